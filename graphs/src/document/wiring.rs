//! What hands do with wires, as edits: removing a node heals the wires through it, dropping one on a
//! wire inserts it, changing its kind keeps what fits.
//!
//! Pure functions of the document. What they give can be applied to it, as one step; what they refuse
//! they refuse with a reason for people.

use super::edit::Edit;
use super::graph::{self, wire_ends_problem};
use super::{Document, Node, NodeId, Setting, Socket, groups};
use crate::values;
use coif_nodes::declared;
use coif_nodes::define::{Arity, InputDef, NodeDef, OutputDef, Type, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What an output gives; none where there is no such output or nobody knows.
pub fn output_type(document: &Document, from: &Socket) -> Option<Type> {
    document.def(&from.node)?.output(&from.name).map(|(_, output)| output.ty)
}

/// The declaration of an input; none where there is no such input or nobody knows.
pub fn input_def(document: &Document, to: &Socket) -> Option<&'static InputDef> {
    document.def(&to.node)?.input(&to.name).map(|(_, input)| input)
}

/// Where an input is set: itself, or, where it reads a parameter of the graph or an input of its group, that.
pub fn set_at(document: &Document, input: &Socket) -> Socket {
    let mut at = input.clone();
    // In a circle it would go on for good.
    for _ in 0..=super::DEEPEST_GROUP {
        let [wire] = document.wires(&at.node, &at.name) else { break };
        let kind = document.node(wire.node.as_str()).map_or("", |node| node.kind.as_str());
        let group = wire.node.group().filter(|_| kind == declared::GROUP_INPUT);
        at = match group {
            Some(group) => Socket { node: group, name: wire.name.clone() },
            None if kind == declared::PARAMETERS => wire.clone(),
            None => break,
        };
    }
    at
}

/// Whether an output can feed an input, as far as their types say.
fn fits(document: &Document, from: &Socket, to: &Socket) -> bool {
    match (output_type(document, from), input_def(document, to)) {
        (Some(from), Some(to)) => from.fits(to.ty),
        // Of kinds that this version does not know, whoever wired them did.
        _ => document.nodes.contains_key(&from.node),
    }
}

/// The input of a kind that takes a wire of this type: one of the very type, else one that it fits.
pub fn taking(def: &'static NodeDef, from: Type) -> Option<&'static InputDef> {
    let exact = def.inputs.iter().find(|input| input.ty == from);
    exact.or_else(|| def.inputs.iter().find(|input| from.fits(input.ty)))
}

/// The output of a kind that can feed an input of this type: one of the very type, else one that fits.
pub fn giving(def: &'static NodeDef, to: Type) -> Option<&'static OutputDef> {
    let exact = def.outputs.iter().find(|output| output.ty == to);
    exact.or_else(|| def.outputs.iter().find(|output| output.ty.fits(to)))
}

/// The kinds that a wire dropped from an output can end at, each with the input that takes it.
pub fn kinds_taking(
    document: &Document,
    from: &Socket,
) -> Vec<(&'static NodeDef, &'static InputDef)> {
    let Some(ty) = output_type(document, from) else { return vec![] };
    coif_nodes::all().filter_map(|def| Some((def, taking(def, ty)?))).collect()
}

/// The kinds that a wire dropped from an input can begin at, each with the output that feeds it.
pub fn kinds_giving(
    document: &Document,
    to: &Socket,
) -> Vec<(&'static NodeDef, &'static OutputDef)> {
    let Some(input) = input_def(document, to) else { return vec![] };
    coif_nodes::all().filter_map(|def| Some((def, giving(def, input.ty)?))).collect()
}

/// A wire while one end of it is dragged: says quickly, for every socket, whether it can end there.
pub struct LooseWire<'a> {
    document: &'a Document,
    fixed: Socket,
    is_output: bool,
    /// Where the wire would run in a circle.
    circle: BTreeSet<NodeId>,
}

impl<'a> LooseWire<'a> {
    /// A wire that begins at an output and looks for an input.
    pub fn from_output(document: &'a Document, from: Socket) -> Self {
        let circle = graph::upstream(document, [&from.node]);
        Self { document, fixed: from, is_output: true, circle }
    }
    /// A wire that ends at an input and looks for an output.
    pub fn from_input(document: &'a Document, to: Socket) -> Self {
        let circle = graph::downstream(document, [&to.node]);
        Self { document, fixed: to, is_output: false, circle }
    }
    /// Why it cannot be wired to `other`, in words without a full stop; none when it can.
    pub fn reason(&self, other: &Socket) -> Option<String> {
        let (from, to) = if self.is_output { (&self.fixed, other) } else { (other, &self.fixed) };
        if from.node == to.node {
            return Some("a node cannot feed itself".to_owned());
        }
        if let Some(problem) = wire_ends_problem(self.document, from, to) {
            return Some(problem.text);
        }
        self.circle.contains(&other.node).then(|| {
            let name = |id| self.document.name_of(id);
            format!("wires would run in a circle: {} feeds {}", name(&to.node), name(&from.node))
        })
    }
}

/// Removes nodes; what their first outputs fed is fed by what fed them, where types fit. A removed
/// display goes to what fed it.
pub fn remove_healed(document: &Document, nodes: &BTreeSet<NodeId>) -> Edit {
    let nodes = &groups::with_inside(document, nodes);
    let mut edits = healed(document, nodes);
    if let Some(id) = document.display.as_ref().filter(|id| nodes.contains(*id)) {
        let shown = first_output(document, id).and_then(|from| {
            let ty = output_type(document, &from);
            source(document, nodes, &from, |from| {
                document.nodes.contains_key(&from.node)
                    && ty.zip(output_type(document, from)).is_none_or(|(ty, from)| ty == from)
            })
        });
        edits.extend(shown.map(|from| Edit::SetDisplay(Some(from.node))));
    }
    // From within outwards: what comes back begins with the group.
    let there = nodes.iter().rev().filter(|id| document.nodes.contains_key(*id));
    edits.extend(there.map(|id| Edit::RemoveNode { id: id.clone() }));
    Edit::Several(edits)
}

/// Takes all wires from nodes; what their first outputs fed is fed by what fed them, where types fit.
pub fn disconnect(document: &Document, nodes: &BTreeSet<NodeId>) -> Edit {
    let wired = document.links.keys().filter(|to| nodes.contains(&to.node));
    let mut edits: Vec<Edit> =
        wired.map(|to| Edit::SetWires { to: to.clone(), from: vec![] }).collect();
    edits.extend(healed(document, nodes));
    Edit::Several(edits)
}

/// The wires of the other nodes' inputs without `nodes`.
fn healed(document: &Document, nodes: &BTreeSet<NodeId>) -> Vec<Edit> {
    let mut edits = vec![];
    for (to, wires) in document.links.iter().filter(|(to, _)| !nodes.contains(&to.node)) {
        if !wires.iter().any(|wire| nodes.contains(&wire.node)) {
            continue;
        }
        let mut kept: Vec<Socket> = vec![];
        for wire in wires {
            if !nodes.contains(&wire.node) {
                kept.push(wire.clone());
                continue;
            }
            let through = source(document, nodes, wire, |from| fits(document, from, to));
            // The same hair twice in one list is nobody's wish.
            kept.extend(through.filter(|from| !kept.contains(from) && !wires.contains(from)));
        }
        edits.push(Edit::SetWires { to: to.clone(), from: kept });
    }
    edits
}

fn first_output(document: &Document, id: &NodeId) -> Option<Socket> {
    Some(Socket::new(id.clone(), document.def(id)?.outputs.first()?.name))
}

/// What feeds an output of one of `nodes` from outside of them, through first outputs and first
/// inputs that fit.
fn source(
    document: &Document,
    nodes: &BTreeSet<NodeId>,
    from: &Socket,
    fits: impl Fn(&Socket) -> bool,
) -> Option<Socket> {
    let mut at = from;
    // Each node once: a broken document may run in a circle.
    for _ in 0..=nodes.len() {
        if !nodes.contains(&at.node) {
            return Some(at.clone());
        }
        let def = document.def(&at.node);
        if def.is_some_and(|def| def.outputs.first().is_none_or(|first| *first.name != *at.name)) {
            return None;
        }
        let wired = graph::inputs_of(document, &at.node);
        let mut wired: Vec<(usize, &Socket)> = wired
            .filter_map(|(to, wires)| {
                let number = def.and_then(|def| def.input(&to.name)).map_or(0, |(i, _)| i);
                Some((number, wires.first()?))
            })
            .collect();
        // Stable: of kinds that are not known, by name.
        wired.sort_by_key(|(number, _)| *number);
        at = wired.into_iter().map(|(_, from)| from).find(|from| fits(from))?;
    }
    None
}

/// Puts a node between the ends of wire `at` of input `to`. A node that stands in a chain leaves it: what took from it takes from
/// what fed it. Its other wires stay.
///
/// # Errors
/// Why it does not fit there, without a full stop.
pub fn insert_on_wire(
    document: &Document,
    node: &NodeId,
    to: &Socket,
    at: usize,
) -> Result<Edit, String> {
    let name = document.name_of(node);
    let (from, into, out) = threaded(document, node, to, at)?;
    let fed = document.links.get(&into).map_or(&[][..], Vec::as_slice);
    let mut others = fed.iter().filter(|wire| **wire != from);
    let many = input_def(document, &into).is_some_and(|input| input.arity == Arity::Many);
    if many && others.next().is_some() {
        return Err(format!("other wires end at {into}"));
    }
    let mut edits = vec![];
    for (taker, wires) in document.links.iter().filter(|(_, wires)| wires.contains(&out)) {
        if taker == to {
            return Err(format!("{name} is wired to {to} already"));
        }
        let mut kept: Vec<Socket> = wires.iter().filter(|wire| **wire != out).cloned().collect();
        let heals = fed.first().filter(|fed| fits(document, fed, taker) && !kept.contains(fed));
        kept.splice(
            wires.iter().position(|wire| *wire == out).map_or(0..0, |at| at..at),
            heals.cloned(),
        );
        edits.push(Edit::SetWires { to: taker.clone(), from: kept });
    }
    edits.push(Edit::Disconnect { to: to.clone(), at });
    edits.push(Edit::SetWires { to: into, from: vec![from] });
    edits.push(Edit::Connect { from: out, to: to.clone(), at: Some(at) });
    sound(document, Edit::Several(edits))
}

/// Lets a node take from where wire `at` of input `to` comes from; the wire stays.
///
/// # Errors
/// Why it does not fit there, without a full stop.
pub fn branch_from_wire(
    document: &Document,
    node: &NodeId,
    to: &Socket,
    at: usize,
) -> Result<Edit, String> {
    let (from, into, _) = threaded(document, node, to, at)?;
    sound(document, Edit::SetWires { to: into, from: vec![from] })
}

/// Whether what a wire brings into an input is what the node changes and gives: what it can do without is only looked at.
pub fn passes_on(input: &InputDef) -> bool {
    input.arity != Arity::Optional
}

/// An edit after which wires run in no circle.
fn sound(document: &Document, edit: Edit) -> Result<Edit, String> {
    let mut after = document.clone();
    edit.apply(&mut after).map_err(|err| err.to_string())?;
    graph::order(&after).map_err(|err| err.to_string())?;
    Ok(edit)
}

/// Where wire `at` of input `to` comes from, and the input and output of a node between which it could run through it.
fn threaded(
    document: &Document,
    node: &NodeId,
    to: &Socket,
    at: usize,
) -> Result<(Socket, Socket, Socket), String> {
    let name = document.name_of(node);
    let wires = document.links.get(to).map_or(&[][..], Vec::as_slice);
    let from = wires.get(at).ok_or_else(|| format!("{to} has no wire {at}"))?;
    if *node == from.node || *node == to.node {
        return Err(format!("{name} is an end of this wire"));
    }
    let kind =
        &document.node(node.as_str()).ok_or_else(|| format!("there is no node {node}"))?.kind;
    let def = document.def(node).ok_or_else(|| format!("nobody knows what {kind:?} takes"))?;
    let given =
        output_type(document, from).ok_or_else(|| format!("nobody knows what {from} gives"))?;
    let taken = input_def(document, to).map_or(given, |input| input.ty);
    let input = taking(def, given).ok_or_else(|| format!("{name} takes no {}", given.name()))?;
    if !passes_on(input) {
        return Err(format!("{name} takes {} beside what it makes", given.name()));
    }
    let output = giving(def, taken).ok_or_else(|| format!("{name} gives no {}", taken.name()))?;
    let socket = |end| Socket::new(node.clone(), end);
    Ok((from.clone(), socket(input.name), socket(output.name)))
}

/// Lets everything that takes from an output take from a node instead that takes from it itself: the node stands between. None
/// where nothing takes from the output that could.
///
/// # Errors
/// Wires would run in a circle.
pub fn insert_behind(
    document: &Document,
    node: &NodeId,
    from: &Socket,
) -> Result<Option<Edit>, String> {
    let Some(def) = document.def(node) else { return Ok(None) };
    let passes = graph::inputs_of(document, node)
        .any(|(to, wires)| wires.contains(from) && input_def(document, to).is_none_or(passes_on));
    if !passes {
        return Ok(None);
    }
    let mut edits = vec![];
    for (to, wires) in document.links.iter().filter(|(_, wires)| wires.contains(from)) {
        let taken = input_def(document, to).map(|input| input.ty);
        let Some(gives) = taken.and_then(|ty| giving(def, ty)) else { continue };
        if to.node == *node {
            continue;
        }
        let gives = Socket::new(node.clone(), gives.name);
        let swap = |wire: &Socket| if wire == from { gives.clone() } else { wire.clone() };
        edits.push(Edit::SetWires { to: to.clone(), from: wires.iter().map(swap).collect() });
    }
    if edits.is_empty() {
        return Ok(None);
    }
    sound(document, Edit::Several(edits)).map(Some)
}

/// Which hair of a groom is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hair {
    /// All of it.
    All,
    /// What grows in no region of its own: brows and beards do not count.
    OfHead,
}

/// Whether a groom gives such hair: it is wired to one of its outputs.
pub fn has_hair(document: &Document, which: Hair) -> bool {
    let elsewhere = match which {
        Hair::All => BTreeSet::new(),
        Hair::OfHead => graph::downstream(document, regions(document)),
    };
    let gives = |(to, wires): (&Socket, &Vec<Socket>)| {
        let node = document.node(to.node.as_str());
        let is_output = node.is_some_and(|node| node.kind == OUTPUT);
        is_output && wires.iter().any(|wire| !elsewhere.contains(&wire.node))
    };
    document.links.iter().any(gives)
}

/// A groom without such hair: heads and masks stay, with what is left out of heads and all that is said of the groom; what gives curves,
/// hangs from them or writes them goes, with the regions and the parameters that only it read.
pub fn without_hair(document: &Document, which: Hair) -> Document {
    let of_curves = |id: &&NodeId| {
        let def = document.def(id);
        let gives = def.is_some_and(|def| def.outputs.iter().any(|out| out.ty == Type::Curves));
        gives || def.is_some_and(|def| def.id == OUTPUT)
    };
    // What grows in regions, what feeds that, and what takes it together with other hair.
    let mut stays = BTreeSet::new();
    if which == Hair::OfHead {
        stays = graph::downstream(document, regions(document));
        let joins = |id: &&NodeId| {
            let node = document.node(id.as_str());
            node.is_some_and(|node| [OUTPUT, MERGE].contains(&node.kind.as_str()))
        };
        let grown: Vec<&NodeId> = stays.iter().filter(|id| !joins(id)).collect();
        let feeds = graph::upstream(document, grown);
        stays.extend(feeds);
    }
    let hair: Vec<&NodeId> =
        document.nodes.keys().filter(|id| of_curves(id) && !stays.contains(*id)).collect();
    let mut gone = graph::downstream(document, hair.iter().copied());
    gone.extend(hair.into_iter().cloned());
    gone.retain(|id| !stays.contains(id));
    // What nothing else reads was that of the hair; but parameters that nothing read at all, and what is left out of a head.
    let is_its = |(id, node): &(&NodeId, &Arc<Node>)| {
        let is_read = document.links.values().flatten().any(|wire| wire.node == **id);
        let is_its = is_region(node) || node.kind == declared::PARAMETERS && is_read;
        is_its && !stays.contains(*id)
    };
    for (id, _) in document.nodes.iter().filter(is_its) {
        let reads = |wires: &Vec<Socket>| wires.iter().any(|wire| wire.node == *id);
        let mut links = document.links.iter();
        if links.all(|(to, wires)| gone.contains(&to.node) || !reads(wires)) {
            gone.insert(id.clone());
        }
    }
    let gone = groups::with_inside(document, &gone);
    let mut bare = document.clone();
    bare.nodes.retain(|id, _| !gone.contains(id));
    bare.links.retain(|to, wires| {
        wires.retain(|wire| !gone.contains(&wire.node));
        !gone.contains(&to.node) && !wires.is_empty()
    });
    bare.frames.clear();
    bare.display = bare.display.filter(|id| !gone.contains(id));
    bare.settle();
    bare
}

/// The kind of node that writes hair, and that of one that says where on a head it grows.
const OUTPUT: &str = "groom_output";
const REGION: &str = "region";
/// The kind that puts hair together.
const MERGE: &str = "merge";

/// Whether hair grows in what a node makes of a head, rather than in what it leaves of it.
fn is_region(node: &Node) -> bool {
    let outside = matches!(node.inputs.get("side"),
        Some(Setting::Known(Value::Text(side))) if &**side == "outside");
    node.kind == REGION && !outside
}

/// The regions in which hair grows.
fn regions(document: &Document) -> impl Iterator<Item = &NodeId> {
    document.nodes.iter().filter(|(_, node)| is_region(node)).map(|(id, _)| id)
}

/// Makes another kind of a node. Values keep their inputs where the new kind has one of that name
/// that takes them; wires keep theirs by name, else go to the first free input, or come from the first
/// output, of a type that fits. What fits nowhere goes.
///
/// # Errors
/// When there is no such node or no such kind.
pub fn change_kind(document: &Document, id: &NodeId, kind: &str) -> Result<Edit, String> {
    let old = document.node(id.as_str()).ok_or_else(|| format!("there is no node {id}"))?;
    let def =
        coif_nodes::by_id(kind).ok_or_else(|| format!("there are no nodes of kind {kind:?}"))?;
    let old_def = document.def(id);
    let mut node = Node {
        label: old.label.clone(),
        note: old.note.clone(),
        bypass: old.bypass,
        ..document.fresh_node(kind, id)
    };
    for (name, setting) in &old.inputs {
        let Some((_, input)) = def.input(name) else { continue };
        let value = match setting {
            Setting::Known(value) => values::fit(input.ty, value.clone()),
            Setting::Raw(text) => crate::text::proven_value(input.ty, text),
        };
        if let Ok(value) = value {
            node.inputs.insert(input.name.to_owned(), Setting::Known(value));
        }
    }
    let mut edits = vec![];
    let number = |to: &Socket| old_def.and_then(|def| def.input(&to.name)).map_or(0, |(i, _)| i);
    let mut wired: Vec<(&Socket, &Vec<Socket>)> = graph::inputs_of(document, id).collect();
    wired.sort_by_key(|(to, _)| number(to));
    edits.extend(wired.iter().map(|(to, _)| Edit::SetWires { to: (*to).clone(), from: vec![] }));
    edits.push(Edit::ReplaceNode { id: id.clone(), node: node.into() });
    for (to, wires) in placed(document, def, &wired) {
        edits.extend(with_bends(&Socket::new(id.clone(), to.name), wires));
    }
    for (to, wires) in document.links.iter().filter(|(to, _)| to.node != *id) {
        let taken = input_def(document, to).map(|input| input.ty);
        let renamed = |wire: &Socket| {
            if wire.node != *id {
                return Some(wire.clone());
            }
            let fits = |output: &&OutputDef| taken.is_none_or(|taken| output.ty.fits(taken));
            let same = def.output(&wire.name).map(|(_, output)| output).filter(fits);
            let other = same.or_else(|| def.outputs.iter().find(fits))?;
            Some(Socket::new(id.clone(), other.name))
        };
        let kept: Vec<Option<Socket>> = wires.iter().map(renamed).collect();
        if kept.iter().zip(wires).all(|(kept, old)| kept.as_ref() == Some(old)) {
            continue;
        }
        let kept = kept.into_iter().enumerate();
        let kept = kept.filter_map(|(at, kept)| Some((kept?, document.bends_of(to, at))));
        edits.extend(with_bends(to, kept.collect()));
    }
    Ok(Edit::Several(edits))
}

/// A wire of an input with its bends.
type Bent<'a> = (Socket, &'a [super::Point]);

/// Gives an input exactly these wires.
fn with_bends(to: &Socket, wires: Vec<Bent>) -> Vec<Edit> {
    let (from, bends): (Vec<Socket>, Vec<_>) = wires.into_iter().unzip();
    let bends = bends.into_iter().enumerate().filter(|(_, bends)| !bends.is_empty());
    let bends = bends.map(|(at, b)| Edit::SetBends { to: to.clone(), at, bends: b.to_vec() });
    [Edit::SetWires { to: to.clone(), from }].into_iter().chain(bends).collect()
}

/// The inputs of a kind that wires of another go to, with these wires.
fn placed<'a>(
    document: &'a Document,
    def: &'static NodeDef,
    wired: &[(&'a Socket, &'a Vec<Socket>)],
) -> Vec<(&'static InputDef, Vec<Bent<'a>>)> {
    let takes = |input: &InputDef, from: &Socket| {
        output_type(document, from).is_none_or(|ty| ty.fits(input.ty))
    };
    let mut found: BTreeMap<usize, Vec<Bent>> = BTreeMap::new();
    let mut homeless = vec![];
    for (to, wires) in wired {
        let bent = |(at, from): (usize, &Socket)| (from.clone(), document.bends_of(to, at));
        let wires: Vec<Bent> = wires.iter().enumerate().map(bent).collect();
        match def.input(&to.name) {
            Some((i, input)) if wires.iter().all(|(from, _)| takes(input, from)) => {
                found.insert(i, wires);
            }
            _ => homeless.push(wires),
        }
    }
    for wires in homeless {
        let free = def.inputs.iter().enumerate().find(|(i, input)| {
            !found.contains_key(i) && wires.iter().all(|(from, _)| takes(input, from))
        });
        if let Some((i, _)) = free {
            found.insert(i, wires);
        }
    }
    let one = |(i, mut wires): (usize, Vec<Bent<'a>>)| {
        let input = &def.inputs[i];
        if input.arity != Arity::Many {
            wires.truncate(1);
        }
        (input, wires)
    };
    found.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests;
