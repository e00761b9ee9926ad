//! A triangle mesh as a reader returns it: in the file's own units and axes, not yet interpreted.
//!
//! **Invariant:** every index in [`Mesh::triangles`] is below `points.len()`, every point is finite, and the
//!  per-triangle columns are as long as `triangles`. Readers establish this; [`Mesh::check`] tests it. Nothing else is
//!  promised: holes, several parts, non-manifold edges, degenerate triangles and missing UVs are all allowed.

use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// A triangle mesh in its file's units and axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices. Vertices that a file repeats at its seams are merged; parts that merely touch, as lashes do a lid,
    /// keep their own.
    pub points: Vec<Vec3>,
    /// Counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One UV per corner, or none at all.
    pub uvs: Option<Vec<[Vec2; 3]>>,
    /// Material names, in the order the file first uses them.
    pub materials: Vec<String>,
    /// Index into `materials` for each triangle; empty if the file names none.
    pub material_of: Vec<u32>,
    /// Names of objects, groups or nodes.
    pub parts: Vec<String>,
    /// Index into `parts` for each triangle; empty if there is a single unnamed part.
    pub part_of: Vec<u32>,
    /// Alternative names for each part: the mesh's own name if the part is named after its node, and those of the
    /// enclosing nodes, nearest first.
    pub also: Vec<Vec<String>>,
    /// Index into `also` for each triangle; empty if there are no such names.
    pub also_of: Vec<u32>,
    /// Painted values, 0 to 1, one per point (vertex colours as `name.r`, `.g`, `.b`).
    pub masks: BTreeMap<String, Vec<f32>>,
    /// Centimetres per unit if the format defines it (glTF: 100).
    pub cm_per_unit: Option<f32>,
    /// What the reader repaired or left out, one sentence each, for the node's messages.
    pub notes: Vec<String>,
}

/// Why a file is not a usable mesh. The text says where and why, without the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {reason}")]
pub struct MeshError {
    /// Line, byte offset, accessor or element, as precise as the reader knows it.
    pub place: String,
    /// What is wrong there and, if one sentence can say it, what to do.
    pub reason: String,
}

impl MeshError {
    /// An error at a position in the file.
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
            ("mesh", (!self.also_of.is_empty()).then_some(self.also_of.len())),
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

    /// Drops triangles, and points that no other triangle uses. Names stay, including unused ones.
    pub fn leave_out(&mut self, gone: &[bool]) {
        keep(&mut self.triangles, gone);
        self.uvs.iter_mut().for_each(|uvs| keep(uvs, gone));
        for of in [&mut self.material_of, &mut self.part_of, &mut self.also_of] {
            keep(of, gone);
        }
        let mut is_unused = vec![true; self.points.len()];
        self.triangles.iter().flatten().for_each(|v| is_unused[*v as usize] = false);
        let mut n = 0;
        let number = |unused: &bool| {
            n += u32::from(!unused);
            n.wrapping_sub(1)
        };
        let to: Vec<u32> = is_unused.iter().map(number).collect();
        self.triangles.iter_mut().flatten().for_each(|v| *v = to[*v as usize]);
        keep(&mut self.points, &is_unused);
        self.masks.values_mut().for_each(|mask| keep(mask, &is_unused));
    }
}

/// Keeps entries that are not gone; an empty column stays empty.
pub(crate) fn keep<T>(column: &mut Vec<T>, gone: &[bool]) {
    let mut gone = gone.iter();
    column.retain(|_| !gone.next().copied().unwrap_or(false));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_takes_its_points_along_and_leaves_the_rest_as_it_was() {
        let mut mesh = Mesh {
            points: (0..5).map(|x| Vec3::X * x as f32).collect(),
            triangles: vec![[0, 1, 2], [2, 3, 4], [2, 4, 1]],
            uvs: Some([0.0, 1.0, 2.0].map(|u| [Vec2::X * u; 3]).to_vec()),
            parts: vec!["a".to_owned(), "b".to_owned()],
            part_of: vec![0, 1, 1],
            masks: [("m".to_owned(), vec![0.0, 0.1, 0.2, 0.3, 0.4])].into(),
            ..Mesh::default()
        };
        mesh.leave_out(&[true, false, false]);
        // Only the first triangle used point 0.
        assert_eq!(mesh.points, [1.0, 2.0, 3.0, 4.0].map(|x| Vec3::X * x));
        assert_eq!(mesh.triangles, [[1, 2, 3], [1, 3, 0]]);
        assert_eq!(mesh.uvs.as_ref().map(|uvs| uvs[0][0].x), Some(1.0));
        assert_eq!((mesh.part_of.as_slice(), mesh.parts.len()), (&[1, 1][..], 2));
        assert_eq!(mesh.masks["m"], [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(mesh.check(), Ok(()));
    }
}
