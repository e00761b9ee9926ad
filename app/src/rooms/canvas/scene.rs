//! What is drawn inside the zoomed scene, and what the pointer does there: frames, wires, bends,
//! nodes, and what the hand holds.

use super::Memory;
use super::edits;
use super::frames;
use super::hand::{Fixed, Hand, Loose, pick_up};
use super::look;
use super::node::{self, Detail, End, Mood};
use super::wires::{self, Run, Wire};
use crate::core::event::Event;
use crate::core::faces::{Face, Faces};
use crate::core::state::{Select, State};
use crate::widgets::panel;
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Node, NodeId};
use coif_nodes::define::Type;
use egui::{
    Color32, LayerId, Mesh, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, pos2, vec2,
};
use std::collections::BTreeMap;

/// One frame of the scene.
pub(super) struct Scene<'a> {
    pub state: &'a State,
    pub faces: &'a Faces,
    pub memory: &'a mut Memory,
    pub out: &'a mut Vec<Event>,
    /// Points of the screen for a unit of the canvas.
    pub scale: f32,
    /// The pointer on the canvas, while it is over the room.
    pub pointer: Option<Pos2>,
}

/// What the scene found.
#[derive(Default)]
pub(super) struct DrawnScene {
    /// Where the nodes stand, as they were drawn.
    pub corners: BTreeMap<NodeId, Pos2>,
    /// How the wires run.
    pub runs: Vec<Run>,
    /// A socket that was clicked without a pointer: by a screen reader, or a test.
    pub put: Option<super::hand::Aim>,
}

impl Scene<'_> {
    /// Draws everything and takes what the pointer does.
    pub(super) fn show(mut self, ui: &mut Ui, show: egui_graph::Show<'_>) -> DrawnScene {
        // The crate's sizes of sockets and frames follow this.
        let mut found = DrawnScene::default();
        dots(ui, self.scale);
        self.comment_frames(ui);
        let seen = ui.clip_rect();
        let faces = self.faces;
        let in_sight =
            faces.all.keys().filter_map(|id| faces.rect(id)).filter(|r| seen.intersects(*r));
        let detail = Detail::at(self.scale, in_sight.count());
        let scene = &mut self;
        show.nodes(ui, |nodes, ui| {
            // What is open lies over its neighbours.
            let open = scene.memory.open.as_ref().map(|(id, _)| id.clone());
            let others = scene.faces.all.keys().filter(|id| Some(*id) != open.as_ref());
            for id in others.chain(&open) {
                if let Some(face) = scene.faces.all.get(id) {
                    scene.node(nodes, ui, face, detail, &mut found);
                }
            }
        });
        let bent = match &self.memory.hand {
            Hand::Bend { wire, bends, .. } => Some((wire.clone(), bends.clone())),
            _ => None,
        };
        let bent = bent.as_ref().map(|(wire, bends)| (wire, &bends[..]));
        let corner = |id: &NodeId| found.corners.get(id).copied();
        found.runs = wires::runs(&self.state.document, self.faces, corner, bent);
        self.wires(ui, &found);
        self.marks(ui, &found);
        self.bends(ui, &found);
        self.held(ui, &found);
        found
    }

    fn comment_frames(&mut self, ui: &Ui) {
        let held = match &self.memory.hand {
            Hand::Frame { name, nodes, by } => Some((name.clone(), nodes.is_none(), *by)),
            _ => None,
        };
        let now = |name: &str, frame: &coif_graphs::document::Frame| match &held {
            Some((held, resized, by)) if held == name => frames::held(frame, *by, *resized),
            _ => edits::frame_rect(frame),
        };
        let selected = self.memory.frame.clone();
        let document = &self.state.document;
        for touched in frames::show(
            ui,
            document,
            self.state.group.as_ref(),
            self.scale,
            selected.as_deref(),
            now,
        ) {
            let Some(frame) = document.frames.get(&touched.name) else { continue };
            let name = touched.name.clone();
            if touched.title.drag_started_by(egui::PointerButton::Primary) {
                let nodes = Some(edits::framed(frame, self.faces));
                self.memory.hand = Hand::Frame { name: name.clone(), nodes, by: Vec2::ZERO };
                self.memory.grabbed = self.pointer;
            }
            if touched.corner.drag_started_by(egui::PointerButton::Primary) {
                self.memory.hand = Hand::Frame { name: name.clone(), nodes: None, by: Vec2::ZERO };
                self.memory.grabbed = self.pointer;
            }
            if touched.title.clicked() || touched.title.drag_started() {
                self.memory.select_frame(Some(name.clone()));
                self.out.push(Event::Select(Select::Nodes(vec![])));
            }
            if touched.title.double_clicked() {
                self.memory.name_frame(name.clone(), &frame.text);
            }
            touched.title.context_menu(|ui| {
                panel::list(ui, |ui| {
                    for (number, (label, colour)) in look::FRAMES.iter().enumerate() {
                        let text = egui::RichText::new(format!("\u{25A0} {label}"));
                        if ui
                            .button(text.color(colour.lerp_to_gamma(theme::STRONG.of(ui), 0.35)))
                            .clicked()
                        {
                            let frame = coif_graphs::document::Frame {
                                colour: number as u8,
                                ..frame.clone()
                            };
                            let edit = Edit::SetFrame { name: name.clone(), frame: Some(frame) };
                            self.out.push(Event::Edit(edit));
                            ui.close();
                        }
                    }
                    ui.separator();
                    if ui.button("Rename frame").clicked() {
                        self.memory.name_frame(name.clone(), &frame.text);
                        ui.close();
                    }
                    if ui.button("Remove frame").clicked() {
                        let edit = Edit::SetFrame { name: name.clone(), frame: None };
                        self.out.push(Event::Edit(edit));
                        ui.close();
                    }
                })
            });
        }
    }

    fn mood(&self, face: &Face) -> Mood {
        let selection = &self.state.selection;
        let run = &self.state.run;
        let runs = run.since.is_some() && run.node == face.id.as_str();
        let share = run.pieces.0 as f32 / run.pieces.1.max(1) as f32;
        let aim = self.memory.aim.as_ref().filter(|aim| aim.node == face.id);
        Mood {
            selected: selection.nodes.contains(&face.id),
            active: selection.active.as_ref() == Some(&face.id),
            near: aim.is_some_and(|aim| aim.refused.is_none()),
            running: runs.then_some(share),
            aimed: aim.filter(|aim| aim.refused.is_none()).and_then(|aim| aim.end),
            wiring: matches!(self.memory.hand, Hand::Wire(_)),
            pen: self.state.settings.pen_mode,
            scale: self.scale,
            named: true,
        }
    }

    fn node(
        &mut self,
        nodes: &mut egui_graph::NodesCtx<'_>,
        ui: &mut Ui,
        face: &Face,
        detail: Detail,
        found: &mut DrawnScene,
    ) {
        // From far away no socket can be hit: the crate need not know them.
        let near = detail.has_sockets();
        let (inputs, outputs) = if near { (face.inputs.len(), face.outputs.len()) } else { (0, 0) };
        let mood = Mood { named: detail == Detail::Full, ..self.mood(face) };
        let shown = egui_graph::node::Node::from_id(face.key)
            .inputs(inputs)
            .outputs(outputs)
            .max_width(crate::core::faces::WIDTH)
            .animation_time(0.0)
            .socket_radius(0.0)
            .socket_color(Color32::TRANSPARENT)
            .show_or_cull(nodes, ui, |cx| {
                let state = cx.interaction();
                let near = mood.near || state.in_selection_rect || state.hovered;
                let mood = Mood { near, ..mood };
                cx.framed_with(egui::Frame::NONE, |ui, layout| {
                    let corner = ui.cursor().min;
                    if near {
                        for number in 0..inputs {
                            layout.input_at(number, face.input_at(corner, number).y);
                        }
                        for number in 0..outputs {
                            layout.output_at(number, face.output_at(corner, number).y);
                        }
                    }
                    node::show(ui, face, detail, mood)
                })
            });
        let response: egui::Response = (*shown).clone();
        found.corners.insert(face.id.clone(), response.rect.min);
        let mark = self.memory.marks.as_ref().and_then(|marks| marks.nodes.get(&face.id).copied());
        node::describe(ui.ctx(), &response, face, mood.selected, mark);
        if let Some(touched) = shown.into_inner().inner {
            self.flags(face, &touched);
            for (end, socket) in touched.ends {
                self.socket(face, end, &socket, found);
            }
        }
        self.pressed(face, &response, ui);
    }

    fn flags(&mut self, face: &Face, touched: &node::NodeResponse) {
        if touched.display {
            let shown = (!face.displayed).then(|| face.id.clone());
            self.out.push(Event::Display(shown));
        }
        if touched.bypass {
            let edit = Edit::SetBypass { id: face.id.clone(), bypass: !face.bypass };
            self.out.push(Event::Edit(edit));
        }
    }

    fn socket(&mut self, face: &Face, end: End, response: &egui::Response, found: &mut DrawnScene) {
        let document = &self.state.document;
        let all = response.ctx.input(|i| i.modifiers.shift);
        if response.drag_started_by(egui::PointerButton::Primary) {
            if let Some(loose) = pick_up(document, face, end, all, true) {
                self.memory.hand = Hand::Wire(loose);
            }
        } else if response.clicked() {
            match &self.memory.hand {
                Hand::Wire(loose) => {
                    // Clicked by its name: what the wire aims at is this end.
                    let (faces, corners) = (self.faces, &self.faces.corners);
                    let Some(corner) = corners.get(&face.id) else { return };
                    let at = match end {
                        End::In(n) => face.input_at(*corner, n),
                        End::Out(n) => face.output_at(*corner, n),
                    };
                    let open = self.memory.open.as_ref().map(|(id, _)| id);
                    let scale = self.scale.max(1.0);
                    found.put = loose.aim(document, (faces, corners), open, at, scale);
                }
                _ => {
                    if let Some(loose) = pick_up(document, face, end, all, false) {
                        self.memory.hand = Hand::Wire(loose);
                    }
                }
            }
        }
        let wire = super::hand::plug(face, end)
            .and_then(|plug| Some(Wire { to: plug.socket.clone(), at: plug.wire? }));
        if let Some(wire) = wire {
            response.context_menu(|ui| {
                if ui.button("Disconnect").clicked() {
                    self.out.push(Event::Edit(edits::cut([wire])));
                    ui.close();
                }
            });
        }
    }

    /// A press on the node itself: what the crate does not do with selections.
    fn pressed(&mut self, face: &Face, response: &egui::Response, ui: &Ui) {
        let selection = &self.state.selection;
        let ctrl = ui.input(|i| i.modifiers.command);
        let shift = ui.input(|i| i.modifiers.shift);
        let only = || Event::Select(Select::Nodes(vec![face.id.clone()]));
        if response.clicked()
            && !ctrl
            && !shift
            && selection.nodes.len() > 1
            && selection.nodes.contains(&face.id)
        {
            self.out.push(only());
        }
        let pressed = ui.input(|i| i.pointer.primary_pressed());
        if response.clicked() && pressed && !response.is_pointer_button_down_on() {
            // Press and release came within one frame, of a touchpad or while frames are slow: the crate saw no press.
            self.memory.select_frame(None);
            self.memory.wires.clear();
            self.out.push(match () {
                () if ctrl => Event::Select(Select::Toggle(face.id.clone())),
                () if shift => {
                    let others = selection.nodes.iter().filter(|id| **id != face.id).cloned();
                    Event::Select(Select::Nodes(others.chain([face.id.clone()]).collect()))
                }
                () => only(),
            });
        } else if response.is_pointer_button_down_on() && pressed {
            self.memory.select_frame(None);
            self.memory.wires.clear();
            if !ctrl
                && !shift
                && selection.nodes.contains(&face.id)
                && selection.active.as_ref() != Some(&face.id)
            {
                let others = selection.nodes.iter().filter(|id| **id != face.id).cloned();
                let nodes = others.chain([face.id.clone()]).collect();
                self.out.push(Event::Select(Select::Nodes(nodes)));
            }
        }
        if response.double_clicked() {
            match self.state.document.node(face.id.as_str()).is_some_and(Node::is_group) {
                true => self.out.push(Event::Enter(Some(face.id.clone()))),
                false => self.memory.name_node(face.id.clone(), &face.label),
            }
        }
        if response.secondary_clicked() && !selection.nodes.contains(&face.id) {
            self.out.push(only());
        }
        let active = self.state.active() == Some(&face.id);
        let by_key = active && std::mem::take(&mut self.memory.menu_by_key);
        let place = ui.ctx().layer_transform_to_global(response.layer_id);
        let middle = place.unwrap_or_default() * response.rect.center();
        super::menu::node(self.state.table, response, by_key.then_some(middle), self.out);
        if self.memory.is_quiet() {
            response.clone().on_hover_ui_at_pointer(|ui| node::node_tip(ui, face));
        }
    }

    fn wires(&mut self, ui: &Ui, found: &DrawnScene) {
        let seen = ui.clip_rect();
        let knife = self.knife(ui, found);
        let idle = self.memory.is_quiet() && !knife && ui.response().contains_pointer();
        let reach = 7.0 / self.scale;
        let near = self.pointer.filter(|_| idle);
        let near = near.and_then(|at| Some((at, wires::nearest(&found.runs, at, reach)?)));
        let mut hovered = None;
        if let Some((at, (run, bend))) = near {
            let spot = Rect::from_center_size(at, Vec2::splat(3.0 * reach));
            let response = ui.interact(spot, ui.id().with("wire"), Sense::click());
            if response.hovered() {
                hovered = Some(run.wire.clone());
            }
            self.wire_clicked(&response, run, bend, at);
            let document = &self.state.document;
            let ends = [&run.from, &run.wire.to].map(|end| super::finder::plain(document, end));
            response.on_hover_text(ends.join(" ⏵ "));
        }
        let hidden = match &self.memory.hand {
            Hand::Wire(Loose { lifted: Some(wire), .. }) => vec![wire.clone()],
            Hand::Wire(Loose { fixed: Fixed::Bundle(_, wires), .. }) => wires.clone(),
            _ => vec![],
        };
        let p = ui.painter();
        for run in found.runs.iter().filter(|run| run.bounds.expand(4.0).intersects(seen)) {
            let marked = self.memory.drop_on.as_ref() == Some(&run.wire);
            let selected = self.memory.wires.contains(&run.wire);
            let hovered = hovered.as_ref() == Some(&run.wire);
            let strength = if hidden.contains(&run.wire) { 0.25 } else { 1.0 };
            draw(p, run, self.scale, Tone { marked, selected, hovered, strength });
        }
        self.memory.hovered = hovered;
    }

    /// Marks what differs from another document: wires behind the nodes, nodes over them.
    fn marks(&self, ui: &Ui, found: &DrawnScene) {
        let Some(marks) = &self.memory.marks else { return };
        for run in &found.runs {
            if let Some(mark) = marks.wires.get(&run.wire) {
                mark.on_wire(ui.painter(), run, self.scale);
            }
        }
        let p = &over(ui, "marks");
        for (id, mark) in &marks.nodes {
            if let (Some(face), Some(corner)) = (self.faces.all.get(id), found.corners.get(id)) {
                mark.on_node(p, Rect::from_min_size(*corner, face.size()), self.scale);
            }
        }
    }

    fn wire_clicked(&mut self, response: &egui::Response, run: &Run, bend: usize, at: Pos2) {
        let document = &self.state.document;
        if response.double_clicked() {
            let mut bends = document.bends_of(&run.wire.to, run.wire.at).to_vec();
            bends.insert(bend.min(bends.len()), crate::core::faces::arrange::point(at));
            let Wire { to, at } = run.wire.clone();
            self.out.push(Event::Edit(Edit::SetBends { to, at, bends }));
        } else if response.clicked() {
            if !response.ctx.input(|i| i.modifiers.command) {
                self.memory.wires.clear();
            }
            if !self.memory.wires.remove(&run.wire) {
                self.memory.wires.insert(run.wire.clone());
            }
            self.memory.select_frame(None);
            self.out.push(Event::Select(Select::Nodes(vec![])));
        }
        let wire = run.wire.clone();
        response.context_menu(|ui| {
            if ui.button("Insert node\u{2026}").clicked() {
                self.memory.insert_at = Some((wire.clone(), at));
                ui.close();
            }
            if ui.button("Disconnect").clicked() {
                self.out.push(Event::Edit(edits::cut([wire.clone()])));
                ui.close();
            }
        });
    }

    /// The knife: drawn with Ctrl held. Gives whether it is in the hand or could be.
    fn knife(&mut self, ui: &Ui, found: &DrawnScene) -> bool {
        let cutting = matches!(self.memory.hand, Hand::Cut(_));
        let could = ui.input(|i| i.modifiers.command) && matches!(self.memory.hand, Hand::Empty);
        if !cutting && !could {
            return false;
        }
        let response = ui.interact(ui.clip_rect(), ui.id().with("knife"), Sense::drag());
        if response.drag_started_by(egui::PointerButton::Primary) && !self.memory.moving {
            let from = ui.input(|i| i.pointer.press_origin());
            let layer = ui.ctx().layer_transform_from_global(ui.layer_id()).unwrap_or_default();
            self.memory.hand = Hand::Cut(from.map(|at| layer * at).into_iter().collect());
        }
        if let (Hand::Cut(line), Some(at)) = (&mut self.memory.hand, self.pointer)
            && line.last().is_none_or(|last| last.distance(at) > 2.0)
        {
            line.push(at);
        }
        if cutting && !ui.input(|i| i.pointer.primary_down()) {
            let Hand::Cut(line) = std::mem::take(&mut self.memory.hand) else { return true };
            let cut = found.runs.iter().filter(|run| run.crosses(&line));
            let cut: Vec<Wire> = cut.map(|run| run.wire.clone()).collect();
            if !cut.is_empty() {
                self.out.push(Event::Edit(edits::cut(cut)));
            }
        }
        cutting
    }

    fn bends(&mut self, ui: &Ui, found: &DrawnScene) {
        if self.scale < 0.3 {
            return;
        }
        let seen = ui.clip_rect().expand(8.0);
        for run in &found.runs {
            for (number, at) in run.bends.iter().enumerate().filter(|(_, at)| seen.contains(**at)) {
                let id = ui.id().with(("bend", &run.wire, number));
                let spot = Rect::from_center_size(*at, Vec2::splat(20.0));
                let response = ui.interact(spot, id, Sense::click_and_drag());
                let this = Some((run.wire.clone(), number));
                let bright = response.hovered() || self.memory.bend == this;
                response.widget_info(|| {
                    let label = format!("{} {}: bend {}", run.wire.to, run.wire.at + 1, number + 1);
                    egui::WidgetInfo::labeled(egui::WidgetType::Button, true, label)
                });
                let colour = if self.memory.bend == this {
                    theme::ACCENT.of(ui)
                } else {
                    theme::of_type(run.ty).of(ui)
                };
                ui.painter().circle(
                    *at,
                    if bright { 6.0 } else { 4.5 },
                    theme::SUNKEN.of(ui),
                    Stroke::new(2.0, colour),
                );
                if response.clicked() || response.drag_started() {
                    self.memory.wires.clear();
                    self.memory.select_frame(None);
                    self.memory.bend.clone_from(&this);
                    self.out.push(Event::Select(Select::Nodes(vec![])));
                }
                if response.drag_started_by(egui::PointerButton::Primary) {
                    let bends = run.bends.clone();
                    self.memory.hand = Hand::Bend { wire: run.wire.clone(), number, bends };
                }
            }
        }
    }

    /// Draws what the hand holds, over everything.
    fn held(&mut self, ui: &Ui, found: &DrawnScene) {
        if matches!(self.memory.hand, Hand::Empty) {
            return;
        }
        let p = over(ui, "hand");
        match &self.memory.hand {
            Hand::Cut(line) => {
                let stroke = Stroke::new(1.6 / self.scale, theme::ERROR.of(ui));
                p.extend(Shape::dashed_line(line, stroke, 6.0 / self.scale, 4.0 / self.scale));
            }
            Hand::Wire(loose) => {
                if let Some(at) = self.pointer {
                    self.loose(&p, loose, found, at);
                }
            }
            _ => {}
        }
    }

    fn loose(&self, p: &Painter, loose: &Loose, found: &DrawnScene, pointer: Pos2) {
        let place = |node: &NodeId, end: End| {
            let (face, corner) = (self.faces.all.get(node)?, *found.corners.get(node)?);
            Some(match end {
                End::In(n) => face.input_at(corner, n),
                End::Out(n) => face.output_at(corner, n),
            })
        };
        let aim = self.memory.aim.as_ref();
        let free = aim.filter(|a| a.refused.is_none());
        let free = free.and_then(|aim| place(&aim.node, aim.end?)).unwrap_or(pointer);
        let refused = aim.is_some_and(|aim| aim.refused.is_some());
        let mut ends: Vec<(Pos2, Pos2, Option<Type>)> = vec![];
        match &loose.fixed {
            Fixed::Output(from) => {
                let face = self.faces.all.get(&from.node);
                if let Some((face, n)) = face.and_then(|f| Some((f, f.output(&from.name)?))) {
                    let start = place(&from.node, End::Out(n)).unwrap_or(pointer);
                    ends.push((start, free, face.outputs[n].ty));
                }
            }
            Fixed::Input(plug) => {
                let face = self.faces.all.get(&plug.socket.node);
                let n = face.and_then(|f| f.inputs.iter().position(|p| p == plug)).unwrap_or(0);
                if let Some(end) = place(&plug.socket.node, End::In(n)) {
                    ends.push((free, end, plug.ty));
                }
            }
            Fixed::Bundle(_, wires) => {
                for wire in wires {
                    let run = found.runs.iter().find(|run| run.wire == *wire);
                    if let Some((run, end)) =
                        run.and_then(|run| Some((run, *run.points(9.0).last()?)))
                    {
                        ends.push((free, end, run.ty));
                    }
                }
            }
        }
        for (from, to, ty) in ends {
            let colour = if refused { theme::ERROR.of(p) } else { theme::of_type(ty).of(p) };
            let apart = ((to - from).abs().max_elem() / 200.0).max(6.0);
            let points: Vec<Pos2> = wires::path(from, &[], to).flatten(apart).collect();
            let stroke = Stroke::new(2.4, colour);
            if refused {
                p.extend(Shape::dashed_line(&points, stroke, 6.0, 5.0));
            } else {
                p.add(Shape::line(points, stroke));
            }
        }
    }
}

/// Paints over all nodes, in the scene.
fn over(ui: &Ui, name: &str) -> Painter {
    let layer = LayerId::new(ui.layer_id().order, ui.id().with(name));
    let ctx = ui.ctx();
    ctx.set_sublayer(ui.layer_id(), layer);
    ctx.move_to_top(layer);
    if let Some(transform) = ctx.layer_transform_to_global(ui.layer_id()) {
        ctx.set_transform_layer(layer, transform);
    }
    ui.painter().clone().with_layer_id(layer)
}

/// How a wire looks just now.
#[derive(Clone, Copy)]
struct Tone {
    marked: bool,
    selected: bool,
    hovered: bool,
    strength: f32,
}

fn draw(p: &Painter, run: &Run, scale: f32, tone: Tone) {
    let points = run.points(6.0 / scale.clamp(0.15, 1.0));
    let base = theme::of_type(run.ty).of(p).gamma_multiply(0.82);
    let (colour, wide) = match tone {
        Tone { marked: true, .. } => (theme::ACCENT.of(p), 2.0),
        Tone { selected: true, .. } => (theme::ACCENT.of(p), 0.8),
        Tone { hovered: true, .. } => (base.lerp_to_gamma(theme::STRONG.of(p), 0.5), 0.6),
        _ => (base, 0.0),
    };
    // Hair is thick, heads are thin, numbers are dashed.
    let width = match run.ty {
        Some(Type::Curves) => 2.2,
        Some(Type::Scalp) => 1.4,
        _ => 1.6,
    };
    let stroke =
        Stroke::new((width + wide) / scale.clamp(0.35, 1.0), colour.gamma_multiply(tone.strength));
    if matches!(run.ty, Some(Type::Curves | Type::Scalp)) && run.ty.is_some() {
        p.add(Shape::line(points, stroke));
    } else {
        p.extend(Shape::dashed_line(&points, stroke, 5.0, 3.5));
    }
}

/// Dots behind everything, so that moving is seen; fewer from far away.
fn dots(ui: &Ui, scale: f32) {
    let mut step = 32.0;
    while step * scale < 22.0 {
        step *= 2.0;
    }
    let seen = ui.clip_rect();
    let size = Vec2::splat(1.4 / scale);
    let count = |length: f32| (length / step) as u32 + 2;
    let (columns, rows) = (count(seen.width().min(9e6)), count(seen.height().min(9e6)));
    if columns.saturating_mul(rows) > 20_000 {
        return;
    }
    let first = pos2((seen.left() / step).floor() * step, (seen.top() / step).floor() * step);
    let mut mesh = Mesh::default();
    let ink = look::DOTS.of(ui);
    for row in 0..rows {
        for column in 0..columns {
            let at = first + step * vec2(column as f32, row as f32);
            mesh.add_colored_rect(Rect::from_center_size(at, size), ink);
        }
    }
    ui.painter().add(Shape::mesh(mesh));
}
