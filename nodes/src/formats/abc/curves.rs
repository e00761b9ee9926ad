//! Curves out of an Alembic archive, in world space.
//!
//! Guaranteed: curves take at most 64 KiB and four times the file in memory. An object whose curves cannot be told, and a curve with a
//! point that is no position, is left out and named; the others are read. Not promised: animation (the first sample counts),
//! instances, and NURBS.

use super::super::FormatError;
use super::super::usd::form::{Basis, Form};
use super::super::usd::read::budget::ReadBudget;
use super::super::usd::read::{
    Bad, InterpolationCounts, LeftOut, ReadCurves, ReadPrimvar, ReadStage, ReadValues, ReadWidths,
    Told, negative_widths, width_scale, wrong_counts, wrong_width,
};
use super::read::{AbcProperty, AbcPropertyKind, Archive, entry};
use glam::{DMat4, DVec3, Vec3};

/// Memory that curves may take: so many bytes, and so many for each of the file. Values that are alike are in a file once and in
/// memory as often as they are meant.
const FIXED: u64 = 64 << 10;
const PER_BYTE: u64 = 4;

/// What an archive has of curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AbcCurves {
    /// Curves as they are, in the unit of the file, and what was left out. Alembic declares no unit.
    pub stage: ReadStage,
    /// The application that wrote the file, by its own words; empty where it says none.
    pub application: String,
}

/// Reads all Curves of a file that have points, in file order. Curves with `groom_guide` 1 are of purpose `guide`.
///
/// # Errors
/// Damaged bytes. What is wrong with one object is told in what is left out.
pub fn read_curves(bytes: &[u8]) -> Result<AbcCurves, FormatError> {
    let archive = Archive::open(bytes)?;
    let mut budget = ReadBudget::of(FIXED + PER_BYTE * bytes.len() as u64);
    let (mut curves, mut told) = (vec![], Told::default());
    let application = budget.text(entry(archive.about(), "_ai_Application").unwrap_or(""))?;
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
            moves_below |= samples(&xform) > 1;
            match transform(&xform, world) {
                Ok(found) => below = found,
                Err(reason) => {
                    budget.charge(path.len() as u64)?;
                    let reason = format!("{reason}: what lies below is not read");
                    told.leave_out(broken(&path, "transform", reason));
                    continue;
                }
            }
        } else if schema.starts_with("AbcGeom_Curve_") {
            let geom = inner(".geom").unwrap_or(Ok(vec![]))?;
            let shape = CurvesObject { archive: &archive, path: &path, geom, world, moves };
            budget.charge(path.len() as u64)?;
            match shape.curves(&mut budget) {
                Ok(ObjectCurves { curves: found, faults }) => {
                    faults
                        .into_iter()
                        .for_each(|fault| told.leave_out(broken(&path, "curves", fault)));
                    curves.extend(found);
                }
                Err(Fault::Object(reason)) => told.leave_out(broken(&path, "curves", reason)),
                Err(Fault::File(error)) => return Err(error),
            }
        }
        for child in children.into_iter().rev() {
            budget.charge((path.len() + child.name.len() + 1) as u64)?;
            open.push((child, format!("{path}/{}", child.name), below, moves_below));
        }
    }
    Ok(AbcCurves { stage: ReadStage { curves, left_out: told.all() }, application })
}

fn broken(path: &str, kind: &str, reason: String) -> LeftOut {
    LeftOut {
        path: path.to_owned(),
        kind: kind.to_owned(),
        asset: String::new(),
        reason,
        is_broken: true,
    }
}

/// Why there are no curves.
enum Fault {
    /// For something that is wrong with the object alone.
    Object(String),
    /// For damaged bytes, or more than a file may take.
    File(FormatError),
}

impl From<FormatError> for Fault {
    fn from(error: FormatError) -> Self {
        Self::File(error)
    }
}

fn fault(name: &str, reason: impl std::fmt::Display) -> Fault {
    Fault::Object(format!("{name}: {reason}"))
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
    if curve_type == "variableOrder" {
        return Err("NURBS of any order are not read: convert them to poly or Bezier curves".into());
    }
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
    /// A transform above has more samples than the first.
    moves: bool,
}

/// What was found of an object.
struct ObjectCurves {
    /// Its sound curves.
    curves: Option<ReadCurves>,
    /// What is wrong with others.
    faults: Vec<String>,
}

impl CurvesObject<'_> {
    fn curves(&self, budget: &mut ReadBudget) -> Result<ObjectCurves, Fault> {
        let points = match values(&self.geom, "P") {
            None | Some((.., [])) => return Ok(ObjectCurves { curves: None, faults: vec![] }),
            Some((10, 3, bytes)) => bytes,
            Some(_) => return Err(fault("P", "the values are no positions")),
        };
        budget.charge(points.len() as u64)?;
        let mut points: Vec<Vec3> = copied(points);
        let counts = self.counts(points.len(), budget)?;
        let form = self.form()?;
        let mut bad = Bad::of(&counts, &points);
        if self.world != DMat4::IDENTITY {
            points.iter_mut().for_each(|point| {
                *point = self.world.transform_point3(point.as_dvec3()).as_vec3();
            });
            if bad.faults.is_empty() {
                bad = Bad::of(&counts, &points);
            }
        }
        let mut notes = self.notes(form);
        notes.extend(wrong_counts(form, &counts));
        let shape = InterpolationCounts::of(form, &counts, points.len());
        let widths = self.widths(&shape, &mut notes, budget)?;
        let primvars = self.primvars(&shape, &mut notes, budget)?;
        let is_guide = |p: &ReadPrimvar| {
            p.name == "groom_guide"
                && matches!(&p.values, ReadValues::Int(v) if v.iter().all(|guide| *guide == 1))
        };
        let purpose = if primvars.iter().any(is_guide) { "guide" } else { "default" };
        let mut curves = ReadCurves {
            path: self.path.to_owned(),
            purpose: purpose.into(),
            is_visible: true,
            counts,
            points,
            form,
            widths,
            primvars,
            notes,
        };
        let is_left = bad.drop_from(&mut curves, budget)?;
        Ok(ObjectCurves { curves: is_left.then_some(curves), faults: bad.faults })
    }

    fn counts(&self, points: usize, budget: &mut ReadBudget) -> Result<Vec<u32>, Fault> {
        let Some((6, 1, counts)) = values(&self.geom, "nVertices") else {
            return Err(fault("nVertices", "there are no counts of points"));
        };
        budget.charge(counts.len() as u64)?;
        let counts: Vec<u32> = copied(counts);
        let counted: u64 = counts.iter().map(|count| u64::from(*count)).sum();
        if counted != points as u64 {
            let reason = format!("the curves count {counted} points, but there are {points}");
            return Err(fault("nVertices", reason));
        }
        Ok(counts)
    }

    fn form(&self) -> Result<Form, Fault> {
        let how = values(&self.geom, "curveBasisAndType").map_or(&[][..], |(.., bytes)| bytes);
        let word = |i: usize, words: &[&'static str]| {
            *how.get(i).and_then(|n| words.get(usize::from(*n))).unwrap_or(&words[0])
        };
        form_of(
            word(0, &["cubic", "linear", "variableOrder"]),
            word(1, &["nonperiodic", "periodic"]),
            word(2, &["none", "bezier", "bspline", "catmullRom", "hermite", "power"]),
        )
        .map_err(|reason| fault("curveBasisAndType", reason))
    }

    /// What is not read of curves that are.
    fn notes(&self, form: Form) -> Vec<String> {
        let mut notes = vec![];
        let n = samples(&self.geom);
        if n > 1 {
            notes.push(format!("it is animated: of {n} samples only the first is read"));
        }
        if self.moves {
            notes.push("it moves: of a transform above only the first sample is read".into());
        }
        let is_bspline = form.basis == Basis::Bspline;
        let knots = values(&self.geom, ".knots").filter(|(pod, ..)| *pod == 10 && is_bspline);
        let mut knots = knots
            .map_or(&[][..], |(.., bytes)| bytes)
            .chunks_exact(4)
            .map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
        // Those of a uniform one rise by equal steps; where the next curve's begin, they fall.
        let mut last = knots.next();
        let steps = knots.filter_map(|knot| Some(knot - last.replace(knot)?));
        let (low, high) = steps
            .filter(|step| *step >= 0.0)
            .fold((f32::MAX, 0f32), |(low, high), step| (low.min(step), high.max(step)));
        if high > 1.001 * low {
            notes.push("its knots are not read: it is taken as a uniform B-spline".into());
        }
        notes
    }

    fn widths(
        &self,
        shape: &InterpolationCounts,
        notes: &mut Vec<String>,
        budget: &mut ReadBudget,
    ) -> Result<Option<ReadWidths>, FormatError> {
        let Some(property) = self.geom.iter().find(|property| property.name == "width") else {
            return Ok(None);
        };
        let (interpolation, mut values) = match self.param(property, shape, budget)? {
            Ok(ReadPrimvar { interpolation, values: ReadValues::Float(values), .. }) => {
                (interpolation, values)
            }
            Ok(_) => {
                notes.push("widths were left out: the values are no numbers".into());
                return Ok(None);
            }
            Err(reason) => {
                notes.push(format!("widths were left out: {reason}"));
                return Ok(None);
            }
        };
        let scale = width_scale(self.world);
        values.iter_mut().for_each(|width| *width = (f64::from(*width) * scale) as f32);
        if let Some(reason) = wrong_width(&values) {
            notes.push(format!("widths were left out: {reason}"));
            return Ok(None);
        }
        notes.extend(negative_widths(&values));
        Ok(Some(ReadWidths { interpolation, values }))
    }

    fn primvars(
        &self,
        shape: &InterpolationCounts,
        notes: &mut Vec<String>,
        budget: &mut ReadBudget,
    ) -> Result<Vec<ReadPrimvar>, FormatError> {
        let mut primvars = vec![];
        let arb = self.geom.iter().find(|property| property.name == ".arbGeomParams");
        let Some(AbcProperty { kind: AbcPropertyKind::Compound(place), .. }) = arb else {
            return Ok(primvars);
        };
        for property in self.archive.properties(*place)? {
            match self.param(&property, shape, budget)? {
                Ok(primvar) => budget.push(&mut primvars, primvar)?,
                Err(reason) => {
                    notes.push(budget.text(&format!("{} was left out: {reason}", property.name))?);
                }
            }
        }
        Ok(primvars)
    }

    /// A GeomParam, indices resolved; or why it is left out.
    fn param(
        &self,
        property: &AbcProperty,
        shape: &InterpolationCounts,
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
        let interpolation = match interpolation(property.metadata, read.len(), shape) {
            Ok(interpolation) => interpolation,
            Err(reason) => return Ok(Err(reason)),
        };
        let is_colour = entry(property.metadata, "interpretation") == Some("rgb");
        Ok(Ok(ReadPrimvar {
            name: budget.text(property.name)?,
            type_name: read.type_name(is_colour).into(),
            interpolation: interpolation.into(),
            values: read,
        }))
    }
}

/// How so many values are spread: as the scope says, or by their number where none is said, as Blender writes widths. Values between
/// points that are as many as points are taken for theirs, for programs write them so.
fn interpolation(
    metadata: &str,
    values: usize,
    shape: &InterpolationCounts,
) -> Result<&'static str, String> {
    let said = match entry(metadata, "geoScope").unwrap_or("") {
        "con" => "constant",
        "uni" => "uniform",
        "vtx" => "vertex",
        "var" | "fvr" if shape.misfit("vertex", values).is_none() => "vertex",
        "var" | "fvr" => "varying",
        "" => {
            return shape.fitting(values).ok_or_else(|| {
                format!(
                    "{values} values without a scope are neither one, one a curve nor one a point"
                )
            });
        }
        scope => return Err(format!("scope {scope} is not read")),
    };
    shape.misfit(said, values).map_or(Ok(said), Err)
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
