//! The files that were open lately: at most twenty, the latest first, each once.
//!
//! Several sessions share the list, so it is read again before every change. Whether the files are still there is looked up
//! on another thread: a folder of a network that is away would make the window wait.

use super::kept;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The most files that are remembered.
const MOST: usize = 20;

/// The list, kept in a file where there is one.
#[derive(Default)]
pub(crate) struct Recent {
    kept_in: Option<PathBuf>,
    files: Vec<PathBuf>,
    missing: Arc<Mutex<Vec<PathBuf>>>,
}

impl Recent {
    /// The list that is kept in a file, and what to tell when it was damaged.
    pub(crate) fn load(kept_in: PathBuf) -> (Self, Option<String>) {
        let (files, told) = kept::load(&kept_in);
        (Self { kept_in: Some(kept_in), files, missing: Arc::default() }, told)
    }

    /// The latest first.
    pub(crate) fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Whether the last [`Recent::look`] did not find a file.
    pub(crate) fn is_missing(&self, path: &Path) -> bool {
        let missing = self.missing.lock().unwrap_or_else(PoisonError::into_inner);
        missing.iter().any(|known| known == path)
    }

    /// Finds out which files are missing and calls `done`; returns at once.
    pub(crate) fn look(&self, done: impl FnOnce() + Send + 'static) {
        let (files, missing) = (self.files.clone(), self.missing.clone());
        // Without a thread nothing is known to be missing.
        let _ = std::thread::Builder::new().name("recent files".to_owned()).spawn(move || {
            let gone = files.into_iter().filter(|path| !path.is_file()).collect();
            *missing.lock().unwrap_or_else(PoisonError::into_inner) = gone;
            done();
        });
    }

    /// A file was opened or saved.
    pub(crate) fn add(&mut self, path: &Path) -> Result<(), String> {
        self.change(|files| files.insert(0, path.to_owned()), path)
    }

    /// Somebody wants a file forgotten.
    pub(crate) fn remove(&mut self, path: &Path) -> Result<(), String> {
        self.change(|_| {}, path)
    }

    fn change(&mut self, put: impl FnOnce(&mut Vec<PathBuf>), path: &Path) -> Result<(), String> {
        if let Some(kept_in) = &self.kept_in {
            (self.files, _) = kept::load(kept_in);
        }
        self.files.retain(|known| known != path);
        put(&mut self.files);
        self.files.truncate(MOST);
        let Some(kept_in) = &self.kept_in else { return Ok(()) };
        // A path that is no text cannot stand in the file.
        let written: Vec<&str> = self.files.iter().filter_map(|path| path.to_str()).collect();
        kept::store(kept_in, &written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Folder, until};

    #[test]
    fn the_latest_come_first_each_once_at_most_twenty_shared_by_sessions() {
        let folder = Folder::new("recent");
        let kept = folder.path("recent.ron");
        let (mut one, told) = Recent::load(kept.clone());
        assert!(told.is_none() && one.files().is_empty());
        for i in 0..30 {
            one.add(&folder.path(&format!("{i}.ron"))).unwrap();
        }
        let (mut other, _) = Recent::load(kept.clone());
        assert_eq!(other.files().len(), 20);
        assert_eq!(other.files()[0], folder.path("29.ron"));
        other.add(&folder.path("15.ron")).unwrap();
        one.add(&folder.path("new.ron")).unwrap();
        one.remove(&folder.path("29.ron")).unwrap();
        let (after, _) = Recent::load(kept);
        let first = ["new.ron", "15.ron", "28.ron"].map(|name| folder.path(name));
        assert_eq!(after.files()[..3], first);
        assert_eq!(after.files().len(), 19);
    }

    #[test]
    fn what_is_not_there_any_more_is_known_to_be_missing() {
        let folder = Folder::new("recent-missing");
        let (mut recent, _) = Recent::load(folder.path("recent.ron"));
        let (here, gone) = (folder.path("here.ron"), folder.path("gone.ron"));
        std::fs::write(&here, "()").unwrap();
        recent.add(&here).unwrap();
        recent.add(&gone).unwrap();
        let (send, receive) = std::sync::mpsc::channel();
        recent.look(move || send.send(()).unwrap());
        until("the look is done", || receive.try_recv().is_ok());
        assert!(recent.is_missing(&gone) && !recent.is_missing(&here));
    }
}
