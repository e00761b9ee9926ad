//! Which meshes a file shows, and where: nodes and their transforms.
//!
//! Source: glTF 2.0 specification, sections 3.5 and 3.7.3.3. Transforms are multiplied in doubles,
//! so an identity leaves every coordinate as it is in the file.

use super::json::{Items, Value};
use super::{Tables, index_or, name_of};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::Names;
use glam::Vec3;

/// How deep nodes may lie in nodes. Rigs reach a few dozen; a stack of this height is 140 kB.
const MOST_DEPTH: usize = 1024;

/// So many nodes that a node lies in may name its mesh.
const MOST_ABOVE: usize = 4;

/// A mesh at its place.
#[derive(Debug)]
pub(super) struct Draw {
    pub(super) mesh: u32,
    pub(super) world_from_mesh: Affine,
    /// Of the node, or else of the mesh, or else a number.
    pub(super) name: String,
    /// The name of the mesh, then those of the nearest nodes that the node lies in; empty where there is none.
    pub(super) also: Vec<String>,
    pub(super) skinned: bool,
    pub(super) instanced: bool,
    /// The node, for messages.
    pub(super) place: String,
}

/// What to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plan {
    /// A scene of the file.
    Scene(u32),
    /// All nodes that lie in no other.
    Roots,
    /// All meshes, in no node at all.
    Meshes,
}

impl Plan {
    /// What the file means to show, then what may stand in for it.
    pub(super) fn of(tables: &Tables) -> Result<impl Iterator<Item = Plan> + use<>, MeshError> {
        let stated = index_or(tables.doc.root(), "scene", "file")?;
        let first = (tables.scenes.len() > 0).then_some(0);
        let scene = stated.or(first).map(Plan::Scene);
        Ok(scene.into_iter().chain([Plan::Roots, Plan::Meshes]))
    }

    pub(super) fn note(self) -> Option<&'static str> {
        match self {
            Self::Scene(_) => None,
            Self::Roots => Some("no scene shows a mesh: all nodes were read"),
            Self::Meshes => Some("no node shows a mesh: all meshes were read as they lie"),
        }
    }
}

/// Calls `draw` for each mesh, nodes before those that lie in them.
///
/// A node that lies in two others, or in itself, is refused.
pub(super) fn walk(
    tables: &Tables,
    plan: Plan,
    draw: &mut dyn FnMut(&Draw) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    match plan {
        Plan::Scene(scene) => {
            let place = format!("scenes[{scene}]");
            let scene = tables.scenes.item(scene, "scene")?;
            let Some(nodes) = scene.get("nodes") else { return Ok(()) };
            let mut walk = Walk::new(tables);
            for node in nodes.items() {
                walk.tree(index(node, &place)?, &place, draw)?;
            }
        }
        Plan::Roots => {
            let mut is_root = vec![true; tables.nodes.len()];
            for node in 0..tables.nodes.len() {
                let children = tables.nodes.item(node as u32, "nodes")?.get("children");
                for child in children.into_iter().flat_map(Value::items).filter_map(Value::whole) {
                    if let Some(is_root) = is_root.get_mut(child as usize) {
                        *is_root = false;
                    }
                }
            }
            let mut walk = Walk::new(tables);
            for node in (0..is_root.len()).filter(|node| is_root[*node]) {
                walk.tree(node as u32, "nodes", draw)?;
            }
        }
        Plan::Meshes => {
            for number in 0..tables.meshes.len() as u32 {
                let place = format!("meshes[{number}]");
                let name = name_of(tables.meshes.item(number, &place)?);
                draw(&Draw {
                    mesh: number,
                    world_from_mesh: Affine::IDENTITY,
                    name: name.map_or_else(|| format!("mesh {number}"), Names::cut),
                    also: vec![],
                    skinned: false,
                    instanced: false,
                    place,
                })?;
            }
        }
    }
    Ok(())
}

fn index(value: Value, place: &str) -> Result<u32, MeshError> {
    let index = value.whole().and_then(|n| u32::try_from(n).ok());
    index.ok_or_else(|| MeshError::at(place, format!("{} is no index of a node", value.shown())))
}

struct Walk<'r, 'a> {
    tables: &'r Tables<'a>,
    seen: Vec<bool>,
    /// The nodes we are in: their number, their children still to come and their transforms.
    stack: Vec<(u32, Items<'a>, Affine)>,
}

impl<'r, 'a> Walk<'r, 'a> {
    fn new(tables: &'r Tables<'a>) -> Self {
        Self { tables, seen: vec![false; tables.nodes.len()], stack: Vec::new() }
    }

    fn tree(
        &mut self,
        root: u32,
        from: &str,
        draw: &mut dyn FnMut(&Draw) -> Result<(), MeshError>,
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
        draw: &mut dyn FnMut(&Draw) -> Result<(), MeshError>,
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
        if visible.and_then(Value::boolean) == Some(false) {
            return Ok(());
        }
        let world = world_from_parent.times(&Affine::of_node(node, &place)?);
        if let Some(mesh) = index_or(node, "mesh", &place)? {
            let mesh_name = name_of(self.tables.meshes.item(mesh, &place)?);
            let name = name_of(node).or(mesh_name);
            let mut also = vec![mesh_name.map_or_else(String::new, Names::cut)];
            for (above, ..) in self.stack.iter().rev().take(MOST_ABOVE) {
                let name = name_of(self.tables.nodes.item(*above, &place)?);
                also.push(name.map_or_else(String::new, Names::cut));
            }
            // The joints of a skin place it, so its node does not.
            let skinned = node.get("skin").is_some();
            draw(&Draw {
                mesh,
                world_from_mesh: if skinned { Affine::IDENTITY } else { world },
                name: name.map_or_else(|| format!("node {number}"), Names::cut),
                also,
                skinned,
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

/// A transform: where the axes and the origin go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Affine {
    pub(super) const IDENTITY: Self =
        Self { axes: [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]], origin: [0.; 3] };

    /// The transform of a node from its `matrix` or its translation, rotation and scale.
    fn of_node(node: Value, place: &str) -> Result<Self, MeshError> {
        if let Some(m) = numbers::<16>(node, "matrix", place)? {
            let column = |c: usize| [m[4 * c], m[4 * c + 1], m[4 * c + 2]];
            return Ok(Self { axes: [column(0), column(1), column(2)], origin: column(3) });
        }
        let origin = numbers(node, "translation", place)?.unwrap_or([0.; 3]);
        let scale = numbers(node, "scale", place)?.unwrap_or([1.; 3]);
        let mut axes = match numbers(node, "rotation", place)? {
            Some(rotation) => rotate(rotation),
            None => Self::IDENTITY.axes,
        };
        for (axis, scale) in axes.iter_mut().zip(scale) {
            *axis = axis.map(|x| x * scale);
        }
        Ok(Self { axes, origin })
    }

    fn turn(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.axes;
        [0, 1, 2].map(|i| x[i] * v[0] + y[i] * v[1] + z[i] * v[2])
    }

    fn place(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(p);
        [0, 1, 2].map(|i| turned[i] + self.origin[i])
    }

    fn times(&self, inner: &Self) -> Self {
        Self { axes: inner.axes.map(|axis| self.turn(axis)), origin: self.place(inner.origin) }
    }

    pub(super) fn point(&self, p: Vec3) -> Vec3 {
        Vec3::from_array(self.place(p.to_array().map(f64::from)).map(|x| x as f32))
    }

    /// Whether it turns triangles over.
    pub(super) fn mirrors(&self) -> bool {
        let [x, y, z] = self.axes;
        let across = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            x[j] * y[k] - x[k] * y[j]
        });
        across[0] * z[0] + across[1] * z[1] + across[2] * z[2] < 0.0
    }
}

/// The axes after a rotation by a quaternion x, y, z, w of any length but 0.
fn rotate([x, y, z, w]: [f64; 4]) -> [[f64; 3]; 3] {
    let length_squared = x * x + y * y + z * z + w * w;
    if length_squared == 0.0 {
        return Affine::IDENTITY.axes;
    }
    let s = 2.0 / length_squared;
    [
        [1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)],
        [s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)],
        [s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)],
    ]
}

fn numbers<const N: usize>(
    node: Value,
    key: &str,
    place: &str,
) -> Result<Option<[f64; N]>, MeshError> {
    let Some(array) = node.get(key) else { return Ok(None) };
    let mut numbers = [0.0; N];
    let mut items = array.items();
    for number in &mut numbers {
        let item = items.next().and_then(Value::number);
        *number = item.ok_or_else(|| {
            MeshError::at(format!("{place}.{key}"), format!("it does not have {N} numbers"))
        })?;
    }
    Ok(Some(numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_turn_as_the_right_hand_does() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let axes = rotate([0.0, 0.0, half, half]);
        for (axis, expected) in axes.iter().zip([[0., 1., 0.], [-1., 0., 0.], [0., 0., 1.]]) {
            for i in 0..3 {
                assert!((axis[i] - expected[i]).abs() < 1e-15, "{axes:?}");
            }
        }
        assert_eq!(rotate([0.0; 4]), Affine::IDENTITY.axes);
        // A quaternion that is not quite of length 1 does not scale.
        let axes = rotate([0.0, 3.0, 0.0, 0.0]);
        assert_eq!(axes, [[-1., 0., 0.], [0., 1., 0.], [0., 0., -1.]]);
    }

    #[test]
    fn a_mirror_is_known_by_its_sign() {
        let flip = Affine { axes: [[-1., 0., 0.], [0., 1., 0.], [0., 0., 1.]], ..Affine::IDENTITY };
        assert!(flip.mirrors() && !flip.times(&flip).mirrors() && !Affine::IDENTITY.mirrors());
    }

    #[test]
    fn an_identity_changes_no_bit() {
        let p = Vec3::new(0.1, -3.000_000_2, 1e30);
        assert_eq!(Affine::IDENTITY.times(&Affine::IDENTITY).point(p), p);
    }
}
