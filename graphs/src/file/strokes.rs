//! Strokes as text: columns of whole steps of the grid (0.01 cm, 1/256 of pressure, 1 ms, 1/64 of a right
//! angle).

use super::columns::Columns;
use crate::document::strokes::Steps;
use coif_nodes::data::strokes::{Sample, Stroke};
use serde::Deserialize;
use std::fmt::Write as _;

#[derive(Deserialize)]
#[serde(rename = "stroke", deny_unknown_fields)]
pub(super) struct FileStroke {
    id: u64,
    x: Vec<i64>,
    y: Vec<i64>,
    z: Vec<i64>,
    pressure: Vec<i64>,
    time: Vec<i64>,
    #[serde(default)]
    tilt_x: Vec<i64>,
    #[serde(default)]
    tilt_y: Vec<i64>,
    #[serde(default)]
    drawn: FileDrawn,
}

/// The samples of a stroke as drawn, in the same columns.
#[derive(Default, Deserialize)]
#[serde(rename = "drawn", deny_unknown_fields)]
struct FileDrawn {
    x: Vec<i64>,
    y: Vec<i64>,
    z: Vec<i64>,
    pressure: Vec<i64>,
    time: Vec<i64>,
    #[serde(default)]
    tilt_x: Vec<i64>,
    #[serde(default)]
    tilt_y: Vec<i64>,
}

const SAMPLES: Columns<7> = Columns {
    names: ["x", "y", "z", "pressure", "time", "tilt_x", "tilt_y"],
    optional: 5,
    row: "sample",
};

impl FileStroke {
    pub(super) fn stroke(self) -> Result<Stroke, String> {
        let Self { id, x, y, z, pressure, time, tilt_x, tilt_y, drawn } = self;
        let samples = samples([x, y, z, pressure, time, tilt_x, tilt_y])
            .map_err(|reason| format!("stroke {id}: {reason}"))?;
        let FileDrawn { x, y, z, pressure, time, tilt_x, tilt_y } = drawn;
        let drawn = self::samples([x, y, z, pressure, time, tilt_x, tilt_y])
            .map_err(|reason| format!("stroke {id} as drawn: {reason}"))?;
        Ok(Stroke { id, samples, drawn })
    }
}

fn samples(columns: [Vec<i64>; 7]) -> Result<Vec<Sample>, String> {
    let rows = SAMPLES.rows(columns)?;
    Ok(rows.into_iter().map(|row| Steps(row).sample()).collect())
}

/// Writes a stroke, on one line or on many.
pub(super) fn write(out: &mut String, stroke: &Stroke, lines: bool) {
    let steps = |samples: &[Sample]| -> Vec<_> { samples.iter().map(|s| Steps::of(s).0).collect() };
    let _ = write!(out, "(id: {}, ", stroke.id);
    SAMPLES.write(out, &steps(&stroke.samples), lines);
    if !stroke.drawn.is_empty() {
        out.push_str(", drawn: (");
        SAMPLES.write(out, &steps(&stroke.drawn), lines);
        out.push(')');
    }
    out.push(')');
}
