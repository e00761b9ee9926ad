//! What the tasks of a job would be refused for, found before the job is written.
//!
//! Every graph is looked at on every head, and with every row of the sweep, as `coif eval` would before anything ran, and each mesh is
//! read once. Not promised: that tasks succeed; what only an evaluation finds, and a head and a row that do not go together, they
//! find themselves.

use super::check::files;
use super::given::{apply_scalp, set_value};
use super::sweep::Sweep;
use crate::jobs::evaluate::Opened;
use crate::jobs::open::{Read, read_packed};
use crate::jobs::stop::{Exit, Stop};
use coif_graphs::document::Document;
use coif_graphs::schedule::files::{DiskFiles, Files};
use coif_nodes::define::FileData;
use coif_nodes::formats::read_mesh;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A graph of the job.
struct Graph {
    document: Document,
    folder: PathBuf,
    shown: String,
}

/// Files of a folder, each read once.
struct Once {
    disk: DiskFiles,
    known: Mutex<BTreeMap<String, Result<Arc<FileData>, String>>>,
}

impl Once {
    fn new(folder: &Path) -> Self {
        Self { disk: DiskFiles::new(folder), known: Mutex::default() }
    }
}

impl Files for Once {
    fn read(&self, path: &str) -> Result<Arc<FileData>, String> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.entry(path.to_owned()).or_insert_with(|| self.disk.read(path)).clone()
    }
}

/// Refuses a job with a task that would be refused: `heads` as `--head` has them, without any the graphs' own.
///
/// # Errors
/// All that is wrong, each once.
pub(super) fn refuse_doomed(
    graphs: &[PathBuf],
    heads: &[String],
    sweep: Option<(&Path, &Sweep)>,
) -> Result<(), Stop> {
    let graphs = graphs.iter().map(|path| {
        let Read { loaded, folder, shown, .. } = read_packed(path, false)?;
        Ok(Graph { document: loaded.document, folder: folder.unwrap_or_default(), shown })
    });
    let graphs: Vec<Graph> = graphs.collect::<Result<_, Stop>>()?;
    let mut wrong = Wrong::default();
    for head in heads {
        let once = Once::new(Path::new(""));
        let mesh = on_head(head);
        let fault = match once.read(&mesh) {
            Ok(file) => {
                let side = |name: &str| file.sides.get(name).cloned();
                read_mesh(&file.extension, &file.bytes, &side).err().map(|err| err.to_string())
            }
            Err(why) => Some(why),
        };
        match fault {
            Some(why) => wrong.add(format!("--head {mesh}: {why}")),
            None => graphs.iter().for_each(|graph| {
                wrong.look(graph, Some(head), &[], &Once::new(&graph.folder));
            }),
        }
    }
    for graph in &graphs {
        let once = Once::new(&graph.folder);
        if heads.is_empty() {
            wrong.look(graph, None, &[], &once);
            let of_files = files(&graph.document, &once).into_iter();
            let faults = of_files.filter(|(is_error, ..)| *is_error);
            faults.for_each(|(_, node, input, why)| {
                wrong.add(format!("{}: {node}.{input}: {why}", graph.shown));
            });
        }
        let Some((file, sweep)) = sweep else { continue };
        for (name, cells) in sweep.each() {
            let before = wrong.lines.len();
            wrong.look(graph, heads.first(), &cells, &once);
            for line in &mut wrong.lines[before..] {
                *line = format!("{}: row {name}: {line}", file.display());
            }
        }
    }
    match wrong.lines.is_empty() {
        true => Ok(()),
        false => Err(Stop(Exit::Refused, wrong.lines)),
    }
}

/// The file of `[NODE=]FILE`: where no file has the whole name, what stands behind the node.
pub(super) fn on_head(head: &str) -> String {
    match head.split_once('=') {
        Some((_, file)) if !Path::new(head).exists() => file.to_owned(),
        _ => head.to_owned(),
    }
}

/// What is wrong, each once.
#[derive(Default)]
struct Wrong {
    lines: Vec<String>,
    known: BTreeSet<String>,
}

impl Wrong {
    fn add(&mut self, line: String) {
        if self.known.insert(line.clone()) {
            self.lines.push(line);
        }
    }

    /// Adds what a graph would be refused for on a head and with values of inputs.
    fn look(
        &mut self,
        graph: &Graph,
        head: Option<&String>,
        set: &[(&str, &str)],
        disk: &dyn Files,
    ) {
        let mut document = graph.document.clone();
        let shown = &graph.shown;
        for (input, value) in set {
            if let Err(why) = set_value(&mut document, input, value) {
                return self.add(format!("{shown}: {input}={value}: {why}"));
            }
        }
        if let Some(head) = head
            && let Err(stop) = apply_scalp(&mut document, "--head", head)
        {
            return stop.lines().iter().for_each(|line| self.add(format!("{shown}: {line}")));
        }
        let opened = match Opened::of(document, graph.folder.clone(), shown.clone(), false) {
            Ok(opened) => opened,
            Err(stop) => {
                return stop.lines().iter().for_each(|line| self.add(format!("{shown}: {line}")));
            }
        };
        if let Err(stop) = opened.refuse_problems(&[], &mut vec![]) {
            return stop.lines().iter().for_each(|line| self.add(format!("{shown}: {line}")));
        }
        let bad = opened.foreseen(disk);
        bad.iter().for_each(|bad| self.add(format!("{shown}: {bad}")));
    }
}
