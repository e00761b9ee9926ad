//! Segments of partings, indexed by position in space.
//!
//! Guarantees: every segment within half a place of a point is listed at that point's place. Not promised: that every listed segment
//! is that near. [`super::lines::LinesView`] alone asks.

use super::lines::PartingSegment;
use glam::Vec3;

/// A grid over the segments in space.
pub(super) struct Places {
    /// Index of the lowest place along each axis. Places are counted from the origin, so that a place has the same
    /// segments wherever other partings lie.
    low: [i32; 3],
    side: f32,
    /// Half of the least side, cm: segments are found from as far.
    half: f32,
    size: [usize; 3],
    /// Start of each place's segments in `listed`.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

impl Places {
    /// The most places along an axis; larger extents have larger places.
    const MOST: f32 = 128.0;

    /// `unit` is one head unit in cm.
    pub(super) fn new(pieces: &[PartingSegment], unit: f32) -> Self {
        let place = PLACE * unit;
        let ends = || pieces.iter().flat_map(|piece| piece.ends);
        let low = ends().fold(Vec3::INFINITY, Vec3::min) - place;
        let high = ends().fold(Vec3::NEG_INFINITY, Vec3::max) + place;
        let longest = (high - low).max_element();
        if !longest.is_finite() {
            let (size, starts) = ([0; 3], vec![0]);
            return Self {
                low: [0; 3],
                side: place,
                half: 0.5 * place,
                size,
                starts,
                listed: vec![],
            };
        }
        let side = place.max(longest / Self::MOST);
        let (low, high) = (place_of(low, side), place_of(high, side));
        let size = [0, 1, 2].map(|k| (high[k] - low[k]) as usize + 1);
        let mut places =
            Self { low, side, half: 0.5 * place, size, starts: vec![], listed: vec![] };
        let mut starts = vec![0u32; size.iter().product::<usize>() + 1];
        for piece in pieces {
            places.about(piece).for_each(|at| starts[at + 1] += 1);
        }
        for at in 1..starts.len() {
            starts[at] += starts[at - 1];
        }
        let mut next = starts.clone();
        let mut listed = vec![0; starts[starts.len() - 1] as usize];
        for (i, piece) in (0..).zip(pieces) {
            for at in places.about(piece) {
                listed[next[at] as usize] = i;
                next[at] += 1;
            }
        }
        (places.starts, places.listed) = (starts, listed);
        places
    }

    /// Side of a place, cm.
    pub(super) fn side(&self) -> f32 {
        self.side
    }

    /// How far from a segment a point may be for the segment to be listed at the point's place, cm.
    pub(super) fn half(&self) -> f32 {
        self.half
    }

    /// Start of a place's list, if the grid contains it.
    fn slot(&self, place: [i32; 3]) -> Option<usize> {
        let at = [0, 1, 2].map(|k| usize::try_from(place[k].saturating_sub(self.low[k])).ok());
        let [Some(x), Some(y), Some(z)] = at else { return None };
        let [nx, ny, nz] = self.size;
        (x < nx && y < ny && z < nz).then(|| (x * ny + y) * nz + z)
    }

    /// The places within half a place of a segment, and some slightly farther.
    fn about(&self, piece: &PartingSegment) -> impl Iterator<Item = usize> + use<> {
        let [a, b] = piece.ends;
        let low = place_of(a.min(b) - 1.2 * self.half, self.side);
        let high = place_of(a.max(b) + 1.2 * self.half, self.side);
        let [xs, ys, zs] = [0, 1, 2].map(|k| {
            let slot = |x: i32| (x.max(self.low[k]) - self.low[k]) as usize;
            slot(low[k])..=slot(high[k]).min(self.size[k] - 1)
        });
        let [_, ny, nz] = self.size;
        xs.flat_map(move |x| {
            let zs = zs.clone();
            ys.clone().flat_map(move |y| zs.clone().map(move |z| (x * ny + y) * nz + z))
        })
    }

    /// The segments near a place.
    pub(super) fn near(&self, place: [i32; 3]) -> &[u32] {
        self.slot(place).map_or(&[], |at| self.listed(at))
    }

    /// Whether no segment is near any place from `low` to `high`.
    pub(super) fn are_empty(&self, low: [i32; 3], high: [i32; 3]) -> bool {
        let [xs, ys, zs] = [0, 1, 2].map(|k| {
            let slot = |x: i32| x.saturating_sub(self.low[k]).max(0) as usize;
            slot(low[k])..(slot(high[k].saturating_add(1))).min(self.size[k])
        });
        let [_, ny, nz] = self.size;
        // The segments of a row of places are contiguous.
        let is_empty = |row: usize| self.starts[row + zs.start] == self.starts[row + zs.end];
        zs.is_empty() || xs.into_iter().all(|x| ys.clone().all(|y| is_empty((x * ny + y) * nz)))
    }

    fn listed(&self, at: usize) -> &[u32] {
        &self.listed[self.starts[at] as usize..self.starts[at + 1] as usize]
    }

    /// All places with segments near them.
    pub(super) fn each(&self) -> impl Iterator<Item = ([i32; 3], &[u32])> {
        let [_, ny, nz] = self.size;
        let place = move |at: usize| {
            let at = [at / nz / ny, at / nz % ny, at % nz];
            [0, 1, 2].map(|k| self.low[k] + at[k] as i32)
        };
        let all = (0..self.starts.len() - 1).map(move |at| (at, self.listed(at)));
        all.filter(|(_, listed)| !listed.is_empty()).map(move |(at, listed)| (place(at), listed))
    }

    pub(super) fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.listed.len())
    }
}

/// Index of a point's place along each axis.
#[inline]
pub(super) fn place_of(p: Vec3, side: f32) -> [i32; 3] {
    // Floor, without the function call it is on older processors.
    (p / side).to_array().map(|x| (x as i32).saturating_sub(i32::from(x < x as i32 as f32)))
}

/// Side of a place, head units: partings up to twice as wide are seen from both sides.
const PLACE: f32 = 0.5;
