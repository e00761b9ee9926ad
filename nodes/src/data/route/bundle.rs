//! Bundles: eight hairs of a tuft side by side, for nodes that move hair ([`Bend`]) or compute a number for each point ([`Tell`]).
//!
//! A tuft stores points one after the other. A bundle holds them transposed, one hair per lane, so that whatever runs along a hair (lengths,
//! frames, waves) runs for eight hairs at once; results are transposed back. Hairs with equal numbers of points share bundles as far as
//! possible. Shorter hairs are padded with their tips, and results for padding are dropped.
//!
//! Guarantees: a hair's bits depend neither on the other hairs in its bundle nor on the width of lanes; a hair that is not moved keeps its
//! bits. Lengths are those of the straight segments between points, which is what *keep length* keeps. Not promised: anything for curves
//! that are not hair (fewer than two points, no length, not finite). They pass through unchanged, but a bender sees their points and must
//! not panic on them.

use super::Lengths;
use crate::data::attributes::ID;
use crate::data::curves::Tuft;
use crate::data::field::Sampler;
use crate::maths::frame::{any_normal, reflect_twice};
use crate::maths::lanes::{
    Eight, InLanes, LANES, Simd, Vec3x8, f32x8, in_lanes, lane, mask32x8, ops::*, pick, turn,
    turned_back,
};
use glam::Vec3;

/// A node that moves hair: it computes where each point should go; [`Route`](super::Route) decides where it may.
pub(crate) trait Bend {
    /// Sets the wished points of eight hairs in `wish`, which holds their present points. Wishes for roots are ignored. Implementations
    /// must be `#[inline(always)]`, as must everything they call in lanes.
    fn bend<S: Simd>(&mut self, hairs: &Hairs<S>, wish: &mut Wish<S>);
}

/// The wished points of eight hairs.
pub(crate) struct Wish<'a, S: Simd> {
    s: S,
    points: &'a mut [[Eight; 3]],
}

impl<S: Simd> Wish<'_, S> {
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> Vec3x8<S> {
        Vec3x8::load(self.s, &self.points[k])
    }
    #[inline(always)]
    pub(crate) fn set(&mut self, k: usize, p: Vec3x8<S>) {
        p.store(&mut self.points[k]);
    }
}

/// Eight hairs as they are, with distances, tangents and frames along them.
pub(crate) struct Hairs<'a, S: Simd> {
    /// The instruction set.
    pub(crate) s: S,
    /// Index of each hair in its tuft, and its id. If fewer than eight hairs are left, the last one is repeated.
    pub(crate) numbers: &'a [usize; LANES],
    pub(crate) ids: &'a [u64; LANES],
    /// Index of each hair's first point in the tuft, and its number of points.
    firsts: &'a [usize; LANES],
    counts: &'a [usize; LANES],
    points: &'a [[Eight; 3]],
    come: &'a [Eight],
}

impl<S: Simd> Hairs<'_, S> {
    /// Number of points of the longest hair.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }
    #[inline(always)]
    pub(crate) fn point(&self, k: usize) -> Vec3x8<S> {
        Vec3x8::load(self.s, &self.points[k])
    }
    /// Point `k` of one hair; its tip if it has fewer points.
    #[inline(always)]
    pub(crate) fn of_lane(&self, k: usize, of: usize) -> Vec3 {
        lane(&self.points[k], of)
    }
    /// Distance along each hair from its root to point `k`, cm.
    #[inline(always)]
    pub(crate) fn come(&self, k: usize) -> f32x8<S> {
        self.come[k].get(self.s)
    }
    /// That distance on one hair.
    #[inline(always)]
    pub(crate) fn come_of_lane(&self, k: usize, of: usize) -> f32 {
        self.come[k].0[of]
    }
    /// Lengths, cm.
    #[inline(always)]
    pub(crate) fn length(&self) -> f32x8<S> {
        self.come(self.len() - 1)
    }
    /// That distance as a fraction of the hair's length.
    #[inline(always)]
    pub(crate) fn u(&self, k: usize) -> f32x8<S> {
        let u = self.come(k) / self.length();
        pick(u.simd_lt(1.0), u, self.s.splat_f32x8(1.0))
    }
    /// The lanes whose hair has a point `k`.
    #[inline(always)]
    pub(crate) fn has(&self, k: usize) -> mask32x8<S> {
        self.own_count().simd_gt(k as f32)
    }
    #[inline(always)]
    fn own_count(&self) -> f32x8<S> {
        let mut counts = Eight::default();
        for (to, count) in counts.0.iter_mut().zip(self.counts) {
            *to = *count as f32;
        }
        counts.get(self.s)
    }
    /// The position on one hair at `s` cm from its root; its tip beyond its end.
    pub(crate) fn at(&self, of: usize, s: f32) -> Vec3 {
        let after = self.come.partition_point(|come| come.0[of] <= s);
        let (Some(before), Some(end)) = (after.checked_sub(1), self.come.get(after)) else {
            return self.of_lane(after.saturating_sub(1), of);
        };
        let t = (s - self.come[before].0[of]) / (end.0[of] - self.come[before].0[of]);
        self.of_lane(before, of).lerp(self.of_lane(after, of), t)
    }
    /// A number for each hair, computed from its id.
    #[inline(always)]
    pub(crate) fn own(&self, compute: impl Fn(u64) -> f32) -> f32x8<S> {
        let mut own = Eight::default();
        for (own, id) in own.0.iter_mut().zip(self.ids) {
            *own = compute(*id);
        }
        own.get(self.s)
    }
    /// The value of a field at point `k`.
    #[inline(always)]
    pub(crate) fn field(&self, field: &Sampler, k: usize) -> f32x8<S> {
        self.field_at(field, k, self.u(k))
    }
    /// The value of a field at point `k`, which counts as the fraction `u` of its hair.
    #[inline(always)]
    pub(crate) fn field_at(&self, field: &Sampler, k: usize, u: f32x8<S>) -> f32x8<S> {
        let mut points = *self.firsts;
        for (point, count) in points.iter_mut().zip(self.counts) {
            *point += k.min(count - 1);
        }
        field.at_each(self.numbers, &points, u)
    }
    /// Unit tangents at point `k`.
    #[inline(always)]
    pub(crate) fn tangent(&self, k: usize) -> Vec3x8<S> {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(self.len() - 1));
        let (tangent, is) = (self.point(after) - self.point(before)).unit();
        // Where points repeat or a hair turns back on itself, the direction of the nearest segment that has one.
        rarely(tangent, is, |i| {
            let piece = |at: usize| self.of_lane(at + 1, i) - self.of_lane(at, i);
            let mut pieces = before..self.len() - 1;
            pieces.find_map(|at| piece(at).try_normalize()).unwrap_or(Vec3::Y)
        })
    }
    /// Frames (tangent and normal) at all points, rotation-minimising from the root on.
    #[inline(always)]
    pub(crate) fn frames(&self, frames: &mut Vec<[[Eight; 3]; 2]>) {
        frames.clear();
        let mut tangent = self.tangent(0);
        let mut normal =
            rarely(tangent, self.s.splat_mask32x8(0), |i| any_normal(spilled(tangent, i)));
        frames.push([tangent.spilled(), normal.spilled()]);
        for k in 1..self.len() {
            let (to, step) = (self.tangent(k), self.point(k) - self.point(k - 1));
            normal = reflected_twice(normal, step, tangent, to);
            tangent = to;
            frames.push([tangent.spilled(), normal.spilled()]);
        }
    }
}

/// `v` in the lanes where `is` is set; in the others, the result of `compute` for that lane. For branches that few hairs take.
#[inline(always)]
fn rarely<S: Simd>(v: Vec3x8<S>, is: mask32x8<S>, compute: impl Fn(usize) -> Vec3) -> Vec3x8<S> {
    if v.x.simd.all_true_mask32x8(is) {
        return v;
    }
    let (mut out, is) = (v.spilled(), v.x.simd.as_array_mask32x8(is));
    for i in (0..LANES).filter(|i| is[*i] == 0) {
        [out[0].0[i], out[1].0[i], out[2].0[i]] = compute(i).to_array();
    }
    Vec3x8::load(v.x.simd, &out)
}

#[inline(always)]
fn spilled<S: Simd>(v: Vec3x8<S>, of: usize) -> Vec3 {
    lane(&v.spilled(), of)
}

/// [`reflect_twice`] in lanes.
#[inline(always)]
fn reflected_twice<S: Simd>(
    normal: Vec3x8<S>,
    step: Vec3x8<S>,
    from: Vec3x8<S>,
    to: Vec3x8<S>,
) -> Vec3x8<S> {
    let c1 = step.dot(step);
    let per = 2.0 / c1;
    let (n, t) = (normal - step * (per * step.dot(normal)), from - step * (per * step.dot(from)));
    let second = to - t;
    let c2 = second.dot(second);
    let reflected = n - second * (2.0 / c2 * second.dot(n));
    let part = reflected - to * reflected.dot(to);
    let (unit, is) = part.unit();
    let long = part.dot(part).simd_gt(1e-12 * reflected.dot(reflected));
    let is = is & long & c1.simd_gt(1e-20) & c2.simd_gt(1e-12);
    rarely(unit, is, |i| {
        reflect_twice(spilled(normal, i), spilled(step, i), spilled(from, i), spilled(to, i))
    })
}

/// The state of a hair after bending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Wished {
    /// No point was moved.
    #[default]
    Stays,
    /// Some points were moved.
    Moved,
    /// A wished point is not finite.
    Far,
}

/// A node that computes a number for each point.
pub(crate) trait Tell {
    /// The number for point `k` of eight hairs, at the fraction `u` of their lengths (0 on a hair without length). See [`Bend::bend`] for
    /// inlining.
    fn tell<S: Simd>(&mut self, hairs: &Hairs<S>, k: usize, u: f32x8<S>) -> f32x8<S>;
}

/// The numbers for all points of a tuft. Calls `tick` once per hair.
pub(crate) fn told<E>(
    tuft: &Tuft,
    tell: &mut impl Tell,
    mut tick: impl FnMut() -> Result<(), E>,
) -> Result<Vec<f32>, E> {
    let mut out = vec![0.0; tuft.points().len()];
    let mut bundle = Bundle::default();
    for numbers in alike(tuft, 1).chunks(LANES) {
        numbers.iter().try_for_each(|_| tick())?;
        bundle.pick(tuft, numbers);
        in_lanes(Read { bundle: &mut bundle, points: tuft.points() });
        in_lanes(TellOne { bundle: &bundle, tell, out: &mut out });
    }
    Ok(out)
}

/// Indices of the hairs with at least `least` points, sorted by number of points.
fn alike(tuft: &Tuft, least: usize) -> Vec<usize> {
    let count = |i: usize| tuft.range(i).len();
    let mut order: Vec<usize> = (0..tuft.len()).filter(|i| count(*i) >= least).collect();
    order.sort_by_key(|i| count(*i));
    order
}

/// The wished points of a tuft, with segment lengths restored if `lengths` is [`Lengths::Kept`], and the state of each hair. Points of hairs
/// that are not to be moved are the old ones. Calls `tick` once per hair.
pub(super) fn wished<E>(
    tuft: &Tuft,
    lengths: Lengths,
    bend: &mut impl Bend,
    mut tick: impl FnMut() -> Result<(), E>,
) -> Result<(Vec<Vec3>, Vec<Wished>), E> {
    let mut out = vec![Vec3::ZERO; tuft.points().len()];
    let mut became = vec![Wished::Stays; tuft.len()];
    let mut bundle = Bundle::default();
    for numbers in alike(tuft, 2).chunks(LANES) {
        numbers.iter().try_for_each(|_| tick())?;
        bundle.pick(tuft, numbers);
        in_lanes(Read { bundle: &mut bundle, points: tuft.points() });
        in_lanes(BendOne { bundle: &mut bundle, bend });
        in_lanes(Lay { bundle: &mut bundle, kept: lengths == Lengths::Kept, out: &mut out });
        for (i, wished) in numbers.iter().zip(bundle.became) {
            became[*i] = wished;
        }
    }
    for (i, wished) in became.iter().enumerate() {
        if *wished != Wished::Moved {
            out[tuft.range(i)].copy_from_slice(tuft.curve(i));
        }
    }
    Ok((out, became))
}

/// The buffers of one bundle. Reusable.
#[derive(Default)]
struct Bundle {
    numbers: [usize; LANES],
    ids: [u64; LANES],
    firsts: [usize; LANES],
    counts: [usize; LANES],
    points: Vec<[Eight; 3]>,
    come: Vec<Eight>,
    wish: Vec<[Eight; 3]>,
    became: [Wished; LANES],
}

impl Bundle {
    /// Selects one to eight hairs.
    fn pick(&mut self, tuft: &Tuft, numbers: &[usize]) {
        self.numbers = std::array::from_fn(|lane| numbers[lane.min(numbers.len() - 1)]);
        let ids = tuft.view(ID);
        self.firsts = self.numbers.map(|i| tuft.range(i).start);
        self.ids = std::array::from_fn(|lane| ids.at(self.numbers[lane], self.firsts[lane]));
        self.counts = self.numbers.map(|i| tuft.range(i).len());
    }
    /// The smallest and the largest number of points.
    fn span(&self) -> (usize, usize) {
        self.counts.iter().fold((usize::MAX, 0), |(few, most), n| (few.min(*n), most.max(*n)))
    }
}

/// Transposes the points of the selected hairs and measures distances along them.
struct Read<'a> {
    bundle: &'a mut Bundle,
    points: &'a [Vec3],
}

impl InLanes for Read<'_> {
    type Out = ();
    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let (few, n) = self.bundle.span();
        let Bundle { firsts, counts, points, come, .. } = self.bundle;
        points.resize(n, [Eight::default(); 3]);
        come.resize(n, Eight::default());
        let all: &[f32] = bytemuck::cast_slice(self.points);
        let rows: [&[f32]; LANES] =
            std::array::from_fn(|i| &all[3 * firsts[i]..3 * (firsts[i] + counts[i])]);
        turn(s, &rows, points[..few].as_flattened_mut());
        for (k, columns) in points.iter_mut().enumerate().skip(few) {
            for (axis, column) in columns.iter_mut().enumerate() {
                column.0 = std::array::from_fn(|i| rows[i][3 * k.min(counts[i] - 1) + axis]);
            }
        }
        let (mut before, mut sum) = (Vec3x8::load(s, &points[0]), s.splat_f32x8(0.0));
        come[0].set(sum);
        for k in 1..n {
            let p = Vec3x8::load(s, &points[k]);
            sum += (p - before).length();
            come[k].set(sum);
            before = p;
        }
    }
}

struct BendOne<'a, B> {
    bundle: &'a mut Bundle,
    bend: &'a mut B,
}

impl<B: Bend> InLanes for BendOne<'_, B> {
    type Out = ();
    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Bundle { numbers, ids, firsts, counts, points, come, wish, .. } = self.bundle;
        wish.clone_from(points);
        let hairs = Hairs { s, numbers, ids, firsts, counts, points, come };
        self.bend.bend(&hairs, &mut Wish { s, points: wish });
    }
}

struct TellOne<'a, T> {
    bundle: &'a Bundle,
    tell: &'a mut T,
    out: &'a mut [f32],
}

impl<T: Tell> InLanes for TellOne<'_, T> {
    type Out = ();
    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Bundle { numbers, ids, firsts, counts, points, come, .. } = self.bundle;
        let hairs = Hairs { s, numbers, ids, firsts, counts, points, come };
        let (zero, one, length) = (s.splat_f32x8(0.0), s.splat_f32x8(1.0), hairs.length());
        let per_length = pick(length.simd_gt(0.0), 1.0 / length, zero);
        let (mut k, n) = (0, hairs.len());
        while k < n {
            let mut four = [Eight::default(); 4];
            for (at, column) in (k..n).zip(&mut four) {
                let u = hairs.come(at) * per_length;
                column.set(self.tell.tell(&hairs, at, pick(u.simd_lt(1.0), u, one)));
            }
            let rows = turned_back(s, &four);
            for ((first, count), row) in firsts.iter().zip(counts).zip(rows) {
                // Shorter hairs end earlier.
                for (at, x) in (k..*count).zip(row) {
                    self.out[first + at] = x;
                }
            }
            k += 4;
        }
    }
}

/// Restores lengths, determines the state of each hair, and transposes the wished points back.
struct Lay<'a> {
    bundle: &'a mut Bundle,
    kept: bool,
    out: &'a mut [Vec3],
}

impl InLanes for Lay<'_> {
    type Out = ();
    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let (few, n) = self.bundle.span();
        let Bundle { firsts, counts, points, come, wish, became, .. } = self.bundle;
        wish[0] = points[0];
        let ends = s.load_array_f32x8(counts.map(|n| n as f32));
        let (no, yes) = (s.splat_mask32x8(0), s.splat_mask32x8(-1));
        let (mut moved, mut finite) = (no, yes);
        let (mut before, mut laid, mut there_before) = {
            let root = Vec3x8::load(s, &points[0]);
            (root, root, root)
        };
        let mut moved_before = no;
        for k in 1..n {
            let (wanted, there) = (Vec3x8::load(s, &wish[k]), Vec3x8::load(s, &points[k]));
            let is_its = ends.simd_gt(k as f32);
            let differs = !wanted.is(there);
            moved |= differs & is_its;
            let mut p = wanted;
            if self.kept {
                let was = there - there_before;
                let (straight, has) = was.unit();
                let straight = Vec3x8::pick(has, straight, Vec3x8::splat(s, Vec3::ZERO));
                let (way, is) = (wanted - before).unit();
                let again = laid + Vec3x8::pick(is, way, straight) * was.length();
                // A segment that was not moved keeps its bits.
                p = Vec3x8::pick(differs | moved_before, again, wanted);
                moved_before = !p.is(there);
                p.store(&mut wish[k]);
                (before, laid, there_before) = (wanted, p, there);
            }
            finite &= p.is_finite() | !is_its;
        }
        let length = come[n - 1].get(s);
        let is_hair = length.simd_gt(0.0) & length.simd_lt(f32::INFINITY);
        let moved = s.as_array_mask32x8(moved & is_hair);
        let finite = s.as_array_mask32x8(finite);
        *became = std::array::from_fn(|i| match (moved[i] != 0, finite[i] != 0) {
            (false, _) => Wished::Stays,
            (true, false) => Wished::Far,
            (true, true) => Wished::Moved,
        });
        let all: &mut [f32] = bytemuck::cast_slice_mut(self.out);
        let columns = wish.as_flattened();
        let (fours, _) = columns[..3 * few].as_chunks::<4>();
        for (k, four) in fours.iter().enumerate() {
            for (first, row) in firsts.iter().zip(turned_back(s, four)) {
                let at = 3 * first + 4 * k;
                all[at..at + 4].copy_from_slice(&row);
            }
        }
        for (i, (first, count)) in firsts.iter().zip(&*counts).enumerate() {
            for k in 4 * fours.len()..3 * count {
                all[3 * first + k] = columns[k].0[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{ALLOW_DEPTH, Domain};
    use crate::data::curves::TuftBuilder;
    use crate::data::field::Field;
    use crate::data::ramp::{Blend, Ramp};
    use crate::maths::frame::Frame;
    use crate::maths::hash::Dice;
    use crate::maths::lanes::in_each_width;
    use std::convert::Infallible;

    /// Moves points by everything that `Hairs` offers.
    struct ByAll<'a> {
        fields: [Sampler<'a>; 4],
        ramp: &'a Ramp,
        frames: Vec<[[Eight; 3]; 2]>,
        still: f32,
    }

    impl Bend for ByAll<'_> {
        #[inline(always)]
        fn bend<S: Simd>(&mut self, hairs: &Hairs<S>, wish: &mut Wish<S>) {
            hairs.frames(&mut self.frames);
            for k in 0..hairs.len() {
                let [tangent, normal] = self.frames[k].map(|axis| Vec3x8::load(hairs.s, &axis));
                let mut far = self.ramp.at_each(hairs.u(k)) + hairs.come(k);
                for field in &self.fields {
                    far += hairs.field(field, k);
                }
                far = pick(hairs.come(k).simd_lt(self.still), hairs.s.splat_f32x8(0.0), far);
                let to = wish.get(k) + (tangent + normal + hairs.tangent(k)) * far;
                wish.set(k, Vec3x8::pick(far.simd_eq(0.0), wish.get(k), to));
            }
        }
    }

    /// The same for a single hair, lengths included.
    fn one(bend: &ByAll, points: &[Vec3], i: usize, first: usize, kept: bool) -> Vec<Vec3> {
        let mut come = vec![0.0f32];
        points.windows(2).for_each(|w| come.push(come[come.len() - 1] + w[1].distance(w[0])));
        let length = come[come.len() - 1];
        if points.len() < 2 || !(length > 0.0 && length.is_finite()) {
            return points.to_vec();
        }
        let tangent = |k: usize| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(points.len() - 1));
            (points[after] - points[before]).try_normalize().unwrap_or_else(|| {
                let mut pieces = points.windows(2).skip(before);
                pieces.find_map(|w| (w[1] - w[0]).try_normalize()).unwrap_or(Vec3::Y)
            })
        };
        let mut frame = Frame { tangent: tangent(0), normal: any_normal(tangent(0)) };
        let mut new = points.to_vec();
        for k in 0..points.len() {
            if k > 0 {
                let (step, to) = (points[k] - points[k - 1], tangent(k));
                let normal = reflect_twice(frame.normal, step, frame.tangent, to);
                frame = Frame { tangent: to, normal };
            }
            let u = (come[k] / length).min(1.0);
            let mut far = bend.ramp.at(u) + come[k];
            bend.fields.iter().for_each(|field| far += field.at(i, first + k, u));
            if k > 0 && come[k] >= bend.still && far != 0.0 {
                new[k] += (frame.tangent + frame.normal + tangent(k)) * far;
            }
        }
        if kept {
            super::super::keep_lengths(points, &mut new);
        }
        if new.iter().all(|p| p.is_finite()) { new } else { points.to_vec() }
    }

    fn tuft() -> Tuft {
        let dice = Dice::new(5, 0, "hairs");
        let mut b = TuftBuilder::new();
        let mut depths = vec![];
        for i in 0..61u64 {
            // As many points as some others, or none; some of them twice, turned back, or no numbers.
            let n = [5, 5, 7, 5, 16, 16, 0, 1, 2, 9][(i % 10) as usize];
            let mut p = Vec3::ZERO;
            let mut points = vec![];
            for k in 0..n {
                let step = Vec3::from([0, 1, 2].map(|a| dice.signed(i, 3 * k + a)));
                p += match (i % 13, k % 4) {
                    (3, 2) => Vec3::ZERO,
                    (4, _) => Vec3::Y * if k % 2 == 0 { 1.0 } else { -1.0 },
                    (5, 3) => Vec3::splat(f32::NAN),
                    (6, 3) => Vec3::splat(3e38),
                    (7, _) => Vec3::ZERO,
                    (8, _) => Vec3::Y,
                    _ => step,
                };
                points.push(p);
                depths.push(dice.unit(i, 100 + k));
            }
            b.push_curve(&points);
        }
        b.set(ID, Domain::Curve, (1..62).collect());
        b.set(ALLOW_DEPTH, Domain::Point, depths);
        b.set_named("own".into(), Domain::Curve, (0..61).map(|i| i as f32 * 0.01).collect());
        b.build()
    }

    #[test]
    fn a_hair_has_the_same_bits_alone_in_any_bundle_and_at_every_width() {
        let all = tuft();
        let stops = vec![(0.0, 0.2), (0.3, 0.2), (0.3, -1.0), (0.8, 0.5)];
        let ramps = [Blend::Step, Blend::Linear, Blend::Smooth]
            .map(|blend| Ramp::new(blend, stops.clone()).unwrap());
        let fields = [
            Field::Constant(0.3),
            Field::Ramp(Ramp::linear(0.0, 2.0)),
            Field::Attribute("own".into()),
            Field::Product(vec![Field::Attribute(ALLOW_DEPTH.name.into()), Field::Constant(2.0)]),
        ];
        let order: Vec<u32> = (0..61).rev().filter(|i| i % 3 > 0).collect();
        for (tuft, ramp) in
            [all.clone(), all.gather(&order).build()].iter().zip(ramps.iter().cycle())
        {
            for (kept, still) in [(true, 0.0), (false, 0.0), (true, 1.5), (true, 1e9)] {
                let on = |field| Field::on(field, tuft, None, (0.0, 1.0)).unwrap();
                let fields = || fields.each_ref().map(on);
                let bend = || ByAll { fields: fields(), ramp, frames: vec![], still };
                let lengths = if kept { Lengths::Kept } else { Lengths::Free };
                let ran = in_each_width(|| {
                    wished(tuft, lengths, &mut bend(), || Ok::<_, Infallible>(())).unwrap()
                });
                for (points, became) in ran {
                    for (i, became) in became.into_iter().enumerate() {
                        let (old, range) = (tuft.curve(i), tuft.range(i));
                        let want = one(&bend(), old, i, range.start, kept);
                        let bits = |p: &[Vec3]| -> Vec<[u32; 3]> {
                            p.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
                        };
                        assert_eq!(bits(&points[range]), bits(&want), "hair {i} of {old:?}");
                        assert_eq!(became == Wished::Moved, bits(&want) != bits(old), "hair {i}");
                    }
                }
            }
        }
    }

    #[test]
    fn numbers_are_computed_for_every_point_of_every_hair() {
        struct Along<'a>(Sampler<'a>);
        impl Tell for Along<'_> {
            #[inline(always)]
            fn tell<S: Simd>(&mut self, hairs: &Hairs<S>, k: usize, u: f32x8<S>) -> f32x8<S> {
                u + hairs.field_at(&self.0, k, u) + hairs.own(|id| id as f32)
            }
        }
        let tuft = tuft();
        let field = Field::Attribute(ALLOW_DEPTH.name.into());
        let on = || field.on(&tuft, None, (0.0, 1.0)).unwrap();
        let mut want = vec![];
        for i in 0..tuft.len() {
            let points = tuft.curve(i);
            let length: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
            let (scale, mut come) = (if length > 0.0 { 1.0 / length } else { 0.0 }, 0.0);
            for k in 0..points.len() {
                come += if k > 0 { points[k].distance(points[k - 1]) } else { 0.0 };
                let u = (come * scale).min(1.0);
                want.push(u + on().at(i, tuft.range(i).start + k, u) + tuft.id(i) as f32);
            }
        }
        let tell = || told(&tuft, &mut Along(on()), || Ok::<_, Infallible>(())).unwrap();
        for got in in_each_width(tell) {
            assert_eq!(got, want);
        }
    }
}
