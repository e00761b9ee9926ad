//! Nearest-neighbour queries on points: a k-d tree, built once.
//!
//! Guarantees: exact; ties go to the lowest index; the same answer on every machine. For many nearby query points,
//! [`KdTree::find_each`] descends the tree once for a group of them.

use glam::Vec3;

/// A k-d tree over points: each part is split in the middle across its longest side.
#[derive(Debug)]
pub struct KdTree {
    /// Points and their indices, in tree order.
    points: Vec<(Vec3, u32)>,
    axes: Vec<u8>,
}

impl KdTree {
    /// The tree of these points; non-finite points are never found.
    pub fn new(points: impl IntoIterator<Item = Vec3>) -> Self {
        Self::numbered(points.into_iter().zip(0..))
    }
    /// [`Self::new`] for points with their own indices.
    pub fn numbered(points: impl IntoIterator<Item = (Vec3, u32)>) -> Self {
        let mut points: Vec<(Vec3, u32)> =
            points.into_iter().filter(|(p, _)| p.is_finite()).collect();
        let mut axes = vec![0; points.len()];
        split(&mut points, &mut axes);
        Self { points, axes }
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.points.len() * (size_of::<(Vec3, u32)>() + 1)
    }
    /// Puts squared distance and index of the `most` points nearest to `p` into `found`, nearest first.
    pub fn find(&self, p: Vec3, most: usize, found: &mut Vec<(f32, u32)>) {
        found.clear();
        if most > 0 && p.is_finite() {
            self.search(p, most, found, 0, self.points.len());
        }
    }
    fn search(&self, p: Vec3, most: usize, found: &mut Vec<(f32, u32)>, from: usize, to: usize) {
        if from == to {
            return;
        }
        let middle = (from + to) / 2;
        let (at, number) = self.points[middle];
        let candidate = (at.distance_squared(p), number);
        let slot = found.partition_point(|one| *one < candidate);
        if slot < most {
            if found.len() == most {
                found.pop();
            }
            found.insert(slot, candidate);
        }
        let axis = self.axes[middle] as usize;
        let side = p[axis] - at[axis];
        let (near, far) = ((from, middle), (middle + 1, to));
        let (near, far) = if side < 0.0 { (near, far) } else { (far, near) };
        self.search(p, most, found, near.0, near.1);
        // Equal to the worst so far still counts: its index may be lower.
        if found.len() < most || side * side <= found[found.len() - 1].0 {
            self.search(p, most, found, far.0, far.1);
        }
    }
}

/// Largest number of queries that share one descent.
const RUN: usize = 64;
/// Number of candidates above which a group of queries is split.
const MANY: usize = 64;
/// Points compared at once.
const LANES: usize = 8;

/// Candidates for the nearest points of all queries in a ball, one list per axis.
#[derive(Default)]
struct Around {
    /// Squared distances from the centre of the ball, with indices and points; nearest first.
    found: Vec<(f32, u32, Vec3)>,
    axes: [Vec<[f32; LANES]>; 3],
    numbers: Vec<[u32; LANES]>,
}

impl Around {
    fn pack(&mut self) {
        self.found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.axes.iter_mut().for_each(Vec::clear);
        self.numbers.clear();
        for pack in self.found.chunks(LANES) {
            // Padding of a pack: nearest to nothing.
            let at = |i: usize| pack.get(i).map_or(Vec3::MAX, |one| one.2);
            for (k, axis) in self.axes.iter_mut().enumerate() {
                axis.push(std::array::from_fn(|i| at(i)[k]));
            }
            self.numbers.push(std::array::from_fn(|i| pack.get(i).map_or(u32::MAX, |one| one.1)));
        }
    }

    /// Puts the points nearest to `p` into `nearest`, whose length is the requested number; returns how many there are.
    fn nearest_to(&self, p: Vec3, nearest: &mut [(f32, u32)]) -> usize {
        const NONE: (f32, u32) = (f32::INFINITY, u32::MAX);
        nearest.fill(NONE);
        let [xs, ys, zs] = &self.axes;
        let worst = nearest.len() - 1;
        for (((x, y), z), numbers) in xs.iter().zip(ys).zip(zs).zip(&self.numbers) {
            let mut squares = [0.0f32; LANES];
            for (i, square) in squares.iter_mut().enumerate() {
                let (x, y, z) = (x[i] - p.x, y[i] - p.y, z[i] - p.z);
                *square = x * x + y * y + z * z;
            }
            for candidate in squares.into_iter().zip(*numbers) {
                if candidate.0 > nearest[worst].0 || candidate >= nearest[worst] {
                    continue;
                }
                let mut slot = worst;
                while slot > 0 && candidate < nearest[slot - 1] {
                    nearest[slot] = nearest[slot - 1];
                    slot -= 1;
                }
                nearest[slot] = candidate;
            }
        }
        nearest.len().min(self.found.len())
    }
}

/// Scratch memory of [`KdTree::find_each`].
#[derive(Default)]
struct Desk {
    around: Around,
    found: Vec<(f32, u32)>,
    nearest: Vec<(f32, u32)>,
}

impl KdTree {
    /// The result of [`Self::find`] for each of `askers`, with their indices in order. Faster than single queries if neighbours
    /// in the list are close in space.
    pub fn find_each(
        &self,
        askers: &[Vec3],
        most: usize,
        mut tell: impl FnMut(usize, &mut Vec<(f32, u32)>),
    ) {
        let mut desk = Desk::default();
        for (i, run) in askers.chunks(RUN).enumerate() {
            self.find_run(run, i * RUN, most, &mut desk, &mut tell);
        }
    }

    fn find_run(
        &self,
        run: &[Vec3],
        first: usize,
        most: usize,
        desk: &mut Desk,
        tell: &mut impl FnMut(usize, &mut Vec<(f32, u32)>),
    ) {
        if let [alone] = run {
            self.find(*alone, most, &mut desk.found);
            return tell(first, &mut desk.found);
        }
        if !self.look_around(run, most, desk) {
            let (left, right) = run.split_at(run.len() / 2);
            self.find_run(left, first, most, desk, tell);
            return self.find_run(right, first + left.len(), most, desk, tell);
        }
        desk.nearest.resize(most, (0.0, 0));
        for (i, p) in run.iter().enumerate() {
            let count = desk.around.nearest_to(*p, &mut desk.nearest);
            desk.found.clear();
            desk.found.extend_from_slice(&desk.nearest[..count]);
            tell(first + i, &mut desk.found);
        }
    }

    /// Gathers all candidates of a run of queries, unless there are too many.
    fn look_around(&self, run: &[Vec3], most: usize, desk: &mut Desk) -> bool {
        let (lo, hi) = run.iter().fold((run[0], run[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let middle = lo + (hi - lo) * 0.5;
        let radius = run.iter().map(|p| p.distance_squared(middle)).fold(0.0, f32::max).sqrt();
        // (Neither is a number if a query point is not.)
        let is_ball =
            (radius + middle.element_sum()).is_finite() && run.iter().all(|p| p.is_finite());
        if most == 0 || most > MANY || !is_ball {
            return false;
        }
        self.find(middle, most, &mut desk.found);
        let far = match desk.found.last() {
            Some((square, _)) if desk.found.len() == most => square.sqrt(),
            _ => f32::INFINITY,
        };
        // At least that many lie within `far` of the centre, so no nearest point of a query lies beyond this; rounding must
        // exclude nothing.
        let reach = far + 2.0 * radius;
        let reach = reach + 1e-5 * (reach + middle.abs().max_element());
        desk.around.found.clear();
        let enough = self.gather(middle, reach, 0, self.points.len(), &mut desk.around.found);
        if enough {
            desk.around.pack();
        }
        enough
    }

    /// Gathers the points within `reach` of `p`; false if there are more than [`MANY`].
    fn gather(
        &self,
        p: Vec3,
        reach: f32,
        from: usize,
        to: usize,
        found: &mut Vec<(f32, u32, Vec3)>,
    ) -> bool {
        if from == to {
            return true;
        }
        let middle = (from + to) / 2;
        let (at, number) = self.points[middle];
        let square = at.distance_squared(p);
        if square <= reach * reach {
            if found.len() == MANY {
                return false;
            }
            found.push((square, number, at));
        }
        let side = p[self.axes[middle] as usize] - at[self.axes[middle] as usize];
        (side > reach || self.gather(p, reach, from, middle, found))
            && (-side > reach || self.gather(p, reach, middle + 1, to, found))
    }
}

fn split(points: &mut [(Vec3, u32)], axes: &mut [u8]) {
    if points.len() < 2 {
        return;
    }
    let first = points[0].0;
    let (lo, hi) = points.iter().fold((first, first), |(lo, hi), (p, _)| (lo.min(*p), hi.max(*p)));
    let axis = (hi - lo).max_position();
    let middle = points.len() / 2;
    points
        .select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let (left, right) = points.split_at_mut(middle);
    let (axes_left, axes_right) = axes.split_at_mut(middle);
    split(left, axes_left);
    split(&mut right[1..], &mut axes_right[1..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    #[test]
    fn finds_what_a_search_through_all_finds() {
        let dice = Dice::new(3, 0, "point");
        // Rounded, so that many are equally near.
        let at = |id: u64| {
            Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2) * 0.2) * 5.0
        };
        for n in [0, 1, 2, 7, 500] {
            let points: Vec<Vec3> = (0..n).map(|id| at(id).round()).collect();
            let tree = KdTree::new(points.iter().copied());
            let mut found = vec![];
            for query in 0..200 {
                let p = (at(1000 + query) * 2.0).round() * 0.5;
                let mut all: Vec<(f32, u32)> =
                    points.iter().map(|q| q.distance_squared(p)).zip(0..).collect();
                all.sort_by(|a, b| a.partial_cmp(b).unwrap());
                for most in [1, 4, 9] {
                    tree.find(p, most, &mut found);
                    assert_eq!(found, all[..most.min(all.len())]);
                }
            }
        }
    }

    #[test]
    fn who_asks_with_others_is_told_what_it_is_told_alone() {
        let dice = Dice::new(4, 0, "run");
        let at = |id: u64, size: f32| {
            Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2) * 0.2) * size
        };
        // Few and many points, on a lattice where many are equally near, beside each other and far from the middle; all in one place.
        for (n, size, middle) in
            [(0, 5.0, 0.0), (3, 5.0, 0.0), (400, 5.0, 0.0), (4000, 9.0, 1e4), (300, 0.0, 1.0)]
        {
            let middle = Vec3::splat(middle);
            let tree = KdTree::new((0..n).map(|id| middle + (at(id, size) * 2.0).round() * 0.5));
            // Beside each other, jumping, far off, and none.
            let mut askers: Vec<Vec3> = vec![];
            for run in 0..20u64 {
                let wide = [0.01, 0.5, 20.0][run as usize % 3];
                let from = middle + at(9000 + run, size);
                let beside = (0..37).map(|k| from + (at(100 * run + k, wide) * 4.0).round() * 0.25);
                askers.extend(beside);
            }
            askers.extend([Vec3::splat(1e7), Vec3::NAN, Vec3::ZERO, middle]);
            let mut alone = vec![];
            for most in [0, 1, 4, 17, 100] {
                let mut told = 0;
                tree.find_each(&askers, most, |i, found| {
                    tree.find(askers[i], most, &mut alone);
                    assert_eq!(*found, alone, "{n} points, the nearest {most} to {}", askers[i]);
                    assert_eq!(i, told);
                    told += 1;
                });
                assert_eq!(told, askers.len());
            }
        }
    }
}
