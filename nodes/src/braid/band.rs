//! The band that ties a braid: a lock or an elastic wound around its hair where the end tuft begins.
//!
//! Guarantees: turns lie side by side on the hair of the strands, at its width there, over the requested height or, if
//! the braid or tuft is too short for that, over as much of it as they hold, which is reported; out of the skin. Not
//! promised: that the band holds single hairs that stand off.

use super::tube::{Braid, Tube};
use crate::data::route::makers::lift;
use crate::data::scalp::Skin;
use crate::maths::frame::{across, any_normal};
use crate::maths::smoothstep;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// Settings of bands. Lengths in cm.
#[derive(Clone, Copy)]
pub(super) struct Band {
    turns: f32,
    height: f32,
    /// How much the band narrows the braid.
    narrower: f32,
}

/// CVs per turn.
const OF_TURN: f32 = 16.0;
/// Height of the band's centre above the hair, in its radii: soft things pressed together.
const PRESSED: f32 = 0.6;
/// Distance from its centre over which a band draws hair together, in its heights.
const DRAWN: f32 = 1.5;
/// Distance of its centre behind the tie, in its heights: behind the last crossing, which it leaves unchanged.
const BEHIND: f32 = 1.0;

impl Band {
    /// `None` for no turns; a band has at least one.
    pub(super) fn new(turns: f32, height: f32, narrower: f32) -> Option<Self> {
        (turns > 0.0).then_some(Self { turns: turns.max(1.0), height, narrower })
    }

    /// Fraction of its width that the braid keeps at this distance (cm) from the centre of its band.
    pub(super) fn keeps(&self, waist: &Waist, along: f32) -> f32 {
        let left = (DRAWN - along.abs() / waist.height.max(1e-6)).clamp(0.0, 1.0);
        1.0 - self.narrower * smoothstep(left)
    }

    /// Centre line of a braid of these strands, as far as the band extends.
    pub(super) fn waist(&self, tubes: &[Tube], step: f32) -> Waist {
        let room = |most: f32, of: f32| most.min(of.floor().max(0.0));
        let before = tubes.iter().fold(f32::MAX, |most, t| room(most, t.tie));
        let behind = tubes.iter().fold(f32::MAX, |most, t| room(most, t.last() - t.tie));
        let middle = |k: f32| {
            tubes.iter().map(|t| t.section(t.tie + k).centre).sum::<Vec3>() / tubes.len() as f32
        };
        // From the tie on, up to this many heights of the band.
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

    /// The centre line of the band around a braid, its radius, and the front of the braid there; `None` if it has
    /// nothing to hold.
    pub(super) fn round(
        &self,
        braid: &Braid,
        skin: Option<&Skin>,
    ) -> Option<(Vec<Vec3>, f32, Vec3)> {
        let waist = braid.waist.as_ref().filter(|waist| waist.height > 0.0)?;
        // This many turns side by side are one thickness higher.
        let radius = 0.5 * waist.height / (self.turns + 1.0);
        let rise = waist.height - 2.0 * radius;
        let front = braid.tubes[0].front(braid.tubes[0].tie);
        let half = 0.5 * waist.height;
        let axis = (waist.at(half).0 - waist.at(-half).0).normalize_or(Vec3::NEG_Y);
        let ahead = across(front, axis).unwrap_or_else(|| any_normal(axis));
        let right = axis.cross(ahead);
        let clear = |p: Vec3| skin.map_or(p, |skin| lift(skin, p, radius).0);
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

/// Centre line of a braid near the band that ties it.
pub(super) struct Waist {
    /// At integer steps of the strands: the centre, and its distance (cm) behind the centre of the band.
    at: Vec<(Vec3, f32)>,
    /// The first of these steps, from the tie.
    first: f32,
    /// Height of the band, cm: the requested one, or what braid and tuft hold.
    height: f32,
    pub(super) limited: bool,
}

impl Waist {
    /// The centre this many steps behind the tie, and its distance (cm) behind the centre of the band; `None` outside
    /// the band's influence.
    pub(super) fn at_step(&self, beyond: f32) -> Option<(Vec3, f32)> {
        let x = beyond - self.first;
        let k = x as usize;
        (x >= 0.0 && k + 1 < self.at.len()).then(|| {
            let ((p, s), (q, t)) = (self.at[k], self.at[k + 1]);
            let f = x - k as f32;
            (p.lerp(q, f), s + (t - s) * f)
        })
    }

    /// The centre at this distance (cm) behind that of the band, and its number of steps behind the tie.
    fn at(&self, along: f32) -> (Vec3, f32) {
        let after = self.at.partition_point(|(_, s)| *s <= along);
        let k = after.clamp(1, self.at.len().max(2) - 1) - 1;
        let (p, s) = self.at[k];
        let (q, t) = self.at.get(k + 1).copied().unwrap_or((p, s));
        let f = if t > s { ((along - s) / (t - s)).clamp(0.0, 1.0) } else { 0.0 };
        (p.lerp(q, f), self.first + k as f32 + f)
    }
}
