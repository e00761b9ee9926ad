//! Everything that can be done to a document, each with its inverse.
//!
//! An edit either happens whole and gives the edit that takes it back, or the document is as
//! before. Edits that would make a groom that cannot run (an unknown input, a value of another
//! type, a circle of wires) are refused with the reason; [`Edit::SetWires`] alone takes anything,
//! because undo must also restore a broken file.

use super::budget::Budget;
use super::{
    Document, FileEntry, Frame, Node, NodeId, Point, SavedLook, SavedView, Setting, Socket,
    Thumbnail, graph,
};
use crate::values;
use coif_nodes::data::gestures::Gesture;
use coif_nodes::data::strokes::Stroke;
use coif_nodes::declared;
use coif_nodes::define::{Arity, NodeDef};
use std::sync::Arc;
use wires::{
    bends_of, kept_bends, one, remove_node, restoring, set_wires, settle_names, wired_with, wires,
};

mod between;
mod bytes;
mod effect;
mod lists;
mod wires;

pub use between::between;

/// A change of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Adds a node, on the canvas at `at`.
    AddNode {
        /// Its id, for ever.
        id: NodeId,
        /// The node.
        node: Arc<Node>,
        /// Its place.
        at: Option<Point>,
    },
    /// Removes a node with its wires and their bends, place, comments and flags.
    RemoveNode {
        /// Which.
        id: NodeId,
    },
    /// Puts another node in the place of one, wires stay: another kind, or several inputs at once.
    ReplaceNode {
        /// Which.
        id: NodeId,
        /// What it becomes.
        node: Arc<Node>,
    },
    /// Sets an input. The value is kept in the form that documents have (see [`values::fit`]).
    SetInput {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// To what.
        setting: Setting,
    },
    /// Gives an input its default back.
    UnsetInput {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
    },
    /// Wires an output to an input. An input that takes one wire loses the one it had.
    Connect {
        /// Output.
        from: Socket,
        /// Input.
        to: Socket,
        /// Before which wire of an input that takes many; behind all when none or past the end.
        at: Option<usize>,
    },
    /// Removes a wire.
    Disconnect {
        /// Input.
        to: Socket,
        /// Which of its wires.
        at: usize,
    },
    /// Moves a wire of an input that takes many to another number.
    Reorder {
        /// Input.
        to: Socket,
        /// Which wire.
        from: usize,
        /// Its new number.
        at: usize,
    },
    /// Gives an input exactly these wires, unproven; none removes all. A wire of the same output keeps
    /// its bends.
    SetWires {
        /// Input.
        to: Socket,
        /// Outputs in order.
        from: Vec<Socket>,
    },
    /// Bends a wire: the points that it runs through, from its output on.
    SetBends {
        /// Input.
        to: Socket,
        /// Which of its wires.
        at: usize,
        /// On the canvas; none lets it run by itself.
        bends: Vec<Point>,
    },
    /// Draws a node small, or whole again.
    SetCollapsed {
        /// Which.
        id: NodeId,
        /// Whether it is small.
        collapsed: bool,
    },
    /// Puts a frame behind nodes, or another in its place; none removes it.
    SetFrame {
        /// Its name, for ever.
        name: String,
        /// The frame.
        frame: Option<Frame>,
    },
    /// Saves a view, or another under the same name; none removes it.
    SetView {
        /// Its name.
        name: String,
        /// The camera.
        view: Option<SavedView>,
    },
    /// Light and skin that the groom is looked at with; none where nobody chose.
    SetLook(Option<SavedLook>),
    /// Sets the small picture, or takes it away.
    SetThumbnail(Option<Thumbnail>),
    /// Moves a node on the canvas.
    Move {
        /// Which.
        id: NodeId,
        /// Where to; none lets the editor place it.
        to: Option<Point>,
    },
    /// Sets the title.
    SetTitle(String),
    /// Sets the document's note.
    SetNote(String),
    /// Sets the document's seed.
    SetSeed(u64),
    /// Sets what the groom may take.
    SetBudget(Budget),
    /// Shows another node.
    SetDisplay(Option<NodeId>),
    /// Calls a node something else; none or empty gives it back the label of its kind.
    SetLabel {
        /// Which.
        id: NodeId,
        /// Its name for people.
        label: Option<String>,
    },
    /// Sets a node's note.
    SetNodeNote {
        /// Which.
        id: NodeId,
        /// Free text.
        note: String,
    },
    /// Lets a node pass its input through, or work again.
    SetBypass {
        /// Which.
        id: NodeId,
        /// Whether it is passed by.
        bypass: bool,
    },
    /// Sets the comment lines before an entry; each is one line with its `//`, none removes them.
    SetComment {
        /// Before what.
        place: FileEntry,
        /// Lines.
        lines: Vec<String>,
    },
    /// Adds a stroke to an input that holds strokes.
    AddStroke {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// Its number; behind all when past the end.
        at: usize,
        /// The stroke.
        stroke: Stroke,
    },
    /// Removes a stroke.
    RemoveStroke {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// Its stored id.
        id: u64,
    },
    /// Puts another form of a stroke in its place, under the same id.
    ReplaceStroke {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// The stroke.
        stroke: Stroke,
    },
    /// Adds a gesture to an input that holds gestures.
    AddGesture {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// Its number; behind all when past the end.
        at: usize,
        /// The gesture.
        gesture: Gesture,
    },
    /// Removes a gesture.
    RemoveGesture {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// Its stored id.
        id: u64,
    },
    /// Puts another form of a gesture in its place, under the same id.
    ReplaceGesture {
        /// Of which node.
        node: NodeId,
        /// Which input.
        input: String,
        /// The gesture.
        gesture: Gesture,
    },
    /// All of them in order, or none.
    Several(Vec<Edit>),
}

/// Why an edit did not happen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// It is about a node that is not there.
    #[error("there is no node {0}")]
    NoNode(NodeId),
    /// A node's id is taken.
    #[error("there is a node {0} already")]
    IdTaken(NodeId),
    /// The node's kind has no such input.
    #[error("{at}: {kind} has no such input{near}")]
    NoInput {
        /// Input.
        at: Socket,
        /// Kind of its node.
        kind: String,
        /// The input that was meant, as a question.
        near: String,
    },
    /// The value cannot be held there.
    #[error("{at}: {reason}")]
    BadValue {
        /// Input.
        at: Socket,
        /// What is wrong with it.
        reason: String,
    },
    /// The wire cannot be.
    #[error("{0}")]
    BadWire(Box<graph::Problem>),
    /// A wire's number is too high.
    #[error("{to} has no wire {at}: its wires are numbered from 0, there are {count}")]
    NoWire {
        /// Input.
        to: Socket,
        /// Number asked for.
        at: usize,
        /// Wires there are.
        count: usize,
    },
    /// The input holds no such list.
    #[error("{at} holds no {what}")]
    NoList {
        /// Input.
        at: Socket,
        /// "strokes" or "gestures".
        what: &'static str,
    },
    /// No item of a list has that id, one has it already, or the list cannot hold it.
    #[error("{at}: {reason}")]
    BadItem {
        /// Input.
        at: Socket,
        /// What is wrong.
        reason: String,
    },
    /// Not a finite place on the canvas.
    #[error("{0}: the place on the canvas is not a finite number")]
    BadPlace(NodeId),
    /// A frame or a view that cannot be kept.
    #[error("{what} {name:?}: {reason}")]
    BadEntry {
        /// "frame" or "view".
        what: &'static str,
        /// Its name.
        name: String,
        /// What is wrong.
        reason: &'static str,
    },
    /// Not comment lines, or nothing for them to stand before.
    #[error(
        "comments are single lines that begin with // and stand before an entry of the document"
    )]
    BadComment,
}

impl Edit {
    /// Makes the change and gives the edit that takes it back exactly. On an error the document is
    /// as before.
    pub fn apply(&self, document: &mut Document) -> Result<Edit, EditError> {
        // Of what is lost comes back what there was, not what this edit had made of it by then.
        let comments = document.comments.clone();
        let inverse = self.change(document)?;
        // Comments go with what they stood before, and come back with it.
        let lost: Vec<FileEntry> =
            document.comments.keys().filter(|place| !document.has(place)).cloned().collect();
        if lost.is_empty() {
            return Ok(inverse);
        }
        let mut undo = vec![inverse];
        for place in lost {
            document.comments.remove(&place);
            if let Some(lines) = comments.get(&place).cloned() {
                undo.push(Edit::SetComment { place, lines });
            }
        }
        Ok(Edit::Several(undo))
    }

    fn change(&self, document: &mut Document) -> Result<Edit, EditError> {
        match self {
            Edit::AddNode { id, node, at } => {
                if document.nodes.contains_key(id) {
                    return Err(EditError::IdTaken(id.clone()));
                }
                let node = checked_node(document, id, node)?;
                place(document, id, *at)?;
                document.nodes.insert(id.clone(), node);
                // A broken file can hold wires of a node that is not there; they outlive this one.
                let mut undo = vec![Edit::RemoveNode { id: id.clone() }];
                for to in wired_with(document, id) {
                    undo.extend(restoring(document, &to));
                }
                settle_names(document, id);
                Ok(one(undo))
            }
            Edit::RemoveNode { id } => remove_node(document, id),
            Edit::ReplaceNode { id, node } => {
                let node = checked_node(document, id, node)?;
                let old = std::mem::replace(slot(document, id)?, node);
                let mut undo = vec![Edit::ReplaceNode { id: id.clone(), node: old }];
                undo.extend(settle_names(document, id));
                Ok(one(undo))
            }
            Edit::SetInput { node, input, setting } => {
                let kind = slot(document, node)?.kind.clone();
                let def = document.def(node);
                let input = present_name(def, input);
                let at = Socket::new(node.clone(), &input);
                let setting = checked((&kind, def), &at, setting)?;
                let old = node_mut(document, node)?.inputs.insert(input.clone(), setting);
                let node = node.clone();
                Ok(match old {
                    Some(setting) => Edit::SetInput { node, input, setting },
                    None => Edit::UnsetInput { node, input },
                })
            }
            Edit::UnsetInput { node, input } => {
                let input = present_name(document.def(node), input);
                let old = node_mut(document, node)?.inputs.remove(&input);
                let node = node.clone();
                Ok(match old {
                    Some(setting) => Edit::SetInput { node, input, setting },
                    None => Edit::UnsetInput { node, input },
                })
            }
            Edit::Connect { from, to, at } => {
                let to = &present_socket(document, to);
                if let Some(problem) = graph::wire_problem(document, from, to) {
                    return Err(EditError::BadWire(Box::new(problem)));
                }
                let mut wires = document.links.get(to).cloned().unwrap_or_default();
                let mut bends = bends_of(document, to);
                if takes_many(document, to) {
                    let at = at.unwrap_or(wires.len()).min(wires.len());
                    wires.insert(at, from.clone());
                    bends.insert(at, vec![]);
                } else {
                    wires = vec![from.clone()];
                    bends = kept_bends(document, to, &wires);
                }
                Ok(set_wires(document, to, wires, bends))
            }
            Edit::Disconnect { to, at } => {
                let to = &present_socket(document, to);
                let (mut wires, mut bends) = wires(document, to, *at)?;
                wires.remove(*at);
                bends.remove(*at);
                Ok(set_wires(document, to, wires, bends))
            }
            Edit::Reorder { to, from, at } => {
                let to = &present_socket(document, to);
                wires(document, to, *at)?;
                let (mut wires, mut bends) = wires(document, to, *from)?;
                let (wire, bent) = (wires.remove(*from), bends.remove(*from));
                wires.insert(*at, wire);
                bends.insert(*at, bent);
                set_wires(document, to, wires, bends);
                Ok(Edit::Reorder { to: to.clone(), from: *at, at: *from })
            }
            Edit::SetWires { to, from } => {
                let to = &present_socket(document, to);
                let bends = kept_bends(document, to, from);
                Ok(set_wires(document, to, from.clone(), bends))
            }
            Edit::SetBends { to, at, bends } => {
                let to = &present_socket(document, to);
                if !bends.iter().all(|point| point.is_finite()) {
                    return Err(EditError::BadPlace(to.node.clone()));
                }
                let (_, mut all) = wires(document, to, *at)?;
                let old = std::mem::replace(&mut all[*at], bends.clone());
                document.set_all_bends(to, all);
                Ok(Edit::SetBends { to: to.clone(), at: *at, bends: old })
            }
            Edit::SetCollapsed { id, collapsed } => {
                slot(document, id)?;
                let was = if *collapsed {
                    !document.collapsed.insert(id.clone())
                } else {
                    document.collapsed.remove(id)
                };
                Ok(Edit::SetCollapsed { id: id.clone(), collapsed: was })
            }
            Edit::SetFrame { name, frame } => {
                if let Some(reason) = frame.as_ref().and_then(|frame| frame.fault(name)) {
                    return Err(EditError::BadEntry { what: "frame", name: name.clone(), reason });
                }
                let old = match frame {
                    Some(frame) => document.frames.insert(name.clone(), frame.clone()),
                    None => document.frames.remove(name),
                };
                Ok(Edit::SetFrame { name: name.clone(), frame: old })
            }
            Edit::SetView { name, view } => {
                if let Some(reason) = view.as_ref().and_then(|view| view.fault(name)) {
                    return Err(EditError::BadEntry { what: "view", name: name.clone(), reason });
                }
                let old = match view {
                    Some(view) => document.views.insert(name.clone(), *view),
                    None => document.views.remove(name),
                };
                Ok(Edit::SetView { name: name.clone(), view: old })
            }
            Edit::SetLook(look) => {
                if let Some(reason) = look.as_ref().and_then(SavedLook::fault) {
                    let name = String::new();
                    return Err(EditError::BadEntry { what: "look", name, reason });
                }
                Ok(Edit::SetLook(std::mem::replace(&mut document.look, look.clone())))
            }
            Edit::Move { id, to } => {
                slot(document, id)?;
                let old = place(document, id, *to)?;
                Ok(Edit::Move { id: id.clone(), to: old })
            }
            Edit::SetTitle(title) => {
                Ok(Edit::SetTitle(std::mem::replace(&mut document.title, title.clone())))
            }
            Edit::SetThumbnail(thumbnail) => {
                let old = std::mem::replace(&mut document.thumbnail, thumbnail.clone());
                Ok(Edit::SetThumbnail(old))
            }
            Edit::SetNote(note) => {
                Ok(Edit::SetNote(std::mem::replace(&mut document.note, note.clone())))
            }
            Edit::SetSeed(seed) => Ok(Edit::SetSeed(std::mem::replace(&mut document.seed, *seed))),
            Edit::SetBudget(budget) => {
                Ok(Edit::SetBudget(std::mem::replace(&mut document.budget, *budget)))
            }
            Edit::SetDisplay(display) => {
                if let Some(id) = display {
                    slot(document, id)?;
                }
                Ok(Edit::SetDisplay(std::mem::replace(&mut document.display, display.clone())))
            }
            Edit::SetLabel { id, label } => {
                let label = label.clone().filter(|label| !label.is_empty());
                let old = std::mem::replace(&mut node_mut(document, id)?.label, label);
                Ok(Edit::SetLabel { id: id.clone(), label: old })
            }
            Edit::SetNodeNote { id, note } => {
                let old = std::mem::replace(&mut node_mut(document, id)?.note, note.clone());
                Ok(Edit::SetNodeNote { id: id.clone(), note: old })
            }
            Edit::SetBypass { id, bypass } => {
                let old = std::mem::replace(&mut node_mut(document, id)?.bypass, *bypass);
                Ok(Edit::SetBypass { id: id.clone(), bypass: old })
            }
            Edit::SetComment { place, lines } => {
                let one_line =
                    |l: &String| l.starts_with("//") && !l.contains('\n') && l.trim_end() == l;
                if !lines.iter().all(one_line) || !document.has(place) {
                    return Err(EditError::BadComment);
                }
                let old = if lines.is_empty() {
                    document.comments.remove(place)
                } else {
                    document.comments.insert(place.clone(), lines.clone())
                };
                Ok(Edit::SetComment { place: place.clone(), lines: old.unwrap_or_default() })
            }
            Edit::AddStroke { node, input, at, stroke } => {
                lists::add(document, (node, input), *at, stroke)
            }
            Edit::RemoveStroke { node, input, id } => {
                lists::remove::<Stroke>(document, (node, input), *id)
            }
            Edit::ReplaceStroke { node, input, stroke } => {
                lists::replace(document, (node, input), stroke)
            }
            Edit::AddGesture { node, input, at, gesture } => {
                lists::add(document, (node, input), *at, gesture)
            }
            Edit::RemoveGesture { node, input, id } => {
                lists::remove::<Gesture>(document, (node, input), *id)
            }
            Edit::ReplaceGesture { node, input, gesture } => {
                lists::replace(document, (node, input), gesture)
            }
            Edit::Several(edits) => {
                let mut undo = vec![];
                for edit in edits {
                    // Not `apply`: comments are looked after once all has happened.
                    match edit.change(document) {
                        Ok(inverse) => undo.push(inverse),
                        Err(err) => {
                            for inverse in undo.iter().rev() {
                                inverse.change(document)?;
                            }
                            return Err(err);
                        }
                    }
                }
                undo.reverse();
                Ok(Edit::Several(undo))
            }
        }
    }

    /// Whether taking back `self` also takes back `newer`, the inverse of a later edit: both
    /// restore the same one thing whole. A drag of a slider is so one entry, however many values it
    /// passed.
    pub(super) fn covers(&self, newer: &Edit) -> bool {
        use Edit::{Move, SetDisplay, SetInput, SetLabel, SetNodeNote, SetNote, SetSeed, SetTitle};
        match (self, newer) {
            (
                SetInput { node, input, .. } | Edit::UnsetInput { node, input },
                SetInput { node: other, input: same, .. }
                | Edit::UnsetInput { node: other, input: same },
            ) => node == other && input == same,
            (Move { id, .. }, Move { id: other, .. })
            | (SetLabel { id, .. }, SetLabel { id: other, .. })
            | (SetNodeNote { id, .. }, SetNodeNote { id: other, .. }) => id == other,
            (Edit::SetFrame { name, .. }, Edit::SetFrame { name: other, .. })
            | (Edit::SetView { name, .. }, Edit::SetView { name: other, .. }) => name == other,
            (Edit::SetBends { to, at, .. }, Edit::SetBends { to: other, at: same, .. }) => {
                to == other && at == same
            }
            (SetTitle(_), SetTitle(_))
            | (SetNote(_), SetNote(_))
            | (SetSeed(_), SetSeed(_))
            | (SetDisplay(_), SetDisplay(_))
            | (Edit::SetThumbnail(_), Edit::SetThumbnail(_))
            | (Edit::SetBudget(_), Edit::SetBudget(_))
            | (Edit::SetLook(_), Edit::SetLook(_)) => true,
            (
                Edit::ReplaceStroke { node, input, stroke },
                Edit::ReplaceStroke { node: other, input: same, stroke: newer },
            ) => node == other && input == same && stroke.id == newer.id,
            (
                Edit::ReplaceGesture { node, input, gesture },
                Edit::ReplaceGesture { node: other, input: same, gesture: newer },
            ) => node == other && input == same && gesture.id == newer.id,
            (Edit::SetWires { to, .. }, Edit::SetWires { to: other, .. }) => to == other,
            (Edit::Several(all), Edit::Several(newer)) => {
                all.len() == newer.len() && all.iter().zip(newer).all(|(a, b)| a.covers(b))
            }
            _ => false,
        }
    }
}

fn slot<'a>(document: &'a mut Document, id: &NodeId) -> Result<&'a mut Arc<Node>, EditError> {
    document.nodes.get_mut(id).ok_or_else(|| EditError::NoNode(id.clone()))
}
fn node_mut<'a>(document: &'a mut Document, id: &NodeId) -> Result<&'a mut Node, EditError> {
    slot(document, id).map(Arc::make_mut)
}

fn place(
    document: &mut Document,
    id: &NodeId,
    to: Option<Point>,
) -> Result<Option<Point>, EditError> {
    match to {
        Some(point) if !point.is_finite() => Err(EditError::BadPlace(id.clone())),
        Some(point) => Ok(document.layout.insert(id.clone(), point)),
        None => Ok(document.layout.remove(id)),
    }
}

/// Inputs of unknown kinds take what they are given.
fn takes_many(document: &Document, to: &Socket) -> bool {
    let def = document.def(&to.node);
    def.and_then(|def| def.input(&to.name)).is_none_or(|(_, input)| input.arity == Arity::Many)
}

/// The setting as documents hold it, which is as a file of it would be read, or why the input of
/// that kind cannot have it.
fn checked(
    (kind, def): (&str, Option<&'static NodeDef>),
    at: &Socket,
    setting: &Setting,
) -> Result<Setting, EditError> {
    let bad = |reason: String| EditError::BadValue { at: at.clone(), reason };
    if let Setting::Raw(text) = setting {
        crate::text::prove_raw(text).map_err(bad)?;
    }
    // What goes out of a group comes by wire.
    let def = def.filter(|_| kind != declared::GROUP_OUTPUT);
    let Some(def) = def else {
        // Nothing says what it is.
        return Ok(match setting {
            Setting::Known(value) => Setting::Raw(crate::text::write_value(value).into()),
            raw => raw.clone(),
        });
    };
    let Some((_, input)) = def.input(&at.name).filter(|(_, input)| input.name == &*at.name) else {
        // What a file brought may stay and come back; nothing new is put where nothing reads it.
        if let Setting::Raw(_) = setting {
            return Ok(setting.clone());
        }
        let near = graph::near_input(def, &at.name);
        return Err(EditError::NoInput { at: at.clone(), kind: kind.to_owned(), near });
    };
    match setting {
        Setting::Raw(text) => Ok(crate::text::proven_value(input.ty, text)
            .map_or_else(|_| setting.clone(), Setting::Known)),
        Setting::Known(value) => {
            values::fit(input.ty, value.clone()).map(Setting::Known).map_err(bad)
        }
    }
}

/// The name of an input today.
fn present_name(def: Option<&'static NodeDef>, input: &str) -> String {
    def.and_then(|def| def.input(input)).map_or(input, |(_, def)| def.name).to_owned()
}

fn present_socket(document: &Document, to: &Socket) -> Socket {
    Socket::new(to.node.clone(), &present_name(document.def(&to.node), &to.name))
}

fn checked_node(
    document: &Document,
    id: &NodeId,
    node: &Arc<Node>,
) -> Result<Arc<Node>, EditError> {
    let def = document.def_of(id, node);
    let mut inputs = std::collections::BTreeMap::new();
    for (name, setting) in &node.inputs {
        let present = present_name(def, name);
        if present != *name && node.inputs.contains_key(&present) {
            continue;
        }
        let at = Socket::new(id.clone(), &present);
        let kept = checked((&node.kind, def), &at, setting)?;
        inputs.insert(present, kept);
    }
    let label = node.label.clone().filter(|label| !label.is_empty());
    if inputs == node.inputs && label == node.label {
        return Ok(node.clone());
    }
    Ok(Arc::new(Node { inputs, label, ..Node::clone(node) }))
}

#[cfg(test)]
mod tests;
