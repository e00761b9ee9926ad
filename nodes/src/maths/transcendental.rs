//! Sines, roots and powers that give the same bits on every machine.
//!
//! The rare ones are libm's (a port of musl, no system calls). The one that hair spends its time in, the
//! sine and cosine of an angle counted in turns, is a polynomial of ours without branches: its
//! largest error is 1.2e-7, about one unit in the last place of 1 (tested on a million angles).

use super::lanes::{Simd, f32x8, mask32x8, ops::*};
use std::f32::consts::TAU;
use std::ops::{Add, Mul, Sub};

/// `x` to the nearest whole number, ties to even.
#[inline]
fn round(x: f32) -> f32 {
    if x.abs() < NEAR { (x + SHIFT) - SHIFT } else { x.round_ties_even() }
}
/// Adding 1.5 * 2^23 leaves no bits for fractions: two additions for what is a call on many machines.
const SHIFT: f32 = 12_582_912.0;
const NEAR: f32 = 4_194_304.0;

/// The number of quarter turns nearest to each angle, and the lanes where it is right, which excludes very large angles.
#[inline(always)]
pub(super) fn quarters<S: Simd>(turns: f32x8<S>) -> (f32x8<S>, mask32x8<S>) {
    let x = turns * 4.0;
    ((x + SHIFT) - SHIFT, x.abs().simd_lt(NEAR))
}

/// Sine and cosine of the angle between `turns` and the nearest quarter turn, for single numbers and lanes alike.
#[inline(always)]
pub(super) fn sin_cos_within<T>(turns: T, quarters: T) -> (T, T)
where
    T: Copy
        + Add<Output = T>
        + Sub<Output = T>
        + Mul<Output = T>
        + Add<f32, Output = T>
        + Mul<f32, Output = T>,
    f32: Mul<T, Output = T> + Sub<T, Output = T> + Add<T, Output = T>,
{
    // `r` in [-1/8, 1/8] is exact, for the subtraction of two neighbouring floats is.
    let r = turns - quarters * 0.25;
    let x = r * TAU;
    let x2 = x * x;
    // Taylor coefficients adjusted for |x| <= pi/4 (the classic single-precision minimax set of
    // Cephes, S. Moshier 1984).
    let sin = x + x * x2 * (-1.666_665_5e-1 + x2 * (8.332_161e-3 + x2 * -1.951_529_6e-4));
    let cos =
        1.0 - 0.5 * x2 + x2 * x2 * (4.166_664_6e-2 + x2 * (-1.388_731_6e-3 + x2 * 2.443_315_7e-5));
    (sin, cos)
}

/// Sine and cosine of `turns` full turns (1 = 360 degrees). Any finite input; the error grows with
/// the spacing of `f32` there, as for any sine.
#[inline]
pub fn sin_cos_turns(turns: f32) -> (f32, f32) {
    let quarters = round(turns * 4.0);
    let (sin, cos) = sin_cos_within(turns, quarters);
    match (quarters as i64) & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos(radians: f32) -> (f32, f32) {
    sin_cos_turns(radians * (1.0 / TAU))
}

/// Sine of an angle in radians.
#[inline]
pub fn sin(radians: f32) -> f32 {
    sin_cos(radians).0
}

/// Cosine of an angle in radians.
#[inline]
pub fn cos(radians: f32) -> f32 {
    sin_cos(radians).1
}

/// Tangent of an angle in radians.
pub fn tan(radians: f32) -> f32 {
    libm::tanf(radians)
}

/// Angle in radians whose cosine is `x`; `x` is clamped to [-1, 1] first.
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Angle in radians whose sine is `x`; `x` is clamped to [-1, 1] first.
pub fn asin(x: f32) -> f32 {
    libm::asinf(x.clamp(-1.0, 1.0))
}

/// Angle of the vector (x, y) in radians, -pi to pi; 0 for the null vector.
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// e to the `x`.
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// `x` to the power of `y`.
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Cube root.
pub fn cbrt(x: f32) -> f32 {
    libm::cbrtf(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_by_addition_is_rounding() {
        let check = |x: f32| assert_eq!(round(x), x.round_ties_even(), "{x}");
        (-4000..4000).for_each(|i| check(i as f32 * 0.125));
        [4_194_303.5, 4_194_304.5, -4_194_303.5, 1e20, f32::INFINITY].into_iter().for_each(check);
    }

    #[test]
    fn sine_and_cosine_of_turns_are_right_to_one_unit_in_the_last_place_of_one() {
        let mut worst = 0.0f64;
        for i in -500_000..500_000 {
            let turns = i as f32 * 3.7e-5;
            let (s, c) = sin_cos_turns(turns);
            let x = f64::from(turns) * std::f64::consts::TAU;
            worst = worst.max((f64::from(s) - libm::sin(x)).abs());
            worst = worst.max((f64::from(c) - libm::cos(x)).abs());
        }
        assert!(worst < 1.2e-7, "{worst:e}");
    }

    #[test]
    fn quarter_turns_are_exact() {
        for k in -8..8 {
            let (s, c) = sin_cos_turns(k as f32 * 0.25);
            let want = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][(k & 3) as usize];
            assert_eq!((s, c), want, "{k}");
        }
    }

    #[test]
    fn angles_outside_the_domain_are_clamped() {
        assert_eq!(acos(1.000_001), 0.0);
        assert_eq!(asin(-2.0), -std::f32::consts::FRAC_PI_2);
    }
}
