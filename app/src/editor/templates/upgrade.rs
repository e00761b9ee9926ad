//! Newer versions of the templates that a groom is made of: which there are, what one would change, and the change itself.
//!
//! Guarantees: nothing changes before it was told value by value; an upgrade is one undo step, and so is keeping a version for good;
//! an instance whose template is in no library loses nothing.

use super::{Listed, Row, Which};
use crate::editor::Editor;
use crate::editor::event::Event as EditorEvent;
use crate::editor::notes::Note;
use crate::editor::state::State;
use crate::library::{self, Entry};
use coif_graphs::document::{NodeId, Origin};
use coif_graphs::template::{self, Told};
use std::cmp::Ordering;
use std::sync::Arc;

/// What the library has for an instance.
pub(crate) enum Newer<'a> {
    /// A version that is not what the instance was made of.
    There(&'a Arc<Listed>),
    /// None; the instance is of the newest.
    Newest,
    /// The library has no template of this name.
    Missing,
    /// It is not known yet.
    Unread,
}

/// What the library has for an instance.
pub(crate) fn newer<'a>(state: &'a State, origin: &Origin) -> Newer<'a> {
    let Some(shelf) = &state.shelf else { return Newer::Unread };
    let version = |it: &Listed| it.origin.version.clone();
    let all = shelf.iter().filter_map(|row| match row {
        Row::Found(it) if it.origin.name == origin.name => Some(it),
        _ => None,
    });
    let newest = all.reduce(|a, b| {
        if library::by_version(&version(b), &version(a)) == Ordering::Greater { b } else { a }
    });
    match newest {
        None => Newer::Missing,
        Some(it) if it.hash == origin.hash => Newer::Newest,
        Some(it) if library::by_version(&version(it), &origin.version) == Ordering::Less => {
            Newer::Newest
        }
        Some(it) => Newer::There(it),
    }
}

/// An upgrade that is shown before it is done.
#[derive(Clone)]
pub(crate) struct Offer {
    /// The instance.
    pub(crate) id: NodeId,
    /// What comes in its place.
    entry: Arc<Entry>,
    /// As of so many changes of the document.
    of: u64,
    /// What becomes of every value and wire on it.
    pub(crate) told: Vec<Told>,
    /// What is in it was changed since it was made: that would go.
    pub(crate) changed_inside: bool,
}

impl Offer {
    /// The version that would come.
    pub(crate) fn version(&self) -> &str {
        &self.entry.origin.version
    }
}

impl Editor {
    /// Reads a template, to show what upgrading to it would do.
    pub(super) fn show_fates(&mut self, id: NodeId, Which(listed): Which) {
        self.read_listed(&listed, super::deed::Purpose::Compare(id));
    }

    /// Shows what an upgrade would do.
    pub(super) fn offer(&mut self, id: NodeId, entry: Entry) {
        self.state.offer = self.offered(id, entry.into());
    }

    fn offered(&mut self, id: NodeId, entry: Arc<Entry>) -> Option<Offer> {
        match template::upgrade(&self.state.document, &id, &entry.document) {
            Ok(upgrade) => Some(Offer {
                id,
                entry,
                of: self.state.changes,
                told: upgrade.told,
                changed_inside: upgrade.changed_inside,
            }),
            Err(why) => {
                self.apply(EditorEvent::Say(Note::warning(why).of(id)));
                None
            }
        }
    }

    /// Does the upgrade that is shown; what is shown follows the document.
    pub(super) fn upgrade(&mut self) {
        let Some(offer) = self.state.offer.take() else { return };
        match template::upgrade(&self.state.document, &offer.id, &offer.entry.document) {
            Err(why) => self.apply(EditorEvent::Say(Note::warning(why).of(offer.id))),
            Ok(upgrade) => {
                let name = self.state.document.name_of(&offer.id).into_owned();
                let version = offer.version();
                self.apply(EditorEvent::Begin(format!("{name}: upgraded to version {version}")));
                self.apply(EditorEvent::Edit(upgrade.edit));
                self.apply(EditorEvent::End);
            }
        }
    }

    /// Keeps an instance at its version for good, or lets it be upgraded again.
    pub(super) fn keep_version(&mut self, id: &NodeId, kept: bool) {
        self.state.offer = None;
        if let Some(edit) = template::lock(&self.state.document, id, kept) {
            let name = self.state.document.name_of(id).into_owned();
            let words = if kept { "kept at its version" } else { "upgraded again where it can be" };
            self.apply(EditorEvent::Begin(format!("{name}: {words}")));
            self.apply(EditorEvent::Edit(edit));
            self.apply(EditorEvent::End);
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
