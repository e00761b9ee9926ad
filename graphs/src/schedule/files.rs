//! Files that documents name: read once, with the files they refer to in turn.
//!
//! Paths are relative to the document's folder. What enters keys is the bytes; the path is kept for messages
//! only.

use crate::document::{Document, NodeId, Setting};
use coif_nodes::define::{FileData, Type, Value};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Larger files are refused: no head is this large, and reading one would take the machine with it.
const MOST_BYTES: u64 = 2 << 30;

/// Reads the files that documents name.
pub trait Files: Sync {
    /// The file at a path of the document's; the error is one line without the path.
    fn read(&self, path: &str) -> Result<Arc<FileData>, String>;
}

/// Every file that a document names: node, input, path as it is written.
pub fn named(document: &Document) -> Vec<(&NodeId, &str, Arc<str>)> {
    let mut all = vec![];
    for (id, node) in &document.nodes {
        for (input, setting) in &node.inputs {
            if let Some(path) = path_of(input, setting) {
                all.push((id, input.as_str(), path));
            }
        }
    }
    all
}

/// The path that an input is set to, where it is a file's.
pub fn path_of(input: &str, setting: &Setting) -> Option<Arc<str>> {
    let is_file =
        coif_nodes::all().any(|def| def.input(input).is_some_and(|(_, i)| i.ty == Type::File));
    match setting {
        Setting::Known(Value::Text(path)) if is_file && !path.is_empty() => Some(path.clone()),
        _ => None,
    }
}

/// Every file that evaluating a document may read, and the node that names it: those that it names, and those that these name.
pub fn read_by(document: &Document, folder: &Path) -> Vec<(NodeId, PathBuf)> {
    let mut all = vec![];
    for (node, _, path) in named(document) {
        let full = folder.join(&*path);
        // What is refused later has no files beside it.
        let bytes = read_whole(&full).unwrap_or_default();
        all.extend(sides_of(&full, &bytes).map(|(_, side)| (node.clone(), side)));
        all.push((node.clone(), full));
    }
    all
}

/// The files that a file names: names and where they lie, beside or below it, for a groom opens no others.
fn sides_of(full: &Path, bytes: &[u8]) -> impl Iterator<Item = (String, PathBuf)> {
    let folder = full.parent().unwrap_or(Path::new("")).to_owned();
    let names = coif_nodes::formats::side_files(&extension_of(full), bytes).into_iter();
    let plain =
        |name: &String| Path::new(name).components().all(|c| matches!(c, Component::Normal(_)));
    names.filter(plain).map(move |name| {
        let side = folder.join(&name);
        (name, side)
    })
}

fn extension_of(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
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
        let extension = extension_of(&full);
        let sides = sides_of(&full, &bytes)
            .filter_map(|(name, side)| Some((name, read_whole(&side).ok()?)))
            .collect();
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
