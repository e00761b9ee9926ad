//! What both parsers hand over, a layer: its prim specs with the few values that curves need, and what they bring in from elsewhere.
//! And what composition makes of layers: the prims of a stage.

use super::super::super::FormatError;
use super::budget::ReadBudget;
use glam::{Vec2, Vec3};

/// The prim specs of a layer and its metadata.
///
/// **Invariant:** parents come before their children.
#[derive(Debug, Default)]
pub(super) struct ParsedLayer {
    pub(super) meters_per_unit: Option<f64>,
    pub(super) up_axis: Option<String>,
    pub(super) default_prim: Option<String>,
    /// Assets, strongest first.
    pub(super) sub_layers: Vec<String>,
    pub(super) specs: Vec<Spec>,
    /// Specs at the root, in file order.
    pub(super) roots: Vec<u32>,
    /// All specs but variants, sorted by parent and name.
    by_name: Vec<u32>,
}

/// What one layer says of a prim, or of one of its variants.
#[derive(Debug, Default)]
pub(super) struct Spec {
    /// Index of the parent; `None` at the root.
    pub(super) parent: Option<usize>,
    /// Name of the prim, or of the variant.
    pub(super) name: String,
    /// The set, when this is a variant of its parent.
    pub(super) variant_of: Option<String>,
    pub(super) type_name: String,
    pub(super) specifier: Specifier,
    pub(super) is_active: Option<bool>,
    pub(super) is_instanceable: Option<bool>,
    /// Values of it lie in further layers by time.
    pub(super) has_clips: bool,
    /// What it brings in, in file order.
    pub(super) arcs: Vec<ListEdit>,
    /// Set and name of the variants that it selects.
    pub(super) selections: Vec<[String; 2]>,
    /// Those that [`is_wanted`], in file order.
    pub(super) attributes: Vec<PrimAttribute>,
    /// Prims below it and its variants, in file order.
    pub(super) children: Vec<u32>,
    pub(super) variants: Vec<u32>,
    /// How many prims of a stage it speaks of.
    pub(super) uses: u32,
}

/// How a prim spec begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Specifier {
    Def,
    #[default]
    Over,
    Class,
}

/// How opinions are brought in, the strongest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Arc {
    Inherit,
    Variant,
    Reference,
    Payload,
    Specialize,
}

/// How a list of targets changes that of weaker layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edit {
    Explicit,
    Add,
    Prepend,
    Append,
    Delete,
    /// Only the order.
    Reorder,
}

/// Targets of arcs of a kind.
#[derive(Debug)]
pub(super) struct ListEdit {
    pub(super) arc: Arc,
    pub(super) edit: Edit,
    pub(super) targets: Vec<Target>,
}

/// Where an arc leads.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Target {
    /// Empty: the layer itself.
    pub(super) asset: String,
    /// Empty: the default prim.
    pub(super) path: String,
}

/// The prims of a stage.
///
/// **Invariant:** parents come before their children; all are defined and active.
#[derive(Debug, Default)]
pub(super) struct Stage {
    pub(super) meters_per_unit: Option<f64>,
    pub(super) up_axis: Option<String>,
    pub(super) prims: Vec<Prim>,
}

/// One prim.
#[derive(Debug)]
pub(super) struct Prim {
    /// Index of the parent; `None` at the root.
    pub(super) parent: Option<usize>,
    pub(super) name: String,
    pub(super) type_name: String,
    /// Those that [`is_wanted`], in file order.
    pub(super) attributes: Vec<PrimAttribute>,
}

/// One attribute.
#[derive(Clone, Debug, Default)]
pub(super) struct PrimAttribute {
    pub(super) name: String,
    pub(super) type_name: String,
    pub(super) interpolation: Option<String>,
    /// The default, else the earliest sample; `None` when blocked, missing or of an unread type.
    pub(super) value: Option<ParsedValue>,
    /// It is said to have no value, whatever weaker layers say.
    pub(super) is_blocked: bool,
    /// How many samples in time it has beside its value.
    pub(super) unread: u64,
}

/// A value or an array; a single value is an array of one.
#[derive(Clone, Debug)]
pub(super) enum ParsedValue {
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

impl ParsedValue {
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

    /// Number of values.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Ints(values) => values.len(),
            Self::Longs(values) => values.len(),
            Self::Floats(values) => values.len(),
            Self::Float2s(values) => values.len(),
            Self::Float3s(values) => values.len(),
            Self::Doubles { per, values } => values.len() / per,
            Self::Texts(texts) => texts.len(),
        }
    }

    /// Bytes that a copy takes.
    pub(super) fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Ints(values) => size_of_val(values.as_slice()),
            Self::Longs(values) => size_of_val(values.as_slice()),
            Self::Floats(values) => size_of_val(values.as_slice()),
            Self::Float2s(values) => size_of_val(values.as_slice()),
            Self::Float3s(values) => size_of_val(values.as_slice()),
            Self::Doubles { values, .. } => size_of_val(values.as_slice()),
            Self::Texts(texts) => texts.iter().map(|text| size_of::<String>() + text.len()).sum(),
        };
        bytes as u64
    }
}

/// Whether an attribute is worth decoding: everything of curves, and of prims that another layer may say are curves; of other
/// prims what they pass down.
pub(super) fn is_wanted(prim_type: &str, attribute: &str) -> bool {
    matches!(prim_type, "BasisCurves" | "") || is_passed_down(attribute)
}

/// Whether an attribute matters to prims below.
pub(super) fn is_passed_down(attribute: &str) -> bool {
    matches!(attribute, "purpose" | "visibility") || attribute.starts_with("xformOp")
}

impl ParsedLayer {
    /// Makes children known to their parents, once all specs are there.
    pub(super) fn index(&mut self, budget: &mut ReadBudget) -> Result<(), FormatError> {
        for at in 0..self.specs.len() {
            let (parent, is_variant) = (self.specs[at].parent, self.specs[at].variant_of.is_some());
            let list = match (parent, is_variant) {
                (None, _) => &mut self.roots,
                (Some(parent), false) => &mut self.specs[parent].children,
                (Some(parent), true) => &mut self.specs[parent].variants,
            };
            budget.push(list, at as u32)?;
        }
        budget.charge_items::<u32>(self.specs.len() as u64)?;
        let specs = &self.specs;
        let is_prim = |at: &u32| specs[*at as usize].variant_of.is_none();
        self.by_name = (0..specs.len() as u32).filter(is_prim).collect();
        let key = |at: &u32| (specs[*at as usize].parent, specs[*at as usize].name.as_str());
        self.by_name.sort_by(|a, b| key(a).cmp(&key(b)));
        Ok(())
    }

    /// The prim spec of this name below another, or at the root.
    pub(super) fn child(&self, parent: Option<usize>, name: &str) -> Option<usize> {
        let key = |at: u32| (self.specs[at as usize].parent, self.specs[at as usize].name.as_str());
        let at = self.by_name.partition_point(|at| key(*at) < (parent, name));
        self.by_name.get(at).filter(|at| key(**at) == (parent, name)).map(|at| *at as usize)
    }

    /// Path of the prim that a spec is of, charged for.
    pub(super) fn path(&self, spec: usize, budget: &mut ReadBudget) -> Result<String, FormatError> {
        let mut next = Some(spec);
        let names = std::iter::from_fn(|| {
            let spec = &self.specs[next?];
            next = spec.parent;
            Some(spec)
        });
        path_of(names.filter(|s| s.variant_of.is_none()).map(|s| s.name.as_str()), budget)
    }
}

impl Stage {
    /// Path of a prim, charged for.
    pub(super) fn path(&self, prim: usize, budget: &mut ReadBudget) -> Result<String, FormatError> {
        let mut next = Some(prim);
        let names = std::iter::from_fn(|| {
            let prim = &self.prims[next?];
            next = prim.parent;
            Some(prim.name.as_str())
        });
        path_of(names, budget)
    }
}

/// A path from its names, the last first.
fn path_of<'n>(
    up: impl Iterator<Item = &'n str>,
    budget: &mut ReadBudget,
) -> Result<String, FormatError> {
    let mut names = Vec::new();
    for name in up {
        budget.charge(name.len() as u64 + 32)?;
        names.push(name);
    }
    Ok(names.iter().rev().flat_map(|name| ["/", name]).collect())
}
