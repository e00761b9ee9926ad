//! Growing a guide over the skin, step by step.
//!
//! Guarantees: no point lies below the skin; on a parted scalp what lies on the skin runs along a parting and not across it, and the
//! guide ends at a corner with no way out; points are evenly spaced. Not promised: the length asked for, beside a corner.

use crate::data::attributes::{Domain, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL, SECTION};
use crate::data::curves::TuftBuilder;
use crate::data::route::makers::{lift, lift_each};
use crate::data::scalp::{Root, Scalp, Skin};
use crate::maths::spline::Spline;
use glam::Vec3;

/// Least height of guides above the skin, cm.
pub(super) const CLEARANCE: f32 = 0.02;
/// Growth steps between two points of a guide.
const SUBSTEPS: usize = 3;

/// Binds a tuft of one guide to its root.
pub(super) fn bind(b: &mut TuftBuilder, root: &Root, scalp: &Scalp) {
    b.set(SCALP_NORMAL, Domain::Curve, vec![root.normal]);
    b.set(ROOT_TRIANGLE, Domain::Curve, vec![root.triangle as i32]);
    b.set(ROOT_BARY, Domain::Curve, vec![root.bary]);
    if scalp.uvs().is_some() {
        b.set(ROOT_UV, Domain::Curve, vec![root.uv]);
    }
    if let Some(section) = scalp.sections().and_then(|s| s.id_of(root)) {
        b.set(SECTION, Domain::Curve, vec![section]);
    }
}

/// Grows guides on a head.
pub(super) struct Grower<'a> {
    pub scalp: &'a Scalp,
    pub skin: Skin<'a>,
    /// Points per guide, at least 2.
    pub points: usize,
}

/// Where a guide is after a step.
pub(super) struct Step {
    /// Fraction of the guide's steps that are done.
    pub u: f32,
    pub point: Vec3,
    /// The way that it came. Unit.
    pub direction: Vec3,
    /// Distance from the skin, cm, the normal there, and the normal of the step before.
    pub distance: f32,
    pub normal: Vec3,
    pub normal_before: Vec3,
}

impl Grower<'_> {
    /// Number of steps of a guide.
    pub(super) fn steps(&self) -> usize {
        (self.points - 1) * SUBSTEPS
    }

    /// A guide of this length (cm) that begins in a direction and goes on as `turn` says, at least `height` (cm) above the skin at each
    /// fraction of its steps.
    pub(super) fn grow(
        &self,
        root: &Root,
        length: f32,
        mut direction: Vec3,
        height: impl Fn(f32) -> f32,
        mut turn: impl FnMut(&Step) -> Vec3,
    ) -> Vec<Vec3> {
        let steps = self.steps();
        let step = length / steps as f32;
        let (mut p, mut normal) = (root.point, root.normal);
        let mut grown = vec![p];
        let mut below = root.triangle;
        let home = self.scalp.home_of(root);
        for k in 1..=steps {
            let u = k as f32 / steps as f32;
            let height = height(u);
            let next = p + direction * step;
            let (lifted, moved) = lift(&self.skin, next, height);
            // A step that was put back on the skin keeps its length along it.
            let mut to = lifted;
            if moved && let Some(along) = (lifted - p).try_normalize() {
                to = lift(&self.skin, p + along * step, height).0;
            }
            // A guide on the skin runs along a parting, not across it.
            if let Some(home) = home {
                to = home.keep(to, &mut below, |kept| lift(&self.skin, kept, height).0);
            }
            // At a corner with no way out, it ends.
            if grown.len() > 1 && home.is_some_and(|home| home.passes(&[p, to])) {
                break;
            }
            direction = (to - p).try_normalize().unwrap_or(direction);
            p = to;
            grown.push(p);
            // The skin below is near that of the previous step: far from the skin, this saves most of the search.
            let surface = self.scalp.surface();
            let Some(hit) = surface.closest_from(p, below) else { continue };
            below = hit.triangle;
            let skin_normal = surface.smooth_normal(hit.triangle, hit.bary);
            let (distance, normal_before) = (hit.distance, normal);
            normal = skin_normal;
            let at = Step { u, point: p, direction, distance, normal, normal_before };
            direction = turn(&at);
        }
        let mut out = self.even(&grown);
        // Around a corner of its section the curve may swing wider than the steps did: it ends before.
        while grown.len() > SUBSTEPS && home.is_some_and(|home| home.passes(&out)) {
            grown.truncate(grown.len() * 3 / 4);
            out = self.even(&grown);
        }
        out
    }

    /// The steps of a guide as evenly spaced points, out of the skin.
    fn even(&self, grown: &[Vec3]) -> Vec<Vec3> {
        let mut out = Vec::with_capacity(self.points);
        match Spline::new(grown) {
            Ok(spline) => spline.resample(self.points, |p| out.push(p)),
            Err(_) => out = grown.to_vec(),
        }
        // The spline may cut a corner of the skin that the steps avoided.
        out[0] = grown[0];
        let whole = 1..out.len();
        lift_each(&self.skin, &mut out, whole, |_| 0.5 * CLEARANCE);
        out
    }
}
