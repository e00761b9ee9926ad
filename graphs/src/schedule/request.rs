//! From a document and what is wanted of it to a plan.
//!
//! Only what the targets need enters the plan; the rest of the document may be broken. Files are read here, so that a
//! missing mesh is found before anything runs.

use super::files::Files;
use super::foreseen::foreseen;
use super::plan::{Plan, Source, Step};
use crate::document::budget::Budget;
use crate::document::{Document, Node, NodeId, Setting, Socket, graph};
use crate::values;
use coif_nodes::declared::{self, Port};
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
    let (plan, refused) = plan_possible(document, targets, quality, files);
    match refused.into_iter().flatten().next() {
        Some(bad) => Err(bad),
        None => Ok(plan),
    }
}

/// The same plan, when its nodes, too, refuse nothing that is known before they run ([`foreseen`]). Whoever says whether a document
/// can be evaluated asks this, so that all say the same.
///
/// # Errors
/// As [`plan`]; else everything that its nodes will refuse.
pub fn proven(
    document: &Document,
    targets: &[Socket],
    quality: Quality,
    files: &dyn Files,
) -> Result<Plan, Vec<BadRequest>> {
    let plan = plan(document, targets, quality, files).map_err(|bad| vec![bad])?;
    let refused = foreseen(&plan);
    if refused.is_empty() { Ok(plan) } else { Err(refused) }
}

/// The plan that gives as many of `targets` as can be given, in their order, and for each target why it
/// cannot, or none where it is in the plan. For the editor, where a broken node aside does not stop
/// the display.
pub fn plan_possible(
    document: &Document,
    targets: &[Socket],
    quality: Quality,
    files: &dyn Files,
) -> (Plan, Vec<Option<BadRequest>>) {
    let mut planner =
        Planner { document, files, known: BTreeMap::new(), steps: vec![], has_groups: false };
    let found: Vec<Result<(usize, usize), BadRequest>> =
        targets.iter().map(|target| planner.target(target)).collect();
    let mut plan = Plan {
        seed: document.seed,
        quality,
        allow_large: false,
        budget: Budget::default(),
        steps: planner.steps,
        targets: found.iter().flatten().copied().collect(),
    };
    // What is wired to a group may feed nothing in it.
    if plan.targets.len() < targets.len() || planner.has_groups {
        drop_unneeded(&mut plan);
    }
    (plan, found.into_iter().map(Result::err).collect())
}

/// Leaves the steps that targets need.
fn drop_unneeded(plan: &mut Plan) {
    let mut needed = vec![false; plan.steps.len()];
    plan.targets.iter().for_each(|(step, _)| needed[*step] = true);
    // From the last on: a step's wires lead to earlier ones only.
    for i in (0..plan.steps.len()).rev() {
        if needed[i] {
            plan.steps[i].wires().for_each(|step| needed[step] = true);
        }
    }
    let mut numbers = vec![0; plan.steps.len()];
    let kept = numbers.iter_mut().zip(&needed).filter(|(_, needed)| **needed);
    kept.enumerate().for_each(|(new, (number, _))| *number = new);
    let steps = std::mem::take(&mut plan.steps).into_iter().zip(needed);
    plan.steps = steps.filter(|(_, needed)| *needed).map(|(step, _)| step).collect();
    for source in plan.steps.iter_mut().flat_map(|step| &mut step.inputs).flatten() {
        if let Source::Wire { step, .. } = source {
            *step = numbers[*step];
        }
    }
    plan.targets.iter_mut().for_each(|(step, _)| *step = numbers[*step]);
}

fn unknown_kind(id: &NodeId, kind: &str) -> BadRequest {
    bad(id, format!("this version of coif knows no node of kind {kind:?}"))
}

fn unknown_input(id: &NodeId, def: &coif_nodes::define::NodeDef, name: &str) -> BadRequest {
    let known: Vec<&str> = def.inputs.iter().map(|i| i.name).collect();
    bad(id, format!("has no input {name:?}; {} has {}", def.with_article(), known.join(", ")))
}

/// What is known of a node.
enum Known {
    /// Its sources are looked at: meeting it again is a circle.
    Visited,
    /// It is this step.
    Step(usize),
    /// It is not run: each of its outputs comes from elsewhere.
    Through(BTreeMap<&'static str, Result<Led, BadRequest>>),
    /// It cannot be, or something that it needs cannot.
    Bad(BadRequest),
}

/// The most wires that lead to one port: borders of groups could double them at each step.
const MOST_LED: usize = 10_000;

/// What an output of a group, of its border or of parameters comes from: nothing, one, or many where many are taken.
#[derive(Clone)]
struct Led {
    from: Vec<(Source, Type)>,
}

/// Steps in an order in which each comes after what it reads.
struct Planner<'a> {
    document: &'a Document,
    files: &'a dyn Files,
    known: BTreeMap<NodeId, Known>,
    steps: Vec<Step>,
    has_groups: bool,
}

impl Planner<'_> {
    /// Step and output of a target, planned with all that it needs.
    fn target(&mut self, target: &Socket) -> Result<(usize, usize), BadRequest> {
        self.visit(&target.node);
        match &self.output(target)?[..] {
            [(Source::Wire { step, output }, _)] => Ok((*step, *output)),
            [] => Err(bad(
                &target.node,
                format!("{} gives nothing: nothing leads to it", target.name),
            )),
            [(Source::Value(_), _)] => {
                Err(bad(&target.node, format!("{} is a value, not hair or a head", target.name)))
            }
            many => {
                let count = many.len();
                Err(bad(&target.node, format!("{} is {count} wires: merge them", target.name)))
            }
        }
    }

    /// Walks upstream without recursion: a chain may be as long as a document allows.
    fn visit(&mut self, target: &NodeId) {
        let mut stack = vec![(target.clone(), false)];
        while let Some((id, sources_done)) = stack.pop() {
            if sources_done {
                if let Some(through) = self.through(&id) {
                    self.has_groups = true;
                    self.known.insert(id, Known::Through(through));
                    continue;
                }
                let known = match self.step(&id) {
                    Ok(step) => {
                        self.steps.push(step);
                        Known::Step(self.steps.len() - 1)
                    }
                    Err(bad) => Known::Bad(bad),
                };
                self.known.insert(id, known);
                continue;
            }
            if self.known.contains_key(&id) {
                continue;
            }
            if !self.document.nodes.contains_key(&id) {
                let missing = Known::Bad(bad(&id, "there is no node of that id"));
                self.known.insert(id, missing);
                continue;
            }
            self.known.insert(id.clone(), Known::Visited);
            let sources: Vec<&NodeId> = graph::all_feeders(self.document, &id).collect();
            stack.push((id, true));
            let new = sources.into_iter().rev().filter(|from| !self.known.contains_key(*from));
            stack.extend(new.map(|from| (from.clone(), false)));
        }
    }

    /// What an output of a node that was visited comes from: itself, or where a group leads to.
    fn output(&self, socket: &Socket) -> Result<Vec<(Source, Type)>, BadRequest> {
        let step = match self.known.get(&socket.node) {
            Some(Known::Step(step)) => *step,
            Some(Known::Through(outputs)) => {
                let known = || outputs.keys().copied().collect::<Vec<_>>().join(", ");
                let found = outputs.get(&*socket.name).cloned().unwrap_or_else(|| {
                    let name = &*socket.name;
                    Err(bad(&socket.node, format!("has no output {name:?}; it gives {}", known())))
                });
                return found.map(|led| led.from);
            }
            Some(Known::Bad(bad)) => return Err(bad.clone()),
            Some(Known::Visited) | None => return Err(bad(&socket.node, "is wired in a circle")),
        };
        let def = self.steps[step].def;
        let found = def.output(&socket.name).ok_or_else(|| {
            let known: Vec<&str> = def.outputs.iter().map(|o| o.name).collect();
            let (name, known) = (&*socket.name, known.join(", "));
            bad(
                &socket.node,
                format!("has no output {name:?}; {} gives {known}", def.with_article()),
            )
        })?;
        Ok(vec![(Source::Wire { step, output: found.0 }, found.1.ty)])
    }

    /// Where each output of a group, of its border or of parameters leads to; none for nodes that run.
    fn through(&self, id: &NodeId) -> Option<BTreeMap<&'static str, Result<Led, BadRequest>>> {
        let node = self.document.node(id.as_str())?;
        let group = id.group();
        let outputs =
            |ports: &'static [Port], one: &dyn Fn(&'static Port) -> Result<Led, BadRequest>| {
                Some(ports.iter().map(|port| (port.name.as_str(), one(port))).collect())
            };
        let interface = node.interface.unwrap_or_default();
        match node.kind.as_str() {
            declared::GROUP if node.bypass => outputs(interface.outputs(), &|port| {
                let same = interface.inputs().iter().filter(|input| input.ty == port.ty);
                for input in same {
                    let led = self.led(id, node, input)?;
                    if !led.from.is_empty() {
                        return Ok(led);
                    }
                }
                Err(bad(
                    id,
                    format!("is bypassed, and nothing that comes in is {}", port.ty.name()),
                ))
            }),
            declared::GROUP => outputs(interface.outputs(), &|port| {
                let out = self.document.outputs_of(id);
                let out = out.ok_or_else(|| {
                    bad(id, "nothing in it says what it gives: add a group_output")
                })?;
                let inside =
                    self.document.node(out.as_str()).ok_or_else(|| bad(out, "is not there"))?;
                self.led(out, inside, &Port { default: None, ..port.clone() })
            }),
            declared::GROUP_INPUT => {
                let group = group.as_ref()?;
                let outside = self.document.node(group.as_str()).filter(|node| node.is_group())?;
                let ports = outside.interface.unwrap_or_default().inputs();
                outputs(ports, &|port| self.led(group, outside, port))
            }
            declared::GROUP_OUTPUT => Some(BTreeMap::new()),
            declared::PARAMETERS => outputs(interface.inputs(), &|port| self.led(id, node, port)),
            _ => None,
        }
    }

    /// What comes in by a port of a node: what is wired to it, else what it is set to, else its default.
    fn led(&self, id: &NodeId, node: &Node, port: &Port) -> Result<Led, BadRequest> {
        let wires = self.document.wires(id, &port.name);
        if !wires.is_empty() {
            let mut from = vec![];
            for socket in wires {
                for (source, ty) in self.output(socket)? {
                    from.push((fitting(id, &port.name, port.ty, socket, (source, ty))?, port.ty));
                }
            }
            if from.len() > MOST_LED {
                let count = from.len();
                return Err(bad(
                    id,
                    format!("{count} wires lead to {}: merge some before", port.name),
                ));
            }
            if from.len() > 1 && port.arity != Arity::Many {
                return Err(bad(id, format!("{} takes one wire, not {}", port.name, from.len())));
            }
            return Ok(Led { from });
        }
        let set = match node.inputs.get(&port.name) {
            Some(setting) => self.value(id, &port.name, port.ty, setting)?,
            None => match &port.default {
                Some(value) => {
                    self.value(id, &port.name, port.ty, &Setting::Known(value.clone()))?
                }
                None => None,
            },
        };
        let clamped = set.map(|source| match source {
            Source::Value(value) => Source::Value(port.clamped(value)),
            wire => wire,
        });
        Ok(Led { from: clamped.into_iter().map(|source| (source, port.ty)).collect() })
    }

    /// The step of a node whose sources were visited.
    fn step(&self, id: &NodeId) -> Result<Step, BadRequest> {
        let node = &self.document.nodes[id];
        let def = coif_nodes::by_id(&node.kind).ok_or_else(|| unknown_kind(id, &node.kind))?;
        let mut inputs: Vec<Vec<Source>> = vec![vec![]; def.inputs.len()];
        for (name, setting) in &node.inputs {
            let (at, input) = def.input(name).ok_or_else(|| unknown_input(id, def, name))?;
            inputs[at] = self.value(id, name, input.ty, setting)?.into_iter().collect();
        }
        for (to, from) in graph::inputs_of(self.document, id) {
            let (at, input) =
                def.input(&to.name).ok_or_else(|| unknown_input(id, def, &to.name))?;
            inputs[at].clear();
            for socket in from {
                for led in self.output(socket)? {
                    inputs[at].push(fitting(id, &to.name, input.ty, socket, led)?);
                }
            }
            let count = from.len().max(inputs[at].len());
            if input.arity != Arity::Many && count > 1 {
                return Err(bad(id, format!("{} takes one wire, not {count}", to.name)));
            }
        }
        Ok(Step { name: id.to_string(), def, bypass: node.bypass, inputs })
    }

    /// What an input is set to, with its file read; none where no file is named.
    fn value(
        &self,
        id: &NodeId,
        name: &str,
        ty: Type,
        setting: &Setting,
    ) -> Result<Option<Source>, BadRequest> {
        let value = match setting {
            Setting::Known(value) => value.clone(),
            Setting::Raw(text) => {
                return Err(bad(id, format!("{name}: {text} is no {}", ty.name())));
            }
        };
        if let Some(fault) = value.fault() {
            return Err(bad(id, format!("{name}: {fault}")));
        }
        let value = match (ty, &value) {
            (Type::File, Value::Text(path)) if path.is_empty() => return Ok(None),
            (Type::File, Value::Text(path)) => {
                let read = self.files.read(path);
                Value::File(read.map_err(|reason| bad(id, format!("{name}: {path}: {reason}")))?)
            }
            _ => value,
        };
        Ok(Some(Source::Value(value)))
    }
}

/// What leads to an input, as it takes it.
fn fitting(
    id: &NodeId,
    name: &str,
    takes: Type,
    from: &Socket,
    (source, gives): (Source, Type),
) -> Result<Source, BadRequest> {
    if !gives.fits(takes) {
        let (takes, gives) = (takes.name(), gives.name());
        return Err(bad(id, format!("{name} takes {takes}, but {from} gives {gives}")));
    }
    match source {
        Source::Value(value) if takes != Type::File => {
            let fitted = values::fit(takes, value);
            fitted.map(Source::Value).map_err(|why| bad(id, format!("{name}: {why}")))
        }
        source => Ok(source),
    }
}

#[cfg(test)]
mod tests {
    use super::super::files::DiskFiles;
    use super::*;
    use crate::document::testing::Random;
    use expect_test::expect;

    const TEXT: &str = r#"(format: 1, nodes: {
        "head": (kind: "head"), "rows": (kind: "stroke_input"), "thin": (kind: "resample"),
        "lost": (kind: "head", inputs: {"mesh": "no/such.obj"}), "on": (kind: "scatter_guides"),
        "loop": (kind: "resample"), "back": (kind: "resample"), "hung": (kind: "resample"),
        "new": (kind: "of_tomorrow"), "old": (kind: "resample"), "all": (kind: "merge"),
        "raw": (kind: "resample", inputs: {"count": Many}), "wrong": (kind: "resample"),
    }, links: {
        "rows.scalp": "head.scalp", "thin.curves": "rows.curves", "on.scalp": "lost.scalp",
        "loop.curves": "back.curves", "back.curves": "loop.curves", "hung.curves": "back.curves",
        "old.curves": "new.out", "all.curves": ["thin.curves", "hung.curves"],
        "raw.curves": "rows.curves", "wrong.curves": "head.scalp",
    })"#;

    fn sockets(text: &str) -> Vec<Socket> {
        text.split_whitespace().map(|text| text.parse().unwrap()).collect()
    }

    #[test]
    fn what_can_be_planned_is_and_the_rest_says_why_not() {
        let document = crate::file::read(TEXT).unwrap().document;
        let targets = sockets(
            "all.curves rows.curves on.curves hung.curves old.curves thin.curves raw.curves gone.x \
             head.nose wrong.curves back.curves loop.curves new.out lost.scalp head.scalp",
        );
        let files = DiskFiles::default();
        let (plan, refused) = plan_possible(&document, &targets, Quality::Final, &files);
        let said = targets.iter().zip(&refused).map(|(target, refused)| match refused {
            Some(why) => format!("{target}: {why}"),
            None => format!("{target} is planned"),
        });
        expect![[r#"
            all.curves: back: is wired in a circle
            rows.curves is planned
            on.curves: lost: mesh: no/such.obj: no such file
            hung.curves: back: is wired in a circle
            old.curves: new: this version of coif knows no node of kind "of_tomorrow"
            thin.curves is planned
            raw.curves: raw: count: Many is no whole number
            gone.x: gone: there is no node of that id
            head.nose: head: has no output "nose"; a head gives scalp
            wrong.curves: wrong: curves takes curves, but head.scalp gives scalp
            back.curves: back: is wired in a circle
            loop.curves: back: is wired in a circle
            new.out: new: this version of coif knows no node of kind "of_tomorrow"
            lost.scalp: lost: mesh: no/such.obj: no such file
            head.scalp is planned"#]]
        .assert_eq(&said.collect::<Vec<_>>().join("\n"));
        let steps: Vec<&str> = plan.steps.iter().map(|step| step.name.as_str()).collect();
        assert_eq!(steps, ["head", "rows", "thin"]);
        assert_eq!(plan.targets, [(1, 0), (2, 0), (0, 0)]);
        let whole = super::plan(&document, &targets, Quality::Final, &files);
        assert_eq!(whole.err(), refused[0].clone());
    }

    #[test]
    fn a_target_is_planned_alone_as_it_is_among_broken_ones() {
        let files = DiskFiles::default();
        for seed in 0..100 {
            let document = Random::new(seed).document();
            let targets: Vec<Socket> =
                document.nodes.keys().map(|id| Socket::new(id.clone(), "curves")).collect();
            let (plan, refused) = plan_possible(&document, &targets, Quality::Final, &files);
            for (i, step) in plan.steps.iter().enumerate() {
                let wires = step.inputs.iter().flatten().filter_map(|source| match source {
                    Source::Wire { step, .. } => Some(*step),
                    Source::Value(_) => None,
                });
                assert!(wires.into_iter().all(|step| step < i));
            }
            let mut planned = plan.targets.iter();
            for (target, refused) in targets.iter().zip(&refused) {
                let alone =
                    super::plan(&document, std::slice::from_ref(target), Quality::Final, &files);
                assert_eq!(alone.is_err(), refused.is_some(), "seed {seed} {target}");
                if let Ok(alone) = alone {
                    let name = |plan: &Plan, step: usize| plan.steps[step].name.clone();
                    let (step, _) = planned.next().unwrap();
                    assert_eq!(name(&plan, *step), name(&alone, alone.targets[0].0));
                }
            }
        }
    }
}
