//! What leads from one document to another, as one edit.

use super::{Edit, wires};
use crate::document::{Document, NodeId, Socket};
use std::collections::BTreeSet;

/// The edit that makes `after` of `before`. It says only what differs, so that what it takes back is only that.
///
/// What `after` holds has to be as documents hold it (`Document::settle` drops what has nothing to stand on).
pub fn between(before: &Document, after: &Document) -> Edit {
    let mut edits = vec![];
    let both = |a: &BTreeSet<Socket>, b: &BTreeSet<Socket>| a.union(b).cloned().collect::<Vec<_>>();
    let keys = |document: &Document| document.links.keys().cloned().collect::<BTreeSet<Socket>>();
    let wired = both(&keys(before), &keys(after));
    // A node that comes or goes takes its wires along, also those of a broken file, which both may have.
    let stays = |id: &NodeId| before.nodes.contains_key(id) == after.nodes.contains_key(id);
    let differs = |to: &&Socket| {
        let mut sources = before.links.get(*to).into_iter().flatten();
        before.links.get(*to) != after.links.get(*to)
            || before.bends.get(*to) != after.bends.get(*to)
            || !stays(&to.node)
            || sources.any(|from| !stays(&from.node))
    };
    let changed: Vec<&Socket> = wired.iter().filter(differs).collect();
    // Wires first off and last on: what comes and goes between takes none with it.
    let was_wired = changed.iter().filter(|to| before.links.contains_key(**to));
    edits.extend(was_wired.map(|to| Edit::SetWires { to: (*to).clone(), from: vec![] }));
    if before.display != after.display && before.display.is_some() {
        edits.push(Edit::SetDisplay(None));
    }
    nodes(before, after, &mut edits);
    for to in changed.into_iter().filter(|to| after.links.contains_key(*to)) {
        edits.extend(
            wires::restoring(after, to)
                .into_iter()
                .filter(|edit| !matches!(edit, Edit::SetBends { bends, .. } if bends.is_empty())),
        );
    }
    besides(before, after, &mut edits);
    Edit::Several(edits)
}

fn nodes(before: &Document, after: &Document, edits: &mut Vec<Edit>) {
    let gone = before.nodes.keys().rev().filter(|id| !after.nodes.contains_key(*id));
    edits.extend(gone.map(|id| Edit::RemoveNode { id: id.clone() }));
    for (id, node) in &after.nodes {
        let at = after.layout.get(id).copied();
        match before.nodes.get(id) {
            None => edits.push(Edit::AddNode { id: id.clone(), node: node.clone(), at }),
            Some(old) => {
                if old != node {
                    edits.push(Edit::ReplaceNode { id: id.clone(), node: node.clone() });
                }
                if before.layout.get(id).copied() != at {
                    edits.push(Edit::Move { id: id.clone(), to: at });
                }
            }
        }
        let was = before.nodes.contains_key(id) && before.collapsed.contains(id);
        let collapsed = after.collapsed.contains(id);
        if was != collapsed {
            edits.push(Edit::SetCollapsed { id: NodeId::clone(id), collapsed });
        }
    }
}

/// All that is no node and no wire.
fn besides(before: &Document, after: &Document, edits: &mut Vec<Edit>) {
    if before.display != after.display && after.display.is_some() {
        edits.push(Edit::SetDisplay(after.display.clone()));
    }
    if before.title != after.title {
        edits.push(Edit::SetTitle(after.title.clone()));
    }
    if before.note != after.note {
        edits.push(Edit::SetNote(after.note.clone()));
    }
    if before.seed != after.seed {
        edits.push(Edit::SetSeed(after.seed));
    }
    if before.thumbnail != after.thumbnail {
        edits.push(Edit::SetThumbnail(after.thumbnail.clone()));
    }
    if before.budget != after.budget {
        edits.push(Edit::SetBudget(after.budget));
    }
    if before.look != after.look {
        edits.push(Edit::SetLook(after.look.clone()));
    }
    for name in before.frames.keys().chain(after.frames.keys()).collect::<BTreeSet<_>>() {
        let frame = after.frames.get(name);
        if before.frames.get(name) != frame {
            edits.push(Edit::SetFrame { name: name.clone(), frame: frame.cloned() });
        }
    }
    for name in before.views.keys().chain(after.views.keys()).collect::<BTreeSet<_>>() {
        let view = after.views.get(name);
        if before.views.get(name) != view {
            edits.push(Edit::SetView { name: name.clone(), view: view.copied() });
        }
    }
    for place in before.comments.keys().chain(after.comments.keys()).collect::<BTreeSet<_>>() {
        let (old, lines) = (before.comments.get(place), after.comments.get(place));
        // What goes with an entry goes by itself.
        if old != lines && after.has(place) {
            let lines = lines.cloned().unwrap_or_default();
            edits.push(Edit::SetComment { place: place.clone(), lines });
        }
    }
}
