//! Some nodes of a document as text, and text as new nodes: copy, paste, duplicate, drag and drop.
//!
//! The text is a small format of its own (`coif_nodes: 1`) with the syntax of files, so that it can
//! be mailed, put on a page and edited by hand. A whole groom can be pasted too.
//!
//! Kept: kinds, labels, notes, values (also those that this version does not know), seed tags, wires
//! among the nodes with their bends, places, and frames of which all nodes are copied. A label that
//! the document has already gets a number. A wire that came in from elsewhere is wired again
//! where the document has that output. Not kept: comments, views, and what the nodes fed.

use crate::document::edit::Edit;
use crate::document::wiring::output_type;
use crate::document::{Document, Frame, Node, NodeId, Point, Socket, groups};
use crate::file;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The letters of a taken id that stand before the number of a copy.
const LONGEST_STEM: usize = 40;

/// Nodes as text, with the wires that end at them. Nodes that are not there are left out.
pub fn copy(document: &Document, nodes: &BTreeSet<NodeId>) -> String {
    let chosen: BTreeSet<NodeId> =
        nodes.iter().filter(|id| document.nodes.contains_key(*id)).cloned().collect();
    let there = groups::with_inside(document, &chosen);
    // What is copied out of a group stands by itself.
    let group = chosen.first().and_then(NodeId::group);
    let group = group.filter(|group| chosen.iter().all(|id| id.group().as_ref() == Some(group)));
    let holds = |frame: &Frame| {
        let inside = |at: &Point| {
            let (x, y) = (at.0 - frame.at.0, at.1 - frame.at.1);
            (0.0..=frame.size.0).contains(&x) && (0.0..=frame.size.1).contains(&y)
        };
        let mut held = document.layout.iter().filter(|(_, at)| inside(at)).peekable();
        held.peek().is_some() && held.all(|(id, _)| there.contains(id))
    };
    let frames = document.frames.iter().filter(|(_, frame)| holds(frame));
    let part = Document {
        frames: frames.map(|(name, frame)| (name.clone(), frame.clone())).collect(),
        nodes: document
            .nodes
            .iter()
            .filter(|(id, _)| there.contains(*id))
            .map(|(id, node)| (id.clone(), node.clone()))
            .collect(),
        links: of(&document.links, |to| there.contains(&to.node)),
        bends: of(&document.bends, |to| there.contains(&to.node)),
        layout: of(&document.layout, |id| there.contains(id)),
        collapsed: document.collapsed.intersection(&there).cloned().collect(),
        ..Document::default()
    };
    let part = match group {
        Some(group) => groups::renamed(&part, |id| {
            let word = id.as_str().strip_prefix(group.as_str()).and_then(|id| id.strip_prefix('/'));
            word.and_then(|word| NodeId::new(word).ok()).unwrap_or_else(|| id.clone())
        }),
        None => part,
    };
    file::write_part(&part)
}

fn of<K: Ord + Clone, V: Clone>(map: &BTreeMap<K, V>, keep: impl Fn(&K) -> bool) -> BTreeMap<K, V> {
    map.iter().filter(|(key, _)| keep(key)).map(|(key, v)| (key.clone(), v.clone())).collect()
}

/// The edit that adds the nodes of a text under ids of their own to a group, or to none, and the ids of those
/// that stand there. `at` is where the upper left of them comes to lie; none leaves them where they were copied.
///
/// # Errors
/// What is wrong with the text, with line and column, on one line.
pub fn paste(
    document: &Document,
    text: &str,
    at: Option<Point>,
    group: Option<&NodeId>,
) -> Result<(Edit, Vec<NodeId>), String> {
    let part = file::read_part(text).map_err(|err| err.to_string())?.document;
    let tops = part.layout.iter().filter(|(id, _)| id.group().is_none());
    let corner = tops.map(|(_, at)| *at).reduce(|a, b| Point(a.0.min(b.0), a.1.min(b.1)));
    let shift = match (at, corner) {
        (Some(at), Some(corner)) => Some(Point(at.0 - corner.0, at.1 - corner.1)),
        _ => None,
    };
    let (edit, ids) = insert(document, &part, shift, &BTreeMap::new(), group)?;
    Ok((edit, ids.into_values().filter(|id| id.group().as_ref() == group).collect()))
}

/// The edit that adds the nodes of another document under ids of their own to a group, or to none, `shift` from where they lie
/// there, and these ids by the ones they had. For nodes of it that are named in `known` a node of this document stands: it is not added, keeps its inputs
/// and feeds what the other fed.
///
/// # Errors
/// Nothing is left to add, or the outcome is refused: on one line.
pub fn insert(
    document: &Document,
    part: &Document,
    shift: Option<Point>,
    known: &BTreeMap<NodeId, NodeId>,
    group: Option<&NodeId>,
) -> Result<(Edit, BTreeMap<NodeId, NodeId>), String> {
    if part.nodes.keys().all(|id| known.contains_key(id)) {
        return Err("there are no nodes in it".to_owned());
    }
    let mut ids = fresh_ids(document, part, group)?;
    ids.extend(known.iter().map(|(old, id)| (old.clone(), id.clone())));
    let moved = |point: &Point| {
        let to = shift.map_or(*point, |by| Point(point.0 + by.0, point.1 + by.1));
        Some(to).filter(|point| point.is_finite())
    };
    let mut edits = vec![];
    // Nodes that had one label among them keep it; only what the document calls so gets a number.
    let there: BTreeSet<String> =
        document.nodes.values().filter_map(|node| node.label.clone()).collect();
    let mut taken = there.clone();
    for (old, node) in part.nodes.iter().filter(|(old, _)| !known.contains_key(*old)) {
        // Within a group all stay where they are.
        let at = match part.nodes.contains_key(old) && old.group().is_some() {
            true => part.layout.get(old).copied().filter(|at| at.is_finite()),
            false => part.layout.get(old).and_then(moved),
        };
        let node = match &node.label {
            Some(label) if there.contains(label) => {
                let label = Some(free_label(&taken, label));
                Node { label, ..(**node).clone() }.into()
            }
            _ => Arc::clone(node),
        };
        taken.extend(node.label.clone());
        edits.push(Edit::AddNode { id: ids[old].clone(), node, at });
    }
    for (to, wires) in &part.links {
        let Some(node) = ids.get(&to.node).filter(|_| !known.contains_key(&to.node)) else {
            continue;
        };
        let to_new = Socket::new(node.clone(), &to.name);
        let (mut from, mut bends) = (vec![], vec![]);
        for (i, wire) in wires.iter().enumerate() {
            let source = match ids.get(&wire.node) {
                Some(node) => Some(Socket::new(node.clone(), &wire.name)),
                None => {
                    let beside = NodeId::within(group, wire.node.as_str()).ok();
                    let beside = beside.map(|node| Socket::new(node, &wire.name));
                    beside.filter(|wire| output_type(document, wire).is_some())
                }
            };
            if let Some(source) = source {
                bends.push(part.bends_of(to, i).iter().filter_map(moved).collect::<Vec<Point>>());
                from.push(source);
            }
        }
        if from.is_empty() {
            continue;
        }
        edits.push(Edit::SetWires { to: to_new.clone(), from });
        for (at, bends) in bends.into_iter().enumerate().filter(|(_, bends)| !bends.is_empty()) {
            edits.push(Edit::SetBends { to: to_new.clone(), at, bends });
        }
    }
    for old in part.collapsed.iter().filter(|old| !known.contains_key(*old)) {
        edits.push(Edit::SetCollapsed { id: ids[old].clone(), collapsed: true });
    }
    let mut framed = Document { frames: document.frames.clone(), ..Document::default() };
    for (name, frame) in &part.frames {
        let Some(at) = moved(&frame.at) else { continue };
        let name = match framed.frames.contains_key(name) {
            true => framed.free_frame(name),
            false => name.clone(),
        };
        let frame = Frame { at, ..frame.clone() };
        framed.frames.insert(name.clone(), frame.clone());
        edits.push(Edit::SetFrame { name, frame: Some(frame) });
    }
    let edit = Edit::Several(edits);
    // What a text holds may still be refused: said now, and not when half of a gesture is done.
    edit.apply(&mut document.clone()).map_err(|err| err.to_string())?;
    Ok((edit, ids))
}

/// A label that nobody has: its words with the first free number behind them.
fn free_label(taken: &BTreeSet<String>, label: &str) -> String {
    let words = label.trim_end_matches(|c: char| c.is_ascii_digit());
    let words = if words.ends_with(' ') { words.trim_end() } else { label };
    let mut number = 2u32;
    loop {
        let free = format!("{words} {number}");
        if !taken.contains(&free) {
            return free;
        }
        number += 1;
    }
}

/// For each node of a part an id in `group` that the document does not use: its own, else its stem with the
/// first free number. Nodes in groups go with them.
///
/// # Errors
/// Groups would be nested too deeply.
fn fresh_ids(
    document: &Document,
    part: &Document,
    group: Option<&NodeId>,
) -> Result<BTreeMap<NodeId, NodeId>, String> {
    let mut scratch = Document { nodes: document.nodes.clone(), ..Document::default() };
    // Wires that wait for a node of that id are not meant for this one.
    for (to, wires) in &document.links {
        for id in wires.iter().map(|wire| &wire.node).chain([&to.node]) {
            scratch.nodes.entry(id.clone()).or_default();
        }
    }
    let mut numbers: BTreeMap<String, u32> = BTreeMap::new();
    let mut ids = BTreeMap::new();
    let within = |group: Option<&NodeId>, id: &str| {
        NodeId::within(group, id).map_err(|_| "groups would be nested too deeply".to_owned())
    };
    for old in part.nodes.keys() {
        if let Some(inside) = old.group().and_then(|group| ids.get(&group)) {
            let id = within(Some(inside), old.word())?;
            scratch.nodes.insert(id.clone(), Arc::default());
            ids.insert(old.clone(), id);
            continue;
        }
        let own = within(group, old.word())?;
        let id = if scratch.nodes.contains_key(&own) {
            let stem = old.word().trim_end_matches(|c: char| c.is_ascii_digit());
            let stem = stem.trim_end_matches('_');
            let stem = stem.get(..LONGEST_STEM).unwrap_or(stem);
            // Remembered, so that a thousand nodes of one stem do not count from 2 each.
            let number = numbers.entry(stem.to_owned()).or_insert(1);
            loop {
                *number += 1;
                let id = scratch.free_id_in(group, &format!("{stem}_{number}"));
                if !part.nodes.contains_key(id.word()) {
                    break id;
                }
            }
        } else {
            own
        };
        scratch.nodes.insert(id.clone(), Arc::default());
        ids.insert(old.clone(), id);
    }
    Ok(ids)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::testing::Random;
    use crate::waiting::ends;
    use crate::work::count;
    use expect_test::expect;

    fn ids(text: &str) -> BTreeSet<NodeId> {
        text.split_whitespace().map(|id| NodeId::new(id).unwrap()).collect()
    }
    fn braids() -> Document {
        let text = r#"(format: 1, title: "x", seed: 7, nodes: {
            "head": (kind: "head"),
            "rows": (kind: "stroke_input", label: "front", inputs: {"seed": 17, "radius": 2}),
            "thin": (kind: "resample", note: "n", inputs: {"count": 9, "twist": Twist(3)}),
            "new": (kind: "of_tomorrow", inputs: {"deep": [1, 2]}),
        }, links: {
            "rows.scalp": "head.scalp", "thin.curves": "rows.curves",
            "new.in": ["thin.curves", "rows.curves"],
        }, bends: {"thin.curves": [[(5, 5)]], "new.in": [[], [(9, 9)]]}, collapsed: ["thin"],
        layout: {"head": (0, 0), "rows": (100, 50), "thin": (200, 40)})"#;
        file::read(text).unwrap().document
    }

    #[test]
    fn a_part_is_text_that_people_can_read() {
        expect![[r#"
            (
                coif_nodes: 3,
                nodes: {
                    "thin": (
                        at: (200.0, 40.0),
                        collapsed: true,
                        kind: "resample",
                        note: "n",
                        inputs: {
                            "count": 9,
                            "twist": Twist(3),
                        },
                        links: {
                            "curves": "rows.curves",
                        },
                    ),
                    "rows": (
                        at: (100.0, 50.0),
                        kind: "stroke_input",
                        label: "front",
                        inputs: {
                            "radius": 2.0,
                            "seed": 17,
                        },
                        links: {
                            "scalp": "head.scalp",
                        },
                    ),
                },
                bends: {
                    "thin.curves": [[(5.0, 5.0)]],
                },
            )
        "#]]
        .assert_eq(&copy(&braids(), &ids("rows thin gone")));
    }

    #[test]
    fn a_duplicate_has_ids_of_its_own_the_same_values_and_the_wires_that_came_in() {
        let mut document = braids();
        let text = copy(&document, &ids("rows thin new"));
        let (edit, made) = paste(&document, &text, Some(Point(1000.0, 500.0)), None).unwrap();
        let before = document.clone();
        let undo = edit.apply(&mut document).unwrap();
        assert_eq!(
            made.iter().map(NodeId::as_str).collect::<Vec<_>>(),
            ["new_2", "rows_2", "thin_2"]
        );
        for (old, new) in [("rows", "rows_2"), ("thin", "thin_2"), ("new", "new_2")] {
            let label =
                document.node(old).unwrap().label.as_ref().map(|label| format!("{label} 2"));
            let copy = Node { label, ..document.node(old).unwrap().clone() };
            assert_eq!(Some(&copy), document.node(new));
        }
        let wires = |to: &str| format!("{:?}", document.links[&to.parse().unwrap()]);
        assert_eq!(wires("rows_2.scalp"), "[head.scalp]");
        assert_eq!(wires("thin_2.curves"), "[rows_2.curves]");
        assert_eq!(wires("new_2.in"), "[thin_2.curves, rows_2.curves]");
        assert_eq!(document.bends_of(&"new_2.in".parse().unwrap(), 1), [Point(909.0, 469.0)]);
        assert_eq!(document.layout["rows_2"], Point(1000.0, 510.0));
        assert!(document.collapsed.contains("thin_2") && !document.layout.contains_key("new_2"));
        undo.apply(&mut document).unwrap();
        assert_eq!(document, before);
    }

    #[test]
    fn a_part_pasted_into_another_groom_keeps_ids_and_loses_the_wires_from_elsewhere() {
        let text = copy(&braids(), &ids("rows thin"));
        let mut document = Document::default();
        paste(&document, &text, None, None).unwrap().0.apply(&mut document).unwrap();
        assert_eq!(document.layout["rows"], Point(100.0, 50.0));
        let wired: Vec<String> = document.links.keys().map(Socket::to_string).collect();
        assert_eq!(wired, ["thin.curves"]);
        let (_, made) = paste(&document, &file::write(&braids()), None, None).unwrap();
        assert_eq!(made.len(), 4);
    }

    #[test]
    fn everything_that_can_be_copied_can_be_pasted_and_is_the_same_again() {
        for seed in 0..60 {
            let mut random = Random::new(seed);
            let mut document = random.document();
            // What is in a group that is not there stands beside the others where it is pasted.
            while let Some(lost) = document
                .nodes
                .keys()
                .find(|id| id.group().is_some_and(|group| !document.nodes.contains_key(&group)))
            {
                let id = lost.clone();
                Edit::RemoveNode { id }.apply(&mut document).unwrap();
            }
            let all: BTreeSet<NodeId> = document.nodes.keys().cloned().collect();
            let text = copy(&document, &all);
            match paste(&document, &text, None, None) {
                Err(why) => assert!(all.is_empty(), "{why}\n{text}"),
                Ok((edit, made)) => {
                    let mut after = document.clone();
                    let undo = edit.apply(&mut after).unwrap();
                    let beside = all.iter().filter(|id| id.group().is_none()).count();
                    assert_eq!((made.len(), after.nodes.len()), (beside, 2 * all.len()));
                    undo.apply(&mut after).unwrap();
                    assert_eq!(after, document, "seed {seed}");
                    let mut alone = Document::default();
                    paste(&alone, &text, None, None).unwrap().0.apply(&mut alone).unwrap();
                    assert_eq!(alone.nodes, document.nodes, "seed {seed}");
                    assert_eq!(alone.layout, document.layout, "seed {seed}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_part_is_refused_in_one_line() {
        let refused = |text: &str| paste(&braids(), text, None, None).unwrap_err();
        expect![[r#"
            1:1: these are no nodes: they begin with `(coif_nodes: 3`
            1:1: these are no nodes: they begin with `(coif_nodes: 3`
            there are no nodes in it
            1:25: expected opening `{`
            1:10: the file has format 9, this version reads up to 3: open it with a newer coif
            1:1: these are no nodes: they begin with `(coif_nodes: 3`"#]]
        .assert_eq(
            &[
                "",
                "hello",
                "(coif_nodes: 1)",
                "(coif_nodes: 2, frames: 3)",
                "(format: 9)",
                "(title: \"x\")",
            ]
            .map(refused)
            .join("\n"),
        );
        let mut random = Random::new(7);
        let text = copy(&braids(), &ids("head rows thin new"));
        for _ in 0..400 {
            let (a, b) = (random.below(text.len()), random.below(text.len()));
            let mut broken = text.clone();
            broken.replace_range(
                a.min(b)..a.max(b).min(a.min(b) + 20),
                random.pick(&["", "(", "\"", "}", ",", "0"]),
            );
            if let Err(why) = paste(&braids(), &broken, None, None) {
                assert!(!why.contains('\n') && !why.is_empty(), "{why}");
            }
        }
        let many: String = (2..4000).map(|n| format!("\"rows_{n}\": (kind: \"head\"),")).collect();
        let many = format!("(coif_nodes: 1, nodes: {{{many}}})");
        let mut document = braids();
        // The second time every name is taken.
        for _ in 0..2 {
            let (pasted, work) = ends("many", || count(|| paste(&document, &many, None, None)));
            let (edit, nodes) = pasted.unwrap();
            assert_eq!(nodes.len(), 3998);
            assert!(work.asked < 3998 * 40, "{work:?}");
            edit.apply(&mut document).unwrap();
        }
    }
}
