//! Leads paths over the scalp around what is not scalp, above all ears, on the crown's side.
//!
//! A path is a taut string on the flat map of the scalp. Where it lies over bare skin, or over scalp in front of which
//! an ear stands, it is lifted toward the top of the head, or the crown, until it is over open scalp; the parts before
//! and after are lifted as well, so that the string has no dent. Straight up comes first, because an ear leans back:
//! toward the crown, a path that begins in front of an ear might be lifted into it.
//!
//! Guarantees: both ends stay; a path over open scalp stays as it is. Not promised: a detour where there is no scalp
//! between a point and the top of the head; such a path stays as it is. The points are afterward only above or below
//! the skin, not on it.

use crate::data::chart::{CELL, Chart, cell_of};
use crate::data::scalp::{Scalp, Skin};
use crate::maths::polyline::Polyline;
use crate::maths::transcendental::{acos, sin_cos};
use glam::{Vec2, Vec3};

/// Objects farther from the skin than this (cm on a head of average size) do not count as standing in front of it.
const BEFORE: f32 = 5.0;
/// Distance of a path from what it avoids, on the map (a cranium of 8.9 cm has 8.9 cm per unit).
const MARGIN: f32 = 0.06;
/// Bare skin narrower than this needs no detour, on the map.
const NARROW: f32 = 0.03;
/// Paths are lifted at most this far, radians.
const FARTHEST: f32 = 0.8;
/// How often a lifted path is tested again.
const ROUNDS: usize = 4;
/// Samples between two points of a path.
const FINE: usize = 4;

/// Direction in which a path over an ear is lifted.
#[derive(Clone, Copy)]
pub(crate) enum Towards {
    /// Straight up, as hair is combed.
    Top,
    /// Toward the crown, the centre of the map.
    Crown,
}

/// Where the scalp is open.
pub(crate) struct Detour<'a> {
    chart: &'a Chart,
    open: Vec<bool>,
    /// Direction of the top of the head.
    top: Vec3,
    /// Direction of the centre of the map.
    crown: Vec3,
}

impl<'a> Detour<'a> {
    /// Examines the whole scalp.
    pub(crate) fn new(scalp: &'a Scalp, skin: &Skin) -> Self {
        let (chart, unit) = (scalp.chart(), scalp.frame().unit());
        let open = chart.spots().iter().map(|spot| {
            let out = (spot.point - chart.origin()).normalize_or_zero();
            // Rays first: this far out, the distance field is not computed yet, and computing it is expensive.
            let clear = |p: Vec3| {
                scalp.surface().ray(p - out * (0.95 * unit), out, BEFORE * unit).is_none()
                    || skin.about(p) > 0.9 * unit
            };
            spot.grows > 0.0 && clear(spot.point + out * unit)
        });
        let open = open.collect();
        Self { chart, open, top: scalp.frame().up, crown: chart.direction(Vec2::ZERO) }
    }

    fn pole(&self, towards: Towards) -> Vec3 {
        match towards {
            Towards::Top => self.top,
            Towards::Crown => self.crown,
        }
    }

    /// The largest lift at `q`, radians.
    fn most(&self, q: Vec2, towards: Towards) -> f32 {
        FARTHEST.min(acos(self.chart.direction(q).dot(self.pole(towards))))
    }

    /// The point `far` radians above `q` along the arc of its lift.
    fn above(&self, q: Vec2, far: f32, towards: Towards) -> Vec2 {
        let (direction, pole) = (self.chart.direction(q), self.pole(towards));
        let up = (pole - direction * pole.dot(direction)).normalize_or_zero();
        let (sin, cos) = sin_cos(far);
        self.chart.flat(self.chart.origin() + direction * cos + up * sin)
    }

    fn is_open(&self, q: Vec2) -> bool {
        cell_of(q).is_some_and(|cell| self.open[cell])
    }

    /// Whether a point is over open scalp.
    pub(crate) fn is_free(&self, p: Vec3) -> bool {
        self.is_open(self.chart.flat(p))
    }

    /// Distance up from `q` to open scalp; `None` if there is none.
    fn off(&self, q: Vec2, towards: Towards) -> Option<f32> {
        if self.is_open(q) {
            return Some(0.0);
        }
        let farthest = self.most(q, towards);
        let mut far = CELL;
        while far < farthest {
            if self.is_open(self.above(q, far, towards)) {
                return Some(if far > NARROW { far + MARGIN } else { 0.0 });
            }
            far += CELL;
        }
        None
    }

    /// Takes a path around what is not open; returns whether it had to. Its points are then evenly spaced.
    pub(crate) fn reroute(&self, way: &mut [Vec3], towards: Towards) -> bool {
        let Some(last) = way.len().checked_sub(1).filter(|last| *last > 1) else { return false };
        let mut fine: Vec<Vec3> = Vec::with_capacity(last * FINE + 1);
        for w in way.windows(2) {
            fine.extend((0..FINE).map(|i| w[0].lerp(w[1], i as f32 / FINE as f32)));
        }
        fine.push(way[last]);
        let flat: Vec<Vec2> = fine.iter().map(|p| self.chart.flat(*p)).collect();
        let off: Option<Vec<f32>> = flat.iter().map(|q| self.off(*q, towards)).collect();
        let Some(mut off) = off else { return false };
        // A root below the edge of an ear comes out from under it; a braid beside one stays.
        (off[0], off[last * FINE]) = (0.0, 0.0);
        if off.iter().all(|far| *far == 0.0) {
            return false;
        }
        let inner = 1..last * FINE;
        let lifted = |i: usize, far: f32| self.above(flat[i], far, towards);
        let mut string = taut(&off);
        // What was lifted only because of its neighbours may now be under the ear.
        for _ in 0..ROUNDS {
            let mut under = false;
            for i in inner.clone() {
                let Some(far) = self.off(lifted(i, string[i]), towards) else { return false };
                if far > 0.0 {
                    under = true;
                    off[i] = (string[i] + (far - MARGIN)).min(self.most(flat[i], towards));
                }
            }
            if !under {
                break;
            }
            string = taut(&off);
        }
        for i in inner {
            let q = lifted(i, string[i]);
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

/// The smallest values that are nowhere below the given ones and have no dent: a taut string over them.
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
        // From beside the ear's top, and from the end of the sideburn, over which the ear leans.
        let froms = [Vec3::new(7.2, -2.5, 1.5), Vec3::new(7.2, -4.46, 0.6)];
        for (side, from) in [-1.0, 1.0].into_iter().flat_map(|side| froms.map(|from| (side, from)))
        {
            let mirror = Vec3::new(side, 1.0, 1.0);
            let (from, to) = (from * mirror, Vec3::new(5.5, -3.0, -8.0) * mirror);
            let straight: Vec<Vec3> = (0..9).map(|k| from.lerp(to, k as f32 / 8.0)).collect();
            let mut way = straight.clone();
            assert!(detour.reroute(&mut way, Towards::Top));
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
            assert!(!detour.reroute(&mut over, Towards::Top));
        }
    }
}
