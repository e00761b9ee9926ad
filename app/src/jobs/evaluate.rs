//! Evaluating a groom's outputs: from a graph as it is open to curves as files have them.
//!
//! What is wrong on the way to an output is found before anything runs; after that, every node that failed is told. Ends of both
//! kinds carry their exit code.

use super::memory;
use super::open::take_said;
use super::report::{ContentHash, Head, Output, Report};
use super::stop::{Exit, Stop, not_strict};
use coif_graphs::document::graph::{Fault, Severity, check_for, upstream};
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::schedule::budget::{Used, used};
use coif_graphs::schedule::files::{DiskFiles, Files};
use coif_graphs::schedule::plan::Plan;
use coif_graphs::schedule::request::{BadRequest, proven};
use coif_graphs::schedule::result::inputs_hash;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Progress};
use coif_nodes::data::attributes::DRIFT;
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{NodeError, Type, Value, short};
use coif_nodes::eval::{Host, Quality};
use coif_nodes::formats::conform::{Conformed, FEW, conform};
use coif_nodes::formats::export;
use coif_nodes::laws::partings::over_lines;
use coif_nodes::laws::strands::MOST_POINTS;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A graph that can be evaluated for its outputs: edited as the options say, with nothing wrong on the way.
pub(crate) struct Opened {
    pub(crate) document: Document,
    pub(crate) outputs: Vec<OutputRequest>,
    pub(crate) folder: PathBuf,
    pub(crate) graph: String,
    pub(crate) allow_large: bool,
    /// What is over the budget fails.
    pub(crate) holds_budget: bool,
    /// Warnings are errors.
    pub(crate) strict: bool,
}

/// What an evaluation gave.
pub(crate) struct Evaluated {
    /// Each output, as it is written to files.
    pub(crate) groups: Vec<export::HairGroup>,
    /// The heads that the outputs stand on.
    pub(crate) scalps: Vec<Arc<Scalp>>,
    /// Names of the sections that hair may be rooted in, by their ids.
    pub(crate) sections: BTreeMap<u64, String>,
    /// The same heads as each parting on the way to the outputs leaves them.
    #[cfg(feature = "render")]
    pub(crate) parted: Vec<Arc<Scalp>>,
    /// How many strands of the final hair each strand stands for, 1 or more.
    #[cfg(feature = "render")]
    pub(crate) stands_for: f32,
    /// What was asked for besides, in that order.
    pub(crate) more: Vec<Value>,
}

/// What an evaluation computes: the outputs and any other sockets asked for, with the heads and partings upstream of them.
struct Wanted {
    targets: Vec<Socket>,
    heads: Vec<Socket>,
    parted: Vec<Socket>,
}

/// What evaluates, with as many threads as were asked for, and a cache of so many bytes.
pub(crate) fn evaluator(
    asked: usize,
    cache_bytes: usize,
    warnings: &mut Vec<String>,
) -> Result<Evaluator, Stop> {
    // More would only wait for each other; thousands take longer to begin than the work.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = asked.min(cores.max(MOST_THREADS));
    if threads < asked {
        warnings.push(format!(
            "--threads {}: {threads} threads work, for there are {cores} cores",
            asked
        ));
    }
    let evaluator = Evaluator::new(threads, cache_bytes).map_err(Stop::failed)?;
    Ok(evaluator.with_memory(memory::free))
}

/// So many threads are to be had on any machine.
const MOST_THREADS: usize = 4;

impl Opened {
    /// A graph as somebody has it open, with all of its outputs. What is over its budget is told and fails nothing.
    pub(crate) fn of(
        document: Document,
        folder: PathBuf,
        graph: String,
        allow_large: bool,
    ) -> Result<Self, Stop> {
        let outputs = outputs(&document, &[])?;
        let (holds_budget, strict) = (false, false);
        Ok(Self { document, outputs, folder, graph, allow_large, holds_budget, strict })
    }

    /// What its paths are relative to.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Hash of all that it is made from, evaluated `how`; none where a file that it names is not read.
    pub(crate) fn inputs_hash(&self, how: &str) -> Option<String> {
        inputs_hash(&self.document, &self.folder, how)
    }

    /// The mesh file of each head that the outputs and `more` stand on, where it has one, as [`Evaluated::scalps`] lists them.
    #[cfg(feature = "render")]
    pub(crate) fn head_files(&self, more: &[Socket]) -> Vec<Option<PathBuf>> {
        let mut targets: Vec<Socket> = self.outputs.iter().map(|o| o.socket.clone()).collect();
        targets.extend_from_slice(more);
        let heads = of_kind(&self.document, &targets, "head");
        let file =
            |head: &Socket| crate::scene::looks::file_of(&self.document, &self.folder, &head.node);
        heads.iter().map(file).collect()
    }

    fn wanted(&self, more: &[Socket]) -> Wanted {
        let mut targets: Vec<Socket> = self.outputs.iter().map(|o| o.socket.clone()).collect();
        targets.extend_from_slice(more);
        let heads = of_kind(&self.document, &targets, "head");
        let parted = of_kind(&self.document, &targets, "partings");
        Wanted { targets, heads, parted }
    }

    fn proven(
        &self,
        Wanted { targets, heads, parted }: &Wanted,
        quality: Quality,
        files: &dyn Files,
    ) -> Result<Plan, Vec<BadRequest>> {
        let all: Vec<Socket> = targets.iter().chain(heads).chain(parted).cloned().collect();
        proven(&self.document, &all, quality, files)
    }

    /// What an evaluation of the outputs would be refused for before anything ran, but for [`Self::refuse_problems`].
    pub(crate) fn foreseen(&self, files: &dyn Files) -> Vec<BadRequest> {
        self.proven(&self.wanted(&[]), Quality::Final, files).err().unwrap_or_default()
    }

    /// Evaluates the outputs, all of them, on all cores.
    pub(crate) fn evaluate(
        &self,
        quality: Quality,
        cancel: &CancelToken,
        progress: &dyn Progress,
        report: &mut Report,
    ) -> Result<Evaluated, Stop> {
        let evaluator = Evaluator::new(0, 0).map_err(Stop::failed)?.with_memory(memory::free);
        self.evaluate_on(&evaluator, quality, &[], cancel, progress, report)
    }

    /// Evaluates the outputs, and `more` besides.
    pub(crate) fn evaluate_on(
        &self,
        evaluator: &Evaluator,
        quality: Quality,
        more: &[Socket],
        cancel: &CancelToken,
        progress: &dyn Progress,
        report: &mut Report,
    ) -> Result<Evaluated, Stop> {
        let Opened { document, outputs, folder, graph, allow_large, holds_budget, strict } = self;
        let wanted = self.wanted(more);
        let mut plan = self.proven(&wanted, quality, &DiskFiles::new(folder)).map_err(|bad| {
            Stop(Exit::Refused, bad.iter().map(|bad| format!("{graph}: {bad}")).collect())
        })?;
        let Wanted { targets, heads, .. } = wanted;
        plan.allow_large = *allow_large;
        if *holds_budget {
            plan.budget = document.budget;
        }
        let mut outcome = evaluator.run(&plan, OnFailure::Stop, cancel, progress);
        drop(plan);
        report.add_nodes(&outcome.nodes);
        if outcome.cancelled {
            return Err(Stop::interrupted());
        }
        let failures: Vec<(&str, &NodeError)> = outcome
            .nodes
            .iter()
            .filter_map(|node| Some((node.name.as_str(), node.error.as_ref()?)))
            .collect();
        if !failures.is_empty() {
            let refused = failures.iter().any(|(_, err)| {
                matches!(err, NodeError::Refused { .. } | NodeError::Unconnected { .. })
            });
            let lines = failures.iter().map(|(node, err)| format!("{graph}: {node}: {err}"));
            return Err(Stop(if refused { Exit::Refused } else { Exit::Failed }, lines.collect()));
        }
        self.hold_budget(used(&document.budget, &outcome, outputs.len()), report)?;
        let mut scalps: Vec<Arc<Scalp>> = outcome
            .targets
            .split_off(targets.len())
            .into_iter()
            .filter_map(|value| match value {
                Some(Value::Scalp(scalp)) => Some(scalp),
                _ => None,
            })
            .collect();
        let parted = scalps.split_off(heads.len().min(scalps.len()));
        let more = outcome.targets.split_off(outputs.len()).into_iter().flatten().collect();
        report.head =
            heads.first().zip(scalps.first()).map(|(socket, scalp)| head_of(socket, scalp));
        let (mut groups, mut empty) = (vec![], vec![]);
        for (output, value) in outputs.iter().zip(outcome.targets) {
            let Some(Value::Curves(curves)) = value else { continue };
            let host = evaluator.host(cancel);
            let group = output.group(curves, (&scalps, &parted), (&host, cancel), report);
            let group = group.ok_or_else(Stop::interrupted)?;
            match group.curves.curve_count() {
                0 => empty.push(output),
                _ => groups.push(group),
            }
        }
        let gives_none =
            |output: &&OutputRequest| format!("{graph}: {} gives no curves", output.socket);
        match (groups.is_empty(), empty.is_empty()) {
            (true, true) => {
                return Err(Stop::refused(format!("{graph}: no output gives curves")));
            }
            (true, false) => {
                return Err(Stop(Exit::Failed, empty.iter().map(gives_none).collect()));
            }
            // Such as bands that are not wound.
            (false, _) => report.warnings.extend(empty.iter().map(|output| {
                let OutputRequest { socket, group, .. } = output;
                format!("{socket} gives no curves: files have no group {:?}", short(group))
            })),
        }
        let hair = groups.iter().filter(|group| !group.guides);
        report.warnings.extend(too_many(hair.map(|group| group.curves.point_count()).sum()));
        if *strict && !report.warnings.is_empty() {
            return Err(Stop(Exit::Failed, vec![not_strict(graph)]));
        }
        let sections = section_names(&parted);
        Ok(Evaluated {
            groups,
            scalps,
            sections,
            #[cfg(feature = "render")]
            parted,
            #[cfg(feature = "render")]
            stands_for: coif_graphs::schedule::result::stands_for(&outcome.nodes),
            more,
        })
    }
}

impl Opened {
    /// Notes what was used of the budget, and fails where it is over and held.
    fn hold_budget(&self, used: Vec<Used>, report: &mut Report) -> Result<(), Stop> {
        let over: Vec<String> =
            used.iter().filter(|used| used.is_over()).map(ToString::to_string).collect();
        if !self.holds_budget && !used.is_empty() {
            let what =
                if over.is_empty() { "nothing is over it".to_owned() } else { over.join("; ") };
            report.notes.push(format!("{}: its budget is not held: {what}", self.graph));
        }
        report.budget.extend(used.into_iter().map(Into::into));
        if !self.holds_budget || over.is_empty() {
            return Ok(());
        }
        let line = |over| {
            format!("{}: {over}: ask for less there, or raise it, or --no-budget", self.graph)
        };
        Err(Stop(Exit::Failed, over.into_iter().map(line).collect()))
    }
}

impl OutputRequest {
    /// The output's curves as files have them; none where somebody asked to stop.
    fn group(
        &self,
        curves: Curves,
        (scalps, parted): (&[Arc<Scalp>], &[Arc<Scalp>]),
        (host, cancel): (&dyn Host, &CancelToken),
        report: &mut Report,
    ) -> Option<export::HairGroup> {
        // The skin that keeps points added by export outside: of the only head, if there is one.
        let skin = match scalps {
            [only] => only.skin().for_hair(),
            _ => None,
        };
        let Conformed { curves: conformed, changes } =
            conform(&curves, skin, parted, self.guides, host)?;
        drop(curves);
        let socket = &self.socket;
        if changes.left_out > 0 {
            report.warnings.push(format!(
                "{socket}: {} curves of fewer than 2 points were left out",
                changes.left_out
            ));
        }
        if changes.astray > 0 {
            let (all, out) = (changes.astray, changes.astray_left_out);
            let way = "on which all tools read one shape, or none but over a parting";
            report.warnings.push(match all - out {
                0 => format!("{socket}: {all} curves find no way out of the skin {way}; they were left out"),
                kept if out == 0 => {
                    format!("{socket}: {kept} curves find no way out of the skin {way}; they were kept")
                }
                kept => format!(
                    "{socket}: {out} curves that lie in the skin and find no way out of it were left out; {kept} more find none {way}, \
                     and were kept"
                ),
            });
        }
        let curves = conformed;
        if !self.guides {
            let [over, looked] = over_lines(&curves, parted, LOOKED_AT, host)?;
            // Single hairs are no fault: one in a thousand is left out of files for less.
            if over * FEW > looked {
                report.warnings.push(format!(
                    "{socket}: {over} of {looked} hairs that were looked at lead over a parting; coif measure counts all where the \
                     partings are written with them, as guides"
                ));
            }
        }
        report.outputs.push(Output {
            node: socket.node.to_string(),
            socket: socket.name.to_string(),
            group: self.group.clone(),
            curves: curves.curve_count(),
            points: curves.point_count(),
            bounds: curves.bounds().map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
            hash: ContentHash::of(&curves, cancel),
            resampled: changes.resampled,
            moved: changes.moved,
            farthest_cm: changes.farthest,
            reading_difference: changes.difference,
            root_drift_cm: root_drift(&curves),
        });
        Some(export::HairGroup { name: self.group.clone(), guides: self.guides, curves })
    }
}

/// What there is to say of so many points of hair.
fn too_many(points: usize) -> Option<String> {
    (points > MOST_POINTS).then(|| {
        format!(
            "the hair has {:.1} million points, and a groom is to have 16 at most: ask for fewer strands, or for fewer points on \
             each",
            points as f64 / 1e6
        )
    })
}

/// One hair in so many is looked at for partings.
const LOOKED_AT: usize = 16;

/// Middle and largest drift of the curves that were drawn.
fn root_drift(curves: &Curves) -> Option<[f32; 2]> {
    let drawn = curves.tufts().iter().filter(|tuft| tuft.attribute(DRIFT.name).is_some());
    let each = |tuft: &Arc<Tuft>| {
        let drift = tuft.view(DRIFT);
        (0..tuft.len()).map(|i| drift.at(i, tuft.range(i).start)).collect::<Vec<f32>>()
    };
    let mut all: Vec<f32> = drawn.flat_map(each).collect();
    all.sort_by(f32::total_cmp);
    Some([*all.get(all.len() / 2)?, *all.last()?])
}

fn head_of(socket: &Socket, scalp: &Scalp) -> Head {
    let frame = scalp.frame();
    Head {
        node: socket.node.to_string(),
        scale: scalp.cm_per_unit(),
        radius_cm: frame.radius,
        length_factor: frame.unit(),
        origin: frame.origin.to_array(),
        up: frame.up.to_array(),
        forward: frame.forward.to_array(),
        triangles: scalp.surface().triangles.len(),
    }
}

/// One output to be given.
pub(crate) struct OutputRequest {
    pub(crate) socket: Socket,
    pub(crate) group: String,
    pub(crate) guides: bool,
}

/// The named outputs, or those of every `groom_output`.
pub(crate) fn outputs(document: &Document, named: &[String]) -> Result<Vec<OutputRequest>, Stop> {
    if named.is_empty() {
        let all: Vec<OutputRequest> = document
            .nodes
            .iter()
            .filter(|(_, node)| node.kind == "groom_output")
            .map(|(id, _)| wanted(document, Socket::new(id.clone(), "curves")))
            .collect();
        if all.is_empty() {
            return Err(Stop::refused(
                "the graph has no groom_output node; add one, or name an output with --output NODE.SOCKET",
            ));
        }
        return Ok(all);
    }
    named
        .iter()
        .map(|text| {
            let fault =
                |reason: String| Stop::refused(format!("--output {}: {reason}", short(text)));
            let socket: Socket = text.parse().map_err(|err| fault(format!("{err}")))?;
            let node = document.node(socket.node.as_str()).ok_or_else(|| {
                fault(format!("there is no node {:?}", short(socket.node.as_str())))
            })?;
            let def = document
                .def(&socket.node)
                .ok_or_else(|| fault(format!("its kind {:?} is not known", node.kind)))?;
            let known: Vec<&str> = def.outputs.iter().map(|o| o.name).collect();
            match def.output(&socket.name) {
                None => Err(fault(format!(
                    "{} has no such output; it gives {}",
                    def.with_article(),
                    known.join(", ")
                ))),
                Some((_, out)) if out.ty != Type::Curves => {
                    Err(fault(format!("gives {}, not curves", out.ty.name())))
                }
                Some(_) => Ok(wanted(document, socket)),
            }
        })
        .collect()
}

/// What there is to say of a node that leads to no output.
pub(crate) fn nowhere(id: &NodeId) -> String {
    format!("{id}: leads to no output: nothing of it is in the groom; wire it, or remove it")
}

fn wanted(document: &Document, socket: Socket) -> OutputRequest {
    let node = document.node(socket.node.as_str());
    let output = node.filter(|node| node.kind == "groom_output");
    let set = |name: &str| output.and_then(|node| node.inputs.get(name));
    let group = match set("name") {
        Some(Setting::Known(Value::Text(name))) if !name.is_empty() => name.to_string(),
        _ => {
            let label = output.and_then(|node| node.label.clone());
            label.unwrap_or_else(|| socket.node.to_string())
        }
    };
    let guides = matches!(set("guides"), Some(Setting::Known(Value::Bool(true))));
    OutputRequest { socket, group, guides }
}

impl Opened {
    /// Ends with every error on the way to an output or to `more`; problems elsewhere are warnings.
    pub(crate) fn refuse_problems(
        &self,
        more: &[Socket],
        warnings: &mut Vec<String>,
    ) -> Result<(), Stop> {
        let targets = self.outputs.iter().map(|o| &o.socket).chain(more);
        let targets = targets.map(|socket| socket.node.clone()).collect();
        let mut errors = vec![];
        for problem in check_for(&self.document, &targets).into_iter().filter(|p| p.needed) {
            // The node clamps such a value and says so itself, where it comes to run.
            let is_warning = problem.severity == Severity::Warning;
            if is_warning && problem.fault == Fault::OutOfRange && !self.strict {
                continue;
            }
            let problem = problem.to_string();
            let told = match take_said(warnings, &self.graph, &problem) {
                Some(at) => format!("{at}: {problem}"),
                None => problem,
            };
            if is_warning { warnings.push(told) } else { errors.push(told) }
        }
        if errors.is_empty() && self.strict && !warnings.is_empty() {
            errors.push(not_strict(&self.graph));
        }
        if errors.is_empty() { Ok(()) } else { Err(Stop(Exit::Refused, errors)) }
    }
}

/// Names of sections by id. Where a section goes on through several cuts, it is called as the last calls it.
fn section_names(parted: &[Arc<Scalp>]) -> BTreeMap<u64, String> {
    let mut all: Vec<_> = parted.iter().filter_map(|scalp| scalp.sections()).collect();
    all.sort_by_key(|sections| sections.partings().len());
    let sections = all.iter().flat_map(|sections| sections.list());
    sections.map(|section| (section.id, section.name.clone())).collect()
}

/// The scalps that nodes of a kind give the targets: `head` those that they stand on, `partings` those that are parted.
fn of_kind(document: &Document, targets: &[Socket], kind: &str) -> Vec<Socket> {
    upstream(document, targets.iter().map(|t| &t.node))
        .into_iter()
        .filter(|id| document.node(id.as_str()).is_some_and(|n| n.kind == kind))
        .map(|id| Socket::new(id, "scalp"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_points_than_a_groom_is_to_have_are_told() {
        assert_eq!(too_many(MOST_POINTS), None);
        let said = too_many(18_240_000).unwrap();
        assert!(said.starts_with("the hair has 18.2 million points"), "{said}");
    }
}
