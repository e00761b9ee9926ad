//! The node canvas: the document's graph, drawn and edited.
//!
//! Scene, zoom, selection, dragging with alignment and culling are egui_graph's; wires, sockets and
//! everything that changes the document are ours, because the document owns the graph. The room reads
//! the state and says what happened; it never changes anything itself. What it keeps between frames is
//! what hands and eyes hold: the view, an open search, a wire in the hand.
//!
//! A canvas may be for looking alone (`Canvas::to_look_at`): it draws a state, is moved and zoomed, and says nothing.
//!
//! Not kept with a groom: the view, selected wires, the last kinds that were added.

mod actions;
mod commands;
mod edits;
mod finder;
mod frames;
mod hand;
mod look;
mod marks;
mod menu;
mod naming;
mod node;
mod overlays;
mod scene;
mod search;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod text;
mod view;
mod wires;

pub(crate) use actions::ACTIONS;
pub(crate) use marks::{DiffMarks, Mark, marks};

use crate::core::event::Event;
use crate::core::faces::{self, FaceCache, Faces, arrange};
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::state::{Select, State};
use crate::core::templates;
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Point, Socket, wiring};
use edits::Link;
use egui::{Pos2, Rect, Ui, Vec2, vec2};
use finder::{Finder, Task};
use hand::{Aim, Fixed, Hand, Loose};
use naming::{Naming, RenameTarget};
use scene::{DrawnScene, Scene};
use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;
use wires::{Run, Shake, Wire};

/// The room.
#[derive(Default)]
pub struct Canvas {
    view: egui_graph::View,
    /// Where it was drawn last, on the screen.
    area: Option<Rect>,
    cache: FaceCache,
    /// The nodes that were there last, to notice another document.
    known: BTreeSet<NodeId>,
    memory: Memory,
    /// What is drawn is looked at alone.
    looks: bool,
}

/// What hands and eyes hold.
#[derive(Default)]
struct Memory {
    hand: Hand,
    aim: Option<Aim>,
    /// The node under a wire in the hand, and those of its inputs that take the wire and are shown for that alone.
    open: Option<(NodeId, BTreeSet<Socket>)>,
    /// Where the hand took hold, on the canvas.
    grabbed: Option<Pos2>,
    finder: Option<Finder>,
    /// A wire on which a node is to be inserted, by its menu.
    insert_at: Option<(Wire, Pos2)>,
    naming: Option<Naming>,
    /// Somebody asked for the menu with a key.
    menu_by_key: bool,
    /// Selected wires; nodes are not selected then.
    wires: BTreeSet<Wire>,
    /// The wire under the pointer.
    hovered: Option<Wire>,
    /// The selected bend.
    bend: Option<(Wire, usize)>,
    /// The selected frame.
    frame: Option<String>,
    /// Nodes are being dragged.
    moving: bool,
    /// The drag was given up; nothing moves until the button is released.
    given_up: bool,
    shake: Shake,
    /// The wire on which the dragged node would be inserted.
    drop_on: Option<Wire>,
    /// Kinds that were added lately, the last first.
    recent: Vec<String>,
    /// The node that is shown alone for a while, and what was displayed before.
    solo: Option<(NodeId, Option<NodeId>)>,
    /// The pointer on the canvas.
    pointer: Option<Pos2>,
    /// The wheel turned last, not a touchpad.
    wheel: bool,
    /// What the menu asked of the clipboard.
    clipboard: Option<Clipboard>,
    /// A paste was asked for and has not come yet.
    pasting: bool,
    /// What is to be brought into sight when the room is drawn next.
    look_at: Option<BTreeSet<NodeId>>,
    /// What differs from another document.
    marks: Option<Arc<DiffMarks>>,
}

impl Memory {
    /// Whether nothing is held and nothing is open.
    fn is_quiet(&self) -> bool {
        matches!(self.hand, Hand::Empty)
            && !self.moving
            && self.finder.is_none()
            && self.naming.is_none()
    }
    /// Remembers that a kind was added.
    fn used(&mut self, def: &coif_nodes::define::NodeDef) {
        self.recent.retain(|kind| kind != def.id);
        self.recent.insert(0, def.id.to_owned());
        self.recent.truncate(8);
    }
    fn select_frame(&mut self, name: Option<String>) {
        self.frame = name;
        self.bend = None;
    }
    fn name_node(&mut self, id: NodeId, now: &str) {
        self.naming = Some(Naming::new(RenameTarget::Node(id), now));
    }
    fn name_frame(&mut self, name: String, now: &str) {
        self.naming = Some(Naming::new(RenameTarget::Frame(name), now));
    }
}

/// What the menu asks of the clipboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Clipboard {
    Cut,
    Copy,
    Paste,
}

impl Canvas {
    /// A canvas for a second document, which is looked at alone.
    pub(crate) fn to_look_at() -> Self {
        Self { looks: true, ..Self::default() }
    }

    /// The id of the graph's widgets.
    fn graph_id(&self) -> egui::Id {
        egui_graph::id(if self.looks { "coif canvas beside" } else { "coif canvas" })
    }

    /// Forgets what it worked out of a document that is gone: it may be covered for long. All of the next one is brought into sight.
    pub(crate) fn forget(&mut self) {
        self.cache = FaceCache::default();
        self.look_at_all();
    }

    /// Marks nodes and wires, or none.
    pub(crate) fn mark(&mut self, marks: Option<Arc<DiffMarks>>) {
        self.memory.marks = marks;
    }

    /// Brings everything into sight when the room is drawn next.
    pub(crate) fn look_at_all(&mut self) {
        self.memory.look_at = Some(BTreeSet::new());
    }

    /// Where a node of a state stands, where the group that is shown has it.
    pub(crate) fn place(&mut self, state: &State, id: &NodeId) -> Option<Rect> {
        self.cache.of(state).rect(id)
    }

    /// Whether a search is open.
    pub(crate) fn searches(&self) -> bool {
        self.memory.finder.is_some()
    }

    /// Whether a search or a field takes what is typed.
    pub(crate) fn types(&self) -> bool {
        self.searches() || self.memory.naming.is_some()
    }

    /// Opens the menu of the active node or, where there is none, of the empty canvas.
    pub(crate) fn open_menu_by_key(&mut self) {
        self.memory.menu_by_key = true;
    }

    /// Closes the search, or the field of a name, which is not kept; whether there was one.
    pub(crate) fn close_search(&mut self) -> bool {
        self.memory.finder.take().is_some() || self.memory.naming.take().is_some()
    }

    /// What stands over the canvas and belongs to it.
    pub(crate) fn owns(id: egui::Id) -> bool {
        id == frames::map_id() || id == overlays::trail_id()
    }

    /// Whether the hand holds something.
    pub(crate) fn holds(&self) -> bool {
        !matches!(self.memory.hand, Hand::Empty)
    }

    /// One frame of the room.
    pub fn ui(&mut self, state: &State, ui: &mut Ui, out: &mut Vec<Event>) {
        let area = ui.available_rect_before_wrap();
        if area.width() < 8.0 || area.height() < 8.0 {
            // What is not seen takes no keys.
            self.close_search();
            return;
        }
        let more = self.memory.open.as_ref().map(|(_, inputs)| inputs.clone());
        let faces = self.cache.opened(state, &more.unwrap_or_default());
        self.meet(state, &faces, area);
        self.steer(ui, area);
        if !self.looks {
            self.clipboard(state, &faces, ui, out);
        }
        self.settle(state, &faces);
        let pointer = ui.input(|i| i.pointer.latest_pos());
        let over =
            pointer.filter(|at| area.contains(*at) || !matches!(self.memory.hand, Hand::Empty));
        self.memory.pointer = over.map(|at| self.to_canvas(at));
        ui.painter().rect_filled(area, 0.0, theme::SUNKEN.of(ui));
        let selected: HashSet<egui_graph::NodeId> =
            state.selection.nodes.iter().map(|id| egui_graph::NodeId::new(id.as_str())).collect();
        let (id, scale, looks) = (self.graph_id(), self.scale(), self.looks);
        let Self { view, memory, .. } = self;
        let given_up = memory.given_up || looks;
        let scene = Scene { state, faces: &faces, pointer: memory.pointer, memory, out, scale };
        let shown = ui.scope(|ui| {
            // The crate finds sockets within this; ours lie over them and take the pointer.
            ui.spacing_mut().interact_size = vec2(8.0, 8.0);
            ui.visuals_mut().window_corner_radius = egui::CornerRadius::ZERO;
            egui_graph::Graph::from_id(id)
                .background(false)
                .dot_grid(false)
                .zoom_range(view::ZOOM)
                .immutable(given_up)
                .selected_nodes(selected)
                .align_threshold(6.0)
                .show(view, ui, |ui, show| {
                    if looks {
                        ui.visuals_mut().disabled_alpha = 1.0;
                        ui.disable();
                    }
                    scene.show(ui, show)
                })
        });
        let shown = shown.inner;
        let found = shown.inner;
        if looks {
            return;
        }
        let keys = ui.input(|i| i.modifiers);
        if let Some(nodes) = shown.selection_changed {
            self.selected(state, &faces, &nodes, keys, ui, out);
        }
        self.background(state, &faces, &shown.response, &found, ui, out);
        self.dragged(state, &faces, &found, shown.nodes_moved, ui, out);
        self.carry(state, &faces, &found, ui, area, out);
        self.overlays(state, &faces, &found, ui, area, out);
        if let Some(at) = self.memory.pointer.filter(|_| ui.rect_contains_pointer(area)) {
            out.extend(templates::dropped(ui.ctx(), arrange::point(at)));
        }
    }

    /// The middle of what is in sight, where a node can lie; none before it was drawn.
    pub(crate) fn middle(&self, document: &Document) -> Option<Point> {
        let area = self.area.filter(|_| view::is_sound(self.view.scene_rect))?;
        let at = self.to_canvas(area.center()) - vec2(faces::WIDTH / 2.0, 40.0);
        Some(arrange::free_in(document, arrange::point(at), Point(faces::WIDTH, 120.0)))
    }

    /// Notices another document, and forgets what is gone.
    fn meet(&mut self, state: &State, faces: &Faces, area: Rect) {
        let now: BTreeSet<NodeId> = faces.all.keys().cloned().collect();
        let stranger = self.known.is_disjoint(&now) && now.len() > 1;
        let unseen = self.area.is_none() || !view::is_sound(self.view.scene_rect);
        self.area = Some(area);
        if stranger || unseen {
            self.view.layout.clear();
            self.look_at(faces, &now);
        }
        if self.known != now {
            // What was just added, here or by the pen, is seen; its id may be that of a node it replaced.
            let active = state.active().filter(|_| !now.is_subset(&self.known));
            let added = active.filter(|_| !stranger && !unseen).and_then(|id| {
                let title = faces.rect(id)?.split_top_bottom_at_fraction(0.3).0;
                (!self.seen().contains_rect(title)).then_some(id)
            });
            if let Some(added) = added {
                self.reveal(faces, added);
            }
            self.memory.wires.retain(|wire| wire.from(&state.document).is_some());
            self.known = now;
        }
        if let Some(nodes) = self.memory.look_at.take() {
            let nodes = if nodes.is_empty() { &self.known } else { &nodes };
            self.look_at(faces, &nodes.clone());
        }
        let memory = &mut self.memory;
        memory.wires.retain(|wire| wire.from(&state.document).is_some());
        let gone = |name: &String| !state.document.frames.contains_key(name);
        if memory.frame.as_ref().is_some_and(gone) {
            memory.frame = None;
        }
        let document = &state.document;
        if memory.bend.as_ref().is_some_and(|(w, n)| document.bends_of(&w.to, w.at).len() <= *n) {
            memory.bend = None;
        }
        if memory.naming.as_ref().is_some_and(|naming| !naming.is_there(document)) {
            memory.naming = None;
        }
        if let Hand::Wire(loose) = &memory.hand {
            let there = |id: &NodeId| document.nodes.contains_key(id);
            let node = match &loose.fixed {
                Fixed::Output(socket) | Fixed::Bundle(socket, _) => &socket.node,
                Fixed::Input(plug) => &plug.socket.node,
            };
            let lifted = loose.lifted.as_ref().is_none_or(|wire| wire.from(document).is_some());
            if !there(node) || !lifted {
                memory.hand = Hand::Empty;
            }
        }
    }

    /// Tells the crate where nodes stand: the document's places, but for what is being dragged.
    fn settle(&mut self, state: &State, faces: &Faces) {
        let with_frame = match &self.memory.hand {
            Hand::Frame { nodes: Some(nodes), by, .. } => Some((nodes.clone(), *by)),
            _ => None,
        };
        let moving = self.memory.moving && !self.memory.given_up;
        for (id, face) in &faces.all {
            let Some(mut corner) = faces.corners.get(id).copied() else { continue };
            if let Some((nodes, by)) = &with_frame
                && nodes.contains(id)
            {
                corner += *by;
            }
            if moving && state.selection.nodes.contains(id) {
                self.view.layout.entry(face.key).or_insert(corner);
            } else {
                self.view.layout.insert(face.key, corner);
            }
        }
        if self.view.layout.len() > faces.all.len() {
            let keys: HashSet<_> = faces.all.values().map(|face| face.key).collect();
            self.view.layout.retain(|key, _| keys.contains(key));
        }
    }

    /// The crate's selection changed.
    fn selected(
        &mut self,
        state: &State,
        faces: &Faces,
        keys: &HashSet<egui_graph::NodeId>,
        modifiers: egui::Modifiers,
        ui: &Ui,
        out: &mut Vec<Event>,
    ) {
        // The crate lets go of what it thinks it removed; the document decides that.
        if ui.input(|i| i.key_pressed(egui::Key::Delete) || i.key_pressed(egui::Key::Backspace)) {
            return;
        }
        let was = &state.selection.nodes;
        let mut now: Vec<NodeId> =
            faces.all.values().filter(|f| keys.contains(&f.key)).map(|f| f.id.clone()).collect();
        if modifiers.shift && !modifiers.command {
            now.extend(was.iter().filter(|id| !now.contains(id)).cloned().collect::<Vec<_>>());
        }
        // The newest is active; else the one that was.
        now.sort_by_key(|id| (!was.contains(id), state.selection.active.as_ref() == Some(id)));
        if now.iter().cloned().collect::<BTreeSet<_>>() != *was {
            out.push(Event::Select(Select::Nodes(now)));
        }
    }

    /// What is done to the empty canvas.
    fn background(
        &mut self,
        state: &State,
        faces: &Faces,
        response: &egui::Response,
        found: &DrawnScene,
        ui: &Ui,
        out: &mut Vec<Event>,
    ) {
        if response.clicked() && !ui.input(|i| i.modifiers.command) {
            self.memory.wires.clear();
            self.memory.select_frame(None);
            // A press and its release within one frame are none to the crate.
            let quick = ui.input(|i| i.pointer.primary_pressed() && !i.modifiers.shift);
            if quick && !state.selection.nodes.is_empty() {
                out.push(Event::Select(Select::Nodes(vec![])));
            }
        }
        if response.drag_started_by(egui::PointerButton::Primary) {
            let from = ui.input(|i| i.pointer.press_origin());
            self.memory.grabbed = from.map(|at| self.to_canvas(at));
        }
        // The crate's box takes nodes; with Shift it takes wires.
        let boxed = response.drag_stopped_by(egui::PointerButton::Primary);
        if boxed && ui.input(|i| i.modifiers.shift) {
            let ends = self.memory.grabbed.take().zip(self.memory.pointer);
            let rect = ends.map_or(Rect::NOTHING, |(from, to)| Rect::from_two_pos(from, to));
            let touched = found.runs.iter().filter(|run| run.touches(rect));
            self.memory.wires.extend(touched.map(|run| run.wire.clone()));
        }
        if response.double_clicked()
            && let Some(at) = ui.input(|i| i.pointer.latest_pos())
        {
            self.open_search(state, faces, Some(at));
        }
        // The active node takes it first, where it is in sight.
        let by_key = std::mem::take(&mut self.memory.menu_by_key);
        let middle = self.area.map(|area| area.center()).filter(|_| by_key);
        menu::background(state.table, response, middle, out);
    }

    /// Nodes are dragged, or were.
    fn dragged(
        &mut self,
        state: &State,
        faces: &Faces,
        found: &DrawnScene,
        moved: bool,
        ui: &Ui,
        out: &mut Vec<Event>,
    ) {
        let (down, branch) = ui.input(|i| (i.pointer.primary_down(), i.modifiers.shift));
        if moved && !self.memory.given_up {
            self.put_nodes(state, faces, branch, out);
        }
        if !down {
            self.memory.moving = false;
            self.memory.given_up = false;
            self.memory.drop_on = None;
            self.memory.shake = Shake::default();
            return;
        }
        let is_off = |id: &NodeId| {
            let (face, corner) = (faces.all.get(id), faces.corners.get(id));
            let now = face.and_then(|face| self.view.layout.get(&face.key));
            now.zip(corner).is_some_and(|(now, corner)| now.distance(*corner) > 0.6)
        };
        let held = matches!(self.memory.hand, Hand::Empty) && !self.memory.given_up;
        if held && state.selection.nodes.iter().any(is_off) {
            self.memory.moving = true;
        }
        if !self.memory.moving {
            return;
        }
        if escaped(ui) {
            self.memory.given_up = true;
            self.memory.moving = false;
            return;
        }
        self.memory.drop_on = self.wire_under(state, found, branch);
        let (at, now) = ui.input(|i| (i.pointer.latest_pos(), i.time));
        if let Some(at) = at
            && self.memory.shake.moved(at, now)
        {
            let off = wiring::disconnect(&state.document, &state.selection.nodes);
            if !commands::is_nothing(&off) {
                out.push(Event::Edit(off));
            }
        }
    }

    /// The wire that a dragged node would be inserted on: one node alone. One that stands in a chain must be dropped on it more exactly.
    fn wire_under(&self, state: &State, found: &DrawnScene, branch: bool) -> Option<Wire> {
        let mut nodes = state.selection.nodes.iter();
        let (Some(id), None) = (nodes.next(), nodes.next()) else { return None };
        let corner = *found.corners.get(id)?;
        let face = self.cache.last().all.get(id)?.size();
        let middle = Rect::from_min_size(corner, face).center();
        let reach = if commands::is_loose(&state.document, id) { 0.4 } else { 0.15 };
        let reach = face.y.min(face.x) * reach;
        let ends = |run: &&Run| run.wire.to.node == *id || run.from.node == *id;
        let near = found.runs.iter().filter(|run| run.bounds.expand(reach).contains(middle));
        let near = near.filter(|run| !ends(run)).map(|run| (run.distance(middle).0, run));
        let mut near: Vec<_> = near.filter(|(distance, _)| *distance <= reach).collect();
        near.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let fits = |run: &Run| put_on_wire(&state.document, id, &run.wire, branch).is_ok();
        near.into_iter().find(|(_, run)| fits(run)).map(|(_, run)| run.wire.clone())
    }

    /// The drag of nodes ended: one step.
    fn put_nodes(&mut self, state: &State, faces: &Faces, branch: bool, out: &mut Vec<Event>) {
        let to = state.selection.nodes.iter().filter_map(|id| {
            let at = *self.view.layout.get(&faces.all.get(id)?.key)?;
            Some((id.clone(), at))
        });
        let mut edits = vec![arrange::moves(to)];
        let first = state.selection.nodes.first();
        let mut said = None;
        if let (Some(wire), Some(id)) = (self.memory.drop_on.take(), first)
            && let Ok(edit) = put_on_wire(&state.document, id, &wire, branch)
        {
            let mut after = state.document.clone();
            said = edit
                .apply(&mut after)
                .ok()
                .and_then(|_| commands::said_of_insertion(&state.document, &after, id));
            edits.push(edit);
            // Behind what is displayed it takes the display along, as an added node does.
            let behind = wire.from(&state.document).map(|from| &from.node);
            if !branch && behind.is_some() && behind == state.document.display.as_ref() {
                edits.push(Edit::SetDisplay(Some(id.clone())));
            }
        }
        out.push(Event::Edit(Edit::Several(edits)));
        out.extend(said.map(|said| Event::Say(Note::done(said))));
    }

    /// Carries on with what the hand holds, and puts it down.
    fn carry(
        &mut self,
        state: &State,
        faces: &Arc<Faces>,
        found: &DrawnScene,
        ui: &Ui,
        area: Rect,
        out: &mut Vec<Event>,
    ) {
        self.memory.aim = None;
        let open = self.memory.open.take();
        if matches!(self.memory.hand, Hand::Empty) {
            return;
        }
        if escaped(ui) || ui.input(|i| i.pointer.secondary_pressed()) {
            self.memory.hand = Hand::Empty;
            return;
        }
        let down = ui.input(|i| i.pointer.primary_down());
        let at = self.memory.pointer;
        match self.memory.hand.clone() {
            Hand::Wire(loose) => {
                self.memory.open = open;
                self.carry_wire(state, faces, found, loose, ui, area, out);
            }
            Hand::Bend { wire, number, mut bends } => {
                if let (Some(at), Some(bend)) = (at, bends.get_mut(number)) {
                    *bend = at;
                }
                if down {
                    self.memory.hand = Hand::Bend { wire, number, bends };
                    return;
                }
                self.memory.hand = Hand::Empty;
                let bends: Vec<_> = bends.into_iter().map(arrange::point).collect();
                if state.document.bends_of(&wire.to, wire.at) != bends {
                    out.push(Event::Edit(Edit::SetBends { to: wire.to, at: wire.at, bends }));
                }
            }
            Hand::Frame { name, nodes, by } => {
                let by = at.zip(self.memory.grabbed).map_or(by, |(at, from)| (at - from).round());
                if down {
                    self.memory.hand = Hand::Frame { name, nodes, by };
                    return;
                }
                self.memory.hand = Hand::Empty;
                if by != Vec2::ZERO {
                    out.extend(commands::put_frame(state, faces, &name, nodes.as_ref(), by));
                }
            }
            Hand::Cut(_) | Hand::Empty => {}
        }
    }

    fn carry_wire(
        &mut self,
        state: &State,
        faces: &Arc<Faces>,
        found: &DrawnScene,
        loose: Loose,
        ui: &Ui,
        area: Rect,
        out: &mut Vec<Event>,
    ) {
        let scale = self.scale();
        let pressed = !loose.held && view::shield(ui, area, "wire");
        let at = self.memory.pointer;
        let was = self.memory.open.as_ref().map(|(id, _)| id);
        let all = (&**faces, &found.corners);
        self.memory.aim = at.and_then(|at| loose.aim(&state.document, all, was, at, scale));
        let under = at.and_then(|at| hand::node_at(all.0, all.1, was, at));
        let open = under.and_then(|id| loose.opens(&state.document, faces.all.get(id)?));
        self.memory.open = open;
        let put = loose.held && !ui.input(|i| i.pointer.primary_down());
        let aim = if put || pressed { self.memory.aim.take() } else { found.put.clone() };
        if !put && !pressed && aim.is_none() {
            ui.ctx().request_repaint();
            return;
        }
        self.memory.hand = Hand::Empty;
        self.memory.open = None;
        match aim {
            Some(Aim { node, end: None, refused: None }) => {
                let Fixed::Output(from) = loose.fixed.clone() else { return };
                let Some(face) = faces.all.get(&node) else { return };
                // One that is not shown is wired, of several one is picked.
                match &loose.taking(&state.document, face)[..] {
                    [one] => {
                        let plug = hand::plug_of(&state.document, face, one);
                        let lifted = loose.lifted.as_ref();
                        let edit = edits::connect(&state.document, &from, &plug, lifted);
                        out.extend(edit.map(Event::Edit));
                    }
                    _ => {
                        let screen = at.map_or(area.center(), |at| self.to_screen(at));
                        let task = Task::Input(from, loose.lifted, node);
                        self.memory.finder = Some(Finder::new(task, screen));
                    }
                }
            }
            Some(aim) => match loose.put_down(&state.document, faces, &aim) {
                Ok(Some(edit)) => out.push(Event::Edit(edit)),
                Ok(None) => {}
                Err(why) => out.push(Event::Say(Note::warning(why).of(aim.node))),
            },
            None => {
                let screen = ui.input(|i| i.pointer.latest_pos()).filter(|at| area.contains(*at));
                let (Some(at), Some(screen)) = (at, screen) else { return };
                let link = match (loose.fixed, loose.lifted) {
                    // Pulled off and let go: the wire is gone. Two clicks are no pull.
                    (_, Some(wire)) => {
                        if loose.held {
                            out.push(Event::Edit(edits::cut([wire])));
                        }
                        return;
                    }
                    (Fixed::Output(from), None) => Link::From(from),
                    (Fixed::Input(plug), None) => Link::To(plug.socket, plug.wire),
                    (Fixed::Bundle(..), None) => return,
                };
                let task = Task::Add { at, link: Some(link), dropped: true };
                self.memory.finder = Some(Finder::new(task, screen));
            }
        }
    }

    /// Copy, cut and paste, as keys or menus say them.
    fn clipboard(&mut self, state: &State, faces: &Faces, ui: &Ui, out: &mut Vec<Event>) {
        let asked = self.memory.clipboard.take();
        if asked == Some(Clipboard::Paste) {
            // What the clipboard holds comes as an event, some frames later.
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::RequestPaste);
            self.memory.pasting = true;
        }
        let typing = ui.ctx().egui_wants_keyboard_input();
        let ours = state.focus == Room::Canvas && !typing;
        let events = ui.input(|i| i.events.clone());
        let has = |wanted: &egui::Event| ours && events.contains(wanted);
        if asked == Some(Clipboard::Copy) || has(&egui::Event::Copy) {
            self.copy(state, faces, ui.ctx());
        }
        if asked == Some(Clipboard::Cut) || has(&egui::Event::Cut) {
            self.copy(state, faces, ui.ctx());
            out.extend(self.delete(state));
        }
        for event in &events {
            if let (egui::Event::Paste(text), true) = (event, ours || self.memory.pasting) {
                self.memory.pasting = false;
                out.extend(self.paste(state, faces, text));
            }
        }
    }
}

/// The edit that puts a node on a wire, or lets it take from where the wire comes from.
fn put_on_wire(
    document: &Document,
    id: &NodeId,
    wire: &Wire,
    branch: bool,
) -> Result<Edit, String> {
    // An output of the groom ends its chain: what it writes is not to change by a move on the canvas.
    let ends = document.node(id.as_str()).is_some_and(|node| node.kind == "groom_output");
    match branch {
        _ if ends && !commands::is_loose(document, id) => Err("it is an output".to_owned()),
        true => wiring::branch_from_wire(document, id, &wire.to, wire.at),
        false => wiring::insert_on_wire(document, id, &wire.to, wire.at),
    }
}

/// Whether Escape was pressed, also when a key table took it.
fn escaped(ui: &Ui) -> bool {
    let is_escape = |event: &egui::Event| {
        matches!(event, egui::Event::Key { key: egui::Key::Escape, pressed: true, .. })
    };
    ui.input(|i| i.raw.events.iter().any(is_escape))
}
