//! Gestures as text: their samples and path in columns of whole steps of the grid (1/8 pixel, 1/256 of
//! pressure, 1 ms, 1/64 of a right angle; 1/10000 head unit), all else as it is. What has its default is
//! left out.

use super::columns::{Columns, numbers};
use super::there;
use crate::values::grid::{point_of, point_steps, sample_of, sample_steps};
use crate::values::no_such_word;
use coif_nodes::data::gestures::{Gesture, GestureView, Layer, Tool};
use glam::Vec3;
use serde::Deserialize;
use std::fmt::Write as _;

#[derive(Deserialize)]
#[serde(rename = "gesture", deny_unknown_fields)]
pub(super) struct FileGesture {
    pub(super) id: u64,
    /// Behind which other gesture of the list it comes.
    #[serde(default, deserialize_with = "there")]
    pub(super) after: Option<u64>,
    tool: String,
    layer: String,
    eye: [f32; 3],
    target: [f32; 3],
    up: [f32; 3],
    half_height: f32,
    #[serde(default)]
    parallel: bool,
    pixels: f32,
    x: Vec<i64>,
    y: Vec<i64>,
    pressure: Vec<i64>,
    time: Vec<i64>,
    #[serde(default)]
    tilt_x: Vec<i64>,
    #[serde(default)]
    tilt_y: Vec<i64>,
    #[serde(default)]
    curves: Vec<u64>,
    #[serde(default, deserialize_with = "there")]
    root: Option<[f32; 3]>,
    #[serde(default)]
    path_x: Vec<i64>,
    #[serde(default)]
    path_y: Vec<i64>,
    #[serde(default)]
    path_z: Vec<i64>,
    #[serde(default, deserialize_with = "there")]
    colour: Option<[f32; 3]>,
    #[serde(default)]
    size: f32,
    #[serde(default = "one")]
    strength: f32,
}

fn one() -> f32 {
    1.0
}

const SAMPLES: Columns<6> = Columns {
    names: ["x", "y", "pressure", "time", "tilt_x", "tilt_y"],
    optional: 4,
    row: "sample",
};
const PATH: Columns<3> =
    Columns { names: ["path_x", "path_y", "path_z"], optional: 3, row: "point" };
/// Ids on one line: they have up to 20 digits.
const IDS_A_LINE: usize = 4;

impl FileGesture {
    /// The gesture; else what is wrong with it, the `n`th of its list.
    pub(super) fn gesture(self, n: usize) -> Result<Gesture, String> {
        let none = |what: &str, word: &str, known: &[&'static str]| {
            format!("gesture {n}: its {what} {}", no_such_word(word, known))
        };
        let tool = Tool::named(&self.tool).ok_or_else(|| {
            none("tool", &self.tool, &Tool::ALL.iter().map(|t| t.1).collect::<Vec<_>>())
        })?;
        let layer = Layer::named(&self.layer).ok_or_else(|| {
            none("layer", &self.layer, &Layer::ALL.iter().map(|l| l.1).collect::<Vec<_>>())
        })?;
        let wrong = |reason: String| format!("gesture {n} ({}): {reason}", tool.word());
        let Self { x, y, pressure, time, tilt_x, tilt_y, path_x, path_y, path_z, .. } = self;
        let samples = SAMPLES.rows([x, y, pressure, time, tilt_x, tilt_y]).map_err(wrong)?;
        let path = PATH.rows([path_x, path_y, path_z]).map_err(wrong)?;
        Ok(Gesture {
            id: self.id,
            tool,
            layer,
            view: GestureView {
                eye: self.eye.into(),
                target: self.target.into(),
                up: self.up.into(),
                half_height: self.half_height,
                parallel: self.parallel,
                pixels: self.pixels,
            },
            samples: samples.into_iter().map(sample_of).collect(),
            curves: self.curves,
            root: self.root.map(Vec3::from),
            path: path.into_iter().map(point_of).collect(),
            colour: self.colour.map(Vec3::from),
            size: self.size,
            strength: self.strength,
        })
    }
}

/// Writes a gesture, on one line or on many.
pub(super) fn write(out: &mut String, gesture: &Gesture, lines: bool, after: Option<u64>) {
    let Gesture { id, tool, layer, view, samples, curves, root, path, colour, size, strength } =
        gesture;
    let space = if lines { '\n' } else { ' ' };
    let _ = write!(out, "(id: {id},{space}");
    if let Some(after) = after {
        let _ = write!(out, "after: {after},{space}");
    }
    let _ = write!(out, "tool: {:?}, layer: {:?},{space}", tool.word(), layer.word());
    let _ = write!(out, "eye: {}, target: {},{space}", vector(view.eye), vector(view.target));
    let _ = write!(out, "up: {}, half_height: {:?}, ", vector(view.up), view.half_height);
    if view.parallel {
        out.push_str("parallel: true, ");
    }
    let _ = write!(out, "pixels: {:?}, ", view.pixels);
    SAMPLES.write(out, &samples.iter().map(sample_steps).collect::<Vec<_>>(), lines);
    if !curves.is_empty() {
        out.push_str(", curves: [");
        numbers(out, curves.iter(), IDS_A_LINE, lines);
    }
    if let Some(root) = root {
        let _ = write!(out, ", root: {}", vector(*root));
    }
    if !path.is_empty() {
        out.push_str(", ");
        PATH.write(out, &path.iter().map(|p| point_steps(*p)).collect::<Vec<_>>(), lines);
    }
    if let Some(colour) = colour {
        let _ = write!(out, ", colour: {}", vector(*colour));
    }
    // By bits: -0.0 is not the 0.0 that is left out.
    for (name, x, default) in [("size", size, 0.0f32), ("strength", strength, one())] {
        if x.to_bits() != default.to_bits() {
            let _ = write!(out, ", {name}: {x:?}");
        }
    }
    out.push(')');
}

fn vector(v: Vec3) -> String {
    format!("({:?}, {:?}, {:?})", v.x, v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::super::values::{placed_value, read_value, write_to, write_value};
    use super::*;
    use crate::document::gestures::finish;
    use crate::document::testing::Random;
    use coif_nodes::data::gestures::Gestures;
    use coif_nodes::define::{Type, Value};
    use glam::Vec2;

    /// What a gesture is that has nothing that may be left out.
    const LEAST: &str = "(id: 7, tool: \"comb\", layer: \"through\", eye: (0.0, 0.0, 60.0), \
         target: (0.0, 0.0, 0.0), up: (0.0, 1.0, 0.0), half_height: 0.25, pixels: 1000.0, x: [0,800], y: [-8,0], \
         pressure: [128,0], time: [0,250])";

    fn read(text: &str) -> Gestures {
        match read_value(Type::Gestures, text).unwrap_or_else(|err| panic!("{err}\n{text}")) {
            Value::Gestures(all) => (*all).clone(),
            other => panic!("{other:?}"),
        }
    }
    /// The least gesture, with a part of its text replaced.
    fn with(from: &str, to: &str) -> String {
        assert!(LEAST.contains(from), "{from}");
        LEAST.replace(from, to)
    }

    #[test]
    fn what_has_its_default_is_left_out_and_all_else_is_written_in_one_way() {
        #[track_caller]
        fn check(text: &str, as_written: &str) {
            let gestures = Value::from(read(&format!("[{text}]")));
            assert_eq!(write_value(&gestures), format!("[{as_written}]"));
        }
        check(LEAST, LEAST);
        let defaults = "250], tilt_x: [0,0], curves: [], path_x: [], size: 0, strength: 1)";
        check(&with("250])", defaults), LEAST);
        check(&with("pixels", "parallel: false, pixels"), LEAST);
        let all = "250], tilt_x: [3,1], tilt_y: [0,-1], curves: [18446744073709551615,1], \
                   root: (-0.0, 8.9, 1e-7), path_x: [1,-2], path_y: [0,5], path_z: [0,0], \
                   colour: (0.1, 0.0, 2.0), size: 0.1, strength: -0.0)";
        check(&with("250])", all), &with("250])", all));
        let parallel = with("pixels: 1000.0", "parallel: true, pixels: 333.3");
        check(&parallel, &parallel);
        // A list of none.
        check("", "");
    }

    #[test]
    fn numbers_are_steps_of_the_grid_from_the_one_before() {
        // 800 eighths of a pixel right of 0; 128 of 256; 250 ms; a path's 10000 to a unit.
        let text = with(
            "250])",
            "250], tilt_x: [-64,32], path_x: [5,10000], path_y: [0,0], path_z: [0,0])",
        );
        let gesture = &read(&format!("[{text}]")).0[0];
        let [first, last] = [gesture.samples[0], gesture.samples[1]];
        assert_eq!((first.at.to_array(), last.at.to_array()), ([0.0, -1.0], [100.0, -1.0]));
        assert_eq!((last.pressure, last.time), (0.5, 0.25));
        assert_eq!((first.tilt.x, last.tilt.x), (-1.0, -0.5));
        assert_eq!((gesture.path[0].x, gesture.path[1].x), (0.0005, 1.0005));
    }

    #[test]
    fn what_is_wrong_is_said_of_its_gesture_and_found_on_its_line() {
        /// The second of three gestures, which begins on line 3, is `text`.
        #[track_caller]
        fn check(text: &str, line: usize, expected: &str) {
            let third = LEAST.replace("id: 7", "id: 9");
            let list = format!("[\n{LEAST}, // the first\n{text},\n{third}]");
            let wrong = placed_value(Type::Gestures, &list).map(|v| write_value(&v)).unwrap_err();
            let found = list[..wrong.at].matches('\n').count() + 1;
            assert_eq!(found, line, "{}", wrong.reason);
            let said = wrong.reason.split_once(" is no gestures: ").map_or(&*wrong.reason, |s| s.1);
            let said = said.trim_end_matches("; write it like the gestures of another groom");
            assert_eq!(said, expected);
        }
        let second = |from: &str, to: &str| with(from, to).replace("id: 7", "id: 8");
        check(
            &second("\"comb\"", "\"combe\""),
            3,
            "gesture 1: its tool \"combe\" is none of implant, lengthen, cut, density, twist, frizz, comb, \
             pin, smooth, puff, grab, straighten, point, redraw, scatter, silhouette; did you mean \"comb\"?",
        );
        check(
            &second("\"through\"", "\"skin\""),
            3,
            "gesture 1: its layer \"skin\" is none of nearest, through, scalp",
        );
        check(&second("x: [0,800]", "x: [0]"), 3, "gesture 1 (comb): y has 2 samples, x has 1");
        check(
            &second("250])", "250], tilt_y: [1])"),
            3,
            "gesture 1 (comb): tilt_y has 1 samples, x has 2",
        );
        check(
            &second("250])", "250], path_x: [1])"),
            3,
            "gesture 1 (comb): path_y has 0 points, path_x has 1",
        );
        check(
            &second("[0,800]", "[9223372036854775807,9223372036854775807]"),
            3,
            "gesture 1 (comb): sample 0 is not on earth",
        );
        check(
            &second("[0,800]", "[0,800001]"),
            3,
            "gesture 1 (comb): sample 1 is 100000 pixels and more off",
        );
        check(
            &second("250])", "250], path_x: [1], path_y: [0], path_z: [1000100000])"),
            3,
            "gesture 1 (comb): point 0 of its path is not on earth",
        );
        let none = "(id: 8, tool: \"pin\", layer: \"scalp\", eye: (0.0, 0.0, 60.0), target: (0.0, 0.0, 0.0), \
                    up: (0.0, 1.0, 0.0), half_height: 0.25, pixels: 9.0, x: [], y: [], pressure: [], time: [])";
        check(none, 3, "gesture 1 (pin): it has no samples");
        check(
            &second("(0.0, 1.0, 0.0)", "(0.0, 0.0, 5.0)"),
            3,
            "gesture 1 (comb): the up of its view lies along the view",
        );
        check(&second("60.0)", "inf)"), 3, "gesture 1 (comb): its view is not on earth");
        check(LEAST, 3, "gesture 1: its id 7 is 0 or used before");
        // A number on a line of its own is found there.
        check(&second("y: [-8,0]", "y: [\n-8,\nx]"), 5, "gesture 1: expected a whole number");
        check(&second("id: 7", "id: -7"), 3, "gesture 1: the number is out of range");
        check(&second("pixels: 1000.0, ", ""), 3, "gesture 1: the field `pixels` is missing");
        let names = second("time:", "\nwhen:").replace("through", "scalp");
        let wrong = placed_value(Type::Gestures, &format!("[{names}]")).map(|_| ()).unwrap_err();
        assert!(wrong.reason.contains("gesture 0: unexpected field named `when` in `gesture`"));
    }

    #[test]
    fn broken_gestures_give_an_error_or_what_comes_back() {
        let mut random = Random::new(77);
        let pieces = [
            "(",
            ")",
            "[",
            "]",
            ",",
            ",,",
            ":",
            "//",
            "/*",
            "\"",
            "-",
            "1e39",
            "NaN",
            "id: 7",
            "\n",
            "99999999999",
            "1",
            "0",
            "2",
            " ",
            "3",
        ];
        let (mut refused, mut read_well) = (0, 0);
        for round in 0..600 {
            let others = Gestures::default();
            let all = Gestures(vec![random.gesture(&others)]);
            let mut text = String::new();
            write_to(&mut text, &all.into(), (round % 2 == 0).then_some(4));
            for _ in 0..1 + random.below(2) {
                let from = random.below(text.len());
                let to = (from + random.below(3)).min(text.len());
                text.replace_range(from..to, random.pick(&pieces));
            }
            match placed_value(Type::Gestures, &text) {
                Err(wrong) => {
                    assert!(wrong.at <= text.len() && text.is_char_boundary(wrong.at));
                    assert!(!wrong.reason.contains('\n') && wrong.reason.len() < 1000);
                    refused += 1;
                }
                Ok(value) => {
                    let back = read_value(Type::Gestures, &write_value(&value)).unwrap();
                    assert_eq!(back.key(), value.key(), "{text}");
                    read_well += 1;
                }
            }
        }
        assert!(refused > 100 && read_well > 20, "{refused} {read_well}");
    }

    #[test]
    fn a_gesture_takes_at_most_40_bytes_a_sample() {
        // A comb, loops that turn a cluster of given curves, and an implant with its path.
        let (mut bytes, mut samples) = ([0; 3], [0; 3]);
        for seed in 0..30 {
            let mut random = Random::new(seed);
            let mut gesture = random.gesture(&Gestures::default());
            gesture.samples = random.pen_on_picture(300);
            (gesture.tool, gesture.path, gesture.curves) = (Tool::Comb, vec![], vec![]);
            (gesture.root, gesture.colour) = (None, None);
            match seed % 3 {
                0 => {}
                1 => {
                    gesture.tool = Tool::Twist;
                    gesture.curves = vec![random.bits()];
                    // Two turns and a half of 60 pixels around the arc.
                    let mut arm = Vec2::X * 60.0;
                    for sample in &mut gesture.samples {
                        arm = Vec2::new(0.998_63, 0.052_336).rotate(arm);
                        sample.at += arm;
                    }
                }
                _ => {
                    gesture.tool = Tool::Implant;
                    gesture.root = Some(Vec3::new(1.234_567_8, 7.654_321, -3.456_789));
                    gesture.colour = Some(Vec3::new(0.12, 0.05, 0.02));
                }
            }
            let mut gesture = finish(gesture, &Gestures::default()).unwrap();
            if gesture.tool == Tool::Implant {
                // A point for each sample but the first, on the grid.
                let point = |s: &coif_nodes::data::gestures::PenSample| s.at.extend(s.at.x) / 40.0;
                gesture.path = gesture.samples[1..].iter().map(point).collect();
            }
            samples[seed as usize % 3] += gesture.samples.len();
            let mut text = String::new();
            write_to(&mut text, &Gestures(vec![gesture]).into(), Some(16));
            bytes[seed as usize % 3] += text.len();
            assert!(text.lines().all(|line| line.len() < 120), "{text}");
        }
        for (bytes, samples) in bytes.into_iter().zip(samples) {
            let each = bytes as f32 / samples as f32;
            assert!(each <= 40.0, "{each} bytes a sample, {samples} samples");
        }
    }
}
