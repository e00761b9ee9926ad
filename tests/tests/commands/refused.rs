//! What `coif eval` refuses before anything runs, `coif check` and `coif batch` refuse in the same words.

use coif_tests::{Folder, run};

/// A groom with other entries among its nodes.
fn groom(nodes: &str) -> String {
    format!("(format: 3, nodes: {{{nodes}}})")
}

const HEAD: &str = r#""head": (kind: "head"), "guides": (kind: "scatter_guides", inputs: {"count": 9}, links: {"scalp": "head.scalp"}),"#;
const OUT: &str = r#""out": (kind: "groom_output", links: {"curves": "last.curves"}),"#;

/// That all three refuse a groom whose last node is this, and say this of it.
#[track_caller]
fn check(last: &str, said: &str) {
    let folder = Folder::new("refused");
    let path = |name: &str| folder.path(name).display().to_string();
    std::fs::write(path("g.ron"), groom(&format!("{HEAD} {last}, {OUT}"))).unwrap();
    let (graph, hair, job) = (path("g.ron"), path("hair.usda"), path("job.yaml"));
    let batch = ["batch", &graph, "--out-dir", &path("hair"), "-o", &job];
    for words in [&["check", &graph][..], &["eval", &graph, "--out", &hair], &batch] {
        let ran = run(words);
        assert_eq!(ran.code, 2, "{words:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{words:?}: {}", ran.err);
    }
    assert_eq!(folder.names(), ["g.ron"]);
}

#[test]
fn what_an_evaluation_refuses_is_refused_by_check_and_batch() {
    let on = |kind: &str, inputs: &str| {
        format!(
            r#""last": (kind: "{kind}", inputs: {{{inputs}}}, links: {{"curves": "guides.curves", "scalp": "head.scalp"}})"#
        )
    };
    let alone =
        |kind: &str, inputs: &str| on(kind, inputs).replace(r#", "scalp": "head.scalp""#, "");
    let mask = "last: amplitude: the scalp has no mask \"nonsense\"; it has: ";
    check(&on("noise", r#""amplitude": Mask("nonsense")"#), mask);
    check(&on("noise", r#""amplitude": Product([0.5, Mask("nonsense")])"#), mask);
    let width = r#""scale": Mask("scalp")"#;
    check(&alone("set_width", width), "last: scale: mask \"scalp\" needs the scalp wired");
    let moved = r#""translate": (1.0, 0.0, 0.0)"#;
    check(&alone("transform", moved), "last: scalp is not connected: wire it, or choose the space");
    check(
        &alone("transform", r#""roots": "bind""#),
        "last: scalp is not connected: roots can only",
    );
    check(
        &on("transform", r#""scale": (0.0, 0.0, 0.0)"#),
        "last: scale: (0, 0, 0) leaves no length",
    );
    check(&on("trim", r#""shape": "mesh""#), "last: shape is mesh, but nothing is wired to mesh");
    check(
        r#""last": (kind: "edge_partition", inputs: {"grouping": "picked"}, links: {"source": "guides.curves", "scalp": "head.scalp"})"#,
        "last: picked is not connected: wire curves to it",
    );
    let head = |inputs: &str| {
        format!(
            r#""other": (kind: "head", inputs: {{{inputs}}}), "last": (kind: "scatter_guides", links: {{"scalp": "other.scalp"}})"#
        )
    };
    check(&head(r#""region": "hairline""#), "other: no outline is drawn");
    let named = |region: &str| head(&format!(r#""region": "{region}", "region_name": "nonsense""#));
    check(&named("mask"), "other: region_name: \"nonsense\" is not there");
    check(&named("material"), "other: region_name: \"nonsense\" is not there");
    check(&head(r#""mesh": "none.obj""#), "none.obj: no such file");
    check(
        r#""last": (kind: "merge", bypass: true)"#,
        "last: bypassed, but it has no curves to pass on",
    );
}

#[test]
fn masks_that_only_an_evaluation_knows_are_not_refused() {
    let folder = Folder::new("refused-not");
    let path = |name: &str| folder.path(name).display().to_string();
    for (name, last) in [
        // Where lines run, only cutting tells; of a node that is passed by, nothing is read.
        (
            "sections.ron",
            r#""parted": (kind: "partings", links: {"scalp": "head.scalp"}), "last": (kind: "noise", inputs: {"amplitude": Mask("left")}, links: {"curves": "guides.curves", "scalp": "parted.scalp"})"#,
        ),
        (
            "bypassed.ron",
            r#""last": (kind: "noise", bypass: true, inputs: {"amplitude": Mask("nonsense")}, links: {"curves": "guides.curves", "scalp": "head.scalp"})"#,
        ),
        (
            "scalp.ron",
            r#""last": (kind: "noise", inputs: {"amplitude": Mask("scalp")}, links: {"curves": "guides.curves", "scalp": "head.scalp"})"#,
        ),
    ] {
        std::fs::write(path(name), groom(&format!("{HEAD} {last}, {OUT}"))).unwrap();
        let ran = run(["check", &path(name)]);
        assert_eq!(ran.code, 0, "{name}: {}", ran.err);
    }
}

#[test]
fn a_job_with_a_doomed_task_is_not_written() {
    let folder = Folder::new("refused-job");
    let path = |name: &str| folder.path(name).display().to_string();
    let two = groom(
        r#""a": (kind: "head"), "b": (kind: "head"),
        "ga": (kind: "scatter_guides", links: {"scalp": "a.scalp"}), "gb": (kind: "scatter_guides", links: {"scalp": "b.scalp"}),
        "oa": (kind: "groom_output", links: {"curves": "ga.curves"}), "ob": (kind: "groom_output", links: {"curves": "gb.curves"})"#,
    );
    std::fs::write(path("two.ron"), two).unwrap();
    let one = groom(&format!(
        r#"{HEAD} "out": (kind: "groom_output", links: {{"curves": "guides.curves"}})"#
    ));
    std::fs::write(path("one.ron"), one).unwrap();
    std::fs::write(path("none.ron"), groom(HEAD)).unwrap();
    for head in ["head.obj", "other.obj"] {
        std::fs::write(path(head), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    }
    std::fs::write(path("broken.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("rows.csv"), "guides.count\n3\nmany\n").unwrap();
    let names = folder.names();
    let batch = |graph: &str, more: &[&str]| {
        let (graph, hair, job) = (path(graph), path("hair"), path("job.yaml"));
        run([&["batch", &graph, "--out-dir", &hair, "-o", &job][..], more].concat())
    };
    let [head, other, broken, gone] = ["head.obj", "other.obj", "broken.obj", "gone.obj"].map(path);
    let (of_a, of_c, rows) = (format!("a={head}"), format!("c={head}"), path("rows.csv"));
    for (graph, more, said) in [
        ("two.ron", &["--head", &head][..], "several heads; write NODE=FILE with one of a, b"),
        ("two.ron", &["--head", &of_c], "several heads; write NODE=FILE with one of a, b"),
        ("two.ron", &["--head", &of_a, &other], "write the same NODE= before each"),
        ("one.ron", &["--head", &head, &gone], "gone.obj: no such file"),
        ("one.ron", &["--head", &broken], "broken.obj: "),
        ("one.ron", &["--sweep", &rows], "row 2: "),
        ("none.ron", &[], "no groom_output"),
    ] {
        let ran = batch(graph, more);
        assert_eq!(ran.code, 2, "{graph} {more:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{graph} {more:?}: {}", ran.err);
        assert_eq!(folder.names(), names, "{graph} {more:?}");
    }
    let ran = batch("two.ron", &["--head", &of_a]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let job = std::fs::read_to_string(path("job.yaml")).unwrap();
    assert!(job.contains("\"a={{Task.Param.Head}}\""), "{job}");
}
