//! Alembic from the whole program: the same hair as in USD, and Blender's own reader as the judge.
//!
//! Blender is the Python package bpy 5.0.1, a third of a gigabyte: `tests/run.sh --long` installs it into `target/venv-blender`.

use coif_graphs::grooms;
use coif_nodes::formats::abc;
use coif_nodes::formats::usd::read::ReadCurves;
use coif_tests::{Folder, curves_in, eval, lean, repository, run};
use glam::Vec3;
use serde_json::Value as Json;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Evaluates a groom to both formats: the folder and what our readers find in `groom.usdc` and `groom.abc`.
fn both(name: &str, more: &[&str]) -> (Folder, Vec<ReadCurves>, Vec<ReadCurves>) {
    let folder = Folder::new(&format!("alembic-{name}-{}", more.len()));
    let out = ["usdc", "abc"].map(|ending| folder.path(&format!("groom.{ending}")));
    let files = out.each_ref().map(|path| path.display().to_string());
    eval(name, &[&["--out", &files[0], "--out", &files[1]], more].concat());
    let usd = curves_in(&out[0]);
    (folder, usd, abc::read_curves(&std::fs::read(&out[1]).unwrap()).unwrap().stage.curves)
}

/// The last but one part of a path in Alembic, the last in USD: the name that people see.
fn name(path: &str, from_end: usize) -> &str {
    path.rsplit('/').nth(from_end).unwrap_or("")
}

#[test]
fn alembic_holds_the_hair_and_the_attributes_of_usd() {
    let (_folder, usd, abc) = both("clusters", &[]);
    assert_eq!(usd.len(), abc.len());
    for (usd, abc) in usd.iter().zip(&abc) {
        assert_eq!((&usd.counts, &usd.points), (&abc.counts, &abc.points), "{}", usd.path);
        assert_eq!((name(&usd.path, 0), &usd.purpose), (name(&abc.path, 1), &abc.purpose));
        for primvar in &usd.primvars {
            let same = abc.primvars.iter().find(|p| p.name == primvar.name).expect(&primvar.name);
            assert_eq!(primvar.interpolation, same.interpolation, "{}", primvar.name);
            assert_eq!(primvar.values, same.values, "{}", primvar.name);
        }
    }
}

#[test]
fn measure_judges_alembic_as_it_judges_usd() {
    let folder = Folder::new("alembic-measure");
    let out =
        ["usdc", "abc"].map(|ending| folder.path(&format!("groom.{ending}")).display().to_string());
    eval("cornrows", &["--out", &out[0], "--out", &out[1]]);
    let laws = |file: &String| -> Vec<(Json, Json, Json)> {
        let ran = run(["measure", file, "--json", "--scalp", "builtin"]);
        let all: Vec<Json> = serde_json::from_str(&ran.out).unwrap();
        all.into_iter()
            .map(|m| (m["curves"].clone(), m["braids"].clone(), m["laws"].clone()))
            .collect()
    };
    let (usd, abc) = (laws(&out[0]), laws(&out[1]));
    assert!(!usd.is_empty() && usd == abc, "{usd:#?}\n{abc:#?}");
}

/// What `measure` gives of a file that Blender wrote: the exit code, its JSON, and its text.
fn of_blender(test: &str, name: &str, more: &[&str]) -> Option<(i32, Json, String)> {
    let file = coif_tests::shared(test, &format!("data/reported/3/{name}.abc"))?;
    let file = file.display().to_string();
    let words = [&["measure", &file][..], more].concat();
    let (text, json) = (run(&words), run([&words[..], &["--json"]].concat()));
    assert_eq!(text.code, json.code, "{}", text.err);
    Some((json.code, serde_json::from_str(&json.out).unwrap(), text.out))
}

#[test]
fn widths_of_blender_are_those_of_points_and_its_metres_are_told() {
    let test = "widths_of_blender_are_those_of_points_and_its_metres_are_told";
    let Some((code, all, text)) = of_blender(test, "blender_width", &[]) else { return };
    assert_eq!(code, 0, "{text}");
    let near = |json: &Json, cm: f64| (json.as_f64().unwrap() - cm).abs() < 1e-4;
    let widths = &all[0]["width_cm"];
    assert!(near(&widths[0], 0.2) && near(&widths[1], 4.0), "{widths}");
    assert_eq!(all[0]["notes"], serde_json::json!([]));
    let unit = serde_json::json!({"cm": 100.0, "by": "application", "application": "Blender"});
    assert_eq!(all[0]["unit"], unit);
    assert!(
        text.starts_with(
            "unit: not declared (Alembic has none); metres are taken, as Blender writes."
        ),
        "{text}"
    );
    // What is asked for goes before.
    let (_, all, text) = of_blender(test, "blender_width", &["--unit", "cm"]).unwrap();
    assert!(
        near(&all[0]["width_cm"][1], 0.04) && text.starts_with("unit: centimetres, as --unit says"),
        "{text}"
    );
}

#[test]
fn curves_of_a_kind_that_is_not_read_hide_no_others() {
    let test = "curves_of_a_kind_that_is_not_read_hide_no_others";
    let read = of_blender(test, "blender_nurbs_beside_others", &[]);
    let Some((code, all, text)) = read else { return };
    assert_eq!(code, 1, "{text}");
    let found: Vec<(&str, f64)> = all
        .as_array()
        .unwrap()
        .iter()
        .map(|prim| (prim["path"].as_str().unwrap(), prim["length_cm"][1].as_f64().unwrap()))
        .collect();
    let [("/BEZIER/BEZIER", bezier), ("/POLY/POLY", poly)] = found[..] else { panic!("{found:?}") };
    assert!((bezier - 20.48).abs() < 0.01 && (poly - 30.88).abs() < 0.01, "{found:?}");
    // A handle has no width: Blender writes one a point on the curve.
    assert!(all[0]["width_cm"].is_array() && all[1]["width_cm"].is_array(), "{all:#}");
    assert!(text.contains("not read: /NURBS/NURBS: curves: curveBasisAndType: NURBS"), "{text}");
}

#[test]
fn the_unit_of_alembic_is_told_by_the_head_first() {
    let folder = Folder::new("alembic-unit");
    let out = folder.path("groom.abc").display().to_string();
    eval("start", &["--out", &out]);
    let unit = |words: &[&str]| {
        let ran = run([&["measure", &out, "--json"][..], words].concat());
        let all: Json = serde_json::from_str(&ran.out).unwrap();
        (all[0]["unit"].clone(), all[0]["length_cm"][2].as_f64().unwrap())
    };
    let (by_us, long) = unit(&[]);
    assert!(by_us["by"] == "application" && by_us["cm"] == 1.0, "{by_us}");
    let (by_head, again) = unit(&["--scalp", "builtin"]);
    assert!(by_head["by"] == "head" && by_head["cm"] == 1.0 && again == long, "{by_head}");
    let (asked, inches) = unit(&["--unit", "in"]);
    assert!(asked["by"] == "option" && (inches / long - 2.54).abs() < 1e-4, "{asked} {inches}");
    let usd = folder.path("groom.usda").display().to_string();
    eval("start", &["--out", &usd]);
    let ran = run(["measure", &usd, "--unit", "m"]);
    assert!(ran.code == 2 && ran.err.contains("--unit is for .abc files"), "{}", ran.err);
}

#[test]
fn a_head_goes_into_alembic_and_usd() {
    let folder = Folder::new("alembic-head");
    let hair = folder.path("groom.hair").display().to_string();
    let ran = run(["eval", "start", "--out", &hair, "--with-head"]);
    assert_eq!(ran.code, 2, "{}", ran.err);
    assert!(ran.err.contains("--with-head: .usda, .usdc and .abc"), "{}", ran.err);
    assert!(folder.names().is_empty());
    let out = folder.path("groom.abc");
    eval("start", &["--out", &out.display().to_string(), "--with-head"]);
    let bytes = std::fs::read(&out).unwrap();
    let archive = abc::read::Archive::open(&bytes).unwrap();
    let (_, top) = archive.open_object(&archive.top().unwrap()).unwrap();
    let (_, sets) = archive.open_object(&top[0]).unwrap();
    assert_eq!(sets.last().unwrap().name, "head");
}

/// The Python with bpy; none where it is not installed.
fn blender(test: &str) -> Option<PathBuf> {
    let python = repository().join("target/venv-blender/bin/python");
    if python.exists() {
        return Some(python);
    }
    println!("skipped: {test} needs bpy in target/venv-blender (tests/run.sh --long installs it)");
    None
}

/// What Blender finds in a file.
fn opened(python: &Path, file: &Path, folder: &Folder) -> Json {
    let script = repository().join("tests/blender/read.py");
    let into = folder.path("");
    let args = [script.as_path(), file, into.as_path()];
    let output = Command::new(python).args(args).output().unwrap();
    let (out, err) = [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b)).into();
    let line = out.lines().find_map(|line| line.strip_prefix("BLENDER "));
    serde_json::from_str(line.unwrap_or_else(|| panic!("{out}\n{err}"))).unwrap()
}

/// The largest distance, cm, of a point in Blender from where it is in our USD file. Blender turns Y up to Z up.
#[track_caller]
fn check_in_blender(python: &Path, groom: &str, more: &[&str]) -> f32 {
    let (folder, usd, abc) = both(groom, more);
    let found = opened(python, &folder.path("groom.abc"), &folder);
    let curves = found.as_object().unwrap().values().filter(|thing| thing["type"] == "CURVES");
    assert_eq!(curves.count(), abc.len(), "{groom}: {found:#}");
    let mut worst = 0f32;
    for prim in &abc {
        let shown = name(&prim.path, 1);
        let own = usd.iter().find(|usd| usd.counts == prim.counts && usd.points == prim.points);
        let own = own.unwrap_or_else(|| panic!("{groom}: {shown} is not in the USD file"));
        let theirs = &found[shown];
        let read = |which: &str| std::fs::read(theirs[which].as_str().expect(shown)).unwrap();
        let number = |bytes: &[u8]| [bytes[0], bytes[1], bytes[2], bytes[3]];
        let counts = read("counts_file");
        let counts = counts.chunks_exact(4).map(|b| u32::from_le_bytes(number(b)));
        assert!(counts.eq(own.counts.iter().copied()), "{groom}: points of the curves of {shown}");
        let positions = read("positions_file");
        let numbers: Vec<f32> =
            positions.chunks_exact(4).map(|b| f32::from_le_bytes(number(b))).collect();
        assert_eq!(numbers.len(), 3 * own.points.len(), "{groom}: {shown}");
        for (theirs, ours) in numbers.chunks_exact(3).zip(&own.points) {
            let turned = Vec3::new(theirs[0], theirs[2], -theirs[1]);
            worst = worst.max(turned.distance(*ours));
        }
        // Blender holds radii.
        let width = own.widths.as_ref().unwrap().values[0];
        let radius = theirs["first_radius"].as_f64().unwrap() as f32;
        assert!(
            (radius - 0.5 * width).abs() <= 1e-6 * width,
            "{groom}: {shown}: {radius} of {width}"
        );
    }
    println!("{groom}: {} objects, at most {worst:e} cm off", abc.len());
    assert!(worst <= 1e-4, "{groom}: {worst} cm");
    worst
}

#[test]
#[ignore = "long"]
fn blender_opens_every_hero_with_the_curves_that_were_written() {
    let test = "blender_opens_every_hero_with_the_curves_that_were_written";
    let Some(python) = blender(test) else { return };
    for hero in grooms::HEROES {
        check_in_blender(&python, hero, &[]);
    }
}

#[test]
#[ignore = "long"]
fn blender_opens_a_tenth_of_every_hero_and_the_head_with_its_faces_outwards() {
    let test = "blender_opens_a_tenth_of_every_hero_and_the_head_with_its_faces_outwards";
    let Some(python) = blender(test) else { return };
    for hero in grooms::HEROES {
        check_in_blender(&python, hero, lean(hero));
    }
    let folder = Folder::new("alembic-blender-head");
    let out = folder.path("groom.abc");
    eval("start", &["--out", &out.display().to_string(), "--with-head"]);
    let found = opened(&python, &out, &folder);
    let head = &found["head"];
    let of = |what: &str| head[what].as_f64().unwrap_or(0.0);
    assert_eq!((head["type"].as_str(), of("uvs")), (Some("MESH"), 1.0), "{found:#}");
    // A head is no ball, but nearly all of it faces away from its middle.
    assert!(of("outwards") > 0.8 * of("polygons") && of("polygons") > 1000.0, "{head}");
}
