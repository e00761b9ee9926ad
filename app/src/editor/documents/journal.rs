//! What a crash leaves: the document as it was, kept by a thread that nobody waits for.
//!
//! After every step the editor hands the journal a snapshot (a copy of pointers); the writer turns the newest one into
//! text and renames it over the one before. Guaranteed: once [`Journal::is_done`] says so, the document that was given
//! last is found again, whatever kills the process; until then a whole earlier one is. The writer has at most one
//! document in work and one waiting, so a process that is killed loses at most the steps of two writes, some
//! milliseconds each.
//!
//! For when the power fails, the text is then synced, and the newest synced one is kept until the next is: two files a
//! session. A session is alive while it holds the lock of its own lock file, which the system lets go of however it ends; so
//! sessions do not disturb each other, and numbers of processes may be given twice.

use crate::files::{MOST_DOCUMENT, name_twice, new_lock, remove_left, write_text_unsynced};
use coif_graphs::document::Document;
use coif_graphs::file::{read_bytes, write};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

/// The first line of a kept document, before what is told about it.
const OPENING: &str = "// coif recovery ";
/// Sessions that are looked at: more are no crash but a habit.
const MOST_LEFT: usize = 50;

/// What is told about a kept document besides itself.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct About {
    /// The file that it was opened from or saved to, when there was one.
    pub(crate) path: Option<PathBuf>,
    /// What people called it.
    pub(crate) name: String,
    /// Seconds since 1970 when it was kept.
    pub(crate) at: u64,
}

/// The journal of this session. Dropped without [`Journal::close`] (a panic), it leaves its files.
pub(crate) struct Journal {
    shared: Arc<Shared>,
    writer: Option<JoinHandle<()>>,
    files: Files,
    _alive: File,
}

#[derive(Default)]
struct Shared {
    inbox: Mutex<Inbox>,
    wake: Condvar,
    written: AtomicU64,
    synced: AtomicU64,
    fault: Mutex<Option<String>>,
}

#[derive(Default)]
struct Inbox {
    /// Number of the newest wish.
    number: u64,
    wish: Option<Wish>,
    /// To be removed after the wish.
    forget: Vec<Files>,
    end: bool,
}

enum Wish {
    Keep(Box<(About, Document)>),
    /// Nothing is unsaved any more.
    Clear,
}

/// The files of one session.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Files {
    folder: PathBuf,
    session: String,
}

impl Files {
    fn path(&self, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", self.session))
    }
    /// The newest text.
    fn text(&self) -> PathBuf {
        self.path("ron")
    }
    /// The newest text that was synced before the newest text was written.
    fn synced(&self) -> PathBuf {
        self.path("synced")
    }
    fn lock(&self) -> PathBuf {
        self.path("lock")
    }
    fn clear(&self) {
        for path in [self.text(), self.synced()] {
            // What is not there is removed.
            let _ = std::fs::remove_file(path);
        }
    }
    fn remove(&self) {
        self.clear();
        remove_left(&self.text());
        let _ = std::fs::remove_file(self.lock());
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Journal {
    /// A journal of a session of its own in `folder`, which is made where it is missing.
    pub(crate) fn open(folder: &Path) -> io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let (files, alive) = (0..1000)
            .find_map(|n| {
                let session = format!("{:013}-{}-{n}", since.as_millis(), std::process::id());
                let files = Files { folder: folder.to_owned(), session };
                match new_lock(&files.lock()) {
                    Err(err) if err.kind() == io::ErrorKind::AlreadyExists => None,
                    made => Some(made.map(|alive| (files, alive))),
                }
            })
            .unwrap_or(Err(io::ErrorKind::AlreadyExists.into()))?;
        alive.lock()?;
        let shared = Arc::new(Shared::default());
        let (for_writer, to) = (shared.clone(), files.clone());
        let writer = std::thread::Builder::new()
            .name("recovery".to_owned())
            .spawn(move || write_on(&for_writer, &to))?;
        Ok(Self { shared, writer: Some(writer), files, _alive: alive })
    }

    /// Keeps a document instead of the one before. Gives its number.
    pub(crate) fn keep(&self, about: About, document: Document) -> u64 {
        self.wish(Wish::Keep(Box::new((about, document))))
    }

    /// Nothing is unsaved: keeps nothing, until the next document.
    pub(crate) fn clear(&self) -> u64 {
        self.wish(Wish::Clear)
    }

    /// Removes what another session left, once everything wished before is done.
    pub(crate) fn forget(&self, leftover: Leftover) {
        let mut inbox = locked(&self.shared.inbox);
        inbox.forget.push(leftover.files);
        drop(inbox);
        self.shared.wake.notify_one();
    }

    /// The number of the newest wish that is done.
    fn written(&self) -> u64 {
        self.shared.written.load(Ordering::Acquire)
    }

    /// The number of the newest wish whose text is synced.
    #[cfg(test)]
    fn synced(&self) -> u64 {
        self.shared.synced.load(Ordering::Acquire)
    }

    /// Whether everything wished for is done.
    pub(crate) fn is_done(&self) -> bool {
        self.written() == locked(&self.shared.inbox).number
    }

    /// Why the last document could not be kept; told once.
    pub(crate) fn fault(&self) -> Option<String> {
        locked(&self.shared.fault).take()
    }

    /// The session ends as somebody wanted: nothing is left.
    pub(crate) fn close(mut self) {
        self.clear();
        self.end();
        self.files.remove();
    }

    fn wish(&self, wish: Wish) -> u64 {
        let mut inbox = locked(&self.shared.inbox);
        inbox.number += 1;
        inbox.wish = Some(wish);
        let number = inbox.number;
        drop(inbox);
        self.shared.wake.notify_one();
        number
    }

    fn end(&mut self) {
        locked(&self.shared.inbox).end = true;
        self.shared.wake.notify_one();
        if let Some(writer) = self.writer.take() {
            // A writer that failed has left what it had written.
            let _ = writer.join();
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.end();
    }
}

/// The writer: the newest wish, again and again, until the end.
fn write_on(shared: &Shared, files: &Files) {
    let mut is_synced = false;
    loop {
        let mut inbox = locked(&shared.inbox);
        while inbox.wish.is_none() && inbox.forget.is_empty() && !inbox.end {
            inbox = shared.wake.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
        let (wish, number) = (inbox.wish.take(), inbox.number);
        let forget = std::mem::take(&mut inbox.forget);
        let end = inbox.end;
        drop(inbox);
        let done = match wish {
            Some(Wish::Keep(kept)) => {
                if is_synced {
                    // A second name for the text that is about to be replaced; file systems without them have one text.
                    name_twice(&files.text(), &files.synced());
                }
                is_synced = false;
                let (about, document) = *kept;
                put(files, &about, &document)
            }
            Some(Wish::Clear) => {
                files.clear();
                Ok(())
            }
            None => Ok(()),
        };
        match done {
            Ok(()) => {
                shared.written.store(number, Ordering::Release);
                forget.iter().for_each(Files::remove);
            }
            Err(err) => {
                let text = format!("{}: {err}", files.text().display());
                *locked(&shared.fault) = Some(text);
            }
        }
        if end {
            return;
        }
        if !is_synced && locked(&shared.inbox).wish.is_none() {
            is_synced = File::open(files.text()).and_then(|file| file.sync_all()).is_ok();
            shared.synced.store(if is_synced { number } else { 0 }, Ordering::Release);
        }
    }
}

fn put(files: &Files, about: &About, document: &Document) -> io::Result<()> {
    let about = serde_json::to_string(about)?;
    let text = format!("{OPENING}{about}\n{}", write(document));
    write_text_unsynced(&files.text(), &text).map_err(io::Error::other)
}

/// What a session left that ended otherwise than somebody wanted. While this lives, no other session is offered it.
pub(crate) struct Leftover {
    /// What was told about it.
    pub(crate) about: About,
    /// The document after the last step that was kept.
    pub(crate) document: Document,
    files: Files,
    _claim: File,
}

impl Leftover {
    /// Removes it for good.
    pub(crate) fn discard(self) {
        self.files.remove();
    }
}

/// What sessions left that are not alive, the latest first. What cannot be read stays where it is.
pub(crate) fn leftovers(folder: &Path) -> Vec<Leftover> {
    let Ok(entries) = std::fs::read_dir(folder) else { return vec![] };
    let mut sessions: Vec<String> = entries
        .flatten()
        .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(".ron")?.to_owned()))
        .collect();
    sessions.sort_unstable_by(|a, b| b.cmp(a));
    sessions.truncate(MOST_LEFT);
    let found = sessions.into_iter().filter_map(|session| {
        let files = Files { folder: folder.to_owned(), session };
        let claim = File::options().create(true).append(true).open(files.lock()).ok()?;
        claim.try_lock().ok()?;
        // Gone, when another session has just dealt with it.
        let (about, document) = read(&files.text()).or_else(|| read(&files.synced()))?;
        Some(Leftover { about, document, files, _claim: claim })
    });
    found.collect()
}

fn read(path: &Path) -> Option<(About, Document)> {
    if std::fs::metadata(path).ok()?.len() > MOST_DOCUMENT {
        return None;
    }
    let bytes = std::fs::read(path).ok()?;
    let end = bytes.iter().position(|b| *b == b'\n')?;
    let (first, rest) = bytes.split_at(end + 1);
    let about = serde_json::from_slice(first.strip_prefix(OPENING.as_bytes())?).ok()?;
    Some((about, read_bytes(rest).ok()?.document))
}

/// Seconds since 1970.
pub(crate) fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Folder, until};

    fn numbered(n: u64) -> Document {
        Document { title: format!("step {n}"), seed: n, ..Document::default() }
    }
    fn about(name: &str) -> About {
        About { path: Some("/somewhere/a b.ron".into()), name: name.to_owned(), at: 7 }
    }
    fn seeds(folder: &Folder) -> Vec<u64> {
        leftovers(folder.root()).iter().map(|left| left.document.seed).collect()
    }

    #[test]
    fn what_was_kept_last_is_found_and_nothing_of_the_living() {
        let folder = Folder::new("journal");
        let journal = Journal::open(folder.root()).unwrap();
        let last = (1..=200).map(|n| journal.keep(about("x"), numbered(n))).max().unwrap();
        until("the last is written", || journal.written() == last);
        assert!(seeds(&folder).is_empty(), "the session is alive");
        drop(journal);
        let left = leftovers(folder.root());
        assert_eq!((left.len(), &left[0].about), (1, &about("x")));
        assert_eq!(left[0].document, numbered(200));
        assert!(seeds(&folder).is_empty(), "it is offered once");
        drop(left);
        assert_eq!(seeds(&folder), [200], "and again where it was kept");
    }

    #[test]
    fn what_was_saved_or_closed_leaves_nothing() {
        let folder = Folder::new("journal-clear");
        let journal = Journal::open(folder.root()).unwrap();
        journal.keep(about("x"), numbered(1));
        journal.clear();
        drop(journal);
        assert!(seeds(&folder).is_empty());
        let journal = Journal::open(folder.root()).unwrap();
        journal.keep(about("x"), numbered(2));
        journal.close();
        assert!(seeds(&folder).is_empty());
        let left = std::fs::read_dir(folder.root()).unwrap().flatten();
        let left: Vec<_> = left.map(|entry| entry.file_name()).collect();
        assert_eq!(left.len(), 1, "only the lock of the first, which was not closed: {left:?}");
    }

    #[test]
    fn sessions_do_not_disturb_each_other() {
        let folder = Folder::new("journal-several");
        let journals: Vec<Journal> =
            (0..5).map(|_| Journal::open(folder.root()).unwrap()).collect();
        for (i, journal) in journals.iter().enumerate() {
            let number = journal.keep(about("x"), numbered(i as u64));
            until("it is written", || journal.written() == number);
        }
        let mut journals: Vec<Option<Journal>> = journals.into_iter().map(Some).collect();
        journals[1].take();
        journals[3].take();
        let mut left = seeds(&folder);
        left.sort_unstable();
        assert_eq!(left, [1, 3]);
    }

    #[test]
    fn what_was_restored_is_forgotten_only_when_it_is_kept_again() {
        let folder = Folder::new("journal-restore");
        let dead = Journal::open(folder.root()).unwrap();
        dead.keep(about("x"), numbered(5));
        drop(dead);
        let journal = Journal::open(folder.root()).unwrap();
        let left = leftovers(folder.root()).pop().unwrap();
        let number = journal.keep(left.about.clone(), left.document.clone());
        journal.forget(left);
        until("it is written", || journal.written() == number);
        drop(journal);
        assert_eq!(seeds(&folder), [5]);
    }

    #[test]
    fn a_torn_text_gives_the_synced_one_and_rubbish_nothing() {
        let folder = Folder::new("journal-torn");
        let journal = Journal::open(folder.root()).unwrap();
        let files = journal.files.clone();
        for n in 1..=3 {
            let number = journal.keep(about("x"), numbered(n));
            until("it is synced", || journal.synced() == number);
        }
        drop(journal);
        std::fs::write(files.text(), "").unwrap();
        assert_eq!(seeds(&folder), [2]);
        for rubbish in
            [&b""[..], b"\xff\xff\xff\n", b"// coif recovery {}\n((((", b"// coif recovery"]
        {
            std::fs::write(files.text(), rubbish).unwrap();
            std::fs::write(files.synced(), rubbish).unwrap();
            assert!(seeds(&folder).is_empty());
        }
    }

    #[test]
    fn where_nothing_can_be_written_somebody_is_told_once() {
        let folder = Folder::new("journal-full");
        let journal = Journal::open(folder.root()).unwrap();
        std::fs::create_dir(journal.files.text()).unwrap();
        journal.keep(about("x"), numbered(1));
        let mut told = None;
        until("it is told", || {
            told = journal.fault();
            told.is_some()
        });
        assert!(told.unwrap().contains(".ron: "));
        assert_eq!((journal.fault(), journal.written()), (None, 0));
    }
}
