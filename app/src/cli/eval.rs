//! `coif eval`: a saved graph to hair.

use super::carry_out::{Stop, carry_out, writes_all};
use super::groom::{Evaluated, GroomArgs};
use super::progress::{Bar, Tell};
use super::report::Report;
use super::{Exit, extension_of};
use crate::files::Together;
use clap::Args;
use coif_graphs::document::Document;
use coif_graphs::schedule::result::document_hash;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::short;
use coif_nodes::formats::export::{self, About, Format, Group};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Args)]
pub(crate) struct EvalArgs {
    #[command(flatten)]
    groom: GroomArgs,
    /// File to write; the extension picks the format (.usda, .usdc, .abc, .hair). Gets every output, one group for each
    #[arg(long, value_name = "FILE")]
    out: Vec<PathBuf>,
    /// Put the head's mesh, whose triangles skinprim counts, into .usda, .usdc and .abc files too; not for Unreal, to which an .abc
    /// with a mesh in it is no groom
    #[arg(long, visible_alias = "with-skin")]
    with_head: bool,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
}

pub(crate) fn run(args: EvalArgs) -> Exit {
    carry_out(
        &args.groom.graph,
        args.report.as_deref(),
        "hair",
        args.groom.strict,
        |cancel, report, files| evaluate(&args, cancel, report, files),
        |report| summary(report, &args.out),
    )
}

fn evaluate(
    args: &EvalArgs,
    cancel: &CancelToken,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    writes_all(args.out.iter().cloned(), files)?;
    let formats = formats(&args.out)?;
    if args.with_head && formats.iter().all(|format| *format == Format::Hair) {
        return Err(Stop::refused(
            "--with-head: .usda, .usdc and .abc hold the head beside the hair; add one by --out, or leave the option out",
        ));
    }
    let opened = args.groom.open(report, files)?;
    opened.refuse_problems(&[], &mut report.warnings)?;
    files.allowed().map_err(Stop::failed)?;
    let evaluated = args.groom.evaluate(&opened, &[], cancel, report)?;
    if formats.contains(&Format::Abc) {
        report.notes.extend(left_out_of_abc(&evaluated.groups));
    }
    save(args, &formats, &opened.document, &evaluated, cancel, files)
}

/// What Alembic files leave out, a line each.
pub(crate) fn left_out_of_abc(groups: &[Group]) -> impl Iterator<Item = String> {
    let left_out = groups.iter().filter(|group| export::is_left_out_of_abc(group, groups));
    left_out.map(|group| {
        format!(
            "{}: lines of partings are left out of .abc, whose readers would take them for guides; USD files hold them",
            group.name
        )
    })
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
    evaluated: &Evaluated,
    cancel: &CancelToken,
    files: &mut Together,
) -> Result<(), Stop> {
    let heads = if args.with_head { &evaluated.scalps[..] } else { &[] };
    let bar = Bar::new("files");
    let wanted: Vec<(&Path, Format)> =
        args.out.iter().map(PathBuf::as_path).zip(formats.iter().copied()).collect();
    let groups = &evaluated.groups;
    let made = (groups.as_slice(), &evaluated.sections);
    let saved = write_files(document, made, heads, &wanted, cancel, files, &|i, path| {
        bar.count(i, wanted.len());
        bar.say(format!("writing {}", path.display()));
    });
    bar.clear();
    saved
}

/// Writes what outputs gave, with the names of sections by id, and with the `heads` where a format holds meshes, to files that `files` puts in place. `begins` is told
/// each file's number and path.
pub(crate) fn write_files(
    document: &Document,
    (groups, sections): (&[Group], &BTreeMap<u64, String>),
    heads: &[Arc<Scalp>],
    wanted: &[(&Path, Format)],
    cancel: &CancelToken,
    files: &mut Together,
    begins: &dyn Fn(usize, &Path),
) -> Result<(), Stop> {
    let title = if document.title.is_empty() { "Groom" } else { &document.title };
    let about = About {
        title: title.to_owned(),
        generator: format!("coif {}", env!("CARGO_PKG_VERSION")),
        graph_hash: document_hash(document),
        seed: document.seed,
        sections: sections.clone(),
    };
    for (i, (path, format)) in wanted.iter().enumerate() {
        begins(i, path);
        let written = files.write(path, cancel, |out| {
            export::write(*format, groups, heads, &about, out, &|| cancel.is_cancelled())
                .map_err(|err| err.to_string())
        });
        written.map_err(|reason| Stop::unwritten(path, &reason, cancel))?;
    }
    Ok(())
}

/// What was made, for a person.
fn summary(report: &Report, out: &[PathBuf]) -> String {
    let mut text = String::new();
    for output in &report.outputs {
        let group = short(&output.group);
        text += &format!("{group}: {} curves, {} points", output.curves, output.points);
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
