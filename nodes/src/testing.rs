//! How tests of single nodes call them: the only place that knows.

use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::outline::for_middles;
use crate::data::scalp::Scalp;
use crate::data::strokes::{Sample, Stroke};
use crate::define::{FileData, NodeDef, NodeError, Value};
use crate::eval::{EvalCx, Host, Kept, Log, Message, PlainHost, Quality, Room};
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// A host without threads that forgets nothing, for tests of what ran.
#[derive(Default)]
pub(crate) struct Memory(Mutex<BTreeMap<Key, Kept>>);

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

/// A host that runs pieces on threads of its own, the last first.
pub(crate) struct Threads(pub usize);

impl Host for Threads {
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        std::thread::scope(|scope| {
            for thread in 0..self.0 {
                scope.spawn(move || (0..n).rev().skip(thread).step_by(self.0).for_each(f));
            }
        });
    }
}

/// A host that lends so much room.
pub(crate) struct Lends(pub Room);

impl Host for Lends {
    fn room(&self) -> Room {
        self.0
    }
    fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
        PlainHost.for_each(n, f);
    }
}

/// Runs a node; unset inputs have their defaults. Gives outputs and messages.
#[track_caller]
pub(crate) fn run(node: &NodeDef, set: &[(&str, Value)]) -> (Vec<Value>, Vec<String>) {
    let log = Log::default();
    let out = run_on(node, set, &PlainHost, &log, Quality::Final);
    let said = log.messages().iter().map(Message::with_id).collect();
    (out.unwrap_or_else(|err| panic!("{}: {err}", node.id)), said)
}

/// Runs a node that must fail; gives the error's text.
#[track_caller]
pub(crate) fn fails(node: &NodeDef, set: &[(&str, Value)]) -> String {
    let log = Log::default();
    match run_on(node, set, &PlainHost, &log, Quality::Final) {
        Ok(_) => panic!("{} ran", node.id),
        Err(err) => err.to_string(),
    }
}

/// Runs a node on a host of the caller's.
#[track_caller]
pub(crate) fn run_on(
    node: &NodeDef,
    set: &[(&str, Value)],
    host: &dyn Host,
    log: &Log,
    quality: Quality,
) -> Result<Vec<Value>, NodeError> {
    let mut values: Vec<Vec<Value>> = vec![vec![]; node.inputs.len()];
    let mut key = KeyBuilder::new(node.id);
    for (name, value) in set {
        let (at, _) = node.input(name).unwrap_or_else(|| panic!("{} has no {name}", node.id));
        if !matches!(value, Value::Curves(_) | Value::Strokes(_) | Value::Gestures(_)) {
            key = key.text(name).key(value.key());
        }
        values[at].push(value.clone());
    }
    let cx = EvalCx::new(0, quality, key.finish(), host, log);
    (node.run)(&cx, &values)
}

/// A tuft whose points are as `change` leaves them: other hair, as other programs hand it in.
pub(crate) fn with_points(tuft: &Tuft, change: impl FnOnce(&mut [Vec3])) -> Tuft {
    let mut points = tuft.points().to_vec();
    change(&mut points);
    let mut b = TuftBuilder::new();
    (0..tuft.len()).for_each(|i| b.push_curve(&points[tuft.range(i)]));
    tuft.attributes().iter().for_each(|attribute| b.set_column(attribute.clone()));
    b.build()
}

/// A file of the shared data with those beside it that it names; none when it is not on this machine.
pub(crate) fn shared_file(name: &str) -> Option<Arc<FileData>> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/");
    let bytes: Arc<[u8]> = std::fs::read(format!("{root}{name}")).ok()?.into();
    let (folder, _) = name.split_once('/')?;
    let extension = name.rsplit('.').next()?.to_owned();
    let sides = crate::formats::mesh_in::side_files(&extension, &bytes)
        .into_iter()
        .filter_map(|side| {
            let bytes = std::fs::read(format!("{root}{folder}/{side}")).ok()?;
            Some((side, bytes.into()))
        })
        .collect();
    Some(Arc::new(FileData { path: name.to_owned(), extension, bytes, sides }))
}

/// The head of a file of the shared data; none, and said so, when it is not on this machine.
#[track_caller]
pub(crate) fn shared_head(test: &str, name: &str, set: &[(&str, Value)]) -> Option<Arc<Scalp>> {
    let Some(file) = shared_file(name) else {
        println!("skipped: {test} needs ../shared/data/{name}");
        return None;
    };
    Some(head(&[&[("mesh", Value::File(file))], set].concat()))
}

/// What the head node gives; the built-in head where nothing is set.
#[track_caller]
pub(crate) fn head(set: &[(&str, Value)]) -> Arc<Scalp> {
    match &run(crate::by_id("head").expect("a head"), set).0[0] {
        Value::Scalp(scalp) => scalp.clone(),
        other => panic!("a {}", other.type_name()),
    }
}

/// The curves of a value.
#[track_caller]
pub(crate) fn curves_of(value: &Value) -> &Curves {
    match value {
        Value::Curves(curves) => curves,
        other => panic!("a {}", other.type_name()),
    }
}

/// The closed line of all skin that is `radius` (cm) from `centre`, in head units.
pub(crate) fn round(scalp: &Scalp, id: u64, centre: Vec3, radius: f32) -> Stroke {
    let middle = scalp.closest_root(centre).unwrap();
    let right = middle.normal.any_orthonormal_vector();
    let up = middle.normal.cross(right);
    let on_skin = |p| scalp.closest_root(p).unwrap().point;
    let sample = |k: u32| {
        let (s, c) = sin_cos_turns(k as f32 / 96.0);
        let (mut near, mut far) = (0.0, 2.0 * radius);
        for _ in 0..30 {
            let t = 0.5 * (near + far);
            let p = on_skin(middle.point + (right * c + up * s) * t);
            if p.distance(middle.point) < radius { near = t } else { far = t }
        }
        let p = on_skin(middle.point + (right * c + up * s) * near);
        let position = scalp.frame().head_from_point(p);
        Sample { position, pressure: 1.0, ..Sample::default() }
    };
    Stroke::new(id, (0..96).map(sample).collect())
}

/// How much skin is nearer to `centre` than `radius`, cm2.
pub(crate) fn area_within(scalp: &Scalp, centre: Vec3, radius: f32) -> f32 {
    let middle = scalp.closest_root(centre).unwrap();
    let surface = scalp.surface();
    let mut sum = 0.0f64;
    for t in 0..surface.triangles.len() as u32 {
        let area = 0.5 * f64::from(surface.area_vector(t).length());
        let [a, b, c] = surface.corners(t);
        let far = [a, b, c].map(|p| p.distance(middle.point));
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        // A ball holds all of a triangle whose corners it holds.
        if far.iter().all(|far| *far < radius) {
            sum += area;
            continue;
        }
        if far.iter().all(|far| *far > radius + longest) {
            continue;
        }
        let part = area / 1600.0;
        for_middles(40, |bary| {
            sum += part * f64::from(u8::from(surface.at(t, bary).distance(middle.point) < radius));
        });
    }
    sum as f32
}
