//! The dabs of all strokes, indexed by position in space.
//!
//! Guarantees: every segment of a stroke that reaches a point is listed at that point, in the order of strokes. Not
//! promised: that every listed segment reaches it.

use super::Dab;
use crate::error::NodeError;
use glam::Vec3;

/// The segment between two samples of a stroke.
pub(super) struct DabSegment {
    pub(super) ends: [Dab; 2],
    /// Distance up to which it acts, cm.
    pub(super) reach: f32,
    /// Index of its stroke.
    pub(super) layer: u32,
    /// 0, or 1 for the mirror image.
    pub(super) half: u8,
    /// Vector from one end to the other, and the same divided by its squared length.
    along: Vec3,
    per_square: Vec3,
}

impl DabSegment {
    pub(super) fn new(ends: [Dab; 2], reach: f32, layer: u32, half: u8) -> Self {
        let along = ends[1].point - ends[0].point;
        let square = along.length_squared();
        let per_square = if square > 1e-12 { along / square } else { Vec3::ZERO };
        Self { ends, reach, layer, half, along, per_square }
    }

    /// Squared distance of a point, cm2, and the fraction along the segment of the closest position, 0 to 1.
    #[inline]
    pub(super) fn square(&self, p: Vec3) -> (f32, f32) {
        let to = p - self.ends[0].point;
        let t = to.dot(self.per_square).clamp(0.0, 1.0);
        ((to - self.along * t).length_squared(), t)
    }
}

#[inline]
fn between(a: Vec3, b: Vec3, p: Vec3) -> (f32, f32) {
    let (along, to) = (b - a, p - a);
    let square = along.length_squared();
    let t = if square > 0.0 { (to.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    ((to - along * t).length(), t)
}

/// A grid over the segments in space.
pub(super) struct Dabs {
    pieces: Vec<DabSegment>,
    low: Vec3,
    side: f32,
    size: [usize; 3],
    /// Start of each cell's segments in `listed`.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

/// The smallest side of a cell, cm.
const SIDE: f32 = 0.5;
/// Where a line has more segments than this along the side of a cell, cells are smaller.
const CROWD: f32 = 16.0;
/// The most cells along an axis.
const MOST: f32 = 96.0;
/// The most entries of all cells together; cells are enlarged to stay below it.
const MOST_LISTED: f64 = 16e6;

impl Dabs {
    /// `bounds` are those of the skin, which contain all queried points.
    pub(super) fn new(
        pieces: Vec<DabSegment>,
        (low, high): (Vec3, Vec3),
        check: &dyn Fn() -> Result<(), NodeError>,
    ) -> Result<Self, NodeError> {
        let ends =
            || pieces.iter().flat_map(|piece| piece.ends.map(|dab| (dab.point, piece.reach)));
        let lowest = ends().fold(Vec3::INFINITY, |low, (p, reach)| low.min(p - reach)).max(low);
        let highest = ends().fold(Vec3::NEG_INFINITY, |high, (p, reach)| high.max(p + reach));
        let highest = highest.min(high);
        let extent = (highest - lowest).max_element();
        let mut dabs =
            Self { pieces, low: lowest, side: SIDE, size: [0; 3], starts: vec![0], listed: vec![] };
        if dabs.pieces.is_empty() || !extent.is_finite() {
            return Ok(dabs);
        }
        let widest = dabs.pieces.iter().map(|piece| piece.reach).fold(0.0, f32::max);
        let extent = extent.max(0.0);
        // The line of a closed stroke has a segment in each triangle that it crosses: very many in a cell where the mesh is fine.
        let along: f32 = dabs.pieces.iter().map(|piece| piece.along.length()).sum();
        let crowd = dabs.pieces.len() as f32 * SIDE / along.max(SIDE);
        let least = if widest < SIDE { SIDE / (crowd / CROWD).clamp(1.0, 8.0) } else { SIDE };
        dabs.side = least.max(extent / MOST).max(widest / 8.0);
        loop {
            dabs.size =
                ((highest - lowest) / dabs.side).to_array().map(|x| x.max(0.0) as usize + 1);
            let cells = |piece: &DabSegment| {
                let [a, b] = piece.ends.map(|dab| dab.point);
                let steps = f64::from((a.distance(b) / dabs.side).ceil() + 1.0);
                let across = f64::from(2.0 * piece.reach / dabs.side + 2.0);
                steps * across * across * across
            };
            let most = dabs.size.iter().product::<usize>() as f64;
            let all: f64 = dabs.pieces.iter().map(|piece| cells(piece).min(most)).sum();
            if all <= MOST_LISTED || dabs.side >= extent {
                break;
            }
            dabs.side *= 2.0;
        }
        let count = dabs.size.iter().product::<usize>();
        let (mut starts, mut seen) = (vec![0u32; count + 1], vec![u32::MAX; count]);
        for i in 0..dabs.pieces.len() as u32 {
            if i % 1024 == 0 {
                check()?;
            }
            dabs.cells(i, &mut seen, |at| starts[at + 1] += 1);
        }
        for at in 1..starts.len() {
            starts[at] += starts[at - 1];
        }
        let mut next = starts.clone();
        let mut listed = vec![0; starts[count] as usize];
        seen.fill(u32::MAX);
        for i in 0..dabs.pieces.len() as u32 {
            if i % 1024 == 0 {
                check()?;
            }
            dabs.cells(i, &mut seen, |at| {
                listed[next[at] as usize] = i;
                next[at] += 1;
            });
        }
        // Segments arrive in the order of strokes, and stay so in each cell.
        (dabs.starts, dabs.listed) = (starts, listed);
        Ok(dabs)
    }

    /// The cells that a segment reaches; `seen` holds the last segment that visited each.
    fn cells(&self, number: u32, seen: &mut [u32], mut each: impl FnMut(usize)) {
        let piece = &self.pieces[number as usize];
        let [a, b] = piece.ends.map(|dab| dab.point);
        let steps = (a.distance(b) / (2.0 * self.side)).ceil().clamp(1.0, 4.0 * MOST) as usize;
        // Distance from the centre of a cell to its corner.
        let near = piece.reach + 0.8661 * self.side;
        for step in 0..steps {
            let [from, to] = [step, step + 1].map(|k| a.lerp(b, k as f32 / steps as f32));
            let [low, high] =
                [from.min(to) - piece.reach, from.max(to) + piece.reach].map(|p| self.cell(p));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        let at = self.slot([x, y, z]);
                        let middle = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, z as f32 + 0.5);
                        let middle = self.low + middle * self.side;
                        if seen[at] != number && between(from, to, middle).0 <= near {
                            seen[at] = number;
                            each(at);
                        }
                    }
                }
            }
        }
    }

    #[inline]
    fn cell(&self, p: Vec3) -> [usize; 3] {
        let at = ((p - self.low) / self.side).to_array();
        // (A negative number becomes 0.)
        [0, 1, 2].map(|k| (at[k] as usize).min(self.size[k].saturating_sub(1)))
    }

    #[inline]
    fn slot(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.size[1] + y) * self.size[2] + z
    }

    /// Indices of the segments that may reach a point of the skin.
    #[inline]
    pub(super) fn near(&self, p: Vec3) -> &[u32] {
        if self.listed.is_empty() {
            return &[];
        }
        let at = self.slot(self.cell(p));
        &self.listed[self.starts[at] as usize..self.starts[at + 1] as usize]
    }

    #[inline]
    pub(super) fn piece(&self, number: u32) -> &DabSegment {
        &self.pieces[number as usize]
    }

    /// The segments of a stroke.
    pub(super) fn of(&self, layer: u32) -> &[DabSegment] {
        let from = self.pieces.partition_point(|piece| piece.layer < layer);
        let to = self.pieces.partition_point(|piece| piece.layer <= layer);
        &self.pieces[from..to]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.pieces[..]) + 4 * (self.starts.len() + self.listed.len())
    }
}
