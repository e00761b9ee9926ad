//! What brushes and drags do to strokes on a head: where points go. How strokes take it is the document's
//! (`coif_graphs::document::strokes`).
//!
//! Points of strokes that lie on the scalp keep their height over it.

use coif_graphs::document::strokes::cvs::placed;
use coif_nodes::data::scalp::Scalp;
use coif_nodes::data::strokes::Stroke;
use glam::Vec3;
use std::collections::BTreeSet;

/// A point of the world moved by `by`; on the scalp it keeps its height.
fn moved(scalp: &Scalp, p: Vec3, by: Vec3, on_scalp: bool) -> Vec3 {
    let to = p + by;
    if !on_scalp || by == Vec3::ZERO {
        return to;
    }
    let (Some(from), Some(root)) = (scalp.closest_root(p), scalp.closest_root(to)) else {
        return to;
    };
    root.point + root.normal * (p - from.point).dot(from.normal)
}

/// The stroke with each point moved by its weight's share of `by` (cm in the world).
pub(crate) fn dragged(
    scalp: &Scalp,
    stroke: &Stroke,
    weights: &[f32],
    by: Vec3,
    on_scalp: bool,
) -> Stroke {
    let mut places = vec![];
    for (i, (sample, weight)) in stroke.samples.iter().zip(weights).enumerate() {
        if *weight > 0.0 {
            let p = scalp.place(sample.position);
            let to = moved(scalp, p, by * *weight, on_scalp);
            places.push((i, scalp.given(to)));
        }
    }
    placed(stroke, &places)
}

/// How high a point of the world is over the scalp, cm; negative under it.
pub(crate) fn height(scalp: &Scalp, p: Vec3) -> Option<f32> {
    scalp.closest_root(p).map(|root| (p - root.point).dot(root.normal))
}

/// The stroke with some points put to a height over the scalp (cm), above where they are.
pub(crate) fn raised(
    scalp: &Scalp,
    stroke: &Stroke,
    points: &BTreeSet<usize>,
    height: f32,
) -> Stroke {
    let mut path = path(scalp, stroke);
    for (_, p) in path.iter_mut().enumerate().filter(|(i, _)| points.contains(i)) {
        if let Some(root) = scalp.closest_root(*p) {
            *p = root.point + root.normal * height;
        }
    }
    put(scalp, stroke, &path)
}

/// A pass of a brush.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// Where it is on the scalp, cm.
    pub(crate) at: Vec3,
    /// How far it came since the last sample, cm.
    pub(crate) by: Vec3,
    /// cm.
    pub(crate) radius: f32,
    /// 0 to 1.
    pub(crate) strength: f32,
    /// Whether strokes lie on the scalp.
    pub(crate) on_scalp: bool,
}

impl Pass {
    /// Where it is half as strong as in its middle, in its radius.
    pub(crate) fn half() -> f32 {
        (1.0 - 0.5_f32.sqrt()).sqrt()
    }

    /// Combs a path (cm in the world) the way of the brush; false when the brush does not reach it. Roots stay.
    pub(crate) fn comb(&self, scalp: &Scalp, path: &mut [Vec3]) -> bool {
        self.brush(scalp, path, |_, _, _| Some(self.by))
    }

    /// Takes the wiggles out of a path (cm in the world) under the brush; false when the brush does not reach it. Both
    /// ends stay.
    pub(crate) fn smooth(&self, scalp: &Scalp, path: &mut [Vec3]) -> bool {
        self.brush(scalp, path, |before, here, after| {
            let after = after?;
            // Towards the straight line, not along it: points stay as far apart as they are.
            let (a, b) = (before.distance(here), here.distance(after));
            let part = if a + b > 0.0 { a / (a + b) } else { 0.5 };
            Some((before + (after - before) * part - here) * 0.5)
        })
    }

    fn brush(
        &self,
        scalp: &Scalp,
        path: &mut [Vec3],
        way: impl Fn(Vec3, Vec3, Option<Vec3>) -> Option<Vec3>,
    ) -> bool {
        let mut reached = false;
        let Some(mut before) = path.first().copied() else { return false };
        for i in 1..path.len() {
            let here = path[i];
            let part = here.distance(self.at) / self.radius;
            if part < 1.0
                && let Some(by) = way(before, here, path.get(i + 1).copied())
            {
                let weight = (1.0 - part * part) * (1.0 - part * part) * self.strength;
                path[i] = moved(scalp, here, by * weight, self.on_scalp);
                reached = true;
            }
            before = here;
        }
        reached
    }
}

/// Where the points of a stroke are in the world, cm.
pub(crate) fn path(scalp: &Scalp, stroke: &Stroke) -> Vec<Vec3> {
    stroke.samples.iter().map(|s| scalp.place(s.position)).collect()
}

/// The stroke with its points put to a path.
pub(crate) fn put(scalp: &Scalp, stroke: &Stroke, path: &[Vec3]) -> Stroke {
    let places: Vec<(usize, Vec3)> = path.iter().map(|p| scalp.given(*p)).enumerate().collect();
    placed(stroke, &places)
}
