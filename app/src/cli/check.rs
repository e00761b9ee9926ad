//! `coif check`: what is wrong with graphs, without evaluating them (or, with a target, what that target would refuse).
//!
//! Guarantees: what `coif eval` would refuse before anything ran is an error here, but for a graph without outputs, which may be
//! evaluated by `--output`. Files that a graph names are opened and read as its nodes would read them. What only an evaluation finds is
//! not found here.

use super::lines::Lines;
use super::{Exit, complain, complain_of, ending, print_plain};
use crate::jobs::evaluate::{Opened, nowhere};
use crate::jobs::open::{Read, take_said};
use crate::jobs::stop::not_strict;
use crate::jobs::unreal;
use clap::{Args, ValueEnum};
use coif_graphs::document::Document;
use coif_graphs::document::graph::{Severity, check, leading_nowhere, targets, upstream};
use coif_graphs::file::Loaded;
use coif_graphs::schedule::files::{DiskFiles, Files, named};
use coif_graphs::schedule::request::BadRequest;
use coif_nodes::define::{Holds, Type, short};
use coif_nodes::formats::picture_in::{Channel, read_picture};
use coif_nodes::formats::read_mesh;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct CheckArgs {
    /// Graphs: .ron files, or names of shipped grooms
    #[arg(required = true)]
    graphs: Vec<PathBuf>,
    /// Warnings are errors too (exit code 2): for farms
    #[arg(long)]
    strict: bool,
    /// Also evaluate, and tell what a program would cut off (exit code 2), and what it would make up (a note)
    #[arg(long, value_enum)]
    target: Option<TargetProgram>,
    /// With a target: evaluate even what makes more than 16.8 million points
    #[arg(long)]
    allow_large: bool,
}

/// A program that grooms are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TargetProgram {
    /// Unreal Engine's groom asset
    Unreal,
}

/// What is wrong with files that a document names, each with whether that keeps it from being evaluated, and the input that names it.
pub(super) fn files(document: &Document, disk: &dyn Files) -> Vec<(bool, String, String, String)> {
    let needed = upstream(document, &targets(document));
    let fault = |holds: Holds, path: &str| -> Option<String> {
        let file = match disk.read(path) {
            Ok(file) => file,
            Err(why) => return Some(why),
        };
        let side = |name: &str| file.sides.get(name).cloned();
        match holds {
            Holds::Picture => read_picture(&file.bytes, Channel::Luminance).err(),
            Holds::Mesh => {
                read_mesh(&file.extension, &file.bytes, &side).err().map(|err| err.to_string())
            }
        }
    };
    let all = named(document).into_iter();
    let told = all.filter_map(|(node, input, path)| {
        let (_, input_def) = document.def(node)?.input(input)?;
        let why = match input_def.holds {
            Some(holds) => fault(holds, &path)?,
            // What a port's file holds, the node that reads it knows.
            None if input_def.ty == Type::File => disk.read(&path).err()?,
            None => return None,
        };
        let text = format!("{}: {why}", short(&path));
        Some((needed.contains(node), node.to_string(), input.to_owned(), text))
    });
    told.collect()
}

/// What an evaluation would refuse before it ran a node.
fn foreseen(document: &Document, folder: &Path, disk: &dyn Files) -> Vec<BadRequest> {
    let opened = Opened::of(document.clone(), folder.to_owned(), String::new(), false);
    opened.map_or(vec![], |opened| opened.foreseen(disk))
}

/// What is wrong with a graph: whether each keeps it from being evaluated, its line, and what it is.
fn problems(
    document: &Document,
    folder: &Path,
    lines: &Lines,
) -> Vec<(bool, Option<usize>, String)> {
    let disk = DiskFiles::new(folder);
    let problems = check(document).into_iter().map(|p| {
        let line = lines.of_input(p.node.as_str(), p.socket.as_deref());
        (p.severity == Severity::Error, line, p.to_string())
    });
    let of_files = files(document, &disk).into_iter().map(|(is_error, node, input, text)| {
        (is_error, lines.of_input(&node, Some(&input)), format!("{node}.{input}: {text}"))
    });
    let mut told: Vec<(bool, Option<usize>, String)> = problems.chain(of_files).collect();
    if !told.iter().any(|(is_error, ..)| *is_error) {
        let bad = foreseen(document, folder, &disk).into_iter();
        told.extend(bad.map(|bad| (true, lines.of_input(&bad.node, None), bad.to_string())));
    }
    told
}

pub(crate) fn run(args: CheckArgs) -> Exit {
    ending::at_once();
    args.graphs.iter().fold(Exit::Done, |exit, path| exit.max(looked_at(path, &args)))
}

/// Tells what is wrong with one graph.
fn looked_at(path: &Path, args: &CheckArgs) -> Exit {
    let read = crate::jobs::open::read_packed(path, args.allow_large);
    let Read { loaded, text, folder, shown } = match read {
        Ok(read) => read,
        Err(stop) => {
            complain_of(stop.lines().to_vec());
            return Exit::Refused;
        }
    };
    let Loaded { document, warnings, conflicts, dropped_comments: _ } = loaded;
    let mut warnings: Vec<String> = warnings.iter().map(|w| w.of_file(&shown)).collect();
    let conflicts: Vec<String> = conflicts.iter().map(|c| c.of_file(&shown)).collect();
    let folder = folder.unwrap_or_default();
    let lines = Lines::of(&String::from_utf8_lossy(&text));
    let told = problems(&document, &folder, &lines);
    for (.., problem) in &told {
        take_said(&mut warnings, &shown, problem);
    }
    let at = |line: Option<usize>| {
        let line = line.map_or(String::new(), |line| format!("{line}:"));
        format!("{shown}:{line}")
    };
    let warned = warnings.iter().map(|warning| format!("warning: {warning}"));
    let problems = told.iter().map(|(is_error, line, problem)| {
        let kind = if *is_error { "" } else { "warning: " };
        format!("{kind}{} {problem}", at(*line))
    });
    complain_of(conflicts.iter().cloned().chain(warned).chain(problems).collect());
    let notes = leading_nowhere(&document)
        .into_iter()
        .map(|id| format!("note: {} {}", at(lines.of_input(id.as_str(), None)), nowhere(&id)));
    complain_of(notes.collect());
    let wrong = told.iter().filter(|(is_error, ..)| *is_error).count();
    let errors = wrong + conflicts.len();
    let strict = args.strict && warnings.len() + told.len() > wrong;
    if strict && errors == 0 {
        complain(not_strict(path));
    }
    if errors > 0 || strict {
        return Exit::Refused;
    }
    let found = match args.target {
        Some(TargetProgram::Unreal) => {
            unreal::found(&document, folder, shown.clone(), args.allow_large)
        }
        None => Ok(unreal::ImportReport::default()),
    };
    let found = match found {
        Ok(found) => found,
        Err(stop) => {
            complain_of(stop.lines().to_vec());
            return Exit::Refused;
        }
    };
    for line in &found.lost {
        complain(format!("{shown}: {line}"));
    }
    for line in &found.made_up {
        complain(format!("note: {shown}: {line}"));
    }
    match found.lost.is_empty() {
        true => print_plain(&format!("{shown}: {} nodes, no errors", document.nodes.len())),
        false => Exit::Refused,
    }
}
