//! What the editor knows. Rooms read it; what happens is applied in one place (`apply.rs`).

use crate::core::action::ActionLookup;
use crate::core::lineage::Ancestor;
use crate::core::made::HairTrace;
use crate::core::notes::Notes;
use crate::core::room::Room;
use crate::core::settings::Settings;
use crate::core::shown::{RunStatus, Shown, Trace};
use crate::core::templates::{Offer, ShelfRow};
use crate::core::visibility::Visibility;
use crate::library::fitted::given_between;
use crate::words::counted;
use coif_graphs::document::graph::head_at_hand;
use coif_graphs::document::history::History;
use coif_graphs::document::{Document, Node, NodeId, Socket};
use coif_nodes::data::landmarks::Landmarks;
use coif_nodes::define::{NodeError, Value};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything that more than one room must know.
pub struct State {
    /// The groom.
    pub document: Document,
    /// What was done to it.
    pub history: History,
    /// Goes up with every change of the document that evaluation can see.
    pub revision: u64,
    /// Goes up with every change of the document.
    pub changes: u64,
    /// Where it lies.
    pub file: OpenFile,
    /// What is selected. No undo step.
    pub selection: Selection,
    /// The group whose nodes the canvas shows; none for those in none. No undo step.
    pub group: Option<NodeId>,
    /// The node that the pen works on, whatever is displayed.
    pub pinned: Option<NodeId>,
    /// Inputs that the canvas shows as sockets although they have no wire.
    pub exposed: BTreeSet<Socket>,
    /// What of the hair is hidden, alone, or locked.
    pub visibility: Visibility,
    /// Something is being dragged.
    pub gesture: bool,
    /// The gesture that began last has changed what is evaluated.
    pub changes_hair: bool,
    /// The last good evaluation.
    pub shown: Option<Arc<Shown>>,
    /// The curve that was traced last and its ancestors, each with the node that made it: the hair first.
    pub traced: Vec<Ancestor>,
    /// What made the hair that was asked for last.
    pub made: Option<Arc<HairTrace>>,
    /// What the evaluator does now.
    pub run: RunStatus,
    /// Preferences.
    pub settings: Settings,
    /// Whether nodes may make more than a groom is to have: somebody said so since this document was opened.
    pub allow_large: bool,
    /// What was said.
    pub notes: Notes,
    /// The templates that there are; none until they are read.
    pub(crate) shelf: Option<Arc<Vec<ShelfRow>>>,
    /// The upgrade of an instance that is shown.
    pub(crate) offer: Option<Offer>,
    /// The room that keys are for.
    pub focus: Room,
    /// Seconds since the window opened.
    pub now: f64,
    /// When the last nudge was.
    pub(super) nudged: f64,
    /// What can be done by name.
    pub(crate) table: ActionLookup,
}

impl State {
    /// A document that was just opened or made, in a window in which these things can be done by name.
    pub fn new(
        document: Document,
        file: OpenFile,
        settings: Settings,
        table: ActionLookup,
    ) -> Self {
        Self {
            document,
            history: History::new(),
            revision: 1,
            changes: 0,
            file,
            selection: Selection::default(),
            group: None,
            pinned: None,
            exposed: BTreeSet::new(),
            visibility: Visibility::default(),
            gesture: false,
            changes_hair: false,
            shown: None,
            traced: vec![],
            made: None,
            run: RunStatus::default(),
            settings,
            allow_large: false,
            notes: Notes::default(),
            shelf: None,
            offer: None,
            focus: Room::Viewport,
            now: 0.0,
            nudged: f64::NEG_INFINITY,
            table,
        }
    }

    /// What people call a node of this id, as reports name it.
    pub fn called<'a>(&'a self, id: &'a str) -> Cow<'a, str> {
        let id = self.document.nodes.get_key_value(id).map(|(id, _)| id);
        id.map_or_else(Cow::default, |id| self.document.name_of(id))
    }

    /// Forgets what is gone: a selection, the node of the pen, and the group that is shown.
    pub fn keep(&mut self) {
        self.selection.keep(&self.document);
        if self.pinned.as_ref().is_some_and(|id| !self.document.nodes.contains_key(id)) {
            self.pinned = None;
        }
        let is_there = |id: &NodeId| self.document.node(id.as_str()).is_some_and(Node::is_group);
        while self.group.as_ref().is_some_and(|id| !is_there(id)) {
            self.group = self.group.as_ref().and_then(NodeId::group);
        }
    }

    /// What runs and how much of it is left: "Interpolate (62 %), 3 of 9 nodes left".
    pub fn left_to_run(&self) -> String {
        let ((done, of), (pieces, all)) = (self.run.nodes, self.run.pieces);
        let mut text = self.called(&self.run.node).into_owned();
        if all > 1 {
            text += &format!(" ({} %)", 100 * pieces / all);
        }
        if of > 0 {
            text += &format!(", {} of {} left", of.saturating_sub(done), counted(of, "node"));
        }
        text
    }

    /// Whether something is dragged that changes hair: previews are enough. A node that is moved on the canvas changes none.
    pub fn drags_hair(&self) -> bool {
        self.gesture && self.changes_hair
    }

    /// Whether a node would make more than a groom is to have, and is not allowed to.
    pub fn is_too_large(&self) -> bool {
        let mut nodes = self.run.reports.nodes.values();
        !self.allow_large
            && nodes.any(|report| matches!(report.error, Some(NodeError::TooLarge(_))))
    }

    /// Whether what is shown is not what the document says now.
    pub fn stale(&self) -> bool {
        let shown = self.shown.as_ref();
        shown.is_none_or(|shown| shown.head_alone || shown.revision != self.revision)
    }

    /// The question about a displayed curve; none where nothing is displayed.
    pub(crate) fn trace(&self, id: u64) -> Option<Trace> {
        let quality = self.shown.as_ref()?.quality;
        let (document, folder) = (self.document.clone(), self.file.folder.clone());
        Some(Trace { id, document, folder, quality, allow_large: self.allow_large })
    }

    /// The landmarks between which strokes on a head are given; none before it has been seen.
    pub(crate) fn landmarks_of(&self, head: &NodeId) -> Option<Landmarks> {
        let output = Socket::new(head.clone(), "scalp");
        // Of several heads the first may be another one; scalps of one head have the same landmarks.
        let marks = self.shown.as_ref().and_then(|shown| match shown.values.get(&output) {
            Some(Value::Scalp(scalp)) => Some(scalp.landmarks()),
            _ => shown
                .scalp()
                .map(|scalp| scalp.landmarks())
                .filter(|marks| shown.scalps.iter().all(|scalp| scalp.landmarks().same(marks))),
        });
        given_between(&self.document, head, marks)
    }

    /// Those of the head at hand.
    pub(crate) fn landmarks_at_hand(&self) -> Option<Landmarks> {
        self.landmarks_of(&head_at_hand(&self.document)?)
    }

    /// The node that keys and the inspector mean: the active one, if it is still there.
    pub fn active(&self) -> Option<&NodeId> {
        self.selection.active.as_ref().filter(|id| self.document.nodes.contains_key(*id))
    }
}

/// Where the document lies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenFile {
    /// Its file; none before the first save.
    pub path: Option<PathBuf>,
    /// The folder that its paths are relative to.
    pub folder: PathBuf,
}

impl OpenFile {
    /// A file; its folder is what holds it.
    pub fn at(path: PathBuf) -> Self {
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        Self { path: Some(path), folder }
    }
    /// The name for titles.
    pub fn name(&self) -> String {
        let name = self.path.as_ref().and_then(|path| path.file_name());
        name.map_or_else(|| "untitled".to_owned(), |name| name.to_string_lossy().into_owned())
    }
}

/// What is selected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Nodes on the canvas.
    pub nodes: BTreeSet<NodeId>,
    /// The one that was selected last.
    pub active: Option<NodeId>,
    /// Displayed curves, by id.
    pub curves: BTreeSet<u64>,
}

/// How a selection changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Select {
    /// Exactly these nodes; the last is active.
    Nodes(Vec<NodeId>),
    /// This node too, as the active one; off again when it was selected.
    Toggle(NodeId),
    /// Exactly these curves.
    Curves(BTreeSet<u64>),
    /// Nothing at all.
    Nothing,
}

impl Selection {
    /// Changes the selection.
    pub fn change(&mut self, select: Select) {
        match select {
            Select::Nodes(nodes) => {
                self.active = nodes.last().cloned();
                self.nodes = nodes.into_iter().collect();
            }
            Select::Toggle(node) => {
                if self.nodes.remove(&node) {
                    if self.active.as_ref() == Some(&node) {
                        self.active = self.nodes.last().cloned();
                    }
                } else {
                    self.nodes.insert(node.clone());
                    self.active = Some(node);
                }
            }
            Select::Curves(curves) => self.curves = curves,
            Select::Nothing => *self = Self::default(),
        }
    }

    /// Forgets nodes that are gone.
    pub fn keep(&mut self, document: &Document) {
        self.nodes.retain(|id| document.nodes.contains_key(id));
        if self.active.as_ref().is_some_and(|id| !document.nodes.contains_key(id)) {
            self.active = self.nodes.last().cloned();
        }
    }
}
