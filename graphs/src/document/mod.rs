//! A groom as it is edited: nodes, the wires between them, and where they stand on the canvas.
//!
//! A [`Document`] is plain data. It is changed through [`edit::Edit`]s, each of which has an
//! inverse; it is snapshot by cloning, which copies a pointer for each node. What it says is not
//! proven here: a document may name nodes that do not exist or hold wires in a circle, as files do
//! after a merge. [`graph::check`] says so.
//!
//! Documents know nothing of evaluation or windows, and open no files.

use budget::Budget;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::declared::{self, Interface, is_name};
use coif_nodes::define::{Arity, NodeDef, Value, short};
use coif_nodes::maths::hash::KeyBuilder;
use std::borrow::{Borrow, Cow};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Write as _};
use std::sync::Arc;

pub mod budget;
pub mod edit;
pub mod gestures;
pub mod graph;
pub mod groups;
pub mod history;
mod layout;
pub mod strokes;
#[cfg(test)]
pub(crate) mod testing;
mod thumbnail;
pub mod wiring;

pub use layout::{Frame, LONGEST_NAME, SavedLook, SavedView};
pub use thumbnail::Thumbnail;

/// A groom as it is edited. Cloning is the snapshot: maps of pointers are copied, nodes are shared.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Document {
    /// What people call it.
    pub title: String,
    /// Free text.
    pub note: String,
    /// All randomness hangs from it.
    pub seed: u64,
    /// What it may take.
    pub budget: Budget,
    /// The node that the viewport shows.
    pub display: Option<NodeId>,
    /// Every node.
    pub nodes: BTreeMap<NodeId, Arc<Node>>,
    /// For each wired input the outputs it takes from, in order. No list is empty.
    pub links: BTreeMap<Socket, Vec<Socket>>,
    /// Boxes behind nodes, by name.
    pub frames: BTreeMap<String, Frame>,
    /// For each input with a bent wire, the bends of each of its wires in order, from the output on.
    pub bends: BTreeMap<Socket, Vec<Vec<Point>>>,
    /// Nodes that are drawn small.
    pub collapsed: BTreeSet<NodeId>,
    /// Cameras that were saved, by name.
    pub views: BTreeMap<String, SavedView>,
    /// Light and skin that it is looked at with; none where nobody chose.
    pub look: Option<SavedLook>,
    /// Where nodes stand on the canvas, in its own units. Means nothing to evaluation.
    pub layout: BTreeMap<NodeId, Point>,
    /// What it looks like, small: of templates.
    pub thumbnail: Option<Thumbnail>,
    /// Comment lines of a hand-edited file, each with its `//`, by the entry that they stand
    /// before.
    pub comments: BTreeMap<FileEntry, Vec<String>>,
}

/// An id as [`Document::free_id`] made it: its stem, and the number behind that.
fn numbered(id: &str) -> (&str, Option<u32>) {
    let parts = id.rsplit_once('_').and_then(|(stem, n)| Some((stem, n.parse().ok()?)));
    parts.map_or((id, None), |(stem, n)| (stem, Some(n)))
}

/// So many numbers are asked one after the other.
const FEW: u32 = 8;

/// A number from 2 on that is not taken: the first one, or where there are many, one behind a number that is taken.
fn free_number(mut is_taken: impl FnMut(u32) -> bool) -> u32 {
    if let Some(first) = (2..FEW).find(|n| !is_taken(*n)) {
        return first;
    }
    let (mut taken, mut free) = (FEW - 1, FEW);
    while is_taken(free) {
        let Some(next) = free.checked_mul(2) else {
            return (FEW..).find(|n| !is_taken(*n)).unwrap_or(FEW);
        };
        (taken, free) = (free, next);
    }
    while free - taken > 1 {
        let middle = taken + (free - taken) / 2;
        if is_taken(middle) { taken = middle } else { free = middle }
    }
    free
}

/// A place on the canvas: right, down. Compared by its bits, so that equality holds for every
/// value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point(pub f32, pub f32);

impl Point {
    /// Whether both numbers are finite.
    pub fn is_finite(self) -> bool {
        self.0.is_finite() && self.1.is_finite()
    }
}

impl PartialEq for Point {
    fn eq(&self, other: &Self) -> bool {
        (self.0.to_bits(), self.1.to_bits()) == (other.0.to_bits(), other.1.to_bits())
    }
}
impl Eq for Point {}

/// One node of a document.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// What it does: the id of a `NodeDef`, or one that this version does not know.
    pub kind: String,
    /// What people call it; never empty when there.
    pub label: Option<String>,
    /// Free text.
    pub note: String,
    /// Passes its first input of its output's type through.
    pub bypass: bool,
    /// The inputs that are set; others have their defaults. A wire goes before a setting.
    pub inputs: BTreeMap<String, Setting>,
    /// What a group takes and gives, or the parameters there are; of other kinds none.
    pub interface: Option<Interface>,
    /// Of a group that was made of a template: which.
    pub template: Option<Arc<Origin>>,
}

/// The template that a group was made of. The group holds all of it, so this is a mark: what it is compared with, and
/// where a newer one is looked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// The name that libraries know it by.
    pub name: String,
    /// Its version, for people.
    pub version: String,
    /// The hash of its meaning when the group was made or upgraded, in hexadecimal.
    pub hash: String,
    /// Stays at this version for good.
    pub locked: bool,
    /// Who made it.
    pub author: String,
    /// Under which licence it is given, as an SPDX identifier where there is one.
    pub licence: String,
    /// Words that it is found by.
    pub tags: Vec<String>,
    /// Where the style comes from.
    pub source: String,
    /// What it needs of a head besides a scalp: names of landmarks and regions.
    pub needs: Vec<String>,
}

/// What an input is set to.
#[derive(Clone, Debug)]
pub enum Setting {
    /// A value that the node's declaration explains.
    Known(Value),
    /// RON text that it does not: the node's kind, the input or the form of the value is unknown.
    /// Kept byte for byte, so that a groom passes unharmed through a version that knows less.
    Raw(Arc<str>),
}

impl PartialEq for Setting {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Setting::Raw(a), Setting::Raw(b)) => a == b,
            (Setting::Known(a), Setting::Known(b)) => {
                std::mem::discriminant(a) == std::mem::discriminant(b)
                    && a.key() == b.key()
                    && drawn_alike(a, b)
            }
            _ => false,
        }
    }
}
impl Eq for Setting {}

/// Whether strokes were drawn the same way, which their keys do not say.
fn drawn_alike(a: &Value, b: &Value) -> bool {
    let (Value::Strokes(a), Value::Strokes(b)) = (a, b) else { return true };
    let drawn = |strokes: &Strokes| {
        let key = KeyBuilder::new("drawn");
        strokes.0.iter().fold(key, |key, stroke| key.column(&stroke.drawn)).finish()
    };
    Arc::ptr_eq(a, b) || drawn(a) == drawn(b)
}

/// The name of a node within its document: a short word made once, never changed, never shown where
/// a label can be. Of a node in a group it is the group's, a slash and the word: `row/braid`.
///
/// **Invariant:** words of `[a-z][a-z0-9_]*`, at most 64 bytes each and 16 of them.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(Arc<str>);

/// The most bytes of a node's id: it is a word that people read in messages and merges.
const LONGEST_ID: usize = 64;
/// The most groups within groups, and the node in them.
pub const DEEPEST_GROUP: usize = 16;

/// Why a text is no id.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is no node id: use a lower case letter, then letters, digits and underscores, at most 64, and within groups / \
     between up to 16 of these"
)]
pub struct BadId(pub String);

impl NodeId {
    /// The id that reads `text`.
    pub fn new(text: &str) -> Result<Self, BadId> {
        // The names of ports are words of the same form.
        let words = text.split('/').take(DEEPEST_GROUP + 1);
        if text.len() > DEEPEST_GROUP * (LONGEST_ID + 1)
            || !words.clone().all(is_name)
            || words.count() > DEEPEST_GROUP
        {
            return Err(BadId(text.chars().take(LONGEST_ID).collect()));
        }
        Ok(Self(text.into()))
    }
    /// The group that it is in; none where it is in none.
    pub fn group(&self) -> Option<NodeId> {
        self.0.rsplit_once('/').map(|(group, _)| Self(group.into()))
    }
    /// Its own word, without the groups that it is in.
    pub fn word(&self) -> &str {
        self.0.rsplit_once('/').map_or(&self.0, |(_, word)| word)
    }
    /// The node of that id in `group`, or in none.
    pub fn within(group: Option<&NodeId>, id: &str) -> Result<Self, BadId> {
        match group {
            Some(group) => Self::new(&format!("{group}/{id}")),
            None => Self::new(id),
        }
    }
    /// Whether it is in `group`, or in groups in it.
    pub fn is_inside(&self, group: &NodeId) -> bool {
        self.0.strip_prefix(group.as_str()).is_some_and(|rest| rest.starts_with('/'))
    }
    /// As text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}
impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}
impl fmt::Debug for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}
impl Borrow<str> for NodeId {
    fn borrow(&self) -> &str {
        &self.0
    }
}
impl std::str::FromStr for NodeId {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        Self::new(text)
    }
}

/// An input or an output of a node, written `node.name`.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Socket {
    /// Whose it is.
    pub node: NodeId,
    /// Its name in the declaration.
    pub name: Arc<str>,
}

/// Why a text is no socket.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadSocket {
    /// No dot, or nothing after it.
    #[error("{0:?} is no socket: write it as \"node.name\"")]
    NoName(String),
    /// What stands before the dot.
    #[error(transparent)]
    Id(#[from] BadId),
}

impl Socket {
    /// A socket of a node.
    pub fn new(node: NodeId, name: &str) -> Self {
        Self { node, name: name.into() }
    }
}
impl std::str::FromStr for Socket {
    type Err = BadSocket;
    fn from_str(text: &str) -> Result<Self, BadSocket> {
        match text.split_once('.') {
            Some((node, name)) if !name.is_empty() => Ok(Self::new(NodeId::new(node)?, name)),
            _ => Err(BadSocket::NoName(short(text))),
        }
    }
}
impl fmt::Display for Socket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.node, self.name)
    }
}
impl fmt::Debug for Socket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// An entry of a document's file, before which comment lines can stand.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileEntry {
    /// The document itself.
    Top,
    /// A field of the document.
    Field(String),
    /// A node.
    Node(NodeId),
    /// A field of a node.
    NodeField(NodeId, String),
    /// A set input of a node.
    Input(NodeId, String),
    /// The wires of an input; the first of them where many go in.
    Link(Socket),
    /// A frame.
    Frame(String),
    /// The bends of an input's wires.
    Bends(Socket),
    /// A node that is drawn small.
    Collapsed(NodeId),
    /// A saved view.
    View(String),
    /// A node's place on the canvas.
    Layout(NodeId),
}

impl FileEntry {
    /// What an entry of a list is called there; of anything else nothing.
    pub(crate) fn name(&self) -> String {
        match self {
            FileEntry::Node(id) => id.to_string(),
            FileEntry::Frame(name) | FileEntry::View(name) => name.clone(),
            _ => String::new(),
        }
    }
}

impl Node {
    /// The seed it is set to, which is in the ids of its curves; `None` where it has none or the default.
    pub fn seed(&self) -> Option<i64> {
        match self.inputs.get("seed") {
            Some(Setting::Known(Value::Int(seed))) => Some(*seed),
            _ => None,
        }
    }
    /// Whether it gives a head.
    pub fn is_head(&self) -> bool {
        self.kind == "head"
    }
    /// Whether it holds others.
    pub fn is_group(&self) -> bool {
        self.kind == declared::GROUP
    }
    /// What its kind declares, or the node itself.
    pub(crate) fn own_def(&self) -> Option<&'static NodeDef> {
        match self.kind.as_str() {
            declared::GROUP | declared::PARAMETERS => {
                self.interface.unwrap_or_default().def(&self.kind)
            }
            kind => coif_nodes::by_id(kind),
        }
    }
}

impl Document {
    /// The node of that id.
    pub fn node(&self, id: &str) -> Option<&Node> {
        self.nodes.get(id).map(|node| &**node)
    }

    /// The outputs wired to an input of a node, in order.
    pub fn wires(&self, id: &NodeId, input: &str) -> &[Socket] {
        self.links.get(&Socket::new(id.clone(), input)).map_or(&[], Vec::as_slice)
    }

    /// Whether the wires of an input are written with the nodes that they come from, one a line: where
    /// many go in, so that what two people wire to it merges. Not where one output is wired to it twice, nor
    /// where a node is missing.
    pub(crate) fn is_said_by_sources(&self, to: &Socket) -> bool {
        let input = self.def(&to.node).and_then(|def| def.input(&to.name));
        let Some(from) = self.links.get(to) else { return false };
        let all: BTreeSet<&Socket> = from.iter().collect();
        input.is_some_and(|(_, input)| input.arity == Arity::Many)
            && all.len() == from.len()
            && all.iter().all(|wire| {
                self.nodes.contains_key(&wire.node)
                    && wire.node.group() == to.node.group()
                    && !wire.name.contains(char::is_whitespace)
            })
    }

    /// What is declared of a node: by its kind, or by the document where that is a group's or its border's. None for
    /// kinds that this version does not know, and for the border of what is no group.
    pub fn def(&self, id: &NodeId) -> Option<&'static NodeDef> {
        self.def_of(id, self.node(id.as_str())?)
    }

    /// The same of a node that is to be called `id`.
    pub(crate) fn def_of(&self, id: &NodeId, node: &Node) -> Option<&'static NodeDef> {
        match node.kind.as_str() {
            declared::GROUP_INPUT | declared::GROUP_OUTPUT => {
                let group = id.group()?;
                let group = self.node(group.as_str()).filter(|group| group.is_group())?;
                group.interface.unwrap_or_default().def(&node.kind)
            }
            _ => node.own_def(),
        }
    }

    /// The group in whose entry a file has a node; none where it stands by itself.
    pub(crate) fn written_in(&self, id: &NodeId) -> Option<NodeId> {
        id.group().filter(|group| self.node(group.as_str()).is_some_and(Node::is_group))
    }

    /// The nodes in a group and in groups in it, in order.
    pub fn inside<'a>(
        &'a self,
        group: &NodeId,
    ) -> impl Iterator<Item = (&'a NodeId, &'a Arc<Node>)> {
        let group = group.clone();
        let all = self.nodes.range(group.clone()..).skip(1);
        all.take_while(move |(id, _)| id.is_inside(&group))
    }

    /// The node of a group that its outputs come from: the first of its kind.
    pub fn outputs_of(&self, group: &NodeId) -> Option<&NodeId> {
        self.inside(group)
            .find(|(id, node)| {
                node.kind == declared::GROUP_OUTPUT && id.group().as_ref() == Some(group)
            })
            .map(|(id, _)| id)
    }

    /// Whether the wires of an input are written apart from nodes: where its node is not there, or where a wire crosses
    /// the border of a group.
    pub(crate) fn is_apart(&self, to: &Socket, from: &[Socket]) -> bool {
        let group = to.node.group();
        !self.nodes.contains_key(&to.node) || from.iter().any(|wire| wire.node.group() != group)
    }

    /// What people call a node: its label, else the label of its kind. Copies have their number behind it: "Head 2". Where nodes
    /// of its kind have ids that somebody chose, so that the label tells none from the other, it is the id with spaces.
    pub fn name_of<'a>(&'a self, id: &'a NodeId) -> Cow<'a, str> {
        let spoken = || id.word().replace('_', " ").into();
        let Some(node) = self.node(id.as_str()) else { return spoken() };
        match (&node.label, self.def_of(id, node)) {
            (Some(label), _) => label.into(),
            (None, Some(def)) => {
                let (stem, number) = numbered(id.word());
                // Those beside it: other groups have names of their own.
                let group = id.group();
                let mut others = self.nodes.iter().filter(|(other, n)| {
                    *other != id && n.kind == node.kind && other.group() == group
                });
                match others.any(|(other, _)| numbered(other.word()).0 != stem) {
                    true => spoken(),
                    false => {
                        number.map_or(def.label.into(), |n| format!("{} {n}", def.label).into())
                    }
                }
            }
            _ => spoken(),
        }
    }

    /// An id that no node has yet, in no group, made of `stem`: itself, else with a free number behind it,
    /// in the place of a number that it has; the first one, but among many.
    pub fn free_id(&self, stem: &str) -> NodeId {
        self.free_id_in(None, stem)
    }

    /// The same in a group.
    pub fn free_id_in(&self, group: Option<&NodeId>, stem: &str) -> NodeId {
        let letters = stem.chars().map(|c| c.to_ascii_lowercase());
        let mut stem: String = letters
            .map(|c| if c.is_ascii_lowercase() || c.is_ascii_digit() { c } else { '_' })
            .take(LONGEST_ID - 12)
            .collect();
        if !stem.starts_with(|c: char| c.is_ascii_lowercase()) {
            stem.insert_str(0, "node");
        }
        let path = |word: &str| match group {
            Some(group) => format!("{group}/{word}"),
            None => word.to_owned(),
        };
        let mut id = path(&stem);
        if self.nodes.contains_key(id.as_str()) {
            id = path(numbered(&stem).0);
            let bare = id.len();
            let mut is_taken = |n: u32| {
                id.truncate(bare);
                let _ = write!(id, "_{n}");
                self.nodes.contains_key(id.as_str())
            };
            let free = free_number(&mut is_taken);
            is_taken(free);
        }
        NodeId(id.into())
    }

    /// A fresh node of a kind, every input at its default; where the kind has a seed tag (`seed`),
    /// one that no node of the document has. The tag hangs from `id` and the tags there are, so
    /// replaying edits gives the same document.
    pub fn fresh_node(&self, kind: &str, id: &NodeId) -> Node {
        use coif_nodes::define::Type;
        let mut node = Node { kind: kind.to_owned(), ..Node::default() };
        let seeded = coif_nodes::by_id(kind)
            .and_then(|def| def.input("seed"))
            .is_some_and(|(_, input)| input.ty == Type::Int);
        if seeded {
            let taken: Vec<i64> = self.nodes.values().filter_map(|node| node.seed()).collect();
            let mut tag = 0;
            for n in 0.. {
                let drawn = KeyBuilder::new("seed tag").text(id.as_str()).int(n).finish().0;
                tag = (drawn % 99_999) as i64 + 1;
                // With tens of thousands of nodes a repeat does no harm: ids also hang from the
                // parent.
                if !taken.contains(&tag) || n > 1000 {
                    break;
                }
            }
            node.inputs.insert("seed".to_owned(), Setting::Known(Value::Int(tag)));
        }
        node
    }

    /// Drops what has nothing to stand on: places, bends and comments of what is not there.
    pub(crate) fn settle(&mut self) {
        self.layout.retain(|id, _| self.nodes.contains_key(id));
        self.collapsed.retain(|id| self.nodes.contains_key(id));
        self.bends.retain(|to, _| self.links.contains_key(to));
        let lost: Vec<FileEntry> =
            self.comments.keys().filter(|place| !self.has(place)).cloned().collect();
        lost.iter().for_each(|place| drop(self.comments.remove(place)));
        self.display = self.display.take().filter(|id| self.nodes.contains_key(id));
    }

    /// Whether a file of this document has an entry at `place`. Comments elsewhere have nothing to
    /// stand before.
    pub fn has(&self, place: &FileEntry) -> bool {
        match place {
            FileEntry::Top => true,
            FileEntry::Field(name) => match name.as_str() {
                "format" | "title" | "seed" | "nodes" => true,
                "note" => !self.note.is_empty(),
                "budget" => !self.budget.is_empty(),
                "display" => self.display.is_some(),
                "links" => self.links.iter().any(|(to, from)| self.is_apart(to, from)),
                "frames" => !self.frames.is_empty(),
                "bends" => !self.bends.is_empty(),
                "views" => !self.views.is_empty(),
                "look" => self.look.is_some(),
                "thumbnail" => self.thumbnail.is_some(),
                _ => false,
            },
            FileEntry::Node(id) => self.nodes.contains_key(id),
            FileEntry::NodeField(id, name) => {
                self.node(id.as_str()).is_some_and(|node| match name.as_str() {
                    "kind" => true,
                    "label" => node.label.is_some(),
                    "note" => !node.note.is_empty(),
                    "bypass" => node.bypass,
                    "inputs" => !node.inputs.is_empty(),
                    "interface" => node.interface.is_some(),
                    "template" => node.template.is_some(),
                    "nodes" => self.inside(id).next().is_some(),
                    "links" => self.links.iter().any(|(to, from)| {
                        to.node == *id && !self.is_apart(to, from) && !self.is_said_by_sources(to)
                    }),
                    "into" => self.links.iter().any(|(to, from)| {
                        from.iter().any(|wire| wire.node == *id) && self.is_said_by_sources(to)
                    }),
                    _ => false,
                })
            }
            FileEntry::Input(id, name) => {
                self.node(id.as_str()).is_some_and(|node| node.inputs.contains_key(name))
            }
            FileEntry::Link(socket) => self.links.contains_key(socket),
            FileEntry::Frame(name) => self.frames.contains_key(name),
            FileEntry::Bends(socket) => self.bends.contains_key(socket),
            FileEntry::Collapsed(id) => self.collapsed.contains(id),
            FileEntry::View(name) => self.views.contains_key(name),
            FileEntry::Layout(id) => self.layout.contains_key(id),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_number_is_the_first_or_follows_a_taken_one_and_takes_few_questions() {
        let check = |taken: &dyn Fn(u32) -> bool, free: u32, most: usize| {
            let mut asked = 0;
            let mut is_taken = |n| {
                asked += 1;
                taken(n)
            };
            assert_eq!(free_number(&mut is_taken), free);
            assert!(asked <= most, "{asked}");
        };
        check(&|_| false, 2, 1);
        check(&|n| n != 5, 5, 4);
        check(&|n| n < 7, 7, 6);
        check(&|n| n <= 4000, 4001, 40);
        // Numbers that somebody chose so that no larger one is free.
        check(&|n| n < 10 || n.is_power_of_two(), 10, 50);
    }

    #[test]
    fn ids_are_short_lower_case_words() {
        for good in ["a", "rows", "rows_2", "r2d2"] {
            assert_eq!(NodeId::new(good).unwrap().as_str(), good);
        }
        let long = "a".repeat(65);
        for bad in ["", "2rows", "_a", "Rows", "a b", "a.b", "é", &long] {
            assert!(NodeId::new(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn copies_have_the_name_of_what_they_are_copies_of_with_their_number() {
        let mut document = Document::default();
        let mut add = |text: &str, kind: &str| {
            let node = Node { kind: kind.to_owned(), ..Node::default() };
            document.nodes.insert(NodeId::new(text).unwrap(), node.into());
            let names = document.nodes.keys().map(|id| document.name_of(id).into_owned());
            names.collect::<Vec<_>>()
        };
        assert_eq!(add("head", "head"), ["Head"]);
        assert_eq!(add("out", "groom_output"), ["Head", "Groom output"]);
        assert_eq!(add("head_2", "head"), ["Head", "Head 2", "Groom output"]);
        let names = add("out_2", "groom_output");
        assert_eq!(names, ["Head", "Head 2", "Groom output", "Groom output 2"]);
        // Who chose ids knows them by these.
        let names = add("braids_out", "groom_output");
        assert_eq!(names, ["braids out", "Head", "Head 2", "out", "out 2"]);
    }

    #[test]
    fn a_free_id_is_the_stem_or_the_first_number_behind_it() {
        let mut document = Document::default();
        let mut made = vec![];
        for stem in ["rows", "rows", "rows", "Front Rows", "9lives", "", &"x".repeat(99)] {
            let id = document.free_id(stem);
            document.nodes.insert(id.clone(), Arc::default());
            made.push(id.to_string());
        }
        assert_eq!(made[..6], ["rows", "rows_2", "rows_3", "front_rows", "node9lives", "node"]);
        assert_eq!(made[6].len(), 52);
    }

    #[test]
    fn a_snapshot_shares_its_nodes() {
        let document = testing::Random::new(1).document();
        let snapshot = document.clone();
        for (id, node) in &snapshot.nodes {
            assert!(Arc::ptr_eq(node, &document.nodes[id]));
        }
        assert_eq!(snapshot, document);
    }

    #[test]
    fn fresh_nodes_have_seed_tags_of_their_own() {
        let mut document = Document::default();
        let mut tags = std::collections::BTreeSet::new();
        for def in coif_nodes::all() {
            for _ in 0..3 {
                let id = document.free_id(def.id);
                let node = document.fresh_node(def.id, &id);
                assert_eq!(node, document.fresh_node(def.id, &id));
                if let Some(Setting::Known(Value::Int(tag))) = node.inputs.get("seed") {
                    assert!(tags.insert(*tag), "{id} has the tag of another");
                }
                document.nodes.insert(id, node.into());
            }
        }
    }

    #[test]
    fn a_name_is_the_label_else_the_kind_where_that_is_one() {
        let (a, b) = (NodeId::new("a").unwrap(), NodeId::new("b").unwrap());
        let node = Node { kind: "resample".into(), ..Node::default() };
        let mut document = Document::default();
        document.nodes.insert(a.clone(), node.clone().into());
        assert_eq!(document.name_of(&a), "Resample");
        document.nodes.insert(b.clone(), Node { label: Some("front".into()), ..node }.into());
        assert_eq!((&*document.name_of(&a), &*document.name_of(&b)), ("a", "front"));
    }
}
