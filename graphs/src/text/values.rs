//! Values as text, read by the type that the node's declaration names.

use super::order::{ITEMS, after, by_lot, in_order};
use super::tokens::{items, offset, trimmed};
use super::{gestures, in_words, place_of, strokes};
use crate::values::{DEEPEST_FIELD, fit, wrong_item};
use coif_nodes::data::field::Field;
use coif_nodes::data::gestures::Gestures;
use coif_nodes::data::ramp::{Blend, Ramp};
use coif_nodes::data::shapes::{ShapeList, Tier, TurnProfile};
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::{Type, Value, short};
use glam::{Vec2, Vec3};
use ron::value::RawValue;
use serde::Deserialize;
use std::fmt::Write as _;
use std::sync::Arc;

/// The deepest nesting of brackets in one value: deeper is an attack on a recursive reader.
const DEEPEST: usize = 64;

/// Reads what a command line or a table gives: RON, or for texts, choices and files a bare word. A whole number may have decimals
/// that are 0, as spreadsheets write it.
pub fn parse_value(ty: Type, text: &str) -> Result<Value, String> {
    let text = text.trim();
    if let (Type::Int, Some(whole)) = (ty, whole_number(text)) {
        return fit(ty, Value::Int(whole));
    }
    let bare = matches!(ty, Type::Text | Type::Choice(_) | Type::File)
        && !text.starts_with('"')
        && !text.starts_with("r\"")
        && !text.starts_with("r#");
    if bare { fit(ty, Value::Text(text.into())) } else { read_value(ty, text) }
}

/// The whole number that a text is, such as `50`, `50.0` or `5e1`.
pub fn whole_number(text: &str) -> Option<i64> {
    /// Beyond, not every whole number is a float.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    text.parse().ok().or_else(|| {
        let x: f64 = text.parse().ok()?;
        (x.fract() == 0.0 && x.abs() <= EXACT).then_some(x as i64)
    })
}

/// Reads RON text as an input of type `ty` would have it. The error names the text and says how it
/// is written.
pub fn read_value(ty: Type, text: &str) -> Result<Value, String> {
    placed_value(ty, text).map_err(|wrong| wrong.reason)
}

/// What is wrong with the text of a value.
pub(crate) struct Wrong {
    /// Where it is in the text, in bytes.
    pub(crate) at: usize,
    pub(crate) reason: String,
}

/// What is wrong with a value is wrong where it begins, unless somebody knows better.
impl From<String> for Wrong {
    fn from(reason: String) -> Self {
        Self { at: 0, reason }
    }
}

/// The same, with an error that also says where in the text it is.
pub(crate) fn placed_value(ty: Type, text: &str) -> Result<Value, Wrong> {
    let mut order = vec![];
    let value = value_of(ty, text, &mut order).map_err(|Wrong { at, reason }| {
        let (text, name) = (short(text), ty.name());
        Wrong { at, reason: format!("{text} is no {name}: {reason}; write it like {}", like(ty)) }
    })?;
    fit(ty, value.clone()).map_err(|reason| match wrong_item(ty, &value) {
        Some((n, reason)) => {
            let n = order.get(n).copied().unwrap_or(n);
            Wrong { at: items(text).get(n).copied().unwrap_or_default(), reason }
        }
        None => reason.into(),
    })
}

/// The same, with an error that says only what is wrong.
pub(crate) fn proven_value(ty: Type, text: &str) -> Result<Value, String> {
    fit(ty, value_of(ty, text, &mut vec![]).map_err(|wrong| wrong.reason)?)
}

/// How a value of the type is written.
fn like(ty: Type) -> &'static str {
    match ty {
        Type::Bool => "true",
        Type::Int => "3",
        Type::Float => "1.5",
        Type::Field => "1.5 or Smooth([(0.0, 1.0), (1.0, 0.3)])",
        Type::Vec3 | Type::Colour => "(0.0, 1.0, 0.0)",
        Type::Text | Type::Choice(_) | Type::File => "\"word\"",
        Type::Ramp => "1.5 or Linear([(0.0, 1.0), (1.0, 0.3)])",
        Type::Shapes => "[(A, Circle), (B, Ellipse(0.7))]",
        Type::Strokes => "[(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]",
        Type::Gestures => "the gestures of another groom",
        Type::Curves | Type::Scalp => "a wire",
    }
}

/// The value, and of what says in which order it comes the places in the text by these in the value.
fn value_of(ty: Type, text: &str, order: &mut Vec<usize>) -> Result<Value, Wrong> {
    Ok(match ty {
        Type::Bool => Value::Bool(parse(text)?),
        Type::Int => Value::Int(parse(text).map_err(|err| match number(text) {
            Ok(x) if x.trunc() != x => "it has decimals".to_owned(),
            Ok(_) if !err.contains("range") => "write it without a point".to_owned(),
            _ => err,
        })?),
        Type::Float => Value::Float(number(text)?),
        Type::Field => field(text, 1)?,
        Type::Vec3 | Type::Colour => {
            let (x, y, z) = parse(text)?;
            Value::Vec3(Vec3::new(x, y, z))
        }
        Type::Text | Type::Choice(_) | Type::File => Value::Text(parse::<String>(text)?.into()),
        Type::Ramp if is_number(text) => Value::from(Ramp::constant(number(text)?)),
        Type::Ramp => Value::from(parse::<FileRamp>(text)?.ramp()?),
        Type::Shapes => {
            let shapes: Vec<(FileTier, FileSection)> = parse(text)?;
            let shapes = shapes.into_iter().map(|(tier, section)| (tier.tier(), section.section()));
            Value::from(ShapeList(shapes.collect()))
        }
        Type::Strokes => {
            let (mut said, mut free) = (vec![], 0);
            let stroke = |_, one: strokes::FileStroke| {
                // One that has no id has the number that it stands at, from 1.
                free += 1;
                let id = one.id.unwrap_or(free);
                said.push((id, one.after));
                one.stroke(id)
            };
            let strokes = list(text, "stroke", stroke)?;
            *order = in_order(&said);
            Value::from(Strokes(arranged(strokes, order)))
        }
        Type::Gestures => {
            let mut said = vec![];
            let gesture = |n, one: gestures::FileGesture| {
                said.push((one.id, one.after));
                one.gesture(n)
            };
            let gestures = list(text, "gesture", gesture)?;
            *order = in_order(&said);
            Value::from(Gestures(arranged(gestures, order)))
        }
        Type::Curves | Type::Scalp => {
            return Err(format!("{} come by wire: connect a node", ty.name()).into());
        }
    })
}

fn arranged<T>(list: Vec<T>, order: &[usize]) -> Vec<T> {
    let mut list: Vec<Option<T>> = list.into_iter().map(Some).collect();
    order.iter().filter_map(|n| list[*n].take()).collect()
}

fn options() -> ron::Options {
    ron::Options::default().with_recursion_limit(DEEPEST)
}

fn parse<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    options().from_str(text).map_err(|err| in_words(&err.code))
}

/// Reads a list of what is long; what is wrong is found where it stands.
fn list<'a, F: Deserialize<'a>, T>(
    text: &'a str,
    item: &str,
    mut read: impl FnMut(usize, F) -> Result<T, String>,
) -> Result<Vec<T>, Wrong> {
    let files: Vec<F> = options().from_str(text).map_err(|err| {
        let at = offset(text, place_of(&err));
        let reason = in_words(&err.code);
        match items(text).partition_point(|start| *start <= at) {
            0 => Wrong { at, reason },
            n => Wrong { at, reason: format!("{item} {}: {reason}", n - 1) },
        }
    })?;
    let one = |(n, file): (usize, F)| {
        let place = |reason| Wrong { at: items(text).get(n).copied().unwrap_or_default(), reason };
        read(n, file).map_err(place)
    };
    files.into_iter().enumerate().map(one).collect()
}

fn number(text: &str) -> Result<f32, String> {
    let x: f32 = parse(text)?;
    if x.is_finite() { Ok(x) } else { Err("not a finite number".to_owned()) }
}

/// Whether RON text can be nothing but a number.
fn is_number(text: &str) -> bool {
    let text = trimmed(text);
    text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))
        || matches!(text, "NaN" | "inf")
}

#[derive(Deserialize)]
#[serde(rename = "ramp")]
enum FileRamp {
    Linear(Vec<(f32, f32)>),
    Smooth(Vec<(f32, f32)>),
    Step(Vec<(f32, f32)>),
}

impl FileRamp {
    fn ramp(self) -> Result<Ramp, String> {
        let (blend, stops) = match self {
            FileRamp::Linear(stops) => (Blend::Linear, stops),
            FileRamp::Smooth(stops) => (Blend::Smooth, stops),
            FileRamp::Step(stops) => (Blend::Step, stops),
        };
        Ramp::new(blend, stops).map_err(|err| err.to_string())
    }
}

#[derive(Deserialize)]
#[serde(rename = "field")]
enum FileField<'a> {
    Linear(Vec<(f32, f32)>),
    Smooth(Vec<(f32, f32)>),
    Step(Vec<(f32, f32)>),
    Attribute(String),
    Mask(String),
    #[serde(borrow)]
    Product(Vec<&'a RawValue>),
}

fn field(text: &str, depth: usize) -> Result<Value, String> {
    if depth > DEEPEST_FIELD {
        return Err(format!("products are nested deeper than {DEEPEST_FIELD}"));
    }
    if is_number(text) {
        return Ok(Value::Float(number(text)?));
    }
    let field = match parse::<FileField>(text)? {
        FileField::Linear(stops) => Field::Ramp(FileRamp::Linear(stops).ramp()?),
        FileField::Smooth(stops) => Field::Ramp(FileRamp::Smooth(stops).ramp()?),
        FileField::Step(stops) => Field::Ramp(FileRamp::Step(stops).ramp()?),
        FileField::Attribute(name) => Field::Attribute(name),
        FileField::Mask(name) => Field::Mask(name),
        FileField::Product(parts) => {
            let part = |part: &RawValue| match field(part.get_ron(), depth + 1)? {
                Value::Float(x) => Ok(Field::Constant(x)),
                Value::Field(field) => Ok(Arc::unwrap_or_clone(field)),
                other => Err(format!("a product of a {}", other.type_name())),
            };
            Field::Product(parts.into_iter().map(part).collect::<Result<_, String>>()?)
        }
    };
    Ok(Value::from(field))
}

#[derive(Deserialize)]
#[serde(rename = "tier")]
enum FileTier {
    A,
    B,
    C,
}

impl FileTier {
    fn tier(&self) -> Tier {
        match self {
            FileTier::A => Tier::A,
            FileTier::B => Tier::B,
            FileTier::C => Tier::C,
        }
    }
}

#[derive(Deserialize)]
#[serde(rename = "shape", deny_unknown_fields)]
enum FileSection {
    Circle,
    Ellipse(f32),
    Lame(f32),
    Polygon(u32),
    Rose { petals: u32, depth: f32 },
    Custom(Vec<(f32, f32)>),
}

impl FileSection {
    fn section(self) -> TurnProfile {
        match self {
            FileSection::Circle => TurnProfile::Circle,
            FileSection::Ellipse(ratio) => TurnProfile::Ellipse(ratio),
            FileSection::Lame(exponent) => TurnProfile::Lame(exponent),
            FileSection::Polygon(sides) => TurnProfile::Polygon(sides),
            FileSection::Rose { petals, depth } => TurnProfile::Rose { petals, depth },
            FileSection::Custom(points) => {
                TurnProfile::Custom(points.into_iter().map(|(x, y)| Vec2::new(x, y)).collect())
            }
        }
    }
}

/// Writes a value as RON, on one line.
pub fn write_value(value: &Value) -> String {
    let mut out = String::new();
    write_to(&mut out, value, None);
    out
}

/// Writes a value; shapes, strokes and gestures take a line each, led by `indent`, where there is one.
pub(crate) fn write_to(out: &mut String, value: &Value, indent: Option<usize>) {
    // Writing to a String cannot fail.
    let _ = match value {
        Value::Bool(on) => write!(out, "{on}"),
        Value::Int(x) => write!(out, "{x}"),
        Value::Float(x) => write!(out, "{x:?}"),
        Value::Vec3(v) => write!(out, "({:?}, {:?}, {:?})", v.x, v.y, v.z),
        Value::Text(text) => {
            quoted(out, text);
            Ok(())
        }
        Value::File(file) => {
            quoted(out, &file.path);
            Ok(())
        }
        Value::Field(field) => {
            write_field(out, field);
            Ok(())
        }
        Value::Ramp(ramp) => {
            write_ramp(out, ramp);
            Ok(())
        }
        Value::Shapes(shapes) => {
            write_list(out, &shapes.0, indent, |out, (tier, section)| {
                let _ = write!(out, "({tier:?}, ");
                write_section(out, section);
                out.push(')');
            });
            Ok(())
        }
        Value::Strokes(all) => {
            write_drawn(
                out,
                &all.0,
                indent,
                |one| one.id,
                |out, one, after| {
                    strokes::write(out, one, indent.map(|n| (n + 4, after)));
                },
            );
            Ok(())
        }
        Value::Gestures(all) => {
            write_drawn(
                out,
                &all.0,
                indent,
                |one| one.id,
                |out, one, after| {
                    gestures::write(out, one, indent.is_some(), after);
                },
            );
            Ok(())
        }
        // Never in a document: `fit` refuses them.
        Value::Curves(_) | Value::Scalp(_) => write!(out, "()"),
    };
}

fn write_list<T>(
    out: &mut String,
    items: &[T],
    indent: Option<usize>,
    one: impl Fn(&mut String, &T),
) {
    out.push('[');
    for (i, item) in items.iter().enumerate() {
        match indent {
            Some(n) => new_line(out, n + 4),
            None if i > 0 => out.push_str(", "),
            None => {}
        }
        one(out, item);
        if indent.is_some() {
            out.push(',');
        }
    }
    if let (Some(n), false) = (indent, items.is_empty()) {
        new_line(out, n);
    }
    out.push(']');
}

/// Writes what was drawn: on one line in its order, else by lot, each with what it comes after.
fn write_drawn<T>(
    out: &mut String,
    items: &[T],
    indent: Option<usize>,
    id: impl Fn(&T) -> u64,
    one: impl Fn(&mut String, &T, Option<u64>),
) {
    let Some(indent) = indent else {
        return write_list(out, items, None, |out, item| one(out, item, None));
    };
    let (placed, rest) = by_lot(0..items.len(), |n| id(&items[*n]).to_string(), ITEMS);
    let mut ranks = vec![0; items.len()];
    for (rank, (_, n)) in placed.iter().enumerate() {
        ranks[*n] = rank;
    }
    let said = after(&ranks);
    out.push('[');
    for (blank, n) in placed {
        out.extend(std::iter::repeat_n('\n', blank));
        new_line(out, indent + 4);
        one(out, &items[n], said[n].map(|after| id(&items[after])));
        out.push(',');
    }
    if !items.is_empty() {
        out.extend(std::iter::repeat_n('\n', rest));
        new_line(out, indent);
    }
    out.push(']');
}

pub(crate) fn new_line(out: &mut String, indent: usize) {
    out.push('\n');
    out.extend(std::iter::repeat_n(' ', indent));
}

fn write_field(out: &mut String, field: &Field) {
    match field {
        Field::Constant(x) => {
            let _ = write!(out, "{x:?}");
        }
        Field::Ramp(ramp) => write_ramp(out, ramp),
        Field::Attribute(name) => {
            out.push_str("Attribute(");
            quoted(out, name);
            out.push(')');
        }
        Field::Mask(name) => {
            out.push_str("Mask(");
            quoted(out, name);
            out.push(')');
        }
        // Never in a document: it comes by wire.
        Field::Painted(_) | Field::Texture(_) => out.push_str("0.0"),
        Field::Product(parts) => {
            out.push_str("Product(");
            write_list(out, parts, None, write_field);
            out.push(')');
        }
    }
}

fn write_ramp(out: &mut String, ramp: &Ramp) {
    let _ = write!(out, "{:?}(", ramp.blend);
    write_list(out, ramp.stops(), None, |out, (x, y)| {
        let _ = write!(out, "({x:?}, {y:?})");
    });
    out.push(')');
}

fn write_section(out: &mut String, section: &TurnProfile) {
    let _ = match section {
        TurnProfile::Circle => write!(out, "Circle"),
        TurnProfile::Ellipse(ratio) => write!(out, "Ellipse({ratio:?})"),
        TurnProfile::Lame(exponent) => write!(out, "Lame({exponent:?})"),
        TurnProfile::Polygon(sides) => write!(out, "Polygon({sides})"),
        TurnProfile::Rose { petals, depth } => {
            write!(out, "Rose(petals: {petals}, depth: {depth:?})")
        }
        TurnProfile::Custom(points) => {
            out.push_str("Custom(");
            write_list(out, points, None, |out, p| {
                let _ = write!(out, "({:?}, {:?})", p.x, p.y);
            });
            write!(out, ")")
        }
    };
}

/// A text in quotes. Line breaks and control characters are escaped: a text is one line of a file.
pub(crate) fn quoted(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{{{:x}}}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::testing::Random;
    use expect_test::{Expect, expect};

    const WORDS: Type = Type::Choice(&[("count", "a number"), ("spacing", "a distance")]);
    const TYPES: [Type; 13] = [
        Type::Bool,
        Type::Int,
        Type::Float,
        Type::Field,
        Type::Vec3,
        Type::Colour,
        Type::Text,
        WORDS,
        Type::File,
        Type::Ramp,
        Type::Shapes,
        Type::Strokes,
        Type::Gestures,
    ];

    #[test]
    fn random_values_of_every_type_come_back() {
        let mut random = Random::new(1);
        for ty in TYPES {
            for _ in 0..300 {
                let value = random.value(ty);
                let mut many_lines = String::new();
                write_to(&mut many_lines, &value, Some(16));
                for text in [write_value(&value), many_lines] {
                    let back = read_value(ty, &text).unwrap_or_else(|err| panic!("{err}\n{text}"));
                    assert_eq!(back.key(), value.key(), "{text}");
                    assert_eq!(back.type_name(), value.type_name(), "{text}");
                }
            }
        }
    }

    #[test]
    fn the_default_of_every_input_of_every_node_comes_back() {
        for input in coif_nodes::all().flat_map(|def| def.inputs) {
            if let Some(default) = input.default() {
                let value = fit(input.ty, default).unwrap();
                let back = read_value(input.ty, &write_value(&value)).unwrap();
                assert_eq!(back.key(), value.key(), "{}", input.name);
            }
        }
    }

    #[track_caller]
    fn reads(ty: Type, text: &str, as_written: &str) {
        let value = parse_value(ty, text).unwrap_or_else(|err| panic!("{err}"));
        assert_eq!(write_value(&value), as_written);
    }

    #[test]
    fn values_are_written_in_one_way() {
        reads(Type::Bool, "true", "true");
        reads(Type::Int, "-3", "-3");
        reads(Type::Float, "3", "3.0");
        reads(Type::Float, "0.1", "0.1");
        reads(Type::Float, "1e-7", "1e-7");
        reads(Type::Float, ".5", "0.5");
        reads(Type::Vec3, "(0, 1.5, -2)", "(0.0, 1.5, -2.0)");
        reads(Type::Colour, " ( 1 , 0 , 0 ) // red", "(1.0, 0.0, 0.0)");
        reads(Type::Field, "2", "2.0");
        reads(Type::Field, "Linear([(0, 1), (1, 0.35)])", "Linear([(0.0, 1.0), (1.0, 0.35)])");
        reads(Type::Field, "Mask(\"fringe\")", "Mask(\"fringe\")");
        reads(
            Type::Field,
            "Product([2, Attribute(\"frizz\"), Product([Smooth([(0.5, 1)])]),])",
            "Product([2.0, Attribute(\"frizz\"), Product([Smooth([(0.5, 1.0)])])])",
        );
        reads(Type::Ramp, "1", "Linear([(0.0, 1.0)])");
        reads(Type::Ramp, "Step([(0, 1)])", "Step([(0.0, 1.0)])");
        let shapes = "[(A, Circle), (B, Ellipse(0.7)), (C, Rose(petals: 5, depth: 0.3)), (B, Polygon(4)), \
                      (A, Lame(0.7)), (C, Custom([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]))]";
        reads(Type::Shapes, shapes, shapes);
        let strokes = "[(id: 7, points: [(1,0,0.01,0.5,0), (0.95,0,0.02,0.512,0.016)])]";
        reads(Type::Strokes, strokes, strokes);
        let columns = "[(id: 7, x: [100,-5], y: [0,0], z: [1,1], pressure: [128,3], time: [0,16])]";
        reads(Type::Strokes, columns, strokes);
        let more = "[(id: 7, points: [(1,0,0.01,0.5,0,-1,0.05)], drawn: (points: [(0.9,0,0.01,0.5), \
                    (0.95,0,0.02,0.504)]))]";
        reads(Type::Strokes, more, more);
        // By hand: ids are the numbers that they stand at, full pressure, no time.
        reads(
            Type::Strokes,
            "[(points: [(0, 9, 7.504)]), (points: [(1, 2, 3, 0.5)]), (points: [(1, 2, 3)], after: 1)]",
            "[(id: 1, points: [(0,9,7.5)]), (id: 3, points: [(1,2,3)]), (id: 2, points: [(1,2,3,0.5)])]",
        );
        let upright = "[(id: 7, x: [1], y: [0], z: [1], pressure: [1], time: [0], tilt_y: [0], drawn: (x: [], \
                       y: [], z: [], pressure: [], time: []))]";
        let short = "[(id: 7, points: [(0.01,0,0.01,0.004)])]";
        reads(Type::Strokes, upright, short);
    }

    #[test]
    fn a_bare_word_is_text_where_text_is_taken() {
        reads(Type::Text, "two words", "\"two words\"");
        reads(Type::Text, "\"quoted\"", "\"quoted\"");
        reads(Type::File, "heads/A-1.obj", "\"heads/A-1.obj\"");
        reads(WORDS, "spacing", "\"spacing\"");
        reads(WORDS, "\"spacing\"", "\"spacing\"");
        assert!(read_value(Type::Text, "word").is_err(), "not in files");
    }

    #[test]
    fn what_is_no_value_says_what_would_be() {
        #[track_caller]
        fn check(ty: Type, texts: &[&str], want: Expect) {
            let said = texts
                .iter()
                .map(|text| parse_value(ty, text).map(|v| write_value(&v)).unwrap_err());
            want.assert_eq(&said.collect::<Vec<_>>().join("\n"));
        }
        check(
            Type::Int,
            &["2.5", "three", "", "99999999999999999999", "3 4"],
            expect![[r#"
                2.5 is no whole number: it has decimals; write it like 3
                three is no whole number: expected a whole number; write it like 3
                 is no whole number: the text ends too early; write it like 3
                99999999999999999999 is no whole number: the number is out of range; write it like 3
                3 4 is no whole number: something stands behind its end; write it like 3"#]],
        );
        check(
            Type::Float,
            &["NaN", "-inf", "1e400", "\"1\"", "1.2.3"],
            expect![[r#"
                NaN is no number: not a finite number; write it like 1.5
                -inf is no number: not a finite number; write it like 1.5
                1e400 is no number: not a finite number; write it like 1.5
                "1" is no number: expected a number; write it like 1.5
                1.2.3 is no number: expected a number; write it like 1.5"#]],
        );
        check(
            Type::Field,
            &[
                "NaN",
                "Lineer([])",
                "Linear([])",
                "Linear([(1.0, 1.0), (0.0, 1.0)])",
                "Product([true])",
            ],
            expect![[r#"
                NaN is no field (number, ramp, attribute or mask): not a finite number; write it like 1.5 or Smooth([(0.0, 1.0), (1.0, 0.3)])
                Lineer([]) is no field (number, ramp, attribute or mask): unexpected variant named `Lineer` in enum `field`, expected one of `Linear`, `Smooth`, `Step`, `Attribute`, `Mask`, or `Product` instead; write it like 1.5 or Smooth([(0.0, 1.0), (1.0, 0.3)])
                Linear([]) is no field (number, ramp, attribute or mask): a ramp needs at least one stop, finite numbers, and positions from 0 to 1 that do not fall; write it like 1.5 or Smooth([(0.0, 1.0), (1.0, 0.3)])
                Linear([(1.0, 1.0), (0.0, 1.0)]) is no field (number, ramp, attribute or mask): a ramp needs at least one stop, finite numbers, and positions from 0 to 1 that do not fall; write it like 1.5 or Smooth([(0.0, 1.0), (1.0, 0.3)])
                Product([true]) is no field (number, ramp, attribute or mask): unexpected variant named `true` in enum `field`, expected one of `Linear`, `Smooth`, `Step`, `Attribute`, `Mask`, or `Product` instead; write it like 1.5 or Smooth([(0.0, 1.0), (1.0, 0.3)])"#]],
        );
        check(
            WORDS,
            &["spcing", "\"", "wide"],
            expect![[r#"
            "spcing" is none of count, spacing; did you mean "spacing"?
            " is no choice: expected end of string; write it like "word"
            "wide" is none of count, spacing"#]],
        );
        check(
            Type::Vec3,
            &["(1, 2)", "1", "(1, 2, inf)"],
            expect![[r#"
            (1, 2) is no vector: expected a tuple of size 3 but found 2 elements instead; write it like (0.0, 1.0, 0.0)
            1 is no vector: expected opening `(`; write it like (0.0, 1.0, 0.0)
            not a finite number"#]],
        );
        check(
            Type::Shapes,
            &["[]", "[(B, Circle)]", "[(A, Ellipse(3))]", "[(A, Rose(petals: 5, width: 1))]"],
            expect![[r#"
                a shape list needs at least one shape in tier A
                a shape list needs at least one shape in tier A
                Ellipse(3): the ratio runs from 0.01 to 1
                [(A, Rose(petals: 5, width: 1))] is no shape list: unexpected field named `width` in `Rose`, expected either `petals` or `depth` instead; write it like [(A, Circle), (B, Ellipse(0.7))]"#]],
        );
        check(
            Type::Strokes,
            &[
                "[(id: 1, x: [1,2], y: [1], z: [1], pressure: [1], time: [1])]",
                "[(id: 0, x: [1], y: [1], z: [1], pressure: [1], time: [1])]",
                "[(id: 1, x: [], y: [], z: [], pressure: [], time: [])]",
                "[(id: 1, x: [9223372036854775807], y: [1], z: [1], pressure: [1], time: [1])]",
                "[(id: 1, x: [1], y: [1], z: [1], pressure: [1], time: [1], tilt_x: [1,1])]",
                "[(id: 1, x: [1], y: [1], z: [1], pressure: [1], time: [1], drawn: (x: [1], y: [], z: [1], pressure: [1], time: [1]))]",
                "[(id: 1, points: [(1, 2, 3)], x: [1])]",
                "[(points: [(1, 2, 3)]), (points: [(1, 2)])]",
                "[(points: [(1, 2, 3, 2)])]",
                "[(id: 2, points: [(1, 2, 3)]), (points: [(1, 2, 3)])]",
                "[(after: 7)]",
            ],
            expect![[r#"
                [(id: 1, x: [1,2], y: [1], z: [1], pressure: [1], time: [1])… is no strokes: stroke 1: y has 1 samples, x has 2; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                stroke 0: its id 0 is 0 or used before
                a stroke has no samples
                [(id: 1, x: [9223372036854775807], y: [1], z: [1], pressure:… is no strokes: stroke 1: sample 0 is not on earth; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                [(id: 1, x: [1], y: [1], z: [1], pressure: [1], time: [1], t… is no strokes: stroke 1: tilt_x has 2 samples, x has 1; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                [(id: 1, x: [1], y: [1], z: [1], pressure: [1], time: [1], d… is no strokes: stroke 1 as drawn: y has 0 samples, x has 1; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                [(id: 1, points: [(1, 2, 3)], x: [1])] is no strokes: stroke 1: it has points and columns of numbers: keep one of them; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                [(points: [(1, 2, 3)]), (points: [(1, 2)])] is no strokes: stroke 1: a point of 2 numbers: expected (x, y, z) in cm of head units, then pressure (0 to 1), time (seconds) and tilt (two numbers), which may be left out; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                [(points: [(1, 2, 3, 2)])] is no strokes: stroke 0: pressure 2 of a point is outside 0 to 1; write it like [(points: [(0.0, 9.0, 7.5), (0.0, 10.5, 5.0)])]
                stroke 1: its id 2 is 0 or used before
                a stroke has no samples"#]],
        );
        check(
            Type::Curves,
            &["3"],
            expect!["3 is no curves: curves come by wire: connect a node; write it like a wire"],
        );
    }

    #[test]
    fn deep_products_are_refused_and_not_followed() {
        let deep = |n: usize| format!("{}1{}", "Product([".repeat(n), "])".repeat(n));
        assert!(read_value(Type::Field, &deep(DEEPEST_FIELD - 1)).is_ok());
        for n in [DEEPEST_FIELD, 31, 63, 100, 100_000] {
            let err = read_value(Type::Field, &deep(n)).unwrap_err();
            assert!(err.len() < 400, "{err}");
        }
    }

    #[test]
    fn a_stroke_takes_at_most_32_bytes_a_sample_and_42_with_tilt() {
        let found = [bytes_a_sample(|tilt| tilt * 0.0), bytes_a_sample(|tilt| tilt)];
        assert!(found[0] <= 32.0 && found[1] <= 42.0, "{found:?}");
    }

    fn bytes_a_sample(tilt: impl Fn(Vec2) -> Vec2) -> f32 {
        let (mut bytes, mut samples) = (0, 0);
        for seed in 0..40 {
            let mut pen = Random::new(seed).pen(300);
            pen.iter_mut().for_each(|sample| sample.tilt = tilt(sample.tilt));
            let stroke = crate::document::strokes::finish(&pen, &Strokes::default());
            let strokes = Strokes(stroke.into_iter().collect());
            samples += strokes.0[0].samples.len();
            let mut text = String::new();
            write_to(&mut text, &Value::from(strokes), Some(16));
            bytes += text.len();
            assert!(text.lines().all(|line| line.len() < 100));
        }
        bytes as f32 / samples as f32
    }
}
