//! The grid and finishing of gestures.

use super::super::testing::Random;
use super::*;
use crate::values::grid::{gestures_on_grid, point_of, point_steps};
use coif_nodes::data::gestures::{GestureView, Layer, Tool};
use glam::{Vec2, Vec3};
use std::sync::Arc;

fn comb(samples: Vec<PenSample>) -> Gesture {
    let view = GestureView {
        eye: Vec3::Z * 60.0,
        target: Vec3::ZERO,
        up: Vec3::Y,
        half_height: 0.25,
        parallel: false,
        pixels: 1000.0,
    };
    Gesture {
        id: 0,
        tool: Tool::Comb,
        layer: Layer::Through,
        view,
        samples,
        curves: vec![],
        root: None,
        path: vec![],
        colour: None,
        size: 0.0,
        strength: 1.0,
    }
}
fn at(x: f32, y: f32) -> PenSample {
    PenSample { at: Vec2::new(x, y), pressure: 0.5, ..PenSample::default() }
}

#[test]
fn a_finished_gesture_is_within_half_a_pixel_of_every_sample_and_much_shorter() {
    let (mut worst, mut given, mut kept) = (0.0f32, 0, 0);
    for seed in 0..20 {
        let samples = Random::new(seed).pen_on_picture(300);
        let gesture = finish(comb(samples.clone()), &Gestures::default()).unwrap();
        given += samples.len();
        kept += gesture.samples.len();
        let to = |p: Vec2, a: Vec2, b: Vec2| {
            let t = (p - a).dot(b - a) / (b - a).length_squared().max(1e-9);
            (a + (b - a) * t.clamp(0.0, 1.0)).distance(p)
        };
        for sample in &samples {
            let ends = gesture.samples.windows(2).map(|w| to(sample.at, w[0].at, w[1].at));
            worst = worst.max(ends.fold(f32::INFINITY, f32::min));
        }
        assert_eq!(gesture.fault(), None);
        let list = Arc::new(Gestures(vec![gesture]));
        assert!(Arc::ptr_eq(&list, &gestures_on_grid(list.clone())), "off the grid");
    }
    assert!(worst <= TOLERANCE, "{worst}");
    assert!(kept * 2 < given, "{kept} of {given}");
}

#[test]
fn each_number_is_on_its_grid() {
    // An eighth of a pixel, a 256th, a millisecond, a 64th: 10.07 * 8 = 80.56 is 81 steps, 10.125;
    // 0.3 * 256 = 76.8, 77; 1.2346 s is 1.235; 0.3 * 64 = 19.2, 19; a path's 1.23456 is 1.2346.
    let tilt = Vec2::new(0.3, -0.3);
    let sample = PenSample { at: Vec2::new(10.07, -10.07), pressure: 0.3, time: 1.2346, tilt };
    let given = Gesture { path: vec![Vec3::new(1.23456, -0.0, 0.0)], ..comb(vec![sample]) };
    let gesture = finish(given, &Gestures::default()).unwrap();
    let tilt = Vec2::new(19.0 / 64.0, -19.0 / 64.0);
    let at = Vec2::new(10.125, -10.125);
    let expected = PenSample { at, pressure: 77.0 / 256.0, time: 1.235, tilt };
    assert_eq!(gesture.samples, [expected]);
    assert_eq!(
        gesture.path[0].to_array().map(f32::to_bits),
        [1.2346f32, 0.0, 0.0].map(f32::to_bits)
    );
}

#[test]
fn the_grid_holds_what_is_on_it() {
    let mut random = Random::new(9);
    for most in [1.0, 60.0, 900.0, 1100.0, 1800.0, 1e5] {
        for _ in 0..1000 {
            let mut any = || (random.unit() - 0.5) * 2.0 * most;
            let point = Vec3::new(any(), any(), any());
            let once = point_of(point_steps(point));
            assert_eq!(point_of(point_steps(once)), once);
            let sample = PenSample { at: point.truncate(), time: any().abs(), ..at(0.0, 0.0) };
            let once = sample_of(sample_steps(&sample));
            assert_eq!(sample_of(sample_steps(&once)), once);
        }
    }
}

#[test]
fn time_runs_on_and_what_is_no_number_is_left_out() {
    // The clock of the pen goes back by 2 s in the third sample: it waits for the fourth.
    let times = [0.0, 3.0, 1.0, f32::NAN, 4.0];
    let corner = |i: usize| at(i as f32 * 10.0, (i % 2) as f32 * 30.0);
    let sample = |(i, time): (usize, f32)| PenSample { time, ..corner(i) };
    let samples = times.into_iter().enumerate().map(sample).collect();
    let gesture = finish(comb(samples), &Gestures::default()).unwrap();
    let kept: Vec<(f32, f32)> = gesture.samples.iter().map(|s| (s.at.x, s.time)).collect();
    assert_eq!(kept, [(0.0, 0.0), (10.0, 3.0), (20.0, 3.0), (40.0, 4.0)]);
    let none = Gestures::default();
    assert_eq!(finish(comb(vec![]), &none), None);
    assert_eq!(finish(comb(vec![at(f32::NAN, 0.0)]), &none), None);
    let mut blind = comb(vec![at(0.0, 0.0)]);
    blind.view.pixels = 0.0;
    assert_eq!(finish(blind, &none), None);
}

#[test]
fn what_is_too_far_off_is_left_to_be_refused() {
    let far = Gestures(vec![Gesture { id: 1, ..comb(vec![at(2e5, 0.1)]) }]);
    let kept = gestures_on_grid(Arc::new(far.clone()));
    assert_eq!(*kept, far);
    assert!(kept.fault().is_some());
}

#[test]
fn ids_differ_within_a_list_and_are_the_same_in_a_replay() {
    let samples = Random::new(2).pen_on_picture(30);
    let mut all = Gestures::default();
    for _ in 0..5 {
        let gesture = finish(comb(samples.clone()), &all).unwrap();
        // What it came with says nothing.
        let again = Gesture { id: 77, ..comb(samples.clone()) };
        assert_eq!(finish(again, &all), Some(gesture.clone()));
        all.0.push(gesture);
    }
    assert_eq!(all.fault(), None);
    let other = Gesture { tool: Tool::Cut, ..comb(samples) };
    let none = Gestures::default();
    assert_ne!(finish(other, &none).unwrap().id, all.0[0].id);
}
