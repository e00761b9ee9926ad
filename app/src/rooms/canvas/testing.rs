//! Grooms for tests of the canvas, and the room on a desk of its own: what it says is applied, nothing
//! is evaluated.

use super::Canvas;
use crate::core::event::Event;
use crate::core::faces::Faces;
use crate::core::settings::Settings;
use crate::core::shown::Reports;
use crate::core::state::{OpenFile, State};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_graphs::{file, grooms};
use egui::{Modifiers, PointerButton, Pos2, Rect, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::collections::BTreeSet;

pub(crate) fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
pub(crate) fn socket(text: &str) -> Socket {
    text.parse().unwrap()
}
/// A shipped groom.
pub(crate) fn document(name: &str) -> Document {
    file::read(grooms::by_name(name).unwrap()).unwrap().document
}
pub(crate) fn faces(document: &Document) -> Faces {
    Faces::new(document, &Reports::default(), &BTreeSet::new(), None, None)
}

/// The room and a state.
pub(crate) struct Desk {
    pub state: State,
    pub canvas: Canvas,
    pub said: Vec<String>,
    pub steps: usize,
}

impl Desk {
    fn ui(&mut self, ui: &mut egui::Ui) {
        let mut out = vec![];
        self.canvas.ui(&self.state, ui, &mut out);
        for event in out {
            self.apply(event);
        }
    }

    pub(crate) fn apply(&mut self, event: Event) {
        let state = &mut self.state;
        match event {
            Event::Edit(edit) | Event::Nudge(edit) => {
                match state.history.edit(&mut state.document, &edit) {
                    Ok(()) => self.steps += 1,
                    Err(why) => self.said.push(why.to_string()),
                }
            }
            Event::Select(select) => state.selection.change(select),
            Event::Display(node) => {
                Edit::SetDisplay(node).apply(&mut state.document).unwrap();
            }
            Event::Pin(node) => state.pinned = node,
            Event::Say(note) => self.said.push(note.text),
            Event::Enter(group) => state.group = group,
            Event::Begin(_) | Event::End => {}
            Event::Act(id) => self.said.push(format!("act {id}")),
            other => panic!("not expected of the canvas: {other:?}"),
        }
        state.keep();
    }
}

/// The room in a window.
pub(crate) type Window = Harness<'static, Desk>;

/// The room on a document.
pub(crate) fn window(document: Document) -> Window {
    sized(document, Vec2::new(1280.0, 640.0))
}

pub(crate) fn sized(document: Document, size: Vec2) -> Window {
    let mut state = State::new(document, OpenFile::default(), Settings::default(), |_| None);
    state.focus = crate::core::room::Room::Canvas;
    let desk = Desk { state, canvas: Canvas::default(), said: vec![], steps: 0 };
    let mut window = Harness::builder()
        .with_size(size)
        .with_max_steps(64)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, desk: &mut Desk| desk.ui(ui), desk);
    crate::widgets::theme::apply(&window.ctx, egui::Theme::Dark, false);
    window.run_steps(3);
    window
}

/// Where something with this name is on the screen.
#[track_caller]
pub(crate) fn place(window: &Window, name: &str) -> Pos2 {
    let local: Rect = window.get_by_label(name).rect();
    window.state().canvas.to_screen(local.center())
}

/// Presses at the first place, goes through the others in small steps, and lets go at the last.
pub(crate) fn drag(window: &mut Window, places: &[Pos2], modifiers: Modifiers) {
    hold(window, places, modifiers);
    release(window, *places.last().unwrap(), modifiers);
}

/// The same without letting go.
pub(crate) fn hold(window: &mut Window, places: &[Pos2], modifiers: Modifiers) {
    window.event(egui::Event::ModifiersChanged(modifiers));
    window.event(egui::Event::PointerMoved(places[0]));
    window.run_steps(2);
    window.event(button(places[0], true, modifiers));
    window.run_steps(1);
    for pair in places.windows(2) {
        for step in 1..=4 {
            let at = pair[0] + (pair[1] - pair[0]) * (step as f32 / 4.0);
            window.event(egui::Event::PointerMoved(at));
            window.run_steps(1);
        }
    }
    window.run_steps(1);
}

pub(crate) fn release(window: &mut Window, at: Pos2, modifiers: Modifiers) {
    window.event(button(at, false, modifiers));
    window.run_steps(1);
    window.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    window.run_steps(2);
}

pub(crate) fn button(pos: Pos2, pressed: bool, modifiers: Modifiers) -> egui::Event {
    egui::Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers }
}

/// Clicks at a place, so many times quickly.
pub(crate) fn click(window: &mut Window, at: Pos2, times: usize) {
    window.event(egui::Event::PointerMoved(at));
    window.run_steps(2);
    for _ in 0..times {
        window.event(button(at, true, Modifiers::NONE));
        window.event(button(at, false, Modifiers::NONE));
        window.run_steps(1);
    }
    window.run_steps(2);
}
