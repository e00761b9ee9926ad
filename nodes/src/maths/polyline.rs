//! Lines of points, by arc length: places on them, even points, smoothing.
//!
//! Guarantees: the ends of a line stay, however it is smoothed; a line of one point has no length and is that point
//! everywhere.

use glam::Vec3;

/// A polyline with its cumulative length.
#[derive(Clone, Debug)]
pub(crate) struct Polyline {
    pub(crate) points: Vec<Vec3>,
    lengths: Vec<f32>,
}

impl Polyline {
    /// The polyline through `points`, at least one.
    pub(crate) fn new(points: Vec<Vec3>) -> Self {
        let mut sum = 0.0f64;
        let mut lengths = vec![0.0];
        for w in points.windows(2) {
            sum += f64::from(w[0].distance(w[1]));
            lengths.push(sum as f32);
        }
        Self { points, lengths }
    }
    /// Length, cm.
    pub(crate) fn length(&self) -> f32 {
        self.lengths.last().copied().unwrap_or(0.0)
    }
    /// Index of the point before arc length `s`, and the fraction toward the next one.
    pub(crate) fn place(&self, s: f32) -> (usize, f32) {
        let last = self.points.len().saturating_sub(2);
        let i = self.lengths.partition_point(|l| *l <= s).saturating_sub(1).min(last);
        let Some(after) = self.lengths.get(i + 1) else { return (0, 0.0) };
        let step = after - self.lengths[i];
        (i, if step > 0.0 { ((s - self.lengths[i]) / step).clamp(0.0, 1.0) } else { 0.0 })
    }
    /// The point at arc length `s`.
    pub(crate) fn at(&self, s: f32) -> Vec3 {
        let (i, t) = self.place(s);
        let next = self.points[(i + 1).min(self.points.len() - 1)];
        self.points[i] + (next - self.points[i]) * t
    }
    /// `n` points evenly spaced by arc length, ends included.
    pub(crate) fn evenly(&self, n: usize) -> Vec<Vec3> {
        let step = self.length() / (n.max(2) - 1) as f32;
        let mut points: Vec<Vec3> = (0..n).map(|k| self.at(k as f32 * step)).collect();
        if let (Some(to), Some(from)) = (points.last_mut(), self.points.last()) {
            *to = *from;
        }
        points
    }
    /// The line smoothed by a Gaussian of standard deviation `sigma` (cm), with fixed ends.
    pub(crate) fn smoothed(&self, sigma: f32) -> Self {
        let length = self.length();
        if sigma <= 0.0 || length <= 0.0 {
            return self.clone();
        }
        // Three points per sigma; a sigma above a third of the line would only straighten it further.
        let sigma = sigma.min(length / 3.0);
        let n = ((length / sigma * 3.0).ceil() as usize).clamp(8, MOST) + 1;
        let h = length / (n - 1) as f32;
        let rounds = (2.0 * (sigma / h) * (sigma / h)).round().clamp(1.0, 64.0) as usize;
        let mut points = self.evenly(n);
        filter(&mut points, rounds);
        Self::new(points)
    }
}

/// The most points a line is sampled with.
pub(crate) const MOST: usize = 4096;

/// Rounds of (1, 2, 1) / 4; each adds half a squared spacing to the variance. The ends stay fixed.
pub(crate) fn filter(points: &mut [Vec3], rounds: usize) {
    for _ in 0..rounds {
        let mut before = match points.first() {
            Some(first) => *first,
            None => return,
        };
        for i in 1..points.len().saturating_sub(1) {
            let here = points[i];
            points[i] = (before + here * 2.0 + points[i + 1]) * 0.25;
            before = here;
        }
    }
}
