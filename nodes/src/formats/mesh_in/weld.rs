//! The last step of every mesh reader: joins points at the same place and drops those unused.
//!
//! Places are compared exactly, by bits (with -0 as 0): no distance is ever chosen here, so nothing
//! that the file keeps apart is closed. Points keep the order of the file, a joined point stands
//! where its first copy stood and keeps the first copy's mask values.

use crate::data::mesh::{Mesh, MeshError};

/// Bytes this step allocates for each point it is given.
pub(crate) const BYTES_PER_POINT: u64 = 8;

/// Welds and tests a mesh. Triangles keep their order and number; some may lose their area.
///
/// Returns how many points no triangle used.
pub(crate) fn finish(mesh: &mut Mesh) -> Result<usize, MeshError> {
    // Before anything is looked up by index.
    mesh.check()?;
    let Mesh { points, triangles, masks, .. } = mesh;
    for p in points.iter_mut() {
        // -0 + 0 = 0; every other number stays.
        *p += glam::Vec3::ZERO;
    }

    const UNUSED: u32 = u32::MAX;
    let mut to = vec![UNUSED; points.len()];
    for v in triangles.iter().flatten() {
        to[*v as usize] = *v;
    }
    // Sorting needs no hash that a file could be made to defeat.
    let n_used = to.iter().filter(|v| **v != UNUSED).count();
    let mut order = Vec::with_capacity(n_used);
    order.extend(to.iter().copied().filter(|v| *v != UNUSED));
    let place = |v: u32| points[v as usize].to_array().map(f32::to_bits);
    order.sort_unstable_by_key(|v| (place(*v), *v));
    for pair in 1..order.len() {
        let (before, here) = (order[pair - 1], order[pair]);
        if place(before) == place(here) {
            to[here as usize] = to[before as usize];
        }
    }

    // A first copy comes before the others, so its new number is known when they ask for it.
    let mut n = 0;
    for v in 0..points.len() {
        let first = to[v];
        if first == UNUSED {
            continue;
        }
        if first as usize != v {
            to[v] = to[first as usize];
            continue;
        }
        points[n] = points[v];
        for mask in masks.values_mut() {
            mask[n] = mask[v];
        }
        to[v] = n as u32;
        n += 1;
    }
    let n_unused = points.len() - n_used;
    points.truncate(n);
    for mask in masks.values_mut() {
        mask.truncate(n);
    }
    for v in triangles.iter_mut().flatten() {
        *v = to[*v as usize];
    }
    mesh.check()?;
    Ok(n_unused)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn equal_places_become_one_point_and_unused_ones_go() {
        let x = Vec3::X;
        let mut mesh = Mesh {
            points: vec![Vec3::Y, Vec3::ZERO, x, -Vec3::ZERO, Vec3::Z, x],
            triangles: vec![[1, 2, 4], [3, 5, 4]],
            masks: [("m".to_owned(), vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5])].into(),
            ..Mesh::default()
        };
        assert_eq!(finish(&mut mesh), Ok(1));
        assert_eq!(mesh.points, [Vec3::ZERO, x, Vec3::Z]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 2]]);
        assert_eq!(mesh.masks["m"], [0.1, 0.2, 0.4]);
    }

    #[test]
    fn the_smallest_step_apart_stays_apart() {
        let next = Vec3::new(1.0 + f32::EPSILON, 0.0, 0.0);
        let mut mesh = Mesh {
            points: vec![Vec3::X, next, Vec3::Z],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        assert_eq!(finish(&mut mesh), Ok(0));
        assert_eq!(mesh.points.len(), 3);
    }
}
