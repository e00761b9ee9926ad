//! Convex parts of the air beside a surface: what is drawn within one is clear of the skin, by a few products and without a sample of the
//! [field](super::distance_field), for a curve lies where its Bezier points lie.
//!
//! Two kinds, found once where hair is: the [`Horizon`] of a triangle, a slope for each distance, gives the cone over a root on it; the
//! `Cap` of a small ball, a height along one direction, gives what of the ball lies higher than all surface in it. The first clears hair
//! where it leaves the skin, the second hair that lies along it.
//!
//! Guarantees: an open cone holds no surface nearer to the root than the distance; the open part of a ball over its cap holds none, and is
//! outside. Not promised: the smallest slope or height; where triangles overhang or are very many, none is given.

use super::closest::Surface;
use super::drawn_span::DrawnSpan;
use glam::Vec3;

/// Distances for which a slope is kept, cm.
const REACHES: [f32; 4] = [0.5, 1.0, 2.0, 4.0];
/// Triangles that are looked at before a shorter distance is tried.
const MOST: usize = 400;
/// Slopes above this are as good as none.
const STEEPEST: f32 = 8.0;
/// Heights and lengths below this are rounded, cm.
const ROUNDED: f32 = 1e-5;
/// What a bound is smaller by, cm.
const MARGIN: f32 = 1e-4;
/// How far (cm) off its triangle a root may lie.
const OFF: f32 = 1e-3;

/// Slopes (height over distance along the plane of a triangle), one for each of 0.5, 1, 2 and 4 cm; infinite where unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon([f32; REACHES.len()]);

impl Horizon {
    const UNKNOWN: Self = Self([f32::INFINITY; REACHES.len()]);

    /// That of a triangle of the surface.
    pub(super) fn of(surface: &Surface, triangle: u32) -> Self {
        let corners = surface.corners(triangle);
        let Some(plane) = Plane::of(corners) else { return Self::UNKNOWN };
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let radius = corners.map(|c| c.distance(middle)).into_iter().fold(0.0, f32::max);
        for count in (1..=REACHES.len()).rev() {
            let mut slopes = [f32::INFINITY; REACHES.len()];
            slopes[..count].fill(0.0);
            let reach = radius + REACHES[count - 1] + ROUNDED;
            // What is level with the triangle does not rise.
            let over = (plane.normal, corners[0].dot(plane.normal) + ROUNDED);
            let all = surface.each_above((middle, reach), over, MOST, |other, corners, far| {
                if other == triangle {
                    return;
                }
                let slope = plane.slope_over(corners);
                for (kept, reach) in slopes[..count].iter_mut().zip(REACHES) {
                    if far <= radius + reach + ROUNDED {
                        *kept = kept.max(slope);
                    }
                }
            });
            if all {
                // Rounding, once more.
                return Self(slopes.map(|slope| match slope * 1.01 + 1e-3 {
                    steep if steep > STEEPEST => f32::INFINITY,
                    slope => slope,
                }));
            }
        }
        Self::UNKNOWN
    }
}

/// Radii of the balls of a [`Cap`], cm for cells of 0.2.
const RADII: [f32; 3] = [0.5, 0.8, 1.6];

/// How high, along one direction, the surface reaches in balls about a place; infinite where unknown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cap {
    normal: Vec3,
    heights: [f32; RADII.len()],
}

impl Cap {
    /// That of a place (cm), with radii times `size`.
    pub(super) fn of(surface: &Surface, centre: Vec3, size: f32) -> Self {
        let mut cap = Self { normal: Vec3::Y, heights: [f32::INFINITY; RADII.len()] };
        let radii = RADII.map(|radius| radius * size);
        // All of the first two balls say which way is up.
        let mut near = vec![];
        let everywhere = (Vec3::Y, f32::NEG_INFINITY);
        let tell = |_, corners, far| near.push((corners, far));
        if !surface.each_above((centre, radii[1]), everywhere, MOST, tell) {
            return cap;
        }
        let area = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
        let across: Vec3 = near.iter().map(|(corners, _)| area(*corners)).sum();
        cap.normal = across.try_normalize().unwrap_or(Vec3::Y);
        let level = centre.dot(cap.normal);
        let mut height = f32::NEG_INFINITY;
        for (k, radius) in radii.into_iter().enumerate() {
            height = height.max(-radius);
            if k < 2 {
                let within = near.iter().filter(|(_, far)| *far <= radius + ROUNDED);
                let heights = within.map(|(corners, _)| cap.reached(*corners, centre, radius));
                height = heights.fold(height, f32::max);
            } else {
                let over = (cap.normal, level + height);
                let tell = |_, corners: [Vec3; 3], _| {
                    height = height.max(cap.reached(corners, centre, radius));
                };
                if !surface.each_above((centre, radius), over, MOST, tell) {
                    break;
                }
            }
            // A ball has one outside, so one point of what is free tells.
            let free = centre + cap.normal * (0.5 * (height + radius));
            let is_outside = height < radius
                && surface
                    .closest(free)
                    .is_none_or(|hit| surface.signed_distance(free, &hit) > 0.0);
            if is_outside {
                cap.heights[k] = height + MARGIN;
            }
        }
        cap
    }

    /// The largest height over the centre of what a triangle has in the ball.
    fn reached(&self, corners: [Vec3; 3], centre: Vec3, radius: f32) -> f32 {
        let heights = corners.map(|p| (p - centre).dot(self.normal));
        let highest = heights.into_iter().fold(f32::NEG_INFINITY, f32::max);
        // No higher than the disc in which its plane cuts the ball.
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return highest };
        let off = (a - centre).dot(normal);
        let disc = (radius * radius - off * off).max(0.0).sqrt();
        let along = normal.dot(self.normal);
        highest.min(off * along + disc * (1.0 - along * along).max(0.0).sqrt() + ROUNDED)
    }

    /// Whether points lie in a ball of its about `centre`, higher than all surface there.
    #[inline]
    pub(super) fn is_under(&self, points: &[Vec3; 4], centre: Vec3, size: f32) -> bool {
        let (mut lowest, mut far) = (f32::INFINITY, 0.0f32);
        for p in points {
            let from = *p - centre;
            lowest = lowest.min(from.dot(self.normal));
            far = far.max(from.length_squared());
        }
        self.heights.into_iter().zip(RADII).any(|(height, radius)| {
            let radius = radius * size;
            lowest > height && far < radius * radius
        })
    }
}

/// The plane of a triangle.
struct Plane {
    corners: [Vec3; 3],
    normal: Vec3,
    /// Away from the triangle across each edge, the one from each corner on; unit.
    aside: [Vec3; 3],
}

impl Plane {
    fn of(corners: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let mut aside = [Vec3::ZERO; 3];
        for (k, aside) in aside.iter_mut().enumerate() {
            *aside = (corners[(k + 1) % 3] - corners[k]).cross(normal).try_normalize()?;
        }
        Some(Self { corners, normal, aside })
    }

    /// The smallest slope found by which a plane through an edge or a corner of this triangle rises over all of another triangle.
    fn slope_over(&self, other: [Vec3; 3]) -> f32 {
        let heights = other.map(|p| (p - self.corners[0]).dot(self.normal));
        if heights.iter().all(|height| *height <= ROUNDED) {
            return 0.0;
        }
        let slope = |through: Vec3, aside: Vec3| {
            let mut slope = 0.0f32;
            let far = other.map(|p| (p - through).dot(aside));
            for (height, far) in heights.into_iter().zip(far) {
                if height > ROUNDED {
                    slope = slope.max(if far > ROUNDED { height / far } else { f32::INFINITY });
                }
            }
            // What lies below the plane must lie below the slope, too.
            let is_over = |(height, far): (f32, f32)| height <= slope * far + ROUNDED;
            match heights.into_iter().zip(far).all(is_over) {
                true => slope,
                false => f32::INFINITY,
            }
        };
        let towards = (other[0] + other[1] + other[2]) / 3.0;
        let mut least = f32::INFINITY;
        for (k, corner) in self.corners.into_iter().enumerate() {
            least = least.min(slope(corner, self.aside[k]));
            // Across a corner, where the triangle lies behind it.
            let away = (towards - corner).reject_from_normalized(self.normal).normalize_or_zero();
            let is_behind = |k: usize| (self.corners[k] - corner).dot(away) <= 0.0;
            if is_behind((k + 1) % 3) && is_behind((k + 2) % 3) {
                least = least.min(slope(corner, away));
            }
        }
        least
    }
}

/// What a hair sees from its root: the open cones over it that hold no skin.
#[derive(Clone, Copy, Debug)]
pub struct View {
    foot: Vec3,
    normal: Vec3,
    horizon: Horizon,
}

impl View {
    /// From a root that lies on a triangle; `None` if it does not, or if nothing is known there.
    pub(super) fn new(
        surface: &Surface,
        triangle: u32,
        root: Vec3,
        horizon: Horizon,
    ) -> Option<Self> {
        if horizon.0[0] == f32::INFINITY {
            return None;
        }
        let plane = Plane::of(surface.corners(triangle))?;
        let height = (root - plane.corners[0]).dot(plane.normal);
        let foot = root - plane.normal * height;
        let is_in = |(corner, aside): (Vec3, Vec3)| (foot - corner).dot(aside) <= ROUNDED;
        let is_on = plane.corners.into_iter().zip(plane.aside).all(is_in) && height.abs() <= OFF;
        is_on.then_some(Self { foot, normal: plane.normal, horizon })
    }

    /// Height over the plane, distance along it, and distance from the root, cm.
    #[inline]
    fn lies(&self, p: Vec3) -> [f32; 3] {
        let from = p - self.foot;
        let (height, square) = (from.dot(self.normal), from.length_squared());
        [height, (square - height * height).max(0.0).sqrt(), square.sqrt()]
    }

    /// A lower bound of the distance of `p` outside the skin (cm); 0 if unknown.
    #[inline]
    pub fn off_at_least(&self, p: Vec3) -> f32 {
        let [height, aside, far] = self.lies(p);
        let mut most = 0.0f32;
        for (slope, reach) in self.horizon.0.into_iter().zip(REACHES) {
            let over = height - slope * aside;
            if over > 0.0 && far < reach {
                most = most.max((over / (1.0 + slope * slope).sqrt()).min(reach - far) - MARGIN);
            }
        }
        most
    }

    /// Whether a span is known to lie outside the skin, but for what is rounded at the root.
    #[inline]
    pub fn clears(&self, span: &DrawnSpan) -> bool {
        // A cone is convex: what holds the Bezier points holds the curve.
        let lies = span.bezier().map(|p| self.lies(p));
        self.horizon.0.into_iter().zip(REACHES).any(|(slope, reach)| {
            lies.iter().all(|[height, aside, far]| *far < reach && *height >= slope * aside - OFF)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::closest::tests::sphere;
    use crate::maths::distance_field::DistanceField;
    use crate::maths::hash::Dice;

    fn signed(surface: &Surface, p: Vec3) -> f32 {
        surface.closest(p).map_or(0.0, |hit| surface.signed_distance(p, &hit))
    }

    #[test]
    fn what_a_root_sees_past_the_horizon_is_outside_as_far_as_it_says() {
        let bust = crate::scalp::bust::adult();
        let bust = Surface::new(bust.points, bust.triangles);
        let dice = Dice::new(23, 0, "view");
        for (surface, most_clear) in [(sphere(1.5, 5), 0.85), (sphere(6.0, 64), 0.5), (bust, 0.4)] {
            let field = DistanceField::new(&surface);
            let (mut clear, mut outside, mut bounds) = (0, 0, 0.0);
            for id in 0..4000 {
                // Ears, eyes and mouth among them.
                let axes = |k: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(id, k + a)));
                let root = surface.closest(axes(0).normalize_or(Vec3::Y) * 9.0).unwrap();
                let Some(view) = field.view_from(&surface, root.point, root.triangle) else {
                    continue;
                };
                let normal = surface.face_normal(root.triangle);
                let step = (normal + axes(3)) * (1.2 * dice.unit(id, 6));
                let points =
                    [0.0, 1.0, 2.0].map(|k| root.point + step * k + axes(7) * (0.2 * k * k));
                let span = DrawnSpan::of(&points, 0);
                let depths = (0..=40).map(|n| -signed(&surface, span.at(n as f32 / 40.0)));
                let deepest = depths.fold(0.0, f32::max);
                outside += usize::from(deepest < 0.002);
                if view.clears(&span) {
                    clear += 1;
                    assert!(deepest < 0.002, "{deepest} cm deep: {span:?}");
                }
                let (off, least) = (signed(&surface, points[1]), view.off_at_least(points[1]));
                assert!(least == 0.0 || off >= least, "{least} for {off}");
                bounds += least / off.max(0.1);
            }
            let share = clear as f32 / outside as f32;
            println!("{clear} of {outside} outside are told so; bounds {}", bounds / clear as f32);
            assert!(share > most_clear, "{share} of {outside}");
        }
    }

    #[test]
    fn a_span_that_is_told_to_lie_over_the_skin_is_outside() {
        let bust = crate::scalp::bust::adult();
        let bust = Surface::new(bust.points, bust.triangles);
        let dice = Dice::new(29, 0, "over");
        for (surface, most_over) in [(sphere(1.5, 5), 0.1), (sphere(6.0, 64), 0.5), (bust, 0.4)] {
            let field = DistanceField::new(&surface);
            let (mut over, mut outside) = (0, 0);
            for id in 0..6000 {
                let axes = |k: u64| Vec3::from([0, 1, 2].map(|a| dice.signed(id, k + a)));
                let root = surface.closest(axes(0).normalize_or(Vec3::Y) * 9.0).unwrap();
                let normal = surface.face_normal(root.triangle);
                let first = root.point + normal * (0.4 * dice.unit(id, 6) - 0.1);
                let along = normal.cross(axes(3)).normalize_or_zero() + 0.2 * axes(10);
                let points =
                    [0.0, 1.0, 2.0, 3.0].map(|k| first + along * (0.3 * k) + axes(7) * 0.05);
                let span = DrawnSpan::of(&points, 1);
                let depths = (0..=40).map(|n| -signed(&surface, span.at(n as f32 / 40.0)));
                let deepest = depths.fold(f32::NEG_INFINITY, f32::max);
                outside += usize::from(deepest < 0.0);
                if field.is_over(&surface, &span, span.ball()) {
                    over += 1;
                    assert!(deepest < 0.0, "{deepest} cm deep: {span:?}");
                }
            }
            println!("{over} of {outside} outside are told so");
            assert!(over as f32 > most_over * outside as f32, "{over} of {outside}");
        }
    }

    #[test]
    fn nothing_is_seen_from_beside_the_triangle_and_over_a_crease_the_horizon_is_its_slope() {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        // A floor, and a wall that rises from its edge by two for one.
        let points =
            vec![at(0.0, 0.0, 0.0), at(0.0, 0.0, 3.0), at(-3.0, 0.0, 0.0), at(3.0, 6.0, 0.0)];
        let surface = Surface::new(points, vec![[0, 2, 1], [0, 1, 3]]);
        let field = DistanceField::new(&surface);
        let floor = (0..2).find(|t| surface.face_normal(*t).dot(Vec3::Y).abs() > 0.99).unwrap();
        let up = surface.face_normal(floor);
        let root = at(-0.3, 0.0, 0.3);
        let view = field.view_from(&surface, root, floor).unwrap();
        assert!(view.off_at_least(root + up * 0.2) > 0.05);
        assert_eq!(view.off_at_least(root + up * 0.2 + Vec3::X * 0.11), 0.0);
        for off in [Vec3::X * 0.4, Vec3::Y * 0.1, Vec3::NAN] {
            assert!(field.view_from(&surface, root + off, floor).is_none());
        }
        assert!(field.view_from(&surface, root, 7).is_none());
    }
}
