//! What of a scalp's sections a piece of work has read, so that it need not run again where a parting moves elsewhere.
//!
//! While [`traced`] runs, whatever asks the sections about a place notes that place: a tile of the scalp's map, or a block of space.
//! Afterwards a [`Footprint`] holds what the sections say there, and tells of other sections of the same head whether they say the
//! same. Work that reads nothing else that differs then gives the same result on both.
//!
//! Guarantees: what the queries of [`Sections`] answer at a place follows from its tile or block alone; what cannot be put down to
//! places (lists, names) counts as all of it. Not promised: that the numbers of sections stay, which only tell one from another
//! within a piece; and anything for what was read before, or on another thread: who traces a piece of work sees to it that nothing
//! it holds comes from the sections.

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
    last: (usize, Option<(Block, Block)>),
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
    read_places(place, place);
}

/// Notes that what is near the places of space from `low` to `high` is read; they should be few.
#[inline]
pub(super) fn read_places(low: [i32; 3], high: [i32; 3]) {
    if TRACING.get() {
        let (low, high) = (block_of(low), block_of(high));
        READS.with_borrow_mut(|reads| {
            if reads.last.1 != Some((low, high)) {
                reads.last.1 = Some((low, high));
                let [xs, ys, zs] = [0, 1, 2].map(|k| low[k]..=high[k]);
                for block in xs.flat_map(|x| {
                    let zs = zs.clone();
                    ys.clone().flat_map(move |y| zs.clone().map(move |z| [x, y, z]))
                }) {
                    reads.blocks.insert(block);
                }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::{Curves, TuftBuilder};
    use crate::data::scalp::Scalp;
    use crate::define::Value;
    use crate::maths::hash::Dice;
    use crate::maths::transcendental::sin_cos_turns;
    use crate::testing::run;
    use glam::Vec3;
    use std::sync::Arc;

    /// The built-in head with five partings from the forehead to the nape; the middle one lies `by` cm beside its place.
    fn parted(head: &Value, by: f32) -> Arc<Scalp> {
        let mut b = TuftBuilder::new();
        for k in 0..5 {
            let x = 2.2 * (k as f32 - 2.0) + if k == 2 { by } else { 0.0 };
            let radius = (121.0 - x * x).sqrt();
            let at = |n: u32| {
                let (up, front) = sin_cos_turns((5.0 + 6.0 * n as f32) / 360.0);
                Vec3::new(x, radius * up, radius * front)
            };
            b.push_curve(&(0..43).map(at).collect::<Vec<_>>());
        }
        b.set(ID, Domain::Curve, (1..=5).collect());
        let lines = Curves::new(vec![Arc::new(b.build())]);
        let set = [("scalp", head.clone()), ("lines", lines.into()), ("width", Value::Float(0.3))];
        match run(crate::by_id("partings").unwrap(), &set).0.swap_remove(0) {
            Value::Scalp(scalp) => scalp,
            other => panic!("a {}", other.type_name()),
        }
    }

    /// What a query answers, in bits; sections by their ids.
    type Query = fn(&Scalp, Vec3, Vec3) -> Vec<u64>;

    fn bits(p: Option<Vec3>) -> Vec<u64> {
        p.map_or(vec![], |p| p.to_array().map(|x| u64::from(x.to_bits())).to_vec())
    }

    const QUERIES: [(&str, Query); 10] = [
        ("the section", |scalp, p, _| scalp.sections().unwrap().id_at(p).into_iter().collect()),
        ("the place", |scalp, p, _| {
            let place = scalp.sections().unwrap().at(p);
            let of = |place: crate::data::sections::Place| {
                [place.distance.to_bits(), place.bare.to_bits(), u32::from(place.free)]
                    .map(u64::from)
            };
            place.map_or(vec![], |place| of(place).to_vec())
        }),
        ("whether hair may be rooted", |scalp, p, _| vec![u64::from(scalp.free(p))]),
        ("a way over a line", |scalp, p, q| {
            vec![u64::from(scalp.sections().unwrap().passed(p, q, 0.0))]
        }),
        ("a way over the scalp", |scalp, p, q| {
            vec![u64::from(scalp.sections().unwrap().crosses(p, q))]
        }),
        ("a point of home", |scalp, p, q| {
            scalp
                .home(p)
                .map_or(vec![], |home| vec![u64::from(home.holds(q)), u64::from(home.is_under(q))])
        }),
        ("a point kept at home", |scalp, p, q| {
            let mut near = 0;
            bits(scalp.home(p).and_then(|home| home.kept(q, &mut near)))
        }),
        ("hair that leaves home", |scalp, p, q| {
            scalp.home(p).map_or(vec![], |home| {
                vec![u64::from(home.crosses(p, q)), u64::from(home.is_straight(p, q))]
            })
        }),
        ("the way home", |scalp, p, q| {
            let way = scalp.home(p).and_then(|home| home.ways(p).from(q));
            way.into_iter().flatten().flat_map(|p| bits(Some(p))).collect()
        }),
        ("a root kept in its section", |scalp, p, q| {
            let root = scalp.closest_root(q).unwrap();
            bits(Some(scalp.kept_in_section(p, root).point))
        }),
    ];

    #[test]
    fn where_a_footprint_is_the_same_so_are_the_answers() {
        let head = run(crate::by_id("head").unwrap(), &[]).0.swap_remove(0);
        let before = parted(&head, 0.0);
        let dice = Dice::new(0, 0, "footprint");
        for (by, rounds) in [(0.4, 400), (-1.0, 200)] {
            let after = parted(&head, by);
            let (old, new) = (before.sections().unwrap(), after.sections().unwrap());
            for (what, ask) in QUERIES {
                let rounds = if what == "the way home" { 12 } else { rounds };
                let (mut same, mut changed) = (0, 0);
                for k in 0..rounds {
                    let off = |n| dice.signed(k, n);
                    // About the moved line and the sections beside it, a little off the skin.
                    let p = Vec3::new(3.0 * off(0), 8.0 + off(1), 4.0 * off(2));
                    let p = before.closest_root(p).unwrap().point;
                    let q = p + Vec3::new(off(3), 0.3 * off(4), off(5));
                    let (was, read) = traced(old, || ask(&before, p, q));
                    let (is, again) = traced(new, || ask(&after, p, q));
                    if read.is_same_on(new) {
                        assert_eq!(was, is, "{what}: {p} {q}, moved by {by}");
                        assert!(
                            again.is_same_on(old),
                            "{what}: {p} {q}, read as the other way round"
                        );
                        same += 1;
                    } else {
                        changed += u32::from(was != is);
                    }
                    assert!(read.is_same_on(old) && again.is_same_on(new));
                }
                // Not all of it is read by every query, nor does a whole section's way stay where its border moves.
                assert!(same > 0 || what == "the way home", "{what}: {same} the same");
                assert!(changed > 0, "{what}: {changed} changed");
            }
        }
    }

    #[test]
    fn what_is_no_places_counts_as_all() {
        let head = run(crate::by_id("head").unwrap(), &[]).0.swap_remove(0);
        let (before, after) = (parted(&head, 0.0), parted(&head, 0.4));
        let (old, new) = (before.sections().unwrap(), after.sections().unwrap());
        let (_, read) = traced(old, || old.list().len());
        assert!(read.is_same_on(old) && !read.is_same_on(new));
        let (_, nothing) = traced(old, || ());
        assert!(nothing.is_same_on(new));
    }
}
