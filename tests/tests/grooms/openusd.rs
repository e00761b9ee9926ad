//! Written files as OpenUSD itself opens them.

use super::shipped::{Shipped, tenth};
use coif_graphs::grooms;
use coif_tests::long::is_long;
use coif_tests::usd_python;
use serde_json::Value as Json;

/// Of all grooms where `COIF_LONG` is set, else of every second one: nodes and attributes come in several.
#[test]
fn openusd_opens_every_written_file_and_finds_what_the_report_says() {
    let test = "openusd_opens_every_written_file_and_finds_what_the_report_says";
    let Some(python) = usd_python(test) else { return };
    let every = if is_long() { 1 } else { 2 };
    let some = grooms::ALL.iter().step_by(every);
    let written: Vec<(&str, &Shipped)> = some.map(|(name, _)| (*name, tenth(name, None))).collect();
    let script = coif_tests::repository().join("tests/usd/validate.py");
    // What each of the files holds; of two of one groom, whether they hold the same.
    let opened = |how: &str, count: usize| -> Json {
        let files = written.iter().map(|(_, tenth)| &tenth.files);
        let files = files.filter(|files| files.len() == count).flatten();
        let ran = std::process::Command::new(&python).arg(&script).arg(how).args(files).output();
        let ran = ran.expect("Python starts");
        let text = String::from_utf8_lossy(&ran.stdout);
        assert!(ran.status.success(), "{text}{}", String::from_utf8_lossy(&ran.stderr));
        serde_json::from_str(&text).unwrap_or_else(|err| panic!("{err}: {text}"))
    };
    // By the number of files that a groom has.
    let found = [opened("report", 1), opened("pairs", 2)];
    for (name, Shipped { report, files, .. }) in &written {
        let count = |key: &str| -> u64 {
            report["outputs"].as_array().unwrap().iter().map(|o| o[key].as_u64().unwrap()).sum()
        };
        for file in files {
            let prims = found[files.len() - 1][file]["curves"].as_object().unwrap();
            let sum = |array: &str| -> u64 {
                prims.values().map(|prim| prim[array]["count"].as_u64().unwrap()).sum()
            };
            assert_eq!(sum("counts"), count("curves"), "{name}: {file}");
            assert_eq!(sum("points"), count("points"), "{name}: {file}");
        }
    }
}
