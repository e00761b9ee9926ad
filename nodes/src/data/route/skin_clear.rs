//! Whole hairs set clear of the skin: pushed out point by point, and led over the edge of what is thin.
//!
//! Pushing each point to the nearest skin tears a hair that passes through an ear: one point leaves it in front, the
//! next behind. Such a hair is led round the edge first, as it would hang in the world, and pushed then.
//!
//! Guarantees: the first point stays; every other ends where [`Skin::push_out`] lets it be; a hair that nothing tears comes
//! out as if each of its points had been pushed alone. Four ways aside are tried, each at most 3 cm long; where the least
//! torn of them is torn still, the hair is laid on the shortest way round (`shortest_path.rs`). Not promised: that there is one; past the
//! skin's patience, and on a rough mesh (`rough.rs`), none is looked for.

use super::shortest_path::way_round;
use crate::data::skin::Skin;
use glam::Vec3;

/// How far the edge of a thin part is looked for, cm: more than half an ear.
const FARTHEST: f32 = 3.0;
/// Step of that search, cm.
const STEP: f32 = 0.1;
/// How far beyond the edge a hair is led, cm.
const CLEARANCE: f32 = 0.15;
/// A hair begins to give way so many times as far from the edge, along itself, as it is led aside there.
const SOFTLY: f32 = 3.0;
/// When the skin has torn two neighbours apart: they have come to lie more than so many times as far from each other as
/// before, and so much farther (cm).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torn(f32, f32);

impl Torn {
    /// What anyone would see.
    pub(crate) const APART: Self = Self(1.5, 0.1);
    /// What makes chords uneven.
    pub(crate) const UNEVEN: Self = Self(1.1, 0.01);
}

/// So many points about which the field alone is asked cost as much as a look at the skin.
const CHEAP: usize = 8;
/// What a ball without skin is taken to be smaller by, cm, for what is rounded.
const SURE: f32 = 1e-3;
/// So deep (cm) in the skin between two points a hair passes through a thin part, if its points lie nearer than that.
const THROUGH: f32 = 0.08;
const ATTEMPTS: usize = 4;
/// So far (cm) along a hair to both sides of a tear what the skin has moved is laid anew.
const ABOUT: f32 = 2.0;
/// The most by which chords grow where a hair is laid on a longer way.
const CROWDED: f32 = 1.25;

impl Skin<'_> {
    /// Sets a hair clear of the skin, all but its first point. `depth` says how deep (cm) each may lie; none where a point
    /// is known to be clear. Tells whether any point was moved.
    pub(in crate::data) fn clear(
        &self,
        points: &mut [Vec3],
        depth: impl Fn(usize) -> Option<f32>,
    ) -> bool {
        self.clear_where(points, depth, |_, _| false)
    }

    /// [`Self::clear`] that skips points for which `is_clear` holds, unless the hair has to be led round something.
    pub(super) fn clear_where(
        &self,
        points: &mut [Vec3],
        depth: impl Fn(usize) -> Option<f32>,
        is_clear: impl Fn(&[Vec3], usize) -> bool,
    ) -> bool {
        self.clear_noting(points, depth, is_clear, |_, _, _| {})
    }

    /// [`Self::clear_where`] that notes what was found out about the air on a mesh where each point asks the skin alone: for which point, and
    /// the middle and the radius (cm) of a ball about it that holds no skin.
    pub(in crate::data) fn clear_noting(
        &self,
        points: &mut [Vec3],
        depth: impl Fn(usize) -> Option<f32>,
        is_clear: impl Fn(&[Vec3], usize) -> bool,
        note: impl FnMut(usize, Vec3, f32),
    ) -> bool {
        match self.asks_alone() {
            true => self.push_each(points, &depth, note),
            false => self.clear_led(Torn::APART, points, &depth, is_clear),
        }
    }

    /// [`Self::clear`] that leads round whatever tears the hair so far.
    pub(in crate::data) fn clear_beyond(
        &self,
        far: Torn,
        points: &mut [Vec3],
        depth: impl Fn(usize) -> Option<f32>,
    ) -> bool {
        match self.asks_alone() {
            true => self.push_each(points, &depth, |_, _, _| {}),
            false => self.clear_led(far, points, &depth, |_, _| false),
        }
    }

    fn clear_led(
        &self,
        far: Torn,
        points: &mut [Vec3],
        depth: &impl Fn(usize) -> Option<f32>,
        is_clear: impl Fn(&[Vec3], usize) -> bool,
    ) -> bool {
        // Where points were, for those that were moved.
        let mut was: Vec<(usize, Vec3)> = vec![];
        self.push_all(points, depth, &is_clear, &mut was);
        if was.is_empty() || self.is_rough() || !self.looked(0) {
            return !was.is_empty();
        }
        // The least torn so far.
        let mut best: Option<(f32, Vec<Vec3>, Vec<(usize, Vec3)>)> = None;
        for attempt in 0..=ATTEMPTS {
            let Some((excess, torn)) = self.tear(far, points, &was) else { return true };
            if best.as_ref().is_none_or(|(least, ..)| excess < *least) {
                best = Some((excess, points.to_vec(), was.clone()));
            }
            if attempt == ATTEMPTS || !self.looked(points.len() / CHEAP) {
                break;
            }
            let (a, b) = (points[torn - 1], points[torn]);
            for (k, p) in was.drain(..) {
                points[k] = p;
            }
            let along = (points[torn] - points[torn - 1]).normalize_or_zero();
            let through = (b - a).normalize_or_zero();
            let Some(aside) = self.way_out((a + b) * 0.5, through, along) else { break };
            give_way(points, torn, aside);
            // What was known of its points is so no more.
            self.push_all(points, &|k| depth(k).or(Some(0.0)), &|_, _| false, &mut was);
        }
        if let Some((_, best, best_was)) = best {
            points.copy_from_slice(&best);
            was = best_was;
        }
        for _ in 0..ATTEMPTS {
            let Some((_, torn)) = self.tear(Torn::APART, points, &was) else { break };
            if !self.looked(0) || !self.lay_round(points, torn, &mut was, depth) {
                break;
            }
        }
        true
    }

    /// Lays the points about a tear, as far as the skin has moved them, evenly on the way round what tore them.
    fn lay_round(
        &self,
        points: &mut [Vec3],
        torn: usize,
        was: &mut Vec<(usize, Vec3)>,
        depth: &impl Fn(usize) -> Option<f32>,
    ) -> bool {
        let moved = |k: usize| was.binary_search_by_key(&k, |(k, _)| *k).is_ok();
        let (mut first, mut come) = (torn - 1, 0.0);
        while first > 0 && moved(first) && come < ABOUT {
            come += points[first].distance(points[first - 1]);
            first -= 1;
        }
        let (mut last, mut come) = (torn, 0.0);
        while last + 1 < points.len() && moved(last) && come < ABOUT {
            come += points[last].distance(points[last + 1]);
            last += 1;
        }
        if last - first < 2 {
            return false;
        }
        let Some(mut way) = way_round(self, points[first], points[last]) else { return false };
        // The way is longer than what it replaces: points before and behind move up, so that no chord grows much.
        let length = |line: &[Vec3]| line.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
        let more = length(&way);
        let (mut from, mut to) = (first, last);
        let crowded = |from: usize, to: usize| {
            let plain = length(&points[from..=first]) + length(&points[last..=to]);
            let spans = (first - from + to - last) as f32;
            plain + more > CROWDED * plain / spans.max(1.0) * (to - from) as f32
        };
        while crowded(from, to) && (from > 0 || to + 1 < points.len()) {
            from = from.saturating_sub(1);
            to = (to + 1).min(points.len() - 1);
        }
        way.splice(..1, points[from..=first].iter().copied());
        way.extend_from_slice(&points[last + 1..=to]);
        let mut come = vec![0.0];
        for w in way.windows(2) {
            come.push(come[come.len() - 1] + w[0].distance(w[1]));
        }
        let total = come[come.len() - 1];
        let mut k = 0;
        was.retain(|(k, _)| *k <= from || *k >= to);
        for (n, point) in points[from + 1..to].iter_mut().enumerate() {
            let s = total * (n + 1) as f32 / (to - from) as f32;
            while k + 2 < come.len() && come[k + 1] < s {
                k += 1;
            }
            let t = (s - come[k]) / (come[k + 1] - come[k]).max(f32::MIN_POSITIVE);
            let p = way[k].lerp(way[k + 1], t.clamp(0.0, 1.0));
            *point = self.push_out(p, depth(from + 1 + n).unwrap_or(0.0)).0;
        }
        true
    }

    /// Pushes each point out of a rough mesh, and asks about none that a ball without skin holds which was found for one before it.
    /// Tells whether any was moved.
    fn push_each(
        &self,
        points: &mut [Vec3],
        depth: &impl Fn(usize) -> Option<f32>,
        mut note: impl FnMut(usize, Vec3, f32),
    ) -> bool {
        let (mut ball, mut near, mut any) = ((Vec3::ZERO, 0.0), None, false);
        for (k, p) in points.iter_mut().enumerate().skip(1) {
            let Some(depth) = depth(k) else { continue };
            if p.distance(ball.0) + SURE - depth.min(0.0) < ball.1 {
                continue;
            }
            let (out, moved, clear) = self.raise_alone(*p, -depth, &mut near);
            ball = (*p, clear);
            if clear > SURE {
                note(k, *p, clear - SURE);
            }
            any |= moved;
            *p = out;
        }
        any
    }

    fn push_all(
        &self,
        points: &mut [Vec3],
        depth: &impl Fn(usize) -> Option<f32>,
        is_clear: &impl Fn(&[Vec3], usize) -> bool,
        was: &mut Vec<(usize, Vec3)>,
    ) {
        for k in 1..points.len() {
            let Some(depth) = depth(k).filter(|_| !is_clear(points, k)) else { continue };
            let (out, moved) = self.push_out(points[k], depth);
            if moved {
                was.push((k, points[k]));
                points[k] = out;
            }
        }
    }

    /// How far beyond what is let pass a hair is torn where it is worst, and where: the later of the two points.
    fn tear(
        &self,
        Torn(times, more): Torn,
        points: &[Vec3],
        was: &[(usize, Vec3)],
    ) -> Option<(f32, usize)> {
        let mut worst: Option<(f32, usize)> = None;
        let before = |k: usize| match was.binary_search_by_key(&k, |(k, _)| *k) {
            Ok(n) => was[n].1,
            Err(_) => points[k],
        };
        let mut look = |k: usize| {
            let (a, b) = (points[k - 1], points[k]);
            let (now, then) = (b.distance(a), before(k).distance(before(k - 1)));
            let mut excess = now - (times * then).max(then + more);
            if excess <= 0.0 && k > 1 {
                let deep = -self.about((a + b) * 0.5);
                let ends = (-self.about(a)).max(-self.about(b)).max(0.0);
                excess = deep - ends - THROUGH;
            }
            if excess > worst.map_or(0.0, |(worst, _)| worst) {
                worst = Some((excess, k));
            }
        };
        for (k, _) in was {
            look(*k);
            if k + 1 < points.len() {
                look(k + 1);
            }
        }
        worst
    }

    /// The shortest way from `middle` out of a thin part, across a hair that runs `along` and whose points were torn apart
    /// along `through`.
    pub(in crate::data) fn way_out(
        &self,
        middle: Vec3,
        through: Vec3,
        along: Vec3,
    ) -> Option<Vec3> {
        let across = through.cross(along).normalize_or_zero();
        if across == Vec3::ZERO {
            return None;
        }
        let along = across.cross(through);
        let ways =
            [across, -across, across + along, across - along, along - across, -across - along];
        let mut best: Option<(f32, Vec3)> = None;
        for way in ways.map(|way| way.normalize_or_zero()) {
            let mut far = STEP;
            while far < best.map_or(FARTHEST, |(far, _)| far) {
                if self.about(middle + way * far) > CLEARANCE {
                    best = Some((far, way));
                    break;
                }
                far += STEP;
            }
            self.looked((far / STEP) as usize / CHEAP);
        }
        best.map(|(far, way)| way * far)
    }
}

/// Leads a hair aside at `torn`, softly before and after it; its root stays.
fn give_way(points: &mut [Vec3], torn: usize, aside: Vec3) {
    let reach = SOFTLY * aside.length();
    let mut come = vec![0.0; points.len()];
    for k in 1..points.len() {
        come[k] = come[k - 1] + points[k].distance(points[k - 1]);
    }
    let at = 0.5 * (come[torn - 1] + come[torn]);
    for (p, come) in points.iter_mut().zip(&come).skip(1) {
        let x = (come - at) / if *come < at { reach.min(at) } else { reach };
        let share = (1.0 - x * x).max(0.0);
        *p += aside * (share * share);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::data::scalp::{HeadFrame, REGION, Scalp};
    use crate::maths::closest::Surface;

    pub(crate) fn bust() -> Scalp {
        let mesh = crate::scalp::bust::adult();
        let surface = Surface::new(mesh.points, mesh.triangles);
        let everywhere = vec![1.0; surface.points.len()];
        Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), everywhere)].into())
    }

    /// Hairs that hang past the left ear of the built-in head, before and behind it and through it.
    pub(crate) fn hairs() -> Vec<Vec<Vec3>> {
        let mut out = vec![];
        for x in 0..24 {
            for z in 0..48 {
                let (x, z) = (7.2 + 0.1 * x as f32, -4.0 + 0.1 * z as f32);
                out.push((0..50).map(|k| Vec3::new(x, 2.0 - 0.25 * k as f32, z)).collect());
            }
        }
        out
    }

    fn longest(points: &[Vec3]) -> f32 {
        points.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f32::max)
    }

    #[test]
    fn hair_hangs_over_ears_and_is_not_torn_by_them() {
        let scalp = bust();
        let skin = scalp.skin();
        let (mut torn, mut still, mut through) = (0, 0, 0);
        for hair in hairs().into_iter().filter(|hair| skin.distance(hair[0]) > 0.0) {
            let alone: Vec<Vec3> = std::iter::once(hair[0])
                .chain(hair[1..].iter().map(|p| skin.push_out(*p, 0.0).0))
                .collect();
            let mut led = hair.clone();
            let moved = skin.clear(&mut led, |_| Some(0.0));
            assert_eq!(led[0], hair[0]);
            assert_eq!(moved, alone != hair);
            for p in &led[1..] {
                assert!(skin.distance(*p) > -1e-3, "{p} is {} deep", skin.distance(*p));
            }
            through += usize::from(moved);
            torn += usize::from(longest(&alone) > 0.6);
            still += usize::from(longest(&led) > 0.6);
        }
        println!("{through} pushed, {torn} torn, {still} still torn");
        assert!(torn > 20, "{torn} of {through} are torn by pushing alone");
        assert!(still * 10 <= torn, "{still} of {torn} are torn still");
    }
}
