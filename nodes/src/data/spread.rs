//! The region unrolled into a line: equal lengths have equal area, and neighbours on the line are neighbours on the
//! scalp.
//!
//! Triangles are halved repeatedly where the gap between their centres is widest, and each half gets a part of the line
//! in proportion to its area. Gaps and parts are chosen robustly against rounding: a head written by another program
//! with different last digits, or with its triangles in another order, has the same line; where single triangles are
//! split differently, the line changes only there.
//!
//! Guarantees: the line depends only on the mesh and the region; every triangle with a nonzero region and area is on it
//! once, with a length proportional to its area to a few percent, and for large sets to less than a few per thousand.
//! Not promised: that neighbours on the scalp are neighbours on the line.

use crate::maths::closest::Surface;
use glam::Vec3;

/// The line.
pub(crate) struct TriangleLine {
    /// Triangles of the region in order along the line, and the end of each, 0 to 1.
    triangles: Vec<u32>,
    ends: Vec<f64>,
    /// For each of `2^bits` equal pieces of the line, the index of the first triangle that it may touch, and their
    /// number at the end: a position is looked up among the few of its piece.
    pieces: Vec<u32>,
    bits: u32,
    area: f64,
}

/// Bits kept of the smaller area's fraction when two triangles are split. Larger sets, whose rounding averages out,
/// keep more: half a bit more for each doubling of their number.
const SHARE_BITS: u32 = 4;
/// Bits kept of the total area, for counts derived from it.
const AREA_BITS: u32 = 16;
/// Gaps narrower than this, as a fraction of the largest coordinate, may be rounding.
const ROUNDING: f32 = 1.0 / 32_768.0;
/// Of two similar gaps, the first is taken unless it is less than this fraction of the second.
const NEARLY: f32 = 0.7;

/// Half of the triangles means half, plus or minus up to one in this many.
const NEAR: usize = 8;

/// A triangle to be laid out: centre, index, area in 2^-50 of the whole.
struct Item {
    at: Vec3,
    triangle: u32,
    area: u64,
}

impl TriangleLine {
    /// The line of a region with these upper bounds, one per triangle.
    pub(crate) fn new(surface: &Surface, highest: &dyn Fn(u32) -> f32) -> Self {
        let area = |t: u32| {
            let highest = highest(t);
            if highest <= 0.0 { 0.0 } else { 0.5 * surface.area_vector(t).length() * highest }
        };
        let areas = (0..surface.triangles.len() as u32).map(|t| (t, f64::from(area(t))));
        let areas: Vec<(u32, f64)> = areas.filter(|(_, a)| a.is_finite() && *a > 0.0).collect();
        let area: f64 = areas.iter().map(|(_, area)| area).sum();
        let item = |(triangle, part): (u32, f64)| {
            let [a, b, c] = surface.corners(triangle);
            // Integers add up to the same in any order.
            let area = ((part / area * (1u64 << 50) as f64) as u64).max(1);
            Item { at: (a + b + c) / 3.0, triangle, area }
        };
        let mut items: Vec<Item> = areas.into_iter().map(item).collect();
        let (low, high) = surface.bounds();
        let mut layer = Layer {
            rounding: ROUNDING * low.abs().max(high.abs()).max_element(),
            last: low,
            triangles: Vec::with_capacity(items.len()),
            ends: Vec::with_capacity(items.len()),
        };
        if !items.is_empty() {
            layer.lay(&mut items, 0.0, 1.0);
        }
        let Layer { triangles, ends, .. } = layer;
        let bits = (ends.len().max(2) as u32).ilog2().min(20);
        let area = rounded(area, AREA_BITS);
        let mut spread = Self { triangles, ends, pieces: vec![], bits, area };
        let mut slot = 0;
        for piece in 0..1u32 << bits {
            let at = unit(piece << (32 - bits));
            while spread.ends.get(slot).is_some_and(|end| *end <= at) {
                slot += 1;
            }
            spread.pieces.push(slot as u32);
        }
        spread.pieces.push(spread.ends.len() as u32);
        spread
    }

    /// The region's area, cm2; a soft triangle counts with its highest corner.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.triangles.len() + 2 * self.ends.len() + self.pieces.len())
    }

    /// The triangle at a position of the line, in 2^-32 of it, and the fraction of the triangle passed there, 0 to 1;
    /// `None` without a region.
    #[inline]
    pub(crate) fn place(&self, along: u32) -> Option<(u32, f64)> {
        let at = unit(along);
        let piece = (along >> (32 - self.bits)) as usize;
        let (from, to) = (self.pieces[piece] as usize, self.pieces[piece + 1] as usize);
        let slot = from + self.ends[from..to].partition_point(|end| *end <= at);
        let triangle = *self.triangles.get(slot)?;
        let before = if slot > 0 { self.ends[slot - 1] } else { 0.0 };
        Some((triangle, (at - before) / (self.ends[slot] - before)))
    }
}

/// 2^-32 of the line as a number from 0 to 1.
#[inline]
fn unit(along: u32) -> f64 {
    f64::from(along) * (1.0 / 4_294_967_296.0)
}

/// Rounds a positive number to this many bits after the leading one.
fn rounded(x: f64, bits: u32) -> f64 {
    let off = 52 - bits;
    f64::from_bits((x.to_bits() + (1 << (off - 1))) >> off << off)
}

/// Lays triangles out on the line.
struct Layer {
    rounding: f32,
    /// The centre of the last triangle laid out.
    last: Vec3,
    triangles: Vec<u32>,
    ends: Vec<f64>,
}

impl Layer {
    /// Lays these out on the line from `start` to `end`.
    fn lay(&mut self, items: &mut [Item], start: f64, end: f64) {
        if let [item] = items {
            self.triangles.push(item.triangle);
            self.ends.push(end);
            self.last = item.at;
            return;
        }
        let bits = SHARE_BITS + items.len().ilog2() / 2;
        let (one, other) = self.halves(items);
        // The half closer to the last triangle comes first.
        let far = |half: &[Item]| {
            let (low, high) = bounds(half);
            self.last.distance_squared(0.5 * low + 0.5 * high)
        };
        let turned = far(other) < NEARLY * far(one);
        let (first, second) = if turned { (other, one) } else { (one, other) };
        let area = |half: &[Item]| half.iter().map(|item| item.area).sum::<u64>();
        let (a, b) = (area(first), area(second));
        let small = rounded(a.min(b) as f64 / (a + b) as f64, bits) * (end - start);
        let middle = if a < b { start + small } else { end - small };
        self.lay(first, start, middle);
        self.lay(second, middle, end);
    }

    /// Splits two or more into halves, at the widest gap between centres along the longest side, near the median.
    fn halves<'a>(&self, items: &'a mut [Item]) -> (&'a mut [Item], &'a mut [Item]) {
        let (low, high) = bounds(items);
        let size = high - low;
        let axis =
            (1..3).fold(0, |best, axis| if NEARLY * size[axis] > size[best] { axis } else { best });
        let count = items.len();
        let order = |a: &Item, b: &Item| a.at[axis].total_cmp(&b.at[axis]);
        let gaps = |items: &mut [Item], from: usize, to: usize| -> Option<usize> {
            // Those before and after each gap from `from` to `to`, in order.
            if from > 1 {
                items.select_nth_unstable_by(from - 1, order);
            }
            if to + 1 < count {
                items[from - 1..].select_nth_unstable_by(to - (from - 1), order);
            }
            items[from - 1..=to].sort_unstable_by(order);
            let gap = |k: usize| items[k].at[axis] - items[k - 1].at[axis];
            let worth = |k: usize| gap(k) * k.min(count - k) as f32;
            let wide = || (from..=to).filter(|k| gap(*k) > self.rounding);
            let best = wide().map(worth).fold(0.0, f32::max);
            wide().find(|k| worth(*k) >= NEARLY * best)
        };
        let near = (count / NEAR).max(1);
        let (from, to) = ((count / 2 - near).max(1), (count / 2 + near).min(count - 1));
        let at = gaps(items, from, to).or_else(|| gaps(items, 1, count - 1));
        let at = at.unwrap_or_else(|| {
            // All at one position.
            items.sort_unstable_by_key(|item| item.triangle);
            count / 2
        });
        items.split_at_mut(at)
    }
}

/// Bounding box of the centres.
fn bounds(items: &[Item]) -> (Vec3, Vec3) {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    items.iter().fold(none, |(low, high), item| (low.min(item.at), high.max(item.at)))
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

    /// Positions of 20,000 evenly spaced points of the line.
    fn places(spread: &TriangleLine, surface: &Surface) -> Vec<Vec3> {
        let step = u32::MAX / 20_000;
        let at = |i: u32| {
            let (triangle, far) = spread.place(i * step).expect("there is a region");
            // Somewhere in the triangle, depending on the fraction.
            surface.at(triangle, glam::Vec2::new(0.5 * far as f32, 0.25))
        };
        (0..20_000).map(at).collect()
    }

    #[test]
    fn a_head_rounded_elsewhere_and_in_another_order_has_the_same_line() {
        let scalp = ball();
        let (surface, region) = (scalp.surface(), scalp.region());
        // As in a file of a standing character: 160 cm up, where coordinates are exact to 1.5e-5 cm, and rounded once
        // more.
        let up = |p: &Vec3, round: f32| (*p + Vec3::Y * 160.0) * round * (1.0 / round);
        let points = |round: f32| surface.points.iter().map(|p| up(p, round)).collect::<Vec<_>>();
        let of = |points: Vec<Vec3>, triangles: Vec<[u32; 3]>| {
            let surface = Surface::new(points, triangles);
            let most = |t: u32| highest(region, surface.triangles[t as usize]);
            (places(&TriangleLine::new(&surface, &most), &surface), surface.points)
        };
        let (as_is, was) = of(points(1.0), surface.triangles.clone());
        let mut turned = surface.triangles.clone();
        turned.reverse();
        for (round, triangles) in
            [(1.0, turned), (0.01, surface.triangles.clone()), (2.54, surface.triangles.clone())]
        {
            let (places, points) = of(points(round), triangles);
            let off = points.iter().zip(&was).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            let moved = places.iter().zip(&as_is).filter(|(a, b)| a.distance(**b) > 1e-4).count();
            assert!(off < 1e-4 && moved <= 120, "{round}: {off} cm, {moved} of 20,000 moved");
        }
    }

    #[test]
    fn each_triangle_has_the_line_that_its_area_is_worth() {
        let scalp = ball();
        let (surface, region) = (scalp.surface(), scalp.region());
        let spread =
            TriangleLine::new(surface, &|t| highest(region, surface.triangles[t as usize]));
        let worth = |t: u32| {
            0.5 * f64::from(surface.area_vector(t).length())
                * f64::from(highest(region, surface.triangles[t as usize]))
        };
        let (mut before, mut seen) = (0.0, std::collections::BTreeSet::new());
        let (mut line, mut area, mut worst) = (0.0, 0.0, 0.0f64);
        for (k, (triangle, end)) in spread.triangles.iter().zip(&spread.ends).enumerate() {
            assert!(seen.insert(*triangle), "{triangle} twice");
            let off = (end - before) * spread.area() / worth(*triangle) - 1.0;
            assert!(off.abs() < 0.12, "{triangle}: {off}");
            (line, area) = (line + end - before, area + worth(*triangle));
            if k % 200 == 199 {
                worst = worst.max((line * spread.area() / area - 1.0).abs());
                (line, area) = (0.0, 0.0);
            }
            before = *end;
        }
        assert!(worst < 0.01, "of 200 triangles: {worst}");
        assert_eq!(before, 1.0);
        let all = (0..surface.triangles.len() as u32).filter(|t| worth(*t) > 0.0).count();
        assert_eq!(seen.len(), all);
    }

    #[test]
    fn triangles_in_one_place_or_like_steps_are_laid_without_end() {
        let dice = Dice::new(3, 0, "steps");
        // A thousand at one position; each half as far as the previous one; one far from a dense cluster.
        let spot = |_: u32| Vec3::ONE;
        let steps = |i: u32| Vec3::X * f32::from_bits((127 - i % 120) << 23);
        let lone = |i: u32| {
            if i == 0 {
                Vec3::X * 1e6
            } else {
                Vec3::from([0, 1, 2].map(|k| dice.unit(u64::from(i), k)))
            }
        };
        for at in [&spot as &dyn Fn(u32) -> Vec3, &steps, &lone] {
            let corners = |i: u32| [at(i), at(i) + 0.1 * Vec3::Y, at(i) + 0.1 * Vec3::Z];
            let points: Vec<Vec3> = (0..1000).flat_map(corners).collect();
            let triangles = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let spread = TriangleLine::new(&Surface::new(points, triangles), &|_| 1.0);
            assert!(spread.triangles.len() > 900, "{}", spread.triangles.len());
            assert!(spread.ends.is_sorted());
        }
    }
}
