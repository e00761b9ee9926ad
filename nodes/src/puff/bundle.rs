//! Hair continued past its tie as one bundle: tails and buns.
//!
//! A bundle runs along a course, a centre line with frames. Every hair keeps its place across the course, in radii of
//! the bundle; locks draw their hairs together toward the tips and move slightly on their own.
//!
//! Guarantees: hair keeps its root and its path to the tie, to less than a millimetre where it bends, and all its
//! attributes; no point below the skin; nothing depends on the number of hairs. Not promised: even points where hair on
//! the inside of a narrow arch turns about itself.

use super::tie::Tie;
use crate::data::attribute_transfer::{CvPlace, carry};
use crate::data::attributes::{Domain, FIBRE, ID, PARENT, PUFF};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::ramp::Ramp;
use crate::data::route::makers::lift_drawn;
use crate::data::scalp::Skin;
use crate::define::NodeError;
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::frame::{across, any_normal, reflect_twice};
use crate::maths::hash::{Dice, curve_id};
use crate::maths::low_discrepancy::disc;
use crate::maths::smoothstep;
use crate::maths::transcendental::sin_cos_turns;
use glam::{Vec2, Vec3};

/// Spacing of the samples of a course, cm.
pub(super) const STEP: f32 = 0.2;
/// The most locks of a bundle.
pub(super) const MOST_LOCKS: i64 = 400;

/// Centre line of a bundle from its tie on, with frames, at even steps.
pub(super) struct Course {
    /// Centre, and two axes across; azimuth 0 is the first.
    at: Vec<(Vec3, Vec3, Vec3)>,
    /// Length of a step, cm.
    step: f32,
}

impl Course {
    /// The course through these points; its frames start with that of the tie.
    pub(super) fn new(tie: &Tie, points: &[Vec3]) -> Self {
        let step = points.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>()
            / (points.len().max(2) - 1) as f32;
        let mut at: Vec<(Vec3, Vec3, Vec3)> = Vec::with_capacity(points.len());
        let mut last: Option<(Vec3, Vec3, Vec3)> = None;
        for (i, p) in points.iter().enumerate() {
            let (before, after) =
                (points[i.saturating_sub(1)], points[(i + 1).min(points.len() - 1)]);
            let tangent = (after - before).normalize_or(tie.axis);
            let normal = match last {
                None => across(tie.right, tangent).unwrap_or_else(|| any_normal(tangent)),
                Some((q, normal, from)) => reflect_twice(normal, *p - q, from, tangent),
            };
            last = Some((*p, normal, tangent));
            at.push((*p, normal, tangent.cross(normal)));
        }
        Self { at, step: step.max(1e-6) }
    }
    /// Centre and axes at `s` cm from the tie; past the end, those of the end.
    #[inline]
    fn at(&self, s: f32) -> (Vec3, Vec3, Vec3) {
        let x = (s / self.step).max(0.0);
        let k = (x as usize).min(self.at.len().saturating_sub(2));
        let f = (x - k as f32).min(1.0);
        let (Some(a), Some(b)) = (self.at.get(k), self.at.get(k + 1)) else {
            return (Vec3::ZERO, Vec3::X, Vec3::Y);
        };
        (a.0.lerp(b.0, f), a.1.lerp(b.1, f), a.2.lerp(b.2, f))
    }
}

/// Layout of a bundle along its course.
pub(super) struct Bundle<'a> {
    /// Ties and courses, by tie.
    pub ties: Vec<(Tie, Course)>,
    pub skin: Skin<'a>,
    /// Length beyond the tie, cm.
    pub length: f32,
    /// Fraction of the path to the tie that shortens hair beyond it.
    pub layers: f32,
    /// Largest shortening of locks and hairs, as a fraction of the length.
    pub uneven: f32,
    /// Radius along the bundle, in radii of the tie, by fraction of `length`.
    pub profile: &'a Ramp,
    /// Twist of the bundle about its course, degrees per cm.
    pub twist: f32,
    pub locks: usize,
    /// How far hairs are drawn to the centre of their lock at its tip.
    pub clump: f32,
    /// Largest random offset of locks and hairs, cm.
    pub loose: f32,
    /// Points per hair.
    pub points: usize,
    pub dice: Dice,
    pub seed: i64,
}

/// Chords within this ratio are even: where a hair bends sharply, as around a tie, all readers then interpret its
/// points alike (`maths/catmull_rom_agreement.rs`).
const EVEN: f32 = 1.02;
/// Rounds of adjustment.
const ROUNDS: usize = 5;

/// One lock: its place across the bundle, and its deviations.
struct Lock {
    id: u64,
    middle: Vec2,
    shorter: f32,
    phase: [f32; 2],
}

impl Bundle<'_> {
    /// Continues hair past its ties. Hair without a tie passes through unchanged.
    pub(super) fn go_on(&self, cx: &EvalCx, hair: &Curves) -> Result<Curves, NodeError> {
        let size = [("hairs", hair.curve_count() as f64), ("points", self.points as f64)];
        cx.may_make(&Size::of(&size))?;
        let locks: Vec<Vec<Lock>> =
            self.ties.iter().map(|(tie, _)| self.locks_of(tie.id)).collect();
        let [out] = cx.each_tuft(hair, |tuft, piece| Ok([self.tuft(tuft, &locks, piece)?]))?;
        Ok(out)
    }

    fn locks_of(&self, tie: u64) -> Vec<Lock> {
        let shift = [self.dice.unit(tie, 0), self.dice.unit(tie, 1)];
        let lock = |k: usize| {
            let id = curve_id(tie, self.seed as u64, (1 << 42) | k as u64);
            Lock {
                id,
                middle: Vec2::from(disc(k as u32, shift)),
                shorter: self.uneven * self.dice.unit(id, 0),
                phase: [self.dice.unit(id, 1), self.dice.unit(id, 2)],
            }
        };
        (0..self.locks).map(lock).collect()
    }

    fn tuft(&self, tuft: &Tuft, locks: &[Vec<Lock>], piece: &mut Piece) -> Result<Tuft, NodeError> {
        let of = tuft.view(PUFF);
        let mut out = TuftBuilder::new();
        let (mut parents, mut lengths) = (vec![], vec![]);
        let kept: Vec<u32> = (0..tuft.len() as u32).collect();
        let mut points: Vec<Vec3> = vec![];
        let mut places: Vec<CvPlace> = vec![];
        for i in 0..tuft.len() {
            piece.tick()?;
            let (id, range) = (tuft.id(i), tuft.range(i));
            let belongs = of.at(i, range.start);
            let tie = self.ties.iter().position(|(tie, _)| tie.id == belongs);
            let mut parent = tuft.view(PARENT).at(i, range.start);
            let base = tuft.curve(i);
            match tie.filter(|_| base.len() >= 2) {
                Some(t) => {
                    let (tied, locks) = (&self.ties[t], &locks[t][..]);
                    parent = self.hair(id, base, (tied, locks), &mut points, parent);
                    if points.iter().any(|p| !p.is_finite()) {
                        points.clear();
                        points.extend_from_slice(base);
                        piece
                            .trouble(id, "hair too far away to go on from a tie was left as it is");
                    }
                }
                None => {
                    points.clear();
                    points.extend_from_slice(base);
                    piece.trouble(id, "hair that belongs to none of the ties was left as it is");
                }
            }
            // Point values move along in proportion to the number of points.
            let (old, new) = (range.len().max(1) - 1, points.len().max(2) - 1);
            places.extend((0..points.len()).map(|k| {
                let before = (k * old / new).min(old.max(1) - 1);
                let t = (k * old - before * new) as f32 / new as f32;
                ((range.start + before) as u32, t)
            }));
            let whole: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
            lengths.push(whole);
            parents.push(parent);
            out.push_curve(&points);
        }
        carry(tuft, &kept, &places, &mut out);
        if self.locks > 0 {
            out.set(PARENT, Domain::Curve, parents);
        }
        out.set(FIBRE, Domain::Curve, lengths);
        if tuft.attribute(ID.name).is_none() {
            out.set(ID, Domain::Curve, vec![tuft.id(0)]);
        }
        Ok(out.build())
    }

    /// Extends a hair that ends at its tie, with points evenly spaced from root to tip; returns the id of its lock, or
    /// `parent` if there are no locks.
    fn hair(
        &self,
        id: u64,
        base: &[Vec3],
        ((tie, course), locks): (&(Tie, Course), &[Lock]),
        points: &mut Vec<Vec3>,
        parent: u64,
    ) -> u64 {
        let Some(end) = base.last().copied() else { return parent };
        let held: f32 = base.windows(2).map(|w| w[0].distance(w[1])).sum();
        let place = tie.place(end);
        let nearest = locks.iter().min_by(|a, b| {
            let d = |l: &Lock| l.middle.distance_squared(place);
            d(a).total_cmp(&d(b))
        });
        let (shorter, middle, phase) =
            nearest.map_or((0.0, place, [0.0; 2]), |l| (l.shorter, l.middle, l.phase));
        let own = 1.0 - 0.3 * self.uneven * self.dice.unit(id, 3);
        let length = (self.length - self.layers * held) * (1.0 - shorter) * own;
        let length = length.max(0.08 * self.length);
        let apart = [self.dice.unit(id, 4), self.dice.unit(id, 5)];
        let past = |s: f32| {
            let u = s / length;
            let (centre, x, y) = course.at(s);
            let radius = tie.radius * self.profile.at(s / self.length);
            let grown = smoothstep(u);
            let mut q = place.lerp(middle, self.clump * grown);
            if self.twist != 0.0 {
                let (sin, cos) = sin_cos_turns(self.twist * s * (1.0 / 360.0));
                q = Vec2::new(q.x * cos - q.y * sin, q.x * sin + q.y * cos);
            }
            let mut off = q * radius;
            if self.loose > 0.0 {
                // Waves of two lengths, one shared by the lock and a smaller one of the hair's own.
                let wave = |p: f32, l: f32| sin_cos_turns(p + s / l).0;
                let shared = Vec2::new(wave(phase[0], 13.0), wave(phase[1], 17.0));
                let single = Vec2::new(wave(apart[0], 7.0), wave(apart[1], 9.0));
                let free = (s * 0.15).min(1.0);
                off += (shared + single * 0.4) * (self.loose * free);
            }
            centre + x * off.x + y * off.y
        };
        let last = self.points - 1;
        let step = (held + length) / last as f32;
        let mut stops: Vec<f32> = (0..=last).map(|n| step * n as f32).collect();
        // On the inside of an arch the course is longer than the hair, so that even steps along it are not even along
        // the hair. Where a hair turns about itself they never are, and more rounds may be worse: the best one is kept.
        let (mut best, mut round) = (None, vec![]);
        for _ in 0..ROUNDS {
            let mut walk = Walk::new(base);
            let at = |s: &f32| if *s >= held { past(*s - held) } else { walk.at(*s) };
            round.clear();
            round.push(base[0]);
            round.extend(stops[1..].iter().map(at));
            let ratio = even_stops(&round, &mut stops);
            if best.is_some_and(|best| ratio >= best) {
                break;
            }
            best = Some(ratio);
            std::mem::swap(points, &mut round);
            if ratio < EVEN {
                break;
            }
        }
        let whole = 1..points.len();
        // Its points stay at their stops: spaced anew, they would leave the way to the tie.
        lift_drawn(&self.skin, points, whole, |_| 0.0);
        nearest.map_or(parent, |l| l.id)
    }
}

/// Moves the points along a hair to where chords would be equal; returns the ratio of the longest to the shortest chord
/// before the move.
fn even_stops(points: &[Vec3], stops: &mut [f32]) -> f32 {
    let chord = |k: usize| points[k].distance(points[k + 1]);
    let last = points.len() - 1;
    let (mut whole, mut least, mut most) = (0.0f32, f32::MAX, 0.0f32);
    for c in (0..last).map(chord) {
        (whole, least, most) = (whole + c, least.min(c), most.max(c));
    }
    let (mut k, mut passed, mut link) = (0, 0.0, chord(0));
    let were = stops.to_vec();
    for (n, stop) in stops.iter_mut().enumerate().take(last).skip(1) {
        let wanted = whole * n as f32 / last as f32;
        while k + 1 < last && passed + link < wanted {
            (k, passed) = (k + 1, passed + link);
            link = chord(k);
        }
        let part = ((wanted - passed) / link.max(1e-6)).clamp(0.0, 1.0);
        *stop = were[k] + (were[k + 1] - were[k]) * part;
    }
    most / least.max(1e-9)
}

/// A walk along a line, starting at its root.
struct Walk<'a> {
    line: &'a [Vec3],
    k: usize,
    passed: f32,
    link: f32,
}

impl<'a> Walk<'a> {
    /// A walk along a line of two points or more.
    fn new(line: &'a [Vec3]) -> Self {
        Self { line, k: 1, passed: 0.0, link: line[0].distance(line[1]) }
    }
    /// The point `s` cm along the line; `s` must not decrease between calls.
    fn at(&mut self, s: f32) -> Vec3 {
        while self.k + 1 < self.line.len() && self.passed + self.link < s {
            self.passed += self.link;
            self.k += 1;
            self.link = self.line[self.k - 1].distance(self.line[self.k]);
        }
        let t = ((s - self.passed) / self.link.max(1e-6)).clamp(0.0, 1.0);
        between(self.line, self.k, t)
    }
}

/// A point between points `k - 1` and `k` of an evenly spaced line, on the cubic through the adjacent points.
fn between(line: &[Vec3], k: usize, t: f32) -> Vec3 {
    let (p1, p2) = (line[k - 1], line[k]);
    let p0 = if k >= 2 { line[k - 2] } else { p1 * 2.0 - p2 };
    let p3 = line.get(k + 1).copied().unwrap_or(p2 * 2.0 - p1);
    let (m1, m2) = ((p2 - p0) * 0.5, (p3 - p1) * 0.5);
    let (t2, t3) = (t * t, t * t * t);
    p1 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + m1 * (t3 - 2.0 * t2 + t)
        + p2 * (3.0 * t2 - 2.0 * t3)
        + m2 * (t3 - t2)
}
