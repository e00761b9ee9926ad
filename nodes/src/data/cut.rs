//! How partings cut a scalp: cells of the map are joined to sections, and slivers that nobody would braid go to a
//! neighbour.
//!
//! Two cells are joined if the segment between their centres crosses no parting and stays off the lines; no hair is
//! drawn through a neck as narrow as a parting's bare skin. A piece between pattern lines that is much narrower than
//! the others goes to the neighbour with which it shares most of its border. Pattern lines are then dropped where the
//! same section lies on both sides. Drawn lines are never dropped.
//!
//! Guarantees: sections are numbered from front to back; cuts do not depend on cuts elsewhere, except for the threshold
//! of narrowness, which derives from the median width of all. Not promised: sections narrower than a cell (1.1 mm).

use super::chart::{CELL, CELLS, around, cell_of, cross, middle};
use super::places::{PLACE, Places, place_of};
use super::read_set::{Digests, block_of, read_cell};
use super::scalp::Scalp;
use super::sections::{FAR, NONE, Parting};
use crate::maths::hash::{Key, KeyBuilder, curve_id};
use crate::maths::nearest_on;
use glam::{IVec2, Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Smallest area of a section, cm2: the box of a micro braid has twice that.
const LEAST: f32 = 0.12;
/// A speck beside an ear is not a section either: at most this small, and at most this fraction of the median section's
/// area.
const SPECK: (f32, f32) = (0.3, 0.06);
/// A piece narrower than this fraction of the median section goes to its neighbour. Width is twice the area over the
/// length of the border: half the side of a square, half the width of a strip.
const NARROW: f32 = 0.25;
/// A cell is on a line if it is nearer than half the line's width, clamped to these limits, cm.
const BARE: (f32, f32) = (0.05, 0.2);
/// Scalp that is connected to no section but lies this near to one (cells) belongs to it: the ragged edge of a region.
const RAGGED: usize = 8;

/// A segment of a parting, on the map and on the scalp.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartingSegment {
    pub(super) flat: [Vec2; 2],
    pub(super) ends: [Vec3; 2],
    /// Direction off the scalp.
    up: Vec3,
    /// Half the width of its parting, cm.
    pub(super) half_width: f32,
    pub(super) parting: u32,
    /// Fraction along its parting.
    pub(super) along: f32,
}

/// The segments of all partings, indexed by cell.
pub(super) struct Lines {
    pub(super) pieces: Vec<PartingSegment>,
    /// Start of each cell's segments in `listed`: those in the cell and in the cells around it.
    starts: Vec<u32>,
    listed: Vec<u32>,
    /// The segment nearest to each cell's centre, or [`NONE`], and its distance, cm.
    pub(super) nearest: Vec<u32>,
    pub(super) clear: Vec<f32>,
    /// Segments indexed by position in space, for points that are near one in space but not on the map, as on an ear.
    places: Places,
}

/// Direction off the scalp at each point of a line: the mean of the normals around it, weighted by proximity. A fold
/// that the line crosses has no side of its own.
pub(crate) fn off_the_scalp(scalp: &Scalp, line: &[Vec3]) -> Vec<Vec3> {
    /// Distance along the line over which they count, cm.
    const REACH: f32 = 0.8;
    let normal = |p: &Vec3| scalp.closest_root(*p).map_or(Vec3::ZERO, |root| root.normal);
    let normals: Vec<Vec3> = line.iter().map(normal).collect();
    let mean = |k: usize| {
        let one = |i: usize| {
            let near = 1.0 - line[i].distance(line[k]) / REACH;
            (near > 0.0).then(|| normals[i] * near)
        };
        let after = (k..line.len()).map_while(one);
        let before = (0..k).rev().map_while(one);
        after.chain(before).sum::<Vec3>().try_normalize().unwrap_or(normals[k])
    };
    (0..line.len()).map(mean).collect()
}

impl PartingSegment {
    /// Whether the straight segment between two points crosses this piece, or comes as near to the plane between its
    /// sides as the fraction `near` of half its width.
    fn is_passed(&self, from: Vec3, to: Vec3, near: f32) -> bool {
        let near = near * self.half_width;
        let [a, b] = self.ends;
        let along = b - a;
        let aside = self.up.cross(along).normalize_or_zero();
        let (before, after) = ((from - a).dot(aside), (to - a).dot(aside));
        let on = if (before > 0.0) != (after > 0.0) {
            from.lerp(to, before / (before - after)) - a
        } else if before.abs().min(after.abs()) < near {
            if before.abs() < after.abs() { from - a } else { to - a }
        } else {
            return false;
        };
        let t = on.dot(along) / along.length_squared().max(1e-12);
        (0.0..1.0).contains(&t) && on.distance(along * t) < 0.5 * PLACE
    }
}

impl Lines {
    fn new(scalp: &Scalp, partings: &[Parting]) -> Self {
        let spread = scalp.chart().spread();
        let mut pieces = vec![];
        for (parting, line) in (0..).zip(partings) {
            let last = line.points.len().saturating_sub(1) as f32;
            let ups = off_the_scalp(scalp, &line.points);
            for (k, w) in line.points.windows(2).enumerate() {
                let ends = [w[0], w[1]];
                let flat = ends.map(|p| spread.flat(p));
                let up = (ups[k] + ups[k + 1]).normalize_or_zero();
                let (along, half_width) = ((k as f32 + 0.5) / last, line.half_width);
                pieces.push(PartingSegment { flat, ends, up, half_width, parting, along });
            }
        }
        let mut starts = vec![0u32; CELLS * CELLS + 1];
        for piece in &pieces {
            covered(&piece.flat, 1).for_each(|cell| starts[cell + 1] += 1);
        }
        for cell in 0..CELLS * CELLS {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut listed = vec![0; starts[CELLS * CELLS] as usize];
        for (i, piece) in (0..).zip(&pieces) {
            for cell in covered(&piece.flat, 1) {
                listed[next[cell] as usize] = i;
                next[cell] += 1;
            }
        }
        let places = Places::new(&pieces);
        let mut lines = Self { pieces, starts, listed, nearest: vec![], clear: vec![], places };
        lines.near(scalp);
        lines
    }

    /// Half the width of the parting of a segment, cm; 0 for none.
    pub(super) fn half_width(&self, piece: u32) -> f32 {
        self.pieces.get(piece as usize).map_or(0.0, |piece| piece.half_width)
    }

    /// The segments near a point in space: all within half a place, and some slightly farther.
    pub(super) fn near_place(&self, p: Vec3) -> &[u32] {
        self.places.near(place_of(p, self.places.side))
    }

    /// The last of the segments between `n` points in space that crosses a parting, or comes as near to it as the
    /// fraction `aside` of half its width, at most half a place off it; as the index of its end point.
    pub(super) fn last_passed(
        &self,
        n: usize,
        at: impl Fn(usize) -> Vec3,
        aside: f32,
    ) -> Option<usize> {
        /// Number of segments tested together, since most are near no parting; and the largest size of their box, in
        /// places.
        const TOGETHER: (usize, f32) = (12, 5.0);
        let passes = |from: Vec3, to: Vec3| {
            let parts = (from.distance(to) / (0.2 * PLACE)).ceil().clamp(1.0, 200.0);
            (0..parts as u32).any(|k| {
                let at = |k: u32| from.lerp(to, k as f32 / parts);
                let (a, b) = (at(k), at(k + 1));
                let near = self.near_place((a + b) * 0.5);
                near.iter().any(|i| self.pieces[*i as usize].is_passed(a, b, aside))
            })
        };
        let mut last = n.saturating_sub(1);
        while last > 0 {
            let mut first = last - 1;
            let (a, b) = (at(first), at(last));
            let (mut low, mut high) = (a.min(b), a.max(b));
            while first > 0 && last - first < TOGETHER.0 {
                let p = at(first - 1);
                let wider = (low.min(p), high.max(p));
                if (wider.1 - wider.0).max_element() > TOGETHER.1 * self.places.side {
                    break;
                }
                ((low, high), first) = (wider, first - 1);
            }
            if !self.places.are_empty(low, high)
                && let Some(k) = (first..last).rev().find(|k| passes(at(*k), at(k + 1)))
            {
                return Some(k + 1);
            }
            last = first;
        }
        None
    }

    /// The segments in a cell and in those around it.
    pub(super) fn near_cell(&self, cell: usize) -> &[u32] {
        read_cell(cell);
        &self.listed[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The segments that lie between the centres of two neighbours.
    fn between(&self, a: usize, b: usize) -> impl Iterator<Item = &PartingSegment> {
        let (p, q) = (middle(a), middle(b));
        let pieces = self.near_cell(a).iter().map(|i| &self.pieces[*i as usize]);
        pieces.filter(move |piece| cross(p, q, piece.flat[0], piece.flat[1]))
    }

    /// The label of a cell whose centre can be reached from a point of the map without crossing a parting.
    pub(super) fn label_at(&self, labels: &[u32], q: Vec2) -> Option<u32> {
        let own = cell_of(q)?;
        let pieces = self.near_cell(own);
        let reached = |cell: usize| {
            let to = middle(cell);
            let label = labels[cell];
            let open = |i: &u32| {
                let [a, b] = self.pieces[*i as usize].flat;
                !cross(q, to, a, b)
            };
            (label != NONE && pieces.iter().all(open)).then_some(label)
        };
        reached(own).or_else(|| around(own).find_map(reached))
    }

    /// Finds the nearest segment to every cell: each cell passes its own on to its neighbours, forward and back.
    fn near(&mut self, scalp: &Scalp) {
        let spots = scalp.chart().spots();
        let mut best = vec![(FAR * FAR, NONE); CELLS * CELLS];
        for (i, piece) in (0..).zip(&self.pieces) {
            for cell in covered(&piece.flat, 0) {
                let d = square_to(piece.ends, spots[cell].point);
                if (d, i) < best[cell] {
                    best[cell] = (d, i);
                }
            }
        }
        let pass = |best: &mut Vec<(f32, u32)>, cell: usize, others: &[usize]| {
            for other in others {
                let (_, i) = best[*other];
                if i != NONE && i != best[cell].1 {
                    let d = square_to(self.pieces[i as usize].ends, spots[cell].point);
                    if (d, i) < best[cell] {
                        best[cell] = (d, i);
                    }
                }
            }
        };
        for _ in 0..2 {
            for cell in CELLS + 1..CELLS * CELLS {
                let above = cell - CELLS;
                pass(&mut best, cell, &[cell - 1, above, above - 1, above + 1]);
            }
            for cell in (0..CELLS * CELLS - CELLS - 1).rev() {
                let below = cell + CELLS;
                pass(&mut best, cell, &[cell + 1, below, below + 1, below - 1]);
            }
        }
        self.clear = best.iter().map(|(d, _)| d.sqrt()).collect();
        self.nearest = best.into_iter().map(|(_, i)| i).collect();
    }

    /// Digests of these lines and of the sections with these ids, for each part of the map and of space: everything
    /// that queries of a cell, with its neighbours, and of a place can find.
    pub(super) fn digests(&self, labels: &[u32], ids: impl Fn(u32) -> u64, widest: f32) -> Digests {
        let piece = |piece: &PartingSegment| {
            let PartingSegment { flat, ends, up, half_width, .. } = piece;
            let key = KeyBuilder::new("piece").float(*half_width).vec3(*up);
            let key = ends.iter().fold(key, |key, end| key.vec3(*end));
            flat.iter().fold(key, |key, q| key.float(q.x).float(q.y)).finish()
        };
        let pieces: Vec<Key> = self.pieces.iter().map(piece).collect();
        let of = |i: u32| pieces.get(i as usize).copied().unwrap_or_default();
        let mut tiles: Vec<KeyBuilder> =
            (0..Digests::COUNT).map(|_| KeyBuilder::new("tile")).collect();
        for cell in 0..CELLS * CELLS {
            let near = of(self.nearest[cell]);
            let clear = self.clear[cell].to_bits();
            let key = |key: KeyBuilder| {
                let key = key.int(ids(labels[cell])).key(near).int(u64::from(clear));
                self.near_cell(cell).iter().fold(key, |key, i| key.key(of(*i)))
            };
            let tile = &mut tiles[Digests::tile(cell)];
            *tile = key(std::mem::replace(tile, KeyBuilder::new("")));
        }
        let mut blocks: BTreeMap<_, KeyBuilder> = BTreeMap::new();
        for (place, listed) in self.places.each() {
            let block = blocks.entry(block_of(place)).or_insert_with(|| KeyBuilder::new("block"));
            let key = std::mem::replace(block, KeyBuilder::new(""));
            let key = place.iter().fold(key, |key, x| key.int(*x as u64));
            *block = listed.iter().fold(key, |key, i| key.key(of(*i)));
        }
        Digests {
            tiles: tiles.into_iter().map(KeyBuilder::finish).collect(),
            blocks: blocks.into_iter().map(|(block, key)| (block, key.finish())).collect(),
            common: KeyBuilder::new("common").float(self.places.side).float(widest).finish(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.pieces.len() * size_of::<PartingSegment>()
            + 4 * (self.starts.len() + self.listed.len() + self.nearest.len() + self.clear.len())
            + self.places.bytes()
    }
}

/// A cut scalp.
pub(super) struct Cut {
    pub(super) partings: Vec<Parting>,
    pub(super) lines: Lines,
    /// Index of each cell's section, or [`NONE`].
    pub(super) labels: Vec<u32>,
    /// How many pieces between drawn lines are too small to be sections.
    pub(super) slivers: usize,
}

impl Cut {
    /// The map according to another cut: its lines, and the section under each cell.
    pub(super) fn told(
        scalp: &Scalp,
        partings: Vec<Parting>,
        slivers: usize,
        under: impl Fn(Vec3) -> Option<u32>,
    ) -> Self {
        let lines = Lines::new(scalp, &partings);
        let spots = scalp.chart().spots().iter();
        let label = |spot: &super::chart::Spot| match spot.area > 0.0 && spot.grows > 0.0 {
            true => under(spot.point).unwrap_or(NONE),
            false => NONE,
        };
        let labels = spots.map(label).collect();
        Self { partings, lines, labels, slivers }
    }
}

/// A connected piece of scalp.
#[derive(Clone, Copy, Default)]
struct Tract {
    area: f32,
    /// Length of its border, cm.
    border: f32,
    /// Whether a parting bounds it.
    parted: bool,
}

impl Tract {
    fn width(&self) -> f32 {
        2.0 * self.area / self.border.max(1e-6)
    }
}

/// Cuts a scalp.
pub(super) fn cut(scalp: &Scalp, partings: Vec<Parting>) -> Cut {
    let lines = Lines::new(scalp, &partings);
    let mut labels = flood(scalp, &lines);
    let mut tracts = measured(scalp, &lines, &labels);
    let joined = join(scalp, &lines, &partings, &labels, &mut tracts);
    for label in labels.iter_mut().filter(|label| **label != NONE) {
        *label = joined[*label as usize];
    }
    let (partings, lines) = parting_something(scalp, partings, lines, &labels);
    // What no parting bounds is a speck of the region's ragged edge.
    let specks: Vec<usize> = (0..CELLS * CELLS)
        .filter(|cell| tracts.get(labels[*cell] as usize).is_some_and(|tract| !tract.parted))
        .collect();
    let slivers = number(&joined, &tracts, &mut labels);
    mend_the_edge(&lines, &specks, &mut labels);
    Cut { partings, lines, labels, slivers }
}

/// Joins cells with no parting between them: first those off the lines, then those next to them, then the rest.
fn flood(scalp: &Scalp, lines: &Lines) -> Vec<u32> {
    let spots = scalp.chart().spots();
    let mut labels = vec![NONE; CELLS * CELLS];
    let mut next = 0;
    let on_line = |cell: usize| {
        let bare = lines.half_width(lines.nearest[cell]).clamp(BARE.0, BARE.1);
        lines.nearest[cell] != NONE && lines.clear[cell] < bare
    };
    let spread = |labels: &mut [u32], mut front: Vec<usize>, off: bool| {
        let mut at = 0;
        while let Some(cell) = front.get(at).copied() {
            at += 1;
            for other in around(cell).take(4) {
                let open = spots[other].grows > 0.0
                    && labels[other] == NONE
                    && !(off && on_line(other))
                    && lines.between(cell, other).next().is_none();
                if open {
                    labels[other] = labels[cell];
                    front.push(other);
                }
            }
        }
    };
    for off in [true, false] {
        let labelled = (0..CELLS * CELLS).filter(|cell| labels[*cell] != NONE).collect();
        spread(&mut labels, labelled, off);
        // Row by row from the forehead, so that sections are numbered from front to back.
        for seed in (0..CELLS).rev().flat_map(|y| (0..CELLS).map(move |x| y * CELLS + x)) {
            let grows = spots[seed].grows > 0.0;
            if grows && labels[seed] == NONE && !(off && on_line(seed)) {
                labels[seed] = next;
                next += 1;
                spread(&mut labels, vec![seed], off);
            }
        }
    }
    labels
}

/// Areas and borders.
fn measured(scalp: &Scalp, lines: &Lines, labels: &[u32]) -> Vec<Tract> {
    let spots = scalp.chart().spots();
    let mut tracts: Vec<Tract> = vec![];
    for (cell, label) in labels.iter().enumerate().filter(|(_, l)| **l != NONE) {
        let slot = *label as usize;
        tracts.resize(tracts.len().max(slot + 1), Tract::default());
        let tract = &mut tracts[slot];
        tract.area += spots[cell].area * spots[cell].grows;
        for other in around(cell).take(4).filter(|o| labels[*o] != *label) {
            tract.border += side(scalp, cell, other);
            tract.parted |= spots[cell].grows >= 0.5
                && spots[other].grows > 0.0
                && lines.between(cell, other).next().is_some();
        }
    }
    tracts
}

/// Length of the side between two cells, cm of scalp.
fn side(scalp: &Scalp, cell: usize, other: usize) -> f32 {
    let (p, q) = (middle(cell), middle(other));
    scalp.chart().stretch((p + q) * 0.5, (q - p).perp())
}

/// Gives tracts that are too small to their neighbours across pattern lines; returns for each the index of the tract
/// that it is now part of. Updates the measurements.
fn join(
    scalp: &Scalp,
    lines: &Lines,
    partings: &[Parting],
    labels: &[u32],
    tracts: &mut [Tract],
) -> Vec<u32> {
    let mut one_with: Vec<u32> = (0..tracts.len() as u32).collect();
    if !partings.iter().any(|parting| parting.of_pattern) {
        return one_with;
    }
    let mut contacts: Vec<BTreeMap<u32, f32>> = vec![BTreeMap::new(); tracts.len()];
    for cell in (0..CELLS * CELLS).filter(|cell| labels[*cell] != NONE) {
        for other in around(cell).take(4).filter(|o| labels[*o] != NONE) {
            let (a, b) = (labels[cell], labels[other]);
            let mut between = lines.between(cell, other);
            if a != b && between.all(|piece| partings[piece.parting as usize].of_pattern) {
                *contacts[a as usize].entry(b).or_default() += side(scalp, cell, other);
            }
        }
    }
    let mut widths: Vec<f32> =
        tracts.iter().filter(|t| t.area >= LEAST).map(Tract::width).collect();
    widths.sort_by(f32::total_cmp);
    let least = NARROW * widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    // Widths are not negative, so their bits sort like their values.
    let asked = |t: &Tract, i: u32| (t.width() < least).then(|| (t.width().to_bits(), i));
    let mut small: BTreeSet<(u32, u32)> =
        (0..).zip(tracts.iter()).filter_map(|(i, tract)| asked(tract, i)).collect();
    while let Some((_, from)) = small.pop_first() {
        let longest = |a: &(&u32, &f32), b: &(&u32, &f32)| a.1.total_cmp(b.1).then(b.0.cmp(a.0));
        let Some((to, contact)) =
            contacts[from as usize].iter().max_by(longest).map(|(to, length)| (*to, *length))
        else {
            continue;
        };
        small.remove(&(tracts[to as usize].width().to_bits(), to));
        let own = std::mem::take(&mut contacts[from as usize]);
        for (other, length) in own {
            contacts[other as usize].remove(&from);
            if other != to {
                *contacts[other as usize].entry(to).or_default() += length;
                *contacts[to as usize].entry(other).or_default() += length;
            }
        }
        let given = tracts[from as usize];
        let tract = &mut tracts[to as usize];
        tract.area += given.area;
        tract.border = (tract.border + given.border - 2.0 * contact).max(1e-3);
        tract.parted |= given.parted;
        small.extend(asked(tract, to));
        one_with[from as usize] = to;
    }
    for i in 0..one_with.len() {
        let mut to = one_with[i];
        while one_with[to as usize] != to {
            to = one_with[to as usize];
        }
        one_with[i] = to;
    }
    one_with
}

/// The partings, without pattern lines that have one section on both sides.
fn parting_something(
    scalp: &Scalp,
    partings: Vec<Parting>,
    lines: Lines,
    labels: &[u32],
) -> (Vec<Parting>, Lines) {
    let parts = |piece: &PartingSegment| {
        let [a, b] = piece.flat;
        let (middle, aside) = ((a + b) * 0.5, (b - a).perp().normalize_or_zero() * CELL);
        // Where two lines coincide, nothing is between them.
        let on_side = |way: Vec2| {
            [0.3, 0.8, 1.5].iter().find_map(|far| lines.label_at(labels, middle + way * *far))
        };
        let [left, right] = [aside, -aside].map(on_side);
        left.is_none() || left != right
    };
    let keeps: Vec<bool> = lines
        .pieces
        .iter()
        .map(|piece| !partings[piece.parting as usize].of_pattern || parts(piece))
        .collect();
    if keeps.iter().all(|keep| *keep) {
        return (partings, lines);
    }
    let mut kept = vec![];
    let mut keeps = keeps.into_iter();
    for line in partings {
        let mut runs: Vec<Vec<Vec3>> = vec![vec![]];
        for w in line.points.windows(2) {
            let last = runs.len() - 1;
            match (keeps.next().unwrap_or(true), runs[last].is_empty()) {
                (true, true) => runs[last].extend(w),
                (true, false) => runs[last].push(w[1]),
                (false, true) => {}
                (false, false) => runs.push(vec![]),
            }
        }
        runs.retain(|run| !run.is_empty());
        for (k, points) in (0..).zip(runs) {
            let id = if k == 0 { line.id } else { curve_id(line.id, RUN_TAG, k) };
            kept.push(Parting { id, points, ..line });
        }
    }
    let lines = Lines::new(scalp, &kept);
    (kept, lines)
}

/// Mixed into the ids of the pieces of a broken line.
const RUN_TAG: u64 = 0xB20C;

/// Numbers the sections, without those that are too small; returns how many of these a parting bounds.
fn number(one_with: &[u32], tracts: &[Tract], labels: &mut [u32]) -> usize {
    let own = |i: &usize| one_with[*i] == *i as u32;
    let mut areas: Vec<f32> = (0..tracts.len()).filter(own).map(|i| tracts[i].area).collect();
    areas.retain(|area| *area >= LEAST);
    areas.sort_by(f32::total_cmp);
    let speck = |middle: &f32| LEAST.max(SPECK.0.min(SPECK.1 * middle));
    let least = areas.get(areas.len() / 2).map_or(LEAST, speck);
    let (mut next, mut slivers) = (0, 0);
    let mut numbers = vec![NONE; tracts.len()];
    // A section takes the place of its first tract.
    for to in one_with.iter().map(|to| *to as usize) {
        if numbers[to] == NONE && tracts[to].area >= least {
            numbers[to] = next;
            next += 1;
        }
    }
    for i in (0..tracts.len()).filter(own) {
        slivers += usize::from(numbers[i] == NONE && tracts[i].parted);
    }
    for label in labels.iter_mut().filter(|label| **label != NONE) {
        *label = numbers[*label as usize];
    }
    slivers
}

/// Gives specks to an adjacent section that no parting separates them from.
fn mend_the_edge(lines: &Lines, specks: &[usize], labels: &mut [u32]) {
    if specks.iter().all(|cell| labels[*cell] != NONE) {
        return;
    }
    // The path may cross bare skin, for a few cells.
    let mut reached = labels.to_vec();
    let mut front: Vec<usize> = (0..CELLS * CELLS).filter(|c| reached[*c] != NONE).collect();
    for _ in 0..RAGGED {
        let mut next = vec![];
        for cell in front {
            for other in around(cell).take(4) {
                if reached[other] == NONE && lines.between(cell, other).next().is_none() {
                    reached[other] = reached[cell];
                    next.push(other);
                }
            }
        }
        front = next;
    }
    for cell in specks {
        labels[*cell] = reached[*cell];
    }
}

/// The cells of the box around a segment, and `more` around it.
pub(super) fn covered(flat: &[Vec2; 2], more: i32) -> impl Iterator<Item = usize> {
    let at = |q: Vec2| ((q / CELL).floor().as_ivec2()) + CELLS as i32 / 2;
    let (a, b) = (at(flat[0].min(flat[1])) - more, at(flat[0].max(flat[1])) + more);
    let last = CELLS as i32 - 1;
    let (low, high) = (a.max(IVec2::ZERO), b.min(IVec2::splat(last)));
    (low.y..=high.y)
        .flat_map(move |y| (low.x..=high.x).map(move |x| y as usize * CELLS + x as usize))
}

/// Squared distance of a point from a segment.
#[inline]
pub(super) fn square_to(segment: [Vec3; 2], p: Vec3) -> f32 {
    p.distance_squared(nearest_on(segment, p).0)
}
