//! Reading and writing whole files.

use super::*;
use crate::document::edit::Edit;
use crate::document::testing::Random;
use crate::document::{NodeId, Point, Setting, Socket};
use crate::text::read_value;
use crate::waiting::ends;
use crate::work::count;
use coif_nodes::define::{Type, Value};
use expect_test::{Expect, expect};

/// A file of format 1: every field, comments where they could be kept.
const OLD: &str = r#"// Cornrows for the wedding scene.
// Ask before touching the crown.
(
    format: 1,
    // for the shelf
    title: "Cornrows \"wedding\"",
    note: "two\nlines",
    seed: 7,
    display: "rows",
    nodes: {
        "all": (
            kind: "of_tomorrow",
            bypass: true,
        ),
        // as many as fit
        "rows": (
            kind: "resample",
            label: "front rows",
            note: "tighter at the temple",
            inputs: {
                // not more than 12
                "count": 9,
                "spacing": 0.1,
                "twist": Twist(3, [1, 2]),
            },
        ),
    },
    // merged by length
    links: {
        "all.in": ["rows.curves", "rows.curves"],
        // from tomorrow
        "rows.curves": "all.out",
    },
    frames: {
        // of the wedding
        "front": (at: (300.0, -40.0), size: (420.0, 160.0), text: "Front rows", colour: 3),
        "plain": (at: (0.0, 0.0), size: (10.0, 10.0)),
    },
    // drawn by hand
    bends: {
        "all.in": [[], [(500.0, 60.5), (560.0, 60.5)]],
    },
    collapsed: [
        // too long
        "all",
    ],
    views: {
        "flat": (eye: (0.0, 0.0, 60.0), target: (0.0, 0.0, 0.0), up: (0.0, 1.0, 0.0), focal_mm: 50.0, orthographic: 32.0),
        // for the poster
        "hero": (eye: (31.5, 8.0, 42.0), target: (0.0, 1.5, 0.0), up: (0.0, 1.0, 0.0), focal_mm: 85.0),
    },
    // as it was approved
    look: (light: "dark-hair", exposure: 0.5, turn: -30.0, skin: "8"),
    // for the laptop
    budget: (seconds: 2.5, points: 5000000, mib: 900.0),
    layout: {
        "all": (640.5, -20.0),
        "rows": (320.0, 0.0),
    },
)
"#;

/// The same as it is written now.
const FULL: &str = include_str!("full.ron");

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}
#[track_caller]
fn ok(text: &str) -> Loaded {
    read(text).unwrap_or_else(|err| panic!("{err}\n{text}"))
}
/// What is said about a file: its error, or warnings and lost comments.
#[track_caller]
fn said(text: &str, want: Expect) {
    want.assert_eq(&match read(text) {
        Ok(loaded) => {
            let lost = loaded.dropped_comments.iter().map(|c| format!("lost {c}\n"));
            loaded.warnings.iter().map(|w| format!("{w}\n")).chain(lost).collect::<String>()
        }
        Err(err) => err.of_file("x.ron"),
    });
}
/// A file of one node with these fields.
fn node(fields: &str) -> String {
    format!("(\n    format: 1,\n    nodes: {{\n        \"a\": ({fields}),\n    }},\n)\n")
}
/// How two texts differ: lines only in the first, lines only in the second.
fn diff(before: &str, after: &str) -> (Vec<String>, Vec<String>) {
    let only = |these: &str, those: &str| {
        let mut rest: Vec<&str> = those.lines().collect();
        let mut only = vec![];
        for line in these.lines() {
            match rest.iter().position(|other| *other == line) {
                Some(at) => drop(rest.remove(at)),
                None => only.push(line.trim().to_owned()),
            }
        }
        only
    };
    (only(before, after), only(after, before))
}

#[test]
fn a_file_is_written_as_it_was_with_its_comments() {
    let loaded = ok(FULL);
    assert_eq!(write(&loaded.document), FULL);
    assert_eq!(loaded.dropped_comments, []);
    assert_eq!(loaded.document.node("rows").unwrap().label.as_deref(), Some("front rows"));
}

#[test]
fn a_file_of_format_1_is_read_and_becomes_one_of_today_with_its_comments() {
    let loaded = ok(OLD);
    assert_eq!(write(&loaded.document), FULL);
    assert_eq!((loaded.warnings.len(), loaded.dropped_comments), (2, vec![]));
}

#[test]
fn the_smallest_file_is_a_format() {
    expect![[r#"
        (
            format: 3,
            title: "",
            seed: 0,
            nodes: {
            },
        )
    "#]]
    .assert_eq(&write(&ok("(format:1)").document));
}

#[test]
fn values_are_written_each_on_its_line() {
    let mut document = ok(&node("kind: \"of_tomorrow\"")).document;
    let mut random = Random::new(8);
    let strokes = crate::document::strokes::finish(&random.pen(200), &Default::default());
    let shapes = "[(A, Circle), (B, Ellipse(0.7))]";
    let shapes = read_value(coif_nodes::define::Type::Shapes, shapes).unwrap();
    let strokes = coif_nodes::data::strokes::Strokes(strokes.into_iter().collect());
    let node = std::sync::Arc::make_mut(document.nodes.get_mut("a").unwrap());
    node.inputs.insert("shapes".into(), Setting::Known(shapes));
    node.inputs.insert("strokes".into(), Setting::Known(strokes.into()));
    expect![[r#"
        (
            format: 3,
            title: "",
            seed: 0,
            nodes: {














                "a": (
                    kind: "of_tomorrow",
                    inputs: {
                        "shapes": [
                            (A, Circle),
                            (B, Ellipse(0.7)),
                        ],
                        "strokes": [



                            (id: 783982968,
                             points: [
        (0,8,0,0.207,0,0.05,0),
        (0.76,7.97,0.2,0.273,0.055,0.05,0),
        (1.55,7.86,0.4,0.344,0.115,0.06,-0.02),
        (2.26,7.71,0.59,0.422,0.17,0.06,-0.02),
        (2.45,7.66,0.63,0.418,0.185,0.06,-0.02),
        (2.69,7.59,0.7,0.434,0.205,0.06,-0.03),
        (2.75,7.57,0.72,0.461,0.21,0.06,-0.02),
        (3.12,7.46,0.81,0.48,0.24,0.06,-0.03),
        (3.94,7.15,1.02,0.543,0.31,0.06,-0.03),
        (4.77,6.78,1.24,0.594,0.385,0.06,-0.05),
        (5.45,6.45,1.42,0.637,0.45,0.06,-0.05),
        (5.65,6.35,1.47,0.629,0.47,0.06,-0.06),
        (6.43,5.94,1.67,0.676,0.55,0.06,-0.06),
        (7.02,5.62,1.82,0.672,0.615,0.06,-0.08),
        (7.07,5.6,1.84,0.695,0.62,0.06,-0.06),
        (7.24,5.51,1.88,0.676,0.64,0.06,-0.08),
        (7.49,5.38,1.95,0.699,0.67,0.06,-0.08),
        (7.66,5.3,1.99,0.68,0.69,0.06,-0.08),
        (7.78,5.24,2.03,0.699,0.705,0.08,-0.08),
        (8.25,5.03,2.14,0.68,0.765,0.08,-0.09),
        (8.44,4.95,2.2,0.691,0.79,0.08,-0.09),
        (8.69,4.86,2.26,0.676,0.825,0.08,-0.09),
        (9.1,4.75,2.37,0.664,0.885,0.08,-0.09),
        (9.33,4.72,2.42,0.633,0.92,0.08,-0.11),
        (9.42,4.71,2.45,0.645,0.935,0.08,-0.11),
        (9.45,4.71,2.45,0.621,0.94,0.08,-0.11),
        (9.72,4.71,2.53,0.621,0.985,0.08,-0.11),
        (9.77,4.72,2.54,0.598,0.995,0.08,-0.11),
        ]),












                        ],
                    },
                ),

















            },
        )
    "#]]
    .assert_eq(&write(&document));
}

#[test]
fn random_documents_come_back() {
    for seed in 0..300 {
        let document = Random::new(seed).document();
        let text = write(&document);
        let loaded = ok(&text);
        assert_eq!(loaded.document, document, "seed {seed}\n{text}");
        assert_eq!(write(&loaded.document), text, "seed {seed}");
        assert_eq!(loaded.dropped_comments, [], "seed {seed}\n{text}");
    }
}

#[test]
fn comments_that_stand_before_nothing_are_named() {
    said(
        "// top\n(\n  format: 1, // kept is the line above only\n  /* block */\n  title: \"x\" // behind\n  ,\n  // no note\n  note: \"\",\n  nodes: {\n    \"a\": ( // opens\n      kind: \"of_tomorrow\",\n      inputs: {\n        \"x\": ( // part of what is kept\n          1),\n        // last\n      },\n    ),\n  },\n  // end\n)\n// after\n",
        expect![[r#"
            11:13: a: unknown node kind "of_tomorrow": kept as it is
            lost 3:14: // kept is the line above only
            lost 4:3: /* block */
            lost 5:14: // behind
            lost 7:3: // no note
            lost 10:12: // opens
            lost 15:9: // last
            lost 19:3: // end
            lost 21:1: // after
        "#]],
    );
    let text = "(\r\n    // windows\r\n    format: 1,\r\n)\r\n";
    assert!(write(&ok(text).document).contains("\n    // windows\n    format: 3,\n"));
    assert!(
        ok(&format!("\u{FEFF}// bom\n{}", &FULL[FULL.find('(').unwrap()..]))
            .dropped_comments
            .is_empty()
    );
}

#[test]
fn what_this_version_does_not_know_is_kept_byte_for_byte_and_said() {
    let text = node(
        "kind: \"of_tomorrow\", inputs: {\"deep\": Knot {\n   \"x\": ( /* in */ a: r#\"\"\"#, ), // in\n}, \"word\": Yes,}",
    );
    // `Knot { ... }` is no RON.
    assert!(read(&text).is_err());
    let value = "Knot({\n   \"x\": ( /* in */ a: r#\"\"\"#, ), // in\n})";
    let text =
        node(&format!("kind: \"of_tomorrow\", inputs: {{\"deep\": {value}, \"word\": Yes}}"));
    let document = ok(&text).document;
    assert_eq!(document.node("a").unwrap().inputs["deep"], Setting::Raw(value.into()));
    assert!(write(&document).contains(&format!("\"deep\": {value},\n")));
    said(
        &node(
            "kind: \"resample\", inputs: {\n    \"count\": \"nine\",\n    \"twist\": 3,\n    \"spacing\": 1}",
        ),
        expect![[r#"
            5:14: a.count: "nine" is no whole number: expected a whole number; write it like 3
            6:14: a.twist: resample has no such input: kept as it is
        "#]],
    );
    said(
        &node("kind: \"resmple\""),
        expect![[r#"
        4:21: a: unknown node kind "resmple": kept as it is
    "#]],
    );
}

#[test]
fn what_is_wrong_with_a_file_is_said_with_line_and_column() {
    said("", expect!["x.ron:1:1: not a groom: a groom begins with `(`"]);
    said("hello", expect!["x.ron:1:6: not a groom: a groom begins with `(`"]);
    said("(title: \"x\")", expect!["x.ron:1:12: the field `format` is missing"]);
    said(
        "(format: 1, colour: 3)",
        expect![
            "x.ron:1:13: unexpected field named `colour` in `Groom`, expected one of `format`, `title`, `note`, `seed`, `display`, `nodes`, `links`, `frames`, `bends`, `collapsed`, `views`, `look`, `budget`, `layout`, or `thumbnail` instead"
        ],
    );
    let budget = |text: &str| format!("(\n    format: 3,\n    budget: ({text}),\n)");
    said(
        &budget("points: 0"),
        expect![
            "x.ron:3:13: budget: points: 0.0 is no limit: give a finite number over 0, or leave points out"
        ],
    );
    said(
        &budget("mib: 9, seconds: -2.5"),
        expect![
            "x.ron:3:13: budget: seconds: -2.5 is no limit: give a finite number over 0, or leave seconds out"
        ],
    );
    said(
        &budget("mib: inf"),
        expect![
            "x.ron:3:13: budget: mib: inf is no limit: give a finite number over 0, or leave mib out"
        ],
    );
    said(
        &budget("points: 0.5"),
        expect!["x.ron:3:13: budget: points: 0.5 is no whole number of points"],
    );
    said("(format: 1, seed: -1)", expect!["x.ron:1:21: the number is out of range"]);
    said("(format: 1) (", expect!["x.ron:1:13: something stands behind its end"]);
    said("(format: 1, title: \"x\ny", expect!["x.ron:1:21: expected end of string"]);
    said(
        "(format: 1, format: 1)",
        expect!["x.ron:1:13: the field `format` stands here twice: keep one of them"],
    );
    said(
        &node("kind: \"resample\", knid: 3"),
        expect![
            "x.ron:4:33: unexpected field named `knid` in `Node`, expected one of `kind`, `label`, `note`, `bypass`, `inputs`, `links`, `into`, `at`, `collapsed`, `interface`, `template`, or `nodes` instead"
        ],
    );
    said(&node("label: \"x\""), expect!["x.ron:4:25: the field `kind` is missing"]);
    said(
        &node("kind: \"resample\", inputs: {\"count\": 3 \"by\": 4}"),
        expect!["x.ron:4:53: expected comma"],
    );
    said(
        &node("kind: \"resample\", inputs: {\"count\": 3, \"count\": 4}"),
        expect![[r#"x.ron:4:55: "count" stands here twice: keep one of them"#]],
    );
    said(
        &node("kind: \"resample\"),\n        \"a\": (kind: \"resample\""),
        expect![[r#"x.ron:5:10: "a" stands here twice: keep one of them"#]],
    );
    said(
        &node("kind: \"resample\"),\n        \"A b\": (kind: \"resample\""),
        expect![[
            r#"x.ron:5:10: "A b" is no node id: use a lower case letter, then letters, digits and underscores, at most 64, and within groups / between up to 16 of these"#
        ]],
    );
    said(
        "(format: 1, links: {\n  \"a\": \"b.c\"})",
        expect![[r#"x.ron:2:4: "a" is no socket: write it as "node.name""#]],
    );
    said(
        "(format: 1, links: {\n  \"a.b\": [\n    \"b\"]})",
        expect![[r#"x.ron:3:8: "b" is no socket: write it as "node.name""#]],
    );
    said(
        "(format: 1, links: {\n  \"a.b\": 3})",
        expect![[
            r#"x.ron:2:11: expected "node.output" or a list of these but found the unsigned integer `3` instead"#
        ]],
    );
    said(
        "(format: 1, layout: {\"a\": (1, inf)}, display: \"a\", links: {\"a.b\": []})",
        expect![[r#"
            1:27: layout of a: there is no such node: dropped
            1:47: display: there is no node "a": dropped
            1:67: a.b: an empty list of wires: dropped
        "#]],
    );
    said(
        "(format: 1, nodes: {\"a\": (kind: \"resample\")}, links: {\"a.curves\": \"a.curves\"},\n\
         frames: {\"\": (at: (0, 0), size: (1, 1)), \"f\": (at: (0, 0), size: (0, 1))},\n\
         bends: {\"a.curves\": [[], []], \"b.curves\": [[(1, 2)]], \"a.x\": [[(1, NaN)]]},\n\
         collapsed: [\"a\", \"b\", \"B\"],\n\
         views: {\"v\": (eye: (0, 0, 0), target: (0, 0, 0), up: (0, 1, 0), focal_mm: 50)}, look: (light: \"studio\", skin: \"a b\"))",
        expect![[r#"
            2:14: frame "": it has no name: dropped
            2:47: frame "f": its width and height must be over 0: dropped
            3:21: bends of a.curves: there are fewer wires: dropped
            3:43: bends of b.curves: there are fewer wires: dropped
            3:62: bends of a.x: a bend is not a finite number: dropped
            4:12: collapsed: there is no node "B": dropped
            4:18: collapsed: there is no node "b": dropped
            5:14: view "v": its eye is where it looks: dropped
            5:87: look: light and skin are words of 1 to 64 letters, digits and hyphens: dropped
        "#]],
    );
    said(
        "(format: 1, frames: {\"f\": (at: (0, 0), size: (1, 1), colour: 256)})",
        expect!["x.ron:1:65: the number is out of range"],
    );
    said(
        "(format: 1,\n<<<<<<< ours\n  seed: 1,\n=======\n",
        expect!["x.ron:2:1: a merge conflict is left in the file: resolve it first"],
    );
    said(
        "// x\n#![enable(implicit_some)]\n(format: 1)",
        expect!["x.ron:2:1: a groom has no #![...] attributes: remove this line"],
    );
    said(
        "(format: 4, frames: [1, 2])",
        expect![
            "x.ron:1:10: the file has format 4, this version reads up to 3: open it with a newer coif"
        ],
    );
    said(
        "(\n    frames: {},\n    format: 2000000,\n)",
        expect![
            "x.ron:3:13: the file has format 2000000, this version reads up to 3: open it with a newer coif"
        ],
    );
    let wire = "is no wire: write it as \"output to node.input\" or \"output to node.input after other.output\"";
    let into =
        |wire: &str| read(&node(&format!("kind: \"merge\", into: [\n\"{wire}\"]"))).unwrap_err();
    for wrong in
        ["curves", "curves to", "curves into a.b", "curves to a.b after", "a to b.c after d.e f"]
    {
        assert_eq!(into(wrong).to_string(), format!("5:2: {wrong:?} {wire}"));
    }
    assert_eq!(into("x to a").to_string(), "5:2: \"a\" is no socket: write it as \"node.name\"");
    said(
        "(format: 3, nodes: {\"a\": (kind: \"resample\", at: (1, 2), links: {\"curves\": \"b.c\", \"guides\": []})}, \
         links: {\"a.curves\": \"b.d\"}, layout: {\"a\": (3, 4)})",
        expect![[r#"
            1:49: layout of a: its place is said elsewhere in the file too: dropped
            1:75: a.curves: the input is wired elsewhere in the file too: dropped
            1:92: a.guides: an empty list of wires: dropped
        "#]],
    );
    said("(format: 99999999999)", expect!["x.ron:1:21: the number is out of range"]);
    let err = read_bytes(b"(\n  \xff\xfe").unwrap_err();
    assert_eq!(err.to_string(), "2:3: not a groom: this is no UTF-8 text");
}

#[test]
fn moving_a_node_changes_one_line() {
    let mut document = ok(FULL).document;
    let to = Some(Point(1.5, 2.0));
    Edit::Move { id: id("rows"), to }.apply(&mut document).unwrap();
    let changed = diff(FULL, &write(&document));
    assert_eq!(changed, (vec!["at: (320.0, 0.0),".into()], vec!["at: (1.5, 2.0),".into()]));
}

#[test]
fn changing_a_value_changes_one_line() {
    let mut document = ok(FULL).document;
    let setting = Setting::Known(Value::Int(12));
    Edit::SetInput { node: id("rows"), input: "count".into(), setting }
        .apply(&mut document)
        .unwrap();
    let changed = diff(FULL, &write(&document));
    assert_eq!(changed, (vec!["\"count\": 9,".into()], vec!["\"count\": 12,".into()]));
}

#[test]
fn a_moved_point_of_a_stroke_changes_one_line_and_a_new_stroke_no_other() {
    let mut random = Random::new(5);
    let mut document = ok(&node("kind: \"stroke_input\"")).document;
    let add = |document: &mut crate::document::Document,
               stroke: &coif_nodes::data::strokes::Stroke| {
        let (node, input, stroke) = (id("a"), "strokes".to_owned(), stroke.clone());
        Edit::AddStroke { node, input, at: usize::MAX, stroke }.apply(document).unwrap();
    };
    let mut strokes = coif_nodes::data::strokes::Strokes::default();
    for _ in 0..12 {
        let stroke = crate::document::strokes::finish(&random.pen(200), &strokes).unwrap();
        let before = write(&document);
        add(&mut document, &stroke);
        let (gone, new) = diff(&before, &write(&document));
        assert!(gone.iter().all(|line| line.is_empty()), "{gone:?}");
        assert!(strokes.0.is_empty() || new.len() <= stroke.samples.len() + 5, "{new:?}");
        strokes.0.push(stroke);
    }
    let before = write(&document);
    let mut stroke = strokes.0[4].clone();
    stroke.samples[3].position.x += 1.0;
    let (node, input) = (id("a"), "strokes".to_owned());
    Edit::ReplaceStroke { node, input, stroke }.apply(&mut document).unwrap();
    let (gone, new) = diff(&before, &write(&document));
    assert_eq!((gone.len(), new.len()), (1, 1));
}

#[test]
fn adding_a_node_adds_one_block() {
    let mut document = ok(FULL).document;
    let node = crate::document::Node { kind: "resample".into(), ..Default::default() };
    Edit::AddNode { id: id("mid"), node: node.into(), at: None }.apply(&mut document).unwrap();
    let (gone, new) = diff(FULL, &write(&document));
    assert_eq!((gone, new.len()), (vec![], 3));
    assert_eq!(new[..2], ["\"mid\": (", "kind: \"resample\","]);
    let wire = Edit::Connect {
        from: Socket::new(id("mid"), "curves"),
        to: Socket::new(id("all"), "in"),
        at: None,
    };
    let before = write(&document);
    wire.apply(&mut document).unwrap();
    let (gone, new) = diff(&before, &write(&document));
    assert_eq!((gone, new), (vec![], vec!["\"mid.curves\",".into()]));
}

#[test]
fn a_wrong_stroke_is_found_on_its_own_line() {
    let stroke = |id: u32, x: &str| {
        format!("\n(id: {id}, x: [{x}], y: [1], z: [1], pressure: [1], time: [1]),")
    };
    let check = |strokes: &[String], expected: (usize, &str)| {
        let list =
            format!("kind: \"stroke_input\", inputs: {{\"strokes\": [{}]}}", strokes.concat());
        let loaded = ok(&node(&list));
        let [warning] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
        assert_eq!(warning.line, expected.0, "{warning}");
        assert!(warning.message.contains(expected.1), "{warning}");
    };
    // The node stands on line 4, its strokes from line 5 on.
    let good = stroke(1, "1");
    check(&[good.clone(), stroke(2, "1,2")], (6, "stroke 2: y has 1 samples, x has 2"));
    check(&[good.clone(), stroke(2, "1"), stroke(1, "5")], (7, "stroke 2: its id 1 is 0 or used"));
    check(&[good.clone(), stroke(2, "x")], (6, "stroke 1: expected a whole number"));
    check(&[stroke(1, "\n1\n,9.5"), good], (7, "stroke 0: "));
}

#[test]
fn a_wrong_gesture_is_found_on_its_own_line() {
    let gesture = |id: u32, tool: &str, y: &str| {
        format!(
            "\n(id: {id}, tool: \"{tool}\", layer: \"through\", eye: (0.0, 0.0, 60.0), target: (0.0, 0.0, 0.0), up: (0.0, 1.0, 0.0), \
             half_height: 0.25, pixels: 1000.0, x: [1,2], y: [{y}], pressure: [1,1], time: [0,9]),"
        )
    };
    let check = |gestures: &[String], expected: (usize, &str)| {
        let list =
            format!("kind: \"hair_sketch\", inputs: {{\"gestures\": [{}]}}", gestures.concat());
        let loaded = ok(&node(&list));
        let [warning] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
        assert_eq!(warning.line, expected.0, "{warning}");
        assert!(warning.message.contains(expected.1), "{warning}");
    };
    let good = gesture(1, "comb", "1,1");
    check(
        &[good.clone(), gesture(2, "comb", "1")],
        (6, "gesture 1 (comb): y has 1 samples, x has 2"),
    );
    check(&[good.clone(), gesture(2, "pluck", "1,1")], (6, "implant, lengthen"));
    check(&[good.clone(), gesture(1, "cut", "1,1")], (6, "its id 1 is 0 or used before"));
}

#[test]
fn old_names_of_inputs_become_the_new_ones() {
    for def in coif_nodes::all() {
        for input in def.inputs {
            for old in input.old_names {
                let text = format!(
                    "(format: 1, nodes: {{\"a\": (kind: {:?}, inputs: {{\n// why\n{old:?}: ()}})}}, links: {{\n// who\n\"a.{old}\": \"b.x\"}})",
                    def.id
                );
                let written = write(&ok(&text).document);
                assert!(
                    written.contains(&format!("// why\n                {:?}: (),", input.name)),
                    "{written}"
                );
                assert!(
                    written
                        .contains(&format!("// who\n                {:?}: \"b.x\",", input.name)),
                    "{written}"
                );
            }
        }
    }
}

#[test]
fn broken_files_give_an_error_or_a_document_that_comes_back() {
    let mut random = Random::new(2024);
    let seeds =
        [FULL.to_owned(), write(&Random::new(1).document()), write(&Random::new(2).document())];
    let pieces = [
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        "\"",
        "'",
        ",",
        ":",
        "//",
        "/*",
        "*/",
        "r#\"",
        "\\",
        "\0",
        "\u{FEFF}",
        "-",
        "1e999",
        "NaN",
        "0x",
        "..",
        "Some(",
        "b'",
        "\u{202E}",
        "r#",
        "#![enable(unwrap_newtypes)]",
        "\n",
        " ",
        "99999999999999999999999",
        "_",
        "()",
    ];
    let (mut refused, mut read_well) = (0, 0);
    for round in 0..1800 {
        let mut text = random.pick(&seeds);
        for _ in 0..1 + random.below(2) {
            let mut at = random.below(text.len() + 1);
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            let mut to = (at + random.below(12)).min(text.len());
            while !text.is_char_boundary(to) {
                to += 1;
            }
            match random.below(9) {
                0 => text.truncate(at),
                1 => text.replace_range(at..to, ""),
                2 => text.replace_range(at..to, random.pick(&pieces)),
                3 => {
                    let copy = text[at..].chars().take(random.below(200)).collect::<String>();
                    text.insert_str(at, &copy);
                }
                4 => text.insert_str(at, random.pick(&pieces)),
                _ => {
                    // A slip of the finger: another letter or digit.
                    let is_word = |c: char| c.is_ascii_alphanumeric();
                    if let Some(i) = text[at..].find(is_word) {
                        let typed = random.pick(&["a", "e", "7", "0", "_", "E", ".", " "]);
                        text.replace_range(at + i..=at + i, typed);
                    }
                }
            }
        }
        match read(&text) {
            Ok(loaded) => {
                read_well += 1;
                let written = write(&loaded.document);
                let again = ok(&written);
                assert_eq!(again.document, loaded.document, "round {round}\n{text}\n{written}");
                assert_eq!(write(&again.document), written, "round {round}\n{text}");
            }
            Err(err) => {
                refused += 1;
                let lines = text.lines().count() + 1;
                assert!((1..=lines).contains(&err.line) && err.column > 0, "{err}\n{text}");
                assert!(!err.message.is_empty() && !err.message.contains('\n'), "{err}");
            }
        }
        // What has no structure at all.
        let noise: Vec<u8> = (0..random.below(64)).map(|_| random.bits() as u8).collect();
        assert!(read_bytes(&noise).is_err());
    }
    assert!(refused > 300 && read_well > 300, "{refused} {read_well}");
}

#[test]
fn attacks_are_refused_with_little_work() {
    let deep = |open: &str, n: usize| open.repeat(n);
    let value = |value: &str| node(&format!("kind: \"of_tomorrow\", inputs: {{\"x\": {value}}}"));
    // Each is read to its end once: it is asked for memory a few times for each byte at most.
    #[track_caller]
    fn check<T, E>(
        what: &str,
        text: &str,
        read: impl FnOnce(&str) -> Result<T, E>,
    ) -> Result<T, E> {
        let (read, work) = ends(what, || count(|| read(text)));
        let len = text.len() as u64;
        let is_little = work.asked < 200 + 4 * len && work.held < 20_000 + 100 * len;
        assert!(is_little, "{what} of {len}: {work:?}");
        read
    }
    for n in [100, 100_000] {
        for open in ["(", "[", "{", "Some(", "X(", "(a: ", "/*", "r#", "'", "\"\\", "[[],", "{1: "]
        {
            assert!(check(open, &deep(open, n), read).is_err(), "{open} {n}");
            assert!(check(open, &value(&deep(open, n)), read).is_err(), "{open} {n}");
            for ty in [Type::Shapes, Type::Field] {
                assert!(check(open, &deep(open, n), |text| read_value(ty, text)).is_err());
            }
        }
    }
    let digits = format!("1{}", "0".repeat(1_000_000));
    assert!(check("digits", &format!("(format: {digits})"), read).is_err());
    for number in
        [digits.as_str(), "1e999999999", "-1e-999999999", "0.0000000000000000000000000001"]
    {
        let text = node(&format!("kind: \"resample\", inputs: {{\"spacing\": {number}}}"));
        let loaded = check("a number", &text, read);
        assert!(loaded.is_ok_and(|loaded| write(&loaded.document).len() < 2_000_000));
    }
}

#[test]
fn saving_replaces_the_file_and_leaves_nothing_beside_it() {
    let folder = std::env::temp_dir().join(format!("coif-save-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("a.ron");
    let document = ok(FULL).document;
    for _ in 0..2 {
        save(&document, &path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), FULL);
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    // A folder is in the way: the error is told and nothing is left.
    assert!(save(&document, &folder).is_err());
    let beside = std::fs::read_dir(std::env::temp_dir()).unwrap().flatten();
    let left = beside.filter(|f| f.file_name().to_string_lossy().starts_with("coif-save-")).count();
    assert_eq!(left, 1);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn an_edit_takes_any_value_that_a_file_can_hold_and_no_other() {
    let takes = |raw: &str| {
        let mut document = ok(&node("kind: \"of_tomorrow\"")).document;
        let (input, setting) = ("x".to_owned(), Setting::Raw(raw.into()));
        Edit::SetInput { node: id("a"), input, setting }.apply(&mut document).map(|_| document)
    };
    for (open, close) in
        [("[", "]"), ("(", ")"), ("(a: ", ")"), ("{1: ", "}"), ("X(", ")"), ("Some(", ")")]
    {
        for n in 1..80 {
            let raw = format!("{}1{}", open.repeat(n), close.repeat(n));
            let text = node(&format!("kind: \"of_tomorrow\", inputs: {{\"x\": {raw}}}"));
            assert_eq!(takes(&raw).is_ok(), read(&text).is_ok(), "{open} {n}");
        }
    }
    for raw in
        ["", " 1", "1 // x", "1,", "(", "1, \"y\": 2", "/* */", "#![enable(unwrap_newtypes)] 1"]
    {
        assert!(takes(raw).is_err(), "{raw}");
    }
    let document = takes("X(1)").unwrap();
    assert_eq!(ok(&write(&document)).document, document);
}
