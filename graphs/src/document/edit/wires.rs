//! Changes of wires, with the bends that belong to them.
//!
//! Bends follow their wire: through insertion, reordering and renaming of its input. They go when
//! the wire goes, and what takes a change back brings them back with it.

use super::{Document, Edit, EditError, NodeId, Point, Socket, graph, present_socket, slot};

/// Removes a node with everything that hangs from it.
pub(super) fn remove_node(document: &mut Document, id: &NodeId) -> Result<Edit, EditError> {
    slot(document, id)?;
    let mut undo = vec![];
    for to in wired_with(document, id) {
        let (mut wires, mut bends) = (vec![], vec![]);
        for (wire, bent) in document.links[&to].iter().zip(bends_of(document, &to)) {
            if to.node != *id && wire.node != *id {
                wires.push(wire.clone());
                bends.push(bent);
            }
        }
        undo.push(set_wires(document, &to, wires, bends));
    }
    if document.display.as_ref() == Some(id) {
        undo.push(Edit::SetDisplay(document.display.take()));
    }
    if document.collapsed.remove(id) {
        undo.push(Edit::SetCollapsed { id: id.clone(), collapsed: true });
    }
    let at = document.layout.remove(id);
    if let Some(node) = document.nodes.remove(id) {
        undo.insert(0, Edit::AddNode { id: id.clone(), node, at });
    }
    Ok(Edit::Several(undo))
}

/// The wired inputs of a node and those that take from it.
pub(super) fn wired_with(document: &Document, id: &NodeId) -> Vec<Socket> {
    let links = document.links.iter();
    links
        .filter(|(to, from)| to.node == *id || from.iter().any(|from| from.node == *id))
        .map(|(to, _)| to.clone())
        .collect()
}

/// The wires of an input that has one of number `at`, and their bends.
pub(super) fn wires(
    document: &Document,
    to: &Socket,
    at: usize,
) -> Result<(Vec<Socket>, Vec<Vec<Point>>), EditError> {
    let wires = document.links.get(to).cloned().unwrap_or_default();
    if at >= wires.len() {
        return Err(EditError::NoWire { to: to.clone(), at, count: wires.len() });
    }
    Ok((wires, bends_of(document, to)))
}

/// The bends of each wire of an input.
pub(super) fn bends_of(document: &Document, to: &Socket) -> Vec<Vec<Point>> {
    let mut bends = document.bends.get(to).cloned().unwrap_or_default();
    bends.resize(document.links.get(to).map_or(0, Vec::len), vec![]);
    bends
}

/// The bends that wires keep when an input is given other ones: a wire of the same output is the
/// same wire.
pub(super) fn kept_bends(document: &Document, to: &Socket, wires: &[Socket]) -> Vec<Vec<Point>> {
    let mut bends = bends_of(document, to);
    if !document.bends.contains_key(to) {
        return vec![];
    }
    let mut old: Vec<Option<&Socket>> = document.links[to].iter().map(Some).collect();
    let mut keep = |wire: &Socket| {
        let at = old.iter().position(|old| *old == Some(wire))?;
        old[at] = None;
        Some(std::mem::take(&mut bends[at]))
    };
    wires.iter().map(|wire| keep(wire).unwrap_or_default()).collect()
}

/// What gives an input the wires and the bends that it has now, whatever it has then.
pub(super) fn restoring(document: &Document, to: &Socket) -> Vec<Edit> {
    let from = document.links.get(to).cloned().unwrap_or_default();
    let bends = bends_of(document, to).into_iter().enumerate();
    let bends = bends.map(|(at, bends)| Edit::SetBends { to: to.clone(), at, bends });
    [Edit::SetWires { to: to.clone(), from }].into_iter().chain(bends).collect()
}

/// Gives an input exactly these wires and bends; gives the inverse.
pub(super) fn set_wires(
    document: &mut Document,
    to: &Socket,
    wires: Vec<Socket>,
    bends: Vec<Vec<Point>>,
) -> Edit {
    let mut undo = restoring(document, to);
    let was_bent = document.bends.contains_key(to);
    document.set_all_bends(to, bends);
    if wires.is_empty() {
        document.links.remove(to);
    } else {
        document.links.insert(to.clone(), wires);
    }
    if !was_bent && !document.bends.contains_key(to) {
        undo.truncate(1);
    }
    one(undo)
}

/// Moves wires that end at a node's inputs under old names to the present ones, where these are free;
/// gives what moves them back. Needed where a node gets a kind that wires did not know.
pub(super) fn settle_names(document: &mut Document, id: &NodeId) -> Vec<Edit> {
    let wired: Vec<Socket> = graph::inputs_of(document, id).map(|(to, _)| to.clone()).collect();
    let mut undo = vec![];
    for old in wired {
        let new = present_socket(document, &old);
        if new == old {
            continue;
        }
        let (from, bends) = (document.links[&old].clone(), bends_of(document, &old));
        let back = set_wires(document, &old, vec![], vec![]);
        if !document.links.contains_key(&new) {
            undo.push(set_wires(document, &new, from, bends));
        }
        undo.push(back);
    }
    undo
}

/// One edit for all.
pub(super) fn one(mut edits: Vec<Edit>) -> Edit {
    if edits.len() == 1 { edits.remove(0) } else { Edit::Several(edits) }
}
