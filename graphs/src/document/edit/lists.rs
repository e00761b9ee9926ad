//! One stroke or gesture of an input added, removed or changed: the list keeps its other items.

use super::{Edit, EditError, node_mut, slot};
use crate::document::{Document, NodeId, Setting, Socket};
use crate::values;
use coif_nodes::data::gestures::{Gesture, Gestures};
use coif_nodes::data::strokes::{Stroke, Strokes};
use coif_nodes::define::{Type, Value};

/// What inputs hold lists of.
pub(super) trait Item: Clone {
    const TYPE: Type;
    /// One of it in messages.
    const NAME: &'static str;
    fn id(&self) -> u64;
    fn all(value: &Value) -> Option<&[Self]>;
    fn value(all: Vec<Self>) -> Value;
    fn add(node: NodeId, input: String, at: usize, item: Self) -> Edit;
    fn remove(node: NodeId, input: String, id: u64) -> Edit;
    fn replace(node: NodeId, input: String, item: Self) -> Edit;
}

impl Item for Stroke {
    const TYPE: Type = Type::Strokes;
    const NAME: &'static str = "stroke";
    fn id(&self) -> u64 {
        self.id
    }
    fn all(value: &Value) -> Option<&[Self]> {
        if let Value::Strokes(all) = value { Some(&all.0) } else { None }
    }
    fn value(all: Vec<Self>) -> Value {
        Strokes(all).into()
    }
    fn add(node: NodeId, input: String, at: usize, stroke: Self) -> Edit {
        Edit::AddStroke { node, input, at, stroke }
    }
    fn remove(node: NodeId, input: String, id: u64) -> Edit {
        Edit::RemoveStroke { node, input, id }
    }
    fn replace(node: NodeId, input: String, stroke: Self) -> Edit {
        Edit::ReplaceStroke { node, input, stroke }
    }
}

impl Item for Gesture {
    const TYPE: Type = Type::Gestures;
    const NAME: &'static str = "gesture";
    fn id(&self) -> u64 {
        self.id
    }
    fn all(value: &Value) -> Option<&[Self]> {
        if let Value::Gestures(all) = value { Some(&all.0) } else { None }
    }
    fn value(all: Vec<Self>) -> Value {
        Gestures(all).into()
    }
    fn add(node: NodeId, input: String, at: usize, gesture: Self) -> Edit {
        Edit::AddGesture { node, input, at, gesture }
    }
    fn remove(node: NodeId, input: String, id: u64) -> Edit {
        Edit::RemoveGesture { node, input, id }
    }
    fn replace(node: NodeId, input: String, gesture: Self) -> Edit {
        Edit::ReplaceGesture { node, input, gesture }
    }
}

/// Adds an item; behind all when its number is past the end. Gives the inverse, as the others do.
pub(super) fn add<T: Item>(
    document: &mut Document,
    (node, input): (&NodeId, &str),
    at: usize,
    item: &T,
) -> Result<Edit, EditError> {
    let was_set = slot(document, node)?.inputs.contains_key(input);
    on_list(document, (node, input), |list| {
        list.insert(at.min(list.len()), item.clone());
        Ok(())
    })?;
    let (node, input) = (node.clone(), input.to_owned());
    Ok(if was_set { T::remove(node, input, item.id()) } else { Edit::UnsetInput { node, input } })
}

/// Removes the item of that id.
pub(super) fn remove<T: Item>(
    document: &mut Document,
    (node, input): (&NodeId, &str),
    id: u64,
) -> Result<Edit, EditError> {
    let (at, item) = on_list(document, (node, input), |list: &mut Vec<T>| {
        let at = find(list, id)?;
        Ok((at, list.remove(at)))
    })?;
    Ok(T::add(node.clone(), input.to_owned(), at, item))
}

/// Puts another form of an item in the place of that with its id.
pub(super) fn replace<T: Item>(
    document: &mut Document,
    (node, input): (&NodeId, &str),
    item: &T,
) -> Result<Edit, EditError> {
    let old = on_list(document, (node, input), |list| {
        let at = find(list, item.id())?;
        Ok(std::mem::replace(&mut list[at], item.clone()))
    })?;
    Ok(T::replace(node.clone(), input.to_owned(), old))
}

fn find<T: Item>(list: &[T], id: u64) -> Result<usize, String> {
    let at = list.iter().position(|item| item.id() == id);
    at.ok_or_else(|| format!("there is no {} {id}", T::NAME))
}

/// Changes the list of an input. It is copied, because snapshots hold the old one: some 20 bytes a
/// sample.
fn on_list<T: Item, R>(
    document: &mut Document,
    (node, input): (&NodeId, &str),
    change: impl FnOnce(&mut Vec<T>) -> Result<R, String>,
) -> Result<R, EditError> {
    let at = Socket::new(node.clone(), input);
    let def = document.def(node).and_then(|def| def.input(input));
    let takes = def.is_some_and(|(_, def)| def.ty == T::TYPE);
    let held = match slot(document, node)?.inputs.get(input) {
        Some(Setting::Known(value)) => T::all(value).map(<[T]>::to_vec),
        Some(Setting::Raw(_)) => None,
        None => takes.then(Vec::new),
    };
    let Some(mut list) = held else {
        return Err(EditError::NoList { at, what: T::TYPE.name() });
    };
    let bad = |reason: String| EditError::BadItem { at: at.clone(), reason };
    let given = change(&mut list).map_err(bad)?;
    let list = values::fit(T::TYPE, T::value(list)).map_err(bad)?;
    node_mut(document, node)?.inputs.insert(input.to_owned(), Setting::Known(list));
    Ok(given)
}
