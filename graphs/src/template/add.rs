//! A template put into a document: its group, with what shows it and what is to be drawn for it.
//!
//! Pure; one edit. The head at hand stands for the template's own. Outside of all groups the outputs of the template's file come along,
//! so that its hair is seen and written.

use super::{OUTPUT, group_of, hash};
use crate::clipboard;
use crate::document::edit::Edit;
use crate::document::graph::{HEAD, free_seed, head_at_hand, upstream};
use crate::document::{Document, Node, NodeId, Origin, Point, Setting, Socket};
use coif_nodes::declared::GROUP_INPUT;
use coif_nodes::define::{Type, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Free space under what is there, in units of the canvas.
const BELOW: f32 = 140.0;

/// What adding a template does.
#[derive(Debug)]
pub struct Added {
    /// The edit that does it.
    pub edit: Edit,
    /// The instance.
    pub id: NodeId,
    /// The node that waits to be drawn into, where the template takes what is drawn.
    pub draws: Option<NodeId>,
}

/// Where a template is added.
#[derive(Clone, Copy, Debug, Default)]
pub struct Placement<'a> {
    /// The group that it stands in; none for the graph itself.
    pub within: Option<&'a NodeId>,
    /// Where the instance comes to lie; none: beside the head, under all that is there.
    pub at: Option<Point>,
    /// A node that may stand for the one that the template has drawn into, where nothing takes from it yet.
    pub drawn: Option<&'a NodeId>,
    /// The hash that the instance is marked with, where the template was changed before it is added; none: that of what it holds.
    pub hash: Option<&'a str>,
}

/// Adds an instance of a template to a document. What its file has drawn for it comes along empty, to be drawn; the head at hand
/// stands for its head, or its head comes along where there is none. In a group the instance comes alone, wired to the
/// head that the group takes.
///
/// # Errors
/// The file is no template, or its nodes are refused.
pub fn add(document: &Document, template: &Document, place: Placement) -> Result<Added, String> {
    let group = group_of(template)?;
    let draws = drawn_for(template, group);
    let mut part = as_added(template, group, place);
    let mut known = BTreeMap::new();
    if place.within.is_none() {
        for (id, node) in &template.nodes {
            let head = (node.kind == HEAD).then(|| head_at_hand(document)).flatten();
            known.extend(head.map(|head| (id.clone(), head)));
        }
    }
    let idle = place.drawn.filter(|id| is_idle(document, id));
    for id in &draws {
        let node = &template.nodes[id];
        let same =
            |theirs: &&NodeId| document.nodes.get(*theirs).is_some_and(|it| it.kind == node.kind);
        known.extend(idle.filter(same).map(|theirs| (id.clone(), theirs.clone())));
        if let Some(node) = part.nodes.get_mut(id) {
            empty(Arc::make_mut(node), free_seed(document));
        }
    }
    if place.at.is_some() {
        part.layout.entry(group.clone()).or_default();
    }
    let shift = shift(document, &part, &known, (group, place.at));
    let (edit, ids) = clipboard::insert(document, &part, shift, &known, place.within)?;
    let id = ids.get(group).cloned().ok_or("the group is not in it")?;
    let mut after = document.clone();
    edit.apply(&mut after).map_err(|err| err.to_string())?;
    let wire = wire_scalp(&after, &id, place.within);
    // Displayed alone it would hide other hair, and its own other outputs.
    let all = place.within.is_none().then_some(Edit::SetDisplay(None));
    let edit = Edit::Several([edit].into_iter().chain(wire).chain(all).collect());
    let draws = draws.first().and_then(|id| ids.get(id).cloned());
    Ok(Added { edit, id, draws })
}

/// What of a template's file is added: the group, marked as it is now; outside of all groups what feeds it and what it gives to, too.
fn as_added(template: &Document, group: &NodeId, place: Placement) -> Document {
    let alone = place.within.is_some();
    let feeding = upstream(template, [group]);
    let gives = |id: &NodeId| {
        let from = |(to, wires): (&Socket, &Vec<Socket>)| {
            to.node == *id && wires.iter().any(|wire| wire.node == *group)
        };
        template.nodes[id].kind == OUTPUT && template.links.iter().any(from)
    };
    let drawn = drawn_for(template, group);
    let kept = |id: &NodeId| {
        let comes =
            template.nodes.get(id).is_some_and(|node| node.kind == HEAD && feeding.contains(id));
        id == group || id.is_inside(group) || (!alone && (comes || drawn.contains(id) || gives(id)))
    };
    let mut part = Document {
        nodes: template
            .nodes
            .iter()
            .filter(|(id, _)| kept(id))
            .map(|(a, b)| (a.clone(), b.clone()))
            .collect(),
        links: template.links.clone(),
        bends: template.bends.clone(),
        layout: template.layout.clone(),
        collapsed: template.collapsed.clone(),
        ..Document::default()
    };
    if let Some(node) = part.nodes.get_mut(group) {
        let node = Arc::make_mut(node);
        let origin = node.template.as_deref().cloned().unwrap_or_default();
        let hash = place.hash.map_or_else(|| hash(template, group), str::to_owned);
        node.template = Some(Origin { hash, ..origin }.into());
    }
    // Nobody's wires by chance: what is not added feeds nothing.
    let there = part.nodes.clone();
    part.links.retain(|to, wires| {
        wires.retain(|wire| there.contains_key(&wire.node));
        there.contains_key(&to.node) && !wires.is_empty()
    });
    part.settle();
    part
}

/// The nodes in a template's file that hold what is drawn for its group, in order.
fn drawn_for(template: &Document, group: &NodeId) -> Vec<NodeId> {
    let feeds =
        template.links.iter().filter(|(to, _)| to.node == *group).flat_map(|(_, from)| from);
    let drawn: BTreeSet<&NodeId> =
        feeds.map(|from| &from.node).filter(|id| is_drawn_into(template, id)).collect();
    drawn.into_iter().cloned().collect()
}

/// Whether a node turns what is drawn into curves.
fn is_drawn_into(document: &Document, id: &NodeId) -> bool {
    let node = document.node(id.as_str()).filter(|node| node.kind != HEAD && !node.is_group());
    let def = node.and_then(|node| coif_nodes::by_id(&node.kind));
    let holds = |ty| matches!(ty, Type::Strokes | Type::Gestures);
    def.is_some_and(|def| {
        def.inputs.iter().any(|input| holds(input.ty))
            && def.outputs.iter().any(|output| output.ty == Type::Curves)
    })
}

/// Whether a node turns what is drawn into curves, and nothing is drawn yet.
pub(super) fn waits_for_a_pen(document: &Document, id: &NodeId) -> bool {
    let drawn = |setting: &Setting| match setting {
        Setting::Known(Value::Strokes(strokes)) => !strokes.0.is_empty(),
        Setting::Known(Value::Gestures(gestures)) => !gestures.0.is_empty(),
        _ => false,
    };
    let node = document.node(id.as_str());
    is_drawn_into(document, id) && node.is_some_and(|node| !node.inputs.values().any(drawn))
}

/// Takes away what is drawn.
fn empty(node: &mut Node, seed: i64) {
    node.inputs.retain(|_, setting| {
        !matches!(setting, Setting::Known(Value::Strokes(_) | Value::Gestures(_)))
    });
    node.inputs.insert("seed".to_owned(), Setting::Known(Value::Int(seed)));
}

fn is_idle(document: &Document, id: &NodeId) -> bool {
    document.nodes.contains_key(id)
        && !document.links.values().flatten().any(|from| from.node == *id)
}

/// The wire from the head at hand to an instance that has none: in a group from the head that the group takes, where it takes exactly
/// one.
fn wire_scalp(after: &Document, id: &NodeId, within: Option<&NodeId>) -> Option<Edit> {
    let is_scalp = |ty: Type| ty == Type::Scalp;
    let takes = after.def(id)?.inputs.iter().find(|input| is_scalp(input.ty))?;
    let to = Socket::new(id.clone(), takes.name);
    if after.links.contains_key(&to) {
        return None;
    }
    let border =
        |other: &NodeId, node: &Node| other.group().as_ref() == within && node.kind == GROUP_INPUT;
    let stands: Vec<NodeId> = match within {
        None => head_at_hand(after).into_iter().collect(),
        Some(_) => {
            let all = after.nodes.iter().filter(|(other, node)| border(other, node));
            all.map(|(other, _)| other.clone()).collect()
        }
    };
    let mut gives = stands.iter().flat_map(|other| {
        let outputs = after.def(other).map_or(&[][..], |def| def.outputs);
        let scalps = outputs.iter().filter(|output| is_scalp(output.ty));
        scalps.map(|output| Socket::new(other.clone(), output.name))
    });
    match (gives.next(), gives.next()) {
        (Some(from), None) => Some(Edit::Connect { from, to, at: None }),
        _ => None,
    }
}

/// From the template's canvas to the document's: the instance to its place, else its head onto the head at hand, but under everything
/// else that is there.
fn shift(
    document: &Document,
    part: &Document,
    known: &BTreeMap<NodeId, NodeId>,
    (group, at): (&NodeId, Option<Point>),
) -> Option<Point> {
    let place = |document: &Document, id: &NodeId| document.layout.get(id).copied();
    let own = place(part, group).unwrap_or_default();
    if let Some(at) = at {
        return Some(Point(at.0 - own.0, at.1 - own.1));
    }
    let head = known.iter().find_map(|(old, id)| {
        let (from, to) = (place(part, old)?, place(document, id)?);
        Some(Point(to.0 - from.0, to.1 - from.1))
    });
    let by = head.unwrap_or_default();
    let is_beside = |id: &NodeId| id.group().is_none();
    let theirs = document
        .layout
        .iter()
        .filter(|(id, _)| is_beside(id) && !known.values().any(|known| known == *id));
    let lowest = theirs.map(|(_, at)| at.1).reduce(f32::max);
    let new = part.layout.iter().filter(|(id, _)| is_beside(id) && !known.contains_key(*id));
    let top = new.map(|(_, at)| at.1).reduce(f32::min);
    Some(match (lowest, top) {
        (Some(lowest), Some(top)) => Point(by.0, by.1.max(lowest + BELOW - top)),
        _ => by,
    })
}
