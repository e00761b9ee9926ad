//! What drawn regions promise: hair only inside the line, on heads and animals, by name, and a message for what does
//! not fit.

use crate::data::scalp::Scalp;
use crate::data::strokes::{Sample, Stroke, Strokes};
use crate::define::Value;
use crate::testing::{area_within, curves_of, fails, head, round, run, shared_head};
use glam::Vec3;
use std::sync::Arc;

fn drawn(strokes: Vec<Stroke>) -> [(&'static str, Value); 3] {
    [
        ("region", "hairline".into()),
        ("hairline", Strokes(strokes).into()),
        ("edge", Value::Float(0.0)),
    ]
}

#[test]
fn hair_grows_inside_a_drawn_line_alone() {
    let check = |set: &[(&str, Value)], centre: Vec3, radius: f32| {
        let plain = head(set);
        // On heads in head units, on animals as a fraction of their bounding box.
        let (low, high) = plain.surface().bounds();
        let near = match set {
            [] => plain.frame().point_from_head(centre),
            _ => low + (high - low) * centre,
        };
        let middle = plain.closest_root(near).unwrap().point;
        let line = round(&plain, 1, middle, radius);
        let (out, said) =
            run(crate::by_id("head").unwrap(), &[set, &drawn(vec![line])[..]].concat());
        let Value::Scalp(scalp) = &out[0] else { panic!("a scalp") };
        let told: Vec<&String> = said.iter().filter(|s| s.contains("stroke")).collect();
        assert!(told.is_empty(), "{told:?}");
        let wide = area_within(scalp, middle, radius);
        let told = said.iter().find_map(|s| s.strip_prefix("scalp: ")?.strip_suffix(" cm2"));
        let told: f32 = told.unwrap().parse().unwrap();
        assert!((told / wide - 1.0).abs() < 0.02, "{told} cm2 of {wide}");
        let hair = [("scalp", scalp.clone().into()), ("count", Value::Int(1500))];
        let (grown, _) = run(crate::by_id("scatter_guides").unwrap(), &hair);
        let mut outermost = 0.0f32;
        for (tuft, i) in curves_of(&grown[0]).each() {
            outermost = outermost.max(tuft.curve(i)[0].distance(middle));
        }
        assert!(curves_of(&grown[0]).curve_count() > 700);
        // The line's chords are slightly inside, where the skin bends slightly outward.
        assert!((0.93..1.006).contains(&(outermost / radius)), "{outermost} of {radius}");
    };
    // The side of the jaw, around one eye, and over the crown.
    check(&[], Vec3::new(6.0, -6.0, 4.0), 2.2);
    check(&[], Vec3::new(3.2, 0.0, 8.5), 1.7);
    check(&[], Vec3::new(0.0, 9.0, 0.0), 6.0);
    let animal = [("fit", Value::from("none"))];
    for (name, centre, radius) in [
        ("rat/street_rat_4k.gltf", Vec3::new(0.5, 0.25, 0.55), 0.6),
        ("spot/spot_triangulated.obj", Vec3::new(0.91, 0.344, 0.534), 0.25),
    ] {
        let Some(file) = crate::testing::shared_file(name) else {
            println!("skipped: hair_grows_inside_a_drawn_line_alone needs ../shared/data/{name}");
            continue;
        };
        check(&[&animal[..], &[("mesh", Value::File(file))]].concat(), centre, radius);
    }
}

#[test]
fn regions_have_names_holes_and_the_side_of_their_point() {
    let plain = head(&[]);
    let at = |p: Vec3| plain.closest_root(plain.frame().point_from_head(p)).unwrap().point;
    let (chin, crown) = (at(Vec3::new(0.0, -8.0, 7.0)), at(Vec3::new(0.0, 9.0, 0.0)));
    let lines = || {
        vec![
            round(&plain, 1, chin, 3.0),
            round(&plain, 2, crown, 6.0),
            round(&plain, 3, crown, 2.0),
        ]
    };
    let made = |names: &str, strokes| {
        let set = [&drawn(strokes)[..], &[("names", names.into())]].concat();
        let (out, said) = run(crate::by_id("head").unwrap(), &set);
        let Value::Scalp(scalp) = &out[0] else { panic!("a scalp") };
        (scalp.clone(), said)
    };
    let value = |scalp: &Arc<Scalp>, name: &str, p: Vec3| {
        let root = scalp.closest_root(p).unwrap();
        scalp.mask_named(name).map(|mask| mask(root.triangle, root.bary))
    };
    let beside = crown + Vec3::X * 4.0;
    let (scalp, said) = made("beard 0 -8 7; top 4 9 0", lines());
    for (name, values) in
        [("beard", [1.0, 0.0, 0.0]), ("top", [0.0, 0.0, 1.0]), ("scalp", [1.0, 0.0, 1.0])]
    {
        let found = [chin, crown, beside].map(|p| value(&scalp, name, p).unwrap());
        assert_eq!(found, values, "{name} {said:?}");
    }
    assert!(said.iter().any(|s| s.contains("leave") && s.contains("hole")), "{said:?}");
    assert!(said.iter().any(|s| s.starts_with("\"beard\": 38")), "{said:?}");
    // Everything except the chin.
    let (scalp, said) = made("rest 0 9 0", vec![round(&plain, 1, chin, 3.0)]);
    assert_eq!([chin, crown].map(|p| value(&scalp, "rest", p)), [Some(0.0), Some(1.0)]);
    assert!(said.iter().any(|s| s.contains("encloses that side")), "{said:?}");
    let told = |names: &str, what: &str| {
        let (_, said) = made(names, vec![round(&plain, 1, chin, 3.0)]);
        assert!(said.iter().any(|s| s.contains(what)), "{said:?}");
    };
    told("beard", "is no name with a point");
    told("scalp 0 -8 7", "names all drawn regions");
    let many: String = (0..300).map(|i| format!("n{i} 0 -8 7;")).collect();
    told(&many, "300 names are given; the first 256");
}

#[test]
fn a_line_that_misses_the_skin_or_is_open_is_told_with_its_place() {
    let plain = head(&[]);
    let chin =
        plain.closest_root(plain.frame().point_from_head(Vec3::new(0.0, -8.0, 7.0))).unwrap();
    let whole = round(&plain, 1, chin.point, 3.0);
    let check = |change: &dyn Fn(&mut Vec<Sample>), what: &str| {
        let mut stroke = whole.clone();
        change(&mut stroke.samples);
        let (_, said) = run(crate::by_id("head").unwrap(), &drawn(vec![stroke]));
        assert!(said.iter().any(|s| s.contains(what)), "{said:?}");
    };
    check(&|samples| samples.iter_mut().for_each(|s| s.position *= 1.2), "it is 2");
    check(&|samples| samples.truncate(60), "stroke 1 is open: its ends, at (");
    let none = drawn(vec![Stroke::new(1, whole.samples[..2].to_vec())]);
    assert_eq!(
        fails(crate::by_id("head").unwrap(), &none),
        "no outline is drawn: draw a closed stroke"
    );
    // As drawn on another head: still a region.
    if let Some(other) =
        shared_head("a_line_that_misses", "lps_head/LeePerrySmith.glb", &drawn(vec![whole.clone()]))
    {
        assert!(other.grows(0, glam::Vec2::ZERO) <= 1.0 && other.spread().area() > 5.0);
    }
}
