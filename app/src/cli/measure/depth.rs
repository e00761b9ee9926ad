//! Roots on the skin and hair under it.
//!
//! The points of each curve are looked at. Of curves that coif did not write, whose points may be far apart, the way between them is too:
//! where no point at its ends is too deep, a stretch that is counts as one.

use super::prim::{Prim, in_parts, quantile};
use coif_nodes::data::scalp::{Scalp, Skin};
use glam::Vec3;
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct OnScalp {
    /// Middle and largest distance of a root from the skin, cm.
    pub(super) root_distance_cm: [f32; 2],
    /// Points deeper under the skin than their curve allows (and 0.001 cm of rounding).
    pub(super) too_deep: usize,
    /// The deepest point's depth, cm.
    pub(super) deepest_cm: f32,
}

/// How far apart a way between points is looked at near the skin, cm, and how often at most.
const STEP: f32 = 0.2;
const MOST_STEPS: usize = 500;

pub(super) fn measure(prim: &Prim, scalp: &Scalp) -> OnScalp {
    let (surface, skin) = (scalp.surface(), scalp.skin());
    let allowed = prim.numbers("allow_depth");
    let fed = prim.whole("fed");
    let between = !prim.is_of_coifs_form();
    let parts = in_parts(prim.len(), 200, |part| {
        let (mut distances, mut too_deep, mut deepest) = (vec![], 0, 0.0f32);
        for i in part {
            let first = prim.range(i).start;
            let mut before = None;
            for (k, p) in prim.curve(i).iter().enumerate() {
                // Hair that was fed into a braid has no root.
                if k == 0 && fed.as_ref().is_none_or(|fed| fed[i] == 0) {
                    distances.extend(surface.closest(*p).map(|hit| hit.distance));
                }
                let depth = depth(scalp, &skin, *p);
                deepest = deepest.max(depth);
                let most = |k: usize| allowed.map_or(0.0, |a| a.at(i, first + k)) + 1e-3;
                let is_deep = depth > most(k);
                too_deep += usize::from(is_deep);
                if let Some(before) = before.replace((p, is_deep)).filter(|_| between) {
                    let within = deepest_between(scalp, &skin, *before.0, *p);
                    deepest = deepest.max(within);
                    let neither = !before.1 && !is_deep;
                    too_deep += usize::from(neither && within > most(k).max(most(k - 1)));
                }
            }
        }
        (distances, too_deep, deepest)
    });
    let mut distances = vec![];
    let (mut too_deep, mut deepest) = (0, 0.0f32);
    for (some, deep, depth) in parts {
        distances.extend(some);
        too_deep += deep;
        deepest = deepest.max(depth);
    }
    distances.sort_by(f32::total_cmp);
    OnScalp {
        root_distance_cm: [0.5, 1.0].map(|q| quantile(&distances, q)),
        too_deep,
        deepest_cm: deepest,
    }
}

/// How deep a point lies under the skin, cm; 0 where it does not.
pub(in super::super) fn depth(scalp: &Scalp, skin: &Skin, p: Vec3) -> f32 {
    // The field is quick and may be wrong at creases; what it finds deep is measured exactly.
    if skin.distance(p) >= 0.0 {
        return 0.0;
    }
    let surface = scalp.surface();
    surface.closest(p).map_or(0.0, |hit| -surface.signed_distance(p, &hit))
}

/// How deep a straight way lies under the skin at the deepest.
fn deepest_between(scalp: &Scalp, skin: &Skin, from: Vec3, to: Vec3) -> f32 {
    let length = from.distance(to);
    let least = STEP.max(length / MOST_STEPS as f32);
    let (mut s, mut deepest) = (least, 0.0f32);
    while s < length {
        let p = from.lerp(to, s / length);
        deepest = deepest.max(depth(scalp, skin, p));
        // As far as the skin is away there is none.
        s += skin.distance(p).max(least);
    }
    deepest
}
