//! Writing hair and pictures from the window: the same code and the same bytes as `coif eval` and `coif render`, beside
//! the window.
//!
//! A snapshot of the document is evaluated on threads of its own, so editing goes on. Stopped or failed, no file is
//! touched.

use crate::core::state::OpenFile;
use crate::files::{Role, Together};
use crate::jobs::evaluate::Opened;
use crate::jobs::export::{formats, left_out_of_abc, write_files};
use crate::jobs::open::reads_all;
use crate::jobs::progress::Tell;
use crate::jobs::render::files::{self, Series};
use crate::jobs::render::{self, RenderRequest};
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use coif_graphs::document::Document;
use coif_graphs::schedule::run::{CancelToken, Progress};
use coif_nodes::eval::Quality;
use coif_nodes::formats::export::Format;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// An export that goes on.
pub(crate) struct Export {
    /// The file.
    pub(crate) path: PathBuf,
    cancel: CancelToken,
    shared: Arc<Mutex<Going>>,
}

/// What is written.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    /// All hair.
    Hair,
    /// A picture; the file is named apart.
    Picture(Box<RenderRequest>),
}

/// How far an export is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Going {
    /// What it does now.
    pub(crate) doing: String,
    /// Nodes or samples that are done, of all.
    pub(crate) done: (usize, usize),
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
    /// Begins to write a document's hair or a picture of it to a file whose ending says how. `wake` is called when there is
    /// something new.
    ///
    /// # Errors
    /// When there are no threads.
    pub(crate) fn start(
        content: Content,
        document: Document,
        file: OpenFile,
        allow_large: bool,
        path: PathBuf,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Result<Self, String> {
        let cancel = CancelToken::default();
        let shared: Arc<Mutex<Going>> = Arc::default();
        let export = Self { path: path.clone(), cancel: cancel.clone(), shared: shared.clone() };
        std::thread::Builder::new()
            .name("export".to_owned())
            .spawn(move || {
                let names = document
                    .nodes
                    .keys()
                    .map(|id| (id.to_string(), document.name_of(id).into_owned()));
                let told = Told { shared: &shared, wake: &wake, names: names.collect() };
                let mut report = Report::new(path.display().to_string());
                let opened = (document, file, allow_large);
                let carried_out = carry_out(&content, opened, &path, &cancel, &told, &mut report);
                let ended = match carried_out {
                    Ok(()) => Ended::Done(said(&path, &report), report.warnings),
                    Err(stop) if stop.is_interruption() => Ended::Stopped,
                    Err(stop) => Ended::Failed(stop.lines().to_vec()),
                };
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

fn carry_out(
    content: &Content,
    (document, file, allow_large): (Document, OpenFile, bool),
    path: &Path,
    cancel: &CancelToken,
    told: &Told,
    report: &mut Report,
) -> Result<(), Stop> {
    let mut files = Together::default();
    if let Some(own) = &file.path {
        files.reads(own, format!("the document {}", own.display())).map_err(Stop::refused)?;
    }
    reads_all(&document, &file.folder, &mut files)?;
    // What is told of the graph is told of the open one; the file is named where it is meant.
    let opened = Opened::of(document, file.folder, "export".to_owned(), allow_large)?;
    match content {
        Content::Hair => hair(&opened, path, cancel, told, report, &mut files)?,
        Content::Picture(asked) => {
            let out = [path.to_owned()];
            let formats = files::formats(&out, Series::One)?;
            let asked = RenderRequest {
                files: out.into_iter().zip(formats).collect(),
                ..(**asked).clone()
            };
            asked.claim(&mut files)?;
            render::draw(&asked, &opened, cancel, told, report, &mut files)?;
        }
    }
    files.place(cancel).map_err(|(path, reason)| Stop::unwritten(&path, &reason, cancel))
}

fn hair(
    opened: &Opened,
    path: &Path,
    cancel: &CancelToken,
    told: &Told,
    report: &mut Report,
    files: &mut Together,
) -> Result<(), Stop> {
    let formats = formats(&[path.to_owned()])?;
    opened.refuse_problems(&[], &mut report.warnings)?;
    files.writes(path, Role::Output, path.display().to_string()).map_err(Stop::refused)?;
    files.allowed().map_err(Stop::failed)?;
    let evaluated = opened.evaluate(Quality::Final, cancel, told, report)?;
    if formats.contains(&Format::Abc) {
        report.warnings.extend(left_out_of_abc(&evaluated.groups));
    }
    write_files(
        &opened.document,
        (&evaluated.groups, &evaluated.sections),
        &[],
        &formats.into_iter().map(|format| (path, format)).collect::<Vec<_>>(),
        cancel,
        files,
        &|_, path| {
            told.say(format!("writing {}", path.display()));
        },
    )
}

/// What was written, in words.
fn said(path: &Path, report: &Report) -> String {
    let path = path.display();
    if let Some(picture) = &report.picture {
        return format!(
            "saved {path}: {} x {}, {}",
            picture.width, picture.height, picture.description
        );
    }
    let curves: usize = report.outputs.iter().map(|output| output.curves).sum();
    let points: usize = report.outputs.iter().map(|output| output.points).sum();
    format!(
        "exported {path}: {}, {}",
        crate::words::counted(curves, "curve"),
        crate::words::counted(points, "point")
    )
}

struct Told<'a> {
    shared: &'a Mutex<Going>,
    wake: &'a (dyn Fn() + Send + Sync),
    /// What people call the nodes.
    names: BTreeMap<String, String>,
}

impl Told<'_> {
    fn change(&self, change: impl FnOnce(&mut Going)) {
        change(&mut self.shared.lock().unwrap_or_else(PoisonError::into_inner));
        (self.wake)();
    }
}

impl Progress for Told<'_> {
    fn started(&self, node: &str) {
        let name = self.names.get(node).map_or(node, String::as_str);
        self.say(format!("evaluating {name}"));
    }
    fn done(&self, done: usize, of: usize) {
        self.count(done, of);
    }
}

impl Tell for Told<'_> {
    fn counts(&self, what: &'static str) {
        self.say(format!("drawing {what}"));
    }
    fn count(&self, done: usize, of: usize) {
        self.change(|going| going.done = (done, of));
    }
    fn say(&self, text: String) {
        self.change(|going| going.doing = text);
    }
}
