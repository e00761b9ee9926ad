//! Pictures read as masks: one channel of a PNG or TIFF file, 16 bits a pixel.
//!
//! Guarantees: numbers as they stand in the file, without colour spaces; a picture that asks for more than it may is refused before
//! room for it is made. Read by the `image` crate, whose readers are the kept ones of each format. JPEG is refused: its standard leaves last bits to the
//! reader, and readers to the machine.

use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// The widest and highest picture, pixels.
const WIDEST: u32 = 16_384;
/// The most bytes that reading one may take.
const MOST_BYTES: u64 = 1 << 30;

/// Which number of a pixel is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// How light it is: the mean of red, green and blue by what the eye makes of each (Rec.709).
    Luminance,
    /// Red, green, blue or alpha, by number.
    Of(usize),
}

/// One channel of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grey {
    /// Pixels in a row.
    pub width: usize,
    /// Row by row from the top, 0 to 65535.
    pub pixels: Vec<u16>,
}

/// Reads a picture.
///
/// # Errors
/// What is wrong with the file, in one line.
pub fn read_picture(bytes: &[u8], channel: Channel) -> Result<Grey, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|err| format!("it cannot be read: {err}"))?;
    match reader.format() {
        Some(ImageFormat::Png | ImageFormat::Tiff) => {}
        Some(ImageFormat::Jpeg) => {
            let reason = "it is a JPEG, which no two programs read alike: save it as PNG or TIFF";
            return Err(reason.to_owned());
        }
        _ => return Err("it is no picture that can be read: give a PNG or TIFF file".to_owned()),
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(WIDEST);
    limits.max_image_height = Some(WIDEST);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let picture = reader.decode().map_err(|err| match err {
        image::ImageError::Limits(_) => {
            format!("it is too large: {WIDEST} pixels across and 1 GiB are the most")
        }
        err => format!("it cannot be read: {err}"),
    })?;
    let grey = match (channel, &picture) {
        // Half of all masks are grey, and need no room for what they have not.
        (Channel::Luminance | Channel::Of(0..=2), DynamicImage::ImageLuma8(grey)) => {
            grey.pixels().map(|p| u16::from(p.0[0]) * 257).collect()
        }
        (Channel::Luminance | Channel::Of(0..=2), DynamicImage::ImageLuma16(grey)) => {
            grey.pixels().map(|p| p.0[0]).collect()
        }
        _ => picture.to_rgba16().pixels().map(|p| number(p.0, channel)).collect(),
    };
    Ok(Grey { width: picture.width() as usize, pixels: grey })
}

fn number(rgba: [u16; 4], channel: Channel) -> u16 {
    match channel {
        Channel::Of(k) => rgba[k.min(3)],
        Channel::Luminance => {
            let [r, g, b, _] = rgba.map(u64::from);
            ((2126 * r + 7152 * g + 722 * b + 5000) / 10_000) as u16
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Rgba};

    fn png(pixels: Vec<u16>, width: u32) -> Vec<u8> {
        let height = pixels.len() as u32 / 4 / width;
        let all: ImageBuffer<Rgba<u16>, _> = ImageBuffer::from_raw(width, height, pixels).unwrap();
        let mut bytes = Cursor::new(vec![]);
        all.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn each_channel_is_read_as_it_stands_in_the_file() {
        let bytes = png(vec![65535, 0, 300, 65535, 0, 65535, 65535, 7], 2);
        for (channel, wanted) in [
            (Channel::Of(0), [65535, 0]),
            (Channel::Of(1), [0, 65535]),
            (Channel::Of(2), [300, 65535]),
            (Channel::Of(3), [65535, 7]),
            // 0.2126 and 0.0722 of the first, and all but red of the second.
            (Channel::Luminance, [13954, 51602]),
        ] {
            let read = read_picture(&bytes, channel).unwrap();
            assert_eq!((read.width, &read.pixels[..]), (2, &wanted[..]), "{channel:?}");
        }
    }

    #[test]
    fn what_is_no_picture_or_broken_is_refused_in_a_line() {
        let whole = png(vec![9; 4 * 64 * 64], 64);
        for (bytes, wanted) in [
            (&b""[..], "no picture"),
            (b"solid cube", "no picture"),
            (b"\xff\xd8\xff\xe0\0\x10JFIF", "JPEG"),
            (&whole[..40], "cannot be read"),
            (&whole[..whole.len() / 2], "cannot be read"),
        ] {
            let fault = read_picture(bytes, Channel::Luminance).unwrap_err();
            assert!(fault.contains(wanted) && !fault.contains('\n'), "{fault}");
        }
        // A picture that says it is 100,000 pixels wide.
        let mut huge = whole;
        huge[16..20].copy_from_slice(&100_000u32.to_be_bytes());
        assert!(read_picture(&huge, Channel::Luminance).is_err());
    }
}
