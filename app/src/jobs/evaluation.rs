//! Evaluation beside the window: one thread takes the newest request, and hands over what came out.
//!
//! Guarantees: asking never waits; of several requests only the newest is run; a newer one stops what runs, except that a
//! preview which follows a stopped one is let through, so that a picture comes however fast the hand is. What is handed over
//! is final only when nothing newer was asked for meanwhile. For a different document or head, the head comes first, without hair; for
//! hair that was never made, a hundredth of it. Another document is evaluated beside it when nothing else is to be done.
//! Not guaranteed: that every request has an answer.

use crate::core::lineage::{Ancestor, lineage};
use crate::core::made::HairTrace;
use crate::core::shown::{Reports, RunStatus, Shown, Trace, displayed, first_output};
use coif_graphs::document::graph::{self, downstream, upstream};
use coif_graphs::document::{Document, Node, NodeId, Socket};
use coif_graphs::schedule::budget::used;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::{plan, plan_possible};
use coif_graphs::schedule::result::{Outcome, stands_for};
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Progress, Quiet};
use coif_graphs::trace;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{Type, Value};
use coif_nodes::eval::Quality;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// What is to be evaluated.
#[derive(Clone, Debug)]
pub(crate) struct EvaluationRequest {
    /// The number of the document's state.
    pub revision: u64,
    /// A snapshot.
    pub document: Document,
    /// What its paths are relative to.
    pub folder: PathBuf,
    /// Outputs whose values are wanted besides what is displayed.
    pub also: Vec<Socket>,
    /// How much hair is made.
    pub quality: Quality,
    /// Whether nodes may make more than a groom is to have.
    pub allow_large: bool,
    /// A different document or head: the head is handed over before its hair is made.
    pub afresh: bool,
    /// None of its hair was made before: a hundredth is handed over before the preview.
    pub unknown: bool,
    /// Something is dragged: earlier failures stay until the new result is known.
    pub drags: bool,
}

/// What is handed over.
pub(crate) struct Finished {
    /// What to show; none when what is displayed has no value.
    pub shown: Option<Shown>,
    /// What the nodes said.
    pub reports: Reports,
}

#[derive(Default)]
struct Desk {
    next: Option<EvaluationRequest>,
    /// Another document, which is evaluated when nothing else is to be done, and what came out.
    beside: Option<EvaluationRequest>,
    finished_beside: Option<Finished>,
    trace: Option<Trace>,
    traced: Option<Vec<Ancestor>>,
    what_made: Option<Trace>,
    made: Option<HairTrace>,
    running: Option<(CancelToken, Quality)>,
    /// Whether the run before was stopped for a newer one.
    stopped_last: bool,
    finished: Option<Finished>,
    status: RunStatus,
    /// Bytes held elsewhere, and whether what is kept has not given way to them yet.
    elsewhere: usize,
    makes_room: bool,
    /// The document that all of it was kept for is gone.
    leaves: bool,
    closed: bool,
}

/// The thread, and the desk over which requests and results pass.
pub(crate) struct Evaluation {
    shared: Arc<Shared>,
    evaluator: Arc<Evaluator>,
}

impl Desk {
    /// Whether there is nothing to do.
    fn is_at_rest(&self) -> bool {
        let asks = self.next.is_some() || self.trace.is_some() || self.what_made.is_some();
        !asks && self.beside.is_none() && !self.makes_room && !self.leaves && !self.closed
    }
}

struct Shared {
    desk: Mutex<Desk>,
    work: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Evaluation {
    /// Starts the thread. `wake` is called when there is something to look at.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub(crate) fn start(
        cache_bytes: usize,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Result<Self, String> {
        let evaluator = Evaluator::new(0, cache_bytes)?.with_memory(super::memory::free);
        let evaluator = Arc::new(evaluator);
        let shared =
            Arc::new(Shared { desk: Mutex::default(), work: Condvar::new(), wake: Box::new(wake) });
        let (theirs, works) = (shared.clone(), evaluator.clone());
        std::thread::Builder::new()
            .name("evaluation".to_owned())
            .spawn(move || serve(&theirs, &works))
            .map_err(|err| format!("no thread to evaluate on: {err}"))?;
        Ok(Self { shared, evaluator })
    }

    /// Tells how many bytes are held elsewhere, which count against the budget of what is kept.
    pub(crate) fn make_room(&self, elsewhere: usize) {
        let mut desk = self.shared.desk();
        if std::mem::replace(&mut desk.elsewhere, elsewhere) != elsewhere {
            desk.makes_room = true;
            drop(desk);
            self.shared.work.notify_one();
        }
    }

    /// What evaluates, for jobs beside it: what is kept of either's values serves both.
    pub(crate) fn evaluator(&self) -> Arc<Evaluator> {
        self.evaluator.clone()
    }

    /// Asks for an evaluation instead of what was asked before.
    pub(crate) fn ask(&self, request: EvaluationRequest) {
        let mut desk = self.shared.desk();
        if let Some((cancel, quality)) = &desk.running {
            let let_through = desk.stopped_last
                && *quality == Quality::Preview
                && request.quality == Quality::Preview
                && !request.afresh;
            if !let_through {
                cancel.cancel();
                desk.stopped_last = true;
            }
        }
        desk.next = Some(request);
        drop(desk);
        self.shared.work.notify_one();
    }

    /// Stops what runs and forgets what was asked.
    pub(crate) fn stop(&self) {
        let mut desk = self.shared.desk();
        (desk.next, desk.beside, desk.what_made) = (None, None, None);
        if let Some((cancel, _)) = &desk.running {
            cancel.cancel();
        }
    }

    /// The same, and forgets what was said of a document that is gone, and most of what was made for it.
    pub(crate) fn forget(&self) {
        self.stop();
        self.shared.desk().leaves = true;
        let mut desk = self.shared.desk();
        (desk.finished, desk.status.reports) = (None, Arc::default());
    }

    /// Asks for an evaluation of another document, instead of what was asked so before; answered when nothing else is to be done.
    /// What both documents have is made once.
    pub(crate) fn ask_beside(&self, request: EvaluationRequest) {
        self.shared.desk().beside = Some(request);
        self.shared.work.notify_one();
    }

    /// Forgets the other document.
    pub(crate) fn leave_beside(&self) {
        let mut desk = self.shared.desk();
        (desk.beside, desk.finished_beside) = (None, None);
    }

    /// What came out of the other document since the last call.
    pub(crate) fn take_beside(&self) -> Option<Finished> {
        self.shared.desk().finished_beside.take()
    }

    /// Asks where a curve comes from; answered when nothing else is to be done.
    pub(crate) fn trace(&self, trace: Trace) {
        self.shared.desk().trace = Some(trace);
        self.shared.work.notify_one();
    }

    /// Asks what made a curve; found when nothing else is to be done. The hair that was asked for before is given up.
    pub(crate) fn what_made(&self, trace: Trace) {
        let mut desk = self.shared.desk();
        if let (Some((cancel, _)), true) = (&desk.running, desk.status.tracing.is_some()) {
            cancel.cancel();
        }
        desk.what_made = Some(trace);
        drop(desk);
        self.shared.work.notify_one();
    }

    /// What made the curve that was asked for last, once it is known or given up.
    pub(crate) fn take_made(&self) -> Option<HairTrace> {
        self.shared.desk().made.take()
    }

    /// The line of the curve that was asked for last, once it is known.
    pub(crate) fn take_traced(&self) -> Option<Vec<Ancestor>> {
        self.shared.desk().traced.take()
    }

    /// What came out since the last call.
    pub(crate) fn take(&self) -> Option<Finished> {
        self.shared.desk().finished.take()
    }

    /// What it does now.
    pub(crate) fn status(&self) -> RunStatus {
        self.shared.desk().status.clone()
    }

    /// Whether nothing runs and nothing waits.
    pub(crate) fn is_idle(&self) -> bool {
        let desk = self.shared.desk();
        desk.next.is_none()
            && desk.beside.is_none()
            && desk.finished_beside.is_none()
            && desk.trace.is_none()
            && desk.what_made.is_none()
            && desk.made.is_none()
            && desk.running.is_none()
            && desk.finished.is_none()
            && desk.traced.is_none()
    }
}

impl Drop for Evaluation {
    fn drop(&mut self) {
        self.stop();
        self.shared.desk().closed = true;
        self.shared.work.notify_one();
    }
}

/// The evaluation thread.
fn serve(shared: &Shared, evaluator: &Evaluator) {
    let mut reports = Reports::default();
    let mut finals: BTreeMap<Vec<Socket>, usize> = BTreeMap::new();
    let mut files = (PathBuf::new(), DiskFiles::default());
    let mut before = Document::default();
    loop {
        let mut desk = shared.desk();
        while desk.is_at_rest() {
            desk = shared.work.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
        if desk.closed {
            return;
        }
        // What gives way is freed here, for that takes a while.
        let (leaves, elsewhere) = (std::mem::take(&mut desk.leaves), desk.elsewhere);
        if std::mem::take(&mut desk.makes_room) || leaves {
            drop(desk);
            evaluator.make_room(elsewhere);
            if leaves {
                evaluator.leave_document();
            }
            shared.desk().status.cache = evaluator.cache_bytes();
            continue;
        }
        let cancel = CancelToken::default();
        let Some(request) = desk.next.take() else {
            if let Some(trace) = desk.trace.take() {
                // A request that comes meanwhile stops it.
                desk.running = Some((cancel.clone(), Quality::Final));
                drop(desk);
                let line = follow(evaluator, &trace, &DiskFiles::new(&trace.folder), &cancel);
                let mut desk = shared.desk();
                desk.running = None;
                desk.traced = (!cancel.is_cancelled()).then_some(line);
                drop(desk);
                (shared.wake)();
            } else if let Some(question) = desk.what_made.take() {
                desk.running = Some((cancel.clone(), Quality::Final));
                desk.status.tracing = Some(trace::TraceProgress::default());
                drop(desk);
                let made = what_made(shared, evaluator, question, &cancel);
                let mut desk = shared.desk();
                (desk.running, desk.status.tracing) = (None, None);
                desk.status.cache = evaluator.cache_bytes();
                desk.made = Some(made);
                drop(desk);
                (shared.wake)();
            } else if let Some(request) = desk.beside.clone() {
                // So does it this; then it begins again.
                desk.running = Some((cancel.clone(), request.quality));
                drop(desk);
                beside(shared, evaluator, &request, &cancel);
            }
            continue;
        };
        desk.running = Some((cancel.clone(), request.quality));
        desk.status.since = Some(Instant::now());
        desk.status.revision = request.revision;
        desk.status.nodes = (0, 0);
        let changed = changed(&before, &request.document);
        if !request.drags {
            desk.status.reports = without_failures(&desk.status.reports, &changed);
        }
        drop(desk);
        if files.0 != request.folder {
            files = (request.folder.clone(), DiskFiles::new(&request.folder));
        }
        reports.nodes.retain(|id, _| !changed.contains(id));
        let told = Told { shared };
        if request.afresh
            && let Some(head) = head_alone(evaluator, &request, &files.1, (&cancel, &told))
        {
            shared.desk().finished = Some(Finished { shown: Some(head), reports: reports.clone() });
            (shared.wake)();
        }
        if request.unknown && request.quality == Quality::Preview {
            let first =
                EvaluationRequest { quality: Quality::FirstLook, also: vec![], ..request.clone() };
            // Messages of nodes about so little hair are dropped.
            let said = &mut Reports::default();
            let shown = evaluate(evaluator, &first, &files.1, (&cancel, &told), said);
            if let Some(shown) = shown.filter(|shown| shown.curves.curve_count() > 0) {
                let reports = reports.clone();
                shared.desk().finished = Some(Finished { shown: Some(shown), reports });
                (shared.wake)();
            }
        }
        let shown = evaluate(evaluator, &request, &files.1, (&cancel, &told), &mut reports);
        before = request.document.clone();
        let mut desk = shared.desk();
        desk.running = None;
        desk.status.since = None;
        desk.status.cache = evaluator.cache_bytes();
        if !cancel.is_cancelled() {
            desk.stopped_last = false;
            let shown = shown.map(|mut shown| {
                if shown.is_final() {
                    finals.insert(shown.sockets.clone(), shown.curves.curve_count());
                }
                shown.final_strands = finals.get(&shown.sockets).copied();
                shown
            });
            desk.status.reports = Arc::new(reports.clone());
            desk.finished = Some(Finished { shown, reports: reports.clone() });
        }
        drop(desk);
        (shared.wake)();
    }
}

/// The line of a curve. Everything on the way was just evaluated, so it comes out of what is kept.
fn follow(
    evaluator: &Evaluator,
    trace: &Trace,
    files: &DiskFiles,
    cancel: &CancelToken,
) -> Vec<Ancestor> {
    let document = &trace.document;
    let sockets = displayed(document);
    let needed = upstream(document, sockets.iter().map(|socket| &socket.node));
    let order = graph::order(document).unwrap_or_default();
    let gives = |id: &NodeId| {
        let socket = first_output(document, id)?;
        let (_, output) = document.def(id)?.output(&socket.name)?;
        (output.ty == Type::Curves).then_some(socket)
    };
    let targets: Vec<Socket> =
        order.iter().filter(|id| needed.contains(*id)).filter_map(gives).collect();
    let Ok(planned) = plan(document, &targets, trace.quality, files) else { return vec![] };
    let outcome = evaluator.run(&planned, OnFailure::PassThrough, cancel, &Quiet);
    let outputs: Vec<(NodeId, Curves)> = targets
        .into_iter()
        .zip(outcome.targets)
        .filter_map(|(socket, value)| match value {
            Some(Value::Curves(curves)) => Some((socket.node, curves)),
            _ => None,
        })
        .collect();
    lineage(&outputs, trace.id)
}

/// What made a curve of what is displayed, with the progress put on the desk.
fn what_made(
    shared: &Shared,
    evaluator: &Evaluator,
    question: Trace,
    cancel: &CancelToken,
) -> HairTrace {
    let Trace { id, document, folder, quality, allow_large } = question;
    let files = DiskFiles::new(&folder);
    let groom = trace::Groom { document: &document, files: &files, quality, allow_large };
    let mut tell = |far| {
        shared.desk().status.tracing = Some(far);
        (shared.wake)();
    };
    let outputs = displayed(&document);
    let traced = trace::trace(&groom, &outputs, id, (evaluator, cancel), &mut tell);
    HairTrace { traced, document }
}

/// The nodes of a document whose hair may be another than in the one before: those that changed, and what follows them.
fn changed(before: &Document, now: &Document) -> BTreeSet<NodeId> {
    let same = |a: &Arc<Node>, b: &Arc<Node>| Arc::ptr_eq(a, b) || a == b;
    let nodes = now.nodes.iter().filter(|(id, node)| {
        now.seed != before.seed || before.nodes.get(*id).is_none_or(|old| !same(old, node))
    });
    let links = now.links.iter().filter(|(to, from)| before.links.get(*to) != Some(*from));
    let cut = before.links.keys().filter(|to| !now.links.contains_key(*to));
    let ids = nodes.map(|(id, _)| id).chain(links.map(|(to, _)| &to.node));
    let ids: Vec<&NodeId> = ids.chain(cut.map(|to| &to.node)).collect();
    downstream(now, ids)
}

/// What nodes said, without what failed in those that have changed since.
fn without_failures(reports: &Arc<Reports>, changed: &BTreeSet<NodeId>) -> Arc<Reports> {
    let is_old = |id: &str| changed.contains(id);
    let failed =
        reports.nodes.iter().any(|(id, report)| report.error.is_some() && changed.contains(id));
    if !failed && !reports.refused.iter().any(|bad| is_old(&bad.node)) {
        return reports.clone();
    }
    let mut left = Reports::clone(reports);
    left.refused.retain(|bad| !is_old(&bad.node));
    let old = left.nodes.iter_mut().filter(|(id, _)| changed.contains(*id));
    old.for_each(|(_, report)| report.error = None);
    Arc::new(left)
}

/// Evaluates another document, unless it is stopped.
fn beside(
    shared: &Shared,
    evaluator: &Evaluator,
    request: &EvaluationRequest,
    cancel: &CancelToken,
) {
    let files = DiskFiles::new(&request.folder);
    let mut reports = Reports::default();
    let shown = evaluate(evaluator, request, &files, (cancel, &Quiet), &mut reports);
    let mut desk = shared.desk();
    desk.running = None;
    // Meanwhile somebody may have asked for another, or for none.
    let is_due = desk.beside.as_ref().is_some_and(|asked| asked.revision == request.revision);
    if is_due && !cancel.is_cancelled() {
        desk.beside = None;
        desk.finished_beside = Some(Finished { shown, reports });
        drop(desk);
        (shared.wake)();
    }
}

/// The heads of what is displayed, without hair; they are kept, so making the hair afterwards does not make them again. `None` without
/// a head, or when stopped.
fn head_alone(
    evaluator: &Evaluator,
    request: &EvaluationRequest,
    files: &DiskFiles,
    (cancel, told): (&CancelToken, &dyn Progress),
) -> Option<Shown> {
    let began = Instant::now();
    let document = &request.document;
    let sockets = displayed(document);
    let mut heads = heads(document, sockets.iter().map(|socket| &socket.node));
    let (planned, refused) = plan_possible(document, &heads, request.quality, files);
    let mut possible = refused.iter().map(Option::is_none);
    heads.retain(|_| possible.next().unwrap_or(false));
    let outcome = evaluator.run(&planned, OnFailure::PassThrough, cancel, told);
    let values: BTreeMap<Socket, Value> =
        heads.into_iter().zip(outcome.targets).filter_map(|(s, v)| Some((s, v?))).collect();
    let scalps: Vec<Arc<Scalp>> = values
        .values()
        .filter_map(|value| match value {
            Value::Scalp(scalp) => Some(scalp.clone()),
            _ => None,
        })
        .collect();
    (!scalps.is_empty()).then(|| Shown {
        revision: request.revision,
        quality: Quality::Preview,
        sockets,
        curves: Curves::default(),
        head_alone: true,
        scalps,
        values,
        stands_for: 1.0,
        final_strands: None,
        ms: began.elapsed().as_secs_f64() * 1e3,
        over: vec![],
    })
}

fn evaluate(
    evaluator: &Evaluator,
    request: &EvaluationRequest,
    files: &DiskFiles,
    (cancel, told): (&CancelToken, &dyn Progress),
    reports: &mut Reports,
) -> Option<Shown> {
    let began = Instant::now();
    let document = &request.document;
    let sockets = displayed(document);
    let heads = heads(document, sockets.iter().chain(&request.also).map(|s| &s.node));
    reports.revision = request.revision;
    reports.refused.clear();
    reports.nodes.retain(|id, _| document.nodes.contains_key(id));
    let mut targets: Vec<Socket> = sockets.clone();
    for socket in request.also.iter().chain(&heads) {
        if !targets.contains(socket) {
            targets.push(socket.clone());
        }
    }
    let (mut planned, refused) = plan_possible(document, &targets, request.quality, files);
    let mut possible = refused.iter().map(Option::is_none);
    targets.retain(|_| possible.next().unwrap_or(false));
    for bad in refused.into_iter().flatten() {
        if !reports.refused.contains(&bad) {
            reports.refused.push(bad);
        }
    }
    planned.allow_large = request.allow_large;
    let outcome = evaluator.run(&planned, OnFailure::PassThrough, cancel, told);
    if outcome.cancelled {
        return None;
    }
    let displayed = targets.iter().filter(|target| sockets.contains(target)).count();
    let mut over = used(&document.budget, &outcome, displayed);
    over.retain(|used| used.is_over() && request.quality == Quality::Final);
    let Outcome { targets: values, nodes, .. } = outcome;
    // Sockets asked for beyond what is displayed make hair that is not drawn.
    let way = upstream(document, sockets.iter().map(|socket| &socket.node));
    let seen = nodes.iter().filter(|node| way.iter().any(|id| id.as_str() == node.name));
    let stands_for = stands_for(seen);
    for report in nodes {
        if let Ok(id) = NodeId::new(&report.name) {
            reports.nodes.insert(id, report);
        }
    }
    let values: BTreeMap<Socket, Value> =
        targets.into_iter().zip(values).filter_map(|(s, v)| Some((s, v?))).collect();
    let mut tufts = vec![];
    let mut scalps: Vec<Arc<Scalp>> = vec![];
    for socket in sockets.iter().chain(&heads) {
        match values.get(socket) {
            Some(Value::Curves(curves)) => tufts.extend_from_slice(curves.tufts()),
            Some(Value::Scalp(scalp)) if !scalps.iter().any(|s| Arc::ptr_eq(s, scalp)) => {
                scalps.push(scalp.clone());
            }
            _ => {}
        }
    }
    if tufts.is_empty() && scalps.is_empty() {
        return None;
    }
    Some(Shown {
        revision: request.revision,
        quality: request.quality,
        sockets,
        curves: Curves::new(tufts),
        head_alone: false,
        scalps,
        values,
        stands_for,
        final_strands: None,
        ms: began.elapsed().as_secs_f64() * 1e3,
        over,
    })
}

/// The heads that nodes stand on; every head when they stand on none.
fn heads<'a>(document: &'a Document, of: impl Iterator<Item = &'a NodeId>) -> Vec<Socket> {
    let is_head = |id: &NodeId| document.node(id.as_str()).is_some_and(|n| n.is_head());
    let mut heads: Vec<NodeId> = upstream(document, of).into_iter().filter(is_head).collect();
    if heads.is_empty() {
        heads = document.nodes.keys().filter(|id| is_head(id)).cloned().collect();
    }
    heads.into_iter().map(|id| Socket::new(id, "scalp")).collect()
}

/// Puts progress on the desk.
struct Told<'a> {
    shared: &'a Shared,
}

impl Progress for Told<'_> {
    fn started(&self, node: &str) {
        let mut desk = self.shared.desk();
        node.clone_into(&mut desk.status.node);
        desk.status.pieces = (0, 0);
    }
    fn pieces(&self, node: &str, done: usize, of: usize) {
        let mut desk = self.shared.desk();
        if desk.status.node == node {
            desk.status.pieces = (done, of);
        }
    }
    fn done(&self, nodes: usize, of: usize) {
        self.shared.desk().status.nodes = (nodes, of);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_graphs::{file, grooms};
    use std::sync::mpsc::sync_channel;

    fn request(groom: &str, quality: Quality, afresh: bool) -> EvaluationRequest {
        let document = file::read(grooms::by_name(groom).unwrap()).unwrap().document;
        let (folder, also) = (PathBuf::new(), vec![]);
        let (allow_large, drags, unknown) = (false, false, afresh);
        EvaluationRequest {
            revision: 1,
            document,
            folder,
            also,
            quality,
            allow_large,
            afresh,
            drags,
            unknown,
        }
    }

    /// What is handed over of a request, one after the other: nothing is made until the one before was taken.
    fn handed_over(request: EvaluationRequest) -> Vec<Shown> {
        let (told, hears) = sync_channel(0);
        let evaluation = Evaluation::start(1 << 30, move || {
            // After the last there is nobody to hear.
            let _ = told.send(());
        })
        .unwrap();
        let quality = request.quality;
        evaluation.ask(request);
        let mut all: Vec<Shown> = vec![];
        while all.last().is_none_or(|shown| shown.head_alone || shown.quality != quality) {
            hears.recv().unwrap();
            all.extend(evaluation.take().and_then(|finished| finished.shown));
        }
        all
    }

    #[test]
    fn of_another_document_the_head_is_shown_before_its_hair_and_a_hundredth_before_a_tenth() {
        let what = |afresh| -> Vec<(bool, Quality, usize)> {
            let all = handed_over(request("puffs", Quality::Preview, afresh));
            assert!(all.iter().all(|shown| shown.scalps.len() == 1));
            all.iter().map(|it| (it.head_alone, it.quality, it.curves.curve_count())).collect()
        };
        let [(true, _, 0), (false, Quality::FirstLook, first), (false, Quality::Preview, tenth)] =
            what(true)[..]
        else {
            panic!("{:?}", what(true));
        };
        assert!(first > 0 && 5 * first < tenth, "{first} strands, then {tenth}");
        assert_eq!(what(false), [(false, Quality::Preview, tenth)], "where it is known");
    }

    #[test]
    fn a_preview_knows_how_many_strands_each_of_it_stands_for() {
        let of = |quality| {
            let shown = handed_over(request("puffs", quality, false)).remove(0);
            (shown.curves.curve_count() as f32, shown.stands_for)
        };
        let ((few, stands_for), (all, one)) = (of(Quality::Preview), of(Quality::Final));
        assert_eq!(one, 1.0);
        assert!((few * stands_for / all - 1.0).abs() < 0.02, "{few} x {stands_for}, {all}");
    }

    #[test]
    fn what_failed_is_forgotten_where_the_groom_has_changed_since() {
        let id = |name: &str| NodeId::new(name).unwrap();
        let mut told = Reports::default();
        for name in ["a", "b"] {
            let error = Some(coif_nodes::define::NodeError::failed("no guides"));
            let report = coif_graphs::schedule::result::NodeReport {
                name: name.to_owned(),
                curves: 7,
                error,
                ..Default::default()
            };
            told.nodes.insert(id(name), report);
        }
        let told = Arc::new(told);
        assert!(Arc::ptr_eq(&without_failures(&told, &[id("c")].into()), &told));
        let left = without_failures(&told, &[id("a")].into());
        let failed: Vec<&str> = left.failures().iter().map(|(node, _)| *node).collect();
        assert_eq!(failed, ["b"]);
        assert_eq!(left.nodes["a"].curves, 7, "what it made is shown still");
    }
}
