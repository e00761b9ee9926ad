//! From the first start to a cornrow that the user drew on their own head: every action counted, by mouse alone and by pen
//! alone, with pictures where they are asked for (`COIF_SHOTS`, a folder).

use super::harness::{Ui, settle};
use coif::editor::Editor;
use coif::editor::documents::places::Places;
use coif::pen::sample::{Device, PenSample, Phase, Tool};
use coif_tests::{Folder, adapter, shared};
use egui::{Event, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::time::{Duration, Instant};

/// The most actions it may take.
const MOST: usize = 15;

#[derive(Clone, Copy, PartialEq)]
enum Hand {
    Mouse,
    Pen,
}

struct Story {
    ui: Ui,
    hand: Hand,
    actions: usize,
    time: f64,
    pictures: bool,
    took: Vec<String>,
}

impl Story {
    /// The first start of all: the start-up groom, and the welcome panel over it.
    fn begin(hand: Hand, home: &Folder, pictures: bool) -> Self {
        let ctx = egui::Context::default();
        let (document, file) = Editor::start_up();
        let mut editor = Editor::new(&ctx, document, file);
        editor.keep_in(&ctx, Places::under(&home.path("home")));
        editor.documents.ask_in_the_window();
        editor.greet();
        if pictures {
            editor.viewport.start(&ctx);
        }
        let mut builder =
            Harness::builder().with_size(egui::vec2(1440.0, 900.0)).with_max_steps(64);
        if pictures {
            builder = builder.wgpu();
        }
        let ui = builder.build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
        coif::editor::theme::apply(&ui.ctx, false);
        Self { ui, hand, actions: 0, time: 0.0, pictures, took: vec![] }
    }

    fn press(&mut self, at: Pos2) {
        for pressed in [true, false] {
            self.ui.event(Event::PointerMoved(at));
            self.ui.step();
            let button = PointerButton::Primary;
            self.ui.event(Event::PointerButton {
                pos: at,
                button,
                pressed,
                modifiers: Modifiers::NONE,
            });
            self.ui.step();
        }
        self.ui.run_steps(2);
    }

    /// Presses what has a name. One action.
    fn click(&mut self, name: &str) {
        // Lists and folders are read on threads of their own.
        let began = Instant::now();
        while self.ui.query_all_by_label(name).next().is_none() {
            let labels = || -> Vec<String> {
                let all = self.ui.query_all(egui_kittest::kittest::By::new());
                all.filter_map(|node| egui_kittest::kittest::NodeT::accesskit_node(&node).label())
                    .collect()
            };
            assert!(began.elapsed() < Duration::from_secs(20), "{name} appears: {:?}", labels());
            std::thread::sleep(Duration::from_millis(10));
            self.ui.step();
        }
        let at = self.ui.query_all_by_label(name).next().map(|node| node.rect().center());
        self.press(at.expect("it is there"));
        self.actions += 1;
        self.took.push(name.to_owned());
    }

    /// Draws a line over the picture, in parts of its size from the middle. One action.
    fn draw(&mut self, places: &[(f32, f32)]) {
        let rect = self.ui.state().viewport.projection().rect;
        let at = |(x, y): (f32, f32)| rect.center() + Vec2::new(x, y) * rect.height();
        let line: Vec<Pos2> = places
            .windows(2)
            .flat_map(|pair| {
                let (a, b) = (at(pair[0]), at(pair[1]));
                (0..12).map(move |k| a.lerp(b, k as f32 / 12.0))
            })
            .collect();
        for (k, pos) in line.iter().enumerate() {
            let (first, last) = (k == 0, k + 1 == line.len());
            match self.hand {
                Hand::Mouse => {
                    self.ui.event(Event::PointerMoved(*pos));
                    if first || last {
                        let button = PointerButton::Primary;
                        let modifiers = Modifiers::NONE;
                        self.ui.event(Event::PointerButton {
                            pos: *pos,
                            button,
                            pressed: first,
                            modifiers,
                        });
                    }
                }
                Hand::Pen => {
                    self.time += 0.01;
                    let phase = match (first, last) {
                        (true, _) => Phase::Down,
                        (_, true) => Phase::Up,
                        _ => Phase::Move,
                    };
                    let pressure =
                        if last { 0.0 } else { 0.3 + 0.6 * k as f32 / line.len() as f32 };
                    let sample = PenSample::mouse(self.time, phase, *pos, pressure);
                    let pen = PenSample { tool: Tool::Tip, device: Device(3), ..sample };
                    self.ui.state_mut().pen.devices.push(pen);
                }
            }
            self.ui.step();
        }
        self.ui.run_steps(2);
        self.actions += 1;
        self.took.push("a row".to_owned());
    }

    /// A picture of the window, where pictures were asked for.
    fn picture(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("COIF_SHOTS").filter(|_| self.pictures) else { return };
        let began = Instant::now();
        while !self.ui.state().viewport.is_idle() && began.elapsed() < Duration::from_secs(60) {
            self.ui.step();
            std::thread::sleep(Duration::from_millis(20));
        }
        let hand = if self.hand == Hand::Pen { "pen" } else { "mouse" };
        let path = std::path::Path::new(&folder).join(format!("own-head-{hand}-{name}.png"));
        self.ui.render().expect("a picture").save(path).expect("it is written");
    }
}

#[test]
fn a_cornrow_on_ones_own_head_takes_few_actions_by_mouse_or_by_pen() {
    const NAME: &str = "a_cornrow_on_ones_own_head_takes_few_actions_by_mouse_or_by_pen";
    let Some(mesh) = shared(NAME, "data/ict_head/generic_neutral_mesh.obj") else { return };
    let pictures = std::env::var_os("COIF_SHOTS").is_some() && adapter(NAME);
    for hand in [Hand::Mouse, Hand::Pen] {
        let home = Folder::new(NAME);
        std::fs::create_dir_all(home.path("heads")).expect("a folder");
        std::fs::copy(&mesh, home.path("heads/my_head.obj")).expect("a head of one's own");
        let mut story = Story::begin(hand, &home, pictures);
        settle(&mut story.ui);
        story.picture("1-start");
        story.click("Empty head");
        // Where one's heads lie: the browser begins there, as it does after the first time.
        story.ui.state_mut().state.file.folder = home.path("heads");
        story.click("File");
        story.click("Own head…");
        story.click("my_head.obj");
        story.click("Open");
        settle(&mut story.ui);
        story.picture("2-head");
        story.click("Accept");
        story.click("Recipes");
        story.click("Cornrows");
        settle(&mut story.ui);
        story.draw(&[(-0.05, -0.34), (0.08, -0.36), (0.16, -0.28)]);
        settle(&mut story.ui);
        story.picture("3-row");
        let state = &story.ui.state().state;
        assert!(state.run.reports.failures().is_empty(), "{:?}", state.run.reports.failures());
        let shown = state.shown.as_ref().expect("hair");
        assert!(shown.is_final() && shown.curves.curve_count() > 100, "{:?}", state.notes.all());
        assert!(story.actions <= MOST, "{} actions: {:?}", story.actions, story.took);
        println!("{} actions: {}", story.actions, story.took.join(", "));
    }
}
