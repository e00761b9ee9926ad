//! What made one hair: the nodes, strokes and gestures without which its points or widths would be others.
//!
//! Found by experiment, not by what nodes say of themselves. **Law:** switch off whatever is not listed, and the hair keeps its bits.
//! All that is not listed was off at once in an evaluation that gave the same hair, and so were random parts of it; what is listed
//! changes the hair when it alone is off, but for what is marked as needed only together with others ([`Found::alone`]). Not
//! guaranteed: that no choice among the 2^n of things to switch off would tell more.
//!
//! **Off** is what bypassing does, for nodes of any kind ([`without`]): who reads a node that is off reads what that node reads
//! first of the same type, by its first wire, and where there is none loses the wire; a node that cannot do without it then gives
//! nothing either, and so on. A stroke or a gesture that is off is not in its list. Where no hair comes out, or nodes fail, the hair is
//! another.
//!
//! An evaluator that keeps what it made (a cache) runs only what is behind what was switched. Parts are switched by halves: of
//! n parts of which k made the hair some k log n evaluations are needed.

use crate::document::{Document, NodeId, Setting, Socket, graph};
use crate::schedule::files::Files;
use crate::schedule::request::{BadRequest, plan};
use crate::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::attributes::WIDTH;
use coif_nodes::data::curves::Curves;
use coif_nodes::declared;
use coif_nodes::define::{Arity, Value};
use coif_nodes::eval::Quality;
use coif_nodes::maths::hash::KeyBuilder;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

/// Something that can be switched off.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// A node.
    Node(NodeId),
    /// A stroke or a gesture of an input.
    Drawn {
        /// Whose input.
        node: NodeId,
        /// Its name.
        input: String,
        /// The stored id.
        id: u64,
    },
}

impl Part {
    /// The node that it is, or is drawn in.
    pub fn node(&self) -> &NodeId {
        match self {
            Part::Node(node) | Part::Drawn { node, .. } => node,
        }
    }

    /// What it is in a document, in words: "node", "stroke 7, the 3rd of 14", "gesture 5 (comb), the 1st of 2".
    pub fn describe(&self, document: &Document) -> String {
        let Part::Drawn { node, input, id } = self else { return "node".to_owned() };
        let value = document.node(node.as_str()).and_then(|node| node.inputs.get(input));
        let Some(Setting::Known(value)) = value else { return format!("{input} {id}") };
        let (what, ids): (String, Vec<u64>) = match value {
            Value::Strokes(all) => {
                let brush =
                    all.0.iter().find(|one| one.id == *id).and_then(|one| one.brush.as_ref());
                let what = brush
                    .map_or("stroke".to_owned(), |brush| format!("{} stroke", brush.mode.word()));
                (format!("{what} {id}"), all.0.iter().map(|one| one.id).collect())
            }
            Value::Gestures(all) => {
                let tool = all.0.iter().find(|one| one.id == *id).map_or("", |one| one.tool.word());
                (format!("gesture {id} ({tool})"), all.0.iter().map(|one| one.id).collect())
            }
            _ => return format!("{input} {id}"),
        };
        match ids.iter().position(|other| other == id) {
            Some(at) => format!("{what}, number {} of {}", at + 1, ids.len()),
            None => what,
        }
    }
}

/// A part that made the hair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Which.
    pub part: Part,
    /// Whether the hair is another when this part alone is off. Else it is only when others that are not listed are off too: of
    /// several that do the same, one is listed.
    pub alone: bool,
}

/// What made a hair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Traced {
    /// The output that gives it.
    pub output: Socket,
    /// Its id.
    pub hair: u64,
    /// What made it, sources first, what is drawn in a node behind it.
    pub found: Vec<Found>,
    /// How many parts could be switched off.
    pub parts: usize,
    /// How many evaluations it took.
    pub evaluations: usize,
}

/// Why nothing was found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotTraced {
    /// The document cannot be evaluated.
    #[error(transparent)]
    Bad(#[from] BadRequest),
    /// A node failed.
    #[error("{node}: {reason}")]
    Failed {
        /// Which.
        node: String,
        /// Why.
        reason: String,
    },
    /// No output has it.
    #[error("no hair of the outputs has the id {0:016x}")]
    NoHair(u64),
    /// Somebody asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// How far a trace is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraceProgress {
    /// Evaluations that are done.
    pub evaluations: usize,
    /// Parts of which it is not known yet whether they made the hair.
    pub open: usize,
    /// All parts.
    pub of: usize,
}

/// What is evaluated.
pub struct Groom<'a> {
    /// The groom.
    pub document: &'a Document,
    /// What it reads.
    pub files: &'a dyn Files,
    /// How much hair is made; ids of a preview are those of the whole.
    pub quality: Quality,
    /// Whether nodes may make more than a groom is to have.
    pub allow_large: bool,
}

/// What made a hair of `outputs`; the first that has it counts. `tell` is told how far it is.
///
/// # Errors
/// It cannot be evaluated, there is no such hair, or somebody asked to stop.
pub fn trace(
    groom: &Groom,
    outputs: &[Socket],
    hair: u64,
    (evaluator, cancel): (&Evaluator, &CancelToken),
    tell: &mut dyn FnMut(TraceProgress),
) -> Result<Traced, NotTraced> {
    let (output, before) = find(groom, outputs, hair, evaluator, cancel)?;
    let parts = parts(groom, &output)?;
    let mut search = Search {
        groom,
        output: &output,
        hair,
        before,
        evaluator,
        cancel,
        tell,
        progress: TraceProgress { evaluations: 1, open: parts.len(), of: parts.len() },
        parts,
    };
    let found = search.found()?;
    let (parts, evaluations) = (search.parts.len(), search.progress.evaluations);
    let part = |(at, alone): (usize, bool)| Found { part: search.parts[at].clone(), alone };
    let found = found.into_iter().map(part).collect();
    Ok(Traced { output, hair, found, parts, evaluations })
}

/// The output that has the hair, and the hair's bits.
fn find(
    groom: &Groom,
    outputs: &[Socket],
    hair: u64,
    evaluator: &Evaluator,
    cancel: &CancelToken,
) -> Result<(Socket, Vec<u32>), NotTraced> {
    let mut planned = plan(groom.document, outputs, groom.quality, groom.files)?;
    planned.allow_large = groom.allow_large;
    let outcome = evaluator.run(&planned, OnFailure::Stop, cancel, &Quiet);
    if outcome.cancelled {
        return Err(NotTraced::Cancelled);
    }
    for (output, value) in outputs.iter().zip(&outcome.targets) {
        if let Some(bits) = bits_of(value.as_ref(), hair) {
            return Ok((output.clone(), bits));
        }
    }
    let failed = outcome.nodes.iter().find_map(|node| Some((&node.name, node.error.as_ref()?)));
    Err(match failed {
        Some((node, why)) => NotTraced::Failed { node: node.clone(), reason: why.to_string() },
        None => NotTraced::NoHair(hair),
    })
}

/// All points and widths of a hair, bit by bit; none where it is not there.
fn bits_of(value: Option<&Value>, hair: u64) -> Option<Vec<u32>> {
    let Some(Value::Curves(curves)) = value else { return None };
    let (tuft, i) = curves.each().find(|(tuft, i)| tuft.id(*i) == hair)?;
    let widths = tuft.view(WIDTH);
    let each = tuft.range(i).flat_map(|k| {
        let [x, y, z] = tuft.points()[k].to_array();
        [x, y, z, widths.at(i, k)].map(f32::to_bits)
    });
    Some(each.collect())
}

/// The id of the hair whose root is nearest to a point (cm), and how far off that is; none where there is no hair.
pub fn nearest(curves: &Curves, at: glam::Vec3) -> Option<(u64, f32)> {
    let roots = curves.each().filter_map(|(tuft, i)| {
        let root = tuft.points().get(tuft.range(i).start)?;
        Some((tuft.id(i), root.distance(at)))
    });
    roots.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// All that may be switched off on the way to an output: nodes in the order in which they run, each with what is drawn in it.
pub fn parts(groom: &Groom, output: &Socket) -> Result<Vec<Part>, BadRequest> {
    let document = groom.document;
    let planned = plan(document, std::slice::from_ref(output), groom.quality, groom.files)?;
    let run: Vec<NodeId> =
        planned.steps.iter().filter_map(|step| NodeId::new(&step.name).ok()).collect();
    // Groups and parameters are not run, and may hold what is drawn.
    let known: BTreeSet<&NodeId> = run.iter().collect();
    let mut feeders = graph::upstream(document, [&output.node]);
    feeders.retain(|id| !known.contains(id));
    let nodes = feeders.iter().map(|id| (id, false)).chain(run.iter().map(|id| (id, true)));
    let mut parts = vec![];
    for (id, runs) in nodes {
        if runs {
            parts.push(Part::Node(id.clone()));
        }
        let node = document.node(id.as_str());
        for (input, setting) in node.into_iter().flat_map(|node| &node.inputs) {
            // A wire goes before what is drawn.
            let is_wired = !document.wires(id, input).is_empty();
            let Setting::Known(value) = setting else { continue };
            let ids: Vec<u64> = match value {
                Value::Strokes(all) if !is_wired => all.0.iter().map(|one| one.id).collect(),
                Value::Gestures(all) if !is_wired => all.0.iter().map(|one| one.id).collect(),
                _ => continue,
            };
            let (node, input) = (id, input);
            parts.extend(ids.into_iter().map(|id| Part::Drawn {
                node: node.clone(),
                input: input.clone(),
                id,
            }));
        }
    }
    Ok(parts)
}

/// The document with these parts off, and what is read there in place of `output`; none where nothing is.
pub fn without<'a>(
    document: &Document,
    off: impl IntoIterator<Item = &'a Part>,
    output: &Socket,
) -> (Document, Option<Socket>) {
    let (mut nodes, mut drawn) = (BTreeSet::new(), BTreeMap::<_, BTreeSet<u64>>::new());
    for part in off {
        match part {
            Part::Node(node) => drop(nodes.insert(node)),
            Part::Drawn { node, input, id } => {
                drawn.entry((node, input)).or_default().insert(*id);
            }
        }
    }
    let mut less = document.clone();
    for ((id, input), off) in drawn {
        let node = less.nodes.get_mut(id).map(Arc::make_mut);
        let Some(Setting::Known(value)) = node.and_then(|node| node.inputs.get_mut(input)) else {
            continue;
        };
        match value {
            Value::Strokes(all) => Arc::make_mut(all).0.retain(|one| !off.contains(&one.id)),
            Value::Gestures(all) => Arc::make_mut(all).0.retain(|one| !off.contains(&one.id)),
            _ => {}
        }
    }
    let mut gone = BTreeSet::new();
    loop {
        let known = gone.len();
        for (to, from) in &document.links {
            let led: Vec<Socket> =
                from.iter().filter_map(|socket| behind(document, &nodes, &gone, socket)).collect();
            if led.is_empty() {
                gone.extend(hangs_from(document, to));
                less.links.remove(to);
            } else {
                less.links.insert(to.clone(), led);
            }
        }
        if gone.len() == known {
            break;
        }
    }
    less.settle();
    (less, behind(document, &nodes, &gone, output))
}

/// The output that is read in place of one, where nodes are off and outputs are gone.
fn behind(
    document: &Document,
    off: &BTreeSet<&NodeId>,
    gone: &BTreeSet<Socket>,
    socket: &Socket,
) -> Option<Socket> {
    let mut at = socket.clone();
    // No way is longer but in a circle.
    for _ in 0..=off.len() {
        if gone.contains(&at) {
            return None;
        }
        if !off.contains(&at.node) {
            return Some(at);
        }
        let def = document.def(&at.node)?;
        let (_, output) = def.output(&at.name)?;
        let same = def.inputs.iter().filter(|input| input.ty == output.ty);
        at = same.flat_map(|input| document.wires(&at.node, input.name)).next()?.clone();
    }
    None
}

/// The outputs that give nothing once an input has no wires left.
fn hangs_from(document: &Document, to: &Socket) -> Vec<Socket> {
    let Some(node) = document.node(to.node.as_str()) else { return vec![] };
    let port = |node: &NodeId| Socket { node: node.clone(), name: to.name.clone() };
    let is_set = node.inputs.contains_key(&*to.name);
    match node.kind.as_str() {
        declared::GROUP_OUTPUT => to.node.group().iter().map(port).collect(),
        declared::GROUP if !is_set => {
            let inner = document.inside(&to.node).filter(|(id, node)| {
                node.kind == declared::GROUP_INPUT && id.group().as_ref() == Some(&to.node)
            });
            inner.map(|(id, _)| port(id)).collect()
        }
        declared::PARAMETERS if !is_set => vec![port(&to.node)],
        _ => {
            let def = document.def(&to.node);
            let input = def.and_then(|def| def.input(&to.name));
            let is_needed = input.is_some_and(|(_, input)| {
                input.arity != Arity::Optional && input.default().is_none() && !is_set
            });
            let outputs = def.into_iter().filter(|_| is_needed).flat_map(|def| def.outputs);
            outputs.map(|output| Socket::new(to.node.clone(), output.name)).collect()
        }
    }
}

/// Random parts of what is not listed that are off in the end, each.
const CHECKS: u64 = 8;

struct Search<'a> {
    groom: &'a Groom<'a>,
    output: &'a Socket,
    hair: u64,
    before: Vec<u32>,
    evaluator: &'a Evaluator,
    cancel: &'a CancelToken,
    tell: &'a mut dyn FnMut(TraceProgress),
    progress: TraceProgress,
    parts: Vec<Part>,
}

impl Search<'_> {
    /// What made the hair, and whether each does alone.
    fn found(&mut self) -> Result<BTreeMap<usize, bool>, NotTraced> {
        let all: Vec<usize> = (0..self.parts.len()).collect();
        let mut found = BTreeMap::new();
        self.needed(&all, false, &mut found)?;
        loop {
            let rest: Vec<usize> =
                all.iter().copied().filter(|at| !found.contains_key(at)).collect();
            let known = found.len();
            self.together(&rest, &mut vec![], &mut found)?;
            if found.len() > known {
                continue;
            }
            // What is off together may still pull against each other, as a painted stroke and one that erases it do.
            for n in 0..CHECKS {
                let drawn = |at: &usize| {
                    KeyBuilder::new("trace").int(n).int(*at as u64).finish().0 & 1 == 0
                };
                let some: Vec<usize> = rest.iter().copied().filter(drawn).collect();
                if !self.is_same(&some)? {
                    self.needed(&some, true, &mut found)?;
                    if found.len() == known {
                        self.together(&some, &mut vec![], &mut found)?;
                    }
                    break;
                }
            }
            if found.len() == known {
                return Ok(found);
            }
        }
    }

    /// Adds those of a group without which, each alone, the hair is another. A group that can be off whole has none; gives whether it
    /// can. `is_needed` where that is known not to be so.
    fn needed(
        &mut self,
        group: &[usize],
        is_needed: bool,
        found: &mut BTreeMap<usize, bool>,
    ) -> Result<bool, NotTraced> {
        let can_be_off = (!is_needed || group.len() < 2) && self.is_same(group)?;
        if can_be_off {
            self.progress.open = self.progress.open.saturating_sub(group.len());
        } else if let [one] = group {
            self.progress.open = self.progress.open.saturating_sub(1);
            found.insert(*one, true);
        } else {
            let (first, second) = group.split_at(group.len() / 2);
            let is_second = self.needed(first, false, found)?;
            self.needed(second, is_second, found)?;
        }
        Ok(can_be_off)
    }

    /// Switches off as many of a group as can be besides those that are `off`, and adds the others.
    fn together(
        &mut self,
        group: &[usize],
        off: &mut Vec<usize>,
        found: &mut BTreeMap<usize, bool>,
    ) -> Result<(), NotTraced> {
        let both: Vec<usize> = off.iter().chain(group).copied().collect();
        if self.is_same(&both)? {
            *off = both;
        } else if let [one] = group {
            found.insert(*one, false);
        } else {
            let (first, second) = group.split_at(group.len() / 2);
            self.together(first, off, found)?;
            self.together(second, off, found)?;
        }
        Ok(())
    }

    /// Whether the hair is the same without these.
    fn is_same(&mut self, off: &[usize]) -> Result<bool, NotTraced> {
        if off.is_empty() {
            return Ok(true);
        }
        (self.tell)(self.progress);
        if self.cancel.is_cancelled() {
            return Err(NotTraced::Cancelled);
        }
        let off = off.iter().map(|at| &self.parts[*at]);
        let (document, target) = without(self.groom.document, off, self.output);
        // What cannot even be planned gives no hair.
        let Some(target) = target.as_ref().map(std::slice::from_ref) else { return Ok(false) };
        let Ok(mut planned) = plan(&document, target, self.groom.quality, self.groom.files) else {
            return Ok(false);
        };
        self.progress.evaluations += 1;
        planned.allow_large = self.groom.allow_large;
        let outcome = self.evaluator.run(&planned, OnFailure::Stop, self.cancel, &Quiet);
        if outcome.cancelled {
            return Err(NotTraced::Cancelled);
        }
        let value = outcome.targets.first().and_then(Option::as_ref);
        Ok(bits_of(value, self.hair).as_deref() == Some(&self.before))
    }
}

impl fmt::Display for Traced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { output, hair, found, parts, evaluations } = self;
        let found = found.len();
        write!(
            f,
            "hair {hair:016x} of {output}: {found} of {parts} parts made it, found by {evaluations} evaluations"
        )
    }
}

#[cfg(test)]
mod tests;
