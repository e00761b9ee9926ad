//! What the finished surface needs besides its shape: the cranium sphere's centre, materials, charts, the
//! painted hairline, the landmarks, and the bytes of the file.
//!
//! The layout of the file is told in `nodes/src/scalp/bust.rs`, which reads it.

use crate::shape::Bust;
use crate::vector::{V, step, through, v};
use std::collections::BTreeMap;

/// The finished bust.
pub struct Made {
    pub points: Vec<V>,
    pub triangles: Vec<[u32; 3]>,
    pub material: Vec<u8>,
    pub uvs: Vec<[[f64; 2]; 3]>,
    pub masks: Vec<(&'static str, Vec<f64>)>,
    pub landmarks: Vec<(&'static str, V)>,
}

/// The names in the order of their numbers.
pub const MATERIALS: [&str; 4] = ["skin", "lips", "eyes", "iris"];

/// The cranium sphere, fitted as the `head` node does: centre and radius.
pub fn cranium(points: &[V], triangles: &[[u32; 3]]) -> (V, f64) {
    let parts: Vec<(V, f64)> = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            ((a + b + c) * (1.0 / 3.0), (b - a).cross(c - a).length() / 2.0)
        })
        .collect();
    let top = points.iter().copied().fold(v(0.0, -1e9, 0.0), |m, p| if p.y > m.y { p } else { m });
    let low = points.iter().fold(1e9f64, |m, p| m.min(p.y));
    let tall = top.y - low;
    let mut sphere = sphere(parts.iter().filter(|(p, _)| {
        p.y > top.y - 0.06 * tall
            && ((p.x - top.x).powi(2) + (p.z - top.z).powi(2)).sqrt() < 0.25 * tall
    }));
    for _ in 0..100 {
        let (c, r) = sphere;
        sphere =
            self::sphere(parts.iter().filter(|(p, _)| {
                p.y > top.y - 0.9 * r && ((*p - c).length() / r - 1.0).abs() < 0.15
            }));
        if (sphere.1 - r).abs() < 1e-5 * r {
            break;
        }
    }
    sphere
}

/// Least squares of |p|^2 = 2 c.p + k, weighed by area.
fn sphere<'a>(parts: impl Iterator<Item = &'a (V, f64)>) -> (V, f64) {
    let mut m = [[0.0f64; 5]; 4];
    for (p, w) in parts {
        let row = [2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0, p.dot(*p)];
        for i in 0..4 {
            for j in 0..5 {
                m[i][j] += w * row[i] * row[j];
            }
        }
    }
    for i in 0..4 {
        let best = (i..4).max_by(|a, b| m[*a][i].abs().total_cmp(&m[*b][i].abs())).unwrap_or(i);
        m.swap(i, best);
        for j in 0..4 {
            if j != i {
                let (k, pivot) = (m[j][i] / m[i][i], m[i]);
                for (x, p) in m[j].iter_mut().zip(pivot).skip(i) {
                    *x -= k * p;
                }
            }
        }
    }
    let s = [0, 1, 2, 3].map(|i| m[i][4] / m[i][i]);
    let c = v(s[0], s[1], s[2]);
    (c, (s[3] + c.dot(c)).sqrt())
}

/// Height of the hairline above the centre, by angle from the front.
const HAIRLINE: [(f64, f64); 17] = [
    (0.0, 3.80),
    (10.0, 3.85),
    (22.0, 4.15),
    (33.0, 4.25),
    (42.0, 3.40),
    (50.0, 2.05),
    (57.0, 0.85),
    (64.0, -0.30),
    (69.0, -1.40),
    (74.0, -3.30),
    (79.0, -4.60),
    (92.0, -4.70),
    (104.0, -4.40),
    (118.0, -5.90),
    (134.0, -7.20),
    (156.0, -7.15),
    (180.0, -6.85),
];

fn hairline(p: V) -> f64 {
    p.y - through(&HAIRLINE, p.x.abs().atan2(p.z).to_degrees())
}

/// Finer edges where the mask fades. The sculpture's own coordinates: the centre of the cranium is where
/// earlier runs found it, near enough for this.
pub fn edge_length_at_hairline(p: V) -> f64 {
    if p.y < -9.0 || p.length() > 12.0 {
        return 9.0;
    }
    0.28 + 0.4 * (hairline(p - v(0.0, 0.21, -0.43)).abs() - 0.5).max(0.0)
}

/// Everything from the whole mesh; `shift` takes the sculpture's coordinates to the file's.
pub fn finish(bust: &Bust, points: Vec<V>, triangles: Vec<[u32; 3]>) -> Made {
    let (c, r) = cranium(&points, &triangles);
    println!("cranium sphere before the shift: centre {:.3} {:.3} {:.3}, r {r:.3}", c.x, c.y, c.z);
    // The sculpture is in true size; the last per mille make the radius exact.
    let k = 8.9 / r;
    let middle = v(0.0, c.y, c.z);
    let to_file = |p: V| (p - middle) * k;
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| points[i as usize]);
        (b - a).cross(c - a).unit()
    };
    let centre =
        |t: &[u32; 3]| t.iter().fold(V::default(), |s, i| s + points[*i as usize]) * (1.0 / 3.0);
    let material: Vec<u8> = triangles
        .iter()
        .map(|t| {
            // The mean of the corners' levels: corners on the border line count for nothing.
            let mean = |f: &dyn Fn(V) -> f64| t.iter().map(|i| f(points[*i as usize])).sum::<f64>();
            if mean(&|p| bust.lip_level(p)) > 0.0 {
                1
            } else if mean(&|p| bust.eye_level(p)) > 0.0 {
                if mean(&|p| bust.iris_level(p)) > 0.0 { 3 } else { 2 }
            } else {
                0
            }
        })
        .collect();
    let (_, _, out) = Bust::ear_frame();
    let mut labels: Vec<u8> = triangles
        .iter()
        .map(|t| {
            let (p, n) = (centre(t), normal(t));
            let p = v(p.x.abs(), p.y, p.z);
            let q = to_file(p);
            let out = if centre(t).x < 0.0 { v(-out.x, out.y, out.z) } else { out };
            if bust.ear_level(p) < 0.04 {
                return if n.dot(out) > -0.1 { 3 } else { 4 };
            }
            if n.y < -0.8 && p.y < -26.5 {
                return 7;
            }
            if q.y > -0.34 * 8.9 + q.z * 0.8391 && q.length() < 1.25 * 8.9 {
                return 0;
            }
            let front = through(&[(-28.0, -4.2), (-22.0, -4.5), (-15.0, -2.2), (0.0, -1.0)], p.y);
            if p.z < front {
                return 6;
            }
            if (p - v(0.0, -13.9, 7.6)).dot(v(0.0, 0.90, 0.435)) > 0.0 { 1 } else { 5 }
        })
        .collect();
    crate::uv::smooth_labels(&triangles, &mut labels, 6);
    crate::uv::drop_islands(&triangles, &mut labels, 120);
    let axis = v(0.0, 0.766, -0.643);
    let scales = [1.0, 1.0, 1.0, 1.1, 0.8, 0.55, 0.6, 0.3];
    let middled: Vec<V> = points.iter().map(|p| to_file(*p)).collect();
    let uvs = crate::uv::unwrap(&middled, &triangles, &labels, &scales, axis);

    let mut normals = vec![V::default(); points.len()];
    for t in &triangles {
        let [a, b, c] = t.map(|i| middled[i as usize]);
        let n = (b - a).cross(c - a);
        for i in t {
            normals[*i as usize] = normals[*i as usize] + n;
        }
    }
    let hair: Vec<f64> = middled
        .iter()
        .zip(&normals)
        .zip(&points)
        .map(|((p, n), own)| {
            if p.y < -10.0 || p.length() > 1.3 * 8.9 {
                return 0.0;
            }
            let e = 1e-3;
            let f = |d: V| (hairline(*p + d) - hairline(*p - d)) / (2.0 * e);
            let g = v(f(v(e, 0.0, 0.0)), f(v(0.0, e, 0.0)), f(v(0.0, 0.0, e)));
            let n = n.unit();
            let g = (g - n * n.dot(g)).length().max(0.5);
            let off_ear = step(0.15, 0.65, bust.ear_level(*own));
            step(-0.25, 0.25, hairline(*p) / g) * off_ear
        })
        .collect();

    // Landmarks lie on the surface, found from directions and heights.
    let on = |guess: V| {
        let best = middled.iter().filter(|p| p.x >= 0.0).fold((1e9, guess), |m, p| {
            let d = (*p - guess).length();
            if d < m.0 { (d, *p) } else { m }
        });
        best.1
    };
    let middle_line = |y: f64, z: f64| {
        let d = v(0.0, y, z).unit();
        let mut t = 4.0;
        while bust.at((d * t) * (1.0 / k) + middle) < 0.0 {
            t += 0.001;
        }
        d * t
    };
    let mirror = |p: V| v(-p.x, p.y, p.z);
    // A point of the middle line at a given height.
    let at_height = |y: f64, sign: f64| {
        let (mut z, mut last) = (0.0, 0.0);
        while bust.at(v(0.0, y, z) * (1.0 / k) + middle) < 0.0 {
            last = z;
            z += sign * 0.001;
        }
        v(0.0, y, last)
    };
    let ear = on(to_file(crate::shape::EAR + v(0.4, -0.6, 0.35)));
    let temple = on(v(6.6, 0.6, 4.6));
    let low = middled
        .iter()
        .filter(|p| p.x == 0.0 && p.z > 6.0 && p.y < -10.0 && p.y > -16.0)
        .fold(v(0.0, 9.0, 0.0), |m, p| if p.y < m.y { *p } else { m });
    let landmarks = vec![
        ("hairline_front", at_height(0.43 * 8.9, 1.0)),
        ("crown", middle_line(1.0, -0.10)),
        ("nape", at_height(-0.77 * 8.9, -1.0)),
        ("ear_left", ear),
        ("ear_right", mirror(ear)),
        ("temple_left", temple),
        ("temple_right", mirror(temple)),
        ("chin", low),
    ];
    Made { points: middled, triangles, material, uvs, masks: vec![("hairline", hair)], landmarks }
}

impl Made {
    /// The file's bytes.
    pub fn bytes(&self) -> Vec<u8> {
        // Triangles go by material, so that a material is a run.
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by_key(|i| (self.material[*i], *i));
        let mut wedges: BTreeMap<(u32, [u32; 2]), u16> = BTreeMap::new();
        let mut list: Vec<(u32, [u32; 2])> = Vec::new();
        let mut corners: Vec<u16> = Vec::new();
        for i in &order {
            for k in 0..3 {
                let key = (self.triangles[*i][k], self.uvs[*i][k].map(|u| (u as f32).to_bits()));
                let n = *wedges.entry(key).or_insert_with(|| {
                    list.push(key);
                    u16::try_from(list.len() - 1).expect("fewer than 65536 wedges")
                });
                corners.push(n);
            }
        }
        let mut out = b"COIFBUST".to_vec();
        let n = |out: &mut Vec<u8>, x: usize| out.extend((x as u32).to_le_bytes());
        n(&mut out, self.points.len());
        n(&mut out, list.len());
        n(&mut out, order.len());
        n(&mut out, MATERIALS.len());
        for m in 0..MATERIALS.len() {
            n(&mut out, self.material.iter().filter(|x| usize::from(**x) == m).count());
        }
        n(&mut out, self.masks.len());
        for p in self.points.iter().chain(self.landmarks.iter().map(|l| &l.1)) {
            for x in [p.x, p.y, p.z] {
                out.extend((x as f32).to_le_bytes());
            }
        }
        for (p, uv) in &list {
            for x in [*p, uv[0], uv[1]] {
                out.extend(x.to_le_bytes());
            }
        }
        for c in corners {
            out.extend(c.to_le_bytes());
        }
        for (_, mask) in &self.masks {
            out.extend(mask.iter().map(|m| (m * 255.0).round() as u8));
        }
        out
    }
}
