//! A hair as modifiers read it: how far along itself each point is, which way it runs there, and what lies across.
//!
//! Lengths are those of the straight pieces from point to point, which is what *keep length* keeps.

use crate::maths::frame::{Frame, any_normal, reflect_twice};
use glam::Vec3;

/// One hair. Reusable: [`Hair::read`] keeps its memory.
#[derive(Default)]
pub(crate) struct Hair {
    points: Vec<Vec3>,
    /// From the root to each point, cm.
    come: Vec<f32>,
}

impl Hair {
    /// Makes this the hair through `points`; false, and nothing to work with, where they are no curve: fewer than two, all at one
    /// place, not finite or farther off than lengths can be told.
    pub(crate) fn read(&mut self, points: &[Vec3]) -> bool {
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
    pub(crate) fn points(&self) -> &[Vec3] {
        &self.points
    }
    /// Length, cm.
    pub(crate) fn length(&self) -> f32 {
        self.come.last().copied().unwrap_or(0.0)
    }
    /// How far from the root point `k` is along it, cm.
    pub(crate) fn come(&self, k: usize) -> f32 {
        self.come[k]
    }
    /// The same as a share of its length, 0 to 1.
    pub(crate) fn u(&self, k: usize) -> f32 {
        (self.come[k] / self.length()).min(1.0)
    }
    /// How far apart its points are in the mean, cm.
    pub(crate) fn spacing(&self) -> f32 {
        self.length() / (self.points.len() - 1) as f32
    }
    /// The point at `s` cm from the root; its tip beyond its end.
    pub(crate) fn at(&self, s: f32) -> Vec3 {
        let after = self.come.partition_point(|come| *come <= s);
        let (Some(before), Some(end)) = (after.checked_sub(1), self.come.get(after)) else {
            return self.points[after.saturating_sub(1)];
        };
        let t = (s - self.come[before]) / (end - self.come[before]);
        self.points[before].lerp(self.points[after], t)
    }
    /// Which way it runs at point `k`. Unit.
    pub(crate) fn tangent(&self, k: usize) -> Vec3 {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(self.points.len() - 1));
        let along = self.points[after] - self.points[before];
        // Where points repeat, or it turns back on itself, the nearest way that it has.
        along.try_normalize().unwrap_or_else(|| {
            let pieces = self.points.windows(2).skip(before);
            pieces.map(|w| w[1] - w[0]).find_map(Vec3::try_normalize).unwrap_or(Vec3::Y)
        })
    }
    /// Frames across it, carried from the root without a turn of their own.
    pub(crate) fn frames(&self, frames: &mut Vec<Frame>) {
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
