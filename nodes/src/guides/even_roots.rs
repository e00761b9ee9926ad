//! Evenly distributed roots on the scalp region: an infinite list of which every prefix is even.
//!
//! The list is dealt out among the triangles ([`crate::data::spread`]), and what a triangle is dealt is spread in it by
//! bisection: a number from 0 to 1 is a point of it, and equal lengths have equal area. The numbers are van der Corput's
//! sequence with scrambled digits (Owen 1995), of which every prefix is evenly spread. In soft parts of the region, a point
//! is kept with the region's value as its probability.
//!
//! Guarantees: the list depends only on scalp and seed; the same number of points per cm2 wherever the region is 1; the
//! n-th point of a triangle, its id and its weights depend on the triangle's number, n and the seed alone, so what a head
//! has in common with one that was turned, scaled or shaped differently is rooted alike on both.

use crate::data::scalp::{Root, Scalp};
use crate::data::spread::{Dealt, RegionTree, unit};
use crate::maths::hash::{Dice, curve_id, mix};
use glam::{Vec2, Vec3};

/// The list.
pub(crate) struct EvenRoots<'a> {
    scalp: &'a Scalp,
    dice: Dice,
    seed: u64,
    spread: &'a RegionTree,
}

/// An entry of the list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EvenRoot {
    /// What it is called on the skin, by its triangle and its number there: for ids, and for all that is drawn by lot about it.
    pub(crate) name: u64,
    pub(crate) triangle: u32,
    pub(crate) bary: Vec2,
}

/// Seed tag that stands for "a place on the skin".
const ON_SKIN: u64 = 0x736B_696E;

/// Bisections inside a triangle: a point is then exact to a few thousandths of its edge.
const HALVINGS: u32 = 18;

impl<'a> EvenRoots<'a> {
    pub(crate) fn new(scalp: &'a Scalp, dice: Dice) -> Self {
        Self { scalp, dice, seed: dice.bits(0, 0), spread: scalp.spread() }
    }

    /// Number of list entries needed for one point per cm2, in cm2: the region's area, with a soft triangle counted by
    /// its highest corner.
    pub(crate) fn area(&self) -> f64 {
        self.spread.area()
    }

    /// The region's area, cm2: [`Self::area`], except for a drawn region, whose area is known better.
    pub(crate) fn region_area(&self) -> f64 {
        self.scalp.exact_area().map_or(self.area(), f64::from)
    }
    /// Number of list entries per point in the region, if it was drawn over large triangles; otherwise 1.
    pub(crate) fn places_for_one(&self) -> u32 {
        let ratio = (self.area() / self.region_area()).ceil();
        if ratio.is_finite() { ratio.clamp(1.0, 10_000.0) as u32 } else { 1 }
    }

    /// Position of the `i`-th entry in a row of all triangles, in 2^-32 of it. Entries close in the row are close on the scalp.
    #[inline]
    pub(crate) fn along(&self, i: u32) -> u32 {
        let Some(dealt) = self.spread.deal(i, self.seed) else { return 0 };
        let [start, length] = dealt.row;
        let within = f64::from(self.fraction(&dealt)) * (1.0 / 4_294_967_296.0);
        ((start + length * within) * 4_294_967_296.0) as u32
    }

    /// Where in its triangle an entry lies, in 2^-32.
    #[inline]
    fn fraction(&self, dealt: &Dealt) -> u32 {
        scrambled(dealt.nth as u32, self.seed ^ dealt.name)
    }

    /// The `i`-th entry; `None` if the soft edge of the region drops it, or without a region.
    pub(crate) fn get(&self, i: u32) -> Option<EvenRoot> {
        self.at(&self.spread.deal(i, self.seed)?)
    }
    fn at(&self, dealt: &Dealt) -> Option<EvenRoot> {
        let bary = within(self.fraction(dealt) >> (32 - HALVINGS));
        let (triangle, name) = (dealt.triangle, curve_id(dealt.name, ON_SKIN, dealt.nth));
        let share = self.scalp.grows(triangle, bary) / self.scalp.highest(triangle);
        let kept = share >= 1.0 || self.dice.unit(1, name) < share;
        kept.then_some(EvenRoot { name, triangle, bary })
    }

    /// Places that come by chance, between `from` and `to` of them for each cm2: in a triangle as many as its area is worth,
    /// one after the other. Each has its room, the cm2 for each of those that are there with it, and they come in the order of
    /// these. Unlike the list, what one triangle has hangs from no other, so few changes of a mesh change few of them.
    pub(crate) fn by_chance(&self, from: f64, to: f64) -> Vec<(f32, EvenRoot)> {
        let surface = self.scalp.surface();
        let mut all = vec![];
        for (triangle, name) in self.spread.triangles() {
            let area = 0.5 * surface.area_vector(triangle).length() * self.scalp.highest(triangle);
            let (from, to) = (from * f64::from(area), to * f64::from(area));
            for nth in from as u64..=to as u64 {
                let come = nth as f64 + unit(self.dice.bits(name, nth));
                if from < come && come <= to {
                    let dealt = Dealt { triangle, name, nth, row: [0.0; 2] };
                    let room = (f64::from(area) / come) as f32;
                    all.extend(self.at(&dealt).map(|root| (room, root)));
                }
            }
        }
        all.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.name.cmp(&b.1.name)));
        all
    }

    /// [`Self::get`] bound to the scalp, with its name; `None` on the bare skin of a parting.
    pub(crate) fn root(&self, i: u32) -> Option<(u64, Root)> {
        let EvenRoot { name, triangle, bary } = self.get(i)?;
        let root = self.scalp.root(triangle, bary);
        self.scalp.is_free(&root).then_some((name, root))
    }
}

/// Van der Corput's sequence in base 2 as a 32-bit fraction, each digit scrambled depending on the digits before it
/// (the hash of Laine and Karras 2011).
fn scrambled(i: u32, seed: u64) -> u32 {
    let mut x = i;
    let seed = mix(seed);
    x = x.wrapping_add(seed as u32);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x ^= ((seed >> 32) as u32) & !1;
    x.reverse_bits()
}

/// A point in a triangle by bisection: nearby fractions (in 2^-[`HALVINGS`]) give nearby points.
fn within(fraction: u32) -> Vec2 {
    // Half of the bisections select a small triangle, the other half continue from there. Corners are sums of few
    // powers of two without rounding, so that the result equals bisecting step by step.
    let [from, apex, to] = CORNERS[(fraction >> HALF & (PARTS - 1)) as usize].map(Vec2::from_array);
    let [a, b, c] = CORNERS[(fraction & (PARTS - 1)) as usize].map(Vec2::from_array);
    let sum = a + b + c;
    (from * 3.0 + (apex - from) * sum.x + (to - from) * sum.y) / 3.0
}

/// Half of the bisections, and the number of parts they make.
const HALF: u32 = HALVINGS / 2;
const PARTS: u32 = 1 << HALF;

/// The corners of the parts (from, apex and to), each as weights of the whole triangle's apex and to.
static CORNERS: [[[f32; 2]; 3]; PARTS as usize] = {
    let mut corners = [[[0.0; 2]; 3]; PARTS as usize];
    let mut part = 0;
    while part < PARTS {
        let (mut from, mut apex, mut to) = ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]);
        let mut halving = HALF;
        while halving > 0 {
            halving -= 1;
            let middle = [(from[0] + to[0]) * 0.5, (from[1] + to[1]) * 0.5];
            if part >> halving & 1 == 0 {
                to = apex;
            } else {
                from = apex;
            }
            apex = middle;
        }
        corners[part as usize] = [from, apex, to];
        part += 1;
    }
    corners
};

/// Places with a minimum distance: those too close to an earlier one are dropped. The distance shrinks with the room of each,
/// so every prefix is even and a higher count only adds. It depends on the place alone, so that taking one affects only its
/// neighbourhood.
pub(crate) struct Apart {
    taken: Vec<Vec3>,
    area: f32,
    least: f32,
    /// Size of the cells, and indices of the places in each, rebuilt as the distance shrinks.
    cell: f32,
    cells: std::collections::BTreeMap<[i32; 3], Vec<u32>>,
    refused: u32,
}

/// A place stays this many times the root of its room away from earlier ones. About one in eleven is then taken, and these
/// are 0.66 to 1.0 times `sqrt(area / taken)` from the next. (A larger factor needs more places and is hardly more even.)
const SPREAD: f32 = 2.2;
/// Consecutive rejections at the smallest distance before giving up.
const PATIENCE: u32 = 960;

impl Apart {
    /// For a region of this area in cm2; never closer than `least` cm.
    pub(crate) fn new(area: f32, least: f32) -> Self {
        Self { taken: vec![], area, least, cell: f32::MAX, cells: Default::default(), refused: 0 }
    }
    /// Whether nothing more can be taken, since even the smallest distance is rejected repeatedly.
    pub(crate) fn full(&self) -> bool {
        self.refused > PATIENCE
    }
    /// Takes a place with this room (cm2) unless an earlier one is too close. Places must come in the order of their rooms.
    pub(crate) fn take(&mut self, room: f32, p: Vec3) -> bool {
        let even = SPREAD * room.min(self.area).sqrt();
        let apart = even.max(self.least);
        // Cells about as wide as the search radius.
        let wide = apart.max(1e-3);
        if wide < 0.5 * self.cell {
            self.cell = wide;
            self.cells.clear();
            for (i, p) in (0..).zip(&self.taken) {
                self.cells.entry(cell_of(*p, self.cell)).or_default().push(i);
            }
        }
        if self.too_near(p, apart) {
            self.refused += u32::from(even < self.least);
            return false;
        }
        self.refused = 0;
        let at = cell_of(p, self.cell);
        self.cells.entry(at).or_default().push(self.taken.len() as u32);
        self.taken.push(p);
        true
    }
    fn too_near(&self, p: Vec3, apart: f32) -> bool {
        let near = |i: &u32| self.taken[*i as usize].distance_squared(p) < apart * apart;
        let (lo, hi) = (cell_of(p - apart, self.cell), cell_of(p + apart, self.cell));
        (lo[0]..=hi[0]).any(|x| {
            (lo[1]..=hi[1]).any(|y| {
                (lo[2]..=hi[2])
                    .any(|z| self.cells.get(&[x, y, z]).is_some_and(|all| all.iter().any(near)))
            })
        })
    }
}

fn cell_of(p: Vec3, cell: f32) -> [i32; 3] {
    (p / cell).floor().as_ivec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::ball;

    #[test]
    fn a_place_in_a_triangle_is_found_by_halving_it() {
        let one_by_one = |fraction: u32| {
            let (mut from, mut apex, mut to) = (Vec2::ZERO, Vec2::X, Vec2::Y);
            for halving in (0..HALVINGS).rev() {
                let middle = (from + to) * 0.5;
                (from, to) = if fraction >> halving & 1 == 0 { (from, apex) } else { (apex, to) };
                apex = middle;
            }
            (from + apex + to) / 3.0
        };
        for fraction in 0..1 << HALVINGS {
            assert_eq!(within(fraction), one_by_one(fraction), "{fraction}");
        }
        // The last of a triangle's curve, which rounding may ask for, is its start.
        assert_eq!(within(1 << HALVINGS), within(0));
    }

    #[test]
    fn every_start_of_the_list_is_spread_by_area() {
        let scalp = ball();
        let roots = EvenRoots::new(&scalp, Dice::new(1, 2, "roots"));
        for n in [500u32, 5_000, 50_000] {
            let all: Vec<Root> = (0..n).filter_map(|i| roots.root(i)).map(|r| r.1).collect();
            assert!(all.len() as f32 > 0.95 * n as f32, "{n}: {}", all.len());
            // Twelve equal slices in height times six in azimuth of the upper half ball (its border row is soft).
            let mut counts = [[0u32; 6]; 8];
            for root in &all {
                let high = (root.point.y / 8.9 * 8.0) as usize;
                let turn = crate::maths::transcendental::atan2(root.point.z, root.point.x);
                let slice = ((turn / std::f32::consts::TAU + 0.5) * 6.0) as usize;
                counts[high.min(7)][slice.min(5)] += 1;
            }
            let want = counts[1..].iter().flatten().sum::<u32>() as f32 / 42.0;
            for count in counts[1..].iter().flatten() {
                let off = (*count as f32 - want).abs();
                assert!(off < 0.06 * want + 2.5 * want.sqrt().sqrt() + 1.0, "{n}: {counts:?}");
            }
        }
    }

    #[test]
    fn discs_anywhere_hold_a_quarter_of_the_variance_that_chance_has() {
        let scalp = ball();
        let (roots, discs) = (
            EvenRoots::new(&scalp, Dice::new(1, 2, "roots")),
            EvenRoots::new(&scalp, Dice::new(77, 2, "discs")),
        );
        for n in [500u32, 3000, 20_000] {
            // Discs of 20 roots, away from the border; chance has a variance of 20.
            let reach = (20.0 * roots.area() as f32 / n as f32 / std::f32::consts::PI).sqrt();
            let all: Vec<Vec3> = (0..n).filter_map(|i| roots.root(i)).map(|r| r.1.point).collect();
            let inner = (0..700)
                .filter_map(|i| discs.root(i))
                .map(|r| r.1)
                .filter(|at| at.point.y > 1.0 + reach);
            let count = |at: Root| {
                all.iter().filter(|p| p.distance_squared(at.point) < reach * reach).count() as f32
            };
            let counts: Vec<f32> = inner.map(count).collect();
            let mean = counts.iter().sum::<f32>() / counts.len() as f32;
            let variance =
                counts.iter().map(|c| (c - mean) * (c - mean)).sum::<f32>() / counts.len() as f32;
            assert!((mean - 20.0).abs() < 0.6 && variance < 0.3 * mean, "{n}: {mean}, {variance}");
        }
    }

    #[test]
    fn places_apart_are_apart_and_fill_the_region() {
        let scalp = ball();
        let roots = EvenRoots::new(&scalp, Dice::new(1, 2, "roots"));
        for n in [40usize, 300, 3000] {
            let mut apart = Apart::new(roots.area() as f32, 0.0);
            let mut tried = 0;
            for (room, root) in roots.by_chance(0.0, 20.0 * n as f64 / roots.area()) {
                if apart.taken.len() < n {
                    tried += 1;
                    apart.take(room, scalp.root(root.triangle, root.bary).point);
                }
            }
            assert_eq!(apart.taken.len(), n, "of {tried}");
            let even = (roots.area() as f32 / n as f32).sqrt();
            let nearest = apart
                .taken
                .iter()
                .enumerate()
                .map(|(i, p)| {
                    let others = apart.taken.iter().enumerate().filter(|(j, _)| *j != i);
                    others.map(|(_, q)| p.distance(*q)).fold(f32::MAX, f32::min)
                })
                .fold(f32::MAX, f32::min);
            assert!(nearest > 0.6 * even, "{n}: {nearest} of {even}, {tried} tried");
            assert!(tried < 16 * n, "{n}: {tried} tried");
        }
    }
}
