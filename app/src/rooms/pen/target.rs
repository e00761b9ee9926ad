//! Which node the pen fills, and what a new one looks like.
//!
//! What can be filled is told by the declaration of a node's inputs ([`filled`]). Of the nodes that a tool can fill it is the pinned
//! one, else the active one, else the nearest to what is displayed along the wires, else any; hair is sketched on nothing but what
//! is displayed. Where there is none, the first touch makes one: wired to the head, beside it on the canvas, as part of the touch's
//! undo step.

use super::{hair, mask};
use crate::core::faces::arrange::free_in;
use crate::core::shown::displayed;
use crate::core::state::State;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::graph::free_seed;
pub(super) use coif_graphs::document::graph::{HEAD, head_at_hand as head};
use coif_graphs::document::{Document, Node, NodeId, Point, Setting, Socket};
use coif_nodes::data::gestures::Gestures;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::{Type, Value};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// The kind of node that drawing makes.
pub(super) const KIND: &str = "stroke_input";
/// Free space between nodes that are placed here, in units of the canvas.
pub(super) const STEP: Point = Point(260.0, 140.0);

/// What tools fill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fills {
    /// Lines.
    Strokes,
    /// Gestures on hair.
    Hair,
    /// Strokes with brushes.
    Mask,
}

impl Fills {
    /// The kind of node that the first touch makes.
    pub(super) fn kind(self) -> &'static str {
        match self {
            Self::Strokes => KIND,
            Self::Hair => hair::target::KIND,
            Self::Mask => mask::target::KIND,
        }
    }
}

/// What the pen fills of a kind of node, and by which input.
pub(crate) fn filled(kind: &str) -> Option<(Fills, &'static str)> {
    let fills = |ty: Type| match ty {
        Type::Strokes if kind == mask::target::KIND => Some(Fills::Mask),
        Type::Strokes => Some(Fills::Strokes),
        Type::Gestures => Some(Fills::Hair),
        _ => None,
    };
    let def = coif_nodes::by_id(kind)?;
    def.inputs.iter().find_map(|input| Some((fills(input.ty)?, input.name)))
}

/// The input of a kind of node that holds strokes.
pub(crate) fn strokes_input(kind: &str) -> Option<&'static str> {
    filled(kind).filter(|(fills, _)| *fills != Fills::Hair).map(|(_, input)| input)
}

/// The input of a node that is filled, also of one that is still to be made.
pub(super) fn input(document: &Document, id: &NodeId, fills: Fills) -> &'static str {
    let kind = document.node(id.as_str()).map_or(fills.kind(), |node| &node.kind);
    filled(kind).map_or("", |(_, input)| input)
}

/// The node that a tool fills; none where the first touch will make it.
pub(crate) fn of(state: &State, fills: Fills) -> Option<NodeId> {
    let (document, strokes) = (&state.document, fills == Fills::Strokes);
    let shown = || displayed(document).into_iter().map(|shown| shown.node).collect::<Vec<_>>();
    let sketches = (fills == Fills::Hair).then(|| hair::target::Sketches::of(state, &shown()));
    let holds = |id: &NodeId| {
        let kind = document.node(id.as_str()).map_or("", |node| &node.kind);
        filled(kind).is_some_and(|(own, _)| own == fills)
    };
    // Outlines of regions are strokes, too: those of a head are drawn only when that is asked for by pinning it.
    let fits = |id: &NodeId| {
        let sketched = sketches.as_ref().is_none_or(|sketches| sketches.has(id));
        holds(id) && sketched && (!strokes || gives_curves(document, id))
    };
    let pinned = state.pinned.as_ref().filter(|id| fits(id) || strokes && holds(id));
    let active = |id: &&NodeId| fits(id) || strokes && is_region(document, id);
    let chosen = pinned.or_else(|| state.active().filter(active)).cloned();
    chosen.or_else(|| {
        // Where none fits, none is looked for along the wires, frame by frame.
        let first = document.nodes.keys().find(|id| fits(id))?;
        let near = by_wires(document, shown(), strokes).find(fits);
        near.or_else(|| sketches.is_none().then(|| first.clone()))
    })
}

/// A node that chooses where hair grows on a head.
const REGION: &str = "region";

pub(super) fn is_region(document: &Document, id: &NodeId) -> bool {
    document.node(id.as_str()).is_some_and(|node| node.kind == REGION)
}

/// The node whose outlines say where hair grows: the pinned or active region, else the head.
pub(crate) fn region(state: &State) -> Option<NodeId> {
    let mut chosen = [state.pinned.as_ref(), state.active()].into_iter().flatten();
    let chosen = chosen.find(|id| is_region(&state.document, id));
    chosen.cloned().or_else(|| head(&state.document))
}

/// The edits that add a region to the head, and its id. None where there is no head.
pub(crate) fn make_region(document: &Document) -> Option<(NodeId, Vec<Edit>)> {
    let head = head(document)?;
    let id = document.free_id(REGION);
    let node = document.fresh_node(REGION, &id);
    let edits = put(&id, node, &head, Socket::new(head.clone(), "scalp"), document);
    Some((id, edits))
}

/// Whether strokes of a node become curves.
fn gives_curves(document: &Document, id: &NodeId) -> bool {
    document.def(id).is_some_and(|def| def.outputs.iter().any(|output| output.ty == Type::Curves))
}

/// Nodes and what feeds them, the nearest first; with `both`, what is made of them, too.
pub(super) fn by_wires(
    document: &Document,
    from: Vec<NodeId>,
    both: bool,
) -> impl Iterator<Item = NodeId> {
    let mut open = VecDeque::from(from);
    let mut seen = BTreeSet::new();
    std::iter::from_fn(move || {
        let new = |id: &NodeId| !seen.contains(id);
        let id = std::iter::from_fn(|| open.pop_front()).find(new)?;
        seen.insert(id.clone());
        // Upstream first: what feeds the picture is nearer than what is made of it.
        let wires = || document.links.iter();
        let up = wires().filter(|(to, _)| to.node == id).flat_map(|(_, from)| from);
        open.extend(up.map(|from| from.node.clone()));
        let down = wires().filter(|(_, from)| both && from.iter().any(|from| from.node == id));
        open.extend(down.map(|(to, _)| to.node.clone()));
        Some(id)
    })
}

/// What a node's input that the pen fills holds; none where it holds nothing or what it holds is not understood.
fn held<'a>(document: &'a Document, id: &NodeId) -> Option<&'a Value> {
    let node = document.node(id.as_str())?;
    match node.inputs.get(filled(&node.kind)?.1)? {
        Setting::Known(value) => Some(value),
        Setting::Raw(_) => None,
    }
}

/// The strokes that a node holds.
pub(crate) fn strokes(document: &Document, id: &NodeId) -> Arc<Strokes> {
    match held(document, id) {
        Some(Value::Strokes(strokes)) => strokes.clone(),
        _ => Arc::default(),
    }
}

/// The gestures that a node holds.
pub(crate) fn gestures(document: &Document, id: &NodeId) -> Arc<Gestures> {
    match held(document, id) {
        Some(Value::Gestures(gestures)) => gestures.clone(),
        _ => Arc::default(),
    }
}

/// A word that a node's choice is set to, or its default.
pub(crate) fn choice(document: &Document, id: &NodeId, input: &str) -> Option<String> {
    let node = document.node(id.as_str())?;
    let value = match node.inputs.get(input) {
        Some(Setting::Known(value)) => Some(value.clone()),
        Some(Setting::Raw(_)) => None,
        None => default(&node.kind, input),
    };
    if let Some(Value::Text(word)) = value { Some(word.to_string()) } else { None }
}

/// What an input of a kind of node is when nothing is set.
pub(super) fn default(kind: &str, input: &str) -> Option<Value> {
    coif_nodes::by_id(kind)?.input(input)?.1.default()
}

/// A number that a node of a kind is set to; its default where it is set to none, or where there is no node.
pub(super) fn number(document: &Document, kind: &str, id: Option<&NodeId>, input: &str) -> f32 {
    let known = |value: &Value| if let Value::Float(x) = value { Some(*x) } else { None };
    let node = id.and_then(|id| document.node(id.as_str()));
    let set = node.and_then(|node| match node.inputs.get(input) {
        Some(Setting::Known(value)) => known(value),
        _ => None,
    });
    set.or_else(|| known(&default(kind, input)?)).unwrap_or_default()
}

/// The edits that put a node beside another one, wired to a scalp.
pub(super) fn put(
    id: &NodeId,
    node: Node,
    beside: &NodeId,
    scalp: Socket,
    document: &Document,
) -> Vec<Edit> {
    let Point(x, y) = document.layout.get(beside).copied().unwrap_or_default();
    let at = Some(free_in(document, Point(x + STEP.0, y), STEP));
    vec![
        Edit::AddNode { id: id.clone(), node: Arc::new(node), at },
        Edit::Connect { from: scalp, to: Socket::new(id.clone(), "scalp"), at: None },
    ]
}

/// The edits that make a node for strokes, on both sides of the head or as drawn, and its id. None where the document has no head.
///
/// Where nothing but the head is displayed, the new node is, or nobody would see what was drawn.
pub(crate) fn make(document: &Document, mirror: bool) -> Option<(NodeId, Vec<Edit>)> {
    let head = head(document)?;
    let id = document.free_id("strokes");
    let seed = Setting::Known(Value::Int(free_seed(document)));
    let mut inputs = BTreeMap::from([("seed".to_owned(), seed)]);
    if mirror {
        inputs.insert("mirror".to_owned(), Setting::Known(Value::Text("both".into())));
    }
    let node = Node { kind: KIND.to_owned(), inputs, ..Node::default() };
    let mut edits = put(&id, node, &head, Socket::new(head.clone(), "scalp"), document);
    let shows_hair = displayed(document).iter().any(|socket| socket.node != head);
    edits.extend((!shows_hair).then(|| Edit::SetDisplay(Some(id.clone()))));
    Some((id, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::settings::Settings;
    use crate::core::state::OpenFile;

    const GROOM: &str = r#"(
        format: 3,
        nodes: {
            "head": (kind: "head"),
            "first": (kind: "stroke_input", links: {"scalp": "head.scalp"}),
            "rows": (kind: "stroke_input", links: {"scalp": "head.scalp"}),
            "braids": (kind: "lissajous_braid", links: {"scalp": "head.scalp", "source": "rows.curves"}),
            "out": (kind: "groom_output", links: {"curves": "braids.curves"}),
            "mask": (kind: "paint_mask", links: {"scalp": "head.scalp"}),
            "beard": (kind: "region", links: {"scalp": "head.scalp"}),
            "sketch": (kind: "hair_sketch", links: {"scalp": "head.scalp"}),
        },
    )"#;

    /// What tools fill by the pinned, the active and the displayed node; an empty word is none of them.
    #[track_caller]
    fn check(pinned: &str, active: &str, displayed: &str, fills: Fills, expected: &str) {
        let document = coif_graphs::file::read(GROOM).unwrap().document;
        let mut state = State::new(document, OpenFile::default(), Settings::default(), |_| None);
        state.pinned = NodeId::new(pinned).ok();
        state.selection.active = NodeId::new(active).ok();
        state.document.display = NodeId::new(displayed).ok();
        let found = of(&state, fills);
        assert_eq!(found.as_ref().map_or("", NodeId::as_str), expected);
    }

    #[test]
    fn a_tool_fills_the_pinned_the_active_or_the_nearest_node_that_takes_what_it_draws() {
        use Fills::{Hair, Mask, Strokes};
        check("first", "rows", "rows", Strokes, "first");
        check("mask", "first", "rows", Strokes, "first");
        check("", "head", "first", Strokes, "first");
        // Without a displayed node all outputs are seen.
        check("", "sketch", "", Strokes, "rows");
        // A head holds its hairline: only when it is pinned. A region is drawn when it is active.
        check("head", "first", "", Strokes, "head");
        check("", "beard", "out", Strokes, "beard");
        check("rows", "head", "out", Mask, "mask");
        // Hair is sketched on what is seen.
        check("", "rows", "out", Hair, "");
        check("", "rows", "sketch", Hair, "sketch");
        check("sketch", "mask", "out", Hair, "sketch");
    }
}
