//! What hands do on the canvas, as edits of the document. Pure; each is one undo step.

use super::wires::{Wire, last_first};
use crate::core::faces::arrange::{self, point};
use crate::core::faces::{Faces, Plug};
use coif_graphs::clipboard;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Frame, NodeId, Point, Setting, Socket, graph, wiring};
use coif_nodes::define::{Arity, NodeDef, Type, Value};
use egui::{Pos2, Rect, Vec2, vec2};
use std::collections::BTreeSet;

/// What a node that is added is wired to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Link {
    /// It takes from this output.
    From(Socket),
    /// It feeds this input, before the wire of that number.
    To(Socket, Option<usize>),
}

/// Wires an output to an end, with the wire that was lifted off another, if any. None when nothing
/// would change.
pub(super) fn connect(
    document: &Document,
    from: &Socket,
    plug: &Plug,
    lifted: Option<&Wire>,
) -> Option<Edit> {
    let to = plug.socket.clone();
    let Some(lifted) = lifted else {
        let here = document.wires(&to.node, &to.name);
        // An end that has this very wire.
        if plug.wire.is_some_and(|at| here.get(at) == Some(from)) {
            return None;
        }
        return Some(Edit::Connect { from: from.clone(), to, at: plug.wire });
    };
    if lifted.to == to {
        let last = document.wires(&to.node, &to.name).len().checked_sub(1)?;
        let at = plug.wire.unwrap_or(last);
        return (at != lifted.at).then_some(Edit::Reorder { to, from: lifted.at, at });
    }
    let off = Edit::Disconnect { to: lifted.to.clone(), at: lifted.at };
    let on = Edit::Connect { from: from.clone(), to, at: plug.wire };
    Some(Edit::Several(vec![off, on]))
}

/// Lets every one of the wires come from another output.
///
/// # Errors
/// Why one of them cannot, in words.
pub(super) fn rewire(document: &Document, wires: &[Wire], from: &Socket) -> Result<Edit, String> {
    let mut edits = vec![];
    for wire in wires {
        if let Some(reason) =
            wiring::LooseWire::from_output(document, from.clone()).reason(&wire.to)
        {
            return Err(reason);
        }
        let mut all = document.wires(&wire.to.node, &wire.to.name).to_vec();
        if let Some(Edit::SetWires { to, from: earlier }) = edits.last()
            && *to == wire.to
        {
            all.clone_from(earlier);
            edits.pop();
        }
        if let Some(slot) = all.get_mut(wire.at) {
            *slot = from.clone();
        }
        edits.push(Edit::SetWires { to: wire.to.clone(), from: all });
    }
    Ok(Edit::Several(edits))
}

/// Takes wires off.
pub(super) fn cut(wires: impl IntoIterator<Item = Wire>) -> Edit {
    let off = last_first(wires).into_iter();
    Edit::Several(off.map(|wire| Edit::Disconnect { to: wire.to, at: wire.at }).collect())
}

/// How a node that is added behind another stands to what takes from that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Behind {
    /// Between: all that took from the other takes from it.
    Inserted,
    /// Between where hair is seen and goes to outputs of the groom alone, so that what is shown is what is written; else beside.
    Dropped,
    /// Beside.
    Branch,
}

/// Adds a node of a kind, wired as asked where that fits. A head that the kind can take is wired too, when it is clear which. Gives the
/// node's id.
pub(super) fn add(
    document: &Document,
    def: &NodeDef,
    at: Pos2,
    (link, behind): (Option<&Link>, Behind),
    group: Option<&NodeId>,
) -> (Edit, NodeId) {
    let (added, id) = beside(document, def, at, link, group);
    let along = match link {
        Some(Link::From(from)) if goes_between(document, from, behind) => {
            let mut with = document.clone();
            let is_added = added.apply(&mut with).is_ok();
            // What would run in a circle stands beside.
            let along = is_added.then(|| wiring::insert_behind(&with, &id, from).ok().flatten());
            along.flatten().or_else(|| is_added.then(|| joined(&with, &id, from)).flatten())
        }
        _ => None,
    };
    match (added, along) {
        (Edit::Several(edits), Some(along)) => {
            (Edit::Several(edits.into_iter().chain([along]).collect()), id)
        }
        (added, _) => (added, id),
    }
}

/// Hair that a node makes of its own beside the hair that it stands on, joined with that hair before it is coloured, else before it is
/// written: it is seen and written with it.
fn joined(document: &Document, id: &NodeId, from: &Socket) -> Option<Edit> {
    let (to, _) = graph::inputs_of(document, id).find(|(_, wires)| wires.contains(from))?;
    let beside = wiring::input_def(document, to).is_some_and(|input| !wiring::passes_on(input));
    let gives = |output: &&coif_nodes::define::OutputDef| output.ty == Type::Curves;
    let mut makes = document.def(id)?.outputs.iter().filter(gives);
    // Guides may be given, too.
    let hair = makes.clone().find(|output| output.name == "curves").or(makes.next_back())?;
    let hair = Socket::new(id.clone(), hair.name);
    // The hair that is made of what the output gives, not of what else its node does.
    let takers = document.links.iter().filter(|(_, wires)| wires.contains(from));
    let behind = graph::downstream(document, takers.map(|(to, _)| &to.node));
    let of_kind = |kind: &str| {
        let all = behind.iter().filter(|it| it.group() == id.group() && *it != id);
        let is = |it: &&NodeId| document.node(it.as_str()).is_some_and(|node| node.kind == kind);
        let all: Vec<&NodeId> = all.filter(is).collect();
        // The first along the wires, where several stand behind one another.
        let first = |it: &&&NodeId| graph::upstream(document, [**it]).len();
        all.iter().min_by_key(first).map(|it| (*it).clone())
    };
    let end = of_kind("hair_colour").or_else(|| of_kind("groom_output")).filter(|_| beside)?;
    let end = Socket::new(end, "curves");
    let feeds = document.links.get(&end)?.first()?.clone();
    let is_merge = document.node(feeds.node.as_str()).is_some_and(|node| node.kind == "merge");
    if is_merge {
        let to = Socket::new(feeds.node, "curves");
        return Some(Edit::Connect { from: hair, to, at: None });
    }
    let merge = document.free_id_in(id.group().as_ref(), "merge");
    let node = document.fresh_node("merge", &merge).into();
    let into = Socket::new(merge.clone(), "curves");
    let joins = |from| Edit::Connect { from, to: into.clone(), at: None };
    Some(Edit::Several(vec![
        Edit::AddNode { id: merge.clone(), node, at: None },
        joins(feeds),
        joins(hair),
        Edit::SetWires { to: end, from: vec![Socket::new(merge, "curves")] },
    ]))
}

/// Whether a node that is added behind an output goes between it and what takes from it.
fn goes_between(document: &Document, from: &Socket, behind: Behind) -> bool {
    let ends = |to: &Socket| {
        document.node(to.node.as_str()).is_some_and(|node| node.kind == "groom_output")
    };
    let mut takers = document.links.iter().filter(|(_, all)| all.contains(from));
    let seen = document.display.as_ref().is_none_or(|shown| *shown == from.node);
    match behind {
        Behind::Inserted => true,
        Behind::Dropped => seen && takers.all(|(to, _)| ends(to)),
        Behind::Branch => false,
    }
}

/// The same without going between.
fn beside(
    document: &Document,
    def: &NodeDef,
    at: Pos2,
    link: Option<&Link>,
    group: Option<&NodeId>,
) -> (Edit, NodeId) {
    let id = document.free_id_in(group, def.id);
    let node = document.fresh_node(def.id, &id);
    let mut edits = vec![Edit::AddNode { id: id.clone(), node: node.into(), at: Some(point(at)) }];
    let known = coif_nodes::by_id(def.id);
    let mut wired: Option<&str> = None;
    match (link, known) {
        (Some(Link::From(from)), Some(def)) => {
            let ty = wiring::output_type(document, from);
            if let Some(input) = ty.and_then(|ty| wiring::taking(def, ty)) {
                let to = Socket::new(id.clone(), input.name);
                wired = Some(input.name);
                edits.push(Edit::Connect { from: from.clone(), to, at: None });
            }
        }
        (Some(Link::To(to, at)), Some(def)) => {
            let input = wiring::input_def(document, to);
            if let Some(output) = input.and_then(|input| wiring::giving(def, input.ty)) {
                let from = Socket::new(id.clone(), output.name);
                edits.push(Edit::Connect { from, to: to.clone(), at: *at });
            }
        }
        _ => {}
    }
    let near = link.map(|link| match link {
        Link::From(socket) | Link::To(socket, _) => &socket.node,
    });
    let heads = def.inputs.iter().filter(|input| {
        let head = input.arity == Arity::One || input.name == "scalp";
        input.ty == Type::Scalp && head && wired != Some(input.name)
    });
    for input in heads {
        if let Some(from) = the_head(document, near, group) {
            let to = Socket::new(id.clone(), input.name);
            edits.push(Edit::Connect { from, to, at: None });
        }
    }
    // What is only looked at stays in sight beside what is made of it.
    let passes =
        wired.and_then(|input| def.input(input)).is_none_or(|(_, it)| wiring::passes_on(it));
    if let Some(Link::From(from)) = link.filter(|_| passes) {
        edits.extend(display_along(document, &from.node, def, &id));
    }
    (Edit::Several(edits), id)
}

/// A node that comes behind the displayed one is displayed in its place, where it gives something to look at.
fn display_along(document: &Document, from: &NodeId, def: &NodeDef, id: &NodeId) -> Option<Edit> {
    let gives = |ty: Type| def.outputs.iter().any(|output| output.ty == ty);
    let along =
        document.display.as_ref() == Some(from) && (gives(Type::Curves) || gives(Type::Scalp));
    along.then(|| Edit::SetDisplay(Some(id.clone())))
}

/// The input that takes curves as places for what a node makes, the one that says at which end, and the one that makes what it makes
/// small enough for all of them.
pub(super) const PLACES: &str = "placements";
pub(super) const PLACES_AT: &str = "at";
const PLACES_FIT: &str = "fit";

/// The same edit, with an input of the node set to a choice.
pub(super) fn and_set(edit: Edit, id: &NodeId, def: &NodeDef, set: Option<(&str, &str)>) -> Edit {
    let Some((input, word)) = set else { return edit };
    let to = |input: &str, value: Value| Edit::SetInput {
        node: id.clone(),
        input: input.to_owned(),
        setting: Setting::Known(value),
    };
    // What comes to several places has room beside each other.
    let fits = (input == PLACES_AT && def.input(PLACES_FIT).is_some())
        .then(|| to(PLACES_FIT, Value::Bool(true)));
    let sets = [to(input, Value::Text(word.into()))].into_iter().chain(fits);
    match edit {
        Edit::Several(edits) => Edit::Several(edits.into_iter().chain(sets).collect()),
        other => Edit::Several([other].into_iter().chain(sets).collect()),
    }
}

/// Adds a node of a kind between the ends of a wire; gives its id.
///
/// # Errors
/// Why it does not fit there.
pub(super) fn insert_new(
    document: &Document,
    def: &NodeDef,
    at: Pos2,
    wire: &Wire,
) -> Result<(Edit, NodeId), String> {
    let from = wire.from(document).ok_or("the wire is gone")?;
    let (added, id) = {
        let group = from.node.group();
        beside(document, def, at, Some(&Link::From(from.clone())), group.as_ref())
    };
    let mut with = document.clone();
    added.apply(&mut with).map_err(|err| err.to_string())?;
    let inserted = wiring::insert_on_wire(&with, &id, &wire.to, wire.at)?;
    Ok((Edit::Several(vec![added, inserted]), id))
}

/// The scalp that a node beside `near` stands on: the nearest upstream of it, itself included. Beside none, or one that
/// stands on nothing: the last of the only head there is, where partings and the like made others of it.
fn the_head(document: &Document, near: Option<&NodeId>, group: Option<&NodeId>) -> Option<Socket> {
    let scalp = |id: &NodeId| {
        let def = document.def(id)?;
        let output = def.outputs.iter().find(|output| output.ty == Type::Scalp)?;
        Some(Socket::new(id.clone(), output.name))
    };
    let mut ring: Vec<NodeId> = near.cloned().into_iter().collect();
    let mut seen: BTreeSet<NodeId> = ring.iter().cloned().collect();
    while !ring.is_empty() {
        // Of two as near, the one that stands on the other.
        let found: Vec<Socket> = ring.iter().filter_map(scalp).collect();
        if let Some(last) = last_of(document, found) {
            return Some(last);
        }
        let feeders = ring.iter().flat_map(|id| graph::inputs_of(document, id));
        let next = feeders.flat_map(|(_, from)| from.iter().map(|from| from.node.clone()));
        ring = next
            .collect::<BTreeSet<_>>()
            .into_iter()
            .filter(|id| seen.insert(id.clone()))
            .collect();
    }
    let beside = document.nodes.keys().filter(|id| id.group().as_ref() == group);
    let all: Vec<Socket> = beside.filter_map(scalp).collect();
    let is_head = |socket: &&Socket| !graph::inputs_of(document, &socket.node).any(|_| true);
    if all.iter().filter(is_head).count() > 1 {
        return None;
    }
    last_of(document, all)
}

/// The one that stands on the most of the others.
fn last_of(document: &Document, scalps: Vec<Socket>) -> Option<Socket> {
    let depth = |socket: &Socket| {
        let above = graph::upstream(document, [&socket.node]);
        scalps.iter().filter(|other| above.contains(&other.node)).count()
    };
    let deepest = scalps.iter().rev().max_by_key(|socket| depth(socket));
    deepest.cloned()
}

/// Copies nodes beside themselves; gives the copies.
///
/// # Errors
/// When they cannot be copied.
pub(super) fn duplicate(
    document: &Document,
    faces: &Faces,
    nodes: &BTreeSet<NodeId>,
    group: Option<&NodeId>,
) -> Result<(Edit, Vec<NodeId>), String> {
    let corner = faces.bounds(nodes).map_or(Pos2::ZERO, |all| all.min);
    paste(document, &placed_copy(document, faces, nodes), corner + vec2(32.0, 32.0), group)
}

/// Nodes as text, with the places at which they are seen.
pub(super) fn placed_copy(document: &Document, faces: &Faces, nodes: &BTreeSet<NodeId>) -> String {
    let mut placed = document.clone();
    for id in nodes {
        if let Some(at) = faces.corners.get(id) {
            placed.layout.insert(id.clone(), point(*at));
        }
    }
    clipboard::copy(&placed, nodes)
}

/// Adds the nodes of a text, their upper left at a place; gives them.
///
/// # Errors
/// What is wrong with the text.
pub(super) fn paste(
    document: &Document,
    text: &str,
    at: Pos2,
    group: Option<&NodeId>,
) -> Result<(Edit, Vec<NodeId>), String> {
    clipboard::paste(document, text, Some(point(at)), group)
}

/// Room between a frame's edge and the nodes in it, and for its title.
const FRAME_ROOM: Vec2 = vec2(16.0, 16.0);
/// Height of a frame's title.
pub(super) const FRAME_TITLE: f32 = 24.0;

/// The box that a frame round others has.
pub(super) fn frame_box(round: Rect) -> Rect {
    let mut rect = round.expand2(FRAME_ROOM);
    rect.min.y -= FRAME_TITLE;
    rect
}

/// Puts a frame round nodes; gives its name.
pub(super) fn frame(document: &Document, round: Rect, group: Option<&NodeId>) -> (Edit, String) {
    let stem = group.map_or("frame".to_owned(), |group| format!("{group}/frame"));
    let name = document.free_frame(&stem);
    let rect = frame_box(round);
    let frame = Frame {
        at: point(rect.min),
        size: Point(rect.width().round(), rect.height().round()),
        text: String::new(),
        colour: (document.frames.len() % super::look::FRAMES.len()) as u8,
    };
    (Edit::SetFrame { name: name.clone(), frame: Some(frame) }, name)
}

/// The box of a frame.
pub(super) fn frame_rect(frame: &Frame) -> Rect {
    let far = arrange::pos(frame.at) + vec2(frame.size.0, frame.size.1);
    Rect::from_min_max(arrange::sound(arrange::pos(frame.at)), arrange::sound(far))
}

/// The nodes that lie in a frame whole.
pub(super) fn framed(frame: &Frame, faces: &Faces) -> BTreeSet<NodeId> {
    let rect = frame_rect(frame);
    let inside = |id: &&NodeId| faces.rect(id).is_some_and(|node| rect.contains_rect(node));
    faces.all.keys().filter(inside).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::testing::{document, faces, id, socket};
    use egui::pos2;

    fn apply(document: &Document, edit: &Edit) -> Document {
        let mut after = document.clone();
        edit.apply(&mut after).unwrap_or_else(|err| panic!("{edit:?}: {err}"));
        after
    }
    const ALONE: (Option<&Link>, Behind) = (None, Behind::Branch);
    fn branch(link: &Link) -> (Option<&Link>, Behind) {
        (Some(link), Behind::Branch)
    }
    fn plug(document: &Document, input: &str, wire: Option<usize>) -> Plug {
        let input = socket(input);
        let faces = faces(document);
        let mut plugs = faces.all[&input.node].inputs.clone();
        plugs.retain(|plug| plug.socket == input && plug.wire == wire);
        plugs.remove(0)
    }

    #[test]
    fn a_lifted_wire_goes_elsewhere_in_one_step() {
        let document = document("cornrows");
        let lifted = Wire { to: socket("fill.curves"), at: 0 };
        let from = socket("braid.curves");
        let to = plug(&document, "colour.curves", Some(0));
        let after = apply(&document, &connect(&document, &from, &to, Some(&lifted)).unwrap());
        assert!(!after.links.contains_key(&lifted.to));
        assert_eq!(after.links[&to.socket], std::slice::from_ref(&from));
        let back = plug(&document, "fill.curves", Some(0));
        assert_eq!(connect(&document, &from, &back, Some(&lifted)), None);
        assert_eq!(connect(&document, &from, &back, None), None);
    }

    #[test]
    fn wires_of_one_input_change_their_order() {
        let mut document = document("cornrows");
        let (edit, all) =
            add(&document, coif_nodes::by_id("merge").unwrap(), Pos2::ZERO, ALONE, None);
        document = apply(&document, &edit);
        let to = Socket::new(all, "curves");
        let from = ["rows.curves", "braid.curves", "fill.curves"].map(socket);
        document.links.insert(to.clone(), from.to_vec());
        let lifted = Wire { to: to.clone(), at: 2 };
        let first = plug(&document, &to.to_string(), Some(0));
        let after = apply(&document, &connect(&document, &from[2], &first, Some(&lifted)).unwrap());
        assert_eq!(after.links[&to], [from[2].clone(), from[0].clone(), from[1].clone()]);
        // A new wire goes before the one it is dropped on, or behind all.
        let colour = socket("colour.curves");
        let after = apply(&document, &connect(&document, &colour, &first, None).unwrap());
        assert_eq!(after.links[&to][0], colour);
        let next = plug(&document, &to.to_string(), None);
        let after = apply(&document, &connect(&document, &colour, &next, None).unwrap());
        assert_eq!(after.links[&to][3], colour);
        let moved = rewire(
            &document,
            &[Wire { to: to.clone(), at: 0 }, Wire { to: to.clone(), at: 1 }],
            &colour,
        );
        let after = apply(&document, &moved.unwrap());
        assert_eq!(after.links[&to], [colour.clone(), colour, from[2].clone()]);
    }

    #[test]
    fn wires_that_cannot_move_say_why() {
        let document = document("cornrows");
        let wires = [Wire { to: socket("braid.source"), at: 0 }];
        let why = rewire(&document, &wires, &socket("fill.curves")).unwrap_err();
        assert!(why.contains("circle"), "{why}");
        let why = rewire(&document, &wires, &socket("head.scalp")).unwrap_err();
        assert!(why.contains("scalp"), "{why}");
    }

    #[test]
    fn an_added_node_is_wired_where_it_fits_and_to_the_only_head() {
        let document = document("cornrows");
        let def = |kind: &str| coif_nodes::by_id(kind).unwrap();
        let from = Link::From(socket("rows.curves"));
        let (edit, new) =
            add(&document, def("scalp_projection"), pos2(9.0, 7.4), branch(&from), None);
        let after = apply(&document, &edit);
        assert_eq!(after.layout[&new], Point(9.0, 7.0));
        assert_eq!(after.wires(&new, "curves"), [socket("rows.curves")]);
        assert_eq!(after.wires(&new, "scalp"), [socket("head.scalp")]);
        let to = Link::To(socket("fill.curves"), None);
        let (edit, new) = add(&document, def("resample"), Pos2::ZERO, branch(&to), None);
        assert_eq!(apply(&document, &edit).links[&socket("fill.curves")][0].node, new);
        let (edit, new) = add(&document, def("head"), Pos2::ZERO, branch(&from), None);
        let after = apply(&document, &edit);
        assert!(graph::inputs_of(&after, &new).next().is_none());
    }

    #[test]
    fn a_node_added_behind_another_in_a_chain_stands_between_and_a_branch_beside() {
        let document = document("cornrows");
        let def = coif_nodes::by_id("resample").unwrap();
        let from = Link::From(socket("rows.curves"));
        let added = |behind| {
            let (edit, new) = add(&document, def, Pos2::ZERO, (Some(&from), behind), None);
            (apply(&document, &edit), new)
        };
        let (after, new) = added(Behind::Inserted);
        assert_eq!(after.wires(&new, "curves"), [socket("rows.curves")]);
        let through = [Socket::new(new, "curves")];
        for to in ["braid.source", "partings.source"] {
            assert_eq!(after.links[&socket(to)], through, "{to}");
        }
        let (after, new) = added(Behind::Branch);
        assert_eq!(after.wires(&new, "curves"), [socket("rows.curves")]);
        assert_eq!(after.links[&socket("braid.source")], [socket("rows.curves")]);
    }

    #[test]
    fn hair_made_beside_other_hair_is_seen_and_coloured_with_it() {
        let document = document("cornrows");
        let def = coif_nodes::by_id("sphere_puff").unwrap();
        let from = Link::From(socket("braid.curves"));
        let behind = (Some(&from), Behind::Inserted);
        let (edit, new) = add(&document, def, Pos2::ZERO, behind, None);
        let after = apply(&document, &edit);
        assert_eq!(after.wires(&new, "placements"), [socket("braid.curves")]);
        assert_eq!(after.links[&socket("fill.curves")], [socket("braid.curves")]);
        assert_eq!(after.links[&socket("colour.curves")], [socket("merge.curves")]);
        let hair = Socket::new(new, "curves");
        assert_eq!(after.links[&socket("merge.curves")], [socket("fill_width.curves"), hair]);
    }

    #[test]
    fn of_several_scalps_the_nearest_upstream_is_wired() {
        let text = r#"(format: 1, title: "x", nodes: {
            "bust": (kind: "head"), "cut": (kind: "partings"), "again": (kind: "partings"),
            "guides": (kind: "scatter_guides"), "long": (kind: "resample"), "bare": (kind: "resample"),
        }, links: {
            "cut.scalp": "bust.scalp", "again.scalp": "cut.scalp",
            "guides.scalp": "cut.scalp", "long.curves": "guides.curves",
        })"#;
        let mut document = coif_graphs::file::read(text).unwrap().document;
        let def = |kind: &str| coif_nodes::by_id(kind).unwrap();
        let wired = |document: &Document, link: Option<Link>| {
            let (edit, new) = add(
                document,
                def("interpolate"),
                Pos2::ZERO,
                (link.as_ref(), Behind::Branch),
                None,
            );
            apply(document, &edit).wires(&new, "scalp").to_vec()
        };
        let from = |text: &str| Some(Link::From(socket(text)));
        // Two steps up, and not the head behind it nor the one that stands on it.
        assert_eq!(wired(&document, from("long.curves")), [socket("cut.scalp")]);
        // Beside nothing, and beside what stands on nothing: the last of the only head.
        assert_eq!(wired(&document, None), [socket("again.scalp")]);
        assert_eq!(wired(&document, from("bare.curves")), [socket("again.scalp")]);
        // Of two heads nobody knows which.
        let head = document.fresh_node("head", &id("other"));
        document.nodes.insert(id("other"), head.into());
        assert_eq!(wired(&document, None), []);
        assert_eq!(wired(&document, from("long.curves")), [socket("cut.scalp")]);
    }

    #[test]
    fn copies_keep_their_wires_and_lie_beside() {
        let document = document("cornrows");
        let faces = faces(&document);
        let nodes: BTreeSet<NodeId> = ["braid", "fill"].map(id).into();
        let (edit, made) = duplicate(&document, &faces, &nodes, None).unwrap();
        let after = apply(&document, &edit);
        assert_eq!((made.len(), after.nodes.len()), (2, document.nodes.len() + 2));
        let wired = after.wires(&made[1], "curves");
        assert_eq!(wired[0].node, made[0]);
        assert_eq!(after.layout[&made[0]], Point(440.0 + 32.0, 32.0));
        assert!(paste(&document, "no nodes at all", Pos2::ZERO, None).is_err());
    }

    #[test]
    fn a_frame_holds_the_nodes_it_was_drawn_round() {
        let document = document("cornrows");
        let faces = faces(&document);
        let nodes: BTreeSet<NodeId> = ["rows", "braid"].map(id).into();
        let (edit, name) = frame(&document, faces.bounds(&nodes).unwrap(), None);
        let after = apply(&document, &edit);
        assert_eq!(framed(&after.frames[&name], &faces), nodes);
    }
}
