//! The last step of every mesh reader: joins points at the same place and drops those unused.
//!
//! Places are compared exactly, by bits (with -0 as 0): no distance is ever chosen here, so nothing
//! that the file keeps apart is closed. Points keep the order of the file, a joined point stands
//! where its first copy stood and keeps the first copy's mask values.
//!
//! Only copies that a format or an exporter made at seams are to be joined. Lashes that touch a lid
//! at its very vertices are another matter: see [`Weld`].

use crate::data::mesh::{Mesh, MeshError};

/// Bytes this step allocates for each point and for each triangle it is given, at most.
pub(crate) const BYTES_PER_POINT: u64 = 12;
pub(crate) const BYTES_PER_TRIANGLE: u64 = 24;

/// Which points at the same place are one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weld {
    /// Those of the same part. For glTF, whose nodes are apart and whose seams within a node are
    /// always cut.
    InPart,
    /// All of them or none. For OBJ, which need not cut seams, though some exporters do: points are
    /// joined if that makes no edge of three triangles or more that was none before. The ICT head,
    /// whose lashes and tear line end on the vertices of the lids, stays as it is in the file.
    IfManifold,
}

/// What [`finish`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Finished {
    /// Points no triangle used.
    pub(crate) n_unused: usize,
    /// Points at the place of another that [`Weld::IfManifold`] left apart.
    pub(crate) n_kept_apart: usize,
}

/// Welds and tests a mesh. Triangles keep their order and number; some may lose their area.
pub(crate) fn finish(mesh: &mut Mesh, weld: Weld) -> Result<Finished, MeshError> {
    // Before anything is looked up by index.
    mesh.check()?;
    let Mesh { points, triangles, masks, part_of, .. } = mesh;
    for p in points.iter_mut() {
        // -0 + 0 = 0; every other number stays.
        *p += glam::Vec3::ZERO;
    }

    const UNUSED: u32 = u32::MAX;
    let mut to = vec![UNUSED; points.len()];
    let mut group_of = match weld {
        Weld::InPart if !part_of.is_empty() => vec![0; points.len()],
        _ => Vec::new(),
    };
    for (t, triangle) in triangles.iter().enumerate() {
        for v in triangle {
            to[*v as usize] = *v;
            if let Some(group) = group_of.get_mut(*v as usize) {
                *group = part_of[t];
            }
        }
    }
    // Sorting needs no hash that a file could be made to defeat.
    let n_used = to.iter().filter(|v| **v != UNUSED).count();
    let mut order = Vec::with_capacity(n_used);
    order.extend(to.iter().copied().filter(|v| *v != UNUSED));
    let place = |v: u32| {
        let group = group_of.get(v as usize).copied().unwrap_or(0);
        (points[v as usize].to_array().map(f32::to_bits), group)
    };
    order.sort_unstable_by_key(|v| (place(*v), *v));
    let mut n_joined = 0;
    for i in 1..order.len() {
        let (before, here) = (order[i - 1], order[i]);
        if place(before) == place(here) {
            to[here as usize] = to[before as usize];
            n_joined += 1;
        }
    }
    drop(order);

    let mut finished = Finished { n_unused: points.len() - n_used, n_kept_apart: 0 };
    if weld == Weld::IfManifold && n_joined > 0 {
        let apart = n_crowded_edges(triangles, |v| v);
        if n_crowded_edges(triangles, |v| to[v as usize]) > apart {
            finished.n_kept_apart = n_joined;
            for (v, first) in to.iter_mut().enumerate().filter(|(_, first)| **first != UNUSED) {
                *first = v as u32;
            }
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
    points.truncate(n);
    for mask in masks.values_mut() {
        mask.truncate(n);
    }
    for v in triangles.iter_mut().flatten() {
        *v = to[*v as usize];
    }
    mesh.check()?;
    Ok(finished)
}

/// Edges with three triangles or more, after `point` has renamed the points.
fn n_crowded_edges(triangles: &[[u32; 3]], point: impl Fn(u32) -> u32) -> usize {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for t in triangles {
        let [a, b, c] = t.map(&point);
        for (a, b) in [(a, b), (b, c), (c, a)] {
            if a != b {
                edges.push(u64::from(a.min(b)) << 32 | u64::from(a.max(b)));
            }
        }
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() > 2).count()
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
        let finished = finish(&mut mesh, Weld::IfManifold);
        assert_eq!(finished, Ok(Finished { n_unused: 1, n_kept_apart: 0 }));
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
        assert_eq!(finish(&mut mesh, Weld::InPart), Ok(Finished::default()));
        assert_eq!(mesh.points.len(), 3);
    }

    /// A strip of two triangles and a lash that ends on their common edge, as copies of its points.
    fn lid_and_lash() -> Mesh {
        let [a, b] = [Vec3::ZERO, Vec3::X];
        Mesh {
            points: vec![a, b, Vec3::Y, -Vec3::Y, a, b, Vec3::Z],
            triangles: vec![[0, 1, 2], [1, 0, 3], [4, 5, 6]],
            parts: vec!["lid".to_owned(), "lash".to_owned()],
            part_of: vec![0, 0, 1],
            ..Mesh::default()
        }
    }

    #[test]
    fn what_touches_at_an_edge_without_being_joined_there_stays_apart() {
        let mut mesh = lid_and_lash();
        let kept = Finished { n_unused: 0, n_kept_apart: 2 };
        assert_eq!(finish(&mut mesh, Weld::IfManifold), Ok(kept));
        assert_eq!(mesh, lid_and_lash());
        assert_eq!(finish(&mut mesh, Weld::InPart), Ok(Finished::default()));
        assert_eq!(mesh, lid_and_lash());
        mesh.part_of = vec![0; 3];
        assert_eq!(finish(&mut mesh, Weld::InPart), Ok(Finished::default()));
        assert_eq!(mesh.points.len(), 5);
    }
}
