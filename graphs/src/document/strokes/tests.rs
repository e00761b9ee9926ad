//! The grid, simplification and edits of strokes.

use super::super::testing::Random;
use super::whole::End;
use super::*;
use crate::values::grid::strokes_on_grid;
use glam::{Vec2, Vec3};
use std::sync::Arc;

fn distance(p: Vec3, path: &[Sample]) -> f32 {
    let to = |a: Vec3, b: Vec3| {
        let span = b - a;
        let t = if span.length_squared() > 0.0 {
            (p - a).dot(span) / span.length_squared()
        } else {
            0.0
        };
        (a + span * t.clamp(0.0, 1.0)).distance(p)
    };
    let ends = path.windows(2).map(|w| to(w[0].position, w[1].position));
    ends.fold(path[0].position.distance(p), f32::min)
}

#[test]
fn a_finished_stroke_is_within_tolerance_of_every_sample_and_much_shorter() {
    let (mut worst, mut given, mut kept) = (0.0f32, 0, 0);
    for seed in 0..40 {
        let samples = Random::new(seed).pen(300);
        let stroke = finish(&samples, &Strokes::default()).unwrap();
        given += samples.len();
        kept += stroke.samples.len();
        for sample in &samples {
            worst = worst.max(distance(sample.position, &stroke.samples));
        }
    }
    assert!(worst <= TOLERANCE, "{worst}");
    assert!(kept * 3 < given, "{kept} of {given}");
}

#[test]
fn a_wrist_that_turns_keeps_few_samples_and_its_tilt() {
    let line = |tilt: fn(f32) -> f32| {
        let sample = |k: usize| Sample {
            position: Vec3::X * k as f32 * 0.1,
            tilt: Vec2::new(0.3, tilt(k as f32 / 99.0)),
            ..Sample::default()
        };
        let samples: Vec<Sample> = (0..100).map(sample).collect();
        finish(&samples, &Strokes::default()).unwrap().samples
    };
    assert_eq!(line(|t| if t > 0.5 { 0.05 } else { 0.0 }).len(), 2);
    let bent = line(|t| (t - 0.5).abs());
    assert_eq!(bent.len(), 3);
    assert!((bent[0].tilt - Vec2::new(0.3, 0.5)).abs().max_element() < 0.01);
}

#[test]
fn the_grid_holds_what_is_on_it() {
    let mut random = Random::new(9);
    for _ in 0..20_000 {
        let mut at = |most: f32| (random.unit() - 0.5) * 2.0 * most;
        let (x, y, z) = (at(60.0), at(1.0), at(1e5));
        let sample = Sample {
            position: Vec3::new(x, y, z),
            pressure: random.unit(),
            time: random.number(),
            tilt: Vec2::new(random.unit() * 3.0 - 1.5, -random.unit()),
        };
        let once = Steps::of(&sample).sample();
        assert_eq!(Steps::of(&once).sample(), once);
        assert!(
            (once.position.x - x).abs() < 0.00501
                && (once.pressure - sample.pressure).abs() < 0.002
        );
    }
}

#[test]
fn strokes_on_the_grid_are_shared_and_others_brought_there() {
    let strokes = Arc::new(Random::new(4).strokes());
    assert!(Arc::ptr_eq(&strokes, &strokes_on_grid(strokes.clone())));
    let mut off = (*strokes).clone();
    let drawn = Random::new(4).pen(5);
    off.0.push(Stroke { drawn, ..Stroke::new(1, vec![Sample::default()]) });
    let on = strokes_on_grid(Arc::new(off));
    assert_ne!(on.0.last().map(|stroke| &stroke.drawn), Some(&Random::new(4).pen(5)));
    assert!(Arc::ptr_eq(&on, &strokes_on_grid(on.clone())));
}

#[test]
fn degenerate_strokes_have_an_answer() {
    let none = Strokes::default();
    assert_eq!(finish(&[], &none), None);
    let bad = Sample { tilt: Vec2::NAN, ..Sample::default() };
    assert_eq!(finish(&[bad], &none), None);
    let dot = Sample { position: Vec3::ONE, pressure: 0.5, ..Sample::default() };
    let one = finish(&[dot, bad], &none).unwrap();
    assert_eq!(one.samples, [dot]);
    // A pen that rests keeps its ends only.
    let rest: Vec<Sample> = (0..9).map(|k| Sample { time: k as f32 * 0.5, ..dot }).collect();
    let rested = finish(&rest, &none).unwrap();
    assert_eq!(rested.samples.len(), 2);
    let position = Vec3::splat(f32::MAX);
    let huge = Sample { position, pressure: 9.0, time: -1.0, tilt: Vec2::splat(-3.0) };
    let sample = finish(&[huge], &none).unwrap().samples[0];
    assert_eq!((sample.position.x, sample.pressure, sample.time), (1e5, 1.0, 0.0));
    assert_eq!(sample.tilt, Vec2::NEG_ONE);
}

#[test]
fn ids_differ_within_a_list_and_are_the_same_in_a_replay() {
    let samples = Random::new(2).pen(30);
    let mut strokes = Strokes::default();
    for _ in 0..5 {
        let stroke = finish(&samples, &strokes).unwrap();
        assert_eq!(stroke, finish(&samples, &strokes).unwrap());
        strokes.0.push(stroke);
    }
    assert_eq!(strokes.fault(), None);
}

/// Strokes of all kinds: as drawn and edited, a dot, and one that rests.
fn strokes() -> Vec<Stroke> {
    let mut strokes = vec![];
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let count = 2 + random.below(120);
        let mut stroke = finish(&random.pen(count), &Strokes::default()).unwrap();
        if seed % 3 == 0 {
            stroke = cvs::moved(&stroke, &vec![1.0; stroke.samples.len()], Vec3::Y);
        }
        strokes.push(stroke);
    }
    strokes
}
/// What holds for everything that edits give.
#[track_caller]
fn lawful(before: &Stroke, after: &Stroke) {
    let list = Arc::new(Strokes(vec![after.clone()]));
    assert_eq!(list.fault(), None);
    assert!(Arc::ptr_eq(&list, &strokes_on_grid(list.clone())), "off the grid");
    assert_eq!(after.id, before.id);
    if after.samples != before.samples {
        assert_eq!(after.drawn, cvs::as_drawn(before), "what was drawn is lost");
    } else {
        assert_eq!(after, before);
    }
    assert!(after.samples.windows(2).all(|w| w[0].time <= w[1].time), "time runs backwards");
}
fn ends(stroke: &Stroke) -> [Vec3; 2] {
    [stroke.samples[0].position, stroke.samples[stroke.samples.len() - 1].position]
}
fn near(a: Vec3, b: Vec3) -> bool {
    a.distance(b) < 0.02
}

#[test]
fn edits_by_nothing_change_nothing() {
    for stroke in strokes() {
        let n = stroke.samples.len();
        let weights = cvs::falloff(&stroke, &[n / 2].into(), 3.0);
        let same = [
            cvs::moved(&stroke, &weights, Vec3::ZERO),
            cvs::moved(&stroke, &vec![0.0; n], Vec3::ONE),
            cvs::moved(&stroke, &weights, Vec3::NAN),
            cvs::placed(&stroke, &[(0, stroke.samples[0].position), (n, Vec3::ONE)]),
            cvs::slid(&stroke, n / 2, 0.0),
            cvs::slid(&stroke, 0, 1.0),
            cvs::slid(&stroke, n - 1, 1.0),
            cvs::straightened(&stroke, 0, n - 1, 0.0),
            cvs::smoothed(&stroke, &vec![0.0; n]),
            cvs::deleted(&stroke, &[].into()).unwrap(),
            whole::extended(&stroke, End::Root, 0.0).unwrap(),
            whole::extended(&stroke, End::Tip, 0.0).unwrap(),
        ];
        for (i, after) in same.iter().enumerate() {
            assert_eq!(*after, stroke, "edit {i}");
        }
    }
}

#[test]
fn a_move_falls_off_along_the_stroke_and_leaves_the_ends() {
    for stroke in strokes().iter().filter(|s| s.samples.len() > 4) {
        let n = stroke.samples.len();
        let mid = n / 2;
        let weights = cvs::falloff(stroke, &[mid].into(), 100.0);
        assert_eq!((weights[0], weights[mid]), (0.0, 1.0));
        assert!(weights[..=mid].is_sorted() && weights[mid..].is_sorted_by(|a, b| a >= b));
        let alone = cvs::falloff(stroke, &[mid].into(), 0.0);
        assert_eq!(alone.iter().sum::<f32>(), 1.0);
        let root = cvs::falloff(stroke, &[0].into(), 100.0);
        assert!(root.iter().all(|weight| *weight > 0.5), "{root:?}");
        let by = Vec3::new(0.31, -0.22, 0.13);
        let after = cvs::moved(stroke, &weights, by);
        lawful(stroke, &after);
        assert_eq!(ends(&after)[0], ends(stroke)[0]);
        let moved = after.samples[mid].position - stroke.samples[mid].position;
        assert!(near(moved, by));
        assert_eq!(cvs::refitted(&after).samples, cvs::as_drawn(stroke));
        assert_eq!(cvs::refitted(&after).drawn, []);
    }
    // Two picked ones do not add up.
    let stroke = &strokes()[1];
    let weights = cvs::falloff(stroke, &[1, 2].into(), 9.0);
    assert!(weights.iter().all(|weight| *weight <= 1.0));
}

#[test]
fn cvs_come_and_go_without_the_shape() {
    for stroke in strokes() {
        let length = cvs::length(&stroke);
        for part in [0.0, 0.2, 0.5, 0.99, 1.0] {
            let (after, i) = cvs::inserted(&stroke, part * length).unwrap();
            lawful(&stroke, &after);
            assert!((cvs::length(&after) - length).abs() < 0.02 && ends(&after) == ends(&stroke));
            let (way, off) = cvs::nearest(&stroke, after.samples[i].position);
            assert!(off < 0.01 && (way - part * length).abs() < 0.02, "{way} {off}");
            if after.samples.len() > stroke.samples.len() {
                assert_eq!(cvs::deleted(&after, &[i].into()).unwrap().samples, stroke.samples);
            }
        }
        let all = (0..stroke.samples.len()).collect();
        assert_eq!(cvs::deleted(&stroke, &all), None);
    }
}

#[test]
fn a_slid_cv_stays_on_the_stroke_between_its_neighbours() {
    for stroke in strokes() {
        for cv in 1..stroke.samples.len() - 1 {
            for by in [-50.0, -0.1, 0.1, 50.0] {
                let after = cvs::slid(&stroke, cv, by);
                lawful(&stroke, &after);
                let (way, off) = cvs::nearest(&stroke, after.samples[cv].position);
                let ways = cvs::ways(&stroke.samples);
                assert!(off < 0.01 && way > ways[cv - 1] - 0.01 && way < ways[cv + 1] + 0.01);
            }
        }
    }
}

#[test]
fn straight_is_straight_and_smooth_is_shorter() {
    for stroke in strokes().iter().filter(|s| s.samples.len() > 3) {
        let n = stroke.samples.len();
        let line = cvs::straightened(stroke, n - 1, 0, 1.0);
        lawful(stroke, &line);
        let [a, b] = ends(stroke);
        assert!((cvs::length(&line) - a.distance(b)).abs() < 0.03 && ends(&line) == [a, b]);
        let half = cvs::straightened(stroke, 0, n - 1, 0.5);
        assert!(cvs::length(&half) < cvs::length(stroke) + 0.02);
        assert_eq!(cvs::straightened(stroke, 1, 2, 1.0), *stroke);
        let mut smooth = stroke.clone();
        for _ in 0..20 {
            smooth = cvs::smoothed(&smooth, &vec![1.0; n]);
        }
        lawful(stroke, &smooth);
        assert!(cvs::length(&smooth) <= cvs::length(stroke) + 0.02 && ends(&smooth) == [a, b]);
        // On the grid a straight line is nearly straight, and stays so.
        for (p, q) in line.samples.iter().zip(&cvs::smoothed(&line, &vec![1.0; n]).samples) {
            assert!(near(p.position, q.position));
        }
    }
}

#[test]
fn an_end_grows_straight_on_and_shrinks_along_the_stroke() {
    for stroke in strokes() {
        let length = cvs::length(&stroke);
        for (end, kept) in [(End::Tip, 0), (End::Root, 1)] {
            for by in [3.0, 0.4, -0.3 * length] {
                let after = whole::extended(&stroke, end, by).unwrap();
                lawful(&stroke, &after);
                assert_eq!(ends(&after)[kept], ends(&stroke)[kept]);
                let grown = cvs::length(&after) - length;
                assert!((grown - by).abs() < 0.02, "{end:?} by {by}: {grown}");
            }
            assert_eq!(whole::extended(&stroke, end, -length), None);
        }
    }
    let dot = Stroke::new(1, vec![Sample::default()]);
    assert_eq!(whole::extended(&dot, End::Tip, 1.0), None);
}

#[test]
fn a_reversed_stroke_keeps_pressure_at_its_place_and_is_itself_again_twice() {
    for stroke in strokes() {
        let after = whole::reversed(&stroke);
        lawful(&stroke, &after);
        let pairs = after.samples.iter().rev().zip(&stroke.samples);
        for (a, b) in pairs {
            assert_eq!((a.position, a.pressure, a.tilt), (b.position, b.pressure, b.tilt));
        }
        assert_eq!(after.samples[0].time, 0.0);
        let twice = whole::reversed(&after).samples;
        assert!(twice.iter().zip(&stroke.samples).all(|(a, b)| near(a.position, b.position)));
    }
}

#[test]
fn two_parts_are_the_whole_and_joined_it_again() {
    let others = Strokes(strokes());
    for stroke in &others.0 {
        let length = cvs::length(stroke);
        for part in [0.0, 0.3, 0.5, 1.0] {
            let Some((root, tip)) = whole::cut(stroke, part * length, &others) else {
                assert!(part == 0.0 || part == 1.0 || length < 0.2);
                continue;
            };
            for piece in [&root, &tip] {
                let list = Arc::new(Strokes(vec![piece.clone()]));
                assert!(Arc::ptr_eq(&list, &strokes_on_grid(list.clone())));
                assert_eq!(piece.drawn.is_empty(), stroke.drawn.is_empty());
            }
            assert_eq!(root.id, stroke.id);
            assert!(others.0.iter().all(|other| other.id != tip.id) && tip.id != 0);
            assert_eq!([ends(&root)[0], ends(&tip)[1]], ends(stroke));
            assert_eq!((ends(&root)[1], tip.samples[0].time), (ends(&tip)[0], 0.0));
            assert!((cvs::length(&root) + cvs::length(&tip) - length).abs() < 0.03);
            for (a, b) in [(&root, &tip), (&tip, &root), (&root, &whole::reversed(&tip))] {
                let again = whole::joined(a, b);
                assert_eq!(again.id, a.id);
                assert!((cvs::length(&again) - length).abs() < 0.03);
                assert_eq!(ends(&again), ends(stroke));
                assert!(again.samples.windows(2).all(|w| w[0].time <= w[1].time));
                assert!(!again.drawn.is_empty());
            }
        }
    }
}

#[test]
fn a_part_is_drawn_anew_in_either_direction_and_the_rest_stays() {
    for stroke in strokes().iter().filter(|s| cvs::length(s) > 2.0) {
        let length = cvs::length(stroke);
        let at = |part: f32| cvs::at(&stroke.samples, part * length).unwrap().1.position;
        let bow = |from: f32, to: f32| -> Vec<Sample> {
            let point = |k: usize| {
                let t = k as f32 / 30.0;
                let off = Vec3::Z * (4.0 * t * (1.0 - t));
                let position = at(from) + (at(to) - at(from)) * t + off + Vec3::Y * 0.05;
                Sample { position, pressure: 0.9, time: t, ..Sample::default() }
            };
            (0..=30).map(point).collect()
        };
        for (from, to) in [(0.3, 0.7), (0.7, 0.3), (0.0, 0.5), (0.4, 1.0)] {
            let after = whole::redrawn(stroke, &bow(from, to), 0.1).unwrap();
            lawful(stroke, &after);
            assert_eq!(ends(&after)[0], ends(stroke)[0], "{from} to {to}");
            assert!(near(ends(&after)[1], ends(stroke)[1]), "{from} to {to}");
            let middle = (at(from) + at(to)) * 0.5 + Vec3::Z;
            assert!(cvs::nearest(&after, middle).1 < 0.05);
            for sample in &stroke.samples {
                let part = cvs::nearest(stroke, sample.position).0 / length;
                if part < from.min(to) - 0.05 || part > from.max(to) + 0.05 {
                    assert!(after.samples.iter().any(|s| s.position == sample.position));
                }
            }
        }
        let mut away = bow(0.3, 0.7);
        away.iter_mut().for_each(|s| s.position.y += 1.0);
        assert_eq!(whole::redrawn(stroke, &away, 0.1), None);
        assert_eq!(whole::redrawn(stroke, &[], 0.1), None);
        assert_eq!(whole::redrawn(stroke, &bow(0.3, 0.7)[..1], 0.1), None);
    }
}

#[test]
fn a_mirrored_stroke_is_a_new_one_on_the_other_side() {
    let others = Strokes(strokes());
    for stroke in &others.0 {
        let twin = cvs::mirrored(stroke, &others);
        assert!(others.0.iter().all(|other| other.id != twin.id));
        lawful(&twin, &twin);
        for (a, b) in twin.samples.iter().zip(&stroke.samples) {
            assert_eq!(a.position, b.position * Vec3::new(-1.0, 1.0, 1.0));
            assert_eq!((a.tilt.x, a.tilt.y, a.time), (-b.tilt.x, b.tilt.y, b.time));
        }
        assert_eq!(twin.drawn.len(), stroke.drawn.len());
    }
}
