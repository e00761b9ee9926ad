//! What can be done by name: menus, keys, the palette and tooltips all read these. An action that cannot be done says why.
//!
//! An action reads the state, may change what its own room holds (a tool, a view, an open search), and says what happened; it changes
//! nothing else. Rooms keep their own part of the table, and the editor joins them.

use super::event::Event;
use super::state::State;
use egui::Ui;

/// Whether something can be done now, or why not.
pub type Can = Result<(), &'static str>;

/// Something that can be done by name.
pub struct Action<When, Run> {
    /// Its name in key tables; never changes.
    pub id: &'static str,
    /// What menus say.
    pub label: &'static str,
    /// What it does, in one or two lines.
    pub tip: &'static str,
    /// Other words that people search for.
    pub words: &'static str,
    /// The menu it stands in; empty when only keys and the palette have it.
    pub menu: &'static str,
    /// Why it cannot be done now.
    pub when: When,
    /// Does it.
    pub run: Run,
}

/// An action of a room.
pub type Of<Room> = Action<fn(&Room, &State) -> Can, fn(&mut Room, &State, &mut Vec<Event>)>;

/// It can always be done.
///
/// # Errors
/// Never.
pub fn always<Room>(_: &Room, _: &State) -> Can {
    Ok(())
}

/// What is said of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActionInfo {
    /// Its name in key tables.
    pub id: &'static str,
    /// What menus say.
    pub label: &'static str,
    /// What it does.
    pub tip: &'static str,
}

/// Finds what is said of an action by its id, whichever room it is of.
pub type ActionLookup = fn(&str) -> Option<ActionInfo>;

/// Actions by their ids, as entries of a menu; empty ones part them.
pub(crate) fn menu(table: ActionLookup, ids: &[&str], ui: &mut Ui, out: &mut Vec<Event>) {
    for id in ids {
        if id.is_empty() {
            ui.separator();
            continue;
        }
        let Some(action) = table(id) else { continue };
        if ui.button(action.label).on_hover_text(action.tip).clicked() {
            out.push(Event::Act(action.id));
            ui.close();
        }
    }
}
