//! The closest point of a triangle surface, rays against it, and which side of it a point is on.
//!
//! The tree is parry3d's; the triangle arithmetic is ours, so that ties are settled by rule (the lowest
//! triangle wins) and the answer is the same bits on every machine. The side is told by the
//! pseudo-normal of the closest feature (Baerentzen and Aanaes 2005, "Signed distance computation
//! using the angle weighted pseudonormal"): exact for closed surfaces, and right near the surface for
//! open ones. Far behind a hole the side is a matter of opinion and not promised.

use glam::{Vec2, Vec3};
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, TraversalAction};
use std::cell::Cell;
use std::collections::BTreeMap;

/// Triangles with their normals and their tree.
pub struct Surface {
    /// Vertices.
    pub points: Vec<Vec3>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Smooth vertex normals: face normals weighted by their angle at the vertex. Unit; zero where no
    /// face has area.
    pub normals: Vec<Vec3>,
    edge_normals: Vec<[Vec3; 3]>,
    tree: Bvh,
    /// Which triangles nothing meets; empty where all are met.
    gone: Vec<bool>,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Which triangle.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third corner; the first has the rest.
    pub bary: Vec2,
    /// The point itself.
    pub point: Vec3,
    /// From the asked point, or along the ray.
    pub distance: f32,
}

/// Points farther off (cm) are taken for nearer ones on the same side.
const FARAWAY: f32 = 1e5;

/// Triangles that are looked at together.
const PACK: usize = 8;

/// The most triangles of [`Around`]; a bust of 36,000 has 100 to 300 there. Among more, the tree is the faster way.
const MOST: usize = 1024;

/// One number of each triangle of a pack, and one vector.
type Each = [f32; PACK];
type Each3 = [Each; 3];

/// Some of the triangles of [`Around`], made ready to be asked how far off they are.
struct Pack {
    /// The least distance of any of them from the ball's middle.
    nearest: f32,
    triangles: [u32; PACK],
    corner: Each3,
    /// From each corner to the next; one over the square of its length, or 0; and what points out of the triangle
    /// there, in its plane.
    edges: [Each3; 3],
    per_square: [Each; 3],
    out: [Each3; 3],
    /// Unit, or zero where there is no area.
    normal: Each3,
}

/// The triangles that may be closest to a point of a ball, those nearest to its middle first.
pub struct Around<'a> {
    surface: &'a Surface,
    middle: Vec3,
    slack: f32,
    packs: Vec<Pack>,
    /// The triangle that is closest to the middle.
    pub nearest: u32,
}

impl Around<'_> {
    /// What [`Surface::closest`] finds for a point of the ball, sooner when triangle `near`, which something may meet, is close to
    /// it.
    pub fn closest_from(&self, p: Vec3, near: u32) -> Hit {
        let (bary, point) = closest_on_triangle(p, self.surface.corners(near));
        let mut best = (point.distance_squared(p), near, bary, point);
        let off = p.distance(self.middle) + self.slack;
        let mut reach = best.0.sqrt();
        for pack in &self.packs {
            if pack.nearest > reach + off {
                break;
            }
            let squares = pack.squares(p);
            for (i, square) in squares.into_iter().enumerate() {
                let limit = reach + self.slack;
                // (A NaN is looked at.)
                if square > limit * limit {
                    continue;
                }
                let triangle = pack.triangles[i];
                let (bary, point) = closest_on_triangle(p, self.surface.corners(triangle));
                let d2 = point.distance_squared(p);
                if d2 < best.0 || (d2 == best.0 && triangle < best.1) {
                    best = (d2, triangle, bary, point);
                    reach = d2.sqrt();
                }
            }
        }
        let (d2, triangle, bary, point) = best;
        Hit { triangle, bary, point, distance: d2.sqrt() }
    }
}

impl Pack {
    /// Of triangles with their distances, 1 to [`PACK`] of them; the last fills what is left.
    fn new(surface: &Surface, triangles: &[(f32, u32)]) -> Self {
        let last = triangles.len() - 1;
        let mut pack = Self {
            nearest: triangles[0].0,
            triangles: [0; PACK],
            corner: Each3::default(),
            edges: Default::default(),
            per_square: Default::default(),
            out: Default::default(),
            normal: Each3::default(),
        };
        let put = |each: &mut Each3, i: usize, v: Vec3| {
            each.iter_mut().zip(v.to_array()).for_each(|(each, v)| each[i] = v);
        };
        for i in 0..PACK {
            let triangle = triangles[i.min(last)].1;
            let corners = surface.corners(triangle);
            let normal = surface.area_vector(triangle).normalize_or_zero();
            pack.triangles[i] = triangle;
            put(&mut pack.corner, i, corners[0]);
            put(&mut pack.normal, i, normal);
            for k in 0..3 {
                let edge = corners[(k + 1) % 3] - corners[k];
                let square = edge.length_squared();
                put(&mut pack.edges[k], i, edge);
                put(&mut pack.out[k], i, edge.cross(normal));
                pack.per_square[k][i] = if square > 0.0 { 1.0 / square } else { 0.0 };
            }
        }
        pack
    }

    /// The square of each triangle's distance from a point, but for rounding; 0 where there is no area. Without branches,
    /// so that a compiler takes several at once.
    #[inline]
    fn squares(&self, p: Vec3) -> Each {
        let mut squares = [0.0f32; PACK];
        for (i, square) in squares.iter_mut().enumerate() {
            let of = |each: &Each3| Vec3::new(each[0][i], each[1][i], each[2][i]);
            let mut from = p - of(&self.corner);
            let height = from.dot(of(&self.normal));
            let (mut to_edge, mut is_over) = (f32::MAX, true);
            for k in 0..3 {
                let edge = of(&self.edges[k]);
                let t = lesser(greater(from.dot(edge) * self.per_square[k][i], 0.0), 1.0);
                to_edge = lesser(to_edge, (from - edge * t).length_squared());
                is_over &= from.dot(of(&self.out[k])) <= 0.0;
                from -= edge;
            }
            *square = if is_over { height * height } else { to_edge };
        }
        squares
    }
}

impl Surface {
    /// Builds normals and tree. Triangles must name existing points.
    pub fn new(points: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let corners = |t: &[u32; 3]| t.map(|v| points[v as usize]);
        let mut normals = vec![Vec3::ZERO; points.len()];
        let mut edges: BTreeMap<(u32, u32), Vec3> = BTreeMap::new();
        for t in &triangles {
            let [a, b, c] = corners(t);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            for (i, (at, next, last)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
                let angle = super::transcendental::acos(
                    (next - at).normalize_or_zero().dot((last - at).normalize_or_zero()),
                );
                normals[t[i] as usize] += normal * angle;
                *edges.entry(edge(t[i], t[(i + 1) % 3])).or_default() += normal;
            }
        }
        for normal in &mut normals {
            *normal = normal.normalize_or_zero();
        }
        let edge_normals = triangles
            .iter()
            .map(|t| {
                [0, 1, 2]
                    .map(|i| edges.get(&edge(t[i], t[(i + 1) % 3])).copied().unwrap_or_default())
            })
            .collect();
        let tree = tree(&points, &triangles, |_| true);
        Self { points, triangles, normals, edge_normals, tree, gone: vec![] }
    }

    /// The same triangles under the same numbers, of which those that are `gone` are met by nothing any more.
    pub fn without(self, gone: &[bool]) -> Self {
        let tree = tree(&self.points, &self.triangles, |t| !gone[t]);
        Self { tree, gone: gone.to_vec(), ..self }
    }

    /// Whether nothing meets a triangle any more.
    pub fn is_gone(&self, triangle: u32) -> bool {
        self.gone.get(triangle as usize).copied().unwrap_or(false)
    }

    /// The three corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }

    /// Lowest and highest corner of the bounding box; zeros when there are no points.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let first = self.points.first().copied().unwrap_or_default();
        self.points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
    }

    /// The closest point of the surface to `p`; none when there are no triangles or `p` is not finite.
    pub fn closest(&self, p: Vec3) -> Option<Hit> {
        self.closest_within(p, f32::MAX)
    }

    /// The closest point not farther than `reach`.
    pub fn closest_within(&self, p: Vec3, reach: f32) -> Option<Hit> {
        let limit = if reach < 1e18 { (reach * reach).next_up() } else { f32::MAX };
        self.search(p, limit, (f32::MAX, u32::MAX, Vec2::ZERO, Vec3::ZERO))
    }

    /// The closest point, as [`Self::closest`] finds it, found sooner when triangle `near` is close to it: the answer for a
    /// neighbour of `p`.
    pub fn closest_from(&self, p: Vec3, near: u32) -> Option<Hit> {
        if self.is_gone(near) {
            return self.closest(p);
        }
        let (bary, point) = closest_on_triangle(p, self.corners(near));
        let d2 = point.distance_squared(p);
        self.search(p, d2.next_up(), (d2, near, bary, point))
    }

    /// What [`Self::closest`] may find for points of the ball of `radius` about `middle`, gathered once for many of them; none where
    /// that are no triangles or very many, or the ball is not finite.
    pub fn around(&self, middle: Vec3, radius: f32, near: u32) -> Option<Around<'_>> {
        let hit = self.closest_from(middle, near)?;
        // Rounding must leave out nothing.
        let slack = 1e-5 * (middle.abs().max_element() + radius + hit.distance);
        let reach = hit.distance + 2.0 * radius + slack;
        let mut found = vec![];
        self.tree.traverse(|node| {
            let (lo, hi) = (node.mins(), node.maxs());
            let off = (lo - middle).max(middle - hi).max(Vec3::ZERO);
            // (A NaN must not prune.)
            if off.length_squared() > reach * reach {
                return TraversalAction::Prune;
            }
            if let Some(triangle) = node.leaf_data() {
                let (_, point) = closest_on_triangle(middle, self.corners(triangle));
                let far = point.distance(middle);
                if far <= reach {
                    found.push((far, triangle));
                }
            }
            if found.len() > MOST { TraversalAction::EarlyExit } else { TraversalAction::Continue }
        });
        if found.len() > MOST {
            return None;
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let packs = found.chunks(PACK).map(|pack| Pack::new(self, pack)).collect();
        Some(Around { surface: self, middle, slack, packs, nearest: hit.triangle })
    }

    /// The best of `best` and what lies within `limit` (squared).
    /// A point that sees the triangles from the same side as `p`, but from no farther than [`FARAWAY`]; none where `p` does so
    /// itself. From farther all are equally far in single precision, and each would be looked at.
    fn seen_from_nearer(&self, p: Vec3) -> Option<Vec3> {
        let bounds = self.tree.root_aabb();
        let middle = (bounds.mins + bounds.maxs) * 0.5;
        let size = (bounds.maxs - bounds.mins).length();
        // (By halves: squares of what is that far may have no number.)
        let off = (p - middle) / FARAWAY;
        let far = off.length() * FARAWAY;
        let most = FARAWAY.max(1e3 * size);
        (far > 1.01 * most && far.is_finite()).then(|| middle + off.normalize_or_zero() * most)
    }

    fn search(&self, p: Vec3, limit: f32, best: (f32, u32, Vec2, Vec3)) -> Option<Hit> {
        if !p.is_finite() {
            return None;
        }
        if p.abs().max_element() > FARAWAY
            && let Some(nearer) = self.seen_from_nearer(p)
        {
            let hit =
                self.search(nearer, f32::MAX, (f32::MAX, u32::MAX, Vec2::ZERO, Vec3::ZERO))?;
            let distance = hit.point.distance(p);
            let is_within = distance * distance <= limit || limit == f32::MAX;
            return is_within.then_some(Hit { distance, ..hit });
        }
        let best = Cell::new(best);
        // A box as far as the best so far is still opened: it may hold a lower triangle at the same distance.
        self.tree.find_best(
            limit,
            |node, _| {
                let (lo, hi) = (node.mins(), node.maxs());
                let axis = |lo: f32, p: f32, hi: f32| greater(greater(lo - p, p - hi), 0.0);
                let (x, y) = (axis(lo.x, p.x, hi.x), axis(lo.y, p.y, hi.y));
                let z = axis(lo.z, p.z, hi.z);
                // A little less than it is, and less than 0 at 0.
                (x * x + y * y + z * z) * 0.999_999_8 - 1e-30
            },
            |triangle, _| {
                let (bary, point) = closest_on_triangle(p, self.corners(triangle));
                let d2 = point.distance_squared(p);
                let (best_d2, best_triangle, ..) = best.get();
                if d2 < best_d2 || (d2 == best_d2 && triangle < best_triangle) {
                    best.set((d2, triangle, bary, point));
                }
                Some(d2)
            },
        );
        let (d2, triangle, bary, point) = best.get();
        (triangle != u32::MAX && d2 <= limit).then(|| Hit {
            triangle,
            bary,
            point,
            distance: d2.sqrt(),
        })
    }

    /// The first point that the ray meets, from either side, within `reach` times `direction`. `distance`
    /// is in multiples of `direction`'s length.
    pub fn ray(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        let inverse = Vec3::ONE / direction;
        let mut best: Option<Hit> = None;
        self.tree.traverse(|node| {
            let limit = best.map_or(reach, |hit| hit.distance);
            let (a, b) = ((node.mins() - origin) * inverse, (node.maxs() - origin) * inverse);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            // A NaN (0 times infinity: the ray lies in a box's side) must not prune.
            if far < 0.0 || near > limit || near > far {
                return TraversalAction::Prune;
            }
            if let Some(triangle) = node.leaf_data()
                && let Some((t, bary)) = ray_triangle(origin, direction, self.corners(triangle))
                && t <= limit
                && best.is_none_or(|hit| t < hit.distance || triangle < hit.triangle)
            {
                best = Some(Hit { triangle, bary, point: origin + direction * t, distance: t });
            }
            TraversalAction::Continue
        });
        best
    }

    /// The point at barycentric coordinates of a triangle.
    #[inline]
    pub fn at(&self, triangle: u32, bary: Vec2) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        a + (b - a) * bary.x + (c - a) * bary.y
    }

    /// The smooth normal at a point of the surface. Unit.
    pub fn smooth_normal(&self, triangle: u32, bary: Vec2) -> Vec3 {
        let [a, b, c] = self.triangles[triangle as usize].map(|v| self.normals[v as usize]);
        (a * (1.0 - bary.x - bary.y) + b * bary.x + c * bary.y)
            .try_normalize()
            .unwrap_or_else(|| self.face_normal(triangle))
    }

    /// The flat normal of a triangle. Unit; +Y when it has no area.
    pub fn face_normal(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Y)
    }

    /// Twice the area vector of a triangle, not normalised.
    pub fn area_vector(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// The distance of `p` from its closest point `hit`, negative inside. Where a mesh ends, or folds into itself as scans do, an
    /// edge or a corner does not tell the sides apart: what seems deep inside such a one is looked at from there.
    pub fn signed_distance(&self, p: Vec3, hit: &Hit) -> f32 {
        let side = (p - hit.point).dot(self.pseudo_normal(hit));
        if side >= 0.0 {
            return hit.distance;
        }
        let at_edge = [1.0 - hit.bary.x - hit.bary.y, hit.bary.x, hit.bary.y];
        let doubtful = hit.distance > DOUBTFUL && at_edge.iter().any(|w| *w <= ON);
        if doubtful && !self.sees_backs(p) { hit.distance } else { -hit.distance }
    }

    /// Whether most ways from a point meet the back of the surface first, which is how it looks from inside.
    fn sees_backs(&self, p: Vec3) -> bool {
        const WAYS: [Vec3; 5] = [
            Vec3::new(0.31, 0.87, 0.38),
            Vec3::new(-0.83, 0.29, 0.47),
            Vec3::new(0.62, -0.41, 0.67),
            Vec3::new(-0.27, -0.58, -0.77),
            Vec3::new(0.53, 0.39, -0.75),
        ];
        let backs = WAYS.iter().filter(|way| {
            let hit = self.ray(p, **way, 1e4);
            hit.is_some_and(|hit| self.area_vector(hit.triangle).dot(**way) > 0.0)
        });
        2 * backs.count() > WAYS.len()
    }

    fn pseudo_normal(&self, hit: &Hit) -> Vec3 {
        let t = hit.triangle as usize;
        let weights = [1.0 - hit.bary.x - hit.bary.y, hit.bary.x, hit.bary.y];
        let zero = weights.map(|w| w <= ON);
        match zero.iter().filter(|z| **z).count() {
            0 => self.area_vector(hit.triangle),
            // Edge i runs from corner i to i + 1: the corner across has no weight.
            1 => self.edge_normals[t][(zero.iter().position(|z| *z).unwrap_or(0) + 1) % 3],
            _ => {
                let corner = zero.iter().position(|z| !*z).unwrap_or(0);
                self.normals[self.triangles[t][corner] as usize]
            }
        }
    }
}

/// A point's weight of a corner in which it has none.
const ON: f32 = 1e-5;
/// Nearer than this (cm) edges and corners are believed.
const DOUBTFUL: f32 = 0.2;

/// The greater of two numbers that are no NaN: one instruction, where `f32::max` has to look for them.
#[inline]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The lesser of two numbers that are no NaN.
#[inline]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The tree of the triangles for which `stays` says so.
fn tree(points: &[Vec3], triangles: &[[u32; 3]], stays: impl Fn(usize) -> bool) -> Bvh {
    let around = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| points[v as usize]);
        Aabb::new(a.min(b).min(c), a.max(b).max(c))
    };
    let leaves: Vec<usize> = (0..triangles.len()).filter(|t| stays(*t)).collect();
    if leaves.len() > 2 {
        let leaves = leaves.into_iter().map(|t| (t, around(&triangles[t])));
        return Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
    }
    // Of one or two leaves, `from_iter` takes only those that are numbered from 0.
    let mut tree = Bvh::new();
    leaves.into_iter().for_each(|t| tree.insert(around(&triangles[t]), t as u32));
    tree
}

fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// Closest point of a triangle (Ericson 2005, "Real-time collision detection", 5.1.5), as the weights of
/// its second and third corner.
pub fn closest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> (Vec2, Vec3) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (Vec2::ZERO, a);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (Vec2::X, b);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = if d1 > d3 { d1 / (d1 - d3) } else { 0.0 };
        return (Vec2::new(v, 0.0), a + ab * v);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (Vec2::Y, c);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = if d2 > d6 { d2 / (d2 - d6) } else { 0.0 };
        return (Vec2::new(0.0, w), a + ac * w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let sum = (d4 - d3) + (d5 - d6);
        let w = if sum > 0.0 { (d4 - d3) / sum } else { 0.0 };
        return (Vec2::new(1.0 - w, w), b + (c - b) * w);
    }
    let scale = 1.0 / (va + vb + vc);
    if !scale.is_finite() {
        return (Vec2::ZERO, a);
    }
    let (v, w) = (vb * scale, vc * scale);
    (Vec2::new(v, w), a + ab * v + ac * w)
}

/// Moeller and Trumbore 1997, both sides.
fn ray_triangle(origin: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> Option<(f32, Vec2)> {
    let (ab, ac) = (b - a, c - a);
    let h = direction.cross(ac);
    let det = ab.dot(h);
    if det == 0.0 {
        return None;
    }
    let s = (origin - a) / det;
    let u = s.dot(h);
    let q = s.cross(ab);
    let v = direction.dot(q);
    let t = ac.dot(q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some((t, Vec2::new(u, v)))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    /// A sphere of `n` x `2n` quads; poles on Y, no uv.
    pub(crate) fn sphere(radius: f32, n: u32) -> Surface {
        use crate::maths::transcendental::sin_cos_turns;
        let columns = 2 * n;
        let mut points = vec![Vec3::Y * radius];
        for row in 1..n {
            let (sr, cr) = sin_cos_turns(row as f32 / (2 * n) as f32);
            for column in 0..columns {
                let (s, c) = sin_cos_turns(column as f32 / columns as f32);
                points.push(Vec3::new(sr * s, cr, sr * c) * radius);
            }
        }
        points.push(Vec3::NEG_Y * radius);
        let last = points.len() as u32 - 1;
        let at = |row: u32, column: u32| match row {
            0 => 0,
            r if r == n => last,
            r => 1 + (r - 1) * columns + column % columns,
        };
        let mut triangles = Vec::new();
        for row in 0..n {
            for column in 0..columns {
                let (a, b) = (at(row, column), at(row, column + 1));
                let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
                if row > 0 {
                    triangles.push([a, c, b]);
                }
                if row + 1 < n {
                    triangles.push([b, c, d]);
                }
            }
        }
        Surface::new(points, triangles)
    }

    #[test]
    fn what_is_very_far_off_still_sees_the_near_side() {
        let ball = sphere(9.0, 24);
        for far in [1e4, 1e6, 2e9, 1e18] {
            for way in [Vec3::X, Vec3::new(-0.6, 0.8, 0.0), Vec3::new(0.48, -0.6, 0.64)] {
                let hit = ball.closest(way * far).unwrap();
                // Faces of 24 rings are up to 1.2 cm wide.
                assert!(hit.point.distance(way * 9.0) < 1.2, "{far} {way}: {}", hit.point);
                assert!((0.99..=1.0).contains(&(hit.distance / far)), "{far}: {}", hit.distance);
            }
        }
        assert!(ball.closest_within(Vec3::X * 2e9, 1e9).is_none());
    }

    #[test]
    fn the_closest_point_is_the_closest_of_all_triangles_and_ties_take_the_lowest() {
        let surface = sphere(2.0, 12);
        let dice = Dice::new(3, 0, "query");
        for id in 0..500 {
            let p = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 4.0;
            let p = if id % 5 == 0 { surface.points[id as usize % 200] } else { p };
            let hit = surface.closest(p).unwrap();
            let brute = (0..surface.triangles.len() as u32)
                .map(|t| (closest_on_triangle(p, surface.corners(t)).1.distance_squared(p), t))
                .min_by(|a, b| a.partial_cmp(b).unwrap())
                .unwrap();
            assert_eq!((hit.distance, hit.triangle), (brute.0.sqrt(), brute.1), "{p}");
            assert!(surface.at(hit.triangle, hit.bary).distance(hit.point) < 1e-5);
            for near in [hit.triangle, 0, id as u32] {
                assert_eq!(surface.closest_from(p, near), Some(hit), "{p} from {near}");
            }
            let aside = Vec3::new(dice.signed(id, 3), dice.signed(id, 4), dice.signed(id, 5)) * 0.5;
            let around = surface.around(p + aside, 0.9, id as u32).unwrap();
            for near in [around.nearest, 0] {
                assert_eq!(around.closest_from(p, near), hit, "{p} from {near}");
            }
        }
    }

    #[test]
    fn of_very_many_triangles_in_little_room_none_are_gathered() {
        let surface = sphere(0.1, 64);
        assert!(surface.triangles.len() > MOST);
        assert!(surface.around(Vec3::X * 0.1, 0.7, 0).is_none());
        // Where few of them may be closest they are.
        assert!(surface.around(Vec3::X * 0.1, 0.003, 0).is_some());
    }

    #[test]
    fn the_side_is_right_everywhere_about_a_closed_surface() {
        let surface = sphere(2.0, 16);
        let dice = Dice::new(4, 0, "query");
        for id in 0..500 {
            let p = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 3.0;
            let signed = surface.signed_distance(p, &surface.closest(p).unwrap());
            let want = p.length() - 2.0;
            assert!((signed - want).abs() < 0.03, "{p}: {signed} {want}");
        }
    }

    #[test]
    fn a_ray_meets_the_near_side() {
        let surface = sphere(2.0, 32);
        let hit = surface.ray(Vec3::new(0.3, 0.2, 10.0), Vec3::NEG_Z, 100.0).unwrap();
        assert!((hit.point.z - 1.966).abs() < 0.01, "{hit:?}");
        assert!(surface.ray(Vec3::new(0.0, 5.0, 10.0), Vec3::NEG_Z, 100.0).is_none());
        assert!(surface.ray(Vec3::new(0.0, 0.0, 10.0), Vec3::NEG_Z, 5.0).is_none());
    }

    #[test]
    fn nothing_is_close_to_nothing() {
        assert!(Surface::new(vec![], vec![]).closest(Vec3::ZERO).is_none());
        assert!(sphere(1.0, 4).closest(Vec3::NAN).is_none());
        assert!(sphere(1.0, 4).closest_within(Vec3::X * 3.0, 1.0).is_none());
    }

    #[test]
    fn of_a_surface_any_part_may_be_gone() {
        let ball = || sphere(1.0, 12);
        let count = ball().triangles.len();
        let p = Vec3::new(0.1, 2.0, 0.3);
        for left in [vec![], vec![count - 1], vec![3, count - 1], vec![2, 5, 9]] {
            let gone: Vec<bool> = (0..count).map(|t| !left.contains(&t)).collect();
            let part = ball().without(&gone);
            let hit = part.closest(p);
            assert_eq!(hit.is_some(), !left.is_empty());
            assert!(hit.is_none_or(|hit| left.contains(&(hit.triangle as usize))));
            // From a triangle that is gone as from any other.
            assert_eq!(part.closest_from(p, 0), hit);
            assert_eq!(part.triangles.len(), count);
        }
    }
}
