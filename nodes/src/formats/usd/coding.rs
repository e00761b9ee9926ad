//! The codings inside crate files, in both directions: value representations, integer deltas, LZ4.
//!
//! **Integers** are stored as differences. The most frequent difference is stated once; each value
//! then takes a two-bit code: that difference again, or one of three widths that follow in order.
//!
//! ```text
//! [common] [4 codes per byte …] [differences that are not common, narrow, middle or wide …]
//! ```
//!
//! **LZ4** blocks follow one byte: 0 for a single block, else the number of blocks, each with its
//! length. Numbers are little-endian, as are the machines this runs on.

use super::super::FormatError;

/// Bit of a value representation: the value is an array.
pub(super) const ARRAY: u64 = 1 << 63;
/// Bit of a value representation: the payload is the value, not its place.
pub(super) const INLINED: u64 = 1 << 62;
/// Bit of a value representation: the array is compressed.
pub(super) const COMPRESSED: u64 = 1 << 61;
/// The bits of a value representation that hold its payload.
pub(super) const PAYLOAD: u64 = (1 << 48) - 1;

/// Arrays shorter than this are never compressed: readers of OpenUSD expect that.
pub(super) const SHORTEST_COMPRESSED: usize = 16;

/// Type numbers of crate files, those that this module reads or writes.
pub(super) mod kind {
    pub(crate) const BOOL: u8 = 1;
    pub(crate) const UCHAR: u8 = 2;
    pub(crate) const INT: u8 = 3;
    pub(crate) const UINT: u8 = 4;
    pub(crate) const INT64: u8 = 5;
    pub(crate) const UINT64: u8 = 6;
    pub(crate) const HALF: u8 = 7;
    pub(crate) const FLOAT: u8 = 8;
    pub(crate) const DOUBLE: u8 = 9;
    pub(crate) const STRING: u8 = 10;
    pub(crate) const TOKEN: u8 = 11;
    pub(crate) const ASSET: u8 = 12;
    pub(crate) const MATRIX4D: u8 = 15;
    pub(crate) const QUATD: u8 = 16;
    pub(crate) const QUATF: u8 = 17;
    pub(crate) const QUATH: u8 = 18;
    pub(crate) const VEC2D: u8 = 19;
    pub(crate) const VEC2F: u8 = 20;
    pub(crate) const VEC2H: u8 = 21;
    pub(crate) const VEC3D: u8 = 23;
    pub(crate) const VEC3F: u8 = 24;
    pub(crate) const VEC3H: u8 = 25;
    pub(crate) const DICTIONARY: u8 = 31;
    pub(crate) const TOKEN_LIST_OP: u8 = 32;
    pub(crate) const PATH_LIST_OP: u8 = 34;
    pub(crate) const REFERENCE_LIST_OP: u8 = 35;
    pub(crate) const TOKEN_VECTOR: u8 = 41;
    pub(crate) const SPECIFIER: u8 = 42;
    pub(crate) const VARIABILITY: u8 = 44;
    pub(crate) const VARIANT_SELECTION_MAP: u8 = 45;
    pub(crate) const TIME_SAMPLES: u8 = 46;
    pub(crate) const ONE_PAYLOAD: u8 = 47;
    pub(crate) const DOUBLE_VECTOR: u8 = 48;
    pub(crate) const STRING_VECTOR: u8 = 50;
    pub(crate) const VALUE_BLOCK: u8 = 51;
    pub(crate) const PAYLOAD_LIST_OP: u8 = 55;
}

/// Spec numbers of crate files.
pub(super) mod spec_kind {
    pub(crate) const ATTRIBUTE: u32 = 1;
    pub(crate) const PRIM: u32 = 6;
    pub(crate) const LAYER: u32 = 7;
    pub(crate) const RELATIONSHIP: u32 = 8;
    pub(crate) const VARIANT: u32 = 10;
}

/// The longest input of one LZ4 block, from the LZ4 format.
const LZ4_MAX_BLOCK: usize = 0x7E00_0000;

/// How wide coded integers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Width {
    /// `int` and `uint`.
    Bits32,
    /// `int64` and `uint64`.
    Bits64,
}

impl Width {
    /// Bytes of a difference by its code; code 0 is the common difference and takes none.
    fn sizes(self) -> [usize; 4] {
        match self {
            Self::Bits32 => [0, 1, 2, 4],
            Self::Bits64 => [0, 2, 4, 8],
        }
    }

    fn bytes(self) -> usize {
        self.sizes()[3]
    }

    /// Cuts a sum or difference to this width, as wrapping arithmetic of that width would.
    fn wrap(self, value: i64) -> i64 {
        match self {
            Self::Bits32 => value as i32 as i64,
            Self::Bits64 => value,
        }
    }

    /// The most bytes that `count` integers can take before LZ4.
    pub(super) fn longest(self, count: u64) -> u64 {
        (self.bytes() as u64)
            .saturating_add(count.div_ceil(4))
            .saturating_add(count.saturating_mul(self.bytes() as u64))
    }
}

/// Sign-extends the low `size` bytes of little-endian `bytes`.
fn sign_extended(bytes: &[u8]) -> i64 {
    let mut wide = [0u8; 8];
    wide[..bytes.len()].copy_from_slice(bytes);
    let unused = 64 - 8 * bytes.len() as u32;
    if unused == 64 { 0 } else { i64::from_le_bytes(wide) << unused >> unused }
}

/// Codes integers as differences, then packs them with LZ4.
pub(super) fn pack_ints(values: impl Iterator<Item = i64>, width: Width) -> Vec<u8> {
    let mut previous = 0;
    let differences: Vec<i64> = values
        .map(|value| {
            let difference = width.wrap(value.wrapping_sub(previous));
            previous = value;
            difference
        })
        .collect();
    lz4_pack(&coded(&differences, width))
}

fn coded(differences: &[i64], width: Width) -> Vec<u8> {
    let common = most_frequent(differences);
    let sizes = width.sizes();
    let mut codes = vec![0u8; differences.len().div_ceil(4)];
    let mut body = Vec::new();
    for (index, &difference) in differences.iter().enumerate() {
        if difference == common {
            continue;
        }
        let bytes = difference.to_le_bytes();
        let fits = |code: &usize| sign_extended(&bytes[..sizes[*code]]) == difference;
        let code = (1..3).find(fits).unwrap_or(3);
        body.extend_from_slice(&bytes[..sizes[code]]);
        codes[index / 4] |= (code as u8) << (2 * (index % 4));
    }
    let mut out = common.to_le_bytes()[..width.bytes()].to_vec();
    out.append(&mut codes);
    out.append(&mut body);
    out
}

/// The most frequent value, the largest of several; 0 for none.
fn most_frequent(values: &[i64]) -> i64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    let runs = sorted.chunk_by(|a, b| a == b);
    runs.max_by_key(|run| run.len()).map_or(0, |run| run[0])
}

/// Undoes the difference coding (after LZ4). `None` when the bytes end too early.
///
/// Takes 8 bytes for each of `count` values: the caller makes sure that is affordable.
pub(super) fn decode_ints(bytes: &[u8], count: usize, width: Width) -> Option<Vec<i64>> {
    let (common, rest) = bytes.split_at_checked(width.bytes())?;
    let common = sign_extended(common);
    let (codes, mut body) = rest.split_at_checked(count.div_ceil(4))?;
    let sizes = width.sizes();
    let mut values = Vec::with_capacity(count);
    let mut value = 0i64;
    for index in 0..count {
        let code = codes[index / 4] >> (2 * (index % 4)) & 3;
        let difference = if code == 0 {
            common
        } else {
            let (head, tail) = body.split_at_checked(sizes[code as usize])?;
            body = tail;
            sign_extended(head)
        };
        value = width.wrap(value.wrapping_add(difference));
        values.push(value);
    }
    Some(values)
}

/// Packs bytes as crate files want them: block count, then blocks.
pub(super) fn lz4_pack(bytes: &[u8]) -> Vec<u8> {
    if bytes.len() <= LZ4_MAX_BLOCK {
        let mut out = vec![0];
        out.append(&mut lz4_flex::block::compress(bytes));
        return out;
    }
    let blocks = bytes.chunks(LZ4_MAX_BLOCK);
    let mut out = vec![blocks.len() as u8];
    for block in blocks {
        let packed = lz4_flex::block::compress(block);
        out.extend_from_slice(&(packed.len() as i32).to_le_bytes());
        out.extend_from_slice(&packed);
    }
    out
}

/// Unpacks into a buffer of the caller's; the number of bytes unpacked.
pub(super) fn lz4_unpack(packed: &[u8], into: &mut [u8]) -> Result<usize, FormatError> {
    let damaged = || FormatError::at("compressed block", "the LZ4 data is damaged");
    let (&blocks, mut rest) = packed.split_first().ok_or_else(damaged)?;
    if blocks == 0 {
        return lz4_flex::block::decompress_into(rest, into).map_err(|_| damaged());
    }
    let mut filled = 0;
    for _ in 0..blocks {
        let (length, tail) = rest.split_first_chunk::<4>().ok_or_else(damaged)?;
        let length = usize::try_from(i32::from_le_bytes(*length)).map_err(|_| damaged())?;
        let (block, tail) = tail.split_at_checked(length).ok_or_else(damaged)?;
        filled +=
            lz4_flex::block::decompress_into(block, &mut into[filled..]).map_err(|_| damaged())?;
        rest = tail;
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(values: &[i64], width: Width) {
        let packed = pack_ints(values.iter().copied(), width);
        let mut buffer = vec![0; width.longest(values.len() as u64) as usize];
        let length = lz4_unpack(&packed, &mut buffer).unwrap();
        assert_eq!(decode_ints(&buffer[..length], values.len(), width).unwrap(), values);
        assert_eq!(decode_ints(&buffer[..length - 1], values.len(), width), None);
    }

    #[test]
    fn integers_of_every_width_come_back() {
        check(&[16, 16, 16, 16, 300, -7, 70_000, i32::MIN as i64, i32::MAX as i64], Width::Bits32);
        check(&[0, 40_000, -3, i64::MAX, i64::MIN, 1 << 40, 5], Width::Bits64);
    }

    #[test]
    fn equal_counts_take_almost_nothing() {
        let packed = pack_ints(std::iter::repeat_n(16, 100_000), Width::Bits32);
        assert!(packed.len() < 200, "{} bytes", packed.len());
    }

    #[test]
    fn the_largest_of_equally_frequent_differences_is_common() {
        assert_eq!(most_frequent(&[3, -1, 3, -1, 7]), 3);
        assert_eq!(most_frequent(&[]), 0);
    }
}
