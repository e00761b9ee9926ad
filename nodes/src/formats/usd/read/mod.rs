//! Reads BasisCurves out of `.usda`, `.usdc` and `.usdz` bytes.
//!
//! `text` and `crate_file` turn bytes into a `tree` of prims, of which only what curves need is
//! decoded; `package` finds the layer in a `.usdz`. Here curves are gathered from the tree, walked
//! down from the root for transforms and purpose, and brought to centimetres with Y up.
//!
//! Guaranteed: hostile bytes give an error, never a panic, an endless loop or more memory than
//! 64 MiB + 20 times their length. Not promised: composition. References, payloads, sublayers,
//! variants, classes and instances are not followed; only `def` prims that are active and written in
//! the layer itself are read. Of animated values the default counts, else the earliest sample.

pub(in crate::formats) mod budget;
mod crate_file;
mod package;
mod text;
mod tree;
mod world;

use super::super::FormatError;
use glam::{DMat4, DVec3, Vec2, Vec3};
use tree::{Attribute, Tree, Value};
use world::World;

pub(in crate::formats) use world::width_scale;

/// The curves of one BasisCurves prim, in centimetres, Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadCurves {
    /// Path of the prim.
    pub path: String,
    /// `default`, `render`, `proxy` or `guide`, inherited as USD has it.
    pub purpose: String,
    /// Points of each curve; 0 and 1 are possible. They add up to the points.
    pub counts: Vec<u32>,
    /// Root to tip in world space: finite, centimetres, Y up.
    pub points: Vec<Vec3>,
    /// `linear` or `cubic`, as written.
    pub curve_type: String,
    /// `bezier`, `bspline`, `catmullRom`, as written.
    pub basis: String,
    /// `nonperiodic`, `periodic`, `pinned`, as written.
    pub wrap: String,
    /// Diameters in centimetres, scaled as the transforms scale volumes.
    pub widths: Option<ReadWidths>,
    /// Everything under `primvars:`, values as written, indices resolved.
    pub primvars: Vec<ReadPrimvar>,
    /// What was left out and why, one sentence each.
    pub notes: Vec<String>,
}

/// Diameters of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadWidths {
    /// `constant`, `uniform`, `varying` or `vertex`; the first for any single value.
    pub interpolation: String,
    /// Finite, as many as the interpolation asks (unchecked for `varying`).
    pub values: Vec<f32>,
}

/// A primvar of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPrimvar {
    /// Name after `primvars:`.
    pub name: String,
    /// Value type as written, for example `color3f[]`.
    pub type_name: String,
    /// `constant`, `uniform`, `varying` or `vertex`.
    pub interpolation: String,
    /// As many as the interpolation asks (unchecked for `varying`).
    pub values: ReadValues,
}

/// Values of a primvar: doubles and halves as floats, unsigned integers as `int64`.
#[derive(Clone, Debug, PartialEq)]
pub enum ReadValues {
    /// `int[]`, `bool[]`
    Int(Vec<i32>),
    /// `int64[]` and unsigned integers.
    Int64(Vec<i64>),
    /// `float[]`
    Float(Vec<f32>),
    /// `float2[]` and its roles.
    Float2(Vec<Vec2>),
    /// `float3[]` and its roles.
    Float3(Vec<Vec3>),
    /// `string[]`, `token[]` and `asset[]`
    Text(Vec<String>),
}

/// Reads all BasisCurves of a file that have points, in file order.
///
/// The bytes decide what they are; `extension` (without the dot, any case) only has to be one of
/// `usd`, `usda`, `usdc`, `usdz`.
///
/// # Errors
/// Damaged bytes with the line or byte, curves that contradict themselves with their path, and files
/// whose curves lie elsewhere (behind references, payloads or variants).
pub fn read_curves(bytes: &[u8], extension: &str) -> Result<Vec<ReadCurves>, FormatError> {
    let known = ["usd", "usda", "usdc", "usdz"];
    if !known.iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        return Err(FormatError::at("file name", format!(".{extension} is no USD file")));
    }
    let mut budget = budget::Budget::for_file(bytes.len());
    let layer = package::root_layer(bytes)?;
    let tree = if layer.starts_with(crate_file::MAGIC) {
        crate_file::read(layer, &mut budget)?
    } else if layer.starts_with(text::MAGIC) {
        text::read(layer, &mut budget)?
    } else {
        return Err(FormatError::at("byte 0", "neither #usda nor a crate file begins here"));
    };
    gather(tree, &mut budget)
}

fn gather(mut tree: Tree, budget: &mut budget::Budget) -> Result<Vec<ReadCurves>, FormatError> {
    let centimetres_from_stage = centimetres_from_stage(&tree)?;
    let worlds = World::of_prims(&tree, centimetres_from_stage, budget)?;
    let mut found = Vec::new();
    for (index, world) in worlds.iter().enumerate() {
        if !world.is_live || tree.prims[index].type_name != "BasisCurves" {
            continue;
        }
        world.check(&tree, budget)?;
        let path = tree.path(index, budget)?;
        let attributes = std::mem::take(&mut tree.prims[index].attributes);
        let prim = CurvesPrim { path, world, attributes };
        found.extend(prim.curves(budget)?);
    }
    if found.is_empty() && tree.has_arcs {
        return Err(FormatError::at(
            "layer",
            "its curves lie behind references, payloads, sublayers or variants, which are not \
             followed: flatten the stage first",
        ));
    }
    Ok(found)
}

/// Scale and axes of the layer: USD's defaults are centimetres, Y up.
fn centimetres_from_stage(tree: &Tree) -> Result<DMat4, FormatError> {
    let meters_per_unit = tree.meters_per_unit.unwrap_or(0.01);
    if !(meters_per_unit.is_finite() && meters_per_unit > 0.0) {
        let reason = format!("{meters_per_unit} is no length");
        return Err(FormatError::at("metersPerUnit", reason));
    }
    // Dividing, not multiplying by 100: 0.01 then gives 1 exactly, and points keep their bits.
    let scale = DMat4::from_scale(DVec3::splat(meters_per_unit / 0.01));
    let y_up = DMat4::from_cols_array_2d(&[
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]);
    match tree.up_axis.as_deref() {
        Some("Z") => Ok(y_up * scale),
        _ => Ok(scale),
    }
}

/// A BasisCurves prim while its curves are taken out.
struct CurvesPrim<'a> {
    path: String,
    world: &'a World,
    attributes: Vec<Attribute>,
}

impl CurvesPrim<'_> {
    /// The curves; `None` for a prim without points, which draws nothing.
    fn curves(mut self, budget: &mut budget::Budget) -> Result<Option<ReadCurves>, FormatError> {
        let counts = self.take("curveVertexCounts").and_then(|a| a.value);
        let points = self.take("points").and_then(|a| a.value);
        let (Some(counts), Some(points)) = (counts, points) else {
            return Ok(None);
        };
        let mut points = self.points(points)?;
        let counts = self.counts(counts, points.len(), budget)?;
        self.to_world(&mut points)?;
        let shape = Shape { curves: counts.len(), points: points.len() };
        let mut notes = Vec::new();
        let widths = self.widths(&shape, &mut notes, budget)?;
        let [curve_type, basis, wrap] =
            [("type", "cubic"), ("basis", "bezier"), ("wrap", "nonperiodic")]
                .map(|(name, default)| self.token(name, default));
        let primvars = self.primvars(&shape, &mut notes, budget)?;
        Ok(Some(ReadCurves {
            purpose: self.world.purpose.clone(),
            counts,
            points,
            curve_type,
            basis,
            wrap,
            widths,
            primvars,
            notes,
            path: self.path,
        }))
    }

    fn take(&mut self, name: &str) -> Option<Attribute> {
        let index = self.attributes.iter().position(|attribute| attribute.name == name)?;
        // The order of what is left is the file's order of primvars.
        Some(self.attributes.remove(index))
    }

    fn token(&mut self, name: &str, default: &str) -> String {
        match self.take(name).and_then(|attribute| attribute.value) {
            Some(Value::Texts(texts)) if texts.len() == 1 => texts.into_iter().next(),
            _ => None,
        }
        .unwrap_or_else(|| default.to_owned())
    }

    fn error(&self, attribute: &str, reason: impl Into<String>) -> FormatError {
        FormatError::at(format!("{}.{attribute}", self.path), reason)
    }

    fn points(&self, value: Value) -> Result<Vec<Vec3>, FormatError> {
        let points = match value {
            Value::Float3s(points) => points,
            Value::Doubles { per: 3, values } => {
                let vector = |v: &[f64]| Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32);
                values.chunks_exact(3).map(vector).collect()
            }
            _ => return Err(self.error("points", "the values are no positions")),
        };
        match points.iter().position(|point| !point.is_finite()) {
            Some(index) => {
                Err(self.error("points", format!("point {index} is no finite position")))
            }
            None => Ok(points),
        }
    }

    fn counts(
        &self,
        value: Value,
        points: usize,
        budget: &mut budget::Budget,
    ) -> Result<Vec<u32>, FormatError> {
        let Value::Ints(signed) = value else {
            return Err(self.error("curveVertexCounts", "the values are no integers"));
        };
        budget.charge_items::<u32>(signed.len() as u64)?;
        let mut counts = Vec::with_capacity(signed.len());
        let mut counted = 0u64;
        for (curve, &count) in signed.iter().enumerate() {
            let Ok(count) = u32::try_from(count) else {
                let reason = format!("curve {curve} has {count} points");
                return Err(self.error("curveVertexCounts", reason));
            };
            counted += count as u64;
            counts.push(count);
        }
        if counted != points as u64 {
            let reason = format!("the curves count {counted} points, but there are {points}");
            return Err(self.error("curveVertexCounts", reason));
        }
        Ok(counts)
    }

    /// Moves points to the world. An identity is left out, so that such points keep their bits.
    fn to_world(&self, points: &mut [Vec3]) -> Result<(), FormatError> {
        if self.world.centimetres_from_local == DMat4::IDENTITY {
            return Ok(());
        }
        for (index, point) in points.iter_mut().enumerate() {
            let moved = self.world.centimetres_from_local.transform_point3(point.as_dvec3());
            *point = moved.as_vec3();
            if !point.is_finite() {
                let reason = format!("point {index} leaves the numbers in world space");
                return Err(self.error("points", reason));
            }
        }
        Ok(())
    }

    fn widths(
        &mut self,
        shape: &Shape,
        notes: &mut Vec<String>,
        budget: &mut budget::Budget,
    ) -> Result<Option<ReadWidths>, FormatError> {
        let Some(attribute) = self.take("widths") else { return Ok(None) };
        let interpolation = attribute.interpolation.unwrap_or_else(|| "vertex".into());
        let Some(value) = attribute.value else { return Ok(None) };
        let Some(ReadValues::Float(mut values)) = read_values(value, budget)? else {
            notes.push("widths were left out: the values are no numbers".into());
            return Ok(None);
        };
        let scale = self.world.width_scale();
        values.iter_mut().for_each(|width| *width = (*width as f64 * scale) as f32);
        if !values.iter().all(|width| width.is_finite()) {
            notes.push("widths were left out: not all are finite numbers".into());
            return Ok(None);
        }
        // Files state one width for all without saying "constant", and renderers take it so.
        let interpolation = if values.len() == 1 { "constant".into() } else { interpolation };
        Ok(match shape.misfit(&interpolation, values.len()) {
            Some(reason) => {
                notes.push(format!("widths were left out: {reason}"));
                None
            }
            None => Some(ReadWidths { interpolation, values }),
        })
    }

    fn primvars(
        &mut self,
        shape: &Shape,
        notes: &mut Vec<String>,
        budget: &mut budget::Budget,
    ) -> Result<Vec<ReadPrimvar>, FormatError> {
        let mut primvars = Vec::new();
        let mut indices = Vec::new();
        for attribute in std::mem::take(&mut self.attributes) {
            let Some(name) = attribute.name.strip_prefix("primvars:") else { continue };
            match (name.strip_suffix(":indices"), attribute.value) {
                (_, None) => {}
                (Some(of), Some(Value::Ints(values))) => indices.push((of.to_owned(), values)),
                (_, Some(value)) => primvars.push(Unresolved {
                    name: name.to_owned(),
                    type_name: attribute.type_name,
                    interpolation: attribute.interpolation,
                    value,
                }),
            }
        }
        indices.sort_by(|a, b| a.0.cmp(&b.0));
        let mut read = Vec::new();
        for primvar in primvars {
            let found = indices.binary_search_by(|(of, _)| of.as_str().cmp(&primvar.name)).ok();
            let indices = found.map(|found| indices[found].1.as_slice());
            let name = primvar.name.clone();
            match primvar.resolve(indices, shape, budget)? {
                Ok(primvar) => read.push(primvar),
                Err(reason) => notes.push(format!("primvar {name} was left out: {reason}")),
            }
        }
        Ok(read)
    }
}

/// How many curves and points the values of a prim have to fit.
struct Shape {
    curves: usize,
    points: usize,
}

impl Shape {
    /// Why so many values do not fit the interpolation; `None` when they do.
    fn misfit(&self, interpolation: &str, found: usize) -> Option<String> {
        let wanted = match interpolation {
            "constant" => 1,
            "uniform" => self.curves,
            "vertex" => self.points,
            // Depends on basis and wrap, and readers disagree: passed on as it is.
            "varying" => found,
            other => return Some(format!("curves have no {other:?} interpolation")),
        };
        let reason = || format!("{found} values where {interpolation} asks for {wanted}");
        (found != wanted).then(reason)
    }
}

/// A primvar before its indices are applied.
struct Unresolved {
    name: String,
    type_name: String,
    interpolation: Option<String>,
    value: Value,
}

impl Unresolved {
    /// The inner error says why the primvar is left out, the outer that the file is refused.
    fn resolve(
        self,
        indices: Option<&[i32]>,
        shape: &Shape,
        budget: &mut budget::Budget,
    ) -> Result<Result<ReadPrimvar, String>, FormatError> {
        let interpolation = self.interpolation.unwrap_or_else(|| "constant".into());
        let Some(mut values) = read_values(self.value, budget)? else {
            return Ok(Err(format!("{} values are not read", self.type_name)));
        };
        if let Some(indices) = indices {
            values = match values.at_indices(indices, budget)? {
                Some(values) => values,
                None => return Ok(Err("an index is outside its values".into())),
            };
        }
        if let Some(reason) = shape.misfit(&interpolation, values.len()) {
            return Ok(Err(reason));
        }
        let (name, type_name) = (self.name, self.type_name);
        Ok(Ok(ReadPrimvar { name, type_name, interpolation, values }))
    }
}

impl ReadValues {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Int(values) => values.len(),
            Self::Int64(values) => values.len(),
            Self::Float(values) => values.len(),
            Self::Float2(values) => values.len(),
            Self::Float3(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// True when there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values that indices pick; `None` when one picks none.
    fn at_indices(
        &self,
        indices: &[i32],
        budget: &mut budget::Budget,
    ) -> Result<Option<Self>, FormatError> {
        Ok(match self {
            Self::Int(values) => pick(values, indices, budget)?.map(Self::Int),
            Self::Int64(values) => pick(values, indices, budget)?.map(Self::Int64),
            Self::Float(values) => pick(values, indices, budget)?.map(Self::Float),
            Self::Float2(values) => pick(values, indices, budget)?.map(Self::Float2),
            Self::Float3(values) => pick(values, indices, budget)?.map(Self::Float3),
            Self::Text(values) => {
                for &index in indices {
                    let text = usize::try_from(index).ok().and_then(|index| values.get(index));
                    budget.charge(text.map_or(0, |text| text.len() as u64))?;
                }
                pick(values, indices, budget)?.map(Self::Text)
            }
        })
    }
}

fn pick<T: Clone>(
    values: &[T],
    indices: &[i32],
    budget: &mut budget::Budget,
) -> Result<Option<Vec<T>>, FormatError> {
    budget.charge_items::<T>(indices.len() as u64)?;
    let at = |&index: &i32| values.get(usize::try_from(index).ok()?).cloned();
    Ok(indices.iter().map(at).collect())
}

/// Values as primvars have them; `None` for types that curves have no use for.
fn read_values(
    value: Value,
    budget: &mut budget::Budget,
) -> Result<Option<ReadValues>, FormatError> {
    Ok(Some(match value {
        Value::Ints(values) => ReadValues::Int(values),
        Value::Longs(values) => ReadValues::Int64(values),
        Value::Floats(values) => ReadValues::Float(values),
        Value::Float2s(values) => ReadValues::Float2(values),
        Value::Float3s(values) => ReadValues::Float3(values),
        Value::Texts(values) => ReadValues::Text(values),
        Value::Doubles { per, values } => {
            budget.charge_items::<f32>(values.len() as u64)?;
            match per {
                1 => ReadValues::Float(values.iter().map(|&value| value as f32).collect()),
                2 => ReadValues::Float2(
                    values.chunks_exact(2).map(|v| Vec2::new(v[0] as f32, v[1] as f32)).collect(),
                ),
                3 => ReadValues::Float3(
                    values
                        .chunks_exact(3)
                        .map(|v| Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32))
                        .collect(),
                ),
                _ => return Ok(None),
            }
        }
    }))
}
