//! A random walk across a hair: how frizz wanders (methods.md 6).
//!
//! Guarantees: a walk never leaves the unit disc; it hangs from the id of its hair alone; the curve through its knots is smooth and
//! stays within them.

use crate::maths::hash::Dice;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec2;

/// Fills `walk`, two longer than `steps`, with a hair's place in the unit disc at each knot, between one more value at both ends: at
/// every knot but the first it takes a step in a random direction, up to the wall and never farther than `steps` says.
#[inline]
pub(crate) fn random_walk(dice: Dice, id: u64, start: Vec2, steps: &[f32], walk: &mut [Vec2]) {
    let mut d = start;
    walk[0] = d;
    for (knot, step) in (0..).zip(steps) {
        if knot > 0 {
            // One draw for both numbers: 24 bits of it for the direction, 24 for the length.
            let bits = dice.bits(id, knot);
            let unit = |bits: u64| (bits & 0xFF_FFFF) as f32 * (1.0 / (1u32 << 24) as f32);
            let (sin, cos) = sin_cos_turns(unit(bits >> 40));
            let x = Vec2::new(cos, sin);
            let along = d.dot(x);
            let wall = (along * along + 1.0 - d.length_squared()).max(0.0).sqrt() - along;
            d += x * (unit(bits >> 8) * wall.min(*step));
        }
        walk[knot as usize + 1] = d;
    }
    if let Some(last) = walk.last_mut() {
        *last = d;
    }
}

/// Which knots count at `x` (knot number and fraction): a quadratic B-spline, which is smooth and stays within what
/// its knots span, so that a walk in a disc never leaves it. Number of the first in a list that repeats the
/// first knot before itself, and three weights that add up to one.
pub(crate) fn smooth(x: f32) -> (usize, [f32; 3]) {
    let knot = (x + 0.5).floor();
    let f = x - knot;
    let (a, c) = (0.5 * (0.5 - f) * (0.5 - f), 0.5 * (0.5 + f) * (0.5 + f));
    (knot as usize, [a, 1.0 - a - c, c])
}
