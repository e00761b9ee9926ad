//! `coif template`: groups that travel between grooms and shows, listed, made, added, upgraded and compared.
//!
//! Guarantees: what a command would change is told with its fate; on anything but exit code 0 no file is touched; a graph with
//! an instance needs no template file, for it holds all of it.

use super::carry_out::in_one_step;
use super::progress::Bar;
use super::{Exit, complain, complain_of, ending, pack, print, print_plain, thumbnail};
use crate::files::{Role, Together};
use crate::jobs::stop::Stop;
use crate::jobs::thumbnail::{CAMERA, SIZE, of};
use crate::library::fitted::{evaluated, given_between, say_home};
use crate::library::new::{MadeOf, NewTemplate};
use crate::library::{self, LibraryEntry};
use crate::pack::is_pack;
use crate::places::Places;
use crate::words::plain_json;
use clap::{Args, Subcommand};
use coif_graphs::document::graph::head_at_hand;
use coif_graphs::document::{Document, NodeId, Origin, groups};
use coif_graphs::schedule::run::CancelToken;
use coif_graphs::template::Placement;
use coif_graphs::{compare, file, template, text};
use coif_nodes::data::landmarks::Landmarks;
use coif_nodes::define::short;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct TemplateArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Name every template: those that come with coif, your own, those of the folders in COIF_TEMPLATES
    List {
        /// Print JSON for other tools
        #[arg(long)]
        json: bool,
    },
    /// Say what a template is: a name of the library, name@version, or a file; or what a pack holds
    Info {
        /// Which
        template: String,
        /// Of a pack: also one that holds more than 4 GiB, or unpacks to a hundred times its size
        #[arg(long)]
        allow_large: bool,
    },
    /// Put a graph and all files that it uses into one file, and say beforehand what it will hold
    Pack(pack::PackArgs),
    /// Make a template of a group of a graph: a groom that opens and evaluates by itself
    New(Box<NewArgs>),
    /// Draw a template small, and keep the picture in its file
    Thumbnail(thumbnail::ThumbnailArgs),
    /// Add an instance of a template to a graph
    Add {
        /// The graph, a .ron file
        graph: PathBuf,
        /// A name of the library, name@version, or a file
        template: String,
        /// Write the graph here instead of over itself
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Put a template into your own folder, under its name and version; or unpack a pack
    Install(InstallArgs),
    /// Put the newest version in the place of instances; what is set on them is kept, and each value's fate told
    Upgrade(UpgradeArgs),
    /// Lock an instance to its version for good
    Lock {
        /// The graph, a .ron file
        graph: PathBuf,
        /// The instance
        node: String,
        /// Let it be upgraded again
        #[arg(long)]
        off: bool,
    },
    /// Say what differs between two templates, or two versions of one
    Diff {
        /// As it was: a name, name@version, or a file
        a: String,
        /// As it is
        b: String,
    },
}

#[derive(Args)]
#[command(disable_version_flag = true)]
struct NewArgs {
    /// The graph, a .ron file or the name of a shipped groom
    graph: PathBuf,
    /// The group in it; else all nodes but heads and outputs are made one
    group: Option<String>,
    /// An input of a node in the group, node.input, that the template is to have as its own; may be given again
    #[arg(long = "expose", value_name = "NODE.INPUT")]
    exposed: Vec<String>,
    /// What people call it; else the group's label
    #[arg(long)]
    title: Option<String>,
    /// What is said of it
    #[arg(long)]
    description: Option<String>,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// What libraries know it by; else the group's id
    #[arg(long)]
    name: Option<String>,
    /// For people, such as 1.2
    #[arg(long, default_value = "1.0")]
    version: String,
    /// Who made it
    #[arg(long, default_value = "")]
    author: String,
    /// Under which licence it is given, such as CC-BY-4.0
    #[arg(long, default_value = "")]
    licence: String,
    /// A word that it is found by; may be given again
    #[arg(long = "tag")]
    tags: Vec<String>,
    /// Where the style comes from
    #[arg(long, default_value = "")]
    source: String,
    /// What it needs of a head, such as a landmark; may be given again
    #[arg(long = "needs")]
    needs: Vec<String>,
    /// Draw no thumbnail
    #[arg(long)]
    no_thumbnail: bool,
    /// Write over a file that is no template of this name
    #[arg(long)]
    force: bool,
    /// Where the thumbnail is seen from, as for coif render
    #[arg(long, value_name = "NAME", default_value = CAMERA)]
    camera: String,
}

#[derive(Args)]
pub(super) struct InstallArgs {
    /// The template, a .ron file, or a pack, .coif
    pub(super) file: PathBuf,
    /// Into this folder instead, such as one of COIF_TEMPLATES
    #[arg(long, value_name = "FOLDER", conflicts_with = "into")]
    pub(super) to: Option<PathBuf>,
    /// Unpack a pack into this folder, with all of its files
    #[arg(long, value_name = "FOLDER")]
    pub(super) into: Option<PathBuf>,
    /// Write over files that are there
    #[arg(long)]
    pub(super) force: bool,
    /// Of a pack: also one that holds more than 4 GiB, or unpacks to a hundred times its size
    #[arg(long)]
    pub(super) allow_large: bool,
}

#[derive(Args)]
struct UpgradeArgs {
    /// The graph, a .ron file
    graph: PathBuf,
    /// Instances; else all that have a newer version
    nodes: Vec<String>,
    /// This template instead of the newest of the library: name@version, or a file
    #[arg(long, value_name = "TEMPLATE")]
    to: Option<String>,
    /// Say what would happen and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Go on where what is in an instance was changed by hand: those changes are lost
    #[arg(long)]
    force: bool,
    /// Write the graph here instead of over itself
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(args: &TemplateArgs) -> Exit {
    match &args.command {
        Command::List { json } => list(*json),
        Command::Info { template, allow_large } if is_pack(Path::new(template)) => {
            pack::info(Path::new(template), *allow_large)
        }
        Command::Info { template, .. } => {
            said(library::find(template), |entry| print_plain(&info(entry)))
        }
        Command::Pack(args) => pack::pack(args),
        Command::New(args) => new(args),
        Command::Thumbnail(args) => thumbnail::run(args),
        Command::Add { graph, template, out } => {
            said(library::find(template), |entry| add(graph, entry, out.as_deref()))
        }
        Command::Install(args) if is_pack(&args.file) => pack::install(args),
        Command::Install(args) => install(args),
        Command::Upgrade(args) => upgrade(args),
        Command::Lock { graph, node, off } => lock(graph, node, !off),
        Command::Diff { a, b } => match (library::find(a), library::find(b)) {
            (Ok(a), Ok(b)) => differ(&a, &b),
            (a, b) => {
                complain_of([a.err(), b.err()].into_iter().flatten().collect());
                Exit::Refused
            }
        },
    }
}

fn said(found: Result<LibraryEntry, String>, then: impl FnOnce(&LibraryEntry) -> Exit) -> Exit {
    ending::at_once();
    match found {
        Ok(entry) => then(&entry),
        Err(why) => {
            complain(why);
            Exit::Refused
        }
    }
}

fn list(as_json: bool) -> Exit {
    ending::at_once();
    let (all, wrong) = library::all();
    complain_of(wrong.iter().map(|why| format!("warning: {why}")).collect());
    if as_json {
        let all: Vec<_> = all.iter().map(of_entry).collect();
        return print(&plain_json(&serde_json::to_string_pretty(&all).unwrap_or_default()));
    }
    let line = |entry: &LibraryEntry| {
        let place =
            entry.path.as_ref().map_or("coif".to_owned(), |path| path.display().to_string());
        let Origin { name, version, .. } = &entry.origin;
        format!("{name:<24} {version:<6} {:<28} {place}", entry.title)
    };
    all.iter().map(|entry| print_plain(&line(entry))).max().unwrap_or(Exit::Done)
}

fn of_entry(entry: &LibraryEntry) -> serde_json::Value {
    let Origin { name, version, author, licence, tags, source, needs, hash: _, locked: _ } =
        &entry.origin;
    json!({
        "name": name, "version": version, "title": entry.title, "description": entry.description,
        "author": author, "licence": licence, "tags": tags, "source": source, "needs": needs,
        "hash": entry.hash, "file": entry.path.as_ref().map(|path| path.display().to_string()),
    })
}

pub(super) fn info(entry: &LibraryEntry) -> String {
    let Origin { name, version, author, licence, tags, source, needs, hash, locked: _ } =
        &entry.origin;
    let mut lines = vec![format!("{}: {name} {version}", entry.title)];
    let mut say = |what: &str, text: &str| {
        if !text.is_empty() {
            lines.push(format!("{what}{text}"));
        }
    };
    say("", &entry.description);
    say("author: ", author);
    say("licence: ", licence);
    say("where the style comes from: ", source);
    say("tags: ", &tags.join(", "));
    say("needs: ", &needs.join(", "));
    say("hash: ", &entry.hash);
    if !hash.is_empty() && *hash != entry.hash {
        say("", "changed since it was made: its mark says another hash");
    }
    if let Ok(group) = template::group_of(&entry.document)
        && let Some(def) = entry.document.def(group)
    {
        let nodes = entry.document.inside(group).count();
        say("nodes: ", &nodes.to_string());
        for input in def.inputs {
            let default =
                input.default().map(|value| format!(" = {}", short(&text::write_value(&value))));
            say(
                "takes ",
                &format!("{}{} ({})", input.name, default.unwrap_or_default(), input.ty.name()),
            );
        }
        for output in def.outputs {
            say("gives ", &format!("{} ({})", output.name, output.ty.name()));
        }
    }
    lines.join("\n")
}

/// Reads a graph, changes it, and writes it over itself or elsewhere.
fn rewritten<T>(
    graph: &Path,
    out: Option<&Path>,
    change: impl FnOnce(&mut Document, &mut Together, &CancelToken) -> Result<T, String>,
) -> Result<T, Exit> {
    if out.is_none()
        && !graph.is_file()
        && coif_graphs::grooms::by_name(&graph.to_string_lossy()).is_some()
    {
        complain(format_args!(
            "{}: comes with coif: say with --out where it is to be written",
            graph.display()
        ));
        return Err(Exit::Refused);
    }
    let out = out.unwrap_or(graph);
    in_one_step("no graph was written", |files, cancel| {
        let refused = |why: String| vec![Stop::refused(why)];
        let mut warnings = vec![];
        let (mut document, _) =
            crate::jobs::open::load(graph, &mut warnings).map_err(|stop| vec![stop])?;
        complain_of(warnings.iter().map(|why| format!("warning: {why}")).collect());
        files
            .writes(out, Role::Output, format!("the graph {}", out.display()))
            .and_then(|()| files.allowed())
            .map_err(refused)?;
        let before = document.clone();
        let given = change(&mut document, files, cancel)
            .map_err(|why| refused(format!("{}: {why}", graph.display())))?;
        // Where nothing changed the file stays as it is written.
        if out == graph && document == before {
            return Ok(given);
        }
        let written = files.write_text(out, &file::write(&document), cancel);
        written.map_err(|why| vec![Stop::unwritten(out, &why, cancel)])?;
        Ok(given)
    })
}

fn new(args: &NewArgs) -> Exit {
    let words = [("name", args.name.as_deref()), ("version", Some(args.version.as_str()))];
    let bad = words.into_iter().find_map(|(what, word)| {
        library::new::bad_word(word?).map(|why| format!("--{what} {why}"))
    });
    let is_there = || {
        // What is no template of that name is somebody's work.
        let another = !library::read(&args.out)
            .is_ok_and(|there| args.name.as_ref().is_none_or(|name| there.origin.name == *name));
        (args.out.is_file() && another && !args.force).then(|| {
            format!("{}: is there, and is no such template: use --force", args.out.display())
        })
    };
    if let Some(why) = bad.or_else(is_there) {
        complain(why);
        return Exit::Refused;
    }
    let made = rewritten(&args.graph, Some(&args.out), |document, files, cancel| {
        let group = args.group.as_deref().map(NodeId::new).transpose();
        let made = NewTemplate {
            of: group.map_err(|err| err.to_string())?.map_or(MadeOf::All, MadeOf::Group),
            exposed: args.exposed.clone(),
            title: args.title.clone(),
            description: args.description.clone(),
            origin: Origin {
                name: args.name.clone().unwrap_or_default(),
                version: args.version.clone(),
                hash: String::new(),
                locked: false,
                author: args.author.clone(),
                licence: args.licence.clone(),
                tags: args.tags.clone(),
                source: args.source.clone(),
                needs: args.needs.clone(),
            },
        };
        *document = made.of(document)?;
        let folder = folder_of(&args.graph);
        let whole = document.clone();
        say_home(document, |head| {
            landmarks(&whole, head, &folder, "the template does not say what head it was drawn on")
        });
        if !args.no_thumbnail {
            let bar = Bar::new("nodes");
            let drawn = of(document, folder, SIZE, &args.camera, &bar, cancel, files);
            bar.clear();
            match drawn {
                Ok(drawn) => document.thumbnail = Some(drawn),
                // A template without a picture is one, too.
                Err(stop) => {
                    complain(format_args!("note: no thumbnail: {}", stop.lines().join("; ")))
                }
            }
        }
        let group = template::group_of(document)?;
        Ok(template::hash(document, group))
    });
    ended(made, |hash| print_plain(&hash))
}

pub(super) fn ended<T>(done: Result<T, Exit>, then: impl FnOnce(T) -> Exit) -> Exit {
    match done {
        Ok(it) => then(it),
        Err(exit) => exit,
    }
}

fn add(graph: &Path, entry: &LibraryEntry, out: Option<&Path>) -> Exit {
    if !entry.origin.hash.is_empty() && entry.origin.hash != entry.hash {
        complain(format_args!(
            "warning: {} was changed since it was made: its mark says the hash {}, it has {}",
            entry.origin.name, entry.origin.hash, entry.hash
        ));
    }
    let added = rewritten(graph, out, |document, _, _| {
        let here = head_at_hand(document).and_then(|head| {
            given_between(document, &head, None).or_else(|| {
                landmarks(document, &head, &folder_of(graph), "the template is not fitted to it")
            })
        });
        let fitted = entry.fitted(here.as_ref());
        let place = Placement { hash: Some(&entry.hash), ..Placement::default() };
        let template::Added { edit, id, .. } = template::add(document, &fitted, place)?;
        edit.apply(document).map_err(|err| err.to_string())?;
        if entry.is_changed_in(&fitted) {
            complain(format_args!(
                "note: {id} was fitted to this head and now differs from its template: upgrading it needs --force"
            ));
        }
        Ok(id)
    });
    ended(added, |id| print_plain(id.as_str()))
}

/// The landmarks of a head; where it cannot be evaluated, why, and what becomes of it.
fn landmarks(
    document: &Document,
    head: &NodeId,
    folder: &Path,
    becomes: &str,
) -> Option<Landmarks> {
    let found = evaluated(document, head, folder);
    found.map_err(|why| complain(format_args!("note: {why}: {becomes}"))).ok()
}

fn folder_of(graph: &Path) -> PathBuf {
    graph.parent().unwrap_or(Path::new("")).to_owned()
}

fn install(args: &InstallArgs) -> Exit {
    let path = &args.file;
    let installed = in_one_step("nothing was installed", |files, cancel| {
        let refused = |why: String| vec![Stop::refused(format!("{}: {why}", path.display()))];
        if args.into.is_some() {
            return Err(refused("--into unpacks packs, and this is none: use --to".to_owned()));
        }
        let entry = library::read(path).map_err(refused)?;
        put(&entry, args, files, cancel)
    });
    ended(installed, |target| print_plain(&target.display().to_string()))
}

/// Writes a template into a folder of the library.
pub(super) fn put(
    entry: &LibraryEntry,
    args: &InstallArgs,
    files: &mut Together,
    cancel: &CancelToken,
) -> Result<PathBuf, Vec<Stop>> {
    let refused = |why: String| vec![Stop::refused(format!("{}: {why}", args.file.display()))];
    let folder = args.to.clone().unwrap_or_else(|| library::own(&Places::here()));
    let Origin { name, version, hash, .. } = &entry.origin;
    if *hash != entry.hash {
        let why = format!(
            "its mark says the hash {hash}, it has {}: it was changed or damaged",
            entry.hash
        );
        return Err(refused(format!("{why}; make it anew with coif template new")));
    }
    let file = library::new::file_name(name, version).map_err(refused)?;
    let target = folder.join(file);
    if let Some(why) = library::new::is_another(&target, &entry.hash).filter(|_| !args.force) {
        return Err(refused(format!("{why}: give it another version, or use --force")));
    }
    std::fs::create_dir_all(&folder).map_err(|err| refused(err.to_string()))?;
    files
        .writes(&target, Role::Output, format!("the template {}", target.display()))
        .and_then(|()| files.allowed())
        .map_err(|why| vec![Stop::refused(why)])?;
    let written = files.write_text(&target, &file::write(&entry.document), cancel);
    written.map_err(|why| vec![Stop::unwritten(&target, &why, cancel)])?;
    Ok(target)
}

/// The instances that an upgrade is about, each with what is to come in its place.
fn wanted(document: &Document, args: &UpgradeArgs) -> Result<Vec<(NodeId, LibraryEntry)>, String> {
    let named = args.nodes.iter().map(|node| NodeId::new(node).map_err(|err| err.to_string()));
    let named: Vec<NodeId> = named.collect::<Result<_, _>>()?;
    let mut found = vec![];
    for (id, origin) in template::instances(document) {
        if !named.is_empty() && !named.contains(id) {
            continue;
        }
        let newest = match &args.to {
            Some(to) => library::find(to),
            None => library::find(&origin.name),
        };
        match newest {
            Ok(entry)
                if named.is_empty() && args.to.is_some() && entry.origin.name != origin.name =>
            {
                let name = &origin.name;
                complain(format_args!(
                    "note: {id} is an instance of {name}: name it to put another template there"
                ));
            }
            Ok(entry) if named.is_empty() && entry.hash == origin.hash => {}
            Ok(_) if named.is_empty() && origin.locked => {
                complain(format_args!("note: {id} is locked to version {}", origin.version));
            }
            Ok(entry) => found.push((id.clone(), entry)),
            // What is in the graph needs no library.
            Err(why) if named.is_empty() => complain(format_args!("note: {id}: {why}")),
            Err(why) => return Err(why),
        }
    }
    match named.iter().find(|id| !found.iter().any(|(known, _)| known == *id)) {
        Some(id) => Err(format!("{id} is no instance of a template")),
        None => Ok(found),
    }
}

fn upgrade(args: &UpgradeArgs) -> Exit {
    let change = |document: &mut Document| -> Result<Vec<String>, String> {
        let mut told = vec![];
        for (id, entry) in wanted(document, args)? {
            let had = document.node(id.as_str()).and_then(|node| node.template.clone());
            let had = had.map(|origin| origin.version.clone()).unwrap_or_default();
            let done = template::upgrade(document, &id, &entry.document)?;
            if done.changed_inside && !args.force && !args.dry_run {
                return Err(format!(
                    "{id} was changed inside since it was made: these changes would be lost; make a template of it first, or use --force"
                ));
            }
            told.push(format!("{id}: {} {had} to {}", entry.origin.name, entry.origin.version));
            if done.changed_inside {
                told.push(format!("{id}: changes inside: lost"));
            }
            told.extend(done.overrides.iter().map(|told| format!("{id}: {told}")));
            done.edit.apply(document).map_err(|err| err.to_string())?;
        }
        Ok(told)
    };
    let told = if args.dry_run {
        ending::at_once();
        let mut warnings = vec![];
        let loaded = crate::jobs::open::load(&args.graph, &mut warnings);
        let told = loaded.map_err(|stop| stop.lines().to_vec());
        let told =
            told.and_then(|(mut document, _)| change(&mut document).map_err(|why| vec![why]));
        told.map_err(|why| {
            complain_of(why);
            Exit::Refused
        })
    } else {
        rewritten(&args.graph, args.out.as_deref(), |document, _, _| change(document))
    };
    ended(told, |told| {
        if told.is_empty() {
            return print_plain("nothing to upgrade");
        }
        told.iter().map(|line| print_plain(line)).max().unwrap_or(Exit::Done)
    })
}

fn lock(graph: &Path, node: &str, locked: bool) -> Exit {
    let done = rewritten(graph, None, |document, _, _| {
        let id = NodeId::new(node).map_err(|err| err.to_string())?;
        let edit = template::lock(document, &id, locked);
        let edit = edit.ok_or_else(|| format!("{id} is no instance of a template"))?;
        edit.apply(document).map_err(|err| err.to_string())
    });
    ended(done, |_| Exit::Done)
}

fn differ(a: &LibraryEntry, b: &LibraryEntry) -> Exit {
    ending::at_once();
    // Under one name, so that they can be compared.
    let alone = |entry: &LibraryEntry| {
        template::group_of(&entry.document).map(|group| groups::alone(&entry.document, group))
    };
    let (Ok(from), Ok(to)) = (alone(a), alone(b)) else { return Exit::Refused };
    let lines = compare::lines(&from, &to, false);
    match lines.is_empty() {
        true => print_plain(&format!("the same: {}", a.hash)),
        false => print_plain(&lines.join("\n")).max(Exit::Failed),
    }
}
