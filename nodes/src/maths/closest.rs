//! Closest points of a triangle mesh, rays against it, and which side of it a point is on.
//!
//! Ties go to the lowest triangle, so that the answer has the same bits on every machine and for every tree. The side follows
//! from the pseudo-normal of the closest feature (Baerentzen and Aanaes 2005, "Signed distance computation using the angle
//! weighted pseudonormal"): exact for closed surfaces, and right near the surface of open ones. Far behind a hole the side is
//! undefined.

use super::lanes::LANES;
use super::mesh_normals::MeshNormals;
use super::triangle::{closest_on_triangle, ray_triangle};
use super::triangle_tree::{Nearby, Nearest, TriangleTree};
use glam::{Vec2, Vec3};

/// Triangles with their normals and their tree.
pub struct Surface {
    /// Vertices.
    pub points: Vec<Vec3>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Smooth vertex normals: face normals weighted by their angle at the vertex. Unit; zero if no face has area.
    pub normals: Vec<Vec3>,
    edge_normals: Vec<[Vec3; 3]>,
    /// Number of boundary vertices.
    ends: usize,
    tree: TriangleTree,
    /// For each triangle, whether it is removed; empty if none is.
    gone: Vec<bool>,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the triangle.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third corner; the first has the rest.
    pub bary: Vec2,
    /// The point itself.
    pub point: Vec3,
    /// Distance from the query point, or along the ray.
    pub distance: f32,
}

/// Query points farther off (cm) are moved closer, on the same side.
const FARAWAY: f32 = 1e5;
/// Nothing found yet.
const NONE: Nearest = (f32::MAX, u32::MAX, Vec2::ZERO, Vec3::ZERO);

impl Surface {
    /// Builds normals and tree. Triangles must refer to existing points.
    pub fn new(points: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let MeshNormals { vertices: normals, edges: edge_normals, ends } =
            MeshNormals::of(&points, &triangles);
        let tree = tree(&points, &triangles, |_| true);
        Self { points, triangles, normals, edge_normals, ends, tree, gone: vec![] }
    }

    /// The same triangles with the same indices, of which queries ignore those in `gone`.
    pub fn without(self, gone: &[bool]) -> Self {
        let tree = tree(&self.points, &self.triangles, |t| !gone[t]);
        Self { tree, gone: gone.to_vec(), ..self }
    }

    /// Whether queries ignore a triangle.
    pub fn is_gone(&self, triangle: u32) -> bool {
        self.gone.get(triangle as usize).copied().unwrap_or(false)
    }

    /// Whether a point that is outside implies the same for all points around it with no skin in between. Not so where much of
    /// the mesh is sheets, such as lashes, or the wall of a hollow: behind those, the side is that of the closest point.
    pub fn parts_in_from_out(&self) -> bool {
        self.gone.is_empty() && self.ends * SHEETS <= self.points.len()
    }

    /// Whether so many triangles intersect that a point has hundreds around it, as in a brush of crossing blades. Results there
    /// may be farther than the nearest, but do not depend on where a search begins.
    pub fn is_tangled(&self) -> bool {
        self.tree.is_tangled()
    }

    /// The three corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }

    /// Lowest and highest corner of the bounds; zeros without points.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let first = self.points.first().copied().unwrap_or_default();
        self.points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
    }

    /// The closest point of the surface to `p`; `None` without triangles or if `p` is not finite.
    pub fn closest(&self, p: Vec3) -> Option<Hit> {
        self.closest_within(p, f32::MAX)
    }

    /// The closest point, if it is within `reach`.
    pub fn closest_within(&self, p: Vec3, reach: f32) -> Option<Hit> {
        let limit = if reach < 1e18 { (reach * reach).next_up() } else { f32::MAX };
        self.search(p, limit, NONE, false)
    }

    /// A close point at bounded cost: the closest of `near` and the few triangles whose boxes are nearest. Nearly always the
    /// closest of all; among stacked layers it may be on another one.
    pub fn closest_of_few(&self, p: Vec3, near: Option<u32>) -> Option<Hit> {
        let best = near.filter(|near| !self.is_gone(*near)).map(|near| self.at_nearest(p, near));
        let limit = best.map_or(f32::MAX, |best| best.0.next_up());
        self.search(p, limit, best.unwrap_or(NONE), true)
    }

    /// The closest point of one triangle to `p`.
    fn at_nearest(&self, p: Vec3, triangle: u32) -> Nearest {
        let (bary, point) = closest_on_triangle(p, self.corners(triangle));
        (point.distance_squared(p), triangle, bary, point)
    }

    /// The same as [`Self::closest`], faster if triangle `near` is close: the result for a neighbour of `p`.
    pub fn closest_from(&self, p: Vec3, near: u32) -> Option<Hit> {
        if self.is_gone(near) || self.tree.is_tangled() {
            return self.closest(p);
        }
        let best = self.at_nearest(p, near);
        self.search(p, best.0.next_up(), best, false)
    }

    /// [`Self::closest_from`] for eight points of a ball, which walk through the tree together.
    pub(super) fn closest_of_each(
        &self,
        points: &[Vec3; LANES],
        (middle, radius): (Vec3, f32),
        near: u32,
    ) -> [Option<Hit>; LANES] {
        let is_far = middle.abs().max_element() + radius > FARAWAY;
        if self.is_gone(near) || self.tree.is_tangled() || is_far || !middle.is_finite() {
            return points.map(|p| self.closest_from(p, near));
        }
        let found = self.tree.nearest_each(points, (middle, radius), (near, self.corners(near)));
        std::array::from_fn(|lane| {
            let (d2, triangle, bary, point) = self.at_nearest(points[lane], found[lane]);
            // (Triangles of enormous size have no distance.)
            if !d2.is_finite() {
                return self.closest_from(points[lane], near);
            }
            Some(Hit { triangle, bary, point, distance: d2.sqrt() })
        })
    }

    /// The triangles one of which is closest to any point of a ball, for [`Self::closest_of`]; empty where they are not few.
    pub(super) fn nearby(&self, middle: Vec3, radius: f32) -> Nearby {
        if self.tree.is_tangled() { Nearby::default() } else { self.tree.nearby(middle, radius) }
    }

    /// Tells of each triangle of a ball that may rise above a plane (its normal, and how far along that it lies) its index, its corners and
    /// its distance from the middle of the ball, cm; false if there are more than `most`.
    pub(super) fn each_above(
        &self,
        ball: (Vec3, f32),
        plane: (Vec3, f32),
        most: usize,
        tell: impl FnMut(u32, [Vec3; 3], f32),
    ) -> bool {
        self.tree.each_above(ball, plane, most, tell)
    }

    /// The same as [`Self::closest`] for a point of a ball with this middle, of what is [near](Self::nearby) it.
    #[inline]
    pub(super) fn closest_of(&self, p: Vec3, middle: Vec3, nearby: &Nearby) -> Option<Hit> {
        let (d2, triangle, bary, point) = self.tree.nearest_of(p, middle, nearby);
        (triangle != u32::MAX).then(|| Hit { triangle, bary, point, distance: d2.sqrt() })
    }

    /// The same as [`Self::closest_within`], faster if triangle `near` is close to `p`.
    pub fn closest_within_from(&self, p: Vec3, reach: f32, near: u32) -> Option<Hit> {
        if self.is_gone(near) || self.tree.is_tangled() {
            return self.closest_within(p, reach);
        }
        let (best, limit) = (self.at_nearest(p, near), (reach * reach).next_up());
        if best.0 > limit {
            return self.search(p, limit, NONE, false);
        }
        self.search(p, best.0.next_up(), best, false)
    }

    /// A point on the same side of the triangles as `p`, at most [`FARAWAY`] from them; `None` if `p` is. From farther away all
    /// triangles are equally distant in single precision, and each would be tested.
    fn seen_from_nearer(&self, p: Vec3) -> Option<Vec3> {
        let (low, high) = self.tree.bounds()?;
        let middle = 0.5 * low + 0.5 * high;
        let size = (high - low).length();
        // (By halves: squares of such distances may overflow.)
        let off = (p - middle) / FARAWAY;
        let far = off.length() * FARAWAY;
        let most = FARAWAY.max(1e3 * size);
        (far > 1.01 * most && far.is_finite()).then(|| middle + off.normalize_or_zero() * most)
    }

    /// The better of `best` and the closest point within the squared distance `limit`.
    fn search(&self, p: Vec3, limit: f32, best: Nearest, few: bool) -> Option<Hit> {
        if !p.is_finite() {
            return None;
        }
        if p.abs().max_element() > FARAWAY
            && let Some(nearer) = self.seen_from_nearer(p)
        {
            let hit = self.search(nearer, f32::MAX, NONE, few)?;
            let distance = hit.point.distance(p);
            let is_within = distance * distance <= limit || limit == f32::MAX;
            return is_within.then_some(Hit { distance, ..hit });
        }
        let (d2, triangle, bary, point) = self.tree.nearest(p, limit, best, few);
        (triangle != u32::MAX && d2 <= limit).then(|| Hit {
            triangle,
            bary,
            point,
            distance: d2.sqrt(),
        })
    }

    /// The first point that the ray hits, from either side, within `reach` times `direction`. `distance` is in multiples of
    /// `direction`'s length.
    pub fn ray(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        let meets = |corners| ray_triangle(origin, direction, corners);
        let (triangle, distance, bary) = self.tree.first(origin, direction, reach, meets)?;
        Some(Hit { triangle, bary, point: origin + direction * distance, distance })
    }

    /// Whether the ray hits anything within `reach` times `direction`.
    pub fn ray_meets(&self, origin: Vec3, direction: Vec3, reach: f32) -> bool {
        self.ray_meets_again(origin, direction, reach, &mut None)
    }

    /// The same, storing the triangle that is hit in `last`: what occludes a point often occludes its neighbours, and is tested
    /// first.
    pub fn ray_meets_again(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        last: &mut Option<u32>,
    ) -> bool {
        let met = |_: u32, corners| {
            ray_triangle(origin, direction, corners).is_some_and(|(far, _)| far <= reach)
        };
        self.meets(origin, direction, reach, last, met)
    }

    /// Whether the ray hits `triangle` before all others, as in [`Self::ray`]; if not, the triangle in front is stored in `last`.
    pub fn ray_sees(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        triangle: u32,
        last: &mut Option<u32>,
    ) -> bool {
        let far = |corners| ray_triangle(origin, direction, corners).map(|(far, _)| far);
        let Some(own) = far(self.corners(triangle)).filter(|own| *own <= reach) else {
            return false;
        };
        let is_before = |other: u32, corners| {
            other != triangle && far(corners).is_some_and(|far| (far, other) < (own, triangle))
        };
        !self.is_gone(triangle) && !self.meets(origin, direction, own, last, is_before)
    }

    /// Whether any triangle is `met`, testing first those that follow `last` in the file.
    fn meets(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        last: &mut Option<u32>,
        met: impl Fn(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        if let Some(at) = *last {
            let near = at.saturating_sub(1)..self.triangles.len().min(at as usize + 4) as u32;
            let mut there = near.filter(|other| !self.is_gone(*other));
            if let Some(found) = there.find(|other| met(*other, self.corners(*other))) {
                *last = Some(found);
                return true;
            }
        }
        let found = self.tree.any(origin, direction, reach, met);
        *last = found.or(*last);
        found.is_some()
    }

    /// The point at barycentric coordinates on a triangle.
    #[inline]
    pub fn at(&self, triangle: u32, bary: Vec2) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        a + (b - a) * bary.x + (c - a) * bary.y
    }

    /// The smooth unit normal at a point of the surface.
    pub fn smooth_normal(&self, triangle: u32, bary: Vec2) -> Vec3 {
        let [a, b, c] = self.triangles[triangle as usize].map(|v| self.normals[v as usize]);
        (a * (1.0 - bary.x - bary.y) + b * bary.x + c * bary.y)
            .try_normalize()
            .unwrap_or_else(|| self.face_normal(triangle))
    }

    /// The flat unit normal of a triangle; +Y if it has no area.
    pub fn face_normal(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Y)
    }

    /// Twice the area vector of a triangle.
    pub fn area_vector(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// The distance of `p` from its closest point `hit`, negative inside. Where a mesh is open or folds into itself, as scans do,
    /// an edge or corner does not decide the side: a point that seems deep inside such a place is tested with rays.
    pub fn signed_distance(&self, p: Vec3, hit: &Hit) -> f32 {
        let distance = self.distance_by_side(p, hit);
        if distance >= 0.0 {
            return distance;
        }
        let at_edge = [1.0 - hit.bary.x - hit.bary.y, hit.bary.x, hit.bary.y];
        let doubtful =
            hit.distance > DOUBTFUL && !self.is_tangled() && at_edge.iter().any(|w| *w <= ON);
        if doubtful && !self.sees_backs(p) { hit.distance } else { distance }
    }

    /// The distance of `p` from its closest point `hit`, negative on the back of the triangle, edge or corner of the hit.
    #[inline]
    pub fn distance_by_side(&self, p: Vec3, hit: &Hit) -> f32 {
        let side = (p - hit.point).dot(self.pseudo_normal(hit));
        if side >= 0.0 { hit.distance } else { -hit.distance }
    }

    /// Whether most rays from a point hit the back of the surface first, as they do from inside.
    fn sees_backs(&self, p: Vec3) -> bool {
        const WAYS: [Vec3; 5] = [
            Vec3::new(0.31, 0.87, 0.38),
            Vec3::new(-0.83, 0.29, 0.47),
            Vec3::new(0.62, -0.41, 0.67),
            Vec3::new(-0.27, -0.58, -0.77),
            Vec3::new(0.53, 0.39, -0.75),
        ];
        const MOST: usize = WAYS.len() / 2 + 1;
        let (mut backs, mut others) = (0, 0);
        for way in WAYS {
            match self.sees_back(p, way) {
                true => backs += 1,
                false => others += 1,
            }
            if backs.max(others) == MOST {
                break;
            }
        }
        backs == MOST
    }

    /// Whether the first hit of a ray from a point is a back face.
    fn sees_back(&self, p: Vec3, way: Vec3) -> bool {
        let hit = self.ray(p, way, 1e4);
        hit.is_some_and(|hit| self.area_vector(hit.triangle).dot(way) > 0.0)
    }

    fn pseudo_normal(&self, hit: &Hit) -> Vec3 {
        let t = hit.triangle as usize;
        let weights = [1.0 - hit.bary.x - hit.bary.y, hit.bary.x, hit.bary.y];
        let zero = weights.map(|w| w <= ON);
        match zero.iter().filter(|z| **z).count() {
            0 => self.area_vector(hit.triangle),
            // Edge i runs from corner i to i + 1; the opposite corner has weight 0.
            1 => self.edge_normals[t][(zero.iter().position(|z| *z).unwrap_or(0) + 1) % 3],
            _ => {
                let corner = zero.iter().position(|z| !*z).unwrap_or(0);
                self.normals[self.triangles[t][corner] as usize]
            }
        }
    }
}

/// Weight below which a corner counts as absent.
const ON: f32 = 1e-5;
/// A mesh with one boundary vertex in so many has sheets.
const SHEETS: usize = 50;
/// Distance (cm) below which edges and corners decide the side.
const DOUBTFUL: f32 = 0.2;

/// The tree of the triangles for which `stays` is true.
fn tree(points: &[Vec3], triangles: &[[u32; 3]], stays: impl Fn(usize) -> bool) -> TriangleTree {
    let numbered = triangles.iter().zip(0u32..).filter(|(_, n)| stays(*n as usize));
    TriangleTree::new(numbered.map(|(t, n)| (n, t.map(|v| points[v as usize]))))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::maths::hash::Dice;
    use crate::maths::lanes::in_each_width;

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
    fn eight_points_of_a_ball_find_together_what_each_finds_alone() {
        let dice = Dice::new(11, 0, "balls");
        // Of strewn triangles, some are slivers, points, lie twice or on a lattice where many are as near.
        let strewn: Vec<Vec3> = (0..900)
            .map(|k| {
                let p = Vec3::from([0, 1, 2].map(|axis| 3.0 * dice.signed(k / 3, axis)));
                let size = [0.5, 1e-4, 0.0][(k / 3 % 3) as usize];
                let p = p + Vec3::from([3, 4, 5].map(|axis| size * dice.signed(k, axis)));
                if k % 5 == 0 { p.round() } else { p }
            })
            .collect();
        let mut triangles: Vec<[u32; 3]> =
            (0..300).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        triangles.extend_from_within(..100);
        let mut enormous = strewn.clone();
        enormous.iter_mut().step_by(40).for_each(|p| *p *= 1e25);
        let surfaces = [
            sphere(2.0, 12),
            Surface::new(strewn, triangles.clone()),
            Surface::new(enormous, triangles),
        ];
        for surface in surfaces {
            for id in 0..300 {
                let middle = Vec3::from([0, 1, 2].map(|axis| 3.0 * dice.signed(id, 10 + axis)));
                let radius = [0.01, 0.3, 2.0][id as usize % 3];
                let points = std::array::from_fn(|k| {
                    let way = [0, 1, 2].map(|axis| dice.signed(id, 20 + 3 * k as u64 + axis));
                    let p = middle + Vec3::from(way).clamp_length_max(1.0) * radius;
                    if k == 0 {
                        p.round().clamp(middle - 0.5 * radius, middle + 0.5 * radius)
                    } else {
                        p
                    }
                });
                let near = (id * 7 % surface.triangles.len() as u64) as u32;
                let alone = points.map(|p| surface.closest_from(p, near));
                let together =
                    in_each_width(|| surface.closest_of_each(&points, (middle, radius), near));
                assert!(
                    together.iter().all(|found| *found == alone),
                    "{id}: {together:?}, not {alone:?}"
                );
            }
        }
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
        }
    }

    /// Meshes of every kind that a tree may find hard, by name.
    fn hard_meshes() -> Vec<(&'static str, Surface)> {
        let dice = Dice::new(11, 0, "mesh");
        let at = |id: u64, k: u64| Vec3::from([0, 1, 2].map(|axis| dice.signed(id, 3 * k + axis)));
        let of = |triangles: Vec<[Vec3; 3]>| {
            let numbers = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
            Surface::new(triangles.concat(), numbers.collect())
        };
        let scaled = |by: f32| {
            let ball = sphere(1.0, 10);
            Surface::new(ball.points.iter().map(|p| *p * by).collect(), ball.triangles)
        };
        let folded = {
            let ball = sphere(1.0, 16);
            let fold = |p: &Vec3| {
                let (sin, _) = crate::maths::transcendental::sin_cos_turns(4.0 * p.x);
                *p * (1.0 + 0.4 * sin)
            };
            Surface::new(ball.points.iter().map(fold).collect(), ball.triangles)
        };
        let bust = crate::scalp::bust::adult();
        let ball = sphere(1.0, 8);
        let layers = |count: u32, step: f32| {
            let n = ball.points.len() as u32;
            let points = (0..count).flat_map(|k| {
                let larger = 1.0 + step * k as f32;
                ball.points.iter().map(move |p| *p * larger)
            });
            let triangles =
                (0..count).flat_map(|k| ball.triangles.iter().map(move |t| t.map(|v| v + k * n)));
            Surface::new(points.collect(), triangles.collect())
        };
        vec![
            ("built-in head", Surface::new(bust.points, bust.triangles)),
            ("tiny", scaled(1e-4)),
            ("huge", scaled(1e5)),
            ("folded", folded),
            ("hollow", layers(2, -0.05)),
            ("many layers on one spot", layers(12, 0.0)),
            ("strewn", of((0..600).map(|id| [at(id, 0), at(id, 1), at(id, 2)]).collect())),
            (
                "slivers",
                of((0..600)
                    .map(|id| [at(id, 0), at(id, 0) + Vec3::Y, at(id, 0) + at(id, 1) * 1e-4])
                    .collect()),
            ),
            ("a plane", of(vec![[Vec3::ZERO, Vec3::X, Vec3::Z], [Vec3::X, Vec3::ONE, Vec3::Z]])),
            ("one triangle", of(vec![[Vec3::ZERO, Vec3::X, Vec3::Z]])),
        ]
    }

    /// `closest` and `closest_from` find what looking at every triangle finds, to the bit, and a ray the first of all that it meets.
    fn check_every_triangle(name: &str, surface: &Surface, count: u64) {
        let dice = Dice::new(12, 0, "query");
        let (low, high) = surface.bounds();
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let numbers = 0..surface.triangles.len() as u32;
        for id in 0..count {
            let v = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2));
            // About the mesh, on it and near it.
            let on = surface.points[dice.below(id, 3, surface.points.len() as u32) as usize];
            let p = match id % 3 {
                0 => middle + v * half * 1.5,
                1 => on,
                _ => on + v * half * 0.05,
            };
            let brute = numbers
                .clone()
                .map(|t| (closest_on_triangle(p, surface.corners(t)).1.distance_squared(p), t))
                .min_by(|a, b| a.partial_cmp(b).unwrap())
                .unwrap();
            let hit = surface.closest(p).unwrap();
            let near = dice.below(id, 4, numbers.end);
            assert_eq!(surface.closest_from(p, near), Some(hit), "{name}: {p} from {near}");
            if surface.is_tangled() {
                assert!(hit.distance >= brute.0.sqrt(), "{name}: {p}");
                continue;
            }
            assert_eq!((hit.distance, hit.triangle), (brute.0.sqrt(), brute.1), "{name}: {p}");
            let met = numbers
                .clone()
                .filter_map(|t| Some((ray_triangle(p, v, surface.corners(t))?.0, t)))
                .min_by(|a, b| a.partial_cmp(b).unwrap());
            let ray = surface.ray(p, v, f32::MAX).map(|hit| (hit.distance, hit.triangle));
            assert_eq!(ray, met, "{name}: ray from {p} along {v}");
            assert_eq!(surface.ray_meets(p, v, f32::MAX), met.is_some());
        }
    }

    #[test]
    fn on_any_mesh_what_is_found_is_what_looking_at_every_triangle_finds() {
        for (name, surface) in hard_meshes() {
            check_every_triangle(name, &surface, 90);
        }
    }

    #[test]
    #[ignore = "long"]
    fn on_any_mesh_what_is_found_is_what_looking_at_every_triangle_finds_at_length() {
        for (name, surface) in hard_meshes() {
            check_every_triangle(name, &surface, 9000);
        }
    }

    #[test]
    fn what_few_looks_find_is_nearly_always_the_closest_and_never_nearer() {
        let bust = crate::scalp::bust::adult();
        let surface = Surface::new(bust.points, bust.triangles);
        let dice = Dice::new(13, 0, "few");
        let mut same = 0;
        for id in 0..1000 {
            let v = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2));
            let on = dice.below(id, 3, surface.points.len() as u32) as usize;
            let p = surface.points[on] + v;
            let (all, few) =
                (surface.closest(p).unwrap(), surface.closest_of_few(p, None).unwrap());
            assert!(few.distance >= all.distance, "{p}: {} {}", few.distance, all.distance);
            same += u32::from(few == all);
        }
        assert!(same > 900, "{same}");
        // From the middle of a ball of 1984 triangles all are about as near: the 32 that are looked at are no farther than a corner.
        let few = sphere(2.0, 32).closest_of_few(Vec3::ZERO, None).unwrap();
        assert!((1.98..=2.0).contains(&few.distance), "{}", few.distance);
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
    fn balls_part_in_from_out_and_strips_and_hollows_do_not() {
        let ball = sphere(9.0, 12);
        assert!(ball.parts_in_from_out());
        // 266 vertices, and with a strip of three triangles 5 more, all of them at its ends: one in 54; with two, one in 28.
        let with = |strips: u32| {
            let (mut points, mut triangles) = (ball.points.clone(), ball.triangles.clone());
            for strip in 0..strips {
                let first = points.len() as u32;
                let at = |k: u32| Vec3::new(k as f32 * 0.1, 10.0 + (k % 2) as f32, strip as f32);
                points.extend((0..5).map(at));
                triangles.extend((0..3).map(|k| [first + k, first + k + 1, first + k + 2]));
            }
            Surface::new(points, triangles)
        };
        assert!(with(1).parts_in_from_out());
        assert!(!with(2).parts_in_from_out());
        let mut gone = vec![false; ball.triangles.len()];
        gone[0] = true;
        assert!(!sphere(9.0, 12).without(&gone).parts_in_from_out());
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
