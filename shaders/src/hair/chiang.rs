//! The near-field model of Chiang et al. 2016, "A practical and controllable hair and fur model for
//! production path tracing", as pbrt-v4 states it: lobes R, TT, TRT and the rest. Twin of
//! `hair_chiang.wgsl`.
//!
//! Guaranteed: equal to an independent evaluation in f64 (test), and white hair that absorbs nothing
//! returns all light for every offset. Not a BSDF of a flat ribbon: `h` is where the ray meets the hair.

use glam::Vec3;
use std::f32::consts::PI;

use super::fibre::{
    Angles, ETA, Hair, cosine, exp, fresnel, logistic_scale, turned, variances, wrapped,
};

/// The trimmed logistic lobe of scale `s` at `x` in -pi..pi; its integral there is 1.
pub(crate) fn logistic(x: f32, s: f32) -> f32 {
    let e = (-x.abs() / s).exp();
    let q = (-PI / s).exp();
    e * (1.0 + q) / (s * (1.0 + e) * (1.0 + e) * (1.0 - q))
}

/// f cos(theta_i) for a ray that meets the hair at offset `h` in -1..1 of its radius.
pub(crate) fn chiang(m: &Hair, a: &Angles, h: f32) -> Vec3 {
    let cos_gamma_o = cosine(h);
    let gamma_o = h.atan2(cos_gamma_o);
    let sin_gamma_t = h * a.cos_o / (ETA * ETA - a.sin_o * a.sin_o).sqrt();
    let cos_gamma_t = cosine(sin_gamma_t);
    let gamma_t = sin_gamma_t.atan2(cos_gamma_t);
    let cos_theta_t = cosine(a.sin_o / ETA);
    let through = exp(m.sigma * (-2.0 * cos_gamma_t / cos_theta_t));

    let f = fresnel(a.cos_o * cos_gamma_o);
    let tt = through * ((1.0 - f) * (1.0 - f));
    let trt = tt * through * f;
    let rest = trt * through * f / (Vec3::ONE - through * f).max(Vec3::splat(1e-4));

    let phi = a.sin_phi.atan2(a.cos_phi);
    let s = logistic_scale(m.beta_n);
    let around = |p: f32| logistic(wrapped(phi - (2.0 * p * gamma_t - 2.0 * gamma_o + p * PI)), s);
    // The scales lift the surface: each lobe's cone turns by a multiple of their tilt.
    let (s1, c1) = m.tilt.sin_cos();
    let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
    let (s4, c4) = (2.0 * s2 * c2, c2 * c2 - s2 * s2);
    let along = |sine: f32, cos: f32, v: f32| turned(a, (sine, cos), v);
    let v = variances(m.beta_m);
    Vec3::splat(m.specular * f * along(-s2, c2, v[0]) * around(0.0))
        + tt * (along(s1, c1, v[1]) * around(1.0))
        + trt * (along(s4, c4, v[2]) * around(2.0))
        + rest * (along(0.0, 1.0, v[2]) * (0.5 / PI))
}
