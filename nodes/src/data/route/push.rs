//! Single points set out of the skin.
//!
//! Guarantees: a point ends no lower than asked, as far as the skin's patience goes, and what lies high enough stays where it is, to the
//! last bit. Not promised: anything of the hair that the points belong to; a whole one is set clear by `skin_clear.rs`.

use crate::data::patience::Patience;
use crate::data::skin::Skin;
use crate::maths::closest::Hit;
use crate::maths::distance_field::Depth;
use crate::maths::frame::round_about;
use glam::Vec3;

/// How far outside the allowed depth a pushed point is put, cm: beyond the rounding of coordinates
/// of a few tens of cm.
const CLEAR: f32 = 1e-4;
/// How far over the skin deep points are put before they are set down on it, cm: beyond what the field errs by where
/// the skin is smooth.
const OVERSHOOT: f32 = 0.03;

/// How far a way out is looked for, cm: as wide as a head.
const ESCAPE: f32 = 20.0;
/// A way out that is longer than this, cm, is none to speak of: deeper than a mouth.
const FAR_OUT: f32 = 6.0;

impl Skin<'_> {
    /// `p`, or the nearest point not deeper than `allow_depth` (cm, 0 = the skin itself) when it lies deeper.
    /// The second value tells whether it was moved.
    #[inline]
    pub(in crate::data) fn push_out(&self, p: Vec3, allow_depth: f32) -> (Vec3, bool) {
        self.raise(p, -allow_depth)
    }

    /// [`Self::push_out`] to a height (cm) over the skin instead of a depth under it.
    #[inline]
    pub(in crate::data) fn lift(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        self.raise(p, height)
    }

    /// [`Self::lift`] of all that [`Self::distance`] tells to be lower: beside ears and among folds the field alone may pass over a
    /// thin wall, and what is put out of one may end in another. Where the skin is near it costs a search more.
    pub(in crate::data) fn lift_exactly(&self, p: Vec3, height: f32) -> (Vec3, bool) {
        const AGAIN: usize = 4;
        let (mut at, mut moved) = self.lift(p, height);
        for _ in 0..AGAIN {
            if self.stands_off(at, height) || self.distance(at) >= height {
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
    pub(in crate::data) fn lift_about(&self, p: Vec3, height: f32) -> Vec3 {
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
                match self.closest(near) {
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
    pub(in crate::data) fn raise_alone(
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
    pub(in crate::data) fn escape(&self, p: Vec3, way: Vec3, height: f32) -> Vec3 {
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
