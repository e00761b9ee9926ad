//! Templates as the window knows them: what is on the shelf, which versions are newer, an upgrade that is shown before it is done, and
//! what can happen to them.

use crate::core::event::Event;
use crate::core::state::State;
use crate::library::{self, LibraryEntry};
use coif_graphs::document::{NodeId, Origin, Point, Thumbnail};
use coif_graphs::template::OverrideOutcome;
use egui::{Context, DragAndDrop};
use std::cmp::Ordering;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What happens to templates.
#[derive(Clone, Debug)]
pub enum TemplateEvent {
    /// One is added to the group that the canvas shows.
    Add {
        /// Which.
        template: Which,
        /// Where on the canvas; none: in the middle of what is in sight.
        at: Option<Point>,
    },
    /// The panel opens that makes one of what is selected.
    Save,
    /// One's file gets a picture.
    Thumbnail(PathBuf),
    /// What upgrading an instance would do is shown.
    Compare {
        /// The instance.
        id: NodeId,
        /// What would come in its place.
        template: Which,
    },
    /// The upgrade that is shown is done.
    Upgrade,
    /// It is not done.
    NotNow,
    /// An instance stays at its version for good, or no longer.
    Keep {
        /// The instance.
        id: NodeId,
        /// Whether it stays.
        kept: bool,
    },
}

/// A template on the shelf.
#[derive(Clone, Debug)]
pub struct Which(pub(crate) Arc<Listed>);

/// A template as it is listed.
#[derive(Debug)]
pub(crate) struct Listed {
    pub(crate) origin: Origin,
    pub(crate) title: String,
    pub(crate) description: String,
    pub(crate) hash: String,
    /// What it takes, in words.
    pub(crate) takes: String,
    /// Where it comes from: coif, its reader's own folder, or a show's folder by name.
    pub(crate) place: String,
    pub(crate) thumbnail: Option<Thumbnail>,
    /// Its file; none where it comes with coif.
    pub(crate) path: Option<PathBuf>,
    /// All that it is found by, in small letters.
    pub(crate) said: String,
}

/// A file that is no template.
#[derive(Debug)]
pub(crate) struct Broken {
    pub(crate) path: PathBuf,
    pub(crate) place: String,
    pub(crate) why: String,
    /// All that it is found by, in small letters.
    pub(crate) said: String,
}

impl Broken {
    pub(crate) fn row(path: &Path, place: &str, why: String) -> ShelfRow {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let said = format!("{name}\n{place}\n{why}").to_lowercase();
        ShelfRow::Broken(Self { path: path.to_owned(), place: place.to_owned(), why, said }.into())
    }
}

/// A line of the shelf.
#[derive(Clone, Debug)]
pub(crate) enum ShelfRow {
    /// A template.
    Found(Arc<Listed>),
    /// A file that is none.
    Broken(Arc<Broken>),
}

impl ShelfRow {
    /// What people read.
    pub(crate) fn title(&self) -> &str {
        match self {
            Self::Found(it) => &it.title,
            Self::Broken(it) => it.path.file_name().and_then(|name| name.to_str()).unwrap_or("?"),
        }
    }

    /// One name for it that no other has.
    pub(crate) fn key(&self) -> String {
        match self {
            Self::Found(it) => match &it.path {
                Some(path) => path.display().to_string(),
                None => it.origin.name.clone(),
            },
            Self::Broken(it) => it.path.display().to_string(),
        }
    }

    /// Whether every word, in small letters, is found in what it says of itself.
    pub(crate) fn says(&self, words: &[String]) -> bool {
        let text = match self {
            Self::Found(it) => &it.said,
            Self::Broken(it) => &it.said,
        };
        words.iter().all(|word| text.contains(word.as_str()))
    }
}

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
        ShelfRow::Found(it) if it.origin.name == origin.name => Some(it),
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
    pub(crate) entry: Arc<LibraryEntry>,
    /// As of so many changes of the document.
    pub(crate) of: u64,
    /// What becomes of every value and wire on it.
    pub(crate) overrides: Vec<OverrideOutcome>,
    /// What is in it was changed since it was made: that would go.
    pub(crate) changed_inside: bool,
}

impl Offer {
    /// The version that would come.
    pub(crate) fn version(&self) -> &str {
        &self.entry.origin.version
    }
}

/// A template in the hand.
pub(crate) struct DraggedTemplate {
    pub(crate) template: Arc<Listed>,
    pub(crate) picture: Option<egui::TextureHandle>,
}

/// The template that was let go of over a place of the canvas, as what happened.
pub(crate) fn dropped(ctx: &Context, at: Point) -> Option<Event> {
    if !ctx.input(|input| input.pointer.any_released()) {
        return None;
    }
    let held = DragAndDrop::take_payload::<DraggedTemplate>(ctx)?;
    let template = Which(held.template.clone());
    Some(Event::Templates(TemplateEvent::Add { template, at: Some(at) }))
}
