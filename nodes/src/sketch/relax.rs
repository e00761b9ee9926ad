//! Repairs curves after a push: restores segment lengths, removes sharp angles, and moves CVs out of the head.
//!
//! Guarantees: CVs up to the last fixed one do not move; segments keep their lengths, except where the head leaves no
//! room; no moved CV ends below the skin, or deeper than before. Not promised: no sharp angles where the head forces
//! one.

use crate::data::route::makers::lift_exactly;
use crate::data::scalp::Skin;
use crate::maths::frame::{across, any_normal};
use crate::maths::transcendental::sin_cos;
use glam::Vec3;

/// Height of CVs above the skin, cm.
pub(super) const CLEARANCE: f32 = 0.02;
/// Cosine of the widest turn between segments: 60 degrees.
const SHARP: f32 = 0.5;
/// Rounds of smoothing angles and lengths.
const ROUNDS: usize = 3;
/// Rounds of leading a curve to a CV, which has arrived this near (cm).
const PULLS: usize = 10;
const ARRIVED: f32 = 2e-3;
/// Attempts to put a CV on the skin at its old distance from the previous one.
const TRIES: usize = 10;
/// Directions tried if that fails.
const WAYS: usize = 128;
/// A segment whose component along the skin is below this fraction of its length is stuck.
const STUCK: f32 = 0.7;

/// What a curve preserves while it is pushed.
pub(super) struct Rest {
    /// Lengths of its segments, cm.
    lengths: Vec<f32>,
    /// Height of each CV above the skin, cm: below the clearance if it was lower before.
    heights: Vec<f32>,
    held: usize,
}

impl Rest {
    /// From the current state; `held` is the last fixed CV.
    pub(super) fn of(points: &[Vec3], held: usize, skin: &Skin) -> Self {
        Self {
            lengths: points.windows(2).map(|pair| pair[0].distance(pair[1])).collect(),
            heights: points.iter().map(|p| skin.distance(*p).min(CLEARANCE)).collect(),
            held,
        }
    }
    /// For a new curve.
    pub(super) fn new(lengths: Vec<f32>, held: usize) -> Self {
        let heights = vec![CLEARANCE; lengths.len() + 1];
        Self { lengths, heights, held }
    }

    /// With the lengths of the line that the curve was before each segment `k` of it got `more[k]` CVs.
    pub(super) fn with_lengths_of(mut self, before: &[Vec3], more: &[usize]) -> Self {
        let mut lengths = &mut self.lengths[..];
        for (pair, more) in before.windows(2).zip(more) {
            let count = (more + 1).min(lengths.len());
            let (own, others) = std::mem::take(&mut lengths).split_at_mut(count);
            let share = pair[0].distance(pair[1]) / own.iter().sum::<f32>().max(1e-12);
            own.iter_mut().for_each(|length| *length *= share);
            lengths = others;
        }
        self
    }

    /// Leads the curve to a CV that was moved, without sharp angles: from there back to the last fixed one, and on to the tip. The
    /// skin is left alone.
    pub(super) fn follow(&self, points: &mut [Vec3], lead: usize) {
        let to = points[lead];
        self.blunt(points);
        for _ in 0..PULLS {
            points[lead] = to;
            for k in (self.held + 1..lead).rev() {
                let way = (points[k] - points[k + 1]).normalize_or_zero();
                points[k] = points[k + 1] + way * self.lengths[k];
            }
            for k in self.held + 1..points.len() {
                let way = (points[k] - points[k - 1]).normalize_or_zero();
                points[k] = points[k - 1] + way * self.lengths[k - 1];
            }
            if points[lead].distance(to) <= ARRIVED {
                break;
            }
        }
    }

    /// Repairs the curve.
    pub(super) fn relax(&self, points: &mut [Vec3], skin: &Skin) {
        for _ in 0..ROUNDS {
            self.blunt(points);
            self.lengthen(points, skin);
        }
        self.lift(points, skin);
    }

    /// Repairs a curve that was led without sharp angles.
    pub(super) fn settle(&self, points: &mut [Vec3], skin: &Skin) {
        self.lengthen(points, skin);
        self.lift(points, skin);
    }

    fn lift(&self, points: &mut [Vec3], skin: &Skin) {
        for (p, height) in points.iter_mut().zip(&self.heights).skip(self.held + 1) {
            *p = lift_exactly(skin, *p, *height).0;
        }
    }

    /// Only lengths, and out of the head: used while the pen moves.
    pub(super) fn lengthen(&self, points: &mut [Vec3], skin: &Skin) {
        let mut way = Vec3::ZERO;
        for k in self.held + 1..points.len() {
            let (from, length, before) = (points[k - 1], self.lengths[k - 1], way);
            way = (points[k] - from).normalize_or(way);
            points[k] = from + way * length;
            let mut free = false;
            for _ in 0..TRIES {
                let (lifted, moved) = lift_exactly(skin, points[k], self.heights[k]);
                if !moved {
                    free = true;
                    break;
                }
                let out = (lifted - points[k]).normalize_or(Vec3::Y);
                let mut to = lifted - from;
                // Straight into the head, lifting leads back: continue in the curve's direction, along the skin.
                if to.reject_from_normalized(out).length() < STUCK * length {
                    let on = across(before, out).unwrap_or_else(|| any_normal(out));
                    to += on * (0.5 * length);
                }
                way = to.normalize_or(way);
                points[k] = from + way * length;
            }
            if !free {
                way = free_way(from, way, length, self.heights[k], skin);
                points[k] = from + way * length;
            }
        }
    }

    /// Removes sharp angles.
    fn blunt(&self, points: &mut [Vec3]) {
        for k in self.held + 1..points.len().saturating_sub(1) {
            let (a, b) = (points[k] - points[k - 1], points[k + 1] - points[k]);
            if a.dot(b) < SHARP * a.length() * b.length() {
                points[k] = points[k].lerp(0.5 * (points[k - 1] + points[k + 1]), 0.5);
            }
        }
    }
}

/// The direction closest to a given one in which a segment of this length does not end inside the head, among folds and
/// behind ears as well; the given one if all directions fail.
fn free_way(from: Vec3, way: Vec3, length: f32, height: f32, skin: &Skin) -> Vec3 {
    // Evenly distributed directions: equal steps in height, each rotated by the golden angle.
    let all = (0..WAYS).map(|k| {
        let high = 1.0 - (2.0 * k as f32 + 1.0) / WAYS as f32;
        let (sin, cos) = sin_cos(2.399_963_2 * k as f32);
        let wide = (1.0 - high * high).sqrt();
        Vec3::new(wide * cos, high, wide * sin)
    });
    let mut all: Vec<Vec3> = all.collect();
    all.sort_by(|a, b| b.dot(way).total_cmp(&a.dot(way)));
    all.into_iter().find(|way| !lift_exactly(skin, from + way * length, height).1).unwrap_or(way)
}
