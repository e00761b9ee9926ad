//! Detects landmarks on any head, from its frame and skin only.
//!
//! The hairline is that of the mesh's own mask, or else the standard one ([`super::region`]), so that drawn data in
//! head units depends on the landmarks and not the other way around.
//!
//! Guarantees: each landmark lies on the skin; a mirrored head has mirrored landmarks, and a rotated or scaled head has
//! the same ones in head units; bounded work. Not promised: the position that a person would choose. A landmark that is
//! not found is left out.

use super::hairline;
use crate::data::carry::{Carry, MapReport};
use crate::data::landmarks::{Landmark, Landmarks};
use crate::data::scalp::HeadFrame;
use crate::eval::EvalCx;
use crate::maths::closest::{Hit, Surface};
use crate::maths::transcendental::sin_cos;
use glam::Vec3;

/// Skin is searched up to this distance from the centre, in radii: hair grows within it, and shoulders are farther
/// away.
const REACH: f32 = 1.5;
/// Angle from the middle of the forehead to the temple about the vertical axis, degrees.
const TEMPLE: f32 = 55.0;
/// Angle of the crown behind the top, degrees: where the back of the head begins.
const BEHIND: f32 = 25.0;
/// A ray in the mirror plane of a mesh may slip between the triangles that meet there; then one this far beside it is
/// used, in radii.
const BESIDE: f32 = 1e-4;
/// The hairline is searched down to this angle from the top, degrees, in steps of one; then the step is halved this
/// many times.
const LOWEST: u16 = 165;
const HALVINGS: usize = 14;
/// The fewest vertices of an ear.
const LEAST_EAR: usize = 6;
/// This fraction of an ear lies below its top; what sticks out above is noise.
const EAR_TOP: f32 = 0.95;
/// The skin over an ear is this far above its top, in radii ...
const OVER_EAR: f32 = 0.04;
/// ... and below what lies at most this far to the side.
const ASIDE: f32 = 1.5;
/// Profile of the face, from below the brows down, in steps; in radii.
const PROFILE: (f32, f32, f32) = (-0.2, -2.0, 0.01);
/// The tip of the nose is not below this level ...
const NOSE: f32 = -1.0;
/// ... the neck is not above this one, and this far behind the tip of the nose.
const NECK: f32 = -0.6;
const RECESS: f32 = 0.6;
/// The bridge of the nose is not above this level. From it the profile comes forward again by at least so much, over at least so much of
/// its height: more than the bridge of a pair of glasses.
const BRIDGE: f32 = 0.2;
const BROW: (f32, f32) = (0.004, 0.06);
/// The lips meet between these parts of the way down from the tip of the nose to the chin, in the notch that is the deepest between what
/// lies at most so far above and below (radii), and at least so deep.
const LIPS: (f32, f32) = (0.36, 0.66);
const NOTCH: (f32, f32) = (0.09, 0.001);

/// A given landmark farther from the skin than this was meant for another head, cm on a head of average size.
const MISSES: f32 = 0.5;

/// The landmarks of a head: those `stated` as text, projected onto the skin, and `guessed` ones for the others.
pub(super) fn resolve(
    cx: &EvalCx,
    surface: &Surface,
    frame: &HeadFrame,
    guessed: Landmarks,
    stated: &str,
) -> Landmarks {
    let (stated, faults) = Landmarks::parse(stated);
    faults.into_iter().for_each(|fault| cx.warn(format!("landmarks: {fault}")));
    let mut out = guessed;
    for (mark, at) in stated.each() {
        let p = frame.point_from_head(at);
        let Some(hit) = surface.closest(p) else { continue };
        let (name, off) = (mark.name(), hit.point.distance(p));
        if off > MISSES * frame.unit() {
            cx.warn(format!(
                "landmark {name:?} misses the skin by {off:.1} cm; it was laid on the nearest skin"
            ));
        }
        out.set(mark, Some(frame.head_from_point(hit.point)));
    }
    if out != Landmarks::default() {
        let missing = out.missing().map_or(String::new(), |gone| format!("; not found: {gone}"));
        cx.remark(format!("landmarks: {out}{missing}"));
    }
    out
}

/// The map from the head with these landmarks, as text, to one with the landmarks `here`; `None` if there is no map.
/// Reports which landmarks it uses and which it drops.
pub(super) fn carry(cx: &EvalCx, home: &str, here: &Landmarks) -> Option<Carry> {
    if home.trim().is_empty() {
        return None;
    }
    let (home, faults) = Landmarks::parse(home);
    faults.into_iter().for_each(|fault| cx.warn(format!("home: {fault}")));
    let names = |marks: &mut dyn Iterator<Item = Landmark>| {
        marks.map(Landmark::name).collect::<Vec<_>>().join(", ")
    };
    let gone =
        names(&mut home.each().map(|(mark, _)| mark).filter(|mark| here.get(*mark).is_none()));
    if !gone.is_empty() {
        cx.warn(format!(
            "home: {gone} not found on this head, and the map goes without: say where in landmarks"
        ));
    }
    // Grooms of earlier versions know no landmarks in the face.
    let knows_face = home.each().any(|(mark, _)| mark.is_in_face());
    if let Some(missing) = home.missing_of(|mark| knows_face || !mark.is_in_face()) {
        cx.warn(format!("home: {missing} not given, and the map goes without"));
    }
    let (carry, MapReport { met, left_out, missed }) = Carry::between(&home, here);
    if !left_out.is_empty() {
        let which = names(&mut left_out.into_iter());
        cx.warn(format!("home: {which} left out: on the spot of another landmark"));
    }
    if let Some((mark, off)) = missed {
        let part = carry.as_ref().map_or(0.0, Carry::part) * 100.0;
        cx.warn(format!(
            "home: all of the map would fold or tear the skin: {part:.0} % of it is taken, and {:?} is missed by {off:.1} cm; look \
             whether the landmarks of both heads mean the same",
            mark.name()
        ));
    } else if carry.is_some() {
        cx.remark(format!("home: {} landmarks meet", met.len()));
    } else if met.is_empty() && !home.same(here) {
        cx.warn("home: no landmark is known on both heads: nothing is carried");
    } else if !home.same(here) {
        cx.warn("home: no map leads through these landmarks: nothing is carried");
    }
    carry
}

/// The landmarks of a head with this frame. `own` is the mesh's own mask for where hair grows, `ears` are the vertices
/// of both ears.
pub(super) fn guessed(
    surface: &Surface,
    frame: &HeadFrame,
    own: Option<&[f32]>,
    ears: &[Vec3],
) -> Landmarks {
    let head = Head { surface, frame, own };
    let side = |degrees: f32, sign: f32| {
        let (sin, cos) = sin_cos(degrees.to_radians());
        frame.forward * cos + frame.right * (sin * sign)
    };
    let (back, up) = sin_cos(BEHIND.to_radians());
    let mut out = Landmarks::default();
    let mut found = |mark, at: Option<Vec3>| {
        out.set(mark, at.map(|at| frame.head_from_point(at)));
    };
    found(Landmark::Front, head.hairline(frame.forward));
    found(Landmark::Nape, head.hairline(-frame.forward));
    found(Landmark::LeftTemple, head.hairline(side(TEMPLE, 1.0)));
    found(Landmark::RightTemple, head.hairline(side(TEMPLE, -1.0)));
    found(Landmark::LeftEar, head.over_ear(ears, 1.0));
    found(Landmark::RightEar, head.over_ear(ears, -1.0));
    found(Landmark::Crown, head.skin(frame.up * up - frame.forward * back).map(|hit| hit.point));
    if let Some(profile) = head.profile() {
        let chin = profile.chin();
        found(Landmark::Chin, chin.map(|(_, at)| at));
        found(Landmark::Bridge, profile.bridge());
        found(Landmark::Nose, profile.nose());
        found(Landmark::Mouth, chin.and_then(|(k, _)| profile.mouth(k)));
    }
    out
}

struct Head<'a> {
    surface: &'a Surface,
    frame: &'a HeadFrame,
    own: Option<&'a [f32]>,
}

impl Head<'_> {
    /// The first skin along a ray with unit direction.
    fn met(&self, from: Vec3, way: Vec3, reach: f32) -> Option<Hit> {
        let beside = self.frame.right * (BESIDE * self.frame.radius);
        let hit = self.surface.ray(from, way, reach);
        hit.or_else(|| self.surface.ray(from + beside, way, reach))
    }

    /// The outermost skin in a unit direction from the centre.
    fn skin(&self, way: Vec3) -> Option<Hit> {
        let reach = REACH * self.frame.radius;
        self.met(self.frame.origin + way * reach, -way, reach)
    }

    fn grows(&self, hit: &Hit) -> bool {
        let Some(own) = self.own else {
            return hairline::within_hairline(self.frame, hit.point - self.frame.origin) > 0.0;
        };
        let [a, b, c] = self.surface.triangles[hit.triangle as usize].map(|v| own[v as usize]);
        let (x, y) = (hit.bary.x, hit.bary.y);
        a * (1.0 - x - y) + b * x + c * y >= 0.5
    }

    /// Where hair ends on the path from the top down to one side (level and unit); `None` if it does not begin or end.
    fn hairline(&self, side: Vec3) -> Option<Vec3> {
        let at = |degrees: f32| {
            let (sin, cos) = sin_cos(degrees.to_radians());
            self.skin(self.frame.up * cos + side * sin).filter(|hit| self.grows(hit))
        };
        let first = (0..LOWEST).find(|k| at(f32::from(*k)).is_some())?;
        let last = (first + 1..=LOWEST).find(|k| at(f32::from(*k)).is_none())?;
        let (mut out, mut within) = (f32::from(last), f32::from(last - 1));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (out + within);
            if at(middle).is_some() { within = middle } else { out = middle }
        }
        at(within).map(|hit| hit.point)
    }

    /// The skin above the ear on one side, 1 the head's left and -1 its right.
    fn over_ear(&self, ears: &[Vec3], sign: f32) -> Option<Vec3> {
        let frame = self.frame;
        let local = ears.iter().map(|p| frame.head_from_vector(*p - frame.origin));
        let mut ear: Vec<Vec3> = local.filter(|p| p.x * sign > 0.0).collect();
        if ear.len() < LEAST_EAR {
            return None;
        }
        ear.sort_by(|a, b| a.y.total_cmp(&b.y).then(a.z.total_cmp(&b.z)));
        let middle = ear.iter().map(|p| p.z).sum::<f32>() / ear.len() as f32;
        let top = ear[((ear.len() - 1) as f32 * EAR_TOP) as usize].y + OVER_EAR * frame.radius;
        let beside = Vec3::new(sign * ASIDE * frame.radius, top, middle);
        let from = frame.origin + frame.vector_from_head(beside);
        let hit = self.met(from, frame.right * -sign, ASIDE * frame.radius)?;
        Some(hit.point)
    }

    /// The skin in the midline at a height (radii), from in front.
    fn front(&self, height: f32) -> Option<Hit> {
        let (frame, r) = (self.frame, self.frame.radius);
        let from = frame.origin + (frame.up * height + frame.forward * 2.0) * r;
        self.met(from, -frame.forward, 2.0 * r)
    }

    /// How far forward a point lies, radii.
    fn forward(&self, p: Vec3) -> f32 {
        (p - self.frame.origin).dot(self.frame.forward) / self.frame.radius
    }

    /// The face in the midline; `None` without a nose.
    fn profile(&self) -> Option<Profile<'_>> {
        let (high, low, step) = PROFILE;
        let hits: Vec<_> = (0..=((high - low) / step) as usize)
            .map(|k| self.front(high - k as f32 * step))
            .collect();
        let faces = hits.iter().enumerate().take_while(|(k, _)| Profile::height(*k) > NOSE);
        let faces = faces.filter_map(|(k, hit)| Some((k, self.forward(hit.as_ref()?.point))));
        let (nose, tip) = faces.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Profile { head: self, hits, nose, tip })
    }
}

/// The face in the midline, from below the brows down to the neck.
struct Profile<'a> {
    head: &'a Head<'a>,
    /// The skin at each height.
    hits: Vec<Option<Hit>>,
    /// Index of the tip of the nose, and how far forward that is, radii.
    nose: usize,
    tip: f32,
}

impl Profile<'_> {
    /// The height of a point by its index, radii.
    fn height(k: usize) -> f32 {
        let (high, _, step) = PROFILE;
        high - k as f32 * step
    }

    fn nose(&self) -> Option<Vec3> {
        self.hits[self.nose].map(|hit| hit.point)
    }

    /// The point of the chin: the part between nose tip and neck that reaches farthest down and forward; `None` if no neck follows.
    fn chin(&self) -> Option<(usize, Vec3)> {
        let Self { head, hits, nose, tip } = self;
        let is_neck = |(k, hit): &(usize, &Option<Hit>)| {
            Self::height(*k) < NECK
                && hit.as_ref().is_none_or(|hit| head.forward(hit.point) < tip - RECESS)
        };
        let (neck, _) = hits.iter().enumerate().find(is_neck)?;
        let jaw = hits.get(*nose..neck)?.iter().enumerate();
        let jaw = jaw.filter_map(|(k, hit)| Some((nose + k, hit.as_ref()?.point)));
        let out = |p: Vec3| (p - head.frame.origin).dot(head.frame.forward - head.frame.up);
        jaw.max_by(|(_, a), (_, b)| out(*a).total_cmp(&out(*b)))
    }

    /// The bridge of the nose: where the profile, going up from its tip, is farthest back before it comes forward to the brow.
    fn bridge(&self) -> Option<Vec3> {
        let (_, _, step) = PROFILE;
        // The point farthest back, and the height up to which the profile stays about there.
        let mut back: Option<(f32, Vec3, f32)> = None;
        let mut height = Self::height(self.nose);
        while height < BRIDGE {
            if let Some(hit) = self.head.front(height) {
                let at = self.head.forward(hit.point);
                match &mut back {
                    Some((least, p, up_to)) if at > *least + BROW.0 => {
                        if height > *up_to + BROW.1 {
                            return Some(*p);
                        }
                    }
                    Some((least, _, up_to)) if at >= *least => *up_to = height,
                    back => *back = Some((at, hit.point, height)),
                }
            }
            height += step;
        }
        None
    }

    /// Where the lips meet, over a chin by its index.
    fn mouth(&self, chin: usize) -> Option<Vec3> {
        let (_, _, step) = PROFILE;
        let (reach, least) = ((NOTCH.0 / step) as usize, NOTCH.1);
        let far = |k: usize| {
            let hit = self.hits.get(k)?.as_ref()?;
            Some(self.head.forward(hit.point))
        };
        let most = |all: std::ops::RangeInclusive<usize>| all.filter_map(far).reduce(f32::max);
        let down = |part: f32| self.nose + ((chin - self.nose) as f32 * part) as usize;
        let notches = (down(LIPS.0)..=down(LIPS.1)).filter_map(|k| {
            // As far forward as the lip that lies farther back.
            let lips = most(k.saturating_sub(reach)..=k)?.min(most(k..=k + reach)?);
            Some((k, lips, far(k).map_or(f32::MAX, |at| lips - at)))
        });
        let (k, lips, depth) = notches.reduce(|a, b| if b.2 > a.2 { b } else { a })?;
        let frame = self.head.frame;
        let between =
            frame.origin + (frame.up * Self::height(k) + frame.forward * lips) * frame.radius;
        (depth > least).then(|| self.head.surface.closest(between)).flatten().map(|hit| hit.point)
    }
}
