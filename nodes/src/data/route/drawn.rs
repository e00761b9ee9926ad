//! The skin and the curve that is drawn through a hair's points, which may dip into it between two points that lie outside.
//!
//! The curve is the one that files say and all readers draw: a uniform Catmull-Rom spline with pinned ends. How deep it may lie is
//! taken as linear from point to point.
//!
//! Guarantees: [`Skin::dips`] finds what lies deeper than [`DIP`] beyond that, but for what is narrower than a hundredth of a cm;
//! spans that the field shows to be outside cost a look or two. [`Skin::clear_drawn`] moves points that may move, and no others, until
//! nothing dips or its rounds are over. On a rough mesh nothing is looked for. Not promised: that there is a way out; whoever must know
//! asks again.

use crate::data::skin::Skin;
use crate::maths::closest::Hit;
use crate::maths::drawn_span::DrawnSpan;
use crate::maths::frame::any_normal;
use glam::Vec3;

/// Depth (cm) of the drawn curve beyond the allowed one that is let pass.
pub(crate) const DIP: f32 = 0.004;
/// How far outside a dip is put, cm.
const CLEAR: f32 = 0.002;
/// Samples of a span are so far apart at most, cm; where the skin bends between two, they are halved so often.
const STEP: f32 = 0.2;
const HALVINGS: usize = 5;
/// Largest number of samples of a span before halving.
const MOST: f32 = 256.0;
/// Rounds in which points are moved, and by how much more each moves them than the one before.
const ROUNDS: usize = 12;
const GROWTH: f32 = 0.3;
/// A way out that runs along the hair by more than this (cosine) leads through a thin part, and not off it.
const ALONG: f32 = 0.8;
/// How far the edge of a thin part is looked for, in steps, cm.
const FARTHEST: f32 = 3.0;
const ASIDE: f32 = 0.1;

/// Where the curve of a span lies deepest beyond what it may.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dip {
    /// The span: from this point to the next.
    pub(crate) span: usize,
    /// The place in it, 0 to 1.
    pub(crate) t: f32,
    /// There, cm.
    pub(crate) at: Vec3,
    /// Depth beyond the allowed one, cm.
    pub(crate) excess: f32,
    /// The way out, a unit vector.
    way: Vec3,
}

impl Dip {
    /// The way out of it, cm.
    pub(crate) fn way_out(&self) -> Vec3 {
        self.way * (self.excess + CLEAR)
    }
}

/// A place of a span, and what the skin says there.
#[derive(Clone, Copy)]
pub(crate) struct SkinSample {
    t: f32,
    /// There, cm.
    pub(crate) at: Vec3,
    /// The distance from the skin, cm, negative inside; no more than it is where the field alone has told it.
    pub(crate) distance: f32,
    /// Depth beyond the allowed one, cm; negative where it is allowed.
    pub(crate) excess: f32,
    /// The way to the outside of the nearest skin, a unit vector, where that was looked for.
    way: Option<Vec3>,
}

impl SkinSample {
    fn worse(self, other: Self) -> Self {
        if other.excess > self.excess { other } else { self }
    }
}

impl Skin<'_> {
    /// The deepest place of each span that dips, of those that are `asked`; `depth` says how deep (cm) each point may lie.
    pub(crate) fn dips(
        &self,
        points: &[Vec3],
        asked: impl Fn(usize) -> bool,
        depth: impl Fn(usize) -> f32,
        mut found: impl FnMut(Dip),
    ) {
        if self.is_rough() || points.len() < 2 {
            return;
        }
        // The sample at the end of a span is that at the start of the next.
        let (mut near, mut start) = (None, None);
        for k in 0..points.len() - 1 {
            if !asked(k) {
                start = None;
            } else if let Some(dip) =
                self.dip(points, k, [depth(k), depth(k + 1)], &mut near, &mut start)
            {
                found(dip);
            }
        }
    }

    /// Whether any span of a curve dips.
    pub(crate) fn has_dip(&self, points: &[Vec3], depth: impl Fn(usize) -> f32) -> bool {
        let mut any = false;
        self.dips(points, |_| true, depth, |_| any = true);
        any
    }

    /// The deepest place of span `k`, if it dips.
    fn dip(
        &self,
        points: &[Vec3],
        k: usize,
        allowed: [f32; 2],
        near: &mut Option<u32>,
        start: &mut Option<SkinSample>,
    ) -> Option<Dip> {
        let deepest = self.deepest_from(&DrawnSpan::of(points, k), allowed, near, start)?;
        let SkinSample { t, at, excess, way, .. } = deepest;
        Some(Dip { span: k, t, at, excess, way: way.filter(|_| excess > DIP)? })
    }

    /// The place of a span that lies deepest beyond what its ends are allowed (cm); none where the field shows it all to be outside.
    pub(crate) fn deepest(
        &self,
        span: &DrawnSpan,
        allowed: [f32; 2],
        near: &mut Option<u32>,
    ) -> Option<SkinSample> {
        self.deepest_from(span, allowed, near, &mut None)
    }

    /// [`Self::deepest`], given the sample at the span's `start` if it is known. On return, `start` is that of the next span.
    fn deepest_from(
        &self,
        span: &DrawnSpan,
        allowed: [f32; 2],
        near: &mut Option<u32>,
        start: &mut Option<SkinSample>,
    ) -> Option<SkinSample> {
        let first = start.take();
        let (middle, radius) = span.ball();
        let is_off = self.is_over(span, (middle, radius)) || self.stands_off(middle, radius);
        if is_off || self.is_clear(middle, radius) {
            return None;
        }
        let mut sample = |t: f32| self.sample(span, t, allowed, near);
        let mut worst = first.unwrap_or_else(|| sample(0.0));
        let last = sample(1.0);
        *start = Some(SkinSample { t: 0.0, ..last });
        // Most spans near the skin are farther from it than they are long.
        reaches(&worst, &last, span.leaves_chord(1.0))?;
        let count = (2.0 * radius / STEP).ceil().clamp(2.0, MOST);
        let mut before = worst;
        for n in 1..=count as usize {
            let here = if n == count as usize { last } else { sample(n as f32 / count) };
            let mut halves = [(before, here, 0); 2 + HALVINGS];
            let mut open = 1;
            while open > 0 {
                open -= 1;
                let (a, b, halved) = halves[open];
                let bar = if worst.excess > DIP { worst.excess + 0.25 * DIP } else { DIP };
                let reach = reaches(&a, &b, span.leaves_chord(b.t - a.t));
                if halved == HALVINGS || reach.is_none_or(|reach| reach <= bar) {
                    continue;
                }
                let middle = sample((a.t + b.t) * 0.5);
                worst = worst.worse(middle);
                halves[open] = (a, middle, halved + 1);
                halves[open + 1] = (middle, b, halved + 1);
                open += 2;
            }
            worst = worst.worse(here);
            before = here;
        }
        Some(worst)
    }

    /// A sample, by the field alone where that shows it to be outside.
    fn sample(
        &self,
        span: &DrawnSpan,
        t: f32,
        [from, to]: [f32; 2],
        near: &mut Option<u32>,
    ) -> SkinSample {
        let at = span.at(t);
        let may = (from + (to - from) * t).max(0.0);
        let told =
            |distance: f32, way| SkinSample { t, at, distance, excess: -distance - may, way };
        match self.finely(at) {
            None => return told(1.0, None),
            Some((d, gradient, error)) if d - error + may > 0.0 => {
                let is_smooth = error <= self.smooth_error();
                return told(d - error, is_smooth.then(|| gradient.normalize_or_zero()));
            }
            Some(_) => {}
        }
        let Some((distance, hit)) = self.exact_from(at, *near) else { return told(1.0, None) };
        *near = Some(hit.triangle);
        told(distance, Some(self.way_from(at, distance, &hit)))
    }

    /// The way to the outside of the nearest skin.
    fn way_from(&self, p: Vec3, distance: f32, hit: &Hit) -> Vec3 {
        match distance.abs() > 1e-3 {
            true => (p - hit.point) / distance,
            // That of the face: a smooth normal would hide a ridge beside it.
            false => self.surface.face_normal(hit.triangle),
        }
    }

    /// Moves points that `may` be moved until no span with one of them dips. `depth` says how deep (cm) each point may lie. Tells
    /// whether any was moved.
    pub(in crate::data) fn clear_drawn(
        &self,
        points: &mut [Vec3],
        may: impl Fn(usize) -> bool,
        depth: impl Fn(usize) -> f32,
    ) -> bool {
        self.clear_drawn_where(points, may, depth, |_, _| false)
    }

    /// [`Self::clear_drawn`] that skips spans for which `is_clear` holds while no point has moved.
    pub(super) fn clear_drawn_where(
        &self,
        points: &mut [Vec3],
        may: impl Fn(usize) -> bool,
        depth: impl Fn(usize) -> f32,
        is_clear: impl Fn(&[Vec3], usize) -> bool,
    ) -> bool {
        if self.is_rough() {
            return false;
        }
        let n = points.len();
        // By which round each point was moved last.
        let mut touched: Vec<usize> = vec![];
        let mut dips = vec![];
        for round in 1..=ROUNDS {
            let is_new = |k: usize| {
                round == 1 || (k.saturating_sub(1)..n.min(k + 3)).any(|k| touched[k] + 1 == round)
            };
            self.dips(
                points,
                |k| (may(k) || may(k + 1)) && is_new(k) && !(round == 1 && is_clear(points, k)),
                &depth,
                |dip| dips.push(dip),
            );
            if dips.is_empty() {
                return round > 1;
            }
            touched.resize(n, 0);
            let mut moves = vec![Vec3::ZERO; n];
            for dip in dips.drain(..) {
                let span = DrawnSpan::of(points, dip.span);
                let way = self.way_off(&span, &dip) * (1.0 + GROWTH * (round - 1) as f32);
                let [_, a, b, _] = DrawnSpan::weights(dip.t);
                let shares = [(dip.span, a), (dip.span + 1, b)]
                    .map(|(k, w)| (k, if may(k) { w } else { 0.0 }));
                let all: f32 = shares.iter().map(|(_, w)| w * w).sum();
                for (k, share) in shares {
                    let by = way * (share / all.max(0.1));
                    if by.length_squared() > moves[k].length_squared() {
                        moves[k] = by;
                    }
                }
            }
            for (k, by) in moves.iter().enumerate().filter(|(_, by)| **by != Vec3::ZERO) {
                points[k] = self.push_out(points[k] + *by, depth(k)).0;
                touched[k] = round;
            }
        }
        true
    }

    /// The way that takes the curve off what it dips into, cm.
    fn way_off(&self, span: &DrawnSpan, dip: &Dip) -> Vec3 {
        let along = span.tangent(dip.t);
        let out = dip.way_out();
        if dip.way.dot(along).abs() < ALONG {
            return out;
        }
        let (across, other) = {
            let across = any_normal(along);
            (across, along.cross(across))
        };
        let mut best: Option<(f32, Vec3)> = None;
        for way in [across, -across, other, -other]
            .into_iter()
            .flat_map(|a| [a, (a + along.cross(a)).normalize_or_zero()])
        {
            let mut far = ASIDE;
            while far < best.map_or(FARTHEST, |(far, _)| far)
                && self.about(dip.at + way * far) < CLEAR
            {
                far += ASIDE;
            }
            if far < best.map_or(FARTHEST, |(far, _)| far) {
                best = Some((far, way));
            }
        }
        best.map_or(out, |(far, way)| way * far)
    }
}

/// How much deeper than allowed (cm) the curve, which leaves the straight line between two samples by no more than `aside` (cm), may lie
/// between them: the skin rises by no more than a ridge does whose two sides they lie on. `None` where it cannot meet the skin.
fn reaches(a: &SkinSample, b: &SkinSample, aside: f32) -> Option<f32> {
    let apart = a.at.distance(b.at);
    // What is farther off than the curve is long there is not met.
    if a.distance + b.distance > apart + 2.0 * aside {
        return None;
    }
    let rise = match (a.way, b.way) {
        (Some(one), Some(other)) => 0.25 * apart * one.distance(other),
        _ => 0.5 * apart,
    };
    Some(a.excess.max(b.excess) + aside + rise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::route::skin_clear::tests::{bust, hairs};

    /// How deep a curve lies, cm, by many samples of each span that none of these rules chose.
    fn deepest(skin: &Skin, points: &[Vec3]) -> f32 {
        let mut deepest = 0.0f32;
        for k in 0..points.len() - 1 {
            let span = DrawnSpan::of(points, k);
            let depths = (0..=60).map(|n| -skin.distance(span.at(n as f32 / 60.0)));
            deepest = depths.fold(deepest, f32::max);
        }
        deepest
    }

    /// Coarse hairs past the left ear of the built-in head, whose points all lie outside.
    fn coarse(skin: &Skin) -> Vec<Vec<Vec3>> {
        let coarse = |step: usize| {
            hairs().into_iter().map(move |hair| hair.into_iter().step_by(step).collect::<Vec<_>>())
        };
        let is_out = |hair: &Vec<Vec3>| hair.iter().all(|p| skin.distance(*p) > 0.0);
        [3, 4, 6, 9].into_iter().flat_map(coarse).filter(is_out).collect()
    }

    #[test]
    fn every_dip_is_found_and_led_out_and_nothing_else_moves() {
        let scalp = bust();
        let skin = scalp.skin();
        let (mut dipped, mut still, mut all) = (0, 0, 0);
        for mut hair in coarse(&skin) {
            let (was, deep) = (hair.clone(), deepest(&skin, &hair));
            let found = skin.has_dip(&hair, |_| 0.0);
            assert!(found || deep < DIP + 0.002, "{deep} cm deep, and not found");
            assert!(!found || deep > DIP - 0.002, "found where the curve is {deep} cm deep");
            let moved = skin.clear_drawn(&mut hair, |k| k > 0, |_| 0.0);
            assert_eq!((moved, hair != was), (found, found));
            assert_eq!(hair[0], was[0]);
            let left = deepest(&skin, &hair);
            all += 1;
            dipped += usize::from(found);
            still += usize::from(left > DIP + 0.002);
        }
        println!("{dipped} of {all} dip, {still} still do");
        assert!(dipped > 50 && still * 100 <= dipped, "{still} of {dipped} of {all}");
    }

    #[test]
    fn what_may_not_move_stays_and_allowed_depth_is_no_dip() {
        let scalp = bust();
        let skin = scalp.skin();
        let mut tried = 0;
        for mut hair in coarse(&skin) {
            let was = hair.clone();
            if !skin.has_dip(&hair, |_| 0.0) {
                continue;
            }
            assert!(!skin.has_dip(&hair, |_| 2.0));
            assert!(!skin.clear_drawn(&mut hair, |_| false, |_| 0.0) && hair == was);
            skin.clear_drawn(&mut hair, |k| k.is_multiple_of(2), |_| 0.0);
            assert!((0..hair.len()).all(|k| k.is_multiple_of(2) || hair[k] == was[k]));
            tried += 1;
        }
        assert!(tried > 50);
    }
}
