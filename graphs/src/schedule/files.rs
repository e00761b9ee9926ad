//! Files that documents name: read once, with the files they refer to in turn.
//!
//! Paths are relative to the document's folder. What enters keys is the bytes; the path is kept for messages
//! only.

use coif_nodes::define::FileData;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Larger files are refused: no head is this large, and reading one would take the machine with it.
const MOST_BYTES: u64 = 2 << 30;

/// Reads the files that documents name.
pub trait Files: Sync {
    /// The file at a path of the document's; the error is one line without the path.
    fn read(&self, path: &str) -> Result<Arc<FileData>, String>;
}

/// Files on the disk, relative to a folder. Remembers what it read until the file changes.
#[derive(Debug, Default)]
pub struct DiskFiles {
    folder: PathBuf,
    read: Mutex<BTreeMap<PathBuf, (SystemTime, u64, Arc<FileData>)>>,
}

impl DiskFiles {
    /// Files relative to `folder`.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), ..Self::default() }
    }
}

impl Files for DiskFiles {
    fn read(&self, path: &str) -> Result<Arc<FileData>, String> {
        let full = self.folder.join(path);
        let about = std::fs::metadata(&full).map_err(|err| said(&err))?;
        if !about.is_file() {
            return Err("is not a file".to_owned());
        }
        let changed = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        let mut known = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((at, len, data)) = known.get(&full)
            && (*at, *len) == (changed, about.len())
            && data.sides.is_empty()
        {
            return Ok(data.clone());
        }
        let bytes = read_whole(&full)?;
        let extension = full.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let mut sides = BTreeMap::new();
        for name in coif_nodes::formats::side_files(&extension, &bytes) {
            // What a file names must lie beside or below it: a groom opens no other files.
            let side = Path::new(&name);
            let plain = side.components().all(|c| matches!(c, std::path::Component::Normal(_)));
            if !plain {
                continue;
            }
            let beside = full.parent().unwrap_or(Path::new("")).join(side);
            if let Ok(bytes) = read_whole(&beside) {
                sides.insert(name, bytes);
            }
        }
        let data = Arc::new(FileData { path: path.to_owned(), extension, bytes, sides });
        known.insert(full, (changed, about.len(), data.clone()));
        Ok(data)
    }
}

fn read_whole(path: &Path) -> Result<Arc<[u8]>, String> {
    let about = std::fs::metadata(path).map_err(|err| said(&err))?;
    if !about.is_file() {
        return Err("is not a file".to_owned());
    }
    if about.len() > MOST_BYTES {
        return Err(format!("is larger than {} GiB", MOST_BYTES >> 30));
    }
    Ok(std::fs::read(path).map_err(|err| said(&err))?.into())
}

/// The system's words without its error number.
fn said(err: &std::io::Error) -> String {
    match err.kind() {
        std::io::ErrorKind::NotFound => "no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "may not be read".to_owned(),
        _ => err.to_string(),
    }
}
