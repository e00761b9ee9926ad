//! Older formats to ours: one function for each step, on raw values.
//!
//! A step sees fields and entries as text that it moves, renames and rewrites; it does not know the
//! structs of any format, so these need not live on. A step `v1_to_v2` is a file of this folder, an
//! entry of [`STEPS`], and a sample of the old format in `samples/` that a test reads. Old *values*
//! need no step: inputs have old names and nodes have versions.

use super::scan::scan;
use crate::document::FileEntry;
use crate::text::in_words;
use crate::text::tokens::trimmed;
use crate::text::values::quoted;
use ron::value::RawValue;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::fmt;

#[cfg(test)]
mod tests;

/// One format to the next. The error says what of the file cannot be carried over.
pub(super) type FormatUpgrade = fn(&mut Raw) -> Result<(), String>;

/// The first format whose files are read, then a step for each later one.
///
/// None yet: format 1 is read as it is, for format 2 only puts more ways to say things beside its own.
pub(super) const STEPS: (u32, &[FormatUpgrade]) = (super::OLDEST, &[]);

/// A struct or a map whose values are RON text.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Raw {
    /// Names are strings in quotes, as in a map; words otherwise, as in a struct.
    is_map: bool,
    /// In the order of the file.
    pub(super) entries: Vec<(String, String)>,
}

impl Raw {
    /// The fields of `( ... )` or the entries of `{ ... }`.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        struct RawVisitor;
        impl<'de> Visitor<'de> for RawVisitor {
            type Value = Vec<(String, String)>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("fields or entries")
            }
            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Self::Value, M::Error> {
                let mut entries = vec![];
                while let Some(name) = map.next_key::<String>()? {
                    let value: &RawValue = map.next_value()?;
                    entries.push((name, trimmed(value.get_ron()).to_owned()));
                }
                Ok(entries)
            }
        }
        struct AnyEntries(Vec<(String, String)>);
        impl<'de> Deserialize<'de> for AnyEntries {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(RawVisitor).map(AnyEntries)
            }
        }
        let options = ron::Options::default().with_recursion_limit(64);
        let AnyEntries(entries) = options.from_str(text).map_err(|err| in_words(&err.code))?;
        Ok(Self { is_map: trimmed(text).starts_with('{'), entries })
    }

    /// As RON text again.
    pub(super) fn write(&self) -> String {
        let (open, close) = if self.is_map { ('{', '}') } else { ('(', ')') };
        let mut out = String::from(open);
        for (name, value) in &self.entries {
            out.push('\n');
            if self.is_map {
                quoted(&mut out, name)
            } else {
                out.push_str(name)
            }
            out.push_str(": ");
            out.push_str(value);
            out.push(',');
        }
        out.push('\n');
        out.push(close);
        out
    }

    /// The text of a value.
    pub(super) fn get_mut(&mut self, name: &str) -> Option<&mut String> {
        self.entries.iter_mut().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// Changes every value that is itself a struct or a map.
    #[cfg_attr(not(test), expect(dead_code, reason = "for steps; there are none yet"))]
    pub(super) fn each(
        &mut self,
        change: impl Fn(&str, &mut Raw) -> Result<(), String>,
    ) -> Result<(), String> {
        for (name, value) in &mut self.entries {
            let mut inner = Raw::read(value)?;
            change(name, &mut inner)?;
            *value = inner.write();
        }
        Ok(())
    }

    /// Gives an entry another name, in its place.
    #[cfg_attr(not(test), expect(dead_code, reason = "for steps; there are none yet"))]
    pub(super) fn rename(&mut self, from: &str, to: &str) {
        for (name, _) in self.entries.iter_mut().filter(|(name, _)| name == from) {
            *name = to.to_owned();
        }
    }
}

/// The format that a file says it has, and where it says so; none when it says none that is a
/// number.
pub(super) fn format_of(text: &str) -> Option<(u32, usize)> {
    let mut raw = Raw::read(text).ok()?;
    let format = raw.get_mut("format")?.parse().ok()?;
    let at = scan(text).values.get(&FileEntry::Field("format".to_owned())).copied();
    Some((format, at.unwrap_or_default()))
}

/// The text of a file of an older format in the newest that `steps` lead to.
pub(super) fn upgrade(
    text: &str,
    format: u32,
    (first, steps): (u32, &[FormatUpgrade]),
) -> Result<String, String> {
    let Some(skip) = format.checked_sub(first) else {
        return Err(format!("the file has format {format}, the oldest that is read is {first}"));
    };
    let mut raw = Raw::read(text)?;
    let mut reached = format;
    for step in steps.iter().skip(skip as usize) {
        step(&mut raw)
            .map_err(|reason| format!("format {reached} to {}: {reason}", reached + 1))?;
        reached += 1;
        if let Some(format) = raw.get_mut("format") {
            *format = reached.to_string();
        }
    }
    Ok(raw.write())
}
