//! The life of a document: new, opened, saved, restored, closed. What [`super::DocumentEvent`]s do.

use super::dialogs::Question;
use super::export::{Content, ExportJob};
use super::journal::About;
use super::remedies::with_remedy;
use super::watch::hash_of;
use super::{
    Asking, Disk, DocumentEvent, Framing, HeadChoice, Left, Next, Unsaved, journal, own_head, paths,
};
use crate::core::documents::Purpose;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::room::Room;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::files::{MOST_DOCUMENT, Role, Together, read_at_most};
use coif_graphs::compare::undecided;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::history::History;
use coif_graphs::document::{Document, Node, NodeId, Point, SavedView, Setting};
use coif_graphs::schedule::files::named;
use coif_graphs::schedule::run::CancelToken;
use coif_graphs::{file, grooms};
use coif_nodes::define::Value;
use coif_shaders::Camera;
use std::path::{Path, PathBuf};

/// The document that begins with nothing but a head.
pub(crate) fn empty_head() -> Document {
    let mut document = Document { title: "Untitled".to_owned(), ..Document::default() };
    let id = document.free_id("head");
    let node = document.fresh_node("head", &id);
    document.nodes.insert(id.clone(), node.into());
    document.layout.insert(id, Point(0.0, 0.0));
    document
}

impl Editor {
    /// Does what happened to the document as a whole.
    pub(crate) fn apply_to_file(&mut self, event: DocumentEvent) {
        match event {
            DocumentEvent::New(groom) => self.after_question(Next::New(groom)),
            DocumentEvent::Begin(action) => self.after_question(Next::Begin(action)),
            DocumentEvent::Open(path) => self.after_question(Next::Open(path)),
            DocumentEvent::Close => self.after_question(Next::Close),
            DocumentEvent::Save => self.save(),
            DocumentEvent::SaveTo(path) => {
                if self.save_to(&path)
                    && let Some(next) = self.documents.after_save.take()
                {
                    self.go_on(next);
                }
            }
            DocumentEvent::Ask(purpose) => self.ask(purpose, None),
            DocumentEvent::Find(node, input) => self.ask(Purpose::Find, Some((node, input))),
            DocumentEvent::NewHead(path) => self.after_question(Next::NewHead(path)),
            DocumentEvent::Mesh(path) => self.ask_mesh(path),
            DocumentEvent::MeshOver { path, bald } => self.try_mesh(&path, bald),
            DocumentEvent::Head(choice) => self.head_chosen(choice),
            DocumentEvent::ExportPanel => self.open_export_panel(),
            DocumentEvent::PicturePanel => self.open_picture_panel(),
            DocumentEvent::CompareWithSaved => self.compare_with_saved(),
            DocumentEvent::Sides(sides) => self.show_sides(sides),
            DocumentEvent::EndCompare => self.end_compare(),
            DocumentEvent::StopExport => {
                if let Some(row) = self.documents.exports.going().first() {
                    self.documents.exports.cancel(row.number);
                }
            }
            DocumentEvent::Unsaved(answer) => self.unsaved(answer),
            DocumentEvent::Disk(answer) => self.changed_on_disk(answer),
            DocumentEvent::Left(at, answer) => self.left(at, answer),
            DocumentEvent::Forget(path) => {
                if let Err(why) = self.documents.recent.remove(&path) {
                    self.state.apply(Event::Say(Note::warning(why)));
                }
            }
            DocumentEvent::Welcome(open) => {
                self.documents.welcome.is_open = open;
                if open {
                    let wake = self.documents.wake.clone();
                    self.documents.recent.look(move || wake());
                }
            }
        }
    }

    /// Does something that loses the document: at once, or after a question where something is unsaved.
    fn after_question(&mut self, next: Next) {
        self.state.apply(Event::End);
        let exports = next == Next::Close && self.documents.exports.is_going();
        if self.state.history.is_changed() || exports {
            self.documents.unsaved = Some(next);
        } else {
            self.go_on(next);
        }
    }

    fn unsaved(&mut self, answer: Unsaved) {
        let Some(next) = self.documents.unsaved.take() else { return };
        match answer {
            Unsaved::Cancel => {}
            Unsaved::Discard => self.go_on(next),
            Unsaved::Save => {
                self.documents.after_save = Some(next);
                self.save();
            }
        }
    }

    fn go_on(&mut self, next: Next) {
        match next {
            Next::New(groom) => self.begin(groom),
            Next::Begin(action) => {
                self.begin(None);
                self.act(action);
            }
            Next::NewHead(path) => {
                self.begin(None);
                self.try_mesh(&path, false);
            }
            Next::Open(path) => {
                self.open(&path);
            }
            Next::Restore(at) => self.restore(at),
            Next::Close => self.leave(),
        }
    }

    /// Another document is there, as it was opened or made.
    fn put(&mut self, document: Document, file: OpenFile, history: History) {
        self.replace(document, file, history);
        // What was said is about the one before.
        self.state.apply(Event::Hush);
        self.documents.changed = false;
        self.documents.head = None;
        self.documents.frames = Some((self.state.revision, Framing::All));
        self.documents.welcome.is_open = false;
        self.documents.export_panel.forget();
        self.documents.picture_panel.forget();
        self.forget_the_last();
    }

    fn begin(&mut self, groom: Option<&'static str>) {
        let document = match groom {
            None => empty_head(),
            Some(name) => match grooms::by_name(name).map(file::read) {
                Some(Ok(loaded)) => loaded.document,
                Some(Err(err)) => {
                    return self.state.apply(Event::Say(Note::error(err.of_file(name))));
                }
                None => {
                    let text = format!("there is no shipped groom {name:?}");
                    return self.state.apply(Event::Say(Note::error(text)));
                }
            },
        };
        self.put(document, OpenFile::default(), History::new());
    }

    /// Opens a file. Where it cannot be, everything stays as it is and somebody is told why.
    fn open(&mut self, path: &Path) -> bool {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let shown = path.display().to_string();
        let (loaded, hash) = match read(&path) {
            Ok(read) => read,
            Err(why) => {
                self.state.apply(Event::Say(Note::error(format!("not opened: {why}"))));
                return false;
            }
        };
        self.documents.watch.knows(&path, hash);
        self.put(loaded.document, OpenFile::at(path.clone()), History::new());
        self.remember(&path);
        for warning in &loaded.warnings {
            self.state.apply(Event::Say(Note::warning(warning.of_file(&shown))));
        }
        self.tell_conflicts(&shown);
        for comment in &loaded.dropped_comments {
            let text = format!("{} (saving drops this comment)", comment.of_file(&shown));
            self.state.apply(Event::Say(Note::warning(text)));
        }
        true
    }

    /// Says how much a merge left to decide; what it is, and what decides it, the messages say.
    pub(in super::super) fn tell_conflicts(&mut self, shown: &str) {
        let left = undecided(&self.state.document).len();
        if left > 0 {
            let left = crate::words::counted(left, "conflict");
            let text = format!("{shown}: {left} of a merge left to decide, in the messages");
            self.state.apply(Event::Say(Note::warning(text)));
            self.apply(crate::core::event::Event::Show(Room::Messages));
        }
    }

    fn remember(&mut self, path: &Path) {
        if let Err(why) = self.documents.recent.add(path) {
            self.state.apply(Event::Say(Note::warning(why)));
        }
    }

    fn save(&mut self) {
        match self.state.file.path.clone() {
            Some(path) => self.apply_to_file(DocumentEvent::SaveTo(path)),
            None => self.ask(Purpose::Save, None),
        }
    }

    /// Saves; tells why where that failed. The file is the document's from then on.
    pub(super) fn save_to(&mut self, path: &Path) -> bool {
        let path = Purpose::Save.complete(path.to_owned());
        let path = std::path::absolute(&path).unwrap_or(path);
        let (state, documents) = (&mut self.state, &mut self.documents);
        state.history.end(&state.document);
        let file = OpenFile::at(path.clone());
        let mut document = state.document.clone();
        let mut history = state.history.clone();
        paths::move_to(&mut document, &mut history, &state.file.folder, &file.folder);
        let text = file::write(&document);
        let before = documents.watched.take();
        documents.watch.knows(&path, hash_of(text.as_bytes()));
        if let Err(why) = put(&document, &file, &path, &text) {
            documents.watched = before;
            documents.after_save = None;
            let why = with_remedy(&why, "choose another place with Save as");
            state.apply(Event::Say(Note::error(format!("not saved: {why}"))));
            return false;
        }
        history.mark_saved(&document);
        if document != state.document {
            state.changes += 1;
        }
        if file.folder != state.file.folder {
            // The same files by other names: evaluation has to ask for them anew.
            state.revision += 1;
        }
        (state.document, state.history, state.file) = (document, history, file);
        documents.changed = false;
        documents.saved_at = state.now;
        state.apply(Event::Say(Note::done(format!("saved {}", path.display()))));
        self.remember(&path);
        true
    }

    /// A question for a file, with a folder to begin in and a name.
    fn question(&self, purpose: Purpose) -> Question {
        let file = &self.state.file;
        let last = self.documents.last_folders[usize::from(purpose.saves())].clone();
        let recent = self.documents.recent.files().first().and_then(|path| path.parent());
        let folder = match &file.path {
            // Heads lie where heads lie; all else begins beside the groom.
            Some(_) if !matches!(purpose, Purpose::Mesh | Purpose::NewHead) => file.folder.clone(),
            _ => last.or(recent.map(Path::to_owned)).unwrap_or_else(|| file.folder.clone()),
        };
        let stem = match &file.path {
            Some(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            None => name_of_file(&self.state.document.title),
        };
        let ending = purpose.endings().1.first().copied().unwrap_or_default();
        Question { purpose, folder, name: format!("{stem}.{ending}") }
    }

    /// The suggested path of a new file; `None` without file dialogs.
    pub(super) fn offered_file(&self, purpose: Purpose) -> Option<PathBuf> {
        if self.documents.dialogs.is_none() && !self.documents.no_dialogs {
            return None;
        }
        let Question { folder, name, .. } = self.question(purpose);
        // As a shell has it, where no groom has a folder yet.
        let path = folder.join(name);
        Some(std::path::absolute(&path).unwrap_or(path))
    }

    pub(super) fn ask(&mut self, purpose: Purpose, input: Option<(NodeId, String)>) {
        let question = self.question(purpose);
        let documents = &mut self.documents;
        if documents.no_dialogs {
            documents.browser = Some(super::Browser::new(question.clone(), documents.wake.clone()));
        } else {
            let Some(dialogs) = &mut documents.dialogs else { return };
            dialogs.ask(&question);
        }
        documents.asking = Some(Asking { question, input });
    }

    /// Somebody chose a file, or not.
    pub(super) fn answered(&mut self, path: Option<PathBuf>) {
        let Some(Asking { question, input }) = self.documents.asking.take() else { return };
        let purpose = question.purpose;
        // A panel completes a name by what is chosen in it.
        let has_panel = matches!(purpose, Purpose::Export | Purpose::Picture);
        let complete = |path| if has_panel { path } else { purpose.complete(path) };
        let Some(path) = path.map(complete) else {
            self.documents.after_save = None;
            return;
        };
        let folder = path.parent().map(Path::to_owned);
        self.documents.last_folders[usize::from(purpose.saves())] = folder;
        match (purpose, input) {
            (Purpose::Open, _) => self.apply_to_file(DocumentEvent::Open(path)),
            (Purpose::Compare, _) => self.compare_with(&path),
            (Purpose::NewHead, _) => self.apply_to_file(DocumentEvent::NewHead(path)),
            (Purpose::Save, _) => self.apply_to_file(DocumentEvent::SaveTo(path)),
            (Purpose::Export, _) => self.browsed_export(path),
            (Purpose::Picture, _) => self.browsed_picture(&path),
            (Purpose::Surroundings, _) => self.viewport.surround(&path, self.documents.waker()),
            (Purpose::Find, Some((node, input))) => {
                let name = self.name_for(&path);
                let setting = Setting::Known(Value::Text(name.into()));
                self.apply(crate::core::event::Event::Edit(Edit::SetInput {
                    node,
                    input,
                    setting,
                }));
            }
            (Purpose::Mesh, _) => self.ask_mesh(path),
            (Purpose::Find, None) => self.try_mesh(&path, false),
        }
    }

    /// How the document names a file: relative to its folder, when it has one.
    pub(super) fn name_for(&self, path: &Path) -> String {
        match &self.state.file.path {
            Some(_) => paths::name_in(&self.state.file.folder, path),
            None => {
                let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
                full.to_string_lossy().into_owned()
            }
        }
    }

    /// Writes hair or a picture of the groom as it is now, beside the window.
    pub(in crate::editor) fn export(&mut self, content: Content, path: PathBuf) {
        let Some(evaluation) = &self.evaluation else {
            return self.state.apply(Event::Say(Note::error("there are no threads to export on")));
        };
        let evaluator = evaluation.evaluator();
        self.documents.last_folders[1] = path.parent().map(Path::to_owned);
        let file = self.state.file.clone();
        let mut document = self.state.document.clone();
        if let Content::Picture(_) = content {
            let Camera { eye, target, up, focal_mm, orthographic } = *self.viewport.camera();
            let [eye, target, up] = [eye, target, up].map(|v| v.to_array());
            let view = SavedView { eye, target, up, focal_mm, orthographic };
            document.views.insert(PRESENT.to_owned(), view);
        }
        let allow_large = self.state.allow_large;
        let job = ExportJob { content, document, file, allow_large, evaluator, path };
        if let Err(why) = self.documents.exports.ask(job) {
            self.state.apply(Event::Say(Note::error(why)));
        }
    }

    fn changed_on_disk(&mut self, answer: Disk) {
        let Some(path) = self.state.file.path.clone() else { return };
        match answer {
            Disk::Keep => self.documents.changed = false,
            Disk::Reload => {
                if self.open(&path) {
                    self.state
                        .apply(Event::Say(Note::done(format!("opened again: {}", path.display()))));
                }
            }
            Disk::Compare => self.compare_with_disk(),
        }
    }

    fn left(&mut self, at: usize, answer: Left) {
        if at >= self.documents.leftovers.len() {
            return;
        }
        match answer {
            Left::Restore => self.after_question(Next::Restore(at)),
            Left::Keep => drop(self.documents.leftovers.remove(at)),
            Left::Discard => self.documents.leftovers.remove(at).discard(),
        }
    }

    fn restore(&mut self, at: usize) {
        if at >= self.documents.leftovers.len() {
            return;
        }
        let left = self.documents.leftovers.remove(at);
        let file = left.about.path.clone().map(OpenFile::at).unwrap_or_default();
        let text = format!("restored {}: it is not saved yet", left.about.name);
        // What was restored differs from its file, whatever was done to it since.
        self.put(left.document.clone(), file, History::default());
        self.state.apply(Event::Say(Note::done(text)));
        self.tell_journal();
        if let Some(journal) = &self.documents.journal {
            journal.forget(left);
        }
    }

    /// Hands the document to the journal, when it is another than the last.
    pub(super) fn tell_journal(&mut self) {
        let (state, documents) = (&self.state, &self.documents);
        let Some(journal) = &documents.journal else { return };
        if let Some(why) = journal.fault() {
            self.state
                .apply(Event::Say(Note::warning(format!("the last step is not safe: {why}"))));
            return;
        }
        let now = (state.changes, state.file.path.clone(), state.history.is_changed());
        if state.gesture || documents.told.as_ref() == Some(&now) {
            return;
        }
        if now.2 {
            let about = About { path: now.1.clone(), name: self.title(), at: journal::now() };
            journal.keep(about, state.document.clone());
        } else {
            journal.clear();
        }
        self.documents.told = Some(now);
    }

    /// What the document is called.
    pub(crate) fn title(&self) -> String {
        match &self.state.file.path {
            None if !self.state.document.title.is_empty() => self.state.document.title.clone(),
            _ => self.state.file.name(),
        }
    }

    /// Nothing keeps the window from closing any more, but exports that have to put their things away.
    pub(super) fn leave(&mut self) {
        if self.documents.exports.is_going() {
            self.documents.exports.cancel_all();
            self.documents.closes_after_export = true;
            return;
        }
        self.documents.leaving = true;
        if let Some(journal) = self.documents.journal.take() {
            journal.close();
        }
        self.store_settings();
    }

    fn head_chosen(&mut self, choice: HeadChoice) {
        match choice {
            HeadChoice::Try(placing, drags) => self.try_head(&placing, drags),
            HeadChoice::Accept => self.documents.head = None,
            HeadChoice::Cancel => self.cancel_head(),
        }
        own_head::settle(self);
    }
}

/// What the view of the moment is called where a picture is drawn.
pub(super) const PRESENT: &str = "present view";

/// Reads a groom, with the hash of its bytes. The error is one line, with what to do.
pub(in super::super) fn read(path: &Path) -> Result<(file::Loaded, u64), String> {
    let shown = path.display().to_string();
    let bytes = read_at_most(path, MOST_DOCUMENT)
        .map_err(|why| with_remedy(&format!("{shown}: {why}"), ""))?;
    let loaded = file::read_bytes(&bytes).map_err(|err| {
        let mend = "mend it in a text editor, or open an earlier copy";
        with_remedy(&err.of_file(&shown), mend)
    })?;
    Ok((loaded, hash_of(&bytes)))
}

/// Writes a document's text, and never over a file that the document reads. The error is one line.
fn put(document: &Document, file: &OpenFile, path: &Path, text: &str) -> Result<(), String> {
    let mut files = Together::default();
    let (shown, cancel) = (path.display().to_string(), CancelToken::default());
    named(document)
        .into_iter()
        .map(|(node, _, name)| (file.folder.join(&*name), format!("{name} of {node}")))
        .try_for_each(|(read, words)| files.reads(&read, words))
        .and_then(|()| files.writes(path, Role::Output, shown.clone()))
        .and_then(|()| files.allowed())?;
    files
        .write_text(path, text, &cancel)
        .and_then(|()| files.place(&cancel).map_err(|(_, why)| why))
        .map_err(|why| format!("{shown}: {why}"))
}

/// A title as the name of a file.
fn name_of_file(title: &str) -> String {
    let plain: String = title
        .chars()
        .map(|c| if c.is_alphanumeric() || matches!(c, ' ' | '-' | '_') { c } else { '_' })
        .take(80)
        .collect();
    let name = plain.trim().to_lowercase().replace(' ', "_");
    if name.is_empty() { "groom".to_owned() } else { name }
}

/// The head that a mesh is meant for: the active one, else the first.
pub(super) fn head_of(document: &Document, active: Option<&NodeId>) -> Option<NodeId> {
    let is_head = |node: Option<&Node>| node.is_some_and(|node| node.is_head());
    let active = active.filter(|id| is_head(document.node(id.as_str())));
    let first = document.nodes.keys().find(|id| is_head(document.node(id.as_str())));
    active.or(first).cloned()
}
