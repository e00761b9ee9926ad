//! A USD layer as a tree of prims: what both writers write.
//!
//! Arrays are [`Chunks`], so a layer borrows the groom it describes. The tree knows nothing of hair
//! and checks nothing but what would break a file: names are the caller's to make valid and unique.

use super::super::{Chunks, FormatError};
use glam::{Vec2, Vec3};

/// One layer: its metadata and root prims.
#[derive(Clone, Debug, Default)]
pub struct UsdLayer<'a> {
    /// Metadata in file order: `defaultPrim`, `documentation`, `metersPerUnit`…
    pub fields: Vec<MetadataField<'a>>,
    /// Root prims in order.
    pub prims: Vec<PrimSpec<'a>>,
}

/// A metadata field: its name in crate files and its value.
pub type MetadataField<'a> = (&'static str, UsdValue<'a>);

/// A prim defined with `def`.
#[derive(Clone, Debug, Default)]
pub struct PrimSpec<'a> {
    /// A USD identifier, unique among its siblings.
    pub name: String,
    /// Schema name such as `BasisCurves`; empty for a typeless prim.
    pub type_name: &'static str,
    /// Metadata beside the type: `kind`, `apiSchemas`…
    pub fields: Vec<MetadataField<'a>>,
    /// Attributes and relationships in order.
    pub properties: Vec<PropertySpec<'a>>,
    /// Child prims in order.
    pub children: Vec<PrimSpec<'a>>,
}

/// What a prim holds beside its children.
#[derive(Clone, Debug)]
pub enum PropertySpec<'a> {
    /// A typed value.
    Attribute(AttributeSpec<'a>),
    /// Paths of other prims or properties.
    Relationship {
        /// Property name, for example `material:binding`.
        name: &'static str,
        /// Absolute paths, each in this layer.
        targets: Vec<String>,
    },
}

impl PropertySpec<'_> {
    /// The property's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Attribute(attribute) => &attribute.name,
            Self::Relationship { name, .. } => name,
        }
    }
}

/// An attribute: declared, with a value, sampled over time, or connected.
#[derive(Clone, Debug, Default)]
pub struct AttributeSpec<'a> {
    /// Name with namespaces, for example `primvars:displayColor`.
    pub name: String,
    /// Value type name, for example `color3f[]`. It must fit `default`.
    pub type_name: &'static str,
    /// Whether the value may vary over time.
    pub variability: Variability,
    /// The value outside time.
    pub default: Option<UsdValue<'a>>,
    /// Values by time code, in rising order of time. Empty: not animated.
    pub samples: Vec<(f64, UsdValue<'a>)>,
    /// How a primvar spreads over the curves: `constant`, `uniform`, `vertex`.
    pub interpolation: Option<&'static str>,
    /// Absolute paths in this layer of the attributes that drive this one.
    pub connections: Vec<String>,
}

/// Whether an attribute may be animated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variability {
    /// It may.
    #[default]
    Varying,
    /// It may not, and readers may rely on that.
    Uniform,
}

/// A value of one of the types that grooms need.
#[derive(Clone, Debug)]
pub enum UsdValue<'a> {
    /// `bool`
    Bool(bool),
    /// `int`
    Int(i32),
    /// `int64`
    Int64(i64),
    /// `uint64`
    UInt64(u64),
    /// `float`
    Float(f32),
    /// `double`
    Double(f64),
    /// `string`
    String(String),
    /// `token`
    Token(String),
    /// `asset`: a path as the file states it.
    Asset(String),
    /// `float2` and its roles.
    Vec2f(Vec2),
    /// `float3` and its roles.
    Vec3f(Vec3),
    /// `int[]`
    Ints(Chunks<'a, i32>),
    /// `int64[]`
    Int64s(Chunks<'a, i64>),
    /// `float[]`
    Floats(Chunks<'a, f32>),
    /// `float2[]` and its roles (`texCoord2f[]`).
    Vec2fs(Chunks<'a, Vec2>),
    /// `float3[]` and its roles (`point3f[]`, `color3f[]`).
    Vec3fs(Chunks<'a, Vec3>),
    /// `token[]`
    Tokens(Vec<String>),
    /// `string[]`
    Strings(Vec<String>),
    /// Tokens put before those of weaker layers, for example `prepend apiSchemas = […]`.
    TokensPrepended(Vec<String>),
    /// Values named by USD identifiers, in rising order of name.
    Dictionary(Vec<(&'static str, UsdValue<'a>)>),
}

impl UsdValue<'_> {
    /// The name that declares a value of this type in a dictionary, where no attribute does.
    pub(super) fn type_name(&self) -> &'static str {
        match self {
            Self::Bool(_) => "bool",
            Self::Int(_) => "int",
            Self::Int64(_) => "int64",
            Self::UInt64(_) => "uint64",
            Self::Float(_) => "float",
            Self::Double(_) => "double",
            Self::String(_) => "string",
            Self::Token(_) => "token",
            Self::Asset(_) => "asset",
            Self::Vec2f(_) => "float2",
            Self::Vec3f(_) => "float3",
            Self::Ints(_) => "int[]",
            Self::Int64s(_) => "int64[]",
            Self::Floats(_) => "float[]",
            Self::Vec2fs(_) => "float2[]",
            Self::Vec3fs(_) => "float3[]",
            Self::Tokens(_) | Self::TokensPrepended(_) => "token[]",
            Self::Strings(_) => "string[]",
            Self::Dictionary(_) => "dictionary",
        }
    }
}

/// Refuses the one character that neither form of the file can hold: crate files end texts with it.
pub(super) fn check_text(text: &str) -> Result<&str, FormatError> {
    match text.find('\0') {
        Some(at) => Err(FormatError::at(
            format!("text {:?}", text.chars().take(40).collect::<String>()),
            format!("a NUL character at byte {at} cannot be written to USD"),
        )),
        None => Ok(text),
    }
}
