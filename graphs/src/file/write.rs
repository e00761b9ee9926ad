//! Documents to text.

use super::ports::{origin_fields, write_port};
use super::{FORMAT, PART};
use crate::document::budget::Term;
use crate::document::{
    Document, FileEntry, Node, NodeId, Point, SavedLook, SavedView, Setting, Socket,
};
use crate::text::order::{FRAMES, NODES, after, by_lot, lot};
use crate::text::values::{new_line, quoted, write_to};
use coif_nodes::declared::Port;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

pub(super) fn write(document: &Document) -> String {
    write_as(document, FORMAT)
}

/// The same, said to be of `format`.
pub(super) fn write_as(document: &Document, format: u32) -> String {
    let mut out = Writer::new(document, NODES);
    for line in document.comments.get(&FileEntry::Top).into_iter().flatten() {
        out.out.push_str(line);
        out.out.push('\n');
    }
    out.out.push('(');
    out.field("format", |out| out.text(&format.to_string()));
    out.field("title", |out| out.quoted(&document.title));
    if !document.note.is_empty() {
        out.field("note", |out| out.quoted(&document.note));
    }
    out.field("seed", |out| out.text(&document.seed.to_string()));
    if let Some(id) = &document.display {
        out.field("display", |out| out.quoted(id.as_str()));
    }
    if !document.budget.is_empty() {
        out.field("budget", |out| {
            let limits = document.budget.limits();
            let limits: Vec<String> =
                limits.map(|(term, x)| format!("{term}: {}", limit(term, x))).collect();
            let _ = write!(out.out, "({})", limits.join(", "));
        });
    }
    out.nodes_and_more();
    out.out
}

/// A limit as files have it: points are a whole number.
fn limit(term: Term, x: f64) -> String {
    if term == Term::Points { format!("{x}") } else { format!("{x:?}") }
}

/// Nodes and their wires, as they are copied.
pub(super) fn write_part(part: &Document) -> String {
    let mut out = Writer::new(part, 1);
    out.out.push('(');
    out.field("coif_nodes", |out| out.text(&PART.to_string()));
    out.nodes_and_more();
    out.out
}

struct Writer<'a> {
    out: String,
    document: &'a Document,
    indent: usize,
    /// Parts of the list of nodes, with a blank line between them.
    paragraphs: usize,
    /// What is wired to each node by itself: its input and the outputs.
    wired: BTreeMap<&'a NodeId, Vec<(&'a Socket, &'a [Socket])>>,
    /// What each node says of its own wires into inputs that take many.
    into: BTreeMap<&'a NodeId, Vec<Into<'a>>>,
}

/// A wire that is written with the node that it comes from.
struct Into<'a> {
    from: &'a Socket,
    to: &'a Socket,
    /// Behind which other wire of the input; none where it stands in its order.
    after: Option<&'a Socket>,
    is_first: bool,
}

impl<'a> Writer<'a> {
    fn new(document: &'a Document, paragraphs: usize) -> Self {
        let (mut wired, mut into) = (BTreeMap::<_, Vec<_>>::new(), BTreeMap::<_, Vec<_>>::new());
        for (to, wires) in &document.links {
            if document.is_apart(to, wires) {
                continue;
            }
            if !document.is_said_by_sources(to) {
                wired.entry(&to.node).or_default().push((to, &wires[..]));
                continue;
            }
            let rank = |(n, from): (usize, &'a Socket)| (lot(from.node.as_str()), &from.node, n);
            let said = after(&wires.iter().enumerate().map(rank).collect::<Vec<_>>());
            for (n, from) in wires.iter().enumerate() {
                let (is_first, after) = (n == 0, said[n].map(|n| &wires[n]));
                into.entry(&from.node).or_default().push(Into { from, to, after, is_first });
            }
        }
        Self { out: String::new(), document, indent: 4, paragraphs, wired, into }
    }
}

impl Writer<'_> {
    /// All fields from the nodes on, and the end.
    fn nodes_and_more(&mut self) {
        let document = self.document;
        let out = self;
        out.field("nodes", |out| out.nodes(None));
        if document.links.iter().any(|(to, from)| document.is_apart(to, from)) {
            out.field("links", |out| {
                let links = document.links.iter().filter(|(to, from)| document.is_apart(to, from));
                let links = links.map(|(to, from)| (FileEntry::Link(to.clone()), (to, from)));
                out.map(None, links, |out, (to, from)| {
                    out.quoted(&to.to_string());
                    out.text(": ");
                    out.wires(None, from);
                });
            });
        }
        if !document.frames.is_empty() {
            out.field("frames", |out| {
                let frames = document.frames.iter();
                let frames =
                    frames.map(|(name, frame)| (FileEntry::Frame(name.clone()), (name, frame)));
                out.map(out.besides(), frames, |out, (name, frame)| {
                    out.quoted(name);
                    out.text(": (at: ");
                    out.point(frame.at);
                    out.text(", size: ");
                    out.point(frame.size);
                    if !frame.text.is_empty() {
                        out.text(", text: ");
                        out.quoted(&frame.text);
                    }
                    if frame.colour != 0 {
                        out.text(&format!(", colour: {}", frame.colour));
                    }
                    out.text(")");
                });
            });
        }
        if !document.bends.is_empty() {
            out.field("bends", |out| {
                let bends = document.bends.iter();
                let bends = bends.map(|(to, bends)| (FileEntry::Bends(to.clone()), (to, bends)));
                out.map(None, bends, |out, (to, bends)| {
                    out.quoted(&to.to_string());
                    out.text(": ");
                    out.list(bends, |out, wire| out.list(wire, |out, point| out.point(*point)));
                });
            });
        }
        if !document.views.is_empty() {
            out.field("views", |out| {
                let views = document.views.iter();
                let views = views.map(|(name, view)| (FileEntry::View(name.clone()), (name, view)));
                out.map(out.besides(), views, |out, (name, view)| {
                    out.quoted(name);
                    let SavedView { eye, target, up, focal_mm, orthographic } = view;
                    for (open, [x, y, z]) in [(": (eye", eye), (", target", target), (", up", up)] {
                        let _ = write!(out.out, "{open}: ({x:?}, {y:?}, {z:?})");
                    }
                    let _ = write!(out.out, ", focal_mm: {focal_mm:?}");
                    if let Some(height) = orthographic {
                        let _ = write!(out.out, ", orthographic: {height:?}");
                    }
                    out.text(")");
                });
            });
        }
        if let Some(SavedLook { light, exposure, turn, skin }) = &document.look {
            out.field("look", |out| {
                out.text("(light: ");
                out.quoted(light);
                let _ = write!(out.out, ", exposure: {exposure:?}");
                if *turn != 0.0 {
                    let _ = write!(out.out, ", turn: {turn:?}");
                }
                out.text(", skin: ");
                out.quoted(skin);
                out.text(")");
            });
        }
        // Last, for it is long.
        if let Some(thumbnail) = &document.thumbnail {
            out.field("thumbnail", |out| out.quoted(&thumbnail.text()));
        }
        out.text("\n)\n");
    }
    fn text(&mut self, text: &str) {
        self.out.push_str(text);
    }
    fn quoted(&mut self, text: &str) {
        quoted(&mut self.out, text);
    }
    /// Comment lines, then the line of an entry, ended by a comma.
    fn entry(&mut self, place: &FileEntry, what: impl FnOnce(&mut Self)) {
        for line in self.document.comments.get(place).into_iter().flatten() {
            new_line(&mut self.out, self.indent);
            self.out.push_str(line);
        }
        self.line(what);
    }
    fn line(&mut self, what: impl FnOnce(&mut Self)) {
        new_line(&mut self.out, self.indent);
        what(self);
        self.out.push(',');
    }
    fn field(&mut self, name: &str, what: impl FnOnce(&mut Self)) {
        self.entry(&FileEntry::Field(name.to_owned()), |out| {
            out.text(name);
            out.text(": ");
            what(out);
        });
    }
    /// Entries in curly brackets, each on its line: by lot, in so many paragraphs, else in their order.
    fn map<T>(
        &mut self,
        paragraphs: Option<usize>,
        entries: impl Iterator<Item = (FileEntry, T)>,
        one: impl Fn(&mut Self, T),
    ) {
        let (entries, rest) = match paragraphs {
            Some(count) => by_lot(entries, |(place, _)| place.name(), count),
            None => (entries.map(|entry| (0, entry)).collect(), 0),
        };
        self.out.push('{');
        self.indent += 4;
        for (blank, (place, entry)) in entries {
            self.blank_lines(blank);
            self.entry(&place, |out| one(out, entry));
        }
        self.indent -= 4;
        self.blank_lines(rest);
        new_line(&mut self.out, self.indent);
        self.out.push('}');
    }
    fn point(&mut self, Point(x, y): Point) {
        let _ = write!(self.out, "({x:?}, {y:?})");
    }
    /// The nodes in a group, or those in none.
    fn nodes(&mut self, group: Option<&NodeId>) {
        let document = self.document;
        let nodes: Vec<(&NodeId, &Arc<Node>)> = match group {
            Some(group) => document.inside(group).collect(),
            None => document.nodes.iter().collect(),
        };
        let nodes = nodes
            .into_iter()
            .filter(|(id, _)| document.written_in(id).as_ref() == group)
            .map(|(id, node)| (FileEntry::Node(id.clone()), (id, node)));
        let paragraphs = if group.is_some() { self.besides() } else { Some(self.paragraphs) };
        self.map(paragraphs, nodes, |out, (id, node)| {
            out.quoted(if group.is_some() { id.word() } else { id.as_str() });
            out.text(": ");
            out.node(id, node);
        });
    }
    /// Paragraphs of what stands besides the nodes.
    fn besides(&self) -> Option<usize> {
        Some(self.paragraphs.min(FRAMES))
    }
    fn blank_lines(&mut self, count: usize) {
        self.out.extend(std::iter::repeat_n('\n', count));
    }
    /// A node. Its place comes first and its kind next, so that a moved node touches no line that
    /// changes for another reason.
    fn node(&mut self, id: &NodeId, node: &Node) {
        self.out.push('(');
        self.indent += 4;
        if let Some(at) = self.document.layout.get(id) {
            self.entry(&FileEntry::Layout(id.clone()), |out| {
                out.text("at: ");
                out.point(*at);
            });
        }
        if self.document.collapsed.contains(id) {
            self.entry(&FileEntry::Collapsed(id.clone()), |out| out.text("collapsed: true"));
        }
        self.node_field(id, "kind", |out| out.quoted(&node.kind));
        if let Some(label) = &node.label {
            self.node_field(id, "label", |out| out.quoted(label));
        }
        if !node.note.is_empty() {
            self.node_field(id, "note", |out| out.quoted(&node.note));
        }
        if node.bypass {
            self.node_field(id, "bypass", |out| out.text("true"));
        }
        if let Some(origin) = &node.template {
            self.node_field(id, "template", |out| {
                out.out.push('(');
                out.indent += 4;
                for line in origin_fields(origin) {
                    out.line(|out| out.text(&line));
                }
                out.indent -= 4;
                new_line(&mut out.out, out.indent);
                out.out.push(')');
            });
        }
        if let Some(interface) = node.interface {
            self.node_field(id, "interface", |out| {
                out.out.push('(');
                out.indent += 4;
                for (side, ports) in
                    [("inputs", interface.inputs()), ("outputs", interface.outputs())]
                {
                    if !ports.is_empty() {
                        out.line(|out| out.ports(side, ports));
                    }
                }
                out.indent -= 4;
                new_line(&mut out.out, out.indent);
                out.out.push(')');
            });
        }
        if !node.inputs.is_empty() {
            self.node_field(id, "inputs", |out| {
                let inputs = node.inputs.iter();
                let inputs = inputs
                    .map(|(name, set)| (FileEntry::Input(id.clone(), name.clone()), (name, set)));
                out.map(None, inputs, |out, (name, setting)| {
                    out.quoted(name);
                    out.text(": ");
                    match setting {
                        Setting::Known(value) => write_to(&mut out.out, value, Some(out.indent)),
                        Setting::Raw(text) => out.text(text),
                    }
                });
            });
        }
        if let Some(wired) = self.wired.remove(id) {
            self.node_field(id, "links", |out| {
                let wired =
                    wired.into_iter().map(|(to, from)| (FileEntry::Link(to.clone()), (to, from)));
                out.map(None, wired, |out, (to, from)| {
                    out.quoted(&to.name);
                    out.text(": ");
                    out.wires(id.group().as_ref(), from);
                });
            });
        }
        if let Some(into) = self.into.remove(id) {
            self.node_field(id, "into", |out| {
                out.out.push('[');
                out.indent += 4;
                for Into { from, to, after, is_first } in into {
                    let said = |socket: &Socket| format!("{}.{}", socket.node.word(), socket.name);
                    let mut line = format!("{} to {}", from.name, said(to));
                    if let Some(after) = after {
                        let _ = write!(line, " after {}", said(after));
                    }
                    // What stands before the wires of an input stands before the first of them.
                    let place = FileEntry::Link(to.clone());
                    match is_first {
                        true => out.entry(&place, |out| out.quoted(&line)),
                        false => out.line(|out| out.quoted(&line)),
                    }
                }
                out.indent -= 4;
                new_line(&mut out.out, out.indent);
                out.out.push(']');
            });
        }
        if node.is_group() && self.document.inside(id).next().is_some() {
            self.node_field(id, "nodes", |out| out.nodes(Some(id)));
        }
        self.indent -= 4;
        new_line(&mut self.out, self.indent);
        self.out.push(')');
    }
    /// One side of an interface, a port a line.
    fn ports(&mut self, side: &str, ports: &[Port]) {
        self.text(side);
        self.text(": [");
        self.indent += 4;
        for port in ports {
            self.line(|out| write_port(&mut out.out, port));
        }
        self.indent -= 4;
        new_line(&mut self.out, self.indent);
        self.out.push(']');
    }
    fn node_field(&mut self, id: &NodeId, name: &str, what: impl FnOnce(&mut Self)) {
        self.entry(&FileEntry::NodeField(id.clone(), name.to_owned()), |out| {
            out.text(name);
            out.text(": ");
            what(out);
        });
    }
    /// Outputs that are wired to an input of a node of `group`: one, or each on its line.
    fn wires(&mut self, group: Option<&NodeId>, from: &[Socket]) {
        // Within a group all have its id before theirs: it is left out.
        let said = |socket: &Socket| match group {
            Some(_) => format!("{}.{}", socket.node.word(), socket.name),
            None => socket.to_string(),
        };
        if let [one] = from {
            return self.quoted(&said(one));
        }
        self.out.push('[');
        self.indent += 4;
        for wire in from {
            self.line(|out| out.quoted(&said(wire)));
        }
        self.indent -= 4;
        new_line(&mut self.out, self.indent);
        self.out.push(']');
    }
    /// A list on one line.
    fn list<T>(&mut self, items: &[T], one: impl Fn(&mut Self, &T)) {
        self.out.push('[');
        for (i, item) in items.iter().enumerate() {
            self.text(if i > 0 { ", " } else { "" });
            one(self, item);
        }
        self.out.push(']');
    }
}
