//! Making a template from a groom, for the command line and the window: which nodes form its group, which inputs it exposes, its
//! description, and its file in the library.
//!
//! Guarantees: the groom does not change. A file of the library that holds anything else is reported before it is overwritten.

use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Origin, Socket, groups};
use coif_graphs::template;
use coif_nodes::define::short;
#[cfg(feature = "editor")]
use std::collections::BTreeSet;
use std::path::Path;

/// What a template is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum MadeOf {
    /// All nodes but heads, outputs and what waits to be drawn into.
    All,
    /// A group.
    Group(NodeId),
    /// These nodes, which become a group.
    #[cfg(feature = "editor")]
    Nodes(BTreeSet<NodeId>),
}

/// A template that is to be made.
#[derive(Clone, Debug)]
pub(crate) struct NewTemplate {
    /// Of what.
    pub(crate) of: MadeOf,
    /// Inputs of nodes in the group that the template exposes, as node.input.
    pub(crate) exposed: Vec<String>,
    /// What people call it; else the group's label.
    pub(crate) title: Option<String>,
    /// What is said of it; else the group's note.
    pub(crate) description: Option<String>,
    /// Its mark; without a name, the group's.
    pub(crate) origin: Origin,
}

impl NewTemplate {
    /// The group that it is made of, in a groom that has it, before anything else is done.
    ///
    /// # Errors
    /// Why no group can be made of these nodes.
    pub(crate) fn grouped(&self, document: &Document) -> Result<(Document, NodeId), String> {
        let name = &self.origin.name;
        let name = if name.trim().is_empty() { "template" } else { name };
        match &self.of {
            MadeOf::All => template::grouped(document, name),
            MadeOf::Group(group) => Ok((document.clone(), group.clone())),
            #[cfg(feature = "editor")]
            MadeOf::Nodes(nodes) => groups::make(document, nodes, name),
        }
    }

    /// The template of a groom.
    ///
    /// # Errors
    /// Why it cannot be made.
    pub(crate) fn of(&self, document: &Document) -> Result<Document, String> {
        let (mut made, group) = self.grouped(document)?;
        for input in &self.exposed {
            let inner: Socket =
                format!("{group}/{input}").parse().map_err(|err| format!("{err}"))?;
            let (edit, _) = groups::expose(&made, &inner)?;
            edit.apply(&mut made).map_err(|err| err.to_string())?;
        }
        let label = self
            .title
            .clone()
            .map(|title| Edit::SetLabel { id: group.clone(), label: Some(title) });
        let note =
            self.description.clone().map(|note| Edit::SetNodeNote { id: group.clone(), note });
        for edit in label.into_iter().chain(note) {
            edit.apply(&mut made).map_err(|err| err.to_string())?;
        }
        let mut origin = self.origin.clone();
        if origin.name.is_empty() {
            group.word().clone_into(&mut origin.name);
        }
        template::new(&made, &group, origin)
    }
}

/// Why a name or a version of a template cannot be, beginning with it.
pub(crate) fn bad_word(word: &str) -> Option<String> {
    let is_good = !word.trim().is_empty()
        && word.chars().all(is_plain)
        && !word.starts_with('.')
        && word.len() <= 100;
    (!is_good).then(|| {
        format!(
            "{:?}: letters, digits, blanks and - _ . are allowed, 1 to 100 bytes, and none begins with a dot",
            short(word)
        )
    })
}

fn is_plain(c: char) -> bool {
    c.is_alphanumeric() || "-_. ".contains(c)
}

/// The file of a template in a folder of the library.
///
/// # Errors
/// Its name and version are no name for a file.
pub(crate) fn file_name(name: &str, version: &str) -> Result<String, String> {
    let words = [name, version].join("-");
    if !words.chars().all(is_plain) || words.starts_with('.') || words.len() > 128 {
        return Err(format!("{:?} is no name for a file", short(&words)));
    }
    Ok(format!("{words}.ron"))
}

/// Why the template of this hash must not be written to a file: it holds something else. `None` if there is no file, or it holds this
/// template.
pub(crate) fn is_another(target: &Path, hash: &str) -> Option<String> {
    if target.symlink_metadata().is_err() {
        return None;
    }
    let shown = target.display();
    match super::read(target) {
        Ok(there) if there.hash == hash => None,
        Ok(_) => Some(format!("{shown} has this name and version and another hash")),
        Err(_) => Some(format!("{shown} exists and holds no template that can be read")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_file_that_holds_this_very_template_may_be_overwritten() {
        let folder = std::env::temp_dir().join(format!("coif-is-another-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("row-1.0.ron");
        assert_eq!(is_another(&file, "any"), None, "there is no file");
        let (name, text) = coif_graphs::grooms::TEMPLATES[0];
        std::fs::write(&file, text).unwrap();
        let hash = crate::library::read(&file).expect(name).hash;
        assert_eq!(is_another(&file, &hash), None);
        let why = |file: &Path, hash: &str| is_another(file, hash).expect("is refused");
        assert!(why(&file, "another").contains("another hash"));
        let junk: [&[u8]; 4] =
            [b"", &text.as_bytes()[..text.len() / 2], b"(nodes: {", &[0xff; 4096]];
        for bytes in junk {
            std::fs::write(&file, bytes).unwrap();
            assert!(why(&file, &hash).contains("holds no template"), "{} bytes", bytes.len());
        }
        assert!(why(&folder, &hash).contains("holds no template"), "a folder");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
