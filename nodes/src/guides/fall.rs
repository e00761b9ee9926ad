//! How threads fall from a head: grown one after another from the lowest root to the highest, then relaxed together.
//!
//! A bent heavy thread turns toward gravity exponentially over a length (its stiffness), like an elastic rod under
//! tension. A thread therefore grows step by step: each step is turned toward gravity by that law, pushed out of the
//! skin and of earlier threads, and continued from there. Lower roots come first, since hair rooted higher lies on top.
//! Relaxation follows, with all threads updated at once from the previous round: each point is smoothed between its
//! neighbours along the thread, pulled down, pushed off other threads (half the overlap each) and off the skin, and put
//! back to its distance from the previous point.
//!
//! Guarantees: no clock, no order except that of height and id; every sum in a fixed order. Not promised: a simulation
//! over time.

use crate::data::route::makers;
use crate::data::scalp::{Root, Skin};
use crate::define::NodeError;
use crate::eval::EvalCx;
use crate::maths::frame::across;
use crate::maths::hash::Dice;
use crate::maths::nearest_on;
use crate::maths::spline::Spline;
use crate::maths::transcendental::{exp, sin, sin_cos};
use glam::{IVec3, Vec3};
use std::collections::BTreeMap;
use std::f32::consts::TAU;

/// A curve that is to fall. Lengths in cm.
pub(super) struct Thread {
    pub(super) id: u64,
    pub(super) point: Vec3,
    /// Its root, if it is rooted on a scalp.
    pub(super) root: Option<Root>,
    /// Direction along the skin in which it is laid. Unit.
    pub(super) flow: Vec3,
    /// The direction in which it leaves the root. Unit.
    pub(super) direction: Vec3,
    pub(super) length: f32,
    pub(super) clearance: f32,
    pub(super) stiffness: f32,
}

/// Settings shared by all threads.
pub(super) struct Fall<'a> {
    pub(super) skin: Option<Skin<'a>>,
    /// Direction of the pull. Unit.
    pub(super) down: Vec3,
    pub(super) hold: f32,
    pub(super) separate: bool,
    /// Angle (radians) of random deviation, and its dice.
    pub(super) stray: (f32, Dice),
    /// Points of each finished curve.
    pub(super) points: usize,
}

/// Height above the skin of a thread without thickness, cm.
const LEAST: f32 = 0.02;
/// Spacing of the points of a thread while it falls, cm.
const STEP: f32 = 0.3;
/// The most points of a thread while it falls.
const MOST: f32 = 900.0;
/// Rounds of relaxation.
const ROUNDS: usize = 24;
/// Rounds for which a list of neighbours is reused.
const LISTED: usize = 4;
/// Extra length of threads while they fall: whatever smoothing straightens is cut off at the end.
const SPARE: f32 = 1.04;
/// Cosine of the sharpest turn in one step.
const TURN: f32 = 0.3;
/// Wavelength of the random deviation, cm.
const WAVE: f32 = 14.0;

/// A thread while it falls.
struct Chain {
    step: f32,
    at: Vec<Vec3>,
}

impl Fall<'_> {
    /// The finished curves, in the order of the threads.
    pub(super) fn all(&self, threads: &[Thread], cx: &EvalCx) -> Result<Vec<Vec<Vec3>>, NodeError> {
        let mut order: Vec<usize> = (0..threads.len()).collect();
        let height = |i: usize| -threads[i].point.dot(self.down);
        order.sort_by(|a, b| {
            height(*a).total_cmp(&height(*b)).then(threads[*a].id.cmp(&threads[*b].id))
        });
        let thickest = threads.iter().map(|t| t.clearance).fold(0.0, f32::max);
        let mut grid = Grid::new(2.0 * thickest + 2.0 * STEP);
        let mut chains: Vec<Chain> = threads
            .iter()
            .map(|thread| {
                let steps = (thread.length / STEP).clamp(12.0, MOST);
                Chain { step: thread.length / steps, at: vec![] }
            })
            .collect();
        for i in order {
            cx.check()?;
            let grown = self.grow(&threads[i], i, chains[i].step, &grid, &chains, threads);
            chains[i].at = grown;
            if self.separate {
                grid.add(i, &chains[i].at);
            }
        }
        let mut near: Vec<Vec<Vec<(u32, u32)>>> = vec![];
        for round in 0..ROUNDS {
            cx.check()?;
            if self.separate && round % LISTED == 0 {
                near = neighbours(cx, threads, &chains, thickest)?;
            }
            let last = round + 3 >= ROUNDS;
            let next = cx.map(chains.len(), |i| {
                let near = near.get(i).map_or(&[][..], Vec::as_slice);
                Ok(self.relaxed(threads, &chains, i, near, last))
            })?;
            for (chain, at) in chains.iter_mut().zip(next) {
                chain.at = at;
            }
        }
        cx.map(threads.len(), |i| Ok(self.finished(&threads[i], &chains[i].at)))
    }

    /// Direction of the pull at arc length `s`: down, with slow random deviation.
    fn pull(&self, thread: &Thread, s: f32) -> Vec3 {
        let (angle, dice) = self.stray;
        if angle == 0.0 {
            return self.down;
        }
        let side = across(Vec3::X, self.down).unwrap_or(Vec3::Z);
        let other = self.down.cross(side);
        let wave = |n: u64| {
            let turns = s / (WAVE * dice.range(thread.id, 2 * n, 0.7, 1.5));
            sin((turns + dice.unit(thread.id, 2 * n + 1)) * TAU)
        };
        (self.down + (side * wave(0) + other * wave(1)) * angle).normalize_or(self.down)
    }

    fn grow(
        &self,
        thread: &Thread,
        number: usize,
        step: f32,
        grid: &Grid,
        chains: &[Chain],
        threads: &[Thread],
    ) -> Vec<Vec3> {
        let count = (thread.length * SPARE / step).ceil() as usize + 2;
        let mut at = Vec::with_capacity(count + 1);
        at.push(thread.point);
        let (mut p, mut direction) = (thread.point, thread.direction);
        let mut flow = thread.flow;
        let mut met = vec![];
        for k in 1..=count {
            let s = k as f32 * step;
            let height = height_at(thread, s);
            let mut to = p + direction * step;
            for _ in 0..3 {
                let (lifted, moved) = self.lift(to, height);
                to = lifted;
                let pushed = self.separate && {
                    grid.near(to, &mut met);
                    let mut pushed = false;
                    for (c, segment) in &met {
                        let other = &chains[*c as usize].at;
                        let step = chains[*c as usize].step;
                        let apart = apart(thread, s, &threads[*c as usize], *segment, step);
                        let push = keep_off(to, other, *segment as usize, apart);
                        to += push;
                        pushed |= push != Vec3::ZERO && *c as usize != number;
                    }
                    pushed
                };
                if !moved && !pushed {
                    break;
                }
                // A step that was held back keeps its length.
                to = p + (to - p).normalize_or(direction) * step;
            }
            to = self.lift(to, height).0;
            let mut went = (to - p).try_normalize().unwrap_or(direction);
            if went.dot(direction) < TURN {
                // If others leave no room, it continues over the skin, through them.
                to = self.lift(p + direction * step, height).0;
                to = self.lift(p + (to - p).normalize_or(direction) * step, height).0;
                went = (to - p).try_normalize().unwrap_or(direction);
            }
            direction = went;
            p = to;
            at.push(p);
            let mut free = 1.0;
            if let Some(skin) = self.skin
                && skin.distance(p) < height + 0.3
                && let Some(hit) = skin.closest(p)
            {
                let normal = (p - hit.point).try_normalize().unwrap_or(direction);
                flow = across(flow, normal).unwrap_or(flow);
                let held = if self.hold > 0.0 { exp(-s / self.hold) } else { 0.0 };
                let high = direction.dot(normal);
                if let Some(flat) = across(direction, normal) {
                    let flat = flat.lerp(flow, (held * step / 1.0).min(1.0)).normalize_or(flat);
                    direction = flat * (1.0 - high * high).max(0.0).sqrt() + normal * high;
                }
                free = 1.0 - held;
            }
            direction = turned_towards(direction, self.pull(thread, s), {
                let stiff = thread.stiffness.max(0.2 * step);
                free * (1.0 - exp(-step / stiff)) + (1.0 - free) * 0.1 * step
            });
        }
        at
    }

    fn relaxed(
        &self,
        threads: &[Thread],
        chains: &[Chain],
        number: usize,
        near: &[Vec<(u32, u32)>],
        exact: bool,
    ) -> Vec<Vec3> {
        let (thread, chain) = (&threads[number], &chains[number]);
        let (at, step) = (&chain.at, chain.step);
        let mut out = Vec::with_capacity(at.len());
        out.extend_from_slice(&at[..2]);
        for k in 2..at.len() {
            let s = k as f32 * step;
            let before = at[k - 1];
            let after = at.get(k + 1).copied().unwrap_or(at[k] * 2.0 - before);
            let mut p = at[k].lerp((before + after) * 0.5, 0.5);
            let held = if self.hold > 0.0 { exp(-s / self.hold) } else { 0.0 };
            let heavy = (1.0 - held) * (1.0 - exp(-s / thread.stiffness.max(0.1)));
            p += self.pull(thread, s) * (0.15 * step * heavy);
            let mut push = Vec3::ZERO;
            // The last rounds only smooth.
            for (c, segment) in near.get(k).into_iter().flatten().filter(|_| !exact) {
                let other = &chains[*c as usize];
                let apart = apart(thread, s, &threads[*c as usize], *segment, other.step);
                push += keep_off(p, &other.at, *segment as usize, apart);
            }
            p += (push * 0.5).clamp_length_max(0.5 * step);
            let height = height_at(thread, s);
            p = if exact { self.lift(p, height).0 } else { self.lift_about(p, height) };
            let (last, from) = (out[k - 1], out[k - 2]);
            let mut went = (p - last).normalize_or(self.down);
            let came = (last - from).normalize_or(went);
            if went.dot(came) < TURN {
                went = (went + came * (TURN + 1.0)).normalize_or(came);
            }
            let on = last + went * step;
            out.push(if exact { self.lift(on, height).0 } else { on });
        }
        out
    }

    fn lift(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        self.skin.map_or((p, false), |skin| makers::lift(&skin, p, height))
    }

    fn lift_about(&self, p: Vec3, height: f32) -> Vec3 {
        self.skin.map_or(p, |skin| makers::lift_about(&skin, p, height))
    }

    /// Smooths a fallen thread where it still turns sharply, squeezed between others.
    fn softened(&self, at: &[Vec3]) -> Vec<Vec3> {
        let mut at = at.to_vec();
        for _ in 0..80 {
            let mut sharp = false;
            for k in 1..at.len().saturating_sub(1) {
                let (a, b) = (at[k] - at[k - 1], at[k + 1] - at[k]);
                if a.dot(b) < 0.97 * (a.length_squared() * b.length_squared()).sqrt() {
                    sharp = true;
                    at[k] = self.lift((at[k - 1] + at[k + 1]) * 0.5, LEAST).0;
                }
            }
            if !sharp {
                break;
            }
        }
        at
    }

    /// The curve with evenly spaced points and exact length along a fallen thread.
    fn finished(&self, thread: &Thread, at: &[Vec3]) -> Vec<Vec3> {
        let at = &self.softened(at)[..];
        let Ok(mut spline) = Spline::new(at) else {
            return straight(thread, self.down, self.points);
        };
        let count = self.points;
        // Where crowding cost steps, the missing length is added at the tip.
        let mut longer = at.to_vec();
        while spline.length() < thread.length * 1.01 && longer.len() < 2 * at.len() {
            let tip = longer[longer.len() - 1];
            let (to, _) = self.lift(tip + self.down * (thread.length / at.len() as f32), LEAST);
            longer.push(to);
            if spline.rebuild(&longer).is_err() {
                return straight(thread, self.down, self.points);
            }
        }
        let mut cut = thread.length.min(spline.length());
        let mut points = Vec::with_capacity(count);
        for _ in 0..6 {
            points.clear();
            for k in 0..count {
                let s = cut * k as f32 / (count - 1) as f32;
                let p = spline.point(spline.locate_length(s));
                // A spline through fewer points may cut a corner of the skin.
                points.push(if k > 0 { self.lift(p, 0.5 * LEAST).0 } else { p });
            }
            let Ok(made) = Spline::new(&points) else { break };
            let off = thread.length - made.length();
            if off.abs() < 2e-4 * thread.length {
                break;
            }
            cut = (cut + off).clamp(0.0, spline.length());
        }
        if points.iter().all(|p| p.is_finite()) {
            points
        } else {
            straight(thread, self.down, self.points)
        }
    }
}

/// Height of a thread above the skin at arc length `s`: in the skin at the root, soon at its clearance.
fn height_at(thread: &Thread, s: f32) -> f32 {
    let t = (s / (3.0 * thread.clearance).max(0.1)).min(1.0);
    thread.clearance.max(LEAST) * t * t * (3.0 - 2.0 * t)
}

/// Distance between two threads at arc length `s` of the first: the sum of both clearances, less near the roots.
fn apart(one: &Thread, s: f32, other: &Thread, segment: u32, step: f32) -> f32 {
    height_at(one, s) + height_at(other, (segment as f32 + 0.5) * step)
}

/// A straight fall: the fallback for non-finite numbers.
fn straight(thread: &Thread, down: Vec3, count: usize) -> Vec<Vec3> {
    let part = thread.length / (count - 1) as f32;
    (0..count).map(|k| thread.point + down * (k as f32 * part)).collect()
}

/// Displacement of `p` that keeps it `apart` from segment `segment` of a thread.
#[inline]
fn keep_off(p: Vec3, other: &[Vec3], segment: usize, apart: f32) -> Vec3 {
    let (a, b) = (other[segment], other[segment + 1]);
    let (on, _) = nearest_on([a, b], p);
    let off = p - on;
    let d2 = off.length_squared();
    if d2 >= apart * apart || d2 == 0.0 {
        return Vec3::ZERO;
    }
    let d = d2.sqrt();
    off * ((apart - d) / d)
}

/// `direction` turned toward `to` by a fraction of the angle between them.
fn turned_towards(direction: Vec3, to: Vec3, share: f32) -> Vec3 {
    let Some(side) = across(to, direction) else { return direction };
    let angle = crate::maths::transcendental::acos(direction.dot(to).clamp(-1.0, 1.0));
    let (sin, cos) = sin_cos(angle * share.clamp(0.0, 1.0));
    (direction * cos + side * sin).normalize_or(direction)
}

/// Segments of threads by position.
struct Grid {
    per_cell: f32,
    cells: BTreeMap<(i32, i32, i32), Vec<(u32, u32)>>,
}

impl Grid {
    fn new(cell: f32) -> Self {
        Self { per_cell: 1.0 / cell.max(0.1), cells: BTreeMap::new() }
    }
    fn cell(&self, p: Vec3) -> IVec3 {
        (p * self.per_cell).floor().as_ivec3()
    }
    fn add(&mut self, number: usize, points: &[Vec3]) {
        for (segment, w) in points.windows(2).enumerate() {
            let IVec3 { x, y, z } = self.cell((w[0] + w[1]) * 0.5);
            self.cells.entry((x, y, z)).or_default().push((number as u32, segment as u32));
        }
    }
    /// Segments within one cell of `p`, in a fixed order.
    fn near(&self, p: Vec3, found: &mut Vec<(u32, u32)>) {
        found.clear();
        let IVec3 { x, y, z } = self.cell(p);
        for x in x.saturating_sub(1)..=x.saturating_add(1) {
            for y in y.saturating_sub(1)..=y.saturating_add(1) {
                let column = (x, y, z.saturating_sub(1))..=(x, y, z.saturating_add(1));
                for (_, segments) in self.cells.range(column) {
                    found.extend_from_slice(segments);
                }
            }
        }
    }
}

/// For each point of each thread, the segments of other threads that it may touch.
fn neighbours(
    cx: &EvalCx,
    threads: &[Thread],
    chains: &[Chain],
    thickest: f32,
) -> Result<Vec<Vec<Vec<(u32, u32)>>>, NodeError> {
    let mut grid = Grid::new(2.0 * thickest + 2.0 * STEP);
    for (i, chain) in chains.iter().enumerate() {
        grid.add(i, &chain.at);
    }
    cx.map(chains.len(), |i| {
        let mut found = vec![];
        let at = |(c, segment): &(u32, u32)| chains[*c as usize].at[*segment as usize];
        let list = |p: &Vec3| {
            grid.near(*p, &mut found);
            let close = |one: &(u32, u32)| {
                let reach = threads[i].clearance + threads[one.0 as usize].clearance + 1.5 * STEP;
                one.0 as usize != i && at(one).distance_squared(*p) < reach * reach
            };
            found.iter().copied().filter(close).collect()
        };
        Ok(chains[i].at.iter().map(list).collect())
    })
}
