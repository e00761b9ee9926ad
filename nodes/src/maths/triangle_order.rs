//! An order of a mesh's triangles in which those that follow each other lie together.
//!
//! Each triangle has three numbers: how many edges fewer it is reached over from one triangle than from another, of three pairs that lie
//! far apart, about as axes do. A Hilbert curve through the cube of these numbers is the order.
//!
//! Guarantees: told by how triangles are joined and numbered, and by no coordinate: a mesh in another pose or unit, sculpted, or
//! rounded elsewhere has the same order. Parts that do not hang together follow each other by their lowest triangle. Not promised:
//! that neighbours in a part of many holes are near in the order.

/// Numbers of the Hilbert curve's cube, as a power of two; more edges are counted by twos, fours and so on.
const BITS: u32 = 10;
/// Ends of axes; a part's lowest triangle is one more place to count from.
const ENDS: usize = 6;
/// Not reached.
const FAR: u32 = u32::MAX;

/// The order. `beside` has the triangle over each edge of each, itself where there is none.
pub(super) fn triangle_order(beside: &[[u32; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = Vec::with_capacity(beside.len());
    let mut reached = vec![[FAR; ENDS + 1]; beside.len()];
    let mut part = vec![];
    for lowest in 0..beside.len() as u32 {
        if reached[lowest as usize][ENDS] != FAR {
            continue;
        }
        spread(beside, lowest, ENDS, &mut reached, &mut part);
        if part.len() <= 2 {
            part.sort_unstable();
            order.append(&mut part);
            continue;
        }
        // The farthest of the part; of as far ones the lowest.
        let farthest = |part: &[u32], far: &dyn Fn(u32) -> u32| {
            let far = |t: &&u32| (far(**t), std::cmp::Reverse(**t));
            part.iter().max_by_key(far).copied().unwrap_or(lowest)
        };
        // The first axis begins where the lowest triangle's farthest is, the others where the ends so far are.
        let mut begin = farthest(&part, &|t| reached[t as usize][ENDS]);
        for axis in 0..ENDS / 2 {
            spread(beside, begin, 2 * axis, &mut reached, &mut part);
            let end = farthest(&part, &|t| reached[t as usize][2 * axis]);
            spread(beside, end, 2 * axis + 1, &mut reached, &mut part);
            let nearest =
                |t: u32| reached[t as usize][..=2 * axis + 1].iter().fold(FAR, |a, b| a.min(*b));
            begin = farthest(&part, &nearest);
        }
        let most =
            part.iter().flat_map(|t| &reached[*t as usize][..ENDS]).fold(0, |a, b| a.max(*b));
        // (A difference of up to `most` either way.)
        let by = (u32::BITS + 1 - most.leading_zeros()).saturating_sub(BITS);
        let along = |t: &u32| {
            let far = reached[*t as usize];
            let cell = [0, 2, 4].map(|from| (most + far[from] - far[from + 1]) >> by);
            u64::from(hilbert(cell)) << 32 | u64::from(*t)
        };
        let mut along: Vec<u64> = part.iter().map(along).collect();
        along.sort_unstable();
        order.extend(along.into_iter().map(|one| one as u32));
    }
    order
}

/// Counts the edges from triangle `from` to all that hang together with it; these are `part`, in the order in which they are reached.
fn spread(
    beside: &[[u32; 3]],
    from: u32,
    which: usize,
    reached: &mut [[u32; ENDS + 1]],
    part: &mut Vec<u32>,
) {
    part.clear();
    part.push(from);
    reached[from as usize][which] = 0;
    let mut next = 0;
    while let Some(at) = part.get(next).copied() {
        next += 1;
        for other in beside[at as usize] {
            if reached[other as usize][which] == FAR {
                reached[other as usize][which] = reached[at as usize][which] + 1;
                part.push(other);
            }
        }
    }
}

/// How far along a Hilbert curve through 1024^3 cells a cell lies (Skilling 2004, "Programming the
/// Hilbert curve").
pub(crate) fn hilbert(mut cell: [u32; 3]) -> u32 {
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        let low = q - 1;
        for axis in 0..3 {
            if cell[axis] & q != 0 {
                cell[0] ^= low;
            } else {
                let t = (cell[0] ^ cell[axis]) & low;
                cell[0] ^= t;
                cell[axis] ^= t;
            }
        }
        q >>= 1;
    }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let mut t = 0;
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        if cell[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let [x, y, z] = cell.map(|c| c ^ t);
    (0..BITS)
        .rev()
        .fold(0, |key, bit| key << 3 | (x >> bit & 1) << 2 | (y >> bit & 1) << 1 | z >> bit & 1)
}

#[cfg(test)]
mod tests {
    use crate::maths::closest::Surface;
    use crate::maths::closest::tests::sphere;
    use glam::Vec3;

    #[test]
    fn neighbours_in_the_order_are_near_and_coordinates_do_not_count() {
        let ball = sphere(9.0, 60);
        let order = ball.order();
        let mut all = order.to_vec();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..ball.triangles.len() as u32));
        // Squares have sides of 0.47 cm and less: neighbours with an edge in common lie within that. A leap of the curve is a few
        // squares long.
        let middle = |t: u32| ball.corners(t).into_iter().sum::<Vec3>() / 3.0;
        let steps = order.windows(2).map(|w| middle(w[0]).distance(middle(w[1])));
        let mut steps: Vec<f32> = steps.collect();
        steps.sort_by(f32::total_cmp);
        let (half, most) = (steps[steps.len() / 2], steps[steps.len() * 99 / 100]);
        assert!(half < 0.5 && most < 3.0, "{half} {most}");
        let turned = ball.points.iter().map(|p| Vec3::new(p.y * 0.01, -p.x * 0.02, p.z + 170.0));
        let turned = Surface::new(turned.collect(), ball.triangles.clone());
        assert_eq!(order, turned.order());
    }

    #[test]
    fn parts_follow_each_other_by_their_lowest_triangle() {
        // Two squares of two triangles each and one alone, taken turns.
        let points = (0..11).map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0)).collect();
        let triangles = vec![[0, 1, 2], [4, 5, 6], [8, 9, 10], [2, 1, 3], [6, 5, 7]];
        assert_eq!(Surface::new(points, triangles).order(), [0, 3, 1, 4, 2]);
        assert!(Surface::new(vec![], vec![]).order().is_empty());
    }
}
