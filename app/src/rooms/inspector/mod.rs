//! The inspector: what the selected nodes are set to, made from their declarations.
//!
//! Guarantees: every input of every kind of node has a widget; what this version does not know is shown as the text that is
//! kept; a drag is one undo step, so is a typed value, and several nodes of one kind are edited in one step. It reads the
//! state and says events; a document with odd values is shown, not corrected.

mod colours;
pub(crate) mod field;
mod instance;
pub(crate) mod number;
mod ports;
pub(crate) mod ramp;
mod row;
pub(crate) mod shapes;
pub(crate) mod slider;
pub(crate) mod stops;
pub(crate) mod target;
#[cfg(test)]
mod tests;
pub(crate) mod value;
mod wheel;

use crate::core::event::Event;
use crate::core::notes::Gravity;
use crate::core::shown::Shown;
use crate::core::state::{Select, State};
use crate::widgets::text::{self, icon_button, set_name, text_field};
use crate::widgets::theme::{self, Tint};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::{self, Problem, Severity};
use coif_graphs::document::{Node, NodeId, Setting};
use coif_graphs::text::write_value;
use coif_nodes::data::attributes::{Column, DECLARED};
use coif_nodes::declared;
use coif_nodes::define::{Group, InputDef, NodeDef, NodeError, Type};
use egui::{Label, RichText, ScrollArea, TextEdit, Ui};
use field::FieldNames;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Weak};
use target::{DragState, EditTarget};

/// With fewer inputs a filter is more than there is to filter.
const FILTERED_FROM: usize = 6;

/// What the inspector remembers between frames.
#[derive(Default)]
pub(crate) struct Inspector {
    gesture: DragState,
    filter: String,
    /// Groups that somebody has opened or closed, in whichever node.
    groups: BTreeMap<Group, bool>,
    /// The node that is shown, and what was said about its inputs.
    node: Option<NodeId>,
    said: BTreeMap<&'static str, String>,
    /// What is wrong with the document, as of a number of changes.
    problems: Option<(u64, Vec<Problem>)>,
    /// Names to choose from, as of an evaluation.
    known: FieldNames,
    known_of: Weak<Shown>,
    /// Whether all that is said of the node is listed, not its worst alone.
    says_all: bool,
}

impl Inspector {
    /// Shows what is selected and says what is done to it.
    pub(crate) fn ui(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        self.gesture.look(state);
        self.learn(state);
        if self.node.as_ref() != state.active() {
            self.node = state.active().cloned();
            self.said.clear();
            self.filter.clear();
        }
        self.messages(state, ui, out);
        let said = self.said.len();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            // Room for the scroll bar, which would lie over what is at the right.
            ui.set_max_width((ui.available_width() - 8.0).max(1.0));
            ui.spacing_mut().item_spacing.y = 3.0;
            match state.active().and_then(|id| Some((id, state.document.node(id.as_str())?))) {
                Some((id, node)) => self.node(state, ui, id, node, out),
                None => document(state, ui, out),
            }
            ui.add_space(8.0);
        });
        self.gesture.settle(ui, out);
        // What was said of what was typed is shown above.
        if self.said.len() != said {
            ui.ctx().request_repaint();
        }
    }

    /// Looks up, where something changed, what is wrong and which names there are; not at every move of the hand.
    fn learn(&mut self, state: &State) {
        if state.gesture && self.problems.is_some() {
            return;
        }
        if self.problems.as_ref().is_none_or(|(changes, _)| *changes != state.changes) {
            self.problems = Some((state.changes, graph::check(&state.document)));
        }
        let shown = state.shown.as_ref().map_or_else(Weak::new, Arc::downgrade);
        if !self.known_of.ptr_eq(&shown) || self.known.attributes.is_empty() {
            self.known = state.shown.as_deref().map_or_else(|| names(None), |it| names(Some(it)));
            self.known_of = shown;
        }
    }

    fn node(&mut self, state: &State, ui: &mut Ui, id: &NodeId, node: &Node, out: &mut Vec<Event>) {
        let def = state.document.def(id);
        let nodes = alike(state, id, &node.kind, def);
        header(state, ui, (id, node), def, &nodes, out);
        if let Some(origin) = node.template.as_deref().filter(|_| node.is_group()) {
            instance::show(state, ui, id, origin, out);
        }
        ui.separator();
        let Some(def) = def else {
            ui.label(format!("This version has no node {:?}.", node.kind));
            ui.weak("It is kept as it is, with its wires, and passes nothing on.");
            kept(ui, id, node, node.inputs.keys(), out);
            return;
        };
        if def.inputs.len() >= FILTERED_FROM {
            let filter = TextEdit::singleline(&mut self.filter)
                .hint_text("Filter inputs")
                .vertical_align(egui::Align::Center)
                .min_size(ui.spacing().interact_size)
                .desired_width(f32::INFINITY);
            let filter = ui.add(filter);
            set_name(ui, &filter, "Filter inputs");
        }
        let Self { gesture, said, known, filter, groups, .. } = self;
        let mut target = EditTarget { state, nodes: &nodes, out, gesture, said };
        let wired = |input: &&InputDef| matches!(input.ty, Type::Curves | Type::Scalp);
        let asked = |input: &&'static InputDef| matches(input, filter);
        let width = ui.available_width();
        let (wires, set): (Vec<&'static InputDef>, Vec<&'static InputDef>) =
            def.inputs.iter().filter(asked).partition(wired);
        let row = |ui: &mut Ui, target: &mut EditTarget, input: &'static InputDef| {
            ui.push_id(input.name, |ui| row::show(ui, target, input, known, width));
        };
        wires.iter().for_each(|input| row(ui, &mut target, input));
        if !wires.is_empty() && !set.is_empty() {
            ui.separator();
        }
        let filtered = !filter.trim().is_empty();
        for (group, inputs) in def.groups() {
            let colours = !filtered && inputs.iter().any(colours::stand_before);
            let inputs: Vec<_> = inputs.iter().filter(asked).filter(|it| !wired(it)).collect();
            if inputs.is_empty() {
                continue;
            }
            if let Some(group) = group {
                // What is looked for is shown wherever it is.
                let open = filtered || groups.get(&group).copied().unwrap_or(!group.rare());
                if heading(ui, &target, group, &inputs, open).clicked() && !filtered {
                    groups.insert(group, !open);
                }
                if !open {
                    continue;
                }
            }
            if colours {
                colours::show(ui, &mut target, def, width);
            }
            inputs.into_iter().for_each(|input| row(ui, &mut target, input));
        }
        if wires.is_empty() && set.is_empty() && !def.inputs.is_empty() {
            ui.weak(format!("No input is called {filter:?}."));
        }
        let unknown = node.inputs.keys().filter(|name| def.input(name).is_none());
        kept(ui, id, node, unknown, out);
        if [declared::GROUP, declared::PARAMETERS].contains(&node.kind.as_str()) {
            ports::show(state, ui, id, node, out);
        }
    }

    /// What there is to say about a node, the worst first, each with its remedy: one line under the inputs, which opens. It
    /// takes its room whether there is anything or not, so that no input moves when something is said.
    fn messages(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        let said = state.active().map_or_else(Vec::new, |id| self.said_of(state, id));
        let most = (ui.available_height() * 0.5).max(60.0);
        egui::Panel::bottom("what nodes say").resizable(false).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.set_min_height(ui.spacing().interact_size.y);
                let Some(worst) = said.first() else {
                    ui.weak("Nothing to say.");
                    return;
                };
                let more = match said.len() {
                    1 => String::new(),
                    n => format!(" (and {} more)", n - 1),
                };
                let sign = if self.says_all { "⏷" } else { "⏵" };
                let text = format!("{sign} {} {}{more}", worst.sign(), worst.text);
                let whole = text.clone();
                let text = RichText::new(text).color(worst.colour().of(ui));
                let line = ui.add(Label::new(text).truncate().sense(egui::Sense::click()));
                // Also what does not fit.
                ui.ctx().accesskit_node_builder(line.id, |node| node.set_value(whole));
                let tip = if self.says_all { "Close the list" } else { "Open the list" };
                if line.on_hover_text(tip).clicked() {
                    self.says_all = !self.says_all;
                }
            });
            if self.says_all && !said.is_empty() {
                ScrollArea::vertical().max_height(most).show(ui, |ui| {
                    said.iter().for_each(|said| said.show(ui, state, out));
                });
            }
        });
    }

    fn said_of(&self, state: &State, id: &NodeId) -> Vec<Said> {
        let mut all = vec![];
        let problems = self.problems.as_ref().map_or(&[][..], |(_, problems)| problems);
        let mut failed = false;
        for problem in problems.iter().filter(|problem| problem.node == *id) {
            failed |= problem.severity == Severity::Error;
            let socket = problem.socket.as_deref().map_or(String::new(), text::spoken);
            let head = if socket.is_empty() { String::new() } else { format!("{socket}: ") };
            let text = format!("{head}{}; {}.", problem.text, problem.remedy);
            let gravity = match problem.severity {
                Severity::Error => Gravity::Error,
                Severity::Warning => Gravity::Warning,
            };
            all.push(Said { gravity, text, ..Said::default() });
        }
        let reports = &state.run.reports;
        let report = reports.nodes.get(id);
        if let Some(error) = report.and_then(|report| report.error.as_ref())
            && *error != NodeError::Cancelled
            && !failed
        {
            failed = true;
            all.push(Said {
                gravity: Gravity::Error,
                text: format!("{error}."),
                ..Said::default()
            });
        }
        for said in report.into_iter().flat_map(|report| &report.messages) {
            let gravity = if said.warning { Gravity::Warning } else { Gravity::Note };
            let curves = said.curves.iter().copied().collect();
            all.push(Said { gravity, text: said.to_string(), curves, ..Said::default() });
        }
        let failures = reports.failures();
        if !failed && !failures.is_empty() {
            let upstream = graph::upstream(&state.document, [id]);
            let above = failures.iter().find_map(|(name, _)| upstream.get(*name));
            if let Some(above) = above.filter(|above| *above != id) {
                let text = format!("upstream: {}", state.document.name_of(above));
                let above = Some(above.clone());
                all.push(Said { gravity: Gravity::Error, text, above, ..Said::default() });
            }
        }
        all.sort_by_key(|said| std::cmp::Reverse(said.gravity));
        // What was just typed goes before all: it is what one waits for.
        let typed = self.said.iter().map(|(input, text)| {
            let text = format!("{}: {text}", text::spoken(input));
            Said { gravity: Gravity::Warning, text, ..Said::default() }
        });
        all.splice(0..0, typed);
        let mut told = BTreeSet::new();
        all.retain(|said| told.insert(said.text.trim_end_matches('.').to_owned()));
        all
    }
}

/// One thing that is said of a node.
struct Said {
    gravity: Gravity,
    text: String,
    /// The curves that it is about.
    curves: BTreeSet<u64>,
    /// The node above that failed.
    above: Option<NodeId>,
}

impl Default for Said {
    fn default() -> Self {
        let (text, curves) = (String::new(), BTreeSet::new());
        Self { gravity: Gravity::Note, text, curves, above: None }
    }
}

impl Said {
    /// A cross, a triangle or a dot; a hollow mark for what failed above.
    fn sign(&self) -> &'static str {
        match self.gravity {
            _ if self.above.is_some() => "◇",
            Gravity::Error => "✖",
            Gravity::Warning => "⚠",
            Gravity::Note => "•",
        }
    }

    fn colour(&self) -> Tint {
        match self.gravity {
            Gravity::Error => theme::ERROR,
            Gravity::Warning => theme::WARNING,
            Gravity::Note => theme::QUIET,
        }
    }

    fn show(&self, ui: &mut Ui, state: &State, out: &mut Vec<Event>) {
        ui.horizontal_wrapped(|ui| {
            if let Some(above) = &self.above {
                ui.colored_label(self.colour().of(ui), "◇ upstream:");
                if ui.link(state.document.name_of(above)).clicked() {
                    out.push(Event::Select(Select::Nodes(vec![above.clone()])));
                }
                return;
            }
            let text = format!("{} {}", self.sign(), self.text);
            ui.label(RichText::new(text).color(self.colour().of(ui)));
            if !self.curves.is_empty() && ui.link("select").clicked() {
                out.push(Event::Select(Select::Curves(self.curves.clone())));
            }
        });
    }
}

/// The selected nodes of a kind, the active one first.
fn alike(state: &State, active: &NodeId, kind: &str, def: Option<&'static NodeDef>) -> Vec<NodeId> {
    // Two groups are alike when they declare the same.
    let same_def = |id: &NodeId| match (def, state.document.def(id)) {
        (Some(one), Some(other)) => std::ptr::eq(one, other),
        (one, other) => one.is_none() && other.is_none(),
    };
    let same = |id: &&NodeId| {
        let node = state.document.node(id.as_str());
        *id != active && node.is_some_and(|node| node.kind == kind) && same_def(id)
    };
    let others = state.selection.nodes.iter().filter(same);
    std::iter::once(active).chain(others).cloned().collect()
}

/// The line over a group of inputs, which opens and closes it. Closed, it says what it holds.
fn heading(
    ui: &mut Ui,
    target: &EditTarget,
    group: Group,
    inputs: &[&'static InputDef],
    open: bool,
) -> egui::Response {
    let own = |input: &&&InputDef| target.is_changed(input) || !target.wires(input).is_empty();
    let name = match inputs.iter().filter(own).count() {
        n if n > 0 && !open => format!("{}: {n} changed", group.name()),
        _ => group.name().to_owned(),
    };
    let sign = if open { "⏷" } else { "⏵" };
    let text = RichText::new(format!("{sign} {name}")).color(theme::ACCENT.of(ui));
    ui.add_space(4.0);
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let line = egui::Button::new(text).frame(false).right_text("").truncate().min_size(size);
    let line = ui.add(line);
    set_name(ui, &line, &name);
    ui.ctx().accesskit_node_builder(line.id, |node| node.set_expanded(open));
    line.on_hover_ui(|ui| {
        let names: Vec<String> = inputs.iter().map(|input| text::spoken(input.name)).collect();
        ui.set_max_width(380.0);
        ui.label(if open { "Collapse the group.".to_owned() } else { names.join(", ") });
    })
}

/// Whether an input is one that the filter asks for: every word of it somewhere in what the input is called.
fn matches(input: &InputDef, filter: &str) -> bool {
    let all = format!("{} {} {}", text::spoken(input.name), input.name, input.words).to_lowercase();
    filter.to_lowercase().split_whitespace().all(|word| all.contains(word))
}

/// Names of attributes and masks that fields can ask for.
fn names(shown: Option<&Shown>) -> FieldNames {
    let number = |ty: &str| ty == "f32" || ty == "i32";
    let declared = DECLARED.iter().filter(|(_, ty, _)| number(ty)).map(|(name, ..)| *name);
    let mut attributes: BTreeSet<String> = declared.map(str::to_owned).collect();
    let mut masks = BTreeSet::new();
    if let Some(shown) = shown {
        for attribute in shown.curves.tufts().iter().flat_map(|tuft| tuft.attributes()) {
            let number = matches!(attribute.values, Column::F32(_) | Column::I32(_));
            if number && !attributes.contains(attribute.name.as_ref()) {
                attributes.insert(attribute.name.to_string());
            }
        }
        masks.extend(shown.scalps.iter().flat_map(|scalp| scalp.mask_names()));
    }
    FieldNames { attributes: attributes.into_iter().collect(), masks: masks.into_iter().collect() }
}

/// Name, kind, bypass and note.
fn header(
    state: &State,
    ui: &mut Ui,
    (id, node): (&NodeId, &Node),
    def: Option<&'static NodeDef>,
    nodes: &[NodeId],
    out: &mut Vec<Event>,
) {
    let once = |edits: Vec<Edit>, out: &mut Vec<Event>| {
        out.extend(match edits.len() {
            0 => None,
            1 => edits.into_iter().next().map(Event::Edit),
            _ => Some(Event::Edit(Edit::Several(edits))),
        });
    };
    let kind = def.map_or(node.kind.as_str(), |def| def.label);
    let button = ui.spacing().interact_size.y;
    ui.horizontal(|ui| {
        let label = node.label.as_deref().unwrap_or_default();
        let width = ui.available_width() - button - 8.0;
        let hint = state.document.name_of(id);
        if let Some(label) = text_field(ui, "Node name", label, &hint, (width, 1)) {
            let label = Some(label.trim().to_owned()).filter(|label| !label.is_empty());
            out.push(Event::Edit(Edit::SetLabel { id: id.clone(), label }));
        }
        let menu = ui.menu_button("…", |ui| {
            let Some(def) = def else { return };
            let all: Vec<&InputDef> = def.inputs.iter().collect();
            let mut edits = vec![];
            for node in nodes {
                let Some(held) = state.document.node(node.as_str()) else { continue };
                for input in all.iter().filter(|input| {
                    held.inputs.contains_key(input.name)
                        && !matches!(input.ty, Type::Strokes | Type::Gestures)
                }) {
                    let (node, input) = (node.clone(), input.name.to_owned());
                    edits.push(Edit::UnsetInput { node, input });
                }
            }
            let can = !edits.is_empty();
            let reset = ui.add_enabled(can, egui::Button::new("Reset all inputs"));
            let reset = reset.on_hover_text(
                "Reset every input to its default. Strokes, gestures and wires stay.",
            );
            if reset.on_disabled_hover_text("All inputs are at their defaults.").clicked() {
                once(edits, out);
                ui.close();
            }
        });
        set_name(ui, &menu.response, "More about the node");
    });
    ui.horizontal(|ui| {
        let kind = ui.add(egui::Label::new(RichText::new(kind).color(theme::ACCENT.of(ui))));
        if let Some(def) = def {
            kind.on_hover_ui(|ui| {
                ui.set_max_width(420.0);
                ui.strong(def.label);
                ui.label(def.doc());
                ui.weak(format!("In files this node is called {id}."));
            });
        }
        let mut bypass = node.bypass;
        let right = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right, |ui| {
            let check = ui.checkbox(&mut bypass, "Bypass");
            let check = check.on_hover_text("Bypass the node: its input passes through unchanged.");
            if check.changed() {
                let edit = |id: &NodeId| Edit::SetBypass { id: id.clone(), bypass };
                once(nodes.iter().map(edit).collect(), out);
            }
        });
    });
    let selected = state.selection.nodes.len();
    if selected > 1 {
        let same = nodes.len();
        ui.weak(match same == selected {
            true => format!("{same} nodes of this kind are edited at once."),
            false if same == 1 => {
                format!("Only this one of the {selected} selected nodes is of its kind and edited.")
            }
            false => {
                format!(
                    "{same} of {selected} selected nodes are of this kind: they are edited at once."
                )
            }
        });
    }
    let width = ui.available_width();
    let lines = if node.note.is_empty() { 1 } else { 2 };
    if let Some(note) = text_field(ui, "Note", &node.note, "Note", (width, lines)) {
        out.push(Event::Edit(Edit::SetNodeNote { id: id.clone(), note }));
    }
}

/// Inputs that this version does not know, as the text that is kept.
fn kept<'a>(
    ui: &mut Ui,
    id: &NodeId,
    node: &Node,
    names: impl Iterator<Item = &'a String>,
    out: &mut Vec<Event>,
) {
    let mut first = true;
    for name in names {
        if std::mem::take(&mut first) {
            ui.add_space(6.0);
            ui.weak("Kept, though this version does not know it:");
        }
        let text = match node.inputs.get(name) {
            Some(Setting::Raw(text)) => text.to_string(),
            Some(Setting::Known(value)) => write_value(value),
            None => continue,
        };
        ui.horizontal_wrapped(|ui| {
            if icon_button(ui, "✖", &format!("Remove {name}")).clicked() {
                let (node, input) = (id.clone(), name.clone());
                out.push(Event::Edit(Edit::UnsetInput { node, input }));
            }
            ui.label(name.as_str());
            ui.monospace(text.chars().take(400).collect::<String>());
        });
    }
}

/// The document itself, when no node is selected.
fn document(state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
    let width = ui.available_width();
    let document = &state.document;
    ui.label(RichText::new("Groom").color(theme::ACCENT.of(ui)));
    if let Some(title) = text_field(ui, "Title", &document.title, "Title", (width, 1)) {
        out.push(Event::Edit(Edit::SetTitle(title)));
    }
    if let Some(note) = text_field(ui, "Note", &document.note, "Note", (width, 3)) {
        out.push(Event::Edit(Edit::SetNote(note)));
    }
    let seed = document.seed.to_string();
    ui.horizontal(|ui| {
        ui.label("Seed").on_hover_text("Seed of all randomness in the groom.");
        let width = ui.available_width();
        if let Some(seed) = text_field(ui, "Seed", &seed, "a whole number", (width, 1))
            && let Ok(seed) = seed.trim().parse()
        {
            out.push(Event::Edit(Edit::SetSeed(seed)));
        }
    });
    ui.separator();
    ui.weak("Select a node to see what it is set to.");
}
