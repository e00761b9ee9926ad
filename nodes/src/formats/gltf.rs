//! Reading glTF 2.0 meshes: `.gltf`, `.glb` and `.vrm`, distinguished by their first bytes.
//!
//! Reads the meshes of the default scene with the transforms of their nodes: triangles, strips and
//! fans, uvs, vertex colours, names of materials and of nodes. Skins are evaluated at the pose that
//! the file's nodes stand in, morph targets at the weights that it gives; both with a note. Uvs are
//! turned to v up (1 - v), as in OBJ and USD; the unit is the metre.
//!
//! **Guarantees:** every accessor is tested against the bytes it reads before it is read, with sums
//! that cannot overflow. Extensions that a file requires and that change its geometry are refused
//! by name (Draco, meshopt). Only files beside or below the `.gltf` are asked for.
//! **Not promised:** that a file is valid. What is not read is not tested: materials, pictures,
//! animations, cameras, normals, skins that hold nothing and stated minima and maxima may be broken.
//!
//! We read JSON and accessors ourselves because the `gltf` crate (1.4.1) refuses numbers written as
//! `1.0`, accessors without a buffer view and quantized meshes (all valid), panics where POSITION
//! names an accessor that is not there, and takes 2.8 GB for 21 MB of empty nodes.

mod accessor;
mod affine;
mod buffers;
mod glb;
mod json;
mod looks;
mod morph;
#[cfg(test)]
mod posed;
mod primitive;
mod scene;
mod skin;

use super::mesh_in::limits::{Budget, excerpt};
use super::mesh_in::{NameTable, Side, Weld, finish};
use crate::data::mesh::{Mesh, MeshError};
use buffers::Buffers;
use glam::Vec2;
use json::{Doc, JsonValue};
pub(super) use looks::read_looks;
use primitive::{Primitive, PrimitiveKind};
use scene::{Draw, SceneSource};
use skin::Skins;

/// Extensions that a file may require and that need no support: none of them moves or hides a triangle.
const HARMLESS: &[&str] = &[
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_xmp",
    "KHR_animation_pointer",
    "VRM",
];

/// Supported extensions.
const KNOWN: &[&str] = &["KHR_mesh_quantization", "KHR_node_visibility"];

/// Reads a `.gltf` or `.glb`; `side` returns the bytes of files beside it, by relative name.
///
/// Errors name the byte of the container, line and column of the JSON, or the object, as in
/// `accessors[3]`.
pub fn read(bytes: &[u8], side: Side) -> Result<Mesh, MeshError> {
    read_as(bytes, side, Take::default())
}

/// What to read where a file has several.
#[derive(Clone, Copy, Debug, Default)]
struct Take {
    /// The set of uvs.
    uv_set: u32,
    /// Whether materials are identified by number instead of name, since names may repeat.
    numbered: bool,
}

fn read_as(bytes: &[u8], side: Side, take: Take) -> Result<Mesh, MeshError> {
    let parts = glb::split(bytes)?;
    let mut budget = Budget::new(bytes.len());
    let doc = Doc::parse(parts.json, &mut budget)?;
    refuse_other_versions(&doc)?;
    refuse_extensions(&doc)?;
    let tables = Tables::new(&doc, take, &mut budget)?;

    let mut reader = Reader {
        tables: &tables,
        buffers: Buffers::new(parts.bin, side),
        skins: Skins::default(),
        notes: Notes::default(),
        mesh: Mesh { cm_per_unit: Some(100.0), ..Mesh::default() },
        uvs: Vec::new(),
        colours: Default::default(),
        materials: NameTable::default(),
        parts: NameTable::default(),
    };
    // The scene, or a substitute if it has no triangles.
    for plan in SceneSource::of(&tables)? {
        let mut total = Total::default();
        let hidden = scene::walk(&tables, plan, &mut |draw| total.add(&tables, draw, &mut budget))?;
        // Meshes alone stand in for nodes that show none, not for those that hide them.
        if total.triangles == 0 && hidden > 0 {
            let reason = "every node with triangles is hidden by KHR_node_visibility: show the head, or export it without";
            return Err(MeshError::at("file", reason));
        }
        reader.notes.hidden = hidden;
        if total.triangles == 0 {
            continue;
        }
        budget.take("file", total.memory())?;
        reader.reserve(&total);
        scene::walk(&tables, plan, &mut |draw| reader.add(draw, &mut budget))?;
        return reader.into_mesh(plan);
    }
    let n = tables.meshes.len();
    Err(MeshError::at("file", format!("no triangles in its {n} meshes")))
}

/// The files beside a `.gltf` that [`read`] may ask for: its buffers, not its pictures. Relative names, without duplicates; none
/// if the bytes are no glTF, and none that [`read`] would refuse.
pub fn side_files(bytes: &[u8]) -> Vec<String> {
    let Ok(parts) = glb::split(bytes) else { return Vec::new() };
    let Ok(doc) = Doc::parse(parts.json, &mut Budget::new(bytes.len())) else { return Vec::new() };
    let buffers = doc.root().get("buffers").into_iter().flat_map(JsonValue::items);
    let uris = buffers.filter_map(|buffer| buffer.get("uri").and_then(JsonValue::text));
    let mut names: Vec<String> =
        uris.filter(|uri| !buffers::is_data(uri)).flat_map(buffers::side_name).collect();
    names.sort_unstable();
    names.dedup();
    names
}

fn refuse_other_versions(doc: &Doc) -> Result<(), MeshError> {
    let asset = doc.root().get("asset");
    let Some(version) = asset.and_then(|a| a.get("version")).and_then(JsonValue::text) else {
        return Err(MeshError::at("asset.version", "it is missing: this is not glTF 2.0"));
    };
    if !version.starts_with("2.") {
        let reason = format!("glTF {}, where only 2.0 is read", excerpt(version.as_bytes()));
        return Err(MeshError::at("asset.version", reason));
    }
    match asset.and_then(|a| a.get("minVersion")).and_then(JsonValue::text) {
        Some(least) if least != "2.0" => {
            let reason = format!("glTF {}, where only 2.0 is read", excerpt(least.as_bytes()));
            Err(MeshError::at("asset.minVersion", reason))
        }
        _ => Ok(()),
    }
}

fn refuse_extensions(doc: &Doc) -> Result<(), MeshError> {
    let Some(required) = doc.root().get("extensionsRequired") else { return Ok(()) };
    for name in required.items().filter_map(JsonValue::text) {
        if KNOWN.contains(&name) || HARMLESS.iter().any(|start| name.starts_with(start)) {
            continue;
        }
        return Err(unread_extension("extensionsRequired", name));
    }
    Ok(())
}

fn unread_extension(place: &str, name: &str) -> MeshError {
    let name = excerpt(name.as_bytes());
    MeshError::at(place, format!("{name} is not read: export the mesh without it"))
}

/// Arrays of the document whose items are referred to by index.
#[derive(Debug)]
struct Tables<'a> {
    doc: &'a Doc<'a>,
    take: Take,
    scenes: Table<'a>,
    nodes: Table<'a>,
    meshes: Table<'a>,
    skins: Table<'a>,
    materials: Table<'a>,
    accessors: Table<'a>,
    views: Table<'a>,
    buffers: Table<'a>,
}

impl<'a> Tables<'a> {
    fn new(doc: &'a Doc<'a>, take: Take, budget: &mut Budget) -> Result<Self, MeshError> {
        let mut table = |key| Table::new(doc, key, budget);
        Ok(Self {
            doc,
            take,
            scenes: table("scenes")?,
            nodes: table("nodes")?,
            meshes: table("meshes")?,
            skins: table("skins")?,
            materials: table("materials")?,
            accessors: table("accessors")?,
            views: table("bufferViews")?,
            buffers: table("buffers")?,
        })
    }
}

/// Position of each item of an array in the document.
#[derive(Debug)]
struct Table<'a> {
    doc: &'a Doc<'a>,
    key: &'static str,
    at: Vec<u32>,
}

impl<'a> Table<'a> {
    fn new(doc: &'a Doc<'a>, key: &'static str, budget: &mut Budget) -> Result<Self, MeshError> {
        let Some(array) = doc.root().get(key) else { return Ok(Self { doc, key, at: Vec::new() }) };
        if !array.is_array() {
            return Err(MeshError::at(key, format!("{} is no array", array.shown())));
        }
        let n = array.items().count();
        budget.take(key, 4 * n as u64)?;
        let mut at = Vec::with_capacity(n);
        at.extend(array.items().map(JsonValue::at));
        Ok(Self { doc, key, at })
    }

    fn len(&self) -> usize {
        self.at.len()
    }

    /// An item that something at `from` refers to.
    fn item(&self, number: u32, from: &str) -> Result<JsonValue<'a>, MeshError> {
        let key = self.key;
        let Some(at) = self.at.get(number as usize) else {
            let n = self.at.len();
            return Err(MeshError::at(
                from,
                format!("it names {key}[{number}], where there are {n}"),
            ));
        };
        let item = JsonValue::of(self.doc, *at);
        if !item.is_object() {
            let reason = format!("{} is no object", item.shown());
            return Err(MeshError::at(format!("{key}[{number}]"), reason));
        }
        Ok(item)
    }
}

/// A non-negative integer; `default` if it is optional and missing.
fn whole_or(
    object: JsonValue,
    key: &str,
    default: Option<u64>,
    place: &str,
) -> Result<u64, MeshError> {
    match (object.get(key), default) {
        (Some(value), _) => value.whole().ok_or_else(|| {
            MeshError::at(format!("{place}.{key}"), format!("{} is no count", value.shown()))
        }),
        (None, Some(default)) => Ok(default),
        (None, None) => Err(MeshError::at(place, format!("{key} is missing"))),
    }
}

/// The index of another object, or `None`.
fn index_or(object: JsonValue, key: &str, place: &str) -> Result<Option<u32>, MeshError> {
    let Some(value) = object.get(key) else { return Ok(None) };
    let index = value.whole().and_then(|n| u32::try_from(n).ok());
    let wrong =
        || MeshError::at(format!("{place}.{key}"), format!("{} is no index", value.shown()));
    Ok(Some(index.ok_or_else(wrong)?))
}

/// A non-empty name.
fn name_of(object: JsonValue<'_>) -> Option<&str> {
    object.get("name").and_then(JsonValue::text).filter(|name| !name.is_empty())
}

/// Counts everything before any of it is allocated.
#[derive(Debug, Default)]
struct Total {
    points: u64,
    triangles: u64,
    uvs: bool,
    colours: bool,
}

impl Total {
    fn add(&mut self, tables: &Tables, draw: &Draw, budget: &mut Budget) -> Result<(), MeshError> {
        budget.take(&draw.place, NameTable::memory(draw.name.len()))?;
        for name in &draw.also {
            budget.take(&draw.place, 32 + name.len() as u64)?;
        }
        for primitive in Primitive::all(tables, draw.mesh)? {
            // Approximate cost of a primitive that needs no decoding.
            tables.doc.tire(20)?;
            let PrimitiveKind::Triangles(primitive) = primitive? else { continue };
            if let Some((_, name)) = &primitive.material {
                budget.take(&draw.place, NameTable::memory(name.map_or(0, str::len)))?;
            }
            self.points = self.points.saturating_add(primitive.n_points());
            self.triangles = self.triangles.saturating_add(primitive.n_triangles());
            self.uvs |= primitive.uv.is_some();
            self.colours |= primitive.colour.is_some();
        }
        if self.points > u64::from(u32::MAX) || self.triangles > u64::from(u32::MAX) {
            let reason = "more than four thousand million vertices or triangles";
            return Err(MeshError::at(&draw.place, reason));
        }
        Ok(())
    }

    fn memory(&self) -> u64 {
        let point = 12 + super::mesh_in::WELD_BYTES_PER_POINT + if self.colours { 12 } else { 0 };
        let triangle = 12 + 4 + 4 + 4 + if self.uvs { 24 } else { 0 };
        self.points * point + self.triangles * triangle
    }
}

/// What was left out or repaired, counted until the end.
#[derive(Debug, Default)]
struct Notes {
    lines_and_points: usize,
    without_position: usize,
    morphed: usize,
    uneven_targets: usize,
    skinned: usize,
    unbound: usize,
    uneven_weights: usize,
    weightless: usize,
    instanced: usize,
    hidden: usize,
    left_over: usize,
    without_uv: usize,
    uv_not_finite: usize,
}

struct Reader<'r, 'a> {
    tables: &'r Tables<'a>,
    buffers: Buffers<'a>,
    skins: Skins,
    notes: Notes,
    mesh: Mesh,
    uvs: Vec<[Vec2; 3]>,
    colours: [Vec<f32>; 3],
    materials: NameTable,
    parts: NameTable,
}

impl<'a> Reader<'_, 'a> {
    fn reserve(&mut self, total: &Total) {
        let n_triangles = total.triangles as usize;
        self.mesh.points.reserve_exact(total.points as usize);
        self.mesh.triangles.reserve_exact(n_triangles);
        self.mesh.material_of.reserve_exact(n_triangles);
        self.mesh.part_of.reserve_exact(n_triangles);
        self.mesh.also_of.reserve_exact(n_triangles);
        if total.uvs {
            self.uvs.reserve_exact(n_triangles);
        }
        if total.colours {
            for channel in &mut self.colours {
                channel.reserve_exact(total.points as usize);
            }
        }
    }

    fn add(&mut self, draw: &Draw<'a>, budget: &mut Budget) -> Result<(), MeshError> {
        let part = self.parts.number(&draw.name);
        let also = self.mesh.also.len() as u32;
        self.mesh.also.push(draw.also.clone());
        self.notes.instanced += usize::from(draw.instanced);
        for primitive in Primitive::all(self.tables, draw.mesh)? {
            let primitive = match primitive? {
                PrimitiveKind::Triangles(primitive) => primitive,
                PrimitiveKind::Other => {
                    self.notes.lines_and_points += 1;
                    continue;
                }
                PrimitiveKind::NoPosition => {
                    self.notes.without_position += 1;
                    continue;
                }
            };
            let before = self.mesh.triangles.len();
            self.add_primitive(draw, &primitive, budget)?;
            let material = match primitive.material {
                None => self.materials.number(super::mesh_in::NAMELESS),
                Some((number, _)) if self.tables.take.numbered => {
                    self.materials.number(&number.to_string())
                }
                Some((_, Some(name))) => self.materials.number(name),
                Some((number, None)) => self.materials.number(&format!("material {number}")),
            };
            let n = self.mesh.triangles.len();
            self.mesh.material_of.resize(n, material);
            self.mesh.part_of.resize(n, part);
            self.mesh.also_of.resize(n, also);
            self.notes.left_over += primitive.left_over() as usize;
            if primitive.uv.is_none() {
                self.notes.without_uv += n - before;
            }
        }
        Ok(())
    }

    fn into_mesh(self, plan: SceneSource) -> Result<Mesh, MeshError> {
        let Self { mut mesh, notes, .. } = self;
        if !self.uvs.is_empty() {
            mesh.uvs = Some(self.uvs);
        }
        if self.colours.iter().any(|channel| !channel.is_empty()) {
            let names = super::obj::COLOUR_MASKS.map(str::to_owned);
            mesh.masks = names.into_iter().zip(self.colours).collect();
        }
        (mesh.materials, mesh.material_of) = self.materials.into_columns(mesh.material_of);
        (mesh.parts, mesh.part_of) = self.parts.into_columns(mesh.part_of);
        finish(&mut mesh, Weld::InPart)?;
        mesh.notes.extend(plan.note().map(str::to_owned));
        let animations = self.tables.doc.root().get("animations").into_iter();
        let animations = animations.flat_map(JsonValue::items).count();
        let without_uv = if mesh.uvs.is_some() { notes.without_uv } else { 0 };
        for (n, text) in [
            (without_uv, "triangles have no uv and got (0, 0)"),
            (notes.uv_not_finite, "uvs are not finite numbers and became (0, 0)"),
            (notes.lines_and_points, "primitives of lines and points were left out"),
            (notes.without_position, "primitives without positions were left out"),
            (notes.left_over, "vertices after the last whole triangle were left out"),
            (notes.skinned, "primitives are held by a skin, in the pose that the file is in"),
            (notes.unbound, "primitives have no joints for their skin: their nodes place them"),
            (
                notes.weightless,
                "vertices have no weights in their skin and follow their first joint",
            ),
            (
                notes.uneven_weights,
                "vertices have weights in their skin that do not sum to 1: scaled",
            ),
            (notes.morphed, "primitives are morphed as far as the file says"),
            (notes.uneven_targets, "primitives have more morph targets or fewer than weights"),
            (
                notes.hidden,
                "nodes are hidden by KHR_node_visibility: they and what lies in them were left out",
            ),
            (notes.instanced, "nodes have EXT_mesh_gpu_instancing: their copies were left out"),
            (animations, "animations are not read: the mesh is in the pose that the file is in"),
        ] {
            if n > 0 {
                mesh.notes.push(format!("{n} {text}"));
            }
        }
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// A corner of a unit square and its colour: 3 floats, 2 floats, 3 bytes and 1 of padding.
    fn numbers() -> Vec<u8> {
        let mut bytes = Vec::new();
        for [x, y] in [[0_f32, 0_f32], [1., 0.], [1., 1.], [0., 1.]] {
            for value in [x, y, 0.0, x, y] {
                bytes.extend(value.to_le_bytes());
            }
            bytes.extend([(x * 255.0) as u8, (y * 51.0) as u8, 0, 0]);
        }
        for index in [0_u16, 1, 2, 0, 2, 3] {
            bytes.extend(index.to_le_bytes());
        }
        bytes
    }

    /// The square in a node. Every piece may be replaced: `("key", "json")`.
    fn square(changes: &[(&str, &str)]) -> String {
        let mut parts = vec![
            ("asset", r#"{"version":"2.0"}"#),
            ("buffers", r#"[{"uri":"square.bin","byteLength":108}]"#),
            (
                "bufferViews",
                r#"[{"buffer":0,"byteLength":96,"byteStride":24},
                    {"buffer":0,"byteOffset":96,"byteLength":12}]"#,
            ),
            (
                "accessors",
                r#"[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},
                    {"bufferView":0,"byteOffset":12,"componentType":5126,"type":"VEC2","count":4},
                    {"bufferView":0,"byteOffset":20,"componentType":5121,"type":"VEC3","count":4,
                     "normalized":true},
                    {"bufferView":1,"componentType":5123,"type":"SCALAR","count":6}]"#,
            ),
            ("meshes", r#"[{"primitives":[{"attributes":{"POSITION":0},"indices":3}]}]"#),
            ("nodes", r#"[{"mesh":0}]"#),
            ("scenes", r#"[{"nodes":[0]}]"#),
        ];
        for (key, json) in changes {
            parts.retain(|(k, _)| k != key);
            if !json.is_empty() {
                parts.push((key, json));
            }
        }
        let parts: Vec<_> = parts.iter().map(|(k, json)| format!("\"{k}\":{json}")).collect();
        format!("{{{}}}", parts.join(","))
    }

    fn told(json: &str) -> String {
        let side = |name: &str| (name == "square.bin").then(|| Arc::from(numbers()));
        let mesh = match read(json.as_bytes(), &side) {
            Ok(mesh) => mesh,
            Err(e) => return e.to_string(),
        };
        mesh.check().unwrap();
        assert_eq!(mesh.cm_per_unit, Some(100.0));
        let points: Vec<_> = mesh.points.iter().map(|p| p.to_array()).collect();
        let mut text = format!("{points:?}\n{:?}", mesh.triangles);
        for (what, names, of) in [
            ("materials", &mesh.materials, &mesh.material_of),
            ("parts", &mesh.parts, &mesh.part_of),
        ] {
            // One part of one name is what most of these files have.
            if !names.is_empty() && *names != ["node 0"] {
                text += &format!("\n{what} {names:?} {of:?}");
            }
        }
        if let Some(uvs) = &mesh.uvs {
            let uvs: Vec<_> = uvs.iter().map(|t| t.map(|uv| uv.to_array())).collect();
            text += &format!("\nuvs {uvs:?}");
        }
        for (name, values) in &mesh.masks {
            text += &format!("\n{name} {values:?}");
        }
        for note in &mesh.notes {
            text += &format!("\nnote: {note}");
        }
        text
    }

    const POINTS: &str = "[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]";
    const TRIANGLES: &str = "[[0, 1, 2], [0, 2, 3]]";

    /// What a changed square becomes; `@` stands for its points and `#` for its triangles.
    #[track_caller]
    fn check(changes: &[(&str, &str)], expected: &[&str]) {
        let expected = expected.join("\n").replace('@', POINTS).replace('#', TRIANGLES);
        assert_eq!(told(&square(changes)), expected);
    }

    #[test]
    fn a_square_is_read_with_uvs_from_below_and_colours() {
        check(&[], &["@", "#"]);
        let all = r#"[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},
                       "indices":3,"material":0}]}]"#;
        check(
            &[("meshes", all), ("materials", r#"[{"name":"skin"}]"#)],
            &[
                "@",
                "#",
                "materials [\"skin\"] [0, 0]",
                "uvs [[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]]",
                "colour.b [0.0, 0.0, 0.0, 0.0]",
                "colour.g [0.0, 0.0, 0.2, 0.2]",
                "colour.r [0.0, 1.0, 1.0, 0.0]",
            ],
        );
    }

    #[test]
    fn nodes_place_mirror_and_repeat_their_meshes() {
        let nodes = r#"[{"name":"a","mesh":0,"children":[1.0],"translation":[0,0,1]},
                        {"name":"b","mesh":0,"scale":[-1,1,1]}]"#;
        check(
            &[("nodes", nodes)],
            &[
                "[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0], \
                 [0.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [-1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]",
                "[[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]",
                r#"parts ["a", "b"] [0, 0, 1, 1]"#,
            ],
        );
        let matrix = r#"[{"mesh":0,"matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 5,0,0,1]}]"#;
        check(
            &[("nodes", matrix)],
            &["[[5.0, 0.0, 0.0], [5.0, 1.0, 0.0], [4.0, 1.0, 0.0], [4.0, 0.0, 0.0]]", "#"],
        );
    }

    #[test]
    fn a_mesh_goes_by_its_own_name_and_those_of_the_nodes_it_lies_in_too() {
        let nodes = r#"[{"name":"rig","children":[1,2]},{"name":"Hair","children":[3]},
                        {"mesh":0,"name":"Object_1"},{"mesh":0,"name":"Object_1"}]"#;
        let mesh = r#"[{"name":"strip","primitives":[{"attributes":{"POSITION":0},"indices":3}]}]"#;
        let json = square(&[("nodes", nodes), ("meshes", mesh)]);
        let mesh = read(json.as_bytes(), &|_| Some(Arc::from(numbers()))).unwrap();
        // Both nodes have one name, and are two to leave out.
        assert_eq!(mesh.parts, ["Object_1"]);
        assert_eq!(mesh.also, [vec!["strip", "Hair", "rig"], vec!["strip", "rig"]]);
        assert_eq!(mesh.also_of, [0, 0, 1, 1]);
    }

    #[test]
    fn animations_are_told_of() {
        let note = "note: 2 animations are not read: the mesh is in the pose that the file is in";
        check(&[("animations", r#"[{"name":"walk"}, {}]"#)], &["@", "#", note]);
        check(&[("animations", "[]")], &["@", "#"]);
    }

    #[test]
    fn without_a_scene_nodes_and_then_meshes_stand_in() {
        let note = "note: no scene shows a mesh: all nodes were read";
        check(&[("scenes", "")], &["@", "#", note]);
        check(&[("scenes", "[{}]")], &["@", "#", note]);
        let parts = r#"parts ["mesh 0"] [0, 0]"#;
        let note = "note: no node shows a mesh: all meshes were read as they lie";
        check(&[("scenes", ""), ("nodes", "")], &["@", "#", parts, note]);
        check(&[("scenes", ""), ("nodes", "[{}]")], &["@", "#", parts, note]);
    }

    #[test]
    fn hidden_nodes_show_nothing_even_where_nothing_else_is_shown() {
        let nodes = |visible: &str| {
            format!(
                r#"[{{"name":"head","mesh":0}},{{"name":"hair","children":[2],"extensions":{{"KHR_node_visibility":{visible}}}}},
                    {{"name":"lock","mesh":0}}]"#
            )
        };
        let scenes = |roots: &str| format!(r#"[{{"nodes":[{roots}]}}]"#);
        let hidden = nodes(r#"{"visible":false}"#);
        let note = "note: 1 nodes are hidden by KHR_node_visibility: they and what lies in them were left out";
        let head = "parts [\"head\"] [0, 0]";
        check(&[("nodes", &hidden), ("scenes", &scenes("0,1"))], &["@", "#", head, note]);
        for shown in ["{}", r#"{"visible":true}"#] {
            let both = told(&square(&[("nodes", &nodes(shown)), ("scenes", &scenes("0,1"))]));
            assert!(both.contains(r#"parts ["head", "lock"] [0, 0, 1, 1]"#), "{both}");
        }
        // A scene that hides all it has is not another scene, nor meshes without one.
        let none = "file: every node with triangles is hidden by KHR_node_visibility: show the head, or export it without";
        check(&[("nodes", &hidden), ("scenes", &scenes("1"))], &[none]);
    }

    #[test]
    fn strips_and_fans_become_triangles_and_lines_do_not() {
        let strip = r#"[{"primitives":[{"attributes":{"POSITION":0},"mode":5},
                         {"attributes":{"POSITION":0},"mode":6},{"mode":1,"attributes":{}}]}]"#;
        let note = "note: 1 primitives of lines and points were left out";
        let triangles = "[[0, 1, 2], [1, 3, 2], [1, 2, 0], [2, 3, 0]]";
        check(&[("meshes", strip)], &["@", triangles, note]);
        // 0 1 2 0 2 3: the third of its four triangles only leads on.
        let indexed = r#"[{"primitives":[{"attributes":{"POSITION":0},"mode":5,"indices":3}]}]"#;
        check(&[("meshes", indexed)], &["@", "[[0, 1, 2], [1, 0, 2], [0, 3, 2]]"]);
    }

    #[test]
    fn sparse_values_replace_those_they_name() {
        let accessors = r#"[{"componentType":5126,"type":"VEC3","count":3,"sparse":{"count":2,
              "indices":{"bufferView":1,"byteOffset":2,"componentType":5123},
              "values":{"bufferView":0,"byteOffset":20}}}]"#;
        let meshes = ("meshes", r#"[{"primitives":[{"attributes":{"POSITION":0}}]}]"#);
        let views = |length: u32| {
            format!(
                r#"[{{"buffer":0,"byteOffset":4,"byteLength":{length},"byteStride":24}},
                    {{"buffer":0,"byteOffset":96,"byteLength":12}}]"#
            )
        };
        // Elements 1 and 2 are the points after the first, from their x on.
        let ok = views(92);
        check(
            &[("accessors", accessors), meshes, ("bufferViews", &ok)],
            &["[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]", "[[0, 1, 2]]"],
        );
        let short = views(55);
        check(
            &[("accessors", accessors), meshes, ("bufferViews", &short)],
            &["accessors[0].sparse: 2 elements from byte 20 on do not fit into the 55 of \
               bufferViews[0]"],
        );
        let falling = accessors.replace("\"byteOffset\":2,", "\"byteOffset\":4,");
        check(
            &[("accessors", &falling), meshes, ("bufferViews", &ok)],
            &["accessors[0].sparse: its indices do not rise from 0 to 3 at 1"],
        );
    }

    #[test]
    fn an_accessor_past_its_bytes_is_refused_with_both_lengths() {
        let view = |json: &str| told(&square(&[("bufferViews", json)]));
        let over = r#"[{"buffer":0,"byteLength":96,"byteStride":32},{"buffer":0,"byteLength":12}]"#;
        let says =
            "accessors[0]: 4 elements from byte 0 on do not fit into the 96 of bufferViews[0]";
        assert_eq!(view(over), says);
        for (start, length, says) in [
            ("0", "109", "bufferViews[0]: 109 bytes from 0 on, where its buffer has 108"),
            (
                "8e15",
                "96",
                "bufferViews[0]: 96 bytes from 8000000000000000 on, where its buffer has 108",
            ),
            ("-1", "96", "bufferViews[0].byteOffset: -1 is no count"),
            ("0", "1.5", "bufferViews[0].byteLength: 1.5 is no count"),
        ] {
            let json =
                format!(r#"[{{"buffer":0,"byteOffset":{start},"byteLength":{length}}},{{}}]"#);
            assert_eq!(view(&json), says);
        }
        let accessor = |count: &str, stride: &str| {
            let accessors = format!(
                r#"[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{count}}}]"#
            );
            let views =
                format!(r#"[{{"buffer":0,"byteLength":96,"byteStride":{stride}}},{{"buffer":0}}]"#);
            let meshes = r#"[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
            told(&square(&[("accessors", &accessors), ("bufferViews", &views), ("meshes", meshes)]))
        };
        assert_eq!(
            accessor("3", "8"),
            "bufferViews[0]: byteStride 8, where an element has 12 bytes"
        );
        assert_eq!(accessor("3", "\"8\""), "bufferViews[0].byteStride: \"8\" is no count");
        assert_eq!(
            accessor("1e3", "9e15"),
            "accessors[0]: 1000 elements from byte 0 on do not fit into the 96 of bufferViews[0]"
        );
        assert_eq!(
            accessor("9e15", "12"),
            "nodes[0]: more than four thousand million vertices or triangles"
        );
        assert_eq!(
            accessor("4e9", "12"),
            "file: reading this takes 122070 MiB of memory, where a file of this size may take 64"
        );
    }

    #[test]
    fn a_reference_that_leads_nowhere_is_refused_with_both_ends() {
        for (key, json, says) in [
            ("scene", "7", "scene: it names scenes[7], where there are 1"),
            ("scenes", r#"[{"nodes":[4]}]"#, "scenes[0]: it names nodes[4], where there are 1"),
            ("scenes", r#"[{"nodes":["a"]}]"#, "scenes[0]: \"a\" is no index of a node"),
            ("nodes", r#"[{"mesh":1}]"#, "nodes[0]: it names meshes[1], where there are 1"),
            ("nodes", r#"[{"mesh":-1}]"#, "nodes[0].mesh: -1 is no index"),
            ("nodes", "[1]", "nodes[0]: 1 is no object"),
            ("nodes", "{}", "nodes: an object is no array"),
            (
                "nodes",
                r#"[{"children":[0]}]"#,
                "nodes[0]: it lies in two nodes, in itself or twice in a scene",
            ),
            ("nodes", r#"[{"scale":[1,2]}]"#, "nodes[0].scale: it does not have 3 numbers"),
            (
                "meshes",
                r#"[{"primitives":[{"attributes":{"POSITION":9}}]}]"#,
                "meshes[0].primitives[0]: it names accessors[9], where there are 4",
            ),
            (
                "meshes",
                r#"[{"primitives":[{"attributes":{"POSITION":0},"indices":3,"material":0}]}]"#,
                "meshes[0].primitives[0]: it names materials[0], where there are 0",
            ),
            (
                "meshes",
                r#"[{"primitives":[{"attributes":{"POSITION":1},"indices":3}]}]"#,
                "accessors[1]: its numbers are of no kind that positions come in",
            ),
            (
                "meshes",
                r#"[{"primitives":[{"mode":7}]}]"#,
                "meshes[0].primitives[0]: mode 7 does not exist",
            ),
            (
                "meshes",
                r#"[{"primitives":[{"attributes":{}}]}]"#,
                "file: no triangles in its 1 meshes",
            ),
            ("meshes", "", "nodes[0]: it names meshes[0], where there are 0"),
            ("buffers", "", "bufferViews[0]: it names buffers[0], where there are 0"),
            (
                "buffers",
                r#"[{"uri":"square.bin","byteLength":109}]"#,
                "buffers[0]: it should have 109 bytes and has 108",
            ),
            (
                "buffers",
                r#"[{"uri":"other.bin","byteLength":1}]"#,
                "buffers[0]: the file `other.bin` beside it is missing",
            ),
            (
                "buffers",
                r#"[{"uri":"http://x/y","byteLength":1}]"#,
                "buffers[0]: the uri `http://x/y` leads to another place than a file beside this one",
            ),
            (
                "buffers",
                r#"[{"byteLength":1}]"#,
                "buffers[0]: it has no bytes: neither a uri nor a binary chunk",
            ),
            ("asset", r#"{"version":"1.0"}"#, "asset.version: glTF 1.0, where only 2.0 is read"),
            ("asset", "", "asset.version: it is missing: this is not glTF 2.0"),
            (
                "extensionsRequired",
                r#"["KHR_materials_unlit","KHR_draco_mesh_compression"]"#,
                "extensionsRequired: KHR_draco_mesh_compression is not read: export the mesh without it",
            ),
        ] {
            assert_eq!(told(&square(&[(key, json)])), says);
        }
    }

    #[test]
    fn what_a_file_requires_for_its_pictures_or_as_an_avatar_hides_no_triangle() {
        let webp = r#"[{"extensions":{"EXT_texture_webp":{"source":0}}}]"#;
        let images = r#"[{"uri":"skin.webp","mimeType":"image/webp"}]"#;
        let materials =
            r#"[{"name":"skin","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}]"#;
        let meshes = r#"[{"primitives":[{"attributes":{"POSITION":0},"indices":3,"material":0}]}]"#;
        for required in [
            r#"["EXT_texture_webp"]"#,
            r#"["EXT_texture_avif","KHR_texture_basisu","KHR_texture_transform"]"#,
            r#"["VRMC_vrm","VRMC_materials_mtoon","VRMC_springBone","VRM"]"#,
        ] {
            let more = [
                ("extensionsRequired", required),
                ("textures", webp),
                ("images", images),
                ("materials", materials),
                ("meshes", meshes),
            ];
            check(&more, &["@", "#", "materials [\"skin\"] [0, 0]"]);
            let side = |name: &str| (name == "square.bin").then(|| Arc::from(numbers()));
            let json = square(&more);
            let mesh = crate::formats::read_mesh("vrm", json.as_bytes(), &side).unwrap();
            assert_eq!(mesh.triangles.len(), 2);
            let looks = crate::formats::read_looks("VRM", json.as_bytes(), &side).unwrap();
            assert!(looks.remarks[0].contains("(EXT_texture_webp): save it as PNG or JPEG"));
        }
    }

    #[test]
    fn an_index_past_the_vertices_is_refused_with_its_element() {
        let accessors = r#"[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3},{},{},
                            {"bufferView":1,"componentType":5123,"type":"SCALAR","count":6}]"#;
        let says = "accessors[3]: element 5 names vertex 3, where there are 3";
        assert_eq!(told(&square(&[("accessors", accessors)])), says);
    }

    #[test]
    fn side_files_are_buffers_and_not_pictures() {
        let json = r#"{"buffers":[{"uri":"b%20.bin"},{"uri":"data:,x"},{"uri":"../c"},{},
                       {"uri":"./a/a.bin"},{"uri":"a/a.bin"}],"images":[{"uri":"d.png"}]}"#;
        assert_eq!(side_files(json.as_bytes()), ["a/a.bin", "b .bin"]);
        assert!(side_files(b"not json").is_empty() && side_files(b"glTF").is_empty());
    }
}
