//! Laws of filled clusters (methods.md 6), on random clusters on a ball.

use super::cluster_to_strands::{COARSE, NODE};
use super::cross_section;
use crate::data::attributes::{ALLOW_DEPTH, ROLL};
use crate::data::attributes::{
    COLOUR, DENSITY, Domain, ID, PARENT, RADIUS, ROOT_BARY, ROOT_TRIANGLE, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::ramp::Ramp;
use crate::data::scalp::tests::shared_ball;
use crate::define::Value;
use crate::eval::{Log, Quality};
use crate::maths::frame::{Frame, any_normal, carry, frames};
use crate::maths::hash::Dice;
use crate::maths::spline::Spline;
use crate::testing::{Memory, curves_of, run, run_on, with_points};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Clusters of 11 points that leave the upper half of the ball in any direction and wander, one a tuft.
fn clusters(n: u64, seed: u64) -> Curves {
    let scalp = shared_ball();
    let dice = Dice::new(seed, 0, "clusters");
    let tuft = |id: u64| {
        let v = |k: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(id, 3 * k + a)));
        let up = v(0).normalize_or(Vec3::Y);
        let root = scalp.closest_root(Vec3::new(up.x, up.y.abs(), up.z) * 9.0).unwrap();
        let mut direction = (root.normal + v(1) * 1.6).normalize();
        let mut points = vec![root.point];
        for k in 0..10 {
            points.push(points[k] + direction * 1.8);
            direction = (direction + v(2 + k as u64) * 0.4).normalize();
        }
        let mut b = TuftBuilder::new();
        b.push_curve(&points);
        b.set(ID, Domain::Curve, vec![100 + id]);
        b.set(DENSITY, Domain::Curve, vec![0.1]);
        b.set(RADIUS, Domain::Curve, vec![dice.range(id, 99, 0.2, 1.2)]);
        Arc::new(b.build())
    };
    Curves::new((0..n).map(tuft).collect())
}

fn fill(curves: &Curves, set: &[(&str, Value)]) -> Curves {
    let given = [("curves", curves.clone().into()), ("scalp", shared_ball().into())];
    let (out, _) = run(&NODE, &[&given, set].concat());
    curves_of(&out[0]).clone()
}

/// Clusters whose cross-sections are shaped.
fn shaped(curves: &Curves, set: &[(&str, Value)]) -> Curves {
    let (out, said) =
        run(&cross_section::NODE, &[&[("curves", curves.clone().into())], set].concat());
    assert!(said.is_empty(), "{said:?}");
    curves_of(&out[0]).clone()
}

/// Clusters that nothing pushes out of the skin.
fn deep(curves: &Curves) -> Curves {
    let sunk = |tuft: &Arc<Tuft>| {
        let mut edit = tuft.edit();
        edit.set(ALLOW_DEPTH, Domain::Curve, vec![100.0]);
        Arc::new(edit.build())
    };
    Curves::new(curves.tufts().iter().map(sunk).collect())
}

fn number(name: &str, x: f32) -> (&str, Value) {
    (name, Value::Float(x))
}

/// Centre and frame at each point of strands, as the specification has them.
fn sections(cluster: &[Vec3], count: usize) -> Vec<(Vec3, Frame, f32)> {
    let spline = Spline::new(cluster).unwrap();
    let normal = shared_ball().closest_root(cluster[0]).unwrap().normal;
    let start = carry(any_normal(normal), normal, spline.tangent_at(0.0));
    let us: Vec<f32> = (0..count).map(|k| k as f32 / (count - 1) as f32).collect();
    let frames = frames(&spline, &us, Some(start), |_, _, _| None);
    let at = |(u, frame): (&f32, Frame)| (spline.at(*u), frame, u * spline.length());
    us.iter().zip(frames).map(at).collect()
}

#[test]
fn without_frizz_and_twist_a_strand_keeps_its_place_across_the_cluster() {
    let mut worst = 0.0f32;
    let input = clusters(60, 1);
    for tuft in fill(&deep(&input), &[]).tufts() {
        let id = tuft.view(PARENT).at(0, 0);
        let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
        let radius = cluster.view(RADIUS).at(0, 0);
        let sections = sections(cluster.curve(0), 16);
        for i in 0..tuft.len() {
            let place = |k: usize| {
                let (centre, frame, _) = sections[k];
                let d = tuft.curve(i)[k] - centre;
                Vec3::new(d.dot(frame.normal), d.dot(frame.binormal()), d.dot(frame.tangent))
            };
            let first = place(15);
            for k in (1..16).filter(|k| sections[*k].2 >= 1.25 * radius) {
                worst = worst.max(place(k).distance(first)).max(place(k).z.abs());
            }
        }
    }
    assert!(worst < 1e-4, "{worst}");
}

#[test]
fn no_strand_leaves_the_radius_whatever_is_asked() {
    let taper = Ramp::linear(0.8, 0.2);
    let none: &[(&str, Value)] = &[];
    let cases: [(&[(&str, Value)], &[(&str, Value)]); 4] = [
        (none, &[number("frizz", 1.0)]),
        (&[number("twist", 45.0)], &[number("frizz", 0.9), number("frizz_step", 0.0)]),
        (none, &[number("frizz", 0.5), ("radius", taper.clone().into())]),
        (&[number("twist", -170.0)], &[("points", Value::Int(4)), number("frizz_step", 0.3)]),
    ];
    let input = clusters(40, 2);
    for (case, (shape, set)) in cases.iter().enumerate() {
        let mut worst = 0.0f32;
        for tuft in fill(&deep(&shaped(&input, shape)), set).tufts() {
            let id = tuft.view(PARENT).at(0, 0);
            let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
            let each = tuft.curve(0).len();
            for (k, (centre, frame, _)) in sections(cluster.curve(0), each).iter().enumerate() {
                let radius = match case {
                    2 => taper.at(k as f32 / (each - 1) as f32),
                    _ => cluster.view(RADIUS).at(0, 0),
                };
                for i in (0..tuft.len()).filter(|_| k > 0) {
                    let d = tuft.curve(i)[k] - *centre;
                    worst = worst.max((d - frame.tangent * d.dot(frame.tangent)).length() - radius);
                }
            }
        }
        assert!(worst < 1e-4, "case {case}: {worst}");
    }
}

#[test]
fn roots_are_on_the_scalp_and_nothing_is_deeper_than_allowed() {
    let scalp = shared_ball();
    // At the root and at the tip; strands carry on what their cluster is allowed.
    for [root, tip] in [[0.0, 0.0], [0.25, 0.25], [0.0, 0.4]] {
        let mut input = clusters(60, 3).tufts().to_vec();
        for tuft in &mut input {
            let n = tuft.curve(0).len();
            let at = |k: usize| root + (tip - root) * k as f32 / (n - 1) as f32;
            let mut edit = tuft.edit();
            match root == tip {
                true => edit.set(ALLOW_DEPTH, Domain::Curve, vec![root]),
                false => edit.set(ALLOW_DEPTH, Domain::Point, (0..n).map(at).collect()),
            };
            *tuft = edit.build().into();
        }
        let (mut pushed, mut deepest) = (0, 0.0f32);
        for tuft in fill(&Curves::new(input), &[number("frizz", 0.6)]).tufts() {
            for i in 0..tuft.len() {
                let points = tuft.curve(i);
                let triangle = tuft.view(ROOT_TRIANGLE).at(i, 0);
                let bary = tuft.view(ROOT_BARY).at(i, 0);
                let bound = scalp.surface().at(u32::try_from(triangle).unwrap(), bary);
                assert!(points[0].distance(bound) < 1e-5);
                for (k, p) in points.iter().enumerate().skip(1) {
                    let allowed: f32 = tuft.view(ALLOW_DEPTH).at(i, tuft.range(i).start + k);
                    let hit = scalp.surface().closest(*p).unwrap();
                    let d = scalp.surface().signed_distance(*p, &hit);
                    deepest = deepest.min(d + allowed);
                    pushed += usize::from(d < 0.001 - allowed);
                }
            }
        }
        assert!(deepest >= -1e-6, "{deepest}");
        assert!(pushed > 50, "nothing was tried: {pushed}");
    }
}

#[test]
fn more_density_only_adds_and_a_preview_is_the_start_of_the_final_hair() {
    let input = clusters(10, 4);
    let input = shaped(&input, &[number("twist", 20.0)]);
    let all = [number("frizz", 0.7)];
    let with = |density| fill(&input, &[&all[..], &[number("density", density)]].concat());
    let (half, full) = (with(0.5), with(1.0));
    let starts = |few: &Curves, many: &Curves| {
        for (a, b) in few.tufts().iter().zip(many.tufts()) {
            assert!(a.len() < b.len());
            for i in 0..a.len() {
                assert_eq!((a.id(i), a.curve(i)), (b.id(i), b.curve(i)));
            }
        }
    };
    assert!((half.curve_count() * 2).abs_diff(full.curve_count()) <= 20);
    starts(&half, &full);
    let set = [("curves", input.clone().into()), ("scalp", shared_ball().into())];
    let set = [&set, &all[..], &[number("density", 1.0)]].concat();
    let preview =
        run_on(&NODE, &set, &crate::eval::PlainHost, &Log::default(), Quality::Preview).unwrap();
    starts(curves_of(&preview[0]), &full);
}

#[test]
fn an_edit_of_one_cluster_makes_its_strands_again_and_no_others() {
    let (host, scalp, input) = (Memory::default(), Value::from(shared_ball()), clusters(150, 5));
    let fill = |curves: &Curves| {
        let (log, count) = (Log::default(), Value::Int(20));
        let set = [("curves", curves.clone().into()), ("scalp", scalp.clone()), ("count", count)];
        let out = run_on(&NODE, &set, &host, &log, Quality::Final).unwrap();
        (curves_of(&out[0]).clone(), log.tufts_run.into_inner())
    };
    let (before, ran) = fill(&input);
    assert_eq!(ran, 150);
    let mut tufts = input.tufts().to_vec();
    tufts[70] = with_points(&tufts[70], |points| points[9].x += 1.0).into();
    let (after, ran) = fill(&Curves::new(tufts.clone()));
    assert_eq!(ran, 1);
    let differ = before.tufts().iter().zip(after.tufts()).filter(|(a, b)| a.key() != b.key());
    assert_eq!(differ.count(), 1);
    tufts.remove(3);
    assert_eq!(fill(&Curves::new(tufts)).1, 0);
}

#[test]
fn the_twist_adds_up_from_the_root_and_gets_the_points_it_needs() {
    let mut b = TuftBuilder::new();
    b.push_curve(&(0..11).map(|k| Vec3::Y * (2.0 * k as f32)).collect::<Vec<_>>());
    b.set(ROLL, Domain::Point, (0..11).map(|k| 3.0 * k as f32).collect());
    let input = Curves::new(vec![b.build().into()]);
    let (out, _) = run(&NODE, &[("curves", shaped(&input, &[number("twist", 45.0)]).into())]);
    let tuft = &curves_of(&out[0]).tufts()[0];
    // 480 degrees in all, 30 from point to point: 17 points for the 16 asked for.
    assert_eq!(tuft.curve(0).len(), 17);
    let flat = |p: Vec3| Vec2::new(p.x, p.z);
    for i in 0..tuft.len() {
        let points = tuft.curve(i);
        for pair in points[1..].windows(2) {
            let turn = flat(pair[0]).angle_to(flat(pair[1])).to_degrees();
            assert!((turn.abs() - 30.0).abs() < 0.05, "{turn}");
        }
    }
}

#[test]
fn what_all_share_is_stored_once_and_what_the_cluster_has_is_inherited() {
    let mut edit = clusters(1, 6).tufts()[0].edit();
    edit.set(COLOUR, Domain::Curve, vec![Vec3::X]);
    edit.set_named("section".into(), Domain::Curve, vec![4]);
    let input = Curves::new(vec![edit.build().into()]);
    let stored = |set: &[(&str, Value)], name: &str| {
        let out = fill(&input, set);
        out.tufts()[0].attribute(name).map_or(0, |a| a.values.len())
    };
    let out = fill(&input, &[]);
    let tuft = &out.tufts()[0];
    for name in [WIDTH.name, COLOUR.name, PARENT.name, "section"] {
        assert_eq!(stored(&[], name), 1, "{name}");
    }
    assert_eq!(tuft.view(COLOUR).at(3, 50), Vec3::X);
    assert_eq!(tuft.view(PARENT).at(0, 0), 100);
}

#[test]
fn what_is_no_cluster_is_left_out_and_said() {
    let mut b = TuftBuilder::new();
    b.push_curve(&[Vec3::Y * 9.0; 3]);
    b.push_curve(&[Vec3::Y * 9.0]);
    b.push_curve(&[Vec3::Y * 9.0, Vec3::NAN, Vec3::Y * 12.0]);
    b.push_curve(&[Vec3::Y * 9.0, Vec3::Y * 12.0]);
    b.set(ID, Domain::Curve, vec![1, 2, 3, 4]);
    let input = Curves::new(vec![b.build().into()]);
    let (out, said) = run(&NODE, &[("curves", input.into()), ("scalp", shared_ball().into())]);
    assert_eq!((curves_of(&out[0]).curve_count(), said.len()), (256, 3), "{said:?}");
    let finite = |t: &Arc<Tuft>| t.points().iter().all(|p| p.is_finite());
    assert!(curves_of(&out[0]).tufts().iter().all(finite));
}

/// How far a point of a strand is from its cluster in the frame, in cm: across, across, along.
fn place(point: Vec3, (centre, frame, _): &(Vec3, Frame, f32)) -> Vec3 {
    let d = point - *centre;
    Vec3::new(d.dot(frame.normal), d.dot(frame.binormal()), d.dot(frame.tangent))
}

#[test]
fn shaped_strands_stay_within_their_cluster() {
    let taper = Ramp::linear(1.0, 0.0);
    let cases: [&[(&str, Value)]; 2] = [
        &[("profile", taper.into())],
        &[number("flatness", 0.25), number("turn", 30.0), number("twist", 15.0)],
    ];
    let input = clusters(20, 7);
    for (case, set) in cases.iter().enumerate() {
        let (mut worst, mut tips) = (0.0f32, 0.0f32);
        for tuft in fill(&deep(&shaped(&input, set)), &[]).tufts() {
            let id = tuft.view(PARENT).at(0, 0);
            let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
            let radius = cluster.view(RADIUS).at(0, 0);
            let sections = sections(cluster.curve(0), 16);
            for i in 0..tuft.len() {
                let points = tuft.curve(i);
                for (p, section) in points.iter().zip(&sections).skip(1) {
                    worst = worst.max(place(*p, section).truncate().length() - radius);
                }
                tips = tips.max(place(points[15], &sections[15]).truncate().length() / radius);
            }
        }
        assert!(worst < 1e-4, "case {case}: {worst}");
        assert!(case > 0 || tips < 1e-4, "case {case}: tips {tips} radii from the middle");
    }
}

#[test]
fn a_cross_section_that_says_nothing_changes_no_cluster_and_a_turn_turns_its_flat_side() {
    let input = clusters(8, 8);
    assert_eq!(shaped(&input, &[]).key(), input.key());
    // As thin as asked, across the turned way.
    for turn in [0.0f32, 60.0] {
        let flat = shaped(&input, &[number("flatness", 0.2), number("turn", turn)]);
        for tuft in fill(&deep(&flat), &[]).tufts() {
            let id = tuft.view(PARENT).at(0, 0);
            let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
            let radius = cluster.view(RADIUS).at(0, 0);
            let sections = sections(cluster.curve(0), 16);
            let ends: Vec<Vec3> =
                (0..tuft.len()).map(|i| place(tuft.curve(i)[15], &sections[15])).collect();
            // The thinnest way across, of ninety, and that of clusters that are not turned.
            let across = |ends: &[Vec3]| -> (f32, i32) {
                let thick = (0..90).map(|k| {
                    let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 180.0);
                    (ends.iter().map(|e| (e.x * c + e.y * s).abs()).fold(0.0, f32::max), 2 * k)
                });
                thick.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
            };
            let (thin, way) = across(&ends);
            assert!((0.15..0.23).contains(&(thin / radius)), "{thin} of {radius}");
            let level = fill(&deep(&shaped(&input, &[number("flatness", 0.2)])), &[]);
            let level = level.tufts().iter().find(|t| t.view(PARENT).at(0, 0) == id).unwrap();
            let ends: Vec<Vec3> =
                (0..level.len()).map(|i| place(level.curve(i)[15], &sections[15])).collect();
            let off = (way - across(&ends).1).rem_euclid(180);
            assert!((off - turn as i32).abs() <= 6, "{off} of {turn}");
        }
    }
}

#[test]
fn only_a_twist_gives_strands_more_points_and_one_that_asks_for_too_many_is_told_once() {
    let input = clusters(6, 10);
    let filled = |twist: f32, points: i64| {
        let input = shaped(&input, &[number("twist", twist)]);
        let set =
            [("curves", input.into()), ("count", Value::Int(5)), ("points", Value::Int(points))];
        let (out, said) = run(&NODE, &set);
        let hair = curves_of(&out[0]).clone();
        let most = hair.each().map(|(tuft, i)| tuft.curve(i).len()).max();
        (hair.curve_count(), most.unwrap_or(0), said)
    };
    // 36,000 degrees ask for 1,200 points.
    let (hairs, most, said) = filled(3600.0, 16);
    assert_eq!((hairs, most), (30, 255));
    assert!(
        said.len() == 1 && said[0].starts_with(COARSE) && said[0].contains("6 curves"),
        "{said:?}"
    );
    assert_eq!(filled(0.0, 300), (30, 300, vec![]));
    assert_eq!(filled(45.0, 255), (30, 255, vec![]));
}

#[test]
fn a_cluster_that_begins_in_a_point_is_filled_as_where_it_is_open_first() {
    let check = |radii: [f32; 4], strands: usize, root: f32| {
        let mut b = TuftBuilder::new();
        b.push_curve(&[9.0, 11.0, 13.0, 15.0].map(|y| Vec3::Y * y));
        b.set(ID, Domain::Curve, vec![7u64]);
        b.set(DENSITY, Domain::Curve, vec![1.0]);
        b.set(RADIUS, Domain::Point, radii.to_vec());
        let cluster: Curves = Curves::new(vec![Arc::new(b.build())]);
        let (out, said) = run(&NODE, &[("curves", cluster.into())]);
        let hair = curves_of(&out[0]);
        assert_eq!(hair.curve_count(), strands, "{radii:?}");
        let far = hair.each().map(|(tuft, i)| tuft.curve(i)[0].distance(Vec3::Y * 9.0));
        let far = far.fold(0.0, f32::max);
        // Few need not reach its edge.
        let least = if strands > 100 { 0.9 * root } else { 0.0 };
        assert!(far <= root * 1.001 && far >= least, "{radii:?}: {far}");
        said
    };
    let quiet = |radii: [f32; 4], strands: usize, root: f32| {
        let said = check(radii, strands, root);
        assert!(said.is_empty(), "{said:?}");
    };
    // 512 strands at 1 cm: 512 x 0.5 x 0.5 = 128, and 0.02 cm holds 0.2 of one, which is none.
    quiet([0.5, 0.3, 0.3, 0.1], 128, 0.5);
    quiet([0.0, 0.5, 0.7, 0.1], 128, 0.5);
    quiet([1e-4, 0.02, 0.5, 0.1], 128, 0.5);
    // 512 x 0.06 x 0.06 = 1.84 where a cone that opens slowly is first open, of 512 that its widest section would have; and 7.4,
    // of which 46 are not so many more.
    let said = check([0.0, 0.06, 0.5, 1.0], 2, 0.06);
    assert_eq!(
        said,
        [
            "1 of 1 clusters have hardly any hair, for strands are counted where a cluster is first open at its root: radius \
          0.0600 cm asks for 2 there, 1.0000 cm where it is widest for 512 (strands 512): open the root wider \
          (Cross-section), or set count"
        ]
    );
    quiet([0.0, 0.12, 0.3, 0.2], 7, 0.12);
    let said = check([0.0, 0.01, 0.02, 0.0], 0, 0.0);
    assert_eq!(
        said,
        [
            "no cluster holds a strand: at their widest, radius 0.0200 cm and density 1.0000 ask for 0.20 (strands 512): raise \
          radius, density or strands, or set count"
        ]
    );
}
