//! `coif eval`: a saved graph to hair.

use super::files::{Pending, write_text};
use super::progress::Bar;
use super::report::{Head, Output, Report, peak_rss_mib, rounded};
use super::{Exit, complain, extension_of, print};
use clap::{Args, ValueEnum};
use coif_graphs::document::graph::{Fault, Severity, check_for, upstream};
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_graphs::grooms;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::{content_hash, document_hash};
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{NodeError, Type, Value};
use coif_nodes::eval::Quality;
use coif_nodes::formats::export::{self, About, Format, Group};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

#[derive(Args)]
pub(crate) struct EvalArgs {
    /// The graph: a .ron file, or the name of a shipped groom
    graph: PathBuf,
    /// File to write; the extension picks the format (.usda, .usdc, .hair). Gets every output, one group for each
    #[arg(long, value_name = "FILE")]
    out: Vec<PathBuf>,
    /// Only these outputs, instead of every groom_output
    #[arg(long, value_name = "NODE.SOCKET")]
    output: Vec<String>,
    /// Set an input before evaluating; VALUE is RON, a bare word is text
    #[arg(long, value_name = "NODE.INPUT=VALUE")]
    set: Vec<String>,
    /// Another mesh for the graph's one head node, or for NODE
    #[arg(long, value_name = "[NODE=]FILE")]
    scalp: Vec<String>,
    /// Another seed than the document's
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads; 0: one for each core
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    threads: usize,
    /// How much hair is made
    #[arg(long, value_enum, default_value_t = QualityArg::Final)]
    quality: QualityArg,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
    /// Print what was made to stdout
    #[arg(skip)]
    summary: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum QualityArg {
    /// The first tenth of the strands
    Preview,
    /// All strands
    Final,
}

impl EvalArgs {
    /// The start-up groom, written to the current folder.
    pub(crate) fn start_up() -> Self {
        Self {
            graph: "start".into(),
            out: vec!["start.usdc".into()],
            output: vec![],
            set: vec![],
            scalp: vec![],
            seed: None,
            threads: 0,
            quality: QualityArg::Final,
            report: None,
            summary: true,
        }
    }
}

/// Why an evaluation ended early.
pub(crate) struct Stop(Exit, Vec<String>);

impl Stop {
    /// Wrong before anything ran.
    pub(crate) fn refused(text: impl Into<String>) -> Self {
        Self(Exit::Refused, vec![text.into()])
    }
    /// What to say, a line each.
    pub(crate) fn lines(&self) -> &[String] {
        &self.1
    }
}

pub(crate) fn run(args: EvalArgs) -> Exit {
    let began = Instant::now();
    let cancel = CancelToken::default();
    let on_ctrl_c = cancel.clone();
    // A second handler in one process can only fail in tests; then Ctrl-C ends it at once.
    let _ = ctrlc::set_handler(move || on_ctrl_c.cancel());
    let mut report = Report::new(args.graph.display().to_string());
    let exit = match evaluate(&args, &cancel, &mut report) {
        Ok(()) => Exit::Done,
        Err(Stop(exit, errors)) => {
            errors.iter().for_each(complain);
            report.errors = errors;
            exit
        }
    };
    for warning in &report.warnings {
        eprintln!("coif: warning: {warning}");
    }
    report.total_ms = rounded(began.elapsed().as_secs_f64() * 1e3);
    report.peak_rss_mib = peak_rss_mib();
    if exit == Exit::Done && (args.summary || args.report.is_none()) {
        let text = summary(&report, &args.out);
        if args.summary { print(&text) } else { eprintln!("{text}") }
    }
    if let Some(path) = &args.report {
        let text = serde_json::to_string_pretty(&report).unwrap_or_default();
        if path.as_os_str() == "-" {
            print(&text);
        } else if let Err(reason) = write_text(path, &(text + "\n")) {
            complain(format!("{}: {reason}", path.display()));
            return if exit == Exit::Done { Exit::Failed } else { exit };
        }
    }
    exit
}

fn evaluate(args: &EvalArgs, cancel: &CancelToken, report: &mut Report) -> Result<(), Stop> {
    let formats = formats(&args.out)?;
    let (mut document, folder) = load(&args.graph, &mut report.warnings)?;
    if let Some(seed) = args.seed {
        document.seed = seed;
    }
    for set in &args.set {
        apply_set(&mut document, set)?;
    }
    for scalp in &args.scalp {
        apply_scalp(&mut document, scalp)?;
    }
    report.seed = document.seed;
    let outputs = outputs(&document, &args.output)?;
    refuse_problems(&document, &outputs, &mut report.warnings)?;
    let targets: Vec<Socket> = outputs.iter().map(|o| o.socket.clone()).collect();
    let heads = heads(&document, &targets);
    let wanted: Vec<Socket> = targets.iter().chain(&heads).cloned().collect();
    let quality = match args.quality {
        QualityArg::Preview => Quality::Preview,
        QualityArg::Final => Quality::Final,
    };
    let plan = plan(&document, &wanted, quality, &DiskFiles::new(folder))
        .map_err(|err| Stop::refused(format!("{}: {err}", args.graph.display())))?;
    let evaluator = Evaluator::new(args.threads, 0).map_err(|err| Stop(Exit::Failed, vec![err]))?;
    let bar = Bar::new();
    let mut outcome = evaluator.run(&plan, OnFailure::Stop, cancel, &bar);
    drop(plan);
    bar.clear();
    report.add_nodes(&outcome.nodes);
    if outcome.cancelled {
        return Err(Stop(Exit::Interrupted, vec!["interrupted; nothing was written".to_owned()]));
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
        let graph = args.graph.display();
        let lines = failures.iter().map(|(node, err)| format!("{graph}: {node}: {err}")).collect();
        return Err(Stop(if refused { Exit::Refused } else { Exit::Failed }, lines));
    }
    // The skin that keeps points added by export outside: of the only head, if there is one.
    let scalps: Vec<Arc<Scalp>> = outcome
        .targets
        .split_off(targets.len())
        .into_iter()
        .filter_map(|value| match value {
            Some(Value::Scalp(scalp)) => Some(scalp),
            _ => None,
        })
        .collect();
    report.head = heads.first().zip(scalps.first()).map(|(socket, scalp)| head_of(socket, scalp));
    let skin = match &scalps[..] {
        [only] => Some(only.skin()),
        _ => None,
    };
    let mut groups = vec![];
    for (output, value) in outputs.iter().zip(std::mem::take(&mut outcome.targets)) {
        let Some(Value::Curves(curves)) = value else { continue };
        let conformed = export::conform(&curves, skin, &|n, f| evaluator.for_each(n, f));
        drop(curves);
        let socket = &output.socket;
        if conformed.left_out > 0 {
            report.warnings.push(format!(
                "{socket}: {} curves of fewer than 2 points were left out",
                conformed.left_out
            ));
        }
        let curves = conformed.curves;
        report.outputs.push(Output {
            node: socket.node.to_string(),
            socket: socket.name.to_string(),
            group: output.group.clone(),
            curves: curves.curve_count(),
            points: curves.point_count(),
            bounds: curves.bounds().map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
            hash: content_hash(&curves),
            resampled: conformed.resampled,
            reading_difference: conformed.difference,
        });
        if curves.curve_count() == 0 {
            let text = format!("{}: {socket} gives no curves", args.graph.display());
            return Err(Stop(Exit::Failed, vec![text]));
        }
        groups.push(Group { name: output.group.clone(), guides: output.guides, curves });
    }
    if groups.is_empty() {
        return Err(Stop::refused(format!("{}: no output gives curves", args.graph.display())));
    }
    save(args, &formats, &document, &groups, cancel, &bar)
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

/// The format of each output file.
fn formats(out: &[PathBuf]) -> Result<Vec<Format>, Stop> {
    out.iter()
        .map(|path| {
            Format::of_extension(&extension_of(path)).ok_or_else(|| {
                Stop::refused(format!(
                    "{}: grooms are written as {}",
                    path.display(),
                    Format::EXTENSIONS
                ))
            })
        })
        .collect()
}

/// The document of a file, or the shipped groom of that name, and the folder that its paths are relative to.
pub(crate) fn load(path: &Path, warnings: &mut Vec<String>) -> Result<(Document, PathBuf), Stop> {
    let shown = path.display();
    let (bytes, folder) = match std::fs::metadata(path) {
        Ok(about) if !about.is_file() => {
            return Err(Stop::refused(format!("{shown}: is not a file")));
        }
        Ok(about) if about.len() > MOST_DOCUMENT => {
            return Err(Stop::refused(format!(
                "{shown}: is larger than 256 MiB, which no graph is"
            )));
        }
        Ok(_) => {
            let bytes =
                std::fs::read(path).map_err(|err| Stop::refused(format!("{shown}: {err}")))?;
            (bytes, path.parent().unwrap_or(Path::new("")).to_owned())
        }
        Err(err) => match grooms::by_name(&path.to_string_lossy()) {
            Some(text) => (text.as_bytes().to_vec(), PathBuf::new()),
            None if err.kind() == std::io::ErrorKind::NotFound => {
                let known: Vec<&str> = grooms::ALL.iter().map(|(name, _)| *name).collect();
                return Err(Stop::refused(format!(
                    "{shown}: no such file, and no shipped groom of that name ({})",
                    known.join(", ")
                )));
            }
            None => return Err(Stop::refused(format!("{shown}: {err}"))),
        },
    };
    let loaded = file::read_bytes(&bytes).map_err(|err| Stop::refused(err.of_file(&shown)))?;
    warnings.extend(loaded.warnings.iter().map(|w| w.of_file(&shown)));
    Ok((loaded.document, folder))
}

/// The largest document that is read: strokes take 20 bytes a sample, so this holds millions.
const MOST_DOCUMENT: u64 = 256 << 20;

/// `NODE.INPUT=VALUE`.
fn apply_set(document: &mut Document, set: &str) -> Result<(), Stop> {
    let fault = |reason: String| Stop::refused(format!("--set {set}: {reason}"));
    let (socket, text) =
        set.split_once('=').ok_or_else(|| fault("write it as NODE.INPUT=VALUE".to_owned()))?;
    let socket: Socket = socket.trim().parse().map_err(|err| fault(format!("{err}")))?;
    let node = document
        .nodes
        .get_mut(&socket.node)
        .ok_or_else(|| fault(format!("there is no node {:?}", socket.node.as_str())))?;
    let def = coif_nodes::by_id(&node.kind)
        .ok_or_else(|| fault(format!("its kind {:?} is not known", node.kind)))?;
    let (_, input) = def.input(&socket.name).ok_or_else(|| {
        let known: Vec<&str> = def.inputs.iter().map(|i| i.name).collect();
        fault(format!("a {} has no input {:?}; it has {}", def.id, &*socket.name, known.join(", ")))
    })?;
    let value = file::parse_value(input.ty, text.trim()).map_err(&fault)?;
    Arc::make_mut(node).inputs.insert(input.name.to_owned(), Setting::Known(value));
    document.links.remove(&Socket::new(socket.node, input.name));
    Ok(())
}

/// `[NODE=]FILE`.
fn apply_scalp(document: &mut Document, scalp: &str) -> Result<(), Stop> {
    let fault = |reason: String| Stop::refused(format!("--scalp {scalp}: {reason}"));
    let named =
        scalp.split_once('=').and_then(|(node, file)| Some((NodeId::new(node).ok()?, file)));
    let (id, path) = match named {
        Some((id, path)) if document.nodes.contains_key(&id) => (id, path),
        _ => {
            let heads: Vec<&NodeId> =
                document.nodes.iter().filter(|(_, n)| n.kind == "head").map(|(id, _)| id).collect();
            match heads[..] {
                [one] => (one.clone(), scalp),
                [] => return Err(fault("the graph has no head node".to_owned())),
                _ => {
                    let names: Vec<&str> = heads.iter().map(|id| id.as_str()).collect();
                    return Err(fault(format!(
                        "the graph has several heads; write NODE=FILE with one of {}",
                        names.join(", ")
                    )));
                }
            }
        }
    };
    // The document's paths are relative to its folder, this one to where the command was given.
    let full = std::path::absolute(path).map_err(|err| fault(err.to_string()))?;
    let text: Arc<str> = full.to_string_lossy().into();
    let node = document.nodes.get_mut(&id).map(Arc::make_mut);
    if let Some(node) = node.filter(|node| node.kind == "head") {
        node.inputs.insert("mesh".to_owned(), Setting::Known(Value::Text(text)));
        document.links.remove(&Socket::new(id, "mesh"));
        return Ok(());
    }
    Err(fault(format!("{id} is no head node")))
}

/// One output to be given.
pub(crate) struct Wanted {
    pub(crate) socket: Socket,
    group: String,
    guides: bool,
}

/// The named outputs, or those of every `groom_output`.
pub(crate) fn outputs(document: &Document, named: &[String]) -> Result<Vec<Wanted>, Stop> {
    if named.is_empty() {
        let all: Vec<Wanted> = document
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
            let fault = |reason: String| Stop::refused(format!("--output {text}: {reason}"));
            let socket: Socket = text.parse().map_err(|err| fault(format!("{err}")))?;
            let node = document
                .node(socket.node.as_str())
                .ok_or_else(|| fault(format!("there is no node {:?}", socket.node.as_str())))?;
            let def = coif_nodes::by_id(&node.kind)
                .ok_or_else(|| fault(format!("its kind {:?} is not known", node.kind)))?;
            let known: Vec<&str> = def.outputs.iter().map(|o| o.name).collect();
            match def.output(&socket.name) {
                None => Err(fault(format!(
                    "a {} has no such output; it gives {}",
                    def.id,
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

fn wanted(document: &Document, socket: Socket) -> Wanted {
    let node = document.node(socket.node.as_str());
    let output = node.filter(|node| node.kind == "groom_output");
    let set = |name: &str| output.and_then(|node| node.inputs.get(name));
    let group = match set("name") {
        Some(Setting::Known(Value::Text(name))) if !name.is_empty() => name.to_string(),
        _ => socket.node.to_string(),
    };
    let guides = matches!(set("guides"), Some(Setting::Known(Value::Bool(true))));
    Wanted { socket, group, guides }
}

/// Ends with every error on the way to an output; problems elsewhere are warnings.
fn refuse_problems(
    document: &Document,
    outputs: &[Wanted],
    warnings: &mut Vec<String>,
) -> Result<(), Stop> {
    let targets = outputs.iter().map(|o| o.socket.node.clone()).collect();
    let mut errors = vec![];
    for problem in check_for(document, &targets).into_iter().filter(|p| p.needed) {
        match problem.severity {
            Severity::Error => errors.push(problem.to_string()),
            // The node clamps such a value and says so itself.
            Severity::Warning if problem.fault == Fault::OutOfRange => {}
            Severity::Warning => warnings.push(problem.to_string()),
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(Stop(Exit::Refused, errors)) }
}

/// The scalps that the targets stand on, to be reported.
fn heads(document: &Document, targets: &[Socket]) -> Vec<Socket> {
    upstream(document, targets.iter().map(|t| &t.node))
        .into_iter()
        .filter(|id| document.node(id.as_str()).is_some_and(|n| n.kind == "head"))
        .map(|id| Socket::new(id, "scalp"))
        .collect()
}

fn save(
    args: &EvalArgs,
    formats: &[Format],
    document: &Document,
    groups: &[Group],
    cancel: &CancelToken,
    bar: &Bar,
) -> Result<(), Stop> {
    let title = if document.title.is_empty() { "Groom" } else { &document.title };
    let about = About {
        title: title.to_owned(),
        generator: format!("coif {}", env!("CARGO_PKG_VERSION")),
        graph_hash: document_hash(document),
        seed: document.seed,
    };
    let mut pending = Pending::default();
    for (path, format) in args.out.iter().zip(formats) {
        bar.say(format!("writing {}", path.display()));
        let written = pending.write(path, cancel, |out| {
            export::write(*format, groups, &about, out).map_err(|err| err.to_string())
        });
        if cancel.is_cancelled() {
            return Err(Stop(
                Exit::Interrupted,
                vec!["interrupted; nothing was written".to_owned()],
            ));
        }
        written
            .map_err(|reason| Stop(Exit::Failed, vec![format!("{}: {reason}", path.display())]))?;
    }
    bar.clear();
    pending
        .place()
        .map_err(|(path, reason)| Stop(Exit::Failed, vec![format!("{}: {reason}", path.display())]))
}

/// What was made, for a person.
fn summary(report: &Report, out: &[PathBuf]) -> String {
    let mut text = String::new();
    for output in &report.outputs {
        text += &format!("{}: {} curves, {} points", output.group, output.curves, output.points);
        if let Some([lo, hi]) = output.bounds {
            let size: Vec<String> = (0..3).map(|i| format!("{:.1}", hi[i] - lo[i])).collect();
            text += &format!(", {} cm", size.join(" x "));
        }
        text += &format!(", hash {}\n", output.hash);
    }
    let memory = report.peak_rss_mib.map_or(String::new(), |m| format!(", {m:.0} MiB"));
    text += &format!("{:.2} s{memory}", report.total_ms / 1e3);
    for path in out {
        text += &format!("\nwrote {}", path.display());
    }
    text
}
