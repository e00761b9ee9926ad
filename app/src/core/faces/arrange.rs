//! Where nodes stand: automatic places, alignment, distribution. Pure.
//!
//! Nodes that the document places are never moved by themselves; only what it does not place is.

use super::{Face, Faces};
use crate::core::shown::Reports;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Point, graph};
use egui::{Pos2, Rect, Vec2, pos2, vec2};
use egui_graph::{LayoutNode, LayoutParams};
use std::collections::{BTreeMap, BTreeSet};

/// Room between nodes along the flow, and across it.
pub(crate) const GAP: Vec2 = vec2(48.0, 24.0);

/// A place of a document on the canvas.
pub(crate) fn pos(point: Point) -> Pos2 {
    pos2(point.0, point.1)
}
/// A place on the canvas for a document, on whole units.
pub(crate) fn point(pos: Pos2) -> Point {
    Point(pos.x.round(), pos.y.round())
}

/// How far from the middle things are drawn. Files may say more.
const FARTHEST: f32 = 1e6;

/// A place as it is drawn: no farther away than makes sense.
pub(crate) fn sound(at: Pos2) -> Pos2 {
    at.clamp(pos2(-FARTHEST, -FARTHEST), pos2(FARTHEST, FARTHEST))
}

/// The corner of every node: the document's, else one beside what feeds it.
pub(crate) fn corners(
    document: &Document,
    faces: &BTreeMap<NodeId, Face>,
) -> BTreeMap<NodeId, Pos2> {
    let finite = |point: &Point| point.0.is_finite() && point.1.is_finite();
    let placed = document.layout.iter().filter(|(id, at)| faces.contains_key(*id) && finite(at));
    let mut corners: BTreeMap<NodeId, Pos2> =
        placed.map(|(id, at)| (id.clone(), sound(pos(*at)))).collect();
    let missing: BTreeSet<NodeId> =
        faces.keys().filter(|id| !corners.contains_key(*id)).cloned().collect();
    if corners.is_empty() {
        return laid_out(document, faces, &missing);
    }
    let mut taken: Vec<Rect> =
        corners.iter().map(|(id, at)| Rect::from_min_size(*at, faces[id].size())).collect();
    for id in graph::order(document).unwrap_or_else(|_| missing.iter().cloned().collect()) {
        if !missing.contains(&id) {
            continue;
        }
        let feeders = graph::feeders(document, &id).filter_map(|f| Some((f, *corners.get(f)?)));
        let beside = feeders.map(|(f, at)| at + vec2(faces[f].size().x + GAP.x, 0.0));
        let size = faces[&id].size();
        let at = beside.reduce(|a, b| if b.x > a.x { b } else { a });
        let at = free_place(&taken, at.unwrap_or_else(|| below(&taken)), size);
        taken.push(Rect::from_min_size(at, size));
        corners.insert(id, at);
    }
    corners
}

fn below(taken: &[Rect]) -> Pos2 {
    let all = taken.iter().copied().reduce(Rect::union).unwrap_or(Rect::ZERO);
    pos2(all.left(), all.bottom() + GAP.y)
}

/// The first place from `at` downwards where a node of this size covers no other.
pub(crate) fn free_place(taken: &[Rect], at: Pos2, size: Vec2) -> Pos2 {
    let mut at = at;
    // Each step passes the bottom of at least one box.
    for _ in 0..=taken.len() {
        let own = Rect::from_min_size(at, size).expand(GAP.y / 2.0 - 1.0);
        let Some(hit) = taken.iter().find(|rect| rect.intersects(own)) else { break };
        at.y = hit.bottom() + GAP.y;
    }
    at
}

/// A free place of a document's canvas for a node of a size, at a place or as far below it as it must be.
pub(crate) fn free_in(document: &Document, at: Point, size: Point) -> Point {
    let faces = Faces::new(document, &Reports::default(), &BTreeSet::new(), None, None);
    let taken: Vec<Rect> = faces.all.keys().filter_map(|id| faces.rect(id)).collect();
    let size = vec2(super::WIDTH.min(size.0), size.1);
    point(free_place(&taken, sound(pos(at)), size))
}

/// Places for nodes in layers along their wires, with few crossings and straight wires. The upper
/// left corner of what they cover stays.
pub(crate) fn laid_out(
    document: &Document,
    faces: &BTreeMap<NodeId, Face>,
    nodes: &BTreeSet<NodeId>,
) -> BTreeMap<NodeId, Pos2> {
    let among = || faces.values().filter(|face| nodes.contains(&face.id));
    let boxes = among().map(|face| {
        let height = |at: Pos2| at.y;
        let inputs = (0..face.inputs.len()).map(|n| height(face.input_at(Pos2::ZERO, n)));
        let outputs = (0..face.outputs.len()).map(|n| height(face.output_at(Pos2::ZERO, n)));
        let node = LayoutNode::new(face.size())
            .input_offsets(inputs.collect())
            .output_offsets(outputs.collect());
        (face.key, node)
    });
    let wires = document.links.iter().flat_map(|(to, from)| {
        from.iter().enumerate().filter_map(|(at, from)| {
            let (a, b) = (faces.get(&from.node)?, faces.get(&to.node)?);
            let both = nodes.contains(&from.node) && nodes.contains(&to.node);
            both.then_some(((a.key, a.output(&from.name)?), (b.key, b.plug_of(&to.name, at)?)))
        })
    });
    let params = LayoutParams::new(egui::Direction::LeftToRight)
        .layer_gap(GAP.x)
        .node_gap(GAP.y)
        .component_gap(GAP.x)
        .straighten_edges(true);
    let found = egui_graph::layout(boxes, wires, params);
    among().filter_map(|face| Some((face.id.clone(), found.get(&face.key)?.round()))).collect()
}

/// The edit that lays nodes out in place.
pub(crate) fn tidied(document: &Document, faces: &Faces, nodes: &BTreeSet<NodeId>) -> Edit {
    let found = laid_out(document, &faces.all, nodes);
    let corner = |places: &mut dyn Iterator<Item = Pos2>| places.reduce(|a, b| a.min(b));
    let was = corner(&mut nodes.iter().filter_map(|id| faces.corners.get(id).copied()));
    let is = corner(&mut found.values().copied());
    let shift = was.zip(is).map_or(Vec2::ZERO, |(was, is)| was - is);
    moves(found.into_iter().map(|(id, at)| (id, at + shift)))
}

/// The edit that moves nodes to places.
pub(crate) fn moves(to: impl IntoIterator<Item = (NodeId, Pos2)>) -> Edit {
    let to = to.into_iter();
    Edit::Several(to.map(|(id, at)| Edit::Move { id, to: Some(point(at)) }).collect())
}

/// A line that nodes are brought to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alignment {
    /// Left edges in a column.
    Left,
    /// Right edges in a column.
    Right,
    /// Upper edges in a row.
    Top,
    /// Lower edges in a row.
    Bottom,
}

/// The edit that brings nodes to the outermost of them.
pub(crate) fn aligned(faces: &Faces, nodes: &BTreeSet<NodeId>, line: Alignment) -> Edit {
    let Some(all) = faces.bounds(nodes) else { return Edit::Several(vec![]) };
    moves(nodes.iter().filter_map(|id| {
        let rect = faces.rect(id)?;
        let at = match line {
            Alignment::Left => pos2(all.left(), rect.top()),
            Alignment::Right => pos2(all.right() - rect.width(), rect.top()),
            Alignment::Top => pos2(rect.left(), all.top()),
            Alignment::Bottom => pos2(rect.left(), all.bottom() - rect.height()),
        };
        Some((id.clone(), at))
    }))
}

/// The edit that makes the gaps between nodes equal along the way in which they are spread the
/// most; the first and the last stay.
pub(crate) fn distributed(faces: &Faces, nodes: &BTreeSet<NodeId>) -> Edit {
    let Some(all) = faces.bounds(nodes) else { return Edit::Several(vec![]) };
    let across = all.width() >= all.height();
    let along = |v: Vec2| if across { v.x } else { v.y };
    let mut boxes: Vec<(NodeId, Rect)> =
        nodes.iter().filter_map(|id| Some((id.clone(), faces.rect(id)?))).collect();
    boxes.sort_by(|(_, a), (_, b)| along(a.min.to_vec2()).total_cmp(&along(b.min.to_vec2())));
    let filled: f32 = boxes.iter().map(|(_, rect)| along(rect.size())).sum();
    let gaps = boxes.len().saturating_sub(1).max(1) as f32;
    let gap = (along(all.size()) - filled) / gaps;
    let mut at = along(all.min.to_vec2());
    moves(boxes.into_iter().map(|(id, rect)| {
        let corner = if across { pos2(at, rect.top()) } else { pos2(rect.left(), at) };
        at += along(rect.size()) + gap;
        (id, corner)
    }))
}

/// The node that lies next in a direction from `from`, judged by the middles: the nearest within a
/// right angle.
pub(crate) fn neighbour(faces: &Faces, from: &NodeId, way: Vec2) -> Option<NodeId> {
    let here = faces.rect(from)?.center();
    let others = faces.all.keys().filter(|id| *id != from);
    others
        .filter_map(|id| {
            let off = faces.rect(id)?.center() - here;
            let (along, across) = (off.dot(way), off.dot(way.rot90()).abs());
            (along > 1.0 && across <= along * 1.5).then_some((along + 2.0 * across, id))
        })
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, id)| id.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::testing::{document, faces, id};

    fn apart(faces: &Faces) {
        let boxes: Vec<Rect> = faces.all.keys().filter_map(|id| faces.rect(id)).collect();
        for (i, a) in boxes.iter().enumerate() {
            assert!(boxes[..i].iter().all(|b| !a.intersects(*b)), "{i}");
        }
    }

    #[test]
    fn what_the_document_does_not_place_stands_apart_and_downstream() {
        let mut document = document("cornrows");
        document.layout.clear();
        let all = faces(&document);
        apart(&all);
        for (to, from) in &document.links {
            for from in from {
                assert!(all.corners[&from.node].x < all.corners[&to.node].x, "{from} {to}");
            }
        }
        document.layout.insert(id("head"), Point(500.0, 300.0));
        let some = faces(&document);
        apart(&some);
        assert_eq!(some.corners[&id("head")], pos2(500.0, 300.0));
    }

    #[test]
    fn aligning_and_distributing_move_what_they_say() {
        let mut document = document("cornrows");
        let nodes: BTreeSet<NodeId> = ["rows", "braid", "fill"].map(id).into();
        document.layout.insert(id("braid"), Point(300.0, 70.0));
        let check = |edit: Edit, want: fn(&Faces) -> bool| {
            let mut after = document.clone();
            edit.apply(&mut after).unwrap();
            assert!(want(&faces(&after)), "{edit:?}");
        };
        let f = faces(&document);
        check(aligned(&f, &nodes, Alignment::Top), |f| f.corners[&id("braid")] == pos2(300.0, 0.0));
        check(aligned(&f, &nodes, Alignment::Left), |f| f.corners[&id("fill")] == pos2(220.0, 0.0));
        check(distributed(&f, &nodes), |f| {
            let x = |node: &str| f.corners[&id(node)].x;
            (x("rows"), x("braid"), x("fill")) == (220.0, 440.0, 660.0)
        });
        check(tidied(&document, &f, &nodes), |f| f.corners[&id("rows")].x == 220.0);
    }

    #[test]
    fn arrows_find_the_node_that_eyes_expect() {
        let document = document("cornrows");
        let f = faces(&document);
        let next = |from: &str, way| neighbour(&f, &id(from), way);
        assert_eq!(next("braid", vec2(1.0, 0.0)), Some(id("fill")));
        assert_eq!(next("fill", vec2(0.0, 1.0)), Some(id("partings")));
        assert_eq!(next("head", vec2(-1.0, 0.0)), None);
    }
}
