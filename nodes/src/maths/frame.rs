//! Frames along a curve: tangent, normal and binormal that do not twist by themselves.
//!
//! methods.md 1. The default is the rotation-minimising frame by double reflection (Wang, Jüttler,
//! Zheng, Liu 2008, "Computation of rotation minimizing frames"), walked in steps of at most
//! 10 degrees of turn. A wanted direction (an axis, the scalp's normal) pulls the normal towards
//! itself, at most 20 degrees a step. What turns back by more than 135 degrees in one place is folded over about the binormal
//! (methods.md has the normal as axis past 170): braids keep their strands on their sides.
//!
//! Guarantees: orthonormal to 1e-5; the normal of each step keeps `dot > 0.999` with the last one carried by the
//! smallest rotation where nothing is wanted; corners and repeated points never make NaN.

use super::closest::Surface;
use super::smoothstep;
use super::spline::Spline;
use super::transcendental::{atan2, sin_cos};
use glam::{Mat3, Vec3};

/// A right-handed frame across a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Along the curve, root to tip. Unit.
    pub tangent: Vec3,
    /// Across the curve, "up" of what is laid along it. Unit.
    pub normal: Vec3,
}

impl Frame {
    /// The third axis, tangent x normal. Unit.
    pub fn binormal(&self) -> Vec3 {
        self.tangent.cross(self.normal)
    }
    /// The frame turned about its tangent by an angle in radians, from normal towards binormal.
    pub fn rolled(&self, radians: f32) -> Self {
        let (sin, cos) = sin_cos(radians);
        Self { tangent: self.tangent, normal: self.normal * cos + self.binormal() * sin }
    }
    /// A vector of the cross-section: `x` along the binormal, `y` along the normal.
    pub fn across(&self, x: f32, y: f32) -> Vec3 {
        self.binormal() * x + self.normal * y
    }
}

/// The 26 directions to the neighbours of a place in a lattice.
pub fn round_about() -> impl Iterator<Item = Vec3> {
    let steps = |k: i32| Vec3::from_array([k % 3, k / 3 % 3, k / 9].map(|step| step as f32 - 1.0));
    (0..27).filter_map(move |k| steps(k).try_normalize())
}

/// Any unit vector across `tangent`: the part of +Y across it, or of +Z where the curve runs along Y.
pub fn any_normal(tangent: Vec3) -> Vec3 {
    let up = if tangent.y.abs() < 0.9 { Vec3::Y } else { Vec3::Z };
    (up - tangent * up.dot(tangent)).try_normalize().unwrap_or(Vec3::X)
}

/// The part of `v` across the unit vector `tangent`, as a unit vector.
pub fn across(v: Vec3, tangent: Vec3) -> Option<Vec3> {
    let part = v - tangent * v.dot(tangent);
    (part.length_squared() > 1e-12 * v.length_squared()).then(|| part.normalize_or(Vec3::ZERO))
}

/// cos 135 degrees.
const TURNED_BACK: f32 = -std::f32::consts::FRAC_1_SQRT_2;

/// Carries `normal` by the smallest rotation that takes the unit tangent `from` to `to`. Past 135 degrees, where the
/// axis of that rotation comes to be any, what lies along the curve is folded over as a ribbon is: its sides
/// stay where they are, and its front faces the other way.
pub fn carry(normal: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let cos = from.dot(to);
    if cos < TURNED_BACK {
        let side = across(from.cross(normal), to).unwrap_or_else(|| any_normal(to));
        return side.cross(to);
    }
    let axis = from.cross(to);
    let carried = normal * cos + axis.cross(normal) + axis * (axis.dot(normal) / (1.0 + cos));
    across(carried, to).unwrap_or_else(|| any_normal(to))
}

/// The smallest rotation that takes one unit vector to another. Between opposite ones, where there are many, it is
/// that of [`carry`].
#[inline]
pub fn smallest_rotation(from: Vec3, to: Vec3) -> Mat3 {
    let cos = from.dot(to);
    if cos < -0.98 {
        let normal = any_normal(from);
        let carried = carry(normal, from, to);
        let before = Mat3::from_cols(from, normal, from.cross(normal));
        return Mat3::from_cols(to, carried, to.cross(carried)) * before.transpose();
    }
    let v = from.cross(to);
    let w = v * (1.0 / (1.0 + cos));
    Mat3::from_cols(
        Vec3::new(cos + w.x * v.x, w.x * v.y + v.z, w.x * v.z - v.y),
        Vec3::new(w.y * v.x - v.z, cos + w.y * v.y, w.y * v.z + v.x),
        Vec3::new(w.z * v.x + v.y, w.z * v.y - v.x, cos + w.z * v.z),
    )
}

/// One step of the double reflection method: `normal` at `from`, carried along `step` to the unit tangent `to`. A step
/// without length falls back on [`carry`].
pub fn reflect_twice(normal: Vec3, step: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let c1 = step.length_squared();
    if c1 <= 1e-20 {
        return carry(normal, from, to);
    }
    let mirrored = |v: Vec3| v - step * (2.0 / c1 * step.dot(v));
    let (n, t) = (mirrored(normal), mirrored(from));
    let second = to - t;
    let c2 = second.length_squared();
    if c2 <= 1e-12 {
        return carry(normal, from, to);
    }
    let reflected = n - second * (2.0 / c2 * second.dot(n));
    across(reflected, to).unwrap_or_else(|| any_normal(to))
}

/// A direction that the normal should turn to, and how strongly (0 to 1).
pub type NormalTarget = Option<(Vec3, f32)>;

/// The most a wished direction turns the normal in one step.
const RELAX_STEP: f32 = 20.0 / 180.0 * std::f32::consts::PI;
/// cos 10 degrees: the most the tangent may turn in one step.
pub const STEP_COS: f32 = 0.984_807_8;

/// Frames at the fractions `us` of the spline's arc length (not decreasing, within [0, 1]), carried from the root.
///
/// `start` is the wanted normal at the root ([`any_normal`] without one). `wish` is asked at every
/// step, with the fraction, the point and the tangent; it never changes a frame by more than 20 degrees
/// a step, and counts with the squared sine of its angle to the tangent, so that a direction along the curve asks
/// nothing. Where the curve turns back on itself the normal folds over as in [`carry`], unless a wish asks it to stay.
pub fn frames(
    spline: &Spline,
    us: &[f32],
    start: Option<Vec3>,
    mut wish: impl FnMut(f32, Vec3, Vec3) -> NormalTarget,
) -> Vec<Frame> {
    let first = spline.locate(0.0);
    let (mut u, mut point, mut tangent) = (0.0, spline.point(first), spline.tangent(first));
    let first_wish = wish(0.0, point, tangent).map(|(direction, _)| direction);
    let mut normal = first_wish
        .and_then(|direction| across(direction, tangent))
        .or_else(|| start.and_then(|direction| across(direction, tangent)))
        .unwrap_or_else(|| any_normal(tangent));
    // An eighth of a span cannot hide a turn; what turns within a 64th of that is a corner, crossed by
    // one smallest rotation.
    let longest = 1.0 / (8 * spline.span_count()) as f32;
    let shortest = longest / 64.0;
    let mut out = Vec::with_capacity(us.len());
    for &target in us {
        while u < target {
            let mut step = (target - u).min(longest);
            let (mut next_point, mut next_tangent);
            loop {
                let place = spline.locate(u + step);
                next_point = spline.point(place);
                next_tangent = spline.tangent(place);
                if tangent.dot(next_tangent) >= STEP_COS || step < shortest {
                    break;
                }
                step *= 0.5;
            }
            normal = if tangent.dot(next_tangent) >= STEP_COS {
                reflect_twice(normal, next_point - point, tangent, next_tangent)
            } else {
                carry(normal, tangent, next_tangent)
            };
            let turned_back = tangent.dot(next_tangent) < TURNED_BACK;
            // `u + step` may round to `u` when the step is tiny: the target is then reached.
            u = if u + step > u { u + step } else { target };
            (point, tangent) = (next_point, next_tangent);
            if let Some((direction, strength)) = wish(u, point, tangent) {
                if turned_back && direction.dot(normal) < 0.0 {
                    normal = -normal;
                }
                normal = relaxed(normal, tangent, direction, strength);
            }
        }
        out.push(Frame { tangent, normal });
    }
    out
}

fn relaxed(normal: Vec3, tangent: Vec3, wanted: Vec3, strength: f32) -> Vec3 {
    let Some(wanted) = wanted.try_normalize() else { return normal };
    let along = wanted.dot(tangent);
    let weight = (1.0 - along * along) * strength.clamp(0.0, 1.0);
    let Some(target) = across(wanted, tangent) else { return normal };
    let angle = atan2(tangent.dot(normal.cross(target)), normal.dot(target)) * weight;
    let turned = Frame { tangent, normal }.rolled(angle.clamp(-RELAX_STEP, RELAX_STEP)).normal;
    across(turned, tangent).unwrap_or(normal)
}

/// The skin under a curve: what `Scalp` frames turn to (methods.md 1), tabulated along the curve.
///
/// The wanted direction is the mean of the smooth normals at the closest points of the skin, under the curve and to both sides
/// of it, then along it: what lies there is as broad as `fade` to either side, and folds of the skin finer than that do not
/// turn it. It counts in full where the curve is no farther from the skin than `fade`, and not at all from twice that on, where closest points jump.
#[derive(Clone, Debug)]
pub struct SkinUnder {
    us: Vec<f32>,
    normals: Vec<Vec3>,
    strengths: Vec<f32>,
}

impl SkinUnder {
    /// The skin at the fractions `us` of the spline's length (at least one, rising).
    pub fn new(surface: &Surface, spline: &Spline, us: Vec<f32>, fade: f32) -> Self {
        let mut under = Self { us, normals: vec![], strengths: vec![] };
        // Past the fade the normal is still told for a while, for those who only ask which way is out.
        let reach = 4.0 * fade;
        for u in &under.us {
            let p = spline.at(*u);
            let hit = surface.closest_within(p, reach);
            let last = under.normals.last().copied().unwrap_or(Vec3::ZERO);
            under.normals.push(hit.map_or(last, |h| {
                let here = surface.smooth_normal(h.triangle, h.bary);
                let tangent = spline.tangent_at(*u);
                let across = across(here, tangent).map_or(Vec3::ZERO, |up| tangent.cross(up));
                let beside = [-1.0, -0.5, 0.5, 1.0].iter().filter_map(|share| {
                    let hit = surface.closest_within(p + across * (fade * share), reach)?;
                    Some(surface.smooth_normal(hit.triangle, hit.bary))
                });
                beside.fold(here, |sum, normal| sum + normal).try_normalize().unwrap_or(here)
            }));
            under
                .strengths
                .push(hit.map_or(0.0, |h| smoothstep(2.0 - h.distance / fade.max(1e-6))));
        }
        // Along the curve what lies nearer counts more.
        let near = fade / spline.length().max(1e-6);
        let mean = |k: usize| {
            let u = under.us[k];
            let from = under.us.partition_point(|known| *known < u - near);
            let to = under.us.partition_point(|known| *known <= u + near);
            let weigh = |j: usize| 1.0 - (under.us[j] - u).abs() / near.max(1e-9);
            let sum: Vec3 = (from..to).map(|j| under.normals[j] * weigh(j).max(0.0)).sum();
            sum.try_normalize().unwrap_or(under.normals[k])
        };
        under.normals = (0..under.us.len()).map(mean).collect();
        under
    }
    /// The direction away from the skin at the fraction `u`, unit (zero: no skin anywhere near), and how much it counts.
    pub fn at(&self, u: f32) -> (Vec3, f32) {
        let after = self.us.partition_point(|known| *known <= u).clamp(1, self.us.len().max(2) - 1);
        if self.us.len() < 2 {
            return (self.normals[0], self.strengths[0]);
        }
        let (u0, u1) = (self.us[after - 1], self.us[after]);
        let t = if u1 > u0 { ((u - u0) / (u1 - u0)).clamp(0.0, 1.0) } else { 0.0 };
        let normal = self.normals[after - 1].lerp(self.normals[after], t);
        let strength = self.strengths[after - 1] * (1.0 - t) + self.strengths[after] * t;
        (normal.normalize_or_zero(), strength)
    }
    /// What the normal should turn to there, for [`frames`].
    pub fn normal_target(&self, u: f32) -> NormalTarget {
        let (normal, strength) = self.at(u);
        (normal != Vec3::ZERO && strength > 0.0).then_some((normal, strength))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    fn walk(points: &[Vec3], n: usize) -> (Spline, Vec<Frame>) {
        let spline = Spline::new(points).unwrap();
        let us: Vec<f32> = (0..n).map(|k| k as f32 / (n - 1) as f32).collect();
        let frames = frames(&spline, &us, None, |_, _, _| None);
        (spline, frames)
    }

    #[track_caller]
    fn check_law(points: &[Vec3]) {
        let (_, frames) = walk(points, 4000);
        for (k, pair) in frames.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]];
            let carried = carry(a.normal, a.tangent, b.tangent);
            if a.tangent.dot(b.tangent) > STEP_COS {
                assert!(b.normal.dot(carried) > 0.999, "step {k}: {}", b.normal.dot(carried));
            }
            if a.tangent.dot(b.tangent) > 0.0 {
                assert!(a.normal.dot(b.normal) > 0.0, "step {k} flips");
            }
            assert!(b.normal.dot(b.tangent).abs() < 1e-5 && (b.normal.length() - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn no_curve_twists_its_frame() {
        check_law(&[Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0]);
        check_law(&[Vec3::ZERO, Vec3::X, Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 0.0)]);
        check_law(&[Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1e-6, 0.0), Vec3::ZERO]);
        let dice = Dice::new(7, 0, "walk");
        for id in 0..200 {
            let n = 3 + dice.below(id, 0, 20) as u64;
            let mut p = Vec3::ZERO;
            let points: Vec<Vec3> = (0..n)
                .map(|k| {
                    let axis = |a| dice.signed(id, 10 + 3 * k + a);
                    p += Vec3::new(axis(0), axis(1), axis(2));
                    p
                })
                .collect();
            check_law(&points);
        }
    }

    #[test]
    fn what_turns_back_on_itself_is_folded_over_like_a_ribbon() {
        // There and back, exactly and a little to the front and the back of the ribbon.
        for to in [[0.0, 0.0, 0.0], [0.0, 0.0, 0.4], [0.0, 0.0, -0.4]] {
            let (_, frames) = walk(&[Vec3::ZERO, Vec3::Y * 4.0, Vec3::from(to)], 2001);
            let (before, after) = (frames[100], frames[1900]);
            assert!(before.binormal().dot(after.binormal()) > 0.9, "{to:?}: the sides change");
            assert!(before.normal.dot(after.normal) < -0.9, "{to:?}: the front does not");
        }
        // Where a side is asked for, it stays outside.
        let spline = Spline::new(&[Vec3::ZERO, Vec3::Y * 4.0, Vec3::ZERO]).unwrap();
        let asked = frames(&spline, &[0.0, 1.0], None, |_, _, _| Some((Vec3::Z, 1.0)));
        assert!(asked.iter().all(|frame| frame.normal.z > 0.99), "{asked:?}");
    }

    #[test]
    fn the_smallest_rotation_takes_one_direction_to_the_other_and_leaves_its_axis() {
        let dice = Dice::new(7, 0, "turn");
        for id in 0..500 {
            let v = |i: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(id, 3 * i + a))).normalize();
            let (from, mut to) = (v(0), v(1));
            match id % 5 {
                0 => to = -from,
                1 => to = (v(1) * 1e-2 - from).normalize(),
                2 => to = from,
                _ => {}
            }
            let m = smallest_rotation(from, to);
            assert!((m * from).distance(to) < 1e-5, "{from} {to}");
            assert!((m.determinant() - 1.0).abs() < 1e-4);
            if from.dot(to) > -0.98
                && let Some(axis) = from.cross(to).try_normalize()
                && id % 5 > 2
            {
                assert!((m * axis).distance(axis) < 1e-4, "{from} {to}");
            }
        }
    }

    #[test]
    fn a_plane_curve_keeps_its_normal_to_the_plane() {
        let points: Vec<Vec3> = (0..20)
            .map(|k| {
                let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 25.0);
                Vec3::new(c, 0.0, s) * 5.0
            })
            .collect();
        for frame in walk(&points, 100).1 {
            assert!(frame.normal.distance(Vec3::Y) < 1e-4, "{frame:?}");
        }
    }

    #[test]
    fn a_wished_direction_is_reached_without_a_jump() {
        let spline = Spline::new(&[Vec3::ZERO, Vec3::X * 10.0]).unwrap();
        let us: Vec<f32> = (0..200).map(|k| k as f32 / 199.0).collect();
        let wish = |u: f32, _: Vec3, _: Vec3| Some((if u < 0.5 { Vec3::Y } else { Vec3::Z }, 1.0));
        let frames = frames(&spline, &us, None, wish);
        assert!(frames[0].normal.distance(Vec3::Y) < 1e-6);
        assert!(frames[199].normal.distance(Vec3::Z) < 1e-4);
        for pair in frames.windows(2) {
            assert!(pair[0].normal.dot(pair[1].normal) > 0.9);
        }
    }

    #[test]
    fn scalp_frames_stand_on_the_skin_and_are_carried_off_it() {
        let surface = crate::maths::closest::tests::sphere(8.9, 48);
        // Over the ball from the front, then straight off it into the air.
        let mut points: Vec<Vec3> = (0..10)
            .map(|k| {
                let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 36.0);
                Vec3::new(0.0, s, c) * 8.9
            })
            .collect();
        points.extend((1..10).map(|k| Vec3::new(0.3 * k as f32, 9.0, -2.0 * k as f32)));
        let spline = Spline::new(&points).unwrap();
        let us: Vec<f32> = (0..400).map(|k| k as f32 / 399.0).collect();
        let fade = 0.5;
        let under = SkinUnder::new(&surface, &spline, us.clone(), fade);
        let frames = frames(&spline, &us, None, |u, _, _| under.normal_target(u));
        let mut carried = 0;
        for (k, u) in us.iter().enumerate() {
            let p = spline.at(*u);
            let off = p.length() - 8.9;
            if off < 0.5 * fade {
                let want = across(p.normalize(), frames[k].tangent).unwrap();
                assert!(frames[k].normal.dot(want) > 0.999, "{u}: {}", frames[k].normal.dot(want));
            } else if off > 2.1 * fade && k > 0 {
                let (a, b) = (frames[k - 1], frames[k]);
                assert!(b.normal.dot(carry(a.normal, a.tangent, b.tangent)) > 0.9999);
                assert_eq!(under.normal_target(*u), None);
                carried += 1;
            }
            if k > 0 {
                assert!(frames[k].normal.dot(frames[k - 1].normal) > 0.9);
            }
        }
        assert!(carried > 100, "{carried}");
    }
}
