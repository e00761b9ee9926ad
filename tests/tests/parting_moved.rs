//! A parting is moved: what runs again is what lies beside it, and the hair is what it would have been if nothing had been kept.

use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::Outcome;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::strokes::{Sample, Stroke, Strokes};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_nodes::maths::transcendental::sin_cos_turns;
use glam::Vec3;
use std::sync::Arc;

/// Rows between drawn partings, braided, with hair through them; free-hanging locks in the same sections, curled.
const GRAPH: &str = r#"(
    format: 1,
    title: "Parting moved",
    seed: 0,
    nodes: {
        "braid": (kind: "lissajous_braid"),
        "braids": (kind: "groom_output", inputs: {"name": "braids"}),
        "clusters": (kind: "cluster_to_strands", inputs: {"strands": 30, "radius": 0.8}),
        "curl": (kind: "shape_list_curl", inputs: {"preset": "3a"}),
        "curls": (kind: "groom_output", inputs: {"name": "curls"}),
        "guides": (kind: "scatter_guides", inputs: {"count": 200, "length": 12.0}),
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
fn strokes(moved: usize, by: f32) -> Strokes {
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
    evaluator: Evaluator,
}

impl Session {
    fn new() -> Self {
        let document = file::read(GRAPH).unwrap_or_else(|err| panic!("{err}")).document;
        Self { document, evaluator: Evaluator::new(2, 1 << 30).unwrap() }
    }

    fn run(&mut self, moved: usize, by: f32) -> Outcome {
        let id = NodeId::new("lines").unwrap();
        let node = Arc::make_mut(self.document.nodes.get_mut(&id).unwrap());
        let strokes = Value::from(strokes(moved, by));
        node.inputs.insert("strokes".to_owned(), Setting::Known(strokes));
        let targets: Vec<Socket> =
            ["braids.curves", "curls.curves"].map(|s| s.parse().unwrap()).into();
        let plan = plan(&self.document, &targets, Quality::Final, &DiskFiles::default())
            .unwrap_or_else(|err| panic!("{err}"));
        let outcome = self.evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
        for node in &outcome.nodes {
            assert_eq!(node.error, None, "{}", node.name);
        }
        outcome
    }
}

fn pieces(outcome: &Outcome, node: &str) -> (u32, u32) {
    let node = outcome.nodes.iter().find(|n| n.name == node).unwrap();
    if node.cached { (0, node.tufts_reused) } else { (node.tufts_run, node.tufts_reused) }
}

#[test]
fn hair_beside_a_moved_parting_is_made_again_and_the_rest_is_kept() {
    let mut session = Session::new();
    let rows = LINES as u32 + 1;
    assert_eq!(pieces(&session.run(0, 0.0), "braid"), (rows, 0));
    for (moved, by) in [(3, 0.3), (3, 0.5), (6, -0.4), (0, 0.0)] {
        let kept = session.run(moved, by);
        let fresh = Session::new().run(moved, by);
        for (kept, fresh) in kept.targets.iter().zip(&fresh.targets) {
            let (Some(kept), Some(fresh)) = (kept, fresh) else { panic!("no hair") };
            assert_eq!(kept.key(), fresh.key(), "parting {moved} by {by}");
        }
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
