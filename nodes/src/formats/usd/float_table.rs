//! The table of distinct floats that a crate file may hold in place of a long array of few.
//!
//! Guaranteed: floats are distinct by their bits and in order of first use, so the same array gives the same table. Not promised: a
//! table; whoever asks stores the array as it is where none pays.

use super::super::Chunks;
use super::coding::SHORTEST_COMPRESSED;

/// Most entries in the table, as in OpenUSD.
const LONGEST_FLOAT_TABLE: usize = 1024;

/// The distinct floats of an array, in order of first use, and each value's index among them.
pub(super) struct FloatTable {
    pub(super) floats: Vec<f32>,
    pub(super) indices: Vec<u16>,
}

impl FloatTable {
    /// `None` when the array is short, or has too many distinct values for a table to pay: more than
    /// a quarter of its length or [`LONGEST_FLOAT_TABLE`]. Distinct means by bits, so `-0.0` stays.
    pub(super) fn of(values: &Chunks<f32>) -> Option<Self> {
        let count = values.len();
        if count < SHORTEST_COMPRESSED {
            return None;
        }
        let longest = LONGEST_FLOAT_TABLE.min(count / 4);
        let mut slots = FloatSlots::new();
        let mut floats: Vec<f32> = Vec::new();
        let mut indices = Vec::new();
        for &value in values.values() {
            let index = slots.index_of(value, &mut floats);
            if floats.len() > longest {
                return None;
            }
            indices.push(index);
        }
        Some(Self { floats, indices })
    }
}

/// An open hash table of at most [`LONGEST_FLOAT_TABLE`] + 1 floats, several times faster than a
/// general one: a groom looks up a width for every point.
struct FloatSlots {
    /// One more than the index of the float in this slot, 0 for a free slot.
    taken: Vec<u16>,
}

impl FloatSlots {
    /// Four slots per float keep the runs of taken slots short.
    const LOG2_SLOTS: u32 = 12;

    fn new() -> Self {
        Self { taken: vec![0; 1 << Self::LOG2_SLOTS] }
    }

    fn index_of(&mut self, value: f32, floats: &mut Vec<f32>) -> u16 {
        // Knuth's multiplicative hash: the high bits are the mixed ones.
        let hash = value.to_bits().wrapping_mul(0x9E37_79B1) >> (32 - Self::LOG2_SLOTS);
        let mut slot = hash as usize;
        loop {
            match self.taken[slot] {
                0 => {
                    floats.push(value);
                    self.taken[slot] = floats.len() as u16;
                    return self.taken[slot] - 1;
                }
                taken if floats[taken as usize - 1].to_bits() == value.to_bits() => {
                    return taken - 1;
                }
                _ => slot = (slot + 1) % self.taken.len(),
            }
        }
    }
}
