//! The far-field model of Karis 2016, "Physically based hair shading in Unreal" (SIGGRAPH course), from
//! his fits of R, TT and TRT. Twin of `hair_karis.wgsl`.
//!
//! Three things are ours. His base colour is the light that one crossing leaves, exp(-4 sigma), so that
//! TT through the middle is exp(-2 sigma) as in Chiang et al.; the looks of many hairs is the scattering
//! table's business and must not enter twice. And each lobe is scaled (`gains`, from the table) to the
//! energy that Chiang's lobe has in white hair, for the fits lose up to a quarter of it.
//! R and TT are as wide as Karis has them (the square of the roughness), narrower than Chiang's. TRT is as wide as
//! Chiang's: with Karis' own width, half of the least that Marschner et al. 2003 measured (table 1), the second highlight of
//! dark hair is a reddish patch with an edge where hair rises beside a parting.

use glam::Vec3;

use super::fibre::{Angles, Hair, cosine, exp, schlick, turned, variances};

fn gaussian(deviation: f32, x: f32) -> f32 {
    let z = x / deviation;
    (-0.5 * z * z).exp() / (deviation * 2.506_628_3)
}

/// Half the difference of the inclinations: its cosine.
fn cos_difference(a: &Angles) -> f32 {
    (0.5 + 0.5 * (a.cos_i * a.cos_o + a.sin_i * a.sin_o)).max(1e-4).sqrt()
}

/// cos(phi / 2), >= 0.
fn cos_half(a: &Angles) -> f32 {
    (0.5 + 0.5 * a.cos_phi).max(0.0).sqrt()
}

/// Where a lobe stands, as the sum of the two sines, and its deviation, of TRT about. `lobe`: 0 R, 1 TT, 2 TRT.
pub(crate) fn place(m: &Hair, a: &Angles, lobe: usize) -> (f32, f32) {
    let b = m.beta_m.clamp(0.02, 1.0);
    let b2 = b * b;
    match lobe {
        0 => {
            let half = cos_half(a);
            let (s, c) = (-2.0 * m.tilt).sin_cos();
            let shift = 2.0 * s * (c * half * a.cos_o + s * a.sin_o);
            (shift, b2 * std::f32::consts::SQRT_2 * half.max(0.05))
        }
        1 => (m.tilt, 0.5 * b2),
        _ => (4.0 * m.tilt, variances(m.beta_m)[2].sqrt()),
    }
}

/// How much of a lobe goes along the hair as these angles say; over all sines of the light its sum is 1 or, where a Gaussian
/// goes on beyond them, less.
pub(crate) fn along(m: &Hair, a: &Angles, lobe: usize) -> f32 {
    if lobe == 2 {
        let (sine, cos) = (-4.0 * m.tilt).sin_cos();
        return turned(a, (sine, cos), variances(m.beta_m)[2]);
    }
    let (shift, deviation) = place(m, a, lobe);
    gaussian(deviation, a.sin_i + a.sin_o - shift)
}

/// All of a lobe but [`along`] and its absorption, and the length of its path: the
/// light that is left is exp(-length sigma).
pub(crate) fn around(a: &Angles, lobe: usize) -> (f32, f32) {
    let cos_d = cos_difference(a);
    match lobe {
        0 => {
            let half = cos_half(a);
            let cosine = a.sin_i * a.sin_o + a.cos_i * a.cos_o * a.cos_phi;
            (0.25 * half * schlick((0.5 + 0.5 * cosine).max(0.0).sqrt()), 0.0)
        }
        1 => {
            let ratio = 1.0 / (1.19 / cos_d + 0.36 * cos_d);
            let h = cos_half(a) * (1.0 + ratio * (0.6 - 0.8 * a.cos_phi));
            let f = schlick(cos_d * cosine(h.min(1.0)));
            let length = 2.0 * cosine((h * ratio).min(1.0)) / cos_d;
            ((-3.65 * a.cos_phi - 3.98).exp() * (1.0 - f) * (1.0 - f), length)
        }
        _ => {
            let f = schlick(0.5 * cos_d);
            ((17.0 * a.cos_phi - 16.78).exp() * (1.0 - f) * (1.0 - f) * f, 3.2 / cos_d)
        }
    }
}

/// f cos(theta_i).
pub(crate) fn karis(m: &Hair, a: &Angles, gains: Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for lobe in 0..3 {
        let (share, length) = around(a, lobe);
        let gain = gains[lobe] * if lobe == 0 { m.specular } else { 1.0 };
        sum += exp(m.sigma * -length) * (gain * share * along(m, a, lobe));
    }
    sum
}
