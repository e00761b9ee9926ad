//! The report of an evaluation, as JSON that other tools read. Its fields are a contract.

use coif_graphs::schedule::budget::Used;
use coif_graphs::schedule::result::{NodeReport, content_hash_until};
use coif_graphs::schedule::run::CancelToken;
use coif_nodes::data::curves::Curves;
use coif_nodes::data::gestures::Replayed;
use coif_nodes::eval::Message;
use serde::{Serialize, Serializer};
use std::fmt;
use std::sync::{Arc, LazyLock};
use std::time::Instant;

/// What an evaluation made and what happened on the way.
#[derive(Serialize)]
pub(crate) struct Report {
    /// Version of coif.
    pub(crate) coif: &'static str,
    /// Path of the graph, as given.
    pub(crate) graph: String,
    /// Heads that were asked for (`--scalp`), as given.
    pub(crate) scalp: Vec<String>,
    /// Inputs that were set (`--set` and a sweep's row), as given.
    pub(crate) set: Vec<String>,
    /// Name of the row of a sweep; missing without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) row: Option<String>,
    /// Seed it ran with.
    pub(crate) seed: u64,
    /// Exit code that it ended with, alone.
    pub(crate) exit: u8,
    /// Hash of all that it was made from; null where that is not known.
    pub(crate) inputs: Option<String>,
    /// Every file that was written, but for the report.
    pub(crate) files: Vec<String>,
    /// Wall time from start to the last byte, milliseconds.
    pub(crate) total_ms: f64,
    /// Most memory the process held, MiB; null where the system does not tell.
    pub(crate) peak_rss_mib: Option<f64>,
    /// The (first) head; null when none ran.
    pub(crate) head: Option<Head>,
    /// What the outputs gave.
    pub(crate) outputs: Vec<Output>,
    /// The picture that was drawn; missing where none was asked for.
    #[cfg(feature = "render")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) picture: Option<PictureReport>,
    /// What became of the groom on another head; missing but for `coif fit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fit: Option<Fit>,
    /// What was used of the groom's budget; missing where it has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) budget: Vec<Budgeted>,
    /// Every node that was needed.
    pub(crate) nodes: Vec<Node>,
    /// Why it ended with another exit code than 0.
    pub(crate) errors: Vec<String>,
    /// What was left out, clamped or changed.
    pub(crate) warnings: Vec<String>,
    /// What is as it should be, and may surprise.
    pub(crate) notes: Vec<String>,
}

/// How the head was understood.
#[derive(Serialize)]
pub(crate) struct Head {
    /// The node.
    pub(crate) node: String,
    /// Centimetres in one unit of the mesh file.
    pub(crate) scale: f32,
    /// Radius of the cranium, cm.
    pub(crate) radius_cm: f32,
    /// What lengths that scale with the head are multiplied by.
    pub(crate) length_factor: f32,
    /// Centre of the cranium, cm, in the (scaled) space of the mesh.
    pub(crate) origin: [f32; 3],
    /// Up, in the space of the mesh.
    pub(crate) up: [f32; 3],
    /// Forward, in the space of the mesh.
    pub(crate) forward: [f32; 3],
    /// Triangles.
    pub(crate) triangles: usize,
}

/// What one output gave.
#[derive(Serialize)]
pub(crate) struct Output {
    pub(crate) node: String,
    pub(crate) socket: String,
    /// Name of its group in files.
    pub(crate) group: String,
    pub(crate) curves: usize,
    pub(crate) points: usize,
    /// Lowest and highest corner, cm.
    pub(crate) bounds: Option<[[f32; 3]; 2]>,
    /// Content hash: the same on every machine. Null where somebody ended it first.
    pub(crate) hash: ContentHash,
    /// Curves resampled because other tools would have read another curve.
    pub(crate) resampled: usize,
    /// How many of these a thin part or a fold of the skin made leave the curve they were, and how far (cm) the farthest.
    pub(crate) moved: usize,
    pub(crate) farthest_cm: f32,
    /// Largest distance, cm, between the curves as coif and as USD readers understand them.
    pub(crate) reading_difference: f32,
    /// How far roots lie from where they were drawn, carried over to this head: the middle and the largest distance, cm;
    /// null where nothing was drawn.
    pub(crate) root_drift_cm: Option<[f32; 2]>,
}

/// The content hash of curves, found by a thread of its own while files are written; who reads it waits for it, and finds it
/// where there was no thread to be had.
pub(crate) struct ContentHash(Arc<Lazy>);

type Lazy = LazyLock<Option<String>, Box<dyn FnOnce() -> Option<String> + Send>>;

impl ContentHash {
    /// Begins to find it.
    pub(crate) fn of(curves: &Curves, cancel: &CancelToken) -> Self {
        let (curves, cancel) = (curves.clone(), cancel.clone());
        let find = move || content_hash_until(&curves, &|| cancel.is_cancelled());
        let hash: Arc<Lazy> = Arc::new(LazyLock::new(Box::new(find)));
        let found = hash.clone();
        let _ = std::thread::Builder::new().spawn(move || found.is_some());
        Self(hash)
    }
    /// Waits until it is found, or given up.
    pub(crate) fn wait(&self) -> Option<&str> {
        (**self.0).as_deref()
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.wait().unwrap_or("unknown"))
    }
}

impl Serialize for ContentHash {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.wait().serialize(serializer)
    }
}

/// A picture, or all those of a turntable.
#[cfg(feature = "render")]
#[derive(Serialize)]
pub(crate) struct PictureReport {
    /// Every file that was written.
    pub(crate) files: Vec<String>,
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// What the picture is, in words; pictures carry the same line.
    pub(crate) description: String,
    pub(crate) view: String,
    pub(crate) camera: String,
    pub(crate) light: String,
    pub(crate) samples: u32,
    /// How pictures for a display are made.
    pub(crate) transform: &'static str,
    /// Name and driver of what drew it.
    pub(crate) adapter: String,
    /// Wall time of the evaluation, milliseconds.
    pub(crate) evaluation_ms: f64,
    /// Wall time of making the device and its shaders, beside the evaluation.
    pub(crate) device_ms: f64,
    /// From the end of the evaluation to one whole sample.
    pub(crate) first_sample_ms: f64,
    /// From the end of the evaluation to the last sample of the last picture.
    pub(crate) draw_ms: f64,
}

/// A groom on another head, beside the same at home.
#[derive(Serialize)]
pub(crate) struct Fit {
    /// Landmarks of the home, in its head units.
    pub(crate) home: String,
    /// Landmarks of the other head, in its own.
    pub(crate) landmarks: String,
    /// How much of the map was taken, 0 to 1: less than 1 where all of it would fold.
    pub(crate) part: f32,
    /// How much the map stretches the region, in head units: least, middle, most.
    pub(crate) stretch: [f32; 3],
    /// Whether the graph was written in units of the other head.
    pub(crate) baked: bool,
    pub(crate) roots: Vec<Roots>,
    pub(crate) sections: Vec<Parted>,
    /// Hair of all outputs that goes deeper under the skin than it may, and how deep (cm) the deepest. Guides are no hair.
    pub(crate) inside: usize,
    pub(crate) deepest_cm: f32,
}

/// Roots of a node, or of an output's group.
#[derive(Serialize)]
pub(crate) struct Roots {
    pub(crate) name: String,
    /// How many there are at home and on the other head.
    pub(crate) home: usize,
    pub(crate) here: usize,
    /// Those at home that are gone here, by id.
    pub(crate) lost: usize,
    /// Those here that are not there at home.
    pub(crate) new: usize,
    /// Those in the region at home that lie outside of it here.
    pub(crate) outside: usize,
    /// Those farther than 0.5 cm (on a head of average size) from where the map brings them.
    pub(crate) missed: usize,
    /// How far they lie from where the map brings them, cm: middle, 95 %, largest; null where none is on both.
    pub(crate) drift_cm: Option<[f32; 3]>,
}

/// Sections of a parted scalp.
#[derive(Serialize)]
pub(crate) struct Parted {
    pub(crate) node: String,
    /// How many at home and on the other head.
    pub(crate) home: usize,
    pub(crate) here: usize,
    /// Names that are gone, and those that are new: of sections that merged, split or moved.
    pub(crate) gone: Vec<String>,
    pub(crate) new: Vec<String>,
}

/// One term of the budget.
#[derive(Serialize)]
pub(crate) struct Budgeted {
    /// `seconds`, `points` or `mib`.
    pub(crate) term: &'static str,
    pub(crate) limit: f64,
    pub(crate) used: f64,
    pub(crate) over: bool,
    /// The node with the largest part, and how large that is, 0 to 1.
    pub(crate) node: String,
    pub(crate) share: f64,
}

impl From<Used> for Budgeted {
    fn from(of: Used) -> Self {
        let over = of.is_over();
        let Used { term, limit, used, node, share } = of;
        Self { term: term.word(), limit, used: rounded(used), over, node, share: rounded(share) }
    }
}

/// One node.
#[derive(Serialize)]
pub(crate) struct Node {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) ms: f64,
    pub(crate) cached: bool,
    pub(crate) tufts_run: u32,
    pub(crate) tufts_reused: u32,
    pub(crate) curves: usize,
    pub(crate) points: usize,
    /// Bytes that its values hold, but for what they share with what it read.
    pub(crate) bytes: usize,
    pub(crate) messages: Vec<String>,
    /// What became of its gestures, in their order; missing where it has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) gestures: Vec<GestureReport>,
}

/// One pen gesture, replayed on this head and these curves.
#[derive(Serialize)]
pub(crate) struct GestureReport {
    /// Its number, as in messages: from 0 in drawing order.
    pub(crate) number: usize,
    pub(crate) id: u64,
    pub(crate) tool: &'static str,
    /// How far the root of an implant lies from where the head's frame puts it, cm; null where the gesture keeps no root.
    pub(crate) drift_cm: Option<f32>,
    /// How far what was made runs from the kept path, seen from its root: the mean over its length; null without a path.
    pub(crate) turned_degrees: Option<f32>,
    /// Curves that it names to act on; 0 where it takes what lies under the pen.
    pub(crate) named: usize,
    /// Curves it took: of those it names the ones that are there.
    pub(crate) picked: usize,
    /// Curves it made, changed or removed.
    pub(crate) changed: usize,
    /// Ids that it names and that are gone.
    pub(crate) orphaned: Vec<String>,
    /// What it could not do.
    pub(crate) said: Vec<String>,
}

impl GestureReport {
    fn new((number, replayed): (usize, &Replayed)) -> Self {
        let Replayed { id, tool, drift, turned, named, picked, changed, orphaned, said } =
            replayed.clone();
        Self {
            number,
            id,
            tool,
            drift_cm: drift,
            turned_degrees: turned,
            named,
            picked,
            changed,
            orphaned: orphaned.iter().map(|id| format!("{id:016x}")).collect(),
            said,
        }
    }
}

impl Report {
    /// An empty report.
    pub(crate) fn new(graph: String) -> Self {
        Self {
            coif: env!("CARGO_PKG_VERSION"),
            graph,
            scalp: vec![],
            set: vec![],
            row: None,
            seed: 0,
            exit: 0,
            inputs: None,
            files: vec![],
            total_ms: 0.0,
            peak_rss_mib: None,
            head: None,
            outputs: vec![],
            #[cfg(feature = "render")]
            picture: None,
            fit: None,
            budget: vec![],
            nodes: vec![],
            errors: vec![],
            warnings: vec![],
            notes: vec![],
        }
    }

    /// As it is written.
    pub(crate) fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Notes how long it took and what memory.
    pub(crate) fn end(&mut self, began: Instant) {
        self.total_ms = rounded(began.elapsed().as_secs_f64() * 1e3);
        self.peak_rss_mib = peak_rss_mib();
    }

    /// Takes over what the evaluation said of its nodes.
    pub(crate) fn add_nodes(&mut self, nodes: &[NodeReport]) {
        for node in nodes {
            for message in node.messages.iter().filter(|m| m.warning) {
                self.warnings.push(format!("{}: {message}", node.name));
            }
            self.nodes.push(Node {
                name: node.name.clone(),
                kind: node.kind,
                ms: rounded(node.ms),
                cached: node.cached,
                tufts_run: node.tufts_run,
                tufts_reused: node.tufts_reused,
                curves: node.curves,
                points: node.points,
                bytes: node.bytes,
                messages: node.messages.iter().map(Message::with_id).collect(),
                gestures: (0..)
                    .zip(node.gestures.iter().map(|one| &**one))
                    .map(GestureReport::new)
                    .collect(),
            });
        }
    }
}

/// Microseconds are enough for a person and for a budget.
pub(crate) fn rounded(ms: f64) -> f64 {
    (ms * 1e3).round() / 1e3
}

/// The most memory the process has held so far, MiB.
fn peak_rss_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(rounded(kib / 1024.0))
}
