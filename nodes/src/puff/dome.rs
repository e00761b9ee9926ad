//! The skin around a tie, tabulated by bearing and distance over the skin, so that hair can be combed to the tie
//! without querying the surface at every point.
//!
//! Lines of constant bearing run from the tie in planes through the centre of the head: the shortest paths over a
//! nearly round head. Bearing and distance are coordinates of the skin: lines that stay apart in them stay apart on the
//! head.
//!
//! Guarantees: at its own samples, the table lies on the skin (on ears, on their outside); in between, it is less than
//! 0.01 cm below it on a head. Not promised: anything where the skin has no outside as seen from the centre of the
//! head, such as under a chin: the table is extrapolated there.

use super::tie::Tie;
use crate::data::scalp::Scalp;
use crate::error::NodeError;
use crate::eval::EvalCx;
use crate::maths::frame::smallest_rotation;
use crate::maths::hash::KeyBuilder;
use crate::maths::transcendental::{acos, atan2, sin_cos, sin_cos_turns};
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Number of tabulated bearings.
const BEARINGS: usize = 192;
/// Angles from the foot, seen from the centre of the head, at which the skin is sampled.
const ANGLES: usize = 120;
/// The largest of them: beyond, lines of all bearings converge again.
const FARTHEST: f32 = 0.94 * PI;
/// Spacing of samples along a line of constant bearing, cm.
const STEP: f32 = 0.25;
/// Skin farther than this many radii from the centre of the head no longer belongs to it.
const HEAD: f32 = 1.3;

/// Skin around a foot.
#[derive(Debug)]
pub(super) struct Dome {
    origin: Vec3,
    pole: Vec3,
    right: Vec3,
    ahead: Vec3,
    /// Distance over the skin by bearing and angle, cm.
    arcs: Vec<f32>,
    /// Samples along a line of constant bearing.
    along: usize,
    /// Skin and its normal, by bearing and distance.
    skin: Vec<(Vec3, Vec3)>,
}

/// A bearing and a distance over the skin from the foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polar {
    /// Turns, 0 to 1.
    pub(super) bearing: f32,
    /// cm.
    pub(super) distance: f32,
}

impl Dome {
    /// The skin around a tie, computed or cached. Bearings are the tie's azimuths, tilted with its axis.
    pub(super) fn around(cx: &EvalCx, scalp: &Scalp, tie: &Tie) -> Result<Arc<Dome>, NodeError> {
        let key = KeyBuilder::new("dome").key(scalp.key()).vec3(tie.foot.point);
        cx.memo(key.vec3(tie.axis).vec3(tie.right).finish(), || {
            let dome = Dome::new(cx, scalp, tie)?;
            let bytes = dome.arcs.len() * 4 + dome.skin.len() * 24;
            Ok((dome, bytes))
        })
    }

    fn new(cx: &EvalCx, scalp: &Scalp, tie: &Tie) -> Result<Self, NodeError> {
        let (frame, surface, foot) = (scalp.frame(), scalp.surface(), &tie.foot);
        let origin = frame.origin;
        let pole = (foot.point - origin).try_normalize().unwrap_or(foot.normal);
        let leaned = smallest_rotation(tie.axis, pole);
        let (right, ahead) = (leaned * tie.right, leaned * tie.ahead());
        let first = foot.point.distance(origin);
        let reach = (HEAD * frame.radius).max(1.02 * first);
        let radii = cx.map(BEARINGS, |b| {
            let (y, x) = sin_cos_turns(b as f32 / BEARINGS as f32);
            let aside = right * x + ahead * y;
            let mut last = first;
            let radii = (0..ANGLES).map(|k| {
                let (sin, cos) = sin_cos(angle(k));
                let out = pole * cos + aside * sin;
                if k > 0
                    && let Some(hit) = surface.ray(origin + out * reach, -out * reach, 1.0)
                    && surface.face_normal(hit.triangle).dot(out) > 0.0
                {
                    last = hit.point.distance(origin);
                }
                last
            });
            Ok(radii.collect::<Vec<f32>>())
        })?;
        let mut dome = Dome { origin, pole, right, ahead, arcs: vec![], along: 0, skin: vec![] };
        dome.fill(&radii.concat());
        Ok(dome)
    }

    fn fill(&mut self, radii: &[f32]) {
        let at = |b: usize, k: usize| {
            let ((y, x), (sin, cos)) =
                (sin_cos_turns(b as f32 / BEARINGS as f32), sin_cos(angle(k)));
            let out = self.pole * cos + (self.right * x + self.ahead * y) * sin;
            self.origin + out * radii[b * ANGLES + k]
        };
        let points: Vec<Vec3> =
            (0..BEARINGS * ANGLES).map(|i| at(i / ANGLES, i % ANGLES)).collect();
        let mut longest = 0.0f32;
        for row in points.chunks_exact(ANGLES) {
            let mut sum = 0.0;
            for (k, p) in row.iter().enumerate() {
                sum += if k > 0 { p.distance(row[k - 1]) } else { 0.0 };
                self.arcs.push(sum);
            }
            longest = longest.max(sum);
        }
        self.along = (longest / STEP) as usize + 2;
        let mut line = Vec::with_capacity(BEARINGS * self.along);
        for (row, arcs) in points.chunks_exact(ANGLES).zip(self.arcs.chunks_exact(ANGLES)) {
            let mut k = 1;
            for j in 0..self.along {
                let s = j as f32 * STEP;
                while k + 1 < ANGLES && arcs[k] < s {
                    k += 1;
                }
                let span = (arcs[k] - arcs[k - 1]).max(1e-6);
                line.push(row[k - 1].lerp(row[k], ((s - arcs[k - 1]) / span).clamp(0.0, 1.0)));
            }
        }
        let along = self.along;
        let normal = |b: usize, j: usize| {
            let on = |b: usize, j: usize| line[(b % BEARINGS) * along + j];
            let (j0, j1) = (j.saturating_sub(2), (j + 2).min(along - 1));
            // Close to the foot, bearings are too close for a difference: the ring of the third sample is used.
            let wide = j.max(3).min(along - 1);
            let round = on(b + 2, wide) - on(b + BEARINGS - 2, wide);
            let out = (on(b, j) - self.origin).normalize_or(self.pole);
            let away = on(b, j1) - on(b, j0);
            let n = away.cross(round);
            let n = if n.dot(out) < 0.0 { -n } else { n };
            n.try_normalize().unwrap_or(out)
        };
        self.skin =
            (0..BEARINGS * along).map(|i| (line[i], normal(i / along, i % along))).collect();
    }

    /// Coordinates of a point of the skin.
    pub(super) fn polar(&self, p: Vec3) -> Polar {
        let out = (p - self.origin).normalize_or(self.pole);
        let (x, y) = (out.dot(self.right), out.dot(self.ahead));
        let bearing = (atan2(y, x) / TAU).rem_euclid(1.0);
        let at = acos(out.dot(self.pole)) * ((ANGLES - 1) as f32 / FARTHEST);
        let k = (at as usize).min(ANGLES - 2);
        let f = at - k as f32;
        let (b, c, g) = beside(bearing);
        let arc = |b: usize| {
            let row = self.arcs.get(b * ANGLES + k..b * ANGLES + k + 2);
            row.map_or(0.0, |row| row[0] + (row[1] - row[0]) * f)
        };
        Polar { bearing, distance: arc(b) * (1.0 - g) + arc(c) * g }
    }

    /// Skin and normal (nearly unit) at a bearing and distance.
    #[inline]
    pub(super) fn at(&self, place: Polar) -> (Vec3, Vec3) {
        let (b, c, g) = beside(place.bearing);
        let x = (place.distance * (1.0 / STEP)).max(0.0);
        let j = (x as usize).min(self.along.saturating_sub(2));
        let f = (x - j as f32).min(1.0);
        let on = |b: usize| {
            let row = self.skin.get(b * self.along + j..b * self.along + j + 2);
            row.map_or((self.origin, self.pole), |row| {
                (row[0].0.lerp(row[1].0, f), row[0].1.lerp(row[1].1, f))
            })
        };
        let ((p, n), (q, m)) = (on(b), on(c));
        (p.lerp(q, g), n.lerp(m, g))
    }
}

/// The angle of an index.
fn angle(k: usize) -> f32 {
    FARTHEST * k as f32 / (ANGLES - 1) as f32
}

/// The adjacent bearings, and the fraction from the first to the second.
#[inline]
fn beside(bearing: f32) -> (usize, usize, f32) {
    let x = bearing * BEARINGS as f32;
    let b = (x as usize).min(BEARINGS - 1);
    (b, (b + 1) % BEARINGS, x - b as f32)
}
