//! The one place where the state is changed by what happened.
//!
//! Guarantees: the document changes only by edits that can be undone (which node is displayed is saved, and is no step); what is
//! gone is selected, pinned or shown no longer.

use super::event::Event;
use super::notes::Note;
use super::state::{Select, State};
use coif_graphs::document::NodeId;
use coif_graphs::document::edit::Edit;

/// Nudges of one value within so many seconds are one undo step.
const NUDGE_SECONDS: f64 = 0.7;

impl State {
    /// Changes the state by what happened. What happens to rooms, files or evaluation is the editor's to carry out.
    pub fn apply(&mut self, event: Event) {
        match event {
            Event::Begin(words) => {
                self.history.begin(&self.document, &words);
                (self.gesture, self.changes_hair) = (true, false);
            }
            Event::Edit(edit) => self.edit(&edit, false),
            Event::Nudge(edit) => {
                let soon = self.now - self.nudged < NUDGE_SECONDS;
                self.nudged = self.now;
                self.edit(&edit, soon);
            }
            Event::EndAs(words) => {
                self.history.call(&words);
                self.apply(Event::End);
            }
            Event::End => {
                self.history.end(&self.document);
                self.gesture = false;
            }
            Event::Abort => {
                let aborted = self.history.abort(&mut self.document);
                self.gesture = false;
                self.changed(aborted.map_err(|err| err.to_string()), true);
            }
            Event::Undo => {
                let undone = self.history.undo(&mut self.document).map(|_| ());
                self.gesture = false;
                self.changed(undone.map_err(|err| err.to_string()), true);
            }
            Event::Redo => {
                let redone = self.history.redo(&mut self.document).map(|_| ());
                self.changed(redone.map_err(|err| err.to_string()), true);
            }
            Event::Jump(to) => {
                let jumped = self.history.jump(&mut self.document, to);
                self.changed(jumped.map_err(|err| err.to_string()), true);
            }
            Event::Select(select) => self.select(select),
            Event::Enter(group) => self.enter(group),
            Event::Made(made) => self.made = made,
            Event::Display(node) => {
                // What is displayed is saved with the groom, but it is no step.
                let set = Edit::SetDisplay(node).apply(&mut self.document).map(|_| ());
                self.changed(set.map_err(|err| err.to_string()), true);
            }
            Event::Pin(node) => self.pinned = node,
            Event::Expose { socket, exposed: true } => {
                self.exposed.insert(socket);
            }
            Event::Expose { socket, exposed: false } => {
                self.exposed.remove(&socket);
            }
            Event::Visibility(visibility) => self.visibility = visibility,
            Event::Settings(settings) => self.settings = *settings,
            Event::Say(note) => self.notes.say(note),
            Event::Hush => self.notes.clear(),
            Event::AllowLarge => self.allow_large = true,
            Event::Focus(room) | Event::Show(room) => self.focus = room,
            // Nothing of these is in the state itself.
            Event::Act(_)
            | Event::Trace(_)
            | Event::WhatMade(_)
            | Event::PickStroke(..)
            | Event::TakeUpPen(_)
            | Event::Evaluate
            | Event::Stop
            | Event::Templates(_)
            | Event::Documents(_)
            | Event::Window(_)
            | Event::Reveal => {}
        }
    }

    fn edit(&mut self, edit: &Edit, nudge: bool) {
        self.changes_hair |= self.gesture && edit.changes_evaluation();
        let done = if nudge {
            self.history.nudge(&mut self.document, edit)
        } else {
            self.history.edit(&mut self.document, edit)
        };
        self.changed(done.map_err(|err| err.to_string()), edit.changes_evaluation());
    }

    /// After a change of the document, or a refusal of one.
    fn changed(&mut self, done: Result<(), String>, changes_evaluation: bool) {
        match done {
            Ok(()) => {
                self.changes += 1;
                if changes_evaluation {
                    self.revision += 1;
                }
                self.keep();
            }
            Err(why) => self.notes.say(Note::error(why).of_groom()),
        }
    }

    fn select(&mut self, select: Select) {
        self.selection.change(select);
        self.keep();
        // What is selected elsewhere is shown where it is.
        if let Some(active) = self.active() {
            self.group = active.group();
        }
    }

    fn enter(&mut self, group: Option<NodeId>) {
        let left = std::mem::replace(&mut self.group, group);
        self.keep();
        // Going out, the group that was left is selected.
        let left = left.filter(|left| left.group() == self.group);
        self.selection.change(Select::Nodes(left.into_iter().collect()));
        self.selection.keep(&self.document);
    }
}
