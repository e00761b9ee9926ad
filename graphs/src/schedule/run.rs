//! Running a plan: independent nodes at once, tufts in parallel, what is known reused, stopped when
//! asked.
//!
//! Nodes run on threads of their own; the pieces they cut their work into run on the evaluator's pool. So a
//! node may wait for the pool (the distance field of a head is built once, by whoever asks first) without
//! ever being run by it.

use super::budget::most_points;
use super::cache::Cache;
use super::held;
use super::plan::{NOTHING_TO_PASS, Plan, Source, Step};
use super::result::{NodeReport, Outcome};
use coif_nodes::data::gestures::Replayed;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::{InputDef, NodeError, Type, Value};
use coif_nodes::eval::{EvalCx, Host, Kept, Log, MOST_POINTS, Message, Quality, Room};
use coif_nodes::maths::hash::{Key, KeyBuilder};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::panic::AssertUnwindSafe;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Instant;

/// Asks a run to stop; may be given to many.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks to stop. Kernels look at least every 2 ms.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
    /// Whether somebody asked.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Is told how a run goes. Called from several threads.
pub trait Progress: Sync {
    /// A node began.
    fn started(&self, _node: &str) {}
    /// So many of a node's pieces of work are done.
    fn pieces(&self, _node: &str, _done: usize, _of: usize) {}
    /// So many of the plan's nodes are done.
    fn done(&self, _nodes: usize, _of: usize) {}
}

/// Nobody to tell.
#[derive(Debug, Default)]
pub struct Quiet;
impl Progress for Quiet {}

/// What becomes of a node's readers when it fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnFailure {
    /// They do not run.
    #[default]
    Stop,
    /// They get the failed node's first curves, so that the groom does not vanish (the editor).
    PassThrough,
}

/// Threads and a cache that outlive single runs.
pub struct Evaluator {
    pool: rayon::ThreadPool,
    /// For previews, which are made while somebody drags: one thread less, so that a core is left to
    /// what draws the window. None where that would leave a single thread.
    polite: Option<rayon::ThreadPool>,
    cache: Mutex<Cache>,
    free_memory: fn() -> Option<u64>,
}

impl Evaluator {
    /// An evaluator with so many threads (0: one a core) and a cache of so many bytes (0: none, values are dropped
    /// after their last reader).
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(threads: usize, cache_bytes: usize) -> Result<Self, String> {
        let pool = |threads| {
            let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            built.map_err(|err| format!("no threads to work with: {err}"))
        };
        let all = pool(threads)?;
        let polite = match all.current_num_threads() {
            // One that drops what it made has nobody who drags.
            threads if threads > 2 && cache_bytes > 0 => Some(pool(threads - 1)?),
            _ => None,
        };
        Ok(Self {
            pool: all,
            polite,
            cache: Mutex::new(Cache::new(cache_bytes)),
            free_memory: || None,
        })
    }

    /// Tells how many bytes are free, where that is known: nodes that would take more fail before they do.
    #[must_use]
    pub fn with_memory(mut self, free: fn() -> Option<u64>) -> Self {
        self.free_memory = free;
        self
    }

    /// Bytes that the cache holds, and its budget.
    pub fn cache_bytes(&self) -> (usize, usize) {
        let cache = self.cache();
        (cache.bytes(), cache.budget())
    }

    /// Tells how many bytes are held elsewhere that count against the cache's budget: pictures, documents.
    pub fn make_room(&self, elsewhere: usize) {
        self.cache().make_room(elsewhere);
    }

    /// Tells that another document takes the place of the one that was evaluated: what is kept of that gives way.
    pub fn leave_document(&self) {
        self.cache().leave_document();
    }

    /// Threads that work on a plan of this quality.
    pub fn threads(&self, quality: Quality) -> usize {
        self.pool(quality).current_num_threads()
    }

    fn pool(&self, quality: Quality) -> &rayon::ThreadPool {
        match quality {
            Quality::Preview | Quality::FirstLook => self.polite.as_ref().unwrap_or(&self.pool),
            Quality::Final => &self.pool,
        }
    }

    fn cache(&self) -> std::sync::MutexGuard<'_, Cache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lends all of the evaluator's threads to work beside nodes, until cancelled.
    pub fn host<'a>(&'a self, cancel: &'a CancelToken) -> impl Host + 'a {
        PoolHost {
            evaluator: self,
            pool: &self.pool,
            cancel,
            progress: &Quiet,
            node: "",
            most: None,
        }
    }

    /// Runs a plan to its end, to the first failure on every way, or until cancelled.
    pub fn run(
        &self,
        plan: &Plan,
        on_failure: OnFailure,
        cancel: &CancelToken,
        progress: &dyn Progress,
    ) -> Outcome {
        let began = Instant::now();
        let n = plan.steps.len();
        // For each step those that read it, once for each wire.
        let mut read_by: Vec<Vec<usize>> = vec![vec![]; n];
        for (i, step) in plan.steps.iter().enumerate() {
            step.wires().for_each(|from| read_by[from].push(i));
        }
        let mut waiting: Vec<usize> = plan.steps.iter().map(|step| step.wires().count()).collect();
        // How many more readers each step's values have; targets are read at the end.
        let mut readers: Vec<usize> = read_by.iter().map(Vec::len).collect();
        plan.targets.iter().for_each(|(step, _)| readers[*step] += 1);
        let mut values: Vec<Option<Vec<Value>>> = vec![None; n];
        let mut reports: Vec<Option<NodeReport>> = vec![None; n];
        // Held until the end, when all is built that is asked of them.
        let mut heads: Vec<Vec<Arc<Scalp>>> = vec![vec![]; n];
        let mut keys: Vec<Option<Key>> = vec![None; n];
        // The first of the plan comes first.
        let mut ready: BTreeSet<usize> = (0..n).filter(|i| waiting[*i] == 0).collect();
        let (mut running, mut finished) = (0, 0);
        let threads = self.threads(plan.quality);
        let (send, receive) = mpsc::channel::<(usize, Key, NodeReport, Option<Vec<Value>>)>();
        std::thread::scope(|scope| {
            loop {
                while running < threads
                    && let Some(i) = ready.pop_first()
                {
                    let inputs: Vec<Vec<Value>> = plan.steps[i]
                        .inputs
                        .iter()
                        .map(|sources| {
                            let found = sources.iter().map(|source| match source {
                                Source::Value(value) => Some(value.clone()),
                                Source::Wire { step, output } => {
                                    Some(values[*step].as_ref()?.get(*output)?.clone())
                                }
                            });
                            found.flatten().collect()
                        })
                        .collect();
                    // Not held here any more while the node runs: it may be the last reader.
                    for step in plan.steps[i].wires() {
                        readers[step] -= 1;
                        if readers[step] == 0 {
                            values[step] = None;
                        }
                    }
                    running += 1;
                    progress.started(&plan.steps[i].name);
                    let send = send.clone();
                    scope.spawn(move || {
                        let (key, report, out) =
                            self.step(plan, i, inputs, on_failure, cancel, progress);
                        let _ = send.send((i, key, report, out));
                    });
                }
                if running == 0 {
                    break;
                }
                let Ok((i, key, report, out)) = receive.recv() else { break };
                running -= 1;
                finished += 1;
                progress.done(finished, n);
                reports[i] = Some(report);
                keys[i] = Some(key);
                if let Some(given) = &out {
                    heads[i].extend(given.iter().filter_map(head_of));
                    for j in read_by[i].iter().copied() {
                        waiting[j] -= 1;
                        if waiting[j] == 0 {
                            ready.insert(j);
                        }
                    }
                    if readers[i] > 0 {
                        values[i] = out;
                    }
                }
            }
        });
        // What was built of heads meanwhile is kept with them.
        let with_heads = keys.iter().zip(&heads).filter(|(_, heads)| !heads.is_empty());
        with_heads.filter_map(|(key, _)| *key).for_each(|key| self.recount(key));
        for (report, bytes) in reports.iter_mut().zip(held::of_scalps(&heads)) {
            report.iter_mut().for_each(|report| report.bytes += bytes);
        }
        let targets = plan
            .targets
            .iter()
            .map(|(step, output)| values[*step].as_ref()?.get(*output).cloned())
            .collect();
        Outcome {
            targets,
            nodes: reports.into_iter().flatten().collect(),
            cancelled: cancel.is_cancelled(),
            ms: began.elapsed().as_secs_f64() * 1e3,
        }
    }

    fn step(
        &self,
        plan: &Plan,
        i: usize,
        inputs: Vec<Vec<Value>>,
        on_failure: OnFailure,
        cancel: &CancelToken,
        progress: &dyn Progress,
    ) -> (Key, NodeReport, Option<Vec<Value>>) {
        let step = &plan.steps[i];
        let began = Instant::now();
        let log = Log::default();
        let mut report =
            NodeReport { name: step.name.clone(), kind: step.def.id, ..NodeReport::default() };
        let keys = Keys::new(step, &inputs, plan.seed, plan.quality);
        let known = self.cache().find(keys.whole).and_then(|kept| kept.downcast::<Known>().ok());
        let result = if step.bypass {
            passed_through(step, &inputs).ok_or_else(|| NodeError::failed(NOTHING_TO_PASS))
        } else if let Some(known) = known {
            report.cached = true;
            report.messages.clone_from(&known.messages);
            report.gestures.clone_from(&known.gestures);
            report.thinned = known.thinned;
            report.tufts_reused = known.tufts;
            report.bytes = known.held;
            Ok(known.values.clone())
        } else if cancel.is_cancelled() {
            Err(NodeError::Cancelled)
        } else {
            let pool = self.pool(plan.quality);
            let usual = (!plan.allow_large).then_some(MOST_POINTS);
            let budget =
                most_points(&plan.budget).filter(|(most, _)| *most < usual.unwrap_or(u64::MAX));
            let most = budget.as_ref().map(|(most, _)| *most).or(usual);
            let host = PoolHost { evaluator: self, pool, cancel, progress, node: &step.name, most };
            let mut cx = EvalCx::new(plan.seed, plan.quality, keys.node, &host, &log);
            // Who keeps nothing need not know what was read.
            cx.node_untraced = keys.node_untraced.filter(|_| !self.cache().is_off());
            let ran = std::panic::catch_unwind(AssertUnwindSafe(|| (step.def.run)(&cx, &inputs)));
            let result = ran.unwrap_or_else(|panic| {
                let text = panic
                    .downcast_ref::<String>()
                    .map(String::as_str)
                    .or_else(|| panic.downcast_ref::<&str>().copied())
                    .unwrap_or("no reason given");
                Err(NodeError::failed(format!("a mistake in coif, please report it: {text}")))
            });
            let result = result.map_err(|err| match (err, &budget) {
                (NodeError::TooLarge(said), Some((_, limit))) => {
                    NodeError::failed(format!("{said}, and {limit}"))
                }
                (err, _) => err,
            });
            report.tufts_run = log.tufts_run.load(Ordering::Relaxed);
            report.tufts_reused = log.tufts_reused.load(Ordering::Relaxed);
            (report.messages, report.gestures) = (log.messages(), log.gestures());
            report.thinned = log.thinned();
            if let Ok(values) = &result {
                report.messages.extend(vanished(step, &inputs, values, &report.messages));
                report.bytes = held::new_bytes(&inputs, values);
                let known = Known {
                    values: values.clone(),
                    messages: report.messages.clone(),
                    gestures: report.gestures.clone(),
                    thinned: report.thinned,
                    tufts: report.tufts_run + report.tufts_reused,
                    held: report.bytes,
                };
                let bytes = known.bytes();
                self.cache().keep(keys.whole, Arc::new(known), bytes);
            }
            result
        };
        report.ms = began.elapsed().as_secs_f64() * 1e3;
        let values = match result {
            Ok(values) => Some(values),
            Err(error) => {
                let cancelled = error == NodeError::Cancelled;
                report.error = Some(error);
                match on_failure {
                    OnFailure::PassThrough if !cancelled => passed_through(step, &inputs),
                    _ => None,
                }
            }
        };
        let curves = |value: &Value| match value {
            Value::Curves(curves) => (curves.curve_count(), curves.point_count()),
            _ => (0, 0),
        };
        report.points_read = inputs.iter().flatten().map(|value| curves(value).1).sum();
        for (curves, points) in values.iter().flatten().map(curves) {
            report.curves += curves;
            report.points += points;
        }
        (keys.whole, report, values)
    }

    /// Counts what is kept under a key again.
    fn recount(&self, key: Key) {
        let mut cache = self.cache();
        if let Some(known) = cache.find(key).and_then(|kept| kept.downcast::<Known>().ok()) {
            let bytes = known.bytes();
            cache.keep(key, known, bytes);
        }
    }
}

fn head_of(value: &Value) -> Option<Arc<Scalp>> {
    match value {
        Value::Scalp(scalp) => Some(scalp.clone()),
        _ => None,
    }
}

/// All outputs of a node, as the cache keeps them.
struct Known {
    values: Vec<Value>,
    messages: Vec<Message>,
    gestures: Vec<Arc<Replayed>>,
    thinned: [u64; 2],
    tufts: u32,
    /// Bytes of what was new in them, without heads.
    held: usize,
}

impl Known {
    /// Bytes of all of it, as the cache counts them.
    fn bytes(&self) -> usize {
        self.values.iter().map(Value::bytes).sum::<usize>() + 256
    }
}

/// Keys of one evaluation of a node.
struct Keys {
    /// Of the node and its values: see [`EvalCx::node`].
    node: Key,
    /// See [`EvalCx::node_untraced`].
    node_untraced: Option<Key>,
    /// The key that also counts the curves it reads.
    whole: Key,
}

impl Keys {
    fn new(step: &Step, inputs: &[Vec<Value>], seed: u64, quality: Quality) -> Self {
        let key =
            |of: &dyn Fn(&InputDef, &Value) -> Key| node_key(step, inputs, (seed, quality), of);
        let node = key(&|_, value| value.key());
        let mut values = step.def.inputs.iter().zip(inputs);
        let is_traced = values.all(|(def, of)| of.iter().all(|v| def.key_untraced(v).is_some()));
        let untraced =
            |def: &InputDef, value: &Value| def.key_untraced(value).unwrap_or_else(|| value.key());
        let node_untraced = is_traced.then(|| key(&untraced)).filter(|key| *key != node);
        let mut curves = KeyBuilder::new("reads").key(node);
        for (def, values) in step.def.inputs.iter().zip(inputs) {
            if is_list(def.ty) {
                curves = values.iter().fold(curves.text(def.name), |key, v| key.key(v.key()));
            }
        }
        Self { node, node_untraced, whole: curves.finish() }
    }
}

/// What comes as a list enters the keys of the pieces made from its items, not of all pieces: a node that takes one
/// adds them. Gestures enter one after the other, so that what those before have made is known.
fn is_list(ty: Type) -> bool {
    matches!(ty, Type::Curves | Type::Strokes | Type::Gestures)
}

/// The key of a node and its values but for lists.
fn node_key(
    step: &Step,
    inputs: &[Vec<Value>],
    (seed, quality): (u64, Quality),
    key_of: &dyn Fn(&InputDef, &Value) -> Key,
) -> Key {
    let mut node = KeyBuilder::new(step.def.id).int(u64::from(step.def.version)).int(seed);
    if step.def.thins {
        node = node.int(quality as u64);
    }
    for (def, values) in step.def.inputs.iter().zip(inputs) {
        if is_list(def.ty) || values.is_empty() {
            continue;
        }
        // A value that says what the default says is the same value.
        let default = def.default().map(|default| default.key());
        if values.len() == 1 && default == Some(values[0].key()) {
            continue;
        }
        node = node.text(def.name);
        for value in values {
            node = node.key(key_of(def, value));
        }
    }
    node.finish()
}

/// The first curves that a node reads, for every output that gives curves; none when an output gives something else or
/// there are no curves.
fn passed_through(step: &Step, inputs: &[Vec<Value>]) -> Option<Vec<Value>> {
    let curves = inputs.iter().flatten().find(|v| matches!(v, Value::Curves(_)))?;
    let all = step.def.outputs.iter().all(|o| o.ty == Type::Curves);
    all.then(|| vec![curves.clone(); step.def.outputs.len()])
}

/// What there is to say of a node that was given curves and gives none, where it has not said why.
fn vanished(
    step: &Step,
    inputs: &[Vec<Value>],
    outputs: &[Value],
    said: &[Message],
) -> Option<Message> {
    let curves = |value: &Value| match value {
        Value::Curves(curves) => Some(curves.curve_count()),
        _ => None,
    };
    let mut given = outputs.iter().filter_map(curves).peekable();
    let is_told = said.iter().any(|message| message.warning);
    if is_told || given.peek().is_none() || given.any(|count| count > 0) {
        return None;
    }
    let came: Vec<String> = step
        .def
        .inputs
        .iter()
        .zip(inputs)
        .filter_map(|(def, values)| {
            let count: usize = values.iter().filter_map(curves).sum();
            (count > 0).then(|| format!("{count} at {}", def.name))
        })
        .collect();
    let text = format!("curves came in ({}), and none come out", came.join(", "));
    (!came.is_empty()).then(|| Message { warning: true, text, count: 0, curves: vec![] })
}

fn for_each_on(pool: &rayon::ThreadPool, n: usize, f: &(dyn Fn(usize) + Sync)) {
    if pool.current_num_threads() == 1 || n < 2 {
        (0..n).for_each(f);
    } else {
        pool.install(|| (0..n).into_par_iter().with_max_len(1).for_each(f));
    }
}

struct PoolHost<'a> {
    evaluator: &'a Evaluator,
    pool: &'a rayon::ThreadPool,
    cancel: &'a CancelToken,
    progress: &'a dyn Progress,
    node: &'a str,
    most: Option<u64>,
}

impl Host for PoolHost<'_> {
    fn room(&self) -> Room {
        Room { points: self.most, bytes: (self.evaluator.free_memory)() }
    }
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        for_each_on(self.pool, n, f);
    }
    fn cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }
    fn find(&self, key: Key) -> Option<Kept> {
        let mut cache = self.evaluator.cache();
        if cache.is_off() { None } else { cache.find(key) }
    }
    fn keep(&self, key: Key, value: Kept, bytes: usize) {
        self.evaluator.cache().keep(key, value, bytes);
    }
    fn progress(&self, done: usize, of: usize) {
        self.progress.pieces(self.node, done, of);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::budget::Budget;
    use crate::document::{Document, NodeId, Socket};
    use crate::schedule::files::DiskFiles;
    use crate::schedule::plan::LOOKED_AT;
    use crate::schedule::request::plan;
    use coif_nodes::data::curves::Curves;

    fn guides() -> Document {
        let text = r#"(format: 1, nodes: {"head": (kind: "head"),
            "on": (kind: "scatter_guides")}, links: {"on.scalp": "head.scalp"})"#;
        crate::file::read(text).unwrap().document
    }
    fn evaluate(evaluator: &Evaluator, quality: Quality) -> Outcome {
        let target = Socket::new(NodeId::new("on").unwrap(), "curves");
        let plan = plan(&guides(), &[target], quality, &DiskFiles::default()).unwrap();
        evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet)
    }

    #[test]
    fn a_node_that_is_given_curves_and_gives_none_says_what_came_in() {
        let curves = |n: usize| {
            let mut b = coif_nodes::data::curves::TuftBuilder::new();
            (0..n).for_each(|_| b.push_curve(&[glam::Vec3::ZERO, glam::Vec3::Y]));
            Value::Curves(Curves::new(vec![Arc::new(b.build())]))
        };
        let step = |id: &str| {
            let def = coif_nodes::by_id(id).unwrap();
            Step { name: "a".to_owned(), def, bypass: false, inputs: vec![] }
        };
        let check = |id: &str, inputs: &[Vec<Value>], given: &[usize], said: Option<&str>| {
            let given: Vec<Value> = given.iter().map(|n| curves(*n)).collect();
            let found = vanished(&step(id), inputs, &given, &[]).map(|message| message.text);
            assert_eq!(found.as_deref(), said);
        };
        let two = [vec![curves(2), curves(3)]];
        check("merge", &two, &[0], Some("curves came in (5 at curves), and none come out"));
        check("merge", &two, &[1], None);
        check("merge", &[vec![curves(0)]], &[0], None);
        check("merge", &[vec![]], &[0], None);
        let told = Message { warning: true, text: "so".to_owned(), count: 0, curves: vec![] };
        assert_eq!(vanished(&step("merge"), &two, &[curves(0)], &[told]), None);
    }

    #[test]
    fn each_node_of_a_long_chain_is_looked_at_a_few_times() {
        let def = coif_nodes::by_id("merge").unwrap();
        let step = |n: usize| {
            let from = n.checked_sub(1).map(|step| Source::Wire { step, output: 0 });
            let mut inputs = vec![vec![]; def.inputs.len()];
            inputs[0].extend(from);
            Step { name: format!("n{n}"), def, bypass: false, inputs }
        };
        let n = 2000;
        let plan = Plan {
            seed: 0,
            quality: Quality::Final,
            allow_large: false,
            budget: Budget::default(),
            steps: (0..n).map(step).collect(),
            targets: vec![(n - 1, 0)],
        };
        let evaluator = Evaluator::new(1, 0).unwrap();
        let before = LOOKED_AT.get();
        let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
        assert!(outcome.targets[0].is_some() && outcome.nodes.len() == n);
        let looks = LOOKED_AT.get() - before;
        assert!(looks <= 4 * n, "{looks}");
    }

    #[test]
    fn a_preview_leaves_a_core_where_there_are_more_than_two() {
        for (threads, cache, preview) in [(1, 9, 1), (2, 9, 2), (3, 9, 2), (4, 9, 3), (4, 0, 4)] {
            let evaluator = Evaluator::new(threads, cache).unwrap();
            let found =
                [Quality::Preview, Quality::Final].map(|quality| evaluator.threads(quality));
            assert_eq!(found, [preview, threads], "{threads} threads, cache of {cache}");
        }
    }

    #[test]
    fn what_is_kept_is_counted_and_reused_by_either_quality() {
        let evaluator = Evaluator::new(3, 1 << 30).unwrap();
        assert_eq!(evaluator.cache_bytes(), (0, 1 << 30));
        let first = evaluate(&evaluator, Quality::Preview);
        let (used, budget) = evaluator.cache_bytes();
        assert!(used > 10_000 && used < budget, "{used}");
        let again = evaluate(&evaluator, Quality::Final);
        assert!(again.nodes.iter().all(|node| node.cached), "{:?}", again.nodes);
        assert_eq!(evaluator.cache_bytes().0, used);
        let key = |outcome: &Outcome| outcome.targets[0].as_ref().unwrap().key();
        assert_eq!(key(&first), key(&again));
    }
}
