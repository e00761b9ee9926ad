//! Triangles in a tree of boxes, four to a node: the nearest to a point, the first that a ray meets.
//!
//! Guarantees: what is found is what looking at every triangle would find, whatever the tree, for rounding is allowed for and
//! ties go to the lowest triangle; a tree of `n` triangles has log4(n) levels however they lie, in heaps on one spot or
//! strewn, and two more where they are slivers; the same answers with any vectors of the processor, for boxes are compared in plain arrays that compilers turn into
//! four at a time. Not promised: few visits where very many triangles are all as near as each other. In a
//! tangle, where hundreds cross each other about each point, a search ends after [`MOST_LOOKS`] triangles: what it finds is the
//! same everywhere, but may lie farther off than the nearest.

use super::lanes::{Eight, InLanes, LANES, Simd, Vec3x8, in_lanes, ops::*, pick};
use super::triangle::{closest_on_triangle, is_airy, pieces, ray_triangle, squares_to_triangle};
use glam::{Vec2, Vec3};
use std::cell::RefCell;

/// Children per node.
const WIDE: usize = 4;
/// Size of the stack: the levels of 2^32 triangles; on each, all but one child wait.
const LEVELS: usize = 16;
const WAITING: usize = (WIDE - 1) * LEVELS + 2 * WIDE;
/// Marks of a child that is a triangle, and of a missing child.
const LEAF: u32 = 1 << 31;
const NONE: u32 = u32::MAX;
/// Rounding of a distance, relative to the largest coordinate.
const ROUNDING: f32 = 1e-6;

/// Triangles whose boxes are mostly empty are halved up to this many times, and in total into no more than this many additional pieces.
const HALVINGS: u32 = 4;
const MOST_PIECES: usize = 400_000;

/// A mesh is tangled if a search near it, or a ray outward from there, tests more triangles than this: on heads and dressed
/// figures, searches test five to forty and rays one to five ...
const TANGLED: usize = 150;
/// ... on average over this many samples, at this distance from a triangle relative to its side ...
const SAMPLES: usize = 64;
/// ... and this far (cm) outward, ...
const OPEN: f32 = 1e4;
const OFF: f32 = 0.1;
/// ... and searches there test this many triangles, nearest boxes first.
const MOST_LOOKS: usize = 24;
/// Limit of approximate searches elsewhere: several times what cloth takes.
const FEW: usize = 32;

/// One number per child.
type Each = [f32; WIDE];

/// Boxes of four children; missing ones are farther than everything.
struct Node {
    low: [Each; 3],
    high: [Each; 3],
    children: [u32; WIDE],
}

struct Leaf {
    corners: [Vec3; 3],
    triangle: u32,
}

/// The triangles of a surface.
pub(super) struct TriangleTree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// The largest coordinate, absolute.
    largest: f32,
    /// Largest number of triangles that a search tests.
    most: usize,
}

/// The triangles one of which is nearest to any point of a ball, those nearest to its middle first: distance (cm) from the middle, and
/// the leaf. Empty where there are more than [`FEW_NEAR`], and for balls that are farther off than they are wide: the tree is as fast.
pub(super) type Nearby = Box<[(f32, u32)]>;

/// Most triangles that are listed for a ball.
const FEW_NEAR: usize = 24;

/// Result for a point: squared distance, triangle, weights of its second and third corner, the closest point.
pub(super) type Nearest = (f32, u32, Vec2, Vec3);

/// A triangle during construction, with the centre of its box.
struct Item {
    middle: Vec3,
    low: Vec3,
    high: Vec3,
    leaf: Leaf,
}

impl TriangleTree {
    /// The tree of triangles, given by index and corners.
    pub(super) fn new(triangles: impl Iterator<Item = (u32, [Vec3; 3])>) -> Self {
        let triangles: Vec<(u32, [Vec3; 3])> = triangles.collect();
        let airy = triangles.iter().filter(|(_, corners)| is_airy(*corners)).count();
        let halvings = (0..=HALVINGS).rev().find(|n| airy * ((1 << n) - 1) <= MOST_PIECES);
        let mut items = Vec::with_capacity(triangles.len());
        for (triangle, corners) in triangles {
            pieces(corners, halvings.unwrap_or(0), &mut |[a, b, c]| {
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                let leaf = Leaf { corners, triangle };
                items.push(Item { middle: 0.5 * low + 0.5 * high, low, high, leaf });
            });
        }
        let largest = |most: f32, i: &Item| most.max(i.low.abs().max(i.high.abs()).max_element());
        let mut tree = Self {
            nodes: vec![],
            leaves: vec![],
            largest: items.iter().fold(0.0, largest),
            most: usize::MAX,
        };
        if !items.is_empty() {
            tree.leaves.reserve(items.len());
            tree.nodes.reserve(items.len() / 2);
            let mut order: Vec<Entry> =
                (0..items.len() as u32).map(|item| Entry::new(item, 0.0)).collect();
            tree.add(&items, &mut order);
            if tree.looks() > TANGLED || tree.ray_looks() > TANGLED {
                tree.most = MOST_LOOKS;
            }
        }
        tree
    }

    /// Whether searches stop before all candidates are tested: see [`TANGLED`].
    pub(super) fn is_tangled(&self) -> bool {
        self.most < usize::MAX
    }

    /// Mean number of triangles tested by a search from samples slightly off the mesh.
    fn looks(&self) -> usize {
        self.looks_at_places(|p, _, look| {
            let mut best = f32::MAX;
            let mut leaf = |_: u32, leaf: &Leaf| {
                look();
                let (_, point) = closest_on_triangle(p, leaf.corners);
                best = best.min(point.distance_squared(p));
                best
            };
            self.walk(|node| node.squares(p), &mut leaf, f32::MAX, 20 * TANGLED);
        })
    }

    /// Mean number of triangles tested by a ray outward from such a sample.
    fn ray_looks(&self) -> usize {
        self.looks_at_places(|p, out, look| {
            let look = RefCell::new(look);
            self.first(p, out, OPEN, |corners| {
                look.borrow_mut()();
                ray_triangle(p, out, corners)
            });
        })
    }

    /// Mean of `looks` over samples slightly off the mesh, each with the direction outward.
    fn looks_at_places(&self, looks: impl Fn(Vec3, Vec3, &mut dyn FnMut())) -> usize {
        let places = self.leaves.len().min(SAMPLES);
        let mut looked = 0;
        for k in 0..places {
            let [a, b, c] = self.leaves[k * self.leaves.len() / places].corners;
            let out = (b - a).cross(c - a).normalize_or_zero();
            looks((a + b + c) / 3.0 + OFF * out * (c - a).length(), out, &mut || looked += 1);
        }
        looked / places.max(1)
    }

    /// The bounds of all triangles; `None` without any.
    pub(super) fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let top = self.nodes.first()?;
        let there = || (0..WIDE).filter(|child| top.children[*child] != NONE);
        let corner = |of: &[Each; 3], child: usize| Vec3::from_array(of.map(|each| each[child]));
        let low = there().fold(Vec3::INFINITY, |low, i| low.min(corner(&top.low, i)));
        let high = there().fold(Vec3::NEG_INFINITY, |high, i| high.max(corner(&top.high, i)));
        Some((low, high))
    }

    /// Adds a node with these triangles below it; returns its index and its box.
    fn add(&mut self, items: &[Item], order: &mut [Entry]) -> (u32, [Vec3; 2]) {
        let number = self.nodes.len();
        self.nodes.push(Node {
            low: [[f32::INFINITY; WIDE]; 3],
            high: [[f32::INFINITY; WIDE]; 3],
            children: [NONE; WIDE],
        });
        let (mut child, mut all) = (0, EMPTY);
        let mut put = |tree: &mut Self, order: &mut [Entry]| {
            let Some(first) = order.first() else { return };
            let first = &items[first.item()].leaf;
            // Of identical triangles only the lowest can be found: files contain duplicate layers.
            let same = order.iter().all(|e| items[e.item()].leaf.corners == first.corners);
            let (is, [low, high]) = if same {
                let here = || order.iter().map(|e| &items[e.item()]);
                let triangle = here().map(|i| i.leaf.triangle).min().unwrap_or(first.triangle);
                tree.leaves.push(Leaf { corners: first.corners, triangle });
                let bounds = here().fold(EMPTY, |all, i| united(all, [i.low, i.high]));
                (LEAF | (tree.leaves.len() - 1) as u32, bounds)
            } else {
                tree.add(items, order)
            };
            let node = &mut tree.nodes[number];
            for axis in 0..3 {
                node.low[axis][child] = low[axis];
                node.high[axis][child] = high[axis];
            }
            node.children[child] = is;
            child += 1;
            all = united(all, [low, high]);
        };
        if order.len() <= WIDE {
            order.chunks_mut(1).for_each(|one| put(self, one));
        } else {
            let (left, right) = halves(items, order);
            for half in [left, right] {
                let (left, right) = halves(items, half);
                put(self, left);
                put(self, right);
            }
        }
        (number as u32, all)
    }

    /// The better of `best` and the triangle nearest to `p` within the squared distance `limit`; ties go to the lowest. With
    /// `few`, at most [`FEW`] are tested.
    #[inline]
    pub(super) fn nearest(&self, p: Vec3, limit: f32, mut best: Nearest, few: bool) -> Nearest {
        let rounding = self.rounding(p);
        // Nothing farther than this is tested.
        let beyond = |square: f32| {
            let far = square.sqrt() + rounding;
            far * far
        };
        let first = beyond(best.0.min(limit));
        let mut reach = first;
        self.walk(
            |node| node.squares(p),
            |_, leaf| {
                let (bary, point) = closest_on_triangle(p, leaf.corners);
                let square = point.distance_squared(p);
                let nearer = square < best.0 || (square == best.0 && leaf.triangle < best.1);
                if square <= limit && nearer {
                    best = (square, leaf.triangle, bary, point);
                    reach = beyond(square);
                }
                reach
            },
            first,
            if few { self.most.min(FEW) } else { self.most },
        );
        best
    }

    /// The triangle nearest to each of eight points of a ball (middle, radius), as [`Self::nearest`] finds it, beginning with one that
    /// is near.
    pub(super) fn nearest_each(
        &self,
        points: &[Vec3; LANES],
        ball: (Vec3, f32),
        near: (u32, [Vec3; 3]),
    ) -> [u32; LANES] {
        in_lanes(NearestEach { tree: self, points, ball, near })
    }

    /// The triangles near a ball.
    pub(super) fn nearby(&self, middle: Vec3, radius: f32) -> Nearby {
        let slack = 2.0 * radius + 4.0 * self.rounding(middle);
        let beyond = |far: f32| {
            let far = far + slack;
            far * far
        };
        let farthest = 2.0 * radius;
        let (mut nearest, mut found) = (farthest, vec![]);
        self.walk(
            |node| node.squares(middle),
            |at, leaf| {
                let (_, point) = closest_on_triangle(middle, leaf.corners);
                let far = point.distance(middle);
                nearest = nearest.min(far);
                found.push((far, at));
                // (All are looked at that may count, but for hopelessly many.)
                if found.len() > 4 * FEW_NEAR { f32::NEG_INFINITY } else { beyond(nearest) }
            },
            beyond(farthest),
            usize::MAX,
        );
        if found.len() > 4 * FEW_NEAR || nearest == farthest {
            return Box::default();
        }
        found.retain(|(far, _)| *far <= nearest + slack);
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if found.len() > FEW_NEAR { Box::default() } else { found.into() }
    }

    /// Tells of each triangle of a ball that may rise above a plane (its normal, and how far along that it lies) its index, its corners and
    /// its distance from the middle of the ball, cm; false if there are more than `most`.
    pub(super) fn each_above(
        &self,
        (middle, radius): (Vec3, f32),
        (normal, height): (Vec3, f32),
        most: usize,
        mut tell: impl FnMut(u32, [Vec3; 3], f32),
    ) -> bool {
        let (mut looks, reach) = (0, radius * radius);
        self.walk(
            |node| {
                let (mut squares, tops) = (node.squares(middle), node.tops(normal));
                for (square, top) in squares.iter_mut().zip(tops) {
                    *square = if top <= height { f32::INFINITY } else { *square };
                }
                squares
            },
            |_, leaf| {
                let (_, point) = closest_on_triangle(middle, leaf.corners);
                tell(leaf.triangle, leaf.corners, point.distance(middle));
                looks += 1;
                reach
            },
            reach,
            most,
        );
        looks < most
    }

    /// The triangle nearest to `p` of those near a ball with this middle, as [`Self::nearest`] finds it if `p` is in the ball.
    #[inline]
    pub(super) fn nearest_of(&self, p: Vec3, middle: Vec3, nearby: &[(f32, u32)]) -> Nearest {
        let rounding = self.rounding(p);
        let off = p.distance(middle) + 2.0 * rounding;
        let mut best: Nearest = (f32::MAX, u32::MAX, Vec2::ZERO, Vec3::ZERO);
        let mut reach = f32::MAX;
        for (far, leaf) in nearby {
            if *far > reach {
                break;
            }
            let leaf = &self.leaves[*leaf as usize];
            let (bary, point) = closest_on_triangle(p, leaf.corners);
            let square = point.distance_squared(p);
            if square < best.0 || (square == best.0 && leaf.triangle < best.1) {
                best = (square, leaf.triangle, bary, point);
                reach = square.sqrt() + off;
            }
        }
        best
    }

    /// Rounding of distances from `p`, cm.
    #[inline]
    fn rounding(&self, p: Vec3) -> f32 {
        ROUNDING * self.largest.max(p.abs().max_element())
    }

    /// The first triangle that a ray hits within `reach` times `direction`; ties go to the lowest: triangle, distance as a
    /// multiple of `direction`, and the weights of its second and third corner. `meets` intersects one triangle.
    #[inline]
    pub(super) fn first(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        meets: impl Fn([Vec3; 3]) -> Option<(f32, Vec2)>,
    ) -> Option<(u32, f32, Vec2)> {
        let per = per(direction);
        let mut best: Option<(u32, f32, Vec2)> = None;
        self.walk(
            |node| node.entries(origin, per),
            |_, leaf| {
                let limit = best.map_or(reach, |(_, t, _)| t);
                if let Some((t, bary)) = meets(leaf.corners)
                    && t <= limit
                    && best.is_none_or(|(triangle, at, _)| t < at || leaf.triangle < triangle)
                {
                    best = Some((leaf.triangle, t, bary));
                }
                past(best.map_or(reach, |(_, t, _)| t))
            },
            past(reach),
            self.most,
        );
        best
    }

    /// Any triangle that is `met` among those whose boxes a ray enters within `reach` times `direction`; which of several is not
    /// promised.
    #[inline]
    pub(super) fn any(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        met: impl Fn(u32, [Vec3; 3]) -> bool,
    ) -> Option<u32> {
        let per = per(direction);
        let mut any = None;
        self.walk(
            |node| node.entries(origin, per),
            |_, leaf| {
                if any.is_none() && met(leaf.triangle, leaf.corners) {
                    any = Some(leaf.triangle);
                }
                if any.is_some() { f32::NEG_INFINITY } else { past(reach) }
            },
            past(reach),
            usize::MAX,
        );
        any
    }

    /// Visits the leaves, nearest boxes first, except those farther than `reach`. `far` returns the distances of a node's
    /// children, `leaf` tests a triangle and returns the new reach; at most `most` are tested.
    #[inline(always)]
    fn walk(
        &self,
        far: impl Fn(&Node) -> Each,
        mut leaf: impl FnMut(u32, &Leaf) -> f32,
        mut reach: f32,
        most: usize,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        // Distance and child in one number, ordered by distance, since none is negative.
        let mut waiting = [0u64; WAITING];
        let (mut waits, mut looks) = (1, 0);
        while waits > 0 {
            waits -= 1;
            let (near, at) = (f32::from_bits((waiting[waits] >> 32) as u32), waiting[waits] as u32);
            if near > reach {
                continue;
            }
            if at & LEAF != 0 {
                let at = at & !LEAF;
                reach = leaf(at, &self.leaves[at as usize]);
                looks += 1;
                if looks == most {
                    return;
                }
                continue;
            }
            let node = &self.nodes[at as usize];
            let (far, mut next, mut count) = (far(node), [0u64; WIDE], 0);
            for i in 0..WIDE {
                // (NaN is tested.) No branches: which children are near is unpredictable, and a misprediction costs as much as
                // four boxes.
                #[allow(clippy::neg_cmp_op_on_partial_ord)]
                let is_near = !(far[i] > reach) & (node.children[i] != NONE);
                let entry = u64::from(far[i].to_bits()) << 32 | u64::from(node.children[i]);
                next[i] = entry * u64::from(is_near);
                count += usize::from(is_near);
            }
            if count == 0 {
                continue;
            }
            // The nearest is on top; those out of reach are above it and get overwritten.
            for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
                (next[i], next[j]) = (next[i].max(next[j]), next[i].min(next[j]));
            }
            waiting[waits..waits + WIDE].copy_from_slice(&next);
            waits += count;
        }
    }

    /// Largest number of nodes from the root to a triangle.
    #[cfg(test)]
    pub(super) fn levels(&self) -> usize {
        fn under(tree: &TriangleTree, node: u32) -> usize {
            let children = tree.nodes[node as usize].children.iter();
            let deeper = children.filter(|c| **c & LEAF == 0);
            1 + deeper.map(|c| under(tree, *c)).max().unwrap_or(0)
        }
        if self.nodes.is_empty() { 0 } else { under(self, 0) }
    }

    /// Number of nodes and triangles tested for the one nearest to `p`.
    #[cfg(test)]
    pub(super) fn visits(&self, p: Vec3) -> (usize, usize) {
        let (nodes, mut leaves) = (std::cell::Cell::new(0), 0);
        let mut best = f32::MAX;
        self.walk(
            |node| {
                nodes.set(nodes.get() + 1);
                node.squares(p)
            },
            |_, leaf| {
                leaves += 1;
                let (_, point) = closest_on_triangle(p, leaf.corners);
                best = best.min(point.distance_squared(p));
                best
            },
            f32::MAX,
            self.most,
        );
        (nodes.get(), leaves)
    }
}

/// [`TriangleTree::nearest_each`].
struct NearestEach<'a> {
    tree: &'a TriangleTree,
    points: &'a [Vec3; LANES],
    ball: (Vec3, f32),
    near: (u32, [Vec3; 3]),
}

impl InLanes for NearestEach<'_> {
    type Out = [u32; LANES];

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Out {
        let Self { tree, points, ball: (middle, radius), near: (near, corners) } = self;
        let columns = [0, 1, 2].map(|axis| Eight(std::array::from_fn(|k| points[k][axis])));
        let p = Vec3x8::load(s, &columns);
        let mut best = squares_to_triangle(p, corners);
        let mut triangles = s.splat_u32x8(near);
        let slack = radius + 2.0 * tree.rounding(middle.abs() + radius);
        let first = reach(&s.as_array_f32x8(best), slack);
        let mut far = first;
        tree.walk(
            |node| node.squares(middle),
            #[inline(always)]
            |_, leaf| {
                let square = squares_to_triangle(p, leaf.corners);
                let triangle = s.splat_u32x8(leaf.triangle);
                let nearer = square.simd_lt(best)
                    | (square.simd_eq(best) & s.simd_lt_u32x8(triangle, triangles));
                if s.any_true_mask32x8(nearer) {
                    best = pick(nearer, square, best);
                    triangles = s.select_u32x8(nearer, triangle, triangles);
                    far = reach(&s.as_array_f32x8(best), slack);
                }
                far
            },
            first,
            usize::MAX,
        );
        s.as_array_u32x8(triangles)
    }
}

/// The square of the largest distance, and a little more.
#[inline(always)]
fn reach(squares: &[f32; LANES], slack: f32) -> f32 {
    let far = squares.iter().fold(0.0, |far, square| greater(*square, far)).sqrt() + slack;
    far * far
}

/// Inverse of a ray's direction along an axis: finite, so that a ray in the face of a box is in the box.
fn per(direction: Vec3) -> [f32; 3] {
    direction.to_array().map(|x| (1.0 / x).clamp(-1e30, 1e30))
}

/// Slightly beyond `t` along a ray: boxes and triangles round differently. Never infinite, as boxes are that a ray misses.
fn past(t: f32) -> f32 {
    lesser(t + 1e-5 * t, f32::MAX)
}

/// The empty box, as its lowest and highest corner.
const EMPTY: [Vec3; 2] = [Vec3::INFINITY, Vec3::NEG_INFINITY];

/// The union of two boxes.
fn united(a: [Vec3; 2], b: [Vec3; 2]) -> [Vec3; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// An item while the tree is built: its centre along an axis as an integer with the same order, above the item's index. One number
/// is moved and compared many times as fast as the item itself.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry(u64);

impl Entry {
    fn new(item: u32, along: f32) -> Self {
        let bits = along.to_bits();
        let rising = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
        Self(u64::from(rising) << 32 | u64::from(item))
    }

    fn item(self) -> usize {
        self.0 as u32 as usize
    }
}

/// Splits the triangles in half across the longest side of the bounds of their centres.
fn halves<'a>(items: &[Item], order: &'a mut [Entry]) -> (&'a mut [Entry], &'a mut [Entry]) {
    let half = order.len() / 2;
    if half == 0 {
        return order.split_at_mut(half);
    }
    let middles = order.iter().map(|e| items[e.item()].middle);
    let [low, high] = middles.fold(EMPTY, |all, middle| united(all, [middle; 2]));
    let size = high - low;
    let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    for entry in order.iter_mut() {
        let item = entry.item();
        *entry = Entry::new(item as u32, items[item].middle[axis]);
    }
    order.select_nth_unstable(half);
    order.split_at_mut(half)
}

/// The larger of two numbers, the second if one is NaN: one instruction, where `f32::max` also tests for NaN.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, the second if one is NaN.
#[inline]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Node {
    /// Squared distance of each child from a point.
    #[inline(always)]
    fn squares(&self, p: Vec3) -> Each {
        let mut squares = [0.0; WIDE];
        for axis in 0..3 {
            let (low, high) = (&self.low[axis], &self.high[axis]);
            for (i, square) in squares.iter_mut().enumerate() {
                let off = greater(greater(low[i] - p[axis], p[axis] - high[i]), 0.0);
                *square += off * off;
            }
        }
        squares
    }

    /// How far along a direction each child reaches.
    #[inline(always)]
    fn tops(&self, way: Vec3) -> Each {
        let mut tops = [0.0; WIDE];
        for axis in 0..3 {
            let faces = if way[axis] > 0.0 { &self.high[axis] } else { &self.low[axis] };
            for (top, face) in tops.iter_mut().zip(faces) {
                *top += face * way[axis];
            }
        }
        tops
    }

    /// Where a ray enters each child, as a multiple of its direction, whose inverse ([`per`]) is given; beyond everything if it
    /// does not.
    #[inline]
    fn entries(&self, origin: Vec3, per: [f32; 3]) -> Each {
        let (mut near, mut far) = ([0.0f32; WIDE], [f32::MAX; WIDE]);
        for axis in 0..3 {
            let per = per[axis];
            let (low, high) = (&self.low[axis], &self.high[axis]);
            for i in 0..WIDE {
                let (a, b) = ((low[i] - origin[axis]) * per, (high[i] - origin[axis]) * per);
                near[i] = greater(lesser(a, b), near[i]);
                far[i] = lesser(greater(a, b), far[i]);
            }
        }
        let mut entries = near;
        for i in 0..WIDE {
            entries[i] = if near[i] > far[i] { f32::INFINITY } else { near[i] };
        }
        entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    fn of(corners: &[[Vec3; 3]]) -> TriangleTree {
        TriangleTree::new((0u32..).zip(corners.iter().copied()))
    }

    #[test]
    fn a_ray_of_any_reach_tests_no_triangle_whose_box_it_misses() {
        let dice = Dice::new(7, 0, "beside a ray");
        let corner = |i: u64, k: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(i, 3 * k + a)));
        let all: Vec<[Vec3; 3]> = (0..500).map(|i| [0, 1, 2].map(|k| corner(i, k))).collect();
        let tree = of(&all);
        for reach in [1.0, 1e30, f32::MAX, f32::INFINITY] {
            let tested = std::cell::Cell::new(0);
            let meets = |_| {
                tested.set(tested.get() + 1);
                None
            };
            tree.first(Vec3::new(3.0, 3.0, 3.0), Vec3::new(0.0, 0.6, 0.8), reach, meets);
            assert_eq!(tested.get(), 0, "{reach}");
        }
    }

    #[test]
    fn a_tree_has_no_more_levels_than_four_to_the_power_of_them_triangles_hold() {
        let dice = Dice::new(8, 0, "tree");
        let at = |id: u64, k: u64| Vec3::from([0, 1, 2].map(|axis| dice.signed(id, 3 * k + axis)));
        // 1000 triangles: 4^5 = 1024. All on one spot, strewn, and slivers.
        let spot = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1000];
        let strewn: Vec<_> = (0..1000).map(|id| [at(id, 0), at(id, 1), at(id, 2)]).collect();
        let slivers: Vec<_> =
            (0..1000).map(|id| [at(id, 0), at(id, 0) + Vec3::Y * 30.0, at(id, 1) * 1e-3]).collect();
        assert!((5..=7).contains(&of(&strewn).levels()));
        // In up to 16 pieces each: 16,384 = 4^7.
        assert!(of(&slivers).levels() <= 7);
        assert_eq!(of(&spot).levels(), 1);
    }

    #[test]
    fn on_one_spot_a_thousand_times_is_once_and_a_search_looks_at_few() {
        let spot = of(&vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1000]);
        // The root's four children are one triangle each.
        assert_eq!(spot.visits(Vec3::Z), (1, 4));
        // A field of 64 x 64 squares: from close over it, 5 to 7 levels with a few nodes each, and what lies under it.
        let corner = |x: u32, z: u32| Vec3::new(x as f32, 0.0, z as f32);
        let field: Vec<_> = (0..64 * 64)
            .flat_map(|k| {
                let (x, z) = (k % 64, k / 64);
                let [a, b] = [corner(x, z), corner(x + 1, z + 1)];
                [[a, corner(x, z + 1), b], [a, b, corner(x + 1, z)]]
            })
            .collect();
        let (nodes, leaves) = of(&field).visits(Vec3::new(20.3, 0.5, 41.6));
        assert!(nodes <= 20 && leaves <= 12, "{nodes} nodes, {leaves} triangles");
    }

    #[test]
    fn slivers_by_the_ten_thousand_make_no_more_pieces_than_a_large_mesh() {
        // Each halved four times, 50,000 of them aslant would be 800,000 pieces: 750,000 more. Three times makes 350,000 more.
        let aslant = |k: u32| {
            let at = Vec3::X * (0.01 * k as f32);
            [at, at + Vec3::new(10.0, 10.0, 10.0), at + Vec3::new(0.001, 0.0, 0.0)]
        };
        let tree = TriangleTree::new((0..50_000).map(|k| (k, aslant(k))));
        // (Some pieces of some are no slivers any more.)
        assert!((300_000..=400_000).contains(&tree.leaves.len()), "{}", tree.leaves.len());
    }

    #[test]
    fn in_a_tangle_a_search_looks_at_few() {
        let dice = Dice::new(9, 0, "tangle");
        let at = |id: u64, k: u64| {
            Vec3::from([0, 1, 2].map(|axis| 10.0 * dice.signed(id, 3 * k + axis)))
        };
        // Triangles of 10 cm all over each other in a box of 20: each holds a tenth of it in its own box.
        let soup: Vec<_> = (0..3000).map(|id| [at(id, 0), at(id, 1), at(id, 2)]).collect();
        let tree = of(&soup);
        assert!(tree.is_tangled());
        for id in 0..50 {
            let p = at(id, 9);
            let (_, looks) = tree.visits(p);
            assert!(looks <= MOST_LOOKS, "{looks}");
            let found = tree.nearest(p, f32::MAX, (f32::MAX, u32::MAX, Vec2::ZERO, p), false);
            assert!(found.1 < 3000 && found.3.distance_squared(p) == found.0);
        }
    }
}
