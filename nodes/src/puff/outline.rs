//! Outlines of puffs: how far hair reaches in each direction from the puff's centre.
//!
//! Directions are local to the puff: x to its right, y along its axis, z forward. Guarantees: never less than a
//! hundredth of the sphere's radius, finite, constant for the sphere. Drawn outlines are matched exactly in front and
//! side view if they go around the centre once; in between, the cross-section is part of an ellipse.

use crate::data::curves::Curves;
use crate::maths::closest::Surface;
use crate::maths::transcendental::{acos, atan2};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Directions in which a drawn outline is tabulated.
const AROUND: usize = 720;

/// The outline of one puff.
pub(crate) enum PuffOutline<'a> {
    Sphere,
    /// Half axes in radii.
    Ellipsoid(Vec3),
    /// A closed mesh, seen from a point inside with these axes (right, up, forward).
    Mesh(&'a Surface, Vec3, [Vec3; 3]),
    /// Radii in cm by angle from the axis, all around, in front view and in side view.
    Drawn(Vec<f32>, Vec<f32>),
}

impl PuffOutline<'_> {
    /// Distance from the centre in a local unit direction, for a sphere of this radius.
    pub(crate) fn reach(&self, d: Vec3, radius: f32) -> f32 {
        let reach = match self {
            PuffOutline::Sphere => return radius,
            PuffOutline::Ellipsoid(half) => {
                radius / (d / half.max(Vec3::splat(0.01))).length().max(1e-6)
            }
            PuffOutline::Mesh(surface, centre, [right, up, ahead]) => {
                let out = *right * d.x + *up * d.y + *ahead * d.z;
                let (low, high) = surface.bounds();
                let far = low.distance(high) + centre.distance(0.5 * (low + high));
                // The outermost wall: the ray runs from outside in.
                let hit = surface.ray(*centre + out * far, -out * far, 1.0);
                hit.map_or(radius, |hit| hit.point.distance(*centre))
            }
            PuffOutline::Drawn(front, side) => {
                let polar = acos(d.y) / TAU;
                let f = read(front, if d.x < 0.0 { 1.0 - polar } else { polar });
                let s = read(side, if d.z < 0.0 { 1.0 - polar } else { polar });
                let across = Vec2::new(d.x, d.z).normalize_or(Vec2::X);
                1.0 / Vec2::new(across.x / f, across.y / s).length().max(1e-6)
            }
        };
        let reach = if reach.is_finite() { reach } else { radius };
        reach.max(0.01 * radius)
    }

    /// A drawn outline as radii by angle: the outermost crossing in each direction; `radius` where there is none.
    /// `flat` returns a point's position in the plane (across, along the axis) from the centre.
    pub(crate) fn drawn(lines: &Curves, radius: f32, flat: impl Fn(Vec3) -> Vec2) -> Vec<f32> {
        let mut out = vec![0.0f32; AROUND];
        for (tuft, i) in lines.each() {
            let points: Vec<Vec2> = tuft.curve(i).iter().map(|p| flat(*p)).collect();
            let finite = points.iter().all(|p| p.is_finite());
            // A stroke is closed by its last segment.
            let next = points.iter().cycle().skip(1);
            for (a, b) in points.iter().zip(next).filter(|_| finite && points.len() >= 3) {
                // Both as angles from the axis: 0 along it, a quarter turn to the side.
                let turn = |p: &Vec2| (atan2(p.x, p.y) / TAU).rem_euclid(1.0);
                let from = turn(a);
                let by = turn(b) - from;
                let by = by - by.round();
                let (first, last) = (from.min(from + by), from.max(from + by));
                let bins = (first * AROUND as f32).ceil() as i64..=(last * AROUND as f32) as i64;
                for bin in bins {
                    let angle = bin as f32 / AROUND as f32 * TAU;
                    let (s, c) = crate::maths::transcendental::sin_cos(angle);
                    let way = Vec2::new(s, c);
                    let (ab, across) = (*b - *a, Vec2::new(c, -s));
                    let along = ab.dot(across);
                    let t = if along.abs() > 1e-9 { -a.dot(across) / along } else { 0.0 };
                    let far = (*a + ab * t.clamp(0.0, 1.0)).dot(way);
                    let slot = &mut out[bin.rem_euclid(AROUND as i64) as usize];
                    *slot = slot.max(far);
                }
            }
        }
        out.iter_mut().filter(|r| **r <= 0.0).for_each(|r| *r = radius);
        out
    }
}

/// The interpolated radius at an angle.
fn read(radii: &[f32], turn: f32) -> f32 {
    let x = turn.rem_euclid(1.0) * AROUND as f32;
    let (k, f) = (x as usize % AROUND, x.fract());
    let (a, b) = (radii.get(k).copied().unwrap_or(1.0), radii.get((k + 1) % AROUND).copied());
    a + (b.unwrap_or(a) - a) * f
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::curves::TuftBuilder;
    use crate::maths::transcendental::sin_cos_turns;

    #[test]
    fn a_drawn_outline_is_met_from_front_and_side() {
        // An egg from the front, a circle of 4 from the side.
        let ring = |of: &dyn Fn(f32, f32) -> Vec3| {
            let mut b = TuftBuilder::new();
            let points: Vec<Vec3> = (0..200)
                .map(|k| {
                    let (s, c) = sin_cos_turns(k as f32 / 200.0);
                    of(s, c)
                })
                .collect();
            b.push_curve(&points);
            Curves::new(vec![b.build().into()])
        };
        let egg = ring(&|s, c| Vec3::new(5.0 * s, 6.0 * c, 0.0));
        let circle = ring(&|s, c| Vec3::new(0.0, 4.0 * c, 4.0 * s));
        let front = PuffOutline::drawn(&egg, 1.0, |p| Vec2::new(p.x, p.y));
        let side = PuffOutline::drawn(&circle, 1.0, |p| Vec2::new(p.z, p.y));
        let drawn = PuffOutline::Drawn(front, side);
        for (d, wanted) in [(Vec3::X, 5.0), (Vec3::NEG_X, 5.0), (Vec3::Z, 4.0), (Vec3::NEG_Z, 4.0)]
        {
            assert!((drawn.reach(d, 1.0) - wanted).abs() < 0.02, "{d}: {}", drawn.reach(d, 1.0));
        }
        let aslant = drawn.reach(Vec3::new(1.0, 0.0, 1.0).normalize(), 1.0);
        assert!((4.0..5.0).contains(&aslant), "{aslant}");
        assert!((drawn.reach(Vec3::new(0.6, 0.8, 0.0), 1.0) - 5.57).abs() < 0.05);
    }

    #[test]
    fn an_ellipsoid_has_its_half_axes() {
        let shape = PuffOutline::Ellipsoid(Vec3::new(1.0, 2.0, 0.5));
        assert_eq!(shape.reach(Vec3::Y, 3.0), 6.0);
        assert_eq!(shape.reach(Vec3::Z, 3.0), 1.5);
    }
}
