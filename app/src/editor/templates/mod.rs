//! What is done with templates: one is added to the document, one's file gets a picture.

pub(super) mod save;
mod upgrade;

use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::state::Select;
use crate::core::templates::{Listed, TemplateEvent, Which};
use crate::editor::Editor;
use crate::files::Together;
use crate::jobs::thumbnail;
use crate::library::{self, LibraryEntry};
use crate::rooms::templates::at_work::{ReadPurpose, Reading};
use coif_graphs::document::Point;
use coif_graphs::grooms;
use coif_graphs::schedule::run::{CancelToken, Quiet};
use coif_graphs::template::{self, Added, Placement};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

impl Editor {
    /// Something happens to templates.
    pub(crate) fn apply_to_templates(&mut self, event: TemplateEvent) {
        match event {
            TemplateEvent::Add { template: Which(listed), at } => {
                self.read_listed(&listed, ReadPurpose::Add(at));
            }
            TemplateEvent::Compare { id, template } => self.show_fates(id, template),
            TemplateEvent::Upgrade => self.upgrade(),
            TemplateEvent::NotNow => self.state.offer = None,
            TemplateEvent::Keep { id, kept } => self.keep_version(&id, kept),
            TemplateEvent::Thumbnail(path) => self.make_thumbnail(path),
            TemplateEvent::Save => self.ask_to_save_template(),
        }
    }

    /// Reads a template for a purpose: what comes with coif at once, a file on a thread.
    pub(super) fn read_listed(&mut self, listed: &Listed, purpose: ReadPurpose) {
        let Some(path) = listed.path.clone() else {
            let name = &listed.origin.name;
            let text = grooms::TEMPLATES.iter().find(|(known, _)| known == name);
            let read = text.ok_or_else(|| "it does not come with this version".to_owned());
            return self.take_read(read.and_then(|(_, text)| library::shipped(text)), purpose);
        };
        // A folder that hangs keeps nobody waiting.
        let reading = Arc::new(Mutex::new(Reading { read: None, purpose }));
        let (to, wake) = (reading.clone(), self.documents.waker());
        let begun = std::thread::Builder::new().name("template".to_owned()).spawn(move || {
            let read = library::read(&path).map_err(|why| format!("{}: {why}", path.display()));
            to.lock().unwrap_or_else(PoisonError::into_inner).read = Some(read);
            wake();
        });
        match begun {
            Ok(_) => self.templates.at_work.reading = Some(reading),
            Err(why) => self.apply(Event::Say(Note::error(why.to_string()))),
        }
    }

    fn take_read(&mut self, read: Result<LibraryEntry, String>, purpose: ReadPurpose) {
        match (read, purpose) {
            (Err(why), _) => self.apply(Event::Say(Note::warning(why))),
            (Ok(entry), ReadPurpose::Add(at)) => self.add_template(&entry, at),
            (Ok(entry), ReadPurpose::Compare(id)) => self.offer(id, entry),
        }
    }

    /// Adds a template to the group that the canvas shows, in one step, and selects it.
    fn add_template(&mut self, entry: &LibraryEntry, at: Option<Point>) {
        let within = self.state.group.clone();
        let at = at.or_else(|| self.canvas.middle(&self.state.document));
        let drawn = self.state.active().cloned();
        let fitted = entry.fitted(self.state.landmarks_at_hand().as_ref());
        let place = Placement {
            within: within.as_ref(),
            at,
            drawn: drawn.as_ref(),
            hash: Some(&entry.hash),
        };
        let added = match template::add(&self.state.document, &fitted, place) {
            Ok(added) => added,
            Err(why) => {
                let note = Note::warning(format!("{}: {why}", entry.title));
                return self.apply(Event::Say(note));
            }
        };
        let Added { edit, id, draws } = added;
        self.apply(Event::Begin(format!("template: {}", entry.title.to_lowercase())));
        self.apply(Event::Edit(edit));
        self.apply(Event::End);
        self.apply(Event::Select(Select::Nodes(vec![id.clone()])));
        if entry.is_changed_in(&fitted) {
            let text = "Fitted to this head, so it now differs from its template. To upgrade it later, choose Upgrade all the same";
            self.apply(Event::Say(Note::done(text).of(id)));
        }
        // What it has drawn for it waits for the pen.
        if let Some(draws) = draws {
            self.apply(Event::TakeUpPen(draws));
        }
    }

    fn make_thumbnail(&mut self, path: PathBuf) {
        if self.templates.at_work.is_busy() {
            return;
        }
        let done = Arc::new(Mutex::new(None));
        let (to, wake, file) = (done.clone(), self.documents.waker(), path.clone());
        let begun = std::thread::Builder::new().name("thumbnail".to_owned()).spawn(move || {
            let drawn = drawn(&file);
            *to.lock().unwrap_or_else(PoisonError::into_inner) = Some(drawn);
            wake();
        });
        match begun {
            Ok(_) => {
                self.templates.at_work.drawing = Some(done);
                self.templates.at_work.path = path;
            }
            Err(why) => self.apply(Event::Say(Note::error(why.to_string()))),
        }
    }

    /// Takes what threads have done.
    pub(crate) fn settle_templates(&mut self, ctx: &egui::Context) {
        self.save_template_panel(ctx);
        self.settle_written(ctx);
        let at_work = &mut self.templates.at_work;
        let read = at_work.reading.as_ref().and_then(|reading| {
            let mut reading = reading.lock().unwrap_or_else(PoisonError::into_inner);
            Some((reading.read.take()?, reading.purpose.clone()))
        });
        let done = at_work
            .drawing
            .as_ref()
            .and_then(|done| done.lock().unwrap_or_else(PoisonError::into_inner).take());
        if read.is_some() {
            at_work.reading = None;
        }
        if let Some(done) = done {
            at_work.drawing = None;
            let note = match done {
                Ok(()) => Note::done(format!("thumbnail kept in {}", at_work.path.display())),
                Err(why) => Note::error(why),
            };
            self.apply(Event::Say(note));
            self.templates.look(ctx);
        }
        if let Some((read, purpose)) = read {
            self.take_read(read, purpose);
        }
        // What a groom is made of is compared with what there is.
        let shelf = &self.templates.shelf;
        if shelf.is_new()
            && !shelf.is_looking()
            && template::instances(&self.state.document).next().is_some()
        {
            self.templates.look(ctx);
        }
        self.state.shelf = (!shelf.is_new()).then(|| shelf.rows());
        self.keep_offer();
    }
}

fn drawn(path: &std::path::Path) -> Result<(), String> {
    let (cancel, mut files) = (CancelToken::default(), Together::default());
    thumbnail::renew(path, thumbnail::SIZE, thumbnail::CAMERA, &Quiet, &cancel, &mut files)
        .map_err(|stop| stop.lines().join("; "))?;
    files.place(&cancel).map_err(|(path, why)| format!("{}: {why}", path.display()))
}
