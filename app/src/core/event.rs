//! Everything that can happen in the editor. Rooms read the state and say what happened; nothing else changes it.

use crate::core::documents;
use crate::core::made::HairTrace;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::settings::Settings;
use crate::core::state::Select;
use crate::core::templates;
use crate::core::visibility::Visibility;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Socket};
use std::sync::Arc;

/// Something that happened.
#[derive(Clone, Debug)]
pub enum Event {
    /// An action of the table, by its id.
    Act(&'static str),
    /// A gesture begins: edits until [`Event::End`] are one step. Empty words are found from what it did.
    Begin(String),
    /// The document changes.
    Edit(Edit),
    /// The document changes a little more: one step with the last nudge of the same thing.
    Nudge(Edit),
    /// The gesture ends.
    End,
    /// The gesture ends, and its step is called so.
    EndAs(String),
    /// The gesture is taken back.
    Abort,
    /// The last step is taken back.
    Undo,
    /// The last undone step is done again.
    Redo,
    /// Undoes or redoes until so many steps are done.
    Jump(usize),
    /// The selection changes.
    Select(Select),
    /// The canvas shows what is in a group, or what is in none.
    Enter(Option<NodeId>),
    /// Where does this displayed curve come from? The answer is `State::traced`.
    Trace(u64),
    /// Which nodes, strokes and gestures made this displayed curve? The answer is `State::made`.
    WhatMade(u64),
    /// What made a hair is known, or forgotten.
    Made(Option<Arc<HairTrace>>),
    /// The pen picks a stroke of a node.
    PickStroke(NodeId, u64),
    /// The pen is taken up for a node that is to be drawn into.
    TakeUpPen(NodeId),
    /// Another node is displayed.
    Display(Option<NodeId>),
    /// The pen works on another node.
    Pin(Option<NodeId>),
    /// The canvas shows an input without a wire as a socket, or no longer.
    Expose {
        /// Which input.
        socket: Socket,
        /// Whether it is shown.
        exposed: bool,
    },
    /// Other hair is hidden, alone or locked.
    Visibility(Visibility),
    /// Preferences change.
    Settings(Box<Settings>),
    /// Something is said.
    Say(Note),
    /// What was said is forgotten; what nodes say is not.
    Hush,
    /// The graph is evaluated now.
    Evaluate,
    /// The graph is evaluated now, and nodes may make more than a groom is to have.
    AllowLarge,
    /// Whatever runs stops; the last picture stays.
    Stop,
    /// Something happens to templates.
    Templates(templates::TemplateEvent),
    /// Something happens to the document as a whole.
    Documents(documents::DocumentEvent),
    /// Something happens to the window round the rooms.
    Window(Window),
    /// The outliner scrolls to what is selected.
    Reveal,
    /// Keys are for another room.
    Focus(Room),
    /// A room is opened, or brought to the front.
    Show(Room),
}

/// Something that happens to the window round the rooms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// The settings open or close.
    Settings,
    /// The sheet of keys opens or closes.
    Keys,
    /// The list of all that can be done opens.
    Palette,
    /// The tour begins.
    Tour,
    /// The menu of the right button opens, in the room that keys are for.
    Menu,
    /// The search for templates takes what is typed next.
    SearchTemplates,
    /// Every room is docked where it was at first.
    ResetLayout,
    /// Keys are for the open room so many further.
    NextRoom(isize),
}
