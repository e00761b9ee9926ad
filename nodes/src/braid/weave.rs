//! The weave: where the strands of a braid stand in its cross-section, and how large the braid then is.
//!
//! The idea (methods.md 2): all strands share one closed path across the braid, `x = A sin(c)`,
//! `y = B sin(m c + psi)`, strand i of N walking it i/N of a cycle ahead, with gcd(m, N) = 1.
//! m = 1 is a rope, m = 2 the classic braid, m = N - 1 a plain weave. The formula of the Lightyear
//! talk (section 2.1), which is this weave at N = 3, is offered beside it; for N > 3 its strands pass
//! through one another.
//!
//! Cycles are counted in turns and kept as f64, so that the two hundredth stitch is as exact as the first.

use crate::maths::transcendental::sin_cos_turns;

/// The frequency of a fresh braid of `strands`: the smallest from 2 on that has no divisor in common with it
/// (a rope for two strands).
pub(crate) fn default_frequency(strands: u32) -> u32 {
    match strands {
        2 => 1,
        n => (2..n).find(|m| coprime(*m, n)).unwrap_or(1),
    }
}

/// Whether `a` and `b` have no divisor in common but 1.
pub(crate) fn coprime(mut a: u32, mut b: u32) -> bool {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// A cross-section: how many strands, which path, seen from which side.
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
    /// The weave of `strands` with frequency `m` (coprime to it). `under`: at the outermost crossings the strand moving
    /// inward passes below its neighbour; an odd `m` is the same braid either way. `mirrored` swaps left and right.
    pub(crate) fn new(strands: u32, m: u32, under: bool, mirrored: bool) -> Self {
        // Just past the outermost place the path's height has the sign of sin(m (90 + e)), that is of
        // (-1)^(m/2) sin(m e).
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
    /// Where strand `i` stands for A = B = 1 when the first strand has walked `cycle` turns.
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
    /// The side on which a strand is a quarter of a cycle after x = 0: 1 right, -1 left.
    pub(crate) fn first_side(&self) -> i32 {
        if self.across > 0.0 { 1 } else { -1 }
    }
    /// How often a strand goes up and down in one cycle.
    pub(crate) fn waves(&self) -> u32 {
        self.m
    }
    /// Cycles at which the first strand is highest.
    fn tops(&self) -> impl Iterator<Item = f64> {
        let (m, quarter) = if self.lightyear {
            (2, 0.0)
        } else {
            (self.m, if self.m % 2 == 1 { 0.25 } else { 0.0 })
        };
        let top = if self.depth > 0.0 { 0.25 } else { 0.75 };
        (0..m).map(move |k| (f64::from(k) + top - quarter) / f64::from(m))
    }
}

/// How far apart stitches are.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pitch {
    /// So many cm.
    Cm(f32),
    /// So many times the amplitude A.
    Amplitudes(f32),
}

/// The inner measures of a straight braid of a given outer size, cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    /// Amplitude of the centre lines across.
    pub(crate) a: f32,
    /// Amplitude of the centre lines in depth.
    pub(crate) b: f32,
    /// Distance of stitches.
    pub(crate) pitch: f32,
    /// Radius of a strand where it is outermost.
    pub(crate) side: f32,
    /// Radius of a strand where it is highest (or lowest).
    pub(crate) top: f32,
}

/// The neighbourhoods that decide a braid's outer size: what other strands do around the outermost
/// and the highest places of one. Independent of size, so made once.
pub(crate) struct Neighbours {
    side: Around,
    tops: Vec<Around>,
}

/// Where other strands are around a place of one and around its two flanks: across, deep (amplitudes), along (stitches).
type Around = [Vec<[f32; 3]>; 3];

/// Stitches from a place to its flanks. Radii are smoothed below their peaks (`touch.rs`), which takes a peak
/// down to the value it has about so far away.
const FLANK: f64 = 0.15;

/// Samples of a stitch in which the nearest place of another strand is looked for: finer moves the
/// size of the braid by less than a thousandth.
const FINE: i32 = 24;
/// Stitches to either side that are looked at: at the closest stitches allowed the nearest place is
/// not always within one.
const REACH: i32 = 2;

impl Neighbours {
    pub(crate) fn new(weave: &Weave) -> Self {
        let near = |cycle: f64| {
            let (x0, y0) = weave.at(0, cycle);
            let mut near = vec![];
            for i in 1..weave.strands {
                for step in -REACH * FINE..=REACH * FINE {
                    let stitches = f64::from(step) / f64::from(FINE);
                    let (x, y) = weave.at(i, cycle + stitches / f64::from(weave.strands));
                    near.push([x - x0, y - y0, stitches as f32]);
                }
            }
            near
        };
        let flank = FLANK / f64::from(weave.strands);
        let around = |cycle: f64| [cycle - flank, cycle, cycle + flank].map(near);
        Self { side: around(0.25), tops: weave.tops().map(around).collect() }
    }

    /// The centre lines of a straight braid that is `width` by `height` over its tubes, whose radii are `fullness`
    /// times what makes them touch.
    pub(crate) fn size(&self, width: f32, height: f32, pitch: Pitch, fullness: f32) -> Size {
        let (half_w, half_h) = (0.5 * width, 0.5 * height);
        let (mut a, mut b) = (0.7 * half_w, 0.5 * half_h);
        let mut size = Size { a, b, pitch: 0.0, side: 0.0, top: 0.0 };
        // Amplitude plus radius is the half size, and the radius follows the amplitude more slowly than
        // one to one: half steps converge to 1e-4 of the size within sixteen.
        for _ in 0..16 {
            let pitch = match pitch {
                Pitch::Cm(h) => h,
                Pitch::Amplitudes(times) => times * a,
            };
            let radius = |around: &Around| {
                let nearest = around.iter().flatten().fold(f32::MAX, |least, [x, y, z]| {
                    let (x, y, z) = (x * a, y * b, z * pitch);
                    least.min(x * x + y * y + z * z)
                });
                0.5 * fullness * nearest.sqrt()
            };
            // A flat braid is flat at its sides, too.
            let side = radius(&self.side).min(half_h);
            let top = self.tops.iter().fold(0.0, |most: f32, near| most.max(radius(near)));
            size = Size { a, b, pitch, side, top };
            a = (0.5 * (a + half_w - side)).max(0.05 * half_w);
            b = (0.5 * (b + half_h - top)).max(0.02 * half_h);
        }
        size
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
            let near = Neighbours::new(&Weave::new(n, default_frequency(n), true, false));
            for (width, height) in [(1.0, 0.5), (1.0, 1.0), (3.0, 0.6), (0.2, 0.15)] {
                for pitch in [Pitch::Amplitudes(2.0), Pitch::Cm(0.4 * width), Pitch::Cm(width)] {
                    let size = near.size(width, height, pitch, 1.0);
                    let (w, h) = (2.0 * (size.a + size.side), 2.0 * (size.b + size.top));
                    assert!((w / width - 1.0).abs() < 2e-3, "{n} {w} {width}");
                    assert!((h / height - 1.0).abs() < 2e-3, "{n} {h} {height}");
                }
            }
        }
    }
}
