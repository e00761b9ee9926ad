//! The skin of a head: what keeps hair out of it.
//!
//! Guarantees: the same answers on every machine and whoever asks first; what a search for a way out takes is bounded by a
//! [`Patience`] where one is given. On a wide mesh each point is asked for by itself, for there no two come to the same cell of the
//! field. What is strewn or tangled ([`Rough`]) has no inside: there every place is outside.

use super::patience::Patience;
use super::rough::Rough;
use crate::maths::closest::{Hit, Surface};
use crate::maths::distance_field::{Depth, DistanceField};
use crate::maths::frame::round_about;
use glam::Vec3;

/// The skin of a head: what keeps hair out of it.
#[derive(Clone, Copy)]
pub struct Skin<'a> {
    surface: &'a Surface,
    field: &'a DistanceField,
    rough: Option<Rough>,
    patience: Option<&'a Patience>,
}

/// Nearer to the skin than this (cm) [`Skin::distance`] asks the surface itself.
const EXACT: f32 = 0.1;
/// How far outside the allowed depth a pushed point is put, cm: beyond the rounding of coordinates
/// of a few tens of cm.
const CLEAR: f32 = 1e-4;
/// How far over the skin deep points are put before they are set down on it, cm: beyond what the field errs by where
/// the skin is smooth.
const OVERSHOOT: f32 = 0.03;

impl<'a> Skin<'a> {
    /// Of a surface and its field.
    pub(super) fn new(
        surface: &'a Surface,
        field: &'a DistanceField,
        rough: Option<Rough>,
    ) -> Self {
        Self { surface, field, rough, patience: None }
    }

    /// The same, whose searches for a way out end with somebody's patience: what is in the skin then is put on its nearest side,
    /// which in a crease may be in the other.
    pub fn within<'b>(self, patience: &'b Patience) -> Skin<'b>
    where
        'a: 'b,
    {
        Skin { patience: Some(patience), ..self }
    }

    /// The skin for hair by the thousand; none where there is no clear inside: there it takes many times as long to keep hair out of the
    /// skin as to grow it. Guides are few, and ask it all the same.
    pub fn for_hair(self) -> Option<Self> {
        self.has_clear_inside().then_some(self)
    }

    /// Whether there is a side that is clearly in: the mesh is not rough, or merely wide.
    pub fn has_clear_inside(&self) -> bool {
        matches!(self.rough, None | Some(Rough::Wide))
    }

    /// Notes so many looks of a search; whether there is patience for more. Among folds there is none: the way out of one leads
    /// into the next.
    pub(super) fn looked(&self, looks: usize) -> bool {
        self.has_clear_inside()
            && self.patience.is_none_or(|patience| {
                patience.take(looks as u64);
                patience.left() > 0
            })
    }

    /// How many looks a search may take yet.
    pub(super) fn patience(&self) -> usize {
        self.patience.map_or(usize::MAX, |patience| patience.left() as usize)
    }

    /// Whether nothing has an inside, as where the mesh is strewn or a tangle: then no place is in the skin.
    pub fn has_no_inside(&self) -> bool {
        matches!(self.rough, Some(Rough::Tangled | Rough::Strewn))
    }

    /// Signed distance of `p` from the skin, cm, negative inside; exact within `EXACT` of it, from the field
    /// beyond, and +-1 cm or more beyond the field's band.
    pub fn distance(&self, p: Vec3) -> f32 {
        if self.has_no_inside() {
            return 1.0;
        }
        match self.field.depth(self.surface, p) {
            Depth::Outside => 1.0,
            Depth::Near(d, ..) if d.abs() > EXACT => d,
            _ => self.exact(p).map_or(1.0, |(d, _)| d),
        }
    }

    /// Whether the mesh is [`Rough`]: then nothing is led round it.
    pub fn is_rough(&self) -> bool {
        self.rough.is_some()
    }

    /// Whether hair is so far from other hair, or the way to the nearest triangle so long, that cells of the field do not pay. There a
    /// point asks about few triangles too: whatever the mesh is, hair has a bounded price.
    pub(crate) fn asks_alone(&self) -> bool {
        self.rough.is_some_and(|rough| rough != Rough::Folded)
    }

    /// Signed distance of `p` from the skin as the field tells it, cm: within a fiftieth of a centimetre where the skin is
    /// smooth, off by up to a tenth at creases, +-1 beyond the field's band. Cheap; for whoever may err on the safe side.
    #[inline]
    pub fn about(&self, p: Vec3) -> f32 {
        self.roughly(p).map_or(1.0, |(d, ..)| d)
    }

    /// The scalp point closest to `p`: [`Surface::closest`], told by the field where to look first.
    #[inline]
    pub fn closest(&self, p: Vec3) -> Option<Hit> {
        match self.field.hint(self.surface, p) {
            Some(near) => self.surface.closest_from(p, near),
            None => self.surface.closest(p),
        }
    }

    /// [`Self::closest`] unless it is farther than `reach` (cm), which the field often tells without a search.
    pub fn closest_within(&self, p: Vec3, reach: f32) -> Option<Hit> {
        if self.field.far(self.surface, p) > reach {
            return None;
        }
        match self.field.hint(self.surface, p) {
            Some(near) => self.surface.closest_within_from(p, reach, near),
            None => self.surface.closest_within(p, reach),
        }
    }

    /// Whether the field alone tells that all of a ball is outside the skin. False says nothing.
    #[inline]
    pub fn is_clear(&self, middle: Vec3, radius: f32) -> bool {
        if self.has_no_inside() {
            return true;
        }
        match self.field.depth(self.surface, middle) {
            Depth::Outside => radius < self.field.band(),
            Depth::Near(d, _, doubt) => radius < (d - doubt).max(0.0),
            Depth::Inside => false,
        }
    }

    /// Whether the field alone tells that `p` is farther than `height` (cm) outside. False says nothing.
    #[inline]
    pub fn stands_off(&self, p: Vec3, height: f32) -> bool {
        if self.asks_alone() {
            return self.field.far(self.surface, p) > height.max(0.0);
        }
        (self.rough.is_some() || self.surface.parts_in_from_out())
            && self.field.is_clear(self.surface, p, height.max(0.0))
    }

    /// The radius (cm) of a ball about `p` that holds no skin: how far it is outside, up to the field's band where that is all that is
    /// known without looking; 0 inside.
    pub fn clear_about(&self, p: Vec3) -> f32 {
        if self.surface.parts_in_from_out() && self.field.is_beyond(self.surface, p) {
            return self.field.band();
        }
        self.exact(p).map_or(0.0, |(d, _)| d.max(0.0))
    }

    /// What the field alone says about `p`: distance, the way out (zero where that is not known), and how far the distance may
    /// be wrong; none farther outside than the field's band. A tenth of the price of an exact answer, for hair by the million.
    #[inline]
    pub fn roughly(&self, p: Vec3) -> Option<(f32, Vec3, f32)> {
        if self.has_no_inside() {
            return None;
        }
        match self.field.depth(self.surface, p) {
            Depth::Near(d, gradient, doubt) => Some((d, gradient, doubt)),
            Depth::Inside => Some((-1.0, Vec3::ZERO, 1.0)),
            Depth::Outside => None,
        }
    }

    pub(super) fn exact(&self, p: Vec3) -> Option<(f32, Hit)> {
        self.exact_from(p, None)
    }

    /// [`Self::exact`], found sooner where a triangle is known that is near `p`.
    fn exact_from(&self, p: Vec3, near: Option<u32>) -> Option<(f32, Hit)> {
        let hit = match near {
            _ if self.has_no_inside() => None,
            _ if self.asks_alone() => {
                let near = near.or_else(|| self.field.hint(self.surface, p));
                self.surface.closest_of_few(p, near)
            }
            Some(near) => self.surface.closest_from(p, near),
            None => self.closest(p),
        }?;
        Some((self.height_over(p, &hit), hit))
    }

    /// The closest point of the skin to `p`, for whoever goes over the scalp from point to point; `near`, a triangle near it, becomes
    /// the nearest. Where there is no clear inside it is a close point, found at a bounded price.
    /// None on an empty mesh or if `p` is not finite.
    #[inline]
    pub fn foot(&self, p: Vec3, near: &mut u32) -> Option<Hit> {
        if self.surface.triangles.is_empty() {
            return None;
        }
        let hit = match self.has_clear_inside() {
            true => self.surface.closest_from(p, *near),
            false => self.surface.closest_of_few(p, Some(*near)),
        }?;
        *near = hit.triangle;
        Some(hit)
    }

    /// The smooth normal at a point of the skin. Unit.
    #[inline]
    pub fn smooth_normal(&self, hit: &Hit) -> Vec3 {
        self.surface.smooth_normal(hit.triangle, hit.bary)
    }

    /// The distance of `p` from its closest point `hit`, cm, negative inside. Where there is no clear inside, the side is that of the
    /// point alone: rays that look farther would meet the next fold.
    #[inline]
    pub fn height_over(&self, p: Vec3, hit: &Hit) -> f32 {
        match self.has_clear_inside() {
            true => self.surface.signed_distance(p, hit),
            false => self.surface.distance_by_side(p, hit),
        }
    }

    /// `p`, or the nearest point not deeper than `allow_depth` (cm, 0 = the skin itself) when it lies deeper.
    /// The second value tells whether it was moved.
    #[inline]
    pub fn push_out(&self, p: Vec3, allow_depth: f32) -> (Vec3, bool) {
        self.raise(p, -allow_depth)
    }

    /// [`Self::push_out`] to a height (cm) over the skin instead of a depth under it.
    #[inline]
    pub fn lift(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        self.raise(p, height)
    }

    /// [`Self::lift`] of all that [`Self::distance`] tells to be lower: beside ears and among folds the field alone may pass over a
    /// thin wall, and what is put out of one may end in another. Where the skin is near it costs a search more.
    pub fn lift_exactly(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        const AGAIN: usize = 4;
        let (mut at, mut moved) = self.lift(p, height);
        for _ in 0..AGAIN {
            if self.distance(at) >= height {
                break;
            }
            let (next, more) = self.raise_exactly(at, height);
            if !more {
                break;
            }
            (at, moved) = (next, true);
        }
        (at, moved)
    }

    /// [`Self::lift`] as far as the field knows, which is right to half a cell: for rounds that come nearer and nearer.
    #[inline]
    pub fn lift_about(&self, p: Vec3, height: f32) -> Vec3 {
        if self.has_no_inside() {
            return p;
        }
        match self.field.depth(self.surface, p) {
            Depth::Near(d, ..) if d >= height => p,
            Depth::Near(d, gradient, _) => p + gradient.normalize_or_zero() * (height - d),
            Depth::Outside if height > 0.9 => self.raise(p, height).0,
            Depth::Outside => p,
            Depth::Inside => self.raise(p, height).0,
        }
    }

    #[inline]
    fn raise(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        if self.asks_alone() {
            let (raised, moved, _) = self.raise_alone(p, height, &mut None);
            return (raised, moved);
        }
        if self.stands_off(p, height) {
            return (p, false);
        }
        match self.field.depth(self.surface, p) {
            Depth::Outside => (p, false),
            // What may lie in the skin is asked of the surface: in folds thinner than its cells the field knows little inside.
            Depth::Near(d, _, doubt) if d > doubt + height.max(0.0) => (p, false),
            // So deep that there is no doubt about the side: the field shows the way, to a little over the
            // height asked for, where a search is short and its answer holds for all points below.
            Depth::Near(d, gradient, doubt) if d < (height - doubt).min(-doubt) => {
                let over = height.max(0.0) + OVERSHOOT;
                let near = p + gradient.normalize_or_zero() * (over - d);
                match self.surface.closest_within(near, 2.0 * over).or_else(|| self.closest(near)) {
                    Some(hit) => {
                        let d = self.surface.signed_distance(near, &hit);
                        if height >= 0.0 && d >= height + CLEAR {
                            let moved = hit.point + (near - hit.point) * ((height + CLEAR) / d);
                            return (moved, true);
                        }
                        (self.put_out(near, d, hit, height), true)
                    }
                    None => (p, false),
                }
            }
            _ => self.raise_exactly(p, height),
        }
    }

    /// [`Self::lift`] that makes no cell of the field; and the radius of a ball about `p` that holds no skin. `near` is a triangle that
    /// is near `p`, then the nearest.
    pub(super) fn raise_alone(
        &self,
        p: Vec3,
        height: f32,
        near: &mut Option<u32>,
    ) -> (Vec3, bool, f32) {
        let far = self.field.far(self.surface, p);
        if far > height.max(0.0) {
            return (p, false, far);
        }
        let Some((d, hit)) = self.exact_from(p, *near) else { return (p, false, 0.0) };
        *near = Some(hit.triangle);
        match d < height {
            true => (self.put_out(p, d, hit, height), true, 0.0),
            false => (p, false, d),
        }
    }

    #[inline(never)]
    fn raise_exactly(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        match self.exact(p) {
            Some((d, hit)) if d < height => (self.put_out(p, d, hit, height), true),
            _ => (p, false),
        }
    }

    /// Where `p`, `d` from its closest point `hit`, is put to be `height` from the skin.
    fn put_out(&self, p: Vec3, d: f32, hit: Hit, height: f32) -> Vec3 {
        // Outward is away from the closest point when outside, towards it when inside; on the skin
        // itself only the normal can tell.
        let outward = if d.abs() > 1e-3 {
            (p - hit.point) / d
        } else {
            self.surface.smooth_normal(hit.triangle, hit.bary)
        };
        let mut moved = hit.point + outward * (height + CLEAR);
        // In a crease the way out of one side may lead into the other: twice more is enough for the
        // creases heads have, and the laws count what is left.
        // The triangle that it came to is near, which makes each look a short one.
        let beside = |moved: Vec3| {
            let next = self.foot(moved, &mut hit.triangle.clone())?;
            Some((self.height_over(moved, &next), next))
        };
        if !self.looked(0) {
            return moved;
        }
        let mut next = beside(moved);
        for _ in 0..3 {
            match next {
                Some((d, hit)) if d < height => {
                    if !self.looked(1) {
                        return moved;
                    }
                    let normal = self.surface.smooth_normal(hit.triangle, hit.bary);
                    moved += normal * (height - d + CLEAR);
                    next = beside(moved);
                }
                _ => return moved,
            }
        }
        match next {
            Some((d, _)) if d < height => {
                self.escape(moved, self.surface.smooth_normal(hit.triangle, hit.bary), height)
            }
            _ => moved,
        }
    }

    /// The way out of a place whose walls face each other (a mouth, an eye, behind an ear, a fold): to the first place in the
    /// open round about, nearest first, and among equally near ones where `way` points.
    pub(super) fn escape(&self, p: Vec3, way: Vec3, height: f32) -> Vec3 {
        let mut ways: Vec<Vec3> = round_about().collect();
        ways.sort_by(|a, b| b.dot(way).total_cmp(&a.dot(way)));
        ways.insert(0, way);
        let hopeless = self.patience.is_some_and(Patience::is_hopeless);
        if !hopeless && !self.looked(ways.len()) {
            return p;
        }
        // Free and in a mouth is no way out: from where it ends, it must lead on into the open. Beyond the last skin on each way
        // it does; one look back from far off tells where that is, however many folds lie between.
        const FAR: f32 = 3.0 * ESCAPE;
        let last_skin = |way: &Vec3| -> f32 {
            let back = self.surface.ray(p + *way * FAR, -*way, FAR);
            back.map_or(0.0, |hit| FAR - hit.distance)
        };
        // On each way, where it opens, once somebody asks; up to where nothing can be free, for distances grow by no more than the way
        // does; and what is nearest there.
        struct Way {
            along: Vec3,
            opens: Option<f32>,
            busy: f32,
            near: Option<u32>,
        }
        let new = |along| Way { along, opens: None, busy: 0.0, near: None };
        let mut ways: Vec<Way> = ways.into_iter().map(new).collect();
        let opens = |way: &mut Way| *way.opens.get_or_insert_with(|| last_skin(&way.along));
        let mut shut = None;
        let deep = self.exact(p).map_or(0.0, |(d, _)| height - d);
        let mut reach = (height.max(0.0) + CLEAR).max(0.999 * deep);
        while reach < ESCAPE {
            for way in &mut ways {
                if reach < way.busy || (shut.is_some() && reach <= opens(way)) {
                    continue;
                }
                if !self.looked(1) {
                    return shut.unwrap_or(p);
                }
                let out = p + way.along * reach;
                let Some((d, hit)) = self.exact_from(out, way.near) else { continue };
                way.near = Some(hit.triangle);
                if d < height {
                    way.busy = reach + 0.999 * (height - d);
                } else if hopeless || reach > opens(way) {
                    if reach > FAR_OUT {
                        self.patience.inspect(|patience| patience.note_shut());
                    }
                    return out;
                } else {
                    shut = shut.or(Some(out));
                }
            }
            if shut.is_some() && ways.iter_mut().all(|way| opens(way) >= ESCAPE) {
                break;
            }
            reach = (reach * 1.5).max(0.01);
        }
        self.patience.inspect(|patience| patience.note_shut());
        shut.unwrap_or(p)
    }
}

/// How far a way out is looked for, cm: as wide as a head.
const ESCAPE: f32 = 20.0;
/// A way out that is longer than this, cm, is none to speak of: deeper than a mouth.
const FAR_OUT: f32 = 6.0;
