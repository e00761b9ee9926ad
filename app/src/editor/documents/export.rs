//! Writing hair from the window: the same code and the same bytes as `coif eval`, beside the window.
//!
//! A snapshot of the document is evaluated on threads of its own, so editing goes on. Stopped or failed, no file is
//! touched.

use crate::cli::eval::write_files;
use crate::cli::extension_of;
use crate::cli::groom::Opened;
use crate::cli::report::Report;
use coif_graphs::document::Document;
use coif_graphs::schedule::run::{CancelToken, Progress};
use coif_nodes::eval::Quality;
use coif_nodes::formats::export::Format;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// An export that goes on.
pub(crate) struct Export {
    /// The file.
    pub(crate) path: PathBuf,
    cancel: CancelToken,
    shared: Arc<Mutex<Going>>,
}

/// How far an export is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Going {
    /// What it does now.
    pub(crate) doing: String,
    /// Nodes that are done, of all.
    pub(crate) nodes: (usize, usize),
    ended: Option<Ended>,
}

/// How an export ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Ended {
    /// What was written, in words, and what was warned of.
    Done(String, Vec<String>),
    /// Nothing was written, because of these.
    Failed(Vec<String>),
    /// Nothing was written, because somebody stopped it.
    Stopped,
}

impl Export {
    /// Begins to write a document's hair to a file whose ending says how. `wake` is called when there is something new.
    ///
    /// # Errors
    /// When the ending is none that can be written, or there are no threads.
    pub(crate) fn start(
        document: Document,
        folder: PathBuf,
        path: PathBuf,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Result<Self, String> {
        let format = Format::of_extension(&extension_of(&path)).ok_or_else(|| {
            format!("{}: grooms are written as {}", path.display(), Format::EXTENSIONS)
        })?;
        let cancel = CancelToken::default();
        let shared: Arc<Mutex<Going>> = Arc::default();
        let export = Self { path: path.clone(), cancel: cancel.clone(), shared: shared.clone() };
        std::thread::Builder::new()
            .name("export".to_owned())
            .spawn(move || {
                let told = Told { shared: &shared, wake: &wake };
                let ended = run(document, folder, &path, format, &cancel, &told);
                told.change(|going| going.ended = Some(ended));
            })
            .map_err(|err| err.to_string())?;
        Ok(export)
    }

    /// Asks it to stop.
    pub(crate) fn stop(&self) {
        self.cancel.cancel();
    }

    /// How far it is.
    pub(crate) fn going(&self) -> Going {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How it ended, if it has.
    pub(crate) fn ended(&self) -> Option<Ended> {
        self.going().ended
    }
}

fn run(
    document: Document,
    folder: PathBuf,
    path: &Path,
    format: Format,
    cancel: &CancelToken,
    told: &Told,
) -> Ended {
    let mut report = Report::new(path.display().to_string());
    // What is told of the graph is told of the open one; the file is named where it is meant.
    let carried_out = Opened::of(document, folder, "export".to_owned()).and_then(|opened| {
        opened.refuse_problems(&[], &mut report.warnings)?;
        let evaluated = opened.evaluate(Quality::Final, 0, &[], cancel, told, &mut report)?;
        let files = [(path, format)];
        write_files(&opened.document, &evaluated.groups, &files, cancel, &|_, path| {
            told.change(|going| going.doing = format!("writing {}", path.display()));
        })
    });
    match carried_out {
        Ok(()) => {
            let curves: usize = report.outputs.iter().map(|output| output.curves).sum();
            let points: usize = report.outputs.iter().map(|output| output.points).sum();
            let hashes: Vec<&str> = report.outputs.iter().map(|o| o.hash.as_str()).collect();
            let words = format!(
                "exported {}: {} curves, {} points, hash {}",
                path.display(),
                super::grouped(curves),
                super::grouped(points),
                hashes.join(", ")
            );
            Ended::Done(words, report.warnings)
        }
        Err(stop) if stop.is_interruption() => Ended::Stopped,
        Err(stop) => Ended::Failed(stop.lines().to_vec()),
    }
}

struct Told<'a> {
    shared: &'a Mutex<Going>,
    wake: &'a (dyn Fn() + Send + Sync),
}

impl Told<'_> {
    fn change(&self, change: impl FnOnce(&mut Going)) {
        change(&mut self.shared.lock().unwrap_or_else(PoisonError::into_inner));
        (self.wake)();
    }
}

impl Progress for Told<'_> {
    fn started(&self, node: &str) {
        self.change(|going| going.doing = format!("evaluating {node}"));
    }
    fn done(&self, done: usize, of: usize) {
        self.change(|going| going.nodes = (done, of));
    }
}
