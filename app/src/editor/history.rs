//! The history room: every step in words, the present one marked. A click goes there, and what the step changed is
//! selected.

use super::event::Event;
use super::state::{Select, State};
use super::theme;
use egui::{RichText, ScrollArea};

/// Shows the room.
pub(crate) fn ui(state: &State, ui: &mut egui::Ui, out: &mut Vec<Event>) {
    let done = state.history.done();
    let steps: Vec<_> = state.history.steps().collect();
    ui.horizontal(|ui| {
        for (word, tip, event, can) in [
            ("Undo", "Takes the last step back", Event::Undo, done > 0),
            ("Redo", "Does it again", Event::Redo, done < steps.len()),
        ] {
            if ui.add_enabled(can, egui::Button::new(word)).on_hover_text(tip).clicked() {
                out.push(event);
            }
        }
        ui.label(RichText::new(format!("{done} of {} steps", steps.len())).weak());
    });
    ui.separator();
    let height = ui.spacing().interact_size.y;
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, steps.len() + 1, |ui, rows| {
        for at in rows {
            let words = match at.checked_sub(1).and_then(|at| steps.get(at)) {
                Some(step) => step.words.clone(),
                None => "As it was opened".to_owned(),
            };
            let mark = if at == done { "▶ " } else { "" };
            let mut text = RichText::new(format!("{mark}{words}"));
            if at > done {
                text = text.color(theme::QUIET).italics();
            }
            let line = ui.selectable_label(at == done, text);
            if line.on_hover_text("Goes to the state after this step").clicked() {
                out.push(Event::Jump(at));
                let changed = at.checked_sub(1).and_then(|at| steps.get(at));
                let nodes = changed.map(|step| step.nodes().into_iter().collect());
                out.extend(nodes.map(|nodes| Event::Select(Select::Nodes(nodes))));
            }
        }
    });
}
