//! What files of older formats mean today.
//!
//! All formats are read by the same structs (`file/read.rs`); a step then changes the document from what one format meant to what the
//! next does. It is a file of this folder, an entry of [`STEPS`], and a sample of the old format in `samples/` that a test reads. Old
//! *values* need no step: inputs have old names and nodes have versions.
//!
//! Guarantees: the same file gives the same document, ids of new nodes included, so that branches of one groom still merge; comments
//! go with the values that they stand before; what cannot be carried over is said with its place; a group that was as its template
//! made it still is.

use crate::document::{Document, FileEntry, NodeId, Socket, groups};
use crate::file::document_hash;
use coif_nodes::define::Type;
use std::sync::Arc;

#[cfg(test)]
mod tests;
mod v2_to_v3;

/// From one format to the next.
struct Step {
    /// The last format that needs it.
    from: u32,
    /// The type of an input that a kind of node no longer has, and that the step reads.
    former_type: fn(kind: &str, input: &str) -> Option<Type>,
    run: fn(&mut FormatUpgrade),
}

/// In the order of their formats.
const STEPS: &[Step] =
    &[Step { from: 2, former_type: v2_to_v3::former_type, run: v2_to_v3::split_makers }];

/// A document on its way to the newest format.
pub(super) struct FormatUpgrade<'a> {
    document: &'a mut Document,
    /// What steps did.
    pub(super) done: Done,
}

/// What steps did to a document, for its reader.
#[derive(Default)]
pub(super) struct Done {
    /// Entries of the file, and where they are now.
    pub(super) moved: Vec<(FileEntry, FileEntry)>,
    /// Entries that could not be carried over, and why.
    pub(super) lost: Vec<(FileEntry, String)>,
}

/// The type of an input that a kind of node had in this format and no longer has.
pub(super) fn former_type(format: u32, kind: &str, input: &str) -> Option<Type> {
    let steps = STEPS.iter().filter(|step| format <= step.from);
    steps.filter_map(|step| (step.former_type)(kind, input)).next()
}

/// Brings a document that was read as `format` to the newest.
pub(super) fn upgrade(document: &mut Document, format: u32) -> Done {
    let mut upgrade = FormatUpgrade { document, done: Done::default() };
    for step in STEPS.iter().filter(|step| format <= step.from) {
        let as_made = upgrade.groups_as_made();
        (step.run)(&mut upgrade);
        for group in as_made {
            upgrade.mark_as_made(&group);
        }
    }
    upgrade.done
}

impl FormatUpgrade<'_> {
    /// The groups that are what their templates had.
    fn groups_as_made(&self) -> Vec<NodeId> {
        let marked = self.document.nodes.iter().filter(|(id, node)| {
            let made = node.template.as_deref().filter(|_| node.is_group());
            made.is_some_and(|origin| {
                document_hash(&groups::alone(self.document, id)) == origin.hash
            })
        });
        marked.map(|(id, _)| id.clone()).collect()
    }
    fn mark_as_made(&mut self, group: &NodeId) {
        let hash = document_hash(&groups::alone(self.document, group));
        if let Some(node) = self.document.nodes.get_mut(group)
            && let Some(origin) = &mut Arc::make_mut(node).template
        {
            Arc::make_mut(origin).hash = hash;
        }
    }
    /// Notes that what a file says of one input is said of another now.
    fn move_entries(&mut self, from: &Socket, to: &Socket) {
        self.done.moved.extend(entries(from).into_iter().zip(entries(to)));
    }
    /// Says that the value of an input, or the wires to it, could not be carried over.
    fn lose(&mut self, input: &Socket, is_value: bool, why: &str) {
        let [value, link, _] = entries(input);
        let place = if is_value { value } else { link };
        self.done.lost.push((place, format!("{input}: {why}")));
    }
}

/// The entries of a file that speak of an input: value, wires and bends.
fn entries(input: &Socket) -> [FileEntry; 3] {
    let value = FileEntry::Input(input.node.clone(), input.name.to_string());
    [value, FileEntry::Link(input.clone()), FileEntry::Bends(input.clone())]
}
