//! What of a scalp's sections a piece of work has read, so that it need not run again where a parting moves elsewhere.
//!
//! Sections as a piece sees them (`Sections::noting`) carry `Reads`: whatever is asked of them about a place is noted there, as a
//! tile of the scalp's map or a block of space. Afterwards a [`Footprint`] holds what the sections say there, and tells of other
//! sections of the same head whether they say the same. Work that reads nothing else that differs then gives the same result on both.
//!
//! Guarantees: what the queries of [`Sections`] answer at a place follows from its tile or block alone; what cannot be put down to
//! places (lists, names) counts as all of it; it does not matter on which thread is read. Not promised: that the numbers of sections
//! stay, which only tell one from another within a piece; nor anything for what is read through other handles: whoever runs a piece sees
//! to it that it holds none ([`TracedScalp`]).
//!
//! [`TracedScalp`]: crate::eval::TracedScalp

use super::chart::CELLS;
use super::sections::Sections;
use crate::maths::hash::Key;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Cells of a tile along one side: 4 mm, less than rows are wide.
const TILE: usize = 4;
/// Tiles of the map along one side.
const TILES: usize = CELLS.div_ceil(TILE);
/// Places of space ([`super::places`]) of a block along one side.
const BLOCK: i32 = 2;
/// Blocks are numbered so far along each axis, then from the start again: more than the partings of a head take up. Those of one
/// number count as one.
const BLOCKS: i32 = 32;

/// Number of a block of space.
pub(super) type Block = u32;

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

/// What one piece of work has read so far.
pub(super) struct Reads {
    tiles: Bits,
    blocks: Bits,
    all: AtomicBool,
}

/// Some of the numbers from 0 on.
struct Bits(Box<[AtomicU64]>);

impl Bits {
    fn new(n: usize) -> Self {
        Self((0..n.div_ceil(64)).map(|_| AtomicU64::new(0)).collect())
    }
    /// Most is noted again and again: then it is only looked at.
    #[inline]
    fn note(&self, i: usize) {
        let (word, bit) = (&self.0[i / 64], 1 << (i % 64));
        if word.load(Ordering::Relaxed) & bit == 0 {
            word.fetch_or(bit, Ordering::Relaxed);
        }
    }
    fn each(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.0).flat_map(|(at, word): (u32, _)| {
            let word = word.load(Ordering::Relaxed);
            (0..64).filter(move |k| word >> k & 1 == 1).map(move |k| at * 64 + k)
        })
    }
}

impl Reads {
    pub(super) fn new() -> Self {
        let blocks = (BLOCKS * BLOCKS * BLOCKS) as usize;
        Self {
            tiles: Bits::new(Digests::COUNT),
            blocks: Bits::new(blocks),
            all: AtomicBool::new(false),
        }
    }

    /// Notes that what is in and around a cell of the map is read.
    #[inline]
    pub(super) fn cell(&self, cell: usize) {
        let (x, y) = (cell % CELLS, cell / CELLS);
        let span = |x: usize| x.saturating_sub(1) / TILE..=(x + 1).min(CELLS - 1) / TILE;
        for y in span(y) {
            span(x).for_each(|x| self.tiles.note(y * TILES + x));
        }
    }

    /// Notes that what is near the places of space from `low` to `high` is read; they should be few.
    #[inline]
    pub(super) fn places(&self, low: [i32; 3], high: [i32; 3]) {
        let span = |k: usize| low[k].div_euclid(BLOCK)..=high[k].div_euclid(BLOCK);
        for (x, y) in span(0).flat_map(|x| span(1).map(move |y| (x, y))) {
            span(2).for_each(|z| self.blocks.note(number([x, y, z]) as usize));
        }
    }

    /// Notes that something is read that is no one place's.
    #[inline]
    pub(super) fn all(&self) {
        self.all.store(true, Ordering::Relaxed);
    }

    /// What was read of `sections`, the only ones that this was noted of.
    pub(super) fn footprint(&self, sections: &Sections) -> Footprint {
        let digests = sections.digests();
        let tiles = self.tiles.each().map(|tile| (tile, digests.tiles[tile as usize]));
        let blocks = self.blocks.each().map(|block| (block, digests.block(block)));
        Footprint {
            tiles: tiles.collect(),
            blocks: blocks.collect(),
            common: digests.common,
            all: self.all.load(Ordering::Relaxed).then(|| sections.key()),
        }
    }
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
            && self.blocks.iter().all(|(block, key)| digests.block(*block) == *key)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.tiles.len() * 32 + self.blocks.len() * 32 + 64
    }
}

impl Digests {
    fn block(&self, block: Block) -> Key {
        self.blocks.get(&block).copied().unwrap_or_default()
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
    number(place.map(|x| x.div_euclid(BLOCK)))
}

#[inline]
fn number(block: [i32; 3]) -> Block {
    block.iter().fold(0, |number, x| number * BLOCKS as u32 + x.rem_euclid(BLOCKS) as u32)
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

    /// What is asked of a scalp, and what that read of its sections.
    fn traced<T>(scalp: &Scalp, ask: impl FnOnce(&Scalp) -> T) -> (T, Footprint) {
        let seen = scalp.noting();
        (ask(&seen), seen.sections().unwrap().footprint())
    }

    /// What a query answers, in bits; sections by their ids.
    type Query = fn(&Scalp, Vec3, Vec3) -> Vec<u64>;

    fn bits(p: Option<Vec3>) -> Vec<u64> {
        p.map_or(vec![], |p| p.to_array().map(|x| u64::from(x.to_bits())).to_vec())
    }

    const QUERIES: [(&str, Query); 14] = [
        // Too long to be looked at by boxes.
        ("a long way over lines", |scalp, p, q| {
            vec![u64::from(scalp.sections().unwrap().passed(p, p + (q - p) * 8.0, 0.0))]
        }),
        ("a root's section", |scalp, p, _| {
            let root = scalp.closest_root(p).unwrap();
            let sections = scalp.sections().unwrap();
            let id = sections.id_of(&root).unwrap_or_default();
            vec![id, u64::from(sections.of(&root).is_some()), u64::from(scalp.is_free(&root))]
        }),
        ("a root's distance", |scalp, p, _| {
            let root = scalp.closest_root(p).unwrap();
            let sections = scalp.sections().unwrap();
            let place = sections.at_root(&root).map_or(-1.0, |place| place.distance);
            [sections.distance(&root), place].map(|x| u64::from(x.to_bits())).to_vec()
        }),
        ("a hair over lines", |scalp, p, q| {
            let hair: Vec<Vec3> = (0..20).map(|k| p.lerp(q, 0.1 * k as f32)).collect();
            let sections = scalp.sections().unwrap();
            let last = sections.last_passed(hair.len(), |k| hair[k]);
            vec![last.map_or(u64::MAX, |k| k as u64), u64::from(sections.is_over_line(&hair))]
        }),
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
                    let (was, read) = traced(&before, |scalp| ask(scalp, p, q));
                    let (is, again) = traced(&after, |scalp| ask(scalp, p, q));
                    assert_eq!(was, ask(&before, p, q), "noted or not: {what}, {p} {q}");
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
        let queries: [(&str, fn(&Scalp)); 7] = [
            ("list", |scalp| _ = scalp.sections().unwrap().list()),
            ("partings", |scalp| _ = scalp.sections().unwrap().partings()),
            ("names", |scalp| _ = scalp.sections().unwrap().names()),
            ("labels", |scalp| _ = scalp.sections().unwrap().labels()),
            ("key", |scalp| _ = scalp.sections().unwrap().key()),
            ("key of the scalp", |scalp| _ = scalp.key()),
            ("masks", |scalp| _ = scalp.mask_names()),
        ];
        for (what, ask) in queries {
            let ((), read) = traced(&before, ask);
            assert!(read.is_same_on(old) && !read.is_same_on(new), "{what}");
        }
        let own: fn(&Scalp) = |scalp| _ = (scalp.whole(), scalp.key_untraced(), scalp.frame());
        for (what, ask) in [("nothing", (|_| ()) as fn(&Scalp)), ("the head's own", own)] {
            let ((), read) = traced(&before, ask);
            assert!(read.is_same_on(new), "{what}");
        }
    }

    #[test]
    fn what_is_read_on_other_threads_and_by_copies_is_noted() {
        let head = run(crate::by_id("head").unwrap(), &[]).0.swap_remove(0);
        let (before, after) = (parted(&head, 0.0), parted(&head, 0.4));
        let ask = |scalp: &Scalp| {
            let sections = scalp.sections().unwrap().clone();
            std::thread::scope(|scope| _ = scope.spawn(move || sections.labels().len()).join());
        };
        let ((), read) = traced(&before, ask);
        assert!(!read.is_same_on(after.sections().unwrap()));
    }
}
