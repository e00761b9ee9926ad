//! How thick the strands of a braid can be: radii at which neighbouring tubes touch and never overlap.
//!
//! The idea: the radius of a strand at a place is half the distance from there to the nearest place of any
//! other strand. Two tubes then cannot overlap, for each takes at most half of what is between them, and
//! where two strands are each other's nearest they touch. Distances are those of the placed, bent
//! splines, in space: strands slope, so they come closer than in the cross-section.
//!
//! Guarantees: `r_i(u) + r_j(v) <= 1.02 |p_i(u) - p_j(v)|` on the splines, radii interpolated between CVs (tested by the
//! node); a radius is never more than 0.9 of the strand's own radius of curvature. The raw distance has
//! kinks where the nearest neighbour changes; what is returned is a smooth function below it.

use crate::define::NodeError;
use crate::eval::Piece;
use crate::maths::spline::{Place, Spline};
use glam::Vec3;

/// A strand's centre line: its spline, and for each CV the arc length along the braid's source and the most that
/// the braid's outline lets its radius be.
pub(crate) struct Line {
    pub(crate) spline: Spline,
    pub(crate) s: Vec<f32>,
    pub(crate) room: Vec<f32>,
}

/// The most of its own radius of curvature that a tube may take: at 1 its inner side would crease.
pub(crate) const OF_CURVATURE: f32 = 0.9;

/// Part of the room between two strands that their tubes fill: the rest covers what lies between samples,
/// which in the densest weaves is up to 3 % nearer.
const FILLED: f32 = 0.98;

/// Points of a strand at its CVs and at places between, as columns.
struct Fine {
    at: [Vec<f32>; 3],
    s: Vec<f32>,
}

impl Fine {
    fn new(line: &Line, per_span: usize) -> Self {
        let n = line.spline.span_count();
        let mut fine = Self { at: [vec![], vec![], vec![]], s: vec![] };
        for span in 0..n {
            for sub in 0..per_span {
                let t = sub as f32 / per_span as f32;
                let s = line.s[span] + (line.s[span + 1] - line.s[span]) * t;
                fine.push(line.spline.point(Place { span, t }), s);
            }
        }
        fine.push(line.spline.point(Place { span: n - 1, t: 1.0 }), line.s[n]);
        fine
    }
    fn push(&mut self, p: Vec3, s: f32) {
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
    /// Square of the least distance of `p` from this strand between the samples `from` and `to`.
    fn nearest2(&self, p: Vec3, from: usize, to: usize, buffer: &mut Vec<f32>) -> f32 {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| &self.at[axis][from..to]);
        buffer.clear();
        buffer.extend(xs.iter().zip(ys).zip(zs).map(|((x, y), z)| {
            let (x, y, z) = (x - p.x, y - p.y, z - p.z);
            x * x + y * y + z * z
        }));
        let least = least(buffer);
        buffer.iter().position(|d| *d == least).map_or(least, |k| at_its_least(buffer, k))
    }
}

/// Squares of distances along a strand have the shape of a parabola near a minimum, exactly so for straight strands: what
/// it is at its lowest, when sample `k` is not higher than its neighbours, and else the sample.
fn at_its_least(squares: &[f32], k: usize) -> f32 {
    let here = squares[k];
    if k == 0 || k + 1 == squares.len() {
        return here;
    }
    let (before, after) = (squares[k - 1], squares[k + 1]);
    let bend = before + after - 2.0 * here;
    if before < here || after < here || bend <= 0.0 {
        return here;
    }
    let slope = after - before;
    // Never below half the sampled square: where samples are too coarse the parabola lies.
    (here - slope * slope / (8.0 * bend)).max(0.5 * here)
}

/// The least of the values, eight lanes at a time.
fn least(values: &[f32]) -> f32 {
    let mut lanes = [f32::MAX; 8];
    let chunks = values.chunks_exact(8);
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = if *value < *lane { *value } else { *lane };
        }
    }
    lanes.iter().chain(rest).fold(f32::MAX, |least, value| least.min(*value))
}

/// Where to look for neighbours.
#[derive(Clone, Copy)]
pub(crate) struct Near {
    /// How far along the source (cm) another strand's nearest place can be.
    pub(crate) window: f32,
    /// CVs of a stitch.
    pub(crate) stitch: f32,
    /// CVs of one time up and down.
    pub(crate) wave: f32,
}

/// Radii at which the tubes touch, one for each CV of each line.
pub(crate) fn touching_radii(
    lines: &[Line],
    Near { window, stitch, wave }: Near,
    piece: &mut Piece,
) -> Result<Vec<Vec<f32>>, NodeError> {
    let per_span = (SAMPLES / wave).ceil().clamp(2.0, 4.0) as usize;
    let fine: Vec<Fine> = lines.iter().map(|line| Fine::new(line, per_span)).collect();
    let round = (per_span as f32 * ROUND * stitch).round().max(1.0) as usize;
    let mut buffer = vec![];
    let mut out = vec![];
    for (i, own) in fine.iter().enumerate() {
        // For each strand the range of its samples that lie within the window.
        let mut ranges = vec![(0, 1); fine.len()];
        let mut nearest2 = Vec::with_capacity(own.len());
        for (k, s) in own.s.iter().enumerate() {
            piece.tick()?;
            let p = own.point(k);
            let mut nearest = f32::MAX;
            for (j, other) in fine.iter().enumerate().filter(|(j, _)| *j != i) {
                let (from, to) = &mut ranges[j];
                while *from + 1 < other.s.len() && other.s[*from] < s - window {
                    *from += 1;
                }
                while *to < other.s.len() && other.s[*to] <= s + window {
                    *to += 1;
                }
                *to = (*to).max(*from + 1);
                nearest = nearest.min(other.nearest2(p, *from, *to, &mut buffer));
            }
            nearest2.push(nearest);
        }
        let raw: Vec<f32> = (0..own.len())
            .map(|k| {
                let gap = at_its_least(&nearest2, k).sqrt();
                (0.5 * FILLED * gap).min(OF_CURVATURE * turn_radius(own, k))
            })
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
    // Below this the bend is rounding.
    if twice_area <= 1e-5 * ca.length_squared() { f32::MAX } else { 0.5 * product / twice_area }
}

/// Samples in one time up and down: with fewer the radius between CVs can be several per cent too large
/// where tubes are shaped like beads.
const SAMPLES: f32 = 32.0;

/// Kinks are rounded over this part of a stitch to either side: half of it leaves visible creases on the
/// tubes, twice of it takes a tenth of their volume.
const ROUND: f32 = 1.0 / 12.0;

/// The smaller of two lengths, without a kink where they are equal: there it is 4 % smaller than both.
fn smooth_min(a: f32, b: f32) -> f32 {
    let reach = 0.16 * a.min(b).max(0.0);
    let near = (reach - (a - b).abs()).max(0.0);
    let least = a.min(b);
    if reach > 0.0 { least - near * near / (4.0 * reach) } else { least }
}

/// Lowers radii at CVs so that straight lines between them are below `raw` at every sample.
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

/// The values at CVs of a function that is smooth and nowhere above `raw`: the least of each neighbourhood, averaged
/// over neighbourhoods of the same size (an opening, so valleys keep their depth).
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
            // A triangle: the average of averages. Weights of what lies past an end go to the end.
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
    fn the_least_is_the_least() {
        for n in 0..40usize {
            let values: Vec<f32> = (0..n).map(|k| ((k * 7 + 3) % 11) as f32).collect();
            assert_eq!(least(&values), values.iter().copied().fold(f32::MAX, f32::min));
        }
    }
}
