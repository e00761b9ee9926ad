//! Laws of sphere puffs (methods.md 5), on a ball.

use super::sphere_puff::{DIPS, NODE};
use crate::data::attributes::{BRAID, Domain, ID};
use crate::data::attributes::{
    FIBRE, PARENT, PUFF, PUFF_CENTRE, PUFF_COVERAGE, PUFF_RADIUS, SCALP_NORMAL,
};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::scalp::tests::ball;
use crate::data::scalp::{HeadFrame, REGION, Root, Scalp};
use crate::define::Value;
use crate::eval::{Log, PlainHost, Quality};
use crate::laws::{MeasuredHair, depth, outlines, roots};
use crate::maths::closest::{Surface, tests::sphere};
use crate::maths::frame::{across, any_normal};
use crate::maths::spline::Spline;
use crate::maths::transcendental::{acos, atan2, cos};
use crate::testing::{curves_of, fails, run, run_on};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

fn puff(set: &[(&str, Value)]) -> (Curves, Curves, Vec<String>) {
    let (out, said) = run(&NODE, &[&[("scalp", ball().into())], set].concat());
    (curves_of(&out[0]).clone(), curves_of(&out[1]).clone(), said)
}

/// The ball's point for a puff, its normal there, and the sphere's centre for a radius of 6.
fn middle(scalp: &Scalp) -> (Root, Vec3) {
    let root = super::picked(scalp, Vec3::new(0.0, 8.0, -4.0)).unwrap();
    (root, root.point + root.normal * 6.0)
}

#[test]
fn guides_end_on_the_sphere_leave_along_the_normal_and_stay_outside() {
    let scalp = ball();
    let skin = scalp.skin();
    let (_, centre) = middle(&scalp);
    let (mut off, mut leaving, mut deepest, mut uneven) = (0.0f32, 1.0f32, 0.0f32, 1.0f32);
    for (tightness, bulge, tie) in [(0.5, 0.5, 1.0), (0.9, 0.0, 2.0), (0.0, 1.0, 0.5)] {
        let (guides, _, said) = puff(&[
            ("tightness", Value::Float(tightness)),
            ("bulge", Value::Float(bulge)),
            ("tie_height", Value::Float(tie)),
            ("count", Value::Int(0)),
        ]);
        assert_eq!(guides.curve_count(), 96);
        assert!(said.is_empty(), "{said:?}");
        for (tuft, i) in guides.each() {
            let points = tuft.curve(i);
            let spline = Spline::new(points).unwrap();
            off = off.max((points[points.len() - 1].distance(centre) / 6.0 - 1.0).abs());
            let normal = tuft.view(SCALP_NORMAL).at(i, 0);
            leaving = leaving.min(spline.tangent_at(0.0).dot(normal));
            for k in 0..=200 {
                deepest = deepest.min(skin.distance(spline.at(k as f32 / 200.0)));
            }
            for pair in
                points.windows(2).map(|w| w[0].distance(w[1])).collect::<Vec<_>>().windows(2)
            {
                uneven = uneven.max(pair[0].max(pair[1]) / pair[0].min(pair[1]));
            }
        }
    }
    assert!(off < 1e-4 && leaving > 0.99 && deepest > -1e-3, "{off} {leaving} {deepest}");
    // Where a tight tie bends hair within two CVs, even spacing yields to the direction at the root.
    assert!(uneven <= 1.6, "{uneven}");
}

#[test]
fn guides_keep_their_order() {
    let scalp = ball();
    let (root, _) = middle(&scalp);
    let (guides, _, _) = puff(&[("count", Value::Int(0))]);
    let tuft = &guides.tufts()[0];
    let (up, right) = (root.normal, any_normal(root.normal));
    let ahead = up.cross(right);
    let across = |row: usize, column: usize| -> Vec<Vec3> {
        let points = tuft.curve(row * 16 + column).iter().map(|p| *p - root.point);
        points.map(|p| Vec3::new(p.dot(right), p.dot(ahead), p.dot(up))).collect()
    };
    for row in 0..6 {
        for column in 0..16 {
            // One column further, always in the same direction.
            for (a, b) in across(row, column).iter().zip(across(row, (column + 1) % 16)) {
                let step = atan2(b.y, b.x) - atan2(a.y, a.x);
                let step = step - TAU * (step / TAU).round();
                assert!((step.abs() - TAU / 16.0).abs() < 0.15, "{row} {column}: {step}");
            }
        }
    }
    // Rows of a column lie in one half plane and do not cross there.
    for (row, other) in (0..5).flat_map(|row| (row + 1..6).map(move |other| (row, other))) {
        for column in 0..16 {
            let flat = |row| -> Vec<Vec2> {
                let points = across(row, column).into_iter();
                points.map(|p| Vec2::new(p.truncate().length(), p.z)).collect()
            };
            let side = |a: Vec2, b: Vec2, p: Vec2| (b - a).perp_dot(p - a) > 0.0;
            for a in flat(row).windows(2) {
                for b in flat(other).windows(2) {
                    let crossed = side(a[0], a[1], b[0]) != side(a[0], a[1], b[1])
                        && side(b[0], b[1], a[0]) != side(b[0], b[1], a[1]);
                    assert!(!crossed, "rows {row} and {other} of column {column} cross");
                }
            }
        }
    }
}

#[test]
fn the_fill_covers_the_sphere() {
    let (_, hair, _) = puff(&[("count", Value::Int(22_000))]);
    let curled = run(
        crate::by_id("shape_list_curl").unwrap(),
        &[("curves", hair.clone().into()), ("preset", "4a".into())],
    );
    for (what, hair) in [("straight", &hair), ("4a", curves_of(&curled.0[0]))] {
        let found = outlines::measure(&MeasuredHair::of(hair, &PlainHost)).unwrap();
        println!("{what}: {found:?}");
        // Rings whose far border lies 5 degrees or more inside what was asked.
        assert!(found.can_be_judged() && found.requested == Some(140.0), "{what}: {found:?}");
        assert!(found.are_clean() && found.coverage > 135.0, "{what}: {found:?}");
    }
}

#[test]
fn more_hair_only_adds_hair_and_preview_makes_the_first_of_it() {
    let ids = |hair: &Curves| hair.each().map(|(tuft, i)| tuft.id(i)).collect::<Vec<_>>();
    let point = |hair: &Curves, n: usize| {
        let (tuft, i) = hair.each().nth(n).unwrap();
        tuft.curve(i).to_vec()
    };
    let (_, few, _) = puff(&[("count", Value::Int(300))]);
    let (_, many, _) = puff(&[("count", Value::Int(2500))]);
    assert_eq!(ids(&few), ids(&many)[..300]);
    assert_eq!(ids(&many).into_iter().collect::<BTreeSet<_>>().len(), 2500);
    assert_eq!(point(&few, 250), point(&many, 250));
    let set = [("scalp", ball().into()), ("count", Value::Int(2500))];
    let out = run_on(&NODE, &set, &PlainHost, &Log::default(), Quality::Preview).unwrap();
    assert_eq!(ids(curves_of(&out[1])), ids(&many)[..250]);
}

#[test]
fn each_placement_has_its_puff_and_hair_is_bound_and_outside() {
    let mut b = TuftBuilder::new();
    b.push_curve(&[Vec3::new(-5.0, 7.5, 0.0), Vec3::new(-9.0, 12.0, 0.0)]);
    b.push_curve(&[Vec3::new(5.0, 7.5, 0.0), Vec3::new(9.0, 12.0, 0.0)]);
    b.push_curve(&[Vec3::NAN]);
    b.set(ID, Domain::Curve, vec![7, 8, 9]);
    let placements = Curves::new(vec![b.build().into()]);
    let (guides, hair, said) =
        puff(&[("placements", placements.into()), ("count", Value::Int(500))]);
    assert_eq!((guides.curve_count(), hair.curve_count()), (192, 1000));
    assert_eq!(said, ["a placement without a root was left out (curve 0000000000000009)"]);
    let scalp = ball();
    assert!(roots::off_their_places(&hair, &scalp) < 1e-3);
    assert!(depth::measure(&MeasuredHair::of(&hair, &PlainHost), &scalp).deepest_cm < 1e-3);
    let parents: BTreeSet<u64> = guides.each().map(|(tuft, i)| tuft.id(i)).collect();
    for (tuft, i) in hair.each() {
        let points = tuft.curve(i);
        assert!(parents.contains(&tuft.view(PARENT).at(i, 0)));
        let length = Spline::new(points).unwrap().length();
        assert!((tuft.view(FIBRE).at(i, 0) * 0.25 / length - 1.0).abs() < 0.02);
    }
}

#[test]
fn at_tips_a_braid_has_one_puff_at_the_end_of_its_strands() {
    let mut b = TuftBuilder::new();
    let up = Vec3::new(0.0, 9.0, 0.0);
    b.push_curve(&[up, Vec3::new(5.8, 7.0, 0.0)]);
    b.push_curve(&[up, Vec3::new(6.2, 7.0, 0.0)]);
    b.push_curve(&[up, Vec3::new(-6.0, 7.0, 0.0)]);
    b.push_curve(&[up, Vec3::new(0.0, 7.0, 40.0)]);
    b.set(ID, Domain::Curve, vec![1, 2, 3, 4]);
    b.set(BRAID, Domain::Curve, vec![77, 77, 0, 0]);
    let placements = Curves::new(vec![b.build().into()]);
    let set = [
        ("placements", placements.into()),
        ("at", "tips".into()),
        ("count", Value::Int(500)),
        ("rows", Value::Int(2)),
        ("columns", Value::Int(4)),
    ];
    let (guides, hair, said) = puff(&set);
    assert_eq!((guides.curve_count(), hair.curve_count()), (16, 1000));
    let why = "the tip of a placement hangs off the scalp and was left out";
    assert_eq!(said, [format!("{why} (curve 0000000000000004)")]);
    let right = hair.each().filter(|(tuft, i)| tuft.curve(*i)[0].x > 0.0).count();
    assert_eq!(right, 500, "one puff for the braid on the right, one on the left");
}

#[test]
fn any_outline_is_met_and_soft_edges_and_neighbours_are_as_asked() {
    let scalp = ball();
    let (_, centre) = middle(&scalp);
    let tips = |hair: &Curves| {
        hair.each().map(|(tuft, i)| *tuft.curve(i).last().unwrap()).collect::<Vec<_>>()
    };
    let clean = [("depth_to", Value::Float(0.0)), ("count", Value::Int(400))];
    let egg = [("shape", "ellipsoid".into()), ("stretch", Vec3::new(1.2, 0.9, 1.0).into())];
    let (guides, hair, _) = puff(&[&clean[..], &egg].concat());
    // Every hair stores the distance of the outline at its end.
    let told = |hair: &Curves| {
        for (tuft, i) in hair.each() {
            let tip = tuft.curve(i).last().unwrap().distance(tuft.view(PUFF_CENTRE).at(i, 0));
            assert!((tuft.view(PUFF_RADIUS).at(i, 0) / tip - 1.0).abs() < 1e-3);
        }
    };
    told(&guides);
    told(&hair);
    let (root, _) = middle(&scalp);
    let ahead = across(Vec3::Z, root.normal).unwrap();
    let right = ahead.cross(root.normal);
    for tip in tips(&guides).into_iter().chain(tips(&hair)) {
        let d = (tip - centre) / 6.0;
        let local = Vec3::new(d.dot(right) / 1.2, d.dot(root.normal) / 0.9, d.dot(ahead));
        assert!((local.length() - 1.0).abs() < 1e-3, "{}", local.length());
    }
    // A mesh of any form: here an egg modeled beside the head, whose own centre is the puff's.
    let round = sphere(5.0, 32);
    let egg = |p: &Vec3| *p * Vec3::new(1.0, 0.8, 1.2) + centre;
    let mesh = Surface::new(round.points.iter().map(egg).collect(), round.triangles.clone());
    let region = BTreeMap::from([(REGION.to_owned(), vec![1.0; mesh.points.len()])]);
    let mesh = Arc::new(Scalp::new(mesh, None, HeadFrame::IDENTITY, region));
    let drawn = [("shape", "mesh".into()), ("mesh", mesh.clone().into())];
    let (guides, hair, _) = puff(&[&clean[..], &drawn].concat());
    assert!(guides.curve_count() > 50 && hair.curve_count() == 400);
    told(&hair);
    for tip in tips(&guides).into_iter().chain(tips(&hair)) {
        let off = mesh.surface().closest(tip).unwrap().distance;
        assert!(off < 0.02, "{tip} is {off} off the mesh");
    }
    let soft = [("edge_softness", Value::Float(1.0))];
    let (_, hair, _) = puff(&[&clean[..], &soft].concat());
    let off: Vec<f32> = tips(&hair).iter().map(|tip| tip.distance(centre) - 6.0).collect();
    assert!(off.iter().all(|off| off.abs() <= 1.001) && off.iter().any(|off| off.abs() > 0.6));
    assert!(off.iter().filter(|off| off.abs() < 0.2).count() > off.len() / 2);
}

#[test]
fn puffs_that_meet_are_flat_between_and_grow_out_of_ties() {
    let tied = run(
        crate::by_id("gather").unwrap(),
        &[
            ("scalp", ball().into()),
            ("position", Vec3::new(3.0, 8.0, 0.0).into()),
            ("mirror", true.into()),
            ("density", Value::Float(1.0)),
        ],
    );
    let ties = curves_of(&tied.0[1]).clone();
    let set =
        [("ties", ties.clone().into()), ("count", Value::Int(300)), ("flatten", Value::Float(1.0))];
    let (guides, hair, _) = puff(&set);
    assert_eq!((guides.curve_count(), hair.curve_count()), (192, 600));
    let ids: BTreeSet<u64> = ties.each().map(|(tuft, i)| tuft.id(i)).collect();
    for (tuft, i) in hair.each() {
        assert!(ids.contains(&tuft.view(PUFF).at(i, 0)));
        let (centre, tip) = (tuft.view(PUFF_CENTRE).at(i, 0), *tuft.curve(i).last().unwrap());
        assert!(tip.x * centre.x.signum() > -1e-3, "{tip} {centre}");
        assert!(tip.distance(centre) <= 6.0 * 1.0001);
    }
}

#[test]
fn a_sphere_in_the_head_is_said() {
    let (_, _, said) = puff(&[("offset", Value::Float(0.0)), ("count", Value::Int(20))]);
    assert!(said.iter().any(|text| text.starts_with(DIPS)), "{said:?}");
}

/// Distance of each tip from the sphere's centre.
fn reaches(hair: &Curves, centre: Vec3) -> Vec<f32> {
    hair.each().map(|(tuft, i)| tuft.curve(i).last().unwrap().distance(centre)).collect()
}

#[test]
fn as_many_hairs_stray_as_asked_and_as_far() {
    let (_, centre) = middle(&ball());
    let clean = [("depth_to", Value::Float(0.0)), ("count", Value::Int(2000))];
    for (share, length) in [(0.1, 0.8), (0.4, 2.0)] {
        let stray = [("stray", Value::Float(share)), ("stray_length", Value::Float(length))];
        let (_, hair, _) = puff(&[&clean[..], &stray].concat());
        let over: Vec<f32> = reaches(&hair, centre).iter().map(|far| far - 6.0).collect();
        assert!(over.iter().all(|over| *over > -1e-3 && *over < length + 1e-3));
        // Most of them stick out only slightly: a tenth by less than a hundredth.
        let strays = over.iter().filter(|over| **over > 0.01 * length).count() as f32 / 2000.0;
        assert!((strays / (0.9 * share) - 1.0).abs() < 0.15, "{strays} of {share}");
        let farthest = over.iter().copied().fold(0.0, f32::max);
        assert!(farthest > 0.9 * length, "{farthest} of {length}");
    }
}

#[test]
fn hairs_are_as_dense_as_asked_whatever_the_circle() {
    for (density, radius) in [(20.0, 3.0), (20.0, 1.5), (45.0, 2.0)] {
        let (_, hair, _) = puff(&[
            ("fill", "density".into()),
            ("density", Value::Float(density)),
            ("root_radius", Value::Float(radius)),
            ("count", Value::Int(7)),
        ]);
        let wanted = density * PI * radius * radius;
        let made = hair.curve_count() as f32;
        assert!((made - wanted).abs() <= 1.0, "{made} of {wanted}");
    }
}

#[test]
fn tips_end_between_the_two_depths() {
    let (_, centre) = middle(&ball());
    for (from, to) in [(0.1, 0.3), (0.3, 0.1), (0.05, 0.05)] {
        let (_, hair, _) = puff(&[
            ("depth_from", Value::Float(from)),
            ("depth_to", Value::Float(to)),
            ("count", Value::Int(800)),
        ]);
        let depths: Vec<f32> = reaches(&hair, centre).iter().map(|far| 1.0 - far / 6.0).collect();
        let (low, high) = depths.iter().fold((9.0f32, -9.0f32), |(a, b), d| (a.min(*d), b.max(*d)));
        let (least, most) = (from.min(to), from.max(to));
        assert!((low - least).abs() < 0.01 && (high - most).abs() < 0.01, "{low} {high}");
        let mean = depths.iter().sum::<f32>() / 800.0;
        assert!((mean - 0.5 * (from + to)).abs() < 0.01, "{mean}");
    }
}

#[test]
fn tips_reach_down_to_the_coverage_and_lie_evenly_above_it() {
    let scalp = ball();
    let (root, centre) = middle(&scalp);
    for coverage in [30.0, 60.0, 90.0, 120.0, 165.0] {
        let (guides, hair, _) = puff(&[
            ("coverage", Value::Float(coverage)),
            ("depth_to", Value::Float(0.0)),
            ("count", Value::Int(1500)),
        ]);
        let polar = |curves: &Curves| {
            let way = |(tuft, i): (&crate::data::curves::Tuft, usize)| {
                let d = (*tuft.curve(i).last().unwrap() - centre).normalize();
                acos(d.dot(root.normal))
            };
            curves.each().map(way).collect::<Vec<f32>>()
        };
        let last = polar(&guides).into_iter().fold(0.0, f32::max).to_degrees();
        assert!((last - coverage).abs() < 0.1, "{last} of {coverage}");
        let tips = polar(&hair);
        let lowest = tips.iter().copied().fold(0.0, f32::max).to_degrees();
        // Between two guides of a row, the path is a great circle, which sags.
        assert!(lowest < coverage + 0.6 && lowest > coverage - 2.0, "{lowest} of {coverage}");
        // Half of them above the angle that halves the cap's area.
        let whole = 1.0 - cos(coverage.to_radians());
        let upper = tips.iter().filter(|polar| 1.0 - cos(**polar) < 0.5 * whole).count();
        assert!((upper as f32 / 1500.0 - 0.5).abs() < 0.03, "{upper} of {coverage}");
        let told = hair.tufts()[0].view(PUFF_COVERAGE).at(0, 0);
        assert_eq!(told, coverage);
    }
}

#[test]
fn drawn_outlines_are_met_from_front_and_side() {
    let scalp = ball();
    let (root, centre) = middle(&scalp);
    let ahead = across(Vec3::Z, root.normal).unwrap();
    let right = ahead.cross(root.normal);
    // Half axes across and along the puff's axis, drawn in its plane.
    let ring = |aside: Vec3, half: Vec2| {
        let points: Vec<Vec3> = (0..120)
            .map(|k| {
                let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 120.0);
                centre + aside * (half.x * s) + root.normal * (half.y * c)
            })
            .collect();
        let mut b = TuftBuilder::new();
        b.push_curve(&points);
        Value::from(Curves::new(vec![b.build().into()]))
    };
    let (front, side) = (Vec2::new(4.5, 6.5), Vec2::new(5.5, 6.5));
    let drawn = [
        ("shape", "drawn".into()),
        ("front", ring(right, front)),
        ("depth_to", Value::Float(0.0)),
        ("count", Value::Int(2500)),
    ];
    for both in [true, false] {
        let more = [("side", ring(ahead, side))];
        let set = if both { [&drawn[..], &more].concat() } else { drawn.to_vec() };
        let (_, hair, _) = puff(&set);
        let (mut seen, mut worst) = ([0; 2], 0.0f32);
        for (tuft, i) in hair.each() {
            let d = *tuft.curve(i).last().unwrap() - centre;
            let local = Vec3::new(d.dot(right), d.dot(root.normal), d.dot(ahead));
            let side = if both { side } else { Vec2::splat(6.0) };
            let views = [(local.x, local.z, front), (local.z, local.x, side)];
            for (view, (aside, off, half)) in views.into_iter().enumerate() {
                // Seen edge-on, where the other view has no effect.
                if off.abs() < 0.05 * d.length() && aside.abs() > 0.3 * d.length() {
                    seen[view] += 1;
                    let on = Vec2::new(aside, local.y) / half;
                    worst = worst.max((on.length() - 1.0).abs());
                }
            }
        }
        assert!(seen.iter().all(|n| *n > 25) && worst < 0.02, "{both}: {seen:?} {worst}");
    }
}

#[test]
fn a_mesh_that_is_missing_is_told() {
    let said = fails(&NODE, &[("scalp", ball().into()), ("shape", "mesh".into())]);
    assert!(said.contains("nothing is wired to mesh"), "{said}");
}

#[test]
fn puffs_that_fit_are_sized_by_the_distance_to_the_next_and_no_larger_than_asked() {
    let scalp = ball();
    let places = [-6.0f32, -3.0, 0.0, 8.0]
        .map(|x| scalp.closest_root(Vec3::new(x, 6.0, 0.0)).unwrap().point);
    let mut b = TuftBuilder::new();
    places.iter().for_each(|p| b.push_curve(&[*p, *p * 1.2]));
    b.set(ID, Domain::Curve, vec![1, 2, 3, 4]);
    let placements = Value::from(Curves::new(vec![b.build().into()]));
    let radii = |fit: bool, sphere: f32| -> Vec<f32> {
        let (guides, ..) = puff(&[
            ("placements", placements.clone()),
            ("fit", fit.into()),
            ("sphere_radius", Value::Float(sphere)),
            ("count", Value::Int(20)),
        ]);
        guides.tufts().iter().map(|tuft| tuft.view(PUFF_RADIUS).at(0, 0)).collect()
    };
    assert_eq!(radii(false, 6.0), [6.0; 4]);
    let next = |i: usize| {
        let others = (0..4).filter(|j| *j != i).map(|j| places[i].distance(places[j]));
        others.fold(f32::MAX, f32::min)
    };
    for (i, radius) in radii(true, 6.0).into_iter().enumerate() {
        let wanted = (0.75 * next(i)).min(6.0);
        assert!((radius - wanted).abs() < 1e-3, "{i}: {radius} for {wanted}");
    }
    assert_eq!(radii(true, 1.0), [1.0; 4]);
}
