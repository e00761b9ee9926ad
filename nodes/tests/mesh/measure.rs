//! Reads a mesh and counts its work.

use crate::waiting::ends;
use crate::work::{Work, count, uncounted};
use coif_nodes::data::mesh::{Mesh, MeshError};
use coif_nodes::formats::mesh_in::{self, limits};
use std::cell::Cell;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Times that memory may be asked for, beside twice for each byte of the file.
const ASKED: u64 = 100;

/// What a read gave and cost.
pub(crate) struct Measured {
    pub(crate) result: Result<Mesh, MeshError>,
    /// Of the reader, without the files.
    pub(crate) work: Work,
    /// Bytes of the file and of those beside it that were asked for.
    pub(crate) file_bytes: u64,
}

/// Reads a mesh; fails the test if the reader breaks one of its limits.
#[track_caller]
pub(crate) fn read(name: &str, extension: &str, bytes: &[u8], side: mesh_in::Side) -> Measured {
    let asked = Cell::new(0);
    let counted = |name: &str| {
        // The caller's memory, not the reader's.
        let bytes = uncounted(|| side(name));
        asked.set(asked.get() + bytes.as_ref().map_or(0, |bytes: &Arc<[u8]>| bytes.len()));
        bytes
    };
    let read = || mesh_in::read_mesh(extension, bytes, &counted);
    let read = std::panic::AssertUnwindSafe(read);
    let (result, work) = ends(name, || count(|| catch_unwind(read)));
    let Ok(result) = result else { panic!("{name}: the reader panicked") };

    let file_bytes = bytes.len() as u64 + asked.get() as u64;
    let allowed = limits::FIXED + limits::PER_BYTE * file_bytes;
    assert!(work.held <= allowed, "{name}: held {} bytes, where {allowed} are allowed", work.held);
    assert!(work.asked <= ASKED + 2 * file_bytes, "{name}: {work:?} for {file_bytes} bytes");
    match &result {
        Ok(mesh) => {
            mesh.check().unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(!mesh.triangles.is_empty(), "{name}: no triangles");
        }
        Err(e) => {
            let text = e.to_string();
            assert!(!text.contains('\n') && text.chars().count() < 300, "{name}: {text:?}");
        }
    }
    Measured { result, work, file_bytes }
}

/// Reads a mesh file and those beside it.
#[track_caller]
pub(crate) fn read_file(path: &Path) -> Measured {
    let bytes = std::fs::read(path).unwrap();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let folder = path.parent().unwrap();
    let side = |name: &str| std::fs::read(folder.join(name)).ok().map(Arc::from);
    read(&path.display().to_string(), &extension, &bytes, &side)
}

/// A folder of `../shared/data`, or nothing after telling that a test is skipped.
pub(crate) fn shared(test: &str, folder: &str) -> Option<PathBuf> {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared")).join("data");
    let folder = data.join(folder);
    if !folder.is_dir() {
        println!("skipped: {test} needs ../shared");
        return None;
    }
    Some(folder)
}

/// The files below a folder that end in one of some extensions, in order.
pub(crate) fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
