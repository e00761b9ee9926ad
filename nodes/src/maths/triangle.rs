//! One triangle: the point of it that is closest to another, where a ray meets it, and its halves.
//!
//! Guarantees: eight points get the bits that each gets alone, on any triangle, without area too. Not promised: anything exact where
//! products of coordinates overflow.

use super::lanes::{Simd, Vec3x8, f32x8, ops::*, pick};
use glam::{Vec2, Vec3};

/// A box is mostly empty if it has more than this multiple of its triangle's area on three faces; equilateral triangles have at most 5.
const AIRY: f32 = 16.0;

/// Closest point of a triangle (Ericson 2005, "Real-time collision detection", 5.1.5), as the weights of its second and third
/// corner.
#[inline]
pub(crate) fn closest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> (Vec2, Vec3) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (Vec2::ZERO, a);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (Vec2::X, b);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = if d1 > d3 { d1 / (d1 - d3) } else { 0.0 };
        return (Vec2::new(v, 0.0), a + ab * v);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (Vec2::Y, c);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = if d2 > d6 { d2 / (d2 - d6) } else { 0.0 };
        return (Vec2::new(0.0, w), a + ac * w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let sum = (d4 - d3) + (d5 - d6);
        let w = if sum > 0.0 { (d4 - d3) / sum } else { 0.0 };
        return (Vec2::new(1.0 - w, w), b + (c - b) * w);
    }
    let scale = 1.0 / (va + vb + vc);
    if !scale.is_finite() {
        return (Vec2::ZERO, a);
    }
    let (v, w) = (vb * scale, vc * scale);
    (Vec2::new(v, w), a + ab * v + ac * w)
}

/// The squared distances of eight points from what [`closest_on_triangle`] finds, to the bit.
#[inline(always)]
pub(super) fn squares_to_triangle<S: Simd>(p: Vec3x8<S>, [a, b, c]: [Vec3; 3]) -> f32x8<S> {
    let s = p.x.simd;
    let (ab, ac, bc) = (Vec3x8::splat(s, b - a), Vec3x8::splat(s, c - a), Vec3x8::splat(s, c - b));
    let (a, b, c) = (Vec3x8::splat(s, a), Vec3x8::splat(s, b), Vec3x8::splat(s, c));
    let (ap, bp, cp) = (p - a, p - b, p - c);
    let (d1, d2, d3, d4) = (ab.dot(ap), ac.dot(ap), ab.dot(bp), ac.dot(bp));
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    // The first case that holds counts: the last comes first.
    let scale = 1.0 / (va + vb + vc);
    let inside = a + ab * (vb * scale) + ac * (vc * scale);
    let point = Vec3x8::pick(scale.abs().simd_lt(f32::INFINITY), inside, a);
    let (before, after) = (d4 - d3, d5 - d6);
    let is = va.simd_le(0.0) & before.simd_ge(0.0) & after.simd_ge(0.0);
    let point = Vec3x8::pick(is, b + bc * share(before, before + after), point);
    let is = vb.simd_le(0.0) & d2.simd_ge(0.0) & d6.simd_le(0.0);
    let point = Vec3x8::pick(is, a + ac * share(d2, d2 - d6), point);
    let point = Vec3x8::pick(d6.simd_ge(0.0) & d5.simd_le(d6), c, point);
    let is = vc.simd_le(0.0) & d1.simd_ge(0.0) & d3.simd_le(0.0);
    let point = Vec3x8::pick(is, a + ab * share(d1, d1 - d3), point);
    let point = Vec3x8::pick(d3.simd_ge(0.0) & d4.simd_le(d3), b, point);
    let point = Vec3x8::pick(d1.simd_le(0.0) & d2.simd_le(0.0), a, point);
    let off = point - p;
    off.dot(off)
}

/// `part / whole`, 0 where `whole` is not positive.
#[inline(always)]
fn share<S: Simd>(part: f32x8<S>, whole: f32x8<S>) -> f32x8<S> {
    pick(whole.simd_gt(0.0), part / whole, part.simd.splat_f32x8(0.0))
}

/// Moeller and Trumbore 1997, two-sided.
pub(super) fn ray_triangle(
    origin: Vec3,
    direction: Vec3,
    [a, b, c]: [Vec3; 3],
) -> Option<(f32, Vec2)> {
    let (ab, ac) = (b - a, c - a);
    let h = direction.cross(ac);
    let det = ab.dot(h);
    if det == 0.0 {
        return None;
    }
    let s = (origin - a) / det;
    let u = s.dot(h);
    let q = s.cross(ab);
    let v = direction.dot(q);
    let t = ac.dot(q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some((t, Vec2::new(u, v)))
}

/// The triangle, or, if it is a diagonal sliver with a mostly empty box, its pieces: halves across the longest side.
pub(super) fn pieces(corners: [Vec3; 3], halvings: u32, each: &mut impl FnMut([Vec3; 3])) {
    let [a, b, c] = corners;
    if halvings == 0 || !is_airy(corners) {
        return each(corners);
    }
    let long = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
    let k = (0..3).fold(0, |best, k| if long[k] > long[best] { k } else { best });
    let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let middle = 0.5 * a + 0.5 * b;
    pieces([a, middle, c], halvings - 1, each);
    pieces([middle, b, c], halvings - 1, each);
}

/// Whether most of a triangle's box is empty.
pub(super) fn is_airy([a, b, c]: [Vec3; 3]) -> bool {
    let size = a.max(b).max(c) - a.min(b).min(c);
    let sides = size.x * size.y + size.y * size.z + size.z * size.x;
    let area = 0.5 * (b - a).cross(c - a).length();
    sides > AIRY * area
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;
    use crate::maths::lanes::{Eight, InLanes, LANES, in_each_width, in_lanes};

    struct Squares([Vec3; LANES], [Vec3; 3]);

    impl InLanes for Squares {
        type Out = [f32; LANES];
        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Out {
            let columns = [0, 1, 2].map(|axis| Eight(self.0.map(|p| p[axis])));
            s.as_array_f32x8(squares_to_triangle(Vec3x8::load(s, &columns), self.1))
        }
    }

    #[test]
    fn eight_distances_have_the_bits_of_one() {
        let dice = Dice::new(17, 0, "triangles");
        for id in 0..3000 {
            let at = |k: u64, size: f32| {
                Vec3::from([0, 1, 2].map(|axis| size * dice.signed(id, 3 * k + axis)))
            };
            let size = [1.0, 1e-4, 1e-20, 1e4, 1e18][id as usize % 5];
            let (a, b, c) = (at(0, size), at(1, size), at(2, size));
            // Slivers, segments, points, and what lies on a lattice with the points.
            let corners = match id / 5 % 5 {
                0 => [a, b, a + (b - a) * 0.5 + at(3, 1e-6 * size)],
                1 => [a, b, b],
                2 => [a; 3],
                3 => [a, b, c].map(Vec3::round),
                _ => [a, b, c],
            };
            let points = std::array::from_fn(|k| match k {
                0 => corners[0],
                1 => (corners[1] + corners[2]) * 0.5,
                2 => at(9, size).round(),
                k => at(10 + k as u64, 3.0 * size),
            });
            let alone = points.map(|p| closest_on_triangle(p, corners).1.distance_squared(p));
            let bits = |squares: [f32; LANES]| {
                squares.map(|x| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() })
            };
            for together in in_each_width(|| in_lanes(Squares(points, corners))) {
                assert_eq!(bits(together), bits(alone), "{id}: {corners:?}");
            }
        }
    }
}
