//! Chiang's model a second time, in f64 and by definition rather than by the forms that are fast: what
//! the f32 code is compared with. Facts from Chiang et al. 2016 and from pbrt-v4's documentation of it.

use glam::DVec3;
use std::f64::consts::PI;

const ETA: f64 = 1.55;

/// exp(-x) I0(x) from the integral of exp(x (cos t - 1)) over half a turn.
fn scaled_bessel(x: f64) -> f64 {
    // Exact to the last digit while the square of STEPS is many times x.
    const STEPS: usize = 140;
    let at = |k: usize| (x * ((k as f64 + 0.5) * PI / STEPS as f64).cos() - x).exp();
    (0..STEPS).map(at).sum::<f64>() / STEPS as f64
}

/// The textbook's exp(-b) I0(a) / (2 v sinh(1 / v)), in logarithms.
fn longitudinal(theta_i: f64, theta_o: f64, v: f64) -> f64 {
    let a = theta_i.cos() * theta_o.cos().abs() / v;
    let b = theta_i.sin() * theta_o.sin() / v;
    let log_sinh = 1.0 / v + (0.5 * (1.0 - (-2.0 / v).exp())).ln();
    (scaled_bessel(a).ln() + a - b - (2.0 * v).ln() - log_sinh).exp()
}

/// A logistic density, cut to one turn.
fn azimuthal(phi: f64, s: f64) -> f64 {
    let mut x = phi;
    while x > PI {
        x -= 2.0 * PI;
    }
    while x < -PI {
        x += 2.0 * PI;
    }
    let sum = |x: f64| 1.0 / (1.0 + (-x / s).exp());
    // The density is the derivative of the sum: sum (1 - sum) / s.
    sum(x) * (1.0 - sum(x)) / s / (sum(PI) - sum(-PI))
}

/// Fresnel's equations by the angles of both rays.
fn fresnel(incidence: f64) -> f64 {
    let i = incidence.max(1e-9);
    let t = (i.sin() / ETA).asin();
    let s = (i - t).sin() / (i + t).sin();
    let p = (i - t).tan() / (i + t).tan();
    0.5 * (s * s + p * p)
}

/// f cos(theta_i) of one channel. Directions unit, tilt in radians, `h` in -1..1.
pub(super) fn chiang(
    sigma: f64,
    (beta_m, beta_n, tilt): (f64, f64, f64),
    (light, viewer, tangent): (DVec3, DVec3, DVec3),
    h: f64,
) -> f64 {
    let theta_i = PI / 2.0 - light.angle_between(tangent);
    let theta_o = PI / 2.0 - viewer.angle_between(tangent);
    // Azimuths in a frame of two vectors across the hair.
    let u = tangent.any_orthonormal_vector();
    let w = tangent.cross(u);
    let azimuth = |d: DVec3| d.dot(w).atan2(d.dot(u));
    let phi = azimuth(light) - azimuth(viewer);

    let gamma_o = h.asin();
    let bravais = (ETA * ETA - theta_o.sin().powi(2)).sqrt() / theta_o.cos();
    let gamma_t = (h / bravais).asin();
    let theta_t = (theta_o.sin() / ETA).asin();
    let through = (-sigma * 2.0 * gamma_t.cos() / theta_t.cos()).exp();
    let f = fresnel((theta_o.cos() * gamma_o.cos()).acos());

    let v = (0.726 * beta_m + 0.812 * beta_m.powi(2) + 3.7 * beta_m.powi(20)).powi(2);
    let s = (PI / 8.0).sqrt() * (0.265 * beta_n + 1.194 * beta_n.powi(2) + 5.372 * beta_n.powi(22));
    let share = |p: i32| (1.0 - f).powi(2) * through.powi(p) * f.powi(p - 1);
    let lobe = |p: i32, share: f64, turn: f64, variance: f64| {
        let leaves = 2.0 * f64::from(p) * gamma_t - 2.0 * gamma_o + f64::from(p) * PI;
        let around = if p < 3 { azimuthal(phi - leaves, s) } else { 0.5 / PI };
        share * longitudinal(theta_i, theta_o + turn, variance) * around
    };
    // Light that is reflected inside again and again, added up one by one.
    let rest = (3..400).map(share).sum();
    lobe(0, f, -2.0 * tilt, v)
        + lobe(1, share(1), tilt, v / 4.0)
        + lobe(2, share(2), 4.0 * tilt, v * 4.0)
        + lobe(3, rest, 0.0, v * 4.0)
}
