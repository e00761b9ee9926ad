//! The two readings of a curve: other tools take `catmullRom` as uniform, coif means centripetal (methods.md 0). Where CVs are
//! even, or the curve is straight, both are the same hair.
//!
//! Guarantees: a difference of more than [`AGREE`] is found as it is to a tenth; less than that is not found less than it is.
//! Where points are so even that there can be none, none is looked for.

use glam::Vec3;

/// The largest distance between the two readings of a curve that is let pass, cm (methods.md 0).
pub const AGREE: f32 = 1e-3;

/// How even the points of a curve are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chords {
    /// The largest ratio of neighbouring chords, 1 or more.
    pub ratio: f32,
    /// The longest chord, cm.
    pub longest: f32,
}

impl Chords {
    /// Of the curve whose `n` points `at` gives.
    #[inline]
    pub fn of(n: usize, at: impl Fn(usize) -> Vec3) -> Self {
        let square = |k: usize| at(k).distance_squared(at(k + 1));
        let mut before = if n > 1 { square(0) } else { 0.0 };
        let (mut ratio, mut longest) = (1.0f32, before);
        for k in 1..n.max(2) - 1 {
            let here = square(k);
            ratio = ratio.max(here.max(before) / here.min(before).max(1e-12));
            longest = longest.max(here);
            before = here;
        }
        Self { ratio: ratio.sqrt(), longest: longest.sqrt() }
    }

    /// What the two readings differ by at most, cm, however the curve bends: with `r` the ratio of knots, roots of chords, their
    /// tangents at a point differ by at most `r` - 1 of the longer chord there, and 4/27 of that is the most it counts.
    pub fn readings_differ_at_most(&self) -> f32 {
        2.0 * (4.0 / 27.0) * self.longest * (self.ratio.sqrt() - 1.0)
    }
}

/// The largest distance, cm, between the uniform and the centripetal Catmull-Rom spline through the points: the two have the
/// same ends in each span and differ in their tangents there. Sliding along the curve counts nothing.
pub fn readings_differ(points: &[Vec3]) -> f32 {
    let at_most = Chords::of(points.len(), |k| points[k]).readings_differ_at_most();
    if at_most <= AGREE {
        return at_most;
    }
    let mut worst = 0.0f32;
    each_span(points, |_, difference| worst = worst.max(difference));
    worst
}

/// [`readings_differ`] of each span; where it is no more than [`AGREE`], not less than it is.
pub fn each_span(points: &[Vec3], mut found: impl FnMut(usize, f32)) {
    let n = points.len();
    let knot = |i: usize| points[i].distance(points[i + 1]).sqrt();
    // Tangents at the inner point `i`, whose segments have the knots `a` and `b`: per unit of the centripetal
    // parameter, and of the uniform one.
    let tangents = |i: usize, a: f32, b: f32| -> (Vec3, Vec3) {
        let (p0, p1, p2) = (points[i - 1], points[i], points[i + 1]);
        let centripetal = if a > 0.0 && b > 0.0 {
            (p1 - p0) / a - (p2 - p0) / (a + b) + (p2 - p1) / b
        } else {
            Vec3::ZERO
        };
        (centripetal, (p2 - p0) * 0.5)
    };
    let mut before = None;
    let mut d = if n > 1 { knot(0) } else { 0.0 };
    for i in 0..n.saturating_sub(1) {
        let next = if i + 2 < n { knot(i + 1) } else { 0.0 };
        let after = (i + 2 < n).then(|| tangents(i + 1, d, next));
        let delta = |t: Option<(Vec3, Vec3)>| t.map_or(Vec3::ZERO, |(c, u)| c * d - u);
        let (d1, d2) = (delta(before), delta(after));
        // 4/27 is the largest value of either Hermite basis.
        let bound = (d1.length() + d2.length()) * (4.0 / 27.0);
        if bound > AGREE && d > 0.0 {
            let chord = points[i + 1] - points[i];
            let (m1, m2) = (before.map_or(chord, |(_, u)| u), after.map_or(chord, |(_, u)| u));
            let mut worst = 0.0f32;
            for t in [0.2f32, 0.4, 0.6, 0.8] {
                let gap = d1 * (t * (1.0 - t) * (1.0 - t)) - d2 * (t * t * (1.0 - t));
                let along = chord * (6.0 * t * (1.0 - t))
                    + m1 * (1.0 - 4.0 * t + 3.0 * t * t)
                    + m2 * (3.0 * t * t - 2.0 * t);
                let slide = along * (gap.dot(along) / along.length_squared().max(1e-20));
                worst = worst.max((gap - slide).length());
            }
            found(i, worst);
        } else {
            found(i, bound.min(AGREE));
        }
        (before, d) = (after, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    #[test]
    fn readings_differ_by_no_more_than_chords_say() {
        let dice = Dice::new(4, 0, "points");
        let (mut near, mut sure) = (0.0f32, 0);
        for id in 0..4000 {
            // Chords of 0.3 cm, uneven by up to a fifth, with any bends.
            let uneven = 0.2 * dice.unit(id, 0) * dice.unit(id, 0);
            let mut points = vec![Vec3::ZERO];
            for k in 1..8 {
                let v = [0, 1, 2].map(|axis| dice.signed(id, 10 * k + axis));
                let chord = 0.3 * (1.0 + uneven * dice.signed(id, 10 * k + 3));
                points.push(points[k as usize - 1] + Vec3::from(v).normalize_or(Vec3::X) * chord);
            }
            let most = Chords::of(points.len(), |k| points[k]).readings_differ_at_most();
            let mut worst = 0.0f32;
            each_span(&points, |_, difference| worst = worst.max(difference));
            assert!(worst <= most.max(AGREE), "{id}: {worst} {most}");
            if most > AGREE {
                near = near.max(worst / most);
                assert_eq!(readings_differ(&points), worst);
            } else {
                sure += 1;
                assert!(worst <= most * 1.001 + 1e-6, "{id}: {worst} {most}");
                assert_eq!(readings_differ(&points), most);
            }
        }
        assert!(near > 0.5 && sure > 200, "{near} {sure}");
    }
}
