//! A pen with pressure through a real X server, into the window, into the document, into its file.

#![cfg(unix)]

use coif_graphs::document::{Document, Node, NodeId, Point, Setting, Socket};
use coif_graphs::file;
use coif_nodes::data::gestures::{Gestures, Layer, Tool};
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::Value;
use coif_tests::tablet::Tablet;
use coif_tests::waiting::until;
use coif_tests::{Folder, adapter, program};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::time::Duration;

/// Looks at the screen after a tap, before another tap.
const LOOKS: usize = 30;

/// A head, and a stroke input on it that is displayed.
fn document() -> Document {
    let mut document = Document::default();
    let id = |text: &str| NodeId::new(text).expect("an id");
    for (name, kind, x) in [("head", "head", 0.0), ("rows", "stroke_input", 260.0)] {
        let node = Node { kind: kind.to_owned(), ..Node::default() };
        document.nodes.insert(id(name), Arc::new(node));
        document.layout.insert(id(name), Point(x, 0.0));
    }
    let (from, to) = (Socket::new(id("head"), "scalp"), Socket::new(id("rows"), "scalp"));
    document.links.insert(to, vec![from]);
    document.display = Some(id("rows"));
    document
}

fn strokes(path: &Path) -> Arc<Strokes> {
    let text = std::fs::read_to_string(path).expect("the file is there");
    let document = file::read(&text).expect("it reads").document;
    let input = document.node("rows").and_then(|node| node.inputs.get("strokes").cloned());
    match input {
        Some(Setting::Known(Value::Strokes(strokes))) => strokes,
        _ => Arc::default(),
    }
}

/// Between two looks at a screen that is to rest.
const A_WHILE: Duration = Duration::from_millis(1000);

/// Waits until nothing on the screen changes any more.
fn settled(tablet: &Tablet, folder: &Folder) {
    let mut before = vec![];
    until("nothing moves", || {
        let shot = tablet.screen.shot(&folder.path("settled.png")).rgb;
        if shot == before {
            return true;
        }
        before = shot;
        std::thread::sleep(A_WHILE);
        false
    });
}

/// Opens the window on a file, and waits for its picture.
fn edit(tablet: &Tablet, folder: &Folder, path: &Path) -> Child {
    // One sample a pixel: the picture is soon at rest, and the machine free for the window.
    std::fs::create_dir_all(folder.path("home")).expect("a folder");
    std::fs::write(folder.path("home/settings.ron"), "(samples: 1)").expect("settings are written");
    let mut editor = program()
        .args(["edit", &path.display().to_string()])
        .env("DISPLAY", tablet.screen.display())
        .env_remove("WAYLAND_DISPLAY")
        .env("COIF_HOME", folder.path("home"))
        .stdout(Stdio::null())
        .spawn()
        .expect("the editor starts");
    tablet.screen.focus(&mut editor, "coif");
    // The head is there when its picture is.
    settled(tablet, folder);
    editor
}

#[test]
fn a_pen_at_an_x_server_draws_with_three_pressures() {
    const NAME: &str = "a_pen_at_an_x_server_draws_with_three_pressures";
    if !adapter(NAME) {
        return;
    }
    let Some(mut tablet) = Tablet::start(NAME) else { return };
    let folder = Folder::new(NAME);
    let path = folder.path("pen.ron");
    std::fs::write(&path, file::write(&document())).expect("a document is written");
    let mut editor = edit(&tablet, &folder, &path);
    // A tap on the first menu opens it: pens work on ordinary widgets. A tap elsewhere closes it.
    let closed = tablet.screen.shot(&folder.path("closed.png"));
    let under_it = 3 * 1440 * 30..3 * 1440 * 130;
    let opens = |tablet: &mut Tablet| {
        tablet.tap(20.0, 14.0);
        (0..LOOKS).any(|_| {
            let open = tablet.screen.shot(&folder.path("open.png"));
            let pairs = closed.rgb[under_it.clone()].iter().zip(&open.rgb[under_it.clone()]);
            pairs.filter(|(a, b)| a.abs_diff(**b) > 16).count() > 3000
        })
    };
    until("a menu opens under the pen", || opens(&mut tablet));
    tablet.tap(1000.0, 888.0);
    tablet.screen.key("p");
    // Across the viewport, over the crown: light, middle, full.
    let levels = [0.25, 0.5, 1.0];
    let place = |k: u32| (440.0 + 3.0 * f64::from(k), 215.0, levels[(k / 20) as usize]);
    let places: Vec<(f64, f64, f64)> = (0..60).map(place).collect();
    tablet.draw(&places);
    settled(&tablet, &folder);
    if let Some(shot) = std::env::var_os("COIF_SHOTS") {
        tablet.screen.shot(&Path::new(&shot).join("pen.png"));
    }
    until("the stroke is saved", || {
        tablet.screen.key("ctrl+s");
        !strokes(&path).0.is_empty()
    });
    let _ = editor.kill();
    let _ = editor.wait();
    let strokes = strokes(&path);
    assert_eq!(strokes.0.len(), 1, "one stroke, and nothing by the pointer that the pen moves");
    let told: BTreeSet<i32> =
        strokes.0[0].samples.iter().map(|s| (s.pressure * 100.0).round() as i32).collect();
    for level in levels {
        let level = (level * 100.0) as i32;
        assert!(told.iter().any(|p| (p - level).abs() <= 2), "{level} of {told:?}");
    }
}

/// A head, and a hair sketch on it that is displayed.
fn bare() -> Document {
    let mut document = document();
    document.layout.clear();
    let id = |text: &str| NodeId::new(text).expect("an id");
    let node = Node { kind: "hair_sketch".to_owned(), ..Node::default() };
    document.nodes.remove("rows");
    document.nodes.insert(id("sketch"), Arc::new(node));
    let (from, to) = (Socket::new(id("head"), "scalp"), Socket::new(id("sketch"), "scalp"));
    document.links = [(to, vec![from])].into();
    document.display = Some(id("sketch"));
    document
}

fn gestures(path: &Path) -> Arc<Gestures> {
    let text = std::fs::read_to_string(path).expect("the file is there");
    let document = file::read(&text).expect("it reads").document;
    let input = document.node("sketch").and_then(|node| node.inputs.get("gestures").cloned());
    match input {
        Some(Setting::Known(Value::Gestures(gestures))) => gestures,
        _ => Arc::default(),
    }
}

#[test]
fn a_pen_at_an_x_server_sketches_hair_with_both_its_ends() {
    const NAME: &str = "a_pen_at_an_x_server_sketches_hair_with_both_its_ends";
    if !adapter(NAME) {
        return;
    }
    let Some(mut tablet) = Tablet::start(NAME) else { return };
    let folder = Folder::new(NAME);
    let path = folder.path("sketch.ron");
    std::fs::write(&path, file::write(&bare())).expect("a document is written");
    let mut editor = edit(&tablet, &folder, &path);
    tablet.tap(1000.0, 888.0);
    tablet.screen.key("h");
    // Down the side of the head that is seen; everything else happens near its root.
    let (x, y) = (565.0, 235.0);
    let (light, middle, heavy) = (0.2, 0.5, 0.9);
    let line = |from: (f64, f64), to: (f64, f64), pressure: f64| -> Vec<(f64, f64, f64)> {
        let at = |k: i32| {
            let t = f64::from(k) / 40.0;
            (from.0 + (to.0 - from.0) * t, from.1 + (to.1 - from.1) * t, pressure)
        };
        (0..=40).map(at).collect()
    };
    // Whole turns about a place that moves down; the circle of the eraser stays.
    let turns = |middle: (f64, f64), radius: f64, count: i32, down: f64| {
        let at = |k: i32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 40.0).sin_cos();
            (middle.0 + radius * cos, middle.1 + radius * sin + down * f64::from(k), light)
        };
        (0..=40 * count).map(at).collect::<Vec<_>>()
    };
    let saw = |k: i32| {
        let swing = f64::from(((k % 24) - 12).abs()) / 6.0 - 1.0;
        (x + 14.0 + 45.0 * swing, y + 18.0 + 0.15 * f64::from(k), light)
    };
    let tap = [(x + 3.0, y + 6.0, middle), (x + 3.0, y + 6.0, middle)];
    tablet.draw(&line((x, y), (x + 45.0, y + 150.0), heavy));
    settled(&tablet, &folder);
    tablet.draw(&line((x + 10.0, y + 50.0), (x + 60.0, y + 60.0), middle));
    std::thread::sleep(A_WHILE);
    for _ in 0..2 {
        tablet.draw(&tap);
    }
    std::thread::sleep(A_WHILE);
    tablet.draw(&(0..=140).map(saw).collect::<Vec<_>>());
    if let Some(shot) = std::env::var_os("COIF_SHOTS") {
        std::thread::sleep(A_WHILE);
        tablet.screen.shot(&Path::new(&shot).join("frizz.png"));
    }
    // Round the root, from which hair leads out of every turn wherever it was combed to.
    tablet.draw(&turns((x + 2.0, y + 12.0), 16.0, 3, 0.15));
    tablet.turn(true);
    tablet.draw(&turns((x + 8.0, y + 25.0), 50.0, 2, 0.0));
    tablet.draw(&line((x - 60.0, y + 70.0), (x + 90.0, y + 78.0), middle));
    settled(&tablet, &folder);
    if let Some(shot) = std::env::var_os("COIF_SHOTS") {
        tablet.screen.shot(&Path::new(&shot).join("sketch.png"));
    }
    until("all seven are saved", || {
        tablet.screen.key("ctrl+s");
        gestures(&path).0.len() >= 7
    });
    let _ = editor.kill();
    let _ = editor.wait();
    let gestures = gestures(&path);
    let told: Vec<(Tool, Layer)> = gestures.0.iter().map(|one| (one.tool, one.layer)).collect();
    assert_eq!(
        told,
        [
            (Tool::Implant, Layer::Scalp),
            (Tool::Comb, Layer::Through),
            (Tool::Pin, Layer::Through),
            (Tool::Frizz, Layer::Nearest),
            (Tool::Twist, Layer::Nearest),
            (Tool::Density, Layer::Nearest),
            (Tool::Cut, Layer::Through),
        ]
    );
    // Each knows whom it changed, so a farm makes the same of it.
    assert!(gestures.0[1..].iter().all(|one| one.curves.len() == 1));
}
