//! Templates: groups that travel from groom to groom and from show to show.
//!
//! A template is an ordinary groom that holds one marked group ([`Origin`]) and what shows it: it opens, evaluates and renders by
//! itself. To use one is to copy its group, whole, so a groom stays one file that opens anywhere. What makes two templates
//! the same is what their groups mean: layout, notes, labels, formatting and the values that a groom sets on the group do not
//! count, anything else does ([`hash`]).
//!
//! Pure functions of documents; nothing here opens a file. What an upgrade does is told for every port before it is done.

use crate::compare::successor;
use crate::document::edit::{Edit, between};
use crate::document::graph::HEAD;
use crate::document::{Document, Node, NodeId, Origin, Setting, Socket, groups};
use crate::file::document_hash;
use crate::values;
use coif_nodes::declared::Port;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

mod add;

/// The kind of node that gives hair to files.
const OUTPUT: &str = "groom_output";

pub use add::{Added, Placement, add};

/// The group of a document that a template is made of: its marked one, where there is exactly one outside of all groups.
///
/// # Errors
/// None is marked, or several are.
pub fn group_of(document: &Document) -> Result<&NodeId, String> {
    let mut marked = document
        .nodes
        .iter()
        .filter(|(id, node)| id.group().is_none() && node.is_group() && node.template.is_some());
    match (marked.next(), marked.next()) {
        (Some((id, _)), None) => Ok(id),
        (None, _) => Err("no group in it is marked as a template".to_owned()),
        (Some((one, _)), Some((other, _))) => {
            Err(format!("{one} and {other} are both marked as templates: a file holds one"))
        }
    }
}

/// What a group means, as 32 hexadecimal digits: the nodes in it with all their values, and its ports. Not what is set on
/// it, wired to it, or said of it.
pub fn hash(document: &Document, group: &NodeId) -> String {
    document_hash(&groups::alone(document, group))
}

/// The nodes that hold instances of templates, in order.
pub fn instances(document: &Document) -> impl Iterator<Item = (&NodeId, &Origin)> {
    document.nodes.iter().filter_map(|(id, node)| {
        let origin = node.template.as_deref().filter(|_| node.is_group())?;
        Some((id, origin))
    })
}

/// Whether what is in an instance is what its template had.
pub fn is_as_made(document: &Document, group: &NodeId, origin: &Origin) -> bool {
    hash(document, group) == origin.hash
}

/// The document as a template of one of its groups: the group marked, what feeds it, and an output of what it gives.
///
/// # Errors
/// There is no such group, or it stands in another.
pub fn new(document: &Document, group: &NodeId, origin: Origin) -> Result<Document, String> {
    let document = &groups::with_parameters_set(document, group);
    let node = document.node(group.as_str()).filter(|node| node.is_group());
    let node = node.ok_or_else(|| format!("{group} is no group"))?;
    if group.group().is_some() {
        return Err(format!(
            "{group} stands in another group: make a template of that, or copy it out"
        ));
    }
    let feeding = crate::document::graph::upstream(document, [group]);
    let kept = |id: &NodeId| feeding.contains(id) || id.is_inside(group);
    let mut made = document.clone();
    made.nodes.retain(|id, _| kept(id));
    made.links.retain(|to, _| kept(&to.node));
    made.frames.clear();
    made.display = None;
    made.thumbnail = None;
    // A name that says what it is, wherever the file goes.
    made.title = node.label.clone().unwrap_or_else(|| origin.name.clone());
    let others: Vec<NodeId> =
        made.nodes.keys().filter(|id| id.group().is_none()).cloned().collect();
    for id in others {
        if let Some(node) = made.nodes.get_mut(&id).filter(|node| node.template.is_some()) {
            Arc::make_mut(node).template = None;
        }
    }
    let marked = Origin { hash: hash(document, group), ..origin };
    if let Some(node) = made.nodes.get_mut(group) {
        Arc::make_mut(node).template = Some(marked.into());
    }
    let curves = |port: &&Port| port.ty == coif_nodes::define::Type::Curves;
    for port in node.interface.unwrap_or_default().outputs().iter().filter(curves) {
        let from = Socket::new(group.clone(), &port.name);
        // What the graph has for it says whether it is hair or guides, and how it is called.
        let shows = |(to, wires): (&Socket, &Vec<Socket>)| {
            let node = document.node(to.node.as_str())?;
            let is_one = node.kind == OUTPUT && to.node.group().is_none() && wires.contains(&from);
            is_one.then(|| (to.node.clone(), node.clone()))
        };
        let (out, shown) = document.links.iter().find_map(shows).unwrap_or_else(|| {
            (made.free_id("out"), Node { kind: OUTPUT.to_owned(), ..Node::default() })
        });
        let out = if made.nodes.contains_key(&out) { made.free_id("out") } else { out };
        made.nodes.insert(out.clone(), shown.into());
        made.links.insert(Socket::new(out, "curves"), vec![from]);
    }
    made.settle();
    Ok(made)
}

/// What becomes of a value or wire that a groom has on a port of an instance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It stays.
    Kept,
    /// Its port has another name now.
    Moved {
        /// The new name.
        to: String,
    },
    /// It stays, but other limits hold now.
    Clamped {
        /// The range, in words.
        to: String,
    },
    /// There is no such port any more, or it takes something else.
    Lost {
        /// Why.
        why: String,
    },
}

/// One override and its fate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverrideOutcome {
    /// The port, as it was called.
    pub port: String,
    /// What was set, or wired from where, in short.
    pub value: String,
    /// What becomes of it.
    pub fate: Fate,
}

impl fmt::Display for OverrideOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { port, value, fate } = self;
        match fate {
            Fate::Kept => write!(f, "{port} = {value}: kept"),
            Fate::Moved { to } => write!(f, "{port} = {value}: moved to {to}"),
            Fate::Clamped { to } => write!(f, "{port} = {value}: kept, clamped to {to}"),
            Fate::Lost { why } => write!(f, "{port} = {value}: lost, {why}"),
        }
    }
}

/// What an upgrade would do.
#[derive(Debug)]
pub struct Upgrade {
    /// The edit that does it.
    pub edit: Edit,
    /// Every override, in the order of their names.
    pub overrides: Vec<OverrideOutcome>,
    /// The instance was changed inside: that is lost.
    pub changed_inside: bool,
}

/// What putting a newer template in the place of an instance would do. Values and wires on its ports are kept where the
/// new one has their port, by its name or by a name that it had.
///
/// # Errors
/// It is no instance, it is locked, or the file is no template.
pub fn upgrade(document: &Document, id: &NodeId, template: &Document) -> Result<Upgrade, String> {
    let node = document.node(id.as_str()).filter(|node| node.is_group());
    let node = node.ok_or_else(|| format!("{id} is no group"))?;
    let origin = node.template.as_deref().ok_or_else(|| format!("{id} was made of no template"))?;
    if origin.locked {
        return Err(format!("{id} is locked to version {}: unlock it first", origin.version));
    }
    let group = group_of(template)?;
    let newer = &template.nodes[group];
    let (old_ports, ports) =
        (node.interface.unwrap_or_default(), newer.interface.unwrap_or_default());
    let find = |name: &str| successor(old_ports.inputs(), ports.inputs(), name);
    // Whether a port that was renamed keeps what it has itself.
    let is_taken = |port: &Port, name: &str| {
        let holds =
            node.inputs.contains_key(&port.name) || !document.wires(id, &port.name).is_empty();
        port.name != name && holds && find(&port.name).is_some_and(|it| it.name == port.name)
    };
    let mut after = document.clone();
    let inside: Vec<NodeId> = document.inside(id).map(|(id, _)| id.clone()).collect();
    after.nodes.retain(|node, _| !node.is_inside(id));
    after.links.retain(|to, _| !to.node.is_inside(id) && to.node != *id);
    after.bends.retain(|to, _| !to.node.is_inside(id));
    let renamed = |inner: &NodeId| -> Result<NodeId, String> {
        let rest = inner.as_str().strip_prefix(group.as_str()).unwrap_or_default();
        NodeId::new(&format!("{id}{rest}"))
            .map_err(|_| "groups would be nested too deeply".to_owned())
    };
    for (inner, node) in template.inside(group) {
        after.nodes.insert(renamed(inner)?, node.clone());
        if let Some(at) = template.layout.get(inner) {
            after.layout.insert(renamed(inner)?, *at);
        }
    }
    for (to, wires) in template.links.iter().filter(|(to, _)| to.node.is_inside(group)) {
        let socket = |socket: &Socket| {
            Ok::<_, String>(Socket { node: renamed(&socket.node)?, name: socket.name.clone() })
        };
        let wires = wires.iter().map(socket).collect::<Result<_, _>>()?;
        after.links.insert(socket(to)?, wires);
    }
    let mut told = vec![];
    let mut new = Node {
        interface: newer.interface,
        template: Some(
            Origin {
                hash: hash(template, group),
                ..newer.template.as_deref().cloned().unwrap_or_default()
            }
            .into(),
        ),
        inputs: BTreeMap::new(),
        ..node.clone()
    };
    for (name, setting) in &node.inputs {
        let value = match setting {
            Setting::Known(value) => crate::text::write_value(value),
            Setting::Raw(text) => text.to_string(),
        };
        let fate = match find(name) {
            None => Fate::Lost { why: "there is no such input any more".to_owned() },
            Some(port) if is_taken(port, name) => {
                Fate::Lost { why: format!("{} has a value of its own", port.name) }
            }
            Some(port) => settled(port, name, setting, &mut new),
        };
        told.push(OverrideOutcome {
            port: name.clone(),
            value: coif_nodes::define::short(&value),
            fate,
        });
    }
    for (to, wires) in document.links.iter().filter(|(to, _)| to.node == *id) {
        let from: Vec<String> = wires.iter().map(Socket::to_string).collect();
        let gives = wires.iter().map(|wire| crate::document::wiring::output_type(document, wire));
        let fate = match find(&to.name) {
            None => Fate::Lost { why: "there is no such input any more".to_owned() },
            Some(port) if is_taken(port, &to.name) => {
                Fate::Lost { why: format!("{} has a value of its own", port.name) }
            }
            Some(port) if !gives.clone().flatten().all(|ty| ty.fits(port.ty)) => {
                Fate::Lost { why: format!("it takes {} now", port.ty.name()) }
            }
            Some(port) => {
                after.links.insert(Socket::new(id.clone(), &port.name), wires.clone());
                moved(port, &to.name)
            }
        };
        told.push(OverrideOutcome { port: to.name.to_string(), value: from.join(", "), fate });
    }
    // What takes from the instance.
    for (to, wires) in &document.links {
        if to.node == *id || to.node.is_inside(id) || !wires.iter().any(|wire| wire.node == *id) {
            continue;
        }
        let mut kept = vec![];
        for wire in wires {
            if wire.node != *id {
                kept.push(wire.clone());
                continue;
            }
            let port = successor(old_ports.outputs(), ports.outputs(), &wire.name);
            let had = old_ports.outputs().iter().find(|port| port.name == *wire.name);
            let fits = |port: &&Port| had.is_none_or(|had| port.ty == had.ty);
            let fate = match port.filter(fits) {
                Some(port) => {
                    kept.push(Socket::new(id.clone(), &port.name));
                    moved(port, &wire.name)
                }
                None => Fate::Lost { why: "there is no such output any more".to_owned() },
            };
            told.push(OverrideOutcome {
                port: wire.name.to_string(),
                value: format!("wired to {to}"),
                fate,
            });
        }
        match kept.is_empty() {
            true => drop(after.links.remove(to)),
            false => drop(after.links.insert(to.clone(), kept)),
        }
    }
    after.nodes.insert(id.clone(), new.into());
    after.display =
        after.display.filter(|shown| !inside.contains(shown) || after.nodes.contains_key(shown));
    after.settle();
    let changed_inside = !is_as_made(document, id, origin);
    Ok(Upgrade { edit: between(document, &after), overrides: told, changed_inside })
}

/// Puts a value on its port, as far as it fits.
fn settled(port: &Port, name: &str, setting: &Setting, new: &mut Node) -> Fate {
    let Setting::Known(value) = setting else {
        new.inputs.insert(port.name.clone(), setting.clone());
        return moved(port, name);
    };
    match values::fit(port.ty, value.clone()) {
        Err(why) => Fate::Lost { why },
        Ok(value) => {
            let clamped = port.clamped(value.clone());
            let is_clamped = clamped.key() != value.key();
            new.inputs.insert(port.name.clone(), Setting::Known(value));
            match (is_clamped, port.hard) {
                (true, Some((lo, hi))) => {
                    Fate::Clamped { to: format!("{lo} to {hi}{}", port.unit.suffix()) }
                }
                _ => moved(port, name),
            }
        }
    }
}

fn moved(port: &Port, name: &str) -> Fate {
    match port.name == name {
        true => Fate::Kept,
        false => Fate::Moved { to: port.name.clone() },
    }
}

/// Locks an instance to its version for good, or lets it be upgraded again.
pub fn lock(document: &Document, id: &NodeId, locked: bool) -> Option<Edit> {
    let node = document.node(id.as_str())?;
    let origin = node.template.as_deref()?;
    let template = Some(Arc::new(Origin { locked, ..origin.clone() }));
    Some(Edit::ReplaceNode { id: id.clone(), node: Node { template, ..node.clone() }.into() })
}

/// Makes a group of all nodes of a groom but its heads, its outputs and what waits to be drawn into, for a template: what it takes is the
/// scalp, and what is drawn.
///
/// # Errors
/// As [`groups::make`].
pub fn grouped(document: &Document, name: &str) -> Result<(Document, NodeId), String> {
    let stays = |(id, node): &(&NodeId, &Arc<Node>)| {
        id.group().is_some()
            || [HEAD, OUTPUT].contains(&node.kind.as_str())
            || add::waits_for_a_pen(document, id)
    };
    let nodes = document.nodes.iter().filter(|it| !stays(it));
    groups::make(document, &nodes.map(|(id, _)| id.clone()).collect(), name)
}

#[cfg(test)]
mod tests;
