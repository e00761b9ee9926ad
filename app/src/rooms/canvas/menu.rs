//! What the right button offers on nodes and on the empty canvas: actions of the table, by their
//! names.

use crate::core::action::{self, ActionLookup};
use crate::core::event::Event;
use crate::widgets::panel;
use egui::{Pos2, Response};

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
    "canvas.group",
    "canvas.ungroup",
    "canvas.enter",
    "template.save",
    "canvas.tidy",
];

/// Actions on the empty canvas.
const BACKGROUND: &[&str] = &[
    "canvas.add",
    "canvas.paste",
    "canvas.leave",
    "",
    "canvas.select_all",
    "canvas.tidy",
    "",
    "canvas.fit_all",
    "canvas.fit_selection",
];

/// The menu of a node; keys open it at a place.
pub(super) fn node(
    table: ActionLookup,
    response: &Response,
    by_key: Option<Pos2>,
    out: &mut Vec<Event>,
) {
    let opens = by_key.or_else(|| panel::right_click(response));
    panel::menu_at(response, opens, |ui| action::menu(table, NODE, ui, out));
}

/// The menu of the empty canvas.
pub(super) fn background(
    table: ActionLookup,
    response: &Response,
    by_key: Option<Pos2>,
    out: &mut Vec<Event>,
) {
    let opens = by_key.or_else(|| panel::right_click(response));
    panel::menu_at(response, opens, |ui| action::menu(table, BACKGROUND, ui, out));
}
