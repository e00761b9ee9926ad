//! What must be seen: failures and warnings, each with its reason and its remedy, in the corner above the status line; and
//! questions that came up by themselves. None moves anything; all of it is in the messages too.
//!
//! Guarantees: what was said leaves by itself, or when it is put away; while the pen draws nothing comes up.

use super::Editor;
use super::documents;
use crate::core::event::Event;
use crate::core::notes::{Gravity, Note};
use crate::core::room::Room;
use crate::widgets::panel;
use egui::{Align2, Area, Context, Frame, Id, Label, Order, ScrollArea};
use std::time::Duration;

/// How long a warning, a failure and what was done stay, seconds.
const WARNING: f64 = 10.0;
const FAILURE: f64 = 20.0;
const DONE: f64 = 12.0;
/// As many are seen at once.
const MOST: usize = 4;
const WIDTH: f32 = 340.0;

/// What is seen of what was said.
#[derive(Default)]
pub(crate) struct Toasts {
    /// How much had been said.
    count: usize,
    /// When the last of it was said, seconds of the window.
    last: f64,
    seen: Vec<(Note, f64)>,
}

impl Toasts {
    /// Whether what was said last is news still.
    pub(crate) fn is_news(&self, now: f64) -> bool {
        now - self.last < DONE
    }

    fn learn(&mut self, editor: &Editor) {
        let (notes, now) = (&editor.state.notes, editor.state.now);
        let new = notes.count().saturating_sub(self.count);
        if new > 0 {
            (self.count, self.last) = (notes.count(), now);
            let all = notes.all();
            for note in &all[all.len().saturating_sub(new)..] {
                self.seen.retain(|(old, _)| old != note);
                if note.gravity > Gravity::Note {
                    self.seen.push((note.clone(), now));
                }
            }
        }
        let lasts = |note: &Note| if note.gravity == Gravity::Error { FAILURE } else { WARNING };
        self.seen.retain(|(note, since)| now - since < lasts(note));
        let over = self.seen.len().saturating_sub(MOST);
        self.seen.drain(..over);
    }
}

/// Shows what there is.
pub(super) fn ui(editor: &mut Editor, ctx: &Context) {
    let mut toasts = std::mem::take(&mut editor.toasts);
    toasts.learn(editor);
    let mut out = vec![];
    let waits = editor.pen.is_drawing();
    let asks = editor.documents.is_changed_on_disk();
    if !waits && (asks || !toasts.seen.is_empty()) {
        let room = panel::room(ctx);
        Area::new(Id::new("toasts"))
            .order(Order::Middle)
            .pivot(Align2::RIGHT_BOTTOM)
            .fixed_pos(room.right_bottom() - egui::vec2(8.0, 8.0))
            .constrain_to(room)
            .show(ctx, |ui| {
                ui.set_width(WIDTH.min(room.width() - 16.0));
                // More than a small window has room for scrolls.
                let most = (room.height() - 20.0).max(16.0);
                ui.set_max_height(most);
                let area = ScrollArea::vertical().max_height(most).min_scrolled_height(16.0);
                area.show(ui, |ui| {
                    // The newest on top: what is pressed below it stays where it is.
                    let mut away = None;
                    for (at, (note, _)) in toasts.seen.iter().enumerate().rev() {
                        if toast(note, ui, &mut out) {
                            away = Some(at);
                        }
                    }
                    away.map(|at| toasts.seen.remove(at));
                    if asks {
                        Frame::popup(ui.style())
                            .show(ui, |ui| documents::changed(editor, ui, &mut out));
                    }
                });
            });
    }
    if !toasts.seen.is_empty() || toasts.is_news(editor.state.now) {
        ctx.request_repaint_after(Duration::from_millis(500));
    }
    editor.toasts = toasts;
    for event in out {
        editor.apply(event);
    }
}

/// One of them; whether it was put away.
fn toast(note: &Note, ui: &mut egui::Ui, out: &mut Vec<Event>) -> bool {
    let mut away = false;
    Frame::popup(ui.style()).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            note.gravity.mark(ui);
            ui.vertical(|ui| {
                ui.add(Label::new(&note.text).wrap());
                ui.horizontal(|ui| {
                    let tip = "It stays in Messages.";
                    away = ui.small_button("Put away").on_hover_text(tip).clicked();
                    if ui.small_button("Messages").on_hover_text("Show all messages").clicked() {
                        out.push(Event::Show(Room::Messages));
                    }
                });
            });
        });
    });
    away
}
