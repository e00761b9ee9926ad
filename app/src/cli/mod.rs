//! The command line: a contract that other tools rely on.
//!
//! Messages go to stderr, data to stdout. Exit codes: 0 done, 1 an evaluation or a write failed, 2 wrong before
//! anything ran, 130 interrupted. On anything but 0 no output file is touched.

mod check;
#[cfg(feature = "editor")]
mod edit;
pub(crate) mod eval;
pub(crate) mod files;
pub(crate) mod groom;
mod measure;
mod nodes;
pub(crate) mod progress;
#[cfg(feature = "render")]
pub(crate) mod render;
pub(crate) mod report;
mod unreal;

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
    /// Draw a graph's hair: pictures, turntables, heat maps
    #[cfg(feature = "render")]
    Render(Box<render::RenderArgs>),
    /// Check graphs without evaluating them: syntax, types, missing inputs, unknown nodes, a target's limits
    Check(check::CheckArgs),
    /// Print the manual of all nodes, or of one
    Nodes(nodes::NodesArgs),
    /// Measure exported strands: the laws of hair, from the file alone
    ///
    /// Curves are measured as their type, basis and wrap define them. Sublayers, references, payloads, selected variants and
    /// instances are followed into files of the same folder, below it, or of the same package; what is not read is said with the
    /// report. A prim or curve that contradicts itself is named, the others are measured, and the exit code is 1.
    Measure(measure::MeasureArgs),
}

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// All done; warnings are allowed.
    Done = 0,
    /// A node on the way to an output failed, none of them has curves, or writing failed.
    Failed = 1,
    /// Wrong before anything ran.
    Refused = 2,
    /// Somebody pressed Ctrl-C.
    Interrupted = 130,
}

pub(crate) fn main() -> ExitCode {
    let args = Args::parse();
    #[cfg(feature = "editor")]
    let given = args.edit.graph.is_some().then_some(Command::Edit(args.edit));
    #[cfg(not(feature = "editor"))]
    let given = None;
    let command = args.command.or(given).or_else(start_up);
    let exit = match command {
        #[cfg(feature = "editor")]
        Some(Command::Edit(args)) => edit::run(&args),
        Some(Command::Eval(args)) => eval::run(args),
        #[cfg(feature = "render")]
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Check(args)) => check::run(args),
        Some(Command::Nodes(args)) => nodes::run(args),
        Some(Command::Measure(args)) => measure::run(args),
        None => {
            complain(
                "say what to do, as in coif eval start --out start.usdc; --help has all commands",
            );
            Exit::Refused
        }
    };
    ExitCode::from(exit as u8)
}

/// What runs without a command: the editor. Where it has no display, or is not part of this program, the start-up groom is
/// drawn in the current folder.
fn start_up() -> Option<Command> {
    #[cfg(feature = "editor")]
    if edit::has_display() {
        return Some(Command::Edit(edit::EditArgs::default()));
    }
    if cfg!(not(feature = "render")) {
        return None;
    }
    complain("there is no display for the editor; the start-up groom is drawn to start.png");
    // Half the samples of a still: somebody waits to see anything at all.
    let words = ["coif", "render", "start", "--samples", "32", "--out", "start.png"];
    Args::parse_from(words).command
}

/// Tells a person what is wrong.
fn complain(text: impl std::fmt::Display) {
    eprintln!("coif: {text}");
}

/// Prints a line of data; a reader that went away is no error of ours.
fn print(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.write_all(b"\n"));
}

/// A lower-case extension without the dot.
pub(crate) fn extension_of(path: &std::path::Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// A path for messages.
fn shown(path: &std::path::Path) -> std::path::Display<'_> {
    path.display()
}
