//! Numerics: deterministic to the last bit on every machine, each with its source.
//!
//! **Invariant:** no function here calls the system's maths library, fuses a multiply with an add, or
//! depends on thread order.

pub mod box_tree;
mod brick;
pub mod catmull_rom_agreement;
pub mod closest;
pub mod distance_field;
pub mod drawn_span;
pub mod frame;
pub mod hair_colour;
pub mod hash;
pub mod horizon;
pub mod lanes;
pub mod low_discrepancy;
mod mesh_normals;
pub mod nearest;
pub(crate) mod polyline;
pub mod rail;
pub(crate) mod random_walk;
pub mod spline;
pub mod transcendental;
pub(crate) mod triangle;
mod triangle_tree;

use glam::Vec3;

/// The point of a segment that is nearest to `p`, and how far along it that is, 0 to 1.
#[inline]
pub fn nearest_on([a, b]: [Vec3; 2], p: Vec3) -> (Vec3, f32) {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    (a + along * t, t)
}

/// 0 up to 0, 1 from 1 on, and a cubic between them that is flat at both ends (Hermite's, which shading languages call smoothstep).
#[inline]
pub fn smoothstep(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// 0 to 1 across an edge of this width, centred where `inside` (the signed distance, cm) is 0.
pub(crate) fn soft_edge(inside: f32, width: f32) -> f32 {
    if width <= 0.0 {
        return f32::from(inside > 0.0);
    }
    smoothstep(inside / width + 0.5)
}
