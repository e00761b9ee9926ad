//! Pictures: scene-linear light in memory, and PNG and OpenEXR bytes of it.
//!
//! Row 0 is the top. Guaranteed: the same picture gives the same bytes. A PNG shows the picture over its
//! backdrop, or keeps coverage for a picture over black; EXR keeps both.

use crate::display::{Transform, dithered};
use exr::prelude::{self as open_exr, WritableImage as _};
use glam::Vec3;
use std::io::{Cursor, Write};

/// A picture in scene-linear Rec.709.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row from the top: red, green, blue over the backdrop, and the part of the pixel that the
    /// subject covers.
    pub linear: Vec<[f32; 4]>,
}

/// How samples are kept in an OpenEXR file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Samples {
    /// 16 bits, 11 of them significant; up to 65504.
    #[default]
    Half,
    /// 32 bits, as they are.
    Float,
}

/// Why a picture was not written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// A picture without pixels, or whose pixels do not fit its size.
    #[error("a picture of {width} x {height} needs that many pixels and has {pixels}")]
    Size {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Pixels that are there.
        pixels: usize,
    },
    /// The PNG writer's own words.
    #[error("PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The OpenEXR writer's own words.
    #[error("OpenEXR: {0}")]
    Exr(#[from] exr::error::Error),
    /// The target took no more.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

impl Picture {
    /// A picture of one colour.
    pub fn plain(width: u32, height: u32, colour: [f32; 4]) -> Self {
        Self { width, height, linear: vec![colour; width as usize * height as usize] }
    }

    fn check(&self) -> Result<(), PictureError> {
        let pixels = self.linear.len();
        let fits = u64::from(self.width) * u64::from(self.height) == pixels as u64;
        if fits && pixels > 0 {
            return Ok(());
        }
        Err(PictureError::Size { width: self.width, height: self.height, pixels })
    }

    /// The display code values of every pixel and opaque alpha: red, green, blue, 255. `exposure` is in
    /// stops. Dithered by the pixel's number.
    pub fn encoded(&self, transform: Transform, exposure: f32) -> Vec<u8> {
        let gain = exposure.exp2();
        let pixels = self.linear.iter().enumerate();
        pixels
            .flat_map(|(k, [r, g, b, _])| {
                let shown = transform.apply(Vec3::new(*r, *g, *b) * gain);
                let [r, g, b] = dithered(shown, k as u32);
                [r, g, b, 255]
            })
            .collect()
    }

    /// Writes an 8-bit PNG. `texts` are keys and values of its metadata; the name of the transform and
    /// the exposure are added.
    ///
    /// # Errors
    /// When the picture has no pixels, a key is empty or longer than 79 letters, or `out` fails.
    pub fn write_png(
        &self,
        out: impl Write,
        transform: Transform,
        exposure: f32,
        texts: &[(String, String)],
    ) -> Result<(), PictureError> {
        let mut bytes = self.encoded(transform, exposure);
        let mut kept = 0;
        bytes.retain(|_| {
            kept += 1;
            kept % 4 != 0
        });
        self.put_png(out, png::ColorType::Rgb, &bytes, transform, exposure, texts)
    }

    /// The same of a picture over black, which is left out: coverage is in the alpha channel.
    ///
    /// # Errors
    /// As [`Self::write_png`].
    pub fn write_transparent_png(
        &self,
        out: impl Write,
        transform: Transform,
        exposure: f32,
        texts: &[(String, String)],
    ) -> Result<(), PictureError> {
        // PNG has colours that are not multiplied by coverage.
        let straight = |[r, g, b, a]: &[f32; 4]| match *a > 0.0 {
            true => [r / a, g / a, b / a, *a],
            false => [0.0; 4],
        };
        let own = Self { linear: self.linear.iter().map(straight).collect(), ..*self };
        let mut bytes = own.encoded(transform, exposure);
        for (bytes, [.., a]) in bytes.chunks_exact_mut(4).zip(&own.linear) {
            bytes[3] = (a.clamp(0.0, 1.0) * 255.0).round() as u8;
            if bytes[3] == 0 {
                bytes.fill(0);
            }
        }
        self.put_png(out, png::ColorType::Rgba, &bytes, transform, exposure, texts)
    }

    fn put_png(
        &self,
        out: impl Write,
        colour: png::ColorType,
        bytes: &[u8],
        transform: Transform,
        exposure: f32,
        texts: &[(String, String)],
    ) -> Result<(), PictureError> {
        self.check()?;
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(colour);
        encoder.set_depth(png::BitDepth::Eight);
        match transform {
            Transform::Agx | Transform::Srgb => {
                encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            }
            Transform::Rec1886 => {
                let scaled = png::ScaledFloat::new;
                encoder.set_source_gamma(scaled(1.0 / 2.4));
                encoder.set_source_chromaticities(png::SourceChromaticities::new(
                    (0.3127, 0.3290),
                    (0.64, 0.33),
                    (0.30, 0.60),
                    (0.15, 0.06),
                ));
            }
        }
        let own = [
            ("display".to_owned(), transform.name().to_owned()),
            ("exposure".to_owned(), format!("{exposure} stops")),
        ];
        for (key, text) in texts.iter().chain(&own) {
            // tEXt holds Latin-1 only; most readers know it best.
            if text.chars().all(|c| u32::from(c) < 256 && c != '\0') {
                encoder.add_text_chunk(key.clone(), text.clone())?;
            } else {
                encoder.add_itxt_chunk(key.clone(), text.replace('\0', " "))?;
            }
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        writer.finish()?;
        Ok(())
    }

    /// Writes an OpenEXR file: scene-linear, without exposure and display transform, colours over the
    /// backdrop, coverage in A. `texts` become attributes
    /// with `coif.` before their keys, because many plain names are the format's own.
    ///
    /// # Errors
    /// When the picture has no pixels or `out` fails.
    pub fn write_exr(
        &self,
        mut out: impl Write,
        samples: Samples,
        texts: &[(String, String)],
    ) -> Result<(), PictureError> {
        self.check()?;
        let software_name = Some(open_exr::Text::from("coif"));
        let mut layer = open_exr::LayerAttributes { software_name, ..Default::default() };
        for (key, text) in texts.iter().filter(|(key, _)| !key.is_empty()) {
            // The format's texts are Latin-1; what it has no letter for is marked.
            let latin = |t: &str| {
                let plain = |c: char| if u32::from(c) < 256 && c != '\0' { c } else { '?' };
                open_exr::Text::new_or_none(t.chars().map(plain).collect::<String>())
            };
            if let (Some(key), Some(text)) = (latin(&format!("coif.{key}")), latin(text)) {
                layer.other.insert(key, open_exr::AttributeValue::Text(text));
            }
        }
        let channel = |name: &str, k: usize| {
            let values = self.linear.iter().map(|p| p[k]);
            let samples = match samples {
                // Infinity would spread through every filter that is run over the file.
                Samples::Half => open_exr::FlatSamples::F16(
                    values.map(|v| open_exr::f16::from_f32(v.clamp(-65504.0, 65504.0))).collect(),
                ),
                Samples::Float => open_exr::FlatSamples::F32(values.collect()),
            };
            open_exr::AnyChannel::new(name, samples)
        };
        let channels = [("A", 3), ("B", 2), ("G", 1), ("R", 0)].map(|(name, k)| channel(name, k));
        let channels = open_exr::AnyChannels::sort(channels.into_iter().collect());
        let encoding = open_exr::Encoding {
            compression: open_exr::Compression::ZIP16,
            blocks: open_exr::Blocks::ScanLines,
            line_order: open_exr::LineOrder::Increasing,
        };
        let size = (self.width as usize, self.height as usize);
        let mut image =
            open_exr::Image::from_layer(open_exr::Layer::new(size, layer, encoding, channels));
        // Rec.709 and D65, so that readers need not guess.
        image.attributes.chromaticities = Some(exr::meta::attribute::Chromaticities {
            red: open_exr::Vec2(0.64, 0.33),
            green: open_exr::Vec2(0.30, 0.60),
            blue: open_exr::Vec2(0.15, 0.06),
            white: open_exr::Vec2(0.3127, 0.3290),
        });
        let mut bytes = Cursor::new(vec![]);
        image.write().non_parallel().to_buffered(&mut bytes)?;
        let mut bytes = bytes.into_inner();
        sort_attributes(&mut bytes);
        out.write_all(&bytes)?;
        Ok(())
    }
}

/// Puts the attributes of an OpenEXR header in the order of their names. The writer keeps some of them
/// in a hash map, whose order is another one each time; the header's length stays, so that nothing
/// else in the file moves. (Layout: openexr.com, "OpenEXR File Layout": magic number and version, 4
/// bytes each, then name, 0, type, 0, size, value, and a 0 at the end.)
fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8;
    let mut attributes: Vec<&[u8]> = vec![];
    let mut at = START;
    while file.get(at).is_some_and(|b| *b != 0) {
        let text_end =
            |from: usize| file[from..].iter().position(|b| *b == 0).map(|n| from + n + 1);
        let Some(size_at) = text_end(at).and_then(text_end) else { return };
        let Some(size) = file.get(size_at..size_at + 4) else { return };
        let size = u32::from_le_bytes([size[0], size[1], size[2], size[3]]) as usize;
        let Some(attribute) = file.get(at..size_at + 4 + size) else { return };
        attributes.push(attribute);
        at = size_at + 4 + size;
    }
    attributes.sort_unstable();
    let sorted = attributes.concat();
    file[START..at].copy_from_slice(&sorted);
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels as _, ReadLayers as _};

    /// 12 x 8 pixels, no two alike; red grows to the right and green downwards.
    fn picture() -> Picture {
        let pixel = |i: usize| {
            let (x, y) = (i % 12, i / 12);
            [x as f32 / 6.0, y as f32 / 8.0, (i as f32 / 96.0).powi(3), 1.0 - y as f32 / 16.0]
        };
        Picture { width: 12, height: 8, linear: (0..96).map(pixel).collect() }
    }

    fn texts() -> Vec<(String, String)> {
        let text = |key: &str, text: &str| (key.to_owned(), text.to_owned());
        vec![
            text("graph", "afro.ron"),
            text("preview", "final"),
            text("camera", "three-quarter"),
            text("note", "日本 é"),
        ]
    }

    fn png_of(transform: Transform) -> (png::Reader<Cursor<Vec<u8>>>, Vec<u8>) {
        let mut bytes = vec![];
        picture().write_png(&mut bytes, transform, 0.5, &texts()).unwrap();
        read_png(bytes)
    }

    fn read_png(bytes: Vec<u8>) -> (png::Reader<Cursor<Vec<u8>>>, Vec<u8>) {
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        reader.finish().unwrap();
        (reader, pixels)
    }

    #[test]
    fn png_holds_the_encoded_pixels_from_the_top_and_says_how_they_were_made() {
        for transform in Transform::ALL {
            let (reader, pixels) = png_of(transform);
            let encoded = picture().encoded(transform, 0.5);
            let rgb: Vec<u8> = encoded.chunks(4).flat_map(|p| p[..3].to_vec()).collect();
            assert_eq!(pixels, rgb);
            assert!(pixels[12 * 3 * 7 + 1] > pixels[1] + 50, "green grows downwards");
            let info = reader.info();
            assert_eq!(info.srgb.is_some(), transform != Transform::Rec1886);
            let mut said: Vec<(String, String)> = info
                .uncompressed_latin1_text
                .iter()
                .map(|t| (t.keyword.clone(), t.text.clone()))
                .collect();
            let wide = info.utf8_text.iter().map(|t| (t.keyword.clone(), t.get_text().unwrap()));
            said.extend(wide);
            for pair in texts() {
                assert!(said.contains(&pair), "{pair:?} in {said:?}");
            }
            assert!(said.contains(&("display".into(), transform.name().into())));
            assert!(said.contains(&("exposure".into(), "0.5 stops".into())));
        }
    }

    #[test]
    fn a_transparent_png_has_the_colours_of_what_covers_and_how_much_does() {
        let colour = [0.3, 0.2, 0.1];
        let covered = [1.0, 0.5, 0.001, 0.0];
        let linear = covered.map(|a| [colour[0] * a, colour[1] * a, colour[2] * a, a]).to_vec();
        let picture = Picture { width: 4, height: 1, linear };
        let mut bytes = vec![];
        picture.write_transparent_png(&mut bytes, Transform::Srgb, 0.0, &texts()).unwrap();
        let (_, pixels) = read_png(bytes);
        let alphas: Vec<u8> = pixels.chunks(4).map(|pixel| pixel[3]).collect();
        assert_eq!(alphas, [255, 128, 0, 0]);
        // A step of 255 is the dither's.
        for k in 0..3 {
            assert!(pixels[k].abs_diff(pixels[4 + k]) <= 1, "half covered, of one colour");
        }
        assert!(pixels[0] > pixels[1] + 20 && pixels[1] > pixels[2] + 20);
        assert_eq!(pixels[8..], [0; 8], "nothing is behind it");
    }

    fn check_exr(samples: Samples, error: f32) {
        let mut bytes = vec![];
        picture().write_exr(&mut bytes, samples, &texts()).unwrap();
        let image = open_exr::read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size, _| vec![vec![[0f32; 4]; size.width()]; size.height()],
                |rows, at, (r, g, b, a): (f32, f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b, a],
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let layer = image.layer_data;
        let read: Vec<[f32; 4]> = layer.channel_data.pixels.concat();
        for (ours, theirs) in picture().linear.iter().flatten().zip(read.iter().flatten()) {
            assert!((ours - theirs).abs() <= error * (ours.abs() + 1e-4), "{ours} {theirs}");
        }
        for (key, text) in texts().iter().filter(|(_, text)| text.is_ascii()) {
            let key = format!("coif.{key}");
            let found = &layer.attributes.other[&open_exr::Text::from(key.as_str())];
            assert_eq!(found, &open_exr::AttributeValue::Text(text.as_str().into()));
        }
        assert!(image.attributes.chromaticities.is_some());
    }

    #[test]
    fn exr_keeps_linear_light_coverage_and_texts() {
        check_exr(Samples::Float, 0.0);
        check_exr(Samples::Half, 1.0 / 2048.0);
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        let write = |samples| {
            let mut bytes = vec![];
            picture().write_exr(&mut bytes, samples, &texts()).unwrap();
            bytes
        };
        for samples in [Samples::Half, Samples::Float] {
            let first = write(samples);
            for _ in 0..8 {
                assert!(write(samples) == first, "{samples:?}");
            }
        }
        assert_eq!(png_of(Transform::Agx).1, png_of(Transform::Agx).1);
    }

    #[test]
    fn values_that_half_floats_cannot_hold_stay_finite() {
        let picture = Picture::plain(2, 2, [1e9, -1e9, 0.0, 1.0]);
        let mut bytes = vec![];
        picture.write_exr(&mut bytes, Samples::Half, &[]).unwrap();
        let encoded = Picture::plain(1, 1, [f32::NAN, f32::INFINITY, -1.0, 1.0]);
        let encoded = encoded.encoded(Transform::Srgb, 0.0);
        assert_eq!(encoded, [0, 255, 0, 255]);
    }

    #[test]
    fn exposure_is_in_stops() {
        let dim = Picture::plain(1, 1, [0.1, 0.1, 0.1, 1.0]);
        let bright = Picture::plain(1, 1, [0.4, 0.4, 0.4, 1.0]);
        let srgb = Transform::Srgb;
        assert_eq!(dim.encoded(srgb, 2.0), bright.encoded(srgb, 0.0));
    }

    #[test]
    fn a_picture_that_does_not_fit_its_size_is_refused() {
        let broken = Picture { width: 3, ..Picture::plain(2, 2, [0.0; 4]) };
        let empty = Picture::plain(0, 5, [0.0; 4]);
        for picture in [broken, empty] {
            let png = picture.write_png(&mut vec![], Transform::Agx, 0.0, &[]);
            assert!(matches!(png, Err(PictureError::Size { .. })));
            let exr = picture.write_exr(&mut vec![], Samples::Half, &[]);
            assert!(matches!(exr, Err(PictureError::Size { .. })));
        }
        let key = ("k".repeat(80), "too long a key".to_owned());
        let long = Picture::plain(1, 1, [0.0; 4]);
        assert!(long.write_png(&mut vec![], Transform::Agx, 0.0, &[key]).is_err());
    }
}
