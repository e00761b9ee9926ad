//! Numbers of curves that views show: length, curvature, density, depth under the skin, distance from partings.
//!
//! Guarantees: each returns one number a point (NaN where there is none to tell); curves without length have numbers
//! too. Density and partings ask all curves at once and are made once.

use coif_nodes::data::attributes::{BRAID, PARENT};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use glam::Vec3;
use std::collections::BTreeMap;

/// Arc length of a polyline, cm.
pub(super) fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|p| p[0].distance(p[1])).sum()
}

/// Fraction of the arc length at each point; 0 on curves without length.
pub(super) fn along(tuft: &Tuft) -> Vec<f32> {
    let mut out = Vec::with_capacity(tuft.points().len());
    for i in 0..tuft.len() {
        let curve = tuft.curve(i);
        let whole = length(curve);
        let scale = if whole > 0.0 { 1.0 / whole } else { 0.0 };
        let mut so_far = 0.0;
        for (k, p) in curve.iter().enumerate() {
            if k > 0 {
                so_far += p.distance(curve[k - 1]);
            }
            out.push(so_far * scale);
        }
    }
    out
}

/// Direction at each point, not unit: the chord between its neighbours.
pub(super) fn tangents(tuft: &Tuft) -> impl Iterator<Item = Vec3> {
    (0..tuft.len()).flat_map(|i| {
        let curve = tuft.curve(i);
        (0..curve.len()).map(|k| curve[(k + 1).min(curve.len() - 1)] - curve[k.saturating_sub(1)])
    })
}

/// Curvature at each point, 1/cm: twice the sine of half the turn over the mean length of the two segments, which is exact for points
/// evenly on a circle and finite for a fold. Ends have that of their neighbours; two points have none.
pub(super) fn curvature(tuft: &Tuft) -> Vec<f32> {
    let mut out = Vec::with_capacity(tuft.points().len());
    for i in 0..tuft.len() {
        let curve = tuft.curve(i);
        let at = |k: usize| {
            let (a, b) = (curve[k] - curve[k - 1], curve[k + 1] - curve[k]);
            let (la, lb) = (a.length(), b.length());
            if la * lb <= 0.0 {
                return 0.0;
            }
            // Half the chord between unit directions is the sine of half the turn.
            (a / la).distance(b / lb) / (0.5 * (la + lb))
        };
        match curve.len() {
            n @ 0..=2 => out.extend(std::iter::repeat_n(0.0, n)),
            n => out.extend((0..n).map(|k| at(k.clamp(1, n - 2)))),
        }
    }
    out
}

/// How deep each point lies under the skin, cm; 0 outside.
pub(super) fn depths(tuft: &Tuft, scalp: &Scalp) -> Vec<f32> {
    let skin = scalp.skin();
    let depth = |p: &Vec3| if p.is_finite() { (-skin.distance(*p)).max(0.0) } else { f32::NAN };
    tuft.points().iter().map(depth).collect()
}

/// Numbers worked out once for all tufts, found again by the tuft's key.
pub(super) struct CachedNumbers(BTreeMap<u128, Vec<f32>>);

impl CachedNumbers {
    pub(super) fn of(curves: &Curves, numbers: impl Fn(&Tuft) -> Vec<f32>) -> Self {
        Self(curves.tufts().iter().map(|t| (t.key().0, numbers(t))).collect())
    }
    pub(super) fn of_tuft(&self, tuft: &Tuft) -> Vec<f32> {
        let known = self.0.get(&tuft.key().0);
        known.cloned().unwrap_or_else(|| vec![f32::NAN; tuft.points().len()])
    }
}

/// Hair in a grid: its length by volume, which is how many hairs cross a square centimetre laid across them.
pub(super) struct Density {
    lower: Vec3,
    cell: f32,
    size: [usize; 3],
    /// cm of hair in each cell.
    lengths: Vec<f32>,
}

/// Cells of the grid along its longest side, at most.
const MOST_CELLS: f32 = 128.0;
/// The least size of a cell, cm.
const CELL: f32 = 0.5;

impl Density {
    pub(super) fn of(curves: &Curves) -> Self {
        let points = || curves.tufts().iter().flat_map(|t| t.points()).filter(|p| p.is_finite());
        let lower = points().fold(Vec3::MAX, |lo, p| lo.min(*p));
        let upper = points().fold(Vec3::MIN, |hi, p| hi.max(*p));
        if lower.cmpgt(upper).any() {
            return Self { lower: Vec3::ZERO, cell: CELL, size: [0; 3], lengths: vec![] };
        }
        let cell = ((upper - lower).max_element() / MOST_CELLS).max(CELL);
        // A cell more on every side, for the share that hair near a cell's side gives to the next.
        let size = ((upper - lower) / cell).to_array().map(|n| n as usize + 3);
        let mut grid =
            Self { lower: lower - cell, cell, size, lengths: vec![0.0; size.iter().product()] };
        for (tuft, i) in curves.each() {
            for pair in tuft.curve(i).windows(2) {
                let way = pair[1] - pair[0];
                let length = way.length();
                if !length.is_finite() || length <= 0.0 {
                    continue;
                }
                let pieces = (length / cell).ceil().min(4096.0);
                for k in 0..pieces as u32 {
                    let p = pair[0] + way * ((k as f32 + 0.5) / pieces);
                    let Some((at, weights)) = grid.around(p) else { continue };
                    for (at, weight) in at.into_iter().zip(weights) {
                        grid.lengths[at] += weight * length / pieces;
                    }
                }
            }
        }
        grid
    }

    /// The eight cells whose middles are around `p`, with their trilinear weights; none outside the grid.
    fn around(&self, p: Vec3) -> Option<([usize; 8], [f32; 8])> {
        let at = (p - self.lower) / self.cell - 0.5;
        let first = at.floor();
        let part = at - first;
        let first = first.to_array();
        if (0..3).any(|axis| !(first[axis] >= 0.0 && first[axis] + 1.0 < self.size[axis] as f32)) {
            return None;
        }
        let [x, y, z] = first.map(|n| n as usize);
        let (row, layer) = (self.size[0], self.size[0] * self.size[1]);
        let start = z * layer + y * row + x;
        let (b, a) = (part, 1.0 - part);
        let cells = [0, 1, row, row + 1].map(|step| start + step);
        let [c, d, e, f] = cells;
        let sides = [a.x * a.y, b.x * a.y, a.x * b.y, b.x * b.y];
        let [p, q, r, s] = sides.map(|w| w * a.z);
        let [t, u, v, w] = sides.map(|w| w * b.z);
        Some(([c, d, e, f, c + layer, d + layer, e + layer, f + layer], [p, q, r, s, t, u, v, w]))
    }

    /// Hairs across a square centimetre at `p`.
    pub(super) fn at(&self, p: Vec3) -> f32 {
        if !p.is_finite() {
            return f32::NAN;
        }
        let Some((at, weights)) = self.around(p) else { return 0.0 };
        let sum: f32 =
            at.into_iter().zip(weights).map(|(at, weight)| self.lengths[at] * weight).sum();
        sum / (self.cell * self.cell * self.cell)
    }
}

/// Whose ground a curve's root stands on: its braid's, else its parent's, else its own.
fn territory(tuft: &Tuft, i: usize) -> u64 {
    let at = tuft.range(i).start;
    match (tuft.view(BRAID).at(i, at), tuft.view(PARENT).at(i, at)) {
        (0, 0) => tuft.id(i),
        (0, parent) => parent,
        (braid, _) => braid,
    }
}

/// Distance of every curve's root from the nearest parting, cm: the line half-way between roots of different territories.
/// NaN for all where there is one territory only.
pub(super) fn partings(curves: &Curves) -> CachedNumbers {
    let mut roots = vec![];
    for (tuft, i) in curves.each() {
        if let Some(root) = tuft.curve(i).first().filter(|p| p.is_finite()) {
            roots.push((*root, territory(tuft, i)));
        }
    }
    let tree = Territories::new(roots);
    CachedNumbers::of(curves, |tuft| {
        let mut out = Vec::with_capacity(tuft.points().len());
        for i in 0..tuft.len() {
            let range = tuft.range(i);
            let distance = match tuft.curve(i).first() {
                Some(root) => tree.parting_distance(*root, territory(tuft, i)),
                None => f32::NAN,
            };
            out.extend(std::iter::repeat_n(distance, range.len()));
        }
        out
    })
}

/// A k-d tree of roots whose parts know whether all in them are of one territory.
struct Territories {
    /// Root, territory, and the axis that its part is split along.
    roots: Vec<(Vec3, u64, u8)>,
    /// For the middle of each part: the territory of all its roots, if it is one.
    one: Vec<Option<u64>>,
}

impl Territories {
    fn new(roots: Vec<(Vec3, u64)>) -> Self {
        let mut roots: Vec<(Vec3, u64, u8)> = roots.into_iter().map(|(p, t)| (p, t, 0)).collect();
        let mut one = vec![None; roots.len()];
        split(&mut roots, &mut one);
        Self { roots, one }
    }

    /// Distance from `p`, which is of `own` territory, to the line between it and the nearest other.
    fn parting_distance(&self, p: Vec3, own: u64) -> f32 {
        if !p.is_finite() {
            return f32::NAN;
        }
        let Some((q, other)) = self.nearest_other(p, own) else { return f32::NAN };
        // The line lies half-way between `q` and the nearest root that is not of its territory.
        let gap = self.nearest_other(q, other).map_or(0.0, |(r, _)| r.distance(q));
        (p.distance(q) - 0.5 * gap).max(0.0)
    }

    fn nearest_other(&self, p: Vec3, own: u64) -> Option<(Vec3, u64)> {
        let mut best = (f32::MAX, usize::MAX);
        self.search(p, own, 0, self.roots.len(), &mut best);
        self.roots.get(best.1).map(|r| (r.0, r.1))
    }

    fn search(&self, p: Vec3, own: u64, from: usize, to: usize, best: &mut (f32, usize)) {
        if from == to {
            return;
        }
        let middle = (from + to) / 2;
        if self.one[middle] == Some(own) {
            return;
        }
        let (at, territory, axis) = self.roots[middle];
        let candidate = (at.distance_squared(p), middle);
        if territory != own && candidate < *best {
            *best = candidate;
        }
        let side = p[axis as usize] - at[axis as usize];
        let (near, far) = ((from, middle), (middle + 1, to));
        let (near, far) = if side < 0.0 { (near, far) } else { (far, near) };
        self.search(p, own, near.0, near.1, best);
        if side * side <= best.0 {
            self.search(p, own, far.0, far.1, best);
        }
    }
}

/// Orders a part of the tree and returns the territory that all of it is of, if it is one. The middle is `len / 2` from the
/// start, as the search has it.
fn split(part: &mut [(Vec3, u64, u8)], one: &mut [Option<u64>]) -> Option<u64> {
    let (lower, upper) =
        part.iter().fold((Vec3::MAX, Vec3::MIN), |(lo, hi), (p, ..)| (lo.min(*p), hi.max(*p)));
    let axis = (upper - lower).max_position();
    let middle = part.len() / 2;
    if part.is_empty() {
        return None;
    }
    part.select_nth_unstable_by(middle, |a, b| {
        a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)).then_with(|| {
            let order = |p: Vec3| p.to_array().map(f32::to_bits);
            order(a.0).cmp(&order(b.0))
        })
    });
    part[middle].2 = axis as u8;
    let (own, last) = (part[middle].1, part.len());
    let mut all = true;
    for (from, to) in [(0, middle), (middle + 1, last)] {
        if from < to {
            all &= split(&mut part[from..to], &mut one[from..to]) == Some(own);
        }
    }
    one[middle] = all.then_some(own);
    one[middle]
}
