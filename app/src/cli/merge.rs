//! `coif merge`: what two people made of one graph, made one; and the setting that lets git merge so.
//!
//! Guarantees: the file that is written opens in every case, and `coif check` does not pass what is left to decide; base and theirs
//! are never written over; on exit code 2 nothing was written. A comment that the result could not keep is told, and nothing is written.

use super::carry_out::in_one_step;
use super::diff::tell_warnings;
use super::{Exit, complain, complain_of, print_plain, tell};
use crate::files::{Role, Together};
use crate::jobs::stop::Stop;
use clap::Args;
use coif_graphs::compare::{Change, Merged, Said, merge};
use coif_graphs::document::Document;
use coif_graphs::file::{self, Loaded};
use coif_nodes::define::short;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Args)]
#[command(arg_required_else_help = true)]
pub(crate) struct MergeArgs {
    /// The graph that both began with
    #[arg(required_unless_present = "install_driver")]
    base: Option<PathBuf>,
    /// What one made of it; the result is written over it
    #[arg(required_unless_present = "install_driver")]
    ours: Option<PathBuf>,
    /// What the other made of it
    #[arg(required_unless_present = "install_driver")]
    theirs: Option<PathBuf>,
    /// Write the result here instead of over OURS
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What messages call the graph: git's own files have names that nobody knows
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Let git merge .ron files of this repository so: sets its driver, and adds a line to .gitattributes
    #[arg(long, conflicts_with_all = ["base", "out", "name"])]
    install_driver: bool,
}

pub(crate) fn run(args: &MergeArgs) -> Exit {
    let (Some(base), Some(ours), Some(theirs)) = (&args.base, &args.ours, &args.theirs) else {
        return install();
    };
    let out = args.out.as_ref().unwrap_or(ours);
    let name = args.name.clone().unwrap_or_else(|| out.display().to_string());
    let merged = in_one_step("no graph was written", |files, cancel| {
        told(files, [base, ours, theirs], out)?;
        let merged = merged([base, ours, theirs])?;
        let text = file::write(&merged.document);
        let written = files.write_text(out, &text, cancel);
        written.map_err(|why| vec![Stop::unwritten(out, &why, cancel)])?;
        Ok(merged)
    });
    match merged {
        Ok(merged) => report(&name, &merged),
        // 1 says that there is a result.
        Err(Exit::Failed) => Exit::Refused,
        Err(exit) => exit,
    }
}

/// Tells what is read and what is written. OURS may be written over; it is what git asks for.
fn told(
    files: &mut Together,
    [base, ours, theirs]: [&Path; 3],
    out: &Path,
) -> Result<(), Vec<Stop>> {
    if out == ours && !ours.exists() {
        return Err(vec![Stop::refused(format!("{}: no such file", ours.display()))]);
    }
    let words = |what: &str, path: &Path| format!("{what} {}", path.display());
    files
        .writes(out, Role::Output, words("the result", out))
        .and_then(|()| files.reads(base, words("the base", base)))
        .and_then(|()| files.reads(theirs, words("theirs", theirs)))
        .and_then(|()| files.allowed())
        .map_err(|why| vec![Stop::refused(why)])
}

/// Reads and merges.
fn merged([base, ours, theirs]: [&Path; 3]) -> Result<Merged, Vec<Stop>> {
    let read = |path: &Path, is_base: bool| -> Result<Document, Stop> {
        // Of a file that both added git gives an empty base.
        if is_base && std::fs::metadata(path).is_ok_and(|about| about.is_file() && about.len() == 0)
        {
            return Ok(Document::default());
        }
        let (Loaded { document, warnings, conflicts, dropped_comments }, _) =
            crate::jobs::open::read(path)?;
        tell_warnings(path, conflicts.iter().chain(&warnings));
        let lost = match is_base {
            true => vec![],
            false => crate::jobs::open::lost_comments(path, &dropped_comments),
        };
        if lost.is_empty() { Ok(document) } else { Err(Stop(Exit::Refused, lost)) }
    };
    match (read(base, true), read(ours, false), read(theirs, false)) {
        (Ok(base), Ok(ours), Ok(theirs)) => Ok(merge(&base, &ours, &theirs)),
        (base, ours, theirs) => {
            Err([base, ours, theirs].into_iter().filter_map(Result::err).collect())
        }
    }
}

/// Says how it ended.
fn report(name: &str, Merged { conflicts, yielded, lost, .. }: &Merged) -> Exit {
    let told = conflicts.iter().map(|conflict| format!("{name}: conflict: {conflict}"));
    let lost = lost.iter().map(|Change { fact, to, .. }| {
        let value = to.as_ref().map_or(String::new(), Said::text);
        format!(
            "warning: {name}: {fact} = {}: lost, the other has no such port any more, or one that takes something else",
            short(&value)
        )
    });
    complain_of(told.chain(lost).collect());
    if !yielded.is_empty() {
        complain(format_args!(
            "note: {name}: {} moved by both on the canvas stand where ours has them",
            yielded.len()
        ));
    }
    if conflicts.is_empty() {
        return Exit::Done;
    }
    tell(format_args!(
        "{name}: merged, but for {}; ours is kept there: choose, and remove the comments that begin with \"{}\"",
        match conflicts.len() {
            1 => "1 conflict".to_owned(),
            n => format!("{n} conflicts"),
        },
        coif_graphs::file::CONFLICT
    ));
    Exit::Failed
}

/// The line of `.gitattributes`.
const ATTRIBUTE: &str = "*.ron merge=coif";

/// Lets git merge grooms of the repository that the current folder is in.
fn install() -> Exit {
    let done = in_one_step("nothing was installed", |files, cancel| {
        let refused = |why: String| vec![Stop::refused(why)];
        let top = git(&["rev-parse", "--show-toplevel"]).map_err(refused)?;
        let program = std::env::current_exe()
            .map_err(|err| refused(format!("where this program is: {err}")))?;
        let driver =
            format!("{} merge %O %A %B --out %A --name %P", quoted(&program.to_string_lossy()));
        let path = Path::new(&top).join(".gitattributes");
        let added = attribute(files, &path, cancel)?;
        git(&["config", "merge.coif.name", "coif: grooms, by what they say"]).map_err(refused)?;
        git(&["config", "merge.coif.driver", &driver]).map_err(refused)?;
        Ok((driver, path, added))
    });
    let (driver, path, added) = match done {
        Ok(done) => done,
        Err(exit) => return exit,
    };
    let line = match added {
        true => format!("{}: added {ATTRIBUTE}; commit it for all who work here", path.display()),
        false => format!("{}: has {ATTRIBUTE} already", path.display()),
    };
    print_plain(&format!("git config merge.coif.driver: {driver}\n{line}"))
}

/// Adds the line to `.gitattributes`, beside its place; whether it was not there.
fn attribute(
    files: &mut Together,
    path: &Path,
    cancel: &coif_graphs::schedule::run::CancelToken,
) -> Result<bool, Vec<Stop>> {
    let fault = |why: String| vec![Stop::refused(format!("{}: {why}", path.display()))];
    let mut text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(err) if err.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(err) => return Err(fault(err.to_string())),
    };
    if text.lines().any(|line| line.split_whitespace().eq(ATTRIBUTE.split_whitespace())) {
        return Ok(false);
    }
    if !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
    text += ATTRIBUTE;
    text.push('\n');
    files.writes(path, Role::Output, path.display().to_string()).map_err(fault)?;
    files.allowed().map_err(|why| vec![Stop::refused(why)])?;
    files.write_text(path, &text, cancel).map_err(fault)?;
    Ok(true)
}

/// A text as a shell takes it for one word, and git for no sign of its own.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''").replace('%', "%%"))
}

/// What git says on its first line; else why not.
fn git(args: &[&str]) -> Result<String, String> {
    let out = Command::new("git").args(args).output().map_err(|err| format!("git: {err}"))?;
    let first =
        |bytes: &[u8]| String::from_utf8_lossy(bytes).lines().next().unwrap_or_default().to_owned();
    match out.status.success() {
        true => Ok(first(&out.stdout)),
        false => Err(format!("git {}: {}", args.join(" "), first(&out.stderr))),
    }
}
