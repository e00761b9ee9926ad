//! Shapes of strokes, computed by hand, and as drawn by a shaky hand.

use super::*;
use crate::maths::hash::Dice;
use crate::sketch::drawing::{DrawingStyle, arc, bow, coil, turn, zigzag};

/// A fast, shaky hand.
fn shaky(seed: u64) -> DrawingStyle {
    DrawingStyle { spacing: 4.0, tremor: 1.5, noise: 0.5, seed }
}

fn mirrored(points: &[Vec2]) -> Vec<Vec2> {
    points.iter().map(|p| Vec2::new(p.x, -p.y)).collect()
}

#[test]
fn every_segment_of_a_resampled_stroke_is_one_step_and_the_rest_is_dropped() {
    let corner = [Vec2::ZERO, Vec2::new(40.0, 0.0), Vec2::new(40.0, 45.0)];
    // 30 along the first side; then the point of the second that is 30 from (30, 0): 10 across and 800^(1/2) = 28.284
    // down; the last 16.7 are less than a step.
    let even = resampled(&corner, 30.0);
    assert_eq!(even.len(), 3);
    assert_eq!(even[..2], [Vec2::ZERO, Vec2::new(30.0, 0.0)]);
    assert!(even[2].distance(Vec2::new(40.0, 28.284_27)) < 1e-4);
    for i in 0..50 {
        let points = shaky(i).places(&arc(400.0, 0.1, [0.4, -0.3]));
        let even = resampled(&points, 7.0);
        assert!(even.windows(2).all(|w| (w[0].distance(w[1]) - 7.0).abs() < 1e-3));
        assert!(even[even.len() - 1].distance(points[points.len() - 1]) < 7.0);
    }
    assert_eq!(resampled(&[], 30.0), []);
    assert_eq!(resampled(&corner, 0.0), [Vec2::ZERO]);
    assert_eq!(resampled(&corner, f32::NAN), [Vec2::ZERO]);
    assert_eq!(resampled(&corner, 100.0), [Vec2::ZERO]);
    assert_eq!(resampled(&corner, 1e-30).len(), MOST_RESAMPLED);
}

#[test]
fn full_circles_count_clockwise_less_counter_clockwise_ones_once_each_is_closed() {
    #[track_caller]
    fn check(line: &[Vec2], expected: i32) {
        for seed in 0..4 {
            let points = shaky(seed).places(line);
            assert_eq!(full_circles(&points, RHO), expected);
            assert_eq!(full_circles(&mirrored(&points), RHO), -expected, "mirrored");
        }
    }
    let drift = Vec2::new(20.0, 10.0);
    for n in 1..=6 {
        check(&coil(50.0, 1.0, 0.0, n as f32 + 0.1, 0.3, Vec2::ZERO), n);
        check(&coil(80.0, 0.5, 0.15, -(n as f32) - 0.1, 0.7, drift), -n);
        // Three quarters more are not another circle.
        check(&coil(60.0, 0.8, 0.3, n as f32 + 0.75, 0.0, drift), n);
    }
    check(&coil(60.0, 1.0, 0.0, 0.8, 0.0, Vec2::ZERO), 0);
    check(&bow(300.0, 0.2, 0.0, 0.0, 0.0), 0);
    check(&zigzag(60.0, 9, 0.2, 20.0, 0.0, false), 0);
    // Two clockwise from the top, then one counterclockwise that leaves the first's side: 1.
    let mut both = coil(50.0, 1.0, 0.0, 2.0, 0.75, Vec2::ZERO);
    both.extend(coil(50.0, 1.0, 0.0, -1.1, 0.25, Vec2::ZERO).iter().map(|p| *p - Vec2::Y * 100.0));
    check(&both, 1);
    // A lead-in of twice the radius is not part of the circle.
    let mut way_in = vec![Vec2::new(-120.0, -60.0)];
    way_in.extend(coil(60.0, 1.0, 0.0, 1.05, 0.75, Vec2::ZERO));
    check(&way_in, 1);
}

#[test]
fn each_turn_of_a_twirl_is_a_loop_with_its_place_and_way_round() {
    // A coil of radius 20 that advances by 60 per turn: it crosses itself below each centre where the hand moves back.
    for n in 1..=6 {
        let line = coil(20.0, 1.0, 0.0, n as f32, 0.75, Vec2::X * 60.0);
        for seed in 0..4 {
            let points = DrawingStyle { tremor: 1.0, spacing: 3.0, ..shaky(seed) }.places(&line);
            for (points, sign) in [(points.clone(), 1.0), (mirrored(&points), -1.0)] {
                let found = loops(&points, RHO);
                assert_eq!(found.len(), n, "{found:?}");
                for (k, one) in found.iter().enumerate() {
                    assert_eq!(one.sign, sign);
                    // Midway between the extremes of its loop: half a turn after it began at the top.
                    assert!((one.at.x - (k as f32 + 0.5) * 60.0).abs() < 4.0, "{one:?}");
                }
            }
        }
    }
}

#[test]
fn turns_over_the_same_ground_count_once_each() {
    for n in 1..=6 {
        for seed in 0..8 {
            let line = coil(40.0, 0.9, 0.1, n as f32 + 0.5, 0.0, Vec2::new(6.0, 3.0));
            let found = loops(&shaky(seed).places(&line), RHO).len();
            assert!(found.abs_diff(n) <= 1, "{n} turns: {found}");
            // Their paths differ only by tremor.
            let line = coil(40.0, 0.9, 0.1, n as f32 + 0.5, 0.0, Vec2::ZERO);
            let found = loops(&shaky(seed).places(&line), RHO).len();
            assert!(found.abs_diff(n) <= 1, "{n} turns on the spot: {found}");
        }
    }
}

#[test]
fn a_circle_that_closes_without_crossing_itself_is_a_loop() {
    for (turns, count) in [(1.0, 1), (0.99, 1), (2.0, 2), (0.9, 0)] {
        for sign in [1.0, -1.0] {
            let line = coil(40.0, 1.0, 0.0, sign * turns, 0.3, Vec2::ZERO);
            let found = loops(&DrawingStyle::still(3.0).places(&line), RHO);
            assert_eq!(found.len(), count, "{turns}: {found:?}");
            assert!(found.iter().all(|one| one.sign == sign), "{turns}: {found:?}");
        }
    }
}

#[test]
fn what_is_no_loop() {
    #[track_caller]
    fn check(line: &[Vec2], hand: DrawingStyle) {
        assert_eq!(loops(&hand.places(line), RHO), []);
    }
    for seed in 0..8 {
        check(
            &bow(400.0, 0.3, 0.05, 0.0, 0.0),
            DrawingStyle { spacing: 1.0, tremor: 2.5, ..shaky(seed) },
        );
        // There and back: its halves cross, and enclose next to nothing.
        let way = bow(300.0, 0.3, 0.0, 0.02, 2.0);
        check(&[way.clone(), way.iter().rev().copied().collect()].concat(), shaky(seed));
        // 12 pixels around: tremor.
        check(&coil(1.9, 1.0, 0.0, 4.0, 0.25, Vec2::X * 6.0), DrawingStyle::still(0.5));
    }
}

#[test]
fn a_scribble_has_its_width_and_its_reversals() {
    for seed in 0..200 {
        let dice = Dice::new(seed, 0, "scribble");
        let pick = |k: u64, lo: f32, hi: f32| dice.range(0, k, lo, hi);
        let (width, reversals) = (pick(0, 20.0, 100.0), 3 + dice.below(0, 1, 10));
        let advance = width * pick(2, 0.0, 0.4);
        let line = zigzag(width, reversals, pick(3, 0.0, 1.0), advance, pick(4, -0.1, 0.1), true);
        let hand = DrawingStyle { spacing: width * 0.08, tremor: width * 0.03, noise: 0.5, seed };
        let found = scribble(&hand.places(&line), RHO).expect("a scribble");
        assert_eq!(found.reversals, reversals);
        let off = (found.amplitude - width).abs();
        assert!(off <= width * 0.1 + 1.0, "{found:?}: {width} wide");
    }
    // Too few; around and around; a wave longer than it is wide belongs to a comb.
    let none = |line: &[Vec2]| assert_eq!(scribble(&shaky(1).places(line), RHO), None);
    none(&zigzag(60.0, 2, 0.1, 10.0, 0.0, true));
    none(&coil(40.0, 0.6, 0.2, 4.5, 0.0, Vec2::new(10.0, 0.0)));
    none(&zigzag(40.0, 8, 0.1, 60.0, 0.0, false));
}

#[test]
fn straightness_is_chord_length_and_bow() {
    // A right angle of 30 and 40: chord 50 of 70, and its corner 30 * 40 / 50 = 24 from it.
    let corner = [Vec2::ZERO, Vec2::new(30.0, 0.0), Vec2::new(30.0, 40.0)];
    let found = straightness(&corner, 3.0);
    assert_eq!(found.chord, 50.0);
    assert!((found.chord_by_length - 50.0 / 70.0).abs() < 0.01, "{found:?}");
    assert!((found.bow - 24.0).abs() < 0.5, "{found:?}");
    // Tremor adds next to nothing to the length.
    let found = straightness(&shaky(3).places(&bow(300.0, 0.3, 0.0, 0.0, 0.0)), RHO);
    assert!(found.chord_by_length > 0.97 && found.bow < 4.0, "{found:?}");
}

#[test]
fn strokes_that_are_hardly_any_and_the_largest_have_shapes_too() {
    let far = |i: u64| {
        let dice = Dice::new(9, 0, "far");
        Vec2::new(dice.signed(i, 0), dice.signed(i, 1)) * 1e5
    };
    let strokes = [
        vec![],
        vec![Vec2::ONE],
        vec![Vec2::ONE; 1000],
        vec![Vec2::ZERO, Vec2::splat(1e5), Vec2::ZERO, Vec2::splat(1e5)],
        (0..100_000).map(far).collect(),
        (0..100_000).map(|i| turn(i as f32 * 1e-3) * (100.0 + i as f32 * 0.9)).collect(),
    ];
    for stroke in &strokes {
        for rho in [RHO, 1e-20, 1e20, 0.0, -1.0, f32::INFINITY] {
            full_circles(stroke, rho);
            loops(stroke, rho);
            scribble(stroke, rho);
            assert!(straightness(stroke, rho).bow.is_finite());
        }
        assert!(resampled(stroke, RHO).len() <= MOST_RESAMPLED);
    }
    for stroke in &strokes[..3] {
        assert_eq!((full_circles(stroke, RHO), loops(stroke, RHO)), (0, vec![]));
        assert_eq!((scribble(stroke, RHO), straightness(stroke, RHO)), (None, Default::default()));
    }
}
