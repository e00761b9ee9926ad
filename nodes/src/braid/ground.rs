//! The territory of each braid row, and the paths over it into the braid.
//!
//! A root belongs to a row as in `scalp/territory.rs`: the nearest one by distance over the scalp. Paths over the
//! scalp are straight lines in a *map*: on each side of a row, columns of points march perpendicularly away from it
//! over the skin and fan out around its two ends. With the row unrolled straight, a hair combed along and into the
//! braid is a parabola, however the head bends beneath it.
//!
//! Guarantees: a path's points are within a few tenths of a millimetre of the skin; in a territory that ends at a
//! parting, a path never comes nearer to the parting than its root's side allows. Not promised: anything where the
//! columns of a row converge (far from a row that bends around its territory); paths there are merely smooth.

use crate::data::scalp::{Root, Scalp};
use crate::maths::frame::{across, any_normal};
use crate::maths::nearest::KdTree;
use crate::maths::smoothstep;
use crate::maths::spline::{Spline, SplineParam};
use crate::maths::transcendental::{atan2, exp, sin_cos};
use crate::scalp::territory::{MOST_OVER, Row, farthest};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::FRAC_PI_2;

/// A braid row.
pub(crate) struct Lane {
    /// Id of the source curve.
    pub(crate) id: u64,
    /// The part that lies on the scalp.
    pub(crate) row: Row,
    /// Length of the whole source, cm.
    pub(crate) length: f32,
    /// The section that it is the centre of; `None`: whatever is nearest to it.
    pub(crate) section: Option<u64>,
    /// Length over the scalp from its root, cm: 0 for a row that stands up from the head.
    pub(crate) scalp_length: f32,
    /// Tangent and scalp normal at even positions of the row.
    ways: Vec<(Vec3, Vec3)>,
    /// The same positions.
    points: Vec<Vec3>,
}

/// How far off a position counts at a distance: 0 up to `far[0]`, 1 from `far[1]` on.
pub(crate) fn far_off(distance: f32, far: [f32; 2]) -> f32 {
    smoothstep((distance - far[0]) / (far[1] - far[0]))
}

/// Number of positions of a row at which its directions are stored.
const WAYS: usize = 48;
/// Spacing of the points that represent a source, cm.
const STEP: f32 = 0.15;

impl Lane {
    /// The row of a source, as far as it is no higher than `off` (cm) above the skin; at least its first `off`. With a
    /// section, it ends where it leaves the section for good: other hair grows beyond.
    pub(crate) fn new(
        id: u64,
        source: &Spline,
        scalp: &Scalp,
        off: f32,
        section: Option<u64>,
    ) -> Option<Self> {
        let length = source.length();
        let n = (length / STEP).ceil().clamp(8.0, 2048.0) as usize;
        let step = length / n as f32;
        let mut points = vec![];
        for k in 0..=n {
            let p = source.at(k as f32 / n as f32);
            let near = scalp.surface().closest_within(p, off).is_some();
            if !near && k as f32 * step > off && points.len() > 2 {
                break;
            }
            points.push(p);
        }
        if let (Some(section), Some(sections)) = (section, scalp.sections()) {
            let last = points.iter().rposition(|p| sections.id_at(*p) == Some(section));
            points.truncate(last.map_or(points.len(), |last| (last + 1).max(3)));
        }
        let row = Row::new(id, &points).ok()?;
        let (mut root, mut scalp_length) = (None, 0.0f32);
        let mut way = |k: usize| {
            let place = row.spline.locate(k as f32 / (WAYS - 1) as f32);
            let (p, along) = (row.spline.point(place), row.spline.tangent(place));
            let foot = scalp.closest_root(p);
            let normal = foot.map_or(Vec3::Y, |foot| foot.normal);
            let foot = foot.map_or(p, |foot| foot.point);
            scalp_length = scalp_length.max(foot.distance(*root.get_or_insert(foot)));
            // A row that leaves the scalp straight up has no direction on it; any will do.
            let along = across(along, normal).unwrap_or_else(|| any_normal(normal));
            (along, normal)
        };
        let ways = (0..WAYS).map(&mut way).collect();
        let points = (0..WAYS).map(|k| row.spline.at(k as f32 / (WAYS - 1) as f32)).collect();
        Some(Self { id, row, length, section, scalp_length, ways, points })
    }
    /// Even positions of the row.
    pub(crate) fn points(&self) -> &[Vec3] {
        &self.points
    }
    /// Tangent and scalp normal at a fraction of the row.
    fn way(&self, u: f32) -> (Vec3, Vec3) {
        let x = u.clamp(0.0, 1.0) * (WAYS - 1) as f32;
        let k = (x as usize).min(WAYS - 2);
        let (a, b) = (self.ways[k], self.ways[k + 1]);
        let normal = a.1.lerp(b.1, x - k as f32).normalize_or(a.1);
        (across(a.0.lerp(b.0, x - k as f32), normal).unwrap_or(a.0), normal)
    }
    /// The position of the row, as a fraction, that `p` is beside. This is the nearest one (`owner.u`), but positions
    /// `far[0]` cm away and more are beside all of the row that is about equally near: beside an ear, where a row from
    /// front to back is near everywhere, neighbouring hairs then run the same way.
    pub(crate) fn foot(&self, p: Vec3, owner: &Owner, far: [f32; 2]) -> f32 {
        let share = far_off(owner.distance, far);
        if share <= 0.0 {
            return owner.u;
        }
        let (mut sum, mut all) = (0.0f32, 0.0f32);
        for k in 0..WAYS {
            let u = k as f32 / (WAYS - 1) as f32;
            let more = self.points[k].distance_squared(p) - owner.distance * owner.distance;
            let weight = exp(-0.5 * more / (far[0] * far[0]));
            (sum, all) = (sum + u * weight, all + weight);
        }
        owner.u + (sum / all.max(1e-9) - owner.u) * share
    }
    /// The side of the row that `p` is on: 1 right, -1 left, seen along it with the normal up.
    pub(crate) fn side(&self, p: Vec3, foot: Vec3, u: f32) -> i32 {
        let (along, normal) = self.way(u);
        if (p - foot).dot(along.cross(normal)) >= 0.0 { 1 } else { -1 }
    }
}

/// A row's source from where its braid begins.
#[derive(Clone, Copy)]
pub(crate) struct Behind<'a> {
    pub(crate) source: &'a Spline,
    /// As a fraction of the source.
    pub(crate) from: f32,
}

impl Behind<'_> {
    pub(crate) fn length(self) -> f32 {
        self.source.length() * (1.0 - self.from)
    }
    pub(crate) fn place(self, u: f32) -> SplineParam {
        self.source.locate(self.from + (1.0 - self.from) * u)
    }
    pub(crate) fn at(self, u: f32) -> Vec3 {
        self.source.point(self.place(u))
    }
}

/// The owner of a position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Owner {
    pub(crate) lane: u32,
    pub(crate) distance: f32,
    /// Fraction of the row at its nearest point.
    pub(crate) u: f32,
    pub(crate) foot: Vec3,
    /// How much farther the next row is.
    pub(crate) ahead: f32,
}

/// All rows, indexed for lookup.
pub(crate) struct RowIndex {
    pub(crate) lanes: Vec<Lane>,
    cell: f32,
    cells: BTreeMap<[i32; 3], Vec<u32>>,
}

/// Size of the cells that list the rows that may be near, head units.
const CELL: f32 = 1.5;

impl RowIndex {
    pub(crate) fn new(lanes: Vec<Lane>, scalp: &Scalp) -> Self {
        let cell = CELL * scalp.frame().unit();
        let lanes = over_the_scalp(lanes, scalp);
        let mut cells: BTreeMap<[i32; 3], Vec<u32>> = BTreeMap::new();
        if lanes.len() > 3 {
            let mut points = BTreeMap::new();
            for (p, grows) in scalp.surface().points.iter().zip(scalp.region()) {
                if *grows > 0.0 {
                    points.entry(cell_of(*p, cell)).or_insert(*p);
                }
            }
            for (at, p) in points {
                let straight: Vec<f32> = lanes.iter().map(|lane| lane.row.nearest(p).1).collect();
                let far = lanes.iter().zip(&straight).map(|(lane, d)| lane.row.far(scalp, p, *d));
                let mut sorted: Vec<f32> = far.collect();
                sorted.sort_by(f32::total_cmp);
                // Across the cell, and as much again for paths longer than the straight one.
                let reach = sorted[1] + 3.5 * cell;
                let near = (0..).zip(&straight).filter(|(_, d)| **d <= reach);
                cells.insert(at, near.map(|(i, _)| i).collect());
            }
        }
        Self { lanes, cell, cells }
    }
    /// The row nearest to `p`, a point of the scalp, among those that `may` accepts.
    pub(crate) fn owner(&self, scalp: &Scalp, p: Vec3, may: impl Fn(u32) -> bool) -> Option<Owner> {
        let (mut best, mut second): (Option<Owner>, f32) = (None, f32::MAX.sqrt());
        let mut see = |lane: u32| {
            if !may(lane) {
                return;
            }
            let row = &self.lanes[lane as usize].row;
            let (foot, straight, u) = row.nearest(p);
            let distance = row.far(scalp, p, straight);
            let last = best.map_or(f32::MAX.sqrt(), |b| b.distance);
            if distance < last {
                second = last;
                best = Some(Owner { lane, distance, u, foot, ahead: 0.0 });
            } else {
                second = second.min(distance);
            }
        };
        match self.cells.get(&cell_of(p, self.cell)) {
            Some(near) => near.iter().for_each(|lane| see(*lane)),
            None => (0..self.lanes.len() as u32).for_each(see),
        }
        best.map(|best| Owner { ahead: second - best.distance, ..best })
    }
}

/// The rows with their distances over the scalp, if several share a territory.
fn over_the_scalp(lanes: Vec<Lane>, scalp: &Scalp) -> Vec<Lane> {
    let sections: BTreeSet<u64> = lanes.iter().filter_map(|lane| lane.section).collect();
    let each_its_own = scalp.sections().is_some() && sections.len() == lanes.len();
    if lanes.len() < 2 || lanes.len() > MOST_OVER || each_its_own {
        return lanes;
    }
    let spots = scalp.chart().spots();
    let reach = farthest(lanes.iter().map(|lane| &lane.row), scalp, |cell| spots[cell].area > 0.0);
    let over = |lane: Lane| {
        let ways = lane.row.ways_over(scalp, reach);
        Lane { row: lane.row.going_over(ways), ..lane }
    };
    lanes.into_iter().map(over).collect()
}

fn cell_of(p: Vec3, cell: f32) -> [i32; 3] {
    (p / cell).floor().as_ivec3().to_array()
}

/// One side of a row, unrolled.
pub(crate) struct UnrolledSide {
    points: Vec<Vec3>,
    columns: usize,
    /// Steps of a column.
    steps: usize,
    step: f32,
    /// Spacing of the starts of columns along the row, cm.
    pitch: f32,
    tree: KdTree,
    /// Distance from the row at which each column leaves the row's own territory.
    pub(crate) limit: Vec<f32>,
}

/// Columns of the quarter turn around an end of a row.
const FAN: usize = 8;
/// The most stations along a row.
const MOST_STATIONS: usize = 64;
/// The most steps of a column.
const MOST_STEPS: f32 = 28.0;

impl UnrolledSide {
    /// The map of one side up to `reach` cm from the row; `inside` says whether a point belongs to the row's territory.
    pub(crate) fn new(
        lane: &Lane,
        scalp: &Scalp,
        side: i32,
        reach: f32,
        inside: impl Fn(Vec3) -> bool,
    ) -> Self {
        let step = (reach / MOST_STEPS).max(0.2);
        let steps = (reach / step).ceil().max(2.0) as usize;
        let stations = ((lane.row.length() / 0.4).ceil() as usize).clamp(2, MOST_STATIONS);
        let columns = stations + 2 * FAN;
        let (mut points, mut limit, mut found) = (vec![], vec![], vec![]);
        for c in 0..columns {
            let u = Self::fraction(c as f32, columns);
            let (along, normal) = lane.way(u);
            let sideways = along.cross(normal) * side as f32;
            // A quarter turn from straight ahead of the row to its side, and another one behind its end.
            let turned = |k: usize| (k as f32 / FAN as f32) * FRAC_PI_2;
            let (sin, cos) = match c {
                c if c < FAN => sin_cos(turned(FAN - c)),
                c if c >= columns - FAN => sin_cos(-turned(c + FAN + 1 - columns)),
                _ => (0.0, 1.0),
            };
            let mut way = sideways * cos - along * sin;
            let start = scalp.closest_root(lane.row.spline.at(u));
            let (mut p, mut inner, mut last) = (lane.row.spline.at(u), true, 0.0);
            p = start.map_or(p, |root| root.point);
            for k in 0..=steps {
                points.push(p);
                // Beyond the point where columns of a bent row meet, a column continues over other territories.
                let (_, far, at) = lane.row.nearest(p);
                let astray = (at - u).abs() * lane.row.length() > (0.4 * far).max(1.5);
                found.push(if astray && k > 0 { Vec3::NAN } else { p });
                if inner && k > 0 {
                    inner = inside(p);
                    last = if inner { k as f32 * step } else { last };
                }
                if let Some(root) = scalp.closest_root(p + way * step) {
                    p = root.point;
                    way = across(way, root.normal).unwrap_or(way);
                }
            }
            limit.push(last + 0.5 * step);
        }
        let tree = KdTree::new(found);
        let pitch = (lane.row.length() / (stations - 1) as f32).max(1e-6);
        Self { points, columns, steps, step, pitch, tree, limit }
    }
    /// The column that starts at a fraction of the row.
    pub(crate) fn column(&self, u: f32) -> f32 {
        FAN as f32 + u.clamp(0.0, 1.0) * (self.columns - 2 * FAN - 1) as f32
    }
    /// The row laid out straight: cm along it (negative in front of it, more than its length behind it) and beside it.
    fn plain(&self, (column, v): (f32, f32)) -> Vec2 {
        let (first, last) = (FAN as f32, (self.columns - 1 - FAN) as f32);
        let beyond = if column < first { column - first } else { (column - last).max(0.0) };
        let (sin, cos) = sin_cos(beyond / FAN as f32 * FRAC_PI_2);
        Vec2::new((column.clamp(first, last) - first) * self.pitch + v * sin, v * cos)
    }
    /// Column and distance of a position in [`UnrolledSide::plain`].
    fn unrolled(&self, p: Vec2) -> (f32, f32) {
        let (first, last) = (FAN as f32, (self.columns - 1 - FAN) as f32);
        let along = p.x / self.pitch + first;
        let column = along.clamp(first, last);
        let beyond = (along - column) * self.pitch;
        if beyond == 0.0 {
            return (column, p.y.max(0.0));
        }
        let turned = atan2(beyond, p.y.max(0.0)) / FRAC_PI_2;
        (column + turned * FAN as f32, Vec2::new(beyond, p.y.max(0.0)).length())
    }
    /// Distance (cm) of a position on the map from the row, or its straight extension.
    pub(crate) fn beside(&self, place: (f32, f32)) -> f32 {
        self.plain(place).y
    }
    /// The fraction of the row at which a column starts.
    fn fraction(column: f32, columns: usize) -> f32 {
        ((column - FAN as f32) / (columns - 2 * FAN - 1) as f32).clamp(0.0, 1.0)
    }
    fn limit_at(&self, column: f32) -> f32 {
        let x = column.clamp(0.0, (self.columns - 1) as f32);
        let c = (x as usize).min(self.columns - 2);
        self.limit[c] + (self.limit[c + 1] - self.limit[c]) * (x - c as f32)
    }
    /// The point at a column and a distance from the row.
    #[inline]
    pub(crate) fn point(&self, column: f32, v: f32) -> Vec3 {
        let x = column.clamp(0.0, (self.columns - 1) as f32);
        let y = (v / self.step).clamp(0.0, self.steps as f32);
        let (c, k) = ((x as usize).min(self.columns - 2), (y as usize).min(self.steps - 1));
        let (fx, fy) = (x - c as f32, y - k as f32);
        let at = c * (self.steps + 1) + k;
        let next = at + self.steps + 1;
        let a = self.points[at].lerp(self.points[at + 1], fy);
        let b = self.points[next].lerp(self.points[next + 1], fy);
        a.lerp(b, fx)
    }
    /// Column and distance of a point of the scalp.
    pub(crate) fn locate(&self, p: Vec3, found: &mut Vec<(f32, u32)>) -> (f32, f32) {
        self.tree.find(p, 1, found);
        let node = found.first().map_or(0, |(_, node)| *node as usize);
        let (mut c, mut v) =
            ((node / (self.steps + 1)) as f32, (node % (self.steps + 1)) as f32 * self.step);
        let (last, far) = ((self.columns - 1) as f32, self.steps as f32 * self.step);
        for _ in 0..4 {
            let off = p - self.point(c, v);
            let (c0, c1) = ((c - 0.5).max(0.0), (c + 0.5).min(last));
            let (v0, v1) = ((v - 0.5 * self.step).max(0.0), (v + 0.5 * self.step).min(far));
            let dc = (self.point(c1, v) - self.point(c0, v)) / (c1 - c0);
            let dv = (self.point(c, v1) - self.point(c, v0)) / (v1 - v0);
            // Least squares in the plane of both directions; a point of a fan has only one.
            let (a, b, d) = (dc.length_squared() + 1e-6, dc.dot(dv), dv.length_squared() + 1e-6);
            let (e, f) = (off.dot(dc), off.dot(dv));
            let det = (a * d - b * b).max(1e-8 + 0.05 * a * d);
            c = (c + ((e * d - f * b) / det).clamp(-0.8, 0.8)).clamp(0.0, last);
            v = (v + ((f * a - e * b) / det).clamp(-0.8 * self.step, 0.8 * self.step))
                .clamp(0.0, far);
        }
        (c, v)
    }
    /// Writes evenly spaced points of the path from a root at `from` (column, cm) to `to` into `out`. `sweep` 0 is
    /// straight; 1 leaves the parting perpendicularly and ends along the row.
    pub(crate) fn way(
        &self,
        root: &Root,
        from: (f32, f32),
        to: (f32, f32),
        sweep: f32,
        count: usize,
        out: &mut Vec<Vec3>,
    ) {
        const FINE: usize = 20;
        let mut fine = [Vec3::ZERO; FINE + 1];
        let (a, b) = (self.plain(from), self.plain(to));
        let corner = Vec2::new(b.x + (a.x - b.x) * sweep, b.y);
        let aside = root.point - self.point(from.0, from.1);
        for (k, p) in fine.iter_mut().enumerate() {
            let s = k as f32 / FINE as f32;
            let r = 1.0 - s;
            let (c, v) = self.unrolled(a * (r * r) + corner * (2.0 * r * s) + b * (s * s));
            *p = self.point(c, v.min(self.limit_at(c).max(to.1)).min(from.1.max(to.1)));
            *p += aside * (r * r);
        }
        fine[0] = root.point;
        let mut lengths = [0.0f32; FINE + 1];
        for k in 1..=FINE {
            lengths[k] = lengths[k - 1] + fine[k].distance(fine[k - 1]);
        }
        let total = lengths[FINE];
        let mut k = 0;
        for i in 0..count {
            let s = total * i as f32 / (count - 1) as f32;
            while k + 1 < FINE && lengths[k + 1] < s {
                k += 1;
            }
            let span = (lengths[k + 1] - lengths[k]).max(1e-9);
            out.push(fine[k].lerp(fine[k + 1], ((s - lengths[k]) / span).clamp(0.0, 1.0)));
        }
    }
}
