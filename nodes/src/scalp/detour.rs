//! Ways over the scalp that would lead over what is none, above all an ear, go round it on the side of the crown.
//!
//! A way is a taut string on the flat map of the scalp: where it lies over bare skin, or over scalp that an ear stands before,
//! it is lifted towards the middle of the map until it is over open scalp, and what comes before and after is lifted with it so far
//! that the string has no hollow.
//!
//! Guarantees: both ends stay; a way over open scalp stays as it is. Not promised: anything where no scalp lies between a place
//! and the middle of the map; such a way stays as it is. Points are not on the skin afterwards, only over or under it.

use super::lay::Polyline;
use crate::data::chart::{CELL, Chart, cell_of};
use crate::data::scalp::{Scalp, Skin};
use glam::{Vec2, Vec3};

/// Farther from the skin than this (cm on a head of average size) nothing is said to stand before it.
const BEFORE: f32 = 5.0;
/// How far a way keeps from what it goes round, on the map (a cranium of 8.9 cm has 8.9 cm to the unit).
const MARGIN: f32 = 0.06;
/// Bare skin narrower than this is not worth a detour, on the map.
const NARROW: f32 = 0.03;
/// Ways are lifted no farther, on the map.
const FARTHEST: f32 = 0.8;
/// Places looked at from one point of a way to the next.
const FINE: usize = 4;

/// Where scalp is open.
pub(crate) struct Detour<'a> {
    chart: &'a Chart,
    open: Vec<bool>,
}

impl<'a> Detour<'a> {
    /// Looks at all of a scalp.
    pub(crate) fn new(scalp: &'a Scalp, skin: &Skin) -> Self {
        let (chart, unit) = (scalp.chart(), scalp.frame().unit());
        let open = chart.spots().iter().map(|spot| {
            let out = (spot.point - chart.origin()).normalize_or_zero();
            let clear = |p: Vec3| {
                skin.about(p) > 0.9 * unit
                    || scalp.surface().ray(p - out * (0.95 * unit), out, BEFORE * unit).is_none()
            };
            spot.grows > 0.0 && clear(spot.point + out * unit)
        });
        Self { chart, open: open.collect() }
    }

    fn is_open(&self, q: Vec2) -> bool {
        cell_of(q).is_some_and(|cell| self.open[cell])
    }

    /// Whether a point is over open scalp.
    pub(crate) fn is_free(&self, p: Vec3) -> bool {
        self.is_open(self.chart.flat(p))
    }

    /// How far towards the middle of the map the open scalp is from `q`; none where there is none.
    fn off(&self, q: Vec2) -> Option<f32> {
        if self.is_open(q) {
            return Some(0.0);
        }
        let way = -q.normalize_or_zero();
        let farthest = FARTHEST.min(q.length());
        let mut far = CELL;
        while far < farthest {
            if self.is_open(q + way * far) {
                return Some(if far > NARROW { far + MARGIN } else { 0.0 });
            }
            far += CELL;
        }
        None
    }

    /// Leads a way round what is not open; tells whether it had to. Its points are even then.
    pub(crate) fn lead(&self, way: &mut [Vec3]) -> bool {
        let Some(last) = way.len().checked_sub(1).filter(|last| *last > 1) else { return false };
        let mut fine: Vec<Vec3> = Vec::with_capacity(last * FINE + 1);
        for w in way.windows(2) {
            fine.extend((0..FINE).map(|i| w[0].lerp(w[1], i as f32 / FINE as f32)));
        }
        fine.push(way[last]);
        let flat: Vec<Vec2> = fine.iter().map(|p| self.chart.flat(*p)).collect();
        let Some(mut off) = flat.iter().map(|q| self.off(*q)).collect::<Option<Vec<f32>>>() else {
            return false;
        };
        // A root under the edge of an ear comes out from under it; a braid beside one is where it is.
        (off[0], off[last * FINE]) = (0.0, 0.0);
        if off.iter().all(|far| *far == 0.0) {
            return false;
        }
        let inner = 1..last * FINE;
        for (i, far) in taut(&off).into_iter().enumerate().filter(|(i, _)| inner.contains(i)) {
            let q = flat[i] - flat[i].normalize_or_zero() * far;
            let out = match cell_of(q).filter(|cell| self.open[*cell]) {
                Some(cell) => self.chart.out(cell),
                None => fine[i].distance(self.chart.origin()),
            };
            fine[i] = self.chart.origin() + self.chart.direction(q) * out;
        }
        way.copy_from_slice(&Polyline::new(fine).evenly(last + 1));
        true
    }
}

/// The least values that are nowhere below the given ones and have no hollow: a string pulled taut over them.
fn taut(values: &[f32]) -> Vec<f32> {
    let mut posts: Vec<usize> = vec![];
    for (i, value) in values.iter().enumerate() {
        while let [.., a, b] = posts[..] {
            let between = values[a] + (value - values[a]) * ((b - a) as f32 / (i - a) as f32);
            if values[b] > between {
                break;
            }
            posts.pop();
        }
        posts.push(i);
    }
    let mut out = vec![];
    for w in posts.windows(2) {
        let (a, b) = (w[0], w[1]);
        let at = |i: usize| values[a] + (values[b] - values[a]) * ((i - a) as f32 / (b - a) as f32);
        out.extend((a..b).map(at));
    }
    out.extend(values.last());
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::{HeadFrame, REGION};
    use crate::maths::closest::Surface;
    use crate::maths::hash::Dice;

    #[test]
    fn a_taut_string_lies_on_its_posts_and_has_no_hollow() {
        let dice = Dice::new(1, 0, "string");
        for id in 0..200 {
            let values: Vec<f32> = (0..12).map(|k| dice.unit(id, k)).collect();
            let string = taut(&values);
            assert_eq!(string.len(), values.len());
            assert_eq!((string[0], string[11]), (values[0], values[11]));
            assert!(string.iter().zip(&values).all(|(s, v)| s >= &(v - 1e-6)), "{values:?}");
            assert!(string.windows(3).all(|w| 2.0 * w[1] >= w[0] + w[2] - 1e-5), "{string:?}");
        }
    }

    /// The built-in head with its painted hairline.
    fn head() -> Scalp {
        let mesh = crate::scalp::bust::adult();
        let hairline = mesh.masks["hairline"].clone();
        let surface = Surface::new(mesh.points, mesh.triangles);
        Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), hairline)].into())
    }

    #[test]
    fn a_way_from_before_an_ear_to_behind_it_goes_over_it() {
        let scalp = head();
        let detour = Detour::new(&scalp, &scalp.skin());
        for side in [-1.0, 1.0] {
            let (from, to) = (Vec3::new(7.2 * side, -2.5, 1.5), Vec3::new(5.5 * side, -3.0, -8.0));
            let straight: Vec<Vec3> = (0..9).map(|k| from.lerp(to, k as f32 / 8.0)).collect();
            let mut way = straight.clone();
            assert!(detour.lead(&mut way));
            assert_eq!((way[0], way[8]), (straight[0], straight[8]));
            let flat: Vec<Vec2> = way.iter().map(|p| scalp.chart().flat(*p)).collect();
            for q in &flat[1..8] {
                assert!(detour.is_open(*q), "{side}: {way:?}");
            }
            let steps: Vec<f32> = way.windows(2).map(|w| w[0].distance(w[1])).collect();
            let mean = steps.iter().sum::<f32>() / 8.0;
            assert!(steps.iter().all(|step| (step / mean - 1.0).abs() < 0.1), "{steps:?}");
            // On the bare crown nothing is in the way.
            let mut over: Vec<Vec3> =
                (0..9).map(|k| Vec3::new(0.4 * k as f32 * side, 9.0, k as f32 - 4.0)).collect();
            assert!(!detour.lead(&mut over));
        }
    }
}
