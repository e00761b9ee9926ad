//! Every shipped document as it stands; and the grooms that are no heroes, on the built-in head and on real ones: each evaluates,
//! and sits where it should.

use super::shipped::{Shipped, evaluate, shipped};
use coif_graphs::document::graph::check;
use coif_graphs::{file, grooms};
use coif_tests::{one_of, smooth_heads};
use expect_test::expect_file;
use serde_json::Value as Json;

/// Where a document is not as coif writes it, `UPDATE_EXPECT=1` writes it so.
#[test]
fn every_shipped_document_reads_checks_and_writes_back_unchanged() {
    for (folder, all) in [("grooms", grooms::ALL), ("templates", grooms::TEMPLATES)] {
        for (name, text) in all {
            let loaded = file::read(text).unwrap_or_else(|err| panic!("{name}.ron:{err}"));
            assert_eq!(loaded.warnings, [], "{name}");
            assert_eq!(check(&loaded.document), [], "{name}");
            let on_disk = coif_tests::repository().join(format!("graphs/{folder}/{name}.ron"));
            expect_file![on_disk].assert_eq(&file::write(&loaded.document));
        }
    }
}

/// What every groom keeps, beside what heroes do, and how much of its hair may be left out or too deep at most.
#[track_caller]
fn check_on(name: &str, on: &str, shipped: &Shipped, most_astray: f64) {
    let report = &shipped.report;
    assert!(
        report["outputs"].as_array().unwrap().iter().all(|o| o["curves"].as_u64().unwrap() > 0)
    );
    let all: f64 = shipped.hair().iter().filter_map(|prim| prim["curves"].as_f64()).sum();
    let too_many = |warning: &str| {
        let mut words = warning.split(|c: char| !c.is_ascii_alphanumeric());
        let count = words.find_map(|word| word.parse::<u32>().ok());
        warning.contains("left out") && f64::from(count.unwrap_or(1)) > all * most_astray
    };
    let warnings = report["warnings"].as_array().unwrap().iter().filter_map(Json::as_str);
    let failed: Vec<&str> = warnings.filter(|warning| too_many(warning)).collect();
    assert!(failed.is_empty(), "{name} on {on}: {failed:?}");
    for prim in &shipped.prims {
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
            // This bust is an open shell that ends above the tips: hair that falls over its rim is led into it or out of it.
            let over_the_rim = on == "ict_head" && name.ends_with("long_straight.ron");
            let deep = prim["scalp"]["too_deep"].as_f64().unwrap_or(all);
            let few = deep <= all * most_astray || over_the_rim;
            assert!(
                *holds != Json::Bool(false)
                    || (in_the_air && law.starts_with("roots"))
                    || (few && law.starts_with("nothing is deeper")),
                "{name} on {on}: {law} is broken\n{prim:#}"
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
    light().for_each(|name| check_on(name, "the built-in head", shipped(name), 0.0));
}

/// As for heroes, a tenth of the hair stands for all, and each groom sits on one head.
#[test]
fn every_groom_sits_on_real_heads() {
    let heads: Vec<_> = smooth_heads("every_groom_sits_on_real_heads").collect();
    for (i, name) in light().enumerate() {
        for head in one_of(&heads, i) {
            let tenth = evaluate(name, Some(head), &["--quality", "preview"]);
            // Export may leave out one hair in a thousand.
            check_on(name, head.name, &tenth, 0.001);
        }
    }
}

#[test]
#[ignore = "minutes in release"]
fn every_groom_sits_on_real_heads_with_all_its_hair() {
    for head in smooth_heads("every_groom_sits_on_real_heads_with_all_its_hair") {
        light().for_each(|name| check_on(name, head.name, &evaluate(name, Some(&head), &[]), 0.0));
    }
}

/// Templates of loose hair, which recipes are made of.
#[test]
fn loose_hair_sits_on_the_built_in_head_and_on_real_ones() {
    let loose = [
        "long_straight",
        "bob",
        "waves",
        "fringe",
        "pony_tail",
        "puff",
        "afro",
        "short_back_and_sides",
    ];
    let names = loose.map(template);
    let heads: Vec<_> =
        smooth_heads("loose_hair_sits_on_the_built_in_head_and_on_real_ones").collect();
    let preview = ["--quality", "preview"];
    for (i, name) in names.iter().enumerate() {
        check_on(name, "the built-in head", &evaluate(name, None, &preview), 0.005);
        one_of(&heads, i).for_each(|head| {
            check_on(name, head.name, &evaluate(name, Some(head), &preview), 0.005)
        });
    }
}

fn template(name: &str) -> String {
    coif_tests::repository().join(format!("graphs/templates/{name}.ron")).display().to_string()
}
