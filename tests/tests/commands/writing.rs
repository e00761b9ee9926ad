//! Writing, by the real program: all or nothing, only onto files, and never over what is read.
#![cfg(unix)]

use coif_tests::waiting::{ends, until};
use coif_tests::{Folder, coif, until_it_hears};
use std::collections::BTreeMap;
use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Two guides on a mesh of its own: the least that is a groom.
const GRAPH: &str = r#"(
    format: 1,
    nodes: {
        "head": (kind: "head", inputs: {"mesh": "head.obj"}),
        "hair": (kind: "scatter_guides", inputs: {"count": 20}),
        "out": (kind: "groom_output"),
    },
    links: {
        "hair.scalp": "head.scalp",
        "out.curves": "hair.curves",
    },
)
"#;

/// Something that stands in the folder before the program runs.
enum Made {
    /// A text file with a mode.
    File(&'static str, u32),
    /// A link, and what it says.
    Link(&'static str, &'static str),
    /// Another name of a file.
    Hard(&'static str, &'static str),
    Folder(&'static str),
    Fifo(&'static str),
    /// The machine's null device.
    Null(&'static str),
}
use Made::{Fifo, File, Hard, Link, Null};

impl Made {
    /// Makes it; false where that takes rights that we lack.
    fn make(&self, folder: &Folder) -> bool {
        let run = |command: &str, args: &[&str]| {
            let out = Command::new(command).args(args).current_dir(folder.path("")).output();
            out.is_ok_and(|out| out.status.success())
        };
        match *self {
            File(name, mode) => {
                fs::write(folder.path(name), format!("old {name}")).unwrap();
                fs::set_permissions(folder.path(name), fs::Permissions::from_mode(mode)).is_ok()
            }
            Link(name, to) => symlink(to, folder.path(name)).is_ok(),
            Hard(name, of) => fs::hard_link(folder.path(of), folder.path(name)).is_ok(),
            Made::Folder(name) => fs::create_dir(folder.path(name)).is_ok(),
            Fifo(name) => run("mkfifo", &[name]),
            Null(name) => run("mknod", &[name, "c", "1", "3"]),
        }
    }
}

fn hash(bytes: &[u8]) -> u64 {
    let mut hash = DefaultHasher::new();
    hash.write(bytes);
    hash.finish()
}

/// All that stands in a folder: its kind, mode and content. What is written there has the content `written`.
fn seen(folder: &Folder) -> BTreeMap<String, String> {
    let look = |name: String| {
        let path = folder.path(&name);
        let about = fs::symlink_metadata(&path).unwrap();
        let kind = about.file_type();
        let is = if kind.is_symlink() {
            format!("link to {}", fs::read_link(&path).unwrap().display())
        } else if kind.is_dir() {
            "folder".to_owned()
        } else if kind.is_fifo() {
            "pipe".to_owned()
        } else if kind.is_char_device() {
            "device".to_owned()
        } else {
            let bytes = fs::read(&path).unwrap();
            let of_ours = [&b"#usda"[..], b"PXR-USDC", b"HAIR", b"{\n  \"coif\""];
            let text = match of_ours.iter().any(|opening| bytes.starts_with(opening)) {
                true => "written".to_owned(),
                false if bytes.len() > 100 => {
                    format!("{} bytes, hash {:x}", bytes.len(), hash(&bytes))
                }
                false => String::from_utf8_lossy(&bytes).into_owned(),
            };
            format!("{:o} {text}", about.permissions().mode() & 0o7777)
        };
        (name, is)
    };
    folder.names().into_iter().map(look).collect()
}

/// A folder with the graph, its mesh, and what stands there besides; none where that cannot be made.
fn prepared(test: &str, made: &[Made]) -> Option<Folder> {
    let folder = Folder::new(&format!("writing-{}", test.replace(' ', "-")));
    fs::write(folder.path("g.ron"), GRAPH).unwrap();
    fs::write(folder.path("head.obj"), ball()).unwrap();
    for made in made {
        if !made.make(&folder) {
            println!("skipped: {test} makes a device, which root may");
            return None;
        }
    }
    Some(folder)
}

/// A ball of 11 cm, closed, with its poles.
fn ball() -> String {
    let (rings, around) = (8, 12);
    let mut text = String::new();
    for i in 0..=rings {
        for k in 0..around {
            let (a, b) = (
                std::f64::consts::PI * f64::from(i) / f64::from(rings),
                std::f64::consts::TAU * f64::from(k) / f64::from(around),
            );
            let (r, y) = (11.0 * a.sin(), 11.0 * a.cos());
            text += &format!("v {} {y} {}\n", r * b.cos(), r * b.sin());
        }
    }
    for i in 0..rings {
        for k in 0..around {
            let at = |i: i32, k: i32| 1 + i * around + k % around;
            text +=
                &format!("f {} {} {} {}\n", at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
        }
    }
    text
}

/// Runs `coif eval g.ron` or the words given among `made`: it ends with `code`, says `said`, and only `written` names (of what
/// links lead to, too) have another content than before. Nothing else comes, goes or changes its kind or mode.
#[track_caller]
fn check(test: &str, made: &[Made], words: &str, code: i32, said: &[&str], written: &[&str]) {
    let Some(folder) = prepared(test, made) else { return };
    let before = seen(&folder);
    let out = coif().args(words.split(' ')).current_dir(folder.path("")).output().unwrap();
    let err = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(code), "{test}: {err}");
    for words in said {
        assert!(err.contains(words), "{test}: {words:?} is not in\n{err}");
    }
    let mut expected = before.clone();
    for name in written {
        let mode = before.get(*name).map_or("644", |old| old.split(' ').next().unwrap());
        expected.insert((*name).to_owned(), format!("{mode} written"));
    }
    assert_eq!(seen(&folder), expected, "{test}: {err}");
}

#[test]
fn files_are_written_where_links_lead_and_keep_their_modes() {
    let out = "eval g.ron --out a.usda";
    check("a new file", &[], out, 0, &["wrote a.usda"], &["a.usda"]);
    check(
        "modes",
        &[File("a.usda", 0o600), File("r", 0o640)],
        &format!("{out} --report r"),
        0,
        &[],
        &["a.usda", "r"],
    );
    let chain = [File("a", 0o755), Link("b", "a"), Link("a.usda", "./b")];
    check("links", &chain, out, 0, &[], &["a"]);
    check("a link to nothing", &[Link("a.usda", "new")], out, 0, &[], &["new"]);
    check("hard links", &[File("a.usda", 0o644), Hard("b", "a.usda")], out, 0, &[], &["a.usda"]);
    check(
        "a circle",
        &[Link("a.usda", "b"), Link("b", "a.usda")],
        out,
        1,
        &["a.usda", "circle"],
        &[],
    );
    check(
        "a link into nowhere",
        &[Link("a.usda", "no/a")],
        out,
        1,
        &["leads to", "no/a", "folder"],
        &[],
    );
    check("read-only", &[File("a.usda", 0o444)], out, 1, &["a.usda", "read-only"], &[]);
    check("read-only link", &[File("b", 0o444), Link("a.usda", "b")], out, 1, &["read-only"], &[]);
    check("a folder", &[Made::Folder("a.usda")], out, 1, &["a.usda", "is a folder"], &[]);
    let long = format!("{}.usda", "a".repeat(250));
    check("a long name", &[], &format!("eval g.ron --out {long}"), 0, &[], &[&long]);
}

#[test]
fn devices_and_pipes_are_written_to() {
    check("a device", &[Null("n")], "eval g.ron --report n", 0, &[], &[]);
    check(
        "a device's link",
        &[Null("n"), Link("a.usda", "n")],
        "eval g.ron --out a.usda",
        0,
        &[],
        &[],
    );
    let Some(folder) = prepared("a pipe", &[Fifo("p"), Link("a.usdc", "p")]) else { return };
    let before = seen(&folder);
    let mut child = start(&folder, "eval g.ron --out a.usdc --out b.usdc");
    let piped = fs::read(folder.path("p")).unwrap();
    assert!(child.wait().unwrap().success());
    assert_eq!(piped, fs::read(folder.path("b.usdc")).unwrap(), "the same bytes as in a file");
    fs::remove_file(folder.path("b.usdc")).unwrap();
    assert_eq!(seen(&folder), before);
    // What an open file's handle leads to is added to: a shell's `>> log`.
    let log = fs::File::options().create(true).append(true).open(folder.path("log")).unwrap();
    fs::write(folder.path("log"), "kept\n").unwrap();
    let mut command = coif();
    let report = ["eval", "g.ron", "--report", "/dev/stdout"];
    command.args(report).current_dir(folder.path("")).stdout(log);
    assert!(command.output().unwrap().status.success());
    let log = fs::read_to_string(folder.path("log")).unwrap();
    assert!(log.starts_with("kept\n{") && log.ends_with("}\n"), "{log}");
}

#[test]
fn several_files_are_one_step() {
    let old = [File("a.usdc", 0o644), File("b.usda", 0o600)];
    let words = "eval g.ron --out a.usdc --out b.usda";
    check("all", &old, &format!("{words} --report r"), 0, &[], &["a.usdc", "b.usda", "r"]);
    let report = format!("{words} --report no/r");
    check("no place for the report", &old, &report, 1, &["no/r", "folder", "no hair"], &[]);
    let third = format!("{words} --out no/c.hair --report r");
    check("no place for the third", &old, &third, 1, &["no/c.hair", "no hair"], &["r"]);
    // The device is full, and a device comes last: both files are put back.
    let full = [File("a.usdc", 0o644), Link("b.usda", "/dev/full"), File("r", 0o644)];
    if Path::new("/dev/full").exists() {
        check(
            "a full device",
            &full,
            &format!("{words} --report r"),
            1,
            &["b.usda", "full", "no hair"],
            &["r"],
        );
    }
    check(
        "a node that fails",
        &old,
        &format!("{words} --set hair.count=0 --report r"),
        1,
        &["no hair"],
        &["r"],
    );
}

#[test]
fn nothing_is_written_over_what_is_read_or_twice() {
    let refused = |test: &str, made: &[Made], words: &str| {
        check(test, made, &format!("eval g.ron {words}"), 2, &[], &[]);
    };
    refused("twice", &[], "--out a.usda --out a.usda");
    refused("by another way", &[Made::Folder("f")], "--out a.usda --out f/../a.usda");
    refused("by a link", &[Link("b.usda", "./a.usda")], "--out a.usda --out b.usda");
    refused(
        "by a second name",
        &[File("a.usda", 0o644), Hard("b.usda", "a.usda")],
        "--out a.usda --out b.usda",
    );
    refused("the report onto hair", &[], "--out a.usda --report a.usda");
    refused("the report onto the graph", &[], "--report g.ron");
    refused("the report onto the graph's link", &[Link("r", "g.ron")], "--report r");
    refused("the report onto the mesh", &[], "--report head.obj");
    refused("hair onto the graph", &[Link("a.usda", "g.ron")], "--out a.usda --output hair.curves");
    refused("hair onto the mesh", &[Hard("a.usda", "head.obj")], "--out a.usda");
    refused("onto another mesh", &[Hard("b.obj", "head.obj")], "--scalp b.obj --report b.obj");
    let render = |test: &str, made: &[Made], words: &str| {
        check(test, made, &format!("render g.ron {words}"), 2, &[], &[]);
    };
    render("a picture twice", &[Link("b.png", "a.png")], "--out a.png --out b.png");
    render("a picture onto the mesh", &[Link("a.png", "head.obj")], "--out a.png");
    render("two of one name", &[], "--camera front --camera front --out a-%s.png");
    render(
        "of a series",
        &[Link("a-top.png", "a-left.png")],
        "--camera left --camera top --out a-%s.png",
    );
    render("of a turntable", &[Link("a2.png", "g.ron")], "--turntable 3 --out a%d.png");
}

fn start(folder: &Folder, words: &str) -> Child {
    let mut command = coif();
    command.args(words.split(' ')).current_dir(folder.path("")).stderr(Stdio::null());
    command.spawn().unwrap()
}

/// Whether these tests were started by `nohup`, and all that they start does not hear a hang-up.
fn is_under_nohup() -> bool {
    let text = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = text.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & 1 == 1))
}

#[test]
fn whoever_asks_it_to_end_finds_what_was_there() {
    let heard = |signal: &&str| *signal != "HUP" || !is_under_nohup();
    for signal in ["INT", "TERM", "HUP"].into_iter().filter(heard) {
        // Hair is in place and the pipe has no reader: it is taken back.
        let made = [File("a.usda", 0o640), Fifo("p")];
        let Some(folder) = prepared(&format!("SIG{signal}"), &made) else { return };
        let before = seen(&folder);
        let mut child = start(&folder, "eval g.ron --out a.usda --report p");
        until("hair is in place", || {
            fs::read(folder.path("a.usda")).unwrap().starts_with(b"#usda")
        });
        let id = child.id().to_string();
        assert!(
            Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success()
        );
        assert_eq!(ends("it", || child.wait()).unwrap().code(), Some(130), "{signal}");
        assert_eq!(seen(&folder), before, "{signal}");
    }
    // nohup asks not to end.
    let Some(folder) = prepared("nohup", &[Fifo("p")]) else { return };
    let mut nohup = Command::new("nohup");
    nohup.arg(coif().get_program()).args(["eval", "g.ron", "--out", "a.usda", "--report", "p"]);
    let mut child = nohup
        .current_dir(folder.path(""))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    until("hair is in place", || folder.path("a.usda").exists());
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-HUP", &id]).status().unwrap().success());
    let report = fs::read_to_string(folder.path("p")).unwrap();
    assert!(child.wait().unwrap().success() && report.starts_with('{'), "{report}");
}

#[test]
fn whoever_asks_it_to_end_is_heard_in_the_midst_of_what_cannot_look() {
    let Some(folder) = prepared("deaf", &[File("old", 0o644)]) else { return };
    // A graph and a file of curves that are read for seconds, in one go: whether somebody asks is looked at before and after.
    let numbers = "0.123456789,".repeat(6_000_000);
    let strokes =
        format!("\"pen\": (kind: \"stroke_input\", inputs: {{\"strokes\": [(x: [{numbers}])]}}),");
    fs::write(folder.path("long.ron"), GRAPH.replace("nodes: {", &format!("nodes: {{{strokes}")))
        .unwrap();
    fs::write(
        folder.path("long.usda"),
        format!("#usda 1.0\ndef BasisCurves \"a\" {{\nfloat[] widths = [{numbers} 0]\n}}\n"),
    )
    .unwrap();
    let check = |words: &str, report: Option<&str>| {
        let before = seen(&folder);
        let mut child = start(&folder, words);
        until_it_hears(&mut child);
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        assert_eq!(ends(words, || child.wait()).unwrap().code(), Some(130), "{words}");
        let mut expected = before;
        if let Some(report) = report {
            let text = fs::read_to_string(folder.path(report)).unwrap();
            assert!(text.contains("interrupted; no hair was written"), "{text}");
            expected.insert(report.to_owned(), "644 written".to_owned());
        }
        assert_eq!(seen(&folder), expected, "{words}");
        report.inspect(|report| fs::remove_file(folder.path(report)).unwrap());
    };
    check("eval long.ron --out a.usda --report r", Some("r"));
    // It may be a mesh of the graph, which has not been read.
    check("eval long.ron --report old", None);
    check("check long.ron", None);
    check("measure long.usda", None);
}

#[test]
fn that_nobody_hears_what_is_said_changes_nothing() {
    let Some(folder) = prepared("unheard", &[]) else { return };
    let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") else { return };
    let check = |words: &str, code: i32| {
        let mut command = coif();
        command.args(words.split(' ')).current_dir(folder.path("")).stdout(Stdio::null());
        let ended = command.stderr(full.try_clone().unwrap()).status().unwrap();
        assert_eq!(ended.code(), Some(code), "{words}");
    };
    check("eval g.ron --out a.usda", 0);
    assert!(fs::read(folder.path("a.usda")).unwrap().starts_with(b"#usda"));
    // A warning, and an error with its report.
    check("eval g.ron --out a.usda --threads 65536", 0);
    check("eval none.ron --report r.json", 2);
    check("measure none.usda", 2);
    // What was asked for and cannot be told is a failure.
    for words in ["measure a.usda", "check g.ron", "nodes"] {
        let mut command = coif();
        command.args(words.split(' ')).current_dir(folder.path("")).stderr(Stdio::null());
        let ended = command.stdout(full.try_clone().unwrap()).status().unwrap();
        assert_eq!(ended.code(), Some(1), "{words}");
    }
}

#[test]
fn a_pack_that_finds_no_room_says_so_in_one_line() {
    let Some(folder) = prepared("pack-limit", &[File("p.coif", 0o644)]) else { return };
    let before = seen(&folder);
    // One block of 512 or 1024 bytes: less than a ball packed.
    let mut limited = Command::new("sh");
    limited.args(["-c", "ulimit -f 1; exec \"$0\" template pack g.ron --out p.coif"]);
    let out = limited.arg(coif().get_program()).current_dir(folder.path("")).output().unwrap();
    let err = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(1), "{err}");
    assert!(err.contains("p.coif") && err.contains("larger"), "{err}");
    assert!(!err.contains("ZipWriter") && err.lines().count() <= 2, "{err}");
    assert_eq!(seen(&folder), before);
}

#[test]
fn a_limit_on_files_is_a_failed_write() {
    let Some(folder) = prepared("limit", &[File("a.usda", 0o644)]) else { return };
    let before = seen(&folder);
    // 4 blocks of 512 or 1024 bytes: less than 20 guides as text.
    let mut limited = Command::new("sh");
    limited.args(["-c", "ulimit -f 4; exec \"$0\" eval g.ron --out a.usda --set hair.count=500"]);
    let out = limited.arg(coif().get_program()).current_dir(folder.path("")).output().unwrap();
    let err = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(1), "{err}");
    assert!(err.contains("a.usda") && err.contains("larger") && err.contains("no hair"), "{err}");
    assert_eq!(seen(&folder), before);
}

#[test]
fn programs_that_share_a_target_do_not_tear_it() {
    let Some(folder) = prepared("shared", &[]) else { return };
    let words = |out: &str, count: u32| format!("eval g.ron --set hair.count={count} --out {out}");
    let whole: Vec<Vec<u8>> = [300, 400]
        .map(|count| {
            assert!(start(&folder, &words("one.usdc", count)).wait().unwrap().success());
            fs::read(folder.path("one.usdc")).unwrap()
        })
        .into();
    let all: Vec<Child> =
        (0..6).map(|i| start(&folder, &words("a.usdc", 300 + i % 2 * 100))).collect();
    for mut child in all {
        assert!(child.wait().unwrap().success());
    }
    assert!(whole.contains(&fs::read(folder.path("a.usdc")).unwrap()));
    assert_eq!(folder.names(), ["a.usdc", "g.ron", "head.obj", "one.usdc"]);
}
