//! The built-in adult bust: head, neck and shoulders, used while no mesh is given.
//!
//! [`adult`] decodes a mesh that is part of the program. It is our own, modeled in code by `examples/make_bust` from
//! published averages of adult heads, and depicts no one in particular. Centimetres, Y up, +Z forward, origin at the
//! centre of the cranium sphere (radius 8.9).
//!
//! Guarantees, each with a test below: closed, manifold, one part, exactly mirror-symmetric; materials `skin`, `lips`,
//! `eyes` and `iris`; one UV tile without overlaps; a painted mask `hairline`; eight landmarks. The same bits on every
//! machine: decoding only divides and compares. Not guaranteed: vertex numbers and UVs from one version of the program
//! to the next.
//!
//! Layout of `bust.bin`, little-endian, without padding:
//! - 8 bytes `COIFBUST`; u32 counts: points, wedges, triangles, materials; u32 triangles of each material, in the order
//!   of `MATERIALS` (triangles are sorted by it); u32 masks;
//! - points, then the landmarks in the order of `LANDMARKS`: f32 x, y, z each;
//! - wedges (a point with a UV): u32 point, f32 u, f32 v;
//! - triangles: three u16 wedge numbers each, counterclockwise seen from outside;
//! - masks in the order of `MASKS`: one u8 per point, in 255ths.

use crate::data::mesh::Mesh;
use glam::{Vec2, Vec3};

const BYTES: &[u8] = include_bytes!("bust.bin");
const MATERIALS: [&str; 4] = ["skin", "lips", "eyes", "iris"];
const MASKS: [&str; 1] = ["hairline"];
const LANDMARKS: [&str; 8] = [
    "hairline_front",
    "crown",
    "nape",
    "ear_left",
    "ear_right",
    "temple_left",
    "temple_right",
    "chin",
];

/// Reads the embedded bytes. The file is part of the program, so a short one is a bug: it panics.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N);
        self.0 = rest;
        let mut bytes = [0; N];
        bytes.copy_from_slice(head);
        bytes
    }
    fn u8(&mut self) -> u8 {
        self.take::<1>()[0]
    }
    fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }
    fn count(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }
    fn float(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }
    fn point(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.float()))
    }
}

/// The counts, and a reader positioned at the first point.
fn open() -> (Reader<'static>, [usize; 3], [usize; 4], usize) {
    let mut read = Reader(BYTES);
    assert_eq!(&read.take::<8>(), b"COIFBUST", "bust.bin is not the bust");
    let counts = [(); 3].map(|()| read.count());
    assert_eq!(read.count(), MATERIALS.len(), "bust.bin has other materials");
    let runs = [(); 4].map(|()| read.count());
    let masks = read.count();
    (read, counts, runs, masks)
}

/// The built-in adult bust, in centimetres.
pub fn adult() -> Mesh {
    let (mut read, [points, wedges, triangles], runs, masks) = open();
    assert_eq!(masks, MASKS.len(), "bust.bin has other masks");
    let points: Vec<Vec3> = (0..points).map(|_| read.point()).collect();
    for _ in LANDMARKS {
        read.point();
    }
    let wedges: Vec<(u32, Vec2)> = (0..wedges)
        .map(|_| {
            let point = read.count() as u32;
            (point, Vec2::new(read.float(), read.float()))
        })
        .collect();
    let corners: Vec<[(u32, Vec2); 3]> =
        (0..triangles).map(|_| [(); 3].map(|()| wedges[usize::from(read.u16())])).collect();
    let masks = MASKS
        .iter()
        .map(|name| {
            let mask = points.iter().map(|_| f32::from(read.u8()) / 255.0).collect();
            ((*name).to_string(), mask)
        })
        .collect();
    Mesh {
        points,
        triangles: corners.iter().map(|t| t.map(|c| c.0)).collect(),
        uvs: Some(corners.iter().map(|t| t.map(|c| c.1)).collect()),
        materials: MATERIALS.map(String::from).to_vec(),
        material_of: (0u32..).zip(runs).flat_map(|(m, n)| std::iter::repeat_n(m, n)).collect(),
        masks,
        cm_per_unit: Some(1.0),
        ..Mesh::default()
    }
}

/// The bust's landmarks; left is +X, the person's own left.
pub fn landmarks() -> [(&'static str, Vec3); 8] {
    let (mut read, [points, ..], ..) = open();
    for _ in 0..points {
        read.point();
    }
    LANDMARKS.map(|name| (name, read.point()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    const R: f64 = 8.9;

    type P = [f64; 3];

    fn p(mesh: &Mesh, i: u32) -> P {
        mesh.points[i as usize].to_array().map(f64::from)
    }
    fn sub(a: P, b: P) -> P {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }
    fn dot(a: P, b: P) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    fn cross(a: P, b: P) -> P {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }
    fn len(a: P) -> f64 {
        dot(a, a).sqrt()
    }
    /// Centroid and area of each triangle.
    fn faces(mesh: &Mesh) -> Vec<(P, f64)> {
        let face = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| p(mesh, i));
            let centroid = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
            (centroid, len(cross(sub(b, a), sub(c, a))) / 2.0)
        };
        mesh.triangles.iter().map(face).collect()
    }
    fn near(what: &str, is: f64, wanted: f64) {
        println!("{what}: {is:.3} (wanted {wanted})");
        assert!((is / wanted - 1.0).abs() < 0.03, "{what}: {is}, wanted {wanted}");
    }

    /// Least squares of |p|^2 = 2 c.p + k, weighted by area.
    fn sphere(parts: &[(P, f64)]) -> (P, f64) {
        let mut m = [[0.0f64; 5]; 4];
        for (q, w) in parts {
            let row = [2.0 * q[0], 2.0 * q[1], 2.0 * q[2], 1.0, dot(*q, *q)];
            for i in 0..4 {
                for j in 0..5 {
                    m[i][j] += w * row[i] * row[j];
                }
            }
        }
        for i in 0..4 {
            let pivot = m[i];
            for (j, row) in m.iter_mut().enumerate() {
                if j != i {
                    let k = row[i] / pivot[i];
                    for l in i..5 {
                        row[l] -= k * pivot[l];
                    }
                }
            }
        }
        let [x, y, z, k] = [0, 1, 2, 3].map(|i| m[i][4] / m[i][i]);
        ([x, y, z], (k + x * x + y * y + z * z).sqrt())
    }

    /// The fit of the head frame.
    fn cranium(mesh: &Mesh) -> (P, f64) {
        let faces = faces(mesh);
        let top = mesh.points.iter().fold(Vec3::MIN, |m, q| if q.y > m.y { *q } else { m });
        let top = top.to_array().map(f64::from);
        let low = mesh.points.iter().fold(f64::MAX, |m, q| m.min(f64::from(q.y)));
        let tall = top[1] - low;
        let some = |keep: &dyn Fn(P) -> bool| -> Vec<(P, f64)> {
            faces.iter().copied().filter(|f| keep(f.0)).collect()
        };
        let (mut c, mut r) = sphere(&some(&|q| {
            q[1] > top[1] - 0.06 * tall && len([q[0] - top[0], 0.0, q[2] - top[2]]) < 0.25 * tall
        }));
        for _ in 0..100 {
            let next = sphere(&some(&|q| {
                q[1] > top[1] - 0.9 * r && (len(sub(q, c)) / r - 1.0).abs() < 0.15
            }));
            let done = (next.1 - r).abs() < 1e-5 * r;
            (c, r) = next;
            if done {
                break;
            }
        }
        (c, r)
    }

    fn edges(mesh: &Mesh) -> BTreeMap<(u32, u32), usize> {
        let mut edges = BTreeMap::new();
        for t in &mesh.triangles {
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
            }
        }
        edges
    }

    #[test]
    fn it_is_a_mesh_of_20_to_40_thousand_triangles_in_less_than_700_kb() {
        let mesh = adult();
        mesh.check().unwrap();
        println!("{} points, {} triangles", mesh.points.len(), mesh.triangles.len());
        assert!((20_000..=40_000).contains(&mesh.triangles.len()));
        assert!(BYTES.len() < 700_000);
        assert!(mesh.parts.is_empty() && mesh.notes.is_empty());
    }

    #[test]
    fn it_is_closed_manifold_and_like_a_ball() {
        let mesh = adult();
        let edges = edges(&mesh);
        for ((a, b), n) in &edges {
            assert_eq!(*n, 1, "edge {a} {b} is used twice in one direction");
            assert!(edges.contains_key(&(*b, *a)), "edge {a} {b} is open");
        }
        let (v, e, f) = (mesh.points.len(), edges.len() / 2, mesh.triangles.len());
        assert_eq!(v + f, e + 2, "not like a ball, or in several parts");
        // One fan around each point.
        let mut spokes: BTreeMap<u32, BTreeMap<u32, u32>> = BTreeMap::new();
        for t in &mesh.triangles {
            for k in 0..3 {
                spokes.entry(t[k]).or_default().insert(t[(k + 1) % 3], t[(k + 2) % 3]);
            }
        }
        for (point, next) in &spokes {
            let (&first, _) = next.first_key_value().unwrap();
            let (mut at, mut n) = (next[&first], 1);
            while at != first {
                at = next[&at];
                n += 1;
            }
            assert_eq!(n, next.len(), "two fans meet at point {point}");
        }
    }

    #[test]
    fn it_is_one_part() {
        let mesh = adult();
        let mut near: Vec<Vec<u32>> = vec![Vec::new(); mesh.points.len()];
        for (a, b) in edges(&mesh).keys() {
            near[*a as usize].push(*b);
        }
        let mut seen = BTreeSet::from([0u32]);
        let mut stack = vec![0u32];
        while let Some(a) = stack.pop() {
            stack.extend(near[a as usize].iter().filter(|b| seen.insert(**b)));
        }
        assert_eq!(seen.len(), mesh.points.len());
    }

    #[test]
    fn triangles_look_outward() {
        let mesh = adult();
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|t| dot(p(&mesh, t[0]), cross(p(&mesh, t[1]), p(&mesh, t[2]))) / 6.0)
            .sum();
        println!("volume {volume:.0} cm3");
        assert!((6_000.0..12_000.0).contains(&volume), "{volume}");
    }

    #[test]
    fn no_triangle_is_a_sliver() {
        let mesh = adult();
        for (t, (_, area)) in mesh.triangles.iter().zip(faces(&mesh)) {
            let [a, b, c] = t.map(|i| p(&mesh, i));
            let long = len(sub(a, b)).max(len(sub(b, c))).max(len(sub(c, a)));
            // Height over the longest edge, as a fraction of it.
            assert!(2.0 * area / (long * long) > 0.02, "{a:?} {b:?} {c:?}");
        }
    }

    #[test]
    fn left_and_right_mirror_each_other() {
        let mesh = adult();
        let bits = |q: Vec3, s: f32| [q.x * s + 0.0, q.y + 0.0, q.z + 0.0].map(f32::to_bits);
        let all: BTreeSet<[u32; 3]> = mesh.points.iter().map(|q| bits(*q, 1.0)).collect();
        assert_eq!(all.len(), mesh.points.len(), "two points at one place");
        for q in &mesh.points {
            assert!(all.contains(&bits(*q, -1.0)), "{q} has no twin");
        }
        let marks: BTreeMap<_, _> = landmarks().into_iter().collect();
        for pair in [("ear_left", "ear_right"), ("temple_left", "temple_right")] {
            let (l, r) = (marks[pair.0], marks[pair.1]);
            assert!(l.x > 3.0);
            assert_eq!(l, Vec3::new(-r.x, r.y, r.z));
        }
    }

    #[test]
    fn the_cranium_sphere_sits_at_the_origin_with_radius_8_9() {
        let mesh = adult();
        let (c, r) = cranium(&mesh);
        println!("centre {c:?}, r {r}");
        assert!(len(c) < 0.05, "{c:?}");
        assert!((r - R).abs() < 0.02, "{r}");
        // Area-weighted 95th percentile of the distance above the centre.
        let mut off: Vec<(f64, f64)> = faces(&mesh)
            .into_iter()
            .filter(|(q, _)| q[1] > c[1])
            .map(|(q, w)| ((len(sub(q, c)) - r).abs() / r, w))
            .collect();
        off.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = off.iter().map(|o| o.1).sum();
        let at = |share: f64| {
            let mut sum = 0.0;
            off.iter().find(|o| {
                sum += o.1;
                sum >= share * total
            })
        };
        let (p50, p95) = (at(0.5).unwrap().0, at(0.95).unwrap().0);
        println!("p50 {p50:.4}, p95 {p95:.4}");
        assert!(p95 < 0.12);
    }

    #[test]
    fn the_head_has_adult_measures() {
        let mesh = adult();
        let all: Vec<P> = mesh.points.iter().map(|q| q.to_array().map(f64::from)).collect();
        let most = |keep: &dyn Fn(P) -> bool, value: &dyn Fn(P) -> f64| {
            all.iter().filter(|q| keep(**q)).map(|q| value(*q)).fold(f64::MIN, f64::max)
        };
        let marks: BTreeMap<_, _> = landmarks().into_iter().collect();
        let crown = most(&|_| true, &|q| q[1]);
        near("head height", crown - f64::from(marks["chin"].y), 23.0);
        // Above the ears.
        near("breadth", 2.0 * most(&|q| q[1] > 0.3, &|q| q[0]), 15.5);
        let front = most(&|q| q[1] > -2.2 && q[1] < 0.5 && q[0].abs() < 0.3, &|q| q[2]);
        let back = most(&|q| q[1] > -5.0, &|q| -q[2]);
        near("length", front + back, 19.5);
        let low = -most(&|_| true, &|q| -q[1]);
        near("bust width", 2.0 * most(&|_| true, &|q| q[0]), 40.0);
        let share = R / (crown - low);
        println!("bust height {:.2}, r / height {share:.4}", crown - low);
        assert!((0.23..=0.27).contains(&share), "{share}");
        assert!((34.0..=38.0).contains(&(crown - low)));
    }

    /// Length of the outline of a plane's cut, as a tape around its convex hull would read.
    fn tape(mesh: &Mesh, height: &dyn Fn(P) -> f64) -> f64 {
        let mut cut: Vec<[f64; 2]> = Vec::new();
        for t in &mesh.triangles {
            for k in 0..3 {
                let (a, b) = (p(mesh, t[k]), p(mesh, t[(k + 1) % 3]));
                let (ha, hb) = (height(a), height(b));
                if ha < 0.0 && hb >= 0.0 {
                    let s = ha / (ha - hb);
                    let q = [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * s);
                    cut.push([q[0], q[2]]);
                }
            }
        }
        cut.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for pass in [cut.clone(), cut.into_iter().rev().collect()] {
            let start = hull.len();
            for q in pass {
                while hull.len() >= start + 2 {
                    let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                    if (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]) > 0.0 {
                        break;
                    }
                    hull.pop();
                }
                hull.push(q);
            }
            hull.pop();
        }
        let n = hull.len();
        (0..n)
            .map(|i| {
                let (a, b) = (hull[i], hull[(i + 1) % n]);
                ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])).sqrt()
            })
            .sum()
    }

    #[test]
    fn a_tape_above_the_brow_reads_56_to_58_cm() {
        // Over the brow ridge and the back of the head, above the ears; the tape tilts slightly.
        let tape = tape(&adult(), &|q| q[1] + 0.2 - 0.03 * q[2]);
        println!("circumference {tape:.2}");
        assert!((56.0..=58.0).contains(&tape), "{tape}");
    }

    #[test]
    fn ears_are_6_3_cm_high() {
        let mesh = adult();
        // What stands off the side of the head.
        let ear: Vec<P> = mesh
            .points
            .iter()
            .map(|q| q.to_array().map(f64::from))
            .filter(|q| q[0] > if q[1] < -5.5 { 7.0 } else { 7.95 })
            .filter(|q| q[1] > -9.5 && q[1] < 0.6 && q[2] > -6.0 && q[2] < 1.5)
            .collect();
        // Along the ear's own axis, which leans back by 12 degrees.
        let along = |q: &P| q[1] * 0.978 - q[2] * 0.208;
        let high = ear.iter().map(along).fold(f64::MIN, f64::max);
        let low = ear.iter().map(along).fold(f64::MAX, f64::min);
        near("ear", high - low, 6.3);
    }

    #[test]
    fn the_farthest_point_in_front_is_the_tip_of_the_nose() {
        let mesh = adult();
        let tip =
            mesh.points
                .iter()
                .map(|q| q.to_array().map(f64::from))
                .filter(|q| q[1] < -0.1 * R && q[1] > -1.2 * R)
                .filter(|q| len([q[0], 0.0, q[2]]) < 1.7 * R)
                .fold([0.0; 3], |m, q| {
                    if len([q[0], 0.0, q[2]]) > len([m[0], 0.0, m[2]]) { q } else { m }
                });
        println!("nose tip {tip:?}, {:.3} r", tip[2] / R);
        assert!(tip[0].abs() < 0.2 && (1.2..=1.4).contains(&(tip[2] / R)), "{tip:?}");
    }

    #[test]
    fn the_default_scalp_holds_580_to_650_cm2() {
        let tan40 = 0.839_099_6;
        let area: f64 = faces(&adult())
            .iter()
            .filter(|(q, _)| q[1] > -0.30 * R + q[2] * tan40)
            .filter(|(q, _)| len(*q) > 0.8 * R && len(*q) < 1.2 * R)
            .map(|f| f.1)
            .sum();
        println!("default scalp {area:.1} cm2");
        assert!((580.0..=650.0).contains(&area), "{area}");
    }

    #[test]
    fn the_painted_hairline_holds_580_to_650_cm2_and_leaves_face_and_ears_free() {
        let mesh = adult();
        let mask = &mesh.masks["hairline"];
        let area: f64 = faces(&mesh)
            .iter()
            .zip(&mesh.triangles)
            .map(|(f, t)| f.1 * t.iter().map(|i| f64::from(mask[*i as usize])).sum::<f64>() / 3.0)
            .sum();
        println!("hairline mask {area:.1} cm2");
        assert!((580.0..=650.0).contains(&area), "{area}");
        let at = |x: f32, y: f32, z: f32| {
            let d = |q: &Vec3| (*q - Vec3::new(x, y, z)).length_squared();
            let i = (0..mask.len())
                .min_by(|a, b| d(&mesh.points[*a]).total_cmp(&d(&mesh.points[*b])))
                .unwrap();
            mask[i]
        };
        assert_eq!(at(0.0, 9.0, 0.0), 1.0);
        assert_eq!(at(0.0, 0.0, -10.0), 1.0);
        assert_eq!(at(0.0, 2.8, 8.5), 0.0, "forehead");
        assert_eq!(at(0.0, -6.0, 11.0), 0.0, "nose");
        assert_eq!(at(9.5, -3.5, -2.5), 0.0, "ear");
        assert_eq!(at(0.0, -9.0, -7.0), 0.0, "neck");
    }

    #[test]
    fn the_hairline_crosses_the_midline_at_0_43_r_in_front_and_0_77_r_below_behind() {
        let mesh = adult();
        let mask = &mesh.masks["hairline"];
        // Where the mask is one half along the midline.
        let crossing = |front: bool| {
            let mut line: Vec<(f32, f32)> = (0..mask.len())
                .filter(|i| mesh.points[*i].x == 0.0 && (mesh.points[*i].z > 0.0) == front)
                .filter(|i| mesh.points[*i].y > -12.0)
                .map(|i| (mesh.points[i].y, mask[i]))
                .collect();
            line.sort_by(|a, b| b.0.total_cmp(&a.0));
            let i = line.iter().position(|l| l.1 < 0.5).unwrap();
            let (a, b) = (line[i - 1], line[i]);
            f64::from(a.0 + (b.0 - a.0) * (a.1 - 0.5) / (a.1 - b.1)) / R
        };
        let (front, nape) = (crossing(true), crossing(false));
        println!("hairline front {front:.3} r, nape {nape:.3} r");
        assert!((front - 0.43).abs() < 0.03 && (nape + 0.77).abs() < 0.03);
    }

    #[test]
    fn landmarks_lie_on_the_surface_where_their_names_say() {
        let mesh = adult();
        let marks: BTreeMap<_, _> = landmarks().into_iter().collect();
        assert_eq!(marks.len(), 8);
        for (name, m) in &marks {
            let d = mesh.points.iter().map(|q| (*q - *m).length()).fold(f32::MAX, f32::min);
            println!("{name}: {m}");
            assert!(d < 0.5, "{name} is {d} off");
        }
        let r = R as f32;
        assert!(
            (marks["hairline_front"].y - 0.43 * r).abs() < 0.05 && marks["hairline_front"].z > 0.0
        );
        assert!((marks["nape"].y + 0.77 * r).abs() < 0.05 && marks["nape"].z < 0.0);
        assert!(marks["crown"].y > 0.95 * r && marks["chin"].z > 5.0 && marks["chin"].y < -1.3 * r);
        for name in ["hairline_front", "crown", "nape", "chin"] {
            assert_eq!(marks[name].x, 0.0, "{name}");
        }
    }

    #[test]
    fn every_triangle_has_one_of_four_materials() {
        let mesh = adult();
        assert_eq!(mesh.materials, ["skin", "lips", "eyes", "iris"]);
        let mut area = [0.0; 4];
        for (f, m) in faces(&mesh).iter().zip(&mesh.material_of) {
            area[*m as usize] += f.1;
        }
        println!("skin, lips, eyes, iris: {area:.1?} cm2");
        assert!((5.0..15.0).contains(&area[1]) && (1.5..10.0).contains(&area[2]) && area[3] > 1.0);
    }

    #[test]
    fn uvs_fill_one_tile_without_overlap() {
        let mesh = adult();
        let uvs = mesh.uvs.as_ref().unwrap();
        let tri: Vec<[[f64; 2]; 3]> =
            uvs.iter().map(|t| t.map(|c| c.to_array().map(f64::from))).collect();
        let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let mut total = 0.0;
        for t in &tri {
            assert!(t.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
            assert!(turn(t[0], t[1], t[2]) > 0.0, "turned over or without area: {t:?}");
            total += turn(t[0], t[1], t[2]) / 2.0;
        }
        println!("the tile is filled to {:.0} %", total * 100.0);
        assert!(total > 0.4);
        // Two triangles overlap unless an edge of one has the other on its outer side; the tolerance is the
        // rounding of the stored coordinates.
        let apart = |s: &[[f64; 2]; 3], t: &[[f64; 2]; 3]| {
            (0..3).any(|k| {
                let (a, b) = (s[k], s[(k + 1) % 3]);
                t.iter().all(|q| turn(a, b, *q) < 1e-12)
            })
        };
        const CELLS: usize = 160;
        let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        let mut grid: Vec<Vec<usize>> = vec![Vec::new(); CELLS * CELLS];
        for (i, t) in tri.iter().enumerate() {
            let of = |k: usize, f: fn(f64, f64) -> f64| cell(f(f(t[0][k], t[1][k]), t[2][k]));
            for y in of(1, f64::min)..=of(1, f64::max) {
                for x in of(0, f64::min)..=of(0, f64::max) {
                    grid[y * CELLS + x].push(i);
                }
            }
        }
        for list in &grid {
            for (n, i) in list.iter().enumerate() {
                for j in &list[n + 1..] {
                    let (s, t) = (&tri[*i], &tri[*j]);
                    assert!(apart(s, t) || apart(t, s), "triangles {i} and {j} overlap in uv");
                }
            }
        }
    }

    #[test]
    fn uvs_on_the_scalp_stretch_little() {
        let mesh = adult();
        let uvs = mesh.uvs.as_ref().unwrap();
        let mask = &mesh.masks["hairline"];
        // Singular values of the map from the surface to the tile, by its first fundamental form.
        let mut worst: Vec<(f64, f64)> = Vec::new();
        for (t, uv) in mesh.triangles.iter().zip(uvs) {
            if t.iter().any(|i| mask[*i as usize] < 0.5) {
                continue;
            }
            let [a, b, c] = t.map(|i| p(&mesh, i));
            let (e, f) = (sub(b, a), sub(c, a));
            let area = len(cross(e, f));
            let [u, v, w] = uv.map(|q| q.to_array().map(f64::from));
            let (g, h) = ([v[0] - u[0], v[1] - u[1]], [w[0] - u[0], w[1] - u[1]]);
            let l = len(e);
            let (x, y) = (dot(f, e) / l, area / l);
            let j = [g[0] / l, (h[0] - g[0] * x / l) / y, g[1] / l, (h[1] - g[1] * x / l) / y];
            let (s, d) = (j.iter().map(|q| q * q).sum::<f64>(), j[0] * j[3] - j[1] * j[2]);
            let root = (s * s - 4.0 * d * d).max(0.0).sqrt();
            worst.push((((s + root) / (s - root).max(1e-18)).sqrt(), area));
        }
        worst.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = worst.iter().map(|q| q.1).sum();
        let mut sum = 0.0;
        let p95 = worst.iter().find(|q| {
            sum += q.1;
            sum > 0.95 * total
        });
        let p95 = p95.unwrap().0;
        println!("scalp uv stretch: p95 {p95:.2} : 1");
        assert!(p95 < 2.5, "{p95}");
    }
}
