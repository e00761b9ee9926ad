//! Strokes as text: what each is, then its samples, a point a line ([`points`]); before them the brush of
//! those that paint a mask. Format 1 had columns of whole steps of the grid (0.01 cm, 1/256 of pressure,
//! 1 ms, 1/64 of a right angle), each from the one before; they are still read.

use super::columns::Columns;
use super::points::{self, ParsedPoint};
use super::there;
use super::values::{new_line, quoted};
use crate::values::grid::Steps;
use crate::values::no_such_word;
use coif_nodes::data::strokes::{Brush, Mode, Sample, Stroke};
use serde::Deserialize;
use std::fmt::Write as _;

#[derive(Deserialize)]
#[serde(rename = "stroke", deny_unknown_fields)]
pub(super) struct FileStroke {
    #[serde(default, deserialize_with = "there")]
    pub(super) id: Option<u64>,
    /// Behind which other stroke of the list it comes.
    #[serde(default, deserialize_with = "there")]
    pub(super) after: Option<u64>,
    #[serde(default)]
    mode: String,
    #[serde(default)]
    radius: f32,
    #[serde(default)]
    strength: f32,
    #[serde(default)]
    mirrored: bool,
    #[serde(default)]
    closed: bool,
    #[serde(default)]
    section: String,
    #[serde(default, deserialize_with = "there")]
    points: Option<Vec<ParsedPoint>>,
    #[serde(default)]
    x: Vec<i64>,
    #[serde(default)]
    y: Vec<i64>,
    #[serde(default)]
    z: Vec<i64>,
    #[serde(default)]
    pressure: Vec<i64>,
    #[serde(default)]
    time: Vec<i64>,
    #[serde(default)]
    tilt_x: Vec<i64>,
    #[serde(default)]
    tilt_y: Vec<i64>,
    #[serde(default)]
    drawn: FileDrawn,
}

/// The samples of a stroke as drawn, written in the same ways.
#[derive(Default, Deserialize)]
#[serde(rename = "drawn", deny_unknown_fields)]
struct FileDrawn {
    #[serde(default, deserialize_with = "there")]
    points: Option<Vec<ParsedPoint>>,
    #[serde(default)]
    x: Vec<i64>,
    #[serde(default)]
    y: Vec<i64>,
    #[serde(default)]
    z: Vec<i64>,
    #[serde(default)]
    pressure: Vec<i64>,
    #[serde(default)]
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
/// What is painted knows no time, unless it was drawn as a line.
const DABS: Columns<7> = Columns { optional: 4, ..SAMPLES };
/// So many dabs stand on one line with their brush: most are taps, and there are many.
const A_LINE: usize = 3;

impl FileStroke {
    /// The stroke; else what is wrong with it.
    pub(super) fn stroke(self, id: u64) -> Result<Stroke, String> {
        let brush = self.brush().map_err(|reason| format!("stroke {id}: {reason}"))?;
        let Self { points, x, y, z, pressure, time, tilt_x, tilt_y, drawn, .. } = self;
        let columns = if brush.is_some() { &DABS } else { &SAMPLES };
        let samples = samples(columns, points, [x, y, z, pressure, time, tilt_x, tilt_y])
            .map_err(|reason| format!("stroke {id}: {reason}"))?;
        let FileDrawn { points, x, y, z, pressure, time, tilt_x, tilt_y } = drawn;
        let drawn = self::samples(columns, points, [x, y, z, pressure, time, tilt_x, tilt_y])
            .map_err(|reason| format!("stroke {id} as drawn: {reason}"))?;
        Ok(Stroke { id, samples, drawn, brush })
    }

    fn brush(&self) -> Result<Option<Brush>, String> {
        let Self { radius, strength, mirrored, closed, .. } = *self;
        if self.mode.is_empty() {
            let says = [
                ("radius", radius != 0.0),
                ("strength", strength != 0.0),
                ("mirrored", mirrored),
                ("closed", closed),
                ("section", !self.section.is_empty()),
            ];
            let says: Vec<&str> =
                says.into_iter().filter(|(_, is_said)| *is_said).map(|(name, _)| name).collect();
            return match says[..] {
                [] => Ok(None),
                _ => Err(without_mode(&says)),
            };
        }
        let known = || Mode::ALL.iter().map(|(_, word)| *word).collect::<Vec<_>>();
        let mode = Mode::named(&self.mode)
            .ok_or_else(|| format!("its mode {}", no_such_word(&self.mode, &known())))?;
        Ok(Some(Brush { mode, radius, strength, mirrored, closed, section: self.section.clone() }))
    }
}

/// What to do about parts of a brush that has no mode.
fn without_mode(says: &[&str]) -> String {
    let (names, modes) = (says.join(", "), Mode::ALL.iter().map(|(_, word)| format!("{word:?}")));
    let modes = modes.collect::<Vec<_>>().join(", ");
    let closes = match says.contains(&"closed") {
        true => ": a hairline closes by itself",
        false => "",
    };
    format!(
        "it says {names} without a mode; to paint a mask write mode ({modes}), radius and strength, else leave {names} out{closes}"
    )
}

fn samples(
    kind: &Columns<7>,
    points: Option<Vec<ParsedPoint>>,
    columns: [Vec<i64>; 7],
) -> Result<Vec<Sample>, String> {
    match points {
        Some(_) if columns.iter().any(|column| !column.is_empty()) => {
            Err("it has points and columns of numbers: keep one of them".to_owned())
        }
        Some(points) => Ok(points.into_iter().map(|point| point.0.sample()).collect()),
        None => Ok(kind.rows(columns)?.into_iter().map(|row| Steps(row).sample()).collect()),
    }
}

/// Writes a stroke, on one line or on many: then led by `indent`, and with what it comes after.
pub(super) fn write(out: &mut String, stroke: &Stroke, lines: Option<(usize, Option<u64>)>) {
    let steps = |samples: &[Sample]| -> Vec<_> { samples.iter().map(Steps::of).collect() };
    let taps = stroke.brush.is_some() && stroke.samples.len() <= A_LINE;
    let (indent, after) = lines.unwrap_or_default();
    let lines = lines.is_some() && !taps;
    let next = |out: &mut String| match lines {
        true => {
            out.push(',');
            new_line(out, indent + 1);
        }
        false => out.push_str(", "),
    };
    let _ = write!(out, "(id: {}", stroke.id);
    if let Some(after) = after {
        next(out);
        let _ = write!(out, "after: {after}");
    }
    if let Some(Brush { mode, radius, strength, mirrored, closed, section }) = &stroke.brush {
        next(out);
        let _ = write!(out, "mode: {:?}", mode.word());
        for (name, number) in [("radius", radius), ("strength", strength)] {
            next(out);
            let _ = write!(out, "{name}: {number:?}");
        }
        for (name, on) in [("mirrored", mirrored), ("closed", closed)] {
            if *on {
                next(out);
                let _ = write!(out, "{name}: true");
            }
        }
        if !section.is_empty() {
            next(out);
            out.push_str("section: ");
            quoted(out, section);
        }
    }
    next(out);
    out.push_str("points: ");
    points::write(out, &steps(&stroke.samples), lines);
    if !stroke.drawn.is_empty() {
        next(out);
        out.push_str("drawn: (points: ");
        points::write(out, &steps(&stroke.drawn), lines);
        out.push(')');
    }
    out.push(')');
}

#[cfg(test)]
mod tests {
    use super::super::values::{placed_value, read_value, write_to, write_value};
    use crate::document::strokes::finish;
    use crate::document::testing::Random;
    use coif_nodes::data::strokes::{Brush, Mode, Sample, Strokes};
    use coif_nodes::define::{Type, Value};

    const DAB: &str = "(id: 7, mode: \"paint\", radius: 1.0, strength: 0.5, points: [(0,8.9,0)])";
    const COLUMNS: &str = "(id: 7, mode: \"paint\", radius: 1.0, strength: 0.5, x: [0], y: [890], z: [0], \
         pressure: [256])";

    #[test]
    fn a_brush_is_written_as_it_was_read() {
        #[track_caller]
        fn check(text: &str) {
            let strokes = read_value(Type::Strokes, &format!("[{text}]")).unwrap();
            assert_eq!(write_value(&strokes), format!("[{text}]"));
        }
        check(DAB);
        check("(id: 7, points: [(0,8.9,0)])");
        let all = "strength: 0.1, mirrored: true, closed: true, section: \"a \\\"b\\\"\", points";
        check(&DAB.replace("strength: 0.5, points", all).replace("paint", "flood"));
    }

    #[test]
    fn a_stroke_of_format_1_reads_to_the_same() {
        let read = |text: &str| read_value(Type::Strokes, &format!("[{text}]")).unwrap();
        assert_eq!(write_value(&read(COLUMNS)), format!("[{DAB}]"));
        assert_eq!(read(COLUMNS).key(), read(DAB).key());
    }

    #[test]
    fn what_is_wrong_with_a_brush_is_found_on_its_line() {
        /// The second of three strokes, which begins on line 3.
        #[track_caller]
        fn check(from: &str, to: &str, expected: &str) {
            assert!(COLUMNS.contains(from), "{from}");
            let (second, third) = (COLUMNS.replace(from, to), COLUMNS.replace("id: 7", "id: 9"));
            let second = second.replace("id: 7", "id: 8");
            let list = format!("[\n{COLUMNS},\n{second},\n{third}]");
            let wrong = placed_value(Type::Strokes, &list).map(|v| write_value(&v)).unwrap_err();
            let line = list[..wrong.at].matches('\n').count() + 1;
            assert_eq!(line, 3, "{}", wrong.reason);
            assert!(wrong.reason.contains(expected), "{}: expected {expected}", wrong.reason);
        }
        let none = "stroke 8: its mode \"pait\" is none of paint, erase, smooth, flood; did you mean \"paint\"?";
        check("paint", "pait", none);
        check(
            "mode: \"paint\", ",
            "",
            "stroke 8: it says radius, strength without a mode; to paint a mask write mode (\"paint\", \"erase\", \"smooth\", \"flood\")",
        );
        check(
            "mode: \"paint\", radius: 1.0, strength: 0.5",
            "closed: true",
            "radius and strength, else leave closed out: a hairline closes by itself",
        );
        check(
            "radius: 1.0",
            "radius: 0.01",
            "stroke 1: the radius 0.01 of its brush is outside 0.05 to 30",
        );
        check(
            "radius: 1.0",
            "radius: inf",
            "stroke 1: the radius inf of its brush is outside 0.05 to 30",
        );
        check(
            "radius: 1.0",
            "radius: NaN",
            "stroke 1: the radius NaN of its brush is outside 0.05 to 30",
        );
        check("radius: 1.0, ", "", "stroke 1: the radius 0.0 of its brush is outside 0.05 to 30");
        check("strength: 0.5", "strength: 1.5", "stroke 1: its strength 1.5 is outside 0 to 1");
        check("strength: 0.5", "strength: -0.5", "stroke 1: its strength -0.5 is outside 0 to 1");
        check("x: [0]", "x: [0, 1]", "stroke 8: y has 1 samples, x has 2");
        check("x: [0]", "x: [9999999999999]", "stroke 8: sample 0 is not on earth");
        check("strength: 0.5", "strenght: 0.5", "stroke 1: unexpected field named `strenght`");
        check("pressure: [256]", "pressure: [a]", "stroke 1: ");
    }

    #[test]
    fn a_thousand_dabs_take_under_200_kilobytes_and_read_back_to_the_same_bits() {
        let mut random = Random::new(12);
        // As taps, at most text for each, and as strokes.
        for dabs_each in [1, 25] {
            let mut strokes = Strokes::default();
            for _ in 0..1000 / dabs_each {
                let brush = Brush {
                    mode: Mode::Paint,
                    radius: 0.05 + 3.0 * random.unit() / 7.0,
                    strength: random.unit() / 3.0,
                    mirrored: true,
                    closed: false,
                    section: "front left".to_owned(),
                };
                let tap = |k: usize, s: &Sample| Sample {
                    tilt: glam::Vec2::ZERO,
                    time: 0.0,
                    pressure: (k % 7) as f32 / 7.0,
                    ..*s
                };
                let pen = random.pen(400);
                let pen = pen.iter().step_by(16).zip(0..dabs_each).map(|(s, k)| tap(k, s));
                let pen: Vec<Sample> = pen.collect();
                let mut stroke = finish(&pen, &strokes).unwrap();
                stroke.brush = Some(brush);
                strokes.0.push(stroke);
            }
            let dabs: usize = strokes.0.iter().map(|stroke| stroke.samples.len()).sum();
            assert!(dabs > 900, "{dabs}");
            let strokes = Value::from(strokes);
            let mut text = String::new();
            write_to(&mut text, &strokes, Some(16));
            println!("{dabs} dabs in strokes of {dabs_each}: {} bytes", text.len());
            assert!(text.len() < 200_000, "{}", text.len());
            let back = read_value(Type::Strokes, &text).unwrap();
            assert_eq!(back.key(), strokes.key());
            assert_eq!(write_value(&back), write_value(&strokes));
        }
    }
}
