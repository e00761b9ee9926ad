//! A brick of a distance field: 4 x 4 x 4 cells, the distances at their corners, and what is known of each cell.
//!
//! Guarantees: a value is unknown or final, for any number of threads. What a distance is, and when a cell is made, `distance_field.rs`
//! decides.

use super::horizon::Cap;
use super::triangle_tree::Nearby;
use glam::IVec3;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU16, AtomicU32, Ordering};

/// Cells along the edge of a brick; a block has eight bricks.
pub(super) const BRICK: i32 = 4;
pub(super) const BRICK_CELLS: usize = (BRICK * BRICK * BRICK) as usize;
/// Samples along the edge of a brick, both faces included.
pub(super) const SIDE: usize = BRICK as usize + 1;
const SAMPLES: usize = SIDE * SIDE * SIDE;

/// Index of a brick's sample at this offset from its lowest corner, in cells.
#[inline]
pub(super) fn sample_at(cells: IVec3) -> usize {
    let [x, y, z] = cells.to_array().map(|k| k as usize);
    (z * SIDE + y) * SIDE + x
}

/// Index of a cell in its brick.
#[inline]
pub(super) fn cell_at(i: IVec3) -> usize {
    let [x, y, z] = (i & (BRICK - 1)).to_array().map(|k| k as usize);
    (z * BRICK as usize + y) * BRICK as usize + x
}

/// A part of a block, small so that a lookup touches little memory. Samples are computed on first use; two threads that compute
/// the same one get the same value.
pub(super) struct Brick {
    /// Distances, as bits; [`UNKNOWN`] until computed.
    pub(super) samples: [AtomicU32; SAMPLES],
    /// For each cell, what the distance at its centre says of those interpolated there, as two bytes: by how much it is farther off than
    /// they say, in steps of [`MORE`] cells, and how far off it is, in steps of [`OFF`] cells, [`FAR_OFF`] if that is more or was not
    /// looked at. [`UNMADE`] until its corners are sampled.
    pub(super) centres: [AtomicU16; BRICK_CELLS],
    /// Start of a search here: the triangle found last. It affects how long a search takes, never its result.
    pub(super) near: AtomicU32,
    /// For each cell in which closest points were asked for, the triangles near it.
    pub(super) nearby: OnceLock<Box<[OnceLock<Nearby>; BRICK_CELLS]>>,
    /// For each eighth, what rises there.
    pub(super) caps: OnceLock<Box<[OnceLock<Cap>; 8]>>,
}

/// Bits that are no distance.
pub(super) const UNKNOWN: u32 = u32::MAX;
pub(super) const UNMADE: u16 = u16::MAX;
/// Steps of what is stored of a cell's centre, in cells.
pub(super) const MORE: f32 = 1.0 / 32.0;
pub(super) const OFF: f32 = 1.0 / 512.0;
pub(super) const FAR_OFF: u8 = u8::MAX;

/// Offsets of the samples at a cell's corners from the lowest, each next to the previous one.
pub(super) const CORNERS: [(usize, [f32; 3]); 8] = {
    const Y: usize = SIDE;
    const Z: usize = SIDE * SIDE;
    [
        (0, [0.0, 0.0, 0.0]),
        (1, [1.0, 0.0, 0.0]),
        (1 + Y, [1.0, 1.0, 0.0]),
        (Y, [0.0, 1.0, 0.0]),
        (Y + Z, [0.0, 1.0, 1.0]),
        (1 + Y + Z, [1.0, 1.0, 1.0]),
        (1 + Z, [1.0, 0.0, 1.0]),
        (Z, [0.0, 0.0, 1.0]),
    ]
};

impl Brick {
    pub(super) fn new(near: u32) -> Box<Self> {
        Box::new(Self {
            samples: [const { AtomicU32::new(UNKNOWN) }; SAMPLES],
            centres: [const { AtomicU16::new(UNMADE) }; BRICK_CELLS],
            near: AtomicU32::new(near),
            nearby: OnceLock::new(),
            caps: OnceLock::new(),
        })
    }

    /// A known distance, or [`UNKNOWN`] as a number.
    pub(super) fn sample(&self, at: usize) -> f32 {
        f32::from_bits(self.samples[at].load(Ordering::Relaxed))
    }
}
