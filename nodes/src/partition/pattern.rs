//! Patterns of partings: rows over the head, and the boxes or triangles that rows are cut into, on any head.
//!
//! A pattern is a net of lines and rings ([`super::net`]) with rows between adjacent lines (or rings). The positions of
//! the lines are measured on the head itself: all rows have the same mean width, so that the outermost row is not a
//! sliver on a head with a higher or lower hairline.

use super::stereographic_grid::{StereographicGrid, wrapped};
use crate::data::chart::{CELLS, Chart, middle};
use crate::data::scalp::HeadFrame;
use crate::maths::hash::curve_id;
use crate::maths::transcendental::{atan2, exp, ln, sin_cos, tan};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Layout of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rows {
    /// From the forehead to the nape.
    Back,
    /// On both sides of a middle parting, around the head to the nape.
    Curved,
    /// From ear to ear.
    Across,
    /// From the hairline to a point.
    Gathered,
    /// Around the head, at a constant distance from the hairline.
    Rings,
}

/// What rows are cut into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CellShape {
    Whole,
    Boxes,
    Triangles,
}

/// Settings of a pattern. Lengths in cm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatternParams {
    pub(crate) rows: Rows,
    pub(crate) count: usize,
    pub(crate) cut: CellShape,
    /// Length of a box or triangle along its row.
    pub(crate) cell: f32,
    pub(crate) brick: bool,
    /// Rotation or sweep of the lines, radians.
    pub(crate) turn: f32,
    /// Where rows gather or what rings surround, as a direction in the head frame.
    pub(crate) centre: Vec3,
    /// Radius of the section that rows gather at.
    pub(crate) gather: f32,
    pub(crate) mirror: bool,
    pub(crate) tag: u64,
}

/// A line on the map.
#[derive(Clone, Debug)]
pub(crate) struct Flat {
    pub(crate) id: u64,
    pub(crate) points: Vec<Vec2>,
    pub(crate) closed: bool,
    /// Whether its first and its last point meet other lines that end there: such points stay.
    pub(crate) tied: [bool; 2],
    /// Whether it separates rows (otherwise it cuts one).
    pub(crate) row: bool,
    /// Whether it was drawn by hand.
    pub(crate) by_hand: bool,
}

/// The lines of a pattern.
#[derive(Debug, Default)]
pub(crate) struct PatternLines {
    pub(crate) lines: Vec<Flat>,
    /// The centre line of each row, from its hairline or front end.
    pub(crate) middles: Vec<Vec<Vec2>>,
}

/// One net on a part of the head.
struct Family<'a> {
    chart: &'a Chart,
    frame: &'a HeadFrame,
    net: StereographicGrid,
    /// Rings: distance (radians) of the hairline from the first pole in each direction; empty for lines.
    edge: Vec<f32>,
    /// Cells that belong to the part.
    part: &'a [bool],
    /// Mirrored on the midline, so that both sides have the same lines.
    mirror: bool,
}

/// Bins for measuring the widths of levels.
const BINS: usize = 720;
/// A line shorter than this fraction of the longest is dropped.
const SHORT: f32 = 0.3;
/// A piece of line shorter than this is dropped, head units.
const STUB: f32 = 1.0;
/// Rings: radius of the innermost section, in rows.
const CAP: f32 = 0.55;

impl Family<'_> {
    fn is_rings(&self) -> bool {
        !self.edge.is_empty()
    }
    fn edge_at(&self, along: f32) -> f32 {
        let n = self.edge.len();
        let x = (wrapped(along) + PI) / TAU * n as f32;
        let (i, t) = (x as usize % n, x - (x as usize) as f32);
        self.edge[i] + (self.edge[(i + 1) % n] - self.edge[i]) * t
    }
    /// Level of a direction, and its position along the level.
    fn place(&self, d: Vec3) -> (f32, f32) {
        let (line, ring) = self.net.place(d);
        if self.is_rings() {
            (2.0 * atan2(exp(ring), 1.0) / self.edge_at(line), line)
        } else {
            (line, ring)
        }
    }
    fn direction(&self, level: f32, along: f32) -> Vec3 {
        if self.is_rings() {
            let angle = (level * self.edge_at(along)).clamp(1e-4, 3.1);
            self.net.at(along, ln(tan(0.5 * angle)))
        } else {
            self.net.at(level, along)
        }
    }
    fn flat(&self, level: f32, along: f32) -> Vec2 {
        let d = self.frame.vector_from_head(self.direction(level, along));
        self.chart.flat(self.frame.origin + d)
    }
    /// Range of levels.
    fn levels(&self) -> (f32, f32) {
        if self.is_rings() { (0.0, 1.3) } else { (-PI, PI) }
    }

    /// The mean width of rows over the levels: for each bin's end, the sum of widths up to it, cm.
    fn widths(&self) -> Vec<f32> {
        let spots = self.chart.spots();
        let (low, high) = self.levels();
        let bin = (high - low) / BINS as f32;
        // Area, and area times slope, of each bin: their quotient is the bin's mean width along its line.
        let mut sums = vec![(0.0f64, 0.0f64); BINS];
        let level = |cell: usize| {
            let d = self.frame.head_from_vector(self.chart.direction(middle(cell)));
            self.place(d).0
        };
        let levels: Vec<f32> = (0..CELLS * CELLS)
            .map(|cell| {
                let near = [cell, cell.wrapping_sub(1), cell.wrapping_sub(CELLS)];
                let asked = near.iter().any(|c| self.part.get(*c).is_some_and(|part| *part));
                if asked { level(cell) } else { 0.0 }
            })
            .collect();
        for cell in (0..CELLS * CELLS - CELLS - 1).filter(|c| self.part[*c]) {
            let here = levels[cell];
            let [x, y] = [cell + 1, cell + CELLS].map(|other| {
                let rise = levels[other] - here;
                let rise = if self.is_rings() { rise } else { wrapped(rise) };
                (spots[other].point - spots[cell].point, rise)
            });
            let (xx, xy, yy) = (x.0.dot(x.0), x.0.dot(y.0), y.0.dot(y.0));
            let det = xx * yy - xy * xy;
            let slope =
                (x.1 * x.1 * yy - 2.0 * x.1 * y.1 * xy + y.1 * y.1 * xx).max(0.0) / det.max(1e-12);
            let (slope, area) = (f64::from(slope.sqrt()), f64::from(spots[cell].area));
            let mut add = |level: f32, share: f64| {
                let at = ((level - low) / bin) as usize;
                let sum = &mut sums[at.min(BINS - 1)];
                *sum = (sum.0 + area * share, sum.1 + area * slope * share);
            };
            if self.mirror && !self.is_rings() {
                add(here, 0.5);
                add(-here, 0.5);
            } else {
                add(here, 1.0);
            }
        }
        let longest = sums.iter().map(|s| s.1).fold(0.0, f64::max);
        let mut total = 0.0f64;
        (0..)
            .zip(&sums)
            .map(|(at, (area, length))| {
                let short =
                    if self.is_rings() && low + bin * at as f32 <= 0.9 { 0.0 } else { SHORT };
                if *length > f64::from(short) * longest {
                    total += area / length * f64::from(bin);
                }
                total as f32
            })
            .collect()
    }

    /// The level up to which rows take a given fraction of the total width.
    fn level_at(&self, widths: &[f32], share: f32) -> f32 {
        let (low, high) = self.levels();
        let wanted = share * widths[BINS - 1];
        // If the ends are empty, the end nearer to the content counts.
        let at = widths.partition_point(|w| if share < 0.5 { *w <= wanted } else { *w < wanted });
        let at = at.min(BINS - 1);
        let before = if at > 0 { widths[at - 1] } else { 0.0 };
        let part = (wanted - before) / (widths[at] - before).max(1e-9);
        low + (at as f32 + part.clamp(0.0, 1.0)) / BINS as f32 * (high - low)
    }

    /// The runs of a level inside the part, each with its positions along the level. A run that returns to itself is
    /// closed.
    fn runs(&self, level: f32) -> Vec<(Vec<(Vec2, f32)>, bool)> {
        const STEPS: usize = 720;
        let (low, high) = if self.is_rings() { (-PI, PI) } else { (-6.0, 6.0) };
        let all: Vec<(Vec2, f32, bool)> = (0..=STEPS)
            .map(|k| {
                let along = low + (high - low) * k as f32 / STEPS as f32;
                let q = self.flat(level, along);
                (q, along, crate::data::chart::cell_of(q).is_some_and(|cell| self.part[cell]))
            })
            .collect();
        if self.is_rings() && all.iter().all(|a| a.2) {
            return vec![(all.into_iter().map(|(q, along, _)| (q, along)).collect(), true)];
        }
        let mut runs: Vec<Vec<(Vec2, f32)>> = vec![];
        let mut k = 0;
        while k <= STEPS {
            if !all[k].2 {
                k += 1;
                continue;
            }
            let end = (k..=STEPS).find(|j| !all[*j].2).unwrap_or(STEPS + 1);
            // One more at both ends, past the edge.
            let (from, to) = (k.saturating_sub(1), end.min(STEPS));
            runs.push(all[from..=to].iter().map(|(q, along, _)| (*q, *along)).collect());
            k = end + 1;
        }
        if self.is_rings() && runs.len() > 1 && all[0].2 && all[STEPS].2 {
            // The ring's own seam is not an end.
            let mut last = runs.pop().unwrap_or_default();
            last.extend(runs.remove(0).into_iter().skip(1).map(|(q, a)| (q, a + TAU)));
            runs.push(last);
        }
        runs.retain(|run| self.length(run) > STUB * self.frame.unit());
        runs.into_iter().map(|run| (run, false)).collect()
    }
    fn length(&self, run: &[(Vec2, f32)]) -> f32 {
        lengths(self.chart, run.iter().map(|r| r.0)).last().copied().unwrap_or(0.0)
    }

    fn put(&self, wish: &PatternParams, number: u64, level: f32, out: &mut PatternLines) {
        for (k, (run, closed)) in (0..).zip(self.runs(level)) {
            let id = curve_id(curve_id(wish.tag, 1, number), 2, k);
            let points = run.into_iter().map(|r| r.0).collect();
            out.lines.push(Flat {
                id,
                points,
                closed,
                tied: [false; 2],
                row: true,
                by_hand: false,
            });
        }
    }

    /// Draws what is between two levels: the centre line of the row there, or its cuts.
    fn row(
        &self,
        wish: &PatternParams,
        (number, of): (usize, usize),
        [low, mid, high]: [f32; 3],
        out: &mut PatternLines,
    ) {
        let mut runs = self.runs(mid);
        runs.sort_by(|a, b| self.length(&b.0).total_cmp(&self.length(&a.0)));
        if wish.cut == CellShape::Whole {
            let longest = runs.into_iter().next();
            out.middles.extend(longest.map(|(run, _)| run.into_iter().map(|r| r.0).collect()));
            return;
        }
        // An ear may interrupt a row: each side of it is cut separately.
        for (piece, (run, closed)) in (0..).zip(runs) {
            let number = (number, of, piece);
            self.cuts(wish, number, [low, high], (&run, closed), out);
        }
    }

    /// Cuts a row along one run of its centre level into boxes or triangles.
    fn cuts(
        &self,
        wish: &PatternParams,
        (number, of, piece): (usize, usize, u64),
        [low, high]: [f32; 2],
        (run, closed): (&[(Vec2, f32)], bool),
        out: &mut PatternLines,
    ) {
        let lengths = lengths(self.chart, run.iter().map(|r| r.0));
        let length = lengths.last().copied().unwrap_or(0.0);
        let along = |s: f32| {
            let at = lengths.partition_point(|l| *l <= s).clamp(1, run.len() - 1);
            let (a, b) = (lengths[at - 1], lengths[at]);
            let t = if b > a { ((s - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
            run[at - 1].1 + (run[at].1 - run[at - 1].1) * t
        };
        // In a brick pattern, every other row has a cut in its middle, and the rows between have a box there.
        let odd = number % 2;
        let mut n = (length / wish.cell).round().max(1.0) as usize;
        if wish.brick && !closed && n % 2 != odd {
            n = if (length / wish.cell) > n as f32 || n < 2 { n + 1 } else { n - 1 };
        }
        if closed {
            n = n.max(3);
        }
        let shift = if closed && wish.brick && odd == 1 { 0.5 } else { 0.0 };
        let number = curve_id(curve_id(wish.tag, 3, number as u64), of as u64, piece);
        // Cuts extend past their row's edges and are trimmed where they meet the row's line.
        let over = 0.25 * (high - low);
        let mut cut = |i: usize, from: (f32, f32), to: (f32, f32)| {
            let points = (0..=24).map(|k| {
                let t = (k as f32 / 24.0) * 1.3 - 0.15;
                let level = from.0 + (to.0 - from.0) * t;
                self.flat(level.clamp(low - over, high + over), from.1 + (to.1 - from.1) * t)
            });
            let id = curve_id(number, 4, i as u64);
            let points = points.collect();
            out.lines.push(Flat {
                id,
                points,
                closed: false,
                tied: [false; 2],
                row: false,
                by_hand: false,
            });
        };
        let at = |i: f32| {
            let s = (i + shift) / n as f32 * length;
            if closed && s > length { along(s - length) + TAU } else { along(s) }
        };
        match wish.cut {
            CellShape::Whole => {}
            CellShape::Boxes => {
                for i in if closed { 0..n } else { 1..n } {
                    let v = at(i as f32);
                    cut(i, (low, v), (high, v));
                }
            }
            CellShape::Triangles => {
                for i in 0..n {
                    let (a, b, c) = (at(i as f32), at(i as f32 + 0.5), at(i as f32 + 1.0));
                    if i > 0 || closed {
                        cut(2 * i, (low, a), (high, b));
                    }
                    if i + 1 < n || closed {
                        cut(2 * i + 1, (high, b), (low, c));
                    }
                }
            }
        }
    }
}

/// Cumulative length of a line on the map, cm on the scalp.
pub(crate) fn lengths(chart: &Chart, line: impl Iterator<Item = Vec2>) -> Vec<f32> {
    let (mut sum, mut last) = (0.0, None);
    line.map(|q| {
        if let Some(before) = last {
            sum += chart.stretch((q + before) * 0.5, q - before);
        }
        last = Some(q);
        sum
    })
    .collect()
}

/// The lines of a pattern on the cells of a head that are in `part`.
pub(crate) fn drawn(
    chart: &Chart,
    frame: &HeadFrame,
    part: &[bool],
    wish: &PatternParams,
) -> PatternLines {
    let mut out = PatternLines::default();
    let family = |net: StereographicGrid, part| Family {
        chart,
        frame,
        net,
        edge: vec![],
        part,
        mirror: wish.mirror && wish.turn == 0.0,
    };
    let count = wish.count.max(1);
    match wish.rows {
        Rows::Back | Rows::Across => {
            let turned = |d: Vec3| about_up(d, wish.turn);
            let net = if wish.rows == Rows::Back {
                StereographicGrid::new(turned(FRONT), turned(BEHIND), Vec3::Y, turned(Vec3::X))
            } else {
                // From below the ear on the head's left to its right; the first row is that of the forehead.
                let (left, right) = (UNDER_EAR, UNDER_EAR * Vec3::new(-1.0, 1.0, 1.0));
                StereographicGrid::new(turned(left), turned(right), Vec3::Y, turned(Vec3::NEG_Z))
            };
            let mirror = wish.rows == Rows::Back && wish.mirror && wish.turn == 0.0;
            rows(&Family { mirror, ..family(net, part) }, wish, count, 0, &mut out);
        }
        Rows::Curved => {
            for (half, side) in [(0, 1.0), (1, -1.0)] {
                let own: Vec<bool> = (0..CELLS * CELLS)
                    .map(|cell| part[cell] && middle(cell).x * side > 0.0)
                    .collect();
                let bent = |d: Vec3, by: f32| about_up(d, by * side);
                let sweep = if wish.turn == 0.0 { SWEEP } else { wish.turn };
                let net = StereographicGrid::new(
                    bent(FRONT, -sweep),
                    bent(BEHIND, 0.5 * sweep),
                    bent(Vec3::new(0.1, 1.0, 0.0), 0.0),
                    Vec3::X * side,
                );
                let own = Family { chart, frame, net, edge: vec![], part: &own, mirror: false };
                rows(&own, wish, count.div_ceil(2), half, &mut out);
            }
            // The middle parting bounds both halves and ends their rows.
            let net = StereographicGrid::new(FRONT, BEHIND, Vec3::Y, Vec3::X);
            family(net, part).put(wish, 999, 0.0, &mut out);
        }
        Rows::Gathered => {
            let net = StereographicGrid::new(wish.centre, -wish.centre, Vec3::Z, Vec3::X);
            let family = family(net, part);
            let widths = family.widths();
            // Lines or rows in the middle of the forehead, for even or odd numbers, so that both sides are alike.
            let first = if count.is_multiple_of(2) { 0.0 } else { 0.5 };
            let level = |k: f32| {
                let share = (k + first) / count as f32;
                // Fractions run around from the nape; half a turn further is the forehead.
                family.level_at(&widths, (share + 0.5).fract())
            };
            for k in 0..count {
                family.put(wish, k as u64, level(k as f32), &mut out);
                let (low, mid) = (level(k as f32), level(k as f32 + 0.5));
                let high = low + wrapped(level(k as f32 + 1.0) - low);
                let mid = low + wrapped(mid - low);
                family.row(wish, (k, 0), [low, mid, high], &mut out);
            }
            cut_at_ring(&family, wish, &mut out);
        }
        Rows::Rings => {
            let net = StereographicGrid::new(wish.centre, -wish.centre, Vec3::Z, Vec3::X);
            let plain = family(net, part);
            let edge = hairline(&plain);
            let family = Family { edge, ..plain };
            let widths = family.widths();
            let all = count as f32 + CAP;
            let level = |k: f32| family.level_at(&widths, (1.0 - k / all).max(0.0));
            for k in 0..count {
                let k = k as f32;
                family.put(wish, k as u64, level(k + 1.0), &mut out);
                let outer = if k == 0.0 { 1.25 } else { level(k) };
                let levels = [level(k + 1.0), level(k + 0.5), outer];
                family.row(wish, (k as usize, 0), levels, &mut out);
            }
        }
    }
    out
}

/// `count` rows side by side.
fn rows(family: &Family, wish: &PatternParams, count: usize, half: usize, out: &mut PatternLines) {
    let widths = family.widths();
    let level = |k: f32| family.level_at(&widths, (k / count as f32).clamp(0.0, 1.0));
    let number = |k: usize| (half * 1000 + k) as u64;
    for k in 1..count {
        family.put(wish, number(k), level(k as f32), out);
    }
    for k in 0..count {
        let [a, m, b] = [0.0, 0.5, 1.0].map(|x| level(k as f32 + x));
        // The outermost rows extend as far as hair grows.
        let beyond = 2.0 * (b - a);
        let low = if k == 0 { a - beyond } else { a };
        let high = if k + 1 == count { b + beyond } else { b };
        family.row(wish, (k, half), [low, m, high], out);
    }
}

/// Poles of rows that run back: below the hairline's front, and below the nape.
const FRONT: Vec3 = Vec3::new(0.0, -0.35, 0.94);
const BEHIND: Vec3 = Vec3::new(0.0, -0.96, 0.28);
/// Pole of rows from ear to ear.
const UNDER_EAR: Vec3 = Vec3::new(0.62, -0.75, 0.22);
/// Default sweep of curved rows, radians.
const SWEEP: f32 = 0.3;

fn about_up(d: Vec3, angle: f32) -> Vec3 {
    let (sin, cos) = sin_cos(angle);
    Vec3::new(d.x * cos + d.z * sin, d.y, d.z * cos - d.x * sin)
}

/// Distance of the hairline from a net's first pole, radians, in all directions, smoothed.
fn hairline(family: &Family) -> Vec<f32> {
    const AROUND: usize = 180;
    let raw: Vec<f32> = (0..AROUND)
        .map(|k| {
            let along = (k as f32 / AROUND as f32 - 0.5) * TAU;
            let mut last = 0.4f32;
            for step in 1..260 {
                let angle = step as f32 * 0.01;
                let q = family.flat(along, ln(tan(0.5 * angle)));
                let inside = crate::data::chart::cell_of(q).is_some_and(|cell| {
                    family.part[cell] && family.chart.spots()[cell].grows >= 0.5
                });
                if inside {
                    last = last.max(angle);
                }
            }
            last
        })
        .collect();
    let mut edge = raw;
    for _ in 0..90 {
        edge = (0..AROUND)
            .map(|k| {
                let [a, b, c] = [k + AROUND - 1, k, k + 1].map(|i| edge[i % AROUND]);
                0.25 * a + 0.5 * b + 0.25 * c
            })
            .collect();
    }
    edge
}

/// Ends the rows of a gathered pattern at the ring around its centre, and draws the ring.
fn cut_at_ring(family: &Family, wish: &PatternParams, out: &mut PatternLines) {
    let angle = (wish.gather / family.frame.radius).clamp(0.02, 1.5);
    let ring = ln(tan(0.5 * angle));
    let outside = |q: &Vec2| {
        let d = family.frame.head_from_vector(family.chart.direction(*q));
        family.place(d).1 > ring
    };
    for line in out.lines.iter_mut().filter(|l| l.row) {
        // One point inside the ring stays, so that the line reaches it.
        let first = line.points.iter().position(outside).unwrap_or(0);
        line.points.drain(..first.saturating_sub(1));
    }
    for middle in &mut out.middles {
        middle.retain(outside);
        // From the hairline to the centre.
        middle.reverse();
    }
    let points = (0..=96).map(|k| family.flat(k as f32 / 96.0 * TAU, ring)).collect();
    let id = curve_id(wish.tag, 5, 0);
    out.lines.push(Flat { id, points, closed: true, tied: [false; 2], row: true, by_hand: false });
}
