//! The voxels just under the surface of solids: what keeps the light of the surroundings out of a head.
//!
//! The light grid takes these as opaque. They lie a cell or two deep, so that the skin itself stays open.
//! Guarantees: every voxel marked is one to two cells under a surface that casts; thin sheets (ears, thin tubes),
//! whose other side would be reached, are left out rather than marked outside themselves; no gaps where a sheet is thick.
//! Not promised: anything about meshes whose triangles face inwards.

use super::Solid;
use glam::Vec3;

/// How deep the middle of the shell lies, cells.
const DEEP: f32 = 1.5;

/// One word a voxel, x fastest: 1 in the shell, else 0. `lower` is the lower corner of the first voxel, cm.
pub(crate) fn solid_voxels(solids: &[Solid], lower: Vec3, cell: f32, size: [u32; 3]) -> Vec<u32> {
    let size = size.map(|n| n as usize);
    let mut marks = vec![0u32; size.iter().product()];
    if !(cell > 0.0 && cell.is_finite()) {
        return marks;
    }
    let inverse = 1.0 / cell;
    let index = |p: Vec3| {
        let at = ((p - lower) * inverse).to_array();
        let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < size[axis] as f32);
        let [x, y, z] = at.map(|n| n as usize);
        inside.then(|| (z * size[1] + y) * size[0] + x)
    };
    // Which ways surfaces face in a voxel, one bit for each octant.
    let mut faces = vec![0u8; marks.len()];
    for solid in solids.iter().filter(|s| s.casts) {
        samples(solid, cell, |p, n| {
            if let Some(i) = index(p) {
                faces[i] |= 1 << octant(n);
            }
        });
    }
    for solid in solids.iter().filter(|s| s.casts) {
        samples(solid, cell, |p, n| {
            let Some(i) = index(p - n * (DEEP * cell)).filter(|i| marks[*i] == 0) else { return };
            // Another side of the sheet lies on the way, or where it ends.
            let against = facing_away(n);
            let thin = [0.5, 1.0, 1.5, 2.0].into_iter().any(|depth| {
                index(p - n * (depth * cell)).is_some_and(|i| faces[i] & against != 0)
            });
            if !thin {
                marks[i] = 1;
            }
        });
    }
    marks
}

/// Bit of the octant that a direction lies in.
fn octant(n: Vec3) -> u32 {
    u32::from(n.x > 0.0) | u32::from(n.y > 0.0) << 1 | u32::from(n.z > 0.0) << 2
}

/// The octants whose middle lies more than 120 degrees from a direction.
fn facing_away(n: Vec3) -> u8 {
    let mut bits = 0;
    for o in 0..8u32 {
        let sign = |axis: u32| if o >> axis & 1 == 1 { 0.577_350_3 } else { -0.577_350_3 };
        if n.dot(Vec3::new(sign(0), sign(1), sign(2))) < -0.5 {
            bits |= 1 << o;
        }
    }
    bits
}

/// Points at most half a cell apart over every triangle, with their smooth normals.
fn samples(solid: &Solid, cell: f32, mut each: impl FnMut(Vec3, Vec3)) {
    for triangle in &solid.triangles {
        let [a, b, c] = triangle.map(|v| solid.points[v as usize]);
        let [na, nb, nc] = triangle.map(|v| solid.normals[v as usize]);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        let steps = (longest.sqrt() / (0.5 * cell)).ceil();
        if !steps.is_finite() {
            continue;
        }
        let steps = steps.clamp(1.0, 1024.0) as i32;
        // Middles of the small triangles that stand like the large one: none on its sides, so neighbours share none.
        for i in 0..steps {
            for j in 0..steps - i {
                let (u, v) =
                    ((i as f32 + 1.0 / 3.0) / steps as f32, (j as f32 + 1.0 / 3.0) / steps as f32);
                let w = 1.0 - u - v;
                each(a * w + b * u + c * v, (na * w + nb * u + nc * v).normalize_or_zero());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Material, head_solid};
    use super::*;
    use coif_nodes::data::scalp::{HeadFrame, REGION, Scalp};
    use coif_nodes::maths::closest::Surface;
    use coif_nodes::scalp::bust;

    /// An icosahedron's faces cut in four, `times` times, on a sphere.
    fn ball(radius: f32, times: usize) -> Solid {
        let mut solid = Solid::empty(Material::Clay);
        let octahedron = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let mut faces = vec![];
        for x in [0, 3] {
            for y in [1, 4] {
                for z in [2, 5] {
                    let face = [octahedron[x], octahedron[y], octahedron[z]];
                    let flip = face[0].cross(face[1]).dot(face[2]) < 0.0;
                    faces.push(if flip { [face[0], face[2], face[1]] } else { face });
                }
            }
        }
        for _ in 0..times {
            faces = faces
                .into_iter()
                .flat_map(|[a, b, c]| {
                    let m = |p: Vec3, q: Vec3| (p + q).normalize();
                    let (ab, bc, ca) = (m(a, b), m(b, c), m(c, a));
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
        for face in faces {
            let t = face.map(|p| solid.push(p * radius, p, Vec3::ONE));
            solid.triangles.push(t);
        }
        solid
    }

    fn middle(lower: Vec3, cell: f32, size: [u32; 3], i: usize) -> Vec3 {
        let i = i as u32;
        let at = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
        lower + (Vec3::from(at.map(|n| n as f32)) + 0.5) * cell
    }

    #[test]
    fn the_shell_of_a_ball_is_closed_and_one_to_two_cells_deep() {
        let (lower, cell, size) = (Vec3::splat(-10.0), 0.4, [50u32; 3]);
        for times in [2, 5] {
            let marks = solid_voxels(&[ball(8.0, times)], lower, cell, size);
            let mut count = 0;
            for (i, mark) in marks.iter().enumerate() {
                let depth = (8.0 - middle(lower, cell, size, i).length()) / cell;
                if *mark == 1 {
                    count += 1;
                    // Flat faces lie up to a cell and a half under the ball's surface where they are few.
                    let sag = if times == 2 { 1.6 } else { 0.1 };
                    assert!(depth > 0.5 && depth < 2.6 + sag, "{depth}");
                }
            }
            // The area over that of a voxel's side, for about one and a half layers.
            let area = 4.0 * std::f32::consts::PI * 7.4 * 7.4 / (cell * cell);
            assert!((1.0..2.2).contains(&(count as f32 / area)), "{count} {area}");
            // No way leads from outside to the middle: fill it.
            let mut seen = vec![false; marks.len()];
            let mut open = vec![[0usize; 3]];
            while let Some(q) = open.pop() {
                let i = (q[2] * 50 + q[1]) * 50 + q[0];
                if seen[i] || marks[i] == 1 {
                    continue;
                }
                seen[i] = true;
                for axis in 0..3 {
                    for next in [q[axis].wrapping_sub(1), q[axis] + 1] {
                        if next < 50 {
                            let mut to = q;
                            to[axis] = next;
                            open.push(to);
                        }
                    }
                }
            }
            assert!(!seen[(25 * 50 + 25) * 50 + 25], "{times}");
        }
    }

    #[test]
    fn a_thin_sheet_and_what_does_not_cast_have_no_shell() {
        let (lower, cell, size) = (Vec3::splat(-10.0), 0.4, [50u32; 3]);
        let thin = ball(0.5, 2);
        assert!(solid_voxels(&[thin], lower, cell, size).iter().all(|m| *m == 0));
        let ghost = Solid { casts: false, ..ball(8.0, 2) };
        assert!(solid_voxels(&[ghost], lower, cell, size).iter().all(|m| *m == 0));
        assert!(solid_voxels(&[], lower, 0.0, [0; 3]).is_empty());
        // A ball that lies outside, or half outside, the grid.
        let marks = solid_voxels(&[ball(8.0, 3)], Vec3::ZERO, cell, size);
        assert!(marks.contains(&1));
        assert!(
            solid_voxels(&[ball(8.0, 3)], Vec3::splat(99.0), cell, size).iter().all(|m| *m == 0)
        );
    }

    #[test]
    fn the_bust_has_a_shell_and_none_beside_its_ears() {
        let mesh = bust::adult();
        let surface = Surface::new(mesh.points, mesh.triangles);
        let region = [(REGION.to_owned(), vec![1.0; surface.points.len()])].into();
        let scalp = Scalp::new(surface, None, HeadFrame::IDENTITY, region);
        let head = head_solid(&scalp, Default::default());
        let (low, high) = scalp.surface().bounds();
        let cell = (high - low).max_element() / 96.0;
        let marks = solid_voxels(&[head], low, cell, [96; 3]);
        let skin = scalp.skin();
        let mut outside = 0;
        let mut count = 0;
        for (i, mark) in marks.iter().enumerate() {
            if *mark == 1 {
                count += 1;
                let over = skin.distance(middle(low, cell, [96; 3], i)) / cell;
                outside += usize::from(over > 0.0);
                assert!(over < 1.5, "{over} cells outside");
            }
        }
        assert!(count > 5_000, "{count}");
        assert!(outside * 100 < count, "{outside} of {count} voxels lie outside");
    }
}
