//! The hero grooms, each evaluated to a file and judged by `coif measure` on that file alone.
//!
//! [`HEROES`] says what must be found in each. Every shipped hero is judged by what all of them promise, whether it has a line
//! there or not; a line whose groom is not shipped is told. On the real heads a tenth of the hair stands for all, and each
//! hero sits on one of them; the ignored test judges all of it on every head (`tests/run.sh --long`, minutes).

use super::shipped::{Shipped, all_hair, evaluate, shipped, tenth};
use coif_graphs::grooms;
use coif_tests::{Folder, one_of, real_heads};
use serde_json::Value as Json;

/// What a groom's file must show, beside what all must.
enum Ask {
    /// At least so many braids of so many strands, all crossing this way.
    Braids { at_least: u64, strands: u64, crossing: &'static str },
    /// Hair joins at the stitches of braids, none fails to.
    Joins,
    /// At least so many partings, which no hair crosses.
    Partings(u64),
    /// Hair in at least so many sections.
    Sections(u64),
    /// No hair that belongs to no section.
    AllInSections,
    /// So many puffs with a clean outline.
    Puffs(u64),
    /// At least this share of all hair held by so many ties, all passing them, half of it hanging at least so many cm behind.
    Tied { ties: u64, share: f64, behind_cm: f64 },
    /// Curls as wide, as steep and as much shrunk as was asked.
    Curls,
}

const HEROES: &[(&str, &[Ask])] = &[
    (
        "cornrows_gathered",
        &[
            Ask::Braids { at_least: 24, strands: 3, crossing: "under" },
            Ask::Joins,
            Ask::Partings(24),
            Ask::Sections(24),
            Ask::AllInSections,
            Ask::Puffs(1),
            Ask::Curls,
        ],
    ),
    (
        "cornrows_puffs",
        &[
            Ask::Braids { at_least: 14, strands: 3, crossing: "under" },
            Ask::Joins,
            Ask::Partings(15),
            Ask::Sections(16),
            Ask::AllInSections,
            Ask::Puffs(2),
            Ask::Curls,
        ],
    ),
    (
        "box_braids",
        &[
            Ask::Braids { at_least: 60, strands: 3, crossing: "over" },
            Ask::Joins,
            Ask::Partings(60),
            Ask::Sections(60),
            Ask::AllInSections,
        ],
    ),
    ("afro_4c", &[Ask::Curls]),
    ("finger_coils", &[Ask::Curls]),
    ("waves_2b", &[Ask::Partings(1), Ask::AllInSections, Ask::Curls]),
    ("ponytail", &[Ask::Tied { ties: 1, share: 0.8, behind_cm: 20.0 }]),
    ("french_braid", &[Ask::Braids { at_least: 1, strands: 3, crossing: "over" }, Ask::Joins]),
    (
        "dutch_braids",
        &[
            Ask::Braids { at_least: 2, strands: 3, crossing: "under" },
            Ask::Joins,
            Ask::Partings(1),
            Ask::Sections(2),
            Ask::AllInSections,
        ],
    ),
    (
        "twists",
        &[
            Ask::Braids { at_least: 120, strands: 2, crossing: "either" },
            Ask::Joins,
            Ask::Partings(120),
            Ask::Sections(120),
            Ask::AllInSections,
        ],
    ),
];

/// What every hero keeps. A law that no prim is judged by is not kept. That the strands of a braid do not overlap is judged of
/// its tubes (`light.rs`), not of the hair that fills them.
const LAWS: &[&str] = &[
    "every curve has two points and a length",
    READINGS,
    "ids do not repeat",
    "a strand has at most 255 points",
    "all hair has at most 16 million points",
    "roots lie on the scalp to 0.001 cm",
    DEPTH,
];
/// What heroes do not keep yet, law by law: `groom` on the built-in head, `groom on head` on others. A law that has come to hold of all
/// their hair is taken off this list: the test says so.
///
/// One hair in 7,000 of the twists hangs over the rim of that open bust and into it from below. As it is drawn, one hair of each of
/// these leads over a line on its way to its braid.
const NOT_YET: &[(&str, &[&str])] = &[
    ("box_braids", &[CROSSING]),
    ("box_braids on sintel", &[CROSSING]),
    ("twists on ict_head", &[DEPTH, CROSSING]),
];
pub(super) const READINGS: &str = "both readings of every curve agree to 0.001 cm";
pub(super) const WOVEN: &str = "braids are woven all along as they begin";
const OUTLINES: &str = "outlines of puffs are as clean as asked";
const TIED: &str = "hair passes its tie";
pub(super) const DEPTH: &str = "nothing is deeper under the skin than allowed";
pub(super) const CROSSING: &str = "no hair crosses a parting";
const ROOTED: &str = "no hair is rooted in a parting";
const DIAMETERS: &str = "curl diameters are as asked to 5 %";
const PITCHES: &str = "curl pitches are as asked to 5 %";
const SHRINKAGE: &str = "shrinkage is as told to 5 %";

/// Of these a tenth of the hair tells enough.
const OF_ANY_HAIR: &[&str] = &[
    "every curve has two points and a length",
    "ids do not repeat",
    "a strand has at most 255 points",
    "roots lie on the scalp to 0.001 cm",
    DEPTH,
];
/// Strands of a hero.
const STRANDS: std::ops::RangeInclusive<u64> = 60_000..=150_000;

/// What a list says that a groom does not keep yet.
fn not_yet(list: &[(&str, &'static [&'static str])], name: &str) -> &'static [&'static str] {
    list.iter().find(|(known, _)| *known == name).map_or(&[], |(_, laws)| laws)
}

/// Tells of the laws that a prim does not keep, but for those that the groom does `not_yet`, and of those that it does.
fn check_laws(
    name: &str,
    prims: &[Json],
    laws: &[&str],
    not_yet: &[&str],
    wrong: &mut Vec<String>,
) {
    for law in laws {
        let broken = prims.iter().find(|prim| prim["laws"][law] == false);
        if prims.iter().all(|prim| prim["laws"][law].is_null()) {
            wrong.push(format!("{name}: nothing is judged by: {law}"));
        }
        match (broken, not_yet.contains(law)) {
            (Some(prim), false) => wrong.push(format!("{name}: {law} is broken\n{prim:#}")),
            (None, true) if all_hair() => {
                wrong.push(format!("{name}: {law} holds; take it off the list"))
            }
            _ => {}
        }
    }
}

/// What all prims have under a name, where they have it.
fn found<'j>(prims: &'j [Json], name: &'j str) -> impl Iterator<Item = &'j Json> {
    prims.iter().map(move |prim| &prim[name]).filter(|found| !found.is_null())
}

fn asks_of(name: &str) -> &'static [Ask] {
    HEROES.iter().find(|(known, _)| *known == name).map_or(&[], |(_, asks)| asks)
}

/// Laws by which a tenth of the hair is not judged.
fn of_all_hair<'l>(laws: &'l [&'l str]) -> &'l [&'l str] {
    if all_hair() { laws } else { &[] }
}

/// Tells where a groom does not show what is asked of it.
fn check_ask(name: &str, prims: &[Json], ask: &Ask, wrong: &mut Vec<String>) {
    let mut must = |holds: bool, found: &dyn std::fmt::Display| {
        if !holds {
            wrong.push(format!("{name}: {found}"));
        }
    };
    let sum = |of: &str, key: &str| found(prims, of).filter_map(|f| f[key].as_u64()).sum::<u64>();
    match ask {
        Ask::Braids { at_least, strands, crossing } => {
            let mut braids = 0;
            for kind in found(prims, "braids").flat_map(|b| b["kinds"].as_array().unwrap()) {
                let as_asked = kind["strands"] == *strands && kind["crossing"] == *crossing;
                // A strand of few hairs does not always show how it is woven.
                must(as_asked || !all_hair(), kind);
                braids += if as_asked { kind["braids"].as_u64().unwrap() } else { 0 };
            }
            must(braids >= *at_least, &format_args!("{braids} braids"));
            check_laws(name, prims, of_all_hair(&[WOVEN]), not_yet(NOT_YET, name), wrong);
        }
        Ask::Joins => {
            let joined: Vec<&Json> =
                found(prims, "braids").map(|b| &b["joined"]).filter(|j| !j.is_null()).collect();
            must(!joined.is_empty(), &"no hair tells where it joins");
            for joined in joined {
                must(joined["unjoined"] == 0, joined);
            }
        }
        Ask::Partings(at_least) => {
            let most = found(prims, "partings").filter_map(|p| p["partings"].as_u64()).max();
            must(most.unwrap_or(0) >= *at_least, &format_args!("{most:?} partings"));
            check_laws(name, prims, &[CROSSING, ROOTED], not_yet(NOT_YET, name), wrong);
        }
        Ask::Sections(at_least) => {
            let most = found(prims, "sections").filter_map(|s| s["sections"].as_u64()).max();
            must(most.unwrap_or(0) >= *at_least, &format_args!("{most:?} sections with hair"));
        }
        Ask::AllInSections => {
            let without = sum("sections", "without");
            must(without == 0, &format_args!("{without} hairs belong to no section"));
        }
        Ask::Puffs(count) => {
            let puffs = sum("puffs", "puffs");
            must(puffs == *count, &format_args!("{puffs} puffs"));
            check_laws(name, prims, of_all_hair(&[OUTLINES]), not_yet(NOT_YET, name), wrong);
        }
        Ask::Tied { ties, share, behind_cm } => {
            let all = prims.iter().filter_map(|prim| prim["curves"].as_u64()).sum::<u64>();
            let held = sum("ties", "hairs");
            must(sum("ties", "ties") == *ties, &format_args!("{} ties", sum("ties", "ties")));
            must(
                held as f64 >= share * all as f64,
                &format_args!("{held} of {all} hairs are tied"),
            );
            for tied in found(prims, "ties") {
                let behind = tied["behind_cm"][1].as_f64();
                must(behind.is_some_and(|cm| cm >= *behind_cm), tied);
            }
            check_laws(name, prims, &[TIED], not_yet(NOT_YET, name), wrong);
        }
        Ask::Curls => {
            must(sum("curls", "measured") > 100, &"no curls are measured");
            check_laws(
                name,
                prims,
                &[DIAMETERS, PITCHES, SHRINKAGE],
                not_yet(NOT_YET, name),
                wrong,
            );
        }
    }
}

#[test]
fn heroes_show_what_their_style_shows() {
    for (name, _) in HEROES.iter().filter(|(name, _)| !grooms::HEROES.contains(name)) {
        println!("not judged: {name} is not shipped as a hero");
    }
    let mut wrong = vec![];
    for name in grooms::HEROES {
        let prims = shipped(name).hair();
        let strands = |prim: &Json| prim["curves"].as_u64().unwrap();
        let all: u64 = prims.iter().map(strands).sum();
        if all_hair() && !STRANDS.contains(&all) {
            wrong.push(format!("{name}: {all} strands"));
        }
        check_laws(name, &prims, LAWS, not_yet(NOT_YET, name), &mut wrong);
        asks_of(name).iter().for_each(|ask| check_ask(name, &prims, ask, &mut wrong));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn grooms_that_show_curls_have_them_as_asked() {
    let mut wrong = vec![];
    for name in ["curls", "curls_3b", "coils_4a", "zigzag_4b"] {
        let prims = shipped(name).hair();
        check_ask(name, &prims, &Ask::Curls, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn heroes_sit_on_real_heads() {
    let mut wrong = vec![];
    let heads: Vec<_> = real_heads("heroes_sit_on_real_heads").collect();
    for (i, name) in grooms::HEROES.iter().enumerate() {
        for head in one_of(&heads, i) {
            check_on(name, head.name, tenth(name, Some(head)), OF_ANY_HAIR, &mut wrong);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
#[ignore = "minutes in release"]
fn heroes_sit_on_real_heads_with_all_their_hair() {
    let mut wrong = vec![];
    for head in real_heads("heroes_sit_on_real_heads_with_all_their_hair") {
        for name in grooms::HEROES {
            let all = evaluate(name, Some(&head), false, Folder::new("all-their-hair"));
            check_on(name, head.name, &all, LAWS, &mut wrong);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Judges a hero on a head by these laws.
fn check_on(name: &str, on: &str, shipped: &Shipped, laws: &[&str], wrong: &mut Vec<String>) {
    let prims = shipped.hair();
    let what = format!("{name} on {on}");
    println!("{what}: {}", shipped.report["warnings"]);
    check_laws(&what, &prims, laws, not_yet(NOT_YET, &what), wrong);
    let all = !shipped.is_tenth;
    for ask in asks_of(name) {
        let laws = match ask {
            Ask::Partings(_) => &[CROSSING, ROOTED][..],
            Ask::Tied { .. } => &[TIED],
            Ask::Braids { .. } if all => &[WOVEN],
            Ask::Curls if all => &[DIAMETERS, PITCHES, SHRINKAGE],
            Ask::Puffs(_) if all => &[OUTLINES],
            _ => &[],
        };
        check_laws(&what, &prims, laws, not_yet(NOT_YET, &what), wrong);
    }
}
