//! What a document means, as a hash.
//!
//! Guarantees: the hash of a document stays from format to format, unless a step changes the document itself.

use crate::document::budget::Budget;
use crate::document::{Document, Setting};
use coif_nodes::declared::Interface;
use coif_nodes::define::Value;
use std::sync::Arc;

/// The format that is hashed. It stays when files get a newer one, so that hashes of older versions still compare.
const HASHED: u32 = 2;

/// Hash of what a document means, as 32 hexadecimal digits: moving nodes, writing notes, displaying another node and limiting what it
/// may take changes nothing.
pub fn document_hash(document: &Document) -> String {
    let mut meaning = document.clone();
    meaning.budget = Budget::default();
    meaning.display = None;
    meaning.layout.clear();
    meaning.frames.clear();
    meaning.bends.clear();
    meaning.collapsed.clear();
    meaning.views.clear();
    meaning.look = None;
    meaning.thumbnail = None;
    meaning.comments.clear();
    meaning.note.clear();
    for node in meaning.nodes.values_mut() {
        let node = Arc::make_mut(node);
        node.note.clear();
        node.label = None;
        node.template = None;
        node.interface = node.interface.map(Interface::without_words);
        for setting in node.inputs.values_mut() {
            if let Setting::Known(Value::Strokes(strokes)) = setting
                && strokes.0.iter().any(|stroke| !stroke.drawn.is_empty())
            {
                Arc::make_mut(strokes).0.iter_mut().for_each(|stroke| stroke.drawn.clear());
            }
        }
    }
    blake3::hash(super::write::write_as(&meaning, HASHED).as_bytes()).to_hex()[..32].to_owned()
}
