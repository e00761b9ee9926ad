//! What commands print of texts that people did not write: nothing in it steers a terminal, and it stays short.

use coif_tests::{Folder, Ran, run};

/// Texts that a file may hold where it names something.
fn hostile() -> Vec<String> {
    let mut all: Vec<String> =
        vec!["a\n'\"`{}%s \u{1b}[2J\u{1b}[31mred\u{7}\u{8}\r\u{7f} \u{9b}31m\u{202e}x".to_owned()];
    all.push("a".repeat(100_000));
    all.push("word ".repeat(20_000));
    all
}

/// The text as RON has it, control characters as they are.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Graphs that hold the text in every place in turn where there can be one.
fn graphs(text: &str) -> Vec<String> {
    let text = quoted(text);
    let of = |title: &str, node: &str, kind: &str, inputs: &str, link: &str| {
        format!(
            "(format: 1, title: {title}, seed: 0, nodes: {{\"head\": (kind: \"head\"), {node}: (kind: {kind}, inputs: \
             {{{inputs}}}), \"g\": (kind: \"scatter_guides\", inputs: {{\"count\": 3}}), \"out\": (kind: \"groom_output\", inputs: \
             {{\"name\": {title}}})}}, links: {{\"g.scalp\": \"head.scalp\", \"out.curves\": \"g.curves\", {link}}})"
        )
    };
    vec![
        of(&text, "\"n\"", "\"merge\"", "", ""),
        of("\"t\"", &text, "\"merge\"", "", ""),
        of("\"t\"", "\"n\"", &text, "", ""),
        of("\"t\"", "\"n\"", "\"head\"", &format!("\"mesh\": {text}"), ""),
        of("\"t\"", "\"n\"", "\"head\"", &format!("\"builtin\": {text}"), ""),
        of("\"t\"", "\"n\"", "\"head\"", &format!("{text}: 1"), ""),
        of("\"t\"", "\"n\"", "\"merge\"", "", &format!("{text}: \"g.curves\"")),
        of("\"t\"", "\"n\"", "\"merge\"", "", &format!("\"n.in\": {text}")),
        format!("({text}"),
    ]
}

/// That nothing steers a terminal, no line is long and not much is said; gives how it ended.
#[track_caller]
fn check(args: &[&str]) -> i32 {
    let Ran { code, out, err } = run(args);
    for said in [&out, &err] {
        let steers = |c: char| (c.is_control() && c != '\n' && c != '\t') || c == '\u{202e}';
        let at = said.find(steers);
        assert_eq!(
            at,
            None,
            "{args:?}: {:?}",
            at.map(|at| said[at..].chars().take(40).collect::<String>())
        );
        // JSON is for programs.
        let said = if args.contains(&"--json") { &String::new() } else { said };
        let longest = said.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        assert!(longest < 8000, "{args:?}: a line of {longest} characters");
    }
    assert!(err.len() < 200_000, "{args:?}: {} bytes", err.len());
    code
}

#[test]
fn nothing_that_a_graph_holds_steers_the_terminal_or_fills_it() {
    let folder = Folder::new("messages");
    let file = folder.path("graph.ron").display().to_string();
    let hair = folder.path("hair.usda").display().to_string();
    for text in hostile() {
        for graph in graphs(&text) {
            std::fs::write(&file, &graph).expect("it is written");
            check(&["check", &file]);
            if check(&["eval", &file, "--out", &hair]) == 0
                && graph.contains("\"n\": (kind: \"merge\"")
            {
                check(&["measure", &hair]);
                check(&["measure", &hair, "--json"]);
            }
        }
        let arg: String = text.chars().take(10_000).collect();
        for command in ["check", "eval", "measure", "nodes"] {
            assert_ne!(check(&[command, &arg]), 0);
            assert_ne!(check(&[command, "--none", &arg]), 0);
        }
        for option in ["--set", "--output", "--scalp", "--out"] {
            check(&[
                "eval",
                "start",
                option,
                &arg,
                "--quality",
                "preview",
                "--output",
                "none.curves",
            ]);
        }
    }
}

#[test]
fn a_thousand_problems_are_counted_after_the_first_fifty() {
    let folder = Folder::new("messages-many");
    let file = folder.path("graph.ron").display().to_string();
    let nodes: String = (0..1000).map(|k| format!("\"n{k}\": (kind: \"none{k}\"),\n")).collect();
    std::fs::write(&file, format!("(format: 1, nodes: {{{nodes}}}, links: {{}})"))
        .expect("it is written");
    let ran = run(["check", &file]);
    let lines: Vec<&str> = ran.err.lines().collect();
    // Fifty, and one line for the other 950.
    assert_eq!((ran.code, lines.len()), (2, 51), "{}", ran.err);
    assert!(lines[50].contains("950 more"), "{}", lines[50]);
}

#[test]
fn strict_makes_warnings_errors_in_every_command_and_writes_nothing() {
    let folder = Folder::new("messages-strict");
    let out = folder.path("hair.usda").display().to_string();
    // A value that is clamped is known before anything runs, a hair that is left out is not.
    let clamped =
        ["eval", "clusters", "--quality", "preview", "--set", "hair.frizz=7", "--out", &out];
    for (args, plain, strict) in [
        (&clamped[..], 0, 2),
        (&["eval", "box_braids", "--quality", "preview", "--out", &out], 0, 1),
        (&["eval", "start", "--quality", "preview", "--out", &out], 0, 0),
    ] {
        let ran = run(args);
        assert_eq!(ran.code, plain, "{args:?}: {}", ran.err);
        std::fs::remove_file(&out).expect("it was written");
        let ran = run(args.iter().chain(&["--strict"]));
        assert_eq!(ran.code, strict, "{args:?}: {}", ran.err);
        assert_eq!(std::path::Path::new(&out).exists(), strict == 0, "{args:?}");
    }
}

#[test]
fn a_problem_is_told_once_with_its_line() {
    let folder = Folder::new("messages-once");
    let file = folder.path("graph.ron").display().to_string();
    let text = "(format: 1, nodes: {\n\"head\": (kind: \"head\"),\n\"g\": (kind: \"scatter_guides\", inputs: {\n\"length\": \
                \"long\",\n\"lie\": 720.0}),\n\"t\": (kind: \"texture_mask\"),\n\"o\": (kind: \"groom_output\"),\n}, \
                links: {\n\"g.scalp\": \"head.scalp\",\n\"t.scalp\": \"head.scalp\",\n\"o.curves\": \"g.curves\"})";
    std::fs::write(&file, text).expect("it is written");
    let ran = run(["check", &file]);
    let told = |place: &str| -> Vec<&str> {
        ran.err.lines().filter(|line| line.contains(place)).collect()
    };
    for (place, line) in [("g.length", 4), ("g.lie", 5), ("t.file", 6)] {
        let [one] = told(place)[..] else { panic!("{place}: {}", ran.err) };
        assert!(one.contains(&format!(".ron:{line}:")), "{one}");
    }
    assert_eq!(ran.code, 2);
    // Nor does evaluation tell what the reader said and what comes of it.
    let out = folder.path("o.usda").display().to_string();
    let ran = run(["eval", &file, "--out", &out]);
    let told: Vec<&str> = ran.err.lines().filter(|line| line.contains("g.length")).collect();
    let [one] = told[..] else { panic!("{}", ran.err) };
    assert!(one.contains(".ron:4:") && !one.starts_with("warning"), "{one}");
    assert_eq!(ran.code, 2, "{}", ran.err);
}

#[test]
fn every_shipped_document_passes_check_strict() {
    let folder = coif_tests::repository().join("graphs");
    let files: Vec<String> = ["grooms", "templates"]
        .iter()
        .flat_map(|kind| std::fs::read_dir(folder.join(kind)).expect("a folder").flatten())
        .map(|entry| entry.path().display().to_string())
        .filter(|path| path.ends_with(".ron"))
        .collect();
    let words = ["check".to_owned(), "--strict".to_owned()];
    let ran = run(words.iter().chain(&files));
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
}
