//! Smooth random vectors, in space or along a hair.
//!
//! Random values at the corners of a lattice of half a wavelength are blended; finer octaves are added. Guarantees: no vector is
//! longer than 1; the same on every machine; along a hair, vectors depend on its id and the position alone.

use crate::maths::hash::Dice;
use glam::Vec3;

/// Noise with these octaves.
pub(super) struct Waves {
    pub dice: Dice,
    /// Number of octaves, each with half the wavelength of the one before.
    pub octaves: u32,
    /// Amplitude of each octave relative to the one before.
    pub roughness: f32,
}

/// Weight of the second of two corners at this fraction of the way: slope and curvature vanish at both.
fn blend(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn vector(bits: u64) -> Vec3 {
    let part = |shift: u32| ((bits >> shift) & 0x1F_FFFF) as f32 * (2.0 / 0x20_0000 as f32) - 1.0;
    Vec3::new(part(0), part(21), part(42))
}

impl Waves {
    /// At a position in space, in wavelengths.
    pub(super) fn in_space(&self, p: Vec3) -> Vec3 {
        self.octaves(|octave, scale| {
            let q = p * (2.0 * scale);
            let low = q.floor();
            let t = (q - low).to_array().map(blend);
            let cell = low.to_array().map(|x| x as i64);
            let mut sum = Vec3::ZERO;
            let side = |a: usize, high: usize| cell[a].saturating_add(high as i64) as u64;
            // What corners share is drawn once.
            let of_x = [0, 1].map(|x| self.dice.bits(octave, side(0, x)));
            let of_y = [0, 1, 2, 3].map(|xy| self.dice.bits(of_x[xy & 1], side(1, xy >> 1)));
            for corner in 0..8usize {
                let high = [0, 1, 2].map(|axis| corner >> axis & 1);
                let share = |a: usize| if high[a] == 1 { t[a] } else { 1.0 - t[a] };
                let bits = self.dice.bits(of_y[corner & 3], side(2, high[2]));
                sum += vector(bits) * (share(0) * share(1) * share(2));
            }
            sum
        })
    }
    /// On the hair with this id, at a distance from its root in wavelengths.
    pub(super) fn along(&self, id: u64, x: f32) -> Vec3 {
        self.octaves(|octave, scale| {
            let q = x * (2.0 * scale);
            let low = q.floor();
            let at = |cell: f32| {
                vector(self.dice.bits(id, (cell as i64 as u64).wrapping_mul(64) + octave))
            };
            at(low).lerp(at(low + 1.0), blend(q - low))
        })
    }
    fn octaves(&self, value: impl Fn(u64, f32) -> Vec3) -> Vec3 {
        let (mut sum, mut all, mut share, mut scale) = (Vec3::ZERO, 0.0, 1.0, 1.0);
        for octave in 0..self.octaves {
            sum += value(u64::from(octave), scale) * share;
            all += share;
            share *= self.roughness;
            scale *= 2.0;
        }
        (sum / all.max(1e-6)).clamp_length_max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_smooth_and_stay_within_one_and_fill_a_good_part_of_it() {
        for (octaves, roughness) in [(1, 0.5), (4, 0.5), (3, 1.0)] {
            let waves = Waves { dice: Dice::new(4, 0, "waves"), octaves, roughness };
            let (mut step, mut sum, n) = (0.0f32, 0.0, 4000);
            for k in 0..n {
                let x = k as f32 * 0.003;
                let far = Vec3::new(x, -x, 40.0 - 2.0 * x);
                let pairs = [
                    (waves.along(9, x), waves.along(9, x + 0.001)),
                    (waves.in_space(far), waves.in_space(far + Vec3::X * 0.001)),
                ];
                for (a, b) in pairs {
                    assert!(a.length() <= 1.0001);
                    step = step.max(a.distance(b));
                    sum += a.length();
                }
            }
            let mean = sum / (2 * n) as f32;
            assert!((0.3..0.9).contains(&mean), "{mean}");
            // The steepest blend of two opposite corners: 15/8 on a way of half a wave, each octave twice as steep.
            assert!(step < 0.001 * 2.0 * 1.875 * 3.5 * octaves as f32, "{step}");
        }
    }
}
