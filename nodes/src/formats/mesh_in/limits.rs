//! How much memory a mesh file may cost: [`FIXED`] bytes and [`PER_BYTE`] for each of its own.
//!
//! A small file can name a huge mesh (instances, accessors of zeros, polygons of one digit a
//! corner), so readers reckon what they are about to allocate, ask a budget and then reserve
//! exactly that: nothing grows by doubling, which would cost three times as much for a moment.

use crate::data::mesh::MeshError;

/// Bytes that any file may cost, however small: room for 1.4 million triangles.
pub const FIXED: u64 = 64 << 20;

/// Bytes allowed for each byte of the file and of the files beside it. A triangle with uvs, a
/// material and a part is 44 bytes and its shortest honest line, `f 1 2 3`, is 8.
pub const PER_BYTE: u64 = 20;

/// The memory a reader may still allocate.
#[derive(Debug)]
pub(crate) struct Budget {
    allowed: u64,
    used: u64,
}

impl Budget {
    /// For a file of so many bytes.
    pub(crate) fn new(file_bytes: usize) -> Self {
        Self { allowed: FIXED.saturating_add(PER_BYTE.saturating_mul(file_bytes as u64)), used: 0 }
    }

    /// Another file was opened, which allows for itself.
    pub(crate) fn add_file(&mut self, file_bytes: usize) {
        let more = PER_BYTE.saturating_mul(file_bytes as u64);
        self.allowed = self.allowed.saturating_add(more);
    }

    /// Takes `bytes`, for good: what a reader frees before it ends it does not give back.
    pub(crate) fn take(&mut self, place: &str, bytes: u64) -> Result<(), MeshError> {
        self.used = self.used.saturating_add(bytes);
        if self.used > self.allowed {
            let (used, allowed) = (self.used >> 20, self.allowed >> 20);
            let reason = format!(
                "reading this takes {used} MiB of memory, where a file of this size may take {allowed}"
            );
            return Err(MeshError::at(place, reason));
        }
        Ok(())
    }
}

/// The start of some bytes of a file, fit for a message: one line, at most 40 characters.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)]);
    let printable = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut short: String = text.chars().take(LONGEST).map(printable).collect();
    if text.chars().count() > LONGEST {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_counts_every_file_and_refuses_the_byte_too_many() {
        let mut budget = Budget::new(1);
        budget.add_file(2);
        budget.take("file", FIXED + 3 * PER_BYTE).unwrap();
        let e = budget.take("file", 1).unwrap_err();
        let says =
            "file: reading this takes 64 MiB of memory, where a file of this size may take 64";
        assert_eq!(e.to_string(), says);
        assert!(budget.take("file", u64::MAX).is_err());
    }

    #[test]
    fn an_excerpt_is_one_short_line() {
        assert_eq!(excerpt(b"a\nb\x07\xff"), "a\u{fffd}b\u{fffd}\u{fffd}");
        assert_eq!(excerpt(&[b'x'; 900]).chars().count(), 41);
    }
}
