//! Laws of all modifiers of hair, on random curves and on hair of the ball; on parted heads they are those of all nodes (`obeys.rs`).

use crate::data::attributes::{COLOUR, Domain, FIBRE, ID, ROLL};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::Field;
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::data::scalp::tests::shared_ball;
use crate::define::Value;
use crate::eval::{Log, Quality, Room};
use crate::maths::hash::Dice;
use crate::testing::{Memory, Threads, curves_of, run, run_on, with_points};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

type Sets = Vec<(&'static str, Value)>;

/// The modifiers, each with what lets it change nothing, and with what makes it change much.
fn modifiers() -> Vec<(&'static str, Sets, Sets)> {
    let number = |name, x: f32| (name, Value::Float(x));
    vec![
        (
            "clump",
            vec![number("amount", 0.0)],
            vec![number("amount", 0.95), number("twist", 200.0)],
        ),
        (
            "clump",
            vec![number("strays", 1.0)],
            vec![number("density", 0.3), ("levels", Value::Int(4))],
        ),
        (
            "noise",
            vec![number("amplitude", 0.0)],
            vec![number("amplitude", 2.0), number("roughness", 0.8)],
        ),
        (
            "noise",
            vec![("along", Ramp::constant(0.0).into())],
            vec![("together", "hair".into()), number("amplitude", 1.5), number("wavelength", 2.0)],
        ),
        ("frizz", vec![number("amplitude", 0.0)], vec![number("amplitude", 1.0)]),
        ("stray", vec![number("share", 0.0)], vec![number("share", 0.5), number("distance", 4.0)]),
        (
            "length",
            vec![number("variation", 0.0)],
            vec![number("share", 0.5), number("variation", 0.9)],
        ),
        (
            "length",
            vec![number("variation", 0.0), ("change", "lengthen".into()), number("share", 0.3)],
            vec![number("share", 1.6), ("way", "cut".into())],
        ),
        (
            "length",
            vec![number("variation", 0.0), ("way", "scale".into())],
            vec![number("share", 0.7), ("way", "scale".into())],
        ),
    ]
}

fn bent(id: &str, curves: &Curves, set: &[(&'static str, Value)]) -> Curves {
    let given = [("curves", Value::from(curves.clone()))];
    curves_of(&run(crate::by_id(id).unwrap(), &[&given[..], set].concat()).0[0]).clone()
}

/// Tufts of curves of 2 to 24 points that wander through space, rooted about each other; a few points repeat. Nothing is known of
/// them but ids and what a user may have set.
fn wild(tufts: u64, each: u64, seed: u64) -> Curves {
    let dice = Dice::new(seed, 0, "wild");
    let tuft = |t: u64| {
        let (mut b, mut n, mut ids) = (TuftBuilder::new(), 0, vec![]);
        for i in 0..each {
            let id = 1 + t * 1000 + i;
            let v = |k: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(id, 3 * k + a)));
            let of_tuft = Vec3::from([0, 1, 2].map(|a| dice.signed(7_000_000 + t, a))) * 4.0;
            let mut points = vec![of_tuft + v(0)];
            let mut way = v(1).normalize_or(Vec3::Y);
            for k in 0..1 + u64::from(dice.below(id, 900, 23)) {
                let step = if dice.unit(id, 1000 + k) < 0.05 {
                    0.0
                } else {
                    0.1 + dice.unit(id, 2000 + k)
                };
                points.push(points[k as usize] + way * step);
                way = (way + v(2 + k) * 0.5).normalize_or(Vec3::Y);
            }
            if points.iter().all(|p| *p == points[0]) {
                points[1] += Vec3::Y;
            }
            n += points.len();
            b.push_curve(&points);
            ids.push(id);
        }
        b.set(ID, Domain::Curve, ids);
        b.set(COLOUR, Domain::Curve, (0..each).map(|i| Vec3::splat(i as f32)).collect());
        b.set_named("half".into(), Domain::Curve, (0..each).map(|i| (i % 2) as f32).collect());
        b.set(ROLL, Domain::Point, (0..n).map(|k| k as f32).collect());
        b.set(FIBRE, Domain::Curve, vec![30.0; each as usize]);
        Arc::new(b.build())
    };
    Curves::new((0..tufts).map(tuft).collect())
}

/// Hair that stands on a head, between guides.
fn grown(scalp: &Arc<Scalp>, density: f32, set: &[(&'static str, Value)]) -> Curves {
    let on = || ("scalp", Value::from(scalp.clone()));
    let node = |id: &str, set: &[(&'static str, Value)]| {
        curves_of(&run(crate::by_id(id).unwrap(), set).0[0]).clone()
    };
    let base = [on(), ("count", Value::Int(500)), ("length", Value::Float(7.0))];
    let guides = node("scatter_guides", &[&base[..], set].concat());
    let by = ("by", "density".into());
    node("interpolate", &[on(), ("guides", guides.into()), by, ("density", Value::Float(density))])
}

fn by_id(curves: &Curves) -> BTreeMap<u64, Vec<Vec3>> {
    curves.each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i).to_vec())).collect()
}

fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

#[test]
fn asked_for_nothing_hair_is_the_hair_that_came_in() {
    for scalp in [None, Some(shared_ball())] {
        let on = scalp.iter().map(|scalp| ("scalp", Value::from(scalp.clone())));
        let on: Sets = on.collect();
        for (id, nothing, much) in modifiers() {
            let hair = wild(6, 12, 1);
            let same = bent(id, &hair, &[&on[..], &nothing].concat());
            let shared =
                |(a, b): (&Arc<Tuft>, &Arc<Tuft>)| a.points().as_ptr() == b.points().as_ptr();
            let all = hair.tufts().iter().zip(same.tufts()).all(shared);
            assert!(all && same.key() == hair.key(), "{id} {nothing:?}");
            assert_ne!(
                bent(id, &hair, &[&on[..], &much].concat()).key(),
                hair.key(),
                "{id} {much:?}"
            );
        }
    }
}

#[test]
fn hair_that_an_attribute_leaves_out_keeps_its_bits() {
    let half: Value = Field::Attribute("half".into()).into();
    let near =
        || Field::Product(vec![Field::Attribute("half".into()), Field::Constant(0.6)]).into();
    for (id, input, value) in [
        ("clump", "amount", half.clone()),
        ("noise", "amplitude", half.clone()),
        ("frizz", "amplitude", half.clone()),
        ("stray", "share", half.clone()),
        ("length", "share", near()),
    ] {
        let hair = wild(5, 20, 2);
        let after = bent(id, &hair, &[(input, value), ("seed", Value::Int(3))]);
        let after = by_id(&after);
        let (mut still, mut moved) = (0, 0);
        for (tuft, i) in hair.each() {
            let same = after.get(&tuft.id(i)).is_some_and(|points| points == tuft.curve(i));
            match i % 2 {
                0 if id != "length" => still += usize::from(same),
                // A share of nothing leaves nothing.
                0 => still += usize::from(!after.contains_key(&tuft.id(i))),
                _ => moved += usize::from(!same),
            }
        }
        assert_eq!(still, 50, "{id}");
        assert!(moved > 40, "{id}: {moved}");
    }
}

#[test]
fn roots_ids_and_attributes_stay_and_lengths_where_they_are_kept() {
    for (id, _, much) in modifiers() {
        let hair = wild(8, 15, 4);
        let after = bent(id, &hair, &much);
        assert_eq!(after.curve_count(), hair.curve_count(), "{id}");
        for (old, new) in hair.tufts().iter().zip(after.tufts()) {
            for i in 0..old.len() {
                let (a, b) = (old.curve(i), new.curve(i));
                assert_eq!((a[0], old.id(i)), (b[0], new.id(i)), "{id}");
                assert_eq!(old.view(COLOUR).at(i, 0), new.view(COLOUR).at(i, 0), "{id}");
                let share = length(b) / length(a);
                if id == "length" {
                    let fibre = new.view(FIBRE).at(i, 0) / 30.0;
                    assert!((fibre / share - 1.0).abs() < 0.05, "{id}: {fibre} {share}");
                    continue;
                }
                assert_eq!(a.len(), b.len(), "{id}");
                assert!((share - 1.0).abs() < 1e-4, "{id}: {share}");
                assert_eq!(
                    old.view(ROLL).at(i, old.range(i).end - 1),
                    new.view(ROLL).at(i, new.range(i).end - 1)
                );
            }
        }
    }
}

#[test]
fn more_hair_changes_none_that_was_there() {
    let mut checked = 0;
    let mut check = |id: &str, few: &Curves, many: &Curves, set: &Sets| {
        let (few, many) = (by_id(&bent(id, few, set)), by_id(&bent(id, many, set)));
        assert!(few.len() < many.len());
        let differ = few.iter().filter(|(id, points)| many.get(id) != Some(*points)).count();
        assert_eq!(differ, 0, "{id} {set:?}: of {}", few.len());
        checked += few.len();
    };
    let scalp = shared_ball();
    let (few, many) = (grown(&scalp, 10.0, &[]), grown(&scalp, 25.0, &[]));
    for (id, _, much) in modifiers() {
        check(id, &wild(8, 10, 5), &wild(9, 25, 5), &much);
        let on = [&[("scalp", Value::from(scalp.clone()))][..], &much].concat();
        check(id, &few, &many, &on);
    }
    assert!(checked > 9 * 4000, "{checked}");
}

#[test]
fn threads_change_nothing_and_an_edit_makes_one_tuft_again() {
    let hair = wild(20, 10, 6);
    let mut tufts = hair.tufts().to_vec();
    tufts[7] = with_points(&tufts[7], |points| points[1].x += 0.5).into();
    let combed = Curves::new(tufts);
    for (id, _, much) in modifiers() {
        let node = crate::by_id(id).unwrap();
        let set =
            |curves: &Curves| [&[("curves", Value::from(curves.clone()))][..], &much].concat();
        let (host, log) = (Memory::default(), Log::default());
        let many = run_on(node, &set(&hair), &Threads(5), &log, Quality::Final).unwrap();
        assert_eq!(bent(id, &hair, &much).key(), curves_of(&many[0]).key(), "{id}");
        run_on(node, &set(&hair), &host, &Log::default(), Quality::Final).unwrap();
        let log = Log::default();
        run_on(node, &set(&combed), &host, &log, Quality::Final).unwrap();
        assert_eq!(log.tufts_run.into_inner(), 1, "{id}");
    }
}

/// Straight hairs that stand on a square of 6 cm, a millimetre and a half apart.
fn field() -> Curves {
    let mut b = TuftBuilder::new();
    let n = 40u64;
    for k in 0..n * n {
        let root = Vec3::new((k % n) as f32 * 0.15, 9.0, (k / n) as f32 * 0.15);
        b.push_curve(&(0..13).map(|j| root + Vec3::Y * (j as f32 * 0.5)).collect::<Vec<_>>());
    }
    b.set(ID, Domain::Curve, (1..=n * n).collect());
    Curves::new(vec![b.build().into()])
}

#[test]
fn clumps_are_as_many_as_asked_for_and_come_together_at_their_tips() {
    let tips = |set: &[(&'static str, Value)]| {
        let base = [
            ("amount", Value::Float(1.0)),
            ("strays", Value::Float(0.0)),
            ("keep_length", false.into()),
            ("levels", Value::Int(1)),
        ];
        let hair = bent("clump", &field(), &[&base[..], set].concat());
        let tip = |(tuft, i): (&Tuft, usize)| {
            let tip = *tuft.curve(i).last().unwrap();
            [tip.x, tip.z].map(|x| (x * 1000.0).round() as i32)
        };
        hair.each().map(tip).collect::<BTreeSet<_>>().len()
    };
    for density in [0.5, 1.0, 3.0] {
        let clumps = tips(&[("density", Value::Float(density))]) as f32;
        // Those at the edge belong to seeds beyond it: half a clump's width all round.
        let side = 6.0 + 0.8 / density.sqrt();
        assert!((clumps / (density * side * side) - 1.0).abs() < 0.3, "{density}: {clumps}");
    }
    let mut centres = TuftBuilder::new();
    for x in [1.0, 3.0, 5.0] {
        centres.push_curve(&[0, 3, 6].map(|y| Vec3::new(x, 9.0 + y as f32, 3.0)));
    }
    centres.set(ID, Domain::Curve, vec![501, 502, 503]);
    let centres = Curves::new(vec![centres.build().into()]);
    assert_eq!(tips(&[("centres", centres.clone().into())]), 3);
    let mut named = field().tufts()[0].edit();
    named.set_named("lock".into(), Domain::Curve, (0..1600).map(|i| i % 5).collect());
    let named = Curves::new(vec![named.build().into()]);
    let set = [
        ("curves", named.into()),
        ("attribute", "lock".into()),
        ("amount", Value::Float(1.0)),
        ("strays", Value::Float(0.0)),
        ("keep_length", false.into()),
        ("levels", Value::Int(1)),
    ];
    let hair = curves_of(&run(crate::by_id("clump").unwrap(), &set).0[0]).clone();
    let tips: BTreeSet<[u32; 3]> = hair
        .each()
        .map(|(t, i)| t.curve(i).last().unwrap().to_array().map(|x| (x * 1e3) as u32))
        .collect();
    assert_eq!(tips.len(), 5);
}

#[test]
fn an_attribute_that_is_not_there_is_told() {
    let set = [("curves", field().into()), ("attribute", "lock".into())];
    let said = crate::testing::fails(crate::by_id("clump").unwrap(), &set);
    assert_eq!(said, "the curves have no attribute \"lock\" that is a number");
}

#[test]
fn before_lengths_are_kept_nothing_goes_farther_than_asked_and_much_goes_half_as_far() {
    let number = |name, x: f32| (name, Value::Float(x));
    let hair = field();
    let flat = ("along", Value::from(Ramp::constant(1.0)));
    for (id, set) in [
        ("noise", vec![number("amplitude", 0.8), flat.clone()]),
        ("noise", vec![number("amplitude", 0.8), flat.clone(), ("together", "hair".into())]),
        ("frizz", vec![number("amplitude", 0.8), flat.clone(), number("variation", 0.0)]),
        ("stray", vec![number("distance", 0.8), number("share", 1.0)]),
    ] {
        let set = [&set[..], &[("keep_length", false.into())]].concat();
        let after = bent(id, &hair, &set);
        let (a, b) = (hair.tufts()[0].points(), after.tufts()[0].points());
        let far: Vec<f32> = a.iter().zip(b).map(|(a, b)| a.distance(*b)).collect();
        let farthest = far.iter().fold(0.0f32, |a, b| a.max(*b));
        assert!((0.55..0.8001).contains(&farthest), "{id}: {farthest}");
    }
}

#[test]
fn a_higher_share_of_strays_only_adds_some() {
    let moved = |share: f32| {
        let after = by_id(&bent("stray", &field(), &[("share", Value::Float(share))]));
        let before = by_id(&field());
        after.into_iter().filter(|(id, points)| before[id] != *points).collect::<Vec<_>>()
    };
    let (few, many) = (moved(0.05), moved(0.2));
    assert!((50..115).contains(&few.len()) && (260..380).contains(&many.len()));
    assert!(few.iter().all(|one| many.contains(one)));
}

#[test]
fn lengths_are_as_asked() {
    let lengths = |set: &[(&'static str, Value)]| -> Vec<f32> {
        let even = [("variation", Value::Float(0.0))];
        let even = if set.iter().any(|one| one.0 == "variation") { &[] } else { &even[..] };
        let hair = bent("length", &field(), &[even, set].concat());
        hair.each().map(|(tuft, i)| length(tuft.curve(i))).collect()
    };
    let check = |set: &[(&'static str, Value)], want: f32| {
        let found = lengths(set);
        assert_eq!(found.len(), 1600);
        assert!(found.iter().all(|l| (l - want).abs() < 1e-3 * want), "{set:?}: {}", found[0]);
    };
    let share = |x| ("share", Value::Float(x));
    let scale = || ("way", Value::from("scale"));
    for x in [0.1, 0.37, 1.0, 1.5, 3.0] {
        check(&[share(x)], 6.0 * x);
        check(&[share(x), scale()], 6.0 * x);
        check(&[("by", "length".into()), ("length", Value::Float(6.0 * x))], 6.0 * x);
        check(&[share(x), ("change", "shorten".into())], 6.0 * x.min(1.0));
        check(&[share(x), ("change", "lengthen".into())], 6.0 * x.max(1.0));
    }
    let varied = lengths(&[("variation", Value::Float(0.5))]);
    let mean = varied.iter().sum::<f32>() / 1600.0;
    // The mean of a square of what is even from 0 to 1 is a third.
    assert!((mean - 5.0).abs() < 0.05, "{mean}");
    assert!(varied.iter().all(|l| (2.99..6.001).contains(l)));
    assert_eq!(lengths(&[share(0.0)]).len(), 0);
    let (_, said) = run(crate::by_id("length").unwrap(), &[("curves", field().into()), share(0.0)]);
    assert!(said[0].starts_with("1600 hairs are left out"), "{said:?}");
}

#[test]
fn hair_that_would_grow_beyond_all_room_is_told_beforehand() {
    let room = crate::testing::Lends(Room { points: Some(100_000), bytes: None });
    let set = [
        ("curves", field().into()),
        ("share", Value::Float(100.0)),
        ("variation", Value::Float(0.0)),
    ];
    let log = Log::default();
    let node = crate::by_id("length").unwrap();
    let failed = run_on(node, &set, &room, &log, Quality::Final).map(|_| ()).unwrap_err();
    let said = "would make 1.9 million points (pieces between points that come in 19200 x share less variation 100)";
    assert!(failed.to_string().starts_with(said), "{failed}");
    assert_eq!(log.tufts_run.into_inner(), 0);
}
