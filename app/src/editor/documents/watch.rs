//! Notices that files changed on the disk: the open document's, and the meshes that it names.
//!
//! A thread looks at time and size each second; only when these differ it reads the file, and only when its content
//! differs from what is known somebody is told. A file that is written in place is told when it has been quiet for one
//! look. Network folders that hang make the thread wait, never the window.

use std::collections::BTreeMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hasher};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

/// Between two looks at files. Tests count looks, and wait for many.
const EVERY: Duration = Duration::from_millis(if cfg!(test) { 20 } else { 1000 });

/// What became of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// It says something else now.
    Content(PathBuf),
    /// It is not there any more.
    Gone(PathBuf),
}

/// A thread that looks at files.
pub(crate) struct Watch {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

#[derive(Default)]
struct State {
    files: BTreeMap<PathBuf, Known>,
    changes: Vec<Change>,
    /// Times that all of them were looked at.
    looks: u64,
    end: bool,
}

/// What is known of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Known {
    /// None until it was looked at for the first time.
    seen: Option<Seen>,
    /// Hash of the content that the program has; none until it was read.
    hash: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seen {
    Missing,
    There { changed: SystemTime, len: u64, told: bool },
}

/// Stands for the content of a file that is not there.
const NO_CONTENT: u64 = 0;

fn locked(shared: &Shared) -> MutexGuard<'_, State> {
    shared.state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The hash by which contents are told apart, within this process.
pub(crate) fn hash_of(bytes: &[u8]) -> u64 {
    let mut hash = DefaultHasher::new();
    hash.write(bytes);
    hash.finish()
}

impl Watch {
    /// A thread that looks at nothing yet and calls `wake` when there is something to tell.
    pub(crate) fn start(wake: impl Fn() + Send + 'static) -> Self {
        Self::every(EVERY, wake)
    }

    fn every(every: Duration, wake: impl Fn() + Send + 'static) -> Self {
        let shared = Arc::new(Shared::default());
        let for_thread = shared.clone();
        let thread = std::thread::Builder::new()
            .name("files on disk".to_owned())
            .spawn(move || look_on(&for_thread, every, &wake));
        // Without a thread nothing is noticed, as on systems that tell no times.
        Self { shared, thread: thread.ok() }
    }

    /// Looks at these files from now on, and no others.
    pub(crate) fn files<'a>(&self, paths: impl IntoIterator<Item = &'a Path>) {
        let mut state = locked(&self.shared);
        let mut old = std::mem::take(&mut state.files);
        state.files = paths
            .into_iter()
            .map(|path| (path.to_owned(), old.remove(path).unwrap_or_default()))
            .collect();
    }

    /// The program has, or is about to write, this content of a file: it is no news.
    pub(crate) fn knows(&self, path: &Path, hash: u64) {
        let mut state = locked(&self.shared);
        // What was seen is kept: a look before the file is written finds nothing new.
        state.files.entry(path.to_owned()).or_default().hash = Some(hash);
        state.changes.retain(|change| change_of(change) != path);
    }

    /// How often all files were looked at, from begin to end.
    #[cfg(test)]
    pub(crate) fn looks(&self) -> u64 {
        locked(&self.shared).looks
    }

    /// What happened since this was asked last.
    pub(crate) fn changes(&self) -> Vec<Change> {
        std::mem::take(&mut locked(&self.shared).changes)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        locked(&self.shared).end = true;
        self.shared.wake.notify_one();
        // A thread that hangs in a folder of a network ends with the process.
        drop(self.thread.take());
    }
}

fn change_of(change: &Change) -> &Path {
    match change {
        Change::Content(path) | Change::Gone(path) => path,
    }
}

fn look_on(shared: &Shared, every: Duration, wake: &dyn Fn()) {
    loop {
        let files: Vec<(PathBuf, Known)> = {
            let state = locked(shared);
            let waited = shared.wake.wait_timeout_while(state, every, |state| !state.end);
            let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
            if state.end {
                return;
            }
            state.files.iter().map(|(path, known)| (path.clone(), *known)).collect()
        };
        let mut told = false;
        for (path, before) in files {
            let (now, change) = look(&path, before);
            let mut state = locked(shared);
            // What was learnt or dropped meanwhile is newer than this look.
            match state.files.get_mut(&path) {
                Some(known) if *known == before => *known = now,
                _ => continue,
            }
            if let Some(change) = change {
                state.changes.retain(|old| change_of(old) != change_of(&change));
                state.changes.push(change);
                told = true;
            }
        }
        locked(shared).looks += 1;
        if told {
            wake();
        }
    }
}

/// What is known after a look, and what there is to tell.
fn look(path: &Path, before: Known) -> (Known, Option<Change>) {
    let about = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file);
    let Some(about) = about else {
        let was_there = matches!(before.seen, Some(Seen::There { .. }));
        // What comes back, or comes for the first time, is news; a file that the program is about to write is not.
        let hash = if was_there || before.hash.is_none() { Some(NO_CONTENT) } else { before.hash };
        let known = Known { seen: Some(Seen::Missing), hash };
        return (known, was_there.then(|| Change::Gone(path.to_owned())));
    };
    let changed = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
    let (len, hash) = (about.len(), before.hash);
    let quiet = match before.seen {
        Some(Seen::There { changed: then, len: then_len, told }) => {
            if told && (then, then_len) == (changed, len) {
                return (before, None);
            }
            (then, then_len) == (changed, len)
        }
        // The first look at a file, and the first after it came back.
        None => true,
        Some(Seen::Missing) => false,
    };
    if !quiet {
        let seen = Some(Seen::There { changed, len, told: false });
        return (Known { seen, hash }, None);
    }
    let seen = Some(Seen::There { changed, len, told: true });
    match hash_file(path) {
        Some(now) if hash.is_some_and(|known| known != now) => {
            (Known { seen, hash: Some(now) }, Some(Change::Content(path.to_owned())))
        }
        Some(now) => (Known { seen, hash: Some(now) }, None),
        None => (Known { seen: Some(Seen::There { changed, len, told: false }), hash }, None),
    }
}

fn hash_file(path: &Path) -> Option<u64> {
    let mut file = File::open(path).ok()?;
    let (mut hash, mut buffer) = (DefaultHasher::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer).ok()? {
            0 => return Some(hash.finish()),
            n => hash.write(&buffer[..n]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Folder, until};
    use std::sync::atomic::{AtomicU32, Ordering};

    fn watch() -> (Watch, Arc<AtomicU32>) {
        let woken = Arc::new(AtomicU32::new(0));
        let count = woken.clone();
        let wake = move || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        (Watch::every(Duration::from_millis(1), wake), woken)
    }
    /// As everybody should: whole or not at all.
    fn write(path: &Path, text: &str) {
        let beside = path.with_extension("part");
        std::fs::write(&beside, text).unwrap();
        std::fs::rename(beside, path).unwrap();
    }
    fn next(watch: &Watch) -> Vec<Change> {
        let mut all = vec![];
        until("a change is told", || {
            all.extend(watch.changes());
            !all.is_empty()
        });
        all
    }
    fn quiet(watch: &Watch) {
        // One look may have begun before the file changed, and what is written in place is told by the second that sees it.
        let before = watch.looks();
        until("it was looked at", || watch.looks() >= before + 3);
        assert_eq!(watch.changes(), []);
    }

    #[test]
    fn what_others_write_is_told_and_what_we_write_is_not() {
        let folder = Folder::new("watch");
        let path = folder.path("a.ron");
        write(&path, "one");
        let (watch, woken) = watch();
        watch.knows(&path, hash_of(b"one"));
        quiet(&watch);
        write(&path, "three");
        assert_eq!(next(&watch), [Change::Content(path.clone())]);
        assert_eq!(woken.load(Ordering::Relaxed), 1);
        quiet(&watch);
        watch.knows(&path, hash_of(b"ours"));
        write(&path, "ours");
        quiet(&watch);
        // The same content again, as by a tool that only touches files.
        write(&path, "ours");
        quiet(&watch);
        std::fs::remove_file(&path).unwrap();
        assert_eq!(next(&watch), [Change::Gone(path.clone())]);
        write(&path, "back");
        assert_eq!(next(&watch), [Change::Content(path)]);
    }

    #[test]
    fn a_file_changed_before_it_was_looked_at_is_told() {
        let folder = Folder::new("watch-first");
        let path = folder.path("a.ron");
        write(&path, "changed while it was opened");
        let (watch, _) = watch();
        watch.knows(&path, hash_of(b"as it was read"));
        assert_eq!(next(&watch), [Change::Content(path)]);
    }

    #[test]
    fn meshes_are_known_by_their_first_look_until_nobody_names_them() {
        let folder = Folder::new("watch-mesh");
        let (a, b) = (folder.path("a.obj"), folder.path("b.obj"));
        write(&a, "v 0 0 0");
        let (watch, _) = watch();
        watch.files([a.as_path(), b.as_path()]);
        quiet(&watch);
        write(&a, "v 0 0 1 ");
        assert_eq!(next(&watch), [Change::Content(a.clone())]);
        watch.files([b.as_path()]);
        write(&a, "v 0 1");
        quiet(&watch);
        write(&b, "v 1 2 3");
        assert_eq!(next(&watch), [Change::Content(b)]);
    }
}
