//! What the editor says to people: one list, newest last. Nothing pops up.

use coif_graphs::document::NodeId;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gravity {
    /// Something was done.
    Note,
    /// There is a result, but not the one that was meant.
    Warning,
    /// There is none.
    Error,
}

/// One thing said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// How bad it is.
    pub gravity: Gravity,
    /// What it is about, if it is about a node.
    pub node: Option<NodeId>,
    /// Which input of it.
    pub input: Option<String>,
    /// What happened and what to do.
    pub text: String,
}

impl Note {
    /// Something was done.
    pub fn done(text: impl Into<String>) -> Self {
        Self { gravity: Gravity::Note, node: None, input: None, text: text.into() }
    }
    /// Something went wrong, but not all.
    pub fn warning(text: impl Into<String>) -> Self {
        Self { gravity: Gravity::Warning, ..Self::done(text) }
    }
    /// Something could not be done.
    pub fn error(text: impl Into<String>) -> Self {
        Self { gravity: Gravity::Error, ..Self::done(text) }
    }
    /// The same, about a node.
    pub fn of(self, node: NodeId) -> Self {
        Self { node: Some(node), ..self }
    }
}

/// What was said since the document was opened. What nodes say is not here: it comes with each evaluation
/// (`Shown::reports`).
#[derive(Clone, Debug, Default)]
pub struct Notes {
    said: Vec<Note>,
}

/// Older notes than so many are forgotten.
const MOST: usize = 500;

impl Notes {
    /// Adds a note behind the others; one that repeats the last is not said twice.
    pub fn say(&mut self, note: Note) {
        if self.said.last() == Some(&note) {
            return;
        }
        if self.said.len() == MOST {
            self.said.remove(0);
        }
        self.said.push(note);
    }
    /// Oldest first.
    pub fn all(&self) -> &[Note] {
        &self.said
    }
    /// Forgets all.
    pub fn clear(&mut self) {
        self.said.clear();
    }
}
