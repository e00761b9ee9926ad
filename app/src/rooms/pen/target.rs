//! Which node the pen works on, and what a new one looks like.
//!
//! The pinned node, else the active one, else the one nearest to what is displayed along the wires. Where the document
//! has none, drawing makes one: wired to the head, seeded, beside the head on the canvas, as part of the stroke's undo
//! step.

use crate::core::faces::arrange::free_in;
use crate::core::shown::displayed;
use crate::core::state::State;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::free_seed;
pub(super) use coif_graphs::document::graph::{HEAD, head_at_hand as head};
use coif_graphs::document::{Document, Node, NodeId, Point, Setting, Socket};
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::{Type, Value};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// The kind of node that drawing makes.
pub(super) const KIND: &str = "stroke_input";
/// Free space between nodes that are placed here, in units of the canvas.
pub(super) const STEP: Point = Point(260.0, 140.0);

/// The input of a kind of node that holds strokes.
pub(crate) fn strokes_input(kind: &str) -> Option<&'static str> {
    let def = coif_nodes::by_id(kind)?;
    def.inputs.iter().find(|input| input.ty == Type::Strokes).map(|input| input.name)
}

/// (What is painted is no lines: it has tools of its own.)
fn holds_strokes(document: &Document, id: &NodeId) -> bool {
    let node = document.node(id.as_str()).filter(|node| node.kind != super::mask::target::KIND);
    node.is_some_and(|node| strokes_input(&node.kind).is_some())
}

/// Whether strokes of a node become curves. A head holds strokes, too, its hairline; the pen works on them only when
/// that is asked for by pinning the head.
pub(crate) fn draws_curves(document: &Document, id: &NodeId) -> bool {
    let kind = document.node(id.as_str()).map(|node| node.kind.as_str());
    let def = kind.and_then(coif_nodes::by_id);
    let gives = def.is_some_and(|def| def.outputs.iter().any(|output| output.ty == Type::Curves));
    gives && holds_strokes(document, id)
}

/// The node that the pen works on; none where the document has no node whose strokes become curves.
pub(crate) fn of(state: &State) -> Option<NodeId> {
    let document = &state.document;
    let pinned = state.pinned.as_ref().filter(|id| holds_strokes(document, id));
    let chosen = pinned.or_else(|| state.active().filter(|id| draws_curves(document, id)));
    chosen.cloned().or_else(|| nearest(document))
}

/// The node with strokes that is fewest wires away from the displayed one; the first by id where nothing leads there.
fn nearest(document: &Document) -> Option<NodeId> {
    let mut seen = BTreeSet::new();
    let mut open: VecDeque<NodeId> = document.display.iter().cloned().collect();
    while let Some(id) = open.pop_front() {
        if !seen.insert(id.clone()) {
            continue;
        }
        if draws_curves(document, &id) {
            return Some(id);
        }
        // Upstream first: what feeds the picture is nearer than what is made of it.
        let wires = || document.links.iter();
        let up = wires().filter(|(to, _)| to.node == id).flat_map(|(_, from)| from);
        let down = wires().filter(|(_, from)| from.iter().any(|from| from.node == id));
        open.extend(up.map(|from| from.node.clone()).chain(down.map(|(to, _)| to.node.clone())));
    }
    document.nodes.keys().find(|id| draws_curves(document, id)).cloned()
}

/// The strokes that a node holds; none where it holds none or what it holds is not understood.
pub(crate) fn strokes(document: &Document, id: &NodeId) -> Arc<Strokes> {
    let node = document.node(id.as_str());
    let held = node.and_then(|node| node.inputs.get(strokes_input(&node.kind)?));
    match held {
        Some(Setting::Known(Value::Strokes(strokes))) => strokes.clone(),
        _ => Arc::default(),
    }
}

/// A word that a node's choice is set to, or its default.
pub(crate) fn choice(document: &Document, id: &NodeId, input: &str) -> Option<String> {
    let node = document.node(id.as_str())?;
    let word = |value: &Value| match value {
        Value::Text(word) => Some(word.to_string()),
        _ => None,
    };
    match node.inputs.get(input) {
        Some(Setting::Known(value)) => word(value),
        Some(Setting::Raw(_)) => None,
        None => {
            let def = coif_nodes::by_id(&node.kind)?;
            let (_, input) = def.input(input)?;
            input.default().and_then(|default| word(&default))
        }
    }
}

/// A free place on the canvas, `right` columns beside a node.
pub(crate) fn place_beside(document: &Document, id: &NodeId, right: f32) -> Point {
    let Point(x, y) = document.layout.get(id).copied().unwrap_or_default();
    free_in(document, Point(x + STEP.0 * right, y), STEP)
}

/// How a new node holds strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fresh {
    /// In space instead of on the scalp.
    pub(crate) free: bool,
    /// On both sides of the head.
    pub(crate) mirror: bool,
}

/// The edits that make a node for strokes, and its id. None where the document has no head.
///
/// Where nothing but the head is displayed, the new node is, or nobody would see what was drawn.
pub(crate) fn make(document: &Document, fresh: Fresh) -> Option<(NodeId, Vec<Edit>)> {
    let head = head(document)?;
    let id = document.free_id("strokes");
    let seed = Setting::Known(Value::Int(free_seed(document)));
    let mut inputs = BTreeMap::from([("seed".to_owned(), seed)]);
    let mut choose = |input: &str, word: &str| {
        inputs.insert(input.to_owned(), Setting::Known(Value::Text(word.into())));
    };
    if fresh.free {
        choose("project", "free");
    }
    if fresh.mirror {
        choose("mirror", "both");
    }
    let node = Node { kind: KIND.to_owned(), inputs, ..Node::default() };
    let mut edits = vec![
        Edit::AddNode {
            id: id.clone(),
            node: Arc::new(node),
            at: Some(place_beside(document, &head, 1.0)),
        },
        Edit::Connect {
            from: Socket::new(head.clone(), "scalp"),
            to: Socket::new(id.clone(), "scalp"),
            at: None,
        },
    ];
    let shows_hair = displayed(document).iter().any(|socket| socket.node != head);
    if !shows_hair {
        edits.push(Edit::SetDisplay(Some(id.clone())));
    }
    Some((id, edits))
}
