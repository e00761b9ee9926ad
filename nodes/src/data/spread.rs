//! The region as a tree of its triangles, by which roots are dealt out: every start of the list of roots is even, and which
//! roots a piece of skin gets is its own affair.
//!
//! The tree halves the mesh by how its triangles hang together and by their numbers; no position is asked. What comes to a
//! fork of the tree goes to its two halves in turn, to each as often as its area is worth, and a half counts what came to it
//! by itself. So the first so many roots of a half are the same whatever the other half is like; of the other half only its
//! area counts, for how many those are.
//!
//! Guarantees: the tree depends on the triangles and their neighbours alone, so a head that is turned, scaled, or shaped
//! differently has the same one; a part's tree is the same whichever other parts there are. Of any number of roots, each
//! half of a fork gets its share to within one. Areas count as ratios; where rounding sends a root to the other half, the
//! next one makes up for it. Not promised: the same roots for triangles in another order.

use crate::maths::closest::Surface;
use crate::maths::hash::mix;
use std::ops::Range;

/// The tree.
pub(crate) struct RegionTree {
    forks: Vec<Fork>,
    leaves: Vec<Leaf>,
    /// `None` without a region.
    top: Option<Branch>,
    area: f64,
}

/// Two halves of a set of triangles, both with a region.
#[derive(Clone, Copy)]
struct Fork {
    /// The first half's part of the area, 0 to 1.
    share: f64,
    halves: [Branch; 2],
    /// Hash of the numbers of the first triangles of both.
    name: u64,
}

/// A triangle of the region.
#[derive(Clone, Copy)]
struct Leaf {
    triangle: u32,
    /// Hash of its number.
    name: u64,
    /// Where it begins and how long it is if all are laid in a row, each as long as its area is worth, 0 to 1. Triangles close
    /// in the row are close on the scalp.
    start: f64,
    length: f64,
}

/// A fork or a leaf, by its index.
#[derive(Clone, Copy)]
enum Branch {
    Fork(u32),
    Leaf(u32),
}

/// What a root is dealt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dealt {
    pub(crate) triangle: u32,
    /// Hash of the triangle's number in its file.
    pub(crate) name: u64,
    /// How many roots the triangle was dealt before.
    pub(crate) nth: u64,
    /// Where the triangle begins and how long it is in the row of all, 0 to 1.
    pub(crate) row: [f64; 2],
}

/// Bits kept of the total area, for counts derived from it.
const AREA_BITS: u32 = 16;

impl RegionTree {
    /// The tree of a region with these upper bounds, one per triangle. `numbers` are the triangles' numbers in their file, if
    /// some are left out.
    pub(crate) fn new(
        surface: &Surface,
        highest: &dyn Fn(u32) -> f32,
        numbers: Option<&[u32]>,
    ) -> Self {
        let area = |t: u32| {
            let highest = highest(t);
            if highest <= 0.0 { 0.0 } else { 0.5 * surface.area_vector(t).length() * highest }
        };
        let count = surface.triangles.len() as u32;
        let areas = (0..count).map(|t| Some(f64::from(area(t))).filter(|a| a.is_finite()));
        let mut grower = Grower {
            areas: areas.map(Option::unwrap_or_default).collect(),
            beside: beside(&surface.triangles),
            numbers,
            order: (0..count).collect(),
            marks: vec![0; count as usize],
            mark: 0,
            forks: vec![],
            leaves: vec![],
        };
        let parts = grower.parts();
        let (top, area) = grower.all(&parts).unzip();
        let area = area.unwrap_or_default();
        let Grower { forks, mut leaves, .. } = grower;
        let mut start = 0.0;
        for leaf in &mut leaves {
            leaf.start = start / area;
            start += leaf.length;
            leaf.length /= area;
        }
        Self { forks, leaves, top, area: rounded(area, AREA_BITS) }
    }

    /// The region's area, cm2; a soft triangle counts with its highest corner.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.forks[..]) + size_of_val(&self.leaves[..])
    }

    /// The triangles of the region, each with the hash of its number.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = (u32, u64)> {
        self.leaves.iter().map(|leaf| (leaf.triangle, leaf.name))
    }

    /// Where the `i`-th root goes in the deal of this seed; `None` without a region.
    #[inline]
    pub(crate) fn deal(&self, i: u32, seed: u64) -> Option<Dealt> {
        let (mut at, mut nth) = (self.top?, u64::from(i));
        loop {
            let fork = match at {
                Branch::Leaf(leaf) => {
                    let Leaf { triangle, name, start, length } = self.leaves[leaf as usize];
                    return Some(Dealt { triangle, name, nth, row: [start, length] });
                }
                Branch::Fork(fork) => &self.forks[fork as usize],
            };
            // So many of the first `n` go to the first half: to within one of its share, and which is by chance.
            let chance = unit(mix(seed ^ fork.name));
            let firsts = |n: u64| (n as f64 * fork.share + chance) as u64;
            let before = firsts(nth);
            (at, nth) = match firsts(nth + 1) > before {
                true => (fork.halves[0], before),
                false => (fork.halves[1], nth - before),
            };
        }
    }
}

/// Random bits as a number from 0 to 1, below 1.
#[inline]
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Rounds a positive number to this many bits after the leading one.
fn rounded(x: f64, bits: u32) -> f64 {
    let off = 52 - bits;
    f64::from_bits((x.to_bits() + (1 << (off - 1))) >> off << off)
}

/// No triangle.
const NONE: u32 = u32::MAX;

/// The triangles across the sides of each, or [`NONE`].
fn beside(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, [a, b, c]) in (0u32..).zip(triangles) {
        for (k, (a, b)) in (0u32..).zip([(a, b), (b, c), (c, a)]) {
            sides.push(([*a.min(b), *a.max(b)], 3 * t + k));
        }
    }
    sides.sort_unstable();
    let mut beside = vec![[NONE; 3]; triangles.len()];
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        // Where more than two meet, each hangs together with the next.
        for (n, (_, side)) in same.iter().enumerate() {
            let other = if n + 1 < same.len() { n + 1 } else { n.saturating_sub(1) };
            if other != n {
                beside[*side as usize / 3][*side as usize % 3] = same[other].1 / 3;
            }
        }
    }
    beside
}

/// What grows the tree.
struct Grower<'a> {
    areas: Vec<f64>,
    beside: Vec<[u32; 3]>,
    numbers: Option<&'a [u32]>,
    /// All triangles; each set of them is a stretch of it.
    order: Vec<u32>,
    /// For each triangle the mark of the walk that came to it last, or of the set that it is in.
    marks: Vec<u32>,
    mark: u32,
    forks: Vec<Fork>,
    /// With their areas for lengths.
    leaves: Vec<Leaf>,
}

impl Grower<'_> {
    /// Sorts the triangles by the parts of the mesh that hang together; returns those with a region, in the order of their
    /// first triangles.
    fn parts(&mut self) -> Vec<Range<usize>> {
        let starts = self.walk(0..self.order.len(), None);
        let ends = starts.iter().skip(1).copied().chain([self.order.len()]);
        let parts: Vec<Range<usize>> = starts.iter().zip(ends).map(|(a, b)| *a..b).collect();
        parts.iter().for_each(|part| self.order[part.clone()].sort_unstable());
        parts.into_iter().filter(|part| self.has_region(part)).collect()
    }

    fn has_region(&self, set: &Range<usize>) -> bool {
        self.order[set.clone()].iter().any(|t| self.areas[*t as usize] > 0.0)
    }

    /// Brings a set into the order in which a walk from `first` comes to its triangles, from neighbour to neighbour within
    /// the set; what does not hang together with it follows. Returns where the walk began, and began anew.
    fn walk(&mut self, set: Range<usize>, first: Option<u32>) -> Vec<usize> {
        self.mark += 2;
        let (inside, come) = (self.mark - 1, self.mark);
        let Self { order, beside, marks, .. } = self;
        order[set.clone()].iter().for_each(|t| marks[*t as usize] = inside);
        let (mut walked, mut starts) = (Vec::with_capacity(set.len()), vec![]);
        for start in first.iter().chain(&order[set.clone()]) {
            if marks[*start as usize] == come {
                continue;
            }
            starts.push(set.start + walked.len());
            marks[*start as usize] = come;
            let mut at = walked.len();
            walked.push(*start);
            while let Some(t) = walked.get(at).copied() {
                at += 1;
                for other in beside[t as usize] {
                    if other != NONE && marks[other as usize] == inside {
                        marks[other as usize] = come;
                        walked.push(other);
                    }
                }
            }
        }
        order[set].copy_from_slice(&walked);
        starts
    }

    /// The branch of some parts, with its area.
    fn all(&mut self, parts: &[Range<usize>]) -> Option<(Branch, f64)> {
        if parts.len() < 2 {
            return self.half(parts.first()?.clone());
        }
        let (some, others) = parts.split_at(parts.len() / 2);
        let name = self.name(some[0].start, others[0].start);
        let halves = [self.all(some), self.all(others)];
        self.fork(halves, name)
    }

    /// The branch of a set that hangs together, or nearly, with its area; `None` without a region.
    fn half(&mut self, set: Range<usize>) -> Option<(Branch, f64)> {
        if !self.has_region(&set) {
            return None;
        }
        if set.len() == 1 {
            let triangle = self.order[set.start];
            let (leaf, length) = (self.leaves.len() as u32, self.areas[triangle as usize]);
            let name = mix(u64::from(self.number(triangle)));
            self.leaves.push(Leaf { triangle, name, start: 0.0, length });
            return Some((Branch::Leaf(leaf), length));
        }
        if set.len() > 2 {
            // From one end of the set to the other: what a walk from anywhere comes to last is an end.
            self.walk(set.clone(), None);
            let end = self.order[set.end - 1];
            self.walk(set.clone(), Some(end));
        }
        let middle = set.start + set.len() / 2;
        let name = self.name(set.start, middle);
        let halves = [self.half(set.start..middle), self.half(middle..set.end)];
        self.fork(halves, name)
    }

    fn fork(&mut self, halves: [Option<(Branch, f64)>; 2], name: u64) -> Option<(Branch, f64)> {
        let [Some((first, a)), Some((other, b))] = halves else {
            return halves.into_iter().flatten().next();
        };
        let fork = self.forks.len() as u32;
        self.forks.push(Fork { share: a / (a + b), halves: [first, other], name });
        Some((Branch::Fork(fork), a + b))
    }

    /// The number of a triangle in its file.
    fn number(&self, triangle: u32) -> u32 {
        self.numbers.map_or(triangle, |all| all[triangle as usize])
    }

    /// The name of the fork between two sets, by where they start.
    fn name(&self, first: usize, other: usize) -> u64 {
        let [a, b] = [first, other].map(|at| u64::from(self.number(self.order[at])));
        mix(a << 32 | b)
    }
}

/// At least the region's value at the highest corner of a triangle, and at most an eighth more, so that rounding of the
/// value does not matter. At most 1.
#[inline]
pub(crate) fn highest(region: &[f32], corners: [u32; 3]) -> f32 {
    let [a, b, c] = corners.map(|v| region[v as usize]);
    let highest = a.max(b).max(c);
    if highest <= 0.0 {
        return 0.0;
    }
    const OFF: u32 = 20;
    f32::from_bits((((highest.to_bits() - 1) >> OFF) + 1) << OFF).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::ball;
    use crate::maths::hash::Dice;
    use glam::{Quat, Vec3};
    use std::collections::{BTreeMap, BTreeSet};

    /// What the first `n` of a deal are dealt: the triangles, each with how many came to it before.
    fn dealt(surface: &Surface, region: &[f32], n: u32) -> BTreeSet<(u32, u64)> {
        let tree =
            RegionTree::new(surface, &|t| highest(region, surface.triangles[t as usize]), None);
        (0..n).filter_map(|i| tree.deal(i, 7)).map(|dealt| (dealt.triangle, dealt.nth)).collect()
    }

    #[test]
    fn a_head_that_is_turned_scaled_or_shaped_elsewhere_is_dealt_the_same_roots() {
        let scalp = ball();
        let (surface, region) = (scalp.surface(), scalp.region());
        let of = |change: &dyn Fn(Vec3) -> Vec3, n: u32| {
            let points = surface.points.iter().map(|p| change(*p)).collect();
            dealt(&Surface::new(points, surface.triangles.clone()), region, n)
        };
        let about = |axis: Vec3| Quat::from_axis_angle(axis.normalize(), 29f32.to_radians());
        let n = 20_000;
        let plain = of(&|p| p, n);
        let check = |what: &str, change: &dyn Fn(Vec3) -> Vec3, most: usize| {
            let lost = plain.difference(&of(change, n)).count();
            assert!(lost <= most, "{what}: {lost} of {n} roots are lost, at most {most}");
        };
        for axis in [Vec3::X, Vec3::Y, Vec3::new(1.0, -2.0, 3.0)] {
            let turn = about(axis);
            check(&format!("turned about {axis}"), &|p| turn * p, 20);
        }
        check("scaled", &|p| p * 1.2, 20);
        // As in a file of a standing character: 160 cm up, where coordinates are exact to 1.5e-5 cm, and rounded once more.
        check("rounded", &|p| (p + Vec3::Y * 160.0) * 2.54 * (1.0 / 2.54), 20);
        // Where skin is drawn out there is more of it: as many roots fewer are elsewhere, and no others change.
        let raised = |p: Vec3| if p.z > 6.0 { p + Vec3::Y * 0.4 * (p.z - 6.0) } else { p };
        let moved = |t: &u32| surface.corners(*t).iter().any(|p| p.z > 6.0);
        let (before, after) = (&plain, of(&raised, n));
        let still = |all: &BTreeSet<(u32, u64)>| {
            all.iter().copied().filter(|(t, _)| !moved(t)).collect::<BTreeSet<_>>()
        };
        let (before, after) = (still(before), still(&after));
        let fewer = before.len().abs_diff(after.len());
        let lost = before.symmetric_difference(&after).count();
        assert!(fewer > 50 && lost <= fewer + 20, "{lost} lost or new, {fewer} fewer or more");
    }

    #[test]
    fn each_triangle_is_dealt_what_its_area_is_worth() {
        let scalp = ball();
        let (surface, region) = (scalp.surface(), scalp.region());
        let tree =
            RegionTree::new(surface, &|t| highest(region, surface.triangles[t as usize]), None);
        let worth = |t: u32| {
            0.5 * f64::from(surface.area_vector(t).length())
                * f64::from(highest(region, surface.triangles[t as usize]))
        };
        let all: f64 = (0..surface.triangles.len() as u32).map(worth).sum();
        for n in [100u32, 5_000, 200_000] {
            let mut got: BTreeMap<u32, u64> = BTreeMap::new();
            for dealt in (0..n).filter_map(|i| tree.deal(i, 3)) {
                let next = got.entry(dealt.triangle).or_default();
                // None is left out, so more roots only add some.
                assert_eq!(dealt.nth, *next, "{n}: triangle {}", dealt.triangle);
                *next += 1;
            }
            assert_eq!(got.values().sum::<u64>(), u64::from(n));
            let got = |t: u32| got.get(&t).copied().unwrap_or(0) as f64;
            for t in 0..surface.triangles.len() as u32 {
                let (got, want) = (got(t), worth(t) / all * f64::from(n));
                let off = (got - want).abs();
                assert!(
                    off < 3.0 + 0.15 * want && (want > 0.0 || got == 0.0),
                    "{n}, {t}: {got} for {want}"
                );
            }
            // Of the ball's bands from top to bottom, each of hundreds of triangles.
            let mut bands = [(0.0, 0.0); 6];
            for t in 0..surface.triangles.len() as u32 {
                let height = surface.corners(t)[0].y / 8.9;
                let band = &mut bands[(height * 6.0).clamp(0.0, 5.0) as usize];
                *band = (band.0 + got(t), band.1 + worth(t) / all * f64::from(n));
            }
            for (got, want) in bands {
                assert!((got - want).abs() < 6.0 + 0.02 * want, "{n}: {got} for {want}");
            }
        }
    }

    #[test]
    fn any_triangles_whatever_are_dealt_to() {
        let dice = Dice::new(3, 0, "loose");
        let at = |i: u32| Vec3::from([0, 1, 2].map(|k| dice.unit(u64::from(i), k)));
        let apart = |i: u32| [3 * i, 3 * i + 1, 3 * i + 2];
        let strip = |i: u32| [i, i + 1, i + 2];
        let fan = |i: u32| [0, i + 1, i + 2];
        let pages = |i: u32| [0, 1, i + 2];
        let same = |_: u32| [0, 1, 2];
        for (what, corners) in [
            ("apart", &apart as &dyn Fn(u32) -> [u32; 3]),
            ("a strip", &strip),
            ("a fan", &fan),
            ("pages of a book", &pages),
            ("one on the other", &same),
        ] {
            let triangles: Vec<[u32; 3]> = (0..1000).map(corners).collect();
            let most = triangles.iter().flatten().max().unwrap();
            let surface = Surface::new((0..=*most).map(at).collect(), triangles);
            let tree = RegionTree::new(&surface, &|_| 1.0, None);
            let got: BTreeSet<u32> =
                (0..200_000).filter_map(|i| tree.deal(i, 1)).map(|dealt| dealt.triangle).collect();
            assert!(got.len() > 950, "{what}: {} of 1000", got.len());
        }
        let none = RegionTree::new(&Surface::new(vec![], vec![]), &|_| 1.0, None);
        assert_eq!((none.deal(0, 1), none.area()), (None, 0.0));
    }
}
