//! The band that ties a braid: a lock or an elastic wound round its hair where the tuft begins.
//!
//! Guarantees: turns lie beside each other on the hair of the strands, as wide as it is there, over the height asked for or, where
//! braid or tuft are too short for that, over as much of it as they hold, which is told; out of the skin. Not promised: that single
//! hairs that stand off are held by it.

use super::tube::{Braid, Tube};
use crate::data::scalp::Skin;
use crate::maths::frame::{across, any_normal};
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// What is asked of bands. Lengths in cm.
#[derive(Clone, Copy)]
pub(super) struct Band {
    turns: f32,
    height: f32,
    /// How much narrower the braid is in it.
    narrower: f32,
}

/// Points of a turn.
const OF_TURN: f32 = 16.0;
/// How far the band's middle lies over the hair, in its radii: soft things pressed together.
const PRESSED: f32 = 0.6;
/// How far from its middle a band draws hair together, in its heights.
const DRAWN: f32 = 1.5;
/// How far behind the tie its middle lies, in its heights: behind the last crossing, which it leaves as it is.
const BEHIND: f32 = 1.0;

impl Band {
    /// None of no turns; a band has one at least.
    pub(super) fn asked(turns: f32, height: f32, narrower: f32) -> Option<Self> {
        (turns > 0.0).then_some(Self { turns: turns.max(1.0), height, narrower })
    }

    /// How much of its width the braid keeps so far (cm) from the middle of its band.
    pub(super) fn keeps(&self, waist: &Waist, along: f32) -> f32 {
        let left = (DRAWN - along.abs() / waist.height.max(1e-6)).clamp(0.0, 1.0);
        1.0 - self.narrower * (left * left * (3.0 - 2.0 * left))
    }

    /// The middle of a braid of these strands, as far as the band counts.
    pub(super) fn waist(&self, tubes: &[Tube], step: f32) -> Waist {
        let room = |most: f32, of: f32| most.min(of.floor().max(0.0));
        let before = tubes.iter().fold(f32::MAX, |most, t| room(most, t.tie));
        let behind = tubes.iter().fold(f32::MAX, |most, t| room(most, t.last() - t.tie));
        let middle = |k: f32| {
            tubes.iter().map(|t| t.section(t.tie + k).centre).sum::<Vec3>() / tubes.len() as f32
        };
        // From the tie on, to so many heights of the band.
        let side = |steps: f32, sign: f32, heights: f32| {
            let mut at = vec![(middle(0.0), 0.0)];
            for k in 1..=steps as usize {
                let (last, along): (Vec3, f32) = at[k - 1];
                if along.abs() >= heights * self.height + step {
                    break;
                }
                let next = middle(sign * k as f32);
                at.push((next, along + sign * next.distance(last)));
            }
            let room = at[at.len() - 1].1.abs() / heights;
            (at, room)
        };
        let (mut at, over) = side(before, -1.0, DRAWN - BEHIND);
        let (after, under) = side(behind, 1.0, DRAWN + BEHIND);
        let height = self.height.min(over.min(under));
        let first = 1.0 - at.len() as f32;
        at.reverse();
        at.extend(&after[1..]);
        at.iter_mut().for_each(|(_, along)| *along -= BEHIND * height);
        Waist { at, first, height, limited: height < self.height }
    }

    /// The line of the band round a braid, its radius, and the front of the braid there; none where it has nothing to hold.
    pub(super) fn round(
        &self,
        braid: &Braid,
        skin: Option<&Skin>,
    ) -> Option<(Vec<Vec3>, f32, Vec3)> {
        let waist = braid.waist.as_ref().filter(|waist| waist.height > 0.0)?;
        // So many turns beside each other are one more thickness high.
        let radius = 0.5 * waist.height / (self.turns + 1.0);
        let rise = waist.height - 2.0 * radius;
        let front = braid.tubes[0].front(braid.tubes[0].tie);
        let half = 0.5 * waist.height;
        let axis = (waist.at(half).0 - waist.at(-half).0).normalize_or(Vec3::NEG_Y);
        let ahead = across(front, axis).unwrap_or_else(|| any_normal(axis));
        let right = axis.cross(ahead);
        let clear = |p: Vec3| skin.map_or(p, |skin| skin.lift(p, radius).0);
        let steps = (self.turns * OF_TURN).ceil() as usize;
        // Its ends are tucked under it.
        let mut points = vec![clear(waist.at(-0.5 * rise).0)];
        points.extend((0..=steps).map(|k| {
            let t = k as f32 / steps as f32;
            let (middle, beyond) = waist.at((t - 0.5) * rise);
            let (x, y) = sin_cos_turns(self.turns * t);
            let out = right * x + ahead * y;
            clear(middle + out * (braid.reach(middle, beyond, out) + PRESSED * radius))
        }));
        points.push(clear(waist.at(0.5 * rise).0));
        points.iter().all(|p| p.is_finite()).then_some((points, radius, front))
    }
}

/// The middle of a braid about the band that ties it.
pub(super) struct Waist {
    /// At whole steps of the strands: the middle, and how far (cm) along it that is behind the middle of the band.
    at: Vec<(Vec3, f32)>,
    /// The first of these steps, from the tie.
    first: f32,
    /// Height of the band, cm: what was asked for, or what braid and tuft hold.
    height: f32,
    pub(super) limited: bool,
}

impl Waist {
    /// The middle so many steps behind the tie, and how far (cm) behind the middle of the band that is; none beyond what the band counts for.
    pub(super) fn at_step(&self, beyond: f32) -> Option<(Vec3, f32)> {
        let x = beyond - self.first;
        let k = x as usize;
        (x >= 0.0 && k + 1 < self.at.len()).then(|| {
            let ((p, s), (q, t)) = (self.at[k], self.at[k + 1]);
            let f = x - k as f32;
            (p.lerp(q, f), s + (t - s) * f)
        })
    }

    /// The middle so far (cm) behind that of the band, and how many steps behind the tie that is.
    fn at(&self, along: f32) -> (Vec3, f32) {
        let after = self.at.partition_point(|(_, s)| *s <= along);
        let k = after.clamp(1, self.at.len().max(2) - 1) - 1;
        let (p, s) = self.at[k];
        let (q, t) = self.at.get(k + 1).copied().unwrap_or((p, s));
        let f = if t > s { ((along - s) / (t - s)).clamp(0.0, 1.0) } else { 0.0 };
        (p.lerp(q, f), self.first + k as f32 + f)
    }
}
