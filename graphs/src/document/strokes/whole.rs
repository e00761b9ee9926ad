//! Edits that change where a stroke begins, ends or runs: extend, reverse, cut, join, draw anew.
//!
//! Lengths are head units along the straight lines between CVs. Where one stroke remains it keeps its
//! id; pressure stays with its place, and time runs from 0 at the root and never backwards. Results are
//! on the grid.

use super::cvs::{as_drawn, at, edited, length, nearest, ways};
use super::{SHARE, free_id, simplify};
use crate::values::grid::Steps;
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use glam::Vec3;

/// An end of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Where hair grows out of the skin.
    Root,
    /// The other one.
    Tip,
}

/// The way over which the direction of an end is measured: a hand turns as it lands and lifts.
const HEADING: f32 = 0.5;

/// Samples from the tip to the root, with time that runs forwards.
fn reversed_samples(samples: &[Sample]) -> Vec<Sample> {
    let end = samples.iter().map(|s| s.time).fold(0.0, f32::max);
    samples.iter().rev().map(|s| Sample { time: end - s.time, ..*s }).collect()
}

/// Samples with time that begins at 0.
fn from_zero(mut samples: Vec<Sample>) -> Vec<Sample> {
    let begin = samples.first().map_or(0.0, |s| s.time);
    samples.iter_mut().for_each(|s| s.time = (s.time - begin).max(0.0));
    samples
}

fn on_grid(samples: Vec<Sample>) -> Vec<Sample> {
    samples.iter().map(|s| Steps::of(s).sample()).collect()
}

/// Seconds a hand took for each unit of length; 0 where nobody knows.
fn pace(samples: &[Sample]) -> f32 {
    let way = ways(samples).last().copied().unwrap_or_default();
    let time = samples.last().map_or(0.0, |s| s.time) - samples.first().map_or(0.0, |s| s.time);
    if way > 0.0 && time > 0.0 { time / way } else { 0.0 }
}

/// The stroke from its tip to its root.
pub fn reversed(stroke: &Stroke) -> Stroke {
    edited(stroke, reversed_samples(&stroke.samples))
}

/// Makes an end longer, straight on, or shorter along the stroke; the other end stays. None when
/// nothing would remain, or when a stroke without length has no way to go.
pub fn extended(stroke: &Stroke, end: End, by: f32) -> Option<Stroke> {
    let samples = match end {
        End::Tip => longer(&stroke.samples, by)?,
        End::Root => {
            let samples = longer(&reversed_samples(&stroke.samples), by)?;
            from_zero(reversed_samples(&samples))
        }
    };
    Some(edited(stroke, samples))
}

fn longer(samples: &[Sample], by: f32) -> Option<Vec<Sample>> {
    let whole = *ways(samples).last()?;
    if by == 0.0 {
        return Some(samples.to_vec());
    }
    if by < 0.0 {
        let keep = whole + by;
        // What is less than two steps of the grid is a dot.
        let (i, tip) = at(samples, keep).filter(|_| keep > 0.02)?;
        let mut samples = samples[..=i].to_vec();
        samples.extend(Some(tip).filter(|tip| Some(tip) != samples.last()));
        return Some(samples);
    }
    let tip = *samples.last()?;
    let (_, back) = at(samples, whole - HEADING)?;
    let ahead = (tip.position - back.position).try_normalize()?;
    let mut samples = samples.to_vec();
    let time = tip.time + by * pace(&samples);
    samples.push(Sample { position: tip.position + ahead * by, time, ..tip });
    Some(samples)
}

/// Cuts a stroke in two at a place on it: the part at the root keeps the id, the other gets one of its
/// own among `others`. None where a part would have no length.
pub fn cut(stroke: &Stroke, way: f32, others: &Strokes) -> Option<(Stroke, Stroke)> {
    let (low, high) = halves(&stroke.samples, way)?;
    let (low, high) = (on_grid(low), on_grid(high));
    let (mut root, mut tip) = (Stroke::new(stroke.id, low), Stroke::new(0, high));
    if !stroke.drawn.is_empty() {
        // Each part goes back to its own part of what was drawn.
        let drawn = Stroke::new(stroke.id, stroke.drawn.clone());
        let (way, _) = nearest(&drawn, tip.samples.first()?.position);
        if let Some((low, high)) = halves(&drawn.samples, way) {
            (root.drawn, tip.drawn) = (on_grid(low), on_grid(high));
        }
    }
    tip.id = free_id(&tip.samples, others);
    (root.brush, tip.brush) = (stroke.brush.clone(), stroke.brush.clone());
    Some((root, tip))
}

/// The samples on both sides of a place, which both have.
fn halves(samples: &[Sample], way: f32) -> Option<(Vec<Sample>, Vec<Sample>)> {
    let whole = *ways(samples).last()?;
    // Two steps of the grid.
    if !(way > 0.02 && way < whole - 0.02) {
        return None;
    }
    let (i, middle) = at(samples, way)?;
    let mut low = samples[..=i].to_vec();
    low.extend(Some(middle).filter(|middle| Some(middle) != low.last()));
    let high = [middle].into_iter().chain(samples[i + 1..].iter().copied()).collect();
    Some((low, from_zero(high)))
}

/// Two strokes as one, under the id of the first, joined where their ends are nearest to each other;
/// the root of the first stays the root where it is not itself joined.
pub fn joined(first: &Stroke, second: &Stroke) -> Stroke {
    let samples = chained(&first.samples, &second.samples);
    let drawn = chained(as_drawn(first), as_drawn(second));
    Stroke { id: first.id, samples, drawn, brush: first.brush.clone() }
}

fn chained(first: &[Sample], second: &[Sample]) -> Vec<Sample> {
    let ends = |s: &[Sample]| {
        let end = |s: Option<&Sample>| s.map_or(Vec3::ZERO, |s| s.position);
        (end(s.first()), end(s.last()))
    };
    let ((root, tip), (other_root, other_tip)) = (ends(first), ends(second));
    let gaps = [
        tip.distance(other_root),
        tip.distance(other_tip),
        root.distance(other_tip),
        root.distance(other_root),
    ];
    let best = (0..4).min_by(|i, j| gaps[*i].total_cmp(&gaps[*j])).unwrap_or(0);
    let (a, b) = match best {
        0 => (first.to_vec(), second.to_vec()),
        1 => (first.to_vec(), reversed_samples(second)),
        2 => (second.to_vec(), first.to_vec()),
        _ => (reversed_samples(second), first.to_vec()),
    };
    on_grid(appended(a, &b, gaps[best]))
}

/// Samples behind others, with a gap between that was drawn at the pace of the first.
fn appended(mut a: Vec<Sample>, b: &[Sample], gap: f32) -> Vec<Sample> {
    let begin = b.first().map_or(0.0, |s| s.time);
    let late = a.last().map_or(0.0, |s| s.time) + gap * pace(&a) - begin;
    let touches = a.last().map(|s| s.position) == b.first().map(|s| s.position);
    let b = b.iter().skip(usize::from(touches));
    a.extend(b.map(|s| Sample { time: s.time + late, ..*s }));
    a
}

/// Draws a part of a stroke anew: what the pen gave replaces the stroke between the places that its
/// first and last samples are nearest to, in either direction. None when one of them is farther than
/// `reach` from the stroke, or when both are at the same place.
pub fn redrawn(stroke: &Stroke, pen: &[Sample], reach: f32) -> Option<Stroke> {
    let pen: Vec<Sample> = pen.iter().copied().filter(Sample::is_finite).collect();
    let kept = simplify(&pen, SHARE);
    let mut pen: Vec<Sample> = kept.into_iter().map(|i| pen[i]).collect();
    let ends = |pen: &[Sample]| {
        let place = |s: &Sample| Some(nearest(stroke, s.position)).filter(|n| n.1 <= reach);
        Some((place(pen.first()?)?.0, place(pen.last()?)?.0))
    };
    let (mut from, mut to) = ends(&pen)?;
    if from > to {
        pen = reversed_samples(&pen);
        (from, to) = (to, from);
    }
    // Two steps of the grid.
    if to - from < 0.02 {
        return None;
    }
    let whole = length(stroke);
    let ((i, first), (j, last)) = (at(&stroke.samples, from)?, at(&stroke.samples, to)?);
    // The new part begins and ends on the stroke: what its ends miss is spread along it.
    let ways = ways(&pen);
    let miss = [first.position - pen.first()?.position, last.position - pen.last()?.position];
    let drawn = *ways.last()?;
    for (sample, way) in pen.iter_mut().zip(&ways) {
        let part = if drawn > 0.0 { way / drawn } else { 0.0 };
        sample.position += miss[0] + (miss[1] - miss[0]) * part;
    }
    let mut samples: Vec<Sample> = stroke.samples[..=i].to_vec();
    if from <= 0.0 {
        samples.clear();
    }
    let head = samples.last().copied();
    if head.is_some_and(|head| head.position == first.position) {
        samples.pop();
    }
    let begin = pen.first()?.time;
    pen.iter_mut().for_each(|s| s.time += first.time - begin);
    let late = pen.last()?.time - last.time;
    samples.extend(pen);
    if to < whole {
        let tail = stroke.samples[j + 1..].iter();
        samples.extend(tail.map(|s| Sample { time: (s.time + late).max(0.0), ..*s }));
    }
    Some(edited(stroke, samples))
}
