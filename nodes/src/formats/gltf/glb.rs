//! The container of a `.glb`: a header of 12 bytes, a JSON chunk and often a chunk of numbers.
//!
//! Source: glTF 2.0 specification, section 4.4.

use crate::data::mesh::MeshError;

/// JSON text and, in a `.glb`, the chunk of numbers.
#[derive(Debug, PartialEq)]
pub(super) struct GlbChunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) bin: Option<&'a [u8]>,
}

/// Takes a `.glb` apart; anything that does not begin as one is JSON.
///
/// Bytes after the stated length are left alone, as are chunks of other kinds.
pub(super) fn split(bytes: &[u8]) -> Result<GlbChunks<'_>, MeshError> {
    if !bytes.starts_with(b"glTF") {
        return Ok(GlbChunks { json: bytes, bin: None });
    }
    let (Some(version), Some(length)) = (u32_at(bytes, 4), u32_at(bytes, 8)) else {
        return Err(cut_off(bytes, 12));
    };
    if version != 2 {
        let reason = format!("glTF binary version {version}, where only 2 is read");
        return Err(MeshError::at("byte 4", reason));
    }
    let Some(whole) = bytes.get(..length as usize) else {
        return Err(cut_off(bytes, length as usize));
    };
    let mut parts = GlbChunks { json: &[], bin: None };
    let mut at = 12;
    let mut n = 0;
    while at < whole.len() {
        let (Some(size), Some(kind)) = (u32_at(whole, at), whole.get(at + 4..at + 8)) else {
            return Err(MeshError::at(format!("byte {at}"), "a chunk without its 8 byte header"));
        };
        let Some(chunk) = whole[at + 8..].get(..size as usize) else {
            let left = whole.len() - at - 8;
            let reason = format!("a chunk of {size} bytes, where {left} are left");
            return Err(MeshError::at(format!("byte {at}"), reason));
        };
        match (n, kind) {
            (0, b"JSON") => parts.json = chunk,
            (0, _) => return Err(MeshError::at("byte 16", "the first chunk is not JSON")),
            (1, b"BIN\0") => parts.bin = Some(chunk),
            _ => {}
        }
        n += 1;
        // Chunks should be multiples of 4 long; the next begins where this one ends either way.
        at += 8 + size as usize;
    }
    if n == 0 {
        return Err(MeshError::at("byte 12", "a binary glTF without its JSON chunk"));
    }
    Ok(parts)
}

fn cut_off(bytes: &[u8], length: usize) -> MeshError {
    let n = bytes.len();
    MeshError::at(
        format!("byte {n}"),
        format!("the file is cut off: it should have {length} bytes"),
    )
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(length: u32, chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes()].concat();
        for (kind, chunk) in chunks {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend_from_slice(*kind);
            bytes.extend_from_slice(chunk);
        }
        bytes
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_passed_over() {
        let bytes = glb(46, &[(b"JSON", b"{}  "), (b"BIN\0", b"12"), (b"more", b"....")]);
        assert_eq!(split(&bytes).unwrap().bin, Some(b"12".as_slice()));
        let mut longer = glb(24, &[(b"JSON", b"{}  ")]);
        longer.extend(b"glTF");
        assert_eq!(split(&longer), Ok(GlbChunks { json: b"{}  ", bin: None }));
        assert_eq!(split(b"{}"), Ok(GlbChunks { json: b"{}", bin: None }));
    }

    #[test]
    fn a_broken_container_is_refused_with_its_place() {
        let whole = glb(24, &[(b"JSON", b"{}  ")]);
        for (bytes, says) in [
            (b"glTF".to_vec(), "byte 4: the file is cut off: it should have 12 bytes"),
            (whole[..23].to_vec(), "byte 23: the file is cut off: it should have 24 bytes"),
            (glb(12, &[]), "byte 12: a binary glTF without its JSON chunk"),
            (glb(16, &[(b"JSON", b"")]), "byte 12: a chunk without its 8 byte header"),
            (glb(21, &[(b"JSON", b"{}")]), "byte 12: a chunk of 2 bytes, where 1 are left"),
            (glb(22, &[(b"BIN\0", b"{}")]), "byte 16: the first chunk is not JSON"),
        ] {
            assert_eq!(split(&bytes).unwrap_err().to_string(), says);
        }
        let mut version = whole;
        version[4] = 99;
        let says = "byte 4: glTF binary version 99, where only 2 is read";
        assert_eq!(split(&version).unwrap_err().to_string(), says);
    }
}
