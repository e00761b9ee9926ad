//! Writes a layer as a crate file (`.usdc` 0.8.0), streaming: big arrays go straight to the output.
//!
//! ```text
//! [header, 88 bytes] [values, 8-byte aligned …] [tokens] [strings] [fields] [field sets]
//! [paths] [specs] [table of contents]
//! ```
//!
//! A spec (layer, prim or property) is a path and a set of fields; a field is a token and a value
//! representation: 64 bits that hold a small value, or the place of a big one. Values are written as
//! the tree is walked, so only the small tables stay in memory; the header is patched at the end.
//!
//! Guaranteed: the same layer gives the same bytes. Integer arrays and float arrays of few distinct
//! values are compressed with the rules of OpenUSD; other arrays lie as they are in memory. Arrays of
//! one type that are equal are in the file once. Arrays are equal if their XXH3 of 128 bits are.
//! Not promised: the bytes OpenUSD would write, and use on big-endian machines.

use super::super::{Chunks, FormatError};
use super::coding::{
    ARRAY, COMPRESSED, INLINED, PAYLOAD, SHORTEST_COMPRESSED, Width, kind, lz4_pack, pack_ints,
    spec_kind,
};
use super::float_table::FloatTable;
use super::spec::{
    AttributeSpec, MetadataField, PrimSpec, PropertySpec, UsdLayer, UsdValue, Variability,
    check_text,
};
use bytemuck::NoUninit;
use std::collections::HashMap;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use xxhash_rust::xxh3::Xxh3;

/// Bytes of the header, the place of the first value.
const HEADER: usize = 88;
/// Output is handed on in pieces of this many bytes.
const BUFFER: usize = 1 << 18;

/// Writes the layer from the output's current position.
///
/// # Errors
/// The output failed, a text holds a NUL, a relationship or connection points outside the layer, or
/// there is more than a crate file can count.
pub fn write(layer: &UsdLayer, out: &mut (impl Write + Seek)) -> Result<(), FormatError> {
    let start = out.stream_position()?;
    let mut crate_file = CrateWriter::new(BufWriter::with_capacity(BUFFER, &mut *out));
    crate_file.put(&[0; HEADER])?;
    crate_file.number_paths(layer)?;
    crate_file.layer(layer)?;
    let table_of_contents = crate_file.sections()?;
    crate_file.out.flush()?;
    drop(crate_file);
    patch_header(out, start, table_of_contents)
}

fn patch_header(
    out: &mut (impl Write + Seek),
    start: u64,
    table_of_contents: u64,
) -> Result<(), FormatError> {
    let end = out.stream_position()?;
    let mut header = [0u8; HEADER];
    header[..8].copy_from_slice(b"PXR-USDC");
    header[8..11].copy_from_slice(&[0, 8, 0]);
    header[16..24].copy_from_slice(&table_of_contents.to_le_bytes());
    out.seek(SeekFrom::Start(start))?;
    out.write_all(&header)?;
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

/// Texts or paths numbered in order of first use.
#[derive(Default)]
struct Numbering {
    number_of: HashMap<String, u32>,
    names: Vec<String>,
}

impl Numbering {
    fn number(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.number_of.get(name) {
            return number;
        }
        let number = self.names.len() as u32;
        self.names.push(name.to_owned());
        self.number_of.insert(name.to_owned(), number);
        number
    }
}

/// The tree of paths, flattened: one entry for each path, parents first.
#[derive(Default)]
struct PathTree {
    indices: Vec<i64>,
    /// Token of the last name; negative for properties.
    elements: Vec<i64>,
    /// Entries to the next sibling; 0: no child, it follows; -1: only children; -2: neither.
    jumps: Vec<i64>,
}

struct CrateWriter<W: Write> {
    out: W,
    /// Bytes written: places in the file count from its start.
    position: u64,
    tokens: Numbering,
    strings: Numbering,
    paths: Numbering,
    path_tree: PathTree,
    fields: Vec<(u32, u64)>,
    field_numbers: HashMap<(u32, u64), u32>,
    field_sets: Vec<i64>,
    /// Representations of the arrays written so far, by type and content.
    arrays: HashMap<(u8, u128), u64>,
    /// Path, field set and kind of each spec.
    specs: [Vec<i64>; 3],
}

impl<W: Write> CrateWriter<W> {
    fn new(out: W) -> Self {
        let mut tokens = Numbering::default();
        // Token 0 is never a name: a property's name is a negative number, and there is no -0.
        tokens.number(";-)");
        Self {
            out,
            position: 0,
            tokens,
            strings: Numbering::default(),
            paths: Numbering::default(),
            path_tree: PathTree::default(),
            fields: Vec::new(),
            field_numbers: HashMap::new(),
            field_sets: Vec::new(),
            arrays: HashMap::new(),
            specs: Default::default(),
        }
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        self.out.write_all(bytes)?;
        self.position += bytes.len() as u64;
        Ok(())
    }

    fn put_u64(&mut self, number: u64) -> Result<(), FormatError> {
        self.put(&number.to_le_bytes())
    }

    /// Fills up to a multiple of 8 and returns the place.
    fn align(&mut self) -> Result<u64, FormatError> {
        let missing = self.position.next_multiple_of(8) - self.position;
        self.put(&[0; 8][..missing as usize])?;
        if self.position > PAYLOAD {
            return Err(FormatError::at("output", "more than 2^48 bytes"));
        }
        Ok(self.position)
    }

    fn token(&mut self, text: &str) -> Result<u32, FormatError> {
        Ok(self.tokens.number(check_text(text)?))
    }

    fn string(&mut self, text: &str) -> Result<u32, FormatError> {
        self.token(text)?;
        Ok(self.strings.number(text))
    }

    fn path(&self, path: &str) -> Result<u32, FormatError> {
        let number = self.paths.number_of.get(path).copied();
        number.ok_or_else(|| FormatError::at(path, "points at nothing in this layer"))
    }

    // ---- paths -------------------------------------------------------------------------------

    /// Numbers every path of the layer, parents first, and builds the tree section.
    fn number_paths(&mut self, layer: &UsdLayer) -> Result<(), FormatError> {
        let root = self.path_entry("/", 0)?;
        for (index, prim) in layer.prims.iter().enumerate() {
            self.number_prim(prim, "", index + 1 < layer.prims.len())?;
        }
        self.close_entry(root, !layer.prims.is_empty(), false);
        Ok(())
    }

    fn number_prim(
        &mut self,
        prim: &PrimSpec,
        parent: &str,
        has_sibling: bool,
    ) -> Result<(), FormatError> {
        let path = format!("{parent}/{}", prim.name);
        let element = self.token(&prim.name)? as i64;
        let entry = self.path_entry(&path, element)?;
        let (properties, children) = (prim.properties.len(), prim.children.len());
        for (index, property) in prim.properties.iter().enumerate() {
            let element = -(self.token(property.name())? as i64);
            let leaf = self.path_entry(&format!("{path}.{}", property.name()), element)?;
            self.close_entry(leaf, false, index + 1 < properties + children);
        }
        for (index, child) in prim.children.iter().enumerate() {
            self.number_prim(child, &path, index + 1 < children)?;
        }
        self.close_entry(entry, properties + children > 0, has_sibling);
        Ok(())
    }

    fn path_entry(&mut self, path: &str, element: i64) -> Result<usize, FormatError> {
        let entry = self.path_tree.indices.len();
        if self.paths.number(path) as usize != entry {
            return Err(FormatError::at(path, "two prims or properties have this path"));
        }
        self.path_tree.indices.push(entry as i64);
        self.path_tree.elements.push(element);
        self.path_tree.jumps.push(0);
        Ok(entry)
    }

    fn close_entry(&mut self, entry: usize, has_child: bool, has_sibling: bool) {
        self.path_tree.jumps[entry] = match (has_child, has_sibling) {
            (false, false) => -2,
            (true, false) => -1,
            (false, true) => 0,
            (true, true) => (self.path_tree.indices.len() - entry) as i64,
        };
    }

    // ---- specs and fields --------------------------------------------------------------------

    fn layer(&mut self, layer: &UsdLayer) -> Result<(), FormatError> {
        let mut fields = self.fields(&layer.fields)?;
        self.name_list("primChildren", layer.prims.iter().map(|p| p.name.as_str()), &mut fields)?;
        self.spec("/", spec_kind::LAYER, fields)?;
        layer.prims.iter().try_for_each(|prim| self.prim(prim, ""))
    }

    fn prim(&mut self, prim: &PrimSpec, parent: &str) -> Result<(), FormatError> {
        let path = format!("{parent}/{}", prim.name);
        let mut fields = Vec::new();
        self.field("specifier", Self::inlined(kind::SPECIFIER, 0), &mut fields)?;
        if !prim.type_name.is_empty() {
            self.token_field("typeName", prim.type_name, &mut fields)?;
        }
        fields.extend(self.fields(&prim.fields)?);
        let (children, properties) = (prim.children.iter(), prim.properties.iter());
        self.name_list("primChildren", children.map(|p| p.name.as_str()), &mut fields)?;
        self.name_list("properties", properties.map(PropertySpec::name), &mut fields)?;
        self.spec(&path, spec_kind::PRIM, fields)?;
        for property in &prim.properties {
            self.property(property, &path)?;
        }
        prim.children.iter().try_for_each(|child| self.prim(child, &path))
    }

    fn property(&mut self, property: &PropertySpec, prim: &str) -> Result<(), FormatError> {
        let path = format!("{prim}.{}", property.name());
        match property {
            PropertySpec::Attribute(attribute) => {
                let fields = self.attribute(attribute)?;
                self.spec(&path, spec_kind::ATTRIBUTE, fields)
            }
            PropertySpec::Relationship { targets, .. } => {
                let mut fields = Vec::new();
                // OpenUSD calls every relationship uniform.
                self.field("variability", Self::inlined(kind::VARIABILITY, 1), &mut fields)?;
                let targets = self.path_list(targets)?;
                self.field("targetPaths", targets, &mut fields)?;
                self.spec(&path, spec_kind::RELATIONSHIP, fields)
            }
        }
    }

    fn attribute(&mut self, attribute: &AttributeSpec) -> Result<Vec<u32>, FormatError> {
        let mut fields = Vec::new();
        self.token_field("typeName", attribute.type_name, &mut fields)?;
        if attribute.variability == Variability::Uniform {
            self.field("variability", Self::inlined(kind::VARIABILITY, 1), &mut fields)?;
        }
        if let Some(interpolation) = attribute.interpolation {
            self.token_field("interpolation", interpolation, &mut fields)?;
        }
        if let Some(value) = &attribute.default {
            let value = self.value(value)?;
            self.field("default", value, &mut fields)?;
        }
        if !attribute.samples.is_empty() {
            let samples = self.samples(&attribute.samples)?;
            self.field("timeSamples", samples, &mut fields)?;
        }
        if !attribute.connections.is_empty() {
            let paths = self.path_list(&attribute.connections)?;
            self.field("connectionPaths", paths, &mut fields)?;
        }
        Ok(fields)
    }

    fn spec(&mut self, path: &str, kind: u32, fields: Vec<u32>) -> Result<(), FormatError> {
        let path = self.path(path)?;
        let numbers = [path as i64, self.field_sets.len() as i64, kind as i64];
        for (column, number) in self.specs.iter_mut().zip(numbers) {
            column.push(number);
        }
        self.field_sets.extend(fields.iter().map(|&field| field as i64));
        self.field_sets.push(-1);
        Ok(())
    }

    fn fields(&mut self, fields: &[MetadataField]) -> Result<Vec<u32>, FormatError> {
        let mut numbers = Vec::new();
        for (name, value) in fields {
            let value = self.value(value)?;
            self.field(name, value, &mut numbers)?;
        }
        Ok(numbers)
    }

    fn field(&mut self, name: &str, value: u64, into: &mut Vec<u32>) -> Result<(), FormatError> {
        let key = (self.token(name)?, value);
        let next = self.fields.len() as u32;
        let number = *self.field_numbers.entry(key).or_insert(next);
        if number == next {
            self.fields.push(key);
        }
        into.push(number);
        Ok(())
    }

    fn token_field(
        &mut self,
        name: &str,
        token: &str,
        into: &mut Vec<u32>,
    ) -> Result<(), FormatError> {
        let value = Self::inlined(kind::TOKEN, self.token(token)?);
        self.field(name, value, into)
    }

    /// The list of names of children or properties; none is no field.
    fn name_list<'n>(
        &mut self,
        field: &str,
        names: impl Iterator<Item = &'n str>,
        into: &mut Vec<u32>,
    ) -> Result<(), FormatError> {
        let numbers = names.map(|name| self.token(name)).collect::<Result<Vec<_>, _>>()?;
        if numbers.is_empty() {
            return Ok(());
        }
        let place = self.counted(&numbers)?;
        self.field(field, Self::at(kind::TOKEN_VECTOR, place), into)
    }

    // ---- values ------------------------------------------------------------------------------

    fn inlined(kind: u8, payload: u32) -> u64 {
        INLINED | (kind as u64) << 48 | payload as u64
    }

    fn at(kind: u8, place: u64) -> u64 {
        (kind as u64) << 48 | place
    }

    /// Writes a value where it does not fit its representation, which is returned.
    fn value(&mut self, value: &UsdValue) -> Result<u64, FormatError> {
        Ok(match value {
            UsdValue::Bool(value) => Self::inlined(kind::BOOL, *value as u32),
            UsdValue::Int(value) => Self::inlined(kind::INT, *value as u32),
            UsdValue::Int64(value) => match i32::try_from(*value) {
                Ok(short) => Self::inlined(kind::INT64, short as u32),
                Err(_) => self.scalar(kind::INT64, value)?,
            },
            UsdValue::UInt64(value) => match u32::try_from(*value) {
                Ok(short) => Self::inlined(kind::UINT64, short),
                Err(_) => self.scalar(kind::UINT64, value)?,
            },
            UsdValue::Float(value) => Self::inlined(kind::FLOAT, value.to_bits()),
            // A double that a float holds exactly is stored as that float.
            UsdValue::Double(value) if (*value as f32) as f64 == *value => {
                Self::inlined(kind::DOUBLE, (*value as f32).to_bits())
            }
            UsdValue::Double(value) => self.scalar(kind::DOUBLE, value)?,
            UsdValue::String(text) => Self::inlined(kind::STRING, self.string(text)?),
            UsdValue::Token(text) => Self::inlined(kind::TOKEN, self.token(text)?),
            UsdValue::Asset(path) => Self::inlined(kind::ASSET, self.token(path)?),
            UsdValue::Vec2f(value) => self.scalar(kind::VEC2F, value)?,
            UsdValue::Vec3f(value) => self.scalar(kind::VEC3F, value)?,
            UsdValue::Ints(values) => self.once(kind::INT, values, |file| {
                file.int_array(kind::INT, values, Width::Bits32, |&value| value as i64)
            })?,
            UsdValue::Int64s(values) => self.once(kind::INT64, values, |file| {
                file.int_array(kind::INT64, values, Width::Bits64, |&value| value)
            })?,
            UsdValue::Floats(values) => {
                self.once(kind::FLOAT, values, |file| file.float_array(values))?
            }
            UsdValue::Vec2fs(values) => {
                self.once(kind::VEC2F, values, |file| file.array(kind::VEC2F, values))?
            }
            UsdValue::Vec3fs(values) => {
                self.once(kind::VEC3F, values, |file| file.array(kind::VEC3F, values))?
            }
            UsdValue::Tokens(texts) => self.text_array(kind::TOKEN, texts, Self::token)?,
            UsdValue::Strings(texts) => self.text_array(kind::STRING, texts, Self::string)?,
            UsdValue::TokensPrepended(texts) => self.prepended(texts)?,
            UsdValue::Dictionary(entries) => self.dictionary(entries)?,
        })
    }

    fn scalar(&mut self, kind: u8, value: &impl NoUninit) -> Result<u64, FormatError> {
        let place = self.align()?;
        self.put(bytemuck::bytes_of(value))?;
        Ok(Self::at(kind, place))
    }

    /// A count, then numbers: how lists are stored. Returns the place.
    fn counted(&mut self, numbers: &[u32]) -> Result<u64, FormatError> {
        let place = self.align()?;
        self.put_u64(numbers.len() as u64)?;
        self.put(bytemuck::cast_slice(numbers))?;
        Ok(place)
    }

    /// The representation of an array: of an equal one that is there, else as `write` gives it.
    fn once<T: NoUninit>(
        &mut self,
        kind: u8,
        values: &Chunks<T>,
        write: impl FnOnce(&mut Self) -> Result<u64, FormatError>,
    ) -> Result<u64, FormatError> {
        let mut hash = Xxh3::new();
        values.slices().for_each(|slice| hash.update(bytemuck::cast_slice(slice)));
        let content = (kind, hash.digest128());
        if let Some(&there) = self.arrays.get(&content) {
            return Ok(there);
        }
        let value = write(self)?;
        self.arrays.insert(content, value);
        Ok(value)
    }

    /// An array as it lies in memory.
    fn array<T: NoUninit>(&mut self, kind: u8, values: &Chunks<T>) -> Result<u64, FormatError> {
        if values.is_empty() {
            return Ok(ARRAY | Self::at(kind, 0));
        }
        let place = self.align()?;
        self.put_u64(values.len() as u64)?;
        for slice in values.slices() {
            self.put(bytemuck::cast_slice(slice))?;
        }
        Ok(ARRAY | Self::at(kind, place))
    }

    fn int_array<T: NoUninit>(
        &mut self,
        kind: u8,
        values: &Chunks<T>,
        width: Width,
        widen: fn(&T) -> i64,
    ) -> Result<u64, FormatError> {
        if values.len() < SHORTEST_COMPRESSED {
            return self.array(kind, values);
        }
        let place = self.align()?;
        self.put_u64(values.len() as u64)?;
        self.put_packed(&pack_ints(values.values().map(widen), width))?;
        Ok(ARRAY | COMPRESSED | Self::at(kind, place))
    }

    fn float_array(&mut self, values: &Chunks<f32>) -> Result<u64, FormatError> {
        let Some(table) = FloatTable::of(values) else {
            return self.array(kind::FLOAT, values);
        };
        let place = self.align()?;
        self.put_u64(values.len() as u64)?;
        self.put(b"t")?;
        self.put(&(table.floats.len() as u32).to_le_bytes())?;
        self.put(bytemuck::cast_slice(&table.floats))?;
        let indices = table.indices.iter().map(|&index| index as i64);
        self.put_packed(&pack_ints(indices, Width::Bits32))?;
        Ok(ARRAY | COMPRESSED | Self::at(kind::FLOAT, place))
    }

    fn text_array(
        &mut self,
        kind: u8,
        texts: &[String],
        number: fn(&mut Self, &str) -> Result<u32, FormatError>,
    ) -> Result<u64, FormatError> {
        let numbers = texts.iter().map(|text| number(self, text)).collect::<Result<Vec<_>, _>>()?;
        self.array(kind, &Chunks::from(numbers))
    }

    /// A list that changes weaker lists: a byte says how, here "prepend".
    fn prepended(&mut self, texts: &[String]) -> Result<u64, FormatError> {
        const HAS_PREPENDED: u8 = 1 << 5;
        let numbers = texts.iter().map(|text| self.token(text)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self::at(kind::TOKEN_LIST_OP, self.list_op(HAS_PREPENDED, &numbers)?))
    }

    /// Paths that replace those of weaker layers.
    fn path_list(&mut self, paths: &[String]) -> Result<u64, FormatError> {
        const IS_EXPLICIT: u8 = 1;
        const HAS_EXPLICIT: u8 = 1 << 1;
        let numbers = paths.iter().map(|path| self.path(path)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self::at(kind::PATH_LIST_OP, self.list_op(IS_EXPLICIT | HAS_EXPLICIT, &numbers)?))
    }

    fn list_op(&mut self, header: u8, numbers: &[u32]) -> Result<u64, FormatError> {
        let place = self.align()?;
        self.put(&[header])?;
        self.put_u64(numbers.len() as u64)?;
        self.put(bytemuck::cast_slice(numbers))?;
        Ok(place)
    }

    /// Entries' values first, so that each representation follows its 8-byte jump directly.
    fn dictionary(&mut self, entries: &[(&'static str, UsdValue)]) -> Result<u64, FormatError> {
        let mut packed = Vec::with_capacity(entries.len());
        for (name, value) in entries {
            packed.push((self.string(name)?, self.value(value)?));
        }
        let place = self.align()?;
        self.put_u64(packed.len() as u64)?;
        for (name, value) in packed {
            self.put(&name.to_le_bytes())?;
            self.put_u64(8)?;
            self.put_u64(value)?;
        }
        Ok(Self::at(kind::DICTIONARY, place))
    }

    /// Values first, then `jump 8, times, jump 8, count, values` with representations for both.
    fn samples(&mut self, samples: &[(f64, UsdValue)]) -> Result<u64, FormatError> {
        let mut values = Vec::with_capacity(samples.len());
        for (_, value) in samples {
            values.push(self.value(value)?);
        }
        let times = self.align()?;
        self.put_u64(samples.len() as u64)?;
        for (time, _) in samples {
            self.put(&time.to_le_bytes())?;
        }
        let place = self.align()?;
        for number in [8, Self::at(kind::DOUBLE_VECTOR, times), 8, values.len() as u64] {
            self.put_u64(number)?;
        }
        self.put(bytemuck::cast_slice(&values))?;
        Ok(Self::at(kind::TIME_SAMPLES, place))
    }

    // ---- sections ----------------------------------------------------------------------------

    /// Writes all sections and the table of contents; the place of the latter.
    fn sections(&mut self) -> Result<u64, FormatError> {
        type Section<W> = fn(&mut CrateWriter<W>) -> Result<(), FormatError>;
        let sections: [(&str, Section<W>); 6] = [
            ("TOKENS", Self::tokens_section),
            ("STRINGS", Self::strings_section),
            ("FIELDS", Self::fields_section),
            ("FIELDSETS", Self::field_sets_section),
            ("PATHS", Self::paths_section),
            ("SPECS", Self::specs_section),
        ];
        let mut contents = Vec::new();
        for (name, section) in sections {
            let start = self.position;
            section(self)?;
            contents.push((name, start, self.position - start));
        }
        let table_of_contents = self.position;
        self.put_u64(contents.len() as u64)?;
        for (name, start, length) in contents {
            let mut padded = [0u8; 16];
            padded[..name.len()].copy_from_slice(name.as_bytes());
            self.put(&padded)?;
            self.put_u64(start)?;
            self.put_u64(length)?;
        }
        Ok(table_of_contents)
    }

    fn put_packed(&mut self, packed: &[u8]) -> Result<(), FormatError> {
        self.put_u64(packed.len() as u64)?;
        self.put(packed)
    }

    fn put_packed_ints(&mut self, numbers: &[i64]) -> Result<(), FormatError> {
        self.put_packed(&pack_ints(numbers.iter().copied(), Width::Bits32))
    }

    fn tokens_section(&mut self) -> Result<(), FormatError> {
        let mut texts = Vec::new();
        for token in &self.tokens.names {
            texts.extend_from_slice(token.as_bytes());
            texts.push(0);
        }
        self.put_u64(self.tokens.names.len() as u64)?;
        self.put_u64(texts.len() as u64)?;
        self.put_packed(&lz4_pack(&texts))
    }

    fn strings_section(&mut self) -> Result<(), FormatError> {
        let numbers: Vec<u32> =
            self.strings.names.iter().map(|text| self.tokens.number_of[text]).collect();
        self.put_u64(numbers.len() as u64)?;
        self.put(bytemuck::cast_slice(&numbers))
    }

    fn fields_section(&mut self) -> Result<(), FormatError> {
        let (tokens, values): (Vec<i64>, Vec<u64>) =
            self.fields.iter().map(|&(token, value)| (token as i64, value)).unzip();
        self.put_u64(tokens.len() as u64)?;
        self.put_packed_ints(&tokens)?;
        self.put_packed(&lz4_pack(bytemuck::cast_slice(&values)))
    }

    fn field_sets_section(&mut self) -> Result<(), FormatError> {
        let field_sets = std::mem::take(&mut self.field_sets);
        self.put_u64(field_sets.len() as u64)?;
        self.put_packed_ints(&field_sets)
    }

    fn paths_section(&mut self) -> Result<(), FormatError> {
        let tree = std::mem::take(&mut self.path_tree);
        let count = tree.indices.len() as u64;
        self.put_u64(count)?;
        self.put_u64(count)?;
        self.put_packed_ints(&tree.indices)?;
        self.put_packed_ints(&tree.elements)?;
        self.put_packed_ints(&tree.jumps)
    }

    fn specs_section(&mut self) -> Result<(), FormatError> {
        let columns = std::mem::take(&mut self.specs);
        self.put_u64(columns[0].len() as u64)?;
        columns.iter().try_for_each(|column| self.put_packed_ints(column))
    }
}
