//! The nearest of many points: a tree that is built once and asked often.
//!
//! Guarantees: exact; of points equally near the one with the lowest number counts; the same answer on every machine.

use glam::Vec3;

/// A k-d tree over points: the middle of each part splits it along its longest side.
#[derive(Debug)]
pub struct Nearest {
    /// Points and their numbers, in the order of the tree.
    points: Vec<(Vec3, u32)>,
    axes: Vec<u8>,
}

impl Nearest {
    /// The tree of these points; those that are not finite are never found.
    pub fn new(points: impl IntoIterator<Item = Vec3>) -> Self {
        let mut points: Vec<(Vec3, u32)> =
            points.into_iter().zip(0..).filter(|(p, _)| p.is_finite()).collect();
        let mut axes = vec![0; points.len()];
        split(&mut points, &mut axes);
        Self { points, axes }
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.points.len() * (size_of::<(Vec3, u32)>() + 1)
    }
    /// Puts squared distance and number of the `most` points nearest to `p` into `found`, nearest first.
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
        // As near as the worst so far still counts: it may have a lower number.
        if found.len() < most || side * side <= found[found.len() - 1].0 {
            self.search(p, most, found, far.0, far.1);
        }
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
            let tree = Nearest::new(points.iter().copied());
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
}
