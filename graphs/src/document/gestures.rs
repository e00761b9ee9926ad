//! Pen gestures as documents keep them: simplified and on a grid, so that live and replay have the same
//! bits.
//!
//! A gesture is finished once, at pen-up, before it is first evaluated ([`finish`]); from then on its
//! samples and its path are on the grid of [`on_the_grid`], in which files hold them exactly. View,
//! root, colour, size and strength are kept as they are.

use super::strokes::{
    LONGEST, PRESSURE_STEPS, STEPS_PER_SECOND, TILT_STEPS, new_id, simplify, steps, value,
};
use coif_nodes::data::gestures::{Gesture, Gestures, PenSample};
use coif_nodes::data::strokes::Sample;
use coif_nodes::maths::hash::KeyBuilder;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// How far the kept samples may lie from the pen's, absolute, in pixels: less shows in no picture, and
/// keeps the tremor of a hand.
pub const TOLERANCE: f32 = 0.5;

/// Steps of a position on the grid in one pixel: the rounding of two coordinates moves a sample by at
/// most 0.0884 pixels, which is taken out of [`TOLERANCE`].
const STEPS_PER_PIXEL: f64 = 8.0;
/// What simplifying may use of [`TOLERANCE`] once rounding has had its share.
const SHARE: f32 = 0.41;
/// Steps of a path in one head unit: a hair's width.
const STEPS_PER_UNIT: f64 = 10_000.0;
/// Farther off than any gesture may be drawn (pixels) or any path lead (head units).
const FARTHEST: f64 = 1e5;

/// A sample in whole steps of the grid: right, down, pressure, time, tilt.
pub(crate) fn sample_steps(sample: &PenSample) -> [i64; 6] {
    let [x, y] = sample.at.to_array().map(|x| steps(x, STEPS_PER_PIXEL, FARTHEST));
    let pressure = steps(sample.pressure, PRESSURE_STEPS, 1.0).max(0);
    let time = steps(sample.time, STEPS_PER_SECOND, LONGEST).max(0);
    let [right, near] = sample.tilt.to_array().map(|x| steps(x, TILT_STEPS, 1.0));
    [x, y, pressure, time, right, near]
}

/// The sample of whole steps. One too far off stays so, to be refused as such.
pub(crate) fn sample_of([x, y, pressure, time, right, near]: [i64; 6]) -> PenSample {
    let [x, y] = [x, y].map(|x| value(x, STEPS_PER_PIXEL, f64::MAX));
    PenSample {
        at: Vec2::new(x, y),
        pressure: value(pressure, PRESSURE_STEPS, 1.0).max(0.0),
        time: value(time, STEPS_PER_SECOND, LONGEST).max(0.0),
        tilt: Vec2::new(value(right, TILT_STEPS, 1.0), value(near, TILT_STEPS, 1.0)),
    }
}

/// A point of a path in whole steps of the grid.
pub(crate) fn point_steps(point: Vec3) -> [i64; 3] {
    point.to_array().map(|x| steps(x, STEPS_PER_UNIT, FARTHEST))
}

/// The point of whole steps. One too far off stays so, to be refused as such.
pub(crate) fn point_of(at: [i64; 3]) -> Vec3 {
    Vec3::from(at.map(|x| value(x, STEPS_PER_UNIT, f64::MAX)))
}

/// What the grid makes of a sample; none where it is on it or cannot be, and is to be refused as such.
fn moved_sample(s: &PenSample) -> Option<PenSample> {
    let finite =
        s.at.is_finite() && s.pressure.is_finite() && s.time.is_finite() && s.tilt.is_finite();
    let near = f64::from(s.at.abs().max_element()) <= FARTHEST;
    let on = sample_of(sample_steps(s));
    // By bits: -0.0 is none of the grid's.
    (finite && near && bytemuck::bytes_of(&on) != bytemuck::bytes_of(s)).then_some(on)
}

/// The same for a point of a path.
fn moved_point(p: Vec3) -> Option<Vec3> {
    let near = p.is_finite() && f64::from(p.abs().max_element()) <= FARTHEST;
    let on = point_of(point_steps(p));
    (near && on.to_array().map(f32::to_bits) != p.to_array().map(f32::to_bits)).then_some(on)
}

fn to_the_grid(gesture: &mut Gesture) {
    for sample in &mut gesture.samples {
        *sample = moved_sample(sample).unwrap_or(*sample);
    }
    for point in &mut gesture.path {
        *point = moved_point(*point).unwrap_or(*point);
    }
}

/// The gestures with every sample and path on the grid: the same `Arc` when they are already. What is
/// not finite or too far off is left as it is, to be refused as such.
pub fn on_the_grid(gestures: Arc<Gestures>) -> Arc<Gestures> {
    let is_kept = |gesture: &Gesture| {
        gesture.samples.iter().all(|s| moved_sample(s).is_none())
            && gesture.path.iter().all(|p| moved_point(*p).is_none())
    };
    if gestures.0.iter().all(is_kept) {
        return gestures;
    }
    let mut gestures = Arc::unwrap_or_clone(gestures);
    gestures.0.iter_mut().for_each(to_the_grid);
    Arc::new(gestures)
}

/// A finished gesture from what the pen gave: simplified, on the grid, with an id of its own among
/// `others`, whatever id it came with.
///
/// Every sample given lies within [`TOLERANCE`] of the gesture; first and last samples stay, and time
/// never runs backwards. Samples that are not finite are left out. None when nothing remains, or when
/// it could not be used ([`Gesture::fault`]).
pub fn finish(gesture: Gesture, others: &Gestures) -> Option<Gesture> {
    let mut latest = 0.0f32;
    let mut given: Vec<Sample> = gesture.samples.iter().map(in_space).collect();
    given.retain(Sample::is_finite);
    for sample in &mut given {
        latest = latest.max(sample.time);
        sample.time = latest;
    }
    let kept = simplify(&given, SHARE).into_iter().map(|i| &given[i]);
    let samples = kept.map(|s| sample_of(sample_steps(&in_picture(s)))).collect();
    let mut gesture = Gesture { id: 0, samples, ..gesture };
    to_the_grid(&mut gesture);
    let content = gesture.key();
    let key = |n: u64| KeyBuilder::new("gesture id").int(n).key(content).finish();
    gesture.id = new_id(key, |id| others.0.iter().any(|other| other.id == id));
    gesture.fault().is_none().then_some(gesture)
}

/// A sample of a picture as one of a stroke, in pixels, which is simplified in the same way.
fn in_space(s: &PenSample) -> Sample {
    Sample { position: s.at.extend(0.0), pressure: s.pressure, time: s.time, tilt: s.tilt }
}
fn in_picture(s: &Sample) -> PenSample {
    PenSample { at: s.position.truncate(), pressure: s.pressure, time: s.time, tilt: s.tilt }
}

#[cfg(test)]
mod tests;
