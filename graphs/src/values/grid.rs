//! The grid on which files hold what is drawn: whole steps of place, pressure, time and tilt, so that live and replay have the same
//! bits.
//!
//! Guarantees: what is on the grid stays as it is, to the bit. What is not finite or too far off is left as it is, to be refused as
//! such.

use coif_nodes::data::gestures::{Gesture, Gestures, PenSample};
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Steps of a position on the grid in one cm. With 0.01 cm the rounding of three coordinates moves
/// a sample by at most 0.0087 cm, which is taken out of `document::strokes::TOLERANCE`.
const STEPS_PER_CM: f64 = 100.0;
/// Steps of pressure: as many as the cheapest pens report.
const PRESSURE_STEPS: f64 = 256.0;
/// Steps of time in a second: pens report at most each millisecond.
const STEPS_PER_SECOND: f64 = 1000.0;
/// Steps of tilt in a right angle: 1.4 degrees, finer than any hand.
const TILT_STEPS: f64 = 64.0;
/// Steps of a position on the grid in one pixel: the rounding of two coordinates moves a sample by at
/// most 0.0884 pixels, which is taken out of `document::gestures::TOLERANCE`.
const STEPS_PER_PIXEL: f64 = 8.0;
/// Steps of a path in one head unit: a hair's width.
const STEPS_PER_UNIT: f64 = 10_000.0;
/// Farther off than anything drawn: cm from the head's centre, pixels in a picture, head units along a path. Near enough for
/// exact sums.
const FARTHEST: f64 = 1e5;
/// Longer than anybody draws (seconds).
const LONGEST: f64 = 1e5;

/// A sample in whole steps of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Steps(pub(crate) [i64; 7]);

/// Nearest step; values beyond `most` are moved to it, NaN to 0.
fn steps(x: f32, per_unit: f64, most: f64) -> i64 {
    (f64::from(x).clamp(-most, most) * per_unit).round() as i64
}
fn value(steps: i64, per_unit: f64, most: f64) -> f32 {
    (steps as f64 / per_unit).clamp(-most, most) as f32
}

impl Steps {
    pub(crate) fn of(sample: &Sample) -> Self {
        let [x, y, z] = sample.position.to_array().map(|x| steps(x, STEPS_PER_CM, FARTHEST));
        let pressure = steps(sample.pressure, PRESSURE_STEPS, 1.0).max(0);
        let time = steps(sample.time, STEPS_PER_SECOND, LONGEST).max(0);
        let [right, near] = sample.tilt.to_array().map(|x| steps(x, TILT_STEPS, 1.0));
        Self([x, y, z, pressure, time, right, near])
    }
    pub(crate) fn sample(self) -> Sample {
        let [x, y, z, pressure, time, right, near] = self.0;
        let [x, y, z] = [x, y, z].map(|x| value(x, STEPS_PER_CM, FARTHEST));
        Sample {
            position: Vec3::new(x, y, z),
            pressure: value(pressure, PRESSURE_STEPS, 1.0).max(0.0),
            time: value(time, STEPS_PER_SECOND, LONGEST).max(0.0),
            tilt: Vec2::new(value(right, TILT_STEPS, 1.0), value(near, TILT_STEPS, 1.0)),
        }
    }
}

/// The strokes with every sample on the grid: the same `Arc` when they are already. Samples that
/// are not finite are left as they are, to be refused as such.
pub fn strokes_on_grid(strokes: Arc<Strokes>) -> Arc<Strokes> {
    // By bits: -0.0 is none of the grid's.
    let same = |a: &Sample, b: &Sample| bytemuck::bytes_of(a) == bytemuck::bytes_of(b);
    let on_grid = |s: &Sample| !s.is_finite() || same(&Steps::of(s).sample(), s);
    let is_kept =
        |stroke: &Stroke| stroke.samples.iter().all(on_grid) && stroke.drawn.iter().all(on_grid);
    if strokes.0.iter().all(is_kept) {
        return strokes;
    }
    let mut strokes = Arc::unwrap_or_clone(strokes);
    for stroke in &mut strokes.0 {
        for sample in stroke.samples.iter_mut().chain(&mut stroke.drawn) {
            if sample.is_finite() {
                *sample = Steps::of(sample).sample();
            }
        }
    }
    Arc::new(strokes)
}

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

/// Brings samples and path of a gesture to the grid.
pub(crate) fn gesture_to_grid(gesture: &mut Gesture) {
    for sample in &mut gesture.samples {
        *sample = moved_sample(sample).unwrap_or(*sample);
    }
    for point in &mut gesture.path {
        *point = moved_point(*point).unwrap_or(*point);
    }
}

/// The gestures with every sample and path on the grid: the same `Arc` when they are already. What is
/// not finite or too far off is left as it is, to be refused as such.
pub fn gestures_on_grid(gestures: Arc<Gestures>) -> Arc<Gestures> {
    let is_kept = |gesture: &Gesture| {
        gesture.samples.iter().all(|s| moved_sample(s).is_none())
            && gesture.path.iter().all(|p| moved_point(*p).is_none())
    };
    if gestures.0.iter().all(is_kept) {
        return gestures;
    }
    let mut gestures = Arc::unwrap_or_clone(gestures);
    gestures.0.iter_mut().for_each(gesture_to_grid);
    Arc::new(gestures)
}
