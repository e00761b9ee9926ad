//! Edits of a stroke's CVs: move with falloff, insert, delete, slide, straighten, smooth.
//!
//! Every function takes a stroke and gives what it becomes, under the same id, on the grid; what was
//! drawn is kept in it from the first change on. Lengths are head units (cm on a head of radius
//! 8.9 cm), measured along the straight lines between CVs. What is no number, or leads to none,
//! changes nothing.
//!
//! Guarantees: root and tip stay where they are unless they are picked themselves; an edit by nothing
//! gives the same stroke, with nothing kept in it.

use super::free_id;
use crate::values::grid::Steps;
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use glam::Vec3;
use std::collections::BTreeSet;

/// The way along a stroke from its root to each CV.
pub fn ways(samples: &[Sample]) -> Vec<f32> {
    let mut way = 0.0;
    let mut last = samples.first().map_or(Vec3::ZERO, |s| s.position);
    let mut add = |s: &Sample| {
        way += s.position.distance(last);
        last = s.position;
        way
    };
    samples.iter().map(&mut add).collect()
}

/// The length of a stroke.
pub fn length(stroke: &Stroke) -> f32 {
    ways(&stroke.samples).last().copied().unwrap_or_default()
}

/// The place on a stroke that is nearest to a point: the way to it from the root, and its distance.
pub fn nearest(stroke: &Stroke, point: Vec3) -> (f32, f32) {
    let ways = ways(&stroke.samples);
    let first = stroke.samples.first().map_or(Vec3::ZERO, |s| s.position);
    let mut best = (0.0, first.distance(point));
    for (i, pair) in stroke.samples.windows(2).enumerate() {
        let (a, span) = (pair[0].position, pair[1].position - pair[0].position);
        let length2 = span.length_squared();
        if length2 > 0.0 {
            let t = ((point - a).dot(span) / length2).clamp(0.0, 1.0);
            let distance = (a + span * t).distance(point);
            if distance < best.1 {
                best = (ways[i] + (ways[i + 1] - ways[i]) * t, distance);
            }
        }
    }
    best
}

/// What is `t` of the way from a sample to the next.
pub(super) fn between(a: &Sample, b: &Sample, t: f32) -> Sample {
    Sample {
        position: a.position + (b.position - a.position) * t,
        pressure: a.pressure + (b.pressure - a.pressure) * t,
        time: a.time + (b.time - a.time) * t,
        tilt: a.tilt + (b.tilt - a.tilt) * t,
    }
}

/// The CV before a place on a stroke, and the sample there.
pub(super) fn at(samples: &[Sample], way: f32) -> Option<(usize, Sample)> {
    let ways = ways(samples);
    let i = ways.partition_point(|w| *w <= way).saturating_sub(1);
    let next = (i + 1).min(samples.len().saturating_sub(1));
    let gap = *ways.get(next)? - ways[i];
    let t = if gap > 0.0 { ((way - ways[i]) / gap).clamp(0.0, 1.0) } else { 0.0 };
    Some((i, between(&samples[i], &samples[next], t)))
}

/// The stroke with other samples, on the grid. It keeps what was drawn.
pub(super) fn edited(stroke: &Stroke, samples: Vec<Sample>) -> Stroke {
    if samples.is_empty() || !samples.iter().all(Sample::is_finite) {
        return stroke.clone();
    }
    let samples: Vec<Sample> = samples.iter().map(|s| Steps::of(s).sample()).collect();
    if samples == stroke.samples {
        return stroke.clone();
    }
    let (drawn, brush) = (as_drawn(stroke).to_vec(), stroke.brush.clone());
    Stroke { id: stroke.id, samples, drawn, brush }
}

/// The samples as they were drawn.
pub(super) fn as_drawn(stroke: &Stroke) -> &[Sample] {
    if stroke.drawn.is_empty() { &stroke.samples } else { &stroke.drawn }
}

/// How much each CV moves with the picked ones: these 1, others less with the way to the nearest
/// picked one, 0 from `reach` on. The reach ends at the root, so that only a picked root moves.
pub fn falloff(stroke: &Stroke, picked: &BTreeSet<usize>, reach: f32) -> Vec<f32> {
    let ways = ways(&stroke.samples);
    let mut weights = vec![0.0f32; ways.len()];
    let weigh = |way: f32, reach: f32| {
        let part = if reach > 0.0 { way / reach } else { f32::INFINITY };
        // Flat at both ends.
        if part < 1.0 { (1.0 - part * part) * (1.0 - part * part) } else { 0.0 }
    };
    let mut before = None;
    for (i, weight) in weights.iter_mut().enumerate() {
        if picked.contains(&i) {
            *weight = 1.0;
            before = Some(ways[i]);
        } else if let Some(from) = before {
            *weight = weigh(ways[i] - from, reach);
        }
    }
    let mut behind = None;
    for (i, weight) in weights.iter_mut().enumerate().rev() {
        if picked.contains(&i) {
            behind = Some(ways[i]);
        } else if let Some(from) = behind {
            let reach = if picked.contains(&0) { reach } else { reach.min(from) };
            *weight = weight.max(weigh(from - ways[i], reach));
        }
    }
    weights
}

/// Moves each CV by its weight's share of `by`.
pub fn moved(stroke: &Stroke, weights: &[f32], by: Vec3) -> Stroke {
    let mut samples = stroke.samples.clone();
    for (sample, weight) in samples.iter_mut().zip(weights) {
        sample.position += by * *weight;
    }
    edited(stroke, samples)
}

/// Puts CVs to places, by number: for moves on the scalp or in the plane of a view, which only the
/// caller knows. Numbers that no CV has are passed over.
pub fn placed(stroke: &Stroke, places: &[(usize, Vec3)]) -> Stroke {
    let mut samples = stroke.samples.clone();
    for (i, place) in places {
        if let Some(sample) = samples.get_mut(*i) {
            sample.position = *place;
        }
    }
    edited(stroke, samples)
}

/// Adds a CV at a place on the stroke, without changing its shape by more than the grid; gives its
/// number. Where there is one already, its number.
pub fn inserted(stroke: &Stroke, way: f32) -> Option<(Stroke, usize)> {
    let (i, sample) = at(&stroke.samples, way)?;
    let sample = Steps::of(&sample).sample();
    let near = [i, i + 1].into_iter();
    let same = |i: &usize| stroke.samples.get(*i).is_some_and(|s| s.position == sample.position);
    if let Some(i) = { near }.find(same) {
        return Some((stroke.clone(), i));
    }
    let mut samples = stroke.samples.clone();
    samples.insert(i + 1, sample);
    Some((edited(stroke, samples), i + 1))
}

/// Takes CVs out; none when fewer than two would remain, which are no stroke.
pub fn deleted(stroke: &Stroke, picked: &BTreeSet<usize>) -> Option<Stroke> {
    let samples = stroke.samples.iter().enumerate().filter(|(i, _)| !picked.contains(i));
    let samples: Vec<Sample> = samples.map(|(_, sample)| *sample).collect();
    (samples.len() >= 2).then(|| edited(stroke, samples))
}

/// Slides a CV along the stroke, towards the tip where `by` is positive, at most up to its
/// neighbours. Root and tip do not slide.
pub fn slid(stroke: &Stroke, cv: usize, by: f32) -> Stroke {
    let ways = ways(&stroke.samples);
    if cv == 0 || cv + 1 >= ways.len() || by == 0.0 || !by.is_finite() {
        return stroke.clone();
    }
    // A CV that lies on its neighbour is hard to pick again.
    const CLOSEST: f32 = 0.02;
    let (low, high) = (ways[cv - 1] + CLOSEST, ways[cv + 1] - CLOSEST);
    let way = ways[cv] + by;
    let way = if low < high { way.clamp(low, high) } else { ways[cv] };
    let mut samples = stroke.samples.clone();
    if let Some((_, sample)) = at(&stroke.samples, way) {
        samples[cv] = sample;
    }
    edited(stroke, samples)
}

/// Straightens the stroke between two CVs: 0 leaves it, 1 puts the CVs between on the straight line,
/// at the same shares of the way.
pub fn straightened(stroke: &Stroke, from: usize, to: usize, amount: f32) -> Stroke {
    let ways = ways(&stroke.samples);
    let (from, to) = (from.min(to), from.max(to).min(ways.len().saturating_sub(1)));
    if to <= from + 1 {
        return stroke.clone();
    }
    let (a, b) = (stroke.samples[from].position, stroke.samples[to].position);
    let whole = ways[to] - ways[from];
    let mut samples = stroke.samples.clone();
    for i in from + 1..to {
        let part = if whole > 0.0 { (ways[i] - ways[from]) / whole } else { 0.0 };
        let position = &mut samples[i].position;
        *position += (a + (b - a) * part - *position) * amount.clamp(0.0, 1.0);
    }
    edited(stroke, samples)
}

/// Moves each CV but root and tip towards the straight line between its neighbours, by its weight
/// (0 to 1). Straight strokes stay as they are, and CVs as far apart. To be repeated at will.
pub fn smoothed(stroke: &Stroke, weights: &[f32]) -> Stroke {
    let mut samples = stroke.samples.clone();
    for (i, three) in stroke.samples.windows(3).enumerate() {
        let [a, p, b] = [three[0].position, three[1].position, three[2].position];
        let (before, behind) = (p.distance(a), b.distance(p));
        if before + behind > 0.0 {
            let middle = a + (b - a) * (before / (before + behind));
            let weight = weights.get(i + 1).copied().unwrap_or_default().clamp(0.0, 1.0);
            // All the way would let neighbours swap sides for ever.
            samples[i + 1].position += (middle - p) * (0.5 * weight);
        }
    }
    edited(stroke, samples)
}

/// Goes back to the stroke as it was drawn.
pub fn refitted(stroke: &Stroke) -> Stroke {
    Stroke::new(stroke.id, as_drawn(stroke).to_vec())
}

/// The stroke on the other side of the head, with an id of its own among `others`.
pub fn mirrored(stroke: &Stroke, others: &Strokes) -> Stroke {
    let mirror = |samples: &[Sample]| {
        let mut samples = samples.to_vec();
        for sample in &mut samples {
            // Not -0.0, which is written in no way of its own.
            sample.position.x = 0.0 - sample.position.x;
            sample.tilt.x = 0.0 - sample.tilt.x;
        }
        samples
    };
    let samples = mirror(&stroke.samples);
    let (id, drawn) = (free_id(&samples, others), mirror(&stroke.drawn));
    Stroke { id, samples, drawn, brush: stroke.brush.clone() }
}
