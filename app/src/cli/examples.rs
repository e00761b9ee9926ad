//! The smallest graph that shows what a kind of node is for, cut from one graph that has them all (`examples.ron`).
//!
//! Pure. An example is a whole groom: the node, what feeds it, an output, and for a node that gives no curves first (a head,
//! partings, a mask) one that takes what it gives. Nodes stand as they are typed in that file, in its order. That each is evaluated
//! without a warning, and that hair would be other hair without the node, is proven by a test of the manual.

use coif_graphs::document::graph::{feeders, upstream};
use coif_graphs::document::{Document, NodeId};
use coif_graphs::file;
use coif_nodes::define::Type;
use std::collections::BTreeSet;
use std::sync::OnceLock;

const TEXT: &str = include_str!("examples.ron");
/// The kind that writes hair.
const OUTPUT: &str = "groom_output";
/// How far the nodes of that file are indented.
const INDENT: &str = "        ";

/// The graph of an example, as text that ends a line: the smallest, of several the first in the file. None for kinds that the file
/// lacks.
pub(super) fn example(kind: &str) -> Option<String> {
    let all = all();
    let of_kind = all.nodes.iter().filter(|(_, node)| node.kind == kind);
    let shown = of_kind.flat_map(|(id, _)| shown_by(all, id));
    let with_feeders = shown.map(|id| (id, upstream(all, [id])));
    let place = |id: &NodeId| TEXT.find(&format!("{INDENT}\"{id}\":"));
    let (shown, nodes) = with_feeders.min_by_key(|(id, nodes)| (nodes.len(), place(id)))?;
    Some(text(all, shown, &nodes))
}

fn all() -> &'static Document {
    static ALL: OnceLock<Document> = OnceLock::new();
    ALL.get_or_init(|| file::read(TEXT).map(|loaded| loaded.document).unwrap_or_default())
}

fn gives_curves_first(all: &Document, id: &NodeId) -> bool {
    let def = all.nodes.get(id).and_then(|node| coif_nodes::by_id(&node.kind));
    def.and_then(|def| def.outputs.first()).is_some_and(|first| first.ty == Type::Curves)
}

/// What may end an example of a node: itself, where it gives curves first; else what takes from it.
fn shown_by<'a>(all: &'a Document, id: &'a NodeId) -> Vec<&'a NodeId> {
    match gives_curves_first(all, id) {
        true => vec![id],
        false => all.nodes.keys().filter(|to| feeders(all, to).any(|from| from == id)).collect(),
    }
}

/// These nodes alone, as they are typed, and an output for the one that is shown.
fn text(all: &Document, shown: &NodeId, nodes: &BTreeSet<NodeId>) -> String {
    let mut text = "(\n    format: 3,\n    nodes: {\n".to_owned();
    let mut is_in = false;
    for line in TEXT.lines() {
        let Some(typed) = line.strip_prefix(INDENT) else { continue };
        if let Some(id) = typed.strip_prefix('"').and_then(|rest| rest.split('"').next()) {
            is_in = nodes.iter().any(|node| node.as_str() == id);
        }
        if is_in && !typed.starts_with("//") {
            text += line;
            text += "\n";
        }
    }
    if all.nodes.get(shown).is_some_and(|node| node.kind != OUTPUT) {
        text += &format!(
            "{INDENT}\"out\": (kind: \"{OUTPUT}\", links: {{\"curves\": \"{shown}.curves\"}}),\n"
        );
    }
    text + "    },\n)\n"
}
