//! From a document and what is wanted of it to a plan.
//!
//! Only what the targets need enters the plan; the rest of the document may be broken. Files are read here, so that a
//! missing mesh is found before anything runs.

use super::files::Files;
use super::plan::{Plan, Source, Step};
use crate::document::{Document, NodeId, Setting, Socket};
use coif_nodes::define::{Arity, Type, Value};
use coif_nodes::eval::Quality;
use std::collections::BTreeMap;

/// Why a document cannot be evaluated for some targets. One line for a person: node, input, what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{node}: {reason}")]
pub struct BadRequest {
    /// The node.
    pub node: String,
    /// What is wrong, and what to do.
    pub reason: String,
}

fn bad(node: &NodeId, reason: impl Into<String>) -> BadRequest {
    BadRequest { node: node.to_string(), reason: reason.into() }
}

/// The plan that gives `targets` (outputs of nodes).
///
/// # Errors
/// The first thing on the way to a target that cannot be: an unknown node, kind, input or output, a wire of the wrong type, a
/// cycle, a value that is no value, a file that cannot be read.
pub fn plan(
    document: &Document,
    targets: &[Socket],
    quality: Quality,
    files: &dyn Files,
) -> Result<Plan, BadRequest> {
    let mut order = Order { document, numbers: BTreeMap::new(), order: vec![] };
    for target in targets {
        order.visit(&target.node)?;
    }
    let Order { numbers, order, .. } = order;
    let number = |id: &NodeId| match numbers.get(id) {
        Some(Some(number)) => Ok(*number),
        _ => Err(bad(id, "is wired in a circle")),
    };
    let output = |socket: &Socket| {
        let step = number(&socket.node)?;
        let node = &document.nodes[&socket.node];
        let def =
            coif_nodes::by_id(&node.kind).ok_or_else(|| unknown_kind(&socket.node, &node.kind))?;
        let found = def.output(&socket.name).ok_or_else(|| {
            let known: Vec<&str> = def.outputs.iter().map(|o| o.name).collect();
            bad(
                &socket.node,
                format!(
                    "has no output {:?}; a {} gives {}",
                    &*socket.name,
                    def.id,
                    known.join(", ")
                ),
            )
        })?;
        Ok((step, found.0, found.1.ty))
    };
    let mut steps = vec![];
    for id in &order {
        let node = &document.nodes[id];
        let def = coif_nodes::by_id(&node.kind).ok_or_else(|| unknown_kind(id, &node.kind))?;
        let mut inputs: Vec<Vec<Source>> = vec![vec![]; def.inputs.len()];
        for (name, setting) in &node.inputs {
            let (at, input) = def.input(name).ok_or_else(|| unknown_input(id, def, name))?;
            let value = match setting {
                Setting::Known(value) => value.clone(),
                Setting::Raw(text) => {
                    return Err(bad(id, format!("{name}: {text} is no {}", input.ty.name())));
                }
            };
            if let Some(fault) = value.fault() {
                return Err(bad(id, format!("{name}: {fault}")));
            }
            inputs[at] = match (input.ty, &value) {
                (Type::File, Value::Text(path)) if path.is_empty() => vec![],
                (Type::File, Value::Text(path)) => {
                    let file = files
                        .read(path)
                        .map_err(|reason| bad(id, format!("{name}: {path}: {reason}")))?;
                    vec![Source::Value(Value::File(file))]
                }
                _ => vec![Source::Value(value)],
            };
        }
        for (to, from) in document.links.iter().filter(|(to, _)| to.node == *id) {
            let (at, input) =
                def.input(&to.name).ok_or_else(|| unknown_input(id, def, &to.name))?;
            if input.arity != Arity::Many && from.len() > 1 {
                return Err(bad(id, format!("{} takes one wire, not {}", to.name, from.len())));
            }
            inputs[at].clear();
            for socket in from {
                let (step, output, ty) = output(socket)?;
                if !ty.fits(input.ty) {
                    return Err(bad(
                        id,
                        format!(
                            "{} takes {}, but {socket} gives {}",
                            to.name,
                            input.ty.name(),
                            ty.name()
                        ),
                    ));
                }
                inputs[at].push(Source::Wire { step, output });
            }
        }
        steps.push(Step { name: id.to_string(), def, bypass: node.bypass, inputs });
    }
    let targets = targets
        .iter()
        .map(|target| output(target).map(|(step, output, _)| (step, output)))
        .collect::<Result<_, _>>()?;
    Ok(Plan { seed: document.seed, quality, steps, targets })
}

fn unknown_kind(id: &NodeId, kind: &str) -> BadRequest {
    bad(id, format!("this version of coif knows no node of kind {kind:?}"))
}

fn unknown_input(id: &NodeId, def: &coif_nodes::define::NodeDef, name: &str) -> BadRequest {
    let known: Vec<&str> = def.inputs.iter().map(|i| i.name).collect();
    bad(id, format!("has no input {name:?}; a {} has {}", def.id, known.join(", ")))
}

/// Nodes in an order in which each comes after what it reads.
struct Order<'a> {
    document: &'a Document,
    /// None while a node's sources are visited: meeting it again is a circle.
    numbers: BTreeMap<NodeId, Option<usize>>,
    order: Vec<NodeId>,
}

impl Order<'_> {
    /// Walks upstream without recursion: a chain may be as long as a document allows.
    fn visit(&mut self, target: &NodeId) -> Result<(), BadRequest> {
        let mut stack = vec![(target.clone(), false)];
        while let Some((id, sources_done)) = stack.pop() {
            if sources_done {
                self.numbers.insert(id.clone(), Some(self.order.len()));
                self.order.push(id);
                continue;
            }
            match self.numbers.get(&id) {
                Some(Some(_)) => continue,
                Some(None) => return Err(bad(&id, "is wired in a circle")),
                None => {}
            }
            if !self.document.nodes.contains_key(&id) {
                return Err(bad(&id, "there is no node of that id"));
            }
            self.numbers.insert(id.clone(), None);
            stack.push((id.clone(), true));
            let wires = self.document.links.iter().filter(|(to, _)| to.node == id);
            for from in wires.flat_map(|(_, from)| from).rev() {
                match self.numbers.get(&from.node) {
                    Some(Some(_)) => {}
                    Some(None) => return Err(bad(&from.node, "is wired in a circle")),
                    None => stack.push((from.node.clone(), false)),
                }
            }
        }
        Ok(())
    }
}
