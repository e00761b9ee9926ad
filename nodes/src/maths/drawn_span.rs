//! The curve that is drawn between two CVs: a span of the uniform Catmull-Rom spline with pinned ends that files say and all readers draw.
//!
//! Guarantees: passes through its two CVs, and lies in the ball that it names. Not promised: coif's own, centripetal reading of a curve
//! (`spline.rs`), which on even CVs is the same hair (`catmull_rom_agreement.rs`).

use glam::Vec3;
use std::borrow::Cow;

/// A span, by the CV before it, its two CVs and the one after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnSpan([Vec3; 4]);

/// How far (cm) a span leaves the straight line before [`bent`] cuts it.
const BENT: f32 = 0.02;
/// How often [`bent`] cuts it.
const CUTS: usize = 4;

impl DrawnSpan {
    /// The span from CV `k` on of a curve of `k + 2` CVs or more.
    pub fn of(cvs: &[Vec3], k: usize) -> Self {
        let (a, b) = (cvs[k], cvs[k + 1]);
        let before = if k > 0 { cvs[k - 1] } else { a + (a - b) };
        let after = cvs.get(k + 2).copied().unwrap_or(b + (b - a));
        Self([before, a, b, after])
    }

    /// The straight span from `a` to `b`.
    pub fn straight(a: Vec3, b: Vec3) -> Self {
        Self([a + (a - b), a, b, b + (b - a)])
    }

    /// How much each of the four CVs counts at `t`, 0 to 1.
    pub fn weights(t: f32) -> [f32; 4] {
        let (t2, t3) = (t * t, t * t * t);
        [
            0.5 * (2.0 * t2 - t - t3),
            0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
            0.5 * (4.0 * t2 - 3.0 * t3 + t),
            0.5 * (t3 - t2),
        ]
    }

    /// The point at `t`, 0 to 1.
    pub fn at(&self, t: f32) -> Vec3 {
        let Self([a, b, c, d]) = self;
        let [wa, wb, wc, wd] = Self::weights(t);
        *a * wa + *b * wb + *c * wc + *d * wd
    }

    /// The way the curve runs at `t`. Unit; zero where the span has no length.
    pub fn tangent(&self, t: f32) -> Vec3 {
        const ABOUT: f32 = 0.05;
        let (lo, hi) = ((t - ABOUT).max(0.0), (t + ABOUT).min(1.0));
        (self.at(hi) - self.at(lo)).normalize_or_zero()
    }

    /// How far (cm) a part of it, a share `dt` of its parameter long, leaves the straight line between its ends at most.
    pub fn leaves_chord(&self, dt: f32) -> f32 {
        let Self([a, b, c, d]) = self;
        let (from, to) =
            (*a * 2.0 - *b * 5.0 + *c * 4.0 - *d, *c * -5.0 - *a + *b * 4.0 + *d * 2.0);
        from.length_squared().max(to.length_squared()).sqrt() * (dt * dt / 8.0)
    }

    /// Middle and radius of a ball that holds the span: that of its Bezier points.
    pub fn ball(&self) -> (Vec3, f32) {
        let bezier = self.bezier();
        let middle = (bezier[0] + bezier[3]) * 0.5;
        let far = |r: f32, p: &Vec3| r.max(p.distance_squared(middle));
        (middle, bezier.iter().fold(0.0, far).sqrt())
    }

    /// Its Bezier points: what is convex and holds them holds the span.
    #[inline]
    pub fn bezier(&self) -> [Vec3; 4] {
        let Self([a, b, c, d]) = self;
        [*b, *b + (*c - *a) / 6.0, *c - (*d - *b) / 6.0, *c]
    }

    /// Whether it leaves the straight line between its CVs by more than [`BENT`] at its middle.
    fn is_bent(&self) -> bool {
        let Self([a, b, c, d]) = self;
        (*b + *c - *a - *d).length_squared() > 256.0 * BENT * BENT
    }
}

/// The first `n` points of a curve with more between those whose span is bent, all on the drawn curve: for who asks a polyline what a
/// curve does.
pub fn bent(cvs: &[Vec3], n: usize) -> Cow<'_, [Vec3]> {
    let n = n.min(cvs.len());
    let spans = || (0..n.saturating_sub(1)).map(|k| DrawnSpan::of(cvs, k));
    if !spans().any(|span| span.is_bent()) {
        return Cow::Borrowed(&cvs[..n]);
    }
    let mut out = Vec::with_capacity(CUTS * n);
    for (k, span) in spans().enumerate() {
        out.push(cvs[k]);
        if span.is_bent() {
            out.extend((1..CUTS).map(|n| span.at(n as f32 / CUTS as f32)));
        }
    }
    out.push(cvs[n - 1]);
    Cow::Owned(out)
}

/// The bounds of the drawn curve: lowest and highest corner, exact but for rounding; none of an empty curve.
pub fn bounds(cvs: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let first = *cvs.first()?;
    let (mut lo, mut hi) = cvs.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    for k in 0..cvs.len() - 1 {
        let span = DrawnSpan::of(cvs, k);
        let (middle, radius) = span.ball();
        let (low, high) = (middle - Vec3::splat(radius), middle + Vec3::splat(radius));
        if low.cmpge(lo).all() && high.cmple(hi).all() {
            continue;
        }
        let [a, b, c, d] = span.0;
        // Where the derivative of a coordinate is zero.
        let (c2, c1, c0) = ((b - c) * 3.0 + d - a, a * 2.0 - b * 5.0 + c * 4.0 - d, c - a);
        for axis in 0..3 {
            let (q2, q1, q0) = (1.5 * c2[axis], c1[axis], 0.5 * c0[axis]);
            let root = (q1 * q1 - 4.0 * q2 * q0).max(0.0).sqrt();
            // Written so that a straight coordinate, whose first coefficient is zero, needs no case of its own.
            let s = -0.5 * (q1 + root.copysign(q1));
            for t in [s / q2, q0 / s].into_iter().filter(|t| (0.0..=1.0).contains(t)) {
                let p = span.at(t);
                (lo[axis], hi[axis]) = (lo[axis].min(p[axis]), hi[axis].max(p[axis]));
            }
        }
    }
    Some((lo, hi))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    fn random(id: u64, n: u64) -> Vec<Vec3> {
        let dice = Dice::new(7, 0, "cvs");
        (0..n).map(|k| Vec3::from([0, 1, 2].map(|axis| dice.signed(id, 10 * k + axis)))).collect()
    }

    #[test]
    fn a_span_lies_in_its_ball_and_a_curve_in_its_bounds_which_it_touches() {
        for id in 0..400 {
            let cvs = random(id, 2 + id % 7);
            let (lo, hi) = bounds(&cvs).unwrap();
            let (mut low, mut high) = (cvs[0], cvs[0]);
            for k in 0..cvs.len() - 1 {
                let span = DrawnSpan::of(&cvs, k);
                assert!(
                    span.at(0.0).distance(cvs[k]) < 1e-6
                        && span.at(1.0).distance(cvs[k + 1]) < 1e-6
                );
                let (middle, radius) = span.ball();
                for (from, dt) in [(0.0, 1.0), (0.25, 0.5), (0.7, 0.1)] {
                    let chord = |t: f32| span.at(from).lerp(span.at(from + dt), t);
                    let off = |n: u32| {
                        let t = n as f32 / 40.0;
                        let ends = [span.at(from), span.at(from + dt)];
                        let p = span.at(from + dt * t);
                        crate::maths::nearest_on(ends, p).0.distance(p).min(chord(t).distance(p))
                    };
                    let most = (0..=40).map(off).fold(0.0, f32::max);
                    assert!(most <= span.leaves_chord(dt) + 1e-5, "{id}: {most}");
                }
                for n in 0..=200 {
                    let p = span.at(n as f32 / 200.0);
                    assert!(p.distance(middle) <= radius + 1e-5);
                    (low, high) = (low.min(p), high.max(p));
                }
            }
            assert!((low - lo).min_element() > -1e-5 && (hi - high).min_element() > -1e-5);
            assert!((low - lo).max_element() < 1e-3 && (hi - high).max_element() < 1e-3, "{id}");
        }
    }

    #[test]
    fn bent_spans_are_cut_and_straight_curves_stay() {
        let straight = [0.0, 1.0, 2.0].map(|x| Vec3::X * x);
        assert!(matches!(bent(&straight, 3), Cow::Borrowed(_)));
        let corner = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y];
        let cut = bent(&corner, 3);
        assert_eq!((cut.len(), cut[0], cut[4], cut[8]), (9, corner[0], corner[1], corner[2]));
        assert_eq!(bent(&corner, 2)[..], cut[..5], "what comes after bends the last span too");
        assert!(bent(&[], 2).is_empty() && bent(&corner[..1], 2).len() == 1);
    }
}
