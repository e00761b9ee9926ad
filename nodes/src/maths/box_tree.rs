//! A bounding-volume hierarchy over boxes: which of them may something touch?
//!
//! Guarantees: every touched box is found, whatever rounding does; a query costs the number of boxes found and the logarithm of
//! all, for boxes of any size and distribution. Not promised: that every box found is touched, since a leaf holds several; any
//! order of results.

use glam::Vec3;
use std::ops::Range;

/// An axis-aligned box, as its centre and half extents.
#[derive(Clone, Copy, Debug, Default)]
pub struct Aabb {
    middle: Vec3,
    half: Vec3,
}

impl Aabb {
    /// The box between two corners, enlarged by more than tests on it may round off.
    pub fn new(low: Vec3, high: Vec3) -> Self {
        let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
        Self { middle, half: half + 1e-6 * (middle.abs() + half) }
    }
    /// Whether the two intersect.
    #[inline]
    pub fn touches(&self, other: &Self) -> bool {
        let (apart, near) = ((self.middle - other.middle).abs(), self.half + other.half);
        apart.x <= near.x && apart.y <= near.y && apart.z <= near.z
    }
}

/// A query: all points within some distance of a line segment.
#[derive(Clone, Copy, Debug)]
pub struct Rod {
    middle: Vec3,
    /// Half the vector from end to end, and its absolute value.
    way: Vec3,
    size: Vec3,
    thick: f32,
}

impl Rod {
    /// The segment from `a` to `b`, with `thick` on every side.
    pub fn new(a: Vec3, b: Vec3, thick: f32) -> Self {
        let way = 0.5 * b - 0.5 * a;
        Self { middle: 0.5 * a + 0.5 * b, way, size: way.abs(), thick }
    }
    /// Whether the segment touches the box, grown by the thickness on every side. By separating axes (Ericson, Real-Time
    /// Collision Detection, 5.3.3): no division, so axis-parallel and zero-length segments need no special case.
    #[inline]
    pub fn touches(&self, block: &Aabb) -> bool {
        let (t, h) = (block.middle - self.middle, block.half + self.thick);
        let (way, size) = (self.way, self.size);
        t.x.abs() <= h.x + size.x
            && t.y.abs() <= h.y + size.y
            && t.z.abs() <= h.z + size.z
            && (t.y * way.z - t.z * way.y).abs() <= h.y * size.z + h.z * size.y
            && (t.z * way.x - t.x * way.z).abs() <= h.z * size.x + h.x * size.z
            && (t.x * way.y - t.y * way.x).abs() <= h.x * size.y + h.y * size.x
    }
}

/// A leaf: some boxes that are close together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Index of its node; the parent of node `n` is `(n - 1) / 2`, the root is 0.
    pub node: usize,
    /// Range of its boxes in [`BoxTree::order`].
    pub boxes: Range<usize>,
}

/// The tree: each part is halved across its longest side.
#[derive(Debug)]
pub struct BoxTree {
    /// As a heap: the children of `n` are `2 n + 1` and `2 n + 2`.
    nodes: Vec<Aabb>,
    order: Vec<u32>,
}

/// Largest number of boxes in a leaf.
const FEW: usize = 8;

impl BoxTree {
    /// The tree of boxes given by their corners, which must be finite.
    pub fn new(boxes: &[(Vec3, Vec3)]) -> Self {
        let mut items: Vec<(Vec3, u32)> =
            boxes.iter().map(|(low, high)| 0.5 * *low + 0.5 * *high).zip(0..).collect();
        let mut parts = 1;
        while boxes.len().div_ceil(parts) > FEW {
            parts *= 2;
        }
        let mut nodes = vec![Aabb::default(); 2 * parts - 1];
        if !boxes.is_empty() {
            build(&mut items, boxes, &mut nodes, 0);
        }
        Self { nodes, order: items.into_iter().map(|(_, number)| number).collect() }
    }
    /// Indices of the boxes in tree order.
    pub fn order(&self) -> &[u32] {
        &self.order
    }
    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }
    /// Puts the leaves that something touches into `found`. `touches` is called with index and box of a node.
    #[inline]
    pub fn find(&self, touches: impl Fn(usize, &Aabb) -> bool, found: &mut Vec<Leaf>) {
        found.clear();
        self.walk(touches, |leaf| {
            found.push(leaf);
            true
        });
    }
    /// Whether any leaf is touched.
    #[inline]
    pub fn any(&self, touches: impl Fn(usize, &Aabb) -> bool) -> bool {
        let mut any = false;
        self.walk(touches, |_| {
            any = true;
            false
        });
        any
    }
    /// Continues while `each` returns true.
    #[inline]
    fn walk(&self, touches: impl Fn(usize, &Aabb) -> bool, mut each: impl FnMut(Leaf) -> bool) {
        if self.order.is_empty() || !touches(0, &self.nodes[0]) {
            return;
        }
        // At most one waits on each level; there are fewer than 32, since indices have 32 bits.
        let mut waiting = [(0u32, 0u32, 0u32); 32];
        let mut waits = 0;
        let mut at = (0, 0, self.order.len() as u32);
        loop {
            let (node, from, to) = at;
            if (to - from) as usize <= FEW {
                if !each(Leaf { node: node as usize, boxes: from as usize..to as usize }) {
                    return;
                }
            } else {
                let middle = from + (to - from) / 2;
                let (left, right) = ((2 * node + 1, from, middle), (2 * node + 2, middle, to));
                let touched =
                    |part: (u32, u32, u32)| touches(part.0 as usize, &self.nodes[part.0 as usize]);
                match (touched(left), touched(right)) {
                    (true, true) => {
                        (at, waiting[waits]) = (left, right);
                        waits += 1;
                        continue;
                    }
                    (true, false) => {
                        at = left;
                        continue;
                    }
                    (false, true) => {
                        at = right;
                        continue;
                    }
                    (false, false) => {}
                }
            }
            if waits == 0 {
                return;
            }
            waits -= 1;
            at = waiting[waits];
        }
    }
}

fn build(
    items: &mut [(Vec3, u32)],
    boxes: &[(Vec3, Vec3)],
    nodes: &mut [Aabb],
    node: usize,
) -> (Vec3, Vec3) {
    let none = (Vec3::MAX, Vec3::MIN);
    let corners = if items.len() <= FEW {
        items.iter().fold(none, |(low, high), (_, number)| {
            let (l, h) = boxes[*number as usize];
            (low.min(l), high.max(h))
        })
    } else {
        let (low, high) =
            items.iter().fold(none, |(low, high), (p, _)| (low.min(*p), high.max(*p)));
        let axis = (high - low).max_position();
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |a, b| {
            a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1))
        });
        let (left, right) = items.split_at_mut(middle);
        let (low, high) = build(left, boxes, nodes, 2 * node + 1);
        let (l, h) = build(right, boxes, nodes, 2 * node + 2);
        (low.min(l), high.max(h))
    };
    nodes[node] = Aabb::new(corners.0, corners.1);
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;
    use std::collections::BTreeSet;

    #[test]
    fn nothing_that_is_touched_is_left_out() {
        let dice = Dice::new(5, 0, "boxes");
        let at = |id: u64, far: f32| {
            Vec3::new(dice.signed(id, 0), dice.signed(id, 1), 0.1 * dice.signed(id, 2)) * far
        };
        for n in [0, 1, 2, 8, 9, 31, 700] {
            // Of all sizes, some flat, some of no size.
            let corner = |id: u64| {
                let side = at(id + 5000, 1.0).abs() * (id % 3) as f32;
                (at(id, 10.0), at(id, 10.0) + side)
            };
            let boxes: Vec<(Vec3, Vec3)> = (0..n).map(corner).collect();
            let tree = BoxTree::new(&boxes);
            let mut all: Vec<u32> = tree.order().to_vec();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..n as u32));
            let mut found = vec![];
            for query in 10_000..10_300 {
                let a = at(query, 12.0);
                // Every third along an axis, some a point.
                let b = match query % 3 {
                    0 => a + Vec3::X * (query % 2) as f32,
                    _ => at(query + 500, 12.0),
                };
                let rod = Rod::new(a, b, 0.05);
                tree.find(|_, block| rod.touches(block), &mut found);
                let leaves = found.iter().flat_map(|leaf| leaf.boxes.clone());
                let told: BTreeSet<u32> = leaves.map(|at| tree.order()[at]).collect();
                for (number, (low, high)) in (0..).zip(&boxes) {
                    // Steps so short that between them the line goes less far than it is thick.
                    let near = (0..=1000).any(|k| {
                        let p = a.lerp(b, k as f32 / 1000.0);
                        p.distance(p.clamp(*low, *high)) < 0.05
                    });
                    assert!(!near || told.contains(&number), "{n} {query} {number}");
                }
                assert_eq!(tree.any(|_, block| rod.touches(block)), !found.is_empty());
            }
        }
    }
}
