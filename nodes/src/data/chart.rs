//! The scalp as a flat map, for everything planar on it: partings and the sections between them.
//!
//! A point of the scalp is represented by its direction from the centre of the cranium, and directions are projected by
//! Lambert's azimuthal equal-area projection. Its axis leans back from the crown, so that forehead and nape are equally
//! far from the map's centre. Neither direction of the projection needs a transcendental. A fine grid holds what is
//! known of the region: where hair grows, how far out the skin is, and its area in cm2.
//!
//! Guarantees: equal solid angles have equal areas on the map; a point of the region returns to itself within the
//! flatness of the mesh's triangles. Of several layers, the innermost that faces outward counts: the skull behind an
//! ear, not the ear. Not promised: anything on a mesh whose region is not visible from one point inside it, such as a
//! whole animal.

use super::scalp::{HeadFrame, Root, Scalp};
use crate::maths::closest::Surface;
use glam::{Vec2, Vec3};

/// Cells along a side of the grid.
pub const CELLS: usize = 304;
/// The map reaches this far from its centre (a whole sphere has a radius of 2); 1.9 is 143 degrees.
const REACH: f32 = 1.9;
/// Side of a cell in map units: 1.1 mm on a cranium of 8.9 cm.
pub const CELL: f32 = 2.0 * REACH / CELLS as f32;
/// Backward lean of the axis from the crown: sine and cosine of 35 degrees.
const LEAN: (f32, f32) = (0.573_576_4, 0.819_152);
/// Smallest cosine between the skin's normal and the direction from the cranium's centre that still counts as scalp: 72
/// degrees, steeper than any cranium.
const ON_EDGE: f32 = 0.3;
/// How much farther out or in the skin may be next to a cell's centre, head units: it is steep beside an ear.
const SLOPE: f32 = 0.8;
/// Triangles larger than this on the map (those around the antipode of its centre) are left out.
const TOO_WIDE: f32 = 0.7;

/// The map of one scalp.
pub struct Chart {
    spread: ChartProjection,
    /// The skin under the centre of each cell, row by row from the nape.
    spots: Vec<Spot>,
}

/// The projection of directions.
#[derive(Clone, Copy, Debug)]
pub struct ChartProjection {
    origin: Vec3,
    /// Right and top (the forehead) of the map, and its normal.
    axes: [Vec3; 3],
    /// Centimetres per head unit.
    unit: f32,
}

impl ChartProjection {
    /// Position of a point on the map.
    #[inline]
    pub fn flat(&self, p: Vec3) -> Vec2 {
        self.flat_direction(p - self.origin)
    }
    /// Distance of a point from the centre of the cranium, cm.
    #[inline]
    pub fn out(&self, p: Vec3) -> f32 {
        p.distance(self.origin)
    }
    /// Centimetres per head unit: whatever is decided on the map is decided in these, so that a head in any unit and size is
    /// parted alike.
    #[inline]
    pub fn unit(&self) -> f32 {
        self.unit
    }
    /// Position on the map of a direction from the centre of the cranium.
    #[inline]
    pub fn flat_direction(&self, d: Vec3) -> Vec2 {
        let [x, y, z] = self.axes.map(|axis| d.dot(axis));
        let square = x * x + y * y;
        let length = (square + z * z).sqrt().max(1e-9);
        // Two equal formulas, each used where it does not cancel.
        let scale = if z >= 0.0 {
            2.0 / (length * (length + z))
        } else {
            2.0 * (length - z) / (length * square.max(1e-12))
        };
        Vec2::new(x, y) * scale.sqrt()
    }
    /// The direction from the centre of the cranium at `q` on the map. Unit.
    pub fn direction(&self, q: Vec2) -> Vec3 {
        let q = q.clamp_length_max(1.999);
        let square = q.length_squared();
        let flat = q * (1.0 - 0.25 * square).max(0.0).sqrt();
        let [x, y, z] = self.axes;
        x * flat.x + y * flat.y + z * (1.0 - 0.5 * square)
    }
}

/// The skin under the centre of a cell.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The point of the scalp, cm; outside the region, a point of the cranium's sphere.
    pub point: Vec3,
    /// Value of the region: 0 where no hair grows.
    pub grows: f32,
    /// Area of skin in the cell, cm2; 0 outside the region.
    pub area: f32,
}

impl Chart {
    /// The map of a surface whose region has one value per vertex.
    pub fn new(surface: &Surface, frame: &HeadFrame, region: &[f32]) -> Self {
        let (sin, cos) = LEAN;
        let axis = frame.up * cos - frame.forward * sin;
        let top = frame.forward * cos + frame.up * sin;
        let spread = ChartProjection {
            origin: frame.origin,
            axes: [frame.right, top, axis],
            unit: frame.unit(),
        };
        let mut chart = Self { spread, spots: vec![] };
        chart.spots = (0..CELLS * CELLS)
            .map(|i| {
                let point = frame.origin + chart.direction(middle(i)) * frame.radius;
                Spot { point, grows: 0.0, area: 0.0 }
            })
            .collect();
        for (t, corners) in (0..).zip(&surface.triangles) {
            let grows = corners.map(|v| region[v as usize]);
            if grows.iter().any(|g| *g > 0.0) {
                chart.lay(surface.corners(t), grows);
            }
        }
        chart
    }

    fn lay(&mut self, corners: [Vec3; 3], grows: [f32; 3]) {
        let [a, b, c] = corners.map(|p| self.flat(p));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let twice = (b - a).perp_dot(c - a);
        let [u, v] = [corners[1] - corners[0], corners[2] - corners[0]];
        let ratio = u.cross(v).length() / twice.abs();
        // Skin that faces the centre or stands on edge belongs to something that sticks out, such as an ear.
        let way = (corners[0] - self.spread.origin).normalize_or_zero();
        if u.cross(v).normalize_or_zero().dot(way) <= ON_EDGE {
            return;
        }
        if (high - low).max_element() > TOO_WIDE || !ratio.is_finite() {
            return;
        }
        let from = ((low + REACH) / CELL - 0.5).ceil().max(Vec2::ZERO);
        let to = ((high + REACH) / CELL - 0.5).floor().min(Vec2::splat(CELLS as f32 - 1.0));
        if from.x > to.x || from.y > to.y {
            return;
        }
        for y in from.y as usize..=to.y as usize {
            for x in from.x as usize..=to.x as usize {
                let i = y * CELLS + x;
                let q = middle(i);
                let s = (q - a).perp_dot(c - a) / twice;
                let t = (b - a).perp_dot(q - a) / twice;
                let r = 1.0 - s - t;
                // Slightly past the edges, so that no cell on an edge is missed.
                if r.min(s).min(t) < -1e-4 {
                    continue;
                }
                let point = corners[0] + u * s + v * t;
                let spot = &mut self.spots[i];
                let out = |p: Vec3| p.distance_squared(self.spread.origin);
                if spot.area == 0.0 || out(point) < out(spot.point) {
                    let grows = (grows[0] * r + grows[1] * s + grows[2] * t).clamp(0.0, 1.0);
                    *spot = Spot { point, grows, area: CELL * CELL * ratio };
                }
            }
        }
    }

    /// The skin under each cell, row by row.
    pub fn spots(&self) -> &[Spot] {
        &self.spots
    }
    /// The centre of the cranium, cm.
    pub fn origin(&self) -> Vec3 {
        self.spread.origin
    }
    /// The projection of directions.
    pub fn spread(&self) -> ChartProjection {
        self.spread
    }
    /// Centimetres per head unit.
    pub fn unit(&self) -> f32 {
        self.spread.unit
    }
    /// Position of a point on the map.
    #[inline]
    pub fn flat(&self, p: Vec3) -> Vec2 {
        self.spread.flat(p)
    }
    /// The direction from the centre of the cranium at `q` on the map. Unit.
    pub fn direction(&self, q: Vec2) -> Vec3 {
        self.spread.direction(q)
    }
    /// Whether hair grows at a point of the map, decided by its cell.
    pub fn grows(&self, q: Vec2) -> f32 {
        cell_of(q).map_or(0.0, |i| self.spots[i].grows)
    }
    /// The root at `q` on the map: where the ray from the centre of the cranium leaves the skin.
    pub fn root(&self, scalp: &Scalp, q: Vec2) -> Option<Root> {
        let (way, surface) = (self.direction(q), scalp.surface());
        // At the hairline the skin is as far out as in the adjacent cells inside it.
        let grown = |i: &usize| self.spots[*i].grows > 0.0;
        let known = cell_of(q).and_then(|i| {
            let near = std::iter::once(i).chain(around(i)).chain(around(i).flat_map(around));
            near.into_iter().find(grown).map(|i| self.out(i))
        });
        let radius = scalp.frame().radius;
        // Outside the region the outermost skin counts, in a wide range.
        let (mut from, to) = match known {
            Some(out) => (out - SLOPE * self.unit(), out + SLOPE * self.unit()),
            None => (0.5 * radius, 2.0 * radius),
        };
        let mut found = None;
        while let Some(hit) = surface.ray(self.spread.origin + way * from, way, to - from) {
            if surface.face_normal(hit.triangle).dot(way) > 0.0 {
                found = Some(hit);
                if known.is_some() {
                    break;
                }
            }
            from += hit.distance + 1e-3 * self.unit();
        }
        match found {
            Some(hit) => Some(scalp.root(hit.triangle, hit.bary)),
            None => scalp.closest_root(self.spread.origin + way * known.unwrap_or(radius)),
        }
    }
    /// Distance of the skin in a cell from the centre of the cranium, cm.
    pub fn out(&self, cell: usize) -> f32 {
        self.spots[cell].point.distance(self.spread.origin)
    }
    /// Length of skin in cm that a step on the map covers, near `q`.
    pub fn stretch(&self, q: Vec2, step: Vec2) -> f32 {
        let out = cell_of(q).map_or(self.unit(), |i| self.out(i));
        let (a, b) = (self.direction(q - step * 0.5), self.direction(q + step * 0.5));
        a.distance(b) * out
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.spots.len() * size_of::<Spot>()
    }
}

/// The cell of a point of the map; `None` outside the map.
#[inline]
pub fn cell_of(q: Vec2) -> Option<usize> {
    let at = (q + REACH) / CELL;
    let inside = at.min_element() >= 0.0 && at.max_element() < CELLS as f32;
    inside.then(|| at.y as usize * CELLS + at.x as usize)
}

/// The centre of a cell.
#[inline]
pub fn middle(cell: usize) -> Vec2 {
    let (x, y) = (cell % CELLS, cell / CELLS);
    (Vec2::new(x as f32, y as f32) + 0.5) * CELL - REACH
}

/// The up to eight cells around a cell, nearest first.
pub fn around(cell: usize) -> impl Iterator<Item = usize> {
    const WAYS: [(i32, i32); 8] =
        [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)];
    let (x, y) = ((cell % CELLS) as i32, (cell / CELLS) as i32);
    let on = |v: i32| (0..CELLS as i32).contains(&v);
    WAYS.into_iter()
        .map(move |(dx, dy)| (x + dx, y + dy))
        .filter(move |(x, y)| on(*x) && on(*y))
        .map(|(x, y)| y as usize * CELLS + x as usize)
}

/// Whether the segments `p`-`q` and `a`-`b` cross. An end point counts for one side only, so that crossings of a
/// polyline are counted once each.
#[inline]
pub fn cross(p: Vec2, q: Vec2, a: Vec2, b: Vec2) -> bool {
    let side = |from: Vec2, to: Vec2, x: Vec2| (to - from).perp_dot(x - from) >= 0.0;
    side(p, q, a) != side(p, q, b) && side(a, b, p) != side(a, b, q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::maths::hash::Dice;

    #[test]
    fn points_come_back_and_areas_are_true() {
        let scalp = shared_ball();
        let chart = scalp.chart();
        let dice = Dice::new(1, 0, "chart");
        for id in 0..500 {
            let v = Vec3::from([0, 1, 2].map(|k| dice.signed(id, k)));
            let up = Vec3::new(v.x, v.y.abs() + 0.05, v.z).normalize();
            let p = scalp.closest_root(up * 9.0).unwrap().point;
            let back = chart.root(&scalp, chart.flat(p)).unwrap().point;
            assert!(back.distance(p) < 0.01, "{p} {back}");
        }
        let area: f32 = chart.spots().iter().map(|s| s.area * s.grows).sum();
        // Half the ball, plus the soft row of triangles at its edge.
        let half = std::f32::consts::TAU * 8.9 * 8.9;
        assert!((area / half - 1.0).abs() < 0.05, "{area} {half}");
    }
}
