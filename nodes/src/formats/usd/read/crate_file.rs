//! Decodes crate files (`.usdc`, versions 0.4 and later) into a layer.
//!
//! Every place and count in the file is checked before it is followed, every allocation is charged
//! to the budget first, and no path or field is visited without being charged, so that sets which
//! point at each other cannot make the work longer than the budget. Little-endian machines only.

use super::super::super::FormatError;
use super::super::coding::{
    ARRAY, COMPRESSED, INLINED, PAYLOAD, SHORTEST_COMPRESSED, Width, decode_ints, kind, lz4_unpack,
    spec_kind,
};
use super::budget::ReadBudget;
use super::text::arc_of;
use super::tree::{ParsedLayer, ParsedValue, PrimAttribute, Spec, Specifier, is_wanted};
use bytemuck::Pod;

/// How crate files begin.
pub(super) const MAGIC: &[u8] = b"PXR-USDC";

/// The most that LZ4 can unpack from a byte.
const LZ4_MAX_RATIO: u64 = 255;

/// Decodes a layer.
pub(super) fn read(bytes: &[u8], budget: &mut ReadBudget) -> Result<ParsedLayer, FormatError> {
    let mut file = CrateFile::open(bytes, budget)?;
    file.layer()
}

/// Reads forward from a place in the file.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn take(&mut self, length: u64) -> Result<&'a [u8], FormatError> {
        let start = self.at;
        let end = usize::try_from(length).ok().and_then(|length| start.checked_add(length));
        let taken = end.and_then(|end| self.bytes.get(start..end));
        let Some(taken) = taken else {
            let reason = format!("{length} bytes are expected here, but the file ends");
            return Err(FormatError::at(format!("byte {start}"), reason));
        };
        self.at += taken.len();
        Ok(taken)
    }

    pub(super) fn number<T: Pod>(&mut self) -> Result<T, FormatError> {
        Ok(bytemuck::pod_read_unaligned(self.take(size_of::<T>() as u64)?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, FormatError> {
        self.number()
    }

    /// Follows a jump that counts from where it stands.
    pub(super) fn jump(&mut self) -> Result<(), FormatError> {
        let start = self.at;
        let distance: i64 = self.number()?;
        let target = (start as i64).checked_add(distance).and_then(|at| usize::try_from(at).ok());
        self.at = target.ok_or_else(|| self.damaged("a jump leaves the file"))?;
        Ok(())
    }

    fn damaged(&self, reason: &str) -> FormatError {
        FormatError::at(format!("byte {}", self.at), reason)
    }
}

/// A path: its last name and the path it continues.
#[derive(Clone, Copy)]
struct Path {
    parent: u32,
    token: u32,
    is_property: bool,
}

/// Stands for no path, spec or prim.
const NONE: u32 = u32::MAX;

pub(super) struct CrateFile<'a, 'b> {
    bytes: &'a [u8],
    pub(super) budget: &'b mut ReadBudget,
    /// Minor version; all files so far are 0.x.
    pub(super) minor: u8,
    token_texts: Vec<u8>,
    /// Start and end of each token in `token_texts`.
    token_ranges: Vec<[u32; 2]>,
    /// Tokens of strings.
    strings: Vec<u32>,
    fields: Vec<(u32, u64)>,
    field_sets: Vec<i64>,
    paths: Vec<Path>,
    /// Paths, parents first, as the file orders them.
    path_order: Vec<u32>,
    /// Path, first field and kind of each spec.
    specs: Vec<[u32; 3]>,
}

impl<'a, 'b> CrateFile<'a, 'b> {
    // ---- sections ----------------------------------------------------------------------------

    fn open(bytes: &'a [u8], budget: &'b mut ReadBudget) -> Result<Self, FormatError> {
        let mut header = Cursor { bytes, at: MAGIC.len() };
        let [major, minor, ..]: [u8; 8] = header.number()?;
        if major != 0 || minor < 4 {
            let reason = format!("crate version {major}.{minor}: 0.4 to 0.x can be read");
            return Err(FormatError::at("byte 8", reason));
        }
        let mut contents = header;
        contents.at = usize::try_from(header.u64()?).unwrap_or(usize::MAX);
        let mut file = Self {
            bytes,
            budget,
            minor,
            token_texts: Vec::new(),
            token_ranges: Vec::new(),
            strings: Vec::new(),
            fields: Vec::new(),
            field_sets: Vec::new(),
            paths: Vec::new(),
            path_order: Vec::new(),
            specs: Vec::new(),
        };
        let section = |name: &str| find_section(contents, name);
        file.read_tokens(section("TOKENS")?)?;
        file.read_strings(section("STRINGS")?)?;
        file.read_fields(section("FIELDS")?)?;
        file.read_field_sets(section("FIELDSETS")?)?;
        file.read_paths(section("PATHS")?)?;
        file.read_specs(section("SPECS")?)?;
        Ok(file)
    }

    fn read_tokens(&mut self, mut section: Cursor<'a>) -> Result<(), FormatError> {
        let (count, length) = (section.u64()?, section.u64()?);
        let packed = section.u64()?;
        let packed = section.take(packed)?;
        self.token_texts = self.unpack(packed, length)?;
        // Each token takes at least the 0 that ends it.
        if count > self.token_texts.len() as u64 || self.token_texts.len() > NONE as usize {
            return Err(section.damaged("more tokens than there are texts"));
        }
        self.budget.charge_items::<[u32; 2]>(count)?;
        self.token_ranges.reserve_exact(count as usize);
        let mut start = 0u32;
        for text in self.token_texts.split(|&byte| byte == 0).take(count as usize) {
            let end = start + text.len() as u32;
            self.token_ranges.push([start, end]);
            start = end + 1;
        }
        Ok(())
    }

    fn read_strings(&mut self, mut section: Cursor<'a>) -> Result<(), FormatError> {
        let count = section.u64()?;
        self.strings = self.pod(&mut section, count)?;
        Ok(())
    }

    fn read_fields(&mut self, mut section: Cursor<'a>) -> Result<(), FormatError> {
        let count = section.u64()?;
        let tokens = self.packed_ints(&mut section, count, Width::Bits32)?;
        let packed = section.u64()?;
        let packed = section.take(packed)?;
        let values = self.unpack(packed, count.saturating_mul(8))?;
        self.budget.charge_items::<(u32, u64)>(count)?;
        let values = values.chunks_exact(8).map(bytemuck::pod_read_unaligned::<u64>);
        self.fields = tokens.iter().map(|&token| token as u32).zip(values).collect();
        Ok(())
    }

    fn read_field_sets(&mut self, mut section: Cursor<'a>) -> Result<(), FormatError> {
        let count = section.u64()?;
        self.field_sets = self.packed_ints(&mut section, count, Width::Bits32)?;
        Ok(())
    }

    fn read_specs(&mut self, mut section: Cursor<'a>) -> Result<(), FormatError> {
        let count = section.u64()?;
        let paths = self.packed_ints(&mut section, count, Width::Bits32)?;
        let sets = self.packed_ints(&mut section, count, Width::Bits32)?;
        let kinds = self.packed_ints(&mut section, count, Width::Bits32)?;
        self.budget.charge_items::<[u32; 3]>(count)?;
        self.specs = (paths.iter().zip(&sets).zip(&kinds))
            .map(|((&path, &set), &kind)| [path as u32, set as u32, kind as u32])
            .collect();
        Ok(())
    }

    fn read_paths(&mut self, mut section: Cursor<'a>) -> Result<(), FormatError> {
        let (paths, entries) = (section.u64()?, section.u64()?);
        let indices = self.packed_ints(&mut section, entries, Width::Bits32)?;
        let elements = self.packed_ints(&mut section, entries, Width::Bits32)?;
        let jumps = self.packed_ints(&mut section, entries, Width::Bits32)?;
        // The empty path, where a reference to a default prim leads, is counted and not in the tree.
        if paths > entries.saturating_add(1) {
            return Err(section.damaged("more paths than the tree of paths has"));
        }
        self.budget.charge_items::<Path>(paths)?;
        self.budget.charge_items::<u32>(paths)?;
        let missing = Path { parent: NONE, token: NONE, is_property: false };
        self.paths = vec![missing; paths as usize];
        self.path_order = Vec::with_capacity(paths as usize);
        self.walk_paths(&indices, &elements, &jumps)
            .ok_or_else(|| section.damaged("the tree of paths is damaged"))
    }

    /// Follows the tree of paths: children come next, siblings after a jump. `None` when an entry is
    /// outside, a path comes twice or a path has no parent.
    fn walk_paths(&mut self, indices: &[i64], elements: &[i64], jumps: &[i64]) -> Option<()> {
        let mut siblings: Vec<(usize, u32)> = vec![(0, NONE)];
        while let Some((mut entry, mut parent)) = siblings.pop() {
            loop {
                let index = u32::try_from(*indices.get(entry)?).ok()?;
                let path = self.paths.get_mut(index as usize)?;
                let element = elements[entry];
                if path.token != NONE {
                    return None;
                }
                *path = Path {
                    parent,
                    token: u32::try_from(element.unsigned_abs()).ok().filter(|&t| t != NONE)?,
                    is_property: element < 0,
                };
                // At most as many as there are paths, none comes twice.
                self.path_order.push(index);
                let jump = jumps[entry];
                let has_child = jump > 0 || jump == -1;
                if has_child && jump > 0 {
                    siblings.push((entry.checked_add(jump as usize)?, parent));
                }
                if has_child {
                    parent = index;
                } else if jump != 0 {
                    break;
                }
                entry += 1;
            }
        }
        Some(())
    }

    // ---- packed data -------------------------------------------------------------------------

    /// Unpacks exactly `length` bytes.
    fn unpack(&mut self, packed: &[u8], length: u64) -> Result<Vec<u8>, FormatError> {
        let most = LZ4_MAX_RATIO * packed.len() as u64;
        if length > most {
            return Err(FormatError::at("compressed block", "it states more than it can hold"));
        }
        self.budget.charge(length)?;
        let mut bytes = vec![0; length as usize];
        let filled = lz4_unpack(packed, &mut bytes)?;
        bytes.truncate(filled);
        Ok(bytes)
    }

    /// `count` integers that are packed at the cursor, after the length of the packing.
    fn packed_ints(
        &mut self,
        cursor: &mut Cursor<'a>,
        count: u64,
        width: Width,
    ) -> Result<Vec<i64>, FormatError> {
        if count == 0 {
            // OpenUSD packs nothing, or an empty block, depending on who asks.
            if cursor.bytes.len() - cursor.at.min(cursor.bytes.len()) >= 8 {
                let packed = cursor.u64()?;
                cursor.take(packed)?;
            }
            return Ok(Vec::new());
        }
        let start = *cursor;
        let packed = cursor.u64()?;
        let packed = cursor.take(packed)?;
        let length = width.longest(count).min(LZ4_MAX_RATIO * packed.len() as u64);
        if count / 4 > length {
            return Err(start.damaged("more integers are stated than can be packed here"));
        }
        let coded = self.unpack(packed, length)?;
        self.budget.charge_items::<i64>(count)?;
        let decoded = decode_ints(&coded, count as usize, width);
        self.budget.give_back(length);
        decoded.ok_or_else(|| start.damaged("packed integers end too early"))
    }

    /// Plain values at the cursor.
    pub(super) fn pod<T: Pod>(
        &mut self,
        cursor: &mut Cursor<'a>,
        count: u64,
    ) -> Result<Vec<T>, FormatError> {
        let bytes = cursor.take(count.saturating_mul(size_of::<T>() as u64))?;
        self.budget.charge(bytes.len() as u64)?;
        let mut values = vec![T::zeroed(); count as usize];
        bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(bytes);
        Ok(values)
    }

    pub(super) fn token(&self, number: u32) -> Result<&str, FormatError> {
        let error = || FormatError::at(format!("token {number}"), "missing, or no UTF-8");
        let [start, end] = *self.token_ranges.get(number as usize).ok_or_else(error)?;
        str::from_utf8(&self.token_texts[start as usize..end as usize]).map_err(|_| error())
    }

    pub(super) fn string(&self, number: u32) -> Result<&str, FormatError> {
        let error = || FormatError::at(format!("string {number}"), "missing");
        self.token(*self.strings.get(number as usize).ok_or_else(error)?)
    }

    // ---- prims -------------------------------------------------------------------------------

    fn layer(&mut self) -> Result<ParsedLayer, FormatError> {
        let count = self.paths.len();
        self.budget.charge_items::<[u32; 2]>(count as u64)?;
        let mut spec_of_path = vec![NONE; count];
        for (spec, [path, ..]) in self.specs.iter().enumerate() {
            if let Some(slot) = spec_of_path.get_mut(*path as usize) {
                *slot = spec as u32;
            }
        }
        let mut prim_of_path = vec![NONE; count];
        let mut layer = ParsedLayer::default();
        for path in std::mem::take(&mut self.path_order) {
            let Some(&[_, set, spec]) = self.specs.get(spec_of_path[path as usize] as usize) else {
                continue;
            };
            let Path { parent, token, is_property } = self.paths[path as usize];
            let owner = prim_of_path.get(parent as usize).copied();
            match (spec, is_property, owner) {
                (spec_kind::LAYER, _, None) => self.layer_metadata(set, &mut layer)?,
                (spec_kind::PRIM | spec_kind::VARIANT, false, Some(owner)) => {
                    let is_root = self.paths[parent as usize].parent == NONE;
                    if owner == NONE && (!is_root || spec == spec_kind::VARIANT) {
                        continue;
                    }
                    let owner = (owner != NONE).then_some(owner as usize);
                    let prim = self.spec(set, token, owner, spec == spec_kind::VARIANT)?;
                    prim_of_path[path as usize] = layer.specs.len() as u32;
                    self.budget.push(&mut layer.specs, prim)?;
                }
                (spec_kind::ATTRIBUTE, true, Some(owner)) if owner != NONE => {
                    let prim = &mut layer.specs[owner as usize];
                    if is_wanted(&prim.type_name, self.token(token)?) {
                        let attribute = self.attribute(set, token)?;
                        self.budget.push(&mut prim.attributes, attribute)?;
                    }
                }
                _ => {}
            }
        }
        Ok(layer)
    }

    /// A path as text, without the variants on the way; charged for.
    pub(super) fn path_text(&mut self, path: u32) -> Result<String, FormatError> {
        let error = || FormatError::at(format!("path {path}"), "missing");
        let mut names = Vec::new();
        let mut next = *self.paths.get(path as usize).ok_or_else(error)?;
        // Parents come before their children, so this ends.
        while let Some(parent) = self.paths.get(next.parent as usize).copied() {
            let name = self.token(next.token)?.to_owned();
            self.budget.charge(name.len() as u64 + 32)?;
            names.push(name);
            next = parent;
        }
        let names = names.iter().rev().filter(|name| !name.starts_with('{'));
        Ok(names.flat_map(|name| ["/", name.as_str()]).collect())
    }

    /// The fields of a set: token and value representation. Charged, as sets may overlap.
    fn fields_of(&mut self, set: u32) -> Result<Vec<(u32, u64)>, FormatError> {
        let error = || FormatError::at(format!("field set {set}"), "missing, or without an end");
        let rest = self.field_sets.get(set as usize..).ok_or_else(error)?;
        let length = rest.iter().position(|&field| field < 0).ok_or_else(error)?;
        self.budget.charge_items::<(u32, u64)>(length as u64)?;
        let field = |&field: &i64| self.fields.get(field as usize).copied().ok_or_else(error);
        rest[..length].iter().map(field).collect()
    }

    fn layer_metadata(&mut self, set: u32, layer: &mut ParsedLayer) -> Result<(), FormatError> {
        for (name, value) in self.fields_of(set)? {
            match self.token(name)? {
                "metersPerUnit" => {
                    let value = self.value(value)?.map(|value| value.numbers());
                    layer.meters_per_unit = value.and_then(|numbers| numbers.first().copied());
                }
                "upAxis" => layer.up_axis = self.text(value)?,
                "defaultPrim" => layer.default_prim = self.text(value)?,
                "subLayers" => layer.sub_layers = self.sub_layers(value)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn spec(
        &mut self,
        set: u32,
        name: u32,
        parent: Option<usize>,
        is_variant: bool,
    ) -> Result<Spec, FormatError> {
        let name = self.token(name)?.to_owned();
        self.budget.charge(name.len() as u64)?;
        let mut spec = Spec { parent, name, ..Spec::default() };
        if is_variant {
            // As in {set=name}.
            let inner = spec.name.strip_prefix('{').and_then(|name| name.strip_suffix('}'));
            let (set, name) = inner.and_then(|inner| inner.split_once('=')).unwrap_or_default();
            (spec.variant_of, spec.name) = (Some(set.to_owned()), name.to_owned());
        }
        for (name, value) in self.fields_of(set)? {
            let is_true = Some(value & PAYLOAD != 0);
            match self.token(name)? {
                "specifier" => {
                    spec.specifier = match value & PAYLOAD {
                        0 => Specifier::Def,
                        1 => Specifier::Over,
                        _ => Specifier::Class,
                    }
                }
                "typeName" => spec.type_name = self.text(value)?.unwrap_or_default(),
                "active" => spec.is_active = is_true,
                "instanceable" => spec.is_instanceable = is_true,
                "clips" => spec.has_clips = true,
                "variantSelection" => spec.selections = self.selections(value)?,
                name => {
                    if let Some(arc) = arc_of(name) {
                        spec.arcs.extend(self.arcs(arc, value)?);
                    }
                }
            }
        }
        Ok(spec)
    }

    fn attribute(&mut self, set: u32, name: u32) -> Result<PrimAttribute, FormatError> {
        let name = self.token(name)?.to_owned();
        self.budget.charge(name.len() as u64)?;
        let mut attribute = PrimAttribute { name, ..PrimAttribute::default() };
        let (mut default, mut samples) = (None, None);
        for (field, value) in self.fields_of(set)? {
            match self.token(field)? {
                "typeName" => attribute.type_name = self.text(value)?.unwrap_or_default(),
                "interpolation" => attribute.interpolation = self.text(value)?,
                "default" => default = Some(value),
                "timeSamples" => samples = Some(value),
                _ => {}
            }
        }
        attribute.value = match (default, samples) {
            (Some(value), samples) => {
                attribute.is_blocked = (value >> 48) as u8 == kind::VALUE_BLOCK;
                attribute.unread = match samples {
                    Some(samples) => self.samples(samples)?.0.len() as u64,
                    None => 0,
                };
                self.value(value)?
            }
            (None, Some(samples)) => {
                let (earliest, n) = self.earliest_sample(samples)?;
                attribute.unread = n.saturating_sub(1);
                earliest
            }
            (None, None) => None,
        };
        Ok(attribute)
    }

    /// The text of a token or string value.
    fn text(&mut self, value: u64) -> Result<Option<String>, FormatError> {
        Ok(self.value(value)?.and_then(|value| value.as_text().map(str::to_owned)))
    }

    // ---- values ------------------------------------------------------------------------------

    pub(super) fn at(&self, value: u64) -> Cursor<'a> {
        let at = usize::try_from(value & PAYLOAD).unwrap_or(usize::MAX);
        Cursor { bytes: self.bytes, at }
    }

    /// Number of values of an array; its width changed with the versions.
    fn array_length(&self, cursor: &mut Cursor<'a>) -> Result<u64, FormatError> {
        if self.minor < 5 {
            cursor.number::<u32>()?; // rank, always 1
        }
        if self.minor < 7 { Ok(cursor.number::<u32>()? as u64) } else { cursor.u64() }
    }

    /// A value; `None` for types that curves have no use for, and for blocks.
    fn value(&mut self, value: u64) -> Result<Option<ParsedValue>, FormatError> {
        let number = (value >> 48) as u8;
        let Some(element) = Element::of(number) else { return Ok(None) };
        if value & ARRAY == 0 {
            if value & INLINED != 0 {
                return self.inlined(element, value & PAYLOAD);
            }
            return self.plain(element, &mut self.at(value), 1).map(Some);
        }
        if value & PAYLOAD == 0 {
            return self.plain(element, &mut Cursor { bytes: &[], at: 0 }, 0).map(Some);
        }
        let mut cursor = self.at(value);
        let count = self.array_length(&mut cursor)?;
        if value & COMPRESSED != 0 {
            return self.compressed(element, &mut cursor, count).map(Some);
        }
        self.plain(element, &mut cursor, count).map(Some)
    }

    /// A value that its own representation holds: 32 bits, or a tuple of small integers.
    fn inlined(
        &mut self,
        element: Element,
        payload: u64,
    ) -> Result<Option<ParsedValue>, FormatError> {
        let bits = payload as u32;
        let small = |index: usize| bits.to_le_bytes()[index] as i8 as f64;
        Ok(Some(match (element.scalar, element.per) {
            (Scalar::Bool | Scalar::I32, 1) => ParsedValue::Ints(vec![bits as i32]),
            (Scalar::U8 | Scalar::U32 | Scalar::U64, 1) => ParsedValue::Longs(vec![bits as i64]),
            (Scalar::I64, 1) => ParsedValue::Longs(vec![bits as i32 as i64]),
            (Scalar::F16, 1) => ParsedValue::Floats(vec![float_of_half(bits as u16)]),
            (Scalar::F32, 1) => ParsedValue::Floats(vec![f32::from_bits(bits)]),
            (Scalar::F64, 1) => {
                ParsedValue::Doubles { per: 1, values: vec![f32::from_bits(bits) as f64] }
            }
            (Scalar::Token, _) => ParsedValue::Texts(self.copied(&[bits], Self::token)?),
            (Scalar::String, _) => ParsedValue::Texts(self.copied(&[bits], Self::string)?),
            // Two halves are no longer than 32 bits and so never reduced to integers.
            (Scalar::F16, 2) => {
                let [x, y] = [bits as u16, (bits >> 16) as u16].map(float_of_half);
                tuples(2, vec![x, y])
            }
            (Scalar::F64, 16) => {
                let mut values = vec![0.0; 16];
                (0..4).for_each(|index| values[5 * index] = small(index));
                ParsedValue::Doubles { per: 16, values }
            }
            (Scalar::F64, per) => {
                ParsedValue::Doubles { per, values: (0..per).map(small).collect() }
            }
            (_, per) => tuples(per, (0..per).map(|index| small(index) as f32).collect()),
        }))
    }

    /// Values that lie in the file as in memory.
    fn plain(
        &mut self,
        element: Element,
        cursor: &mut Cursor<'a>,
        count: u64,
    ) -> Result<ParsedValue, FormatError> {
        let per = element.per;
        let numbers = count.saturating_mul(per as u64);
        Ok(match element.scalar {
            Scalar::Bool => {
                let bytes = cursor.take(count)?;
                self.budget.charge_items::<i32>(count)?;
                ParsedValue::Ints(bytes.iter().map(|&byte| (byte != 0) as i32).collect())
            }
            Scalar::U8 => {
                let bytes = cursor.take(count)?;
                self.budget.charge_items::<i64>(count)?;
                ParsedValue::Longs(bytes.iter().map(|&byte| byte as i64).collect())
            }
            Scalar::I32 => ParsedValue::Ints(self.pod(cursor, count)?),
            Scalar::U32 => {
                let values: Vec<u32> = self.pod(cursor, count)?;
                self.budget.charge_items::<i64>(count)?;
                ParsedValue::Longs(values.iter().map(|&value| value as i64).collect())
            }
            Scalar::I64 | Scalar::U64 => ParsedValue::Longs(self.pod(cursor, count)?),
            Scalar::F16 => {
                let halves: Vec<u16> = self.pod(cursor, numbers)?;
                self.budget.charge_items::<f64>(numbers)?;
                tuples(per, halves.iter().map(|&half| float_of_half(half)).collect())
            }
            Scalar::F32 => match per {
                2 => ParsedValue::Float2s(self.pod(cursor, count)?),
                3 => ParsedValue::Float3s(self.pod(cursor, count)?),
                _ => {
                    let values: Vec<f32> = self.pod(cursor, numbers)?;
                    self.budget.charge_items::<f64>(if per == 1 { 0 } else { numbers })?;
                    tuples(per, values)
                }
            },
            Scalar::F64 => ParsedValue::Doubles { per, values: self.pod(cursor, numbers)? },
            Scalar::Token => {
                let tokens: Vec<u32> = self.pod(cursor, count)?;
                ParsedValue::Texts(self.copied(&tokens, Self::token)?)
            }
            Scalar::String => {
                let strings: Vec<u32> = self.pod(cursor, count)?;
                ParsedValue::Texts(self.copied(&strings, Self::string)?)
            }
        }
        .with_real_part_first(element.is_quaternion))
    }

    /// Integers as differences, or floats as integers (`i`) or indices into a table (`t`).
    fn compressed(
        &mut self,
        element: Element,
        cursor: &mut Cursor<'a>,
        count: u64,
    ) -> Result<ParsedValue, FormatError> {
        // Files say "compressed" of arrays too short to be so.
        if count < SHORTEST_COMPRESSED as u64 {
            return self.plain(element, cursor, count);
        }
        match (element.scalar, element.per) {
            (Scalar::I32, 1) => {
                let values = self.packed_ints(cursor, count, Width::Bits32)?;
                self.budget.charge_items::<i32>(count)?;
                self.budget.give_back(8 * count);
                Ok(ParsedValue::Ints(values.iter().map(|&value| value as i32).collect()))
            }
            (Scalar::U32, 1) => {
                let mut values = self.packed_ints(cursor, count, Width::Bits32)?;
                values.iter_mut().for_each(|value| *value = *value as u32 as i64);
                Ok(ParsedValue::Longs(values))
            }
            (Scalar::I64 | Scalar::U64, 1) => {
                Ok(ParsedValue::Longs(self.packed_ints(cursor, count, Width::Bits64)?))
            }
            (Scalar::F16 | Scalar::F32 | Scalar::F64, 1) => {
                self.compressed_floats(element, cursor, count)
            }
            _ => Err(cursor.damaged("a compressed array of a type that is never compressed")),
        }
    }

    fn compressed_floats(
        &mut self,
        element: Element,
        cursor: &mut Cursor<'a>,
        count: u64,
    ) -> Result<ParsedValue, FormatError> {
        let table = match cursor.number::<u8>()? {
            b'i' => None,
            b't' => {
                let length: u32 = cursor.number()?;
                Some(self.plain(element, cursor, length as u64)?.numbers())
            }
            _ => return Err(cursor.damaged("floats are compressed in an unknown way")),
        };
        let integers = self.packed_ints(cursor, count, Width::Bits32)?;
        let numbers = integers.iter().map(|&integer| match &table {
            None => Some(integer as f64),
            Some(table) => table.get(integer as u32 as usize).copied(),
        });
        let value = if element.scalar == Scalar::F64 {
            self.budget.charge_items::<f64>(count)?;
            let values: Option<Vec<f64>> = numbers.collect();
            values.map(|values| ParsedValue::Doubles { per: 1, values })
        } else {
            self.budget.charge_items::<f32>(count)?;
            let values: Option<Vec<f32>> = numbers.map(|n| n.map(|n| n as f32)).collect();
            values.map(ParsedValue::Floats)
        };
        self.budget.give_back(8 * count);
        value.ok_or_else(|| cursor.damaged("an index is outside the table of floats"))
    }

    /// Copies of texts by number, charged one by one: many may be the same long one.
    pub(super) fn copied(
        &mut self,
        numbers: &[u32],
        text: fn(&Self, u32) -> Result<&str, FormatError>,
    ) -> Result<Vec<String>, FormatError> {
        let mut texts = Vec::new();
        for &number in numbers {
            let copy = text(self, number)?.to_owned();
            self.budget.charge(copy.len() as u64)?;
            self.budget.push(&mut texts, copy)?;
        }
        Ok(texts)
    }

    /// The value at the earliest time, and how many there are.
    fn earliest_sample(&mut self, value: u64) -> Result<(Option<ParsedValue>, u64), FormatError> {
        let (times, mut values) = self.samples(value)?;
        let earliest = (0..times.len()).min_by(|&a, &b| times[a].total_cmp(&times[b]));
        let Some(earliest) = earliest else { return Ok((None, 0)) };
        values.take(8 * earliest as u64)?;
        let value = values.u64()?;
        Ok((self.value(value)?, times.len() as u64))
    }

    /// `jump → times, jump → count, values`: times of samples, and where their values begin.
    fn samples(&mut self, value: u64) -> Result<(Vec<f64>, Cursor<'a>), FormatError> {
        let mut cursor = self.at(value);
        if (value >> 48) as u8 != kind::TIME_SAMPLES || value & INLINED != 0 {
            return Ok((vec![], cursor));
        }
        cursor.jump()?;
        let times = cursor.u64()?;
        cursor.jump()?;
        let count = cursor.u64()?;
        let mut times_cursor = self.at(times);
        let n_times = times_cursor.u64()?;
        let mut times: Vec<f64> = self.pod(&mut times_cursor, n_times)?;
        times.truncate(usize::try_from(count).unwrap_or(usize::MAX));
        Ok((times, cursor))
    }
}

fn find_section<'a>(mut contents: Cursor<'a>, name: &str) -> Result<Cursor<'a>, FormatError> {
    let count = contents.u64()?;
    for _ in 0..count {
        let stated = contents.take(16)?;
        let (start, length) = (contents.u64()?, contents.u64()?);
        let stated = stated.split(|&byte| byte == 0).next().unwrap_or(stated);
        if stated == name.as_bytes() {
            let end = start.checked_add(length).and_then(|end| usize::try_from(end).ok());
            let bytes = end.and_then(|end| contents.bytes.get(..end));
            let error = || FormatError::at(format!("section {name}"), "it lies outside the file");
            return Ok(Cursor { bytes: bytes.ok_or_else(error)?, at: start as usize });
        }
    }
    Err(FormatError::at("table of contents", format!("there is no section {name}")))
}

/// What the values of a type are made of.
#[derive(Clone, Copy)]
struct Element {
    scalar: Scalar,
    /// How many scalars a value has.
    per: usize,
    is_quaternion: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Scalar {
    Bool,
    U8,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
    Token,
    String,
}

impl Element {
    fn of(number: u8) -> Option<Self> {
        let (scalar, per) = match number {
            kind::BOOL => (Scalar::Bool, 1),
            kind::UCHAR => (Scalar::U8, 1),
            kind::INT => (Scalar::I32, 1),
            kind::UINT => (Scalar::U32, 1),
            kind::INT64 => (Scalar::I64, 1),
            kind::UINT64 => (Scalar::U64, 1),
            kind::HALF => (Scalar::F16, 1),
            kind::FLOAT => (Scalar::F32, 1),
            kind::DOUBLE => (Scalar::F64, 1),
            kind::STRING => (Scalar::String, 1),
            kind::TOKEN | kind::ASSET => (Scalar::Token, 1),
            kind::MATRIX4D => (Scalar::F64, 16),
            kind::QUATD => (Scalar::F64, 4),
            kind::QUATF => (Scalar::F32, 4),
            kind::QUATH => (Scalar::F16, 4),
            kind::VEC2D => (Scalar::F64, 2),
            kind::VEC2F => (Scalar::F32, 2),
            kind::VEC2H => (Scalar::F16, 2),
            kind::VEC3D => (Scalar::F64, 3),
            kind::VEC3F => (Scalar::F32, 3),
            kind::VEC3H => (Scalar::F16, 3),
            _ => return None,
        };
        let is_quaternion = matches!(number, kind::QUATD | kind::QUATF | kind::QUATH);
        Some(Self { scalar, per, is_quaternion })
    }
}

/// Floats in tuples of `per`.
fn tuples(per: usize, values: Vec<f32>) -> ParsedValue {
    match per {
        1 => ParsedValue::Floats(values),
        2 => ParsedValue::Float2s(values.chunks_exact(2).map(glam::Vec2::from_slice).collect()),
        3 => ParsedValue::Float3s(values.chunks_exact(3).map(glam::Vec3::from_slice).collect()),
        _ => {
            ParsedValue::Doubles { per, values: values.iter().map(|&value| value as f64).collect() }
        }
    }
}

impl ParsedValue {
    /// Crate files put the real part of quaternions last, text files first.
    fn with_real_part_first(mut self, is_quaternion: bool) -> Self {
        if let (true, Self::Doubles { values, .. }) = (is_quaternion, &mut self) {
            values.chunks_exact_mut(4).for_each(|quaternion| quaternion.rotate_right(1));
        }
        self
    }
}

/// IEEE 754 half precision to single.
fn float_of_half(half: u16) -> f32 {
    let sign = ((half as u32) & 0x8000) << 16;
    let exponent = (half >> 10) & 0x1F;
    let mantissa = (half & 0x3FF) as u32;
    let magnitude = match exponent {
        // Subnormal: a multiple of 2^-24, exact as a float.
        0 => mantissa as f32 / 16_777_216.0,
        0x1F => f32::from_bits(0x7F80_0000 | mantissa << 13),
        _ => f32::from_bits((exponent as u32 + 112) << 23 | mantissa << 13),
    };
    f32::from_bits(magnitude.to_bits() | sign)
}

#[cfg(test)]
mod tests {
    use super::super::super::super::Chunks;
    use super::super::super::coding::{lz4_pack, pack_ints};
    use super::super::super::groom::{CurveSet, GroomStage, UpAxis, write_usdc};
    use super::super::read_alone;
    use super::*;
    use glam::Vec3;

    fn small_file() -> Vec<u8> {
        let hair = CurveSet {
            name: "hair".into(),
            counts: Chunks::from(vec![4; 8]),
            points: Chunks::from(vec![Vec3::ONE; 32]),
            ..CurveSet::default()
        };
        let stage = GroomStage {
            name: "Groom".into(),
            doc: "doc".into(),
            generator: "tests".into(),
            graph_hash: "0".into(),
            seed: 1,
            meters_per_unit: 0.01,
            up_axis: UpAxis::Y,
            groups: vec![hair],
            skins: vec![],
        };
        let mut out = std::io::Cursor::new(Vec::new());
        write_usdc(&stage, &mut out).unwrap();
        out.into_inner()
    }

    /// The unpacked columns of integers of a section, behind so many counts.
    fn columns(bytes: &[u8], name: &str, counts: usize, columns: usize) -> Vec<Vec<i64>> {
        let budget = &mut ReadBudget::for_file(bytes.len());
        let mut contents = Cursor { bytes, at: 16 };
        contents.at = contents.u64().unwrap() as usize;
        let mut section = find_section(contents, name).unwrap();
        let mut file = CrateFile::open(bytes, budget).unwrap();
        let count = (0..counts).map(|_| section.u64().unwrap()).last().unwrap();
        let column = |_| file.packed_ints(&mut section, count, Width::Bits32).unwrap();
        (0..columns).map(column).collect()
    }

    /// The file with another section of this name, put at its end.
    fn with_section(bytes: &[u8], name: &str, section: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        let at = bytes.windows(name.len() + 1).rposition(|window| {
            window[..name.len()] == *name.as_bytes() && window[name.len()] == 0
        });
        let entry = at.unwrap() + 16;
        let place = [bytes.len() as u64, section.len() as u64];
        bytes[entry..entry + 16].copy_from_slice(bytemuck::cast_slice(&place));
        bytes.extend_from_slice(section);
        bytes
    }

    fn section_of(counts: usize, columns: &[Vec<i64>]) -> Vec<u8> {
        let count = columns[0].len() as u64;
        let mut section: Vec<u8> = (0..counts).flat_map(|_| count.to_le_bytes()).collect();
        for column in columns {
            let packed = pack_ints(column.iter().copied(), Width::Bits32);
            section.extend((packed.len() as u64).to_le_bytes());
            section.extend(packed);
        }
        section
    }

    /// Bit flips seldom get past LZ4: here the tables themselves point anywhere.
    #[test]
    fn tables_that_point_anywhere_are_read_or_refused() {
        let bytes = small_file();
        let mut state = 1u64;
        let mut below = |limit: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % limit
        };
        let mut outcomes = [0; 2];
        for (name, counts, n_columns) in [("PATHS", 2, 3), ("SPECS", 1, 3), ("FIELDSETS", 1, 1)] {
            let sound = columns(&bytes, name, counts, n_columns);
            let rebuilt = with_section(&bytes, name, &section_of(counts, &sound));
            assert_eq!(read_alone(&rebuilt, "usdc"), read_alone(&bytes, "usdc"));
            for _ in 0..300 {
                let mut columns = sound.clone();
                let column = &mut columns[below(n_columns)];
                let values = [-2, -1, 0, 1, i32::MAX as i64, i32::MIN as i64, below(200) as i64];
                let at = below(column.len());
                column[at] = values[below(values.len())];
                let changed = with_section(&bytes, name, &section_of(counts, &columns));
                outcomes[read_alone(&changed, "usdc").is_ok() as usize] += 1;
            }
        }
        assert!(outcomes.iter().all(|&count| count > 50), "{outcomes:?}");
    }

    /// The places and types of values are the other half of what a file can lie about.
    #[test]
    fn values_that_lie_anywhere_are_read_or_refused() {
        let bytes = small_file();
        let budget = &mut ReadBudget::for_file(bytes.len());
        let fields = CrateFile::open(&bytes, budget).unwrap().fields;
        let tokens: Vec<i64> = fields.iter().map(|&(token, _)| token as i64).collect();
        let mut outcomes = [0; 2];
        for changed in 0..fields.len() {
            for kind in 0..62u64 {
                for flags in [0, ARRAY, INLINED, ARRAY | COMPRESSED] {
                    let payload = [fields[changed].1 & PAYLOAD, 88, 1 << 40][kind as usize % 3];
                    let mut values: Vec<u64> = fields.iter().map(|&(_, value)| value).collect();
                    values[changed] = flags | kind << 48 | payload;
                    let mut section = section_of(1, std::slice::from_ref(&tokens));
                    let packed = lz4_pack(bytemuck::cast_slice(&values));
                    section.extend((packed.len() as u64).to_le_bytes());
                    section.extend(packed);
                    let file = with_section(&bytes, "FIELDS", &section);
                    outcomes[read_alone(&file, "usdc").is_ok() as usize] += 1;
                }
            }
        }
        assert!(outcomes.iter().all(|&count| count > 50), "{outcomes:?}");
    }

    #[test]
    fn tables_that_unfold_without_end_are_refused() {
        let bytes = small_file();
        let million = vec![0i64; 1_000_000];
        let field_sets: Vec<i64> = million.iter().copied().chain([-1]).collect();
        let sets = section_of(1, &[field_sets]);
        let changed = with_section(&bytes, "FIELDSETS", &sets);
        assert!(read_alone(&changed, "usdc").is_err());
        let specs = section_of(1, &[million.clone(), million.clone(), million]);
        assert!(read_alone(&with_section(&bytes, "SPECS", &specs), "usdc").is_err());
    }

    #[test]
    fn halves_become_the_floats_they_stand_for() {
        let cases = [
            (0x0000, 0.0),
            (0x3C00, 1.0),
            (0xC000, -2.0),
            (0x7BFF, 65504.0),
            (0x0001, 5.960_464_5e-8),
            (0x3555, 0.333_251_95),
            (0xFC00, f32::NEG_INFINITY),
        ];
        for (half, float) in cases {
            assert_eq!(float_of_half(half).to_bits(), f32::to_bits(float), "{half:#06x}");
        }
    }
}
