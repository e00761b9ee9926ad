//! Everything that can be done to a document, each with its inverse.
//!
//! An edit either happens whole and gives the edit that takes it back, or the document is as
//! before. Edits that would make a groom that cannot run (an unknown input, a value of another
//! type, a circle of wires) are refused with the reason; [`Edit::SetWires`] alone takes anything,
//! because undo must also restore a broken file.

use super::{Document, Node, NodeId, Place, Point, Setting, Socket, graph, values};
use coif_nodes::data::strokes::{Stroke, Strokes};
use coif_nodes::define::{Arity, Type, Value};
use std::collections::btree_map::Entry;
use std::sync::Arc;

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
    /// Removes a node with its wires, place, comments and display flag.
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
    /// Gives an input exactly these wires, unproven; none removes all.
    SetWires {
        /// Input.
        to: Socket,
        /// Outputs in order.
        from: Vec<Socket>,
    },
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
        place: Place,
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
    /// The input holds no strokes.
    #[error("{0} holds no strokes")]
    NoStrokes(Socket),
    /// No stroke has that id, or one has it already.
    #[error("{at}: {reason}")]
    BadStroke {
        /// Input.
        at: Socket,
        /// What is wrong.
        reason: String,
    },
    /// Not a finite place on the canvas.
    #[error("{0}: the place on the canvas is not a finite number")]
    BadPlace(NodeId),
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
        let inverse = self.change(document)?;
        // Comments go with what they stood before, and come back with it.
        let lost: Vec<Place> =
            document.comments.keys().filter(|place| !document.has(place)).cloned().collect();
        if lost.is_empty() {
            return Ok(inverse);
        }
        let mut undo = vec![inverse];
        for place in lost {
            if let Some(lines) = document.comments.remove(&place) {
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
                let node = checked_node(id, node)?;
                place(document, id, *at)?;
                document.nodes.insert(id.clone(), node);
                // A broken file can hold wires of a node that is not there; they outlive this one.
                let mut undo = vec![Edit::RemoveNode { id: id.clone() }];
                for to in wired_with(document, id) {
                    let from = document.links.get(&to).cloned().unwrap_or_default();
                    undo.push(Edit::SetWires { to, from });
                }
                settle_names(document, id);
                Ok(if undo.len() == 1 { undo.remove(0) } else { Edit::Several(undo) })
            }
            Edit::RemoveNode { id } => remove_node(document, id),
            Edit::ReplaceNode { id, node } => {
                let node = checked_node(id, node)?;
                let old = std::mem::replace(slot(document, id)?, node);
                let mut undo = vec![Edit::ReplaceNode { id: id.clone(), node: old }];
                undo.extend(settle_names(document, id));
                Ok(if undo.len() == 1 { undo.remove(0) } else { Edit::Several(undo) })
            }
            Edit::SetInput { node, input, setting } => {
                let kind = slot(document, node)?.kind.clone();
                let input = present_name(&kind, input);
                let setting = checked(&kind, &Socket::new(node.clone(), &input), setting)?;
                let old = node_mut(document, node)?.inputs.insert(input.clone(), setting);
                let node = node.clone();
                Ok(match old {
                    Some(setting) => Edit::SetInput { node, input, setting },
                    None => Edit::UnsetInput { node, input },
                })
            }
            Edit::UnsetInput { node, input } => {
                let input = present_name(&slot(document, node)?.kind, input);
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
                if takes_many(document, to) {
                    wires.insert(at.unwrap_or(wires.len()).min(wires.len()), from.clone());
                } else {
                    wires = vec![from.clone()];
                }
                Ok(set_wires(document, to, wires))
            }
            Edit::Disconnect { to, at } => {
                let to = &present_socket(document, to);
                let mut wires = wires(document, to, *at)?;
                wires.remove(*at);
                Ok(set_wires(document, to, wires))
            }
            Edit::Reorder { to, from, at } => {
                let to = &present_socket(document, to);
                wires(document, to, *at)?;
                let mut wires = wires(document, to, *from)?;
                let wire = wires.remove(*from);
                wires.insert(*at, wire);
                set_wires(document, to, wires);
                Ok(Edit::Reorder { to: to.clone(), from: *at, at: *from })
            }
            Edit::SetWires { to, from } => {
                Ok(set_wires(document, &present_socket(document, to), from.clone()))
            }
            Edit::Move { id, to } => {
                slot(document, id)?;
                let old = place(document, id, *to)?;
                Ok(Edit::Move { id: id.clone(), to: old })
            }
            Edit::SetTitle(title) => {
                Ok(Edit::SetTitle(std::mem::replace(&mut document.title, title.clone())))
            }
            Edit::SetNote(note) => {
                Ok(Edit::SetNote(std::mem::replace(&mut document.note, note.clone())))
            }
            Edit::SetSeed(seed) => Ok(Edit::SetSeed(std::mem::replace(&mut document.seed, *seed))),
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
                let (node, input, id) = (node.clone(), input.clone(), stroke.id);
                let was_set = slot(document, &node)?.inputs.contains_key(&input);
                on_strokes(document, &node, &input, |strokes| {
                    let at = (*at).min(strokes.len());
                    strokes.insert(at, stroke.clone());
                    Ok(())
                })?;
                Ok(if was_set {
                    Edit::RemoveStroke { node, input, id }
                } else {
                    Edit::UnsetInput { node, input }
                })
            }
            Edit::RemoveStroke { node, input, id } => {
                let (node, input) = (node.clone(), input.clone());
                let (at, stroke) = on_strokes(document, &node, &input, |strokes| {
                    let at = find(strokes, *id)?;
                    Ok((at, strokes.remove(at)))
                })?;
                Ok(Edit::AddStroke { node, input, at, stroke })
            }
            Edit::ReplaceStroke { node, input, stroke } => {
                let (node, input) = (node.clone(), input.clone());
                let stroke = on_strokes(document, &node, &input, |strokes| {
                    let at = find(strokes, stroke.id)?;
                    Ok(std::mem::replace(&mut strokes[at], stroke.clone()))
                })?;
                Ok(Edit::ReplaceStroke { node, input, stroke })
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
            (SetTitle(_), SetTitle(_))
            | (SetNote(_), SetNote(_))
            | (SetSeed(_), SetSeed(_))
            | (SetDisplay(_), SetDisplay(_)) => true,
            (
                Edit::ReplaceStroke { node, input, stroke },
                Edit::ReplaceStroke { node: other, input: same, stroke: newer },
            ) => node == other && input == same && stroke.id == newer.id,
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
        Some(Point(x, y)) if !(x.is_finite() && y.is_finite()) => {
            Err(EditError::BadPlace(id.clone()))
        }
        Some(point) => Ok(document.layout.insert(id.clone(), point)),
        None => Ok(document.layout.remove(id)),
    }
}

fn remove_node(document: &mut Document, id: &NodeId) -> Result<Edit, EditError> {
    let node = document.nodes.remove(id).ok_or_else(|| EditError::NoNode(id.clone()))?;
    let mut undo =
        vec![Edit::AddNode { id: id.clone(), node: node.clone(), at: document.layout.remove(id) }];
    for to in wired_with(document, id) {
        let old = document.links.get(&to).cloned().unwrap_or_default();
        let kept = old.iter().filter(|from| to.node != *id && from.node != *id).cloned().collect();
        undo.push(set_wires(document, &to, kept));
    }
    if document.display.as_ref() == Some(id) {
        undo.push(Edit::SetDisplay(document.display.take()));
    }
    Ok(Edit::Several(undo))
}

/// The wired inputs of a node and those that take from it.
fn wired_with(document: &Document, id: &NodeId) -> Vec<Socket> {
    let links = document.links.iter();
    links
        .filter(|(to, from)| to.node == *id || from.iter().any(|from| from.node == *id))
        .map(|(to, _)| to.clone())
        .collect()
}

fn wires(document: &Document, to: &Socket, at: usize) -> Result<Vec<Socket>, EditError> {
    let wires = document.links.get(to).cloned().unwrap_or_default();
    if at >= wires.len() {
        return Err(EditError::NoWire { to: to.clone(), at, count: wires.len() });
    }
    Ok(wires)
}

/// Gives an input exactly these wires; gives the inverse.
fn set_wires(document: &mut Document, to: &Socket, wires: Vec<Socket>) -> Edit {
    let old = match document.links.entry(to.clone()) {
        Entry::Occupied(entry) if wires.is_empty() => entry.remove(),
        Entry::Occupied(mut entry) => entry.insert(wires),
        Entry::Vacant(_) if wires.is_empty() => vec![],
        Entry::Vacant(entry) => {
            entry.insert(wires);
            vec![]
        }
    };
    Edit::SetWires { to: to.clone(), from: old }
}

/// Inputs of unknown kinds take what they are given.
fn takes_many(document: &Document, to: &Socket) -> bool {
    let def = document.node(to.node.as_str()).and_then(|node| coif_nodes::by_id(&node.kind));
    def.and_then(|def| def.input(&to.name)).is_none_or(|(_, input)| input.arity == Arity::Many)
}

/// The setting as documents hold it, which is as a file of it would be read, or why the input of
/// that kind cannot have it.
fn checked(kind: &str, at: &Socket, setting: &Setting) -> Result<Setting, EditError> {
    let bad = |reason: String| EditError::BadValue { at: at.clone(), reason };
    if let Setting::Raw(text) = setting {
        crate::file::prove_raw(text).map_err(bad)?;
    }
    let Some(def) = coif_nodes::by_id(kind) else {
        // Nothing says what it is.
        return Ok(match setting {
            Setting::Known(value) => Setting::Raw(crate::file::write_value(value).into()),
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
        Setting::Raw(text) => Ok(crate::file::proven_value(input.ty, text)
            .map_or_else(|_| setting.clone(), Setting::Known)),
        Setting::Known(value) => {
            values::fit(input.ty, value.clone()).map(Setting::Known).map_err(bad)
        }
    }
}

/// The name of an input today.
fn present_name(kind: &str, input: &str) -> String {
    let def = coif_nodes::by_id(kind).and_then(|def| def.input(input));
    def.map_or(input, |(_, def)| def.name).to_owned()
}

fn present_socket(document: &Document, to: &Socket) -> Socket {
    let kind = document.node(to.node.as_str()).map_or("", |node| &node.kind);
    Socket::new(to.node.clone(), &present_name(kind, &to.name))
}

/// Moves wires that end at a node's inputs under old names to the present ones, where these are free;
/// gives what moves them back. Needed where a node gets a kind that wires did not know.
fn settle_names(document: &mut Document, id: &NodeId) -> Vec<Edit> {
    let wired: Vec<Socket> = graph::inputs_of(document, id).map(|(to, _)| to.clone()).collect();
    let mut undo = vec![];
    for old in wired {
        let new = present_socket(document, &old);
        if new == old {
            continue;
        }
        let taken = document.links.contains_key(&new);
        if let Some(from) = document.links.remove(&old) {
            if !taken {
                undo.push(set_wires(document, &new, from.clone()));
            }
            undo.push(Edit::SetWires { to: old, from });
        }
    }
    undo
}

fn checked_node(id: &NodeId, node: &Arc<Node>) -> Result<Arc<Node>, EditError> {
    let mut inputs = std::collections::BTreeMap::new();
    for (name, setting) in &node.inputs {
        let present = present_name(&node.kind, name);
        if present != *name && node.inputs.contains_key(&present) {
            continue;
        }
        let kept = checked(&node.kind, &Socket::new(id.clone(), &present), setting)?;
        inputs.insert(present, kept);
    }
    let label = node.label.clone().filter(|label| !label.is_empty());
    if inputs == node.inputs && label == node.label {
        return Ok(node.clone());
    }
    Ok(Arc::new(Node { inputs, label, ..Node::clone(node) }))
}

fn find(strokes: &[Stroke], id: u64) -> Result<usize, String> {
    strokes.iter().position(|s| s.id == id).ok_or_else(|| format!("there is no stroke {id}"))
}

/// Changes the strokes of an input. The list is copied, because snapshots hold the old one: 20
/// bytes a sample.
fn on_strokes<T>(
    document: &mut Document,
    node: &NodeId,
    input: &str,
    change: impl FnOnce(&mut Vec<Stroke>) -> Result<T, String>,
) -> Result<T, EditError> {
    let at = Socket::new(node.clone(), input);
    let def = coif_nodes::by_id(&slot(document, node)?.kind).and_then(|def| def.input(input));
    let takes = def.is_some_and(|(_, def)| def.ty == Type::Strokes);
    let old = match slot(document, node)?.inputs.get(input) {
        Some(Setting::Known(Value::Strokes(strokes))) => strokes.clone(),
        None if takes => Arc::default(),
        _ => return Err(EditError::NoStrokes(at)),
    };
    let mut strokes: Strokes = (*old).clone();
    let bad = |reason: String| EditError::BadStroke { at: at.clone(), reason };
    let given = change(&mut strokes.0).map_err(bad)?;
    let strokes = values::fit(Type::Strokes, Value::Strokes(Arc::new(strokes)));
    let strokes = Setting::Known(strokes.map_err(bad)?);
    node_mut(document, node)?.inputs.insert(input.to_owned(), strokes);
    Ok(given)
}

#[cfg(test)]
mod tests {
    use super::super::testing::Random;
    use super::*;

    fn id(text: &str) -> NodeId {
        NodeId::new(text).unwrap()
    }
    fn socket(text: &str) -> Socket {
        text.parse().unwrap()
    }
    fn add(name: &str, kind: &str) -> Edit {
        let node = Node { kind: kind.to_owned(), ..Node::default() };
        Edit::AddNode { id: id(name), node: node.into(), at: None }
    }
    fn connect(from: &str, to: &str) -> Edit {
        Edit::Connect { from: socket(from), to: socket(to), at: None }
    }
    fn set(node: &str, input: &str, value: impl Into<Value>) -> Edit {
        let setting = Setting::Known(value.into());
        Edit::SetInput { node: id(node), input: input.to_owned(), setting }
    }
    fn resamples() -> Document {
        let mut document = Document::default();
        for name in ["a", "b", "c"] {
            add(name, "resample").apply(&mut document).unwrap();
        }
        connect("a.curves", "b.curves").apply(&mut document).unwrap();
        document
    }

    /// Applies an edit that must go through; its inverse must restore exactly, and the inverse of
    /// that redo.
    #[track_caller]
    fn there_and_back(document: &Document, edit: &Edit) -> Document {
        let mut after = document.clone();
        let inverse = edit.apply(&mut after).unwrap_or_else(|err| panic!("{edit:?}: {err}"));
        let mut back = after.clone();
        let redo = inverse.apply(&mut back).unwrap_or_else(|err| panic!("{inverse:?}: {err}"));
        assert_eq!(back, *document, "{edit:?}\n{inverse:?}");
        redo.apply(&mut back).unwrap();
        assert_eq!(back, after, "{edit:?}\n{redo:?}");
        after
    }
    #[track_caller]
    fn refused(document: &Document, edit: &Edit, why: &str) {
        let mut after = document.clone();
        assert_eq!(edit.apply(&mut after).unwrap_err().to_string(), why);
        assert_eq!(after, *document);
    }

    #[test]
    fn random_edits_restore_exactly_and_refused_ones_change_nothing() {
        let mut happened = 0;
        for seed in 0..60 {
            let mut random = Random::new(seed);
            let mut document = Document::default();
            for _ in 0..100 {
                let edit = random.edit(&document);
                let mut after = document.clone();
                match edit.apply(&mut after) {
                    Ok(_) => {
                        happened += 1;
                        document = there_and_back(&document, &edit);
                    }
                    Err(_) => assert_eq!(after, document, "{edit:?}"),
                }
                assert!(document.comments.keys().all(|place| document.has(place)));
                assert!(document.links.values().all(|from| !from.is_empty()));
                assert!(document.layout.keys().all(|id| document.nodes.contains_key(id)));
            }
        }
        assert!(happened > 2000, "only {happened} edits happened");
    }

    #[test]
    fn a_removed_node_comes_back_with_wires_in_order_place_display_and_comments() {
        let mut document = Document::default();
        for name in ["x", "y", "z"] {
            add(name, "resample").apply(&mut document).unwrap();
        }
        add("all", "of_tomorrow").apply(&mut document).unwrap();
        for from in ["x.curves", "y.curves", "z.curves"] {
            connect(from, "all.in").apply(&mut document).unwrap();
        }
        connect("x.curves", "y.curves").apply(&mut document).unwrap();
        Edit::Move { id: id("y"), to: Some(Point(1.0, 2.0)) }.apply(&mut document).unwrap();
        Edit::SetDisplay(Some(id("y"))).apply(&mut document).unwrap();
        set("y", "count", 9i64).apply(&mut document).unwrap();
        for place in [Place::Input(id("y"), "count".into()), Place::Link(socket("y.curves"))] {
            let lines = vec!["// why".to_owned()];
            Edit::SetComment { place, lines }.apply(&mut document).unwrap();
        }
        let after = there_and_back(&document, &Edit::RemoveNode { id: id("y") });
        assert_eq!(after.links[&socket("all.in")], [socket("x.curves"), socket("z.curves")]);
        assert_eq!((after.links.len(), after.display, after.comments.len()), (1, None, 0));
    }

    #[test]
    fn what_cannot_run_is_refused_with_the_reason() {
        let document = resamples();
        let check = |edit: Edit, why: &str| refused(&document, &edit, why);
        check(add("a", "resample"), "there is a node a already");
        check(set("x", "count", 3i64), "there is no node x");
        check(set("a", "cuont", 3i64), "a.cuont: resample has no such input; did you mean count?");
        check(
            set("a", "colour", 3i64),
            "a.colour: resample has no such input; it has curves, by, count, spacing",
        );
        check(set("a", "count", 0.5), "a.count: takes a whole number, not a number");
        check(set("a", "spacing", f32::NAN), "a.spacing: not a finite number");
        check(
            set("a", "by", "spcing"),
            "a.by: \"spcing\" is none of count, spacing; did you mean \"spacing\"?",
        );
        check(
            set("a", "curves", coif_nodes::data::curves::Curves::default()),
            "a.curves: curves come by wire: connect a node",
        );
        check(
            connect("b.curves", "a.curves"),
            "a.curves: a wire from b.curves would run in a circle: a feeds b; wire a node that does not hang from a",
        );
        check(
            connect("c.curves", "c.curves"),
            "c.curves: a wire from c.curves would feed the node with itself; wire a node that does not hang from c",
        );
        check(
            connect("a.curve", "c.curves"),
            "c.curves: a.curve is no output: resample gives curves; did you mean a.curves?",
        );
        check(
            connect("a.curves", "c.count"),
            "c.count: a.curves gives curves, whole number is taken; remove the wire and set a value",
        );
        check(
            connect("nix.curves", "c.curves"),
            "c.curves: there is no node nix to wire; remove the wire or add the node",
        );
        check(
            Edit::Disconnect { to: socket("b.curves"), at: 1 },
            "b.curves has no wire 1: its wires are numbered from 0, there are 1",
        );
        let point = Some(Point(f32::NAN, 0.0));
        check(
            Edit::Move { id: id("a"), to: point },
            "a: the place on the canvas is not a finite number",
        );
        let half = Edit::Several(vec![set("a", "count", 5i64), set("a", "count", 0.5)]);
        check(half, "a.count: takes a whole number, not a number");
        let lines = vec!["no slashes".to_owned()];
        check(
            Edit::SetComment { place: Place::Top, lines },
            "comments are single lines that begin with // and stand before an entry of the document",
        );
    }

    #[test]
    fn an_input_of_one_wire_takes_the_new_one_and_many_are_kept_in_order() {
        let document = resamples();
        let after = there_and_back(&document, &connect("c.curves", "b.curves"));
        assert_eq!(after.links[&socket("b.curves")], [socket("c.curves")]);
        let mut document = document;
        add("all", "of_tomorrow").apply(&mut document).unwrap();
        let first = Edit::Connect { from: socket("c.curves"), to: socket("all.in"), at: Some(0) };
        for edit in [connect("a.curves", "all.in"), connect("b.curves", "all.in"), first] {
            document = there_and_back(&document, &edit);
        }
        let reorder = Edit::Reorder { to: socket("all.in"), from: 0, at: 2 };
        let after = there_and_back(&document, &reorder);
        let order: Vec<&str> =
            after.links[&socket("all.in")].iter().map(|s| s.node.as_str()).collect();
        assert_eq!(order, ["a", "b", "c"]);
    }

    #[test]
    fn values_are_kept_in_one_form() {
        let mut document = resamples();
        set("a", "spacing", 2i64).apply(&mut document).unwrap();
        let two = Setting::Known(Value::Float(2.0));
        assert_eq!(document.node("a").unwrap().inputs["spacing"], two);
        add("new", "of_tomorrow").apply(&mut document).unwrap();
        set("new", "twist", 2i64).apply(&mut document).unwrap();
        assert_eq!(document.node("new").unwrap().inputs["twist"], Setting::Raw("2".into()));
    }

    #[test]
    fn strokes_are_added_changed_and_removed_one_by_one() {
        let mut random = Random::new(3);
        let mut document = Document::default();
        document.nodes.insert(id("pen"), random.stroke_node().into());
        let drawn = |random: &mut Random, others: &Strokes| {
            super::super::strokes::finish(&random.pen(40), others).unwrap()
        };
        let stroke = drawn(&mut random, &Strokes::default());
        let (node, input) = (id("pen"), "strokes".to_owned());
        let edit = Edit::AddStroke {
            node: node.clone(),
            input: input.clone(),
            at: 0,
            stroke: stroke.clone(),
        };
        let after = there_and_back(&document, &edit);
        refused(
            &after,
            &edit,
            &format!("pen.strokes: stroke 1: its id {} is 0 or used before", stroke.id),
        );
        let other = Stroke { id: stroke.id, ..drawn(&mut random, &Strokes::default()) };
        let edit = Edit::ReplaceStroke { node: node.clone(), input: input.clone(), stroke: other };
        let after = there_and_back(&after, &edit);
        let edit = Edit::RemoveStroke { node, input: input.clone(), id: stroke.id };
        assert_eq!(there_and_back(&after, &edit), document);
        add("plain", "resample").apply(&mut document).unwrap();
        let edit = Edit::AddStroke { node: id("plain"), input, at: 0, stroke };
        refused(&document, &edit, "plain.strokes holds no strokes");
    }

    #[test]
    fn a_node_added_where_dangling_wires_wait_leaves_them_when_taken_back() {
        let mut document = Document::default();
        let wires = Edit::SetWires { to: socket("b.curves"), from: vec![socket("a.curves")] };
        wires.apply(&mut document).unwrap();
        let after = there_and_back(&document, &add("a", "resample"));
        there_and_back(&after, &add("b", "resample"));
    }
}
