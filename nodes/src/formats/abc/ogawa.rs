//! Writes an Ogawa archive, the container of Alembic: a tree of objects, each with a tree of properties, streaming.
//!
//! ```text
//! [Ogawa ff 00 01] [u64 place of the root group]  then data and groups in any order:
//! data:   [u64 size] [bytes]
//! group:  [u64 n] [n x u64 place of a child; top bit: data, else a group; 0 past it: empty]
//! root:   [file version] [library version] [top object] [archive metadata] [time samplings] [metadata table]
//! object: [properties] [child objects ...] [headers of children, 32 bytes of hashes]
//! compound property: [a group for each property ...] [headers of properties]
//! sample: [16 bytes of content key] [values], for arrays followed by their dimensions
//! ```
//!
//! Guaranteed: the same tree gives the same bytes; values that are equal are written once; they go straight to the output, so
//! only headers stay in memory. Content keys are XXH3, 128 bits: Alembic's own are SpookyHash, but readers only ask whether two
//! keys are equal. Not promised: animation (everything is one sample for all time), and use on big-endian machines.
//!
//! The layout is that of Alembic 1.8.12, `lib/Alembic/{Ogawa,AbcCoreOgawa}` (<https://github.com/alembic/alembic>).

use super::super::{Chunks, FormatError};
use std::collections::HashMap;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use xxhash_rust::xxh3::Xxh3;

/// Bytes of the header.
const HEADER: u64 = 16;
/// Marks a place as that of data.
pub(super) const DATA: u64 = 1 << 63;
/// Version of the library that this layout is of.
const LIBRARY_VERSION: i32 = 10812;
/// Longest metadata of the table, and the most entries; what is over stands in headers.
const LONGEST_SHARED: usize = 255;
const MOST_SHARED: usize = 254;
/// The number in headers for metadata that stand there themselves.
pub(super) const OWN_METADATA: u8 = 255;
/// Output is handed on in pieces of this many bytes.
const BUFFER: usize = 1 << 18;

/// A type of plain values, by its number in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pod {
    Bool = 0,
    U8 = 1,
    I16 = 4,
    I32 = 6,
    I64 = 8,
    F32 = 10,
    F64 = 11,
    Text = 12,
}

impl Pod {
    /// Its name in metadata.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool_t",
            Self::U8 => "uint8_t",
            Self::I16 => "int16_t",
            Self::I32 => "int32_t",
            Self::I64 => "int64_t",
            Self::F32 => "float32_t",
            Self::F64 => "float64_t",
            Self::Text => "string",
        }
    }
}

/// Where values go, piece by piece.
pub(super) type Sink<'s> = dyn FnMut(&[u8]) -> Result<(), FormatError> + 's;

/// Values that are asked for twice: once for their key, once to be written. So they need not lie in memory as one.
pub(super) struct Values<'a> {
    /// How many items there are, each of the property's extent.
    items: u64,
    give: Box<dyn Fn(&mut Sink) -> Result<(), FormatError> + 'a>,
}

impl<'a> Values<'a> {
    /// A few values, as they lie in memory.
    pub(super) fn of<T: bytemuck::NoUninit>(values: &[T], items: usize) -> Self {
        let bytes: Vec<u8> = bytemuck::cast_slice(values).to_vec();
        Self { items: items as u64, give: Box::new(move |sink| sink(&bytes)) }
    }
    /// Texts, each ended by a NUL.
    pub(super) fn texts(texts: &[String]) -> Self {
        let bytes: Vec<u8> =
            texts.iter().flat_map(|text| [text.as_bytes(), &[0]].concat()).collect();
        Self { items: texts.len() as u64, give: Box::new(move |sink| sink(&bytes)) }
    }
    /// For each index its text.
    pub(super) fn named(texts: &'a [String], indices: &'a Chunks<'a, i32>) -> Self {
        let of = |index: &i32| texts.get(*index as usize).map_or("", String::as_str);
        let give = Box::new(move |sink: &mut Sink| {
            indices.values().try_for_each(|index| {
                sink(of(index).as_bytes())?;
                sink(&[0])
            })
        });
        Self { items: indices.len() as u64, give }
    }
    /// A long array.
    pub(super) fn chunks<T: bytemuck::NoUninit>(values: &'a Chunks<'a, T>) -> Self {
        Self {
            items: values.len() as u64,
            give: Box::new(|sink| {
                values.slices().try_for_each(|slice| sink(bytemuck::cast_slice(slice)))
            }),
        }
    }
    /// Each value as often as its count says.
    pub(super) fn spread<T: bytemuck::NoUninit>(
        values: impl Fn() -> Box<dyn Iterator<Item = T> + 'a> + 'a,
        counts: &'a Chunks<'a, i32>,
    ) -> Self {
        Self {
            items: counts.values().map(|count| *count as u64).sum(),
            give: Box::new(move |sink| {
                let mut piece: Vec<T> = vec![];
                for (value, count) in values().zip(counts.values()) {
                    piece.extend(std::iter::repeat_n(value, *count as usize));
                    if size_of_val(&piece[..]) >= BUFFER {
                        sink(bytemuck::cast_slice(&piece))?;
                        piece.clear();
                    }
                }
                sink(bytemuck::cast_slice(&piece))
            }),
        }
    }
    /// The bytes that `piece` makes of each item.
    pub(super) fn made<T: 'a, const N: usize>(
        items: &'a [T],
        each: usize,
        piece: impl Fn(&T) -> [u8; N] + 'a,
    ) -> Self {
        Self {
            items: (items.len() * each) as u64,
            give: Box::new(move |sink| {
                items.chunks(1 << 12).try_for_each(|some| {
                    sink(some.iter().map(&piece).collect::<Vec<_>>().as_flattened())
                })
            }),
        }
    }
}

/// A named value or compound of them.
pub(super) struct Property<'a> {
    pub(super) name: String,
    pub(super) metadata: String,
    pub(super) kind: PropertyKind<'a>,
}

pub(super) enum PropertyKind<'a> {
    Compound(Vec<Property<'a>>),
    /// One item, read as a scalar.
    Scalar(Pod, u8, Values<'a>),
    /// Any number of items of this many values each.
    Array(Pod, u8, Values<'a>),
}

/// A node of the tree.
#[derive(Default)]
pub(super) struct Object<'a> {
    pub(super) name: String,
    pub(super) metadata: String,
    pub(super) properties: Vec<Property<'a>>,
    pub(super) children: Vec<Object<'a>>,
}

/// `key=value` joined by `;` in the order of keys, without those that are empty.
pub(super) fn metadata(entries: &[(&str, &str)]) -> String {
    let mut entries: Vec<_> = entries.iter().filter(|(_, value)| !value.is_empty()).collect();
    entries.sort();
    entries.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(";")
}

/// Writes an archive from the output's current position on. `top` is the object without a name above all others.
///
/// # Errors
/// The output failed.
pub(super) fn write(
    top: &Object,
    about: &str,
    out: &mut (impl Write + Seek),
) -> Result<(), FormatError> {
    let start = out.stream_position()?;
    let mut archive = Archive::new(BufWriter::with_capacity(BUFFER, &mut *out));
    archive.put(b"Ogawa\xff\x00\x01")?;
    archive.put(&[0; 8])?;
    let versions = [0i32, LIBRARY_VERSION].map(i32::to_le_bytes);
    let mut root = vec![archive.data(&versions[0])?, archive.data(&versions[1])?];
    let (top, _) = archive.object(top)?;
    root.extend([top, archive.data(about.as_bytes())?, archive.time()?, archive.table()?]);
    let root = archive.group(&root)?;
    archive.out.flush()?;
    drop(archive);
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(start + HEADER - 8))?;
    out.write_all(&root.to_le_bytes())?;
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

struct Archive<W: Write> {
    out: W,
    /// Bytes written: places count from the archive's start.
    position: u64,
    /// Where values lie, by their key and length.
    written: HashMap<(u128, u64), u64>,
    shared_metadata: Vec<String>,
}

impl<W: Write> Archive<W> {
    fn new(out: W) -> Self {
        Self { out, position: 0, written: HashMap::new(), shared_metadata: vec![] }
    }
    fn put(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        self.out.write_all(bytes)?;
        self.position += bytes.len() as u64;
        Ok(())
    }
    fn data(&mut self, bytes: &[u8]) -> Result<u64, FormatError> {
        if bytes.is_empty() {
            return Ok(DATA);
        }
        let place = self.position;
        self.put(&(bytes.len() as u64).to_le_bytes())?;
        self.put(bytes)?;
        Ok(place | DATA)
    }
    fn group(&mut self, children: &[u64]) -> Result<u64, FormatError> {
        if children.is_empty() {
            return Ok(0);
        }
        let place = self.position;
        self.put(&(children.len() as u64).to_le_bytes())?;
        children.iter().try_for_each(|child| self.put(&child.to_le_bytes()))?;
        Ok(place)
    }

    /// The place of values and their key.
    fn sample(&mut self, values: &Values) -> Result<(u64, u128), FormatError> {
        let (mut hash, mut size) = (Xxh3::new(), 0u64);
        (values.give)(&mut |bytes| {
            hash.update(bytes);
            size += bytes.len() as u64;
            Ok(())
        })?;
        let key = hash.digest128();
        if let Some(place) = self.written.get(&(key, size)) {
            return Ok((*place, key));
        }
        let place = self.position | DATA;
        self.put(&(16 + size).to_le_bytes())?;
        self.put(&key.to_le_bytes())?;
        (values.give)(&mut |bytes| self.put(bytes))?;
        self.written.insert((key, size), place);
        Ok((place, key))
    }

    /// The number of metadata in the table, or that of those that stand in the header.
    fn metadata(&mut self, metadata: &str) -> u8 {
        if metadata.is_empty() {
            return 0;
        }
        if let Some(at) = self.shared_metadata.iter().position(|known| known == metadata) {
            return at as u8 + 1;
        }
        if metadata.len() > LONGEST_SHARED || self.shared_metadata.len() >= MOST_SHARED {
            return OWN_METADATA;
        }
        self.shared_metadata.push(metadata.to_owned());
        self.shared_metadata.len() as u8
    }

    /// Writes properties; gives their group and the hash of all they hold.
    fn compound(&mut self, properties: &[Property]) -> Result<(u64, u128), FormatError> {
        let (mut places, mut headers, mut hash) = (vec![], vec![], Xxh3::new());
        for property in properties {
            hash.update(property.name.as_bytes());
            hash.update(property.metadata.as_bytes());
            let (place, key) = match &property.kind {
                PropertyKind::Compound(inner) => self.compound(inner)?,
                PropertyKind::Scalar(_, _, values) => {
                    let (place, key) = self.sample(values)?;
                    (self.group(&[place])?, key)
                }
                PropertyKind::Array(pod, _, values) => {
                    let (place, key) = self.sample(values)?;
                    // How many texts there are is told by no length.
                    let dimensions = match pod {
                        Pod::Text => self.data(&values.items.to_le_bytes())?,
                        _ => DATA,
                    };
                    (self.group(&[place, dimensions])?, key)
                }
            };
            hash.update(&key.to_le_bytes());
            places.push(place);
            let number = self.metadata(&property.metadata);
            property.header(number, &mut headers);
        }
        if !headers.is_empty() {
            places.push(self.data(&headers)?);
        }
        Ok((self.group(&places)?, hash.digest128()))
    }

    /// Writes an object and all below it; gives its group and the hash of all they hold.
    fn object(&mut self, object: &Object) -> Result<(u64, u128), FormatError> {
        let (properties, own) = self.compound(&object.properties)?;
        let (mut places, mut headers, mut below) = (vec![properties], vec![], Xxh3::new());
        for child in &object.children {
            let (place, hash) = self.object(child)?;
            places.push(place);
            below.update(&hash.to_le_bytes());
            put_text(&child.name, 4, &mut headers);
            let number = self.metadata(&child.metadata);
            headers.push(number);
            if number == OWN_METADATA {
                put_text(&child.metadata, 4, &mut headers);
            }
        }
        let below = if object.children.is_empty() { 0 } else { below.digest128() };
        headers.extend(own.to_le_bytes());
        headers.extend(below.to_le_bytes());
        places.push(self.data(&headers)?);
        let mut hash = Xxh3::new();
        hash.update(&headers);
        hash.update(object.name.as_bytes());
        hash.update(object.metadata.as_bytes());
        Ok((self.group(&places)?, hash.digest128()))
    }

    /// The one time sampling there is: a sample at 0 that holds for ever.
    fn time(&mut self) -> Result<u64, FormatError> {
        let mut bytes = 1u32.to_le_bytes().to_vec(); // samples
        bytes.extend(1f64.to_le_bytes()); // seconds a cycle
        bytes.extend(1u32.to_le_bytes()); // times a cycle
        bytes.extend(0f64.to_le_bytes()); // the first time
        self.data(&bytes)
    }
    fn table(&mut self) -> Result<u64, FormatError> {
        let mut bytes = vec![];
        std::mem::take(&mut self.shared_metadata)
            .iter()
            .for_each(|metadata| put_text(metadata, 1, &mut bytes));
        self.data(&bytes)
    }
}

/// A text led by its length in so many bytes.
fn put_text(text: &str, length_bytes: usize, out: &mut Vec<u8>) {
    out.extend(&(text.len() as u32).to_le_bytes()[..length_bytes]);
    out.extend(text.as_bytes());
}

impl Property<'_> {
    fn header(&self, metadata: u8, out: &mut Vec<u8>) {
        const SCALAR: u32 = 1;
        const ARRAY: u32 = 2;
        const SCALAR_LIKE: u32 = 1;
        const ALL_OF_ONE_SIZE: u32 = 1 << 10;
        const CONSTANT: u32 = 1 << 11;
        // Numbers in a header are as wide as the widest needs.
        let longest = self.name.len().max(self.metadata.len());
        let (hint, width) = match longest {
            0..=0xff => (0, 1),
            0x100..=0xffff => (1, 2),
            _ => (2, 4),
        };
        let (ty, pod, extent) = match &self.kind {
            PropertyKind::Compound(_) => (0, None, 0),
            PropertyKind::Scalar(pod, extent, _) => (SCALAR, Some(*pod), *extent),
            PropertyKind::Array(pod, extent, values) if values.items == 1 => {
                (ARRAY | SCALAR_LIKE, Some(*pod), *extent)
            }
            PropertyKind::Array(pod, extent, _) => (ARRAY, Some(*pod), *extent),
        };
        let mut info = ty | hint << 2 | u32::from(metadata) << 20;
        if let Some(pod) = pod {
            info |= (pod as u32) << 4 | u32::from(extent) << 12 | ALL_OF_ONE_SIZE | CONSTANT;
        }
        out.extend(info.to_le_bytes());
        if pod.is_some() {
            out.extend(&1u32.to_le_bytes()[..width]); // samples
        }
        put_text(&self.name, width, out);
        if metadata == OWN_METADATA {
            put_text(&self.metadata, width, out);
        }
    }
}
