//! How a hand moves the eye: orbit, pan, dolly, trackball, and fitting what is looked at.
//!
//! Functions from a camera to a camera. Distances are cm, angles degrees, distances on the screen points.
//! Guaranteed: cameras stay finite and their eye stays between [`NEAREST`] and [`FARTHEST`] of what is zoomed to; orbit keeps
//! the distance to its pivot, the pivot's place on the screen and a level horizon; pan carries what was picked along with the
//! pointer; dolly keeps what is under the pointer there; the trackball run backwards takes itself back.
//! Not guaranteed: that the eye stays out of the head.

use crate::core::projection::Projection;
use coif_nodes::data::scalp::HeadFrame;
use coif_shaders::camera::{Camera, FILM_HEIGHT};
use egui::{Pos2, Vec2};
use glam::{Quat, Vec3};

/// The least distance between the eye and what is zoomed to, cm.
pub const NEAREST: f32 = 1.0;
/// The largest, cm.
pub const FARTHEST: f32 = 5000.0;
/// Degrees that a drag over one point turns by.
pub const DEGREES_PER_POINT: f32 = 0.4;
/// How much closer a drag over one point to the right comes.
const DOLLY_PER_POINT: f32 = 0.006;

/// Focal lengths that can be set, mm.
pub const FOCALS: (f32, f32) = (10.0, 400.0);

/// What a drag with the pointer does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Turns about the pivot, horizon level.
    Orbit,
    /// Turns as a ball that the pointer holds.
    Trackball,
    /// Carries the picture with the pointer.
    Pan,
    /// Comes closer to the pivot.
    Dolly,
}

/// A drag with the pointer that moves the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// What it does.
    pub motion: Motion,
    /// What it turns about or holds on to, cm.
    pub pivot: Vec3,
    /// The world's up.
    pub up: Vec3,
}

impl Drag {
    /// The camera after the pointer went from `from` to `to`.
    pub fn moved(&self, view: &Projection, from: Pos2, to: Pos2) -> Camera {
        let by = to - from;
        if !(by.x.is_finite() && by.y.is_finite()) {
            return view.camera;
        }
        match self.motion {
            Motion::Orbit => orbit(
                &view.camera,
                self.pivot,
                self.up,
                -by.x * DEGREES_PER_POINT,
                by.y * DEGREES_PER_POINT,
            ),
            Motion::Trackball => trackball(view, self.pivot, from, to),
            Motion::Pan => pan(view, self.pivot, by),
            Motion::Dolly => dolly(&view.camera, self.pivot, dolly_factor(by)),
        }
    }
}

/// How a drag scales the distance: to the right and up comes closer.
pub fn dolly_factor(by: Vec2) -> f32 {
    (-(by.x - by.y) * DOLLY_PER_POINT).clamp(-3.0, 3.0).exp()
}

/// Turns a camera whose picture lies askew back upright.
pub fn levelled(camera: &Camera, up: Vec3) -> Camera {
    let (across, _) = camera.across_and_up();
    let along = camera.ahead().dot(up).abs();
    // Looking along the vertical every picture is level.
    if along > 0.999 || across.dot(up).abs() < 1e-4 {
        return *camera;
    }
    Camera { up, ..*camera }
}

/// Turns about a pivot: `around` degrees about the vertical, `over` degrees over the top, which ends at the poles. The eye
/// moves to its own right and up for positive numbers.
pub fn orbit(camera: &Camera, pivot: Vec3, up: Vec3, around: f32, over: f32) -> Camera {
    let camera = levelled(camera, up);
    let (across, above) = camera.across_and_up();
    let height = (-camera.ahead().dot(up)).clamp(-1.0, 1.0).asin().to_degrees();
    // Beyond a pole, as some named views are by rounding, only the way back is open.
    let over = over.clamp((-90.0 - height).min(0.0), (90.0 - height).max(0.0));
    let turn = Quat::from_axis_angle(up, around.to_radians())
        * Quat::from_axis_angle(across, -over.to_radians());
    rigid(&Camera { up: above, ..camera }, pivot, turn.normalize())
}

/// Turns everything about a pivot.
fn rigid(camera: &Camera, pivot: Vec3, turn: Quat) -> Camera {
    let distance = camera.eye.distance(camera.target);
    let eye = pivot + turn * (camera.eye - pivot);
    let ahead = (turn * camera.ahead()).normalize();
    // The target is put where it was seen, so that rounding does not add up over a drag.
    Camera { eye, target: eye + ahead * distance, up: turn * camera.up, ..*camera }
}

/// Hultquist's virtual trackball ("A virtual trackball", Graphics Gems, 1990): the pointer holds a ball that fills the
/// picture and stands at the pivot.
fn trackball(view: &Projection, pivot: Vec3, from: Pos2, to: Pos2) -> Camera {
    let centre = view.rect.center();
    let radius = 0.45 * view.rect.width().min(view.rect.height());
    let [across, up, ahead] = view.axes();
    let on_ball = |at: Pos2| {
        let p = (at - centre) / radius;
        let far = p.length();
        // Beyond its rim the ball is held at the rim.
        let (p, deep) =
            if far < 1.0 { (p, (1.0 - far * far).sqrt()) } else { (p / far.max(1e-6), 0.0) };
        across * p.x - up * p.y - ahead * deep
    };
    let (a, b) = (on_ball(from), on_ball(to));
    let axis = b.cross(a);
    let Some(unit) = axis.try_normalize() else { return view.camera };
    let angle = axis.length().atan2(a.dot(b));
    rigid(&Camera { up, ..view.camera }, pivot, Quat::from_axis_angle(unit, angle))
}

/// Moves along the picture so that a point follows the pointer.
pub fn pan(view: &Projection, pivot: Vec3, by: Vec2) -> Camera {
    let scale = view.cm_per_point(view.depth(pivot).max(NEAREST));
    let [across, up, _] = view.axes();
    shifted(&view.camera, (up * by.y - across * by.x) * scale)
}

fn shifted(camera: &Camera, by: Vec3) -> Camera {
    Camera { eye: camera.eye + by, target: camera.target + by, ..*camera }
}

/// Scales the distance to a pivot, which stays where it is on the screen. Parallel views are scaled instead.
pub fn dolly(camera: &Camera, pivot: Vec3, factor: f32) -> Camera {
    let factor = if factor.is_finite() { factor.clamp(0.01, 100.0) } else { 1.0 };
    if let Some(height) = camera.orthographic {
        let wanted = (height * factor).clamp(0.1, FARTHEST);
        let factor = wanted / height;
        let ahead = camera.ahead();
        let off = pivot - camera.eye;
        let beside = off - ahead * off.dot(ahead);
        return Camera { orthographic: Some(wanted), ..shifted(camera, beside * (1.0 - factor)) };
    }
    let off = camera.eye - pivot;
    let far = off.length();
    if far < 1e-6 {
        return *camera;
    }
    let least = if far < NEAREST { 1.0 } else { NEAREST / far };
    let factor = factor.clamp(least, (FARTHEST / far).max(1.0));
    let distance = camera.eye.distance(camera.target);
    let ahead = camera.ahead();
    let eye = pivot + off * factor;
    // What the eye looks at keeps its place in depth before the pivot or behind it.
    let deep = ((pivot - eye).dot(ahead) + (distance - (pivot - camera.eye).dot(ahead)) * factor)
        .clamp(NEAREST, FARTHEST);
    Camera { eye, target: eye + ahead * deep, ..*camera }
}

/// Another focal length from so far away that the target keeps its size.
pub fn with_focal(camera: &Camera, focal_mm: f32) -> Camera {
    let focal_mm = focal_mm.clamp(FOCALS.0, FOCALS.1);
    let height = camera.height();
    let away = (height * focal_mm / FILM_HEIGHT).clamp(NEAREST, FARTHEST);
    Camera { eye: camera.target - camera.ahead() * away, focal_mm, ..*camera }
}

/// The same picture of the target with or without perspective.
pub fn with_parallel_rays(camera: &Camera, parallel: bool) -> Camera {
    match (camera.orthographic, parallel) {
        (None, true) => camera.flattened(),
        (Some(height), false) => {
            let away = (height * camera.focal_mm / FILM_HEIGHT).clamp(NEAREST, FARTHEST);
            let eye = camera.target - camera.ahead() * away;
            Camera { eye, orthographic: None, ..*camera }
        }
        _ => *camera,
    }
}

/// The same way of looking, moved so that the points fill the picture but for a margin; none for no points. `aspect` is the
/// picture's width over its height.
pub fn fitted(camera: &Camera, points: impl Iterator<Item = Vec3>, aspect: f32) -> Option<Camera> {
    let (across, up) = camera.across_and_up();
    let back = -camera.ahead();
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let seen: Vec<Vec3> = points
        .filter(|p| p.is_finite() && p.abs().max_element() < 1e6)
        .map(|p| Vec3::new(p.dot(across), p.dot(up), p.dot(back)))
        .inspect(|p| (low, high) = (low.min(*p), high.max(*p)))
        .collect();
    if seen.is_empty() {
        return None;
    }
    let middle = (low + high) * 0.5;
    let room = 1.0 - 2.0 * coif_shaders::camera::MARGIN;
    let tall = 0.5 * FILM_HEIGHT / camera.focal_mm.clamp(FOCALS.0, FOCALS.1) * room;
    let wide = tall * aspect.clamp(0.05, 20.0);
    let half_height =
        ((high.y - low.y) * 0.5).max((high.x - low.x) * 0.5 / aspect.clamp(0.05, 20.0)).max(0.5);
    let away = match camera.orthographic {
        Some(_) => camera.eye.distance(camera.target).max((high.z - low.z) + 10.0),
        None => seen
            .iter()
            .map(|p| {
                let off = (*p - middle).abs();
                (off.x / wide).max(off.y / tall) + (p.z - middle.z)
            })
            .fold(NEAREST.max(0.5 / tall), f32::max)
            .min(FARTHEST),
    };
    let target = across * middle.x + up * middle.y + back * middle.z;
    Some(Camera {
        eye: target + back * away,
        target,
        up: camera.up,
        focal_mm: camera.focal_mm,
        orthographic: camera.orthographic.map(|_| 2.0 * half_height / room),
    })
}

/// The vertical that orbits keep, of a head or of none.
pub fn vertical(frame: Option<&HeadFrame>) -> Vec3 {
    frame.and_then(|f| f.up.try_normalize()).unwrap_or(Vec3::Y)
}

/// Views that were looked at, to go back and forward through. No undo steps.
#[derive(Clone, Debug, Default)]
pub struct Views {
    seen: Vec<Camera>,
    /// How many of them lie behind the present one.
    at: usize,
}

/// Views that are remembered.
const MOST_VIEWS: usize = 100;

impl Views {
    /// A view at which the eye came to rest. The ways forward from an earlier one are forgotten.
    pub fn rest(&mut self, camera: &Camera) {
        if self.seen.get(self.at) == Some(camera) {
            return;
        }
        self.seen.truncate(self.at + 1);
        self.seen.push(*camera);
        if self.seen.len() > MOST_VIEWS {
            self.seen.remove(0);
        }
        self.at = self.seen.len() - 1;
    }
    /// The view before, if there is one.
    pub fn back(&mut self) -> Option<Camera> {
        self.at = self.at.checked_sub(1)?;
        self.seen.get(self.at).copied()
    }
    /// The view that [`Self::back`] came from.
    pub fn forward(&mut self) -> Option<Camera> {
        let next = self.seen.get(self.at + 1).copied()?;
        self.at += 1;
        Some(next)
    }
    /// Whether there is a view before this one, and one after it.
    pub fn ways(&self) -> (bool, bool) {
        (self.at > 0, self.at + 1 < self.seen.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::projection::tests::{any_camera, any_rect};
    use coif_nodes::maths::hash::Dice;

    /// A view, a point before its eye, and where it is drawn; by a number.
    fn scene(seed: u64) -> (Projection, Vec3, Pos2, Dice) {
        let view = Projection::new(any_camera(seed), any_rect(seed));
        let dice = Dice::new(seed, 3, "hands");
        let at = view.rect.lerp_inside(Vec2::new(dice.unit(0, 0), dice.unit(0, 1)));
        let pivot = view.at_depth(at, dice.range(0, 2, 8.0, 60.0));
        (view, pivot, at, dice)
    }

    fn with(view: &Projection, camera: Camera) -> Projection {
        Projection::new(camera, view.rect)
    }

    #[test]
    fn an_orbit_keeps_distance_horizon_and_the_pivots_place() {
        for seed in 0..400 {
            let (view, pivot, at, dice) = scene(seed);
            let mut camera = view.camera;
            for k in 0..20 {
                let (around, over) = (dice.range(k, 5, -40.0, 40.0), dice.range(k, 6, -40.0, 40.0));
                camera = orbit(&camera, pivot, Vec3::Y, around, over);
            }
            let before = view.camera.eye.distance(pivot);
            assert!((camera.eye.distance(pivot) - before).abs() < 2e-3 * before, "{seed}");
            let (across, up) = camera.across_and_up();
            assert!(across.dot(Vec3::Y).abs() < 2e-3, "{seed}: the horizon is level");
            assert!(up.dot(Vec3::Y) > -1e-3, "{seed}: never upside down");
            let now = with(&view, camera).screen(pivot).unwrap();
            let far = 1.0 + at.distance(view.rect.center());
            assert!(now.distance(at) < 0.02 * far, "{seed}: {at} {now}");
            assert_eq!(camera.focal_mm, view.camera.focal_mm);
        }
    }

    #[test]
    fn an_orbit_ends_at_the_poles_and_leads_back_from_them() {
        for seed in 0..100 {
            let camera = any_camera(seed);
            let pole = orbit(&camera, Vec3::ZERO, Vec3::Y, 0.0, 500.0);
            assert!(pole.ahead().dot(Vec3::NEG_Y) > 0.9999, "{seed}");
            let turned = orbit(&pole, Vec3::ZERO, Vec3::Y, 30.0, 0.0);
            assert!(turned.ahead().dot(Vec3::NEG_Y) > 0.9999, "{seed}");
            let level = orbit(&turned, Vec3::ZERO, Vec3::Y, 0.0, -90.0);
            assert!(level.ahead().dot(Vec3::Y).abs() < 0.02, "{seed}: {}", level.ahead());
        }
    }

    #[test]
    fn a_turn_and_its_opposite_cancel_out() {
        for seed in 0..200 {
            let (view, pivot, from, dice) = scene(seed);
            let to = view.rect.lerp_inside(Vec2::new(dice.unit(1, 0), dice.unit(1, 1)));
            let there = trackball(&view, pivot, from, to);
            let back = trackball(&with(&view, there), pivot, to, from);
            let far = view.camera.eye.distance(pivot) + 1.0;
            assert!(back.eye.distance(view.camera.eye) < 2e-3 * far, "{seed}");
            assert!(back.ahead().distance(view.camera.ahead()) < 2e-3, "{seed}");
            let ups = (view.camera.across_and_up().1, back.across_and_up().1);
            assert!(ups.0.distance(ups.1) < 3e-3, "{seed}");
            let distance = |c: &Camera| c.eye.distance(pivot);
            assert!((distance(&there) - distance(&view.camera)).abs() < 1e-3 * far, "{seed}");
        }
    }

    #[test]
    fn the_ball_follows_the_pointer() {
        // A drag to the right brings the left side of what is seen to the front: the eye goes left.
        let camera = Camera {
            eye: Vec3::Z * 50.0,
            target: Vec3::ZERO,
            up: Vec3::Y,
            focal_mm: 85.0,
            orthographic: None,
        };
        let view =
            Projection::new(camera, egui::Rect::from_min_size(Pos2::ZERO, Vec2::splat(400.0)));
        let (from, to) = (Pos2::new(200.0, 200.0), Pos2::new(260.0, 200.0));
        for motion in [Motion::Trackball, Motion::Orbit] {
            let drag = Drag { motion, pivot: Vec3::ZERO, up: Vec3::Y };
            let moved = drag.moved(&view, from, to);
            assert!(moved.eye.x < -1.0, "{motion:?}: {}", moved.eye);
            let down = drag.moved(&view, from, Pos2::new(200.0, 260.0));
            assert!(down.eye.y > 1.0, "{motion:?}: {}", down.eye);
        }
    }

    #[test]
    fn a_pan_carries_what_was_picked_with_the_pointer() {
        for seed in 0..400 {
            let (view, pivot, at, dice) = scene(seed);
            let by = Vec2::new(dice.range(2, 0, -200.0, 200.0), dice.range(2, 1, -200.0, 200.0));
            let camera = pan(&view, pivot, by);
            let now = with(&view, camera).screen(pivot).unwrap();
            assert!(now.distance(at + by) < 0.5, "{seed}: {} {now}", at + by);
            assert!(camera.ahead().distance(view.camera.ahead()) < 1e-4);
        }
    }

    #[test]
    fn a_dolly_keeps_what_is_under_the_pointer_there() {
        for seed in 0..400 {
            let (view, pivot, at, dice) = scene(seed);
            let factor = dice.range(3, 0, 0.3, 3.0);
            let camera = dolly(&view.camera, pivot, factor);
            let now = with(&view, camera).screen(pivot).unwrap();
            assert!(now.distance(at) < 0.5, "{seed}: {at} {now}");
            assert!(camera.ahead().distance(view.camera.ahead()) < 1e-3, "{seed}");
            let back = dolly(&camera, pivot, 1.0 / factor);
            let far = view.camera.eye.distance(pivot);
            assert!(back.eye.distance(view.camera.eye) < 5e-3 * far, "{seed}");
            match (view.camera.orthographic, camera.orthographic) {
                (Some(a), Some(b)) => assert!((b / a - factor).abs() < 1e-3),
                (None, None) => {
                    let ratio = camera.eye.distance(pivot) / far;
                    assert!((ratio - factor).abs() < 1e-3, "{seed}: {ratio} {factor}");
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn no_zoom_ends_in_the_pivot_or_beyond_the_world() {
        for seed in 0..100 {
            let (view, pivot, ..) = scene(seed);
            for factor in [0.5, 1.7, 0.0, f32::NAN, f32::INFINITY] {
                let mut camera = view.camera;
                for _ in 0..200 {
                    camera = dolly(&camera, pivot, factor);
                }
                assert!(camera.eye.is_finite() && camera.target.is_finite(), "{seed} {factor}");
                let far = camera.eye.distance(pivot);
                assert!(camera.orthographic.is_some() || (0.9..FARTHEST * 1.1).contains(&far));
                assert!(camera.eye.distance(camera.target) > 0.9 * NEAREST);
            }
        }
    }

    #[test]
    fn framed_points_lie_within_the_picture_and_fill_it() {
        for seed in 0..300 {
            let camera = any_camera(seed);
            let dice = Dice::new(seed, 4, "cloud");
            let size = dice.range(0, 0, 0.5, 25.0);
            let middle = Vec3::new(dice.signed(0, 1), dice.signed(0, 2), dice.signed(0, 3)) * 30.0;
            let points: Vec<Vec3> = (1..40)
                .map(|k| {
                    middle
                        + size * Vec3::new(dice.signed(k, 1), dice.signed(k, 2), dice.signed(k, 3))
                })
                .collect();
            let rect = any_rect(seed);
            let camera = Camera { focal_mm: camera.focal_mm.max(20.0), ..camera };
            let fit =
                fitted(&camera, points.iter().copied(), rect.width() / rect.height()).unwrap();
            let view = Projection::new(fit, rect);
            let mut fullest: f32 = 0.0;
            for p in &points {
                let off = (view.screen(*p).unwrap() - rect.center()) / (rect.size() * 0.5);
                let out = off.x.abs().max(off.y.abs());
                assert!(out < 0.9, "{seed}: {out}");
                fullest = fullest.max(out);
            }
            assert!(fullest > 0.4, "{seed}: {fullest}");
            assert!(fit.ahead().distance(camera.ahead()) < 1e-3);
        }
        assert_eq!(fitted(&any_camera(1), std::iter::empty(), 1.0), None);
        let nowhere = [Vec3::NAN, Vec3::INFINITY].into_iter();
        assert_eq!(fitted(&any_camera(1), nowhere, 1.0), None);
    }

    #[test]
    fn lenses_change_and_the_target_keeps_its_size() {
        for seed in 0..100 {
            let camera = Camera { orthographic: None, ..any_camera(seed) };
            let long = with_focal(&camera, 135.0);
            assert!((long.height() / camera.height() - 1.0).abs() < 1e-3, "{seed}");
            let flat = with_parallel_rays(&camera, true);
            assert!((flat.height() / camera.height() - 1.0).abs() < 1e-3);
            let back = with_parallel_rays(&flat, false);
            assert!(back.eye.distance(camera.eye) < 0.01 * camera.eye.distance(camera.target));
        }
    }

    #[test]
    fn views_go_back_and_forward_and_a_new_one_ends_the_way_forward() {
        let cameras: Vec<Camera> = (0..4).map(any_camera).collect();
        let mut views = Views::default();
        assert_eq!((views.back(), views.forward()), (None, None));
        cameras[..3].iter().for_each(|c| views.rest(c));
        views.rest(&cameras[2]);
        assert_eq!(views.back(), Some(cameras[1]));
        assert_eq!(views.back(), Some(cameras[0]));
        assert_eq!(views.back(), None);
        assert_eq!(views.forward(), Some(cameras[1]));
        assert_eq!(views.ways(), (true, true));
        views.rest(&cameras[3]);
        assert_eq!(views.forward(), None);
        assert_eq!(views.back(), Some(cameras[1]));
        (0..300).for_each(|k| views.rest(&any_camera(k)));
        assert!(views.seen.len() <= MOST_VIEWS);
    }
}
