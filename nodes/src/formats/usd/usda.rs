//! Writes a layer as text (`.usda`), streaming.
//!
//! Guaranteed: the same layer gives the same bytes, and every number reads back to the same bits
//! (floats are written with the fewest digits that do so), but for the payload of NaNs.

use super::super::{Chunks, FormatError};
use super::spec::{
    AttributeSpec, MetadataField, PrimSpec, PropertySpec, UsdLayer, UsdValue, Variability,
    check_text,
};
use glam::{Vec2, Vec3};
use std::fmt::Write as _;
use std::io::Write;

/// Output is handed on in pieces of this many bytes.
const BUFFER: usize = 1 << 18;

/// Writes the layer.
///
/// # Errors
/// The output failed, or a text holds a NUL.
pub fn write(layer: &UsdLayer, out: &mut (impl Write + ?Sized)) -> Result<(), FormatError> {
    let mut text = TextWriter { out, buffer: String::with_capacity(BUFFER + 64), depth: 0 };
    text.layer(layer)?;
    text.hand_on()?;
    Ok(out.flush()?)
}

struct TextWriter<'o, W: Write + ?Sized> {
    out: &'o mut W,
    /// Text not handed on yet. A string, as numbers are formatted faster into one than into a stream.
    buffer: String,
    /// How many prims are open around the line being written.
    depth: usize,
}

type Done = Result<(), FormatError>;

impl<W: Write + ?Sized> TextWriter<'_, W> {
    fn put(&mut self, text: &str) -> Done {
        self.buffer.push_str(text);
        if self.buffer.len() < BUFFER { Ok(()) } else { self.hand_on() }
    }

    fn hand_on(&mut self) -> Done {
        self.out.write_all(self.buffer.as_bytes())?;
        self.buffer.clear();
        Ok(())
    }

    /// A number as Rust writes it, which for floats is the shortest text that reads back equal.
    fn number(&mut self, number: impl std::fmt::Display) -> Done {
        // Writing to a string cannot fail.
        let _ = write!(self.buffer, "{number}");
        Ok(())
    }

    /// Starts a line inside `levels` more brackets than the prims that are open.
    fn indent(&mut self, levels: usize) -> Done {
        (0..self.depth + levels).try_for_each(|_| self.put("    "))
    }

    fn layer(&mut self, layer: &UsdLayer) -> Done {
        self.put("#usda 1.0\n")?;
        self.metadata(&layer.fields)?;
        self.put("\n")?;
        for prim in &layer.prims {
            self.put("\n")?;
            self.prim(prim)?;
        }
        Ok(())
    }

    fn prim(&mut self, prim: &PrimSpec) -> Done {
        self.indent(0)?;
        self.put("def ")?;
        if !prim.type_name.is_empty() {
            self.put(prim.type_name)?;
            self.put(" ")?;
        }
        self.text(&prim.name)?;
        if !prim.fields.is_empty() {
            self.put(" ")?;
            self.metadata(&prim.fields)?;
        }
        self.put("\n")?;
        self.indent(0)?;
        self.put("{\n")?;
        self.depth += 1;
        for property in &prim.properties {
            self.property(property)?;
        }
        for (index, child) in prim.children.iter().enumerate() {
            if index > 0 || !prim.properties.is_empty() {
                self.put("\n")?;
            }
            self.prim(child)?;
        }
        self.depth -= 1;
        self.indent(0)?;
        self.put("}\n")
    }

    fn metadata(&mut self, fields: &[MetadataField]) -> Done {
        self.put("(\n")?;
        for (name, value) in fields {
            self.indent(1)?;
            if matches!(value, UsdValue::TokensPrepended(_)) {
                self.put("prepend ")?;
            }
            // The one field whose name differs between the two forms of the file.
            self.put(if *name == "documentation" { "doc" } else { name })?;
            self.put(" = ")?;
            self.value(value)?;
            self.put("\n")?;
        }
        self.indent(0)?;
        self.put(")")
    }

    fn property(&mut self, property: &PropertySpec) -> Done {
        match property {
            PropertySpec::Attribute(attribute) => self.attribute(attribute),
            PropertySpec::Relationship { name, targets } => {
                self.indent(0)?;
                self.put("rel ")?;
                self.put(name)?;
                self.put(" = ")?;
                self.paths(targets)?;
                self.put("\n")
            }
        }
    }

    /// One line for each of default value, time samples and connections, or one that declares.
    fn attribute(&mut self, attribute: &AttributeSpec) -> Done {
        let only_declared = attribute.samples.is_empty() && attribute.connections.is_empty();
        if attribute.default.is_some() || only_declared {
            self.declaration(attribute)?;
            if let Some(value) = &attribute.default {
                self.put(" = ")?;
                self.value(value)?;
            }
            self.interpolation(attribute)?;
        }
        if !attribute.samples.is_empty() {
            self.declaration(attribute)?;
            self.put(".timeSamples = ")?;
            self.samples(&attribute.samples)?;
            if attribute.default.is_none() {
                // Metadata may follow any of the lines, but only one of them.
                self.interpolation(attribute)?;
            } else {
                self.put("\n")?;
            }
        }
        if !attribute.connections.is_empty() {
            self.declaration(attribute)?;
            self.put(".connect = ")?;
            self.paths(&attribute.connections)?;
            self.put("\n")?;
        }
        Ok(())
    }

    fn declaration(&mut self, attribute: &AttributeSpec) -> Done {
        self.indent(0)?;
        if attribute.variability == Variability::Uniform {
            self.put("uniform ")?;
        }
        self.put(attribute.type_name)?;
        self.put(" ")?;
        self.put(&attribute.name)
    }

    fn interpolation(&mut self, attribute: &AttributeSpec) -> Done {
        match attribute.interpolation {
            Some(interpolation) => {
                self.put(" (\n")?;
                self.indent(1)?;
                self.put("interpolation = ")?;
                self.text(interpolation)?;
                self.put("\n")?;
                self.indent(0)?;
                self.put(")\n")
            }
            None => self.put("\n"),
        }
    }

    fn samples(&mut self, samples: &[(f64, UsdValue)]) -> Done {
        self.put("{\n")?;
        for (time, value) in samples {
            self.indent(1)?;
            self.double(*time)?;
            self.put(": ")?;
            self.value(value)?;
            self.put(",\n")?;
        }
        self.indent(0)?;
        self.put("}")
    }

    fn paths(&mut self, paths: &[String]) -> Done {
        match paths {
            [path] => self.path(path),
            _ => self.list(paths.iter(), |text, path| text.path(path)),
        }
    }

    fn path(&mut self, path: &str) -> Done {
        self.put("<")?;
        self.put(check_text(path)?)?;
        self.put(">")
    }

    fn value(&mut self, value: &UsdValue) -> Done {
        match value {
            UsdValue::Bool(value) => self.put(if *value { "true" } else { "false" }),
            UsdValue::Int(value) => self.number(*value),
            UsdValue::Int64(value) => self.number(*value),
            UsdValue::UInt64(value) => self.number(*value),
            UsdValue::Float(value) => self.float(*value),
            UsdValue::Double(value) => self.double(*value),
            UsdValue::String(text) | UsdValue::Token(text) => self.text(text),
            UsdValue::Asset(path) => {
                let quote = if path.contains('@') { "@@@" } else { "@" };
                self.put(quote)?;
                self.put(check_text(path)?)?;
                self.put(quote)
            }
            UsdValue::Vec2f(value) => self.vec2(*value),
            UsdValue::Vec3f(value) => self.vec3(*value),
            UsdValue::Ints(values) => self.array(values, |text, &value| text.number(value)),
            UsdValue::Int64s(values) => self.array(values, |text, &value| text.number(value)),
            UsdValue::Floats(values) => self.array(values, |text, &value| text.float(value)),
            UsdValue::Vec2fs(values) => self.array(values, |text, &value| text.vec2(value)),
            UsdValue::Vec3fs(values) => self.array(values, |text, &value| text.vec3(value)),
            UsdValue::Tokens(texts)
            | UsdValue::Strings(texts)
            | UsdValue::TokensPrepended(texts) => {
                self.list(texts.iter(), |text, value| text.text(value))
            }
            UsdValue::Dictionary(entries) => self.dictionary(entries),
        }
    }

    fn array<T: Clone>(&mut self, values: &Chunks<T>, each: fn(&mut Self, &T) -> Done) -> Done {
        self.list(values.values(), each)
    }

    fn list<'v, T: 'v>(
        &mut self,
        values: impl Iterator<Item = &'v T>,
        each: impl Fn(&mut Self, &T) -> Done,
    ) -> Done {
        self.put("[")?;
        for (index, value) in values.enumerate() {
            if index > 0 {
                self.put(", ")?;
            }
            each(self, value)?;
        }
        self.put("]")
    }

    fn dictionary(&mut self, entries: &[(&'static str, UsdValue)]) -> Done {
        self.put("{\n")?;
        self.depth += 1;
        for (name, value) in entries {
            self.indent(1)?;
            self.put(value.type_name())?;
            self.put(" ")?;
            self.put(name)?;
            self.put(" = ")?;
            self.value(value)?;
            self.put("\n")?;
        }
        self.depth -= 1;
        self.indent(1)?;
        self.put("}")
    }

    fn vec2(&mut self, value: Vec2) -> Done {
        self.tuple(&value.to_array())
    }

    fn vec3(&mut self, value: Vec3) -> Done {
        self.tuple(&value.to_array())
    }

    fn tuple(&mut self, values: &[f32]) -> Done {
        self.put("(")?;
        for (index, &value) in values.iter().enumerate() {
            if index > 0 {
                self.put(", ")?;
            }
            self.float(value)?;
        }
        self.put(")")
    }

    fn float(&mut self, value: f32) -> Done {
        // `Display` writes `NaN`, which USD does not read; infinities are `inf` in both.
        if value.is_nan() { self.put("nan") } else { self.number(value) }
    }

    fn double(&mut self, value: f64) -> Done {
        if value.is_nan() { self.put("nan") } else { self.number(value) }
    }

    /// A quoted text. Control characters other than line ends and tabs are written as `\xHH`.
    fn text(&mut self, text: &str) -> Done {
        self.put("\"")?;
        let mut rest = check_text(text)?;
        let special = |c: char| c == '"' || c == '\\' || c.is_ascii_control();
        while let Some(at) = rest.find(special) {
            self.put(&rest[..at])?;
            match rest.as_bytes()[at] {
                b'\n' => self.put("\\n")?,
                b'\r' => self.put("\\r")?,
                b'\t' => self.put("\\t")?,
                byte @ (b'"' | b'\\') => self.put(if byte == b'"' { "\\\"" } else { "\\\\" })?,
                byte => self.number(format_args!("\\x{byte:02x}"))?,
            }
            rest = &rest[at + 1..];
        }
        self.put(rest)?;
        self.put("\"")
    }
}
