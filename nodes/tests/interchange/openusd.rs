//! OpenUSD as the judge: our files pass its validators and hold our values; its files read right.
//!
//! Needs a Python with usd-core 26.11, named by the variable `COIF_USD_PYTHON`; without it the tests
//! say so and pass. `tests/usd/validate.py` does OpenUSD's part.

use super::common::{Tufts, both_forms, read_curves, sample_stage};
use coif_nodes::formats::Chunks;
use coif_nodes::formats::usd::groom::{CurveSet, PrimvarValues, Widths};
use coif_nodes::formats::usd::read::{ReadCurves, ReadValues};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::{Command, Output};

/// Runs the script; `None` without OpenUSD.
pub(super) fn validate(test: &str, arguments: &[&str]) -> Option<Output> {
    let Ok(python) = std::env::var("COIF_USD_PYTHON") else {
        println!("skipped: {test} needs COIF_USD_PYTHON, a Python with usd-core");
        return None;
    };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/usd/validate.py");
    Some(Command::new(python).arg(script).args(arguments).output().unwrap())
}

/// Standard output, once the script has succeeded.
#[track_caller]
pub(super) fn passed(output: &Output) -> &str {
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{err}\n{out}");
    str::from_utf8(&output.stdout).unwrap()
}

pub(super) fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The sample stage in both forms, as files.
fn written(name: &str, strands: &Tufts, guides: &Tufts) -> [String; 2] {
    let folder = folder(name);
    both_forms(&sample_stage(strands, guides)).map(|(extension, bytes)| {
        let file = folder.join(format!("groom.{extension}"));
        std::fs::write(&file, bytes).unwrap();
        file.to_str().unwrap().to_owned()
    })
}

#[test]
fn openusd_finds_no_fault_and_our_values() {
    let (strands, guides) = (Tufts::new(300, None), Tufts::new(20, Some(8)));
    let files = written("report", &strands, &guides);
    let test = "openusd_finds_no_fault_and_our_values";
    let Some(output) = validate(test, &["report", &files[0], &files[1]]) else { return };
    let reports: Value = serde_json::from_str(passed(&output)).unwrap();
    let stage = sample_stage(&strands, &guides);
    for file in &files {
        let report = &reports[file];
        assert_eq!(report["default_prim"], "/Head_groom_1");
        assert_eq!(report["meters_per_unit"], 0.01);
        assert_eq!(report["up_axis"], "Y");
        assert_eq!(report["doc"], stage.doc);
        assert_eq!(report["about"]["seed"], (u64::MAX - 1).to_string());
        assert_eq!(report["about"]["generator"], "coif tests");
        assert_eq!(report["about"]["graph"], "00ff");
        let sets = ["/Strands/scalp", "/Guides/scalp", "/Strands/scalp_1"];
        for (set, path) in stage.groups.iter().zip(sets) {
            check_set(set, &report["curves"][format!("/Head_groom_1{path}")]);
        }
        let guides = &report["curves"]["/Head_groom_1/Guides/scalp"];
        assert_eq!(guides["purpose"], "guide");
        assert_eq!(guides["material"][0], "/Head_groom_1/Looks/scalp_1");
    }
}

#[track_caller]
fn check_set(set: &CurveSet, report: &Value) {
    check_array(&report["counts"], "int[]", set.counts.len(), &bytes_of(&set.counts));
    check_array(&report["points"], "point3f[]", set.points.len(), &bytes_of(&set.points));
    let (widths, interpolation) = match &set.widths {
        Widths::Constant(width) => (Chunks::from(vec![*width]), "constant"),
        Widths::Vertex(widths) => (widths.clone(), "vertex"),
    };
    check_array(&report["widths"], "float[]", widths.len(), &bytes_of(&widths));
    assert_eq!(report["widths_interpolation"], interpolation);
    assert_eq!(report["type"], json!(["cubic", "catmullRom", "pinned"]));
    assert_eq!(report["primvars"].as_object().unwrap().len(), set.primvars.len());
    for primvar in &set.primvars {
        let report = &report["primvars"][primvar.name.replace(' ', "_")];
        assert_eq!(report["interpolation"], primvar.interpolation.name());
        check_primvar(report, &primvar.values);
    }
}

#[track_caller]
fn check_primvar(report: &Value, values: &PrimvarValues) {
    let (type_name, count, bytes) = match values {
        PrimvarValues::Int(values) => ("int[]", values.len(), bytes_of(values)),
        PrimvarValues::Int64(values) => ("int64[]", values.len(), bytes_of(values)),
        PrimvarValues::Float(values) => ("float[]", values.len(), bytes_of(values)),
        PrimvarValues::TexCoord(values) => ("texCoord2f[]", values.len(), bytes_of(values)),
        PrimvarValues::Vector(values) => ("float3[]", values.len(), bytes_of(values)),
        PrimvarValues::Color(values) => ("color3f[]", values.len(), bytes_of(values)),
        PrimvarValues::Point(values) => ("point3f[]", values.len(), bytes_of(values)),
        PrimvarValues::Text(values) | PrimvarValues::Named(values, _) => {
            let bytes = values.iter().flat_map(|text| [text.as_bytes(), &[0]].concat());
            ("string[]", values.len(), bytes.collect())
        }
    };
    check_array(report, type_name, count, &bytes);
}

#[track_caller]
fn check_array(report: &Value, type_name: &str, count: usize, bytes: &[u8]) {
    assert_eq!(report["type"], type_name);
    assert_eq!(report["count"], count);
    let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(report["bytes"], hex);
}

fn bytes_of<T: bytemuck::NoUninit>(values: &Chunks<T>) -> Vec<u8> {
    values.slices().flat_map(bytemuck::cast_slice).copied().collect()
}

#[test]
fn openusd_sees_no_difference_between_our_two_forms() {
    let (strands, guides) = (Tufts::new(300, None), Tufts::new(20, Some(8)));
    let files = written("equal", &strands, &guides);
    let test = "openusd_sees_no_difference_between_our_two_forms";
    let Some(output) = validate(test, &["equal", &files[0], &files[1]]) else { return };
    passed(&output);
}

#[test]
fn openusd_sees_a_difference_where_there_is_one() {
    let (strands, other) = (Tufts::new(300, None), Tufts::new(20, Some(8)));
    let files = written("differ_a", &strands, &other);
    let others = written("differ_b", &strands, &Tufts::new(21, Some(8)));
    let test = "openusd_sees_a_difference_where_there_is_one";
    let Some(output) = validate(test, &["equal", &files[0], &others[1]]) else { return };
    assert!(!output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("differs: /Head_groom_1/Guides"));
}

#[test]
fn openusd_finds_faults_where_there_are_some() {
    let test = "openusd_finds_faults_where_there_are_some";
    let Some(output) = validate(test, &["control"]) else { return };
    passed(&output);
}

#[test]
fn files_of_openusd_read_as_openusd_reads_them() {
    let test = "files_of_openusd_read_as_openusd_reads_them";
    let folder = folder("openusd");
    let Some(output) = validate(test, &["write", folder.to_str().unwrap()]) else { return };
    let reports: Value = serde_json::from_str(passed(&output)).unwrap();
    let reports = reports.as_object().unwrap();
    assert_eq!(reports.len(), 2);
    for (file, report) in reports {
        let read = read_curves(&std::fs::read(file).unwrap(), "usd").unwrap();
        assert_eq!(read.len(), report.as_object().unwrap().len(), "{file}");
        for curves in read {
            check_read(&curves, &report[&curves.path]);
        }
    }
}

#[track_caller]
pub(super) fn check_read(read: &ReadCurves, report: &Value) {
    assert_eq!(report["purpose"], read.purpose);
    assert_eq!(report["counts"], json!(read.counts));
    let coordinates = read.points.iter().flat_map(|point| point.to_array());
    for (ours, theirs) in coordinates.zip(report["points"].as_array().unwrap()) {
        // Theirs are doubles, ours are rounded once.
        let theirs = theirs.as_f64().unwrap();
        let error = (ours as f64 - theirs).abs();
        assert!(error <= 1e-6 * theirs.abs().max(1.0), "{}: {ours} is not {theirs}", read.path);
    }
    let primvars = report["primvars"].as_object().unwrap();
    assert_eq!(read.primvars.len(), primvars.len(), "{:?}", read.notes);
    for primvar in &read.primvars {
        let ours = json_of(&primvar.values);
        let theirs = primvars[&primvar.name].as_array().unwrap();
        assert_eq!(ours.len(), theirs.len(), "{}", primvar.name);
        for (ours, theirs) in ours.iter().zip(theirs) {
            let is_same = match (ours.as_f64(), theirs.as_f64()) {
                (Some(ours), Some(theirs)) => ours == theirs || ours == theirs as f32 as f64,
                _ => ours == theirs,
            };
            assert!(is_same, "{} of {}: {ours} is not {theirs}", primvar.name, read.path);
        }
    }
}

/// All numbers of the values as floats, or their texts.
fn json_of(values: &ReadValues) -> Vec<Value> {
    match values {
        ReadValues::Int(values) => values.iter().map(|&value| json!(value as f64)).collect(),
        ReadValues::Int64(values) => values.iter().map(|&value| json!(value as f64)).collect(),
        ReadValues::Float(values) => values.iter().map(|&value| json!(value as f64)).collect(),
        ReadValues::Float2(values) => {
            values.iter().flat_map(|v| v.to_array()).map(|value| json!(value as f64)).collect()
        }
        ReadValues::Float3(values) => {
            values.iter().flat_map(|v| v.to_array()).map(|value| json!(value as f64)).collect()
        }
        ReadValues::Text(values) => values.iter().map(|text| json!(text)).collect(),
    }
}
