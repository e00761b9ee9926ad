//! Hair to files: which formats there are, and writing what was evaluated.
//!
//! Guarantees: a file's ending alone says how it is written, and an ending that none of the formats has is refused before anything
//! runs; files are put in place by [`Together`], all or none.

use super::stop::Stop;
use crate::files::{Together, extension_of};
use coif_graphs::document::Document;
use coif_graphs::file::document_hash;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::formats::export::{self, About, Format, HairGroup};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The format of each output file.
pub(crate) fn formats(out: &[PathBuf]) -> Result<Vec<Format>, Stop> {
    out.iter()
        .map(|path| {
            Format::of_extension(&extension_of(path)).ok_or_else(|| {
                Stop::refused(format!(
                    "{}: grooms are written as {}",
                    path.display(),
                    Format::EXTENSIONS
                ))
            })
        })
        .collect()
}

/// What Alembic files leave out, a line each.
pub(crate) fn left_out_of_abc(groups: &[HairGroup]) -> impl Iterator<Item = String> {
    let left_out = groups.iter().filter(|group| export::is_left_out_of_abc(group, groups));
    left_out.map(|group| {
        format!(
            "{}: lines of partings are left out of .abc, whose readers would take them for guides; USD files hold them",
            group.name
        )
    })
}

/// Writes what outputs gave, with the names of sections by id, and with the `heads` where a format holds meshes, to files that `files` puts in place. `begins` is told
/// each file's number and path.
pub(crate) fn write_files(
    document: &Document,
    (groups, sections): (&[HairGroup], &BTreeMap<u64, String>),
    heads: &[Arc<Scalp>],
    wanted: &[(&Path, Format)],
    cancel: &CancelToken,
    files: &mut Together,
    begins: &dyn Fn(usize, &Path),
) -> Result<(), Stop> {
    let title = if document.title.is_empty() { "Groom" } else { &document.title };
    let about = About {
        title: title.to_owned(),
        generator: format!("coif {}", env!("CARGO_PKG_VERSION")),
        graph_hash: document_hash(document),
        seed: document.seed,
        sections: sections.clone(),
    };
    for (i, (path, format)) in wanted.iter().enumerate() {
        begins(i, path);
        let written = files.write(path, cancel, |out| {
            export::write(*format, groups, heads, &about, out, &|| cancel.is_cancelled())
                .map_err(|err| err.to_string())
        });
        written.map_err(|reason| Stop::unwritten(path, &reason, cancel))?;
    }
    Ok(())
}
