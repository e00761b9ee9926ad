//! Reads curves out of Alembic (Ogawa) bytes.
//!
//! [`Archive`] walks the tree: names, metadata and values are borrowed from the bytes, so hostile ones cannot make it allocate more
//! than their headers tell. [`read_curves`] gathers curves from it in world space.
//!
//! Guaranteed: hostile bytes give an error, never a panic, an endless walk (a group that many others share counts as often as it
//! is met, and all together may not be larger than twice the file) or curves that take more memory than 64 KiB and four times the
//! file. Not promised:
//! animation (the first sample counts), instances, and the older container HDF5, which Alembic itself gave up.

use super::super::FormatError;
use super::super::usd::form::{FARTHEST, Form, is_position};
use super::super::usd::read::budget::ReadBudget;
use super::super::usd::read::{
    ReadCurves, ReadPrimvar, ReadValues, ReadWidths, negative_widths, width_scale, wrong_width,
};
use super::ogawa::{DATA, OWN_METADATA};
use glam::{DMat4, DVec3, Vec3};
use std::cell::Cell;

/// Memory that curves may take: so many bytes, and so many for each of the file. Values that are alike are in a file once and in
/// memory as often as they are meant.
const FIXED: u64 = 64 << 10;
const PER_BYTE: u64 = 4;

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

/// Reads all Curves of a file that have points, in file order: as they are, for Alembic states no unit; coif's are centimetres,
/// Y up. Curves with `groom_guide` 1 are of purpose `guide`.
///
/// # Errors
/// Damaged bytes, and curves that contradict themselves, with their path.
pub fn read_curves(bytes: &[u8]) -> Result<Vec<ReadCurves>, FormatError> {
    let archive = Archive::open(bytes)?;
    let mut budget = ReadBudget::of(FIXED + PER_BYTE * bytes.len() as u64);
    let mut found = vec![];
    let mut open = vec![(archive.top()?, String::new(), DMat4::IDENTITY, false)];
    while let Some((object, path, world, moves)) = open.pop() {
        let (place, children) = archive.open_object(&object)?;
        let schema = entry(object.metadata, "schema").unwrap_or("");
        let properties = archive.properties(place)?;
        let inner = |name: &str| match properties.iter().find(|p| p.name == name)?.kind {
            AbcPropertyKind::Compound(place) => Some(archive.properties(place)),
            AbcPropertyKind::Values { .. } => None,
        };
        let (mut below, mut moves_below) = (world, moves);
        if schema.starts_with("AbcGeom_Xform_") {
            let xform = inner(".xform").unwrap_or(Ok(vec![]))?;
            below = transform(&xform, world).map_err(|reason| FormatError::at(&*path, reason))?;
            moves_below |= samples(&xform) > 1;
        } else if schema.starts_with("AbcGeom_Curve_") {
            let geom = inner(".geom").unwrap_or(Ok(vec![]))?;
            let shape = CurvesObject { archive: &archive, path: &path, geom, world };
            let mut curves = shape.curves(&mut budget)?;
            if let Some(curves) = curves.as_mut().filter(|_| moves) {
                curves
                    .notes
                    .push("it moves: of a transform above only the first sample is read".into());
            }
            found.extend(curves);
        }
        for child in children.into_iter().rev() {
            budget.charge((path.len() + child.name.len() + 1) as u64)?;
            open.push((child, format!("{path}/{}", child.name), below, moves_below));
        }
    }
    Ok(found)
}

fn values<'a>(properties: &[AbcProperty<'a>], name: &str) -> Option<(u8, u8, &'a [u8])> {
    match properties.iter().find(|property| property.name == name)?.kind {
        AbcPropertyKind::Values { pod, extent, bytes, .. } => Some((pod, extent, bytes)),
        AbcPropertyKind::Compound(_) => None,
    }
}

/// The most samples that one of the properties has.
fn samples(properties: &[AbcProperty]) -> u64 {
    let of = |property: &AbcProperty| match property.kind {
        AbcPropertyKind::Values { samples, .. } => samples,
        AbcPropertyKind::Compound(_) => 0,
    };
    properties.iter().map(of).max().unwrap_or(0)
}

/// The transform of what lies below an Xform.
fn transform(xform: &[AbcProperty], world: DMat4) -> Result<DMat4, String> {
    let inherits = values(xform, ".inherits").is_none_or(|(_, _, bytes)| bytes != [0]);
    let mut matrix = if inherits { world } else { DMat4::IDENTITY };
    let Some((1, _, ops)) = values(xform, ".ops") else { return Ok(matrix) };
    let numbers = match values(xform, ".vals") {
        Some((11, _, bytes)) => doubles(bytes),
        _ => vec![],
    };
    let mut numbers = &numbers[..];
    for op in ops {
        let n = match op >> 4 {
            0 | 1 => 3,
            2 => 4,
            3 => 16,
            4..=6 => 1,
            op => return Err(format!("a transform operation {op} is not known")),
        };
        let (own, rest) = numbers.split_at_checked(n).ok_or("a transform has too few values")?;
        numbers = rest;
        let radians = own[n - 1].to_radians();
        matrix *= match op >> 4 {
            0 => DMat4::from_scale(DVec3::from_slice(own)),
            1 => DMat4::from_translation(DVec3::from_slice(own)),
            2 => match DVec3::from_slice(own).try_normalize() {
                Some(axis) => DMat4::from_axis_angle(axis, radians),
                None => DMat4::IDENTITY,
            },
            // Row vectors there, column vectors here: the same 16 numbers.
            3 => DMat4::from_cols_slice(own),
            4 => DMat4::from_rotation_x(radians),
            5 => DMat4::from_rotation_y(radians),
            _ => DMat4::from_rotation_z(radians),
        };
    }
    Ok(matrix)
}

fn doubles(bytes: &[u8]) -> Vec<f64> {
    let double = |bytes: &[u8]| {
        let mut own = [0; 8];
        own.copy_from_slice(bytes);
        f64::from_le_bytes(own)
    };
    bytes.chunks_exact(8).map(double).collect()
}

/// The curve that type, wrap and basis make. Alembic has no word for pinned ends; who writes Catmull-Rom there (coif, Blender)
/// means that curves go from their first point to their last, and it is read so.
fn form_of(curve_type: &str, wrap: &str, basis: &str) -> Result<Form, String> {
    let wrap = match (basis, wrap) {
        ("catmullRom", "nonperiodic") => "pinned",
        _ => wrap,
    };
    let basis = if curve_type == "linear" { "bezier" } else { basis };
    Form::of(curve_type, basis, wrap).map_err(|(_, reason)| reason)
}

/// A Curves object while its curves are taken out.
struct CurvesObject<'a> {
    archive: &'a Archive<'a>,
    path: &'a str,
    geom: Vec<AbcProperty<'a>>,
    world: DMat4,
}

impl CurvesObject<'_> {
    fn error(&self, name: &str, reason: impl Into<String>) -> FormatError {
        FormatError::at(format!("{}.{name}", self.path), reason)
    }

    fn curves(&self, budget: &mut ReadBudget) -> Result<Option<ReadCurves>, FormatError> {
        let points = match values(&self.geom, "P") {
            None | Some((.., [])) => return Ok(None),
            Some((10, 3, bytes)) => bytes,
            Some(_) => return Err(self.error("P", "the values are no positions")),
        };
        budget.charge(points.len() as u64)?;
        let mut points: Vec<Vec3> = copied(points);
        if let Some(bad) = points.iter().position(|point| !point.is_finite()) {
            return Err(self.error("P", format!("point {bad} is no finite position")));
        }
        let is_far = |point: &Vec3| point.is_finite() && !is_position(*point);
        if self.world != DMat4::IDENTITY {
            points.iter_mut().for_each(|point| {
                *point = self.world.transform_point3(point.as_dvec3()).as_vec3();
            });
            if let Some(bad) = points.iter().position(|point| !point.is_finite()) {
                return Err(
                    self.error("P", format!("point {bad} leaves the numbers in world space"))
                );
            }
        }
        if let Some(bad) = points.iter().position(is_far) {
            let reason = format!("point {bad} is farther off than {FARTHEST:e} cm");
            return Err(self.error("P", reason));
        }
        let Some((6, 1, counts)) = values(&self.geom, "nVertices") else {
            return Err(self.error("nVertices", "there are no counts of points"));
        };
        budget.charge(counts.len() as u64)?;
        let counts: Vec<u32> = copied(counts);
        let counted: u64 = counts.iter().map(|count| u64::from(*count)).sum();
        if counted != points.len() as u64 {
            let reason =
                format!("the curves count {counted} points, but there are {}", points.len());
            return Err(self.error("nVertices", reason));
        }
        let how = values(&self.geom, "curveBasisAndType").map_or(&[][..], |(.., bytes)| bytes);
        let word = |i: usize, words: &[&'static str]| {
            *how.get(i).and_then(|n| words.get(usize::from(*n))).unwrap_or(&words[0])
        };
        let form = form_of(
            word(0, &["cubic", "linear", "variableOrder"]),
            word(1, &["nonperiodic", "periodic"]),
            word(2, &["none", "bezier", "bspline", "catmullRom", "hermite", "power"]),
        )
        .map_err(|reason| self.error("curveBasisAndType", reason))?;
        let mut notes = vec![];
        let n = samples(&self.geom);
        if n > 1 {
            notes.push(format!("it is animated: of {n} samples only the first is read"));
        }
        let shape = [1, counts.len(), points.len()];
        let mut widths = None;
        if let Some(property) = self.geom.iter().find(|property| property.name == "width") {
            match self.param(property, shape, budget)? {
                Ok(ReadPrimvar {
                    interpolation, values: ReadValues::Float(mut values), ..
                }) => {
                    let scale = width_scale(self.world);
                    values.iter_mut().for_each(|width| *width = (f64::from(*width) * scale) as f32);
                    widths = Some(ReadWidths { interpolation, values });
                }
                Ok(_) => notes.push("widths were left out: the values are no numbers".into()),
                Err(reason) => notes.push(format!("widths were left out: {reason}")),
            }
            if let Some(read) = &widths {
                match wrong_width(&read.values) {
                    Some(reason) => {
                        notes.push(format!("widths were left out: {reason}"));
                        widths = None;
                    }
                    None => notes.extend(negative_widths(&read.values)),
                }
            }
        }
        let mut primvars = vec![];
        let arb = self.geom.iter().find(|property| property.name == ".arbGeomParams");
        if let Some(AbcProperty { kind: AbcPropertyKind::Compound(place), .. }) = arb {
            for property in self.archive.properties(*place)? {
                match self.param(&property, shape, budget)? {
                    Ok(primvar) => budget.push(&mut primvars, primvar)?,
                    Err(reason) => {
                        notes.push(
                            budget.text(&format!("{} was left out: {reason}", property.name))?,
                        );
                    }
                }
            }
        }
        let is_guide = |p: &ReadPrimvar| {
            p.name == "groom_guide"
                && matches!(&p.values, ReadValues::Int(v) if v.iter().all(|guide| *guide == 1))
        };
        let purpose = if primvars.iter().any(is_guide) { "guide" } else { "default" };
        Ok(Some(ReadCurves {
            path: self.path.to_owned(),
            purpose: purpose.into(),
            is_visible: true,
            counts,
            points,
            form,
            widths,
            primvars,
            notes,
        }))
    }

    /// A GeomParam, indices resolved; or why it is left out. `shape`: 1, and how many curves and points there are.
    fn param(
        &self,
        property: &AbcProperty,
        shape: [usize; 3],
        budget: &mut ReadBudget,
    ) -> Result<Result<ReadPrimvar, String>, FormatError> {
        let (held, indices) = match property.kind {
            AbcPropertyKind::Values { .. } => (property.kind, None),
            AbcPropertyKind::Compound(place) => {
                let inner = self.archive.properties(place)?;
                let Some(held) = inner.iter().find(|p| p.name == ".vals") else {
                    return Ok(Err("it has no values".into()));
                };
                (held.kind, values(&inner, ".indices").map(|(.., bytes)| bytes))
            }
        };
        let AbcPropertyKind::Values { pod, extent, bytes, .. } = held else {
            return Ok(Err("it has no values".into()));
        };
        budget.charge(2 * bytes.len() as u64)?;
        let mut read = match read_values(pod, extent, bytes) {
            Some(read) => read,
            None => return Ok(Err(format!("values of type {pod} by {extent} are not read"))),
        };
        if let Some(indices) = indices {
            let indices: Vec<u32> = copied(indices);
            let each = read.bytes_each();
            budget.charge(indices.len() as u64 * each)?;
            let Some(picked) = read.picked(&indices) else {
                return Ok(Err("an index is beyond its values".into()));
            };
            read = picked;
        }
        let scope = entry(property.metadata, "geoScope").unwrap_or("con");
        let (interpolation, wanted) = match scope {
            "con" => ("constant", shape[0]),
            "uni" => ("uniform", shape[1]),
            "vtx" => ("vertex", shape[2]),
            _ => return Ok(Err(format!("scope {scope} is not read"))),
        };
        if read.len() != wanted {
            return Ok(Err(format!(
                "{} values where {interpolation} interpolation asks for {wanted}",
                read.len()
            )));
        }
        let is_colour = entry(property.metadata, "interpretation") == Some("rgb");
        Ok(Ok(ReadPrimvar {
            name: budget.text(property.name)?,
            type_name: read.type_name(is_colour).into(),
            interpolation: interpolation.into(),
            values: read,
        }))
    }
}

/// Values as they lie in the file; what is left of a last one is dropped.
fn copied<T: bytemuck::Pod>(bytes: &[u8]) -> Vec<T> {
    let mut values = vec![T::zeroed(); bytes.len() / size_of::<T>()];
    let length = size_of_val(&values[..]);
    bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(&bytes[..length]);
    values
}

fn read_values(pod: u8, extent: u8, bytes: &[u8]) -> Option<ReadValues> {
    let ints = |of: &dyn Fn(&[u8]) -> i32, n: usize| bytes.chunks_exact(n).map(of).collect();
    Some(match (pod, extent) {
        (0 | 1, 1) => ReadValues::Int(bytes.iter().map(|b| i32::from(*b)).collect()),
        (2, 1) => ReadValues::Int(bytes.iter().map(|b| i32::from(*b as i8)).collect()),
        (3, 1) => ReadValues::Int(ints(&|b| i32::from(u16::from_le_bytes([b[0], b[1]])), 2)),
        (4, 1) => ReadValues::Int(ints(&|b| i32::from(i16::from_le_bytes([b[0], b[1]])), 2)),
        (5, 1) => ReadValues::Int64(copied::<u32>(bytes).into_iter().map(i64::from).collect()),
        (6, 1) => ReadValues::Int(copied(bytes)),
        (8, 1) => ReadValues::Int64(copied(bytes)),
        (10, 1) => ReadValues::Float(copied(bytes)),
        (10, 2) => ReadValues::Float2(copied(bytes)),
        (10, 3) => ReadValues::Float3(copied(bytes)),
        (11, 1) => ReadValues::Float(doubles(bytes).into_iter().map(|x| x as f32).collect()),
        (12, 1) => {
            let texts =
                bytes.strip_suffix(&[0]).map_or(vec![], |all| all.split(|b| *b == 0).collect());
            ReadValues::Text(
                texts.iter().map(|t| String::from_utf8_lossy(t).into_owned()).collect(),
            )
        }
        _ => return None,
    })
}

impl ReadValues {
    /// Bytes that a value takes at most.
    fn bytes_each(&self) -> u64 {
        match self {
            Self::Text(v) => v.iter().map(|text| text.len() as u64 + 24).max().unwrap_or(0),
            _ => 12,
        }
    }
    fn picked(&self, indices: &[u32]) -> Option<Self> {
        fn of<T: Clone>(values: &[T], indices: &[u32]) -> Option<Vec<T>> {
            indices.iter().map(|i| values.get(*i as usize).cloned()).collect()
        }
        Some(match self {
            Self::Int(v) => Self::Int(of(v, indices)?),
            Self::Int64(v) => Self::Int64(of(v, indices)?),
            Self::Float(v) => Self::Float(of(v, indices)?),
            Self::Float2(v) => Self::Float2(of(v, indices)?),
            Self::Float3(v) => Self::Float3(of(v, indices)?),
            Self::Text(v) => Self::Text(of(v, indices)?),
        })
    }
    /// The name of the type in USD.
    fn type_name(&self, is_colour: bool) -> &'static str {
        match self {
            Self::Int(_) => "int[]",
            Self::Int64(_) => "int64[]",
            Self::Float(_) => "float[]",
            Self::Float2(_) => "float2[]",
            Self::Float3(_) if is_colour => "color3f[]",
            Self::Float3(_) => "float3[]",
            Self::Text(_) => "string[]",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a point of an Xform with these operations and values lies, below a world that moves by 10 along x.
    #[track_caller]
    fn check(ops: &[u8], numbers: &[f64], inherits: u8, point: [f64; 3], expected: [f64; 3]) {
        let numbers: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let inherits = [inherits];
        let property = |name, pod, bytes| {
            let kind =
                AbcPropertyKind::Values { samples: 1, pod, extent: 1, is_scalar: true, bytes };
            AbcProperty { name, metadata: "", kind }
        };
        let xform = [
            property(".inherits", 0, &inherits[..]),
            property(".ops", 1, ops),
            property(".vals", 11, &numbers[..]),
        ];
        let world = DMat4::from_translation(DVec3::X * 10.0);
        let found = transform(&xform, world).unwrap().transform_point3(DVec3::from(point));
        assert!(found.distance(DVec3::from(expected)) < 1e-12, "{found}");
    }

    #[test]
    fn the_last_operation_of_a_transform_meets_points_first() {
        let x = [1.0, 0.0, 0.0];
        // A quarter turn about z takes x to y, then all moves by 1, 2, 3 and by the 10 of the world.
        check(&[0x10, 0x60], &[1.0, 2.0, 3.0, 90.0], 1, x, [11.0, 3.0, 3.0]);
        check(&[0x10, 0x60], &[1.0, 2.0, 3.0, 90.0], 0, x, [1.0, 3.0, 3.0]);
        // About the axis z by 90 degrees, after doubling.
        check(&[0x20, 0x00], &[0.0, 0.0, 5.0, 90.0, 2.0, 2.0, 2.0], 0, x, [0.0, 2.0, 0.0]);
        // A matrix of row vectors moves by its last row.
        let mut matrix = DMat4::IDENTITY.to_cols_array();
        matrix[12..15].copy_from_slice(&[4.0, 5.0, 6.0]);
        check(&[0x30], &matrix, 0, x, [5.0, 5.0, 6.0]);
    }
}
