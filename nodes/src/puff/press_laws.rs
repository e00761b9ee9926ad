//! Laws of puffs that press on each other across nodes, and on the head, on a ball.

use super::press_puffs::NODE;
use super::sphere_puff;
use crate::data::attributes::{
    CURL_DIAMETER, FIBRE, PUFF, PUFF_CENTRE, PUFF_RADIUS, ROOT_TRIANGLE,
};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::scalp::tests::shared_ball;
use crate::data::scalp::{HeadFrame, REGION, Scalp};
use crate::define::Value;
use crate::eval::{Log, PlainHost, Quality};
use crate::maths::closest::{Surface, tests::sphere};
use crate::maths::spline::Spline;
use crate::testing::{curves_of, run, run_on};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The hair of a puff node at a position to one side.
fn puff(x: f32, seed: i64, set: &[(&str, Value)]) -> Curves {
    let own = [
        ("scalp", shared_ball().into()),
        ("position", Vec3::new(x, 8.0, -1.0).into()),
        ("root_radius", Value::Float(2.5)),
        ("count", Value::Int(700)),
        ("seed", Value::Int(seed)),
    ];
    curves_of(&run(&sphere_puff::NODE, &[&own, set].concat()).0[1]).clone()
}

fn merged(lots: &[&Curves]) -> Curves {
    let lots: Vec<(&str, Value)> = lots.iter().map(|c| ("curves", (*c).clone().into())).collect();
    curves_of(&run(crate::by_id("merge").unwrap(), &lots).0[0]).clone()
}

fn press(hair: &Curves, set: &[(&str, Value)]) -> (Curves, Vec<String>) {
    let own = [("curves", hair.clone().into()), ("scalp", shared_ball().into())];
    let (out, said) = run(&NODE, &[&own, set].concat());
    (curves_of(&out[0]).clone(), said)
}

/// How far each hair, past its first quarter, and its tip reach over the plane x = 0 from the side of its puff.
fn over(hair: &Curves) -> Vec<(f32, f32)> {
    hair.each()
        .map(|(tuft, i)| {
            let points = tuft.curve(i);
            let side = tuft.view(PUFF_CENTRE).at(i, 0).x.signum();
            let past = points.iter().skip(points.len() / 4 + 1);
            let all = past.map(|p| -side * p.x).fold(f32::MIN, f32::max);
            (all, -side * points[points.len() - 1].x)
        })
        .collect()
}

/// A ball stretched to an egg, at the puff's centre.
fn egg(centre: Vec3) -> Arc<Scalp> {
    let round = sphere(6.0, 32);
    let at = |p: &Vec3| *p * Vec3::new(1.1, 0.9, 1.0) + centre;
    let mesh = Surface::new(round.points.iter().map(at).collect(), round.triangles.clone());
    let region = BTreeMap::from([(REGION.to_owned(), vec![1.0; mesh.points.len()])]);
    Arc::new(Scalp::new(mesh, None, HeadFrame::IDENTITY, region))
}

#[test]
fn puffs_of_two_nodes_end_at_the_plane_between_and_curled_no_farther_over_it_than_a_curl_is_thick()
{
    let centre = puff(2.5, 1, &[]).tufts()[0].view(PUFF_CENTRE).at(0, 0);
    let mesh = |x: f32| egg(Vec3::new(x.signum() * centre.x, centre.y, centre.z));
    let shapes: [(&str, &dyn Fn(f32) -> Vec<(&'static str, Value)>); 3] = [
        ("sphere", &|_| vec![]),
        ("ellipsoid", &|_| {
            let stretch = Vec3::new(1.2, 0.9, 1.0);
            vec![("shape", "ellipsoid".into()), ("stretch", stretch.into())]
        }),
        ("mesh", &|x| vec![("shape", "mesh".into()), ("mesh", mesh(x).into())]),
    ];
    for (shape, set) in shapes {
        let hair = merged(&[&puff(2.5, 1, &set(2.5)), &puff(-2.5, 2, &set(-2.5))]);
        let before = over(&hair).iter().filter(|(_, tip)| *tip > 0.01).count();
        assert!(before > 100, "{shape}: {before} tips lie over the plane, too few to tell");
        let (out, said) = press(&hair, &[]);
        // The reach of outlines that are not round is known to a few hundredths.
        let loose = if shape == "sphere" { 1e-3 } else { 0.15 };
        let worst = over(&out).iter().map(|(all, _)| *all).fold(f32::MIN, f32::max);
        assert!(worst < loose, "{shape}: {worst}");
        assert_eq!(said, ["two of the 2 puffs meet"], "{shape}");
        let mut curled = vec![("curves", out.clone().into()), ("scalp", shared_ball().into())];
        curled.extend([("preset", "4a".into()), ("length", "fibre".into())]);
        let curled = run(crate::by_id("shape_list_curl").unwrap(), &curled).0;
        let curled = curves_of(&curled[0]);
        for ((all, _), (tuft, i)) in over(curled).into_iter().zip(curled.each()) {
            let radius = 0.5 * tuft.view(CURL_DIAMETER).at(i, tuft.range(i).start);
            // The radius of a noncircular profile is its mean; its corners are farther out.
            assert!(all < loose + 1.5 * radius, "{shape}: {all} of {radius}");
        }
    }
}

#[test]
fn a_large_puff_and_a_small_one_meet_where_their_spheres_do() {
    let (large, small) = (
        puff(2.5, 1, &[("sphere_radius", Value::Float(7.0))]),
        puff(-2.5, 2, &[("sphere_radius", Value::Float(4.0))]),
    );
    let told = |hair: &Curves| hair.tufts()[0].view(PUFF_CENTRE).at(0, 0);
    let (a, b) = (told(&large), told(&small));
    let d = a.distance(b);
    let at = 0.5 + (49.0 - 16.0) / (2.0 * d * d);
    let (out, _) = press(&merged(&[&large, &small]), &[]);
    let (mut on_it, mut worst) = (0, 0.0f32);
    for (tuft, i) in out.each() {
        let points = tuft.curve(i);
        let over = ((points[points.len() - 1] - a).dot(b - a) / (d * d) - at) * d;
        let over = if tuft.view(PUFF_CENTRE).at(i, 0) == a { over } else { -over };
        worst = worst.max(over);
        on_it += usize::from(over.abs() < 1e-3);
    }
    assert!(worst < 1e-3 && on_it > 40, "{worst} {on_it}");
}

#[test]
fn what_meets_nothing_keeps_its_bits_and_what_is_pressed_its_root_and_its_fibre() {
    let (left, right) = (puff(2.5, 1, &[]), puff(-2.5, 2, &[]));
    let hair = merged(&[&left, &right]);
    let (out, _) = press(&hair, &[]);
    let (mut moved, mut kept) = (0, 0);
    for ((a, i), (b, j)) in hair.each().zip(out.each()) {
        let (old, new) = (a.curve(i), b.curve(j));
        assert_eq!((a.id(i), a.view(PUFF).at(i, 0)), (b.id(j), b.view(PUFF).at(j, 0)));
        assert_eq!((old[0], old.len()), (new[0], new.len()));
        assert_eq!(a.view(ROOT_TRIANGLE).at(i, 0), b.view(ROOT_TRIANGLE).at(j, 0));
        let leaving = |p: &[Vec3]| (p[1] - p[0]).normalize();
        assert!(leaving(old).dot(leaving(new)) > 0.999);
        assert!(new.iter().all(|p| shared_ball().skin().distance(*p) > -1e-3));
        if old == new {
            kept += 1;
            continue;
        }
        moved += 1;
        // The stored outline is the current one, no farther than before, with lengths in proportion.
        let (was, is) = (a.view(PUFF_RADIUS).at(i, 0), b.view(PUFF_RADIUS).at(j, 0));
        let centre = b.view(PUFF_CENTRE).at(j, 0);
        assert!(is <= was && new[new.len() - 1].distance(centre) <= is * 1.001);
        let length = |p: &[Vec3]| Spline::new(p).unwrap().length();
        let fibres = b.view(FIBRE).at(j, 0) / a.view(FIBRE).at(i, 0);
        assert!((fibres / (length(new) / length(old)) - 1.0).abs() < 0.03, "{fibres}");
        // Nothing folds: it advances from point to point.
        for w in new.windows(3) {
            assert!((w[1] - w[0]).dot(w[2] - w[1]) > 0.0, "{new:?}");
        }
    }
    assert!(moved > 100 && kept > 400, "{moved} {kept}");
    let same = |one: &Curves, other: &Curves| {
        one.tufts().iter().zip(other.tufts()).all(|(a, b)| a.key() == b.key())
    };
    assert!(same(&hair, &press(&hair, &[("flatten", Value::Float(0.0))]).0));
    // The order of wires does not matter.
    let back = press(&merged(&[&right, &left]), &[]).0;
    let by_id = |hair: &Curves| {
        let all = hair.each().map(|(t, i)| (t.id(i), t.curve(i).to_vec()));
        all.collect::<BTreeMap<u64, Vec<Vec3>>>()
    };
    assert_eq!(by_id(&out), by_id(&back));
}

#[test]
fn half_pressed_hair_is_half_as_far_over_and_a_preview_has_its_planes() {
    let hair = merged(&[&puff(2.5, 1, &[]), &puff(-2.5, 2, &[])]);
    let half = press(&hair, &[("flatten", Value::Float(0.5))]).0;
    for ((_, before), (_, after)) in over(&hair).into_iter().zip(over(&half)) {
        if before > 0.01 {
            assert!((after - 0.5 * before).abs() < 0.02, "{before} {after}");
        }
    }
    let egg = [("shape", "ellipsoid".into()), ("stretch", Vec3::new(1.2, 0.9, 1.0).into())];
    let made = |quality: Quality| {
        let one = |x: f32, seed: i64| {
            let own = [
                ("scalp", shared_ball().into()),
                ("position", Vec3::new(x, 8.0, -1.0).into()),
                ("count", Value::Int(900)),
                ("seed", Value::Int(seed)),
            ];
            let set = [&own[..], &egg].concat();
            let out = run_on(&sphere_puff::NODE, &set, &PlainHost, &Log::default(), quality);
            curves_of(&out.unwrap()[1]).clone()
        };
        let hair = merged(&[&one(2.5, 1), &one(-2.5, 2)]);
        let set = [("curves", hair.into())];
        let out = run_on(&NODE, &set, &PlainHost, &Log::default(), quality).unwrap();
        let out = curves_of(&out[0]).clone();
        out.each().map(|(t, i)| (t.id(i), t.curve(i).to_vec())).collect::<BTreeMap<_, _>>()
    };
    let (some, all) = (made(Quality::Preview), made(Quality::Final));
    assert_eq!((some.len(), all.len()), (180, 1800));
    assert!(some.iter().all(|(id, points)| all[id] == *points));
}

#[test]
fn hair_of_no_puff_goes_through_and_is_said() {
    let mut b = TuftBuilder::new();
    b.push_curve(&[Vec3::Y * 9.0, Vec3::Y * 12.0]);
    let bare = Curves::new(vec![b.build().into()]);
    let (out, said) = press(&bare, &[]);
    assert_eq!(out.key(), bare.key());
    assert!(said[0].starts_with("no hair in curves carries"), "{said:?}");
    let (_, said) = press(&puff(2.5, 1, &[]), &[]);
    assert_eq!(said, ["there is one puff alone, and nothing to press it against"]);
}

#[test]
fn a_puff_that_dips_into_the_head_is_flat_there_and_its_tips_do_not_bunch() {
    let scalp = shared_ball();
    let skin = scalp.skin();
    let lying = |flatten: f32, shape: &[(&'static str, Value)]| {
        let set = [
            ("scalp", shared_ball().into()),
            ("offset", Value::Float(1.5)),
            ("count", Value::Int(1500)),
            ("depth_to", Value::Float(0.0)),
            ("flatten", Value::Float(flatten)),
        ];
        let (out, said) = run(&sphere_puff::NODE, &[&set, shape].concat());
        (curves_of(&out[0]).clone(), curves_of(&out[1]).clone(), said)
    };
    let egg = [("shape", "ellipsoid".into()), ("stretch", Vec3::new(1.2, 1.0, 0.9).into())];
    for shape in [&[][..], &egg] {
        let (guides, hair, said) = lying(1.0, shape);
        assert!(!said.iter().any(|text| text.starts_with(sphere_puff::DIPS)), "{said:?}");
        let mut low = 0;
        for (tuft, i) in guides.each().chain(hair.each()) {
            let points = tuft.curve(i);
            let tip = points[points.len() - 1];
            // The clearance is a tenth of a centimetre; hair rises to it along its second half.
            let above = skin.distance(tip);
            assert!(above > 0.095, "{above}");
            low += usize::from(above < 0.105);
            let n = points.len();
            let way = points[3 * n / 4..].iter().map(|p| skin.distance(*p)).fold(9.0, f32::min);
            assert!(way > 0.045, "{way}");
            // As far out as the file states.
            let told = tuft.view(PUFF_RADIUS).at(i, tuft.range(i).start);
            let far = tip.distance(tuft.view(PUFF_CENTRE).at(i, tuft.range(i).start));
            assert!((far / told - 1.0).abs() < 0.02, "{far} {told}");
        }
        assert!(low > 150, "{low} tips lie on the head, too few to tell");
        // Distance from a tip on the head to the nearest other tip: a twentieth of the hairs is closer.
        let crowd = |hair: &Curves| {
            let tips = hair.each().map(|(tuft, i)| *tuft.curve(i).last().unwrap());
            let tips: Vec<Vec3> = tips.filter(|tip| skin.distance(*tip) < 0.11).collect();
            let mut near: Vec<f32> = (0..tips.len())
                .map(|i| {
                    let others = tips.iter().enumerate().filter(|(j, _)| *j != i);
                    others.map(|(_, tip)| tip.distance(tips[i])).fold(9.0, f32::min)
                })
                .collect();
            near.sort_by(f32::total_cmp);
            (tips.len(), near[near.len() / 20], near[near.len() / 2])
        };
        let ((n, least, middle), (m, bunched, bunched_middle)) =
            (crowd(&hair), crowd(&lying(0.0, shape).1));
        assert!(
            least > bunched && middle > 0.9 * bunched_middle,
            "{n} tips {least} {middle} apart, {m} that are not pressed {bunched} {bunched_middle}"
        );
        let ids: BTreeSet<u64> = hair.each().map(|(tuft, i)| tuft.id(i)).collect();
        assert_eq!(ids.len(), 1500);
    }
}
