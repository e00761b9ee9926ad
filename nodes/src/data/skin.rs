//! The skin of a head: what keeps hair out of it.
//!
//! Guarantees: the same answers on every machine and in any order of queries; searches for a way out are bounded by a
//! [`Patience`] where one is given. On a wide mesh each point is computed directly, since points rarely share a cell of the
//! field. What is strewn or tangled ([`Rough`]) has no inside: every point is outside.

use super::patience::Patience;
use super::rough::Rough;
use crate::maths::closest::{Hit, Surface};
use crate::maths::distance_field::{Depth, DistanceField};
use crate::maths::drawn_span::DrawnSpan;
use crate::maths::horizon::View;
use glam::Vec3;

/// The skin of a head: what keeps hair out of it.
#[derive(Clone, Copy)]
pub struct Skin<'a> {
    pub(super) surface: &'a Surface,
    pub(super) field: &'a DistanceField,
    pub(super) rough: Option<Rough>,
    pub(super) patience: Option<&'a Patience>,
}

/// Distance from the skin, cm, below which [`Skin::distance`] queries the surface itself.
const EXACT: f32 = 0.1;
impl<'a> Skin<'a> {
    /// The skin of a surface and its distance field.
    pub(super) fn new(
        surface: &'a Surface,
        field: &'a DistanceField,
        rough: Option<Rough>,
    ) -> Self {
        Self { surface, field, rough, patience: None }
    }

    /// The same, with bounded searches for a way out: once the budget is spent, points in the skin move to its nearest side,
    /// which in a crease may be the wrong one.
    pub fn within<'b>(self, patience: &'b Patience) -> Skin<'b>
    where
        'a: 'b,
    {
        Skin { patience: Some(patience), ..self }
    }

    /// The skin for hair by the thousand; `None` where there is no clear inside, because keeping hair out of it would take many
    /// times as long as growing it. Guides are few and use it all the same.
    pub fn for_hair(self) -> Option<Self> {
        self.has_clear_inside().then_some(self)
    }

    /// Whether the mesh has a clear inside: it is not rough, or merely wide.
    pub fn has_clear_inside(&self) -> bool {
        matches!(self.rough, None | Some(Rough::Wide))
    }

    /// Spends queries of a search; returns whether any remain. Always false among folds, where the way out of one leads into the
    /// next.
    pub(super) fn looked(&self, looks: usize) -> bool {
        self.has_clear_inside()
            && self.patience.is_none_or(|patience| {
                patience.take(looks as u64);
                patience.left() > 0
            })
    }

    /// Remaining queries of a search.
    pub(super) fn patience(&self) -> usize {
        self.patience.map_or(usize::MAX, |patience| patience.left() as usize)
    }

    /// Whether nothing has an inside, on strewn and tangled meshes: no point is in the skin.
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

    /// Whether the mesh is [`Rough`]: hair is not routed around it.
    pub fn is_rough(&self) -> bool {
        self.rough.is_some()
    }

    /// Whether hairs are so far apart, or searches for the nearest triangle so long, that cells of the field do not pay. Then a
    /// query also tests few triangles, so that the cost per hair is bounded on any mesh.
    pub(crate) fn asks_alone(&self) -> bool {
        self.rough.is_some_and(|rough| rough != Rough::Folded)
    }

    /// Signed distance of `p` from the skin by the field, cm: within 0.02 cm where the skin is smooth, off by up to 0.1 at
    /// creases, +-1 beyond the field's band. Cheap; for callers with a margin.
    #[inline]
    pub fn about(&self, p: Vec3) -> f32 {
        self.roughly(p).map_or(1.0, |(d, ..)| d)
    }

    /// The scalp point closest to `p`: [`Surface::closest`], by what the field knows to be near.
    #[inline]
    pub fn closest(&self, p: Vec3) -> Option<Hit> {
        self.closest_from(p, None)
    }

    /// The same, where a triangle near `p` may be known.
    #[inline]
    pub(super) fn closest_from(&self, p: Vec3, near: Option<u32>) -> Option<Hit> {
        if let Some(hit) = self.closest_of_cell(p) {
            return Some(hit);
        }
        match near.or_else(|| self.field.hint(self.surface, p)) {
            Some(near) => self.surface.closest_from(p, near),
            None => self.surface.closest(p),
        }
    }

    /// [`Self::closest`] where the field knows what is near.
    #[inline]
    fn closest_of_cell(&self, p: Vec3) -> Option<Hit> {
        if self.asks_alone() { None } else { self.field.closest(self.surface, p) }
    }

    /// [`Self::closest`], or `None` if it is farther than `reach` (cm), which the field often rules out without a search.
    pub fn closest_within(&self, p: Vec3, reach: f32) -> Option<Hit> {
        if self.field.far(self.surface, p) > reach || self.stands_off(p, reach) {
            return None;
        }
        if let Some(hit) = self.closest_of_cell(p) {
            return (hit.distance <= reach).then_some(hit);
        }
        match self.field.hint(self.surface, p) {
            Some(near) => self.surface.closest_within_from(p, reach, near),
            None => self.surface.closest_within(p, reach),
        }
    }

    /// Whether the field alone shows that a ball is entirely outside the skin. False means unknown.
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

    /// Whether the field alone shows that `p` is more than `height` (cm) outside. False means unknown.
    #[inline]
    pub fn stands_off(&self, p: Vec3, height: f32) -> bool {
        if self.asks_alone() {
            return self.field.far(self.surface, p) > height.max(0.0);
        }
        self.bounds_nearby() && self.field.is_clear(self.surface, p, height.max(0.0))
    }

    /// A lower bound of the distance of `p` outside the skin (cm), from what [`Self::stands_off`] reads; 0 if unknown. The search ends once it
    /// exceeds `enough`.
    #[inline]
    pub(super) fn off_at_least(&self, p: Vec3, enough: f32) -> f32 {
        match (self.asks_alone(), self.bounds_nearby()) {
            (true, _) => self.field.far(self.surface, p),
            (false, true) => self.field.off_at_least(self.surface, p, enough),
            (false, false) => 0.0,
        }
    }

    /// What a hair sees from its root on a triangle, the value of its attribute; `None` if it is not rooted there, or on a rough mesh.
    #[inline]
    pub(crate) fn view_from(&self, root: Vec3, triangle: i32) -> Option<View> {
        if !self.parts_air() {
            return None;
        }
        self.field.view_from(self.surface, root, u32::try_from(triangle).ok()?)
    }

    /// Whether a span, in this ball, is far from the skin or higher than all skin beside it. False means unknown.
    #[inline]
    pub(crate) fn is_over(&self, span: &DrawnSpan, ball: (Vec3, f32)) -> bool {
        self.parts_air() && self.field.is_over(self.surface, span, ball)
    }

    /// Whether air that is outside in one place is outside wherever no skin lies between.
    fn parts_air(&self) -> bool {
        !self.is_rough() && self.surface.parts_in_from_out()
    }

    /// Whether distances of the field bound those nearby.
    fn bounds_nearby(&self) -> bool {
        self.rough.is_some() || self.surface.parts_in_from_out()
    }

    /// Radius (cm) of a ball around `p` that holds no skin: its distance outside, at most the field's band without a search; 0
    /// inside.
    pub fn clear_about(&self, p: Vec3) -> f32 {
        if self.surface.parts_in_from_out() && self.field.is_beyond(self.surface, p) {
            return self.field.band();
        }
        self.exact(p).map_or(0.0, |(d, _)| d.max(0.0))
    }

    /// What the field alone knows about `p`: distance, direction outward (zero where unknown) and the possible error; `None`
    /// beyond the field's band outside. A tenth of the cost of an exact answer, for hair by the million.
    #[inline]
    pub fn roughly(&self, p: Vec3) -> Option<(f32, Vec3, f32)> {
        self.by_the_field(|| self.field.depth(self.surface, p))
    }

    /// [`Self::roughly`] with the [finer error](DistanceField::fine_depth) of the distance.
    #[inline]
    pub(super) fn finely(&self, p: Vec3) -> Option<(f32, Vec3, f32)> {
        self.by_the_field(|| self.field.fine_depth(self.surface, p))
    }

    /// Errors of [`Self::finely`] up to this (cm) are those of smooth skin.
    #[inline]
    pub(super) fn smooth_error(&self) -> f32 {
        self.field.fine()
    }

    #[inline]
    fn by_the_field(&self, depth: impl Fn() -> Depth) -> Option<(f32, Vec3, f32)> {
        if self.has_no_inside() {
            return None;
        }
        match depth() {
            Depth::Near(d, gradient, doubt) => Some((d, gradient, doubt)),
            Depth::Inside => Some((-1.0, Vec3::ZERO, 1.0)),
            Depth::Outside => None,
        }
    }

    pub(super) fn exact(&self, p: Vec3) -> Option<(f32, Hit)> {
        self.exact_from(p, None)
    }

    /// [`Self::exact`], faster if a triangle near `p` is known.
    pub(super) fn exact_from(&self, p: Vec3, near: Option<u32>) -> Option<(f32, Hit)> {
        let hit = match near {
            _ if self.has_no_inside() => None,
            _ if self.asks_alone() => {
                let near = near.or_else(|| self.field.hint(self.surface, p));
                self.surface.closest_of_few(p, near)
            }
            near => self.closest_from(p, near),
        }?;
        Some((self.height_over(p, &hit), hit))
    }

    /// The closest point of the skin to `p`, for callers that walk over the scalp; `near`, a triangle near it, is updated to the
    /// nearest. Without a clear inside it is a close point, found at bounded cost. `None` on an empty mesh or if `p` is not
    /// finite.
    #[inline]
    pub fn foot(&self, p: Vec3, near: &mut u32) -> Option<Hit> {
        if self.surface.triangles.is_empty() {
            return None;
        }
        let hit = match self.has_clear_inside() {
            true => self.closest_from(p, Some(*near)),
            false => self.surface.closest_of_few(p, Some(*near)),
        }?;
        *near = hit.triangle;
        Some(hit)
    }

    /// The smooth unit normal at a point of the skin.
    #[inline]
    pub fn smooth_normal(&self, hit: &Hit) -> Vec3 {
        self.surface.smooth_normal(hit.triangle, hit.bary)
    }

    /// The distance of `p` from its closest point `hit`, cm, negative inside. Without a clear inside, the side is judged at that
    /// point alone, since rays would hit the next fold.
    #[inline]
    pub fn height_over(&self, p: Vec3, hit: &Hit) -> f32 {
        match self.has_clear_inside() {
            true => self.surface.signed_distance(p, hit),
            false => self.surface.distance_by_side(p, hit),
        }
    }
}
