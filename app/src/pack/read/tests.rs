//! Packs that somebody broke or made to do harm: each is refused in one line and with little work.

use super::*;
use crate::waiting::ends;
use crate::work::count;
use serde_json::{Value as Json, json};
use std::fs;
use std::io::Write;
use std::sync::atomic::{AtomicU32, Ordering};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const GRAPH: &str =
    r#"(format: 3, nodes: {"head": (kind: "head", inputs: {"mesh": "heads/face.obj"})})"#;
const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder for one test.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let n = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path =
            std::env::temp_dir().join(format!("coif-pack-{test}-{}-{n}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Files of a pack, and what its manifest says of them.
struct Made {
    files: Vec<(String, Vec<u8>)>,
    manifest: Json,
    deflated: bool,
}

fn hash(bytes: &[u8]) -> String {
    let mut hash = Hash::new();
    hash.add(bytes);
    hash.text()
}

impl Made {
    /// A graph with these files beside it.
    fn of(graph: &str, files: &[(&str, &[u8])]) -> Self {
        let all = [("groom.ron", graph.as_bytes())].into_iter().chain(files.iter().copied());
        let files: Vec<(String, Vec<u8>)> =
            all.map(|(name, bytes)| (name.to_owned(), bytes.to_vec())).collect();
        let of = |(name, bytes): &(String, Vec<u8>)| json!({"path": name, "size": bytes.len(), "hash": hash(bytes)});
        let list: Vec<Json> = files.iter().map(of).collect();
        let manifest = json!({"format": 1, "program": "test", "graph": "groom.ron", "files": list});
        Self { files, manifest, deflated: false }
    }

    fn good() -> Self {
        Self::of(GRAPH, &[("heads/face.obj", MESH.as_bytes()), ("heads/skin.png", b"png")])
    }

    fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// As a zip, with the manifest first where there is one.
    fn zip(&self) -> Vec<u8> {
        let method = match self.deflated {
            true => CompressionMethod::Deflated,
            false => CompressionMethod::Stored,
        };
        let options =
            SimpleFileOptions::default().compression_method(method).unix_permissions(0o644);
        let mut zip = ZipWriter::new(std::io::Cursor::new(vec![]));
        let text = self.manifest.as_str().map_or(self.manifest.to_string(), ToOwned::to_owned);
        let manifest = (MANIFEST.to_owned(), text.into_bytes());
        let all = Some(&manifest).filter(|_| !self.manifest.is_null());
        for (name, bytes) in all.into_iter().chain(&self.files) {
            match name.strip_prefix("link:") {
                Some(name) => {
                    zip.add_symlink(name, String::from_utf8_lossy(bytes), options).unwrap()
                }
                None if name.ends_with('/') => zip.add_directory(name.as_str(), options).unwrap(),
                None => {
                    zip.start_file(name.as_str(), options).unwrap();
                    zip.write_all(bytes).unwrap();
                }
            }
        }
        zip.finish().unwrap().into_inner()
    }
}

/// Where the nth header of a kind begins: `PK\3\4` of files, `PK\1\2` of the list.
fn header(zip: &[u8], kind: u8, n: usize) -> usize {
    let mark = [b'P', b'K', kind, kind + 1];
    let found = zip.windows(4).enumerate().filter(|(_, at)| *at == mark);
    found.map(|(at, _)| at).nth(n).unwrap()
}

/// Sets bytes of the nth file in its own header and in the list, at these places of each.
fn patch(zip: &mut [u8], n: usize, places: [usize; 2], bytes: &[u8]) {
    let at = [header(zip, 3, n) + places[0], header(zip, 1, n) + places[1]];
    at.into_iter().for_each(|at| zip[at..at + bytes.len()].copy_from_slice(bytes));
}

/// Puts another text of the same length in the place of one, everywhere.
fn replaced(mut zip: Vec<u8>, from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let found: Vec<usize> = zip
        .windows(from.len())
        .enumerate()
        .filter(|(_, at)| *at == from.as_bytes())
        .map(|(at, _)| at)
        .collect();
    assert!(!found.is_empty(), "{from}");
    found.into_iter().for_each(|at| zip[at..at + to.len()].copy_from_slice(to.as_bytes()));
    zip
}

/// Memory that no pack takes that is refused, and times that it is asked for.
const MOST_HELD: u64 = 4 << 20;
const MOST_ASKED: u64 = 2_000;

/// The pack at a path is refused with one line that names it and says `says`, and with little work.
#[track_caller]
fn refused(path: &Path, says: &str) {
    let (opened, work) = ends(says, || count(|| Pack::open(path, false)));
    let Err(said) = opened else { panic!("{says}: was opened") };
    assert!(said.starts_with(&path.display().to_string()), "{says}: {said}");
    assert!(said.contains(says) && said.lines().count() == 1, "{says}: {said}");
    assert!(work.held < MOST_HELD && work.asked < MOST_ASKED, "{says}: {work:?}");
}

#[track_caller]
fn check(says: &str, zip: &[u8]) {
    let folder = Folder::new("hostile");
    let path = folder.0.join("x.coif");
    fs::write(&path, zip).unwrap();
    refused(&path, says);
}

#[test]
fn a_whole_pack_is_opened_and_gives_its_files() {
    let folder = Folder::new("good");
    let path = folder.0.join("x.coif");
    for deflated in [false, true] {
        fs::write(&path, Made::good().with(|it| it.deflated = deflated).zip()).unwrap();
        let pack = Pack::open(&path, false).unwrap_or_else(|why| panic!("{why}"));
        assert_eq!(pack.read("heads/face.obj", 99).unwrap(), MESH.as_bytes());
        assert!(pack.read("heads/face.obj", 9).is_err() && pack.read("heads/gone", 9).is_err());
    }
}

#[test]
fn names_that_lead_elsewhere_are_refused() {
    for (name, says) in [
        ("../ds/skin.png", "leads out of the folder"),
        ("heads/../../a1", "leads out of the folder"),
        ("/eads/skin.png", "begins at the root"),
        ("C:/ds/skin.png", "not every system"),
        ("heads\\skin.png", "backslash"),
        ("heads/ski\0.png", "not every system"),
        ("heads/aux.pngs", "device"),
        ("heads/skin.pn.", "ends with a dot"),
        ("heads//kin.png", "empty part"),
        ("heads/\u{202e}n.png", "reads as another name"),
    ] {
        check(says, &replaced(Made::good().zip(), "heads/skin.png", name));
    }
    let twice = Made::of(GRAPH, &[("heads/face.obj", MESH.as_bytes()), ("heads/facf.obj", b"")]);
    check("twice", &replaced(twice.zip(), "heads/facf.obj", "heads/face.obj"));
    let cases = Made::of(GRAPH, &[("heads/face.obj", MESH.as_bytes()), ("Heads/face.obj", b"")]);
    check("where case does not count", &cases.zip());
    let twins = [("heads/\u{e9}.obj", MESH.as_bytes()), ("heads/e\u{301}.obj", b"")];
    check("on macOS", &Made::of(GRAPH, &twins).zip());
    let within = Made::of(GRAPH, &[("heads/face.obj", MESH.as_bytes()), ("heads", b"")]);
    check("which is a file", &within.zip());
    let link = Made::good().with(|it| it.files.push(("link:heads/a".to_owned(), b"/etc".to_vec())));
    check("is a link", &link.zip());
    let folder = Made::good().with(|it| it.files.push(("more/".to_owned(), vec![])));
    check("a folder", &folder.zip());
}

#[test]
fn a_pack_holds_what_its_manifest_says_and_nothing_else() {
    let says = |says: &str, change: &dyn Fn(&mut Made)| {
        check(says, &Made::good().with(|it| change(it)).zip())
    };
    says("has the hash", &|it| it.manifest["files"][1]["hash"] = json!("0".repeat(32)));
    says("its manifest says 9", &|it| it.manifest["files"][1]["size"] = json!(9));
    says("is named in the manifest once more", &|it| drop(it.files.pop()));
    says("is not named in the manifest", &|it| it.files.push(("more.png".to_owned(), vec![1])));
    says("is not named in the manifest", &|it| {
        it.manifest["files"].as_array_mut().unwrap().pop();
    });
    says("once more", &|it| {
        let first = it.manifest["files"][1].clone();
        it.manifest["files"].as_array_mut().unwrap().push(first);
    });
    says("is the graph by the manifest", &|it| it.manifest["graph"] = json!("other.ron"));
    says("does not come first", &|it| it.manifest = Json::Null);
    says("expected value", &|it| it.manifest = json!("(graph: 1)"));
    says("EOF while parsing", &|it| {
        it.manifest = json!(format!("{{\"format\":1,\"graph\":{}", "[".repeat(100_000)))
    });
    says("unknown field", &|it| it.manifest["more"] = json!(1));
    says("take a newer coif", &|it| it.manifest["format"] = json!(2));
    says("duplicate field", &|it| {
        let text = it.manifest.to_string();
        it.manifest = json!(text.replacen('{', "{\"graph\":\"a.ron\",", 1));
    });
    let second = |name: &str, bytes: &[u8]| {
        Made::of(GRAPH, &[("heads/face.obj", MESH.as_bytes()), (name, bytes)]).zip()
    };
    check("a second graph", &second("heads/b.ron", GRAPH.as_bytes()));
    check("a pack in a pack", &second("heads/b.coif", &Made::good().zip()));
    check("a pack in a pack", &second("b.zip", b""));
}

#[test]
fn a_zip_that_lies_of_itself_is_refused() {
    let good = Made::good().zip();
    let changed = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut zip = good.clone();
        change(&mut zip);
        zip
    };
    let end = good.len() - 22;
    // The graph's flags.
    check("is encrypted", &changed(&|zip| patch(zip, 1, [6, 8], &[1, 0])));
    check("neither stored nor deflated", &changed(&|zip| patch(zip, 1, [8, 10], &[12, 0])));
    check(
        "coif-pack.json: is larger than 4 MiB",
        &changed(&|zip| patch(zip, 0, [22, 24], &[0xf0, 255, 255, 255])),
    );
    check(
        "holds 65535 files",
        &changed(&|zip| {
            zip[end + 8..end + 12].fill(255);
        }),
    );
    check("is no whole pack", &changed(&|zip| zip.push(0)));
    check(
        "is no whole pack",
        &changed(&|zip| {
            zip.truncate(end);
            zip.extend(b"PK\x05\x06\0\0\0\0\x04\0\x04\0\xff\xff\xff\xff\xff\xff\xff\xff\0\0");
        }),
    );
    // The list says that the second file lies where the first does.
    check(
        "does not begin where the file before it ends",
        &changed(&|zip| {
            let list = header(zip, 1, 1) + 42;
            zip[list..list + 4].fill(0);
        }),
    );
    check(
        "something hides",
        &changed(&|zip| {
            let list = header(zip, 1, 0);
            zip.splice(list..list, *b"hidden!!");
            let at = zip.len() - 22 + 16;
            let start = u32::try_from(list + 8).unwrap();
            zip[at..at + 4].copy_from_slice(&start.to_le_bytes());
        }),
    );
    for n in 0..32 {
        check("", &good[..good.len() * n / 32]);
    }
    check("is no pack", b"");
    check("is no pack", GRAPH.as_bytes());
    check("is no whole pack", b"PK\x03\x04");
    check("is no whole pack", &[&b"PK\x03\x04"[..], &[0; 4096]].concat());
}

#[test]
fn what_unpacks_to_very_much_is_refused_before_it_does() {
    let zeros = vec![0; 70 << 20];
    let bomb = Made::of(GRAPH, &[("heads/face.obj", MESH.as_bytes()), ("a.png", &zeros)])
        .with(|it| it.deflated = true);
    check("--allow-large", &bomb.zip());
    // Every size says 9, and 70 MiB come.
    let mut lies = bomb.with(|it| it.manifest["files"][2]["size"] = json!(9)).zip();
    patch(&mut lies, 3, [22, 24], &[9, 0, 0, 0]);
    check("a.png: is damaged: File is larger than its declared", &lies);
    let blank = format!("{GRAPH}{}", " ".repeat(2 << 20));
    let graph = Made::of(&blank, &[("heads/face.obj", MESH.as_bytes())]);
    check("groom.ron: unpacks to 2 MiB", &graph.with(|it| it.deflated = true).zip());
    let many: Vec<(String, Vec<u8>)> =
        (0..MOST_FILES).map(|n| (format!("{n}.png"), vec![])).collect();
    check("packs hold 4096 at most", &Made::good().with(|it| it.files.extend(many)).zip());
    let vast = Made::good().with(|it| it.manifest["files"][1]["size"] = json!(u64::MAX));
    check("its manifest says", &vast.zip());
}

#[test]
fn a_graph_that_is_none_or_names_what_is_not_in_the_pack_is_refused() {
    let of = |graph: &str| Made::of(graph, &[("heads/face.obj", MESH.as_bytes())]).zip();
    let named = |path: &str| of(&GRAPH.replace("heads/face.obj", path));
    for path in
        ["/etc/passwd", "../x.obj", "heads/../../x.obj", "heads/gone.obj", "/heads/face.obj"]
    {
        check("is not in the pack", &named(path));
    }
    check("groom.ron:1:", &of("(format: 3, nodes: {"));
    let deep =
        format!("(format: 3, nodes: {{{}", "\"a\": (kind: \"group\", nodes: {".repeat(10_000));
    check("groom.ron:1:", &of(&deep));
    let closed = format!("{deep}{}}})", "})".repeat(10_000));
    check("groom.ron:1:", &of(&closed));
    // By a port of a group, and by its default.
    let port = |set: &str, default: &str| {
        of(&format!(
            "(format: 3, nodes: {{\"p\": (kind: \"parameters\", interface: (inputs: [(name: \"scan\", type: \"file\"{default})]), \
             inputs: {{{set}}})}})"
        ))
    };
    check("p.scan: /etc/passwd is not in the pack", &port("\"scan\": \"/etc/passwd\"", ""));
    check("p.scan: /etc/passwd is not in the pack", &port("", ", default: \"/etc/passwd\""));
}

#[test]
fn what_is_no_file_is_not_read() {
    let folder = Folder::new("none");
    refused(&folder.0.join("gone.coif"), "no such file");
    fs::create_dir(folder.0.join("folder.coif")).unwrap();
    refused(&folder.0.join("folder.coif"), "is not a file");
    #[cfg(unix)]
    {
        let pipe = folder.0.join("pipe.coif");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|made| made.success()) {
            refused(&pipe, "is not a file");
        }
    }
}

#[test]
fn a_pack_of_which_any_byte_is_changed_is_refused_or_gives_the_same_files() {
    let folder = Folder::new("changed");
    let path = folder.0.join("x.coif");
    let good = Made::good().with(|it| it.deflated = true).zip();
    let mut random = 1_u64;
    let mut next = |most: usize| {
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % most
    };
    let mut opened = 0;
    for _ in 0..3000 {
        let mut zip = good.clone();
        for _ in 0..=next(3) {
            let at = next(zip.len());
            zip[at] = next(256) as u8;
        }
        fs::write(&path, &zip).unwrap();
        match Pack::open(&path, false) {
            Ok(pack) => {
                opened += 1;
                assert_eq!(pack.text, GRAPH.as_bytes());
                assert_eq!(pack.read("heads/face.obj", 99).unwrap(), MESH.as_bytes());
            }
            Err(said) => assert_eq!(said.lines().count(), 1, "{said}"),
        }
    }
    // Times and the like mean nothing.
    assert!(opened < 600, "{opened}");
}

#[test]
fn a_pack_that_changes_after_it_was_opened_is_found_out() {
    let folder = Folder::new("later");
    let path = folder.0.join("x.coif");
    let mut zip = Made::good().zip();
    fs::write(&path, &zip).unwrap();
    let pack = Pack::open(&path, false).unwrap();
    let at = zip.windows(5).position(|at| at == b"v 1 0").unwrap();
    zip[at + 2] = b'2';
    // In place: the pack has it open.
    fs::write(&path, &zip).unwrap();
    let said = pack.read("heads/face.obj", 99).unwrap_err();
    assert!(said.contains("damaged") || said.contains("hash"), "{said}");
}
