//! Rows on the scalp and the ground between them: which row is nearest to a point, which one a row meets
//! on its left and right.
//!
//! Distances are straight, which between rows a few centimetres apart is within 1 % of the way over the scalp.
//! **Invariant:** a row's answers depend on that row alone, so what reads three rows changes only with these.

use crate::data::scalp::Scalp;
use crate::maths::spline::{CurveFault, Spline};
use glam::Vec3;

/// A row: a curve, and a line of straight pieces that stands for it in searches.
pub(crate) struct Row {
    /// The curve's id.
    pub(crate) id: u64,
    pub(crate) spline: Spline,
    points: Vec<Vec3>,
    low: Vec3,
    high: Vec3,
}

/// Distance between the points of the line, cm; half of its sagitta on the tightest row (radius 1 cm) is the
/// error of a distance: 0.003 cm.
const STEP: f32 = 0.15;
/// The most points of the line.
const MOST: f32 = 1024.0;

impl Row {
    pub(crate) fn new(id: u64, points: &[Vec3]) -> Result<Self, CurveFault> {
        let spline = Spline::new(points)?;
        let n = (spline.length() / STEP).ceil().clamp(8.0, MOST) as usize + 1;
        let mut points = Vec::with_capacity(n);
        spline.resample(n, |p| points.push(p));
        let (low, high) =
            points.iter().fold((points[0], points[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        Ok(Self { id, spline, points, low, high })
    }
    pub(crate) fn length(&self) -> f32 {
        self.spline.length()
    }
    fn box_distance(&self, p: Vec3) -> f32 {
        (self.low - p).max(p - self.high).max(Vec3::ZERO).length()
    }
    /// The nearest point of the row, its distance, and its fraction of the row's length.
    pub(crate) fn nearest(&self, p: Vec3) -> (Vec3, f32, f32) {
        let mut best = (self.points[0], f32::MAX, 0.0);
        for (k, w) in self.points.windows(2).enumerate() {
            let (q, t) = on_piece(p, w[0], w[1]);
            let d = q.distance_squared(p);
            if d < best.1 {
                best = (q, d, (k as f32 + t) / (self.points.len() - 1) as f32);
            }
        }
        (best.0, best.1.sqrt(), best.2)
    }
    /// The distance of the row from `p` where it is under `limit`, else `limit`.
    pub(crate) fn distance_under(&self, p: Vec3, limit: f32) -> f32 {
        if self.box_distance(p) >= limit {
            return limit;
        }
        let mut best = limit * limit;
        for w in self.points.windows(2) {
            best = best.min(on_piece(p, w[0], w[1]).0.distance_squared(p));
        }
        best.sqrt()
    }
    /// The point nearest to `p` among those that lie within 60 degrees of `side`, seen in the plane of
    /// `normal`, and its distance where it is under `limit`.
    fn to_the_side(&self, p: Vec3, side: Vec3, normal: Vec3, limit: f32) -> Option<(Vec3, f32)> {
        if self.box_distance(p) >= limit {
            return None;
        }
        let mut best = (Vec3::ZERO, limit);
        for w in self.points.windows(2) {
            let q = on_piece(p, w[0], w[1]).0;
            let d = q.distance(p);
            if d < best.1 {
                let flat = (q - p).reject_from_normalized(normal);
                if flat.dot(side) > 0.5 * flat.length() {
                    best = (q, d);
                }
            }
        }
        (best.1 < limit).then_some(best)
    }
}

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
        let place = row.spline.locate(u);
        let along = row.spline.tangent(place);
        let beyond = u.min(0.0) + (u - 1.0).max(0.0);
        let point = row.spline.point(place) + along * (beyond * row.length());
        let normal = scalp.closest_root(point).map_or(Vec3::Y, |root| root.normal);
        let normal = crate::maths::frame::across(normal, along)
            .unwrap_or_else(|| crate::maths::frame::any_normal(along));
        Self { point, along, normal }
    }
    /// To the right (1) or left (-1), seen along the row with the scalp's normal up.
    pub(crate) fn side(&self, side: i32) -> Vec3 {
        self.along.cross(self.normal) * side as f32
    }
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
        let line = |x: f32| Row::new(1, &[Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, -9.0)]).unwrap();
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
