//! Cameras: where the eye stands, what it sees, and the views that every groom is judged from.
//!
//! Lengths are cm. A named view of a head and its hair is framed by [`frame`], for any focal length
//! and shape of picture.
//!
//! Guaranteed: overall views hold every finite hair point within the margin; every camera that
//! [`frame`] makes is finite and stands level, also without hair or on a head that is none.
//! Not guaranteed: that nothing stands between the eye and what a close-up looks at.

use coif_nodes::data::curves::Curves;
use coif_nodes::data::scalp::{HEAD_RADIUS, HeadFrame};
use coif_nodes::maths::closest::Surface;
use glam::camera::rh::proj::directx::orthographic;
use glam::{Mat4, Quat, Vec3, Vec4};

/// Height of the film, mm. Its width follows from the picture's: 36 mm at 3:2.
pub const FILM_HEIGHT: f32 = 24.0;
/// The focal length that portraits are taken with, mm.
pub const PORTRAIT_FOCAL: f32 = 85.0;
/// What is nearer to the eye than this is not drawn, cm.
pub const NEAR: f32 = 0.2;
/// Part of the picture's height or width that stays free at each side of an overall view.
pub const MARGIN: f32 = 0.06;

/// Half of the smallest height of a picture of given points, cm: one point is no subject of its own.
const LEAST_HALF_HEIGHT: f32 = 1.0;
/// Points farther out than this are mistakes, not hair, cm.
const FARTHEST: f32 = 1e6;
/// The shorter side of a close-up at the skin or at the hair over it, head units: 12.75 across at 3:2.
const CLOSE_UP: f32 = 8.5;

/// A ball, cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub centre: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl Sphere {
    /// The ball around a box.
    pub fn around(lowest: Vec3, highest: Vec3) -> Self {
        Self { centre: (lowest + highest) * 0.5, radius: lowest.distance(highest) * 0.5 }
    }
}

/// An eye and what it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is, cm.
    pub eye: Vec3,
    /// What it looks at, and what it is turned about, cm. Not at the eye.
    pub target: Vec3,
    /// The way that is up in the picture; not along the view.
    pub up: Vec3,
    /// Focal length in mm, over a film 24 mm high.
    pub focal_mm: f32,
    /// The height of the picture in cm when all rays are parallel; none for perspective.
    pub orthographic: Option<f32>,
}

impl Camera {
    /// Unit, from the eye into the picture.
    pub fn ahead(&self) -> Vec3 {
        (self.target - self.eye).try_normalize().unwrap_or(Vec3::NEG_Z)
    }

    /// Unit and at right angles: to the picture's right and to its top.
    pub fn across_and_up(&self) -> (Vec3, Vec3) {
        let ahead = self.ahead();
        let across =
            ahead.cross(self.up).try_normalize().unwrap_or_else(|| ahead.any_orthonormal_vector());
        (across, across.cross(ahead))
    }

    /// From the world to the eye: x to the right, y up, z towards the viewer, cm.
    pub fn view(&self) -> Mat4 {
        let (across, up) = self.across_and_up();
        let back = -self.ahead();
        let from_eye = |v: Vec3| v.dot(self.eye);
        Mat4::from_cols(
            Vec4::new(across.x, up.x, back.x, 0.0),
            Vec4::new(across.y, up.y, back.y, 0.0),
            Vec4::new(across.z, up.z, back.z, 0.0),
            Vec4::new(-from_eye(across), -from_eye(up), -from_eye(back), 1.0),
        )
    }

    /// From the eye to clip space, for a picture `aspect` times as wide as high. Depth is 1 at
    /// [`NEAR`]; it falls to 0 at infinity, or in parallel views linearly to a far end that lies
    /// well behind the target.
    pub fn projection(&self, aspect: f32) -> Mat4 {
        match self.orthographic {
            Some(height) => {
                let (half_width, half_height) = (height * aspect * 0.5, height * 0.5);
                let far = self.far();
                // The far end takes the place of the near one: reversed depth.
                orthographic(-half_width, half_width, -half_height, half_height, far, NEAR)
            }
            None => {
                let y = 1.0 / self.half_height();
                Mat4::from_cols(
                    Vec4::new(y / aspect, 0.0, 0.0, 0.0),
                    Vec4::new(0.0, y, 0.0, 0.0),
                    Vec4::new(0.0, 0.0, 0.0, -1.0),
                    Vec4::new(0.0, 0.0, NEAR, 0.0),
                )
            }
        }
    }

    /// Where a parallel view ends, cm from the eye.
    fn far(&self) -> f32 {
        NEAR + 1000.0 + 4.0 * self.eye.distance(self.target)
    }

    /// Half of the picture's height at one cm from the eye, in perspective.
    fn half_height(&self) -> f32 {
        0.5 * FILM_HEIGHT / self.focal_mm.clamp(1.0, 10_000.0)
    }

    /// Height of the picture at the target, cm.
    pub fn height(&self) -> f32 {
        let perspective = || 2.0 * self.half_height() * self.eye.distance(self.target);
        self.orthographic.unwrap_or_else(perspective)
    }

    /// The half-line of all that a picture of this aspect (width over height) shows at a place, which is counted from its upper left
    /// corner, 0 to 1 across and down: where it begins, and its direction (unit).
    pub fn ray(&self, [x, y]: [f32; 2], aspect: f32) -> (Vec3, Vec3) {
        let (across, up) = self.across_and_up();
        let half = self.orthographic.map_or(self.half_height(), |height| 0.5 * height);
        let off = across * (2.0 * x - 1.0) * half * aspect + up * (1.0 - 2.0 * y) * half;
        match self.orthographic {
            Some(_) => (self.eye + off, self.ahead()),
            None => (self.eye, (self.ahead() + off).normalize_or(self.ahead())),
        }
    }

    /// How many cm a share of the picture's height covers, so far (cm) from the eye.
    pub fn covers(&self, share: f32, distance: f32) -> f32 {
        share * self.orthographic.unwrap_or(2.0 * self.half_height() * distance)
    }

    /// The same view with parallel rays: what lies at the target's depth keeps its size.
    pub fn flattened(&self) -> Self {
        Self { orthographic: Some(self.height()), ..*self }
    }

    /// Turned about an axis through a point, as a subject on a turntable sees it: positive degrees
    /// carry the eye anticlockwise when looked at against `axis`.
    pub fn turned(&self, about: Vec3, axis: Vec3, degrees: f32) -> Self {
        let Some(axis) = axis.try_normalize() else { return *self };
        let turn = Quat::from_axis_angle(axis, degrees.to_radians());
        Self {
            eye: about + turn * (self.eye - about),
            target: about + turn * (self.target - about),
            up: turn * self.up,
            ..*self
        }
    }
}

/// A view of a head. Left and right are the head's own, as on a person: `left` shows the side of the
/// left ear, whose face looks to the left edge of the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Viewpoint {
    /// The face, level.
    Front,
    /// The head's own left side.
    Left,
    /// The head's own right side.
    Right,
    /// The back of the head, level.
    Back,
    /// From above, the face at the bottom of the picture.
    Top,
    /// From below, the face at the top of the picture. Under a whole body the eye may stand in it.
    Under,
    /// Face and the head's own left side, a little from above.
    ThreeQuarter,
    /// Close: where hair whorls, behind the top.
    Crown,
    /// Close: the lower hairline at the back.
    Nape,
    /// Close: the hairline over the forehead.
    Hairline,
    /// Close: the head's own left temple.
    TempleLeft,
    /// Close: the head's own right temple.
    TempleRight,
    /// Filled with these points, cm, but for the outermost 2 %.
    Close(Vec<Vec3>),
}

impl Viewpoint {
    /// Names of all views but `close`, as the command line takes them.
    pub const NAMES: [&'static str; 12] = [
        "front",
        "left",
        "right",
        "back",
        "top",
        "under",
        "three-quarter",
        "crown",
        "nape",
        "hairline",
        "temple-left",
        "temple-right",
    ];

    /// The view of a name; none for names that are not in [`Self::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "front" => Self::Front,
            "left" => Self::Left,
            "right" => Self::Right,
            "back" => Self::Back,
            "top" => Self::Top,
            "under" => Self::Under,
            "three-quarter" => Self::ThreeQuarter,
            "crown" => Self::Crown,
            "nape" => Self::Nape,
            "hairline" => Self::Hairline,
            "temple-left" => Self::TempleLeft,
            "temple-right" => Self::TempleRight,
            _ => return None,
        })
    }
}

/// What a view is framed by.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Where the head is and how it stands.
    pub frame: HeadFrame,
    /// The head's skin; none where there is only hair.
    pub surface: Option<&'a Surface>,
    /// All hair that is drawn.
    pub hair: &'a Curves,
}

impl Subject<'_> {
    /// The head frame, or the frame of no head where its numbers are none.
    fn sound_frame(&self) -> HeadFrame {
        let f = self.frame;
        let unit = |v: Vec3| v.is_finite() && (v.length() - 1.0).abs() < 0.01;
        let sound = f.origin.abs().max_element() < FARTHEST
            && (1e-3..FARTHEST).contains(&f.radius)
            && [f.right, f.up, f.forward].into_iter().all(unit);
        if sound { f } else { HeadFrame::IDENTITY }
    }

    /// Hair points that are numbers and are somewhere near.
    fn hair_points(&self) -> impl Iterator<Item = Vec3> {
        let points = self.hair.tufts().iter().flat_map(|t| t.points().iter().copied());
        points.filter(|p| sane(*p))
    }

    /// What an overall view shows besides hair: skull and face with room for a hand's breadth of
    /// neck and the root of the shoulders. The body under it must not shrink the head, so nothing
    /// of the mesh counts, unless the mesh is no head at all, such as an animal: then all of it does.
    fn portrait(&self, frame: &HeadFrame) -> Vec<Sphere> {
        let at = |x, y, z| frame.point_from_head(Vec3::new(x, y, z) * HEAD_RADIUS);
        let head = vec![
            Sphere { centre: at(0.0, 0.0, 0.05), radius: 1.2 * frame.radius },
            Sphere { centre: at(0.0, -1.15, 0.05), radius: 0.9 * frame.radius },
        ];
        let Some(surface) = self.surface.filter(|s| !s.points.is_empty()) else { return head };
        // A skull has points about the frame's middle on all sides but below.
        let on_side = |side: Vec3| {
            surface.points.iter().any(|p| {
                let out = *p - frame.origin;
                let far = out.length() / frame.radius;
                (0.5..=1.6).contains(&far) && out.dot(side) > 0.7 * out.length()
            })
        };
        let sides = [frame.up, frame.right, -frame.right, frame.forward, -frame.forward];
        let (lowest, highest) = surface.bounds();
        if sides.into_iter().all(on_side) || !sane(lowest) || !sane(highest) {
            return head;
        }
        let middle = Sphere { centre: 0.5 * (lowest + highest), radius: 0.0 };
        let at = |p: &Vec3| Sphere { centre: *p, radius: 0.0 };
        [middle].into_iter().chain(surface.points.iter().filter(|p| sane(**p)).map(at)).collect()
    }
}

fn sane(p: Vec3) -> bool {
    p.is_finite() && p.abs().max_element() < FARTHEST
}

/// A camera for a view of a subject, in a picture `aspect` times as wide as high.
///
/// Overall views fit head, face, neck and all hair within [`MARGIN`]. Close-ups are 8.5 head units
/// high (wide, in upright pictures) and look along the normal, tilted by 25 degrees so that relief
/// shows, at the hair over their place where there is any.
pub fn frame(viewpoint: &Viewpoint, subject: &Subject, focal_mm: f32, aspect: f32) -> Camera {
    let head = subject.sound_frame();
    let focal_mm =
        if focal_mm.is_finite() { focal_mm.clamp(1.0, 10_000.0) } else { PORTRAIT_FOCAL };
    let aspect = if aspect.is_finite() { aspect.clamp(0.01, 100.0) } else { 1.5 };
    let overall = |x: f32, y: f32, z: f32| {
        let towards_eye = head.vector_from_head(Vec3::new(x, y, z)).normalize_or(head.forward);
        let fit = Fit::new(&head, towards_eye, focal_mm, aspect);
        let reach = fit.reach_of_points(subject.hair_points());
        let spheres = subject.portrait(&head);
        let reach = spheres.iter().fold(reach, |reach, s| reach.union(fit.reach_of_sphere(s)));
        let target_depth = match spheres.as_slice() {
            [skull, ..] => (skull.centre - fit.origin).dot(fit.towards_eye),
            [] => 0.0,
        };
        fit.camera(reach, target_depth)
    };
    let close_up = |place: [f32; 3], tilt: [f32; 3]| {
        close_up(subject, &head, Vec3::from(place), Vec3::from(tilt), focal_mm, aspect)
    };
    match viewpoint {
        Viewpoint::Front => overall(0.0, 0.0, 1.0),
        Viewpoint::Back => overall(0.0, 0.0, -1.0),
        Viewpoint::Left => overall(1.0, 0.0, 0.0),
        Viewpoint::Right => overall(-1.0, 0.0, 0.0),
        Viewpoint::Top => overall(0.0, 1.0, 0.0),
        Viewpoint::Under => overall(0.0, -1.0, 0.0),
        Viewpoint::ThreeQuarter => overall(0.64, 0.14, 0.76),
        Viewpoint::Crown => close_up([0.0, 0.84, -0.54], [0.0, 0.0, -1.0]),
        Viewpoint::Nape => close_up([0.0, -0.52, -0.85], [0.5, 1.0, 0.0]),
        Viewpoint::Hairline => close_up([0.0, 0.5, 0.87], [1.0, 0.0, 0.0]),
        Viewpoint::TempleLeft => close_up([0.75, 0.2, 0.62], [0.0, 0.2, 1.0]),
        Viewpoint::TempleRight => close_up([-0.75, 0.2, 0.62], [0.0, 0.2, 1.0]),
        Viewpoint::Close(points) => {
            let points = inner_points(points);
            let (count, sum) = points.iter().fold((0.0, Vec3::ZERO), |(n, s), p| (n + 1.0, s + *p));
            let middle = if count > 0.0 { sum / count } else { head.origin };
            let towards_eye = (middle - head.origin)
                .try_normalize()
                .filter(|_| middle.distance(head.origin) > 0.05 * head.radius)
                .unwrap_or(head.forward);
            let fit = Fit::new(&head, towards_eye, focal_mm, aspect);
            let core = Sphere { centre: middle, radius: LEAST_HALF_HEIGHT };
            let reach = points
                .iter()
                .fold(fit.reach_of_sphere(&core), |reach, p| reach.union(fit.reach_of_point(*p)));
            fit.camera(reach, (middle - fit.origin).dot(towards_eye))
        }
    }
}

/// The points without the 2 % that lie farthest from the middle one, and without what is no number.
fn inner_points(points: &[Vec3]) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = points.iter().copied().filter(|p| sane(*p)).collect();
    if points.is_empty() {
        return points;
    }
    let median = |axis: usize| {
        let mut values: Vec<f32> = points.iter().map(|p| p[axis]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f32::total_cmp).1
    };
    let middle = Vec3::new(median(0), median(1), median(2));
    points.sort_by(|a, b| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)));
    points.truncate(points.len() - points.len() / 50);
    points
}

/// Looks at the place of the head in direction `place` from its centre, along the skin's normal
/// tilted towards `tilt`; both in the head frame.
fn close_up(
    subject: &Subject,
    head: &HeadFrame,
    place: Vec3,
    tilt: Vec3,
    focal_mm: f32,
    aspect: f32,
) -> Camera {
    let out = head.vector_from_head(place.normalize());
    let hit = subject.surface.and_then(|s| {
        let hit = s.ray(head.origin, out, 2.5 * head.radius)?;
        let normal = s.smooth_normal(hit.triangle, hit.bary);
        // A wall that is turned inwards belongs to a mouth or an eye, not to the scalp.
        (normal.is_finite() && normal.dot(out) > 0.3).then_some((hit.point, normal.normalize()))
    });
    let (skin, normal) = hit.unwrap_or((head.origin + out * head.radius, out));
    // Where hair stands off the skin (a puff, a bun), its outside is what there is to see.
    let across = 0.25 * CLOSE_UP * head.unit();
    let mut heights: Vec<f32> = subject
        .hair_points()
        .filter_map(|p| {
            let height = (p - skin).dot(normal);
            let beside = (p - skin - normal * height).length();
            (beside < across && (0.0..3.0 * head.radius).contains(&height)).then_some(height)
        })
        .collect();
    let height = match heights.len() {
        0 => 0.0,
        n => *heights.select_nth_unstable_by(n * 3 / 4, f32::total_cmp).1,
    };
    let target = skin + normal * height;
    let tilt = head.vector_from_head(tilt);
    let tilt = (tilt - normal * tilt.dot(normal)).normalize_or_zero();
    let (sin, cos) = 25f32.to_radians().sin_cos();
    let towards_eye = (normal * cos + tilt * sin).normalize();
    let distance = CLOSE_UP * head.unit() / aspect.min(1.0) * focal_mm / FILM_HEIGHT;
    let up = up_for(head, towards_eye);
    Camera { eye: target + towards_eye * distance, target, up, focal_mm, orthographic: None }
}

/// The head's up, or, looking along it, the way that lets the face lie at the bottom of the picture.
fn up_for(head: &HeadFrame, towards_eye: Vec3) -> Vec3 {
    let along = towards_eye.dot(head.up);
    if along.abs() > 0.99 { -head.forward * along.signum() } else { head.up }
}

/// How far things reach against the four sides of a picture: the largest `x + t z`, `-x + t z`,
/// `y + s z` and `-y + s z`, where `t` and `s` are the tangents of half the angle that may be filled,
/// and the largest z. An eye at (u, v, w) sees a point inside when `t (w - z) >= |x - u|`, so these
/// five numbers say all that a fit needs, exactly.
#[derive(Clone, Copy, Debug)]
struct Reach([f32; 5]);

impl Reach {
    const NONE: Self = Self([f32::NEG_INFINITY; 5]);

    fn union(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].max(other.0[k])))
    }
}

/// Finds the eye's place for a way of looking.
struct Fit {
    origin: Vec3,
    across: Vec3,
    above: Vec3,
    towards_eye: Vec3,
    up: Vec3,
    tangents: [f32; 2],
    focal_mm: f32,
}

impl Fit {
    fn new(head: &HeadFrame, towards_eye: Vec3, focal_mm: f32, aspect: f32) -> Self {
        let up = up_for(head, towards_eye);
        let across = up.cross(towards_eye).normalize();
        let vertical = 0.5 * FILM_HEIGHT / focal_mm * (1.0 - 2.0 * MARGIN);
        Self {
            origin: head.origin,
            across,
            above: towards_eye.cross(across),
            towards_eye,
            up,
            tangents: [vertical * aspect, vertical],
            focal_mm,
        }
    }

    fn reach_of_point(&self, p: Vec3) -> Reach {
        self.reach_of_sphere(&Sphere { centre: p, radius: 0.0 })
    }

    fn reach_of_points(&self, points: impl Iterator<Item = Vec3>) -> Reach {
        points.fold(Reach::NONE, |reach, p| reach.union(self.reach_of_point(p)))
    }

    /// The planes that bound the view touch a ball at its radius along their normals.
    fn reach_of_sphere(&self, sphere: &Sphere) -> Reach {
        let p = sphere.centre - self.origin;
        let (x, y, z) = (p.dot(self.across), p.dot(self.above), p.dot(self.towards_eye));
        let [t, s] = self.tangents;
        let (wide, high) =
            (sphere.radius * (1.0 + t * t).sqrt(), sphere.radius * (1.0 + s * s).sqrt());
        Reach([
            x + t * z + wide,
            -x + t * z + wide,
            y + s * z + high,
            -y + s * z + high,
            z + sphere.radius,
        ])
    }

    /// The nearest eye that sees everything, with what has room to spare in the middle.
    fn camera(&self, reach: Reach, target_depth: f32) -> Camera {
        let [right, left, top, bottom, nearest] = reach.0;
        let [t, s] = self.tangents;
        let away =
            ((right + left) / (2.0 * t)).max((top + bottom) / (2.0 * s)).max(nearest + 4.0 * NEAR);
        let eye = self.origin
            + self.across * ((right - left) * 0.5)
            + self.above * ((top - bottom) * 0.5)
            + self.towards_eye * away;
        // The target is what the view turns about: in the depth of the head, but never behind the eye.
        let ahead = (away - target_depth).max(4.0 * NEAR);
        Camera {
            eye,
            target: eye - self.towards_eye * ahead,
            up: self.up,
            focal_mm: self.focal_mm,
            orthographic: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::curves::TuftBuilder;
    use glam::camera::rh::proj::directx;
    use std::sync::Arc;

    const FOCALS: [f32; 4] = [24.0, 50.0, 85.0, 200.0];
    const ASPECTS: [f32; 4] = [0.5, 1.0, 1.5, 16.0 / 9.0];
    const OVERALL: [&str; 7] = ["front", "left", "right", "back", "top", "under", "three-quarter"];

    fn noise(i: usize, k: u32) -> f32 {
        let word = (i as u32).wrapping_mul(747_796_405).wrapping_add(k.wrapping_mul(2_891_336_453));
        let word = (word ^ (word >> 15)).wrapping_mul(277_803_737);
        (word >> 8) as f32 / 8_388_608.0 - 1.0
    }

    #[test]
    fn a_ray_leads_through_all_that_is_drawn_at_its_place() {
        let plain = Camera {
            eye: Vec3::new(30.0, 12.0, 80.0),
            target: Vec3::new(1.0, 2.0, -3.0),
            up: Vec3::Y,
            focal_mm: 85.0,
            orthographic: None,
        };
        for (camera, aspect) in [(plain, 1.5), (plain.flattened(), 1.5), (plain, 0.5)] {
            let clip = camera.projection(aspect) * camera.view();
            for at in [[0.5, 0.5], [0.0, 0.0], [0.9, 0.2], [0.25, 1.0]] {
                let (origin, way) = camera.ray(at, aspect);
                for far in [1.0, 50.0, 200.0] {
                    let drawn = clip.project_point3(origin + way * far);
                    let drawn = [0.5 + 0.5 * drawn.x, 0.5 - 0.5 * drawn.y];
                    let off = (drawn[0] - at[0]).abs().max((drawn[1] - at[1]).abs());
                    assert!(off < 1e-4, "{at:?} {far} cm off is drawn at {drawn:?}");
                }
            }
            // What covers the picture from bottom to top at the target is as high as it says.
            let far = camera.eye.distance(camera.target);
            assert!((camera.covers(1.0, far) / camera.height() - 1.0).abs() < 1e-5);
        }
    }

    /// Hair from the scalp of the default frame down to `length` cm below, lopsided.
    fn hair(length: f32) -> Curves {
        let mut tuft = TuftBuilder::new();
        for i in 0..60 {
            let out = Vec3::new(noise(i, 0), noise(i, 1).abs(), noise(i, 2)).normalize() * 9.0;
            let tip = out * 1.3 + Vec3::new(3.0, -length * noise(i, 3).abs(), 0.0);
            tuft.push_curve(&[out, out * 1.3, tip]);
        }
        Curves::new(vec![Arc::new(tuft.build())])
    }

    fn subject(hair: &Curves) -> Subject<'_> {
        Subject { frame: HeadFrame::IDENTITY, surface: None, hair }
    }

    /// Where a point is in the picture, -1 to 1 from edge to edge, and its depth.
    fn seen(camera: &Camera, aspect: f32, p: Vec3) -> Vec3 {
        let clip = camera.projection(aspect) * camera.view() * p.extend(1.0);
        clip.truncate() / clip.w
    }

    /// The largest |x| or |y| in the picture of all hair points.
    fn filled(camera: &Camera, aspect: f32, hair: &Curves) -> f32 {
        let points = hair.tufts().iter().flat_map(|t| t.points());
        points.map(|p| seen(camera, aspect, *p).truncate().abs().max_element()).fold(0.0, f32::max)
    }

    fn each_view(check: impl Fn(&str, Viewpoint, f32, f32)) {
        for name in Viewpoint::NAMES {
            for focal in FOCALS {
                for aspect in ASPECTS {
                    check(name, Viewpoint::named(name).unwrap(), focal, aspect);
                }
            }
        }
    }

    #[test]
    fn all_hair_is_inside_the_margin_of_overall_views_however_long() {
        for length in [2.0, 30.0, 150.0] {
            let hair = hair(length);
            each_view(|name, view, focal, aspect| {
                if !OVERALL.contains(&name) {
                    return;
                }
                let camera = frame(&view, &subject(&hair), focal, aspect);
                let fill = filled(&camera, aspect, &hair);
                assert!(fill <= 1.0 - 2.0 * MARGIN + 1e-3, "{name} {length} {focal} {fill}");
                for p in hair.tufts()[0].points() {
                    let depth = seen(&camera, aspect, *p).z;
                    assert!(depth > 0.0 && depth < 1.0, "{name} {depth}");
                }
            });
        }
    }

    #[test]
    fn long_hair_fills_the_picture_whatever_the_focal_length() {
        let hair = hair(150.0);
        for focal in FOCALS {
            let camera = frame(&Viewpoint::Front, &subject(&hair), focal, 1.0);
            let top = seen(&camera, 1.0, Vec3::new(0.0, 1.2 * HEAD_RADIUS, 0.0)).y;
            let lowest = hair.bounds().unwrap().0.y;
            assert!(lowest < -100.0);
            let bottom = hair.tufts()[0].points().iter().map(|p| seen(&camera, 1.0, *p).y);
            let bottom = bottom.fold(0.0, f32::min);
            assert!((bottom + 0.88).abs() < 1e-3 && (top - 0.88).abs() < 0.03, "{bottom} {top}");
        }
    }

    #[test]
    fn a_portrait_shows_the_whole_head_and_the_neck_and_little_more() {
        let none = Curves::new(vec![]);
        for focal in FOCALS {
            let camera = frame(&Viewpoint::Front, &subject(&none), focal, 1.0);
            let y = |r: f32| seen(&camera, 1.0, Vec3::Y * r * HEAD_RADIUS).y;
            assert!((0.6..0.95).contains(&y(1.05)), "crown {}", y(1.05));
            assert!((-0.75..-0.4).contains(&y(-1.5)), "chin {}", y(-1.5));
        }
    }

    #[test]
    fn every_view_is_level_and_looks_at_the_side_that_it_names() {
        let hair = hair(20.0);
        each_view(|name, view, focal, aspect| {
            let camera = frame(&view, &subject(&hair), focal, aspect);
            let (across, up) = camera.across_and_up();
            assert!(across.y.abs() < 1e-5, "{name} leans");
            if name != "top" && name != "under" {
                assert!(up.y > 0.0, "{name} is upside down");
            }
            let back = -camera.ahead();
            let side = match name {
                "front" | "hairline" => back.z,
                "back" | "nape" => -back.z,
                "top" => back.y,
                "under" => -back.y,
                "left" | "temple-left" => back.x,
                "right" | "temple-right" => -back.x,
                "three-quarter" => back.x.min(back.z),
                _ => back.y.min(-back.z),
            };
            assert!(side > 0.25, "{name} {back}");
        });
    }

    #[test]
    fn the_face_looks_left_from_the_left_down_from_above_and_up_from_below() {
        let none = Curves::new(vec![]);
        let nose = Vec3::Z * HEAD_RADIUS;
        let left = frame(&Viewpoint::Left, &subject(&none), 85.0, 1.0);
        assert!(seen(&left, 1.0, nose).x < -0.2);
        let top = frame(&Viewpoint::Top, &subject(&none), 85.0, 1.0);
        assert!(seen(&top, 1.0, nose).y < -0.2);
        assert!(seen(&top, 1.0, Vec3::X * HEAD_RADIUS).x > 0.2);
        let under = frame(&Viewpoint::Under, &subject(&none), 85.0, 1.0);
        assert!(seen(&under, 1.0, nose).y > 0.2);
        assert!(seen(&under, 1.0, Vec3::X * HEAD_RADIUS).x > 0.2);
    }

    #[test]
    fn mirrored_subjects_give_mirrored_views() {
        let hair = hair(25.0);
        let flip = |p: Vec3| Vec3::new(-p.x, p.y, p.z);
        let mut tuft = TuftBuilder::new();
        for (t, i) in hair.each() {
            tuft.push_curve(&t.curve(i).iter().map(|p| flip(*p)).collect::<Vec<_>>());
        }
        let mirrored = Curves::new(vec![Arc::new(tuft.build())]);
        let pairs = [
            ("front", "front"),
            ("back", "back"),
            ("top", "top"),
            ("under", "under"),
            ("left", "right"),
            ("crown", "crown"),
            ("temple-left", "temple-right"),
        ];
        for (a, b) in pairs {
            let a = frame(&Viewpoint::named(a).unwrap(), &subject(&hair), 85.0, 1.5);
            let b = frame(&Viewpoint::named(b).unwrap(), &subject(&mirrored), 85.0, 1.5);
            assert!(a.eye.distance(flip(b.eye)) < 1e-3 && a.target.distance(flip(b.target)) < 1e-3);
        }
    }

    #[test]
    fn focal_length_changes_the_perspective_and_not_the_framing() {
        let hair = hair(60.0);
        let look = |focal| frame(&Viewpoint::Front, &subject(&hair), focal, 1.5);
        let (near, far) = (look(35.0), look(200.0));
        assert!((filled(&near, 1.5, &hair) - filled(&far, 1.5, &hair)).abs() < 2e-3);
        assert!(far.eye.z > 4.0 * near.eye.z);
        // The nose is larger than the ears in the near one.
        let ratio = |c: &Camera| {
            let size = |p: Vec3| (seen(c, 1.5, p + Vec3::X) - seen(c, 1.5, p)).x;
            size(Vec3::Z * 9.0) / size(Vec3::ZERO)
        };
        assert!(ratio(&near) > ratio(&far) * 1.05);
        for name in ["crown", "nape", "hairline", "temple-left"] {
            let view = Viewpoint::named(name).unwrap();
            for focal in FOCALS {
                let wide = frame(&view, &subject(&hair), focal, 1.5);
                let upright = frame(&view, &subject(&hair), focal, 0.5);
                assert!((wide.height() - CLOSE_UP).abs() < 1e-3, "{name}");
                assert!((0.5 * upright.height() - CLOSE_UP).abs() < 1e-3, "{name}");
            }
        }
    }

    #[test]
    fn close_ups_look_at_hair_that_stands_off_the_skin() {
        let mut tuft = TuftBuilder::new();
        for i in 0..40 {
            let up = Vec3::new(noise(i, 0) * 0.2, 0.84, -0.54).normalize();
            tuft.push_curve(&[up * 8.9, up * 15.0]);
        }
        let puff = Curves::new(vec![Arc::new(tuft.build())]);
        let over = frame(&Viewpoint::Crown, &subject(&puff), 85.0, 1.5);
        let none = Curves::new(vec![]);
        let skin = frame(&Viewpoint::Crown, &subject(&none), 85.0, 1.5);
        assert!((skin.target.length() - 8.9).abs() < 1e-3 && over.target.length() > 14.0);
    }

    #[test]
    fn close_fills_the_frame_with_its_points_and_not_with_strays() {
        let hair = Curves::new(vec![]);
        let middle = Vec3::new(6.0, 7.0, 2.0);
        let mut points: Vec<Vec3> = (0..200)
            .map(|i| middle + Vec3::new(noise(i, 0), noise(i, 1), noise(i, 2)) * 2.0)
            .collect();
        points.extend([Vec3::splat(90.0), Vec3::new(f32::NAN, 0.0, 0.0), Vec3::NEG_Z * 1e30]);
        let camera = frame(&Viewpoint::Close(points.clone()), &subject(&hair), 85.0, 1.5);
        let fill = |p: &Vec3| seen(&camera, 1.5, *p).truncate().abs().max_element();
        let inside = points[..200].iter().filter(|p| fill(p) <= 0.881).count();
        assert!((194..=200).contains(&inside), "{inside}");
        assert!(points[..200].iter().map(fill).fold(0.0, f32::max) > 0.85);
        assert!((-camera.ahead()).dot(middle.normalize()) > 0.99, "from outside");
    }

    #[test]
    fn the_body_under_the_shoulders_does_not_shrink_the_head() {
        let triangle = |at: Vec3| [at, at + Vec3::X, at + Vec3::Z];
        let mesh = |lowest: f32| {
            let skull = [Vec3::Y, Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z].map(|side| side * 8.0);
            let places = skull.into_iter().chain([Vec3::Y * lowest]);
            let points = places.flat_map(triangle).collect();
            Surface::new(points, (0..6).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
        };
        let hair = hair(5.0);
        let cameras = [-20.0, -160.0].map(|lowest| {
            let surface = mesh(lowest);
            let subject = Subject { surface: Some(&surface), ..subject(&hair) };
            frame(&Viewpoint::ThreeQuarter, &subject, 85.0, 1.5)
        });
        assert_eq!(cameras[0], cameras[1]);
    }

    #[test]
    fn an_animal_at_its_frame_fills_overall_views() {
        // As a rat lies about the origin: 18 cm long, 4 high and 5 wide, where a head would be 20 high.
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let points =
            vec![at(-2.5, 0.0, -12.0), at(2.5, 0.0, 6.0), at(0.0, 4.0, 0.0), at(0.0, 3.0, 6.0)];
        let surface = Surface::new(points, vec![[0, 1, 2], [1, 2, 3]]);
        let none = Curves::new(vec![]);
        let subject = Subject { surface: Some(&surface), ..subject(&none) };
        for view in OVERALL.iter().filter_map(|name| Viewpoint::named(name)) {
            let camera = frame(&view, &subject, 85.0, 1.5);
            let reach = surface.points.iter().map(|p| seen(&camera, 1.5, *p).truncate().abs());
            let farthest = reach.fold(0.0, |most: f32, p| most.max(p.max_element()));
            // The margin is 0.88 of the way to the edge.
            assert!((0.8..=0.881).contains(&farthest), "{view:?}: {farthest}");
        }
    }

    #[test]
    fn a_mesh_far_from_its_frame_is_framed_by_itself() {
        let at = Vec3::new(300.0, 0.0, 0.0);
        let surface = Surface::new(vec![at, at + Vec3::X * 40.0, at + Vec3::Y], vec![[0, 1, 2]]);
        let none = Curves::new(vec![]);
        let subject = Subject { surface: Some(&surface), ..subject(&none) };
        let camera = frame(&Viewpoint::Front, &subject, 85.0, 1.5);
        for p in &surface.points {
            assert!(seen(&camera, 1.5, *p).truncate().abs().max_element() <= 0.881);
        }
    }

    #[test]
    fn poor_input_gives_a_finite_camera() {
        let curves = |points: &[Vec3]| {
            let mut tuft = TuftBuilder::new();
            tuft.push_curve(points);
            Curves::new(vec![Arc::new(tuft.build())])
        };
        let hairs = [
            Curves::new(vec![]),
            curves(&[Vec3::ZERO]),
            curves(&[Vec3::NAN, Vec3::INFINITY]),
            curves(&[Vec3::splat(1e30), Vec3::splat(-1e30)]),
        ];
        let zero = HeadFrame { radius: 0.0, ..HeadFrame::IDENTITY };
        let nan = HeadFrame { origin: Vec3::NAN, right: Vec3::ZERO, ..HeadFrame::IDENTITY };
        let surface = Surface::new(vec![], vec![]);
        let closes = [vec![], vec![Vec3::ZERO], vec![Vec3::Y * 9.0; 3], vec![Vec3::NAN]];
        let mut views: Vec<Viewpoint> =
            Viewpoint::NAMES.iter().map(|n| Viewpoint::named(n).unwrap()).collect();
        views.extend(closes.map(Viewpoint::Close));
        for hair in &hairs {
            for frame_of in [HeadFrame::IDENTITY, zero, nan] {
                for view in &views {
                    for (focal, aspect) in [(85.0, 1.5), (0.0, 0.0), (f32::NAN, f32::INFINITY)] {
                        let subject = Subject { frame: frame_of, surface: Some(&surface), hair };
                        let camera = frame(view, &subject, focal, aspect);
                        let clip = camera.projection(1.5) * camera.view();
                        assert!(clip.is_finite() && camera.eye != camera.target, "{view:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn matrices_agree_with_those_of_the_mathematics_library() {
        let camera = Camera {
            eye: Vec3::new(30.0, 12.0, 50.0),
            target: Vec3::new(1.0, -2.0, 3.0),
            up: Vec3::Y,
            focal_mm: 85.0,
            orthographic: None,
        };
        let view = glam::camera::rh::view::look_at_mat4(camera.eye, camera.target, camera.up);
        assert!(camera.view().abs_diff_eq(view, 1e-4));
        let angle = 2.0 * (12.0f32 / 85.0).atan();
        let projection = directx::perspective_infinite_reverse(angle, 1.5, NEAR);
        assert!(camera.projection(1.5).abs_diff_eq(projection, 1e-4));
        assert!((seen(&camera, 1.5, camera.eye + camera.ahead() * NEAR).z - 1.0).abs() < 1e-3);
    }

    #[test]
    fn parallel_rays_keep_sizes_and_order_of_depth() {
        let none = Curves::new(vec![]);
        let camera = frame(&Viewpoint::Front, &subject(&none), 85.0, 1.5);
        let flat = camera.flattened();
        let size = |c: &Camera, z: f32| {
            let p = c.target + Vec3::Z * z;
            (seen(c, 1.5, p + Vec3::Y) - seen(c, 1.5, p)).y
        };
        assert!((size(&flat, 0.0) - size(&camera, 0.0)).abs() < 1e-4);
        assert!((size(&flat, 9.0) - size(&flat, -9.0)).abs() < 1e-5);
        let depth = |z: f32| seen(&flat, 1.5, Vec3::Z * z).z;
        assert!(depth(9.0) > depth(0.0) && depth(0.0) > depth(-500.0) && depth(-500.0) > 0.0);
    }

    #[test]
    fn a_full_turn_leads_back_and_a_quarter_shows_the_left_side() {
        let none = Curves::new(vec![]);
        let front = frame(&Viewpoint::Front, &subject(&none), 85.0, 1.5);
        let quarter = front.turned(Vec3::ZERO, Vec3::Y, 90.0);
        assert!(quarter.eye.x > 0.9 * front.eye.z && quarter.eye.z.abs() < 1e-2);
        let full = (0..36).fold(front, |c, _| c.turned(Vec3::ZERO, Vec3::Y, 10.0));
        assert!(full.eye.distance(front.eye) < 1e-2);
    }

    #[test]
    fn every_name_is_a_view_of_its_own() {
        for (i, name) in Viewpoint::NAMES.iter().enumerate() {
            let view = Viewpoint::named(name).unwrap();
            let same =
                Viewpoint::NAMES.iter().position(|n| Viewpoint::named(n) == Some(view.clone()));
            assert_eq!(same, Some(i));
        }
        assert_eq!(Viewpoint::named("close"), None);
    }
}
