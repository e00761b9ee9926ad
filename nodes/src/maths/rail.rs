//! A source curve made ready for laying things along it: points and minimal frames by arc length.
//!
//! The same centripetal Catmull-Rom curve as [`super::spline`], with the normal and binormal carried beside it
//! (double reflection, [`super::frame`]). Where `frames` answers a few questions about one curve exactly, a rail
//! answers hundreds for each of a hundred thousand: it costs two square roots a source span and one an
//! answer, and keeps its memory from curve to curve.
//!
//! Guarantees: passes through every CV; no segment turns by more than 10 degrees (sharper corners are crossed by
//! one smallest rotation), so that the straight mix of its two frames is unit and square to 0.4 %; arc length
//! right to 1e-3 of a span.

use super::frame::{STEP_COS, across, any_normal, carry, reflect_twice};
use super::spline::CurveFault;
use glam::Vec3;

/// A part of a span with a frame at each end.
#[derive(Clone, Copy, Debug)]
struct Segment {
    /// Arc length at its start and one over its own.
    start: f32,
    per_length: f32,
    /// Speed at the start, and speed at the end less that, both over the mean speed.
    speed: f32,
    speed_step: f32,
    /// Cubic coefficients for a parameter that runs 0..1 over this segment.
    cubic: [Vec3; 4],
    normal: Vec3,
    normal_step: Vec3,
    binormal: Vec3,
    binormal_step: Vec3,
    piece: Piece,
}

/// Which part of which span a segment covers.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// CV before the span.
    cv: u32,
    from: f32,
    part: f32,
}

/// What is carried from segment to segment.
struct Walk<F> {
    start: Option<F>,
    tangent: Vec3,
    normal: Vec3,
}

/// A place on a rail with the axes across it.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// The point on the curve.
    pub point: Vec3,
    /// Axis across the curve.
    pub normal: Vec3,
    /// The other axis, tangent x normal.
    pub binormal: Vec3,
    /// CV before the point and the fraction of the way to the next.
    pub place: (u32, f32),
}

/// A curve with frames, by arc length. Reusable: [`Rail::rebuild`] keeps its buffers.
#[derive(Clone, Debug, Default)]
pub struct Rail {
    segments: Vec<Segment>,
    /// Square root of each chord: the centripetal knot distances.
    knots: Vec<f32>,
    length: f32,
}

/// cos 5 degrees: the most the tangent may turn in half a segment.
const HALF_TURN_COS: f32 = 0.996_194_7;
/// The smallest part of a span that becomes a segment: what turns within it is a corner.
const SHORTEST: f32 = 1.0 / 64.0;

impl Rail {
    /// Makes this the rail along `points`. `start` gives the wanted normal for the tangent at the root.
    pub fn rebuild(
        &mut self,
        points: &[Vec3],
        start: impl FnOnce(Vec3) -> Vec3,
    ) -> Result<(), CurveFault> {
        self.segments.clear();
        self.knots.clear();
        self.length = 0.0;
        if points.len() < 2 {
            return Err(CurveFault::TooFewPoints);
        }
        if points.iter().any(|p| !p.is_finite()) {
            return Err(CurveFault::NotFinite);
        }
        self.knots.extend(points.windows(2).map(|w| w[0].distance(w[1]).sqrt()));
        let mut walk = Walk { start: Some(start), tangent: Vec3::ZERO, normal: Vec3::ZERO };
        let last = points.len() - 2;
        let mut after = Vec3::ZERO;
        for i in 0..=last {
            let knot = self.knots[i];
            if knot == 0.0 {
                continue;
            }
            let (p1, p2) = (points[i], points[i + 1]);
            let chord = p2 - p1;
            let before = if i > 0 { self.knots[i - 1] } else { 0.0 };
            let m1 = if before > 0.0 { after * knot } else { chord };
            let next = if i < last { self.knots[i + 1] } else { 0.0 };
            let m2 = if next > 0.0 {
                let p3 = points[i + 2];
                after = chord / knot - (p3 - p1) / (knot + next) + (p3 - p2) / next;
                after * knot
            } else {
                chord
            };
            let cubic = [p1, m1, chord * 3.0 - m1 * 2.0 - m2, m1 + m2 - chord * 2.0];
            self.push(&mut walk, cubic, Piece { cv: i as u32, from: 0.0, part: 1.0 });
        }
        if self.length > 0.0 && self.length.is_finite() {
            Ok(())
        } else {
            Err(CurveFault::NoLength)
        }
    }

    /// Adds a piece of a span, in halves while it turns too much.
    fn push<F: FnOnce(Vec3) -> Vec3>(
        &mut self,
        walk: &mut Walk<F>,
        cubic: [Vec3; 4],
        piece: Piece,
    ) {
        let (first, middle, last) = (cubic[1], velocity(&cubic, 0.5), velocity(&cubic, 1.0));
        let (v0, vm, v1) = (first.length(), middle.length(), last.length());
        // (A point where the speed is zero makes this false, which asks for halves.)
        let smooth = first.dot(middle) >= HALF_TURN_COS * v0 * vm
            && middle.dot(last) >= HALF_TURN_COS * vm * v1
            && v0 * v1 > 0.0;
        if !smooth && piece.part > SHORTEST {
            let part = 0.5 * piece.part;
            self.push(walk, cut(&cubic, 0.0), Piece { part, ..piece });
            let second = Piece { from: piece.from + part, part, ..piece };
            return self.push(walk, cut(&cubic, 0.5), second);
        }
        const X: f32 = 0.387_298_35;
        let speed = |t: f32| velocity(&cubic, t).length();
        // Gauss-Legendre with three points, as in `super::spline`.
        let length = (5.0 * speed(0.5 - X) + 8.0 * vm + 5.0 * speed(0.5 + X)) / 18.0;
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let step = cubic[1] + cubic[2] + cubic[3];
        let to = if v1 > 0.0 { last / v1 } else { step.normalize_or(walk.tangent) };
        if let Some(start) = walk.start.take() {
            walk.tangent = if v0 > 0.0 { first / v0 } else { to };
            walk.normal = across(start(walk.tangent), walk.tangent)
                .unwrap_or_else(|| any_normal(walk.tangent));
        }
        let Walk { tangent, normal, .. } = *walk;
        let carried = if tangent.dot(to) >= STEP_COS {
            reflect_twice(normal, step, tangent, to)
        } else {
            carry(normal, tangent, to)
        };
        let mean = 0.5 * (v0 + v1);
        let (speed, speed_step) =
            if mean > 0.0 { (v0 / mean, (v1 - v0) / mean) } else { (1.0, 0.0) };
        let binormal = tangent.cross(normal);
        self.segments.push(Segment {
            start: self.length,
            per_length: 1.0 / length,
            speed,
            speed_step,
            cubic,
            normal,
            normal_step: carried - normal,
            binormal,
            binormal_step: to.cross(carried) - binormal,
            piece,
        });
        self.length += length;
        (walk.tangent, walk.normal) = (to, carried);
    }

    /// Arc length, cm.
    pub fn length(&self) -> f32 {
        self.length
    }

    /// What lies at arc length `s`. `cursor` is where the last answer was found (0 at first): asking with rising
    /// `s` costs no search.
    #[inline]
    pub fn at(&self, cursor: &mut usize, s: f32) -> Stop {
        let mut i = (*cursor).min(self.segments.len() - 1);
        while i + 1 < self.segments.len() && self.segments[i + 1].start <= s {
            i += 1;
        }
        while i > 0 && self.segments[i].start > s {
            i -= 1;
        }
        *cursor = i;
        let segment = &self.segments[i];
        let fraction = ((s - segment.start) * segment.per_length).clamp(0.0, 1.0);
        // Speed taken as linear across the segment, as in `Spline::locate_length`.
        let (v, dv) = (segment.speed, segment.speed_step);
        let root = (v * v + 2.0 * dv * fraction).max(0.0).sqrt();
        let t = if v + root > 0.0 { (2.0 * fraction / (v + root)).min(1.0) } else { fraction };
        let [c0, c1, c2, c3] = segment.cubic;
        Stop {
            point: ((c3 * t + c2) * t + c1) * t + c0,
            normal: segment.normal + segment.normal_step * t,
            binormal: segment.binormal + segment.binormal_step * t,
            place: (segment.piece.cv, segment.piece.from + segment.piece.part * t),
        }
    }
}

fn velocity([_, c1, c2, c3]: &[Vec3; 4], t: f32) -> Vec3 {
    (*c3 * (3.0 * t) + *c2 * 2.0) * t + *c1
}

/// Half of a cubic, from `from` on.
fn cut([c0, c1, c2, c3]: &[Vec3; 4], from: f32) -> [Vec3; 4] {
    let point = ((*c3 * from + *c2) * from + *c1) * from + *c0;
    let first = (*c3 * (3.0 * from) + *c2 * 2.0) * from + *c1;
    let second = *c3 * (3.0 * from) + *c2;
    [point, first * 0.5, second * 0.25, *c3 * 0.125]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::frame::frames;
    use crate::maths::hash::Dice;
    use crate::maths::spline::Spline;

    fn walk(id: u64, n: u64) -> Vec<Vec3> {
        let dice = Dice::new(3, 0, "walk");
        let mut p = Vec3::ZERO;
        let axis = |k, a| dice.signed(id, 10 + 3 * k + a) * 0.5;
        (0..n)
            .map(|k| {
                p += Vec3::new(axis(k, 0), axis(k, 1) + 0.6, axis(k, 2));
                p
            })
            .collect()
    }

    #[test]
    fn follows_the_spline_and_its_frames() {
        let (mut far, mut turned, mut uneven) = (0.0f32, 1.0f32, 0.0f32);
        for id in 0..100 {
            let points = walk(id, 4 + id % 20);
            let spline = Spline::new(&points).unwrap();
            let mut rail = Rail::default();
            rail.rebuild(&points, |_| Vec3::X).unwrap();
            assert!((rail.length() / spline.length() - 1.0).abs() < 2e-3);
            let us: Vec<f32> = (0..=200).map(|k| k as f32 / 200.0).collect();
            let exact = frames(&spline, &us, Some(Vec3::X), |_, _, _| None);
            let mut cursor = 0;
            for (u, frame) in us.iter().zip(exact) {
                let stop = rail.at(&mut cursor, u * rail.length());
                far = far.max(stop.point.distance(spline.at(*u)));
                turned = turned.min(stop.normal.dot(frame.normal));
                uneven = uneven.max((stop.normal.length() - 1.0).abs());
                uneven = uneven.max((stop.binormal.length() - 1.0).abs());
                uneven = uneven.max(stop.normal.dot(stop.binormal).abs());
            }
        }
        assert!(far < 0.02 && turned > 0.995 && uneven < 4e-3, "{far} {turned} {uneven}");
    }

    #[test]
    fn corners_and_repeated_points_make_no_nan() {
        for points in [
            vec![Vec3::ZERO, Vec3::Y, Vec3::Y, Vec3::ZERO],
            vec![Vec3::ZERO, Vec3::X, Vec3::ZERO],
            vec![Vec3::ZERO, Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1e-7, 0.0)],
        ] {
            let mut rail = Rail::default();
            rail.rebuild(&points, any_normal).unwrap();
            let mut cursor = 0;
            for k in 0..=100 {
                let stop = rail.at(&mut cursor, rail.length() * k as f32 / 100.0);
                assert!(stop.point.is_finite() && stop.normal.is_finite());
                assert!(stop.binormal.is_finite());
            }
        }
        let mut rail = Rail::default();
        assert_eq!(rail.rebuild(&[Vec3::ONE; 3], any_normal), Err(CurveFault::NoLength));
        assert_eq!(rail.rebuild(&[Vec3::ONE], any_normal), Err(CurveFault::TooFewPoints));
        assert_eq!(rail.rebuild(&[Vec3::ONE, Vec3::NAN], any_normal), Err(CurveFault::NotFinite));
    }
}
