//! Packs, read. Nothing of a pack is used before all of it was proven.
//!
//! Guaranteed for any bytes: no panic, no file but the pack opened, at most one byte more unpacked of a file than it should have,
//! memory for the manifest, the graph and one file; and of a pack that is opened: its files are exactly those of its manifest, with
//! its sizes and hashes, under names that are safe everywhere ([`names`]); it holds one graph, which is read, and every file that
//! the graph names is in the pack. A pack that is changed afterwards is found out when a file is read again.
//! Not promised: that the graph is free of mistakes, nor that a mesh is one; whoever evaluates finds out.

use super::{
    ALLOW, EXTENSION, FORMAT, Hash, MANIFEST, MOST_FILES, MOST_MANIFEST, MOST_RATIO, Manifest,
    Packed, SMALL_GRAPH, SMALL_TOTAL, names,
};
use crate::files::MOST_DOCUMENT;
use coif_graphs::file::{self, Loaded};
use coif_graphs::schedule::files::{Archive, name_below, named};
use coif_nodes::define::short;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use zip::{CompressionMethod, ZipArchive};

/// A pack that was proven.
pub(crate) struct Pack {
    path: PathBuf,
    pub(crate) manifest: Manifest,
    /// The graph, and its bytes.
    pub(crate) graph: Loaded,
    pub(crate) text: Vec<u8>,
    zip: Mutex<ZipArchive<File>>,
    /// Of each name its number in the zip, and in the manifest.
    at: BTreeMap<String, (usize, usize)>,
}

/// The last 22 bytes of a zip: how many files it has, how long the list of them is, and where that begins.
struct End {
    files: usize,
    list: u64,
    at: u64,
}

impl Pack {
    /// Opens a pack and proves all of it.
    ///
    /// # Errors
    /// What is wrong first, in one line that names the pack, and the file in it where it is of one.
    pub(crate) fn open(path: &Path, allow_large: bool) -> Result<Arc<Self>, String> {
        let of_pack = |why: String| format!("{}: {why}", path.display());
        let mut file = open(path).map_err(of_pack)?;
        let end = End::of(&mut file).map_err(of_pack)?;
        let size = end.at + end.list;
        let mut zip = ZipArchive::new(file)
            .map_err(|err| of_pack(format!("is no whole pack: {err}; have it sent anew")))?;
        if (zip.len(), zip.offset(), zip.central_directory_start()) != (end.files, 0, end.at) {
            return Err(of_pack("names a file twice, or is no plain zip".to_owned()));
        }
        let listed = listed(&mut zip, end.at).map_err(|(name, why)| of_file(path, &name, &why))?;
        zip.validate_header_consistency()
            .map_err(|err| of_pack(format!("says two things of one file: {err}")))?;
        let manifest = manifest(&mut zip, &listed).map_err(|why| of_file(path, MANIFEST, &why))?;
        let at = agree(&manifest, &listed).map_err(|(name, why)| of_file(path, &name, &why))?;
        manifest.allowed(allow_large).map_err(of_pack)?;
        let graph_at = at[&manifest.graph];
        let graph = &listed[graph_at.0];
        if !allow_large {
            bounded(manifest.total(), size, SMALL_TOTAL).map_err(of_pack)?;
            bounded(graph.size, graph.packed, SMALL_GRAPH)
                .map_err(|why| of_file(path, &graph.name, &why))?;
        }
        // The graph first: it is small, and most often wrong.
        let mut text = vec![];
        unpacked(&mut zip, &manifest, graph_at, &mut text)
            .map_err(|why| of_file(path, &manifest.graph, &why))?;
        let name = format!("{}:{}", path.display(), short(&manifest.graph));
        let graph = file::read_bytes(&text).map_err(|err| err.of_file(&name))?;
        for (node, input, value) in named(&graph.document) {
            let found = name_below(Path::new(&*value)).is_some_and(|name| at.contains_key(&name));
            if !found {
                let value = short(&value);
                return Err(format!("{name}: {node}.{input}: {value} is not in the pack"));
            }
        }
        for (packed, place) in &at {
            if *place != graph_at {
                unpacked(&mut zip, &manifest, *place, &mut std::io::sink())
                    .map_err(|why| of_file(path, packed, &why))?;
            }
        }
        let zip = Mutex::new(zip);
        Ok(Arc::new(Self { path: path.to_owned(), manifest, graph, text, zip, at }))
    }

    /// A file of it for messages.
    pub(crate) fn shown(&self, name: &str) -> String {
        format!("{}:{}", self.path.display(), short(name))
    }

    /// Writes a file of it, found to be what the manifest says by then.
    ///
    /// # Errors
    /// There is none of that name, the pack has changed, or it cannot be written. One line without the name.
    pub(crate) fn unpack(&self, name: &str, out: &mut dyn std::io::Write) -> Result<(), String> {
        let at = *self.at.get(name).ok_or("is not in the pack")?;
        let mut zip = self.zip.lock().unwrap_or_else(PoisonError::into_inner);
        unpacked(&mut zip, &self.manifest, at, out)
    }
}

impl Archive for Pack {
    fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        let at = self.at.get(name).ok_or("is not in the pack")?;
        if self.manifest.files[at.1].size > most {
            return Err(format!("is larger than {} MiB", most >> 20));
        }
        let mut bytes = vec![];
        self.unpack(name, &mut bytes)?;
        Ok(bytes)
    }
}

/// A message about a file of a pack.
fn of_file(pack: &Path, name: &str, why: &str) -> String {
    format!("{}:{}: {why}", pack.display(), short(name))
}

/// The file itself, if it may be a zip.
fn open(path: &Path) -> Result<File, String> {
    let about = std::fs::metadata(path).map_err(|err| match err.kind() {
        std::io::ErrorKind::NotFound => "no such file".to_owned(),
        _ => err.to_string(),
    })?;
    if !about.is_file() {
        return Err("is not a file".to_owned());
    }
    if about.len() >= u64::from(u32::MAX) {
        return Err("is larger than 4 GiB, which no pack is".to_owned());
    }
    let mut file = File::open(path).map_err(|err| err.to_string())?;
    let mut first = [0; 4];
    match file.read_exact(&mut first) {
        Ok(()) if first == *b"PK\x03\x04" => Ok(file),
        _ => Err("is no pack: packs are zips that coif template pack writes".to_owned()),
    }
}

impl End {
    fn of(file: &mut File) -> Result<Self, String> {
        const SIZE: u64 = 22;
        let cut = || {
            "is no whole pack: its end lacks, or something stands behind it; have it sent anew"
                .to_owned()
        };
        let mut last = [0; SIZE as usize];
        let len = file.seek(SeekFrom::End(0)).map_err(|err| err.to_string())?;
        file.seek(SeekFrom::Start(len.saturating_sub(SIZE))).map_err(|err| err.to_string())?;
        file.read_exact(&mut last).map_err(|_| cut())?;
        let short = |at: usize| u16::from_le_bytes([last[at], last[at + 1]]);
        let long = |at: usize| u64::from(short(at)) | u64::from(short(at + 2)) << 16;
        let disks = [short(4), short(6)];
        let (here, files, list, at, comment) = (short(8), short(10), long(12), long(16), short(20));
        let is_end = last.starts_with(b"PK\x05\x06") && comment == 0 && disks == [0, 0];
        if !is_end || here != files || at + list + SIZE != len {
            return Err(cut());
        }
        // Told before the list is read: it may name a million.
        if usize::from(files) > MOST_FILES {
            return Err(format!("holds {files} files, and packs hold {MOST_FILES} at most"));
        }
        if list > MOST_LIST {
            return Err("has a list of files that is larger than any pack's".to_owned());
        }
        file.rewind().map_err(|err| err.to_string())?;
        Ok(Self { files: files.into(), list, at })
    }
}

/// The largest list of files: each with the longest name and some room.
const MOST_LIST: u64 = MOST_FILES as u64 * 512;

/// What a zip says of a file.
struct Listed {
    name: String,
    size: u64,
    packed: u64,
}

type Fault = (String, String);

/// What is in a zip, in order: plain files under safe names, that lie one after another and fill the zip up to its list.
fn listed(zip: &mut ZipArchive<File>, end: u64) -> Result<Vec<Listed>, Fault> {
    let mut all = vec![];
    let mut begins = 0;
    for at in 0..zip.len() {
        let entry = zip.by_index_raw(at).map_err(|err| (format!("file {at}"), err.to_string()))?;
        let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
        let wrong = |why: &str| Err((name.clone(), why.to_owned()));
        if std::str::from_utf8(entry.name_raw()).is_err() {
            return wrong("its name is no UTF-8 text");
        }
        if entry.is_dir()
            || entry.unix_mode().is_some_and(|mode| !matches!(mode & 0o170_000, 0 | 0o100_000))
        {
            return wrong("is a link, a folder or a device: packs hold files alone");
        }
        if let Some(why) = names::fault(&name) {
            return wrong(&why);
        }
        if entry.encrypted() {
            return wrong("is encrypted, which files of packs are not");
        }
        if !matches!(entry.compression(), CompressionMethod::Stored | CompressionMethod::Deflated) {
            return wrong("is neither stored nor deflated, as files of packs are");
        }
        let starts = (entry.header_start() == begins).then(|| entry.data_start()).flatten();
        let Some(ends) = starts.and_then(|start| start.checked_add(entry.compressed_size())) else {
            return wrong("does not begin where the file before it ends");
        };
        begins = ends;
        all.push(Listed { size: entry.size(), packed: entry.compressed_size(), name });
    }
    if begins != end {
        return Err((
            MANIFEST.to_owned(),
            "something hides between the files of the pack".to_owned(),
        ));
    }
    match names::clash(all.iter().map(|listed| listed.name.as_str())) {
        Some((name, why)) => Err((name.to_owned(), why)),
        None => Ok(all),
    }
}

/// The manifest, which comes first.
fn manifest(zip: &mut ZipArchive<File>, listed: &[Listed]) -> Result<Manifest, String> {
    #[derive(Deserialize)]
    struct Of {
        format: u32,
    }
    let Some(first) = listed.first().filter(|first| first.name == MANIFEST) else {
        return Err("does not come first: this is no pack, or somebody packed it anew".to_owned());
    };
    if first.size > MOST_MANIFEST {
        return Err(format!("is larger than {} MiB", MOST_MANIFEST >> 20));
    }
    let mut text = vec![];
    let entry = zip.by_index(0).map_err(|err| err.to_string())?;
    entry.take(first.size + 1).read_to_end(&mut text).map_err(|err| err.to_string())?;
    if text.len() as u64 != first.size {
        return Err("has another size than the pack says".to_owned());
    }
    let Of { format } = serde_json::from_slice(&text).map_err(|err| short(&err.to_string()))?;
    if format != FORMAT {
        return Err(format!(
            "is of format {format}, and this version reads {FORMAT}: take a newer coif"
        ));
    }
    serde_json::from_slice(&text).map_err(|err| short(&err.to_string()))
}

/// Where each file of the manifest is: its number in the zip, and in the manifest. Both have the same files.
fn agree(
    manifest: &Manifest,
    listed: &[Listed],
) -> Result<BTreeMap<String, (usize, usize)>, Fault> {
    let wrong = |name: &str, why: &str| Err((name.to_owned(), why.to_owned()));
    let mut at = BTreeMap::new();
    let mut zipped: BTreeMap<&str, (usize, u64)> = listed
        .iter()
        .enumerate()
        .skip(1)
        .map(|(n, Listed { name, size, .. })| (name.as_str(), (n, *size)))
        .collect();
    if !zipped.contains_key(manifest.graph.as_str()) {
        return wrong(&manifest.graph, "is the graph by the manifest, and none of its files");
    }
    for (n, packed) in manifest.files.iter().enumerate() {
        let Some((place, size)) = zipped.remove(packed.path.as_str()) else {
            return wrong(&packed.path, "is named in the manifest once more than it is there");
        };
        if size != packed.size {
            let why = format!("has {size} bytes, and its manifest says {}", packed.size);
            return wrong(&packed.path, &why);
        }
        let ends = |extension: &str| packed.path.to_lowercase().ends_with(extension);
        if ends(".ron") && packed.path != manifest.graph {
            return wrong(&packed.path, "is a second graph, and a pack holds one");
        }
        if ends(&format!(".{EXTENSION}")) || ends(".zip") {
            return wrong(&packed.path, "is a pack in a pack");
        }
        at.insert(packed.path.clone(), (place, n));
    }
    if let Some(extra) = zipped.keys().next() {
        return wrong(extra, "is not named in the manifest");
    }
    match at.get(&manifest.graph) {
        None => wrong(&manifest.graph, "is the graph by the manifest, and not in its list"),
        Some((_, n)) if manifest.files[*n].size > MOST_DOCUMENT => {
            wrong(&manifest.graph, "is larger than 256 MiB, which no graph is")
        }
        Some(_) if manifest.graph.contains('/') => {
            wrong(&manifest.graph, "is the graph, and lies in a folder of the pack")
        }
        Some(_) => Ok(at),
    }
}

/// Refuses what is more than `small` and unpacks to very much.
fn bounded(size: u64, packed: u64, small: u64) -> Result<(), String> {
    match size > small && size / MOST_RATIO > packed {
        true => Err(format!(
            "unpacks to {} MiB, more than {MOST_RATIO} times its size; {ALLOW} takes it all the same",
            size >> 20
        )),
        false => Ok(()),
    }
}

/// Unpacks a file into `out`, and finds it to be what the manifest says.
fn unpacked(
    zip: &mut ZipArchive<File>,
    manifest: &Manifest,
    (place, n): (usize, usize),
    out: &mut dyn std::io::Write,
) -> Result<(), String> {
    let Packed { size, hash, .. } = &manifest.files[n];
    let damaged = |err: std::io::Error| format!("is damaged: {err}");
    let mut entry = zip.by_index(place).map_err(|err| format!("is damaged: {err}"))?;
    let mut piece = vec![0; 1 << 16];
    let (mut found, mut had) = (Hash::new(), 0);
    loop {
        let read = entry.read(&mut piece).map_err(damaged)?;
        if read == 0 {
            break;
        }
        had += read as u64;
        if had > *size {
            return Err(format!("is larger than the {size} bytes that its manifest says"));
        }
        found.add(&piece[..read]);
        out.write_all(&piece[..read]).map_err(|err| err.to_string())?;
    }
    if had < *size {
        return Err(format!("has {had} bytes, and its manifest says {size}"));
    }
    match found.text() == *hash {
        true => Ok(()),
        false => {
            Err(format!("has the hash {}, and its manifest says {}", found.text(), short(hash)))
        }
    }
}

#[cfg(test)]
mod tests;
