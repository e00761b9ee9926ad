//! `coif eval`: a saved graph to hair.

use super::carry_out::{carry_out, carry_out_each, is_stdout};
use super::groom::GroomArgs;
use super::progress::Bar;
use super::sweep::Sweep;
use super::{Exit, complain, ledger, print_plain, tell};
use crate::files::Together;
use crate::jobs::export::{HairFiles, formats};
use crate::jobs::memory;
use crate::jobs::open::writes_all;
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use clap::Args;
use coif_graphs::document::Document;
use coif_graphs::schedule::run::{CancelToken, Evaluator};
use coif_nodes::define::short;
use serde::Deserialize;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Default)]
pub(crate) struct EvalArgs {
    #[command(flatten)]
    pub(super) groom: GroomArgs,
    /// File to write; the extension picks the format (.usda, .usdc, .abc, .hair). Gets every output, one group for each
    #[arg(long, value_name = "FILE")]
    pub(super) out: Vec<PathBuf>,
    /// Put the head's mesh, whose triangles skinprim counts, into .usda, .usdc and .abc files too; not for Unreal, to which an .abc
    /// with a mesh in it is no groom
    #[arg(long, visible_alias = "with-skin")]
    with_head: bool,
    /// Write what was made, and what happened, as JSON to a file (- for stdout)
    #[arg(long, value_name = "FILE|-")]
    pub(super) report: Option<PathBuf>,
    /// Evaluate once for each row of a table (.csv): its first row names inputs (node.input), parameters of the graph, seed and
    /// name; {name} in --out stands for the row's name, else its number. The report is a list, an object a row
    #[arg(long, value_name = "FILE.csv")]
    sweep: Option<PathBuf>,
    /// Only this row of the sweep, as if its values were given by --set
    #[arg(long, value_name = "NAME", requires = "sweep")]
    pub(super) row: Option<String>,
    /// Print what each node cost: time, points, curves, memory, and what was known already; groups with what is in them
    #[arg(long)]
    ledger: bool,
    /// Do nothing where the report tells that the same files were made from the same inputs
    #[arg(long, requires = "report")]
    pub(super) skip_done: bool,
    /// Files that are read besides what the graph names.
    #[arg(skip)]
    reads: Vec<PathBuf>,
}

/// Writes a groom as it is to a file.
#[cfg(feature = "render")]
pub(super) fn plainly(graph: &str, out: &str) -> Exit {
    run(EvalArgs { groom: GroomArgs::of(graph), out: vec![out.into()], ..EvalArgs::default() })
}

pub(crate) fn run(mut args: EvalArgs) -> Exit {
    let mut applied = Ok(());
    if let Some(sweep) = args.sweep.take() {
        let Some(name) = args.row.take() else { return sweep_all(&args, &sweep) };
        applied = Sweep::read(&sweep).and_then(|table| table.apply(&name, &mut args));
        args.reads.push(sweep);
    }
    if args.skip_done
        && applied.is_ok()
        && let Some(path) = args.report.as_deref().filter(|path| is_done(&args, path))
    {
        tell(format_args!("{}: is done already, from the same inputs", path.display()));
        return Exit::Done;
    }
    carry_out(
        &args.groom.graph,
        args.report.as_deref(),
        "hair",
        args.groom.strict,
        |cancel, report, files| {
            applied?;
            report.row.clone_from(&args.row);
            for path in &args.reads {
                files.reads(path, format!("--sweep {}", path.display())).map_err(Stop::refused)?;
            }
            writes_all(args.out.iter().cloned(), files)?;
            evaluate(&args, None, cancel, report, files)
        },
        |report| summary(report, &args.out),
    )
}

/// Every row of a sweep, by one evaluator that keeps what rows share.
fn sweep_all(args: &EvalArgs, sweep: &Path) -> Exit {
    let evaluator = OnceCell::new();
    carry_out_each(
        &args.groom.graph,
        args.report.as_deref(),
        "hair",
        args.groom.strict,
        |files| {
            let rows = Sweep::read(sweep)?.all(args)?;
            files.reads(sweep, format!("--sweep {}", sweep.display())).map_err(Stop::refused)?;
            writes_all(rows.iter().flat_map(|(_, row)| row.out.iter().cloned()), files)?;
            formats(&args.out)?;
            let mut warnings = vec![];
            let made = args.groom.evaluator(cache_bytes(), &mut warnings)?;
            evaluator.get_or_init(|| made);
            warnings.iter().for_each(|warning| complain(format_args!("warning: {warning}")));
            files.allowed().map_err(Stop::failed)?;
            Ok(rows)
        },
        |row, cancel, report, files| evaluate(row, evaluator.get(), cancel, report, files),
        |row, report| summary(report, &row.out),
    )
}

/// How much is kept between rows of a sweep: a quarter of the memory that is free, 4 GiB at most.
pub(super) fn cache_bytes() -> usize {
    const MOST: u64 = 4 << 30;
    usize::try_from(memory::free().map_or(1 << 30, |free| free / 4).min(MOST)).unwrap_or(1 << 30)
}

/// Whether a report tells that these files were made from the very inputs that are there now.
fn is_done(args: &EvalArgs, path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Known {
        exit: u8,
        inputs: Option<String>,
        files: Vec<String>,
    }
    let known =
        std::fs::read(path).ok().and_then(|text| serde_json::from_slice::<Known>(&text).ok());
    let Some(known) = known.filter(|known| known.exit == 0 && known.inputs.is_some()) else {
        return false;
    };
    let (mut report, mut files) = (Report::new(String::new()), Together::default());
    let opened = args.groom.open(&mut report, &mut files);
    let is_there =
        |out: &PathBuf| out.is_file() && known.files.contains(&out.display().to_string());
    args.out.iter().all(is_there)
        && opened
            .is_ok_and(|opened| opened.inputs_hash(&args.how(&opened.document)) == known.inputs)
}

fn evaluate(
    args: &EvalArgs,
    evaluator: Option<&Evaluator>,
    cancel: &CancelToken,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    let out = HairFiles::new(&args.out, args.with_head)?;
    let opened = args.groom.open(report, files)?;
    opened.refuse_problems(&[], &mut report.warnings)?;
    files.allowed().map_err(Stop::failed)?;
    if args.report.is_some() {
        report.inputs = opened.inputs_hash(&args.how(&opened.document));
    }
    let evaluated = args.groom.evaluate(&opened, evaluator, cancel, report);
    let printed = if args.ledger { print_ledger(args, report) } else { Exit::Done };
    let evaluated = evaluated?;
    if printed != Exit::Done {
        return Err(Stop(printed, vec![]));
    }
    report.notes.extend(out.left_out(&evaluated.groups));
    let bar = Bar::new("files");
    let saved = out.write(&opened.document, &evaluated, cancel, &bar, files);
    bar.clear();
    saved
}

/// Prints what nodes cost, also where one failed or the budget is over. Where the report goes to stdout, it goes to stderr.
fn print_ledger(args: &EvalArgs, report: &Report) -> Exit {
    let row = report.row.as_ref().map_or(String::new(), |row| format!("{row}:\n"));
    let text = row + &ledger::table(&report.nodes);
    match args.report.as_deref().is_some_and(is_stdout) {
        true => {
            tell(text.trim_end());
            Exit::Done
        }
        false => print_plain(&text),
    }
}

impl EvalArgs {
    /// All but graph, head, seed and inputs that decides what is in the files.
    fn how(&self, document: &Document) -> String {
        let GroomArgs { output, quality, no_budget, .. } = &self.groom;
        let version = env!("CARGO_PKG_VERSION");
        let mut how = format!("coif {version} {output:?} {quality:?} {}", self.with_head);
        // What a wider budget let pass is not what a narrower one would.
        if !no_budget && !document.budget.is_empty() {
            how += &format!(" {:?}", document.budget.limits().collect::<Vec<_>>());
        }
        how
    }
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
