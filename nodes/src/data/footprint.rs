//! What of a scalp's sections a piece of work has read, so that it need not run again where a parting moves elsewhere.
//!
//! While [`traced`] runs, whatever asks the sections about a place notes that place: a tile of the scalp's map, or a block of space.
//! Afterwards a [`Footprint`] holds what the sections say there, and tells of other sections of the same head whether they say the
//! same. Work that reads nothing else that differs then gives the same result on both.
//!
//! Guarantees: what the queries of [`Sections`] answer at a place follows from its tile or block alone; what cannot be put down to
//! places (lists, names) counts as all of it. Not promised: anything for what was read before, or on another thread: who traces a
//! piece of work sees to it that nothing it holds comes from the sections.

use super::chart::CELLS;
use super::sections::Sections;
use crate::maths::hash::Key;
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

/// Cells of a tile along one side: 4 mm, less than rows are wide.
const TILE: usize = 4;
/// Tiles of the map along one side.
const TILES: usize = CELLS.div_ceil(TILE);
/// Places of space ([`super::cut`]) of a block along one side.
const BLOCK: i32 = 2;

/// A block of space, by its number along each axis.
pub(super) type Block = [i32; 3];

/// What was read, and what was found there.
#[derive(Clone, Debug)]
pub struct Footprint {
    tiles: Vec<(u32, Key)>,
    blocks: Vec<(Block, Key)>,
    /// What holds everywhere; all that there is, where that was read.
    common: Key,
    all: Option<Key>,
}

/// What sections say in each tile and block.
pub(super) struct Digests {
    pub(super) tiles: Vec<Key>,
    pub(super) blocks: BTreeMap<Block, Key>,
    pub(super) common: Key,
}

#[derive(Default)]
struct Reads {
    tiles: Vec<u64>,
    blocks: BTreeSet<Block>,
    last: (usize, Block),
    all: bool,
}

thread_local! {
    static TRACING: Cell<bool> = const { Cell::new(false) };
    static READS: RefCell<Reads> = RefCell::default();
}

/// Whoever traced before goes on afterwards, also when what is traced panics.
struct Outer(bool, Option<Reads>);

impl Drop for Outer {
    fn drop(&mut self) {
        TRACING.set(self.0);
        READS.replace(self.1.take().unwrap_or_default());
    }
}

/// Runs `work` and gives what it read of `sections`, which must be the only ones that it reads.
pub fn traced<T>(sections: &Sections, work: impl FnOnce() -> T) -> (T, Footprint) {
    let fresh = Reads { tiles: vec![0; (TILES * TILES).div_ceil(64)], ..Reads::default() };
    let outer = Outer(TRACING.replace(true), Some(READS.replace(fresh)));
    let out = work();
    let reads = READS.take();
    drop(outer);
    let digests = sections.digests();
    let read = |tile: &u32| reads.tiles[*tile as usize / 64] & (1 << (tile % 64)) != 0;
    let tiles = (0..(TILES * TILES) as u32).filter(read);
    let footprint = Footprint {
        tiles: tiles.map(|tile| (tile, digests.tiles[tile as usize])).collect(),
        blocks: reads.blocks.iter().map(|block| (*block, digests.block(block))).collect(),
        common: digests.common,
        all: reads.all.then(|| sections.key()),
    };
    (out, footprint)
}

impl Footprint {
    /// Whether other sections of the same head say the same wherever these were read.
    pub fn is_same_on(&self, sections: &Sections) -> bool {
        if let Some(all) = self.all {
            return all == sections.key();
        }
        let digests = sections.digests();
        self.common == digests.common
            && self.tiles.iter().all(|(tile, key)| digests.tiles[*tile as usize] == *key)
            && self.blocks.iter().all(|(block, key)| digests.block(block) == *key)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.tiles.len() * 32 + self.blocks.len() * 32 + 64
    }
}

impl Digests {
    fn block(&self, block: &Block) -> Key {
        self.blocks.get(block).copied().unwrap_or_default()
    }

    /// The tile of a cell of the map.
    pub(super) fn tile(cell: usize) -> usize {
        cell / CELLS / TILE * TILES + cell % CELLS / TILE
    }

    /// Tiles of the map.
    pub(super) const COUNT: usize = TILES * TILES;
}

/// The block of a place of space.
pub(super) fn block_of(place: [i32; 3]) -> Block {
    place.map(|x| x.div_euclid(BLOCK))
}

/// Notes that what is in and around a cell of the map is read.
#[inline]
pub(super) fn read_cell(cell: usize) {
    if TRACING.get() {
        note_cell(cell);
    }
}

/// Notes that what is near a place of space is read.
#[inline]
pub(super) fn read_place(place: [i32; 3]) {
    if TRACING.get() {
        READS.with_borrow_mut(|reads| {
            let block = block_of(place);
            if reads.blocks.is_empty() || reads.last.1 != block {
                reads.last.1 = block;
                reads.blocks.insert(block);
            }
        });
    }
}

/// Notes that something is read that is no one place's.
#[inline]
pub(super) fn read_all() {
    if TRACING.get() {
        READS.with_borrow_mut(|reads| reads.all = true);
    }
}

#[cold]
fn note_cell(cell: usize) {
    READS.with_borrow_mut(|reads| {
        // Told from 0, which is where it starts.
        if reads.last.0 == cell + 1 {
            return;
        }
        reads.last.0 = cell + 1;
        let (x, y) = (cell % CELLS, cell / CELLS);
        let span = |x: usize| x.saturating_sub(1) / TILE..=(x + 1).min(CELLS - 1) / TILE;
        for tile in span(y).flat_map(|y| span(x).map(move |x| y * TILES + x)) {
            reads.tiles[tile / 64] |= 1 << (tile % 64);
        }
    });
}
