//! Tests: laws of all gestures, on random gestures, on every available head and animal.

use super::hair_sketch::{self, resolved};
use super::hand::off_line;
use super::laws::{length, points};
use super::seen::Seen;
use crate::data::attributes::{PINNED, RADIUS};
use crate::data::curves::{Curves, Tuft};
use crate::data::gestures::tests::gesture;
use crate::data::gestures::{Gesture, GestureView, Gestures, Layer, PenSample, Tool};
use crate::data::scalp::Scalp;
use crate::data::scalp::tests::shared_ball;
use crate::define::Value;
use crate::eval::{Host, Log, PlainHost, Quality};
use crate::maths::hash::Dice;
use crate::maths::transcendental::sin_cos;
use crate::testing::{Memory, curves_of, head, run, run_on, shared_head};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A gesture as nobody would draw it. One in four names curves of `ids`, and one that does not exist.
fn any(seed: u64, ids: &[u64]) -> Gesture {
    let dice = Dice::new(seed, 0, "gesture");
    let count = 1 + u64::from(dice.below(0, 0, 60));
    let size = dice.range(0, 1, 2.0, 400.0);
    let from = Vec2::new(dice.signed(0, 2), dice.signed(0, 3)) * 300.0;
    let way = Vec2::new(dice.signed(0, 4), dice.signed(0, 5)) * size;
    let tremor = dice.range(0, 6, 0.0, 0.3) * size;
    let turns = dice.signed(0, 7) * 4.0;
    let tools = Tool::ALL.len() as u32;
    let tool = Tool::ALL[dice.below(0, 9, tools) as usize].0;
    // Most random lines close nothing: half of the outlines are ellipses drawn by a trembling hand.
    let ellipse = tool == Tool::Silhouette && dice.below(0, 15, 2) == 0;
    let wide = dice.signed(0, 16);
    let samples = (0..count)
        .map(|k| {
            let t = k as f32 / count as f32;
            let (sin, cos) = sin_cos(std::f32::consts::TAU * turns * t);
            let jitter = Vec2::new(dice.signed(1, k), dice.signed(2, k)) * tremor;
            let round = Vec2::new(cos - 1.0, sin) * size * 0.3;
            if ellipse {
                let (sin, cos) = sin_cos(std::f32::consts::TAU * t);
                let at = from + way * (0.5 - 0.5 * cos) + way.perp() * (wide * sin) + jitter * 0.1;
                return PenSample { at, ..Default::default() };
            }
            PenSample { at: from + way * t + jitter + round, ..Default::default() }
        })
        .collect();
    let (sin, cos) = sin_cos(std::f32::consts::TAU * dice.unit(0, 8));
    let base = gesture(seed + 1, tool);
    let named = |k: u64| match ids.len() as u32 {
        0 => 1,
        most => ids[dice.below(3, k, most) as usize],
    };
    let names = dice.below(0, 14, 4) == 0;
    Gesture {
        layer: Layer::ALL[dice.below(0, 10, 3) as usize].0,
        view: GestureView {
            eye: Vec3::new(sin * 60.0, dice.signed(0, 11) * 40.0, cos * 60.0),
            parallel: seed.is_multiple_of(5),
            half_height: if seed.is_multiple_of(5) { 15.0 } else { 0.25 },
            ..base.view
        },
        samples,
        strength: dice.range(0, 12, 0.0, 3.0),
        size: if seed.is_multiple_of(3) { dice.range(0, 13, 0.0, 200.0) } else { 0.0 },
        curves: if names { (0..4).map(named).chain([1]).collect() } else { vec![] },
        ..base
    }
}

/// Depth of a point inside the head, cm: inside according to both the distance field and the surface, since the former
/// is inexact among folds, and the latter below the open neck of a bust.
pub(super) fn out_of(scalp: &Scalp, p: Vec3) -> f32 {
    let surface = scalp.surface();
    let exact = surface.closest(p).map_or(f32::MAX, |hit| surface.signed_distance(p, &hit));
    exact.max(scalp.skin().distance(p))
}

/// A sketch of random gestures on guides all over a head.
struct Trial<'a> {
    scalp: &'a Arc<Scalp>,
    grown: Curves,
    all: Vec<Gesture>,
}

impl Trial<'_> {
    fn run(&self, host: &dyn Host) -> Curves {
        let set = [
            ("scalp", self.scalp.clone().into()),
            ("curves", self.grown.clone().into()),
            ("gestures", Value::from(Gestures(self.all.clone()))),
        ];
        let out = run_on(&hair_sketch::NODE, &set, host, &Log::default(), Quality::Final);
        curves_of(&out.unwrap()[0]).clone()
    }

    /// The laws of the last gesture.
    fn check(&self, name: &str, before: &Curves, after: &Curves) {
        let gesture = self.all.last().unwrap();
        let tool = gesture.tool;
        let said = format!("{name}, {} {tool:?} {:?}", gesture.id - 1, gesture.layer);
        let (was, is) = (points(before), points(after));
        let pins: BTreeMap<u64, Vec<bool>> = before
            .each()
            .map(|(tuft, i)| {
                let each = 0..tuft.curve(i).len();
                (tuft.id(i), each.map(|k| tuft.view(PINNED).at(i, k) != 0).collect())
            })
            .collect();
        let radii: BTreeMap<u64, Vec<f32>> = after
            .each()
            .map(|(tuft, i)| {
                let each = 0..tuft.curve(i).len();
                (tuft.id(i), each.map(|k| tuft.view(RADIUS).at(i, k)).collect())
            })
            .collect();
        let pushes =
            matches!(tool, Tool::Comb | Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten);
        for (id, cvs) in &is {
            assert!(cvs.iter().all(|p| p.is_finite()), "{said}: {cvs:?}");
            assert!(radii[id].iter().all(|r| r.is_finite() && *r >= 0.0), "{said}: {radii:?}");
            let Some(old) = was.get(id) else {
                let makes = matches!(tool, Tool::Implant | Tool::Scatter | Tool::Silhouette);
                assert!(makes, "{said}: a new curve");
                let deep = cvs.iter().map(|p| out_of(self.scalp, *p)).fold(f32::MAX, f32::min);
                assert!(deep > -2e-3, "{said}: {deep}");
                continue;
            };
            assert_eq!(cvs[0], old[0], "{said}: a root moved");
            let held = pins[id].iter().rposition(|pinned| *pinned);
            if let Some(held) = held.filter(|_| pushes) {
                assert_eq!(cvs[..=held], old[..=held], "{said}: what a pin holds moved");
            }
            for (k, _) in pins[id].iter().enumerate().filter(|(_, pinned)| **pinned) {
                // (Cut off is not moved.)
                let gone = tool == Tool::Cut && !cvs.contains(&old[k]);
                assert!(gone || cvs[k] == old[k], "{said}: a pinned CV moved");
            }
            if pushes && tool != Tool::Straighten {
                let share = length(cvs) / length(old);
                assert!((share - 1.0).abs() < 0.01, "{said}: length times {share}");
            }
            if tool == Tool::Lengthen {
                assert_eq!(cvs[..old.len()], old[..], "{said}: what was there moved");
            }
            // At most as deep as before.
            let skin = self.scalp.skin();
            for (k, p) in cvs.iter().enumerate().skip(1).filter(|(_, p)| !old.contains(p)) {
                let (deep, was) = (out_of(self.scalp, *p), old.get(k).map(|p| skin.distance(*p)));
                let least = was.unwrap_or(0.0).min(0.0) - 2e-3;
                assert!(deep > least, "{said}: CV {k} of {id:x} at {deep}, was at {was:?}");
            }
        }
        self.check_taken(&said, before, after);
    }

    /// The stored result of a gesture reproduces what was drawn.
    fn check_kept(&self, name: &str, host: &dyn Host, before: &Curves, after: &Curves) {
        let gesture = self.all.last().unwrap();
        let kept = resolved(gesture, before, after, self.scalp);
        let set = [
            ("scalp", self.scalp.clone().into()),
            ("curves", before.clone().into()),
            ("gestures", Value::from(Gestures(vec![kept]))),
        ];
        let out = run_on(&hair_sketch::NODE, &set, host, &Log::default(), Quality::Final);
        let again = points(curves_of(&out.unwrap()[0]));
        let drawn = points(after);
        let said = format!("{name}, {} {:?}", gesture.id - 1, gesture.tool);
        assert_eq!(drawn.keys().collect::<Vec<_>>(), again.keys().collect::<Vec<_>>(), "{said}");
        for (id, cvs) in &drawn {
            let off = cvs.iter().zip(&again[id]).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            assert!(cvs.len() == again[id].len() && off < 1e-4, "{said}: {id:x} is {off} off");
        }
    }

    /// Changed curves are those that the gesture names or, if it names none, one curve on the nearest layer, else those
    /// drawn within its reach and not behind the head.
    fn check_taken(&self, said: &str, before: &Curves, after: &Curves) {
        let gesture = self.all.last().unwrap();
        let tufts = |curves: &Curves| -> BTreeMap<u64, crate::maths::hash::Key> {
            curves.each().map(|(tuft, i)| (tuft.id(i), tuft.key())).collect()
        };
        let is = tufts(after);
        let changed: Vec<u64> = tufts(before)
            .into_iter()
            .filter(|(id, key)| is.get(id) != Some(key))
            .map(|(id, _)| id)
            .collect();
        if gesture.tool == Tool::Scatter {
            assert!(changed.is_empty(), "{said}: {changed:x?}");
            let twice = is.len() - tufts(before).len();
            assert_eq!(twice, after.curve_count() - before.curve_count(), "{said}: ids");
            return;
        }
        let discs: BTreeMap<u64, f32> =
            before.each().map(|(tuft, i)| (tuft.id(i), tuft.view(RADIUS).at(i, 0))).collect();
        if matches!(gesture.tool, Tool::Implant | Tool::Silhouette) {
            // Replaced curves, and the new one under its disc.
            let new = points(after).into_iter().find(|(id, _)| !points(before).contains_key(id));
            let root = new.map(|(_, cvs)| cvs[0]);
            for id in &changed {
                let off = root.unwrap().distance(points(before)[id][0]);
                assert!(!is.contains_key(id) && off <= 1.01 * discs[id], "{said}");
            }
            return;
        }
        if !gesture.curves.is_empty() {
            assert!(changed.iter().all(|id| gesture.curves.contains(id)), "{said}: {changed:x?}");
            return;
        }
        let soft = gesture.tool.is_soft() && gesture.size > 0.0;
        if gesture.layer == Layer::Nearest && !soft {
            assert!(changed.len() <= 1, "{said}: {changed:x?}");
        }
        let seen = Seen::new(&gesture.view, self.scalp.frame());
        let line: Vec<Vec2> = gesture.samples.iter().map(|sample| sample.at).collect();
        let middle = line.iter().sum::<Vec2>() / line.len() as f32;
        // A cut is straight, whatever the hand did in between.
        let line =
            if gesture.tool == Tool::Cut { vec![line[0], line[line.len() - 1]] } else { line };
        let was = points(before);
        let widest = |id: &u64| -> f32 {
            let of = |(tuft, i): (&Tuft, usize)| {
                let each = (0..tuft.curve(i).len()).map(|k| tuft.view(RADIUS).at(i, k));
                (tuft.id(i) == *id).then(|| each.fold(0.0, f32::max))
            };
            before.each().find_map(of).unwrap_or_default()
        };
        for id in &changed {
            let cvs = &was[id];
            let off = |p: Vec3| {
                seen.pixel(p).map_or(f32::MAX, |at| off_line(&line, at).min(at.distance(middle)))
            };
            // Between CVs as well; a cluster is a disc of one head unit around its curve, and a circle contains what is
            // inside it.
            let inner = match gesture.tool {
                Tool::Density => line.iter().fold(0.0f32, |r, p| r.max(p.distance(line[0]))),
                _ => 0.0,
            };
            let near = cvs.windows(2).any(|pair| {
                (0..=8).map(|k| pair[0].lerp(pair[1], k as f32 / 8.0)).any(|p| {
                    let cluster = 1.6 * self.scalp.frame().unit().max(widest(id));
                    let wide = cluster / seen.cm_per_pixel(seen.depth(p));
                    off(p) <= inner + wide + gesture.size.max(60.0) + 10.0
                })
            });
            // The nearest curve that a circle on the nearest layer finds may be far away.
            let any = gesture.tool == Tool::Density && gesture.layer == Layer::Nearest;
            assert!(near || any, "{said}: {id:x} lies beside it");
        }
    }
}

/// Laws of `count` random gestures on a head, thirty per sketch.
fn hold(name: &str, scalp: &Arc<Scalp>, count: u64) {
    let set = [("scalp", scalp.clone().into()), ("count", Value::Int(60))];
    let grown = curves_of(&run(crate::by_id("scatter_guides").unwrap(), &set).0[0]).clone();
    assert!(grown.curve_count() > 20, "{name}: {}", grown.curve_count());
    let keys = |curves: &Curves| -> Vec<_> { curves.tufts().iter().map(|t| t.key()).collect() };
    let mut tools = BTreeSet::new();
    for first in (0..count).step_by(30) {
        let mut trial = Trial { scalp, grown: grown.clone(), all: vec![] };
        let mut before = grown.clone();
        let (mut states, mut ids) = (vec![], vec![]);
        let host = Memory::default();
        for seed in first..count.min(first + 30) {
            trial.all.push(any(seed, &ids));
            let after = trial.run(&host);
            trial.check(name, &before, &after);
            let tool = trial.all[trial.all.len() - 1].tool;
            // (A hand redraws one curve; names may refer to four.)
            let one = matches!(tool, Tool::Redraw | Tool::Point)
                && trial.all.last().unwrap().curves.is_empty();
            if one || matches!(tool, Tool::Scatter | Tool::Silhouette) {
                trial.check_kept(name, &host, &before, &after);
            }
            if keys(&before) != keys(&after) {
                tools.insert(trial.all[trial.all.len() - 1].tool);
            }
            states.push(keys(&before));
            ids = after.each().map(|(tuft, i)| tuft.id(i)).collect();
            before = after;
        }
        // Each undo gives the same bits, and so does replaying the rest without a cache.
        while let Some(state) = states.pop() {
            trial.all.pop();
            assert!(keys(&trial.run(&host)) == state, "{name}, {first}: undo");
            if states.len() == 15 {
                assert!(keys(&trial.run(&PlainHost)) == state, "{name}, {first}: from nothing");
            }
        }
    }
    if count >= 1000 {
        // (On a small animal, sixty discs of 1 cm leave no room for a copy.)
        let all = Tool::ALL.iter().map(|(tool, _)| *tool);
        let idle: Vec<Tool> = all.filter(|tool| !tools.contains(tool)).collect();
        assert!(idle.is_empty() || idle == [Tool::Scatter], "{name}: {idle:?} did nothing");
    }
}

/// Every head and animal, with the settings for reading it.
fn heads() -> Vec<(&'static str, Vec<(&'static str, Value)>)> {
    let animal = |scale: f32| {
        let units = [("units", "custom".into()), ("scale", Value::Float(scale))];
        [&units[..], &[("fit", "none".into())]].concat()
    };
    vec![
        ("lps_head/LeePerrySmith.glb", vec![]),
        ("ict_head/generic_neutral_mesh.obj", vec![]),
        ("sintel/sintel.obj", vec![]),
        ("snowden_scan/snowden.obj", vec![]),
        ("reported/head_plain.glb", vec![]),
        ("reported/head_skinned_cm_zup.glb", vec![]),
        ("reported/head_skinned_quantized.glb", vec![]),
        ("reported/head_with_ponytail.glb", vec![]),
        ("rat/street_rat_4k.gltf", animal(100.0)),
        ("spot/spot_triangulated.obj", animal(8.0)),
    ]
}

#[test]
fn random_gestures_keep_roots_lengths_pins_and_hair_out_of_the_head() {
    hold("ball", &shared_ball(), 300);
    hold("built-in", &head(&[]), 150);
}

#[test]
fn random_gestures_keep_their_laws_on_real_heads_and_animals() {
    for (name, set) in heads().into_iter().step_by(2) {
        let test = "random_gestures_keep_their_laws_on_real_heads_and_animals";
        let Some(scalp) = shared_head(test, name, &set) else { continue };
        hold(name, &scalp, 60);
    }
}

/// The heads whose names begin like this, with ten thousand gestures each.
fn long(names: &str) {
    for (name, set) in heads().into_iter().filter(|(name, _)| name.starts_with(names)) {
        let test = "ten_thousand_random_gestures_keep_their_laws";
        let Some(scalp) = shared_head(test, name, &set) else { continue };
        hold(name, &scalp, 10_000);
    }
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_the_built_in_head() {
    hold("ball", &shared_ball(), 10_000);
    hold("built-in", &head(&[]), 10_000);
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_lps() {
    long("lps");
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_ict() {
    long("ict");
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_sintel() {
    long("sintel");
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_the_scan() {
    long("snowden");
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_posed_heads() {
    long("reported");
}

#[test]
#[ignore = "long"]
fn ten_thousand_random_gestures_keep_their_laws_on_animals() {
    long("rat");
    long("spot");
}
