//! What the pen shows over the picture: strokes and their points, the line being drawn, the brush on the scalp, and
//! what a touch would pick.
//!
//! Points and lines have the same size at any distance. What is picked differs by shape and size, not by colour alone.

use super::gestures::Work;
use super::shapes::{Shape, StrokePlace};
use super::{Pen, PenTool, Said, Scene};
use crate::core::projection::Projection;
use crate::widgets::theme;
use coif_nodes::data::scalp::Scalp;
use egui::{Align2, Color32, FontId, Painter, Pos2, Shape as Drawn, Stroke, Vec2};
use glam::Vec3;

/// Radius of a point of a stroke, points of the screen.
const POINT: f32 = 3.0;
/// Corners of the brush's disc.
const CORNERS: usize = 40;
/// Lines of strokes.
pub(super) const LINE: Color32 = Color32::from_rgb(150, 190, 230);
/// Outlines around marks, so that they are seen on hair of any colour.
pub(super) const EDGE: Color32 = Color32::from_black_alpha(160);

impl Pen {
    /// Paints over the picture.
    pub(super) fn paint(&self, ui: &egui::Ui, scene: &Scene) {
        let painter = ui.painter_at(scene.view.rect);
        if self.tool == PenTool::Draw {
            self.hairline.borrow_mut().paint(&painter, scene);
        }
        if self.tool != PenTool::Select {
            let hovered = self.hovered(scene);
            for shape in self.shapes.all() {
                let whose = hovered.map(StrokePlace::stroke) == Some(shape.id);
                self.paint_stroke(&painter, shape, whose);
            }
            if let Some(StrokePlace::Point(id, i)) = hovered
                && let Some(p) = self.shapes.of(id).and_then(|shape| shape.screen[i])
            {
                painter.circle_stroke(p, POINT + 3.0, Stroke::new(1.5, theme::ACCENT));
            }
        }
        match self.gesture.as_ref().map(|gesture| &gesture.work).or(self.ended.as_ref()) {
            Some(Work::Draw(line) | Work::Redraw { line, .. }) => {
                let pressures = line.samples().iter().map(|sample| sample.pressure);
                let widths: Vec<f32> = pressures.map(|p| 1.0 + 4.0 * p).collect();
                ink(&painter, scene.view, line.world(), &widths, theme::ACCENT);
                if scene.is_mirrored() {
                    let twin = |sample: &coif_nodes::data::strokes::Sample| {
                        scene.scalp.place(sample.position * Vec3::new(-1.0, 1.0, 1.0))
                    };
                    let twin: Vec<Vec3> = line.samples().iter().map(twin).collect();
                    ink(&painter, scene.view, &twin, &widths, theme::ACCENT.gamma_multiply(0.5));
                }
            }
            Some(Work::Outline { line, lasso, .. }) => outline(&painter, line, *lasso),
            _ => {}
        }
        self.paint_cursor(ui, &painter, scene);
        tell(ui, &painter, scene.view.rect, self.said.as_ref());
        if self.tool != PenTool::Select {
            let name = scene.node.map(|node| scene.state.document.name_of(node));
            let words =
                format!("{}: {}", self.tool.label(), name.as_deref().unwrap_or("new stroke input"));
            let at = scene.view.rect.right_top() + Vec2::new(-12.0, 12.0);
            label(&painter, at, Align2::RIGHT_TOP, &words);
        }
    }

    /// What a touch would pick now.
    fn hovered(&self, scene: &Scene) -> Option<StrokePlace> {
        let input = self.hover.filter(|_| self.gesture.is_none())?;
        let reach = match self.tool {
            PenTool::Points => scene.reach,
            PenTool::Redraw => scene.reach * 3.0,
            _ => return None,
        };
        self.shapes.pick(input.sample.pos, reach)
    }

    fn paint_stroke(&self, painter: &Painter, shape: &Shape, hovered: bool) {
        let picked = self.picked.strokes.contains(&shape.id);
        let colour = if picked || hovered { theme::ACCENT } else { LINE };
        // While strokes are drawn the hair matters more than those that are done.
        let width = match (picked, self.tool) {
            (true, _) => 2.5,
            (false, PenTool::Draw) => 1.0,
            (false, _) => 1.5,
        };
        // Runs of what is before the head and of what is behind it, by turns.
        let mut run: Vec<Pos2> = vec![];
        let mut before = true;
        let finish = |run: Vec<Pos2>, before: bool| match before {
            true => line(painter, run, Stroke::new(width, colour)),
            false => faint(painter, run, Stroke::new(width, colour)),
        };
        for (p, seen) in shape.screen.iter().zip(&shape.seen) {
            if *seen != before || p.is_none() {
                let last = run.last().copied().filter(|_| p.is_some());
                finish(std::mem::take(&mut run), before);
                run.extend(last);
                before = *seen;
            }
            run.extend(*p);
        }
        finish(run, before);
        if self.tool != PenTool::Points || shape.locked {
            return;
        }
        for (i, p) in shape.screen.iter().enumerate() {
            let Some(p) = p.filter(|_| shape.seen[i]) else { continue };
            // The root is a square, which also tells the direction.
            let mark = |radius: f32, colour: Color32| match i {
                0 => Drawn::rect_filled(
                    egui::Rect::from_center_size(p, Vec2::splat(radius * 2.0)),
                    0.0,
                    colour,
                ),
                _ => Drawn::circle_filled(p, radius, colour),
            };
            let picked = self.picked.points.contains(&(shape.id, i));
            let radius = if picked { POINT + 2.0 } else { POINT };
            painter.add(mark(radius + 1.0, EDGE));
            painter.add(mark(radius, if picked { theme::ACCENT } else { Color32::WHITE }));
        }
    }

    /// The disc of the brush, or a dot with the pressure that a mouse would have.
    fn paint_cursor(&self, ui: &egui::Ui, painter: &Painter, scene: &Scene) {
        let Some(input) = self.hover.filter(|_| self.tool != PenTool::Select) else { return };
        let at = input.sample.pos;
        let eraser = input.sample.tool == super::sample::Tool::Eraser;
        let ray = scene.view.ray(at);
        let hit = scene.scalp.surface().ray(ray.origin, ray.direction, f32::MAX);
        if (self.tool.has_brush() || eraser)
            && let Some(hit) = hit
        {
            let radius = scene.state.settings.pen.brush();
            let disc = disc(scene.scalp, hit.point, hit.triangle, hit.bary, radius);
            let mut ring: Vec<Pos2> = disc.iter().filter_map(|p| scene.view.screen(*p)).collect();
            ring.extend(ring.first().copied());
            line(painter, ring, Stroke::new(1.5, theme::ACCENT));
        }
        if self.tool == PenTool::Draw && self.gesture.is_none() {
            painter.circle(at, 2.5, theme::ACCENT, Stroke::new(1.0, EDGE));
            if input.sample.tool == super::sample::Tool::Mouse {
                let pressure = scene.state.settings.pen.mouse_pressure;
                let hand = Self::hand(&input);
                let left = input.left_handed;
                let side = if left { hand.right_top() } else { hand.left_top() };
                let off = Vec2::new(if left { -10.0 } else { 10.0 }, -14.0);
                let align = if left { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
                label(painter, side + off, align, &format!("{:.0} %", pressure * 100.0));
            }
        }
        if ui.rect_contains_pointer(scene.view.rect) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
    }
}

/// A circle laid on the scalp.
pub(super) fn disc(
    scalp: &Scalp,
    at: Vec3,
    triangle: u32,
    bary: glam::Vec2,
    radius: f32,
) -> Vec<Vec3> {
    let normal = scalp.surface().smooth_normal(triangle, bary);
    let across = normal.any_orthonormal_vector();
    let up = normal.cross(across);
    let corner = |k: usize| {
        let turn = std::f32::consts::TAU * k as f32 / CORNERS as f32;
        let p = at + (across * turn.cos() + up * turn.sin()) * radius;
        scalp.closest_root(p).map_or(p, |root| root.point + root.normal * 0.05)
    };
    (0..CORNERS).map(corner).collect()
}

/// A line whose width is the pressure.
fn ink(painter: &Painter, view: &Projection, world: &[Vec3], widths: &[f32], colour: Color32) {
    let screen: Vec<Option<Pos2>> = world.iter().map(|p| view.screen(*p)).collect();
    for (pair, width) in screen.windows(2).zip(widths) {
        if let [Some(a), Some(b)] = pair {
            painter.line_segment([*a, *b], Stroke::new(*width, colour));
        }
    }
}

pub(super) fn line(painter: &Painter, run: Vec<Pos2>, stroke: Stroke) {
    if run.len() > 1 {
        painter.add(Drawn::line(run.clone(), Stroke::new(stroke.width + 2.0, EDGE)));
        painter.add(Drawn::line(run, stroke));
    }
}

/// A line behind the head.
fn faint(painter: &Painter, run: Vec<Pos2>, stroke: Stroke) {
    if run.len() > 1 {
        painter.add(Drawn::line(run, Stroke::new(1.0, stroke.color.gamma_multiply(0.3))));
    }
}

fn outline(painter: &Painter, places: &[Pos2], lasso: bool) {
    let stroke = Stroke::new(1.0, theme::ACCENT);
    match (places.first(), places.last()) {
        (Some(first), Some(last)) if !lasso => {
            let rect = egui::Rect::from_two_pos(*first, *last);
            painter.rect_stroke(rect, 0.0, stroke, egui::StrokeKind::Middle);
        }
        (Some(first), _) => {
            let closed = places.iter().chain([first]).copied().collect();
            painter.add(Drawn::line(closed, stroke));
        }
        _ => {}
    }
}

/// Why a touch did nothing, where it ended, for as long as that is told.
pub(super) fn tell(ui: &egui::Ui, painter: &Painter, rect: egui::Rect, said: Option<&Said>) {
    let now = ui.input(|input| input.time);
    let Some(Said { at, until, text }) = said.filter(|said| said.until > now) else { return };
    let left = at.x < rect.center().x;
    let align = if left { Align2::LEFT_TOP } else { Align2::RIGHT_TOP };
    let aside = Vec2::new(if left { 16.0 } else { -16.0 }, 14.0);
    label(painter, rect.clamp(*at) + aside, align, text);
    ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(*until - now));
}

pub(super) fn label(painter: &Painter, at: Pos2, align: Align2, words: &str) {
    let font = FontId::proportional(12.0);
    let galley = painter.layout_no_wrap(words.to_owned(), font, theme::TEXT);
    let rect = align.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand(4.0), 3.0, theme::GROUND.gamma_multiply(0.8));
    painter.galley(rect.min, galley, theme::TEXT);
}
