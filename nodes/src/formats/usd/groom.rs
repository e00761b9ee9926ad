//! A groom as a USD stage: which prims there are, and what they say.
//!
//! ```text
//! /Groom                 Xform, kind = component, the default prim
//!   Strands/<set>        BasisCurves: cubic, catmullRom, pinned
//!   Guides/<set>         the same with purpose = "guide"
//!   Skin/<name>          Mesh: the skin that roots are bound to, where it was asked for
//!   Looks/<set>          Material with a UsdPreviewSurface, bound by the curves
//! ```
//!
//! Guaranteed: the extent is what OpenUSD computes, `interpolation` is only `constant`, `uniform` or
//! `vertex` (counts of `varying` differ between readers), names are valid and unique, and the same
//! stage gives the same bytes. Positions and widths are written as they are given: converting units
//! and axes is the caller's. Nothing is animated. Names that no identifier can hold are kept as `displayName`.

use super::super::{Chunks, FormatError};
use super::spec::{
    AttributeSpec, MetadataField, PrimSpec, PropertySpec, UsdLayer, UsdValue, Variability,
};
use super::{usda, usdc};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::io::{Seek, Write};

/// A groom to be written.
#[derive(Clone, Debug)]
pub struct GroomStage<'a> {
    /// Name of the root prim; made a valid identifier.
    pub name: String,
    /// What the file says about itself, for people.
    pub doc: String,
    /// Program and version that wrote it.
    pub generator: String,
    /// Hash of the graph that made the groom.
    pub graph_hash: String,
    /// Seed the graph ran with.
    pub seed: u64,
    /// Length of a unit in metres: 0.01 for centimetres.
    pub meters_per_unit: f64,
    /// Which axis points up.
    pub up_axis: UpAxis,
    /// The curves, in file order.
    pub groups: Vec<CurveSet<'a>>,
    /// Meshes beside them.
    pub skins: Vec<SkinMesh<'a>>,
}

/// A mesh of triangles.
#[derive(Clone, Debug)]
pub struct SkinMesh<'a> {
    /// Name of the prim; made valid and unique.
    pub name: String,
    /// Corners, in stage units and axes.
    pub points: &'a [Vec3],
    /// Counter-clockwise seen from outside, as `skinprim` counts them.
    pub triangles: &'a [[u32; 3]],
    /// Texture coordinates of each triangle's corners.
    pub uvs: Option<&'a [[Vec2; 3]]>,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// Most film and game tools.
    #[default]
    Y,
    /// Blender, CAD.
    Z,
}

/// What curves are for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// Hair to be seen.
    #[default]
    Render,
    /// Curves that steer others; renderers leave them out.
    Guide,
}

/// Curves that share a material: one BasisCurves prim.
#[derive(Clone, Debug, Default)]
pub struct CurveSet<'a> {
    /// Name of the prim and its material; made valid and unique.
    pub name: String,
    /// Strands or guides.
    pub purpose: Purpose,
    /// Points of each curve, at least 2 each. No curves at all is valid.
    pub counts: Chunks<'a, i32>,
    /// Root to tip, curve after curve, in stage units and axes.
    pub points: Chunks<'a, Vec3>,
    /// Diameters in stage units.
    pub widths: Widths<'a>,
    /// Further values for the curves or their points.
    pub primvars: Vec<Primvar<'a>>,
    /// Diffuse colour of the material, linear, 0 to 1.
    pub color: Vec3,
}

/// Diameters in stage units.
#[derive(Clone, Debug)]
pub enum Widths<'a> {
    /// One for all.
    Constant(f32),
    /// One for each point.
    Vertex(Chunks<'a, f32>),
}

impl Default for Widths<'_> {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

/// Named values that travel with curves.
#[derive(Clone, Debug)]
pub struct Primvar<'a> {
    /// Name after `primvars:`; colons separate namespaces. Made valid and unique.
    pub name: String,
    /// How many values there are.
    pub interpolation: Interpolation,
    /// The values.
    pub values: PrimvarValues<'a>,
}

/// How the values of a primvar spread over the curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// One value in all.
    Constant,
    /// One for each curve.
    Uniform,
    /// One for each point.
    Vertex,
}

impl Interpolation {
    /// The name in USD.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Uniform => "uniform",
            Self::Vertex => "vertex",
        }
    }
}

/// Values of a primvar, by type.
#[derive(Clone, Debug)]
pub enum PrimvarValues<'a> {
    /// `int[]`
    Int(Chunks<'a, i32>),
    /// `int64[]`
    Int64(Chunks<'a, i64>),
    /// `float[]`
    Float(Chunks<'a, f32>),
    /// `texCoord2f[]`
    TexCoord(Chunks<'a, Vec2>),
    /// `float3[]`
    Vector(Chunks<'a, Vec3>),
    /// `color3f[]`, linear
    Color(Chunks<'a, Vec3>),
    /// `point3f[]`
    Point(Chunks<'a, Vec3>),
    /// `string[]`
    Text(Vec<String>),
    /// `string[]` by `indices`: each text once, and the number of its text for each value.
    Named(Vec<String>, Chunks<'a, i32>),
}

impl PrimvarValues<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Int(values) => values.len(),
            Self::Int64(values) => values.len(),
            Self::Float(values) => values.len(),
            Self::TexCoord(values) => values.len(),
            Self::Vector(values) | Self::Color(values) | Self::Point(values) => values.len(),
            Self::Named(_, indices) => indices.len(),
            Self::Text(values) => values.len(),
        }
    }
}

/// Writes the stage as text.
///
/// # Errors
/// The output failed, a text holds a NUL, or a curve set contradicts itself: see [`write_usdc`].
pub fn write_usda(stage: &GroomStage, out: &mut (impl Write + ?Sized)) -> Result<(), FormatError> {
    usda::write(&layer(stage)?, out)
}

/// Writes the stage as a crate file.
///
/// # Errors
/// The output failed, a text holds a NUL, or a curve set contradicts itself: a curve of fewer than 2
/// points, counts that are not the number of points, a width or primvar of another length than its
/// interpolation asks, a point or width that is no finite number.
pub fn write_usdc(stage: &GroomStage, out: &mut (impl Write + Seek)) -> Result<(), FormatError> {
    usdc::write(&layer(stage)?, out)
}

/// The stage as prims. Borrows the arrays of the stage.
///
/// # Errors
/// A curve set contradicts itself, as for [`write_usdc`].
pub fn layer<'a>(stage: &'a GroomStage<'a>) -> Result<UsdLayer<'a>, FormatError> {
    let name = identifier(&stage.name);
    let mut scopes = Scopes::of(&name);
    for set in &stage.groups {
        scopes.add(set)?;
    }
    for skin in &stage.skins {
        let is_taken = |name: &str| scopes.skins.iter().any(|prim| prim.name == name);
        let name = unique(identifier(&skin.name), is_taken);
        scopes.skins.push(mesh(skin, name));
    }
    let root = PrimSpec {
        name: name.clone(),
        type_name: "Xform",
        fields: [("kind", UsdValue::Token("component".into()))]
            .into_iter()
            .chain(display_name(&stage.name, &name))
            .collect(),
        children: scopes.prims(),
        ..PrimSpec::default()
    };
    Ok(UsdLayer { fields: layer_fields(stage, name), prims: vec![root] })
}

fn layer_fields<'a>(stage: &GroomStage, default_prim: String) -> Vec<MetadataField<'a>> {
    let up_axis = match stage.up_axis {
        UpAxis::Y => "Y",
        UpAxis::Z => "Z",
    };
    let about = vec![
        ("generator", UsdValue::String(stage.generator.clone())),
        ("graph", UsdValue::String(stage.graph_hash.clone())),
        ("seed", UsdValue::UInt64(stage.seed)),
    ];
    vec![
        ("customLayerData", UsdValue::Dictionary(about)),
        ("defaultPrim", UsdValue::Token(default_prim)),
        ("documentation", UsdValue::String(stage.doc.clone())),
        ("metersPerUnit", UsdValue::Double(stage.meters_per_unit)),
        ("upAxis", UsdValue::Token(up_axis.into())),
    ]
}

/// The three scopes under the root while they fill.
struct Scopes<'a> {
    /// Path of the root prim.
    root: String,
    strands: Vec<PrimSpec<'a>>,
    guides: Vec<PrimSpec<'a>>,
    skins: Vec<PrimSpec<'a>>,
    looks: Vec<PrimSpec<'a>>,
}

impl<'a> Scopes<'a> {
    fn of(root_name: &str) -> Self {
        let root = format!("/{root_name}");
        Self { root, strands: vec![], guides: vec![], skins: vec![], looks: vec![] }
    }

    fn add(&mut self, set: &'a CurveSet<'a>) -> Result<(), FormatError> {
        let scope = match set.purpose {
            Purpose::Render => &mut self.strands,
            Purpose::Guide => &mut self.guides,
        };
        let wanted = identifier(&set.name);
        let name = unique(wanted.clone(), |name| scope.iter().any(|prim| prim.name == name));
        let look_name = unique(wanted, |name| self.looks.iter().any(|prim| prim.name == name));
        let look = format!("{}/Looks/{look_name}", self.root);
        scope.push(curves(set, name, &look)?);
        self.looks.push(material(look_name, &look, set));
        Ok(())
    }

    fn prims(self) -> Vec<PrimSpec<'a>> {
        let scopes = [
            ("Strands", self.strands),
            ("Guides", self.guides),
            ("Skin", self.skins),
            ("Looks", self.looks),
        ];
        scopes
            .into_iter()
            .filter(|(_, children)| !children.is_empty())
            .map(|(name, children)| PrimSpec {
                name: name.into(),
                type_name: "Scope",
                children,
                ..PrimSpec::default()
            })
            .collect()
    }
}

fn curves<'a>(
    set: &'a CurveSet<'a>,
    name: String,
    material: &str,
) -> Result<PrimSpec<'a>, FormatError> {
    let shape = CheckedCurves::of(set)?;
    let mut properties = vec![
        uniform_token("type", "cubic"),
        uniform_token("basis", "catmullRom"),
        uniform_token("wrap", "pinned"),
        attribute("curveVertexCounts", "int[]", UsdValue::Ints(set.counts.clone())),
        attribute("points", "point3f[]", UsdValue::Vec3fs(set.points.clone())),
        widths(set),
    ];
    if set.purpose == Purpose::Guide {
        properties.push(uniform_token("purpose", "guide"));
    }
    // Without points there is nothing to bound, and OpenUSD would write an inside-out box.
    if let Some(extent) = shape.extent {
        properties.push(attribute("extent", "float3[]", UsdValue::Vec3fs(extent.to_vec().into())));
    }
    let mut names = BTreeSet::new();
    for primvar in &set.primvars {
        shape.check_primvar(set, primvar)?;
        let name = unique(primvar_name(&primvar.name), |name| names.contains(name));
        names.insert(name.clone());
        if let PrimvarValues::Named(_, indices) = &primvar.values {
            let indices = UsdValue::Ints(indices.clone());
            properties.push(attribute(&format!("primvars:{name}:indices"), "int[]", indices));
        }
        properties.push(primvar_attribute(primvar, name));
    }
    let targets = vec![material.to_owned()];
    properties.push(PropertySpec::Relationship { name: "material:binding", targets });
    let mut fields =
        vec![("apiSchemas", UsdValue::TokensPrepended(vec!["MaterialBindingAPI".into()]))];
    fields.extend(display_name(&set.name, &name));
    Ok(PrimSpec { name, type_name: "BasisCurves", fields, properties, children: Vec::new() })
}

/// The name as it was given, where an identifier cannot hold it.
fn display_name<'a>(given: &str, name: &str) -> Option<MetadataField<'a>> {
    (given != name && !given.is_empty())
        .then(|| ("displayName", UsdValue::String(given.replace(char::is_control, "_"))))
}

fn mesh<'a>(skin: &SkinMesh<'a>, name: String) -> PrimSpec<'a> {
    let corners: &[i32] = bytemuck::cast_slice(skin.triangles.as_flattened());
    let three = vec![3i32; skin.triangles.len()];
    let mut properties = vec![
        uniform_token("subdivisionScheme", "none"),
        attribute("faceVertexCounts", "int[]", UsdValue::Ints(three.into())),
        attribute("faceVertexIndices", "int[]", UsdValue::Ints(corners.into())),
        attribute("points", "point3f[]", UsdValue::Vec3fs(skin.points.into())),
    ];
    if !skin.points.is_empty() {
        let [low, high] = extent(&skin.points.into(), 0.0);
        properties.push(attribute("extent", "float3[]", UsdValue::Vec3fs(vec![low, high].into())));
    }
    if let Some(uvs) = skin.uvs {
        properties.push(PropertySpec::Attribute(AttributeSpec {
            name: "primvars:st".into(),
            type_name: "texCoord2f[]",
            default: Some(UsdValue::Vec2fs(uvs.as_flattened().into())),
            interpolation: Some("faceVarying"),
            ..AttributeSpec::default()
        }));
    }
    PrimSpec { name, type_name: "Mesh", properties, ..PrimSpec::default() }
}

fn widths<'a>(set: &'a CurveSet<'a>) -> PropertySpec<'a> {
    let (values, interpolation) = match &set.widths {
        Widths::Constant(width) => (vec![*width].into(), Interpolation::Constant),
        Widths::Vertex(widths) => (widths.clone(), Interpolation::Vertex),
    };
    PropertySpec::Attribute(AttributeSpec {
        name: "widths".into(),
        type_name: "float[]",
        default: Some(UsdValue::Floats(values)),
        interpolation: Some(interpolation.name()),
        ..AttributeSpec::default()
    })
}

fn primvar_attribute<'a>(primvar: &'a Primvar<'a>, name: String) -> PropertySpec<'a> {
    let (type_name, value) = match &primvar.values {
        PrimvarValues::Int(values) => ("int[]", UsdValue::Ints(values.clone())),
        PrimvarValues::Int64(values) => ("int64[]", UsdValue::Int64s(values.clone())),
        PrimvarValues::Float(values) => ("float[]", UsdValue::Floats(values.clone())),
        PrimvarValues::TexCoord(values) => ("texCoord2f[]", UsdValue::Vec2fs(values.clone())),
        PrimvarValues::Vector(values) => ("float3[]", UsdValue::Vec3fs(values.clone())),
        PrimvarValues::Color(values) => ("color3f[]", UsdValue::Vec3fs(values.clone())),
        PrimvarValues::Point(values) => ("point3f[]", UsdValue::Vec3fs(values.clone())),
        PrimvarValues::Text(values) | PrimvarValues::Named(values, _) => {
            ("string[]", UsdValue::Strings(values.clone()))
        }
    };
    PropertySpec::Attribute(AttributeSpec {
        name: format!("primvars:{name}"),
        type_name,
        default: Some(value),
        interpolation: Some(primvar.interpolation.name()),
        ..AttributeSpec::default()
    })
}

/// A material that every renderer knows: UsdPreviewSurface with the colour of each point, where the curves have colours.
fn material<'a>(name: String, path: &str, set: &CurveSet) -> PrimSpec<'a> {
    /// Hair is glossy; a preview surface has no better model for it than a medium roughness.
    const ROUGHNESS: f32 = 0.4;
    let output = |connections| {
        PropertySpec::Attribute(AttributeSpec {
            name: "outputs:surface".into(),
            type_name: "token",
            connections,
            ..AttributeSpec::default()
        })
    };
    let has_colours = set.primvars.iter().any(|primvar| primvar.name == COLOURS);
    let diffuse = AttributeSpec {
        name: "inputs:diffuseColor".into(),
        type_name: "color3f",
        // What reads no primvars shows the mean.
        default: Some(UsdValue::Vec3f(set.color)),
        connections: match has_colours {
            true => vec![format!("{path}/Colour.outputs:result")],
            false => vec![],
        },
        ..AttributeSpec::default()
    };
    let reader = PrimSpec {
        name: "Colour".into(),
        type_name: "Shader",
        properties: vec![
            uniform_token("info:id", "UsdPrimvarReader_float3"),
            attribute("inputs:varname", "string", UsdValue::String(COLOURS.into())),
            attribute("inputs:fallback", "float3", UsdValue::Vec3f(set.color)),
            PropertySpec::Attribute(AttributeSpec {
                name: "outputs:result".into(),
                type_name: "float3",
                ..AttributeSpec::default()
            }),
        ],
        ..PrimSpec::default()
    };
    let fields = display_name(&set.name, &name).into_iter().collect();
    let shader = PrimSpec {
        name: "Surface".into(),
        type_name: "Shader",
        properties: vec![
            uniform_token("info:id", "UsdPreviewSurface"),
            PropertySpec::Attribute(diffuse),
            attribute("inputs:roughness", "float", UsdValue::Float(ROUGHNESS)),
            output(vec![]),
        ],
        ..PrimSpec::default()
    };
    PrimSpec {
        name,
        type_name: "Material",
        properties: vec![output(vec![format!("{path}/Surface.outputs:surface")])],
        fields,
        children: if has_colours { vec![reader, shader] } else { vec![shader] },
    }
}

/// The primvar that materials show.
const COLOURS: &str = "displayColor";

fn attribute<'a>(name: &str, type_name: &'static str, value: UsdValue<'a>) -> PropertySpec<'a> {
    PropertySpec::Attribute(AttributeSpec {
        name: name.into(),
        type_name,
        default: Some(value),
        ..AttributeSpec::default()
    })
}

fn uniform_token<'a>(name: &str, token: &str) -> PropertySpec<'a> {
    PropertySpec::Attribute(AttributeSpec {
        name: name.into(),
        type_name: "token",
        variability: Variability::Uniform,
        default: Some(UsdValue::Token(token.into())),
        ..AttributeSpec::default()
    })
}

/// A curve set that has been checked: how many there are and where.
pub(in super::super) struct CheckedCurves {
    curves: usize,
    points: usize,
    /// Lowest and highest corner, grown by half the largest width. `None` without points.
    extent: Option<[Vec3; 2]>,
}

impl CheckedCurves {
    pub(in super::super) fn of(set: &CurveSet) -> Result<Self, FormatError> {
        let points = checked_points(set)?;
        let widest = checked_widths(set, points)?;
        let extent = (points > 0).then(|| extent(&set.points, widest));
        Ok(Self { curves: set.counts.len(), points, extent })
    }

    pub(in super::super) fn check_primvar(
        &self,
        set: &CurveSet,
        primvar: &Primvar,
    ) -> Result<(), FormatError> {
        let wanted = match primvar.interpolation {
            Interpolation::Constant => 1,
            Interpolation::Uniform => self.curves,
            Interpolation::Vertex => self.points,
        };
        let found = primvar.values.len();
        if found == wanted {
            return Ok(());
        }
        let kind = primvar.interpolation.name();
        Err(FormatError::at(
            format!("{}, primvar {}", set.name, primvar.name),
            format!("{found} values where {kind} interpolation asks for {wanted}"),
        ))
    }
}

/// Number of points, once the counts agree with them and all are finite.
fn checked_points(set: &CurveSet) -> Result<usize, FormatError> {
    let mut counted = 0usize;
    for (curve, &count) in set.counts.values().enumerate() {
        if count < 2 {
            return Err(FormatError::at(
                format!("{}, curve {curve}", set.name),
                format!("{count} points: a pinned cubic curve needs at least 2"),
            ));
        }
        counted += count as usize;
    }
    let points = set.points.len();
    if counted != points {
        return Err(FormatError::at(
            set.name.as_str(),
            format!("the curves count {counted} points, but there are {points}"),
        ));
    }
    match set.points.values().position(|point| !point.is_finite()) {
        Some(index) => Err(FormatError::at(
            format!("{}, point {index}", set.name),
            "the position is no finite number",
        )),
        None => Ok(points),
    }
}

/// The largest width, once all are finite and as many as the points.
fn checked_widths(set: &CurveSet, points: usize) -> Result<f32, FormatError> {
    let constant;
    let widths = match &set.widths {
        Widths::Constant(width) => {
            constant = [*width];
            &Chunks::from(&constant[..])
        }
        Widths::Vertex(widths) if widths.len() == points => widths,
        Widths::Vertex(widths) => {
            return Err(FormatError::at(
                format!("{}, widths", set.name),
                format!("{} values for {points} points", widths.len()),
            ));
        }
    };
    let mut widest = 0f32;
    for (index, &width) in widths.values().enumerate() {
        if !(width >= 0.0 && width.is_finite()) {
            return Err(FormatError::at(
                format!("{}, width {index}", set.name),
                format!("{width} is no diameter: it must be finite and not negative"),
            ));
        }
        widest = widest.max(width);
    }
    Ok(widest)
}

/// As `UsdGeomBoundable::ComputeExtent` has it, to the bit.
fn extent(points: &Chunks<Vec3>, widest: f32) -> [Vec3; 2] {
    let mut low = Vec3::MAX;
    let mut high = Vec3::MIN;
    for &point in points.values() {
        low = low.min(point);
        high = high.max(point);
    }
    let margin = Vec3::splat(widest * 0.5);
    [low - margin, high + margin]
}

/// The nearest ASCII identifier: other characters become `_`, and a leading digit gets one.
/// USD allows more letters since 24.03; older readers do not.
pub fn identifier(name: &str) -> String {
    let mut identifier: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !identifier.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        identifier.insert(0, '_');
    }
    identifier
}

/// Identifiers joined by colons. `indices` cannot be the last of several: USD keeps it for itself.
fn primvar_name(name: &str) -> String {
    let mut parts: Vec<String> = name.split(':').map(identifier).collect();
    if parts.len() > 1 && parts.last().is_some_and(|last| last == "indices") {
        parts.push("_".into());
    }
    parts.join(":")
}

/// The name itself, or with `_1`, `_2`… the first that is not taken.
pub(in super::super) fn unique(name: String, is_taken: impl Fn(&str) -> bool) -> String {
    let mut candidate = name.clone();
    let mut number = 0;
    while is_taken(&candidate) {
        number += 1;
        candidate = format!("{name}_{number}");
    }
    candidate
}
