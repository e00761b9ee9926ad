//! Samples of strokes as people type them: each on its line, where it lies, in whole cm of head units and
//! parts of them. Read and written with at most three decimals, which is finer than the grid.

use crate::values::grid::Steps;
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};
use std::fmt;

/// What a point says: so many of these numbers.
const NAMES: [&str; 7] = ["x", "y", "z", "pressure", "time", "tilt x", "tilt y"];
/// What each may be, and how many steps of the grid a unit has.
const RANGES: [(f64, f64, f64); 7] = [
    (-1e5, 1e5, 100.0),
    (-1e5, 1e5, 100.0),
    (-1e5, 1e5, 100.0),
    (0.0, 1.0, 256.0),
    (0.0, 1e5, 1000.0),
    (-1.0, 1.0, 64.0),
    (-1.0, 1.0, 64.0),
];
/// Full pressure, what a mouse has; no time; a pen held upright.
const LEFT_OUT: [i64; 7] = [0, 0, 0, 256, 0, 0, 0];
/// How many numbers a point may say.
const COUNTS: [usize; 4] = [3, 4, 5, 7];

/// How a point is written.
pub(super) const LIKE: &str = "(x, y, z) in cm of head units, then pressure (0 to 1), time (seconds) \
                               and tilt (two numbers), which may be left out";

/// A point as it is read.
pub(super) struct ParsedPoint(pub(super) Steps);

impl<'de> Deserialize<'de> for ParsedPoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = ParsedPoint;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a point {LIKE}")
            }
            fn visit_seq<S: SeqAccess<'de>>(self, mut seq: S) -> Result<ParsedPoint, S::Error> {
                let (mut steps, mut count) = (LEFT_OUT, 0);
                while let Some(x) = seq.next_element::<f64>()? {
                    if let Some((low, high, per_unit)) = RANGES.get(count).copied() {
                        if !(low..=high).contains(&x) {
                            let name = NAMES[count];
                            let why = format!("{name} {x} of a point is outside {low} to {high}");
                            return Err(de::Error::custom(why));
                        }
                        steps[count] = (x * per_unit).round() as i64;
                    }
                    count += 1;
                }
                if !COUNTS.contains(&count) {
                    let why = format!("a point of {count} numbers: expected {LIKE}");
                    return Err(de::Error::custom(why));
                }
                Ok(ParsedPoint(Steps(steps)))
            }
        }
        deserializer.deserialize_any(Numbers)
    }
}

/// Writes points, each on its line where there are lines.
pub(super) fn write(out: &mut String, points: &[Steps], lines: bool) {
    let says = |count: usize| points.iter().any(|p| p.0[count..] != LEFT_OUT[count..]);
    let count = COUNTS.into_iter().rev().fold(7, |all, n| if says(n) { all } else { n });
    out.push('[');
    for (i, Steps(steps)) in points.iter().enumerate() {
        out.push_str(if lines {
            "\n"
        } else if i > 0 {
            ", "
        } else {
            ""
        });
        for (k, (step, range)) in steps.iter().zip(RANGES).take(count).enumerate() {
            out.push(if k > 0 { ',' } else { '(' });
            number(out, *step as f64 / range.2, if matches!(k, 3 | 4) { 3 } else { 2 });
        }
        out.push_str(if lines { ")," } else { ")" });
    }
    out.push_str(if lines { "\n]" } else { "]" });
}

/// A number with as few decimals as it needs.
fn number(out: &mut String, x: f64, decimals: usize) {
    let text = format!("{x:.decimals$}");
    out.push_str(text.trim_end_matches('0').trim_end_matches('.'));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(points: &[Steps]) -> String {
        let mut out = String::new();
        write(&mut out, points, false);
        out
    }
    fn read(text: &str) -> Result<Vec<Steps>, String> {
        let points: Vec<ParsedPoint> = ron::from_str(text).map_err(|err| err.code.to_string())?;
        Ok(points.into_iter().map(|point| point.0).collect())
    }

    #[test]
    fn every_step_of_the_grid_comes_back() {
        for (k, (low, high, per_unit)) in RANGES.into_iter().enumerate() {
            let ends = ((low * per_unit) as i64, (high * per_unit) as i64);
            let near = (-300i64..=1100).map(|step| step.clamp(ends.0, ends.1));
            for step in near.chain([ends.0, ends.1, ends.1 - 1]) {
                let mut steps = LEFT_OUT;
                steps[k] = step;
                let text = written(&[Steps(steps)]);
                assert_eq!(read(&text).unwrap(), [Steps(steps)], "{text}");
            }
        }
    }

    #[test]
    fn what_says_nothing_is_left_out() {
        #[track_caller]
        fn check(text: &str, as_written: &str) {
            assert_eq!(written(&read(text).unwrap()), as_written);
        }
        check("[(1, -0.5, 8.904)]", "[(1,-0.5,8.9)]");
        check("[(0, 0, 0, 1)]", "[(0,0,0)]");
        check("[(100, 0, 0, 0.5), (1, 2, 3)]", "[(100,0,0,0.5), (1,2,3,1)]");
        check("[(0, 0, 0, 1, 0.016)]", "[(0,0,0,1,0.016)]");
        check("[(0, 0, 0, 1, 0, 0, -1)]", "[(0,0,0,1,0,0,-1)]");
    }

    #[test]
    fn a_wrong_point_says_what_a_point_is() {
        #[track_caller]
        fn check(text: &str, expected: &str) {
            let said = read(text).unwrap_err();
            assert!(said.contains(expected), "{said}");
        }
        check("[(1, 2)]", "a point of 2 numbers: expected (x, y, z) in cm of head units");
        check("[(1, 2, 3, 1, 0, 0)]", "a point of 6 numbers");
        check("[(1, 2, 3, 1, 0, 0, 0, 0)]", "a point of 8 numbers");
        check("[(1, 2, 3, 1.5)]", "pressure 1.5 of a point is outside 0 to 1");
        check("[(1, 2, 3, 1, -1)]", "time -1 of a point is outside 0 to 100000");
        check("[(1, NaN, 3)]", "y NaN of a point is outside -100000 to 100000");
        check("[(1e30, 2, 3)]", "x ");
        check("[()]", "a point (x, y, z) in cm");
        check("[3]", "xpected a point (x, y, z) in cm");
        check("[(\"a\", 2, 3)]", "");
    }
}
