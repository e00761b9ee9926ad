//! A function of a fraction from 0 to 1, such as root to tip.

use crate::maths::hash::KeyBuilder;
use crate::maths::lanes::{self, Simd, f32x8, ops::*};
use crate::maths::smoothstep;

/// Interpolation between stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// Holds the left stop's value up to the next stop.
    Step,
    /// Straight.
    Linear,
    /// Smoothstep: flat at every stop.
    Smooth,
}

/// Stops (position, value), with ascending positions in [0, 1]; the end values hold outside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// Interpolation between stops.
    pub blend: Blend,
    /// **Invariant:** at least one, positions non-decreasing, all finite.
    stops: Vec<(f32, f32)>,
}

/// Why stops do not form a ramp.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a ramp needs at least one stop, finite numbers, and positions from 0 to 1 that do not fall"
)]
pub struct BadRamp;

impl Ramp {
    /// A ramp through these stops.
    pub fn new(blend: Blend, stops: Vec<(f32, f32)>) -> Result<Self, BadRamp> {
        let finite = stops.iter().all(|(x, y)| x.is_finite() && y.is_finite());
        let rising = stops.windows(2).all(|w| w[0].0 <= w[1].0);
        let within = stops.iter().all(|(x, _)| (0.0..=1.0).contains(x));
        if stops.is_empty() || !finite || !rising || !within {
            return Err(BadRamp);
        }
        Ok(Self { blend, stops })
    }
    /// A ramp that is `value` everywhere.
    pub fn constant(value: f32) -> Self {
        Self { blend: Blend::Linear, stops: vec![(0.0, value)] }
    }
    /// A smooth ramp between two values.
    pub fn smooth(from: f32, to: f32) -> Self {
        Self { blend: Blend::Smooth, stops: vec![(0.0, from), (1.0, to)] }
    }
    /// A linear ramp between two values.
    pub fn linear(from: f32, to: f32) -> Self {
        Self { blend: Blend::Linear, stops: vec![(0.0, from), (1.0, to)] }
    }
    /// The same ramp with values from `lo` to `hi`.
    pub fn clamped(&self, lo: f32, hi: f32) -> Self {
        let mut ramp = self.clone();
        ramp.stops.iter_mut().for_each(|(_, y)| *y = y.clamp(lo, hi));
        ramp
    }
    /// The stops.
    pub fn stops(&self) -> &[(f32, f32)] {
        &self.stops
    }
    /// The value at `x`.
    #[inline]
    pub fn at(&self, x: f32) -> f32 {
        let after = self.stops.partition_point(|(position, _)| *position <= x);
        if after == 0 {
            return self.stops[0].1;
        }
        let (x0, y0) = self.stops[after - 1];
        let Some((x1, y1)) = self.stops.get(after).copied() else { return y0 };
        let t = (x - x0) / (x1 - x0);
        match self.blend {
            Blend::Step => y0,
            Blend::Linear => y0 + (y1 - y0) * t,
            Blend::Smooth => y0 + (y1 - y0) * smoothstep(t),
        }
    }
    /// [`Self::at`] in lanes.
    #[inline(always)]
    pub(crate) fn at_each<S: Simd>(&self, x: f32x8<S>) -> f32x8<S> {
        let mut y = x.simd.splat_f32x8(self.stops[0].1);
        for (i, (x0, y0)) in self.stops.iter().enumerate() {
            let reached = x.simd_ge(*x0);
            if x.simd.all_false_mask32x8(reached) {
                break;
            }
            let on = match (self.stops.get(i + 1), self.blend) {
                (None, _) | (_, Blend::Step) => x.simd.splat_f32x8(*y0),
                (Some((x1, y1)), blend) => {
                    let t = (x - *x0) / (x1 - x0);
                    let t = if blend == Blend::Smooth { lanes::smoothstep(t) } else { t };
                    *y0 + (y1 - y0) * t
                }
            };
            y = lanes::pick(reached, on, y);
        }
        y
    }
    /// Adds the ramp to a key.
    pub fn add_to(&self, key: KeyBuilder) -> KeyBuilder {
        let key = key.int(self.blend as u64).int(self.stops.len() as u64);
        self.stops.iter().fold(key, |key, (x, y)| key.float(*x).float(*y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_its_ends_and_meets_its_stops() {
        let stops = vec![(0.2, 1.0), (0.6, 3.0), (0.8, 2.0)];
        for blend in [Blend::Step, Blend::Linear, Blend::Smooth] {
            let ramp = Ramp::new(blend, stops.clone()).unwrap();
            assert_eq!((ramp.at(0.0), ramp.at(1.0)), (1.0, 2.0));
            assert_eq!(ramp.at(0.6), 3.0);
        }
        let linear = Ramp::new(Blend::Linear, stops).unwrap();
        assert!((linear.at(0.4) - 2.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_ramp_is_refused() {
        for stops in [vec![], vec![(0.5, 1.0), (0.4, 1.0)], vec![(0.0, f32::NAN)], vec![(2.0, 1.0)]]
        {
            assert_eq!(Ramp::new(Blend::Linear, stops), Err(BadRamp));
        }
    }
}
