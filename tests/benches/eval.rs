//! `coif eval` as a whole process: 100,000 strands of 16 points from 150 clusters, file included, on two threads.
//!
//! Prints, for a few runs in turn: wall time, the most memory, the size of the file, and the bound that the memory
//! must keep (three times the file and 60 MiB). Run it alone: `cargo bench -p coif-tests --bench eval`.

use coif_tests::{Folder, eval};
use std::time::Instant;

fn main() {
    // `cargo test --benches` only asks whether it starts.
    if std::env::args().any(|arg| arg == "--test") {
        return;
    }
    let folder = Folder::new("bench-eval");
    let graph = folder.path("graph.ron");
    std::fs::write(&graph, GRAPH).unwrap();
    let graph = graph.display().to_string();
    for extension in ["usdc", "usda", "hair"] {
        let out = folder.path(&format!("hair.{extension}"));
        let mut walls = vec![];
        let mut last = serde_json::Value::Null;
        for _ in 0..7 {
            let began = Instant::now();
            last = eval(&graph, &["--threads", "2", "--out", &out.display().to_string()]);
            walls.push(began.elapsed().as_secs_f64());
        }
        walls.sort_by(f64::total_cmp);
        let size = std::fs::metadata(&out).unwrap().len() as f64 / (1 << 20) as f64;
        let output = &last["outputs"][0];
        println!(
            "{extension}: {} curves, {} points; wall {:.2} s middle, {:.2} least; peak {:.0} MiB (bound {:.0}); file {size:.1} MiB",
            output["curves"],
            output["points"],
            walls[walls.len() / 2],
            walls[0],
            last["peak_rss_mib"].as_f64().unwrap_or(0.0),
            3.0 * size + 60.0,
        );
        if extension == "usdc" {
            for node in last["nodes"].as_array().unwrap() {
                println!("    {} {} ms", node["name"].as_str().unwrap(), node["ms"]);
            }
        }
    }
}

const GRAPH: &str = r#"(
    format: 3,
    title: "Bench",
    seed: 0,
    nodes: {
        "clusters": (
            kind: "scatter_guides",
            inputs: {
                "count": 150,
            },
        ),
        "head": (
            kind: "head",
        ),
        "out": (
            kind: "groom_output",
        ),
        "strands": (
            kind: "cluster_to_strands",
            inputs: {
                "count": 667,
                "frizz": 0.3,
                "points": 16,
            },
        ),
    },
    links: {
        "clusters.scalp": "head.scalp",
        "out.curves": "strands.curves",
        "strands.curves": "clusters.curves",
        "strands.scalp": "head.scalp",
    },
)
"#;
