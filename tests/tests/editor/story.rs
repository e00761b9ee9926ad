//! A person at work, every action counted, by mouse or by pen, with pictures where they are asked for (`COIF_SHOTS`, a folder).

use super::harness::{Ui, settle};
use coif::core::room::Room;
use coif::editor::Editor;
use coif::places::Places;
use coif::rooms::pen::sample::{Device, PenSample, Phase, Tool};
use coif_tests::waiting::until;
use coif_tests::{Folder, adapter};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

/// What a person holds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Hand {
    Mouse,
    Pen,
}

/// Somebody at the editor.
pub(crate) struct Story {
    pub(crate) ui: Ui,
    /// What it is called in the names of pictures.
    name: &'static str,
    hand: Hand,
    pub(crate) actions: usize,
    time: f64,
    pictures: bool,
    pub(crate) took: Vec<String>,
}

impl Story {
    /// The first start of all: the start-up groom, and the welcome panel over it.
    pub(crate) fn begin(name: &'static str, hand: Hand, home: &Folder) -> Self {
        let pictures = std::env::var_os("COIF_SHOTS").is_some() && adapter(name);
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
        coif::widgets::theme::apply(&ui.ctx, egui::Theme::Dark, false);
        Self { ui, name, hand, actions: 0, time: 0.0, pictures, took: vec![] }
    }

    pub(crate) fn press(&mut self, at: Pos2) {
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
    pub(crate) fn click(&mut self, name: &str) {
        // Lists and folders are read on threads of their own.
        until(&format!("{name} appears"), || {
            self.ui.step();
            self.ui.query_all_by_label(name).next().is_some()
        });
        let at = self.ui.query_all_by_label(name).next().map(|node| node.rect().center());
        self.press(at.expect("it is there"));
        self.did(name.to_owned());
    }

    /// Draws a line over the picture, in parts of its size from the middle. One action.
    pub(crate) fn draw(&mut self, places: &[(f32, f32)]) {
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
        self.did("a row".to_owned());
    }

    /// Drags what has a name by so many points. One action.
    pub(crate) fn drag(&mut self, name: &str, by: Vec2) {
        let found = self.ui.query_all_by_label(name).next().map(|node| node.rect().center());
        let from = found.unwrap_or_else(|| panic!("{name} is there"));
        let button = |pos, pressed| {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            Event::PointerButton { pos, button, pressed, modifiers }
        };
        self.ui.event(Event::PointerMoved(from));
        self.ui.step();
        self.ui.event(button(from, true));
        self.ui.step();
        for k in 1..=10 {
            self.ui.event(Event::PointerMoved(from + by * (k as f32 / 10.0)));
            self.ui.step();
        }
        self.ui.event(button(from + by, false));
        self.ui.run_steps(2);
        self.did(format!("drag {name}"));
    }

    /// Presses a key where the pointer is. One action.
    pub(crate) fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.ui.key_press_modifiers(modifiers, key);
        self.ui.run_steps(3);
        self.did(format!("{key:?}"));
    }

    /// Rests the pointer over a room; nothing is pressed, and it counts as no action.
    pub(crate) fn over(&mut self, room: Room) {
        let place = self.ui.state().place_of(room).expect("the room is there");
        self.ui.event(Event::PointerMoved(place.center()));
        self.ui.run_steps(2);
    }

    /// Types into what has the keys. One action.
    pub(crate) fn write(&mut self, text: &str) {
        self.ui.event(Event::Text(text.to_owned()));
        self.ui.run_steps(3);
        self.did(format!("type {text}"));
    }

    fn did(&mut self, what: String) {
        self.actions += 1;
        self.took.push(what);
    }

    /// Waits for the hair, which is final, without failures, and at least so much.
    #[track_caller]
    pub(crate) fn sees_hair(&mut self, least: usize) {
        settle(&mut self.ui);
        self.sees_the_picture();
        let state = &self.ui.state().state;
        let failures = state.run.reports.failures();
        assert!(failures.is_empty(), "{failures:?}");
        let shown = state.shown.as_ref().expect("hair");
        let count = shown.curves.curve_count();
        assert!(shown.is_final() && count >= least, "{count}: {:?}", state.notes.all());
    }

    /// Waits until a view that flies to another place has arrived, and its picture is at rest.
    fn sees_the_picture(&mut self) {
        until("the viewport rests", || {
            self.ui.step();
            self.ui.state().viewport.is_idle()
        });
    }

    /// A picture of the window, where pictures were asked for.
    pub(crate) fn picture(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("COIF_SHOTS").filter(|_| self.pictures) else { return };
        self.sees_the_picture();
        let hand = if self.hand == Hand::Pen { "pen" } else { "mouse" };
        let path = std::path::Path::new(&folder).join(format!("{}-{hand}-{name}.png", self.name));
        self.ui.render().expect("a picture").save(path).expect("it is written");
    }
}
