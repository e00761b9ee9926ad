//! What the actions of the canvas do: each reads the state and gives what happened.

use super::Canvas;
use super::edits::{self, Link};
use super::finder::{Finder, FinderChoice, Task};
use super::naming::{Naming, RenameTarget};
use super::wires::{Wire, of_output};
use crate::core::event::Event;
use crate::core::faces::arrange::{self, Alignment, GAP};
use crate::core::faces::{FOOTER, Faces, HEADER, ROW, WIDTH, comes_by_wire};
use crate::core::notes::Note;
use crate::core::shown::first_output;
use crate::core::state::{Select, State};
use coif_graphs::document::edit::{Edit, between};
use coif_graphs::document::{Document, Frame, Node, NodeId, Point, Socket, graph, groups, wiring};
use coif_nodes::declared;
use coif_nodes::define::{NodeDef, Type};
use egui::{Pos2, Rect, Vec2, pos2, vec2};
use std::collections::BTreeSet;

/// Whether an edit does nothing at all.
pub(super) fn is_nothing(edit: &Edit) -> bool {
    matches!(edit, Edit::Several(edits) if edits.iter().all(is_nothing))
}

/// One edit, as what happened; nothing where it does nothing.
fn edited(edit: Edit) -> Vec<Event> {
    if is_nothing(&edit) { vec![] } else { vec![Event::Edit(edit)] }
}

/// Whether nothing but heads is wired to a node, and it feeds nobody.
pub(super) fn is_loose(document: &Document, id: &NodeId) -> bool {
    let heads_only = graph::inputs_of(document, id)
        .flat_map(|(_, from)| from)
        .all(|from| wiring::output_type(document, from) == Some(Type::Scalp));
    heads_only && !document.links.values().flatten().any(|from| from.node == *id)
}

/// A column for a node that is inserted behind another: what comes behind moves to the right, as far as room is missing. Gives the
/// node's corner, too.
pub(super) fn make_room(
    document: &Document,
    faces: &Faces,
    behind: &NodeId,
    def: &NodeDef,
) -> (Edit, Pos2) {
    let from = faces.rect(behind).unwrap_or(Rect::ZERO);
    let mut moved = graph::downstream(document, [behind]);
    moved.retain(|id| id != behind && faces.all.contains_key(id));
    let left = moved.iter().filter_map(|id| Some(faces.rect(id)?.left())).reduce(f32::min);
    let room = left.map_or(f32::INFINITY, |left| left - from.right());
    let missing = (WIDTH + 2.0 * GAP.x - room).clamp(0.0, WIDTH + GAP.x);
    let stays = |id: &&NodeId| missing == 0.0 || !moved.contains(*id);
    let taken: Vec<Rect> = faces.all.keys().filter(stays).filter_map(|id| faces.rect(id)).collect();
    let corner = pos2(from.right() + GAP.x, from.top());
    let corner = arrange::free_place(&taken, corner, size_of_new(def));
    let moved = moved.into_iter().filter(|_| missing > 0.0);
    let moves = arrange::moves(moved.filter_map(|id| {
        let corner = *faces.corners.get(&id)?;
        Some((id, corner + vec2(missing, 0.0)))
    }));
    (moves, corner)
}

fn size_of_new(def: &NodeDef) -> Vec2 {
    let rows = def.inputs.iter().filter(|input| comes_by_wire(input.ty)).count();
    let rows = rows.max(def.outputs.len()) as f32;
    vec2(WIDTH, HEADER + rows * ROW + FOOTER)
}

/// What is said of a node that was put between others; nothing where it was not.
pub(super) fn said_of_insertion(
    before: &Document,
    after: &Document,
    id: &NodeId,
) -> Option<String> {
    let rewired = after.links.iter().filter(|(to, wires)| {
        to.node != *id
            && wires.iter().any(|wire| wire.node == *id)
            && before.links.get(*to) != Some(*wires)
    });
    let takers: BTreeSet<&NodeId> = rewired.map(|(to, _)| &to.node).collect();
    let now = graph::inputs_of(after, id).flat_map(|(_, wires)| wires);
    // Of all that feeds it, what fed these before.
    let fed = now.map(|wire| &wire.node).find(|feeder| {
        before.links.iter().any(|(to, wires)| {
            takers.contains(&to.node) && wires.iter().any(|wire| wire.node == **feeder)
        })
    })?;
    let name = |id| after.name_of(id);
    let mut takers = takers.into_iter();
    let behind = match (takers.next(), takers.len()) {
        (None, _) => return None,
        (Some(one), 0) => format!("between {} and {}", name(fed), name(one)),
        (_, more) => format!("between {} and {} nodes", name(fed), more + 1),
    };
    Some(format!("{}: inserted {behind}", name(id)))
}

/// The corner of a node that is added: its end where the wire was dropped, else beside what it is
/// wired to, else round `at`, and over no other.
pub(super) fn place_new(
    faces: &Faces,
    def: &NodeDef,
    at: Pos2,
    link: Option<&Link>,
    dropped: bool,
) -> Pos2 {
    let first_row = HEADER + ROW / 2.0;
    let (wanted, fixed) = match link {
        Some(Link::From(_)) if dropped => (at - vec2(0.0, first_row), true),
        Some(Link::To(..)) if dropped => (at - vec2(WIDTH, first_row), true),
        Some(Link::From(socket)) => {
            let beside = faces.rect(&socket.node).map(|r| pos2(r.right() + GAP.x, r.top()));
            (beside.unwrap_or(at), false)
        }
        Some(Link::To(socket, _)) => {
            let beside = faces.rect(&socket.node);
            (beside.map_or(at, |r| pos2(r.left() - GAP.x - WIDTH, r.top())), false)
        }
        None => (at - vec2(WIDTH / 2.0, HEADER / 2.0), false),
    };
    if fixed {
        return wanted;
    }
    let taken: Vec<Rect> = faces.all.keys().filter_map(|id| faces.rect(id)).collect();
    arrange::free_place(&taken, wanted, size_of_new(def))
}

/// The drag of a frame or its corner ended.
pub(super) fn put_frame(
    state: &State,
    faces: &Faces,
    name: &str,
    nodes: Option<&BTreeSet<NodeId>>,
    by: Vec2,
) -> Vec<Event> {
    let Some(frame) = state.document.frames.get(name) else { return vec![] };
    let rect = super::frames::held(frame, by, nodes.is_none());
    let frame = Frame {
        at: arrange::point(rect.min),
        size: Point(rect.width().round(), rect.height().round()),
        ..frame.clone()
    };
    let mut edits = vec![Edit::SetFrame { name: name.to_owned(), frame: Some(frame) }];
    let moved = nodes.into_iter().flatten();
    let moved = moved.filter_map(|id| Some((id.clone(), *faces.corners.get(id)? + by)));
    edits.push(arrange::moves(moved));
    edited(Edit::Several(edits))
}

/// The braids that are meant: those of the active node, else of the first in sight that makes some.
pub(super) fn braid(state: &State) -> Option<Socket> {
    let document = &state.document;
    let makes = |id: &&NodeId| document.node(id.as_str()).is_some_and(|node| node.kind == BRAID);
    let mut shown = document.nodes.keys().filter(|id| id.group() == state.group);
    let braid = state.active().filter(makes).or_else(|| shown.find(makes))?;
    Some(Socket::new(braid.clone(), "curves"))
}

/// The kind of node that braids.
const BRAID: &str = "lissajous_braid";

/// What a node gives that others can be made of: of parameters the hair that is made by them.
fn gives(document: &Document, id: &NodeId) -> Option<Socket> {
    let kind = |id: &NodeId| document.node(id.as_str()).map_or("", |node| node.kind.as_str());
    let of_parameters = || {
        let behind = graph::downstream(document, [id]);
        let is_output = |to: &Socket| behind.contains(&to.node) && kind(&to.node) == "groom_output";
        let mut outputs = document.links.iter().filter(|(to, _)| is_output(to));
        outputs.find_map(|(_, from)| from.first().cloned())
    };
    let own = first_output(document, id);
    own.or_else(|| (kind(id) == declared::PARAMETERS).then(of_parameters).flatten())
}

impl Canvas {
    /// Opens the search for a node: where the pointer is, else beside the active node, to which it
    /// proposes a wire.
    pub(super) fn open_search(&mut self, state: &State, faces: &Faces, clicked: Option<Pos2>) {
        let link = match (clicked, state.active()) {
            (None, Some(id)) => gives(&state.document, id).map(Link::From),
            _ => None,
        };
        let beside = match &link {
            Some(Link::From(from)) => Some(&from.node),
            _ => None,
        };
        let on_screen = clicked.unwrap_or_else(|| self.opens_at(faces, beside));
        let at = self.to_canvas(on_screen);
        let task = Task::Add { at, link, dropped: false };
        self.memory.finder = Some(Finder::new(task, on_screen));
    }

    pub(super) fn add(&mut self, state: &State) -> Vec<Event> {
        let faces = self.cache.of(state);
        self.open_search(state, &faces, None);
        vec![]
    }

    pub(super) fn swap(&mut self, state: &State) -> Vec<Event> {
        if let Some(id) = state.active() {
            let at = self.beside(state, id);
            self.memory.finder = Some(Finder::new(Task::Swap(id.clone()), at));
        }
        vec![]
    }

    pub(super) fn connect(&mut self, state: &State) -> Vec<Event> {
        if let Some(id) = state.active() {
            let at = self.beside(state, id);
            self.memory.finder = Some(Finder::new(Task::Connect(id.clone()), at));
        }
        vec![]
    }

    fn beside(&mut self, state: &State, id: &NodeId) -> Pos2 {
        let faces = self.cache.of(state);
        self.opens_at(&faces, Some(id))
    }

    /// Puffs grow at the tips of the braids, joined with their hair.
    pub(super) fn puffs_at_ends(&mut self, state: &State) -> Vec<Event> {
        let (mut out, faces) = (vec![], self.cache.of(state));
        let puff = coif_nodes::by_id("sphere_puff");
        if let Some((def, braid)) = puff.zip(braid(state)) {
            let corner = faces.rect(&braid.node).unwrap_or(Rect::ZERO).right_top();
            let task = Task::Add { at: corner, link: Some(Link::From(braid)), dropped: false };
            let at_tips = Some((edits::PLACES_AT, "tips"));
            self.picked(state, &faces, &task, FinderChoice::Kind(def, true, at_tips), &mut out);
        }
        out
    }

    /// Where a search opens: at the pointer, else beside a node where it is in sight, else in the middle.
    fn opens_at(&self, faces: &Faces, beside: Option<&NodeId>) -> Pos2 {
        let area = self.area.unwrap_or(Rect::ZERO);
        let beside = beside.and_then(|id| faces.rect(id));
        let beside = beside.map(|rect| rect.right_top() + vec2(12.0, 0.0));
        let places = [self.memory.pointer, beside].into_iter().flatten();
        let mut places = places.map(|at| self.to_screen(at));
        let middle = || area.center() - vec2(150.0, 80.0);
        places.find(|at| area.contains(*at)).unwrap_or_else(middle)
    }

    /// Removes what is selected: a bend, wires, a frame, or nodes, whose wires heal.
    pub(super) fn delete(&mut self, state: &State) -> Vec<Event> {
        let document = &state.document;
        if !state.selection.nodes.is_empty() {
            return edited(wiring::remove_healed(document, &state.selection.nodes));
        }
        if let Some((wire, number)) = self.memory.bend.take() {
            let mut bends = document.bends_of(&wire.to, wire.at).to_vec();
            if number < bends.len() {
                bends.remove(number);
                return edited(Edit::SetBends { to: wire.to, at: wire.at, bends });
            }
        }
        if !self.memory.wires.is_empty() {
            return edited(edits::cut(std::mem::take(&mut self.memory.wires)));
        }
        match self.memory.frame.take() {
            Some(name) => edited(Edit::SetFrame { name, frame: None }),
            None => vec![],
        }
    }

    /// Whether there is something to remove.
    pub(super) fn holds_something(&self, state: &State) -> bool {
        !state.selection.nodes.is_empty()
            || self.memory.bend.is_some()
            || !self.memory.wires.is_empty()
            || self.memory.frame.is_some()
    }

    pub(super) fn copy(&mut self, state: &State, faces: &Faces, ctx: &egui::Context) {
        // A frame is copied with what it holds.
        let frame = self.memory.frame.as_ref().and_then(|name| state.document.frames.get(name));
        let framed = frame.map(|frame| edits::framed(frame, faces)).unwrap_or_default();
        let selected = &state.selection.nodes;
        let nodes = if selected.is_empty() { &framed } else { selected };
        if !nodes.is_empty() {
            ctx.copy_text(edits::placed_copy(&state.document, faces, nodes));
        }
    }

    pub(super) fn paste(&mut self, state: &State, faces: &Faces, text: &str) -> Vec<Event> {
        let pointer = self.memory.pointer.filter(|at| self.seen().contains(*at));
        let at = pointer.unwrap_or_else(|| {
            let all = faces.bounds(&state.selection.nodes);
            all.map_or(self.seen().center(), |all| all.min + vec2(32.0, 32.0))
        });
        match edits::paste(&state.document, text, at, state.group.as_ref()) {
            Ok((edit, made)) => vec![Event::Edit(edit), Event::Select(Select::Nodes(made))],
            Err(why) => vec![Event::Say(Note::warning(format!("nothing was pasted: {why}")))],
        }
    }

    pub(super) fn duplicate(&mut self, state: &State) -> Vec<Event> {
        let faces = self.cache.of(state);
        match edits::duplicate(
            &state.document,
            &faces,
            &state.selection.nodes,
            state.group.as_ref(),
        ) {
            Ok((edit, made)) => vec![Event::Edit(edit), Event::Select(Select::Nodes(made))],
            Err(why) => vec![Event::Say(Note::warning(why))],
        }
    }

    pub(super) fn disconnect(&mut self, state: &State) -> Vec<Event> {
        if !self.memory.wires.is_empty() {
            return edited(edits::cut(std::mem::take(&mut self.memory.wires)));
        }
        edited(wiring::disconnect(&state.document, &state.selection.nodes))
    }

    pub(super) fn bypass(&mut self, state: &State) -> Vec<Event> {
        let active = state.active().and_then(|id| state.document.node(id.as_str()));
        let bypass = !active.is_some_and(|node| node.bypass);
        let nodes = state.selection.nodes.iter();
        edited(Edit::Several(nodes.map(|id| Edit::SetBypass { id: id.clone(), bypass }).collect()))
    }

    pub(super) fn collapse(&mut self, state: &State) -> Vec<Event> {
        let is = |id: &NodeId| state.document.collapsed.contains(id);
        let collapsed = !state.active().is_some_and(is);
        let nodes = state.selection.nodes.iter();
        let all = nodes.map(|id| Edit::SetCollapsed { id: id.clone(), collapsed });
        edited(Edit::Several(all.collect()))
    }

    pub(super) fn display(&mut self, state: &State) -> Vec<Event> {
        let shown = state.document.display.as_ref();
        self.memory.solo = None;
        state
            .active()
            .map(|id| Event::Display((shown != Some(id)).then(|| id.clone())))
            .into_iter()
            .collect()
    }

    pub(super) fn pin(&mut self, state: &State) -> Vec<Event> {
        let id = state.active();
        vec![Event::Pin(id.filter(|id| state.pinned.as_ref() != Some(id)).cloned())]
    }

    /// Shows the active node, and at the next call what was shown before.
    pub(super) fn solo(&mut self, state: &State) -> Vec<Event> {
        let shown = &state.document.display;
        if let Some((soloed, before)) = self.memory.solo.take()
            && *shown == Some(soloed)
        {
            let there = before.filter(|id| state.document.nodes.contains_key(id));
            return vec![Event::Display(there)];
        }
        let Some(id) = state.active() else { return vec![] };
        self.memory.solo = Some((id.clone(), shown.clone()));
        vec![Event::Display(Some(id.clone()))]
    }

    pub(super) fn rename(&mut self, state: &State) -> Vec<Event> {
        if let Some(id) = state.active() {
            let name = state.document.name_of(id).into_owned();
            self.memory.name_node(id.clone(), &name);
        } else if let Some(name) = self.memory.frame.clone()
            && let Some(frame) = state.document.frames.get(&name)
        {
            self.memory.name_frame(name, &frame.text);
        }
        vec![]
    }

    pub(super) fn note(&mut self, state: &State) -> Vec<Event> {
        if let Some(id) = state.active() {
            let note = state.document.node(id.as_str()).map_or("", |node| &node.note);
            self.memory.naming = Some(Naming::new(RenameTarget::Note(id.clone()), note));
        }
        vec![]
    }

    /// Puts a frame round the selected nodes and asks for its title.
    pub(super) fn frame_nodes(&mut self, state: &State) -> Vec<Event> {
        let faces = self.cache.of(state);
        let Some(round) = faces.bounds(&state.selection.nodes) else { return vec![] };
        let (edit, name) = edits::frame(&state.document, round, state.group.as_ref());
        self.memory.select_frame(Some(name.clone()));
        self.memory.name_frame(name, "");
        edited(edit)
    }

    /// Puts the selected nodes into a group and asks for its name.
    pub(super) fn group(&mut self, state: &State) -> Vec<Event> {
        match groups::make(&state.document, &state.selection.nodes, "group") {
            Ok((after, group)) => {
                self.memory.name_node(group.clone(), "");
                let edit = between(&state.document, &after);
                vec![
                    Event::Begin("Nodes grouped".to_owned()),
                    Event::Edit(edit),
                    Event::End,
                    Event::Select(Select::Nodes(vec![group])),
                ]
            }
            Err(why) => vec![Event::Say(Note::warning(why))],
        }
    }

    /// Takes the selected groups apart.
    pub(super) fn ungroup(&mut self, state: &State) -> Vec<Event> {
        let mut after = state.document.clone();
        let mut freed = vec![];
        for id in &state.selection.nodes {
            if !state.document.node(id.as_str()).is_some_and(Node::is_group) {
                freed.push(id.clone());
                continue;
            }
            match groups::ungroup(&after, id) {
                Ok((apart, nodes)) => {
                    after = apart;
                    freed.extend(nodes);
                }
                Err(why) => return vec![Event::Say(Note::warning(why).of(id.clone()))],
            }
        }
        vec![
            Event::Begin("Group taken apart".to_owned()),
            Event::Edit(between(&state.document, &after)),
            Event::End,
            Event::Select(Select::Nodes(freed)),
        ]
    }

    /// Shows what is in the active group.
    pub(super) fn enter(&mut self, state: &State) -> Vec<Event> {
        let group = state
            .active()
            .filter(|id| state.document.node(id.as_str()).is_some_and(Node::is_group));
        group.map(|id| Event::Enter(Some(id.clone()))).into_iter().collect()
    }

    /// Shows what the group is in.
    pub(super) fn leave(&mut self, state: &State) -> Vec<Event> {
        let group = state.group.as_ref();
        group.map(|group| Event::Enter(group.group())).into_iter().collect()
    }

    pub(super) fn tidy(&mut self, state: &State) -> Vec<Event> {
        let faces = self.cache.of(state);
        let mut nodes = state.selection.nodes.clone();
        if nodes.len() < 2 {
            nodes = faces.all.keys().cloned().collect();
        }
        edited(arrange::tidied(&state.document, &faces, &nodes))
    }

    pub(super) fn align(&mut self, state: &State, line: Alignment) -> Vec<Event> {
        edited(arrange::aligned(&self.cache.of(state), &state.selection.nodes, line))
    }

    pub(super) fn distribute(&mut self, state: &State) -> Vec<Event> {
        edited(arrange::distributed(&self.cache.of(state), &state.selection.nodes))
    }

    /// Moves the selected nodes a little.
    pub(super) fn nudge(&mut self, state: &State, by: Vec2) -> Vec<Event> {
        let faces = self.cache.of(state);
        let nodes = state.selection.nodes.iter();
        let to = nodes.filter_map(|id| Some((id.clone(), *faces.corners.get(id)? + by)));
        let edit = arrange::moves(to);
        if is_nothing(&edit) { vec![] } else { vec![Event::Nudge(edit)] }
    }

    /// Selects the next node: along wires to the sides, by direction where there is none.
    pub(super) fn step(&mut self, state: &State, way: Vec2) -> Vec<Event> {
        let faces = self.cache.of(state);
        let document = &state.document;
        let next = match state.active() {
            None => faces.all.keys().next().cloned(),
            Some(id) => {
                let along = if way.x > 0.0 {
                    let fed = document.links.iter().find(|(_, f)| f.iter().any(|f| f.node == *id));
                    fed.map(|(to, _)| to.node.clone())
                } else if way.x < 0.0 {
                    let wires = faces.all.get(id).into_iter().flat_map(|face| &face.inputs);
                    let mut wires = wires.filter_map(|plug| {
                        Wire { to: plug.socket.clone(), at: plug.wire? }.from(document).cloned()
                    });
                    wires.next().map(|from| from.node)
                } else {
                    None
                };
                along
                    .filter(|id| faces.all.contains_key(id))
                    .or_else(|| arrange::neighbour(&faces, id, way))
            }
        };
        let Some(id) = next else { return vec![] };
        self.memory.wires.clear();
        self.memory.select_frame(None);
        self.reveal(&faces, &id);
        vec![Event::Select(Select::Nodes(vec![id]))]
    }

    /// Selects one wire after the other of those that end at the active node, or leave it where none
    /// does.
    pub(super) fn next_wire(&mut self, state: &State) -> Vec<Event> {
        let document = &state.document;
        let last = self.memory.wires.first().cloned();
        let node =
            state.active().cloned().or_else(|| last.as_ref().map(|wire| wire.to.node.clone()));
        let Some(id) = node else { return vec![] };
        let faces = self.cache.of(state);
        let Some(face) = faces.all.get(&id) else { return vec![] };
        let inputs = face.inputs.iter();
        let mut all: Vec<Wire> =
            inputs.filter_map(|p| Some(Wire { to: p.socket.clone(), at: p.wire? })).collect();
        if all.is_empty() {
            all = face.outputs.iter().flat_map(|plug| of_output(document, &plug.socket)).collect();
        }
        let at = last.and_then(|last| all.iter().position(|wire| *wire == last));
        let Some(next) = all.get(at.map_or(0, |at| (at + 1) % all.len())) else { return vec![] };
        self.memory.wires = [next.clone()].into();
        vec![Event::Select(Select::Nodes(vec![]))]
    }

    /// Moves the selected wire among those of its input.
    pub(super) fn reorder(&mut self, state: &State, by: isize) -> Vec<Event> {
        let wires = &self.memory.wires;
        let (Some(wire), 1) = (wires.first().cloned(), wires.len()) else { return vec![] };
        let count = state.document.wires(&wire.to.node, &wire.to.name).len();
        let Some(at) = wire.at.checked_add_signed(by).filter(|at| *at < count) else {
            return vec![];
        };
        self.memory.wires = [Wire { to: wire.to.clone(), at }].into();
        edited(Edit::Reorder { to: wire.to, from: wire.at, at })
    }

    pub(super) fn select_all(&mut self, state: &State) -> Vec<Event> {
        vec![Event::Select(Select::Nodes(self.cache.of(state).all.keys().cloned().collect()))]
    }

    pub(super) fn select_flow(&mut self, state: &State, down: bool) -> Vec<Event> {
        let nodes = &state.selection.nodes;
        let mut all = if down {
            graph::downstream(&state.document, nodes)
        } else {
            graph::upstream(&state.document, nodes)
        };
        // The active node stays the active one.
        let active = state.active().cloned();
        let group = state.group.as_ref();
        all.retain(|id| Some(id) != active.as_ref() && id.group().as_ref() == group);
        vec![Event::Select(Select::Nodes(all.into_iter().chain(active).collect()))]
    }

    /// Brings nodes into sight: those of the selection, or all.
    pub(super) fn fit(&mut self, state: &State, selection: bool) -> Vec<Event> {
        let nodes = &state.selection.nodes;
        self.memory.look_at = Some(if selection { nodes.clone() } else { BTreeSet::new() });
        vec![]
    }
}
