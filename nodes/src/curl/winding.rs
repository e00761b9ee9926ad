//! Winds one source curve into a curl: turns drawn by hashes (`pattern.rs`), each blended into the next.
//!
//! A curl is a list of turns. Turn `j` has a profile, a size, a pitch, a direction, a phase and an offset; over its first
//! `blend` all of them change from the previous turn's values by one smoothstep. With `x` the fraction of the turn and `w`
//! the smoothstep's integral, the distance along the source and the angle around it both have closed forms,
//!
//! ```text
//! s(x)     = s_j     + p_{j-1} x + (p_j - p_{j-1}) w(x)      p: pitch
//! theta(x) = theta_j + h_{j-1} x + (h_j - h_{j-1}) w(x)      h: direction, +1 or -1
//! ```
//!
//! so the path is C1 whatever is drawn, without integration. CVs lie on the path, spaced within 1.2 : 1 of their
//! neighbours (where no skin is in the way), so that every reader of Catmull-Rom curves reads the same curl: the path is
//! walked with a step predicted from its own speed, and a step that comes out too long or too short is repeated. The
//! length of steps follows from the requested error and changes slowly along the hair.
//!
//! A curl has a limited number of CVs. If the limit is below what the error asks for, all steps are lengthened equally; if
//! steps would approach the size of the turns and skip some, the whole curl is drawn larger, so that the result has the
//! requested form. Its size is then not the requested one; the caller learns by how much it is larger.

use super::pattern::{CurlVariation, Detail, Pattern, Turn};
use crate::data::attributes::CURL_MIDDLE;
use crate::maths::rail::Rail;
use crate::maths::smoothstep;
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos_turns;
use glam::{Vec2, Vec3};

/// The most turns on one curl; a smaller pitch is raised to the one that gives this many.
const MOST_TURNS: f32 = 16_384.0;
/// The fewest CVs on a turn of any size.
const FEWEST: f32 = 8.0;
/// Fewest CVs on a turn of full size: a curl whose limit of CVs would give fewer is drawn larger. At 7, the diameters
/// of 3c to 4c measure within 5 % of those with enough CVs, and the pitches within 2 % (for 4c, whose turns differ
/// most, within 8 %). With fewer, steps pass over small turns; with 8, the longest hairs of an afro would be drawn
/// larger for little benefit.
const FLOOR: f32 = 7.0;
/// Below this, a curl uses all CVs that it may have, which requires one more walk.
const SCARCE: f32 = 8.5;
/// How often a curl is drawn again until its turns are large enough.
const DRAWN: usize = 8;
/// Largest ratio of step lengths from one turn to the next: less than a tenth from one CV to the next.
const STEADY: f32 = 1.5;
/// Tolerance of the length of a step.
const LENIENT: f32 = 0.06;
/// Relative tolerance of a curl's requested length.
const CLOSE: f32 = 2e-3;
/// Hairs with fewer CVs than this are measured exactly.
const FEW: usize = 32;
/// Number of CVs that share the remainder at the tip.
const TAIL: usize = 10;
/// Samples along a curl between which its amount is linear.
const AMOUNTS: usize = 32;

/// The sizes of one curve's curl, by fraction of the source's length.
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

impl<D: Fn(f32) -> f32, P: Fn(f32) -> f32, A: Fn(f32) -> f32> Sizes<D, P, A> {
    /// The requested values of a curl with this start: RMS diameter over its middle part, and pitch by number of turns,
    /// where they vary along the hair.
    fn params(&self, start: CurlVariation) -> CurlParams {
        let (mut square, mut turns) = (0.0, 0.0);
        let [from, to] = CURL_MIDDLE;
        for k in 0..8 {
            let u = (k as f32 + 0.5) / 8.0;
            let middle = from + (to - from) * u;
            let diameter = (self.diameter)(middle) * (self.amount)(middle);
            square += diameter * diameter;
            turns += 1.0 / (self.pitch)(u).max(1e-6);
        }
        CurlParams {
            diameter: (square / 8.0).sqrt() * start.size,
            pitch: 8.0 / turns * start.pitch,
        }
    }
}

/// A turn on a curve.
#[derive(Clone, Copy, Debug, Default)]
struct Laid {
    /// Distance along the source and angle at its start.
    s: f32,
    theta: f32,
    pitch: f32,
    hand: f32,
    phase: f32,
    /// RMS radius, cm.
    size: f32,
    /// Size times the plane's cosine and sine, and the offset in cm.
    plane: Vec2,
    offset: Vec2,
    shape: u16,
    /// Approximate length of the curl on it, cm.
    length: f32,
    /// Spacing of CVs at its end, cm.
    spacing: f32,
}

/// A point of a curl.
#[derive(Clone, Copy, Debug)]
struct Mark {
    turn: u32,
    /// Fraction of the turn.
    x: f32,
    /// Length of curl per turn here, cm.
    speed: f32,
    /// Unit direction from the last point, and length along the curl up to here, cm.
    way: Vec3,
    arc: f32,
}

impl Mark {
    /// Change of speed per turn from here to `next`.
    fn faster(&self, next: &Self) -> f32 {
        let ahead = (next.turn - self.turn) as f32 + next.x - self.x;
        (next.speed - self.speed) / ahead.max(1e-9)
    }
}

/// Requested values of one curl, including the variation over the head.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CurlParams {
    /// cm.
    pub(crate) diameter: f32,
    /// cm.
    pub(crate) pitch: f32,
}

impl CurlParams {
    fn larger(self, factor: f32) -> Self {
        Self { diameter: self.diameter * factor, pitch: self.pitch * factor }
    }
}

/// How far a curl goes: along the first `reach` cm of its source, and no farther than `fibre` cm of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    pub(crate) reach: f32,
    pub(crate) fibre: f32,
}

/// A completed walk.
#[derive(Debug, Default)]
struct Walk {
    points: Vec<Vec3>,
    marks: Vec<Mark>,
    fibre: f32,
    span: f32,
}

/// Winds curves; reuses its memory from curve to curve.
#[derive(Debug, Default)]
pub(crate) struct Winder {
    /// The turns of the last requested clump.
    clump: (u64, Vec<Turn>),
    laid: Vec<Laid>,
    /// Length over which the curl grows, cm.
    rise: f32,
    /// Length of curl on a turn of full size, cm.
    turn: f32,
    /// Factor of the size at even positions along the source; empty: constant.
    amounts: Vec<f32>,
    amount: f32,
    /// Requested values of the last drawn curl.
    pub(crate) params: CurlParams,
    /// Straight length at the root of this curl, cm, if it exceeds the pattern's.
    pub(crate) held: f32,
    /// How much larger than requested the curl is, in diameter and pitch; it never decreases by itself.
    pub(crate) larger: f32,
    /// The curl, root first.
    pub(crate) points: Vec<Vec3>,
    marks: Vec<Mark>,
    /// How many of these the last walk placed at the intended spacing; the rest share the remainder.
    walked: usize,
    /// The walk so far whose length is closest to the requested one.
    nearest: Walk,
    /// Arc length of the curl, and cm of source that it takes.
    pub(crate) fibre: f32,
    pub(crate) span: f32,
    /// Whether all requested points are there.
    pub(crate) enough: bool,
}

/// Smoothstep, its integral from 0 and its derivative, for a step of width `b`.
#[inline(always)]
fn blended(x: f32, b: f32) -> (f32, f32, f32) {
    if x < b {
        let y = x / b;
        (smoothstep(y), b * y * y * y * (1.0 - 0.5 * y), 6.0 * y * (1.0 - y) / b)
    } else {
        (1.0, x - 0.5 * b, 0.0)
    }
}

impl Winder {
    /// Draws and lays the curve `id`, whose clump has the key `clump`: along `rail` as far as `goal` says, with at
    /// least `fewest` points. If a curl may have so few points that steps would pass over whole turns, it is drawn
    /// larger in diameter and pitch alike, so that its form and shrinkage stay.
    pub(crate) fn wind(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        names: (u64, u64),
        sizes: &Sizes<impl Fn(f32) -> f32, impl Fn(f32) -> f32, impl Fn(f32) -> f32>,
        (goal, fewest): (Goal, usize),
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) {
        let room = (pattern.most() - 1) as f32;
        self.larger = self.larger.max(1.0);
        for tries in (0..DRAWN).rev() {
            self.draw(pattern, rail, names, sizes);
            let (last, x) = self.end(pattern, goal);
            let (wish, length) = self.steps_to(last, x, goal.fibre);
            let on_turn = self.on_turn(pattern.most(), length);
            if wish <= room || on_turn >= FLOOR || tries == 0 {
                break;
            }
            // Other turns now fall on the hair: slightly more, so that the next attempt is the last.
            self.larger *= 1.01 * FLOOR / on_turn;
        }
        self.lay(pattern, rail, goal, fewest, roll);
    }

    /// Draws the turns of the curve `id`, whose clump has the key `clump`, along `rail`.
    fn draw(
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
        // A hair follows its clump, slightly beside it, until it leaves: some at the root, others at a turn. A hair
        // that left never comes back, since nothing pulls it. Accumulated values (pitch, direction) are the clump's own
        // until then; otherwise a hair a hundredth off would be out of phase after a few turns.
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
        let least_pitch = length / MOST_TURNS;
        let even = pattern.even;
        self.params = sizes.params(start);
        let full = self.params.larger(self.larger);
        self.params.diameter *= even.mean_size;
        // From here on, everything drawn is larger; the requested values stay.
        (start.size, start.pitch) = (start.size * self.larger, start.pitch * self.larger);
        self.set_amounts(sizes);
        let radius = 0.5 * full.diameter;
        self.rise = pattern.rise * ((sizes.pitch)(0.0) * start.pitch).max(least_pitch);
        let spacing = Spacing::new(pattern, full);
        self.turn = spacing.turn;
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
            let young = young(laid.s, pattern.sponge);
            let (size, pitch) =
                (start.size * turn.size * even.size, start.pitch * turn.pitch * even.pitch);
            laid.size = 0.5 * (sizes.diameter)(u) * size * young;
            laid.pitch = ((sizes.pitch)(u) * pitch * young).max(least_pitch);
            if turn.back && j > 0 {
                laid.hand = -last.hand;
            }
            laid.phase = pattern.phase + start.phase + turn.phase;
            laid.plane = turn.plane * laid.size;
            laid.offset = turn.offset * laid.size;
            laid.shape = turn.shape;
            let before = if j == 0 { laid } else { last };
            let amount = self.amount_at(u);
            (laid.length, laid.spacing) = spacing.of(pattern, &before, &laid, amount, radius);
            laid.length *= 1.0 - 0.5 * pattern.blend * f32::from(laid.hand != before.hand);
            self.laid.push(laid);
            last = laid;
            // One turn more than the source has room for, so that there is one everywhere.
            if self.laid.len() > 1 && laid.s >= length {
                break;
            }
            j += 1;
        }
        for j in 1..self.laid.len() {
            let most = self.laid[j - 1].spacing * STEADY;
            self.laid[j].spacing = self.laid[j].spacing.min(most);
        }
        for j in (1..self.laid.len()).rev() {
            let most = self.laid[j].spacing * STEADY;
            self.laid[j - 1].spacing = self.laid[j - 1].spacing.min(most);
        }
    }

    fn set_amounts(
        &mut self,
        sizes: &Sizes<impl Fn(f32) -> f32, impl Fn(f32) -> f32, impl Fn(f32) -> f32>,
    ) {
        let at = |k: usize| (sizes.amount)(k as f32 / AMOUNTS as f32);
        self.amount = at(0);
        self.amounts.clear();
        if [1, 2, 3, 4].into_iter().any(|k| at(k * AMOUNTS / 4) != self.amount) {
            self.amounts.extend((0..=AMOUNTS).map(at));
        }
    }

    #[inline(always)]
    fn amount_at(&self, u: f32) -> f32 {
        if self.amounts.is_empty() {
            return self.amount;
        }
        let x = u * AMOUNTS as f32;
        let k = (x as usize).min(AMOUNTS - 1);
        let (a, b) = (self.amounts[k], self.amounts[k + 1]);
        a + (b - a) * (x - k as f32).min(1.0)
    }

    /// Lays the drawn turns along `rail` as far as `goal` says, into `points`: as many points as the tolerance needs,
    /// at least `fewest` and at most the pattern's limit.
    fn lay(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        goal: Goal,
        fewest: usize,
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) {
        let most = pattern.most();
        let fewest = fewest.clamp(4, most);
        let (last, x) = self.end(pattern, goal);
        let (wish, length) = self.steps_to(last, x, goal.fibre);
        self.enough = wish <= (most - 1) as f32;
        let mut stretch = (wish / (fewest - 1) as f32).min(1.0);
        if !self.enough {
            let even = length / (most - 1) as f32;
            self.laid.iter_mut().for_each(|laid| laid.spacing = even);
            stretch = 1.01;
        }
        // The spline through the points is slightly shorter than the path, and its length is known only afterward. A
        // walk that needs more points than allowed starts again with longer steps.
        let (mut fibre, mut corrections, mut again) = (goal.fibre, 0, false);
        let mut scarce = self.on_turn(most, length) < SCARCE;
        let mut nearest = f32::INFINITY;
        for _ in 0..10 {
            let way = (fibre, stretch, most, again);
            match self.walk(pattern, rail, (last as u32, x), way, roll) {
                Ok(_) if scarce && !self.enough && self.points.len() * 16 < most * 15 => {
                    // Chords cut corners and need fewer points: the rest makes all of them shorter.
                    stretch *= self.points.len() as f32 / (most - 1) as f32;
                    (again, scarce) = (false, false);
                }
                Ok(whole) => {
                    self.fibre = arc_length(&self.points);
                    let off = self.fibre - goal.fibre;
                    let ended = whole && off < 0.0;
                    let close = off.abs() <= CLOSE * goal.fibre || goal.fibre == f32::INFINITY;
                    if ended || close {
                        return;
                    }
                    if off.abs() < nearest {
                        nearest = off.abs();
                        self.nearest.points.clone_from(&self.points);
                        self.nearest.marks.clone_from(&self.marks);
                        (self.nearest.fibre, self.nearest.span) = (self.fibre, self.span);
                    }
                    corrections += 1;
                    fibre *= goal.fibre / self.fibre;
                    again = true;
                    if corrections > 2 {
                        // Points that pass over cusps only in some walks: finer points resolve all of them.
                        stretch *= 0.8;
                        again = false;
                    }
                }
                Err(part) => {
                    again = false;
                    if self.enough {
                        // Steps that change over so few points would be uneven.
                        let most =
                            self.laid.iter().fold(0.0f32, |most, laid| most.max(laid.spacing));
                        self.laid.iter_mut().for_each(|laid| laid.spacing = most);
                        self.enough = false;
                    } else {
                        stretch *= 1.01 / part.clamp(0.5, 0.99);
                    }
                }
            }
        }
        // No length was close, and the last walk may have stopped early for lack of points.
        if nearest < f32::INFINITY {
            std::mem::swap(&mut self.points, &mut self.nearest.points);
            std::mem::swap(&mut self.marks, &mut self.nearest.marks);
            (self.fibre, self.span) = (self.nearest.fibre, self.nearest.span);
        }
    }

    /// How many of the steps between `most` CVs on `length` cm of curl fall on a turn of full size.
    fn on_turn(&self, most: usize, length: f32) -> f32 {
        (most - 1) as f32 * self.turn / length
    }

    /// Turn, and fraction of it, at which the curl reaches its end along its source.
    fn end(&self, pattern: &Pattern, goal: Goal) -> (usize, f32) {
        let last = (self.laid.partition_point(|laid| laid.s < goal.reach).max(1) - 1)
            .min(self.laid.len() - 2);
        (last, self.x_at(last, goal.reach, pattern.blend))
    }

    /// Approximate number of steps of the intended length to the fraction `x` of turn `last`, or to `fibre` cm of curl;
    /// and their length in cm.
    fn steps_to(&self, last: usize, x: f32, fibre: f32) -> (f32, f32) {
        let (mut steps, mut gone) = (0.0, 0.0);
        for j in 0..=last {
            let (turn, before) = (&self.laid[j], &self.laid[j.saturating_sub(1)]);
            let part = if j == last { x } else { 1.0 };
            let length = turn.length * part;
            let left = if length > 0.0 { ((fibre - gone) / length).clamp(0.0, 1.0) } else { 1.0 };
            steps += left * length / (0.5 * (turn.spacing + before.spacing));
            gone += length;
            if left < 1.0 {
                break;
            }
        }
        (steps.max(1e-3), gone.min(fibre))
    }

    /// Walks to the position `whole` (turn and fraction), or `fibre` cm along the curl, with at most `most` points.
    /// Steps are `stretch` times the intended length. If `again`, the same steps were taken before, and all but the
    /// last can be skipped. Returns whether it reached the end or, if that would take more points, the fraction that it
    /// covered.
    fn walk(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        whole: (u32, f32),
        (fibre, stretch, most, again): (f32, f32, usize, bool),
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) -> Result<bool, f32> {
        let mut cursor = 0;
        if again {
            let is_before = |mark: &Mark| mark.arc < fibre;
            let keep = self.walked.min(self.marks.partition_point(is_before)).max(1);
            self.points.truncate(keep);
            self.marks.truncate(keep);
        } else {
            self.points.clear();
            self.marks.clear();
            let (point, speed) = self.at(pattern, rail, (0, 0.0), &mut cursor, roll);
            self.points.push(point);
            self.marks.push(Mark { turn: 0, x: 0.0, speed, way: Vec3::ZERO, arc: 0.0 });
        }
        let n = self.marks.len();
        let (mut mark, mut here) = (self.marks[n - 1], self.points[n - 1]);
        let mut faster = if n > 1 { self.marks[n - 2].faster(&mark) } else { 0.0 };
        let (end, stop, wanted) = loop {
            let (turn, before) = (
                &self.laid[mark.turn as usize],
                &self.laid[(mark.turn as usize).saturating_sub(1)],
            );
            let wanted = stretch * (before.spacing + (turn.spacing - before.spacing) * mark.x);
            let (next, at, _) = self.step(
                pattern,
                rail,
                (&mark, here, faster),
                (wanted, LENIENT),
                &mut cursor,
                roll,
            );
            let past = (next.turn, next.x) >= whole;
            if past || next.arc >= fibre {
                let mut place = whole;
                if next.arc >= fibre {
                    let part = (fibre - mark.arc) / (next.arc - mark.arc).max(1e-9);
                    let ahead = (next.turn - mark.turn) as f32 + next.x - mark.x;
                    let cut = self.ahead((mark.turn, mark.x), ahead * part.clamp(0.0, 1.0));
                    place = if cut < whole { cut } else { whole };
                }
                let (point, speed) = self.at(pattern, rail, place, &mut cursor, roll);
                let (way, far) = way(here, point);
                let arc = mark.arc + arc(far, way, &mark);
                break (Mark { turn: place.0, x: place.1, speed, way, arc }, point, wanted);
            }
            if self.points.len() + 1 >= most {
                let gone = mark.turn as f32 + mark.x;
                return Err(gone / (whole.0 as f32 + whole.1).max(gone));
            }
            faster = mark.faster(&next);
            self.points.push(at);
            self.marks.push(next);
            (mark, here) = (next, at);
        };
        self.span = self.s_at(end.turn as usize, end.x, pattern.blend);
        self.finish(pattern, rail, (end, stop), (wanted, most), &mut cursor, roll);
        Ok((end.turn, end.x) >= whole)
    }

    /// Ends the walk at `end`: the last points share the remainder. There are at most `most` points.
    fn finish(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        (end, stop): (Mark, Vec3),
        (wanted, most): (f32, usize),
        cursor: &mut usize,
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) {
        let n = self.points.len();
        let base = n - 1 - TAIL.min(n - 1);
        self.walked = base + 1;
        let chords =
            |points: &[Vec3]| -> f32 { points.windows(2).map(|w| w[0].distance(w[1])).sum() };
        let left = chords(&self.points[base..]) + self.points[n - 1].distance(stop);
        let own = (n - 1 - base) as f32;
        // The same number, or one more.
        let mean = if base + 1 < n { chords(&self.points[base..]) / own } else { wanted };
        let room = most.saturating_sub(base + 1).max(1);
        let likely = ((left / mean).round().clamp(1.0, own + 1.0) as usize).min(room);
        let mut best = (f32::INFINITY, likely, left / likely as f32);
        for steps in [likely, (likely + 1).min(room), likely.max(2) - 1] {
            let (mut step, mut low, mut high) = (left / steps as f32, 0.88 * mean, 1.14 * mean);
            for _ in 0..9 {
                let over = self.tail(pattern, rail, (base, end, stop), (steps, step), cursor, roll);
                let off = (over / step).abs();
                if off < best.0 {
                    best = (off, steps, step);
                }
                if off <= LENIENT {
                    break;
                }
                if over > 0.0 {
                    low = step
                } else {
                    high = step
                }
                let guess = step + over / steps as f32;
                step = if guess > low && guess < high { guess } else { 0.5 * (low + high) };
            }
            if best.0 <= LENIENT {
                break;
            }
        }
        if best.0 > LENIENT {
            let way = (best.1, best.2);
            self.tail(pattern, rail, (base, end, stop), way, cursor, roll);
        }
        self.points.push(stop);
        self.marks.push(end);
    }

    /// Takes all steps but the last from point `base` to the end. Returns how much longer the last is than the others,
    /// or how far they went past the end (negative).
    fn tail(
        &mut self,
        pattern: &Pattern,
        rail: &Rail,
        (base, end, stop): (usize, Mark, Vec3),
        (steps, step): (usize, f32),
        cursor: &mut usize,
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) -> f32 {
        self.points.truncate(base + 1);
        self.marks.truncate(base + 1);
        for k in 1..steps {
            let (mark, here) = (self.marks[base + k - 1], self.points[base + k - 1]);
            let still = (&mark, here, 0.0);
            let (next, at, _) = self.step(pattern, rail, still, (step, 0.01), cursor, roll);
            if (next.turn, next.x) >= (end.turn, end.x) {
                return -step * (steps - k) as f32;
            }
            self.points.push(at);
            self.marks.push(next);
        }
        self.points[self.points.len() - 1].distance(stop) - step
    }

    /// The next point `wanted` cm from a point of the curl, within the tolerance, where the speed changes by `faster`
    /// per turn; and its distance.
    #[inline(always)]
    fn step(
        &self,
        pattern: &Pattern,
        rail: &Rail,
        (mark, here, faster): (&Mark, Vec3, f32),
        (wanted, lenient): (f32, f32),
        cursor: &mut usize,
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) -> (Mark, Vec3, f32) {
        let mut ahead = wanted / mark.speed;
        ahead =
            wanted / (mark.speed + 0.5 * faster * ahead).clamp(0.5 * mark.speed, 2.0 * mark.speed);
        // Where the curl turns back on itself (a wave wider than its source's bends does), distance no longer grows
        // along the path: the first position that is far enough is then bracketed.
        let (mut near, mut beyond, mut tries) = (0.0, f32::INFINITY, 0);
        loop {
            let place = self.ahead((mark.turn, mark.x), ahead);
            let (point, speed) = self.at(pattern, rail, place, cursor, roll);
            let (way, far) = way(here, point);
            tries += 1;
            if (far - wanted).abs() <= lenient * wanted || tries == 24 {
                let arc = mark.arc + arc(far, way, mark);
                return (Mark { turn: place.0, x: place.1, speed, way, arc }, point, far);
            }
            if far < wanted {
                near = ahead
            } else {
                beyond = ahead
            }
            ahead = match () {
                () if tries < 3 => ahead * (wanted / far.max(1e-9)).clamp(0.5, 2.0),
                () if beyond == f32::INFINITY => near * 1.25,
                () => 0.5 * (near + beyond),
            };
        }
    }

    /// The position `ahead` turns further; the last turn continues forever.
    #[inline(always)]
    fn ahead(&self, (turn, x): (u32, f32), ahead: f32) -> (u32, f32) {
        let (mut turn, mut x) = (turn, x + ahead);
        let last = self.laid.len() as u32 - 1;
        while x >= 1.0 && turn < last {
            x -= 1.0;
            turn += 1;
        }
        (turn, x)
    }

    /// The curl's point at a fraction of a turn, and its speed there in cm per turn.
    #[inline(always)]
    fn at(
        &self,
        pattern: &Pattern,
        rail: &Rail,
        (j, x): (u32, f32),
        cursor: &mut usize,
        roll: Option<&impl Fn((u32, f32)) -> f32>,
    ) -> (Vec3, f32) {
        let turn = &self.laid[j as usize];
        let before = &self.laid[(j as usize).saturating_sub(1)];
        let (w, integral, slope) = blended(x, pattern.blend);
        let (longer, back) = (turn.pitch - before.pitch, turn.hand - before.hand);
        let shift = turn.phase - before.phase;
        let s = turn.s + before.pitch * x + longer * integral;
        let along = before.pitch + longer * w;
        let theta = turn.theta + before.hand * x + back * integral + before.phase + shift * w;
        let around = before.hand + back * w + shift * slope;
        let of = |turn: &Laid| {
            let (p, v) = pattern.shapes[turn.shape as usize].at(theta);
            (turn.plane.rotate(p) + turn.offset, turn.plane.rotate(v) * around)
        };
        let (mut across, mut velocity) = of(turn);
        if w < 1.0 {
            let (from, leaving) = of(before);
            let step = across - from;
            velocity = leaving + (velocity - leaving) * w + step * slope;
            across = from + step * w;
        }
        let size = envelope(s, pattern.start.max(self.held), self.rise)
            * self.amount_at(s / rail.length());
        across *= size;
        let speed = (along * along + velocity.length_squared() * size * size).sqrt();
        let stop = rail.at(cursor, s);
        if let Some(roll) = roll {
            let (sin, cos) = sin_cos_turns(roll(stop.place) / 360.0);
            across = Vec2::new(across.x * cos + across.y * sin, across.y * cos - across.x * sin);
        }
        (stop.point + stop.binormal * across.x + stop.normal * across.y, speed)
    }

    /// Position on the source at the fraction `x` of turn `j`, cm from its root.
    fn s_at(&self, j: usize, x: f32, b: f32) -> f32 {
        let (turn, before) = (&self.laid[j], &self.laid[j.saturating_sub(1)]);
        turn.s + before.pitch * x + (turn.pitch - before.pitch) * blended(x, b).1
    }

    /// For each point, the source's CV before it and the fraction toward the next.
    pub(crate) fn places(&self, rail: &Rail, b: f32) -> impl Iterator<Item = (u32, f32)> {
        let mut cursor = 0;
        self.marks
            .iter()
            .map(move |mark| rail.at(&mut cursor, self.s_at(mark.turn as usize, mark.x, b)).place)
    }

    /// For each point, whether the curl may come near what `clear` reports for a ball (centre and radius, cm): queried
    /// once per turn.
    pub(crate) fn near(
        &self,
        rail: &Rail,
        pattern: &Pattern,
        clear: impl Fn(Vec3, f32) -> bool,
        out: &mut Vec<bool>,
    ) {
        out.clear();
        let (mut cursor, mut turn, mut near) = (0, u32::MAX, false);
        for mark in &self.marks {
            if mark.turn != turn {
                turn = mark.turn;
                let (now, before) =
                    (&self.laid[turn as usize], &self.laid[(turn as usize).saturating_sub(1)]);
                let wide = |t: &Laid| t.size * pattern.widest + t.offset.length();
                let half = 0.5 * now.pitch.max(before.pitch);
                let middle = rail.at(&mut cursor, now.s + half).point;
                let most = self.amounts.iter().fold(self.amount, |most, x| most.max(*x));
                near = !clear(middle, half + most * wide(now).max(wide(before)));
            }
            out.push(near);
        }
    }

    /// Where the turn of a given point ends, cm from the source's root.
    pub(crate) fn end_of_turn(&self, point: usize) -> f32 {
        let turn = self.marks.get(point).map_or(0, |mark| mark.turn as usize);
        self.laid.get(turn + 1).or(self.laid.last()).map_or(0.0, |next| next.s)
    }

    /// The fraction of turn `j` at which it reaches `s` along the source.
    fn x_at(&self, j: usize, s: f32, b: f32) -> f32 {
        let (turn, next) = (&self.laid[j], &self.laid[j + 1]);
        let before = &self.laid[j.saturating_sub(1)];
        let mut x = ((s - turn.s) / (next.s - turn.s)).clamp(0.0, 1.0);
        for _ in 0..5 {
            let (w, integral, _) = blended(x, b);
            let off = turn.s + before.pitch * x + (turn.pitch - before.pitch) * integral - s;
            let slope = before.pitch + (turn.pitch - before.pitch) * w;
            x = (x - off / slope).clamp(0.0, 1.0);
        }
        x
    }
}

/// Unit direction and distance from one point to another.
#[inline(always)]
fn way(from: Vec3, to: Vec3) -> (Vec3, f32) {
    let step = to - from;
    let far = step.length();
    (if far > 0.0 { step / far } else { Vec3::ZERO }, far)
}

/// Arc over a chord of `far` cm: longer than the chord depending on the turn since the last chord.
#[inline(always)]
fn arc(far: f32, way: Vec3, last: &Mark) -> f32 {
    if last.way == Vec3::ZERO { far } else { far * (1.0 + way.distance_squared(last.way) / 24.0) }
}

/// Arc length of the spline through evenly spaced points, cm: each span by Simpson's rule, which is half a percent off
/// where few points turn sharply. These few are measured exactly on the spline.
pub(crate) fn arc_length(points: &[Vec3]) -> f32 {
    if points.len() < FEW
        && let Ok(spline) = Spline::new(points)
    {
        return spline.length();
    }
    let (mut sum, mut tangent) = (0.0f32, points[1] - points[0]);
    let mut speed = tangent.length();
    for k in 1..points.len() {
        let chord = points[k] - points[k - 1];
        let next = points.get(k + 1).map_or(chord, |after| (*after - points[k - 1]) * 0.5);
        let then = next.length();
        sum += speed + then + (chord * 6.0 - tangent - next).length();
        (tangent, speed) = (next, then);
    }
    sum / 6.0
}

/// What sets the spacing of the CVs of one curl.
struct Spacing {
    detail: Detail,
    /// Length of curl on a turn of full size, cm.
    turn: f32,
}

impl Spacing {
    fn new(pattern: &Pattern, asked: CurlParams) -> Self {
        let around = pattern.shapes[0].perimeter * 0.5 * asked.diameter;
        let turn = (asked.pitch * asked.pitch + around * around).sqrt();
        Self { detail: pattern.detail, turn: turn.max(1e-6) }
    }

    /// Length of a turn along the curl, and the spacing of CVs on it, cm.
    fn of(
        &self,
        pattern: &Pattern,
        before: &Laid,
        turn: &Laid,
        amount: f32,
        radius: f32,
    ) -> (f32, f32) {
        let (a, b) = (&pattern.shapes[before.shape as usize], &pattern.shapes[turn.shape as usize]);
        let size = 0.5 * (before.size + turn.size) * amount;
        let around = a.perimeter.max(b.perimeter) * size;
        let pitch = 0.5 * (before.pitch + turn.pitch);
        let length = (pitch * pitch + around * around).sqrt();
        let on_turn = match self.detail {
            Detail::PerTurn(cvs) => cvs * length / self.turn,
            // A chord of c over a bend of radius r lies c^2 / 8 r off it; r follows from the acceleration of the
            // profile.
            Detail::Tolerance(share) => {
                let bend = a.bend.max(b.bend) * size;
                std::f32::consts::TAU * (bend / (8.0 * share * radius.max(1e-6))).sqrt()
            }
        };
        (length, length / on_turn.clamp(FEWEST, 256.0))
    }
}

/// Fraction of its size and pitch of a turn inside the sponge at the root: half at the root.
fn young(s: f32, sponge: f32) -> f32 {
    if s >= sponge {
        return 1.0;
    }
    let y = s / sponge;
    0.5 + 0.5 * y * y * (3.0 - 2.0 * y)
}

/// Fraction of a clump's hairs that leaves it at each turn, by definition: none at 1, a tenth at a half, all at 0.
fn leaving(definition: f32) -> f32 {
    (0.1 * (1.0 - definition) / definition.max(1e-3)).min(1.0)
}

/// Fraction of its size that the curl has at `s`: 0 up to `start`, 1 from `start + rise` on. Always 0 at the root.
#[inline]
fn envelope(s: f32, start: f32, rise: f32) -> f32 {
    let x = s - start;
    if x <= 0.0 {
        0.0
    } else if x < rise {
        let y = x / rise;
        smoothstep(y)
    } else {
        1.0
    }
}
