//! A narrow-band signed distance field of a head: fast answers to "is this point under the skin?".
//!
//! Samples every 2 mm within 1 cm of the surface, in blocks of 8 x 8 x 8 cells that carry their own
//! border, so that one lookup touches one block. Exact distances are computed beside the surface
//! and handed on from sample to sample (the nearest triangle of a neighbour is a candidate), which needs about one
//! exact distance a sample instead of a search. Blocks away from the band only know their side.
//!
//! Guarantees: the same bits for any number of threads; error under a tenth of a cell where the
//! surface is smooth on the scale of a cell, under half a cell at sharp creases. Within a cell of the surface
//! callers who need more ask [`Surface::closest`](super::closest::Surface::closest).

use super::closest::{Hit, Surface, closest_on_triangle};
use glam::{IVec3, Vec3};
use std::collections::VecDeque;
use std::sync::OnceLock;

/// Distance between samples, cm. Doubled as often as needed for a mesh of more than [`MOST_BLOCKS`].
pub const CELL: f32 = 0.2;
/// How many cells from the surface distances are known: 1 cm.
const BAND_CELLS: f32 = 5.0;
/// Cells along a block's edge.
const BLOCK: i32 = 8;
/// Samples along a block's edge, border included.
const SIDE: usize = BLOCK as usize + 1;
const SAMPLES: usize = SIDE * SIDE * SIDE;

/// Runs `f(0)..f(n)` in any order, maybe at once.
pub type ForEach<'a> = &'a dyn Fn(usize, &(dyn Fn(usize) + Sync));

/// What the field knows about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Depth {
    /// Signed distance (negative inside) and its gradient (about unit, outward).
    Near(f32, Vec3),
    /// More than the band inside.
    Inside,
    /// More than the band outside.
    Outside,
}

/// The field of one surface.
pub struct DistanceField {
    cell: f32,
    per_cell: f32,
    lowest: Vec3,
    blocks_along: IVec3,
    /// Index into `samples`, or `INSIDE` / `OUTSIDE`.
    blocks: Vec<u32>,
    samples: Vec<[f32; SAMPLES]>,
}

const NEIGHBOURS: [(usize, i32); 6] = [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)];
const INSIDE: u32 = u32::MAX;
const OUTSIDE: u32 = u32::MAX - 1;
/// The most blocks a field's box may have: 200,000 are a figure of 1.8 x 1 x 0.4 m at 2 mm. The table of
/// blocks then takes 6 MB while it is built; only blocks near the surface cost more.
const MOST_BLOCKS: f32 = 200_000.0;

#[derive(Clone, Copy)]
struct Nearest {
    d2: f32,
    triangle: u32,
}

impl DistanceField {
    /// The field of `surface`, whose coordinates are in cm.
    pub fn new(surface: &Surface, for_each: ForEach) -> Self {
        let (lo, hi) = surface.bounds();
        let mut cell = CELL;
        let blocks = |cell: f32| {
            (hi - lo + Vec3::splat(2.0 * (BAND_CELLS + 1.0) * cell)) / (cell * BLOCK as f32)
        };
        while blocks(cell).element_product() > MOST_BLOCKS {
            cell *= 2.0;
        }
        let (extent, band) = (blocks(cell), BAND_CELLS * cell);
        let lowest = lo - Vec3::splat(band + cell);
        let blocks_along = extent.ceil().as_ivec3().max(IVec3::ONE);
        let count = (blocks_along.x * blocks_along.y * blocks_along.z) as usize;
        let index = |b: IVec3| ((b.z * blocks_along.y + b.y) * blocks_along.x + b.x) as usize;
        let size = cell * BLOCK as f32;
        let mut near: Vec<Vec<u32>> = vec![vec![]; count];
        let mut in_band = vec![false; count];
        for (t, corners) in (0..).map(|t| (t, surface.corners(t))).take(surface.triangles.len()) {
            let (lo, hi) = (
                corners[0].min(corners[1]).min(corners[2]),
                corners[0].max(corners[1]).max(corners[2]),
            );
            let blocks_within = |margin: f32| {
                let first = ((lo - margin - lowest) / size).floor().as_ivec3().max(IVec3::ZERO);
                let last = ((hi + margin - lowest) / size).floor().as_ivec3();
                (first, last.min(blocks_along - 1))
            };
            // A long triangle's box covers blocks that it never comes near.
            let comes_near = |b: IVec3, margin: f32| {
                let middle = lowest + (b.as_vec3() + 0.5) * size;
                let reach = margin + 0.5 * size * 1.732_05;
                closest_on_triangle(middle, corners).1.distance_squared(middle) <= reach * reach
            };
            each_block(blocks_within(1.5 * cell), |b| {
                if comes_near(b, 1.5 * cell) {
                    near[index(b)].push(t);
                }
            });
            each_block(blocks_within(band), |b| {
                in_band[index(b)] = in_band[index(b)] || comes_near(b, band);
            });
        }
        let live: Vec<IVec3> = {
            let mut live = vec![];
            each_block((IVec3::ZERO, blocks_along - 1), |b| {
                if in_band[index(b)] {
                    live.push(b);
                }
            });
            live
        };
        let mut slot = vec![OUTSIDE; count];
        for (i, b) in live.iter().enumerate() {
            slot[index(*b)] = i as u32;
        }

        let place = |b: IVec3, s: usize| lowest + (b * BLOCK + sample_cell(s)).as_vec3() * cell;
        // Beside the surface: exact distances to the triangles around.
        let mut nearest: Vec<Box<[Nearest; SAMPLES]>> = map(for_each, live.len(), |i| {
            let b = live[i];
            let mut out = Box::new([Nearest { d2: f32::MAX, triangle: u32::MAX }; SAMPLES]);
            for &t in &near[index(b)] {
                splat(surface, t, place(b, 0), cell, &mut out);
            }
            out
        });
        // Outwards: a sample tries the triangles its neighbours found. Every round reads only the last one's
        // answers, so the order of blocks does not matter.
        let neighbour_slot = |b: IVec3| {
            let inside = b.cmpge(IVec3::ZERO).all() && b.cmplt(blocks_along).all();
            if inside { slot[index(b)] } else { OUTSIDE }
        };
        for _ in 0..3 * BLOCK {
            let next = map(for_each, live.len(), |i| {
                grow(surface, &nearest, live[i], &neighbour_slot, |s| place(live[i], s), i)
            });
            let mut changed = false;
            for (old, new) in nearest.iter_mut().zip(next) {
                if let Some(new) = new {
                    *old = new;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        // The first to reach a sample may not have been the nearest: all try once more.
        let nearest = map(for_each, live.len(), |i| {
            let mut out = nearest[i].clone();
            for (s, out) in out.iter_mut().enumerate() {
                let p = place(live[i], s);
                candidates(&nearest, live[i], s, &neighbour_slot, |t| {
                    try_triangle(surface, t, p, out)
                });
            }
            out
        });
        let samples: Vec<[f32; SAMPLES]> = map(for_each, live.len(), |i| {
            let mut out = [0.0; SAMPLES];
            for (s, out) in out.iter_mut().enumerate() {
                let Nearest { triangle, d2 } = nearest[i][s];
                *out = if triangle == u32::MAX {
                    // No path of samples led here from the surface; it is far away.
                    2.0 * band
                } else {
                    let p = place(live[i], s);
                    let (bary, point) = closest_on_triangle(p, surface.corners(triangle));
                    let hit = Hit { triangle, bary, point, distance: d2.sqrt() };
                    surface.signed_distance(p, &hit)
                };
            }
            out
        });
        drop(nearest);

        // Sides of the blocks without samples, from their neighbours' nearest corner samples.
        let mut queue: VecDeque<IVec3> = live.iter().copied().collect();
        let mut known = in_band;
        while let Some(b) = queue.pop_front() {
            for (axis, step) in NEIGHBOURS {
                let mut other = b;
                other[axis] += step;
                let within = other.cmpge(IVec3::ZERO).all() && other.cmplt(blocks_along).all();
                if !within || known[index(other)] {
                    continue;
                }
                known[index(other)] = true;
                slot[index(other)] = match slot[index(b)] {
                    far @ (INSIDE | OUTSIDE) => far,
                    live => {
                        let mut middle = IVec3::splat(BLOCK / 2);
                        middle[axis] = if step < 0 { 0 } else { BLOCK };
                        let sample = samples[live as usize][sample_index(middle)];
                        if sample < 0.0 { INSIDE } else { OUTSIDE }
                    }
                };
                queue.push_back(other);
            }
        }
        Self { cell, per_cell: 1.0 / cell, lowest, blocks_along, blocks: slot, samples }
    }

    /// What is known at `p` (cm), interpolated between samples.
    #[inline]
    pub fn depth(&self, p: Vec3) -> Depth {
        let q = (p - self.lowest) * self.per_cell;
        // Truncated where it is positive: a floor, without asking the library for one.
        let i = q.as_ivec3();
        let b = IVec3::new(i.x >> 3, i.y >> 3, i.z >> 3);
        if !q.cmpge(Vec3::ZERO).all() || b.cmpge(self.blocks_along).any() {
            return Depth::Outside;
        }
        let cell = i.as_vec3();
        let block = ((b.z * self.blocks_along.y + b.y) * self.blocks_along.x + b.x) as usize;
        let samples = match self.blocks[block] {
            INSIDE => return Depth::Inside,
            OUTSIDE => return Depth::Outside,
            live => &self.samples[live as usize],
        };
        let at = sample_index(IVec3::new(i.x & 7, i.y & 7, i.z & 7));
        let f = q - cell;
        const Y: usize = SIDE;
        const Z: usize = SIDE * SIDE;
        let s = |o: usize| samples[at + o];
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let (x00, x10) = (lerp(s(0), s(1), f.x), lerp(s(Y), s(Y + 1), f.x));
        let (x01, x11) = (lerp(s(Z), s(Z + 1), f.x), lerp(s(Z + Y), s(Z + Y + 1), f.x));
        let (y0, y1) = (lerp(x00, x10, f.y), lerp(x01, x11, f.y));
        let dx = lerp(
            lerp(s(1) - s(0), s(Y + 1) - s(Y), f.y),
            lerp(s(Z + 1) - s(Z), s(Z + Y + 1) - s(Z + Y), f.y),
            f.z,
        );
        let dy = lerp(x10 - x00, x11 - x01, f.z);
        let gradient = Vec3::new(dx, dy, y1 - y0) * self.per_cell;
        Depth::Near(lerp(y0, y1, f.z), gradient)
    }

    /// Half as much again as the error where the surface is smooth, cm.
    #[inline]
    pub fn error(&self) -> f32 {
        0.15 * self.cell
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.blocks.len() * 4 + self.samples.len() * size_of::<[f32; SAMPLES]>()
    }
}

fn sample_index(cell: IVec3) -> usize {
    (cell.z as usize * SIDE + cell.y as usize) * SIDE + cell.x as usize
}

fn sample_cell(s: usize) -> IVec3 {
    IVec3::new((s % SIDE) as i32, (s / SIDE % SIDE) as i32, (s / (SIDE * SIDE)) as i32)
}

fn each_block((first, last): (IVec3, IVec3), mut f: impl FnMut(IVec3)) {
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                f(IVec3::new(x, y, z));
            }
        }
    }
}

/// Tries triangle `t` on the samples within one cell and a half of it.
fn splat(surface: &Surface, t: u32, first: Vec3, size: f32, out: &mut [Nearest; SAMPLES]) {
    let corners = surface.corners(t);
    let margin = Vec3::splat(1.5 * size);
    let lo = (corners[0].min(corners[1]).min(corners[2]) - margin - first) / size;
    let hi = (corners[0].max(corners[1]).max(corners[2]) + margin - first) / size;
    let lo = lo.ceil().as_ivec3().max(IVec3::ZERO);
    let hi = hi.floor().as_ivec3().min(IVec3::splat(BLOCK));
    each_block((lo, hi), |cell| {
        let p = first + cell.as_vec3() * size;
        let d2 = closest_on_triangle(p, corners).1.distance_squared(p);
        let old = &mut out[sample_index(cell)];
        // Triangles come in rising order: a tie keeps the lower one.
        if d2 < old.d2 {
            *old = Nearest { d2, triangle: t };
        }
    });
}

/// One round for one block: unknown samples try their six neighbours' triangles. None when nothing
/// changed.
fn grow(
    surface: &Surface,
    nearest: &[Box<[Nearest; SAMPLES]>],
    b: IVec3,
    slot: &dyn Fn(IVec3) -> u32,
    place: impl Fn(usize) -> Vec3,
    own: usize,
) -> Option<Box<[Nearest; SAMPLES]>> {
    if nearest[own].iter().all(|n| n.triangle != u32::MAX) {
        return None;
    }
    let mut out: Option<Box<[Nearest; SAMPLES]>> = None;
    for s in 0..SAMPLES {
        if nearest[own][s].triangle != u32::MAX {
            continue;
        }
        let mut best = Nearest { d2: f32::MAX, triangle: u32::MAX };
        let p = place(s);
        candidates(nearest, b, s, slot, |t| try_triangle(surface, t, p, &mut best));
        if best.triangle != u32::MAX {
            out.get_or_insert_with(|| nearest[own].clone())[s] = best;
        }
    }
    out
}

/// Calls `found` with the triangles nearest to the six neighbours of sample `s` of block `b`.
fn candidates(
    nearest: &[Box<[Nearest; SAMPLES]>],
    b: IVec3,
    s: usize,
    slot: &dyn Fn(IVec3) -> u32,
    mut found: impl FnMut(u32),
) {
    let cell = sample_cell(s);
    for (axis, step) in NEIGHBOURS {
        let (mut other, mut block) = (cell, b);
        other[axis] += step;
        // The border sample 8 is the next block's sample 0.
        if other[axis] < 0 {
            block[axis] -= 1;
            other[axis] += BLOCK;
        } else if other[axis] > BLOCK {
            block[axis] += 1;
            other[axis] -= BLOCK;
        }
        let from = slot(block);
        if from < OUTSIDE {
            let triangle = nearest[from as usize][sample_index(other)].triangle;
            if triangle != u32::MAX {
                found(triangle);
            }
        }
    }
}

fn try_triangle(surface: &Surface, triangle: u32, p: Vec3, best: &mut Nearest) {
    if triangle == best.triangle {
        return;
    }
    let d2 = closest_on_triangle(p, surface.corners(triangle)).1.distance_squared(p);
    if d2 < best.d2 || (d2 == best.d2 && triangle < best.triangle) {
        *best = Nearest { d2, triangle };
    }
}

fn map<T: Send + Sync>(for_each: ForEach, n: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let cells: Vec<OnceLock<T>> = (0..n).map(|_| OnceLock::new()).collect();
    for_each(n, &|i| {
        let _ = cells[i].set(f(i));
    });
    cells.into_iter().filter_map(OnceLock::into_inner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::closest::tests::sphere;
    use crate::maths::hash::Dice;

    fn in_order(n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).for_each(f);
    }
    fn backwards(n: usize, f: &(dyn Fn(usize) + Sync)) {
        (0..n).rev().for_each(f);
    }

    #[test]
    fn distances_in_the_band_are_right_to_a_tenth_of_a_cell() {
        let surface = sphere(6.0, 64);
        let field = DistanceField::new(&surface, &in_order);
        let dice = Dice::new(5, 0, "query");
        let (mut near, mut worst) = (0, 0.0f32);
        for id in 0..5000 {
            let p = Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 7.5;
            let exact = surface.signed_distance(p, &surface.closest(p).unwrap());
            match field.depth(p) {
                Depth::Near(d, gradient) => {
                    near += 1;
                    if exact.abs() < 1.0 {
                        worst = worst.max((d - exact).abs());
                        assert!(gradient.dot(p.normalize()) > 0.8, "{p} {gradient}");
                    }
                }
                Depth::Inside => assert!(exact < -0.9 * 1.0, "{p} {exact}"),
                Depth::Outside => assert!(exact > 0.9 * 1.0, "{p} {exact}"),
            }
        }
        assert!(near > 1500 && worst < 0.1 * CELL, "{near} {worst}");
    }

    #[test]
    fn the_order_of_blocks_does_not_matter() {
        let surface = sphere(3.0, 16);
        let (a, b) =
            (DistanceField::new(&surface, &in_order), DistanceField::new(&surface, &backwards));
        assert!(a.blocks == b.blocks && a.samples == b.samples);
    }

    #[test]
    fn a_mesh_of_any_size_is_answered() {
        let field = DistanceField::new(&sphere(1e6, 8), &in_order);
        assert_eq!(field.depth(Vec3::ZERO), Depth::Inside);
        assert_eq!(field.depth(Vec3::splat(2e6)), Depth::Outside);
        assert_eq!(field.depth(Vec3::NAN), Depth::Outside);
    }
}
