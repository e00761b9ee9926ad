//! Parses `.usda` text into a layer.
//!
//! Prims nest on a stack of our own and values that are not wanted are skipped by counting brackets,
//! so depth is bounded by memory, not by the call stack. Lenient where USD is strict (separators,
//! which bracket closes which): the point is to read curves, not to judge files.

use super::super::super::FormatError;
use super::budget::ReadBudget;
use super::tree::{
    Arc, Edit, ListEdit, ParsedLayer, ParsedValue, PrimAttribute, Spec, Specifier, Target,
    is_wanted,
};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::str::FromStr;

/// How text layers begin.
pub(super) const MAGIC: &[u8] = b"#usda";

/// Parses a layer.
pub(super) fn read(bytes: &[u8], budget: &mut ReadBudget) -> Result<ParsedLayer, FormatError> {
    let text = str::from_utf8(bytes).map_err(|error| {
        FormatError::at(format!("byte {}", error.valid_up_to()), "the text is no UTF-8")
    })?;
    let mut parser =
        Parser { text, at: 0, budget, layer: ParsedLayer::default(), open: Vec::new() };
    parser.layer()?;
    Ok(parser.layer)
}

struct Parser<'a, 'b> {
    text: &'a str,
    /// Byte to be read next.
    at: usize,
    budget: &'b mut ReadBudget,
    layer: ParsedLayer,
    /// Prims whose `{` is not closed yet.
    open: Vec<OpenPrim<'a>>,
}

struct OpenPrim<'a> {
    /// Index in the layer.
    spec: usize,
    /// What is open is a set of its variants.
    variants_of: Option<String>,
    /// Where each attribute is, as several lines may speak of one.
    attributes: BTreeMap<&'a str, KnownAttribute>,
}

#[derive(Clone, Copy)]
struct KnownAttribute {
    index: usize,
    has_default: bool,
}

/// A metadata value, as far as anyone asks.
enum Meta<'a> {
    Text(String),
    Word(&'a str),
    Targets(Vec<Target>),
    Selections(Vec<[String; 2]>),
    Other,
}

/// What the numbers of a value type are.
#[derive(Clone, Copy)]
enum Scalar {
    Bool,
    Int,
    Long,
    Float,
    Double,
    Text,
}

type Done = Result<(), FormatError>;

impl<'a> Parser<'a, '_> {
    // ---- letters and words -------------------------------------------------------------------

    fn error(&self, reason: impl Into<String>) -> FormatError {
        let end = self.at.min(self.text.len());
        let line = 1 + self.text.as_bytes()[..end].iter().filter(|&&byte| byte == b'\n').count();
        FormatError::at(format!("line {line}"), reason)
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Advances while bytes satisfy the condition. Stops only at ASCII or ends of characters when
    /// the condition holds for all bytes of other characters, or for none.
    fn take_while(&mut self, holds: impl Fn(u8) -> bool) -> &'a str {
        let rest = &self.text.as_bytes()[self.at..];
        let length = rest.iter().position(|&byte| !holds(byte)).unwrap_or(rest.len());
        let taken = &self.text[self.at..self.at + length];
        self.at += length;
        taken
    }

    /// Skips space and comments.
    fn blank(&mut self) {
        loop {
            self.take_while(|byte| byte.is_ascii_whitespace());
            let rest = &self.text[self.at..];
            if rest.starts_with('#') || rest.starts_with("//") {
                self.take_while(|byte| byte != b'\n');
            } else if rest.starts_with("/*") {
                self.at += rest.find("*/").map_or(rest.len(), |end| end + 2);
            } else {
                return;
            }
        }
    }

    /// Skips space, then the byte if it is there.
    fn eat(&mut self, byte: u8) -> bool {
        self.blank();
        let found = self.peek() == Some(byte);
        self.at += found as usize;
        found
    }

    fn expect(&mut self, byte: u8) -> Done {
        if self.eat(byte) {
            return Ok(());
        }
        let found = self.text[self.at..].chars().next();
        let found = found.map_or("the end of the file".into(), |found| format!("{found:?}"));
        Err(self.error(format!("expected {:?}, found {found}", byte as char)))
    }

    /// A name with namespaces.
    fn name(&mut self) -> Result<&'a str, FormatError> {
        self.blank();
        let is_part =
            |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b':' | 128..);
        let name = self.take_while(is_part);
        if name.is_empty() { Err(self.error("expected a name")) } else { Ok(name) }
    }

    /// A number or keyword.
    fn word(&mut self) -> &'a str {
        self.blank();
        self.take_while(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'+' | b'-' | b'.'))
    }

    fn number<T: FromStr>(&mut self) -> Result<T, FormatError> {
        let word = self.word();
        word.parse().map_err(|_| self.error(format!("{word:?} is no number that fits its type")))
    }

    /// The text between quotes, single or triple, escapes not yet replaced.
    fn quoted(&mut self) -> Result<&'a str, FormatError> {
        self.blank();
        let rest = &self.text[self.at..];
        let quotes = ["\"\"\"", "'''", "\"", "'"];
        let Some(quote) = quotes.into_iter().find(|quote| rest.starts_with(quote)) else {
            return Err(self.error("expected a text in quotes"));
        };
        let start = self.at + quote.len();
        let mut end = start;
        loop {
            let rest = &self.text[end..];
            if rest.starts_with(quote) {
                self.at = end + quote.len();
                return Ok(&self.text[start..end]);
            }
            end += match rest.as_bytes() {
                [b'\\', _, ..] => 1 + rest[1..].chars().next().map_or(0, char::len_utf8),
                [_, ..] => rest.chars().next().map_or(1, char::len_utf8),
                [] => return Err(self.error("a text has no closing quote")),
            };
        }
    }

    fn string(&mut self) -> Result<String, FormatError> {
        let raw = self.quoted()?;
        self.budget.charge(raw.len() as u64)?;
        Ok(unescaped(raw))
    }

    /// An asset path between `@` or `@@@`.
    fn asset(&mut self) -> Result<&'a str, FormatError> {
        self.blank();
        let quote = if self.text[self.at..].starts_with("@@@") { "@@@" } else { "@" };
        self.expect(b'@')?;
        let start = self.at + quote.len() - 1;
        let rest = &self.text[start..];
        let length = rest.find(quote).ok_or_else(|| self.error("an asset path has no end"))?;
        self.at = start + length + quote.len();
        Ok(&rest[..length])
    }

    /// Skips one value of any type.
    fn skip_value(&mut self) -> Done {
        let mut depth = 0usize;
        loop {
            self.blank();
            match self.peek() {
                None => return Err(self.error("the file ends inside a value")),
                Some(b'"' | b'\'') => {
                    self.quoted()?;
                }
                Some(b'@') => {
                    self.asset()?;
                }
                Some(b'<') => {
                    self.take_while(|byte| byte != b'>' && byte != b'\n');
                    self.expect(b'>')?;
                }
                Some(b'[' | b'(' | b'{') => {
                    self.at += 1;
                    depth += 1;
                }
                Some(b']' | b')' | b'}') => {
                    depth = depth.checked_sub(1).ok_or_else(|| self.error("expected a value"))?;
                    self.at += 1;
                }
                Some(b',' | b'=' | b':' | b';') if depth > 0 => self.at += 1,
                Some(_) => {
                    if self.word().is_empty() {
                        self.name()?;
                    }
                }
            }
            if depth == 0 {
                return Ok(());
            }
        }
    }

    // ---- layer and prims ---------------------------------------------------------------------

    fn layer(&mut self) -> Done {
        self.take_while(|byte| byte != b'\n');
        if self.eat(b'(') {
            self.layer_metadata()?;
        }
        loop {
            self.blank();
            match self.peek() {
                None if self.open.is_empty() => return Ok(()),
                None => return Err(self.error("the file ends inside a prim")),
                Some(b'}') => {
                    self.at += 1;
                    if self.open.pop().is_none() {
                        return Err(self.error("a } that closes nothing"));
                    }
                }
                Some(b';') => self.at += 1,
                Some(_) if self.open.last().is_some_and(|open| open.variants_of.is_some()) => {
                    self.variant()?;
                }
                Some(_) => self.statement()?,
            }
        }
    }

    fn layer_metadata(&mut self) -> Done {
        let mut layer = std::mem::take(&mut self.layer);
        self.metadata(|key, _, value| match (key, value) {
            ("metersPerUnit", Meta::Word(word)) => layer.meters_per_unit = word.parse().ok(),
            ("upAxis", Meta::Text(text)) => layer.up_axis = Some(text),
            ("defaultPrim", Meta::Text(text)) => layer.default_prim = Some(text),
            ("subLayers", Meta::Targets(targets)) => {
                layer.sub_layers = targets.into_iter().map(|target| target.asset).collect();
            }
            _ => {}
        })?;
        self.layer = layer;
        Ok(())
    }

    fn statement(&mut self) -> Done {
        let start = self.at;
        match self.name()? {
            "def" => self.prim(Specifier::Def),
            "over" => self.prim(Specifier::Over),
            "class" => self.prim(Specifier::Class),
            "variantSet" if !self.open.is_empty() => {
                let set = self.string()?;
                self.expect(b'=')?;
                self.expect(b'{')?;
                let spec = self.open.last().map_or(0, |open| open.spec);
                let open = OpenPrim { spec, variants_of: Some(set), attributes: BTreeMap::new() };
                self.budget.push(&mut self.open, open)
            }
            "reorder" => {
                self.name()?;
                self.expect(b'=')?;
                self.skip_value()
            }
            _ if self.open.is_empty() => Err(self.error("expected def, over or class")),
            _ => {
                self.at = start;
                self.property()
            }
        }
    }

    fn prim(&mut self, specifier: Specifier) -> Done {
        self.blank();
        let type_name = match self.peek() {
            Some(b'"' | b'\'') => "",
            _ => self.name()?,
        };
        let type_name = self.budget.text(type_name)?;
        let parent = self.open.last().map(|open| open.spec);
        self.spec(Spec { parent, type_name, specifier, ..Spec::default() })
    }

    fn variant(&mut self) -> Done {
        let Some(OpenPrim { spec, variants_of: Some(set), .. }) = self.open.last() else {
            return Err(self.error("a variant outside all sets"));
        };
        let (parent, set) = (Some(*spec), self.budget.text(set)?);
        self.spec(Spec { parent, variant_of: Some(set), ..Spec::default() })
    }

    /// Name, metadata and opening bracket of a prim or variant.
    fn spec(&mut self, mut spec: Spec) -> Done {
        spec.name = self.string()?;
        if self.eat(b'(') {
            let is_true = |word: &str| !matches!(word, "false" | "0");
            self.metadata(|key, edit, value| match (key, value) {
                ("active", Meta::Word(word)) => spec.is_active = Some(is_true(word)),
                ("instanceable", Meta::Word(word)) => spec.is_instanceable = Some(is_true(word)),
                ("clips", _) => spec.has_clips = true,
                (_, Meta::Selections(selections)) => spec.selections = selections,
                (key, Meta::Targets(targets)) => {
                    if let Some(arc) = arc_of(key) {
                        spec.arcs.push(ListEdit { arc, edit, targets });
                    }
                }
                _ => {}
            })?;
        }
        self.expect(b'{')?;
        let open = OpenPrim {
            spec: self.layer.specs.len(),
            variants_of: None,
            attributes: BTreeMap::new(),
        };
        self.budget.push(&mut self.layer.specs, spec)?;
        self.budget.push(&mut self.open, open)
    }

    /// Metadata up to its closing bracket; `visit` gets every key, how it edits a list, and the value.
    fn metadata(&mut self, mut visit: impl FnMut(&str, Edit, Meta)) -> Done {
        loop {
            self.blank();
            match self.peek() {
                Some(b')') => {
                    self.at += 1;
                    return Ok(());
                }
                Some(b';' | b',') => {
                    self.at += 1;
                    continue;
                }
                Some(b'"' | b'\'') => {
                    // A text by itself is a comment.
                    self.quoted()?;
                    continue;
                }
                _ => {}
            }
            let mut key = self.name()?;
            let edit = list_edit(key);
            if edit.is_some() {
                key = self.name()?;
            }
            self.expect(b'=')?;
            let value = match key {
                "subLayers" => Meta::Targets(self.targets()?),
                "variants" => Meta::Selections(self.selections()?),
                key if arc_of(key).is_some() => Meta::Targets(self.targets()?),
                _ => self.meta_value()?,
            };
            visit(key, edit.unwrap_or(Edit::Explicit), value);
        }
    }

    /// Assets and paths of references, payloads, classes or sublayers: none, one, or several in square brackets.
    fn targets(&mut self) -> Result<Vec<Target>, FormatError> {
        let mut targets = Vec::new();
        self.blank();
        if self.text[self.at..].starts_with("None") {
            self.word();
            return Ok(targets);
        }
        let is_list = self.eat(b'[');
        while !(is_list && self.eat(b']')) {
            self.blank();
            let start = self.at;
            let mut target = Target::default();
            if self.peek() == Some(b'@') {
                let asset = self.asset()?;
                target.asset = self.budget.text(asset)?;
                self.take_while(|byte| byte == b' ');
            }
            if self.peek() == Some(b'<') {
                self.at += 1;
                let path = self.take_while(|byte| byte != b'>' && byte != b'\n');
                target.path = self.budget.text(path)?;
                self.expect(b'>')?;
                self.take_while(|byte| byte == b' ');
            }
            if self.at == start {
                return Err(self.error("expected an asset or a path"));
            }
            if self.peek() == Some(b'(') {
                self.skip_value()?;
            }
            self.budget.push(&mut targets, target)?;
            if !is_list {
                break;
            }
            self.eat(b',');
        }
        Ok(targets)
    }

    /// Sets and names of selected variants.
    fn selections(&mut self) -> Result<Vec<[String; 2]>, FormatError> {
        let mut selections = Vec::new();
        self.expect(b'{')?;
        while !self.eat(b'}') {
            self.name()?;
            self.blank();
            let set = match self.peek() {
                Some(b'"' | b'\'') => self.string()?,
                _ => {
                    let name = self.name()?;
                    self.budget.text(name)?
                }
            };
            self.expect(b'=')?;
            let name = self.string()?;
            self.budget.push(&mut selections, [set, name])?;
            while self.eat(b';') || self.eat(b',') {}
        }
        Ok(selections)
    }

    fn meta_value(&mut self) -> Result<Meta<'a>, FormatError> {
        self.blank();
        match self.peek() {
            Some(b'"' | b'\'') => Ok(Meta::Text(self.string()?)),
            Some(byte) if byte.is_ascii_alphanumeric() || b"+-.".contains(&byte) => {
                Ok(Meta::Word(self.word()))
            }
            _ => {
                self.skip_value()?;
                // A reference is an asset, then perhaps a path and an offset.
                self.take_while(|byte| byte == b' ');
                while matches!(self.peek(), Some(b'<' | b'(')) {
                    self.skip_value()?;
                    self.take_while(|byte| byte == b' ');
                }
                Ok(Meta::Other)
            }
        }
    }

    // ---- properties --------------------------------------------------------------------------

    fn property(&mut self) -> Done {
        let mut type_name = self.name()?;
        while list_edit(type_name).is_some()
            || matches!(type_name, "custom" | "uniform" | "varying" | "config")
        {
            type_name = self.name()?;
        }
        if type_name == "rel" {
            return self.relationship();
        }
        let is_array = self.eat(b'[');
        if is_array {
            self.expect(b']')?;
        }
        let name = self.name()?;
        let suffix = match self.peek() {
            Some(b'.') => {
                self.at += 1;
                self.name()?
            }
            _ => "default",
        };
        self.attribute(type_name, is_array, name, suffix)
    }

    fn relationship(&mut self) -> Done {
        self.name()?;
        if self.eat(b'.') {
            self.name()?;
        }
        if self.eat(b'=') {
            self.skip_value()?;
        }
        if self.eat(b'(') {
            self.metadata(|_, _, _| {})?;
        }
        Ok(())
    }

    fn attribute(&mut self, base: &str, is_array: bool, name: &'a str, suffix: &str) -> Done {
        let spec = self.open.last().map_or(0, |open| open.spec);
        let is_wanted = is_wanted(&self.layer.specs[spec].type_name, name);
        let kind = value_type(base).filter(|_| is_wanted);
        let mut samples = 0;
        let value = match (self.eat(b'='), kind, suffix) {
            (false, _, _) => None,
            (true, Some(kind), "default") => Some(self.value(kind, is_array)?),
            (true, Some(kind), "timeSamples") => {
                let (earliest, n) = self.earliest_sample(kind, is_array)?;
                samples = n;
                Some(earliest)
            }
            _ => {
                self.skip_value()?;
                None
            }
        };
        let mut interpolation = None;
        if self.eat(b'(') {
            self.metadata(|key, _, value| {
                if let ("interpolation", Meta::Text(text)) = (key, value) {
                    interpolation = Some(text);
                }
            })?;
        }
        if !is_wanted {
            return Ok(());
        }
        let (attribute, has_default) = self.known_attribute(base, is_array, name)?;
        if interpolation.is_some() {
            attribute.interpolation = interpolation;
        }
        // The default counts, wherever it stands.
        let Some(value) = value else { return Ok(()) };
        // Of samples alone the earliest is read.
        let was_sample = suffix == "default" && !*has_default && attribute.value.is_some();
        let is_sample = suffix != "default" && !*has_default;
        attribute.unread += samples + u64::from(was_sample);
        attribute.unread -= u64::from(is_sample && samples > 0);
        if suffix == "default" || !*has_default {
            attribute.is_blocked = value.is_none();
            attribute.value = value;
            *has_default |= suffix == "default";
        }
        Ok(())
    }

    /// The attribute of this name in the innermost prim, made when it is new.
    fn known_attribute(
        &mut self,
        base: &str,
        is_array: bool,
        name: &'a str,
    ) -> Result<(&mut PrimAttribute, &mut bool), FormatError> {
        let Some(open) = self.open.last_mut() else {
            return Err(FormatError::at("layer", "an attribute outside all prims"));
        };
        let attributes = &mut self.layer.specs[open.spec].attributes;
        if !open.attributes.contains_key(name) {
            self.budget.charge(64)?;
            let known = KnownAttribute { index: attributes.len(), has_default: false };
            open.attributes.insert(name, known);
            let brackets = if is_array { "[]" } else { "" };
            let attribute = PrimAttribute {
                name: self.budget.text(name)?,
                type_name: format!("{base}{brackets}"),
                ..PrimAttribute::default()
            };
            self.budget.charge(base.len() as u64 + 2)?;
            self.budget.push(attributes, attribute)?;
        }
        let Some(known) = open.attributes.get_mut(name) else {
            return Err(FormatError::at(name, "an attribute was lost"));
        };
        Ok((&mut attributes[known.index], &mut known.has_default))
    }

    // ---- values ------------------------------------------------------------------------------

    /// The value at the earliest time, and how many there are.
    fn earliest_sample(
        &mut self,
        kind: (Scalar, usize),
        is_array: bool,
    ) -> Result<(Option<ParsedValue>, u64), FormatError> {
        let mut samples = 0;
        self.expect(b'{')?;
        let mut earliest: Option<(f64, Option<ParsedValue>)> = None;
        while !self.eat(b'}') {
            let time: f64 = self.number()?;
            samples += 1;
            self.expect(b':')?;
            if earliest.as_ref().is_none_or(|(earliest, _)| time < *earliest) {
                earliest = Some((time, self.value(kind, is_array)?));
            } else {
                self.skip_value()?;
            }
            self.eat(b',');
        }
        Ok((earliest.and_then(|(_, value)| value), samples))
    }

    /// A value of a type; `None` for a blocked one.
    fn value(
        &mut self,
        (scalar, per): (Scalar, usize),
        is_array: bool,
    ) -> Result<Option<ParsedValue>, FormatError> {
        self.blank();
        if self.text[self.at..].starts_with("None") {
            self.word();
            return Ok(None);
        }
        Ok(Some(match (scalar, per) {
            (Scalar::Bool, _) => ParsedValue::Ints(self.items(is_array, Self::bool)?),
            (Scalar::Int, _) => ParsedValue::Ints(self.items(is_array, Self::number)?),
            (Scalar::Long, _) => ParsedValue::Longs(self.items(is_array, Self::long)?),
            (Scalar::Float, 1) => ParsedValue::Floats(self.items(is_array, Self::number)?),
            (Scalar::Float, 2) => ParsedValue::Float2s(
                self.items(is_array, |text| Ok(Vec2::from_array(text.tuple(Self::number)?)))?,
            ),
            (Scalar::Float, 3) => ParsedValue::Float3s(
                self.items(is_array, |text| Ok(Vec3::from_array(text.tuple(Self::number)?)))?,
            ),
            (Scalar::Text, _) => ParsedValue::Texts(self.items(is_array, Self::any_text)?),
            (Scalar::Float, _) => {
                let parts = self.items(is_array, |text| text.tuple::<f32, 4>(Self::number))?;
                self.budget.charge_items::<[f64; 4]>(parts.len() as u64)?;
                let values = parts.as_flattened().iter().map(|&part| part as f64).collect();
                ParsedValue::Doubles { per: 4, values }
            }
            (Scalar::Double, _) => self.doubles(per, is_array)?,
        }))
    }

    /// The items between square brackets, or the only one.
    fn items<T>(
        &mut self,
        is_array: bool,
        item: impl Fn(&mut Self) -> Result<T, FormatError>,
    ) -> Result<Vec<T>, FormatError> {
        let mut items = Vec::new();
        if !is_array {
            items.push(item(self)?);
            return Ok(items);
        }
        self.expect(b'[')?;
        while !self.eat(b']') {
            let next = item(self)?;
            self.budget.push(&mut items, next)?;
            if !self.eat(b',') {
                self.expect(b']')?;
                break;
            }
        }
        Ok(items)
    }

    /// Numbers in round brackets.
    fn tuple<T: Copy + Default, const N: usize>(
        &mut self,
        number: impl Fn(&mut Self) -> Result<T, FormatError>,
    ) -> Result<[T; N], FormatError> {
        self.expect(b'(')?;
        let mut values = [T::default(); N];
        for (index, value) in values.iter_mut().enumerate() {
            if index > 0 {
                self.expect(b',')?;
            }
            *value = number(self)?;
        }
        self.eat(b',');
        self.expect(b')')?;
        Ok(values)
    }

    fn doubles(&mut self, per: usize, is_array: bool) -> Result<ParsedValue, FormatError> {
        let values = match per {
            1 => self.items(is_array, Self::number)?,
            2 => self.items(is_array, |text| text.tuple::<f64, 2>(Self::number))?.into_flattened(),
            3 => self.items(is_array, |text| text.tuple::<f64, 3>(Self::number))?.into_flattened(),
            4 => self.items(is_array, |text| text.tuple::<f64, 4>(Self::number))?.into_flattened(),
            _ => {
                let row = |text: &mut Self| text.tuple::<f64, 4>(Self::number);
                let matrix = |text: &mut Self| text.tuple::<[f64; 4], 4>(row);
                self.items(is_array, matrix)?.into_flattened().into_flattened()
            }
        };
        Ok(ParsedValue::Doubles { per, values })
    }

    fn bool(&mut self) -> Result<i32, FormatError> {
        match self.word() {
            "true" | "1" => Ok(1),
            "false" | "0" => Ok(0),
            other => Err(self.error(format!("{other:?} is neither true nor false"))),
        }
    }

    /// Signed or unsigned; the largest unsigned wrap.
    fn long(&mut self) -> Result<i64, FormatError> {
        let word = self.word();
        let parsed = word.parse().or_else(|_| word.parse::<u64>().map(|value| value as i64));
        parsed.map_err(|_| self.error(format!("{word:?} is no integer of 64 bits")))
    }

    fn any_text(&mut self) -> Result<String, FormatError> {
        self.blank();
        if self.peek() == Some(b'@') {
            let path = self.asset()?;
            return self.budget.text(path);
        }
        self.string()
    }
}

fn list_edit(word: &str) -> Option<Edit> {
    Some(match word {
        "add" => Edit::Add,
        "prepend" => Edit::Prepend,
        "append" => Edit::Append,
        "delete" => Edit::Delete,
        "reorder" => Edit::Reorder,
        _ => return None,
    })
}

/// What metadata of this name brings in.
pub(super) fn arc_of(key: &str) -> Option<Arc> {
    Some(match key {
        "references" => Arc::Reference,
        "payload" => Arc::Payload,
        "inherits" | "inheritPaths" => Arc::Inherit,
        "specializes" => Arc::Specialize,
        _ => return None,
    })
}

/// What a value type holds and how many in a tuple; `None` for types that are skipped.
/// Names without a digit are those of files older than 2016.
fn value_type(base: &str) -> Option<(Scalar, usize)> {
    Some(match base {
        "bool" => (Scalar::Bool, 1),
        "int" => (Scalar::Int, 1),
        "int64" | "uint" | "uint64" | "uchar" => (Scalar::Long, 1),
        "half" | "float" => (Scalar::Float, 1),
        "double" | "timecode" => (Scalar::Double, 1),
        "float2" | "half2" | "texCoord2f" | "texCoord2h" | "Vec2f" => (Scalar::Float, 2),
        "double2" | "texCoord2d" | "Vec2d" => (Scalar::Double, 2),
        "float3" | "point3f" | "normal3f" | "vector3f" | "color3f" | "texCoord3f" => {
            (Scalar::Float, 3)
        }
        "half3" | "point3h" | "normal3h" | "vector3h" | "color3h" | "texCoord3h" => {
            (Scalar::Float, 3)
        }
        "Vec3f" | "PointFloat" | "NormalFloat" | "VectorFloat" | "ColorFloat" => (Scalar::Float, 3),
        "double3" | "point3d" | "normal3d" | "vector3d" | "color3d" | "texCoord3d" => {
            (Scalar::Double, 3)
        }
        "Vec3d" | "Point" | "Normal" | "Vector" | "Color" => (Scalar::Double, 3),
        "float4" | "half4" | "color4f" | "color4h" | "quatf" | "quath" => (Scalar::Float, 4),
        "double4" | "color4d" | "quatd" => (Scalar::Double, 4),
        "matrix4d" | "Matrix4d" => (Scalar::Double, 16),
        "string" | "token" | "asset" => (Scalar::Text, 1),
        _ => return None,
    })
}

/// Replaces `\n`, `\t`, `\r`, `\xHH` and octal escapes; any other escaped character is itself.
fn unescaped(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let Some(escaped) = rest.chars().next() else { break };
        let (character, length) = match escaped {
            'n' => ('\n', 1),
            't' => ('\t', 1),
            'r' => ('\r', 1),
            'x' => coded_character(&rest[1..], 2, 16).map_or(('x', 1), |(c, n)| (c, n + 1)),
            '0'..='7' => coded_character(rest, 3, 8).unwrap_or((escaped, 1)),
            other => (other, other.len_utf8()),
        };
        out.push(character);
        rest = &rest[length..];
    }
    out.push_str(rest);
    out
}

/// A character written as at most `most` digits, and how many there were.
fn coded_character(digits: &str, most: usize, radix: u32) -> Option<(char, usize)> {
    let length = digits.chars().take(most).take_while(|digit| digit.is_digit(radix)).count();
    let code = u32::from_str_radix(digits.get(..length)?, radix).ok()?;
    Some((char::from_u32(code)?, length))
}
