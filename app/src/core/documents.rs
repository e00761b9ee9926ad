//! What can happen to a document as a whole: new, opened, saved, exported, given another head.

use crate::core::shown::Sides;
use coif_graphs::document::NodeId;
use std::path::PathBuf;

/// Something that happened to a document as a whole.
#[derive(Clone, Debug)]
pub enum DocumentEvent {
    /// A new document: a shipped groom by its name, or the empty head.
    New(Option<&'static str>),
    /// A new document on which an action, a recipe's, is done at once.
    Begin(&'static str),
    /// A file is opened.
    Open(PathBuf),
    /// Saves to its file; asks for one where there is none.
    Save,
    /// Saves to a file, which is the document's from then on.
    SaveTo(PathBuf),
    /// Asks for a file.
    Ask(Purpose),
    /// Asks for a file that a node's input is missing.
    Find(NodeId, String),
    /// A mesh becomes the head; over hair it is asked first whether that stays.
    Mesh(PathBuf),
    /// A new document with nothing but a mesh as its head.
    NewHead(PathBuf),
    /// A mesh becomes the head over hair.
    MeshOver {
        /// Its file.
        path: PathBuf,
        /// The hair goes.
        bald: bool,
    },
    /// The head stands as it should, or is taken back.
    Head(HeadChoice),
    /// The panel that exports hair opens.
    ExportPanel,
    /// The panel that saves pictures opens.
    PicturePanel,
    /// What is written now stops.
    StopExport,
    /// The groom is shown beside its file as it was saved.
    CompareWithSaved,
    /// The picture shows this groom and the one beside it another way.
    Sides(Sides),
    /// The groom is shown alone again.
    EndCompare,
    /// The window is to be closed.
    Close,
    /// What becomes of unsaved changes.
    Unsaved(Unsaved),
    /// What becomes of a file that others changed.
    Disk(Disk),
    /// What becomes of what a session left: its number in the list.
    Left(usize, Left),
    /// A file is not offered as recent any more.
    Forget(PathBuf),
    /// The welcome panel opens or closes.
    Welcome(bool),
}

/// What becomes of unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsaved {
    /// They are saved first.
    Save,
    /// They are lost.
    Discard,
    /// Nothing happens at all.
    Cancel,
}

/// What becomes of a file that others changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disk {
    /// It is opened again.
    Reload,
    /// The document stays; saving replaces the file.
    Keep,
    /// Both are shown side by side.
    Compare,
}

/// What becomes of what a session left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Left {
    /// It is opened.
    Restore,
    /// It is offered again at the next start.
    Keep,
    /// It is removed for good.
    Discard,
}

/// What becomes of a head that was just chosen.
#[derive(Clone, Debug)]
pub enum HeadChoice {
    /// It stands otherwise. `true`: somebody drags.
    Try(Placing, bool),
    /// It stays as it stands.
    Accept,
    /// The head from before comes back.
    Cancel,
}

/// What a file is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A groom to open.
    Open,
    /// A groom to compare this one with.
    Compare,
    /// A mesh for the head.
    Mesh,
    /// A mesh for the head of a new groom.
    NewHead,
    /// A mesh instead of one that is missing, for the same node.
    Find,
    /// Where the groom is saved.
    Save,
    /// Where hair is written.
    Export,
    /// Where a picture is written.
    Picture,
    /// A photographed sphere that lights the picture.
    Surroundings,
}

/// How a head is understood: the inputs of the head node that people may have to correct.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placing {
    /// Degrees about the up axis.
    pub turn: f32,
    /// The axis that the face looks along; empty finds the face.
    pub forward: &'static str,
    /// The axis that points up in the file; empty takes Y, and another one where no head is found so.
    pub up: &'static str,
    /// What is no head, as the head node's `leave_out` names it.
    pub leave_out: Vec<String>,
    /// Centimetres in one unit of the file; 0 finds them.
    pub scale: f32,
    /// Radius of the cranium, cm; 0 keeps the fitted sphere.
    pub radius: f32,
    /// Whether the mesh is no human head and keeps its own axes.
    pub no_head: bool,
}
