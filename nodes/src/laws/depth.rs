//! Hair under the skin.
//!
//! A curve is judged as it is drawn: each CV, and each span between two, sampled the denser the more the skin bends there. A span with a
//! deep part counts once, unless one of its ends is too deep itself.

use super::hair::MeasuredHair;
use crate::data::scalp::{Scalp, Skin};
use crate::maths::drawn_span::DrawnSpan;
use glam::Vec3;

/// How deep hair is under the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinDepth {
    /// Number of CVs deeper than their curve allows (with 0.001 cm of tolerance), and of spans between others that are somewhere (with
    /// 0.01 cm).
    pub too_deep: usize,
    /// Number of curves with such.
    pub curves: usize,
    /// Depth of the deepest place of any curve, cm.
    pub deepest_cm: f32,
    /// How much deeper than its curve allows the worst place lies, cm; 0 where none does.
    pub beyond_cm: f32,
    /// That place, cm; none where nothing lies deeper than allowed.
    pub at: Option<[f32; 3]>,
    /// Its curve.
    pub curve: Option<usize>,
}

impl SkinDepth {
    const NONE: Self =
        Self { too_deep: 0, curves: 0, deepest_cm: 0.0, beyond_cm: 0.0, at: None, curve: None };

    fn note(&mut self, depth: f32, beyond: f32, at: Vec3, curve: usize) {
        self.deepest_cm = self.deepest_cm.max(depth);
        if beyond > self.beyond_cm {
            (self.beyond_cm, self.at, self.curve) = (beyond, Some(at.to_array()), Some(curve));
        }
    }

    fn and(self, other: Self) -> Self {
        let worse = if other.beyond_cm > self.beyond_cm { other } else { self };
        Self {
            too_deep: self.too_deep + other.too_deep,
            curves: self.curves + other.curves,
            deepest_cm: self.deepest_cm.max(other.deepest_cm),
            ..worse
        }
    }
}

/// Tolerance of the allowed depth of CVs, cm, and of what is drawn between them.
const ROUNDING: f32 = 1e-3;
const BETWEEN: f32 = 0.01;

/// Measures every curve.
pub fn measure(hair: &MeasuredHair, scalp: &Scalp) -> SkinDepth {
    let skin = scalp.skin();
    let allowed = hair.numbers("allow_depth");
    let is_smooth = hair.is_of_coifs_form();
    let parts = hair.in_parts(hair.len(), 200, |part| {
        let (mut found, mut near) = (SkinDepth::NONE, None);
        for i in part {
            let (first, before_it) = (hair.range(i).start, found.too_deep);
            let points = hair.curve(i);
            let may = |k: usize| allowed.as_ref().map_or(0.0, |a| a.at(i, first + k));
            let mut was_deep = false;
            for (k, p) in points.iter().enumerate() {
                let depth = depth(scalp, &skin, *p);
                let is_deep = depth > may(k) + ROUNDING;
                found.note(depth, depth - may(k), *p, i);
                found.too_deep += usize::from(is_deep);
                let neither = !std::mem::replace(&mut was_deep, is_deep) && !is_deep;
                let Some(before) = k.checked_sub(1) else { continue };
                let span = match is_smooth {
                    true => DrawnSpan::of(points, before),
                    false => DrawnSpan::straight(points[before], *p),
                };
                if let Some(deepest) = skin.deepest(&span, [may(before), may(k)], &mut near) {
                    found.note(-deepest.distance, deepest.excess, deepest.at, i);
                    found.too_deep += usize::from(neither && deepest.excess > BETWEEN);
                }
            }
            found.curves += usize::from(found.too_deep > before_it);
        }
        found
    });
    parts.into_iter().fold(SkinDepth::NONE, SkinDepth::and)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::curves::{Curves, TuftBuilder};
    use crate::data::route::skin_clear::tests::{bust, hairs};
    use crate::eval::PlainHost;

    #[test]
    fn a_curve_that_dives_between_points_that_all_lie_outside_is_too_deep_and_its_place_is_told() {
        let scalp = bust();
        let skin = scalp.skin();
        let is_out = |hair: &Vec<Vec3>| hair.iter().all(|p| skin.distance(*p) > 0.0);
        let coarse = hairs().into_iter().map(|hair| hair.into_iter().step_by(6).collect());
        let mut b = TuftBuilder::new();
        coarse.filter(is_out).for_each(|hair| b.push_curve(&hair));
        let hair = Curves::new(vec![b.build().into()]);
        let hair = MeasuredHair::of(&hair, &PlainHost);
        let found = measure(&hair, &scalp);
        assert!(found.too_deep > 0 && found.curves > 0 && found.beyond_cm > 0.05, "{found:?}");
        let (at, curve) = (Vec3::from(found.at.unwrap()), found.curve.unwrap());
        let hit = scalp.surface().closest(at).unwrap();
        let distance = scalp.surface().signed_distance(at, &hit);
        assert!((distance + found.beyond_cm).abs() < 1e-3, "{found:?}");
        let spans = hair.curve(curve).len() - 1;
        let off = |k: usize| {
            let span = DrawnSpan::of(hair.curve(curve), k);
            (0..=200).map(|n| span.at(n as f32 / 200.0).distance(at)).fold(f32::MAX, f32::min)
        };
        assert!((0..spans).map(off).fold(f32::MAX, f32::min) < 0.02, "{found:?}");
    }
}
