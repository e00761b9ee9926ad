//! What can be asked of a document's graph: order, circles, what hangs from what, and what is
//! wrong.
//!
//! Nothing here recurses: a chain of a hundred thousand nodes is as good as one of three.

use super::{Document, Node, NodeId, Setting, Socket, groups};
use crate::values;
use crate::values::suggest::nearest;
use coif_nodes::data::field::Field;
use coif_nodes::declared;
use coif_nodes::define::{Arity, InputDef, NodeDef, OutputDef, Type, Unit, Value, short};
use coif_nodes::formats::usd::groom::identifier;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

/// Whether a problem keeps a groom from being evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// What needs the node has no result.
    Error,
    /// There is a result.
    Warning,
}

/// What kind of thing is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// No node of this version is of that kind.
    UnknownKind,
    /// The kind has no such input.
    UnknownInput,
    /// The kind has no such output.
    UnknownOutput,
    /// A wire begins or ends at a node that is not there.
    UnknownNode,
    /// A wire carries what the input does not take.
    WrongType,
    /// Several wires where one is taken.
    TooManyWires,
    /// Nothing is wired to an input that needs a wire.
    Missing,
    /// Wires run in a circle.
    Cycle,
    /// A value that cannot be used.
    BadValue,
    /// A value that will be clamped.
    OutOfRange,
    /// An output has the name of another.
    SameName,
    /// A group, or its border, is not whole, or a wire crosses it.
    Border,
}

/// Something wrong with a document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Whether it keeps the groom from being evaluated.
    pub severity: Severity,
    /// Whether a target needs the node. A problem elsewhere harms nobody yet.
    pub needed: bool,
    /// What kind of thing it is.
    pub fault: Fault,
    /// Where.
    pub node: NodeId,
    /// Input, or output, if it is about one.
    pub socket: Option<String>,
    /// What is wrong: the value or wire there is and what was expected. No full stop.
    pub text: String,
    /// What to do about it. No full stop.
    pub remedy: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.node)?;
        if let Some(socket) = &self.socket {
            write!(f, ".{socket}")?;
        }
        write!(f, ": {}; {}", self.text, self.remedy)
    }
}

/// Wires that run in a circle: each node feeds the next, the last the first.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("wires run in a circle: {}", circle(.0))]
pub struct Cycle(pub Vec<NodeId>);

fn circle(nodes: &[NodeId]) -> String {
    let names: Vec<&str> = nodes.iter().chain(nodes.first()).map(NodeId::as_str).collect();
    names.join(" -> ")
}

/// The nodes that feed a node directly, in the order of its inputs' names and wires; of a group also
/// the node that its outputs come from, and of what comes into a group those that feed the group. Nodes
/// that are not there are left out.
pub fn feeders<'a>(document: &'a Document, id: &NodeId) -> impl Iterator<Item = &'a NodeId> {
    all_feeders(document, id).filter(|node| document.nodes.contains_key(*node))
}

/// The same, with nodes that are not there.
pub(crate) fn all_feeders<'a>(
    document: &'a Document,
    id: &NodeId,
) -> impl Iterator<Item = &'a NodeId> + use<'a> {
    let (within, outside) = match document.node(id.as_str()).map(|node| node.kind.as_str()) {
        Some(declared::GROUP) => (document.outputs_of(id), None),
        Some(declared::GROUP_INPUT) => (None, id.group()),
        _ => (None, None),
    };
    let outside = outside.into_iter().flat_map(|group| inputs_of(document, &group));
    inputs_of(document, id)
        .chain(outside)
        .flat_map(|(_, from)| from)
        .map(|from| &from.node)
        .chain(within)
}

/// The wired inputs of a node with their wires.
pub fn inputs_of<'a>(
    document: &'a Document,
    id: &NodeId,
) -> impl Iterator<Item = (&'a Socket, &'a Vec<Socket>)> + use<'a> {
    let id = id.clone();
    document.links.range(Socket::new(id.clone(), "")..).take_while(move |(to, _)| to.node == id)
}

/// For each node those it feeds, each once.
fn fed(document: &Document) -> BTreeMap<&NodeId, BTreeSet<&NodeId>> {
    let mut fed: BTreeMap<&NodeId, BTreeSet<&NodeId>> = BTreeMap::new();
    for to in document.nodes.keys() {
        for from in feeders(document, to) {
            fed.entry(from).or_default().insert(to);
        }
    }
    fed
}

/// Every node, each behind all that feed it; where that leaves a choice, by id.
pub fn order(document: &Document) -> Result<Vec<NodeId>, Cycle> {
    let (order, rest) = sorted(document, &BTreeSet::new());
    match find_cycle(document, &rest) {
        Some(cycle) => Err(cycle),
        None => Ok(order),
    }
}

/// Kahn's order of what can be ordered without `left_out`, and the nodes that lie in or behind a
/// circle.
fn sorted(document: &Document, left_out: &BTreeSet<NodeId>) -> (Vec<NodeId>, BTreeSet<NodeId>) {
    let fed = fed(document);
    let mut waits: BTreeMap<&NodeId, usize> =
        document.nodes.keys().filter(|id| !left_out.contains(*id)).map(|id| (id, 0)).collect();
    for (_, to) in fed.iter().filter(|(from, _)| !left_out.contains(**from)) {
        for id in to {
            if let Some(count) = waits.get_mut(id) {
                *count += 1;
            }
        }
    }
    let mut ready: BTreeSet<&NodeId> =
        waits.iter().filter(|(_, count)| **count == 0).map(|(id, _)| *id).collect();
    let mut order = vec![];
    while let Some(id) = ready.pop_first() {
        waits.remove(id);
        order.push(id.clone());
        for next in fed.get(id).into_iter().flatten() {
            if let Some(count) = waits.get_mut(next) {
                *count -= 1;
                if *count == 0 {
                    ready.insert(next);
                }
            }
        }
    }
    (order, waits.into_keys().cloned().collect())
}

/// A circle among nodes each of which has a feeder among them.
fn find_cycle(document: &Document, among: &BTreeSet<NodeId>) -> Option<Cycle> {
    let mut at = among.first()?;
    let mut path: Vec<&NodeId> = vec![];
    let mut seen: BTreeMap<&NodeId, usize> = BTreeMap::new();
    loop {
        if let Some(start) = seen.get(at) {
            let mut nodes: Vec<NodeId> = path[*start..].iter().map(|id| (*id).clone()).collect();
            nodes.reverse();
            // The same circle always reads the same.
            let first = nodes.iter().enumerate().min_by_key(|(_, id)| (*id).clone())?.0;
            nodes.rotate_left(first);
            return Some(Cycle(nodes));
        }
        seen.insert(at, path.len());
        path.push(at);
        at = feeders(document, at).filter_map(|id| among.get(id)).next()?;
    }
}

/// So many circles are told of one document, and inputs that nothing is wired to with what could be: who has more has seen enough.
const MOST_TOLD: usize = 100;

/// Circles of the document that share no node, the first by id first, at most a hundred; none when it can be ordered.
pub fn cycles(document: &Document) -> Vec<Cycle> {
    let (mut cycles, mut left_out) = (vec![], BTreeSet::new());
    loop {
        if cycles.len() == MOST_TOLD {
            return cycles;
        }
        let (_, rest) = sorted(document, &left_out);
        let Some(cycle) = find_cycle(document, &rest) else { return cycles };
        left_out.extend(cycle.0.iter().cloned());
        cycles.push(cycle);
    }
}

/// The nodes and everything that feeds them.
pub fn upstream<'a>(
    document: &Document,
    of: impl IntoIterator<Item = &'a NodeId>,
) -> BTreeSet<NodeId> {
    reached(document, of, |id| feeders(document, id).cloned().collect())
}

/// The nodes and everything that hangs from them.
pub fn downstream<'a>(
    document: &Document,
    of: impl IntoIterator<Item = &'a NodeId>,
) -> BTreeSet<NodeId> {
    let fed = fed(document);
    below(document, &fed, of)
}

/// The same, where it is known what each node feeds.
fn below<'a>(
    document: &Document,
    fed: &BTreeMap<&NodeId, BTreeSet<&NodeId>>,
    of: impl IntoIterator<Item = &'a NodeId>,
) -> BTreeSet<NodeId> {
    let next = |id: &NodeId| fed.get(id).into_iter().flatten().map(|id| (*id).clone()).collect();
    reached(document, of, next)
}

fn reached<'a>(
    document: &Document,
    of: impl IntoIterator<Item = &'a NodeId>,
    next: impl Fn(&NodeId) -> Vec<NodeId>,
) -> BTreeSet<NodeId> {
    let mut found = BTreeSet::new();
    let mut open: Vec<NodeId> =
        of.into_iter().filter(|id| document.nodes.contains_key(*id)).cloned().collect();
    while let Some(id) = open.pop() {
        if found.insert(id.clone()) {
            open.extend(next(&id));
        }
    }
    found
}

/// The kind of node that hair grows on.
pub const HEAD: &str = "head";

/// The head that what is added stands on: the one that the displayed hair stands on, else the first.
pub fn head_at_hand(document: &Document) -> Option<NodeId> {
    let is_head = |id: &NodeId| document.node(id.as_str()).is_some_and(|node| node.kind == HEAD);
    let under = upstream(document, &document.display);
    under
        .into_iter()
        .find(is_head)
        .or_else(|| document.nodes.keys().find(|id| id.group().is_none() && is_head(id)).cloned())
}

/// A seed that no node of a document has, so that two nodes of a kind differ.
pub fn free_seed(document: &Document) -> i64 {
    let seeds: BTreeSet<i64> = document.nodes.values().filter_map(|node| node.seed()).collect();
    (1..).find(|seed| !seeds.contains(seed)).unwrap_or(1)
}

/// What a document is evaluated for: the displayed node and the nodes of the output stage; when
/// there is none of these, every node that feeds no other.
pub fn targets(document: &Document) -> BTreeSet<NodeId> {
    let outputs: Vec<&str> = coif_nodes::STAGES
        .iter()
        .filter(|(stage, _)| *stage == "output")
        .flat_map(|(_, nodes)| nodes.iter().map(|node| node.id))
        .collect();
    let nodes = document.nodes.iter();
    let mut targets: BTreeSet<NodeId> = nodes
        .filter(|(_, node)| outputs.contains(&node.kind.as_str()))
        .map(|(id, _)| id.clone())
        .collect();
    targets.extend(document.display.iter().filter(|id| document.nodes.contains_key(*id)).cloned());
    if targets.is_empty() {
        let fed = fed(document);
        targets = document.nodes.keys().filter(|id| !fed.contains_key(id)).cloned().collect();
    }
    targets
}

/// The nodes that lead to no target, but for those that feed others of them or lie in one: whatever they make, nothing comes of it.
pub fn leading_nowhere(document: &Document) -> Vec<NodeId> {
    let needed = upstream(document, &targets(document));
    let unneeded = |id: &NodeId| !needed.contains(id);
    let feeding: BTreeSet<&NodeId> = document
        .nodes
        .keys()
        .filter(|id| unneeded(id))
        .flat_map(|id| feeders(document, id))
        .collect();
    let leads_nowhere = |(id, node): &(&NodeId, &Arc<Node>)| {
        let is_border = [declared::GROUP_INPUT, declared::GROUP_OUTPUT];
        unneeded(id)
            && !feeding.contains(id)
            && !is_border.contains(&node.kind.as_str())
            && id.group().is_none_or(|group| !unneeded(&group))
    };
    document.nodes.iter().filter(leads_nowhere).map(|(id, _)| id.clone()).collect()
}

/// Everything wrong with a document for its [`targets`]; errors first.
pub fn check(document: &Document) -> Vec<Problem> {
    check_for(document, &targets(document))
}

/// Everything wrong with a document that is evaluated for `targets`; errors first, then by node.
///
/// An input that nothing is wired to is an error only where a target needs it; elsewhere it is work
/// in progress, and a warning.
pub fn check_for(document: &Document, targets: &BTreeSet<NodeId>) -> Vec<Problem> {
    let needed = upstream(document, targets);
    let mut problems = vec![];
    for Cycle(nodes) in cycles(document) {
        let text = Cycle(nodes.clone()).to_string();
        problems.push(problem(Fault::Cycle, &nodes[0], None, text, "remove one of these wires"));
    }
    let mut advice = Advice { document, fed: None, given: 0 };
    for (id, node) in &document.nodes {
        groups::check(document, id, node, &mut problems);
        match document.def(id) {
            Some(def) => check_node(&mut advice, id, node, def, &mut problems),
            None if declared::KINDS.contains(&node.kind.as_str()) => {}
            None => problems.push(unknown_kind(id, &node.kind)),
        }
    }
    for (to, from) in &document.links {
        check_wires(document, to, from, &mut problems);
    }
    same_names(document, &mut problems);
    for problem in &mut problems {
        problem.needed = needed.contains(&problem.node);
        if problem.fault == Fault::Missing && !problem.needed {
            problem.severity = Severity::Warning;
        }
    }
    // Stable: within a node, in the order of its declaration.
    problems.sort_by(|a, b| (a.severity, &a.node).cmp(&(b.severity, &b.node)));
    problems
}

/// Why a wire cannot be drawn; none when it can.
pub fn wire_problem(document: &Document, from: &Socket, to: &Socket) -> Option<Problem> {
    let ends = wire_ends_problem(document, from, to);
    if ends.is_some() || !downstream(document, [&to.node]).contains(&from.node) {
        return ends;
    }
    let text = if from.node == to.node {
        format!("a wire from {from} would feed the node with itself")
    } else {
        format!("a wire from {from} would run in a circle: {} feeds {}", to.node, from.node)
    };
    let remedy = format!("wire a node that does not hang from {}", to.node);
    Some(problem(Fault::Cycle, &to.node, Some(&to.name), text, &remedy))
}

/// The same, but for circles: quick, whatever the size of the document.
pub(super) fn wire_ends_problem(
    document: &Document,
    from: &Socket,
    to: &Socket,
) -> Option<Problem> {
    let mut problems = vec![];
    let wires = [from.clone()];
    check_wires(document, to, &wires, &mut problems);
    for end in [&to.node, &from.node] {
        if document.node(end.as_str()).is_none() && problems.is_empty() {
            problems.push(no_node(to, end));
        }
    }
    problems.into_iter().find(|problem| problem.severity == Severity::Error)
}

/// "; did you mean ...?" for the input of `def` that is nearest to `name`, else the inputs there
/// are.
pub(super) fn near_input(def: &NodeDef, name: &str) -> String {
    let known = || def.inputs.iter().map(|input| input.name);
    match nearest(name, known()) {
        Some(meant) => format!("; did you mean {meant}?"),
        None => format!("; it has {}", list(known())),
    }
}

pub(super) fn problem(
    fault: Fault,
    node: &NodeId,
    socket: Option<&str>,
    text: String,
    remedy: &str,
) -> Problem {
    let harmless = matches!(fault, Fault::OutOfRange | Fault::SameName);
    let severity = if harmless { Severity::Warning } else { Severity::Error };
    let (node, socket) = (node.clone(), socket.map(str::to_owned));
    Problem { severity, needed: true, fault, node, socket, text, remedy: remedy.to_owned() }
}

/// Outputs whose names come to one in files: those would number them, and nobody knows which is which. Guides have places of
/// their own there, and are meant to have the name of their hair.
fn same_names(document: &Document, problems: &mut Vec<Problem>) {
    let mut known: BTreeMap<(String, bool), &NodeId> = BTreeMap::new();
    for (id, node) in document.nodes.iter().filter(|(_, node)| node.kind == "groom_output") {
        let name = match node.inputs.get("name") {
            Some(Setting::Known(Value::Text(name))) if !name.is_empty() => name,
            // One without a name goes by its node.
            _ => id.as_str(),
        };
        let guides = matches!(node.inputs.get("guides"), Some(Setting::Known(Value::Bool(true))));
        let place = (identifier(name), guides);
        match known.get(&place) {
            Some(first) => {
                let text = format!("its name {} is that of {first}, too, in files", short(name));
                let remedy = "give each output a name of its own: files tell them apart by it";
                problems.push(problem(Fault::SameName, id, Some("name"), text, remedy));
            }
            None => {
                known.insert(place, id);
            }
        }
    }
}

fn unknown_kind(id: &NodeId, kind: &str) -> Problem {
    let remedy = match nearest(kind, coif_nodes::all().map(|def| def.id)) {
        Some(meant) => format!("did you mean {meant}?"),
        None => "open it with the version of coif that made it, or remove the node".to_owned(),
    };
    let text = format!("this version has no node of kind {kind:?}");
    problem(Fault::UnknownKind, id, None, text, &remedy)
}

fn no_node(to: &Socket, missing: &NodeId) -> Problem {
    let text = format!("there is no node {missing} to wire");
    problem(Fault::UnknownNode, &to.node, Some(&to.name), text, "remove the wire or add the node")
}

fn check_node(
    advice: &mut Advice,
    id: &NodeId,
    node: &Node,
    def: &'static NodeDef,
    problems: &mut Vec<Problem>,
) {
    for input in def.inputs {
        let wired = advice.document.links.contains_key(&Socket::new(id.clone(), input.name));
        let set = node.inputs.get(input.name).filter(|_| node.kind != declared::GROUP_OUTPUT);
        let is_empty = input.ty == Type::File
            && matches!(set, Some(Setting::Known(Value::Text(path))) if path.is_empty());
        if let Some(setting) = set.filter(|_| !is_empty) {
            check_value(id, input, setting, problems);
        } else if !wired && input.arity == Arity::One && !input.has_default() {
            if input.ty == Type::File {
                let text = "no file is named, and one is needed".to_owned();
                let remedy = format!("set {} to the path of a file", input.name);
                problems.push(problem(Fault::Missing, id, Some(input.name), text, &remedy));
                continue;
            }
            let text = format!("nothing is wired to it, {} is needed", input.ty.name());
            let remedy = match advice.fitting(id, input.ty) {
                None if advice.given == MOST_TOLD => format!("wire {} to it", input.ty.name()),
                Some(from) => format!("wire {} to it, such as {from}", input.ty.name()),
                None => format!("add a node that gives {} and wire it", input.ty.name()),
            };
            problems.push(problem(Fault::Missing, id, Some(input.name), text, &remedy));
        }
    }
    for (name, setting) in &node.inputs {
        if def.inputs.iter().any(|input| input.name == name) {
            if node.kind == declared::GROUP_OUTPUT {
                let text = format!("it is set to {}, and takes wires alone", shown(setting));
                problems.push(problem(Fault::BadValue, id, Some(name), text, "remove the value"));
            }
            continue;
        }
        let value = shown(setting);
        let text = format!("{} has no input of this name (it is set to {value})", def.id);
        let remedy = match nearest(name, def.inputs.iter().map(|input| input.name)) {
            Some(meant) => format!("did you mean {meant}?"),
            None => "remove it, or open the groom with the version of coif that made it".to_owned(),
        };
        problems.push(problem(Fault::UnknownInput, id, Some(name), text, &remedy));
    }
}

/// What could be wired, for the first inputs that nothing is wired to.
struct Advice<'a> {
    document: &'a Document,
    /// For each node those it feeds, once it was asked for.
    fed: Option<BTreeMap<&'a NodeId, BTreeSet<&'a NodeId>>>,
    given: usize,
}

impl Advice<'_> {
    /// An output that could be wired: the first by id that gives `ty` and does not hang from `id`.
    fn fitting(&mut self, id: &NodeId, ty: Type) -> Option<Socket> {
        if self.given == MOST_TOLD {
            return None;
        }
        self.given += 1;
        let document = self.document;
        let below = below(document, self.fed.get_or_insert_with(|| fed(document)), [id]);
        let group = id.group();
        let mut others =
            document.nodes.keys().filter(|other| !below.contains(*other) && other.group() == group);
        others.find_map(|other| {
            let output = document.def(other)?.outputs.iter().find(|output| output.ty.fits(ty))?;
            Some(Socket::new(other.clone(), output.name))
        })
    }
}

fn check_value(
    id: &NodeId,
    input: &'static InputDef,
    setting: &Setting,
    problems: &mut Vec<Problem>,
) {
    let fit = match setting {
        Setting::Known(value) => values::fit(input.ty, value.clone()),
        Setting::Raw(text) => crate::text::proven_value(input.ty, text),
    };
    let value = match fit {
        Ok(value) => value,
        Err(reason) => {
            let text = format!("{} cannot be used: {reason}", shown(setting));
            let remedy = match input.ty {
                Type::Curves | Type::Scalp => "remove the value".to_owned(),
                _ => format!("set it to {}", example(input)),
            };
            problems.push(problem(Fault::BadValue, id, Some(input.name), text, &remedy));
            return;
        }
    };
    let Some((lo, hi)) = input.hard else { return };
    // Ranges are written in decimals, values rounded to f32.
    let (lo32, hi32) = (lo as f32, hi as f32);
    let beyond = |x: f32| x < lo32 || x > hi32;
    let found = match &value {
        Value::Float(x) => beyond(*x).then_some(f64::from(*x)),
        Value::Int(x) => (((*x as f64) < lo) || ((*x as f64) > hi)).then_some(*x as f64),
        Value::Field(field) => match &**field {
            Field::Ramp(ramp) => stop_beyond(ramp, beyond),
            _ => None,
        },
        Value::Ramp(ramp) => stop_beyond(ramp, beyond),
        _ => None,
    };
    if let Some(x) = found {
        let unit = input.unit.suffix();
        let x = if input.ty == Type::Int { x.to_string() } else { (x as f32).to_string() };
        let text = format!("{x}{unit} is outside {lo} to {hi}{unit} and will be clamped");
        let remedy = format!("set it to {lo} to {hi}{unit}");
        problems.push(problem(Fault::OutOfRange, id, Some(input.name), text, &remedy));
    }
}

fn stop_beyond(ramp: &coif_nodes::data::ramp::Ramp, beyond: impl Fn(f32) -> bool) -> Option<f64> {
    ramp.stops().iter().map(|(_, y)| *y).find(|y| beyond(*y)).map(f64::from)
}

/// A setting in a message: cut where it is long.
fn shown(setting: &Setting) -> String {
    let text = match setting {
        Setting::Known(value) => crate::text::write_value(value),
        Setting::Raw(text) => text.to_string(),
    };
    short(&text)
}

/// What the input could be set to, in words.
fn example(input: &InputDef) -> String {
    if let Type::Choice(words) = input.ty {
        return format!("one of {}", list(words.iter().map(|(word, _)| *word)));
    }
    let range = match (input.hard, input.unit) {
        (None, _) => String::new(),
        (Some((lo, hi)), Unit::None | Unit::Ratio | Unit::Count) => format!(" from {lo} to {hi}"),
        (Some((lo, hi)), unit) => format!(" from {lo} to {hi}{}", unit.suffix()),
    };
    let like = match input.default() {
        Some(default) => format!(", such as {}", short(&crate::text::write_value(&default))),
        None => String::new(),
    };
    format!("a {}{range}{like}", input.ty.name())
}

fn list<'a>(words: impl Iterator<Item = &'a str>) -> String {
    words.collect::<Vec<_>>().join(", ")
}

fn check_wires(document: &Document, to: &Socket, from: &[Socket], problems: &mut Vec<Problem>) {
    if !document.nodes.contains_key(&to.node) {
        problems.push(no_node(to, &to.node));
        return;
    }
    let def = document.def(&to.node);
    let input = def.and_then(|def| def.inputs.iter().find(|input| input.name == &*to.name));
    if let (Some(def), None) = (def, input) {
        let text = format!("{} has no input of this name, but a wire ends there", def.id);
        let remedy = match nearest(&to.name, def.inputs.iter().map(|input| input.name)) {
            Some(meant) => format!("did you mean {meant}?"),
            None => format!("remove the wire; it has {}", list(def.inputs.iter().map(|i| i.name))),
        };
        problems.push(problem(Fault::UnknownInput, &to.node, Some(&to.name), text, &remedy));
    }
    if input.is_some_and(|input| input.arity != Arity::Many) && from.len() > 1 {
        let text = format!("{} wires end there, it takes one", from.len());
        let remedy = "remove the others, or merge them before";
        problems.push(problem(Fault::TooManyWires, &to.node, Some(&to.name), text, remedy));
    }
    for from in from {
        check_wire(document, to, input, from, problems);
    }
}

fn check_wire(
    document: &Document,
    to: &Socket,
    input: Option<&'static InputDef>,
    from: &Socket,
    problems: &mut Vec<Problem>,
) {
    if !document.nodes.contains_key(&from.node) {
        problems.push(no_node(to, &from.node));
        return;
    }
    if from.node.group() != to.node.group() {
        let text = format!("a wire from {from} crosses the border of a group");
        let remedy = "give the group an input or an output, and wire these";
        problems.push(problem(Fault::Border, &to.node, Some(&to.name), text, remedy));
        return;
    }
    // Unknown kinds have been told of; nobody knows their outputs.
    let Some(def) = document.def(&from.node) else { return };
    let Some((_, output)) = def.output(&from.name) else {
        let text = format!("{from} is no output: {} gives {}", def.id, names(def.outputs));
        let remedy = match nearest(&from.name, def.outputs.iter().map(|output| output.name)) {
            Some(meant) => format!("did you mean {}.{meant}?", from.node),
            None => "wire one of these".to_owned(),
        };
        problems.push(problem(Fault::UnknownOutput, &to.node, Some(&to.name), text, &remedy));
        return;
    };
    let Some(input) = input else { return };
    if !output.ty.fits(input.ty) {
        let text = format!("{from} gives {}, {} is taken", output.ty.name(), input.ty.name());
        let other = def.outputs.iter().find(|output| output.ty.fits(input.ty));
        let remedy = match other {
            Some(other) => format!("wire {}.{}", from.node, other.name),
            None if matches!(input.ty, Type::Curves | Type::Scalp) => {
                format!("wire an output that gives {}", input.ty.name())
            }
            None => "remove the wire and set a value".to_owned(),
        };
        problems.push(problem(Fault::WrongType, &to.node, Some(&to.name), text, &remedy));
    }
}

fn names(outputs: &[OutputDef]) -> String {
    list(outputs.iter().map(|output| output.name))
}

#[cfg(test)]
mod tests {
    use super::super::edit::Edit;
    use super::*;
    use expect_test::{Expect, expect};

    fn id(text: &str) -> NodeId {
        NodeId::new(text).unwrap()
    }
    /// Nodes of kind resample, wired: "a>b" feeds b with a.
    fn chain(wires: &str) -> Document {
        let mut document = Document::default();
        let node = Arc::new(Node { kind: "resample".into(), ..Node::default() });
        for wire in wires.split_whitespace() {
            let ends: Vec<&str> = wire.split('>').collect();
            for end in &ends {
                document.nodes.insert(id(end), node.clone());
            }
            if let [from, to] = ends[..] {
                let to = document.links.entry(Socket::new(id(to), "curves")).or_default();
                to.push(Socket::new(id(from), "curves"));
            }
        }
        document
    }
    fn said(ids: impl IntoIterator<Item = NodeId>) -> String {
        ids.into_iter().map(|id| id.to_string()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn order_puts_every_node_behind_its_feeders_and_is_by_id_where_it_may() {
        let check = |wires: &str, want: &str| {
            let got = order(&chain(wires)).map_or_else(|cycle| cycle.to_string(), said);
            assert_eq!(got, want, "{wires}");
        };
        check("", "");
        check("c b a", "a b c");
        check("z>a a>m b", "b z a m");
        check("a>b a>b b>c a>c", "a b c");
        check("a>a", "wires run in a circle: a -> a");
        check("x>c c>b b>a a>c a>y", "wires run in a circle: a -> c -> b -> a");
    }

    #[test]
    fn each_circle_is_told_of() {
        let cycles: Vec<String> =
            cycles(&chain("a>b b>a c>d d>e e>c a>c x")).iter().map(Cycle::to_string).collect();
        assert_eq!(
            cycles,
            ["wires run in a circle: a -> b -> a", "wires run in a circle: c -> d -> e -> c"]
        );
    }

    #[test]
    fn upstream_and_downstream_follow_wires() {
        let document = chain("a>b b>c b>d x>d y");
        assert_eq!(said(upstream(&document, [&id("c")])), "a b c");
        assert_eq!(said(upstream(&document, [&id("d"), &id("y")])), "a b d x y");
        assert_eq!(said(downstream(&document, [&id("b")])), "b c d");
        assert_eq!(said(targets(&document)), "c d y");
    }

    #[test]
    fn a_long_chain_overflows_nothing() {
        let names: Vec<String> = (0..20_000).map(|i| format!("n{i:05}")).collect();
        let wires: Vec<String> = names.windows(2).map(|w| format!("{}>{}", w[0], w[1])).collect();
        let mut document = chain(&wires.join(" "));
        assert_eq!(order(&document).unwrap().len(), names.len());
        assert_eq!(upstream(&document, [&id("n19999")]).len(), names.len());
        document
            .links
            .insert(Socket::new(id("n00000"), "curves"), vec![Socket::new(id("n19999"), "curves")]);
        assert_eq!(order(&document).unwrap_err().0.len(), names.len());
    }

    #[track_caller]
    fn check_text(text: &str, want: Expect) {
        let document = crate::file::read(text).unwrap().document;
        let problems = check(&document);
        let lines = problems.iter().map(|problem| {
            let mark = if problem.needed { "" } else { " (not needed)" };
            format!("{:?}{mark}: {problem}\n", problem.severity)
        });
        want.assert_eq(&lines.collect::<String>());
    }

    #[test]
    fn every_problem_says_where_what_was_expected_and_what_to_do() {
        check_text(
            r#"(format: 1, display: "b", nodes: {
                "a": (kind: "resmple"),
                "b": (kind: "resample", inputs: {"count": 1, "cuont": 3, "spacing": "wide", "by": "cuont"}),
                "c": (kind: "resample"),
                "d": (kind: "of_tomorrow", inputs: {"x": Y(1)}),
                "e": (kind: "resample", inputs: {"spacing": 1e9, "curves": 3, "count": 2.5, "colour": 1}),
            }, links: {
                "b.curves": ["c.curves", "d.out"],
                "b.count": "c.curves",
                "b.curve": "a.x",
                "e.curves": "c.crves",
                "nix.in": "c.curves",
            })"#,
            expect![[r#"
                Error: a: this version has no node of kind "resmple"; did you mean resample?
                Error: b.by: "cuont" cannot be used: "cuont" is none of count, spacing; did you mean "count"?; set it to one of count, spacing
                Error: b.spacing: "wide" cannot be used: expected a number; set it to a number from 0.001 to 1000 cm, such as 0.5
                Error: b.cuont: resample has no input of this name (it is set to 3); did you mean count?
                Error: b.count: c.curves gives curves, whole number is taken; remove the wire and set a value
                Error: b.curve: resample has no input of this name, but a wire ends there; did you mean curves?
                Error: b.curves: 2 wires end there, it takes one; remove the others, or merge them before
                Error: c.curves: nothing is wired to it, curves is needed; add a node that gives curves and wire it
                Error: d: this version has no node of kind "of_tomorrow"; open it with the version of coif that made it, or remove the node
                Error (not needed): e.curves: 3 cannot be used: curves come by wire: connect a node; remove the value
                Error (not needed): e.count: 2.5 cannot be used: it has decimals; set it to a whole number from 2 to 4096, such as 16
                Error (not needed): e.colour: resample has no input of this name (it is set to 1); remove it, or open the groom with the version of coif that made it
                Error (not needed): e.curves: c.crves is no output: resample gives curves; did you mean c.curves?
                Error (not needed): nix.in: there is no node nix to wire; remove the wire or add the node
                Warning: b.count: 1 is outside 2 to 4096 and will be clamped; set it to 2 to 4096
                Warning (not needed): e.spacing: 1000000000 cm is outside 0.001 to 1000 cm and will be clamped; set it to 0.001 to 1000 cm
            "#]],
        );
    }

    #[test]
    fn an_unwired_input_is_an_error_only_where_a_target_needs_it() {
        check_text(
            r#"(format: 1, display: "a", nodes: {"a": (kind: "resample"), "b": (kind: "resample")})"#,
            expect![[r#"
                Error: a.curves: nothing is wired to it, curves is needed; wire curves to it, such as b.curves
                Warning (not needed): b.curves: nothing is wired to it, curves is needed; wire curves to it, such as a.curves
            "#]],
        );
    }

    #[test]
    fn what_leads_nowhere_is_the_last_of_what_no_target_needs() {
        let nowhere =
            |text: &str| said(leading_nowhere(&crate::file::read(text).unwrap().document));
        let of = |more: &str| {
            nowhere(&format!(
                r#"(format: 3, nodes: {{
                    "head": (kind: "head"), "a": (kind: "scatter_guides", links: {{"scalp": "head.scalp"}}),
                    "b": (kind: "resample", links: {{"curves": "a.curves"}}),
                    "c": (kind: "resample", links: {{"curves": "b.curves"}}), {more}
                }})"#
            ))
        };
        assert_eq!(of(""), "");
        assert_eq!(of(r#""out": (kind: "groom_output", links: {"curves": "a.curves"})"#), "c");
        assert_eq!(of(r#""out": (kind: "groom_output", links: {"curves": "c.curves"})"#), "");
        let group = r#""g": (kind: "group", interface: (outputs: [(name: "curves", type: "curves")]),
            nodes: {"out": (kind: "group_output", links: {"curves": "x.curves"}), "in": (kind: "group_input"),
                "x": (kind: "stroke_input"), "y": (kind: "stroke_input")})"#;
        let out = r#"(kind: "groom_output", links: {"curves": "g.curves"})"#;
        assert_eq!(of(&format!(r#"{group}, "out": {out}"#)), "c g/y");
        assert_eq!(of(&format!(r#"{group}, "out": {}"#, out.replace("g.", "c."))), "g");
    }

    #[test]
    fn a_value_built_by_hand_is_proven_too() {
        let mut document = chain("a");
        let node = Arc::make_mut(document.nodes.get_mut("a").unwrap());
        node.inputs.insert("spacing".into(), Setting::Known(Value::Float(f32::NAN)));
        let faults: Vec<Fault> = check(&document).iter().map(|problem| problem.fault).collect();
        assert_eq!(faults, [Fault::Missing, Fault::BadValue]);
    }

    #[test]
    fn values_on_the_border_of_their_range_are_within_it() {
        for def in coif_nodes::all() {
            for input in def.inputs {
                let Some((lo, hi)) = input.hard else { continue };
                for x in [lo, hi] {
                    let value = match input.ty {
                        Type::Int => Value::Int(x as i64),
                        _ => Value::Float(x as f32),
                    };
                    let mut problems = vec![];
                    check_value(&id("a"), input, &Setting::Known(value), &mut problems);
                    assert_eq!(problems, [], "{}.{}", def.id, input.name);
                }
            }
        }
    }

    #[test]
    fn a_wire_drawn_by_an_edit_is_one_that_check_accepts() {
        let mut random = super::super::testing::Random::new(5);
        for _ in 0..300 {
            let mut document = chain("a>b c d");
            let ends = ["a", "b", "c", "d"].map(id);
            let (from, to) = (random.pick(&ends), random.pick(&ends));
            let (from, to) = (Socket::new(from, "curves"), Socket::new(to, "curves"));
            let edit = Edit::Connect { from, to, at: None };
            if edit.apply(&mut document).is_ok() {
                assert!(check(&document).iter().all(|problem| problem.fault == Fault::Missing));
            }
        }
    }
}
