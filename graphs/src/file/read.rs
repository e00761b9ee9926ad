//! Text to documents: the structs of formats 1 to 3, and their conversion.

use super::ports::{self, FileInterface, FileOrigin};
use super::scan::{Scan, error_at, errors_at, scan};
use super::{CONFLICT, FORMAT, FileError, Loaded, OLDEST, PART, upgrade};
use crate::document::budget::Term;
use crate::document::{
    BadId, Document, FileEntry, Frame, Node, NodeId, Point, SavedLook, SavedView, Setting, Socket,
    Thumbnail,
};
use crate::text::order::in_order;
use crate::text::tokens::trimmed;
use crate::text::values::{Wrong, placed_value};
use crate::text::{DEEPEST_IN_FILE, in_words, place_of, prove_raw, there};
use coif_nodes::declared;
use coif_nodes::define::{NodeDef, short};
use ron::value::RawValue;
use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;
use std::str::FromStr;
use std::sync::Arc;

#[derive(Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Groom")]
struct FileGroom<'a> {
    format: u32,
    #[serde(default)]
    title: String,
    #[serde(default)]
    note: String,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    display: String,
    #[serde(borrow, default)]
    nodes: Entries<NodeId, FileNode<'a>>,
    #[serde(default)]
    links: Entries<Socket, FileWires>,
    #[serde(default)]
    frames: Entries<String, FileFrame>,
    #[serde(default)]
    bends: Entries<Socket, Vec<Vec<(f32, f32)>>>,
    #[serde(default)]
    collapsed: Vec<String>,
    #[serde(default)]
    views: Entries<String, FileView>,
    #[serde(default, deserialize_with = "there")]
    look: Option<FileLook>,
    #[serde(default)]
    budget: FileBudget,
    #[serde(default)]
    layout: Entries<NodeId, (f32, f32)>,
    #[serde(default)]
    thumbnail: String,
}

/// Nodes as they are copied.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Nodes")]
struct FilePart<'a> {
    coif_nodes: u32,
    #[serde(borrow, default)]
    nodes: Entries<NodeId, FileNode<'a>>,
    #[serde(default)]
    links: Entries<Socket, FileWires>,
    #[serde(default)]
    bends: Entries<Socket, Vec<Vec<(f32, f32)>>>,
    #[serde(default)]
    collapsed: Vec<String>,
    #[serde(default)]
    frames: Entries<String, FileFrame>,
    #[serde(default)]
    layout: Entries<NodeId, (f32, f32)>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Node")]
struct FileNode<'a> {
    kind: String,
    #[serde(default)]
    label: String,
    #[serde(default)]
    note: String,
    #[serde(default)]
    bypass: bool,
    #[serde(borrow, default)]
    inputs: Entries<String, &'a RawValue>,
    #[serde(default)]
    links: Entries<Input, FileWires>,
    #[serde(default)]
    into: Vec<FileInto>,
    #[serde(default, deserialize_with = "there")]
    at: Option<(f32, f32)>,
    #[serde(default)]
    collapsed: bool,
    #[serde(borrow, default, deserialize_with = "there")]
    interface: Option<FileInterface<'a>>,
    #[serde(default, deserialize_with = "there")]
    template: Option<FileOrigin>,
    #[serde(borrow, default)]
    nodes: Entries<NodeId, FileNode<'a>>,
}

/// The name of an input.
struct Input(String);

impl FromStr for Input {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if text.is_empty() {
            Err("an input without a name".to_owned())
        } else {
            Ok(Self(text.into()))
        }
    }
}

/// A wire as the node says it that it comes from: `output to node.input`, and behind which other wire
/// of that input, `after node.output`.
pub(super) struct WireEntry {
    output: Arc<str>,
    pub(super) to: Socket,
    after: Option<Socket>,
}

impl FromStr for WireEntry {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (output, to, after) = match words[..] {
            [output, "to", to] => (output, to, None),
            [output, "to", to, "after", after] => (output, to, Some(after)),
            _ => {
                return Err(format!(
                    "{:?} is no wire: write it as \"output to node.input\" or \"output to node.input after \
                     other.output\"",
                    short(text)
                ));
            }
        };
        let socket = |text: &str| text.parse::<Socket>().map_err(|err| err.to_string());
        let after = after.map(socket).transpose()?;
        Ok(Self { output: output.into(), to: socket(to)?, after })
    }
}

struct FileInto(WireEntry);

impl<'de> Deserialize<'de> for FileInto {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map(FileInto).map_err(de::Error::custom)
    }
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Frame")]
struct FileFrame {
    at: (f32, f32),
    size: (f32, f32),
    #[serde(default)]
    text: String,
    #[serde(default)]
    colour: u8,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "View")]
struct FileView {
    eye: [f32; 3],
    target: [f32; 3],
    up: [f32; 3],
    focal_mm: f32,
    /// 0 where there is perspective.
    #[serde(default)]
    orthographic: f32,
}

/// As [`Budget`].
#[derive(Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Budget")]
struct FileBudget {
    #[serde(default, deserialize_with = "there")]
    seconds: Option<f64>,
    #[serde(default, deserialize_with = "there")]
    points: Option<f64>,
    #[serde(default, deserialize_with = "there")]
    mib: Option<f64>,
}

/// As [`SavedLook`].
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Look")]
struct FileLook {
    light: String,
    #[serde(default)]
    exposure: f32,
    #[serde(default)]
    turn: f32,
    skin: String,
}

/// A map in the order of the file. Two entries of one name are refused: a merge made them, and one
/// would be lost. Names are read here, where the reader knows the line.
struct Entries<K, T>(Vec<(K, T)>);

impl<K, T> Default for Entries<K, T> {
    fn default() -> Self {
        Self(vec![])
    }
}

impl<'de, K, T> Deserialize<'de> for Entries<K, T>
where
    K: FromStr<Err: fmt::Display>,
    T: Deserialize<'de>,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor<K, T>(PhantomData<(K, T)>);
        impl<'de, K, T> Visitor<'de> for EntriesVisitor<K, T>
        where
            K: FromStr<Err: fmt::Display>,
            T: Deserialize<'de>,
        {
            type Value = Entries<K, T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("entries in curly brackets")
            }
            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Self::Value, M::Error> {
                let (mut entries, mut seen) = (vec![], BTreeSet::new());
                while let Some(name) = map.next_key::<String>()? {
                    let key = name.parse().map_err(de::Error::custom)?;
                    if seen.contains(&name) {
                        return Err(de::Error::custom(format!(
                            "{name:?} stands here twice: keep one of them"
                        )));
                    }
                    seen.insert(name);
                    entries.push((key, map.next_value()?));
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(EntriesVisitor(PhantomData))
    }
}

/// The outputs wired to an input: one, or a list.
struct FileWires(Vec<Socket>);

impl<'de> Deserialize<'de> for FileWires {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WiresVisitor;
        impl<'de> Visitor<'de> for WiresVisitor {
            type Value = FileWires;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"node.output\" or a list of these")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<FileWires, E> {
                Ok(FileWires(vec![text.parse().map_err(de::Error::custom)?]))
            }
            fn visit_seq<S: SeqAccess<'de>>(self, mut seq: S) -> Result<FileWires, S::Error> {
                let mut wires = vec![];
                while let Some(wire) = seq.next_element::<String>()? {
                    wires.push(wire.parse().map_err(de::Error::custom)?);
                }
                Ok(FileWires(wires))
            }
        }
        deserializer.deserialize_any(WiresVisitor)
    }
}

pub(super) fn read(text: &str) -> Result<Loaded, FileError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    refuse_conflicts(text)?;
    match parse::<FileGroom>(text) {
        Ok(groom) if (OLDEST..=FORMAT).contains(&groom.format) => convert(text, groom),
        parsed => match format_of(text) {
            Some((format, at)) if format > FORMAT => Err(error_at(
                text,
                at,
                format!(
                    "the file has format {format}, this version reads up to {FORMAT}: open it with a newer coif"
                ),
            )),
            Some((format, at)) if format < OLDEST => {
                let message =
                    format!("the file has format {format}, the oldest that is read is {OLDEST}");
                Err(error_at(text, at, message))
            }
            _ => match parsed {
                Err(err) => Err(err),
                Ok(_) => Err(error_at(text, 0, "the file says no format".to_owned())),
            },
        },
    }
}

/// The format that a file says it has, and where it says so; none when it says none that is a number.
fn format_of(text: &str) -> Option<(u32, usize)> {
    let at = scan(text).values.get(&FileEntry::Field("format".to_owned())).copied()?;
    Some((number_at(text, at)?, at))
}

fn number_at(text: &str, at: usize) -> Option<u32> {
    text[at..].split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

/// Reads copied nodes, or a whole groom.
pub(super) fn read_part(text: &str) -> Result<Loaded, FileError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    refuse_conflicts(text)?;
    let said = scan(text).values;
    if said.contains_key(&FileEntry::Field("format".to_owned())) {
        return read(text);
    }
    let Some(at) = said.get(&FileEntry::Field("coif_nodes".to_owned())) else {
        let message = format!("these are no nodes: they begin with `(coif_nodes: {PART}`");
        return Err(error_at(text, 0, message));
    };
    if let Some(format) = number_at(text, *at).filter(|format| *format > PART) {
        let message = format!(
            "the nodes have format {format}, this version reads up to {PART}: paste them into a newer coif"
        );
        return Err(error_at(text, *at, message));
    }
    let FilePart { coif_nodes: format, nodes, links, bends, collapsed, frames, layout } =
        parse(text)?;
    let groom = FileGroom {
        format,
        nodes,
        links,
        bends,
        collapsed,
        frames,
        layout,
        ..FileGroom::default()
    };
    convert(text, groom)
}

fn parse<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, FileError> {
    if trimmed_start(text).starts_with('#') {
        let message = "a groom has no #![...] attributes: remove this line".to_owned();
        return Err(error_at(text, text.len() - trimmed_start(text).len(), message));
    }
    ron::Options::default().with_recursion_limit(DEEPEST_IN_FILE).from_str(text).map_err(|err| {
        let (line, column) = place_of(&err);
        FileError { line, column, message: in_words(&err.code) }
    })
}

fn trimmed_start(text: &str) -> &str {
    let inner = trimmed(text);
    // A slice of `text`: where it begins is where the comments end.
    &text[inner.as_ptr() as usize - text.as_ptr() as usize..]
}

/// A merge that nobody finished is said as such: what the parser would say of it helps nobody.
fn refuse_conflicts(text: &str) -> Result<(), FileError> {
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ") {
            let message = "a merge conflict is left in the file: resolve it first".to_owned();
            return Err(error_at(text, at, message));
        }
        at += line.len();
    }
    Ok(())
}

/// Collects what is to be said about a file.
struct Reader<'a> {
    text: &'a str,
    format: u32,
    scan: Scan,
    warnings: Vec<(usize, String)>,
    /// Text that is kept as it is, comments in it too.
    raw: Vec<Range<usize>>,
    /// Why the file is not read, found late.
    refused: Option<(usize, String)>,
}

impl Reader<'_> {
    fn at(&self, place: &FileEntry) -> usize {
        self.scan.values.get(place).copied().unwrap_or_default()
    }
    fn warn(&mut self, place: &FileEntry, message: String) {
        let at = self.at(place);
        self.warnings.push((at, message));
    }
}

fn convert(text: &str, groom: FileGroom) -> Result<Loaded, FileError> {
    let mut reader = Reader {
        text,
        format: groom.format,
        scan: scan(text),
        warnings: vec![],
        raw: vec![],
        refused: None,
    };
    let mut document =
        Document { title: groom.title, note: groom.note, seed: groom.seed, ..Document::default() };
    let mut links: Vec<(Socket, Vec<Socket>)> = vec![];
    let mut into: BTreeMap<Socket, Vec<(Socket, Option<Socket>)>> = BTreeMap::new();
    // Groups before what is in them: what they declare says what their border is.
    let mut open: Vec<(NodeId, FileNode)> = groom.nodes.0.into_iter().rev().collect();
    while let Some((id, mut node)) = open.pop() {
        if document.nodes.contains_key(&id) {
            let message = format!("{id}: it stands elsewhere in the file too: dropped");
            reader.warn(&FileEntry::Node(id), message);
            continue;
        }
        for (inner, node) in std::mem::take(&mut node.nodes.0).into_iter().rev() {
            match NodeId::within(Some(&id), inner.as_str()) {
                Ok(inner) => open.push((inner, node)),
                Err(_) => {
                    let most = crate::document::DEEPEST_GROUP;
                    let message =
                        format!("{inner} in {id}: groups are nested deeper than {most}: dropped");
                    reader.warn(&FileEntry::Node(id.clone()), message);
                }
            }
        }
        let group = id.group();
        // Within a group what is wired has the group's id before its own: it is left out.
        let beside = |socket: Socket| within(group.as_ref(), socket.clone()).unwrap_or(socket);
        let wired = std::mem::take(&mut node.links.0).into_iter();
        links.extend(wired.map(|(input, from)| {
            let from = from.0.into_iter().map(beside).collect();
            (Socket::new(id.clone(), &input.0), from)
        }));
        for FileInto(WireEntry { output, to, after }) in std::mem::take(&mut node.into) {
            let from = Socket::new(id.clone(), &output);
            into.entry(beside(to)).or_default().push((from, after.map(beside)));
        }
        if let Some((x, y)) = node.at {
            reader.place(&mut document, &id, Point(x, y));
        }
        if node.collapsed {
            document.collapsed.insert(id.clone());
        }
        let node = reader.node(&document, &id, node);
        document.nodes.insert(id, Arc::new(node));
    }
    links.extend(groom.links.0.into_iter().map(|(to, FileWires(from))| (to, from)));
    for (written, from) in links {
        let to = reader.present_input(&document, &written, FileEntry::Link);
        let why = match document.links.entry(to) {
            _ if from.is_empty() => "an empty list of wires",
            Entry::Occupied(_) => "the input is wired elsewhere in the file too",
            Entry::Vacant(entry) => {
                entry.insert(from);
                continue;
            }
        };
        reader.warn(&FileEntry::Link(written.clone()), format!("{written}: {why}: dropped"));
    }
    for (written, wires) in into {
        let to = reader.present_input(&document, &written, FileEntry::Link);
        let said: Vec<_> = wires.iter().map(|(from, after)| (from, after.as_ref())).collect();
        let ordered = in_order(&said).into_iter().map(|n| wires[n].0.clone());
        document.links.entry(to).or_default().extend(ordered);
    }
    if !groom.display.is_empty() {
        let id = NodeId::new(&groom.display).ok();
        document.display = id.filter(|id| document.nodes.contains_key(id));
        if document.display.is_none() {
            let message = format!("display: there is no node {:?}: dropped", groom.display);
            reader.warn(&FileEntry::Field("display".to_owned()), message);
        }
    }
    reader.besides(&mut document, groom.frames, groom.bends, groom.collapsed, groom.views);
    let FileBudget { seconds, points, mib } = groom.budget;
    for (term, limit) in Term::ALL.into_iter().zip([seconds, points, mib]) {
        // Left out, it would be a limit that nobody holds.
        if let Err(why) = document.budget.set(term, limit) {
            let at = reader.at(&FileEntry::Field("budget".to_owned()));
            reader.refused.get_or_insert((at, format!("budget: {why}")));
        }
    }
    if let Some(FileLook { light, exposure, turn, skin }) = groom.look {
        let look = SavedLook { light, exposure, turn, skin };
        match look.fault() {
            Some(why) => {
                let place = FileEntry::Field("look".to_owned());
                reader.warn(&place, format!("look: {why}: dropped"));
            }
            None => document.look = Some(look),
        }
    }
    if !groom.thumbnail.is_empty() {
        match Thumbnail::from_text(&groom.thumbnail) {
            Ok(thumbnail) => document.thumbnail = Some(thumbnail),
            Err(why) => {
                let place = FileEntry::Field("thumbnail".to_owned());
                reader.warn(&place, format!("thumbnail: {why}: dropped"));
            }
        }
    }
    for (id, (x, y)) in groom.layout.0 {
        if document.nodes.contains_key(&id) {
            reader.place(&mut document, &id, Point(x, y));
        } else {
            let message = format!("layout of {id}: there is no such node: dropped");
            reader.warn(&FileEntry::Layout(id), message);
        }
    }
    reader.upgrade(&mut document);
    reader.finish(document)
}

impl Reader<'_> {
    /// Where a node stands; what it says itself goes before the table of format 1.
    fn place(&mut self, document: &mut Document, id: &NodeId, at: Point) {
        let why = if !at.is_finite() {
            "its place is not a finite number"
        } else if document.layout.contains_key(id) {
            "its place is said elsewhere in the file too"
        } else {
            document.layout.insert(id.clone(), at);
            return;
        };
        self.warn(&FileEntry::Layout(id.clone()), format!("layout of {id}: {why}: dropped"));
    }

    fn node(&mut self, document: &Document, id: &NodeId, file: FileNode) -> Node {
        let mut node = Node {
            kind: file.kind,
            label: Some(file.label).filter(|label| !label.is_empty()),
            note: file.note,
            bypass: file.bypass,
            template: file.template.map(|origin| Arc::new(origin.into())),
            ..Node::default()
        };
        if let Some(declared) = file.interface {
            let (interface, said) = ports::interface(declared);
            node.interface = Some(interface);
            for what in said {
                let place = FileEntry::NodeField(id.clone(), "interface".to_owned());
                self.warn(&place, format!("{id}: {what}"));
            }
        }
        let def = document.def_of(id, &node);
        if def.is_none() && !declared::KINDS.contains(&node.kind.as_str()) {
            let message = format!("{id}: unknown node kind {:?}: kept as it is", node.kind);
            self.warn(&FileEntry::NodeField(id.clone(), "kind".to_owned()), message);
        }
        if node.kind == declared::GROUP_OUTPUT && !file.inputs.0.is_empty() {
            let message = format!(
                "{id}: what goes out of a group comes by wire: its values are kept as they are"
            );
            self.warn(&FileEntry::NodeField(id.clone(), "inputs".to_owned()), message);
        }
        let def = def.filter(|_| node.kind != declared::GROUP_OUTPUT);
        let written: BTreeSet<String> =
            file.inputs.0.iter().map(|(name, _)| name.clone()).collect();
        for (name, raw) in file.inputs.0 {
            let place = FileEntry::Input(id.clone(), name.clone());
            let present = present_name(def, &name);
            if present != name && written.contains(&present) {
                let message =
                    format!("{id}.{name}: {present} is its new name and set too: dropped");
                self.warn(&place, message);
                continue;
            }
            if present != name {
                let comments = self.scan.comments.remove(&place);
                let renamed = FileEntry::Input(id.clone(), present.clone());
                self.scan.comments.extend(comments.map(|lines| (renamed, lines)));
            }
            let setting = self.setting(id, def, &place, &present, trimmed(raw.get_ron()));
            node.inputs.insert(present, setting);
        }
        node
    }

    fn setting(
        &mut self,
        id: &NodeId,
        def: Option<&NodeDef>,
        place: &FileEntry,
        name: &str,
        text: &str,
    ) -> Setting {
        if let Some(def) = def {
            let input = def.inputs.iter().find(|input| input.name == name).map(|input| input.ty);
            match input.or_else(|| upgrade::former_type(self.format, def.id, name)) {
                Some(ty) => match placed_value(ty, text) {
                    Ok(value) => return Setting::Known(value),
                    Err(Wrong { at, reason }) => {
                        let at = self.at(place) + at;
                        self.warnings.push((at, format!("{id}.{name}: {reason}")));
                    }
                },
                None => {
                    let message =
                        format!("{id}.{name}: {} has no such input: kept as it is", def.id);
                    self.warn(place, message);
                }
            }
        }
        let at = self.at(place);
        if let Err(why) = prove_raw(text) {
            // Nested so deeply that it could not be read back from within groups.
            self.refused.get_or_insert((at, why));
        }
        self.raw.push(at..at + text.len());
        Setting::Raw(text.into())
    }

    /// What is kept besides the meaning.
    fn besides(
        &mut self,
        document: &mut Document,
        frames: Entries<String, FileFrame>,
        bends: Entries<Socket, Vec<Vec<(f32, f32)>>>,
        collapsed: Vec<String>,
        views: Entries<String, FileView>,
    ) {
        let point = |(x, y)| Point(x, y);
        for (name, FileFrame { at, size, text, colour }) in frames.0 {
            let frame = Frame { at: point(at), size: point(size), text, colour };
            match frame.fault(&name) {
                Some(why) => {
                    let message = format!("frame {:?}: {why}: dropped", short(&name));
                    self.warn(&FileEntry::Frame(name), message);
                }
                None => drop(document.frames.insert(name, frame)),
            }
        }
        for (written, bends) in bends.0 {
            let to = self.present_input(document, &written, FileEntry::Bends);
            let wires = document.links.get(&to).map_or(0, Vec::len);
            let bends: Vec<Vec<Point>> =
                bends.into_iter().map(|wire| wire.into_iter().map(point).collect()).collect();
            let why = if !bends.iter().flatten().all(|point| point.is_finite()) {
                "a bend is not a finite number"
            } else if bends.len() > wires {
                "there are fewer wires"
            } else if document.bends.contains_key(&to) {
                "the input has bends under its new name too"
            } else {
                document.set_all_bends(&to, bends);
                continue;
            };
            self.warn(
                &FileEntry::Bends(written.clone()),
                format!("bends of {written}: {why}: dropped"),
            );
        }
        for name in collapsed {
            let id = NodeId::new(&name).ok().filter(|id| document.nodes.contains_key(id));
            match id {
                Some(id) => drop(document.collapsed.insert(id)),
                None => {
                    let place = NodeId::new(&name)
                        .map_or(FileEntry::Field("collapsed".to_owned()), FileEntry::Collapsed);
                    let name = short(&name);
                    self.warn(&place, format!("collapsed: there is no node {name:?}: dropped"));
                }
            }
        }
        for (name, FileView { eye, target, up, focal_mm, orthographic }) in views.0 {
            let orthographic = Some(orthographic).filter(|height| *height != 0.0);
            let view = SavedView { eye, target, up, focal_mm, orthographic };
            match view.fault(&name) {
                Some(why) => {
                    let message = format!("view {:?}: {why}: dropped", short(&name));
                    self.warn(&FileEntry::View(name), message);
                }
                None => drop(document.views.insert(name, view)),
            }
        }
    }

    /// The socket under the name that its node's input has today.
    fn present_input(
        &mut self,
        document: &Document,
        written: &Socket,
        place: fn(Socket) -> FileEntry,
    ) -> Socket {
        let def = document.def(&written.node);
        let to = Socket::new(written.node.clone(), &present_name(def, &written.name));
        if to != *written
            && let Some(lines) = self.scan.comments.remove(&place(written.clone()))
        {
            self.scan.comments.insert(place(to.clone()), lines);
        }
        to
    }

    /// Brings what an older format means to ours.
    fn upgrade(&mut self, document: &mut Document) {
        let upgrade::Done { moved, lost } = upgrade::upgrade(document, self.format);
        for (place, message) in lost {
            self.warn(&place, message);
        }
        for (from, to) in moved {
            if let Some(lines) = self.scan.comments.remove(&from) {
                self.scan.comments.entry(to).or_default().extend(lines);
            }
        }
    }

    fn finish(mut self, mut document: Document) -> Result<Loaded, FileError> {
        if let Some((at, why)) = self.refused {
            return Err(error_at(self.text, at, why));
        }
        let mut dropped = std::mem::take(&mut self.scan.dropped);
        let conflicts = self.scan.comments.values().flatten().chain(&dropped);
        let conflicts = conflicts.filter_map(|comment| {
            let left = comment.text.strip_prefix(CONFLICT)?;
            let message =
                format!("merge conflict:{left}; choose a value, then remove this comment");
            Some((comment.at, message))
        });
        let conflicts = conflicts.collect();
        for (place, lines) in std::mem::take(&mut self.scan.comments) {
            // What is written with nodes now had tables of its own, and where many go in the wires
            // may be typed with the node that they go to.
            let place = match &place {
                _ if document.has(&place) => place,
                FileEntry::Field(name)
                    if ["links", "collapsed", "layout"].contains(&name.as_str()) =>
                {
                    FileEntry::Field("nodes".to_owned())
                }
                FileEntry::NodeField(id, name) if ["links", "into"].contains(&name.as_str()) => {
                    FileEntry::Node(id.clone())
                }
                _ => place,
            };
            if document.has(&place) {
                let lines = lines.into_iter().map(|line| line.text);
                document.comments.entry(place).or_default().extend(lines);
            } else {
                dropped.extend(lines);
            }
        }
        // Comments within kept text are kept. The ranges do not overlap.
        self.raw.sort_by_key(|raw| raw.start);
        let raw = self.raw;
        dropped.retain(|comment| {
            let after = raw.partition_point(|raw| raw.start <= comment.at);
            after == 0 || !raw[after - 1].contains(&comment.at)
        });
        let dropped = dropped.into_iter().map(|comment| (comment.at, comment.text)).collect();
        Ok(Loaded {
            document,
            warnings: errors_at(self.text, self.warnings),
            conflicts: errors_at(self.text, conflicts),
            dropped_comments: errors_at(self.text, dropped),
        })
    }
}

/// A socket that is written in a group, under the ids of the document.
pub(super) fn within(group: Option<&NodeId>, socket: Socket) -> Result<Socket, BadId> {
    match group {
        Some(_) => Ok(Socket { node: NodeId::within(group, socket.node.as_str())?, ..socket }),
        None => Ok(socket),
    }
}

fn present_name(def: Option<&NodeDef>, name: &str) -> String {
    def.and_then(|def| def.input(name)).map_or(name, |(_, input)| input.name).to_owned()
}
