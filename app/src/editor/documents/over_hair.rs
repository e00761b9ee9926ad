//! What is asked before a head of one's own comes under hair that is there: whether that hair stays.

use crate::core::documents::DocumentEvent;
use crate::core::event::Event;
use crate::widgets::panel;
use std::path::{Path, PathBuf};

/// The question's name among windows.
pub(in crate::editor) const PANEL: &str = "own head over hair";

/// Shows it; gives the event of the answer, and whether it is still open.
pub(super) fn window(path: &Path, ctx: &egui::Context, out: &mut Vec<Event>) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (mut open, mut cancel, mut answer) = (true, false, None);
    panel::window("Own head", PANEL, ctx)
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(panel::room(ctx).center())
        .show(ctx, |ui| {
            panel::body(ui, 280.0, |ui| {
                ui.label(format!("{name} becomes the head. There is hair on this one."));
                ui.horizontal_wrapped(|ui| {
                    let tip = "Remove the hair that is there: a bald head to begin on.";
                    if ui.button("Instead of the hair").on_hover_text(tip).clicked() {
                        answer = Some(true);
                    }
                    let tip = "Keep the hair: it grows on the new head.";
                    if ui.button("With the hair").on_hover_text(tip).clicked() {
                        answer = Some(false);
                    }
                    cancel = ui.button("Not now").clicked();
                });
            });
        });
    let event = |bald| DocumentEvent::MeshOver { path: PathBuf::from(path), bald };
    out.extend(answer.map(|bald| Event::Documents(event(bald))));
    open && !cancel && answer.is_none()
}
