//! The house's own rules, asserted on what Cargo resolves and on the sources: who may depend on whom, crates and modules alike, which
//! features keep the same bits, which licences come in, and that a crate gives no type name twice.

#[path = "house/imports.rs"]
mod imports;

use coif_tests::repository;
use serde_json::Value as Json;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

fn cargo(args: &[&str]) -> String {
    let out = Command::new(env!("CARGO")).args(args).current_dir(repository()).output().unwrap();
    assert!(out.status.success(), "cargo {args:?}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

fn tree(package: &str, more: &[&str]) -> BTreeSet<String> {
    let args =
        [&["tree", "-q", "-p", package, "-e", "normal", "--prefix", "none", "-f", "{p}"], more]
            .concat();
    cargo(&args).lines().filter_map(|l| l.split(' ').next()).map(str::to_owned).collect()
}

#[test]
fn evaluation_knows_no_window_and_no_gpu() {
    for package in ["coif-nodes", "coif-graphs"] {
        for banned in ["egui", "eframe", "wgpu", "winit", "coif", "coif-shaders"] {
            assert!(!tree(package, &[]).contains(banned), "{package} pulls in {banned}");
        }
    }
    assert!(!tree("coif-nodes", &[]).contains("rayon"), "nodes own no threads");
    let farm = tree("coif", &["--no-default-features"]);
    for banned in ["egui", "wgpu", "winit", "coif-shaders"] {
        assert!(!farm.contains(banned), "the farm build: {banned}");
    }
    assert!(tree("coif", &[]).contains("wgpu"), "the usual build draws");
}

#[test]
fn vector_maths_is_built_for_the_same_bits_everywhere() {
    let features = |package: &str| {
        let args = [
            "tree",
            "-q",
            "-p",
            "coif",
            "-e",
            "normal,features",
            "-i",
            package,
            "--prefix",
            "none",
        ];
        cargo(&args)
    };
    let glam = features("glam");
    for needed in ["glam feature \"libm\"", "glam feature \"scalar-math\""] {
        assert!(glam.contains(needed), "{needed} is not on:\n{glam}");
    }
    assert!(!glam.contains("fast-math"), "{glam}");
}

#[test]
fn every_dependency_is_licensed_as_deny_toml_allows() {
    let deny = std::fs::read_to_string(repository().join("deny.toml")).unwrap();
    let list = deny.split("allow = [").nth(1).and_then(|rest| rest.split(']').next()).unwrap();
    let allowed: Vec<&str> = list.split('"').skip(1).step_by(2).collect();
    let metadata: Json =
        serde_json::from_str(&cargo(&["metadata", "-q", "--format-version", "1"])).unwrap();
    for package in metadata["packages"].as_array().unwrap() {
        let name = package["name"].as_str().unwrap();
        let license = package["license"].as_str().unwrap_or("");
        assert!(satisfied(license, &allowed), "{name}: {license:?} is not allowed by deny.toml");
    }
}

/// Whether an SPDX expression (without nested parentheses beyond one level) can be met.
fn satisfied(expression: &str, allowed: &[&str]) -> bool {
    let flat = expression.replace('/', " OR ");
    let all_of = |part: &str| {
        let part = part.trim().trim_start_matches('(').trim_end_matches(')');
        part.split(" AND ").all(|one| {
            one.split(" OR ").any(|l| allowed.contains(&l.trim().trim_matches(['(', ')'])))
        })
    };
    // "(A OR B) AND C" needs each factor; "A OR B" needs one.
    if flat.contains(") AND") || flat.contains("AND (") {
        return flat.split(" AND ").all(|factor| {
            factor
                .trim()
                .trim_matches(['(', ')'])
                .split(" OR ")
                .any(|l| allowed.contains(&l.trim()))
        });
    }
    flat.split(" OR ").any(all_of)
}

/// Sources under some folders: where, and what they say.
fn sources(folders: &[&str]) -> Vec<(std::path::PathBuf, String)> {
    let mut folders: Vec<_> = folders.iter().map(|f| repository().join(f)).collect();
    let mut all = vec![];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() && path.file_name().is_some_and(|n| n != "target") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                all.push((path, text));
            }
        }
    }
    assert!(!all.is_empty());
    all
}

#[test]
fn every_source_file_says_what_it_is() {
    for (path, text) in sources(&["app", "nodes", "graphs", "shaders", "tests"]) {
        assert!(text.starts_with("//!"), "{} does not open with //!", path.display());
    }
}

/// Laws are kept from it by `nodes/clippy.toml`; what prints their figures lives beside a window that is not.
#[test]
fn what_is_measured_does_not_hang_on_the_systems_maths() {
    for (path, text) in sources(&["app/src/cli/measure"]) {
        let judged = text.split("#[cfg(test)]").next().unwrap();
        for maths in [
            "sin()",
            "cos()",
            "sin_cos()",
            "tan()",
            "asin()",
            "acos()",
            "atan()",
            "atan2(",
            "exp()",
            "exp2()",
            "ln()",
            "log(",
            "log2()",
            "log10()",
            "powf(",
            "powi(",
            "hypot(",
            "cbrt()",
            "mul_add(",
        ] {
            let method = format!(".{maths}");
            assert!(!judged.contains(&method), "{} calls {method}", path.display());
        }
    }
}

/// The layers of each crate, lowest first: a module imports modules of lower layers alone. Those of nodes end with the stages in which
/// hair is made, so that none knows a later one, and with what judges their work.
fn layers() -> [(&'static str, Vec<&'static str>); 4] {
    let floor = ["maths", "error", "data", "eval", "define", "declared formats"];
    let stages = coif_nodes::STAGES.iter().map(|(stage, _)| *stage);
    let nodes = floor.into_iter().chain(stages).chain(["laws"]).collect();
    let graphs = vec![
        "values",
        "text",
        "document",
        "file",
        "clipboard compare grooms schedule",
        "template trace",
    ];
    let shaders = vec![
        "camera display environment gpu hair source twins",
        "frame picture view",
        "legend light pipelines small strands",
        "chart hdri maps",
        "surface",
        "solids",
        "renderer",
    ];
    let app = vec![
        "words places files feeders",
        "library pack scene",
        "widgets",
        "core",
        "jobs",
        "rooms",
        "editor",
        "cli",
    ];
    [("nodes", nodes), ("graphs", graphs), ("shaders", shaders), ("app", app)]
}

/// The sources of a crate, by their paths below its `src`.
fn sources_of(package: &str) -> Vec<(std::path::PathBuf, String)> {
    let root = repository().join(package).join("src");
    let below = |(path, text): (std::path::PathBuf, String)| {
        (path.strip_prefix(&root).unwrap().to_owned(), text)
    };
    let mut all: Vec<_> = sources(&[&format!("{package}/src")]).into_iter().map(below).collect();
    all.sort();
    all
}

/// What goes up or sideways, a line each with its place. The root of a crate stands above all of its layers; rooms are folders of one
/// layer that do not know each other either.
fn against_the_layers(
    (package, layers): &(&str, Vec<&str>),
    all: &[imports::Import],
) -> Vec<String> {
    let layer = |module: &[String]| match module.first() {
        Some(name) => layers.iter().position(|layer| layer.split(' ').any(|one| one == name)),
        None => Some(layers.len()),
    };
    let part = |module: &[String]| {
        let depth = if module.first().is_some_and(|name| name == "rooms") { 2 } else { 1 };
        module.iter().take(depth).cloned().collect::<Vec<_>>()
    };
    let mut wrong = vec![];
    for import in all {
        let way = match (layer(&import.from), layer(&import.to)) {
            (Some(from), Some(to)) if to > from => "up",
            (Some(from), Some(to)) if to < from || part(&import.from) == part(&import.to) => {
                continue;
            }
            (Some(_), Some(_)) => "sideways",
            _ => "from or to no layer",
        };
        let (file, line, path) = (import.file.display(), import.line, &import.path);
        wrong.push(format!("{package}/src/{file}:{line}: crate::{path} leads {way}"));
    }
    wrong
}

#[test]
fn each_crate_stands_in_layers_and_no_room_knows_another() {
    for layered in layers() {
        let package = layered.0;
        let all = imports::imports(&sources_of(package));
        assert!(all.len() > 100, "{package}: {} imports were read", all.len());
        let wrong = against_the_layers(&layered, &all);
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
        for module in layered.1.iter().flat_map(|layer| layer.split(' ')) {
            let at = repository().join(package).join("src").join(module);
            assert!(at.is_dir() || at.with_extension("rs").is_file(), "{}", at.display());
        }
    }
}

#[test]
fn what_leads_up_or_sideways_is_told_with_its_place() {
    let layered = ("app", vec!["words", "core", "rooms", "cli"]);
    let check = |file: &str, text: &str, told: &[&str]| {
        let all = "cli/mod core/mod core/state rooms/pen/mod rooms/canvas words".split(' ');
        let mut all: Vec<_> =
            all.map(|file| (format!("{file}.rs").into(), String::new())).collect();
        all.retain(|(other, _): &(std::path::PathBuf, _)| *other != std::path::Path::new(file));
        all.push((file.into(), text.to_owned()));
        assert_eq!(against_the_layers(&layered, &imports::imports(&all)), told, "{text}");
    };
    check("rooms/canvas.rs", "use crate::core::state::State;\nuse crate::words;", &[]);
    check(
        "rooms/canvas.rs",
        "use crate::{\n    words,\n    rooms::pen::{Pen as P, self},\n};",
        &[
            "app/src/rooms/canvas.rs:1: crate::rooms::pen::Pen leads sideways",
            "app/src/rooms/canvas.rs:1: crate::rooms::pen leads sideways",
        ],
    );
    let up = "app/src/core/state.rs:2: crate::cli::run leads up";
    check("core/state.rs", "\nfn a() { crate::cli::run() }", &[up]);
    check("core/state.rs", "\nfn a() { super::super::cli::run(); super::notes::x() }", &[up]);
    check("core/state.rs", "mod a {\nuse super::super::super::cli::run;\n}", &[up]);
    check("core/state.rs", "// crate::cli::run\nconst A: &str = \"crate::cli::run\";", &[]);
    check("core/state.rs", "#[cfg(test)]\nmod tests { use crate::cli::run; }\nfn a<'a>() {}", &[]);
    check(
        "core/state.rs",
        "#[cfg(test)]\nuse crate::cli::run;\nuse crate::cli::run;",
        &["app/src/core/state.rs:3: crate::cli::run leads up"],
    );
    check("core/state.rs", "const A: &[u8] = br#\"'\"#;\nuse crate::cli::run;", &[up]);
    check(
        "core/state.rs",
        "use crate::VERSION;",
        &["app/src/core/state.rs:1: crate::VERSION leads up"],
    );
    check("main.rs", "use crate::cli::run;", &[]);
    let none = "app/src/new.rs:1: crate::words leads from or to no layer";
    check("new.rs", "use crate::words;", &[none]);
}

/// The types of a crate that more than one of its files gives a name in `pub`, `pub(crate)` or the like, each with these files.
fn names_given_twice(sources: &[(std::path::PathBuf, String)]) -> Vec<String> {
    let mut places: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (file, text) in imports::code(sources) {
        for name in public_types(&text) {
            places.entry(name).or_default().insert(file.display().to_string());
        }
    }
    let twice = places.into_iter().filter(|(_, files)| files.len() > 1);
    twice.map(|(name, files)| format!("{name}: {}", Vec::from_iter(files).join(", "))).collect()
}

/// The types that a file's code declares for others: associated types and names that macros make up are none.
fn public_types(code: &str) -> Vec<String> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let declared = |at: usize| {
        let rest = code[at..].strip_prefix("pub").filter(|_| !code[..at].ends_with(is_word))?;
        let rest = match rest.strip_prefix('(') {
            Some(within) => within.split_once(')')?.1,
            None => rest,
        };
        let (kind, name) = rest.strip_prefix(char::is_whitespace)?.trim_start().split_once(' ')?;
        let name = &name[..name.find(|c| !is_word(c)).unwrap_or(name.len())];
        let is_type = ["struct", "enum", "trait", "type", "union"].contains(&kind);
        (is_type && !name.is_empty()).then(|| name.to_owned())
    };
    code.match_indices("pub").filter_map(|(at, _)| declared(at)).collect()
}

#[test]
fn no_two_public_types_of_a_crate_share_a_name() {
    for (package, _) in layers() {
        let all = sources_of(package);
        let types: usize = all.iter().map(|(_, text)| public_types(text).len()).sum();
        assert!(types > 50, "{package}: {types} types were read");
        let twice = names_given_twice(&all);
        assert!(twice.is_empty(), "{package}/src: rename all but one\n{}", twice.join("\n"));
    }
}

#[test]
fn a_name_given_twice_is_told_with_its_files() {
    let check = |other: &str, told: &[&str]| {
        let own = "pub(crate) struct Section;\nstruct Wrap;\npub trait Read { type Item; }";
        let sources = [("cluster/mod.rs", own), ("data/sections.rs", other)];
        let sources = sources.map(|(file, text)| (file.into(), text.to_owned()));
        assert_eq!(names_given_twice(&sources), told, "{other}");
    };
    let section = &["Section: cluster/mod.rs, data/sections.rs"];
    check("pub struct Section<T>(T);", section);
    check("pub(super) enum Section {}", section);
    check("pub(in crate::data)\n    type Section = u8;", section);
    check("struct Section; pub struct Sections; pub fn section() {}", &[]);
    check("pub enum Wrap {}\npub struct Item;", &[]);
    check("// pub struct Section;\nconst A: &str = \"pub struct Section;\";", &[]);
    check("#[cfg(test)]\nmod tests { pub struct Section; }", &[]);
    check("#[cfg(unix)]\npub struct Path;\n#[cfg(not(unix))]\npub struct Path;", &[]);
}

#[test]
fn what_the_program_writes_is_written_in_one_place() {
    for (file, text) in imports::code(&sources_of("app")) {
        if file.starts_with("files") {
            continue;
        }
        for write in
            ["fs::write", "fs::rename", "fs::copy", "fs::hard_link", "File::create", "OpenOptions"]
        {
            let at = text.find(write).map(|at| text[..at].matches('\n').count() + 1);
            assert_eq!(at, None, "app/src/{}: {write}, which app/src/files does", file.display());
        }
    }
}

#[test]
fn jobs_are_asked_for_by_types_and_not_by_words() {
    for (file, text) in imports::code(&sources_of("app")) {
        let reads_words = text.contains("parse_from(") || text.contains("clap::");
        assert!(!reads_words || file.starts_with("cli"), "app/src/{} reads words", file.display());
        assert!(!text.contains(".parse_from("), "app/src/{} makes words up", file.display());
    }
}

/// Files whose tests know a clock: where waiting is, and what prints how long something takes and judges nothing.
const CLOCKS: &[&str] =
    &["tests/src/waiting.rs", "tests/examples/judge.rs", "shaders/src/hair/tests.rs"];
/// Files whose tests rest: where waiting is, hands, which do so as people do, and what chooses moments to interrupt something at.
const RESTS: &[&str] = &[
    "tests/src/waiting.rs",
    "tests/src/lib.rs",
    "tests/src/screen.rs",
    "tests/src/tablet.rs",
    "tests/tests/window/hands.rs",
    "tests/tests/window/pen.rs",
    "tests/tests/commands/command_line.rs",
    "tests/tests/commands/render.rs",
    "app/src/editor/documents/tests.rs",
];

/// What of a source is tests: how often it names something, more than its code does.
fn in_tests(file: &std::path::Path, text: &str, code: Option<&str>, name: &str) -> usize {
    let is_test = !file.iter().any(|part| part == "src") || file.starts_with("tests");
    let all = imports::without_words(text).matches(name).count();
    all - if is_test { 0 } else { code.map_or(0, |code| code.matches(name).count()) }
}

#[test]
fn tests_wait_for_what_happens_and_count_work_instead_of_seconds() {
    for package in ["app", "graphs", "nodes", "shaders", "tests"] {
        let root = repository();
        let below = |(path, text): (std::path::PathBuf, String)| {
            (path.strip_prefix(root).unwrap().to_owned(), text)
        };
        let all: Vec<_> = sources(&[package]).into_iter().map(below).collect();
        let code: BTreeMap<_, _> = imports::code(&all).into_iter().collect();
        for (file, text) in &all {
            if file.iter().any(|part| part == "benches") {
                continue;
            }
            let code = code.get(file).map(String::as_str);
            let is_of = |files: &[&str]| files.iter().any(|one| file == std::path::Path::new(one));
            for name in ["Instant", "elapsed(", "from_secs", "ThreadTime", "recv_timeout"] {
                let named = in_tests(file, text, code, name);
                assert!(named == 0 || is_of(CLOCKS), "{}: {name} in tests", file.display());
            }
            let rests = in_tests(file, text, code, "sleep(");
            assert!(rests == 0 || is_of(RESTS), "{}: a test sleeps", file.display());
        }
    }
}
