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
            "49:39: locks/strands.root_clump: strands gather from their roots on, and roots stay where they are now",
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
