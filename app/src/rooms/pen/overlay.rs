//! What the pen shows over the picture: strokes and their points, the line being drawn, the brush on the scalp, and
//! what a touch would pick.
//!
//! Points and lines have the same size at any distance. What is picked differs by shape and size, not by colour alone.

use super::devices::Input;
use super::drawing::{GrowingStroke, skin};
use super::sample::Tool;
use super::shapes::{Shape, StrokePlace};
use super::touch::Touches;
use super::{PenTool, Said, Scene, edits, hair, mask};
use crate::widgets::theme;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::Sample;
use coif_nodes::maths::closest::Hit;
use egui::{Align2, Color32, FontId, Painter, Pos2, Shape as Drawn, Stroke, Vec2};
use glam::Vec3;

/// Radius of a point of a stroke, points of the screen.
const POINT: f32 = 3.0;
/// Corners of the brush's disc.
const CORNERS: usize = 40;
/// How strongly the ring is drawn where a brush does half of what it does in its middle.
pub(super) const HALF: f32 = 0.5;
/// Lines of strokes.
pub(super) const LINE: Color32 = Color32::from_rgb(150, 190, 230);
/// Outlines around marks, so that they are seen on hair of any colour.
pub(super) const EDGE: Color32 = Color32::from_black_alpha(160);

/// Paints over the picture: what lies under the touch, the touch, the pen, and words.
pub(super) fn paint(tool: PenTool, touches: &Touches, ui: &egui::Ui, scene: &mut Scene) {
    let painter = ui.painter_at(scene.view.rect);
    let still = touches.hover.filter(|_| !touches.is_drawing());
    match tool {
        PenTool::Select => {}
        PenTool::Hair(_) => {
            let shown = scene.state.shown.as_ref();
            if shown.is_some_and(|shown| shown.curves.curve_count() == 0) {
                scene.hairline.paint(&painter, &scene.view, scene.scalp);
            }
            hair::under(&painter, scene);
        }
        PenTool::Mask(_) => mask::under(&painter, scene),
        tool => strokes(tool, still, &painter, scene),
    }
    if let Some(work) = touches.seen() {
        work.paint(&painter, scene);
    }
    match (tool, touches.hover) {
        (PenTool::Select, _) | (_, None) => {}
        (PenTool::Hair(_), _) if touches.is_drawing() => {}
        (PenTool::Hair(tool), Some(input)) => hair::cursor(tool, &input, &painter, scene),
        (tool, Some(input)) => cursor(tool, &input, still.is_some(), &painter, scene),
    }
    tell(ui, &painter, scene);
    if tool != PenTool::Select {
        let words = format!("{}: {}", tool.label(), filled(tool, scene));
        let at = scene.view.rect.right_top() + Vec2::new(-12.0, 12.0);
        label(&painter, at, Align2::RIGHT_TOP, &words);
        if touches.hover.is_some() && ui.rect_contains_pointer(scene.view.rect) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
    }
}

/// What a touch fills: the curves that are not frozen, or else a node.
fn filled(tool: PenTool, scene: &mut Scene) -> String {
    let free = matches!(tool, PenTool::Hair(_)).then(|| hair::frozen(scene)).flatten();
    let node = || scene.node.as_ref().map(|node| scene.state.document.name_of(node).into());
    free.or_else(node).unwrap_or_else(|| {
        let new = coif_nodes::by_id(tool.fills().kind()).map_or("", |def| def.label);
        format!("new {}", new.to_lowercase())
    })
}

/// The strokes, and what a touch would pick now.
fn strokes(tool: PenTool, still: Option<Input>, painter: &Painter, scene: &mut Scene) {
    if tool == PenTool::Draw {
        scene.hairline.paint(painter, &scene.view, scene.scalp);
    }
    let reach = match tool {
        PenTool::Points => Some(scene.reach),
        PenTool::Redraw => Some(scene.reach * 3.0),
        _ => None,
    };
    let hovered =
        still.zip(reach).and_then(|(input, reach)| scene.shapes.pick(input.sample.pos, reach));
    for shape in scene.shapes.all() {
        let whose = hovered.map(StrokePlace::stroke) == Some(shape.id);
        stroke(tool, shape, whose, painter, scene);
    }
    if let Some(StrokePlace::Point(id, i)) = hovered
        && let Some(p) = scene.shapes.of(id).and_then(|shape| shape.screen[i])
    {
        painter.circle_stroke(p, POINT + 3.0, Stroke::new(1.5, theme::ACCENT.dark));
    }
}

fn stroke(tool: PenTool, shape: &Shape, hovered: bool, painter: &Painter, scene: &Scene) {
    let picked = scene.picked.strokes.contains(&shape.id);
    let colour = if picked || hovered { theme::ACCENT.dark } else { LINE };
    // While strokes are drawn the hair matters more than those that are done.
    let width = match (picked, tool) {
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
    if tool != PenTool::Points || shape.locked {
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
        let picked = scene.picked.points.contains(&(shape.id, i));
        let radius = if picked { POINT + 2.0 } else { POINT };
        painter.add(mark(radius + 1.0, EDGE));
        painter.add(mark(radius, if picked { theme::ACCENT.dark } else { Color32::WHITE }));
    }
}

/// The disc of the brush and where it is half as strong, or a dot with the pressure that a mouse would have.
fn cursor(tool: PenTool, input: &Input, still: bool, painter: &Painter, scene: &Scene) {
    let at = input.sample.pos;
    if tool.has_brush() || input.sample.tool == Tool::Eraser {
        let radius = scene.state.settings.pen.brush();
        brush(painter, scene, at, radius, theme::ACCENT.dark);
        let half = match tool {
            _ if input.sample.tool == Tool::Eraser => None,
            PenTool::Comb | PenTool::Smooth => Some(edits::Pass::half()),
            PenTool::Mask(_) => Some(mask::half(scene)),
            _ => None,
        };
        if let Some(half) = half {
            brush(painter, scene, at, half * radius, theme::ACCENT.dark.gamma_multiply(HALF));
        }
    }
    if tool == PenTool::Draw && still {
        painter.circle(at, 2.5, theme::ACCENT.dark, Stroke::new(1.0, EDGE));
        if input.sample.tool == Tool::Mouse {
            let words = format!("{:.0} %", scene.state.settings.pen.mouse_pressure * 100.0);
            let (side, align) = match input.left_handed {
                true => (-10.0, Align2::RIGHT_CENTER),
                false => (10.0, Align2::LEFT_CENTER),
            };
            label(painter, at + Vec2::new(side, -14.0), align, &words);
        }
    }
}

/// The disc of a brush on the skin under the pen.
pub(super) fn brush(painter: &Painter, scene: &Scene, at: Pos2, radius: f32, colour: Color32) {
    let hit = skin(scene.scalp, &scene.view, at);
    let disc = hit.map_or(vec![], |hit| disc(scene.scalp, &hit, radius));
    let mut ring: Vec<Pos2> = disc.iter().filter_map(|p| scene.view.screen(*p)).collect();
    ring.extend(ring.first().copied());
    line(painter, ring, Stroke::new(1.5, colour));
}

/// A circle laid on the scalp.
fn disc(scalp: &Scalp, hit: &Hit, radius: f32) -> Vec<Vec3> {
    let normal = scalp.surface().smooth_normal(hit.triangle, hit.bary);
    let across = normal.any_orthonormal_vector();
    let up = normal.cross(across);
    let corner = |k: usize| {
        let turn = std::f32::consts::TAU * k as f32 / CORNERS as f32;
        let p = hit.point + (across * turn.cos() + up * turn.sin()) * radius;
        scalp.closest_root(p).map_or(p, |root| root.point + root.normal * 0.05)
    };
    (0..CORNERS).map(corner).collect()
}

/// A stroke while it is drawn, as wide as it is pressed; its twin on the other side of the head is paler.
pub(super) fn ink(painter: &Painter, scene: &Scene, stroke: &GrowingStroke) {
    let line = |world: &[Vec3], colour: Color32| {
        let screen: Vec<Option<Pos2>> = world.iter().map(|p| scene.view.screen(*p)).collect();
        for (pair, sample) in screen.windows(2).zip(stroke.samples()) {
            if let [Some(a), Some(b)] = *pair {
                let width = 1.0 + 4.0 * sample.pressure;
                painter.line_segment([a, b], Stroke::new(width, colour));
            }
        }
    };
    line(stroke.world(), theme::ACCENT.dark);
    if scene.is_mirrored() {
        let place = |s: &Sample| scene.scalp.place(s.position * Vec3::new(-1.0, 1.0, 1.0));
        let twin: Vec<Vec3> = stroke.samples().iter().map(place).collect();
        line(&twin, theme::ACCENT.dark.gamma_multiply(0.5));
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

/// A line around what would be picked.
pub(super) fn outline(painter: &Painter, mut places: Vec<Pos2>) {
    places.extend(places.first().copied());
    painter.add(Drawn::line(places, Stroke::new(1.0, theme::ACCENT.dark)));
}

/// Why a touch did nothing, where it ended, for as long as that is told.
fn tell(ui: &egui::Ui, painter: &Painter, scene: &Scene) {
    let (now, rect) = (scene.now, scene.view.rect);
    let Some(Said { at, until, text }) = scene.said.as_ref().filter(|said| said.until > now) else {
        return;
    };
    let left = at.x < rect.center().x;
    let align = if left { Align2::LEFT_TOP } else { Align2::RIGHT_TOP };
    let aside = Vec2::new(if left { 16.0 } else { -16.0 }, 14.0);
    label(painter, rect.clamp(*at) + aside, align, text);
    ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(*until - now));
}

pub(super) fn label(painter: &Painter, at: Pos2, align: Align2, words: &str) {
    let font = FontId::proportional(12.0);
    let galley = painter.layout_no_wrap(words.to_owned(), font, theme::TEXT.dark);
    let rect = align.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand(4.0), 3.0, theme::GROUND.dark.gamma_multiply(0.8));
    painter.galley(rect.min, galley, theme::TEXT.dark);
}
