//! Small files of the program's own, one at a time.

use super::Together;
use coif_graphs::schedule::run::CancelToken;
use std::path::Path;
#[cfg(feature = "editor")]
use std::path::PathBuf;
#[cfg(feature = "editor")]
use std::{fs, io};

/// Writes a text file in one go; the error is one line without the path.
pub(crate) fn write_text(target: &Path, text: &str) -> Result<(), String> {
    write_with(Together::default(), target, text)
}

/// The same without waiting for the disk: once it is back, the text outlives the process, and not yet the power.
#[cfg(feature = "editor")]
pub(crate) fn write_text_unsynced(target: &Path, text: &str) -> Result<(), String> {
    write_with(Together::unsynced(), target, text)
}

/// Gives a damaged file another name beside it, so that what takes its place does not end it; gives that name.
#[cfg(feature = "editor")]
pub(crate) fn set_aside(path: &Path) -> io::Result<PathBuf> {
    let mut aside = path.as_os_str().to_owned();
    aside.push(".bad");
    fs::rename(path, &aside)?;
    Ok(aside.into())
}

/// Gives what a file holds another name too, instead of what had that: it stays there when the file is replaced. File systems that know
/// no second names have none then.
#[cfg(feature = "editor")]
pub(crate) fn name_twice(path: &Path, other: &Path) {
    let _ = fs::remove_file(other);
    let _ = fs::hard_link(path, other);
}

/// Makes a file that is there to be locked, where none is.
#[cfg(feature = "editor")]
pub(crate) fn new_lock(path: &Path) -> io::Result<fs::File> {
    fs::File::create_new(path)
}

fn write_with(mut files: Together, target: &Path, text: &str) -> Result<(), String> {
    let cancel = CancelToken::default();
    files.write_text(target, text, &cancel)?;
    files.place(&cancel).map_err(|(_, reason)| reason)
}
