//! Surroundings from a photographed sphere: equirectangular Radiance HDR and OpenEXR pictures.
//!
//! A picture is reduced to 256 x 128 texels. Its one or two strongest lamps (sun, windows, soft boxes)
//! are taken out of it and become lights, because only lights cast the shadow of every strand; the rest
//! is light from all around. Together they give what the picture gave.
//!
//! Bytes are not trusted: anything gives a result or an error of one line, in memory in proportion to
//! the file. Not read: greyscale, luminance-chroma and deep OpenEXR, and pictures larger than
//! 8192 x 4096.

use crate::environment::{Backdrop, Environment, RadianceMap, luminance, project, without_ringing};
use crate::light::{GREY_CARD, Light, Rig};
use exr::prelude::{self as open_exr, ReadChannels as _, ReadLayers as _};
use glam::{DVec3, Quat, Vec3};
use image::ImageDecoder as _;
use std::f32::consts::{PI, TAU};
use std::io::Cursor;
use std::sync::Arc;

/// The largest picture that is read. More pixels would not change the light.
pub const LARGEST: (usize, usize) = (8192, 4096);
/// The smallest.
const SMALLEST: (usize, usize) = (8, 4);
/// Size that pictures are reduced to.
const REDUCED: (usize, usize) = (256, 128);
/// More channels in an OpenEXR file than any renderer writes.
const MOST_CHANNELS: usize = 256;
/// What a sample is held under; the sun is near 1e5 over a sky of 1.
const BRIGHTEST: f32 = 1e6;
/// A lamp's brightest texel is this many times the mean,
const LAMP_CONTRAST: f32 = 4.0;
/// it reaches no farther around that texel (cosine of 20 degrees),
const LAMP_REACH: f32 = 0.939_69;
/// and it gives at least this part of the irradiance that even light of the mean would give.
const LAMP_SHARE: f32 = 0.2;

/// Why a picture cannot light a scene. One line for a person.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HdriError {
    /// Neither of the two formats.
    #[error("this is neither a Radiance HDR nor an OpenEXR picture")]
    Format,
    /// A broken or unsupported file, in the reader's words.
    #[error("the {format} picture cannot be read: {reason}")]
    Broken {
        /// Which format it seems to be.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Too large, too small.
    #[error(
        "the picture has {0} x {1} pixels; from {small_w} x {small_h} to {w} x {h} are read",
        small_w = SMALLEST.0, small_h = SMALLEST.1, w = LARGEST.0, h = LARGEST.1
    )]
    Size(usize, usize),
    /// No sphere.
    #[error(
        "the picture has {0} x {1} pixels; an equirectangular one is twice as wide as it is high"
    )]
    Shape(usize, usize),
}

/// A photographed sphere, ready to be turned.
#[derive(Clone, Debug)]
pub struct Hdri {
    /// All of it.
    map: RadianceMap,
    /// Harmonics of what is left without the lights.
    rest: [Vec3; 9],
    /// The strongest first.
    lights: Vec<Light>,
}

impl Hdri {
    /// Reads the bytes of a `.hdr` or `.exr` file; which one it is, they tell themselves.
    ///
    /// # Errors
    /// When they are neither, are broken, are no equirectangular picture, or are too large.
    pub fn read(bytes: &[u8]) -> Result<Self, HdriError> {
        let map = match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => read_exr(bytes)?,
            [b'#', b'?', ..] => read_hdr(bytes)?,
            _ => return Err(HdriError::Format),
        };
        Ok(Self::of(map))
    }

    /// The surroundings of a map, with its lamps taken out.
    pub fn of(map: RadianceMap) -> Self {
        let (rest, lights) = without_lamps(&map);
        Self { rest: without_ringing(project(rest.each())), map, lights }
    }

    /// The lamps that were taken out, the strongest first; none or one or two.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// A rig that stays with the world, turned about Y by `turn_degrees` (anticlockwise as seen from
    /// above), with the picture blurred to about `blur_degrees` as its backdrop. Exposed so that a grey
    /// card comes to 18 % on the mean of all ways that it can stand.
    pub fn rig(&self, turn_degrees: f32, blur_degrees: f32) -> Rig {
        let sound = |v: f32| if v.is_finite() { v } else { 0.0 };
        let (turn_degrees, blur_degrees) = (sound(turn_degrees) % 360.0, sound(blur_degrees));
        let turn = Quat::from_rotation_y(turn_degrees.to_radians());
        let backdrop = Arc::new(self.map.turned_and_blurred(turn_degrees, blur_degrees));
        let environment = Environment { sh: self.rest, backdrop: Backdrop::Map(backdrop) };
        let light = |k: usize| match self.lights.get(k) {
            Some(light) => Light { towards: turn * light.towards, ..*light },
            None => Light::OFF,
        };
        let mut rig = Rig {
            lights: [light(0), light(1), Light::OFF],
            with_camera: false,
            environment: environment.turned(turn),
            exposure: 0.0,
        };
        let around = (0..16).map(|k| {
            let (sin, cos) = (k as f32 * TAU / 16.0).sin_cos();
            rig.grey_card(Vec3::new(sin, 0.0, cos))
        });
        let card = around.sum::<f32>() / 16.0;
        rig.exposure = (GREY_CARD / card.max(1e-9)).log2().clamp(-24.0, 24.0);
        rig
    }
}

/// Adds up samples into the texels of the reduced map, each by the solid angle that it covers.
struct Bins {
    size: (usize, usize),
    bins: (usize, usize),
    sums: Vec<DVec3>,
    weights: Vec<f64>,
}

impl Bins {
    fn new(size: (usize, usize)) -> Self {
        // Pictures that are smaller keep their size: a bin that gets no sample would be a hole.
        let bins = (REDUCED.0.min(size.0), REDUCED.1.min(size.1));
        let count = bins.0 * bins.1;
        Self { size, bins, sums: vec![DVec3::ZERO; count], weights: vec![0.0; count] }
    }

    fn add(&mut self, x: usize, y: usize, rgb: [f32; 3]) {
        let (column, row) = (x * self.bins.0 / self.size.0, y * self.bins.1 / self.size.1);
        let Some(bin) = self.sums.get_mut(row * self.bins.0 + column) else { return };
        let sound = |v: f32| if v.is_nan() { 0.0 } else { f64::from(v.clamp(0.0, BRIGHTEST)) };
        let weight = ((y as f64 + 0.5) / self.size.1 as f64 * std::f64::consts::PI).sin();
        *bin += DVec3::from_array(rgb.map(sound)) * weight;
        self.weights[row * self.bins.0 + column] += weight;
    }

    fn map(self) -> RadianceMap {
        let mean = |(sum, weight): (&DVec3, &f64)| (*sum / weight.max(1e-12)).as_vec3();
        RadianceMap {
            width: self.bins.0 as u32,
            height: self.bins.1 as u32,
            texels: self.sums.iter().zip(&self.weights).map(mean).collect(),
        }
    }
}

/// Refuses sizes that are no sphere's or too large.
fn check_size(width: usize, height: usize) -> Result<(), HdriError> {
    if width > LARGEST.0 || height > LARGEST.1 || width < SMALLEST.0 || height < SMALLEST.1 {
        return Err(HdriError::Size(width, height));
    }
    // Cropping by a pixel or two happens; another projection is never this near.
    if width.abs_diff(2 * height) * 50 > width {
        return Err(HdriError::Shape(width, height));
    }
    Ok(())
}

fn read_hdr(bytes: &[u8]) -> Result<RadianceMap, HdriError> {
    let broken =
        |reason: String| HdriError::Broken { format: "Radiance HDR", reason: one_line(&reason) };
    let decoder = image::codecs::hdr::HdrDecoder::new(Cursor::new(bytes))
        .map_err(|err| broken(err.to_string()))?;
    let (width, height) = decoder.dimensions();
    let size = (width as usize, height as usize);
    check_size(size.0, size.1)?;
    // No row is shorter than one pixel: keeps a short file from asking for much memory.
    if bytes.len() < 4 * size.1 {
        return Err(broken("it ends too early".to_owned()));
    }
    let mut samples = vec![0f32; size.0 * size.1 * 3];
    decoder
        .read_image(bytemuck::cast_slice_mut(&mut samples))
        .map_err(|err| broken(err.to_string()))?;
    let mut bins = Bins::new(size);
    for (k, rgb) in samples.chunks_exact(3).enumerate() {
        bins.add(k % size.0, k / size.0, [rgb[0], rgb[1], rgb[2]]);
    }
    Ok(bins.map())
}

fn read_exr(bytes: &[u8]) -> Result<RadianceMap, HdriError> {
    let broken =
        |reason: String| HdriError::Broken { format: "OpenEXR", reason: one_line(&reason) };
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|err| broken(err.to_string()))?;
    let mut found: Vec<String> = vec![];
    for header in &meta.headers {
        let (width, height) = (header.layer_size.x(), header.layer_size.y());
        if width > LARGEST.0 || height > LARGEST.1 {
            return Err(HdriError::Size(width, height));
        }
        if header.channels.list.len() > MOST_CHANNELS {
            return Err(broken(format!("it has {} channels", header.channels.list.len())));
        }
        found.extend(header.channels.list.iter().map(|channel| channel.name.to_string()));
        if let exr::meta::BlockDescription::Tiles(tiles) = &header.blocks {
            let (width, height) = (tiles.tile_size.x(), tiles.tile_size.y());
            if width > LARGEST.0 || height > LARGEST.1 {
                return Err(broken(format!("its tiles have {width} x {height} pixels")));
            }
        }
    }
    let is_coloured = ["R", "G", "B"].iter().all(|rgb| found.iter().any(|name| name == rgb));
    found.truncate(8);
    let grey =
        || format!("it has no channels R, G and B ({} alone): save it in colour", found.join(", "));
    let image = open_exr::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Bins::new((size.width(), size.height())),
            |bins, at, (r, g, b): (f32, f32, f32)| bins.add(at.x(), at.y(), [r, g, b]),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|err| broken(if is_coloured { err.to_string() } else { grey() }))?;
    let bins = image.layer_data.channel_data.pixels;
    check_size(bins.size.0, bins.size.1)?;
    Ok(bins.map())
}

/// A reader's message as one line of sane length.
fn one_line(text: &str) -> String {
    text.lines().next().unwrap_or("").chars().take(200).collect()
}

/// The map without its one or two strongest lamps, and these.
fn without_lamps(map: &RadianceMap) -> (RadianceMap, Vec<Light>) {
    let mut rest = map.clone();
    let mut lights = vec![];
    while lights.len() < 2 {
        let Some((light, taken)) = strongest_lamp(&rest) else { break };
        for (texel, taken) in rest.texels.iter_mut().zip(taken) {
            *texel = (*texel - taken).max(Vec3::ZERO);
        }
        lights.push(light);
    }
    lights.sort_by(|a, b| luminance(b.irradiance).total_cmp(&luminance(a.irradiance)));
    (rest, lights)
}

/// The strongest lamp of a map and what it takes from each texel: all that is brighter than twice the
/// mean, near the brightest texel.
fn strongest_lamp(map: &RadianceMap) -> Option<(Light, Vec<Vec3>)> {
    let flux: f32 = map.each().map(|(_, solid_angle, l)| luminance(l) * solid_angle).sum();
    let mean = flux / (4.0 * PI);
    // The first of equals, so that the result does not depend on anything but the map.
    let (middle, peak) = map.each().fold((Vec3::Y, 0.0), |best, (d, _, l)| {
        if luminance(l) > best.1 { (d, luminance(l)) } else { best }
    });
    if peak <= 0.0 || peak < LAMP_CONTRAST * mean {
        return None;
    }
    let ground = 2.0 * mean;
    let taken: Vec<Vec3> = map
        .each()
        .map(|(d, _, l)| match luminance(l) {
            bright if bright > ground && d.dot(middle) > LAMP_REACH => l * (1.0 - ground / bright),
            _ => Vec3::ZERO,
        })
        .collect();
    let (mut irradiance, mut moment) = (DVec3::ZERO, DVec3::ZERO);
    let (mut sum, mut sum_of_squares) = (0.0f64, 0.0f64);
    for ((d, solid_angle, _), taken) in map.each().zip(&taken) {
        let bright = f64::from(luminance(*taken));
        let solid_angle = f64::from(solid_angle);
        irradiance += taken.as_dvec3() * solid_angle;
        moment += d.as_dvec3() * (bright * solid_angle);
        sum += bright * solid_angle;
        sum_of_squares += bright * bright * solid_angle;
    }
    if sum < f64::from(LAMP_SHARE * PI * mean) {
        return None;
    }
    // The solid angle of an even lamp with the same sums, and the cone that covers it.
    let solid_angle = (sum * sum / sum_of_squares.max(1e-30)) as f32;
    let half = (1.0 - solid_angle / TAU).clamp(-1.0, 1.0).acos();
    let towards = moment.as_vec3().try_normalize().unwrap_or(middle);
    let light =
        Light { towards, irradiance: irradiance.as_vec3(), size_degrees: 2.0 * half.to_degrees() };
    Some((light, taken))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::lamp;
    use crate::picture::{Picture, Samples};

    const SUN: Vec3 = Vec3::new(0.5, 0.6, -0.7);
    const WINDOW: Vec3 = Vec3::new(-0.9, 0.2, 0.3);

    /// A sky with a small warm sun and a larger cool window.
    fn outside(d: Vec3) -> Vec3 {
        let sky = Vec3::new(0.3, 0.4, 0.6) * (0.4 + 0.6 * d.y.max(0.0));
        sky + Vec3::new(300.0, 260.0, 200.0) * lamp(d, SUN, 0.004)
            + Vec3::new(8.0, 10.0, 12.0) * lamp(d, WINDOW, 0.02)
    }

    /// The bytes of a radiance as a picture, RGBE without runs or OpenEXR.
    fn hdr_of(width: u32, height: u32, radiance: impl Fn(Vec3) -> Vec3) -> Vec<u8> {
        let mut bytes =
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
        for texel in RadianceMap::of(width, height, radiance).texels {
            let most = texel.max_element();
            if most < 1e-30 {
                bytes.extend([0; 4]);
                continue;
            }
            let exponent = most.log2().floor() as i32 + 1;
            let scale = 256.0 / (exponent as f32).exp2();
            let rgb = (texel * scale).to_array().map(|v| v.min(255.0) as u8);
            bytes.extend([rgb[0], rgb[1], rgb[2], (exponent + 128) as u8]);
        }
        bytes
    }

    fn exr_of(width: u32, height: u32, radiance: impl Fn(Vec3) -> Vec3) -> Vec<u8> {
        let map = RadianceMap::of(width, height, radiance);
        let linear = map.texels.iter().map(|t| t.extend(1.0).to_array()).collect();
        let mut bytes = vec![];
        Picture { width, height, linear }.write_exr(&mut bytes, Samples::Float, &[]).unwrap();
        bytes
    }

    /// A grey picture: one channel, Y.
    fn one_channel(width: usize, height: usize) -> Vec<u8> {
        use open_exr::WritableImage as _;
        let grey = open_exr::AnyChannel {
            name: "Y".into(),
            sample_data: open_exr::FlatSamples::F32(vec![1.0; width * height]),
            quantize_linearly: false,
            sampling: open_exr::Vec2(1, 1),
        };
        let channels = open_exr::AnyChannels::sort([grey].into_iter().collect());
        let mut bytes = Cursor::new(vec![]);
        let image = open_exr::Image::from_channels((width, height), channels);
        image.write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn directions() -> impl Iterator<Item = Vec3> {
        (0..60).map(|i| {
            let y = 1.0 - (2 * i + 1) as f32 / 60.0;
            let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
            let r = (1.0 - y * y).sqrt();
            Vec3::new(r * cos, y, r * sin)
        })
    }

    #[test]
    fn both_formats_give_the_light_that_they_were_made_of() {
        let of_map = Hdri::of(RadianceMap::of(256, 128, outside));
        for bytes in [hdr_of(256, 128, outside), exr_of(256, 128, outside)] {
            let read = Hdri::read(&bytes).unwrap();
            assert_eq!(read.lights.len(), 2);
            let (ours, theirs) = (read.rig(0.0, 0.0), of_map.rig(0.0, 0.0));
            for n in directions() {
                let (a, b) = (ours.grey_card(n), theirs.grey_card(n));
                assert!((a - b).abs() < 0.02 * b + 1e-4, "{n} {a} {b}");
            }
        }
    }

    #[test]
    fn lamps_become_lights_from_where_they_stand_and_of_their_size() {
        let hdri = Hdri::of(RadianceMap::of(256, 128, outside));
        let [sun, window] = hdri.lights() else { panic!("{:?}", hdri.lights()) };
        assert!(sun.towards.dot(SUN.normalize()) > 0.999, "{sun:?}");
        assert!(window.towards.dot(WINDOW.normalize()) > 0.999, "{window:?}");
        assert!(sun.irradiance.x > sun.irradiance.z && window.irradiance.z > window.irradiance.x);
        assert!(sun.size_degrees < window.size_degrees && sun.size_degrees > 1.0);
        assert!((4.0..24.0).contains(&window.size_degrees), "{window:?}");
    }

    #[test]
    fn light_is_moved_and_neither_made_nor_lost() {
        let map = RadianceMap::of(256, 128, outside);
        let total: Vec3 = map.each().map(|(_, solid_angle, l)| l * solid_angle).sum();
        let hdri = Hdri::of(map.clone());
        let lights: Vec3 = hdri.lights.iter().map(|l| l.irradiance).sum();
        let rest = hdri.rest[0] / 0.282_095;
        let off = ((lights + rest) / total - 1.0).abs().max_element();
        assert!(off < 2e-3, "{lights} and {rest} of {total}");
        // A lamp that stays in the surroundings as well would be counted twice here.
        let rig = hdri.rig(0.0, 0.0);
        let most = directions().map(|n| rig.grey_card(n)).fold(0.0, f32::max);
        for n in directions() {
            let sum: Vec3 = map.each().map(|(d, w, l)| l * (w * d.dot(n).max(0.0))).sum();
            let whole = GREY_CARD / PI * luminance(sum) * rig.exposure.exp2();
            let ours = rig.grey_card(n);
            assert!((ours - whole).abs() < 0.02 * most, "{n} {ours} {whole}");
        }
    }

    #[test]
    fn even_light_has_no_lamps() {
        let hdri = Hdri::of(RadianceMap::of(64, 32, |d| Vec3::splat(1.0 + 0.5 * d.y)));
        assert_eq!(hdri.lights(), []);
        let dark = Hdri::of(RadianceMap::of(64, 32, |_| Vec3::ZERO));
        assert_eq!(dark.lights(), []);
        assert!(dark.rig(0.0, 10.0).exposure.is_finite());
    }

    #[test]
    fn a_grey_card_comes_to_18_per_cent_on_the_mean_however_bright_the_picture_is() {
        for gain in [1e-3, 1.0, 500.0] {
            let hdri = Hdri::of(RadianceMap::of(128, 64, |d| outside(d) * gain));
            let rig = hdri.rig(20.0, 5.0);
            let around = (0..16).map(|k| {
                let (sin, cos) = (k as f32 * TAU / 16.0).sin_cos();
                rig.grey_card(Vec3::new(cos, 0.0, sin))
            });
            assert!((around.sum::<f32>() / 16.0 - 0.18).abs() < 1e-3);
        }
    }

    #[test]
    fn turning_takes_lights_surroundings_and_backdrop_along() {
        let hdri = Hdri::of(RadianceMap::of(256, 128, outside));
        let (still, turned) = (hdri.rig(0.0, 0.0), hdri.rig(90.0, 0.0));
        let turn = Quat::from_rotation_y(90f32.to_radians());
        for n in directions() {
            let (a, b) = (still.grey_card(n), turned.grey_card(turn * n));
            assert!((a - b).abs() < 0.01 * a + 1e-3, "{n} {a} {b}");
        }
        let Backdrop::Map(map) = &turned.environment.backdrop else { panic!("a map") };
        let brightest = map.each().max_by(|a, b| a.2.x.total_cmp(&b.2.x)).unwrap().0;
        assert!(brightest.dot((turn * SUN).normalize()) > 0.999, "{brightest}");
        assert!(turned.lights[0].towards.dot((turn * SUN).normalize()) > 0.999);
    }

    #[test]
    fn pictures_of_any_size_are_read() {
        for (width, height) in [(8, 4), (100, 50), (257, 129), (600, 300)] {
            let hdri = Hdri::read(&hdr_of(width, height, |d| d.abs())).unwrap();
            let mean = hdri.rig(0.0, 0.0).environment.mean();
            assert!((mean - 0.5).abs().max_element() < 0.05, "{width} {mean}");
            assert!(hdri.map.texels.iter().all(|t| t.max_element() > 0.0), "holes at {width}");
        }
    }

    #[test]
    fn samples_that_are_no_numbers_are_dark_and_infinite_ones_are_bounded() {
        let odd = |d: Vec3| match d.x {
            x if x > 0.9 => Vec3::NAN,
            x if x < -0.9 => Vec3::INFINITY,
            _ => Vec3::new(-1.0, 1.0, 1.0),
        };
        let hdri = Hdri::read(&exr_of(64, 32, odd)).unwrap();
        let rig = hdri.rig(f32::NAN, f32::INFINITY);
        assert!(rig.environment.sh.iter().all(|c| c.is_finite()) && rig.exposure.is_finite());
        assert!(rig.lights.iter().all(|l| l.irradiance.is_finite()));
    }

    #[track_caller]
    fn check_refused(bytes: &[u8], words: &str) {
        let error = Hdri::read(bytes).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    }

    #[test]
    fn what_is_no_sphere_of_light_is_refused_in_one_line() {
        let grey = |_| Vec3::ONE;
        check_refused(b"", "neither");
        check_refused(b"\x89PNG\r\n", "neither");
        check_refused(&hdr_of(64, 64, grey), "twice as wide");
        check_refused(&exr_of(60, 20, grey), "twice as wide");
        check_refused(&hdr_of(4, 2, grey), "from 8 x 4 to 8192 x 4096");
        let large = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 50000 +X 100000\n".to_vec();
        check_refused(&large, "100000 x 50000");
        let short = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\nabcd".to_vec();
        check_refused(&short, "cannot be read");
        let exr = exr_of(64, 32, grey);
        check_refused(&exr[..exr.len() / 2], "cannot be read");
        check_refused(
            &one_channel(64, 32),
            "has no channels R, G and B (Y alone): save it in colour",
        );
        check_refused(&exr[..30], "cannot be read");
    }

    #[test]
    fn broken_bytes_give_an_error_or_a_picture_and_never_a_panic() {
        let rough = |d: Vec3| outside(d) * (1.0 + 0.2 * (d.x * 91.0).sin() * (d.y * 57.0).cos());
        for whole in [hdr_of(32, 16, rough), exr_of(32, 16, rough)] {
            let mut word = 1u32;
            let mut next = || {
                word ^= word << 13;
                word ^= word >> 17;
                word ^= word << 5;
                word as usize
            };
            let mut refused = 0;
            for round in 0..600 {
                let mut bytes = whole.clone();
                // Mostly the header, where sizes are.
                let reach = if round % 3 == 0 { bytes.len() } else { bytes.len().min(420) };
                for _ in 0..1 + next() % 4 {
                    bytes[next() % reach] = [0, 1, 0x7f, 0x80, 0xff, next() as u8][next() % 6];
                }
                if round % 5 == 0 {
                    bytes.truncate(next() % whole.len());
                }
                match Hdri::read(&bytes) {
                    Ok(hdri) => assert!(hdri.rest.iter().all(|c| c.is_finite())),
                    Err(error) => {
                        refused += 1;
                        assert!(!error.to_string().contains('\n'));
                    }
                }
            }
            assert!(refused > 50);
        }
    }
}
