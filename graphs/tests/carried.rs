//! Shipped grooms on real heads: what was drawn on the built-in head and is carried to another one comes back to where it was.

use coif_graphs::document::{Document, Setting, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_graphs::{file, grooms};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use glam::Vec3;
use std::path::Path;
use std::sync::Arc;

const HEADS: [&str; 4] = [
    "lps_head/LeePerrySmith.glb",
    "ict_head/generic_neutral_mesh.obj",
    "sintel/sintel.obj",
    "snowden_scan/snowden.obj",
];

/// The head of a groom with this mesh and this home; empty texts are the built-in head, and a groom at home.
fn head(document: &Document, mesh: &str, home: &str) -> Arc<Scalp> {
    let mut document = document.clone();
    let (id, node) =
        document.nodes.iter_mut().find(|(_, node)| node.kind == "head").expect("a head");
    for (name, text) in [("mesh", mesh), ("home", home)] {
        if !text.is_empty() {
            let setting = Setting::Known(Value::Text(text.into()));
            Arc::make_mut(node).inputs.insert(name.to_owned(), setting);
        }
    }
    let socket = Socket::new(id.clone(), "scalp");
    let plan = plan(&document, &[socket], Quality::Final, &DiskFiles::new(Path::new(""))).unwrap();
    let evaluator = Evaluator::new(1, 0).unwrap();
    let mut outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
    match outcome.targets.remove(0) {
        Some(Value::Scalp(scalp)) => scalp,
        _ => panic!("no head: {mesh}"),
    }
}

/// All places that a groom keeps of what was drawn, in head units: points of strokes, and roots of gestures.
fn drawn(document: &Document) -> Vec<Vec3> {
    let settings = document.nodes.values().flat_map(|node| node.inputs.values());
    settings
        .flat_map(|setting| match setting {
            Setting::Known(Value::Strokes(strokes)) => {
                strokes.0.iter().flat_map(|s| &s.samples).map(|s| s.position).collect()
            }
            Setting::Known(Value::Gestures(all)) => all.0.iter().filter_map(|g| g.root).collect(),
            _ => vec![],
        })
        .collect()
}

/// In the middle of each groom. What is written in the other head's units drifts under 1 mm; what is also laid on its skin in between
/// does not meet that and is held to 1.5 mm: a map of space does not take one skin onto the other (1.1 mm at most was measured).
#[test]
fn shipped_grooms_carried_there_and_back_drift_under_1_mm_and_under_1_5_mm_laid_on_the_skin_between()
 {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/");
    for mesh in HEADS {
        let path = format!("{data}{mesh}");
        if !Path::new(&path).exists() {
            println!("skipped: shipped_grooms_carried_there_and_back needs ../shared/data/{mesh}");
            continue;
        }
        let cornrows = file::read(grooms::by_name("cornrows").unwrap()).unwrap().document;
        let home = head(&cornrows, "", "");
        let there = head(&cornrows, &path, &home.landmarks().to_string());
        let back = head(&cornrows, "", &there.landmarks().to_string());
        assert!(there.space().carry().is_some() && back.space().carry().is_some());
        for name in ["cornrows", "cornrows_puffs", "dutch_braids", "sketch_bob"] {
            let document = file::read(grooms::by_name(name).unwrap()).unwrap().document;
            let on = |scalp: &Scalp, p: Vec3| scalp.closest_root(p).expect("skin").point;
            let places = drawn(&document);
            assert!(places.len() > 5, "{name} has nothing drawn");
            // As it is written in units of the other head (`coif fit --bake`), and laid on the skin there in between.
            let written = |p: Vec3| there.space().own(p);
            let laid = |p: Vec3| there.frame().head_from_point(on(&there, there.place(p)));
            let drift = |there: &dyn Fn(Vec3) -> Vec3| {
                let again = places
                    .iter()
                    .map(|p| on(&back, back.place(there(*p))).distance(on(&home, home.place(*p))));
                let mut all: Vec<f32> = again.collect();
                all.sort_by(f32::total_cmp);
                [0.5, 0.95].map(|part| all[((all.len() - 1) as f32 * part) as usize])
            };
            let (written, laid) = (drift(&written), drift(&laid));
            println!("{name} on {mesh}: {} places, {written:?} cm, laid {laid:?}", places.len());
            assert!(written[0] < 0.1 && laid[0] < 0.15, "{name} on {mesh}: {written:?} {laid:?}");
        }
    }
}
