//! A slider of cornrows under a hand, in the whole editor with its picture: how soon new hair is on the device, and how soon
//! the picture of it is on the screen, at 960 x 600 points. Also what a frame costs the window's own thread meanwhile.

use coif::core::event::Event;
use coif::core::state::OpenFile;
use coif::editor::Editor;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Setting, Socket};
use coif_graphs::{file, grooms};
use coif_nodes::define::Value;
use cpu_time::ThreadTime;
use egui_kittest::Harness;
use std::time::{Duration, Instant};

/// A slider and the ends between which it is dragged.
const SLIDERS: &[(&str, f32, f32)] = &[
    ("fill.frizz", 0.0, 0.3),
    ("braid.flare", -0.8, 0.0),
    ("braid.tie", 0.8, 0.98),
    ("colour.melanin_root", 0.3, 0.97),
    ("partings.parting_width", 0.05, 0.5),
    ("rows.smoothing", 0.1, 1.0),
];
/// Steps of a drag.
const STEPS: usize = 12;

fn main() {
    let text = grooms::by_name("cornrows").expect("a shipped groom");
    let document = file::read(text).expect("it reads").document;
    let ctx = egui::Context::default();
    let mut editor = Editor::new(&ctx, document, OpenFile::default());
    editor.viewport.start(&ctx);
    let mut ui = Harness::builder()
        .with_size(egui::vec2(1300.0, 1090.0))
        .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
    let began = Instant::now();
    while !(ui.state().is_idle() && ui.state().viewport.stats.newest.is_some()) {
        ui.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    println!("first final picture after {:.2} s", began.elapsed().as_secs_f64());
    let rect = ui.state().viewport.projection().rect;
    println!("viewport {:.0} x {:.0} points", rect.width(), rect.height());
    let mut frames: Vec<Duration> = vec![];
    for (socket, from, to) in SLIDERS {
        let socket: Socket = socket.parse().expect("NODE.INPUT");
        ui.state_mut().apply(Event::Begin(String::new()));
        let (mut uploads, mut pictures) = (vec![], vec![]);
        for k in 0..STEPS {
            let value = from + (to - from) * (k as f32 + 0.5) / STEPS as f32;
            let setting = Setting::Known(Value::Float(value));
            let (node, input) = (socket.node.clone(), socket.name.to_string());
            let moved = Instant::now();
            ui.state_mut().apply(Event::Edit(Edit::SetInput { node, input, setting }));
            let revision = ui.state().state.revision;
            loop {
                let frame = ThreadTime::now();
                ui.step();
                frames.push(frame.elapsed());
                match ui.state().viewport.stats.newest {
                    Some((of, uploaded, drawn)) if of == revision => {
                        uploads.push((uploaded - moved).as_secs_f64() * 1e3);
                        pictures.push((drawn - moved).as_secs_f64() * 1e3);
                        break;
                    }
                    _ => assert!(moved.elapsed() < Duration::from_secs(60), "{socket}: no picture"),
                }
                std::thread::sleep(Duration::from_millis(2));
            }
        }
        ui.state_mut().apply(Event::Abort);
        let median = |times: &mut Vec<f64>| {
            times.sort_by(f64::total_cmp);
            (times[times.len() / 2], times[times.len() - 1])
        };
        let ((upload, worst_upload), (picture, worst_picture)) =
            (median(&mut uploads), median(&mut pictures));
        println!(
            "cornrows {socket}: hair on the device {upload:.0} ms median, {worst_upload:.0} worst; picture {picture:.0} ms median, {worst_picture:.0} worst"
        );
    }
    frames.sort();
    println!(
        "frames of the window's thread: {}, median {:.2?}, 99 % {:.2?}, worst {:.2?} CPU",
        frames.len(),
        frames[frames.len() / 2],
        frames[(frames.len() - 1) * 99 / 100],
        frames[frames.len() - 1]
    );
}
