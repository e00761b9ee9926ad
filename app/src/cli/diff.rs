//! `coif diff`: what differs between two graphs, in words or for tools.
//!
//! Guarantees: nothing is evaluated or written; the exit code is 0 exactly when both say the same, however they are laid out as text.

use super::{Exit, complain_of, ending, print, print_plain};
use crate::jobs::open::Read;
use crate::jobs::stop::Stop;
use crate::words::plain_json;
use clap::Args;
use coif_graphs::compare::{Change, Drawn, Said, diff, drawn, is_same_hair, lines};
use coif_graphs::document::Document;
use coif_graphs::file::FileError;
use serde_json::{Value as Json, json};
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct DiffArgs {
    /// The graph as it was: a .ron file, or the name of a shipped groom
    a: PathBuf,
    /// The graph as it is
    b: PathBuf,
    /// Also say how much stands elsewhere on the canvas
    #[arg(long)]
    all: bool,
    /// Print JSON for other tools
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &DiffArgs) -> Exit {
    ending::at_once();
    let DiffArgs { a, b, all, json } = args;
    let Some([a, b]) = read_all([a, b]) else { return Exit::Refused };
    let is_same_text = a.text == b.text;
    let (from, to) = (a.loaded.document, b.loaded.document);
    let changes = diff(&from, &to);
    let is_same_hair = is_same_hair(&from, &to, &changes);
    let printed = match json {
        true => print(&plain_json(&as_json(args, [&from, &to], &changes, is_same_hair))),
        false => {
            let mut said = lines(&from, &to, *all);
            said.extend(
                closing(args, &changes, is_same_hair, said.is_empty(), is_same_text)
                    .map(str::to_owned),
            );
            print_plain(&said.join("\n"))
        }
    };
    printed.max(if changes.is_empty() { Exit::Done } else { Exit::Failed })
}

/// The graphs of all files, with their warnings told; else what is wrong with each that cannot be read is told.
fn read_all<const N: usize>(paths: [&PathBuf; N]) -> Option<[Read; N]> {
    let read = paths.iter().map(|path| crate::jobs::open::read_packed(path, false));
    let read: Vec<Result<Read, Stop>> = read.collect();
    let wrong = read.iter().filter_map(|read| read.as_ref().err());
    let wrong: Vec<String> = wrong.flat_map(|stop| stop.lines().to_vec()).collect();
    if !wrong.is_empty() {
        complain_of(wrong);
        return None;
    }
    let all: Vec<Read> = read.into_iter().flatten().collect();
    for Read { loaded, shown, .. } in &all {
        tell_warnings(Path::new(shown), loaded.conflicts.iter().chain(&loaded.warnings));
    }
    all.try_into().ok()
}

/// Tells what a file says that this version cannot use.
pub(super) fn tell_warnings<'a>(path: &Path, all: impl Iterator<Item = &'a FileError>) {
    complain_of(all.map(|w| format!("warning: {}", w.of_file(path.display()))).collect());
}

/// What is to be said where nothing that makes hair differs.
fn closing(
    DiffArgs { all, .. }: &DiffArgs,
    changes: &[Change],
    is_same_hair: bool,
    said_nothing: bool,
    is_same_text: bool,
) -> Option<&'static str> {
    match () {
        () if changes.is_empty() && is_same_text => Some("the same groom"),
        () if changes.is_empty() => Some("the same groom, laid out otherwise as text"),
        () if is_same_hair && said_nothing && !all => {
            Some("the same hair: only places on the canvas differ (--all counts them)")
        }
        () if is_same_hair => Some("the same hair"),
        () => None,
    }
}

fn as_json(
    DiffArgs { a, b, .. }: &DiffArgs,
    [from, to]: [&Document; 2],
    changes: &[Change],
    is_same_hair: bool,
) -> String {
    let json = json!({
        "a": a.display().to_string(),
        "b": b.display().to_string(),
        "same": changes.is_empty(),
        "same_hair": is_same_hair,
        "words": lines(from, to, true),
        "changes": changes.iter().map(|change| of_change([from, to], change)).collect::<Vec<_>>(),
    });
    serde_json::to_string_pretty(&json).unwrap_or_default()
}

fn of_change([from, to]: [&Document; 2], change: &Change) -> Json {
    let (what, name) = change.fact.named();
    let mut json = json!({ "what": what });
    if let Some(id) = change.fact.node() {
        json["node"] = json!(id.as_str());
        let of = if to.nodes.contains_key(id) { to } else { from };
        json["called"] = json!(of.name_of(id));
    }
    if let Some(name) = name {
        json["name"] = json!(name);
    }
    match drawn(change) {
        Some(Drawn { word: _, added, removed, changed, is_reordered }) => {
            let changed = changed.iter().map(|(id, moved)| json!({"id": id, "moved_cm": moved}));
            json["added"] = json!(added);
            json["removed"] = json!(removed);
            json["changed"] = changed.collect();
            json["reordered"] = json!(is_reordered);
        }
        None => {
            json["from"] = json!(change.from.as_ref().map(Said::text));
            json["to"] = json!(change.to.as_ref().map(Said::text));
        }
    }
    json
}
