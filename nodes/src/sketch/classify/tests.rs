use super::*;
use crate::maths::hash::Dice;
use crate::sketch::hand::{Hand, TICK, arc, bow, coil, spiral, turn, zigzag};
use crate::sketch::stroke_shape::RHO;

/// Pixels across a cluster of 1 cm radius in a picture 1000 pixels high.
const DIAMETER: f32 = 50.0;

struct Case {
    name: String,
    how: String,
    samples: Vec<PenSample>,
    before: Option<Vec<PenSample>>,
    around: Around,
    /// None: unsure.
    right: Option<Tool>,
}

impl Case {
    fn guess(&self) -> Guess {
        classify(&self.samples, self.before.as_deref(), &self.around, RHO)
    }
}

/// The kinds of strokes in the table.
const KINDS: &[&str] = &[
    "coil", "circles on the spot", "scribble", "arc", "spiral", "density", "cut", "removal", "taps",
    "lengthen", "implant", "unsure",
];

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
    // Small and large ones are as frequent.
    let size = |lo: f32, hi: f32| lo * crate::maths::transcendental::pow(hi / lo, pick(0, 0.0, 1.0));
    let way = if dice.below(i, 1, 2) == 0 { 1.0 } else { -1.0 };
    let angle = pick(2, 0.0, 1.0);
    let light = if dice.below(i, 3, 2) == 0 { Layer::Nearest } else { Layer::Through };
    // As fast as its shape lets a hand be.
    let hand = |finest: f32| Hand {
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
    let stroke = |line: &[Vec2], hand: Hand, around: Around, right: Option<Tool>| Case {
        name: format!("{kind} {i}"),
        how: format!("{line:.0?} {hand:.1?}").replace(' ', "").chars().take(0).collect::<String>()
            + &format!("{hand:.1?} {:?} size {:.0}", around.layer, size(0.001, 1.0) * 1000.0),
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
        Case { samples, before: Some(before), ..stroke(&[Vec2::ZERO], Hand::still(1.0), around, right) }
    };
    match kind {
        "coil" => {
            let radius = size(8.0, 100.0);
            let drift = turn(pick(12, 0.0, 1.0)) * radius * pick(13, 0.3, 3.0);
            let turns = way * (dice.below(i, 14, 6) as f32 + pick(15, 1.5, 1.9));
            let line = coil(radius, pick(16, 0.6, 1.0), angle, turns, pick(17, 0.0, 1.0), drift);
            let hand = hand(radius * 0.6);
            // No hand turns on less than a few times its own tremor.
            let hand = Hand { tremor: hand.tremor.min(radius * 0.1), ..hand };
            stroke(&line, hand, tip, Some(Tool::Twist))
        }
        "circles on the spot" => {
            let radius = size(8.0, 100.0);
            let drift = turn(pick(12, 0.0, 1.0)) * radius * pick(13, 0.1, 0.3);
            let turns = way * (dice.below(i, 14, 5) as f32 + pick(15, 1.6, 2.4));
            let line = coil(radius, pick(16, 0.6, 1.0), angle, turns, pick(17, 0.0, 1.0), drift);
            let hand = hand(radius * 0.6);
            let hand = Hand { tremor: hand.tremor.min(radius * 0.1), ..hand };
            stroke(&line, hand, tip, Some(Tool::Twist))
        }
        "scribble" => {
            let width = size(0.25 * DIAMETER, 2.0 * DIAMETER);
            let (advance, bend) = (width * pick(12, 0.0, 0.6), pick(13, -0.25, 0.25));
            let sharp = dice.below(i, 14, 2) == 0;
            let line = zigzag(width, 3 + dice.below(i, 15, 10), angle, advance, bend, sharp);
            let hand = hand(width * 0.35);
            let hand = Hand { tremor: hand.tremor.min(width * 0.1), ..hand };
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
            let around = Around { layer: Layer::Scalp, crosses: dice.below(i, 13, 2) == 0, ..ERASER };
            stroke(&line, hand(40.0), around, Some(Tool::Cut))
        }
        "taps" => taps(pick(12, 0.05, 0.4), pick(13, 0.0, 8.0), tip, Some(Tool::Pin)),
        "lengthen" => {
            let line = arc(size(20.0, 500.0), angle, [pick(10, -0.35, 0.35), pick(11, -0.35, 0.35)]);
            let around = Around { layer: Layer::Nearest, near_end: true, ..TIP };
            stroke(&line, hand(40.0), around, Some(Tool::Lengthen))
        }
        "implant" => {
            let around = Around { layer: Layer::Scalp, ..tip };
            stroke(&any(12), hand(20.0), around, Some(Tool::Implant))
        }
        _ => match i % 10 {
            // Half a circle, and what bends too far for a cut.
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

/// Names of the strokes of the table that are guessed wrong, and how many there are.
fn wrong(seed: u64, each: u64) -> (Vec<String>, usize) {
    let mut wrong = vec![];
    for kind in KINDS {
        for i in 0..each {
            let case = case(seed, kind, i);
            let guess = case.guess();
            let right = match (guess, case.right) {
                (Guess::Is(tool), Some(right)) => tool == right,
                (Guess::Unsure(why), None) => why.contains(':'),
                _ => false,
            };
            if !right {
                println!("{}: {guess:?}, {}", case.name, case.how);
                assert_ne!(guess, Guess::Is(Tool::Cut), "{}: hair is cut by mistake", case.name);
                wrong.push(case.name);
            }
        }
    }
    (wrong, KINDS.len() * each as usize)
}

#[test]
fn the_table() {
    let (wrong, all) = wrong(1, 400);
    println!("{} of {all}", wrong.len());
    for kind in KINDS {
        println!("{kind}: {}", wrong.iter().filter(|w| w.starts_with(kind)).count());
    }
}
