//! How soon a drag is seen: sliders of a shipped groom moved as a hand moves them, in preview quality, with everything kept
//! that an editor keeps. Prints for each slider the median and the worst time to new hair, and what ran; and how soon the first hair,
//! the preview and all hair of each recipe are there on a head that is known (`-- first-hair`: these alone). `-- heroes` does both for each
//! hero, with every slider of its nodes, and names those that take longer than 50 ms.

use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_graphs::{file, grooms};
use coif_nodes::data::gestures::{Gesture, Gestures, Layer, PenSample, Tool};
use coif_nodes::define::{Type, Value};
use coif_nodes::eval::Quality;
use glam::Vec2;
use std::time::Instant;

/// A slider and the ends between which it is dragged.
const SLIDERS: &[(&str, &str, f32, f32)] = &[
    ("cornrows", "fill.frizz", 0.0, 0.3),
    ("cornrows", "braid.flare", -0.8, 0.0),
    ("cornrows", "braid.tie", 0.8, 0.98),
    ("cornrows", "colour.melanin_root", 0.3, 0.97),
    ("cornrows", "rows.smoothing", 0.1, 1.0),
    ("start", "hair.clump", 0.0, 0.5),
];

/// 150 clusters that the pen combs, and the hair in them.
const SKETCH: &str = r#"(
    format: 3,
    nodes: {
        "head": (kind: "head"),
        "clusters": (kind: "scatter_guides", inputs: {
            "count": 150, "length": 14.0, "radius": 1.0, "lie": 40.0, "bend": 30.0, "points": 8,
        }),
        "sketch": (kind: "hair_sketch"),
        "hair": (kind: "cluster_to_strands", inputs: {"density": 0.5}),
    },
    links: {
        "clusters.scalp": "head.scalp",
        "sketch.scalp": "head.scalp",
        "sketch.curves": "clusters.curves",
        "hair.curves": "sketch.curves",
        "hair.scalp": "head.scalp",
    },
)"#;

/// Each recipe as it is opened: its first hair, its preview, all of it, one after the other.
fn first_hair() {
    for (name, text) in grooms::TEMPLATES {
        let document = file::read(text).expect("it reads").document;
        let of = |kind: &str, output: &str| -> Vec<Socket> {
            let nodes = document.nodes.iter().filter(|(_, node)| node.kind == kind);
            nodes.map(|(id, _)| Socket::new(id.clone(), output)).collect()
        };
        let (heads, hair) = (of("head", "scalp"), of("groom_output", "curves"));
        let evaluator = Evaluator::new(0, 1 << 30).expect("threads");
        let files = DiskFiles::default();
        let run = |targets: &[Socket], quality: Quality| {
            let began = Instant::now();
            let plan = plan(&document, targets, quality, &files).expect("a plan");
            let outcome =
                evaluator.run(&plan, OnFailure::PassThrough, &CancelToken::default(), &Quiet);
            let made: usize = match outcome.nodes.last() {
                Some(node) => node.curves,
                None => 0,
            };
            (began.elapsed().as_secs_f64() * 1e3, made)
        };
        run(&heads, Quality::Final);
        let [first, preview, all] = [Quality::FirstLook, Quality::Preview, Quality::Final]
            .map(|quality| run(&hair, quality));
        println!(
            "{name}: first hair after {:.0} ms ({} strands), preview after {:.0} more ({}), all after {:.0} more ({})",
            first.0, first.1, preview.0, preview.1, all.0, all.1
        );
    }
}

/// A comb of all layers down the side of the head, sample by sample; then it is taken back.
fn sketch() {
    let mut document = file::read(SKETCH).expect("it reads").document;
    let bob = grooms::by_name("sketch_bob").expect("a shipped groom");
    let bob = file::read(bob).expect("it reads").document;
    let held = bob.node("hair_sketch").and_then(|node| node.inputs.get("gestures").cloned());
    let Some(Setting::Known(Value::Gestures(drawn))) = held else { panic!("no gestures") };
    let comb = drawn.0.iter().find(|one| one.tool == Tool::Comb).expect("a comb");
    let gesture = |samples: usize| {
        let at = |k: usize| PenSample {
            at: Vec2::new(-40.0 + 6.0 * k as f32, -120.0 + 9.0 * k as f32),
            pressure: 0.5,
            time: 0.008 * k as f32,
            tilt: Vec2::ZERO,
        };
        let samples = (0..samples).map(at).collect();
        Gesture { samples, curves: vec![], layer: Layer::Through, ..comb.clone() }
    };
    let evaluator = Evaluator::new(0, 1 << 30).expect("threads");
    let files = DiskFiles::default();
    let run = |document: &Document, socket: &str, quality: Quality| {
        let began = Instant::now();
        let target = [socket.parse().expect("a socket")];
        let plan = plan(document, &target, quality, &files).expect("a plan");
        let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
        let ms = began.elapsed().as_secs_f64() * 1e3;
        let made = outcome.nodes.iter().find(|node| node.name == "hair");
        (ms, made.map_or((0, 0), |node| (node.tufts_run, node.tufts_reused)))
    };
    let set = |document: &mut Document, gestures: Vec<Gesture>| {
        let node = NodeId::new("sketch").expect("an id");
        let setting = Setting::Known(Gestures(gestures).into());
        Edit::SetInput { node, input: "gestures".into(), setting }
            .apply(document)
            .expect("an edit");
    };
    run(&document, "hair.curves", Quality::Final);
    run(&document, "hair.curves", Quality::Preview);
    let (mut clusters, mut strands, mut most) = (vec![], vec![], (0, 0));
    for k in 2..42 {
        set(&mut document, vec![gesture(k)]);
        clusters.push(run(&document, "sketch.curves", Quality::Preview).0);
        let (ms, made) = run(&document, "hair.curves", Quality::Preview);
        strands.push(ms);
        most = most.max(made);
    }
    set(&mut document, vec![]);
    let (undo, _) = run(&document, "hair.curves", Quality::Preview);
    let (whole, _) = run(&document, "hair.curves", Quality::Final);
    for times in [&mut clusters, &mut strands] {
        times.sort_by(f64::total_cmp);
    }
    let told = |times: &[f64]| format!("{:.2} ms median, {:.2} worst", times[20], times[39]);
    println!(
        "150 clusters, a comb's sample: clusters {}; strands after them {} ({} tufts made at most, {} known); undo {undo:.2} ms, all hair again {whole:.2} ms",
        told(&clusters),
        told(&strands),
        most.0,
        most.1,
    );
}

/// Longest median of a slider that is not named, ms.
const SOON: f64 = 50.0;

/// Each hero: how soon its first hair, its preview and all hair are there on a head that is known, and how soon a preview follows each
/// slider, moved three times by a fiftieth of its range.
fn heroes() {
    for name in grooms::HEROES {
        let text = grooms::by_name(name).expect("a shipped groom");
        let mut document = file::read(text).expect("it reads").document;
        let of = |kind: &str, output: &str| -> Vec<Socket> {
            let nodes = document.nodes.iter().filter(|(_, node)| node.kind == kind);
            nodes.map(|(id, _)| Socket::new(id.clone(), output)).collect()
        };
        let (heads, hair) = (of("head", "scalp"), of("groom_output", "curves"));
        let evaluator = Evaluator::new(0, 4 << 30).expect("threads");
        let files = DiskFiles::default();
        let run = |document: &Document, targets: &[Socket], quality: Quality| {
            let began = Instant::now();
            let plan = plan(document, targets, quality, &files).expect("a plan");
            evaluator.run(&plan, OnFailure::PassThrough, &CancelToken::default(), &Quiet);
            began.elapsed().as_secs_f64() * 1e3
        };
        run(&document, &heads, Quality::Final);
        let [first, preview, all] = [Quality::FirstLook, Quality::Preview, Quality::Final]
            .map(|quality| run(&document, &hair, quality));
        let (mut medians, mut slow) = (vec![], vec![]);
        let nodes: Vec<NodeId> = document.nodes.keys().cloned().collect();
        for id in nodes {
            let kind = document.nodes[&id].kind.clone();
            let Some(def) = coif_nodes::by_id(&kind) else { continue };
            for input in def.inputs {
                let Some((low, high)) = input.soft.or(input.hard) else { continue };
                let set = document.nodes[&id].inputs.get(input.name).cloned();
                let from = match set.clone().map_or_else(
                    || input.default(),
                    |set| match set {
                        Setting::Known(value) => Some(value),
                        _ => None,
                    },
                ) {
                    Some(Value::Float(x)) => f64::from(x),
                    Some(Value::Int(n)) => n as f64,
                    Some(Value::Field(field)) if field.constant().is_some() => {
                        f64::from(field.constant().unwrap_or_default())
                    }
                    _ => continue,
                };
                let mut times = vec![];
                for k in 1..=3 {
                    let step = (high - low) * 0.02 * f64::from(k);
                    let to = if from + step <= high { from + step } else { from - step };
                    let text = match input.ty {
                        Type::Int => format!("{:.0}", to.max(from + f64::from(k))),
                        _ => format!("{to:?}"),
                    };
                    let value = coif_graphs::text::parse_value(input.ty, &text).expect("a number");
                    let (node, input) = (id.clone(), input.name.to_owned());
                    let setting = Setting::Known(value);
                    let edit = Edit::SetInput { node, input, setting };
                    edit.apply(&mut document).expect("an edit");
                    times.push(run(&document, &hair, Quality::Preview));
                }
                let node = document.nodes.get_mut(&id).map(std::sync::Arc::make_mut);
                if let Some(inputs) = node.map(|node| &mut node.inputs) {
                    match set {
                        Some(set) => inputs.insert(input.name.to_owned(), set),
                        None => inputs.remove(input.name),
                    };
                }
                run(&document, &hair, Quality::Preview);
                times.sort_by(f64::total_cmp);
                medians.push(times[1]);
                if times[1] > SOON {
                    slow.push((times[1], format!("{id}.{} {:.0}", input.name, times[1])));
                }
            }
        }
        medians.sort_by(f64::total_cmp);
        slow.sort_by(|a, b| b.0.total_cmp(&a.0));
        println!(
            "{name}: first hair after {first:.0} ms, preview after {preview:.0} more, all after {all:.0} more; {} sliders, median {:.0} ms, {} over {SOON} ms: {}",
            medians.len(),
            medians[medians.len() / 2],
            slow.len(),
            slow.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>().join(", ")
        );
    }
}

fn main() {
    if std::env::args().any(|arg| arg == "heroes") {
        return heroes();
    }
    first_hair();
    if std::env::args().any(|arg| arg == "first-hair") {
        return;
    }
    sketch();
    for (groom, socket, from, to) in SLIDERS {
        let text = grooms::by_name(groom).expect("a shipped groom");
        let mut document: Document = file::read(text).expect("it reads").document;
        let socket: Socket = socket.parse().expect("NODE.INPUT");
        if !document.nodes.contains_key(&socket.node) {
            println!("{groom} has no {socket}: {:?}", document.nodes.keys().collect::<Vec<_>>());
            continue;
        }
        let outputs = document.nodes.iter().filter(|(_, node)| node.kind == "groom_output");
        let targets: Vec<Socket> =
            outputs.map(|(id, _)| Socket::new(id.clone(), "curves")).collect();
        let files = DiskFiles::default();
        let evaluator = Evaluator::new(0, 1 << 30).expect("threads");
        let run = |document: &Document, quality: Quality| {
            let began = Instant::now();
            let plan = plan(document, &targets, quality, &files).expect("a plan");
            let outcome =
                evaluator.run(&plan, OnFailure::PassThrough, &CancelToken::default(), &Quiet);
            let ms = began.elapsed().as_secs_f64() * 1e3;
            let mut ran: Vec<(f64, String)> = outcome
                .nodes
                .iter()
                .filter(|n| !n.cached)
                .map(|n| {
                    (
                        n.ms,
                        format!(
                            "{} {:.0} ms ({}/{})",
                            n.name,
                            n.ms,
                            n.tufts_run,
                            n.tufts_run + n.tufts_reused
                        ),
                    )
                })
                .collect();
            ran.sort_by(|a, b| b.0.total_cmp(&a.0));
            (ms, ran.into_iter().map(|(_, text)| text).collect::<Vec<_>>().join(", "))
        };
        let (whole, _) = run(&document, Quality::Final);
        let (first, _) = run(&document, Quality::Preview);
        let mut times = vec![];
        let mut said = String::new();
        for k in 0..9 {
            let value = from + (to - from) * k as f32 / 8.0;
            let setting = Setting::Known(Value::Float(value));
            let edit = Edit::SetInput {
                node: socket.node.clone(),
                input: socket.name.to_string(),
                setting,
            };
            edit.apply(&mut document).expect("an edit");
            let (ms, ran) = run(&document, Quality::Preview);
            times.push(ms);
            said = ran;
        }
        times.sort_by(f64::total_cmp);
        println!(
            "{groom} {socket}: preview {:.0} ms median, {:.0} worst (first {first:.0}; all hair {whole:.0}); {said}",
            times[4], times[8]
        );
    }
}
