//! How soon a drag is seen: sliders of a shipped groom moved as a hand moves them, in preview quality, with everything kept
//! that an editor keeps. Prints for each slider the median and the worst time to new hair, and what ran.

use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Setting, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_graphs::{file, grooms};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use std::time::Instant;

/// A slider and the ends between which it is dragged.
const SLIDERS: &[(&str, &str, f32, f32)] = &[
    ("cornrows", "fill.frizz", 0.0, 0.3),
    ("cornrows", "braid.flare", -0.8, 0.0),
    ("cornrows", "braid.tie", 0.8, 0.98),
    ("cornrows", "colour.melanin_root", 0.3, 0.97),
    ("cornrows", "rows.smoothing", 0.1, 1.0),
    ("start", "hair.frizz", 0.0, 0.3),
];

fn main() {
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
