//! The command line's contract: exit codes, one clear line, and nothing touched when something is wrong.

use coif_nodes::formats::usd::read::ReadValues;
use coif_nodes::maths::hash::curve_id;
use coif_tests::waiting::ends;
use coif_tests::{Folder, Ran, adapter, eval, repository, run, shared, until_it_hears};
use serde_json::Value as Json;

/// A graph of `nodes`, `links` and a groom_output `out` fed by `hair.curves`.
fn graph(nodes: &str, links: &str) -> String {
    format!(
        "(\n    format: 1,\n    title: \"Test\",\n    seed: 0,\n    nodes: {{\n{nodes}\n    }},\n    links: {{\n{links}\n    }},\n)\n"
    )
}

const HEAD: &str = "        \"head\": (\n            kind: \"head\",\n        ),\n";
const GUIDES: &str = "        \"hair\": (\n            kind: \"scatter_guides\",\n            inputs: {\n                \"count\": 50,\n            },\n        ),\n";
const OUT: &str = "        \"out\": (\n            kind: \"groom_output\",\n        ),\n";
const WIRES: &str =
    "        \"hair.scalp\": \"head.scalp\",\n        \"out.curves\": \"hair.curves\",\n";

/// Evaluates a graph's text with an existing output file beside it: the exit code, what was said; and that the file is untouched.
#[track_caller]
fn check(test: &str, text: &str, more: &[&str], code: i32, said: &[&str]) -> Ran {
    let folder = Folder::new(test);
    let path = folder.path("graph.ron");
    std::fs::write(&path, text).unwrap();
    let out = folder.path("hair.usda");
    std::fs::write(&out, "what was there").unwrap();
    let report = folder.path("report.json");
    let mut args = vec!["eval".to_owned(), path.display().to_string()];
    args.extend(["--out".to_owned(), out.display().to_string()]);
    args.extend(["--report".to_owned(), report.display().to_string()]);
    args.extend(more.iter().map(|s| (*s).to_owned()));
    let ran = run(&args);
    assert_eq!(ran.code, code, "{test}: {}", ran.err);
    for words in said {
        assert!(ran.err.contains(words), "{test}: {words:?} is not in\n{}", ran.err);
    }
    if code != 0 {
        assert_eq!(std::fs::read_to_string(&out).unwrap(), "what was there", "{test}");
        assert_eq!(folder.names(), ["graph.ron", "hair.usda", "report.json"], "{test}");
        let report: Json =
            serde_json::from_str(&std::fs::read_to_string(&report).unwrap()).unwrap();
        assert!(!report["errors"].as_array().unwrap().is_empty(), "{test}: the report says why");
    }
    ran
}

#[test]
fn what_is_wrong_with_a_graph_is_said_with_its_node_before_anything_runs() {
    let good = graph(&[HEAD, GUIDES, OUT].concat(), WIRES);
    check("good", &good, &[], 0, &[]);
    let two = "        \"a\": (\n            kind: \"resample\",\n        ),\n        \"b\": (\n            kind: \"resample\",\n        ),\n";
    let circle = "        \"a.curves\": \"b.curves\",\n        \"b.curves\": \"a.curves\",\n        \"out.curves\": \"a.curves\",\n";
    check("cycle", &graph(&[two, OUT].concat(), circle), &[], 2, &["circle", "a"]);
    let crossed =
        "        \"hair.scalp\": \"head.scalp\",\n        \"out.curves\": \"head.scalp\",\n";
    check(
        "wire",
        &graph(&[HEAD, GUIDES, OUT].concat(), crossed),
        &[],
        2,
        &["out", "curves", "scalp"],
    );
    let missing = good.replace("kind: \"head\",", "kind: \"head\",\n            inputs: {\n                \"mesh\": \"none.obj\",\n            },");
    check("mesh", &missing, &[], 2, &["head", "none.obj", "no such file"]);
    check(
        "nan",
        &good.replace("\"count\": 50", "\"length\": NaN"),
        &[],
        2,
        &["hair", "length", "finite"],
    );
    check(
        "kind",
        &good.replace("scatter_guides", "scatter_gides"),
        &[],
        2,
        &["hair", "scatter_gides", "scatter_guides"],
    );
    check("input", &good.replace("\"count\"", "\"cuont\""), &[], 2, &["hair", "cuont", "count"]);
    check("socket", &good.replace("hair.curves", "hair.hairs"), &[], 2, &["hair", "hairs"]);
    check("syntax", &good.replace("links: {", "links: ["), &[], 2, &["graph.ron:"]);
    check("newer", &good.replace("format: 1", "format: 99"), &[], 2, &["99"]);
    check(
        "unwired",
        &good.replace("        \"hair.scalp\": \"head.scalp\",\n", ""),
        &[],
        2,
        &["hair", "scalp"],
    );
    check("output", &good, &["--output", "hair.nothing"], 2, &["hair.nothing", "curves"]);
    check("set", &good, &["--set", "hair.count=many"], 2, &["hair.count", "many"]);
    check("no node", &good, &["--set", "hare.count=5"], 2, &["hare"]);
    check("format", &good, &["--out", "/tmp/hair.docx"], 2, &["docx", ".usda"]);
    check(
        "folder",
        &good,
        &["--out", "/nowhere/at/all/hair.usda"],
        1,
        &["/nowhere/at/all/hair.usda", "folder"],
    );
}

#[test]
fn an_output_without_curves_is_a_failure_and_says_so() {
    let text = graph(&[HEAD, GUIDES, OUT].concat(), WIRES).replace("\"count\": 50", "\"count\": 0");
    check("empty", &text, &[], 1, &["out.curves", "no curves"]);
    // Beside hair it is told.
    let none = GUIDES.replace("\"hair\"", "\"none\"").replace("\"count\": 50", "\"count\": 0");
    let beside = OUT.replace("\"out\"", "\"none_out\"");
    let wires =
        "        \"none.scalp\": \"head.scalp\",\n        \"none_out.curves\": \"none.curves\",\n";
    let text = graph(&[HEAD, GUIDES, &none, &beside, OUT].concat(), &[WIRES, wires].concat());
    check("empty-beside", &text, &[], 0, &["none_out.curves gives no curves", "no group"]);
}

#[test]
fn usage_errors_are_exit_2() {
    for args in [
        &["eval"][..],
        &["eval", "x.ron", "--nope"],
        &["fly"],
        &["eval", "not-there.ron"],
        &["nodes", "not_a_node"],
        &["measure", "not-there.usdc"],
        &["check", "not-there.ron"],
    ] {
        assert_eq!(run(args).code, 2, "{args:?}");
    }
    assert_eq!(run(["--version"]).code, 0);
}

#[test]
fn check_opens_the_files_and_with_strict_lets_no_warning_pass() {
    let good = graph(&[HEAD, GUIDES, OUT].concat(), WIRES);
    let mesh = |name: &str| {
        let with = format!(
            "kind: \"head\",\n            inputs: {{\n                \"mesh\": \"{name}\",\n            }},"
        );
        good.replace("kind: \"head\",", &with)
    };
    let named = OUT.replace(
        "\"groom_output\",",
        "\"groom_output\",\n            inputs: {\n                \"name\": \"hair\",\n            },",
    );
    let both = [HEAD, GUIDES, &named, &named.replace("\"out\"", "\"out_2\"")].concat();
    let wires = format!("{WIRES}        \"out_2.curves\": \"hair.curves\",\n");
    let twice = graph(&both, &wires);
    for (test, text, strict, code, said) in [
        ("good", good.clone(), true, 0, &[][..]),
        ("missing", mesh("none.obj"), false, 2, &["head.mesh: none.obj", "no such file"]),
        ("broken", mesh("broken.obj"), false, 2, &["head.mesh: broken.obj"]),
        ("kind", mesh("broken.fbx"), false, 2, &["head.mesh: broken.fbx"]),
        ("clamped", good.replace("\"count\": 50", "\"count\": -50"), false, 0, &["warning"]),
        ("clamped", good.replace("\"count\": 50", "\"count\": -50"), true, 2, &["--strict"]),
        ("twice", twice.clone(), false, 0, &["out_2.name", "that of out, too"]),
        ("twice", twice, true, 2, &["that of out, too", "--strict"]),
    ] {
        let folder = Folder::new(&format!("check-{test}-{strict}"));
        std::fs::write(folder.path("graph.ron"), text).unwrap();
        std::fs::write(folder.path("broken.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
        std::fs::write(folder.path("broken.fbx"), "FBX").unwrap();
        let path = folder.path("graph.ron").display().to_string();
        let ran = run([&["check", &path][..], if strict { &["--strict"] } else { &[] }].concat());
        assert_eq!(ran.code, code, "{test}: {}", ran.err);
        for words in said {
            assert!(ran.err.contains(words), "{test}: {words:?} is not in\n{}", ran.err);
        }
        assert!(!said.is_empty() || ran.err.is_empty(), "{test}: {}", ran.err);
    }
}

#[test]
fn what_is_wrong_is_quoted_in_short() {
    let long = "spacing".repeat(10_000);
    for set in [
        format!("hair.count={long}"),
        format!("hair.by={long}"),
        format!("hair.{long}=3"),
        format!("{long}.count=3"),
        format!("out.name=[{long}"),
        long.clone(),
    ] {
        let ran = run(["eval", "start", "--set", &set]);
        assert!(ran.code == 2 || ran.code == 0, "{}", ran.code);
        // The longest names every node that there is.
        assert!(ran.err.len() < 3_000, "{} bytes: {}", ran.err.len(), &ran.err[..200]);
    }
    assert!(run(["eval", "start", "--output", &long]).err.len() < 500);
}

#[test]
fn measuring_half_a_file_says_which_half() {
    let folder = Folder::new("measure-half");
    let hair = "def BasisCurves \"hair\" { uniform token type = \"linear\" int[] curveVertexCounts = [2] \
                point3f[] points = [(0, 0, 0), (0, 4, 0)] }";
    let bad =
        "def BasisCurves \"bad\" { int[] curveVertexCounts = [3] point3f[] points = [(0, 0, 0)] }";
    let beside = "def \"beside\" (references = @part.usda@</hair>) {}";
    let gone = "def \"gone\" (references = @gone.usda@</hair>) {}";
    std::fs::write(folder.path("part.usda"), format!("#usda 1.0\n{hair}")).unwrap();
    let check = |prims: &[&str], code: i32, measured: usize, said: &str| {
        let path = folder.path("all.usda").display().to_string();
        std::fs::write(&path, format!("#usda 1.0\n{}", prims.join("\n"))).unwrap();
        let (text, json) = (run(["measure", &path]), run(["measure", &path, "--json"]));
        assert_eq!((text.code, json.code), (code, code), "{}", text.err);
        let said_text = if measured > 0 { &text.out } else { &text.err };
        assert!(said_text.contains(said), "{said}: {said_text}");
        // Broken prims are errors, so they are said there too.
        assert!(code == 0 || text.err.contains(said), "{said}: {}", text.err);
        if measured > 0 {
            let all: Json = serde_json::from_str(&json.out).unwrap();
            let all = all.as_array().unwrap();
            assert_eq!(all.len(), measured);
            let told = serde_json::to_string(&all[0]["left_out"]).unwrap();
            assert_eq!(told != "[]", !said.is_empty(), "{told}");
        }
    };
    check(&[hair, beside], 0, 2, "");
    check(
        &[hair, gone],
        0,
        1,
        "not read: /gone: reference @gone.usda@</hair>: there is no such file",
    );
    check(&[hair, bad], 1, 1, "not read: /bad: curves: curveVertexCounts: the curves count 3");
    check(&[gone], 2, 0, "not read: /gone: reference @gone.usda@</hair>: there is no such file");
    check(&[bad], 2, 0, "not read: /bad: curves: curveVertexCounts: the curves count 3");
    let empty = "def BasisCurves \"none\" { int[] curveVertexCounts = [] point3f[] points = [] }";
    check(&[empty], 2, 0, "there are no curves in it");
    check(&[hair, empty], 0, 2, "");
    // Counts that make no curve contradict the prim; a curve without length is one, of length 0.
    let measured = |prim: &str, code: i32, lines: &[&str], complaint: &str| {
        let path = folder.path("all.usda").display().to_string();
        std::fs::write(&path, format!("#usda 1.0\n{prim}")).unwrap();
        let (text, json) = (run(["measure", &path]), run(["measure", &path, "--json"]));
        assert_eq!((text.code, json.code), (code, code), "{}", text.err);
        for line in lines {
            assert!(text.out.contains(line), "{line}: {}", text.out);
        }
        assert!(text.err.contains(complaint) && (code != 0) != text.err.is_empty(), "{}", text.err);
    };
    let short = "def BasisCurves \"hair\" { uniform token type = \"linear\" int[] curveVertexCounts = [2, 1, 0, 3] \
                 point3f[] points = [(0, 0, 0), (0, 4, 0), (1, 0, 0), (2, 0, 0), (2, 0, 0), (2, 0, 0)] }";
    let (length, none) = ("length 0 to 4 cm", "note: 2 of 4 curves are none: curve 1 has 1 points");
    let complaint = "/hair: 2 of 4 curves have a number of points that makes no curve";
    measured(short, 1, &[length, "1 curve without length", none], complaint);
    let still = hair.replace("[2]", "[3, 3]").replace(
        "[(0, 0, 0), (0, 4, 0)]",
        "[(1, 0, 0), (1, 0, 0), (1, 0, 0), (2, 0, 0), (2, 0, 0), (2, 0, 0)]",
    );
    measured(&still, 0, &["length 0 to 0 cm", "2 curves without length", "BROKEN"], "");
    // One point is no curve: that is told, and nothing else is left.
    let path = folder.path("all.usda").display().to_string();
    let one = hair.replace("[2]", "[1]").replace(", (0, 4, 0)", "");
    std::fs::write(&path, format!("#usda 1.0\n{one}")).unwrap();
    let ran = run(["measure", &path]);
    assert_eq!(ran.code, 1, "{}", ran.out);
    assert!(ran.err.contains("there is no curve in it that can be measured"), "{}", ran.err);
}

#[test]
fn hair_is_measured_on_the_head_that_it_was_grown_on_without_what_was_left_out() {
    let file = "data/reported/3/head_and_cap.glb";
    let Some(head) = shared("hair_is_measured_on_the_head", file) else { return };
    let (head, folder) = (head.display().to_string(), Folder::new("measure-leave-out"));
    let (path, hair) = (folder.path("graph.ron"), folder.path("hair.usda").display().to_string());
    std::fs::write(&path, graph(&[HEAD, GUIDES, OUT].concat(), WIRES)).unwrap();
    let left_out = "head.leave_out=\"Hair* long\"";
    let path = path.display().to_string();
    let ran = run(["eval", &path, "--scalp", &head, "--set", left_out, "--out", &hair]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let measure =
        |more: &[&str]| run([&["measure", &hair, "--json", "--scalp", &head], more].concat());
    let too_deep = |ran: &Ran| {
        assert_eq!(ran.code, 0, "{}", ran.err);
        let all: Json = serde_json::from_str(&ran.out).unwrap();
        all[0]["scalp"]["too_deep"].as_u64().expect("a count")
    };
    let (whole, bare) = (measure(&[]), measure(&["--leave-out", "hair* LONG"]));
    assert_eq!(too_deep(&bare), 0);
    assert!(too_deep(&whole) > 0);
    // What the head node warns of is said here too.
    let said = "\"Hair, long\" stands over the crown";
    assert!(whole.err.contains(said) && !bare.err.contains(said), "{}", bare.err);
    for (more, said) in [
        (
            &["--leave-out", "Hat"][..],
            "--leave-out: \"Hat\" matches nothing; the mesh has the parts \"Head\"",
        ),
        (&["--leave-out", "*"], "leaves nothing of the mesh"),
    ] {
        let ran = measure(more);
        assert_eq!(ran.code, 2, "{}", ran.err);
        assert!(ran.err.contains(said), "{}", ran.err);
    }
    assert_eq!(run(["measure", &hair, "--leave-out", "Hair"]).code, 2);
}

#[test]
fn the_report_has_the_fields_of_the_contract() {
    let report = eval("start", &[]);
    for field in [
        "coif",
        "graph",
        "seed",
        "total_ms",
        "peak_rss_mib",
        "head",
        "outputs",
        "nodes",
        "errors",
        "warnings",
    ] {
        assert!(report.get(field).is_some(), "{field}");
    }
    for field in ["scale", "radius_cm"] {
        assert!(report["head"][field].is_number(), "head.{field}");
    }
    for field in ["node", "socket", "curves", "points", "bounds", "hash"] {
        assert!(report["outputs"][0].get(field).is_some(), "outputs.{field}");
    }
    for field in [
        "name",
        "kind",
        "ms",
        "cached",
        "tufts_run",
        "tufts_reused",
        "curves",
        "points",
        "messages",
    ] {
        assert!(report["nodes"][0].get(field).is_some(), "nodes.{field}");
    }
}

#[test]
fn the_report_tells_gesture_by_gesture_what_became_of_them() {
    const TEST: &str = "the_report_tells_gesture_by_gesture_what_became_of_them";
    // Kept with its root, 2 head units off the skin, and a path that leads down; a comb that names it and a curve that is gone; a
    // cut that names nothing, beside all hair.
    let made = curve_id(1, 0, 0);
    let view = "eye: (0.0, 0.0, 60.0), target: (0.0, 0.0, 0.0), up: (0.0, 1.0, 0.0), half_height: 0.25, pixels: 1000.0";
    let stroke = |x: &str, y: &str| {
        format!("x: [{x}], y: [{y}], pressure: [128, 0, 0], time: [0, 100, 100]")
    };
    let (down, aside) =
        (stroke("0, 0, 0", "-1200, 1000, 1000"), stroke("-400, 1600, 1600", "-1600, 0, 0"));
    let far = stroke("3000, 100, 100", "0, 800, 800");
    let sketch = format!(
        "        \"hair\": (kind: \"hair_sketch\", inputs: {{\"gestures\": [
            (id: 1, tool: \"implant\", layer: \"scalp\", {view}, {down}, root: (0.0, 7.6, 7.6), path_x: [10000, 5000, 2000], path_y: [5000, 15000, 20000], path_z: [0, 0, 0]),
            (id: 2, tool: \"comb\", layer: \"through\", {view}, {aside}, curves: [{made}, 57005]),
            (id: 7, tool: \"cut\", layer: \"through\", {view}, {far}),
        ]}}),\n"
    );
    let folder = Folder::new(TEST);
    let path = folder.path("sketch.ron");
    std::fs::write(&path, graph(&format!("{HEAD}{sketch}{OUT}"), WIRES)).unwrap();
    let report = eval(&path.display().to_string(), &[]);
    let nodes = report["nodes"].as_array().unwrap();
    let node = |name: &str| nodes.iter().find(|node| node["name"] == name).unwrap();
    assert!(node("head").get("gestures").is_none());
    let told = node("hair")["gestures"].as_array().unwrap();
    let of = |field: &str| -> Vec<Json> { told.iter().map(|one| one[field].clone()).collect() };
    assert_eq!(of("number"), [0, 1, 2]);
    assert_eq!(of("id"), [1, 2, 7]);
    assert_eq!(of("tool"), ["implant", "comb", "cut"]);
    assert_eq!(
        (of("named"), of("picked"), of("changed")),
        (list([0, 2, 0]), list([0, 1, 0]), list([1, 1, 0]))
    );
    assert_eq!(told[1]["orphaned"], serde_json::json!(["000000000000dead"]));
    assert!(told[2]["said"][0].as_str().unwrap().contains("crosses no curve"), "{told:?}");
    // sqrt(2) x 7.6 = 10.7 head units from the middle of a head of 8.9.
    let drift = told[0]["drift_cm"].as_f64().unwrap();
    assert!((1.0..2.5).contains(&drift) && told[1]["drift_cm"].is_null(), "{drift}");
    assert!(
        told[0]["turned_degrees"].as_f64().unwrap() >= 0.0 && told[1]["turned_degrees"].is_null()
    );
    let said = node("hair")["messages"].to_string();
    assert!(said.contains(&format!("{drift:.2} cm at most (gesture 0)")), "{said}");
}

fn list(of: [i32; 3]) -> Vec<Json> {
    of.map(Json::from).to_vec()
}

#[test]
fn the_seed_the_quality_and_set_values_reach_the_hair() {
    let hash =
        |more: &[&str]| eval("start", more)["outputs"][0]["hash"].as_str().unwrap().to_owned();
    let plain = hash(&[]);
    assert_eq!(plain, hash(&["--threads", "1"]));
    assert_ne!(plain, hash(&["--seed", "5"]));
    assert_ne!(plain, hash(&["--quality", "preview"]));
}

#[test]
fn without_arguments_the_start_up_groom_is_drawn_here() {
    if !adapter("without_arguments_the_start_up_groom_is_drawn_here") {
        return;
    }
    let folder = Folder::new("start");
    let out = coif_tests::program().current_dir(folder.path("")).output().unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{said}");
    assert_eq!(folder.names(), ["start.png"]);
    assert!(said.contains("100,000 strands") && said.contains("start.png"), "{said}");
}

#[test]
fn with_neither_display_nor_driver_the_start_up_groom_is_written_here() {
    let folder = Folder::new("start-bare");
    std::fs::write(folder.path("start.usdc"), "somebody's own").unwrap();
    // No driver is found: the loader of Vulkan looks into an empty file, and there is no display for another.
    let mut bare = coif_tests::program();
    bare.current_dir(folder.path("")).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    bare.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    let out = bare.output().unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{said}");
    assert_eq!(folder.names(), ["start-2.usdc", "start.usdc"]);
    assert_eq!(std::fs::read(folder.path("start.usdc")).unwrap(), b"somebody's own");
    assert!(std::fs::read(folder.path("start-2.usdc")).unwrap().starts_with(b"PXR-USDC"));
    for words in ["start.usdc is there already", "wrote start-2.usdc", "mesa-vulkan-drivers"] {
        assert!(said.contains(words), "{words:?} is not in\n{said}");
    }
}

#[test]
fn ctrl_c_leaves_what_was_there() {
    let folder = Folder::new("interrupt");
    let out = folder.path("hair.usda");
    std::fs::write(&out, "what was there").unwrap();
    // Much more hair than can be made before the signal comes.
    let mut child = coif_tests::coif()
        .args(["eval", "start", "--set", "hair.count=2000000", "--allow-large", "--out"])
        .arg(&out)
        .spawn()
        .unwrap();
    until_it_hears(&mut child);
    let killed =
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.unwrap().success());
    assert_eq!(ends("it", || child.wait()).unwrap().code(), Some(130));
    assert_eq!(folder.names(), ["hair.usda"]);
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "what was there");
}

#[cfg(unix)]
#[test]
fn ctrl_c_is_heard_at_any_moment_and_leaves_nothing() {
    // Strands four times as wide as a head, so that most of its time goes to hair that looks for a way out of the skin, and so many
    // that it would take hours.
    let folder = Folder::new("interrupt-anywhere");
    let out = folder.path("hair.usdc");
    let begin = || {
        coif_tests::coif()
            .args(["eval", "cornrows", "--set", "braid.width=100", "--set", "fill.count=300000"])
            .args(["--allow-large", "--out"])
            .arg(&out)
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap()
    };
    // At moments that lie further and further apart.
    let mut after = std::time::Duration::from_millis(100);
    for _ in 0..8 {
        let mut child = begin();
        until_it_hears(&mut child);
        std::thread::sleep(after);
        after = after * 4 / 3;
        let kill = ["-INT", &child.id().to_string()].map(str::to_owned);
        assert!(std::process::Command::new("kill").args(kill).status().unwrap().success());
        assert_eq!(ends("it", || child.wait()).unwrap().code(), Some(130), "{after:?}");
        assert!(folder.names().is_empty(), "{:?}", folder.names());
    }
}

#[test]
fn what_would_be_too_large_is_told_before_it_is_made_and_made_when_allowed() {
    let large = GUIDES
        .replace("50", "100000")
        .replace("},\n        ),", "    \"points\": 1024,\n            },\n        ),");
    let text = graph(&[HEAD, &large, OUT].concat(), WIRES);
    let said =
        ["hair: would make 102.4 million points (count 100000 x points 1024)", "--allow-large"];
    check("large", &text, &[], 1, &said);
    // Little, but the threads of a farm.
    let text = graph(&[HEAD, GUIDES, OUT].concat(), WIRES);
    check("threads", &text, &["--threads", "65536", "--allow-large"], 0, &["--threads 65536: "]);
}

#[test]
fn every_hostile_mesh_is_refused_in_one_line_or_loads() {
    let Some(bad) = shared("every_hostile_mesh_is_refused_in_one_line_or_loads", "data/bad") else {
        return;
    };
    let mut files = vec![];
    let mut folders = vec![bad];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            if path.is_dir() {
                folders.push(path);
            } else if ["obj", "glb", "gltf"].contains(&extension.as_str()) {
                files.push(path);
            }
        }
    }
    files.sort();
    // Every third: a process each is slow, and the readers' own tests read all of them.
    for path in files.iter().step_by(3) {
        let shown = path.display();
        let ran = ends(shown.to_string(), || {
            run([
                "eval".as_ref(),
                "start".as_ref(),
                "--scalp".as_ref(),
                path.as_os_str(),
                "--set".as_ref(),
                "hair.count=100".as_ref(),
            ])
        });
        assert!([0, 1, 2].contains(&ran.code), "{shown}: {} {}", ran.code, ran.err);
        assert!(
            !ran.err.contains("panicked") && !ran.err.contains("mistake in coif"),
            "{shown}: {}",
            ran.err
        );
        if ran.code == 2 {
            let name = path.file_name().unwrap().to_string_lossy();
            let lines: Vec<&str> = ran.err.lines().filter(|l| !l.contains("warning")).collect();
            assert_eq!(lines.len(), 1, "{shown}: {}", ran.err);
            assert!(lines[0].contains(&*name), "{shown}: {}", ran.err);
        }
    }
}

#[test]
fn hair_that_leads_over_partings_is_told_of() {
    let parted = |count: u32| {
        let nodes = format!(
            "{HEAD}        \"hair\": (kind: \"gather\", inputs: {{\"density\": 8.0}}),\n        \"parted\": (kind: \
             \"partings\", inputs: {{\"pattern\": \"straight_back\", \"count\": {count}}}),\n{OUT}"
        );
        let links = "        \"hair.scalp\": \"parted.scalp\",\n        \"out.curves\": \"hair.curves\",\n        \
                     \"parted.scalp\": \"head.scalp\",\n";
        graph(&nodes, links)
    };
    // A tie on the line between two sections; and over rows, of which it stands over two.
    let ran = check("two sections", &parted(2), &[], 0, &[]);
    assert!(!ran.err.contains("parting"), "{}", ran.err);
    let said =
        ["hair: a hair is combed over a parting to its tie", "out.curves: ", "lead over a parting"];
    check("rows", &parted(6), &[], 0, &said);
}

#[test]
fn hostile_documents_are_refused_in_one_line() {
    let folder = Folder::new("documents");
    let deep = "(".repeat(100_000);
    let cases: [(&str, &[u8]); 6] = [
        ("empty", b""),
        ("binary", &[0, 159, 146, 150, 255]),
        ("deep", deep.as_bytes()),
        ("json", b"{\"format\": 1}"),
        ("cut", b"(\n    format: 1,\n    nodes: {\n        \"a\": ("),
        ("twice", b"(format: 1, format: 1)"),
    ];
    for (name, bytes) in cases {
        let path = folder.path(&format!("{name}.ron"));
        std::fs::write(&path, bytes).unwrap();
        for command in ["eval", "check"] {
            let ran = run([command.as_ref(), path.as_os_str()]);
            assert_eq!(
                (ran.code, ran.err.lines().count()),
                (2, 1),
                "{command} {name}: {}",
                ran.err
            );
            assert!(ran.err.contains(&format!("{name}.ron")), "{}", ran.err);
        }
    }
}

#[test]
fn the_manual_names_every_input_of_every_node() {
    let text = run(["nodes"]).out;
    let json: Json = serde_json::from_str(&run(["nodes", "--json"]).out).unwrap();
    assert!(json.as_array().unwrap().len() >= 16);
    for node in coif_nodes::all() {
        assert!(text.contains(&format!("(`{}`)", node.id)), "{}", node.id);
        for input in node.inputs {
            assert!(text.contains(&format!("| `{}` |", input.name)), "{}.{}", node.id, input.name);
        }
    }
    let kept = std::fs::read_to_string(repository().join("docs/nodes.md")).unwrap();
    assert_eq!(kept, text, "docs/nodes.md is `coif nodes`: write it anew");
}

/// What a search for the makers of a hair of the rows of cornrows prints as JSON.
#[track_caller]
fn traced(more: &[&str]) -> Json {
    let ran = run([&["trace", "cornrows", "--output", "rows.curves", "--json"], more].concat());
    assert_eq!(ran.code, 0, "{more:?}: {}", ran.err);
    serde_json::from_str(&ran.out).expect("JSON")
}

#[test]
fn what_made_a_hair_is_found_by_place_by_id_and_by_the_number_in_files() {
    let folder = Folder::new("trace");
    let file = folder.path("rows.usda");
    let out = file.display().to_string();
    eval("cornrows", &["--output", "rows.curves", "--out", &out]);
    let rows = &coif_tests::curves_in(&file)[0];
    let first = rows.points[0].to_array().map(|x| x.to_string()).join(",");
    let of = |made: &Json| {
        let parts = made["parts"].as_array().unwrap();
        parts.iter().map(|part| (part["node"].clone(), part["id"].clone())).collect::<Vec<_>>()
    };
    let by_place = traced(&["--at", &first]);
    // Of seven strokes one made it.
    let nodes: Vec<Json> = of(&by_place).into_iter().map(|part| part.0).collect();
    assert_eq!(nodes, ["head", "rows", "rows"]);
    assert!(by_place["parts"][2]["id"].is_u64() && by_place["candidates"] == 9, "{by_place}");
    let by_id = traced(&["--hair", by_place["hair"].as_str().unwrap()]);
    assert_eq!(of(&by_id), of(&by_place));
    let ids = rows.primvars.iter().find(|primvar| primvar.name == "id").unwrap();
    let ReadValues::Int(ids) = &ids.values else { panic!("ids are numbers: {ids:?}") };
    let by_number = traced(&["--hair", &ids[0].to_string()]);
    assert_eq!(by_number["hair"], by_place["hair"]);
    let words = run(["trace", "cornrows", "--output", "rows.curves", "--at", &first]);
    assert!(words.out.contains("3 of 9 parts made it"), "{}", words.out);
    assert!(words.out.contains("\nrows (stroke_input)\n    stroke "));
    assert_eq!(folder.names(), ["rows.usda"]);
}

#[test]
fn a_hair_that_is_none_is_refused() {
    for (more, code, said) in [
        (&["--hair", "zzzzzzzzzzzzzzzz"][..], 2, "is no id: 16 hexadecimal digits"),
        (&["--hair", "twelve"], 2, "is no id: 16 hexadecimal digits"),
        (&["--hair", "0000000000000001"], 2, "no hair of the outputs has the id 0000000000000001"),
        (&["--hair", "2147483646"], 2, "no curve has this number in exported files"),
        (&["--at", "1,2"], 2, "write it as X,Y,Z in cm"),
        (&["--at", "1,NaN,2"], 2, "write it as X,Y,Z in cm"),
        (&[], 2, "--hair"),
        (&["--at", "0,0,0", "--set", "head.mesh=none.obj"], 2, "no such file"),
    ] {
        let ran = run([&["trace", "cornrows", "--output", "rows.curves"], more].concat());
        assert_eq!(ran.code, code, "{more:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{more:?}: {}", ran.err);
    }
}
