//! Small pictures of templates as textures: few are decoded in a frame, and few are kept.

use crate::core::templates::Listed;
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Pictures that are decoded in one frame.
pub(crate) const PER_FRAME: usize = 2;
/// Pictures that are kept, of at most 256 KiB each.
pub(crate) const MOST: usize = 128;
/// Pixels of a side that are shown.
const SIDE: usize = 256;

struct Kept {
    of: Arc<Listed>,
    /// None where its pixels cannot be decoded.
    texture: Option<TextureHandle>,
    seen: u64,
}

/// Textures of what is in sight.
#[derive(Default)]
pub(crate) struct Pictures {
    kept: BTreeMap<String, Kept>,
    /// Decoded in this frame, and since the beginning.
    pub(crate) decoded: usize,
    pub(crate) total: usize,
    frame: u64,
}

/// What there is to show.
pub(crate) enum Thumbnail<'a> {
    /// It.
    Here(&'a TextureHandle),
    /// It comes in a later frame.
    Later,
    /// It has none.
    None,
    /// It cannot be decoded.
    Damaged,
}

impl Pictures {
    /// A frame begins. What was not in sight for longest goes, where there is too much.
    pub(crate) fn begin(&mut self, frame: u64) {
        (self.frame, self.decoded) = (frame, 0);
        if self.kept.len() > MOST {
            let mut seen: Vec<u64> = self.kept.values().map(|kept| kept.seen).collect();
            seen.sort_unstable();
            let oldest = seen[self.kept.len() - MOST];
            self.kept.retain(|_, kept| kept.seen >= oldest);
        }
    }

    /// The picture of a template, known under a key.
    pub(crate) fn of(&mut self, key: &str, listed: &Arc<Listed>, ctx: &Context) -> Thumbnail<'_> {
        let Some(thumbnail) = &listed.thumbnail else { return Thumbnail::None };
        let is_known = self.kept.get(key).is_some_and(|kept| Arc::ptr_eq(&kept.of, listed));
        if !is_known {
            if self.decoded == PER_FRAME {
                ctx.request_repaint();
                return Thumbnail::Later;
            }
            self.decoded += 1;
            self.total += 1;
            let texture = decoded(thumbnail.png()).map(|image| {
                ctx.load_texture(format!("template {key}"), image, TextureOptions::LINEAR)
            });
            let of = listed.clone();
            self.kept.insert(key.to_owned(), Kept { of, texture, seen: self.frame });
        }
        let Some(kept) = self.kept.get_mut(key) else { return Thumbnail::None };
        kept.seen = self.frame;
        kept.texture.as_ref().map_or(Thumbnail::Damaged, Thumbnail::Here)
    }

    /// How many are kept.
    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.kept.len()
    }
}

/// The pixels of a PNG whose header was read: every so manieth where they are more than are shown.
fn decoded(png: &[u8]) -> Option<ColorImage> {
    let icon = eframe::icon_data::from_png_bytes(png).ok()?;
    let [width, height] = [icon.width as usize, icon.height as usize];
    let step = width.max(height).div_ceil(SIDE).max(1);
    let [columns, rows] = [width / step, height / step].map(|n| n.max(1));
    let pixels =
        (0..rows).flat_map(|y| (0..columns).map(move |x| (y * step * width + x * step) * 4));
    let rgba: Vec<u8> =
        pixels.filter_map(|at| icon.rgba.get(at..at + 4)).flatten().copied().collect();
    (rgba.len() == columns * rows * 4)
        .then(|| ColorImage::from_rgba_unmultiplied([columns, rows], &rgba))
}
