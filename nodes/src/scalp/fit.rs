//! Fits the cranium, and derives how many centimetres a unit of the file has.
//!
//! methods.md 0.1. The sphere is fitted by integrating over triangles, so that neither mesh density nor a random seed
//! affects it: large triangles are split into cells of a fortieth of the radius, small ones count by area. Everything
//! here is in the file's units, Y up.
//!
//! Guarantees: the same sphere for the same surface, however it is triangulated (to about 1e-3 r); bounded work for any
//! mesh. Not promised: a sensible sphere for a mesh that is not a head; [`Fit::p50`] detects that.

use crate::define::NodeError;
use crate::maths::transcendental::atan2;
use glam::Vec3;
use std::f32::consts::TAU;

/// The cranium sphere, and how well the crown fits it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fit {
    /// Centre, in the mesh's units.
    pub(crate) centre: Vec3,
    /// Radius, in the mesh's units.
    pub(crate) radius: f32,
    /// Half of the surface above the centre is within this distance of the sphere, as a fraction of its radius.
    pub(crate) p50: f32,
    /// The same for 95 % of that surface.
    pub(crate) p95: f32,
    /// Fraction of the sphere above its centre with surface near it, 0 to 1.
    pub(crate) cover: f32,
    /// Whether most triangles of the crown face inward.
    pub(crate) inside_out: bool,
}

/// A cell of the surface: its triangle, centre and area.
#[derive(Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) of: u32,
    pub(crate) at: Vec3,
    pub(crate) area: f32,
}

/// Fraction of the height, from the top down, that the first sphere is fitted to.
const CAP: f32 = 0.06;
/// Distance from the top point's axis up to which that part counts, in heights: wide enough for the cap of any cranium
/// (0.16 on a bust), narrow enough to leave out a raised hand.
const CAP_REACH: f32 = 0.2;
/// Depth below the top up to which the cranium counts, in radii.
const DOWN: f32 = 0.9;
/// Distance from the last sphere up to which surface counts, in radii.
const SHELL: f32 = 0.15;
/// The fit ends when a step moves it by less than this, in radii.
const STILL: f32 = 1e-5;
/// ... or at the latest after this many steps, or this many examined cells: a fine scan of 100,000 triangles needs 10
/// million.
const MOST_STEPS: usize = 100;
const MOST_SPENT: usize = 14_000_000;
/// Cells that lead near the sphere; where there are twice as many and more, a part of them is asked first, until it moves by less
/// than this, in radii.
const ENOUGH: usize = 30_000;
const NEARLY: f32 = 1e-3;
/// The surface is split anew if the radius falls below this fraction of the one it was split for.
const SMALLER: f32 = 0.7;
const LARGER: f32 = 1.4;
/// The same for a rough fit ...
const ROUGHLY: f32 = 2e-3;
const MOST_ROUGH_STEPS: usize = 16;
/// ... which needs no more samples than this.
const MOST_SAMPLES: usize = 2048;
/// Largest edge of the cells that a triangle is split into, in radii.
pub(crate) const CELL: f32 = 1.0 / 40.0;
/// Most cells along a triangle's edge, so that a giant triangle cannot make millions of cells ...
const MOST_PARTS: f32 = 64.0;
/// ... and most cells of a mesh, besides one per triangle: a head has some tens of thousands.
const MOST_CELLS: f32 = 4e5;

/// Fits the cranium sphere; `None` if the mesh has no surface that a sphere fits. `check` is called now and then and
/// may stop the work. Its cost is added to `spent`.
pub(crate) fn cranium(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    spent: &mut usize,
    check: impl Fn() -> Result<(), NodeError>,
) -> Result<Option<Fit>, NodeError> {
    let Some(top) = points.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)) else {
        return Ok(None);
    };
    let height = top.y - points.iter().fold(f32::MAX, |low, p| low.min(p.y));
    if !(height > 0.0 && height.is_finite()) {
        return Ok(None);
    }
    // From here on, the top point is the origin and the height is 1, which suits f32 best.
    let points: Vec<Vec3> = points.iter().map(|p| (*p - top) / height).collect();
    let cap = cells(&points, triangles, -CAP, 0.3 * CAP);
    let cut = |radius: f32| {
        check()?;
        Ok(cells(&points, triangles, -2.2 * radius, CELL * radius))
    };
    let fitted = fitted(cap, cut, STILL, MOST_STEPS, spent)?;
    let Some((surface, centre, radius)) = fitted else { return Ok(None) };
    let normal = |of: u32| {
        let [a, b, c] = triangles[of as usize].map(|v| points[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let fit = judged(&surface, centre, radius, normal);
    Ok(Some(Fit { centre: top + centre * height, radius: radius * height, ..fit }))
}

/// The same from area samples of a surface, with this top point and height: the sphere to about a percent, and rough
/// statistics. The facing of triangles is unknown.
pub(crate) fn rough(samples: impl Iterator<Item = Cell>, top: Vec3, height: f32) -> Option<Fit> {
    if !(height > 0.0 && height.is_finite()) {
        return None;
    }
    let samples: Vec<Cell> =
        samples.map(|cell| Cell { at: (cell.at - top) / height, ..cell }).collect();
    // Samples are spread in order all over the surface, and so is every n-th of them.
    let cut = |radius: f32| {
        let above = || samples.iter().filter(|cell| cell.at.y > -2.2 * radius);
        let every = above().count().div_ceil(MOST_SAMPLES).max(1);
        Ok(above().step_by(every).copied().collect())
    };
    let fit = fitted(samples.clone(), cut, ROUGHLY, MOST_ROUGH_STEPS, &mut 0).ok().flatten();
    let (surface, centre, radius) = fit?;
    let fit = judged(&surface, centre, radius, |_| Vec3::ZERO);
    // With few samples, some patches are empty by chance: at least this fraction of a whole crown's.
    let count = surface.iter().filter(|cell| cell.at.y > centre.y).count().max(1) as f32;
    let cover = fit.cover * (1.0 + Patches::COUNT as f32 / count);
    Some(Fit { centre: top + centre * height, radius: radius * height, cover, ..fit })
}

/// The sphere of a surface whose top point is the origin and whose height is 1, starting from its `cap`; `cut` is the
/// surface above 2.2 radii below the top. Also returns the last split surface; `None` if no sphere fits.
fn fitted(
    cap: Vec<Cell>,
    cut: impl Fn(f32) -> Result<Vec<Cell>, NodeError>,
    still: f32,
    most_steps: usize,
    spent: &mut usize,
) -> Result<Option<(Vec<Cell>, Vec3, f32)>, NodeError> {
    let in_cap = |c: &&Cell| c.at.y > -CAP && c.at.with_y(0.0).length() < CAP_REACH;
    let first = least_squares(cap.iter().filter(in_cap));
    let Some((mut centre, mut radius)) = first else { return Ok(None) };
    drop(cap);
    // A nearly flat cap fits any radius; a head is never wider than the mesh is high.
    if !(0.02..=0.6).contains(&radius) {
        radius = radius.clamp(0.02, 0.6);
        centre = Vec3::NEG_Y * radius;
    }
    let (mut surface, mut upper, mut cut_for) = (vec![], vec![], 0.0);
    let until = *spent + MOST_SPENT;
    // Of very many cells one in so many leads to near where all of them do.
    let mut every = 1;
    for _ in 0..most_steps {
        if !(SMALLER..LARGER).contains(&(radius / cut_for)) {
            surface = cut(radius)?;
            cut_for = radius;
            // No other cell can count before the next split.
            let may_count = |c: &&Cell| c.at.y > -1.01 * DOWN * LARGER * radius;
            upper = surface.iter().filter(may_count).copied().collect();
            *spent += 2 * surface.len();
            every = (upper.len() / ENOUGH).clamp(1, 16);
        }
        *spent += upper.len() / every;
        let counts = |c: &&Cell| c.at.y > -DOWN * radius && on_shell(c, centre, radius);
        let some = upper.iter().step_by(every);
        let Some(next) = least_squares(some.filter(counts)) else { return Ok(None) };
        if !(1e-3..2.0).contains(&next.1) {
            return Ok(None);
        }
        let moved = next.0.distance(centre).max((next.1 - radius).abs());
        (centre, radius) = next;
        if every > 1 {
            every = if moved < NEARLY * radius { 1 } else { every };
        } else if moved < still * radius || *spent > until {
            break;
        }
    }
    Ok(Some((surface, centre, radius)))
}

fn on_shell(cell: &Cell, centre: Vec3, radius: f32) -> bool {
    (cell.at.distance(centre) - radius).abs() < SHELL * radius
}

fn judged(surface: &[Cell], centre: Vec3, radius: f32, normal: impl Fn(u32) -> Vec3) -> Fit {
    let above = || surface.iter().filter(|c| c.at.y > centre.y);
    let mut off: Vec<(f32, f32)> =
        above().map(|c| ((c.at.distance(centre) - radius).abs() / radius, c.area)).collect();
    off.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = off.iter().map(|o| f64::from(o.1)).sum();
    let quantile = |q: f64| {
        let mut sum = 0.0;
        let found = off.iter().find(|(_, area)| {
            sum += f64::from(*area);
            sum >= q * total
        });
        found.map_or(f32::INFINITY, |o| o.0)
    };
    let crown = || above().filter(|c| on_shell(c, centre, radius));
    let outward: f64 = crown().map(|c| f64::from(c.area * normal(c.of).dot(c.at - centre))).sum();
    let mut covered = [false; Patches::COUNT];
    crown().filter_map(|c| Patches::above(c.at - centre)).for_each(|at| covered[at] = true);
    let cover = covered.iter().filter(|covered| **covered).count() as f32 / Patches::COUNT as f32;
    Fit {
        centre,
        radius,
        p50: quantile(0.5),
        p95: quantile(0.95),
        cover,
        inside_out: outward < 0.0,
    }
}

/// Equal-area patches of the sphere above its centre: four bands, each divided into 24 around the axis.
pub(crate) struct Patches;

impl Patches {
    /// How many there are.
    pub(crate) const COUNT: usize = Self::BANDS * Self::ROUND;
    const BANDS: usize = 4;
    const ROUND: usize = 24;
    /// Patches more than 30 degrees above the centre, one bit each.
    pub(crate) const UPPER: u128 = !0 << (Self::BANDS / 2 * Self::ROUND);

    /// The patch in a direction from the centre; `None` below it.
    pub(crate) fn above(way: Vec3) -> Option<usize> {
        let way = way.try_normalize().filter(|way| way.y > 0.0)?;
        let band = ((way.y * Self::BANDS as f32) as usize).min(Self::BANDS - 1);
        let turns = (atan2(way.x, way.z) / TAU).rem_euclid(1.0);
        Some(band * Self::ROUND + (turns * Self::ROUND as f32) as usize % Self::ROUND)
    }
}

/// The surface above `low` in cells of at most `size`.
pub(crate) fn cells(points: &[Vec3], triangles: &[[u32; 3]], low: f32, size: f32) -> Vec<Cell> {
    let corners = |t: &[u32; 3]| t.map(|v| points[v as usize]);
    let counts = |[a, b, c]: &[Vec3; 3]| a.y.max(b.y).max(c.y) > low;
    let n_parts = |[a, b, c]: [Vec3; 3], size: f32| {
        let square = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        // Most triangles of most meshes, without a root and a call.
        if square < 0.999 * (size * size) {
            return 1.0;
        }
        (square.sqrt() / size).ceil().clamp(1.0, MOST_PARTS)
    };
    let n_cells = |size: f32| -> f32 {
        let parts = triangles.iter().map(corners).filter(counts).map(|t| n_parts(t, size) - 1.0);
        parts.map(|more| more * more).sum()
    };
    let mut size = size;
    while n_cells(size) > MOST_CELLS && size.is_finite() {
        size *= 2.0;
    }
    let mut out = vec![];
    let all = triangles.iter().map(corners);
    for (of, t) in (0u32..).zip(all).filter(|(_, t)| counts(t)) {
        let [a, b, c] = t;
        let across = (b - a).cross(c - a);
        if across.try_normalize().is_none() {
            continue;
        }
        let n = n_parts(t, size);
        let parts = n as usize;
        let area = 0.5 * across.length() / (n * n);
        let at = |i: f32, j: f32| a + (b - a) * (i / n) + (c - a) * (j / n);
        for i in 0..parts {
            for j in 0..parts - i {
                let (x, y) = (i as f32, j as f32);
                out.push(Cell { of, at: at(x + 1.0 / 3.0, y + 1.0 / 3.0), area });
                if i + j + 1 < parts {
                    out.push(Cell { of, at: at(x + 2.0 / 3.0, y + 2.0 / 3.0), area });
                }
            }
        }
    }
    out
}

/// The sphere |p - c|^2 = r^2 that minimises the squared error of that equation: one linear system, so it needs no
/// initial guess and cannot get stuck. (The sphere that minimises the squared *distance* is 0.7 to 1.7 % larger on
/// three heads, since it weights brows and ears more.)
fn least_squares<'a>(cells: impl Iterator<Item = &'a Cell>) -> Option<(Vec3, f32)> {
    let mut sums = Sums::default();
    for cell in cells {
        let p = cell.at;
        sums.add([p.x, p.y, p.z, 1.0], p.length_squared(), cell.area);
    }
    let [x, y, z, k] = sums.system().solve()?;
    let centre = Vec3::new(x, y, z) * 0.5;
    let radius = (k + centre.length_squared()).sqrt();
    (centre.is_finite() && radius.is_finite() && radius > 0.0).then_some((centre, radius))
}

/// Accumulated normal equations of a weighted least-squares problem in four unknowns: sums of products of every two
/// entries of a row and its value, as the upper triangle, since products of two f32 are exact. Stored as one list,
/// which compilers vectorize two at a time.
#[derive(Default)]
struct Sums([f64; 14]);

impl Sums {
    #[inline]
    fn add(&mut self, row: [f32; 4], value: f32, weight: f32) {
        let ([a, b, c, d], v, weight) = (row.map(f64::from), f64::from(value), f64::from(weight));
        let [p, q, r, s] = [a, b, c, d].map(|x| weight * x);
        let weighted = [p, p, p, p, p, q, q, q, q, r, r, r, s, s];
        let others = [a, b, c, d, v, b, c, d, v, c, d, v, d, v];
        for ((sum, weighted), other) in self.0.iter_mut().zip(weighted).zip(others) {
            *sum += weighted * other;
        }
    }
    fn system(&self) -> Normal {
        let mut sums = self.0.into_iter();
        let mut system = Normal::default();
        for (i, row) in system.0.iter_mut().enumerate() {
            row.iter_mut().skip(i).zip(&mut sums).for_each(|(x, sum)| *x = sum);
        }
        system
    }
}

/// Normal equations of such a problem, without the part below the diagonal.
#[derive(Default)]
struct Normal([[f64; 5]; 4]);

impl Normal {
    /// Elimination with pivoting; `None` if the rows do not determine the unknowns.
    fn solve(mut self) -> Option<[f32; 4]> {
        let m = &mut self.0;
        let half = *m;
        for (i, row) in m.iter_mut().enumerate() {
            row.iter_mut().zip(half).take(i).for_each(|(x, above)| *x = above[i]);
        }
        let scale = m.iter().flatten().fold(0.0f64, |s, x| s.max(x.abs()));
        for i in 0..4 {
            let pivot = (i..4).max_by(|a, b| m[*a][i].abs().total_cmp(&m[*b][i].abs()))?;
            m.swap(i, pivot);
            if m[i][i].abs() <= 1e-12 * scale || !m[i][i].is_finite() {
                return None;
            }
            for row in i + 1..4 {
                let factor = m[row][i] / m[i][i];
                let above = m[i];
                m[row].iter_mut().zip(above).skip(i).for_each(|(x, above)| *x -= factor * above);
            }
        }
        let mut x = [0.0; 4];
        for i in (0..4).rev() {
            let known: f64 = (i + 1..4).map(|j| m[i][j] * x[j]).sum();
            x[i] = (m[i][4] - known) / m[i][i];
        }
        Some(x.map(|x| x as f32))
    }
}

/// Fits worse than this (half of the crown farther off than this fraction of the radius) are not a human cranium: heads
/// have 0.04 to 0.05, a rat 0.11, a cow 0.21.
pub(crate) const HEAD_LIKE: f32 = 0.08;

/// If the last 5 % of the crown are farther off than this, something stands on it: bald heads have 0.11 to 0.16, one
/// with sculpted hair 0.19, one with a bun or ponytail 0.27 to 0.5.
pub(crate) const BARE: f32 = 0.2;

impl Fit {
    /// Whether the crown lies on the sphere as a person's does.
    pub(crate) fn head_like(&self) -> bool {
        self.p50 < HEAD_LIKE
    }
    /// The same of a rough fit that may be one, and covers much of the crown.
    pub(crate) fn may_be_whole(&self) -> bool {
        self.p50 < 1.5 * HEAD_LIKE && self.cover > 0.6
    }
    /// Whether nothing stands on the crown.
    pub(crate) fn is_bare(&self) -> bool {
        self.p95 < BARE
    }
}

/// Plausible radius of a human cranium, cm.
pub(crate) const BELIEVED: std::ops::RangeInclusive<f32> = 6.0..=12.0;

/// Units of files, as centimetres and a name, likeliest first.
const UNITS: [(f32, &str); 4] = [(1.0, "cm"), (100.0, "m"), (0.1, "mm"), (2.54, "in")];

/// The unit in which a cranium of this radius is human.
pub(crate) fn unit_of_radius(radius: f32) -> Option<(f32, &'static str)> {
    UNITS.into_iter().find(|(cm, _)| BELIEVED.contains(&(radius * cm)))
}

/// The unit suggested by the height of a mesh's bounding box: metres up to 2, centimetres up to 200, else millimetres.
pub(crate) fn unit_of_height(height: f32) -> (f32, &'static str) {
    match height {
        h if h < 2.0 => (100.0, "m"),
        h if h < 200.0 => (1.0, "cm"),
        _ => (0.1, "mm"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::transcendental::sin_cos_turns;

    #[test]
    fn slivers_by_the_thousand_make_no_more_cells_than_a_head() {
        // The wall of a cylinder, 1 high and 2 pi around, of 2000 slivers as high as it is. Split as finely as asked,
        // each makes 64 x 64 cells: 8 million in all.
        let at = |k: u32, high: f32| {
            let (sin, cos) = sin_cos_turns(k as f32 / 1000.0);
            Vec3::new(sin, high, cos)
        };
        let points: Vec<Vec3> = (0..1000).flat_map(|k| [at(k, 0.0), at(k, 1.0)]).collect();
        let wall = |k: u32| {
            let [low, high, next, next_high] = [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3];
            [[low, next, high], [high, next, next_high]].map(|t| t.map(|v| v % 2000))
        };
        let triangles: Vec<[u32; 3]> = (0..1000).flat_map(wall).collect();
        let made = cells(&points, &triangles, -1.0, 0.001);
        assert!(made.len() as f32 <= MOST_CELLS + triangles.len() as f32, "{}", made.len());
        let area: f32 = made.iter().map(|cell| cell.area).sum();
        assert!((area / TAU - 1.0).abs() < 1e-3, "{area}");
    }
}
