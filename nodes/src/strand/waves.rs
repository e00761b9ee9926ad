//! Smooth random vectors, in space or along a hair.
//!
//! Random values at the corners of a lattice of half a wavelength are blended; finer octaves are added. Guarantees: no vector is
//! longer than 1; the same on every machine and at every width of lanes; along a hair, vectors depend on its id and the position alone.

use crate::maths::hash::Dice;
use crate::maths::lanes::{Eight, LANES, Simd, Vec3x8, each, f32x8, four_at, lane, ops::*, turned};
use glam::Vec3;

/// Noise with these octaves.
pub(super) struct Waves {
    pub dice: Dice,
    /// Number of octaves, each with half the wavelength of the one before.
    pub octaves: u32,
    /// Amplitude of each octave relative to the one before.
    pub roughness: f32,
}

/// Weight of the second of two corners at this fraction of the way: slope and curvature vanish at both.
fn blend(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn vector(bits: u64) -> Vec3 {
    let part = |shift: u32| ((bits >> shift) & 0x1F_FFFF) as f32 * (2.0 / 0x20_0000 as f32) - 1.0;
    Vec3::new(part(0), part(21), part(42))
}

impl Waves {
    /// At a position in space, in wavelengths.
    pub(super) fn in_space(&self, p: Vec3) -> Vec3 {
        self.octaves(|octave, scale| {
            let q = p * (2.0 * scale);
            let low = q.floor();
            let t = (q - low).to_array().map(blend);
            let corners = self.corners(octave, low.to_array().map(|x| x as i64));
            let mut sum = Vec3::ZERO;
            for (corner, vector) in corners.into_iter().enumerate() {
                let share = |a: usize| if corner >> a & 1 == 1 { t[a] } else { 1.0 - t[a] };
                sum += vector * (share(0) * share(1) * share(2));
            }
            sum
        })
    }
    /// Random vectors at the corners of a cell. Bit `a` of a corner's number says whether it is the upper one along axis `a`.
    fn corners(&self, octave: u64, cell: [i64; 3]) -> [Vec3; 8] {
        let side = |a: usize, high: usize| cell[a].saturating_add(high as i64) as u64;
        // Draws that corners share.
        let of_x = [0, 1].map(|x| self.dice.bits(octave, side(0, x)));
        let of_y = [0, 1, 2, 3].map(|xy| self.dice.bits(of_x[xy & 1], side(1, xy >> 1)));
        std::array::from_fn(|corner| vector(self.dice.bits(of_y[corner & 3], side(2, corner >> 2))))
    }
    /// On the hair with this id, at a distance from its root in wavelengths.
    #[cfg(test)]
    fn along(&self, id: u64, x: f32) -> Vec3 {
        self.octaves(|octave, scale| {
            let q = x * (2.0 * scale);
            let low = q.floor();
            let [a, b] = [low, low + 1.0].map(|at| self.on_hair(id, octave, at));
            a.lerp(b, blend(q - low))
        })
    }
    /// Random vector of a hair at a whole number of half wavelengths.
    fn on_hair(&self, id: u64, octave: u64, at: f32) -> Vec3 {
        vector(self.dice.bits(id, (at as i64 as u64).wrapping_mul(64) + octave))
    }
    fn octaves(&self, value: impl Fn(u64, f32) -> Vec3) -> Vec3 {
        let (mut sum, mut all, mut share, mut scale) = (Vec3::ZERO, 0.0, 1.0, 1.0);
        for octave in 0..self.octaves {
            sum += value(u64::from(octave), scale) * share;
            all += share;
            share *= self.roughness;
            scale *= 2.0;
        }
        (sum / all.max(1e-6)).clamp_length_max(1.0)
    }
    /// [`Self::octaves`] in lanes.
    #[inline(always)]
    fn octaves_of<S: Simd>(&self, s: S, mut value: impl FnMut(u64, f32) -> Vec3x8<S>) -> Vec3x8<S> {
        let mut sum = Vec3x8::splat(s, Vec3::ZERO);
        let (mut all, mut share, mut scale) = (0.0f32, 1.0f32, 1.0);
        for octave in 0..self.octaves {
            sum = sum + value(u64::from(octave), scale) * s.splat_f32x8(share);
            all += share;
            share *= self.roughness;
            scale *= 2.0;
        }
        let all = all.max(1e-6);
        Vec3x8 { x: sum.x / all, y: sum.y / all, z: sum.z / all }.within_one()
    }
}

/// [`blend`] in lanes.
#[inline(always)]
fn blended<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Whole numbers as integers.
#[inline(always)]
fn whole<S: Simd>(x: f32x8<S>) -> [i32; LANES] {
    x.simd.as_array_i32x8(x.simd.cvt_i32_f32x8(x))
}

/// Waves in space, for the hair of one tuft. Each cell of the lattice is drawn once and kept: neighbouring points share most of them.
pub(super) struct InSpace<'a> {
    waves: &'a Waves,
    /// Index into `cells`, by a hash of octave and position.
    slots: Vec<u16>,
    cells: Vec<Cell>,
}

/// A cell with the random vectors at its corners.
struct Cell {
    octave: u64,
    at: [i32; 3],
    corners: [f32; 24],
}

/// log2 of the number of slots.
const SLOTS: u32 = 10;
/// Cells are discarded once there are more than this.
const MOST_CELLS: usize = 4096;
/// A slot without a cell.
const EMPTY: u16 = u16::MAX;
/// Positions closer to the origin than this (wavelengths) have cell numbers that fit 32 bits in every octave.
const NEAR: f32 = 4e6;

impl<'a> InSpace<'a> {
    pub(super) fn new(waves: &'a Waves) -> Self {
        Self { waves, slots: vec![EMPTY; 1 << SLOTS], cells: vec![] }
    }
    /// [`Waves::in_space`] in lanes.
    #[inline(always)]
    pub(super) fn at<S: Simd>(&mut self, p: Vec3x8<S>) -> Vec3x8<S> {
        let s = p.x.simd;
        let near = p.x.abs().simd_lt(NEAR) & p.y.abs().simd_lt(NEAR) & p.z.abs().simd_lt(NEAR);
        if s.any_false_mask32x8(near) {
            let (p, mut out) = (p.spilled(), [Eight::default(); 3]);
            for i in 0..LANES {
                let v = self.waves.in_space(lane(&p, i));
                [out[0].0[i], out[1].0[i], out[2].0[i]] = v.to_array();
            }
            return Vec3x8::load(s, &out);
        }
        let waves = self.waves;
        waves.octaves_of(
            s,
            #[inline(always)]
            |octave, scale| {
                let q = p * s.splat_f32x8(2.0 * scale);
                let low = Vec3x8 { x: q.x.floor(), y: q.y.floor(), z: q.z.floor() };
                let t = q - low;
                let t = [blended(t.x), blended(t.y), blended(t.z)];
                let [x, y, z] = [whole(low.x), whole(low.y), whole(low.z)];
                if self.cells.len() > MOST_CELLS {
                    self.cells.clear();
                    self.slots.fill(EMPTY);
                }
                let mut at = [0; LANES];
                for (i, at) in at.iter_mut().enumerate() {
                    *at = self.cell(octave, [x[i], y[i], z[i]]);
                }
                let rows = each(
                    at,
                    #[inline(always)]
                    |at| &self.cells[at].corners,
                );
                let mut drawn = [s.splat_f32x8(0.0); 24];
                for (k, drawn) in drawn.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                    *drawn = turned(
                        s,
                        each(
                            rows,
                            #[inline(always)]
                            |row| four_at(row, 4 * k),
                        ),
                    );
                }
                let mut sum = Vec3x8::splat(s, Vec3::ZERO);
                let [x, y, z] = t;
                let [x, y, z] = [[1.0 - x, x], [1.0 - y, y], [1.0 - z, z]];
                for (corner, v) in drawn.as_chunks::<3>().0.iter().enumerate() {
                    let v = Vec3x8 { x: v[0], y: v[1], z: v[2] };
                    let share = x[corner & 1] * y[corner >> 1 & 1] * z[corner >> 2];
                    sum = sum + v * share;
                }
                sum
            },
        )
    }
    /// Index of a cell in `cells`.
    #[inline(always)]
    fn cell(&mut self, octave: u64, at: [i32; 3]) -> usize {
        let mixed = |x: i32, by: u32| (x as u32).wrapping_mul(by);
        let hash = mixed(at[0], 0x9E37_79B1)
            ^ mixed(at[1], 0x85EB_CA77)
            ^ mixed(at[2], 0xC2B2_AE3D)
            ^ mixed(octave as i32, 0x27D4_EB2F);
        let slot = (hash >> (32 - SLOTS)) as usize;
        match self.cells.get(self.slots[slot] as usize) {
            Some(cell) if cell.at == at && cell.octave == octave => self.slots[slot] as usize,
            _ => self.drawn(octave, at, slot),
        }
    }
    #[inline(never)]
    fn drawn(&mut self, octave: u64, at: [i32; 3], slot: usize) -> usize {
        let mut corners = [0.0; 24];
        let drawn = self.waves.corners(octave, at.map(i64::from));
        corners.copy_from_slice(bytemuck::cast_slice(&drawn));
        let cell = Cell { octave, at, corners };
        // The cell that had this slot stays: another lane may be using it.
        self.cells.push(cell);
        let at = self.cells.len() - 1;
        self.slots[slot] = at as u16;
        at
    }
}

/// Waves along hairs. The last interval of each lane is kept, since the next point usually lies in it.
pub(super) struct OnHairs<'a> {
    waves: &'a Waves,
    /// By octave and lane.
    last: Vec<[Drawn; LANES]>,
}

/// The random vectors at both ends of an interval of half a wavelength.
#[derive(Clone, Copy)]
struct Drawn {
    id: u64,
    low: f32,
    ends: [Vec3; 2],
}

impl<'a> OnHairs<'a> {
    pub(super) fn new(waves: &'a Waves) -> Self {
        let none = Drawn { id: 0, low: f32::NAN, ends: [Vec3::ZERO; 2] };
        Self { waves, last: vec![[none; LANES]; waves.octaves as usize] }
    }
    /// The waves of the hairs with these ids, at these distances from their roots in wavelengths.
    #[inline(always)]
    pub(super) fn at<S: Simd>(&mut self, ids: &[u64; LANES], x: f32x8<S>) -> Vec3x8<S> {
        let (s, waves) = (x.simd, self.waves);
        waves.octaves_of(
            s,
            #[inline(always)]
            |octave, scale| {
                let q = x * (2.0 * scale);
                let low = q.floor();
                let mut ends = [[Eight::default(); 3]; 2];
                let lows = s.as_array_f32x8(low);
                for (i, last) in self.last[octave as usize].iter_mut().enumerate() {
                    last.go_on(waves, octave, ids[i], lows[i]);
                    for (end, v) in ends.iter_mut().zip(last.ends) {
                        [end[0].0[i], end[1].0[i], end[2].0[i]] = v.to_array();
                    }
                }
                let (a, b) = (Vec3x8::load(s, &ends[0]), Vec3x8::load(s, &ends[1]));
                a.lerp(b, blended(q - low))
            },
        )
    }
}

impl Drawn {
    /// Advances to the interval that starts at `low`.
    #[inline(always)]
    fn go_on(&mut self, waves: &Waves, octave: u64, id: u64, low: f32) {
        let same = self.id == id;
        if same && self.low == low {
            return;
        }
        let next = same && self.low + 1.0 == low;
        let first = if next { self.ends[1] } else { waves.on_hair(id, octave, low) };
        *self = Self { id, low, ends: [first, waves.on_hair(id, octave, low + 1.0)] };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::lanes::{InLanes, in_each_width, in_lanes};

    #[test]
    fn waves_are_smooth_and_stay_within_one_and_fill_a_good_part_of_it() {
        for (octaves, roughness) in [(1, 0.5), (4, 0.5), (3, 1.0)] {
            let waves = Waves { dice: Dice::new(4, 0, "waves"), octaves, roughness };
            let (mut step, mut sum, n) = (0.0f32, 0.0, 4000);
            for k in 0..n {
                let x = k as f32 * 0.003;
                let far = Vec3::new(x, -x, 40.0 - 2.0 * x);
                let pairs = [
                    (waves.along(9, x), waves.along(9, x + 0.001)),
                    (waves.in_space(far), waves.in_space(far + Vec3::X * 0.001)),
                ];
                for (a, b) in pairs {
                    assert!(a.length() <= 1.0001);
                    step = step.max(a.distance(b));
                    sum += a.length();
                }
            }
            let mean = sum / (2 * n) as f32;
            assert!((0.3..0.9).contains(&mean), "{mean}");
            // The steepest blend of two opposite corners: 15/8 on a way of half a wave, each octave twice as steep.
            assert!(step < 0.001 * 2.0 * 1.875 * 3.5 * octaves as f32, "{step}");
        }
    }

    #[test]
    fn waves_have_the_same_bits_in_lanes_of_every_width() {
        struct At<'a>(&'a Waves, [Vec3; LANES], bool);
        impl InLanes for At<'_> {
            type Out = [Vec3; LANES];
            #[inline(always)]
            fn run<S: Simd>(self, s: S) -> Self::Out {
                let column = |axis: usize| s.load_array_f32x8(self.1.map(|p| p[axis]));
                let p = Vec3x8 { x: column(0), y: column(1), z: column(2) };
                let wave = match self.2 {
                    true => InSpace::new(self.0).at(p),
                    false => OnHairs::new(self.0).at(&[1, 2, 3, 4, 5, 6, 7, 1], p.x),
                };
                let wave = wave.spilled();
                std::array::from_fn(|i| lane(&wave, i))
            }
        }
        let dice = Dice::new(7, 0, "places");
        for (octaves, roughness) in [(1, 0.5), (8, 0.9)] {
            let waves = Waves { dice: Dice::new(4, 0, "waves"), octaves, roughness };
            for row in 0..300u64 {
                let far = [3.0, 40.0, 1e5, 1e9][row as usize % 4];
                let axis = |k: u64| dice.signed(row, k) * far;
                let mut places: [Vec3; LANES] =
                    std::array::from_fn(|i| Vec3::from([0, 1, 2].map(|a| axis(3 * i as u64 + a))));
                places[7] = [places[7], Vec3::NAN, Vec3::INFINITY][row as usize % 3];
                let same = |a: Vec3, b: Vec3| a == b || a.is_nan() && b.is_nan();
                for got in in_each_width(|| in_lanes(At(&waves, places, true))) {
                    assert!(
                        (0..LANES).all(|i| same(got[i], waves.in_space(places[i]))),
                        "{places:?}"
                    );
                }
                for got in in_each_width(|| in_lanes(At(&waves, places, false))) {
                    let one = |i: usize| waves.along([1, 2, 3, 4, 5, 6, 7, 1][i], places[i].x);
                    assert!((0..LANES).all(|i| same(got[i], one(i))), "{places:?}");
                }
            }
        }
    }
}
