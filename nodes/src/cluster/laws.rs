//! Laws of filled clusters (methods.md 6), on random clusters on a ball.

use super::cluster_to_strands::{COARSE, NODE};
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
    for tuft in fill(&input, &[("push_out", false.into())]).tufts() {
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
    let cases: [&[(&str, Value)]; 4] = [
        &[number("frizz", 1.0)],
        &[number("frizz", 0.9), number("twist", 45.0), number("frizz_step", 0.0)],
        &[number("frizz", 0.5), ("radius", taper.clone().into())],
        &[number("twist", -170.0), ("points", Value::Int(4)), number("frizz_step", 0.3)],
    ];
    let input = clusters(40, 2);
    for (case, set) in cases.iter().enumerate() {
        let mut worst = 0.0f32;
        for tuft in fill(&input, &[&[("push_out", false.into())], *set].concat()).tufts() {
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
        assert!(pushed > 100, "nothing was tried: {pushed}");
    }
}

#[test]
fn more_density_only_adds_and_a_preview_is_the_start_of_the_final_hair() {
    let input = clusters(10, 4);
    let all = [number("frizz", 0.7), number("twist", 20.0)];
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
    let (out, _) = run(&NODE, &[("curves", input.into()), number("twist", 45.0)]);
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
    assert_eq!(stored(&[number("width_tip", 0.001)], WIDTH.name), tuft.points().len());
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
fn clumped_tapered_flat_and_jittered_strands_stay_within_their_cluster() {
    let taper = Ramp::linear(1.0, 0.0);
    let cases: [&[(&str, Value)]; 4] = [
        &[number("tip_clump", 1.0)],
        &[("profile", taper.into()), number("jitter", 0.4)],
        &[number("flatness", 0.25), number("flat_angle", 30.0)],
        &[number("tip_clump", 0.8), ("wisps", Value::Int(5)), number("length_variation", 0.6)],
    ];
    let input = clusters(20, 7);
    for (case, set) in cases.iter().enumerate() {
        let (mut worst, mut tips) = (0.0f32, 0.0f32);
        for tuft in fill(&input, &[&[("push_out", false.into())], *set].concat()).tufts() {
            let id = tuft.view(PARENT).at(0, 0);
            let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
            let radius = cluster.view(RADIUS).at(0, 0);
            let sections = sections(cluster.curve(0), 16);
            for i in 0..tuft.len() {
                let points = tuft.curve(i);
                // What is cut has its points between sections.
                if case < 3 {
                    for (p, section) in points.iter().zip(&sections).skip(1) {
                        worst = worst.max(place(*p, section).truncate().length() - radius);
                    }
                    tips = tips.max(place(points[15], &sections[15]).truncate().length() / radius);
                }
                let length = |p: &[Vec3]| p.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
                let bent = 1.0 + 2.0 * radius / length(cluster.curve(0));
                assert!(length(points) <= bent * 1.5 * length(cluster.curve(0)));
            }
        }
        assert!(worst < 1e-4, "case {case}: {worst}");
        assert!(case > 1 || tips < 1e-4, "case {case}: tips {tips} radii from the middle");
    }
}

#[test]
fn a_flat_section_is_as_thin_as_asked_and_shapes_of_strands_do_not_depend_on_their_number() {
    let input = clusters(8, 8);
    let straight = [("push_out", false.into())];
    for tuft in fill(&input, &[&straight[..], &[number("flatness", 0.2)]].concat()).tufts() {
        let id = tuft.view(PARENT).at(0, 0);
        let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
        let radius = cluster.view(RADIUS).at(0, 0);
        let sections = sections(cluster.curve(0), 16);
        let ends: Vec<Vec3> =
            (0..tuft.len()).map(|i| place(tuft.curve(i)[15], &sections[15])).collect();
        // The thinnest way across, of ninety.
        let thin = (0..90).map(|k| {
            let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 180.0);
            ends.iter().map(|e| (e.x * c + e.y * s).abs()).fold(0.0, f32::max)
        });
        let thin = thin.fold(f32::MAX, f32::min) / radius;
        assert!((0.15..0.23).contains(&thin), "{thin}");
    }
    let all = [
        number("tip_clump", 0.7),
        ("wisps", Value::Int(4)),
        number("length_variation", 0.5),
        number("jitter", 0.2),
        number("stray", 0.3),
    ];
    let with = |density| fill(&input, &[&all[..], &[number("density", density)]].concat());
    for (a, b) in with(0.3).tufts().iter().zip(with(0.6).tufts()) {
        assert!(a.len() < b.len());
        assert!((0..a.len()).all(|i| (a.id(i), a.curve(i)) == (b.id(i), b.curve(i))));
    }
}

#[test]
fn stray_strands_are_as_many_and_as_far_off_as_asked() {
    let input = clusters(12, 9);
    let asked = [("push_out", false.into()), number("stray", 0.25), number("stray_amount", 3.0)];
    let (mut off, mut all) = (0, 0);
    for (tuft, calm) in fill(&input, &asked).tufts().iter().zip(fill(&input, &asked[..1]).tufts()) {
        for i in 0..tuft.len() {
            let (a, b) = (tuft.curve(i)[15], calm.curve(i)[15]);
            assert_eq!(tuft.curve(i)[0], calm.curve(i)[0]);
            assert!(a.distance(b) <= 3.0 * 1.001);
            off += usize::from(a.distance(b) > 1e-3);
            all += 1;
        }
    }
    assert!((off as f32 / all as f32 - 0.25).abs() < 0.03, "{off} of {all}");
}

#[test]
fn no_strand_has_more_points_than_it_may_and_a_twist_that_asks_for_more_is_told_once() {
    let input = clusters(6, 10);
    let filled = |set: &[(&str, Value)]| {
        let own = [("curves", input.clone().into()), ("count", Value::Int(5))];
        let (out, said) = run(&NODE, &[&own, set].concat());
        (curves_of(&out[0]).clone(), said)
    };
    let most =
        |curves: &Curves| curves.each().map(|(tuft, i)| tuft.curve(i).len()).max().unwrap_or(0);
    // 36,000 degrees ask for 1,200 points.
    let (out, said) = filled(&[number("twist", 3600.0)]);
    assert_eq!((out.curve_count(), most(&out)), (30, 255));
    assert!(
        said.len() == 1 && said[0].starts_with(COARSE) && said[0].contains("6 curves"),
        "{said:?}"
    );
    let (out, said) = filled(&[("points", Value::Int(300))]);
    assert_eq!((most(&out), said.len()), (255, 1), "{said:?}");
    let (out, said) = filled(&[number("twist", 3600.0), ("most_points", Value::Int(4000))]);
    assert!((1200..1400).contains(&most(&out)) && said.is_empty(), "{} {said:?}", most(&out));
    let (out, said) = filled(&[("points", Value::Int(255))]);
    assert!(most(&out) == 255 && said.is_empty(), "{said:?}");
}

#[test]
fn roots_draw_together_as_asked() {
    let input = clusters(12, 11);
    // Distance of roots from their cluster's, against that of roots that do not.
    let spread = |set: &[(&str, Value)]| {
        let (mut sum, mut n) = (0.0, 0);
        for tuft in fill(&input, set).tufts() {
            let id = tuft.view(PARENT).at(0, 0);
            let cluster = input.tufts().iter().find(|c| c.id(0) == id).unwrap();
            let root = cluster.curve(0)[0];
            sum += (0..tuft.len()).map(|i| tuft.curve(i)[0].distance(root)).sum::<f32>();
            n += tuft.len();
        }
        sum / n as f32
    };
    let whole = spread(&[]);
    let (half, none) = (spread(&[number("root_clump", 0.5)]), spread(&[number("root_clump", 1.0)]));
    assert!((half / whole - 0.5).abs() < 0.02, "{half} of {whole}");
    assert!(none < 1e-3, "{none}");
    // To wisps, not to the middle: as far out as those stand, and no more places than there are.
    let wisps = [number("root_clump", 1.0), ("wisps", Value::Int(4))];
    assert!((0.6..1.2).contains(&(spread(&wisps) / whole)), "{}", spread(&wisps) / whole);
    for tuft in fill(&input, &wisps).tufts() {
        let mut places: Vec<Vec3> = vec![];
        for i in 0..tuft.len() {
            let root = tuft.curve(i)[0];
            if places.iter().all(|p| p.distance(root) > 1e-3) {
                places.push(root);
            }
        }
        assert!(places.len() <= 4, "{}", places.len());
    }
}

#[test]
fn strands_wave_as_far_as_asked_and_are_cut_as_much() {
    let input = clusters(15, 12);
    let length = |p: &[Vec3]| p.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
    // Strands of clusters of one radius, without and with what is asked.
    let paired = |radius: f32, asked: (&'static str, Value)| {
        let count = ("count", Value::Int(60));
        let still = [("push_out", false.into()), number("radius", radius), count];
        let (calm, out) = (fill(&input, &still), fill(&input, &[&still[..], &[asked]].concat()));
        let pairs = calm.each().zip(out.each());
        pairs.map(|((a, i), (b, j))| (a.curve(i).to_vec(), b.curve(j).to_vec())).collect::<Vec<_>>()
    };
    for jitter in [0.1, 0.4] {
        let pairs = paired(2.0, number("jitter", jitter));
        let off =
            pairs.iter().flat_map(|(a, b)| a.iter().zip(b).skip(4).map(|(p, q)| p.distance(*q)));
        let off: Vec<f32> = off.collect();
        let mean = off.iter().sum::<f32>() / off.len() as f32;
        let most = off.iter().copied().fold(0.0, f32::max);
        // Two waves of that height across each other: at most its root of 2, in the mean nearly as much as one.
        assert!((0.75..1.0).contains(&(mean / jitter)), "{mean} of {jitter}");
        assert!(most <= 1.415 * jitter && most > 1.2 * jitter, "{most} of {jitter}");
    }
    for shorter in [0.3, 0.6] {
        // Thin ones: in bends of thick ones the inner strands are shorter than the outer.
        let pairs = paired(0.2, number("length_variation", shorter));
        let shares: Vec<f32> = pairs.iter().map(|(a, b)| length(b) / length(a)).collect();
        let (least, most) =
            shares.iter().fold((9.0f32, 0.0f32), |(a, b), s| (a.min(*s), b.max(*s)));
        let mean = shares.iter().sum::<f32>() / shares.len() as f32;
        // Drawn by a square, whose mean is a third.
        assert!((mean - (1.0 - shorter / 3.0)).abs() < 0.02, "{mean} of {shorter}");
        assert!(
            (least - (1.0 - shorter)).abs() < 0.06 && most > 0.99 && most < 1.02,
            "{least} {most}"
        );
    }
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
        let set = [("curves", cluster.into()), ("push_out", false.into())];
        let (out, said) = run(&NODE, &set);
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
          0.0600 cm asks for 2 there, 1.0000 cm where it is widest for 512 (strands 512): open the root wider (radius, \
          profile), or set count"
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
