//! A hand that draws for tests: strokes from parameters, with tremor, noise and speed.

use crate::data::gestures::PenSample;
use crate::maths::hash::Dice;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec2;

/// How a stroke is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hand {
    /// Pixels between samples: how fast it is.
    pub spacing: f32,
    /// Amplitude of its tremor, pixels, at 9 a second.
    pub tremor: f32,
    /// The most that a sample is off, pixels.
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

impl Hand {
    /// A hand without faults.
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

    /// The places of the stroke alone.
    pub(crate) fn places(self, line: &[Vec2]) -> Vec<Vec2> {
        self.draw(line).iter().map(|s| s.at).collect()
    }
}

/// A line of 1000 steps.
fn line(at: impl Fn(f32) -> Vec2) -> Vec<Vec2> {
    (0..=1000).map(|i| at(i as f32 / 1000.0)).collect()
}

/// Turns clockwise (counter-clockwise: less than 0) on an ellipse of half axes `radius` and `radius * flat`, tilted, from a phase,
/// whose middle drifts by `drift` a turn.
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

/// To and fro along a direction, as wide as `width` from side to side, with so many reversals; at each swing it leads on by
/// `advance` across. `bend`, in turns: how far the way on turns over the whole. Round at its ends, or sharp.
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

/// A line so long that turns at an even rate, clockwise by `turns` (and back by the second ones after its half).
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

/// A spiral outwards or inwards: from one radius to another over so many turns.
pub(crate) fn spiral(from: f32, to: f32, turns: f32, phase: f32) -> Vec<Vec2> {
    line(|t| turn(phase + turns * t) * (from + (to - from) * t))
}

/// A straight line whose bow is a share of it, and which waves from side to side so often by a share of it.
pub(crate) fn bow(length: f32, direction: f32, bow: f32, wave: f32, times: f32) -> Vec<Vec2> {
    line(|t| {
        let off = bow * 4.0 * t * (1.0 - t) + wave * turn(times * t).y;
        turn(direction).rotate(Vec2::new(t, off) * length)
    })
}
