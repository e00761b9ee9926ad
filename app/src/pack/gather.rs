//! What goes into a pack: a graph, the files that it names, those that these name, and what says under which licence they are given.
//!
//! Files are found as evaluation and pictures find them: [`named`], [`side_files`] and [`read_looks`]. Guaranteed: a file that a
//! graph cannot do without is in the pack or an error; a path of the graph is as it was, unless it leads outside its folder and
//! somebody asked to collect what does; what was left out is told. Not followed: what else a mesh file mentions (a folder above it,
//! an address of the network), and text that this version does not know.

use super::{Packed, SEE, Template, names};
use crate::files::extension_of;
use coif_graphs::document::{Document, Setting};
use coif_graphs::file::{self, Loaded};
use coif_graphs::schedule::files::{MOST_BYTES, name_below, named, read_at_most};
use coif_graphs::template;
use coif_nodes::define::{Value, short};
use coif_nodes::formats::mesh_in::EXTENSIONS;
use coif_nodes::formats::picture_in::tiles_fault;
use coif_nodes::formats::{read_looks, side_files};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file for a pack.
pub(crate) struct PackFile {
    /// Its name in the pack.
    pub(crate) name: String,
    pub(crate) from: Source,
    pub(crate) size: u64,
    pub(crate) hash: String,
    licence: String,
    author: String,
}

/// Where a file's bytes are.
pub(crate) enum Source {
    Bytes(Vec<u8>),
    File(PathBuf),
}

/// A graph that is to be packed.
pub(crate) struct Graph {
    /// Its name in the pack.
    pub(crate) name: String,
    pub(crate) text: Vec<u8>,
    pub(crate) loaded: Loaded,
    /// What its paths are relative to; none where it is no file.
    pub(crate) folder: Option<PathBuf>,
}

/// What goes into a pack, in order.
pub(crate) struct Gathered {
    pub(crate) items: Vec<PackFile>,
    pub(crate) document: Document,
    /// What was changed or left out, a line each.
    pub(crate) notes: Vec<String>,
}

/// The largest file that is taken for one that says a licence, and the most of them beside a file.
const MOST_LICENCE: u64 = 1 << 20;
const MOST_LICENCES: usize = 8;
/// What ends in one of these says no licence, whatever it is called.
const ASSETS: &[&str] = &[
    "obj", "mtl", "gltf", "glb", "vrm", "bin", "png", "jpg", "jpeg", "tif", "tiff", "exr", "hdr",
    "ron", "coif",
];
/// The folder of a pack that holds what lay outside the graph's.
const OUTSIDE: &str = "outside";

/// Gathers what a graph needs. `collect` also takes what lies outside its folder.
///
/// # Errors
/// Everything that cannot be packed, a line each.
pub(crate) fn gather(graph: Graph, collect: bool) -> Result<Gathered, Vec<String>> {
    let Graph { name, mut text, loaded, folder } = graph;
    let Loaded { mut document, dropped_comments, .. } = loaded;
    let is_file = folder.is_some();
    let folder = folder.unwrap_or_default();
    let mut bag = Bag { folder: settled(&folder), collect, ..Bag::default() };
    let mut moved = BTreeMap::new();
    let mut wrong = vec![];
    for (node, input, path) in named(&document) {
        match bag.take(&folder, &path) {
            Ok(packed) if *packed != *path => {
                bag.told.insert(format!("{node}.{input}: {path} becomes {packed}"));
                moved.insert((node.clone(), input.to_owned()), packed);
            }
            Ok(_) => {}
            Err(why) => wrong.push(format!("{name}: {node}.{input}: {}: {why}", short(&path))),
        }
    }
    if !wrong.is_empty() {
        return Err(wrong);
    }
    if !moved.is_empty() {
        if let Some(comment) = dropped_comments.first() {
            return Err(vec![format!(
                "{name}:{}:{}: a comment would be lost when paths are written anew: put it on a line of its own before an entry",
                comment.line, comment.column
            )]);
        }
        rewrite(&mut document, &moved).map_err(|why| vec![format!("{name}: {why}")])?;
        text = file::write(&document).into_bytes();
    }
    let origin = template::group_of(&document)
        .ok()
        .and_then(|id| document.node(id.as_str())?.template.clone());
    let beside = if is_file { bag.licences(&folder, &name) } else { String::new() };
    let (terms, author) = match origin {
        Some(origin) if !origin.licence.is_empty() => {
            (origin.licence.clone(), origin.author.clone())
        }
        Some(origin) => (beside, origin.author.clone()),
        None => (beside, String::new()),
    };
    let first = Found { from: Source::Bytes(text), licence: terms, author };
    let rest = std::mem::take(&mut bag.found);
    let told = std::mem::take(&mut bag.told);
    let items = items(std::iter::once((name, first)).chain(rest))?;
    Ok(Gathered { items, document, notes: told.into_iter().collect() })
}

/// The templates that a graph has instances of.
pub(crate) fn templates(document: &Document) -> Vec<Template> {
    let of = |(id, origin): (&_, &coif_graphs::document::Origin)| Template {
        node: ToString::to_string(id),
        name: origin.name.clone(),
        version: origin.version.clone(),
        licence: origin.licence.clone(),
        author: origin.author.clone(),
    };
    template::instances(document).map(of).collect()
}

impl PackFile {
    /// What a manifest says of it.
    pub(crate) fn packed(&self) -> Packed {
        let Self { name, size, hash, licence, author, .. } = self;
        let (path, hash) = (name.clone(), hash.clone());
        Packed { path, size: *size, hash, licence: licence.clone(), author: author.clone() }
    }
}

/// Files as items: under names that are safe everywhere, with their sizes and hashes.
fn items(found: impl Iterator<Item = (String, Found)>) -> Result<Vec<PackFile>, Vec<String>> {
    let (mut items, mut wrong) = (vec![], vec![]);
    for (name, Found { from, licence, author }) in found {
        if let Some(why) = names::fault(&name).or_else(|| kept(&name)) {
            wrong.push(format!("{}: {why}: rename it", short(&name)));
            continue;
        }
        match from.each_piece(|_| Ok(())) {
            Ok((hash, size)) => items.push(PackFile { name, from, size, hash, licence, author }),
            Err(why) => wrong.push(format!("{}: {why}", short(&name))),
        }
    }
    if let Some((name, why)) = names::clash(items.iter().map(|item| item.name.as_str())) {
        wrong.push(format!("{}: {why}: rename it", short(name)));
    }
    if items.len() >= super::MOST_FILES {
        wrong.push(format!(
            "{} files, and packs hold {} at most",
            items.len(),
            super::MOST_FILES - 1
        ));
    }
    if wrong.is_empty() { Ok(items) } else { Err(wrong) }
}

/// What is wrong with a name that packs keep for themselves.
fn kept(name: &str) -> Option<String> {
    (name.to_lowercase() == super::MANIFEST).then(|| "is the name of a pack's manifest".to_owned())
}

/// Sets inputs to other paths.
fn rewrite(
    document: &mut Document,
    moved: &BTreeMap<(coif_graphs::document::NodeId, String), String>,
) -> Result<(), String> {
    for ((id, input), path) in moved {
        let node = document.nodes.get_mut(id).map(Arc::make_mut);
        let node = node.ok_or_else(|| format!("{id} is gone"))?;
        let setting = Setting::Known(Value::Text(path.as_str().into()));
        node.inputs.insert(input.clone(), setting);
    }
    Ok(())
}

/// A file that was found.
struct Found {
    from: Source,
    licence: String,
    author: String,
}

/// What was found so far.
#[derive(Default)]
struct Bag {
    /// The graph's folder as the system sees it.
    folder: PathBuf,
    collect: bool,
    found: BTreeMap<String, Found>,
    /// Folders outside, and what they are called in the pack.
    outside: BTreeMap<PathBuf, String>,
    told: BTreeSet<String>,
    /// What speaks for folders that were looked at.
    licences: BTreeMap<PathBuf, Vec<(String, PathBuf)>>,
}

impl Bag {
    /// Takes a file that the graph names, and what it names in turn. Gives its name in the pack.
    fn take(&mut self, folder: &Path, path: &str) -> Result<String, String> {
        let full = folder.join(path);
        let real = full
            .canonicalize()
            .map_err(|err| tiles_fault(path).map_or_else(|| said(&err), str::to_owned))?;
        let about = real.metadata().map_err(|err| said(&err))?;
        if !about.is_file() {
            return Err("is not a file".to_owned());
        }
        if about.len() > MOST_BYTES {
            return Err(format!("is larger than {} GiB", MOST_BYTES >> 30));
        }
        let name = match self.inside(folder, path, &real) {
            // What the graph says leads to the same place in the pack.
            Ok(name) if Path::new(path).is_relative() => {
                self.file(&full, &real, &name)?;
                return Ok(path.to_owned());
            }
            Ok(name) => name,
            Err(why) if !self.collect => {
                return Err(format!("{why}: copy it beside the graph, or use --collect"));
            }
            Err(_) => self.outside(&real)?,
        };
        self.file(&full, &real, &name)?;
        Ok(name)
    }

    /// The name of a file in the pack, where its path leads from the graph's folder to a file in it.
    fn inside(&self, folder: &Path, path: &str, real: &Path) -> Result<String, String> {
        if Path::new(path).is_absolute() {
            let name = real.strip_prefix(&self.folder).ok().and_then(name_below);
            return name.filter(|_| self.collect).ok_or("is absolute".to_owned());
        }
        let name = name_below(Path::new(path)).ok_or("leads outside the graph's folder")?;
        let is_it = folder.join(&name).canonicalize().is_ok_and(|other| other == *real);
        match is_it && real.starts_with(&self.folder) {
            true => Ok(name),
            false => Err(format!("leads through a link to {}", real.display())),
        }
    }

    /// The name in the pack of a file from elsewhere; those of one folder stay together.
    fn outside(&mut self, real: &Path) -> Result<String, String> {
        let (folder, file) = (real.parent().unwrap_or(Path::new("/")), real.file_name());
        let file = file.and_then(|file| file.to_str()).ok_or("its name is no text")?;
        let called = match self.outside.get(folder) {
            Some(called) => called.clone(),
            None => {
                let is_used = |called: &String| self.outside.values().any(|other| other == called);
                let is_free =
                    |called: &String| !is_used(called) && !self.folder.join(called).exists();
                let numbered = (2..).map(|n| format!("{OUTSIDE}/{n}"));
                let called = std::iter::once(OUTSIDE.to_owned()).chain(numbered).find(is_free);
                let called = called.unwrap_or_default();
                self.outside.insert(folder.to_owned(), called.clone());
                called
            }
        };
        Ok(format!("{called}/{file}"))
    }

    /// Adds a file, what says its licence, and the files beside it that it names.
    fn file(&mut self, full: &Path, real: &Path, name: &str) -> Result<(), String> {
        if self.found.contains_key(name) {
            return Ok(());
        }
        let beside = full.parent().unwrap_or(Path::new(""));
        let licence = self.licences(beside, name);
        self.add(name, real, &licence);
        if !EXTENSIONS.contains(&extension_of(full).as_str()) {
            return Ok(());
        }
        let bytes = read_at_most(full, MOST_BYTES)?;
        let extension = extension_of(full);
        let asked = RefCell::new(BTreeSet::new());
        let side = |name: &str| {
            asked.borrow_mut().insert(name.to_owned());
            let plain = name_below(Path::new(name)).is_some_and(|plain| plain == name);
            plain
                .then(|| read_at_most(&beside.join(name), MOST_BYTES).ok())
                .flatten()
                .map(Arc::from)
        };
        // A mesh that is none is told by whoever evaluates.
        let _ = read_looks(&extension, &bytes, &side);
        let needed = side_files(&extension, &bytes);
        let mut asked = asked.into_inner();
        asked.extend(needed.iter().cloned());
        for asked_name in asked {
            let is_needed = needed.contains(&asked_name);
            match self.side(beside, name, &asked_name, &licence) {
                Ok(()) => {}
                Err(why) if is_needed => {
                    return Err(format!("names {}: {why}", short(&asked_name)));
                }
                Err(why) => {
                    self.told
                        .insert(format!("{name} names {}, left out: {why}", short(&asked_name)));
                }
            }
        }
        Ok(())
    }

    /// Adds a file beside a mesh `of` that names it. Where nothing beside it says a licence it has the mesh's.
    fn side(&mut self, beside: &Path, of: &str, side: &str, licence: &str) -> Result<(), String> {
        if name_below(Path::new(side)).is_none_or(|plain| plain != side) {
            return Err("no file beside or below it is read by that name".to_owned());
        }
        let full = beside.join(side);
        let real = full.canonicalize().map_err(|err| said(&err))?;
        if !real.is_file() {
            return Err("is not a file".to_owned());
        }
        if !real.starts_with(settled(beside)) && !self.collect {
            let to = real.display();
            return Err(format!(
                "leads through a link to {to}: copy it beside the mesh, or use --collect"
            ));
        }
        let name = match of.rsplit_once('/') {
            Some((folder, _)) => format!("{folder}/{side}"),
            None => side.to_owned(),
        };
        let own = self.licences(full.parent().unwrap_or(beside), &name);
        self.add(&name, &real, if own.is_empty() { licence } else { &own });
        Ok(())
    }

    fn add(&mut self, name: &str, real: &Path, licence: &str) {
        let new = || Found {
            from: Source::File(real.to_owned()),
            licence: licence.to_owned(),
            author: String::new(),
        };
        self.found.entry(name.to_owned()).or_insert_with(new);
    }

    /// Adds what says the licence of the file that lies in `folder` and is called `name` in the pack: what is called as it is, else
    /// what speaks for the folder. Gives words that name it; empty where there is none.
    fn licences(&mut self, folder: &Path, name: &str) -> String {
        let (within, file) =
            name.rsplit_once('/').map_or((String::new(), name), |(f, n)| (format!("{f}/"), n));
        let found = match of_folder(folder, &format!("{file}.license")) {
            Some(own) => vec![own],
            None => {
                let known = self.licences.entry(folder.to_owned());
                known.or_insert_with(|| licences_of(folder)).clone()
            }
        };
        let mut named = vec![];
        for (licence, real) in found {
            let licence = format!("{within}{licence}");
            self.add(&licence, &real, "");
            named.push(licence);
        }
        if named.is_empty() { String::new() } else { format!("{SEE}{}", named.join(", ")) }
    }
}

/// The files of a folder that say a licence for all of it.
fn licences_of(folder: &Path) -> Vec<(String, PathBuf)> {
    let all = std::fs::read_dir(or_here(folder)).into_iter().flatten().flatten();
    let mut all: Vec<String> =
        all.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    all.sort();
    let is_text = |name: &str| {
        let extension = extension_of(Path::new(name));
        !ASSETS.contains(&extension.as_str()) && extension != "license"
    };
    let called = |words: &[&str]| -> Vec<(String, PathBuf)> {
        let fits = |name: &&String| {
            let lower = name.to_lowercase();
            words.iter().any(|word| lower.contains(word)) && is_text(&lower)
        };
        let found = all.iter().filter(fits).filter_map(|name| of_folder(folder, name));
        found.take(MOST_LICENCES).collect()
    };
    match called(&["license", "licence", "copying"]) {
        none if none.is_empty() => called(&["readme"]),
        some => some,
    }
}

/// A small file of a folder under a name that packs may have; none where there is no such, or a link that leads elsewhere.
fn of_folder(folder: &Path, name: &str) -> Option<(String, PathBuf)> {
    let real = folder.join(name).canonicalize().ok()?;
    let about = real.metadata().ok()?;
    let fits = about.is_file() && about.len() <= MOST_LICENCE && real.starts_with(settled(folder));
    (fits && names::fault(name).is_none()).then(|| (name.to_owned(), real))
}

fn or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// A folder as the system sees it.
fn settled(folder: &Path) -> PathBuf {
    or_here(folder).canonicalize().unwrap_or_else(|_| folder.to_owned())
}

fn said(err: &std::io::Error) -> String {
    match err.kind() {
        std::io::ErrorKind::NotFound => "no such file".to_owned(),
        _ => err.to_string(),
    }
}
