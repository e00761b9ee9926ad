//! Primitives: the pieces of a mesh, as triangles of points at their place. Morph targets move a
//! point first, then its skin or its node takes it there.
//!
//! Source: glTF 2.0 specification, sections 3.7.2 and 5.24.

use super::accessor::{Accessor, AccessorValues, Component};
use super::json::JsonValue;
use super::scene::Draw;
use super::skin::Bound;
use super::{Reader, Tables, index_or, name_of, unread_extension, whole_or};
use super::{morph, skin};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::limits::Budget;
use glam::Vec2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// A primitive, by what we can do with it.
#[expect(clippy::large_enum_variant, reason = "one at a time, on the stack")]
#[derive(Debug)]
pub(super) enum PrimitiveKind<'a> {
    Triangles(Primitive<'a>),
    /// Lines or points.
    Other,
    NoPosition,
}

/// A primitive of triangles whose accessors fit together; no byte of them is read yet.
#[derive(Debug)]
pub(super) struct Primitive<'a> {
    mode: Mode,
    position: Accessor<'a>,
    indices: Option<Accessor<'a>>,
    pub(super) uv: Option<Accessor<'a>>,
    pub(super) colour: Option<Accessor<'a>>,
    /// Number and name.
    pub(super) material: Option<(u32, Option<&'a str>)>,
    pub(super) attributes: JsonValue<'a>,
    pub(super) targets: Option<JsonValue<'a>>,
    /// For messages.
    pub(super) place: String,
}

impl<'a> Primitive<'a> {
    pub(super) fn all<'t>(
        tables: &'t Tables<'a>,
        mesh: u32,
    ) -> Result<impl Iterator<Item = Result<PrimitiveKind<'a>, MeshError>> + use<'a, 't>, MeshError>
    {
        let json = tables.meshes.item(mesh, "nodes")?;
        let primitives = json.get("primitives").into_iter().flat_map(JsonValue::items);
        Ok(primitives.enumerate().map(move |(i, primitive)| {
            let place = format!("meshes[{mesh}].primitives[{i}]");
            Self::read(tables, primitive, &place)
        }))
    }

    fn read(
        tables: &Tables<'a>,
        json: JsonValue<'a>,
        place: &str,
    ) -> Result<PrimitiveKind<'a>, MeshError> {
        let mode = match whole_or(json, "mode", Some(4), place)? {
            0..=3 => return Ok(PrimitiveKind::Other),
            4 => Mode::Triangles,
            5 => Mode::Strip,
            6 => Mode::Fan,
            mode => return Err(MeshError::at(place, format!("mode {mode} does not exist"))),
        };
        let Some(attributes) = json.get("attributes") else { return Ok(PrimitiveKind::NoPosition) };
        let attribute = |key: &str| -> Result<Option<Accessor<'a>>, MeshError> {
            match index_or(attributes, key, place)? {
                None => Ok(None),
                Some(number) => Ok(Some(Accessor::find(tables, number, place)?)),
            }
        };
        let Some(position) = attribute("POSITION")? else { return Ok(PrimitiveKind::NoPosition) };
        let compressed = json.get("extensions").and_then(|e| e.get("KHR_draco_mesh_compression"));
        if compressed.is_some() && !position.has_view() {
            return Err(unread_extension(place, "KHR_draco_mesh_compression"));
        }
        let uv = attribute(&format!("TEXCOORD_{}", tables.take.uv_set))?;
        let colour = attribute("COLOR_0")?;
        let indices = match index_or(json, "indices", place)? {
            None => None,
            Some(number) => Some(Accessor::find(tables, number, place)?),
        };

        use Component::{F32, U8, U16, U32};
        fits(&position, "positions", position.width == 3 && position.component != U32)?;
        if let Some(uv) = &uv {
            fits(uv, "uvs", uv.width == 2 && uv.component != U32)?;
        }
        if let Some(c) = &colour {
            let scaled = c.component == F32 || (c.normalized && matches!(c.component, U8 | U16));
            fits(c, "colours", scaled && matches!(c.width, 3 | 4))?;
        }
        if let Some(i) = &indices {
            let whole = matches!(i.component, U8 | U16 | U32) && !i.normalized;
            fits(i, "indices", whole && i.width == 1)?;
        }
        for other in [&uv, &colour].into_iter().flatten() {
            one_each(other, &position)?;
        }
        let material = match index_or(json, "material", place)? {
            None => None,
            Some(number) => Some((number, name_of(tables.materials.item(number, place)?))),
        };
        let (targets, place) = (json.get("targets"), place.to_owned());
        Ok(PrimitiveKind::Triangles(Self {
            mode,
            position,
            indices,
            uv,
            colour,
            material,
            attributes,
            targets,
            place,
        }))
    }

    /// Tests an accessor that has an element for each position.
    pub(super) fn fits(&self, a: &Accessor, what: &str, is: bool) -> Result<(), MeshError> {
        fits(a, what, is)?;
        one_each(a, &self.position)
    }

    fn n_corners(&self) -> u64 {
        self.indices.as_ref().map_or(self.position.count, |i| i.count)
    }

    /// Triangles, at most: strips leave out those that only lead on to the next.
    pub(super) fn n_triangles(&self) -> u64 {
        match self.mode {
            Mode::Triangles => self.n_corners() / 3,
            Mode::Strip | Mode::Fan => self.n_corners().saturating_sub(2),
        }
    }

    /// Points before welding.
    pub(super) fn n_points(&self) -> u64 {
        if self.is_point_per_corner() { self.n_corners() } else { self.position.count }
    }

    /// Many primitives may share one long list of positions and use a few of them each: then a
    /// point for each corner is less than all of the list.
    fn is_point_per_corner(&self) -> bool {
        self.n_corners() < self.position.count
    }

    pub(super) fn left_over(&self) -> u64 {
        match (self.mode, self.n_corners()) {
            (Mode::Triangles, n) => n % 3,
            (_, n) if n < 3 => n,
            _ => 0,
        }
    }
}

fn fits(a: &Accessor, what: &str, fits: bool) -> Result<(), MeshError> {
    if !fits {
        let reason = format!("its numbers are of no kind that {what} come in");
        return Err(MeshError::at(a.place(), reason));
    }
    Ok(())
}

fn one_each(a: &Accessor, position: &Accessor) -> Result<(), MeshError> {
    if a.count != position.count {
        let (n, positions) = (a.count, position.count);
        let reason = format!("{n} elements, where there are {positions} positions");
        return Err(MeshError::at(a.place(), reason));
    }
    Ok(())
}

/// The corners of triangle `t`, in the order of section 3.7.2.1.
fn corners(mode: Mode, t: u64) -> [u64; 3] {
    match mode {
        Mode::Triangles => [3 * t, 3 * t + 1, 3 * t + 2],
        Mode::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
        Mode::Fan => [t + 1, t + 2, 0],
    }
}

struct Opened<'b> {
    position: AccessorValues<'b>,
    indices: Option<AccessorValues<'b>>,
    uv: Option<AccessorValues<'b>>,
    colour: Option<AccessorValues<'b>>,
    targets: Vec<(f64, AccessorValues<'b>)>,
    bound: Option<Bound<'b>>,
}

impl<'a> Reader<'_, 'a> {
    /// Adds the points, triangles, uvs and colours of a primitive.
    pub(super) fn add_primitive(
        &mut self,
        draw: &Draw<'a>,
        primitive: &Primitive<'a>,
        budget: &mut Budget,
    ) -> Result<(), MeshError> {
        let tables = self.tables;
        let Primitive { position, indices, uv, colour, place, .. } = primitive;
        let targets = morph::targets(tables, draw, primitive, &mut self.notes, budget)?;
        let sets = draw.skin.map_or(Ok(Vec::new()), |_| skin::sets(tables, primitive))?;
        let skin = match draw.skin {
            Some(skin) if !sets.is_empty() => {
                self.notes.skinned += 1;
                Some(self.skins.find(tables, skin, &draw.place, &mut self.buffers, budget)?)
            }
            Some(_) => {
                self.notes.unbound += 1;
                None
            }
            None => None,
        };
        // A few bytes can ask for all of a long list of vertices many times over.
        let moving = || targets.iter().map(|(_, a)| a).chain(sets.iter().flatten());
        let steps = moving().map(Accessor::steps).fold(0, u64::saturating_add);
        tables.doc.tire(steps.saturating_mul(primitive.n_points())).map_err(|_| {
            let reason = "its morph targets and joints move too many vertices in all: export the \
                          mesh with them applied";
            MeshError::at(place, reason)
        })?;
        let others = [indices, uv, colour].into_iter().flatten();
        for accessor in std::iter::once(position).chain(others).chain(moving()) {
            accessor.open(tables, &mut self.buffers, budget)?;
        }
        let numbers = |a: &Accessor<'a>| a.numbers(tables, &self.buffers);
        let pair = |a: &Accessor<'a>| Ok((a.number, numbers(a)?));
        let opened = Opened {
            position: numbers(position)?,
            indices: indices.as_ref().map(numbers).transpose()?,
            uv: uv.as_ref().map(numbers).transpose()?,
            colour: colour.as_ref().map(numbers).transpose()?,
            targets: targets
                .iter()
                .map(|(weight, a)| Ok((*weight, numbers(a)?)))
                .collect::<Result<_, MeshError>>()?,
            bound: match skin {
                None => None,
                Some(skin) => {
                    let sets = sets.iter().map(|[j, w]| Ok([pair(j)?, pair(w)?]));
                    Some(Bound { skin, sets: sets.collect::<Result<_, MeshError>>()? })
                }
            },
        };
        // Which element of the attributes a corner uses.
        let element = |corner: u64| -> Result<u64, MeshError> {
            let (Some(accessor), Some(numbers)) = (indices, &opened.indices) else {
                return Ok(corner);
            };
            let element = u64::from(numbers.whole(corner));
            if element >= position.count {
                let n = position.count;
                let reason =
                    format!("element {corner} names vertex {element}, where there are {n}");
                return Err(MeshError::at(accessor.place(), reason));
            }
            Ok(element)
        };

        let mesh = &mut self.mesh;
        let first_point = mesh.points.len() as u64;
        let per_corner = primitive.is_point_per_corner();
        // Of what a skin holds: whether the triangles about each point are.
        let mut turned_over = Vec::new();
        if opened.bound.is_some() {
            budget.take(place, primitive.n_points())?;
            turned_over.reserve_exact(primitive.n_points() as usize);
        }
        for i in 0..primitive.n_points() {
            let i = if per_corner { element(i)? } else { i };
            let mut at: [f64; 3] = opened.position.vector(i);
            for (weight, target) in &opened.targets {
                let to: [f64; 3] = target.vector(i);
                at.iter_mut().zip(to).for_each(|(x, to)| *x += weight * to);
            }
            let world_from_mesh = match &opened.bound {
                None => draw.world_from_mesh,
                Some(bound) => {
                    let world_from_mesh = bound.matrix(i, &mut self.notes)?;
                    turned_over.push(world_from_mesh.mirrors());
                    world_from_mesh
                }
            };
            let placed = world_from_mesh.point(at);
            if !placed.is_finite() {
                let (place, at) = (position.place(), &draw.place);
                let skin = draw.skin.map_or_else(String::new, |skin| format!(" by skins[{skin}]"));
                let reason = format!("element {i} is not at a finite place in {at}{skin}");
                return Err(MeshError::at(place, reason));
            }
            mesh.points.push(placed);
            if self.colours[0].capacity() > 0 {
                // White where there is none, as the specification says.
                let colour: [f64; 3] = opened.colour.as_ref().map_or([1.0; 3], |c| c.vector(i));
                for (channel, value) in self.colours.iter_mut().zip(colour.map(|x| x as f32)) {
                    channel.push(if value.is_nan() { 1.0 } else { value.clamp(0.0, 1.0) });
                }
            }
        }

        let mirrored = opened.bound.is_none() && draw.world_from_mesh.mirrors();
        let mut uv_at = |element: u64| -> Vec2 {
            let Some(uv) = &opened.uv else { return Vec2::ZERO };
            let [u, v] = uv.vector(element).map(|x| x as f32);
            if !u.is_finite() || !v.is_finite() {
                self.notes.uv_not_finite += 1;
                return Vec2::ZERO;
            }
            Vec2::new(u, 1.0 - v)
        };
        for t in 0..primitive.n_triangles() {
            let corners = corners(primitive.mode, t);
            let mut elements = [0; 3];
            for (element_of, corner) in elements.iter_mut().zip(corners) {
                *element_of = element(corner)?;
            }
            let [a, b, c] = elements;
            if primitive.mode == Mode::Strip && (a == b || b == c || c == a) {
                continue;
            }
            let mut points = if per_corner { corners } else { elements };
            let over = |p: &&u64| turned_over.get(**p as usize) == Some(&true);
            if mirrored || points.iter().filter(over).count() >= 2 {
                points.swap(1, 2);
                elements.swap(1, 2);
            }
            mesh.triangles.push(points.map(|p| (first_point + p) as u32));
            if self.uvs.capacity() > 0 {
                self.uvs.push(elements.map(&mut uv_at));
            }
        }
        Ok(())
    }
}
