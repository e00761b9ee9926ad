//! The nodes that the inspector edits at once, and how what hands do becomes events.
//!
//! Guarantees: an input that reads a parameter is set there; a drag is one gesture from its first change to the release of the pointer; what changes nothing is not
//! said; several nodes change in one edit. A gesture that something else ended or took back stays ended until the
//! pointer is released.

use crate::core::event::Event;
use crate::core::state::State;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Setting, Socket, wiring};
use coif_graphs::values::fit;
use coif_nodes::define::{InputDef, Value};
use std::collections::BTreeMap;

/// How a value changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum How {
    /// The hand still holds it.
    Drag,
    /// At once.
    Once,
    /// A little, by a key or the wheel.
    Nudge,
}

impl How {
    /// For widgets that do not tell a drag from a click: whatever changes while the pointer is down is dragged.
    pub(crate) fn of(ui: &egui::Ui) -> Self {
        if ui.input(|input| input.pointer.primary_down()) { How::Drag } else { How::Once }
    }
}

/// The drag under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum DragState {
    /// None.
    #[default]
    Rest,
    /// Begun by the inspector.
    Open,
    /// Ended by something else, while the pointer is still down.
    Dead,
}

impl DragState {
    /// Looks, before anything is shown, whether the gesture is still open.
    pub(crate) fn look(&mut self, state: &State) {
        if *self == DragState::Open && !state.gesture {
            *self = DragState::Dead;
        }
    }
    /// Ends it once the pointer is released; to be called when all is shown.
    pub(crate) fn settle(&mut self, ui: &egui::Ui, out: &mut Vec<Event>) {
        if *self != DragState::Rest && !ui.input(|input| input.pointer.any_down()) {
            if *self == DragState::Open {
                out.push(Event::End);
            }
            *self = DragState::Rest;
        }
    }
    /// Says an edit.
    pub(crate) fn say(&mut self, edit: Edit, how: How, out: &mut Vec<Event>) {
        match (how, *self) {
            (How::Drag, DragState::Dead) => {}
            (How::Drag, DragState::Rest) => {
                *self = DragState::Open;
                out.extend([Event::Begin(String::new()), Event::Edit(edit)]);
            }
            (How::Drag, DragState::Open) | (How::Once, _) => out.push(Event::Edit(edit)),
            (How::Nudge, _) => out.push(Event::Nudge(edit)),
        }
    }
}

/// What an input of a node is set to.
#[derive(Clone, Debug)]
pub(crate) enum InputSetting {
    /// This value, or the default.
    Value(Value),
    /// Nothing, which means something of its own or needs a wire.
    Unset,
    /// Text that this version cannot read; it is kept.
    Raw(String),
}

/// The nodes that are edited at once, all of one kind, and where what was done is said.
pub(crate) struct EditTarget<'a> {
    /// What everybody sees.
    pub(crate) state: &'a State,
    /// The active node first.
    pub(crate) nodes: &'a [NodeId],
    /// Where events go.
    pub(crate) out: &'a mut Vec<Event>,
    /// The drag under way.
    pub(crate) gesture: &'a mut DragState,
    /// What was said about an input, until it changes again.
    pub(crate) said: &'a mut BTreeMap<&'static str, String>,
}

impl EditTarget<'_> {
    /// Where an input of one of the nodes is set: there, or where the parameter is that it reads.
    fn place(&self, node: &NodeId, input: &InputDef) -> Socket {
        wiring::set_at(&self.state.document, &Socket::new(node.clone(), input.name))
    }

    fn setting(&self, node: &NodeId, input: &InputDef) -> Option<&Setting> {
        let at = self.place(node, input);
        self.state.document.node(at.node.as_str())?.inputs.get(&*at.name)
    }

    /// The edit that sets an input of one of the nodes.
    pub(crate) fn set_edit(&self, node: &NodeId, input: &InputDef, setting: Setting) -> Edit {
        let at = self.place(node, input);
        Edit::SetInput { node: at.node, input: at.name.to_string(), setting }
    }

    /// What an input of one of the nodes holds.
    pub(crate) fn held_by(&self, node: &NodeId, input: &InputDef) -> InputSetting {
        match self.setting(node, input) {
            Some(Setting::Known(value)) => InputSetting::Value(value.clone()),
            Some(Setting::Raw(text)) => InputSetting::Raw(text.to_string()),
            None => {
                let at = self.place(node, input);
                let there = wiring::input_def(&self.state.document, &at).and_then(default_of);
                let value = there.or_else(|| default_of(input));
                value.map_or(InputSetting::Unset, InputSetting::Value)
            }
        }
    }

    /// What the active node holds.
    pub(crate) fn held(&self, input: &InputDef) -> InputSetting {
        self.nodes.first().map_or(InputSetting::Unset, |node| self.held_by(node, input))
    }

    /// Why the input counts for nothing beside what else the active node is set to.
    pub(crate) fn idle(&self, input: &InputDef) -> Option<&'static str> {
        let (idle, node) = (input.idle?, self.nodes.first()?);
        let def = self.state.document.def(node)?;
        idle(&|name| {
            let (_, other) = def.input(name)?;
            match self.held(other) {
                InputSetting::Value(value) if self.wires(other).is_empty() => Some(value),
                _ => None,
            }
        })
    }

    /// Whether the nodes hold different values.
    pub(crate) fn differ(&self, input: &InputDef) -> bool {
        let Some((first, rest)) = self.nodes.split_first() else { return false };
        rest.iter().any(|node| self.setting(node, input) != self.setting(first, input))
    }

    /// Whether any of the nodes says something of its own about the input.
    pub(crate) fn is_set(&self, input: &InputDef) -> bool {
        self.nodes.iter().any(|node| self.setting(node, input).is_some())
    }

    /// Whether any of the nodes differs from the default.
    pub(crate) fn is_changed(&self, input: &InputDef) -> bool {
        // Every node has a seed of its own from the start.
        if input.name == "seed" {
            return false;
        }
        self.nodes.iter().any(|node| match self.setting(node, input) {
            None => false,
            Some(Setting::Raw(_)) => true,
            Some(Setting::Known(value)) => {
                default_of(input).is_none_or(|default| default.key() != value.key())
            }
        })
    }

    /// The outputs wired to an input of the active node.
    pub(crate) fn wires(&self, input: &InputDef) -> &[Socket] {
        let wires = |node| self.state.document.wires(node, input.name);
        self.nodes.first().map_or(&[], wires)
    }

    /// Sets an input of all nodes.
    pub(crate) fn set(&mut self, input: &InputDef, value: impl Into<Value>, how: How) {
        let value = value.into();
        self.set_each(input, how, |_| Some(value.clone()));
    }

    /// Sets an input of each node to what is made of what it holds; none leaves it.
    pub(crate) fn set_each(
        &mut self,
        input: &InputDef,
        how: How,
        new: impl Fn(InputSetting) -> Option<Value>,
    ) {
        let mut edits = vec![];
        for node in self.nodes {
            let Some(value) = new(self.held_by(node, input)) else { continue };
            let setting = match fit(input.ty, value) {
                Ok(value) => Setting::Known(value),
                Err(why) => {
                    self.said.insert(input.name, why);
                    return;
                }
            };
            if self.setting(node, input) != Some(&setting) {
                edits.push(self.set_edit(node, input, setting));
            }
        }
        self.say(edits, how);
    }

    /// Gives an input its default back.
    pub(crate) fn unset(&mut self, input: &InputDef) {
        self.said.remove(input.name);
        let edits = self.unset_edits(&[input]);
        self.say(edits, How::Once);
    }

    /// What gives inputs their defaults back, where they are set.
    pub(crate) fn unset_edits(&self, inputs: &[&InputDef]) -> Vec<Edit> {
        let mut edits = vec![];
        for node in self.nodes {
            for input in inputs.iter().filter(|input| self.setting(node, input).is_some()) {
                let at = self.place(node, input);
                edits.push(Edit::UnsetInput { node: at.node, input: at.name.to_string() });
            }
        }
        edits
    }

    /// Says edits as one.
    pub(crate) fn say(&mut self, mut edits: Vec<Edit>, how: How) {
        let edit = match edits.len() {
            0 => return,
            1 => edits.remove(0),
            _ => Edit::Several(edits),
        };
        self.gesture.say(edit, how, self.out);
    }
}

/// The default of an input in the form that documents hold; none where unset means something of its own.
pub(crate) fn default_of(input: &InputDef) -> Option<Value> {
    input.default().and_then(|default| fit(input.ty, default).ok())
}
