//! `coif fit`: a groom onto another head, by landmarks.
//!
//! The graph is evaluated on its own head and on the other one, what moved is measured, and a new graph is written: the head node
//! has the other mesh and the landmarks of its home, or, baked, everything that is given in head units is in those of the new head.
//!
//! Guarantees: the graph that is read stays as it is; nothing is written unless both evaluations went well. Not promised: that a
//! groom looks as well on any head; the report says what was lost, missed or split.

pub(crate) mod figures;

use super::Exit;
use super::carry_out::carry_out;
use super::given::apply_scalp;
use super::groom::QualityArg;
use super::progress::Bar;
use crate::files::Together;
use crate::jobs::evaluate::{Evaluated, Opened};
use crate::jobs::memory;
use crate::jobs::open::writes_all;
use crate::jobs::open::{load, reads_all};
use crate::jobs::report::Fit;
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use crate::library::bake::bake;
use clap::Args;
use coif_graphs::document::graph::upstream;
use coif_graphs::document::{Document, Node, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::landmarks::{Landmark, Landmarks};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{Type, Value};
use coif_nodes::eval::Quality;
use figures::FitResult;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Args)]
pub(crate) struct FitArgs {
    /// The graph: a .ron file, or the name of a shipped groom
    graph: PathBuf,
    /// The mesh of the other head, for the graph's one head node or for NODE; `builtin` is the built-in head
    #[arg(long, value_name = "[NODE=]FILE")]
    head: String,
    /// Where landmarks of the other head are, instead of where they are guessed, such as "crown 0 8.3 -3.9; chin 0 -10 7.3"
    #[arg(long, value_name = "TEXT", default_value = "")]
    landmarks: String,
    /// The graph to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write the figures, and what happened on the new head, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
    /// Write everything in units of the new head, with no map left
    #[arg(long)]
    bake: bool,
    /// Number of threads; 0: one for each core
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    threads: usize,
    /// Also make more than 16 million points, as many as memory holds
    #[arg(long)]
    allow_large: bool,
    /// How much hair is made for the figures
    #[arg(long, value_enum, default_value_t = QualityArg::Final)]
    quality: QualityArg,
}

pub(crate) fn run(args: &FitArgs) -> Exit {
    carry_out(
        &args.graph,
        args.report.as_deref(),
        "graph",
        false,
        |cancel, report, files| fit(args, cancel, report, files),
        |report| summary(report, &args.out),
    )
}

fn fit(
    args: &FitArgs,
    cancel: &CancelToken,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    writes_all([args.out.clone()], files)?;
    let (document, folder) = load(&args.graph, &mut report.warnings)?;
    reads_all(&document, &folder, files)?;
    report.seed = document.seed;
    let mut there = document.clone();
    let head = apply_scalp(&mut there, "--head", &args.head)?;
    let out_folder = folder_of(&args.out)?;
    rebase(&mut there, &folder_of(&folder.join("x"))?, &out_folder);
    let (_, faults) = Landmarks::parse(&args.landmarks);
    if !faults.is_empty() {
        let faults = faults.into_iter().map(|fault| format!("--landmarks: {fault}"));
        return Err(Stop(Exit::Refused, faults.collect()));
    }
    let name = args.graph.display().to_string();
    let evaluated = |document: &Document, folder: &Path, report: &mut Report| {
        let of = (document.clone(), folder.to_owned(), name.clone());
        let opened = Opened::of(of.0, of.1, of.2, args.allow_large)?;
        opened.refuse_problems(&[], &mut report.warnings)?;
        let watched = Watched::of(document, &head)?;
        let (bar, quality) = (Bar::new("nodes"), Quality::from(args.quality));
        let more = watched.sockets();
        let evaluator =
            Evaluator::new(args.threads, 0).map_err(Stop::failed)?.with_memory(memory::free);
        let evaluated = opened.evaluate_on(&evaluator, quality, &more, cancel, &bar, report);
        bar.clear();
        watched.made(evaluated?)
    };
    // Whether the mesh can be read at all is known before anything else runs.
    reads_all(&there, &out_folder, files)?;
    files.allowed().map_err(Stop::failed)?;
    let scalp_of = |document: &Document, folder: &Path| {
        scalp_alone(document, folder, &name, &head, args, cancel)
    };
    let known = document.node(head.as_str()).and_then(|node| text_of(node, "home"));
    // A groom that was carried already is still given in units of its first home.
    let home = match known {
        Some(home) => home,
        None => scalp_of(&document, &folder)?.landmarks().to_string().into(),
    };
    if home.is_empty() {
        return Err(Stop::refused(format!(
            "{name}: {head} has no landmarks: no head was found; say where they are in its input landmarks"
        )));
    }
    set_head(&mut there, &head, &args.head, &args.landmarks, &home, report);
    refuse_unknown(&*scalp_of(&there, &out_folder)?, &home, args)?;
    let at_home = evaluated(&document, &folder, &mut Report::new(name.clone()))?;
    let carried = evaluated(&there, &out_folder, report)?;
    let mut made = None;
    if args.bake {
        bake(&mut there, &head, carried.scalp.space(), &mut report.warnings);
        let mut again = Report::new(name.clone());
        made = Some(evaluated(&there, &out_folder, &mut again)?);
        (report.nodes, report.outputs) = (again.nodes, again.outputs);
    }
    let made = made.as_ref().unwrap_or(&carried);
    let figures = Fit::of(&at_home, &carried.scalp, made, (&home, args.bake), &|| {
        cancel.is_cancelled().then(Stop::interrupted).map_or(Ok(()), Err)
    })?;
    report.fit = Some(figures);
    let written = files.write_text(&args.out, &file::write(&there), cancel);
    written.map_err(|why| Stop::unwritten(&args.out, &why, cancel))
}

/// The scalp of a head node, with nothing that hangs from it.
fn scalp_alone(
    document: &Document,
    folder: &Path,
    name: &str,
    head: &NodeId,
    args: &FitArgs,
    cancel: &CancelToken,
) -> Result<Arc<Scalp>, Stop> {
    let wanted = [Socket::new(head.clone(), "scalp")];
    let quality = Quality::from(args.quality);
    let plan = plan(document, &wanted, quality, &DiskFiles::new(folder))
        .map_err(|err| Stop::refused(format!("{name}: {err}")))?;
    let evaluator = Evaluator::new(args.threads, 0).map_err(Stop::failed)?;
    let mut outcome = evaluator.run(&plan, OnFailure::Stop, cancel, &Quiet);
    if outcome.cancelled {
        return Err(Stop::interrupted());
    }
    match outcome.targets.pop() {
        Some(Some(Value::Scalp(scalp))) => Ok(scalp),
        _ => {
            let failed = outcome.nodes.iter().filter_map(|node| Some((node, node.error.as_ref()?)));
            let lines = failed.map(|(node, err)| format!("{name}: {}: {err}", node.name));
            Err(Stop(Exit::Refused, lines.collect()))
        }
    }
}

/// Refuses a head that no map leads to: it would only lay the groom somewhere.
fn refuse_unknown(there: &Scalp, home: &str, args: &FitArgs) -> Result<(), Stop> {
    let (here, (home, _)) = (there.landmarks(), Landmarks::parse(home));
    if there.space().carry().is_some() || here.same(&home) {
        return Ok(());
    }
    let shared: Vec<&str> = home
        .each()
        .filter(|(mark, _)| here.get(*mark).is_some())
        .map(|(mark, _)| mark.name())
        .collect();
    let why = match shared.is_empty() {
        true => "no head was found in it, and no landmark is known".to_owned(),
        false => {
            format!("no map leads through the landmarks that are known ({})", shared.join(", "))
        }
    };
    Err(Stop::refused(format!(
        "--head {}: {why}: say where they lie, in the head frame, in cm on a mesh without a head: --landmarks \"crown X Y Z; chin \
         X Y Z; ...\", of {}",
        args.head,
        Landmark::names()
    )))
}

/// What of a graph is looked at besides its outputs.
struct Watched {
    head: Socket,
    /// Scalps that are parted.
    parted: Vec<Socket>,
    /// Curves of the nodes that root some: they read a head and no curves.
    sources: Vec<Socket>,
}

impl Watched {
    fn of(document: &Document, head: &NodeId) -> Result<Self, Stop> {
        let outputs = document.nodes.iter().filter(|(_, node)| node.kind == "groom_output");
        let needed = upstream(document, outputs.map(|(id, _)| id));
        if !needed.contains(head) {
            return Err(Stop::refused(format!("no output hangs from the head {head}")));
        }
        let mut out =
            Self { head: Socket::new(head.clone(), "scalp"), parted: vec![], sources: vec![] };
        for id in needed {
            let Some(node) = document.node(id.as_str()).filter(|node| !node.bypass) else {
                continue;
            };
            let Some(def) = coif_nodes::by_id(&node.kind) else { continue };
            let wired = |ty: Type| {
                let mut inputs = def.inputs.iter().filter(|input| input.ty == ty);
                inputs.any(|input| !document.wires(&id, input.name).is_empty())
            };
            let gives = def.outputs.iter().find(|output| output.ty == Type::Curves);
            if node.kind == "partings" {
                out.parted.push(Socket::new(id, "scalp"));
            } else if let (Some(gives), true, false) =
                (gives, wired(Type::Scalp), wired(Type::Curves))
            {
                out.sources.push(Socket::new(id, gives.name));
            }
        }
        Ok(out)
    }

    fn sockets(&self) -> Vec<Socket> {
        let head = std::iter::once(&self.head);
        head.chain(&self.parted).chain(&self.sources).cloned().collect()
    }

    fn made(self, evaluated: Evaluated) -> Result<FitResult, Stop> {
        let Evaluated { groups, more, .. } = evaluated;
        let mut more = more.into_iter();
        let scalp = |value: Option<Value>| match value {
            Some(Value::Scalp(scalp)) => Some(scalp),
            _ => None,
        };
        let none = || Stop::failed("a node gave nothing");
        let head = scalp(more.next()).ok_or_else(none)?;
        let mut parted: Vec<(NodeId, Arc<Scalp>)> = vec![];
        for socket in self.parted {
            parted.push((socket.node, scalp(more.next()).ok_or_else(none)?));
        }
        let mut sources = vec![];
        for socket in self.sources {
            let Some(Value::Curves(curves)) = more.next() else { return Err(none()) };
            sources.push((socket.node, curves));
        }
        Ok(FitResult { groups, scalp: head, parted, sources })
    }
}

fn text_of(node: &Node, input: &str) -> Option<Arc<str>> {
    match node.inputs.get(input) {
        Some(Setting::Known(Value::Text(text))) if !text.trim().is_empty() => Some(text.clone()),
        _ => None,
    }
}

/// Inputs of a head node that say how its mesh file is to be read, and nothing of another one.
const OF_THE_MESH: [&str; 11] = [
    "leave_out",
    "landmarks",
    "units",
    "scale",
    "up",
    "forward",
    "turn",
    "fit",
    "radius",
    "centre",
    "builtin",
];

/// Makes the head node that of the other head.
fn set_head(
    document: &mut Document,
    head: &NodeId,
    given: &str,
    landmarks: &str,
    home: &Arc<str>,
    report: &mut Report,
) {
    let Some(node) = document.nodes.get_mut(head).map(Arc::make_mut) else { return };
    let gone: Vec<&str> =
        OF_THE_MESH.into_iter().filter(|name| node.inputs.remove(*name).is_some()).collect();
    if !gone.is_empty() {
        let gone = gone.join(", ");
        report.notes.push(format!(
            "{head}: {gone} went back to the default, for they were about the other mesh"
        ));
    }
    if given.rsplit('=').next() == Some("builtin") {
        node.inputs.remove("mesh");
    }
    let mut set = |name: &str, text: &str| {
        if !text.trim().is_empty() {
            node.inputs.insert(name.to_owned(), Setting::Known(Value::Text(text.into())));
        }
    };
    set("landmarks", landmarks);
    set("home", home);
}

/// The folder that a file lies in, from the root.
fn folder_of(file: &Path) -> Result<PathBuf, Stop> {
    let full = std::path::absolute(file)
        .map_err(|err| Stop::refused(format!("{}: {err}", file.display())))?;
    Ok(full.parent().unwrap_or(Path::new("/")).to_owned())
}

/// Lets all paths of a document that was in one folder lead to the same files from another: from there where they lie below it.
fn rebase(document: &mut Document, from: &Path, to: &Path) {
    for node in document.nodes.values_mut() {
        let Some(def) = coif_nodes::by_id(&node.kind) else { continue };
        for input in def.inputs.iter().filter(|input| input.ty == Type::File) {
            let Some(path) = text_of(node, input.name) else { continue };
            let full = from.join(&*path);
            let text = full.strip_prefix(to).unwrap_or(&full).to_string_lossy().into_owned();
            if *text != *path {
                let setting = Setting::Known(Value::Text(text.into()));
                Arc::make_mut(node).inputs.insert(input.name.to_owned(), setting);
            }
        }
    }
}

/// The figures, for a person.
fn summary(report: &Report, out: &Path) -> String {
    let figures = report.fit.as_ref().map_or(String::new(), Fit::report);
    format!("{figures}{:.2} s\nwrote {}", report.total_ms / 1e3, out.display())
}
