//! The far-field model of Karis 2016, "Physically based hair shading in Unreal" (SIGGRAPH course), from
//! his fits of R, TT and TRT. Twin of `hair_karis.wgsl`.
//!
//! Two things are ours. His base colour is the light that one crossing leaves, exp(-4 sigma), so that
//! TT through the middle is exp(-2 sigma) as in Chiang et al.; the looks of many hairs is the scattering
//! table's business and must not enter twice. And each lobe is scaled (`gains`, from the table) to the
//! energy that Chiang's lobe has in white hair, for the fits lose up to a quarter of it.
//! The lobes' widths are Karis' own (the square of the roughness), narrower than Chiang's.

use glam::Vec3;

use super::fibre::{Angles, Hair, cosine, exp, schlick};

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

/// Where a lobe stands, as the sum of the two sines, and its deviation. `lobe`: 0 R, 1 TT, 2 TRT.
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
        _ => (4.0 * m.tilt, 2.0 * b2),
    }
}

/// All of a lobe but its longitudinal Gaussian and its absorption, and the length of its path: the
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
    let across = a.sin_i + a.sin_o;
    let mut sum = Vec3::ZERO;
    for lobe in 0..3 {
        let (shift, deviation) = place(m, a, lobe);
        let (share, length) = around(a, lobe);
        let gain = gains[lobe] * if lobe == 0 { m.specular } else { 1.0 };
        sum += exp(m.sigma * -length) * (gain * share * gaussian(deviation, across - shift));
    }
    sum
}
