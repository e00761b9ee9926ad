//! What the right button offers on nodes and on the empty canvas: actions of the table, by their
//! names.

use crate::editor::actions;
use crate::editor::event::Event;
use crate::editor::panel;
use egui::Response;

/// Actions on nodes; empty lines part them.
const NODE: &[&str] = &[
    "node.display",
    "node.bypass",
    "node.solo",
    "node.pin",
    "",
    "node.rename",
    "node.note",
    "node.collapse",
    "node.swap",
    "",
    "node.duplicate",
    "canvas.copy",
    "node.disconnect",
    "node.delete",
    "",
    "canvas.frame_nodes",
    "canvas.tidy",
];

/// Actions on the empty canvas.
const BACKGROUND: &[&str] = &[
    "canvas.add",
    "canvas.paste",
    "",
    "canvas.select_all",
    "canvas.tidy",
    "",
    "canvas.fit_all",
    "canvas.fit_selection",
];

/// The menu of a node.
pub(super) fn node(response: &Response, out: &mut Vec<Event>) {
    menu(response, NODE, out);
}

/// The menu of the empty canvas.
pub(super) fn background(response: &Response, out: &mut Vec<Event>) {
    menu(response, BACKGROUND, out);
}

fn menu(response: &Response, ids: &[&str], out: &mut Vec<Event>) {
    response.context_menu(|ui| {
        panel::list(ui, |ui| {
            for id in ids {
                if id.is_empty() {
                    ui.separator();
                    continue;
                }
                let Some(action) = actions::by_id(id) else { continue };
                if ui.button(action.label).on_hover_text(action.tip).clicked() {
                    out.push(Event::Act(action.id));
                    ui.close();
                }
            }
        })
    });
}
