//! Actions.

use crate::core::event::Event;
use egui::Ui;

/// Actions of the table by their ids, as entries of a menu; empty ones part them.
pub(crate) fn menu(ui: &mut Ui, ids: &[&str], out: &mut Vec<Event>) {
    for id in ids {
        if id.is_empty() {
            ui.separator();
            continue;
        }
        let Some(action) = crate::editor::actions::by_id(id) else { continue };
        if ui.button(action.label).on_hover_text(action.tip).clicked() {
            out.push(Event::Act(action.id));
            ui.close();
        }
    }
}
