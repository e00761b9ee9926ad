//! Separation: lengths, roots, room and order, on a few hairs and on clumps of hundreds.

use super::*;
use crate::data::scalp::tests::shared_ball;
use crate::define::Value;
use crate::eval::{Host, Log, PlainHost, Quality};
use crate::maths::hash::Dice;
use crate::maths::transcendental::sin_cos_turns;
use crate::testing::{Memory, Threads, curves_of, run, run_on};
use std::sync::atomic::{AtomicU32, Ordering};

/// Curves that leave the ball side by side, much closer than their radii ask.
fn crowd(n: u64, radius: f32) -> Curves {
    let dice = Dice::new(3, 0, "crowd");
    let tuft = |id: u64| {
        let v = Vec3::new(0.15 * dice.signed(id, 0), 1.0, 0.15 * dice.signed(id, 1)).normalize();
        let root = shared_ball().closest_root(v * 9.0).unwrap().point;
        let points: Vec<Vec3> = (0..12).map(|k| root + Vec3::Y * k as f32).collect();
        let mut b = TuftBuilder::new();
        b.push_curve(&points);
        b.set(ID, Domain::Curve, vec![id + 1]);
        b.set(RADIUS, Domain::Curve, vec![radius]);
        b.build().into()
    };
    Curves::new((0..n).map(tuft).collect())
}

fn nearest(curves: &Curves) -> f32 {
    let tips: Vec<Vec3> = curves.tufts().iter().map(|t| *t.points().last().unwrap()).collect();
    let mut least = f32::MAX;
    for (i, a) in tips.iter().enumerate() {
        least = tips[..i].iter().fold(least, |least, b| least.min(a.distance(*b)));
    }
    least
}

#[test]
fn curves_come_apart_and_keep_roots_and_lengths() {
    let input = crowd(14, 0.5);
    let set = [("curves", input.clone().into()), ("scalp", shared_ball().into())];
    let (out, said) = run(&NODE, &[&set[..], &[("passes", Value::Int(40))]].concat());
    let out = curves_of(&out[0]);
    assert!(said.is_empty(), "{said:?}");
    assert!(nearest(&input) < 0.3 && nearest(out) > 0.85, "{} {}", nearest(&input), nearest(out));
    let skin = shared_ball();
    for (a, b) in input.tufts().iter().zip(out.tufts()) {
        assert_eq!((a.points()[0], a.id(0)), (b.points()[0], b.id(0)));
        for (p, q) in a.points().windows(2).zip(b.points().windows(2)) {
            assert!((p[0].distance(p[1]) - q[0].distance(q[1])).abs() < 1e-4);
        }
        assert!(b.points()[1..].iter().all(|p| skin.skin().distance(*p) > -1e-3));
    }
}

#[test]
fn hairs_keep_their_own_width_apart_and_a_crowd_is_told() {
    let bare = |width: f32, n: u64| {
        let tuft = |id: u64| {
            let x = 0.004 * id as f32;
            let points: Vec<Vec3> =
                (0..8).map(|k| Vec3::new(x, 10.0 + 0.5 * k as f32, 0.0)).collect();
            let mut b = TuftBuilder::new();
            b.push_curve(&points);
            b.set(ID, Domain::Curve, vec![id + 1]);
            b.set(WIDTH, Domain::Curve, vec![width]);
            b.build().into()
        };
        Curves::new((0..n).map(tuft).collect())
    };
    // Half as far apart as they are thick: they part. Thinner than they are apart: they stay.
    let passes = ("passes", Value::Int(30));
    let (out, _) = run(&NODE, &[("curves", bare(0.008, 2).into()), passes.clone()]);
    assert!((nearest(curves_of(&out[0])) - 0.008).abs() < 5e-4, "{}", nearest(curves_of(&out[0])));
    let thin = bare(0.003, 2);
    let (out, _) = run(&NODE, &[("curves", thin.clone().into()), passes]);
    assert_eq!(curves_of(&out[0]).key(), thin.key());
    // Each once, however many passes it is crowded in.
    let set = [
        ("curves", bare(0.008, 700).into()),
        ("radius", Field::Constant(5.0).into()),
        ("passes", Value::Int(3)),
    ];
    let (_, said) = run(&NODE, &set);
    let told = |text: &&String| text.starts_with(CROWDED) && text.contains("(700 curves,");
    assert!(said.len() == 1 && said.iter().any(|text| told(&text)), "{said:?}");
}

#[test]
fn what_keeps_its_distance_stays_and_order_does_not_matter() {
    let roomy = crowd(14, 0.001);
    let (out, _) = run(&NODE, &[("curves", roomy.clone().into())]);
    assert_eq!(curves_of(&out[0]).key(), roomy.key());
    let input = crowd(9, 0.6);
    let mut back: Vec<_> = input.tufts().to_vec();
    back.reverse();
    let (one, _) = run(&NODE, &[("curves", input.clone().into())]);
    let (other, _) = run(&NODE, &[("curves", Curves::new(back).into())]);
    for (a, b) in curves_of(&one[0]).tufts().iter().zip(curves_of(&other[0]).tufts().iter().rev()) {
        assert_eq!(a.key(), b.key());
    }
    let (none, _) = run(&NODE, &[("curves", input.clone().into()), ("passes", Value::Int(0))]);
    assert_eq!(curves_of(&none[0]).key(), input.key());
}

/// Hair that leaves a disc of a centimetre and meets in one of `tip` cm, as clumped clusters do; one tuft.
fn clump(n: u64, tip: f32, first_id: u64, at: Vec3) -> Curves {
    let (mut b, dice) = (TuftBuilder::new(), Dice::new(7, 0, "clump"));
    for i in 0..n {
        // Anywhere on the disc, so that some are close though there is room for all.
        let id = first_id + i;
        let (sin, cos) = sin_cos_turns(dice.unit(id, 0));
        let from_middle = Vec3::new(cos, 0.0, sin) * dice.unit(id, 1).sqrt();
        let point = |k: i32| {
            let u = k as f32 / 11.0;
            at + Vec3::Y * (13.0 * u) + from_middle * (1.0 + (tip - 1.0) * u)
        };
        b.push_curve(&(0..12).map(point).collect::<Vec<_>>());
    }
    b.set(ID, Domain::Curve, (first_id..first_id + n).collect());
    b.set(WIDTH, Domain::Curve, vec![0.008]);
    Curves::new(vec![b.build().into()])
}

/// The share of points that are nearer to another curve than the distance asked for, by more than a twentieth.
fn too_near(curves: &Curves, distance: f32) -> f32 {
    let all: Vec<(u64, &[Vec3])> = curves.each().map(|(t, i)| (t.id(i), t.curve(i))).collect();
    let near = |id: u64, p: Vec3| {
        all.iter().filter(|(other, _)| *other != id).any(|(_, points)| {
            points.windows(2).any(|w| {
                let way = w[1] - w[0];
                let t = ((p - w[0]).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                p.distance(w[0] + way * t) < 0.95 * distance
            })
        })
    };
    let points = || all.iter().flat_map(|(id, points)| points[1..].iter().map(|p| (*id, *p)));
    points().filter(|(id, p)| near(*id, *p)).count() as f32 / points().count() as f32
}

#[test]
fn clumped_hair_comes_apart_where_there_is_room() {
    let input = clump(300, 0.1, 1, Vec3::ZERO);
    let after = |passes: i64| {
        let (out, said) =
            run(&NODE, &[("curves", input.clone().into()), ("passes", Value::Int(passes))]);
        assert!(said.is_empty(), "{said:?}");
        let out = curves_of(&out[0]).clone();
        for ((a, i), (b, _)) in input.each().zip(out.each()) {
            assert_eq!((a.curve(i)[0], a.id(i)), (b.curve(i)[0], b.id(i)));
            for (p, q) in a.curve(i).windows(2).zip(b.curve(i).windows(2)) {
                assert!((p[0].distance(p[1]) - q[0].distance(q[1])).abs() < 1e-4);
            }
        }
        too_near(&out, 0.008)
    };
    let shares = [too_near(&input, 0.008), after(6), after(60)];
    let [before, few, many] = shares;
    assert!(before > 0.06 && few < 0.7 * before && many < 0.002, "{shares:?}");
}

#[test]
fn a_curve_counts_by_its_nearest_part_once() {
    // One hair bends beside a point of the other, where its two links are equally near; the other goes straight on.
    let two = |bent: bool| {
        let tuft = |id: u64, points: &[Vec3]| {
            let mut b = TuftBuilder::new();
            b.push_curve(points);
            b.set(ID, Domain::Curve, vec![id]);
            b.set(RADIUS, Domain::Curve, vec![0.05]);
            b.build().into()
        };
        let straight = [0.0, 1.0, 2.0].map(|y| Vec3::new(0.0, y, 0.0));
        let beside = [0.0, 1.0, 2.0].map(|y| Vec3::new(0.09, y, 0.0));
        let beside = if bent { beside.to_vec() } else { vec![beside[0], beside[2]] };
        let curves = Curves::new(vec![tuft(1, &straight), tuft(2, &beside)]);
        let (out, _) = run(&NODE, &[("curves", curves.into()), ("passes", Value::Int(1))]);
        curves_of(&out[0]).tufts()[0].key()
    };
    assert_eq!(two(true), two(false));
}

#[test]
fn threads_and_hair_elsewhere_change_nothing() {
    let at = |x: f32| Vec3::new(x, 0.0, 0.0);
    let tufts: Vec<_> = (0..6)
        .flat_map(|n| {
            // Two and two reach into each other.
            let x = 10.0 * (n / 2) as f32 + 0.02 * (n % 2) as f32;
            clump(60, 0.01, 1 + 60 * n, at(x)).tufts().to_vec()
        })
        .collect();
    let given = [("curves", Curves::new(tufts.clone()).into())];
    let keys = |host: &dyn Host, given: &[(&str, Value)], log: &Log| {
        let out = run_on(&NODE, given, host, log, Quality::Final).unwrap();
        curves_of(&out[0]).tufts().iter().map(|t| t.key()).collect::<Vec<_>>()
    };
    let one = keys(&PlainHost, &given, &Log::default());
    assert_eq!(keys(&Threads(5), &given, &Log::default()), one);
    // Another tuft far off: the rest is as it was and not made again, whatever is asked of the new one.
    let memory = Memory::default();
    assert_eq!(keys(&memory, &given, &Log::default()), one);
    let mut edit = clump(60, 0.01, 1000, at(50.0)).tufts()[0].edit();
    edit.set(WIDTH, Domain::Curve, vec![0.05]);
    let more = [&[edit.build().into()], &tufts[..]].concat();
    let log = Log::default();
    let all = keys(&memory, &[("curves", Curves::new(more).into())], &log);
    assert_eq!(all[1..], one);
    assert_eq!(log.tufts_run.into_inner(), 6, "the new one, in each pass");
    // What reaches into nothing is as it is alone, and else not.
    let alone = |n: usize| {
        keys(&PlainHost, &[("curves", Curves::new(vec![tufts[n].clone()]).into())], &Log::default())
    };
    assert_ne!(alone(0)[0], one[0]);
}

#[test]
fn whoever_asks_to_stop_does_not_wait_for_a_crowd() {
    /// Asks to stop at the so-many-th look.
    struct Stops(AtomicU32);
    impl Host for Stops {
        fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
            (0..n).for_each(f);
        }
        fn cancelled(&self) -> bool {
            self.0.fetch_add(1, Ordering::Relaxed) > 100
        }
    }
    let set = [
        ("curves", clump(500, 0.05, 1, Vec3::ZERO).into()),
        ("radius", Field::Constant(20.0).into()),
    ];
    let host = Stops(AtomicU32::new(0));
    let err = run_on(&NODE, &set, &host, &Log::default(), Quality::Final).unwrap_err();
    assert!(matches!(err, NodeError::Cancelled), "{err}");
    assert!(host.0.into_inner() < 110);
}
