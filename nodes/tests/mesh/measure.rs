//! Reads a mesh under a stopwatch and an allocator that counts.

use coif_nodes::data::mesh::{Mesh, MeshError};
use coif_nodes::formats::mesh_in::{self, limits};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longer than any read may take, on a slow machine and in a build without optimisation of tests.
const LONGEST: Duration = Duration::from_secs(5);

struct Counting;

// Of this thread, since tests run beside each other and readers stay on the thread that calls them.
thread_local! {
    static HELD: Cell<i64> = const { Cell::new(0) };
    static MOST: Cell<i64> = const { Cell::new(0) };
}

fn count(bytes: i64) {
    HELD.with(|held| {
        held.set(held.get() + bytes);
        MOST.with(|most| most.set(most.get().max(held.get())));
    });
}

// Growing in place is not counted as such: the default `realloc` allocates, copies and frees, which
// is the worst that an allocator does.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What a read gave and cost.
pub(crate) struct Measured {
    pub(crate) result: Result<Mesh, MeshError>,
    pub(crate) time: Duration,
    /// Bytes held at the worst moment, without those of the files.
    pub(crate) most_bytes: u64,
    /// Bytes of the file and of those beside it that were asked for.
    pub(crate) file_bytes: u64,
}

/// What a read gave, and the bytes that it held at the worst moment.
pub(crate) fn held<T>(read: impl FnOnce() -> T) -> (T, u64) {
    let before = HELD.get();
    MOST.set(before);
    let given = read();
    (given, (MOST.get() - before) as u64)
}

/// Reads a mesh; fails the test if the reader breaks one of its limits.
#[track_caller]
pub(crate) fn read(name: &str, extension: &str, bytes: &[u8], side: mesh_in::Side) -> Measured {
    let asked = Cell::new(0);
    let counted = |name: &str| {
        let before = HELD.get();
        let bytes = side(name);
        asked.set(asked.get() + bytes.as_ref().map_or(0, |bytes: &Arc<[u8]>| bytes.len()));
        // The caller's memory, not the reader's.
        count(before - HELD.get());
        bytes
    };
    let before = HELD.get();
    MOST.set(before);
    let start = Instant::now();
    let read = || mesh_in::read_mesh(extension, bytes, &counted);
    let result = catch_unwind(std::panic::AssertUnwindSafe(read));
    let time = start.elapsed();
    let most_bytes = (MOST.get() - before) as u64;
    let Ok(result) = result else { panic!("{name}: the reader panicked") };

    let file_bytes = bytes.len() as u64 + asked.get() as u64;
    let allowed = limits::FIXED + limits::PER_BYTE * file_bytes;
    assert!(most_bytes <= allowed, "{name}: held {most_bytes} bytes, where {allowed} are allowed");
    assert!(time < LONGEST, "{name}: took {time:?}");
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
    Measured { result, time, most_bytes, file_bytes }
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
