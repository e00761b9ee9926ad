//! Accessors: numbers of any component type at any place of a buffer, checked once and then read
//! one element at a time.
//!
//! Source: glTF 2.0 specification, sections 3.6.2 and 5.1. Bounds are checked in 64 bits before the
//! first read. Alignment is not asked for: bytes are put together one by one. An accessor without
//! a buffer view is all zeros, as the specification says.

use super::buffers::Buffers;
use super::json::JsonValue;
use super::{Tables, index_or, whole_or};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::limits::Budget;

/// What an accessor says of itself, tested for sense but not against any bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accessor<'a> {
    json: JsonValue<'a>,
    pub(super) number: u32,
    /// How many elements.
    pub(super) count: u64,
    pub(super) component: Component,
    /// Numbers in an element: 1 to 4, or 16 in a matrix.
    pub(super) width: usize,
    pub(super) normalized: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn of(number: u64) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }
}

impl<'a> Accessor<'a> {
    pub(super) fn find(tables: &Tables<'a>, number: u32, from: &str) -> Result<Self, MeshError> {
        let json = tables.accessors.item(number, from)?;
        let place = format!("accessors[{number}]");
        let component = component(json, &place)?;
        let width = match json.get("type").and_then(JsonValue::text) {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            // Columns of 4 bytes and more lie close together.
            Some("MAT4") => 16,
            _ => {
                let kind = json.get("type").map_or("missing".to_owned(), JsonValue::shown);
                let reason = format!("its type is {kind}, which no mesh has");
                return Err(MeshError::at(place, reason));
            }
        };
        let count = whole_or(json, "count", None, &place)?;
        let normalized = json.get("normalized").and_then(JsonValue::boolean).unwrap_or(false);
        Ok(Self { json, number, count, component, width, normalized })
    }

    pub(super) fn place(&self) -> String {
        format!("accessors[{}]", self.number)
    }

    /// Whether it has bytes of its own; without them it is zeros.
    pub(super) fn has_view(&self) -> bool {
        self.json.get("bufferView").is_some()
    }

    /// What reading an element costs: in a sparse list each is looked for by halving.
    pub(super) fn steps(&self) -> u64 {
        let sparse =
            self.json.get("sparse").and_then(|s| s.get("count")).and_then(JsonValue::whole);
        1 + sparse.map_or(0, |count| u64::from(u64::BITS - count.leading_zeros()))
    }

    /// Opens the buffers it reads.
    pub(super) fn open(
        &self,
        tables: &Tables<'a>,
        buffers: &mut Buffers<'a>,
        budget: &mut Budget,
    ) -> Result<(), MeshError> {
        let sparse = self.json.get("sparse");
        let place = self.place();
        for holder in [
            Some(self.json),
            sparse.and_then(|s| s.get("indices")),
            sparse.and_then(|s| s.get("values")),
        ]
        .into_iter()
        .flatten()
        {
            if let Some(view) = index_or(holder, "bufferView", &place)? {
                let json = tables.views.item(view, &place)?;
                if let Some(buffer) = index_or(json, "buffer", &place)? {
                    buffers.open(tables, buffer, &format!("bufferViews[{view}]"), budget)?;
                }
            }
        }
        Ok(())
    }

    /// Finds the bytes in opened buffers and tests that every element lies in them.
    pub(super) fn numbers<'b>(
        &self,
        tables: &Tables<'a>,
        buffers: &'b Buffers<'a>,
    ) -> Result<AccessorValues<'b>, MeshError> {
        let place = self.place();
        let base = match self.json.get("bufferView") {
            None => None,
            Some(_) => {
                let size = self.width * self.component.size();
                Some(Strided::find(tables, buffers, self.json, self.count, size, &place)?)
            }
        };
        let sparse = match self.json.get("sparse") {
            None => None,
            Some(sparse) => Some(self.sparse(tables, buffers, sparse)?),
        };
        let Self { component, width, normalized, .. } = *self;
        Ok(AccessorValues { base, sparse, component, width, normalized })
    }

    fn sparse<'b>(
        &self,
        tables: &Tables<'a>,
        buffers: &'b Buffers<'a>,
        sparse: JsonValue<'a>,
    ) -> Result<Sparse<'b>, MeshError> {
        let place = format!("{}.sparse", self.place());
        let missing = |key: &str| MeshError::at(&place, format!("{key} is missing"));
        let count = whole_or(sparse, "count", None, &place)?;
        let indices = sparse.get("indices").ok_or_else(|| missing("indices"))?;
        let values = sparse.get("values").ok_or_else(|| missing("values"))?;
        let component = component(indices, &place)?;
        let size = component.size();
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(MeshError::at(place, "its indices are no whole numbers"));
        }
        let indices = Strided::find(tables, buffers, indices, count, size, &place)?;
        let size = self.width * self.component.size();
        let values = Strided::find(tables, buffers, values, count, size, &place)?;
        tables.doc.tire(count)?;
        let mut before = None;
        for i in 0..count {
            let index = indices.whole(component, i);
            // Elements are looked up by halving, so their order matters.
            if before.is_some_and(|before| before >= index) || u64::from(index) >= self.count {
                let reason = format!("its indices do not rise from 0 to {} at {i}", self.count);
                return Err(MeshError::at(place, reason));
            }
            before = Some(index);
        }
        Ok(Sparse { count, component, indices, values })
    }
}

fn component(json: JsonValue, place: &str) -> Result<Component, MeshError> {
    let number = whole_or(json, "componentType", None, place)?;
    Component::of(number)
        .ok_or_else(|| MeshError::at(place, format!("componentType {number} is no kind of number")))
}

/// Elements at equal distances, all of them within `bytes`.
#[derive(Clone, Copy, Debug)]
struct Strided<'b> {
    bytes: &'b [u8],
    stride: usize,
}

impl<'b> Strided<'b> {
    /// `count` elements of `size` bytes, from the buffer view that `holder` names.
    fn find<'a>(
        tables: &Tables<'a>,
        buffers: &'b Buffers<'a>,
        holder: JsonValue<'a>,
        count: u64,
        size: usize,
        place: &str,
    ) -> Result<Self, MeshError> {
        let missing = |what: &str| MeshError::at(place, format!("{what} is missing"));
        let number = index_or(holder, "bufferView", place)?.ok_or_else(|| missing("bufferView"))?;
        let view = tables.views.item(number, place)?;
        let view_place = format!("bufferViews[{number}]");
        let buffer = index_or(view, "buffer", &view_place)?
            .ok_or_else(|| MeshError::at(&view_place, "buffer is missing"))?;
        let bytes = buffers.get(buffer).ok_or_else(|| missing("its buffer"))?;

        let start = whole_or(view, "byteOffset", Some(0), &view_place)?;
        let length = whole_or(view, "byteLength", None, &view_place)?;
        let within = start.checked_add(length).is_some_and(|end| end <= bytes.len() as u64);
        if !within {
            let n = bytes.len();
            let reason = format!("{length} bytes from {start} on, where its buffer has {n}");
            return Err(MeshError::at(view_place, reason));
        }
        let view_bytes = &bytes[start as usize..(start + length) as usize];

        let stride = whole_or(view, "byteStride", Some(size as u64), &view_place)?;
        if stride < size as u64 {
            let reason = format!("byteStride {stride}, where an element has {size} bytes");
            return Err(MeshError::at(view_place, reason));
        }
        let offset = whole_or(holder, "byteOffset", Some(0), place)?;
        let end = count
            .saturating_sub(1)
            .checked_mul(stride)
            .and_then(|last| last.checked_add(offset))
            .and_then(|last| last.checked_add(size as u64));
        if count > 0 && end.is_none_or(|end| end > length) {
            let reason = format!(
                "{count} elements from byte {offset} on do not fit into the {length} of {view_place}"
            );
            return Err(MeshError::at(place, reason));
        }
        let bytes = view_bytes.get(offset as usize..).unwrap_or_default();
        Ok(Self { bytes, stride: stride as usize })
    }

    fn element(&self, i: u64) -> &'b [u8] {
        &self.bytes[i as usize * self.stride..]
    }

    fn whole(&self, component: Component, i: u64) -> u32 {
        let b = self.element(i);
        match component {
            Component::U8 => u32::from(b[0]),
            Component::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Sparse<'b> {
    count: u64,
    component: Component,
    indices: Strided<'b>,
    values: Strided<'b>,
}

impl<'b> Sparse<'b> {
    /// Where the value of an element stands, if it is one of those replaced.
    fn find(&self, i: u64) -> Option<u64> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            match u64::from(self.indices.whole(self.component, middle)).cmp(&i) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }
}

/// The elements of an accessor. Elements must be asked for below its `count`.
#[derive(Clone, Copy, Debug)]
pub(super) struct AccessorValues<'b> {
    base: Option<Strided<'b>>,
    sparse: Option<Sparse<'b>>,
    component: Component,
    width: usize,
    normalized: bool,
}

impl<'b> AccessorValues<'b> {
    fn element(&self, i: u64) -> Option<&'b [u8]> {
        if let Some(sparse) = &self.sparse
            && let Some(place) = sparse.find(i)
        {
            return Some(sparse.values.element(place));
        }
        self.base.map(|base| base.element(i))
    }

    /// The first numbers of an element, those that it does not have 0; normalized integers between
    /// -1 and 1. None of them loses a digit.
    pub(super) fn vector<const N: usize>(&self, i: u64) -> [f64; N] {
        let mut vector = [0.0; N];
        let Some(b) = self.element(i) else { return vector };
        for (j, value) in vector.iter_mut().enumerate().take(self.width) {
            let b = &b[j * self.component.size()..];
            let (number, largest) = match self.component {
                Component::I8 => (f64::from(b[0] as i8), 127.0),
                Component::U8 => (f64::from(b[0]), 255.0),
                Component::I16 => (f64::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
                Component::U16 => (f64::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
                Component::U32 => (f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])), 1.0),
                Component::F32 => (f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])), 1.0),
            };
            // Two of the signed integers would be -1; the specification cuts the lower one off.
            let scaled = number / largest;
            *value = if self.normalized && largest > 1.0 { scaled.max(-1.0) } else { number };
        }
        vector
    }

    /// An element of one whole number.
    pub(super) fn whole(&self, i: u64) -> u32 {
        let Some(b) = self.element(i) else { return 0 };
        Strided { bytes: b, stride: 0 }.whole(self.component, 0)
    }
}
