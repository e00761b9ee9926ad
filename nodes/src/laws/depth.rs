//! Hair under the skin.
//!
//! The points of each curve are looked at. Of curves that coif did not write, whose points may be far apart, the way between them is too:
//! where no point at its ends is too deep, a stretch that is counts as one.

use super::hair::MeasuredHair;
use crate::data::scalp::{Scalp, Skin};
use glam::Vec3;

/// How hair lies under the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinDepth {
    /// Points deeper under the skin than their curve allows (and 0.001 cm of rounding).
    pub too_deep: usize,
    /// Curves with such points.
    pub curves: usize,
    /// The deepest point's depth, cm.
    pub deepest_cm: f32,
}

/// How far apart a way between points is looked at near the skin, cm, and how often at most.
const STEP: f32 = 0.2;
const MOST_STEPS: usize = 500;
/// How deep a point may lie beside what its curve allows, cm.
const ROUNDING: f32 = 1e-3;

/// Looks at every point, and between them where a curve is not as coif writes it.
pub fn measure(hair: &MeasuredHair, scalp: &Scalp) -> SkinDepth {
    let skin = scalp.skin();
    let allowed = hair.numbers("allow_depth");
    let between = !hair.is_of_coifs_form();
    let parts = hair.in_parts(hair.len(), 200, |part| {
        let (mut too_deep, mut curves, mut deepest) = (0, 0, 0.0f32);
        for i in part {
            let (first, before_it) = (hair.range(i).start, too_deep);
            let mut before = None;
            for (k, p) in hair.curve(i).iter().enumerate() {
                let depth = depth(scalp, &skin, *p);
                deepest = deepest.max(depth);
                let most =
                    |k: usize| allowed.as_ref().map_or(0.0, |a| a.at(i, first + k)) + ROUNDING;
                let is_deep = depth > most(k);
                too_deep += usize::from(is_deep);
                if let Some(before) = before.replace((p, is_deep)).filter(|_| between) {
                    let within = deepest_between(scalp, &skin, *before.0, *p);
                    deepest = deepest.max(within);
                    let neither = !before.1 && !is_deep;
                    too_deep += usize::from(neither && within > most(k).max(most(k - 1)));
                }
            }
            curves += usize::from(too_deep > before_it);
        }
        SkinDepth { too_deep, curves, deepest_cm: deepest }
    });
    let none = SkinDepth { too_deep: 0, curves: 0, deepest_cm: 0.0 };
    parts.into_iter().fold(none, |all, part| SkinDepth {
        too_deep: all.too_deep + part.too_deep,
        curves: all.curves + part.curves,
        deepest_cm: all.deepest_cm.max(part.deepest_cm),
    })
}

/// How deep a point lies under the skin, cm; 0 where it does not.
fn depth(scalp: &Scalp, skin: &Skin, p: Vec3) -> f32 {
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
