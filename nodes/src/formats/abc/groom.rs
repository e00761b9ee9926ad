//! A groom as a tree of Alembic objects; the layout is told in [`super`].
//!
//! Guaranteed: names hold nothing that a path or metadata cannot (`/`, `;`, `=`, control characters) and are unique, the box is that
//! of the points, and the same groom gives the same bytes. Positions and widths are written as they are given. Nothing is animated.

use super::super::FormatError;
use super::super::usd::groom::{
    CheckedCurves, CurveSet, GroomStage, Interpolation, Primvar, PrimvarValues, Purpose, Widths,
    unique,
};
use super::ogawa::{self, Object, Pod, Property, PropertyKind, Values, metadata};
use crate::data::scalp::Scalp;
use glam::Vec3;
use std::io::{Seek, Write};
use std::sync::Arc;

/// Version of Epic's schema of grooms that is written.
const GROOM_VERSION: [i16; 2] = [1, 5];

/// Writes the stage, and the meshes of heads beside its hair.
///
/// # Errors
/// The output failed, or a curve set contradicts itself: see [`super::super::usd::groom::write_usdc`].
pub fn write(
    stage: &GroomStage,
    heads: &[Arc<Scalp>],
    out: &mut (impl Write + Seek),
) -> Result<(), FormatError> {
    let mut objects: Vec<Object> = vec![];
    let mut add = |wanted: String, schema: &str, properties| {
        let name = unique(wanted, |name| objects.iter().any(|object| object.name == name));
        let shape = Object {
            name: format!("{name}Shape"),
            metadata: schema_metadata(schema, ".geom"),
            properties: vec![Property {
                name: ".geom".into(),
                metadata: metadata(&[("schema", schema), ("schemaBaseType", GEOMETRY)]),
                kind: PropertyKind::Compound(properties),
            }],
            children: vec![],
        };
        objects.push(xform(name, vec![], vec![shape]));
    };
    for set in &stage.groups {
        let mut name = safe(&set.name);
        if set.purpose == Purpose::Guide && !name.contains("guide") {
            name += "_guides";
        }
        add(name, "AbcGeom_Curve_v2", curves(set)?);
    }
    for head in heads {
        add("head".into(), "AbcGeom_PolyMesh_v1", mesh(head));
    }
    let [major, minor] = GROOM_VERSION;
    let made = format!("graph={}, seed={}", stage.graph_hash, stage.seed);
    let user = vec![
        scalar("groom_version_major", "", Pod::I16, &[major]),
        scalar("groom_version_minor", "", Pod::I16, &[minor]),
        text("groom_tool", &stage.generator),
        text("groom_properties", &made),
    ];
    let top =
        Object { children: vec![xform(safe(&stage.name), user, objects)], ..Object::default() };
    let about = metadata(&[
        ("_ai_AlembicVersion", "Alembic 1.8.12, Ogawa as written by coif"),
        ("_ai_Application", &safe(&stage.generator)),
        ("_ai_Description", &safe(&stage.doc)),
    ]);
    ogawa::write(&top, &about, out)
}

const GEOMETRY: &str = "AbcGeom_GeomBase_v1";

fn schema_metadata(schema: &str, at: &str) -> String {
    let base = if at == ".geom" { GEOMETRY } else { "" };
    let title = format!("{schema}:{at}");
    metadata(&[("schema", schema), ("schemaBaseType", base), ("schemaObjTitle", &title)])
}

/// A transform that does nothing, over what is to have a name of its own: readers name by transforms.
fn xform<'a>(name: String, user: Vec<Property<'a>>, children: Vec<Object<'a>>) -> Object<'a> {
    const SCHEMA: &str = "AbcGeom_Xform_v3";
    let mut properties = vec![scalar(".inherits", "", Pod::Bool, &[1u8])];
    if !user.is_empty() {
        properties.push(compound(".userProperties", user));
    }
    Object {
        name,
        metadata: schema_metadata(SCHEMA, ".xform"),
        properties: vec![Property {
            name: ".xform".into(),
            metadata: metadata(&[("schema", SCHEMA)]),
            kind: PropertyKind::Compound(properties),
        }],
        children,
    }
}

fn curves<'a>(set: &'a CurveSet<'a>) -> Result<Vec<Property<'a>>, FormatError> {
    let shape = CheckedCurves::of(set)?;
    const CUBIC: u8 = 0;
    const NOT_PERIODIC: u8 = 0;
    const CATMULL_ROM: u8 = 3;
    let mut properties = vec![
        bounds(set.points.values()),
        positions(Values::chunks(&set.points)),
        array("nVertices", "", Pod::I32, Values::chunks(&set.counts)),
        scalar("curveBasisAndType", "", Pod::U8, &[CUBIC, NOT_PERIODIC, CATMULL_ROM, CATMULL_ROM]),
    ];
    // One a point even where all are one: Blender passes over a single width, and Unreal reads 0 for it where others have many.
    let widths = match &set.widths {
        Widths::Vertex(widths) => Values::chunks(widths),
        Widths::Constant(width) => {
            let width = *width;
            let each = move || Box::new(std::iter::repeat(width)) as Box<dyn Iterator<Item = f32>>;
            Values::spread(each, &set.counts)
        }
    };
    properties.push(param("width", Pod::F32, 1, "", "vtx", widths));
    let st = set.primvars.iter().find(|primvar| primvar.name == "st");
    if let Some(Primvar { interpolation: Interpolation::Uniform, values, .. }) = st
        && let PrimvarValues::TexCoord(uvs) = values
    {
        properties.push(param("uv", Pod::F32, 2, "vector", "uni", Values::chunks(uvs)));
    }
    let mut params: Vec<Property> = vec![];
    for primvar in &set.primvars {
        shape.check_primvar(set, primvar)?;
        if let PrimvarValues::Text(texts) | PrimvarValues::Named(texts, _) = &primvar.values
            && texts.iter().any(|text| text.contains('\0'))
        {
            let place = format!("{}, primvar {}", set.name, primvar.name);
            return Err(FormatError::at(
                place,
                "a text holds a NUL character, which ends texts in Alembic",
            ));
        }
        let name = unique(safe(&primvar.name), |name| params.iter().any(|p| p.name == name));
        params.push(geom_param(name, primvar));
    }
    let colour = set.primvars.iter().find(|primvar| primvar.name == "displayColor");
    if let Some(Primvar { interpolation, values: PrimvarValues::Color(colours), .. }) = colour
        && !params.iter().any(|param| param.name == "groom_color")
    {
        let values = match interpolation {
            Interpolation::Vertex => Values::chunks(colours),
            how => {
                let how = *how;
                let each = move || match how {
                    Interpolation::Constant => {
                        let one = colours.values().next().copied().unwrap_or(Vec3::ZERO);
                        Box::new(std::iter::repeat(one)) as Box<dyn Iterator<Item = Vec3>>
                    }
                    _ => Box::new(colours.values().copied()),
                };
                Values::spread(each, &set.counts)
            }
        };
        params.push(param("groom_color", Pod::F32, 3, "rgb", "vtx", values));
    }
    if !params.is_empty() {
        properties.push(compound(".arbGeomParams", params));
    }
    Ok(properties)
}

fn geom_param<'a>(name: String, primvar: &'a Primvar<'a>) -> Property<'a> {
    let scope = match primvar.interpolation {
        Interpolation::Constant => "con",
        Interpolation::Uniform => "uni",
        Interpolation::Vertex => "vtx",
    };
    let (pod, extent, meaning, values) = match &primvar.values {
        PrimvarValues::Int(values) => (Pod::I32, 1, "", Values::chunks(values)),
        PrimvarValues::Int64(values) => (Pod::I64, 1, "", Values::chunks(values)),
        PrimvarValues::Float(values) => (Pod::F32, 1, "", Values::chunks(values)),
        PrimvarValues::TexCoord(values) => (Pod::F32, 2, "vector", Values::chunks(values)),
        PrimvarValues::Vector(values) => (Pod::F32, 3, "vector", Values::chunks(values)),
        PrimvarValues::Color(values) => (Pod::F32, 3, "rgb", Values::chunks(values)),
        PrimvarValues::Point(values) => (Pod::F32, 3, "point", Values::chunks(values)),
        PrimvarValues::Text(values) => (Pod::Text, 1, "", Values::texts(values)),
        // Alembic's readers of grooms know no indices.
        PrimvarValues::Named(names, indices) => (Pod::Text, 1, "", Values::named(names, indices)),
    };
    Property { name, ..param("", pod, extent, meaning, scope, values) }
}

/// The head's mesh. Faces are clockwise in Alembic, counter-clockwise here.
fn mesh(head: &Scalp) -> Vec<Property<'_>> {
    let surface = head.surface();
    let turned = |[a, b, c]: &[u32; 3]| -> [u8; 12] { bytemuck::cast([*a, *c, *b]) };
    let three = |_: &[u32; 3]| 3i32.to_le_bytes();
    let mut properties = vec![
        bounds(surface.points.iter()),
        positions(Values::made(&surface.points, 1, |p| -> [u8; 12] { bytemuck::cast(*p) })),
        array(".faceIndices", "", Pod::I32, Values::made(&surface.triangles, 3, turned)),
        array(".faceCounts", "", Pod::I32, Values::made(&surface.triangles, 1, three)),
    ];
    if let Some(uvs) = head.uvs() {
        let turned = |[a, b, c]: &[glam::Vec2; 3]| -> [u8; 24] { bytemuck::cast([*a, *c, *b]) };
        properties.push(param("uv", Pod::F32, 2, "vector", "fvr", Values::made(uvs, 3, turned)));
    }
    properties
}

fn bounds<'p>(points: impl Iterator<Item = &'p Vec3>) -> Property<'static> {
    let start = (Vec3::MAX, Vec3::MIN);
    let (low, high) = points.fold(start, |(low, high), p| (low.min(*p), high.max(*p)));
    let corners = if low.x <= high.x { [low, high] } else { [Vec3::ZERO; 2] };
    let corners = corners.map(|corner| corner.as_dvec3().to_array());
    scalar(".selfBnds", "interpretation=box", Pod::F64, corners.as_flattened())
}

fn positions(values: Values<'_>) -> Property<'_> {
    let kind = PropertyKind::Array(Pod::F32, 3, values);
    Property { name: "P".into(), metadata: "geoScope=vtx;interpretation=point".into(), kind }
}

fn scalar<T: bytemuck::NoUninit>(
    name: &str,
    metadata: &str,
    pod: Pod,
    values: &[T],
) -> Property<'static> {
    let kind = PropertyKind::Scalar(pod, values.len() as u8, Values::of(values, 1));
    Property { name: name.into(), metadata: metadata.into(), kind }
}

fn text(name: &str, text: &str) -> Property<'static> {
    let kind = PropertyKind::Scalar(Pod::Text, 1, Values::texts(&[text.replace('\0', "_")]));
    Property { name: name.into(), metadata: String::new(), kind }
}

fn array<'a>(name: &str, metadata: &str, pod: Pod, values: Values<'a>) -> Property<'a> {
    Property {
        name: name.into(),
        metadata: metadata.into(),
        kind: PropertyKind::Array(pod, 1, values),
    }
}

fn compound<'a>(name: &str, inner: Vec<Property<'a>>) -> Property<'a> {
    Property { name: name.into(), metadata: String::new(), kind: PropertyKind::Compound(inner) }
}

/// Values with a scope, as Alembic's typed readers ask for them.
fn param<'a>(
    name: &str,
    pod: Pod,
    extent: u8,
    interpretation: &str,
    scope: &str,
    values: Values<'a>,
) -> Property<'a> {
    let metadata = metadata(&[
        ("isGeomParam", "true"),
        ("podName", pod.name()),
        ("podExtent", &extent.to_string()),
        ("arrayExtent", "1"),
        ("interpretation", interpretation),
        ("geoScope", scope),
    ]);
    Property { name: name.into(), metadata, kind: PropertyKind::Array(pod, extent, values) }
}

/// The name without what paths and metadata are made of.
fn safe(name: &str) -> String {
    let is_bad = |c: char| matches!(c, '/' | ';' | '=') || c.is_control();
    let safe: String = name.chars().map(|c| if is_bad(c) { '_' } else { c }).collect();
    if safe.is_empty() { "_".into() } else { safe }
}
