//! A pen with pressure through a real X server, into the window, into the document, into its file.

#![cfg(unix)]

use coif_graphs::document::{Document, Node, NodeId, Point, Setting, Socket};
use coif_graphs::file;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::Value;
use coif_tests::tablet::Tablet;
use coif_tests::{Folder, adapter, program};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Stdio;
use std::sync::Arc;
use std::time::{Duration, Instant};

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

/// Waits until nothing on the screen has changed for a second.
fn settled(tablet: &Tablet, folder: &Folder) {
    let began = Instant::now();
    let mut before = vec![];
    while began.elapsed() < Duration::from_secs(60) {
        let shot = tablet.screen.shot(&folder.path("settled.png")).rgb;
        if shot == before {
            return;
        }
        before = shot;
        std::thread::sleep(Duration::from_secs(1));
    }
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
    tablet.screen.focus("coif");
    // The head is there when its picture is.
    settled(&tablet, &folder);
    // A tap on the first menu opens it: pens work on ordinary widgets. A tap elsewhere closes it.
    let closed = tablet.screen.shot(&folder.path("closed.png"));
    let under_it = 3 * 1440 * 30..3 * 1440 * 130;
    let opens = |tablet: &mut Tablet| {
        tablet.tap(20.0, 14.0);
        let began = Instant::now();
        while began.elapsed() < Duration::from_secs(6) {
            let open = tablet.screen.shot(&folder.path("open.png"));
            let pairs = closed.rgb[under_it.clone()].iter().zip(&open.rgb[under_it.clone()]);
            if pairs.filter(|(a, b)| a.abs_diff(**b) > 16).count() > 3000 {
                return true;
            }
        }
        false
    };
    assert!((0..3).any(|_| opens(&mut tablet)), "a menu opens under the pen");
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
    tablet.screen.key("ctrl+s");
    let began = Instant::now();
    while strokes(&path).0.is_empty() && began.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(100));
    }
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
