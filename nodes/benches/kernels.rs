//! The busiest kernels at 10,000 and 100,000 strands of 16 points, each beside a memset of as many bytes into freshly
//! allocated memory: what is quoted is the ratio of the two in one run. At the end, each node that runs in lanes is held to a limit.

use coif_nodes::data::attributes::{DENSITY, Domain, FRIZZ, ID, RADIUS};
use coif_nodes::data::curves::{Curves, TuftBuilder};
use coif_nodes::data::scalp::{HeadFrame, REGION, Scalp};
use coif_nodes::define::Value;
use coif_nodes::eval::{EvalCx, Host, Kept, Log, Quality};
use coif_nodes::maths::closest::Surface;
use coif_nodes::maths::distance_field::{Depth, DistanceField};
use coif_nodes::maths::hash::{Dice, Key, KeyBuilder};
use coif_nodes::maths::lanes::use_single_numbers;
use coif_nodes::maths::low_discrepancy::r2;
use coif_nodes::maths::transcendental::sin_cos_turns;
use divan::{Bencher, black_box};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, OnceLock};

const STRANDS: [usize; 2] = [10_000, 100_000];
const POINTS: usize = 16;
const CLUSTERS: usize = 150;

fn main() {
    // `cargo test --benches` only asks whether it starts; words select benches, and `lanes` the limits of nodes in lanes.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if words != ["lanes"] {
        divan::main();
    }
    if words.is_empty() || words == ["lanes"] {
        lanes();
    }
}

/// Nodes whose kernels run in lanes, and the longest that they may take for a point, in copies of a point. A closure that silently loses
/// its lanes takes two to five times as long.
const IN_LANES: &[(&str, &[(&str, &str)], f64)] = &[
    ("noise", &[], 70.0),
    ("noise", &[("together", "hair")], 55.0),
    ("frizz", &[], 75.0),
    ("clump", &[], 140.0),
    ("stray", &[], 65.0),
    ("set_width", &[], 12.0),
];
/// The same for a question of the distance field that finds a cell to be sampled, more often than not.
const FIELD: f64 = 4200.0;

/// Times each node and the distance field on one thread, with single numbers and in the widest lanes in turn. Exits with 1 where one
/// takes too long.
fn lanes() {
    let curves = strands(20_000);
    let least = |of: &mut dyn FnMut() -> usize| {
        let began = std::time::Instant::now();
        let points = of();
        began.elapsed().as_secs_f64() * 1e9 / points as f64
    };
    let from: Vec<Vec3> = curves.tufts().iter().flat_map(|t| t.points().to_vec()).collect();
    let mut to = from.clone();
    let mut copy = f64::INFINITY;
    for _ in 0..31 {
        copy = copy.min(least(&mut || {
            black_box(&mut to).copy_from_slice(black_box(&from));
            from.len()
        }));
    }
    println!("copying a point: {copy:.2} ns");
    let mut slow = vec![];
    let mut hold = |name: String, most: f64, of: &mut dyn FnMut() -> usize| {
        let mut ns = [f64::INFINITY; 2];
        for _ in 0..7 {
            for (single, ns) in [true, false].into_iter().zip(&mut ns) {
                use_single_numbers(single);
                *ns = ns.min(least(of));
            }
        }
        let [one, eight] = ns;
        let copies = eight / copy;
        println!("{name}: {one:.0} ns a point, in lanes {eight:.0}, {copies:.0} x copying");
        if copies > most {
            slow.push(name);
        }
    };
    for (kind, words, most) in IN_LANES {
        let mut set: Vec<(&str, Value)> = vec![("curves", curves.clone().into())];
        set.extend(words.iter().map(|(name, word)| (*name, Value::from(*word))));
        if *kind == "stray" {
            set.push(("share", Value::Float(1.0)));
        }
        hold(format!("{kind} {words:?}"), *most, &mut || {
            black_box(run(kind, &set, &Alone)).point_count()
        });
    }
    let (surface, asked) = over_a_head();
    hold("cells of the distance field".to_owned(), FIELD, &mut || {
        let field = DistanceField::new(&surface);
        asked.iter().for_each(|p| _ = black_box(field.depth(&surface, *p)));
        asked.len()
    });
    if !slow.is_empty() {
        println!("over the limit: {}", slow.join(", "));
        std::process::exit(1);
    }
}

/// A host with one thread and no memory.
struct Alone;

impl Host for Alone {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).for_each(f);
    }
}

/// A host with rayon's threads and no memory.
#[derive(Default)]
struct Pool;

impl Host for Pool {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).into_par_iter().with_max_len(1).for_each(f);
    }
}

/// A [`Pool`] that remembers the first thing it is given and forgets all others: of a node that plans first, the plan.
#[derive(Default)]
struct Plans {
    first: Mutex<Option<(Key, Kept)>>,
}

impl Host for Plans {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        Pool.for_each(n, f);
    }
    fn find(&self, key: Key) -> Option<Kept> {
        let first = self.first.lock().unwrap();
        first.as_ref().filter(|(known, _)| *known == key).map(|(_, kept)| kept.clone())
    }
    fn keep(&self, key: Key, value: Kept, _: usize) {
        self.first.lock().unwrap().get_or_insert((key, value));
    }
}

fn run(kind: &str, set: &[(&str, Value)], host: &dyn Host) -> Curves {
    let node = coif_nodes::by_id(kind).expect("a node of this kind");
    let mut values: Vec<Vec<Value>> = vec![vec![]; node.inputs.len()];
    let mut key = KeyBuilder::new(kind);
    for (name, value) in set {
        let (at, _) = node.input(name).expect("an input of this name");
        if !matches!(value, Value::Curves(_)) {
            key = key.text(name).key(value.key());
        }
        values[at].push(value.clone());
    }
    let (log, quality) = (Log::default(), Quality::Final);
    let cx = EvalCx::new(0, quality, key.finish(), host, &log);
    match (node.run)(&cx, &values).expect("a result").swap_remove(0) {
        Value::Curves(curves) => curves,
        other => panic!("a {}", other.type_name()),
    }
}

/// A ball of a head's size with bumps of a centimetre and 25,000 triangles.
fn head() -> Arc<Scalp> {
    static HEAD: OnceLock<Arc<Scalp>> = OnceLock::new();
    HEAD.get_or_init(|| {
        let surface = bumpy_ball(112);
        let region = surface.points.iter().map(|p| f32::from(p.y > 0.0)).collect();
        let scalp =
            Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), region)].into());
        scalp.skin();
        Arc::new(scalp)
    })
    .clone()
}

fn bumpy_ball(rows: u32) -> Surface {
    let columns = rows;
    let place = |row: u32, column: u32| {
        let (sr, cr) = sin_cos_turns(row as f32 / (2 * rows) as f32);
        let (s, c) = sin_cos_turns(column as f32 / columns as f32);
        let n = Vec3::new(sr * s, cr, sr * c);
        let bump = sin_cos_turns(0.6 * n.x + 0.2).0 * sin_cos_turns(0.5 * n.y - 0.1).1;
        n * (8.9 + 0.8 * bump)
    };
    let mut points = vec![place(0, 0)];
    for row in 1..rows {
        points.extend((0..columns).map(|column| place(row, column)));
    }
    points.push(place(rows, 0));
    let last = points.len() as u32 - 1;
    let at = |row: u32, column: u32| match row {
        0 => 0,
        r if r == rows => last,
        r => 1 + (r - 1) * columns + column % columns,
    };
    let mut triangles = vec![];
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            if row > 0 {
                triangles.push([a, c, b]);
            }
            if row + 1 < rows {
                triangles.push([b, c, d]);
            }
        }
    }
    Surface::new(points, triangles)
}

/// Evenly spread points of the upper half of the head.
fn roots(n: usize) -> Vec<Vec3> {
    let scalp = head();
    (0..n as u32)
        .map(|i| {
            let [a, b] = r2(i, [0.5, 0.5]);
            let (s, c) = sin_cos_turns(a);
            let flat = (1.0 - b * b).max(0.0).sqrt();
            let p = Vec3::new(flat * s, b, flat * c) * 9.0;
            scalp.closest_root(p).expect("a root").point
        })
        .collect()
}

/// Curves of 20 cm that leave at 50 degrees from the skin and fall.
fn falling(n: usize) -> Curves {
    let tufts = roots(n).into_iter().enumerate().map(|(i, root)| {
        let out = root.normalize();
        let mut direction = (out + Vec3::new(out.x, 0.0, out.z).normalize_or(Vec3::X)).normalize();
        let mut p = root;
        let points: Vec<Vec3> = (0..11)
            .map(|k| {
                if k > 0 {
                    p += direction * 2.0;
                    direction = (direction + Vec3::NEG_Y * 0.35).normalize();
                }
                p
            })
            .collect();
        let mut b = TuftBuilder::new();
        b.push_curve(&points);
        b.set(ID, Domain::Curve, vec![i as u64 + 1]);
        b.set(RADIUS, Domain::Curve, vec![1.0]);
        b.set(DENSITY, Domain::Curve, vec![1.0]);
        b.set(FRIZZ, Domain::Curve, vec![0.5]);
        Arc::new(b.build())
    });
    Curves::new(tufts.collect())
}

fn strands(n: usize) -> Curves {
    run("cluster_to_strands", &clusters(n), &Pool)
}

fn clusters(n: usize) -> Vec<(&'static str, Value)> {
    vec![
        ("curves", falling(CLUSTERS).into()),
        ("scalp", head().into()),
        ("count", Value::Int((n / CLUSTERS) as i64)),
        ("points", Value::Int(POINTS as i64)),
    ]
}

/// 500 guides and as many hairs as asked for between them.
fn guides(n: usize) -> Vec<(&'static str, Value)> {
    vec![
        ("guides", falling(500).into()),
        ("scalp", head().into()),
        ("by", "count".into()),
        ("count", Value::Int(n as i64)),
        ("points", Value::Int(POINTS as i64)),
    ]
}

fn bytes(strands: usize) -> usize {
    strands * POINTS * size_of::<Vec3>()
}

#[divan::bench(args = STRANDS, sample_count = 20)]
fn a_memset_of_their_points(bencher: Bencher, n: usize) {
    // What is given back is handed out again already mapped: nothing is given back.
    bencher.bench(|| std::mem::forget(black_box(vec![black_box(1u8); bytes(n)])));
}

#[divan::bench(args = STRANDS, sample_count = 20)]
fn b_cluster_to_strands(bencher: Bencher, n: usize) {
    let (set, host) = (clusters(n), Pool);
    bencher.bench(|| run("cluster_to_strands", &set, &host));
}

/// Clusters that lie on the head, so that four points of ten have to be pushed out of it.
#[divan::bench(args = STRANDS, sample_count = 10)]
fn b_cluster_to_strands_lying(bencher: Bencher, n: usize) {
    let lying = [
        ("scalp", head().into()),
        ("count", Value::Int(CLUSTERS as i64)),
        ("lie", Value::Float(5.0)),
        ("length", Value::Float(8.0)),
    ];
    let mut set = clusters(n);
    set[0].1 = run("scatter_guides", &lying, &Pool).into();
    bencher.bench(|| run("cluster_to_strands", &set, &Pool));
}

#[divan::bench(args = STRANDS, sample_count = 20)]
fn c_root_projections(bencher: Bencher, n: usize) {
    let scalp = head();
    let dice = Dice::new(0, 0, "roots");
    let at = falling(CLUSTERS);
    let asked: Vec<Vec3> = (0..n as u64)
        .map(|i| {
            let root = at.tufts()[i as usize * CLUSTERS / n].points()[0];
            let d = Vec3::new(dice.signed(i, 0), dice.signed(i, 1), dice.signed(i, 2));
            root + d.reject_from(root.normalize())
        })
        .collect();
    bencher.bench(|| {
        let skin = scalp.skin();
        asked
            .par_chunks(512)
            .map(|c| c.iter().filter_map(|p| skin.closest(*p)).count())
            .sum::<usize>()
    });
}

#[divan::bench(args = STRANDS, sample_count = 20)]
fn e_resample(bencher: Bencher, n: usize) {
    let (curves, host) = (strands(n), Pool);
    bencher.bench(|| run("resample", &[("curves", curves.clone().into())], &host));
}

/// Roots placed and guides found: what the first evaluation does and later ones remember.
#[divan::bench(args = STRANDS, sample_count = 10)]
fn d_interpolate_from_nothing(bencher: Bencher, n: usize) {
    bencher.bench(|| run("interpolate", &guides(n), &Pool));
}

#[divan::bench(args = STRANDS, sample_count = 20)]
fn d_interpolate_with_roots_remembered(bencher: Bencher, n: usize) {
    let (set, host) = (guides(n), Plans::default());
    bencher.bench(|| run("interpolate", &set, &host));
}

#[divan::bench(args = STRANDS, sample_count = 20)]
fn f_set_width(bencher: Bencher, n: usize) {
    let (curves, host) = (strands(n), Pool);
    bencher.bench(|| run("set_width", &[("curves", curves.clone().into())], &host));
}

/// Fill, taper, colour, resample, one after the other.
#[divan::bench(args = STRANDS, sample_count = 10)]
fn g_chain(bencher: Bencher, n: usize) {
    let (set, host) = (clusters(n), Pool);
    bencher.bench(|| {
        ["set_width", "set_colour", "resample"]
            .iter()
            .fold(run("cluster_to_strands", &set, &host), |curves, kind| {
                run(kind, &[("curves", curves.into())], &host)
            })
    });
}

/// A head of 25,000 triangles, and places all over its upper half, up to 1 cm over the skin.
fn over_a_head() -> (Surface, Vec<Vec3>) {
    let surface = bumpy_ball(112);
    let dice = Dice::new(0, 0, "field");
    let at = |i: u64| {
        let p = surface.points[dice.below(i, 0, surface.points.len() as u32) as usize];
        Vec3::new(p.x, p.y.abs(), p.z) * (1.0 + dice.unit(i, 1) / 9.0)
    };
    let asked = (0..40_000).map(at).collect();
    (surface, asked)
}

/// What a full head of hair needs of the field.
#[divan::bench(sample_count = 5)]
fn h_distance_field_of_25_000_triangles(bencher: Bencher) {
    let (surface, asked) = over_a_head();
    bencher.bench(|| {
        let field = DistanceField::new(&surface);
        let near = |p: &Vec3| matches!(field.depth(&surface, *p), Depth::Near(..));
        asked.par_chunks(512).map(|c| c.iter().filter(|p| near(p)).count()).sum::<usize>()
    });
}

/// 50 braids of three strands, free and as cornrows on the head.
#[divan::bench(args = ["free", "cornrow"], sample_count = 20)]
fn i_braids_of_50_guides(bencher: Bencher, how: &str) {
    let mut set: Vec<(&str, Value)> = vec![("source", falling(50).into())];
    if how == "cornrow" {
        set.push(("scalp", head().into()));
    }
    bencher.bench(|| run("lissajous_braid", &set, &Pool));
}

#[divan::bench(args = STRANDS, sample_count = 10)]
fn j_curl_to_about_60_points(bencher: Bencher, n: usize) {
    let set = [("curves", strands(n).into()), ("preset", Value::from("3b"))];
    bencher.bench(|| run("shape_list_curl", &set, &Pool));
}

/// Six passes over clumped clusters: of their tips each has a dozen others nearer than they are thick.
#[divan::bench(args = STRANDS, sample_count = 5)]
fn k_separation_of_clumps(bencher: Bencher, n: usize) {
    let filled = run("cluster_to_strands", &clusters(n), &Pool);
    let clump = [
        ("curves", filled.into()),
        ("centres", falling(CLUSTERS).into()),
        ("attribute", "parent".into()),
        ("levels", Value::Int(1)),
    ];
    let set = [("curves", run("clump", &clump, &Pool).into())];
    bencher.bench(|| run("separation", &set, &Pool));
}
