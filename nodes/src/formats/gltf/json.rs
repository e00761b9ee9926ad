//! JSON as a flat list of values, small enough for any file.
//!
//! A value takes 16 bytes and an array or object knows where it ends, so a document costs at most 8
//! bytes for each byte of text. (The typed structs of the `gltf` crate take 400 bytes for a node
//! written as `{},`.) Lookups walk over what they skip, and are counted: see [`Doc::tire`].

use crate::data::mesh::MeshError;
use crate::formats::mesh_in::limits::{Budget, excerpt};
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::cell::Cell;
use std::fmt;

/// Members a reader may walk over in all lookups of one file: about a second. A file asks for more
/// only where many references lead into one huge object.
const MOST_STEPS: u64 = 100_000_000;

#[derive(Clone, Copy, Debug)]
enum Entry {
    Null,
    Bool(bool),
    Number(f64),
    /// A text of the source, by start and length.
    Text(u32, u32),
    /// A text that had escapes, in [`Doc::unescaped`].
    Unescaped(u32, u32),
    /// Where the values after it begin. In an object keys and values take turns.
    Array(u32),
    Object(u32),
}

/// A parsed document.
#[derive(Debug)]
pub(super) struct Doc<'a> {
    source: &'a str,
    entries: Vec<Entry>,
    unescaped: String,
    steps: Cell<u64>,
}

/// A value in a document.
#[derive(Clone, Copy, Debug)]
pub(super) struct JsonValue<'a> {
    doc: &'a Doc<'a>,
    at: u32,
}

impl<'a> Doc<'a> {
    /// Parses UTF-8 JSON; errors tell line and column.
    pub(super) fn parse(json: &'a [u8], budget: &mut Budget) -> Result<Self, MeshError> {
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let source = std::str::from_utf8(json).map_err(|e| {
            MeshError::at(format!("byte {}", e.valid_up_to()), "this is not UTF-8 text")
        })?;
        if u32::try_from(source.len()).is_err() {
            return Err(MeshError::at("file", "more than 4 GiB of JSON"));
        }
        let n = count_values(json);
        budget.take("JSON", 16 * n as u64 + 3 * source.len() as u64)?;
        let mut doc = Self {
            source,
            entries: Vec::with_capacity(n),
            unescaped: String::new(),
            steps: Cell::new(0),
        };
        let mut parser = serde_json::Deserializer::from_str(source);
        Add(&mut doc).deserialize(&mut parser).and_then(|()| parser.end()).map_err(|e| {
            let reason = e.to_string();
            // serde_json ends its messages with the place, which goes first here.
            let reason =
                reason.rsplit_once(" at line ").map_or(reason.as_str(), |(start, _)| start);
            let place = format!("line {} column {}", e.line(), e.column());
            MeshError::at(place, format!("this is not JSON: {reason}"))
        })?;
        Ok(doc)
    }

    pub(super) fn root(&'a self) -> JsonValue<'a> {
        JsonValue { doc: self, at: 0 }
    }

    /// Counts `n` steps more; an error once they are too many in all. To be called wherever a file
    /// can make us repeat ourselves.
    pub(super) fn tire(&self, n: u64) -> Result<(), MeshError> {
        self.steps.set(self.steps.get().saturating_add(n));
        if self.steps.get() > MOST_STEPS {
            return Err(MeshError::at("JSON", "its references are too many to follow"));
        }
        Ok(())
    }

    fn step(&self) {
        self.steps.set(self.steps.get() + 1);
    }

    fn after(&self, at: u32) -> u32 {
        match self.entries[at as usize] {
            Entry::Array(end) | Entry::Object(end) => end,
            _ => at + 1,
        }
    }
}

/// No fewer than the text has values and keys, and little more if it is JSON.
fn count_values(json: &[u8]) -> usize {
    let (mut n, mut in_text, mut escaped) = (1, false, false);
    for b in json {
        match b {
            _ if escaped => escaped = false,
            b'\\' => escaped = in_text,
            b'"' => in_text = !in_text,
            b',' | b':' | b'[' | b'{' if !in_text => n += 1,
            _ => {}
        }
    }
    n
}

impl<'a> JsonValue<'a> {
    fn entry(self) -> Entry {
        self.doc.entries[self.at as usize]
    }

    /// The position in the document, by which a value can be found again.
    pub(super) fn at(self) -> u32 {
        self.at
    }

    /// The value at a position that [`Self::at`] gave.
    pub(super) fn of(doc: &'a Doc<'a>, at: u32) -> Self {
        Self { doc, at }
    }

    /// A member of an object; nothing also for `null` and where this is no object.
    pub(super) fn get(self, key: &str) -> Option<JsonValue<'a>> {
        self.members().find(|(k, _)| *k == key).map(|(_, v)| v).filter(|v| !v.is_null())
    }

    pub(super) fn is_null(self) -> bool {
        matches!(self.entry(), Entry::Null)
    }

    pub(super) fn is_object(self) -> bool {
        matches!(self.entry(), Entry::Object(_))
    }

    pub(super) fn is_array(self) -> bool {
        matches!(self.entry(), Entry::Array(_))
    }

    pub(super) fn boolean(self) -> Option<bool> {
        match self.entry() {
            Entry::Bool(b) => Some(b),
            _ => None,
        }
    }

    pub(super) fn number(self) -> Option<f64> {
        match self.entry() {
            Entry::Number(n) => Some(n),
            _ => None,
        }
    }

    /// A whole number from 0, however it is written: `3`, `3.0` and `30e-1` are one.
    pub(super) fn whole(self) -> Option<u64> {
        const EXACT: f64 = 9_007_199_254_740_992.0;
        let n = self.number()?;
        (n.fract() == 0.0 && (0.0..EXACT).contains(&n)).then_some(n as u64)
    }

    pub(super) fn text(self) -> Option<&'a str> {
        let (whole, start, length) = match self.entry() {
            Entry::Text(start, length) => (self.doc.source, start, length),
            Entry::Unescaped(start, length) => (self.doc.unescaped.as_str(), start, length),
            _ => return None,
        };
        whole.get(start as usize..start as usize + length as usize)
    }

    /// The values of an array; none where this is no array.
    pub(super) fn items(self) -> Items<'a> {
        let end = match self.entry() {
            Entry::Array(end) => end,
            _ => 0,
        };
        Items { doc: self.doc, at: self.at + 1, end }
    }

    /// Keys and values of an object; none where this is no object.
    pub(super) fn members(self) -> impl Iterator<Item = (&'a str, JsonValue<'a>)> + use<'a> {
        let end = match self.entry() {
            Entry::Object(end) => end,
            _ => 0,
        };
        let doc = self.doc;
        let mut at = self.at + 1;
        std::iter::from_fn(move || {
            if at >= end {
                return None;
            }
            doc.step();
            let key = JsonValue { doc, at }.text().unwrap_or_default();
            let value = JsonValue { doc, at: at + 1 };
            at = doc.after(at + 1);
            Some((key, value))
        })
    }

    /// For messages: the value as it is written, shortened.
    pub(super) fn shown(self) -> String {
        match self.entry() {
            Entry::Null => "null".to_owned(),
            Entry::Bool(b) => b.to_string(),
            Entry::Number(n) => n.to_string(),
            Entry::Text(..) | Entry::Unescaped(..) => {
                format!("\"{}\"", excerpt(self.text().unwrap_or_default().as_bytes()))
            }
            Entry::Array(_) => "an array".to_owned(),
            Entry::Object(_) => "an object".to_owned(),
        }
    }
}

/// The values of an array that are still to come.
#[derive(Debug)]
pub(super) struct Items<'a> {
    doc: &'a Doc<'a>,
    at: u32,
    end: u32,
}

impl<'a> Iterator for Items<'a> {
    type Item = JsonValue<'a>;

    fn next(&mut self) -> Option<JsonValue<'a>> {
        if self.at >= self.end {
            return None;
        }
        self.doc.step();
        let item = JsonValue { doc: self.doc, at: self.at };
        self.at = self.doc.after(self.at);
        Some(item)
    }
}

/// Adds one value, whatever it is, to the list.
struct Add<'d, 'a>(&'d mut Doc<'a>);

impl Add<'_, '_> {
    fn push<E: Error>(self, entry: Entry) -> Result<(), E> {
        self.0.entries.push(entry);
        Ok(())
    }
}

impl<'a> DeserializeSeed<'a> for Add<'_, 'a> {
    type Value = ();

    fn deserialize<D: Deserializer<'a>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'a> Visitor<'a> for Add<'_, 'a> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.push(Entry::Null)
    }

    fn visit_bool<E: Error>(self, b: bool) -> Result<(), E> {
        self.push(Entry::Bool(b))
    }

    fn visit_u64<E: Error>(self, n: u64) -> Result<(), E> {
        self.push(Entry::Number(n as f64))
    }

    fn visit_i64<E: Error>(self, n: i64) -> Result<(), E> {
        self.push(Entry::Number(n as f64))
    }

    fn visit_f64<E: Error>(self, n: f64) -> Result<(), E> {
        self.push(Entry::Number(n))
    }

    fn visit_borrowed_str<E: Error>(self, text: &'a str) -> Result<(), E> {
        // A borrowed text is a piece of the source, so the difference is its position there.
        let start = (text.as_ptr() as usize).wrapping_sub(self.0.source.as_ptr() as usize);
        self.push(Entry::Text(start as u32, text.len() as u32))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        let start = self.0.unescaped.len();
        self.0.unescaped.push_str(text);
        self.push(Entry::Unescaped(start as u32, text.len() as u32))
    }

    fn visit_seq<S: SeqAccess<'a>>(self, mut items: S) -> Result<(), S::Error> {
        let at = self.0.entries.len();
        self.0.entries.push(Entry::Array(0));
        while items.next_element_seed(Add(self.0))?.is_some() {}
        self.0.entries[at] = Entry::Array(self.0.entries.len() as u32);
        Ok(())
    }

    fn visit_map<M: MapAccess<'a>>(self, mut members: M) -> Result<(), M::Error> {
        let at = self.0.entries.len();
        self.0.entries.push(Entry::Object(0));
        while members.next_key_seed(Add(self.0))?.is_some() {
            members.next_value_seed(Add(self.0))?;
        }
        self.0.entries[at] = Entry::Object(self.0.entries.len() as u32);
        Ok(())
    }
}

const _: () = assert!(size_of::<Entry>() == 16);

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(json: &str) -> Result<Doc<'_>, MeshError> {
        Doc::parse(json.as_bytes(), &mut Budget::new(json.len()))
    }

    #[test]
    fn values_are_found_by_key_and_order() {
        let json = r#" {"a":[1,[],{"b":{}},"c\n\u00e9"],"d":{"a":null},"e":-2.5,"f":true,"a":7} "#;
        let doc = parse(json).unwrap();
        let root = doc.root();
        let a: Vec<_> = root.get("a").unwrap().items().collect();
        assert_eq!(a.len(), 4);
        assert_eq!(a[0].whole(), Some(1));
        assert!(a[1].is_array() && a[1].items().next().is_none());
        assert!(a[2].get("b").unwrap().is_object());
        assert_eq!(a[3].text(), Some("c\né"));
        assert!(root.get("d").unwrap().get("a").is_none());
        assert_eq!(root.get("e").unwrap().number(), Some(-2.5));
        assert_eq!(root.get("f").unwrap().boolean(), Some(true));
        assert_eq!(root.get("e").unwrap().whole(), None);
        assert!(root.get("e").unwrap().get("x").is_none() && a[0].items().next().is_none());
        let keys: Vec<_> = root.members().map(|(k, _)| k).collect();
        assert_eq!(keys, ["a", "d", "e", "f", "a"]);
        assert_eq!(doc.entries.len(), 19);
        assert!(doc.entries.capacity() < 30);
    }

    #[test]
    fn whole_numbers_may_be_written_as_fractions() {
        for (json, whole) in [
            ("3.0", Some(3)),
            ("30e-1", Some(3)),
            ("-0", Some(0)),
            ("0.5", None),
            ("-1", None),
            ("1e300", None),
            ("\"3\"", None),
            ("18446744073709551615", None),
        ] {
            assert_eq!(parse(json).unwrap().root().whole(), whole, "{json}");
        }
    }

    #[test]
    fn errors_tell_the_place() {
        let deep = "[".repeat(200);
        for (json, says) in [
            ("", "line 1 column 0: this is not JSON: EOF while parsing a value"),
            ("{\n 'a'", "line 2 column 2: this is not JSON: key must be a string"),
            ("{} x", "line 1 column 4: this is not JSON: trailing characters"),
            ("[1e999]", "line 1 column 6: this is not JSON: number out of range"),
            (deep.as_str(), "line 1 column 128: this is not JSON: recursion limit exceeded"),
        ] {
            assert_eq!(parse(json).unwrap_err().to_string(), says);
        }
        let e = Doc::parse(b"{\"\xff\"}", &mut Budget::new(0)).unwrap_err();
        assert_eq!(e.to_string(), "byte 2: this is not UTF-8 text");
    }

    #[test]
    fn endless_lookups_end() {
        let doc = parse("[0]").unwrap();
        assert!(doc.tire(0).is_ok());
        doc.tire(MOST_STEPS).unwrap();
        let _ = doc.root().items().next();
        assert!(doc.tire(0).is_err());
    }
}
