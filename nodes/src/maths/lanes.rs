//! Eight numbers at a time: lane `i` of every value belongs to hair `i` of a bundle.
//!
//! Kernels are written once, against `fearless_simd`, and compiled for each instruction set: on x86-64 for eight numbers (AVX2) and
//! for single ones, in tests also for four (SSE 4.2), elsewhere for what the machine has. The widest set that the machine supports is
//! chosen at run time.
//!
//! Guarantees: every width gives the same bits, because sums, products, quotients and square roots are rounded alike in each. Nothing is
//! fused (`mul_add`), estimated (`recip`) or left to the machine (`min` and `max` of -0 and NaN, whole numbers out of range).
//!
//! Everything called in lanes must be `#[inline(always)]`, closures included. What is not inlined is compiled without the instruction set:
//! the same bits, but several times slower, and no warning. `benches/kernels.rs` sets a limit for each kernel.

use super::transcendental;
use fearless_simd::Level;
pub(crate) use fearless_simd::{Simd, f32x8, mask32x8};
use glam::Vec3;
use std::ops::{Add, Mul, Sub};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Operations on numbers in lanes.
pub(crate) mod ops {
    pub(crate) use fearless_simd::prelude::*;
}
use ops::*;

/// Hairs in a bundle.
pub(crate) const LANES: usize = 8;

/// One number for each hair, in memory.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Eight(pub(crate) [f32; LANES]);

impl Eight {
    /// Loads the numbers into lanes.
    #[inline(always)]
    pub(crate) fn get<S: Simd>(&self, s: S) -> f32x8<S> {
        s.load_array_ref_f32x8(&self.0)
    }
    /// Stores numbers from lanes.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, x: f32x8<S>) {
        x.simd.store_array_f32x8(x, &mut self.0);
    }
}

/// Work that runs in lanes.
pub(crate) trait InLanes {
    /// Its result.
    type Out;
    /// Runs on the instruction set `s`.
    fn run<S: Simd>(self, s: S) -> Self::Out;
}

/// Runs `work` in the widest lanes of this machine.
#[inline]
pub(crate) fn in_lanes<T: InLanes>(work: T) -> T::Out {
    // Four at a time gains whole nodes nothing over single numbers, and each instruction set compiles every kernel once more: tests
    // alone have it.
    #[cfg(all(target_arch = "x86_64", not(test)))]
    return if let Some(eight) = level().as_avx2() {
        eight.vectorize(
            #[inline(always)]
            || work.run(eight),
        )
    } else {
        let one = fearless_simd::Fallback::new();
        one.vectorize(
            #[inline(always)]
            || work.run(one),
        )
    };
    #[cfg(any(not(target_arch = "x86_64"), test))]
    fearless_simd::dispatch!(level(), s => work.run(s))
}

fn level() -> Level {
    static WIDEST: OnceLock<Level> = OnceLock::new();
    #[cfg(test)]
    if let Some(forced) = FORCED.get() {
        return forced;
    }
    match SINGLE.load(Ordering::Relaxed) {
        true => single(),
        false => *WIDEST.get_or_init(Level::new),
    }
}

static SINGLE: AtomicBool = AtomicBool::new(false);

/// Switches to single numbers, or back to the widest lanes, for benches that compare the two.
pub fn use_single_numbers(single: bool) {
    SINGLE.store(single, Ordering::Relaxed);
}

/// One number at a time, or the narrowest lanes of a machine that always has some.
fn single() -> Level {
    #[cfg(target_arch = "x86_64")]
    return Level::Fallback(fearless_simd::Fallback::new());
    #[cfg(not(target_arch = "x86_64"))]
    return Level::new();
}

#[cfg(test)]
std::thread_local! {
    static FORCED: std::cell::Cell<Option<Level>> = const { std::cell::Cell::new(None) };
}

/// Runs `work` on this thread once in each width that the machine has; returns all results.
#[cfg(test)]
pub(crate) fn in_each_width<T>(work: impl Fn() -> T) -> Vec<T> {
    let run = |level| {
        FORCED.set(Some(level));
        let out = work();
        FORCED.set(None);
        out
    };
    let mut widths = vec![single(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    widths.extend(Level::new().as_sse4_2().map(Level::Sse4_2));
    widths.into_iter().map(run).collect()
}

/// `yes` in the lanes where `which` is set, `no` in the others.
#[inline(always)]
pub(crate) fn pick<S: Simd>(which: mask32x8<S>, yes: f32x8<S>, no: f32x8<S>) -> f32x8<S> {
    which.simd.select_f32x8(which, yes, no)
}

/// `x` from 0 to 1; NaN stays.
#[inline(always)]
pub(crate) fn clamp_to_one<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let s = x.simd;
    let x = pick(x.simd_lt(0.0), s.splat_f32x8(0.0), x);
    pick(x.simd_gt(1.0), s.splat_f32x8(1.0), x)
}

/// [`super::smoothstep`] in lanes.
#[inline(always)]
pub(crate) fn smoothstep<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let x = clamp_to_one(x);
    x * x * (3.0 - 2.0 * x)
}

/// [`transcendental::sin_cos_turns`] in lanes.
#[inline(always)]
pub(crate) fn sin_cos_turns<S: Simd>(turns: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    let s = turns.simd;
    let (quarters, near) = transcendental::quarters(turns);
    if s.any_false_mask32x8(near) {
        let turns = s.as_array_f32x8(turns).map(transcendental::sin_cos_turns);
        return (
            s.load_array_f32x8(turns.map(|both| both.0)),
            s.load_array_f32x8(turns.map(|both| both.1)),
        );
    }
    let (sin, cos) = transcendental::sin_cos_within(turns, quarters);
    let quarter = s.cvt_i32_f32x8(quarters);
    let is =
        |bit: i32| s.simd_eq_i32x8(s.and_i32x8(quarter, s.splat_i32x8(bit)), s.splat_i32x8(bit));
    let (odd, back) = (is(1), is(2));
    let (a, b) = (pick(odd, cos, sin), pick(odd, sin, cos));
    // The sine is negative in quarters 2 and 3, the cosine in 1 and 2.
    (pick(back, -a, a), pick(s.xor_mask32x8(odd, back), -b, b))
}

/// [`transcendental::sin_cos`] in lanes.
#[inline(always)]
pub(crate) fn sin_cos<S: Simd>(radians: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    sin_cos_turns(radians * (1.0 / std::f32::consts::TAU))
}

/// One vector for each hair.
#[derive(Clone, Copy)]
pub(crate) struct Vec3x8<S: Simd> {
    pub(crate) x: f32x8<S>,
    pub(crate) y: f32x8<S>,
    pub(crate) z: f32x8<S>,
}

impl<S: Simd> Vec3x8<S> {
    /// The same vector in all lanes.
    #[inline(always)]
    pub(crate) fn splat(s: S, v: Vec3) -> Self {
        Self { x: s.splat_f32x8(v.x), y: s.splat_f32x8(v.y), z: s.splat_f32x8(v.z) }
    }
    #[inline(always)]
    pub(crate) fn load(s: S, columns: &[Eight; 3]) -> Self {
        let [x, y, z] = columns;
        Self { x: x.get(s), y: y.get(s), z: z.get(s) }
    }
    #[inline(always)]
    pub(crate) fn store(self, columns: &mut [Eight; 3]) {
        let [x, y, z] = columns;
        x.set(self.x);
        y.set(self.y);
        z.set(self.z);
    }
    /// The vectors in memory, axis by axis.
    #[inline(always)]
    pub(crate) fn spilled(self) -> [Eight; 3] {
        let mut columns = [Eight::default(); 3];
        self.store(&mut columns);
        columns
    }
    #[inline(always)]
    pub(crate) fn dot(self, o: Self) -> f32x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    #[inline(always)]
    pub(crate) fn cross(self, o: Self) -> Self {
        Self {
            x: self.y * o.z - o.y * self.z,
            y: self.z * o.x - o.z * self.x,
            z: self.x * o.y - o.x * self.y,
        }
    }
    #[inline(always)]
    pub(crate) fn length(self) -> f32x8<S> {
        self.dot(self).sqrt()
    }
    /// The unit vectors, and the lanes that have one.
    #[inline(always)]
    pub(crate) fn unit(self) -> (Self, mask32x8<S>) {
        let per_length = 1.0 / self.length();
        let is = per_length.simd_gt(0.0) & per_length.simd_lt(f32::INFINITY);
        (self * per_length, is)
    }
    /// The component perpendicular to a unit vector.
    #[inline(always)]
    pub(crate) fn reject_from(self, unit: Self) -> Self {
        self - unit * self.dot(unit)
    }
    #[inline(always)]
    pub(crate) fn pick(which: mask32x8<S>, yes: Self, no: Self) -> Self {
        Self {
            x: pick(which, yes.x, no.x),
            y: pick(which, yes.y, no.y),
            z: pick(which, yes.z, no.z),
        }
    }
    /// The lanes where both are equal.
    #[inline(always)]
    pub(crate) fn is(self, o: Self) -> mask32x8<S> {
        self.x.simd_eq(o.x) & self.y.simd_eq(o.y) & self.z.simd_eq(o.z)
    }
    /// The lanes where all three coordinates are finite.
    #[inline(always)]
    pub(crate) fn is_finite(self) -> mask32x8<S> {
        let is = f32::INFINITY;
        self.x.abs().simd_lt(is) & self.y.abs().simd_lt(is) & self.z.abs().simd_lt(is)
    }
    /// Linear interpolation, in glam's order of operations.
    #[inline(always)]
    pub(crate) fn lerp(self, o: Self, t: f32x8<S>) -> Self {
        self * (1.0 - t) + o * t
    }
    /// The vectors, shortened to length 1 where they are longer; in glam's order of operations.
    #[inline(always)]
    pub(crate) fn within_one(self) -> Self {
        let square = self.dot(self);
        let root = square.sqrt();
        let shorter = Self { x: self.x / root, y: self.y / root, z: self.z / root };
        Self::pick(square.simd_gt(1.0), shorter, self)
    }
}

impl<S: Simd> Add for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}
impl<S: Simd> Sub for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}
impl<S: Simd> Mul<f32x8<S>> for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: f32x8<S>) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }
}

/// Maps each lane. (Unlike `array::map`, this is always inlined.)
#[inline(always)]
pub(crate) fn each<T, U>([a, b, c, d, e, f, g, h]: [T; LANES], map: impl Fn(T) -> U) -> [U; LANES] {
    [map(a), map(b), map(c), map(d), map(e), map(f), map(g), map(h)]
}

/// The vector of one lane.
#[inline(always)]
pub(crate) fn lane(columns: &[Eight; 3], lane: usize) -> Vec3 {
    Vec3::new(columns[0].0[lane], columns[1].0[lane], columns[2].0[lane])
}

/// Transposes four numbers of each hair into four columns.
#[inline(always)]
pub(crate) fn turned<S: Simd>(s: S, rows: [&[f32; 4]; LANES]) -> [f32x8<S>; 4] {
    let half = |from: usize| {
        let row = |k: usize| s.load_array_ref_f32x4(rows[from + k]);
        let (a, b) = s.interleave_f32x4(row(0), row(2));
        let (c, d) = s.interleave_f32x4(row(1), row(3));
        let ((x, y), (z, w)) = (s.interleave_f32x4(a, c), s.interleave_f32x4(b, d));
        [x, y, z, w]
    };
    let ([a, b, c, d], [e, f, g, h]) = (half(0), half(LANES / 2));
    [s.combine_f32x4(a, e), s.combine_f32x4(b, f), s.combine_f32x4(c, g), s.combine_f32x4(d, h)]
}

/// Transposes rows of numbers, one row per hair, into columns. Rows must be at least as long as there are columns.
#[inline(always)]
pub(crate) fn turn<S: Simd>(s: S, rows: &[&[f32]; LANES], columns: &mut [Eight]) {
    let (fours, rest) = columns.as_chunks_mut::<4>();
    for (k, columns) in fours.iter_mut().enumerate() {
        let four = turned(s, rows.map(|row| four_at(row, 4 * k)));
        columns.iter_mut().zip(four).for_each(|(column, x)| column.set(x));
    }
    let done = 4 * fours.len();
    for (k, column) in rest.iter_mut().enumerate() {
        column.0 = rows.map(|row| row[done + k]);
    }
}

/// Transposes four columns back into four numbers of each hair.
#[inline(always)]
pub(crate) fn turned_back<S: Simd>(s: S, columns: &[Eight; 4]) -> [[f32; 4]; LANES] {
    let [a, b, c, d] = columns;
    let (a, b) = (s.split_f32x8(a.get(s)), s.split_f32x8(b.get(s)));
    let (c, d) = (s.split_f32x8(c.get(s)), s.split_f32x8(d.get(s)));
    let half = |a, b, c, d| {
        let (e, f) = s.interleave_f32x4(a, c);
        let (g, h) = s.interleave_f32x4(b, d);
        let ((x, y), (z, w)) = (s.interleave_f32x4(e, g), s.interleave_f32x4(f, h));
        [s.as_array_f32x4(x), s.as_array_f32x4(y), s.as_array_f32x4(z), s.as_array_f32x4(w)]
    };
    let ([e, f, g, h], [i, j, k, l]) = (half(a.0, b.0, c.0, d.0), half(a.1, b.1, c.1, d.1));
    [e, f, g, h, i, j, k, l]
}

/// Four numbers of a row that holds them.
#[inline(always)]
pub(crate) fn four_at(row: &[f32], at: usize) -> &[f32; 4] {
    let (fours, _) = row[at..at + 4].as_chunks();
    &fours[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;
    use crate::maths::smoothstep as smoothstep_of_one;

    /// Compares a function of eight numbers, in each width, with one of a single number.
    macro_rules! check {
        ($of:expr, $lanes:ident, $one:expr) => {{
            struct Run(Eight);
            impl InLanes for Run {
                type Out = [Eight; 2];
                #[inline(always)]
                fn run<S: Simd>(self, s: S) -> [Eight; 2] {
                    let mut out = [Eight::default(); 2];
                    let both: [f32x8<S>; 2] = $lanes(self.0.get(s)).into();
                    out.iter_mut().zip(both).for_each(|(out, x)| out.set(x));
                    out
                }
            }
            for x in $of {
                let want: [[f32; LANES]; 2] = {
                    let both = x.map($one);
                    [both.map(|b: [f32; 2]| b[0]), both.map(|b: [f32; 2]| b[1])]
                };
                for got in in_each_width(|| in_lanes(Run(Eight(x)))) {
                    let bits =
                        |x: [f32; LANES]| x.map(|x| if x.is_nan() { 0 } else { x.to_bits() });
                    assert_eq!(got.map(|c| bits(c.0)), want.map(bits), "{x:?}");
                }
            }
        }};
    }

    fn numbers() -> impl Iterator<Item = [f32; LANES]> {
        let dice = Dice::new(1, 2, "lanes");
        let odd = [0.0, -0.0, 1.0, f32::NAN, f32::INFINITY, -3e9, 0.125, -0.375];
        let drawn = move |row: u64| {
            std::array::from_fn(|i| dice.signed(row, i as u64) * [1.0, 30.0, 1e5][row as usize % 3])
        };
        std::iter::once(odd).chain((0..400).map(drawn))
    }

    #[inline(always)]
    fn smooth<S: Simd>(x: f32x8<S>) -> [f32x8<S>; 2] {
        [smoothstep(x), clamp_to_one(x)]
    }

    #[test]
    fn lanes_give_what_single_numbers_give() {
        check!(numbers(), sin_cos_turns, |x| transcendental::sin_cos_turns(x).into());
        check!(numbers(), sin_cos, |x| transcendental::sin_cos(x).into());
        check!(numbers(), smooth, |x: f32| [smoothstep_of_one(x), x.clamp(0.0, 1.0)]);
    }

    #[test]
    fn rows_survive_being_transposed_and_back() {
        struct Turn<'a>(&'a [&'a [f32]; LANES]);
        impl InLanes for Turn<'_> {
            type Out = (Vec<Eight>, [[f32; 4]; LANES]);
            #[inline(always)]
            fn run<S: Simd>(self, s: S) -> Self::Out {
                let mut columns = vec![Eight::default(); self.0[0].len()];
                turn(s, self.0, &mut columns);
                let back = turned_back(s, &columns.as_chunks().0[0]);
                (columns, back)
            }
        }
        let rows: [Vec<f32>; LANES] =
            std::array::from_fn(|i| (0..15).map(|k| (100 * i + k) as f32).collect());
        let rows = rows.each_ref().map(|row| &row[..]);
        for (columns, back) in in_each_width(|| in_lanes(Turn(&rows))) {
            for (k, column) in columns.iter().enumerate() {
                assert_eq!(column.0, rows.map(|row| row[k]));
            }
            assert_eq!(back, rows.map(|row| *four_at(row, 0)));
        }
    }
}
