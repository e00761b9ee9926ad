//! Every edit there and back, and what is refused.

use super::super::testing::Random;
use super::*;
use coif_nodes::data::gestures::Gestures;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::Value;

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
fn socket(text: &str) -> Socket {
    text.parse().unwrap()
}
fn add(name: &str, kind: &str) -> Edit {
    let node = Node { kind: kind.to_owned(), ..Node::default() };
    Edit::AddNode { id: id(name), node: node.into(), at: None }
}
fn connect(from: &str, to: &str) -> Edit {
    Edit::Connect { from: socket(from), to: socket(to), at: None }
}
fn set(node: &str, input: &str, value: impl Into<Value>) -> Edit {
    let setting = Setting::Known(value.into());
    Edit::SetInput { node: id(node), input: input.to_owned(), setting }
}
fn resamples() -> Document {
    let mut document = Document::default();
    for name in ["a", "b", "c"] {
        add(name, "resample").apply(&mut document).unwrap();
    }
    connect("a.curves", "b.curves").apply(&mut document).unwrap();
    document
}

/// Applies an edit that must go through; its inverse must restore exactly, and the inverse of
/// that redo.
#[track_caller]
fn there_and_back(document: &Document, edit: &Edit) -> Document {
    let mut after = document.clone();
    let inverse = edit.apply(&mut after).unwrap_or_else(|err| panic!("{edit:?}: {err}"));
    let mut back = after.clone();
    let redo = inverse.apply(&mut back).unwrap_or_else(|err| panic!("{inverse:?}: {err}"));
    assert_eq!(back, *document, "{edit:?}\n{inverse:?}");
    redo.apply(&mut back).unwrap();
    assert_eq!(back, after, "{edit:?}\n{redo:?}");
    after
}
#[track_caller]
fn refused(document: &Document, edit: &Edit, why: &str) {
    let mut after = document.clone();
    assert_eq!(edit.apply(&mut after).unwrap_err().to_string(), why);
    assert_eq!(after, *document);
}

#[test]
fn random_edits_restore_exactly_and_refused_ones_change_nothing() {
    let (mut happened, mut drawn) = (0, 0);
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let mut document = Document::default();
        for _ in 0..100 {
            let edit = random.edit(&document);
            let mut after = document.clone();
            match edit.apply(&mut after) {
                Ok(_) => {
                    happened += 1;
                    use Edit::{RemoveGesture, RemoveStroke, ReplaceGesture, ReplaceStroke};
                    drawn += usize::from(matches!(
                        edit,
                        RemoveGesture { .. }
                            | RemoveStroke { .. }
                            | ReplaceGesture { .. }
                            | ReplaceStroke { .. }
                    ));
                    document = there_and_back(&document, &edit);
                }
                Err(_) => assert_eq!(after, document, "{edit:?}"),
            }
            assert!(document.comments.keys().all(|place| document.has(place)));
            assert!(document.links.values().all(|from| !from.is_empty()));
            assert!(document.collapsed.iter().all(|id| document.nodes.contains_key(id)));
            for (to, bends) in &document.bends {
                assert!(bends.last().is_some_and(|last| !last.is_empty()));
                assert!(document.links[to].len() >= bends.len());
            }
            assert!(document.layout.keys().all(|id| document.nodes.contains_key(id)));
        }
    }
    assert!(
        happened > 2000 && drawn > 20,
        "only {happened} edits happened, {drawn} of one stroke or gesture"
    );
}

#[test]
fn a_removed_node_comes_back_with_wires_in_order_place_display_and_comments() {
    let mut document = Document::default();
    for name in ["x", "y", "z"] {
        add(name, "resample").apply(&mut document).unwrap();
    }
    add("all", "of_tomorrow").apply(&mut document).unwrap();
    for from in ["x.curves", "y.curves", "z.curves"] {
        connect(from, "all.in").apply(&mut document).unwrap();
    }
    connect("x.curves", "y.curves").apply(&mut document).unwrap();
    Edit::Move { id: id("y"), to: Some(Point(1.0, 2.0)) }.apply(&mut document).unwrap();
    Edit::SetDisplay(Some(id("y"))).apply(&mut document).unwrap();
    set("y", "count", 9i64).apply(&mut document).unwrap();
    for place in [FileEntry::Input(id("y"), "count".into()), FileEntry::Link(socket("y.curves"))] {
        let lines = vec!["// why".to_owned()];
        Edit::SetComment { place, lines }.apply(&mut document).unwrap();
    }
    let after = there_and_back(&document, &Edit::RemoveNode { id: id("y") });
    assert_eq!(after.links[&socket("all.in")], [socket("x.curves"), socket("z.curves")]);
    assert_eq!((after.links.len(), after.display, after.comments.len()), (1, None, 0));
}

#[test]
fn what_cannot_run_is_refused_with_the_reason() {
    let document = resamples();
    let check = |edit: Edit, why: &str| refused(&document, &edit, why);
    check(add("a", "resample"), "there is a node a already");
    check(set("x", "count", 3i64), "there is no node x");
    check(set("a", "cuont", 3i64), "a.cuont: resample has no such input; did you mean count?");
    check(
        set("a", "colour", 3i64),
        "a.colour: resample has no such input; it has curves, by, count, spacing",
    );
    check(set("a", "count", 0.5), "a.count: takes a whole number, not a number");
    check(set("a", "spacing", f32::NAN), "a.spacing: not a finite number");
    check(
        set("a", "by", "spcing"),
        "a.by: \"spcing\" is none of count, spacing; did you mean \"spacing\"?",
    );
    check(
        set("a", "curves", coif_nodes::data::curves::Curves::default()),
        "a.curves: curves come by wire: connect a node",
    );
    check(
        connect("b.curves", "a.curves"),
        "a.curves: a wire from b.curves would run in a circle: a feeds b; wire a node that does not hang from a",
    );
    check(
        connect("c.curves", "c.curves"),
        "c.curves: a wire from c.curves would feed the node with itself; wire a node that does not hang from c",
    );
    check(
        connect("a.curve", "c.curves"),
        "c.curves: a.curve is no output: resample gives curves; did you mean a.curves?",
    );
    check(
        connect("a.curves", "c.count"),
        "c.count: a.curves gives curves, whole number is taken; remove the wire and set a value",
    );
    check(
        connect("nix.curves", "c.curves"),
        "c.curves: there is no node nix to wire; remove the wire or add the node",
    );
    check(
        Edit::Disconnect { to: socket("b.curves"), at: 1 },
        "b.curves has no wire 1: its wires are numbered from 0, there are 1",
    );
    let point = Some(Point(f32::NAN, 0.0));
    check(
        Edit::Move { id: id("a"), to: point },
        "a: the place on the canvas is not a finite number",
    );
    let half = Edit::Several(vec![set("a", "count", 5i64), set("a", "count", 0.5)]);
    check(half, "a.count: takes a whole number, not a number");
    let lines = vec!["no slashes".to_owned()];
    check(
        Edit::SetComment { place: FileEntry::Top, lines },
        "comments are single lines that begin with // and stand before an entry of the document",
    );
}

#[test]
fn an_input_of_one_wire_takes_the_new_one_and_many_are_kept_in_order() {
    let document = resamples();
    let after = there_and_back(&document, &connect("c.curves", "b.curves"));
    assert_eq!(after.links[&socket("b.curves")], [socket("c.curves")]);
    let mut document = document;
    add("all", "of_tomorrow").apply(&mut document).unwrap();
    let first = Edit::Connect { from: socket("c.curves"), to: socket("all.in"), at: Some(0) };
    for edit in [connect("a.curves", "all.in"), connect("b.curves", "all.in"), first] {
        document = there_and_back(&document, &edit);
    }
    let reorder = Edit::Reorder { to: socket("all.in"), from: 0, at: 2 };
    let after = there_and_back(&document, &reorder);
    let order: Vec<&str> = after.links[&socket("all.in")].iter().map(|s| s.node.as_str()).collect();
    assert_eq!(order, ["a", "b", "c"]);
}

#[test]
fn values_are_kept_in_one_form() {
    let mut document = resamples();
    set("a", "spacing", 2i64).apply(&mut document).unwrap();
    let two = Setting::Known(Value::Float(2.0));
    assert_eq!(document.node("a").unwrap().inputs["spacing"], two);
    add("new", "of_tomorrow").apply(&mut document).unwrap();
    set("new", "twist", 2i64).apply(&mut document).unwrap();
    assert_eq!(document.node("new").unwrap().inputs["twist"], Setting::Raw("2".into()));
}

#[test]
fn strokes_are_added_changed_and_removed_one_by_one() {
    let mut random = Random::new(3);
    let mut document = Document::default();
    document.nodes.insert(id("pen"), random.stroke_node().into());
    let drawn = |random: &mut Random, others: &Strokes| {
        super::super::strokes::finish(&random.pen(40), others).unwrap()
    };
    let stroke = drawn(&mut random, &Strokes::default());
    let (node, input) = (id("pen"), "strokes".to_owned());
    let edit =
        Edit::AddStroke { node: node.clone(), input: input.clone(), at: 0, stroke: stroke.clone() };
    let after = there_and_back(&document, &edit);
    refused(
        &after,
        &edit,
        &format!("pen.strokes: stroke 1: its id {} is 0 or used before", stroke.id),
    );
    let other = Stroke { id: stroke.id, ..drawn(&mut random, &Strokes::default()) };
    let edit = Edit::ReplaceStroke { node: node.clone(), input: input.clone(), stroke: other };
    let after = there_and_back(&after, &edit);
    let edit = Edit::RemoveStroke { node, input: input.clone(), id: stroke.id };
    assert_eq!(there_and_back(&after, &edit), document);
    add("plain", "resample").apply(&mut document).unwrap();
    let edit = Edit::AddStroke { node: id("plain"), input, at: 0, stroke };
    refused(&document, &edit, "plain.strokes holds no strokes");
}

#[test]
fn gestures_are_added_changed_and_removed_one_by_one() {
    let mut random = Random::new(3);
    let mut document = Document::default();
    document.nodes.insert(id("pen"), random.gesture_node().into());
    let held = |document: &Document| match &document.node("pen").unwrap().inputs["gestures"] {
        Setting::Known(Value::Gestures(all)) => all.0.clone(),
        other => panic!("{other:?}"),
    };
    let before = held(&document);
    let gesture = random.gesture(&Gestures(before.clone()));
    let (node, input) = (id("pen"), "gestures".to_owned());
    let at = usize::MAX;
    let edit = Edit::AddGesture { node, input, at, gesture: gesture.clone() };
    let after = there_and_back(&document, &edit);
    assert_eq!(held(&after), [before.clone(), vec![gesture.clone()]].concat());
    let twice = format!(
        "pen.gestures: gesture {}: its id {} is 0 or used before",
        before.len() + 1,
        gesture.id
    );
    refused(&after, &edit, &twice);
    let (node, input) = (id("pen"), "gestures".to_owned());
    let other = Gesture { id: gesture.id, ..random.gesture(&Gestures::default()) };
    let edit = Edit::ReplaceGesture { node, input, gesture: other.clone() };
    let after = there_and_back(&after, &edit);
    assert_eq!(held(&after).last(), Some(&other));
    let (node, input) = (id("pen"), "gestures".to_owned());
    let empty = Gesture { samples: vec![], ..other };
    let what = format!("gesture {} ({}): it has no samples", before.len(), empty.tool.word());
    let edit = Edit::ReplaceGesture { node, input, gesture: empty };
    refused(&after, &edit, &format!("pen.gestures: {what}"));
    let (node, input) = (id("pen"), "gestures".to_owned());
    let edit = Edit::RemoveGesture { node, input, id: gesture.id };
    assert_eq!(there_and_back(&after, &edit), document);
    refused(&document, &edit, &format!("pen.gestures: there is no gesture {}", gesture.id));
    add("plain", "resample").apply(&mut document).unwrap();
    let (node, input) = (id("plain"), "gestures".to_owned());
    let edit = Edit::AddGesture { node, input, at: 0, gesture };
    refused(&document, &edit, "plain.gestures holds no gestures");
}

#[test]
fn a_node_added_where_dangling_wires_wait_leaves_them_when_taken_back() {
    let mut document = Document::default();
    let wires = Edit::SetWires { to: socket("b.curves"), from: vec![socket("a.curves")] };
    wires.apply(&mut document).unwrap();
    let after = there_and_back(&document, &add("a", "resample"));
    there_and_back(&after, &add("b", "resample"));
}

fn bend(to: &str, at: usize, right: f32) -> Edit {
    Edit::SetBends { to: socket(to), at, bends: vec![Point(right, 0.0)] }
}
/// The first bend of each wire of an input.
fn bent(document: &Document, to: &str) -> Vec<Option<f32>> {
    let wires = document.links.get(&socket(to)).map_or(0, Vec::len);
    (0..wires).map(|at| document.bends_of(&socket(to), at).first().map(|p| p.0)).collect()
}

#[test]
fn bends_follow_their_wire_and_go_and_come_back_with_it() {
    let mut document = resamples();
    add("all", "of_tomorrow").apply(&mut document).unwrap();
    for from in ["a.curves", "b.curves", "a.curves"] {
        connect(from, "all.in").apply(&mut document).unwrap();
    }
    document = there_and_back(&document, &bend("all.in", 0, 1.0));
    document = there_and_back(&document, &bend("all.in", 2, 3.0));
    assert_eq!(bent(&document, "all.in"), [Some(1.0), None, Some(3.0)]);
    let first = Edit::Connect { from: socket("c.curves"), to: socket("all.in"), at: Some(0) };
    let after = there_and_back(&document, &first);
    assert_eq!(bent(&after, "all.in"), [None, Some(1.0), None, Some(3.0)]);
    let reorder = Edit::Reorder { to: socket("all.in"), from: 2, at: 0 };
    let after = there_and_back(&document, &reorder);
    assert_eq!(bent(&after, "all.in"), [Some(3.0), Some(1.0), None]);
    let remove = Edit::Disconnect { to: socket("all.in"), at: 0 };
    let after = there_and_back(&document, &remove);
    assert_eq!(bent(&after, "all.in"), [None, Some(3.0)]);
    let after = there_and_back(&document, &Edit::RemoveNode { id: id("a") });
    assert_eq!((bent(&after, "all.in"), after.bends.len()), (vec![None], 0));
    let after = there_and_back(&document, &Edit::RemoveNode { id: id("b") });
    assert_eq!(bent(&after, "all.in"), [Some(1.0), Some(3.0)]);
    let from = vec![socket("c.curves"), socket("a.curves")];
    let after = there_and_back(&document, &Edit::SetWires { to: socket("all.in"), from });
    assert_eq!(bent(&after, "all.in"), [None, Some(1.0)]);
    // An input of one wire forgets the bends of the wire that it had, not of the same one again.
    document = there_and_back(&document, &bend("b.curves", 0, 7.0));
    let after = there_and_back(&document, &connect("a.curves", "b.curves"));
    assert_eq!(bent(&after, "b.curves"), [Some(7.0)]);
    let after = there_and_back(&document, &connect("c.curves", "b.curves"));
    assert_eq!(bent(&after, "b.curves"), [None]);
}

#[test]
fn a_removed_node_comes_back_collapsed_and_bent() {
    let mut document = resamples();
    Edit::SetCollapsed { id: id("b"), collapsed: true }.apply(&mut document).unwrap();
    bend("b.curves", 0, 7.0).apply(&mut document).unwrap();
    let after = there_and_back(&document, &Edit::RemoveNode { id: id("b") });
    assert!(after.collapsed.is_empty() && after.bends.is_empty());
}

#[test]
fn frames_views_and_bends_that_cannot_be_are_refused() {
    let document = resamples();
    let frame = Some(Frame::default());
    refused(
        &document,
        &Edit::SetFrame { name: "front".into(), frame },
        "frame \"front\": its width and height must be over 0",
    );
    let view = Some(SavedView {
        eye: [1.0; 3],
        target: [1.0; 3],
        up: [0.0, 1.0, 0.0],
        focal_mm: 85.0,
        orthographic: None,
    });
    refused(
        &document,
        &Edit::SetView { name: "hero".into(), view },
        "view \"hero\": its eye is where it looks",
    );
    refused(
        &document,
        &bend("b.curves", 1, 0.0),
        "b.curves has no wire 1: its wires are numbered from 0, there are 1",
    );
    refused(
        &document,
        &bend("b.curves", 0, f32::NAN),
        "b: the place on the canvas is not a finite number",
    );
    refused(&document, &Edit::SetCollapsed { id: id("x"), collapsed: true }, "there is no node x");
}
