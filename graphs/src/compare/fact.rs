//! A document as facts, each under a name of its own.
//!
//! [`facts`] and [`document`] take each other back, for every document that a file can hold. Whoever adds something to documents
//! adds a fact here, and diff and merge know it; what both take apart by naming every field tells when one is missing.

use crate::document::budget::Term;
use crate::document::{
    Document, FileEntry, Frame, Node, NodeId, Origin, Point, SavedLook, SavedView, Setting, Socket,
    Thumbnail,
};
use coif_nodes::declared::Interface;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a fact is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fact {
    /// The title.
    Title,
    /// The document's note.
    Note,
    /// The seed.
    Seed,
    /// The node that is shown.
    Display,
    /// A term of what the groom may take.
    Budget(Term),
    /// Light and skin.
    Look,
    /// The small picture.
    Thumbnail,
    /// A node's kind. It is there exactly when the node is.
    Kind(NodeId),
    /// What people call a node.
    Label(NodeId),
    /// A node's note.
    NodeNote(NodeId),
    /// Whether a node is passed by.
    Bypass(NodeId),
    /// What a group takes and gives, or the parameters there are.
    Ports(NodeId),
    /// The template that a group was made of.
    Template(NodeId),
    /// What an input is set to.
    Input(NodeId, String),
    /// The wires of an input, with their bends.
    Wires(Socket),
    /// A frame.
    Frame(String),
    /// A saved view.
    View(String),
    /// Where a node stands on the canvas.
    Layout(NodeId),
    /// Whether a node is drawn small.
    Collapsed(NodeId),
    /// The comment before an entry.
    Comment(FileEntry),
}

/// What a fact says. A fact that says what a document says without it (no note, seed 0) is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// That it is so.
    Yes,
    /// A text, or the kind of a node.
    Text(String),
    /// A seed.
    Seed(u64),
    /// A node.
    Node(NodeId),
    /// What an input is set to.
    Setting(Setting),
    /// Ports in their order.
    Ports(Interface),
    /// A template.
    Template(Arc<Origin>),
    /// Wires in their order.
    Wires(Vec<Wire>),
    /// A frame.
    Frame(Frame),
    /// A camera.
    View(SavedView),
    /// The limit of a term.
    Limit(Limit),
    /// Light and skin.
    Look(SavedLook),
    /// A small picture.
    Thumbnail(Thumbnail),
    /// A place on the canvas.
    At(Point),
    /// Comment lines.
    Lines(Vec<String>),
}

/// The limit of a term of a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit(pub Term, pub f64);

// No limit is NaN.
impl Eq for Limit {}

/// A wire of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wire {
    /// The output that it comes from.
    pub from: Socket,
    /// The points that it runs through.
    pub bends: Vec<Point>,
}

/// All that a document says.
pub(super) type Facts = BTreeMap<Fact, Said>;

impl Fact {
    /// The node that it is about, if it is about one.
    pub fn node(&self) -> Option<&NodeId> {
        match self {
            Fact::Kind(id)
            | Fact::Label(id)
            | Fact::NodeNote(id)
            | Fact::Bypass(id)
            | Fact::Ports(id)
            | Fact::Template(id)
            | Fact::Input(id, _)
            | Fact::Layout(id)
            | Fact::Collapsed(id) => Some(id),
            Fact::Wires(to) => Some(&to.node),
            Fact::Comment(place) => match place {
                FileEntry::Node(id)
                | FileEntry::NodeField(id, _)
                | FileEntry::Input(id, _)
                | FileEntry::Collapsed(id)
                | FileEntry::Layout(id) => Some(id),
                FileEntry::Link(to) | FileEntry::Bends(to) => Some(&to.node),
                FileEntry::Top | FileEntry::Field(_) | FileEntry::Frame(_) | FileEntry::View(_) => {
                    None
                }
            },
            Fact::Title
            | Fact::Note
            | Fact::Seed
            | Fact::Display
            | Fact::Budget(_)
            | Fact::Look
            | Fact::Thumbnail
            | Fact::Frame(_)
            | Fact::View(_) => None,
        }
    }

    /// Whether it says only where something stands on the canvas.
    pub(super) fn is_canvas(&self) -> bool {
        matches!(self, Fact::Layout(_) | Fact::Collapsed(_))
    }

    /// What it is called where tools read it: a word, and the name of the input, frame or view.
    pub fn named(&self) -> (&'static str, Option<String>) {
        match self {
            Fact::Title => ("title", None),
            Fact::Note | Fact::NodeNote(_) => ("note", None),
            Fact::Seed => ("seed", None),
            Fact::Display => ("display", None),
            Fact::Budget(term) => ("budget", Some(term.word().to_owned())),
            Fact::Look => ("look", None),
            Fact::Thumbnail => ("thumbnail", None),
            Fact::Kind(_) => ("kind", None),
            Fact::Label(_) => ("label", None),
            Fact::Bypass(_) => ("bypass", None),
            Fact::Ports(_) => ("interface", None),
            Fact::Template(_) => ("template", None),
            Fact::Input(_, name) => ("input", Some(name.clone())),
            Fact::Wires(to) => ("wires", Some(to.name.to_string())),
            Fact::Frame(name) => ("frame", Some(name.clone())),
            Fact::View(name) => ("view", Some(name.clone())),
            Fact::Layout(_) => ("at", None),
            Fact::Collapsed(_) => ("collapsed", None),
            Fact::Comment(_) => ("comment", None),
        }
    }
}

impl Said {
    /// The outputs that are wired.
    pub(super) fn sources(&self) -> impl Iterator<Item = &Socket> {
        let wires = if let Said::Wires(wires) = self { &wires[..] } else { &[] };
        wires.iter().map(|wire| &wire.from)
    }
}

/// Takes a document apart.
pub(super) fn facts(document: &Document) -> Facts {
    let Document {
        title,
        note,
        seed,
        budget,
        display,
        nodes,
        links,
        frames,
        bends,
        collapsed,
        views,
        look,
        layout,
        thumbnail,
        comments,
    } = document;
    let mut facts = Facts::new();
    let text = |text: &String| (!text.is_empty()).then(|| Said::Text(text.clone()));
    facts.extend(text(title).map(|said| (Fact::Title, said)));
    facts.extend(text(note).map(|said| (Fact::Note, said)));
    facts.extend((*seed != 0).then_some((Fact::Seed, Said::Seed(*seed))));
    facts.extend(display.iter().map(|id| (Fact::Display, Said::Node(id.clone()))));
    facts
        .extend(budget.limits().map(|(term, x)| (Fact::Budget(term), Said::Limit(Limit(term, x)))));
    facts.extend(look.iter().map(|look| (Fact::Look, Said::Look(look.clone()))));
    facts.extend(thumbnail.iter().map(|it| (Fact::Thumbnail, Said::Thumbnail(it.clone()))));
    for (id, node) in nodes {
        let Node { kind, label, note, bypass, inputs, interface, template } = &**node;
        let id = || id.clone();
        facts.insert(Fact::Kind(id()), Said::Text(kind.clone()));
        facts.extend(label.iter().map(|label| (Fact::Label(id()), Said::Text(label.clone()))));
        facts.extend(text(note).map(|said| (Fact::NodeNote(id()), said)));
        facts.extend(bypass.then(|| (Fact::Bypass(id()), Said::Yes)));
        facts.extend(interface.map(|ports| (Fact::Ports(id()), Said::Ports(ports))));
        facts.extend(template.iter().map(|it| (Fact::Template(id()), Said::Template(it.clone()))));
        facts.extend(inputs.iter().map(|(name, setting)| {
            (Fact::Input(id(), name.clone()), Said::Setting(setting.clone()))
        }));
    }
    facts.extend(links.iter().map(|(to, from)| {
        let bent = |n: usize| bends.get(to).and_then(|all| all.get(n)).cloned().unwrap_or_default();
        let wires = from.iter().cloned().enumerate();
        let wires = wires.map(|(n, from)| Wire { from, bends: bent(n) }).collect();
        (Fact::Wires(to.clone()), Said::Wires(wires))
    }));
    facts.extend(
        frames.iter().map(|(n, frame)| (Fact::Frame(n.clone()), Said::Frame(frame.clone()))),
    );
    facts.extend(views.iter().map(|(name, view)| (Fact::View(name.clone()), Said::View(*view))));
    facts.extend(layout.iter().map(|(id, at)| (Fact::Layout(id.clone()), Said::At(*at))));
    facts.extend(collapsed.iter().map(|id| (Fact::Collapsed(id.clone()), Said::Yes)));
    facts.extend(
        comments
            .iter()
            .map(|(place, lines)| (Fact::Comment(place.clone()), Said::Lines(lines.clone()))),
    );
    facts
}

/// Puts a document together. What is said of a node that is not there, but for its wires, is left out.
pub(super) fn document(facts: Facts) -> Document {
    let (mut document, mut nodes) = (Document::default(), BTreeMap::<NodeId, Node>::new());
    // Kinds come before all else that is said of nodes: facts are in the order of their declaration.
    for (fact, said) in facts {
        let node = fact.node().and_then(|id| nodes.get_mut(id));
        match (fact, said) {
            (Fact::Title, Said::Text(text)) => document.title = text,
            (Fact::Note, Said::Text(text)) => document.note = text,
            (Fact::Seed, Said::Seed(seed)) => document.seed = seed,
            (Fact::Display, Said::Node(id)) => document.display = Some(id),
            (Fact::Budget(_), Said::Limit(Limit(term, x))) => {
                drop(document.budget.set(term, Some(x)))
            }
            (Fact::Look, Said::Look(look)) => document.look = Some(look),
            (Fact::Thumbnail, Said::Thumbnail(it)) => document.thumbnail = Some(it),
            (Fact::Kind(id), Said::Text(kind)) => {
                nodes.insert(id, Node { kind, ..Node::default() });
            }
            (Fact::Label(_), Said::Text(text)) => {
                node.into_iter().for_each(|node| node.label = Some(text.clone()));
            }
            (Fact::NodeNote(_), Said::Text(text)) => {
                node.into_iter().for_each(|node| node.note.clone_from(&text));
            }
            (Fact::Bypass(_), _) => node.into_iter().for_each(|node| node.bypass = true),
            (Fact::Ports(_), Said::Ports(ports)) => {
                node.into_iter().for_each(|node| node.interface = Some(ports));
            }
            (Fact::Template(_), Said::Template(it)) => {
                node.into_iter().for_each(|node| node.template = Some(it.clone()));
            }
            (Fact::Input(_, name), Said::Setting(setting)) => {
                node.and_then(|node| node.inputs.insert(name, setting));
            }
            (Fact::Wires(to), Said::Wires(wires)) => {
                let (from, bends) = wires.into_iter().map(|wire| (wire.from, wire.bends)).unzip();
                document.set_all_bends(&to, bends);
                document.links.insert(to, from);
            }
            (Fact::Frame(name), Said::Frame(frame)) => drop(document.frames.insert(name, frame)),
            (Fact::View(name), Said::View(view)) => drop(document.views.insert(name, view)),
            (Fact::Layout(id), Said::At(at)) if node.is_some() => {
                document.layout.insert(id, at);
            }
            (Fact::Collapsed(id), _) if node.is_some() => drop(document.collapsed.insert(id)),
            (Fact::Comment(place), Said::Lines(lines)) => {
                document.comments.insert(place, lines);
            }
            // Nothing else is ever said of these facts.
            _ => {}
        }
    }
    document.nodes = nodes.into_iter().map(|(id, node)| (id, Arc::new(node))).collect();
    document.display = document.display.filter(|id| document.nodes.contains_key(id));
    document
}
