//! The shape of a pen stroke: even steps, full circles, loops, scribbles and straightness.
//!
//! Points are pixels, x to the right and y down, so that clockwise on the screen is positive. `rho` is the reach of the
//! pen in the same pixels (30 in a picture 1000 high, [`RHO`]) and the scale of everything here: a stroke twice as
//! large under a `rho` twice as large has the same shape.
//!
//! Guarantees: every finite stroke has a shape, including the empty one; the mirrored stroke has the mirrored shape;
//! time is linear in the points, except for loops, which are searched among [`MOST_STEPS`] steps at most: a stroke too
//! long for steps of `rho / 10` is sampled more coarsely, and loops smaller than the steps are missed.

use crate::maths::transcendental::atan2;
use glam::Vec2;
use std::f32::consts::{PI, TAU};

/// Reach of the pen, pixels, in a picture 1000 pixels high.
pub const RHO: f32 = 30.0;
/// The most steps that are searched for loops and circles.
pub const MOST_STEPS: usize = 2000;
/// The most points of a resampled stroke.
pub const MOST_RESAMPLED: usize = 50_000;

/// Where a stroke closes a loop: it crosses itself, or ends where it came by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Position of the crossing or end, pixels.
    pub at: Vec2,
    /// 1 clockwise, -1 counterclockwise.
    pub sign: f32,
}

/// A stroke back and forth over a narrow track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scribble {
    /// Mean width from side to side, pixels.
    pub amplitude: f32,
    /// Number of reversals, at least 3.
    pub reversals: u32,
}

/// Straightness of a stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Straightness {
    /// Distance from the first to the last point, pixels.
    pub chord: f32,
    /// Chord divided by the length of the stroke without its tremor: 1 if straight, 0 if closed.
    pub chord_by_length: f32,
    /// Largest distance from the chord, pixels.
    pub bow: f32,
}

/// The stroke as a polyline whose segments are all `step` pixels long, starting at its first point. A remainder shorter
/// than a step is dropped, and so is everything after the first [`MOST_RESAMPLED`] points. Empty for no points; only
/// the first point if `step` is not above 0.
pub fn resampled(points: &[Vec2], step: f32) -> Vec<Vec2> {
    stepped(points, step, MOST_RESAMPLED).0
}

/// Number of full circles of the stroke: clockwise minus counterclockwise. A circle counts 30 degrees before it closes,
/// since hands stop short; it may drift and be as flat as 1 to 3.
pub fn full_circles(points: &[Vec2], rho: f32) -> i32 {
    let path = Path::of(points, rho);
    // Where the next circle starts counting: where the last one ended, or the hand reversed.
    let (mut count, mut low, mut high) = (0, 0.0_f32, 0.0_f32);
    for (j, &turned) in path.turned.iter().enumerate() {
        low = low.min(turned + (TAU - FULL));
        high = high.max(turned - (TAU - FULL));
        let sign = if turned - low >= FULL {
            low += TAU;
            1.0
        } else if high - turned >= FULL {
            high -= TAU;
            -1.0
        } else {
            continue;
        };
        // The last such turn, so that a straight lead-in is not part of it.
        let first = (0..j).rev().find(|&i| (turned - path.turned[i]) * sign >= FULL);
        let round = first.map_or(0.0, |i| path.roundness(i, j, path.points[i]));
        count += if round * sign >= ROUND { sign as i32 } else { 0 };
    }
    count
}

/// Where the stroke closes loops, in order. Each turn of the hand counts once, however many earlier turns it crosses.
/// Not loops: anything shorter around than half of `rho`, and a path there and back whose halves cross.
pub fn loops(points: &[Vec2], rho: f32) -> Vec<Loop> {
    let path = Path::of(points, rho);
    let mut found: Vec<Loop> = vec![];
    // The step that closed the last loop; the turn at which the first of overlapping loops was closed, and the number
    // of these.
    let (mut last, mut base, mut shared) = (0, 0.0, 0.0);
    for j in 2..path.steps() {
        let turned = path.turned[j] - base;
        // Over the same ground, a loop counts only after another full turn; over new ground, at once.
        let again = !found.is_empty() && turned.abs() >= TAU * shared - NEARLY;
        let least = if again { 0 } else { last };
        let closed = path.crossings(least, j).find_map(|(i, at)| {
            let round = path.roundness(i, j, at);
            let fits = i >= last || turned * round > 0.0;
            let long = path.length[j] - path.length[i] >= rho * LEAST_LOOP;
            (fits && long && round.abs() >= ROUND).then(|| (i, Loop { at, sign: round.signum() }))
        });
        if let Some((i, one)) = closed {
            (base, shared) = if i >= last { (path.turned[j], 1.0) } else { (base, shared + 1.0) };
            last = j;
            found.push(one);
        }
    }
    found.extend(path.closed_at_end(last, rho));
    found
}

/// The stroke as a scribble; `None` if it reverses fewer than three times, or goes around rather than back and forth.
/// If it also advances, its width is measured across the advance.
pub fn scribble(points: &[Vec2], rho: f32) -> Option<Scribble> {
    let turns = reversals(points, rho);
    let swings: Vec<(f32, f32)> = turns.windows(2).map(|t| bulge(&points[t[0]..=t[1]])).collect();
    // For a path back over itself, however it bends, the areas of two swings cancel; those of half circles add up.
    let (area, square) = swings.windows(2).fold((0.0, 0.0), |(area, square), w| {
        (area + (w[0].0 + w[1].0).abs(), square + w[0].1 + w[1].1)
    });
    if turns.len() < 3 || area > FLAT * square {
        return None;
    }
    let width = |t: &[usize]| points[t[1]].distance(points[t[0]].midpoint(points[t[2]]));
    let amplitude = turns.windows(3).map(width).sum::<f32>() / (turns.len() - 2) as f32;
    Some(Scribble { amplitude, reversals: turns.len() as u32 })
}

/// Straightness of the stroke; all 0 if it does not move.
pub fn straightness(points: &[Vec2], rho: f32) -> Straightness {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Straightness::default();
    };
    let path = Path::of(points, rho);
    // The remainder after the last whole step counts as well.
    let over = path.points.last().map_or(0.0, |p| p.distance(last));
    let (chord, length) =
        (first.distance(last), path.length.last().map_or(0.0, |whole| whole + over));
    let along = (last - first).normalize_or_zero();
    // A point past an end is as far away as it is from that end.
    let off = |p: &Vec2| (*p - first).distance(along * along.dot(*p - first).clamp(0.0, chord));
    let bow = path.points.iter().map(off).fold(0.0, f32::max);
    Straightness { chord, chord_by_length: if length > 0.0 { chord / length } else { 0.0 }, bow }
}

/// A circle counts as full at this turn, radians.
const FULL: f32 = TAU * 330.0 / 360.0;
/// How much earlier than a full turn the next loop over the same ground may close, radians.
const NEARLY: f32 = PI / 3.0;
/// Shortest circumference of a loop, in `rho`.
const LEAST_LOOP: f32 = 0.5;
/// A stroke that ends this near to its own way has closed, in `rho`.
const TOUCHES: f32 = 0.25;
/// Smallest [`Path::roundness`] of circles and loops: that of an ellipse of 1 to 5.
const ROUND: f32 = 0.45;
/// Largest area enclosed by two swings of a scribble, relative to the squares of their chords: that of an ellipse of 3
/// to 8.
const FLAT: f32 = 0.15;
/// Swings shorter than this are tremor, in `rho`.
const LEAST_SWING: f32 = 0.15;
/// A stroke reverses where it comes back by this fraction of its way.
const BACK: f32 = 0.125;
/// Coming back by less than this is tremor, in `rho`.
const LEAST_RETURN: f32 = 0.12;

/// A stroke in even steps without its tremor.
struct Path {
    points: Vec<Vec2>,
    /// Arc length at each point, pixels.
    length: Vec<f32>,
    /// Turn of each step relative to the first, radians, clockwise.
    turned: Vec<f32>,
    /// Twice the area swept about the first point; 64 bits, since small loops may be far out.
    swept: Vec<f64>,
    /// Bounding box of each [`RUN`] steps.
    boxes: Vec<(Vec2, Vec2)>,
}

/// Steps per box.
const RUN: usize = 16;

impl Path {
    fn of(points: &[Vec2], rho: f32) -> Self {
        let mut step = if rho.is_finite() { rho.max(1e-3) * 0.1 } else { RHO * 0.1 };
        let mut points = loop {
            match stepped(points, step, MOST_STEPS) {
                (even, true) => break even,
                _ => step *= 2.0,
            }
        };
        for _ in 0..2 {
            let before = points.clone();
            for (p, w) in points.iter_mut().skip(1).zip(before.windows(3)) {
                *p = (w[0] + w[1] * 2.0 + w[2]) * 0.25;
            }
        }
        let mut path =
            Self { points, length: vec![], turned: vec![], swept: vec![], boxes: vec![] };
        let (mut length, mut swept) = (0.0, 0.0);
        let (mut ahead, mut turned) = (Vec2::ZERO, 0.0);
        for w in path.points.windows(2) {
            path.length.push(length);
            path.swept.push(swept);
            let step = w[1] - w[0];
            length += step.length();
            let [a, b] = [w[0], w[1]].map(|p| (p - path.points[0]).as_dvec2());
            swept += a.perp_dot(b);
            // Straight back has no direction of rotation.
            let aside = ahead.perp_dot(step);
            turned += if aside == 0.0 { 0.0 } else { atan2(aside, ahead.dot(step)) };
            path.turned.push(turned);
            ahead = if step == Vec2::ZERO { ahead } else { step };
        }
        path.length.push(length);
        path.swept.push(swept);
        path.boxes = (0..path.steps()).step_by(RUN).map(|i| path.around(i, i + RUN)).collect();
        path
    }

    fn steps(&self) -> usize {
        self.points.len().saturating_sub(1)
    }

    /// Bounding box of a half-open range of steps.
    fn around(&self, first: usize, end: usize) -> (Vec2, Vec2) {
        let steps = &self.points[first..=end.min(self.steps())];
        steps.iter().fold((Vec2::MAX, Vec2::MIN), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
    }

    /// Earlier steps from `least` on that step `j` crosses, and the positions, latest first; not the one right before
    /// it.
    fn crossings(&self, least: usize, j: usize) -> impl Iterator<Item = (usize, Vec2)> {
        let (lo, hi) = self.around(j, j + 1);
        let near = move |run: &usize| {
            let (low, high) = self.boxes[*run];
            low.cmple(hi).all() && lo.cmple(high).all()
        };
        let end = j.saturating_sub(1);
        let runs = (least / RUN..end.div_ceil(RUN)).rev().filter(near);
        runs.flat_map(move |run| (least.max(run * RUN)..end.min((run + 1) * RUN)).rev())
            .filter_map(move |i| Some((i, self.crossing(i, j)?)))
    }

    /// Where one step crosses another. A step owns the side with nothing to its left, so that a stroke through the end
    /// of a step crosses once.
    fn crossing(&self, i: usize, j: usize) -> Option<Vec2> {
        let [a, b, c, d] = [i, i + 1, j, j + 1].map(|k| self.points[k]);
        let (first, second) = (b - a, d - c);
        let apart = |way: Vec2, from: Vec2, p: Vec2, q: Vec2| {
            (way.perp_dot(p - from) > 0.0) != (way.perp_dot(q - from) > 0.0)
        };
        let slope = first.perp_dot(second);
        (slope != 0.0 && apart(first, a, c, d) && apart(second, c, a, b))
            .then(|| a + first * ((c - a).perp_dot(second) / slope))
    }

    /// The loop that the stroke closes where it ends beside its own way from step `least` on, without crossing it.
    fn closed_at_end(&self, least: usize, rho: f32) -> Option<Loop> {
        let j = self.steps().checked_sub(1)?;
        let at = self.points[j + 1];
        let back = |i: &usize| {
            (self.turned[j] - self.turned[*i]).abs() >= FULL
                && self.points[*i].distance(at) <= rho * TOUCHES
        };
        let i = (least..j).rev().find(back)?;
        let round = self.roundness(i, j, at);
        let long = self.length[j] - self.length[i] >= rho * LEAST_LOOP;
        (long && round.abs() >= ROUND).then(|| Loop { at, sign: round.signum() })
    }

    /// The area that the stroke encloses between position `at` on step `i` and its return near step `j`, relative to
    /// that of circles with the same turns and circumference: 1 for circles, positive clockwise.
    fn roundness(&self, i: usize, j: usize, at: Vec2) -> f32 {
        let [a, b, at] =
            [self.points[i + 1], self.points[j], at].map(|p| (p - self.points[0]).as_dvec2());
        let area = self.swept[j] - self.swept[i + 1] + b.perp_dot(at) + at.perp_dot(a);
        let around = self.length[j] - self.length[i + 1] + (a.distance(at) + b.distance(at)) as f32;
        let turns = (self.turned[j] - self.turned[i]).abs() / TAU;
        let most = around * around / (2.0 * PI * turns.round().max(1.0));
        if most > 0.0 { area as f32 / most } else { 0.0 }
    }
}

/// Points at a constant distance along a stroke, starting at its first, at most `most`, and whether these were enough.
/// A stroke within one step of its first point has no second.
fn stepped(points: &[Vec2], step: f32, most: usize) -> (Vec<Vec2>, bool) {
    let Some(&first) = points.first() else { return (vec![], true) };
    let mut even = vec![first];
    if step.is_nan() || step <= 0.0 {
        return (even, true);
    }
    let (mut last, mut from) = (first, first);
    for &to in points {
        // The position ahead where the path leaves the circle of one step around the last point.
        while to.distance(last) >= step {
            let (way, off) = (to - from, from - last);
            let (a, b, c) = (way.dot(way), off.dot(way), off.dot(off) - step * step);
            let root = (b * b - a * c).max(0.0).sqrt();
            // The form of the root without cancellation.
            let share = if b > 0.0 { -c / (b + root) } else { (root - b) / a };
            last = from + way * share.clamp(0.0, 1.0);
            from = last;
            even.push(last);
            if even.len() >= most {
                return (even, false);
            }
        }
        from = to;
    }
    (even, true)
}

/// The points where a stroke reverses: the farthest from the previous one, if it then comes back by an eighth.
fn reversals(points: &[Vec2], rho: f32) -> Vec<usize> {
    let (mut turns, mut start, mut far) = (vec![], 0, 0);
    for (i, &p) in points.iter().enumerate() {
        let swing = points[far] - points[start];
        let reach = swing.length();
        let gone = p - points[start];
        let sure = reach >= rho * LEAST_SWING;
        // Progress along its own line, not distance from its start: a sharp zigzag that advances keeps moving away.
        if if sure { gone.dot(swing) >= reach * reach } else { gone.length() >= reach } {
            far = i;
        } else if sure
            && (points[far] - p).dot(swing) >= reach * (reach * BACK).max(rho * LEAST_RETURN)
        {
            turns.push(far);
            (start, far) = (far, i);
        }
    }
    turns
}

/// The area between a part of a stroke and its chord, clockwise, and the squared chord.
fn bulge(points: &[Vec2]) -> (f32, f32) {
    let first = points[0];
    let area = points.windows(2).map(|w| (w[0] - first).perp_dot(w[1] - first) * 0.5).sum();
    (area, points[points.len() - 1].distance_squared(first))
}

#[cfg(test)]
mod tests;
