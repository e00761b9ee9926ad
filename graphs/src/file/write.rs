//! Documents to text.

use super::values::{new_line, quoted, write_to};
use super::{FORMAT, PART};
use crate::document::{Document, Node, NodeId, Place, Point, SavedLook, SavedView, Setting};
use std::fmt::Write as _;

pub(super) fn write(document: &Document) -> String {
    let mut out = Writer { out: String::new(), document, indent: 4 };
    for line in document.comments.get(&Place::Top).into_iter().flatten() {
        out.out.push_str(line);
        out.out.push('\n');
    }
    out.out.push('(');
    out.field("format", |out| out.text(&FORMAT.to_string()));
    out.field("title", |out| out.quoted(&document.title));
    if !document.note.is_empty() {
        out.field("note", |out| out.quoted(&document.note));
    }
    out.field("seed", |out| out.text(&document.seed.to_string()));
    if let Some(id) = &document.display {
        out.field("display", |out| out.quoted(id.as_str()));
    }
    out.nodes_and_more();
    out.out
}

/// Nodes and their wires, as they are copied.
pub(super) fn write_part(part: &Document) -> String {
    let mut out = Writer { out: "(".to_owned(), document: part, indent: 4 };
    out.field("coif_nodes", |out| out.text(&PART.to_string()));
    out.nodes_and_more();
    out.out
}

struct Writer<'a> {
    out: String,
    document: &'a Document,
    indent: usize,
}

impl Writer<'_> {
    /// All fields from the nodes on, and the end.
    fn nodes_and_more(&mut self) {
        let document = self.document;
        let out = self;
        out.field("nodes", |out| {
            let nodes = document.nodes.iter();
            out.map(
                nodes.map(|(id, node)| (Place::Node(id.clone()), (id, node))),
                |out, (id, node)| {
                    out.quoted(id.as_str());
                    out.text(": ");
                    out.node(id, node);
                },
            );
        });
        if !document.links.is_empty() {
            out.field("links", |out| {
                let links = document.links.iter();
                let links = links.map(|(to, from)| (Place::Link(to.clone()), (to, from)));
                out.map(links, |out, (to, from)| {
                    out.quoted(&to.to_string());
                    out.text(": ");
                    out.wires(from);
                });
            });
        }
        if !document.frames.is_empty() {
            out.field("frames", |out| {
                let frames = document.frames.iter();
                let frames =
                    frames.map(|(name, frame)| (Place::Frame(name.clone()), (name, frame)));
                out.map(frames, |out, (name, frame)| {
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
                let bends = bends.map(|(to, bends)| (Place::Bends(to.clone()), (to, bends)));
                out.map(bends, |out, (to, bends)| {
                    out.quoted(&to.to_string());
                    out.text(": ");
                    out.list(bends, |out, wire| out.list(wire, |out, point| out.point(*point)));
                });
            });
        }
        if !document.collapsed.is_empty() {
            out.field("collapsed", |out| {
                let nodes = document.collapsed.iter();
                let nodes = nodes.map(|id| (Place::Collapsed(id.clone()), id));
                out.block(['[', ']'], nodes, |out, id| out.quoted(id.as_str()));
            });
        }
        if !document.views.is_empty() {
            out.field("views", |out| {
                let views = document.views.iter();
                let views = views.map(|(name, view)| (Place::View(name.clone()), (name, view)));
                out.map(views, |out, (name, view)| {
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
        if let Some(SavedLook { light, exposure, skin }) = &document.look {
            out.field("look", |out| {
                out.text("(light: ");
                out.quoted(light);
                let _ = write!(out.out, ", exposure: {exposure:?}, skin: ");
                out.quoted(skin);
                out.text(")");
            });
        }
        if !document.layout.is_empty() {
            out.field("layout", |out| {
                let layout = document.layout.iter();
                let layout = layout.map(|(id, at)| (Place::Layout(id.clone()), (id, at)));
                out.map(layout, |out, (id, at)| {
                    out.quoted(id.as_str());
                    out.text(": ");
                    out.point(*at);
                });
            });
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
    fn entry(&mut self, place: &Place, what: impl FnOnce(&mut Self)) {
        for line in self.document.comments.get(place).into_iter().flatten() {
            new_line(&mut self.out, self.indent);
            self.out.push_str(line);
        }
        new_line(&mut self.out, self.indent);
        what(self);
        self.out.push(',');
    }
    fn field(&mut self, name: &str, what: impl FnOnce(&mut Self)) {
        self.entry(&Place::Field(name.to_owned()), |out| {
            out.text(name);
            out.text(": ");
            what(out);
        });
    }
    fn map<T>(&mut self, entries: impl Iterator<Item = (Place, T)>, one: impl Fn(&mut Self, T)) {
        self.block(['{', '}'], entries, one);
    }
    /// Entries between brackets, each on its line.
    fn block<T>(
        &mut self,
        [open, close]: [char; 2],
        entries: impl Iterator<Item = (Place, T)>,
        one: impl Fn(&mut Self, T),
    ) {
        self.out.push(open);
        self.indent += 4;
        for (place, entry) in entries {
            self.entry(&place, |out| one(out, entry));
        }
        self.indent -= 4;
        new_line(&mut self.out, self.indent);
        self.out.push(close);
    }
    fn point(&mut self, Point(x, y): Point) {
        let _ = write!(self.out, "({x:?}, {y:?})");
    }
    fn node(&mut self, id: &NodeId, node: &Node) {
        self.out.push('(');
        self.indent += 4;
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
        if !node.inputs.is_empty() {
            self.node_field(id, "inputs", |out| {
                let inputs = node.inputs.iter();
                let inputs =
                    inputs.map(|(name, set)| (Place::Input(id.clone(), name.clone()), (name, set)));
                out.map(inputs, |out, (name, setting)| {
                    out.quoted(name);
                    out.text(": ");
                    match setting {
                        Setting::Known(value) => write_to(&mut out.out, value, Some(out.indent)),
                        Setting::Raw(text) => out.text(text),
                    }
                });
            });
        }
        self.indent -= 4;
        new_line(&mut self.out, self.indent);
        self.out.push(')');
    }
    fn node_field(&mut self, id: &NodeId, name: &str, what: impl FnOnce(&mut Self)) {
        self.entry(&Place::NodeField(id.clone(), name.to_owned()), |out| {
            out.text(name);
            out.text(": ");
            what(out);
        });
    }
    fn wires(&mut self, from: &[crate::document::Socket]) {
        if let [one] = from {
            return self.quoted(&one.to_string());
        }
        self.list(from, |out, wire| out.quoted(&wire.to_string()));
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
