//! Closed lines on a mesh, cut along its triangles, and what lies inside them.
//!
//! Between its points a line runs straight over the skin: from triangle to triangle in a plane normal to the skin, or,
//! where that leaves the mesh, along a short path over the triangles. Two corners of a triangle are on the same side if
//! the line crosses the edge between them an even number of times; a point inside a triangle is classified against a
//! corner by the line segments in between.
//!
//! Guarantees: two points of a triangle on two sides of the line are classified separately, however close they are;
//! only skin connected to the line is inside; sides do not depend on the order of triangles. Not promised: useful
//! results for a line that does not divide the piece of mesh it lies on; this is reported ([`Outline::is_torn`]).

use super::links::{Links, NONE, edge};
use crate::maths::closest::{Hit, Surface};
use crate::maths::triangle::closest_on_triangle;
use glam::{Vec2, Vec3};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::sync::Arc;

/// Minimum distance of crossings from corners, as a fraction of an edge, and of points from edges, as a fraction of a
/// triangle.
const OFF: f32 = 1e-3;
/// A straight path is abandoned once it is this many times longer than expected.
const TOO_LONG: f32 = 3.0;
/// The most triangles searched for a path where none is straight.
const LOOKS: usize = 100_000;

/// A surface and its connectivity.
pub(crate) struct ConnectedSurface<'a> {
    surface: &'a Surface,
    links: Arc<Links>,
}

/// A straight segment of a line, inside one triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceSegment {
    pub(crate) triangle: u32,
    /// Weights of the second and third corner at both ends.
    pub(crate) bary: [Vec2; 2],
    pub(crate) ends: [Vec3; 2],
}

/// A line on the skin.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceLine {
    /// Segments in order along the line.
    pub(crate) pieces: Vec<SurfaceSegment>,
    /// Crossed edges, each listed once per crossing.
    pub(crate) crossed: Vec<(u32, u32)>,
    /// The point farthest from the skin, and its distance, cm.
    pub(crate) off: Option<(Vec3, f32)>,
    /// Where the line could not be continued over the skin.
    pub(crate) gaps: Vec<[Vec3; 2]>,
}

impl<'a> ConnectedSurface<'a> {
    pub(crate) fn new(surface: &'a Surface) -> Self {
        Self::of(surface, Arc::new(Links::new(surface)))
    }
    /// The same, with known connectivity.
    pub(crate) fn of(surface: &'a Surface, links: Arc<Links>) -> Self {
        Self { surface, links }
    }

    /// The surface.
    pub(crate) fn surface(&self) -> &'a Surface {
        self.surface
    }
    /// Its connectivity.
    pub(crate) fn links(&self) -> Arc<Links> {
        self.links.clone()
    }
    /// Index of the connected piece of the mesh that a vertex belongs to.
    pub(crate) fn piece(&self, vertex: u32) -> u32 {
        self.links.pieces[vertex as usize]
    }
    /// The pieces of the mesh that a line crosses.
    pub(super) fn touched<'p>(
        &self,
        line: impl IntoIterator<Item = &'p SurfaceSegment>,
    ) -> BTreeSet<u32> {
        let of =
            |piece: &SurfaceSegment| self.piece(self.surface.triangles[piece.triangle as usize][0]);
        line.into_iter().map(of).collect()
    }
    /// The triangles across the sides of a triangle.
    pub(crate) fn beside(&self, triangle: u32) -> impl Iterator<Item = u32> {
        self.links.beside[triangle as usize].into_iter().filter(|t| *t != NONE)
    }

    /// Whether both ends of every uncrossed edge are on one side, and those of crossed edges on two.
    fn is_parted(&self, odd: &BTreeSet<(u32, u32)>, sides: &[bool]) -> bool {
        let differ = |(a, b): (u32, u32)| sides[a as usize] != sides[b as usize];
        let sound = |t: u32, corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| sides[v as usize]);
            (a == b && b == c)
                || self.surface.is_gone(t)
                || (0..3).map(|k| edge(corners, k)).all(|edge| !differ(edge) || odd.contains(&edge))
        };
        odd.iter().all(|edge| differ(*edge))
            && (0u32..).zip(&self.surface.triangles).all(|(t, corners)| sound(t, corners))
    }

    /// The line through points near the skin, closed or open. It stays on one piece of the mesh, the one that most
    /// points are on.
    pub(crate) fn line(&self, points: &[Vec3], closed: bool) -> SurfaceLine {
        let mut line = SurfaceLine::default();
        let hits: Vec<Option<Hit>> = points.iter().map(|p| self.surface.closest(*p)).collect();
        let piece = |hit: &Hit| self.piece(self.surface.triangles[hit.triangle as usize][0]);
        let mut votes: BTreeMap<u32, usize> = BTreeMap::new();
        for hit in hits.iter().flatten() {
            *votes.entry(piece(hit)).or_default() += 1;
        }
        let Some((own, _)) = votes.iter().max_by_key(|(id, votes)| (**votes, Reverse(**id))) else {
            return line;
        };
        let mut way: Vec<Hit> = vec![];
        for (p, hit) in points.iter().zip(&hits) {
            let hit = hit.filter(|hit| piece(hit) == *own).or_else(|| self.closest_on(*p, *own));
            let Some(mut hit) = hit else { continue };
            if line.off.is_none_or(|(_, off)| hit.distance > off) {
                line.off = Some((*p, hit.distance));
            }
            // Off edges and corners, where the next triangle is ambiguous.
            hit.bary = within(hit.bary, OFF);
            hit.point = self.surface.at(hit.triangle, hit.bary);
            way.push(hit);
        }
        if closed && way.len() > 2 {
            way.push(way[0]);
        }
        for pair in way.windows(2) {
            if pair[0].point == pair[1].point {
                continue;
            }
            let led = self.straight(&pair[0], &pair[1]).or_else(|| self.round(&pair[0], &pair[1]));
            match led {
                Some((pieces, crossed)) => {
                    line.pieces.extend(pieces);
                    line.crossed.extend(crossed);
                }
                None => line.gaps.push([pair[0].point, pair[1].point]),
            }
        }
        line
    }

    /// The closest point of one piece of the mesh.
    fn closest_on(&self, p: Vec3, piece: u32) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (triangle, corners) in (0u32..).zip(&self.surface.triangles) {
            if self.piece(corners[0]) != piece || self.surface.is_gone(triangle) {
                continue;
            }
            let (bary, point) = closest_on_triangle(p, self.surface.corners(triangle));
            let distance = point.distance(p);
            if best.is_none_or(|best| distance < best.distance) {
                best = Some(Hit { triangle, bary, point, distance });
            }
        }
        best
    }

    /// The straight path over the skin.
    fn straight(&self, from: &Hit, to: &Hit) -> Option<(Vec<SurfaceSegment>, Vec<(u32, u32)>)> {
        let piece = |triangle, bary: [Vec2; 2]| SurfaceSegment {
            triangle,
            bary,
            ends: bary.map(|bary| self.surface.at(triangle, bary)),
        };
        if from.triangle == to.triangle {
            return Some((vec![piece(from.triangle, [from.bary, to.bary])], vec![]));
        }
        let along = to.point - from.point;
        let normal = |hit: &Hit| self.surface.smooth_normal(hit.triangle, hit.bary);
        let across = along.cross(normal(from) + normal(to)).try_normalize()?;
        let side = |v: u32| (self.surface.points[v as usize] - from.point).dot(across);
        // Where the plane leaves a triangle through one of its sides, as weights of its corners.
        let leaves = |triangle: u32, k: usize| {
            let corners = self.surface.triangles[triangle as usize];
            let (a, b) = (side(corners[k]), side(corners[(k + 1) % 3]));
            if (a >= 0.0) == (b >= 0.0) {
                return None;
            }
            Some(on_side(k, (a / (a - b)).clamp(OFF, 1.0 - OFF)))
        };
        let mut ways: Vec<(usize, Vec2)> =
            (0..3).filter_map(|k| Some((k, leaves(from.triangle, k)?))).collect();
        let toward = |(_, bary): &(usize, Vec2)| {
            (self.surface.at(from.triangle, *bary) - from.point).dot(along)
        };
        ways.sort_by(|a, b| toward(b).total_cmp(&toward(a)));
        let longest = TOO_LONG * along.length() + 0.05;
        ways.into_iter().find_map(|(k, bary)| {
            let (mut triangle, mut k, mut at, mut out) = (from.triangle, k, from.bary, bary);
            let (mut pieces, mut crossed, mut length) = (vec![], vec![], 0.0);
            loop {
                let last = piece(triangle, [at, out]);
                length += last.ends[0].distance(last.ends[1]);
                pieces.push(last);
                crossed.push(edge(&self.surface.triangles[triangle as usize], k));
                if length > longest {
                    return None;
                }
                let (next, entered) = self.over(triangle, k)?;
                at = carried(self.surface, triangle, out, next);
                triangle = next;
                if triangle == to.triangle {
                    pieces.push(piece(triangle, [at, to.bary]));
                    return Some((pieces, crossed));
                }
                (k, out) = (0..3)
                    .filter(|k| *k != entered)
                    .find_map(|k| Some((k, leaves(triangle, k)?)))?;
            }
        })
    }

    /// The triangle across a side, and which of its sides that is.
    fn over(&self, triangle: u32, k: usize) -> Option<(u32, usize)> {
        let next = self.links.beside[triangle as usize][k];
        let edge_of = |t: u32, k: usize| edge(&self.surface.triangles[t as usize], k);
        let entered = (next != NONE)
            .then(|| (0..3).find(|other| edge_of(next, *other) == edge_of(triangle, k)))??;
        Some((next, entered))
    }

    /// A short path over the triangles, through the midpoints of their sides.
    fn round(&self, from: &Hit, to: &Hit) -> Option<(Vec<SurfaceSegment>, Vec<(u32, u32)>)> {
        let middle = |t: u32| self.surface.at(t, Vec2::splat(1.0 / 3.0));
        // Non-negative floats sort like their bits.
        let mut best = BTreeMap::from([(from.triangle, (0.0f32, NONE, 0usize))]);
        let mut next = BinaryHeap::from([Reverse((0u32, from.triangle))]);
        let mut done: BTreeSet<u32> = BTreeSet::new();
        while let Some(Reverse((_, triangle))) = next.pop() {
            if triangle == to.triangle || done.len() > LOOKS {
                break;
            }
            if !done.insert(triangle) {
                continue;
            }
            for k in 0..3 {
                let Some((other, _)) = self.over(triangle, k) else { continue };
                let length = best[&triangle].0 + middle(triangle).distance(middle(other));
                if best.get(&other).is_none_or(|known| length < known.0) {
                    best.insert(other, (length, triangle, k));
                    next.push(Reverse((length.to_bits(), other)));
                }
            }
        }
        let mut steps = vec![];
        let mut at = to.triangle;
        while at != from.triangle {
            let (_, before, k) = *best.get(&at)?;
            steps.push((before, k, at));
            at = before;
        }
        let (mut pieces, mut crossed, mut bary) = (vec![], vec![], from.bary);
        let mut push = |triangle, bary: [Vec2; 2]| {
            let ends = bary.map(|bary| self.surface.at(triangle, bary));
            pieces.push(SurfaceSegment { triangle, bary, ends });
        };
        for (triangle, k, next) in steps.into_iter().rev() {
            let out = on_side(k, 0.5);
            push(triangle, [bary, out]);
            crossed.push(edge(&self.surface.triangles[triangle as usize], k));
            bary = carried(self.surface, triangle, out, next);
        }
        push(to.triangle, [bary, to.bary]);
        Some((pieces, crossed))
    }
}

/// Weights of the second and third corner, with all three weights at least about `least` of the whole.
pub(super) fn within(bary: Vec2, least: f32) -> Vec2 {
    let rest = (1.0 - bary.x - bary.y).max(least);
    let [x, y] = [bary.x.max(least), bary.y.max(least)];
    Vec2::new(x, y) / (x + y + rest)
}

/// The segments in one triangle; `pieces` must be sorted by triangle.
pub(super) fn in_triangle(pieces: &[SurfaceSegment], triangle: u32) -> &[SurfaceSegment] {
    let from = pieces.partition_point(|piece| piece.triangle < triangle);
    let count = pieces[from..].partition_point(|piece| piece.triangle == triangle);
    &pieces[from..from + count]
}

/// Weights of the second and third corner at a fraction of the way from corner `k` to the next.
fn on_side(k: usize, share: f32) -> Vec2 {
    match k {
        0 => Vec2::new(share, 0.0),
        1 => Vec2::new(1.0 - share, share),
        _ => Vec2::new(0.0, 1.0 - share),
    }
}

/// Converts a point on an edge shared by two triangles from the weights of one to those of the other.
fn carried(surface: &Surface, from: u32, bary: Vec2, to: u32) -> Vec2 {
    let weights = [1.0 - bary.x - bary.y, bary.x, bary.y];
    let old = surface.triangles[from as usize];
    let [_, x, y] = surface.triangles[to as usize].map(|v| {
        let same = old.iter().position(|other| *other == v);
        same.map_or(0.0, |k| weights[k].max(0.0))
    });
    Vec2::new(x, y)
}

/// A closed line and its inside.
pub(crate) struct Outline {
    /// Its segments, sorted by triangle.
    pieces: Vec<SurfaceSegment>,
    /// Whether each vertex is inside.
    inside: Vec<bool>,
    /// Area of skin inside, cm2.
    area: f32,
    torn: bool,
    /// Segments by the cells of space within their reach. A cell is as wide as the longest segment, so that each is in
    /// few cells.
    near: BTreeMap<[i32; 3], Vec<u32>>,
    side: f32,
    /// Distance from the line up to which distances are known, cm.
    reach: f32,
}

/// Samples along a side of a triangle, by which its inside fraction is computed.
const SHARES: u32 = 24;

impl Outline {
    /// What a closed line encloses: the smaller of its two sides. Distances to it are known up to `reach`, cm.
    pub(crate) fn new(net: &ConnectedSurface, line: &SurfaceLine, reach: f32) -> Self {
        let mut crossed = line.crossed.clone();
        crossed.sort_unstable();
        let touched = net.touched(&line.pieces);
        let odd: BTreeSet<(u32, u32)> = crossed
            .chunk_by(|a, b| a == b)
            .filter(|same| same.len() % 2 == 1)
            .map(|same| same[0])
            .collect();
        let inside = net.links.sides(&odd);
        let mut pieces = line.pieces.clone();
        pieces.sort_by_key(|piece| piece.triangle);
        let torn = !line.gaps.is_empty() || !net.is_parted(&odd, &inside);
        let length = |piece: &SurfaceSegment| piece.ends[0].distance(piece.ends[1]);
        let side = pieces.iter().map(length).fold(reach, f32::max);
        let near = BTreeMap::new();
        let mut outline = Self { pieces, inside, area: 0.0, torn, near, side, reach };
        let areas = outline.areas(net, &touched);
        outline.area = areas[1];
        if areas[1] > areas[0] {
            outline.area = areas[0];
            for (inside, piece) in outline.inside.iter_mut().zip(&net.links.pieces) {
                *inside = touched.contains(piece) && !*inside;
            }
        }
        if reach > 0.0 {
            for (i, piece) in (0u32..).zip(&outline.pieces) {
                let [a, b] = piece.ends;
                let [low, high] = [a.min(b) - reach, a.max(b) + reach].map(|p| cell_of(p, side));
                for x in low[0]..=high[0] {
                    for y in low[1]..=high[1] {
                        for z in low[2]..=high[2] {
                            outline.near.entry([x, y, z]).or_default().push(i);
                        }
                    }
                }
            }
        }
        outline
    }

    /// Area on both sides of the line, of the pieces that it lies on, cm2.
    fn areas(&self, net: &ConnectedSurface, touched: &BTreeSet<u32>) -> [f32; 2] {
        let surface = net.surface;
        let mut areas = [0.0f64; 2];
        let mut cut = self.pieces.chunk_by(|a, b| a.triangle == b.triangle).peekable();
        for (t, corners) in (0u32..).zip(&surface.triangles) {
            let pieces = cut.next_if(|pieces| pieces[0].triangle == t);
            if surface.is_gone(t) || !touched.contains(&net.piece(corners[0])) {
                continue;
            }
            let area = 0.5 * f64::from(net.links.twice[t as usize]);
            let inside = self.inside[corners[0] as usize];
            let Some(pieces) = pieces else {
                areas[usize::from(inside)] += area;
                continue;
            };
            for_middles(SHARES, |bary| {
                areas[usize::from(inside != is_beyond(pieces, bary))] +=
                    area / f64::from(SHARES * SHARES);
            });
        }
        areas.map(|area| area as f32)
    }

    /// The segments of the line in a triangle.
    fn of(&self, triangle: u32) -> &[SurfaceSegment] {
        in_triangle(&self.pieces, triangle)
    }

    /// Whether the line does not divide the mesh: it runs off it, or around a handle.
    pub(crate) fn is_torn(&self) -> bool {
        self.torn
    }
    /// Area of skin inside, cm2.
    pub(crate) fn area(&self) -> f32 {
        self.area
    }
    /// Swaps inside and outside.
    pub(crate) fn turn(&mut self, net: &ConnectedSurface) {
        let touched = net.touched(&self.pieces);
        for (inside, piece) in self.inside.iter_mut().zip(&net.links.pieces) {
            *inside = touched.contains(piece) && !*inside;
        }
        self.area = self.areas(net, &touched)[1];
    }
    /// Its segments, sorted by triangle.
    pub(crate) fn pieces(&self) -> &[SurfaceSegment] {
        &self.pieces
    }
    /// Whether a vertex is inside.
    pub(crate) fn holds_vertex(&self, vertex: u32) -> bool {
        self.inside[vertex as usize]
    }
    /// Whether a point of a triangle is inside.
    pub(crate) fn holds(&self, surface: &Surface, triangle: u32, bary: Vec2) -> bool {
        let Some(corners) = surface.triangles.get(triangle as usize) else { return false };
        self.inside[corners[0] as usize] != is_beyond(self.of(triangle), bary)
    }
    /// Straight distance to the line, cm; at most the reach, and some positive number without a line.
    pub(crate) fn distance(&self, p: Vec3) -> f32 {
        if self.reach <= 0.0 {
            return 1.0;
        }
        let near = self.near.get(&cell_of(p, self.side)).into_iter().flatten();
        let square = near.map(|i| super::lines::square_to(self.pieces[*i as usize].ends, p));
        square.fold(self.reach * self.reach, f32::min).sqrt()
    }
    /// The same, positive inside and negative outside.
    pub(crate) fn depth(&self, surface: &Surface, triangle: u32, bary: Vec2) -> f32 {
        let distance = self.distance(surface.at(triangle, bary)).max(f32::MIN_POSITIVE);
        if self.holds(surface, triangle, bary) { distance } else { -distance }
    }
    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let near: usize = self.near.values().map(|list| 4 * list.len() + 48).sum();
        self.pieces.len() * size_of::<SurfaceSegment>() + self.inside.len() + near
    }
}

/// Whether a point of a triangle is on another side of the line than its first corner, judged by the segments in the
/// triangle.
fn is_beyond(pieces: &[SurfaceSegment], bary: Vec2) -> bool {
    // Segments end on the sides of their triangle: a point on a side counts as just inside it.
    let to = within(bary, 0.01 * OFF);
    let passed = pieces
        .iter()
        .filter(|piece| super::chart::cross(Vec2::ZERO, to, piece.bary[0], piece.bary[1]));
    passed.count() % 2 == 1
}

/// The centres of `n` by `n` equal parts of a triangle, as weights of its second and third corner.
pub(crate) fn for_middles(n: u32, mut each: impl FnMut(Vec2)) {
    let step = 1.0 / n as f32;
    for i in 0..n {
        for j in 0..n - i {
            let corner = Vec2::new(i as f32, j as f32) * step;
            each(corner + step / 3.0);
            if i + j + 1 < n {
                each(corner + step * 2.0 / 3.0);
            }
        }
    }
}

fn cell_of(p: Vec3, side: f32) -> [i32; 3] {
    (p / side).to_array().map(|x| x.floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::closest::tests::sphere;
    use crate::maths::hash::Dice;
    use crate::maths::transcendental::sin_cos_turns;

    /// A circle on a ball around `pole`, `height` from the ball's centre.
    fn circle(pole: Vec3, height: f32, n: u32) -> Vec<Vec3> {
        let right = pole.any_orthonormal_vector();
        let up = pole.cross(right);
        let round = |k| {
            let (s, c) = sin_cos_turns(k as f32 / n as f32);
            pole * height + (right * c + up * s) * (1.0f32 - height * height).sqrt()
        };
        (0..n).map(|k| round(k) * 9.0).collect()
    }

    #[test]
    fn points_have_the_side_that_they_are_on_and_the_smaller_side_is_inside() {
        let ball = sphere(9.0, 20);
        let net = ConnectedSurface::new(&ball);
        for (pole, height) in
            [(Vec3::Y, 0.7), (Vec3::new(0.3, -0.9, 0.2).normalize(), 0.9), (Vec3::X, 0.1)]
        {
            let line = net.line(&circle(pole, height, 200), true);
            assert!(line.gaps.is_empty() && line.off.unwrap().1 < 0.2);
            let outline = Outline::new(&net, &line, 0.4);
            assert!(!outline.is_torn());
            // A cap of a ball has an area of 2 pi r^2 (1 - height); the mesh is slightly smaller.
            let cap = std::f32::consts::TAU * 81.0 * (1.0 - height);
            assert!((outline.area() / cap - 1.0).abs() < 0.01, "{} {cap}", outline.area());
            let dice = Dice::new(3, 0, "points");
            let mut near = 0;
            for id in 0..4000 {
                let some = Vec3::from([0, 1, 2].map(|k| dice.signed(id, k)));
                let p = some.normalize_or(Vec3::Y) * 9.0;
                let hit = ball.closest(p).unwrap();
                let over = hit.point.normalize().dot(pole) - height;
                // The line's chords are up to 0.01 cm off the circle.
                if over.abs() < 0.003 {
                    continue;
                }
                near += u32::from(over.abs() < 0.03);
                assert_eq!(outline.holds(&ball, hit.triangle, hit.bary), over > 0.0, "{p} {over}");
                let depth = outline.depth(&ball, hit.triangle, hit.bary);
                assert!((depth > 0.0) == (over > 0.0) && depth.abs() <= 0.4);
            }
            assert!(near > 40, "{near}");
        }
    }

    #[test]
    fn a_line_in_one_triangle_has_an_inside_and_one_off_the_mesh_says_where() {
        let ball = sphere(9.0, 4);
        let net = ConnectedSurface::new(&ball);
        let hit = ball.closest(Vec3::new(4.0, 5.0, 3.0)).unwrap();
        let middle = ball.at(hit.triangle, Vec2::splat(1.0 / 3.0));
        let [a, b, _] = ball.corners(hit.triangle);
        let (x, y) = ((b - a).normalize() * 0.2, (b - a).cross(middle).normalize() * 0.2);
        let square = [middle - x - y, middle + x - y, middle + x + y, middle - x + y];
        let outline = Outline::new(&net, &net.line(&square, true), 0.0);
        assert!((outline.area() - 0.16).abs() < 0.03, "{}", outline.area());
        assert!(outline.holds(&ball, hit.triangle, Vec2::splat(1.0 / 3.0)));
        assert!((0..ball.points.len() as u32).all(|v| !outline.holds_vertex(v)));
        let line = net.line(&[Vec3::Y * 14.0, Vec3::X * 9.0, Vec3::Z * 9.0], true);
        assert!((line.off.unwrap().1 - 5.0).abs() < 0.01);
    }

    #[test]
    fn a_narrow_edge_on_large_triangles_takes_no_more_room_than_a_wide_one() {
        let ball = sphere(900.0, 3);
        let net = ConnectedSurface::new(&ball);
        let ring: Vec<Vec3> = circle(Vec3::Y, 0.2, 12).iter().map(|p| *p * 100.0).collect();
        let line = net.line(&ring, true);
        for reach in [1e-30, 1e-4, 0.25, 1e4] {
            let outline = Outline::new(&net, &line, reach);
            assert!(outline.near.len() < 30 * outline.pieces.len() && !outline.is_torn());
            let on = outline.pieces[3].ends[0];
            assert!(outline.distance(on) <= 1e-3 && outline.distance(Vec3::Y * 3e5) <= reach);
        }
    }

    #[test]
    fn what_does_not_hang_together_with_the_line_is_outside_and_hostile_lines_end() {
        let (mut points, mut triangles) = (vec![], vec![]);
        for at in [Vec3::ZERO, Vec3::X * 40.0] {
            let ball = sphere(9.0, 8);
            let first = points.len() as u32;
            points.extend(ball.points.iter().map(|p| *p + at));
            triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        let both = Surface::new(points, triangles);
        let net = ConnectedSurface::new(&both);
        // One of its points is nearer to the other ball.
        let mut ring = circle(Vec3::X, 0.3, 40);
        ring[7] = Vec3::X * 25.0;
        let outline = Outline::new(&net, &net.line(&ring, true), 0.5);
        assert!(!outline.is_torn());
        let far = (0..both.points.len() as u32).filter(|v| both.points[*v as usize].x > 20.0);
        assert!(far.into_iter().all(|v| !outline.holds_vertex(v)));
        let dice = Dice::new(5, 0, "hostile");
        for id in 0..60u64 {
            let many = (0..id % 30).map(|k| {
                let some = Vec3::from([0, 1, 2].map(|axis| dice.signed(id, 3 * k + axis)));
                some * [1.0, 10.0, 1e2, 1e3, 1e5, 1e9, 1e18][(id % 7) as usize]
            });
            let mut many: Vec<Vec3> = many.collect();
            match id % 5 {
                0 => many.push(Vec3::NAN),
                1 => many.push(Vec3::INFINITY),
                2 => many.extend(many.clone()),
                _ => {}
            }
            let outline = Outline::new(&net, &net.line(&many, true), 0.3);
            let all = 2.0 * 1018.0;
            assert!((0.0..=0.51 * all).contains(&outline.area()), "{id} {}", outline.area());
        }
        let none = Surface::new(vec![], vec![]);
        let net = ConnectedSurface::new(&none);
        assert_eq!(Outline::new(&net, &net.line(&[Vec3::X, Vec3::Y], true), 1.0).area(), 0.0);
    }
}
