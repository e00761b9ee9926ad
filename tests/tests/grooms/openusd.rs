//! Written files as OpenUSD itself opens them.

use coif_graphs::grooms;
use coif_tests::{Folder, eval, lean, usd_python};
use serde_json::Value as Json;

#[test]
fn openusd_opens_every_written_file_and_finds_what_the_report_says() {
    let test = "openusd_opens_every_written_file_and_finds_what_the_report_says";
    let Some(python) = usd_python(test) else { return };
    let folder = Folder::new("openusd");
    let written: Vec<(&str, [String; 2], Json)> = grooms::ALL
        .iter()
        .map(|(name, _)| {
            let files = ["usda", "usdc"]
                .map(|extension| folder.path(&format!("{name}.{extension}")).display().to_string());
            let report =
                eval(name, &[&["--out", &files[0], "--out", &files[1]], lean(name)].concat());
            (*name, files, report)
        })
        .collect();
    let script = coif_tests::repository().join("tests/usd/validate.py");
    let files = written.iter().flat_map(|(_, files, _)| files);
    let ran = std::process::Command::new(&python).arg(&script).arg("pairs").args(files).output();
    let ran = ran.expect("Python starts");
    let text = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{text}{}", String::from_utf8_lossy(&ran.stderr));
    let found: Json = serde_json::from_str(&text).unwrap_or_else(|err| panic!("{err}: {text}"));
    for (name, files, report) in &written {
        let count = |key: &str| -> u64 {
            report["outputs"].as_array().unwrap().iter().map(|o| o[key].as_u64().unwrap()).sum()
        };
        for file in files {
            let prims = found[file]["curves"].as_object().unwrap();
            let sum = |array: &str| -> u64 {
                prims.values().map(|prim| prim[array]["count"].as_u64().unwrap()).sum()
            };
            assert_eq!(sum("counts"), count("curves"), "{name}: {file}");
            assert_eq!(sum("points"), count("points"), "{name}: {file}");
        }
    }
}
