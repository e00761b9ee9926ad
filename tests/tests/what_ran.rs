//! What runs after an edit: exactly the nodes and tufts that it reaches, told by the scheduler's own log.

use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::Outcome;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use glam::Vec3;
use std::sync::Arc;

const CLUSTERS: usize = 150;

/// 150 strokes over the upper head, each straight up and out, as clusters of a chain of mapping nodes; hair
/// between them, gathered, beside it.
const GRAPH: &str = r#"(
    format: 1,
    title: "What ran",
    seed: 0,
    nodes: {
        "chain": (
            kind: "groom_output",
        ),
        "curl": (
            kind: "shape_list_curl",
        ),
        "gathered": (
            kind: "groom_output",
        ),
        "head": (
            kind: "head",
        ),
        "hair": (
            kind: "cluster_to_strands",
            inputs: {
                "strands": 20,
            },
        ),
        "between": (
            kind: "interpolate",
            inputs: {
                "count": 2000,
            },
        ),
        "pen": (
            kind: "stroke_input",
        ),
        "points": (
            kind: "resample",
        ),
        "width": (
            kind: "set_width",
        ),
    },
    links: {
        "chain.curves": "width.curves",
        "curl.curves": "hair.curves",
        "gathered.curves": "between.curves",
        "hair.curves": "pen.curves",
        "hair.scalp": "head.scalp",
        "between.guides": "pen.curves",
        "between.scalp": "head.scalp",
        "pen.scalp": "head.scalp",
        "points.curves": "curl.curves",
        "width.curves": "points.curves",
    },
)
"#;

fn strokes() -> Strokes {
    let golden = 2.399_963_2f32;
    let stroke = |i: usize| {
        // A spiral of even area over the cap above the ears.
        let y = 1.0 - 0.75 * (i as f32 + 0.5) / CLUSTERS as f32;
        let r = (1.0 - y * y).sqrt();
        let (s, c) = coif_nodes::maths::transcendental::sin_cos(i as f32 * golden);
        let out = Vec3::new(r * s, y, r * c);
        let sample = |k: usize| Sample {
            position: out * (8.9 + k as f32),
            pressure: 0.5,
            time: k as f32 * 0.02,
            ..Sample::default()
        };
        Stroke::new(i as u64 + 1, (0..6).map(sample).collect())
    };
    Strokes((0..CLUSTERS).map(stroke).collect())
}

struct Session {
    document: Document,
    evaluator: Evaluator,
    files: DiskFiles,
}

impl Session {
    fn new() -> Self {
        let mut document = file::read(GRAPH).unwrap_or_else(|err| panic!("{err}")).document;
        set(&mut document, "pen", "strokes", strokes().into());
        set(&mut document, "pen", "project", "free".into());
        let evaluator = Evaluator::new(2, 1 << 30).unwrap();
        Self { document, evaluator, files: DiskFiles::default() }
    }
    fn run(&self) -> Outcome {
        let targets: Vec<Socket> =
            ["chain.curves", "gathered.curves"].map(|s| s.parse().unwrap()).into();
        let plan = plan(&self.document, &targets, Quality::Final, &self.files)
            .unwrap_or_else(|err| panic!("{err}"));
        let outcome = self.evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
        for node in &outcome.nodes {
            assert_eq!(node.error, None, "{}", node.name);
        }
        outcome
    }
    /// Runs, and tells every node that was not wholly known: its name and how many tufts it made.
    fn ran(&self) -> Vec<(String, u32)> {
        let outcome = self.run();
        let mut ran: Vec<(String, u32)> = outcome
            .nodes
            .iter()
            .filter(|n| !n.cached)
            .map(|n| (n.name.clone(), n.tufts_run))
            .collect();
        ran.sort();
        ran
    }
}

fn set(document: &mut Document, node: &str, input: &str, value: Value) {
    let id = NodeId::new(node).unwrap();
    let node = Arc::make_mut(document.nodes.get_mut(&id).unwrap());
    node.inputs.insert(input.to_owned(), Setting::Known(value));
}

fn tufts(ran: &[(String, u32)], node: &str) -> Option<u32> {
    ran.iter().find(|(name, _)| name == node).map(|(_, n)| *n)
}

#[test]
fn the_first_run_makes_everything_and_the_second_nothing() {
    let session = Session::new();
    let first = session.ran();
    for node in ["pen", "hair", "curl", "points", "width"] {
        assert_eq!(tufts(&first, node), Some(CLUSTERS as u32), "{first:?}");
    }
    assert_eq!(session.ran(), []);
}

#[test]
fn a_value_changed_to_itself_runs_nothing() {
    let mut session = Session::new();
    session.run();
    set(&mut session.document, "points", "count", Value::Int(16));
    assert_eq!(session.ran(), [], "16 is the default");
    set(&mut session.document, "hair", "strands", Value::Int(20));
    assert_eq!(session.ran(), []);
}

#[test]
fn one_parameter_runs_its_node_and_what_hangs_from_it() {
    let mut session = Session::new();
    session.run();
    set(&mut session.document, "points", "count", Value::Int(12));
    let all = CLUSTERS as u32;
    let ran = session.ran();
    let want = [("chain", 0), ("points", all), ("width", all)].map(|(n, t)| (n.to_owned(), t));
    assert_eq!(ran, want);
    set(&mut session.document, "points", "count", Value::Int(16));
    assert_eq!(session.ran(), [], "back to what is known");
}

#[test]
fn one_cluster_of_150_runs_one_tuft_in_every_mapping_node_and_its_neighbours_in_a_gathering_one() {
    let mut session = Session::new();
    session.run();
    let mut edited = strokes();
    // Bent, not moved: its root stays, so that no other hair finds other neighbours.
    for (k, sample) in edited.0[40].samples.iter_mut().enumerate() {
        sample.position.y += 0.05 * (k * k) as f32;
    }
    set(&mut session.document, "pen", "strokes", edited.into());
    let ran = session.ran();
    for node in ["pen", "hair", "curl", "points", "width"] {
        assert_eq!(tufts(&ran, node), Some(1), "{node}: {ran:?}");
    }
    // The hair of each guide is gathered from its neighbours: those tufts that read the bent guide run.
    let gathered = tufts(&ran, "between").unwrap();
    assert_eq!(gathered, GATHERED, "{ran:?}");
}

/// How many of the 150 groups of hair between guides read guide number 40: its own and those of seven neighbours.
const GATHERED: u32 = 8;

#[test]
fn a_cancelled_run_says_so_and_gives_nothing() {
    let session = Session::new();
    let targets = ["chain.curves".parse().unwrap()];
    let plan = plan(&session.document, &targets, Quality::Final, &session.files).unwrap();
    let cancel = CancelToken::default();
    cancel.cancel();
    let outcome = session.evaluator.run(&plan, OnFailure::Stop, &cancel, &Quiet);
    assert!(outcome.cancelled && outcome.targets.iter().all(Option::is_none));
}

#[test]
fn in_the_editor_a_failing_node_passes_its_curves_through() {
    let mut session = Session::new();
    let targets = ["chain.curves".parse().unwrap()];
    // The plan refuses a wrong type; a field without its attribute fails only when it runs.
    use coif_nodes::data::field::Field;
    set(&mut session.document, "width", "scale", Field::Attribute("nothing".into()).into());
    let plan = plan(&session.document, &targets, Quality::Final, &session.files).unwrap();
    let run = |on| session.evaluator.run(&plan, on, &CancelToken::default(), &Quiet);
    assert!(run(OnFailure::Stop).targets[0].is_none());
    let passed = run(OnFailure::PassThrough);
    let Some(Value::Curves(curves)) = &passed.targets[0] else { panic!("no curves") };
    assert!(curves.curve_count() > 0);
    let node = passed.nodes.iter().find(|n| n.name == "width").unwrap();
    assert!(node.error.as_ref().unwrap().to_string().contains("nothing"));
}
