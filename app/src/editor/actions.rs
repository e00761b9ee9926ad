//! Everything that can be done by name: menus, keys, the palette and tooltips all read this one table.
//!
//! Rooms keep their own part of it; [`all`] is the whole. An action that cannot be done says why.

use super::Editor;
use crate::core::event::Event;
use crate::core::room::Room;

/// Something that can be done by name.
pub struct Action {
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
    pub when: fn(&Editor) -> Result<(), &'static str>,
    /// Does it.
    pub run: fn(&mut Editor),
}

/// It can always be done.
pub fn always(_: &Editor) -> Result<(), &'static str> {
    Ok(())
}

/// Menus from left to right.
pub const MENUS: &[&str] = &["File", "Edit", "Node", "View", "Pen", "Window", "Help"];

/// The parts of the table, room by room.
const PARTS: &[&[&[Action]]] = &[
    &[super::documents::actions::ACTIONS, ACTIONS],
    crate::rooms::canvas::ACTIONS,
    &[
        crate::rooms::viewport::actions::ACTIONS,
        crate::rooms::pen::actions::ACTIONS,
        crate::rooms::pen::hair::actions::ACTIONS,
        crate::rooms::pen::mask::actions::ACTIONS,
    ],
];

/// Every action, in the order of menus.
pub fn all() -> impl Iterator<Item = &'static Action> {
    PARTS.iter().copied().flatten().copied().flatten()
}

/// The action of an id.
pub fn by_id(id: &str) -> Option<&'static Action> {
    all().find(|action| action.id == id)
}

macro_rules! show_room {
    ($id:literal, $label:literal, $room:ident) => {
        Action {
            id: $id,
            label: $label,
            tip: "Brings this room to the front, and opens it where it is closed.",
            words: "panel tab window",
            menu: "Window",
            when: always,
            run: |editor| editor.apply(Event::Show(Room::$room)),
        }
    };
}

/// What belongs to no room.
const ACTIONS: &[Action] = &[
    Action {
        id: "edit.undo",
        label: "Undo",
        tip: "Takes the last step back.",
        words: "back revert",
        menu: "Edit",
        when: |editor| match editor.state.history.done() {
            0 => Err("nothing was done yet"),
            _ => Ok(()),
        },
        run: |editor| editor.apply(Event::Undo),
    },
    Action {
        id: "edit.redo",
        label: "Redo",
        tip: "Does the step again that was taken back last.",
        words: "again forward",
        menu: "Edit",
        when: |editor| {
            let history = &editor.state.history;
            if history.steps().count() > history.done() {
                Ok(())
            } else {
                Err("nothing was taken back")
            }
        },
        run: |editor| editor.apply(Event::Redo),
    },
    Action {
        id: "edit.settings",
        label: "Settings…",
        tip: "Scale, contrast, evaluation, navigation, saving.",
        words: "preferences options configure theme zoom autosave",
        menu: "Edit",
        when: always,
        run: |editor| editor.settings_panel.is_open = !editor.settings_panel.is_open,
    },
    Action {
        id: "evaluate.stop",
        label: "Stop",
        tip: "Stops what is being evaluated; the last picture stays.",
        words: "cancel abort escape",
        menu: "View",
        when: always,
        run: |editor| editor.apply(Event::Stop),
    },
    Action {
        id: "evaluate.now",
        label: "Evaluate now",
        tip: "Makes all hair, whatever mode evaluation is in.",
        words: "cook recompute refresh render update",
        menu: "View",
        when: always,
        run: |editor| editor.apply(Event::Evaluate),
    },
    Action {
        id: "evaluate.allow_large",
        label: "Make it all the same",
        tip: "Makes more hair than a groom is to have, as much as memory holds, until another document is opened.",
        words: "allow large many points limit memory",
        menu: "View",
        when: |editor| match editor.state.is_too_large() {
            true => Ok(()),
            false => Err("no node would make too much"),
        },
        run: |editor| editor.apply(Event::AllowLarge),
    },
    Action {
        id: "help.tour",
        label: "Tour",
        tip: "Five minutes on this groom: every step is done by you.",
        words: "tutorial learn first begin",
        menu: "Help",
        when: |editor| super::tour::possible(&editor.state),
        run: |editor| editor.tour.begin(),
    },
    Action {
        id: "window.palette",
        label: "Find an action…",
        tip: "Everything that can be done, by name.",
        words: "command palette search",
        menu: "Help",
        when: always,
        run: |editor| editor.palette.open(),
    },
    Action {
        id: "window.keys",
        label: "Keys and manual",
        tip: "The keys of the room that keys are for now, and the manual of the active node.",
        words: "shortcuts hotkeys help",
        menu: "Help",
        when: always,
        run: |editor| editor.key_sheet = !editor.key_sheet,
    },
    Action {
        id: "window.menu",
        label: "Menu",
        tip: "The menu of the right button: of what is under the pointer, or of the active node or row.",
        words: "context right click",
        menu: "Window",
        when: |editor| match editor.state.focus {
            Room::Viewport | Room::Canvas | Room::Outliner => Ok(()),
            _ => Err("this room has no menu of the right button"),
        },
        run: |editor| match editor.state.focus {
            Room::Viewport => editor.viewport.open_menu_by_key(),
            Room::Canvas => editor.canvas.open_menu_by_key(),
            _ => editor.outliner.open_menu_by_key(),
        },
    },
    Action {
        id: "window.reset_layout",
        label: "Reset the layout",
        tip: "Docks every room where it was at first.",
        words: "panels default",
        menu: "Window",
        when: always,
        run: Editor::reset_layout,
    },
    Action {
        id: "window.next_room",
        label: "Next room",
        tip: "Gives the keys to the next room.",
        words: "focus cycle",
        menu: "Window",
        when: always,
        run: |editor| editor.focus_next(1),
    },
    Action {
        id: "window.previous_room",
        label: "Previous room",
        tip: "Gives the keys to the room before.",
        words: "focus cycle",
        menu: "Window",
        when: always,
        run: |editor| editor.focus_next(-1),
    },
    show_room!("window.viewport", "Viewport", Viewport),
    show_room!("window.canvas", "Nodes", Canvas),
    show_room!("window.inspector", "Inspector", Inspector),
    show_room!("window.outliner", "Outliner", Outliner),
    Action {
        id: "window.templates",
        label: "Templates",
        tip: "Hair that comes with coif, of your own and of shows: drag it among the nodes.",
        words: "library browser preset asset group recipe style add insert",
        menu: "Window",
        when: always,
        run: |editor| {
            editor.apply(Event::Show(Room::Templates));
            editor.templates.search();
        },
    },
    show_room!("window.spreadsheet", "Spreadsheet", Spreadsheet),
    show_room!("window.messages", "Messages", Messages),
    show_room!("window.history", "History", History),
];
