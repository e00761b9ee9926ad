//! Light that meets many hairs: a table of what one hair does on average, and the sums over many.
//! `hair_scatter.wgsl` reads the table and is the twin of the sums.
//!
//! This is dual scattering (Zinke et al. 2008, "Dual scattering approximation for fast multiple scattering
//! in hair"): a hair sends the share `forward` of light on and the share `back` back, each wider by a
//! variance; light on its way through n hairs (global) and light that the hairs behind send back
//! (local) follow from those. Where the paper multiplies n shares and stops after three backward
//! bounces, we sum all bounces: two flows of light through hairs that lie at random, n of them on
//! average (Kubelka & Munk 1931). With f = forward, b = back:
//!
//! - k = sqrt((1 - f)^2 - b^2) is the loss per hair crossed; exp(-k n) of the light reaches depth n, of
//!   which exp(-n) never met a hair. For few bounces this is the mean of the paper's f^n.
//! - r = b / (1 - f + k) is what a deep head of hair returns; 1 for white hair, where the paper's series,
//!   cut after its third term, would lose a third.
//!
//! A head is no half space: light that has crossed many hairs finds a side to leave by. That loss
//! is 1 / (1 + (n / 12)^2), a constant set by eye. Widths are the paper's (its equations 8 and 16).
//! Not modelled: mean shifts of inclination, and hairs that are not parallel.

use coif_nodes::maths::smoothstep;
use glam::Vec3;
use std::f32::consts::PI;

use super::fibre::{Angles, ETA, Hair, cosine, fresnel, logistic_scale, longitudinal, variances};
use super::{Model, karis};

/// Values of absorption in the table: 0 and then growing by a constant ratio.
pub(crate) const SIGMAS: usize = 64;
/// Values of cos(theta) in the table: 0 to 1 in equal steps.
pub(crate) const THETAS: usize = 16;
/// The scale of the axis of absorption: sigma = SMALL (2^(k / STEPS) - 1).
const SMALL: f32 = 0.01;
/// Rows of the table per doubling; row 63 is a sigma of 20.1, darker than any hair.
const STEPS: f32 = 5.74;
/// Hairs crossed at which half of the light has left sideways.
const SIDEWAYS: f32 = 12.0;

/// What one hair does to light on average, by absorption and inclination.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScatterTable {
    /// `THETAS` rows of `SIGMAS`: share sent forward, share sent back, variances of their inclinations
    /// (forward, back). Then `THETAS` values for viewers on the tip's side and as many for the root's: what
    /// Karis' lobes R, TT, TRT are scaled by, and the share that the surface reflects.
    pub(crate) values: Vec<[f32; 4]>,
}

impl ScatterTable {
    /// Integrates Chiang's model over the hair's width and all directions of light.
    ///
    /// Roughnesses 0..1, tilt in radians. A few milliseconds.
    pub(crate) fn bake(beta_m: f32, beta_n: f32, tilt: f32) -> Self {
        let mut values = vec![[0.0; 4]; SIGMAS * THETAS + 2 * THETAS];
        let m =
            Hair { sigma: Vec3::ZERO, beta_m, beta_n, tilt, specular: 1.0, model: Model::Karis };
        for row in 0..THETAS {
            let cos_o = row as f32 / (THETAS - 1) as f32;
            let chords = chords(beta_n, cos_o);
            for k in 0..SIGMAS {
                values[row * SIGMAS + k] = average(&chords, variances(beta_m), sigma_of(k as f32));
            }
            let wanted = energies(&chords);
            for (side, sin_o) in [cosine(cos_o), -cosine(cos_o)].into_iter().enumerate() {
                let have = karis_energies(&m, sin_o, cos_o);
                let gain = |lobe: usize| (wanted[lobe] / have[lobe].max(1e-6)).min(8.0);
                values[SIGMAS * THETAS + side * THETAS + row] =
                    [gain(0), gain(1), gain(2), wanted[0]];
            }
        }
        Self { values }
    }

    /// What one hair does to three channels of light, seen at an inclination of sine `sin_o`.
    pub(crate) fn at(&self, sigma: Vec3, sin_o: f32) -> Scatter {
        let row = cosine(sin_o) * (THETAS - 1) as f32;
        let low = (row as usize).min(THETAS - 2);
        let part = row - low as f32;
        let mut of = Scatter::default();
        for channel in 0..3 {
            let k = (STEPS * (1.0 + sigma[channel].max(0.0) * (1.0 / SMALL)).log2())
                .min(SIGMAS as f32 - 1.0);
            let left = (k as usize).min(SIGMAS - 2);
            let along = |row: usize| {
                let at = row * SIGMAS + left;
                mix(self.values[at], self.values[at + 1], k - left as f32)
            };
            let [forward, back, v_forward, v_back] = mix(along(low), along(low + 1), part);
            of.forward[channel] = forward;
            of.back[channel] = back;
            of.v_forward += v_forward / 3.0;
            of.v_back += v_back / 3.0;
        }
        let side = SIGMAS * THETAS + if sin_o < 0.0 { THETAS } else { 0 };
        let gains = |row: usize| self.values[side + row];
        let [r, tt, trt, surface] = mix(gains(low), gains(low + 1), part);
        of.gains = Vec3::new(r, tt, trt);
        of.surface = surface;
        of
    }
}

fn mix(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

/// The absorption of a place on the table's axis.
pub(crate) fn sigma_of(k: f32) -> f32 {
    SMALL * ((k / STEPS).exp2() - 1.0)
}

/// A place across the hair's width: its share of the width, the length of a crossing, the surface's
/// reflectance, and the share of R, TT, TRT that leaves into the far half of azimuths.
struct Chord {
    width: f32,
    length: f32,
    fresnel: f32,
    far: [f32; 3],
}

fn chords(beta_n: f32, cos_o: f32) -> Vec<Chord> {
    const ACROSS: usize = 48;
    let s = logistic_scale(beta_n);
    let sin_o = cosine(cos_o);
    (0..ACROSS)
        .map(|k| {
            // Equal steps of the angle, for what happens at the rim happens fast. Both sides are alike.
            let step = PI / 2.0 / ACROSS as f32;
            let gamma_o = (k as f32 + 0.5) * step;
            let (h, cos_gamma_o) = gamma_o.sin_cos();
            let sin_gamma_t = h * cos_o / (ETA * ETA - sin_o * sin_o).sqrt();
            let cos_gamma_t = cosine(sin_gamma_t);
            let gamma_t = sin_gamma_t.atan2(cos_gamma_t);
            Chord {
                width: cos_gamma_o * 2.0 * (step / 2.0).sin(),
                length: 2.0 * cos_gamma_t / cosine(sin_o / ETA),
                fresnel: fresnel(cos_o * cos_gamma_o),
                far: std::array::from_fn(|p| {
                    let p = p as f32;
                    let leaves = 2.0 * p * gamma_t - 2.0 * gamma_o + p * PI;
                    1.0 - (turned(PI / 2.0 - leaves, s) - turned(-PI / 2.0 - leaves, s))
                }),
            }
        })
        .collect()
}

/// The integral of the periodic logistic lobe from -pi to `x`.
fn turned(x: f32, s: f32) -> f32 {
    let turns = (x / (2.0 * PI)).round_ties_even();
    let x = x - turns * 2.0 * PI;
    let at = |x: f32| 1.0 / (1.0 + (-x / s).exp());
    turns + (at(x) - at(-PI)) / (at(PI) - at(-PI))
}

/// Shares of light in R, TT, TRT, the rest, where a crossing leaves `through`.
fn orders(fresnel: f32, through: f32) -> [f32; 4] {
    let tt = (1.0 - fresnel) * (1.0 - fresnel) * through;
    let trt = tt * through * fresnel;
    [fresnel, tt, trt, trt * through * fresnel / (1.0 - through * fresnel).max(1e-4)]
}

fn average(chords: &[Chord], v: [f32; 3], sigma: f32) -> [f32; 4] {
    let (mut far, mut near, mut v_far, mut v_near) = (0.0, 0.0, 0.0, 0.0);
    for chord in chords {
        let shares = orders(chord.fresnel, (-sigma * chord.length).exp());
        for (p, share) in shares.into_iter().enumerate() {
            let share = share * chord.width;
            let ahead = share * if p < 3 { chord.far[p] } else { 0.5 };
            far += ahead;
            near += share - ahead;
            v_far += ahead * v[p.min(2)];
            v_near += (share - ahead) * v[p.min(2)];
        }
    }
    [far, near, v_far / far.max(1e-6), v_near / near.max(1e-6)]
}

/// Energies of Chiang's lobes in white hair, the rest with TRT.
fn energies(chords: &[Chord]) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for chord in chords {
        let shares = orders(chord.fresnel, 1.0);
        for (p, share) in shares.into_iter().enumerate() {
            sum[p.min(2)] += share * chord.width;
        }
    }
    sum
}

/// Energies of Karis' lobes in white hair: their integrals over all directions of light.
fn karis_energies(m: &Hair, sin_o: f32, cos_o: f32) -> [f32; 3] {
    const AROUND: usize = 32;
    const ALONG: usize = 16;
    let mut sum = [0.0_f32; 3];
    for step in 0..AROUND {
        let (sin_phi, cos_phi) = ((step as f32 + 0.5) * PI / AROUND as f32).sin_cos();
        let mut a = Angles { sin_i: 0.0, cos_i: 1.0, sin_o, cos_o, cos_phi, sin_phi };
        for (lobe, sum) in sum.iter_mut().enumerate() {
            let (shift, deviation) = karis::place(m, &a, lobe);
            let middle = shift - sin_o;
            // What the Gaussian has beyond sines of 1 is lost.
            let from = (middle - 4.0 * deviation).max(-1.0);
            let to = (middle + 4.0 * deviation).min(1.0);
            let width = (to - from).max(0.0) / ALONG as f32;
            for k in 0..ALONG {
                a.sin_i = (from + (k as f32 + 0.5) * width).clamp(-1.0, 1.0);
                a.cos_i = cosine(a.sin_i);
                // Both halves of the circle.
                let ring = width * 2.0 * PI / AROUND as f32;
                *sum += karis::around(&a, lobe).0 * karis::along(m, &a, lobe) * ring;
            }
        }
    }
    sum
}

/// What one hair does to three channels of light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scatter {
    /// Share sent on, into the half of azimuths away from the light.
    pub(crate) forward: Vec3,
    /// Share sent back.
    pub(crate) back: Vec3,
    /// Variance of the inclination of light sent on, square radians.
    pub(crate) v_forward: f32,
    /// Variance of the inclination of light sent back, square radians.
    pub(crate) v_back: f32,
    /// What Karis' lobes are scaled by.
    pub(crate) gains: Vec3,
    /// Share that the surface reflects.
    pub(crate) surface: f32,
}

impl Scatter {
    /// Loss per hair crossed.
    pub(crate) fn loss(&self) -> Vec3 {
        let kept = Vec3::ONE - self.forward;
        let squares = (kept * kept - self.back * self.back).max(Vec3::ZERO);
        Vec3::new(squares.x.sqrt(), squares.y.sqrt(), squares.z.sqrt())
    }

    /// What many hairs return of light that falls on them.
    pub(crate) fn deep(&self) -> Vec3 {
        self.back / (Vec3::ONE - self.forward + self.loss()).max(Vec3::splat(1e-4))
    }

    /// Share of light that reaches a hair behind `fibres` others, whether it met them or not.
    pub(crate) fn reaches(&self, fibres: f32) -> Vec3 {
        let sideways = fibres * (1.0 / SIDEWAYS);
        let reached = super::fibre::exp(self.loss() * -fibres) / (1.0 + sideways * sideways);
        reached.max(Vec3::splat((-fibres).exp()))
    }

    /// Light that met other hairs first: f cos(theta_i) summed with what reached the hair, for a light
    /// of irradiance 1.
    pub(crate) fn many(&self, a: &Angles, fibres: f32) -> Vec3 {
        let direct = (-fibres).exp();
        let reached = self.reaches(fibres);
        let s = 0.5 - 0.5 * a.cos_phi;
        let far = smoothstep(s);

        // Through the hairs in front. At least one was crossed; on average this many.
        let crossed = if fibres > 0.01 { fibres / (1.0 - direct) } else { 1.0 };
        let v = self.v_back + (self.v_forward - self.v_back) * far + crossed * self.v_forward;
        let along = longitudinal(a.sin_i, a.cos_i, a.sin_o, a.cos_o, v.min(2.0));
        let through = (reached - Vec3::splat(direct))
            * (self.back + (self.forward - self.back) * far)
            * (along / PI);

        // From the hairs behind, which are those away from the viewer. The light that they had is the
        // light on the viewer's side: a soft cosine whose integral over phi is pi.
        let f = (self.forward.x + self.forward.y + self.forward.z) / 3.0;
        let b = (self.back.x + self.back.y + self.back.z) / 3.0;
        let b3 = b * b * b;
        let (v_f, v_b) = (self.v_forward, self.v_back);
        let width = (1.0 + 0.7 * f * f)
            * (b * (2.0 * v_f + v_b).sqrt() + b3 * (2.0 * v_f + 3.0 * v_b).sqrt())
            / (b + b3 * (2.0 * v_f.sqrt() + 3.0 * v_b.sqrt())).max(1e-6);
        let v = (width * width + (crossed - 1.0) * v_f).min(2.0);
        let near = 1.0 - s;
        let along = longitudinal(a.sin_i, a.cos_i, a.sin_o, a.cos_o, v.max(1e-3));
        let behind = reached * self.deep() * self.forward * (along * 1.6 / PI * near * near * near);
        through + behind
    }
}
