//! Normals of a triangle mesh: of its vertices and its edges.
//!
//! Guarantees: faces without area count for nothing. Sums are in the order of the triangles. Triangles must refer to points that exist.

use glam::Vec3;

/// Normals of vertices and edges, and how much of the mesh is open.
pub(super) struct MeshNormals {
    /// Of each vertex: face normals weighted by their angle there. Unit; zero if no face has area.
    pub(super) vertices: Vec<Vec3>,
    /// Of the three edges of each triangle, from corner `i` to `i + 1`: the sum of the face normals along it.
    pub(super) edges: Vec<[Vec3; 3]>,
    /// Number of boundary vertices.
    pub(super) ends: usize,
}

impl MeshNormals {
    /// The normals of triangles, whose corners run counter-clockwise as seen from outside.
    pub(super) fn of(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let corners = |t: &[u32; 3]| t.map(|v| points[v as usize]);
        let mut vertices = vec![Vec3::ZERO; points.len()];
        let mut faces = Vec::with_capacity(triangles.len());
        for t in triangles {
            let [a, b, c] = corners(t);
            let normal = (b - a).cross(c - a).try_normalize();
            faces.push(normal.unwrap_or_default());
            let Some(normal) = normal else { continue };
            for (i, (at, next, last)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
                let angle = super::transcendental::acos(
                    (next - at).normalize_or_zero().dot((last - at).normalize_or_zero()),
                );
                vertices[t[i] as usize] += normal * angle;
            }
        }
        for normal in &mut vertices {
            *normal = normal.normalize_or_zero();
        }
        let mut edges = vec![[Vec3::ZERO; 3]; triangles.len()];
        let mut ends = vec![false; points.len()];
        each_edge(points.len(), triangles, |(a, b), same| {
            let sum = same.iter().fold(Vec3::ZERO, |sum, (_, n)| sum + faces[*n as usize / 3]);
            if let [_] = same {
                (ends[a as usize], ends[b as usize]) = (true, true);
            }
            for (_, n) in same {
                edges[*n as usize / 3][*n as usize % 3] = sum;
            }
        });
        Self { vertices, edges, ends: ends.into_iter().filter(|is| *is).count() }
    }
}

/// Calls a function for each edge and the sides of triangles along it: with its second vertex, and their indices among all sides,
/// ascending.
fn each_edge(
    points: usize,
    triangles: &[[u32; 3]],
    mut tell: impl FnMut((u32, u32), &[(u32, u32)]),
) {
    let sides = || {
        (0u32..).zip(triangles).flat_map(|(n, t)| {
            [0, 1, 2].map(|i| {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                (a.min(b), a.max(b), 3 * n + i as u32)
            })
        })
    };
    // Counting sort by first vertex, at a fraction of the cost of a full sort.
    let mut ends = vec![0u32; points + 1];
    sides().for_each(|(a, ..)| ends[a as usize + 1] += 1);
    for a in 1..ends.len() {
        ends[a] += ends[a - 1];
    }
    let mut by_first = vec![(0, 0); 3 * triangles.len()];
    for (a, b, n) in sides() {
        let end = &mut ends[a as usize];
        by_first[*end as usize] = (b, n);
        *end += 1;
    }
    let mut start = 0;
    for (a, end) in (0u32..).zip(&ends[..points]) {
        let of_vertex = &mut by_first[start..*end as usize];
        start = *end as usize;
        of_vertex.sort_unstable();
        of_vertex.chunk_by(|x, y| x.0 == y.0).for_each(|same| tell((a, same[0].0), same));
    }
}
