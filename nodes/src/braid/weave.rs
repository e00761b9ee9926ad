//! The weave: positions of a braid's strands in its cross-section, and the resulting size of the braid.
//!
//! The idea (methods.md 2): all strands share one closed path across the braid, `x = A sin(c)`, `y = B sin(m c + psi)`,
//! with strand i of N walking it i/N of a cycle ahead, and gcd(m, N) = 1. m = 1 is a rope, m = 2 the classic braid, m =
//! N - 1 a plain weave. The formula of the Lightyear talk (section 2.1), which is this weave at N = 3, is offered as
//! well; for N > 3 its strands intersect.
//!
//! Cycles are counted in turns and kept as f64, so that the two hundredth stitch is as exact as the first.

use super::strand_radius::OF_CURVATURE;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// Default frequency of a braid of `strands`: the smallest from 2 up that shares no divisor with it (a rope for two
/// strands).
pub(crate) fn default_frequency(strands: u32) -> u32 {
    match strands {
        2 => 1,
        n => (2..n).find(|m| coprime(*m, n)).unwrap_or(1),
    }
}

/// Whether `a` and `b` share no divisor but 1.
pub(crate) fn coprime(mut a: u32, mut b: u32) -> bool {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// A cross-section: number of strands, path, and viewing side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weave {
    pub(crate) strands: u32,
    m: u32,
    lightyear: bool,
    /// -1 where left and right are swapped.
    across: f32,
    /// -1 where front and back are swapped.
    depth: f32,
}

impl Weave {
    /// The weave of `strands` with frequency `m` (coprime to it). `under`: at the outermost crossings, the strand
    /// moving inward passes below its neighbour; an odd `m` gives the same braid either way. `mirrored` swaps left and
    /// right.
    pub(crate) fn new(strands: u32, m: u32, under: bool, mirrored: bool) -> Self {
        // Just past the outermost point, the path's height has the sign of sin(m (90 + e)), that is, of (-1)^(m/2)
        // sin(m e).
        let natural = (m / 2) % 2 == 1;
        let depth = if m % 2 == 1 || under == natural { 1.0 } else { -1.0 };
        Self { strands, m, lightyear: false, across: if mirrored { -1.0 } else { 1.0 }, depth }
    }
    /// The formula of the Lightyear talk as printed.
    pub(crate) fn lightyear(strands: u32, under: bool, mirrored: bool) -> Self {
        Self { lightyear: true, ..Self::new(strands, 2, under, mirrored) }
    }
    /// How far strand `i` is ahead of the first, in cycles.
    pub(crate) fn ahead(&self, i: u32) -> f64 {
        f64::from(i) / f64::from(self.strands)
    }
    /// Position of strand `i` for A = B = 1 when the first strand has walked `cycle` turns.
    pub(crate) fn at(&self, i: u32, cycle: f64) -> (f32, f32) {
        let sine = |turns: f64| sin_cos_turns((turns - turns.floor()) as f32).0;
        let own = cycle + self.ahead(i);
        let y = if self.lightyear {
            sine(2.0 * cycle - self.ahead(i))
        } else {
            let quarter = if self.m % 2 == 1 { 0.25 } else { 0.0 };
            sine(f64::from(self.m) * own + quarter)
        };
        (self.across * sine(own), self.depth * y)
    }
    /// The side of a strand a quarter of a cycle after x = 0: 1 right, -1 left.
    pub(crate) fn first_side(&self) -> i32 {
        if self.across > 0.0 { 1 } else { -1 }
    }
    /// Oscillations of a strand per cycle.
    pub(crate) fn waves(&self) -> u32 {
        self.m
    }
}

/// Length of a stitch.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pitch {
    /// In cm.
    Cm(f32),
    /// In multiples of the amplitude A.
    Amplitudes(f32),
}

impl Pitch {
    fn of(self, a: f32) -> f32 {
        match self {
            Pitch::Cm(h) => h,
            Pitch::Amplitudes(times) => times * a,
        }
    }
}

/// The inner dimensions of a straight braid of a given outer size, cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BraidSize {
    /// Amplitude of the centre lines across.
    pub(crate) a: f32,
    /// Amplitude of the centre lines in depth.
    pub(crate) b: f32,
    /// Length of a stitch.
    pub(crate) pitch: f32,
    /// From the amplitude across to the outside of the tubes.
    pub(crate) side: f32,
    /// From the amplitude in depth to the outside of the tubes.
    pub(crate) top: f32,
}

/// The paths of all strands over one cycle, A = B = 1, from which the size of a straight braid follows. Computed once
/// for all braids of an evaluation.
pub(crate) struct Paths {
    strands: usize,
    /// For each strand its positions across and in depth, [`FINE`] per stitch, with [`REACH`] more at both ends.
    at: Vec<[Vec<f32>; 2]>,
}

/// Tubes may reach this factor of half the requested height beside the highest points: slightly above it, so that only
/// flat braids feel the limit.
pub(crate) const OUTLINE: f32 = 1.06;
/// Samples per stitch: more would change the size of a braid by less than a hundredth.
const FINE: usize = 16;
/// Samples to each side in which the nearest point of another strand is searched.
const REACH: usize = 20;

impl Paths {
    pub(crate) fn new(weave: &Weave) -> Self {
        let n = weave.strands as usize;
        let path = |i: u32| {
            let place = |k: usize| {
                let stitches = (k as f64 - REACH as f64) / FINE as f64;
                weave.at(i, stitches / n as f64)
            };
            let places = (0..n * FINE + 2 * REACH).map(place);
            let (xs, ys) = places.unzip();
            [xs, ys]
        };
        Self { strands: n, at: (0..weave.strands).map(path).collect() }
    }

    /// The centre lines of a straight braid that is `width` by `height` over its tubes, whose radii are `fullness`
    /// times those that touch.
    pub(crate) fn size(&self, width: f32, height: f32, pitch: Pitch, fullness: f32) -> BraidSize {
        let (half_w, half_h) = (0.5 * width, 0.5 * height);
        let (mut a, mut b) = (0.7 * half_w, 0.5 * half_h);
        // The tubes' contribution changes more slowly than the amplitude: half steps converge to a thousandth of the
        // size within twelve.
        for _ in 0..12 {
            let (w, h) = self.outer(a, b, pitch.of(a), fullness);
            a = (a + 0.5 * (half_w - w)).max(0.05 * half_w);
            b = (b + 0.5 * (half_h - h)).max(0.02 * half_h);
        }
        BraidSize { a, b, pitch: pitch.of(a), side: half_w - a, top: half_h - b }
    }

    /// Half the outer width, and half the outer height where strands are highest: elsewhere the node keeps tubes below
    /// that.
    fn outer(&self, a: f32, b: f32, pitch: f32, fullness: f32) -> (f32, f32) {
        // Half a cycle later, everything is mirrored.
        let n = self.strands * FINE / 2;
        let [xs, ys] = &self.at[0];
        let step = pitch / FINE as f32;
        let radii: Vec<f32> = (0..n)
            .map(|k| {
                let (x, y) = (xs[k + REACH], ys[k + REACH]);
                let mut nearest = f32::MAX;
                for [others_x, others_y] in &self.at[1..] {
                    let window = k..k + 2 * REACH + 1;
                    let (others_x, others_y) = (&others_x[window.clone()], &others_y[window]);
                    for (d, (u, v)) in others_x.iter().zip(others_y).enumerate() {
                        let dz = (d as f32 - REACH as f32) * step;
                        let (dx, dy) = ((u - x) * a, (v - y) * b);
                        nearest = nearest.min(dx * dx + dy * dy + dz * dz);
                    }
                }
                // Circle through the neighbouring samples.
                let place = |k: usize| Vec3::new(xs[k] * a, ys[k] * b, k as f32 * step);
                let [p, q, r] = [place(k + REACH - 1), place(k + REACH), place(k + REACH + 1)];
                let sides = p.distance(q) * q.distance(r) * r.distance(p);
                let turn = 0.5 * sides / (q - p).cross(r - q).length().max(1e-9);
                (0.5 * fullness * nearest.sqrt()).min(OF_CURVATURE * turn)
            })
            .collect();
        // As `strand_radius.rs` rounds kinks: the minimum of the neighbours, averaged over as many.
        let low = |k: usize| radii[k % n].min(radii[(k + 1) % n]).min(radii[(k + n - 1) % n]);
        let radius = |k: usize| 0.25 * (low(k + n - 1) + 2.0 * low(k) + low(k + 1));
        let highest = (0..n)
            .fold(0, |best, k| if ys[k + REACH].abs() > ys[best + REACH].abs() { k } else { best });
        let h = b * ys[highest + REACH].abs() + radius(highest);
        let w = (0..n).fold(0.0f32, |w, k| {
            let room = OUTLINE * h - b * ys[k + REACH].abs();
            w.max(a * xs[k + REACH].abs() + radius(k).min(room))
        });
        (w, h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Smallest distance of two strands' centres in the cross-section, A = 1, B = 0.5.
    fn section_distance(weave: &Weave) -> f32 {
        let mut least = f32::MAX;
        for k in 0..2000 {
            let at: Vec<(f32, f32)> =
                (0..weave.strands).map(|i| weave.at(i, f64::from(k) / 2000.0)).collect();
            for i in 0..at.len() {
                for j in 0..i {
                    let (x, y) = (at[i].0 - at[j].0, 0.5 * (at[i].1 - at[j].1));
                    least = least.min((x * x + y * y).sqrt());
                }
            }
        }
        least
    }

    #[test]
    fn strands_keep_the_section_distances_of_the_method() {
        let table = [
            (3, 2, 0.866),
            (4, 3, 0.599),
            (5, 2, 0.588),
            (5, 4, 0.406),
            (6, 5, 0.288),
            (7, 2, 0.434),
            (8, 3, 0.372),
            (2, 1, 1.0),
            (12, 11, 0.073),
        ];
        for (n, m, want) in table {
            for under in [true, false] {
                let got = section_distance(&Weave::new(n, m, under, false));
                assert!((got - want).abs() < 1e-3, "({n}, {m}): {got} {want}");
            }
        }
        for (n, want) in [(3, 0.866), (4, 0.0), (5, 0.130), (6, 0.0), (7, 0.069), (8, 0.0)] {
            let got = section_distance(&Weave::lightyear(n, true, false));
            assert!((got - want).abs() < 1e-3, "lightyear {n}: {got} {want}");
        }
    }

    #[test]
    fn the_default_frequency_is_the_smallest_that_weaves() {
        let want = [
            (2, 1),
            (3, 2),
            (4, 3),
            (5, 2),
            (6, 5),
            (7, 2),
            (8, 3),
            (9, 2),
            (10, 3),
            (11, 2),
            (12, 5),
        ];
        for (n, m) in want {
            assert_eq!(default_frequency(n), m, "{n}");
        }
    }

    #[test]
    fn three_strands_of_the_talk_are_the_weave() {
        let (weave, talk) = (Weave::new(3, 2, true, false), Weave::lightyear(3, true, false));
        let mut worst = 0.0f32;
        for k in 0..60_000 {
            let cycle = f64::from(k) * 0.001_1;
            for i in 0..3 {
                let ((x, y), (u, v)) = (weave.at(i, cycle), talk.at(i, cycle));
                worst = worst.max((x - u).abs()).max((y - v).abs());
            }
        }
        assert!(worst < 1e-5, "{worst:e}");
    }

    #[test]
    fn the_inner_size_fills_the_outer_one() {
        for n in 2..=12 {
            let paths = Paths::new(&Weave::new(n, default_frequency(n), true, false));
            for (width, height) in [(1.0, 0.5), (1.0, 1.0), (3.0, 0.6), (0.2, 0.15)] {
                for pitch in [Pitch::Amplitudes(2.0), Pitch::Cm(0.4 * width), Pitch::Cm(width)] {
                    let size = paths.size(width, height, pitch, 1.0);
                    let (w, h) = paths.outer(size.a, size.b, size.pitch, 1.0);
                    assert!((2.0 * w / width - 1.0).abs() < 5e-3, "{n} {w} {width}");
                    assert!((2.0 * h / height - 1.0).abs() < 5e-3, "{n} {h} {height}");
                }
            }
        }
    }
}
