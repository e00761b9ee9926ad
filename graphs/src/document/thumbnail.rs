//! The small picture of a template: PNG bytes that travel in its file, as base64.
//!
//! Guarantees: what is a [`Thumbnail`] is framed as a PNG, at most 256 KiB of text and 1024 pixels a side, told by its header before
//! any pixel is decoded. Not guaranteed: that its pixels can be decoded; who shows it says so.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt;
use std::sync::Arc;

/// A small picture. Cloning shares the bytes.
#[derive(Clone, PartialEq, Eq)]
pub struct Thumbnail(Arc<[u8]>);

impl Thumbnail {
    /// The longest text that is read, bytes of base64.
    pub const LONGEST: usize = 256 << 10;
    /// The most pixels of a side.
    pub const WIDEST: u32 = 1024;
    /// The longest text that coif itself writes.
    pub const WRITTEN: usize = 64 << 10;

    /// A picture of PNG bytes.
    ///
    /// # Errors
    /// It is none that is kept: why, in one line.
    pub fn new(png: Vec<u8>) -> Result<Self, String> {
        let text = png.len().div_ceil(3).saturating_mul(4);
        if text > Self::LONGEST {
            let most = Self::LONGEST >> 10;
            return Err(format!("it is {} KiB of text, at most {most} are read", text >> 10));
        }
        let [width, height] = size_of(&png)?;
        let most = Self::WIDEST;
        match (1..=most).contains(&width) && (1..=most).contains(&height) {
            true => Ok(Self(png.into())),
            false => {
                Err(format!("it says {width} x {height} pixels, 1 to {most} are read of each side"))
            }
        }
    }

    /// A picture from the text of a file.
    ///
    /// # Errors
    /// As [`Self::new`], and where the text is no base64.
    pub fn from_text(text: &str) -> Result<Self, String> {
        if text.len() > Self::LONGEST {
            let most = Self::LONGEST >> 10;
            return Err(format!("it is {} KiB of text, at most {most} are read", text.len() >> 10));
        }
        let bytes = STANDARD.decode(text).map_err(|err| format!("it is no base64: {err}"))?;
        Self::new(bytes)
    }

    /// The text that files hold.
    pub fn text(&self) -> String {
        STANDARD.encode(&self.0)
    }

    /// The PNG.
    pub fn png(&self) -> &[u8] {
        &self.0
    }

    /// Width and height in pixels, as the header says.
    pub fn size(&self) -> [u32; 2] {
        size_of(&self.0).unwrap_or_default()
    }
}

impl fmt::Debug for Thumbnail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl fmt::Display for Thumbnail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size();
        write!(f, "a picture of {width} x {height}, {} bytes", self.0.len())
    }
}

/// Width and height that a PNG's header says, where its chunks follow each other to its end.
fn size_of(png: &[u8]) -> Result<[u32; 2], String> {
    const BEGIN: &[u8] = b"\x89PNG\r\n\x1a\n";
    let not = |why: &str| format!("it is no PNG: {why}");
    let mut rest = png.strip_prefix(BEGIN).ok_or_else(|| not("it does not begin as one"))?;
    let mut size = None;
    loop {
        let Some((head, after)) = rest.split_first_chunk::<8>() else {
            return Err(not("it is cut off"));
        };
        let word = |at: usize, of: &[u8]| -> Option<u32> {
            Some(u32::from_be_bytes(of.get(at..at + 4)?.try_into().ok()?))
        };
        let length = word(0, head).and_then(|n| usize::try_from(n).ok()).unwrap_or(usize::MAX);
        let chunk = after.get(..length).ok_or_else(|| not("it is cut off"))?;
        // Behind each chunk is its sum.
        let next = after[length..].get(4..).ok_or_else(|| not("it is cut off"))?;
        match (&head[4..], &size) {
            (b"IHDR", None) => size = word(0, chunk).zip(word(4, chunk)).map(|(w, h)| [w, h]),
            (_, None) => return Err(not("it has no header")),
            (b"IEND", Some(size)) if next.is_empty() => return Ok(*size),
            (b"IEND", Some(_)) => return Err(not("something follows its end")),
            _ => {}
        }
        rest = next;
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The frame of a PNG of some size, with so many bytes in it that are no pixels.
    pub(crate) fn framed(width: u32, height: u32, bytes: usize) -> Vec<u8> {
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        let mut chunk = |name: &[u8; 4], data: &[u8]| {
            png.extend((data.len() as u32).to_be_bytes());
            png.extend(name);
            png.extend(data);
            png.extend([0; 4]);
        };
        let [w, h] = [width, height].map(u32::to_be_bytes);
        chunk(b"IHDR", &[&w[..], &h, &[8, 2, 0, 0, 0]].concat());
        chunk(b"IDAT", &vec![7; bytes]);
        chunk(b"IEND", &[]);
        png
    }

    #[test]
    fn only_small_whole_pngs_are_thumbnails() {
        let good = framed(256, 200, 300);
        let thumbnail = Thumbnail::new(good.clone()).unwrap();
        assert_eq!(thumbnail.size(), [256, 200]);
        assert_eq!(Thumbnail::from_text(&thumbnail.text()).unwrap(), thumbnail);
        let header_late = {
            let mut png = good[..8].to_vec();
            png.extend(&good[33..]);
            png
        };
        for (png, why) in [
            (framed(60_000, 60_000, 9), "it says 60000 x 60000 pixels"),
            (framed(1025, 4, 9), "1025 x 4"),
            (framed(0, 4, 9), "0 x 4"),
            (framed(64, 64, 200 << 10), "KiB of text, at most 256"),
            (vec![], "does not begin"),
            (b"GIF89a".to_vec(), "does not begin"),
            (header_late, "no header"),
            (good[..8].to_vec(), "cut off"),
            ([&good[..], b"more"].concat(), "follows its end"),
        ] {
            let told = Thumbnail::new(png).unwrap_err();
            assert!(told.contains(why), "{told}");
        }
        for cut in 0..good.len() {
            assert!(Thumbnail::new(good[..cut].to_vec()).is_err(), "{cut}");
        }
        assert!(Thumbnail::from_text("no base64!").unwrap_err().contains("no base64"));
        let long = "A".repeat(Thumbnail::LONGEST + 4);
        assert!(Thumbnail::from_text(&long).unwrap_err().contains("at most 256"));
    }
}
