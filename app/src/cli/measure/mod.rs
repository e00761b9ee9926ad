//! `coif measure`: the laws of hair, measured on an exported file alone (methods.md 0 and 2 to 6).
//!
//! What coif promises of its own grooms is measured on whatever is in the file, by whomever it was written: the laws themselves are in
//! `coif_nodes::laws`. Here are the options, what is read (`beside.rs`: files that a file names), the figures by their names
//! (`report.rs`) and the text (`words.rs`). What was not read of the file is said with every report; a prim or curve that
//! contradicts itself is named, the others are measured, and the command ends with 1.

mod beside;
#[cfg(test)]
mod cases;
mod report;
mod unit;
mod words;

use super::{Exit, complain, complain_of, ending, extension_of, print, print_plain, shown};
use crate::words::plain_json;
use clap::Args;
use coif_graphs::schedule::files::{DiskFiles, Files};
use coif_graphs::schedule::run::{CancelToken, Evaluator};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_nodes::eval::{EvalCx, Log, PlainHost, Quality};
use coif_nodes::formats::abc::{self, AbcCurves};
use coif_nodes::formats::usd::read::read_stage;
use coif_nodes::maths::hash::Key;
use report::{NotRead, measure};
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Args)]
pub(crate) struct MeasureArgs {
    /// File with curves: .usda, .usdc, .usd, .usdz or .abc
    file: PathBuf,
    /// Head mesh that the roots should lie on: .obj, .gltf, .glb or .vrm, also one of a pack (groom.coif:head.obj); "builtin" for the
    /// built-in head
    #[arg(long, value_name = "FILE")]
    scalp: Option<PathBuf>,
    /// Parts of that mesh that are no skin, such as hair and hats, as in the head node's leave_out: "Hair*, *glasses"
    #[arg(
        long,
        value_name = "NAMES",
        requires = "scalp",
        default_value = "",
        hide_default_value = true
    )]
    leave_out: String,
    /// Unit of an .abc file, which declares none. Without, it is guessed by the head of --scalp, then by the application that wrote
    /// the file, and said
    #[arg(long, value_name = "UNIT")]
    unit: Option<unit::LengthUnit>,
    /// Print JSON for other tools
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: MeasureArgs) -> Exit {
    ending::at_once();
    let refuse = |file: &PathBuf, reason: String| {
        complain(format!("{}: {reason}", shown(file)));
        Exit::Refused
    };
    let bytes = match std::fs::metadata(&args.file) {
        Ok(about) if !about.is_file() => return refuse(&args.file, "is not a file".to_owned()),
        Ok(_) => std::fs::read(&args.file),
        Err(err) => Err(err),
    };
    let bytes = match bytes {
        Ok(bytes) => bytes,
        Err(err) => return refuse(&args.file, err.to_string()),
    };
    let name = args.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut beside = beside::Folder::of(&args.file);
    let read = match &*extension_of(&args.file) {
        "abc" => abc::read_curves(&bytes)
            .map(|AbcCurves { stage, application }| (stage, Some(application))),
        _ if args.unit.is_some() => {
            let reason = "--unit is for .abc files; this one declares its unit".to_owned();
            return refuse(&args.file, reason);
        }
        _ => read_stage(&bytes, &name, &mut |path| beside.read(path)).map(|stage| (stage, None)),
    };
    let (mut stage, written_by) = match read {
        Ok(read) => read,
        Err(err) => return refuse(&args.file, err.to_string()),
    };
    drop(bytes);
    let left_out: Vec<NotRead> = stage.left_out.iter().map(NotRead::new).collect();
    // A prim may say that it has none.
    let is_bald = stage.curves.iter().all(|curves| curves.counts.is_empty());
    // The report says the rest.
    let of_note = left_out.iter().filter(|what| what.broken || is_bald);
    let of_note =
        of_note.map(|what| format!("{}: not read: {}", shown(&args.file), what.in_words()));
    complain_of(of_note.collect());
    if is_bald {
        let none = if left_out.is_empty() {
            "there are no curves in it"
        } else {
            "there are no curves in it that could be read"
        };
        return refuse(&args.file, none.to_owned());
    }
    let scalp = args.scalp.as_ref().map(|mesh| read_scalp(mesh, &args.leave_out)).transpose();
    let scalp = match scalp {
        Ok(read) => read.map(|(scalp, doubts)| {
            let mesh = args.scalp.as_ref().unwrap_or(&args.file);
            complain_of(doubts.iter().map(|doubt| format!("{}: {doubt}", shown(mesh))).collect());
            scalp
        }),
        Err(reason) => return refuse(args.scalp.as_ref().unwrap_or(&args.file), reason),
    };
    let threads = match Evaluator::new(0, 0) {
        Ok(threads) => threads,
        Err(reason) => return refuse(&args.file, reason),
    };
    let taken = written_by.map(|application| {
        let head = scalp.as_ref().map(|scalp| scalp.surface());
        let taken = unit::TakenUnit::of(args.unit, &stage.curves, head, application);
        stage.curves.iter_mut().for_each(|curves| curves.scale(taken.cm));
        taken
    });
    let mut all = measure(&stage, scalp.as_deref(), &threads.host(&CancelToken::default()));
    all.iter_mut().for_each(|measured| measured.unit.clone_from(&taken));
    let printed = if args.json {
        print(&plain_json(&serde_json::to_string_pretty(&all).unwrap_or_default()))
    } else {
        let left_out = left_out.iter().map(|what| format!("not read: {}", what.in_words()));
        let taken = taken.iter().map(|taken| taken.in_words());
        let lines: Vec<String> =
            taken.chain(all.iter().map(words::in_words)).chain(left_out).collect();
        print_plain(&lines.join("\n"))
    };
    if all.iter().all(|m| m.strands.undrawn() == m.strands.curves) {
        complain(format!("{}: there is no curve in it that can be measured", shown(&args.file)));
        return Exit::Failed;
    }
    let undrawn: Vec<String> = all
        .iter()
        .filter(|m| m.strands.undrawn() > 0)
        .map(|m| {
            let (n, of) = (m.strands.undrawn(), m.strands.curves);
            format!(
                "{}: {}: {n} of {of} curves have a number of points that makes no curve",
                shown(&args.file),
                m.path
            )
        })
        .collect();
    let is_whole = undrawn.is_empty() && !left_out.iter().any(|what| what.broken);
    complain_of(undrawn);
    if is_whole { printed } else { Exit::Failed }
}

/// What `--scalp` takes for the head that is part of the program.
const BUILT_IN: &str = "builtin";

/// The scalp of a mesh file or of the built-in head, without the parts that are left out, as the `head` node makes it; and what that
/// node warns of.
fn read_scalp(path: &PathBuf, leave_out: &str) -> Result<(Arc<Scalp>, Vec<String>), String> {
    let node = coif_nodes::by_id("head").ok_or("this build has no head node")?;
    let mut inputs = vec![vec![]; node.inputs.len()];
    let mut set = |name: &str, value: Value| {
        let (at, _) = node.input(name).ok_or_else(|| format!("the head node has no {name}"))?;
        inputs[at].push(value);
        Ok::<(), String>(())
    };
    if path.as_os_str() != BUILT_IN {
        let path = std::path::absolute(path).map_err(|err| err.to_string())?;
        let path = crate::pack::led_into(path)?;
        set("mesh", Value::File(DiskFiles::new("/").read(&path.to_string_lossy())?))?;
    }
    if !leave_out.is_empty() {
        set("leave_out", Value::Text(leave_out.into()))?;
    }
    let log = Log::default();
    let cx = EvalCx::new(0, Quality::Final, Key::default(), &PlainHost, &log);
    let made = (node.run)(&cx, &inputs).map_err(|err| err.to_string())?;
    let doubts: Vec<String> =
        log.messages().into_iter().filter(|said| said.warning).map(|said| said.text).collect();
    // What is meant to be left out and is not there would be measured as skin.
    if let Some(unknown) = doubts.iter().find(|doubt| doubt.starts_with("leave_out: ")) {
        return Err(format!("--{}", unknown.replacen('_', "-", 1)));
    }
    match made.into_iter().next() {
        Some(Value::Scalp(scalp)) => Ok((scalp, doubts)),
        _ => Err("the head node gave no scalp".to_owned()),
    }
}
