//! Which node takes the pen's gestures on hair, and where a new one goes.
//!
//! The pinned or active *Hair sketch*, else the one nearest upstream of what is displayed. Where there is none, the first touch
//! makes one: behind the guides or clusters that the displayed hair grows from, wired into all that took them, or on the bare
//! head, with nodes that fill it with hair. It is part of the touch's undo step. While the pen works on single strands
//! (`settings.pen.strands`) the sketch is one behind the hair itself, and a new one goes there.

use super::super::target;
use crate::core::shown::first_output;
use crate::core::state::State;
use crate::feeders::feeders;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_nodes::data::gestures::Gestures;
use coif_nodes::define::{Type, Value};
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

/// The kind of node that holds gestures.
pub(crate) const KIND: &str = "hair_sketch";
/// Its input for them, and that of the curves that it edits.
pub(crate) const GESTURES: &str = "gestures";
const CURVES: &str = "curves";
/// Displayed curves that grow from no others are edited themselves when there are no more of them than this.
const MOST: usize = 5000;
/// Strands are edited one by one when there are no more of them than this: each becomes a tuft of its own.
const MOST_STRANDS: usize = 200_000;

/// Whether a node is a sketch of what the pen works on: of strands, or of what they grow from.
struct Sketches<'a> {
    document: &'a Document,
    strands: bool,
    /// What hair grows from, and all before it; empty where what is displayed grows from nothing.
    below: BTreeSet<NodeId>,
}

impl<'a> Sketches<'a> {
    fn of(state: &'a State, displayed: &[NodeId]) -> Self {
        let document = &state.document;
        let grown = feeders(document, displayed);
        let below = upstream(document, grown.iter().map(|socket| &socket.node));
        let below = below.into_iter().chain(grown.iter().map(|socket| socket.node.clone()));
        Self { document, strands: state.settings.pen.strands, below: below.collect() }
    }
    fn has(&self, id: &NodeId) -> bool {
        let is_sketch = self.document.node(id.as_str()).is_some_and(|node| node.kind == KIND);
        let of_strands = !self.below.is_empty() && !self.below.contains(id);
        is_sketch && (self.below.is_empty() || of_strands == self.strands)
    }
}

/// The node that takes gestures; none where the first one will make it.
pub(crate) fn of(state: &State) -> Option<NodeId> {
    let document = &state.document;
    let displayed = displayed(state);
    let sketches = Sketches::of(state, &displayed);
    let chosen = [state.pinned.as_ref(), state.active()];
    let chosen = chosen.into_iter().flatten().find(|id| sketches.has(id));
    if let Some(chosen) = chosen {
        return Some(chosen.clone());
    }
    let mut open: VecDeque<NodeId> = displayed.into();
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop_front() {
        if sketches.has(&id) {
            return Some(id);
        }
        if seen.insert(id.clone()) {
            let up = document.links.iter().filter(|(to, _)| to.node == id);
            open.extend(up.flat_map(|(_, from)| from.iter().map(|from| from.node.clone())));
        }
    }
    None
}

/// The nodes that are displayed.
fn displayed(state: &State) -> Vec<NodeId> {
    match (&state.document.display, &state.shown) {
        (Some(id), _) => vec![id.clone()],
        (None, Some(shown)) => shown.sockets.iter().map(|socket| socket.node.clone()).collect(),
        (None, None) => vec![],
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
    let displayed = displayed(state);
    let way = upstream(document, displayed.iter());
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
    match of(state) {
        Some(node) => {
            let mut wanted = vec![output(&node)];
            wanted.extend(came_in(&state.document, &node));
            wanted
        }
        None => sources(state),
    }
}

/// The gestures that a node holds; none where it holds none or what it holds is not understood.
pub(crate) fn gestures(document: &Document, id: &NodeId) -> Arc<Gestures> {
    match document.node(id.as_str()).and_then(|node| node.inputs.get(GESTURES)) {
        Some(Setting::Known(Value::Gestures(gestures))) => gestures.clone(),
        _ => Arc::default(),
    }
}

/// A number that a node is set to; its default where it is set to none.
pub(crate) fn number(document: &Document, id: Option<&NodeId>, input: &str) -> f32 {
    let known = |value: &Value| if let Value::Float(x) = value { Some(*x) } else { None };
    let node = id.and_then(|id| document.node(id.as_str()));
    let set = node.and_then(|node| match node.inputs.get(input) {
        Some(Setting::Known(value)) => known(value),
        _ => None,
    });
    let usual = || {
        let (at, _) = coif_nodes::by_id(KIND)?.input(input)?;
        known(&coif_nodes::by_id(KIND)?.inputs[at].default()?)
    };
    set.or_else(usual).unwrap_or_default()
}

/// The edits that make a node for gestures behind an output, or on the bare head, and its id. None where there is no head.
pub(crate) fn make(document: &Document, after: Option<&Socket>) -> Option<(NodeId, Vec<Edit>)> {
    // Sections of the head come along with the hair that stands on it.
    let own = after.and_then(|after| document.wires(&after.node, "scalp").first().cloned());
    let scalp = own.or_else(|| Some(Socket::new(target::head(document)?, "scalp")))?;
    let id = document.free_id(KIND);
    let node = Arc::new(document.fresh_node(KIND, &id));
    let beside = after.map_or(&scalp.node, |after| &after.node);
    let at = Some(target::place_beside(document, beside, 1.0));
    let mut edits = vec![
        Edit::AddNode { id: id.clone(), node, at },
        Edit::Connect { from: scalp, to: Socket::new(id.clone(), "scalp"), at: None },
    ];
    if let Some(after) = after {
        let to = Socket::new(id.clone(), CURVES);
        for (to, from) in &document.links {
            if from.contains(after) {
                let swap = |from: &Socket| if from == after { output(&id) } else { from.clone() };
                let from = from.iter().map(swap).collect();
                edits.push(Edit::SetWires { to: to.clone(), from });
            }
        }
        edits.push(Edit::Connect { from: after.clone(), to, at: None });
    }
    // What stands behind it goes on being seen: only where the hair that it edits is what is displayed, or nothing is, it takes the
    // display along.
    let shown = document.display.as_ref();
    let takes = after.is_none_or(|after| shown == Some(&after.node));
    if takes {
        edits.push(Edit::SetDisplay(Some(id.clone())));
    }
    Some((id, edits))
}
