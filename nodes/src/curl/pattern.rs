//! What all curls of a node have in common, and the turns that are drawn from it.
//!
//! Guarantees: turn `j` of a curl is a pure function of the pattern, the curl's name and `j`; a pattern that is
//! [`Pattern::evened`] draws turns which, in the mean, have the size and the pitch that are asked, exactly where they differ
//! little, by fits to what is measured where they differ much. Not promised: any one turn of the size asked.

use super::section::{ENTRIES, Shape};
use crate::maths::hash::{Dice, mix};
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec2;

/// What all curls of a node share.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// The list's shapes, and the zigzag of Z-bends last.
    pub(crate) shapes: Vec<Shape>,
    /// The farthest that any of them goes from its centre.
    pub(crate) widest: f32,
    /// Which shape each entry of the shape list is.
    pub(crate) list: Vec<u16>,
    /// Shares of turns.
    pub(crate) z_bends: f32,
    pub(crate) switchbacks: f32,
    pub(crate) skipped: f32,
    /// R(A, F, P, O).
    pub(crate) ranges: [f32; 4],
    pub(crate) spread: f32,
    pub(crate) blend: f32,
    /// Direction of the first turn; none: drawn.
    pub(crate) hand: Option<f32>,
    /// Turns that the phase at the root is drawn from, 0 or 1, and what is added.
    pub(crate) phase_range: f32,
    pub(crate) phase: f32,
    /// cm from the root that stay straight.
    pub(crate) start: f32,
    /// Turns over which the curl grows to its full size.
    pub(crate) rise: f32,
    /// cm from the root over which turns grow from half their size and pitch.
    pub(crate) sponge: f32,
    pub(crate) detail: Detail,
    /// The most CVs on a curl.
    pub(crate) most: usize,
    /// What [`Self::evened`] finds.
    pub(crate) even: Even,
    pub(crate) turn_dice: Dice,
    pub(crate) curl_dice: Dice,
}

/// What decides the number of CVs.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Detail {
    /// CVs on a turn of full size.
    PerTurn(f32),
    /// How far the chord between two CVs may lie off the curl, as a share of the curl's radius.
    Tolerance(f32),
}

/// A turn as drawn: factors and shares, before any curve has a size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) shape: u16,
    /// Cosine and sine of the angle that a Z-bend's plane is turned by.
    pub(super) plane: Vec2,
    pub(super) back: bool,
    pub(super) size: f32,
    pub(super) pitch: f32,
    pub(super) phase: f32,
    pub(super) offset: Vec2,
    /// Uniform in [0, 1): whether a hair leaves its clump at this turn.
    pub(super) gate: f32,
}

/// What is drawn once a curl.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub(super) hand: f32,
    pub(super) phase: f32,
    pub(super) size: f32,
    pub(super) pitch: f32,
}

/// How much of its size a skipped turn keeps: not none, for hair is never straight beside its own curls.
const SKIPPED: f32 = 0.15;
/// What turns that lie off the source add to the square of a curl's size and to its pitch, for the square of the offset: a
/// fifth of their own square, as the axis of ten turns follows them (that of twenty does less: then curls of an offset of 1
/// are seen 8 % wider, as they are without this of 0.7).
const WANDERS: [f32; 2] = [0.14, 0.05];
/// What a curl of large and of small turns lacks in size, for the fourth power of their range, and has too much in pitch, for
/// the square: found at 0.95, for coils of ten turns and of twenty.
const SMALL: [f32; 2] = [0.05, 0.045];
/// How much longer turns are seen to be where half are skipped, times four: found at 0.15 to 0.5.
const HALF_SKIPPED: f32 = 0.2;
/// How much shorter turns are seen to be of a curl that turns back at every turn, without blending: then it swings to and fro
/// beside its source, and its axis with it. Where it does so at every other turn, a hundredth.
const SWINGS: f32 = 0.12;
/// Turns for which Z-bends go on, or stay away: hair kinks in runs.
const Z_RUN: u64 = 3;
/// Turns over which the plane of Z-bends turns.
const PLANE_REACH: u64 = 7;
/// Where the numbers of runs and of planes begin among a curl's random numbers.
const RUNS: u64 = 1 << 40;
const PLANES: u64 = 1 << 41;

/// Factors between what is asked and what turns are drawn with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Even {
    pub(super) size: f32,
    pub(super) pitch: f32,
    /// Share of the size asked that the mean over all turns has, skipped ones too.
    pub(super) told: f32,
}

impl Default for Even {
    fn default() -> Self {
        Self { size: 1.0, pitch: 1.0, told: 1.0 }
    }
}

impl Pattern {
    /// Turn number `j` of the curl that `key` names.
    pub(crate) fn turn(&self, key: u64, j: u64) -> Turn {
        let share = |bits: u64| (bits & 0xFFFF) as f32 * (1.0 / 65_536.0);
        let signed = |bits: u64| ((bits & 0xFFF) as f32 + 0.5) * (1.0 / 2_048.0) - 1.0;
        let a = self.turn_dice.bits(key, 2 * j);
        let b = self.turn_dice.bits(key, 2 * j + 1);
        let z_bend = self.z_bends > 0.0
            && self.turn_dice.unit(key, RUNS + (j + key % Z_RUN) / Z_RUN) < self.z_bends;
        let skipped = share(a >> 44) < self.skipped;
        let [amplitude, frequency, phase, offset] = self.ranges;
        Turn {
            shape: if z_bend {
                self.shapes.len() as u16 - 1
            } else {
                self.list[(a & (ENTRIES as u64 - 1)) as usize]
            },
            plane: if z_bend {
                let (sin, cos) = sin_cos_turns(self.plane(key, j) + 0.04 * signed(mix(a)));
                Vec2::new(cos, sin)
            } else {
                Vec2::X
            },
            back: share(a >> 28) < self.switchbacks,
            size: (1.0 + amplitude * signed(b)) * if skipped { SKIPPED } else { 1.0 },
            pitch: 1.0 / (1.0 + frequency * signed(b >> 12)),
            phase: phase * signed(b >> 24),
            offset: Vec2::new(signed(b >> 36), signed(b >> 48)) * offset,
            gate: share(mix(b)),
        }
    }

    /// The plane of a Z-bend at turn `j`, in turns: smooth noise, so that one zigzag leads into the next in nearly the same
    /// plane and a hair shows its Zs. A new plane at every turn would be a tangle.
    fn plane(&self, key: u64, j: u64) -> f32 {
        let at = |k: u64| self.curl_dice.signed(key, PLANES + k);
        let (k, x) = (j / PLANE_REACH, (j % PLANE_REACH) as f32 / PLANE_REACH as f32);
        let (a, b) = (at(k), at(k + 1));
        at(0) + 0.4 * (a + (b - a) * (x * x * (3.0 - 2.0 * x)))
    }

    /// The pattern with the factors that keep, in the mean, the size and the pitch that are asked of curls whose turns differ.
    /// Turns that are skipped are none that others make up for: what the others are stays, and what is told is the mean.
    ///
    /// Parts that have a closed form are that. What is left is how hair that goes here and there is seen: its axis is where
    /// it is in the mean over a few turns, not its source, and it goes round that seldomer. These are fits to what
    /// `coif measure` finds (the constants say of what), all of second order or more: what differs little stays exact.
    pub(crate) fn evened(self) -> Self {
        let [size, frequency, _, offset] = self.ranges;
        let (skipped, back) = (self.skipped, self.switchbacks);
        // Two turns of sizes a and b, blended by a smoothstep w, are nearer to each other: the mean of 2 w (1 - w) is 9/35.
        let apart = 1.0 - 9.0 / 35.0 * self.blend;
        let square = 1.0 + size * size / 3.0 * apart + WANDERS[0] * offset * offset;
        // The mean of 1 / (1 + f x) over x from -1 to 1.
        let (mut longer, mut power) = (0.0, 1.0);
        for k in 0..64 {
            longer += power / (2 * k + 1) as f32;
            power *= frequency * frequency;
        }
        // While the direction changes by a smoothstep, 5 parts of 8 of the angle are gone, to and fro.
        let gone = 1.0 - 0.375 * self.blend * back;
        // Small turns among large ones, skipped ones and those off to the side are not gone round.
        let passed = 1.0
            + SMALL[1] * size * size
            + WANDERS[1] * offset * offset
            + HALF_SKIPPED * skipped * (1.0 - skipped);
        let fourth = |x: f32| x * x * x * x;
        let swings = 1.0 + SWINGS * fourth(back) * (1.0 - fourth(self.blend));
        let even = Even {
            size: (1.0 + SMALL[0] * fourth(size)) / square.sqrt(),
            pitch: gone * swings / (longer * passed),
            told: (1.0 - skipped * (1.0 - SKIPPED * SKIPPED)).sqrt(),
        };
        Self { even, ..self }
    }

    /// The most points on a curl.
    pub(super) fn most(&self) -> usize {
        self.most.max(4)
    }

    pub(super) fn start(&self, key: u64) -> Start {
        // Symmetric in scale: as often twice as large as half.
        let factor = |x: f32| (1.0 + 0.34 * self.spread * x) / (1.0 - 0.34 * self.spread * x);
        let signed = |index| self.curl_dice.signed(key, index);
        Start {
            hand: self.hand.unwrap_or(if signed(0) < 0.0 { 1.0 } else { -1.0 }),
            phase: self.phase_range * 0.5 * signed(1),
            size: factor(signed(2)),
            pitch: factor(signed(3)),
        }
    }
}
