//! What `partings` promises: patterns, drawn lines, names, and that moving one line leaves the rest unchanged.

use super::*;
use crate::data::attributes::Domain;
use crate::data::attributes::{ID, PARENT, PARTING, RADIUS, SECTION};
use crate::data::curves::TuftBuilder;
use crate::data::field::Field;
use crate::define::Value;
use crate::testing::{curves_of, run};
use std::collections::BTreeMap;

fn head() -> Arc<Scalp> {
    static HEAD: std::sync::OnceLock<Arc<Scalp>> = std::sync::OnceLock::new();
    let make = || match run(crate::by_id("head").unwrap(), &[]).0.remove(0) {
        Value::Scalp(scalp) => scalp,
        other => panic!("a {}", other.type_name()),
    };
    HEAD.get_or_init(make).clone()
}
fn scalp_of(value: &Value) -> Arc<Scalp> {
    match value {
        Value::Scalp(scalp) => scalp.clone(),
        other => panic!("a {}", other.type_name()),
    }
}
#[track_caller]
fn part(scalp: &Arc<Scalp>, set: &[(&str, Value)]) -> (Vec<Value>, Vec<String>) {
    let (out, mut said) = run(&NODE, &[&[("scalp", scalp.clone().into())], set].concat());
    said.retain(|s| !["sections:", "lengths"].iter().any(|word| s.contains(word)));
    (out, said)
}

/// Hair drawn to the guides that it was made from.
fn clumped(hair: &Value, guides: &Value, scalp: &Arc<Scalp>, amount: f32) -> Value {
    let set = [
        ("curves", hair.clone()),
        ("scalp", scalp.clone().into()),
        ("centres", guides.clone()),
        ("attribute", "parent".into()),
        ("amount", Value::Float(amount)),
        ("levels", Value::Int(1)),
        ("strays", Value::Float(0.0)),
        ("keep_length", false.into()),
    ];
    run(crate::by_id("clump").unwrap(), &set).0.remove(0)
}

#[test]
fn every_pattern_cuts_the_head_into_the_sections_that_were_asked_for() {
    let check = |pattern: &str, count: i64, cells: &str, want: std::ops::RangeInclusive<usize>| {
        let set =
            [("pattern", pattern.into()), ("count", Value::Int(count)), ("cells", cells.into())];
        let (out, said) = part(&head(), &set);
        let what = format!("{pattern} {cells}");
        assert!(said.is_empty(), "{what}: {said:?}");
        let scalp = scalp_of(&out[0]);
        let list = scalp.sections().unwrap().list();
        assert!(want.contains(&list.len()), "{what}: {}", list.len());
        let ids: std::collections::BTreeSet<u64> = list.iter().map(|s| s.id).collect();
        assert_eq!(ids.len(), list.len(), "{what}: ids are unique");
        let mean = list.iter().map(|s| s.area).sum::<f32>() / list.len() as f32;
        let least = list.iter().map(|s| s.area).fold(f32::MAX, f32::min);
        // The section inside rings is small, and so are cells beside the ears.
        let small = match (pattern, cells) {
            ("halo", _) => 0.05,
            (_, "whole") => 0.2,
            _ => 0.05,
        };
        assert!(least > small * mean, "{what}: {least} where {mean} is the mean");
        assert_eq!(curves_of(&out[3]).curve_count(), list.len(), "{what}");
        assert!(curves_of(&out[2]).curve_count() + 1 >= list.len(), "{what}");
        // Except where they continue over an ear.
        let lines: Vec<Vec3> =
            curves_of(&out[1]).each().flat_map(|(t, i)| t.curve(i).to_vec()).collect();
        let off = |p: &&Vec3| scalp.surface().closest(**p).unwrap().distance > 1e-3;
        let off = lines.iter().filter(off).count();
        assert!(off * 50 <= lines.len(), "{what}: {off} of {}", lines.len());
    };
    check("straight_back", 9, "whole", 9..=9);
    check("straight_back", 6, "whole", 6..=6);
    check("curved", 8, "whole", 8..=8);
    check("across", 7, "whole", 7..=7);
    check("gathered", 12, "whole", 13..=13);
    check("halo", 4, "whole", 5..=5);
    check("halo", 4, "boxes", 60..=110);
    check("across", 9, "boxes", 60..=120);
    check("across", 7, "triangles", 80..=180);
}

#[test]
fn rows_run_in_their_section_as_wide_as_it_is() {
    let (out, _) = part(&head(), &[("pattern", "straight_back".into())]);
    let scalp = scalp_of(&out[0]);
    let sections = scalp.sections().unwrap();
    for (tuft, i) in curves_of(&out[2]).each() {
        let points = tuft.curve(i);
        for (k, p) in points.iter().enumerate().skip(2).take(points.len() - 4) {
            assert_eq!(sections.id_at(*p), Some(tuft.view(SECTION).at(i, 0)));
            let (half, to) = (tuft.view(RADIUS).at(i, k), sections.at(*p).unwrap().distance);
            assert!(half < 4.0 && half > 0.5 * to.min(half), "{half} {to}");
        }
        // From the forehead to the nape.
        assert!(points[0].z > points[points.len() - 1].z + 5.0);
    }
}

#[test]
fn rows_that_are_drawn_already_are_parted_half_way_between_them() {
    let (out, _) = part(&head(), &[("pattern", "straight_back".into())]);
    let rows = curves_of(&out[2]).clone();
    let between = |rows: &Curves| {
        let set = [("between", Value::from(rows.clone())), ("wobble", Value::Float(0.0))];
        let (out, said) = part(&head(), &set);
        assert!(said.is_empty(), "{said:?}");
        (scalp_of(&out[0]), curves_of(&out[1]).clone())
    };
    let (scalp, lines) = between(&rows);
    let sections = scalp.sections().unwrap();
    assert_eq!(sections.list().len(), rows.curve_count());
    let own: std::collections::BTreeSet<u64> = rows
        .each()
        .map(|(tuft, i)| {
            let ids: Vec<Option<u64>> =
                tuft.curve(i).iter().skip(1).map(|p| sections.id_at(*p)).collect();
            assert!(ids.windows(2).all(|w| w[0] == w[1]), "a row leaves its section");
            ids[0].unwrap()
        })
        .collect();
    assert_eq!(own.len(), rows.curve_count(), "each row has a section of its own");
    let known: Vec<Row> =
        rows.each().map(|(tuft, i)| Row::new(tuft.id(i), tuft.curve(i)).unwrap()).collect();
    // Halfway, except where a line is extended straight to the hairline past the rows' ends.
    let mut off: Vec<f32> = vec![];
    for p in lines.each().flat_map(|(tuft, i)| tuft.curve(i)) {
        let mut far: Vec<f32> = known.iter().map(|row| row.nearest(*p).1).collect();
        far.sort_by(f32::total_cmp);
        off.push(far[1] - far[0]);
    }
    off.sort_by(f32::total_cmp);
    let (most, last) = (off[off.len() * 95 / 100], off[off.len() - 1]);
    assert!(most < 0.1 && last < 0.3, "{most} {last}");
    // A drifted row keeps its drift; and so does a drawn parting.
    let mut b = rows.tufts()[0].edit();
    b.set(DRIFT, Domain::Curve, vec![0.25]);
    let drifted = Curves::new(vec![Arc::new(b.build()), rows.tufts()[1].clone()]);
    let set = [("between", Value::from(drifted.clone())), ("lines", drifted.into())];
    let (out, _) = part(&head(), &set);
    let told = |curves: &Curves| -> Vec<f32> {
        let each = curves.each().filter(|(tuft, _)| tuft.attribute(DRIFT.name).is_some());
        each.map(|(tuft, i)| tuft.view(DRIFT).at(i, tuft.range(i).start)).collect()
    };
    assert_eq!(told(curves_of(&out[1])), [0.25]);
    assert_eq!(told(curves_of(&out[2])), [0.25]);
    assert!(curves_of(&out[1]).each().all(|(tuft, i)| tuft.view(PARTING).at(i, 0) != 0));
    // What lies beside other rows stays the same.
    let ids = |lines: &Curves| -> std::collections::BTreeSet<u64> {
        lines.each().map(|(tuft, i)| tuft.id(i)).collect()
    };
    let fewer = Curves::new(rows.tufts()[1..].to_vec());
    let (_, fewer) = between(&fewer);
    assert!(ids(&fewer).intersection(&ids(&lines)).count() + 2 >= ids(&fewer).len());
}

#[test]
fn rows_that_lie_about_scattered_have_a_section_each() {
    let check = |count: i64, apart: f32| {
        let scatter = crate::by_id("scatter_guides").unwrap();
        let set = [
            ("scalp", head().into()),
            ("count", Value::Int(count)),
            ("min_distance", Value::Float(apart)),
            ("length", Value::Float(0.4 * apart)),
            ("lie", Value::Float(0.0)),
        ];
        let rows = curves_of(&run(scatter, &set).0[0]).clone();
        assert_eq!(rows.curve_count(), count as usize);
        let (out, said) = part(&head(), &[("between", rows.clone().into())]);
        assert!(said.is_empty(), "{said:?}");
        let scalp = scalp_of(&out[0]);
        let sections = scalp.sections().unwrap();
        let own: std::collections::BTreeSet<u64> =
            rows.each().filter_map(|(tuft, i)| sections.id_at(tuft.curve(i)[0])).collect();
        let (n, each) = (sections.list().len(), own.len());
        // Narrow strips behind the ears are too small to cut.
        assert!(n == each && each * 100 >= rows.curve_count() * 95, "{n} {each} of {count}");
    };
    check(20, 3.0);
    check(60, 2.0);
    check(120, 1.5);
}

#[test]
fn a_parting_takes_the_guides_that_are_rooted_in_it_and_no_others() {
    let scatter = crate::by_id("scatter_guides").unwrap();
    let on = |scalp: &Arc<Scalp>| -> BTreeMap<u64, Vec3> {
        let set = [("scalp", scalp.clone().into()), ("count", Value::Int(800))];
        let guides = curves_of(&run(scatter, &set).0[0]).clone();
        guides.each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i)[0])).collect()
    };
    let rows = |turn: f32| {
        let set = [
            ("pattern", "straight_back".into()),
            ("count", Value::Int(4)),
            ("width", Value::Float(0.3)),
            ("turn", Value::Float(turn)),
        ];
        scalp_of(&part(&head(), &set).0[0])
    };
    let whole = on(&head());
    assert_eq!(whole.len(), 800);
    // Three lines of about 20 x 0.3 cm are a thirtieth of the scalp's 600 cm2.
    for scalp in [rows(0.0), rows(4.0)] {
        let parted = on(&scalp);
        for (id, root) in &whole {
            let there = parted.get(id);
            assert_eq!(there, scalp.free(*root).then_some(root), "{id:x}");
        }
        assert!((740..800).contains(&parted.len()), "{}", parted.len());
        assert!(parted.keys().all(|id| whole.contains_key(id)));
    }
}

#[test]
fn hair_wired_where_rows_belong_is_refused() {
    let mut b = TuftBuilder::new();
    for k in 0..5000 {
        let x = k as f32 * 1e-3;
        b.push_curve(&[Vec3::new(x, 9.0, 0.0), Vec3::new(x, 9.0, 1.0)]);
    }
    b.set(crate::data::attributes::ID, Domain::Curve, (1..=5000).collect::<Vec<u64>>());
    let hair = Curves::new(vec![Arc::new(b.build())]);
    let set = [("scalp", head().into()), ("between", Value::from(hair))];
    let fault = crate::testing::fails(&NODE, &set);
    assert!(fault.contains("5000 rows") && fault.contains("4096"), "{fault}");
}

#[test]
fn a_second_node_cuts_the_sections_of_the_first_where_a_mask_says() {
    let half = [("pattern", "across".into()), ("count", Value::Int(2))];
    let names = [("names", "front 0 7 6; back 0 3 -8".into()), ("seed", Value::Int(1))];
    let (out, _) = part(&head(), &[&half[..], &names].concat());
    let parted = scalp_of(&out[0]);
    let set = [
        ("pattern", "straight_back".into()),
        ("count", Value::Int(6)),
        ("area", Field::Mask("front".into()).into()),
    ];
    let (out, said) = part(&parted, &set);
    assert_eq!(said, [""; 0]);
    let scalp = scalp_of(&out[0]);
    let names = scalp.sections().unwrap().names();
    assert_eq!(names.get("front").map(<[u32]>::len), Some(6));
    assert_eq!(names.get("back").map(<[u32]>::len), Some(1));
    assert_eq!(scalp.sections().unwrap().list().len(), 7);
    assert_eq!(curves_of(&out[2]).curve_count(), 6);
    assert!(std::ptr::eq(scalp.surface(), head().surface()), "the head itself is shared");
    assert_ne!(scalp.key(), parted.key());
}

#[test]
fn hair_keeps_to_its_section_and_off_the_partings() {
    let set = [("pattern", "straight_back".into()), ("width", Value::Float(0.3))];
    let (out, _) = part(&head(), &set);
    let (scalp, number) = (scalp_of(&out[0]), Value::Int(400));
    let guides = crate::by_id("scatter_guides").unwrap();
    let (grown, _) = run(guides, &[("scalp", scalp.clone().into()), ("count", number)]);
    // The width of a guide shows which section it stands in.
    let sections = scalp.sections().unwrap();
    let hair = crate::by_id("interpolate").unwrap();
    let set = [
        ("guides", grown[0].clone()),
        ("scalp", scalp.clone().into()),
        ("density", Value::Float(20.0)),
    ];
    let (hair, _) = run(hair, &set);
    let home: BTreeMap<u64, u64> = curves_of(&grown[0])
        .each()
        .map(|(t, i)| (t.id(i), sections.id_at(t.curve(i)[0]).unwrap()))
        .collect();
    let mut hairs = 0;
    for (tuft, i) in curves_of(&hair[0]).each() {
        let place = sections.at(tuft.curve(i)[0]).unwrap();
        assert!(place.distance >= 0.15, "{place:?}");
        let id = sections.list()[place.section as usize].id;
        assert_eq!(tuft.view(SECTION).at(i, 0), id);
        assert_eq!(home[&tuft.view(PARENT).at(i, 0)], id);
        hairs += 1;
    }
    assert!(hairs > 5000, "{hairs}");
}

#[test]
fn hair_drawn_to_the_middle_of_its_box_crosses_no_parting() {
    let set = [
        ("pattern", "across".into()),
        ("cells", "boxes".into()),
        ("cell_length", Value::Float(3.0)),
        ("width", Value::Float(0.2)),
        ("wobble", Value::Float(0.05)),
    ];
    let (out, said) = part(&head(), &set);
    assert!(said.is_empty(), "{said:?}");
    let scalp = scalp_of(&out[0]);
    let sections = scalp.sections().unwrap();
    let set = [
        ("guides", out[3].clone()),
        ("scalp", scalp.clone().into()),
        ("density", Value::Float(30.0)),
        ("guides_per_hair", Value::Int(1)),
        ("points", Value::Int(7)),
    ];
    let (hair, _) = run(crate::by_id("interpolate").unwrap(), &set);
    let hair = [clumped(&hair[0], &out[3], &scalp, 1.0)];
    let (mut hairs, mut crossing) = (0, 0);
    for (tuft, i) in curves_of(&hair[0]).each() {
        let points = tuft.curve(i);
        let on_skin = |p: &Vec3| scalp.surface().closest(*p).unwrap().point;
        // What is in the air is held by nothing.
        let lies = |p: &&Vec3| p.distance(on_skin(p)) < 0.24;
        let way: Vec<Vec3> = points.iter().filter(lies).map(on_skin).collect();
        let home = sections.id_at(points[0]);
        // Where no hair grows, as behind an ear, is not another section.
        let elsewhere = |p: &Vec3| sections.id_at(*p).is_some_and(|id| Some(id) != home);
        let passes = sections.is_over_line(points);
        let strays = passes || way[1..].iter().any(elsewhere);
        (hairs, crossing) = (hairs + 1, crossing + usize::from(strays));
    }
    assert!(hairs > 10_000 && crossing == 0, "{crossing} of {hairs}");
}

#[test]
fn a_parting_that_ends_in_hair_parts_the_hair_beside_it_and_curls_keep_off_it() {
    let whole = head();
    let on_skin = |p: Vec3| whole.closest_root(p).unwrap();
    // From the forehead over the top, where it ends.
    let line: Vec<Vec3> =
        (0..=24).map(|k| on_skin(Vec3::new(2.0, 11.0, 7.0 - 0.4 * k as f32)).point).collect();
    let mut b = TuftBuilder::new();
    b.push_curve(&line);
    b.set(ID, Domain::Curve, vec![5]);
    let drawn = Curves::new(vec![Arc::new(b.build())]);
    let set = [("lines", drawn.into()), ("wobble", Value::Float(0.0))];
    let (out, said) = part(&whole, &set);
    assert!(said.len() == 1 && said[0].contains("cut no section"), "{said:?}");
    let scalp = scalp_of(&out[0]);
    let sections = scalp.sections().unwrap();
    assert_eq!(sections.list().len(), 1);
    // Hair swept aside, each from its own side of the line.
    let set = [("scalp", scalp.clone().into()), ("count", Value::Int(900))];
    let (grown, _) = run(crate::by_id("scatter_guides").unwrap(), &set);
    let swept = curves_of(&grown[0]).each().map(|(tuft, i)| {
        let root = tuft.curve(i)[0];
        let aside = Vec3::new((root.x - 2.0).signum() * 0.15, 0.0, -0.35);
        let mut b = TuftBuilder::new();
        let mut points = vec![root];
        for k in 0..8 {
            let next = on_skin(points[k] + aside);
            points.push(next.point + next.normal * 0.06);
        }
        b.push_curve(&points);
        b.set(ID, Domain::Curve, vec![tuft.id(i)]);
        Arc::new(b.build())
    });
    let guides = Curves::new(swept.collect());
    let over = |curves: &Curves| {
        let leads = |points: &[Vec3]| sections.is_over_line(points);
        curves.each().filter(|(tuft, i)| leads(tuft.curve(*i))).count()
    };
    let grow = |scalp: &Arc<Scalp>| {
        let set = [
            ("guides", guides.clone().into()),
            ("scalp", scalp.clone().into()),
            ("density", Value::Float(60.0)),
        ];
        let hair = run(crate::by_id("interpolate").unwrap(), &set).0.remove(0);
        clumped(&hair, &guides.clone().into(), scalp, 0.7)
    };
    let curl = |hair: &Value, scalp: &Arc<Scalp>| {
        let set = [
            ("curves", hair.clone()),
            ("scalp", scalp.clone().into()),
            ("preset", "2b".into()),
            ("diameter", Value::Float(1.6)),
            ("pitch", Value::Float(2.0)),
        ];
        run(crate::by_id("shape_list_curl").unwrap(), &set).0.remove(0)
    };
    let (hair, without) = (grow(&scalp), grow(&whole));
    let n = curves_of(&hair).curve_count();
    assert!(n > 10_000, "{n}");
    let unparted = over(curves_of(&without));
    assert!(over(curves_of(&hair)) == 0 && unparted > 50, "{unparted}");
    let (curled, free) = (curl(&hair, &scalp), curl(&hair, &whole));
    let (kept, crossing) = (over(curves_of(&curled)), over(curves_of(&free)));
    assert!(kept == 0 && crossing > 10, "{kept} of {crossing}");
    // Hair that would cross no line is unchanged.
    let (curled, free) = (curves_of(&curled), curves_of(&free));
    assert_eq!(curled.curve_count(), n);
    let changed = curled.each().zip(free.each());
    let changed = changed.filter(|((a, i), (b, j))| a.curve(*i) != b.curve(*j)).count();
    assert_eq!(changed, crossing);
}

#[test]
fn hair_that_hangs_from_its_box_gathers_before_it_leaves_it() {
    let check = |cells: &str, lost: f32| {
        let set = [("count", Value::Int(9)), ("cells", cells.into())];
        let (out, _) = part(&head(), &set);
        let scalp = scalp_of(&out[0]);
        let sections = scalp.sections().unwrap();
        let set = [("roots", out[3].clone()), ("scalp", scalp.clone().into())];
        let set = [&set[..], &[("length", Value::Float(12.0))]].concat();
        let (hung, _) = run(crate::by_id("hang").unwrap(), &set);
        let over = |points: &[Vec3]| sections.is_over_line(points);
        // A guide that itself lies over a parting leads its hair there.
        let low: Vec<u64> = curves_of(&hung[0])
            .each()
            .filter(|(tuft, i)| over(tuft.curve(*i)))
            .map(|(tuft, i)| tuft.id(i))
            .collect();
        assert!(low.len() * 8 < curves_of(&hung[0]).curve_count(), "{cells}: {low:?}");
        let set = [
            ("guides", hung[0].clone()),
            ("scalp", scalp.clone().into()),
            ("density", Value::Float(20.0)),
            ("points", Value::Int(40)),
        ];
        let (hair, said) = run(crate::by_id("interpolate").unwrap(), &set);
        let hair = clumped(&hair[0], &hung[0], &scalp, 0.9);
        let hair = curves_of(&hair);
        let crossing = hair
            .each()
            .filter(|(tuft, i)| !low.contains(&tuft.view(PARENT).at(*i, 0)))
            .filter(|(tuft, i)| over(tuft.curve(*i)))
            .count();
        assert_eq!(crossing, 0, "{cells}");
        // The number of dropped hairs is reported.
        let told = said.iter().find(|line| line.contains("left out")).map_or(0.0, |line| {
            let number = line.split_once(" (").map(|(_, rest)| rest.split(' ').next());
            number.flatten().and_then(|n| n.parse().ok()).unwrap_or(f32::NAN)
        });
        let share = told / hair.curve_count() as f32;
        assert!(hair.curve_count() > 7_000 && share < lost, "{cells}: {share} {said:?}");
    };
    check("boxes", 0.02);
    check("triangles", 0.06);
}

#[test]
fn one_closed_line_cuts_an_animal_in_two_sections_with_their_names() {
    use crate::data::outline::for_middles;
    let animal = [("fit", Value::from("none"))];
    // The belly of one and the flank of the other, as fractions of their bounding boxes.
    for (name, place, radius) in [
        ("rat/street_rat_4k.gltf", Vec3::new(0.5, 0.25, 0.55), 0.7),
        ("spot/spot_triangulated.obj", Vec3::new(0.91, 0.344, 0.534), 9.0),
    ] {
        let test = "one_closed_line_cuts_an_animal_in_two_sections_with_their_names";
        let Some(whole) = crate::testing::shared_head(test, name, &animal) else { continue };
        let (low, high) = whole.surface().bounds();
        let middle = whole.closest_root(low + (high - low) * place).unwrap();
        let right = middle.normal.any_orthonormal_vector();
        let up = middle.normal.cross(right);
        let ring: Vec<Vec3> = (0..=60)
            .map(|k| {
                let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 60.0);
                let p = middle.point + (right * c + up * s) * (0.8 * radius);
                whole.closest_root(p).unwrap().point
            })
            .collect();
        let far = whole.closest_root(low + (high - low) * Vec3::new(0.5, 1.0, 0.55)).unwrap().point;
        let as_typed = |p: Vec3| {
            let p = whole.frame().head_from_point(p);
            format!("{} {} {}", p.x, p.y, p.z)
        };
        let names = format!("belly {}; coat {}", as_typed(middle.point), as_typed(far));
        let mut b = TuftBuilder::new();
        b.push_curve(&ring);
        b.set(crate::data::attributes::ID, crate::data::attributes::Domain::Curve, vec![7]);
        let line = Curves::new(vec![Arc::new(b.build())]);
        let set = [
            ("lines", line.into()),
            ("names", Value::from(&*names)),
            ("width", Value::Float(0.02)),
        ];
        let (out, said) = part(&whole, &set);
        assert_eq!(said, [""; 0], "{name}");
        let scalp = scalp_of(&out[0]);
        let sections = scalp.sections().unwrap();
        let called: Vec<&str> = sections.list().iter().map(|s| s.name.as_str()).collect();
        assert_eq!(called, ["coat", "belly"], "{name}");
        assert_eq!(curves_of(&out[2]).curve_count(), 0);
        assert_eq!(curves_of(&out[3]).curve_count(), 2);
        // All skin is in one of them, and skin inside the ring has the section of the nearest skin.
        let surface = scalp.surface();
        let mut areas = [0.0f32; 2];
        for t in 0..surface.triangles.len() as u32 {
            for_middles(4, |bary| {
                let at = sections.of(&scalp.root(t, bary));
                let number = at.expect("a section") as usize;
                areas[number] += surface.area_vector(t).length() / 32.0;
                let p = surface.at(t, bary);
                if p.distance(middle.point) < 0.5 * radius {
                    assert_eq!(called[number], "belly", "{name} {p}");
                } else if p.distance(middle.point) > 1.2 * radius {
                    assert_eq!(called[number], "coat", "{name} {p}");
                }
            });
        }
        for (section, area) in sections.list().iter().zip(areas) {
            assert!((section.area / area - 1.0).abs() < 0.03, "{name} {section:?} {area}");
        }
        // Hair masked by the name of a section is rooted only in it, and off the line.
        let coat = [
            ("scalp", scalp.clone().into()),
            ("count", Value::Int(3000)),
            ("mask", Field::Mask("belly".into()).into()),
        ];
        let (grown, _) = run(crate::by_id("scatter_guides").unwrap(), &coat);
        let roots: Vec<Vec3> = curves_of(&grown[0]).each().map(|(t, i)| t.curve(i)[0]).collect();
        let farthest = roots.iter().map(|p| p.distance(middle.point)).fold(0.0, f32::max);
        assert!(roots.len() > 5 && farthest < 1.1 * radius, "{} {farthest}", roots.len());
    }
}

#[test]
fn heads_have_their_region_on_the_map_and_animals_have_not() {
    assert!(head().is_on_map());
    let test = "heads_have_their_region_on_the_map_and_animals_have_not";
    for (name, fit, is) in [
        ("lps_head/LeePerrySmith.glb", "cranium", true),
        ("ict_head/generic_neutral_mesh.obj", "cranium", true),
        ("sintel/sintel.obj", "cranium", true),
        ("rat/street_rat_4k.gltf", "none", false),
        ("spot/spot_triangulated.obj", "none", false),
    ] {
        if let Some(scalp) = crate::testing::shared_head(test, name, &[("fit", fit.into())]) {
            let on: f32 = scalp.chart().spots().iter().map(|s| s.area * s.grows).sum();
            println!("{name}: {:.3}", f64::from(on) / scalp.spread().area());
            assert_eq!(scalp.is_on_map(), is, "{name}");
        }
    }
}

#[test]
fn a_head_in_any_size_has_the_same_sections_with_the_same_names_and_ids() {
    let triangles = [
        ("pattern", Value::from("across")),
        ("cells", "triangles".into()),
        ("cell_length", Value::Float(3.0)),
        ("width", Value::Float(0.2)),
        ("wobble", Value::Float(0.0)),
    ];
    let bricks = [("pattern", Value::from("straight_back")), ("cells", "boxes".into())];
    let curved = [("pattern", Value::from("curved")), ("cells", "triangles".into())];
    let rings = [("pattern", Value::from("halo")), ("count", Value::Int(5))];
    let zigzag = [
        ("pattern", Value::from("gathered")),
        ("zigzag", Value::Float(0.4)),
        ("count", Value::Int(11)),
    ];
    let named = |scalp: &Arc<Scalp>, set: &[(&str, Value)]| -> Vec<(u64, String)> {
        let parted = scalp_of(&part(scalp, set).0[0]);
        let list = parted.sections().unwrap().list();
        list.iter().map(|section| (section.id, section.name.clone())).collect()
    };
    let check = |at: &dyn Fn(f32) -> Arc<Scalp>,
                 scales: [f32; 3],
                 sizes_round: bool,
                 sets: &[&[(&str, Value)]]| {
        let heads = scales.map(at);
        for set in sets {
            let all = heads.each_ref().map(|scalp| named(scalp, set));
            assert!(all[0].len() > 4, "{set:?}: {}", all[0].len());
            for (scale, other) in scales.iter().zip(&all).skip(1) {
                let lost = all[0].iter().filter(|section| !other.contains(section)).count();
                // (Last bits may join one to its neighbour, and those behind it are counted anew.)
                let few = all[0].len() / 10 * usize::from(sizes_round);
                assert!(
                    lost <= few && other.len().abs_diff(all[0].len()) <= few,
                    "{set:?} at scale {scale}: {lost} lost, {} of {}",
                    other.len(),
                    all[0].len()
                );
            }
        }
    };
    let scaled = |scale: f32| [("units", Value::from("custom")), ("scale", Value::Float(scale))];
    let builtin = |scale: f32| crate::testing::head(&scaled(scale));
    // Powers of two keep every bit.
    check(&builtin, [1.0, 0.5, 2.0], false, &[&triangles, &bricks, &curved, &rings, &zigzag]);
    let Some(file) = crate::testing::shared_file("sintel/sintel.obj") else {
        println!("skipped: sizes of sintel need ../shared");
        return;
    };
    let sintel = |scale: f32| {
        crate::testing::head(&[&[("mesh", Value::File(file.clone()))], &scaled(scale)[..]].concat())
    };
    check(&sintel, [100.0, 60.0, 150.0], true, &[&triangles, &curved]);
}

#[test]
fn hair_is_parted_where_drawn_rows_leave_each_other_and_nowhere_else() {
    let rows = |of: &[&[[f32; 3]]]| {
        let tuft = |(id, row): (u64, &&[[f32; 3]])| {
            let laid = row.iter().map(|p| head().closest_root(Vec3::from(*p)).unwrap().point);
            let mut b = TuftBuilder::new();
            b.push_curve(&laid.collect::<Vec<_>>());
            b.set(ID, Domain::Curve, vec![id]);
            Arc::new(b.build())
        };
        Value::from(Curves::new((1..).zip(of).map(tuft).collect()))
    };
    let to_left = |z: f32| [[0.8, 9.0, z], [4.0, 8.0, z], [7.0, 5.0, z]];
    let to_right = |z: f32| to_left(z).map(|[x, y, z]| [-x, y, z]);
    let turned = |row: [[f32; 3]; 3]| [row[2], row[1], row[0]];
    let lines = |of: &[[[f32; 3]; 3]], leave: f32| {
        let of: Vec<&[[f32; 3]]> = of.iter().map(|row| &row[..]).collect();
        let set = [("between", rows(&of)), ("leave", Value::Float(leave))];
        let (out, _) = part(&head(), &set);
        curves_of(&out[1]).clone()
    };
    let apart = [to_left(3.0), to_right(3.0), to_left(-1.0), to_right(-1.0)];
    let found = lines(&apart, 60.0);
    assert_eq!(found.curve_count(), 1, "one line goes on past all rows");
    for (tuft, i) in found.each() {
        // The middle, as far as there are rows.
        for p in tuft.curve(i).iter().filter(|p| (-1.0..3.0).contains(&p.z)) {
            assert!(p.x.abs() < 0.4, "{p}");
        }
    }
    assert!(lines(&apart, 0.0).curve_count() > 2, "all neighbours are parted");
    assert_eq!(lines(&apart, 179.0).curve_count(), 0, "they leave by less than that");
    let side_by_side = [to_left(3.0), to_left(0.0), to_left(-3.0)];
    assert_eq!(lines(&side_by_side, 60.0).curve_count(), 0, "they run beside each other");
    let meeting = apart.map(turned);
    assert_eq!(lines(&meeting, 60.0).curve_count(), 0, "they come together");
}
