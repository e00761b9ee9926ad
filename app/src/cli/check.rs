//! `coif check`: what is wrong with graphs, without evaluating them (or, with a target, what that target would refuse).

use super::{Exit, complain, ending, groom, print, unreal};
use clap::{Args, ValueEnum};
use coif_graphs::document::graph::{Severity, check};
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct CheckArgs {
    /// Graphs: .ron files, or names of shipped grooms
    #[arg(required = true)]
    graphs: Vec<PathBuf>,
    /// Also evaluate, and tell what a program would cut off (exit code 2), and what it would make up (a note)
    #[arg(long, value_enum)]
    target: Option<Target>,
    /// With a target: evaluate even what makes more than 16.8 million points
    #[arg(long)]
    allow_large: bool,
}

/// A program that grooms are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Target {
    /// Unreal Engine's groom asset
    Unreal,
}

pub(crate) fn run(args: CheckArgs) -> Exit {
    ending::at_once();
    let mut exit = Exit::Done;
    for path in &args.graphs {
        let shown = path.display();
        let mut warnings = vec![];
        let (document, folder) = match groom::load(path, &mut warnings) {
            Ok(loaded) => loaded,
            Err(stop) => {
                stop.lines().iter().for_each(complain);
                exit = Exit::Refused;
                continue;
            }
        };
        warnings.iter().for_each(|w| complain(format!("warning: {w}")));
        let problems = check(&document);
        let errors = problems.iter().filter(|p| p.severity == Severity::Error).count();
        for problem in &problems {
            let kind = if problem.severity == Severity::Error { "" } else { "warning: " };
            complain(format!("{kind}{shown}: {problem}"));
        }
        if errors > 0 {
            exit = Exit::Refused;
            continue;
        }
        let found = match args.target {
            Some(Target::Unreal) => {
                match unreal::found(&document, folder, shown.to_string(), args.allow_large) {
                    Ok(found) => found,
                    Err(stop) => {
                        stop.lines().iter().for_each(complain);
                        exit = Exit::Refused;
                        continue;
                    }
                }
            }
            None => unreal::Found::default(),
        };
        for line in &found.lost {
            complain(format!("{shown}: {line}"));
            exit = Exit::Refused;
        }
        for line in &found.made_up {
            complain(format!("note: {shown}: {line}"));
        }
        if found.lost.is_empty() {
            exit = exit.max(print(&format!("{shown}: {} nodes, no errors", document.nodes.len())));
        }
    }
    exit
}
