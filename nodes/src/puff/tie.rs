//! Ties: where hair is held together, and how nodes pass them to each other.
//!
//! A tie travels as a curve of two points, from its foot on the scalp to its top, with its radius and the direction of
//! azimuth 0. A curve that has no length or is not finite is not a tie and is dropped.

use crate::data::attributes::{
    Domain, ID, NORMAL, RADIUS, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::scalp::{Root, Scalp};
use crate::eval::EvalCx;
use crate::maths::frame::{across, any_normal};
use glam::{Vec2, Vec3};

/// One tie, in cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tie {
    /// Value of [`crate::data::attributes::PUFF`] of the hair it holds.
    pub id: u64,
    /// The scalp under it.
    pub foot: Root,
    /// Direction from the foot to the top. Unit.
    pub axis: Vec3,
    /// Azimuth 0, across the axis. Unit.
    pub right: Vec3,
    /// From the foot to where hair is free again.
    pub height: f32,
    /// Radius of the hair in it.
    pub radius: f32,
}

impl Tie {
    /// A tie whose azimuth starts at the right of an observer who looks from the top along `forward`.
    pub(super) fn new(
        id: u64,
        foot: Root,
        axis: Vec3,
        forward: Vec3,
        height: f32,
        radius: f32,
    ) -> Self {
        let ahead = across(forward, axis).unwrap_or_else(|| any_normal(axis));
        Self { id, foot, axis, right: ahead.cross(axis), height, radius }
    }
    /// Direction of azimuth a quarter turn. Unit.
    pub(super) fn ahead(&self) -> Vec3 {
        self.axis.cross(self.right)
    }
    /// The centre of the ring where hair leaves the tie.
    pub(super) fn top(&self) -> Vec3 {
        self.foot.point + self.axis * self.height
    }
    /// Position of a point across the tie, in radii: length 1 is the ring.
    pub(super) fn place(&self, p: Vec3) -> Vec2 {
        let d = (p - self.foot.point) / self.radius.max(1e-6);
        Vec2::new(d.dot(self.right), d.dot(self.ahead()))
    }
    /// The tie as a curve.
    pub(super) fn curve(&self) -> Tuft {
        let mut b = TuftBuilder::new();
        b.push_curve(&[self.foot.point, self.top()]);
        b.set(ID, Domain::Curve, vec![self.id]);
        b.set(RADIUS, Domain::Curve, vec![self.radius]);
        b.set(NORMAL, Domain::Curve, vec![self.right]);
        b.set(SCALP_NORMAL, Domain::Curve, vec![self.foot.normal]);
        b.set(ROOT_TRIANGLE, Domain::Curve, vec![self.foot.triangle as i32]);
        b.set(ROOT_BARY, Domain::Curve, vec![self.foot.bary]);
        b.set(ROOT_UV, Domain::Curve, vec![self.foot.uv]);
        b.build()
    }
    /// The ties that these curves describe; invalid ones are reported once.
    pub(super) fn all(cx: &EvalCx, scalp: &Scalp, curves: &Curves) -> Vec<Tie> {
        let mut out = vec![];
        for (tuft, i) in curves.each() {
            let at = tuft.range(i).start;
            let read = || {
                let (first, last) = (*tuft.curve(i).first()?, *tuft.curve(i).last()?);
                let axis = (last - first).try_normalize()?;
                let foot = scalp.closest_root(first)?;
                let right = tuft.view(NORMAL).at(i, at);
                let right = across(right, axis).unwrap_or_else(|| any_normal(axis));
                let radius = tuft.view(RADIUS).at(i, at);
                let height = (last - foot.point).dot(axis);
                (radius > 0.0 && height > 0.0 && right.is_finite() && radius.is_finite())
                    .then_some(Tie { id: tuft.id(i), foot, axis, right, height, radius })
            };
            match read() {
                Some(tie) => out.push(tie),
                None => cx.trouble(tuft.id(i), "a curve that is no tie was left out"),
            }
        }
        out
    }
}
