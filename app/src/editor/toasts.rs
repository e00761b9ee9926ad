//! What must be seen: failures and warnings, each with its reason and its remedy, in the corner above the status line; and
//! questions that came up by themselves. None moves anything; all of it is in the messages too.
//!
//! Guarantees: what was said leaves by itself, or when it is put away, and what was said of the groom as soon as that is changed; while the pen draws nothing comes up.

use super::Editor;
use super::documents;
use crate::core::event::Event;
use crate::core::notes::{Gravity, Note};
use crate::core::room::Room;
use crate::core::state::State;
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
    /// The last of it, while that is news: for the status line.
    last: Option<Toast>,
    seen: Vec<Toast>,
    /// Whether a gesture was on.
    gesture: bool,
}

#[derive(Clone)]
struct Toast {
    note: Note,
    /// When it was said, seconds of the window, and after how many changes of the groom: those of the gesture that it was said in count
    /// as before it.
    since: f64,
    changes: u64,
}

impl Toast {
    /// Whether it is still shown: for `lasts` seconds, and a note about the groom only until the groom changes.
    fn is_news(&self, now: f64, changes: u64, lasts: f64) -> bool {
        now - self.since < lasts && !(self.note.of_groom && self.changes != changes)
    }
}

impl Toasts {
    /// What was said last, while that is news.
    pub(crate) fn news(&self) -> Option<&Note> {
        self.last.as_ref().map(|toast| &toast.note)
    }

    fn learn(&mut self, editor: &Editor) {
        let State { notes, now, changes, gesture, .. } = &editor.state;
        let (now, changes) = (*now, *changes);
        let new = notes.count().saturating_sub(self.count);
        if new > 0 {
            self.count = notes.count();
            let all = notes.all();
            let toast = |note: &Note| Toast { note: note.clone(), since: now, changes };
            self.last = all.last().map(toast);
            for note in &all[all.len().saturating_sub(new)..] {
                self.seen.retain(|old| old.note != *note);
                if note.gravity > Gravity::Note {
                    self.seen.push(toast(note));
                }
            }
        }
        // The last change of a gesture comes with its end.
        if std::mem::replace(&mut self.gesture, *gesture) || *gesture {
            self.seen.iter_mut().chain(&mut self.last).for_each(|toast| toast.changes = changes);
        }
        let lasts = |note: &Note| if note.gravity == Gravity::Error { FAILURE } else { WARNING };
        self.seen.retain(|toast| toast.is_news(now, changes, lasts(&toast.note)));
        self.last.take_if(|last| !last.is_news(now, changes, DONE));
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
                    for (at, Toast { note, .. }) in toasts.seen.iter().enumerate().rev() {
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
    if !toasts.seen.is_empty() || toasts.last.is_some() {
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
