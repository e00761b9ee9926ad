//! Small pictures of few colours, for files in which they are text.
//!
//! Guaranteed: the same picture gives the same bytes, and no more of them than asked for.

use crate::display::Transform;
use crate::picture::{Picture, PictureError};
use color_quant::NeuQuant;

/// Colours of a small picture: enough for hair and skin, and 6 bits a pixel at most.
const COLOURS: usize = 64;

/// The bytes of a PNG with a palette, at most `most` of them: where they would be more, the picture is half as wide and high.
///
/// # Errors
/// When the picture has no pixels, or not even its smallest fits.
pub fn small_png(
    picture: &Picture,
    transform: Transform,
    exposure: f32,
    most: usize,
) -> Result<Vec<u8>, PictureError> {
    let bytes = palette_png(picture, transform, exposure)?;
    match bytes.len() <= most {
        true => Ok(bytes),
        false => small_png(&halved(picture), transform, exposure, most),
    }
}

fn palette_png(
    picture: &Picture,
    transform: Transform,
    exposure: f32,
) -> Result<Vec<u8>, PictureError> {
    let Picture { width, height, ref linear } = *picture;
    let pixels = linear.len();
    if pixels == 0 || pixels as u64 != u64::from(width) * u64::from(height) {
        return Err(PictureError::Size { width, height, pixels });
    }
    let shown = picture.encoded(transform, exposure);
    let palette = NeuQuant::new(1, COLOURS, &shown);
    let indices: Vec<u8> = shown.chunks_exact(4).map(|it| palette.index_of(it) as u8).collect();
    let mut out = vec![];
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.color_map_rgb());
    encoder.set_compression(png::Compression::High);
    // Numbers of colours are near each other by chance alone.
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&indices)?;
    writer.finish()?;
    Ok(out)
}

/// Half as wide and high: each pixel is the mean of four.
fn halved(picture: &Picture) -> Picture {
    let [width, height] = [picture.width / 2, picture.height / 2];
    let at = |x: u32, y: u32| picture.linear[y as usize * picture.width as usize + x as usize];
    let mean = |x: u32, y: u32| {
        let four = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
        std::array::from_fn(|channel| four.iter().map(|it| it[channel]).sum::<f32>() / 4.0)
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (2 * x, 2 * y)));
    Picture { width, height, linear: all.map(|(x, y)| mean(x, y)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_picture_has_the_colours_of_the_large_one_and_no_more_bytes_than_it_may() {
        let mut picture = Picture::plain(64, 64, [0.2, 0.1, 0.05, 1.0]);
        for (k, pixel) in picture.linear.iter_mut().enumerate() {
            // Noise, as hair is.
            let noise = (k as u32).wrapping_mul(2_654_435_761) >> 8;
            pixel[0] = (noise % 997) as f32 / 997.0;
        }
        let read = |most: usize| {
            let bytes = small_png(&picture, Transform::Srgb, 0.0, most).unwrap();
            assert!(bytes.len() <= most, "{} of {most}", bytes.len());
            let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
            decoder.set_transformations(png::Transformations::EXPAND);
            let mut reader = decoder.read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            (info.width, pixels)
        };
        let (width, pixels) = read(64 << 10);
        assert_eq!(width, 64);
        let shown = picture.encoded(Transform::Srgb, 0.0);
        let off = shown.chunks(4).zip(pixels.chunks(3)).map(|(a, b)| a[0].abs_diff(b[0]));
        assert!(off.clone().max() <= Some(24), "{:?}", off.max());
        // How small depends on who packs the bytes.
        assert!((8..=32).contains(&read(500).0));
        assert!(small_png(&picture, Transform::Srgb, 0.0, 9).is_err());
    }
}
