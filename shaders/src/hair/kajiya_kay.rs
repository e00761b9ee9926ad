//! The model of Kajiya & Kay 1989, "Rendering fur with three dimensional textures": a diffuse cylinder and
//! a cone of highlight. Twin of `hair_kajiya_kay.wgsl`.
//!
//! Both terms are the paper's; the constants that it leaves open are ours: the diffuse term returns the
//! colour of many such hairs (`Scatter::deep`) less their shine, the highlight is white, has the width of Karis' R lobe and
//! a share of the light that looks usual. The model has no azimuth: a hair is as bright with the light
//! behind it as before it.

use glam::Vec3;
use std::f32::consts::PI;

use super::fibre::{Angles, Hair};

/// Share of the light that the highlight returns at most.
pub(crate) const HIGHLIGHT: f32 = 0.07;
/// The colour of many hairs, `deep`, without what their surfaces reflect, which is the highlight's.
pub(crate) fn colour(deep: Vec3, surface: f32) -> Vec3 {
    let shine = 0.2 * surface;
    (deep - Vec3::splat(shine)).max(Vec3::ZERO) / (1.0 - shine)
}

/// The diffuse term, f cos(theta_i) with the cosine of the paper: the sine of light and hair.
pub(crate) fn diffuse(colour: Vec3, a: &Angles) -> Vec3 {
    colour * ((1.0 - HIGHLIGHT) * a.cos_i / (PI * PI))
}

/// The highlight.
pub(crate) fn highlight(m: &Hair, a: &Angles) -> f32 {
    // Of a cone as wide as Karis' R lobe at its middle, and never wider than a cosine.
    let b = m.beta_m.clamp(0.1, 0.84);
    let exponent = 0.5 / (b * b * b * b);
    let (apart, across) = (a.cos_i - a.cos_o, a.sin_i + a.sin_o);
    // cos(theta_i + theta_o), with all digits near 1.
    let cosine = 1.0 - 0.5 * (apart * apart + across * across);
    let lobe = (exponent * cosine.max(1e-6).ln()).exp();
    m.specular * HIGHLIGHT * lobe * exponent.sqrt() / (2.0 * PI * (2.0 * PI).sqrt())
}
