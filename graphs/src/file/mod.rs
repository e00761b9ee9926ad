//! Documents as text: RON made for people and for git.
//!
//! One fact a line, with the shortest numbers that read back the same, in an order in which what two
//! people change and add merges (`text/order.rs`): each node stands with its place, its values and its wires.
//! What this version does not know of nodes and values is kept
//! byte for byte; what it does not know of the document itself is refused, with line and column.
//! `read(write(d)) == d`, and `write(read(f))` is a fixed point.
//!
//! The structs of files are their own ([`read`]), converted by hand, so that a document can change
//! its shape without changing its files. Nothing here opens a file except [`save`].

use crate::document::Document;
use std::fmt;
use std::io::{self, Write as _};
use std::path::Path;

mod meaning;
#[cfg(test)]
pub(crate) mod merges;
mod ports;
mod read;
mod scan;
#[cfg(test)]
mod tests;
mod upgrade;
mod write;

pub use meaning::document_hash;
pub use ports::{TYPES as PORT_TYPES, UNITS as PORT_UNITS};

/// The format that this version writes. It goes up when an older version would misread a file.
pub const FORMAT: u32 = 3;

/// The oldest format that is read.
const OLDEST: u32 = 1;

/// How a comment begins that says what a merge could not decide. Whoever decided it removes the comment.
pub const CONFLICT: &str = "// conflict:";

/// A file that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// What it says.
    pub document: Document,
    /// What this version does not know or cannot use; it is kept unless the message says otherwise.
    pub warnings: Vec<FileError>,
    /// What a merge could not decide and nobody has since: comments that begin with [`CONFLICT`]. Each message says what to do.
    pub conflicts: Vec<FileError>,
    /// Comments that stand where they cannot be kept: saving drops them. Each message is the
    /// comment.
    pub dropped_comments: Vec<FileError>,
}

/// A message about a place in a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{line}:{column}: {message}")]
pub struct FileError {
    /// From 1.
    pub line: usize,
    /// In characters, from 1.
    pub column: usize,
    /// What is wrong, on one line.
    pub message: String,
}

impl FileError {
    /// The message with the file's name before it, as compilers write it: `file.ron:12:5: message`.
    pub fn of_file(&self, name: impl fmt::Display) -> String {
        format!("{name}:{self}")
    }
}

/// Reads a document.
pub fn read(text: &str) -> Result<Loaded, FileError> {
    read::read(text)
}

/// Reads a document from bytes, which may not even be text.
pub fn read_bytes(bytes: &[u8]) -> Result<Loaded, FileError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => read(text),
        Err(err) => {
            let before = std::str::from_utf8(&bytes[..err.valid_up_to()]).unwrap_or_default();
            let message = "not a groom: this is no UTF-8 text".to_owned();
            Err(scan::error_at(before, before.len(), message))
        }
    }
}

/// Writes a document.
pub fn write(document: &Document) -> String {
    write::write(document)
}

/// Writes nodes and their wires, as they are copied.
pub(crate) fn write_part(part: &Document) -> String {
    write::write_part(part)
}

/// Reads what [`write_part`] wrote, or a whole groom.
pub(crate) fn read_part(text: &str) -> Result<Loaded, FileError> {
    read::read_part(text)
}

/// The format of copied nodes, which goes up with that of files.
const PART: u32 = FORMAT;

/// Saves a document so that a crash leaves the old file or the new one: written beside it, synced,
/// renamed.
pub fn save(document: &Document, path: &Path) -> io::Result<()> {
    let mut name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    let beside = path.with_file_name(name);
    let written = io::Result::and_then(std::fs::File::create(&beside), |mut file| {
        file.write_all(write(document).as_bytes())?;
        file.sync_all()?;
        std::fs::rename(&beside, path)
    });
    if written.is_err() {
        // The first error is the one to tell.
        let _ = std::fs::remove_file(&beside);
    }
    written
}
