//! Rows on the scalp and the ground between them: which row is nearest to a point, which one a row meets
//! on its left and right.
//!
//! Which row is nearest goes by the way over the scalp (`over.rs`) where a row was given it, else by the straight one: beside an
//! ear, the border between two rows lies up to 1.2 cm elsewhere by the straight one.
//! **Invariant:** a row's answers depend on that row alone, so what reads three rows changes only with these.

use super::over::Over;
use crate::data::scalp::Scalp;
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::spline::{CurveFault, Spline};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A row: a curve, and a line of straight pieces that stands for it in searches.
pub(crate) struct Row {
    /// The curve's id.
    pub(crate) id: u64,
    pub(crate) spline: Spline,
    points: Vec<Vec3>,
    /// Box of each [`RUN`] pieces, so that a search opens few of them.
    boxes: Vec<(Vec3, Vec3)>,
    /// Box of all of it.
    whole: (Vec3, Vec3),
    /// Ways over the scalp; none: straight ones.
    over: Option<Arc<Over>>,
}

/// Distance between the points of the line, cm; half of its sagitta on the tightest row (radius 1 cm) is the
/// error of a distance: 0.003 cm.
const STEP: f32 = 0.15;
/// The most points of the line.
const MOST: f32 = 1024.0;
/// Pieces in a box.
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
    /// The ways from this row over the scalp, as far as `reach` cm; none where it does not lie on the scalp.
    pub(crate) fn ways_over(&self, scalp: &Scalp, reach: f32) -> Option<Arc<Over>> {
        Over::new(&self.points, scalp, reach).map(Arc::new)
    }
    /// The same row, whose distances ([`Row::far`]) go over the scalp.
    pub(crate) fn going_over(self, over: Option<Arc<Over>>) -> Self {
        Self { over, ..self }
    }
    /// How far `p`, a point of the scalp, is from the row, where its straight distance is known.
    pub(crate) fn far(&self, scalp: &Scalp, p: Vec3, straight: f32) -> f32 {
        self.over.as_ref().map_or(straight, |over| over.at(scalp.chart(), p, straight))
    }
    /// The same where it is under `limit`, else `limit`.
    pub(crate) fn far_under(&self, scalp: &Scalp, p: Vec3, limit: f32) -> f32 {
        let straight = self.distance_under(p, limit);
        if straight < limit { self.far(scalp, p, straight).min(limit) } else { limit }
    }
    /// Calls `see` with the nearest point of every piece, its squared distance and the piece's fraction, of the runs
    /// whose box is nearer than the squared distance that `see` last gave; it starts with `limit`.
    fn search(&self, p: Vec3, limit: f32, mut see: impl FnMut(Vec3, f32, f32) -> f32) {
        let mut limit = limit;
        let far = |b: usize| beside(self.boxes[b], p);
        let mut open = |b: usize, limit: f32| {
            let mut limit = limit;
            let last = (b * RUN + RUN).min(self.points.len() - 1);
            for k in b * RUN..last {
                let (q, t) = on_piece(p, self.points[k], self.points[k + 1]);
                limit = see(q, q.distance_squared(p), k as f32 + t);
            }
            limit
        };
        // The nearest box first where nothing is known yet: it leaves little for the others.
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
    /// The nearest point of the row, its distance, and its fraction of the row's length.
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
    /// The distance of the row from `p` where it is under `limit`, else `limit`.
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
    /// The point nearest to `p` among those that lie within 60 degrees of `side`, seen in the plane of
    /// `normal`, and its distance where it is under `limit`.
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

/// The most rows whose ways over the scalp are found: half a megabyte each.
pub(crate) const MOST_OVER: usize = 256;

/// How far (cm) ways from rows are wanted: as far as the place that is farthest from all of them is from its own, and somewhat more.
/// `counts` says which cells of the map count; one of [`EVERY`] is asked.
pub(crate) fn farthest<'r>(
    rows: impl Iterator<Item = &'r Row> + Clone,
    scalp: &Scalp,
    counts: impl Fn(usize) -> bool,
) -> f32 {
    let spots = scalp.chart().spots().iter().enumerate().step_by(EVERY);
    let far = spots.filter(|(cell, _)| counts(*cell)).map(|(_, spot)| {
        rows.clone().fold(f32::MAX.sqrt(), |d, row| row.distance_under(spot.point, d))
    });
    1.5 * far.fold(0.0, f32::max) + 2.0
}

/// Of so many cells of the map one is asked how far it is from all rows.
const EVERY: usize = 23;

/// The ways of many rows over the scalp, each found once, when it is first asked for.
pub(crate) struct Overs<'a> {
    scalp: &'a Scalp,
    /// Cm; none: ways are straight.
    reach: Option<f32>,
    made: Mutex<BTreeMap<Key, Arc<OnceLock<Option<Arc<Over>>>>>>,
}

impl<'a> Overs<'a> {
    /// For the ways of so many rows as far as `reach` cm. A row on its own is parted from none, and of very many each is so
    /// near to the next that its ways are straight.
    pub(crate) fn new(scalp: &'a Scalp, rows: usize, reach: f32) -> Self {
        let reach = (2..=MOST_OVER).contains(&rows).then_some(reach);
        Self { scalp, reach, made: Mutex::default() }
    }
    /// The row with its ways.
    pub(crate) fn give(&self, row: Row) -> Row {
        let Some(reach) = self.reach else { return row };
        let key = KeyBuilder::new("row").column(bytemuck::cast_slice::<_, f32>(&row.points));
        let cell = {
            // Whoever panicked while holding the lock left the list whole.
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

/// From this squared limit on (cm2) looking for the nearest box first pays.
const WIDE: f32 = 9.0;

fn on_piece(p: Vec3, a: Vec3, b: Vec3) -> (Vec3, f32) {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    (a + along * t, t)
}

/// A place of a row with the directions that matter there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    pub(crate) point: Vec3,
    pub(crate) along: Vec3,
    /// The scalp's normal, made square to `along`.
    pub(crate) normal: Vec3,
}

impl Station {
    /// The place at fraction `u` of the row's length; beyond its ends, straight on.
    pub(crate) fn new(row: &Row, scalp: &Scalp, u: f32) -> Self {
        let (point, along) = Self::on_row(row, u);
        let normal = scalp.closest_root(point).map_or(Vec3::Y, |root| root.normal);
        Self { point, along, normal: square(normal, along) }
    }
    /// The same place, where the scalp's normal is known already.
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
    /// To the right (1) or left (-1), seen along the row with the scalp's normal up.
    pub(crate) fn side(&self, side: i32) -> Vec3 {
        self.along.cross(self.normal) * side as f32
    }
}

fn square(normal: Vec3, along: Vec3) -> Vec3 {
    crate::maths::frame::across(normal, along)
        .unwrap_or_else(|| crate::maths::frame::any_normal(along))
}

/// Which of `rows` the row with this station meets first on a side, and where; none within `reach`.
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
