//! A triangle mesh as a reader hands it over: in the file's own units and axes, nothing judged yet.
//!
//! **Invariant:** every index in [`Mesh::triangles`] is below `points.len()`, every point is finite, and
//! the per-triangle columns are as long as `triangles`. Readers establish this, [`Mesh::check`]
//! tests it. Nothing else is promised: holes, several parts, non-manifold edges, triangles without
//! area and missing uvs are all allowed.

use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// A triangle mesh in its file's units and axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices. Those that a file repeats at its seams are one point; things that merely touch, as
    /// lashes do a lid, keep their own.
    pub points: Vec<Vec3>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One uv per corner, or none at all.
    pub uvs: Option<Vec<[Vec2; 3]>>,
    /// Material names, in the order the file first uses them.
    pub materials: Vec<String>,
    /// Index into `materials` for each triangle; empty when the file names none.
    pub material_of: Vec<u32>,
    /// Names of objects, groups or nodes.
    pub parts: Vec<String>,
    /// Index into `parts` for each triangle; empty when there is one nameless part.
    pub part_of: Vec<u32>,
    /// Painted values, 0 to 1, one for each point (vertex colours as `name.r`, `.g`, `.b`).
    pub masks: BTreeMap<String, Vec<f32>>,
    /// Centimetres per unit where the format states it (glTF: 100).
    pub cm_per_unit: Option<f32>,
    /// What the reader repaired or left out, one sentence each, for the messages of the node.
    pub notes: Vec<String>,
}

/// Why a file is no mesh that coif can use. The text says where and why, without the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {reason}")]
pub struct MeshError {
    /// Line, byte offset, accessor or element, as exact as the reader knows it.
    pub place: String,
    /// What is wrong there and, where one sentence can say it, what to do.
    pub reason: String,
}

impl MeshError {
    /// An error at a place.
    pub fn at(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { place: place.into(), reason: reason.into() }
    }
}

impl Mesh {
    /// Tests the invariant of the type; readers call it last.
    pub fn check(&self) -> Result<(), MeshError> {
        if let Some(i) = self.points.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::at(
                format!("vertex {i}"),
                "a coordinate is not a finite number",
            ));
        }
        let n = self.points.len() as u32;
        if let Some(i) = self.triangles.iter().position(|t| t.iter().any(|v| *v >= n)) {
            return Err(MeshError::at(
                format!("triangle {i}"),
                format!("it names a vertex past the last of {n}"),
            ));
        }
        let lengths = [
            ("uv", self.uvs.as_ref().map(Vec::len)),
            ("material", (!self.material_of.is_empty()).then_some(self.material_of.len())),
            ("part", (!self.part_of.is_empty()).then_some(self.part_of.len())),
        ];
        for (what, length) in lengths {
            if length.is_some_and(|length| length != self.triangles.len()) {
                return Err(MeshError::at(what, "there is not one for each triangle"));
            }
        }
        if let Some((name, _)) = self.masks.iter().find(|(_, m)| m.len() != self.points.len()) {
            return Err(MeshError::at(format!("mask {name}"), "there is not one value a vertex"));
        }
        Ok(())
    }
}
