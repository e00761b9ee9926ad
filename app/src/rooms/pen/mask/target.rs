//! What is painted on, and where a new *Paint mask* goes: beside the head, wired to the scalp that the selected or else the displayed
//! hair stands on (parted, where it is; never that of a region, whose masks are those of its head) and into nothing.

use super::super::target::{self, Fills};
use crate::core::shown::displayed;
use crate::core::state::State;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Socket};
use coif_nodes::data::field::Field;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use std::sync::Arc;

/// The kind of node that holds what is painted.
pub(crate) const KIND: &str = "paint_mask";
const SCALP: &str = "scalp";

/// Its output.
pub(crate) fn output(node: &NodeId) -> Socket {
    Socket::new(node.clone(), "mask")
}

/// What it is painted on: the scalp wired to it, or the one that a new node will have.
fn source(state: &State, node: Option<&NodeId>) -> Option<Socket> {
    let document = &state.document;
    let is_parted =
        |id: &NodeId| document.node(id.as_str()).is_some_and(|node| node.kind == "partings");
    let wired = |id: &NodeId| document.wires(id, SCALP).first().cloned();
    let behind_regions = |socket: Socket| {
        std::iter::successors(Some(socket), |socket| wired(&socket.node))
            .find(|socket| !target::is_region(document, &socket.node))
    };
    let under = |from: Vec<NodeId>| {
        let up = || target::by_wires(document, from.clone(), false);
        let parted = up().find(is_parted).map(|id| Socket::new(id, SCALP));
        parted.or_else(|| up().find_map(|id| behind_regions(wired(&id)?)))
    };
    node.and_then(wired)
        .or_else(|| under(vec![state.active()?.clone()]))
        .or_else(|| under(displayed(document).into_iter().map(|socket| socket.node).collect()))
        .or_else(|| Some(Socket::new(target::head(document)?, SCALP)))
}

/// The outputs that the pen must see while it paints.
pub(crate) fn wanted(state: &State) -> Vec<Socket> {
    let node = target::of(state, Fills::Mask);
    let own = node.as_ref().map(output);
    own.into_iter().chain(source(state, node.as_ref())).collect()
}

/// The scalp that is painted on, once it is known.
pub(crate) fn scalp<'a>(state: &'a State, node: Option<&NodeId>) -> Option<&'a Arc<Scalp>> {
    let socket = source(state, node)?;
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

/// The edits that make a node to paint on, and its id. None where there is no head.
pub(crate) fn make(state: &State) -> Option<(NodeId, Vec<Edit>)> {
    let document = &state.document;
    let scalp = source(state, None)?;
    let id = document.free_id(KIND);
    let beside = scalp.node.clone();
    let mut edits = target::put(&id, document.fresh_node(KIND, &id), &beside, scalp, document);
    // What nothing reads is displayed where nothing else is: what was displayed stays so.
    let shown = displayed(document);
    let hair =
        |s: &Socket| document.node(s.node.as_str()).is_some_and(|n| n.kind != "groom_output");
    let only = shown.first().filter(|only| shown.len() == 1 && hair(only));
    let only = only.filter(|_| document.display.is_none()).map(|only| only.node.clone());
    edits.extend(only.map(|only| Edit::SetDisplay(Some(only))));
    Some((id, edits))
}
