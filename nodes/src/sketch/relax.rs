//! Curves set right after they were pushed: segments as long as they were, no sharp angles, out of the head.
//!
//! Guarantees: CVs up to the last that holds its place do not move; segments keep their lengths, but where the head leaves no room;
//! no moved CV ends under the skin, or deeper than it was. Not promised: that no angle is sharp where the head makes it so.

use crate::data::scalp::Skin;
use crate::maths::frame::{across, any_normal};
use glam::Vec3;

/// Over the skin by so much (cm) CVs are kept.
pub(super) const CLEARANCE: f32 = 0.02;
/// The cosine of the widest turn from segment to segment: 60 degrees.
const SHARP: f32 = 0.5;
/// Rounds in which angles and lengths are evened.
const ROUNDS: usize = 3;
/// Tries to put a CV on the skin as far from the last as it was.
const TRIES: usize = 10;
/// A segment that leads along the skin by less than this part of itself is stuck in it.
const STUCK: f32 = 0.7;

/// What a curve keeps while it is pushed about.
pub(super) struct Rest {
    /// Lengths of its segments, cm.
    lengths: Vec<f32>,
    /// How far over the skin each CV stays, cm: less than the clearance where it lay lower.
    heights: Vec<f32>,
    held: usize,
}

impl Rest {
    /// As it is now; `held` is the last CV that holds its place.
    pub(super) fn of(points: &[Vec3], held: usize, skin: &Skin) -> Self {
        Self {
            lengths: points.windows(2).map(|pair| pair[0].distance(pair[1])).collect(),
            heights: points.iter().map(|p| skin.distance(*p).min(CLEARANCE)).collect(),
            held,
        }
    }
    /// For a curve that is new.
    pub(super) fn new(lengths: Vec<f32>, held: usize) -> Self {
        let heights = vec![CLEARANCE; lengths.len() + 1];
        Self { lengths, heights, held }
    }

    /// Sets the curve right.
    pub(super) fn relax(&self, points: &mut [Vec3], skin: &Skin) {
        for _ in 0..ROUNDS {
            self.blunt(points);
            self.lengthen(points, skin);
        }
        for (p, height) in points.iter_mut().zip(&self.heights).skip(self.held + 1) {
            *p = skin.lift(*p, *height).0;
        }
    }

    /// Lengths alone, and out of the head: what is done while the pen moves.
    pub(super) fn lengthen(&self, points: &mut [Vec3], skin: &Skin) {
        let mut way = Vec3::ZERO;
        for k in self.held + 1..points.len() {
            let (from, length, before) = (points[k - 1], self.lengths[k - 1], way);
            way = (points[k] - from).normalize_or(way);
            points[k] = from + way * length;
            for _ in 0..TRIES {
                let (lifted, moved) = skin.lift(points[k], self.heights[k]);
                if !moved {
                    break;
                }
                let out = (lifted - points[k]).normalize_or(Vec3::Y);
                let mut to = lifted - from;
                // Straight into the head lifting leads back: it goes on as the curve did, over the skin.
                if to.reject_from_normalized(out).length() < STUCK * length {
                    let on = across(before, out).unwrap_or_else(|| any_normal(out));
                    to += on * (0.5 * length);
                }
                way = to.normalize_or(way);
                points[k] = from + way * length;
            }
        }
    }

    /// Takes sharp angles out.
    fn blunt(&self, points: &mut [Vec3]) {
        for k in self.held + 1..points.len().saturating_sub(1) {
            let (a, b) = (points[k] - points[k - 1], points[k + 1] - points[k]);
            if a.dot(b) < SHARP * a.length() * b.length() {
                points[k] = points[k].lerp(0.5 * (points[k - 1] + points[k + 1]), 0.5);
            }
        }
    }
}
