//! Parameterized strokes by the hundred, laws, and random walks.

use super::*;
use crate::maths::hash::Dice;
use crate::sketch::drawing::{DrawingStyle, TICK, arc, bow, coil, spiral, turn, zigzag};
use crate::sketch::stroke_shape::RHO;

/// Diameter in pixels of a cluster of 1 cm radius in a picture 1000 pixels high.
const DIAMETER: f32 = 50.0;

struct Case {
    name: String,
    how: String,
    samples: Vec<PenSample>,
    before: Option<Vec<PenSample>>,
    around: Around,
    /// `None`: ambiguous.
    right: Option<Tool>,
}

impl Case {
    fn guess(&self) -> Guess {
        classify(&self.samples, self.before.as_deref(), &self.around, RHO)
    }
}

/// The kinds of strokes in the table.
const KINDS: &[&str] = &[
    "coil",
    "circles on the spot",
    "scribble",
    "arc",
    "spiral",
    "density",
    "cut",
    "removal",
    "taps",
    "lengthen",
    "implant",
    "unsure",
];

/// The strokes of the table that are guessed wrong: currently none. 14 of 480 may be, none of them a cut.
const WRONG: &[&str] = &[];

const TIP: Around = Around {
    eraser: false,
    layer: Layer::Through,
    near_end: false,
    starts_on_scalp: true,
    crosses: true,
};
const ERASER: Around = Around { eraser: true, ..TIP };

/// One stroke of a kind.
fn case(seed: u64, kind: &str, i: u64) -> Case {
    let dice = Dice::new(seed, 0, kind);
    let pick = |k: u64, lo: f32, hi: f32| dice.range(i, k, lo, hi);
    // Small and large ones are equally frequent.
    let size =
        |lo: f32, hi: f32| lo * crate::maths::transcendental::pow(hi / lo, pick(0, 0.0, 1.0));
    let way = if dice.below(i, 1, 2) == 0 { 1.0 } else { -1.0 };
    let angle = pick(2, 0.0, 1.0);
    let light = if dice.below(i, 3, 2) == 0 { Layer::Nearest } else { Layer::Through };
    // As fast as its shape allows.
    let hand = |finest: f32| DrawingStyle {
        spacing: pick(4, 1.0, finest.clamp(1.5, 40.0)),
        tremor: pick(5, 0.0, 2.5),
        noise: pick(6, 0.0, 0.7),
        seed: dice.bits(i, 7),
    };
    let tip = Around { layer: light, near_end: dice.below(i, 8, 4) == 0, ..TIP };
    let hair = Around { near_end: false, ..tip };
    let eraser = Around { layer: light, ..ERASER };
    let any = |k: u64| match dice.below(i, k, 4) {
        0 => arc(size(20.0, 500.0), angle, [pick(10, -0.3, 0.3), pick(11, -0.3, 0.3)]),
        1 => coil(size(12.0, 60.0), 0.8, angle, way * pick(10, 1.5, 4.0), 0.0, turn(angle) * 40.0),
        2 => bow(size(20.0, 500.0), angle, pick(10, -0.1, 0.1), 0.0, 0.0),
        _ => spiral(size(20.0, 80.0), 100.0, way * 0.8, angle),
    };
    let stroke = |line: &[Vec2], hand: DrawingStyle, around: Around, right: Option<Tool>| Case {
        name: format!("{kind} {i}"),
        how: format!("{hand:.1?} {around:?}"),
        samples: hand.draw(line),
        before: None,
        around,
        right,
    };
    let tap = |k: u64, at: Vec2, start: f32, time: f32| -> Vec<PenSample> {
        let samples = ((time / TICK) as u64).max(1);
        (0..samples)
            .map(|n| PenSample {
                at: at + Vec2::new(pick(k + n * 2, -2.5, 2.5), pick(k + n * 2 + 1, -2.5, 2.5)),
                pressure: 0.4,
                time: start + n as f32 * TICK,
                tilt: Vec2::ZERO,
            })
            .collect()
    };
    let taps = |pause: f32, apart: f32, around: Around, right: Option<Tool>| {
        let (first, second) = (pick(20, 0.01, 0.24), pick(21, 0.01, 0.24));
        let samples = tap(100, turn(angle) * apart, 0.0, second);
        let before = tap(300, Vec2::ZERO, -pause - first, first);
        Case {
            samples,
            before: Some(before),
            ..stroke(&[Vec2::ZERO], DrawingStyle::still(1.0), around, right)
        }
    };
    match kind {
        "coil" => {
            let radius = size(8.0, 100.0);
            let drift = turn(pick(12, 0.0, 1.0)) * radius * pick(13, 0.3, 3.0);
            let turns = way * (dice.below(i, 14, 6) as f32 + pick(15, 1.5, 1.9));
            let line = coil(radius, pick(16, 0.6, 1.0), angle, turns, pick(17, 0.0, 1.0), drift);
            let hand = hand(radius * 0.6);
            // No hand turns on less than a few times its own tremor.
            let hand = DrawingStyle { tremor: hand.tremor.min(radius * 0.1), ..hand };
            stroke(&line, hand, tip, Some(Tool::Twist))
        }
        "circles on the spot" => {
            let radius = size(8.0, 100.0);
            let drift = turn(pick(12, 0.0, 1.0)) * radius * pick(13, 0.1, 0.3);
            let turns = way * (dice.below(i, 14, 5) as f32 + pick(15, 1.6, 2.4));
            let line = coil(radius, pick(16, 0.6, 1.0), angle, turns, pick(17, 0.0, 1.0), drift);
            let hand = hand(radius * 0.6);
            let hand = DrawingStyle { tremor: hand.tremor.min(radius * 0.1), ..hand };
            stroke(&line, hand, tip, Some(Tool::Twist))
        }
        "scribble" => {
            let width = size(0.25 * DIAMETER, 2.0 * DIAMETER);
            let (advance, bend) = (width * pick(12, 0.0, 0.6), pick(13, -0.25, 0.25));
            let sharp = dice.below(i, 14, 2) == 0;
            let line = zigzag(width, 3 + dice.below(i, 15, 10), angle, advance, bend, sharp);
            let hand = hand(width * 0.35);
            let hand = DrawingStyle { tremor: hand.tremor.min(width * 0.1), ..hand };
            stroke(&line, hand, tip, Some(Tool::Frizz))
        }
        "arc" => {
            let turns = match dice.below(i, 12, 3) {
                0 => [0.0; 2],
                1 => [pick(13, -0.35, 0.35); 2],
                _ => [pick(13, 0.1, 0.4) * way, pick(14, -0.4, -0.1) * way],
            };
            stroke(&arc(size(30.0, 600.0), angle, turns), hand(40.0), hair, Some(Tool::Comb))
        }
        "spiral" => {
            let (outer, turns) = (size(25.0, 200.0), way * pick(12, 0.5, 300.0 / 360.0));
            let inner = outer * pick(13, 0.3, 0.6);
            let ends = if dice.below(i, 14, 2) == 0 { (inner, outer) } else { (outer, inner) };
            let line = spiral(ends.0, ends.1, turns, angle);
            stroke(&line, hand(outer * 0.5), hair, Some(Tool::Comb))
        }
        "density" => {
            let radius = size(15.0, 200.0);
            let drift = turn(pick(12, 0.0, 1.0)) * radius * pick(13, 0.0, 0.6);
            let turns = way * (dice.below(i, 14, 6) as f32 + pick(15, 1.0, 1.2));
            let line = coil(radius, pick(16, 0.55, 1.0), angle, turns, pick(17, 0.0, 1.0), drift);
            let crosses = dice.below(i, 18, 2) == 0;
            stroke(&line, hand(radius * 0.6), Around { crosses, ..eraser }, Some(Tool::Density))
        }
        "cut" => {
            let line = bow(size(30.0, 500.0), angle, way * pick(12, 0.0, 0.06), 0.0, 0.0);
            stroke(&line, hand(40.0), eraser, Some(Tool::Cut))
        }
        "removal" => {
            let line = bow(size(30.0, 300.0), angle, way * pick(12, 0.0, 0.06), 0.0, 0.0);
            let around =
                Around { layer: Layer::Scalp, crosses: dice.below(i, 13, 2) == 0, ..ERASER };
            stroke(&line, hand(40.0), around, Some(Tool::Cut))
        }
        "taps" => taps(pick(12, 0.05, 0.38), pick(13, 0.0, 8.0), tip, Some(Tool::Pin)),
        "lengthen" => {
            let line =
                arc(size(20.0, 500.0), angle, [pick(10, -0.35, 0.35), pick(11, -0.35, 0.35)]);
            let around = Around { layer: Layer::Nearest, near_end: true, ..TIP };
            stroke(&line, hand(40.0), around, Some(Tool::Lengthen))
        }
        "implant" => {
            let around = Around { layer: Layer::Scalp, ..tip };
            stroke(&any(12), hand(20.0), around, Some(Tool::Implant))
        }
        _ => match i % 10 {
            // Half a circle, and strokes that bend too much for a cut.
            0 => stroke(&arc(size(60.0, 500.0), angle, [way * 0.25; 2]), hand(40.0), eraser, None),
            1 => {
                let line = bow(size(40.0, 500.0), angle, way * pick(12, 0.2, 0.35), 0.0, 0.0);
                stroke(&line, hand(40.0), eraser, None)
            }
            2 => {
                let (wave, times) = (pick(12, 0.14, 0.3), pick(13, 1.5, 3.0));
                let line = bow(size(60.0, 500.0), angle, 0.0, wave, times);
                stroke(&line, hand(30.0), eraser, None)
            }
            3 => {
                let line = bow(size(30.0, 500.0), angle, 0.0, 0.0, 0.0);
                stroke(&line, hand(40.0), Around { crosses: false, ..eraser }, None)
            }
            4 => {
                let around = Around { layer: Layer::Scalp, starts_on_scalp: false, ..tip };
                stroke(&any(12), hand(20.0), around, None)
            }
            5 => Case { before: None, ..taps(0.1, 0.0, tip, None) },
            6 => taps(pick(12, 0.45, 2.0), 0.0, tip, None),
            7 => taps(0.1, pick(12, 18.0, 200.0), tip, None),
            8 => taps(0.1, 0.0, eraser, None),
            _ => {
                let width = size(15.0, 100.0);
                let line = zigzag(width, 3 + dice.below(i, 15, 6), angle, width * 0.3, 0.0, true);
                stroke(&line, hand(width * 0.35), eraser, None)
            }
        },
    }
}

/// Names of wrongly guessed strokes, with this many of each kind. None of them may cut.
fn wrong(seed: u64, each: u64) -> Vec<String> {
    let mut wrong = vec![];
    for case in KINDS.iter().flat_map(|kind| (0..each).map(move |i| case(seed, kind, i))) {
        let guess = case.guess();
        let right = match (guess, case.right) {
            (Guess::Is(tool), Some(right)) => tool == right,
            // Why and, after the colon, what to do.
            (Guess::Unsure(why), None) => why.contains(':'),
            _ => false,
        };
        if !right {
            println!("{}: {guess:?}, {}", case.name, case.how);
            assert_ne!(guess, Guess::Is(Tool::Cut), "{}: cuts by mistake", case.name);
            wrong.push(case.name);
        }
    }
    wrong
}

#[test]
fn a_table_of_480_strokes_is_guessed_right_but_for_these() {
    assert_eq!(wrong(1, 40), WRONG);
    assert!(WRONG.len() * 100 <= KINDS.len() * 40 * 3);
}

#[test]
#[ignore = "long"]
fn at_most_three_in_a_hundred_of_each_kind_are_guessed_wrong() {
    for seed in 2..12 {
        let wrong = wrong(seed, 400);
        for kind in KINDS {
            let of_kind = wrong.iter().filter(|name| name.starts_with(kind)).count();
            println!("seed {seed}, {kind}: {of_kind} of 400 wrong");
            assert!(of_kind <= 12, "seed {seed}, {kind}: {of_kind} of 400");
        }
    }
}

#[test]
fn the_eraser_and_the_tip_have_tools_of_their_own_whatever_is_drawn() {
    for mut case in KINDS.iter().flat_map(|kind| (0..40).map(move |i| case(3, kind, i))) {
        for layer in [Layer::Nearest, Layer::Through, Layer::Scalp] {
            for eraser in [false, true] {
                case.around = Around { eraser, layer, ..case.around };
                if let Guess::Is(tool) = case.guess() {
                    let erases = matches!(tool, Tool::Cut | Tool::Density);
                    assert_eq!(erases, eraser, "{}: {tool:?}", case.name);
                }
            }
        }
    }
}

#[test]
fn a_stroke_means_the_same_larger_and_mirrored() {
    for case in KINDS.iter().flat_map(|kind| (0..40).map(move |i| case(4, kind, i))) {
        for (scale, mirror) in [(0.25, 1.0), (3.0, 1.0), (1.0, -1.0)] {
            let changed = |samples: &[PenSample]| -> Vec<PenSample> {
                let place = |p: Vec2| Vec2::new(p.x, p.y * mirror) * scale;
                samples.iter().map(|s| PenSample { at: place(s.at), ..*s }).collect()
            };
            let before = case.before.as_deref().map(changed);
            let guess =
                classify(&changed(&case.samples), before.as_deref(), &case.around, RHO * scale);
            assert_eq!(guess, case.guess(), "{}: {scale} {mirror}", case.name);
        }
    }
}

#[test]
fn nothing_but_a_straight_stroke_of_the_eraser_through_hair_or_on_the_scalp_cuts() {
    let mut cuts = 0;
    for i in 0..10_000 {
        let dice = Dice::new(5, i, "garbage");
        // Walks with random turns and strides, some nearly straight.
        let (bend, stride) = (dice.unit(0, 0), dice.range(0, 1, 0.1, 40.0));
        let (mut at, mut way) = (Vec2::ZERO, dice.unit(0, 2));
        let samples: Vec<PenSample> = (0..u64::from(dice.below(0, 3, 60)))
            .map(|k| {
                way += dice.signed(1, k) * (bend * bend * bend);
                at += turn(way) * stride * dice.unit(2, k);
                PenSample { at, time: k as f32 * TICK, ..Default::default() }
            })
            .collect();
        let yes = |k: u64| dice.below(3, k, 2) == 0;
        let around = Around {
            eraser: yes(0),
            layer: Layer::ALL[dice.below(3, 1, 3) as usize].0,
            near_end: yes(2),
            starts_on_scalp: yes(3),
            crosses: yes(4),
        };
        if classify(&samples, None, &around, RHO) == Guess::Is(Tool::Cut) {
            cuts += 1;
            assert!(around.eraser && (around.crosses || around.layer == Layer::Scalp));
            let (first, last) = (samples[0].at, samples[samples.len() - 1].at);
            let chord = first.distance(last);
            let off = |s: &PenSample| (last - first).perp_dot(s.at - first).abs() / chord;
            // The allowed bow, not counting tremor at the ends: a twelfth, and 0.08 of 30.
            assert!(samples.iter().all(|s| off(s) <= chord / 12.0 + 4.0), "garbage {i} cuts");
        }
    }
    assert!(cuts > 100, "{cuts} cuts: too few to tell");
}

#[test]
fn what_was_not_done_is_said_with_what_to_do() {
    #[track_caller]
    fn check(line: &[Vec2], around: Around, expected: &str) {
        match classify(&DrawingStyle::still(5.0).draw(line), None, &around, RHO) {
            Guess::Unsure(why) => assert!(why.contains(expected), "{why:?}: expected {expected:?}"),
            guess => panic!("{guess:?}"),
        }
    }
    let straight = bow(200.0, 0.1, 0.0, 0.0, 0.0);
    let missed = Around { crosses: false, ..ERASER };
    check(&straight, missed, "crosses no hair: begin on one side of a cluster");
    let off = Around { starts_on_scalp: false, layer: Layer::Scalp, ..missed };
    check(&straight, off, "neither scalp nor hair: draw it across the roots");
    check(&straight, Around { eraser: false, ..off }, "begins off the scalp: begin on it to plant");
    check(&bow(200.0, 0.1, 0.2, 0.0, 0.0), ERASER, "not straight enough to cut: draw it straight");
    check(&arc(200.0, 0.1, [0.25; 2]), ERASER, "Neither a cut nor a circle: draw straight");
    check(&straight[..1], TIP, "One tap does nothing: tap twice");
    check(&straight[..1], ERASER, "A tap of the eraser does nothing: draw");
    check(&bow(8.0, 0.1, 0.0, 0.0, 0.0), TIP, "One tap");
    let none = classify(&[], None, &TIP, RHO);
    assert_eq!(none, Guess::Unsure("Nothing was drawn: draw a stroke over the hair"));
}
