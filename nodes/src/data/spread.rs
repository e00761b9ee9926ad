//! The scalp region as a line: equal lengths of it have equal area, and what is near on it is near on the scalp.
//!
//! Guarantees: the line depends on the mesh and the region alone; every triangle with any region and any area is on it once.
//! Not promised: the same line for a mesh whose coordinates are rounded in another way.

use crate::maths::closest::Surface;

/// The line: triangles in the order in which a Hilbert curve visits them.
pub(crate) struct Spread {
    /// Triangles with any region along the line, and the sum of area times highest region up to and with each.
    triangles: Vec<u32>,
    sums: Vec<f64>,
    /// For each of `2^bits` equal pieces of the line the number of the first triangle that it may touch, and all of them at the end:
    /// a place is looked for among the few of its piece.
    pieces: Vec<u32>,
    bits: u32,
}

impl Spread {
    /// Of the region with these values, one a vertex.
    pub(crate) fn new(surface: &Surface, region: &[f32]) -> Self {
        let highest = |t: u32| highest(region, surface.triangles[t as usize]);
        let (lo, hi) = surface.bounds();
        let scale = 1023.0 / (hi - lo).max_element().max(1e-6);
        let mut order: Vec<u64> = (0..surface.triangles.len() as u32)
            .filter(|t| highest(*t) > 0.0)
            .map(|t| {
                let [a, b, c] = surface.corners(t);
                let cell = ((a + b + c) / 3.0 - lo) * scale;
                let along = hilbert([cell.x as u32, cell.y as u32, cell.z as u32]);
                u64::from(along) << 32 | u64::from(t)
            })
            .collect();
        order.sort_unstable();
        let mut sum = 0.0;
        let mut triangles = Vec::with_capacity(order.len());
        let mut sums = Vec::with_capacity(order.len());
        for t in order.into_iter().map(|one| one as u32) {
            let area = 0.5 * f64::from(surface.area_vector(t).length());
            if area.is_finite() && area > 0.0 {
                sum += area * f64::from(highest(t));
                triangles.push(t);
                sums.push(sum);
            }
        }
        let bits = (sums.len().max(2) as u32).ilog2().min(20);
        let mut spread = Self { triangles, sums, pieces: vec![], bits };
        let mut slot = 0;
        for piece in 0..1u32 << bits {
            let at = spread.sum_at(piece << (32 - bits));
            while spread.sums.get(slot).is_some_and(|sum| *sum <= at) {
                slot += 1;
            }
            spread.pieces.push(slot as u32);
        }
        spread.pieces.push(spread.sums.len() as u32);
        spread
    }

    /// The region's area, cm2, a soft triangle counted with its highest corner.
    pub(crate) fn area(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.triangles.len() + 2 * self.sums.len() + self.pieces.len())
    }

    /// The triangle at a place of the line, in 2^-32 of it, and how far through that the place is, 0 to 1; none without any region.
    #[inline]
    pub(crate) fn place(&self, along: u32) -> Option<(u32, f64)> {
        let at = self.sum_at(along);
        let piece = (along >> (32 - self.bits)) as usize;
        let (from, to) = (self.pieces[piece] as usize, self.pieces[piece + 1] as usize);
        let slot = from + self.sums[from..to].partition_point(|sum| *sum <= at);
        let triangle = *self.triangles.get(slot)?;
        let before = if slot > 0 { self.sums[slot - 1] } else { 0.0 };
        Some((triangle, (at - before) / (self.sums[slot] - before)))
    }

    /// The sum of areas up to a place of the line.
    #[inline]
    fn sum_at(&self, along: u32) -> f64 {
        f64::from(along) * (1.0 / 4_294_967_296.0) * self.area()
    }
}

/// The region's value at the highest corner of a triangle, at most 1.
#[inline]
pub(crate) fn highest(region: &[f32], corners: [u32; 3]) -> f32 {
    let [a, b, c] = corners.map(|v| region[v as usize]);
    a.max(b).max(c).min(1.0)
}

/// How far along a Hilbert curve through 1024^3 cells a cell lies (Skilling 2004, "Programming the
/// Hilbert curve").
pub(crate) fn hilbert(mut cell: [u32; 3]) -> u32 {
    const BITS: u32 = 10;
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        let low = q - 1;
        for axis in 0..3 {
            if cell[axis] & q != 0 {
                cell[0] ^= low;
            } else {
                let t = (cell[0] ^ cell[axis]) & low;
                cell[0] ^= t;
                cell[axis] ^= t;
            }
        }
        q >>= 1;
    }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let mut t = 0;
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        if cell[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let [x, y, z] = cell.map(|c| c ^ t);
    (0..BITS)
        .rev()
        .fold(0, |key, bit| key << 3 | (x >> bit & 1) << 2 | (y >> bit & 1) << 1 | z >> bit & 1)
}
