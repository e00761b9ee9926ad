//! The curve that control vertices stand for: a centripetal Catmull-Rom spline by arc length.
//!
//! methods.md 0: a curve is interpolated by a centripetal Catmull-Rom spline (Yuksel, Schaefer, Keyser
//! 2011, "Parameterization and applications of Catmull-Rom curves"), its ends extrapolated as USD's
//! `pinned` does, and `u` in [0, 1] is the fraction of its arc length.
//!
//! Guarantees: passes through every CV, C1 wherever neighbouring CVs differ, length right to 1e-5 of
//! itself on hair-like curves, [`Spline::at`] within 1e-4 of a span of the true arc length. Repeated CVs are allowed;
//! a curve without any length is refused by name.

use super::lanes::{
    InLanes, LANES, Simd, Vec3x8, clamp_to_one, each, f32x8, four_at, in_lanes, ops::*, pick,
    turned,
};
use glam::Vec3;

/// Why points make no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CurveFault {
    /// Fewer than two CVs.
    #[error("a curve with fewer than 2 points was left out")]
    TooFewPoints,
    /// A coordinate is NaN or infinite.
    #[error("a curve with a point that is not a finite number was left out")]
    NotFinite,
    /// All CVs are at one place.
    #[error("a curve without length was left out")]
    NoLength,
}

/// Sub-intervals of a span for which the arc length is tabulated. Four keep a quarter turn in one
/// span (8 CVs a turn has half of that) within the stated accuracy.
const SUBS: usize = 4;

/// A place on a spline: span and local parameter in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineParam {
    /// Span from CV `span` to CV `span + 1`.
    pub span: usize,
    /// Parameter within the span.
    pub t: f32,
}

/// A centripetal Catmull-Rom spline with its arc length table. Reusable: [`Spline::rebuild`] keeps
/// its buffers.
#[derive(Clone, Debug, Default)]
pub struct Spline {
    /// Cubic coefficients of each span: `((c3 t + c2) t + c1) t + c0`.
    spans: Vec<[Vec3; 4]>,
    /// Arc length up to each sub-interval; `spans * SUBS + 1` entries.
    lengths: Vec<f32>,
    /// Speed |d/dt| at each sub-interval's ends, as many.
    speeds: Vec<(f32, f32)>,
    /// Scratch: the knot distance of each span.
    knots: Vec<f32>,
}

impl Spline {
    /// The spline through `points` (root first, at least two, finite, not all the same).
    pub fn new(points: &[Vec3]) -> Result<Self, CurveFault> {
        let mut spline = Self::default();
        spline.rebuild(points)?;
        Ok(spline)
    }

    /// Makes this the spline through `points`, reusing its memory.
    pub fn rebuild(&mut self, points: &[Vec3]) -> Result<(), CurveFault> {
        self.spans.clear();
        self.lengths.clear();
        self.speeds.clear();
        if points.len() < 2 {
            return Err(CurveFault::TooFewPoints);
        }
        if points.iter().any(|p| !p.is_finite()) {
            return Err(CurveFault::NotFinite);
        }
        span_coefficients(points, &mut self.knots, &mut self.spans);
        self.tabulate(&WHOLE)
    }

    /// Makes this the chain of these polynomials, `((c3 t + c2) t + c1) t + c0` for t from 0 to 1, each of which goes on where
    /// the one before ends: curves that are no Catmull-Rom splines.
    pub fn rebuild_from_spans(
        &mut self,
        spans: impl Iterator<Item = [Vec3; 4]>,
    ) -> Result<(), CurveFault> {
        self.spans.clear();
        self.lengths.clear();
        self.speeds.clear();
        self.spans.extend(spans);
        if self.spans.is_empty() {
            return Err(CurveFault::TooFewPoints);
        }
        if self.spans.iter().flatten().any(|c| !c.is_finite()) {
            return Err(CurveFault::NotFinite);
        }
        // Curves by whomever: their spans may bend more than those that coif makes.
        self.tabulate(&IN_FOUR)
    }

    /// Fills the table of arc lengths from the spans, integrating each sub-interval in these parts.
    fn tabulate(&mut self, parts: &'static [Stops]) -> Result<(), CurveFault> {
        let total = in_lanes(Tabulate { spline: self, parts });
        if total > 0.0 && total.is_finite() { Ok(()) } else { Err(CurveFault::NoLength) }
    }

    /// Arc length in the points' unit.
    pub fn length(&self) -> f32 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Number of spans: one less than CVs.
    pub fn span_count(&self) -> usize {
        self.spans.len()
    }

    /// Where the fraction `u` of the arc length lies; clamped to the curve.
    pub fn locate(&self, u: f32) -> SplineParam {
        self.locate_length(u * self.length())
    }

    /// Where arc length `s` from the root lies; clamped to the curve.
    pub fn locate_length(&self, s: f32) -> SplineParam {
        let s = s.clamp(0.0, self.length());
        self.place_within(self.lengths.partition_point(|length| *length <= s), s)
    }

    /// [`Self::locate_length`] for lengths that rise from call to call: `cursor`, 0 at first, remembers how far they have
    /// come.
    pub fn locate_rising(&self, cursor: &mut usize, s: f32) -> SplineParam {
        let s = s.clamp(0.0, self.length());
        self.advance(cursor, s);
        self.place_within(*cursor, s)
    }

    fn advance(&self, cursor: &mut usize, s: f32) {
        while *cursor < self.lengths.len() && self.lengths[*cursor] <= s {
            *cursor += 1;
        }
    }

    /// The first half of [`Self::locate_rising`], for [`Self::points_in`]: the index of the sub-interval.
    #[inline(always)]
    pub(crate) fn part_rising(&self, cursor: &mut usize, s: f32) -> usize {
        self.advance(cursor, s.clamp(0.0, self.length()));
        cursor.saturating_sub(1).min(self.speeds.len() - 1)
    }

    /// The place with parameter `t` on the span of a sub-interval.
    pub(crate) fn place_in(sub: usize, t: f32) -> SplineParam {
        SplineParam { span: sub / SUBS, t }
    }

    /// Arc lengths and speeds at both ends of a sub-interval, and the coefficients of its span.
    #[inline(always)]
    pub(crate) fn part(&self, sub: usize) -> ([f32; 4], &[f32; 12]) {
        let (v0, v1) = self.speeds[sub];
        let ends = [self.lengths[sub], self.lengths[sub + 1], v0, v1];
        let cubic: &[f32] = bytemuck::cast_slice(&self.spans[sub / SUBS]);
        (ends, cubic.first_chunk().expect("four vectors"))
    }

    /// The place of arc length `s`, where `after` sub-intervals begin at or before it.
    fn place_within(&self, after: usize, s: f32) -> SplineParam {
        let sub = after.saturating_sub(1).min(self.speeds.len() - 1);
        let (start, end) = (self.lengths[sub], self.lengths[sub + 1]);
        let fraction = if end > start { (s - start) / (end - start) } else { 0.0 };
        let (v0, v1) = self.speeds[sub];
        // Speed taken as linear across the sub-interval: s = v0 x + (v1 - v0) x^2 / 2, whose root is
        // written so that v1 = v0 needs no special case.
        let mean = 0.5 * (v0 + v1);
        let root = (v0 * v0 + 2.0 * (v1 - v0) * mean * fraction).max(0.0).sqrt();
        let x = if v0 + root > 0.0 { 2.0 * mean * fraction / (v0 + root) } else { fraction };
        let t = ((sub % SUBS) as f32 + x.clamp(0.0, 1.0)) / SUBS as f32;
        SplineParam { span: sub / SUBS, t }
    }

    /// The points at arc lengths `s` of eight splines, and their parameters, given the sub-intervals: [`Self::locate_rising`] and
    /// [`Self::point`] in lanes.
    #[inline(always)]
    pub(crate) fn points_in<S: Simd>(
        splines: &[&Spline; LANES],
        subs: &[usize; LANES],
        s: f32x8<S>,
    ) -> (Vec3x8<S>, f32x8<S>) {
        let zero = s.simd.splat_f32x8(0.0);
        let parts: [_; LANES] = std::array::from_fn(
            #[inline(always)]
            |i| splines[i].part(subs[i]),
        );
        let row = each(
            parts.each_ref(),
            #[inline(always)]
            |part| &part.0,
        );
        let [start, end, v0, v1] = turned(s.simd, row);
        let four = |at: usize| {
            let row = each(
                parts.each_ref(),
                #[inline(always)]
                |part| four_at(part.1, at),
            );
            turned(s.simd, row)
        };
        let ([x0, y0, z0, x1], [y1, z1, x2, y2], [z2, x3, y3, z3]) = (four(0), four(4), four(8));
        let lengths = s.simd.load_array_f32x8(splines.map(Spline::length));
        let s = pick(s.simd_lt(0.0), zero, s);
        let s = pick(s.simd_gt(lengths), lengths, s);
        let fraction = pick(end.simd_gt(start), (s - start) / (end - start), zero);
        let mean = 0.5 * (v0 + v1);
        let square = v0 * v0 + 2.0 * (v1 - v0) * mean * fraction;
        let root = pick(square.simd_gt(0.0), square, zero).sqrt();
        let x = pick((v0 + root).simd_gt(0.0), 2.0 * mean * fraction / (v0 + root), fraction);
        let first = s.simd.load_array_f32x8(subs.map(|sub| (sub % SUBS) as f32));
        let t = (first + clamp_to_one(x)) / SUBS as f32;
        let c0 = Vec3x8 { x: x0, y: y0, z: z0 };
        let c1 = Vec3x8 { x: x1, y: y1, z: z1 };
        let c2 = Vec3x8 { x: x2, y: y2, z: z2 };
        let c3 = Vec3x8 { x: x3, y: y3, z: z3 };
        (((c3 * t + c2) * t + c1) * t + c0, t)
    }

    /// The point at a place.
    pub fn point(&self, place: SplineParam) -> Vec3 {
        let [c0, c1, c2, c3] = self.spans[place.span];
        ((c3 * place.t + c2) * place.t + c1) * place.t + c0
    }

    /// The unit tangent at a place, root to tip. Where CVs repeat, the direction of the nearest part that has one.
    pub fn tangent(&self, place: SplineParam) -> Vec3 {
        // At a cusp the speed is zero for an instant: the direction just after it is meant.
        for t in [place.t, place.t + 1e-3, place.t - 1e-3] {
            let direct = derivative(&self.spans[place.span], t);
            if direct.length_squared() > 1e-14 * self.length() * self.length() {
                return direct.normalize_or_zero();
            }
        }
        let n = self.spans.len();
        for reach in 0..=n {
            for span in [place.span + reach, place.span.wrapping_sub(reach)] {
                if span < n
                    && let Some(tangent) = derivative(&self.spans[span], 0.5).try_normalize()
                {
                    return tangent;
                }
            }
        }
        Vec3::Y
    }

    /// The point at the fraction `u` of the arc length.
    pub fn at(&self, u: f32) -> Vec3 {
        self.point(self.locate(u))
    }

    /// The unit tangent at the fraction `u` of the arc length.
    pub fn tangent_at(&self, u: f32) -> Vec3 {
        self.tangent(self.locate(u))
    }

    /// The place of CV `index`, which must be one of the curve's.
    pub fn place_of_cv(&self, index: usize) -> SplineParam {
        match index.checked_sub(1) {
            Some(span) if index == self.spans.len() => SplineParam { span, t: 1.0 },
            _ => SplineParam { span: index, t: 0.0 },
        }
    }

    /// The fraction of the arc length at which CV `index` lies.
    pub fn u_of_cv(&self, index: usize) -> f32 {
        let total = self.length();
        if total > 0.0 {
            self.lengths[(index * SUBS).min(self.lengths.len() - 1)] / total
        } else {
            0.0
        }
    }

    /// Curvature (1/length unit) at the fraction `u`.
    pub fn curvature_at(&self, u: f32) -> f32 {
        let place = self.locate(u);
        let [_, c1, c2, c3] = self.spans[place.span];
        let first = (c3 * (3.0 * place.t) + c2 * 2.0) * place.t + c1;
        let second = c3 * (6.0 * place.t) + c2 * 2.0;
        let speed = first.length();
        if speed > 0.0 { first.cross(second).length() / (speed * speed * speed) } else { 0.0 }
    }

    /// Calls `put` with `n` points at even arc length, ends included; n < 2 gives the root alone.
    pub fn resample(&self, n: usize, mut put: impl FnMut(Vec3)) {
        let mut cursor = 0;
        for k in 0..n {
            let u = if n > 1 { k as f32 / (n - 1) as f32 } else { 0.0 };
            put(self.point(self.locate_rising(&mut cursor, u * self.length())));
        }
    }
}

fn span_coefficients(points: &[Vec3], knots: &mut Vec<f32>, spans: &mut Vec<[Vec3; 4]>) {
    knots.clear();
    knots.extend(points.windows(2).map(|w| w[0].distance(w[1]).sqrt()));
    for (i, w) in points.windows(2).enumerate() {
        let (p1, p2, d12) = (w[0], w[1], knots[i]);
        if d12 == 0.0 {
            spans.push([p1, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO]);
            continue;
        }
        // Tangents at p1 and p2 for a parameter that runs 0..1 over this span. A missing or repeated
        // neighbour is extrapolated: 2 p1 - p2, at the same knot distance.
        let tangent = |before: Option<(Vec3, f32)>, from: Vec3, to: Vec3| match before {
            Some((p0, d01)) if d01 > 0.0 => {
                ((from - p0) / d01 - (to - p0) / (d01 + d12) + (to - from) / d12) * d12
            }
            _ => to - from,
        };
        let before = i.checked_sub(1).map(|k| (points[k], knots[k]));
        let after = points.get(i + 2).map(|p| (*p, knots[i + 1]));
        let (m1, m2) = (tangent(before, p1, p2), -tangent(after, p2, p1));
        let chord = p2 - p1;
        spans.push([p1, m1, chord * 3.0 - m1 * 2.0 - m2, m1 + m2 - chord * 2.0]);
    }
}

fn derivative([_, c1, c2, c3]: &[Vec3; 4], t: f32) -> Vec3 {
    (*c3 * (3.0 * t) + *c2 * 2.0) * t + *c1
}

/// Fills the tables of arc lengths and speeds. Returns the total length.
struct Tabulate<'a> {
    spline: &'a mut Spline,
    parts: &'a [Stops],
}

impl InLanes for Tabulate<'_> {
    type Out = f64;
    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> f64 {
        let Self { spline: Spline { spans, lengths, speeds: ends, .. }, parts } = self;
        lengths.push(0.0);
        let mut total = 0.0f64;
        for span in &*spans {
            let mut arcs = [[0.0; SUBS]; IN_FOUR.len()];
            let mut at_ends = [0.0; SUBS + 1];
            for (stops, arcs) in parts.iter().zip(&mut arcs) {
                let speeds = speeds(s, span, &stops.at);
                *arcs = stops.arc_lengths(&speeds);
                at_ends.copy_from_slice(&speeds[3 * SUBS..=4 * SUBS]);
            }
            for sub in 0..SUBS {
                arcs[..parts.len()].iter().for_each(|arcs| total += f64::from(arcs[sub]));
                lengths.push(total as f32);
                ends.push((at_ends[sub], at_ends[sub + 1]));
            }
        }
        total
    }
}

/// The speeds of a span at these parameters.
#[inline(always)]
fn speeds<S: Simd>(s: S, [_, c1, c2, c3]: &[Vec3; 4], at: &[f32; 3 * LANES]) -> [f32; 3 * LANES] {
    let [c1, c2, c3] = [Vec3x8::splat(s, *c1), Vec3x8::splat(s, *c2), Vec3x8::splat(s, *c3)];
    let mut out = [0.0; 3 * LANES];
    let (eights, _) = out.as_chunks_mut::<LANES>();
    for (out, t) in eights.iter_mut().zip(at.as_chunks::<LANES>().0) {
        let t = s.load_array_ref_f32x8(t);
        let velocity = (c3 * (3.0 * t) + c2 * s.splat_f32x8(2.0)) * t + c1;
        s.store_array_f32x8(velocity.length(), out);
    }
    out
}

/// Where speeds are taken for the arc lengths of one part of each sub-interval, by Gauss-Legendre with three points (exact for
/// speeds that are polynomials up to degree five): first, second and third points, then the sub-intervals' ends.
struct Stops {
    at: [f32; 3 * LANES],
    halves: [f32; SUBS],
}

/// For sub-intervals integrated as a whole, and in four parts.
const WHOLE: [Stops; 1] = [Stops::of(0, 1)];
const IN_FOUR: [Stops; 4] = [Stops::of(0, 4), Stops::of(1, 4), Stops::of(2, 4), Stops::of(3, 4)];

impl Stops {
    /// For part number `part` of each sub-interval, out of `parts`.
    const fn of(part: usize, parts: usize) -> Self {
        const X: f32 = 0.774_596_7;
        let (mut at, mut halves) = ([1.0; 3 * LANES], [0.0; SUBS]);
        let mut sub = 0;
        while sub < SUBS {
            let (t0, t1) = (sub as f32 / SUBS as f32, (sub + 1) as f32 / SUBS as f32);
            let m0 = t0 + (t1 - t0) * (part as f32 / parts as f32);
            let m1 = t0 + (t1 - t0) * ((part + 1) as f32 / parts as f32);
            let (mid, half) = (0.5 * (m0 + m1), 0.5 * (m1 - m0));
            at[sub] = mid + half * -X;
            at[SUBS + sub] = mid;
            at[2 * SUBS + sub] = mid + half * X;
            at[3 * SUBS + sub] = t0;
            halves[sub] = half;
            sub += 1;
        }
        Self { at, halves }
    }

    fn arc_lengths(&self, speeds: &[f32; 3 * LANES]) -> [f32; SUBS] {
        let mut arcs = [0.0; SUBS];
        for sub in 0..SUBS {
            let sum = 5.0 * speeds[sub] + 8.0 * speeds[SUBS + sub] + 5.0 * speeds[2 * SUBS + sub];
            arcs[sub] = self.halves[sub] * sum / 9.0;
        }
        arcs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::transcendental::sin_cos_turns;

    fn helix(turns: f32, per_turn: usize) -> Vec<Vec3> {
        let n = (turns * per_turn as f32) as usize;
        (0..=n)
            .map(|k| {
                let (s, c) = sin_cos_turns(k as f32 / per_turn as f32);
                Vec3::new(c, k as f32 / per_turn as f32, s)
            })
            .collect()
    }

    #[test]
    fn passes_through_its_points() {
        let points = helix(2.0, 8);
        let spline = Spline::new(&points).unwrap();
        for (i, p) in points.iter().enumerate() {
            assert!(spline.at(spline.u_of_cv(i)).distance(*p) < 1e-4, "CV {i}");
        }
    }

    #[test]
    fn u_is_arc_length() {
        // Uneven CVs on a straight line: u must not follow them.
        let points = [0.0, 0.1, 0.2, 3.0, 3.1, 10.0].map(|x| Vec3::new(x, 0.0, 0.0));
        let spline = Spline::new(&points).unwrap();
        assert!((spline.length() - 10.0).abs() < 1e-4);
        for k in 0..=100 {
            let u = k as f32 / 100.0;
            assert!((spline.at(u).x - 10.0 * u).abs() < 0.02, "{u}: {}", spline.at(u).x);
        }
    }

    #[test]
    fn length_of_a_helix_converges_to_the_closed_form() {
        let exact = 3.0 * (std::f32::consts::TAU * std::f32::consts::TAU + 1.0).sqrt();
        for (per_turn, tolerance) in [(8, 1e-2), (16, 1e-3), (64, 1e-5)] {
            let length = Spline::new(&helix(3.0, per_turn)).unwrap().length();
            assert!((length / exact - 1.0).abs() < tolerance, "{per_turn}: {length} {exact}");
        }
    }

    #[test]
    fn the_tangent_has_no_corner_at_the_points() {
        let points = helix(2.0, 8);
        let spline = Spline::new(&points).unwrap();
        for span in 0..spline.span_count() - 1 {
            let a = spline.tangent(SplineParam { span, t: 1.0 });
            let b = spline.tangent(SplineParam { span: span + 1, t: 0.0 });
            assert!(a.dot(b) > 0.999_99, "span {span}");
        }
    }

    #[test]
    fn what_is_no_curve_is_refused_by_name() {
        let check = |points: &[Vec3], fault| assert_eq!(Spline::new(points).unwrap_err(), fault);
        check(&[], CurveFault::TooFewPoints);
        check(&[Vec3::ONE], CurveFault::TooFewPoints);
        check(&[Vec3::ONE; 5], CurveFault::NoLength);
        check(&[Vec3::ONE, Vec3::NAN], CurveFault::NotFinite);
    }

    #[test]
    fn repeated_points_are_passed_over() {
        let spline = Spline::new(&[Vec3::ZERO, Vec3::X, Vec3::X, Vec3::X * 2.0]).unwrap();
        assert!((spline.length() - 2.0).abs() < 1e-5);
        assert!(spline.tangent_at(0.5).dot(Vec3::X) > 0.999);
    }
}
