//! Finds files in a `.usdz`, an uncompressed zip archive whose first file is the layer to open.
//!
//! The names in the archive are looked at, never used: nothing is unpacked anywhere.

use super::super::super::FormatError;

const LOCAL_FILE: &[u8] = b"PK\x03\x04";
const LOCAL_FILE_HEADER: usize = 30;

/// Whether these bytes are a package.
pub(super) fn is_package(bytes: &[u8]) -> bool {
    bytes.starts_with(LOCAL_FILE)
}

/// Name and bytes of the layer to open.
pub(super) fn root_layer(bytes: &[u8]) -> Result<(String, &[u8]), FormatError> {
    let error = |reason: &str| FormatError::at("byte 0, first file of the package", reason);
    let Entry { name, content, .. } = entry(bytes, 0).map_err(error)?;
    let is_layer = [&b".usda"[..], b".usdc", b".usd"].iter().any(|end| name.ends_with(end));
    if !is_layer {
        return Err(error("it is no USD layer"));
    }
    Ok((String::from_utf8_lossy(name).into_owned(), content))
}

/// The bytes of the file of this name; the inner error says why there are none.
pub(super) fn find<'a>(bytes: &'a [u8], wanted: &str) -> Result<&'a [u8], String> {
    let mut at = 0;
    while bytes.get(at..).is_some_and(is_package) {
        // Each is at least as long as its header, so this ends.
        let Entry { name, content, end } = entry(bytes, at)?;
        if name == wanted.as_bytes() {
            return Ok(content);
        }
        at = end;
    }
    Err("there is no such file in the package".to_owned())
}

struct Entry<'a> {
    name: &'a [u8],
    content: &'a [u8],
    end: usize,
}

/// The file whose header is at a place.
fn entry(bytes: &[u8], at: usize) -> Result<Entry<'_>, &'static str> {
    let ends_early = "the file ends inside it";
    let bytes_from = bytes.get(at..).unwrap_or_default();
    let header = bytes_from.get(..LOCAL_FILE_HEADER).ok_or(ends_early)?;
    let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
    let long = |at: usize| short(at) as usize | (short(at + 2) as usize) << 16;
    let (flags, method) = (short(6), short(8));
    if method != 0 || flags & 1 != 0 {
        return Err("it is compressed or encrypted, which USD packages never are");
    }
    let name_end = LOCAL_FILE_HEADER + short(26) as usize;
    let name = bytes_from.get(LOCAL_FILE_HEADER..name_end).ok_or(ends_early)?;
    let start = name_end + short(28) as usize;
    let end = start.checked_add(long(18)).ok_or(ends_early)?;
    let content = bytes_from.get(start..end).ok_or(ends_early)?;
    Ok(Entry { name, content, end: at + end })
}
