//! Profiles of curls as tables by arc length, and the list of 4,096 entries that turns draw from.
//!
//! Every profile is a closed curve around the origin with unit RMS radius; `theta` in [0, 1) is the fraction of its arc
//! length from its +x axis, counterclockwise. No corner is tighter than `rounding` of the RMS radius: the outline is
//! dilated by a disc of that radius (which rounds convex corners, however thin) and then smoothed until concave corners
//! are as round.
//!
//! Ellipses are the exception to both: they are parameterized by angle and not rounded. By arc length, a flat ellipse
//! runs back and forth at constant speed, a zigzag whose crests turn within a hundredth of the period; by angle, it is
//! the sine wave of wavy hair.

use crate::data::shapes::{ShapeList, Tier, TurnProfile};
use crate::maths::spline::Spline;
use crate::maths::transcendental::{exp, pow, sin_cos_turns};
use glam::{Vec2, Vec3};

/// Entries of the shape list.
pub(crate) const ENTRIES: usize = 4096;
/// Entries of a profile's table. A corner of the smallest rounding takes seven of them.
const TABLE: usize = 512;
/// Extra roundness of an outline, to offset the table's interpolation.
const MARGIN: f32 = 1.05;
/// Points of an outline under construction.
const FINE: usize = 1024;
/// Points of a stretch of it.
const STRETCH: usize = 16;

/// A closed curve of unit RMS radius by arc length.
#[derive(Clone, Debug)]
pub(crate) struct ProfileCurve {
    /// Point and velocity (per entry) at each entry; the first is repeated at the end.
    table: Vec<(Vec2, Vec2)>,
    /// Length of the outline.
    pub(crate) perimeter: f32,
    /// Its bend: the acceleration that nine tenths of a turn do not exceed, relative to a circle.
    pub(crate) bend: f32,
    /// Its largest distance from the centre.
    pub(crate) widest: f32,
}

impl ProfileCurve {
    /// The point at `theta` turns, any finite number, and its derivative by `theta`. C1.
    #[inline(always)]
    pub(crate) fn at(&self, theta: f32) -> (Vec2, Vec2) {
        // Truncated and corrected: a floor without a library call.
        let whole = theta as i32 as f32;
        let part = theta - whole;
        let x = (if part < 0.0 { part + 1.0 } else { part }) * TABLE as f32;
        let i = (x as usize).min(TABLE - 1);
        let t = x - i as f32;
        let ((p0, m0), (p1, m1)) = (self.table[i], self.table[i + 1]);
        let d = p1 - p0;
        let (a, b) = (m0 + m1 - d * 2.0, d * 3.0 - m0 * 2.0 - m1);
        let velocity = (a * (3.0 * t) + b * 2.0) * t + m0;
        (((a * t + b) * t + m0) * t + p0, velocity * TABLE as f32)
    }

    fn new(outline: &[Vec2]) -> Self {
        let n = outline.len();
        let stride = n / TABLE;
        let entry = |i: usize| {
            let velocity = (outline[(i + 1) % n] - outline[(i + n - 1) % n]) * 0.5;
            (outline[i % n], velocity * stride as f32)
        };
        let table: Vec<(Vec2, Vec2)> = (0..=TABLE).map(|i| entry((i * stride) % n)).collect();
        let mut steps: Vec<f32> = table.windows(2).map(|w| (w[1].1 - w[0].1).length()).collect();
        steps.sort_by(f32::total_cmp);
        let turn = std::f32::consts::TAU / TABLE as f32;
        let bend = steps[TABLE * 9 / 10] / (turn * turn);
        let widest = outline.iter().fold(0.0f32, |far, p| far.max(p.length()));
        Self { table, perimeter: perimeter(outline), bend, widest }
    }

    /// The table of a profile.
    pub(crate) fn of(section: &TurnProfile, rounding: f32) -> Self {
        match section {
            TurnProfile::Circle => Self::ellipse(1.0),
            TurnProfile::Ellipse(ratio) => Self::ellipse(*ratio),
            TurnProfile::Lame(e) => Self::polar(rounding, |turns| {
                let (sin, cos) = sin_cos_turns(turns);
                pow(pow(cos.abs(), *e) + pow(sin.abs(), *e), -1.0 / *e)
            }),
            TurnProfile::Polygon(n) => {
                let n = *n as f32;
                let apothem = sin_cos_turns(0.5 / n).1;
                Self::polar(rounding, |turns| {
                    let within = (turns * n).fract() / n - 0.5 / n;
                    apothem / sin_cos_turns(within).1
                })
            }
            TurnProfile::Rose { petals, depth } => {
                let petals = *petals as f32;
                Self::polar(rounding, |turns| 1.0 + depth * sin_cos_turns(turns * petals).1)
            }
            TurnProfile::Custom(points) => {
                // Three more points at each end close the spline.
                let n = points.len();
                let around = |i: usize| points[i % n].extend(0.0);
                let cvs: Vec<Vec3> = (n - 3..2 * n + 4).map(around).collect();
                let Ok(spline) = Spline::new(&cvs) else { return Self::ellipse(1.0) };
                let (from, to) = (spline.u_of_cv(3), spline.u_of_cv(3 + n));
                let at = |k: usize| from + (to - from) * k as f32 / FINE as f32;
                Self::rounded(
                    (0..FINE).map(|k| spline.at(at(k)).truncate()).collect(),
                    0.0,
                    rounding,
                )
            }
        }
    }

    /// The Z of a Z-bend: straight legs back and forth with bends as tight as the rounding.
    pub(crate) fn zigzag(rounding: f32) -> Self {
        let along = |k: usize| (4.0 * k as f32 / FINE as f32 - 2.0).abs() - 1.0;
        let line = (0..FINE).map(|k| Vec2::new(along(k), 0.0)).collect();
        Self::rounded(line, rounding, rounding)
    }

    fn ellipse(ratio: f32) -> Self {
        let scale = (2.0 / (1.0 + ratio * ratio)).sqrt();
        let at = |k: usize| {
            let (sin, cos) = sin_cos_turns(k as f32 / FINE as f32);
            Vec2::new(cos, ratio * sin) * scale
        };
        let outline: Vec<Vec2> = (0..FINE).map(at).collect();
        Self::new(&outline)
    }

    fn polar(rounding: f32, radius: impl Fn(f32) -> f32) -> Self {
        let at = |k: usize| {
            let turns = k as f32 / FINE as f32;
            let (sin, cos) = sin_cos_turns(turns);
            Vec2::new(cos, sin) * radius(turns)
        };
        Self::rounded((0..FINE).map(at).collect(), rounding, rounding)
    }

    /// The outline dilated by `widen` and smoothed until nothing is tighter than `rounding`, both in RMS radii of the
    /// result.
    fn rounded(outline: Vec<Vec2>, widen: f32, rounding: f32) -> Self {
        // Smoothing thins the tips of thin arms: where it cannot reach the rounding, a larger disc can.
        let mut roundest = vec![];
        for widen in [1.0, 1.5, 2.25, 3.4].map(|more| more * widen) {
            // The disc's radius is relative to the result; two rounds converge within 1 %.
            let disc =
                (0..2).fold(widen, |disc, _| widen * rms(&even(&widened(&outline, disc, FINE))));
            // The sides of thin arms run along the rays, so many rays are needed.
            let wide = normalised(&widened(&outline, disc, 4 * FINE));
            let smooth = |sigma: f32| normalised(&smoothed(&wide, sigma));
            let enough = |outline: &[Vec2]| tightest(outline) >= MARGIN * rounding;
            if enough(&wide) {
                return Self::new(&wide);
            }
            // The smallest sufficient smoothing, in RMS radii, to a twentieth.
            let (mut low, mut high) = (0.0, 0.02);
            while high < 0.6 && !enough(&smooth(high)) {
                (low, high) = (high, high * 1.5);
            }
            for _ in 0..5 {
                let middle = 0.5 * (low + high);
                if enough(&smooth(middle)) { high = middle } else { low = middle }
            }
            roundest = smooth(high);
            if enough(&roundest) {
                break;
            }
        }
        Self::new(&roundest)
    }
}

fn perimeter(outline: &[Vec2]) -> f32 {
    (0..outline.len()).map(|i| outline[i].distance(outline[(i + 1) % outline.len()])).sum()
}

/// RMS radius of an outline with evenly spaced points.
fn rms(outline: &[Vec2]) -> f32 {
    (outline.iter().map(|p| p.length_squared()).sum::<f32>() / outline.len() as f32).sqrt()
}

/// The outline at even arc length from its +x axis.
fn even(outline: &[Vec2]) -> Vec<Vec2> {
    let n = outline.len();
    // Its outermost crossing of the +x axis.
    let crossing = |i: usize| {
        let (a, b) = (outline[i], outline[(i + 1) % n]);
        let crosses = (a.y <= 0.0) != (b.y <= 0.0) || a.y == 0.0;
        let t = if a.y == b.y { 0.0 } else { a.y / (a.y - b.y) };
        let at = a + (b - a) * t;
        (crosses && at.x > 0.0).then_some((at.x, i, at))
    };
    let start = (0..n).filter_map(crossing).fold(None, |best: Option<(f32, usize, Vec2)>, c| {
        if best.is_none_or(|b| c.0 > b.0) { Some(c) } else { best }
    });
    let (_, first, start) = start.unwrap_or((0.0, n - 1, outline[0]));
    let mut around = vec![start];
    around.extend((1..=n).map(|k| outline[(first + k) % n]));
    around.push(start);
    // Twice the signed area: drawn profiles may be clockwise.
    let area: f32 = around.windows(2).map(|w| w[0].perp_dot(w[1])).sum();
    if area < 0.0 {
        around.reverse();
    }
    let total: f32 = around.windows(2).map(|w| w[0].distance(w[1])).sum();
    let step = total / FINE as f32;
    let mut out = Vec::with_capacity(FINE);
    let mut walked = 0.0;
    for pair in around.windows(2) {
        let length = pair[0].distance(pair[1]);
        while out.len() < FINE && walked + length > out.len() as f32 * step {
            let t = (out.len() as f32 * step - walked) / length;
            out.push(pair[0] + (pair[1] - pair[0]) * t);
        }
        walked += length;
    }
    out.resize(FINE, start);
    out
}

/// The outline at even arc length around its centroid, with unit RMS radius.
fn normalised(outline: &[Vec2]) -> Vec<Vec2> {
    let mut out = even(outline);
    // Moving the centre moves the +x axis: one repetition is enough, since the centre then stays.
    for _ in 0..2 {
        let mean = centroid(&out);
        out.iter_mut().for_each(|p| *p -= mean);
        out = even(&out);
    }
    let scale = 1.0 / rms(&out).max(1e-12);
    out.iter_mut().for_each(|p| *p *= scale);
    out
}

/// A star-shaped outline dilated by a disc: for each of this many rays from the centre, the farthest point within
/// `radius` of the outline.
fn widened(outline: &[Vec2], radius: f32, rays: usize) -> Vec<Vec2> {
    if radius <= 0.0 {
        return outline.to_vec();
    }
    // Stretches of the outline, each in a disc that, with room for rounding, holds all dilated points: most lie beside a ray.
    let stretch = |points| {
        let middle = centroid(points);
        let far = points.iter().fold(0.0f32, |far, p| far.max(p.distance(middle)));
        (points, middle, (far + radius) * 1.001 + 1e-5 * middle.length())
    };
    let stretches: Vec<(&[Vec2], Vec2, f32)> = outline.chunks(STRETCH).map(stretch).collect();
    let reach = |k: usize| {
        let (sin, cos) = sin_cos_turns(k as f32 / rays as f32);
        let ray = Vec2::new(cos, sin);
        let mut far = 0.0f32;
        for (points, middle, disc) in &stretches {
            if ray.perp_dot(*middle).abs() > *disc || ray.dot(*middle) + disc < far {
                continue;
            }
            for p in *points {
                let left = radius * radius - ray.perp_dot(*p) * ray.perp_dot(*p);
                far = if left < 0.0 { far } else { far.max(ray.dot(*p) + left.sqrt()) };
            }
        }
        ray * far
    };
    (0..rays).map(reach).collect()
}

fn centroid(points: &[Vec2]) -> Vec2 {
    points.iter().sum::<Vec2>() / points.len().max(1) as f32
}

/// The evenly spaced outline convolved with a Gaussian of width `sigma`, in its own unit.
fn smoothed(outline: &[Vec2], sigma: f32) -> Vec<Vec2> {
    let n = outline.len();
    let per_step = perimeter(outline) / n as f32 / sigma;
    let reach = ((3.5 / per_step) as usize).min(n / 2 - 1);
    let weight = |k: usize| exp(-0.5 * (k as f32 * per_step) * (k as f32 * per_step));
    let weights: Vec<f32> = (0..=reach).map(weight).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f32>();
    // All points take one neighbour on each side at a time: compilers do that for several numbers at once.
    let around: Vec<Vec2> = (n - reach..2 * n + reach).map(|i| outline[i % n]).collect();
    let shifted = |by: usize| bytemuck::cast_slice::<Vec2, f32>(&around[by..by + n]);
    let mut sums: Vec<Vec2> = outline.iter().map(|p| *p * weights[0]).collect();
    for (k, weight) in weights.iter().enumerate().skip(1) {
        let sums = bytemuck::cast_slice_mut::<Vec2, f32>(&mut sums);
        let both = shifted(reach + k).iter().zip(shifted(reach - k));
        sums.iter_mut().zip(both).for_each(|(sum, (next, last))| *sum += (next + last) * weight);
    }
    sums.into_iter().map(|sum| sum / total).collect()
}

/// The smallest radius of curvature of an evenly spaced outline, measured over two steps each way.
fn tightest(outline: &[Vec2]) -> f32 {
    let n = outline.len();
    let radius = |i: usize| {
        let (a, b, c) = (outline[(i + n - 2) % n], outline[i], outline[(i + 2) % n]);
        let twice_area = (b - a).perp_dot(c - a).abs();
        a.distance(b) * b.distance(c) * c.distance(a) / (2.0 * twice_area).max(1e-12)
    };
    (0..n).map(radius).fold(f32::INFINITY, f32::min)
}

/// The profile of `shapes` for each of the 4,096 entries, by largest remainder: tier A gets `uniformity`, B and C share
/// the rest as `b_to_c` to 1; an empty tier leaves its share to the others. Every profile with a nonzero share has an
/// entry.
pub(crate) fn entries(shapes: &ShapeList, uniformity: f32, b_to_c: f32) -> Vec<u16> {
    let count = |tier: Tier| shapes.0.iter().filter(|(t, _)| *t == tier).count() as f64;
    let rest = 1.0 - f64::from(uniformity);
    let ratio = f64::from(b_to_c);
    let (b, c) = (rest * ratio / (ratio + 1.0), rest / (ratio + 1.0));
    let (b, c) = match (count(Tier::B) > 0.0, count(Tier::C) > 0.0) {
        (true, true) => (b, c),
        (true, false) => (rest, 0.0),
        (false, true) => (0.0, rest),
        (false, false) => (0.0, 0.0),
    };
    let a = 1.0 - b - c;
    let ideal: Vec<f64> = shapes
        .0
        .iter()
        .map(|(tier, _)| {
            let share = match tier {
                Tier::A => a,
                Tier::B => b,
                Tier::C => c,
            };
            share * ENTRIES as f64 / count(*tier)
        })
        .collect();
    let mut counts: Vec<usize> =
        ideal.iter().map(|x| (*x as usize).max(usize::from(*x > 0.0))).collect();
    let remainder = |counts: &[usize], i: usize| ideal[i] - counts[i] as f64;
    while counts.iter().sum::<usize>() != ENTRIES {
        let short = counts.iter().sum::<usize>() < ENTRIES;
        let by = |i: &usize| if short { remainder(&counts, *i) } else { -remainder(&counts, *i) };
        // Ties go to the first.
        let pick = (0..counts.len())
            .filter(|i| ideal[*i] > 0.0 && (short || counts[*i] > 1))
            .reduce(|best, i| if by(&i) > by(&best) { i } else { best });
        let Some(pick) = pick else { break };
        if short { counts[pick] += 1 } else { counts[pick] -= 1 }
    }
    counts.iter().enumerate().flat_map(|(i, n)| std::iter::repeat_n(i as u16, *n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn all() -> Vec<TurnProfile> {
        let mut all =
            vec![TurnProfile::Circle, TurnProfile::Ellipse(0.05), TurnProfile::Ellipse(0.7)];
        all.extend([0.3, 0.7, 1.0, 2.0, 4.0, 20.0].map(TurnProfile::Lame));
        all.extend([3, 4, 5, 12].map(TurnProfile::Polygon));
        let roses = [(2, 0.95), (3, 0.5), (5, 0.2), (12, 0.95), (4, 0.0)];
        all.extend(roses.map(|(petals, depth)| TurnProfile::Rose { petals, depth }));
        let drawn = [(1.0, 0.0), (0.2, 0.3), (0.0, 1.0), (-1.0, 0.2), (-0.3, -1.0)];
        all.push(TurnProfile::Custom(drawn.map(|(x, y)| Vec2::new(x, y)).to_vec()));
        all
    }

    #[test]
    fn every_section_has_unit_radius_runs_by_arc_length_and_has_no_tight_corner() {
        for section in all() {
            for rounding in [0.05, 0.2] {
                let shape = ProfileCurve::of(&section, rounding);
                let n = 4096;
                let at = |k: usize| shape.at(k as f32 / n as f32).0;
                let points: Vec<Vec2> = (0..n).map(at).collect();
                let what = format!("{section:?} {rounding}");
                assert!((rms(&points) - 1.0).abs() < 2e-3, "{what}: {}", rms(&points));
                assert!(shape.at(0.0).0.y.abs() < 2e-3 && shape.at(0.0).0.x > 0.0, "{what}");
                assert!(shape.at(0.02).0.y > 0.0, "{what}");
                assert!(shape.at(3.25).0.distance(shape.at(0.25).0) < 1e-5, "{what}");
                if matches!(section, TurnProfile::Ellipse(_)) {
                    continue;
                }
                let even = shape.perimeter / n as f32;
                let worst = (0..n)
                    .map(|k| (at(k).distance(at(k + 1)) / even - 1.0).abs())
                    .fold(0.0, f32::max);
                assert!(worst < 0.05, "{what}: speed is off by {worst}");
                let coarse: Vec<Vec2> = (0..n).step_by(4).map(at).collect();
                assert!(tightest(&coarse) > rounding, "{what}: {}", tightest(&coarse));
            }
        }
    }

    #[test]
    fn outlines_are_dilated_and_smoothed_as_if_every_point_were_looked_at() {
        let outline: Vec<Vec2> = (0..FINE)
            .map(|k| {
                let turns = k as f32 / FINE as f32;
                let (sin, cos) = sin_cos_turns(turns);
                Vec2::new(cos, 0.3 * sin) * (1.0 + 0.6 * sin_cos_turns(5.0 * turns).1)
            })
            .collect();
        for radius in [0.003, 0.08, 0.9] {
            let far = |k: usize| {
                let (sin, cos) = sin_cos_turns(k as f32 / FINE as f32);
                let ray = Vec2::new(cos, sin);
                let reach = |p: &Vec2| {
                    let left = radius * radius - ray.perp_dot(*p) * ray.perp_dot(*p);
                    if left < 0.0 { 0.0 } else { ray.dot(*p) + left.sqrt() }
                };
                ray * outline.iter().map(reach).fold(0.0, f32::max)
            };
            let all: Vec<Vec2> = (0..FINE).map(far).collect();
            assert_eq!(widened(&outline, radius, FINE), all, "{radius}");
        }
        for sigma in [0.02, 0.3] {
            let step = perimeter(&outline) / FINE as f32 / sigma;
            let weight = |k: usize| exp(-0.5 * (k as f32 * step) * (k as f32 * step));
            let reach = ((3.5 / step) as usize).min(FINE / 2 - 1);
            let whole = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f32>();
            let mean = |i: usize| {
                let sum = (1..=reach).fold(outline[i] * weight(0), |sum, k| {
                    sum + (outline[(i + k) % FINE] + outline[(i + FINE - k) % FINE]) * weight(k)
                });
                sum / whole
            };
            let all: Vec<Vec2> = (0..FINE).map(mean).collect();
            assert_eq!(smoothed(&outline, sigma), all, "{sigma}");
        }
    }

    #[test]
    fn the_list_has_each_tiers_share_and_every_shape() {
        let list = |tiers: &[Tier]| {
            ShapeList(tiers.iter().map(|tier| (*tier, TurnProfile::Circle)).collect())
        };
        let check = |tiers: &[Tier], u: f32, ratio: f32, want: &[usize]| {
            let entries = entries(&list(tiers), u, ratio);
            assert_eq!(entries.len(), ENTRIES);
            let counts: Vec<usize> = (0..tiers.len())
                .map(|i| entries.iter().filter(|e| **e as usize == i).count())
                .collect();
            assert_eq!(counts, want, "{tiers:?} {u} {ratio}");
        };
        use Tier::{A, B, C};
        check(&[A, B, C], 1.0, 4.0, &[4096, 0, 0]);
        check(&[A, B, C], 0.5, 3.0, &[2048, 1536, 512]);
        check(&[A, A, B, C], 0.5, 3.0, &[1024, 1024, 1536, 512]);
        check(&[A, B, C], 0.9999, 9.0, &[4094, 1, 1]);
        check(&[A, B, C], 0.0, 1.0, &[0, 2048, 2048]);
        check(&[A, C], 0.25, 9.0, &[1024, 3072]);
        check(&[A], 0.3, 9.0, &[4096]);
        check(&[A, A, A], 1.0, 9.0, &[1366, 1365, 1365]);
    }
}
