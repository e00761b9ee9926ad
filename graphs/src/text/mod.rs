//! RON made for people and for git: values, each read by the type that a node's declaration names, and what all of our text has in
//! common: its tokens and comments (`tokens.rs`), its order (`order.rs`), and errors in words.
//!
//! Guarantees: what is written reads back the same, to the bit; for any text an answer comes, without a panic, and says what is wrong
//! and what was expected. Nothing here knows a document or opens a file.

mod columns;
mod gestures;
pub(crate) mod order;
mod points;
mod strokes;
pub(crate) mod tokens;
pub(crate) mod values;

pub(crate) use values::proven_value;
pub use values::{parse_value, read_value, whole_number, write_value};

use coif_nodes::define::short;
use ron::value::RawValue;
use tokens::trimmed;

/// The deepest nesting of brackets in a file: ours has 8, and 2 more for each group within a group; what is deeper is an attack on a
/// recursive reader.
pub(crate) const DEEPEST_IN_FILE: usize = 128;
/// What of it is left within the value of an input: groups within groups have two brackets each.
const DEEPEST_VALUE: usize = 56;

/// Whether a file can hold the text as the value of an input and give it back; else why not.
pub(crate) fn prove_raw(text: &str) -> Result<(), String> {
    let options = ron::Options::default().with_recursion_limit(DEEPEST_VALUE);
    let read = options.from_str::<&RawValue>(text).map_err(|err| in_words(&err.code));
    if read.is_err() || trimmed(text) != text || text.starts_with('#') {
        let why = read.err().unwrap_or_else(|| "something stands around it".to_owned());
        let text = short(text);
        return Err(format!("{text} is no value that a file can hold: {why}"));
    }
    Ok(())
}

/// An error of the RON reader as one line of ours.
pub(crate) fn in_words(err: &ron::Error) -> String {
    let text = match err {
        ron::Error::TrailingCharacters => "something stands behind its end".to_owned(),
        ron::Error::ExpectedNamedStructLike("Groom")
        | ron::Error::ExpectedDifferentStructName { expected: "Groom", .. } => {
            "not a groom: a groom begins with `(`".to_owned()
        }
        ron::Error::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
        ron::Error::DuplicateStructField { field, .. } => {
            format!("the field `{field}` stands here twice: keep one of them")
        }
        ron::Error::ExpectedFloat => "expected a number".to_owned(),
        ron::Error::ExpectedInteger => "expected a whole number".to_owned(),
        ron::Error::IntegerOutOfBounds => "the number is out of range".to_owned(),
        ron::Error::Eof => "the text ends too early".to_owned(),
        ron::Error::ExceededRecursionLimit => "brackets are nested too deeply".to_owned(),
        err => err.to_string(),
    };
    let mut chars = text.chars();
    let lower = chars.next().map(|c| c.to_lowercase().chain(chars).collect());
    let text: String = lower.unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Line and column of an error of the RON reader.
pub(crate) fn place_of(err: &ron::error::SpannedError) -> (usize, usize) {
    use ron::Error as E;
    let named = matches!(
        err.code,
        E::NoSuchStructField { .. } | E::DuplicateStructField { .. } | E::Message(_)
    );
    let place = if named { err.span.start } else { err.span.end };
    (place.line, place.col)
}

/// What may lack, without the `Some` that RON asks for.
pub(crate) fn there<'de, D: serde::Deserializer<'de>, T: serde::Deserialize<'de>>(
    from: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(from).map(Some)
}
