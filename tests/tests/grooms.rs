//! Every shipped groom, on the built-in head and on real ones: it evaluates, and sits where it should.

use coif_graphs::document::graph::check;
use coif_graphs::{file, grooms};
use coif_tests::{Folder, RealHead, eval, lean, run, smooth_heads, usd_python};
use expect_test::expect_file;
use serde_json::Value as Json;

/// Where a document is not as coif writes it, `UPDATE_EXPECT=1` writes it so.
#[test]
fn every_shipped_document_reads_checks_and_writes_back_unchanged() {
    for (name, text) in grooms::ALL {
        let loaded = file::read(text).unwrap_or_else(|err| panic!("{name}.ron:{err}"));
        assert_eq!(loaded.warnings, [], "{name}");
        assert_eq!(check(&loaded.document), [], "{name}");
        let on_disk = coif_tests::repository().join(format!("graphs/grooms/{name}.ron"));
        expect_file![on_disk].assert_eq(&file::write(&loaded.document));
    }
}

/// Evaluates a groom, and measures what was written against the head it stands on.
#[track_caller]
fn check_on(name: &str, head: Option<&RealHead>) {
    let folder = Folder::new(&format!("groom-{name}-{}", head.is_some()));
    let file = folder.path("groom.usdc");
    let out = file.display().to_string();
    let mesh = head.map(|head| head.mesh.clone());
    let mut more = vec!["--out", &out];
    more.extend(head.iter().flat_map(|head| head.eval_args()));
    let report = eval(name, &more);
    assert!(
        report["outputs"].as_array().unwrap().iter().all(|o| o["curves"].as_u64().unwrap() > 0)
    );
    let failed: Vec<&str> = report["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Json::as_str)
        .filter(|w| w.contains("left out"))
        .collect();
    assert!(failed.is_empty(), "{name} {mesh:?}: {failed:?}");
    let mut args = vec!["measure".to_owned(), out.clone(), "--json".to_owned()];
    if let Some(mesh) = &mesh {
        args.extend(["--scalp".to_owned(), mesh.clone()]);
    }
    let measured = run(&args);
    assert_eq!(measured.code, 0, "{}", measured.err);
    let measured: Json = serde_json::from_str(&measured.out).unwrap();
    for prim in measured.as_array().unwrap() {
        for law in [
            "every curve has two points and a length",
            "ids do not repeat",
            "strands of a braid do not overlap",
            "roots lie on the scalp to 0.001 cm",
            "nothing is deeper under the skin than allowed",
        ] {
            let holds = &prim["laws"][law];
            // Free braids and sample rows hang in the air by design; they have no roots on the scalp.
            let in_the_air = prim["path"].as_str().unwrap().contains("free");
            assert!(
                *holds != Json::Bool(false) || (in_the_air && law.starts_with("roots")),
                "{name} on {mesh:?}: {law} is broken\n{prim:#}"
            );
        }
    }
}

/// All grooms but heroes, which `hero.rs` judges.
fn light() -> impl Iterator<Item = &'static str> {
    grooms::ALL.iter().map(|(name, _)| *name).filter(|name| !grooms::HEROES.contains(name))
}

#[test]
fn every_groom_evaluates_on_the_built_in_head() {
    light().for_each(|name| check_on(name, None));
}

#[test]
fn every_groom_sits_on_real_heads() {
    for head in smooth_heads("every_groom_sits_on_real_heads") {
        light().for_each(|name| check_on(name, Some(&head)));
    }
}

#[test]
fn openusd_opens_every_written_file_and_finds_what_the_report_says() {
    let test = "openusd_opens_every_written_file_and_finds_what_the_report_says";
    let Some(python) = usd_python(test) else { return };
    let folder = Folder::new("openusd");
    for (name, _) in grooms::ALL {
        let (usda, usdc) =
            (folder.path(&format!("{name}.usda")), folder.path(&format!("{name}.usdc")));
        let (a, b) = (usda.display().to_string(), usdc.display().to_string());
        let report = eval(name, &[&["--out", &a, "--out", &b], lean(name)].concat());
        let script = coif_tests::repository().join("tests/usd/validate.py");
        let judge = |what: &str| {
            std::process::Command::new(&python).arg(&script).args([what, &a, &b]).output().unwrap()
        };
        let ran = judge("report");
        let text = String::from_utf8_lossy(&ran.stdout);
        assert!(ran.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&ran.stderr));
        let same = judge("equal");
        assert!(same.status.success(), "{name}: {}", String::from_utf8_lossy(&same.stderr));
        let files: Json = serde_json::from_str(&text).unwrap_or_else(|err| panic!("{err}: {text}"));
        let count = |key: &str| -> u64 {
            report["outputs"].as_array().unwrap().iter().map(|o| o[key].as_u64().unwrap()).sum()
        };
        let found = |array: &str| -> u64 {
            let files = files.as_object().unwrap().values();
            let prims = files.flat_map(|file| file["curves"].as_object().unwrap().values());
            prims.map(|prim| prim[array]["count"].as_u64().unwrap()).sum()
        };
        assert_eq!(found("counts"), 2 * count("curves"), "{name}: {text}");
        assert_eq!(found("points"), 2 * count("points"), "{name}: {text}");
    }
}
