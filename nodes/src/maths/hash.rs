//! Keys of results, and randomness that is a pure function of ids.
//!
//! Two different things share this file because both turn bits into bits: [`Key`] says whether two
//! results are the same (128 bits, XXH3), [`Dice`] draws numbers (64 bits, the finaliser of
//! SplitMix64, Steele, Lea and Flood 2014). Neither leaves the process: files carry content hashes
//! by BLAKE3 (`graphs/src/schedule/result.rs`).

use glam::Vec3;

/// A 128-bit hash of exactly what made something.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key(pub u128);

/// Collects the parts of a [`Key`]: each part is led by its type and length, so that no two lists of
/// parts run together.
pub struct KeyBuilder(xxhash_rust::xxh3::Xxh3);

impl KeyBuilder {
    /// Starts a key of the named kind.
    pub fn new(kind: &str) -> Self {
        Self(xxhash_rust::xxh3::Xxh3::new()).text(kind)
    }
    fn part(mut self, tag: u8, bytes: &[u8]) -> Self {
        let mut head = [tag; 9];
        head[1..].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.update(&head);
        self.0.update(bytes);
        self
    }
    /// Adds a text.
    pub fn text(self, text: &str) -> Self {
        self.part(b't', text.as_bytes())
    }
    /// Adds a column of plain values.
    pub fn column<T: bytemuck::NoUninit>(self, column: &[T]) -> Self {
        self.part(b'c', bytemuck::cast_slice(column))
    }
    /// Adds a whole number.
    pub fn int(self, number: u64) -> Self {
        self.part(b'i', &number.to_le_bytes())
    }
    /// Adds a number; -0.0 counts as 0.0, every NaN as one.
    pub fn float(self, number: f32) -> Self {
        self.part(b'f', &canonical(number).to_bits().to_le_bytes())
    }
    /// Adds a vector.
    pub fn vec3(self, v: Vec3) -> Self {
        self.float(v.x).float(v.y).float(v.z)
    }
    /// Adds another key.
    pub fn key(self, key: Key) -> Self {
        self.part(b'k', &key.0.to_le_bytes())
    }
    /// The key of all parts so far.
    pub fn finish(self) -> Key {
        Key(self.0.digest128())
    }
}

/// One bit pattern for each value: -0.0 becomes 0.0 and every NaN the same NaN.
#[inline]
pub fn canonical(number: f32) -> f32 {
    if number.is_nan() { f32::NAN } else { number + 0.0 }
}

/// Mixes 64 bits so that each depends on all (SplitMix64's finaliser).
#[inline]
pub const fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

#[inline]
const fn join(a: u64, b: u64) -> u64 {
    mix(a.wrapping_mul(GOLDEN).wrapping_add(b).wrapping_add(GOLDEN))
}

/// FNV-1a of a purpose's name, so that purposes are words in the source and constants in the program.
const fn word(text: &str) -> u64 {
    let bytes = text.as_bytes();
    let (mut hash, mut i) = (0xCBF2_9CE4_8422_2325u64, 0);
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x100_0000_01B3);
        i += 1;
    }
    hash
}

/// The id of the `index`-th curve that a maker with the seed tag `tag` makes from `parent`.
/// Never 0, which stands for "no curve".
pub const fn curve_id(parent: u64, tag: u64, index: u64) -> u64 {
    let id = join(join(parent, tag), index);
    if id == 0 { 1 } else { id }
}

/// Draws numbers for one purpose: the same (seed, tag, purpose, curve id, index) gives the same number
/// on every machine, whatever else is drawn, and in whatever order.
#[derive(Clone, Copy, Debug)]
pub struct Dice(u64);

impl Dice {
    /// Dice of a node: the document's seed, the node's own seed tag, and what is drawn.
    pub const fn new(seed: u64, tag: u64, purpose: &str) -> Self {
        Self(join(join(seed, tag), word(purpose)))
    }
    /// 64 random bits.
    #[inline]
    pub const fn bits(self, id: u64, index: u64) -> u64 {
        join(join(self.0, id), index)
    }
    /// Uniform in [0, 1).
    #[inline]
    pub fn unit(self, id: u64, index: u64) -> f32 {
        (self.bits(id, index) >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
    }
    /// Uniform in [-1, 1).
    #[inline]
    pub fn signed(self, id: u64, index: u64) -> f32 {
        self.unit(id, index) * 2.0 - 1.0
    }
    /// Uniform in [lo, hi).
    #[inline]
    pub fn range(self, id: u64, index: u64, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit(id, index)
    }
    /// Uniform in 0..n; 0 when `n` is 0.
    #[inline]
    pub fn below(self, id: u64, index: u64, n: u32) -> u32 {
        (((self.bits(id, index) >> 32) * u64::from(n)) >> 32) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_key_do_not_run_together() {
        let key = |parts: &[&str]| {
            parts.iter().fold(KeyBuilder::new("t"), |key, part| key.text(part)).finish()
        };
        assert_ne!(key(&["ab", "c"]), key(&["a", "bc"]));
        assert_ne!(key(&["ab"]), key(&["ab", ""]));
        assert_eq!(
            KeyBuilder::new("t").float(-0.0).finish(),
            KeyBuilder::new("t").float(0.0).finish()
        );
    }

    #[test]
    fn numbers_are_uniform_and_purposes_do_not_correlate() {
        let (a, b) = (Dice::new(1, 2, "length"), Dice::new(1, 2, "colour"));
        let n = 100_000;
        let mean = |f: &dyn Fn(u64) -> f64| (0..n).map(f).sum::<f64>() / n as f64;
        let (ma, mb) = (mean(&|i| a.unit(i, 0).into()), mean(&|i| b.unit(i, 0).into()));
        assert!((ma - 0.5).abs() < 0.005 && (mb - 0.5).abs() < 0.005, "{ma} {mb}");
        let joint = mean(&|i| f64::from(a.unit(i, 0) - 0.5) * f64::from(b.unit(i, 0) - 0.5));
        assert!(joint.abs() < 0.002, "{joint}");
        let counts = (0..n).fold([0u32; 7], |mut c, i| {
            c[a.below(9, i, 7) as usize] += 1;
            c
        });
        assert!(counts.iter().all(|c| (13_500..15_100).contains(c)), "{counts:?}");
    }

    #[test]
    fn a_draw_never_changes() {
        // Grooms in the field depend on this very number.
        assert_eq!(Dice::new(0, 0, "root").bits(1, 2), 15_845_115_417_434_478_657);
        assert_eq!(curve_id(0, 0, 0), 9_669_442_505_924_063_346);
    }
}
