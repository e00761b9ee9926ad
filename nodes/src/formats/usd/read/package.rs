//! Finds the layer to open in a `.usdz`: the first file of an uncompressed zip archive.
//!
//! The names in the archive are looked at, never used: nothing is unpacked anywhere.

use super::super::super::FormatError;

const LOCAL_FILE: &[u8] = b"PK\x03\x04";
const LOCAL_FILE_HEADER: usize = 30;

/// The bytes of the layer: those of the first file when the bytes are a package, else all of them.
pub(super) fn root_layer(bytes: &[u8]) -> Result<&[u8], FormatError> {
    if !bytes.starts_with(LOCAL_FILE) {
        return Ok(bytes);
    }
    let error = |reason: &str| FormatError::at("byte 0, first file of the package", reason);
    let ends_early = || error("the file ends inside it");
    let header = bytes.get(..LOCAL_FILE_HEADER).ok_or_else(ends_early)?;
    let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
    let long = |at: usize| short(at) as usize | (short(at + 2) as usize) << 16;
    let (flags, method) = (short(6), short(8));
    if method != 0 || flags & 1 != 0 {
        return Err(error("it is compressed or encrypted, which USD packages never are"));
    }
    let name_end = LOCAL_FILE_HEADER + short(26) as usize;
    let name = bytes.get(LOCAL_FILE_HEADER..name_end).ok_or_else(ends_early)?;
    let is_layer = [&b".usda"[..], b".usdc", b".usd"].iter().any(|end| name.ends_with(end));
    if !is_layer {
        return Err(error("it is no USD layer"));
    }
    let start = name_end + short(28) as usize;
    let length = long(18);
    start.checked_add(length).and_then(|end| bytes.get(start..end)).ok_or_else(ends_early)
}
