//! Files that documents name: read once, with the files they refer to in turn.
//!
//! Paths are relative to the document's folder. What enters keys is the bytes; the path is kept for messages
//! only. Where an archive is mounted, a path through its file leads to what is in it ([`mount`]): such a path leads nowhere on
//! a disk, so whoever reads by [`read_at_most`] reads from folders and archives alike.

use crate::document::{Document, NodeId, Setting};
use coif_nodes::define::{FileData, Type, Value};
use coif_nodes::formats::picture_in::tiles_fault;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// Larger files are refused: no head is this large, and reading one would take the machine with it.
pub const MOST_BYTES: u64 = 2 << 30;

/// Reads the files that documents name.
pub trait Files: Sync {
    /// The file at a path of the document's; the error is one line without the path.
    fn read(&self, path: &str) -> Result<Arc<FileData>, String>;
}

/// The files of an archive, by names of plain words with slashes between them.
pub trait Archive: Send + Sync {
    /// The file of a name, of at most so many bytes; the error is one line without the name.
    fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, String>;
}

/// Every archive that paths lead into.
static MOUNTED: Mutex<BTreeMap<PathBuf, Arc<dyn Archive>>> = Mutex::new(BTreeMap::new());

fn all_mounted() -> MutexGuard<'static, BTreeMap<PathBuf, Arc<dyn Archive>>> {
    MOUNTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets paths through the file `at` lead into an archive, until the process ends.
pub fn mount(at: &Path, archive: Arc<dyn Archive>) {
    all_mounted().insert(at.to_owned(), archive);
}

/// The archive that a path leads into: where it is, and the name in it, where that leads not out again.
fn within(path: &Path) -> Option<(PathBuf, Option<String>, Arc<dyn Archive>)> {
    let all = all_mounted();
    let (at, archive) = all.iter().find(|(at, _)| path.starts_with(at))?;
    let name = path.strip_prefix(at).ok().and_then(name_below);
    Some((at.clone(), name, archive.clone()))
}

/// A path from a folder as plain words with slashes between them; none where it leads out of that folder, to none of its files,
/// or is no text.
pub fn name_below(path: &Path) -> Option<String> {
    let mut words: Vec<&str> = vec![];
    for part in path.components() {
        match part {
            Component::Normal(word) => words.push(word.to_str()?),
            Component::CurDir => {}
            Component::ParentDir => drop(words.pop()?),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    (!words.is_empty()).then(|| words.join("/"))
}

/// A file for messages: `pack.coif:heads/face.obj` in an archive, else its path.
pub fn shown(path: &Path) -> String {
    match within(path) {
        Some((at, Some(name), _)) => format!("{}:{name}", at.display()),
        _ => path.display().to_string(),
    }
}

/// A whole file of at most so many bytes, on the disk or in an archive.
///
/// # Errors
/// In one line without the path.
pub fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    if let Some((_, name, archive)) = within(path) {
        return archive.read(&name.ok_or("leads out of the pack")?, most);
    }
    let about = std::fs::metadata(path).map_err(|err| said(&err))?;
    if !about.is_file() {
        return Err("is not a file".to_owned());
    }
    if about.len() > most {
        let most = match most >> 30 {
            0 => format!("{} MiB", most >> 20),
            gib => format!("{gib} GiB"),
        };
        return Err(format!("is larger than {most}"));
    }
    std::fs::read(path).map_err(|err| said(&err))
}

/// Every file that a document names: node, input, path as it is written. Ports of groups and parameters name files as nodes do, by
/// what they are set to or by their defaults.
pub fn named(document: &Document) -> Vec<(&NodeId, &str, Arc<str>)> {
    let mut all = vec![];
    for (id, node) in &document.nodes {
        let ports = node.interface.unwrap_or_default().inputs();
        let port = |input: &str| ports.iter().find(|port| port.name == input);
        for (input, setting) in &node.inputs {
            let path = match port(input) {
                Some(port) => text_of(port.ty, setting),
                None => path_of(input, setting),
            };
            all.extend(path.map(|path| (id, input.as_str(), path)));
        }
        for port in ports.iter().filter(|port| !node.inputs.contains_key(&port.name)) {
            let path = port.default.clone().map(Setting::Known);
            let path = path.and_then(|default| text_of(port.ty, &default));
            all.extend(path.map(|path| (id, port.name.as_str(), path)));
        }
    }
    all
}

/// The path that a setting is, where it is a file's.
fn text_of(ty: Type, setting: &Setting) -> Option<Arc<str>> {
    match setting {
        Setting::Known(Value::Text(path)) if ty == Type::File && !path.is_empty() => {
            Some(path.clone())
        }
        _ => None,
    }
}

/// The path that an input is set to, where it is a file's.
pub fn path_of(input: &str, setting: &Setting) -> Option<Arc<str>> {
    let is_file =
        coif_nodes::all().any(|def| def.input(input).is_some_and(|(_, i)| i.ty == Type::File));
    text_of(if is_file { Type::File } else { Type::Text }, setting)
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
        let stamp = stamp(&full).map_err(|why| tiles_fault(path).map_or(why, str::to_owned))?;
        let mut known = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((changed, len, data)) = known.get(&full)
            && (*changed, *len) == stamp
            && data.sides.is_empty()
        {
            return Ok(data.clone());
        }
        let bytes = read_whole(&full)?;
        let extension = extension_of(&full);
        let sides = sides_of(&full, &bytes)
            .filter_map(|(name, side)| Some((name, read_whole(&side).ok()?)))
            .collect();
        let path = within(&full).map_or(path.to_owned(), |_| shown(&full));
        let data = Arc::new(FileData { path, extension, bytes, sides });
        known.insert(full, (stamp.0, stamp.1, data.clone()));
        Ok(data)
    }
}

/// What tells that a file has changed. What is in an archive does not.
fn stamp(path: &Path) -> Result<(SystemTime, u64), String> {
    if within(path).is_some() {
        return Ok((SystemTime::UNIX_EPOCH, 0));
    }
    let about = std::fs::metadata(path).map_err(|err| said(&err))?;
    if !about.is_file() {
        return Err("is not a file".to_owned());
    }
    Ok((about.modified().unwrap_or(SystemTime::UNIX_EPOCH), about.len()))
}

fn read_whole(path: &Path) -> Result<Arc<[u8]>, String> {
    read_at_most(path, MOST_BYTES).map(Arc::from)
}

/// The system's words without its error number.
fn said(err: &std::io::Error) -> String {
    match err.kind() {
        std::io::ErrorKind::NotFound => "no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "may not be read".to_owned(),
        _ => err.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_below_a_folder_leads_nowhere_else() {
        let name = |path: &str| name_below(Path::new(path));
        for (path, expected) in
            [("a.obj", "a.obj"), ("./a/b", "a/b"), ("a/../b", "b"), ("a//b/./c/", "a/b/c")]
        {
            assert_eq!(name(path).as_deref(), Some(expected), "{path}");
        }
        for path in ["", ".", "..", "../a", "a/../..", "a/../../b", "/a", "a/.."] {
            assert_eq!(name(path), None, "{path}");
        }
    }

    #[test]
    fn ports_name_files_as_nodes_do() {
        let text = r#"(format: 3, nodes: {
            "head": (kind: "head", inputs: {"mesh": "a.obj"}),
            "p": (kind: "parameters", inputs: {"scan": "b.obj"}, interface: (inputs: [
                (name: "scan", type: "file"), (name: "mesh", type: "text", default: "no file"),
                (name: "more", type: "file", default: "c.obj"), (name: "none", type: "file"),
            ])),
        })"#;
        let document = crate::file::read(text).unwrap().document;
        let found: Vec<String> = named(&document)
            .iter()
            .map(|(id, input, path)| format!("{id}.{input} {path}"))
            .collect();
        assert_eq!(found, ["head.mesh a.obj", "p.scan b.obj", "p.more c.obj"]);
    }

    #[test]
    fn a_name_for_tiles_of_a_texture_is_no_missing_file() {
        let read = |path: &str| DiskFiles::new("/nowhere").read(path).unwrap_err();
        assert!(read("head.<UDIM>.png").starts_with("names a texture of several tiles (UDIM)"));
        assert_eq!(read("head.1001.png"), "no such file");
    }

    #[test]
    fn paths_lead_into_an_archive_and_not_out_of_it() {
        struct One;
        impl Archive for One {
            fn read(&self, name: &str, _: u64) -> Result<Vec<u8>, String> {
                if name == "heads/a.obj" {
                    Ok(vec![7])
                } else {
                    Err("is not in the pack".to_owned())
                }
            }
        }
        let at = std::env::temp_dir().join("coif-files-no-such.coif");
        mount(&at, Arc::new(One));
        let read = |name: &str| read_at_most(&at.join(name), 9);
        assert_eq!(read("heads/a.obj"), Ok(vec![7]));
        assert_eq!(read("heads/../heads/./a.obj"), Ok(vec![7]));
        assert_eq!(read("../coif-files-no-such.coif"), Err("leads out of the pack".to_owned()));
        let read = DiskFiles::new(&at).read("heads/a.obj").unwrap();
        assert_eq!(read.path, format!("{}:heads/a.obj", at.display()));
        assert!(DiskFiles::new(&at).read("b.obj").is_err());
    }
}
