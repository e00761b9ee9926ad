//! The two readings of a curve: other tools take `catmullRom` as uniform, coif means centripetal (methods.md 0). Where CVs are
//! even, or the curve is straight, both are the same hair.
//!
//! Guarantees: a difference of more than [`AGREE`] is found as it is to a tenth; less than that is not found less than it is.
//! Where points are so even that there can be none, none is looked for. Not promised: anything of points that repeat or are not finite.

use glam::Vec3;

/// The largest distance between the two readings of a curve that is let pass, cm (methods.md 0).
pub const AGREE: f32 = 1e-3;

/// How even the points of a curve are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chords {
    /// The largest ratio of neighbouring chords, 1 or more.
    pub ratio: f32,
    /// The largest difference of neighbouring chords, cm.
    pub step: f32,
}

impl Chords {
    /// Of a curve whose chords (cm) these are, in turn.
    #[inline]
    pub fn of(chords: impl Iterator<Item = f32>) -> Self {
        let (mut ratio, mut step) = (1.0f32, 0.0f32);
        let mut before = None;
        for here in chords {
            let last = before.replace(here).unwrap_or(here);
            ratio = ratio.max(here.max(last) / here.min(last).max(1e-6));
            step = step.max((here - last).abs());
        }
        Self { ratio, step }
    }

    /// What the two readings differ by at most, cm, however the curve bends.
    pub fn readings_differ_at_most(&self) -> f32 {
        (self.step + self.step) * OF_STEP
    }
}

/// How much of the difference of the two chords at a point the readings of a span there differ by at most. With knots a and b,
/// roots of the chords v and w, the span's own being b, its centripetal tangent less its uniform one is
/// v (b² / (a (a + b)) - 1/2) + w (a / (a + b) - 1/2), which is no longer than half of the difference of a² and b²; and 4/27 is the
/// largest value of a Hermite basis.
const OF_STEP: f32 = 0.5 * (4.0 / 27.0);

/// The largest distance, cm, between the uniform and the centripetal Catmull-Rom spline through the points: the two have the
/// same ends in each span and differ in their tangents there. Sliding along the curve counts nothing.
pub fn readings_differ(points: &[Vec3]) -> f32 {
    let mut worst = 0.0f32;
    each_span(points, |_, difference| worst = worst.max(difference));
    worst
}

/// [`readings_differ`] where it is no more than [`AGREE`]; none where it is more, which the first such span tells.
pub fn readings_agree(points: &[Vec3]) -> Option<f32> {
    let mut worst = 0.0f32;
    let differs = any_span(points, |_, difference| {
        worst = worst.max(difference);
        difference > AGREE
    });
    (!differs).then_some(worst)
}

/// [`readings_differ`] of each span; where it is no more than [`AGREE`], not less than it is.
pub fn each_span(points: &[Vec3], mut found: impl FnMut(usize, f32)) {
    any_span(points, |i, difference| {
        found(i, difference);
        false
    });
}

/// Whether any span `is_one`, told as [`each_span`] tells them; those behind the first are not looked at.
#[inline]
fn any_span(points: &[Vec3], mut is_one: impl FnMut(usize, f32) -> bool) -> bool {
    let n = points.len();
    let chord = |i: usize| points[i].distance(points[i + 1]);
    let mut here = if n > 1 { chord(0) } else { 0.0 };
    let mut before = None;
    for i in 0..n.saturating_sub(1) {
        let after = (i + 2 < n).then(|| chord(i + 1));
        let step = |other: Option<f32>| other.map_or(0.0, |other: f32| (other - here).abs());
        let bound = (step(before) + step(after)) * OF_STEP;
        // Most spans of most curves.
        let difference = if bound <= AGREE || here == 0.0 {
            bound.min(AGREE)
        } else {
            span_differs(points, i, (before, here, after))
        };
        if is_one(i, difference) {
            return true;
        }
        (before, here) = (Some(here), after.unwrap_or(0.0));
    }
    false
}

/// [`readings_differ`] of the span from the point `i` on, whose chord is `here`, those beside it `before` and `after`.
fn span_differs(
    points: &[Vec3],
    i: usize,
    (before, here, after): (Option<f32>, f32, Option<f32>),
) -> f32 {
    let knot = here.sqrt();
    // At the inner point `j`, between the knots `a` and `b`: the uniform tangent, and how much the centripetal one differs.
    let tangents = |j: usize, a: f32, b: f32| {
        let (p0, p1, p2) = (points[j - 1], points[j], points[j + 1]);
        let centripetal = if a > 0.0 && b > 0.0 {
            (p1 - p0) / a - (p2 - p0) / (a + b) + (p2 - p1) / b
        } else {
            Vec3::ZERO
        };
        let uniform = (p2 - p0) * 0.5;
        (uniform, centripetal * knot - uniform)
    };
    let chord = points[i + 1] - points[i];
    let (m1, d1) = before.map_or((chord, Vec3::ZERO), |a| tangents(i, a.sqrt(), knot));
    let (m2, d2) = after.map_or((chord, Vec3::ZERO), |b| tangents(i + 1, knot, b.sqrt()));
    let bound = (d1.length() + d2.length()) * (4.0 / 27.0);
    if bound <= AGREE {
        return bound;
    }
    // Four places side by side, which compilers take at once.
    const AT: [f32; 4] = [0.2, 0.4, 0.6, 0.8];
    let (mut gap, mut along) = ([[0.0f32; 4]; 3], [[0.0f32; 4]; 3]);
    for axis in 0..3 {
        let (d1, d2, m1, m2, chord) = (d1[axis], d2[axis], m1[axis], m2[axis], chord[axis]);
        for (i, t) in AT.into_iter().enumerate() {
            gap[axis][i] = d1 * (t * (1.0 - t) * (1.0 - t)) - d2 * (t * t * (1.0 - t));
            along[axis][i] = chord * (6.0 * t * (1.0 - t))
                + m1 * (1.0 - 4.0 * t + 3.0 * t * t)
                + m2 * (3.0 * t * t - 2.0 * t);
        }
    }
    let mut worst = 0.0f32;
    let ([gx, gy, gz], [ax, ay, az]) = (gap, along);
    let mut squares = [0.0f32; 4];
    for i in 0..4 {
        let dot = gx[i] * ax[i] + gy[i] * ay[i] + gz[i] * az[i];
        let square = ax[i] * ax[i] + ay[i] * ay[i] + az[i] * az[i];
        let slide = dot / square.max(1e-20);
        let [x, y, z] = [gx[i] - ax[i] * slide, gy[i] - ay[i] * slide, gz[i] - az[i] * slide];
        squares[i] = (x * x + y * y + z * z).sqrt();
    }
    for difference in squares {
        worst = worst.max(difference);
    }
    worst
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
            let chords = points.windows(2).map(|w| w[0].distance(w[1]));
            let most = Chords::of(chords).readings_differ_at_most();
            let whole = |i: usize| {
                let chord = |i: usize| points[i].distance(points[i + 1]);
                let before = (i > 0).then(|| chord(i - 1));
                span_differs(&points, i, (before, chord(i), (i + 2 < 8).then(|| chord(i + 1))))
            };
            each_span(&points, |i, difference| {
                let exact = whole(i);
                assert!(difference >= exact * 0.999 - 1e-6, "{id}: {difference} {exact}");
                if exact > AGREE {
                    assert_eq!(difference, exact);
                    near = near.max(exact / most);
                } else {
                    assert!(difference <= AGREE, "{id}: {difference} {exact}");
                    sure += usize::from(difference > exact);
                }
            });
            let worst = readings_differ(&points);
            assert_eq!(readings_agree(&points), (worst <= AGREE).then_some(worst));
            assert!(worst <= most.max(AGREE) * 1.001, "{id}: {worst} {most}");
        }
        assert!(near > 0.5 && sure > 200, "{near} {sure}");
    }
}
