//! Which *Paint mask* the pen works on, and where a new one goes.
//!
//! The pinned or active one, else the one nearest upstream of what is displayed, else the first. Where there is none the first
//! touch makes one beside the head, wired to the scalp that the displayed hair stands on (parted, where it is) and into nothing.

use super::super::target;
use crate::core::shown::displayed;
use crate::core::state::State;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::data::field::Field;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::Value;
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

/// The kind of node that holds what is painted.
pub(crate) const KIND: &str = "paint_mask";
/// Its input for strokes.
pub(crate) const STROKES: &str = "strokes";
const SCALP: &str = "scalp";

fn is_mask(document: &Document, id: &NodeId) -> bool {
    document.node(id.as_str()).is_some_and(|node| node.kind == KIND)
}

/// Nodes from what is displayed upstream, the nearest first.
fn upstream(document: &Document) -> Vec<NodeId> {
    let mut open: VecDeque<NodeId> = displayed(document).into_iter().map(|s| s.node).collect();
    let (mut seen, mut found) = (BTreeSet::new(), vec![]);
    while let Some(id) = open.pop_front() {
        if seen.insert(id.clone()) {
            let up = document.links.iter().filter(|(to, _)| to.node == id);
            open.extend(up.flat_map(|(_, from)| from.iter().map(|from| from.node.clone())));
            found.push(id);
        }
    }
    found
}

/// The node that is painted on; none where the first touch will make it.
pub(crate) fn of(state: &State) -> Option<NodeId> {
    let document = &state.document;
    let chosen = [state.pinned.as_ref(), state.active()].into_iter().flatten().cloned();
    let mut all = chosen.chain(upstream(document)).chain(document.nodes.keys().cloned());
    all.find(|id| is_mask(document, id))
}

/// Its output.
pub(crate) fn output(node: &NodeId) -> Socket {
    Socket::new(node.clone(), "mask")
}

/// What it is painted on: the scalp wired to it, or the one that a new node will have.
fn source(document: &Document, node: Option<&NodeId>) -> Option<Socket> {
    if let Some(wired) = node.and_then(|node| document.wires(node, SCALP).first()) {
        return Some(wired.clone());
    }
    let up = upstream(document);
    let parted =
        up.iter().find(|id| document.node(id.as_str()).is_some_and(|n| n.kind == "partings"));
    let wired = || up.iter().find_map(|id| document.wires(id, SCALP).first().cloned());
    let parted = parted.map(|id| Socket::new(id.clone(), SCALP));
    parted.or_else(wired).or_else(|| Some(Socket::new(target::head(document)?, SCALP)))
}

/// The outputs that the pen must see while it paints.
pub(crate) fn wanted(state: &State) -> Vec<Socket> {
    let node = of(state);
    let own = node.as_ref().map(output);
    own.into_iter().chain(source(&state.document, node.as_ref())).collect()
}

/// The scalp that is painted on, once it is known.
pub(crate) fn scalp<'a>(state: &'a State, node: Option<&NodeId>) -> Option<&'a Arc<Scalp>> {
    let socket = source(&state.document, node)?;
    match state.shown.as_ref()?.values.get(&socket)? {
        Value::Scalp(scalp) => Some(scalp),
        _ => None,
    }
}

/// What a node gives, once it is known.
pub(crate) fn field(state: &State, node: &NodeId) -> Option<Arc<Field>> {
    match state.shown.as_ref()?.values.get(&output(node))? {
        Value::Field(field) => Some(field.clone()),
        _ => None,
    }
}

/// The strokes that a node holds.
pub(crate) fn strokes(document: &Document, id: &NodeId) -> Arc<Strokes> {
    if is_mask(document, id) { target::strokes(document, id) } else { Arc::default() }
}

/// The edits that make a node to paint on, and its id. None where there is no head.
pub(crate) fn make(state: &State) -> Option<(NodeId, Vec<Edit>)> {
    let document = &state.document;
    let scalp = source(document, None)?;
    let id = document.free_id(KIND);
    let node = Arc::new(document.fresh_node(KIND, &id));
    let at = Some(target::place_beside(document, &scalp.node, 1.0));
    let mut edits = vec![
        Edit::AddNode { id: id.clone(), node, at },
        Edit::Connect { from: scalp, to: Socket::new(id.clone(), SCALP), at: None },
    ];
    // What nothing reads is displayed where nothing else is: what was displayed stays so.
    if document.display.is_none() {
        let shown = displayed(document);
        let hair =
            |s: &Socket| document.node(s.node.as_str()).is_some_and(|n| n.kind != "groom_output");
        if let [only] = &shown[..]
            && hair(only)
        {
            edits.push(Edit::SetDisplay(Some(only.node.clone())));
        }
    }
    Some((id, edits))
}
