//! Another's version beside one's own, as a person looks at it: side by side, then its hair in place of one's own.

use super::harness::settle;
use super::story::{Hand, Story};
use coif::core::documents::{self, Unsaved};
use coif::core::event::Event;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Setting};
use coif_graphs::{file, grooms};
use coif_nodes::data::field::Field;
use coif_nodes::define::Value;
use coif_tests::{Folder, program, run_with};
use egui::{Key, Modifiers};

#[test]
fn anothers_version_is_looked_at_beside_ones_own_and_in_its_place() {
    let folder = Folder::new("compare-story");
    let text = grooms::by_name("cornrows").expect("a shipped groom");
    let mut other = file::read(text).expect("it is valid").document;
    let id = |name: &str| NodeId::new(name).expect("an id");
    let strands = Setting::Known(Value::Int(5));
    let width = Setting::Known(Value::Field(std::sync::Arc::new(Field::Constant(1.6))));
    for edit in [
        Edit::SetInput { node: id("braid"), input: "strands".to_owned(), setting: strands },
        Edit::SetInput { node: id("braid"), input: "width".to_owned(), setting: width },
        Edit::RemoveNode { id: id("partings") },
    ] {
        edit.apply(&mut other).expect("it fits");
    }
    let path = folder.path("ada.ron");
    std::fs::write(&path, file::write(&other)).expect("a file");
    let mut story = Story::begin("compare", Hand::Mouse, &folder);
    let editor = story.ui.state_mut();
    editor.apply(Event::Documents(documents::DocumentEvent::New(Some("cornrows"))));
    editor.apply(Event::Documents(documents::DocumentEvent::Unsaved(Unsaved::Discard)));
    story.sees_hair(1000);
    let before = file::write(&story.ui.state().state.document);
    // The file is chosen in the window's own browser.
    story.ui.state_mut().state.file.folder = path.with_file_name("");
    story.click("File");
    story.click("Compare with…");
    story.click("ada.ron");
    story.click("Open");
    settle(&mut story.ui);
    story.picture("1-side-by-side");
    let compare = story.ui.state().compare().expect("it is there");
    let lines: Vec<&str> = compare.lines().collect();
    assert!(lines.iter().any(|line| line.contains("strands 3 to 5")), "{lines:?}");
    let line = lines.iter().find(|line| line.contains("strands")).expect("it is").to_string();
    story.click(&line);
    story.picture("2-the-braid");
    story.key(Modifiers::NONE, Key::F8);
    settle(&mut story.ui);
    story.picture("3-its-hair");
    story.click("Shown: ada.ron");
    story.click("End");
    story.picture("4-alone");
    assert_eq!(file::write(&story.ui.state().state.document), before);
    assert_eq!(story.ui.state().state.history.done(), 0);
}

#[test]
fn a_groom_that_cannot_be_read_opens_no_window_beside_another() {
    let folder = Folder::new("compare-broken");
    let broken = folder.path("broken.ron");
    std::fs::write(&broken, "(format: 3, nodes: {").expect("a file");
    for (name, said) in [("none.ron", "no such file"), ("broken.ron", "broken.ron:1:")] {
        let other = folder.path(name).display().to_string();
        let ran = run_with(program(), ["edit", "start", "--compare", &other]);
        assert_eq!(ran.code, 2, "{}", ran.err);
        assert!(ran.err.contains(said) && ran.err.contains(name), "{}", ran.err);
    }
}
