//! The scalp region as a line: equal lengths of it have equal area, and what is near on it is near on the scalp.
//!
//! Triangles follow each other in [`Surface::order`], which knows no coordinates, and have whole numbers of shares of the line.
//!
//! Guarantees: a stretch of a hundredth of the region has as many shares for its area as any other, to half a percent, and triangles
//! within it to one share. A mesh whose coordinates are rounded elsewhere has the same line but for single shares, for what
//! is rounded in one triangle is not carried along.

use crate::maths::closest::Surface;
use crate::maths::hash::Dice;

/// The line.
pub(crate) struct Spread {
    /// Triangles with any region, in their order along the line, and the shares of the line up to and with each.
    triangles: Vec<u32>,
    ends: Vec<u32>,
    /// For each of `2^bits` equal pieces of the line the number of the first triangle that it may touch, and all of them at the end:
    /// a place is looked for among the few of its piece.
    pieces: Vec<u32>,
    bits: u32,
    area: f64,
}

/// A stretch of the line has at least so many steps, of which all stretches have [`STEPS`] or a few more or less. Within a stretch
/// triangles share what it has, to one of [`SHARES`] of a step.
const STRETCH: f64 = 128.0;
const STEPS: f64 = 16384.0;
const SHARES: u32 = 8;

impl Spread {
    /// Of the region with these values, one a vertex.
    pub(crate) fn new(surface: &Surface, region: &[f32]) -> Self {
        let counts = |t: u32| {
            let high = highest(region, surface.triangles[t as usize]);
            if high <= 0.0 { 0.0 } else { 0.5 * surface.area_vector(t).length() * high }
        };
        let counts: Vec<f32> = (0..surface.triangles.len() as u32).map(counts).collect();
        let order = surface.order().iter().map(|t| (*t, f64::from(counts[*t as usize])));
        let order: Vec<(u32, f64)> = order.filter(|(_, c)| c.is_finite() && *c > 0.0).collect();
        let area: f64 = order.iter().map(|(_, area)| area).sum();
        let (step, dice) = (area / STEPS, Dice::new(0, 0, "spread"));
        let mut ends = Vec::with_capacity(order.len());
        let (mut sums, mut sum, mut start) = (vec![], 0.0, 0);
        for (k, (triangle, area)) in order.iter().enumerate() {
            sum += area;
            sums.push(sum);
            if sum >= STRETCH * step || k + 1 == order.len() {
                // Up or down by chance, so that all together are right.
                let steps = (sum / step + f64::from(dice.unit(u64::from(*triangle), 0))) as u32;
                let shares = f64::from(steps * SHARES) / sum;
                ends.extend(sums.drain(..).map(|sum| start + (sum * shares + 0.5) as u32));
                start += steps * SHARES;
                sum = 0.0;
            }
        }
        let triangles = order.into_iter().map(|(triangle, _)| triangle).collect();
        let bits = (ends.len().max(2) as u32).ilog2().min(20);
        let mut spread = Self { triangles, ends, pieces: vec![], bits, area };
        let mut slot = 0;
        for piece in 0..1u32 << bits {
            let (at, _) = spread.share(piece << (32 - bits));
            while spread.ends.get(slot).is_some_and(|end| *end <= at) {
                slot += 1;
            }
            spread.pieces.push(slot as u32);
        }
        spread.pieces.push(spread.ends.len() as u32);
        spread
    }

    /// The region's area, cm2, a soft triangle counted with its highest corner.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.triangles.len() + self.ends.len() + self.pieces.len())
    }

    /// The triangle at a place of the line, in 2^-32 of it, and how far through that the place is, 0 to 1; none without any region.
    #[inline]
    pub(crate) fn place(&self, along: u32) -> Option<(u32, f64)> {
        let (share, rest) = self.share(along);
        let piece = (along >> (32 - self.bits)) as usize;
        let (from, to) = (self.pieces[piece] as usize, self.pieces[piece + 1] as usize);
        let slot = from + self.ends[from..to].partition_point(|end| *end <= share);
        let triangle = *self.triangles.get(slot)?;
        let before = if slot > 0 { self.ends[slot - 1] } else { 0 };
        let far = f64::from(share - before) + f64::from(rest) * (1.0 / 4_294_967_296.0);
        Some((triangle, far / f64::from(self.ends[slot] - before)))
    }

    /// In which share a place of the line lies, and how far in it, in 2^-32.
    #[inline]
    fn share(&self, along: u32) -> (u32, u32) {
        let all = self.ends.last().copied().unwrap_or(0);
        let at = u64::from(along) * u64::from(all);
        ((at >> 32) as u32, at as u32)
    }
}

/// The region's value at the highest corner of a triangle, at most 1.
#[inline]
pub(crate) fn highest(region: &[f32], corners: [u32; 3]) -> f32 {
    let [a, b, c] = corners.map(|v| region[v as usize]);
    a.max(b).max(c).min(1.0)
}
