//! Centres of clumps: the curve that each hair is drawn to.
//!
//! The centre of a clump is one of its own hairs, the first in its tuft, moved to the clump's place; or a given curve. Membership
//! depends on a hair's root or attribute alone, and a tuft reads no other: so more hair, which is added after existing hair,
//! changes no clump, and an edit changes none in other tufts. Clumps never cross a parting.

use super::seeds::Seeds;
use crate::data::attributes::{PARENT, SCALP_NORMAL};
use crate::data::curves::{AttributeView, Tuft};
use crate::data::route::bundle::{Hairs, Wish};
use crate::data::scalp::{HeadFrame, Scalp};
use crate::maths::lanes::sin_cos as sin_cos_each;
use crate::maths::lanes::{Eight, LANES, Simd, Vec3x8, f32x8, ops::*};
use crate::maths::nearest::KdTree;
use crate::maths::spline::Spline;
use glam::Vec3;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The curve that the hair of one clump is drawn to.
struct Middle {
    way: Spline,
    /// Offset from the curve to the clump, cm.
    shift: Vec3,
}

/// The centres for the hair of a tuft.
pub(super) struct Middles {
    all: Vec<Middle>,
    /// Index of the centre of each hair.
    of: Vec<Option<u32>>,
}

/// Section of the scalp that a root lies in, which separates clumps.
fn section(scalp: Option<&Scalp>, root: Vec3) -> Option<u64> {
    scalp?.sections()?.id_at(root)
}

/// Given curves, searched by nearest root and by id.
pub(super) struct Given {
    tree: KdTree,
    by_id: BTreeMap<u64, u32>,
}

/// Number of nearest curves among which one in the hair's section is searched.
const NEAR: usize = 4;

impl Given {
    /// Curves, one per tuft.
    pub(super) fn new<'a>(tufts: impl Iterator<Item = &'a Tuft> + Clone) -> Self {
        let root = |tuft: &Tuft| tuft.points().first().copied().unwrap_or(Vec3::NAN);
        let mut by_id = BTreeMap::new();
        for (n, tuft) in (0..).zip(tufts.clone()).filter(|(_, tuft)| !tuft.is_empty()) {
            by_id.entry(tuft.id(0)).or_insert(n);
        }
        Self { tree: KdTree::new(tufts.map(root)), by_id }
    }
    /// Indices of the curves whose ids an attribute of a tuft names, in order.
    pub(super) fn named(&self, tuft: &Tuft, name: &str) -> Vec<u32> {
        let Some(keys) = keys(tuft, name) else { return vec![] };
        let mut named: Vec<u32> =
            (0..tuft.len()).filter_map(|i| self.by_id.get(&keys(i)?).copied()).collect();
        named.sort_unstable();
        named.dedup();
        named
    }
    /// Indices of the curves that a tuft's hair may be drawn to, in order.
    pub(super) fn near(&self, tuft: &Tuft) -> Vec<u32> {
        let roots: Vec<Vec3> =
            (0..tuft.len()).filter_map(|i| tuft.curve(i).first().copied()).collect();
        let mut near = vec![];
        self.tree.find_each(&roots, NEAR, |_, found| near.extend(found.iter().map(|one| one.1)));
        near.sort_unstable();
        near.dedup();
        near
    }
}

impl Middles {
    /// For each hair, the nearest of these curves (one per tuft) in its own section.
    pub(super) fn given(tuft: &Tuft, curves: &[&Tuft], scalp: Option<&Scalp>) -> Self {
        let mut all = vec![];
        let mut roots = vec![];
        for curve in curves {
            if let Ok(way) = Spline::new(curve.curve(0)) {
                let root = curve.curve(0)[0];
                roots.push((root, section(scalp, root)));
                all.push(Middle { way, shift: Vec3::ZERO });
            }
        }
        let tree = KdTree::new(roots.iter().map(|(root, _)| *root));
        let mut found = vec![];
        let mut nearest = |i: usize| {
            let root = *tuft.curve(i).first()?;
            let own = section(scalp, root);
            tree.find(root, NEAR, &mut found);
            let at_home = found.iter().find(|(_, n)| roots[*n as usize].1 == own);
            at_home.map(|(_, n)| *n)
        };
        let of = (0..tuft.len()).map(&mut nearest).collect();
        Self { all, of }
    }

    /// The curve whose id an attribute of the hair names.
    pub(super) fn named(tuft: &Tuft, name: &str, curves: &[&Tuft]) -> Option<Self> {
        let keys = keys(tuft, name)?;
        let mut all = vec![];
        let mut numbers = BTreeMap::new();
        for curve in curves {
            if let Ok(way) = Spline::new(curve.curve(0)) {
                numbers.entry(curve.id(0)).or_insert(all.len() as u32);
                all.push(Middle { way, shift: Vec3::ZERO });
            }
        }
        let of = (0..tuft.len()).map(|i| numbers.get(&keys(i)?).copied()).collect();
        Some(Self { all, of })
    }

    /// Clumps of hairs with the same value of an attribute; hairs without a value are in none. `None` if the tuft lacks the
    /// attribute.
    pub(super) fn alike(tuft: &Tuft, name: &str, scalp: Option<&Scalp>) -> Option<Self> {
        let keys = keys(tuft, name)?;
        Some(Self::grouped(tuft, scalp, |i| Some((keys(i)?, None))))
    }

    /// Clumps of hairs that belong to the same seed, moved to its place; `frame` is the space of the seeds.
    pub(super) fn strewn(
        tuft: &Tuft,
        seeds: &Seeds,
        frame: Option<&HeadFrame>,
        scalp: Option<&Scalp>,
    ) -> Self {
        let frame = frame.unwrap_or(&HeadFrame::IDENTITY);
        let mut seeds = seeds.kept();
        Self::grouped(tuft, scalp, |i| {
            let root = *tuft.curve(i).first().filter(|root| root.is_finite())?;
            let seed = seeds.nearest(frame.head_from_vector(root - frame.origin));
            Some((seed.key, Some(frame.origin + frame.vector_from_head(seed.at))))
        })
    }

    /// Clumps of hairs with the same key and section, and the place of each key.
    fn grouped(
        tuft: &Tuft,
        scalp: Option<&Scalp>,
        mut key: impl FnMut(usize) -> Option<(u64, Option<Vec3>)>,
    ) -> Self {
        let mut groups = BTreeMap::new();
        let mut all = vec![];
        let mut of = Vec::with_capacity(tuft.len());
        for i in 0..tuft.len() {
            let found = key(i).and_then(|(key, place)| {
                let root = tuft.curve(i)[..].first()?;
                match groups.entry((key, section(scalp, *root))) {
                    Entry::Occupied(known) => Some(*known.get()),
                    Entry::Vacant(new) => {
                        let way = Spline::new(tuft.curve(i)).ok()?;
                        let shift = place.map_or(Vec3::ZERO, |at| shift(tuft, i, at, scalp));
                        all.push(Middle { way, shift });
                        Some(*new.insert(all.len() as u32 - 1))
                    }
                }
            });
            of.push(found);
        }
        Self { all, of }
    }

    /// Draws hairs to their centres at the same distance from the root: at each point by `strength` (0 to 1), rotated about it by
    /// `twist` radians at full strength. Past the end of its centre, a hair keeps its own shape.
    #[inline(always)]
    pub(super) fn draw<S: Simd>(
        &self,
        hairs: &Hairs<S>,
        wish: &mut Wish<S>,
        strength: &[Eight],
        twist: f32,
    ) {
        let s = hairs.s;
        let of = hairs.numbers.map(|i| self.of[i]);
        let Some(some) = of.iter().flatten().next() else { return };
        let middles = of.map(|n| &self.all[n.unwrap_or(*some) as usize]);
        let ways = middles.map(|middle| &middle.way);
        let has = s.load_array_f32x8(of.map(|n| f32::from(n.is_some()))).simd_gt(0.0);
        let mut shift = [Eight::default(); 3];
        for (i, middle) in middles.iter().enumerate() {
            [shift[0].0[i], shift[1].0[i], shift[2].0[i]] = middle.shift.to_array();
        }
        let shift = Vec3x8::load(s, &shift);
        let lengths = s.load_array_f32x8(ways.map(Spline::length));
        // The point of each hair at the length of its centre, if it is longer.
        let mut ends = [Eight::default(); 3];
        for (i, way) in ways.iter().enumerate() {
            let length = way.length();
            if hairs.come_of_lane(hairs.len() - 1, i) > length {
                let at = hairs.at(i, length);
                [ends[0].0[i], ends[1].0[i], ends[2].0[i]] = at.to_array();
            }
        }
        let ends = Vec3x8::load(s, &ends);
        let mut cursors = [0; LANES];
        for (k, drawn) in strength.iter().enumerate().take(hairs.len()).skip(1) {
            let (drawn, come) = (drawn.get(s), hairs.come(k));
            let draws = has & !drawn.simd_le(0.0);
            if s.all_false_mask32x8(draws) {
                continue;
            }
            let mut subs = [0; LANES];
            for (i, sub) in subs.iter_mut().enumerate() {
                *sub = ways[i].part_rising(&mut cursors[i], hairs.come_of_lane(k, i));
            }
            let (on, t) = Spline::points_in(&ways, &subs, come);
            let middle = on + shift;
            let beyond = middle + (hairs.point(k) - ends);
            let middle = Vec3x8::pick(come.simd_gt(lengths), beyond, middle);
            let p = wish.get(k);
            let mut off = p - middle;
            if twist != 0.0 {
                let (mut axis, t) = ([Eight::default(); 3], s.as_array_f32x8(t));
                for i in 0..LANES {
                    let tangent = ways[i].tangent(Spline::place_in(subs[i], t[i]));
                    [axis[0].0[i], axis[1].0[i], axis[2].0[i]] = tangent.to_array();
                }
                off = turned(off, Vec3x8::load(s, &axis), drawn * twist);
            }
            wish.set(k, Vec3x8::pick(draws, middle + off * (1.0 - drawn), p));
        }
    }
}

/// The attribute of each curve as bits; `None` for the id 0 or a negative number.
fn keys<'a>(tuft: &'a Tuft, name: &str) -> Option<impl Fn(usize) -> Option<u64> + 'a> {
    enum Keys<'a> {
        Id(AttributeView<'a, u64>),
        Whole(AttributeView<'a, i32>),
        Number(AttributeView<'a, f32>),
    }
    let keys = if let Some(view) = tuft.view_named::<u64>(name) {
        Keys::Id(view)
    } else if let Some(view) = tuft.view_named::<i32>(name) {
        Keys::Whole(view)
    } else if let Some(view) = tuft.view_named::<f32>(name) {
        Keys::Number(view)
    } else if name == PARENT.name {
        Keys::Id(AttributeView::Shared(PARENT.default))
    } else {
        return None;
    };
    Some(move |i: usize| {
        let first = tuft.range(i).start;
        if tuft.range(i).is_empty() {
            return None;
        }
        match &keys {
            Keys::Id(view) => Some(view.at(i, first)).filter(|id| *id != 0),
            Keys::Whole(view) => u64::try_from(view.at(i, first)).ok(),
            Keys::Number(view) => {
                Some(view.at(i, first)).filter(|x| *x >= 0.0).map(|x| u64::from(x.to_bits()))
            }
        }
    })
}

/// From the root of a curve to the place of its clump, tangent to the skin, or perpendicular to the curve where the normal is
/// unknown. `None` where that leads into another section.
fn shift(tuft: &Tuft, i: usize, place: Vec3, scalp: Option<&Scalp>) -> Vec3 {
    let root = tuft.curve(i)[0];
    let skin = scalp.and_then(|scalp| {
        let hit = scalp.skin().closest(root)?;
        Some(scalp.surface().smooth_normal(hit.triangle, hit.bary))
    });
    let own = || tuft.view(SCALP_NORMAL).at(i, tuft.range(i).start).try_normalize();
    let along = || tuft.curve(i).windows(2).find_map(|w| (w[1] - w[0]).try_normalize());
    let Some(out) = skin.or_else(own).or_else(along) else { return Vec3::ZERO };
    let shift = (place - root).reject_from_normalized(out);
    let leaves = section(scalp, root + shift) != section(scalp, root);
    if leaves || !shift.is_finite() { Vec3::ZERO } else { shift }
}

/// `v` rotated about a unit axis, by Rodrigues' formula.
#[inline(always)]
fn turned<S: Simd>(v: Vec3x8<S>, axis: Vec3x8<S>, radians: f32x8<S>) -> Vec3x8<S> {
    let (sin, cos) = sin_cos_each(radians);
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}
