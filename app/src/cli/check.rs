//! `coif check`: what is wrong with graphs, without evaluating them (or, with a target, what that target would refuse).
//!
//! Files that a graph names are opened and read as its nodes would read them. What only an evaluation finds is not found here.

use super::lines::Lines;
use super::{Exit, complain, complain_of, ending, print_plain, unreal};
use crate::jobs::open::{Read, take_said};
use crate::jobs::stop::not_strict;
use clap::{Args, ValueEnum};
use coif_graphs::document::Document;
use coif_graphs::document::graph::{Severity, check, targets, upstream};
use coif_graphs::file::Loaded;
use coif_graphs::schedule::files::{DiskFiles, Files, named};
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
fn files(document: &Document, folder: &Path) -> Vec<(bool, String, String, String)> {
    let needed = upstream(document, &targets(document));
    let disk = DiskFiles::new(folder);
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

pub(crate) fn run(args: CheckArgs) -> Exit {
    ending::at_once();
    let mut exit = Exit::Done;
    for path in &args.graphs {
        let Read { loaded, text, folder, shown } =
            match crate::jobs::open::read_packed(path, args.allow_large) {
                Ok(read) => read,
                Err(stop) => {
                    complain_of(stop.lines().to_vec());
                    exit = Exit::Refused;
                    continue;
                }
            };
        let Loaded { document, warnings, conflicts, dropped_comments: _ } = loaded;
        let mut warnings: Vec<String> = warnings.iter().map(|w| w.of_file(&shown)).collect();
        let conflicts: Vec<String> = conflicts.iter().map(|c| c.of_file(&shown)).collect();
        let problems = check(&document);
        let folder = folder.unwrap_or_default();
        let lines = Lines::of(&String::from_utf8_lossy(&text));
        let told = problems.iter().map(|p| {
            let line = lines.of_input(p.node.as_str(), p.socket.as_deref());
            (p.severity == Severity::Error, line, p.to_string())
        });
        let of_files =
            files(&document, &folder).into_iter().map(|(is_error, node, input, text)| {
                (is_error, lines.of_input(&node, Some(&input)), format!("{node}.{input}: {text}"))
            });
        let told: Vec<(bool, Option<usize>, String)> = told.chain(of_files).collect();
        for (.., problem) in &told {
            take_said(&mut warnings, &shown, problem);
        }
        let warned = warnings.iter().map(|warning| format!("warning: {warning}"));
        let all = conflicts.iter().cloned().chain(warned).chain(told.iter().map(
            |(is_error, line, problem)| {
                let kind = if *is_error { "" } else { "warning: " };
                let line = line.map_or(String::new(), |line| format!("{line}:"));
                format!("{kind}{shown}:{line} {problem}")
            },
        ));
        complain_of(all.collect());
        let wrong = told.iter().filter(|(is_error, ..)| *is_error).count();
        let errors = wrong + conflicts.len();
        let strict = args.strict && warnings.len() + told.len() > wrong;
        if strict && errors == 0 {
            complain(not_strict(path));
        }
        if errors > 0 || strict {
            exit = Exit::Refused;
            continue;
        }
        let found = match args.target {
            Some(TargetProgram::Unreal) => {
                match unreal::found(&document, folder, shown.clone(), args.allow_large) {
                    Ok(found) => found,
                    Err(stop) => {
                        complain_of(stop.lines().to_vec());
                        exit = Exit::Refused;
                        continue;
                    }
                }
            }
            None => unreal::ImportReport::default(),
        };
        for line in &found.lost {
            complain(format!("{shown}: {line}"));
            exit = Exit::Refused;
        }
        for line in &found.made_up {
            complain(format!("note: {shown}: {line}"));
        }
        if found.lost.is_empty() {
            exit = exit
                .max(print_plain(&format!("{shown}: {} nodes, no errors", document.nodes.len())));
        }
    }
    exit
}
