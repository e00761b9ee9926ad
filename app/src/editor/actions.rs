//! The whole table of what can be done by name: the rooms' parts of it, and what belongs to no room.

use super::Editor;
use crate::core::action::{Action, ActionInfo, Can, Of};
use crate::core::event::{Event, Window};
use crate::core::room::Room;
use crate::rooms::canvas::{self, Canvas};
use crate::rooms::pen::{self, Pen};
use crate::rooms::viewport::{self, Viewport};

/// An action of the editor itself: it says what happened, and changes nothing.
pub(super) type Own = Action<fn(&Editor) -> Can, fn(&Editor, &mut Vec<Event>)>;

/// Something that can be done by name, whoever does it.
#[derive(Clone, Copy)]
pub struct Entry {
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
    by: By,
}

/// Who does it.
#[derive(Clone, Copy)]
enum By {
    Editor(&'static Own),
    Canvas(&'static Of<Canvas>),
    Viewport(&'static Of<Viewport>),
    Pen(&'static Of<Pen>),
}

impl Entry {
    fn of<W, R>(action: &'static Action<W, R>, by: fn(&'static Action<W, R>) -> By) -> Self {
        let Action { id, label, tip, words, menu, .. } = action;
        Self { id, label, tip, words, menu, by: by(action) }
    }

    /// The menu within its menu that it stands in.
    pub fn group(&self) -> Option<&'static str> {
        let is_in = |(menu, _, ids): &&(&str, &str, &[&str])| {
            *menu == self.menu && ids.iter().any(|id| self.id.starts_with(id))
        };
        GROUPS.iter().find(is_in).map(|(_, group, _)| *group)
    }

    /// Whether it can be done now.
    ///
    /// # Errors
    /// Why it cannot.
    pub fn when(&self, editor: &Editor) -> Can {
        let state = &editor.state;
        match self.by {
            By::Editor(action) => (action.when)(editor),
            By::Canvas(action) => (action.when)(&editor.canvas, state),
            By::Viewport(action) => (action.when)(&editor.viewport, state),
            By::Pen(action) => (action.when)(&editor.pen, state),
        }
    }

    /// Does it.
    pub(crate) fn run(&self, editor: &mut Editor) {
        let mut out = vec![];
        let state = &editor.state;
        match self.by {
            By::Editor(action) => (action.run)(editor, &mut out),
            By::Canvas(action) => (action.run)(&mut editor.canvas, state, &mut out),
            By::Viewport(action) => (action.run)(&mut editor.viewport, state, &mut out),
            By::Pen(action) => (action.run)(&mut editor.pen, state, &mut out),
        }
        for event in out {
            editor.apply(event);
        }
    }
}

/// It can always be done.
pub(super) fn always(_: &Editor) -> Can {
    Ok(())
}

/// Menus from left to right.
pub const MENUS: &[&str] = &["File", "Edit", "Node", "View", "Pen", "Window", "Help"];

/// Entries that stand in a menu within their menu: that menu, what it is called, and how the ids of its entries begin.
const GROUPS: &[(&str, &str, &[&str])] = &[
    ("Node", "Line up", &["canvas.align_", "canvas.distribute"]),
    ("Node", "Pick", &["canvas.select_", "canvas.next_wire"]),
    ("View", "Look from", &["view.from_"]),
    ("View", "Lighting", &["view.light", "view.brighter", "view.darker", "view.surroundings"]),
    (
        "View",
        "Selected hair",
        &[
            "view.isolate",
            "view.hide",
            "view.show_all",
            "view.lock",
            "view.select_",
            "view.what_made",
            "view.reveal",
        ],
    ),
    ("View", "Two grooms", &["compare."]),
    ("Pen", "Tools on hair", &["hair."]),
    ("Pen", "Strokes", &["strokes."]),
    ("Pen", "Masks", &["mask."]),
    ("Pen", "Recipes", &["recipe."]),
];

/// Every action, in the order of menus.
pub fn all() -> impl Iterator<Item = Entry> {
    let own = super::documents::actions::ACTIONS.iter().chain(ACTIONS);
    let canvas = canvas::ACTIONS.iter().copied().flatten();
    let pen = pen::ACTIONS.iter().copied().flatten();
    own.map(|action| Entry::of(action, By::Editor))
        .chain(canvas.map(|action| Entry::of(action, By::Canvas)))
        .chain(viewport::actions::ACTIONS.iter().map(|action| Entry::of(action, By::Viewport)))
        .chain(pen.map(|action| Entry::of(action, By::Pen)))
}

/// The action of an id.
pub fn by_id(id: &str) -> Option<Entry> {
    all().find(|action| action.id == id)
}

/// What is said of the action of an id, for rooms.
pub(super) fn named(id: &str) -> Option<ActionInfo> {
    by_id(id).map(|Entry { id, label, tip, .. }| ActionInfo { id, label, tip })
}

macro_rules! show_room {
    ($id:literal, $label:literal, $room:ident) => {
        Action {
            id: $id,
            label: $label,
            tip: "Open this room, or bring it to the front.",
            words: "panel tab window",
            menu: "Window",
            when: always,
            run: |_, out| out.push(Event::Show(Room::$room)),
        }
    };
}

/// What belongs to no room.
const ACTIONS: &[Own] = &[
    Action {
        id: "edit.undo",
        label: "Undo",
        tip: "Undo the last step.",
        words: "back revert",
        menu: "Edit",
        when: |editor| match editor.state.history.done() {
            0 => Err("there is no step to undo"),
            _ => Ok(()),
        },
        run: |_, out| out.push(Event::Undo),
    },
    Action {
        id: "edit.redo",
        label: "Redo",
        tip: "Redo the step that was undone last.",
        words: "again forward",
        menu: "Edit",
        when: |editor| {
            let history = &editor.state.history;
            if history.steps().count() > history.done() {
                Ok(())
            } else {
                Err("there is no step to redo")
            }
        },
        run: |_, out| out.push(Event::Redo),
    },
    Action {
        id: "edit.settings",
        label: "Settings…",
        tip: "Interface scale, contrast, evaluation, navigation and saving.",
        words: "preferences options configure theme zoom autosave",
        menu: "Edit",
        when: always,
        run: |_, out| out.push(Event::Window(Window::Settings)),
    },
    Action {
        id: "view.theme",
        label: "Light or dark window",
        tip: "Switch between light and dark panels; the picture stays as it is.",
        words: "theme bright day night colours colors contrast appearance mode",
        menu: "View",
        when: always,
        run: |editor, out| {
            let mut settings = editor.state.settings.clone();
            settings.theme = settings.theme.other();
            out.push(Event::Settings(Box::new(settings)));
        },
    },
    Action {
        id: "evaluate.stop",
        label: "Stop",
        tip: "Stop the running evaluation and keep the last picture.",
        words: "cancel abort escape",
        menu: "View",
        when: always,
        run: |_, out| out.push(Event::Stop),
    },
    Action {
        id: "evaluate.now",
        label: "Evaluate now",
        tip: "Evaluate all hair now, in every evaluation mode.",
        words: "cook recompute refresh render update",
        menu: "View",
        when: always,
        run: |_, out| out.push(Event::Evaluate),
    },
    Action {
        id: "evaluate.allow_large",
        label: "Evaluate anyway",
        tip: "Evaluate beyond the limit of 16.8 million points, up to the free memory, until another document is opened.",
        words: "allow large many points limit memory",
        menu: "View",
        when: |editor| match editor.state.is_too_large() {
            true => Ok(()),
            false => Err("no node would make too much"),
        },
        run: |_, out| out.push(Event::AllowLarge),
    },
    Action {
        id: "help.tour",
        label: "Tour",
        tip: "A five-minute tour on this groom; you do every step.",
        words: "tutorial learn first begin",
        menu: "Help",
        when: |editor| super::tour::possible(&editor.state),
        run: |_, out| out.push(Event::Window(Window::Tour)),
    },
    Action {
        id: "window.palette",
        label: "Find an action…",
        tip: "Search all actions by name.",
        words: "command palette search",
        menu: "Help",
        when: always,
        run: |_, out| out.push(Event::Window(Window::Palette)),
    },
    Action {
        id: "window.keys",
        label: "Keys and manual",
        tip: "Keys of the focused room, and the manual of the active node.",
        words: "shortcuts hotkeys help",
        menu: "Help",
        when: always,
        run: |_, out| out.push(Event::Window(Window::Keys)),
    },
    Action {
        id: "window.menu",
        label: "Menu",
        tip: "Open the context menu of what is under the pointer, or of the active node or row.",
        words: "context right click",
        menu: "Window",
        when: |editor| match editor.state.focus {
            Room::Viewport | Room::Canvas | Room::Outliner => Ok(()),
            _ => Err("this room has no context menu"),
        },
        run: |_, out| out.push(Event::Window(Window::Menu)),
    },
    Action {
        id: "window.reset_layout",
        label: "Reset the layout",
        tip: "Dock every room in its default place.",
        words: "panels default",
        menu: "Window",
        when: always,
        run: |_, out| out.push(Event::Window(Window::ResetLayout)),
    },
    Action {
        id: "window.next_room",
        label: "Next room",
        tip: "Move keyboard focus to the next room.",
        words: "focus cycle",
        menu: "Window",
        when: always,
        run: |_, out| out.push(Event::Window(Window::NextRoom(1))),
    },
    Action {
        id: "window.previous_room",
        label: "Previous room",
        tip: "Move keyboard focus to the previous room.",
        words: "focus cycle",
        menu: "Window",
        when: always,
        run: |_, out| out.push(Event::Window(Window::NextRoom(-1))),
    },
    show_room!("window.viewport", "Viewport", Viewport),
    show_room!("window.canvas", "Nodes", Canvas),
    show_room!("window.inspector", "Inspector", Inspector),
    show_room!("window.outliner", "Outliner", Outliner),
    Action {
        id: "window.templates",
        label: "Templates",
        tip: "Templates that come with coif, your own and those of a show. Drag one onto the canvas.",
        words: "library browser preset asset group recipe style add insert",
        menu: "Window",
        when: always,
        run: |_, out| {
            out.push(Event::Show(Room::Templates));
            out.push(Event::Window(Window::SearchTemplates));
        },
    },
    show_room!("window.spreadsheet", "Spreadsheet", Spreadsheet),
    show_room!("window.messages", "Messages", Messages),
    show_room!("window.history", "History", History),
];
