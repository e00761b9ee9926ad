//! Laws of hair gathered into ties, on a ball.

use super::gather::NODE;
use super::tie::Tie;
use crate::data::attributes::{PUFF, TIE, TIE_RADIUS};
use crate::data::curves::Curves;
use crate::data::scalp::tests::shared_ball;
use crate::define::Value;
use crate::eval::{EvalCx, PlainHost};
use crate::laws::{MeasuredHair, depth, roots};
use crate::maths::hash::KeyBuilder;
use crate::maths::transcendental::atan2;
use crate::testing::{curves_of, run};
use glam::Vec3;
use std::collections::BTreeMap;
use std::f32::consts::TAU;

fn gather(set: &[(&str, Value)]) -> (Curves, Vec<Tie>) {
    let (out, said) = run(&NODE, &[&[("scalp", shared_ball().into())], set].concat());
    assert!(said.is_empty(), "{said:?}");
    let host = PlainHost;
    let log = crate::eval::Log::default();
    let cx = EvalCx::new(0, Default::default(), KeyBuilder::new("test").finish(), &host, &log);
    let ties = Tie::all(&cx, &shared_ball(), curves_of(&out[1]));
    (curves_of(&out[0]).clone(), ties)
}

fn few() -> (&'static str, Value) {
    ("density", Value::Float(4.0))
}

#[test]
fn hair_is_rooted_stays_out_of_the_head_and_ends_in_its_tie() {
    let scalp = shared_ball();
    let wild: &[(&str, Value)] =
        &[("stray", Value::Float(0.5)), ("wander", Value::Float(0.5)), few()];
    let high: &[(&str, Value)] = &[
        ("position", Vec3::new(2.0, 7.0, 2.0).into()),
        ("lean", Value::Float(30.0)),
        ("tightness", Value::Float(0.0)),
        ("volume", Value::Float(3.0)),
        few(),
    ];
    for set in [&[few()], wild, high] {
        let (hair, ties) = gather(set);
        assert!(hair.curve_count() > 1000);
        assert!(roots::off_their_places(&hair, &scalp) < 1e-5);
        let deep = depth::measure(&MeasuredHair::of(&hair, &PlainHost), &scalp);
        assert_eq!(deep.too_deep, 0, "{} cm", deep.beyond_cm);
        for (tuft, i) in hair.each() {
            let points = tuft.curve(i);
            let tie = ties.iter().find(|t| t.id == tuft.view(PUFF).at(i, 0)).unwrap();
            assert!(tuft.view(TIE).at(i, 0).distance(tie.top()) < 1e-5);
            assert!((tuft.view(TIE_RADIUS).at(i, 0) - tie.radius).abs() < 1e-6);
            let end = points[points.len() - 1];
            assert!(tie.place(end).length() <= 1.0 + 1e-4);
            assert!(((end - tie.foot.point).dot(tie.axis) - tie.height).abs() < 1e-4);
        }
    }
}

#[test]
fn combed_hair_keeps_bearing_and_order() {
    let (hair, ties) = gather(&[few(), ("wander", 0.0.into()), ("stray", 0.0.into())]);
    let tie = &ties[0];
    let turn = |p: Vec3| {
        let place = tie.place(p);
        atan2(place.y, place.x) / TAU
    };
    // Rings of the tie by sector: hair rooted farther away ends farther out.
    let mut sectors: BTreeMap<i32, Vec<(f32, f32)>> = BTreeMap::new();
    for (tuft, i) in hair.each() {
        let points = tuft.curve(i);
        let (from, to) = (turn(points[0]), turn(points[points.len() - 1]));
        let off = from - to;
        let far = tie.place(points[0]).length();
        if (0.5..5.0).contains(&far) {
            assert!((off - off.round()).abs() < 0.06, "{from} {to}");
        }
        let away = points[0].angle_between(tie.foot.point);
        let sector = (to * 12.0).floor() as i32;
        sectors
            .entry(sector)
            .or_default()
            .push((away, tie.place(points[points.len() - 1]).length()));
    }
    for (sector, mut ends) in sectors {
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let swapped = ends.windows(2).filter(|w| w[1].1 < w[0].1 - 2e-3).count();
        assert!(swapped * 50 <= ends.len(), "{swapped} of {} in sector {sector}", ends.len());
    }
}

#[test]
fn more_hair_only_adds_hair() {
    let (some, _) = gather(&[("density", Value::Float(2.0))]);
    let (more, _) = gather(&[few()]);
    let all: BTreeMap<u64, Vec<Vec3>> =
        more.each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i).to_vec())).collect();
    assert_eq!(all.len(), more.curve_count());
    assert!(some.curve_count() < more.curve_count());
    assert!(some.each().all(|(tuft, i)| all[&tuft.id(i)] == tuft.curve(i)));
}

#[test]
fn two_ties_leave_a_parting_between_them() {
    let (hair, ties) = gather(&[
        ("position", Vec3::new(5.0, 6.0, -3.0).into()),
        ("mirror", true.into()),
        ("parting", Value::Float(0.4)),
        few(),
    ]);
    assert_eq!(ties.len(), 2);
    for (tuft, i) in hair.each() {
        let tie = ties.iter().find(|t| t.id == tuft.view(PUFF).at(i, 0)).unwrap();
        let x = tuft.curve(i)[0].x;
        assert!(x.abs() > 0.17 && (x > 0.0) == (tie.foot.point.x > 0.0), "{x}");
    }
}

#[test]
fn hair_that_is_given_keeps_its_ids_and_roots() {
    let (hair, _) = gather(&[few()]);
    let (again, _) = gather(&[("roots", hair.clone().into())]);
    let ids = |c: &Curves| c.each().map(|(t, i)| (t.id(i), t.curve(i)[0])).collect::<Vec<_>>();
    let far = ids(&hair)
        .into_iter()
        .zip(ids(&again))
        .find(|(a, b)| a.0 != b.0 || a.1.distance(b.1) > 1e-4);
    assert_eq!(far, None);
}

#[test]
fn given_hair_that_has_no_tie_is_left_out_and_told() {
    let (hair, _) = gather(&[few()]);
    let given = ("roots", Value::from(hair.clone()));
    let check = |set: &[(&str, Value)], says: &str| {
        let set = [&[("scalp", shared_ball().into()), given.clone()], set].concat();
        let (out, said) = run(&NODE, &set);
        let left = hair.curve_count() - curves_of(&out[0]).curve_count();
        let [said] = &said[..] else { panic!("{said:?}") };
        assert!(left > 0 && said.contains(says), "{said}");
        assert!(said.contains(&left.to_string()), "{left}: {said}");
    };
    check(&[("reach", 4.0.into())], "out of reach of its tie was left out");
    let two = [("position", Vec3::new(5.0, 6.5, -3.0).into()), ("mirror", true.into())];
    check(&[&two[..], &[("parting", 1.0.into())]].concat(), "between two ties was left out");
}
