//! A texture on a head: one channel of a picture, read at each point of the skin through the head's UVs.
//!
//! Guarantees: values are 0 to 1 as stored in the file (a mask is data: no colour space is applied), interpolated
//! bilinearly, with the same bits everywhere. Outside 0 to 1 the picture repeats. Not known here: files, and how they
//! are read.

use super::scalp::{Root, Scalp};
use crate::maths::hash::{Key, KeyBuilder};
use glam::Vec2;
use std::sync::Arc;

/// One channel of a picture, on a head with UVs.
pub struct Texture {
    key: Key,
    scalp: Arc<Scalp>,
    width: usize,
    /// Row by row from the top, 0 to 65535.
    pixels: Vec<u16>,
}

impl Texture {
    /// A picture with rows of this width, from the top; `source` is the hash of everything it comes from. `None` if it
    /// has no pixels.
    pub fn new(source: Key, scalp: Arc<Scalp>, width: usize, pixels: Vec<u16>) -> Option<Self> {
        let key = KeyBuilder::new("texture").key(source).key(scalp.whole()).finish();
        let whole = width > 0 && !pixels.is_empty() && pixels.len().is_multiple_of(width);
        whole.then_some(Self { key, scalp, width, pixels })
    }

    /// Hash of the content.
    pub fn key(&self) -> Key {
        self.key
    }
    /// The head that it lies on.
    pub fn scalp(&self) -> &Arc<Scalp> {
        &self.scalp
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.pixels.len() * 2
    }

    /// The value at a root, 0 to 1.
    pub fn at(&self, root: &Root) -> f32 {
        self.at_uv(root.uv)
    }

    /// The value at a UV, whose v rises from the picture's lower edge, 0 to 1; 0 if the UV is not finite.
    pub fn at_uv(&self, uv: Vec2) -> f32 {
        let height = self.pixels.len() / self.width;
        let place = |x: f32, count: usize| {
            // The centre of the first pixel is half a pixel in.
            let x = (x - x.floor()) * count as f32 - 0.5;
            let low = x.floor();
            let wrap = |k: f32| (k as i64).rem_euclid(count as i64) as usize;
            (wrap(low), wrap(low + 1.0), x - low)
        };
        if !uv.is_finite() {
            return 0.0;
        }
        let (left, right, s) = place(uv.x, self.width);
        let (upper, lower, t) = place(1.0 - uv.y, height);
        let pixel = |x: usize, y: usize| f32::from(self.pixels[y * self.width + x]) / 65535.0;
        let row = |y: usize| pixel(left, y) * (1.0 - s) + pixel(right, y) * s;
        row(upper) * (1.0 - t) + row(lower) * t
    }
}

impl std::fmt::Debug for Texture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Texture({:?})", self.key)
    }
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;

    #[test]
    fn pixels_are_blended_and_the_picture_repeats() {
        let key = KeyBuilder::new("test").finish();
        // Two by two: white at the upper left, a half at the lower right, black else.
        let pixels = vec![65535, 0, 0, 32768];
        let texture = Texture::new(key, shared_ball(), 2, pixels).unwrap();
        let half = 32768.0 / 65535.0;
        for (u, v, wanted) in [
            (0.25, 0.75, 1.0),
            (0.75, 0.25, half),
            (0.75, 0.75, 0.0),
            (0.5, 0.75, 0.5),
            (0.5, 0.5, 0.25 + 0.25 * half),
            (-0.75, 3.75, 1.0),
            // Across the edge, the opposite side follows.
            (0.0, 0.75, 0.5),
            (f32::NAN, 0.0, 0.0),
        ] {
            let found = texture.at_uv(Vec2::new(u, v));
            assert!((found - wanted).abs() < 1e-6, "{u} {v}: {found}, not {wanted}");
        }
        assert!(Texture::new(key, shared_ball(), 2, vec![1, 2, 3]).is_none());
        assert!(Texture::new(key, shared_ball(), 0, vec![]).is_none());
    }
}
