//! Small files of the program's own, one at a time.

use super::Together;
use coif_graphs::schedule::run::CancelToken;
use std::path::Path;

/// Writes a text file in one go; the error is one line without the path.
pub(crate) fn write_text(target: &Path, text: &str) -> Result<(), String> {
    write_with(Together::default(), target, text)
}

/// The same without waiting for the disk: once it is back, the text outlives the process, and not yet the power.
#[cfg(feature = "editor")]
pub(crate) fn write_text_unsynced(target: &Path, text: &str) -> Result<(), String> {
    write_with(Together::unsynced(), target, text)
}

fn write_with(mut files: Together, target: &Path, text: &str) -> Result<(), String> {
    let cancel = CancelToken::default();
    files.write_text(target, text, &cancel)?;
    files.place(&cancel).map_err(|(_, reason)| reason)
}
