//! What all models of a hair share: its material, the angles of a pair of directions, Fresnel's terms
//! and the longitudinal lobe. Twin of `hair_fibre.wgsl`.
//!
//! Conventions (Marschner et al. 2003): `sin_i` and `sin_o` are the sines of the inclinations of light
//! and viewer out of the plane that the hair is perpendicular to; `phi` is the angle between the two
//! seen along the hair, 0 where light comes from behind the viewer. A lobe is a value of
//! f cos(theta_i), so that its integral over all directions of light is the share of energy that goes
//! to the viewer's cone. Every function here is finite for every finite argument.

use glam::Vec3;
use std::f32::consts::PI;

use super::Model;

/// Refractive index of keratin (Marschner et al. 2003).
pub(crate) const ETA: f32 = 1.55;
/// Reflectance at normal incidence of a surface of that index, ((1.55 - 1) / (1.55 + 1))^2.
const NORMAL_REFLECTANCE: f32 = 0.046_520_57;

/// A hair's material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hair {
    /// Absorption per radius of hair, >= 0.
    pub(crate) sigma: Vec3,
    /// Longitudinal roughness, 0..1; below 0.02 it is 0.02.
    pub(crate) beta_m: f32,
    /// Azimuthal roughness, 0..1; below 0.02 it is 0.02.
    pub(crate) beta_n: f32,
    /// Tilt of the cuticle's scales, radians.
    pub(crate) tilt: f32,
    /// Gain of the first highlight; 1 is what the models say.
    pub(crate) specular: f32,
    /// Which model.
    pub(crate) model: Model,
}

/// A pair of directions as the hair sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Angles {
    pub(crate) sin_i: f32,
    pub(crate) cos_i: f32,
    pub(crate) sin_o: f32,
    pub(crate) cos_o: f32,
    pub(crate) cos_phi: f32,
    pub(crate) sin_phi: f32,
}

impl Angles {
    /// Of unit vectors: to the light, to the viewer, along the hair to its tip.
    pub(crate) fn of(light: Vec3, viewer: Vec3, tangent: Vec3) -> Self {
        let sin_i = tangent.dot(light).clamp(-1.0, 1.0);
        let sin_o = tangent.dot(viewer).clamp(-1.0, 1.0);
        let x = light.dot(viewer) - sin_i * sin_o;
        let y = tangent.dot(viewer.cross(light));
        let r = (x * x + y * y).sqrt();
        // Along the hair there is no azimuth, and any will do.
        let (cos_phi, sin_phi) = if r > 1e-6 { (x / r, y / r) } else { (1.0, 0.0) };
        Self { sin_i, cos_i: cosine(sin_i), sin_o, cos_o: cosine(sin_o), cos_phi, sin_phi }
    }
}

/// The cosine, >= 0, that goes with a sine.
pub(crate) fn cosine(sine: f32) -> f32 {
    ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt()
}

/// exp(-x) I0(x) for x >= 0, I0 the modified Bessel function (Abramowitz & Stegun 9.8.1, 9.8.2).
pub(crate) fn scaled_bessel(x: f32) -> f32 {
    if x < 3.75 {
        let t = x * x * (1.0 / 14.0625);
        let i0 = 1.0
            + t * (3.515_622_9
                + t * (3.089_942_4
                    + t * (1.206_749_2 + t * (0.265_973_2 + t * (0.036_076_8 + t * 0.004_581_3)))));
        return i0 * (-x).exp();
    }
    let t = 3.75 / x;
    let p = 0.398_942_3
        + t * (0.013_285_92
            + t * (0.002_253_19
                + t * (-0.001_575_65
                    + t * (0.009_162_81
                        + t * (-0.020_577_06
                            + t * (0.026_355_37 + t * (-0.016_476_33 + t * 0.003_923_77)))))));
    p / x.sqrt()
}

/// The longitudinal lobe of d'Eon et al. 2011, "An energy-conserving hair reflectance model", equation 7:
/// of variance `v` around the mirrored inclination. Its integral over sin(theta_i) is 1 for every v.
///
/// Written with the half square of the distance of the two inclinations, which keeps all digits where
/// exp(-b) I0(a) / sinh(1 / v) would be infinity times nothing.
pub(crate) fn longitudinal(sin_i: f32, cos_i: f32, sin_o: f32, cos_o: f32, v: f32) -> f32 {
    let (apart, across) = (cos_i - cos_o, sin_i + sin_o);
    let distance = 0.5 * (apart * apart + across * across);
    (-distance / v).exp() * scaled_bessel(cos_i * cos_o / v) / (v * (1.0 - (-2.0 / v).exp()))
}

/// [`longitudinal`] for a viewer's cone that is turned by the angle of this sine and cosine.
pub(crate) fn turned(a: &Angles, (sine, cos): (f32, f32), v: f32) -> f32 {
    let sin_o = a.sin_o * cos + a.cos_o * sine;
    let cos_o = (a.cos_o * cos - a.sin_o * sine).abs();
    longitudinal(a.sin_i, a.cos_i, sin_o, cos_o, v)
}

/// Variances of the lobes R, TT and TRT (Chiang et al. 2016, equation 7).
pub(crate) fn variances(beta_m: f32) -> [f32; 3] {
    let b = beta_m.clamp(0.02, 1.0);
    let b5 = b * b * b * b * b;
    let b10 = b5 * b5;
    let root = 0.726 * b + 0.812 * b * b + 3.7 * b10 * b10;
    let v = root * root;
    [v, 0.25 * v, 4.0 * v]
}

/// Scale of the azimuthal logistic lobe (Chiang et al. 2016, equation 8).
pub(crate) fn logistic_scale(beta_n: f32) -> f32 {
    let b = beta_n.clamp(0.02, 1.0);
    let b11 = b * b * b * b * b * b * b * b * b * b * b;
    0.626_657_07 * (0.265 * b + 1.194 * b * b + 5.372 * b11 * b11)
}

/// Reflectance of the surface for unpolarised light that comes in at an angle of cosine `c`, 0..1.
pub(crate) fn fresnel(c: f32) -> f32 {
    let cos_t = (1.0 - (1.0 - c * c) / (ETA * ETA)).max(0.0).sqrt();
    let s = (c - ETA * cos_t) / (c + ETA * cos_t);
    let p = (ETA * c - cos_t) / (ETA * c + cos_t);
    0.5 * (s * s + p * p)
}

/// Schlick's approximation of it, which Karis' fits were made with.
pub(crate) fn schlick(c: f32) -> f32 {
    let x = 1.0 - c.clamp(0.0, 1.0);
    let x2 = x * x;
    NORMAL_REFLECTANCE + (1.0 - NORMAL_REFLECTANCE) * x2 * x2 * x
}

/// exp for each channel.
pub(crate) fn exp(x: Vec3) -> Vec3 {
    Vec3::new(x.x.exp(), x.y.exp(), x.z.exp())
}

/// The angle, -pi..pi, that differs from `x` by whole turns.
pub(crate) fn wrapped(x: f32) -> f32 {
    x - 2.0 * PI * (x / (2.0 * PI)).round_ties_even()
}
