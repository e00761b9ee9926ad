//! Which meshes a file shows, and where: nodes and their transforms.
//!
//! Source: glTF 2.0 specification, sections 3.5 and 3.7.3.3.

use super::affine::Affine;
use super::json::{Items, JsonValue};
use super::{Tables, index_or, name_of};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::NameTable;

/// How deep nodes may lie in nodes. Rigs reach a few dozen; a stack of this height is 140 kB.
pub(super) const MOST_DEPTH: usize = 1024;

/// So many nodes that a node lies in may name its mesh.
const MOST_ABOVE: usize = 4;

/// A mesh at its place.
#[derive(Debug)]
pub(super) struct Draw<'a> {
    pub(super) mesh: u32,
    /// By the nodes it lies in. What a skin holds is placed by the skin's joints instead.
    pub(super) world_from_mesh: Affine,
    /// Of the node, or else of the mesh, or else a number.
    pub(super) name: String,
    /// The name of the mesh, then those of the nearest nodes that the node lies in; empty where there is none.
    pub(super) also: Vec<String>,
    pub(super) skin: Option<u32>,
    /// How far the node turns its mesh into each morph target, where it says so itself.
    pub(super) weights: Option<JsonValue<'a>>,
    pub(super) instanced: bool,
    /// The node, for messages.
    pub(super) place: String,
}

/// What to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SceneSource {
    /// A scene of the file.
    Scene(u32),
    /// All nodes that lie in no other.
    Roots,
    /// All meshes, in no node at all.
    Meshes,
}

impl SceneSource {
    /// What the file means to show, then what may stand in for it.
    pub(super) fn of(
        tables: &Tables,
    ) -> Result<impl Iterator<Item = SceneSource> + use<>, MeshError> {
        let stated = index_or(tables.doc.root(), "scene", "file")?;
        let first = (tables.scenes.len() > 0).then_some(0);
        let scene = stated.or(first).map(SceneSource::Scene);
        Ok(scene.into_iter().chain([SceneSource::Roots, SceneSource::Meshes]))
    }

    pub(super) fn note(self) -> Option<&'static str> {
        match self {
            Self::Scene(_) => None,
            Self::Roots => Some("no scene shows a mesh: all nodes were read"),
            Self::Meshes => Some("no node shows a mesh: all meshes were read as they lie"),
        }
    }
}

/// Calls `draw` for each mesh, nodes before those that lie in them; returns how many nodes are hidden, with all that lies in them.
///
/// A node that lies in two others, or in itself, is refused.
pub(super) fn walk<'a>(
    tables: &Tables<'a>,
    plan: SceneSource,
    draw: &mut dyn FnMut(&Draw<'a>) -> Result<(), MeshError>,
) -> Result<usize, MeshError> {
    let mut walk = Walk::new(tables);
    match plan {
        SceneSource::Scene(scene) => {
            let place = format!("scenes[{scene}]");
            let scene = tables.scenes.item(scene, "scene")?;
            let Some(nodes) = scene.get("nodes") else { return Ok(0) };
            for node in nodes.items() {
                walk.tree(index(node, &place)?, &place, draw)?;
            }
        }
        SceneSource::Roots => {
            let mut is_root = vec![true; tables.nodes.len()];
            for node in 0..tables.nodes.len() {
                let children = tables.nodes.item(node as u32, "nodes")?.get("children");
                for child in
                    children.into_iter().flat_map(JsonValue::items).filter_map(JsonValue::whole)
                {
                    if let Some(is_root) = is_root.get_mut(child as usize) {
                        *is_root = false;
                    }
                }
            }
            for node in (0..is_root.len()).filter(|node| is_root[*node]) {
                walk.tree(node as u32, "nodes", draw)?;
            }
        }
        SceneSource::Meshes => {
            for number in 0..tables.meshes.len() as u32 {
                let place = format!("meshes[{number}]");
                let name = name_of(tables.meshes.item(number, &place)?);
                draw(&Draw {
                    mesh: number,
                    world_from_mesh: Affine::IDENTITY,
                    name: name.map_or_else(|| format!("mesh {number}"), NameTable::cut),
                    also: vec![],
                    skin: None,
                    weights: None,
                    instanced: false,
                    place,
                })?;
            }
        }
    }
    Ok(walk.hidden)
}

/// The number of a node, which something at `place` names.
pub(super) fn index(value: JsonValue, place: &str) -> Result<u32, MeshError> {
    let index = value.whole().and_then(|n| u32::try_from(n).ok());
    index.ok_or_else(|| MeshError::at(place, format!("{} is no index of a node", value.shown())))
}

struct Walk<'r, 'a> {
    tables: &'r Tables<'a>,
    seen: Vec<bool>,
    hidden: usize,
    /// The nodes we are in: their number, their children still to come and their transforms.
    stack: Vec<(u32, Items<'a>, Affine)>,
}

impl<'r, 'a> Walk<'r, 'a> {
    fn new(tables: &'r Tables<'a>) -> Self {
        Self { tables, seen: vec![false; tables.nodes.len()], hidden: 0, stack: Vec::new() }
    }

    fn tree(
        &mut self,
        root: u32,
        from: &str,
        draw: &mut dyn FnMut(&Draw<'a>) -> Result<(), MeshError>,
    ) -> Result<(), MeshError> {
        self.stack.clear();
        self.enter(root, from, Affine::IDENTITY, draw)?;
        while let Some((node, children, world)) = self.stack.last_mut() {
            self.tables.doc.tire(1)?;
            let Some(child) = children.next() else {
                self.stack.pop();
                continue;
            };
            let (world, place) = (*world, format!("nodes[{node}]"));
            self.enter(index(child, &place)?, &place, world, draw)?;
        }
        Ok(())
    }

    fn enter(
        &mut self,
        number: u32,
        from: &str,
        world_from_parent: Affine,
        draw: &mut dyn FnMut(&Draw<'a>) -> Result<(), MeshError>,
    ) -> Result<(), MeshError> {
        let node = self.tables.nodes.item(number, from)?;
        let place = format!("nodes[{number}]");
        if std::mem::replace(&mut self.seen[number as usize], true) {
            return Err(MeshError::at(
                place,
                "it lies in two nodes, in itself or twice in a scene",
            ));
        }
        if self.stack.len() >= MOST_DEPTH {
            return Err(MeshError::at(place, format!("it lies in more than {MOST_DEPTH} nodes")));
        }
        let extension = |name| node.get("extensions").and_then(|e| e.get(name));
        let visible = extension("KHR_node_visibility").and_then(|v| v.get("visible"));
        if visible.and_then(JsonValue::boolean) == Some(false) {
            self.hidden += 1;
            return Ok(());
        }
        let world = world_from_parent.times(&Affine::of_node(node, &place)?);
        if let Some(mesh) = index_or(node, "mesh", &place)? {
            let mesh_name = name_of(self.tables.meshes.item(mesh, &place)?);
            let name = name_of(node).or(mesh_name);
            let mut also = vec![mesh_name.map_or_else(String::new, NameTable::cut)];
            for (above, ..) in self.stack.iter().rev().take(MOST_ABOVE) {
                let name = name_of(self.tables.nodes.item(*above, &place)?);
                also.push(name.map_or_else(String::new, NameTable::cut));
            }
            draw(&Draw {
                mesh,
                world_from_mesh: world,
                name: name.map_or_else(|| format!("node {number}"), NameTable::cut),
                also,
                skin: index_or(node, "skin", &place)?,
                weights: node.get("weights"),
                instanced: extension("EXT_mesh_gpu_instancing").is_some(),
                place: place.clone(),
            })?;
        }
        if let Some(children) = node.get("children") {
            self.stack.push((number, children.items(), world));
        }
        Ok(())
    }
}
