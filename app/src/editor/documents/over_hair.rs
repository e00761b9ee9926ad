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
    let text = format!("{name} becomes the head. There is hair on this one.");
    let answers = [
        ("Instead of the hair", "Remove the hair that is there: a bald head to begin on."),
        ("With the hair", "Keep the hair: it grows on the new head."),
    ];
    let answered = panel::question("Own head", PANEL, &text, &answers, ctx);
    if let Some(Some(answer)) = answered {
        let (path, bald) = (PathBuf::from(path), answer == 0);
        out.push(Event::Documents(DocumentEvent::MeshOver { path, bald }));
    }
    answered.is_none()
}
