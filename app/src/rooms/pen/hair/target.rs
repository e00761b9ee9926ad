//! Which *Hair sketch* takes the pen's gestures, and where a new one goes.
//!
//! It is one of what the displayed hair grows from, or, while the pen works on single strands (`settings.pen.strands`), one behind the
//! hair itself. Where there is none, the first touch makes one: behind the guides or clusters that the displayed hair grows from,
//! wired into all that took them, or on the bare head, with nodes that fill it with hair. It is part of the touch's undo step.

use super::super::target::{self, Fills};
use crate::core::shown::{displayed, first_output};
use crate::core::state::State;
use crate::feeders::feeders;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::data::curves::Curves;
use coif_nodes::define::Type;
use std::collections::BTreeSet;

/// The kind of node that holds gestures.
pub(crate) const KIND: &str = "hair_sketch";
/// The curves that it edits, and gives.
const CURVES: &str = "curves";
/// Displayed curves that grow from no others are edited themselves when there are no more of them than this.
const MOST: usize = 5000;
/// Strands are edited one by one when there are no more of them than this: each becomes a tuft of its own.
const MOST_STRANDS: usize = 200_000;

/// Which sketches are of what the pen works on: of strands, or of what they grow from.
pub(in super::super) struct Sketches {
    strands: bool,
    /// What hair grows from, and all before it; empty where what is displayed grows from nothing.
    below: BTreeSet<NodeId>,
}

impl Sketches {
    pub(in super::super) fn of(state: &State, displayed: &[NodeId]) -> Self {
        let grown = feeders(&state.document, displayed);
        let below = upstream(&state.document, grown.iter().map(|socket| &socket.node));
        Self { strands: state.settings.pen.strands, below }
    }
    pub(in super::super) fn has(&self, id: &NodeId) -> bool {
        self.below.is_empty() || self.below.contains(id) != self.strands
    }
}

/// The output of a node that takes gestures.
pub(crate) fn output(node: &NodeId) -> Socket {
    Socket::new(node.clone(), CURVES)
}

/// What a node that takes gestures edits.
pub(crate) fn came_in(document: &Document, node: &NodeId) -> Option<Socket> {
    document.wires(node, CURVES).first().cloned()
}

/// Outputs behind which a new node may go: what the displayed hair grows from.
pub(crate) fn sources(state: &State) -> Vec<Socket> {
    let document = &state.document;
    let displayed: Vec<NodeId> = displayed(document).into_iter().map(|shown| shown.node).collect();
    let way = upstream(document, &displayed);
    let taken = |socket: &Socket| {
        let mut wires = document.links.iter();
        wires.any(|(to, from)| way.contains(&to.node) && from.contains(socket))
    };
    let grown: Vec<Socket> = feeders(document, &displayed).into_iter().filter(taken).collect();
    let strands = state.settings.pen.strands;
    if !grown.is_empty() && !strands {
        return grown;
    }
    let most = if strands { MOST_STRANDS } else { MOST };
    let few = state.shown.as_ref().is_none_or(|shown| shown.curves.curve_count() <= most);
    let is_end =
        |id: &NodeId| document.node(id.as_str()).is_some_and(|node| node.kind == "groom_output");
    let own = displayed.iter().flat_map(|id| match first_output(document, id) {
        Some(socket) if !is_end(id) => vec![socket],
        // Behind an end nothing takes what it gives.
        _ => document.wires(id, CURVES).to_vec(),
    });
    own.filter(|socket| few && output_type(document, socket) == Some(Type::Curves)).collect()
}

fn output_type(document: &Document, socket: &Socket) -> Option<Type> {
    let def = document.def(&socket.node)?;
    def.outputs.iter().find(|output| *output.name == *socket.name).map(|output| output.ty)
}

/// The outputs that the pen must see while it works on hair.
pub(crate) fn wanted(state: &State) -> Vec<Socket> {
    match target::of(state, Fills::Hair) {
        Some(node) => [output(&node)].into_iter().chain(came_in(&state.document, &node)).collect(),
        None => sources(state),
    }
}

/// The curves that the pen works on now.
pub(super) fn curves(state: &State, node: Option<&NodeId>) -> Option<Curves> {
    let shown = state.shown.as_ref()?;
    let sockets = node.map_or_else(|| sources(state), |node| vec![output(node)]);
    sockets.iter().find_map(|socket| shown.curves_of(socket)).cloned()
}

/// The edits that make a node for gestures behind an output, and its id. None where there is no head.
pub(crate) fn make(document: &Document, after: &Socket) -> Option<(NodeId, Vec<Edit>)> {
    // Sections of the head come along with the hair that stands on it.
    let own = document.wires(&after.node, "scalp").first().cloned();
    let scalp = own.or_else(|| Some(Socket::new(target::head(document)?, "scalp")))?;
    let id = document.free_id(KIND);
    let node = document.fresh_node(KIND, &id);
    let mut edits = target::put(&id, node, &after.node, scalp, document);
    let swap = |from: &Socket| if from == after { output(&id) } else { from.clone() };
    let taken = document.links.iter().filter(|(_, from)| from.contains(after));
    edits.extend(taken.map(|(to, from)| {
        let from = from.iter().map(swap).collect();
        Edit::SetWires { to: to.clone(), from }
    }));
    let to = Socket::new(id.clone(), CURVES);
    edits.push(Edit::Connect { from: after.clone(), to, at: None });
    // What stands behind it goes on being seen: only where the hair that it edits is what is displayed, it takes the display along.
    let takes = document.display.as_ref() == Some(&after.node);
    edits.extend(takes.then(|| Edit::SetDisplay(Some(id.clone()))));
    Some((id, edits))
}
