//! The laws of curls (methods.md 4), asserted on what the node gives. Tests only.

use super::section::entries;
use super::shape_list_curl::NODE;
use super::winding::{Detail, Pattern};
use crate::data::attributes::{Domain, ID, PARENT};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::shapes::{Section, ShapeList, Tier};
use crate::define::Value;
use crate::maths::hash::Dice;
use crate::maths::spline::{Place, Spline};
use crate::testing::{curves_of, run};
use glam::{Vec2, Vec3};

fn one(points: &[Vec3]) -> Curves {
    let mut b = TuftBuilder::new();
    b.push_curve(points);
    b.set(ID, Domain::Curve, vec![7]);
    b.set(PARENT, Domain::Curve, vec![3]);
    Curves::new(vec![b.build().into()])
}

/// A straight source of `length` cm along Y.
fn straight(length: usize) -> Curves {
    one(&(0..=length).map(|k| Vec3::Y * k as f32).collect::<Vec<_>>())
}

/// Sources that bend this way and that.
fn bent(id: u64) -> Curves {
    let dice = Dice::new(9, 0, "source");
    let mut p = Vec3::ZERO;
    let points: Vec<Vec3> = (0..14u64)
        .map(|k| {
            let step = |a| dice.signed(id, 3 * k + a) * 0.7;
            p += Vec3::new(step(0), 1.0 + 0.3 * step(1), step(2));
            p
        })
        .collect();
    one(&points)
}

/// The curl of a source with a preset's numbers replaced.
fn curled(source: &Curves, preset: &str, set: &[(&str, Value)]) -> Vec<Vec3> {
    let base = [("curves", source.clone().into()), ("preset", preset.into())];
    let (out, _) = run(&NODE, &[&base, set].concat());
    curves_of(&out[0]).tufts()[0].curve(0).to_vec()
}

/// One shape, nothing random, nothing blended.
fn pure(section: Section) -> Vec<(&'static str, Value)> {
    let zero =
        ["z_bends", "switchbacks", "skipped", "spread", "amplitude_range", "frequency_range"];
    let more = ["phase_range", "offset_range", "blend"];
    let mut set: Vec<(&str, Value)> =
        zero.iter().chain(&more).map(|name| (*name, Value::Float(0.0))).collect();
    set.push(("shapes", ShapeList(vec![(Tier::A, section)]).into()));
    set.push(("uniformity", Value::Float(1.0)));
    set.push(("definition", Value::Float(1.0)));
    set.push(("rise", Value::Float(0.25)));
    set.push(("phase_lock", "all".into()));
    set.push(("hand", "right".into()));
    set
}

#[test]
fn a_circle_at_full_uniformity_is_the_exact_helix() {
    let set = [
        &pure(Section::Circle)[..],
        &[("diameter", Value::Float(1.0)), ("pitch", Value::Float(2.0))],
    ]
    .concat();
    let points = curled(&straight(20), "custom", &set);
    let angle =
        |p: Vec3| f64::from(crate::maths::transcendental::atan2(p.z, p.x)) / std::f64::consts::TAU;
    let inner: Vec<Vec3> = points.iter().copied().filter(|p| (3.0..18.0).contains(&p.y)).collect();
    assert!(inner.len() > 80);
    for pair in inner.windows(2) {
        assert!((Vec2::new(pair[0].x, pair[0].z).length() - 0.5).abs() < 1e-4, "{}", pair[0]);
        let turn = angle(pair[1]) - angle(pair[0]);
        let turn = (turn - turn.round()).abs();
        let want = f64::from((pair[1].y - pair[0].y) / 2.0);
        assert!((turn - want).abs() < 1e-4, "{}: {turn} {want}", pair[0]);
    }
}

#[test]
fn the_rms_radius_is_half_the_diameter_whatever_the_shape() {
    let sections = [
        Section::Circle,
        Section::Ellipse(0.3),
        Section::Lame(0.7),
        Section::Lame(4.0),
        Section::Polygon(3),
        Section::Polygon(5),
        Section::Rose { petals: 3, depth: 0.6 },
        Section::Rose { petals: 5, depth: 0.3 },
    ];
    for section in sections {
        let shown = format!("{section:?}");
        let sizes = [
            ("diameter", Value::Float(1.0)),
            ("pitch", Value::Float(0.02)),
            ("points_per_turn", Value::Float(64.0)),
        ];
        let points = curled(&straight(2), "custom", &[&pure(section)[..], &sizes].concat());
        let spline = Spline::new(&points).unwrap();
        let (mut sum, mut length) = (0.0f64, 0.0f64);
        let mut last: Option<Vec3> = None;
        for span in 0..spline.span_count() {
            for k in 0..4 {
                let p = spline.point(Place { span, t: k as f32 / 4.0 });
                // Fifty whole turns of the full-amplitude part.
                if (0.5..1.5).contains(&p.y) {
                    if let Some(last) = last {
                        // Turns run evenly along the source: so does the weight.
                        let step = f64::from(p.y - last.y);
                        sum += step * f64::from(p.x * p.x + p.z * p.z);
                        length += step;
                    }
                    last = Some(p);
                }
            }
        }
        let rms = (sum / length).sqrt();
        assert!((rms / 0.5 - 1.0).abs() < 0.01, "{shown}: {rms}");
    }
}

#[test]
fn keeping_the_fibre_keeps_the_arc_length() {
    let mut worst = 0.0f32;
    for preset in ["2a", "2b", "2c", "3a", "3b", "3c", "4a", "4b", "4c"] {
        for id in 0..6 {
            let source = bent(id);
            let before = Spline::new(source.tufts()[0].curve(0)).unwrap().length();
            let length = |keep: &str| {
                let points = curled(&source, preset, &[("length", keep.into())]);
                Spline::new(&points).unwrap().length()
            };
            let after = length("fibre");
            // A wide wave may run inside its source's bends: shorter than the source, it ends with it.
            let before = before.min(length("span"));
            worst = worst.max((after / before - 1.0).abs());
            assert!((after / before - 1.0).abs() <= 0.005, "{preset} {id}: {after} of {before}");
        }
    }
    assert!(worst > 0.0, "nothing was measured");
}

#[test]
fn the_root_stays_and_a_size_of_nothing_changes_nothing() {
    for id in 0..20 {
        let source = bent(id);
        let points = source.tufts()[0].curve(0);
        for preset in ["2b", "3b", "4a", "4c"] {
            assert_eq!(curled(&source, preset, &[])[0], points[0], "{preset}");
        }
        assert_eq!(curled(&source, "3b", &[("diameter", Value::Float(0.0))]), points);
    }
}

#[test]
fn the_primary_shape_has_its_share_of_a_hundred_thousand_turns() {
    let list = ShapeList(vec![
        (Tier::A, Section::Circle),
        (Tier::B, Section::Ellipse(0.7)),
        (Tier::B, Section::Polygon(4)),
        (Tier::C, Section::Rose { petals: 5, depth: 0.3 }),
    ]);
    for (uniformity, b_to_c) in [(0.0, 4.0), (0.1, 4.0), (0.5, 1.0), (0.8, 9.0), (1.0, 2.0)] {
        let dice = Dice::new(1, 2, "turn");
        let pattern = Pattern {
            shapes: vec![],
            list: entries(&list, uniformity, b_to_c),
            z_bends: 0.0,
            switchbacks: 0.0,
            skipped: 0.0,
            ranges: [0.0; 4],
            spread: 0.0,
            blend: 0.0,
            hand: None,
            phase_range: 0.0,
            phase: 0.0,
            start: 0.0,
            rise: 1.0,
            detail: Detail::PerTurn(12.0),
            turn_dice: dice,
            curl_dice: dice,
        };
        let mut counts = [0u32; 4];
        for curl in 0..1000 {
            for turn in 0..100 {
                counts[pattern.turn(curl, turn).shape as usize] += 1;
            }
        }
        let share = |n: u32| n as f32 / 1e5;
        assert!((share(counts[0]) - uniformity).abs() <= 0.01, "{uniformity}: {counts:?}");
        let (b, c) = (share(counts[1] + counts[2]), share(counts[3]));
        let want = (1.0 - uniformity) * b_to_c / (1.0 + b_to_c);
        assert!((b - want).abs() <= 0.01, "{uniformity} {b_to_c}: {b} {c}");
    }
}

#[test]
fn the_tangent_turns_half_as_much_in_half_a_step() {
    let shapes = ShapeList(vec![
        (Tier::A, Section::Circle),
        (Tier::B, Section::Ellipse(0.5)),
        (Tier::C, Section::Polygon(5)),
    ]);
    let set = |per_turn: f32| {
        vec![
            ("shapes", shapes.clone().into()),
            ("uniformity", Value::Float(0.4)),
            ("blend", Value::Float(0.6)),
            ("rounding", Value::Float(0.5)),
            ("amplitude_range", Value::Float(0.3)),
            ("offset_range", Value::Float(0.3)),
            ("switchbacks", Value::Float(0.0)),
            ("points_per_turn", Value::Float(per_turn)),
        ]
    };
    let steepest = |per_turn: f32| {
        let points = curled(&straight(15), "3c", &set(per_turn));
        let steps: Vec<Vec3> = points.windows(2).map(|w| (w[1] - w[0]).normalize()).collect();
        steps.windows(2).map(|w| w[0].angle_between(w[1])).fold(0.0f32, f32::max)
    };
    let turns = [32.0, 64.0, 128.0, 256.0].map(steepest);
    for pair in turns.windows(2) {
        let ratio = pair[1] / pair[0];
        assert!((0.4..0.62).contains(&ratio), "{turns:?}");
    }
}
