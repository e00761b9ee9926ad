//! `coif render` as a whole program: what it refuses, what it writes, and that nothing is touched when it cannot.

use coif_tests::waiting::ends;
use coif_tests::{Folder, Ran, adapter, program, run_with, until_it_hears};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// A small picture of little hair, unless `more` says otherwise.
fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["render", "start", "--set", "hair.by=count", "--set", "hair.count=1500"];
    for option in [["--size", "64x36"], ["--samples", "2"]] {
        if !more.contains(&option[0]) {
            args.extend(option);
        }
    }
    args.extend(more);
    args
}

/// Runs `coif render` with a picture and a report beside it that were there before.
fn render(folder: &Folder, more: &[&str]) -> Ran {
    let picture = folder.path("hair.png");
    std::fs::write(&picture, "what was there").unwrap();
    let picture = picture.display().to_string();
    run_with(program(), small(&[&["--out", &picture], more].concat()))
}

#[track_caller]
fn check_untouched(folder: &Folder) {
    assert_eq!(std::fs::read_to_string(folder.path("hair.png")).unwrap(), "what was there");
    assert_eq!(folder.names(), ["hair.png"]);
}

#[test]
fn wrong_words_are_refused_in_one_line_and_nothing_is_touched() {
    let folder = Folder::new("render-refused");
    let broken = Folder::new("render-hdri");
    let path = |name: &str, bytes: &[u8]| {
        std::fs::write(broken.path(name), bytes).unwrap();
        broken.path(name).display().to_string()
    };
    // Headers of maps that would take terabytes, that end early, that hold NaN where lengths should be.
    let huge = path(
        "huge.hdr",
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n\x02\x02",
    );
    let short =
        path("short.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n\x02\x02\x00\x80");
    let text = path("text.hdr", b"this is no picture");
    let exr = path(
        "short.exr",
        b"\x76\x2f\x31\x01\x02\x00\x00\x00channels\x00chlist\x00\xff\xff\xff\x7f",
    );
    let kind = path("map.docx", b"PK");
    let numbered = folder.path("turn%04d.png").display().to_string();
    for (more, words) in [
        (&["--size", "1280"][..], "WIDTHxHEIGHT"),
        (&["--size", "0x0"], "16384"),
        (&["--size", "99999x1"], "16384"),
        (&["--size", "-5x5"], "WIDTHxHEIGHT"),
        (&["--camera", "upside-down"], "three-quarter"),
        (&["--camera", "upside-down"], "no saved views"),
        (&["--camera", "close:nobody"], "nobody"),
        (&["--camera", "close:head"], "curves"),
        (&["--focal", "0"], "mm"),
        (&["--focal", "NaN"], "mm"),
        (&["--samples", "0"], "--samples"),
        (&["--samples", "99999999"], "--samples"),
        (&["--light", "candle"], "studio"),
        (&["--display", "crt"], "agx"),
        (&["--model", "phong"], "karis"),
        (&["--skin", "11"], "clay"),
        (&["--skin", "green"], "clay"),
        (&["--overlay", "heat"], "mask=NAME"),
        (&["--overlay", "region=hair"], "gives a scalp"),
        (&["--opacity", "1.5"], "--opacity"),
        (&["--share", "0"], "--share"),
        (&["--exposure", "inf"], "--exposure"),
        (&["--hdri", "nowhere.hdr"], "nowhere.hdr"),
        (&["--hdri", &huge], "huge.hdr"),
        (&["--hdri", &short], "short.hdr"),
        (&["--hdri", &text], "text.hdr"),
        (&["--hdri", &exr], "short.exr"),
        (&["--hdri", &kind], "OpenEXR"),
        (&["--hdri-blur", "9"], "--hdri"),
        (&["--hdri", &text, "--light", "flat"], "one of them"),
        (&["--turntable", "3"], "%04d"),
        (&["--out", &numbered], "--turntable"),
        (&["--out", "hair.jpg"], ".png or .exr"),
        (&["--set", "hair.nothing=1"], "nothing"),
        (&["--output", "hair.nothing"], "nothing"),
        (&["--scalp", "nowhere.obj"], "nowhere.obj"),
    ] {
        let ran = render(&folder, more);
        assert_eq!(ran.code, 2, "{more:?}: {}", ran.err);
        assert!(ran.err.contains(words), "{more:?}: {words:?} is not in {}", ran.err);
        assert_eq!(ran.err.lines().count(), 1, "{more:?}: {}", ran.err);
        check_untouched(&folder);
    }
    let ran = run_with(program(), ["render", "start"]);
    assert!(ran.code == 2 && ran.err.contains("--out"), "{}", ran.err);
}

#[test]
fn nothing_is_written_over_the_pictures_of_a_head() {
    let folder = Folder::new("render-over-maps");
    let put = |name: &str, text: &str| std::fs::write(folder.path(name), text).unwrap();
    put("head.obj", "mtllib head.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\n");
    put("head.mtl", "newmtl skin\nmap_Kd face.png\n");
    put("face.png", "no picture, and read all the same");
    let at = |name: &str| folder.path(name).display().to_string();
    let (mesh, over, free) = (at("head.obj"), at("face.png"), at("hair.png"));
    for (out, report, named) in
        [(&over, at("r.json"), "face.png"), (&free, at("head.mtl"), "head.mtl")]
    {
        let words = ["--scalp", &mesh, "--out", out, "--report", &report];
        let ran = run_with(program(), small(&words));
        assert_eq!(ran.code, 2, "{}", ran.err);
        let says = format!("{named} of the head, which is read");
        assert!(ran.err.contains(&says), "{}", ran.err);
        let face = std::fs::read_to_string(folder.path("face.png")).unwrap();
        assert_eq!(face, "no picture, and read all the same");
    }
}

#[test]
fn without_an_adapter_one_line_names_what_to_install() {
    let folder = Folder::new("render-none");
    let picture = folder.path("hair.png");
    std::fs::write(&picture, "what was there").unwrap();
    let none = Folder::new("render-none-driver");
    let driver = none.path("none.json");
    std::fs::write(&driver, "").unwrap();
    let out = program()
        .args(small(&[]))
        .arg("--out")
        .arg(&picture)
        .env("WGPU_BACKEND", "vulkan")
        .env("VK_ICD_FILENAMES", &driver)
        .env("VK_DRIVER_FILES", &driver)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(1), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.contains("mesa-vulkan-drivers"), "{said}");
    assert_eq!(folder.names(), ["hair.png"]);
    assert_eq!(std::fs::read_to_string(picture).unwrap(), "what was there");
}

/// Size and texts of a PNG.
fn png(path: &Path) -> ([u32; 2], BTreeMap<String, String>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
    let info = reader.info();
    let latin = info.uncompressed_latin1_text.iter().map(|t| (t.keyword.clone(), t.text.clone()));
    let texts = info.utf8_text.iter().map(|t| (t.keyword.clone(), t.get_text().unwrap()));
    ([info.width, info.height], latin.chain(texts).collect())
}

#[test]
fn a_picture_has_its_size_and_says_what_it_shows() {
    let test = "a_picture_has_its_size_and_says_what_it_shows";
    if !adapter(test) {
        return;
    }
    let folder = Folder::new("render-picture");
    let report_path = folder.path("report.json").display().to_string();
    let ran = render(&folder, &["--camera", "front", "--report", &report_path]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let report: Json =
        serde_json::from_str(&std::fs::read_to_string(report_path).unwrap()).unwrap();
    let (size, texts) = png(&folder.path("hair.png"));
    assert_eq!(size, [64, 36]);
    let text =
        |key: &str| texts.get(key).unwrap_or_else(|| panic!("{key} is not in {texts:?}")).as_str();
    assert_eq!(text("Software"), format!("coif {}", env!("CARGO_PKG_VERSION")));
    assert_eq!(text("graph").len(), 32);
    assert!(text("hair").contains(report["outputs"][0]["hash"].as_str().unwrap()));
    assert_eq!(text("camera"), "front, 85 mm");
    assert_eq!(text("samples"), "2");
    assert_eq!(text("view"), "hair");
    assert_eq!(text("display"), "AgX");
    assert_eq!(text("adapter"), report["picture"]["adapter"].as_str().unwrap());
    assert!(text("Description").starts_with("final, 1,500 strands"), "{}", text("Description"));
    for field in ["evaluation_ms", "first_sample_ms", "draw_ms"] {
        assert!(report["picture"][field].as_f64().unwrap() > 0.0, "{field}: {report}");
    }
    assert_eq!(folder.names(), ["hair.png", "report.json"]);
}

#[test]
fn a_saved_view_is_a_camera_and_others_are_listed() {
    let folder = Folder::new("render-saved");
    let graph = folder.path("saved.ron");
    let start = coif_graphs::grooms::by_name("start").unwrap();
    let views = r#"    views: {
        "flat": (eye: (0, 4, 60), target: (0, 4, 0), up: (0, 1, 0), focal_mm: 50, orthographic: 30),
        "hero": (eye: (30, 8, 42), target: (0, 1, 0), up: (0, 1, 0), focal_mm: 70),
    },
    nodes: {"#;
    std::fs::write(&graph, start.replace("    nodes: {", views)).unwrap();
    let (graph, out) = (graph.display().to_string(), folder.path("hair.png").display().to_string());
    let seen = |camera: &[&str]| {
        let mut args = small(&["--out", &out]);
        args[1] = &graph;
        run_with(program(), args.iter().chain(camera).copied())
    };
    let ran = seen(&["--camera", "herp"]);
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("none of the graph's saved views (flat, hero)"), "{}", ran.err);
    if !adapter("a_saved_view_is_a_camera_and_others_are_listed") {
        return;
    }
    for (camera, said) in [
        (&["--camera", "hero"][..], "hero, 70 mm"),
        (&["--camera", "flat"], "flat, parallel, 30 cm high"),
    ] {
        let ran = seen(camera);
        assert_eq!(ran.code, 0, "{}", ran.err);
        assert_eq!(png(&folder.path("hair.png")).1["camera"], said);
    }
}

#[test]
fn light_and_skin_that_are_saved_with_the_groom_are_drawn_with_unless_others_are_asked_for() {
    const NAME: &str =
        "light_and_skin_that_are_saved_with_the_groom_are_drawn_with_unless_others_are_asked_for";
    if !adapter(NAME) {
        return;
    }
    let folder = Folder::new("render-look");
    let graph = folder.path("look.ron");
    let start = coif_graphs::grooms::by_name("start").unwrap();
    let look = "    look: (light: \"backlit\", exposure: 1.0, skin: \"9\"),\n    nodes: {";
    std::fs::write(&graph, start.replace("    nodes: {", look)).unwrap();
    let odd = folder.path("odd.ron").display().to_string();
    let (graph, out) = (graph.display().to_string(), folder.path("hair.png").display().to_string());
    let drawn = |graph: &str, more: &[&str]| {
        let mut args = small(&["--out", &out]);
        args[1] = graph;
        let ran = run_with(program(), args.iter().chain(more).copied());
        assert_eq!(ran.code, 0, "{}", ran.err);
        std::fs::read(folder.path("hair.png")).unwrap()
    };
    let saved = drawn(&graph, &[]);
    assert_eq!(png(&folder.path("hair.png")).1["light"], "backlit");
    let asked = ["--light", "backlit", "--exposure", "1", "--skin", "9"];
    assert!(saved == drawn("start", &asked), "the same picture");
    std::fs::write(&odd, start.replace("    nodes: {", &look.replace("backlit", "disco"))).unwrap();
    let ran = run_with(program(), {
        let mut args = small(&["--out", &out]);
        args[1] = &odd;
        args
    });
    assert!(ran.err.contains("this version has no light \"disco\""), "{}", ran.err);
    let usual = drawn("start", &[]);
    assert!(saved != usual && usual == drawn(&graph, &["--light", "studio", "--skin", "5"]));
}

#[test]
fn an_overlay_lays_the_region_or_a_mask_as_heat_on_the_skin() {
    if !adapter("an_overlay_lays_the_region_or_a_mask_as_heat_on_the_skin") {
        return;
    }
    let folder = Folder::new("render-overlay");
    let drawn = |more: &[&str]| {
        let ran = render(&folder, &[&["--opacity", "0"], more].concat());
        assert_eq!(ran.code, 0, "{}", ran.err);
        std::fs::read(folder.path("hair.png")).unwrap()
    };
    let region = drawn(&["--overlay", "region"]);
    assert!(region != drawn(&[]));
    // Where hair grows on the built-in head is its mask of this name.
    assert!(region == drawn(&["--overlay", "mask=scalp"]));
    let ran = render(&folder, &["--overlay", "mask=beard"]);
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert!(
        ran.err.contains("--overlay: the scalp has no mask \"beard\"; it has: "),
        "{}",
        ran.err
    );
}

#[test]
fn a_preview_says_so_and_hashes_are_those_of_eval() {
    if !adapter("a_preview_says_so_and_hashes_are_those_of_eval") {
        return;
    }
    let folder = Folder::new("render-preview");
    let ran = render(&folder, &["--quality", "preview", "--report", "-"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let report: Json = serde_json::from_str(&ran.out).unwrap();
    let same = coif_tests::eval(
        "start",
        &["--set", "hair.by=count", "--set", "hair.count=1500", "--quality", "preview"],
    );
    assert_eq!(report["outputs"], same["outputs"]);
    let (_, texts) = png(&folder.path("hair.png"));
    assert!(texts["Description"].starts_with("preview"), "{texts:?}");
    assert_eq!(report["picture"]["description"].as_str(), Some(&*texts["Description"]));
}

#[test]
fn pictures_are_the_same_bytes_with_one_and_two_driver_threads() {
    if !adapter("pictures_are_the_same_bytes_with_one_and_two_driver_threads") {
        return;
    }
    let folder = Folder::new("render-threads");
    let drawn = |threads: &str| {
        let path = folder.path(&format!("{threads}.png"));
        let mut command = program();
        command.args(small(&[])).arg("--out").arg(&path).env("LP_NUM_THREADS", threads);
        let out = command.args(["--threads", threads]).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        std::fs::read(path).unwrap()
    };
    assert!(drawn("1") == drawn("2"), "the pictures differ");
}

#[test]
fn a_turntable_is_numbered_from_one_and_turns_all_the_way() {
    if !adapter("a_turntable_is_numbered_from_one_and_turns_all_the_way") {
        return;
    }
    let folder = Folder::new("render-turn");
    let out = folder.path("turn.%04d.png").display().to_string();
    let ran = run_with(program(), small(&["--camera", "front", "--turntable", "3", "--out", &out]));
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert_eq!(folder.names(), ["turn.0001.png", "turn.0002.png", "turn.0003.png"]);
    let pictures: Vec<Vec<u8>> =
        folder.names().iter().map(|name| std::fs::read(folder.path(name)).unwrap()).collect();
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2], "the head does not turn");
    let still = folder.path("still.png").display().to_string();
    let ran = run_with(program(), small(&["--camera", "front", "--out", &still]));
    assert_eq!(ran.code, 0, "{}", ran.err);
    let pixels = |name: &str| {
        let file = std::io::BufReader::new(std::fs::File::open(folder.path(name)).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels
    };
    assert!(pixels("still.png") == pixels("turn.0001.png"), "a turntable starts at its camera");
}

#[test]
fn an_exr_is_scene_linear_and_says_what_it_shows() {
    if !adapter("an_exr_is_scene_linear_and_says_what_it_shows") {
        return;
    }
    let folder = Folder::new("render-exr");
    let path = folder.path("hair.exr");
    let more = ["--out", &path.display().to_string()];
    assert_eq!(render(&folder, &more).code, 0);
    let image = exr::prelude::read_first_rgba_layer_from_file(
        &path,
        |size, _| (size.width(), vec![[0f32; 4]; size.width() * size.height()]),
        |(width, pixels), at, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b, a];
        },
    )
    .unwrap();
    let pixels = &image.layer_data.channel_data.pixels.1;
    assert_eq!(pixels.len(), 64 * 36);
    assert!(pixels.iter().flatten().all(|x| x.is_finite()));
    assert!(pixels.iter().any(|p| p[3] > 0.9) && pixels.iter().any(|p| p[0] > 0.01));
    let said = format!("{:?} {:?}", image.attributes, image.layer_data.attributes);
    for words in ["coif.graph", "coif.samples", "final, 1,500 strands"] {
        assert!(said.contains(words), "{words} is not in {said}");
    }
}

#[test]
fn a_node_that_fails_and_a_folder_that_is_not_there_leave_the_picture() {
    if !adapter("a_node_that_fails_and_a_folder_that_is_not_there_leave_the_picture") {
        return;
    }
    let folder = Folder::new("render-fails");
    for (more, words) in [
        (&["--set", "hair.count=0"][..], "no curves"),
        (&["--out", "/nowhere/at/all/hair.png"], "folder"),
        (&["--view", "shoe_size"], "shoe_size"),
    ] {
        let ran = render(&folder, more);
        assert_eq!(ran.code, 1, "{more:?}: {}", ran.err);
        assert!(ran.err.contains(words), "{more:?}: {}", ran.err);
        check_untouched(&folder);
    }
}

#[test]
fn ctrl_c_ends_drawing_and_leaves_what_was_there() {
    if !adapter("ctrl_c_ends_drawing_and_leaves_what_was_there") {
        return;
    }
    let folder = Folder::new("render-interrupt");
    let picture = folder.path("hair.png");
    std::fs::write(&picture, "what was there").unwrap();
    let mut child = program()
        .args(["render", "start", "--samples", "4096", "--out"])
        .arg(&picture)
        .spawn()
        .unwrap();
    until_it_hears(&mut child);
    // Most machines draw by then; whatever it is at, it ends.
    std::thread::sleep(std::time::Duration::from_millis(3000));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.unwrap().success());
    assert_eq!(ends("it", || child.wait()).unwrap().code(), Some(130));
    check_untouched(&folder);
}
