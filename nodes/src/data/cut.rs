//! How partings cut a scalp: cells of the map joined to sections, and what a braider would not braid given to its neighbour.
//!
//! Cells are joined where the way between their middles crosses no parting. A piece between lines of a pattern that is much
//! narrower than the others goes to the neighbour that it shares most of its border with; then the lines of patterns are left out
//! wherever the same section lies on both sides of them. Lines that somebody drew are never left out.
//!
//! Guarantees: numbers run from front to back; the same cuts whatever is cut elsewhere, but for what counts as narrow, which hangs
//! from the middle width of all. Not promised: sections narrower than a cell (1.1 mm).

use super::chart::{CELL, CELLS, Spread, around, cell_of, cross, middle};
use super::scalp::Scalp;
use super::sections::{NONE, Parting};
use crate::maths::hash::curve_id;
use glam::{IVec2, Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// What is smaller is no section, cm2: the box of a micro braid is twice that.
const LEAST: f32 = 0.12;
/// Nor is a speck beside an ear, as small as this and of so small a share of the middle section's area.
const SPECK: (f32, f32) = (0.3, 0.06);
/// What is narrower than this share of the middle section goes to its neighbour. Width is twice the area over the border's
/// length: half the side of a square, half the width of a strip.
const NARROW: f32 = 0.35;
/// Scalp that hangs together with no section but lies this near to one (cells) belongs to it: the ragged edge of a region.
const RAGGED: usize = 8;

/// A piece of a parting, on the map and on the scalp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) flat: [Vec2; 2],
    pub(super) ends: [Vec3; 2],
    pub(super) parting: u32,
    /// Fraction along its parting.
    pub(super) along: f32,
}

/// The pieces of all partings, found by cell.
pub(super) struct Lines {
    pub(super) pieces: Vec<Piece>,
    /// Where each cell's pieces start in `listed`: those in the cell and in the cells around it.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

impl Lines {
    fn new(spread: &Spread, partings: &[Parting]) -> Self {
        let mut pieces = vec![];
        for (parting, line) in (0..).zip(partings) {
            let last = line.points.len().saturating_sub(1) as f32;
            for (k, w) in line.points.windows(2).enumerate() {
                let ends = [w[0], w[1]];
                let flat = ends.map(|p| spread.flat(p));
                pieces.push(Piece { flat, ends, parting, along: (k as f32 + 0.5) / last });
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
        Self { pieces, starts, listed }
    }

    /// The pieces in a cell and in those around it.
    pub(super) fn near_cell(&self, cell: usize) -> &[u32] {
        &self.listed[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The pieces that the way between the middles of two neighbours crosses.
    fn between(&self, a: usize, b: usize) -> impl Iterator<Item = &Piece> {
        let (p, q) = (middle(a), middle(b));
        let pieces = self.near_cell(a).iter().map(|i| &self.pieces[*i as usize]);
        pieces.filter(move |piece| cross(p, q, piece.flat[0], piece.flat[1]))
    }

    /// The label of the cell whose middle is reached from a point of the map without crossing a parting.
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

    pub(super) fn bytes(&self) -> usize {
        self.pieces.len() * size_of::<Piece>() + 4 * (self.starts.len() + self.listed.len())
    }
}

/// A scalp cut.
pub(super) struct Cut {
    pub(super) partings: Vec<Parting>,
    pub(super) lines: Lines,
    /// Number of each cell's section, or [`NONE`].
    pub(super) labels: Vec<u32>,
    /// How many pieces between drawn lines are too small to be sections.
    pub(super) slivers: usize,
}

/// A piece of scalp that hangs together.
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

pub(super) fn cut(scalp: &Scalp, partings: Vec<Parting>) -> Cut {
    let spread = scalp.chart().spread();
    let lines = Lines::new(&spread, &partings);
    let (mut labels, mut tracts) = flood(scalp, &lines);
    let joined = join(scalp, &lines, &partings, &labels, &mut tracts);
    for label in labels.iter_mut().filter(|label| **label != NONE) {
        *label = joined[*label as usize];
    }
    let (partings, lines) = parting_something(&spread, partings, lines, &labels);
    // What no parting bounds is a speck of the region's ragged edge.
    let specks: Vec<usize> = (0..CELLS * CELLS)
        .filter(|cell| tracts.get(labels[*cell] as usize).is_some_and(|tract| !tract.parted))
        .collect();
    let slivers = number(&joined, &tracts, &mut labels);
    mend_the_edge(&lines, &specks, &mut labels);
    Cut { partings, lines, labels, slivers }
}

/// Joins cells where no parting is between them.
fn flood(scalp: &Scalp, lines: &Lines) -> (Vec<u32>, Vec<Tract>) {
    let spots = scalp.chart().spots();
    let grows: Vec<bool> = spots.iter().map(|s| s.grows > 0.0).collect();
    let mut labels = vec![NONE; CELLS * CELLS];
    let mut found: Vec<Tract> = vec![];
    let mut members = vec![];
    // Row by row from the forehead, so that numbers run from front to back.
    let rows = (0..CELLS).rev().flat_map(|y| (0..CELLS).map(move |x| y * CELLS + x));
    for seed in rows {
        if !grows[seed] || labels[seed] != NONE {
            continue;
        }
        members.clear();
        members.push(seed);
        let label = found.len() as u32;
        labels[seed] = label;
        let mut tract = Tract::default();
        let mut next = 0;
        while let Some(cell) = members.get(next).copied() {
            next += 1;
            tract.area += spots[cell].area * spots[cell].grows;
            let side = spots[cell].area.sqrt();
            for other in around(cell).take(4) {
                if !grows[other] {
                    tract.border += side;
                } else if labels[other] != label {
                    if lines.between(cell, other).next().is_some() {
                        tract.parted |= spots[cell].grows >= 0.5;
                        tract.border += side;
                    } else if labels[other] == NONE {
                        labels[other] = label;
                        members.push(other);
                    }
                }
            }
        }
        found.push(tract);
    }
    (labels, found)
}

/// Gives tracts that are too small to their neighbours beyond lines of patterns: for each the number of the tract that it is one
/// with now. What is known of that is brought up to date.
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
    let spots = scalp.chart().spots();
    let mut contacts: Vec<BTreeMap<u32, f32>> = vec![BTreeMap::new(); tracts.len()];
    for cell in (0..CELLS * CELLS).filter(|cell| labels[*cell] != NONE) {
        for other in around(cell).take(4).filter(|o| labels[*o] != NONE) {
            let (a, b) = (labels[cell], labels[other]);
            let mut between = lines.between(cell, other);
            if a != b && between.all(|piece| partings[piece.parting as usize].of_pattern) {
                *contacts[a as usize].entry(b).or_default() += spots[cell].area.sqrt();
            }
        }
    }
    let mut widths: Vec<f32> =
        tracts.iter().filter(|t| t.area >= LEAST).map(Tract::width).collect();
    widths.sort_by(f32::total_cmp);
    let least = NARROW * widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    // Widths are not negative, so their bits are in their order.
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

/// The partings without what of patterns has one section on both sides.
fn parting_something(
    spread: &Spread,
    partings: Vec<Parting>,
    lines: Lines,
    labels: &[u32],
) -> (Vec<Parting>, Lines) {
    let parts = |piece: &Piece| {
        let [a, b] = piece.flat;
        let (middle, aside) = ((a + b) * 0.5, (b - a).perp().normalize_or_zero() * (0.3 * CELL));
        let [left, right] = [aside, -aside].map(|off| lines.label_at(labels, middle + off));
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
    let lines = Lines::new(spread, &kept);
    (kept, lines)
}

/// Mixed into the ids of what a line is broken into.
const RUN_TAG: u64 = 0xB20C;

/// Numbers the sections, without those that are too small; gives how many of these a parting bounds.
fn number(one_with: &[u32], tracts: &[Tract], labels: &mut [u32]) -> usize {
    let own = |i: &usize| one_with[*i] == *i as u32;
    let mut areas: Vec<f32> = (0..tracts.len()).filter(own).map(|i| tracts[i].area).collect();
    areas.retain(|area| *area >= LEAST);
    areas.sort_by(f32::total_cmp);
    let speck = |middle: &f32| LEAST.max(SPECK.0.min(SPECK.1 * middle));
    let least = areas.get(areas.len() / 2).map_or(LEAST, speck);
    let (mut next, mut slivers) = (0, 0);
    let mut numbers = vec![NONE; tracts.len()];
    // A section has the place of its first tract.
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

/// Gives specks to the section beside them that no parting keeps them from.
fn mend_the_edge(lines: &Lines, specks: &[usize], labels: &mut [u32]) {
    if specks.iter().all(|cell| labels[*cell] != NONE) {
        return;
    }
    // Over what grows no hair the way may lead, a few cells far.
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

/// The cells of the box about a piece, and `more` around it.
pub(super) fn covered(flat: &[Vec2; 2], more: i32) -> impl Iterator<Item = usize> {
    let at = |q: Vec2| ((q / CELL).floor().as_ivec2()) + CELLS as i32 / 2;
    let (a, b) = (at(flat[0].min(flat[1])) - more, at(flat[0].max(flat[1])) + more);
    let last = CELLS as i32 - 1;
    let (low, high) = (a.max(IVec2::ZERO), b.min(IVec2::splat(last)));
    (low.y..=high.y)
        .flat_map(move |y| (low.x..=high.x).map(move |x| y as usize * CELLS + x as usize))
}

/// Squared distance of a point from a straight piece.
#[inline]
pub(super) fn square_to([a, b]: [Vec3; 2], p: Vec3) -> f32 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance_squared(a + along * t)
}
