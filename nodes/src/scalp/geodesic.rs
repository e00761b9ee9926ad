//! Distance from a row over the scalp, rather than through the head or past an ear.
//!
//! Distances propagate outward from the row over the cells of the scalp's map, by the fast marching method on triangles
//! (Kimmel and Sethian, Computing geodesic paths on manifolds, 1998), using the cells' positions in space: between skin
//! in front of an ear and skin behind it, the path goes around the ear. Where no hair grows, the map's points lie on
//! the cranium's sphere and paths count [`BARE`] times as long, so that they reach isolated skin but never pass under
//! an ear.
//!
//! Guarantees: within half a millimetre of the geodesic distance over smooth skin, tested up to 8 cm on a ball; the
//! same bits on every machine. Not promised: distances where no hair grows (only which row is nearest), on layers above
//! the map's skin, or on a mesh without a map; distances there are straight.

use crate::data::chart::{self, CELLS, Chart};
use crate::data::scalp::Scalp;
use glam::{Vec2, Vec3};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Distances from a row over the scalp.
pub(crate) struct Over {
    /// Lower corner and size of the computed window of the map.
    low: [usize; 2],
    size: [usize; 2],
    /// Distance of each cell of the window; the largest float if it exceeds `reach`.
    far: Vec<f32>,
    reach: f32,
}

/// Cells to each side of a row that are initialized.
const SEEDS: i32 = 4;
/// Cost of paths where no hair grows: through the base of an ear they are then no shorter than around it.
const BARE: f32 = 4.0;
/// Parts of a row higher than this above the scalp (head units) have left it.
const HIGH: f32 = 2.0;

impl Over {
    /// Distances up to `reach` cm from a line of points on the scalp; `None` if it is nowhere on the map.
    pub(crate) fn new(line: &[Vec3], scalp: &Scalp, reach: f32) -> Option<Self> {
        let chart = scalp.chart();
        let seeds = seeds(line, chart);
        let mut known = vec![];
        let mut heap = BinaryHeap::new();
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        let mut far = Window::default();
        for (cell, d) in seeds {
            far.set(cell, d);
            // Distances are not negative, so their bits sort like their values.
            heap.push(Reverse((d.to_bits(), cell)));
        }
        while let Some(Reverse((bits, cell))) = heap.pop() {
            let d = f32::from_bits(bits);
            if d > reach {
                break;
            }
            if far.done(cell) || d > far.get(cell) {
                continue;
            }
            far.finish(cell);
            known.push((cell, d));
            let (x, y) = (cell as usize % CELLS, cell as usize / CELLS);
            (low, high) = ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]);
            for other in chart::around(cell as usize).map(|other| other as u32) {
                if far.done(other) {
                    continue;
                }
                let to = reached(chart, &far, other, cell);
                if to < far.get(other) {
                    far.set(other, to);
                    heap.push(Reverse((to.to_bits(), other)));
                }
            }
        }
        if known.is_empty() {
            return None;
        }
        let size = [high[0] - low[0] + 1, high[1] - low[1] + 1];
        let mut found = vec![f32::MAX; size[0] * size[1]];
        for (cell, d) in known {
            let (x, y) = (cell as usize % CELLS, cell as usize / CELLS);
            found[(y - low[1]) * size[0] + x - low[0]] = d;
        }
        Some(Self { low, size, far: found, reach })
    }
    /// Distance of a point of the scalp from the row, cm, given its straight distance.
    pub(crate) fn at(&self, chart: &Chart, p: Vec3, straight: f32) -> f32 {
        // Next to the row, the straight distance is the distance over the skin.
        if straight < NEAR * chart.unit() {
            return straight;
        }
        let at = (chart.flat(p) - chart::middle(0)) / chart::CELL;
        let corner = at.floor();
        let t = at - corner;
        let beside = BESIDE * chart.unit();
        let (mut sum, mut all, mut on_map) = (0.0, 0.0, false);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let q = corner + Vec2::new(dx, dy);
            if q.min_element() < 0.0 || q.max_element() >= CELLS as f32 {
                continue;
            }
            let (x, y) = (q.x as usize, q.y as usize);
            let spot = &chart.spots()[y * CELLS + x];
            // Skin above the map's, such as the back of an ear, is not on the map.
            if spot.area > 0.0 && spot.point.distance_squared(p) > beside * beside {
                continue;
            }
            on_map = true;
            let far = self.cell(x, y);
            if far < f32::MAX {
                let weight = (1.0 - (t.x - dx).abs()) * (1.0 - (t.y - dy).abs());
                (sum, all) = (sum + weight * far, all + weight);
            }
        }
        match on_map {
            true if all > 1e-3 => straight.max(sum / all),
            // No path within reach: rows are compared by straight distance.
            true => self.reach + straight,
            false => straight,
        }
    }
    fn cell(&self, x: usize, y: usize) -> f32 {
        let (x, y) = (x.wrapping_sub(self.low[0]), y.wrapping_sub(self.low[1]));
        if x < self.size[0] && y < self.size[1] { self.far[y * self.size[0] + x] } else { f32::MAX }
    }
}

/// Points farther than this (head units) from the skin of their cells are not on the map.
const BESIDE: f32 = 2.0;
/// Below this distance (head units), straight distances equal those over the skin.
const NEAR: f32 = 0.4;

fn grows(chart: &Chart, cell: usize) -> bool {
    chart.spots()[cell].area > 0.0
}

/// The cells beside a line with their straight distances.
fn seeds(line: &[Vec3], chart: &Chart) -> BTreeMap<u32, f32> {
    let mut seeds: BTreeMap<u32, f32> = BTreeMap::new();
    for piece in line.windows(2) {
        let along = piece[1] - piece[0];
        let Some(on) = chart::cell_of(chart.flat((piece[0] + piece[1]) * 0.5)) else { continue };
        let (x, y) = ((on % CELLS) as i32, (on / CELLS) as i32);
        for (dx, dy) in (-SEEDS..=SEEDS).flat_map(|dy| (-SEEDS..=SEEDS).map(move |dx| (dx, dy))) {
            let (x, y) = (x + dx, y + dy);
            if !(0..CELLS as i32).contains(&x) || !(0..CELLS as i32).contains(&y) {
                continue;
            }
            let cell = y as usize * CELLS + x as usize;
            let off = chart.spots()[cell].point - piece[0];
            let t = (off.dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let d = off.distance(along * t);
            if d < HIGH * chart.unit() {
                let known = seeds.entry(cell as u32).or_insert(f32::MAX);
                *known = known.min(d);
            }
        }
    }
    seeds
}

/// Distance of a cell by way of `from` and the finished cells next to both.
fn reached(chart: &Chart, far: &Window, cell: u32, from: u32) -> f32 {
    let spots = chart.spots();
    let here = spots[cell as usize].point;
    let a = spots[from as usize].point - here;
    let da = far.get(from);
    let bare = |cell: u32| !grows(chart, cell as usize);
    if bare(cell) || bare(from) {
        return da + BARE * a.length();
    }
    let mut best = da + a.length();
    let (x, y) = ((from as usize % CELLS) as i32, (from as usize / CELLS) as i32);
    let (cx, cy) = ((cell as usize % CELLS) as i32, (cell as usize / CELLS) as i32);
    // The two cells next to `from` on the ring around this one: one eighth of a turn in each direction.
    let (dx, dy) = (x - cx, y - cy);
    for turn in [1, -1] {
        let (ex, ey) = ((dx - turn * dy).clamp(-1, 1), (dy + turn * dx).clamp(-1, 1));
        let (x, y) = (cx + ex, cy + ey);
        if !(0..CELLS as i32).contains(&x) || !(0..CELLS as i32).contains(&y) {
            continue;
        }
        let other = (y as usize * CELLS + x as usize) as u32;
        if far.done(other) && !bare(other) {
            let b = spots[other as usize].point - here;
            best = best.min(through(a, da, b, far.get(other)));
        }
    }
    best
}

/// Distance of the origin behind a planar front that passed `a` at `da` and `b` at `db`; a large number if the front
/// does not come from between the two.
fn through(a: Vec3, da: f32, b: Vec3, db: f32) -> f32 {
    // With T the time here, (T - da, T - db) are the front's direction along a and b: its length is 1.
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let det = aa * bb - ab * ab;
    if det <= 1e-4 * aa * bb {
        return f32::MAX;
    }
    let inverse = |x: f32, y: f32| ((bb * x - ab * y) / det, (aa * y - ab * x) / det);
    let (ox, oy) = inverse(1.0, 1.0);
    let (sx, sy) = inverse(da, db);
    let (oo, os, ss) = (ox + oy, sx + sy, da * sx + db * sy);
    let root = os * os - oo * (ss - 1.0);
    if root < 0.0 || oo <= 0.0 {
        return f32::MAX;
    }
    let t = (os + root.sqrt()) / oo;
    let (wx, wy) = inverse(t - da, t - db);
    if wx >= 0.0 && wy >= 0.0 && t >= da.max(db) { t } else { f32::MAX }
}

/// Distances during propagation.
struct Window {
    far: Vec<f32>,
    done: Vec<bool>,
}

impl Default for Window {
    fn default() -> Self {
        Self { far: vec![f32::MAX; CELLS * CELLS], done: vec![false; CELLS * CELLS] }
    }
}

impl Window {
    fn get(&self, cell: u32) -> f32 {
        self.far[cell as usize]
    }
    fn set(&mut self, cell: u32, d: f32) {
        let far = &mut self.far[cell as usize];
        *far = far.min(d);
    }
    fn done(&self, cell: u32) -> bool {
        self.done[cell as usize]
    }
    fn finish(&mut self, cell: u32) {
        self.done[cell as usize] = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::data::scalp::{HeadFrame, REGION, Scalp};
    use crate::maths::closest::Surface;
    use crate::maths::hash::Dice;
    use crate::maths::transcendental::{acos, sin_cos};
    use crate::scalp::hairline::{default_region, ears};
    use crate::scalp::territory::Row;

    /// A line down a half circle of the ball, `turn` radians to the right.
    fn meridian(turn: f32) -> Vec<Vec3> {
        let (sin, cos) = sin_cos(turn);
        let at = |k: i32| {
            let (s, c) = sin_cos(0.05 * k as f32);
            Vec3::new(s * sin, c, s * cos) * 8.9
        };
        (2..=28).map(at).collect()
    }

    #[test]
    fn on_a_ball_ways_are_arcs_to_half_a_millimetre() {
        let scalp = shared_ball();
        let line = meridian(0.0);
        let row = Row::new(1, &line).unwrap();
        let row = { row.ways_over(&scalp, 9.0) }.map(|over| row.going_over(Some(over))).unwrap();
        let dice = Dice::new(1, 0, "over");
        let mut seen = 0;
        for id in 0..2000 {
            let v = Vec3::from([0, 1, 2].map(|k| dice.signed(id, k)));
            let up = Vec3::new(v.x, v.y.abs() + 0.2, v.z).normalize();
            let p = scalp.closest_root(up * 8.9).unwrap().point;
            // The nearest of many points of the line, by angle.
            let arc = |k: i32| {
                let (s, c) = sin_cos(0.1 + 1.3 * k as f32 / 600.0);
                8.9 * acos(up.dot(Vec3::new(0.0, c, s)).clamp(-1.0, 1.0))
            };
            let wanted = (0..=600).map(arc).fold(f32::MAX, f32::min);
            if (1.0..8.0).contains(&wanted) {
                let found = row.far(&scalp, p, row.nearest(p).1);
                assert!((found - wanted).abs() < 0.05, "{p}: {found} for {wanted}");
                seen += 1;
            }
        }
        assert!(seen > 300, "{seen}");
    }

    #[test]
    fn borders_lie_half_way_to_a_millimetre() {
        // Halfway between two meridians is the one between them.
        let scalp = shared_ball();
        let rows = [-0.5, 0.5].map(|turn| {
            let row = Row::new(1, &meridian(turn)).unwrap();
            let over = row.ways_over(&scalp, 9.0);
            row.going_over(over)
        });
        for p in &meridian(0.0)[2..] {
            let p = scalp.closest_root(*p).unwrap().point;
            let [a, b] = [0, 1].map(|i: usize| rows[i].far(&scalp, p, rows[i].nearest(p).1));
            assert!((a - b).abs() < 0.1, "{p}: {a} and {b}");
        }
    }

    #[test]
    fn skin_that_is_cut_off_belongs_to_the_nearest_row_too() {
        // The ball's cap with a bare ring around it, and skin again below the ring.
        let ball = shared_ball();
        let bare = |p: &Vec3| (4.0..6.0).contains(&p.y);
        let region = ball.surface().points.iter().map(|p| f32::from(p.y > 0.0 && !bare(p)));
        let masks = [(REGION.to_owned(), region.collect())].into();
        let surface = Surface::new(ball.surface().points.clone(), ball.surface().triangles.clone());
        let scalp = Scalp::new(surface, None, *ball.frame(), masks);
        let rows = [-0.5f32, 0.5].map(|turn| {
            let row = Row::new(1, &meridian(turn)[..8]).unwrap();
            let over = row.ways_over(&scalp, 30.0);
            row.going_over(over)
        });
        for turn in [-0.4f32, -0.2, 0.2, 0.4] {
            let (sin, cos) = sin_cos(turn);
            let p = scalp.closest_root(Vec3::new(8.4 * sin, 2.5, 8.4 * cos)).unwrap().point;
            let [a, b] = [0, 1].map(|i: usize| rows[i].far(&scalp, p, rows[i].nearest(p).1));
            assert!((b - a) * turn < 0.0 && (b - a).abs() > 0.2, "{turn}: {a} and {b}");
        }
    }

    #[test]
    fn behind_an_ear_the_way_is_longer_than_straight() {
        // A row in front of the ear, and skin behind the ear.
        let mesh = crate::scalp::bust::adult();
        let (surface, frame) = (Surface::new(mesh.points, mesh.triangles), HeadFrame::IDENTITY);
        let ears = ears(&surface, &frame, &|| Ok(())).unwrap();
        let region = default_region(&surface, &frame, 0.5, &ears, &|| Ok(())).unwrap();
        let scalp = Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into());
        let on = |p: Vec3| scalp.closest_root(p).unwrap().point;
        let chart = scalp.chart();
        let before = |k: i32| on(Vec3::new(7.4, 4.0 - 0.5 * k as f32, 3.4));
        let row = Row::new(1, &(0..12).map(before).collect::<Vec<_>>()).unwrap();
        let over = row.ways_over(&scalp, 30.0);
        let row = row.going_over(over);
        let mut most: f32 = 1.0;
        for spot in chart.spots().iter().filter(|spot| spot.grows > 0.5) {
            let straight = row.nearest(spot.point).1;
            let far = row.far(&scalp, spot.point, straight);
            assert!(far >= straight && far <= 30.0);
            most = most.max(if straight < 6.0 { far / straight } else { 1.0 });
        }
        assert!(most > 1.2, "{most}");
        assert!(Over::new(&[Vec3::Y * 40.0, Vec3::Y * 50.0], &scalp, 9.0).is_none());
    }
}
