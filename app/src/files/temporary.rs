//! Files that are there for a moment, beside the one that they are about to become or used to be.
//!
//! Each has a name of its own, that nobody else has and nobody guesses: it is made anew, never opened where something stands.
//! Dropped, it is gone; and [`end`] removes all of them from any thread, for a process that is asked to end. Folders that are made
//! for files to come go with them where none came.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// All that are there now.
static ALL: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// All folders that were made for files to come, those within others after them.
static FOLDERS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Held while several files are renamed as one step.
static STEP: Mutex<()> = Mutex::new(());

/// Bytes of the target's name that are part of a temporary's: enough to know it by, and short enough for every disk.
const MOST_OF_NAME: usize = 64;
/// Names that are tried.
const TRIES: usize = 100;

/// A file that is removed when this is dropped.
#[derive(Debug)]
pub(super) struct Temporary(PathBuf);

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps [`end`] from coming between the renames of one step.
pub(super) fn step() -> MutexGuard<'static, ()> {
    locked(&STEP)
}

/// Removes every temporary and ends the process. No step is left half done.
pub(crate) fn end(code: i32) -> ! {
    // Never let go of: what other threads would still write waits for the end.
    let _step = step();
    let all = locked(&ALL);
    for path in all.iter() {
        // What cannot be removed stays, and nobody is there to be told.
        let _ = fs::remove_file(path);
    }
    locked(&FOLDERS).iter().rev().for_each(remove_empty);
    // Without what libraries do at an exit: graphics drivers take down what their threads still work on.
    #[cfg(unix)]
    signal_hook::low_level::exit(code);
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// Folders that are made for files to come. Dropped, those that are empty are gone.
#[derive(Default)]
pub(crate) struct Folders(Vec<PathBuf>);

impl Folders {
    /// Makes a folder and those that it is to lie in, where they are not there.
    ///
    /// # Errors
    /// In one line without the path.
    pub(crate) fn make(&mut self, path: &Path) -> Result<(), String> {
        if path.as_os_str().is_empty() || path.is_dir() {
            return Ok(());
        }
        if let Some(parent) = path.parent() {
            self.make(parent)?;
        }
        let mut all = locked(&FOLDERS);
        fs::create_dir(path).map_err(|err| super::said(&err))?;
        all.push(path.to_owned());
        self.0.push(path.to_owned());
        Ok(())
    }
}

impl Drop for Folders {
    fn drop(&mut self) {
        let mut all = locked(&FOLDERS);
        all.retain(|path| !self.0.contains(path));
        self.0.iter().rev().for_each(remove_empty);
    }
}

/// Removes a folder that has nothing in it; the system refuses all others.
fn remove_empty(path: &PathBuf) {
    let _ = fs::remove_dir(path);
}

/// Removes what processes that were killed outright left beside a target that nobody writes now.
#[cfg(feature = "editor")]
pub(crate) fn remove_left(target: &Path) {
    let opening = opening(target.file_name().unwrap_or_default());
    let entries = fs::read_dir(super::target::folder_of(target)).into_iter().flatten();
    for entry in entries.flatten().filter(|entry| {
        let name = entry.file_name();
        name.to_str().is_some_and(|name| name.starts_with(&opening) && name.ends_with(".part"))
    }) {
        // Whoever cleared up before us has removed it.
        let _ = fs::remove_file(entry.path());
    }
}

/// The start of a temporary's name beside `name`.
fn opening(name: &OsStr) -> String {
    let name = name.to_string_lossy();
    format!(".{}.", &name[..name.floor_char_boundary(MOST_OF_NAME)])
}

impl Temporary {
    /// Makes something under a fresh name beside `target`.
    fn beside<T>(
        target: &Path,
        mut make: impl FnMut(&Path) -> io::Result<T>,
    ) -> io::Result<(Self, T)> {
        let opening = opening(target.file_name().unwrap_or_default());
        for _ in 0..TRIES {
            // Every such state is seeded by the system, so processes that know nothing of each other differ.
            let random = RandomState::new().hash_one(std::process::id());
            let path = target.with_file_name(format!("{opening}{random:016x}.part"));
            let mut all = locked(&ALL);
            match make(&path) {
                Ok(made) => {
                    all.insert(path.clone());
                    return Ok((Self(path), made));
                }
                Err(err) if err.kind() == io::ErrorKind::AlreadyExists => {}
                Err(err) => return Err(err),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// A new file beside `target`, for its owner alone where `private`.
    pub(super) fn new(target: &Path, private: bool) -> io::Result<(Self, File)> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        if private {
            use std::os::unix::fs::OpenOptionsExt;
            options.mode(0o600);
        }
        #[cfg(not(unix))]
        let _ = private;
        Self::beside(target, |path| options.open(path))
    }

    /// Another name for the file `target`, which keeps its own where the disk knows second names.
    pub(super) fn second_name(target: &Path) -> io::Result<Self> {
        let linked = Self::beside(target, |path| fs::hard_link(target, path));
        linked.or_else(|_| Self::beside(target, |path| fs::rename(target, path))).map(|made| made.0)
    }

    /// Takes the place of `target`; where that fails, it is still this one.
    pub(super) fn become_file(self, target: &Path) -> Result<(), (Self, io::Error)> {
        let mut all = locked(&ALL);
        if let Err(err) = fs::rename(&self.0, target) {
            drop(all);
            return Err((self, err));
        }
        // Two names of one file are left as they are by a rename.
        let _ = fs::remove_file(&self.0);
        all.remove(&self.0);
        drop(all);
        std::mem::forget(self);
        Ok(())
    }

    /// Stays for good.
    pub(super) fn keep(self) -> PathBuf {
        locked(&ALL).remove(&self.0);
        let path = self.0.clone();
        std::mem::forget(self);
        path
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut all = locked(&ALL);
        // What is not there any more needs not be removed.
        let _ = fs::remove_file(&self.0);
        all.remove(&self.0);
    }
}
