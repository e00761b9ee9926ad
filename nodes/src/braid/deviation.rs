//! Random deviation of hairs in a braid: wandering inside their strand, and leaving it as flyaways.

use super::hair_path::Manner;
use super::tube::{Tube, place};
use crate::maths::hash::Dice;
use crate::maths::smoothstep;
use glam::{Vec2, Vec3};

/// A hair that has left its braid.
#[derive(Clone, Copy)]
pub(super) struct Flyaway {
    from: Vec3,
    along: Vec3,
    out: Vec3,
    length: f32,
}

impl Flyaway {
    pub(super) fn new(tube: &Tube, from: f32, q: Vec2, end: f32) -> Self {
        let section = tube.section(from);
        let out = (section.x * q.x + section.y * q.y).normalize_or(section.y.normalize_or(Vec3::Y));
        let p = place(&section, q);
        let before = place(&tube.section(from - 1.0), q);
        let scale = p.distance(before).max(1e-4);
        Self { from: p, along: (p - before) / scale, out, length: (end - from).max(1.0) * scale }
    }
    pub(super) fn at(&self, s: f32, manner: &Manner, id: u64) -> Vec3 {
        let x = (s / self.length.max(1e-4)).min(1.0);
        let lift = manner.dice.range(id, 7, 0.15, 0.7);
        let bend = 0.6 * manner.dice.signed(id, 8);
        let aside = self.along.cross(self.out);
        self.from + self.along * (s * (1.0 - 0.2 * x)) + (self.out * lift + aside * bend) * (s * x)
    }
}

/// A hair's slow wandering in the cross-section.
pub(super) struct CrossSectionWalk {
    dice: Dice,
    id: u64,
    amount: f32,
    per_step: f32,
    knot: u64,
    from: Vec2,
    to: Vec2,
    loose: Vec2,
}

/// Wavelength of the wandering, cm.
const WANDER: f32 = 0.9;

impl CrossSectionWalk {
    pub(super) fn new(manner: &Manner, id: u64, step: f32) -> Self {
        let at = |index: u64| {
            Vec2::new(manner.dice.signed(id, index), manner.dice.signed(id, index + 1))
        };
        Self {
            dice: manner.dice,
            id,
            amount: manner.frizz,
            per_step: step / (WANDER * manner.unit),
            knot: u64::MAX,
            from: Vec2::ZERO,
            to: Vec2::ZERO,
            loose: at(10),
        }
    }
    #[inline]
    pub(super) fn at(&mut self, t: f32) -> Vec2 {
        if self.amount <= 0.0 {
            return Vec2::ZERO;
        }
        let x = t * self.per_step;
        let knot = x as u64;
        if knot != self.knot {
            let at = |k: u64| {
                let bits = self.dice.bits(self.id, k.wrapping_add(100));
                let unit =
                    |bits: u64| (bits & 0xFF_FFFF) as f32 * (2.0 / (1u32 << 24) as f32) - 1.0;
                Vec2::new(unit(bits), unit(bits >> 32)) * self.amount
            };
            self.from = if self.knot.wrapping_add(1) == knot { self.to } else { at(knot) };
            self.to = at(knot.wrapping_add(1));
            self.knot = knot;
        }
        self.from + (self.to - self.from) * smoothstep(x - knot as f32)
    }
    /// A direction that stays constant.
    pub(super) fn loose(&self) -> Vec2 {
        self.loose
    }
}
