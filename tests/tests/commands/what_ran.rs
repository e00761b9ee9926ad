//! What runs after an edit: exactly the nodes and tufts that it reaches, told by the scheduler's own log.

use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::Outcome;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::gestures::{Gesture, GestureView, Gestures, Layer, PenSample, Tool};
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_nodes::maths::hash::Dice;
use coif_nodes::maths::transcendental::{sin_cos, sin_cos_turns};
use coif_tests::long::is_long;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

const CLUSTERS: usize = 150;

/// 150 strokes over the upper head, each straight up and out, as clusters of a chain of mapping nodes; hair
/// between them, gathered, beside it.
const GRAPH: &str = r#"(
    format: 3,
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
        let (s, c) = sin_cos(i as f32 * golden);
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

/// Rows between drawn partings, braided, with hair through them; free-hanging locks in the same sections, curled.
const PARTED: &str = r#"(
    format: 3,
    title: "Parting moved",
    seed: 0,
    nodes: {
        "braid": (kind: "lissajous_braid"),
        "braids": (kind: "groom_output", inputs: {"name": "braids"}),
        "clusters": (kind: "cluster_to_strands", inputs: {"strands": 12, "radius": 0.8}),
        "curl": (kind: "shape_list_curl", inputs: {"preset": "3a"}),
        "curls": (kind: "groom_output", inputs: {"name": "curls"}),
        "guides": (kind: "scatter_guides", inputs: {"count": 200, "length": 12.0, "seed": 3}),
        "hair": (kind: "braid_hair"),
        "head": (kind: "head"),
        "lines": (kind: "stroke_input", inputs: {"project": "free"}),
        "parted": (kind: "partings"),
        "territory": (kind: "braid_territory", inputs: {"density": 20.0}),
    },
    links: {
        "braid.scalp": "parted.scalp",
        "braid.source": "territory.source",
        "braids.curves": "hair.curves",
        "clusters.curves": "guides.curves",
        "clusters.scalp": "parted.scalp",
        "curl.curves": "clusters.curves",
        "curl.scalp": "parted.scalp",
        "curls.curves": "curl.curves",
        "guides.scalp": "parted.scalp",
        "hair.roots": "territory.curves",
        "hair.scalp": "parted.scalp",
        "hair.stitches": "braid.stitches",
        "hair.strands": "braid.curves",
        "lines.scalp": "head.scalp",
        "parted.lines": "lines.curves",
        "parted.scalp": "head.scalp",
        "territory.scalp": "parted.scalp",
        "territory.source": "parted.rows",
    },
)
"#;

const LINES: usize = 7;

/// Partings from the forehead to the nape, 1.7 cm beside one another; number `moved` lies `by` cm beside its place.
fn lines(moved: usize, by: f32) -> Strokes {
    let stroke = |i: usize| {
        let x = 1.7 * (i as f32 - 0.5 * (LINES - 1) as f32) + if i == moved { by } else { 0.0 };
        let sample = |k: usize| {
            let (up, front) = sin_cos_turns((5.0 + 12.0 * k as f32) / 360.0);
            let radius = (121.0 - x * x).sqrt();
            Sample {
                position: Vec3::new(x, radius * up, radius * front),
                pressure: 0.5,
                time: k as f32 * 0.02,
                ..Sample::default()
            }
        };
        Stroke::new(i as u64 + 1, (0..22).map(sample).collect())
    };
    Strokes((0..LINES).map(stroke).collect())
}

struct Session {
    document: Document,
    targets: Vec<Socket>,
    evaluator: Evaluator,
    files: DiskFiles,
}

impl Session {
    fn of(graph: &str, targets: [&str; 2]) -> Self {
        let document = file::read(graph).unwrap_or_else(|err| panic!("{err}")).document;
        let targets = targets.map(|s| s.parse().unwrap()).into();
        let evaluator = Evaluator::new(2, 1 << 30).unwrap();
        Self { document, targets, evaluator, files: DiskFiles::default() }
    }
    fn new() -> Self {
        let mut session = Self::of(GRAPH, ["chain.curves", "gathered.curves"]);
        set(&mut session.document, "pen", "strokes", strokes().into());
        set(&mut session.document, "pen", "project", "free".into());
        session
    }
    fn parted() -> Self {
        Self::of(PARTED, ["braids.curves", "curls.curves"])
    }
    /// Runs with these partings drawn.
    fn run_parted(&mut self, lines: Strokes) -> Outcome {
        set(&mut self.document, "lines", "strokes", lines.into());
        self.run()
    }
    fn outcome(&self) -> Outcome {
        let plan = plan(&self.document, &self.targets, Quality::Final, &self.files)
            .unwrap_or_else(|err| panic!("{err}"));
        self.evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet)
    }
    fn run(&self) -> Outcome {
        let outcome = self.outcome();
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

fn pieces(outcome: &Outcome, node: &str) -> (u32, u32) {
    let node = outcome.nodes.iter().find(|n| n.name == node).unwrap();
    if node.cached { (0, node.tufts_reused) } else { (node.tufts_run, node.tufts_reused) }
}

/// Whether what was kept of other runs gave the hair that a fresh run gives.
#[track_caller]
fn assert_same(kept: &Outcome, fresh: &Outcome, what: &str) {
    for (kept, fresh) in kept.targets.iter().zip(&fresh.targets) {
        let (Some(kept), Some(fresh)) = (kept, fresh) else { panic!("{what}: no hair") };
        assert_eq!(kept.key(), fresh.key(), "{what}");
    }
}

#[test]
fn hair_beside_a_moved_parting_is_made_again_and_the_rest_is_kept() {
    let mut session = Session::parted();
    let rows = LINES as u32 + 1;
    assert_eq!(pieces(&session.run_parted(lines(0, 0.0)), "braid"), (rows, 0));
    for (moved, by) in [(3, 0.3), (3, 0.5), (6, -0.4), (0, 0.0)] {
        let kept = session.run_parted(lines(moved, by));
        let fresh = Session::parted().run_parted(lines(moved, by));
        assert_same(&kept, &fresh, &format!("parting {moved} by {by}"));
        let of = |node| pieces(&kept, node);
        let ((hair, kept_hair), (curls, kept_curls)) = (of("hair"), of("curl"));
        if by == 0.0 {
            assert_eq!((of("braid"), hair, curls), ((0, rows), 0, 0), "back to what is known");
        } else if moved == 3 {
            assert_eq!(of("braid"), (2, rows - 2), "the rows on its two sides");
            // Hair of a row is made in one piece or two.
            assert!((2..=4).contains(&hair) && kept_hair >= 6, "{hair}, {kept_hair} kept");
            // Locks that hang over other sections read the lines that they pass.
            assert!(curls > 0 && 2 * curls < kept_curls, "{curls}, {kept_curls} kept");
        } else {
            // Number 3 went back to its place as well.
            assert_eq!(of("braid"), (2, rows - 2), "its own rows; those of number 3 are known");
            assert!(kept_hair >= 5 && kept_curls > 0, "{kept_hair}, {kept_curls} kept");
        }
    }
}

#[test]
fn whatever_becomes_of_partings_the_hair_is_that_of_a_fresh_run() {
    let mut session = Session::parted();
    let some = |keep: &dyn Fn(usize) -> bool| {
        let all = lines(0, 0.0).0.into_iter().enumerate();
        Strokes(all.filter(|(i, _)| keep(*i)).map(|(_, stroke)| stroke).collect())
    };
    let scaled = |by: f32| {
        let mut all = lines(0, 0.0);
        for sample in all.0.iter_mut().flat_map(|stroke| &mut stroke.samples) {
            sample.position *= by;
        }
        all
    };
    let point = |at: f32| Sample { position: Vec3::splat(at), ..Sample::default() };
    let cases = [
        ("all", some(&|_| true)),
        ("none", Strokes::default()),
        ("one", some(&|i| i == 3)),
        ("all but one", some(&|i| i != 3)),
        ("far off the head", scaled(1e5)),
        ("in the middle of the head", scaled(1e-4)),
        (
            "a point, and two alike",
            Strokes(vec![Stroke::new(1, vec![point(8.0)]), Stroke::new(2, vec![point(8.0); 2])]),
        ),
        ("all again", some(&|_| true)),
    ];
    for (what, drawn) in cases {
        let kept = session.run_parted(drawn.clone());
        assert_same(&kept, &Session::parted().run_parted(drawn), what);
    }
}

/// A number of a trial, told by its name.
#[derive(Clone, Copy)]
struct Any(Dice, u64);

impl Any {
    fn range(self, what: u64, low: f32, high: f32) -> f32 {
        self.0.range(self.1, what, low, high)
    }
    fn of<'a>(self, what: u64, words: &[&'a str]) -> &'a str {
        words[self.0.below(self.1, what, words.len() as u32) as usize]
    }
}

/// Some node that moves hair, makes it longer or winds it, with what it is set to. Some read a mask, which may be a section.
fn any_modifier(any: Any) -> String {
    let [x, y, z] = [0, 1, 2].map(|what| any.range(10 + what, 0.0, 1.0));
    let keep = any.of(1, &["true", "false"]);
    let far = match any.of(2, &["plain", "plain", "region", "section"]) {
        "region" => format!("Product([{:.3}, Mask(\"scalp\")])", 0.2 + x),
        "section" => format!("Product([{:.3}, Mask(\"fore\")])", 0.2 + x),
        _ => format!("{:.3}", 0.2 + x),
    };
    let (kind, inputs) = match any.of(0, &["clump", "frizz", "length", "noise", "stray", "curl"]) {
        "clump" => (
            "clump",
            format!("\"density\": {:.3}, \"levels\": 2, \"twist\": {:.1}", 0.1 + y, 90.0 * z),
        ),
        "frizz" => ("frizz", format!("\"amplitude\": {far}, \"step\": {:.3}", 0.2 + y)),
        "length" => (
            "length",
            format!("\"share\": {:.3}, \"way\": \"{}\"", 0.5 + x, any.of(3, &["cut", "scale"])),
        ),
        "noise" => (
            "noise",
            format!("\"amplitude\": {far}, \"together\": \"{}\"", any.of(4, &["space", "hair"])),
        ),
        "stray" => ("stray", format!("\"share\": {:.3}, \"distance\": {far}", 0.1 + 0.5 * y)),
        _ => ("shape_list_curl", format!("\"preset\": \"{}\"", any.of(5, &["2b", "3a", "3c"]))),
    };
    let keeps = matches!(kind, "clump" | "frizz" | "noise" | "stray");
    let keep = if keeps { format!(", \"keep_length\": {keep}") } else { String::new() };
    format!("(kind: \"{kind}\", inputs: {{\"seed\": {}, {inputs}{keep}}})", any.of(6, &["1", "2"]))
}

/// Hair of a maker on a parted scalp, and some modifiers after it, all of which run by place.
fn any_graph(any: Any) -> String {
    let (made, nodes, links) = match any.of(7, &["hang", "clusters", "braids"]) {
        // It lies over partings that its scalp does not have.
        "hang" => (
            "hang.curves",
            r#""hang": (kind: "hang", inputs: {"clearance": 0.1, "length": 14.0, "points": 24, "separate": false}),"#,
            r#""hang.roots": "guides.curves", "hang.scalp": "head.scalp","#,
        ),
        "clusters" => (
            "clusters.curves",
            r#""clusters": (kind: "cluster_to_strands", inputs: {"count": 8, "points": 12, "radius": 0.8}),"#,
            r#""clusters.curves": "guides.curves", "clusters.scalp": "parted.scalp","#,
        ),
        _ => (
            "hair.curves",
            r#""braid": (kind: "lissajous_braid"),
            "hair": (kind: "braid_hair", inputs: {"points_per_stitch": 4.0}),
            "territory": (kind: "braid_territory", inputs: {"density": 3.0}),"#,
            r#""braid.scalp": "parted.scalp", "braid.source": "territory.source",
            "hair.roots": "territory.curves", "hair.scalp": "parted.scalp",
            "hair.stitches": "braid.stitches", "hair.strands": "braid.curves",
            "territory.scalp": "parted.scalp", "territory.source": "parted.rows","#,
        ),
    };
    let (mut nodes, mut links, mut last) = (nodes.to_owned(), links.to_owned(), made.to_owned());
    for k in 0..2 + any.1 % 2 {
        let node = any_modifier(Any(any.0, 1000 * (any.1 + 1) + k));
        nodes += &format!("\"move{k}\": {node},");
        links += &format!("\"move{k}.curves\": \"{last}\", \"move{k}.scalp\": \"parted.scalp\",");
        last = format!("move{k}.curves");
    }
    format!(
        r#"(format: 3, nodes: {{
            "head": (kind: "head"),
            "guides": (kind: "scatter_guides", inputs: {{"count": 60, "length": 9.0, "points": 12}}),
            "lines": (kind: "stroke_input", inputs: {{"project": "free"}}),
            "parted": (kind: "partings", inputs: {{"names": "fore 0.9 6 8"}}),
            "out": (kind: "groom_output"),
            {nodes}
        }}, links: {{
            "guides.scalp": "head.scalp",
            "lines.scalp": "head.scalp",
            "parted.lines": "lines.curves",
            "parted.scalp": "head.scalp",
            "out.curves": "{last}",
            {links}
        }})"#
    )
}

/// Lines from the forehead to the nape, each so far beside the middle at its two ends (cm), by id.
fn lines_at(ends: &[(u64, [f32; 2])]) -> Strokes {
    let stroke = |(id, [front, back]): &(u64, [f32; 2])| {
        let sample = |k: usize| {
            let (up, ahead) = sin_cos_turns((5.0 + 12.0 * k as f32) / 360.0);
            let x = front + (back - front) * k as f32 / 21.0;
            let radius = (121.0 - x * x).sqrt();
            let position = Vec3::new(x, radius * up, radius * ahead);
            Sample { position, pressure: 0.5, time: k as f32 * 0.02, ..Sample::default() }
        };
        Stroke::new(*id, (0..22).map(sample).collect())
    };
    Strokes(ends.iter().map(stroke).collect())
}

#[test]
fn however_partings_move_under_whatever_nodes_the_hair_is_that_of_a_run_that_keeps_nothing() {
    let dice = Dice::new(0, 0, "partings under graphs");
    let mut reused = BTreeMap::<&str, u32>::new();
    let (trials, steps) = if is_long() { (32, 5) } else { (5, 3) };
    for trial in 0..trials {
        let any = Any(dice, trial);
        let graph = any_graph(any);
        let mut kept = Session::of(&graph, ["out.curves", "parted.rows"]);
        let mut fresh = Session::of(&graph, ["out.curves", "parted.rows"]);
        // Who keeps nothing notes nothing, and reads all through plain scalps.
        fresh.evaluator = Evaluator::new(2, 0).unwrap();
        let place = |k: u64| 1.9 * (k as f32 - 2.5);
        let mut ends: Vec<(u64, [f32; 2])> = (0..6).map(|k| (k + 1, [place(k); 2])).collect();
        let mut before = ends.clone();
        for step in 0..steps {
            let what = format!("trial {trial}, step {step}: {ends:?} under {graph}");
            for session in [&mut kept, &mut fresh] {
                set(&mut session.document, "lines", "strokes", lines_at(&ends).into());
            }
            let [kept, fresh] = [&kept, &fresh].map(Session::outcome);
            for (kept, fresh) in kept.nodes.iter().zip(&fresh.nodes) {
                assert_eq!(kept.error, fresh.error, "{}, {what}", kept.name);
                assert_eq!(kept.messages, fresh.messages, "{}, {what}", kept.name);
                if step > 0 && !kept.cached && kept.tufts_run > 0 {
                    *reused.entry(kept.kind).or_default() += kept.tufts_reused;
                }
            }
            let keys = |outcome: &Outcome| {
                let of = |value: &Option<Value>| value.as_ref().map(Value::key);
                outcome.targets.iter().map(of).collect::<Vec<_>>()
            };
            assert_eq!(keys(&kept), keys(&fresh), "{what}");
            let pick = any.0.below(trial, 100 + step, ends.len() as u32) as usize;
            let by = |n: u64| any.0.range(trial, 200 + 10 * step + n, -0.7, 0.7);
            let was = ends.clone();
            match any.of(300 + step, &["one end", "both ends", "gone", "new", "back"]) {
                "one end" => ends[pick].1[0] += by(0),
                "both ends" => ends[pick].1 = ends[pick].1.map(|x| x + by(1)),
                "gone" => _ = ends.remove(pick),
                "new" => ends.push((20 + step, [6.0 * by(2), 6.0 * by(3)])),
                _ => ends = before,
            }
            before = was;
        }
    }
    println!("{reused:?}");
    let by_place = [
        "braid_hair",
        "clump",
        "cluster_to_strands",
        "frizz",
        "length",
        "noise",
        "shape_list_curl",
        "stray",
    ];
    for kind in by_place {
        assert!(reused.get(kind).is_some_and(|pieces| *pieces > 0), "{kind}: {reused:?}");
    }
}

/// Clusters that gestures change, and the hair in them.
const SKETCHED: &str = r#"(
    format: 3,
    nodes: {
        "head": (kind: "head"),
        "clusters": (kind: "scatter_guides", inputs: {"count": 30, "length": 12.0, "radius": 1.0}),
        "sketch": (kind: "hair_sketch"),
        "hair": (kind: "cluster_to_strands", inputs: {"strands": 20}),
    },
    links: {
        "clusters.scalp": "head.scalp",
        "sketch.scalp": "head.scalp",
        "sketch.curves": "clusters.curves",
        "hair.curves": "sketch.curves",
        "hair.scalp": "head.scalp",
    },
)"#;

#[test]
fn a_gesture_on_one_cluster_makes_one_tuft_anew_and_taking_it_back_none() {
    let mut session = Session::of(SKETCHED, ["sketch.curves", "hair.curves"]);
    assert_eq!(tufts(&session.ran(), "hair"), Some(30));
    let id = match session.run().targets.first() {
        Some(Some(Value::Curves(curves))) => curves.each().map(|(tuft, i)| tuft.id(i)).min(),
        _ => None,
    };
    let view = GestureView {
        eye: Vec3::new(0.0, 0.0, 80.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        half_height: 0.2,
        parallel: false,
        pixels: 900.0,
    };
    let frizz = |one: u64, wide: f32| Gesture {
        id: one,
        tool: Tool::Frizz,
        layer: Layer::Nearest,
        view,
        samples: (0..97)
            .map(|k: i32| PenSample {
                at: Vec2::new(wide * (((k % 16) - 8).abs() as f32 / 4.0 - 1.0), 0.7 * k as f32),
                pressure: 0.5,
                time: 0.01 * k as f32,
                tilt: Vec2::ZERO,
            })
            .collect(),
        curves: id.into_iter().collect(),
        root: None,
        path: vec![],
        colour: None,
        size: 0.0,
        strength: 1.0,
    };
    let mut draw = |gestures: Vec<Gesture>| {
        set(&mut session.document, "sketch", "gestures", Gestures(gestures).into());
        tufts(&session.ran(), "hair")
    };
    assert_eq!(draw(vec![frizz(1, 60.0)]), Some(1));
    assert_eq!(draw(vec![frizz(1, 60.0), frizz(2, 18.0)]), Some(1));
    // What was made before is kept.
    assert_eq!(draw(vec![frizz(1, 60.0)]).unwrap_or(0), 0);
    assert_eq!(draw(vec![]).unwrap_or(0), 0);
}
