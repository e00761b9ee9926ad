//! The model of Kajiya & Kay 1989, "Rendering fur with three dimensional textures": a diffuse cylinder and
//! a cone of highlight. Twin of `hair_kajiya_kay.wgsl`.
//!
//! Both terms are the paper's; the constants that it leaves open are ours: the diffuse term returns the
//! colour of many such hairs (`Scatter::deep`), the highlight is white, has the width of Chiang's R lobe
//! and a tenth of the light. The model has no azimuth: a hair is as bright
//! with the light behind it as before it.

use glam::Vec3;
use std::f32::consts::PI;

use super::fibre::{Angles, Hair, variances};

/// Share of the light that the highlight returns at most.
pub(crate) const HIGHLIGHT: f32 = 0.1;
/// The diffuse term, f cos(theta_i) with the cosine of the paper: the sine of light and hair.
pub(crate) fn diffuse(colour: Vec3, a: &Angles) -> Vec3 {
    colour * ((1.0 - HIGHLIGHT) * a.cos_i / (PI * PI))
}

/// The highlight.
pub(crate) fn highlight(m: &Hair, a: &Angles) -> f32 {
    let exponent = (1.0 / variances(m.beta_m)[0]).max(1.0);
    let (apart, across) = (a.cos_i - a.cos_o, a.sin_i + a.sin_o);
    // cos(theta_i + theta_o), with all digits near 1.
    let cosine = 1.0 - 0.5 * (apart * apart + across * across);
    let lobe = (exponent * cosine.max(1e-6).ln()).exp();
    m.specular * HIGHLIGHT * lobe * exponent.sqrt() / (2.0 * PI * (2.0 * PI).sqrt())
}
