//! What a path leads to, before anything is written there.
//!
//! Links are followed by hand to the name where a file stands or is to stand, so that they stay and the file beside which
//! everything is written is the right one. What is no file is written to and never replaced. Looking changes nothing.

use super::said;
use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// As many links as systems follow.
const MOST_LINKS: usize = 40;

/// Where bytes go.
#[derive(Debug)]
pub(super) enum WriteTarget {
    /// A name that is no link: of a file that stands there, or of none yet.
    Name(PathBuf, Option<Metadata>),
    /// A device, a pipe, or a file that is already open: it is opened and written to.
    Stream(PathBuf),
    /// Standard output.
    Output,
}

/// The same for two paths exactly when they lead to one file, there or to come.
pub(super) type FileIdentity = (Node, Option<OsString>);

#[cfg(unix)]
type Node = (u64, u64);
#[cfg(unix)]
fn node(path: &Path) -> io::Result<Node> {
    use std::os::unix::fs::MetadataExt;
    let about = fs::metadata(path)?;
    Ok((about.dev(), about.ino()))
}
/// Two names of one file (hard links) are two places here: nothing that we may call tells.
#[cfg(not(unix))]
type Node = PathBuf;
#[cfg(not(unix))]
fn node(path: &Path) -> io::Result<Node> {
    path.canonicalize()
}

/// The place of what is there.
pub(super) fn place_of(path: &Path) -> io::Result<FileIdentity> {
    Ok((node(path)?, None))
}

impl WriteTarget {
    /// What `named` leads to; `-` is a name like any other.
    ///
    /// # Errors
    /// A folder, a disk, a link that leads nowhere, a missing folder, or something that may not be written by its mode (which
    /// root may ignore, and we do not). One line without the path.
    pub(super) fn at(named: &Path) -> Result<Self, String> {
        let mut at = named.to_owned();
        let leads = |at: &Path, reason: String| match at == named {
            true => reason,
            false => format!("leads to {}: {reason}", at.display()),
        };
        for _ in 0..=MOST_LINKS {
            let about = match fs::symlink_metadata(&at) {
                Ok(about) => about,
                Err(err) if err.kind() == io::ErrorKind::NotFound => {
                    at.file_name().ok_or_else(|| leads(&at, "is no file name".to_owned()))?;
                    fs::metadata(folder_of(&at)).map_err(|err| leads(&at, said(&err)))?;
                    return Ok(Self::Name(at, None));
                }
                Err(err) => return Err(leads(&at, said(&err))),
            };
            if about.is_dir() {
                return Err(leads(&at, "is a folder".to_owned()));
            }
            if about.is_symlink() && !is_handle(&at) {
                let next = fs::read_link(&at).map_err(|err| leads(&at, said(&err)))?;
                at = folder_of(&at).join(next);
                continue;
            }
            // What an open file's handle leads to is not a name: another file of that name would not be it.
            let is_name = about.is_file();
            let about = fs::metadata(&at).map_err(|err| leads(&at, said(&err)))?;
            if about.is_dir() {
                return Err(leads(&at, "is a folder".to_owned()));
            }
            if is_read_only(&about) {
                return Err(leads(&at, "is read-only".to_owned()));
            }
            if is_disk(&about) {
                return Err(leads(&at, "is a whole disk".to_owned()));
            }
            return Ok(if is_name { Self::Name(at, Some(about)) } else { Self::Stream(at) });
        }
        Err("is a link that leads in a circle".to_owned())
    }

    /// Refuses an existing file that the system will not let us write, whatever may be renamed in its folder.
    pub(super) fn refuse_locked(&self) -> Result<(), String> {
        match self {
            // Opened without a change; the system knows more about rights than modes say.
            Self::Name(at, Some(_)) => {
                File::options().write(true).open(at).map(drop).map_err(|err| said(&err))
            }
            _ => Ok(()),
        }
    }

    /// Where it is; none where any number may write.
    pub(super) fn place(&self) -> io::Result<Option<FileIdentity>> {
        match self {
            Self::Name(at, Some(_)) => place_of(at).map(Some),
            Self::Name(at, None) => {
                Ok(Some((node(folder_of(at))?, at.file_name().map(OsString::from))))
            }
            Self::Stream(at) if is_device(&fs::metadata(at)?) => Ok(None),
            Self::Stream(at) => place_of(at).map(Some),
            Self::Output => Ok(None),
        }
    }
}

/// The folder that a name stands in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Whether a link is a handle of an open file, as `/dev/stdout` leads to: the kernel opens the file itself, and what the link
/// says is for people.
fn is_handle(link: &Path) -> bool {
    cfg!(target_os = "linux")
        && folder_of(link).canonicalize().is_ok_and(|folder| folder.starts_with("/proc"))
}

/// Whether its owner may not write it.
#[cfg(unix)]
fn is_read_only(about: &Metadata) -> bool {
    use std::os::unix::fs::PermissionsExt;
    about.permissions().mode() & 0o200 == 0
}
#[cfg(not(unix))]
fn is_read_only(about: &Metadata) -> bool {
    about.permissions().readonly()
}

#[cfg(unix)]
fn is_disk(about: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    about.file_type().is_block_device()
}
#[cfg(not(unix))]
fn is_disk(_: &Metadata) -> bool {
    false
}

#[cfg(unix)]
fn is_device(about: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    about.file_type().is_char_device()
}
#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}
