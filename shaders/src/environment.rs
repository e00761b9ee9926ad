//! Light from all around: radiance as spherical harmonics, and the backdrop; twin of `environment.wgsl`.
//!
//! Radiance is scene-linear Rec.709, directions are in the world, Y up. Guaranteed: integration is
//! deterministic, mean radiance is kept to 1e-3, and no direction is darker than dark. Not guaranteed:
//! irradiance to more than 15 % of its largest value, and detail narrower than about 60
//! degrees; three bands hold none, so what is narrow belongs to the lights of a rig.

use coif_nodes::maths::smoothstep;
use glam::{Mat3, Quat, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Weights of bands 1 and 2 that turn radiance into irradiance over PI (Ramamoorthi & Hanrahan 2001).
pub const COSINE_LOBE: [f32; 2] = [2.0 / 3.0, 0.25];

/// Radiance in all directions on a grid: equirectangular, rows from up to down, the middle column
/// looks along -Z and columns go on to the right, so that it lies behind a subject that is seen from
/// the front.
#[derive(Clone, Debug, PartialEq)]
pub struct RadianceMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row from the top.
    pub texels: Vec<Vec3>,
}

impl RadianceMap {
    /// A map whose texels are made one by one from their directions.
    pub fn of(width: u32, height: u32, radiance: impl Fn(Vec3) -> Vec3) -> Self {
        let texels = (0..width * height).map(|i| {
            radiance(direction((i % width) as f32 + 0.5, (i / width) as f32 + 0.5, width, height))
        });
        Self { width, height, texels: texels.collect() }
    }

    /// Every texel: direction (unit), solid angle in steradians, radiance. Solid angles sum to 4 PI.
    pub fn each(&self) -> impl Iterator<Item = (Vec3, f32, Vec3)> {
        let (width, height) = (self.width, self.height);
        self.texels.iter().enumerate().map(move |(i, radiance)| {
            let (column, row) = (i as u32 % width, i as u32 / width);
            let at = direction(column as f32 + 0.5, row as f32 + 0.5, width, height);
            let band = |row: u32| (row as f32 * PI / height as f32).cos();
            let solid_angle = TAU / width as f32 * (band(row) - band(row + 1));
            (at, solid_angle, *radiance)
        })
    }

    /// Radiance from a direction (unit), between texels; twin of the shader's look-up.
    pub fn at(&self, direction: Vec3) -> Vec3 {
        let (width, height) = (self.width as i64, self.height as i64);
        let u = direction.x.atan2(-direction.z) / TAU + 0.5;
        let v = direction.y.clamp(-1.0, 1.0).acos() / PI;
        let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
        let (low_x, low_y) = (x.floor(), y.floor());
        let mut sum = Vec3::ZERO;
        for (column, weight_x) in [(low_x, 1.0 - (x - low_x)), (low_x + 1.0, x - low_x)] {
            for (row, weight_y) in [(low_y, 1.0 - (y - low_y)), (low_y + 1.0, y - low_y)] {
                let column = (column as i64).rem_euclid(width);
                let row = (row as i64).clamp(0, height - 1);
                sum += weight_x * weight_y * self.texels[(row * width + column) as usize];
            }
        }
        sum
    }

    /// The map turned about Y, anticlockwise as seen from above, and blurred to about `degrees`.
    pub fn turned_and_blurred(&self, turn_degrees: f32, degrees: f32) -> Self {
        let turn = Quat::from_rotation_y(-turn_degrees.to_radians());
        let turned = Self::of(self.width, self.height, |d| self.at(turn * d));
        // Boxes, three times over, are close to a Gaussian of the same variance.
        let sigma = degrees.clamp(0.0, 90.0) / 180.0 * self.height as f32;
        let half = ((4.0 * sigma * sigma + 1.0).sqrt() - 1.0) * 0.5;
        (0..3).fold(turned, |map, _| map.boxed(half.round() as i64))
    }

    /// Blurred by a box `half` texels to each side at the equator and as wide on the ball elsewhere.
    fn boxed(&self, half: i64) -> Self {
        if half < 1 {
            return self.clone();
        }
        let (width, height) = (self.width as i64, self.height as i64);
        let mut across = self.clone();
        for row in 0..height {
            let sine = ((row as f32 + 0.5) * PI / height as f32).sin();
            let reach = ((half as f32 / sine) as i64).min(width / 2);
            let line = &self.texels[(row * width) as usize..((row + 1) * width) as usize];
            let at = |x: i64| line[x.rem_euclid(width) as usize];
            let mut sum: Vec3 = (-reach..=reach).map(at).sum();
            for x in 0..width {
                across.texels[(row * width + x) as usize] = sum / (2 * reach + 1) as f32;
                sum += at(x + reach + 1) - at(x - reach);
            }
        }
        // Over a pole the line goes on half a turn away.
        let at = |x: i64, y: i64| match y {
            y if y < 0 => (((x + width / 2) % width), -1 - y),
            y if y >= height => (((x + width / 2) % width), 2 * height - 1 - y),
            y => (x, y),
        };
        let mut result = across.clone();
        let reach = half.min(height / 2);
        for x in 0..width {
            for y in 0..height {
                let sum: Vec3 = (-reach..=reach)
                    .map(|k| at(x, y + k))
                    .map(|(x, y)| across.texels[(y * width + x) as usize])
                    .sum();
                result.texels[(y * width + x) as usize] = sum / (2 * reach + 1) as f32;
            }
        }
        result
    }
}

/// The direction of a place in an equirectangular map, in texels from its upper left corner.
fn direction(x: f32, y: f32, width: u32, height: u32) -> Vec3 {
    let (sin_phi, cos_phi) = ((x / width as f32 - 0.5) * TAU).sin_cos();
    let (sin_theta, cos_theta) = (y / height as f32 * PI).sin_cos();
    Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
}

/// What is seen where there is nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Backdrop {
    /// A wall with a pool of light behind the subject: radiance in its middle and at the corners.
    Sweep {
        /// In the pool.
        middle: Vec3,
        /// In the corners.
        edge: Vec3,
    },
    /// One radiance everywhere.
    Plain(Vec3),
    /// The surroundings themselves.
    Map(Arc<RadianceMap>),
}

/// Light from all around, and what is seen behind the subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Radiance in the real spherical harmonics 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2.
    pub sh: [Vec3; 9],
    /// What is seen behind the subject; lights nothing.
    pub backdrop: Backdrop,
}

/// Constants of the harmonics, in their order.
const BASIS: [f32; 9] = [
    0.282_095, 0.488_603, 0.488_603, 0.488_603, 1.092_548, 1.092_548, 0.315_392, 1.092_548,
    0.546_274,
];

/// The nine harmonics in a direction.
fn harmonics(d: Vec3) -> [f32; 9] {
    let shapes = [
        1.0,
        d.y,
        d.z,
        d.x,
        d.x * d.y,
        d.y * d.z,
        3.0 * d.z * d.z - 1.0,
        d.x * d.z,
        d.x * d.x - d.y * d.y,
    ];
    std::array::from_fn(|k| BASIS[k] * shapes[k])
}

/// The coefficients of texels: direction, solid angle, radiance.
pub(crate) fn project(texels: impl Iterator<Item = (Vec3, f32, Vec3)>) -> [Vec3; 9] {
    let mut sums = [glam::DVec3::ZERO; 9];
    for (d, solid_angle, radiance) in texels {
        for (sum, y) in sums.iter_mut().zip(harmonics(d)) {
            *sum += (radiance * (y * solid_angle)).as_dvec3();
        }
    }
    sums.map(|s| s.as_vec3())
}

/// How dark the darkest direction may be, as a part of the mean.
const LEAST_RADIANCE: f32 = 0.02;

/// Bands 1 and 2 weakened as little as keeps light from being less than none: three bands cannot follow
/// a narrow lamp and swing below zero beside it. The window is 1 / (1 + k l^2 (l + 1)^2) (Sloan 2008,
/// "Stupid spherical harmonics tricks"); the mean stays.
pub(crate) fn without_ringing(sh: [Vec3; 9]) -> [Vec3; 9] {
    let windowed = |k: f32| {
        let mut sh = sh;
        for c in &mut sh[1..4] {
            *c /= 1.0 + 4.0 * k;
        }
        for c in &mut sh[4..] {
            *c /= 1.0 + 36.0 * k;
        }
        sh
    };
    let least = sh[0] * BASIS[0] * LEAST_RADIANCE;
    let lit = |sh: &[Vec3; 9]| {
        fibonacci(600).all(|d| {
            let terms = sh.iter().zip(harmonics(d));
            (terms.map(|(c, y)| *c * y).sum::<Vec3>() - least).min_element() >= 0.0
        })
    };
    let strengths = std::iter::once(0.0).chain((0..40).map(|i| 0.002 * 1.3f32.powi(i)));
    strengths
        .map(windowed)
        .find(lit)
        .unwrap_or_else(|| std::array::from_fn(|k| if k == 0 { sh[0] } else { Vec3::ZERO }))
}

/// Directions that are spread evenly over the sphere.
fn fibonacci(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f32 / count as f32;
        // The golden angle.
        let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
        let r = (1.0 - y * y).sqrt();
        Vec3::new(r * cos, y, r * sin)
    })
}

impl Environment {
    /// The environment of a radiance in every direction.
    pub fn of(radiance: impl Fn(Vec3) -> Vec3, backdrop: Backdrop) -> Self {
        // Twice as many texels as the narrowest studio lamp needs to be seen by some dozens of them.
        let sh = project(RadianceMap::of(128, 64, radiance).each());
        Self { sh: without_ringing(sh), backdrop }
    }

    /// A photographer's studio in grey: dim floor, walls that brighten upwards, a large soft box to the
    /// left of the camera, one overhead and a strip to the right behind.
    pub fn studio() -> Self {
        let backdrop = Backdrop::Sweep {
            middle: Vec3::new(0.150, 0.156, 0.170),
            edge: Vec3::new(0.033, 0.034, 0.037),
        };
        Self::of(studio, backdrop)
    }

    /// Radiance from around a direction (unit), blurred by a lobe that weighs bands 1 and 2 by
    /// `spread`; twin of `sky`.
    pub fn radiance(&self, n: Vec3, spread: [f32; 2]) -> Vec3 {
        let weight = |k: usize| match k {
            0 => 1.0,
            1..=3 => spread[0],
            _ => spread[1],
        };
        let terms = self.sh.iter().zip(harmonics(n)).enumerate();
        terms.map(|(k, (c, y))| *c * (y * weight(k))).sum::<Vec3>().max(Vec3::ZERO)
    }

    /// Irradiance of a surface that faces `n` (unit) and is covered by nothing.
    pub fn irradiance(&self, n: Vec3) -> Vec3 {
        PI * self.radiance(n, COSINE_LOBE)
    }

    /// Mean radiance over all directions.
    pub fn mean(&self) -> Vec3 {
        self.sh[0] * BASIS[0]
    }

    /// The harmonics as the frame block holds them.
    pub(crate) fn sky(&self) -> [[f32; 4]; 9] {
        self.sh.map(|c| c.extend(0.0).to_array())
    }

    /// Number of the backdrop's kind in the frame block.
    pub(crate) fn backdrop_kind(&self) -> u32 {
        match self.backdrop {
            Backdrop::Sweep { .. } => 0,
            Backdrop::Plain(_) => 1,
            Backdrop::Map(_) => 2,
        }
    }

    /// Width, height and texels of the texture that the shader draws the backdrop from: two texels for
    /// a sweep, one for a plain one, else the map. Alpha is 1.
    pub fn backdrop_map(&self) -> (u32, u32, Vec<[f32; 4]>) {
        let texel = |c: Vec3| c.extend(1.0).to_array();
        match &self.backdrop {
            Backdrop::Sweep { middle, edge } => (2, 1, vec![texel(*middle), texel(*edge)]),
            Backdrop::Plain(radiance) => (1, 1, vec![texel(*radiance)]),
            Backdrop::Map(map) => {
                (map.width, map.height, map.texels.iter().copied().map(texel).collect())
            }
        }
    }

    /// Turned as a whole, but for the backdrop, which is seen and not cast.
    pub fn turned(&self, turn: Quat) -> Self {
        let m = Mat3::from_quat(turn);
        // One channel: band 1 is a vector; band 2 is a symmetric matrix without trace, f(d) = d M d.
        let turned = |sh: [f32; 9]| -> [f32; 9] {
            let v = turn * Vec3::new(sh[3], sh[1], sh[2]);
            let c = |k: usize| sh[k] * BASIS[k];
            let (xx, yy, zz) = (c(8) - c(6), -c(8) - c(6), 2.0 * c(6));
            let (xy, yz, xz) = (0.5 * c(4), 0.5 * c(5), 0.5 * c(7));
            let band = m * Mat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
            let [x, y, z] = (band * m.transpose()).to_cols_array_2d();
            let shapes = [2.0 * x[1], 2.0 * y[2], 0.5 * z[2], 2.0 * x[2], 0.5 * (x[0] - y[1])];
            let [xy, yz, zz, xz, xx] = std::array::from_fn(|k| shapes[k] / BASIS[4 + k]);
            [sh[0], v.y, v.z, v.x, xy, yz, zz, xz, xx]
        };
        let [r, g, b] = std::array::from_fn(|channel| turned(self.sh.map(|c| c[channel])));
        let sh = std::array::from_fn(|k| Vec3::new(r[k], g[k], b[k]));
        Self { sh, backdrop: self.backdrop.clone() }
    }

    /// Without colour, as bright as before.
    pub(crate) fn grey(&self) -> Self {
        let grey = |c: Vec3| Vec3::splat(luminance(c));
        let backdrop = match &self.backdrop {
            Backdrop::Sweep { middle, edge } => {
                Backdrop::Sweep { middle: grey(*middle), edge: grey(*edge) }
            }
            Backdrop::Plain(radiance) => Backdrop::Plain(grey(*radiance)),
            Backdrop::Map(map) => {
                let texels = map.texels.iter().copied().map(grey).collect();
                Backdrop::Map(Arc::new(RadianceMap { texels, ..**map }))
            }
        };
        Self { sh: self.sh.map(grey), backdrop }
    }
}

/// Luminance of linear Rec.709.
pub(crate) fn luminance(c: Vec3) -> f32 {
    c.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Radiance of a soft lamp: 1 around its middle, falling to 0 at `width` (1 - cosine of the angle).
pub(crate) fn lamp(d: Vec3, middle: Vec3, width: f32) -> f32 {
    smoothstep((d.dot(middle.normalize()) - (1.0 - width)) / width)
}

fn studio(d: Vec3) -> Vec3 {
    let room = match d.y {
        y if y > 0.0 => Vec3::new(0.17, 0.18, 0.20).lerp(Vec3::new(0.44, 0.48, 0.54), y),
        y => Vec3::new(0.17, 0.18, 0.20).lerp(Vec3::new(0.13, 0.12, 0.11), (-4.0 * y).min(1.0)),
    };
    // As broad as three bands can follow.
    room + Vec3::new(1.22, 1.17, 1.08) * lamp(d, Vec3::new(-0.6, 0.6, 0.55), 0.42)
        + Vec3::new(0.95, 0.95, 1.00) * lamp(d, Vec3::new(0.0, 1.0, -0.3), 0.5)
        + Vec3::new(0.52, 0.60, 0.73) * lamp(d, Vec3::new(0.9, 0.25, -0.2), 0.42)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_close(ours: Vec3, theirs: Vec3, error: f32) {
        assert!((ours - theirs).abs().max_element() < error, "{ours} is not {theirs}");
    }

    fn directions() -> impl Iterator<Item = Vec3> {
        fibonacci(64)
    }

    #[test]
    fn even_light_has_the_same_radiance_and_irradiance_everywhere() {
        let environment = Environment::of(|_| Vec3::new(0.5, 1.0, 2.0), Backdrop::Plain(Vec3::ONE));
        for n in directions() {
            check_close(environment.radiance(n, [1.0, 1.0]), Vec3::new(0.5, 1.0, 2.0), 2e-3);
            check_close(environment.irradiance(n), PI * Vec3::new(0.5, 1.0, 2.0), 5e-3);
        }
    }

    #[test]
    fn irradiance_is_what_adding_up_all_directions_gives() {
        // Three bands hold irradiance to a few per cent of its largest value (Ramamoorthi & Hanrahan
        // 2001); keeping light from going below none costs some more.
        let map = RadianceMap::of(128, 64, studio);
        let plain = Environment { sh: project(map.each()), ..Environment::studio() };
        for (environment, error) in [(plain, 0.04), (Environment::studio(), 0.15)] {
            let most =
                directions().map(|n| environment.irradiance(n).max_element()).fold(0.0, f32::max);
            for n in directions() {
                let sum: Vec3 = map.each().map(|(d, w, l)| l * (w * d.dot(n).max(0.0))).sum();
                check_close(environment.irradiance(n), sum, error * most);
            }
        }
    }

    #[test]
    fn no_direction_is_darker_than_dark_and_the_mean_stays() {
        let sharp = |d: Vec3| Vec3::new(1.0, 0.5, 0.1) * lamp(d, Vec3::new(0.3, 0.8, 0.2), 0.02);
        let before = project(RadianceMap::of(128, 64, sharp).each());
        let after = without_ringing(before);
        assert_eq!(before[0], after[0]);
        assert!(after[1].x > 0.3 * before[1].x, "the lamp still comes from its side");
        let unclamped = |sh: &[Vec3; 9], d: Vec3| -> f32 {
            sh.iter().zip(harmonics(d)).map(|(c, y)| c.x * y).sum()
        };
        assert!(fibonacci(5000).any(|d| unclamped(&before, d) < 0.0));
        assert!(fibonacci(5000).all(|d| unclamped(&after, d) > 0.0));
        let smooth = project(RadianceMap::of(128, 64, |d| Vec3::splat(2.0 + d.y)).each());
        assert_eq!(without_ringing(smooth), smooth);
    }

    #[test]
    fn solid_angles_cover_the_sphere_once() {
        let map = RadianceMap::of(16, 8, |_| Vec3::ONE);
        let sum: f32 = map.each().map(|(_, solid_angle, _)| solid_angle).sum();
        assert!((sum - 4.0 * PI).abs() < 1e-4);
    }

    #[test]
    fn a_map_gives_back_what_it_was_made_of() {
        let smooth = |d: Vec3| d * 0.5 + 0.5;
        let map = RadianceMap::of(256, 128, smooth);
        for d in directions() {
            check_close(map.at(d), smooth(d), 0.02);
        }
        check_close(map.at(Vec3::NEG_Z), smooth(Vec3::NEG_Z), 0.02);
        let middle = map.texels[(64 * 256 + 128) as usize];
        check_close(middle, smooth(Vec3::NEG_Z), 0.03);
    }

    #[test]
    fn turning_the_harmonics_is_turning_the_light() {
        let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.3);
        let turned = Environment::studio().turned(turn);
        for n in directions() {
            let before = Environment::studio().radiance(turn.inverse() * n, [1.0, 1.0]);
            check_close(turned.radiance(n, [1.0, 1.0]), before, 1e-4);
        }
    }

    #[test]
    fn blurring_keeps_the_light_and_evens_it_out() {
        let spot = |d: Vec3| Vec3::splat(30.0 * lamp(d, Vec3::new(0.3, 0.2, -1.0), 0.02));
        let map = RadianceMap::of(256, 128, spot);
        let blurred = map.turned_and_blurred(90.0, 15.0);
        let sum = |m: &RadianceMap| m.each().map(|(_, w, l)| l.x * w).sum::<f32>();
        assert!((sum(&blurred) / sum(&map) - 1.0).abs() < 0.05, "{} {}", sum(&blurred), sum(&map));
        let peak = |m: &RadianceMap| m.texels.iter().map(|t| t.x).fold(0.0, f32::max);
        assert!(peak(&blurred) < 0.5 * peak(&map));
        let brightest =
            blurred.each().max_by(|a, b| a.2.x.total_cmp(&b.2.x)).map(|(d, ..)| d).unwrap();
        // Anticlockwise from above: what stood in front of -Z stands at -X now.
        let expected = Quat::from_rotation_y(90f32.to_radians()) * Vec3::new(0.3, 0.2, -1.0);
        assert!(brightest.dot(expected.normalize()) > 0.99, "{brightest}");
    }

    #[test]
    fn the_shader_gets_a_texture_of_the_kind_it_expects() {
        let of = |backdrop| {
            let environment = Environment { sh: [Vec3::ZERO; 9], backdrop };
            let (width, height, texels) = environment.backdrop_map();
            assert_eq!(texels.len() as u32, width * height);
            (environment.backdrop_kind(), width, height)
        };
        assert_eq!(of(Backdrop::Sweep { middle: Vec3::ONE, edge: Vec3::ZERO }), (0, 2, 1));
        assert_eq!(of(Backdrop::Plain(Vec3::ONE)), (1, 1, 1));
        let map = RadianceMap::of(256, 128, |d| d.abs());
        assert_eq!(of(Backdrop::Map(Arc::new(map))), (2, 256, 128));
    }
}
