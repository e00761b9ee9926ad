//! `coif eval`: a saved graph to hair.

use super::files::Pending;
use super::groom::{GroomArgs, Stop, carry_out};
use super::progress::Bar;
use super::report::Report;
use super::{Exit, extension_of};
use clap::Args;
use coif_graphs::document::Document;
use coif_graphs::schedule::result::document_hash;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::formats::export::{self, About, Format, Group};
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct EvalArgs {
    #[command(flatten)]
    groom: GroomArgs,
    /// File to write; the extension picks the format (.usda, .usdc, .hair). Gets every output, one group for each
    #[arg(long, value_name = "FILE")]
    out: Vec<PathBuf>,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
}

pub(crate) fn run(args: EvalArgs) -> Exit {
    carry_out(
        &args.groom.graph,
        args.report.as_deref(),
        |cancel, report| evaluate(&args, cancel, report),
        |report| summary(report, &args.out),
    )
}

fn evaluate(args: &EvalArgs, cancel: &CancelToken, report: &mut Report) -> Result<(), Stop> {
    let formats = formats(&args.out)?;
    let opened = args.groom.open(report)?;
    opened.refuse_problems(&[], &mut report.warnings)?;
    let evaluated = args.groom.evaluate(&opened, &[], cancel, report)?;
    save(args, &formats, &opened.document, &evaluated.groups, cancel)
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

fn save(
    args: &EvalArgs,
    formats: &[Format],
    document: &Document,
    groups: &[Group],
    cancel: &CancelToken,
) -> Result<(), Stop> {
    let title = if document.title.is_empty() { "Groom" } else { &document.title };
    let about = About {
        title: title.to_owned(),
        generator: format!("coif {}", env!("CARGO_PKG_VERSION")),
        graph_hash: document_hash(document),
        seed: document.seed,
    };
    let bar = Bar::new("files");
    let mut pending = Pending::default();
    for (i, (path, format)) in args.out.iter().zip(formats).enumerate() {
        bar.count(i, formats.len());
        bar.say(format!("writing {}", path.display()));
        let written = pending.write(path, cancel, |out| {
            export::write(*format, groups, &about, out).map_err(|err| err.to_string())
        });
        if cancel.is_cancelled() {
            return Err(Stop::interrupted());
        }
        written.map_err(|reason| Stop::failed(format!("{}: {reason}", path.display())))?;
    }
    bar.clear();
    pending.place().map_err(|(path, reason)| Stop::failed(format!("{}: {reason}", path.display())))
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
