//! The mechanism of upgrades, on a format 0 that never was: it called titles names and kinds types.

use super::*;
use crate::document::Setting;

const SAMPLE: &str = include_str!("samples/v0.ron");

fn v0_to_v1(groom: &mut Raw) -> Result<(), String> {
    groom.rename("name", "title");
    if let Some(nodes) = groom.get_mut("nodes") {
        let mut all = Raw::read(nodes)?;
        all.each(|_, node| {
            node.rename("type", "kind");
            Ok(())
        })?;
        *nodes = all.write();
    }
    Ok(())
}

fn fails(_: &mut Raw) -> Result<(), String> {
    Err("nothing is as it was".to_owned())
}

#[test]
fn a_step_carries_what_it_does_not_know() {
    let text = upgrade(SAMPLE, 0, (0, &[v0_to_v1])).unwrap();
    let loaded = super::super::read(&text).unwrap();
    let document = loaded.document;
    assert_eq!(document.title, "Old rows");
    let node = document.node("points").unwrap();
    assert_eq!(node.kind, "resample");
    assert_eq!(node.inputs["of_tomorrow"], Setting::Raw("Twist(3, [1, 2])".into()));
    let written = super::super::write(&document);
    assert_eq!(super::super::read(&written).unwrap().document, document);
}

#[test]
fn steps_run_from_the_format_of_the_file_on() {
    assert_eq!(format_of(SAMPLE).map(|(format, at)| (format, &SAMPLE[at..at + 1])), Some((0, "0")));
    let text = upgrade("(format: 1)", 1, (0, &[fails, |_| Ok(())])).unwrap();
    assert_eq!(text, "(\nformat: 2,\n)");
    assert_eq!(
        upgrade(SAMPLE, 0, (0, &[fails])).unwrap_err(),
        "format 0 to 1: nothing is as it was"
    );
}

#[test]
fn a_format_older_than_any_that_is_read_is_refused() {
    let err = super::super::read(SAMPLE).unwrap_err();
    assert_eq!(
        err.of_file("rows.ron"),
        "rows.ron:3:13: the file has format 0, the oldest that is read is 1"
    );
}
