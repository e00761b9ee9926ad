//! Clearance: a lower bound of the distance between each point of a hair and the skin.
//!
//! Most hair hangs well clear of the head, where no query about skin or partings can find anything. The bound is computed once per point,
//! at most, and lets all later steps skip such points and spans.
//!
//! Guarantees: a point or span reported clear is at least as far outside the skin as stated, so skipping it changes no result. Not promised:
//! that every clear point is recognised.

use crate::data::skin::Skin;
use crate::maths::drawn_span::DrawnSpan;
use crate::maths::horizon::View;
use glam::Vec3;
use std::cell::Cell;

/// The search for a bound ends once it exceeds this, cm.
const ENOUGH: f32 = 1.0;
/// Margin for rounding: a factor, and cm.
const ROUNDING: (f32, f32) = (1.001, 1e-4);

/// Lower bounds of the distances of a hair's points from the skin.
pub(super) struct Clearance<'a> {
    /// `None` if nothing is known and the skin is not to be asked.
    skin: Option<Skin<'a>>,
    view: Option<View>,
    points: Vec<Cell<Bound>>,
}

#[derive(Clone, Copy)]
struct Bound {
    /// cm; 0 if unknown.
    least: f32,
    /// Whether the skin was asked.
    is_asked: bool,
}

impl<'a> Clearance<'a> {
    /// For a hair of `points` points; `known` gives a bound that the caller already has, or 0. The root counts as on the skin.
    pub(super) fn new(skin: &Skin<'a>, points: usize, known: impl Fn(usize) -> f32) -> Self {
        let bound = |k: usize| Cell::new(Bound { least: known(k), is_asked: k == 0 });
        Self { skin: Some(*skin), view: None, points: (0..points).map(bound).collect() }
    }

    /// With what the hair sees from its root, which is asked before the skin.
    pub(super) fn seen(self, view: Option<View>) -> Self {
        Self { view, ..self }
    }

    /// Knows nothing, asks nothing.
    pub(super) fn unknown() -> Self {
        Self { skin: None, view: None, points: vec![] }
    }

    /// Discards the bound of point `k`, which has moved.
    pub(super) fn forget(&mut self, k: usize) {
        if let Some(bound) = self.points.get_mut(k) {
            bound.set(Bound { least: 0.0, is_asked: false });
        }
    }

    /// The bound of point `k`; the skin is asked unless the known bound exceeds `enough` (cm).
    fn of(&self, points: &[Vec3], k: usize, enough: f32) -> f32 {
        let (Some(skin), Some(cell)) = (&self.skin, self.points.get(k)) else { return 0.0 };
        let Bound { mut least, is_asked } = cell.get();
        if least > enough || is_asked {
            return least;
        }
        least = least.max(self.seen_off(points[k]));
        let is_asked = least <= enough;
        if is_asked {
            least = least.max(skin.off_at_least(points[k], ENOUGH));
        }
        cell.set(Bound { least, is_asked });
        least
    }

    /// The bound that the view from the root gives.
    fn seen_off(&self, p: Vec3) -> f32 {
        self.view.as_ref().map_or(0.0, |view| view.off_at_least(p))
    }

    /// Whether point `k` is known to be more than `height` (cm) outside the skin.
    pub(super) fn of_point(&self, points: &[Vec3], k: usize, height: f32) -> bool {
        self.of(points, k, height.max(0.0)) > height.max(0.0)
    }

    /// Whether the curve drawn from point `k` to the next is.
    pub(super) fn of_span(&self, points: &[Vec3], k: usize, height: f32) -> bool {
        if self.skin.is_none() {
            return false;
        }
        // A point on the chord is at most half of it away from the nearer end, so both bounds together count.
        let span = DrawnSpan::of(points, k);
        let half = 0.5 * points[k].distance(points[k + 1]);
        let reach = half + span.leaves_chord(1.0);
        let needed = height + ROUNDING.0 * reach + ROUNDING.1;
        let known = |k: usize| self.points.get(k).map_or(0.0, |bound| bound.get().least);
        let is_clear = |a: f32, b: f32| 0.5 * (a + b) > needed;
        is_clear(known(k), known(k + 1))
            || (height <= 0.0 && self.view.as_ref().is_some_and(|view| view.clears(&span)))
            || is_clear(self.of(points, k, ENOUGH), self.of(points, k + 1, ENOUGH))
    }

    /// Number of leading points beyond which every span is more than `height` (cm) outside the skin.
    pub(super) fn near(&self, points: &[Vec3], height: f32) -> usize {
        let spans = points.len().saturating_sub(1);
        let last = (0..spans).rev().find(|k| !self.of_span(points, *k, height));
        last.map_or(0, |k| k + 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::route::skin_clear::tests::{bust, hairs};
    use crate::data::scalp::Scalp;
    use crate::formats::conform::tests::parted_ball;
    use crate::maths::hash::Dice;

    /// Hairs rooted all over a head that wander in and over it.
    fn wandering(scalp: &Scalp, n: u64) -> Vec<Vec<Vec3>> {
        let dice = Dice::new(11, 0, "wandering");
        let hair = |i: u64| {
            let axis =
                |k: u64, by: f32| Vec3::from([0, 1, 2].map(|a| dice.signed(i, 3 * k + a) * by));
            let mut p = scalp.closest_root(axis(0, 12.0) + Vec3::Y * 4.0)?.point;
            let (way, by) = (axis(1, 0.5), 0.6 * dice.unit(i, 999));
            let mut hair = vec![p];
            for k in 2..20 {
                p += way + axis(k, by);
                hair.push(p);
            }
            Some(hair)
        };
        (0..n).filter_map(hair).collect()
    }

    #[test]
    fn what_is_reported_clear_is_as_far_outside_as_stated() {
        let scalp = bust();
        let skin = scalp.skin();
        let (mut points, mut spans, mut views) = (0, 0, 0);
        for hair in hairs().into_iter().step_by(5).chain(wandering(&scalp, 400)) {
            for height in [0.0, 0.25, 0.7] {
                let root = scalp.closest_root(hair[0]).unwrap();
                let view = skin.view_from(hair[0], root.triangle as i32);
                views += usize::from(view.is_some());
                let clearance = Clearance::new(&skin, hair.len(), |_| 0.0).seen(view);
                let far = |p: Vec3| match skin.distance(p) > 0.0 {
                    true => skin.closest(p).map_or(f32::MAX, |hit| hit.distance),
                    false => 0.0,
                };
                let near = clearance.near(&hair, height);
                for k in 0..hair.len() - 1 {
                    if clearance.of_point(&hair, k, height) {
                        assert!(far(hair[k]) > height - 1e-4, "{k} of {hair:?}");
                        points += 1;
                    }
                    let is_clear = clearance.of_span(&hair, k, height);
                    assert!(is_clear || k + 2 <= near, "{k} of {hair:?}, {near}");
                    if is_clear {
                        let span = DrawnSpan::of(&hair, k);
                        let least = (0..=20).map(|n| far(span.at(n as f32 / 20.0)));
                        assert!(least.fold(f32::MAX, f32::min) > height - 1e-4, "{k} of {hair:?}");
                        spans += 1;
                    }
                }
            }
        }
        assert!(points > 5000 && spans > 5000 && views > 500, "{points} {spans} {views}");
    }

    #[test]
    fn no_hair_leads_over_a_parting_that_was_ruled_out_at_a_glance() {
        let [ball] = parted_ball();
        let skin = ball.skin();
        let (mut over, mut glances, mut shorter) = (0, 0, 0);
        for hair in wandering(&ball, 4000) {
            let Some(home) = ball.home(hair[0]) else { continue };
            let passes = home.passes(&hair);
            let clearance = Clearance::new(&skin, hair.len(), |_| 0.0);
            let near = clearance.near(&hair, home.over_lines());
            assert_eq!(home.passes_before(&hair, near), passes, "{near} of {hair:?}");
            let is_off = home.is_off_lines(&hair[..hair.len().min(near + 1)]);
            assert!(!(is_off && passes), "{hair:?}");
            over += usize::from(passes);
            glances += usize::from(is_off);
            shorter += usize::from(near < hair.len());
        }
        assert!(over > 50 && glances > 500 && shorter > 500, "{over} {glances} {shorter}");
    }
}
