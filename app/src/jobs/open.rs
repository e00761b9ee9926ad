//! Opening grooms: a file, a shipped groom by its name, or a pack, with all that is said of it; and what else is read and written
//! beside it.
//!
//! What is wrong is told in full; a comment that would be lost where the graph is written anew is refused by whoever writes.

use super::stop::{Exit, Stop};
use crate::files::{MOST_DOCUMENT, Role, Together};
use crate::pack::{is_pack, read::Pack};
use coif_graphs::document::Document;
use coif_graphs::file::{self, FileError, Loaded};
use coif_graphs::grooms;
use coif_graphs::schedule::files::{mount, read_by};
use coif_nodes::define::short;
use std::path::{Path, PathBuf};

/// Tells `files` of all that a document names.
pub(crate) fn reads_all(
    document: &Document,
    folder: &Path,
    files: &mut Together,
) -> Result<(), Stop> {
    let mut all = read_by(document, folder).into_iter();
    all.try_for_each(|(node, path)| files.reads(&path, format!("{} of {node}", path.display())))
        .map_err(Stop::refused)
}

/// A graph that was read.
pub(crate) struct Read {
    /// The document, and all that is said of it.
    pub(crate) loaded: Loaded,
    /// Its text.
    pub(crate) text: Vec<u8>,
    /// What its paths are relative to; none where the graph comes with coif.
    pub(crate) folder: Option<PathBuf>,
    /// What messages call it: of a pack the graph in it.
    pub(crate) shown: String,
}

/// The document of a file, or the shipped groom of that name, and the folder that its paths are relative to. For who
/// writes a graph: none of a pack is given, whose files lie nowhere.
pub(crate) fn load(path: &Path, warnings: &mut Vec<String>) -> Result<(Document, PathBuf), Stop> {
    let (loaded, folder) = read(path)?;
    let lost = lost_comments(path, &loaded.dropped_comments);
    if !lost.is_empty() {
        return Err(Stop(Exit::Refused, lost));
    }
    tell_of(path.display(), &loaded, warnings);
    Ok((loaded.document, folder))
}

/// What to do about each comment that stands where none can be kept: nothing is written anew without it.
pub(crate) fn lost_comments(path: &Path, comments: &[FileError]) -> Vec<String> {
    let line = |comment: &FileError| {
        format!(
            "{}:{}:{}: this comment would be lost, put it on a line of its own before an entry: {}",
            path.display(),
            comment.line,
            comment.column,
            short(&comment.message)
        )
    };
    comments.iter().map(line).collect()
}

/// The same, with all that is said of it.
pub(crate) fn read(path: &Path) -> Result<(Loaded, PathBuf), Stop> {
    if is_pack(path) {
        return Err(Stop::refused(format!(
            "{}: is a pack: unpack it first, by coif template install {0} --into FOLDER",
            path.display()
        )));
    }
    let Read { loaded, folder, .. } = read_file(path)?;
    Ok((loaded, folder.unwrap_or_default()))
}

/// The same of a pack, too, which is proven first: paths lead into it as into a folder. `allow_large` also takes one that holds
/// more than grooms do.
pub(crate) fn read_packed(path: &Path, allow_large: bool) -> Result<Read, Stop> {
    if !is_pack(path) {
        return read_file(path);
    }
    let pack = Pack::open(path, allow_large).map_err(Stop::refused)?;
    let (loaded, text) = (pack.graph.clone(), pack.text.clone());
    let shown = pack.shown(&pack.manifest.graph);
    mount(path, pack);
    Ok(Read { loaded, text, folder: Some(path.to_owned()), shown })
}

/// Tells what this version cannot use of a graph.
pub(crate) fn tell_of(shown: impl std::fmt::Display, loaded: &Loaded, warnings: &mut Vec<String>) {
    let told = loaded.conflicts.iter().chain(&loaded.warnings);
    warnings.extend(told.map(|warning| warning.of_file(&shown)));
}

fn read_file(path: &Path) -> Result<Read, Stop> {
    let shown = path.display();
    let (text, folder) = match std::fs::metadata(path) {
        Ok(about) if !about.is_file() => {
            return Err(Stop::refused(format!("{shown}: is not a file")));
        }
        Ok(about) if about.len() > MOST_DOCUMENT => {
            return Err(Stop::refused(format!(
                "{shown}: is larger than 256 MiB, which no graph is"
            )));
        }
        Ok(_) => {
            let text =
                std::fs::read(path).map_err(|err| Stop::refused(format!("{shown}: {err}")))?;
            (text, Some(path.parent().unwrap_or(Path::new("")).to_owned()))
        }
        Err(err) => match grooms::by_name(&path.to_string_lossy()) {
            Some(text) => (text.as_bytes().to_vec(), None),
            None if err.kind() == std::io::ErrorKind::NotFound => {
                let known: Vec<&str> = grooms::ALL.iter().map(|(name, _)| *name).collect();
                return Err(Stop::refused(format!(
                    "{shown}: no such file, and no shipped groom of that name ({})",
                    known.join(", ")
                )));
            }
            None => return Err(Stop::refused(format!("{shown}: {err}"))),
        },
    };
    let mut loaded = file::read_bytes(&text).map_err(|err| Stop::refused(err.of_file(&shown)))?;
    if folder.is_some() && is_shipped(path) {
        let message =
            "this file is taken, and not the shipped groom of its name: rename it to have that one"
                .to_owned();
        loaded.warnings.push(FileError { line: 1, column: 1, message });
    }
    let shown = shown.to_string();
    Ok(Read { loaded, text, folder, shown })
}

/// Whether a path is the name of a shipped groom.
pub(crate) fn is_shipped(path: &Path) -> bool {
    grooms::by_name(&path.to_string_lossy()).is_some()
}

/// Tells `files` what will be written, and refuses one file for two things. What the disk does not allow is told later, where
/// nothing else is wrong.
pub(crate) fn writes_all(
    paths: impl IntoIterator<Item = PathBuf>,
    files: &mut Together,
) -> Result<(), Stop> {
    paths
        .into_iter()
        .try_for_each(|path| files.writes(&path, Role::Output, format!("--out {}", path.display())))
        .map_err(Stop::refused)
}

/// Takes what the reader of the graph's file said of a problem's place (`node.input`, before the first colon) out of its warnings,
/// so that it is told once, and gives where in the file that is.
pub(crate) fn take_said(warnings: &mut Vec<String>, file: &str, problem: &str) -> Option<String> {
    let (place, _) = problem.split_once(": ")?;
    let mut at = None;
    warnings.retain(|warning| {
        let said = warning.strip_prefix(file).and_then(|said| said.split_once(": "));
        match said {
            Some((position, said)) if said.split_once(": ").is_some_and(|(of, _)| of == place) => {
                at.get_or_insert_with(|| format!("{file}{position}"));
                false
            }
            _ => true,
        }
    });
    at
}
