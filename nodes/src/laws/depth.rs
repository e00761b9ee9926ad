//! Hair under the skin.
//!
//! Each CV is measured. On curves that coif did not write, whose CVs may be far apart, so are the segments between them: a
//! segment with a deep part counts once, unless one of its ends is too deep itself.

use super::hair::MeasuredHair;
use crate::data::scalp::{Scalp, Skin};
use glam::Vec3;

/// How deep hair is under the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinDepth {
    /// Number of CVs deeper than their curve allows (with 0.001 cm of tolerance).
    pub too_deep: usize,
    /// Number of curves with such CVs.
    pub curves: usize,
    /// Depth of the deepest CV, cm.
    pub deepest_cm: f32,
}

/// Spacing of samples along a segment near the skin, cm, and their largest number.
const STEP: f32 = 0.2;
const MOST_STEPS: usize = 500;
/// Tolerance of the allowed depth, cm.
const ROUNDING: f32 = 1e-3;

/// Measures every CV, and segments of curves that coif did not write.
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

/// Depth of a point under the skin, cm; 0 outside.
fn depth(scalp: &Scalp, skin: &Skin, p: Vec3) -> f32 {
    // The field is fast and may be wrong at creases; what it finds deep is measured exactly.
    if skin.distance(p) >= 0.0 {
        return 0.0;
    }
    let surface = scalp.surface();
    surface.closest(p).map_or(0.0, |hit| -surface.signed_distance(p, &hit))
}

/// Largest depth of a segment under the skin.
fn deepest_between(scalp: &Scalp, skin: &Skin, from: Vec3, to: Vec3) -> f32 {
    let length = from.distance(to);
    let least = STEP.max(length / MOST_STEPS as f32);
    let (mut s, mut deepest) = (least, 0.0f32);
    while s < length {
        let p = from.lerp(to, s / length);
        deepest = deepest.max(depth(scalp, skin, p));
        // Within its distance from the skin, a point has none around it.
        s += skin.distance(p).max(least);
    }
    deepest
}
