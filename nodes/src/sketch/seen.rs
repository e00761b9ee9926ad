//! The view of a gesture: converts between positions in space and pixels of the picture it was drawn on.
//!
//! Guarantees: the same on every machine and in every window, since the gesture stores all of it; on another head, the
//! eye keeps its position in head units.

use super::stroke_shape::resampled;
use crate::data::gestures::GestureView;
use crate::data::scalp::{HeadFrame, Scalp};
use crate::maths::closest::Hit;
use glam::{Vec2, Vec3};

/// The view, in the head's space (cm).
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    eye: Vec3,
    /// Orthonormal: to the picture's right, to its top, and into it.
    across: Vec3,
    up: Vec3,
    ahead: Vec3,
    half_height: f32,
    parallel: bool,
    pixels: f32,
}

/// Nothing closer to the eye than this (cm) is visible.
const NEAR: f32 = 0.1;
/// Anything less than this (cm) in front of a point does not hide it: skin under hair that lies on it.
const VEIL: f32 = 0.35;
/// Cosine of the steepest view in which strokes stand upright: 60 degrees from above.
const STEEP: f32 = 0.5;

impl Seen {
    /// A view of a head with this frame.
    pub fn new(view: &GestureView, frame: &HeadFrame) -> Self {
        let eye = frame.point_from_head(view.eye);
        let ahead = (frame.point_from_head(view.target) - eye).normalize_or(-frame.forward);
        let up = frame.vector_from_head(view.up);
        let across = ahead.cross(up).try_normalize();
        let across = across.unwrap_or_else(|| crate::maths::frame::any_normal(ahead));
        let unit = if view.parallel { frame.unit() } else { 1.0 };
        Self {
            eye,
            across,
            up: across.cross(ahead),
            ahead,
            half_height: view.half_height * unit,
            parallel: view.parallel,
            pixels: view.pixels,
        }
    }

    /// Whether the projection is parallel.
    pub fn is_parallel(&self) -> bool {
        self.parallel
    }

    /// Direction into the picture, unit.
    pub fn ahead(&self) -> Vec3 {
        self.ahead
    }

    /// Depth of a point in front of the eye, along the view, cm.
    pub fn depth(&self, p: Vec3) -> f32 {
        (p - self.eye).dot(self.ahead)
    }

    /// Centimetres per pixel at a depth.
    pub fn cm_per_pixel(&self, depth: f32) -> f32 {
        let far = if self.parallel { 1.0 } else { depth.max(NEAR) };
        2.0 * self.half_height * far / self.pixels
    }

    /// Position of a point in the picture, in pixels from its centre, to the right and down; `None` behind the eye.
    pub fn pixel(&self, p: Vec3) -> Option<Vec2> {
        let depth = self.depth(p);
        // Written so that NaN is rejected.
        if !(p.is_finite() && depth >= NEAR) {
            return None;
        }
        let off = p - self.eye;
        Some(Vec2::new(off.dot(self.across), -off.dot(self.up)) / self.cm_per_pixel(depth))
    }

    /// The point under a pixel at a depth.
    pub fn at(&self, pixel: Vec2, depth: f32) -> Vec3 {
        let off = pixel * self.cm_per_pixel(depth);
        self.eye + self.ahead * depth + self.across * off.x - self.up * off.y
    }

    /// The depth under a pixel of the plane through `p` that stands upright (`up`, unit) and faces the eye; `None` seen steeply from
    /// above or below.
    pub fn upright(&self, pixel: Vec2, p: Vec3, up: Vec3) -> Option<f32> {
        let facing = self.ahead.reject_from_normalized(up);
        let facing = facing.try_normalize().filter(|_| facing.length() > STEEP)?;
        let depth = self.depth(p);
        let [off, next] = [depth, depth + 1.0].map(|depth| (self.at(pixel, depth) - p).dot(facing));
        (next - off > STEEP * STEEP).then(|| (depth - off / (next - off)).max(NEAR))
    }

    /// Origin and unit direction of the line of sight through a pixel.
    pub fn ray(&self, pixel: Vec2) -> (Vec3, Vec3) {
        if self.parallel {
            (self.at(pixel, 0.0), self.ahead)
        } else {
            (self.eye, (self.at(pixel, 1.0) - self.eye).normalize_or(self.ahead))
        }
    }

    /// Normal of the plane of everything drawn on the line through two pixels, unit.
    pub fn plane(&self, a: Vec2, b: Vec2) -> Vec3 {
        let along = self.at(b, 1.0) - self.at(a, 1.0);
        along.cross(self.ray(a.midpoint(b)).1).normalize_or(self.up)
    }

    /// Where the line of sight through a pixel hits the head.
    pub fn head(&self, scalp: &Scalp, pixel: Vec2) -> Option<Hit> {
        let (origin, direction) = self.ray(pixel);
        scalp.surface().ray(origin, direction, f32::MAX)
    }

    /// Whether the head does not hide a point.
    pub fn sees(&self, scalp: &Scalp, p: Vec3) -> bool {
        let Some(pixel) = self.pixel(p) else { return false };
        let (origin, direction) = self.ray(pixel);
        let far = (p - origin).dot(direction) - VEIL;
        far > 0.0 && !scalp.surface().ray_meets(origin, direction * far, 1.0)
    }
}

/// A stroke as a polyline of equal steps, starting at its first point; the remainder forms a shorter step if it is half
/// a step or more. A stroke shorter than a step is a single segment; one without length is empty.
pub fn steps(points: &[Vec2], step: f32) -> Vec<Vec2> {
    let mut line = resampled(points, step);
    if let (Some(at), Some(last)) = (line.last(), points.last()) {
        let left = at.distance(*last);
        if left >= 0.5 * step || line.len() == 1 && left > 0.0 {
            line.push(*last);
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    pub(crate) fn view() -> GestureView {
        crate::data::gestures::tests::gesture(1, crate::data::gestures::Tool::Comb).view
    }

    #[test]
    fn the_picture_and_the_world_lead_to_each_other() {
        let frame =
            HeadFrame { radius: 12.0, origin: Vec3::new(1.0, 160.0, 3.0), ..HeadFrame::IDENTITY };
        for seed in 0..300 {
            let dice = Dice::new(seed, 0, "view");
            let place = |k: u64, size: f32| Vec3::from([0, 1, 2].map(|a| dice.signed(k, a))) * size;
            let view = GestureView {
                eye: place(0, 60.0) + Vec3::Z * 80.0,
                target: place(1, 8.0),
                parallel: seed % 3 == 0,
                half_height: if seed % 3 == 0 { 15.0 } else { 0.3 },
                ..view()
            };
            let seen = Seen::new(&view, &frame);
            let p = frame.point_from_head(place(2, 15.0));
            let pixel = seen.pixel(p).unwrap();
            assert!(seen.at(pixel, seen.depth(p)).distance(p) < 1e-2, "{seed}");
            let (origin, direction) = seen.ray(pixel);
            assert!((p - origin).cross(direction).length() < 1e-2, "{seed}");
        }
    }

    #[test]
    fn one_view_shows_two_heads_alike() {
        let frames = [8.9, 17.8].map(|radius| HeadFrame { radius, ..HeadFrame::IDENTITY });
        for parallel in [false, true] {
            let view =
                GestureView { parallel, half_height: if parallel { 15.0 } else { 0.25 }, ..view() };
            let [a, b] = frames.map(|frame| {
                Seen::new(&view, &frame)
                    .pixel(frame.point_from_head(Vec3::new(3.0, 5.0, 2.0)))
                    .unwrap()
            });
            assert!(a.distance(b) < 1e-3 && a.x > 0.0 && a.y < 0.0, "{a} {b}");
        }
    }

    #[test]
    fn steps_are_equal_and_a_short_stroke_is_one() {
        let at = |x: f32| Vec2::new(x, 0.0);
        assert_eq!(steps(&[at(0.0), at(7.0), at(65.0)], 30.0), [at(0.0), at(30.0), at(60.0)]);
        assert_eq!(steps(&[at(0.0), at(80.0)], 30.0), [at(0.0), at(30.0), at(60.0), at(80.0)]);
        assert_eq!(steps(&[at(0.0), at(9.0)], 30.0), [at(0.0), at(9.0)]);
        assert_eq!(steps(&[at(0.0), at(0.0)], 30.0), [at(0.0)]);
        assert_eq!(steps(&[], 30.0), []);
        // A corner is cut by no more than a step.
        let corner = steps(&[at(0.0), at(45.0), Vec2::new(45.0, 45.0)], 30.0);
        for pair in corner[..corner.len() - 1].windows(2) {
            assert!((pair[0].distance(pair[1]) - 30.0).abs() < 1e-3);
        }
    }
}
