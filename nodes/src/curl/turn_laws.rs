//! The laws of a curl's turns: their number and sense, which are skipped, turn back or bend in a Z, how they keep step, and where
//! along a hair they begin. Tests only.
//!
//! Diameter and pitch are read by [`along_y`], independently of `laws::curls`: the axis is known here, and coils much wider than
//! their pitch, which `laws` reads up to a tenth too steep without it, are to be as large as was said.

use super::laws::{curled, hairs, lock, one, pure, pure_but, straight, wound};
use crate::data::attributes::{CURL_DIAMETER, CURL_PITCH, Domain, ID};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::shapes::TurnProfile;
use crate::define::Value;
use crate::maths::spline::Spline;
use glam::{Vec2, Vec3};

/// Rotation of a curl along Y about it: turns per cm between 3 cm and 9 cm, positive from X to Z.
fn turns(points: &[Vec3]) -> f32 {
    let angle = |p: &Vec3| crate::maths::transcendental::atan2(p.z, p.x) / std::f32::consts::TAU;
    let part: Vec<&Vec3> = points.iter().filter(|p| (3.0..9.0).contains(&p.y)).collect();
    let step = |w: &[&Vec3]| {
        let step = angle(w[1]) - angle(w[0]);
        step - step.round()
    };
    part.windows(2).map(step).sum::<f32>() / (part[part.len() - 1].y - part[0].y)
}

/// Handedness of a screw: the sum of the signs of its torsion, positive for a right-handed one.
fn sense(points: &[Vec3]) -> f32 {
    let steps: Vec<Vec3> = points.windows(2).map(|w| w[1] - w[0]).collect();
    steps.windows(3).map(|w| w[0].cross(w[1]).dot(w[2]).signum()).sum()
}

/// RMS radius of a curl along Y between two heights, with all heights weighted equally.
fn radius(points: &[Vec3], low: f32, high: f32) -> f32 {
    let (mut sum, mut gone) = (0.0, 0.0);
    for w in points.windows(2).filter(|w| w[0].y > low && w[1].y < high) {
        let step = w[1].y - w[0].y;
        let square = |p: Vec3| p.x * p.x + p.z * p.z;
        (sum, gone) = (sum + 0.5 * step * (square(w[0]) + square(w[1])), gone + step);
    }
    (sum / gone).sqrt()
}

/// Diameter and pitch of a curl along Y, cm, from its points alone: turns by the angle about the line from end to end, the
/// axis by the mean over one turn, the diameter by the distance from it in the root of the mean square.
fn along_y(points: &[Vec3]) -> (f32, f32) {
    let spline = Spline::new(points).unwrap();
    // The part at full size.
    let n = 1200;
    let at = |k: usize| spline.at(0.2 + 0.75 * k as f32 / n as f32);
    let samples: Vec<Vec3> = (0..=n).map(at).collect();
    let middle = samples.iter().sum::<Vec3>() / samples.len() as f32;
    let angle = |p: &Vec3| crate::maths::transcendental::atan2(p.z - middle.z, p.x - middle.x);
    let mut turned = 0.0f32;
    for pair in samples.windows(2) {
        let step = (angle(&pair[1]) - angle(&pair[0])) / std::f32::consts::TAU;
        turned += step - step.round();
    }
    let turns = turned.abs();
    let reach = ((n as f32 / turns) * 0.5).round() as usize;
    let (mut sum, mut count) = (0.0f32, 0);
    for k in reach..=n - reach {
        let around = &samples[k - reach..=k + reach];
        let axis = around.iter().sum::<Vec3>() / around.len() as f32;
        let off = samples[k] - axis;
        sum += off.x * off.x + off.z * off.z;
        count += 1;
    }
    (2.0 * (sum / count as f32).sqrt(), (samples[n].y - samples[0].y).abs() / turns)
}

#[test]
fn a_curl_of_more_turns_than_its_points_show_is_drawn_larger_and_said_so() {
    let check = |preset: &str, length: f32, set: &[(&str, Value)], larger: (f32, f32)| {
        let (curves, said) = wound(&hairs(40, length), preset, set);
        let tuft = &curves.tufts()[0];
        let (mut wide, mut far) = (0.0, 0.0);
        for i in 0..tuft.len() {
            let (d, p) = along_y(tuft.curve(i));
            assert!(tuft.curve(i).len() <= 255, "{preset}: {}", tuft.curve(i).len());
            wide += d / tuft.view(CURL_DIAMETER).at(i, 0) / tuft.len() as f32;
            far += p / tuft.view(CURL_PITCH).at(i, 0) / tuft.len() as f32;
        }
        // Form and shrinkage stay: pitch and diameter grow alike.
        let by = larger.0..larger.1;
        assert!(by.contains(&wide) && by.contains(&far), "{preset} {length}: {wide} {far}");
        let warned: Vec<_> = said.iter().filter(|said| said.contains("drawn larger")).collect();
        assert_eq!(warned.len(), usize::from(larger.0 > 1.1), "{preset} {length}: {said:?}");
        assert!(warned.iter().all(|said| said.contains("(40 curves, first")), "{warned:?}");
    };
    let pitch = |x: f32| ("pitch", Value::Float(x));
    let still = [("spread", Value::Float(0.0)), ("switchbacks", Value::Float(0.0))];
    // 36 turns or fewer have seven points each.
    check("custom", 20.0, &[&still[..], &[pitch(0.7)]].concat(), (0.95, 1.05));
    check("custom", 20.0, &[&still[..], &[pitch(0.25)]].concat(), (2.05, 2.4));
    check("4a", 40.0, &still, (1.5, 1.7));
    check("3c", 14.0, &[&still[..], &[pitch(0.2)]].concat(), (1.8, 2.15));
    // With enough points, it is as requested.
    let many = ("most_points", Value::Int(4000));
    let set = [&still[..], &[pitch(0.25), many]].concat();
    let (curves, said) = wound(&hairs(1, 20.0), "custom", &set);
    let (d, p) = along_y(curves.tufts()[0].curve(0));
    assert!((d - 1.0).abs() < 0.05 && (p / 0.25 - 1.0).abs() < 0.03, "{d} {p}");
    assert!(!said.iter().any(|said| said.contains("larger") || said.contains("coarser")));
}

#[test]
fn hairs_that_are_merely_coarser_are_counted_and_no_others() {
    let said = |most: i64| {
        let set = [("most_points", Value::Int(most)), ("pitch", Value::Float(1.0))];
        wound(&hairs(9, 14.0), "custom", &set).1
    };
    let coarser = |said: &[String]| said.iter().filter(|s| s.contains("coarser")).count();
    assert_eq!(coarser(&said(400)), 0);
    let some = said(140);
    assert!(some.iter().any(|s| s.starts_with("9 of 9 hairs would have more")), "{some:?}");
    // The message names those that are drawn larger.
    let few = said(60);
    assert!(coarser(&few) == 0 && few.iter().any(|s| s.contains("drawn larger")), "{few:?}");
}

#[test]
fn turns_that_are_not_skipped_keep_their_size_and_the_mean_is_told() {
    let widest = |skipped: f32| {
        let set = pure_but(TurnProfile::Circle, &[("skipped", Value::Float(skipped))]);
        // Without blending, each turn has its own size.
        let (curves, _) = wound(&hairs(60, 14.0), "custom", &set);
        let tuft = &curves.tufts()[0];
        let all = (0..tuft.len()).map(|i| radius(tuft.curve(i), 4.0, 13.0));
        let mean = (all.map(|r| r * r).sum::<f32>() / tuft.len() as f32).sqrt();
        let far = (0..tuft.len())
            .flat_map(|i| tuft.curve(i))
            .filter(|p| p.y > 4.0)
            .map(|p| Vec2::new(p.x, p.z).length())
            .fold(0.0, f32::max);
        (far, 2.0 * mean / tuft.view(CURL_DIAMETER).at(0, 0), tuft.view(CURL_DIAMETER).at(0, 0))
    };
    for skipped in [0.0, 0.25, 0.5, 0.75] {
        let (far, told, _) = widest(skipped);
        assert!((far - 0.5).abs() < 0.01, "{skipped}: {far}");
        assert!((told - 1.0).abs() < 0.06, "{skipped}: {told}");
    }
    let (far, told, diameter) = widest(1.0);
    assert!(far < 0.08 && (told - 1.0).abs() < 0.02 && diameter < 0.16, "{far} {told} {diameter}");
}

#[test]
fn left_is_a_left_handed_screw_and_right_a_right_handed_one() {
    let check = |hand: &'static str, want: f32| {
        for preset in ["custom", "3a", "3b", "3c", "4a"] {
            let set = [("hand", hand.into()), ("switchbacks", Value::Float(0.0))];
            let (curves, _) = wound(&hairs(6, 14.0), preset, &set);
            let (tuft, mut sum) = (&curves.tufts()[0], 0.0);
            for i in 0..tuft.len() {
                sum += sense(tuft.curve(i)) * want;
                assert!(sense(tuft.curve(i)) * want > 0.0, "{hand} {preset} {i}");
            }
            assert!(sum > 0.0);
        }
    };
    check("left", -1.0);
    check("right", 1.0);
}

#[test]
fn alternating_turns_go_against_each_other_and_bring_a_hair_nowhere_round() {
    let set = |hand: &'static str| pure_but(TurnProfile::Circle, &[("hand", hand.into())]);
    let round = |hand: &'static str| {
        turns(wound(&hairs(1, 14.0), "custom", &set(hand)).0.tufts()[0].curve(0)).abs()
    };
    assert!((round("right") - 1.0 / 1.5).abs() < 0.02, "{}", round("right"));
    assert!(round("alternating") < 0.2, "{}", round("alternating"));
}

#[test]
fn phases_are_a_clumps_a_hairs_or_all_alike() {
    let spread = |lock: &'static str, source: &Curves| {
        let set =
            [("phase_lock", lock.into()), ("spread", Value::Float(0.0)), ("hand", "right".into())];
        let (curves, _) = wound(source, "custom", &set);
        let tuft = &curves.tufts()[0];
        let at = |i: usize| tuft.curve(i)[tuft.curve(i).len() / 2];
        (1..tuft.len()).map(|i| at(i).distance(at(0))).fold(0.0, f32::max)
    };
    // Hairs of one parent, and hairs without any.
    assert!(spread("clump", &lock(20)) < 1e-4);
    assert!(spread("free", &lock(20)) > 0.5);
    assert!(spread("clump", &hairs(20, 12.0)) > 0.5);
    assert!(spread("all", &hairs(20, 12.0)) < 1e-4);
}

#[test]
fn hair_is_straight_up_to_its_start() {
    let set = [("start", Value::Float(4.0))];
    let points = curled(&straight(14), "3b", &set);
    assert!(radius(&points, 0.1, 4.0) < 1e-5 && radius(&points, 7.0, 13.0) > 0.5);
}

#[test]
fn a_ramp_on_amount_is_the_curls_size_along_the_hair() {
    use crate::data::ramp::Ramp;
    let ramp = Value::from(Ramp::linear(1.0, 0.2));
    let set = [
        &pure(TurnProfile::Circle)[..],
        &[("amount", ramp), ("pitch", Value::Float(0.5)), ("most_points", Value::Int(4000))],
    ];
    let points = curled(&straight(20), "custom", &set.concat());
    for (y, want) in [(4.0, 0.84), (10.0, 0.6), (16.0, 0.36)] {
        let found = radius(&points, y - 0.5, y + 0.5) / 0.5;
        assert!((found - want).abs() < 0.02, "{y}: {found} of {want}");
    }
}

#[test]
fn without_spread_all_hairs_have_one_size_and_with_it_each_its_own() {
    let sizes = |spread: f32| {
        let (curves, _) = wound(&hairs(40, 14.0), "3b", &[("spread", Value::Float(spread))]);
        let tuft = &curves.tufts()[0];
        let mut all: Vec<f32> = (0..40).map(|i| tuft.view(CURL_DIAMETER).at(i, 0)).collect();
        all.sort_by(f32::total_cmp);
        all[39] / all[0]
    };
    assert!((sizes(0.0) - 1.0).abs() < 1e-5, "{}", sizes(0.0));
    // From half to twice.
    assert!((2.5..4.2).contains(&sizes(1.0)), "{}", sizes(1.0));
}

#[test]
fn z_bends_and_switchbacks_have_their_share_of_turns() {
    // A zigzag in its plane winds about no axis; a coil winds in one direction or in both.
    let round = |z_bends: f32, switchbacks: f32| {
        let set = pure_but(
            TurnProfile::Circle,
            &[
                ("z_bends", Value::Float(z_bends)),
                ("switchbacks", Value::Float(switchbacks)),
                ("pitch", Value::Float(0.5)),
                ("most_points", Value::Int(4000)),
            ],
        );
        let (curves, _) = wound(&hairs(200, 14.0), "custom", &set);
        let tuft = &curves.tufts()[0];
        // Samples of the direction, turn by turn: the fraction that goes the first way, and the fraction that is flat.
        let (mut flat, mut changed, mut all) = (0, 0, 0);
        for i in 0..tuft.len() {
            let mut last = 0.0;
            for turn in 6..26 {
                let from = turn as f32 * 0.5;
                let part: Vec<Vec2> = tuft
                    .curve(i)
                    .iter()
                    .filter(|p| (from..from + 0.5).contains(&p.y))
                    .map(|p| Vec2::new(p.x, p.z))
                    .collect();
                let area: f32 = part.windows(2).map(|w| w[0].perp_dot(w[1])).sum();
                all += 1;
                flat += usize::from(area.abs() < 0.6);
                changed += usize::from(last * area < 0.0 && area.abs() > 0.6);
                last = if area.abs() > 0.6 { area } else { last };
            }
        }
        (flat as f32 / all as f32, changed as f32 / all as f32)
    };
    for share in [0.0, 0.3, 0.7, 1.0] {
        let (flat, _) = round(share, 0.0);
        assert!((flat - share).abs() < 0.05, "Z-bends {share}: {flat}");
    }
    for share in [0.0, 0.2, 0.5] {
        let (_, changed) = round(0.0, share);
        assert!((changed - share).abs() < 0.06, "switchbacks {share}: {changed}");
    }
}

#[test]
fn a_drawn_shape_takes_the_place_of_its_tier() {
    let outline = |radius: &dyn Fn(f32) -> f32| {
        let point = |k: usize| {
            let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 / 24.0);
            Vec3::new(cos, 0.0, sin) * radius(k as f32 / 24.0)
        };
        Value::from(one(&(0..24).map(point).collect::<Vec<_>>()))
    };
    let with = |drawn: Value, tier: &'static str| {
        let more = [("shape_curves", drawn), ("drawn_tier", tier.into())];
        curled(&straight(20), "custom", &[&pure(TurnProfile::Circle)[..], &more].concat())
    };
    let plain = curled(&straight(20), "custom", &pure(TurnProfile::Circle));
    let least = |points: &[Vec3]| {
        let inner = points.iter().filter(|p| (4.0..18.0).contains(&p.y));
        inner.map(|p| Vec2::new(p.x, p.z).length()).fold(f32::MAX, f32::min)
    };
    let circle = |_: f32| 3.0;
    let flat = |turns: f32| {
        let (sin, cos) = crate::maths::transcendental::sin_cos_turns(turns);
        1.0 / (cos * cos + 9.0 * sin * sin).sqrt()
    };
    // A drawn circle of any size equals the built-in circle; a flat profile comes closer to its centre.
    assert!((least(&with(outline(&circle), "a")) - least(&plain)).abs() < 0.01);
    let drawn = least(&with(outline(&flat), "a"));
    assert!((0.1..0.35).contains(&drawn), "{drawn}");
    // If no turn is of tier B, a profile drawn for it has no effect.
    assert_eq!(with(outline(&flat), "b"), plain);
}

#[test]
fn a_limit_that_was_typed_is_not_outside_itself() {
    for (pitch, warned) in [(0.02, false), (1000.0, false), (0.0199, true), (1001.0, true)] {
        let (_, said) = wound(&hairs(1, 14.0), "custom", &[("pitch", Value::Float(pitch))]);
        let outside = said.iter().find(|said| said.contains("is outside 0.02 to 1000 cm"));
        assert_eq!(outside.is_some(), warned, "{pitch}: {said:?}");
        let named = |said: &String| said.starts_with(&format!("pitch {pitch} cm"));
        assert!(outside.is_none_or(named), "{outside:?}");
    }
}

#[test]
fn hair_that_the_skin_pushes_out_keeps_its_length() {
    let scalp = crate::data::scalp::tests::shared_ball();
    // Sources along the skin of a ball, so close that curls would go below it.
    let mut b = TuftBuilder::new();
    for i in 0..12 {
        let around = |k: usize| {
            let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 * 0.02);
            let (s, c) = crate::maths::transcendental::sin_cos_turns(i as f32 / 12.0);
            Vec3::new(s * sin, cos, c * sin) * 9.4
        };
        b.push_curve(&(0..=10).map(around).collect::<Vec<_>>());
    }
    b.set(ID, Domain::Curve, (1..=12).collect::<Vec<u64>>());
    let source = Curves::new(vec![b.build().into()]);
    let fibre = [("length", "fibre".into())];
    let free = wound(&source, "3b", &fibre).0;
    let pushed = wound(&source, "3b", &[&fibre[..], &[("scalp", scalp.clone().into())]].concat()).0;
    let mut moved = 0;
    for i in 0..12 {
        let before = Spline::new(source.tufts()[0].curve(i)).unwrap().length();
        let (free, pushed) = (free.tufts()[0].curve(i), pushed.tufts()[0].curve(i));
        let after = Spline::new(pushed).unwrap().length();
        moved += usize::from(free != pushed);
        assert!((after / before - 1.0).abs() < 0.1, "{i}: {after} of {before}");
    }
    assert!(moved > 6, "only {moved} were pushed out");
}
