//! Colours, marks and little pictures of the canvas.
//!
//! Types of sockets, stages and troubles each have a shape of their own besides their colour.

use crate::widgets::theme;
use coif_nodes::define::Type;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};
use std::f32::consts::TAU;

/// Bodies of nodes.
pub(super) const BODY: Color32 = Color32::from_gray(41);
/// Headers, before their stage tints them.
const HEADER: Color32 = Color32::from_gray(54);
/// Dots of the background.
pub(super) const DOTS: Color32 = Color32::from_gray(38);
/// Outlines at rest.
pub(super) const EDGE: Color32 = Color32::from_gray(68);
/// Size of the smallest text on a node: it is read at full size, without coming nearer.
pub(super) const SMALL: f32 = 11.0;
/// Radius of a socket's mark.
pub(super) const SOCKET: f32 = 4.6;

/// Colours of stages, in the order in which hair is made; the last but one is for unknown kinds, the last for what documents declare.
const STAGES: [Color32; 13] = [
    Color32::from_rgb(205, 160, 125),
    Color32::from_rgb(130, 190, 145),
    Color32::from_rgb(220, 165, 95),
    Color32::from_rgb(205, 130, 140),
    Color32::from_rgb(160, 150, 220),
    Color32::from_rgb(195, 145, 200),
    Color32::from_rgb(222, 150, 178),
    Color32::from_rgb(120, 180, 195),
    Color32::from_rgb(110, 185, 165),
    Color32::from_rgb(125, 165, 215),
    Color32::from_rgb(170, 175, 180),
    Color32::from_rgb(225, 140, 132),
    Color32::from_rgb(150, 168, 196),
];

/// The stage of what documents declare: groups and what belongs to them. Behind that of what nobody knows.
pub(super) const DECLARED: usize = coif_nodes::STAGES.len() + 1;

/// Colours of comment frames: their names, and how they are painted.
pub(super) const FRAMES: [(&str, Color32); 6] = [
    ("Grey", Color32::from_gray(110)),
    ("Blue", Color32::from_rgb(84, 118, 168)),
    ("Green", Color32::from_rgb(92, 140, 104)),
    ("Amber", Color32::from_rgb(168, 126, 66)),
    ("Red", Color32::from_rgb(166, 92, 88)),
    ("Violet", Color32::from_rgb(124, 104, 168)),
];

/// The colour of a frame's number.
pub(super) fn frame_colour(number: u8) -> Color32 {
    FRAMES[usize::from(number) % FRAMES.len()].1
}

/// The colour of a stage.
pub(super) fn stage_colour(stage: usize) -> Color32 {
    STAGES[stage.min(STAGES.len() - 1)]
}

/// A header's fill.
pub(super) fn header_fill(stage: usize) -> Color32 {
    HEADER.lerp_to_gamma(stage_colour(stage), 0.16)
}

/// The colour of what a wire carries.
pub(super) fn type_colour(ty: Option<Type>) -> Color32 {
    match ty {
        Some(Type::Curves) => Color32::from_rgb(128, 203, 148),
        Some(Type::Scalp) => Color32::from_rgb(219, 172, 130),
        Some(Type::Strokes) => Color32::from_rgb(232, 150, 96),
        Some(Type::Gestures) => Color32::from_rgb(226, 132, 178),
        Some(Type::Field | Type::Ramp) => Color32::from_rgb(178, 158, 235),
        Some(Type::Bool | Type::Int | Type::Float) => Color32::from_rgb(130, 180, 225),
        Some(Type::Vec3 | Type::Colour) => Color32::from_rgb(224, 205, 110),
        Some(Type::Shapes) => Color32::from_rgb(110, 200, 200),
        Some(Type::Text | Type::Choice(_) | Type::File) => Color32::from_gray(175),
        None => theme::ERROR,
    }
}

/// Corners of a regular shape, the first at `turn` (a share of a full turn from the right,
/// clockwise).
fn regular(at: Pos2, radius: f32, corners: u32, turn: f32) -> Vec<Pos2> {
    let corner = |n: u32| at + radius * Vec2::angled(TAU * (turn + n as f32 / corners as f32));
    (0..corners).map(corner).collect()
}

/// Paints the mark of a socket: its shape is the type, filled where a wire is.
pub(super) fn socket(p: &Painter, at: Pos2, ty: Option<Type>, wired: bool, bright: bool) {
    let colour = type_colour(ty);
    let r = if bright { SOCKET + 1.4 } else { SOCKET };
    let fill = if wired { colour } else { theme::SUNKEN };
    let line = Stroke::new(1.6, if bright { Color32::WHITE } else { colour });
    let polygon = |points| Shape::convex_polygon(points, fill, line);
    p.add(match ty {
        Some(Type::Curves) => {
            Shape::Circle(egui::epaint::CircleShape { center: at, radius: r, fill, stroke: line })
        }
        Some(Type::Scalp) => polygon(regular(at, r * 1.25, 4, 0.125)),
        Some(Type::Strokes) => polygon(regular(at, r * 1.25, 4, 0.0)),
        // The nib of a pen.
        Some(Type::Gestures) => polygon(regular(at, r * 1.2, 3, 0.25)),
        Some(Type::Field | Type::Ramp) => polygon(regular(at, r * 1.2, 3, 0.0)),
        Some(Type::Bool | Type::Int | Type::Float) => polygon(regular(at, r * 1.1, 5, 0.75)),
        Some(Type::Vec3 | Type::Colour | Type::Shapes) => polygon(regular(at, r * 1.1, 6, 0.0)),
        Some(Type::Text | Type::Choice(_) | Type::File) => {
            let rect = Rect::from_center_size(at, vec2(r * 1.2, r * 2.2));
            polygon(vec![
                rect.left_top(),
                rect.right_top(),
                rect.right_bottom(),
                rect.left_bottom(),
            ])
        }
        None => {
            cross(p, at, r * 0.8, Stroke::new(2.0, colour));
            return;
        }
    });
}

fn cross(p: &Painter, at: Pos2, r: f32, line: Stroke) {
    p.line_segment([at - Vec2::splat(r), at + Vec2::splat(r)], line);
    p.line_segment([at + vec2(-r, r), at + vec2(r, -r)], line);
}

/// An error: an octagon with a cross.
pub(super) fn error_mark(p: &Painter, at: Pos2, r: f32) {
    p.add(Shape::convex_polygon(regular(at, r, 8, 1.0 / 16.0), theme::ERROR, Stroke::NONE));
    cross(p, at, r * 0.4, Stroke::new(r * 0.25, theme::SUNKEN));
}

/// A warning: a triangle with an exclamation mark.
pub(super) fn warning_mark(p: &Painter, at: Pos2, r: f32) {
    let middle = at + vec2(0.0, r * 0.15);
    p.add(Shape::convex_polygon(regular(middle, r * 1.15, 3, 0.75), theme::WARNING, Stroke::NONE));
    let line = Stroke::new(r * 0.26, theme::SUNKEN);
    p.line_segment([at + vec2(0.0, -r * 0.45), at + vec2(0.0, r * 0.2)], line);
    p.circle_filled(at + vec2(0.0, r * 0.48), r * 0.14, theme::SUNKEN);
}

/// Trouble upstream: an octagon in outline, with an arrow from the left.
pub(super) fn upstream_mark(p: &Painter, at: Pos2, r: f32) {
    let line = Stroke::new(1.3, theme::ERROR);
    p.add(Shape::closed_line(regular(at, r, 8, 1.0 / 16.0), line));
    p.line_segment([at + vec2(r * 0.45, 0.0), at - vec2(r * 0.45, 0.0)], line);
    let tip = at - vec2(r * 0.45, 0.0);
    p.line_segment([tip, tip + vec2(r * 0.35, -r * 0.35)], line);
    p.line_segment([tip, tip + vec2(r * 0.35, r * 0.35)], line);
}

/// The display flag: an eye, filled where it is set.
pub(super) fn eye(p: &Painter, at: Pos2, set: bool, hovered: bool) {
    let colour = match (set, hovered) {
        (true, _) => theme::ACCENT,
        (false, true) => theme::TEXT,
        (false, false) => Color32::from_gray(112),
    };
    if set {
        p.rect_filled(Rect::from_center_size(at, vec2(18.0, 14.0)), 4.0, theme::SELECTED);
    }
    let lid = |down: f32| -> Vec<Pos2> {
        (0..=8)
            .map(|i| {
                let t = i as f32 / 8.0;
                pos2(at.x - 6.5 + 13.0 * t, at.y + down * 4.2 * (t * TAU / 2.0).sin())
            })
            .collect()
    };
    let line = Stroke::new(1.3, colour);
    p.line(lid(-1.0), line);
    p.line(lid(1.0), line);
    p.circle_filled(at, if set { 2.4 } else { 1.8 }, colour);
}

/// The bypass flag: an arrow that goes round, with a bar where it is set.
pub(super) fn bypass(p: &Painter, at: Pos2, set: bool, hovered: bool) {
    let colour = match (set, hovered) {
        (true, _) => theme::WARNING,
        (false, true) => theme::TEXT,
        (false, false) => Color32::from_gray(112),
    };
    let line = Stroke::new(1.3, colour);
    let over: Vec<Pos2> = (0..=8)
        .map(|i| at + vec2(0.0, 2.0) + 5.0 * Vec2::angled(TAU * (0.5 + i as f32 / 16.0)))
        .collect();
    let tip = over[8];
    p.line(over, line);
    p.line_segment([tip, tip + vec2(-3.4, -1.2)], line);
    p.line_segment([tip, tip + vec2(0.9, -3.4)], line);
    if set {
        p.circle_filled(at + vec2(0.0, 2.6), 2.0, colour);
    } else {
        p.circle_stroke(at + vec2(0.0, 2.6), 1.6, Stroke::new(1.0, colour));
    }
}

/// The mark of the node that the pen works on.
pub(super) fn pen(p: &Painter, at: Pos2) {
    let line = Stroke::new(1.6, theme::ACCENT);
    p.line_segment([at + vec2(-4.0, 4.0), at + vec2(3.5, -3.5)], line);
    p.line_segment([at + vec2(-4.0, 4.0), at + vec2(-1.2, 3.2)], line);
    p.circle_filled(at + vec2(4.0, -4.0), 1.6, theme::ACCENT);
}

/// The mark of a node with a note: a leaf of paper.
pub(super) fn note(p: &Painter, at: Pos2) {
    let rect = Rect::from_center_size(at, vec2(8.0, 10.0));
    let line = Stroke::new(1.0, theme::QUIET);
    p.rect_stroke(rect, 1.0, line, StrokeKind::Middle);
    for row in [-2.0, 0.5, 3.0] {
        p.line_segment([at + vec2(-2.2, row), at + vec2(2.2, row)], line);
    }
}

/// The little picture of a stage, about 14 points wide.
pub(super) fn stage(p: &Painter, at: Pos2, stage: usize) {
    let line = Stroke::new(1.4, stage_colour(stage));
    let arc = |from: f32, to: f32, r: Vec2, middle: Pos2| -> Vec<Pos2> {
        (0..=10)
            .map(|i| {
                let turn = TAU * (from + (to - from) * i as f32 / 10.0);
                middle + vec2(r.x * turn.cos(), r.y * turn.sin())
            })
            .collect()
    };
    let wave = |x: f32, side: f32, turns: f32| -> Vec<Pos2> {
        (0..=14)
            .map(|i| {
                let t = i as f32 / 14.0;
                at + vec2(x + side * 2.6 * (t * turns * TAU).sin(), -6.0 + 12.0 * t)
            })
            .collect()
    };
    match stage {
        // A head.
        0 => {
            p.line(arc(0.45, 1.05, vec2(5.0, 5.5), at - vec2(0.0, 1.0)), line);
            p.line_segment([at + vec2(-3.0, 3.0), at + vec2(-3.0, 6.5)], line);
            p.line_segment([at + vec2(3.2, 2.5), at + vec2(3.2, 6.5)], line);
        }
        // Guides that lean.
        1 => {
            for x in [-4.0, 0.0, 4.0] {
                let from = at + vec2(x - 1.0, 6.0);
                p.line(vec![from, from + vec2(0.5, -5.0), from + vec2(2.6, -12.0)], line);
            }
        }
        // Two strands that cross.
        2 => {
            p.line(wave(0.0, 1.0, 1.0), line);
            p.line(wave(0.0, -1.0, 1.0), line);
        }
        // A parting.
        3 => {
            p.line_segment([at + vec2(0.0, -6.0), at + vec2(0.0, 6.0)], line);
            p.line(arc(0.75, 0.98, vec2(6.0, 8.0), at + vec2(0.0, 6.0)), line);
            p.line(arc(0.75, 0.52, vec2(6.0, 8.0), at + vec2(0.0, 6.0)), line);
        }
        // A curl.
        4 => {
            p.line(wave(0.0, 1.4, 2.0), line);
        }
        // A puff on its tie.
        5 => {
            p.circle_stroke(at - vec2(0.0, 1.5), 4.8, line);
            p.line_segment([at + vec2(-2.0, 5.5), at + vec2(2.0, 5.5)], line);
        }
        // A pen that draws.
        6 => {
            p.line_segment([at + vec2(5.5, -6.0), at + vec2(-1.0, 2.5)], line);
            p.line(vec![at + vec2(-3.4, 1.4), at + vec2(-4.4, 5.4), at + vec2(-0.6, 4.2)], line);
            p.line_segment([at + vec2(-3.4, 1.4), at + vec2(-0.6, 4.2)], line);
            p.line_segment([at + vec2(0.5, 6.0), at + vec2(6.0, 6.0)], line);
        }
        // A filled lock.
        7 => {
            p.line(arc(0.0, 1.0, vec2(5.5, 2.2), at - vec2(0.0, 4.0)), line);
            for x in [-5.5, 0.0, 5.5] {
                p.line_segment([at + vec2(x, -3.5), at + vec2(x * 0.25, 6.5)], line);
            }
        }
        // Sliders.
        8 => {
            for (y, x) in [(-4.0, 2.0), (0.5, -2.5), (5.0, 1.0)] {
                p.line_segment([at + vec2(-6.0, y), at + vec2(6.0, y)], line);
                p.circle_filled(at + vec2(x, y), 2.0, line.color);
            }
        }
        // Out.
        9 => {
            p.line(
                vec![
                    at + vec2(0.0, -5.0),
                    at + vec2(-5.5, -5.0),
                    at + vec2(-5.5, 5.0),
                    at + vec2(0.0, 5.0),
                ],
                line,
            );
            p.line_segment([at + vec2(-2.0, 0.0), at + vec2(6.0, 0.0)], line);
            p.line(vec![at + vec2(3.0, -3.0), at + vec2(6.0, 0.0), at + vec2(3.0, 3.0)], line);
        }
        // Groups, their borders, and parameters: a box in a box.
        stage if stage == DECLARED => {
            for half in [6.0, 2.6] {
                let rect = Rect::from_center_size(at, Vec2::splat(2.0 * half));
                p.rect_stroke(rect, 1.5, line, egui::StrokeKind::Middle);
            }
        }
        _ => cross(p, at, 4.0, line),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use theme::contrast;

    #[test]
    fn marks_stand_out_from_what_they_are_drawn_on() {
        for ty in [Type::Curves, Type::Scalp, Type::Field, Type::Float, Type::Colour, Type::Text] {
            assert!(contrast(type_colour(Some(ty)), theme::SUNKEN) >= 3.0, "{ty:?}");
            assert!(contrast(type_colour(Some(ty)), BODY) >= 3.0, "{ty:?}");
        }
        for stage in 0..STAGES.len() {
            assert!(contrast(theme::TEXT, header_fill(stage)) >= 4.5, "{stage}");
            assert!(contrast(stage_colour(stage), header_fill(stage)) >= 3.0, "{stage}");
        }
        for text in [theme::QUIET, theme::ERROR, theme::WARNING] {
            assert!(contrast(text, BODY) >= 4.5);
        }
    }

    #[test]
    fn every_stage_has_a_colour_of_its_own() {
        // One more for kinds that nobody knows, and one for what documents declare.
        assert_eq!(coif_nodes::STAGES.len() + 2, STAGES.len());
    }
}
