//! Between the world and the screen: where a point is drawn, and what lies under the pointer.
//!
//! Lengths are cm in the world and points (egui's logical pixels) on the screen; y goes up in the world and down on the
//! screen. Guaranteed: what [`Projection::screen`] gives leads back through [`Projection::at_depth`] to within what `f32`
//! rounds; nothing here is infinite or no number for finite cameras and rectangles. Not known here: what stands in the way.

use coif_shaders::camera::{Camera, NEAR};
use egui::{Pos2, Rect, Vec2};
use glam::Vec3;

/// The picture among the widgets of a frame; those that come after it stand on it. `ui` is that of its room.
pub(crate) fn picture(ui: &egui::Ui) -> egui::Id {
    ui.id().with("picture")
}

/// A camera and the rectangle of the screen that its picture fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Where it is seen from.
    pub camera: Camera,
    /// Where the picture lies, points.
    pub rect: Rect,
    across: Vec3,
    up: Vec3,
    ahead: Vec3,
    /// Half the picture's height: at one cm from the eye, or anywhere in parallel views, cm.
    half_height: f32,
}

/// A half-line into the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins: the eye, or in parallel views a point of the plane through it.
    pub origin: Vec3,
    /// Unit.
    pub direction: Vec3,
}

impl Ray {
    /// The point at a distance, cm.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }
}

impl Projection {
    /// A picture of `camera` that fills `rect`. A rectangle without area is taken for one of a point's size.
    pub fn new(camera: Camera, rect: Rect) -> Self {
        let rect = if rect.is_finite() { rect } else { Rect::ZERO };
        let rect = Rect::from_min_size(rect.min, rect.size().max(Vec2::splat(1.0)));
        let (across, up) = camera.across_and_up();
        let half_height = 1.0 / camera.projection(1.0).y_axis.y;
        Self { camera, rect, across, up, ahead: camera.ahead(), half_height }
    }

    /// Unit: to the picture's right, to its top, and into it.
    pub fn axes(&self) -> [Vec3; 3] {
        [self.across, self.up, self.ahead]
    }

    /// How far a point lies before the eye along the view, cm; negative behind it.
    pub fn depth(&self, p: Vec3) -> f32 {
        (p - self.camera.eye).dot(self.ahead)
    }

    /// How many cm of the world at this depth a point of the screen covers.
    pub fn cm_per_point(&self, depth: f32) -> f32 {
        let half = match self.camera.orthographic {
            Some(_) => self.half_height,
            None => self.half_height * depth.max(NEAR),
        };
        2.0 * half / self.rect.height()
    }

    /// Where a point of the world is drawn; none for what is too near or behind the eye, or no place. It may lie outside
    /// the rectangle.
    pub fn screen(&self, p: Vec3) -> Option<Pos2> {
        let depth = self.depth(p);
        // Written so that what is no number is left out.
        if !(p.is_finite() && depth >= NEAR) {
            return None;
        }
        let scale = 1.0 / self.cm_per_point(depth);
        let from_eye = p - self.camera.eye;
        let off = Vec2::new(from_eye.dot(self.across), -from_eye.dot(self.up)) * scale;
        Some(self.rect.center() + off)
    }

    /// The point of the world under a point of the screen at a depth.
    pub fn at_depth(&self, at: Pos2, depth: f32) -> Vec3 {
        let off = (at - self.rect.center()) * self.cm_per_point(depth);
        self.camera.eye + self.ahead * depth + self.across * off.x - self.up * off.y
    }

    /// The half-line of all that is drawn at a point of the screen.
    pub fn ray(&self, at: Pos2) -> Ray {
        match self.camera.orthographic {
            Some(_) => Ray { origin: self.at_depth(at, 0.0), direction: self.ahead },
            None => {
                let origin = self.camera.eye;
                let direction = (self.at_depth(at, 1.0) - origin).normalize_or(self.ahead);
                Ray { origin, direction }
            }
        }
    }

    /// Where the half-line under a point of the screen meets a plane; none where they run side by side or the plane lies
    /// behind.
    pub fn on_plane(&self, at: Pos2, point: Vec3, normal: Vec3) -> Option<Vec3> {
        let ray = self.ray(at);
        let slope = ray.direction.dot(normal);
        let distance = (point - ray.origin).dot(normal) / slope;
        (slope.abs() > 1e-5 * normal.length() && distance > 0.0 && distance.is_finite())
            .then(|| ray.at(distance))
    }

    /// The point of the line through `point` along `axis` that is drawn nearest to a point of the screen: what a handle on a
    /// line follows. None where the line points at the viewer.
    pub fn on_line(&self, at: Pos2, point: Vec3, axis: Vec3) -> Option<Vec3> {
        let axis = axis.try_normalize()?;
        let ray = self.ray(at);
        let between = point - ray.origin;
        let along = axis.dot(ray.direction);
        let apart = 1.0 - along * along;
        if apart < 1e-4 {
            return None;
        }
        let t = (along * ray.direction.dot(between) - axis.dot(between)) / apart;
        t.is_finite().then(|| point + axis * t)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use coif_nodes::maths::hash::Dice;

    /// A camera somewhere around a head, level or not, in perspective or parallel.
    pub(crate) fn any_camera(seed: u64) -> Camera {
        let dice = Dice::new(seed, 0, "camera");
        let place = |k: u64, size: f32| {
            Vec3::new(dice.signed(k, 0), dice.signed(k, 1), dice.signed(k, 2)) * size
        };
        let target = place(1, 8.0);
        let towards = place(2, 1.0).normalize_or(Vec3::Z);
        let towards = (towards * Vec3::new(1.0, 0.8, 1.0)).normalize_or(Vec3::Z);
        Camera {
            eye: target + towards * dice.range(3, 0, 15.0, 120.0),
            target,
            up: Vec3::Y,
            focal_mm: dice.range(3, 1, 20.0, 150.0),
            orthographic: (dice.unit(3, 2) < 0.3).then(|| dice.range(3, 3, 5.0, 60.0)),
        }
    }

    pub(crate) fn any_rect(seed: u64) -> Rect {
        let dice = Dice::new(seed, 0, "rect");
        let min = Pos2::new(dice.range(0, 0, 0.0, 500.0), dice.range(0, 1, 0.0, 500.0));
        Rect::from_min_size(
            min,
            Vec2::new(dice.range(1, 0, 80.0, 1600.0), dice.range(1, 1, 80.0, 1200.0)),
        )
    }

    #[test]
    fn the_screen_and_the_world_lead_to_each_other() {
        for seed in 0..500 {
            let view = Projection::new(any_camera(seed), any_rect(seed));
            let dice = Dice::new(seed, 0, "pixels");
            let at = view.rect.lerp_inside(Vec2::new(dice.unit(0, 0), dice.unit(0, 1)));
            let depth = dice.range(0, 2, 1.0, 150.0);
            let p = view.at_depth(at, depth);
            assert!((view.depth(p) - depth).abs() < 1e-3 * (1.0 + depth), "{seed}");
            let back = view.screen(p).unwrap();
            assert!(back.distance(at) < 0.05, "{seed}: {at} {back}");
            let ray = view.ray(at);
            let along = (p - ray.origin).dot(ray.direction);
            assert!(ray.at(along).distance(p) < 2e-3 * (1.0 + depth), "{seed}");
            assert!((ray.direction.length() - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn points_are_drawn_where_the_renderers_matrix_puts_them() {
        for seed in 0..500 {
            let view = Projection::new(any_camera(seed), any_rect(seed));
            let dice = Dice::new(seed, 1, "points");
            let p = Vec3::new(dice.signed(0, 0), dice.signed(0, 1), dice.signed(0, 2)) * 20.0;
            let rect = view.rect;
            let matrix = view.camera.projection(rect.width() / rect.height()) * view.camera.view();
            let clip = matrix * p.extend(1.0);
            let Some(ours) = view.screen(p) else {
                assert!(clip.z > clip.w * 0.99, "{seed}: {clip}");
                continue;
            };
            let ndc = Vec2::new(clip.x, -clip.y) / clip.w;
            let theirs = rect.center() + ndc * rect.size() * 0.5;
            assert!(ours.distance(theirs) < 0.1 + 1e-4 * ours.distance(rect.center()), "{seed}");
        }
    }

    #[test]
    fn planes_and_lines_are_met_under_the_pointer() {
        for seed in 0..500 {
            let view = Projection::new(any_camera(seed), any_rect(seed));
            let dice = Dice::new(seed, 2, "planes");
            let unit = |k| Vec3::new(dice.signed(k, 0), dice.signed(k, 1), dice.signed(k, 2));
            let at = view.rect.lerp_inside(Vec2::new(dice.unit(9, 0), dice.unit(9, 1)));
            let point = view.at_depth(view.rect.center(), 30.0) + unit(0) * 3.0;
            let normal = unit(1).normalize_or(Vec3::Y);
            if let Some(hit) = view.on_plane(at, point, normal) {
                let far = 1.0 + hit.distance(view.camera.eye);
                assert!((hit - point).dot(normal).abs() < 1e-3 * far, "{seed}");
                if let Some(back) = view.screen(hit) {
                    assert!(back.distance(at) < 0.5, "{seed}: {at} {back}");
                }
            }
            if let Some(on) = view.on_line(at, point, normal) {
                let off = (on - point).cross(normal).length();
                assert!(off < 1e-3 * (1.0 + on.distance(point)), "{seed}: {off}");
                // No other place of the line is nearer to what lies under the pointer.
                let ray = view.ray(at);
                let gap = |p: Vec3| (p - ray.origin).cross(ray.direction).length();
                for step in [-0.5, 0.5] {
                    assert!(gap(on + normal * step) > gap(on) - 1e-3, "{seed}");
                }
            }
        }
    }

    #[test]
    fn what_is_behind_the_eye_or_no_place_is_not_drawn() {
        let view = Projection::new(
            any_camera(1),
            Rect::from_min_size(Pos2::ZERO, Vec2::new(300.0, 200.0)),
        );
        let camera = view.camera;
        assert_eq!(view.screen(camera.eye - camera.ahead()), None);
        assert_eq!(view.screen(Vec3::splat(f32::NAN)), None);
        assert_eq!(view.screen(Vec3::splat(f32::INFINITY)), None);
        let empty = Projection::new(camera, Rect::NOTHING);
        assert!(empty.ray(Pos2::ZERO).direction.is_finite());
    }
}
