//! Widths and primvars: values that fit the curves, their indices resolved.

use super::super::super::FormatError;
use super::super::form::Form;
use super::budget::ReadBudget;
use super::tree::ParsedValue;
use glam::{Vec2, Vec3};

/// Diameters of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadWidths {
    /// `constant`, `uniform`, `varying`, `vertex` or `faceVarying`, which is as `varying`; the first for any single value.
    pub interpolation: String,
    /// Finite, as many as the interpolation asks.
    pub values: Vec<f32>,
}

/// A primvar of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPrimvar {
    /// Name after `primvars:`.
    pub name: String,
    /// Value type as written, for example `color3f[]`.
    pub type_name: String,
    /// `constant`, `uniform`, `varying`, `vertex` or `faceVarying`, which is as `varying`.
    pub interpolation: String,
    /// As many as the interpolation asks.
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

/// How many values of each interpolation a prim asks for.
pub(in crate::formats) struct InterpolationCounts {
    curves: usize,
    points: usize,
    varying: usize,
}

impl InterpolationCounts {
    pub(in crate::formats) fn of(form: Form, counts: &[u32], points: usize) -> Self {
        let varying = counts.iter().map(|count| form.varying(*count as usize)).sum();
        Self { curves: counts.len(), points, varying }
    }

    /// Why so many values do not fit the interpolation; `None` when they do.
    pub(in crate::formats) fn misfit(&self, interpolation: &str, found: usize) -> Option<String> {
        let wanted = match interpolation {
            "constant" => 1,
            "uniform" => self.curves,
            "vertex" => self.points,
            "varying" | "faceVarying" => self.varying,
            other => return Some(format!("curves have no {other:?} interpolation")),
        };
        let reason = || format!("{found} values where {interpolation} asks for {wanted}");
        (found != wanted).then(reason)
    }

    /// The interpolation that so many values fit: the coarsest where they fit several. `None` where they fit none.
    pub(in crate::formats) fn fitting(&self, found: usize) -> Option<&'static str> {
        let all = ["constant", "uniform", "vertex", "varying"];
        all.into_iter().find(|interpolation| self.misfit(interpolation, found).is_none())
    }
}

/// Whether values of curves can be spread so.
pub(super) fn is_interpolation(name: &str) -> bool {
    matches!(name, "constant" | "uniform" | "vertex" | "varying" | "faceVarying")
}

/// A primvar before its indices are applied.
pub(super) struct Unresolved {
    pub(super) name: String,
    pub(super) type_name: String,
    pub(super) interpolation: Option<String>,
    pub(super) value: ParsedValue,
}

impl Unresolved {
    /// The inner error says why the primvar is left out, the outer that the file is refused.
    pub(super) fn resolve(
        self,
        indices: Option<&[i32]>,
        shape: &InterpolationCounts,
        budget: &mut ReadBudget,
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
        budget: &mut ReadBudget,
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
    budget: &mut ReadBudget,
) -> Result<Option<Vec<T>>, FormatError> {
    budget.charge_items::<T>(indices.len() as u64)?;
    let at = |&index: &i32| values.get(usize::try_from(index).ok()?).cloned();
    Ok(indices.iter().map(at).collect())
}

/// Values as primvars have them; `None` for types that curves have no use for.
fn read_values(
    value: ParsedValue,
    budget: &mut ReadBudget,
) -> Result<Option<ReadValues>, FormatError> {
    Ok(Some(match value {
        ParsedValue::Ints(values) => ReadValues::Int(values),
        ParsedValue::Longs(values) => ReadValues::Int64(values),
        ParsedValue::Floats(values) => ReadValues::Float(values),
        ParsedValue::Float2s(values) => ReadValues::Float2(values),
        ParsedValue::Float3s(values) => ReadValues::Float3(values),
        ParsedValue::Texts(values) => ReadValues::Text(values),
        ParsedValue::Doubles { per, values } => {
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
