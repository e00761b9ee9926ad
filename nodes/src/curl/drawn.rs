//! Drawn profiles: curves in space converted to closed shapes in a plane.
//!
//! A curve is projected along the normal of the area that it encloses (Newell's method), so that a shape drawn on any
//! wall, and not quite flat, keeps its form; a turn begins in the direction from its centre to its first point. Curves
//! that enclose no area are dropped and counted.

use crate::data::curves::Curves;
use crate::data::shapes::{ShapeList, Tier, TurnProfile};
use crate::eval::EvalCx;
use crate::maths::spline::Spline;
use glam::{Vec2, Vec3};

/// Points of a drawn profile; a shape list takes up to 256.
const POINTS: usize = 96;

/// `shapes` with the profiles of `drawn` in place of those of `tier`; unchanged if no drawn curve is usable.
pub(crate) fn with_drawn(cx: &EvalCx, shapes: &ShapeList, drawn: &Curves, tier: Tier) -> ShapeList {
    let mut found = vec![];
    for (tuft, i) in drawn.each() {
        match section(tuft.curve(i)) {
            Some(section) => found.push((tier, section)),
            None => {
                cx.trouble(tuft.id(i), "a drawn cross-section that encloses nothing was left out")
            }
        }
    }
    if found.is_empty() {
        return shapes.clone();
    }
    let others = shapes.0.iter().filter(|(of, _)| *of != tier).cloned();
    ShapeList(others.chain(found).collect())
}

/// The flat, closed profile of a curve in space.
fn section(points: &[Vec3]) -> Option<TurnProfile> {
    let closed = points.len() > 3 && points[0].distance(points[points.len() - 1]) < 1e-4;
    let open = if closed { &points[..points.len() - 1] } else { points };
    let mut points = open.to_vec();
    if points.len() > POINTS {
        let spline = Spline::new(open).ok()?;
        points.clear();
        spline.resample(POINTS, |p| points.push(p));
    }
    let n = points.len();
    if n < 3 {
        return None;
    }
    let middle = points.iter().sum::<Vec3>() / n as f32;
    let around = |i: usize| (points[i] - middle).cross(points[(i + 1) % n] - middle);
    let area: Vec3 = (0..n).map(around).sum();
    let size = points.iter().map(|p| p.distance_squared(middle)).sum::<f32>() / n as f32;
    // Less than a thousandth of its square: a line back and forth.
    if !(area.is_finite() && area.length() > 1e-3 * size) {
        return None;
    }
    let normal = area.normalize();
    let x = (points[0] - middle).reject_from_normalized(normal).try_normalize()?;
    let y = normal.cross(x);
    let scale = 1.0 / size.sqrt();
    let flat = |p: &Vec3| Vec2::new((*p - middle).dot(x), (*p - middle).dot(y)) * scale;
    Some(TurnProfile::Custom(points.iter().map(flat).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::transcendental::sin_cos_turns;

    #[test]
    fn a_shape_drawn_anywhere_and_of_any_size_is_the_shape() {
        let check = |at: Vec3, x: Vec3, y: Vec3, closed: bool| {
            let point = |k: usize| {
                let (sin, cos) = sin_cos_turns(k as f32 / 24.0);
                at + x * cos * 2.0 + y * sin
            };
            let points: Vec<Vec3> = (0..24 + usize::from(closed)).map(point).collect();
            let Some(TurnProfile::Custom(flat)) = section(&points) else { panic!("{at} {x} {y}") };
            assert_eq!(flat.len(), 24);
            let rms = (flat.iter().map(|p| p.length_squared()).sum::<f32>() / 24.0).sqrt();
            assert!((rms - 1.0).abs() < 1e-4, "{rms}");
            let (a, b) = (flat[0].length(), flat[6].length());
            assert!((a / b - 2.0).abs() < 1e-3 && flat[0].y.abs() < 1e-4, "{a} {b}");
        };
        check(Vec3::ZERO, Vec3::X, Vec3::Y, false);
        check(Vec3::new(3.0, -8.0, 2.0), Vec3::Y * 0.1, Vec3::Z * 0.1, true);
        check(Vec3::ONE, Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.8, 0.6, 0.0) * -1.0, true);
        assert_eq!(section(&[Vec3::ZERO, Vec3::X, Vec3::ZERO, Vec3::X]), None);
        assert_eq!(section(&[Vec3::ZERO, Vec3::X]), None);
    }
}
