//! Winds one source curve into a curl: turns drawn by hashes, each blended into the next.
//!
//! A curl is a list of turns. Turn `j` has a shape, a size, a pitch, a direction, a phase, an offset; over the
//! first `blend` of it all of them change from the last turn's values by one smoothstep. With `x` the
//! fraction of the turn and `w` the smoothstep's integral, both the distance along the source and the
//! angle around it are closed forms,
//!
//! ```text
//! s(x)     = s_j     + p_{j-1} x + (p_j - p_{j-1}) w(x)      p: pitch
//! theta(x) = theta_j + h_{j-1} x + (h_j - h_{j-1}) w(x)      h: direction, +1 or -1
//! ```
//!
//! so the path is C1 whatever is drawn, without integration. CVs are spread by the speed of the path, so that a small
//! turn beside a large one gets fewer, though never under eight.

use super::section::{ENTRIES, Shape};
use crate::maths::hash::{Dice, mix};
use crate::maths::rail::Rail;
use crate::maths::transcendental::{acos, sin_cos_turns};
use glam::{Vec2, Vec3};

/// What all curls of a node share.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// The list's shapes, and the zigzag of Z-bends last.
    pub(crate) shapes: Vec<Shape>,
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
    pub(crate) detail: Detail,
    pub(crate) turn_dice: Dice,
    pub(crate) curl_dice: Dice,
}

/// What decides the number of CVs.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Detail {
    /// CVs on a turn of full size.
    PerTurn(f32),
    /// cm that the chord between two CVs may lie off a circle.
    Tolerance(f32),
}

/// A turn as drawn: factors and shares, before any curve has a size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) shape: u16,
    /// Cosine and sine of the angle that a Z-bend's plane is turned by.
    plane: Vec2,
    back: bool,
    size: f32,
    pitch: f32,
    phase: f32,
    offset: Vec2,
    /// Uniform in [0, 1): whether a hair leaves its clump at this turn.
    gate: f32,
}

/// What is drawn once a curl.
#[derive(Clone, Copy, Debug)]
struct Start {
    hand: f32,
    phase: f32,
    size: f32,
    pitch: f32,
}

/// How much of its size a skipped turn keeps: not none, for hair is never straight beside its own curls.
const SKIPPED: f32 = 0.15;
/// Turns for which Z-bends go on, or stay away: hair kinks in runs.
const Z_RUN: u64 = 3;
/// Turns over which the plane of Z-bends turns.
const PLANE_REACH: u64 = 7;
/// Where the numbers of runs and of planes begin among a curl's random numbers.
const RUNS: u64 = 1 << 40;
const PLANES: u64 = 1 << 41;
/// The most CVs on one curl; beyond, CVs are spread wider.
const MOST_CVS: usize = 16_384;
/// The fewest CVs on a turn.
pub(crate) const FEWEST: f32 = 8.0;

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

    fn start(&self, key: u64) -> Start {
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

/// The sizes of one curve's curl, asked at fractions of the source's length.
pub(crate) struct Sizes<D, P, A> {
    /// cm.
    pub(crate) diameter: D,
    /// cm.
    pub(crate) pitch: P,
    /// Factor of the diameter.
    pub(crate) amount: A,
    /// 0 to 1.
    pub(crate) definition: f32,
}

/// A turn on a curve.
#[derive(Clone, Copy, Debug, Default)]
struct Laid {
    /// Distance along the source, angle and CV clock at its start.
    s: f32,
    theta: f32,
    clock: f32,
    /// CVs' density at its start, per turn.
    density: f32,
    pitch: f32,
    hand: f32,
    phase: f32,
    /// RMS radius, cm.
    size: f32,
    /// Size times the plane's cosine and sine, and the offset in cm.
    plane: Vec2,
    offset: Vec2,
    shape: u16,
}

/// Winds curves; keeps its memory from curve to curve.
#[derive(Debug, Default)]
pub(crate) struct Winder {
    /// The turns of the clump last asked for.
    clump: (u64, Vec<Turn>),
    laid: Vec<Laid>,
    /// cm over which the curl grows.
    rise: f32,
    /// The curl, root first.
    pub(crate) points: Vec<Vec3>,
    /// For each point the source's CV before it and the fraction of the way to the next.
    pub(crate) places: Vec<(u32, f32)>,
}

/// Smoothstep and its integral from 0, for a step of width `b`.
#[inline]
fn blended(x: f32, b: f32) -> (f32, f32) {
    if x < b {
        let y = x / b;
        (y * y * (3.0 - 2.0 * y), b * y * y * y * (1.0 - 0.5 * y))
    } else {
        (1.0, x - 0.5 * b)
    }
}

impl Winder {
    /// Draws the turns of the curve `id`, whose clump's pattern is named by `clump`, along `rail`.
    pub(crate) fn draw(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        (clump, id): (u64, u64),
        sizes: &Sizes<impl Fn(f32) -> f32, impl Fn(f32) -> f32, impl Fn(f32) -> f32>,
    ) {
        let length = rail.length();
        let common = sizes.definition;
        let mixed = |own: f32, clump: f32| own + (clump - own) * common;
        let mut start = pattern.start(clump);
        // A hair goes with its clump, a little beside it, until it leaves: some at the root, others at a turn. One that
        // left never comes back, for nothing pulls it. What adds up along the hair (pitch, direction) is the clump's own
        // until then; else a hair a hundredth off would be out of step after a few turns.
        let loose = 1.0 - common;
        let mut left = false;
        let leaving = leaving(common);
        if common < 1.0 {
            let own = pattern.start(id);
            left = pattern.curl_dice.unit(id, 4) < loose * loose;
            if left {
                (start.hand, start.pitch) = (own.hand, own.pitch);
            }
            start.phase += 0.5 * loose * loose * pattern.curl_dice.signed(id, 5);
            start.size = mixed(own.size, start.size);
        }
        if self.clump.0 != clump {
            self.clump = (clump, vec![]);
        }
        self.laid.clear();
        let (nominal_size, nominal_pitch) = (
            0.5 * (sizes.diameter)(0.0) * start.size,
            ((sizes.pitch)(0.0) * start.pitch).max(length / MOST_CVS as f32),
        );
        self.rise = pattern.rise * nominal_pitch;
        let perimeter = pattern.shapes[0].perimeter;
        let speed =
            |pitch: f32, size: f32| (pitch * pitch + perimeter * perimeter * size * size).sqrt();
        let cvs = match pattern.detail {
            Detail::PerTurn(cvs) => cvs,
            Detail::Tolerance(chord) => {
                let angle = acos(1.0 - chord / nominal_size.max(1e-6));
                (std::f32::consts::PI / angle.max(1e-3)).clamp(FEWEST, 256.0)
            }
        };
        // The clock runs by `cvs` over a turn of full size and by eight or more over any.
        let per_speed = cvs / speed(nominal_pitch, nominal_size).max(1e-9);
        let mut last = Laid { hand: start.hand, ..Laid::default() };
        let mut j = 0;
        loop {
            if self.clump.1.len() <= j {
                self.clump.1.push(pattern.turn(clump, j as u64));
            }
            let mut turn = self.clump.1[j];
            if common < 1.0 {
                let own = pattern.turn(id, j as u64);
                left |= own.gate < leaving;
                if left {
                    turn = own;
                } else {
                    turn.size = mixed(own.size, turn.size);
                    turn.phase = mixed(own.phase, turn.phase);
                    turn.offset = own.offset + (turn.offset - own.offset) * common;
                }
            }
            let mut laid = last;
            if j > 0 {
                let previous = self.laid[self.laid.len().saturating_sub(2)];
                let half = 1.0 - 0.5 * pattern.blend;
                laid.s += previous.pitch + (last.pitch - previous.pitch) * half;
                laid.theta += previous.hand + (last.hand - previous.hand) * half;
            }
            let u = (laid.s / length).min(1.0);
            laid.size = 0.5 * (sizes.diameter)(u) * start.size * turn.size;
            laid.pitch =
                ((sizes.pitch)(u) * start.pitch * turn.pitch).max(length / MOST_CVS as f32);
            if turn.back && j > 0 {
                laid.hand = -last.hand;
            }
            laid.phase = pattern.phase + start.phase + turn.phase;
            laid.plane = turn.plane * laid.size;
            laid.offset = turn.offset * laid.size;
            laid.shape = turn.shape;
            let before = if j == 0 { laid } else { last };
            let grown = envelope(laid.s, pattern.start, self.rise) * (sizes.amount)(u);
            let size = 0.5 * (before.size + laid.size) * grown;
            let density = speed(0.5 * (before.pitch + laid.pitch), size) * per_speed;
            laid.density = density.max(FEWEST);
            if j > 0 {
                laid.clock += 0.5 * (last.density + laid.density);
            }
            self.laid.push(laid);
            last = laid;
            // The turn after the last is there too, for its density.
            if self.laid.len() > 1 && laid.s >= length {
                break;
            }
            j += 1;
        }
    }

    /// Lays what was drawn along the first `reach` cm of `rail`, into `points` and `places`. At least `fewest`
    /// points are made.
    pub(crate) fn lay(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        reach: f32,
        fewest: usize,
        sizes: &Sizes<impl Fn(f32) -> f32, impl Fn(f32) -> f32, impl Fn(f32) -> f32>,
        roll: Option<impl Fn((u32, f32)) -> f32>,
    ) {
        let b = pattern.blend;
        let last =
            (self.laid.partition_point(|laid| laid.s < reach).max(1) - 1).min(self.laid.len() - 2);
        let end = self.clock_at(last, reach, b);
        let n = (end.ceil() as usize).clamp(fewest.max(4) - 1, MOST_CVS);
        let step = end / n as f32;
        let per_length = 1.0 / rail.length();
        let constant = (sizes.amount)(0.0);
        let varies = constant != (sizes.amount)(0.5) || constant != (sizes.amount)(1.0);
        self.points.clear();
        self.places.clear();
        let (mut j, mut cursor) = (0, 0);
        for k in 0..=n {
            let clock = k as f32 * step;
            while j < last && self.laid[j + 1].clock <= clock {
                j += 1;
            }
            let (turn, next) = (&self.laid[j], &self.laid[j + 1]);
            let before = &self.laid[j.saturating_sub(1)];
            let (d, dd) = (turn.density, next.density - turn.density);
            let c = clock - turn.clock;
            let x = 2.0 * c / (d + (d * d + 2.0 * dd * c).max(0.0).sqrt());
            let (w, integral) = blended(x, b);
            let s = turn.s + before.pitch * x + (turn.pitch - before.pitch) * integral;
            let theta = turn.theta
                + before.hand * x
                + (turn.hand - before.hand) * integral
                + before.phase
                + (turn.phase - before.phase) * w;
            let of = |turn: &Laid| {
                let p = pattern.shapes[turn.shape as usize].at(theta);
                turn.plane.rotate(p) + turn.offset
            };
            let mut across = of(turn);
            if w < 1.0 {
                let from = of(before);
                across = from + (across - from) * w;
            }
            let amount = if varies { (sizes.amount)(s * per_length) } else { constant };
            across *= envelope(s, pattern.start, self.rise) * amount;
            let stop = rail.at(&mut cursor, s);
            if let Some(roll) = &roll {
                let (sin, cos) = sin_cos_turns(roll(stop.place) / 360.0);
                across =
                    Vec2::new(across.x * cos + across.y * sin, across.y * cos - across.x * sin);
            }
            self.points.push(stop.point + stop.binormal * across.x + stop.normal * across.y);
            self.places.push(stop.place);
        }
    }

    /// The CV clock where turn `j` has come to `s` along the source.
    fn clock_at(&self, j: usize, s: f32, b: f32) -> f32 {
        let (turn, next) = (&self.laid[j], &self.laid[j + 1]);
        let before = &self.laid[j.saturating_sub(1)];
        let mut x = ((s - turn.s) / (next.s - turn.s)).clamp(0.0, 1.0);
        for _ in 0..5 {
            let (w, integral) = blended(x, b);
            let off = turn.s + before.pitch * x + (turn.pitch - before.pitch) * integral - s;
            let slope = before.pitch + (turn.pitch - before.pitch) * w;
            x = (x - off / slope).clamp(0.0, 1.0);
        }
        turn.clock + (turn.density + 0.5 * (next.density - turn.density) * x) * x
    }

    /// Arc length of the curl, cm, from chords over one and two points (Richardson): right to 2e-3 from
    /// eight CVs a turn on.
    pub(crate) fn arc_length(&self) -> f32 {
        let p = &self.points;
        let (mut single, mut double) = (0.0, 0.0);
        let mut pairs = p.windows(3).step_by(2);
        for w in &mut pairs {
            single += w[0].distance(w[1]) + w[1].distance(w[2]);
            double += w[0].distance(w[2]);
        }
        let left =
            if p.len().is_multiple_of(2) { p[p.len() - 2].distance(p[p.len() - 1]) } else { 0.0 };
        single + (single - double) / 3.0 + left
    }
}

/// Which share of a clump's hairs leaves it at each turn, by how defined it is: none at 1, a tenth at a half, all at 0.
fn leaving(definition: f32) -> f32 {
    (0.1 * (1.0 - definition) / definition.max(1e-3)).min(1.0)
}

/// How much of its size the curl has at `s`: none up to `start`, all from `start + rise` on. Always none at the root.
#[inline]
fn envelope(s: f32, start: f32, rise: f32) -> f32 {
    let x = s - start;
    if x <= 0.0 {
        0.0
    } else if x < rise {
        let y = x / rise;
        y * y * (3.0 - 2.0 * y)
    } else {
        1.0
    }
}
