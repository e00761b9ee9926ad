//! The same bits everywhere: the content hash of a tenth of the hair of every shipped groom, every other one on one thread; in dev and in
//! release where `COIF_PROGRAM` names a release build.
//!
//! A hash changes only when hair changes. If it is meant to, `UPDATE_EXPECT=1 cargo test -p coif-tests --test grooms golden`
//! writes the new ones, and the changelog says why.

use super::shipped::tenth;
use coif_graphs::grooms;
use coif_tests::{Ran, program, run_with};
use expect_test::expect_file;
use serde_json::Value as Json;

/// What the goldens say of a groom.
fn lines_of(name: &str, report: &Json) -> String {
    let line = |output: &Json| {
        format!(
            "{name} {} {} curves {} points {}\n",
            output["group"].as_str().unwrap(),
            output["curves"],
            output["points"],
            output["hash"].as_str().unwrap()
        )
    };
    report["outputs"].as_array().unwrap().iter().map(line).collect()
}

#[test]
fn every_shipped_groom_has_its_hash() {
    let report = |name| &tenth(name, None).report;
    let lines: String = grooms::ALL.iter().map(|(name, _)| lines_of(name, report(name))).collect();
    expect_file!["../../goldens/grooms.txt"].assert_eq(&lines);
}

/// The build of these tests, on one thread, where every other one ran on two in the build that `COIF_PROGRAM` names. A tenth of the hair
/// goes the way of all of it.
#[test]
#[ignore = "every groom twice: tests/run.sh --long"]
fn one_thread_and_another_build_give_the_same_hair() {
    for (name, _) in grooms::ALL {
        let args = ["eval", name, "--quality", "preview", "--threads", "1", "--report", "-"];
        let Ran { code, out, err } = run_with(program(), args);
        assert_eq!(code, 0, "{name}: {err}");
        let report = serde_json::from_str(&out).unwrap_or_else(|err| panic!("{name}: {err}"));
        assert_eq!(lines_of(name, &report), lines_of(name, &tenth(name, None).report));
    }
}
