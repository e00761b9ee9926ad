//! Handles of the active node: what of its inputs can be dragged in the picture. Parameters have those of the inputs that read them.
//!
//! Declarations say which inputs have one. Grips have the same size at any distance. A drag is one undo step; Escape takes it
//! back. Inputs that are wired to what is made, unset or vary over the hair have none.
//!
//! Where they stand: points where they are; balls about the middle that the node's curves carry; everything else about the
//! node's own point, else about the first curve that it gives. What the head hides is not drawn ([`Seen`]) and cannot be taken.
//! Lengths are as large as they are made: in head units where the node measures in those. Guaranteed: what a drag gives lies
//! within the input's hard limits, and a grip that is let go where it was taken leaves the value as it was.

mod grip;
mod marks;

use crate::core::event::Event;
use crate::core::projection::Projection;
use crate::core::shown::first_output;
use crate::core::state::State;
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting, Socket, wiring};
use coif_graphs::values;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::declared;
use coif_nodes::define::{Handle, Value};
use egui::{Color32, Key, Pos2, Sense, Shape, Stroke, Vec2};
use glam::Vec3;
use grip::{Grip, Number, grips};
use marks::LandmarkHandles;
use std::collections::BTreeSet;

/// How far from a grip's middle it is taken, points.
const TARGET: f32 = 12.0;
/// The radius of a grip, points.
const GRIP: f32 = 5.0;
/// Grips of a node lie at least so far apart: one that would lie nearer to another is held aside of its place, by a line.
const APART: f32 = 26.0;
/// While the pointer is within this of a grip they all say what they are, points.
const NEAR: f32 = 60.0;
/// Places of the skin itself lie up to so far under it, cm.
const UNDER: f32 = 0.5;
/// Skin farther from the eye than this is not reached, cm.
pub(super) const FAR: f32 = 1e5;

/// What the head lets be seen.
struct Seen<'a> {
    view: &'a Projection,
    /// The heads that are shown.
    scalps: &'a [&'a Scalp],
}

impl Seen<'_> {
    /// Whether a head stands before a place.
    fn hides(&self, p: Vec3) -> bool {
        let Some(at) = self.view.screen(p) else { return true };
        let ray = self.view.ray(at);
        let far = (p - ray.origin).dot(ray.direction) - UNDER;
        let hit = |scalp: &&&Scalp| scalp.surface().ray(ray.origin, ray.direction, far).is_some();
        far > 0.0 && self.scalps.iter().any(|scalp| hit(&scalp))
    }

    /// Draws what is seen of a line.
    fn line(&self, points: impl Iterator<Item = Vec3>, stroke: Stroke, painter: &egui::Painter) {
        let mut run = vec![];
        for p in points {
            match self.view.screen(p).filter(|_| !self.hides(p)) {
                Some(at) => run.push(at),
                None => {
                    painter.add(Shape::line(std::mem::take(&mut run), stroke));
                }
            }
        }
        painter.add(Shape::line(run, stroke));
    }
}

/// What is being dragged.
struct Drag {
    node: NodeId,
    grip: Grip,
    /// From the grip to where it was taken, points.
    off: Vec2,
    last: Number,
}

/// The grips of the active node.
#[derive(Default)]
pub(super) struct Handles {
    drag: Option<Drag>,
    marks: LandmarkHandles,
}

impl Handles {
    /// Whether one is being dragged.
    pub(super) fn is_dragging(&self) -> bool {
        self.drag.is_some() || self.marks.is_dragging()
    }

    /// Draws the grips and takes drags of them.
    pub(super) fn ui(
        &mut self,
        state: &State,
        view: &Projection,
        head: bool,
        ui: &mut egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let (Some(shown), Some(node)) = (state.shown.as_ref(), state.active()) else {
            if self.marks.is_dragging() {
                out.push(Event::End);
            }
            *self = Self::default();
            return;
        };
        let nodes = gripped(&state.document, node);
        if self.drag.as_ref().is_some_and(|drag| !nodes.contains(&drag.node)) {
            self.drag = None;
        }
        let scalps: Vec<&Scalp> = shown.scalps.iter().map(|scalp| &**scalp).collect();
        let seen = Seen { view, scalps: if head { &scalps } else { &[] } };
        let dragged = self.drag.as_ref().map(|drag| (drag.node.clone(), drag.grip.input.name));
        let is_held = |node: &NodeId, grip: &Grip| {
            dragged.as_ref().is_some_and(|(held, name)| held == node && *name == grip.input.name)
        };
        let is_own = |of: &NodeId, grip: &Grip| {
            of == node || set_at(&state.document, of, grip.input.name).node == *node
        };
        let (mut of, mut placed): (Vec<&NodeId>, Vec<(Grip, Pos2)>) = (vec![], vec![]);
        for node in &nodes {
            let grips = grips(&state.document, shown, node, view);
            for grip in grips.into_iter().filter(|grip| is_own(node, grip)) {
                let Some((at, hidden)) = grip.place(&seen, &scalps) else { continue };
                if !hidden || is_held(node, &grip) {
                    of.push(node);
                    placed.push((grip, at));
                }
            }
        }
        let hands = apart(&placed);
        let pointer = ui.input(|input| input.pointer.latest_pos());
        let near = pointer.is_some_and(|p| hands.iter().any(|at| at.distance(p) < NEAR));
        for ((node, (grip, place)), at) in of.into_iter().zip(placed).zip(hands) {
            let held = is_held(node, &grip);
            grip.draw(&seen, ui);
            if at.distance(place) > GRIP {
                let stroke = Stroke::new(1.0, theme::ACCENT.dark.gamma_multiply(0.5));
                ui.painter_at(view.rect).line_segment([place, at], stroke);
            }
            let id = ui.id().with(("handle", node.as_str(), grip.input.name));
            let target = egui::Rect::from_center_size(at, Vec2::splat(2.0 * TARGET));
            let response = ui.interact(target, id, Sense::drag());
            response.widget_info(|| {
                let label = format!("Handle of {}", grip.input.name);
                egui::WidgetInfo::labeled(egui::WidgetType::Slider, true, label)
            });
            let colour =
                if held || response.hovered() { Color32::WHITE } else { theme::ACCENT.dark };
            ui.painter().circle(at, GRIP, theme::GROUND.dark, Stroke::new(2.0, colour));
            let told = held || response.hovered();
            if told || near {
                let name = crate::widgets::text::spoken(grip.input.name);
                let text = if told { format!("{name} {}", grip.words()) } else { name };
                label(ui, at, text);
            }
            if response.drag_started() {
                let pressed = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
                out.push(Event::Begin(String::new()));
                let last = grip.value;
                self.drag = Some(Drag { node: node.clone(), grip, off: pressed - place, last });
            }
        }
        self.follow(&state.document, view, &scalps, ui, out);
        self.marks.ui(state, &seen, ui, out);
    }

    /// Gives the dragged input what the pointer says.
    fn follow(
        &mut self,
        document: &Document,
        view: &Projection,
        scalps: &[&Scalp],
        ui: &egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let Some(drag) = &mut self.drag else { return };
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            out.push(Event::Abort);
            self.drag = None;
            return;
        }
        let (pointer, down) =
            ui.input(|input| (input.pointer.interact_pos(), input.pointer.any_down()));
        if let Some(at) = pointer
            && let Some(value) = drag.grip.value_at(view, scalps, at - drag.off)
            && value != drag.last
        {
            drag.last = value;
            let value = match value {
                Number::One(x) => Value::Float(x),
                Number::Point(p) => Value::Vec3(p),
            };
            let at = set_at(document, &drag.node, drag.grip.input.name);
            let ty = wiring::input_def(document, &at).map_or(drag.grip.input.ty, |input| input.ty);
            if let Ok(value) = values::fit(ty, value) {
                let (node, input, setting) = (at.node, at.name.to_string(), Setting::Known(value));
                out.push(Event::Edit(Edit::SetInput { node, input, setting }));
            }
        }
        if !down {
            out.push(Event::End);
            self.drag = None;
        }
    }
}

/// Where an input is set: there, or where the parameter is that it reads.
fn set_at(document: &Document, node: &NodeId, input: &str) -> Socket {
    wiring::set_at(document, &Socket::new(node.clone(), input))
}

/// The nodes whose grips are shown while this one is active: itself, and of parameters those with a handle that is set there.
fn gripped(document: &Document, active: &NodeId) -> BTreeSet<NodeId> {
    let is_parameters =
        document.node(active.as_str()).is_some_and(|node| node.kind == declared::PARAMETERS);
    let has_handle =
        |to: &Socket| wiring::input_def(document, to).is_some_and(|input| input.handle.is_some());
    let reads = |wires: &[Socket]| wires.iter().any(|wire| wire.node == *active);
    let readers = document.links.iter().filter(|(_, wires)| is_parameters && reads(wires));
    let readers = readers.filter(|(to, _)| has_handle(to)).map(|(to, _)| &to.node);
    readers.chain([active]).cloned().collect()
}

/// Outputs that grips stand about, of nodes that are not active themselves.
pub(super) fn wants(state: &State) -> Vec<Socket> {
    let document = &state.document;
    let nodes = state.active().map_or_else(BTreeSet::new, |active| gripped(document, active));
    nodes.iter().filter_map(|id| first_output(document, id)).collect()
}

/// What a handle is called, beside it.
fn label(ui: &egui::Ui, at: Pos2, text: String) {
    let galley =
        ui.painter().layout_no_wrap(text, egui::FontId::proportional(12.0), theme::TEXT.dark);
    let from = at + Vec2::new(12.0, -18.0);
    let back = egui::Rect::from_min_size(from, galley.size()).expand(2.0);
    ui.painter().rect_filled(back, 2.0, Color32::from_black_alpha(190));
    ui.painter().galley(from, galley, theme::TEXT.dark);
}

/// Where grips are taken: at their places, but for those that would lie on another. The place of the whole stays first, for it is
/// what is dragged most.
fn apart(placed: &[(Grip, Pos2)]) -> Vec<Pos2> {
    let mut hands: Vec<Pos2> = placed.iter().map(|(_, at)| *at).collect();
    let mut order: Vec<usize> = (0..placed.len()).collect();
    order.sort_by_key(|i| placed[*i].0.handle != Handle::Point);
    for (n, i) in order.iter().copied().enumerate() {
        let free =
            |at: Pos2| order[..n].iter().all(|other| hands[*other].distance(at) >= APART - 0.01);
        let place = placed[i].1;
        // Away from the nearest of the others, else upwards; then round the place, farther and farther.
        let nearest = order[..n].iter().map(|other| place - hands[*other]);
        let nearest = nearest.min_by(|a, b| a.length().total_cmp(&b.length()));
        let first = nearest.filter(|by| by.length() > 1.0).map_or(-Vec2::Y, Vec2::normalized);
        let around = (1..4).flat_map(|ring| (0..8u8).map(move |turn| (ring as f32, turn)));
        let aside = around.map(|(ring, turn)| {
            // To both sides in turn.
            let side = if turn % 2 == 0 { 1.0 } else { -1.0 };
            let angle = side * f32::from(turn.div_ceil(2)) * std::f32::consts::FRAC_PI_4;
            place + egui::emath::Rot2::from_angle(angle) * first * (APART * ring)
        });
        if let Some(at) = std::iter::once(place).chain(aside).find(|at| free(*at)) {
            hands[i] = at;
        }
    }
    hands
}

#[cfg(test)]
mod tests;
