//! Walks an Alembic archive (Ogawa): objects, properties and values, borrowed from the bytes.
//!
//! Guaranteed: hostile bytes give an error, never a panic, more memory than their headers tell, or an endless walk (a group that many
//! others share counts as often as it is met, and all together may not be larger than twice the file). Not promised: animation (the
//! first sample counts), and the older container HDF5, which Alembic itself gave up. What the values mean is not known here.

use super::super::FormatError;
use super::ogawa::{DATA, OWN_METADATA};
use std::cell::Cell;

/// The bytes of an archive.
pub struct Archive<'a> {
    bytes: &'a [u8],
    /// Metadata that headers name by number, from 1.
    shared_metadata: Vec<&'a str>,
    root: u64,
    /// Bytes of groups and headers that may still be walked over.
    left: Cell<u64>,
}

/// A node of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbcObject<'a> {
    /// Its name; empty at the top.
    pub name: &'a str,
    /// `key=value` joined by `;`.
    pub metadata: &'a str,
    group: u64,
}

/// A named value of an object, or a compound of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbcProperty<'a> {
    /// Its name.
    pub name: &'a str,
    /// `key=value` joined by `;`.
    pub metadata: &'a str,
    /// What it holds.
    pub kind: AbcPropertyKind<'a>,
}

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AbcPropertyKind<'a> {
    /// More properties: see [`Archive::properties`].
    Compound(CompoundOffset),
    /// Values.
    Values {
        /// How many samples in time there are.
        samples: u64,
        /// Type of the values, by its number in Alembic: 6 is int32, 10 float32, 11 float64, 12 texts.
        pod: u8,
        /// Values an item has.
        extent: u8,
        /// Whether there is always one item.
        is_scalar: bool,
        /// Those of the first sample, little-endian; texts end in NUL.
        bytes: &'a [u8],
    },
}

/// Where the properties of a compound lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompoundOffset(u64);

/// The value of a key in metadata.
pub fn entry<'m>(metadata: &'m str, key: &str) -> Option<&'m str> {
    metadata.split(';').find_map(|entry| entry.strip_prefix(key)?.strip_prefix('='))
}

fn damaged(at: u64, reason: impl Into<String>) -> FormatError {
    FormatError::at(format!("byte {at}"), reason)
}

impl<'a> Archive<'a> {
    /// The archive in these bytes.
    ///
    /// # Errors
    /// No Ogawa archive, one that was not finished, or one whose head is damaged.
    pub fn open(bytes: &'a [u8]) -> Result<Self, FormatError> {
        if bytes.starts_with(b"\x89HDF") {
            return Err(damaged(0, "an Alembic file in HDF5, which is not read: save it as Ogawa"));
        }
        if !bytes.starts_with(b"Ogawa") {
            return Err(damaged(0, "no Alembic file: it does not begin with Ogawa"));
        }
        let left = Cell::new(2 * bytes.len() as u64);
        let mut archive = Self { bytes, shared_metadata: vec![], root: 0, left };
        if archive.take(5, 1)? != [0xff] {
            return Err(damaged(5, "the file was never finished by the program that wrote it"));
        }
        archive.root = archive.number(8)?;
        let root = archive.group(archive.root)?;
        if root.len() < 6 {
            return Err(damaged(archive.root, format!("the root has {} parts, not 6", root.len())));
        }
        let mut table = Cursor { bytes: archive.data(root.place(5))?, at: 0 };
        while !table.is_done() {
            archive.shared_metadata.push(table.text(1)?);
        }
        Ok(archive)
    }

    /// What the file says of itself, `key=value` joined by `;`; empty where it says nothing that is text.
    pub fn about(&self) -> &'a str {
        let place = self.group(self.root).ok().filter(|root| root.len() > 3);
        let bytes = place.and_then(|root| self.data(root.place(3)).ok());
        bytes.and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// The object above all others.
    ///
    /// # Errors
    /// The root is damaged.
    pub fn top(&self) -> Result<AbcObject<'a>, FormatError> {
        let group = self.group(self.root)?.place(2);
        Ok(AbcObject { name: "", metadata: "", group })
    }

    /// What an object holds: the place of its properties, and its children.
    ///
    /// # Errors
    /// It is damaged.
    pub fn open_object(
        &self,
        object: &AbcObject<'a>,
    ) -> Result<(CompoundOffset, Vec<AbcObject<'a>>), FormatError> {
        let group = self.group(object.group)?;
        if group.len() == 0 {
            return Ok((CompoundOffset(0), vec![]));
        }
        let mut headers = Cursor { bytes: self.data(group.place(group.len() - 1))?, at: 0 };
        // Behind the headers of children lie 32 bytes of hashes.
        let end = headers.bytes.len().saturating_sub(32);
        headers.bytes = &headers.bytes[..end];
        self.charge(end as u64)?;
        let mut children = vec![];
        while !headers.is_done() {
            let name = headers.text(4)?;
            let number = headers.number(1)? as u8;
            let metadata = self.metadata(number, 4, &mut headers)?;
            let at = children.len() + 1;
            if at + 1 >= group.len() {
                return Err(damaged(object.group, "an object names more children than it has"));
            }
            children.push(AbcObject { name, metadata, group: group.place(at) });
        }
        let properties =
            if group.len() > 1 { CompoundOffset(group.place(0)) } else { CompoundOffset(0) };
        Ok((properties, children))
    }

    /// The properties of an object or compound.
    ///
    /// # Errors
    /// They are damaged.
    pub fn properties(&self, place: CompoundOffset) -> Result<Vec<AbcProperty<'a>>, FormatError> {
        let group = self.group(place.0)?;
        if group.len() == 0 {
            return Ok(vec![]);
        }
        let mut headers = Cursor { bytes: self.data(group.place(group.len() - 1))?, at: 0 };
        self.charge(headers.bytes.len() as u64)?;
        let mut properties = vec![];
        while !headers.is_done() {
            let at = properties.len();
            if at + 1 >= group.len() {
                return Err(damaged(place.0, "a compound names more properties than it has"));
            }
            properties.push(self.property(group.place(at), &mut headers)?);
        }
        Ok(properties)
    }

    fn property(&self, at: u64, headers: &mut Cursor<'a>) -> Result<AbcProperty<'a>, FormatError> {
        let info = headers.number(4)? as u32;
        let width = 1 << (info >> 2 & 3).min(2);
        let number = (info >> 20) as u8;
        let is_compound = info & 3 == 0;
        let mut samples = 0;
        if !is_compound {
            samples = headers.number(width)?;
            let more = [(9, 2), (8, 1)].map(|(bit, n)| if info >> bit & 1 == 1 { n } else { 0 });
            headers.take(width * (more[0] + more[1]))?;
        }
        let name = headers.text(width)?;
        let metadata = self.metadata(number, width, headers)?;
        if is_compound {
            return Ok(AbcProperty {
                name,
                metadata,
                kind: AbcPropertyKind::Compound(CompoundOffset(at)),
            });
        }
        let group = self.group(at)?;
        let sample =
            if samples == 0 || group.len() == 0 { &[][..] } else { self.data(group.place(0))? };
        let kind = AbcPropertyKind::Values {
            samples,
            pod: (info >> 4 & 15) as u8,
            extent: (info >> 12) as u8,
            is_scalar: info & 3 == 1,
            bytes: sample.get(16..).unwrap_or(&[]),
        };
        Ok(AbcProperty { name, metadata, kind })
    }

    fn metadata(
        &self,
        number: u8,
        width: usize,
        headers: &mut Cursor<'a>,
    ) -> Result<&'a str, FormatError> {
        match number {
            0 => Ok(""),
            OWN_METADATA => headers.text(width),
            number => self
                .shared_metadata
                .get(usize::from(number) - 1)
                .copied()
                .ok_or_else(|| damaged(0, format!("there is no metadata number {number}"))),
        }
    }

    fn charge(&self, bytes: u64) -> Result<(), FormatError> {
        let left = self.left.get().checked_sub(bytes);
        self.left.set(left.ok_or_else(|| {
            FormatError::at(
                "file",
                "its groups are more than it has bytes, which no honest file's are",
            )
        })?);
        Ok(())
    }
    fn take(&self, at: u64, n: u64) -> Result<&'a [u8], FormatError> {
        let end = at.checked_add(n).and_then(|end| usize::try_from(end).ok());
        end.and_then(|end| self.bytes.get(usize::try_from(at).ok()?..end))
            .ok_or_else(|| damaged(at, format!("the file ends before {n} bytes of it")))
    }
    fn number(&self, at: u64) -> Result<u64, FormatError> {
        let mut number = [0; 8];
        number.copy_from_slice(self.take(at, 8)?);
        Ok(u64::from_le_bytes(number))
    }
    fn data(&self, place: u64) -> Result<&'a [u8], FormatError> {
        match place.checked_sub(DATA) {
            None => Err(damaged(place, "a group where data should be")),
            Some(0) => Ok(&[]),
            Some(at) => self.take(at.saturating_add(8), self.number(at)?),
        }
    }
    fn group(&self, place: u64) -> Result<Children<'a>, FormatError> {
        if place == 0 {
            return Ok(Children(&[]));
        }
        if place >= DATA {
            return Err(damaged(place - DATA, "data where a group should be"));
        }
        let n = self.number(place)?;
        let bytes = self.take(place + 8, n.saturating_mul(8))?;
        self.charge(8 + bytes.len() as u64)?;
        Ok(Children(bytes))
    }
}

/// Places of the children of a group.
struct Children<'a>(&'a [u8]);

impl Children<'_> {
    fn len(&self) -> usize {
        self.0.len() / 8
    }
    fn place(&self, i: usize) -> u64 {
        let mut place = [0; 8];
        place.copy_from_slice(&self.0[8 * i..8 * i + 8]);
        u64::from_le_bytes(place)
    }
}

/// Headers, taken one after the other.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn is_done(&self) -> bool {
        self.at >= self.bytes.len()
    }
    fn take(&mut self, n: usize) -> Result<&'a [u8], FormatError> {
        let end = self.at.checked_add(n).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or_else(|| FormatError::at("headers", "they end too early"))?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }
    /// A number of 1, 2 or 4 bytes.
    fn number(&mut self, width: usize) -> Result<u64, FormatError> {
        Ok(self.take(width)?.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }
    fn text(&mut self, width: usize) -> Result<&'a str, FormatError> {
        let length = self.number(width)? as usize;
        let bytes = self.take(length)?;
        std::str::from_utf8(bytes)
            .map_err(|_| FormatError::at("headers", "a name or metadata is no UTF-8 text"))
    }
}
