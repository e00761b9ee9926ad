//! A random walk across a hair: how frizz wanders (methods.md 6).
//!
//! Guarantees: a walk never leaves the unit disc; it hangs from the id of its hair alone; the curve through its knots is smooth and
//! stays within them.

use crate::maths::hash::Dice;
use crate::maths::lanes::sin_cos_turns as sin_cos_each;
use crate::maths::lanes::{Eight, LANES, Simd, f32x8, ops::*, pick};
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
            let (turn, unit) = drawn(dice, id, knot);
            let (sin, cos) = sin_cos_turns(turn);
            let x = Vec2::new(cos, sin);
            let along = d.dot(x);
            let wall = (along * along + 1.0 - d.length_squared()).max(0.0).sqrt() - along;
            d += x * (unit * wall.min(*step));
        }
        walk[knot as usize + 1] = d;
    }
    if let Some(last) = walk.last_mut() {
        *last = d;
    }
}

/// Direction (turns) and length of a step, each in [0, 1): 24 bits each of one draw.
#[inline(always)]
fn drawn(dice: Dice, id: u64, knot: u64) -> (f32, f32) {
    let bits = dice.bits(id, knot);
    let unit = |bits: u64| (bits & 0xFF_FFFF) as f32 * (1.0 / (1u32 << 24) as f32);
    (unit(bits >> 40), unit(bits >> 8))
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

/// [`random_walk`] for eight hairs, from the middle of the disc, with steps of at most `step`. Hair `i` has `spans[i]` steps, truncated; in
/// `walk` its last position is repeated after them.
#[inline(always)]
pub(crate) fn random_walks<S: Simd>(
    s: S,
    dice: Dice,
    ids: &[u64; LANES],
    spans: [f32; LANES],
    step: f32,
    walk: &mut Vec<[Eight; 2]>,
) {
    let counts = spans.map(|spans| spans as usize + 1);
    let most = counts.iter().fold(1, |most, count| *count.max(&most));
    walk.resize(most + 2, [Eight::default(); 2]);
    let (mut x, mut y) = (s.splat_f32x8(0.0), s.splat_f32x8(0.0));
    walk[0] = [Eight::default(); 2];
    let ends = s.load_array_f32x8(counts.map(|count| count as f32));
    for knot in 0..most {
        if knot > 0 {
            let (mut turns, mut units) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                let (turn, unit) = drawn(dice, ids[i], knot as u64);
                (turns[i], units[i]) = (turn, unit);
            }
            let (sin, cos) = sin_cos_each(s.load_array_f32x8(turns));
            let along = x * cos + y * sin;
            let square = along * along + 1.0 - (x * x + y * y);
            let square = pick(square.simd_gt(0.0), square, s.splat_f32x8(0.0));
            let wall = square.sqrt() - along;
            let most = s.splat_f32x8(step);
            let far = s.load_array_f32x8(units) * pick(wall.simd_lt(most), wall, most);
            let goes_on = ends.simd_gt(knot as f32);
            (x, y) = (pick(goes_on, x + cos * far, x), pick(goes_on, y + sin * far, y));
        }
        walk[knot + 1][0].set(x);
        walk[knot + 1][1].set(y);
    }
    walk[most + 1] = walk[most];
}

/// [`smooth`] in lanes.
#[inline(always)]
pub(crate) fn smooth_each<S: Simd>(x: f32x8<S>) -> ([usize; LANES], [f32x8<S>; 3]) {
    let knot = (x + 0.5).floor();
    let f = x - knot;
    let (a, c) = (0.5 * (0.5 - f) * (0.5 - f), 0.5 * (0.5 + f) * (0.5 + f));
    (x.simd.as_array_f32x8(knot).map(|knot| knot as usize), [a, 1.0 - a - c, c])
}
