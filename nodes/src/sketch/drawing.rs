//! A simulated hand for tests: strokes from parameters, with tremor, noise and speed.

use crate::data::gestures::PenSample;
use crate::maths::hash::Dice;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec2;

/// Manner of drawing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawingStyle {
    /// Pixels between samples: its speed.
    pub spacing: f32,
    /// Amplitude of its tremor, pixels, at 9 Hz.
    pub tremor: f32,
    /// Largest noise of a sample, pixels.
    pub noise: f32,
    pub seed: u64,
}

/// Seconds between samples.
pub(crate) const TICK: f32 = 1.0 / 133.0;

/// A unit vector, turns clockwise from right.
pub(crate) fn turn(turns: f32) -> Vec2 {
    let (sin, cos) = sin_cos_turns(turns);
    Vec2::new(cos, sin)
}

impl DrawingStyle {
    /// A hand without noise or tremor.
    pub(crate) fn still(spacing: f32) -> Self {
        Self { spacing, tremor: 0.0, noise: 0.0, seed: 0 }
    }

    /// The stroke along a line, at one speed.
    pub(crate) fn draw(self, line: &[Vec2]) -> Vec<PenSample> {
        let mut places = vec![line[0]];
        let mut left = self.spacing;
        for w in line.windows(2) {
            let length = w[0].distance(w[1]);
            let mut along = left;
            while along <= length {
                places.push(w[0].lerp(w[1], along / length));
                along += self.spacing;
            }
            left = along - length;
        }
        if left < self.spacing {
            places.push(line[line.len() - 1]);
        }
        let dice = Dice::new(self.seed, 0, "hand");
        let (start, lean) = (dice.unit(0, 0), dice.unit(0, 1));
        let sample = |(i, at): (usize, &Vec2)| {
            let time = i as f32 * TICK;
            let shake = turn(lean) * turn(start + time * 9.0).x
                + turn(lean + 0.25) * turn(start + time * 9.0).y * 0.5;
            let off = Vec2::new(dice.signed(1, i as u64), dice.signed(2, i as u64));
            let at = *at + shake * self.tremor + off * self.noise;
            PenSample { at, pressure: 0.5, time, tilt: turn(lean) * 0.4 }
        };
        places.iter().enumerate().map(sample).collect()
    }

    /// The positions of the stroke only.
    pub(crate) fn places(self, line: &[Vec2]) -> Vec<Vec2> {
        self.draw(line).iter().map(|s| s.at).collect()
    }
}

/// A line of 1000 steps.
fn line(at: impl Fn(f32) -> Vec2) -> Vec<Vec2> {
    (0..=1000).map(|i| at(i as f32 / 1000.0)).collect()
}

/// Turns clockwise (negative: counterclockwise) on an ellipse with half axes `radius` and `radius * flat`, tilted, with
/// a phase and a centre that drifts by `drift` per turn.
pub(crate) fn coil(
    radius: f32,
    flat: f32,
    tilt: f32,
    turns: f32,
    phase: f32,
    drift: Vec2,
) -> Vec<Vec2> {
    line(|t| {
        let p = turn(phase + turns * t) * Vec2::new(radius, radius * flat);
        turn(tilt).rotate(p) + drift * (turns.abs() * t)
    })
}

/// Back and forth along a direction, `width` wide from side to side, with this many reversals; each swing advances by
/// `advance` across. `bend`, in turns: total turn of the direction of advance. Round or sharp at its ends.
pub(crate) fn zigzag(
    width: f32,
    reversals: u32,
    direction: f32,
    advance: f32,
    bend: f32,
    sharp: bool,
) -> Vec<Vec2> {
    let swings = reversals as f32;
    let side = |t: f32| {
        let phase = t * swings;
        let saw = 1.0 - 4.0 * ((phase * 0.5 - 0.25).rem_euclid(1.0) - 0.5).abs();
        if sharp { saw } else { turn(phase * 0.5).y }
    };
    let mut middle = Vec2::ZERO;
    (0..=1000)
        .map(|i| {
            let t = i as f32 / 1000.0;
            let across = turn(direction + bend * t);
            middle += across.perp() * (advance * swings / 1000.0);
            middle + across * (side(t) * width * 0.5)
        })
        .collect()
}

/// A line of this length that turns at a constant rate, clockwise by `turns` (and back by the second value after its
/// half).
pub(crate) fn arc(length: f32, direction: f32, turns: [f32; 2]) -> Vec<Vec2> {
    let mut at = Vec2::ZERO;
    (0..=1000)
        .map(|i| {
            let t = i as f32 / 1000.0;
            let bend = turns[0] * (t * 2.0).min(1.0) + turns[1] * (t * 2.0 - 1.0).max(0.0);
            at += turn(direction + bend) * (length / 1000.0);
            at
        })
        .collect()
}

/// A spiral outward or inward: from one radius to another over this many turns.
pub(crate) fn spiral(from: f32, to: f32, turns: f32, phase: f32) -> Vec<Vec2> {
    line(|t| turn(phase + turns * t) * (from + (to - from) * t))
}

/// A straight line with a bow that is a fraction of its length, and a side-to-side wave of a given count and relative
/// size.
pub(crate) fn bow(length: f32, direction: f32, bow: f32, wave: f32, times: f32) -> Vec<Vec2> {
    line(|t| {
        let off = bow * 4.0 * t * (1.0 - t) + wave * turn(times * t).y;
        turn(direction).rotate(Vec2::new(t, off) * length)
    })
}
