//! What brushes and dragged points do to strokes: functions from samples to samples.
//!
//! Points are moved in the world and kept in the head's frame. Those of strokes that lie on the scalp keep their height
//! over it. Pressure, time and tilt stay with their points.

use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::{Sample, Stroke};
use glam::Vec3;
use std::collections::BTreeSet;

/// A stroke with other points, which remembers how it was drawn.
pub(crate) fn edited(stroke: &Stroke, samples: Vec<Sample>) -> Stroke {
    let drawn = if stroke.drawn.is_empty() { &stroke.samples } else { &stroke.drawn };
    Stroke { id: stroke.id, samples, drawn: drawn.clone() }
}

/// How much each point goes along when some are moved: 1 for those, falling to 0 at `falloff` (head units) along the
/// stroke.
pub(crate) fn weights(samples: &[Sample], moved: &BTreeSet<usize>, falloff: f32) -> Vec<f32> {
    let mut at = vec![0.0f32];
    for w in samples.windows(2) {
        at.push(at[at.len() - 1] + w[0].position.distance(w[1].position));
    }
    let weight = |i: usize| {
        if moved.contains(&i) {
            return 1.0;
        }
        let nearest = moved.iter().filter_map(|m| at.get(*m)).map(|s| (s - at[i]).abs());
        bump(nearest.fold(f32::MAX, f32::min), falloff)
    };
    (0..samples.len()).map(weight).collect()
}

/// 1 in the middle, 0 from `reach` on, smooth.
fn bump(distance: f32, reach: f32) -> f32 {
    let x = if reach > 0.0 { (distance / reach).min(1.0) } else { 1.0 };
    (1.0 - x * x) * (1.0 - x * x)
}

/// A point moved by `by`; on the scalp it keeps its height.
pub(crate) fn moved(scalp: &Scalp, p: Vec3, by: Vec3, on_scalp: bool) -> Vec3 {
    let to = p + by;
    if !on_scalp || by == Vec3::ZERO {
        return to;
    }
    let (Some(from), Some(root)) = (scalp.closest_root(p), scalp.closest_root(to)) else {
        return to;
    };
    root.point + root.normal * (p - from.point).dot(from.normal)
}

/// A pass of a brush.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// Where it is on the scalp, cm.
    pub(crate) at: Vec3,
    /// How far it came since the last sample, cm.
    pub(crate) by: Vec3,
    /// cm.
    pub(crate) radius: f32,
    /// 0 to 1.
    pub(crate) strength: f32,
    /// Whether strokes lie on the scalp.
    pub(crate) on_scalp: bool,
}

/// The stroke combed the way of the brush; none when the brush does not reach it. Roots stay.
pub(crate) fn combed(scalp: &Scalp, stroke: &Stroke, pass: &Pass) -> Option<Stroke> {
    brushed(scalp, stroke, pass, |_, _, _| Some(pass.by))
}

/// The stroke with its wiggles taken out under the brush; none when the brush does not reach it. Both ends stay.
pub(crate) fn smoothed(scalp: &Scalp, stroke: &Stroke, pass: &Pass) -> Option<Stroke> {
    brushed(scalp, stroke, pass, |before, here, after| Some((before + after?) * 0.5 - here))
}

fn brushed(
    scalp: &Scalp,
    stroke: &Stroke,
    pass: &Pass,
    way: impl Fn(Vec3, Vec3, Option<Vec3>) -> Option<Vec3>,
) -> Option<Stroke> {
    let frame = scalp.frame();
    let world = |s: &Sample| frame.point_from_head(s.position);
    let mut samples = stroke.samples.clone();
    let mut reached = false;
    for i in 1..samples.len() {
        let (before, here) = (world(&stroke.samples[i - 1]), world(&stroke.samples[i]));
        let weight = bump(here.distance(pass.at), pass.radius) * pass.strength;
        if weight <= 0.0 {
            continue;
        }
        let after = stroke.samples.get(i + 1).map(world);
        if let Some(by) = way(before, here, after) {
            let to = moved(scalp, here, by * weight, pass.on_scalp);
            samples[i].position = frame.head_from_point(to);
            reached = true;
        }
    }
    reached.then(|| edited(stroke, samples))
}

/// The stroke with a point in the middle between two; none at the end.
pub(crate) fn inserted(stroke: &Stroke, behind: usize) -> Option<Stroke> {
    let (a, b) = (stroke.samples.get(behind)?, stroke.samples.get(behind + 1)?);
    let middle = Sample {
        position: (a.position + b.position) * 0.5,
        pressure: (a.pressure + b.pressure) * 0.5,
        time: (a.time + b.time) * 0.5,
        tilt: (a.tilt + b.tilt) * 0.5,
    };
    let mut samples = stroke.samples.clone();
    samples.insert(behind + 1, middle);
    Some(edited(stroke, samples))
}

/// The stroke with the part beside `line` replaced by it, from the point nearest to where the line begins to the one
/// nearest to where it ends. A line that leads the other way is turned. What lies beyond a line that leaves the end of the
/// stroke behind is the line's.
pub(crate) fn redrawn(stroke: &Stroke, line: &[Sample]) -> Option<Stroke> {
    let nearest = |p: Vec3| {
        let distance = |i: &usize| stroke.samples[*i].position.distance_squared(p);
        (0..stroke.samples.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let (from, to) = (nearest(line.first()?.position)?, nearest(line.last()?.position)?);
    let mut part = line.to_vec();
    if to < from {
        part.reverse();
    }
    let (from, to) = (from.min(to), from.max(to));
    let mut samples = stroke.samples[..from].to_vec();
    samples.extend(part);
    samples.extend_from_slice(&stroke.samples[to + 1..]);
    in_time(&mut samples);
    Some(edited(stroke, samples))
}

/// Gives samples times that never go back, from 0 on.
fn in_time(samples: &mut [Sample]) {
    let mut before = (0.0f32, 0.0f32);
    for (i, sample) in samples.iter_mut().enumerate() {
        let step = if i == 0 { 0.0 } else { (sample.time - before.0).max(0.0) };
        before = (sample.time, before.1 + step);
        sample.time = before.1;
    }
}
