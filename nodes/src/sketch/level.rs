//! The layer of a stroke, from the pressure at its beginning (the paper's section 4).
//!
//! Guarantees: nothing after the beginning changes the result; samples before the pen touches do not count, and neither
//! do non-finite pressures. Not known here: a layer set by a key or the toolbar.

use crate::data::gestures::{Layer, PenSample};

/// How the beginning of a stroke determines its layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// The deepest level within the first 80 ms or the first 12 pixels, whichever takes longer: real pens start light,
    /// a quick hand has moved 12 pixels before it presses, and a slow one has not within 80 ms.
    #[default]
    Highest,
    /// The rule of the paper: the level of the mean pressure within 2 pixels of the start.
    Mean,
}

/// Length of the beginning for [`Rule::Highest`], seconds and pixels.
const BEGINS: (f32, f32) = (0.08, 12.0);
/// Length of the beginning for [`Rule::Mean`], pixels.
const NEAR: f32 = 2.0;

/// The layer of a stroke, or of its part so far. A stroke that never touches works on the nearest.
pub fn level(samples: &[PenSample], rule: Rule) -> Layer {
    // (NaN is not a touch.)
    let touches = |sample: &PenSample| sample.pressure > 0.0;
    let first = samples.iter().position(touches).unwrap_or(samples.len());
    let Some(start) = samples.get(first) else { return Layer::Nearest };
    let within = |sample: &&PenSample, reach: f32| sample.at.distance(start.at) <= reach;
    let begins = |sample: &&PenSample| match rule {
        Rule::Highest => sample.time - start.time <= BEGINS.0 || within(sample, BEGINS.1),
        Rule::Mean => within(sample, NEAR),
    };
    let pressures = samples[first..].iter().take_while(begins).map(|sample| sample.pressure);
    let pressures = pressures.filter(|pressure| pressure.is_finite());
    Layer::of_pressure(match rule {
        Rule::Highest => pressures.fold(0.0, f32::max),
        Rule::Mean => {
            let (sum, count) = pressures.fold((0.0, 0), |(sum, n), p| (sum + p, n + 1));
            sum / count.max(1) as f32
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    /// Samples as time (ms), pixels from the start, and pressure.
    #[track_caller]
    fn check(samples: &[(f32, f32, f32)], highest: Layer, mean: Layer) {
        let sample = |&(ms, x, pressure): &(f32, f32, f32)| PenSample {
            at: Vec2::new(x, 0.0),
            pressure,
            time: ms * 1e-3,
            ..Default::default()
        };
        let samples: Vec<PenSample> = samples.iter().map(sample).collect();
        let found = [Rule::Highest, Rule::Mean].map(|rule| level(&samples, rule));
        assert_eq!(found, [highest, mean], "{samples:?}");
    }

    #[test]
    fn three_equal_levels_are_told_by_the_mean_within_two_pixels_as_in_the_paper() {
        use Layer::{Nearest, Scalp, Through};
        // A third and two thirds of the range are the borders.
        for (pressure, layer) in [
            (0.1, Nearest),
            (0.33, Nearest),
            (0.34, Through),
            (0.66, Through),
            (0.67, Scalp),
            (1.0, Scalp),
        ] {
            check(&[(0.0, 0.0, pressure), (10.0, 1.0, pressure)], layer, layer);
        }
        // (0.2 + 0.9) / 2 = 0.55; samples 3 pixels away do not count: with them the mean would be 0.7.
        check(&[(0.0, 0.0, 0.2), (5.0, 2.0, 0.9), (9.0, 3.0, 1.0)], Scalp, Through);
        // Back at the start, the beginning is over.
        check(&[(0.0, 0.0, 0.2), (90.0, 40.0, 0.2), (200.0, 0.0, 1.0)], Nearest, Nearest);
    }

    #[test]
    fn the_highest_level_of_the_first_80_ms_or_12_pixels_counts() {
        use Layer::{Nearest, Scalp, Through};
        // A quick hand has moved 60 pixels when it presses, after 40 ms.
        check(&[(0.0, 0.0, 0.1), (10.0, 15.0, 0.2), (40.0, 60.0, 0.8)], Scalp, Nearest);
        // A slow one has moved 11 pixels in 300 ms.
        check(&[(0.0, 0.0, 0.1), (150.0, 5.0, 0.2), (300.0, 11.0, 0.5)], Through, Nearest);
        // Beyond both, nothing counts.
        check(&[(0.0, 0.0, 0.1), (79.0, 60.0, 0.5), (82.0, 70.0, 1.0)], Through, Nearest);
        check(&[(0.0, 0.0, 0.5), (300.0, 13.0, 1.0)], Through, Through);
        // A pen that lets up keeps working at its pressed depth.
        check(&[(0.0, 0.0, 0.9), (20.0, 20.0, 0.1)], Scalp, Scalp);
    }

    #[test]
    fn before_it_touches_a_pen_says_nothing() {
        use Layer::{Nearest, Scalp, Through};
        // It hovers for half a second, 40 pixels away. (0.2 + 0.6) / 2 = 0.4.
        let hovers = [(0.0, 0.0, 0.0), (500.0, 40.0, 0.0)];
        let touches = [(510.0, 41.0, 0.2), (540.0, 42.0, 0.6), (585.0, 60.0, 0.9)];
        check(&[&hovers[..], &touches].concat(), Scalp, Through);
        check(&hovers, Nearest, Nearest);
        check(&[], Nearest, Nearest);
        check(&[(0.0, 0.0, f32::NAN), (9.0, 1.0, 0.5), (12.0, 1.0, f32::NAN)], Through, Through);
    }
}
