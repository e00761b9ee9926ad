//! The air about a hair: how far off the skin each of its points is at least, found once, so that what is asked of hair on the skin is
//! asked of nothing that hangs.
//!
//! Guarantees: what is told to be off the skin is; to skip it changes no answer. Not promised: that all that is off is told to be.

use crate::data::skin::Skin;
use crate::maths::drawn_span::DrawnSpan;
use glam::Vec3;
use std::cell::Cell;

/// Points farther off than this (cm) are not told how much farther.
const ENOUGH: f32 = 1.0;
/// What is taken off for rounding, as a share and in cm.
const ROUNDING: (f32, f32) = (1.001, 1e-4);

/// How far off the skin the points of a hair are at least.
pub(super) struct Air<'a> {
    /// To be asked once about each point; none where nothing more is to be known.
    skin: Option<Skin<'a>>,
    off: Vec<Cell<Off>>,
}

#[derive(Clone, Copy)]
struct Off {
    /// cm; 0 where it is not known, and at the root.
    least: f32,
    is_asked: bool,
}

impl<'a> Air<'a> {
    /// The air about a hair of so many points, of which something may be known already (cm).
    pub(super) fn new(skin: &Skin<'a>, points: usize, known: impl Fn(usize) -> f32) -> Self {
        let off = |k: usize| Cell::new(Off { least: known(k), is_asked: k == 0 });
        Self { skin: Some(*skin), off: (0..points).map(off).collect() }
    }

    /// Nothing is known, and nothing asked.
    pub(super) fn unknown() -> Self {
        Self { skin: None, off: vec![] }
    }

    /// Notes that point `k` is elsewhere now.
    pub(super) fn forget(&mut self, k: usize) {
        if let Some(off) = self.off.get_mut(k) {
            off.set(Off { least: 0.0, is_asked: false });
        }
    }

    /// What is known of point `k`, and what the skin says where that is not more than `enough` (cm).
    fn off(&self, points: &[Vec3], k: usize, enough: f32) -> f32 {
        let (Some(skin), Some(cell)) = (&self.skin, self.off.get(k)) else { return 0.0 };
        let Off { mut least, is_asked } = cell.get();
        if least <= enough && !is_asked {
            least = least.max(skin.off_at_least(points[k], ENOUGH));
            cell.set(Off { least, is_asked: true });
        }
        least
    }

    /// Whether point `k` is known to be more than `height` (cm) off the skin.
    pub(super) fn holds(&self, points: &[Vec3], k: usize, height: f32) -> bool {
        self.off(points, k, height.max(0.0)) > height.max(0.0)
    }

    /// Whether the curve that is drawn from point `k` to the next is.
    pub(super) fn holds_span(&self, points: &[Vec3], k: usize, height: f32) -> bool {
        if self.skin.is_none() {
            return false;
        }
        // Told from both ends together, for which it is half of the way at most.
        let half = 0.5 * points[k].distance(points[k + 1]);
        let reach = half + DrawnSpan::of(points, k).leaves_chord(1.0);
        let needed = height + ROUNDING.0 * reach + ROUNDING.1;
        let known = |k: usize| self.off.get(k).map_or(0.0, |off| off.get().least);
        let is_off = |a: f32, b: f32| 0.5 * (a + b) > needed;
        is_off(known(k), known(k + 1))
            || is_off(self.off(points, k, ENOUGH), self.off(points, k + 1, ENOUGH))
    }

    /// Number of the first points beyond which all that is drawn is more than `height` (cm) off the skin.
    pub(super) fn near(&self, points: &[Vec3], height: f32) -> usize {
        let spans = points.len().saturating_sub(1);
        let last = (0..spans).rev().find(|k| !self.holds_span(points, *k, height));
        last.map_or(0, |k| k + 2)
    }
}
