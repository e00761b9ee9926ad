//! Files of older formats, and what is made of them.

use crate::document::groups;
use crate::file::{document_hash, read, write};

const V2: &str = include_str!("samples/v2.ron");
const V3: &str = include_str!("samples/v3.ron");

#[test]
fn makers_of_format_2_become_the_chains_that_give_the_same_hair() {
    let loaded = read(V2).unwrap();
    let written = write(&loaded.document);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/file/upgrade/samples");
        std::fs::write(format!("{folder}/v3.ron"), &written).unwrap();
    }
    assert_eq!(written, V3);
    let said: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "26:114: exact.push_out: hair always stays out of the skin, except as deep as the attribute allow_depth of what it is made \
             from: dropped",
            "49:39: locks/strands.root_clump: strands gather from their roots on, and roots stay where they are now: Clump has one \
             amount, and a ramp along the hair",
        ]
    );
    assert!(loaded.dropped_comments.is_empty() && loaded.conflicts.is_empty());
    assert_eq!(read(V3).unwrap().document, loaded.document);
}

#[test]
fn an_input_that_nobody_knows_is_kept_in_any_format() {
    let of = |format: u32, input: &str| {
        let text = format!(
            "(format: {format}, nodes: {{\"hair\": (kind: \"interpolate\", inputs: {{\"{input}\": 0.5}})}})"
        );
        let said = read(&text).unwrap().warnings;
        said.first().map(|said| said.message.clone())
    };
    let kept =
        |input: &str| Some(format!("hair.{input}: interpolate has no such input: kept as it is"));
    assert_eq!(of(2, "clump"), None);
    assert_eq!(of(3, "clump"), kept("clump"));
    assert_eq!(of(2, "clumps"), kept("clumps"));
}

#[test]
fn values_of_former_inputs_that_are_none_are_told_and_kept() {
    let text =
        "(format: 2, nodes: {\"hair\": (kind: \"interpolate\", inputs: {\"clump\": \"much\"})})";
    let loaded = read(text).unwrap();
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    assert!(
        loaded.warnings[0].to_string().starts_with("1:69: hair.clump: "),
        "{:?}",
        loaded.warnings
    );
    assert!(write(&loaded.document).contains("\"amount\": \"much\""));
}

/// What is said of a document of format 2 with these nodes, and what is written of it.
fn upgraded(nodes: &str) -> (Vec<String>, String) {
    let loaded = read(&format!("(format: 2, nodes: {{{nodes}}})")).unwrap();
    assert!(loaded.dropped_comments.is_empty(), "{:?}", loaded.dropped_comments);
    let said = loaded.warnings.iter().map(ToString::to_string).collect();
    (said, write(&loaded.document))
}

#[test]
fn a_port_without_a_default_keeps_the_one_that_its_reader_had() {
    let (said, written) = upgraded(
        r#""p": (kind: "parameters", interface: (inputs: [(name: "c", type: "field"), (name: "j", type: "number")])),
        "hair": (kind: "interpolate", links: {"clump": "p.c"}),
        "g": (kind: "group", interface: (inputs: [(name: "waves", type: "number")]), links: {"waves": "p.j"}, nodes: {
            "in": (kind: "group_input"),
            "fill": (kind: "cluster_to_strands", links: {"jitter": "in.waves"}),
        })"#,
    );
    assert!(said.is_empty(), "{said:?}");
    for port in [
        "name: \"c\", type: \"field\"",
        "name: \"j\", type: \"number\"",
        "name: \"waves\", type: \"number\"",
    ] {
        assert!(written.contains(&format!("({port}, default: 0.0")), "{port}: {written}");
    }
}

#[test]
fn what_comes_to_lie_nowhere_is_told_with_its_place_and_leaves_its_comments() {
    let (said, written) = upgraded(
        r#""hair": (kind: "interpolate", inputs: {
            // for later
            "clump_along": Linear([(0.0, 1.0), (1.0, 1.0)]),
            // always
            "push_out": true,
        }),
        "fill": (kind: "cluster_to_strands", inputs: {"points": 400, "most_points": 8, "twist": 45.0, "wisps": 9},
            links: {"push_out": "hair.curves"})"#,
    );
    let nothing = "it had no effect here: dropped";
    assert_eq!(said.len(), 4, "{said:?}");
    assert_eq!(said[0], format!("3:28: hair.clump_along: {nothing}"));
    assert!(said[1].starts_with("7:85: fill.most_points: strands have"), "{said:?}");
    assert_eq!(said[2], format!("7:112: fill.wisps: {nothing}"));
    assert!(said[3].starts_with("8:33: fill.push_out: "), "{said:?}");
    assert!(written.contains("// for later\n") && written.contains("// always\n"), "{written}");
}

#[test]
fn ids_of_new_nodes_are_told_apart_and_take_up_no_wire_that_led_nowhere() {
    let long = "a".repeat(64);
    let (_, written) = upgraded(&format!(
        r#""{long}": (kind: "interpolate"), "hair": (kind: "interpolate"), "out": (kind: "groom_output", links: {{"curves": "hair_length.curves"}})"#
    ));
    assert!(written.contains(&format!("\"{}_length\": (", "a".repeat(42))), "{written}");
    assert!(written.contains("\"hair_length_2\": ("), "{written}");
}

#[test]
fn a_group_that_is_as_its_template_made_it_still_is() {
    let marked = |hash: &str| {
        format!(
            "(format: 2, nodes: {{\"locks\": (kind: \"group\", template: (name: \"locks\", version: \"1.0\", hash: \"{hash}\"), \
             nodes: {{\"hair\": (kind: \"interpolate\", inputs: {{\"clump\": 0.5}})}})}})"
        )
    };
    // What it was called by before there was a format 3.
    let old = "(format: 3, nodes: {\"locks\": (kind: \"group\", nodes: {\"hair\": (kind: \"interpolate\", inputs: {\"clump\": 0.5})})})";
    let old = read(old).unwrap().document;
    let locks = old.nodes.keys().next().unwrap();
    let made = document_hash(&groups::alone(&old, locks));
    for (hash, is_as_made) in [(made.as_str(), true), ("0123", false)] {
        let document = read(&marked(hash)).unwrap().document;
        let origin = document.nodes[locks].template.clone().unwrap();
        assert_eq!(crate::template::is_as_made(&document, locks, &origin), is_as_made);
    }
}

#[test]
fn a_format_older_than_any_that_is_read_is_refused() {
    let err = read("(\n    title: \"Old rows\",\n    format: 0,\n)").unwrap_err();
    assert_eq!(
        err.of_file("rows.ron"),
        "rows.ron:3:13: the file has format 0, the oldest that is read is 1"
    );
}

#[test]
fn ports_that_lead_in_a_circle_are_looked_at_once() {
    let group = |name: &str| {
        format!(
            r#""{name}": (kind: "group", interface: (inputs: [(name: "p", type: "number")]), nodes: {{
                "in": (kind: "group_input"), "fill": (kind: "cluster_to_strands", links: {{"jitter": "in.p"}}),
            }})"#
        )
    };
    for to in ["x/in", "y/in"] {
        let text = format!(
            r#"(format: 1, nodes: {{{}, {}}}, links: {{"x.p": "y/in.p", "y.p": "{to}.p"}})"#,
            group("x"),
            group("y")
        );
        let document = read(&text).unwrap().document;
        assert!(document.nodes.contains_key("x/fill_waves"), "{to}");
    }
}
