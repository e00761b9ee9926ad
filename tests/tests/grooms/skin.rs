//! No drawn curve dives under the skin: every groom and recipe, judged by geometry that is not coif's (`coif_tests::judge`).
//!
//! Here the judge itself is judged too, by balls that can be worked out by hand.

use super::light::light;
use super::shipped::{recipe, tenth};
use coif_graphs::grooms;
use coif_graphs::schedule::run::Evaluator;
use coif_nodes::formats::usd::read::{ReadCurves, read_stage};
use coif_tests::judge::{Found, Judge, Place, Soup, head_of, region};
use coif_tests::long::is_long;
use coif_tests::{RealHead, SCAN, curves_in, one_of, real_heads, smooth_heads};
use glam::DVec3;
use std::path::Path;

/// A ball of this radius around the origin, its triangles so small that it is one to 1e-3 cm; without what lies under `floor`.
fn ball(radius: f64, floor: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    const RINGS: u32 = 200;
    const SIDES: u32 = 400;
    let turn = |share: f64| (std::f64::consts::TAU * share).sin_cos();
    let at = |ring: u32, side: u32| {
        let (out, up) = turn(0.5 * f64::from(ring) / f64::from(RINGS));
        let out = if ring == RINGS { 0.0 } else { out };
        let (x, z) = turn(f64::from(side % SIDES) / f64::from(SIDES));
        radius * DVec3::new(out * x, up, out * z)
    };
    let (mut points, mut triangles) = (vec![], vec![]);
    for (ring, side) in (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let four = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(r, s)| at(ring + r, side + s));
        for three in [[0, 1, 2], [0, 2, 3]].map(|three| three.map(|k: usize| four[k])) {
            let first = points.len() as u32;
            let is_whole = three[0] != three[1] && three[1] != three[2] && three[2] != three[0];
            if is_whole && three.iter().all(|p| p.y >= floor) {
                points.extend(three);
                triangles.push([first, first + 1, first + 2]);
            }
        }
    }
    (points, triangles)
}

/// Points that look strewn, within `reach` of the origin along each axis.
fn strewn(count: usize, reach: f64) -> impl Iterator<Item = DVec3> {
    let mut state = 1u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        reach * ((state >> 33) as f64 / f64::from(1u32 << 30) - 1.0)
    };
    (0..count).map(move |_| DVec3::new(next(), next(), next()))
}

/// One prim of curves, as a file says it.
fn read(points: &[&[DVec3]], more: &str) -> ReadCurves {
    let list = |all: Vec<String>| all.join(", ");
    let counts = list(points.iter().map(|curve| curve.len().to_string()).collect());
    let all = points.iter().flat_map(|curve| *curve);
    let all = list(all.map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect());
    let text = format!(
        "#usda 1.0\n(\n metersPerUnit = 0.01\n upAxis = \"Y\"\n)\ndef BasisCurves \"hair\" {{\n uniform token type = \"cubic\"\n \
         uniform token basis = \"catmullRom\"\n uniform token wrap = \"pinned\"\n int[] curveVertexCounts = [{counts}]\n point3f[] \
         points = [{all}]\n int[] primvars:skinprim = [0] (interpolation = \"constant\")\n{more}\n}}\n"
    );
    let nothing = &mut |_: &str| Err("there is nothing beside it".to_owned());
    let read = read_stage(text.as_bytes(), "hair.usda", nothing).unwrap();
    assert_eq!(read.left_out, []);
    read.curves.into_iter().next().unwrap()
}

#[test]
fn inside_and_nearest_are_what_looking_at_every_triangle_finds() {
    for floor in [-10.0, -3.0] {
        let (points, triangles) = ball(9.0, floor);
        let skin = Soup::new(&points, &triangles).unwrap();
        assert_eq!(skin.len().1, usize::from(floor > -9.0), "borders");
        for p in strewn(60, 12.0) {
            let (quick, all) = (skin.winding(p), skin.winding_by_all(p));
            assert!((quick - all).abs() < 1e-3, "{p}: {quick} for {all}");
            assert_eq!(skin.is_inside(p), all > 0.5, "{p}: {all}");
            let sides = [p, 0.9 * p].map(|p| skin.is_inside(p));
            let passes = skin.is_between(p, 0.9 * p);
            assert!(passes || sides[0] == sides[1] || p.y < floor + 1.0, "{p}: {sides:?}");
            assert!(!passes || (8.9..10.1).contains(&p.length()), "{p}");
            assert_eq!(skin.nearest(p, 0).distance, skin.nearest_by_all(p).distance, "{p}");
        }
    }
}

/// Curves around a ball of 9 cm, through points at this distance from its middle, 15 degrees from each to the next.
fn around(radius: f64, count: usize) -> Vec<DVec3> {
    let at = |k: usize| {
        let (sin, cos) = (15.0 * k as f64).to_radians().sin_cos();
        radius * DVec3::new(sin, cos, 0.0)
    };
    (0..count).map(at).collect()
}

#[test]
fn a_curve_that_dives_between_points_that_lie_outside_is_found_and_its_deepest_place_too() {
    let (points, triangles) = ball(9.0, -10.0);
    let skin = Soup::new(&points, &triangles).unwrap();
    let judge = Judge::default();
    // Two points make a straight line: its middle is as deep as its sagitta.
    let straight = [around(9.0, 3)[0], around(9.0, 3)[2]];
    let sagitta = 9.0 * (1.0 - 15f64.to_radians().cos());
    let check = |more: &str, by: f64| {
        let found = judge.judge(&skin, &[read(&[&straight], more)]);
        let deepest = found.deepest.map_or(0.0, |place| place.by);
        assert!((deepest - by).abs() < 2e-3, "{more}: {found:?} for {by}");
        assert_eq!((found.hairs, found.samples, found.off), (1, 11, 0), "{more}");
        assert_eq!((found.deep > 0, found.deep_hairs), (by > 0.0, usize::from(by > 0.0)), "{more}");
    };
    check("", sagitta);
    check(" float[] primvars:allow_depth = [0.1] (interpolation = \"constant\")", sagitta - 0.1);
    check(" float[] primvars:allow_depth = [0.2] (interpolation = \"uniform\")", sagitta - 0.2);
    let sloping = |t: f64| straight[0].lerp(straight[1], t).length() + 0.2 * t;
    let sloping = (0..=1000).map(|k| 9.0 - sloping(f64::from(k) / 1e3)).fold(0.0, f64::max);
    check(" float[] primvars:allow_depth = [0, 0.2] (interpolation = \"vertex\")", sloping);
    check(" float[] primvars:allow_depth = [0.32] (interpolation = \"constant\")", 0.0);
    // A smooth one keeps to the ball between its points.
    let found = judge.judge(&skin, &[read(&[&around(9.0, 20)], "")]);
    assert!(
        found.deepest.is_some_and(|place| place.along < 1.0 || place.along > 18.0),
        "{found:?}"
    );
    let found = judge.judge(&skin, &[read(&[&around(9.1, 20)], "")]);
    assert_eq!((found.deepest, found.off, found.hairs), (None, 1, 1));
    // Its second point lies outside, and the curve dives behind it.
    let hook = [DVec3::Y * 9.0, DVec3::new(0.4, 9.02, 0.0), DVec3::new(0.5, 12.0, 0.0)];
    let dense = {
        let [a, b, c] = hook;
        let before = 2.0 * a - b;
        let at = |t: f64| {
            let s = 1.0 - t;
            let [p, q] = [a + (b - before) / 6.0, b - (c - a) / 6.0];
            a * s.powi(3) + p * (3.0 * s * s * t) + q * (3.0 * s * t * t) + b * t.powi(3)
        };
        (0..=10_000).map(|k| 9.0 - at(f64::from(k) / 1e4).length()).fold(0.0, f64::max)
    };
    assert!(dense > 0.05, "{dense}");
    let found = judge.judge(&skin, &[read(&[&hook], "")]);
    assert!((found.deepest.unwrap().by - dense).abs() < 2e-3, "{found:?} for {dense}");
}

#[test]
fn roots_off_the_skin_are_counted_but_for_hair_that_was_fed() {
    let (points, triangles) = ball(9.0, -10.0);
    let skin = Soup::new(&points, &triangles).unwrap();
    let on = |radius: f64| [DVec3::Y * radius, DVec3::Y * (radius + 1.0)];
    let all = [on(9.0), on(9.0005), on(9.002), on(9.3)];
    let all: Vec<&[DVec3]> = all.iter().map(|curve| &curve[..]).collect();
    let found = Judge::default().judge(&skin, &[read(&all, "")]);
    assert_eq!((found.hairs, found.rootless, found.off, found.deepest), (4, 0, 2, None));
    let farthest = found.farthest.unwrap();
    assert!(farthest.hair == [0, 3] && (farthest.by - 0.3).abs() < 1e-3, "{farthest:?}");
    let fed = " int[] primvars:fed = [0, 0, 0, 1] (interpolation = \"uniform\")";
    let found = Judge::default().judge(&skin, &[read(&all, fed)]);
    assert_eq!((found.rootless, found.off), (1, 1));
}

#[test]
fn under_an_open_neck_nothing_is_too_deep_and_above_it_what_is_inside() {
    let (points, triangles) = ball(9.0, -3.0);
    let skin = Soup::new(&points, &triangles).unwrap();
    let check = |from: DVec3, to: DVec3, deep: Option<f64>| {
        let found = Judge::default().judge(&skin, &[read(&[&[from, to]], "")]);
        let by = found.deepest.map(|place| place.by);
        let is = by.is_some() == deep.is_some();
        assert!(is && (by.unwrap_or(0.0) - deep.unwrap_or(0.0)).abs() < 0.2, "{found:?}");
    };
    let edge = points.iter().map(|p| p.y).fold(0.0, f64::min);
    check(DVec3::new(-20.0, edge - 1.0, 0.0), DVec3::new(20.0, edge - 1.0, 0.0), None);
    // From under it through the hole to the middle, through no triangle.
    check(DVec3::Y * -12.0, DVec3::ZERO, Some(9.0));
    check(DVec3::Y * -12.0, DVec3::Y * (edge - 0.1), None);
}

/// Judges a tenth of some hair, each on a head: every second one of it, or all where `COIF_LONG` is set.
fn judge_all<'a>(all: impl IntoIterator<Item = (&'static str, String, Option<&'a RealHead>)>) {
    let every = if is_long() { 1 } else { 2 };
    let judge = Judge { threads: 2, every, ..Judge::default() };
    let evaluator = Evaluator::new(2, 0).expect("threads");
    let mut wrong = vec![];
    for (text, name, head) in all {
        let on = head.map_or("the built-in head", |head| head.name);
        let mesh = head.map(|head| Path::new(&head.mesh));
        let (skin, frame) = head_of(text, Path::new(""), mesh, &evaluator)
            .unwrap_or_else(|err| panic!("{name} on {on}: {err}"));
        let mut curves = curves_in(tenth(&name, head).file());
        curves.retain(|curves| curves.purpose != "guide");
        let found = judge.judge(&skin, &curves);
        assert!(found.hairs > 0, "{name} on {on}");
        let mut tell = |what: &str, place: Option<Place>| {
            if let Some(Place { by, at, hair: [prim, hair], along, spans, .. }) = place {
                wrong.push(format!(
                    "{name} on {on}: {what} by {by:.4} cm: {} {at:.2}, {} hair {hair} at {along:.1} of {spans}",
                    region(at, &frame),
                    curves[prim].path
                ));
            }
        };
        let Found { deep_hairs, off, hairs, .. } = found;
        tell(&format!("{deep_hairs} of {hairs} hairs too deep, the deepest"), found.deepest);
        tell(&format!("{off} of {hairs} roots off the skin, the farthest"), found.farthest);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Each on the heads on which it is measured, but for the scan, whose skin is rough: on the built-in head for it.
#[test]
fn no_curve_of_a_groom_dives_under_the_skin_of_any_head() {
    let test = "no_curve_of_a_groom_dives_under_the_skin";
    let (real, smooth): (Vec<_>, Vec<_>) =
        (real_heads(test).collect(), smooth_heads(test).collect());
    let light =
        light().enumerate().flat_map(|(i, name)| one_of(&smooth, i).map(move |on| (name, on)));
    let heroes = grooms::HEROES.iter().enumerate();
    let heroes = heroes.flat_map(|(i, name)| one_of(&real, i).map(move |on| (*name, on)));
    judge_all(light.chain(heroes).map(|(name, head)| {
        let text = grooms::by_name(name).expect("a groom");
        (text, name.to_owned(), Some(head).filter(|head| head.name != SCAN))
    }));
}

#[test]
fn no_curve_of_a_recipe_dives_under_the_skin_of_any_head() {
    let smooth: Vec<_> = smooth_heads("no_curve_of_a_recipe_dives_under_the_skin").collect();
    let places: Vec<_> = [None].into_iter().chain(smooth.iter().map(Some)).collect();
    let all = grooms::TEMPLATES.iter().enumerate();
    judge_all(all.flat_map(|(i, (name, text))| {
        one_of(&places, i).map(move |head| (*text, recipe(name), *head))
    }));
}
