//! Eyes, locks and isolating: what of a row's hair is seen, and kept from the pen. View state, never a part of a groom.

use super::tree::TreeRow;
use crate::core::event::Event;
use crate::core::state::State;
use crate::core::visibility::Visibility;
use crate::widgets::theme::{self, Tint};
use egui::{Align2, Rect, Sense, TextStyle, Ui, WidgetInfo, WidgetType, pos2, vec2};
use std::collections::BTreeSet;

/// What can be done to see a row's hair, or not.
#[derive(Clone, Copy)]
pub(super) enum Eye {
    Hide,
    Isolate,
    Lock,
}

/// All of them, each with what its entry says while it is off and while it is on.
pub(super) const EYES: [(Eye, [&str; 2]); 3] = [
    (Eye::Hide, ["Hide", "Show"]),
    (Eye::Isolate, ["Isolate", "End isolation"]),
    (Eye::Lock, ["Lock", "Unlock"]),
];

impl Eye {
    fn set(self, view: &mut Visibility) -> &mut BTreeSet<u64> {
        match self {
            Eye::Hide => &mut view.hidden,
            Eye::Isolate => &mut view.alone,
            Eye::Lock => &mut view.locked,
        }
    }

    /// Whether it is on for all of the names.
    pub(super) fn is_on(self, view: &Visibility, names: &[u64]) -> bool {
        let set = match self {
            Eye::Hide => &view.hidden,
            Eye::Isolate => &view.alone,
            Eye::Lock => &view.locked,
        };
        names.iter().all(|name| set.contains(name))
    }

    /// Turns it on for all of the names, or off where it is on for all.
    pub(super) fn toggled(self, view: &Visibility, names: &[u64]) -> Event {
        let mut view = view.clone();
        let set = self.set(&mut view);
        *set = toggled(set, names);
        Event::Visibility(view)
    }

    pub(super) fn tip(self) -> &'static str {
        match self {
            Eye::Hide => "Hide or show this hair in the viewport (Space).",
            Eye::Isolate => "Isolate this hair, together with what is isolated already.",
            Eye::Lock => "Lock this hair against the pen.",
        }
    }

    fn sign(self, on: bool) -> &'static str {
        match (self, on) {
            (Eye::Hide, true) => "–",
            (Eye::Hide, false) => "👁",
            (Eye::Isolate, _) => "◎",
            (Eye::Lock, true) => "🔒",
            (Eye::Lock, false) => "🔓",
        }
    }

    fn colour(self, on: bool, hovered: bool) -> Tint {
        match (self, on || hovered) {
            (Eye::Isolate, true) if on => theme::ACCENT,
            (_, true) => theme::TEXT,
            // What is not in use steps back.
            (Eye::Hide, false) => theme::QUIET,
            _ => theme::QUIET.faded(0.5),
        }
    }
}

/// The eye, the lock and isolating, at the right of a row.
pub(super) fn eye_buttons(
    state: &State,
    ui: &Ui,
    row: &TreeRow,
    id: egui::Id,
    line: Rect,
    out: &mut Vec<Event>,
) {
    let height = line.height();
    for (i, (eye, [what, _])) in EYES.into_iter().enumerate() {
        let on = eye.is_on(&state.visibility, &row.names);
        let left = line.right() - height * (3 - i) as f32;
        let at = Rect::from_min_size(pos2(left, line.top()), vec2(height, height));
        let response = ui.interact(at, id.with(what), Sense::click());
        let (sign, colour) = (eye.sign(on), eye.colour(on, response.hovered()).of(ui));
        let font = TextStyle::Body.resolve(ui.style());
        ui.painter_at(line).text(at.center(), Align2::CENTER_CENTER, sign, font, colour);
        let name = format!("{what} {}", row.name);
        response.widget_info(|| WidgetInfo::selected(WidgetType::Checkbox, true, on, &name));
        if response.clicked() {
            out.push(eye.toggled(&state.visibility, &row.names));
        }
        response.on_hover_text(eye.tip());
    }
}

/// The set with all of the names, or without them where it had all.
pub(super) fn toggled(set: &BTreeSet<u64>, names: &[u64]) -> BTreeSet<u64> {
    let mut set = set.clone();
    if names.iter().all(|name| set.contains(name)) {
        for name in names {
            set.remove(name);
        }
    } else {
        set.extend(names);
    }
    set
}
