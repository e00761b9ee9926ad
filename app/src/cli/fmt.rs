//! `coif fmt`: graphs as the editor would save them, without evaluating them.
//!
//! Guarantees: what it writes is what the editor's save writes, to the byte, and a fixed point; all files are written or
//! none; a file that is so already is not touched; no comment is lost: one that stands where none can be kept is told, and nothing
//! is written.

use super::carry_out::in_one_step;
use super::{Exit, complain, print};
use crate::files::{Role, Together};
use crate::jobs::stop::Stop;
use clap::Args;
use coif_graphs::file;
use coif_graphs::schedule::run::CancelToken;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct FmtArgs {
    /// Graphs: .ron files
    #[arg(required = true)]
    graphs: Vec<PathBuf>,
    /// Write nothing; name the files that would change, and end with 1 where there are any
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(args: &FmtArgs) -> Exit {
    let written =
        in_one_step("no graph was written", |files, cancel| write_all(args, files, cancel));
    let changed = match written {
        Ok(changed) => changed,
        Err(exit) => return exit,
    };
    let printed = changed.iter().map(|path| print(&path.display().to_string())).max();
    let found = if args.check && !changed.is_empty() { Exit::Failed } else { Exit::Done };
    printed.unwrap_or(Exit::Done).max(found)
}

/// Writes what changes beside its place, and gives its names; else all that is wrong with the files.
fn write_all(
    args: &FmtArgs,
    files: &mut Together,
    cancel: &CancelToken,
) -> Result<Vec<PathBuf>, Vec<Stop>> {
    let (mut changed, mut wrong) = (vec![], vec![]);
    for path in &args.graphs {
        match formatted(path) {
            Ok(Some(text)) => changed.push((path, text)),
            Ok(None) => {}
            Err(lines) => wrong.push(Stop(Exit::Refused, lines)),
        }
    }
    if wrong.is_empty() && !args.check {
        let writes = changed.iter().try_for_each(|(path, _)| {
            files.writes(path, Role::Output, format!("the graph {}", path.display()))
        });
        if let Err(why) = writes {
            wrong.push(Stop::refused(why));
        } else if let Err(why) = files.allowed() {
            wrong.push(Stop::failed(why));
        }
    }
    if !wrong.is_empty() {
        return Err(wrong);
    }
    for (path, text) in changed.iter().filter(|_| !args.check) {
        let written = files.write_text(path, text, cancel);
        written.map_err(|why| vec![Stop::unwritten(path, &why, cancel)])?;
    }
    Ok(changed.into_iter().map(|(path, _)| path.clone()).collect())
}

/// A graph's text as the editor would save it; none where it is that already.
fn formatted(path: &Path) -> Result<Option<String>, Vec<String>> {
    let shown = path.display();
    let refused = |why: String| vec![format!("{shown}: {why}")];
    let about = std::fs::metadata(path).map_err(|err| refused(err.to_string()))?;
    if !about.is_file() || about.len() > crate::files::MOST_DOCUMENT {
        return Err(refused("is no file of at most 256 MiB, as graphs are".to_owned()));
    }
    let bytes = std::fs::read(path).map_err(|err| refused(err.to_string()))?;
    let loaded = file::read_bytes(&bytes).map_err(|err| vec![err.of_file(path.display())])?;
    for warning in loaded.conflicts.iter().chain(&loaded.warnings) {
        complain(format_args!("warning: {}", warning.of_file(path.display())));
    }
    let lost = crate::jobs::open::lost_comments(path, &loaded.dropped_comments);
    if !lost.is_empty() {
        return Err(lost);
    }
    let text = file::write(&loaded.document);
    Ok((text.as_bytes() != bytes).then_some(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_graphs::grooms::{ALL, TEMPLATES};

    /// Graphs in a folder of their own, formatted: how it ended.
    fn fmt(folder: &Path, names: &[&str], check: bool) -> Exit {
        let graphs = names.iter().map(|name| folder.join(name)).collect();
        run(&FmtArgs { graphs, check })
    }
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("coif-fmt-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn grooms_of_the_pages_for_artists_are_as_they_would_be_saved() {
        let pages = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/artists");
        let all = std::fs::read_dir(pages).unwrap().map(|entry| entry.unwrap().path());
        let graphs: Vec<PathBuf> =
            all.filter(|path| path.extension() == Some("ron".as_ref())).collect();
        assert!(graphs.len() >= 4, "{graphs:?}");
        assert_eq!(run(&FmtArgs { graphs, check: true }), Exit::Done);
    }

    #[test]
    fn shipped_grooms_are_as_they_would_be_saved() {
        for (name, text) in ALL.iter().chain(TEMPLATES) {
            let loaded = file::read(text).unwrap();
            assert!(file::write(&loaded.document) == *text, "{name}: coif fmt it");
            assert!(loaded.warnings.is_empty() && loaded.dropped_comments.is_empty(), "{name}");
        }
    }

    #[test]
    fn it_writes_what_a_save_writes_and_a_second_time_nothing() {
        let folder = folder("save");
        let reported = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/reported");
        let mut texts =
            vec!["(format:1,// kept by nobody\n)".to_owned(), "// top\n(format: 1)".to_owned()];
        match std::fs::read_dir(&reported) {
            Ok(all) => {
                let all = all.flatten().map(|entry| entry.path());
                let all = all.filter(|path| path.extension().is_some_and(|e| e == "ron"));
                texts.extend(all.filter_map(|path| std::fs::read_to_string(path).ok()));
            }
            Err(_) => {
                println!("skipped: formatting of reported graphs needs ../shared/data/reported")
            }
        }
        for text in texts {
            let path = folder.join("a.ron");
            std::fs::write(&path, &text).unwrap();
            let loaded = file::read(&text).unwrap();
            let saved = file::write(&loaded.document);
            let loses = !loaded.dropped_comments.is_empty();
            let (before, after) = if loses { (Exit::Refused, &text) } else { (Exit::Done, &saved) };
            let found = if loses || text == saved { before } else { Exit::Failed };
            assert_eq!(fmt(&folder, &["a.ron"], true), found, "{text}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "--check writes nothing");
            assert_eq!(fmt(&folder, &["a.ron"], false), before, "{text}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), *after);
            assert_eq!(fmt(&folder, &["a.ron"], true), before);
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn all_are_written_or_none() {
        let folder = folder("all");
        let good = "(format: 1)";
        std::fs::write(folder.join("good.ron"), good).unwrap();
        std::fs::write(folder.join("bad.ron"), "(format: 1").unwrap();
        for other in ["bad.ron", "missing.ron", ".", "good.ron"] {
            assert_eq!(fmt(&folder, &["good.ron", other], false), Exit::Refused, "{other}");
            assert_eq!(std::fs::read_to_string(folder.join("good.ron")).unwrap(), good, "{other}");
        }
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
