//! `coif trace`: what made one hair, found by switching nodes, strokes and gestures off (`graphs/src/trace.rs` has the law).

use super::eval::cache_bytes;
use super::groom::GroomArgs;
use super::progress::Bar;
use super::{Exit, answer, ending, tell};
use crate::files::Together;
use crate::jobs::evaluate::{Evaluated, Opened};
use crate::jobs::progress::Tell;
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use crate::words::plain_json;
use clap::Args;
use coif_graphs::document::{Document, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::run::{CancelToken, Evaluator};
use coif_graphs::trace::{Found, Groom, NotTraced, Part, Traced, nearest, trace};
use coif_nodes::define::short;
use coif_nodes::formats::export;
use glam::Vec3;
use serde::Serialize;
use std::time::Instant;

#[derive(Args)]
pub(crate) struct TraceArgs {
    #[command(flatten)]
    groom: GroomArgs,
    /// The hair: 16 hexadecimal digits as the spreadsheet shows, or its number in exported files (primvar id)
    #[arg(long, value_name = "ID", required_unless_present = "at", conflicts_with = "at")]
    hair: Option<String>,
    /// The hair whose root is nearest to this place, cm
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    at: Option<String>,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(mut args: TraceArgs) -> Exit {
    ending::at_once();
    // What it costs is asked of coif eval.
    args.groom.no_budget = true;
    let mut report = Report::new(args.groom.graph.display().to_string());
    let found = traced(&args, &mut report);
    answer(report, found)
}

/// What is printed.
fn traced(args: &TraceArgs, report: &mut Report) -> Result<String, Stop> {
    let began = Instant::now();
    let opened = args.groom.open(report, &mut Together::default())?;
    opened.refuse_problems(&[], &mut report.warnings)?;
    let evaluator = args.groom.evaluator(cache_bytes(), &mut report.warnings)?;
    let cancel = CancelToken::default();
    let evaluated = args.groom.evaluate(&opened, Some(&evaluator), &cancel, report)?;
    let hair = asked(args, &evaluated)?;
    drop(evaluated);
    let traced = of_hair(args, &opened, hair, &evaluator)?;
    let seconds = began.elapsed().as_secs_f64();
    Ok(match args.json {
        true => json(&opened.document, &traced, seconds),
        false => {
            let text = words(&opened.document, &traced);
            tell(format_args!("{} evaluations, {seconds:.1} s", traced.evaluations));
            text
        }
    })
}

/// Nothing of a groom is farther from the origin than this, cm.
const FARTHEST: f32 = 1e6;

/// The id of the hair that is asked for.
fn asked(args: &TraceArgs, evaluated: &Evaluated) -> Result<u64, Stop> {
    let groups = &evaluated.groups;
    if let Some(at) = &args.at {
        let numbers: Vec<f32> = at.split(',').filter_map(|word| word.trim().parse().ok()).collect();
        let point = match (&numbers[..], at.split(',').count()) {
            ([x, y, z], 3) if numbers.iter().all(|x| x.abs() <= FARTHEST) => Vec3::new(*x, *y, *z),
            _ => {
                return Err(Stop::refused(format!(
                    "--at {}: write it as X,Y,Z in cm, each at most 1000000",
                    short(at)
                )));
            }
        };
        let hair = groups.iter().filter(|group| !group.guides);
        let near = hair.filter_map(|group| nearest(&group.curves, point));
        let near = near.min_by(|a, b| a.1.total_cmp(&b.1));
        let (id, far) =
            near.ok_or_else(|| Stop::failed("no output gives hair that is no guide"))?;
        tell(format_args!("hair {id:016x}, whose root is {far:.2} cm from there"));
        return Ok(id);
    }
    let text = args.hair.as_deref().unwrap_or_default();
    let no_id = || {
        Stop::refused(format!(
            "--hair {}: is no id: 16 hexadecimal digits as in the spreadsheet, or a number as in files",
            short(text)
        ))
    };
    if text.len() == 16 {
        return u64::from_str_radix(text, 16).map_err(|_| no_id());
    }
    let number: i32 = text.parse().map_err(|_| no_id())?;
    let numbers = export::numbers(groups).map_err(|err| Stop::failed(err.to_string()))?;
    let ids = groups.iter().flat_map(|group| group.curves.each().map(|(tuft, i)| tuft.id(i)));
    let found = numbers.into_iter().flatten().zip(ids).find(|(known, _)| *known == number);
    found.map(|(_, id)| id).ok_or_else(|| {
        Stop::refused(format!("--hair {text}: no curve has this number in exported files"))
    })
}

fn of_hair(
    args: &TraceArgs,
    opened: &Opened,
    hair: u64,
    evaluator: &Evaluator,
) -> Result<Traced, Stop> {
    let outputs: Vec<Socket> = opened.outputs.iter().map(|output| output.socket.clone()).collect();
    let groom = Groom {
        document: &opened.document,
        files: &DiskFiles::new(opened.folder()),
        quality: args.groom.quality(),
        allow_large: args.groom.allow_large,
    };
    let bar = Bar::new("parts");
    let traced = trace(&groom, &outputs, hair, (evaluator, &CancelToken::default()), &mut |far| {
        bar.count(far.of - far.open, far.of);
        bar.say(format!("{} evaluations", far.evaluations));
    });
    bar.clear();
    traced.map_err(|why| match why {
        NotTraced::NoHair(_) | NotTraced::Bad(_) => Stop::refused(why.to_string()),
        NotTraced::Cancelled => Stop::interrupted(),
        NotTraced::Failed { .. } => Stop::failed(why.to_string()),
    })
}

/// A line for each node, and behind it one for each of what is drawn in it.
fn words(document: &Document, traced: &Traced) -> String {
    let mut text = format!("{traced}:\n");
    let mut node = None;
    for Found { part, alone } in &traced.found {
        if node != Some(part.node()) {
            node = Some(part.node());
            let kind = document.node(part.node().as_str()).map_or("", |node| &node.kind);
            text += &format!("{} ({kind})", part.node());
            text +=
                if matches!(part, Part::Node(_)) { "\n" } else { ", for what is drawn in it\n" };
        }
        let together = if *alone { "" } else { ", but only together with others" };
        match part {
            Part::Node(_) if *alone => {}
            Part::Node(_) => text += "    it could be off, but for others that then could not\n",
            Part::Drawn { .. } => text += &format!("    {}{together}\n", part.describe(document)),
        }
    }
    text
}

#[derive(Serialize)]
struct JsonTraced {
    output: String,
    hair: String,
    parts: Vec<JsonPart>,
    candidates: usize,
    evaluations: usize,
    seconds: f64,
}

#[derive(Serialize)]
struct JsonPart {
    node: String,
    kind: String,
    /// Null for the node itself.
    input: Option<String>,
    id: Option<u64>,
    told: String,
    alone: bool,
}

fn json(document: &Document, traced: &Traced, seconds: f64) -> String {
    let part = |Found { part, alone }: &Found| {
        let (input, id) = match part {
            Part::Node(_) => (None, None),
            Part::Drawn { input, id, .. } => (Some(input.clone()), Some(*id)),
        };
        let kind = document.node(part.node().as_str()).map_or("", |node| &node.kind).to_owned();
        let node = part.node().to_string();
        JsonPart { node, kind, input, id, told: part.describe(document), alone: *alone }
    };
    let all = JsonTraced {
        output: traced.output.to_string(),
        hair: format!("{:016x}", traced.hair),
        parts: traced.found.iter().map(part).collect(),
        candidates: traced.parts,
        evaluations: traced.evaluations,
        seconds,
    };
    plain_json(&serde_json::to_string_pretty(&all).unwrap_or_default())
}
