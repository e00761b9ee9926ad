//! All that a command writes, as one step: every file is written first, then all are put in place, and when one cannot be the
//! old ones are back.
//!
//! It also knows what the command reads, so that nothing is written over that or twice, by whatever names and links.

use super::target::{FileIdentity, WriteTarget, place_of};
use super::temporary::{Temporary, step};
use super::{put_text, said};
use coif_graphs::schedule::run::CancelToken;
use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Cursor, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Files to be read and written, and those that are complete but not yet in place.
pub(crate) struct Together {
    roles: Arc<Mutex<Roles>>,
    /// The first file that the disk will not let us write.
    locked: Option<String>,
    written: Vec<(PathBuf, Written)>,
    synced: bool,
}

/// What files are to a command, each told in words.
#[derive(Default)]
struct Roles {
    of: BTreeMap<FileIdentity, (Role, String)>,
    /// Nothing more will be read or written.
    are_all: bool,
}

/// What a file is to a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// It is read.
    Read,
    /// It is what was asked for.
    Output,
    /// It tells what happened.
    Report,
}

/// Bytes on their way to a file. Fails at the next write when somebody asks to stop.
pub(crate) type Out = BufWriter<Stoppable>;

/// Where the bytes are until the file is put in place.
pub(crate) struct Stoppable {
    sink: Sink,
    cancel: CancelToken,
}

enum Sink {
    File(File),
    Memory(Cursor<Vec<u8>>),
}

impl Write for Stoppable {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.cancel.is_cancelled() {
            return Err(io::Error::other("interrupted"));
        }
        match &mut self.sink {
            Sink::File(file) => file.write(bytes).map_err(|err| match err.kind() {
                io::ErrorKind::Interrupted => err,
                kind => io::Error::new(kind, said(&err)),
            }),
            Sink::Memory(all) => all.write(bytes),
        }
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Stoppable {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.sink {
            Sink::File(file) => file.seek(to),
            Sink::Memory(all) => all.seek(to),
        }
    }
}

/// A complete file.
enum Written {
    /// It takes a name over.
    File(Temporary, PathBuf),
    /// It is sent somewhere.
    Sent(Vec<u8>, WriteTarget),
}

/// A name that was taken over: with a second name of what it was before, or nothing where nothing was.
struct Taken(PathBuf, Option<Temporary>);

impl Default for Together {
    fn default() -> Self {
        Self { roles: Arc::default(), locked: None, written: vec![], synced: true }
    }
}

impl Together {
    /// Another that knows what this one is told, now and later, for a thread that writes a report when this one cannot.
    pub(crate) fn another(&self) -> Self {
        Self { roles: self.roles.clone(), ..Self::default() }
    }

    fn roles(&self) -> MutexGuard<'_, Roles> {
        self.roles.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Files that are whole whatever happens to the process, but not to the power.
    #[cfg(any(feature = "editor", test))]
    pub(super) fn unsynced() -> Self {
        Self { synced: false, ..Self::default() }
    }

    /// Tells that a file is read, in words such as `the graph g.ron`. What is not there is no trouble.
    ///
    /// # Errors
    /// In one line, where the same file is to be written.
    pub(crate) fn reads(&mut self, path: &Path, words: String) -> Result<(), String> {
        match place_of(path) {
            Ok(place) => self.takes(place, Role::Read, words),
            Err(_) => Ok(()),
        }
    }

    /// Tells that a file is to be written, in words such as `--out a.usdc`.
    ///
    /// # Errors
    /// In one line, where the same file is read or has been told of.
    pub(crate) fn writes(&mut self, path: &Path, role: Role, words: String) -> Result<(), String> {
        let place = WriteTarget::at(path)
            .and_then(|target| target.refuse_locked().map(|()| target))
            .and_then(|target| target.place().map_err(|err| said(&err)));
        match place {
            Ok(Some(place)) => self.takes(place, role, words),
            Ok(None) => Ok(()),
            Err(reason) => {
                self.locked.get_or_insert(format!("{words}: {reason}"));
                Ok(())
            }
        }
    }

    fn takes(&mut self, place: FileIdentity, role: Role, words: String) -> Result<(), String> {
        let roles = &mut self.roles().of;
        let Some((had, other)) = roles.get(&place) else {
            roles.insert(place, (role, words));
            return Ok(());
        };
        let told = match (had, role) {
            (Role::Read, Role::Read) => return Ok(()),
            (Role::Read, _) => format!("{words}: is {other}, which is read; write to another file"),
            (_, Role::Read) => format!("{other}: is {words}, which is read; write to another file"),
            _ => format!("{words}: is the same file as {other}; each needs its own"),
        };
        // A report that is something else too is none from now on.
        if *had == Role::Report {
            roles.insert(place, (role, words));
        }
        Err(told)
    }

    /// Whether everything that is to be written can be, as far as that is seen beforehand. Asked when all has been told.
    ///
    /// # Errors
    /// The first that cannot, in one line.
    pub(crate) fn allowed(&self) -> Result<(), String> {
        self.roles().are_all = true;
        self.locked.clone().map_or(Ok(()), Err)
    }

    /// Whether a file may be written for this role still.
    pub(crate) fn may_be(&self, path: &Path, role: Role) -> bool {
        match WriteTarget::at(path).map(|target| target.place()) {
            Ok(Ok(Some(place))) => {
                self.roles().of.get(&place).is_none_or(|(found, _)| *found == role)
            }
            Ok(Ok(None)) => true,
            _ => false,
        }
    }

    /// The same while other files may still be told of: then only where no file stands yet.
    pub(crate) fn may_be_by_now(&self, path: &Path, role: Role) -> bool {
        let is_new =
            || !matches!(WriteTarget::at(path), Ok(WriteTarget::Name(_, Some(_))) | Err(_));
        (self.roles().are_all || is_new()) && self.may_be(path, role)
    }

    /// Whether anything but a report is to be written.
    pub(crate) fn has_outputs(&self) -> bool {
        self.roles().of.values().any(|(role, _)| *role == Role::Output)
    }

    /// Writes a complete file beside its target. The error is one line without the path.
    pub(crate) fn write(
        &mut self,
        named: &Path,
        cancel: &CancelToken,
        write: impl FnOnce(&mut Out) -> Result<(), String>,
    ) -> Result<(), String> {
        let target = WriteTarget::at(named)?;
        self.write_to(named, target, cancel, write)
    }

    /// The same for text.
    pub(crate) fn write_text(
        &mut self,
        named: &Path,
        text: &str,
        cancel: &CancelToken,
    ) -> Result<(), String> {
        self.write(named, cancel, |out| put_text(out, text))
    }

    /// The same for text that goes to standard output.
    pub(crate) fn print(&mut self, text: &str) -> Result<(), String> {
        let cancel = CancelToken::default();
        self.write_to(Path::new("-"), WriteTarget::Output, &cancel, |out| put_text(out, text))
    }

    fn write_to(
        &mut self,
        named: &Path,
        target: WriteTarget,
        cancel: &CancelToken,
        write: impl FnOnce(&mut Out) -> Result<(), String>,
    ) -> Result<(), String> {
        let (sink, temporary) = match &target {
            WriteTarget::Name(at, old) => {
                let made = Temporary::new(at, old.is_some()).map_err(|err| match err.kind() {
                    io::ErrorKind::PermissionDenied => "its folder may not be written".to_owned(),
                    // A folder of the system's own, such as /proc, says so of every name.
                    io::ErrorKind::NotFound if at.parent().is_some_and(Path::is_dir) => {
                        "its folder takes no files".to_owned()
                    }
                    _ => said(&err),
                })?;
                (Sink::File(made.1), Some(made.0))
            }
            WriteTarget::Stream(_) | WriteTarget::Output => (Sink::Memory(Cursor::default()), None),
        };
        let stoppable = Stoppable { sink, cancel: cancel.clone() };
        let mut out = BufWriter::with_capacity(1 << 20, stoppable);
        write(&mut out)?;
        let whole = out.into_inner().map_err(|err| err.error().to_string())?;
        let written = match (whole.sink, temporary, target) {
            (Sink::File(file), Some(temporary), WriteTarget::Name(at, old)) => {
                if let Some(old) = old {
                    take_after(&file, &old).map_err(|err| said(&err))?;
                }
                if self.synced {
                    file.sync_all().map_err(|err| said(&err))?;
                }
                Written::File(temporary, at)
            }
            (Sink::Memory(all), _, target) => Written::Sent(all.into_inner(), target),
            (Sink::File(_), ..) => return Err("has no name".to_owned()),
        };
        self.written.push((named.to_owned(), written));
        Ok(())
    }

    /// Names of what is written and not yet in place, as they were given.
    pub(crate) fn written(&self) -> Vec<String> {
        self.written.iter().map(|(named, _)| named.display().to_string()).collect()
    }

    /// Forgets what was written and is not in place.
    pub(crate) fn drop_written(&mut self) {
        self.written.clear();
    }

    /// Puts everything in place, as one step.
    ///
    /// # Errors
    /// The file that could not be, and why, in one line; everything is as it was before, or the line says what is not.
    pub(crate) fn place(&mut self, cancel: &CancelToken) -> Result<(), (PathBuf, String)> {
        let all = std::mem::take(&mut self.written);
        let alone = all.len() == 1;
        let (mut taken, mut sent) = (vec![], vec![]);
        let step = step();
        let mut placed = Ok(());
        for (named, written) in all {
            match written {
                Written::Sent(bytes, target) => sent.push((named, bytes, target)),
                Written::File(temporary, at) => match take(temporary, &at, alone) {
                    Ok(old) => taken.push(Taken(at, old)),
                    Err(reason) => {
                        placed = Err((named, reason));
                        break;
                    }
                },
            }
        }
        // What is sent cannot be taken back, so it comes last. Whoever reads at the other end may let us wait.
        let placed = match placed {
            Ok(()) => {
                drop(step);
                sent.into_iter().try_for_each(|(named, bytes, target)| {
                    send(bytes, target, cancel).map_err(|reason| (named, reason))
                })
            }
            failed => failed,
        };
        placed.map_err(|(named, mut reason)| {
            for Taken(at, old) in taken.into_iter().rev() {
                if let Err(left) = give_back(&at, old) {
                    reason += &format!("; {}: {left}", at.display());
                }
            }
            (named, reason)
        })
    }
}

/// Lets a file belong to whom the old one belongs, and with its mode.
fn take_after(file: &File, old: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let new = file.metadata()?;
        // Only root gives files away; a group that one is a member of may be given.
        if new.uid() != old.uid() {
            let _ = fchown(file, Some(old.uid()), None);
        }
        if new.gid() != old.gid() {
            let _ = fchown(file, None, Some(old.gid()));
        }
    }
    file.set_permissions(old.permissions())
}

/// Renames a complete file to its name. What stood there before has a second name then, unless the file is `alone`.
fn take(temporary: Temporary, at: &Path, alone: bool) -> Result<Option<Temporary>, String> {
    let is_there = match fs::symlink_metadata(at) {
        Ok(about) if about.is_file() => true,
        Ok(_) => return Err("has become something else than a file meanwhile".to_owned()),
        Err(err) if err.kind() == io::ErrorKind::NotFound => false,
        Err(err) => return Err(said(&err)),
    };
    let old = match is_there && !alone {
        true => Some(Temporary::second_name(at).map_err(|err| said(&err))?),
        false => None,
    };
    match temporary.become_file(at) {
        Ok(()) => Ok(old),
        Err((_, err)) => {
            let reason = said(&err);
            match old.map(|old| give_back(at, Some(old))) {
                Some(Err(left)) => Err(format!("{reason}; {left}")),
                _ => Err(reason),
            }
        }
    }
}

/// Lets a name be what it was before.
fn give_back(at: &Path, old: Option<Temporary>) -> Result<(), String> {
    match old {
        None => fs::remove_file(at).map_err(|err| format!("could not be removed: {err}")),
        Some(old) => old
            .become_file(at)
            .map_err(|(old, err)| format!("what was there is now {}: {err}", old.keep().display())),
    }
}

/// How long it takes until somebody who waits for the other end looks whether to go on.
const LOOKS: Duration = Duration::from_millis(50);

/// Writes to what is no file, on a thread of its own: a pipe that nobody reads lets it wait for ever.
fn send(bytes: Vec<u8>, target: WriteTarget, cancel: &CancelToken) -> Result<(), String> {
    let (tell, told) = channel();
    let written = move || match target {
        WriteTarget::Output => {
            let mut out = io::stdout().lock();
            match out.write_all(&bytes).and_then(|()| out.flush()) {
                // A reader that went away is no error of ours.
                Err(err) if err.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                ended => ended,
            }
        }
        WriteTarget::Stream(at) | WriteTarget::Name(at, _) => {
            // What somebody else wrote to an open file before stays.
            let mut file = File::options().append(true).open(at)?;
            file.write_all(&bytes)
        }
    };
    std::thread::Builder::new()
        .spawn(move || tell.send(written().map_err(|err| said(&err))))
        .map_err(|err| err.to_string())?;
    loop {
        match told.recv_timeout(LOOKS) {
            Ok(ended) => return ended,
            Err(RecvTimeoutError::Disconnected) => return Err("could not be written".to_owned()),
            Err(RecvTimeoutError::Timeout) if cancel.is_cancelled() => {
                return Err("interrupted".to_owned());
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}
