//! `coif probe`: what a picture shows at a place, against the exported curves.

use coif_tests::{Folder, eval, program, run_with};
use serde_json::Value as Json;

#[test]
fn a_probe_names_the_skin_and_the_hair_that_a_picture_shows_at_a_place() {
    let probe = |more: &[&str]| {
        let ran =
            run_with(program(), [&["probe", "cornrows", "--output", "rows.curves"], more].concat());
        assert_eq!(ran.code, 0, "{more:?}: {}", ran.err);
        ran.out
    };
    let json = |more: &[&str]| -> Json {
        serde_json::from_str(&probe(&[more, &["--json"]].concat())).expect("JSON")
    };
    let numbers = |json: &Json| -> Vec<f32> {
        json.as_array().unwrap().iter().map(|x| x.as_f64().unwrap() as f32).collect()
    };
    // The middle of the front is on the plane in which the built-in head mirrors; its corner is beside it.
    let front = json(&["--camera", "front", "--at", "0.5,0.5", "--at", "0,0"]);
    let skin = &front[0]["skin"];
    assert!(
        numbers(&skin["head"])[0].abs() < 0.05 && skin["distance"].as_f64() > Some(10.0),
        "{front}"
    );
    assert!(front[1]["skin"].is_null() && front[1]["hair"].is_null(), "{front}");

    // A grid over the crown meets rows; each passes through the place that is told of it, in front of the skin.
    let folder = Folder::new("probe");
    let file = folder.path("rows.usda");
    eval("cornrows", &["--output", "rows.curves", "--out", &file.display().to_string()]);
    let rows = &coif_tests::curves_in(&file)[0];
    let grid: Vec<String> = (0..400)
        .map(|n| format!("{},{}", 0.3 + 0.02 * (n % 20) as f32, 0.1 + 0.03 * (n / 20) as f32))
        .collect();
    let at: Vec<&str> = grid.iter().flat_map(|at| ["--at", at]).collect();
    let seen = json(&[&["--camera", "crown"], &at[..]].concat());
    let hit: Vec<&Json> =
        seen.as_array().unwrap().iter().filter(|seen| !seen["hair"].is_null()).collect();
    assert!((5..200).contains(&hit.len()), "{} of {} places", hit.len(), grid.len());
    let mut regions = 0;
    for seen in hit {
        let hair = &seen["hair"];
        let place = glam::Vec3::from_slice(&numbers(&hair["cm"]));
        let spans = rows.points.windows(2);
        let off = |w: &[glam::Vec3]| {
            let way = w[1] - w[0];
            let t = ((place - w[0]).dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0);
            place.distance(w[0] + way * t)
        };
        let near = spans.map(off).fold(f32::MAX, f32::min);
        assert!(near < 0.05, "{near} cm from all rows: {seen}");
        assert!(hair["above"].as_f64().unwrap().abs() < 0.5 && hair["group"] == "rows", "{seen}");
        assert!(
            hair["distance"].as_f64() < seen["skin"]["distance"].as_f64().map(|far| far + 0.1),
            "{seen}"
        );
        regions += usize::from(seen["skin"]["region"] == 1.0);
    }
    assert!(regions > 0, "no row lies on the region where hair grows");
    let words = probe(&["--camera", "crown", "--at", "0.5,0.5"]);
    assert!(words.contains("  skin at ") && words.contains("in head units"), "{words}");

    for (more, said) in [
        (&["--at", "1.5,0"][..], "write it as X,Y, each from 0 (left, top) to 1"),
        (&["--at", "0.5"], "write it as X,Y"),
        (&["--at", "NaN,0"], "write it as X,Y"),
        (&["--at", "0,0", "--camera", "behind"], "--camera behind: is not one of"),
        (&["--at", "0,0", "--size", "0x0"], "--size 0x0"),
        (&[], "--at"),
    ] {
        let ran =
            run_with(program(), [&["probe", "cornrows", "--output", "rows.curves"], more].concat());
        assert_eq!(ran.code, 2, "{more:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{more:?}: {}", ran.err);
    }
}

#[test]
fn hair_that_hangs_far_from_the_head_is_as_high_above_the_skin_as_it_is() {
    let args = ["probe", "start", "--quality", "preview", "--camera", "front", "--json"];
    let grid: Vec<String> = (0..100)
        .map(|n| format!("{},{}", 0.3 + 0.04 * (n % 10) as f32, 0.1 + 0.08 * (n / 10) as f32))
        .collect();
    let at = grid.iter().flat_map(|at| ["--at", at]);
    let ran = run_with(program(), args.into_iter().chain(at));
    let seen: Json = serde_json::from_str(&ran.out).expect("JSON");
    let heights = seen.as_array().unwrap().iter().filter_map(|seen| seen["hair"]["above"].as_f64());
    let highest = heights.fold(0.0, f64::max);
    // The distance field ends at 1 cm.
    assert!((1.5..15.0).contains(&highest), "{highest} cm");
}
