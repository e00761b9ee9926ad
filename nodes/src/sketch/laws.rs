//! Tests: the effect of each gesture of the paper, in numbers; what a sketch keeps and what it recomputes.

use super::hair_sketch::{self, resolved};
use super::{density, frizz, twist};
use crate::data::attributes::{DENSITY, FRIZZ, PINNED, RADIUS, ROLL};
use crate::data::curves::Curves;
use crate::data::gestures::tests::gesture;
use crate::data::gestures::{Gesture, Gestures, Layer, PenSample, Tool};
use crate::data::scalp::Scalp;
use crate::data::scalp::tests::shared_ball;
use crate::define::Value;
use crate::eval::{Log, Quality};
use crate::maths::transcendental::sin_cos;
use crate::testing::{Memory, curves_of, run, run_on};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// A gesture from the front, where a pixel covers 0.03 cm at the centre of the ball.
pub(super) fn drawn(tool: Tool, layer: Layer, line: &[Vec2]) -> Gesture {
    let sample = |(i, at): (usize, &Vec2)| PenSample {
        at: *at,
        pressure: 0.5,
        time: 0.01 * i as f32,
        ..Default::default()
    };
    let samples: Vec<PenSample> = line.iter().enumerate().map(sample).collect();
    let id = 1 + samples.len() as u64 + (tool as u64) * 1000 + line[0].x.to_bits() as u64;
    let size = if tool == Tool::Comb { 30.0 } else { 0.0 };
    Gesture { layer, samples, size, ..gesture(id, tool) }
}

pub(super) fn line(from: [f32; 2], to: [f32; 2]) -> Vec<Vec2> {
    let (a, b) = (Vec2::from(from), Vec2::from(to));
    (0..=40).map(|k| a.lerp(b, k as f32 / 40.0)).collect()
}

/// Turns of a circle, clockwise for positive ones.
pub(super) fn circle(middle: [f32; 2], radius: f32, turns: f32) -> Vec<Vec2> {
    let count = (64.0 * turns.abs()) as usize;
    let at = |k: usize| {
        let (sin, cos) = sin_cos(std::f32::consts::TAU * turns * k as f32 / count as f32);
        Vec2::from(middle) + Vec2::new(cos, sin) * radius
    };
    (0..=count).map(at).collect()
}

/// The node's result for these gestures, and its messages.
pub(super) fn sketch_on(
    scalp: &Arc<Scalp>,
    curves: Option<&Curves>,
    gestures: &[Gesture],
) -> (Curves, Vec<String>) {
    let gestures = Value::from(Gestures(gestures.to_vec()));
    let mut set = vec![("scalp", scalp.clone().into()), ("gestures", gestures)];
    set.extend(curves.map(|curves| ("curves", curves.clone().into())));
    let (out, said) = run(&hair_sketch::NODE, &set);
    (curves_of(&out[0]).clone(), said)
}

fn sketch(curves: Option<&Curves>, gestures: &[Gesture]) -> (Curves, Vec<String>) {
    sketch_on(&shared_ball(), curves, gestures)
}

/// All CVs by id.
pub(super) fn points(curves: &Curves) -> BTreeMap<u64, Vec<Vec3>> {
    curves.each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i).to_vec())).collect()
}

fn only(curves: &Curves) -> Vec<Vec3> {
    assert_eq!(curves.curve_count(), 1);
    curves.tufts()[0].points().to_vec()
}

pub(super) fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// A cluster down the front of the ball: implanted on its upper half, 12 cm long.
fn one_lock() -> Gesture {
    drawn(Tool::Implant, Layer::Scalp, &line([0.0, -150.0], [0.0, 250.0]))
}

#[test]
fn the_numbers_of_the_paper_are_those_of_the_node() {
    let default = |node: &str, name: &str| {
        let node = crate::by_id(node).unwrap();
        let (at, _) = node.input(name).unwrap();
        match node.inputs[at].default().unwrap() {
            Value::Float(x) => x,
            Value::Int(x) => x as f32,
            other => panic!("{}", other.type_name()),
        }
    };
    for (name, value) in [
        ("radius", 1.0),
        ("segment", 2.0),
        ("tau", 4.0),
        ("rho", 30.0),
        ("angle", 30.0),
        ("density", 0.5),
    ] {
        assert_eq!(default("hair_sketch", name), value, "{name}");
    }
    assert_eq!(default("cluster_to_strands", "strands"), 512.0);
    assert_eq!((twist::TURN, density::STEP), (15.0, 0.05));
    let all = [5.0, 25.0, 40.0, 62.5, 100.0, 300.0].map(|wide| frizz::of_amplitude(wide, 100.0));
    assert_eq!(all, [0.0, 0.0, 0.2, 0.5, 1.0, 1.0]);
}

#[test]
fn an_implant_grows_from_the_head_along_the_stroke_in_segments_of_two_cm() {
    let (curves, said) = sketch(None, &[one_lock()]);
    assert!(said.is_empty(), "{said:?}");
    let (cvs, scalp) = (only(&curves), shared_ball());
    // The ray through 150 pixels above the centre, for 8.9 cm of ball seen from 60 cm with 0.0005 cm per pixel and cm:
    // on the ball.
    assert!(scalp.skin().distance(cvs[0]).abs() < 1e-4, "{}", cvs[0]);
    assert!((cvs[0].y - 150.0 * 0.0005 * (60.0 - cvs[0].z)).abs() < 1e-3 && cvs[0].x.abs() < 1e-3);
    for pair in cvs.windows(2) {
        assert!((pair[0].distance(pair[1]) - 2.0).abs() < 0.25, "{cvs:?}");
    }
    // 400 pixels of 0.0005 (60 - z) cm.
    let way = 400.0 * 0.0005 * (60.0 - cvs[0].z);
    assert!((length(&cvs) - way).abs() < 0.15 * way, "{} of {way}", length(&cvs));
    for p in &cvs[1..] {
        assert!(scalp.skin().distance(*p) > 0.015, "{p}");
        assert!(p.x.abs() < 0.05);
    }
    let tuft = &curves.tufts()[0];
    assert_eq!(tuft.view(DENSITY).at(0, 0), 0.5);
    // An implant that begins beside the head is reported.
    let beside = drawn(Tool::Implant, Layer::Scalp, &line([900.0, 0.0], [950.0, 100.0]));
    let (none, said) = sketch(None, &[beside]);
    assert!(
        none.curve_count() == 0
            && said[0].contains("gesture 0 (implant): it begins beside the head"),
        "{said:?}"
    );
}

fn drawn_again(g: &Gesture, by: Vec2) -> Gesture {
    let mut out = g.clone();
    out.id += 77;
    out.samples.iter_mut().for_each(|s| s.at += by);
    out
}

#[test]
fn an_implant_replaces_the_cluster_whose_disc_holds_its_root_and_takes_its_neighbours_density() {
    let first = one_lock();
    // 20 pixels are half a cm: inside the disc of 1 cm. 100 are 2.6 cm.
    let (curves, _) = sketch(None, &[first.clone(), drawn_again(&first, Vec2::new(20.0, 0.0))]);
    assert_eq!(curves.curve_count(), 1);
    let fuller = drawn(Tool::Density, Layer::Scalp, &circle([0.0, -150.0], 60.0, 4.0));
    let beside = drawn_again(&first, Vec2::new(100.0, 0.0));
    let (curves, said) = sketch(None, &[first, fuller, beside]);
    assert!(said.is_empty(), "{said:?}");
    let densities: Vec<f32> = curves.tufts().iter().map(|t| t.view(DENSITY).at(0, 0)).collect();
    assert!(
        (densities[0] - 0.7).abs() < 1e-5 && (densities[1] - 0.7).abs() < 1e-5,
        "{densities:?}"
    );
}

#[test]
fn a_stroke_beside_a_cluster_leads_as_deep_as_it_and_beside_the_head_keeps_its_depth() {
    // A cluster that hangs toward the eye: 0.7 cm closer per cm down.
    let scalp = shared_ball();
    let known: Vec<Vec3> =
        (0..8).map(|k| Vec3::new(0.0, 6.0 - 1.6 * k as f32, 6.6 + 1.12 * k as f32)).collect();
    let mut b = crate::data::curves::TuftBuilder::new();
    b.push_curve(&known);
    b.set(crate::data::attributes::ID, crate::data::attributes::Domain::Curve, vec![5]);
    let upstream = Curves::new(vec![Arc::new(b.build())]);
    // Straight down, 2 cm beside it.
    let stroke = drawn(Tool::Implant, Layer::Scalp, &line([70.0, -220.0], [70.0, 120.0]));
    let (curves, _) = sketch_on(&scalp, Some(&upstream), &[stroke]);
    let new = curves.tufts().last().unwrap().points().to_vec();
    let slope = |cvs: &[Vec3]| {
        let (a, b) = (cvs[0], cvs[cvs.len() - 1]);
        (b.z - a.z) / (a.y - b.y)
    };
    let found = slope(&new[1..]);
    assert!((found - 0.7).abs() < 0.15 * 0.7, "{found}: {new:?}");
    // With none nearby and no head below, in the plane of the picture: from a root at the ball's edge it leaves the head at once.
    let aside = drawn(Tool::Implant, Layer::Scalp, &line([0.0, -295.0], [300.0, -330.0]));
    let (curves, _) = sketch_on(&scalp, None, &[aside]);
    let cvs = only(&curves);
    assert!(cvs[1..].iter().all(|p| (p.z - cvs[1].z).abs() < 0.02), "{cvs:?}");
    assert!((cvs[1].z - cvs[0].z).abs() < 1.0, "{cvs:?}");
    assert!(cvs.len() > 3);
}

#[test]
fn curves_that_run_more_than_thirty_degrees_elsewhere_tell_no_depth() {
    // From the top of the ball up and toward the eye: 0.7 cm per cm in the picture.
    let known: Vec<Vec3> =
        (0..8).map(|k| Vec3::new(0.0, 8.9 + 1.6 * k as f32, 1.12 * k as f32)).collect();
    let mut b = crate::data::curves::TuftBuilder::new();
    b.push_curve(&known);
    let upstream = Curves::new(vec![Arc::new(b.build())]);
    for (degrees, wanted) in [(0.0, 0.7), (25.0, 0.7), (35.0, 0.0), (-25.0, 0.7), (-35.0, 0.0)] {
        let (sin, cos) = sin_cos(f32::to_radians(degrees));
        let to = [40.0 + 120.0 * sin, -290.0 - 120.0 * cos];
        let stroke = drawn(Tool::Implant, Layer::Scalp, &line([40.0, -290.0], to));
        let (curves, said) = sketch_on(&shared_ball(), Some(&upstream), &[stroke]);
        let cvs = curves.tufts().last().unwrap().points().to_vec();
        let way = cvs[cvs.len() - 1] - cvs[0];
        let found = way.z / way.truncate().length();
        assert!((found - wanted).abs() < 0.15 * 0.7, "{degrees}: {found} {cvs:?} {said:?}");
    }
}

#[test]
fn a_comb_that_stores_no_size_reaches_thirty_pixels_and_no_farther() {
    let (before, _) = sketch(None, &[one_lock()]);
    let was = only(&before);
    let seen = super::seen::Seen::new(&one_lock().view, shared_ball().frame());
    let drawn_line: Vec<Vec2> = was.iter().map(|p| seen.pixel(*p).unwrap()).collect();
    let tuft = &before.tufts()[0];
    let wide = tuft.view(RADIUS).at(0, 3) / seen.cm_per_pixel(seen.depth(was[3]));
    // Beside the middle of a piece, as far off as is asked, and away from it.
    let comb = |off: f32| {
        let (a, b) = (drawn_line[3], drawn_line[4]);
        let aside = (b - a).perp().normalize();
        let from = a.lerp(b, 0.5) + aside * off;
        let comb =
            drawn(Tool::Comb, Layer::Through, &line(from.into(), (from + aside * 200.0).into()));
        sketch(None, &[one_lock(), Gesture { size: 0.0, ..comb }])
    };
    let (after, said) = comb(wide + 20.0);
    assert!(said.is_empty() && only(&after).len() > was.len(), "{said:?}");
    let (same, said) = comb(wide + 32.0);
    assert!(only(&same) == was && said[0].contains("passes no curve"), "{said:?}");
}

#[test]
fn a_full_cluster_has_512_strands_within_a_radius_of_one_cm() {
    let fuller = drawn(Tool::Density, Layer::Scalp, &circle([0.0, -150.0], 60.0, 10.0));
    for (gestures, wanted) in [(vec![one_lock()], 256), (vec![one_lock(), fuller], 512)] {
        let (curves, said) = sketch(None, &gestures);
        assert!(said.is_empty(), "{said:?}");
        let root = only(&curves)[0];
        let set = [("curves", curves.into()), ("scalp", shared_ball().into())];
        let hair = run(crate::by_id("cluster_to_strands").unwrap(), &set).0;
        let hair = curves_of(&hair[0]);
        assert_eq!(hair.curve_count(), wanted);
        let off = hair.each().map(|(tuft, i)| tuft.curve(i)[0].distance(root));
        let off = off.fold(0.0, f32::max);
        assert!((0.9..1.01).contains(&off), "{off}");
    }
}

#[test]
fn a_lengthened_cluster_goes_on_from_its_tip_and_keeps_what_was() {
    let (before, _) = sketch(None, &[one_lock()]);
    let was = only(&before);
    // From its tip 4 cm to the left.
    let seen = super::seen::Seen::new(&one_lock().view, shared_ball().frame());
    let tip = seen.pixel(*was.last().unwrap()).unwrap();
    let on =
        drawn(Tool::Lengthen, Layer::Nearest, &line(tip.into(), [tip.x - 160.0, tip.y + 20.0]));
    let (after, said) = sketch(None, &[one_lock(), on]);
    assert!(said.is_empty(), "{said:?}");
    let cvs = only(&after);
    assert_eq!(cvs[..was.len()], was[..]);
    assert!(cvs.len() > was.len() + 1 && cvs.last().unwrap().x < -3.0, "{cvs:?}");
    let far = drawn(Tool::Lengthen, Layer::Nearest, &line([tip.x + 40.0, tip.y], [300.0, tip.y]));
    let (same, said) = sketch(None, &[one_lock(), far]);
    assert!(only(&same) == was && said[0].contains("begin at a tip"), "{said:?}");
}

#[test]
fn a_point_goes_where_the_pen_puts_it_and_takes_none_along() {
    let (before, _) = sketch(None, &[one_lock()]);
    let was = only(&before);
    let seen = super::seen::Seen::new(&one_lock().view, shared_ball().frame());
    let at = seen.pixel(was[4]).unwrap();
    // 50 pixels to the right, at its depth: as many cm as they cover there.
    let (from, to) = ([at.x + 4.0, at.y], [at.x + 54.0, at.y]);
    let pull = drawn(Tool::Point, Layer::Nearest, &line(from, to));
    let (after, said) = sketch(None, &[one_lock(), pull.clone()]);
    assert!(said.is_empty(), "{said:?}");
    let cvs = only(&after);
    let by = 50.0 * seen.cm_per_pixel(seen.depth(was[4]));
    assert!((cvs[4] - was[4]).distance(Vec3::X * by) < 1e-3, "{} {}", cvs[4], was[4]);
    assert!((0..was.len()).all(|k| k == 4 || cvs[k] == was[k]));
    // With a size its neighbours follow, the less the farther they are; roots and what is farther stay.
    let soft = Gesture { size: 1.5 * at.distance(seen.pixel(was[3]).unwrap()), ..pull.clone() };
    let (after, _) = sketch(None, &[one_lock(), soft]);
    let ways = (0..was.len()).map(|k| only(&after)[k].distance(was[k]));
    let ways: Vec<f32> = ways.collect();
    assert!((ways[4] - by).abs() < 1e-3 && ways[3] > 0.05 * by && ways[3] < 0.6 * by, "{ways:?}");
    assert!(ways[5] > 0.05 * by && ways[0] == 0.0 && ways[1] == 0.0, "{ways:?}");
    let still = drawn(Tool::Point, Layer::Nearest, &[at, at + Vec2::new(0.125, 0.0)]);
    let (same, said) = sketch(None, &[one_lock(), still]);
    assert!(only(&same) == was && said[0].contains("drag the point on"), "{said:?}");
    // Not into the head, not through a pin, and without effect on empty space.
    let deep = drawn(Tool::Point, Layer::Nearest, &line(from, [at.x, at.y - 60.0]));
    let (after, _) = sketch(None, &[one_lock(), deep]);
    assert!(super::random_laws::out_of(&shared_ball(), only(&after)[4]) > 0.0);
    let pin = drawn(Tool::Pin, Layer::Nearest, &[seen.pixel(was[5]).unwrap()]);
    let (same, said) = sketch(None, &[one_lock(), pin, pull]);
    assert!(only(&same) == was && said[0].contains("tap the pin"), "{said:?}");
    let beside = drawn(Tool::Point, Layer::Nearest, &line([200.0, 0.0], [260.0, 0.0]));
    let (same, said) = sketch(None, &[one_lock(), beside]);
    assert!(only(&same) == was && said[0].contains("no point of a curve"), "{said:?}");
}

#[test]
fn a_pin_with_a_size_pins_all_under_its_stroke_and_frees_it_where_it_begins_on_a_pin() {
    let lock = one_lock();
    let beside = drawn_again(&lock, Vec2::new(60.0, 0.0));
    let two = [lock.clone(), beside];
    let (was, _) = sketch(None, &two);
    let seen = super::seen::Seen::new(&lock.view, shared_ball().frame());
    let at = seen.pixel(was.tufts()[0].points()[3]).unwrap();
    let (from, to) = (at - Vec2::new(20.0, 0.0), at + Vec2::new(80.0, 0.0));
    let mut pin = drawn(Tool::Pin, Layer::Through, &line(from.into(), to.into()));
    pin.size = 25.0;
    let (pinned, said) = sketch(None, &[&two[..], &[pin.clone()]].concat());
    assert!(said.is_empty(), "{said:?}");
    for (tuft, i) in pinned.each() {
        let pins = tuft.view(PINNED);
        let under = |p: Vec3| super::hand::off_piece(&[from, to], [seen.pixel(p).unwrap(); 2]).0;
        let mut count = 0;
        for (k, p) in tuft.curve(i).iter().enumerate().skip(1) {
            assert_eq!(pins.at(i, k) != 0, under(*p) <= 25.0, "{k}");
            count += i32::from(pins.at(i, k) != 0);
        }
        assert!(count > 0 && pins.at(i, 0) == 0);
    }
    let again = Gesture { id: 9, ..pin.clone() };
    let (freed, said) = sketch(None, &[&two[..], &[pin, again]].concat());
    assert!(said.is_empty(), "{said:?}");
    let free = |(tuft, i): (&crate::data::curves::Tuft, usize)| {
        (0..tuft.curve(i).len()).all(|k| tuft.view(PINNED).at(i, k) == 0)
    };
    assert!(freed.each().all(free));
}

#[test]
fn a_curve_drawn_anew_keeps_what_lies_before_and_follows_the_stroke() {
    let lock = one_lock();
    let taper = drawn(Tool::Twist, Layer::Nearest, &circle([0.0, -20.0], 15.0, 3.0));
    let (before, _) = sketch(None, &[lock.clone(), taper.clone()]);
    let was = only(&before);
    let seen = super::seen::Seen::new(&lock.view, shared_ball().frame());
    // From between its third and fourth CV, 200 pixels to the left and slightly down.
    let at = seen.pixel(was[2].lerp(was[3], 0.5)).unwrap();
    let anew = drawn(Tool::Redraw, Layer::Nearest, &line(at.into(), [at.x - 200.0, at.y + 60.0]));
    let (after, said) = sketch(None, &[lock.clone(), taper.clone(), anew.clone()]);
    assert!(said.is_empty(), "{said:?}");
    let cvs = only(&after);
    assert_eq!(cvs[..=2], was[..=2]);
    assert!(cvs[3].distance(was[2].lerp(was[3], 0.5)) < 0.1, "{}", cvs[3]);
    // Its tip is under the end of the stroke.
    let tip = seen.pixel(cvs[cvs.len() - 1]).unwrap();
    assert!(tip.distance(Vec2::new(at.x - 200.0, at.y + 60.0)) < 20.0, "{tip}");
    // Its twist still ends as before.
    let roll = |curves: &Curves| {
        let tuft = &curves.tufts()[0];
        tuft.view(ROLL).at(0, tuft.points().len() - 1)
    };
    assert!(roll(&before) > 0.0 && roll(&after) == roll(&before));
    // With its stored path, the result is the same; on a larger head it is larger in proportion.
    let all = |last: &Gesture| vec![lock.clone(), taper.clone(), last.clone()];
    let kept = resolved(&anew, &before, &after, &shared_ball());
    assert_eq!((kept.curves.len(), kept.path.len()), (1, cvs.len() - 4));
    let again = only(&sketch(None, &all(&kept)).0);
    let off = cvs.iter().zip(&again).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
    assert!(off < 1e-4 && cvs.len() == again.len(), "{off}");
    // A tap with a trembling hand removes nothing, and neither does a path without length.
    let tap = drawn(Tool::Redraw, Layer::Nearest, &[at, at + Vec2::new(0.125, 0.0)]);
    let nowhere = Gesture { path: vec![Vec3::ZERO], ..anew.clone() };
    for short in [tap, nowhere] {
        let (same, said) = sketch(None, &[lock.clone(), taper.clone(), short]);
        assert!(only(&same) == was && said[0].contains("no length"), "{said:?}");
    }
    // Only beyond a pin.
    let pin = drawn(Tool::Pin, Layer::Nearest, &[seen.pixel(was[4]).unwrap()]);
    let (same, said) = sketch(None, &[lock.clone(), pin.clone(), anew]);
    assert!(only(&same) == only(&sketch(None, &[lock, pin]).0), "{said:?}");
    assert!(said[0].contains("behind its last pin"), "{said:?}");
}

#[test]
fn a_cut_ends_the_nearest_all_or_takes_out_what_is_rooted_there() {
    // Three clusters side by side, 2.6 cm apart, and one behind the head's other side.
    let row: Vec<Gesture> =
        [-100.0, 0.0, 100.0].map(|x| drawn_again(&one_lock(), Vec2::new(x, 0.0))).to_vec();
    let mut row = row;
    for (i, one) in row.iter_mut().enumerate() {
        one.id = 10 + i as u64;
    }
    let mut behind = one_lock();
    behind.id = 20;
    behind.view.eye.z = -60.0;
    let all: Vec<Gesture> = row.iter().cloned().chain([behind]).collect();
    let (before, _) = sketch(None, &all);
    let was = points(&before);
    assert_eq!(was.len(), 4);
    let tips = |curves: &Curves| -> Vec<f32> {
        curves.tufts().iter().map(|t| t.points().last().unwrap().y).collect()
    };
    let mut through = drawn(Tool::Cut, Layer::Through, &line([-250.0, 100.0], [250.0, 100.0]));
    through.id = 30;
    let with = |cut: &Gesture| {
        let (out, said) = sketch(None, &[&all[..], std::slice::from_ref(cut)].concat());
        (out, said)
    };
    let (cut, said) = with(&through);
    assert!(said.is_empty(), "{said:?}");
    let ends = tips(&cut);
    // 100 pixels below the centre: at 51 cm, 2.6 cm down.
    assert!(ends[..3].iter().all(|y| (y + 2.55).abs() < 0.15) && ends[3] < -4.0, "{ends:?}");
    // From side to side of a single one.
    let mut one = drawn(Tool::Cut, Layer::Nearest, &line([-55.0, 100.0], [55.0, 100.0]));
    one.id = 31;
    let ends = tips(&with(&one).0);
    assert!(ends[0] < -4.0 && (ends[1] + 2.55).abs() < 0.15 && ends[2] < -4.0, "{ends:?}");
    // A stroke that begins inside a cluster cuts nothing.
    let mut short = drawn(Tool::Cut, Layer::Nearest, &line([-5.0, 100.0], [55.0, 100.0]));
    short.id = 32;
    let (same, said) = with(&short);
    assert!(points(&same) == was && said[0].contains("from side to side"), "{said:?}");
    // On the scalp: whatever is rooted on the line, whole.
    let mut scalp = drawn(Tool::Cut, Layer::Scalp, &line([-20.0, -150.0], [200.0, -150.0]));
    scalp.id = 33;
    let (left, _) = with(&scalp);
    assert_eq!(left.curve_count(), 2);
}

#[test]
fn each_full_circle_changes_density_by_a_twentieth() {
    #[track_caller]
    fn check(turns: f32, wanted: f32) {
        let circle = drawn(Tool::Density, Layer::Nearest, &circle([0.0, 50.0], 40.0, turns));
        let (curves, _) = sketch(None, &[one_lock(), circle]);
        let found = curves.tufts()[0].view(DENSITY).at(0, 0);
        assert!((found - wanted).abs() < 1e-5, "{turns}: {found}, not {wanted}");
    }
    for (turns, wanted) in [
        (1.0, 0.55),
        (3.0, 0.65),
        (-1.0, 0.45),
        (-2.4, 0.4),
        (0.6, 0.5),
        (-0.7, 0.5),
        (20.0, 1.0),
        (-20.0, 0.0),
    ] {
        check(turns, wanted);
    }
}

#[test]
fn each_loop_turns_the_cluster_by_fifteen_degrees_from_there_on() {
    // Loops with a radius of 12 pixels along the cluster, which is 38 wide on each side.
    let twirl = |turns: f32, loops: usize| -> Vec<Vec2> {
        let count = 40 * loops;
        (0..=count)
            .map(|k| {
                let t = k as f32 / count as f32;
                let (sin, cos) = sin_cos(std::f32::consts::TAU * turns * t);
                Vec2::new(12.0 * sin, 30.0 * t - 12.0 * cos)
            })
            .collect()
    };
    for (turns, loops, wanted) in [(3.3, 3, 3), (-3.3, 3, -3), (1.3, 2, 1), (0.4, 2, 0)] {
        let twist = drawn(Tool::Twist, Layer::Nearest, &twirl(turns, loops));
        let found = super::stroke_shape::loops(&twirl(turns, loops), 30.0);
        let sum: f32 = found.iter().map(|one| one.sign).sum();
        assert_eq!(sum as i32, wanted, "{turns}: {found:?}");
        let (curves, _) = sketch(None, &[one_lock(), twist]);
        let tuft = &curves.tufts()[0];
        let last = tuft.points().len() - 1;
        assert_eq!(tuft.view(ROLL).at(0, 0), 0.0);
        assert_eq!(tuft.view(ROLL).at(0, last), 15.0 * wanted as f32, "{turns}");
    }
}

#[test]
fn a_scribble_as_wide_as_the_cluster_frizzes_it_whole() {
    // The cluster of 2 cm is about 78 pixels wide at the scribble.
    for (wide, wanted) in [(80.0, 1.0), (48.0, 0.5), (15.0, 0.0)] {
        let to = |k: usize| {
            Vec2::new(if k.is_multiple_of(2) { -0.5 } else { 0.5 } * wide, 4.0 * k as f32)
        };
        let corners: Vec<Vec2> = (0..10).map(to).collect();
        let line: Vec<Vec2> = corners
            .windows(2)
            .flat_map(|pair| (0..8).map(|k| pair[0].lerp(pair[1], k as f32 / 8.0)))
            .collect();
        let scribble = drawn(Tool::Frizz, Layer::Nearest, &line);
        let (curves, said) = sketch(None, &[one_lock(), scribble]);
        let found = curves.tufts()[0].view(FRIZZ).at(0, 0);
        assert!((found - wanted).abs() < 0.12, "{wide}: {found} {said:?}");
    }
}

#[test]
fn a_pin_holds_all_before_it_and_a_second_tap_frees_it() {
    let (before, _) = sketch(None, &[one_lock()]);
    let was = only(&before);
    let seen = super::seen::Seen::new(&one_lock().view, shared_ball().frame());
    let at = seen.pixel(was[2]).unwrap();
    let mut tap = drawn(Tool::Pin, Layer::Nearest, &[at]);
    tap.id = 40;
    let next = seen.pixel(was[3]).unwrap();
    let way = line(next.into(), [next.x + 150.0, next.y + 20.0]);
    let comb = drawn(Tool::Comb, Layer::Through, &way);
    let (pinned, _) = sketch(None, &[one_lock(), tap.clone(), comb.clone()]);
    assert_eq!(pinned.tufts()[0].view(PINNED).at(0, 2), 1);
    let cvs = only(&pinned);
    assert_eq!(cvs[..3], was[..3]);
    assert!(cvs[3..].iter().zip(&was[3..]).any(|(a, b)| a.distance(*b) > 0.3));
    let again = Gesture { id: 41, ..tap.clone() };
    let (free, _) = sketch(None, &[one_lock(), tap, again, comb.clone()]);
    let (never, _) = sketch(None, &[one_lock(), comb]);
    assert_eq!(only(&free), only(&never));
}

#[test]
fn a_comb_moves_hair_along_the_stroke_and_keeps_its_length() {
    let (before, _) = sketch(None, &[one_lock()]);
    let was = only(&before);
    // A comb takes everything under it along, and at half the strength half of it.
    let comb = drawn(Tool::Comb, Layer::Nearest, &line([0.0, 75.0], [150.0, 75.0]));
    let (after, said) = sketch(None, &[one_lock(), comb.clone()]);
    assert!(said.is_empty(), "{said:?}");
    let cvs = only(&after);
    assert_eq!(cvs[0], was[0]);
    let farthest = |cvs: &[Vec3]| cvs.iter().map(|p| p.x).fold(0.0, f32::max);
    assert!(farthest(&cvs) > 0.7, "{cvs:?}");
    assert!((length(&cvs) / length(&was) - 1.0).abs() < 0.01);
    for p in &cvs[1..] {
        assert!(shared_ball().skin().distance(*p) > -1e-3, "{p}");
    }
    let (less, _) = sketch(None, &[one_lock(), Gesture { strength: 0.5, ..comb }]);
    let less = farthest(&only(&less));
    assert!(less > 0.1 && less < farthest(&cvs) - 0.2, "{less}");
}

#[test]
fn a_gesture_acts_on_the_curves_it_names_alone_and_tells_those_that_are_gone() {
    let mut beside = drawn_again(&one_lock(), Vec2::new(60.0, 0.0));
    beside.id = 9;
    let start = [one_lock(), beside];
    let (before, _) = sketch(None, &start);
    let was = points(&before);
    let ids: Vec<u64> = was.keys().copied().collect();
    let mut comb = drawn(Tool::Comb, Layer::Through, &line([0.0, 60.0], [150.0, 60.0]));
    let both = points(&sketch(None, &[&start[..], &[comb.clone()]].concat()).0);
    assert!(ids.iter().all(|id| both[id] != was[id]));
    comb.curves = vec![ids[0], 0xdead];
    let (after, said) = sketch(None, &[&start[..], &[comb.clone()]].concat());
    let is = points(&after);
    assert!(is[&ids[0]] == both[&ids[0]] && is[&ids[1]] == was[&ids[1]]);
    let text = "gesture 2 (comb): 1 of its 2 curves are not there any more";
    assert!(said.len() == 1 && said[0].contains(text), "{said:?}");
    comb.curves = vec![0xdead];
    let (after, said) = sketch(None, &[&start[..], &[comb]].concat());
    assert!(
        points(&after) == was && said[0].contains("its curve is not there any more"),
        "{said:?}"
    );
}

#[test]
fn one_more_gesture_runs_alone_and_what_it_does_not_touch_is_the_same_tuft() {
    let (host, scalp) = (Memory::default(), shared_ball());
    let steps = |gestures: &[Gesture]| {
        let log = Log::default();
        let set = [
            ("scalp", scalp.clone().into()),
            ("gestures", Value::from(Gestures(gestures.to_vec()))),
        ];
        let out = run_on(&hair_sketch::NODE, &set, &host, &log, Quality::Final).unwrap();
        (curves_of(&out[0]).clone(), log.tufts_run.load(Ordering::Relaxed))
    };
    let mut all: Vec<Gesture> = (0..10)
        .map(|i| {
            let mut one = drawn_again(&one_lock(), Vec2::new(-225.0 + 45.0 * i as f32, 0.0));
            one.id = 100 + i;
            one
        })
        .collect();
    let (_, ran) = steps(&all);
    assert_eq!(ran, 10);
    let (before, ran) = steps(&all);
    assert_eq!(ran, 0);
    let mut comb = drawn(Tool::Comb, Layer::Nearest, &line([0.0, 60.0], [100.0, 60.0]));
    comb.id = 7;
    all.push(comb);
    let (after, ran) = steps(&all);
    assert_eq!(ran, 1);
    let same = before.tufts().iter().zip(after.tufts()).filter(|(a, b)| Arc::ptr_eq(a, b)).count();
    assert_eq!(same, before.tufts().len() - 1);
}

#[test]
fn what_is_resolved_replays_as_it_was_drawn() {
    let scalp = shared_ball();
    let mut so_far: Vec<Gesture> = vec![];
    let seen = super::seen::Seen::new(&one_lock().view, scalp.frame());
    let lines: Vec<(Tool, Layer, Vec<Vec2>)> = vec![
        (Tool::Implant, Layer::Scalp, line([0.0, -150.0], [40.0, 250.0])),
        (Tool::Implant, Layer::Scalp, line([90.0, -150.0], [150.0, 220.0])),
        (Tool::Comb, Layer::Through, line([20.0, 0.0], [180.0, 90.0])),
        (Tool::Puff, Layer::Through, line([20.0, -40.0], [20.0, 60.0])),
        (Tool::Cut, Layer::Through, line([-250.0, 150.0], [250.0, 150.0])),
    ];
    for round in 0..=lines.len() {
        let (before, _) = sketch_on(&scalp, None, &so_far);
        let (tool, layer, line) = match lines.get(round) {
            Some(one) => one.clone(),
            None => {
                let tip = seen.pixel(*before.tufts()[0].points().last().unwrap()).unwrap();
                (Tool::Lengthen, Layer::Nearest, line(tip.into(), [tip.x + 90.0, tip.y + 120.0]))
            }
        };
        let mut one = drawn(tool, layer, &line);
        one.id = 50 + round as u64;
        so_far.push(one.clone());
        let (after, said) = sketch_on(&scalp, None, &so_far);
        assert!(said.is_empty(), "{said:?}");
        *so_far.last_mut().unwrap() = resolved(&one, &before, &after, &scalp);
        let kept = so_far.last().unwrap();
        assert!(!kept.curves.is_empty() || kept.root.is_some(), "{tool:?}");
        let (again, said) = sketch_on(&scalp, None, &so_far);
        assert!(said.is_empty(), "{said:?}");
        let (a, b) = (points(&after), points(&again));
        assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
        for (id, cvs) in &a {
            let off = cvs.iter().zip(&b[id]).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            assert!(cvs.len() == b[id].len() && off < 1e-4, "{tool:?}: {off}");
        }
    }
}

#[test]
fn a_cut_on_a_bias_ends_each_strand_on_the_stroke() {
    // A cut that falls by 100 pixels over 200 across a cluster of 78, and one straight across.
    for (from, to) in [([-100.0, 50.0], [100.0, 150.0]), ([-100.0, 100.0], [100.0, 100.0])] {
        let stroke = drawn(Tool::Cut, Layer::Nearest, &line(from, to));
        let (cut, said) = sketch(None, &[one_lock(), stroke]);
        assert!(said.is_empty(), "{said:?}");
        let set = [("curves", cut.into()), ("scalp", shared_ball().into())];
        let hair = run(crate::by_id("cluster_to_strands").unwrap(), &set).0;
        let seen = super::seen::Seen::new(&one_lock().view, shared_ball().frame());
        let (a, b) = (Vec2::from(from), Vec2::from(to));
        let off = |p: &Vec3| {
            let at = seen.pixel(*p).unwrap();
            (at - a).perp_dot((b - a).normalize()).abs()
        };
        let ends: Vec<f32> = curves_of(&hair[0])
            .each()
            .map(|(tuft, i)| off(tuft.curve(i).last().unwrap()))
            .collect();
        assert!(ends.len() > 200);
        // Half a pixel is a fifth of a millimetre; points pushed out of the head may be off.
        let near = ends.iter().filter(|off| **off < 0.5).count();
        assert!(100 * near >= 95 * ends.len(), "{near} of {}", ends.len());
    }
}
