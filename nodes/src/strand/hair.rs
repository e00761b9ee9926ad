//! A hair as modifiers read it: how far along itself each point is, which way it runs there, and what lies across.
//!
//! Lengths are those of the straight pieces from point to point, which is what *keep length* keeps.

use crate::data::curves::{Curves, Tuft};
use crate::eval::EvalCx;
use crate::maths::frame::{Frame, any_normal, reflect_twice};
use glam::Vec3;

/// One hair. Reusable: [`Hair::read`] keeps its memory.
#[derive(Default)]
pub(super) struct Hair {
    points: Vec<Vec3>,
    /// From the root to each point, cm.
    come: Vec<f32>,
}

impl Hair {
    /// Makes this the hair through `points`; false, and nothing to work with, where they are no curve: fewer than two, all at one
    /// place, not finite or farther off than lengths can be told.
    pub(super) fn read(&mut self, points: &[Vec3]) -> bool {
        self.points.clear();
        self.come.clear();
        let mut come = 0.0;
        for (k, p) in points.iter().enumerate() {
            come += if k > 0 { p.distance(points[k - 1]) } else { 0.0 };
            self.points.push(*p);
            self.come.push(come);
        }
        points.len() >= 2 && come > 0.0 && come.is_finite()
    }
    /// Its points, root first.
    pub(super) fn points(&self) -> &[Vec3] {
        &self.points
    }
    /// Length, cm.
    pub(super) fn length(&self) -> f32 {
        self.come.last().copied().unwrap_or(0.0)
    }
    /// How far from the root point `k` is along it, cm.
    pub(super) fn come(&self, k: usize) -> f32 {
        self.come[k]
    }
    /// The same as a share of its length, 0 to 1.
    pub(super) fn u(&self, k: usize) -> f32 {
        (self.come[k] / self.length()).min(1.0)
    }
    /// How far apart its points are in the mean, cm.
    pub(super) fn spacing(&self) -> f32 {
        self.length() / (self.points.len() - 1) as f32
    }
    /// The point at `s` cm from the root; its tip beyond its end.
    pub(super) fn at(&self, s: f32) -> Vec3 {
        let after = self.come.partition_point(|come| *come <= s);
        let (Some(before), Some(end)) = (after.checked_sub(1), self.come.get(after)) else {
            return self.points[after.saturating_sub(1)];
        };
        let t = (s - self.come[before]) / (end - self.come[before]);
        self.points[before].lerp(self.points[after], t)
    }
    /// Which way it runs at point `k`. Unit.
    pub(super) fn tangent(&self, k: usize) -> Vec3 {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(self.points.len() - 1));
        let along = self.points[after] - self.points[before];
        // Where points repeat, or it turns back on itself, the nearest way that it has.
        along.try_normalize().unwrap_or_else(|| {
            let pieces = self.points.windows(2).skip(before);
            pieces.map(|w| w[1] - w[0]).find_map(Vec3::try_normalize).unwrap_or(Vec3::Y)
        })
    }
    /// Frames across it, carried from the root without a turn of their own.
    pub(super) fn frames(&self, frames: &mut Vec<Frame>) {
        frames.clear();
        for (k, p) in self.points.iter().enumerate() {
            let tangent = self.tangent(k);
            let normal = match frames.last() {
                Some(last) => {
                    reflect_twice(last.normal, *p - self.points[k - 1], last.tangent, tangent)
                }
                None => any_normal(tangent),
            };
            frames.push(Frame { tangent, normal });
        }
    }
}

/// Remarks how many hairs have points farther apart than `step` (cm), which `what` is, so that what is finer does not show.
pub(super) fn remark_coarse(cx: &EvalCx, curves: &Curves, step: f32, what: &str) {
    let mut hair = Hair::default();
    let coarse = |(tuft, i): &(&Tuft, usize)| hair.read(tuft.curve(*i)) && hair.spacing() > step;
    let coarse = curves.each().filter(coarse).count();
    if coarse > 0 {
        let all = curves.curve_count();
        cx.remark(format!(
            "{coarse} of {all} hairs have points farther apart than {what} ({step:.2} cm), and show nothing finer: Resample them before"
        ));
    }
}
