//! Pen gestures as documents keep them: simplified and on a grid, so that live and replay have the same
//! bits.
//!
//! A gesture is finished once, at pen-up, before it is first evaluated ([`finish`]); from then on its
//! samples and its path are on the grid in which files hold them exactly (`values/grid.rs`). View, root,
//! colour, size and strength are kept as they are.

use super::strokes::{new_id, simplify};
use crate::values::grid::{gesture_to_grid, sample_of, sample_steps};
use coif_nodes::data::gestures::{Gesture, Gestures, PenSample};
use coif_nodes::data::strokes::Sample;
use coif_nodes::maths::hash::KeyBuilder;

/// How far the kept samples may lie from the pen's, absolute, in pixels: less shows in no picture, and
/// keeps the tremor of a hand.
pub const TOLERANCE: f32 = 0.5;

/// What simplifying may use of [`TOLERANCE`] once rounding has had its share.
const SHARE: f32 = 0.41;

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
    gesture_to_grid(&mut gesture);
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
