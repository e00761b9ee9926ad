//! What of the canvas is in sight: zoom, pan, fitting.

use super::Canvas;
use super::hand::Hand;
use crate::core::faces::Faces;
use coif_graphs::document::NodeId;
use egui::{MouseWheelUnit, Pos2, Rangef, Rect, Sense, Ui, Vec2, vec2};
use std::collections::BTreeSet;

/// How small and how large nodes can be drawn.
pub(super) const ZOOM: Rangef = Rangef { min: 0.1, max: 2.0 };
/// Room left round what is brought into sight, in points of the screen.
const MARGIN: f32 = 36.0;

/// Whether a view can be drawn at all.
pub(super) fn is_sound(seen: Rect) -> bool {
    seen.is_finite() && seen.width() > 0.0 && seen.height() > 0.0
}

/// Covers the room, so that the next press means only what is in the hand. True when it was pressed.
pub(super) fn shield(ui: &Ui, area: Rect, name: &str) -> bool {
    let id = egui::Id::new(("canvas shield", name));
    let shown = egui::Area::new(id)
        .order(egui::Order::Middle)
        .fixed_pos(area.min)
        .show(ui.ctx(), |ui| ui.allocate_exact_size(area.size(), Sense::click_and_drag()).1);
    shown.inner.is_pointer_button_down_on() && ui.input(|i| i.pointer.primary_pressed())
}

impl Canvas {
    /// Points of the screen for a unit of the canvas.
    pub(super) fn scale(&self) -> f32 {
        let (Some(area), seen) = (self.area, self.view.scene_rect) else { return 1.0 };
        if !is_sound(seen) {
            return 1.0;
        }
        ZOOM.clamp((area.size() / seen.size()).min_elem())
    }

    /// A place of the screen on the canvas.
    pub(super) fn to_canvas(&self, at: Pos2) -> Pos2 {
        let middle = self.area.map_or(Pos2::ZERO, |area| area.center());
        self.view.scene_rect.center() + (at - middle) / self.scale()
    }

    /// A place of the canvas on the screen.
    pub(crate) fn to_screen(&self, at: Pos2) -> Pos2 {
        let middle = self.area.map_or(Pos2::ZERO, |area| area.center());
        middle + (at - self.view.scene_rect.center()) * self.scale()
    }

    /// What of the canvas is in sight.
    pub(super) fn seen(&self) -> Rect {
        let area = self.area.unwrap_or(Rect::ZERO);
        Rect::from_min_max(self.to_canvas(area.min), self.to_canvas(area.max))
    }

    pub(super) fn see(&mut self, center: Pos2, scale: f32) {
        let size = self.area.map_or(vec2(1.0, 1.0), |area| area.size());
        self.view.scene_rect = Rect::from_center_size(center, size / ZOOM.clamp(scale));
    }

    /// Sees the same part of the canvas as another; whether it saw another.
    pub(crate) fn see_as(&mut self, other: &Self) -> bool {
        let (mine, theirs) = (self.view.scene_rect, other.view.scene_rect);
        let off = (mine.min - theirs.min).abs() + (mine.max - theirs.max).abs();
        // A view that was never drawn is no view.
        let is_new = is_sound(theirs) && off.max_elem() >= 0.1;
        if is_new {
            self.view.scene_rect = theirs;
        }
        is_new
    }

    /// Brings a part of the canvas into sight, no larger than full size.
    pub(crate) fn look_at_part(&mut self, part: Rect) {
        let size = self.area.map_or(vec2(1.0, 1.0), |area| area.size());
        let room = (size - Vec2::splat(2.0 * MARGIN)).max(vec2(8.0, 8.0));
        self.see(part.center(), (room / part.size()).min_elem().min(1.0));
    }

    pub(super) fn center_on(&mut self, at: Pos2) {
        self.see(at, self.scale());
    }

    /// Brings nodes into sight whole, no larger than full size.
    pub(super) fn look_at(&mut self, faces: &Faces, nodes: &BTreeSet<NodeId>) {
        match faces.bounds(nodes) {
            Some(all) => self.look_at_part(all),
            None => {
                let size = self.area.map_or(vec2(1.0, 1.0), |area| area.size());
                self.see(Pos2::ZERO + size / 2.0, 1.0);
            }
        }
    }

    /// Brings a node into sight, moving the view no more than that takes.
    pub(super) fn reveal(&mut self, faces: &Faces, node: &NodeId) {
        let Some(rect) = faces.rect(node) else { return };
        let seen = self.seen().shrink(MARGIN / self.scale());
        let off = (rect.min - seen.min).min(Vec2::ZERO) + (rect.max - seen.max).max(Vec2::ZERO);
        if off != Vec2::ZERO && is_sound(self.view.scene_rect) {
            self.view.scene_rect = self.view.scene_rect.translate(off);
        }
    }

    /// Wheel, Space and the edge of the room. Touchpads and Ctrl with the wheel are egui's.
    pub(super) fn steer(&mut self, ui: &Ui, area: Rect) {
        if !is_sound(self.view.scene_rect) {
            return;
        }
        let pointer = ui.input(|i| i.pointer.latest_pos());
        let over = pointer.filter(|at| area.contains(*at) && ui.rect_contains_pointer(area));
        if let Some(at) = over {
            self.turn_wheel(ui, at);
        }
        let space = ui.input(|i| i.key_down(egui::Key::Space));
        if space && over.is_some() && !ui.ctx().egui_wants_keyboard_input() {
            shield(ui, area, "pan");
            let (down, delta) = ui.input(|i| (i.pointer.any_down(), i.pointer.delta()));
            if down && delta != Vec2::ZERO {
                self.view.scene_rect = self.view.scene_rect.translate(-delta / self.scale());
            }
        }
        self.pan_at_the_edge(ui, area, pointer);
    }

    fn turn_wheel(&mut self, ui: &Ui, at: Pos2) {
        let turned = ui.input(|i| {
            i.events.iter().rev().find_map(|event| match event {
                egui::Event::MouseWheel { unit, modifiers, .. } => {
                    Some(*unit == MouseWheelUnit::Line && !modifiers.any())
                }
                _ => None,
            })
        });
        self.memory.wheel = turned.unwrap_or(self.memory.wheel);
        let by = ui.input(|i| i.smooth_scroll_delta()).y;
        if !self.memory.wheel || by == 0.0 || self.memory.finder.is_some() {
            return;
        }
        // Zoom about the pointer instead of moving up and down.
        ui.ctx().input_mut(|i| i.smooth_scroll_delta = Vec2::ZERO);
        let anchor = self.to_canvas(at);
        let scale = ZOOM.clamp(self.scale() * (by / 240.0).exp());
        let middle = self.area.map_or(at, |area| area.center());
        self.see(anchor - (at - middle) / scale, scale);
    }

    /// A wire, a bend or a frame that is held near the edge moves the view.
    fn pan_at_the_edge(&mut self, ui: &Ui, area: Rect, pointer: Option<Pos2>) {
        let holds = !matches!(self.memory.hand, Hand::Empty | Hand::Cut(_));
        let down = ui.input(|i| i.pointer.primary_down());
        let Some(at) = pointer.filter(|_| holds && down) else { return };
        let inner = area.shrink(28.0);
        let off = (at - inner.min).min(Vec2::ZERO) + (at - inner.max).max(Vec2::ZERO);
        if off != Vec2::ZERO {
            let step = off.clamp(Vec2::splat(-40.0), Vec2::splat(40.0)) * 18.0;
            let by = step * ui.input(|i| i.stable_dt).min(0.05) / self.scale();
            self.view.scene_rect = self.view.scene_rect.translate(by);
            ui.ctx().request_repaint();
        }
    }
}
