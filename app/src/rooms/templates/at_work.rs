//! What threads do for the room: a template is read, a picture of one is drawn.

use crate::library::LibraryEntry;
use coif_graphs::document::{NodeId, Point};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// What threads do for the room.
#[derive(Default)]
pub(crate) struct AtWork {
    pub(crate) drawing: Option<Arc<Mutex<Option<Result<(), String>>>>>,
    /// The file that is drawn.
    pub(crate) path: PathBuf,
    /// A template that is written: its file, and whether it is to be drawn.
    pub(crate) writing: Option<Written>,
    pub(crate) reading: Option<Arc<Mutex<Reading>>>,
}

/// What became of a template that was written: its file, and whether it is to be drawn then.
pub(crate) type Written = Arc<Mutex<Option<Result<(PathBuf, bool), String>>>>;

/// What a template is read for.
#[derive(Clone)]
pub(crate) enum ReadPurpose {
    /// To be added, there.
    Add(Option<Point>),
    /// To be compared with an instance.
    Compare(NodeId),
}

/// A template that is read.
pub(crate) struct Reading {
    pub(crate) read: Option<Result<LibraryEntry, String>>,
    pub(crate) purpose: ReadPurpose,
}

impl AtWork {
    /// Whether a picture is being drawn.
    pub(crate) fn is_busy(&self) -> bool {
        self.drawing.is_some()
    }
}
