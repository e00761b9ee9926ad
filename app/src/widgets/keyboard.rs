//! Keys that widgets keep for themselves.

use egui::{Event, EventFilter, Id, Key, Ui};

/// Arrow keys stay with a widget that has the keyboard, instead of leading to the next.
pub(crate) fn keep_arrows(ui: &Ui, id: Id) {
    let filter =
        EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
}

/// Where Escape stands among what was done in a frame.
pub(crate) fn escape_at(events: &[Event]) -> Option<usize> {
    let is_escape = |event: &Event| match event {
        Event::Key { key: Key::Escape, pressed: true, modifiers, .. } => modifiers.is_none(),
        _ => false,
    };
    events.iter().position(is_escape)
}
