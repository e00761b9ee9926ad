//! Groups: nodes in a node with inputs and outputs of its own, and named parameters.
//!
//! A group is a node; those in it have its id before theirs (`row/braid`). What comes in is given inside by a
//! `group_input`, what goes out is wired to a `group_output`. Evaluation leads through all three, so grouped nodes give
//! the bits that they gave before.
//!
//! Pure functions from a document to another, or to an edit. What they refuse they refuse with a reason for people. They
//! prove nothing of the document: `graph::check` says what is wrong with groups in one.

use super::edit::Edit;
use super::graph::{self, Fault, Problem, problem};
use super::{Document, FileEntry, Node, NodeId, Point, Setting, Socket};
use crate::values;
use coif_nodes::declared::{self, Interface, Port};
use coif_nodes::define::{Arity, InputDef, Type};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Nodes, and what is in those of them that are groups.
pub fn with_inside(document: &Document, nodes: &BTreeSet<NodeId>) -> BTreeSet<NodeId> {
    let inside = nodes.iter().flat_map(|id| document.inside(id)).map(|(id, _)| id);
    nodes.iter().chain(inside).cloned().collect()
}

/// What is wrong with where a node stands, and with a group's border.
pub(super) fn check(document: &Document, id: &NodeId, node: &Node, problems: &mut Vec<Problem>) {
    let mut say = |text: String, remedy: &str| {
        problems.push(problem(Fault::Border, id, None, text, remedy));
    };
    let group = id.group();
    let within = group.as_ref().and_then(|group| document.node(group.as_str()));
    let is_border = [declared::GROUP_INPUT, declared::GROUP_OUTPUT].contains(&node.kind.as_str());
    match (&group, within) {
        (Some(group), None) => say(
            format!("it is in {group}, and there is no such node"),
            "add the group, or remove this node",
        ),
        (Some(group), Some(within)) if !within.is_group() => say(
            format!("it is in {group}, which is no group but a {}", within.kind),
            "remove this node, or make a group of the other",
        ),
        (None, _) if is_border => {
            say(format!("a {} stands in a group, and this is in none", node.kind), "remove it");
        }
        _ => {}
    }
    if node.is_group() && node.interface.is_some_and(|i| !i.outputs().is_empty()) {
        let beside = |(other, _): &(&NodeId, &Arc<Node>)| other.group().as_ref() == Some(id);
        let of_kind = |(_, node): &(&NodeId, &Arc<Node>)| node.kind == declared::GROUP_OUTPUT;
        match document.inside(id).filter(beside).filter(of_kind).count() {
            1 => {}
            0 => say(
                "nothing in it says what it gives".to_owned(),
                "add a group_output in it and wire its outputs",
            ),
            n => say(format!("{n} nodes in it say what it gives"), "keep one group_output"),
        }
    }
}

/// The document with other ids; `to` must give each a new one of its own.
pub(crate) fn renamed(document: &Document, to: impl Fn(&NodeId) -> NodeId) -> Document {
    let socket = |s: &Socket| Socket { node: to(&s.node), name: s.name.clone() };
    let place = |place: &FileEntry| match place {
        FileEntry::Node(id) => FileEntry::Node(to(id)),
        FileEntry::NodeField(id, name) => FileEntry::NodeField(to(id), name.clone()),
        FileEntry::Input(id, name) => FileEntry::Input(to(id), name.clone()),
        FileEntry::Link(s) => FileEntry::Link(socket(s)),
        FileEntry::Bends(s) => FileEntry::Bends(socket(s)),
        FileEntry::Collapsed(id) => FileEntry::Collapsed(to(id)),
        FileEntry::Layout(id) => FileEntry::Layout(to(id)),
        FileEntry::Top | FileEntry::Field(_) | FileEntry::Frame(_) | FileEntry::View(_) => {
            place.clone()
        }
    };
    let wires = |all: &[Socket]| all.iter().map(socket).collect();
    Document {
        display: document.display.as_ref().map(&to),
        nodes: document.nodes.iter().map(|(id, node)| (to(id), node.clone())).collect(),
        links: document.links.iter().map(|(to, from)| (socket(to), wires(from))).collect(),
        bends: document.bends.iter().map(|(to, bends)| (socket(to), bends.clone())).collect(),
        collapsed: document.collapsed.iter().map(&to).collect(),
        layout: document.layout.iter().map(|(id, at)| (to(id), *at)).collect(),
        comments: document.comments.iter().map(|(at, c)| (place(at), c.clone())).collect(),
        ..document.clone()
    }
}

/// `stem`, else with the first free number behind it; a name of a port.
fn free_port<'a>(mut taken: impl FnMut(&str) -> bool + 'a, stem: &str) -> String {
    let stem: String = stem.chars().take(declared::LONGEST_NAME - 8).collect();
    let mut name = stem.clone();
    for n in 2u32.. {
        if !taken(&name) {
            break;
        }
        name = format!("{stem}_{n}");
    }
    name
}

fn has(ports: &[Port], name: &str) -> bool {
    ports.iter().any(|port| port.name == name)
}

/// The node's input as a port that gives it what it takes.
fn port_for(name: String, input: Option<&InputDef>, ty: Type) -> Port {
    let needed = input.is_some_and(|i| i.arity == Arity::One && !i.has_default());
    let doc = input.map(InputDef::doc).unwrap_or_default();
    let arity = if needed { Arity::One } else { Arity::Optional };
    Port { doc, arity, ..Port::new(&name, ty) }
}

/// The port of a node of parameters that a wire comes from.
fn parameter(document: &Document, from: &Socket) -> Option<&'static Port> {
    let node = document.node(from.node.as_str()).filter(|n| n.kind == declared::PARAMETERS)?;
    node.interface?.inputs().iter().find(|port| port.name == *from.name)
}

/// What a set of nodes takes from outside and gives to it.
struct Border {
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    /// For each output outside that feeds it, the port that it comes in by.
    from: BTreeMap<Socket, String>,
    /// For each output inside that is used outside, the port that it goes out by.
    to: BTreeMap<Socket, String>,
}

fn border(document: &Document, nodes: &BTreeSet<NodeId>) -> Result<Border, String> {
    let mut found =
        Border { inputs: vec![], outputs: vec![], from: BTreeMap::new(), to: BTreeMap::new() };
    let type_of = |from: &Socket| {
        super::wiring::output_type(document, from)
            .ok_or_else(|| format!("nobody knows what {from} gives, so no port can be made for it"))
    };
    let give = |found: &mut Border, from: &Socket| -> Result<(), String> {
        if !found.to.contains_key(from) {
            let name = free_port(|name| has(&found.outputs, name), &from.name);
            let def = document.def(&from.node).and_then(|def| def.output(&from.name));
            let doc = def.map(|(_, output)| output.doc()).unwrap_or_default();
            found.outputs.push(Port { doc, ..Port::new(&name, type_of(from)?) });
            found.to.insert(from.clone(), name);
        }
        Ok(())
    };
    let mut fed_inside = BTreeSet::new();
    for (to, wires) in &document.links {
        for from in wires {
            match (nodes.contains(&from.node), nodes.contains(&to.node)) {
                (false, true) if !found.from.contains_key(from) => {
                    let told = parameter(document, from);
                    let stem = told.map_or(&*to.name, |port| &port.name);
                    let name = free_port(|name| has(&found.inputs, name), stem);
                    let input = super::wiring::input_def(document, to);
                    found.inputs.push(match told {
                        Some(port) => Port { name: name.clone(), ..port.clone() },
                        None => port_for(name.clone(), input, type_of(from)?),
                    });
                    found.from.insert(from.clone(), name);
                }
                (true, false) => give(&mut found, from)?,
                (true, true) => drop(fed_inside.insert(&from.node)),
                _ => {}
            }
        }
    }
    if found.outputs.is_empty() {
        // Nothing is used yet: what the ends of it give can be.
        for id in nodes.iter().filter(|id| !fed_inside.contains(id)) {
            if let Some(output) = document.def(id).and_then(|def| def.outputs.first()) {
                give(&mut found, &Socket::new(id.clone(), output.name))?;
            }
        }
    }
    Ok(found)
}

/// The left, right and middle of nodes on the canvas.
fn extent<'a>(document: &Document, nodes: impl Iterator<Item = &'a NodeId>) -> Option<[Point; 3]> {
    let all: Vec<Point> = nodes.filter_map(|id| document.layout.get(id)).copied().collect();
    let first = *all.first()?;
    let (lo, hi) = all.iter().fold((first, first), |(lo, hi), at| {
        (Point(lo.0.min(at.0), lo.1.min(at.1)), Point(hi.0.max(at.0), hi.1.max(at.1)))
    });
    // In whole places that the canvas can show: a file may say any number.
    let far = |at: Point| at.0.abs().max(at.1.abs()) > 1e9;
    if far(lo) || far(hi) {
        return None;
    }
    let middle = Point((lo.0 + hi.0) * 0.5, (lo.1 + hi.1) * 0.5);
    Some([Point(lo.0 - 260.0, middle.1), Point(hi.0 + 260.0, middle.1), middle])
}

/// A group by itself, called `template`, with nothing set on it and nothing said of it: what is compared.
pub fn alone(document: &Document, group: &NodeId) -> Document {
    let mut found = Document::default();
    let name = |id: &NodeId| -> NodeId {
        let rest = id.as_str().strip_prefix(group.as_str()).unwrap_or_default();
        NodeId::new(&format!("template{rest}")).unwrap_or_else(|_| id.clone())
    };
    if let Some(node) = document.nodes.get(group) {
        let Node { kind, interface, .. } = Node::clone(node);
        let bare = Node { kind, interface, ..Node::default() };
        found.nodes.insert(name(group), bare.into());
    }
    for (id, node) in document.inside(group) {
        found.nodes.insert(name(id), node.clone());
    }
    for (to, wires) in document.links.iter().filter(|(to, _)| to.node.is_inside(group)) {
        let renamed =
            |socket: &Socket| Socket { node: name(&socket.node), name: socket.name.clone() };
        found.links.insert(renamed(to), wires.iter().map(renamed).collect());
    }
    found
}

/// Puts nodes into a new group: the document with it, and its id. What they took from other nodes are its inputs, what others
/// took from them its outputs. Nodes of parameters stay outside, where the group takes from them.
///
/// # Errors
/// There are no nodes, they are in different groups, or one is a border of a group; a port would be of no known type; groups
/// would be nested too deeply.
pub fn make(
    document: &Document,
    nodes: &BTreeSet<NodeId>,
    name: &str,
) -> Result<(Document, NodeId), String> {
    let kind = |id: &NodeId| document.node(id.as_str()).map_or("", |node| node.kind.as_str());
    let nodes: &BTreeSet<NodeId> =
        &nodes.iter().filter(|id| kind(id) != declared::PARAMETERS).cloned().collect();
    let first = nodes.first().ok_or("select the nodes that are to be in the group")?;
    let outer = first.group();
    if let Some(other) = nodes.iter().find(|id| id.group() != outer) {
        return Err(format!("{first} and {other} are in different groups"));
    }
    let is_border =
        |id: &&NodeId| [declared::GROUP_INPUT, declared::GROUP_OUTPUT].contains(&kind(id));
    if let Some(id) = nodes.iter().find(is_border) {
        return Err(format!("{} is the border of its group and stays in it", document.name_of(id)));
    }
    let group = document.free_id_in(outer.as_ref(), name);
    let all = with_inside(document, nodes);
    let deepest = all.iter().map(|id| id.as_str().matches('/').count()).max().unwrap_or_default();
    if deepest + 2 > super::DEEPEST_GROUP {
        return Err(format!("groups are nested {} deep at most", super::DEEPEST_GROUP - 1));
    }
    let Border { inputs, outputs, from, to } = border(document, nodes)?;
    let into = |id: &NodeId| -> NodeId {
        let inner = match &outer {
            Some(outer) => &id.as_str()[outer.as_str().len() + 1..],
            None => id.as_str(),
        };
        NodeId::within(Some(&group), inner).unwrap_or_else(|_| id.clone())
    };
    let moved = |id: &NodeId| if all.contains(id) { into(id) } else { id.clone() };
    let mut after = renamed(document, moved);
    let interface = Interface::new(inputs, outputs).map_err(|err| err.to_string())?;
    let label = Some(name.trim().to_owned()).filter(|name| !name.is_empty());
    let node =
        Node { kind: declared::GROUP.into(), label, interface: Some(interface), ..Node::default() };
    after.nodes.insert(group.clone(), node.into());
    let [at_in, at_out] = borders(&mut after, &group);
    if let Some([left, right, middle]) = extent(document, nodes.iter()) {
        after.layout.insert(group.clone(), middle);
        after.layout.insert(at_in.clone(), left);
        after.layout.insert(at_out.clone(), right);
    }
    for (socket, wires) in &mut after.links {
        let is_inside = socket.node.is_inside(&group);
        for wire in wires {
            // What is not in the group kept its name.
            if is_inside && let Some(port) = from.get(wire) {
                *wire = Socket::new(at_in.clone(), port);
            } else if !is_inside
                && let Some((_, port)) =
                    to.iter().find(|(old, _)| into(&old.node) == wire.node && old.name == wire.name)
            {
                *wire = Socket::new(group.clone(), port);
            }
        }
    }
    for (socket, port) in &from {
        after.links.insert(Socket::new(group.clone(), port), vec![socket.clone()]);
    }
    for (socket, port) in &to {
        let inner = Socket { node: into(&socket.node), name: socket.name.clone() };
        after.links.insert(Socket::new(at_out.clone(), port), vec![inner]);
    }
    // Where the wires run has changed: those that crossed the border run by themselves.
    let straight = |to: &Socket| {
        after
            .links
            .get(to)
            .is_some_and(|wires| wires.iter().any(|wire| wire.node == at_in || wire.node == group))
    };
    let bent: Vec<Socket> = after.bends.keys().filter(|to| straight(to)).cloned().collect();
    bent.iter().for_each(|to| drop(after.bends.remove(to)));
    after.settle();
    Ok((after, group))
}

/// Adds what comes in and what goes out to a group; gives their ids.
pub(crate) fn borders(document: &mut Document, group: &NodeId) -> [NodeId; 2] {
    [("in", declared::GROUP_INPUT), ("out", declared::GROUP_OUTPUT)].map(|(stem, kind)| {
        let id = document.free_id_in(Some(group), stem);
        document.nodes.insert(id.clone(), Node { kind: kind.into(), ..Node::default() }.into());
        id
    })
}

/// Takes a group apart: the document with its nodes in its place, and these.
///
/// # Errors
/// It is no group, or it is bypassed, which nodes alone cannot be.
pub fn ungroup(
    document: &Document,
    group: &NodeId,
) -> Result<(Document, BTreeSet<NodeId>), String> {
    let node = document.node(group.as_str()).filter(|node| node.is_group());
    let node = node.ok_or_else(|| format!("{} is no group", document.name_of(group)))?;
    if node.bypass {
        return Err(format!("{} is bypassed: let it work first", document.name_of(group)));
    }
    let outer = group.group();
    let mut ids: BTreeMap<NodeId, NodeId> = BTreeMap::new();
    let mut taken = document.clone();
    for (id, _) in document.inside(group) {
        let rest = &id.as_str()[group.as_str().len() + 1..];
        let new = match rest.rsplit_once('/') {
            None => taken.free_id_in(outer.as_ref(), rest),
            // What it is in came before it, unless a broken file has it without.
            Some(_) => {
                let whole = id.as_str();
                let found = whole.rmatch_indices('/').find_map(|(at, _)| {
                    let within = ids.get(whole.get(..at)?)?;
                    Some(format!("{within}{}", &whole[at..]))
                });
                match found {
                    Some(path) => NodeId::new(&path).map_err(|err| err.to_string())?,
                    None => taken.free_id_in(outer.as_ref(), rest),
                }
            }
        };
        taken.nodes.insert(new.clone(), Arc::default());
        ids.insert(id.clone(), new);
    }
    let through = Through::new(document, group, node);
    let mut plain = document.clone();
    let is_border = |id: &NodeId| id.group().as_ref() == Some(group) && through.is_border(id);
    for (to, wires) in &document.links {
        if to.node == *group || is_border(&to.node) {
            plain.links.remove(to);
            plain.bends.remove(to);
            continue;
        }
        let touches = |wire: &Socket| wire.node == *group || is_border(&wire.node);
        if !wires.iter().any(touches) {
            continue;
        }
        plain.bends.remove(to);
        let mut sources = vec![];
        let mut value = None;
        for wire in wires {
            match through.source(wire) {
                Source::Wires(wires) => sources.extend(wires),
                Source::Value(set) => value = Some(set),
                Source::Nothing => {}
            }
        }
        match sources.is_empty() {
            true => drop(plain.links.remove(to)),
            false => drop(plain.links.insert(to.clone(), sources)),
        }
        if let Some(set) = value
            && let Some(inner) = plain.nodes.get_mut(&to.node)
        {
            let ty = document.def(&to.node).and_then(|def| def.input(&to.name)).map(|(_, i)| i.ty);
            let set = match (ty, set) {
                (Some(ty), Setting::Known(value)) => {
                    Setting::Known(values::fit(ty, value).map_err(|why| format!("{to}: {why}"))?)
                }
                (_, set) => set,
            };
            Arc::make_mut(inner).inputs.insert(to.name.to_string(), set);
        }
    }
    let gone: Vec<NodeId> = document
        .inside(group)
        .map(|(id, _)| id.clone())
        .filter(is_border)
        .chain([group.clone()])
        .collect();
    let shown = document.display.clone().filter(|id| gone.contains(id));
    for id in &gone {
        plain.nodes.remove(id);
        plain.layout.remove(id);
        plain.collapsed.remove(id);
    }
    if let Some(shown) = shown {
        let from = document.def(&shown).and_then(|def| def.outputs.first());
        plain.display =
            from.and_then(|from| match through.source(&Socket::new(shown, from.name)) {
                Source::Wires(wires) => wires.first().map(|wire| wire.node.clone()),
                _ => None,
            });
    }
    let mut after = renamed(&plain, |id| ids.get(id).unwrap_or(id).clone());
    after.settle();
    let free =
        ids.iter().filter(|(old, _)| !gone.contains(old) && old.group().as_ref() == Some(group));
    Ok((after.clone(), free.map(|(_, new)| new.clone()).collect()))
}

/// Makes parameters of the graph of what can be set on a group: its inputs that take a value and have no wire, in a node of their own
/// called `label`, where the group's inner nodes take from. The document with it, and its id; none where nothing can be set.
///
/// # Errors
/// It is no group, or it stands in another.
pub fn set_by_parameters(
    document: &Document,
    group: &NodeId,
    label: &str,
) -> Result<(Document, Option<NodeId>), String> {
    let node = document.node(group.as_str()).filter(|node| node.is_group());
    let node = node.ok_or_else(|| format!("{} is no group", document.name_of(group)))?;
    if group.group().is_some() {
        return Err(format!("{} stands in another group", document.name_of(group)));
    }
    let to = |port: &Port| Socket::new(group.clone(), &port.name);
    let made = |ty| matches!(ty, Type::Curves | Type::Scalp | Type::Strokes | Type::Gestures);
    let is_set = |port: &&Port| !made(port.ty) && !document.links.contains_key(&to(port));
    let ports: Vec<Port> =
        node.interface.unwrap_or_default().inputs().iter().filter(is_set).cloned().collect();
    if ports.is_empty() {
        return Ok((document.clone(), None));
    }
    let mut after = document.clone();
    let id = after.free_id(declared::PARAMETERS);
    let mut inputs = BTreeMap::new();
    if let Some(node) = after.nodes.get_mut(group) {
        let node = Arc::make_mut(node);
        let set = |port: &Port| Some((port.name.clone(), node.inputs.remove(&port.name)?));
        inputs.extend(ports.iter().filter_map(set));
    }
    for port in &ports {
        after.links.insert(to(port), vec![Socket::new(id.clone(), &port.name)]);
    }
    // Where the group's own inputs stand.
    let border = document.inside(group).find(|(inner, node)| {
        node.kind == declared::GROUP_INPUT && inner.group().as_ref() == Some(group)
    });
    let at = border.and_then(|(inner, _)| document.layout.get(inner)).copied();
    after.layout.extend(at.map(|at| (id.clone(), at)));
    let interface = Some(Interface::new(ports, vec![]).map_err(|err| err.to_string())?);
    let label = Some(label.to_owned()).filter(|label| !label.is_empty());
    let kind = declared::PARAMETERS.to_owned();
    after
        .nodes
        .insert(id.clone(), Node { kind, label, inputs, interface, ..Node::default() }.into());
    after.settle();
    Ok((after, Some(id)))
}

/// The document in which a group has what it takes from nodes of parameters as defaults of its own inputs.
pub fn with_parameters_set(document: &Document, group: &NodeId) -> Document {
    let mut after = document.clone();
    let Some(interface) = document.node(group.as_str()).and_then(|node| node.interface) else {
        return after;
    };
    let mut ports = interface.inputs().to_vec();
    for port in &mut ports {
        let [wire] = document.wires(group, &port.name) else { continue };
        let Some(told) = parameter(document, wire) else { continue };
        let set = document.node(wire.node.as_str()).and_then(|node| node.inputs.get(&*wire.name));
        // A value that nobody can read stays where it is, to be told.
        let value = match set {
            Some(Setting::Known(value)) => Some(value),
            Some(Setting::Raw(_)) => None,
            None => told.default.as_ref(),
        };
        let value = value.and_then(|value| values::fit(port.ty, value.clone()).ok());
        if value.is_some() {
            (port.default, port.arity) = (value, Arity::Optional);
            after.links.remove(&Socket::new(group.clone(), &port.name));
        }
    }
    if let (Ok(interface), Some(node)) =
        (Interface::new(ports, interface.outputs().to_vec()), after.nodes.get_mut(group))
    {
        Arc::make_mut(node).interface = Some(interface);
    }
    after
}

/// What an output of a group, or of its border, comes from.
enum Source {
    Wires(Vec<Socket>),
    Value(Setting),
    Nothing,
}

/// Ways through the border of one group.
struct Through<'a> {
    document: &'a Document,
    group: &'a NodeId,
    node: &'a Node,
}

impl<'a> Through<'a> {
    fn new(document: &'a Document, group: &'a NodeId, node: &'a Node) -> Self {
        Self { document, group, node }
    }
    fn is_border(&self, id: &NodeId) -> bool {
        let kind = self.document.node(id.as_str()).map_or("", |node| node.kind.as_str());
        [declared::GROUP_INPUT, declared::GROUP_OUTPUT].contains(&kind)
    }
    /// What feeds `wire`, of which each end is at the border: at most out, and in, and out of the group.
    fn source(&self, wire: &Socket) -> Source {
        if wire.node == *self.group {
            let Some(out) = self.document.outputs_of(self.group) else { return Source::Nothing };
            return self.all(self.document.wires(out, &wire.name));
        }
        if !self.is_border(&wire.node) || wire.node.group().as_ref() != Some(self.group) {
            return Source::Wires(vec![wire.clone()]);
        }
        let wires = self.document.wires(self.group, &wire.name);
        if !wires.is_empty() {
            return Source::Wires(wires.to_vec());
        }
        let set = self.node.inputs.get(&*wire.name).cloned();
        let declared = || {
            let port = self.node.interface?.inputs().iter().find(|port| port.name == *wire.name)?;
            port.default.clone().map(Setting::Known)
        };
        set.or_else(declared).map_or(Source::Nothing, Source::Value)
    }
    fn all(&self, wires: &[Socket]) -> Source {
        let mut all = vec![];
        for wire in wires {
            match self.source(wire) {
                Source::Wires(wires) => all.extend(wires),
                other => return other,
            }
        }
        Source::Wires(all)
    }
}

/// Gives a group or a node of parameters other ports. What is wired or set keeps its port, under its new name where `names`
/// (old, new) says so and the type still fits; what has none any more goes.
pub fn set_interface(
    document: &Document,
    id: &NodeId,
    interface: Interface,
    names: &BTreeMap<String, String>,
) -> Option<Edit> {
    let node = document.node(id.as_str())?;
    let new_name = |old: &str| names.get(old).map_or(old, String::as_str).to_owned();
    let port = |ports: &'static [Port], old: &str| {
        let name = new_name(old);
        ports.iter().find(|port| port.name == name)
    };
    let (inputs, outputs) = (interface.inputs(), interface.outputs());
    let outputs = if node.is_group() { outputs } else { inputs };
    let mut new = node.clone();
    new.interface = Some(interface);
    new.inputs.clear();
    for (name, setting) in &node.inputs {
        let Some(port) = port(inputs, name) else { continue };
        let fitted = match setting {
            Setting::Known(value) => values::fit(port.ty, value.clone()).ok().map(Setting::Known),
            Setting::Raw(_) => Some(setting.clone()),
        };
        new.inputs.extend(fitted.map(|setting| (port.name.clone(), setting)));
    }
    let within = document.outputs_of(id).filter(|_| node.is_group());
    let is_in = |other: &NodeId| {
        node.is_group()
            && other.group().as_ref() == Some(id)
            && document.node(other.as_str()).is_some_and(|n| n.kind == declared::GROUP_INPUT)
    };
    // All wires that name a port are taken off, and put on again where their port is.
    let (mut off, mut on) = (vec![], vec![]);
    for (to, wires) in &document.links {
        let renamed = |socket: &Socket, ports| {
            port(ports, &socket.name).map(|port| Socket::new(socket.node.clone(), &port.name))
        };
        let new_to = match () {
            () if to.node == *id => renamed(to, inputs),
            () if within == Some(&to.node) => renamed(to, outputs),
            () => Some(to.clone()),
        };
        let source = |wire: &Socket| match () {
            () if wire.node == *id => renamed(wire, outputs),
            () if is_in(&wire.node) => renamed(wire, inputs),
            () => Some(wire.clone()),
        };
        let new_wires: Vec<Socket> = wires.iter().filter_map(source).collect();
        if new_to.as_ref() == Some(to) && new_wires == *wires {
            continue;
        }
        off.push(Edit::SetWires { to: to.clone(), from: vec![] });
        on.extend(new_to.map(|to| Edit::SetWires { to, from: new_wires }));
    }
    off.push(Edit::ReplaceNode { id: id.clone(), node: new.into() });
    off.extend(on);
    Some(Edit::Several(off))
}

/// Makes a port of an input of a node: on the group that it is in, or on the graph's parameters where it is in none (they are
/// added where there are none). The input takes its value from there; what it was set to is the port's default. Gives the
/// port.
///
/// # Errors
/// There is no such input, something is wired to it, or it cannot be a port.
pub fn expose(document: &Document, input: &Socket) -> Result<(Edit, Socket), String> {
    let def = super::wiring::input_def(document, input)
        .ok_or_else(|| format!("nobody knows what {input} takes"))?;
    if document.links.contains_key(input) {
        return Err(format!("{} comes by a wire already", input.name.replace('_', " ")));
    }
    let mut after = document.clone();
    let (holder, source) = holder(&mut after, input.node.group());
    let node = after.node(holder.as_str()).ok_or("there is no such group")?;
    let (mut inputs, outputs) = match node.interface {
        Some(interface) => (interface.inputs().to_vec(), interface.outputs().to_vec()),
        None => (vec![], vec![]),
    };
    let name = free_port(|name| has(&inputs, name), def.name);
    let mut port = Port::like(&name, def);
    if let Some(Setting::Known(value)) =
        document.node(input.node.as_str()).and_then(|node| node.inputs.get(def.name))
    {
        port.default = Some(value.clone());
    }
    inputs.push(port);
    let interface = Interface::new(inputs, outputs).map_err(|err| err.to_string())?;
    if let Some(node) = after.nodes.get_mut(&holder) {
        Arc::make_mut(node).interface = Some(interface);
    }
    if let Some(node) = after.nodes.get_mut(&input.node) {
        Arc::make_mut(node).inputs.remove(def.name);
    }
    let to = Socket::new(input.node.clone(), def.name);
    after.links.insert(to, vec![Socket::new(source, &name)]);
    after.settle();
    Ok((super::edit::between(document, &after), Socket::new(holder, &name)))
}

/// Lets an input read a port that there is: of the group that it is in, or of the graph's parameters.
///
/// # Errors
/// There is no such port, or it gives what the input does not take.
pub fn read_port(document: &Document, input: &Socket, port: &str) -> Result<Edit, String> {
    let mut after = document.clone();
    let (_, source) = holder(&mut after, input.node.group());
    let from = Socket::new(source, port);
    if let Some(problem) = graph::wire_problem(&after, &from, input) {
        return Err(problem.text);
    }
    if let Some(node) = after.nodes.get_mut(&input.node) {
        Arc::make_mut(node).inputs.remove(&*input.name);
    }
    after.links.insert(input.clone(), vec![from]);
    after.settle();
    Ok(super::edit::between(document, &after))
}

/// The node whose ports nodes of a group read, and the one that gives them there; added where there is none.
fn holder(document: &mut Document, group: Option<NodeId>) -> (NodeId, NodeId) {
    let kind = if group.is_some() { declared::GROUP_INPUT } else { declared::PARAMETERS };
    let there = document.nodes.iter().find(|(id, node)| node.kind == kind && id.group() == group);
    let there = there.map(|(id, _)| id.clone());
    let source = there.unwrap_or_else(|| {
        let stem = if group.is_some() { "in" } else { declared::PARAMETERS };
        let id = document.free_id_in(group.as_ref(), stem);
        let mut node = Node { kind: kind.into(), ..Node::default() };
        if group.is_none() {
            node.interface = Some(Interface::default());
        }
        let beside = document.nodes.keys().filter(|other| other.group() == group);
        if let Some([left, ..]) = extent(document, beside) {
            document.layout.insert(id.clone(), left);
        }
        document.nodes.insert(id.clone(), node.into());
        id
    });
    (group.unwrap_or_else(|| source.clone()), source)
}

#[cfg(test)]
mod tests;
