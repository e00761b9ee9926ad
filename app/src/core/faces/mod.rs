//! What every node shows: its sockets, its words, its trouble, its size. Pure: document and reports
//! in, faces out.
//!
//! Everything that is placed or hit on the canvas is worked out from here, so a wire knows where it
//! ends while its nodes are out of sight.

pub(crate) mod arrange;

use crate::core::shown::Reports;
use crate::core::state::State;
use coif_graphs::document::graph::{self, Severity};
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::declared::{GROUP_INPUT, GROUP_OUTPUT, KINDS, PARAMETERS};
use coif_nodes::define::{Arity, InputDef, NodeDef, NodeError, Type};
use coif_nodes::eval::Message;
use egui::{Pos2, Rect, Vec2, pos2, vec2};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The stage of nodes that a document declares: behind all others.
pub(crate) const DECLARED: usize = coif_nodes::STAGES.len() + 1;
/// Width of every node, in the canvas's own units (points at full size).
pub(crate) const WIDTH: f32 = 172.0;
/// Height of a header with one line.
pub(crate) const HEADER: f32 = 26.0;
/// What a second line adds to it.
pub(crate) const SUBTITLE: f32 = 13.0;
/// Height of a row of sockets.
pub(crate) const ROW: f32 = 22.0;
/// Height of the footer.
pub(crate) const FOOTER: f32 = 19.0;

/// What stands between the parts of a footer.
pub(crate) const PARTS: &str = "  ·  ";

/// One end for wires.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plug {
    /// The input or output it belongs to.
    pub socket: Socket,
    /// What it carries; none when this version does not know it.
    pub ty: Option<Type>,
    /// The wire that ends here, by its number. Inputs that take many have a plug for each wire, and
    /// one more for the next.
    pub wire: Option<usize>,
    /// Whether the input takes any number of wires.
    pub many: bool,
    /// Whether the node cannot do without.
    pub needed: bool,
}

impl Plug {
    /// What stands beside it.
    pub(crate) fn label(&self) -> String {
        match (self.many, self.wire) {
            (true, Some(at)) => format!("{} {}", words(&self.socket.name), at + 1),
            (true, None) => format!("{} +", words(&self.socket.name)),
            _ => words(&self.socket.name),
        }
    }
}

/// A name of a declaration as people read it.
pub(crate) fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// Trouble of a node, the worst there is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// It has no result.
    Error(String),
    /// It would have, had this node one.
    Upstream(String),
    /// There is a result, but something was left out or changed.
    Warning(Vec<String>),
}

/// What one node shows.
#[derive(Clone)]
pub(crate) struct Face {
    /// Whose it is.
    pub id: NodeId,
    /// Its number for the widgets.
    pub key: egui_graph::NodeId,
    /// What people call it.
    pub label: String,
    /// The label of its kind; none where that is the label.
    pub kind: Option<String>,
    /// Its declaration; none for a kind that this version does not know.
    pub def: Option<&'static NodeDef>,
    /// Number of its stage in the order in which hair is made.
    pub stage: usize,
    /// Drawn small.
    pub collapsed: bool,
    /// Passed by.
    pub bypass: bool,
    /// Has the display flag.
    pub displayed: bool,
    /// The pen works on it.
    pub pinned: bool,
    /// Its note.
    pub note: String,
    /// Ends on the left, from above.
    pub inputs: Vec<Plug>,
    /// Ends on the right, from above.
    pub outputs: Vec<Plug>,
    /// Time and counts of its last run; empty before.
    pub footer: String,
    /// The worst that is wrong.
    pub trouble: Option<Trouble>,
}

impl Face {
    /// Height of the header.
    pub(crate) fn header(&self) -> f32 {
        if self.kind.is_some() { HEADER + SUBTITLE } else { HEADER }
    }
    /// Width and height.
    pub(crate) fn size(&self) -> Vec2 {
        if self.collapsed {
            return vec2(WIDTH, self.header());
        }
        let rows = self.inputs.len().max(self.outputs.len());
        vec2(WIDTH, self.header() + rows as f32 * ROW + FOOTER)
    }
    /// Where an input's end is on a node whose corner is at `corner`.
    pub(crate) fn input_at(&self, corner: Pos2, number: usize) -> Pos2 {
        pos2(corner.x, corner.y + self.height_of(number, self.inputs.len()))
    }
    /// Where an output's end is.
    pub(crate) fn output_at(&self, corner: Pos2, number: usize) -> Pos2 {
        pos2(corner.x + WIDTH, corner.y + self.height_of(number, self.outputs.len()))
    }
    fn height_of(&self, number: usize, of: usize) -> f32 {
        if self.collapsed {
            return self.header() * (number as f32 + 1.0) / (of as f32 + 1.0);
        }
        self.header() + (number as f32 + 0.5) * ROW
    }
    /// The plug at which a wire of an input ends.
    pub(crate) fn plug_of(&self, input: &str, wire: usize) -> Option<usize> {
        self.inputs.iter().position(|p| &*p.socket.name == input && p.wire == Some(wire))
    }
    /// The plug of an output.
    pub(crate) fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|p| &*p.socket.name == name)
    }
}

/// The faces of a document and where they stand.
#[derive(Clone, Default)]
pub(crate) struct Faces {
    /// By id, in the order of ids.
    pub all: BTreeMap<NodeId, Face>,
    /// Upper left corners, where the document says or else where there is room.
    pub corners: BTreeMap<NodeId, Pos2>,
}

impl Faces {
    /// Faces of every node of a group, or of those in none.
    pub(crate) fn new(
        document: &Document,
        reports: &Reports,
        exposed: &BTreeSet<Socket>,
        pinned: Option<&NodeId>,
        group: Option<&NodeId>,
    ) -> Self {
        let troubles = troubles(document, reports);
        let taken = taken_outputs(document);
        let all: BTreeMap<NodeId, Face> = document
            .nodes
            .keys()
            .filter(|id| id.group().as_ref() == group)
            .map(|id| {
                let mut face = face(document, id, exposed, &taken);
                face.pinned = pinned == Some(id);
                face.footer = reports.nodes.get(id).map_or_else(String::new, footer);
                face.trouble = troubles.get(id).cloned();
                if let Some(says) = of_border(&document.nodes[id].kind) {
                    face.footer = says.to_owned();
                }
                if document.nodes[id].is_group() {
                    face.footer = footer_of_group(document, reports, id);
                    face.trouble = face.trouble.or_else(|| trouble_inside(document, &troubles, id));
                }
                (id.clone(), face)
            })
            .collect();
        let corners = arrange::corners(document, &all);
        Self { all, corners }
    }

    /// The box of a node.
    pub(crate) fn rect(&self, id: &NodeId) -> Option<Rect> {
        Some(Rect::from_min_size(*self.corners.get(id)?, self.all.get(id)?.size()))
    }

    /// The box round nodes; none when there are none.
    pub(crate) fn bounds<'a>(&self, of: impl IntoIterator<Item = &'a NodeId>) -> Option<Rect> {
        of.into_iter().filter_map(|id| self.rect(id)).reduce(Rect::union)
    }
}

fn face(
    document: &Document,
    id: &NodeId,
    exposed: &BTreeSet<Socket>,
    taken: &BTreeMap<&NodeId, BTreeSet<&str>>,
) -> Face {
    let node = &document.nodes[id];
    let def = document.def(id);
    let stages = coif_nodes::STAGES.iter();
    let stage = match KINDS.contains(&node.kind.as_str()) {
        true => DECLARED,
        false => stages.take_while(|(_, nodes)| !nodes.iter().any(|n| n.id == node.kind)).count(),
    };
    let kind = def.map_or_else(|| words(&node.kind), |def| def.label.to_owned());
    let label = document.name_of(id).into_owned();
    Face {
        id: id.clone(),
        key: egui_graph::NodeId::new(id.as_str()),
        kind: (label != kind).then_some(kind),
        label,
        def,
        stage,
        collapsed: document.collapsed.contains(id),
        bypass: node.bypass,
        displayed: document.display.as_ref() == Some(id),
        pinned: false,
        note: node.note.clone(),
        inputs: inputs(document, id, def, exposed),
        outputs: outputs(id, def, taken.get(id)),
        footer: String::new(),
        trouble: None,
    }
}

/// Whether an input is only of use with a wire.
pub(crate) fn comes_by_wire(ty: Type) -> bool {
    matches!(ty, Type::Curves | Type::Scalp)
}

fn inputs(
    document: &Document,
    id: &NodeId,
    def: Option<&'static NodeDef>,
    exposed: &BTreeSet<Socket>,
) -> Vec<Plug> {
    let mut plugs = vec![];
    let declared = def.map_or(&[][..], |def| def.inputs);
    for input in declared {
        let socket = Socket::new(id.clone(), input.name);
        let wires = document.wires(id, input.name).len();
        if wires == 0 && !comes_by_wire(input.ty) && !exposed.contains(&socket) {
            continue;
        }
        push_plugs(&mut plugs, socket, Some(input), wires);
    }
    // Wires of a file that this version does not know, or that a merge broke, are seen too.
    for (socket, wires) in graph::inputs_of(document, id) {
        if !declared.iter().any(|input| *input.name == *socket.name) {
            push_plugs(&mut plugs, socket.clone(), None, wires.len());
        }
    }
    plugs
}

fn push_plugs(plugs: &mut Vec<Plug>, socket: Socket, input: Option<&InputDef>, wires: usize) {
    let many = input.is_some_and(|input| input.arity == Arity::Many) || wires > 1;
    let needed = input.is_some_and(|i| i.arity == Arity::One && !i.has_default());
    let ty = input.map(|input| input.ty);
    let plug = |wire| Plug { socket: socket.clone(), ty, wire, many, needed };
    plugs.extend((0..wires).map(|at| plug(Some(at))));
    if wires == 0 || input.is_some_and(|input| input.arity == Arity::Many) {
        plugs.push(plug(None));
    }
}

fn outputs(id: &NodeId, def: Option<&NodeDef>, taken: Option<&BTreeSet<&str>>) -> Vec<Plug> {
    let plug = |name: &str, ty| Plug {
        socket: Socket::new(id.clone(), name),
        ty,
        wire: None,
        many: false,
        needed: false,
    };
    let declared = def.map_or(&[][..], |def| def.outputs);
    let known = declared.iter().map(|output| plug(output.name, Some(output.ty)));
    let unknown = taken.into_iter().flatten();
    let unknown = unknown.filter(|name| !declared.iter().any(|output| output.name == **name));
    known.chain(unknown.map(|name| plug(name, None))).collect()
}

/// For each node the outputs that wires take from it.
fn taken_outputs(document: &Document) -> BTreeMap<&NodeId, BTreeSet<&str>> {
    let mut taken: BTreeMap<&NodeId, BTreeSet<&str>> = BTreeMap::new();
    for from in document.links.values().flatten() {
        taken.entry(&from.node).or_default().insert(&from.name);
    }
    taken
}

/// What is wrong with each node: in the document, in its last run, or before it.
fn troubles(document: &Document, reports: &Reports) -> BTreeMap<NodeId, Trouble> {
    let mut errors: BTreeMap<NodeId, String> = BTreeMap::new();
    let mut warnings: BTreeMap<NodeId, Vec<String>> = BTreeMap::new();
    for problem in graph::check(document) {
        let at = problem.socket.as_deref().map_or(String::new(), |s| format!("{}: ", words(s)));
        let text = format!("{at}{}; {}", problem.text, problem.remedy);
        // What nobody needs yet is work in progress.
        if problem.severity == Severity::Error && problem.needed {
            errors.entry(problem.node).or_insert(text);
        } else if problem.needed {
            warnings.entry(problem.node).or_default().push(text);
        }
    }
    for bad in &reports.refused {
        if let Ok(id) = NodeId::new(bad.node.as_str()) {
            errors.entry(id).or_insert_with(|| bad.reason.clone());
        }
    }
    for (id, report) in &reports.nodes {
        if let Some(error) = report.error.as_ref().filter(|e| **e != NodeError::Cancelled) {
            errors.entry(id.clone()).or_insert_with(|| error.to_string());
        }
        let said = report.messages.iter().filter(|m| m.warning).map(Message::to_string);
        let said: Vec<String> = said.collect();
        if !said.is_empty() {
            warnings.entry(id.clone()).or_default().extend(said);
        }
    }
    let mut troubles: BTreeMap<NodeId, Trouble> = BTreeMap::new();
    for id in errors.keys() {
        let name = document.name_of(id);
        for behind in graph::downstream(document, [id]) {
            let upstream = Trouble::Upstream(name.clone().into_owned());
            troubles.entry(behind).or_insert(upstream);
        }
    }
    let of_node = |(id, said)| (id, Trouble::Warning(said));
    for (id, trouble) in warnings.into_iter().map(of_node) {
        troubles.entry(id).or_insert(trouble);
    }
    troubles.extend(errors.into_iter().map(|(id, text)| (id, Trouble::Error(text))));
    troubles
}

/// Time and counts of a run, short enough for a node.
fn footer(report: &coif_graphs::schedule::result::NodeReport) -> String {
    let mut parts = vec![if report.cached { "cached".to_owned() } else { time(report.ms) }];
    if report.curves > 0 {
        let plural = if report.curves == 1 { "" } else { "s" };
        parts.push(format!("{} curve{plural}", count(report.curves)));
        parts.push(format!("{} pts", count(report.points)));
    }
    parts.join(PARTS)
}

/// What stands under what never runs, but hands on.
fn of_border(kind: &str) -> Option<&'static str> {
    match kind {
        GROUP_INPUT => Some("from outside"),
        GROUP_OUTPUT => Some("to outside"),
        PARAMETERS => Some("read by others"),
        _ => None,
    }
}

/// The sums of what ran in a group.
fn footer_of_group(document: &Document, reports: &Reports, group: &NodeId) -> String {
    let count = document.inside(group).filter(|(_, node)| of_border(&node.kind).is_none()).count();
    let ran: Vec<_> = document.inside(group).filter_map(|(id, _)| reports.nodes.get(id)).collect();
    let nodes = format!("{count} node{}", if count == 1 { "" } else { "s" });
    if ran.is_empty() {
        return nodes;
    }
    let cached = ran.iter().all(|report| report.cached);
    let ms = ran.iter().filter(|report| !report.cached).map(|report| report.ms).sum();
    let time = if cached { "cached".to_owned() } else { time(ms) };
    [time, nodes].join(PARTS)
}

/// The worst that is wrong in a group, with the node.
fn trouble_inside(
    document: &Document,
    troubles: &BTreeMap<NodeId, Trouble>,
    group: &NodeId,
) -> Option<Trouble> {
    let mut found = None;
    for (id, _) in document.inside(group) {
        let name = document.name_of(id);
        match troubles.get(id) {
            Some(Trouble::Error(text)) => return Some(Trouble::Error(format!("{name}: {text}"))),
            Some(Trouble::Warning(said)) if found.is_none() => {
                let said = said.iter().map(|said| format!("{name}: {said}"));
                found = Some(Trouble::Warning(said.collect()));
            }
            _ => {}
        }
    }
    found
}

/// Milliseconds as people read them.
fn time(ms: f64) -> String {
    match ms {
        ms if ms < 10.0 => format!("{ms:.1} ms"),
        ms if ms < 1000.0 => format!("{ms:.0} ms"),
        ms => format!("{:.1} s", ms / 1000.0),
    }
}

/// A number with its thousands apart; millions are rounded.
pub(crate) fn count(n: usize) -> String {
    if n >= 1_000_000 {
        return format!("{:.1} M", n as f64 / 1e6);
    }
    if n >= 100_000 {
        return format!("{} k", n / 1000);
    }
    let digits = n.to_string();
    match digits.len() {
        len if len > 3 => format!("{},{}", &digits[..len - 3], &digits[len - 3..]),
        _ => digits,
    }
}

/// Kept faces: worked out again when what they show changed.
#[derive(Default)]
pub(crate) struct FaceCache {
    key: Option<Key>,
    faces: Arc<Faces>,
}

/// All that faces are worked out from.
#[derive(PartialEq)]
struct Key {
    /// Cheap: nodes are shared with the document, and equal when they are the same.
    document: Document,
    reports: usize,
    exposed: BTreeSet<Socket>,
    pinned: Option<NodeId>,
    group: Option<NodeId>,
}

impl FaceCache {
    /// The faces that were asked for last.
    pub(crate) fn last(&self) -> &Faces {
        &self.faces
    }

    /// The faces of a state.
    pub(crate) fn of(&mut self, state: &State) -> Arc<Faces> {
        self.opened(state, &BTreeSet::new())
    }

    /// The same with more inputs shown as ends than the state asks for.
    pub(crate) fn opened(&mut self, state: &State, more: &BTreeSet<Socket>) -> Arc<Faces> {
        let reports = &state.run.reports;
        let exposed: BTreeSet<Socket> = state.exposed.union(more).cloned().collect();
        let same = self.key.as_ref().is_some_and(|key| {
            key.document == state.document
                && key.reports == Arc::as_ptr(reports) as usize
                && key.exposed == exposed
                && key.pinned == state.pinned
                && key.group == state.group
        });
        if !same {
            let (document, pinned) = (&state.document, state.pinned.as_ref());
            let group = state.group.as_ref();
            self.faces = Faces::new(document, reports, &exposed, pinned, group).into();
            self.key = Some(Key {
                document: document.clone(),
                reports: Arc::as_ptr(reports) as usize,
                exposed,
                pinned: state.pinned.clone(),
                group: state.group.clone(),
            });
        }
        self.faces.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::testing::{document, id};

    fn faces(document: &Document) -> Faces {
        Faces::new(document, &Reports::default(), &BTreeSet::new(), None, None)
    }

    #[test]
    fn a_node_shows_what_comes_by_wire_what_is_wired_and_what_was_asked_for() {
        let document = document("cornrows");
        let exposed = [Socket::new(id("braid"), "width")].into();
        let faces = Faces::new(&document, &Reports::default(), &exposed, None, None);
        let inputs = |node: &str| -> Vec<String> {
            faces.all[node].inputs.iter().map(Plug::label).collect()
        };
        assert_eq!(inputs("head"), Vec::<String>::new());
        assert_eq!(inputs("rows"), ["scalp"]);
        assert_eq!(inputs("braid"), ["source", "scalp", "width"]);
        assert!(inputs("partings").contains(&"stitches".to_owned()), "{:?}", inputs("partings"));
    }

    #[test]
    fn inputs_of_many_wires_have_a_plug_for_each_and_one_more() {
        let mut document = document("cornrows");
        let node = document.fresh_node("merge", &id("all"));
        document.nodes.insert(id("all"), node.into());
        let from = ["fill", "colour"].map(|node| Socket::new(id(node), "curves"));
        document.links.insert(Socket::new(id("all"), "curves"), from.to_vec());
        let faces = faces(&document);
        let labels: Vec<String> = faces.all["all"].inputs.iter().map(Plug::label).collect();
        assert_eq!(labels, ["curves 1", "curves 2", "curves +"]);
        assert_eq!(faces.all["all"].plug_of("curves", 1), Some(1));
    }

    #[test]
    fn trouble_is_told_where_it_is_and_where_it_leads() {
        let mut document = document("cornrows");
        document.links.remove(&Socket::new(id("rows"), "scalp"));
        document.links.remove(&Socket::new(id("braid"), "source"));
        let faces = faces(&document);
        let trouble = |node: &str| faces.all[node].trouble.clone();
        assert!(matches!(trouble("braid"), Some(Trouble::Error(_))), "{:?}", trouble("braid"));
        let label = document.name_of(&id("braid")).into_owned();
        assert_eq!(trouble("fill"), Some(Trouble::Upstream(label)));
        assert_eq!(trouble("head"), None);
    }

    #[test]
    fn what_this_version_does_not_know_is_shown_and_wired() {
        let mut document = document("cornrows");
        let mut node = (*document.nodes["fill"]).clone();
        node.kind = "of_tomorrow".to_owned();
        document.nodes.insert(id("fill"), node.into());
        let faces = faces(&document);
        let fill = &faces.all["fill"];
        assert_eq!(fill.outputs.len(), 1);
        assert_eq!(fill.inputs.len(), 2);
        assert!(fill.inputs.iter().all(|plug| plug.ty.is_none()));
        assert_eq!(fill.kind.as_deref(), Some("of tomorrow"));
    }

    #[test]
    fn numbers_are_short() {
        for (n, text) in [
            (0, "0"),
            (999, "999"),
            (1204, "1,204"),
            (30000, "30,000"),
            (123_456, "123 k"),
            (1_600_000, "1.6 M"),
        ] {
            assert_eq!(count(n), text);
        }
        assert_eq!(
            (time(3.12), time(38.2), time(2345.0)),
            ("3.1 ms".into(), "38 ms".into(), "2.3 s".into())
        );
    }
}
