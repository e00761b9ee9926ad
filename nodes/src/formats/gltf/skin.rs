//! Skins: where the joints of a skeleton hold the vertices that are bound to them.
//!
//! Source: glTF 2.0 specification, section 3.7.3. The matrix of a joint is the place of its node in
//! the world, as the file's nodes stand, times its inverse bind matrix; a vertex goes where the mean
//! of its joints' matrices takes it, by their weights. The node that shows the mesh moves nothing
//! then, and `skeleton` only names a root. Joints count wherever they lie, shown in the scene or not.
//!
//! **Guarantees:** sums run in doubles in the order of the file and are rounded once, to the
//! coordinate. Weights are scaled to a sum of 1; those below 0 count as 0; a vertex without any
//! follows its first joint. Of a joint that holds nothing, the inverse bind matrix may be broken.
//! **Not promised:** the bind pose. A file that was saved in a pose comes in that pose.

use super::accessor::{Accessor, AccessorValues, Component};
use super::affine::Affine;
use super::buffers::Buffers;
use super::json::JsonValue;
use super::primitive::Primitive;
use super::scene::{MOST_DEPTH, index};
use super::{Notes, Tables, index_or};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::limits::Budget;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Sets of four joints that a vertex may have. Programs write one or two.
const MOST_SETS: usize = 8;

/// How far from 1 the weights of a vertex may sum up before we tell: two sets, rounded to bytes.
const UNEVEN: f64 = 0.02;

/// Bytes that a joint costs at most, and a node whose place is known.
const BYTES_PER_JOINT: u64 = 128;
const BYTES_PER_PLACE: u64 = 200;

/// The skins of a file that were needed so far.
#[derive(Debug, Default)]
pub(super) struct Skins {
    read: BTreeMap<u32, Rc<GltfSkin>>,
    /// The node that each node lies in; empty before the first skin.
    parents: Vec<Parent>,
    worlds: BTreeMap<u32, Affine>,
}

#[derive(Clone, Copy, Debug)]
enum Parent {
    None,
    Node(u32),
    Several,
}

/// A skin, its joints at their places.
#[derive(Debug)]
pub(super) struct GltfSkin {
    number: u32,
    joints: Vec<Joint>,
}

#[derive(Debug)]
struct Joint {
    world_from_mesh: Affine,
    /// What is wrong with its inverse bind matrix.
    fault: Option<&'static str>,
}

impl Skins {
    /// A skin that something at `from` names.
    pub(super) fn find<'a>(
        &mut self,
        tables: &Tables<'a>,
        number: u32,
        from: &str,
        buffers: &mut Buffers<'a>,
        budget: &mut Budget,
    ) -> Result<Rc<GltfSkin>, MeshError> {
        if let Some(skin) = self.read.get(&number) {
            return Ok(skin.clone());
        }
        let place = format!("skins[{number}]");
        let json = tables.skins.item(number, from)?;
        let listed = || json.get("joints").into_iter().flat_map(JsonValue::items);
        let n = listed().count();
        if n == 0 {
            let reason = "there are none: export the mesh with its skeleton, or without a skin";
            return Err(MeshError::at(format!("{place}.joints"), reason));
        }
        budget.take(&place, BYTES_PER_JOINT * n as u64)?;
        self.find_parents(tables, budget)?;

        let binds_place = format!("{place}.inverseBindMatrices");
        let binds = match index_or(json, "inverseBindMatrices", &place)? {
            None => None,
            Some(accessor) => {
                let accessor = Accessor::find(tables, accessor, &binds_place)?;
                if accessor.width != 16 || accessor.component != Component::F32 {
                    let reason = format!("{} holds no 4 x 4 matrices of floats", accessor.place());
                    return Err(MeshError::at(binds_place, reason));
                }
                if accessor.count < n as u64 {
                    let have = accessor.count;
                    let reason = format!(
                        "{have} matrices, where there are {n} joints: export the skin again"
                    );
                    return Err(MeshError::at(binds_place, reason));
                }
                accessor.open(tables, buffers, budget)?;
                Some(accessor.numbers(tables, buffers)?)
            }
        };
        let mut joints = Vec::with_capacity(n);
        for (k, joint) in listed().enumerate() {
            let place = format!("{place}.joints[{k}]");
            let world = self.world(tables, index(joint, &place)?, &place, budget)?;
            let (bind, fault) = match &binds {
                None => (Affine::IDENTITY, None),
                Some(binds) => bind(&binds.vector(k as u64)),
            };
            joints.push(Joint { world_from_mesh: world.times(&bind), fault });
        }
        let skin = Rc::new(GltfSkin { number, joints });
        self.read.insert(number, skin.clone());
        Ok(skin)
    }

    fn find_parents(&mut self, tables: &Tables, budget: &mut Budget) -> Result<(), MeshError> {
        let n = tables.nodes.len();
        if self.parents.len() == n {
            return Ok(());
        }
        budget.take("nodes", (n * size_of::<Parent>()) as u64)?;
        self.parents = vec![Parent::None; n];
        for node in 0..n as u32 {
            tables.doc.tire(1)?;
            let children = tables.nodes.item(node, "nodes")?.get("children");
            for child in
                children.into_iter().flat_map(JsonValue::items).filter_map(JsonValue::whole)
            {
                if let Some(parent) = self.parents.get_mut(child as usize) {
                    *parent = match parent {
                        Parent::None => Parent::Node(node),
                        _ => Parent::Several,
                    };
                }
            }
        }
        Ok(())
    }

    /// The place of a node that something at `from` names.
    fn world(
        &mut self,
        tables: &Tables,
        node: u32,
        from: &str,
        budget: &mut Budget,
    ) -> Result<Affine, MeshError> {
        // Up to a node whose place is known, or out of all of them, and down again.
        let mut way: Vec<u32> = Vec::new();
        let (mut at, mut world) = (Some(node), Affine::IDENTITY);
        while let Some(node) = at {
            tables.doc.tire(1)?;
            if let Some(known) = self.worlds.get(&node) {
                world = *known;
                break;
            }
            if way.len() >= MOST_DEPTH {
                let reason = format!("it lies in itself or in more than {MOST_DEPTH} nodes");
                return Err(MeshError::at(format!("nodes[{}]", way[0]), reason));
            }
            tables.nodes.item(node, from)?;
            way.push(node);
            at = match self.parents.get(node as usize) {
                None | Some(Parent::None) => None,
                Some(Parent::Node(parent)) => Some(*parent),
                Some(Parent::Several) => {
                    let reason = "it lies in two nodes, or twice in one";
                    return Err(MeshError::at(format!("nodes[{node}]"), reason));
                }
            };
        }
        budget.take("nodes", BYTES_PER_PLACE * way.len() as u64)?;
        for node in way.into_iter().rev() {
            let place = format!("nodes[{node}]");
            world = world.times(&Affine::of_node(tables.nodes.item(node, from)?, &place)?);
            self.worlds.insert(node, world);
        }
        Ok(world)
    }
}

/// An inverse bind matrix, and what is wrong with it.
fn bind(m: &[f64; 16]) -> (Affine, Option<&'static str>) {
    let bind = Affine::of_columns(m);
    // Inverses that programs have worked out in floats are off by their last digits.
    let off = |value: f64, expected: f64| (value - expected).abs() > 1e-3;
    let fault = if !m.iter().all(|x| x.is_finite()) {
        Some("has a number that is not finite")
    } else if bind == Affine::ZERO {
        Some("is all zeros")
    } else if off(m[3], 0.0) || off(m[7], 0.0) || off(m[11], 0.0) || off(m[15], 1.0) {
        Some("does not end in the row 0, 0, 0, 1")
    } else {
        None
    };
    (bind, fault)
}

/// The accessors of a primitive's joints and weights, set by set; none where it has no such.
pub(super) fn sets<'a>(
    tables: &Tables<'a>,
    primitive: &Primitive<'a>,
) -> Result<Vec<[Accessor<'a>; 2]>, MeshError> {
    let place = &primitive.place;
    let mut sets = Vec::new();
    loop {
        let n = sets.len();
        let [joints, weights] = ["JOINTS", "WEIGHTS"].map(|name| format!("{name}_{n}"));
        let find = |name: &str| -> Result<Option<Accessor<'a>>, MeshError> {
            let number = index_or(primitive.attributes, name, place)?;
            number.map(|number| Accessor::find(tables, number, place)).transpose()
        };
        let (j, mut w) = match (find(&joints)?, find(&weights)?) {
            (None, None) => return Ok(sets),
            (Some(j), Some(w)) => (j, w),
            (Some(_), None) => {
                let reason = format!("it has {joints} without {weights}");
                return Err(MeshError::at(place, reason));
            }
            (None, Some(_)) => {
                let reason = format!("it has {weights} without {joints}");
                return Err(MeshError::at(place, reason));
            }
        };
        if n == MOST_SETS {
            let most = 4 * MOST_SETS;
            let reason = format!("its vertices have more than {most} joints: export fewer");
            return Err(MeshError::at(place, reason));
        }
        use Component::{F32, U8, U16};
        let fits = matches!(j.component, U8 | U16) && !j.normalized;
        primitive.fits(&j, "joints", fits && j.width == 4)?;
        primitive.fits(&w, "weights", matches!(w.component, F32 | U8 | U16) && w.width == 4)?;
        // Integers that are not said to be shares of 1 are so all the same: they cannot sum to 1.
        w.normalized = true;
        sets.push([j, w]);
    }
}

/// A primitive in its skin.
pub(super) struct Bound<'b> {
    pub(super) skin: Rc<GltfSkin>,
    /// Joints and weights, with the numbers of their accessors.
    pub(super) sets: Vec<[(u32, AccessorValues<'b>); 2]>,
}

impl Bound<'_> {
    /// What takes vertex `i` to its place.
    pub(super) fn matrix(&self, i: u64, notes: &mut Notes) -> Result<Affine, MeshError> {
        let (mut mean, mut sum, mut uneven) = (Affine::ZERO, 0.0, false);
        for [(accessor, joints), (weight_accessor, weights)] in &self.sets {
            let (joints, weights) = (joints.vector::<4>(i), weights.vector::<4>(i));
            for (joint, weight) in joints.into_iter().zip(weights) {
                if !weight.is_finite() {
                    let reason = format!("element {i} has a weight that is not a finite number");
                    return Err(MeshError::at(format!("accessors[{weight_accessor}]"), reason));
                }
                uneven |= weight < 0.0;
                if weight > 0.0 {
                    mean.add(&self.joint(*accessor, i, joint)?.map(|x| x * weight));
                    sum += weight;
                }
            }
        }
        if sum == 0.0
            && let [[(accessor, joints), _], ..] = &self.sets[..]
        {
            notes.weightless += 1;
            return self.joint(*accessor, i, joints.vector::<1>(i)[0]);
        }
        notes.uneven_weights += usize::from(uneven || (sum - 1.0).abs() > UNEVEN);
        Ok(mean.map(|x| x / sum))
    }

    /// The matrix of a joint, which element `i` of an accessor names.
    fn joint(&self, accessor: u32, i: u64, joint: f64) -> Result<Affine, MeshError> {
        let GltfSkin { number, joints } = &*self.skin;
        match joints.get(joint as usize) {
            None => {
                let n = joints.len();
                let reason = format!(
                    "element {i} names joint {joint}, where skins[{number}] has {n}: export the mesh \
                     with its whole skeleton"
                );
                Err(MeshError::at(format!("accessors[{accessor}]"), reason))
            }
            Some(Joint { fault: Some(fault), .. }) => {
                let reason = format!("matrix {joint} {fault}: export the skin again");
                Err(MeshError::at(format!("skins[{number}].inverseBindMatrices"), reason))
            }
            Some(joint) => Ok(joint.world_from_mesh),
        }
    }
}
