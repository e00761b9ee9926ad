//! What all curls of a node have in common, and the turns that are drawn from it.
//!
//! Guarantees: turn `j` of a curl is a pure function of the pattern, the curl's key and `j`. The turns of a pattern
//! after [`Pattern::evened`] have the requested mean size and pitch: exactly if they differ little, by fits to
//! measurements if they differ much. Not promised: the requested size of any single turn.

use super::profile::{ENTRIES, ProfileCurve};
use crate::maths::hash::{Dice, mix};
use crate::maths::smoothstep;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec2;

/// Settings shared by all curls of a node.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// The list's profiles, and the zigzag of Z-bends last.
    pub(crate) shapes: Vec<ProfileCurve>,
    /// The largest distance of any of them from its centre.
    pub(crate) widest: f32,
    /// Index of the profile of each entry of the shape list.
    pub(crate) list: Vec<u16>,
    /// Fractions of turns.
    pub(crate) z_bends: f32,
    pub(crate) switchbacks: f32,
    pub(crate) skipped: f32,
    /// R(A, F, P, O).
    pub(crate) ranges: [f32; 4],
    pub(crate) spread: f32,
    pub(crate) blend: f32,
    /// Direction of the first turn; `None`: random.
    pub(crate) hand: Option<f32>,
    /// Range in turns that the phase at the root is drawn from, 0 or 1, and its offset.
    pub(crate) phase_range: f32,
    pub(crate) phase: f32,
    /// Straight length at the root, cm.
    pub(crate) start: f32,
    /// Turns over which the curl grows to its full size.
    pub(crate) rise: f32,
    /// Length at the root over which turns grow from half their size and pitch, cm.
    pub(crate) sponge: f32,
    pub(crate) detail: Detail,
    /// The most CVs on a curl.
    pub(crate) most: usize,
    /// The result of [`Self::evened`].
    pub(crate) even: TurnFactors,
    pub(crate) turn_dice: Dice,
    pub(crate) curl_dice: Dice,
}

/// What sets the number of CVs.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Detail {
    /// CVs per turn of full size.
    PerTurn(f32),
    /// Largest distance of the chord between two CVs from the curl, as a fraction of the curl's radius.
    Tolerance(f32),
}

/// A turn as drawn: factors and fractions, before any curve has a size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) shape: u16,
    /// Cosine and sine of the rotation of a Z-bend's plane.
    pub(super) plane: Vec2,
    pub(super) back: bool,
    pub(super) size: f32,
    pub(super) pitch: f32,
    pub(super) phase: f32,
    pub(super) offset: Vec2,
    /// Uniform in [0, 1): decides whether a hair leaves its clump at this turn.
    pub(super) gate: f32,
}

/// Values drawn once per curl.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurlVariation {
    pub(super) hand: f32,
    pub(super) phase: f32,
    pub(super) size: f32,
    pub(super) pitch: f32,
}

/// Fraction of its size that a skipped turn keeps: not zero, since hair is never straight next to its own curls.
const SKIPPED: f32 = 0.15;
/// What offset turns add to the square of a curl's size and to its pitch, per squared offset: a fifth of their own
/// square, because the axis over ten turns follows them (over twenty turns less so: curls with an offset of 1 are then
/// measured 8 % too wide, as they are at 0.7 without this correction).
const WANDERS: [f32; 2] = [0.14, 0.05];
/// Deficit in size of a curl of large and small turns, per fourth power of their range, and excess in pitch, per
/// square: measured at 0.95, for coils of ten and of twenty turns.
const SMALL: [f32; 2] = [0.05, 0.045];
/// Measured excess in turn length where half are skipped, times four: fitted at 0.15 to 0.5.
const HALF_SKIPPED: f32 = 0.2;
/// Measured deficit in turn length of a curl that reverses at every turn, without blending: it swings back and forth
/// beside its source, and its axis with it. If it reverses at every other turn, a hundredth.
const SWINGS: f32 = 0.12;
/// Turns for which Z-bends continue, or stay away: hair kinks in runs.
const Z_RUN: u64 = 3;
/// Turns over which the plane of Z-bends rotates.
const PLANE_REACH: u64 = 7;
/// First index of the runs' and planes' random numbers among a curl's random numbers.
const RUNS: u64 = 1 << 40;
const PLANES: u64 = 1 << 41;

/// Factors between the requested values and those that turns are drawn with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TurnFactors {
    pub(super) size: f32,
    pub(super) pitch: f32,
    /// Mean size of all turns, including skipped ones, as a fraction of the requested size.
    pub(super) mean_size: f32,
}

impl Default for TurnFactors {
    fn default() -> Self {
        Self { size: 1.0, pitch: 1.0, mean_size: 1.0 }
    }
}

impl Pattern {
    /// Turn `j` of the curl with this key.
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

    /// The plane of a Z-bend at turn `j`, in turns: smooth noise, so that one zigzag leads into the next in nearly the
    /// same plane and the Zs of a hair are visible. A new plane at every turn would be a tangle.
    fn plane(&self, key: u64, j: u64) -> f32 {
        let at = |k: u64| self.curl_dice.signed(key, PLANES + k);
        let (k, x) = (j / PLANE_REACH, (j % PLANE_REACH) as f32 / PLANE_REACH as f32);
        let (a, b) = (at(k), at(k + 1));
        at(0) + 0.4 * (a + (b - a) * smoothstep(x))
    }

    /// The pattern with factors that keep the requested mean size and pitch for curls whose turns differ. The other
    /// turns do not compensate for skipped ones: they keep their size, and the mean is reported.
    ///
    /// Parts with a closed form use it. The rest models how wandering hair is measured: its axis is its mean over a few
    /// turns, not its source, and it winds around that axis less often. These are fits to the results of `coif measure`
    /// (see the constants), all of second order or more, so that small differences stay exact.
    pub(crate) fn evened(self) -> Self {
        let [size, frequency, _, offset] = self.ranges;
        let (skipped, back) = (self.skipped, self.switchbacks);
        // Two turns of sizes a and b, blended by a smoothstep w, come closer together: the mean of 2 w (1 - w) is 9/35.
        let apart = 1.0 - 9.0 / 35.0 * self.blend;
        let square = 1.0 + size * size / 3.0 * apart + WANDERS[0] * offset * offset;
        // The mean of 1 / (1 + f x) over x from -1 to 1.
        let (mut longer, mut power) = (0.0, 1.0);
        for k in 0..64 {
            longer += power / (2 * k + 1) as f32;
            power *= frequency * frequency;
        }
        // While the direction changes by a smoothstep, 5/8 of the angle is traversed, back and forth.
        let gone = 1.0 - 0.375 * self.blend * back;
        // Small turns among large ones, skipped turns and offset turns are not wound around.
        let passed = 1.0
            + SMALL[1] * size * size
            + WANDERS[1] * offset * offset
            + HALF_SKIPPED * skipped * (1.0 - skipped);
        let fourth = |x: f32| x * x * x * x;
        let swings = 1.0 + SWINGS * fourth(back) * (1.0 - fourth(self.blend));
        let even = TurnFactors {
            size: (1.0 + SMALL[0] * fourth(size)) / square.sqrt(),
            pitch: gone * swings / (longer * passed),
            mean_size: (1.0 - skipped * (1.0 - SKIPPED * SKIPPED)).sqrt(),
        };
        Self { even, ..self }
    }

    /// The most points on a curl.
    pub(super) fn most(&self) -> usize {
        self.most.max(4)
    }

    pub(super) fn start(&self, key: u64) -> CurlVariation {
        // Symmetric in scale: twice as large as often as half as large.
        let factor = |x: f32| (1.0 + 0.34 * self.spread * x) / (1.0 - 0.34 * self.spread * x);
        let signed = |index| self.curl_dice.signed(key, index);
        CurlVariation {
            hand: self.hand.unwrap_or(if signed(0) < 0.0 { 1.0 } else { -1.0 }),
            phase: self.phase_range * 0.5 * signed(1),
            size: factor(signed(2)),
            pitch: factor(signed(3)),
        }
    }
}
