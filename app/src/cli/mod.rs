//! The command line: a contract that other tools rely on.
//!
//! Messages go to stderr, data to stdout. Exit codes: 0 done, 1 an evaluation failed or a file cannot be written, 2 wrong before
//! anything ran, 130 asked to end. On anything but 0 no output is touched; a report is written then, too.

mod batch;
mod carry_out;
mod check;
mod diff;
#[cfg(feature = "editor")]
mod edit;
mod ending;
pub(crate) mod eval;
mod examples;
mod fit;
mod fmt;
mod given;
mod groom;
mod ledger;
mod lines;
mod measure;
mod merge;
mod nodes;
mod pack;
#[cfg(feature = "render")]
mod probe;
mod progress;
#[cfg(feature = "render")]
pub(crate) mod render;
mod schema;
mod signals;
mod sweep;
mod tasks;
mod template;
mod thumbnail;
mod trace;

use crate::files::extension_of;
use crate::jobs::report;
use crate::jobs::stop::{Exit, Stop};
use crate::words::{first_of, plain};
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Groom editor made of nodes: braids, partitions, curls and puffs.
#[derive(Parser)]
#[command(name = "coif", version, propagate_version = true, subcommand_negates_reqs = true)]
#[cfg_attr(feature = "editor", command(args_conflicts_with_subcommands = true))]
struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[cfg(feature = "editor")]
    #[command(flatten)]
    edit: edit::EditArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Open the editor, on a graph or on the start-up groom
    #[cfg(feature = "editor")]
    Edit(edit::EditArgs),
    /// Evaluate a graph and write its hair
    Eval(eval::EvalArgs),
    /// Bring a groom to another head by landmarks, and say what became of it
    ///
    /// The graph is evaluated on its own head and on the other one; a new graph is written, in which everything that is given in head
    /// units is carried over: landmarks meet, and between them all moves with them.
    Fit(fit::FitArgs),
    /// Draw a graph's hair: pictures, turntables, heat maps
    #[cfg(feature = "render")]
    Render(Box<render::RenderArgs>),
    /// Say what a picture shows at a place: the skin there, its region and section, and the hair above it
    #[cfg(feature = "render")]
    Probe(Box<probe::ProbeArgs>),
    /// Write a job for farms (Open Job Description) that evaluates graphs on heads, with seeds and rows of a table; or collect reports
    Batch(batch::BatchArgs),
    /// Check graphs without evaluating them: syntax, types, missing inputs, unknown nodes, a target's limits
    Check(check::CheckArgs),
    /// Write graphs as the editor would save them: one fact a line, in the order that git merges
    Fmt(fmt::FmtArgs),
    /// Say what differs between two graphs, as a groomer says it: exit code 0 nothing, 1 something, 2 one cannot be read
    Diff(diff::DiffArgs),
    /// Merge what two people made of one graph: exit code 0 clean, 1 with conflicts, 2 nothing was written
    ///
    /// What both changed, each otherwise, stays as OURS has it, with a comment before it that names the other; `coif check` lets none
    /// of these pass. The result is written over OURS, as git's merge drivers do; --install-driver lets git merge so.
    Merge(merge::MergeArgs),
    /// Templates: groups that travel between grooms and shows
    Template(template::TemplateArgs),
    /// Say which nodes, strokes and gestures made one hair
    ///
    /// Found by switching them off: whatever is not listed can be off, and the points and widths of the hair keep their bits.
    Trace(trace::TraceArgs),
    /// Print the manual of all nodes, or of one
    Nodes(nodes::NodesArgs),
    /// Measure exported strands: the laws of hair, from the file alone
    ///
    /// Curves are measured as their type, basis and wrap define them. Sublayers, references, payloads, selected variants and
    /// instances are followed into files of the same folder, below it, or of the same package; what is not read is said with the
    /// report. A prim or curve that contradicts itself is named, the others are measured, and the exit code is 1; so it is for
    /// Alembic objects whose curves are of a kind that is not read, such as NURBS.
    Measure(measure::MeasureArgs),
}

/// Ends a command that prints what it found: first the report's warnings, then the finding, or the reason there is none.
fn answer(mut report: report::Report, found: Result<String, Stop>) -> Exit {
    for warning in first_of(std::mem::take(&mut report.warnings)) {
        complain(format_args!("warning: {warning}"));
    }
    match found {
        Ok(text) => print_plain(text.trim_end()),
        Err(stop) => {
            first_of(stop.lines().to_vec()).iter().for_each(complain);
            stop.exit()
        }
    }
}

pub(crate) fn main() -> ExitCode {
    let args = Args::try_parse().unwrap_or_else(|err| {
        let text = err.render().to_string();
        if text != plain(&text) && err.use_stderr() {
            tell(text.trim_end());
            std::process::exit(err.exit_code());
        }
        err.exit()
    });
    #[cfg(feature = "editor")]
    let given = args.edit.graph.is_some().then_some(Command::Edit(args.edit));
    #[cfg(not(feature = "editor"))]
    let given = None;
    let exit = match args.command.or(given) {
        #[cfg(feature = "editor")]
        Some(Command::Edit(args)) => edit::run(&args),
        Some(Command::Eval(args)) => eval::run(args),
        Some(Command::Fit(args)) => fit::run(&args),
        #[cfg(feature = "render")]
        Some(Command::Render(args)) => render::run(&args),
        #[cfg(feature = "render")]
        Some(Command::Probe(args)) => probe::run(&args),
        Some(Command::Batch(args)) => batch::run(&args),
        Some(Command::Check(args)) => check::run(args),
        Some(Command::Fmt(args)) => fmt::run(&args),
        Some(Command::Diff(args)) => diff::run(&args),
        Some(Command::Merge(args)) => merge::run(&args),
        Some(Command::Template(args)) => template::run(&args),
        Some(Command::Trace(args)) => trace::run(args),
        Some(Command::Nodes(args)) => nodes::run(args),
        Some(Command::Measure(args)) => measure::run(args),
        None => start_up(),
    };
    ExitCode::from(exit as u8)
}

/// What runs without a command: the editor. Where it has no display, or is not part of this program, the start-up groom is drawn
/// in the current folder; where nothing can be drawn either, its hair is written there. No file is written over.
#[cfg(feature = "render")]
fn start_up() -> Exit {
    use coif_shaders::{Gpu, Precision};
    #[cfg(feature = "editor")]
    if edit::has_display() {
        return edit::run(&edit::EditArgs::default());
    }
    let drawn = Gpu::new(Precision::Best).map(drop);
    let made = free_name("start", if drawn.is_ok() { "png" } else { "usdc" });
    match drawn {
        Ok(()) => {
            complain(format!(
                "there is no display for the editor; the start-up groom is drawn to {made}"
            ));
            render::plainly("start", &made)
        }
        Err(why) => {
            complain(format!(
                "there is no display for the editor, and no picture can be drawn: {why}"
            ));
            complain(format!("the hair of the start-up groom is written to {made} instead"));
            eval::plainly("start", &made)
        }
    }
}

/// Without window and pictures somebody has to say what is to be done.
#[cfg(not(feature = "render"))]
fn start_up() -> Exit {
    complain("say what to do, as in coif eval start --out start.usdc; --help has all commands");
    Exit::Refused
}

/// The first name in the current folder that nothing has: `start.png`, then `start-2.png`.
#[cfg(feature = "render")]
fn free_name(stem: &str, ending: &str) -> String {
    let plain = format!("{stem}.{ending}");
    let is_free = |name: &String| std::path::Path::new(name).symlink_metadata().is_err();
    if is_free(&plain) {
        return plain;
    }
    complain(format!("{plain} is there already and stays as it is"));
    (2..).map(|n| format!("{stem}-{n}.{ending}")).find(is_free).unwrap_or(plain)
}

/// Tells a person what is wrong.
fn complain(text: impl std::fmt::Display) {
    tell(format_args!("coif: {text}"));
}

/// Says something to whoever watches; that nobody listens any more, or that there is no room for it, ends nothing.
fn tell(text: impl std::fmt::Display) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr().lock(), "{}", plain(&text.to_string()));
}

/// Tells a person what is wrong, the first of it and how much more there is.
fn complain_of(problems: Vec<String>) {
    first_of(problems).iter().for_each(complain);
}

/// Prints a line of data that quotes, and gives how that ended.
fn print_plain(text: &str) -> Exit {
    print(&plain(text))
}

/// Prints a line of data, and gives how that ended; a reader that went away is no error of ours.
fn print(text: &str) -> Exit {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match out
        .write_all(text.as_bytes())
        .and_then(|()| out.write_all(b"\n"))
        .and_then(|()| out.flush())
    {
        Err(err) if err.kind() != ErrorKind::BrokenPipe => {
            complain(format_args!("standard output: {err}"));
            Exit::Failed
        }
        _ => Exit::Done,
    }
}

/// A path for messages.
fn shown(path: &std::path::Path) -> std::path::Display<'_> {
    path.display()
}
