//! How thick the strands of a braid can be: radii at which adjacent tubes touch and never overlap.
//!
//! The idea: the radius of a strand at a point is half the distance from there to the nearest point of any other
//! strand. Two tubes then cannot overlap, since each takes at most half of the space between them, and where two
//! strands are each other's nearest, they touch. Distances are those of the placed, bent splines in space: strands are
//! sloped, so they come closer than in the cross-section.
//!
//! Guarantees: `r_i(u) + r_j(v) <= 1.02 |p_i(u) - p_j(v)|` on the splines, with radii interpolated between CVs (tested
//! by the node); a radius is at most 0.9 of the strand's own radius of curvature. The raw distance has kinks where the
//! nearest neighbour changes; the result is a smooth function below it.

use crate::define::NodeError;
use crate::eval::Piece;
use crate::maths::nearest_on;
use crate::maths::spline::{Spline, SplineParam};
use glam::Vec3;

/// A strand's centre line: its spline and, for each CV, the arc length along the braid's source and the largest radius
/// that the braid's outline allows.
pub(crate) struct StrandLine {
    pub(crate) spline: Spline,
    pub(crate) s: Vec<f32>,
    pub(crate) room: Vec<f32>,
}

/// Largest fraction of its own radius of curvature that a tube may have: at 1 its inner side would crease.
pub(crate) const OF_CURVATURE: f32 = 0.9;

/// Fraction of the space between two strands that their tubes fill: the rest covers the curve between samples, which in
/// the densest weaves is up to 3 % closer.
const FILLED: f32 = 0.98;

/// How much larger the space may be at the sample next to the one nearest to another strand: [`FILLED`] leaves room for
/// the excess of radii halfway in between.
const BESIDE: f32 = 1.04;

/// Points of a strand at its CVs and in between, as columns, and bounding boxes of [`BLOCK`] of them each, up to the
/// first of the next block.
struct Fine {
    at: [Vec<f32>; 3],
    s: Vec<f32>,
    boxes: Vec<(Vec3, Vec3)>,
}

/// Samples that are skipped together if their box is too far away.
const BLOCK: usize = 16;

impl Fine {
    fn new(line: &StrandLine, per_span: usize) -> Self {
        let n = line.spline.span_count();
        let mut fine = Self { at: [vec![], vec![], vec![]], s: vec![], boxes: vec![] };
        for span in 0..n {
            for sub in 0..per_span {
                let t = sub as f32 / per_span as f32;
                let s = line.s[span] + (line.s[span + 1] - line.s[span]) * t;
                fine.push(line.spline.point(SplineParam { span, t }), s);
            }
        }
        fine.push(line.spline.point(SplineParam { span: n - 1, t: 1.0 }), line.s[n]);
        fine
    }
    fn push(&mut self, p: Vec3, s: f32) {
        // The chord between two blocks is in the box of the first.
        if let Some((low, high)) = self.boxes.last_mut() {
            (*low, *high) = (low.min(p), high.max(p));
        }
        if self.s.len().is_multiple_of(BLOCK) {
            self.boxes.push((p, p));
        }
        self.at[0].push(p.x);
        self.at[1].push(p.y);
        self.at[2].push(p.z);
        self.s.push(s);
    }
    fn len(&self) -> usize {
        self.s.len()
    }
    fn point(&self, k: usize) -> Vec3 {
        Vec3::new(self.at[0][k], self.at[1][k], self.at[2][k])
    }
    /// Squared distance of `p` from a sample.
    fn square(&self, p: Vec3, k: usize) -> f32 {
        let (x, y, z) = (self.at[0][k] - p.x, self.at[1][k] - p.y, self.at[2][k] - p.z);
        x * x + y * y + z * z
    }
    /// The chords from a sample to its neighbours.
    fn chords(&self, k: usize) -> impl Iterator<Item = [Vec3; 2]> {
        (k.max(1)..(k + 2).min(self.len())).map(|k| [self.point(k - 1), self.point(k)])
    }
    /// How far the strand bulges beyond its chords at a sample.
    fn sagitta(&self, k: usize) -> f32 {
        let k = k.clamp(1, self.len() - 2);
        (self.point(k - 1) + self.point(k + 1) - self.point(k) * 2.0).length() * 0.125
    }
    /// Squared smallest distance of `p` from this strand between the samples `from` and `to`, if it may be below
    /// `bound`; otherwise anything above that. Also returns the sample.
    fn nearest2(&self, p: Vec3, from: usize, to: usize, bound: f32) -> (f32, usize) {
        let (mut best, mut at) = (f32::MAX, from);
        for block in from / BLOCK..=(to - 1) / BLOCK {
            let (low, high) = self.boxes[block];
            let beside = (low - p).max(p - high).max(Vec3::ZERO);
            // The curve between samples takes at most half of the square; the rest is for rounding.
            if 0.499 * beside.length_squared() > bound {
                continue;
            }
            let (first, end) = ((block * BLOCK).max(from), ((block + 1) * BLOCK).min(to));
            let mut squares = [f32::MAX; BLOCK];
            let [xs, ys, zs] = [0, 1, 2].map(|axis| &self.at[axis][first..end]);
            for (square, ((x, y), z)) in squares.iter_mut().zip(xs.iter().zip(ys).zip(zs)) {
                let (x, y, z) = (x - p.x, y - p.y, z - p.z);
                *square = x * x + y * y + z * z;
            }
            let least = least(&squares);
            if least < best {
                let found = squares.iter().position(|square| *square == least);
                (best, at) = (least, first + found.unwrap_or(0));
            }
        }
        if best < f32::MAX && at > from && at + 1 < to {
            best =
                lowest(self.square(p, at - 1), best, self.square(p, at + 1)).unwrap_or_else(|| {
                    let least = self.chords(at).map(|chord| beside(p, chord)).fold(best, f32::min);
                    bulged(least, self.sagitta(at))
                });
        }
        (best, at)
    }
}

/// Squared distances along a strand are parabolic near a minimum, exactly so for straight strands: the minimum between
/// three samples, or the middle value if that is not the smallest. `None` if it is below half of the sample: strands
/// that close, relative to the sample spacing, must be examined.
fn lowest(before: f32, here: f32, after: f32) -> Option<f32> {
    let bend = before + after - 2.0 * here;
    if before < here || after < here || bend <= 0.0 {
        return Some(here);
    }
    let slope = after - before;
    let low = here - slope * slope / (8.0 * bend);
    (low >= 0.5 * here).then_some(low)
}

/// Square of the remaining distance between chords where strands bulge beyond them, at least half of the distance.
fn bulged(square: f32, sagitta: f32) -> f32 {
    let distance = square.sqrt();
    let left = (distance - sagitta).max(0.5 * distance);
    left * left
}

/// Squared distance of `p` from a chord.
fn beside(p: Vec3, segment: [Vec3; 2]) -> f32 {
    p.distance_squared(nearest_on(segment, p).0)
}

/// Squared smallest distance of two chords.
fn apart(one: [Vec3; 2], other: [Vec3; 2]) -> f32 {
    let (u, v, w) = (one[1] - one[0], other[1] - other[0], one[0] - other[0]);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let across = uu * vv - uv * uv;
    // Where they cross within both; otherwise an end of one is nearest.
    let s = (uv * v.dot(w) - vv * u.dot(w)) / across;
    let t = (uu * v.dot(w) - uv * u.dot(w)) / across;
    if across > 1e-6 * uu * vv && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        return (w + u * s - v * t).length_squared();
    }
    let ends = [
        beside(one[0], other),
        beside(one[1], other),
        beside(other[0], one),
        beside(other[1], one),
    ];
    ends.into_iter().fold(f32::MAX, f32::min)
}

/// The minimum of a block.
fn least(values: &[f32; BLOCK]) -> f32 {
    let mut lanes = [f32::MAX; 8];
    for chunk in values.chunks_exact(8) {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = if *value < *lane { *value } else { *lane };
        }
    }
    lanes.iter().fold(f32::MAX, |least, value| least.min(*value))
}

/// Squared smallest distance between the neighbourhood of sample `k` of a strand and what is nearest to it.
fn least_about<'f>(
    own: &Fine,
    k: usize,
    nearest2: &[f32],
    whose: impl Fn(usize) -> Option<(&'f Fine, usize)>,
) -> f32 {
    let here = nearest2[k];
    if k == 0 || k + 1 == nearest2.len() {
        return here;
    }
    lowest(nearest2[k - 1], here, nearest2[k + 1]).unwrap_or_else(|| {
        let Some((other, at)) = whose(k) else { return here };
        let pairs = own.chords(k).flat_map(|one| other.chords(at).map(move |two| apart(one, two)));
        bulged(pairs.fold(here, f32::min), own.sagitta(k) + other.sagitta(at))
    })
}

/// Search range for neighbours.
#[derive(Clone, Copy)]
pub(crate) struct Near {
    /// How far along the source (cm) another strand's nearest point can be.
    pub(crate) window: f32,
    /// CVs per stitch.
    pub(crate) stitch: f32,
    /// CVs per oscillation.
    pub(crate) wave: f32,
}

/// Radii at which the tubes touch, one for each CV of each line.
pub(crate) fn touching_radii(
    lines: &[StrandLine],
    Near { window, stitch, wave }: Near,
    piece: &mut Piece,
) -> Result<Vec<Vec<f32>>, NodeError> {
    let per_span = (SAMPLES / wave).ceil().clamp(2.0, 4.0) as usize;
    let fine: Vec<Fine> = lines.iter().map(|line| Fine::new(line, per_span)).collect();
    let round = (per_span as f32 * ROUND * stitch).round().max(1.0) as usize;
    let mut out = vec![];
    for (i, own) in fine.iter().enumerate() {
        // For each strand, the range of its samples inside the window.
        let mut ranges = vec![(0, 1); fine.len()];
        let mut nearest2 = Vec::with_capacity(own.len());
        // The nearest strand and sample of each sample; they are likely the nearest of the next one as well.
        let mut whose: Vec<Option<(usize, usize)>> = Vec::with_capacity(own.len());
        for (k, s) in own.s.iter().enumerate() {
            piece.tick()?;
            let p = own.point(k);
            for ((from, to), other) in ranges.iter_mut().zip(&fine) {
                while *from + 1 < other.s.len() && other.s[*from] < s - window {
                    *from += 1;
                }
                while *to < other.s.len() && other.s[*to] <= s + window {
                    *to += 1;
                }
                *to = (*to).max(*from + 1);
            }
            let mut nearest = f32::MAX;
            let mut found = None;
            let mut bound = match whose.last().copied().flatten() {
                Some((j, at)) if at >= ranges[j].0 => fine[j].square(p, at),
                _ => f32::MAX,
            };
            for (j, other) in fine.iter().enumerate().filter(|(j, _)| *j != i) {
                let (square, at) = other.nearest2(p, ranges[j].0, ranges[j].1, bound);
                if square < nearest {
                    (nearest, found) = (square, Some((j, at)));
                }
                bound = bound.min(nearest);
            }
            nearest2.push(nearest);
            whose.push(found);
        }
        let mut gaps: Vec<f32> = (0..own.len())
            .map(|k| least_about(own, k, &nearest2, |k| whose[k].map(|(j, at)| (&fine[j], at))))
            .collect();
        // Strands that are nearest between two samples count for both: radii are linear between CVs.
        for k in 1..own.len() - 1 {
            let (before, here, after) = (nearest2[k - 1], nearest2[k], nearest2[k + 1]);
            if here <= before && here <= after {
                let beside = if before < after { k - 1 } else { k + 1 };
                gaps[beside] = gaps[beside].min(gaps[k] * (BESIDE * BESIDE));
            }
        }
        let raw: Vec<f32> = gaps
            .iter()
            .enumerate()
            .map(|(k, gap)| (0.5 * FILLED * gap.sqrt()).min(OF_CURVATURE * turn_radius(own, k)))
            .collect();
        let mut radii = smooth_below(&raw, round, per_span);
        keep_below_between(&mut radii, &raw, per_span);
        for (radius, room) in radii.iter_mut().zip(&lines[i].room) {
            *radius = smooth_min(*radius, *room);
        }
        out.push(radii);
    }
    Ok(out)
}

/// Radius of the circle through a sample and its neighbours; huge on a straight line.
fn turn_radius(fine: &Fine, k: usize) -> f32 {
    let k = k.clamp(1, fine.len() - 2);
    let (a, b, c) = (fine.point(k - 1), fine.point(k), fine.point(k + 1));
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let twice_area = ab.cross(bc).length();
    let product = ab.length() * bc.length() * ca.length();
    // Below this, the bend is rounding.
    if twice_area <= 1e-5 * ca.length_squared() { f32::MAX } else { 0.5 * product / twice_area }
}

/// Samples per oscillation: with fewer, the radius between CVs can be several percent too large where tubes are shaped
/// like beads.
const SAMPLES: f32 = 32.0;

/// Kinks are rounded over this fraction of a stitch to each side: half of it leaves visible creases on the tubes, twice
/// of it takes a tenth of their volume.
const ROUND: f32 = 1.0 / 12.0;

/// Smooth minimum of two lengths: where they are equal, it is 4 % smaller than both.
fn smooth_min(a: f32, b: f32) -> f32 {
    let reach = 0.16 * a.min(b).max(0.0);
    let near = (reach - (a - b).abs()).max(0.0);
    let least = a.min(b);
    if reach > 0.0 { least - near * near / (4.0 * reach) } else { least }
}

/// Lowers radii at CVs so that linear interpolation between them stays below `raw` at every sample.
fn keep_below_between(radii: &mut [f32], raw: &[f32], per_span: usize) {
    let mut factors = vec![1.0f32; radii.len()];
    for span in 0..radii.len() - 1 {
        for sub in 1..per_span {
            let t = sub as f32 / per_span as f32;
            let between = radii[span] * (1.0 - t) + radii[span + 1] * t;
            let factor = raw[span * per_span + sub] / between.max(f32::MIN_POSITIVE);
            factors[span] = factors[span].min(factor);
            factors[span + 1] = factors[span + 1].min(factor);
        }
    }
    radii.iter_mut().zip(factors).for_each(|(radius, factor)| *radius *= factor);
}

/// The values at CVs of a smooth function that is nowhere above `raw`: the minimum of each neighbourhood, averaged over
/// neighbourhoods of the same size (an opening, so valleys keep their depth).
fn smooth_below(raw: &[f32], round: usize, per_span: usize) -> Vec<f32> {
    let n = raw.len();
    let low: Vec<f32> = (0..n)
        .map(|k| {
            let around = &raw[k.saturating_sub(round)..(k + round + 1).min(n)];
            around.iter().fold(f32::MAX, |least, r| least.min(*r))
        })
        .collect();
    (0..n)
        .step_by(per_span)
        .map(|k| {
            // A triangle filter: the average of averages. Weights past an end go to the end.
            let (mut sum, mut weights) = (0.0, 0.0);
            for step in -(round as isize)..=round as isize {
                let weight = (round as isize + 1 - step.abs()) as f32;
                sum += weight * low[(k as isize + step).clamp(0, n as isize - 1) as usize];
                weights += weight;
            }
            sum / weights
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smoothed_radius_stays_below_and_keeps_its_valleys() {
        let raw: Vec<f32> =
            (0..=200).map(|k| 1.0 + ((k % 40) as f32 - 20.0).abs() * 0.05).collect();
        let smooth = smooth_below(&raw, 4, 2);
        for (k, r) in smooth.iter().enumerate() {
            assert!(*r <= raw[2 * k] + 1e-6, "{k}");
        }
        assert!((smooth[10] - 1.0).abs() < 1e-6);
        let bend = |w: &[f32]| (w[0] + w[2] - 2.0 * w[1]).abs();
        let raw_cvs: Vec<f32> = raw.iter().step_by(2).copied().collect();
        let most = |v: &[f32]| v.windows(3).map(bend).fold(0.0, f32::max);
        assert!(most(&smooth) < 0.5 * most(&raw_cvs), "{} {}", most(&smooth), most(&raw_cvs));
    }

    #[test]
    fn chords_are_as_far_apart_as_their_nearest_places() {
        let dice = crate::maths::hash::Dice::new(3, 0, "chords");
        let at = |[a, b]: [Vec3; 2], k: u8| a + (b - a) * (f32::from(k) / 50.0);
        for id in 0..200 {
            let p = |k: u64| Vec3::from([0, 1, 2].map(|axis| dice.signed(id, 3 * k + axis)));
            let (one, two) = ([p(0), p(1)], [p(2), if id % 5 == 0 { p(2) } else { p(3) }]);
            let all = (0..=50).flat_map(|k| (0..=50).map(move |l| (k, l)));
            let least = all.map(|(k, l)| at(one, k).distance(at(two, l))).fold(f32::MAX, f32::min);
            let got = apart(one, two).sqrt();
            assert!(got <= least + 1e-5 && got > least - 0.06, "{id}: {got} {least}");
        }
        let cross = [[Vec3::NEG_X, Vec3::X], [Vec3::new(0.3, -1.0, 0.1), Vec3::new(0.3, 1.0, 0.1)]];
        assert!((apart(cross[0], cross[1]).sqrt() - 0.1).abs() < 1e-6);
    }

    #[test]
    fn nothing_nearer_is_skipped() {
        let wave = |k: usize, turn: f32| {
            let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 * 0.037 + turn);
            Vec3::new(sin, 0.6 * cos * sin, 0.05 * k as f32)
        };
        let mut fine = Fine { at: [vec![], vec![], vec![]], s: vec![], boxes: vec![] };
        (0..203).for_each(|k| fine.push(wave(k, 0.0), k as f32));
        for k in 0..203 {
            let p = wave(k, 0.3);
            for (from, to) in [(0, 203), (k, k + 1), (k / 2, k + 1), (k, 203), (k / 3, 150 + k / 4)]
            {
                let all: Vec<f32> = (from..to).map(|k| fine.square(p, k)).collect();
                let least = all.iter().copied().fold(f32::MAX, f32::min);
                let at = all.iter().position(|square| *square == least).unwrap();
                let inside = at > 0 && at + 1 < all.len();
                let want = inside.then(|| lowest(all[at - 1], least, all[at + 1]));
                let Some(want) = want.unwrap_or(Some(least)) else { continue };
                for bound in [f32::MAX, want, 1.5 * want, fine.square(p, 100)] {
                    let (got, place) = fine.nearest2(p, from, to, bound);
                    assert!((got, place) == (want, from + at) || want > bound && got > bound);
                }
            }
        }
    }
}
