//! Packs: a graph and every file that it uses, in one zip with a manifest (`docs/packs.md`).
//!
//! What a pack holds is told by its manifest alone, and proven before anything of it is used ([`read`]); what goes into one is
//! found by the readers of meshes themselves ([`gather`]). The same input gives the same bytes ([`write`]).

pub(crate) mod gather;
mod names;
pub(crate) mod read;
pub(crate) mod write;

use crate::words::grouped;
use coif_graphs::document::Document;
use coif_graphs::schedule::files::mount;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What files of packs end in.
pub(crate) const EXTENSION: &str = "coif";
/// The manifest's name in a pack; it comes first.
pub(crate) const MANIFEST: &str = "coif-pack.json";
/// The format that this version writes and reads.
const FORMAT: u32 = 1;
/// The most files of a pack, its manifest counted.
const MOST_FILES: usize = 4096;
/// The largest manifest, bytes.
const MOST_MANIFEST: u64 = 4 << 20;
/// The most that files of a pack have together, bytes, where nobody allows more.
const MOST_TOTAL: u64 = 4 << 30;
/// What unpacks to more than this, and to [`MOST_RATIO`] times the pack, is no groom; and the same of the graph, which takes longer.
const SMALL_TOTAL: u64 = 64 << 20;
const SMALL_GRAPH: u64 = 1 << 20;
const MOST_RATIO: u64 = 100;
/// How a licence begins that names files of the pack.
const SEE: &str = "see ";
/// The option that lifts both.
const ALLOW: &str = "--allow-large";

/// What a pack says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    /// [`FORMAT`].
    pub(crate) format: u32,
    /// Who wrote it, with its version.
    pub(crate) program: String,
    /// The graph's name among the files.
    pub(crate) graph: String,
    /// All files but the manifest, in their order: the graph, then by name.
    pub(crate) files: Vec<Packed>,
    /// The templates that the graph has instances of. All of them is in the graph.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) templates: Vec<Template>,
    /// What the graph's outputs were when it was packed, where somebody asked for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) outputs: Vec<PackedOutput>,
}

/// One file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Packed {
    /// Its name: words with slashes between them, from the pack's root.
    pub(crate) path: String,
    /// Bytes.
    pub(crate) size: u64,
    /// BLAKE3 of its bytes, cut to 128 bits, as 32 hexadecimal digits.
    pub(crate) hash: String,
    /// Under which licence it is given, or which files of the pack say it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) licence: String,
    /// Who made it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) author: String,
}

/// A template that the graph has an instance of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Template {
    pub(crate) node: String,
    pub(crate) name: String,
    pub(crate) version: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) licence: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) author: String,
}

/// What an output was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PackedOutput {
    /// `node.socket`.
    pub(crate) output: String,
    /// The content hash of its curves.
    pub(crate) hash: String,
}

impl Manifest {
    /// What is said of files, the graph first.
    pub(crate) fn of(items: &[gather::PackFile], document: &Document) -> Self {
        Self {
            format: FORMAT,
            program: format!("coif {}", env!("CARGO_PKG_VERSION")),
            graph: items.first().map(|item| item.name.clone()).unwrap_or_default(),
            files: items.iter().map(gather::PackFile::packed).collect(),
            templates: gather::templates(document),
            outputs: vec![],
        }
    }

    /// What all files have together, bytes.
    fn total(&self) -> u64 {
        self.files.iter().fold(0, |sum, file| sum.saturating_add(file.size))
    }

    /// Refuses what is more than a groom, where nobody allows it.
    ///
    /// # Errors
    /// In one line, with the option that allows it.
    pub(crate) fn allowed(&self, allow_large: bool) -> Result<(), String> {
        let (mib, most) = (self.total() >> 20, MOST_TOTAL >> 20);
        match self.total() > MOST_TOTAL && !allow_large {
            true => Err(format!(
                "holds {mib} MiB, and {most} are the most; {ALLOW} takes it all the same"
            )),
            false => Ok(()),
        }
    }

    /// What it holds, a line each, for a person.
    pub(crate) fn lines(&self) -> Vec<String> {
        // On one line, whatever a manifest says.
        let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let licence = |licence: &str, author: &str| match (&*line(licence), &*line(author)) {
            ("", "") => "licence not stated".to_owned(),
            ("", author) => format!("by {author}, licence not stated"),
            (licence, "") => format!("licence: {licence}"),
            (licence, author) => format!("licence: {licence}, by {author}"),
        };
        let says_one = |path: &str| {
            let named = |licence: &str| {
                licence
                    .strip_prefix(SEE)
                    .is_some_and(|named| named.split(", ").any(|it| it == path))
            };
            self.files.iter().any(|file| named(&file.licence))
        };
        let mut lines: Vec<String> = self
            .files
            .iter()
            .map(|Packed { path, size, licence: terms, author, .. }| {
                let terms = match terms.is_empty() && says_one(path) {
                    true => "says a licence".to_owned(),
                    false => licence(terms, author),
                };
                format!("{path}  {} bytes  {terms}", grouped(*size as usize))
            })
            .collect();
        lines.extend(self.templates.iter().map(|template| {
            let Template { node, name, version, licence: terms, author } = template;
            format!(
                "{node} in {}: template {name} {version}  {}",
                self.graph,
                licence(terms, author)
            )
        }));
        lines.extend(
            self.outputs
                .iter()
                .map(|PackedOutput { output, hash }| format!("{output}: hash {hash}")),
        );
        let many = if self.files.len() == 1 {
            "1 file".to_owned()
        } else {
            format!("{} files", self.files.len())
        };
        lines.push(format!("{many}, {} bytes", grouped(self.total() as usize)));
        lines
    }
}

/// Whether a path is a pack's, by its extension.
pub(crate) fn is_pack(path: &Path) -> bool {
    crate::files::extension_of(path) == EXTENSION
}

/// The path to a file that is named as messages name those in packs, `pack.coif:heads/face.obj`: into that pack, which is proven
/// first. Any other path is as it was.
///
/// # Errors
/// The pack is refused, in one line that names it.
pub(crate) fn led_into(path: PathBuf) -> Result<PathBuf, String> {
    let text = path.to_string_lossy().into_owned();
    let mark = format!(".{EXTENSION}:");
    let Some(at) = text.find(&mark).filter(|_| !path.exists()) else { return Ok(path) };
    let (pack, name) = text.split_at(at + mark.len() - 1);
    let pack = Path::new(pack);
    mount(pack, read::Pack::open(pack, false)?);
    Ok(pack.join(&name[1..]))
}

/// The hash of a file's bytes: [`Packed::hash`].
struct Hash(blake3::Hasher);

impl Hash {
    fn new() -> Self {
        Self(blake3::Hasher::new())
    }
    fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }
    fn text(&self) -> String {
        self.0.finalize().to_hex()[..32].to_owned()
    }
}
