//! Two orthogonal families of curves on a sphere of directions: lines from one pole to another, and rings around the
//! poles.
//!
//! The sphere is projected stereographically from the second pole, so that the first pole is at the origin and the
//! second at infinity: lines between the poles become rays, rings become circles. The poles need not be opposite each
//! other, which is how rows of braids fan out over a head and converge at the neck.

use crate::maths::transcendental::{atan2, exp, ln, sin_cos};
use glam::{Vec2, Vec3};

/// The net between two poles. Directions are in the head frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StereographicGrid {
    /// The pole at infinity, and two directions perpendicular to it.
    to: Vec3,
    axes: [Vec3; 2],
    /// Position of the other pole on the plane.
    from: Vec2,
    zero: f32,
    sign: f32,
}

impl StereographicGrid {
    /// The net whose lines run from one direction to another. The line through `zero` is number 0; angles grow toward
    /// `plus`.
    pub(crate) fn new(from: Vec3, to: Vec3, zero: Vec3, plus: Vec3) -> Self {
        let to = to.normalize_or(Vec3::NEG_Y);
        let axes = [to.any_orthonormal_vector(), to.cross(to.any_orthonormal_vector())];
        let mut net = Self { to, axes, from: Vec2::ZERO, zero: 0.0, sign: 1.0 };
        net.from = net.plane(from.normalize_or(-to));
        net.zero = net.place(zero).0;
        if net.place(plus).0 < 0.0 {
            net.sign = -1.0;
            net.zero = -net.zero;
        }
        net
    }
    fn plane(&self, d: Vec3) -> Vec2 {
        let d = d.normalize_or(self.to);
        let scale = 1.0 / (1.0 - d.dot(self.to)).max(1e-7);
        Vec2::new(d.dot(self.axes[0]), d.dot(self.axes[1])) * scale
    }
    /// The line of a direction (radians, -pi to pi) and its ring (minus to plus infinity, from pole to pole).
    pub(crate) fn place(&self, d: Vec3) -> (f32, f32) {
        let w = self.plane(d) - self.from;
        let turn = (atan2(w.y, w.x) - self.zero * self.sign) * self.sign;
        (wrapped(turn), ln(w.length().max(1e-9)))
    }
    /// The direction where a line and a ring cross.
    pub(crate) fn at(&self, line: f32, ring: f32) -> Vec3 {
        let (sin, cos) = sin_cos((line + self.zero) * self.sign);
        let q = self.from + Vec2::new(cos, sin) * exp(ring.clamp(-20.0, 20.0));
        let square = q.length_squared();
        let d = (self.axes[0] * q.x + self.axes[1] * q.y) * 2.0 + self.to * (square - 1.0);
        d.normalize_or(self.to)
    }
}

/// An angle within half a turn of 0.
pub(crate) fn wrapped(angle: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    angle - TAU * ((angle + PI) / TAU).floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    #[test]
    fn places_come_back_and_lines_cross_rings_squarely() {
        let dice = Dice::new(1, 0, "net");
        for id in 0..300 {
            let v = |k: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(id, 3 * k + a))).normalize();
            if v(0).dot(v(1)) > 0.8 {
                continue;
            }
            let net = StereographicGrid::new(v(0), v(1), v(2), v(3));
            let (zero, _) = net.place(v(2));
            assert!(zero.abs() < 2e-3, "{zero}");
            assert!(net.place(v(3)).0 > -1e-3);
            let d = v(4);
            let (line, ring) = net.place(d);
            if ring.abs() > 4.0 {
                continue;
            }
            assert!(net.at(line, ring).distance(d) < 1e-3, "{id}: {d} {}", net.at(line, ring));
            let along = net.at(line, ring + 0.02) - net.at(line, ring - 0.02);
            let across = net.at(line + 0.02, ring) - net.at(line - 0.02, ring);
            if along.length().min(across.length()) > 1e-3 {
                assert!(along.normalize().dot(across.normalize()).abs() < 0.02, "{id}");
            }
        }
    }
}
