//! From the field to triangles: half the bust is cut out of a grid of tetrahedra, remeshed to the wanted
//! edge lengths, cut along the borders of the materials, and mirrored.
//!
//! Guarantees: the half is a manifold whose border lies exactly in x = 0, so the mirrored whole is closed,
//! manifold and exactly symmetric. Passes walk sorted lists: the same program gives the same mesh.

use crate::shape::Bust;
use crate::vector::{V, v};
use std::collections::HashMap;

/// Triangles under way. Dead triangles have equal corners.
pub struct Soup {
    pub points: Vec<V>,
    pub triangles: Vec<[u32; 3]>,
    around: Vec<Vec<u32>>,
}

const DEAD: [u32; 3] = [0, 0, 0];

/// Marching tetrahedra over x >= 0.
pub fn cut_out(bust: &Bust, step: f64) -> Soup {
    let (low, high) = (v(0.0, -28.6, -16.0), v(21.2, 10.6, 13.4));
    let n = |a: f64, b: f64| ((b - a) / step).ceil() as usize + 1;
    let (nx, ny, nz) = (n(low.x, high.x), n(low.y, high.y), n(low.z, high.z));
    let at = |i: usize, j: usize, k: usize| {
        v(low.x + i as f64 * step, low.y + j as f64 * step, low.z + k as f64 * step)
    };
    let mut values = vec![0.0f64; nx * ny * nz];
    let rows = nz.div_ceil(8);
    std::thread::scope(|s| {
        for (c, chunk) in values.chunks_mut(rows * nx * ny).enumerate() {
            s.spawn(move || {
                for (i, value) in chunk.iter_mut().enumerate() {
                    let i = i + c * rows * nx * ny;
                    let d = bust.at(at(i % nx, i / nx % ny, i / nx / ny));
                    *value = if d.abs() < 1e-9 { 1e-9 } else { d };
                }
            });
        }
    });
    let index = |i: usize, j: usize, k: usize| i + nx * (j + ny * k);
    let mut soup = Soup { points: Vec::new(), triangles: Vec::new(), around: Vec::new() };
    let mut made: HashMap<(u32, u32), u32> = HashMap::new();
    let orders = [[1, 2, 4], [1, 4, 2], [2, 1, 4], [2, 4, 1], [4, 1, 2], [4, 2, 1]];
    for k in 0..nz - 1 {
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let corner = |b: usize| index(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2 & 1));
                let inside = (0..8).filter(|b| values[corner(*b)] < 0.0).count();
                if inside == 0 || inside == 8 {
                    continue;
                }
                for o in orders {
                    let tet = [0, o[0], o[0] | o[1], 7].map(corner);
                    let (ins, outs): (Vec<usize>, Vec<usize>) =
                        tet.iter().partition(|c| values[**c] < 0.0);
                    let mut vertex = |a: usize, b: usize| {
                        let key = (a.min(b) as u32, a.max(b) as u32);
                        *made.entry(key).or_insert_with(|| {
                            let place = |c: usize| at(c % nx, c / nx % ny, c / nx / ny);
                            let t = (values[a] / (values[a] - values[b])).clamp(0.08, 0.92);
                            let (pa, pb) = (place(a), place(b));
                            soup.points.push(pa + (pb - pa) * t);
                            soup.points.len() as u32 - 1
                        })
                    };
                    let mut faces: Vec<[u32; 3]> = Vec::new();
                    match (ins.len(), outs.len()) {
                        (1, 3) => faces.push([0, 1, 2].map(|q| vertex(ins[0], outs[q]))),
                        (3, 1) => faces.push([0, 1, 2].map(|q| vertex(ins[q], outs[0]))),
                        (2, 2) => {
                            let (a, b) = (vertex(ins[0], outs[0]), vertex(ins[0], outs[1]));
                            let (c, d) = (vertex(ins[1], outs[1]), vertex(ins[1], outs[0]));
                            faces.push([a, b, c]);
                            faces.push([a, c, d]);
                        }
                        _ => {}
                    }
                    if faces.is_empty() {
                        continue;
                    }
                    let mid = |list: &[usize]| {
                        let sum = list
                            .iter()
                            .fold(V::default(), |s, c| s + at(c % nx, c / nx % ny, c / nx / ny));
                        sum * (1.0 / list.len() as f64)
                    };
                    let way = mid(&outs) - mid(&ins);
                    for f in faces {
                        let [a, b, c] = f.map(|q| soup.points[q as usize]);
                        let n = (b - a).cross(c - a);
                        soup.triangles.push(if n.dot(way) > 0.0 { f } else { [f[0], f[2], f[1]] });
                    }
                }
            }
        }
    }
    soup.link();
    soup.keep_largest();
    soup
}

impl Soup {
    fn link(&mut self) {
        self.around = vec![Vec::new(); self.points.len()];
        for (i, t) in self.triangles.iter().enumerate() {
            for c in t {
                self.around[*c as usize].push(i as u32);
            }
        }
    }

    /// Drops all but the largest connected part: hollows closed in between the masses are no surface.
    fn keep_largest(&mut self) {
        let mut part = vec![u32::MAX; self.points.len()];
        let mut sizes = Vec::new();
        for start in 0..self.points.len() {
            if part[start] != u32::MAX {
                continue;
            }
            let name = sizes.len() as u32;
            let (mut stack, mut count) = (vec![start], 0usize);
            part[start] = name;
            while let Some(a) = stack.pop() {
                count += 1;
                for t in &self.around[a] {
                    for c in self.triangles[*t as usize] {
                        if part[c as usize] == u32::MAX {
                            part[c as usize] = name;
                            stack.push(c as usize);
                        }
                    }
                }
            }
            sizes.push(count);
        }
        let best = (0..sizes.len()).max_by_key(|i| sizes[*i]).unwrap_or(0) as u32;
        self.triangles.retain(|t| part[t[0] as usize] == best);
        self.tidy();
        let edges = self.edges().len() as i64;
        let middle = (0..self.points.len()).filter(|i| self.on_middle(*i as u32)).count();
        println!(
            "{} parts; the largest: characteristic {}, {middle} points in the middle plane",
            sizes.len(),
            self.points.len() as i64 - edges + self.triangles.len() as i64
        );
    }

    /// Drops dead triangles and unused points.
    pub fn tidy(&mut self) {
        self.triangles.retain(|t| *t != DEAD);
        let mut name = vec![u32::MAX; self.points.len()];
        let mut points = Vec::new();
        for t in &mut self.triangles {
            for c in t {
                if name[*c as usize] == u32::MAX {
                    name[*c as usize] = points.len() as u32;
                    points.push(self.points[*c as usize]);
                }
                *c = name[*c as usize];
            }
        }
        self.points = points;
        self.link();
    }

    fn edges(&self) -> Vec<(u32, u32)> {
        let mut all: Vec<(u32, u32)> = self
            .triangles
            .iter()
            .filter(|t| **t != DEAD)
            .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        (self.points[a as usize] - self.points[b as usize]).length()
    }

    /// The triangles at an edge.
    fn sides(&self, a: u32, b: u32) -> Vec<u32> {
        self.around[a as usize]
            .iter()
            .copied()
            .filter(|t| self.triangles[*t as usize].contains(&b))
            .collect()
    }

    fn ring(&self, a: u32) -> Vec<u32> {
        let mut ring: Vec<u32> = self.around[a as usize]
            .iter()
            .flat_map(|t| self.triangles[*t as usize])
            .filter(|c| *c != a)
            .collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    fn on_middle(&self, a: u32) -> bool {
        self.points[a as usize].x == 0.0
    }

    fn normal_of(&self, t: [u32; 3]) -> V {
        let [a, b, c] = t.map(|q| self.points[q as usize]);
        (b - a).cross(c - a)
    }

    /// Puts a new vertex on the edge.
    fn split(&mut self, a: u32, b: u32, at: V) -> u32 {
        let m = self.points.len() as u32;
        self.points.push(at);
        self.around.push(Vec::new());
        for t in self.sides(a, b) {
            let old = self.triangles[t as usize];
            let new = self.triangles.len() as u32;
            self.triangles[t as usize] = old.map(|c| if c == b { m } else { c });
            self.triangles.push(old.map(|c| if c == a { m } else { c }));
            self.around[b as usize].retain(|q| *q != t);
            self.around[b as usize].push(new);
            self.around[m as usize].push(t);
            self.around[m as usize].push(new);
            for c in old {
                if c != a && c != b {
                    self.around[c as usize].push(new);
                }
            }
        }
        m
    }

    fn collapse(&mut self, a: u32, b: u32, size: &dyn Fn(V) -> f64) {
        let sides = self.sides(a, b);
        if sides.is_empty() {
            return;
        }
        let (ma, mb) = (self.on_middle(a), self.on_middle(b));
        // `a` goes, `b` stays.
        let (a, b) = if ma && !mb { (b, a) } else { (a, b) };
        if ma && mb && sides.len() != 1 {
            return;
        }
        let (ra, rb) = (self.ring(a), self.ring(b));
        if ra.iter().filter(|c| rb.contains(c)).count() != sides.len() {
            return;
        }
        if sides.len() == 2
            && (self.around[a as usize].len() <= 3 || self.around[b as usize].len() <= 3)
        {
            return;
        }
        let target = if ma == mb {
            (self.points[a as usize] + self.points[b as usize]) * 0.5
        } else {
            self.points[b as usize]
        };
        let limit = size(target) * 1.34;
        for (own, other) in [(a, b), (b, a)] {
            for t in &self.around[own as usize] {
                let old = self.triangles[*t as usize];
                if old.contains(&other) {
                    continue;
                }
                let q = old.map(|c| if c == own { target } else { self.points[c as usize] });
                let (was, now) = (self.normal_of(old), (q[1] - q[0]).cross(q[2] - q[0]));
                if was.unit().dot(now.unit()) < 0.55 {
                    return;
                }
                let longest = (0..3).map(|i| (q[i] - q[(i + 1) % 3]).length()).fold(0.0, f64::max);
                if longest > limit || now.length() < 0.04 * longest * longest {
                    return;
                }
            }
        }
        for t in sides {
            for c in self.triangles[t as usize] {
                self.around[c as usize].retain(|q| *q != t);
            }
            self.triangles[t as usize] = DEAD;
        }
        for t in std::mem::take(&mut self.around[a as usize]) {
            self.triangles[t as usize] =
                self.triangles[t as usize].map(|c| if c == a { b } else { c });
            self.around[b as usize].push(t);
        }
        self.points[b as usize] = target;
    }

    fn flip(&mut self, a: u32, b: u32) {
        let sides = self.sides(a, b);
        if sides.len() != 2 {
            return;
        }
        let apex = |t: u32| self.triangles[t as usize].into_iter().find(|c| *c != a && *c != b);
        let (Some(mut c), Some(mut d)) = (apex(sides[0]), apex(sides[1])) else { return };
        let first = self.triangles[sides[0] as usize];
        // In `first` the edge runs a to b or b to a.
        let i = first.iter().position(|q| *q == a).unwrap_or(0);
        if first[(i + 1) % 3] != b {
            std::mem::swap(&mut c, &mut d);
        }
        if self.around[a as usize].len() <= 3
            || self.around[b as usize].len() <= 3
            || !self.sides(c, d).is_empty()
        {
            return;
        }
        let p = |q: u32| self.points[q as usize];
        let angle = |o: u32| {
            let (s, t) = ((p(a) - p(o)).unit(), (p(b) - p(o)).unit());
            s.dot(t).clamp(-1.0, 1.0).acos()
        };
        if angle(c) + angle(d) < std::f64::consts::PI + 1e-6 {
            return;
        }
        let (n0, n1) = (self.normal_of([a, b, c]), self.normal_of([b, a, d]));
        let (m0, m1) = (self.normal_of([a, d, c]), self.normal_of([d, b, c]));
        let mean = (n0 + n1).unit();
        // Folds stay: a flip may not turn a face away from both old ones.
        if m0.unit().dot(mean) < 0.7 || m1.unit().dot(mean) < 0.7 || n0.unit().dot(n1.unit()) < 0.6
        {
            return;
        }
        let (t0, t1) = (sides[0], sides[1]);
        self.triangles[t0 as usize] = [a, d, c];
        self.triangles[t1 as usize] = [d, b, c];
        for q in [a, b, c, d] {
            self.around[q as usize].retain(|t| *t != t0 && *t != t1);
        }
        for (t, f) in [(t0, [a, d, c]), (t1, [d, b, c])] {
            for q in f {
                self.around[q as usize].push(t);
            }
        }
    }

    /// Brings every edge near the wanted length, on the surface.
    pub fn remesh(&mut self, bust: &Bust, size: &dyn Fn(V) -> f64, rounds: usize) {
        for round in 0..rounds {
            let want = |s: &Soup, a: u32, b: u32| {
                size((s.points[a as usize] + s.points[b as usize]) * 0.5)
            };
            for (a, b) in self.edges() {
                if self.length(a, b) > 1.34 * want(self, a, b) && !self.sides(a, b).is_empty() {
                    let at = (self.points[a as usize] + self.points[b as usize]) * 0.5;
                    self.split(a, b, at);
                }
            }
            let mut short: Vec<(u64, u32, u32)> = self
                .edges()
                .into_iter()
                .map(|(a, b)| ((self.length(a, b) / want(self, a, b) * 1e6) as u64, a, b))
                .filter(|e| e.0 < 800_000)
                .collect();
            short.sort_unstable();
            for (_, a, b) in short {
                if self.length(a, b) < 0.8 * want(self, a, b) {
                    self.collapse(a, b, size);
                }
            }
            for _ in 0..2 {
                for (a, b) in self.edges() {
                    self.flip(a, b);
                }
            }
            self.tidy();
            for _ in 0..if round + 1 == rounds { 4 } else { 2 } {
                self.relax(bust, size, &[]);
            }
        }
        for _ in 0..2 {
            for (a, b) in self.edges() {
                self.flip(a, b);
            }
        }
        self.tidy();
    }

    /// Evens out the triangles beside the borders once more; what `held` names stays.
    pub fn ease(&mut self, bust: &Bust, size: &dyn Fn(V) -> f64, held: &dyn Fn(V) -> bool) {
        let held: Vec<bool> = self.points.iter().map(|p| held(*p)).collect();
        for _ in 0..3 {
            self.relax(bust, size, &held);
        }
    }

    fn relax(&mut self, bust: &Bust, size: &dyn Fn(V) -> f64, held: &[bool]) {
        let mut moved = self.points.clone();
        let chunk = moved.len().div_ceil(8);
        let me = &*self;
        // The size function is cheap but not shared between threads: weigh by it up front.
        let weight: Vec<f64> = me.points.iter().map(|p| 1.0 / size(*p).max(1e-3)).collect();
        let weight = &weight;
        std::thread::scope(|s| {
            for (c, part) in moved.chunks_mut(chunk).enumerate() {
                s.spawn(move || {
                    for (i, m) in part.iter_mut().enumerate() {
                        let i = (c * chunk + i) as u32;
                        if held.get(i as usize).is_some_and(|h| *h) {
                            continue;
                        }
                        let p = me.points[i as usize];
                        let middle = me.on_middle(i);
                        let (mut sum, mut total) = (V::default(), 0.0);
                        for q in me.ring(i) {
                            if middle && !(me.on_middle(q) && me.sides(i, q).len() == 1) {
                                continue;
                            }
                            let w = weight[q as usize] * weight[q as usize];
                            sum = sum + me.points[q as usize] * w;
                            total += w;
                        }
                        if total == 0.0 {
                            continue;
                        }
                        let n = bust.normal(p);
                        let go = sum * (1.0 / total) - p;
                        let go = go - n * n.dot(go);
                        let mut q = p + go * 0.6;
                        if middle {
                            q.x = 0.0;
                        } else {
                            q.x = q.x.max(p.x * 0.4);
                        }
                        q = settle(bust, q);
                        // A jump to another sheet of the surface is refused.
                        if (q - p).length() < 1.5 / weight[i as usize] {
                            *m = q;
                        }
                    }
                });
            }
        });
        self.points = moved;
    }

    /// Splits the triangles along the zero line of `level`, so that no triangle lies on both sides; a vertex
    /// nearer than `reach` of an edge moves instead.
    pub fn cut_along(&mut self, bust: &Bust, reach: f64, level: &dyn Fn(V) -> f64) {
        // Vertices near the line move on to it; the other crossed edges get a vertex.
        let mut on: Vec<bool> = vec![false; self.points.len()];
        let root = |a: V, b: V| {
            let (mut lo, mut hi) = (0.0, 1.0);
            let sign = level(a) > 0.0;
            for _ in 0..30 {
                let m = (lo + hi) / 2.0;
                if (level(a + (b - a) * m) > 0.0) == sign { lo = m } else { hi = m }
            }
            (lo + hi) / 2.0
        };
        for (a, b) in self.edges() {
            let (pa, pb) = (self.points[a as usize], self.points[b as usize]);
            if on[a as usize] || on[b as usize] || (level(pa) > 0.0) == (level(pb) > 0.0) {
                continue;
            }
            let t = root(pa, pb);
            let (near, other) = if t < reach {
                (a, b)
            } else if t > 1.0 - reach {
                (b, a)
            } else {
                continue;
            };
            if self.on_middle(near) && !self.on_middle(other) {
                continue;
            }
            let q = settle(bust, pa + (pb - pa) * t);
            let old = self.points[near as usize];
            let before: Vec<V> = self.around[near as usize]
                .iter()
                .map(|t| self.normal_of(self.triangles[*t as usize]))
                .collect();
            self.points[near as usize] = q;
            let bad = self.around[near as usize].iter().zip(&before).any(|(t, n)| {
                let m = self.normal_of(self.triangles[*t as usize]);
                m.unit().dot(n.unit()) < 0.5 || m.length() < 0.15 * n.length()
            });
            if bad {
                self.points[near as usize] = old;
            } else {
                on[near as usize] = true;
            }
        }
        for (a, b) in self.edges() {
            let (pa, pb) = (self.points[a as usize], self.points[b as usize]);
            if on[a as usize] || on[b as usize] || (level(pa) > 0.0) == (level(pb) > 0.0) {
                continue;
            }
            let t = root(pa, pb).clamp(0.1, 0.9);
            let q = settle(bust, pa + (pb - pa) * t);
            self.split(a, b, q);
            on.push(true);
        }
        self.tidy();
    }

    /// Closes the shortest edges that cutting left where two lines meet.
    pub fn drop_slivers(&mut self, shortest: f64, size: &dyn Fn(V) -> f64) {
        for (a, b) in self.edges() {
            if self.length(a, b) < shortest {
                self.collapse(a, b, size);
            }
        }
        self.tidy();
    }

    /// The whole bust: the half and its mirror image, sharing the middle line.
    pub fn mirrored(&self) -> (Vec<V>, Vec<[u32; 3]>) {
        let mut points = self.points.clone();
        let mut twin = Vec::with_capacity(points.len());
        for i in 0..self.points.len() {
            let p = self.points[i];
            if p.x == 0.0 {
                twin.push(i as u32);
            } else {
                twin.push(points.len() as u32);
                points.push(v(-p.x, p.y, p.z));
            }
        }
        let mut triangles = self.triangles.clone();
        triangles
            .extend(self.triangles.iter().map(|t| [t[0], t[2], t[1]].map(|c| twin[c as usize])));
        (points, triangles)
    }
}

/// Walks down the field on to the surface; a point in the middle plane stays there.
pub fn settle(bust: &Bust, p: V) -> V {
    let middle = p.x == 0.0;
    let mut p = p;
    for _ in 0..4 {
        let d = bust.at(p);
        if d.abs() < 1e-6 {
            break;
        }
        let e = 2e-4;
        let f = |o: V| bust.at(p + o) - bust.at(p - o);
        let g = v(f(v(e, 0.0, 0.0)), f(v(0.0, e, 0.0)), f(v(0.0, 0.0, e))) * (0.5 / e);
        let step = g * (d / g.dot(g).max(0.2));
        p = p - step * (0.25 / step.length().max(0.25));
        if middle {
            p.x = 0.0;
        }
    }
    p
}
