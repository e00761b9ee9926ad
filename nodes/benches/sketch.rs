//! What the pen costs: one more sample of a comb over 150 clusters, and 500 gestures from nothing. Beside each, what the node does with
//! the same curves and no gesture. And a mask of 1,000 dabs: what one more costs, and what 100,000 roots cost that read it.

use coif_nodes::data::curves::Curves;
use coif_nodes::data::field::Field;
use coif_nodes::data::gestures::{Gesture, GestureView, Gestures, Layer, PenSample, Tool};
use coif_nodes::data::strokes::{Brush, Mode, Sample, Stroke, Strokes};
use coif_nodes::define::Value;
use coif_nodes::eval::{EvalCx, Host, Kept, Log, Quality};
use coif_nodes::maths::hash::{Dice, Key, KeyBuilder};
use coif_nodes::maths::transcendental::sin_cos_turns;
use divan::Bencher;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Mutex;

fn main() {
    divan::main();
}

/// A host on one thread that keeps all it is given.
#[derive(Default)]
struct Memory(Mutex<BTreeMap<Key, Kept>>);

impl Host for Memory {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).for_each(f);
    }
    fn find(&self, key: Key) -> Option<Kept> {
        self.0.lock().unwrap().get(&key).cloned()
    }
    fn keep(&self, key: Key, value: Kept, _: usize) {
        self.0.lock().unwrap().insert(key, value);
    }
}

fn run(kind: &str, set: &[(&str, Value)], host: &dyn Host) -> Value {
    run_in(Quality::Final, kind, set, host)
}

fn run_in(quality: Quality, kind: &str, set: &[(&str, Value)], host: &dyn Host) -> Value {
    let node = coif_nodes::by_id(kind).unwrap();
    let mut values: Vec<Vec<Value>> = vec![vec![]; node.inputs.len()];
    for (name, value) in set {
        values[node.input(name).unwrap().0].push(value.clone());
    }
    let log = Log::default();
    // What is wired in is part of a node's key, but for lists.
    let is_list =
        |value: &Value| matches!(value, Value::Curves(_) | Value::Strokes(_) | Value::Gestures(_));
    let wired = set.iter().filter(|(_, value)| !is_list(value));
    let key = wired.fold(KeyBuilder::new(kind), |key, (_, value)| key.key(value.key())).finish();
    let cx = EvalCx::new(0, quality, key, host, &log);
    (node.run)(&cx, &values).unwrap().remove(0)
}

/// A gesture across the front of the head, from a random place.
fn gesture(id: u64, tool: Tool, samples: u64) -> Gesture {
    let dice = Dice::new(id, 0, "bench");
    let from = Vec2::new(dice.signed(0, 0), dice.signed(0, 1)) * 200.0;
    let way = Vec2::new(dice.signed(0, 2), dice.signed(0, 3)) * 300.0;
    let at = |k: u64| PenSample { at: from + way * (k as f32 / 60.0), ..Default::default() };
    Gesture {
        id,
        tool,
        layer: if tool == Tool::Implant { Layer::Scalp } else { Layer::Through },
        view: GestureView {
            eye: Vec3::new(0.0, 10.0, 60.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            half_height: 0.25,
            parallel: false,
            pixels: 1000.0,
        },
        samples: (0..samples).map(at).collect(),
        curves: vec![],
        root: None,
        path: vec![],
        colour: None,
        size: 0.0,
        strength: 1.0,
    }
}

fn start(host: &Memory) -> Vec<(&'static str, Value)> {
    let scalp = run("head", &[], host);
    let set = [("scalp", scalp.clone()), ("count", Value::Int(150))];
    let guides = run("scatter_guides", &set, host);
    vec![("scalp", scalp), ("curves", guides)]
}

fn sketch(host: &Memory, set: &[(&'static str, Value)], gestures: &[Gesture]) -> Curves {
    let gestures = Value::from(Gestures(gestures.to_vec()));
    match run("hair_sketch", &[set, &[("gestures", gestures)]].concat(), host) {
        Value::Curves(curves) => curves,
        _ => panic!(),
    }
}

/// Each time the comb has gone on by a sample: all of it is replayed on the state before.
#[divan::bench]
fn a_sample_of_a_comb_over_150_clusters(bencher: Bencher) {
    let host = Memory::default();
    let set = start(&host);
    sketch(&host, &set, &[]);
    let mut samples = 60u64;
    bencher.bench_local(|| {
        samples += 1;
        sketch(&host, &set, &[gesture(5, Tool::Comb, samples)])
    });
}

#[divan::bench]
fn b_the_500th_gesture(bencher: Bencher) {
    let host = Memory::default();
    let set = start(&host);
    let mut all = five_hundred();
    sketch(&host, &set, &all);
    let mut id = 1000;
    bencher.bench_local(|| {
        id += 1;
        all[499] = gesture(id, Tool::Comb, 60);
        sketch(&host, &set, &all)
    });
}

#[divan::bench(sample_count = 5)]
fn c_500_gestures_from_nothing(bencher: Bencher) {
    let host = Memory::default();
    let set = start(&host);
    let all = five_hundred();
    bencher.bench_local(|| sketch(&Memory::default(), &set, &all));
}

#[divan::bench]
fn d_no_gesture(bencher: Bencher) {
    let host = Memory::default();
    let set = start(&host);
    bencher.bench_local(|| sketch(&Memory::default(), &set, &[]));
}

fn five_hundred() -> Vec<Gesture> {
    let tools = [Tool::Comb, Tool::Implant, Tool::Puff, Tool::Smooth, Tool::Comb, Tool::Grab];
    (0..500).map(|i| gesture(i + 1, tools[i as usize % tools.len()], 60)).collect()
}

/// 40 strokes of 25 dabs over the upper head, each fifth of which erases.
fn thousand_dabs(smooth: bool) -> Strokes {
    let stroke = |id: u64| {
        let dice = Dice::new(id, 0, "dabs");
        let mut way = Vec3::new(dice.signed(0, 0), 0.3 + dice.unit(0, 1), dice.signed(0, 2));
        let sample = |k: u64| {
            way += Vec3::new(dice.signed(k, 3), 0.0, dice.signed(k, 4)) * 0.06;
            Sample { position: way.normalize() * 9.5, pressure: 0.8, ..Sample::default() }
        };
        let samples = (0..25).map(sample).collect();
        let mode = match id % 5 {
            4 => Mode::Erase,
            3 if smooth => Mode::Smooth,
            _ => Mode::Paint,
        };
        let brush = Brush { mode, radius: dice.range(0, 5, 0.4, 1.2), ..Brush::default() };
        Stroke { brush: Some(brush), ..Stroke::new(id, samples) }
    };
    Strokes((1..=40).map(stroke).collect())
}

/// One more dab: the whole mask of 1,000 is made anew.
#[divan::bench(args = [false, true])]
fn e_the_1000th_dab(bencher: Bencher, smooth: bool) {
    let host = Memory::default();
    let scalp = run("head", &[], &host);
    let mut strokes = thousand_dabs(smooth);
    let mut more = 0;
    bencher.bench_local(|| {
        more += 1;
        strokes.0[39].id = 1000 + more;
        let set = [("scalp", scalp.clone()), ("strokes", strokes.clone().into())];
        run("paint_mask", &set, &host)
    });
}

/// On one thread; hair is made on all of them.
#[divan::bench(args = [false, true])]
fn f_100_000_roots_read_1000_dabs(bencher: Bencher, smooth: bool) {
    let host = Memory::default();
    let scalp = run("head", &[], &host);
    let roots =
        [("scalp", scalp.clone()), ("count", Value::Int(100_000)), ("points", Value::Int(2))];
    let Value::Curves(hair) = run("scatter_guides", &roots, &host) else { panic!() };
    let set = [("scalp", scalp.clone()), ("strokes", thousand_dabs(smooth).into())];
    let Value::Field(mask) = run("paint_mask", &set, &host) else { panic!() };
    assert!(matches!(*mask, Field::Painted(_)) && hair.curve_count() > 90_000);
    let Value::Scalp(scalp) = scalp else { panic!() };
    bencher.bench_local(|| {
        for tuft in hair.tufts() {
            divan::black_box(mask.on(tuft, Some(&scalp), (0.0, 1.0)).unwrap());
        }
    });
}

/// Guides and 20,000 hairs whose length and number one more dab changes, as a preview is made of them.
#[divan::bench]
fn g_hair_follows_the_1000th_dab(bencher: Bencher) {
    let host = Memory::default();
    let scalp = run("head", &[], &host);
    let mut strokes = thousand_dabs(true);
    let mut more = 0;
    bencher.bench_local(|| {
        more += 1;
        strokes.0[39].id = 1000 + more;
        let preview = |kind: &str, set: &[(&str, Value)]| {
            let set = [&[("scalp", scalp.clone())], set].concat();
            run_in(Quality::Preview, kind, &set, &host)
        };
        let mask = preview("paint_mask", &[("strokes", strokes.clone().into())]);
        let guides = preview("scatter_guides", &[("length", mask.clone())]);
        let count = [("by", "count".into()), ("count", Value::Int(20_000))];
        preview("interpolate", &[&count[..], &[("guides", guides), ("mask", mask)]].concat())
    });
}

/// Closed strokes over the upper head, each of 60 samples, 1 to 4 cm wide.
fn closed(count: u64) -> Strokes {
    let stroke = |id: u64| {
        let dice = Dice::new(id, 0, "closed");
        let middle = Vec3::new(dice.signed(0, 0), 0.3 + dice.unit(0, 1), dice.signed(0, 2));
        let middle = middle.normalize();
        let right = middle.any_orthonormal_vector();
        let (up, wide) = (middle.cross(right), dice.range(0, 3, 0.5, 2.0));
        let sample = |k: u64| {
            let (sin, cos) = sin_cos_turns(k as f32 / 60.0);
            let position = middle * 9.5 + (right * cos + up * sin) * wide;
            Sample { position, pressure: 1.0, ..Sample::default() }
        };
        let brush = Brush { closed: true, ..Brush::default() };
        Stroke { brush: Some(brush), ..Stroke::new(id, (0..60).map(sample).collect()) }
    };
    Strokes((1..=count).map(stroke).collect())
}

/// A mask of closed strokes while the last of them is drawn.
#[divan::bench(args = [1, 200])]
fn h_a_sample_of_the_last_closed_stroke(bencher: Bencher, count: u64) {
    let host = Memory::default();
    let scalp = run("head", &[], &host);
    let mut strokes = closed(count);
    let mut more = 0.0;
    let mut made = || {
        more += 1e-3;
        strokes.0[count as usize - 1].samples[0].position.x += more;
        let set = [("scalp", scalp.clone()), ("strokes", strokes.clone().into())];
        run("paint_mask", &set, &host)
    };
    made();
    bencher.bench_local(made);
}

/// The same made of nothing but the head.
#[divan::bench(args = [1, 200])]
fn i_closed_strokes_from_nothing(bencher: Bencher, count: u64) {
    let host = Memory::default();
    let scalp = run("head", &[], &host);
    let set = [("scalp", scalp), ("strokes", closed(count).into())];
    run("paint_mask", &set, &Memory::default());
    bencher.bench_local(|| run("paint_mask", &set, &Memory::default()));
}

/// On one thread.
#[divan::bench(args = [1, 200])]
fn j_100_000_roots_read_closed_strokes(bencher: Bencher, count: u64) {
    let host = Memory::default();
    let scalp = run("head", &[], &host);
    let roots =
        [("scalp", scalp.clone()), ("count", Value::Int(100_000)), ("points", Value::Int(2))];
    let Value::Curves(hair) = run("scatter_guides", &roots, &host) else { panic!() };
    let set = [("scalp", scalp.clone()), ("strokes", closed(count).into())];
    let Value::Field(mask) = run("paint_mask", &set, &host) else { panic!() };
    let Value::Scalp(scalp) = scalp else { panic!() };
    bencher.bench_local(|| {
        for tuft in hair.tufts() {
            divan::black_box(mask.on(tuft, Some(&scalp), (0.0, 1.0)).unwrap());
        }
    });
}
