//! Pictures read as masks: one channel of a PNG or TIFF file, 16 bits a pixel.
//!
//! Guarantees: numbers as they stand in the file, without colour spaces; a picture that is larger than it may be is refused before
//! room for it is made. Read by the `image` crate, whose readers are the kept ones of each format. JPEG is refused, in a TIFF too:
//! its standard leaves last bits to the reader, and readers to the machine. So are numbers of 32 bits, and pictures that are stored
//! turned.

use image::metadata::Orientation;
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::io::Cursor;
use tiff::tags::{CompressionMethod, Tag};

/// The most pixels of a picture: 8192 by 8192.
const MOST: u64 = 1 << 26;
/// What is wrong is quoted up to so many letters.
const QUOTED: usize = 80;

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
/// What is wrong with the file and what to do, in one line.
pub fn read_picture(bytes: &[u8], channel: Channel) -> Result<Grey, String> {
    let plain = without_profile(bytes);
    let reader = ImageReader::new(Cursor::new(&*plain));
    let mut reader =
        reader.with_guessed_format().map_err(|err| format!("it cannot be read: {err}"))?;
    match reader.format() {
        Some(ImageFormat::Png) => {}
        Some(ImageFormat::Tiff) if is_jpeg(bytes) => return Err(JPEG.to_owned()),
        Some(ImageFormat::Tiff) => {}
        Some(ImageFormat::Jpeg) => return Err(JPEG.to_owned()),
        Some(ImageFormat::OpenExr) => {
            return Err(format!("it is an OpenEXR, which is not read here: {SAVE}"));
        }
        Some(ImageFormat::WebP) => return Err(format!("it is a WebP, which is not read: {SAVE}")),
        _ => return Err("it is no picture that can be read: give a PNG or TIFF file".to_owned()),
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(8 * MOST);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(|err| told(&err))?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    if count > MOST {
        return Err(format!(
            "it has {width} x {height} pixels, more than 8192 x 8192: save it smaller"
        ));
    }
    if decoder.orientation().is_ok_and(|way| way != Orientation::NoTransforms) {
        return Err("it is stored turned or mirrored: save it upright".to_owned());
    }
    let (numbers, wide): (usize, bool) = match decoder.color_type() {
        ColorType::L8 => (1, false),
        ColorType::La8 => (2, false),
        ColorType::Rgb8 => (3, false),
        ColorType::Rgba8 => (4, false),
        ColorType::L16 => (1, true),
        ColorType::La16 => (2, true),
        ColorType::Rgb16 => (3, true),
        ColorType::Rgba16 => (4, true),
        _ => return Err(format!("its numbers have neither 8 nor 16 bits: {SAVE}")),
    };
    let room = usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX);
    let mut raw: Vec<u8> = vec![];
    let mut pixels: Vec<u16> = vec![];
    if raw.try_reserve_exact(room).is_err() || pixels.try_reserve_exact(count as usize).is_err() {
        return Err(format!("there is no memory for its {width} x {height} pixels"));
    }
    raw.resize(room, 0);
    decoder.read_image(&mut raw).map_err(|err| told(&err))?;
    let each = numbers * if wide { 2 } else { 1 };
    let at = |pixel: &[u8], k: usize| match wide {
        true => u16::from_ne_bytes([pixel[2 * k], pixel[2 * k + 1]]),
        false => u16::from(pixel[k]) * 257,
    };
    // Grey is its own red, green and blue.
    let coloured = numbers > 2;
    let alpha = numbers.is_multiple_of(2).then(|| numbers - 1);
    pixels.extend(raw.chunks_exact(each).map(|pixel| match channel {
        Channel::Of(3..) => alpha.map_or(u16::MAX, |k| at(pixel, k)),
        Channel::Of(k) => at(pixel, if coloured { k } else { 0 }),
        Channel::Luminance if coloured => {
            let [r, g, b] = [0, 1, 2].map(|k| u64::from(at(pixel, k)));
            ((2126 * r + 7152 * g + 722 * b + 5000) / 10_000) as u16
        }
        Channel::Luminance => at(pixel, 0),
    }));
    Ok(Grey { width: width as usize, pixels })
}

/// What is wrong with the name of a texture in tiles (`head.<UDIM>.png`), which is no file's; none where it is not one.
pub fn tiles_fault(path: &str) -> Option<&'static str> {
    let lower = path.to_ascii_lowercase();
    let is_tiles = ["<udim>", "<uvtile>", "%(udim)d", "<u>", "<v>"];
    is_tiles.iter().any(|mark| lower.contains(mark)).then_some(
        "names a texture of several tiles (UDIM), which is not read: give the picture of the tile that the scalp lies in, such as \
         name.1001.png",
    )
}

/// A PNG without its colour profile; any other bytes as they are.
///
/// Profiles are not read, but the reader would unpack them: 200 KB of a file become 200 MB.
pub fn without_profile(bytes: &[u8]) -> Cow<'_, [u8]> {
    const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
    // Length, kind and sum of a chunk, besides its data.
    const FRAME: usize = 12;
    let mut at = SIGNATURE.len();
    let mut plain: Option<Vec<u8>> = None;
    while bytes.starts_with(SIGNATURE)
        && let Some([a, b, c, d, kind @ ..]) = bytes.get(at..).and_then(<[u8]>::first_chunk::<8>)
        && kind != b"IDAT"
        && let length = u32::from_be_bytes([*a, *b, *c, *d]) as usize
        && let Some(chunk) = bytes.get(at..).and_then(|rest| rest.get(..FRAME + length))
    {
        match (kind == b"iCCP", &mut plain) {
            (true, None) => plain = Some(bytes[..at].to_vec()),
            (false, Some(plain)) => plain.extend_from_slice(chunk),
            _ => {}
        }
        at += chunk.len();
    }
    match plain {
        Some(mut plain) => {
            plain.extend_from_slice(&bytes[at..]);
            Cow::Owned(plain)
        }
        None => Cow::Borrowed(bytes),
    }
}

const SAVE: &str = "save it as a PNG or TIFF of 8 or 16 bits, grey or RGB";
const JPEG: &str = "it is a JPEG, which no two programs read alike: save it as PNG or TIFF";

/// Whether the pixels of a TIFF are a JPEG.
fn is_jpeg(bytes: &[u8]) -> bool {
    let tag = tiff::decoder::Decoder::new(Cursor::new(bytes))
        .and_then(|mut tiff| tiff.find_tag_unsigned::<u16>(Tag::Compression));
    // As the standard has it, and as it was before.
    let jpeg = [CompressionMethod::ModernJPEG, CompressionMethod::JPEG].map(|way| way.to_u16());
    matches!(tag, Ok(Some(way)) if jpeg.contains(&way))
}

/// What a reader says, and what to do.
fn told(err: &ImageError) -> String {
    let text: String =
        err.to_string().lines().next().unwrap_or_default().chars().take(QUOTED).collect();
    match err {
        ImageError::Unsupported(_) => format!("it is of a kind that is not read ({text}): {SAVE}"),
        ImageError::Limits(_) => {
            "it takes more room than a picture may: save it smaller".to_owned()
        }
        _ => format!("it is broken or cut short ({text}): save it anew"),
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
    fn names_of_tiles_are_told() {
        for name in ["head.<UDIM>.png", "a/<udim>.tif", "x_<UVTILE>.png", "x.%(UDIM)d.tx"] {
            assert!(tiles_fault(name).is_some(), "{name}");
        }
        for name in ["head.1001.png", "udim/a.png", "<other>.png"] {
            assert_eq!(tiles_fault(name), None, "{name}");
        }
    }

    #[test]
    fn a_colour_profile_is_not_unpacked() {
        let whole = png((0..4 * 64 * 64).collect(), 64);
        // Between the header, of 33 bytes, and the pixels.
        let with = |profile: &[u8]| {
            let length = (profile.len() as u32 - 4).to_be_bytes();
            let mut bytes = whole[..33].to_vec();
            for _ in 0..2 {
                bytes.extend([&length[..], profile, &[0; 4]].concat());
            }
            [&bytes[..], &whole[33..]].concat()
        };
        let bytes = with(b"iCCPname\0\0unpacked it is 200 MB");
        assert_eq!(*without_profile(&bytes), whole);
        // A reader of profiles refuses a second one.
        assert_eq!(
            read_picture(&bytes, Channel::Luminance),
            read_picture(&whole, Channel::Luminance)
        );
        let others = with(b"tEXtSoftware\0coif");
        for bytes in [&whole[..], &others, &bytes[..40], &bytes[..20], b""] {
            assert!(matches!(without_profile(bytes), Cow::Borrowed(same) if same == bytes));
        }
    }

    #[test]
    fn what_is_no_picture_or_broken_is_refused_in_a_line() {
        let whole = png(vec![9; 4 * 64 * 64], 64);
        for (bytes, wanted) in [
            (&b""[..], "no picture"),
            (b"solid cube", "no picture"),
            (b"\xff\xd8\xff\xe0\0\x10JFIF", "JPEG"),
            (
                b"\x76\x2f\x31\x01\x02\0\0\0",
                "OpenEXR, which is not read here: save it as a PNG or TIFF",
            ),
            (b"RIFF\x08\0\0\0WEBPVP8L", "WebP, which is not read: save it as a PNG or TIFF"),
            (&whole[..40], "broken or cut short"),
            (&whole[..whole.len() / 2], "broken or cut short"),
        ] {
            let fault = read_picture(bytes, Channel::Luminance).unwrap_err();
            assert!(fault.contains(wanted) && !fault.contains('\n'), "{fault}");
        }
        // A picture that says it is 100,000 pixels wide.
        let mut huge = whole;
        huge[16..20].copy_from_slice(&100_000u32.to_be_bytes());
        assert!(read_picture(&huge, Channel::Luminance).is_err());
        // One of nothing but black: small as a file, 256 MB as pixels.
        let mut bytes = Cursor::new(vec![]);
        image::GrayImage::new(16_384, 16_384).write_to(&mut bytes, ImageFormat::Png).unwrap();
        let fault = read_picture(&bytes.into_inner(), Channel::Luminance).unwrap_err();
        assert!(fault.contains("16384 x 16384") && fault.contains("smaller"), "{fault}");
        // Numbers of 32 bits, and of a TIFF what is in it.
        let mut bytes = Cursor::new(vec![]);
        let all = image::Rgb32FImage::new(4, 4);
        image::DynamicImage::from(all).write_to(&mut bytes, ImageFormat::Tiff).unwrap();
        let fault = read_picture(&bytes.into_inner(), Channel::Luminance).unwrap_err();
        assert!(fault.contains("8 or 16 bits"), "{fault}");
        assert!(!is_jpeg(b"II*\0"));
    }
}
