//! What both parsers hand over: the prims of a layer with the few values that curves need.

use super::super::super::FormatError;
use super::budget::Budget;
use glam::{Vec2, Vec3};

/// The prims of a layer and its units.
///
/// **Invariant:** parents come before their children.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) meters_per_unit: Option<f64>,
    pub(super) up_axis: Option<String>,
    /// The layer says that there is more in other layers or in variants.
    pub(super) has_arcs: bool,
    pub(super) prims: Vec<Prim>,
}

/// One prim.
#[derive(Debug)]
pub(super) struct Prim {
    /// Index of the parent; `None` at the root.
    pub(super) parent: Option<usize>,
    pub(super) name: String,
    pub(super) type_name: String,
    /// Written with `def` and not deactivated.
    pub(super) is_live: bool,
    /// Those that [`is_wanted`], in file order.
    pub(super) attributes: Vec<Attribute>,
}

/// One attribute.
#[derive(Debug)]
pub(super) struct Attribute {
    pub(super) name: String,
    pub(super) type_name: String,
    pub(super) interpolation: Option<String>,
    /// The default, else the earliest sample; `None` when blocked, missing or of an unread type.
    pub(super) value: Option<Value>,
}

/// A value or an array; a single value is an array of one.
#[derive(Debug)]
pub(super) enum Value {
    /// `int` and `bool`
    Ints(Vec<i32>),
    /// `int64` and unsigned integers, the largest wrapping.
    Longs(Vec<i64>),
    Floats(Vec<f32>),
    Float2s(Vec<Vec2>),
    Float3s(Vec<Vec3>),
    /// Doubles and all tuples of 4 or 16, `per` numbers each, one after the other. Quaternions begin
    /// with the real part; matrices are row by row, for row vectors.
    Doubles {
        per: usize,
        values: Vec<f64>,
    },
    /// `string`, `token`, `asset`
    Texts(Vec<String>),
}

impl Value {
    /// All numbers in order; empty for texts. Only for the small values of transforms.
    pub(super) fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Ints(values) => values.iter().map(|&value| value as f64).collect(),
            Self::Longs(values) => values.iter().map(|&value| value as f64).collect(),
            Self::Floats(values) => values.iter().map(|&value| value as f64).collect(),
            Self::Float2s(values) => values.iter().flat_map(|v| v.as_dvec2().to_array()).collect(),
            Self::Float3s(values) => values.iter().flat_map(|v| v.as_dvec3().to_array()).collect(),
            Self::Doubles { values, .. } => values.clone(),
            Self::Texts(_) => Vec::new(),
        }
    }

    /// The only text.
    pub(super) fn as_text(&self) -> Option<&str> {
        match self {
            Self::Texts(texts) if texts.len() == 1 => Some(&texts[0]),
            _ => None,
        }
    }
}

/// Whether an attribute is worth decoding: everything of curves, of other prims what they pass down.
pub(super) fn is_wanted(prim_type: &str, attribute: &str) -> bool {
    prim_type == "BasisCurves" || attribute == "purpose" || attribute.starts_with("xformOp")
}

impl Tree {
    /// Path of a prim, charged for.
    pub(super) fn path(&self, prim: usize, budget: &mut Budget) -> Result<String, FormatError> {
        let mut names = Vec::new();
        let mut next = Some(prim);
        while let Some(index) = next {
            let name = self.prims[index].name.as_str();
            budget.charge(name.len() as u64 + 32)?;
            names.push(name);
            next = self.prims[index].parent;
        }
        Ok(names.iter().rev().flat_map(|name| ["/", name]).collect())
    }
}
