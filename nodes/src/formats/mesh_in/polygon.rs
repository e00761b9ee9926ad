//! Polygons to triangles: a fan where the polygon is convex, ear clipping where it is not.
//!
//! The polygon is laid flat along the largest axis of its normal (Newell's), in doubles, in which
//! the turns of single-precision corners come out right or nearly so. Ears are tried in corner
//! order, so the answer depends on the polygon alone. Always `n - 2` triangles that wind as the
//! polygon does; in a simple flat polygon none of them overlap. Crossing edges, no area at all or
//! corners that fold back give *some* triangles.
//!
//! Ear clipping takes n³ steps at worst. All polygons of a file share [`MOST_STEPS`]; once they are
//! spent the rest become fans, and the reader says so.

use glam::Vec3;

/// Corner tests for all polygons of one file, about half a second. A concave polygon of n corners
/// takes about n² of them: this is enough for 10 000 polygons of 100 corners.
const MOST_STEPS: u64 = 100_000_000;

/// Cuts polygons into triangles, with scratch memory kept from one to the next.
#[derive(Debug)]
pub(crate) struct Clipper {
    steps_left: u64,
    /// The corners of the polygon in its plane, counter-clockwise.
    flat: Vec<[f64; 2]>,
    /// The corner before and after each, as long as they are not cut off.
    before: Vec<u32>,
    after: Vec<u32>,
    /// Corners that are no ear and may lie in one: those that do not turn left.
    dull: Vec<bool>,
}

impl Default for Clipper {
    fn default() -> Self {
        Self {
            steps_left: MOST_STEPS,
            flat: Vec::new(),
            before: Vec::new(),
            after: Vec::new(),
            dull: Vec::new(),
        }
    }
}

impl Clipper {
    /// Adds the triangles of one polygon to `out`, as positions in `ring`.
    ///
    /// False if a concave polygon became a fan because [`MOST_STEPS`] are spent.
    pub(crate) fn triangulate(&mut self, ring: &[Vec3], out: &mut Vec<[u32; 3]>) -> bool {
        let n = ring.len();
        if n <= 3 || !self.lay_flat(ring) || self.is_convex() {
            fan(n, |i| i as u32, out);
            return true;
        }
        if self.steps_left == 0 {
            fan(n, |i| i as u32, out);
            return false;
        }
        self.clip(out)
    }

    /// False where the polygon has no area to lay flat.
    fn lay_flat(&mut self, ring: &[Vec3]) -> bool {
        // From the first corner, which a polygon far from the origin needs.
        let origin = ring[0].to_array().map(f64::from);
        let at = |i: usize| {
            let p = ring[i % ring.len()].to_array().map(f64::from);
            [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]
        };
        let mut normal = [0.0_f64; 3];
        for i in 0..ring.len() {
            let (a, b) = (at(i), at(i + 1));
            for (axis, component) in normal.iter_mut().enumerate() {
                let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
                *component += a[x] * b[y] - a[y] * b[x];
            }
        }
        // The first of the largest, so that ties are settled.
        let mut up = 0;
        for axis in 1..3 {
            if normal[axis].abs() > normal[up].abs() {
                up = axis;
            }
        }
        let (x, y) = ((up + 1) % 3, (up + 2) % 3);
        let (x, y) = if normal[up] > 0.0 { (x, y) } else { (y, x) };
        self.flat.clear();
        self.flat.extend((0..ring.len()).map(|i| [at(i)[x], at(i)[y]]));
        normal[up] != 0.0
    }

    /// Whether every corner turns left, and all of them together turn round once.
    fn is_convex(&self) -> bool {
        let n = self.flat.len();
        let mut turns = 0;
        let mut was_rising = None;
        // One edge more than there are, to meet the first again.
        for i in 0..=n {
            let (a, b, c) = (i % n, (i + 1) % n, (i + 2) % n);
            if self.turn(a, b, c) <= 0.0 {
                return false;
            }
            let rise = self.flat[b][1] - self.flat[a][1];
            if rise != 0.0 {
                turns += usize::from(was_rising.is_some_and(|was| was != (rise > 0.0)));
                was_rising = Some(rise > 0.0);
            }
        }
        turns <= 2
    }

    /// Twice the area of a triangle; positive where it turns left.
    fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        let [a, b, c] = [self.flat[a], self.flat[b], self.flat[c]];
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    fn turn_at(&self, i: usize) -> f64 {
        self.turn(self.before[i] as usize, i, self.after[i] as usize)
    }

    fn clip(&mut self, out: &mut Vec<[u32; 3]>) -> bool {
        let n = self.flat.len();
        let mut left = n;
        self.before.clear();
        self.before.extend((0..n).map(|i| ((i + n - 1) % n) as u32));
        self.after.clear();
        self.after.extend((0..n).map(|i| ((i + 1) % n) as u32));
        self.dull.clear();
        self.dull.resize(n, false);
        for i in 0..n {
            self.dull[i] = self.turn_at(i) <= 0.0;
        }
        let (mut i, mut misses) = (0, 0);
        while left > 3 && self.steps_left > 0 {
            let stuck = misses >= left;
            if stuck {
                // No ear: the polygon crosses or touches itself. A corner that lies between its
                // neighbours costs nothing; otherwise any corner that turns left will do.
                let Some(next) = self.least_bad(i, left) else { break };
                i = next;
            } else if !self.is_ear(i) {
                i = self.after[i] as usize;
                misses += 1;
                continue;
            }
            let (a, c) = (self.before[i] as usize, self.after[i] as usize);
            out.push([a as u32, i as u32, c as u32]);
            self.after[a] = c as u32;
            self.before[c] = a as u32;
            left -= 1;
            for corner in [a, c] {
                self.dull[corner] = self.turn_at(corner) <= 0.0;
            }
            // Past `c`, so that long thin fans around one corner stay rare.
            i = self.after[c] as usize;
            misses = 0;
        }
        let mut rest = vec![i as u32];
        while rest.len() < left {
            i = self.after[i] as usize;
            rest.push(i as u32);
        }
        fan(rest.len(), |i| rest[i], out);
        self.steps_left > 0
    }

    fn is_ear(&mut self, i: usize) -> bool {
        let (a, c) = (self.before[i] as usize, self.after[i] as usize);
        self.steps_left = self.steps_left.saturating_sub(1);
        if self.dull[i] {
            return false;
        }
        let mut other = self.after[c] as usize;
        while other != a {
            self.steps_left = self.steps_left.saturating_sub(1);
            // A corner at the very place of one of the three is where a bridge to a hole ends.
            let same = [a, i, c].iter().any(|v| self.flat[*v] == self.flat[other]);
            if self.dull[other]
                && !same
                && self.turn(a, i, other) >= 0.0
                && self.turn(i, c, other) >= 0.0
                && self.turn(c, a, other) >= 0.0
            {
                return false;
            }
            other = self.after[other] as usize;
        }
        true
    }

    fn least_bad(&self, start: usize, left: usize) -> Option<usize> {
        let mut left_turn = None;
        let mut i = start;
        for _ in 0..left {
            let turn = self.turn_at(i);
            if turn == 0.0 {
                return Some(i);
            }
            if turn > 0.0 && left_turn.is_none() {
                left_turn = Some(i);
            }
            i = self.after[i] as usize;
        }
        left_turn
    }
}

fn fan(n: usize, corner: impl Fn(usize) -> u32, out: &mut Vec<[u32; 3]>) {
    for i in 2..n {
        out.push([corner(0), corner(i - 1), corner(i)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the signed area of a ring in xy.
    fn area(ring: &[[f32; 2]]) -> f64 {
        let at = |i: usize| ring[i % ring.len()].map(f64::from);
        (0..ring.len()).map(|i| at(i)[0] * at(i + 1)[1] - at(i)[1] * at(i + 1)[0]).sum()
    }

    /// The triangles cover the polygon once: none is turned over, and their areas add up.
    #[track_caller]
    fn check(ring: &[[f32; 2]], some_without_area: bool) {
        type Place = fn(&[f32; 2]) -> Vec3;
        // Flat, upright and turned over.
        let places: [Place; 3] = [
            |p| Vec3::new(p[0], p[1], 0.5),
            |p| Vec3::new(7.0, p[0], p[1]),
            |p| Vec3::new(p[1], p[0], -3.0),
        ];
        let expected = area(ring);
        for place in places {
            let mut triangles = Vec::new();
            let points: Vec<Vec3> = ring.iter().map(place).collect();
            assert!(Clipper::default().triangulate(&points, &mut triangles));
            assert_eq!(triangles.len(), ring.len() - 2);
            let areas = triangles.iter().map(|t| area(&t.map(|v| ring[v as usize])));
            let sign = expected.signum();
            let mut sum = 0.0;
            for a in areas {
                assert!(a * sign > 0.0 || (some_without_area && a == 0.0), "{triangles:?}");
                sum += a;
            }
            assert!((sum - expected).abs() <= 1e-9 * expected.abs(), "{sum} {expected}");
        }
    }

    #[test]
    fn a_square_is_cut_from_its_first_corner() {
        let mut out = Vec::new();
        Clipper::default().triangulate(&[Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y], &mut out);
        assert_eq!(out, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn an_arrow_head_is_cut_along_its_inner_diagonal() {
        check(&[[0., 0.], [2., 2.], [0., 1.], [-2., 2.]], false);
        check(&[[2., 2.], [0., 1.], [-2., 2.], [0., 0.]], false);
    }

    #[test]
    fn a_corner_on_a_straight_edge_gives_no_flat_triangle() {
        check(&[[0., 0.], [1., 0.], [2., 0.], [2., 2.], [0., 2.]], false);
        check(&[[0., 0.], [1., 0.], [2., 0.], [1., 2.]], false);
    }

    #[test]
    fn stars_combs_and_spirals_are_covered_once() {
        let ray = [
            [1., 0.],
            [0.5, 0.5],
            [0., 1.],
            [-0.5, 0.5],
            [-1., 0.],
            [-0.5, -0.5],
            [0., -1.],
            [0.5, -0.5],
        ];
        let star: Vec<[f32; 2]> = (0..64)
            .map(|i| {
                let (a, b) = (ray[i / 8], ray[(i / 8 + 1) % 8]);
                let (t, r) = ((i % 8) as f32 / 8.0, if i % 2 == 0 { 1.0 } else { 0.25 });
                [r * (a[0] + (b[0] - a[0]) * t), r * (a[1] + (b[1] - a[1]) * t)]
            })
            .collect();
        check(&star, false);
        let mut comb: Vec<[f32; 2]> =
            (0..40).map(|i| [i as f32, if i % 2 == 0 { 0.0 } else { 9.0 }]).collect();
        comb.extend([[39., -1.], [0., -1.]]);
        check(&comb, false);
        let spiral = [
            [0., 0.],
            [9., 0.],
            [9., 9.],
            [2., 9.],
            [2., 4.],
            [5., 4.],
            [5., 6.],
            [4., 6.],
            [4., 5.],
            [3., 5.],
            [3., 8.],
            [8., 8.],
            [8., 1.],
            [1., 1.],
            [1., 9.],
            [0., 9.],
        ];
        check(&spiral, false);
    }

    #[test]
    fn a_hole_reached_by_a_bridge_stays_open() {
        check(
            &[
                [0., 0.],
                [9., 0.],
                [9., 9.],
                [0., 9.],
                [0., 0.],
                [3., 3.],
                [3., 6.],
                [6., 6.],
                [6., 3.],
                [3., 3.],
            ],
            true,
        );
    }

    #[test]
    fn crossed_folded_and_empty_polygons_give_n_minus_two_triangles() {
        let pentagram = [[0., 3.], [-2., -3.], [3., 1.], [-3., 1.], [2., -3.]];
        let folded = [[0., 0.], [1., 0.], [0., 0.], [1., 0.], [0., 0.]];
        let bow = [[0., 0.], [2., 2.], [2., 0.], [0., 2.1]];
        for ring in [&pentagram[..], &folded, &bow, &[[1., 1.]; 6]] {
            let ring: Vec<Vec3> =
                ring.iter().map(|p: &[f32; 2]| Vec3::new(p[0], p[1], 0.0)).collect();
            let mut out = Vec::new();
            assert!(Clipper::default().triangulate(&ring, &mut out));
            assert_eq!(out.len(), ring.len() - 2);
        }
    }

    #[test]
    fn without_steps_left_a_concave_polygon_becomes_a_fan() {
        let mut clipper = Clipper { steps_left: 3, ..Clipper::default() };
        let ring: Vec<Vec3> =
            (0..50).map(|i| Vec3::new(i as f32, ((i * 7) % 13) as f32, 0.0)).collect();
        for _ in 0..2 {
            let mut out = Vec::new();
            assert!(!clipper.triangulate(&ring, &mut out));
            assert_eq!(out.len(), 48);
        }
    }
}
