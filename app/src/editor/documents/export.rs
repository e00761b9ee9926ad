//! Writing hair and pictures from the window: the same code and the same bytes as `coif eval` and `coif render`, beside
//! the window, one after the other.
//!
//! Guarantees: a snapshot of the document is evaluated on a thread of its own, so editing goes on, and by the window's evaluator,
//! so that no node runs again whose values it keeps. What is asked for while something is written waits for its turn.
//! Stopped or failed, no file is touched.

use crate::core::state::OpenFile;
use crate::files::{Role, Together};
use crate::jobs::evaluate::{Opened, outputs};
use crate::jobs::export::HairFiles;
use crate::jobs::open::reads_all;
use crate::jobs::progress::Tell;
use crate::jobs::render::files::{self, Series};
use crate::jobs::render::{self, RenderRequest};
use crate::jobs::report::Report;
use crate::jobs::stop::Stop;
use crate::jobs::unreal;
use crate::words::counted;
use coif_graphs::document::Document;
use coif_graphs::schedule::run::{CancelToken, Evaluator, Progress};
use coif_nodes::eval::Quality;
use std::collections::{BTreeMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What is written, and all that it is made from.
pub(crate) struct ExportJob {
    pub(crate) content: Content,
    pub(crate) document: Document,
    pub(crate) file: OpenFile,
    pub(crate) allow_large: bool,
    pub(crate) evaluator: Arc<Evaluator>,
    /// Where to.
    pub(crate) path: PathBuf,
}

/// What is written.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    /// Hair.
    Hair(HairChoice),
    /// Pictures; the file is named apart.
    Picture(Box<RenderRequest>),
}

/// What of the hair is written, and how: the options of `coif eval` and `coif check`.
#[derive(Clone, Debug, Default)]
pub(crate) struct HairChoice {
    /// These outputs; all of the groom's where none is named.
    pub(crate) outputs: Vec<String>,
    /// How much hair is made.
    pub(crate) quality: Quality,
    /// Whether the heads' meshes are written beside it.
    pub(crate) with_head: bool,
    /// Whether it is told what Unreal would cut off or make up.
    pub(crate) for_unreal: bool,
}

/// One export, as people see it.
#[derive(Clone, Debug)]
pub(crate) struct ExportRow {
    pub(crate) number: u64,
    pub(crate) path: PathBuf,
    pub(crate) state: ExportState,
}

/// How far an export is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ExportState {
    /// Others are written first.
    Waits,
    /// It is written: what goes on, and how many nodes or samples are done, of all.
    Runs(String, (usize, usize)),
    /// It is over.
    Ended(Ended),
}

/// How an export ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Ended {
    /// It is written.
    Done(Exported),
    /// Nothing was written, because of these.
    Failed(Vec<String>),
    /// Nothing was written, because somebody stopped it.
    Stopped,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Exported {
    /// That it is written, and where.
    pub(crate) words: String,
    /// What is in it.
    pub(crate) made: String,
    /// What was warned of, and what may surprise.
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
    /// Nodes that ran for it, of all that it is made by.
    pub(crate) ran: (usize, usize),
}

/// All exports of the window, in the order that they were asked for.
pub(crate) struct Exports {
    shared: Arc<Shared>,
    /// Those whose end was told.
    told: VecDeque<ExportRow>,
}

/// Ended exports that are still listed.
const MOST_TOLD: usize = 6;

#[derive(Default)]
struct Desk {
    last: u64,
    waiting: VecDeque<(u64, ExportJob)>,
    running: Option<(ExportRow, CancelToken)>,
    /// Whose end was not told yet.
    ended: Vec<ExportRow>,
    /// Whether a thread works for it.
    works: bool,
}

struct Shared {
    desk: Mutex<Desk>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Updates the progress of the running export.
    fn tell(&self, change: impl FnOnce(&mut String, &mut (usize, usize))) {
        if let Some((row, _)) = &mut self.desk().running
            && let ExportState::Runs(doing, done) = &mut row.state
        {
            change(doing, done);
        }
        (self.wake)();
    }
}

impl Exports {
    /// None yet; `wake` is called when there is something new.
    pub(crate) fn new(wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self { shared: Arc::new(Shared { desk: Mutex::default(), wake }), told: VecDeque::new() }
    }

    /// Writes something as soon as all that was asked for before is written.
    ///
    /// # Errors
    /// When there are no threads.
    pub(crate) fn ask(&self, job: ExportJob) -> Result<(), String> {
        let mut desk = self.shared.desk();
        desk.last += 1;
        let number = desk.last;
        desk.waiting.push_back((number, job));
        if desk.works {
            return Ok(());
        }
        let theirs = self.shared.clone();
        let begun = std::thread::Builder::new().name("export".to_owned()).spawn(move || {
            while let Some((job, cancel)) = theirs.next() {
                let ended = catch_unwind(AssertUnwindSafe(|| job.carry_out(&theirs, &cancel)));
                let ended = ended.unwrap_or_else(|_| {
                    Ended::Failed(vec![format!("{}: ended unexpectedly", job.path.display())])
                });
                theirs.end(ended);
            }
        });
        match begun {
            Ok(_) => desk.works = true,
            Err(_) => drop(desk.waiting.pop_back()),
        }
        begun.map(drop).map_err(|err| format!("no thread to export on: {err}"))
    }

    /// Stops an export, or keeps one that waits from being written.
    pub(crate) fn cancel(&self, number: u64) {
        let mut desk = self.shared.desk();
        if let Some((row, cancel)) = &desk.running
            && row.number == number
        {
            cancel.cancel();
        }
        let at = desk.waiting.iter().position(|(waits, _)| *waits == number);
        if let Some((number, job)) = at.and_then(|at| desk.waiting.remove(at)) {
            let state = ExportState::Ended(Ended::Stopped);
            desk.ended.push(ExportRow { number, path: job.path, state });
        }
    }

    /// Stops all of them.
    pub(crate) fn cancel_all(&self) {
        let all = self.going();
        all.iter().for_each(|row| self.cancel(row.number));
    }

    /// Those that are written or wait, in their order.
    pub(crate) fn going(&self) -> Vec<ExportRow> {
        let desk = self.shared.desk();
        let waits = desk.waiting.iter().map(|(number, job)| ExportRow {
            number: *number,
            path: job.path.clone(),
            state: ExportState::Waits,
        });
        desk.running.iter().map(|(row, _)| row.clone()).chain(waits).collect()
    }

    /// Whether something is written or waits, or has ended and was not told yet.
    pub(crate) fn is_going(&self) -> bool {
        let desk = self.shared.desk();
        desk.running.is_some() || !desk.waiting.is_empty() || !desk.ended.is_empty()
    }

    /// Those that have ended since the last call. The last of them are listed on.
    pub(crate) fn take_ended(&mut self) -> Vec<ExportRow> {
        let ended = std::mem::take(&mut self.shared.desk().ended);
        self.told.extend(ended.iter().cloned());
        let over = self.told.len().saturating_sub(MOST_TOLD);
        self.told.drain(..over);
        ended
    }

    /// The last that have ended, the newest first.
    pub(crate) fn told(&self) -> impl Iterator<Item = &ExportRow> {
        self.told.iter().rev()
    }
}

impl Shared {
    /// The next export in the queue; without one, the thread ends.
    fn next(&self) -> Option<(ExportJob, CancelToken)> {
        let mut desk = self.desk();
        let Some((number, job)) = desk.waiting.pop_front() else {
            desk.works = false;
            return None;
        };
        let cancel = CancelToken::default();
        let state = ExportState::Runs(String::new(), (0, 0));
        let row = ExportRow { number, path: job.path.clone(), state };
        desk.running = Some((row, cancel.clone()));
        Some((job, cancel))
    }

    fn end(&self, ended: Ended) {
        let mut desk = self.desk();
        if let Some((row, _)) = desk.running.take() {
            desk.ended.push(ExportRow { state: ExportState::Ended(ended), ..row });
        }
        drop(desk);
        (self.wake)();
    }
}

impl ExportJob {
    fn carry_out(&self, shared: &Shared, cancel: &CancelToken) -> Ended {
        let document = &self.document;
        let named = |id| (format!("{id}"), document.name_of(id).into_owned());
        let told = Told { shared, names: document.nodes.keys().map(named).collect() };
        let mut report = Report::new(self.path.display().to_string());
        let mut notes = vec![];
        match self.write(cancel, &told, &mut report, &mut notes) {
            Ok(()) => {
                let (done, made) = made(&report);
                let words = format!("{done} {}: {made}", self.path.display());
                let ran = report.nodes.iter().filter(|node| !node.cached).count();
                let ran = (ran, report.nodes.len());
                Ended::Done(Exported { words, made, warnings: report.warnings, notes, ran })
            }
            Err(stop) if stop.is_interruption() => Ended::Stopped,
            Err(stop) => Ended::Failed(stop.lines().to_vec()),
        }
    }

    fn write(
        &self,
        cancel: &CancelToken,
        told: &Told,
        report: &mut Report,
        notes: &mut Vec<String>,
    ) -> Result<(), Stop> {
        let (document, file) = (self.document.clone(), &self.file);
        let mut files = Together::default();
        if let Some(own) = &file.path {
            files.reads(own, format!("the document {}", own.display())).map_err(Stop::refused)?;
        }
        reads_all(&document, &file.folder, &mut files)?;
        // What is told of the graph is told of the open one; the file is named where it is meant.
        let folder = file.folder.clone();
        let mut opened = Opened::of(document, folder, "export".to_owned(), self.allow_large)?;
        match &self.content {
            Content::Hair(asked) => {
                opened.outputs = outputs(&opened.document, &asked.outputs)?;
                self.hair(asked, &opened, cancel, told, report, notes, &mut files)?;
            }
            Content::Picture(asked) => {
                let out = [self.path.clone()];
                let series = if asked.frames > 1 { Series::Turntable } else { Series::One };
                let formats = files::formats(&out, series)?;
                let asked = RenderRequest {
                    files: out.into_iter().zip(formats).collect(),
                    ..(**asked).clone()
                };
                asked.claim(&mut files)?;
                let evaluator = Some(&*self.evaluator);
                render::draw(&asked, &opened, evaluator, cancel, told, report, &mut files)?;
            }
        }
        files.place(cancel).map_err(|(path, reason)| Stop::unwritten(&path, &reason, cancel))
    }

    fn hair(
        &self,
        asked: &HairChoice,
        opened: &Opened,
        cancel: &CancelToken,
        told: &Told,
        report: &mut Report,
        notes: &mut Vec<String>,
        files: &mut Together,
    ) -> Result<(), Stop> {
        let path = &self.path;
        let out = HairFiles::new(std::slice::from_ref(path), asked.with_head)?;
        opened.refuse_problems(&[], &mut report.warnings)?;
        files.writes(path, Role::Output, path.display().to_string()).map_err(Stop::refused)?;
        files.allowed().map_err(Stop::failed)?;
        let evaluated =
            opened.evaluate_on(&self.evaluator, asked.quality, &[], cancel, told, report)?;
        notes.extend(out.left_out(&evaluated.groups));
        if asked.for_unreal {
            let found = unreal::judged(&evaluated.groups);
            report.warnings.extend(found.lost.iter().map(|line| format!("Unreal: {line}")));
            notes.extend(found.made_up.iter().map(|line| format!("Unreal: {line}")));
        }
        out.write(&opened.document, &evaluated, cancel, told, files)
    }
}

/// What was done, and what was made, in words.
fn made(report: &Report) -> (&'static str, String) {
    if let Some(picture) = &report.picture {
        let many = match picture.files.len() {
            0 | 1 => String::new(),
            many => format!("{many} pictures, "),
        };
        let size = format!("{} x {}", picture.width, picture.height);
        return ("saved", format!("{many}{size}, {}", picture.description));
    }
    let curves: usize = report.outputs.iter().map(|output| output.curves).sum();
    let points: usize = report.outputs.iter().map(|output| output.points).sum();
    ("exported", format!("{}, {}", counted(curves, "curve"), counted(points, "point")))
}

struct Told<'a> {
    shared: &'a Shared,
    /// What people call the nodes.
    names: BTreeMap<String, String>,
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
        self.shared.tell(|_, counted| *counted = (done, of));
    }
    fn say(&self, text: String) {
        self.shared.tell(|doing, _| *doing = text);
    }
}
