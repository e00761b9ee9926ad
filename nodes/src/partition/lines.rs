//! Parting lines on the flat map: zigzag and hand wobble, ends that snap to what they were meant to meet, and their
//! projection onto the scalp.

use super::pattern::{Flat, lengths};
use crate::data::chart::{CELL, Chart, cross};
use crate::data::scalp::Scalp;
use crate::maths::hash::Dice;
use crate::maths::polyline::{Polyline, filter};
use crate::maths::transcendental::sin;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// What makes straight lines uneven, cm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Uneven {
    pub(crate) amplitude: f32,
    pub(crate) period: f32,
    pub(crate) wobble: f32,
    pub(crate) dice: Dice,
}

/// Spacing of a line's points on the map, in cells: short compared to bends of a millimetre.
const STEP: f32 = 1.5 * CELL;

/// The line through `points`, divided into `n` equal pieces.
fn evenly(chart: &Chart, points: &[Vec2], n: usize) -> Vec<Vec2> {
    let sums = lengths(chart, points.iter().copied());
    let total = sums.last().copied().unwrap_or(0.0);
    let mut at = 1;
    (0..=n)
        .map(|k| {
            let s = total * k as f32 / n as f32;
            while at + 1 < sums.len() && sums[at] < s {
                at += 1;
            }
            let (a, b) = (sums[at - 1], sums[at]);
            let t = if b > a { ((s - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
            points[at - 1].lerp(points[at], t)
        })
        .collect()
}

/// The line with enough points for its bends.
pub(crate) fn fine(chart: &Chart, points: &[Vec2]) -> Vec<Vec2> {
    let flat: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    evenly(chart, points, ((flat / STEP).ceil() as usize).clamp(1, 4096))
}

/// Points of a map line on the scalp, close and even enough that a spline through them is the line that hair keeps off.
/// Over skin that is too rough or thin, such as the modeled locks of a scan, the line runs straight on.
pub(crate) fn laid(scalp: &Scalp, chart: &Chart, line: &[Vec2]) -> Vec<Vec3> {
    /// Spacing of its points, and the largest distance between scalp and smooth line, head units.
    const STEP: f32 = 0.06;
    const ROUGH: f32 = 0.008;
    let (step, rough) = (STEP * chart.unit(), ROUGH * chart.unit());
    let down = |points: &[Vec3]| -> Vec<Vec3> {
        points.iter().filter_map(|p| Some(scalp.closest_root(*p)?.point)).collect()
    };
    let evenly = |points: Vec<Vec3>, step: f32| {
        let line = Polyline::new(points);
        let n = ((line.length() / step).ceil() as usize).clamp(1, 8000) + 1;
        line.evenly(n)
    };
    let flat = fine(chart, line);
    let points: Vec<Vec3> =
        flat.iter().filter_map(|q| Some(chart.root(scalp, *q)?.point)).collect();
    if points.len() < 2 {
        return points;
    }
    let mut points = down(&evenly(points, step));
    for _ in 0..2 {
        points = evenly(points, 0.5 * step);
        filter(&mut points, 8);
        points = evenly(points, step);
        for p in &mut points {
            let Some(on) = scalp.closest_root(*p).map(|root| root.point) else { continue };
            let smooth = (2.0 - 2.0 * p.distance(on) / rough).clamp(0.0, 1.0);
            *p = p.lerp(on, smooth);
        }
    }
    // Projected points are uneven beside folds, and other programs would read them as another line.
    evenly(points, step)
}

/// Makes a line uneven. Tied ends stay in place.
pub(crate) fn uneven(chart: &Chart, line: &mut Flat, how: &Uneven) {
    let total = lengths(chart, line.points.iter().copied()).last().copied().unwrap_or(0.0);
    let unit = chart.unit();
    if line.points.len() < 2 || total < 0.5 * unit {
        return;
    }
    let zigzag = how.amplitude > 0.0 && line.row;
    // A whole number of halves, so that a closed line closes and an open one starts and ends on itself.
    let halves = (2.0 * total / how.period.max(0.1 * unit)).round().max(2.0);
    let halves = if line.closed { (halves * 0.5).ceil() * 2.0 } else { halves };
    let each = ((total / halves / (0.15 * unit)).ceil() * 2.0).clamp(2.0, 64.0);
    let n = if zigzag { halves * each } else { (total / (0.15 * unit)).ceil().clamp(4.0, 2048.0) };
    let base = evenly(chart, &line.points, n as usize);
    let phase = [0, 1, 2].map(|k| how.dice.unit(line.id, k));
    // A hand-drawn line strays slowly: in waves of 7, 4 and 2.6 head units, whole ones on a closed line.
    let waves = [7.0, 4.0, 2.6].map(|wave| (total / (wave * unit)).round().max(1.0));
    let last = base.len() - 1;
    let moved = (0..=last).map(|k| {
        let part = k as f32 / last as f32;
        // Where lines meet, it grows over one head unit.
        let from = |tied: bool, s: f32| if tied { (s * total / unit).min(1.0) } else { 1.0 };
        let near_end = from(line.tied[0], part).min(from(line.tied[1], 1.0 - part));
        let mut off = 0.0;
        if zigzag {
            let x = part * halves;
            // 0 at whole halves, alternating 1 and -1 at their centres.
            let saw = 1.0 - (2.0 * (x - x.floor()) - 1.0).abs();
            off += how.amplitude * if (x.floor() as i64) % 2 == 0 { saw } else { -saw };
        }
        if how.wobble > 0.0 {
            let wave = |i: usize| sin(TAU * (phase[i] + part * waves[i]));
            let stray = 0.55 * wave(0) + 0.3 * wave(1) + 0.15 * wave(2);
            off += how.wobble * stray * near_end;
        }
        if off == 0.0 {
            return base[k];
        }
        let (before, after) = match (k, line.closed) {
            (0, true) => (base[last - 1], base[1]),
            (k, true) if k == last => (base[last - 1], base[1]),
            _ => (base[k.saturating_sub(1)], base[(k + 1).min(last)]),
        };
        aside(chart, base[k], after - before, off)
    });
    line.points = moved.collect();
}

/// The point `off` cm to the left of `q` when heading along `way`, perpendicular to it on the head.
fn aside(chart: &Chart, q: Vec2, way: Vec2, off: f32) -> Vec2 {
    let Some(way) = way.try_normalize() else { return q };
    let (spread, step) = (chart.spread(), way * 0.5 * CELL);
    let here = spread.direction(q);
    let along = spread.direction(q + step) - spread.direction(q - step);
    let left = here.cross(along).normalize_or_zero();
    let out = crate::data::chart::cell_of(q).map_or(chart.unit(), |cell| chart.out(cell));
    spread.flat_direction(here + left * (off / out.max(1e-3 * chart.unit())))
}

/// State of a line's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LineEnd {
    /// It meets another line or lies outside the hairline.
    Met,
    /// It ends in hair and cuts nothing.
    Loose,
}

/// Ends a line where it meets others: trims up to `join` cm past the last crossing, or extends up to `farthest`.
/// Applies to the line's last point; reverse the line for its first.
pub(crate) fn end(
    chart: &Chart,
    points: &mut Vec<Vec2>,
    others: &[&[Vec2]],
    [join, farthest]: [f32; 2],
) -> LineEnd {
    let Some(tip) = points.last().copied() else { return LineEnd::Loose };
    let per_cm = CELL / chart.stretch(tip, Vec2::new(CELL, 0.0)).max(1e-6 * chart.unit());
    let reach = join * per_cm;
    let far = farthest * per_cm;
    let near: Vec<&[Vec2]> = near(others, tip, 2.0 * far, 0.0);
    // A line that ends on this one does not end this one.
    let through: Vec<&[Vec2]> =
        self::near(others, tip, 2.0 * reach, 3.0 * OVER * chart.unit() * per_cm);
    let all: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    let (mut walked, mut last) = (0.0, None);
    for k in (1..points.len()).rev() {
        if walked > reach.min(0.5 * all) {
            break;
        }
        let (a, b) = (points[k - 1], points[k]);
        // Going inward from the end, the farthest crossing is where the line should have stopped.
        if let Some(t) = first_crossing(a, b, &through) {
            last = Some((k, t));
        }
        walked += a.distance(b);
    }
    // Slightly past the other line: enough that no path leads through between.
    let over = OVER * chart.unit() * per_cm;
    if let Some((k, t)) = last {
        let (a, b) = (points[k - 1], points[k]);
        points.truncate(k);
        points.push(a.lerp(b, t) + (b - a).normalize_or_zero() * over);
        return LineEnd::Met;
    }
    if chart.grows(tip) == 0.0 {
        // Outside the hairline nothing is parted, except for a first step.
        let inside = points.iter().rposition(|q| chart.grows(*q) > 0.0);
        if let Some(k) = inside {
            points.truncate((k + 2).min(points.len()));
        }
        return LineEnd::Met;
    }
    let before = points.iter().rev().find(|q| q.distance(tip) > 3.0 * CELL).copied();
    let Some(way) = before.and_then(|b| (tip - b).try_normalize()) else { return LineEnd::Loose };
    let crossing = first_crossing(tip, tip + way * far, &near).map(|t| far * t);
    let steps = (far / (0.5 * CELL)).ceil() as usize;
    let edge = (1..=steps)
        .map(|k| far * k as f32 / steps as f32)
        .find(|s| chart.grows(tip + way * *s) == 0.0);
    let to = match (crossing, edge) {
        (Some(a), Some(b)) => a.min(b),
        (a, b) => match a.or(b) {
            Some(to) => to,
            None => return LineEnd::Loose,
        },
    };
    points.push(tip + way * (to + over));
    LineEnd::Met
}

/// How far a line continues past one that it meets, head units.
const OVER: f32 = 0.02;

/// The segments of lines near a point, without those that end within `tip` of their line's end.
fn near<'a>(others: &[&'a [Vec2]], p: Vec2, reach: f32, tip: f32) -> Vec<&'a [Vec2]> {
    let close = |w: &[Vec2]| {
        let (lo, hi) = (w[0].min(w[1]) - reach, w[0].max(w[1]) + reach);
        p.cmpge(lo).all() && p.cmple(hi).all()
    };
    let of = |line: &'a [Vec2]| {
        let ends = [line.first().copied(), line.last().copied()];
        let at_end = move |w: &[Vec2]| {
            let near = |q: &Vec2| w[0].distance(*q).min(w[1].distance(*q)) <= tip;
            tip > 0.0 && ends.iter().flatten().any(near)
        };
        line.windows(2).filter(move |w| close(w) && !at_end(w))
    };
    others.iter().flat_map(|line| of(line)).collect()
}

/// Fraction of the way from `a` to `b` at which the first of the segments is crossed.
fn first_crossing(a: Vec2, b: Vec2, pieces: &[&[Vec2]]) -> Option<f32> {
    let at = |w: &&[Vec2]| {
        if !cross(a, b, w[0], w[1]) {
            return None;
        }
        let along = w[1] - w[0];
        Some((w[0] - a).perp_dot(along) / (b - a).perp_dot(along))
    };
    pieces.iter().filter_map(at).filter(|t| t.is_finite()).min_by(f32::total_cmp)
}
