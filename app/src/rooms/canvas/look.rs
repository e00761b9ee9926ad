//! Colours, marks and little pictures of the canvas.
//!
//! Types of sockets, stages and troubles each have a shape of their own besides their colour.

use crate::widgets::theme::{self, Tint};
use coif_nodes::define::Type;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};
use std::f32::consts::TAU;

/// Bodies of nodes.
pub(super) const BODY: Tint = Tint::grey(41, 255);
/// Headers, before their stage tints them.
const HEADER: Tint = Tint::grey(54, 226);
/// Dots of the background.
pub(super) const DOTS: Tint = Tint::grey(38, 218);
/// Outlines at rest.
pub(super) const EDGE: Tint = Tint::grey(68, 168);
/// Between the parts of a node.
pub(super) const RULE: Tint = Tint::grey(50, 222);
/// Flags that are not set.
const OFF: Tint = Tint::grey(112, 130);
/// Size of the smallest text on a node: it is read at full size, without coming nearer.
pub(super) const SMALL: f32 = 11.0;
/// Radius of a socket's mark.
pub(super) const SOCKET: f32 = 4.6;

/// Colours of stages, in the order in which hair is made; the last but one is for unknown kinds, the last for what documents declare.
const STAGES: [Tint; 13] = [
    Tint::new([205, 160, 125], [150, 93, 49]),
    Tint::new([130, 190, 145], [55, 118, 71]),
    Tint::new([220, 165, 95], [151, 94, 23]),
    Tint::new([205, 130, 140], [183, 62, 78]),
    Tint::new([160, 150, 220], [104, 86, 209]),
    Tint::new([195, 145, 200], [156, 73, 164]),
    Tint::new([222, 150, 178], [190, 47, 103]),
    Tint::new([120, 180, 195], [50, 115, 131]),
    Tint::new([110, 185, 165], [50, 118, 100]),
    Tint::new([125, 165, 215], [45, 107, 185]),
    Tint::new([170, 175, 180], [101, 108, 116]),
    Tint::new([225, 140, 132], [195, 48, 35]),
    Tint::new([150, 168, 196], [79, 108, 153]),
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
pub(super) fn stage_colour(stage: usize) -> Tint {
    STAGES[stage.min(STAGES.len() - 1)]
}

/// A header's fill.
pub(super) fn header_fill(stage: usize) -> Tint {
    HEADER.mixed(stage_colour(stage), 0.16)
}

/// Corners of a regular shape, the first at `turn` (a share of a full turn from the right,
/// clockwise).
fn regular(at: Pos2, radius: f32, corners: u32, turn: f32) -> Vec<Pos2> {
    let corner = |n: u32| at + radius * Vec2::angled(TAU * (turn + n as f32 / corners as f32));
    (0..corners).map(corner).collect()
}

/// Paints the mark of a socket: its shape is the type, filled where a wire is.
pub(super) fn socket(p: &Painter, at: Pos2, ty: Option<Type>, wired: bool, bright: bool) {
    let colour = theme::of_type(ty).of(p);
    let r = if bright { SOCKET + 1.4 } else { SOCKET };
    let fill = if wired { colour } else { theme::SUNKEN.of(p) };
    let line = Stroke::new(1.6, if bright { theme::STRONG.of(p) } else { colour });
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
    p.add(Shape::convex_polygon(regular(at, r, 8, 1.0 / 16.0), theme::ERROR.of(p), Stroke::NONE));
    cross(p, at, r * 0.4, Stroke::new(r * 0.25, theme::SUNKEN.of(p)));
}

/// A warning: a triangle with an exclamation mark.
pub(super) fn warning_mark(p: &Painter, at: Pos2, r: f32) {
    let middle = at + vec2(0.0, r * 0.15);
    p.add(Shape::convex_polygon(
        regular(middle, r * 1.15, 3, 0.75),
        theme::WARNING.of(p),
        Stroke::NONE,
    ));
    let line = Stroke::new(r * 0.26, theme::SUNKEN.of(p));
    p.line_segment([at + vec2(0.0, -r * 0.45), at + vec2(0.0, r * 0.2)], line);
    p.circle_filled(at + vec2(0.0, r * 0.48), r * 0.14, theme::SUNKEN.of(p));
}

/// Trouble upstream: an octagon in outline, with an arrow from the left.
pub(super) fn upstream_mark(p: &Painter, at: Pos2, r: f32) {
    let line = Stroke::new(1.3, theme::ERROR.of(p));
    p.add(Shape::closed_line(regular(at, r, 8, 1.0 / 16.0), line));
    p.line_segment([at + vec2(r * 0.45, 0.0), at - vec2(r * 0.45, 0.0)], line);
    let tip = at - vec2(r * 0.45, 0.0);
    p.line_segment([tip, tip + vec2(r * 0.35, -r * 0.35)], line);
    p.line_segment([tip, tip + vec2(r * 0.35, r * 0.35)], line);
}

/// The display flag: an eye, filled where it is set.
pub(super) fn eye(p: &Painter, at: Pos2, set: bool, hovered: bool) {
    let colour = match (set, hovered) {
        (true, _) => theme::ACCENT.of(p),
        (false, true) => theme::TEXT.of(p),
        (false, false) => OFF.of(p),
    };
    if set {
        p.rect_filled(Rect::from_center_size(at, vec2(18.0, 14.0)), 4.0, theme::SELECTED.of(p));
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
        (true, _) => theme::WARNING.of(p),
        (false, true) => theme::TEXT.of(p),
        (false, false) => OFF.of(p),
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
    let line = Stroke::new(1.6, theme::ACCENT.of(p));
    p.line_segment([at + vec2(-4.0, 4.0), at + vec2(3.5, -3.5)], line);
    p.line_segment([at + vec2(-4.0, 4.0), at + vec2(-1.2, 3.2)], line);
    p.circle_filled(at + vec2(4.0, -4.0), 1.6, theme::ACCENT.of(p));
}

/// The mark of a node with a note: a leaf of paper.
pub(super) fn note(p: &Painter, at: Pos2) {
    let rect = Rect::from_center_size(at, vec2(8.0, 10.0));
    let line = Stroke::new(1.0, theme::QUIET.of(p));
    p.rect_stroke(rect, 1.0, line, StrokeKind::Middle);
    for row in [-2.0, 0.5, 3.0] {
        p.line_segment([at + vec2(-2.2, row), at + vec2(2.2, row)], line);
    }
}

/// The little picture of a stage, about 14 points wide.
pub(super) fn stage(p: &Painter, at: Pos2, stage: usize) {
    let line = Stroke::new(1.4, stage_colour(stage).of(p));
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
    fn marks_stand_out_from_what_they_are_drawn_on_in_both_themes() {
        for theme in [egui::Theme::Dark, egui::Theme::Light] {
            let contrast = |a: Tint, b: Tint| contrast(a.in_theme(theme), b.in_theme(theme));
            for ty in
                [Type::Curves, Type::Scalp, Type::Field, Type::Float, Type::Colour, Type::Text]
            {
                assert!(contrast(theme::of_type(Some(ty)), BODY) >= 3.0, "{theme:?} {ty:?}");
            }
            for stage in 0..STAGES.len() {
                let header = header_fill(stage);
                assert!(contrast(theme::TEXT, header) >= 4.5, "{theme:?} {stage}");
                assert!(contrast(stage_colour(stage), header) >= 3.0, "{theme:?} {stage}");
            }
            for text in [theme::TEXT, theme::QUIET, theme::ERROR, theme::WARNING, theme::ACCENT] {
                assert!(contrast(text, BODY) >= 4.5, "{theme:?} {text:?}");
            }
            for (name, colour) in FRAMES {
                let title = theme::TEXT.in_theme(theme);
                let under = theme::SUNKEN.in_theme(theme).lerp_to_gamma(colour, 0.16);
                assert!(theme::contrast(title, under) >= 4.5, "{theme:?} {name}");
            }
        }
    }

    #[test]
    fn every_stage_has_a_colour_of_its_own() {
        // One more for kinds that nobody knows, and one for what documents declare.
        assert_eq!(coif_nodes::STAGES.len() + 2, STAGES.len());
    }
}
