//! `coif diff` and `coif merge`, alone and as git's merge driver in a real repository.

use coif_tests::{Folder, Ran, coif, run, run_with};
use serde_json::Value as Json;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const BASE: &str = r#"(
    format: 3,
    title: "Rows",
    nodes: {
        "head": (kind: "head"),
        "rows": (kind: "scatter_guides", label: "Guides", inputs: {"count": 20}, links: {"scalp": "head.scalp"}),
        "finer": (kind: "resample", inputs: {"count": 8}, links: {"curves": "rows.curves"}),
        "out": (kind: "groom_output", links: {"curves": "finer.curves"}),
    },
)"#;

/// A folder with a file for each text that is made of the base by putting something in the place of something.
fn files(test: &str, all: &[(&str, &[(&str, &str)])]) -> Folder {
    let folder = Folder::new(test);
    for (name, changes) in all {
        let text = changes.iter().fold(BASE.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
        std::fs::write(folder.path(name), text).unwrap();
    }
    folder
}

/// Runs the program in a folder.
fn run_in(folder: &Folder, args: &[&str]) -> Ran {
    let mut program = coif();
    program.current_dir(folder.path(""));
    run_with(program, args)
}

#[track_caller]
fn check(folder: &Folder, args: &[&str], code: i32, out: &str, err: &[&str]) -> Ran {
    let ran = run_in(folder, args);
    assert_eq!((ran.code, &*ran.out), (code, out), "{args:?}: {}", ran.err);
    for said in err {
        assert!(ran.err.contains(said), "{args:?}: {said:?} is not in\n{}", ran.err);
    }
    assert!(!err.is_empty() || ran.err.is_empty(), "{args:?}: {}", ran.err);
    ran
}

const NINE: &[(&str, &str)] = &[("\"count\": 8", "\"count\": 9")];
const TEN: &[(&str, &str)] = &[("\"count\": 8", "\"count\": 10")];
const MORE: &[(&str, &str)] = &[("\"count\": 20", "\"count\": 30"), ("\"Rows\"", "\"More\"")];

#[test]
fn a_diff_says_what_differs_and_its_exit_code_whether_anything_does() {
    let moved = ("kind: \"head\"", "kind: \"head\", at: (1.0, 2.0)");
    let all: &[(&str, &[_])] = &[
        ("a.ron", &[]),
        ("b.ron", NINE),
        ("moved.ron", &[moved]),
        ("spaced.ron", &[(",\n", ",\n\n")]),
    ];
    let folder = files("compare-diff", all);
    check(&folder, &["diff", "a.ron", "a.ron"], 0, "the same groom\n", &[]);
    let other = "the same groom, laid out otherwise as text\n";
    check(&folder, &["diff", "a.ron", "spaced.ron"], 0, other, &[]);
    check(&folder, &["diff", "a.ron", "b.ron"], 1, "Resample: count 8 to 9\n", &[]);
    let places = "the same hair: only places on the canvas differ (--all counts them)\n";
    check(&folder, &["diff", "a.ron", "moved.ron"], 1, places, &[]);
    let counted = "1 node moved on the canvas\nthe same hair\n";
    check(&folder, &["diff", "--all", "a.ron", "moved.ron"], 1, counted, &[]);
    check(&folder, &["diff", "cornrows", "cornrows"], 0, "the same groom\n", &[]);
    std::fs::write(folder.path("bad.ron"), "no groom").unwrap();
    check(
        &folder,
        &["diff", "bad.ron", "nix.ron"],
        2,
        "",
        &["bad.ron:1:", "nix.ron: no such file"],
    );
    let ran = run_in(&folder, &["diff", "--json", "a.ron", "b.ron"]);
    let json: Json = serde_json::from_str(&ran.out).unwrap();
    assert_eq!((ran.code, &json["same"], &json["same_hair"]), (1, &false.into(), &false.into()));
    let change = &json["changes"][0];
    assert_eq!((&change["node"], &change["name"]), (&"finer".into(), &"count".into()));
    assert_eq!((&change["from"], &change["to"]), (&"8".into(), &"9".into()));
}

#[test]
fn a_merge_takes_both_and_tells_what_meets() {
    let all: &[(&str, &[_])] =
        &[("base.ron", &[]), ("a.ron", NINE), ("b.ron", MORE), ("c.ron", TEN)];
    let folder = files("compare-merge", all);
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    for (ours, theirs, out) in [("a.ron", "b.ron", "ab.ron"), ("b.ron", "a.ron", "ba.ron")] {
        check(&folder, &["merge", "base.ron", ours, theirs, "--out", out], 0, "", &[]);
    }
    assert_eq!(read("ab.ron"), read("ba.ron"));
    let words = "title: \"Rows\" to \"More\"\nResample: count 8 to 9\nGuides: count 20 to 30\n";
    check(&folder, &["diff", "base.ron", "ab.ron"], 1, words, &[]);
    // In conflict: over ours, which opens, evaluates, and passes no check.
    let told = ["a.ron: conflict: finer.count: base 8, ours 9, theirs 10", "1 conflict"];
    check(&folder, &["merge", "base.ron", "a.ron", "c.ron"], 1, "", &told);
    let line = "// conflict: finer.count: base 8, ours 9, theirs 10\n                \"count\": 9,";
    assert!(read("a.ron").contains(line), "{}", read("a.ron"));
    check(&folder, &["check", "a.ron"], 2, "", &["merge conflict: finer.count"]);
    let hair = folder.path("hair.usda").display().to_string();
    assert_eq!(run_in(&folder, &["eval", "a.ron", "--out", &hair]).code, 0);
    let strict = run_in(&folder, &["eval", "a.ron", "--strict", "--out", &hair]);
    assert_eq!(strict.code, 2, "{}", strict.err);
    assert!(strict.err.contains("merge conflict"), "{}", strict.err);
    let decided = read("a.ron").replace("// conflict: finer.count: base 8, ours 9, theirs 10", "");
    std::fs::write(folder.path("a.ron"), decided).unwrap();
    check(&folder, &["check", "a.ron"], 0, "a.ron: 4 nodes, no errors\n", &[]);
}

#[test]
fn nothing_is_written_where_anything_is_amiss() {
    let all: &[(&str, &[_])] = &[("base.ron", &[]), ("a.ron", NINE), ("b.ron", MORE)];
    let folder = files("compare-amiss", all);
    std::fs::write(folder.path("bad.ron"), "(format: 3, nodes: {").unwrap();
    std::fs::write(folder.path("lost.ron"), BASE.replace("8},", "8}, // kept by nobody\n"))
        .unwrap();
    let huge = std::fs::File::create(folder.path("huge.ron")).unwrap();
    huge.set_len(300 << 20).unwrap();
    std::fs::write(folder.path("noise.ron"), "a\u{1b}[2J\u{202e}".repeat(100 << 10)).unwrap();
    std::fs::create_dir(folder.path("folder")).unwrap();
    let names = folder.names();
    let read = || -> Vec<_> {
        ["base.ron", "a.ron", "b.ron"].map(|name| std::fs::read(folder.path(name)).unwrap()).into()
    };
    let before = read();
    let amiss: &[(&[&str], &[&str])] = &[
        (&["bad.ron", "a.ron", "b.ron"], &["bad.ron:1:"]),
        (&["base.ron", "bad.ron", "nix.ron"], &["bad.ron:1:", "nix.ron: no such file"]),
        (&["base.ron", "nix.ron", "b.ron"], &["nix.ron: no such file"]),
        (&["base.ron", "a.ron", "lost.ron"], &["lost.ron", "kept by nobody"]),
        (&["base.ron", "a.ron", "huge.ron"], &["huge.ron: is larger than 256 MiB"]),
        (&["base.ron", "a.ron", "noise.ron"], &["noise.ron:1:"]),
        (&["base.ron", "a.ron", "b.ron", "--out", "base.ron"], &["base.ron", "which is read"]),
        (&["base.ron", "a.ron", "b.ron", "--out", "b.ron"], &["b.ron", "which is read"]),
        (&["base.ron", "base.ron", "base.ron"], &["base.ron", "which is read"]),
        (&["base.ron", "a.ron", "b.ron", "--out", "folder"], &["folder: is a folder"]),
        (&["base.ron", "a.ron", "b.ron", "--out", "none/x.ron"], &["its folder does not exist"]),
        (&["base.ron", "folder", "b.ron"], &["folder: is a folder"]),
    ];
    for (args, said) in amiss {
        let args: Vec<&str> = ["merge"].iter().chain(*args).copied().collect();
        let ran = check(&folder, &args, 2, "", said);
        assert!(!ran.err.contains(['\u{1b}', '\u{202e}']) && ran.err.len() < 10_000);
        assert_eq!((read(), folder.names()), (before.clone(), names.clone()), "{args:?}");
    }
    // One file thrice is itself.
    let same = ["merge", "base.ron", "base.ron", "base.ron", "--out", "same.ron"];
    check(&folder, &same, 0, "", &[]);
    check(
        &folder,
        &["diff", "base.ron", "same.ron"],
        0,
        "the same groom, laid out otherwise as text\n",
        &[],
    );
}

#[test]
fn names_that_steer_a_terminal_are_escaped_in_conflicts() {
    let name = |by: &str| format!("\"{by}\\u{{1b}}[2J\\u{{202e}}\"");
    let folder = Folder::new("compare-names");
    for by in ["base", "ours", "theirs"] {
        std::fs::write(folder.path(by), BASE.replace("\"Guides\"", &name(by))).unwrap();
    }
    let ran = run_in(&folder, &["merge", "base", "ours", "theirs", "--name", "\u{1b}]0;x\u{7}"]);
    assert_eq!(ran.code, 1);
    let ran =
        [ran, run_in(&folder, &["diff", "base", "theirs"]), run_in(&folder, &["check", "ours"])];
    for Ran { out, err, .. } in ran {
        assert!(!out.contains(['\u{1b}', '\u{202e}', '\u{7}']), "{out:?}");
        assert!(!err.contains(['\u{1b}', '\u{202e}', '\u{7}']), "{err:?}");
    }
}

/// A repository, whose git knows no settings but its own.
struct Repository(Folder);

impl Repository {
    fn alone(program: &mut Command, folder: &Path) {
        program.current_dir(folder).env("GIT_CONFIG_GLOBAL", "/dev/null");
        program.env("GIT_CONFIG_NOSYSTEM", "1");
    }
    fn new(test: &str) -> Option<Self> {
        if Command::new("git").arg("--version").output().is_err() {
            println!("skipped: {test} needs git");
            return None;
        }
        let new = Self(Folder::new(test));
        new.git(&["init", "-q", "-b", "main"]);
        Some(new)
    }
    fn run(&self, args: &[&str]) -> Output {
        let mut git = Command::new("git");
        Self::alone(&mut git, &self.path("."));
        git.args(["-c", "user.name=t", "-c", "user.email=t@t"]).args(args).output().unwrap()
    }
    #[track_caller]
    fn git(&self, args: &[&str]) {
        let out = self.run(args);
        assert!(out.status.success(), "{args:?}: {}", String::from_utf8_lossy(&out.stderr));
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }
    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }
    /// A branch of main on which the groom is the base with changes.
    fn branch(&self, name: &str, changes: &[(&str, &str)]) {
        self.git(&["checkout", "-q", "main"]);
        self.git(&["checkout", "-q", "-b", name]);
        let text = changes.iter().fold(BASE.to_owned(), |text, (from, to)| text.replace(from, to));
        std::fs::write(self.path("it's a groom.ron"), text).unwrap();
        self.git(&["commit", "-q", "-a", "--allow-empty", "-m", name]);
    }
}

#[test]
fn git_merges_grooms_by_the_driver_that_one_command_installs() {
    let Some(repository) = Repository::new("compare-git") else { return };
    let folder = &repository.0;
    std::fs::write(repository.path(".gitattributes"), "*.usdc binary").unwrap();
    std::fs::create_dir(repository.path("within")).unwrap();
    let install = |from: &str| {
        let mut program = coif();
        Repository::alone(&mut program, &folder.path(from));
        run_with(program, ["merge", "--install-driver"])
    };
    let ran = install("within");
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.out.contains("git config merge.coif.driver: '") && ran.out.contains("added"));
    assert_eq!(repository.read(".gitattributes"), "*.usdc binary\n*.ron merge=coif\n");
    let again = install(".");
    assert!(again.code == 0 && again.out.contains("already"), "{}", again.out);
    assert_eq!(repository.read(".gitattributes"), "*.usdc binary\n*.ron merge=coif\n");
    std::fs::write(repository.path("it's a groom.ron"), BASE).unwrap();
    repository.git(&["add", "."]);
    repository.git(&["commit", "-q", "-m", "base"]);
    // Both change one line of text: git alone would give up.
    let links = "inputs: {\"count\": 8}, links: {\"curves\": \"rows.curves\"}";
    repository.branch("ours", NINE);
    repository.branch(
        "theirs",
        &[(links, "bypass: true, inputs: {\"count\": 8}, links: {\"curves\": \"rows.curves\"}")],
    );
    repository.branch("other", TEN);
    repository.git(&["checkout", "-q", "ours"]);
    repository.git(&["merge", "-q", "-m", "clean", "theirs"]);
    let merged = repository.read("it's a groom.ron");
    assert!(merged.contains("\"count\": 9") && merged.contains("bypass: true"), "{merged}");
    // What meets is a conflict to git, too, and named by the file's own name.
    let out = repository.run(&["merge", "-m", "meets", "other"]);
    assert!(!out.status.success());
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(
        said.contains("it's a groom.ron: conflict: finer.count: base 8, ours 9, theirs 10"),
        "{said}"
    );
    let text = repository.read("it's a groom.ron");
    assert!(text.contains("// conflict: finer.count") && text.contains("bypass: true"), "{text}");
    let status = repository.run(&["status", "--porcelain"]);
    assert!(String::from_utf8_lossy(&status.stdout).contains("UU "), "{status:?}");
    repository.git(&["merge", "--abort"]);
    // A file that both added has no base.
    for by in ["first", "second"] {
        repository.branch(by, &[]);
        std::fs::write(repository.path("new.ron"), BASE.replace("Rows", by)).unwrap();
        repository.git(&["add", "."]);
        repository.git(&["commit", "-q", "-m", by]);
    }
    let out = repository.run(&["merge", "-m", "added", "first"]);
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(said.contains("new.ron: conflict: title"), "{said}");
    assert_eq!(run(["check", &repository.path("new.ron").display().to_string()]).code, 2);
    // Outside of a repository there is nothing to install into.
    let nowhere = Folder::new("compare-nowhere");
    let mut program = coif();
    Repository::alone(&mut program, &nowhere.path("."));
    program.env("GIT_CEILING_DIRECTORIES", nowhere.path("."));
    let ran = run_with(program, ["merge", "--install-driver"]);
    assert!(ran.code == 2 && ran.err.contains("not a git repository"), "{}", ran.err);
    assert_eq!(nowhere.names(), Vec::<String>::new());
}

#[test]
fn an_upgrade_and_a_value_on_the_old_port_merge_to_a_groom_that_can_be_evaluated() {
    let test = "an_upgrade_and_a_value_on_the_old_port_merge_to_a_groom_that_can_be_evaluated";
    let folder = Folder::new("compare-was");
    let mut texts = vec![];
    for name in ["base.ron", "ours.ron", "theirs.ron"] {
        let file = coif_tests::shared(test, &format!("data/reported/3/merge_was/{name}"));
        let Some(file) = file else { return };
        // A head that needs no file.
        let text = std::fs::read_to_string(file).unwrap();
        let mesh = "\"mesh\": \"../../../sintel/sintel.obj\",";
        assert!(text.contains(mesh));
        texts.push((name, text.replace(mesh, "")));
    }
    for (name, text) in texts {
        std::fs::write(folder.path(name), text).unwrap();
    }
    let lost = ["locs.fuzz = 0.3: lost, the other has no such port any more"];
    for (ours, theirs, out) in
        [("ours.ron", "theirs.ron", "a.ron"), ("theirs.ron", "ours.ron", "b.ron")]
    {
        check(&folder, &["merge", "base.ron", ours, theirs, "--out", out], 0, "", &lost);
    }
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    assert_eq!(read("a.ron"), read("b.ron"));
    assert!(read("a.ron").contains("\"thickness\": 0.6,"), "{}", read("a.ron"));
    let ran = run_in(&folder, &["check", "a.ron"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
}
