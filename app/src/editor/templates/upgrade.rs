//! Newer versions of the templates that a groom is made of: which there are, what one would change, and the change itself.
//!
//! Guarantees: nothing changes before it was told value by value; an upgrade is one undo step, and so is keeping a version for good;
//! an instance whose template is in no library loses nothing.

use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::templates::{Offer, Which};
use crate::editor::Editor;
use crate::library::LibraryEntry;
use crate::rooms::templates::at_work::ReadPurpose;
use coif_graphs::document::NodeId;
use coif_graphs::template;
use std::sync::Arc;

impl Editor {
    /// Reads a template, to show what upgrading to it would do.
    pub(super) fn show_fates(&mut self, id: NodeId, Which(listed): Which) {
        self.read_listed(&listed, ReadPurpose::Compare(id));
    }

    /// Shows what an upgrade would do.
    pub(super) fn offer(&mut self, id: NodeId, entry: LibraryEntry) {
        self.state.offer = self.offered(id, entry.into());
    }

    fn offered(&mut self, id: NodeId, entry: Arc<LibraryEntry>) -> Option<Offer> {
        match template::upgrade(&self.state.document, &id, &entry.document) {
            Ok(upgrade) => Some(Offer {
                id,
                entry,
                of: self.state.changes,
                overrides: upgrade.overrides,
                changed_inside: upgrade.changed_inside,
            }),
            Err(why) => {
                self.apply(Event::Say(Note::warning(why).of(id)));
                None
            }
        }
    }

    /// Does the upgrade that is shown; what is shown follows the document.
    pub(super) fn upgrade(&mut self) {
        let Some(offer) = self.state.offer.take() else { return };
        match template::upgrade(&self.state.document, &offer.id, &offer.entry.document) {
            Err(why) => self.apply(Event::Say(Note::warning(why).of(offer.id))),
            Ok(upgrade) => {
                let name = self.state.document.name_of(&offer.id).into_owned();
                let version = offer.version();
                self.apply(Event::Begin(format!("{name}: upgraded to version {version}")));
                self.apply(Event::Edit(upgrade.edit));
                self.apply(Event::End);
            }
        }
    }

    /// Keeps an instance at its version for good, or lets it be upgraded again.
    pub(super) fn keep_version(&mut self, id: &NodeId, kept: bool) {
        self.state.offer = None;
        if let Some(edit) = template::lock(&self.state.document, id, kept) {
            let name = self.state.document.name_of(id).into_owned();
            let words = if kept { "kept at its version" } else { "upgraded again where it can be" };
            self.apply(Event::Begin(format!("{name}: {words}")));
            self.apply(Event::Edit(edit));
            self.apply(Event::End);
        }
    }

    /// What is shown follows the document.
    pub(super) fn keep_offer(&mut self) {
        let Some(offer) = &self.state.offer else { return };
        if offer.of == self.state.changes || self.state.gesture {
            return;
        }
        let Offer { id, entry, .. } = offer.clone();
        let is_there =
            self.state.document.node(id.as_str()).is_some_and(|node| node.template.is_some());
        self.state.offer = if is_there { self.offered(id, entry) } else { None };
    }
}
