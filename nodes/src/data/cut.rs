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

use super::chart::{CELLS, around, middle};
use super::lines::{Lines, LinesView, PartingSegment};
use super::scalp::Scalp;
use super::sections::{CONTACT, NONE, Parting};
use crate::maths::hash::curve_id;
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Smallest area of a section, square head units: the box of a micro braid has twice that.
const LEAST: f32 = 0.12;
/// A speck beside an ear is not a section either: at most this small (square head units), and at most this fraction of
/// the median section's area.
const SPECK: (f32, f32) = (0.3, 0.06);
/// A piece narrower than this fraction of the median section goes to its neighbour. Width is twice the area over the
/// length of the border: half the side of a square, half the width of a strip.
const NARROW: f32 = 0.25;
/// A border that is this fraction of the longest counts as long as it: the first of such neighbours takes a piece.
const AS_LONG: f32 = 0.95;
/// A cell is on a line if it is nearer than half the line's width, clamped to these limits, head units.
const BARE: (f32, f32) = (0.05, 0.2);
/// Scalp that is connected to no section but lies this near to one (cells) belongs to it: the ragged edge of a region.
const RAGGED: usize = 8;

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
    let seen = lines.seen(&[], None);
    let mut labels = flood(scalp, seen);
    let mut tracts = measured(scalp, seen, &labels);
    let joined = join(scalp, seen, &partings, &labels, &mut tracts);
    for label in labels.iter_mut().filter(|label| **label != NONE) {
        *label = joined[*label as usize];
    }
    let (partings, lines) = parting_something(scalp, partings, lines, &labels);
    // What no parting bounds is a speck of the region's ragged edge.
    let specks: Vec<usize> = (0..CELLS * CELLS)
        .filter(|cell| tracts.get(labels[*cell] as usize).is_some_and(|tract| !tract.parted))
        .collect();
    let slivers = number(&joined, &tracts, scalp.chart().unit(), &mut labels);
    mend_the_edge(lines.seen(&[], None), &specks, &mut labels);
    Cut { partings, lines, labels, slivers }
}

/// Joins cells with no parting between them: first those off the lines, then those next to them, then the rest.
fn flood(scalp: &Scalp, lines: LinesView) -> Vec<u32> {
    let (spots, unit) = (scalp.chart().spots(), scalp.chart().unit());
    let mut labels = vec![NONE; CELLS * CELLS];
    let mut next = 0;
    let on_line = |cell: usize| {
        let cell = lines.cell(cell);
        let bare = lines.half_width(cell.nearest()).clamp(BARE.0 * unit, BARE.1 * unit);
        cell.nearest() != NONE && cell.clear() < bare
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
fn measured(scalp: &Scalp, lines: LinesView, labels: &[u32]) -> Vec<Tract> {
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
    lines: LinesView,
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
    let unit = scalp.chart().unit();
    let least_area = LEAST * unit * unit;
    let mut widths: Vec<f32> =
        tracts.iter().filter(|t| t.area >= least_area).map(Tract::width).collect();
    widths.sort_by(f32::total_cmp);
    let least = NARROW * widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    // The narrowest first; of those as narrow to a hundredth, which last bits would tell apart, the first. (Widths are
    // not negative, so their bits sort like their values.)
    let rank = |t: &Tract, i: u32| (t.width().to_bits() >> 16, i);
    let asked = |t: &Tract, i: u32| (t.width() < least).then(|| rank(t, i));
    let mut small: BTreeSet<(u32, u32)> =
        (0..).zip(tracts.iter()).filter_map(|(i, tract)| asked(tract, i)).collect();
    while let Some((_, from)) = small.pop_first() {
        let beside = &contacts[from as usize];
        let longest = beside.values().fold(0.0f32, |longest, length| longest.max(*length));
        let Some((to, contact)) = beside
            .iter()
            .find(|(_, length)| **length >= AS_LONG * longest)
            .map(|(to, length)| (*to, *length))
        else {
            continue;
        };
        small.remove(&rank(&tracts[to as usize], to));
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
        tract.border = (tract.border + given.border - 2.0 * contact).max(1e-3 * unit);
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
    let seen = lines.seen(labels, None);
    let parts = |piece: &PartingSegment| {
        let [left, right] = seen.sides(piece);
        left.is_none() || left != right
    };
    let keeps: Vec<bool> = lines
        .pieces()
        .iter()
        .map(|piece| !partings[piece.parting as usize].of_pattern || parts(piece))
        .collect();
    if keeps.iter().all(|keep| *keep) {
        return (partings, lines);
    }
    let least = CONTACT * scalp.chart().unit();
    let mut kept = vec![];
    let mut from = 0;
    for line in partings {
        let keeps = &keeps[from..][..line.points.len().saturating_sub(1)];
        from += keeps.len();
        // Those that are as short as a corner bound nothing and are counted by themselves: which of them there are hangs from
        // last bits, and the others keep their ids.
        let (mut long, mut short) = (0, 0);
        for points in runs(&line.points, keeps, least) {
            let (tag, k) = match length(&points) < least {
                true => (SHORT_TAG, &mut short),
                false => (RUN_TAG, &mut long),
            };
            let id = if (tag, *k) == (RUN_TAG, 0) { line.id } else { curve_id(line.id, tag, *k) };
            *k += 1;
            kept.push(Parting { id, points, ..line });
        }
    }
    let lines = Lines::new(scalp, &kept);
    (kept, lines)
}

/// Length of a line, cm.
fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// The pieces of a line of whose segments these are kept; what leaves out less than `least` (cm) between two that are kept
/// is kept too.
fn runs(points: &[Vec3], keeps: &[bool], least: f32) -> Vec<Vec<Vec3>> {
    let mut runs: Vec<Vec<Vec3>> = vec![];
    let mut at = 0;
    for same in keeps.chunk_by(|a, b| a == b) {
        let here = &points[at..=at + same.len()];
        let is_hole = !same[0] && at > 0 && at + same.len() < keeps.len() && length(here) < least;
        match (same[0] || is_hole, runs.last_mut().filter(|run| run.last() == here.first())) {
            (true, Some(run)) => run.extend(&here[1..]),
            (true, None) => runs.push(here.to_vec()),
            (false, _) => {}
        }
        at += same.len();
    }
    runs
}

/// Mixed into the ids of the pieces of a broken line, and of those as short as a corner.
const RUN_TAG: u64 = 0xB20C;
const SHORT_TAG: u64 = 0xB20D;

/// Numbers the sections, without those that are too small; returns how many of these a parting bounds. `unit` is one
/// head unit in cm.
fn number(one_with: &[u32], tracts: &[Tract], unit: f32, labels: &mut [u32]) -> usize {
    let (smallest, speck_area) = (LEAST * unit * unit, SPECK.0 * unit * unit);
    let own = |i: &usize| one_with[*i] == *i as u32;
    let mut areas: Vec<f32> = (0..tracts.len()).filter(own).map(|i| tracts[i].area).collect();
    areas.retain(|area| *area >= smallest);
    areas.sort_by(f32::total_cmp);
    let speck = |middle: &f32| smallest.max(speck_area.min(SPECK.1 * middle));
    let least = areas.get(areas.len() / 2).map_or(smallest, speck);
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
fn mend_the_edge(lines: LinesView, specks: &[usize], labels: &mut [u32]) {
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
