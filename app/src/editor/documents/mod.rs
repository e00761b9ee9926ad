//! Documents of the editor: new, open, save, export, recent files, recovery, and what happens to files on the disk.
//!
//! Guarantees: what is unsaved is asked about once before it goes; a file is written whole or not at all; whatever ends the
//! process, the document after the last step that the journal has written is offered at the next start; nothing
//! here waits for a dialog, an export or a folder that hangs. Saving itself is waited for.
//!
//! Without a home (as a new editor has none) nothing is kept between runs and no dialog opens, so that tests leave nothing behind;
//! [`super::Editor::keep_in`] gives it one.

pub(crate) mod actions;
mod bars;
mod between_runs;
mod browser;
pub(crate) mod dialogs;
pub(super) mod export;
pub(super) mod export_panel;
mod file_field;
mod frame;
mod journal;
pub(crate) mod kept;
pub(crate) mod life;
pub(super) mod over_hair;
mod own_head;
mod paths;
pub(super) mod picture_panel;
mod recent;
mod remedies;
#[cfg(test)]
mod tests;
mod watch;
mod welcome;

use crate::core::documents::{Disk, DocumentEvent, HeadChoice, Left, Unsaved};
use crate::core::settings::Settings;
use crate::places::Places;
use browser::Browser;
use coif_graphs::document::NodeId;
use dialogs::{Dialogs, Question};
use export::Exports;
use export_panel::ExportPanel;
use journal::{Journal, Leftover};
use own_head::OwnHead;
use picture_panel::PicturePanel;
use recent::Recent;
use std::path::PathBuf;
use std::sync::Arc;
use watch::Watch;
use welcome::Welcome;

pub(crate) use bars::changed;
pub(crate) use bars::export_line;
pub(crate) use frame::{after, before, panels};

/// What waits until unsaved changes are dealt with.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Next {
    New(Option<&'static str>),
    Begin(&'static str),
    NewHead(PathBuf),
    Open(PathBuf),
    Restore(usize),
    Close,
}

/// A question for a file, and what it is for.
struct Asking {
    question: Question,
    /// The node and input that a file is wanted for.
    input: Option<(NodeId, String)>,
}

/// What is brought into view when another document or head is seen first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Framing {
    /// The heads, and then all hair, once there is some.
    All,
    /// All hair: the heads are in view.
    Hair,
    /// The face.
    Face,
}

/// What the editor knows about documents as files.
pub struct Documents {
    wake: Arc<dyn Fn() + Send + Sync>,
    home: Option<Places>,
    journal: Option<Journal>,
    /// What the journal was told last: changes, file, whether anything is unsaved.
    told: Option<(u64, Option<PathBuf>, bool)>,
    recent: Recent,
    watch: Watch,
    /// The files that are looked at, as of this number of changes.
    watched: Option<(u64, Option<PathBuf>)>,
    /// None where nothing is kept: nobody is asked for files then.
    dialogs: Option<Box<dyn Dialogs>>,
    /// The system has no dialogs.
    no_dialogs: bool,
    asking: Option<Asking>,
    /// Where a file was chosen last, to be read and to be written: heads lie where nobody writes hair.
    last_folders: [Option<PathBuf>; 2],
    browser: Option<Browser>,
    /// Waits for an answer about unsaved changes.
    unsaved: Option<Next>,
    /// Waits for the document to be saved.
    after_save: Option<Next>,
    leftovers: Vec<Leftover>,
    /// Others changed the present file.
    changed: bool,
    exports: Exports,
    pub(super) export_panel: ExportPanel,
    pub(super) picture_panel: PicturePanel,
    /// The window closes once all exports have stopped.
    closes_after_export: bool,
    head: Option<OwnHead>,
    /// What is brought into view, once this state of the document is shown.
    frames: Option<(u64, Framing)>,
    /// A mesh that is to become the head, while it is asked what becomes of the hair.
    pub(super) mesh: Option<PathBuf>,
    welcome: Welcome,
    title: String,
    /// The settings that the window has, and that are kept.
    settings: Option<Settings>,
    /// When the document was saved or changed last, for saving by itself; seconds of the window.
    saved_at: f64,
    /// Nothing keeps the window from closing any more.
    leaving: bool,
}

impl Documents {
    /// What wakes the window from a thread.
    pub(crate) fn waker(&self) -> Arc<dyn Fn() + Send + Sync> {
        self.wake.clone()
    }

    /// Without a home: nothing is kept.
    pub(crate) fn new(ctx: &egui::Context) -> Self {
        let for_wake = ctx.clone();
        let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(move || for_wake.request_repaint());
        let for_watch = wake.clone();
        Self {
            home: None,
            journal: None,
            told: None,
            recent: Recent::default(),
            watch: Watch::start(move || for_watch()),
            watched: None,
            dialogs: None,
            no_dialogs: false,
            asking: None,
            last_folders: [None, None],
            browser: None,
            unsaved: None,
            after_save: None,
            leftovers: vec![],
            changed: false,
            exports: Exports::new(wake.clone()),
            export_panel: ExportPanel::default(),
            picture_panel: PicturePanel::default(),
            closes_after_export: false,
            head: None,
            mesh: None,
            frames: None,
            welcome: Welcome::default(),
            title: String::new(),
            settings: None,
            saved_at: 0.0,
            leaving: false,
            wake,
        }
    }

    /// Asks for files in the window itself, as where the system has no dialogs.
    pub fn ask_in_the_window(&mut self) {
        self.no_dialogs = true;
    }

    /// Whether something is open that takes the keys.
    pub(crate) fn takes_keys(&self) -> bool {
        self.unsaved.is_some() || self.browser.is_some()
    }

    /// Whether something is still to be brought into view.
    pub(crate) fn is_framing(&self) -> bool {
        self.frames.is_some()
    }

    /// Whether the document would be found again as it is now, whatever ended the process.
    pub fn is_safe(&self) -> bool {
        self.journal.as_ref().is_some_and(|journal| journal.is_done())
    }

    /// Whether the present file was changed by others and nothing was decided.
    pub fn is_changed_on_disk(&self) -> bool {
        self.changed
    }

    /// Whether a head that was just chosen waits for an answer.
    pub(crate) fn places_head(&self) -> bool {
        self.head.is_some()
    }

    /// Whether the welcome panel is open.
    pub fn shows_welcome(&self) -> bool {
        self.welcome.is_open
    }
}
