//! Laying lines on the scalp: shared by drawn strokes, projected curves and hair pulled from partings.

use crate::data::attributes::{Domain, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV};
use crate::data::curves::TuftBuilder;
use crate::data::scalp::{Root, Scalp};
use glam::Vec3;

/// Binds the curves of a tuft, in order, to these roots.
pub(crate) fn bind(tuft: &mut TuftBuilder, roots: &[Root]) {
    if roots.is_empty() {
        return;
    }
    let triangles = roots.iter().map(|r| r.triangle as i32).collect();
    tuft.set(ROOT_TRIANGLE, Domain::Curve, triangles);
    tuft.set(ROOT_BARY, Domain::Curve, roots.iter().map(|r| r.bary).collect());
    tuft.set(ROOT_UV, Domain::Curve, roots.iter().map(|r| r.uv).collect());
}

/// The point at `height` (cm) above the scalp's closest point to `p`, and the smooth normal there; `p` itself without a
/// scalp.
pub(crate) fn laid(scalp: &Scalp, p: Vec3, height: f32) -> (Vec3, Vec3) {
    match scalp.closest_root(p) {
        Some(root) => (root.point + root.normal * height, root.normal),
        None => (p, Vec3::ZERO),
    }
}

/// Where a pen at `p` touches the scalp: the closest point, or scalp that overhangs it as seen from outside the head,
/// such as the modeled locks of a scan. Nothing is drawn below such a lock. Ears, where no hair grows, do not count as
/// overhangs.
pub(crate) fn met(scalp: &Scalp, p: Vec3) -> Option<Root> {
    let mut root = scalp.closest_root(p)?;
    let frame = scalp.frame();
    let Some(up) = (root.point - frame.point_from_head(Vec3::ZERO)).try_normalize() else {
        return Some(root);
    };
    let surface = scalp.surface();
    let (below, mut come) = (root.point, 0.0);
    for _ in 0..LAYERS {
        let left = OVERHANG * frame.unit() - come;
        let Some(hit) = surface.ray(below + up * (come + PAST), up, left) else { break };
        come += PAST + hit.distance;
        let grows = scalp.grows(hit.triangle, hit.bary) > 0.0;
        if grows && surface.face_normal(hit.triangle).dot(up) > 0.0 {
            root = scalp.root(hit.triangle, hit.bary);
        }
    }
    Some(root)
}

/// Distance out from the scalp within which overhangs are searched, cm on a head of average size: anything farther is
/// not a lock.
const OVERHANG: f32 = 1.5;
/// The most layers searched.
const LAYERS: usize = 8;
/// Anything closer than this (cm) is the layer itself.
const PAST: f32 = 1e-3;

/// The smooth scalp normal nearest to each point.
pub(crate) fn scalp_normals(scalp: &Scalp, points: &[Vec3]) -> Vec<Vec3> {
    points.iter().map(|p| laid(scalp, *p, 0.0).1).collect()
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pen_meets_the_lock_that_overhangs_and_no_ear() {
        use crate::data::scalp::{HeadFrame, REGION};
        use crate::maths::closest::Surface;
        use crate::maths::closest::tests::sphere;
        // A plate 0.6 cm over the crown of a ball, seen from above.
        let ball = sphere(9.0, 48);
        let n = ball.points.len() as u32;
        let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
        let plate = corners.map(|(x, z)| Vec3::new(x, 9.6, z));
        let points: Vec<Vec3> = ball.points.iter().copied().chain(plate).collect();
        let faces = [[n, n + 2, n + 1], [n, n + 3, n + 2]];
        let triangles: Vec<_> = ball.triangles.iter().copied().chain(faces).collect();
        let met_at = |hair_on_it: f32, p: Vec3| {
            let region = (0..n + 4).map(|v| if v < n { 1.0 } else { hair_on_it }).collect();
            let surface = Surface::new(points.clone(), triangles.clone());
            let frame = HeadFrame { radius: 9.0, ..HeadFrame::IDENTITY };
            let scalp = Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into());
            met(&scalp, p).unwrap().point
        };
        let under = Vec3::new(0.3, 9.1, 0.2);
        assert!((met_at(1.0, under).y - 9.6).abs() < 1e-4);
        assert!((met_at(0.0, under).length() - 9.0).abs() < 0.05);
        let beside = Vec3::new(4.0, 8.1, 0.0);
        assert!((met_at(1.0, beside).length() - 9.0).abs() < 0.05);
    }
}
