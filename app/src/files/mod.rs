//! Writing files: all of them or none, and only where a file may be. Everything that the program writes goes through here.
//!
//! A file is written beside its target, synced, and renamed over it; several are written first and renamed together, and when
//! one of these steps fails the old files are back in place ([`together`]). A link is followed and stays, what is no file
//! (a device, a pipe) is written to, and what is read-only is refused ([`target`]). Whatever fails or is interrupted, what was
//! there before is untouched and nothing is left beside it ([`temporary`]).
//!
//! Not guaranteed: a process that is killed outright (SIGKILL, power) between two renames leaves the first; it may leave hidden
//! files that end in `.part`. What was sent down a pipe is not taken back. A file keeps its mode, and its owner where the process
//! may give it away; other names of it (hard links) keep the old content, and lists of rights (ACLs) are not copied.

#[cfg(any(feature = "editor", test))]
mod alone;
mod target;
mod temporary;
#[cfg(all(test, unix))]
mod tests;
mod together;

#[cfg(any(feature = "editor", test))]
pub(crate) use alone::write_text;
#[cfg(feature = "editor")]
pub(crate) use alone::{name_twice, new_lock, set_aside, write_text_unsynced};
#[cfg(feature = "render")]
pub(crate) use coif_graphs::schedule::files::read_at_most;
#[cfg(feature = "editor")]
pub(crate) use temporary::remove_left;
pub(crate) use temporary::{Folders, end};
pub(crate) use together::{Out, Role, Together};

use std::io::{self, Write};
use std::path::Path;

/// What the system says, in the words of somebody who wants a file.
fn said(err: &io::Error) -> String {
    match err.kind() {
        io::ErrorKind::NotFound => "its folder does not exist".to_owned(),
        io::ErrorKind::NotADirectory => "its folder is a file".to_owned(),
        io::ErrorKind::PermissionDenied => "may not be written".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "is on a disk that is read-only".to_owned(),
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::FileTooLarge => {
            "is larger than a file may be here (ulimit -f, or the disk's own limit)".to_owned()
        }
        _ => err.to_string(),
    }
}

/// Text as bytes.
fn put_text(out: &mut Out, text: &str) -> Result<(), String> {
    out.write_all(text.as_bytes()).map_err(|err| err.to_string())
}

/// A lower-case extension without the dot.
pub(crate) fn extension_of(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The largest document that is read: strokes take 30 bytes a sample, so this holds millions.
pub(crate) const MOST_DOCUMENT: u64 = 256 << 20;
