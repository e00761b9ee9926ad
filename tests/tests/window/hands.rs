//! A real window on a screen in memory: opened, drawn into, saved, closed and opened again by keys and a mouse.

#![cfg(unix)]

use coif_graphs::document::{Document, Node, NodeId, Point, Setting};
use coif_graphs::file;
use coif_nodes::define::Value;
use coif_tests::screen::{Running, Screen};
use coif_tests::waiting::until;
use coif_tests::{Folder, adapter, eval, program};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

/// A head alone.
fn head() -> Document {
    let id = NodeId::new("head").expect("an id");
    let mut document = Document { title: "Mine".to_owned(), ..Document::default() };
    document
        .nodes
        .insert(id.clone(), Arc::new(Node { kind: "head".to_owned(), ..Node::default() }));
    document.layout.insert(id, Point(0.0, 0.0));
    document
}

fn open(path: &Path, folder: &Folder, screen: &Screen) -> Running {
    let mut editor = program()
        .arg("edit")
        .arg(path)
        .env("DISPLAY", screen.display())
        .env_remove("WAYLAND_DISPLAY")
        .env("COIF_HOME", folder.path("home"))
        .stdout(Stdio::null())
        .spawn()
        .expect("the editor starts");
    screen.focus(&mut editor, "coif");
    Running(editor)
}

/// The screen, once the picture of the viewport has so many colours.
fn wait_for_picture(screen: &Screen, shots: &Path, name: &str, colours: usize) {
    until(&format!("{name}: the viewport shows {colours} colours"), || {
        let shot = screen.shot(&shots.join(format!("window-{name}.png")));
        shot.colours(300..800, 120..480) >= colours
    });
}

fn strokes(path: &Path) -> usize {
    let text = std::fs::read_to_string(path).expect("the file is there");
    let document = file::read(&text).expect("it reads").document;
    let settings = document.nodes.values().flat_map(|node| node.inputs.values());
    settings
        .map(|setting| match setting {
            Setting::Known(Value::Strokes(strokes)) => strokes.0.len(),
            _ => 0,
        })
        .sum()
}

#[test]
fn a_row_is_drawn_braided_saved_and_there_again() {
    const NAME: &str = "a_row_is_drawn_braided_saved_and_there_again";
    if !adapter(NAME) {
        return;
    }
    let Some(screen) = Screen::start(NAME, 1440, 900) else { return };
    let folder = Folder::new(NAME);
    let shots = std::env::var_os("COIF_SHOTS").map_or_else(|| folder.path("shots"), PathBuf::from);
    std::fs::create_dir_all(&shots).expect("a folder");
    let path = folder.path("mine.ron");
    std::fs::write(&path, file::write(&head())).expect("a document is written");

    let mut editor = open(&path, &folder, &screen);
    wait_for_picture(&screen, &shots, "1-head", 400);
    // The palette knows every action by name.
    screen.key("ctrl+k");
    screen.write("cornrows");
    screen.key("Return");
    std::thread::sleep(Duration::from_millis(500));
    screen.drag(1, &[(500, 240), (560, 215), (615, 240)]);
    std::thread::sleep(Duration::from_millis(2000));
    wait_for_picture(&screen, &shots, "2-row", 400);
    until("the row is saved", || {
        screen.key("ctrl+s");
        strokes(&path) > 0
    });
    assert_eq!(strokes(&path), 1, "one row was drawn and saved");
    screen.key("ctrl+q");
    assert_eq!(editor.end(), Some(0), "nothing was unsaved, so it closes");
    let saved = std::fs::read(&path).expect("it is there");

    // What was saved is what the command line evaluates, and what opens again.
    let report = eval(&path.display().to_string(), &[]);
    let curves = report["outputs"][0]["curves"].as_u64().unwrap_or(0);
    assert!(curves > 100, "{curves} strands");
    let mut again = open(&path, &folder, &screen);
    wait_for_picture(&screen, &shots, "3-again", 400);
    screen.key("ctrl+q");
    assert_eq!(again.end(), Some(0));
    assert_eq!(std::fs::read(&path).expect("it is there"), saved, "looking at it changes nothing");
}
