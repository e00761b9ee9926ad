//! Rows on the scalp and their territories: which row is nearest to a point, and which rows a row meets on its left and
//! right.
//!
//! The nearest row is found by distance over the scalp (`geodesic.rs`) if the rows have it, otherwise by straight distance:
//! beside an ear, the border between two rows then moves by up to 1.2 cm.
//! **Invariant:** a row's answers depend on that row only, so what reads three rows changes only with these.

use super::geodesic::Over;
use crate::data::scalp::Scalp;
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::nearest_on;
use crate::maths::spline::{CurveFault, Spline};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A row: a curve, and a polyline that represents it in searches.
pub(crate) struct Row {
    /// The curve's id.
    pub(crate) id: u64,
    pub(crate) spline: Spline,
    points: Vec<Vec3>,
    /// Bounding box of each [`RUN`] segments, so that a search visits few of them.
    boxes: Vec<(Vec3, Vec3)>,
    /// Bounding box of the whole row.
    whole: (Vec3, Vec3),
    /// Distances over the scalp; `None`: straight distances.
    over: Option<Arc<Over>>,
}

/// Spacing of the polyline's points, cm. Half its sagitta on the tightest row (radius 1 cm) is the error of a distance:
/// 0.003 cm.
const STEP: f32 = 0.15;
/// The most points of the polyline.
const MOST: f32 = 1024.0;
/// Segments per box.
const RUN: usize = 8;

impl Row {
    pub(crate) fn new(id: u64, points: &[Vec3]) -> Result<Self, CurveFault> {
        let spline = Spline::new(points)?;
        let n = (spline.length() / STEP).ceil().clamp(8.0, MOST) as usize + 1;
        let mut points = Vec::with_capacity(n);
        spline.resample(n, |p| points.push(p));
        let boxes: Vec<(Vec3, Vec3)> = (0..n - 1)
            .step_by(RUN)
            .map(|k| {
                let run = &points[k..(k + RUN + 1).min(n)];
                run.iter().fold((run[0], run[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
            })
            .collect();
        let join = |a: (Vec3, Vec3), b: &(Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
        let whole = boxes.iter().fold((points[0], points[0]), join);
        Ok(Self { id, spline, points, boxes, whole, over: None })
    }
    pub(crate) fn length(&self) -> f32 {
        self.spline.length()
    }
    /// Distances from this row over the scalp, up to `reach` cm; `None` if it does not lie on the scalp.
    pub(crate) fn ways_over(&self, scalp: &Scalp, reach: f32) -> Option<Arc<Over>> {
        Over::new(&self.points, scalp, reach).map(Arc::new)
    }
    /// The same row, with distances ([`Row::far`]) over the scalp.
    pub(crate) fn going_over(self, over: Option<Arc<Over>>) -> Self {
        Self { over, ..self }
    }
    /// Distance of `p`, a point of the scalp, from the row, given its straight distance.
    pub(crate) fn far(&self, scalp: &Scalp, p: Vec3, straight: f32) -> f32 {
        self.over.as_ref().map_or(straight, |over| over.at(scalp.chart(), p, straight))
    }
    /// The same, capped at `limit`.
    pub(crate) fn far_under(&self, scalp: &Scalp, p: Vec3, limit: f32) -> f32 {
        let straight = self.distance_under(p, limit);
        if straight < limit { self.far(scalp, p, straight).min(limit) } else { limit }
    }
    /// Calls `see` with the closest point of every segment, its squared distance and fraction, for runs whose box is
    /// closer than the squared distance that `see` returned last; starts with `limit`.
    fn search(&self, p: Vec3, limit: f32, mut see: impl FnMut(Vec3, f32, f32) -> f32) {
        let mut limit = limit;
        let far = |b: usize| beside(self.boxes[b], p);
        let mut open = |b: usize, limit: f32| {
            let mut limit = limit;
            let last = (b * RUN + RUN).min(self.points.len() - 1);
            for k in b * RUN..last {
                let (q, t) = nearest_on([self.points[k], self.points[k + 1]], p);
                limit = see(q, q.distance_squared(p), k as f32 + t);
            }
            limit
        };
        // With nothing known yet, the nearest box comes first: it rules out most others.
        let mut first = usize::MAX;
        if limit > WIDE {
            let mut least = f32::MAX;
            for b in 0..self.boxes.len() {
                let d = far(b);
                if d < least {
                    (least, first) = (d, b);
                }
            }
            if first < self.boxes.len() && least < limit {
                limit = open(first, limit);
            }
        }
        for b in 0..self.boxes.len() {
            if b != first && far(b) < limit {
                limit = open(b, limit);
            }
        }
    }
    /// The closest point of the row, its distance, and its fraction of the row's length.
    pub(crate) fn nearest(&self, p: Vec3) -> (Vec3, f32, f32) {
        let mut best = (self.points[0], f32::MAX, 0.0);
        self.search(p, f32::MAX, |q, d, at| {
            if d < best.1 {
                best = (q, d, at);
            }
            best.1
        });
        (best.0, best.1.sqrt(), best.2 / (self.points.len() - 1) as f32)
    }
    /// The distance of the row from `p`, capped at `limit`.
    pub(crate) fn distance_under(&self, p: Vec3, limit: f32) -> f32 {
        let mut best = limit * limit;
        if beside(self.whole, p) >= best {
            return limit;
        }
        self.search(p, best, |_, d, _| {
            best = best.min(d);
            best
        });
        best.sqrt()
    }
    /// The point closest to `p` among those within 60 degrees of `side`, in the plane of `normal`, and its distance if
    /// below `limit`.
    fn to_the_side(&self, p: Vec3, side: Vec3, normal: Vec3, limit: f32) -> Option<(Vec3, f32)> {
        let mut best = (Vec3::ZERO, limit * limit);
        self.search(p, best.1, |q, d, _| {
            if d < best.1 {
                let flat = (q - p).reject_from_normalized(normal);
                if flat.dot(side) > 0.5 * flat.length() {
                    best = (q, d);
                }
            }
            best.1
        });
        (best.1 < limit * limit).then(|| (best.0, best.1.sqrt()))
    }
}

/// The most rows with distances over the scalp: half a megabyte each.
pub(crate) const MOST_OVER: usize = 256;

/// How far (cm) distances from rows are needed: up to the point that is farthest from all of them, and slightly more.
/// `counts` says which cells of the map count; one in [`EVERY`] is sampled.
pub(crate) fn farthest<'r>(
    rows: impl Iterator<Item = &'r Row> + Clone,
    scalp: &Scalp,
    counts: impl Fn(usize) -> bool,
) -> f32 {
    let spots = scalp.chart().spots().iter().enumerate().step_by(EVERY);
    let far = spots.filter(|(cell, _)| counts(*cell)).map(|(_, spot)| {
        rows.clone().fold(f32::MAX.sqrt(), |d, row| row.distance_under(spot.point, d))
    });
    1.5 * far.fold(0.0, f32::max) + 2.0 * scalp.chart().unit()
}

/// One in this many cells of the map is sampled for its distance from all rows.
const EVERY: usize = 23;

/// Distances of many rows over the scalp, each computed on first use.
pub(crate) struct Overs<'a> {
    scalp: &'a Scalp,
    /// In cm; `None`: straight distances.
    reach: Option<f32>,
    made: Mutex<BTreeMap<Key, Arc<OnceLock<Option<Arc<Over>>>>>>,
}

impl<'a> Overs<'a> {
    /// For this many rows, up to `reach` cm. A single row has no neighbours, and very many rows are so close together
    /// that straight distances suffice.
    pub(crate) fn new(scalp: &'a Scalp, rows: usize, reach: f32) -> Self {
        let reach = (2..=MOST_OVER).contains(&rows).then_some(reach);
        Self { scalp, reach, made: Mutex::default() }
    }
    /// The row with its distances.
    pub(crate) fn give(&self, row: Row) -> Row {
        let Some(reach) = self.reach else { return row };
        let key = KeyBuilder::new("row").column(bytemuck::cast_slice::<_, f32>(&row.points));
        let cell = {
            // A panic while holding the lock left the list intact.
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            made.entry(key.finish()).or_default().clone()
        };
        let over = cell.get_or_init(|| row.ways_over(self.scalp, reach)).clone();
        row.going_over(over)
    }
}

/// Squared distance of a point from a box.
#[inline]
fn beside((low, high): (Vec3, Vec3), p: Vec3) -> f32 {
    (low - p).max(p - high).max(Vec3::ZERO).length_squared()
}

/// Above this squared limit (cm2), finding the nearest box first pays off.
const WIDE: f32 = 9.0;

/// A position on a row with its local directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    pub(crate) point: Vec3,
    pub(crate) along: Vec3,
    /// The scalp normal, made perpendicular to `along`.
    pub(crate) normal: Vec3,
}

impl Station {
    /// The position at fraction `u` of the row's length; past its ends, straight on.
    pub(crate) fn new(row: &Row, scalp: &Scalp, u: f32) -> Self {
        let (point, along) = Self::on_row(row, u);
        let normal = scalp.closest_root(point).map_or(Vec3::Y, |root| root.normal);
        Self { point, along, normal: square(normal, along) }
    }
    /// The same position, with a known scalp normal.
    pub(crate) fn with_normal(row: &Row, u: f32, normal: Vec3) -> Self {
        let (point, along) = Self::on_row(row, u);
        Self { point, along, normal: square(normal, along) }
    }
    fn on_row(row: &Row, u: f32) -> (Vec3, Vec3) {
        let place = row.spline.locate(u);
        let along = row.spline.tangent(place);
        let beyond = u.min(0.0) + (u - 1.0).max(0.0);
        (row.spline.point(place) + along * (beyond * row.length()), along)
    }
    /// Direction to the right (1) or left (-1), seen along the row with the scalp normal up.
    pub(crate) fn side(&self, side: i32) -> Vec3 {
        self.along.cross(self.normal) * side as f32
    }
}

fn square(normal: Vec3, along: Vec3) -> Vec3 {
    crate::maths::frame::across(normal, along)
        .unwrap_or_else(|| crate::maths::frame::any_normal(along))
}

/// Which of `rows` the row with this station meets first on a side, and where; `None` within `reach`.
pub(crate) fn neighbour<'a>(
    station: &Station,
    side: i32,
    rows: impl Iterator<Item = (usize, &'a Row)>,
    reach: f32,
) -> Option<(usize, Vec3)> {
    let way = station.side(side);
    let mut best: Option<(usize, Vec3)> = None;
    let mut limit = reach;
    for (i, row) in rows {
        if let Some((q, d)) = row.to_the_side(station.point, way, station.normal, limit) {
            (best, limit) = (Some((i, q)), d);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_neighbour_is_the_nearest_row_on_that_side() {
        let line =
            |x: f32| Row::new(1, &[Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, -9.0)]).unwrap();
        let rows = [line(1.0), line(-2.0), line(3.0)];
        let station =
            Station { point: Vec3::new(0.0, 0.0, -4.0), along: Vec3::NEG_Z, normal: Vec3::Y };
        let meet = |side| neighbour(&station, side, rows.iter().enumerate(), 20.0);
        assert_eq!(meet(1), Some((0, Vec3::new(1.0, 0.0, -4.0))));
        assert_eq!(meet(-1), Some((1, Vec3::new(-2.0, 0.0, -4.0))));
        assert_eq!(neighbour(&station, -1, rows.iter().enumerate(), 1.5), None);
        assert_eq!(rows[0].distance_under(Vec3::new(3.0, 0.0, -1.0), 9.0), 2.0);
        assert!((rows[0].nearest(Vec3::new(3.0, 0.0, -4.5)).2 - 0.5).abs() < 1e-5);
    }
}
