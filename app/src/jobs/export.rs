//! Hair to files: which formats there are, and writing what was evaluated.
//!
//! Guarantees: a file's ending alone says how it is written, and an ending that none of the formats has is refused before anything
//! runs; files are put in place by [`Together`], all or none.

use super::evaluate::Evaluated;
use super::progress::Tell;
use super::stop::Stop;
use crate::files::{Together, extension_of};
use coif_graphs::document::Document;
use coif_graphs::file::document_hash;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::formats::export::{self, About, Format, HairGroup};
use std::path::PathBuf;

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

/// The files that hair is written to.
pub(crate) struct HairFiles {
    files: Vec<(PathBuf, Format)>,
    /// Whether the heads' meshes are written beside the hair.
    with_head: bool,
}

impl HairFiles {
    /// Refuses files of no known format, and heads where no format holds any.
    pub(crate) fn new(out: &[PathBuf], with_head: bool) -> Result<Self, Stop> {
        let formats = formats(out)?;
        if with_head && formats.iter().all(|format| *format == Format::Hair) {
            return Err(Stop::refused(
                "--with-head: .usda, .usdc and .abc hold the head beside the hair; add one by --out, or leave the option out",
            ));
        }
        Ok(Self { files: out.iter().cloned().zip(formats).collect(), with_head })
    }

    /// What the files leave out, a line each.
    pub(crate) fn left_out(&self, groups: &[HairGroup]) -> Vec<String> {
        if self.files.iter().all(|(_, format)| *format != Format::Abc) {
            return vec![];
        }
        let left_out = groups.iter().filter(|group| export::is_left_out_of_abc(group, groups));
        let line = |group: &HairGroup| {
            format!(
                "{}: lines of partings are left out of .abc, whose readers would take them for guides; USD files hold them",
                group.name
            )
        };
        left_out.map(line).collect()
    }

    /// Writes what the outputs of a document gave to files that `files` puts in place.
    pub(crate) fn write(
        &self,
        document: &Document,
        evaluated: &Evaluated,
        cancel: &CancelToken,
        tell: &dyn Tell,
        files: &mut Together,
    ) -> Result<(), Stop> {
        let title = if document.title.is_empty() { "Groom" } else { &document.title };
        let about = About {
            title: title.to_owned(),
            generator: format!("coif {}", env!("CARGO_PKG_VERSION")),
            graph_hash: document_hash(document),
            seed: document.seed,
            sections: evaluated.sections.clone(),
        };
        let heads = if self.with_head { &evaluated.scalps[..] } else { &[] };
        for (i, (path, format)) in self.files.iter().enumerate() {
            tell.count(i, self.files.len());
            tell.say(format!("writing {}", path.display()));
            let written = files.write(path, cancel, |out| {
                let stops = || cancel.is_cancelled();
                export::write(*format, &evaluated.groups, heads, &about, out, &stops)
                    .map_err(|err| err.to_string())
            });
            written.map_err(|reason| Stop::unwritten(path, &reason, cancel))?;
        }
        Ok(())
    }
}
