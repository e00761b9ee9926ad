//! Triangles without any order: which points lie inside them, and how far off the nearest one is.
//!
//! Inside is where the generalised winding number is over one half (Jacobson, Kavan and Sorkine-Hornung 2013, "Robust inside-outside
//! segmentation using generalized winding numbers"), which holes leave well defined. Clusters that are far are dipoles (Barill et al.
//! 2018, "Fast winding numbers for soups and clouds"), near triangles their exact solid angles: [`Soup::winding`] is that of
//! [`Soup::winding_by_all`] to 1e-3. The nearest point is exact. All in f64, and nothing of it is coif's: what coif does about skin is
//! judged by this.

use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Triangles in a tree of boxes.
pub struct Soup {
    nodes: Vec<Node>,
    /// In the order of the tree.
    triangles: Vec<Triangle>,
    holes: Vec<Hole>,
}

struct Triangle {
    corners: [DVec3; 3],
    /// Whether its edges, from each corner to the next, are on a border, and whether its corners are.
    open: [[bool; 3]; 2],
}

/// A node of the tree: its left child follows it.
struct Node {
    low: DVec3,
    high: DVec3,
    /// Mean of the triangles by area, their sum of area vectors, and the farthest corner from the mean.
    middle: DVec3,
    area: DVec3,
    reach: f64,
    /// Triangles of a leaf.
    first: u32,
    count: u32,
    right: u32,
}

/// A closed border, in the smallest box along its own plane. The surface on which the winding number is one half spans it within.
struct Hole {
    middle: DVec3,
    axes: [DVec3; 3],
    half: [f64; 3],
}

/// What is nearest to a point.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// How far off it is.
    pub distance: f64,
    /// Number of the triangle in the tree, to begin the next search with.
    pub triangle: u32,
    /// Whether the nearest point is on an open border.
    pub on_border: bool,
}

/// Triangles of a leaf, at most.
const LEAF: usize = 4;
/// A cluster is far where it is so many times its reach away; the error falls with the square of this.
const FAR: f64 = 16.0;
/// The same where it matters only whether a point is clearly inside or outside: then winding numbers are off by 0.02.
const ROUGHLY: f64 = 2.0;

impl Soup {
    /// The triangles of a mesh; corners at the very same place are one. None where there is no triangle.
    pub fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Option<Self> {
        let (points, triangles) = welded(points, triangles);
        let mut sides: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (a, b) in triangles.iter().flat_map(sides_of) {
            *sides.entry((a.min(b), a.max(b))).or_default() += 1;
        }
        let is_open = |a: u32, b: u32| sides[&(a.min(b), a.max(b))] == 1;
        let mut ends = vec![false; points.len()];
        let mut border = vec![];
        for (a, b) in triangles.iter().flat_map(sides_of).filter(|(a, b)| is_open(*a, *b)) {
            (ends[a as usize], ends[b as usize]) = (true, true);
            border.push([a, b]);
        }
        let mut all: Vec<Triangle> = triangles
            .iter()
            .map(|t| Triangle {
                corners: t.map(|v| points[v as usize]),
                open: [
                    [is_open(t[0], t[1]), is_open(t[1], t[2]), is_open(t[2], t[0])],
                    t.map(|v| ends[v as usize]),
                ],
            })
            .filter(|t| area(&t.corners) != DVec3::ZERO)
            .collect();
        if all.is_empty() {
            return None;
        }
        let mut nodes = vec![];
        build(&mut nodes, &mut all, 0);
        Some(Self { nodes, triangles: all, holes: holes(&points, &border) })
    }

    /// How many triangles there are, and how many closed borders.
    pub fn len(&self) -> (usize, usize) {
        (self.triangles.len(), self.holes.len())
    }

    /// Whether a point is inside.
    pub fn is_inside(&self, p: DVec3) -> bool {
        let roughly = self.expanded(p, ROUGHLY);
        let winding = if (roughly - 0.5).abs() > 0.25 { roughly } else { self.expanded(p, FAR) };
        winding > 0.5
    }

    /// The winding number about a point: 1 inside, 0 outside, between them near holes.
    pub fn winding(&self, p: DVec3) -> f64 {
        self.expanded(p, FAR)
    }

    /// The same, with clusters that are so many times their reach away as dipoles.
    fn expanded(&self, p: DVec3, times: f64) -> f64 {
        let mut sum = 0.0;
        let mut stack = [0u32; 96];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let at = stack[top];
            let node = &self.nodes[at as usize];
            let to = node.middle - p;
            let far = to.length_squared();
            if far > (times * node.reach).powi(2) {
                sum += node.area.dot(to) / (far * far.sqrt());
            } else if node.count > 0 {
                let own = &self.triangles[node.first as usize..][..node.count as usize];
                sum += own.iter().map(|t| solid_angle(&t.corners, p)).sum::<f64>();
            } else {
                stack[top] = at + 1;
                stack[top + 1] = node.right;
                top += 2;
            }
        }
        sum / (4.0 * PI)
    }

    /// The winding number by the solid angles of all triangles.
    pub fn winding_by_all(&self, p: DVec3) -> f64 {
        self.triangles.iter().map(|t| solid_angle(&t.corners, p)).sum::<f64>() / (4.0 * PI)
    }

    /// What is nearest to a point. The search begins with the triangle `from`.
    pub fn nearest(&self, p: DVec3, from: u32) -> Near {
        let mut best = (f64::MAX, from, false);
        self.look(p, from, &mut best);
        let mut stack = [(0u32, 0.0f64); 96];
        stack[0] = (0, self.nodes[0].off(p));
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (at, off) = stack[top];
            if off >= best.0 {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                (node.first..node.first + node.count).for_each(|t| self.look(p, t, &mut best));
                continue;
            }
            let both = [at + 1, node.right].map(|child| (child, self.nodes[child as usize].off(p)));
            let [near, far] = if both[0].1 <= both[1].1 { both } else { [both[1], both[0]] };
            (stack[top], stack[top + 1]) = (far, near);
            top += 2;
        }
        Near { distance: best.0.sqrt(), triangle: best.1, on_border: best.2 }
    }

    /// The same by looking at all triangles.
    pub fn nearest_by_all(&self, p: DVec3) -> Near {
        let mut best = (f64::MAX, 0, false);
        (0..self.triangles.len() as u32).for_each(|t| self.look(p, t, &mut best));
        Near { distance: best.0.sqrt(), triangle: best.1, on_border: best.2 }
    }

    fn look(&self, p: DVec3, t: u32, best: &mut (f64, u32, bool)) {
        let triangle = &self.triangles[t as usize];
        let (at, on) = closest(&triangle.corners, p);
        let off = at.distance_squared(p);
        if off < best.0 {
            let on_border = match on {
                On::Face => false,
                On::Edge(k) => triangle.open[0][k],
                On::Corner(k) => triangle.open[1][k],
            };
            *best = (off, t, on_border);
        }
    }

    /// Whether a triangle is between two points. Where one is only touched, it may be.
    pub fn is_between(&self, a: DVec3, b: DVec3) -> bool {
        let (low, high) = (a.min(b), a.max(b));
        let mut stack = [0u32; 96];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let at = stack[top];
            let node = &self.nodes[at as usize];
            if node.low.cmpgt(high).any() || node.high.cmplt(low).any() {
                continue;
            }
            if node.count > 0 {
                let own = &self.triangles[node.first as usize..][..node.count as usize];
                if own.iter().any(|t| meets(&t.corners, a, b)) {
                    return true;
                }
                continue;
            }
            (stack[top], stack[top + 1]) = (at + 1, node.right);
            top += 2;
        }
        false
    }

    /// Whether a ball may reach into what spans a hole, where inside becomes outside without a triangle between.
    pub fn spans(&self, middle: DVec3, radius: f64) -> bool {
        self.holes.iter().any(|hole| {
            let to = middle - hole.middle;
            (0..3).all(|k| to.dot(hole.axes[k]).abs() <= hole.half[k] + radius)
        })
    }
}

/// Points at the very same place made one, and the triangles that keep three corners.
fn welded(points: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut known: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut own = vec![];
    let mut number = |p: &DVec3| {
        // Adding zero makes of both zeros one.
        *known.entry(p.to_array().map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
            own.push(*p);
            own.len() as u32 - 1
        })
    };
    let to: Vec<u32> = points.iter().map(&mut number).collect();
    let all = triangles.iter().map(|t| t.map(|v| to[v as usize]));
    let whole = all.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    (own, whole)
}

fn sides_of(t: &[u32; 3]) -> [(u32, u32); 3] {
    [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
}

/// Half the cross product of two edges: as long as the area, out of the front.
fn area([a, b, c]: &[DVec3; 3]) -> DVec3 {
    0.5 * (*b - *a).cross(*c - *a)
}

fn build(nodes: &mut Vec<Node>, all: &mut [Triangle], first: usize) {
    let at = nodes.len();
    let mut node = Node::of(all);
    node.first = first as u32;
    nodes.push(node);
    if all.len() <= LEAF {
        nodes[at].count = all.len() as u32;
        return;
    }
    let middle = |t: &Triangle| t.corners.iter().sum::<DVec3>() / 3.0;
    let (low, high) = all
        .iter()
        .fold((DVec3::MAX, DVec3::MIN), |(low, high), t| (low.min(middle(t)), high.max(middle(t))));
    let axis = (high - low).max_position();
    let half = all.len() / 2;
    all.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let (left, right) = all.split_at_mut(half);
    build(nodes, left, first);
    nodes[at].right = nodes.len() as u32;
    build(nodes, right, first + half);
}

impl Node {
    fn of(all: &[Triangle]) -> Self {
        let corners = || all.iter().flat_map(|t| t.corners);
        let low = corners().fold(DVec3::MAX, DVec3::min);
        let high = corners().fold(DVec3::MIN, DVec3::max);
        let (mut weight, mut sum, mut vector) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for t in all {
            let area = area(&t.corners);
            vector += area;
            weight += area.length();
            sum += area.length() * t.corners.iter().sum::<DVec3>() / 3.0;
        }
        let middle = sum / weight;
        let reach = corners().map(|p| p.distance(middle)).fold(0.0, f64::max);
        Self { low, high, middle, area: vector, reach, first: 0, count: 0, right: 0 }
    }

    /// Squared distance of a point from the box.
    fn off(&self, p: DVec3) -> f64 {
        p.distance_squared(p.clamp(self.low, self.high))
    }
}

/// Solid angle of a triangle seen from a point, positive from behind (Van Oosterom and Strackee 1983).
fn solid_angle(corners: &[DVec3; 3], p: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - p);
    let [la, lb, lc] = [a.length(), b.length(), c.length()];
    let over = a.dot(b.cross(c));
    let under = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * over.atan2(under)
}

/// Whether a triangle and the way from `from` to `to` have a point in common, to rounding.
fn meets(corners: &[DVec3; 3], from: DVec3, to: DVec3) -> bool {
    const ROUNDING: f64 = 1e-12;
    let [a, b, c] = corners.map(|corner| corner - from);
    let (way, normal) = (to - from, (b - a).cross(c - a));
    let [before, after] = [-a.dot(normal), (way - a).dot(normal)];
    if before.min(after) > ROUNDING || before.max(after) < -ROUNDING {
        return false;
    }
    let sides = [way.dot(a.cross(b)), way.dot(b.cross(c)), way.dot(c.cross(a))];
    sides.iter().all(|side| *side >= -ROUNDING) || sides.iter().all(|side| *side <= ROUNDING)
}

enum On {
    Face,
    /// From this corner to the next.
    Edge(usize),
    Corner(usize),
}

/// The point of a triangle that is closest to `p` (Ericson 2005, "Real-Time Collision Detection", 5.1.5).
fn closest([a, b, c]: &[DVec3; 3], p: DVec3) -> (DVec3, On) {
    let (ab, ac, ap) = (*b - *a, *c - *a, p - *a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, On::Corner(0));
    }
    let bp = p - *b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, On::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (*a + ab * (d1 / (d1 - d3)), On::Edge(0));
    }
    let cp = p - *c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, On::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (*a + ac * (d2 / (d2 - d6)), On::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (*b + (*c - *b) * w, On::Edge(1));
    }
    let all = va + vb + vc;
    (*a + ab * (vb / all) + ac * (vc / all), On::Face)
}

/// The closed borders, by their edges.
fn holes(points: &[DVec3], border: &[[u32; 2]]) -> Vec<Hole> {
    let mut root: Vec<u32> = (0..points.len() as u32).collect();
    fn find(root: &mut [u32], mut v: u32) -> u32 {
        while root[v as usize] != v {
            root[v as usize] = root[root[v as usize] as usize];
            v = root[v as usize];
        }
        v
    }
    for [a, b] in border {
        let (a, b) = (find(&mut root, *a), find(&mut root, *b));
        root[a.max(b) as usize] = a.min(b);
    }
    let mut loops: BTreeMap<u32, Vec<[DVec3; 2]>> = BTreeMap::new();
    for edge in border {
        let own = loops.entry(find(&mut root, edge[0])).or_default();
        own.push(edge.map(|v| points[v as usize]));
    }
    loops.into_values().map(|edges| Hole::of(&edges)).collect()
}

impl Hole {
    fn of(edges: &[[DVec3; 2]]) -> Self {
        let mean = edges.iter().flatten().sum::<DVec3>() / (2 * edges.len()) as f64;
        let across: DVec3 = edges.iter().map(|[a, b]| (*a - mean).cross(*b - mean)).sum();
        let across = across.try_normalize().unwrap_or(DVec3::Y);
        let side = across.any_orthonormal_vector();
        let axes = [across, side, across.cross(side)];
        let along = |k: usize| edges.iter().flatten().map(move |p: &DVec3| p.dot(axes[k]));
        let (mut middle, mut half) = (DVec3::ZERO, [0.0; 3]);
        for k in 0..3 {
            let (low, high) =
                (along(k).fold(f64::MAX, f64::min), along(k).fold(f64::MIN, f64::max));
            middle += axes[k] * (0.5 * (low + high));
            half[k] = 0.5 * (high - low);
        }
        Self { middle, axes, half }
    }
}
