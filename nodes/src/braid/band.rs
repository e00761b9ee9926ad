//! The band that ties a braid: a lock or an elastic wound round its hair where the tuft begins.
//!
//! Guarantees: it lies on the hair of the braid's strands as wide as they are there, turn beside turn over the height asked for,
//! and out of the skin. Not promised: that single hairs that stand off are held by it.

use super::tube::Braid;
use crate::data::scalp::Skin;
use crate::maths::frame::{across, any_normal};
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// What is asked of a band. Lengths in cm.
pub(super) struct Band {
    pub(super) turns: f32,
    pub(super) height: f32,
}

/// Points of a turn.
const OF_TURN: f32 = 16.0;
/// How far apart turns and hair lie, in radii of the band: round things pressed together.
const PRESSED: f32 = 0.6;

impl Band {
    /// Radius of what is wound, cm: turns lie beside each other.
    pub(super) fn radius(&self) -> f32 {
        0.5 * self.height / self.turns.max(1.0)
    }

    /// The line of the band round a braid, and the front of the braid there; none where it has no tuft to hold.
    pub(super) fn round(&self, braid: &Braid, skin: Option<&Skin>) -> Option<(Vec<Vec3>, Vec3)> {
        if self.turns <= 0.0 || self.height <= 0.0 || braid.brush.is_empty() {
            return None;
        }
        let thick = self.radius();
        let steps = (self.turns * OF_TURN).ceil() as usize;
        let (height, front) = (self.height - 2.0 * thick, braid.tubes[0].front(braid.tubes[0].tie));
        let (start, end) = (braid.middle(-0.5 * height), braid.middle(0.5 * height));
        let axis = (end - start).try_normalize().unwrap_or_else(|| {
            (braid.middle(0.5 * self.height) - braid.middle(-0.5 * self.height))
                .normalize_or(Vec3::NEG_Y)
        });
        let ahead = across(front, axis).unwrap_or_else(|| any_normal(axis));
        let right = axis.cross(ahead);
        // Its ends are tucked under it.
        let mut points = vec![start];
        points.extend((0..=steps).map(|k| {
            let t = k as f32 / steps as f32;
            let along = (t - 0.5) * height;
            let (x, y) = sin_cos_turns(self.turns * t);
            let out = right * x + ahead * y;
            let p = braid.middle(along) + out * (braid.reach(along, out) + PRESSED * thick);
            skin.map_or(p, |skin| skin.lift(p, thick).0)
        }));
        points.push(end);
        Some((points, front))
    }
}
