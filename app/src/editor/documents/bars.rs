//! Questions that wait for an answer without being in the way, the export that goes on, and the one question that does
//! stand in the way: about unsaved changes.

use super::export::ExportState;
use super::{Disk, DocumentEvent, Documents, Left, Next, Unsaved, journal};
use crate::core::event::Event;
use crate::core::state::State;
use crate::editor::Editor;
use crate::widgets::panel;
use egui::{Panel, ProgressBar};

/// Documents that are offered at once; the others come up when these are dealt with.
const MOST_BARS: usize = 3;

/// The bars that are due.
pub(super) fn show(documents: &Documents, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let more = documents.leftovers.len().saturating_sub(MOST_BARS);
    for (at, left) in documents.leftovers.iter().enumerate().take(MOST_BARS) {
        Panel::top(egui::Id::new(("left", at))).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                let age = ago(journal::now().saturating_sub(left.about.at));
                ui.label(format!("{} was not saved when coif ended {age}.", left.about.name));
                if at + 1 == MOST_BARS && more > 0 {
                    ui.label(format!("There are {more} more."));
                }
                for (word, tip, answer) in [
                    ("Restore", "Open it as it was after the last step", Left::Restore),
                    ("Keep for later", "Offer it again at the next start", Left::Keep),
                    ("Discard", "Delete it for good", Left::Discard),
                ] {
                    if ui.button(word).on_hover_text(tip).clicked() {
                        out.push(Event::Documents(DocumentEvent::Left(at, answer)));
                    }
                }
            });
        });
    }
}

/// The question about a file that others changed.
pub(crate) fn changed(editor: &Editor, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let state = &editor.state;
    if !editor.documents.changed {
        return;
    }
    let lost = match state.history.is_changed() {
        true => " Reloading loses what you have not saved.",
        false => "",
    };
    let text = format!("{} was changed by another program.{lost}", state.file.name());
    ui.add(egui::Label::new(text).wrap());
    ui.horizontal_wrapped(|ui| {
        for (word, tip, answer) in [
            ("Reload", "Open the file as it is now", Disk::Reload),
            ("Keep mine", "Keep your version; saving overwrites the file", Disk::Keep),
            ("Compare", "Show both side by side", Disk::Compare),
        ] {
            if ui.button(word).on_hover_text(tip).clicked() {
                out.push(Event::Documents(DocumentEvent::Disk(answer)));
            }
        }
    });
}

/// The export that goes on, in the status line; whether there is one.
pub(crate) fn export_line(documents: &Documents, ui: &mut egui::Ui, out: &mut Vec<Event>) -> bool {
    let going = documents.exports.going();
    let Some(row) = going.first() else { return false };
    let (doing, (done, of)) = match &row.state {
        ExportState::Runs(doing, done) => (doing.as_str(), *done),
        ExportState::Waits | ExportState::Ended(_) => ("", (0, 0)),
    };
    let name = row.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stop = ui.button("Stop export").on_hover_text("Nothing is written");
    if stop.clicked() {
        out.push(Event::Documents(DocumentEvent::StopExport));
    }
    let part = if of == 0 { 0.0 } else { done as f32 / of as f32 };
    ui.add(ProgressBar::new(part).desired_width(120.0));
    let wait = match going.len() - 1 {
        0 => String::new(),
        n => format!(" ({n} more to write)"),
    };
    let text = format!("writing {name}: {doing}{wait}");
    let line = ui.add(egui::Label::new(text).truncate());
    line.on_hover_text(row.path.display().to_string());
    true
}

/// What a file that hangs over the window would do.
pub(super) fn hovering(ctx: &egui::Context) {
    let hovers = ctx.input(|input| !input.raw.hovered_files.is_empty());
    if hovers {
        egui::Area::new("hovering".into())
            .order(egui::Order::Tooltip)
            .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
            .show(ctx, |ui| {
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    ui.heading("Drop a groom to open it, a mesh to grow hair on it, or an .hdr or .exr to light it");
                });
            });
    }
}

/// The question about unsaved changes.
pub(super) fn unsaved(
    documents: &Documents,
    state: &State,
    name: &str,
    ctx: &egui::Context,
    out: &mut Vec<Event>,
) {
    if documents.unsaved.is_none() {
        return;
    }
    let ask = |ui: &mut egui::Ui| {
        let changed = state.history.is_changed();
        if changed {
            ui.heading(format!("Save the changes of {name}?"));
            ui.label("What is not saved is lost.");
        } else {
            ui.heading("Close while an export goes on?");
        }
        if documents.exports.is_going() && documents.unsaved == Some(Next::Close) {
            ui.label("Closing stops the export; nothing of it is written.");
        }
        ui.add_space(8.0);
        let mut answer = None;
        ui.horizontal(|ui| {
            let answers: &[_] = if changed {
                &[
                    ("Save", "Saves first", Unsaved::Save),
                    ("Discard", "Continue without saving", Unsaved::Discard),
                    ("Cancel", "Go back to the document", Unsaved::Cancel),
                ]
            } else {
                &[
                    ("Close", "Stop the export", Unsaved::Discard),
                    ("Cancel", "Go back to the document", Unsaved::Cancel),
                ]
            };
            for (word, tip, what) in answers.iter().copied() {
                if ui.button(word).on_hover_text(tip).clicked() {
                    answer = Some(what);
                }
            }
        });
        answer
    };
    let modal = egui::Modal::new(panel::id("unsaved", ctx)).show(ctx, |ui| {
        ui.set_max_width(340.0_f32.min(panel::room(ctx).width() - 40.0).max(24.0));
        panel::body(ui, 200.0, ask)
    });
    let closed = modal.should_close().then_some(Unsaved::Cancel);
    if let Some(answer) = modal.inner.or(closed) {
        out.push(Event::Documents(DocumentEvent::Unsaved(answer)));
    }
}

/// How long something is ago, in words.
fn ago(seconds: u64) -> String {
    let said = |n: u64, one: &str| {
        let s = if n == 1 { "" } else { "s" };
        format!("{n} {one}{s} ago")
    };
    match seconds {
        0..60 => "just now".to_owned(),
        60..3600 => said(seconds / 60, "minute"),
        3600..86_400 => said(seconds / 3600, "hour"),
        _ => said(seconds / 86_400, "day"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_said_in_the_largest_unit() {
        let said: Vec<String> = [3, 60, 7300, 86_400 * 3].map(ago).into();
        assert_eq!(said, ["just now", "1 minute ago", "2 hours ago", "3 days ago"]);
    }
}
