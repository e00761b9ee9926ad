//! Clusters as generalised cylinders: a ring of the curve's radius at each of its points, closed by round ends.
//!
//! Guarantees: every vertex lies within the radius of its ring's centre, ends included; frames turn with the attribute
//! `normal` and by the smallest rotation without it; curves without two different points have no tube; at most
//! two million triangles whatever the number of curves, with fewer sides and rings where there are very many.
//! Not promised: that a tube wider than its bend is round does not meet itself.

use super::{Material, Solid};
use crate::view::of_id;
use coif_nodes::data::attributes::{NORMAL, RADIUS};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::maths::frame::{across, any_normal, reflect_twice};
use coif_nodes::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// The most triangles of all tubes.
const MOST_TRIANGLES: usize = 2_000_000;
/// Rings that an end is rounded by, its own ring not counted.
const CAP: usize = 2;

/// Tubes of all curves, each in the colour of its id, which is the colour of its hair when that is shown by cluster.
pub fn tubes(curves: &Curves) -> Solid {
    let mut solid = Solid::empty(Material::Clay);
    let (sides, stride) = economy(curves);
    for (tuft, i) in curves.each() {
        tube(&mut solid, tuft, i, sides, stride);
    }
    solid
}

/// Sides of a ring, and how many points lie from one ring to the next.
fn economy(curves: &Curves) -> (usize, usize) {
    let fits = |sides: usize, stride: usize| {
        let rings = |n: usize| n.div_ceil(stride) + 1 + 2 * CAP;
        let all: usize = curves.each().map(|(t, i)| rings(t.range(i).len()) * sides * 2).sum();
        all <= MOST_TRIANGLES
    };
    for (sides, stride) in [(12, 1), (8, 1), (6, 1), (6, 2), (5, 4), (4, 8), (3, 16)] {
        if fits(sides, stride) {
            return (sides, stride);
        }
    }
    (3, usize::MAX)
}

/// A ring of a tube.
struct Ring {
    centre: Vec3,
    radius: f32,
    /// Across the curve; unit and at right angles.
    normal: Vec3,
    binormal: Vec3,
    /// A vertex's normal is `radial` times its direction from the centre, and this.
    radial: f32,
    along: Vec3,
}

fn tube(solid: &mut Solid, tuft: &Tuft, i: usize, sides: usize, stride: usize) {
    let curve = tuft.curve(i);
    let start = tuft.range(i).start;
    let last = curve.len().saturating_sub(1);
    let (radius, wanted) = (tuft.view(RADIUS), tuft.view(NORMAL));
    // Points that lie on the one before have no direction and no ring.
    let mut spine: Vec<(Vec3, f32, Vec3)> = vec![];
    for k in (0..=last).filter(|k| k % stride == 0 || *k == last) {
        let Some(p) = curve.get(k).filter(|p| p.is_finite()) else { continue };
        let r = radius.at(i, start + k);
        let r = if r.is_finite() { r.max(0.0) } else { 0.0 };
        if spine.last().is_none_or(|(q, ..)| q.distance(*p) > 1e-5) {
            spine.push((*p, r, wanted.at(i, start + k)));
        }
    }
    let n = spine.len();
    let triangles = (n + 2 * CAP) * sides * 2;
    if n < 2
        || spine.iter().all(|(_, r, _)| *r <= 0.0)
        || solid.triangles.len() + triangles > MOST_TRIANGLES
    {
        return;
    }
    let mut rings: Vec<Ring> = Vec::with_capacity(n + 2 * CAP);
    let mut before = direction(&spine, 0);
    let mut normal = any_normal(before);
    for (k, (centre, r, wish)) in spine.iter().copied().enumerate() {
        let tangent = direction(&spine, k);
        if k > 0 {
            normal = reflect_twice(normal, centre - spine[k - 1].0, before, tangent);
        }
        before = tangent;
        if let Some(told) = wish.try_normalize().and_then(|w| across(w, tangent)) {
            normal = told;
        }
        let binormal = tangent.cross(normal);
        // An end is half as deep as wide: round to the eye, and it does not reach far past the curve.
        let cap = |step: usize, out: Vec3| {
            let (wide, far) = sin_cos_turns(step as f32 / (4 * CAP) as f32);
            Ring {
                centre: centre + out * (0.5 * r * far),
                radius: r * wide,
                normal,
                binormal,
                radial: 0.5 * wide,
                along: out * far,
            }
        };
        if k == 0 {
            rings.extend((0..CAP).map(|step| cap(step, -tangent)));
        }
        // How the radius grows along the curve tilts the surface.
        let (a, b) = (spine[k.saturating_sub(1)], spine[(k + 1).min(n - 1)]);
        let slope = (b.1 - a.1) / a.0.distance(b.0).max(1e-6);
        rings.push(Ring {
            centre,
            radius: r,
            normal,
            binormal,
            radial: 1.0,
            along: tangent * -slope,
        });
        if k + 1 == n {
            rings.extend((0..CAP).rev().map(|step| cap(step, tangent)));
        }
    }
    let colour = of_id(tuft.id(i));
    let first = solid.points.len() as u32;
    for ring in &rings {
        for side in 0..sides {
            let (sin, cos) = sin_cos_turns(side as f32 / sides as f32);
            let out = ring.normal * cos + ring.binormal * sin;
            let normal = (out * ring.radial + ring.along).normalize_or(out);
            solid.push(ring.centre + out * ring.radius, normal, colour);
        }
    }
    let sides = sides as u32;
    for ring in 1..rings.len() as u32 {
        for side in 0..sides {
            let at = |ring: u32, side: u32| first + ring * sides + side % sides;
            let [a, b] = [at(ring - 1, side), at(ring - 1, side + 1)];
            let [c, d] = [at(ring, side), at(ring, side + 1)];
            solid.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
}

/// The mean of the directions before and after point `k`, so that long segments do not count more.
fn direction(spine: &[(Vec3, f32, Vec3)], k: usize) -> Vec3 {
    let to = |a: usize, b: usize| (spine[b].0 - spine[a].0).normalize_or_zero();
    let before = to(k.saturating_sub(1), k);
    let after = to(k, (k + 1).min(spine.len() - 1));
    (before + after).try_normalize().unwrap_or(if k == 0 { after } else { before })
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::{Domain, ID};
    use coif_nodes::data::curves::TuftBuilder;
    use std::sync::Arc;

    fn curves(list: &[(Vec<Vec3>, f32)]) -> Curves {
        let mut b = TuftBuilder::new();
        list.iter().for_each(|(points, _)| b.push_curve(points));
        b.set(ID, Domain::Curve, (1..=list.len() as u64).collect());
        b.set(RADIUS, Domain::Curve, list.iter().map(|(_, r)| *r).collect());
        Curves::new(vec![Arc::new(b.build())])
    }

    fn bent(n: usize) -> Vec<Vec3> {
        let at = |k: usize| {
            let t = k as f32 / n as f32;
            Vec3::new((3.0 * t).sin() * 4.0, t * 9.0, (2.0 * t).cos() * 5.0)
        };
        (0..n).map(at).collect()
    }

    #[test]
    fn a_tube_keeps_to_its_radius_and_looks_outwards() {
        let solid = tubes(&curves(&[(bent(20), 0.6)]));
        assert_eq!(solid.triangles.len(), (20 + 2 * CAP - 1) * 12 * 2);
        let spine = bent(20);
        for (p, n) in solid.points.iter().zip(&solid.normals) {
            let d = spine.iter().map(|q| q.distance(*p)).fold(f32::MAX, f32::min);
            assert!(d < 0.6 + 1e-4, "{p}: {d}");
            assert!((n.length() - 1.0).abs() < 1e-4);
        }
        let (mut volume, mut inwards) = (0.0, 0);
        for t in &solid.triangles {
            let [a, b, c] = t.map(|v| solid.points[v as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            let flat = (b - a).cross(c - a);
            let smooth: Vec3 = t.iter().map(|v| solid.normals[*v as usize]).sum();
            inwards += usize::from(flat.dot(smooth) < 0.0);
        }
        assert_eq!(inwards, 0);
        // A dozen sides have 3 / pi of the circle's area.
        let length: f32 = spine.windows(2).map(|p| p[0].distance(p[1])).sum();
        let want = 3.0 * 0.36 * length;
        assert!((volume / want - 1.0).abs() < 0.06, "{volume} {want}");
    }

    #[test]
    fn curves_without_a_tube_have_none() {
        for points in
            [vec![], vec![Vec3::ONE], vec![Vec3::ONE; 5], vec![Vec3::ZERO, Vec3::splat(f32::NAN)]]
        {
            let solid = tubes(&curves(&[(points.clone(), 1.0)]));
            assert!(solid.triangles.is_empty(), "{points:?}");
        }
        assert!(tubes(&curves(&[(bent(9), 0.0)])).triangles.is_empty());
        assert!(tubes(&curves(&[(bent(9), f32::NAN)])).triangles.is_empty());
        assert_eq!(tubes(&Curves::default()), Solid::empty(Material::Clay));
        // A point that is repeated, a fold and two points are fine.
        for points in [
            vec![Vec3::ZERO, Vec3::Y, Vec3::Y, Vec3::Y * 2.0],
            vec![Vec3::ZERO, Vec3::Y, Vec3::ZERO],
            vec![Vec3::ZERO, Vec3::X],
        ] {
            let solid = tubes(&curves(&[(points, 0.5)]));
            assert!(!solid.triangles.is_empty());
            assert!(solid.points.iter().chain(&solid.normals).all(|p| p.is_finite()));
        }
    }

    #[test]
    fn very_many_curves_share_a_bound() {
        let list: Vec<(Vec<Vec3>, f32)> = (0..4_000).map(|_| (bent(64), 0.1)).collect();
        let solid = tubes(&curves(&list));
        assert!((500_000..=MOST_TRIANGLES).contains(&solid.triangles.len()));
        let most = solid.triangles.iter().flatten().max().unwrap();
        assert!((*most as usize) < solid.points.len());
    }

    #[test]
    fn a_tube_has_the_colour_of_its_hair() {
        let solid = tubes(&curves(&[(bent(5), 0.5), (bent(5), 0.2)]));
        assert_eq!(solid.colours[0], of_id(1));
        assert_eq!(*solid.colours.last().unwrap(), of_id(2));
    }
}
