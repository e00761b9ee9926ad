//! What people come to do, from the welcome panel on, in few actions, each of which shows at once.

use super::story::{Hand, Story};
use coif::core::room::Room;
use coif_graphs::document::{Document, Setting};
use coif_nodes::define::Value;
use coif_tests::Folder;
use egui::{Key, Modifiers, Vec2};

fn begin(name: &'static str) -> (Folder, Story) {
    let home = Folder::new(name);
    let story = Story::begin(name, Hand::Mouse, &home);
    (home, story)
}

/// The one node of a kind.
fn node<'a>(document: &'a Document, kind: &str) -> &'a coif_graphs::document::Node {
    let mut all = document.nodes.values().filter(|node| node.kind == kind);
    all.next().unwrap_or_else(|| panic!("there is a {kind}"))
}

fn number(document: &Document, kind: &str, input: &str) -> f32 {
    match node(document, kind).inputs.get(input) {
        Some(Setting::Known(Value::Float(x))) => *x,
        other => panic!("{kind}.{input}: {other:?}"),
    }
}

#[test]
fn a_wavy_bob_with_a_side_parting_copper_with_dark_roots() {
    let (_home, mut story) = begin("bob");
    story.click("Bob with a side parting");
    story.sees_hair(50_000);
    story.picture("1-bob");
    // Its inputs are selected: the swatches are in the inspector.
    story.click("Copper");
    story.sees_hair(50_000);
    let document = &story.ui.state().state.document;
    assert_eq!(number(document, "parameters", "melanin_tip"), 0.38);
    story.click("Root colour as hex");
    story.write("#0b0301");
    story.key(Modifiers::NONE, Key::Enter);
    story.sees_hair(50_000);
    story.picture("2-colour");
    let document = &story.ui.state().state.document;
    let root = number(document, "parameters", "melanin_root");
    assert!(root > 0.75, "{root}");
    assert_eq!(number(document, "parameters", "melanin_tip"), 0.38, "tips stay");
    assert!(number(document, "parameters", "redness") > 0.6, "and copper");
    // Over the nodes.
    story.over(Room::Canvas);
    story.key(Modifiers::NONE, Key::Tab);
    story.write("2b");
    story.key(Modifiers::NONE, Key::Enter);
    story.sees_hair(50_000);
    story.picture("3-waves");
    let document = &story.ui.state().state.document;
    let curl = node(document, "shape_list_curl");
    assert_eq!(curl.inputs.get("preset"), Some(&Setting::Known(Value::Text("2b".into()))));
    let shown = document.display.as_ref().and_then(|id| document.node(id.as_str()));
    assert_eq!(shown.map(|node| node.kind.as_str()), Some("shape_list_curl"), "it is seen");
    let written = document.links.iter().find(|(to, _)| to.node.as_str() == "out").unwrap().1;
    assert_eq!(document.node(written[0].node.as_str()), shown, "and written");
    println!("{} actions: {}", story.actions, story.took.join(", "));
    assert!(story.actions <= 12, "{} actions: {:?}", story.actions, story.took);
}

#[test]
fn mirrored_cornrows_with_partings() {
    let (_home, mut story) = begin("cornrows");
    story.click("Cornrows");
    story.sees_hair(0);
    story.over(Room::Viewport);
    story.key(Modifiers::NONE, Key::X);
    for x in [0.06, 0.13, 0.2] {
        story.draw(&[(x, -0.3), (x + 0.02, -0.36), (x, -0.42)]);
        story.sees_hair(100);
    }
    story.picture("1-rows");
    let state = &story.ui.state().state;
    let shown = state.shown.as_ref().expect("hair");
    let braids = shown.curves.tufts().len();
    assert!(braids >= 12, "three rows on each side and the hair from their partings: {braids}");
    println!("{} actions: {}", story.actions, story.took.join(", "));
    assert!(story.actions <= 8, "{} actions: {:?}", story.actions, story.took);
}

#[test]
fn a_puff_is_moved_by_its_handle() {
    let (_home, mut story) = begin("puff");
    story.click("Puff");
    story.sees_hair(10_000);
    story.picture("1-puff");
    let before =
        node(&story.ui.state().state.document, "parameters").inputs.get("position").cloned();
    // Its place is on the skin, over the horizon of the head as seen from the front: from above it is there.
    story.over(Room::Viewport);
    story.key(Modifiers::ALT, Key::Num5);
    story.sees_hair(10_000);
    story.drag("Handle of position", Vec2::new(60.0, 10.0));
    story.sees_hair(10_000);
    story.picture("2-moved");
    let after =
        node(&story.ui.state().state.document, "parameters").inputs.get("position").cloned();
    assert_ne!(before, after);
    assert_eq!(story.ui.state().state.history.done(), 2, "the recipe and the drag");
    println!("{} actions: {}", story.actions, story.took.join(", "));
    assert!(story.actions <= 3, "{} actions: {:?}", story.actions, story.took);
}
