//! coif beside its peers: the cases of `../shared/tools/peer_bench.py`, by their names, what each costs a point, and how often over that
//! memory could be copied.
//!
//! Prints for each case the median wall time on two threads, processor time for a point that comes out, the ratio of that to copying a
//! point on this machine, and, where `tests/run.sh --long` has installed Blender, Blender's median beside it, taken in turn in the same
//! run. Export, heroes and sliders in the window are not among them. Before each run one value changes a little, as under a hand on a slider. At the end it names each line that misses what it should
//! reach at least; the exit code is then 1.
//!
//! `cargo bench -p coif-tests --bench peers [-- CASE...]`: only cases whose name contains one of the words. Run it alone.

use coif_graphs::document::{Document, Setting, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_tests::{repository, shared};
use cpu_time::ProcessTime;
use serde_json::Value as Json;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// Runs of a case, after one that is not counted.
const RUNS: usize = 7;

/// What is timed.
struct Case {
    name: &'static str,
    /// The node whose curves are asked for.
    target: &'static str,
    /// The input that changes, and its value in the first run; it grows by a hundredth with each, or by one where it counts.
    turned: &'static str,
    from: f32,
    /// Case and line of `peer_bench.py`, where it has one, and how many times as fast coif is to be at least.
    peer: Option<(&'static str, &'static str, f64)>,
    /// What a point is to cost at most where no peer has the case: processor time, ns.
    most_ns: Option<f64>,
}

const fn case(name: &'static str, target: &'static str, turned: &'static str, from: f32) -> Case {
    Case { name, target, turned, from, peer: None, most_ns: None }
}

/// Of 100,000 hairs of 16 points where nothing else is said.
const CASES: &[Case] = &[
    Case {
        peer: Some(("interpolate", "interpolate guides=500 guide_pts=16 (new roots)", 10.0)),
        ..case("interpolate from 500 guides", "hair", "hair.seed", 1.0)
    },
    Case {
        peer: Some(("curl", "curl guided subdiv=0 map=existing", 10.0)),
        ..case("curl", "curl", "curl.diameter", 1.5)
    },
    Case {
        peer: Some(("clumpfrizz", "clump map=existing", 20.0)),
        ..case("clump", "clump", "clump.amount", 0.7)
    },
    Case {
        peer: Some(("clumpfrizz", "noise alone", 20.0)),
        ..case("noise", "noise", "noise.amplitude", 0.4)
    },
    Case {
        peer: Some(("clumpfrizz", "frizz alone", 20.0)),
        ..case("frizz", "frizz", "frizz.amplitude", 0.4)
    },
    case("length", "length", "length.share", 0.7),
    case("width", "width", "width.root", 0.008),
    Case { most_ns: Some(60.0), ..case("clump, parted head", "p_clump", "p_clump.amount", 0.7) },
    Case { most_ns: Some(60.0), ..case("noise, parted head", "p_noise", "p_noise.amplitude", 0.4) },
    Case { most_ns: Some(60.0), ..case("frizz, parted head", "p_frizz", "p_frizz.amplitude", 0.4) },
    Case { most_ns: Some(60.0), ..case("length, parted head", "p_length", "p_length.share", 0.7) },
    Case {
        peer: Some(("braid", "braid guides=50 hairs/braid=300 subdiv=0 map=existing", 15.0)),
        ..case("braid 50 x 300 x 64", "braid_hair", "braid.width", 1.5)
    },
    Case {
        peer: Some(("chain", "change FIRST (interpolation guides)", 10.0)),
        ..case("chain of five, first node changed", "c_width", "hair.seed", 100.0)
    },
    Case {
        peer: Some(("chain", "change LAST (profile radius)", 300.0)),
        ..case("chain of five, last node changed", "c_width", "c_width.root", 0.008)
    },
];

/// A head and the same with five partings from front to back, 500 guides of 10 cm, hair between them, and each node on it: alone, on the
/// parted head, and in a chain.
const GRAPH: &str = r#"(
    format: 3,
    title: "Peers",
    seed: 0,
    nodes: {
        "head": (kind: "head"),
        "parted": (kind: "partings", inputs: { "pattern": "straight_back", "count": 4 }, links: { "scalp": "head.scalp" }),
        "guides": (kind: "scatter_guides", inputs: { "count": 500, "length": 10 }, links: { "scalp": "head.scalp" }),
        "hair": (kind: "interpolate", inputs: { "by": "count", "count": 100000, "points": 16 }, links: { "guides": "guides.curves", "scalp": "head.scalp" }),
        "curl": (kind: "shape_list_curl", links: { "curves": "hair.curves" }),
        "clump": (kind: "clump", inputs: { "levels": 1 }, links: { "curves": "hair.curves" }),
        "noise": (kind: "noise", links: { "curves": "hair.curves" }),
        "frizz": (kind: "frizz", links: { "curves": "hair.curves" }),
        "length": (kind: "length", links: { "curves": "hair.curves" }),
        "width": (kind: "set_width", links: { "curves": "hair.curves" }),
        "p_guides": (kind: "scatter_guides", inputs: { "count": 500, "length": 10 }, links: { "scalp": "parted.scalp" }),
        "p_hair": (kind: "interpolate", inputs: { "by": "count", "count": 100000, "points": 16 }, links: { "guides": "p_guides.curves", "scalp": "parted.scalp" }),
        "p_clump": (kind: "clump", inputs: { "levels": 1 }, links: { "curves": "p_hair.curves", "scalp": "parted.scalp" }),
        "p_noise": (kind: "noise", links: { "curves": "p_hair.curves", "scalp": "parted.scalp" }),
        "p_frizz": (kind: "frizz", links: { "curves": "p_hair.curves", "scalp": "parted.scalp" }),
        "p_length": (kind: "length", links: { "curves": "p_hair.curves", "scalp": "parted.scalp" }),
        "locks": (kind: "scatter_guides", inputs: { "count": 50, "length": 40 }, links: { "scalp": "head.scalp" }),
        "braid": (kind: "lissajous_braid", links: { "source": "locks.curves" }),
        "braid_hair": (kind: "cluster_to_strands", inputs: { "count": 100, "points": 64 }, links: { "curves": "braid.curves" }),
        "c_clump": (kind: "clump", links: { "curves": "hair.curves" }),
        "c_curl": (kind: "shape_list_curl", links: { "curves": "c_clump.curves" }),
        "c_noise": (kind: "noise", links: { "curves": "c_curl.curves" }),
        "c_width": (kind: "set_width", links: { "curves": "c_noise.curves" }),
    },
)
"#;

fn main() {
    // `cargo test --benches` only asks whether it starts.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if words.iter().any(|word| word == "--test") {
        return;
    }
    let blender = repository().join("target/venv-blender/bin/python");
    let peer = blender.exists().then(|| shared("peers", "tools/peer_bench.py")).flatten();
    let copy = copied();
    println!("copying a point: {copy:.2} ns; two threads; medians of {RUNS}");
    let mut missed = vec![];
    let asked = |case: &&Case| words.is_empty() || words.iter().any(|w| case.name.contains(w));
    for case in CASES.iter().filter(asked) {
        let Ran { ms, ns, points } = timed(case);
        let mut line = format!(
            "{:<36} {ms:>8.1} ms {points:>9} points {ns:>7.1} ns a point, {:>6.1} x copying",
            case.name,
            ns / copy
        );
        if case.most_ns.is_some_and(|most| ns > most) {
            missed.push(format!("{}: {ns:.0} ns a point", case.name));
        }
        if let (Some((of, label, at_least)), Some(script)) = (case.peer, &peer)
            && let Some((theirs, their_points)) = blenders(&blender, script, of, label)
        {
            let ratio = theirs / their_points * points as f64 / ms;
            line +=
                &format!("; Blender {theirs:.0} ms, {their_points} points: {ratio:.1} x a point");
            if ratio < at_least {
                missed.push(format!("{}: {ratio:.1} x, not {at_least} x", case.name));
            }
        }
        println!("{line}");
    }
    if !missed.is_empty() {
        println!("missed: {}", missed.join("; "));
        std::process::exit(1);
    }
}

/// Copying a point of hair that is too much for the caches, ns.
fn copied() -> f64 {
    let from = vec![[1.0f32; 3]; 100_000 * 16];
    let mut to = from.clone();
    let mut all: Vec<f64> = (0..31)
        .map(|_| {
            let began = Instant::now();
            to.copy_from_slice(std::hint::black_box(&from));
            std::hint::black_box(&mut to);
            began.elapsed().as_secs_f64() * 1e9 / from.len() as f64
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

struct Ran {
    ms: f64,
    /// Processor time, for each point.
    ns: f64,
    points: usize,
}

/// Medians of runs in each of which only what hangs from the turned input is made anew.
fn timed(case: &Case) -> Ran {
    let mut document = file::read(GRAPH).expect("the graph is valid").document;
    let target = Socket::new(case.target.parse().expect("an id"), "curves");
    let evaluator = Evaluator::new(2, 4 << 30).expect("threads");
    let (mut walls, mut costs, mut points) = (vec![], vec![], 0);
    for run in 0..=RUNS {
        turn(&mut document, case, run);
        let plan = plan(
            &document,
            std::slice::from_ref(&target),
            Quality::Final,
            &DiskFiles::new(Path::new("")),
        )
        .expect("a plan");
        let (began, spent) = (Instant::now(), ProcessTime::now());
        let outcome = evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
        let (wall, cost) = (began.elapsed(), spent.elapsed());
        let Some(Some(Value::Curves(curves))) = outcome.targets.first() else {
            panic!("{}: {:?}", case.name, outcome.nodes.iter().find_map(|n| n.error.clone()));
        };
        points = curves.point_count();
        if run > 0 {
            walls.push(wall.as_secs_f64() * 1e3);
            costs.push(cost.as_secs_f64() * 1e9 / points as f64);
        }
    }
    let median = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    Ran { ms: median(walls), ns: median(costs), points }
}

/// Sets the turned input as the run has it.
fn turn(document: &mut Document, case: &Case, run: usize) {
    let socket: Socket = case.turned.parse().expect("NODE.INPUT");
    let node = document.nodes.get_mut(&socket.node).expect("a node");
    let value = match &*socket.name {
        "seed" => Value::Int(case.from as i64 + run as i64),
        _ => {
            let def = coif_nodes::by_id(&node.kind).expect("a kind");
            let (_, input) = def.input(&socket.name).expect("an input");
            let text = format!("{}", case.from * (1.0 + 0.01 * run as f32));
            coif_graphs::text::parse_value(input.ty, &text).expect("a number")
        }
    };
    Arc::make_mut(node).inputs.insert(socket.name.to_string(), Setting::Known(value));
}

/// Blender's median for a line of a case, ms, and how many points came out.
fn blenders(python: &Path, script: &Path, case: &str, label: &str) -> Option<(f64, f64)> {
    let ran = Command::new(python)
        .arg(script)
        .args(["--case", case, "--size", "100000", "--points", "16", "--runs", "3"])
        .output()
        .ok()?;
    let lines = String::from_utf8_lossy(&ran.stdout).into_owned();
    let mut found = lines.lines().filter_map(|line| serde_json::from_str::<Json>(line).ok());
    let line = found.find(|line| line["case"].as_str().is_some_and(|c| c.ends_with(label)));
    line.and_then(|line| Some((line["wall_med_ms"].as_f64()?, line["points"].as_f64()?)))
}
