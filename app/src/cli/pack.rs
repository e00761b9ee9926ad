//! `coif template pack`, and `install` and `info` of packs: a graph with all files that it uses in one file, and out of it again.
//!
//! Guarantees: what a pack holds is told before anything is written; a pack is proven whole before anything of it is used; files
//! are written all or none, under the folder that was named and through no link in it, and over none without `--force`.

use super::carry_out::in_one_step;
use super::progress::Bar;
use super::template::{self, InstallArgs, ended};
use super::{Exit, complain, complain_of, ending, print_plain, shown};
use crate::files::{Folders, Role, Together};
use crate::jobs::evaluate::Opened;
use crate::jobs::open::Read;
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use crate::library;
use crate::pack::gather::{self, Gathered, Graph, PackFile, Source};
use crate::pack::read::Pack;
use crate::pack::{Manifest, PackedOutput, is_pack, write};
use clap::Args;
use coif_graphs::document::Document;
use coif_graphs::file;
use coif_graphs::schedule::files::named;
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::eval::Quality;
use std::fs::symlink_metadata;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Args)]
pub(super) struct PackArgs {
    /// The graph, a .ron file; or a template or a shipped groom by its name
    graph: PathBuf,
    /// The pack to write, .coif
    #[arg(long, value_name = "FILE.coif", required_unless_present = "dry_run")]
    out: Option<PathBuf>,
    /// Say what it would hold and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Also take files that lie outside the graph's folder: they come into outside/ of the pack, and the graph in it names them there
    #[arg(long)]
    collect: bool,
    /// Evaluate, and let the pack say which hash each output has
    #[arg(long)]
    with_hash: bool,
    /// Also pack more than 4 GiB; and with --with-hash make more than 16 million points
    #[arg(long)]
    allow_large: bool,
}

pub(super) fn pack(args: &PackArgs) -> Exit {
    let packed = in_one_step("no pack was written", |files, cancel| {
        let refused = |why: String| vec![Stop::refused(why)];
        if let Some(out) = &args.out {
            write::named_as_pack(out).map_err(refused)?;
        }
        let graph = graph_of(&args.graph).map_err(|stop| vec![stop])?;
        let (original, folder) = (graph.loaded.document.clone(), graph.folder.clone());
        let gathered = gather::gather(graph, args.collect);
        let Gathered { items, document, notes: told } =
            gathered.map_err(|lines| vec![Stop(Exit::Refused, lines)])?;
        let mut manifest = Manifest::of(&items, &document);
        manifest
            .allowed(args.allow_large)
            .map_err(|why| refused(format!("{}: {why}", shown(&args.graph))))?;
        if args.with_hash {
            let made = made(original, folder.unwrap_or_default(), args, cancel);
            manifest.outputs = made.map_err(|stop| vec![stop])?;
        }
        complain_of(told.iter().map(|line| format!("note: {line}")).collect());
        tell(&manifest);
        let Some(out) = args.out.as_ref().filter(|_| !args.dry_run) else { return Ok(None) };
        write_pack(&manifest, &items, (&args.graph, out), files, cancel)?;
        Ok(Some(out))
    });
    ended(packed, |out| out.map_or(Exit::Done, |out| print_plain(&format!("wrote {}", shown(out)))))
}

/// Says what a pack holds.
fn tell(manifest: &Manifest) {
    for line in manifest.lines() {
        // That nobody reads it ends nothing.
        let _ = print_plain(&line);
    }
}

fn write_pack(
    manifest: &Manifest,
    items: &[PackFile],
    (graph, out): (&Path, &Path),
    files: &mut Together,
    cancel: &CancelToken,
) -> Result<(), Vec<Stop>> {
    let refused = |why: String| vec![Stop::refused(why)];
    files.reads(graph, format!("the graph {}", shown(graph))).map_err(refused)?;
    for item in items {
        if let Source::File(path) = &item.from {
            files.reads(path, format!("{}, which is packed", shown(path))).map_err(refused)?;
        }
    }
    files
        .writes(out, Role::Output, format!("--out {}", shown(out)))
        .and_then(|()| files.allowed())
        .map_err(refused)?;
    let written = files.write(out, cancel, |out| write::write(manifest, items, out));
    written.map_err(|why| vec![Stop::unwritten(out, &why, cancel)])
}

/// The graph of a file, the template, or the shipped groom that a person names, in this order.
fn graph_of(path: &Path) -> Result<Graph, Stop> {
    let name = path.to_string_lossy();
    if is_pack(path) {
        return Err(Stop::refused(format!("{name}: is a pack already")));
    }
    let is_there = symlink_metadata(path).is_ok();
    if !is_there && let Ok(entry) = library::find(&name) {
        let Some(path) = &entry.path else {
            let text = file::write(&entry.document);
            let loaded = file::read(&text).map_err(|err| Stop::refused(err.of_file(&name)))?;
            let name = format!("{}.ron", entry.origin.name);
            return Ok(Graph { name, text: text.into_bytes(), loaded, folder: None });
        };
        let called = path.file_name().unwrap_or_default().to_string_lossy();
        return Ok(graph(crate::jobs::open::read_packed(path, false)?, &called));
    }
    if !is_there && !crate::jobs::open::is_shipped(path) {
        return Err(Stop::refused(format!(
            "{name}: no such file, and no template or shipped groom of that name; coif template list has the templates"
        )));
    }
    let read = crate::jobs::open::read_packed(path, false)?;
    let called = match read.folder {
        Some(_) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        None => format!("{name}.ron"),
    };
    Ok(graph(read, &called))
}

fn graph(read: Read, name: &str) -> Graph {
    let Read { loaded, text, folder, shown } = read;
    let told = loaded.conflicts.iter().chain(&loaded.warnings);
    complain_of(told.map(|warning| format!("warning: {}", warning.of_file(&shown))).collect());
    Graph { name: name.to_owned(), text, loaded, folder }
}

/// What the outputs of a graph are.
fn made(
    document: Document,
    folder: PathBuf,
    args: &PackArgs,
    cancel: &CancelToken,
) -> Result<Vec<PackedOutput>, Stop> {
    let graph = shown(&args.graph).to_string();
    let opened = Opened::of(document, folder, graph.clone(), args.allow_large)?;
    let mut report = Report::new(graph);
    opened.refuse_problems(&[], &mut report.warnings)?;
    let bar = Bar::new("nodes");
    let evaluated = opened.evaluate(Quality::Final, cancel, &bar, &mut report);
    bar.clear();
    evaluated?;
    let of = |output: &crate::jobs::report::Output| PackedOutput {
        output: format!("{}.{}", output.node, output.socket),
        hash: output.hash.to_string(),
    };
    Ok(report.outputs.iter().map(of).collect())
}

/// Says what a pack holds.
pub(super) fn info(path: &Path, allow_large: bool) -> Exit {
    ending::at_once();
    match Pack::open(path, allow_large) {
        Ok(pack) => {
            let Manifest { program, graph, .. } = &pack.manifest;
            let printed = print_plain(&format!("{}: {graph}, packed by {program}", shown(path)));
            tell(&pack.manifest);
            match library::of_text(&pack.text, None) {
                Ok(entry) => printed.max(print_plain(&template::info(&entry))),
                Err(_) => printed,
            }
        }
        Err(why) => {
            complain(why);
            Exit::Refused
        }
    }
}

/// Puts a pack's template into the library, or all of it into a folder.
pub(super) fn install(args: &InstallArgs) -> Exit {
    let mut folders = Folders::default();
    let installed = in_one_step("nothing was installed", |files, cancel| {
        let refused = |why: String| vec![Stop::refused(why)];
        let pack = Pack::open(&args.file, args.allow_large).map_err(refused)?;
        tell(&pack.manifest);
        files.reads(&args.file, format!("the pack {}", shown(&args.file))).map_err(refused)?;
        if let Some(folder) = &args.into {
            return unpack(&pack, folder, args.force, &mut folders, files, cancel);
        }
        let is_alone = named(&pack.graph.document).is_empty();
        match library::of_text(&pack.text, None) {
            Ok(entry) if is_alone => template::put(&entry, args, files, cancel),
            Ok(_) => Err(refused(format!(
                "{}: its template uses files that lie beside it: say where with --into FOLDER",
                shown(&args.file)
            ))),
            Err(why) => Err(refused(format!(
                "{}: holds a groom that is no template ({why}): say where with --into FOLDER",
                shown(&args.file)
            ))),
        }
    });
    ended(installed, |target| print_plain(&shown(&target).to_string()))
}

/// Writes all files of a pack into a folder. Gives where its graph is.
fn unpack(
    pack: &Arc<Pack>,
    folder: &Path,
    force: bool,
    folders: &mut Folders,
    files: &mut Together,
    cancel: &CancelToken,
) -> Result<PathBuf, Vec<Stop>> {
    let names = || pack.manifest.files.iter().map(|file| file.path.as_str());
    let wrong: Vec<String> = names().filter_map(|name| taken(folder, name, force)).collect();
    if !wrong.is_empty() {
        return Err(vec![Stop(Exit::Refused, crate::words::first_of(wrong))]);
    }
    for name in names() {
        let target = folder.join(name);
        let within = target.parent().unwrap_or(folder);
        folders
            .make(within)
            .map_err(|why| vec![Stop::failed(format!("{}: {why}", shown(within)))])?;
        let words = format!("the file {}", shown(&target));
        files.writes(&target, Role::Output, words).map_err(|why| vec![Stop::refused(why)])?;
    }
    files.allowed().map_err(|why| vec![Stop::failed(why)])?;
    for name in names() {
        let target = folder.join(name);
        let written = files.write(&target, cancel, |out| {
            pack.unpack(name, out).map_err(|why| format!("{}: {why}", pack.shown(name)))
        });
        written.map_err(|why| vec![Stop::unwritten(&target, &why, cancel)])?;
    }
    Ok(folder.join(&pack.manifest.graph))
}

/// Why a file of a pack cannot be put into a folder; none where it can.
fn taken(folder: &Path, name: &str, force: bool) -> Option<String> {
    let mut at = folder.to_owned();
    let mut words = name.split('/').peekable();
    while let Some(word) = words.next() {
        at.push(word);
        let about = match symlink_metadata(&at) {
            Ok(about) => about,
            Err(err) if err.kind() == std::io::ErrorKind::NotFound => return None,
            Err(err) => return Some(format!("{}: {err}", shown(&at))),
        };
        let why = match words.peek() {
            _ if about.is_symlink() => "is a link, and packs are unpacked through none",
            Some(_) if about.is_dir() => continue,
            Some(_) => "is there, and is no folder",
            None if !about.is_file() => "is there, and is no file",
            None if force => return None,
            None => "is there already: unpack into another folder, or use --force",
        };
        return Some(format!("{}: {why}", shown(&at)));
    }
    None
}
