//! Packs by the real program: they evaluate to the hash of their folder, are told before they are written, and unpack again; hostile
//! ones leave no trace.

use coif_tests::{Folder, Ran, run, shared};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A head in `heads/` of the graph's folder, a texture beside it where there is one, and hair that reads both.
fn graph(mesh: &str, picture: Option<&str>) -> String {
    let mask = picture.map_or(String::new(), |picture| {
        format!(
            "\"mask\": (kind: \"texture_mask\", inputs: {{\"file\": \"{picture}\"}}, links: {{\"scalp\": \"head.scalp\"}}),"
        )
    });
    let by = picture.map_or("", |_| ", \"mask\": \"mask.mask\"");
    format!(
        "(format: 3, nodes: {{\"head\": (kind: \"head\", inputs: {{\"mesh\": \"{mesh}\", \"fit\": \"none\"}}), {mask} \
         \"guides\": (kind: \"scatter_guides\", inputs: {{\"count\": 40}}, links: {{\"scalp\": \"head.scalp\"{by}}}), \
         \"out\": (kind: \"groom_output\", links: {{\"curves\": \"guides.curves\"}})}})"
    )
}

/// All files below a folder, by their names in it.
fn tree(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(&at).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap().display().to_string();
            all.insert(name, fs::read(&path).unwrap());
        }
    }
    all
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// The hash of each output.
fn hashes(graph: &Path, more: &[&str]) -> Vec<Json> {
    let graph = text(graph);
    let ran = run(["eval", &graph, "--report", "-"].iter().chain(more));
    assert_eq!(ran.code, 0, "{graph}: {}", ran.err);
    let report: Json = serde_json::from_str(&ran.out).unwrap();
    let outputs = report["outputs"].as_array().unwrap();
    outputs.iter().map(|output| output["hash"].clone()).collect()
}

fn template(words: &[&str]) -> Ran {
    run(["template"].iter().chain(words))
}

#[track_caller]
fn done(words: &[&str]) -> Ran {
    let ran = template(words);
    assert_eq!(ran.code, 0, "{words:?}: {}", ran.err);
    ran
}

/// A groom on a head of `../shared`, whose files are copied: its pack has its hash, holds `expected` and no more, and unpacks to
/// the same files.
fn check(test: &str, files: &[&str], mesh: &str, picture: Option<&str>, expected: &[&str]) {
    let folder = Folder::new(&format!("packs-{test}"));
    let groom = folder.path("groom");
    fs::create_dir_all(groom.join("heads")).unwrap();
    for file in files {
        let Some(from) = shared(test, file) else { return };
        fs::copy(&from, groom.join("heads").join(from.file_name().unwrap())).unwrap();
    }
    let ron = groom.join("groom.ron");
    fs::write(&ron, graph(mesh, picture)).unwrap();
    let before = tree(&groom);
    let [pack, again] = ["a.coif", "b.coif"].map(|name| folder.path(name));
    let told = done(&["pack", &text(&ron), "--dry-run"]);
    assert!(!pack.exists() && tree(&groom) == before, "a dry run writes nothing");
    let packed = done(&["pack", &text(&ron), "--out", &text(&pack)]);
    assert!(packed.out.starts_with(told.out.trim_end()), "{}", packed.out);
    let held: Vec<&str> =
        told.out.lines().filter_map(|line| line.split_once("  ")).map(|(a, _)| a).collect();
    assert_eq!(held, expected);
    done(&["pack", &text(&ron), "--out", &text(&again)]);
    assert!(fs::read(&pack).unwrap() == fs::read(&again).unwrap(), "the same bytes");
    assert_eq!(hashes(&pack, &[]), hashes(&ron, &[]));
    assert_eq!(run(["check", &text(&pack)]).code, 0);
    assert_eq!(run(["diff", &text(&pack), &text(&ron)]).out, "the same groom\n");
    let into = folder.path("new/folder");
    done(&["install", &text(&pack), "--into", &text(&into)]);
    let mut kept = before;
    kept.retain(|name, _| expected.contains(&name.as_str()));
    assert!(tree(&into) == kept, "{:?}", tree(&into).keys());
    assert_eq!(hashes(&into.join("groom.ron"), &[]), hashes(&ron, &[]));
}

#[test]
fn a_gltf_with_its_buffer_in_a_pack_has_the_hash_of_its_folder() {
    let files =
        ["data/rat/street_rat_4k.gltf", "data/rat/street_rat.bin", "data/rat/LICENCE_NOTE.txt"];
    let expected =
        ["groom.ron", "heads/LICENCE_NOTE.txt", "heads/street_rat.bin", "heads/street_rat_4k.gltf"];
    check("gltf", &files, "heads/street_rat_4k.gltf", None, &expected);
}

#[test]
fn an_obj_with_its_materials_in_a_pack_has_the_hash_of_its_folder() {
    let files = [
        "data/ict_head/generic_neutral_mesh.obj",
        "data/ict_head/ICTFaceModelMaterial.mtl",
        "data/ict_head/LICENSE",
        "data/sintel/sintel-eyes.obj",
    ];
    let expected = [
        "groom.ron",
        "heads/ICTFaceModelMaterial.mtl",
        "heads/LICENSE",
        "heads/generic_neutral_mesh.obj",
    ];
    check("obj", &files, "heads/generic_neutral_mesh.obj", None, &expected);
}

#[test]
fn a_mask_from_a_picture_in_a_pack_has_the_hash_of_its_folder() {
    let files =
        ["data/spot/spot_triangulated.obj", "data/spot/spot_texture.png", "data/spot/README.txt"];
    let expected =
        ["groom.ron", "heads/README.txt", "heads/spot_texture.png", "heads/spot_triangulated.obj"];
    check("mask", &files, "heads/spot_triangulated.obj", Some("heads/spot_texture.png"), &expected);
}

#[test]
fn what_lies_outside_the_folder_is_refused_by_name_or_collected() {
    let Some(ball) = shared("outside", "data/spot/spot_triangulated.obj") else { return };
    let folder = Folder::new("packs-outside");
    let (groom, heads) = (folder.path("groom"), folder.path("heads"));
    for folder in [&groom, &heads] {
        fs::create_dir_all(folder).unwrap();
    }
    fs::copy(&ball, heads.join("spot.obj")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(heads.join("spot.obj"), groom.join("link.obj")).unwrap();
    let absolute = text(&heads.join("spot.obj"));
    for path in ["../heads/spot.obj", &absolute, "link.obj"] {
        if !groom.join(path).exists() {
            continue;
        }
        let (ron, pack) = (groom.join("groom.ron"), folder.path("x.coif"));
        fs::write(&ron, graph(path, None)).unwrap();
        let refused = template(&["pack", &text(&ron), "--out", &text(&pack)]);
        assert_eq!(
            (refused.code, refused.err.lines().count(), pack.exists()),
            (2, 1, false),
            "{}",
            refused.err
        );
        for says in ["groom.ron: head.mesh: ", path, "copy it beside the graph", "--collect"] {
            assert!(refused.err.contains(says), "{path}: {}", refused.err);
        }
        let packed = done(&["pack", &text(&ron), "--out", &text(&pack), "--collect"]);
        assert!(
            packed.err.contains(&format!("head.mesh: {path} becomes outside/")),
            "{}",
            packed.err
        );
        assert_eq!(hashes(&pack, &[]), hashes(&ron, &[]));
        fs::remove_file(&pack).unwrap();
    }
}

#[test]
fn a_pack_is_written_over_nothing_that_it_is_made_of_and_unpacked_over_nothing() {
    let folder = Folder::new("packs-over");
    let path = |name: &str| text(&folder.path(name));
    done(&["pack", "start", "--out", &path("a.coif")]);
    for out in ["a.ron", "a"] {
        let ran = template(&["pack", "start", "--out", &path(out)]);
        assert_eq!((ran.code, ran.err.contains("packs end in .coif")), (2, true), "{}", ran.err);
    }
    fs::create_dir_all(folder.path("there")).unwrap();
    fs::write(folder.path("there/start.ron"), "mine").unwrap();
    let ran = template(&["install", &path("a.coif"), "--into", &path("there")]);
    assert_eq!((ran.code, ran.err.contains("--force")), (2, true), "{}", ran.err);
    assert_eq!(fs::read(folder.path("there/start.ron")).unwrap(), b"mine");
    done(&["install", &path("a.coif"), "--into", &path("there"), "--force"]);
    assert_ne!(fs::read(folder.path("there/start.ron")).unwrap(), b"mine");
    #[cfg(unix)]
    {
        fs::create_dir_all(folder.path("links")).unwrap();
        std::os::unix::fs::symlink(folder.path("there/start.ron"), folder.path("links/start.ron"))
            .unwrap();
        let ran = template(&["install", &path("a.coif"), "--into", &path("links"), "--force"]);
        assert_eq!((ran.code, ran.err.contains("is a link")), (2, true), "{}", ran.err);
    }
    let over = template(&["pack", "start", "--out", &path("gone/x.coif")]);
    assert_eq!(over.code, 2, "{}", over.err);
    for words in [["fmt", "a.coif"], ["merge", "a.coif"]] {
        let pack = path(words[1]);
        let words: Vec<&str> = [words[0]].into_iter().chain([pack.as_str(); 3]).collect();
        assert_eq!(run(&words).code, 2, "{words:?}");
    }
    assert_eq!(
        folder.names(),
        if cfg!(unix) { vec!["a.coif", "links", "there"] } else { vec!["a.coif", "there"] }
    );
}

#[test]
fn a_packed_template_goes_into_the_library() {
    let folder = Folder::new("packs-library");
    let (pack, library) = (text(&folder.path("t.coif")), text(&folder.path("library")));
    let told = done(&["pack", "box_braids", "--out", &pack]);
    assert!(told.out.contains("licence: MIT OR Apache-2.0"), "{}", told.out);
    done(&["install", &pack, "--to", &library]);
    assert_eq!(tree(Path::new(&library)).keys().collect::<Vec<_>>(), ["box_braids-1.0.ron"]);
    let groom = text(&folder.path("g.coif"));
    done(&["pack", "start", "--out", &groom, "--with-hash"]);
    let ran = template(&["install", &groom, "--to", &library]);
    assert_eq!((ran.code, ran.err.contains("--into FOLDER")), (2, true), "{}", ran.err);
    let said = done(&["info", &groom]).out;
    for hash in hashes(&PathBuf::from("start"), &[]) {
        assert!(said.contains(hash.as_str().unwrap()), "{said}");
    }
}

#[test]
fn a_hostile_pack_leaves_nothing_behind_whatever_opens_it() {
    let folder = Folder::new("packs-hostile");
    let path = |name: &str| text(&folder.path(name));
    let good = folder.path("good.coif");
    done(&["pack", "start", "--out", &text(&good)]);
    let zip = fs::read(&good).unwrap();
    fs::write(folder.path("cut.coif"), &zip[..zip.len() / 2]).unwrap();
    fs::write(folder.path("text.coif"), "(format: 3)").unwrap();
    let mut escapes = zip.clone();
    let name = b"start.ron";
    let found: Vec<usize> = (0..zip.len() - 9).filter(|at| zip[*at..].starts_with(name)).collect();
    found.into_iter().for_each(|at| escapes[at..at + 9].copy_from_slice(b"../st.ron"));
    fs::write(folder.path("out.coif"), escapes).unwrap();
    fs::create_dir(folder.path("folder.coif")).unwrap();
    let before = folder.names();
    for bad in ["cut.coif", "text.coif", "out.coif", "folder.coif", "gone.coif"] {
        let (bad, hair, into) = (path(bad), path("hair.usda"), path("into"));
        for words in [
            vec!["eval", &bad, "--out", &hair],
            vec!["check", &bad],
            vec!["diff", &bad, "start"],
            vec!["template", "info", &bad],
            vec!["template", "install", &bad, "--into", &into],
            vec!["template", "install", &bad, "--to", &into],
        ] {
            let ran = run(&words);
            assert_eq!((ran.code, ran.err.lines().count()), (2, 1), "{words:?}: {}", ran.err);
            assert!(ran.err.contains(&bad), "{words:?}: {}", ran.err);
            assert_eq!(folder.names(), before, "{words:?}");
        }
    }
}
