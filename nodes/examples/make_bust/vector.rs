//! Double-precision vectors and the few blends of distance fields that the sculpture is made of.
//!
//! Guarantees: plain sums and products, no state. It is no geometry library: only what the bust needs.

use std::ops::{Add, Mul, Neg, Sub};

/// A point or direction in centimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct V {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// Short for a [`V`].
pub const fn v(x: f64, y: f64, z: f64) -> V {
    V { x, y, z }
}

impl Add for V {
    type Output = V;
    fn add(self, o: V) -> V {
        v(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}
impl Sub for V {
    type Output = V;
    fn sub(self, o: V) -> V {
        v(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
impl Mul<f64> for V {
    type Output = V;
    fn mul(self, k: f64) -> V {
        v(self.x * k, self.y * k, self.z * k)
    }
}
impl Neg for V {
    type Output = V;
    fn neg(self) -> V {
        self * -1.0
    }
}

impl V {
    pub fn dot(self, o: V) -> f64 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    pub fn cross(self, o: V) -> V {
        v(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }
    /// The direction; a zero vector stays zero.
    pub fn unit(self) -> V {
        let l = self.length();
        if l > 0.0 { self * (1.0 / l) } else { self }
    }
    /// Component by component.
    pub fn over(self, o: V) -> V {
        v(self.x / o.x, self.y / o.y, self.z / o.z)
    }
}

/// Union with a fillet of width `k`.
pub fn blend(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Intersection with a rounding of width `k`.
pub fn both(a: f64, b: f64, k: f64) -> f64 {
    -blend(-a, -b, k)
}

/// 0 below `a`, 1 above `b`, smooth between.
pub fn step(a: f64, b: f64, x: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Near-distance to an ellipsoid.
pub fn ellipsoid(p: V, centre: V, radii: V) -> f64 {
    let q = (p - centre).over(radii);
    let (l, g) = (q.length(), q.over(radii).length());
    if g < 1e-9 { -radii.x.min(radii.y).min(radii.z) } else { l * (l - 1.0) / g }
}

/// A smooth function through given values: cubic pieces, slopes from the neighbours, flat ends.
pub fn through(table: &[(f64, f64)], x: f64) -> f64 {
    let n = table.len();
    if x <= table[0].0 {
        return table[0].1;
    }
    if x >= table[n - 1].0 {
        return table[n - 1].1;
    }
    let i = table.iter().rposition(|t| t.0 <= x).unwrap_or(0).min(n - 2);
    let slope = |j: usize| {
        if j == 0 || j == n - 1 {
            0.0
        } else {
            (table[j + 1].1 - table[j - 1].1) / (table[j + 1].0 - table[j - 1].0)
        }
    };
    let w = table[i + 1].0 - table[i].0;
    let t = (x - table[i].0) / w;
    let (t2, t3) = (t * t, t * t * t);
    table[i].1 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + slope(i) * w * (t3 - 2.0 * t2 + t)
        + table[i + 1].1 * (3.0 * t2 - 2.0 * t3)
        + slope(i + 1) * w * (t3 - t2)
}

/// Distance to a chain of round cones, each point with its radius.
pub fn tube(p: V, chain: &[(V, f64)], k: f64) -> f64 {
    let mut d = 1e9;
    for w in chain.windows(2) {
        let (a, b) = (w[0].0, w[1].0);
        let ab = b - a;
        let t = ((p - a).dot(ab) / ab.dot(ab)).clamp(0.0, 1.0);
        let e = (p - a - ab * t).length() - (w[0].1 + (w[1].1 - w[0].1) * t);
        d = if k > 0.0 { blend(d, e, k) } else { d.min(e) };
    }
    d
}

/// A centripetal-like refinement of a chain: Catmull-Rom through its points, `n` pieces for each span.
pub fn refine(chain: &[(V, f64)], n: usize) -> Vec<(V, f64)> {
    let at = |i: isize| chain[i.clamp(0, chain.len() as isize - 1) as usize];
    let mut out = Vec::new();
    for i in 0..chain.len() as isize - 1 {
        let (a, b, c, d) = (at(i - 1), at(i), at(i + 1), at(i + 2));
        for j in 0..n {
            let t = j as f64 / n as f64;
            let w = [
                -0.5 * t + t * t - 0.5 * t * t * t,
                1.0 - 2.5 * t * t + 1.5 * t * t * t,
                0.5 * t + 2.0 * t * t - 1.5 * t * t * t,
                -0.5 * t * t + 0.5 * t * t * t,
            ];
            out.push((a.0 * w[0] + b.0 * w[1] + c.0 * w[2] + d.0 * w[3], b.1 + (c.1 - b.1) * t));
        }
    }
    out.push(chain[chain.len() - 1]);
    out
}
