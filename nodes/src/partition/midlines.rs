//! Lines halfway between rows: the partings when rows are drawn first.
//!
//! methods.md 3, "braids first": the scalp is divided among rows by distance over the scalp (`scalp/territory.rs`), with a
//! line wherever the territories of two rows meet. The line is traced on the scalp's map through cells whose corners
//! are nearest to different rows; three territories meet in a point shared by their three lines.
//!
//! Lines may be asked for only where two rows leave each other, as drawn hair does at a parting: pieces of several pairs of rows then join
//! to one smooth line, which may end in the middle of hair.
//!
//! Guarantees: points of a line are equally far from its two rows to the resolution of the map, half a millimetre on
//! smooth skin (but for joined lines, which are smoothed); rows of one section share only that section. Ids derive from the two rows. Not promised: lines beside
//! rows that come closer to each other than two cells of the map (2 mm).

use super::pattern::Flat;
use crate::data::chart::{self, CELLS, middle};
use crate::data::scalp::Scalp;
use crate::define::NodeError;
use crate::eval::EvalCx;
use crate::maths::hash::curve_id;
use crate::maths::transcendental::sin_cos;
use crate::scalp::territory::{MOST_OVER, Row, farthest};
use glam::Vec2;
use std::collections::BTreeMap;

/// Corners of the net lie on every n-th cell of the map: 2.2 mm.
const EVERY: usize = 2;
/// Corners along a side of the net.
const SIDE: usize = CELLS / EVERY;
/// Marks a corner where no hair grows.
const NONE: u32 = u32::MAX;
/// Smoothing rounds for a line, whose points jitter by a tenth of a cell, and for one that goes on between other rows, which turns there.
const EASED: usize = 6;
const EASED_JOINED: usize = 80;
/// Part of a row whose direction counts as that beside a line.
const BESIDE: f32 = 0.05;
/// With more rows than this, territories would be narrower than the map resolves.
const MOST_ROWS: usize = 4096;
/// Lines shorter than this, in corners of the net, are dropped.
const LEAST: usize = 4;
const LEAST_JOINED: usize = 8;

/// Where a line crosses the net: an edge between two corners, or the centre of a square in which three territories meet
/// ([`MET`]).
type Crossing = (u32, u8);
/// Marks a square in which three territories meet, or one at the hairline, where lines continue.
const MET: u8 = 2;
const MET_AT_HAIRLINE: u8 = 3;
/// Two rows by index, the lower first.
type Pair = (u32, u32);

/// Lines halfway between the rows, where hair grows and `part` is true; with `leave`, only where two rows leave each other by more than
/// this angle (degrees).
pub(crate) fn between(
    cx: &EvalCx,
    scalp: &Scalp,
    part: &[bool],
    rows: Vec<Row>,
    leave: f32,
    seed: u64,
) -> Result<Vec<Flat>, NodeError> {
    if rows.len() > MOST_ROWS {
        let n = rows.len();
        return Err(NodeError::failed(format!(
            "{n} rows to part between, at most {MOST_ROWS} are: wire the rows that braids are laid along, not hair"
        )));
    }
    let rows = over_the_scalp(scalp, part, rows);
    let ground = Ground::new(cx, scalp, part, &rows)?;
    let mut meetings: BTreeMap<Pair, Meeting> = BTreeMap::new();
    for y in 0..SIDE - 1 {
        cx.check()?;
        for x in 0..SIDE - 1 {
            ground.square(y * SIDE + x, &mut meetings);
        }
    }
    let name = |(a, b): Pair| {
        let (a, b) = (rows[a as usize].id, rows[b as usize].id);
        curve_id(a.min(b), seed, a.max(b))
    };
    if leave > 0.0 {
        return Ok(ground.parted(meetings, sin_cos(leave.to_radians()).1, name));
    }
    let mut out = vec![];
    for (pair, meeting) in meetings {
        let pair = name(pair);
        for (n, Line { mut points, closed, tied, .. }) in (0..).zip(meeting.lines()) {
            ease(&mut points, closed, EASED);
            if closed {
                points.push(points[0]);
            }
            let id = curve_id(pair, seed, n);
            out.push(Flat { id, points, closed, tied, row: true, by_hand: false });
        }
    }
    Ok(out)
}

/// The rows with their distances over the scalp, as far as hair is from them.
fn over_the_scalp(scalp: &Scalp, part: &[bool], rows: Vec<Row>) -> Vec<Row> {
    if !(2..=MOST_OVER).contains(&rows.len()) {
        return rows;
    }
    let reach = farthest(rows.iter(), scalp, |cell| part[cell]);
    let over = |row: Row| {
        let ways = row.ways_over(scalp, reach);
        row.going_over(ways)
    };
    rows.into_iter().map(over).collect()
}

/// The nearest row of each corner of the net.
struct Ground<'a> {
    scalp: &'a Scalp,
    rows: &'a [Row],
    nearest: Vec<u32>,
}

impl<'a> Ground<'a> {
    fn new(
        cx: &EvalCx,
        scalp: &'a Scalp,
        part: &[bool],
        rows: &'a [Row],
    ) -> Result<Self, NodeError> {
        let sections = scalp.sections();
        let section = |p| sections.and_then(|s| s.at(p)).map(|place| place.section);
        let own: Vec<Option<u32>> = rows.iter().map(|row| section(row.spline.at(0.5))).collect();
        let mut ground = Self { scalp, rows, nearest: vec![NONE; SIDE * SIDE] };
        // Neighbouring corners mostly have the same row: farther rows are skipped quickly.
        let mut last = 0;
        for corner in 0..SIDE * SIDE {
            if corner % SIDE == 0 {
                cx.check()?;
            }
            let cell = cell_of(corner);
            let spot = &scalp.chart().spots()[cell];
            if !part[cell] || spot.area <= 0.0 {
                continue;
            }
            let here = section(spot.point);
            let mut best = (f32::MAX, NONE);
            let others = (0..rows.len() as u32).filter(|row| *row != last);
            for row in std::iter::once(last).chain(others) {
                let known = sections.is_none() || own[row as usize] == here;
                if known
                    && ground.rows[row as usize].distance_under(spot.point, best.0.min(1e3))
                        < best.0.min(1e3)
                {
                    let far = ground.far(corner, row);
                    if (far, row) < best {
                        best = (far, row);
                    }
                }
            }
            ground.nearest[corner] = best.1;
            last = if best.1 == NONE { last } else { best.1 };
        }
        Ok(ground)
    }

    /// Distance of a corner from a row, cm.
    fn far(&self, corner: usize, row: u32) -> f32 {
        let row = &self.rows[row as usize];
        let p = self.scalp.chart().spots()[cell_of(corner)].point;
        row.far(self.scalp, p, row.nearest(p).1)
    }

    /// Where two territories meet between two neighbouring corners, on the map.
    fn crossing(&self, from: usize, to: usize) -> Option<(Pair, Vec2)> {
        let (a, b) = (self.nearest[from], self.nearest[to]);
        if a == b || a == NONE || b == NONE {
            return None;
        }
        let ahead = (self.far(from, b) - self.far(from, a)).max(0.0);
        let behind = (self.far(to, a) - self.far(to, b)).max(0.0);
        let t = if ahead + behind > 0.0 { ahead / (ahead + behind) } else { 0.5 };
        let p = middle(cell_of(from)).lerp(middle(cell_of(to)), t);
        Some(((a.min(b), a.max(b)), p))
    }

    /// The lines at which rows leave each other by more than the angle of this cosine, joined where one pair of rows follows another.
    fn parted(
        &self,
        meetings: BTreeMap<Pair, Meeting>,
        alike: f32,
        name: impl Fn(Pair) -> u64,
    ) -> Vec<Flat> {
        let (mut all, mut names) = (Meeting::default(), BTreeMap::new());
        for (pair, Meeting { pieces, places }) in meetings {
            for [from, to] in pieces {
                if self.leave(pair, places[&from].lerp(places[&to], 0.5), alike) {
                    all.piece((from, places[&from]), (to, places[&to]));
                    names.entry(from).or_insert_with(|| name(pair));
                    names.entry(to).or_insert_with(|| name(pair));
                }
            }
        }
        let mut ends: BTreeMap<Crossing, usize> = BTreeMap::new();
        all.pieces.iter().flatten().for_each(|at| *ends.entry(*at).or_default() += 1);
        let flat = |Line { mut points, at, closed, .. }: Line| {
            // Where others meet that are lines no more, it is loose.
            let tied = [at[0], at[at.len() - 1]].map(|at| !closed && ends[&at] > 1);
            ease(&mut points, closed, EASED_JOINED);
            if closed {
                points.push(points[0]);
            }
            let id = at.iter().map(|at| names[at]).min().unwrap_or_default();
            Flat { id, points, closed, tied, row: true, by_hand: true }
        };
        let lines = all.lines().into_iter().map(flat);
        let mut lines: Vec<Flat> = lines.filter(|line| line.points.len() >= LEAST_JOINED).collect();
        // A pair of rows may leave each other twice.
        let mut known = BTreeMap::new();
        for line in &mut lines {
            let times = known.entry(line.id).or_insert(0);
            line.id = curve_id(line.id, 0, *times);
            *times += 1;
        }
        lines
    }

    /// Whether two rows leave each other beside a place of the map.
    fn leave(&self, (a, b): Pair, at: Vec2, alike: f32) -> bool {
        let Some(cell) = chart::cell_of(at) else { return false };
        let p = self.scalp.chart().spots()[cell].point;
        let beside = |row: u32| {
            let row = &self.rows[row as usize];
            let (place, _, u) = row.nearest(p);
            let ends = [u - BESIDE, u + BESIDE].map(|u| row.spline.at(u.clamp(0.0, 1.0)));
            (place, (ends[1] - ends[0]).normalize_or_zero())
        };
        let ((at_a, way_a), (at_b, way_b)) = (beside(a), beside(b));
        way_a.dot(way_b) < alike && (at_b - at_a).dot(way_b - way_a) > 0.0
    }

    /// The segments of lines in the square with this first corner.
    fn square(&self, corner: usize, meetings: &mut BTreeMap<Pair, Meeting>) {
        let corners = [corner, corner + 1, corner + SIDE + 1, corner + SIDE];
        let first = self.nearest[corner];
        if corners.iter().all(|c| self.nearest[*c] == first) {
            return;
        }
        // Each edge is named by its lower corner and its direction.
        let edges = [(0, 1, 0), (1, 2, 1), (3, 2, 0), (0, 3, 1)];
        let found: Vec<(Pair, Crossing, Vec2)> = edges
            .into_iter()
            .filter_map(|(from, to, way)| {
                let (pair, p) = self.crossing(corners[from], corners[to])?;
                Some((pair, (corners[from] as u32, way), p))
            })
            .collect();
        let all_one_pair = found.windows(2).all(|w| w[0].0 == w[1].0);
        if all_one_pair {
            // Two crossings, or four around a saddle; one where hair ends.
            for two in found.chunks_exact(2) {
                let meeting = meetings.entry(two[0].0).or_default();
                meeting.piece((two[0].1, two[0].2), (two[1].1, two[1].2));
            }
            return;
        }
        let met = found.iter().map(|(_, _, p)| *p).sum::<Vec2>() / found.len() as f32;
        let kind = match corners.iter().any(|c| self.nearest[*c] == NONE) {
            true => MET_AT_HAIRLINE,
            false => MET,
        };
        for (pair, at, p) in found {
            meetings.entry(pair).or_default().piece((at, p), ((corner as u32, kind), met));
        }
    }
}

/// The cell of the map that contains a corner of the net.
fn cell_of(corner: usize) -> usize {
    (corner / SIDE * CELLS + corner % SIDE) * EVERY
}

/// A line between two rows.
struct Line {
    points: Vec<Vec2>,
    /// Where each crosses the net.
    at: Vec<Crossing>,
    closed: bool,
    /// Whether other lines end at its first and its last point.
    tied: [bool; 2],
}

/// Segments of the lines between two rows.
#[derive(Default)]
struct Meeting {
    pieces: Vec<[Crossing; 2]>,
    places: BTreeMap<Crossing, Vec2>,
}

impl Meeting {
    fn piece(&mut self, from: (Crossing, Vec2), to: (Crossing, Vec2)) {
        self.pieces.push([from.0, to.0]);
        self.places.extend([from, to]);
    }

    /// The lines formed by the segments.
    fn lines(&self) -> Vec<Line> {
        let mut beside: BTreeMap<Crossing, Vec<usize>> = BTreeMap::new();
        for (i, piece) in self.pieces.iter().enumerate() {
            piece.iter().for_each(|at| beside.entry(*at).or_default().push(i));
        }
        let mut left = vec![true; self.pieces.len()];
        let mut out = vec![];
        // Open lines first, from their ends; the rest is closed.
        let ends = beside.iter().filter(|(_, pieces)| pieces.len() != 2).map(|(at, _)| *at);
        for start in ends.chain(beside.keys().copied()) {
            loop {
                let mut line = vec![start];
                let mut at = start;
                while let Some(i) = beside[&at].iter().copied().find(|i| left[*i]) {
                    left[i] = false;
                    at =
                        if self.pieces[i][0] == at { self.pieces[i][1] } else { self.pieces[i][0] };
                    line.push(at);
                    if beside[&at].len() != 2 {
                        break;
                    }
                }
                if line.len() == 1 {
                    break;
                }
                let closed = at == start;
                if closed {
                    line.pop();
                }
                let is_tied = |at: Crossing| !closed && at.1 == MET;
                let tied = [is_tied(line[0]), is_tied(line[line.len() - 1])];
                if line.len() >= LEAST || tied.contains(&true) {
                    let points = line.iter().map(|at| self.places[at]).collect();
                    out.push(Line { points, at: line, closed, tied });
                }
            }
        }
        out
    }
}

/// Moves points toward the midpoint of their neighbours, except for the ends.
fn ease(points: &mut [Vec2], closed: bool, rounds: usize) {
    let n = points.len();
    for _ in 0..rounds {
        let was = points.to_vec();
        for k in 0..n {
            if closed || (k > 0 && k + 1 < n) {
                points[k] = was[k] * 0.5 + (was[(k + n - 1) % n] + was[(k + 1) % n]) * 0.25;
            }
        }
    }
}
