//! Unfolds the bust into one uv tile: charts of one label each, flattened, relaxed and packed.
//!
//! Guarantees: no triangle is turned over and no two overlap (a chart whose relaxed border crosses itself
//! falls back to the embedding into a circle, which cannot). Distortion is kept low, not minimal.

use crate::vector::V;
use std::collections::BTreeMap;

type P = [f64; 2];

fn area2(a: P, b: P, c: P) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

struct Chart {
    faces: Vec<usize>,
    /// Local corner numbers, and the bust's vertex for each.
    corners: Vec<[usize; 3]>,
    vertex: Vec<usize>,
    border: Vec<usize>,
    flat: Vec<P>,
    scale: f64,
}

/// Smooths jagged borders between labels.
pub fn smooth_labels(triangles: &[[u32; 3]], labels: &mut [u8], rounds: usize) {
    let near = neighbours(triangles);
    for _ in 0..rounds {
        let old = labels.to_vec();
        for (i, n) in near.iter().enumerate() {
            for a in 0..3 {
                let (b, c) = (n[a], n[(a + 1) % 3]);
                if old[b] == old[c] && old[b] != old[i] {
                    labels[i] = old[b];
                }
            }
        }
    }
}

/// Gives islands of a label with fewer than `least` triangles to the label around them.
pub fn drop_islands(triangles: &[[u32; 3]], labels: &mut [u8], least: usize) {
    let near = neighbours(triangles);
    for _ in 0..8 {
        let mut seen = vec![false; labels.len()];
        for start in 0..labels.len() {
            if seen[start] {
                continue;
            }
            let (mut part, mut i) = (vec![start], 0);
            let mut beside: BTreeMap<u8, usize> = BTreeMap::new();
            seen[start] = true;
            while i < part.len() {
                for n in near[part[i]] {
                    if labels[n] != labels[start] {
                        *beside.entry(labels[n]).or_default() += 1;
                    } else if !seen[n] {
                        seen[n] = true;
                        part.push(n);
                    }
                }
                i += 1;
            }
            if part.len() < least
                && let Some((label, _)) = beside.iter().max_by_key(|b| b.1)
            {
                for t in part {
                    labels[t] = *label;
                }
            }
        }
    }
}

fn neighbours(triangles: &[[u32; 3]]) -> Vec<[usize; 3]> {
    let mut at: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (i, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            at.insert((t[k], t[(k + 1) % 3]), i);
        }
    }
    triangles.iter().map(|t| [0, 1, 2].map(|k| at[&(t[(k + 1) % 3], t[k])])).collect()
}

/// Uvs for every corner. `axis`: label 0 (the scalp) is first laid out around this direction.
pub fn unwrap(
    points: &[V],
    triangles: &[[u32; 3]],
    labels: &[u8],
    scales: &[f64],
    axis: V,
) -> Vec<[P; 3]> {
    let near = neighbours(triangles);
    let mut todo: Vec<Vec<usize>> = Vec::new();
    let mut seen = vec![false; triangles.len()];
    for start in 0..triangles.len() {
        if seen[start] {
            continue;
        }
        let mut part = vec![start];
        seen[start] = true;
        let mut i = 0;
        while i < part.len() {
            for n in near[part[i]] {
                if !seen[n] && labels[n] == labels[start] {
                    seen[n] = true;
                    part.push(n);
                }
            }
            i += 1;
        }
        todo.push(part);
    }
    todo.reverse();
    let mut charts: Vec<Chart> = Vec::new();
    while let Some(mut part) = todo.pop() {
        part.sort_unstable();
        let label = labels[part[0]] as usize;
        match chart(points, triangles, &near, &part) {
            Some(mut c) => {
                c.lay_out(points, (label == 0).then_some(axis));
                c.scale = scales[label];
                charts.push(c);
            }
            None => {
                let (a, b) = halves(&near, &part);
                todo.push(a);
                todo.push(b);
            }
        }
    }
    pack(&mut charts);
    let mut uvs = vec![[[0.0; 2]; 3]; triangles.len()];
    for c in &charts {
        for (f, t) in c.faces.iter().zip(&c.corners) {
            uvs[*f] = t.map(|q| c.flat[q]);
        }
    }
    println!(
        "{} charts: {:?}",
        charts.len(),
        charts.iter().map(|c| c.faces.len()).collect::<Vec<_>>()
    );
    uvs
}

/// Cuts a part in two, between two of its triangles that are far apart.
fn halves(near: &[[usize; 3]], part: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let inside: std::collections::BTreeSet<usize> = part.iter().copied().collect();
    let walk = |from: usize| {
        let mut order = vec![(from, 0usize)];
        let mut step: BTreeMap<usize, usize> = BTreeMap::from([(from, 0)]);
        let mut i = 0;
        while i < order.len() {
            let (t, d) = order[i];
            for n in near[t] {
                if inside.contains(&n) && !step.contains_key(&n) {
                    step.insert(n, d + 1);
                    order.push((n, d + 1));
                }
            }
            i += 1;
        }
        (step, order[order.len() - 1].0)
    };
    let (_, a) = walk(part[0]);
    let (from_a, b) = walk(a);
    let (from_b, _) = walk(b);
    let far = usize::MAX;
    part.iter().partition(|t| from_a.get(t).unwrap_or(&far) < from_b.get(t).unwrap_or(&far))
}

/// A chart where the part is a disc.
fn chart(
    points: &[V],
    triangles: &[[u32; 3]],
    near: &[[usize; 3]],
    part: &[usize],
) -> Option<Chart> {
    let local: BTreeMap<usize, usize> = part.iter().enumerate().map(|(i, t)| (*t, i)).collect();
    // Corners grow together across the edges inside the part, so a vertex that two fans touch is split.
    let mut root: Vec<usize> = (0..part.len() * 3).collect();
    fn find(root: &mut [usize], mut a: usize) -> usize {
        while root[a] != a {
            root[a] = root[root[a]];
            a = root[a];
        }
        a
    }
    let mut inner = 0;
    let mut border: Vec<(usize, usize)> = Vec::new();
    for (i, t) in part.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (triangles[*t][k], triangles[*t][(k + 1) % 3]);
            if let Some(j) = local.get(&near[*t][k]) {
                inner += 1;
                let other = triangles[part[*j]];
                for (c, own) in [(a, i * 3 + k), (b, i * 3 + (k + 1) % 3)] {
                    let o = j * 3 + other.iter().position(|q| *q == c)?;
                    let (x, y) = (find(&mut root, own), find(&mut root, o));
                    root[x.max(y)] = x.min(y);
                }
            } else {
                border.push((i * 3 + k, i * 3 + (k + 1) % 3));
            }
        }
    }
    let mut name: BTreeMap<usize, usize> = BTreeMap::new();
    let mut vertex = Vec::new();
    let mut corners = Vec::new();
    for (i, t) in part.iter().enumerate() {
        corners.push([0, 1, 2].map(|k| {
            let r = find(&mut root, i * 3 + k);
            *name.entry(r).or_insert_with(|| {
                vertex.push(triangles[*t][k] as usize);
                vertex.len() - 1
            })
        }));
    }
    let edges = inner / 2 + border.len();
    if vertex.len() + part.len() != edges + 1 || border.is_empty() {
        return None;
    }
    let next: BTreeMap<usize, usize> = border
        .iter()
        .map(|(a, b)| (name[&find(&mut root, *a)], name[&find(&mut root, *b)]))
        .collect();
    let (&start, _) = next.first_key_value()?;
    let mut loop_ = vec![start];
    while let Some(n) = next.get(&loop_[loop_.len() - 1]).filter(|n| **n != start) {
        loop_.push(*n);
        if loop_.len() > border.len() {
            return None;
        }
    }
    if loop_.len() != border.len() {
        return None;
    }
    let _ = points;
    Some(Chart {
        faces: part.to_vec(),
        corners,
        vertex,
        border: loop_,
        flat: Vec::new(),
        scale: 1.0,
    })
}

impl Chart {
    fn right_way_up(&self, flat: &[P]) -> bool {
        self.corners.iter().all(|t| area2(flat[t[0]], flat[t[1]], flat[t[2]]) > 1e-7)
    }

    /// All triangles the right way up and a border that does not cross itself: no overlap.
    fn sound(&self, flat: &[P]) -> bool {
        let n = self.border.len();
        let e = |i: usize| (flat[self.border[i]], flat[self.border[(i + 1) % n]]);
        self.right_way_up(flat)
            && (0..n).all(|i| {
                (i + 2..n).filter(|j| i != 0 || *j != n - 1).all(|j| {
                    let ((a, b), (c, d)) = (e(i), e(j));
                    !(area2(a, b, c) * area2(a, b, d) <= 0.0
                        && area2(c, d, a) * area2(c, d, b) <= 0.0)
                })
            })
    }

    fn lay_out(&mut self, points: &[V], axis: Option<V>) {
        let at = |i: usize| points[self.vertex[i]];
        let mean = self
            .corners
            .iter()
            .fold(V::default(), |s, t| s + (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])))
            .unit();
        let up = axis.unwrap_or(mean);
        let side = if up.y.abs() > 0.9 {
            V { x: 1.0, y: 0.0, z: 0.0 }
        } else {
            V { x: 0.0, y: 1.0, z: 0.0 }.cross(up).unit()
        };
        let side = (side - up * side.dot(up)).unit();
        let across = up.cross(side);
        let straight: Vec<P> = (0..self.vertex.len())
            .map(|i| {
                let p = at(i);
                if axis.is_some() {
                    // Lambert's equal-area map around the axis.
                    let d = p.unit();
                    let k = p.length() * (2.0 / (1.0 + d.dot(up)).max(1e-3)).sqrt();
                    [d.dot(side) * k, d.dot(across) * k]
                } else {
                    [p.dot(side), p.dot(across)]
                }
            })
            .collect();
        let start = if self.sound(&straight) { straight.clone() } else { self.circle(points) };
        let relaxed = self.relaxed(points, start.clone());
        let good = self.sound(&relaxed);
        if !good {
            println!("a chart of {} keeps its first layout", self.faces.len());
        }
        self.flat = if good { relaxed } else { start };
        // Upright: turned so that it agrees best with a look along the chart's mean normal.
        let n = self.flat.len() as f64;
        let mean = self.flat.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
        let (mut k, mut s) = (0.0, 0.0);
        for (p, q) in self.flat.iter().zip(&straight) {
            let p = [p[0] - mean[0], p[1] - mean[1]];
            k += p[0] * q[0] + p[1] * q[1];
            s += p[0] * q[1] - p[1] * q[0];
        }
        let (k, s) = (k / k.hypot(s), s / k.hypot(s));
        for p in &mut self.flat {
            *p = [p[0] * k - p[1] * s, p[0] * s + p[1] * k];
        }
    }

    /// Mean-value embedding into a circle of the chart's area.
    fn circle(&self, points: &[V]) -> Vec<P> {
        let at = |i: usize| points[self.vertex[i]];
        let n = self.vertex.len();
        let total: f64 = self
            .corners
            .iter()
            .map(|t| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).length() / 2.0)
            .sum();
        let radius = (total / std::f64::consts::PI).sqrt();
        let mut flat = vec![[0.0; 2]; n];
        let mut fixed = vec![false; n];
        let m = self.border.len();
        let length = |i: usize| (at(self.border[(i + 1) % m]) - at(self.border[i])).length();
        let round: f64 = (0..m).map(length).sum();
        let mut go = 0.0;
        for i in 0..m {
            let a = go / round * std::f64::consts::TAU;
            flat[self.border[i]] = [radius * a.cos(), radius * a.sin()];
            fixed[self.border[i]] = true;
            go += length(i);
        }
        let mut weights: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); n];
        for t in &self.corners {
            for k in 0..3 {
                let (o, a, b) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
                let (s, u) = (at(a) - at(o), at(b) - at(o));
                let half = (s.unit().dot(u.unit()).clamp(-1.0, 1.0).acos() / 2.0).min(1.5).tan();
                *weights[o].entry(a).or_default() += half / s.length();
                *weights[o].entry(b).or_default() += half / u.length();
            }
        }
        let weights: Vec<Vec<(usize, f64)>> =
            weights.into_iter().map(|w| w.into_iter().collect()).collect();
        // Overshooting is faster, but may run away: then more carefully.
        let embedded = flat.clone();
        for overshoot in [1.7, 1.5, 1.3, 1.0] {
            flat = embedded.clone();
            if settle(&mut flat, &fixed, &weights, overshoot) {
                break;
            }
        }
        flat
    }

    /// Moves one vertex at a time down the symmetric Dirichlet energy; never turns a triangle over.
    fn relaxed(&self, points: &[V], mut flat: Vec<P>) -> Vec<P> {
        if !self.right_way_up(&flat) {
            return flat;
        }
        // For each triangle the inverse of its rest frame and its area.
        let rest: Vec<([f64; 4], f64)> = self
            .corners
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| points[self.vertex[i]]);
                let (e, f) = (b - a, c - a);
                let (x1, u) = (e.length(), e.unit());
                let x2 = f.dot(u);
                let y2 = (f - u * x2).length();
                ([1.0 / x1, -x2 / (x1 * y2), 0.0, 1.0 / y2], x1 * y2 / 2.0)
            })
            .collect();
        let energy = |t: usize, flat: &[P]| {
            let [a, b, c] = self.corners[t].map(|i| flat[i]);
            let (r, area) = &rest[t];
            let (e, f) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
            let j =
                [e[0] * r[0], e[0] * r[1] + f[0] * r[3], e[1] * r[0], e[1] * r[1] + f[1] * r[3]];
            let det = j[0] * j[3] - j[1] * j[2];
            if det < 1e-9 {
                return f64::INFINITY;
            }
            let n = j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3];
            area * n * (1.0 + 1.0 / (det * det))
        };
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); flat.len()];
        for (i, t) in self.corners.iter().enumerate() {
            for c in t {
                around[*c].push(i);
            }
        }
        for sweep in 0..160 {
            for k in 0..flat.len() {
                let i = if sweep % 2 == 0 { k } else { flat.len() - 1 - k };
                let here = flat[i];
                let cost = |flat: &mut Vec<P>, p: P| {
                    flat[i] = p;
                    around[i].iter().map(|t| energy(*t, flat)).sum::<f64>()
                };
                // A step that turns nothing over.
                let h = around[i]
                    .iter()
                    .map(|t| {
                        let [a, b, c] = self.corners[*t].map(|q| flat[q]);
                        let long = [(a, b), (b, c), (c, a)]
                            .iter()
                            .map(|(s, t)| (s[0] - t[0]).hypot(s[1] - t[1]))
                            .fold(0.0, f64::max);
                        area2(a, b, c) / long
                    })
                    .fold(0.01, f64::min)
                    * 0.02;
                let e0 = cost(&mut flat, here);
                let (ex, ey) = (
                    cost(&mut flat, [here[0] + h, here[1]]),
                    cost(&mut flat, [here[0], here[1] + h]),
                );
                let (fx, fy) = (
                    cost(&mut flat, [here[0] - h, here[1]]),
                    cost(&mut flat, [here[0], here[1] - h]),
                );
                let g = [(ex - fx) / (2.0 * h), (ey - fy) / (2.0 * h)];
                let hh = [
                    ((ex + fx - 2.0 * e0) / (h * h)).max(1e-3),
                    ((ey + fy - 2.0 * e0) / (h * h)).max(1e-3),
                ];
                let mut step = [-g[0] / hh[0] * 1.4, -g[1] / hh[1] * 1.4];
                let mut best = here;
                if step[0].is_finite() && step[1].is_finite() {
                    for _ in 0..8 {
                        let p = [here[0] + step[0], here[1] + step[1]];
                        if cost(&mut flat, p) < e0 {
                            best = p;
                            break;
                        }
                        step = [step[0] * 0.5, step[1] * 0.5];
                    }
                }
                flat[i] = best;
            }
        }
        flat
    }
}

/// Moves every free vertex to the weighed mean of its neighbours until nothing moves; false if it ran away.
fn settle(flat: &mut [P], fixed: &[bool], weights: &[Vec<(usize, f64)>], overshoot: f64) -> bool {
    for round in 0..20_000 {
        let mut most = 0.0f64;
        for i in (0..flat.len()).filter(|i| !fixed[*i]) {
            let (mut s, mut total) = ([0.0; 2], 0.0);
            for (j, w) in &weights[i] {
                s[0] += flat[*j][0] * w;
                s[1] += flat[*j][1] * w;
                total += w;
            }
            for k in 0..2 {
                let step = (s[k] / total - flat[i][k]) * overshoot;
                most = most.max(step.abs());
                flat[i][k] += step;
            }
        }
        if most < 1e-10 {
            println!("embedded after {round} rounds, overshoot {overshoot}");
            return true;
        }
        if !most.is_finite() || most > 1e3 {
            break;
        }
    }
    println!("overshoot {overshoot} did not settle");
    false
}

/// Sets the charts into the unit tile, upright as they are, on a grid of cells; larger ones first, each at
/// the lowest and then leftmost place where it touches no other.
fn pack(charts: &mut [Chart]) {
    const CELL: f64 = 0.25;
    // Cells that a chart covers, with a margin of two cells around it.
    let mut shapes: Vec<(usize, usize, Vec<(usize, usize)>)> = Vec::new();
    for c in charts.iter_mut() {
        let low = c.flat.iter().fold([1e9f64; 2], |l, p| [l[0].min(p[0]), l[1].min(p[1])]);
        for p in &mut c.flat {
            *p = [0, 1].map(|k| (p[k] - low[k]) * c.scale + 2.0 * CELL);
        }
        let high = c.flat.iter().fold([0.0f64; 2], |l, p| [l[0].max(p[0]), l[1].max(p[1])]);
        let (w, h) = ((high[0] / CELL) as usize + 4, (high[1] / CELL) as usize + 4);
        let mut covered = vec![false; w * h];
        for t in &c.corners {
            let q = t.map(|i| c.flat[i]);
            let span = |k: usize| {
                let (a, b) = (
                    q.iter().fold(1e9f64, |m, p| m.min(p[k])),
                    q.iter().fold(-1e9f64, |m, p| m.max(p[k])),
                );
                ((a / CELL) as usize).saturating_sub(1)..=(b / CELL) as usize + 1
            };
            for y in span(1) {
                for x in span(0) {
                    covered[y * w + x] = true;
                }
            }
        }
        let cells = (0..w * h).filter(|i| covered[*i]).map(|i| (i % w, i / w)).collect();
        shapes.push((w, h, cells));
    }
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by_key(|i| (std::cmp::Reverse(shapes[*i].2.len()), *i));
    let place = |n: usize| -> Option<Vec<(usize, usize)>> {
        let mut taken = vec![false; n * n];
        let mut spots = vec![(0, 0); shapes.len()];
        for i in &order {
            let (w, h, cells) = &shapes[*i];
            if *w > n || *h > n {
                return None;
            }
            let free = |x: usize, y: usize| cells.iter().all(|c| !taken[(c.1 + y) * n + c.0 + x]);
            let (x, y) = (0..=n - h)
                .flat_map(|y| (0..=n - w).map(move |x| (x, y)))
                .find(|(x, y)| free(*x, *y))?;
            for c in cells {
                taken[(c.1 + y) * n + c.0 + x] = true;
            }
            spots[*i] = (x, y);
        }
        Some(spots)
    };
    let mut n = 150;
    let spots = loop {
        if let Some(s) = place(n) {
            break s;
        }
        n += 2;
    };
    let side = n as f64 * CELL;
    println!("uv tile: {side:.1} cm a side");
    for (c, s) in charts.iter_mut().zip(spots) {
        for p in &mut c.flat {
            *p = [(p[0] + s.0 as f64 * CELL) / side, (p[1] + s.1 as f64 * CELL) / side];
        }
    }
}
