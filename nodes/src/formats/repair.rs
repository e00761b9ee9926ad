//! Repair of one curve whose readings differ: gives it CVs through which they agree.
//!
//! Tried in turn until they agree: CVs with equal chords; the same, moved out of the skin as a whole, which keeps chords equal
//! where pushing single CVs would not; both again after the curve is routed around what tears it. Of the results that move the
//! curve as a whole, the first that stays near its place ([`NEARBY`]) is taken, else the one that stays nearest: a hair that a
//! fold throws across the forehead is visible, though its readings agree. What is thrown farther than [`THROWN`] is not taken, nor
//! are barred results, such as those that cross a parting.
//!
//! Guarantees: the root stays, and the tip too except on curves that are moved as a whole; no other CV is deeper in the skin than
//! allowed by more than [`NEAR`] cm; work is limited by an [`Allowance`] in CVs, not in time, so that the result is the same
//! everywhere. Not promised: that readings agree at the end; see [`Read::left`].

use super::conform::Effort;
use crate::data::curves::MOST_A_CURVE;
use crate::data::patience::Patience;
use crate::data::route::makers::{
    clear, clear_beyond, clear_drawn, deepest_dip, dips, lift, way_out,
};
use crate::data::route::skin_clear::Torn;
use crate::data::scalp::Skin;
use crate::maths::catmull_rom_agreement::{AGREE, each_span, readings_agree, readings_differ};
use crate::maths::spline::{Spline, SplineParam};
use glam::Vec3;
use std::cell::Cell;

/// Factors of the number of segments of a resampled curve, in the order tried.
const FINER: [f32; 2] = [1.0, 1.25];
/// Factors for a curve that is moved out of the skin as a whole.
const MOVED_FINER: [f32; 3] = [1.0, 2.0, 4.0];
/// How torn a curve must be to be routed around the skin, in the order tried.
const LEADS: [Torn; 2] = [Torn::APART, Torn::UNEVEN];
/// Largest number of times a curve is moved out as a whole and evened again.
const MOVES: usize = 40;
/// Manners of moving, in the order tried: close to the curve first, then harder.
const MANNERS: [Manner; 3] = [
    Manner { growth: 0.3, hard: false },
    Manner { growth: 0.1, hard: true },
    Manner { growth: 1.0, hard: true },
];

/// How CVs that are too deep are moved out of the skin.
#[derive(Clone, Copy)]
struct Manner {
    /// Growth of the move per round, as a fraction.
    growth: f32,
    /// Whether neighbours on both sides of a thin part move around its edge together, and spans that are clear of the skin but
    /// read differently are smoothed.
    hard: bool,
}

/// Limit of a move: this multiple of the required distance, plus this distance (cm).
const FARTHEST: (f32, f32) = (12.0, 0.5);
/// A moved curve is near its place if no CV has moved farther than this multiple of the largest distance required to clear the
/// skin, plus this distance (cm).
const NEARBY: (f32, f32) = (1.5, 0.2);
/// Largest distance from its place, cm, that a curve may be moved. An ear's edge is up to 3 cm away, and a coil as wide as it must
/// clear it between its CVs too.
const THROWN: f32 = 4.5;
/// Depth beyond the allowed one that is tolerated, cm: half of what the law on depth tolerates.
const NEAR: f32 = 5e-4;
/// Rounds of equalising chords.
const ROUNDS: usize = 16;
/// Number of rounds after which steps are halved: where a curve turns by a right angle from CV to CV, full steps overshoot.
const QUICK: usize = 8;
/// Rounds without improvement after which equalising stops: in the air, and where the skin moves CVs, whose jumps no round mends.
const STALE: usize = 5;
const STALE_ON_SKIN: usize = 2;
/// Ratio of chords that counts as equal.
const ALIKE: f32 = 1.01;

/// Cost of querying the skin at a point, relative to placing a CV.
const ASKED: u64 = 8;
/// Cost of pushing a point out of the skin, relative to placing a CV.
const PUSHED: u64 = 100;
/// Cost of routing a curve around what tears it, relative to placing a CV; it searches paths through the air.
const LED: u64 = 15_000;

/// Cost of a query in a search for a way out, relative to placing a CV.
const LOOK: u64 = 20;

/// Remaining budget: CVs to place, and queries of searches for a way out of the skin.
pub(super) struct Allowance<'a> {
    most: u64,
    left: Cell<u64>,
    looks: Patience,
    is_cancelled: &'a dyn Fn() -> bool,
}

impl<'a> Allowance<'a> {
    /// A budget of `most` CVs, and the queries that cost as much. It is spent at once on cancellation.
    pub(super) fn new(most: u64, is_cancelled: &'a dyn Fn() -> bool) -> Self {
        Self { most, left: Cell::new(most), looks: Patience::new(most / LOOK), is_cancelled }
    }
    /// A budget of unlimited CVs and `looks` queries.
    pub(super) fn of_looks(looks: u64, is_cancelled: &'a dyn Fn() -> bool) -> Self {
        Self { most: 0, left: Cell::new(u64::MAX), looks: Patience::new(looks), is_cancelled }
    }
    /// Remaining CVs.
    pub(super) fn left(&self) -> u64 {
        self.left.get()
    }
    /// Cost, in CVs, of the queries spent of those that came with the CVs.
    pub(super) fn looked(&self) -> u64 {
        LOOK * (self.most / LOOK).saturating_sub(self.looks.left())
    }
    /// Remaining queries.
    pub(super) fn looks(&self) -> &Patience {
        &self.looks
    }
    pub(super) fn is_out(&self) -> bool {
        self.left.get() == 0
    }
    /// Spends `points` CVs; returns whether any remain.
    fn has(&self, points: u64) -> bool {
        self.left.set(if (self.is_cancelled)() {
            0
        } else {
            self.left.get().saturating_sub(points)
        });
        !self.is_out()
    }
}

/// CVs that represent a curve.
#[derive(Clone, Default)]
pub(super) struct Read {
    /// Largest distance between their readings, cm.
    pub(super) left: f32,
    pub(super) points: Vec<Vec3>,
    /// Their positions on the original curve: arc length and place.
    pub(super) stops: Vec<(f32, SplineParam)>,
    /// Largest displacement from there, cm; `None` if the curve was only resampled.
    pub(super) moved: f32,
    /// Whether the skin moved any of them.
    pub(super) on_skin: bool,
    /// How much deeper than allowed the curve that is drawn through them lies, cm; 0 where it does not.
    pub(super) dip: f32,
}

impl Read {
    /// The original curve.
    pub(super) fn of(points: &[Vec3], left: f32) -> Self {
        let last = points.len() - 1;
        let place =
            |k: usize| SplineParam { span: k.min(last - 1), t: if k == last { 1.0 } else { 0.0 } };
        let stops = (0..=last).map(|k| (0.0, place(k))).collect();
        Self { left, points: points.to_vec(), stops, moved: 0.0, on_skin: true, dip: 0.0 }
    }

    /// Whether all tools read one curve, and that lies no deeper than it may.
    pub(super) fn agrees(&self) -> bool {
        self.left <= AGREE && self.dip == 0.0
    }
}

/// A curve to repair.
pub(super) struct Mender<'a> {
    pub(super) old: &'a [Vec3],
    pub(super) spline: &'a Spline,
    /// Scratch memory for the spline of the new CVs.
    pub(super) led: &'a mut Spline,
    pub(super) skin: Option<&'a Skin<'a>>,
    /// Allowed depth in the skin at a place, cm.
    pub(super) depth: &'a dyn Fn(SplineParam) -> f32,
    /// Whether a result is barred.
    pub(super) is_barred: &'a dyn Fn(&Read) -> bool,
    pub(super) patience: &'a Allowance<'a>,
}

impl Mender<'_> {
    pub(super) fn read_alike(&mut self, effort: Effort) -> Read {
        let mut tried: Vec<Read> = vec![];
        for finer in FINER {
            let (read, leaps) = self.resampled(finer);
            if self.takes(&read) {
                return read;
            }
            tried.push(read);
            if leaps {
                break;
            }
        }
        if let (Some(skin), Effort::Moved | Effort::Led) = (self.skin, effort) {
            let leads = if effort == Effort::Led { &LEADS[..] } else { &[] };
            let mut starts = vec![tried[0].clone()];
            let mut nearest: Option<Read> = None;
            let near = NEARBY.0 * self.deepest() + NEARBY.1;
            for manner in MANNERS {
                for k in 0..=leads.len() {
                    if k == starts.len() {
                        if !self.patience.has(LED) {
                            break;
                        }
                        let led = self.led_round(skin, leads[k - 1]);
                        if self.takes(&led) {
                            return led;
                        }
                        starts.push(led);
                    }
                    let read = MOVED_FINER.into_iter().find_map(|finer| {
                        let read = self.moved_out(skin, &starts[k], finer, manner)?;
                        self.takes(&read).then_some(read)
                    });
                    match read {
                        Some(read) if read.moved <= near => return read,
                        Some(read) if nearest.as_ref().is_none_or(|n| read.moved < n.moved) => {
                            nearest = Some(read);
                        }
                        _ => {}
                    }
                }
                if let Some(read) = nearest {
                    return read;
                }
            }
            let stays = |led: &Read| led.moved <= THROWN && !(self.is_barred)(led);
            tried.extend(starts.into_iter().skip(1).filter(stays));
        }
        tried.sort_by(|a, b| a.left.max(a.dip).total_cmp(&b.left.max(b.dip)));
        tried.swap_remove(0)
    }

    /// Whether a result is one to take: read alike, out of the skin, near its place and not barred.
    pub(super) fn takes(&self, read: &Read) -> bool {
        read.agrees() && read.moved <= THROWN && !(self.is_barred)(read)
    }

    /// The curve with its own CVs, out of the skin where it dips between them.
    pub(super) fn lifted(&self) -> Read {
        let mut read = Read::of(self.old, 0.0);
        if let Some(skin) = self.skin {
            let Read { points, stops, .. } = &mut read;
            clear_drawn(skin, points, |k| (self.depth)(stops[k].1));
            read.moved = self.moved(&read);
        }
        self.judged(read)
    }

    /// The same, once what dips between CVs is out of the skin, as far as that goes.
    fn settled(&self, read: Read) -> Read {
        let mut read = self.judged(read);
        match self.skin.filter(|_| read.dip > 0.0) {
            None => read,
            Some(skin) => {
                let Read { points, stops, .. } = &mut read;
                clear_drawn(skin, points, |k| (self.depth)(stops[k].1));
                read.on_skin = true;
                self.judged(read)
            }
        }
    }

    /// How CVs are read, and how deep the curve through them dips.
    fn judged(&self, mut read: Read) -> Read {
        read.left = readings_differ(&read.points);
        let depth = |k: usize| (self.depth)(read.stops[k].1);
        read.dip = self.skin.map_or(0.0, |skin| deepest_dip(skin, &read.points, depth));
        read
    }

    /// The number of segments times a factor.
    fn segments(&self, of: usize, finer: f32) -> usize {
        ((of as f32 * finer) as usize).min((MOST_A_CURVE - 1).max(self.old.len() - 1))
    }

    fn clear(&self, p: Vec3, place: SplineParam) -> Vec3 {
        let Some(skin) = self.skin else { return p };
        let (out, moved) = lift(skin, p, -(self.depth)(place));
        if moved {
            self.patience.looks.take(1);
            self.patience.has(PUSHED);
        }
        out
    }

    /// Largest distance that the curve would have to move to clear the skin, cm, sampled at up to four points per segment.
    fn deepest(&self) -> f32 {
        let steps = 4 * (self.old.len() - 1);
        if !self.patience.has(ASKED * steps as u64) {
            return 0.0;
        }
        let way = |k: usize| {
            let place = self.spline.locate_length(self.spline.length() * k as f32 / steps as f32);
            let p = self.spline.point(place);
            self.clear(p, place).distance(p)
        };
        (1..=steps).map(way).fold(0.0, f32::max)
    }

    /// Largest distance of CVs from their original positions.
    fn moved(&self, read: &Read) -> f32 {
        let far = |(p, stop): (&Vec3, &(f32, SplineParam))| p.distance(self.spline.point(stop.1));
        read.points.iter().zip(&read.stops).map(far).fold(0.0, f32::max)
    }

    /// CVs with equal chords, out of the skin; and whether that makes them jump, which more CVs would not mend.
    fn resampled(&self, finer: f32) -> (Read, bool) {
        let last = self.segments(self.old.len() - 1, finer);
        let mut read = Read::default();
        // Among folds every round would be torn again: CVs that are even in the air are pushed once.
        let once = self.skin.is_some_and(Skin::is_rough);
        let pushed = Cell::new(false);
        let stale = || if pushed.get() { STALE_ON_SKIN } else { STALE };
        let alike =
            alike_chords(self.spline, last, &mut read, self.patience, &stale, |k, place| match k {
                0 => self.old[0],
                k if k == last => self.old[self.old.len() - 1],
                _ => {
                    let p = self.spline.point(place);
                    let out = if once { p } else { self.clear(p, place) };
                    pushed.set(pushed.get() || out != p);
                    out
                }
            });
        if let (true, Some(skin)) = (once, self.skin) {
            let Read { points, stops, .. } = &mut read;
            clear(skin, &mut points[..last], |k| Some((self.depth)(stops[k].1)));
            self.patience.looks.take(2 * last as u64);
        }
        read.on_skin = pushed.get();
        (self.settled(read), !alike && pushed.get())
    }

    /// The same, of the curve routed around what tears it.
    fn led_round(&mut self, skin: &Skin, torn: Torn) -> Read {
        let last = self.segments(self.old.len() - 1, 1.0);
        let mut read = Read::default();
        alike_chords(self.spline, last, &mut read, self.patience, &|| STALE, |_, place| {
            self.spline.point(place)
        });
        let Read { points, stops, .. } = &mut read;
        clear_beyond(skin, torn, points, |k| Some((self.depth)(stops[k].1)));
        self.even(&mut read, last, true);
        let mut read = self.settled(read);
        read.moved = self.moved(&read);
        read
    }

    /// Equalises chords along the curve of these CVs; returns whether it succeeded.
    fn even(&mut self, read: &mut Read, last: usize, clears: bool) -> bool {
        if self.led.rebuild(&read.points).is_err() {
            return false;
        }
        let tip = read.points[read.points.len() - 1];
        let was: Vec<f32> = read.stops.iter().map(|(s, _)| *s).collect();
        let before = |place: SplineParam| {
            let (a, b) = (was[place.span], was[place.span + 1]);
            a + (b - a) * place.t
        };
        alike_chords(self.led, last, read, self.patience, &|| STALE, |k, place| match k {
            0 => self.old[0],
            k if k == last => tip,
            _ if clears => {
                self.clear(self.led.point(place), self.spline.locate_length(before(place)))
            }
            _ => self.led.point(place),
        });
        for (s, place) in &mut read.stops {
            *s = before(*place);
            *place = self.spline.locate_length(*s);
        }
        true
    }

    /// CVs with equal chords of the curve, moved as a whole until none is too deep and its readings agree; `None` if that fails.
    fn moved_out(&mut self, skin: &Skin, from: &Read, finer: f32, manner: Manner) -> Option<Read> {
        let mut read = from.clone();
        let last = self.segments(from.points.len() - 1, finer);
        for round in 0..MOVES {
            let has = self.patience.has(ASKED * read.points.len() as u64);
            if !has || !self.even(&mut read, last, false) {
                return None;
            }
            let stops = &read.stops;
            // The moves grow, so that CVs pulled back by evening come out in the end.
            let beyond = (1.1 + manner.growth * round as f32).min(FARTHEST.0);
            if !move_out(&mut read.points, |k| (self.depth)(stops[k].1), skin, beyond, manner.hard)
            {
                read = self.judged(read);
                if read.agrees() {
                    read.moved = self.moved(&read);
                    return Some(read);
                }
                if !manner.hard {
                    return None;
                }
                ease(&mut read.points);
            }
        }
        None
    }
}

/// `last` + 1 CVs on the spline with chords so equal that both readings agree, however sharply it bends (at even arc length,
/// chords are shorter where it bends); and their positions on it (arc length and place). `point` returns the CV at a place, which
/// may have to clear the skin; `most_stale` is the largest number of rounds without improvement. Also returns whether chords
/// became equal.
fn alike_chords(
    spline: &Spline,
    last: usize,
    read: &mut Read,
    patience: &Allowance,
    most_stale: &dyn Fn() -> usize,
    point: impl Fn(usize, SplineParam) -> Vec3,
) -> bool {
    let Read { points, stops, .. } = read;
    let mut chords: Vec<f32> = Vec::with_capacity(last);
    // Places the CVs at these arc lengths; returns the ratio of the longest chord to the shortest.
    let sample = |wanted: &[f32],
                  stops: &mut Vec<(f32, SplineParam)>,
                  points: &mut Vec<Vec3>,
                  chords: &mut Vec<f32>|
     -> f32 {
        let mut cursor = 0;
        stops.clear();
        stops.extend(wanted.iter().map(|s| (*s, spline.locate_rising(&mut cursor, *s))));
        points.clear();
        points.extend(stops.iter().enumerate().map(|(k, (_, place))| point(k, *place)));
        chords.clear();
        chords.extend(points.windows(2).map(|w| w[0].distance(w[1])));
        let (least, most) =
            chords.iter().fold((f32::MAX, 0.0f32), |(a, b), c| (a.min(*c), b.max(*c)));
        most / least.max(1e-9)
    };
    let mut wanted: Vec<f32> =
        (0..=last).map(|k| k as f32 / last as f32 * spline.length()).collect();
    // Where the skin makes a curve jump, more CVs make no shorter chords: the best round counts, and rounds without improvement
    // end the search.
    let mut best = (f32::MAX, wanted.clone());
    let mut stale = 0;
    for round in 0..ROUNDS {
        let ratio = sample(&wanted, stops, points, &mut chords);
        if ratio <= ALIKE || readings_agree(points).is_some() {
            return true;
        }
        if !patience.has(points.len() as u64) {
            return false;
        }
        stale += 1;
        if ratio < best.0 {
            best.0 = ratio;
            best.1.copy_from_slice(&wanted);
            stale = 0;
        }
        if stale >= most_stale() {
            break;
        }
        // The arc length at which the sum of chords reaches an even share.
        let total: f32 = chords.iter().sum();
        let (mut k, mut come) = (0, 0.0);
        for (n, stop) in wanted.iter_mut().enumerate().take(last).skip(1) {
            let share = total * n as f32 / last as f32;
            while k + 1 < last && come + chords[k] < share {
                come += chords[k];
                k += 1;
            }
            let chord = chords[k];
            let part = if chord > 0.0 { ((share - come) / chord).clamp(0.0, 1.0) } else { 0.0 };
            let even = stops[k].0 + (stops[k + 1].0 - stops[k].0) * part;
            *stop += (even - *stop) * if round < QUICK { 1.0 } else { 0.5 };
        }
    }
    if sample(&wanted, stops, points, &mut chords) > best.0 {
        sample(&best.1, stops, points, &mut chords);
    }
    false
}

/// Moves CVs that are deeper in the skin than allowed out of it, by `beyond` times the required distance, and their neighbours
/// along with them, decreasing with distance. Returns whether any moved.
fn move_out(
    points: &mut [Vec3],
    depth: impl Fn(usize) -> f32 + Copy,
    skin: &Skin,
    beyond: f32,
    aside: bool,
) -> bool {
    // Reach of a move to either side, as a multiple of the move and of the mean chord.
    const ALONG: (f32, f32) = (6.0, 3.0);
    let n = points.len();
    let mut come = vec![0.0f32; n];
    for k in 1..n {
        come[k] = come[k - 1] + points[k].distance(points[k - 1]);
    }
    let chord = come[n - 1] / (n - 1) as f32;
    let out = |k: usize| {
        let way = lift(skin, points[k], -depth(k)).0 - points[k];
        if way.length() > NEAR { way } else { Vec3::ZERO }
    };
    let mut ways: Vec<Vec3> = (1..n).map(out).collect();
    ways.insert(0, Vec3::ZERO);
    for dip in dips(skin, points, depth) {
        for k in [dip.span, dip.span + 1].into_iter().filter(|k| *k > 0) {
            if ways[k].length() < dip.excess {
                ways[k] = dip.way_out();
            }
        }
    }
    for k in 1..n - 1 {
        if aside && ways[k].dot(ways[k + 1]) < 0.0 {
            let through = (ways[k + 1] - ways[k]).normalize_or_zero();
            let along = (points[k + 1] - points[k]).normalize_or_zero();
            let middle = (points[k] + points[k + 1]) * 0.5;
            if let Some(aside) = way_out(skin, middle, through, along) {
                (ways[k], ways[k + 1]) = (aside / beyond, aside / beyond);
            }
        }
    }
    let mut moves = vec![Vec3::ZERO; n];
    for k in (1..n).filter(|k| ways[*k] != Vec3::ZERO) {
        let reach = (ALONG.0 * ways[k].length()).max(ALONG.1 * chord);
        let way = ways[k] * beyond.min(1.0 + FARTHEST.1 / ways[k].length());
        let goes_along = |j: &usize| (come[*j] - come[k]).abs() < reach;
        for j in (k..n).take_while(goes_along).chain((1..k).rev().take_while(goes_along)) {
            let off = (come[j] - come[k]) / reach;
            let by = way * ((1.0 - off * off) * (1.0 - off * off));
            // The strongest of several moves counts: neighbours that are both in the skin move the same way out.
            if by.length_squared() > moves[j].length_squared() {
                moves[j] = by;
            }
        }
    }
    points.iter_mut().zip(moves).for_each(|(p, by)| *p += by);
    ways.iter().any(|way| *way != Vec3::ZERO)
}

/// Smooths CVs around the spans where readings differ, except at the ends, towards the mean of their neighbours.
fn ease(points: &mut [Vec3]) {
    const REACH: usize = 3;
    let n = points.len();
    let mut shares = vec![0.0f32; n];
    each_span(points, |span, difference| {
        if difference > AGREE {
            let end = (span + 2 + REACH).min(n - 1);
            for (k, share) in shares.iter_mut().enumerate().take(end).skip(1) {
                let off = span.saturating_sub(k).max(k.saturating_sub(span + 1));
                *share = share.max(1.0 - off as f32 / (REACH + 1) as f32);
            }
        }
    });
    let was = points.to_vec();
    for k in 1..n - 1 {
        points[k] += ((was[k - 1] + was[k + 1]) * 0.5 - was[k]) * (0.5 * shares[k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::route::skin_clear::tests::{bust, hairs};
    use crate::data::scalp::tests::shared_ball;
    use crate::maths::transcendental::sin_cos_turns;

    /// Of a curve that may nowhere lie in the skin.
    fn mender<'a>(
        old: &'a [Vec3],
        spline: &'a Spline,
        led: &'a mut Spline,
        skin: &'a Skin<'a>,
        patience: &'a Allowance<'a>,
    ) -> Mender<'a> {
        let (depth, is_barred) = (&|_| 0.0, &|_: &Read| false);
        Mender { old, spline, led, skin: Some(skin), depth, is_barred, patience }
    }

    #[test]
    fn coils_that_an_ear_tears_are_read_alike_and_stay_near_where_they_were() {
        let scalp = bust();
        let skin = scalp.skin();
        let (mut torn, mut far) = (0, 0);
        for hair in hairs().into_iter().filter(|hair| skin.distance(hair[0]) > 0.0) {
            // As nodes leave it: each point pushed alone.
            let push = |(k, p): (usize, Vec3)| {
                let (sin, cos) = sin_cos_turns(k as f32 * 0.1);
                let p = p + Vec3::new(cos - 1.0, 0.0, sin) * 0.3;
                if k == 0 { p } else { lift(&skin, p, 0.0).0 }
            };
            let coil: Vec<Vec3> = hair.into_iter().enumerate().map(push).collect();
            let spline = Spline::new(&coil).unwrap();
            let mut led = Spline::default();
            let patience = Allowance::of_looks(u64::MAX, &|| false);
            let mut mender = mender(&coil, &spline, &mut led, &skin, &patience);
            let read = mender.read_alike(Effort::Led);
            if read.moved > 0.0 {
                torn += 1;
                far += usize::from(read.moved > 2.0);
                assert!(read.agrees(), "{}", read.left);
                assert!(read.moved <= THROWN, "thrown {} cm", read.moved);
                assert_eq!(read.points[0], coil[0]);
            }
        }
        println!("{torn} torn, {far} moved by more than 2 cm");
        assert!(torn > 200 && far * 20 < torn, "{far} of {torn} are moved by more than 2 cm");
    }

    #[test]
    fn a_curve_is_moved_out_as_a_whole_and_its_chords_stay_alike() {
        let scalp = shared_ball();
        let skin = scalp.skin();
        // A coil along the ball, its turns half in it, from a root on it to a tip in it.
        let coil: Vec<Vec3> = (0..=160)
            .map(|k| {
                let t = k as f32 / 160.0;
                let (rise, over) = sin_cos_turns(0.25 - 0.2 * t);
                let (sin, cos) = sin_cos_turns(14.0 * t);
                let out = Vec3::new(over, rise, 0.0);
                out * (8.9 + 0.4 * sin) + (Vec3::Z * 0.4 * cos)
            })
            .collect();
        let spline = Spline::new(&coil).unwrap();
        let mut led = Spline::default();
        let patience = Allowance::of_looks(u64::MAX, &|| false);
        let mut mender = mender(&coil, &spline, &mut led, &skin, &patience);
        let deepest = |points: &[Vec3]| points.iter().map(|p| 8.9 - p.length()).fold(0.0, f32::max);
        let (mut from, _) = mender.resampled(1.0);
        for (p, stop) in from.points.iter_mut().zip(&from.stops) {
            *p = spline.point(stop.1);
        }
        assert!(deepest(&coil) > 0.35, "{}", deepest(&coil));
        let moved = mender.moved_out(&skin, &from, 1.0, MANNERS[0]).unwrap();
        assert!(moved.agrees(), "{}", moved.left);
        assert_eq!(moved.points[0], coil[0]);
        // The ball is a mesh whose faces lie up to a fiftieth within the sphere.
        assert!(deepest(&moved.points[1..]) < 0.02 + NEAR, "{}", deepest(&moved.points[1..]));
        let far = moved.points.iter().zip(&moved.stops).map(|(p, s)| p.distance(spline.point(s.1)));
        assert!(far.fold(0.0, f32::max) < 0.7, "it goes no farther than it has to");
    }
}
