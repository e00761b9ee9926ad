//! What differs between two documents, node by node, in words.

use coif_graphs::document::graph::inputs_of;
use coif_graphs::document::{Document, Node, NodeId};
use std::collections::BTreeSet;

/// A node that is not the same in two documents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Which; none for the document itself.
    pub node: Option<NodeId>,
    /// What differs, for people.
    pub words: String,
}

/// What another document has otherwise than one's own. Layout is no difference.
pub fn differences(mine: &Document, theirs: &Document) -> Vec<Difference> {
    let mut all = vec![];
    let of_document = [
        (mine.title != theirs.title, "the title"),
        (mine.note != theirs.note, "the note"),
        (mine.seed != theirs.seed, "the seed"),
        (mine.display != theirs.display, "the displayed node"),
    ];
    let words: Vec<&str> = of_document.into_iter().filter(|(d, _)| *d).map(|(_, w)| w).collect();
    if !words.is_empty() {
        all.push(Difference { node: None, words: format!("differs in {}", words.join(", ")) });
    }
    let ids: BTreeSet<&NodeId> = mine.nodes.keys().chain(theirs.nodes.keys()).collect();
    for id in ids {
        let words = match (mine.node(id.as_str()), theirs.node(id.as_str())) {
            (Some(_), None) => Some("is only in yours".to_owned()),
            (None, Some(_)) => Some("is only on the disk".to_owned()),
            (Some(a), Some(b)) => of_node(mine, theirs, id, a, b),
            (None, None) => None,
        };
        all.extend(words.map(|words| Difference { node: Some(id.clone()), words }));
    }
    all
}

fn of_node(mine: &Document, theirs: &Document, id: &NodeId, a: &Node, b: &Node) -> Option<String> {
    let mut parts = vec![];
    for (differs, word) in [
        (a.kind != b.kind, "kind"),
        (a.label != b.label, "name"),
        (a.note != b.note, "note"),
        (a.bypass != b.bypass, "bypass"),
    ] {
        parts.extend(differs.then(|| word.to_owned()));
    }
    let names: BTreeSet<&String> = a.inputs.keys().chain(b.inputs.keys()).collect();
    let differ = names.into_iter().filter(|name| a.inputs.get(*name) != b.inputs.get(*name));
    parts.extend(differ.map(|name| name.replace('_', " ")));
    let wires = |document: &Document| -> Vec<_> {
        inputs_of(document, id).map(|(to, from)| (to.clone(), from.clone())).collect()
    };
    if wires(mine) != wires(theirs) {
        parts.push("wires".to_owned());
    }
    (!parts.is_empty()).then(|| format!("differs in {}", parts.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_graphs::document::Setting;
    use coif_nodes::define::Value;
    use std::sync::Arc;

    #[test]
    fn differences_are_said_node_by_node() {
        let text = coif_graphs::grooms::by_name("braids").unwrap();
        let mine = coif_graphs::file::read(text).unwrap().document;
        assert_eq!(differences(&mine, &mine), []);
        let mut theirs = mine.clone();
        let ids: Vec<NodeId> = theirs.nodes.keys().take(2).cloned().collect();
        theirs.seed += 1;
        theirs.nodes.remove(&ids[0]);
        let node = Arc::make_mut(theirs.nodes.get_mut(&ids[1]).unwrap());
        node.bypass = !node.bypass;
        node.inputs.insert("made_up".to_owned(), Setting::Known(Value::Int(7)));
        let found = differences(&mine, &theirs);
        let said: Vec<(Option<&NodeId>, &str)> =
            found.iter().map(|d| (d.node.as_ref(), d.words.as_str())).collect();
        assert_eq!(
            said,
            [
                (None, "differs in the seed"),
                (Some(&ids[0]), "is only in yours"),
                (Some(&ids[1]), "differs in bypass, made up"),
            ]
        );
        assert_eq!(differences(&theirs, &mine)[1].words, "is only on the disk");
    }
}
