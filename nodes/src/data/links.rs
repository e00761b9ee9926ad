//! Connectivity of a surface's triangles: neighbours across sides, connected pieces, and a spanning tree over each
//! piece. The tree classifies vertices by the side of a line in one pass over the vertices.
//!
//! Guarantees: the same triangles give the same result. Surfaces need not be closed, and edges may have more than two
//! triangles.

use crate::maths::closest::Surface;
use std::collections::BTreeSet;

/// No triangle; no vertex.
pub(super) const NONE: u32 = u32::MAX;

/// Connectivity of a surface's triangles, to be stored beside the surface.
#[derive(Debug)]
pub(crate) struct Links {
    /// The triangle across the side from each corner to the next, or [`NONE`].
    pub(super) beside: Vec<[u32; 3]>,
    /// A number for each vertex, the same for all vertices of a connected piece.
    pub(super) pieces: Vec<u32>,
    /// A spanning tree over each piece: for each vertex its parent, or [`NONE`].
    above: Vec<u32>,
    /// Position of each vertex in an order in which all its descendants follow it, and where they end.
    stands: Vec<[u32; 2]>,
    /// Twice the area of each triangle, cm2.
    pub(super) twice: Vec<f32>,
}

impl Links {
    pub(crate) fn new(surface: &Surface) -> Self {
        let mut sides: Vec<((u32, u32), u32)> = vec![];
        for (t, corners) in (0u32..).zip(&surface.triangles) {
            if !surface.is_gone(t) {
                sides.extend((0..3).map(|k| (edge(corners, k), 3 * t + k as u32)));
            }
        }
        sides.sort_unstable();
        let mut beside = vec![[NONE; 3]; surface.triangles.len()];
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            for pair in same.chunks_exact(2) {
                for [a, b] in [[pair[0].1, pair[1].1], [pair[1].1, pair[0].1]] {
                    beside[a as usize / 3][a as usize % 3] = b / 3;
                }
            }
        }
        let mut joined = UnionFind::new(surface.points.len());
        let mut tree = vec![];
        for (t, corners) in (0u32..).zip(&surface.triangles) {
            if !surface.is_gone(t) {
                let edges = (0..3).map(|k| edge(corners, k));
                tree.extend(edges.filter(|edge| joined.join(*edge)));
            }
        }
        let pieces: Vec<u32> = (0..surface.points.len() as u32).map(|v| joined.root(v)).collect();
        let (above, stands) = hung(&pieces, &tree);
        let triangles = 0..surface.triangles.len() as u32;
        let twice = triangles.map(|t| surface.area_vector(t).length()).collect();
        Self { beside, pieces, above, stands, twice }
    }

    /// For each vertex, whether it is on the other side than the first vertex of its piece when these edges are
    /// crossed: crossed tree edges flip all descendants.
    pub(super) fn sides(&self, odd: &BTreeSet<(u32, u32)>) -> Vec<bool> {
        let hangs = |(a, b): (u32, u32)| match (self.above[a as usize], self.above[b as usize]) {
            (on, _) if on == b => Some(a),
            (_, on) if on == a => Some(b),
            _ => None,
        };
        let turning = odd.iter().filter_map(|edge| hangs(*edge));
        let mut turns: Vec<u32> = turning.flat_map(|v| self.stands[v as usize]).collect();
        turns.sort_unstable();
        let side = |[at, _]: &[u32; 2]| turns.partition_point(|turn| turn <= at) % 2 == 1;
        self.stands.iter().map(side).collect()
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        16 * self.beside.len() + 16 * self.pieces.len()
    }
}

/// The parent of each vertex in a spanning tree of each piece, rooted at the vertex that the piece is numbered by; and
/// the positions of the vertices.
fn hung(pieces: &[u32], tree: &[(u32, u32)]) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut ends: Vec<(u32, u32)> = tree.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]).collect();
    ends.sort_unstable();
    let mut above = vec![NONE; pieces.len()];
    let mut stands = vec![[0; 2]; pieces.len()];
    let mut next = 0;
    let mut todo = vec![];
    for root in (0u32..).zip(pieces).filter(|(v, piece)| v == *piece).map(|(v, _)| v) {
        todo.push((root, false));
        while let Some((v, is_done)) = todo.pop() {
            if is_done {
                stands[v as usize][1] = next;
                continue;
            }
            stands[v as usize][0] = next;
            next += 1;
            todo.push((v, true));
            let from = ends.partition_point(|(end, _)| *end < v);
            for (_, other) in ends[from..].iter().take_while(|(end, _)| *end == v) {
                if *other != above[v as usize] {
                    above[*other as usize] = v;
                    todo.push((*other, false));
                }
            }
        }
    }
    (above, stands)
}

/// A union-find structure over vertices.
pub(super) struct UnionFind(Vec<u32>);

impl UnionFind {
    pub(super) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }
    /// The representative of a vertex's set.
    pub(super) fn root(&mut self, v: u32) -> u32 {
        let mut root = v;
        while self.0[root as usize] != root {
            root = self.0[root as usize];
        }
        // Path compression for later queries.
        let mut at = v;
        while at != root {
            at = std::mem::replace(&mut self.0[at as usize], root);
        }
        root
    }
    /// Joins two vertices; returns whether they were separate.
    pub(super) fn join(&mut self, (a, b): (u32, u32)) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}

/// The edge from a corner of a triangle to the next.
pub(super) fn edge(corners: &[u32; 3], k: usize) -> (u32, u32) {
    let (a, b) = (corners[k], corners[(k + 1) % 3]);
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::closest::tests::sphere;
    use crate::maths::hash::Dice;
    use glam::Vec3;

    #[test]
    fn sides_are_told_from_the_edges_that_are_crossed_alone() {
        // Two balls and a sheet of two triangles, which has a border.
        let (mut points, mut triangles) = (vec![], vec![]);
        for at in [Vec3::ZERO, Vec3::X * 40.0] {
            let ball = sphere(9.0, 6);
            let first = points.len() as u32;
            points.extend(ball.points.iter().map(|p| *p + at));
            triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        let first = points.len() as u32;
        points.extend([Vec3::Y, Vec3::Z, Vec3::X, Vec3::ONE].map(|p| p * 90.0));
        triangles.extend([[0, 1, 2], [3, 2, 1]].map(|t| t.map(|v| v + first)));
        let surface = Surface::new(points, triangles);
        let links = Links::new(&surface);
        assert_eq!(links.pieces.iter().collect::<BTreeSet<_>>().len(), 3);
        for round in 0..50 {
            let dice = Dice::new(round, 0, "sides");
            let share = dice.unit(0, 0);
            let side = |v: u32| dice.unit(u64::from(v), 1) < share;
            let edges = surface.triangles.iter().flat_map(|t| (0..3).map(|k| edge(t, k)));
            let odd: BTreeSet<(u32, u32)> = edges.filter(|(a, b)| side(*a) != side(*b)).collect();
            for (v, found) in (0u32..).zip(links.sides(&odd)) {
                assert_eq!(found, side(v) != side(links.pieces[v as usize]), "{round} {v}");
            }
        }
    }
}
