//! What evaluation gives the window: what is shown, what nodes said, how far it is; and what of a document is shown at all.

use coif_graphs::document::graph::downstream;
use coif_graphs::document::{Document, Node, NodeId, Setting, Socket};
use coif_graphs::schedule::budget::Used;
use coif_graphs::schedule::request::BadRequest;
use coif_graphs::schedule::result::NodeReport;
use coif_graphs::trace;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{Type, Value};
use coif_nodes::eval::Quality;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// What came out, ready to be looked at.
#[derive(Debug)]
pub struct Shown {
    /// The state of the document that it shows.
    pub revision: u64,
    /// How much hair was made.
    pub quality: Quality,
    /// The outputs that are displayed, in the document's order.
    pub sockets: Vec<Socket>,
    /// Their curves together.
    pub curves: Curves,
    /// Whether this is the head alone, shown while its hair is being made.
    pub head_alone: bool,
    /// The heads that they stand on.
    pub scalps: Vec<Arc<Scalp>>,
    /// Every value that was asked for, by output.
    pub values: BTreeMap<Socket, Value>,
    /// How many strands of the final hair each of these stands for, 1 or more: pictures draw it as much wider.
    pub stands_for: f32,
    /// How many strands the same outputs had in the last final evaluation.
    pub final_strands: Option<usize>,
    /// Wall time of the evaluation, milliseconds.
    pub ms: f64,
    /// What is over the groom's budget; of a preview nothing, which says little of the whole.
    pub over: Vec<Used>,
}

impl Shown {
    /// The head that everything stands on, when there is one.
    pub fn scalp(&self) -> Option<&Arc<Scalp>> {
        self.scalps.first()
    }
    /// Whether all hair was made.
    pub fn is_final(&self) -> bool {
        self.quality == Quality::Final
    }
    /// The curves of one output, when it was asked for.
    pub fn curves_of(&self, socket: &Socket) -> Option<&Curves> {
        match self.values.get(socket)? {
            Value::Curves(curves) => Some(curves),
            _ => None,
        }
    }
}

/// How the viewport shows two grooms that are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// One's own alone.
    #[default]
    Own,
    /// The other in its place.
    Other,
    /// One's own at the left of a divider, the other at its right, in one picture.
    Wipe,
    /// One beside the other.
    Beside,
}

impl Sides {
    /// The other groom alone, or one's own again.
    #[must_use]
    pub fn flipped(self) -> Self {
        if self == Self::Other { Self::Own } else { Self::Other }
    }
}

/// What the nodes said when they last ran.
#[derive(Clone, Debug, Default)]
pub struct Reports {
    /// The state of the document that was evaluated last, with or without a result.
    pub revision: u64,
    /// Each node's last report. Nodes off the way keep theirs while nothing before them changes.
    pub nodes: BTreeMap<NodeId, NodeReport>,
    /// Why the document, or a part of it, could not be evaluated at all.
    pub refused: Vec<BadRequest>,
}

impl Reports {
    /// Failed nodes with what they say, in the order of their ids.
    pub fn failures(&self) -> Vec<(&str, String)> {
        let failed = self.nodes.iter().filter_map(|(id, report)| {
            let error = report.error.as_ref()?;
            (*error != coif_nodes::define::NodeError::Cancelled)
                .then(|| (id.as_str(), error.to_string()))
        });
        let refused = self.refused.iter().map(|bad| (bad.node.as_str(), bad.reason.clone()));
        refused.chain(failed).collect()
    }
}

/// What the evaluator does now.
#[derive(Clone, Debug, Default)]
pub struct RunStatus {
    /// When the present run began; none at rest.
    pub since: Option<Instant>,
    /// The state of the document that it is about, and how much hair it makes.
    pub revision: u64,
    /// Nodes done, of all that the run needs.
    pub nodes: (usize, usize),
    /// The node that began last, and its pieces of work done.
    pub node: String,
    /// Pieces of that node done, of all.
    pub pieces: (usize, usize),
    /// What the nodes said last.
    pub reports: Arc<Reports>,
    /// Bytes kept for reuse, and the most that may be.
    pub cache: (usize, usize),
    /// How far the search for what made a hair is; none where none is on.
    pub tracing: Option<trace::TraceProgress>,
}

/// Which curve's makers are looked for, in what is displayed of a document.
#[derive(Clone, Debug)]
pub struct Trace {
    /// The curve.
    pub id: u64,
    /// What it was seen in.
    pub document: Document,
    /// What its paths are relative to.
    pub folder: PathBuf,
    /// How much hair it was seen among.
    pub quality: Quality,
    /// Whether nodes may make more than a groom is to have.
    pub allow_large: bool,
}

/// What is displayed: the output of the node with the display flag, else the hair of every `groom_output` (guides where
/// there is no hair), else what nothing reads.
pub fn displayed(document: &Document) -> Vec<Socket> {
    if let Some(socket) = document.display.as_ref().and_then(|id| first_output(document, id)) {
        return vec![socket];
    }
    let guides =
        |node: &Node| matches!(node.inputs.get("guides"), Some(Setting::Known(Value::Bool(true))));
    for with_guides in [false, true] {
        let outputs = document.nodes.iter().filter(|(_, node)| node.kind == "groom_output");
        let outputs = outputs.filter(|(_, node)| with_guides || !guides(node));
        let sockets: Vec<Socket> =
            outputs.filter_map(|(id, _)| first_output(document, id)).collect();
        if !sockets.is_empty() {
            return sockets;
        }
    }
    let ends = document.nodes.keys().filter(|id| downstream(document, [*id]).len() <= 1);
    ends.filter_map(|id| first_output(document, id)).collect()
}

/// The output of a node that can be looked at: its first curves, else its scalp.
pub fn first_output(document: &Document, id: &NodeId) -> Option<Socket> {
    let def = document.def(id)?;
    let of = |ty: Type| def.outputs.iter().find(|output| output.ty == ty);
    let output = of(Type::Curves).or_else(|| of(Type::Scalp))?;
    Some(Socket::new(id.clone(), output.name))
}
