//! The colour wheel: what the next clusters are planted in, picked where the pen is.
//!
//! It follows the pen where there is neither skin nor hair within its reach; pressed to level 2 or 3 it stays, and the colour under
//! the pen when that is lifted is the one. Inside are the colours that hair grows in: black in the middle, lighter outwards, ash to
//! the left and red to the right; round them dyes. The very middle is no colour: that of the hair downstream.

use super::super::Scene;
use super::super::overlay::EDGE;
use super::super::sample::{PenSample, Phase};
use super::super::target::Fills;
use super::super::touch::{Outcome, Touch, TouchStep, Work};
use super::touch::STILL;
use crate::core::event::Event;
use coif_nodes::maths::hair_colour::{absorption_of_melanin, colour_of};
use coif_nodes::sketch::around::ViewedCurves;
use egui::{Color32, Mesh, Painter, Pos2, Rgba, Shape, Stroke, Vec2};

/// Its radius, points.
pub(super) const RADIUS: f32 = 62.0;
/// Where the parts of it end, in its radius: no colour, hair, dyes.
const NONE: f32 = 0.14;
const GROWN: f32 = 0.72;
/// Spokes and rings that it is painted with.
const SPOKES: usize = 48;
const RINGS: usize = 10;

/// The wheel while it is pressed: where it was pressed down, and where the pen is on it.
struct Wheel {
    middle: Pos2,
    at: Pos2,
}

/// A touch that picks a colour, for the sketch that is there or would be made.
pub(super) fn touch(at: Pos2, scene: &Scene) -> Touch {
    let id = || scene.state.document.free_id(Fills::Hair.kind());
    let node = scene.node.clone().unwrap_or_else(id);
    Touch::new((node, vec![]), Fills::Hair, "", Wheel { middle: at, at }, scene)
}

impl Work for Wheel {
    fn go_on(&mut self, sample: &PenSample, _: &Scene) {
        if sample.phase == Phase::Move {
            self.at = sample.pos;
        }
    }
    /// A tap picks nothing.
    fn end(&mut self, _: &mut TouchStep, scene: &mut Scene) -> Outcome {
        if self.at.distance(self.middle) > STILL {
            let mut settings = scene.state.settings.clone();
            settings.pen.hair_colour = colour(self.at - self.middle);
            scene.out.push(Event::Settings(settings.into()));
        }
        Outcome::Nothing
    }
    fn paint(&self, painter: &Painter, scene: &Scene) {
        paint(painter, scene, self.middle, Some(self.at));
    }
}

/// The colour at a place off the wheel's middle; none where it is the hair's own.
pub(super) fn colour(off: Vec2) -> Option<[u8; 3]> {
    let far = off.length() / RADIUS;
    if far < NONE {
        return None;
    }
    let colour: Color32 = if far < GROWN {
        let light = (far - NONE) / (GROWN - NONE);
        // Most hair is dark: half of the wheel is what lies between black and brown.
        let melanin = 0.99 - 0.98 * light * light;
        let red = 0.5 + 0.5 * off.x / off.length();
        let grown = colour_of(absorption_of_melanin(melanin, red));
        Rgba::from_rgb(grown.x, grown.y, grown.z).into()
    } else {
        let hue = off.angle() / std::f32::consts::TAU;
        let light = ((far - GROWN) / (1.0 - GROWN)).min(1.0);
        egui::ecolor::Hsva::new(hue.rem_euclid(1.0), 0.85, 0.35 + 0.5 * light, 1.0).into()
    };
    Some([colour.r(), colour.g(), colour.b()])
}

/// Whether there is neither skin nor hair within the pen's reach of a pixel.
pub(super) fn is_free(ground: &ViewedCurves, at: glam::Vec2, rho: f32) -> bool {
    let round = (0..8).map(|k| {
        let (sin, cos) = (std::f32::consts::TAU * k as f32 / 8.0).sin_cos();
        at + glam::Vec2::new(cos, sin) * rho
    });
    std::iter::once(at).chain(round).all(|at| ground.skin(at).is_none()) && !ground.hair(at)
}

/// The wheel, with the colour in hand and the one under the pen.
pub(super) fn paint(painter: &Painter, scene: &Scene, middle: Pos2, pen: Option<Pos2>) {
    let strength = if pen.is_some() { 1.0 } else { 0.35 };
    let mut mesh = Mesh::default();
    let ring = |k: usize| NONE + (1.0 - NONE) * k as f32 / RINGS as f32;
    for k in 0..RINGS {
        for spoke in 0..SPOKES {
            let way = |s: usize| Vec2::angled(std::f32::consts::TAU * s as f32 / SPOKES as f32);
            let first = mesh.vertices.len() as u32;
            // A hair's breadth inside the ring, so that each keeps its side of a border.
            for (far, s) in [
                (ring(k) + 1e-3, spoke),
                (ring(k + 1) - 1e-3, spoke),
                (ring(k + 1) - 1e-3, spoke + 1),
                (ring(k) + 1e-3, spoke + 1),
            ] {
                let off = way(s) * (far * RADIUS);
                let [r, g, b] = colour(off).unwrap_or_default();
                let shade = Color32::from_rgb(r, g, b).gamma_multiply(strength);
                mesh.colored_vertex(middle + off, shade);
            }
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first, first + 2, first + 3);
        }
    }
    painter.add(Shape::mesh(mesh));
    let settings = &scene.state.settings.pen;
    let now = pen.map_or(settings.hair_colour, |pen| colour(pen - middle));
    let edge = Stroke::new(1.0, EDGE.gamma_multiply(strength));
    painter.circle_stroke(middle, RADIUS, edge);
    let now = now.map(|[r, g, b]| Color32::from_rgb(r, g, b).gamma_multiply(strength));
    painter.circle(middle, RADIUS * NONE, now.unwrap_or(Color32::TRANSPARENT), edge);
    if let Some(pen) = pen {
        painter.circle_stroke(pen, 5.0, Stroke::new(3.0, EDGE));
        painter.circle_stroke(pen, 5.0, Stroke::new(1.5, Color32::WHITE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wheel_goes_from_no_colour_over_hair_to_dyes() {
        assert_eq!(colour(Vec2::ZERO), None);
        let at = |far: f32, turn: f32| {
            colour(Vec2::angled(turn * std::f32::consts::TAU) * (far * RADIUS)).expect("a colour")
        };
        let sum = |c: [u8; 3]| c.iter().map(|c| i32::from(*c)).sum::<i32>();
        // Black, brown, blond; red to the right.
        assert!(sum(at(0.15, 0.5)) < 60, "{:?}", at(0.15, 0.5));
        assert!(sum(at(0.7, 0.5)) > 320, "{:?}", at(0.7, 0.5));
        let warm = |c: [u8; 3]| i32::from(c[0]) - i32::from(c[2]);
        assert!(warm(at(0.6, 0.0)) > warm(at(0.6, 0.5)) + 5);
        // Dyes of every hue.
        assert!(at(0.95, 1.0 / 3.0)[1] > 150 && at(0.95, 2.0 / 3.0)[2] > 150);
        // Beyond the edge as at the edge.
        assert_eq!(at(1.0, 0.3), at(3.0, 0.3));
    }
}
