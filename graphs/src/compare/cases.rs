//! What diff and merge say of a small groom, case by case.

use super::*;
use crate::document::Document;
use crate::file::{read, write};
use expect_test::{Expect, expect};

const BASE: &str = r#"(
    format: 3,
    title: "Rows",
    seed: 3,
    nodes: {
        "head": (kind: "head"),
        "rows": (kind: "stroke_input", inputs: {"strokes": [
            (id: 5, points: [(0.0, 9.0, 5.0), (0.0, 9.5, 0.0), (0.0, 9.0, -5.0)]),
            (id: 6, points: [(2.0, 9.0, 5.0), (2.0, 9.5, 0.0)]),
        ]}, links: {"scalp": "head.scalp"}),
        "finer": (kind: "resample", inputs: {"count": 8}, links: {"curves": "rows.curves"}, into: ["curves to all.curves"]),
        "all": (kind: "merge"),
        "braids": (kind: "lissajous_braid", label: "Front braids", inputs: {"strands": 3}, links: {"scalp": "head.scalp", "source": "finer.curves"}),
        "out": (kind: "groom_output", links: {"curves": "braids.curves"}),
    },
)"#;

/// The base with texts put in the place of others.
fn with(changes: &[(&str, &str)]) -> Document {
    let mut text = BASE.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let loaded = read(&text).unwrap_or_else(|err| panic!("{err}\n{text}"));
    assert_eq!(loaded.dropped_comments, []);
    loaded.document
}

#[track_caller]
fn check_diff(changes: &[(&str, &str)], expected: Expect) {
    let (a, b) = (with(&[]), with(changes));
    let same = if is_same_hair(&a, &b, &diff(&a, &b)) { "same hair\n" } else { "" };
    let said: String = lines(&a, &b, true).iter().map(|line| format!("{line}\n")).collect();
    expected.assert_eq(&(said + same));
}

#[test]
fn changes_are_said_as_a_groomer_says_them() {
    check_diff(
        &[],
        expect![[r#"
        same hair
    "#]],
    );
    check_diff(
        &[("\"strands\": 3", "\"strands\": 4"), ("seed: 3,", "")],
        expect![[r#"
        seed: 3 to 0
        Front braids: strands 3 to 4
    "#]],
    );
    check_diff(
        &[("{\"count\": 8}", "{\"spacing\": 0.25}")],
        expect![[r#"
        Resample: count 8 to 16 (default)
        Resample: spacing 0.5 cm (default) to 0.25 cm
    "#]],
    );
    check_diff(
        &[("inputs: {\"strands\": 3}", "bypass: true, note: \"why\"")],
        expect![[r#"
        Front braids: note none to "why"
        Front braids: bypassed
        Front braids: strands 3 to 3 (default)
    "#]],
    );
    check_diff(
        &[("\"source\": \"finer.curves\"", "\"source\": \"rows.curves\"")],
        expect![[r#"
        Front braids.source: from Resample to Stroke input
    "#]],
    );
    check_diff(
        &[(
            "\"head\": (kind: \"head\")",
            "\"head\": (kind: \"head\", at: (1.0, 2.0), label: \"Mia\")",
        )],
        expect![[r#"
        Mia: called "Mia", before none
        1 node moved on the canvas
        same hair
    "#]],
    );
    check_diff(
        &[
            (
                "(id: 6, points: [(2.0, 9.0, 5.0), (2.0, 9.5, 0.0)])",
                "(id: 7, points: [(1.0, 9.0, 5.0)])",
            ),
            ("(0.0, 9.5, 0.0)", "(0.0, 9.5, 0.3)"),
        ],
        expect![[r#"
            Stroke input: 1 stroke drawn, 1 removed, 1 moved by 0.30 cm
        "#]],
    );
    check_diff(
        &[
            ("into: [\"curves to all.curves\"]),", "),"),
            (
                "\"all\": (kind: \"merge\"),",
                "\"braids_2\": (kind: \"lissajous_braid\", links: {\"source\": \"finer.curves\"}, into: [\"curves to all.curves\"]), \"all\": (kind: \"scatter_guides\"),",
            ),
        ],
        expect![[r#"
            Scatter guides: Merge is now Scatter guides
            Scatter guides.curves: from Resample to Lissajous braid 2.curves
            Lissajous braid 2: added (Lissajous braid), fed by Resample
        "#]],
    );
    check_diff(
        &[
            (
                "seed: 3,",
                "display: \"rows\", frames: {\"f\": (at: (0.0, 0.0), size: (9.0, 9.0))}, look: (light: \"rim\", skin: \"3\"), budget: (points: 5000000, mib: 900),",
            ),
            ("\"out\": (", "// why\n\"out\": ("),
        ],
        expect![[r#"
            seed: 3 to 0
            shown: none to Stroke input
            budget: points none to 5 million
            budget: mib none to 900 MiB
            look: none to light "rim", exposure 0.0, skin "3"
            frame "f": added
            1 comment changed
        "#]],
    );
}

#[track_caller]
fn check_merge(ours: &[(&str, &str)], theirs: &[(&str, &str)], expected: Expect) {
    let (base, ours, theirs) = (with(&[]), with(ours), with(theirs));
    let merged = merge(&base, &ours, &theirs);
    let mut said: String = merged.conflicts.iter().map(|c| format!("! {c}\n")).collect();
    let changes = lines(&base, &merged.document, false);
    said.extend(changes.iter().map(|line| format!("{line}\n")));
    expected.assert_eq(&said);
    // It opens, and every reader tells what is left.
    let loaded = read(&write(&merged.document)).unwrap();
    assert_eq!(loaded.document, merged.document);
    assert_eq!(loaded.conflicts.len(), merged.conflicts.len());
    for (left, conflict) in loaded.conflicts.iter().zip(&merged.conflicts) {
        assert!(left.message.contains("merge conflict"), "{left} {conflict}");
    }
}

const HEALED: [(&str, &str); 2] = [
    (
        "\"finer\": (kind: \"resample\", inputs: {\"count\": 8}, links: {\"curves\": \"rows.curves\"}, into: [\"curves to all.curves\"]),",
        "",
    ),
    ("\"source\": \"finer.curves\"", "\"source\": \"rows.curves\""),
];

#[test]
fn what_meets_is_told_with_its_values_and_the_rest_is_merged() {
    let four = [("\"strands\": 3", "\"strands\": 4")];
    let five = [("\"strands\": 3", "\"strands\": 5"), ("title: \"Rows\"", "title: \"Five\"")];
    check_merge(
        &four,
        &five,
        expect![[r#"
        ! braids.strands: base 3, ours 4, theirs 5
        title: "Rows" to "Five"
        Front braids: strands 3 to 4
        1 comment changed
    "#]],
    );
    // A budget, term by term.
    let budget = |text: &'static str| [("seed: 3,", text)];
    check_merge(
        &budget("seed: 3, budget: (seconds: 2.5, points: 5000000),"),
        &budget("seed: 3, budget: (points: 4000000, mib: 900),"),
        expect![[r#"
            ! budget: points: base none, ours 5 million, theirs 4 million
            budget: seconds none to 2.5 s
            budget: points none to 5 million
            budget: mib none to 900 MiB
            1 comment changed
        "#]],
    );
    // Removed by one, changed by the other.
    let finest = [("\"count\": 8", "\"count\": 9")];
    check_merge(
        &HEALED,
        &finest,
        expect![[r#"
            ! finer: ours removed it, theirs changed finer.count from 8 to 9
            ! wires of braids.source: base finer.curves, ours rows.curves, theirs finer.curves
            Merge.curves: from Resample to nothing
            Front braids.source: from Resample to Stroke input
            Resample: removed (Resample)
            2 comments changed
        "#]],
    );
    check_merge(
        &finest,
        &HEALED,
        expect![[r#"
            ! finer: theirs removed it, ours changed finer.count from 8 to 9
            ! wires of braids.source: base finer.curves, ours finer.curves, theirs rows.curves
            Resample: count 8 to 9
            2 comments changed
        "#]],
    );
    check_merge(
        &HEALED,
        &four,
        expect![[r#"
        Merge.curves: from Resample to nothing
        Front braids: strands 3 to 4
        Front braids.source: from Resample to Stroke input
        Resample: removed (Resample)
    "#]],
    );
    // One node, put in by both.
    let fed = ("\"source\": \"finer.curves\"", "\"source\": \"x.curves\"");
    let a = [("\"all\": (", "\"x\": (kind: \"resample\"), \"all\": ("), fed];
    let b = [("\"all\": (", "\"x\": (kind: \"set_width\"), \"all\": ("), fed];
    check_merge(
        &a,
        &b,
        expect![[r#"
            ! x: kind: both added this node: ours "resample", theirs "set_width"
            Front braids.source: from finer to x
            x: added (Resample)
            1 comment changed
        "#]],
    );
    check_merge(
        &a,
        &a,
        expect![[r#"
            Front braids.source: from finer to x
            x: added (Resample)
        "#]],
    );
    // Another kind, and another value.
    let kind = [("kind: \"resample\", inputs: {\"count\": 8}", "kind: \"set_width\"")];
    check_merge(
        &kind,
        &finest,
        expect![[r#"
        ! finer: kind: one made the node another kind, the other changed it: base "resample", ours "set_width", theirs "resample"
        ! finer.count: one made the node another kind, the other changed it: base 8, ours not set, theirs 9
        Set width: Resample is now Set width
        Set width: count 8 to not set
        2 comments changed
    "#]],
    );
    // A circle that neither has.
    let one = [(
        "links: {\"curves\": \"rows.curves\"}, into: [\"curves to all.curves\"]",
        "links: {\"curves\": \"braids.curves\"}",
    )];
    let other = [("\"source\": \"finer.curves\"", "\"source\": \"all.curves\"")];
    check_merge(
        &[(
            "links: {\"curves\": \"rows.curves\"}, into",
            "links: {\"curves\": \"braids.curves\"}, into",
        )],
        &other,
        expect![[r#"
            ! wires of braids.source: both together: wires run in a circle: all -> braids -> finer -> all; remove one of these wires: ours finer.curves, theirs all.curves
            Resample.curves: from Stroke input to Front braids.curves
            1 comment changed
        "#]],
    );
    check_merge(
        &one,
        &[],
        expect![[r#"
        Merge.curves: from Resample to nothing
        Resample.curves: from Stroke input to Front braids.curves
    "#]],
    );
}

#[test]
fn strokes_and_wires_merge_one_by_one() {
    let point = [("(0.0, 9.5, 0.0)", "(0.0, 9.5, 0.3)")];
    let gone = [("(id: 5, points: [(0.0, 9.0, 5.0), (0.0, 9.5, 0.0), (0.0, 9.0, -5.0)]),", "")];
    let end = [("(0.0, 9.0, -5.0)", "(0.0, 9.0, -6.0)")];
    let drawn = [("(id: 6,", "(id: 8, points: [(1.0, 9.0, 5.0)]), (id: 6,")];
    check_merge(
        &point,
        &end,
        expect![[r#"
        Stroke input: 1 stroke moved by 1.00 cm
    "#]],
    );
    check_merge(
        &point,
        &[("(0.0, 9.5, 0.0)", "(0.0, 9.5, 0.4)")],
        expect![[r#"
        ! rows.strokes: stroke 5: base [(id: 5, points: [(0,9,5), (0,9.5,0), (0,9,-5)])], ours [(id: 5, points: [(0,9,5), (0,9.5,0.3), (0,9,-5)])], theirs [(id: 5, points: [(0,9,5), (0,9.5,0.4), (0,9,-5)])]
        Stroke input: 1 stroke moved by 0.30 cm
        1 comment changed
    "#]],
    );
    check_merge(
        &point,
        &gone,
        expect![[r#"
            ! rows.strokes: stroke 5: base [(id: 5, points: [(0,9,5), (0,9.5,0), (0,9,-5)])], ours [(id: 5, points: [(0,9,5), (0,9.5,0.3), (0,9,-5)])], theirs none
            Stroke input: 1 stroke moved by 0.30 cm
            1 comment changed
        "#]],
    );
    check_merge(
        &drawn,
        &gone,
        expect![[r#"
        Stroke input: 1 stroke drawn, 1 removed
    "#]],
    );
    let wired = [(
        "\"scalp\": \"head.scalp\"}),\n        \"finer\"",
        "\"scalp\": \"head.scalp\"}, into: [\"curves to all.curves\"]),\n        \"finer\"",
    )];
    let instead = [
        ("into: [\"curves to all.curves\"]", ""),
        (
            "\"source\": \"finer.curves\"}",
            "\"source\": \"finer.curves\"}, into: [\"curves to all.curves\"]",
        ),
    ];
    check_merge(
        &wired,
        &instead,
        expect![[r#"
        Merge.curves: also from Front braids.curves, Stroke input; no longer from Resample
    "#]],
    );
    let other = [
        wired[0],
        (
            "links: {\"curves\": \"rows.curves\"}, into: [\"curves to all.curves\"]",
            "links: {\"curves\": \"rows.curves\"}",
        ),
    ];
    check_merge(
        &other,
        &instead,
        expect![[r#"
        ! wires of all.curves: base finer.curves, ours rows.curves, theirs braids.curves
        Merge.curves: from Resample to Stroke input
        1 comment changed
    "#]],
    );
}

#[test]
fn a_comment_whose_entry_is_gone_stands_before_its_node() {
    let comment = [("{\"count\": 8}", "{\n// eight is enough\n\"count\": 8}")];
    let unset = [("{\"count\": 8}", "{}")];
    check_merge(
        &comment,
        &unset,
        expect![[r#"
        Resample: count 8 to 16 (default)
        1 comment changed
    "#]],
    );
    let merged = merge(&with(&[]), &with(&unset), &with(&comment)).document;
    assert!(write(&merged).contains("        // eight is enough\n        \"finer\": ("));
}

/// A group whose ports are set, read inside and wired outside.
const GROUPED: &str = r#"(
    format: 3,
    nodes: {
        "head": (kind: "head"),
        "locs": (
            kind: "group",
            label: "Locs",
            interface: (
                inputs: [
                    (name: "scalp", type: "scalp", needed: true),
                    (name: "radius", type: "field", default: 0.4, range: (0.1, 1.5), unit: "cm"),
                    (name: "fuzz", type: "number", default: 0.1),
                ],
                outputs: [(name: "hair", type: "curves")],
            ),
            inputs: {"radius": 0.5},
            links: {"scalp": "head.scalp"},
            nodes: {
                "in": (kind: "group_input"),
                "fall": (kind: "scatter_guides", inputs: {"count": 9}, links: {"scalp": "in.scalp", "radius": "in.radius", "length_variation": "in.fuzz"}),
                "out": (kind: "group_output", links: {"hair": "fall.curves"}),
            },
        ),
        "out": (kind: "groom_output", links: {"curves": "locs.hair"}),
    },
)"#;

/// What an upgrade makes of it: a port and an output with other names, a port that takes something else, one that is gone.
const UPGRADED: &[(&str, &str)] = &[
    (
        "name: \"radius\", type: \"field\", default: 0.4",
        "name: \"thickness\", type: \"field\", was: [\"radius\"], default: 0.45",
    ),
    ("(name: \"fuzz\", type: \"number\", default: 0.1),", ""),
    (", \"length_variation\": \"in.fuzz\"", ""),
    ("inputs: {\"radius\": 0.5}", "inputs: {\"thickness\": 0.5}"),
    ("in.radius", "in.thickness"),
    ("(name: \"hair\", type: \"curves\")", "(name: \"curves\", type: \"curves\", was: [\"hair\"])"),
    ("{\"hair\": \"fall.curves\"}", "{\"curves\": \"fall.curves\"}"),
    ("locs.hair", "locs.curves"),
];

/// Merges what two made of the grouped groom, both ways, and holds that what comes out evaluates.
#[track_caller]
fn check_grouped(ours: &[(&str, &str)], theirs: &[(&str, &str)], expected: Expect) {
    let with = |changes: &[(&str, &str)]| {
        let text = changes.iter().fold(GROUPED.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
        read(&text).unwrap_or_else(|err| panic!("{err}\n{text}")).document
    };
    let all = [&[], ours, theirs].map(with);
    let [base, ours, theirs] = &all;
    let [merged, back] = [(ours, theirs), (theirs, ours)].map(|(a, b)| merge(base, a, b));
    let mut said: String = merged.conflicts.iter().map(|c| format!("! {c}\n")).collect();
    said.extend(merged.lost.iter().map(|c| format!("lost {}: {:?}\n", c.fact, c.to)));
    let changes = lines(base, &merged.document, false);
    said.extend(changes.iter().map(|line| format!("{line}\n")));
    expected.assert_eq(&said);
    for merged in [&merged, &back] {
        let loaded = read(&write(&merged.document)).unwrap();
        assert_eq!(loaded.document, merged.document);
        let mut problems = crate::document::graph::check(&loaded.document);
        problems.retain(|problem| problem.needed);
        assert_eq!(problems, [], "{}", write(&merged.document));
    }
    assert_eq!(merged.lost, back.lost);
    if merged.conflicts.is_empty() {
        assert_eq!(write(&merged.document), write(&back.document));
    }
}

#[test]
fn who_renames_a_port_and_who_sets_it_do_not_meet() {
    check_grouped(
        &[("inputs: {\"radius\": 0.5}", "inputs: {\"radius\": 0.7}")],
        UPGRADED,
        expect![[r#"
            Locs: input fuzz removed
            Locs: input radius called radius to thickness, default 0.4 to 0.45
            Locs: output hair called hair to curves
            Locs: thickness 0.5 cm to 0.7 cm
            Locs/Scatter guides.length_variation: from Locs/Inputs.fuzz to nothing
        "#]],
    );
    // What is read from it and from the group by somebody else.
    check_grouped(
        UPGRADED,
        &[
            (
                "\"fall\": (",
                "\"more\": (kind: \"resample\", links: {\"curves\": \"fall.curves\", \"spacing\": \"in.fuzz\"}), \"fall\": (",
            ),
            (
                "\"out\": (kind: \"groom_output\"",
                "\"thin\": (kind: \"set_width\", links: {\"curves\": \"locs.hair\"}), \"out\": (kind: \"groom_output\"",
            ),
        ],
        expect![[r#"
            ! wires of locs/more.spacing: both together: locs/in.fuzz is no output: group_input gives scalp, thickness; wire one of these
            Locs: input fuzz removed
            Locs: input radius called radius to thickness, default 0.4 to 0.45
            Locs: output hair called hair to curves
            Locs/Scatter guides.length_variation: from Locs/Inputs.fuzz to nothing
            Locs/Resample: added (Resample), fed by Locs/Inputs, Locs/Scatter guides
            Set width: added (Set width), fed by Locs
            1 comment changed
        "#]],
    );
    // A value whose port is gone is lost, as in an upgrade.
    check_grouped(
        &[("{\"radius\": 0.5}", "{\"radius\": 0.5, \"fuzz\": 0.3}")],
        UPGRADED,
        expect![[r#"
            lost locs.fuzz: Some(Setting(Known(Float(0.3))))
            Locs: input fuzz removed
            Locs: input radius called radius to thickness, default 0.4 to 0.45
            Locs: output hair called hair to curves
            Locs/Scatter guides.length_variation: from Locs/Inputs.fuzz to nothing
        "#]],
    );
    // Both renamed it: ours is followed.
    check_grouped(
        UPGRADED,
        &[
            (
                "name: \"radius\", type: \"field\"",
                "name: \"wide\", type: \"field\", was: [\"radius\"]",
            ),
            ("in.radius", "in.wide"),
            ("{\"radius\": 0.5}", "{\"wide\": 0.9}"),
        ],
        expect![[r#"
            ! locs: interface: base scalp, radius = 0.4 in 0.1 to 1.5, fuzz = 0.1 -> hair, ours scalp, thickness = 0.45 in 0.1 to 1.5 -> curves, theirs scalp, wide = 0.4 in 0.1 to 1.5, fuzz = 0.1 -> hair
            Locs: input fuzz removed
            Locs: input radius called radius to thickness, default 0.4 to 0.45
            Locs: output hair called hair to curves
            Locs: thickness 0.5 cm to 0.9 cm
            Locs/Scatter guides.length_variation: from Locs/Inputs.fuzz to nothing
            1 comment changed
        "#]],
    );
}
