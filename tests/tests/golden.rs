//! The same bits everywhere: the content hash of every shipped groom, for any number of threads, in dev and in release.
//!
//! A hash changes only when hair changes. If it is meant to, `UPDATE_EXPECT=1 cargo test -p coif-tests --test golden`
//! writes the new ones, and the changelog says why.

use coif_graphs::grooms;
use coif_tests::{eval, lean};
use expect_test::expect_file;

#[test]
fn every_shipped_groom_has_its_hash() {
    let mut lines = String::new();
    for (name, _) in grooms::ALL {
        let report = eval(name, &["--threads", "2"]);
        for output in report["outputs"].as_array().unwrap() {
            lines += &format!(
                "{name} {} {} curves {} points {}\n",
                output["group"].as_str().unwrap(),
                output["curves"],
                output["points"],
                output["hash"].as_str().unwrap()
            );
        }
    }
    expect_file!["../goldens/grooms.txt"].assert_eq(&lines);
}

#[test]
fn one_thread_gives_the_same_hair_as_two() {
    for (name, _) in grooms::ALL {
        let hashes = |threads: &str| {
            let report = eval(name, &[&["--threads", threads], lean(name)].concat());
            let outputs = report["outputs"].as_array().unwrap().clone();
            outputs.iter().map(|o| o["hash"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(hashes("1"), hashes("2"), "{name}");
    }
}
