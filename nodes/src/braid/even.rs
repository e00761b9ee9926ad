//! Even spacing of points along a hair, and the two curves that guide hairs.
//!
//! Guarantees: after [`EvenSampler::out`], adjacent chords differ by at most a tenth, and both readings of the hair agree, if
//! it bends by less than a right angle within a few points; the ends stay in place. Not promised: that other points
//! stay in place.

use crate::maths::catmull_rom_agreement::{AGREE, Chords, readings_differ};
use glam::Vec3;

/// A point of a hair under construction.
#[derive(Clone, Copy)]
pub(super) struct Bead {
    pub(super) p: Vec3,
    /// Fraction along the braid's source.
    pub(super) along: f32,
    /// Whether the skin may be near.
    pub(super) near: bool,
    /// Whether it was certainly out of the skin when it was last lifted. Anything that moves it later lifts it again.
    pub(super) clear: bool,
}

impl Bead {
    pub(super) fn new(p: Vec3, along: f32, near: bool) -> Self {
        Self { p, along, near, clear: false }
    }
}

/// Buffers of [`EvenSampler::out`].
#[derive(Default)]
pub(super) struct EvenSampler {
    beads: Vec<Bead>,
    points: Vec<Vec3>,
    /// Distance from each bead to the next, cm.
    chords: Vec<f32>,
    /// Speed of the spline through the beads at each bead, cm per span.
    speeds: Vec<f32>,
}

/// If adjacent chords differ by less than this, both readings of the hair agree.
const EVEN: f32 = 1.1;
/// Rounds of adjustment.
const ROUNDS: usize = 6;

impl EvenSampler {
    /// Moves the beads of a hair along it until they are evenly spaced; they must nearly be already.
    pub(super) fn out(&mut self, beads: &mut Vec<Bead>) {
        let n = beads.len();
        if n < 3 {
            return;
        }
        let joins = beads[0].along;
        for _ in 0..ROUNDS {
            self.chords.clear();
            self.chords.extend(chords(beads));
            if self.is_even(beads) {
                return;
            }
            self.speeds.clear();
            self.speeds.push(self.chords[0]);
            self.speeds.extend(beads.windows(3).map(|w| 0.5 * w[0].p.distance(w[2].p)));
            self.speeds.push(self.chords[n - 2]);
            let total: f32 = self.chords.iter().fold(0.0, |sum, chord| sum + chord);
            self.beads.clear();
            let (mut k, mut before) = (0, 0.0);
            for i in 0..n {
                let s = total * i as f32 / (n - 1) as f32;
                while k + 2 < n && before + self.chords[k] < s {
                    before += self.chords[k];
                    k += 1;
                }
                // Speed is assumed linear along the span, as in `maths/rail.rs`.
                let (from, to) = (self.speeds[k], self.speeds[k + 1]);
                let per_mean = 2.0 / (from + to).max(1e-9);
                let (speed, faster) = (from * per_mean, (to - from) * per_mean);
                let x = ((s - before) / self.chords[k].max(1e-9)).clamp(0.0, 1.0);
                let root = (speed * speed + 2.0 * faster * x).max(0.0).sqrt();
                let t = (2.0 * x / (speed + root).max(1e-6)).min(1.0);
                let (a, b) = (beads[k], beads[k + 1]);
                let p = spline_point(|k| beads[k].p, n, k, t);
                // Not before it has joined.
                let along = if a.along > joins { a.along + (b.along - a.along) * t } else { joins };
                self.beads.push(Bead::new(p, along, a.near || b.near));
            }
            self.beads[0] = beads[0];
            self.beads[n - 1] = beads[n - 1];
            std::mem::swap(beads, &mut self.beads);
        }
    }

    /// Whether the beads are evenly spaced; their chords must be known.
    fn is_even(&mut self, beads: &[Bead]) -> bool {
        let chords = Chords::of(self.chords.iter().copied());
        if chords.ratio >= EVEN || chords.readings_differ_at_most() <= AGREE {
            return chords.ratio < EVEN;
        }
        self.points.clear();
        self.points.extend(beads.iter().map(|bead| bead.p));
        readings_differ(&self.points) <= AGREE
    }
}

/// Distance from each bead of a hair to the next, cm.
pub(super) fn chords(beads: &[Bead]) -> impl Iterator<Item = f32> {
    beads.windows(2).map(|w| w[0].p.distance(w[1].p))
}

/// Straightens a hair slightly where the skin may be near.
pub(super) fn relax(beads: &mut [Bead]) {
    let Some(first) = beads.first() else { return };
    let mut before = first.p;
    for k in 1..beads.len() - 1 {
        let here = beads[k].p;
        if beads[k].near {
            beads[k].p = here * 0.5 + (before + beads[k + 1].p) * 0.25;
        }
        before = here;
    }
}

/// Catmull-Rom spline through `n` even points with extrapolated ends, between the points `k` and `k` + 1.
#[inline]
pub(super) fn spline_point(at: impl Fn(usize) -> Vec3, n: usize, k: usize, t: f32) -> Vec3 {
    let (b, c) = (at(k), at(k + 1));
    let a = if k > 0 { at(k - 1) } else { b * 2.0 - c };
    let d = if k + 2 < n { at(k + 2) } else { c * 2.0 - b };
    let (t2, t3) = (t * t, t * t * t);
    a * (t2 - 0.5 * (t3 + t))
        + b * (1.5 * t3 - 2.5 * t2 + 1.0)
        + c * (0.5 * t - 1.5 * t3 + 2.0 * t2)
        + d * (0.5 * (t3 - t2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_points_of_a_bent_hair_are_made_even() {
        // A quarter circle whose points crowd at its start.
        let at = |k: usize| {
            let (y, x) = crate::maths::transcendental::sin_cos_turns(
                0.25 * {
                    let x = k as f32 / 29.0;
                    x * x * x
                },
            );
            Bead::new(Vec3::new(x, y, 0.0), y, k == 3)
        };
        let mut beads: Vec<Bead> = (0..30).map(at).collect();
        EvenSampler::default().out(&mut beads);
        let chords: Vec<f32> = beads.windows(2).map(|w| w[0].p.distance(w[1].p)).collect();
        let (least, most) =
            chords.iter().fold((f32::MAX, 0.0f32), |(a, b), c| (a.min(*c), b.max(*c)));
        assert!(most < 1.1 * least, "{least} {most}");
        assert!(beads.iter().all(|b| (b.p.length() - 1.0).abs() < 1e-2));
        assert!(beads.windows(2).all(|w| w[0].along <= w[1].along) && beads.len() == 30);
        assert_eq!((beads[0].p, beads[29].p), (at(0).p, at(29).p));
    }
}
