//! Writing files so that nobody ever sees half of one: to a temporary beside the target, synced, renamed.
//!
//! Several files are renamed only when all are complete. Whatever fails or is interrupted, what was there before is untouched
//! and no temporary is left.

use coif_graphs::schedule::run::CancelToken;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Files that are complete but not yet in place.
#[derive(Default)]
pub(crate) struct Pending {
    files: Vec<(PathBuf, PathBuf)>,
}

/// A file while it is written. Fails at the next write when somebody asks to stop.
pub(crate) struct Stoppable<W> {
    inner: W,
    cancel: CancelToken,
}

impl<W: Write> Write for Stoppable<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.cancel.is_cancelled() {
            return Err(io::Error::other("interrupted"));
        }
        self.inner.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Seek> Seek for Stoppable<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

impl Pending {
    /// Writes a complete file beside `target`.
    pub(crate) fn write(
        &mut self,
        target: &Path,
        cancel: &CancelToken,
        write: impl FnOnce(&mut BufWriter<Stoppable<File>>) -> Result<(), String>,
    ) -> Result<(), String> {
        let name = target.file_name().ok_or("is no file name")?.to_string_lossy().into_owned();
        if target.is_dir() {
            return Err("is a folder".to_owned());
        }
        let temporary = target.with_file_name(format!(".{name}.{}.part", std::process::id()));
        let file = File::create(&temporary).map_err(|err| match err.kind() {
            io::ErrorKind::NotFound => "its folder does not exist".to_owned(),
            _ => err.to_string(),
        })?;
        self.files.push((temporary, target.to_owned()));
        let stoppable = Stoppable { inner: file, cancel: cancel.clone() };
        let mut out = BufWriter::with_capacity(1 << 20, stoppable);
        write(&mut out)?;
        let whole = out.into_inner().map_err(|err| err.to_string())?;
        whole.inner.sync_all().map_err(|err| err.to_string())
    }

    /// Puts all files in place.
    pub(crate) fn place(mut self) -> Result<(), (PathBuf, String)> {
        for (temporary, target) in std::mem::take(&mut self.files) {
            if let Err(err) = std::fs::rename(&temporary, &target) {
                let _ = std::fs::remove_file(&temporary);
                return Err((target, err.to_string()));
            }
        }
        Ok(())
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        for (temporary, _) in &self.files {
            let _ = std::fs::remove_file(temporary);
        }
    }
}

/// A file of at most so many bytes; the error is one line without the path.
#[cfg(feature = "render")]
pub(crate) fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    let said = |err: io::Error| match err.kind() {
        io::ErrorKind::NotFound => "no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "may not be read".to_owned(),
        _ => err.to_string(),
    };
    let about = std::fs::metadata(path).map_err(said)?;
    if !about.is_file() {
        return Err("is not a file".to_owned());
    }
    if about.len() > most {
        return Err(format!("is larger than {} MiB", most >> 20));
    }
    std::fs::read(path).map_err(said)
}

/// Writes a small text file in one go.
pub(crate) fn write_text(target: &Path, text: &str) -> Result<(), String> {
    let mut pending = Pending::default();
    pending.write(target, &CancelToken::default(), |out| {
        out.write_all(text.as_bytes()).map_err(|err| err.to_string())
    })?;
    pending.place().map_err(|(_, err)| err)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_what_was_there_and_nothing_else() {
        let folder = std::env::temp_dir().join(format!("coif-files-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let target = folder.join("a.txt");
        write_text(&target, "before").unwrap();
        let cancel = CancelToken::default();
        let mut pending = Pending::default();
        pending
            .write(&target, &cancel, |out| out.write_all(b"after").map_err(|e| e.to_string()))
            .unwrap();
        cancel.cancel();
        let failed = pending.write(&folder.join("b.txt"), &cancel, |out| {
            out.write_all(&[0; 3 << 20]).map_err(|e| e.to_string())
        });
        assert_eq!(failed, Err("interrupted".to_owned()));
        drop(pending);
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "before");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
