//! The tail of a braid beyond the head: it falls from the end of its row, around what is in its way.
//!
//! A tail has the requested length and keeps its height above the skin where the skin allows it; it spans nooks (a
//! collar, a shoulder's fold) in a bow. It does not swing.

use crate::data::route::makers::lift;
use crate::data::scalp::Skin;
use glam::Vec3;

/// The row with a tail of `length` cm that falls from its end at `height` above the skin. Where it would fall into a
/// nook and climb out again, as behind a collar, it bridges the nook in a bow; the end of the row may leave the scalp
/// for that.
pub(super) fn lengthened(points: &[Vec3], length: f32, height: f32, skin: &Skin) -> Vec<Vec3> {
    let n = points.len();
    let mut all = points.to_vec();
    let towards = |a: Vec3, b: Vec3| (b - a).try_normalize();
    let way_at = |all: &[Vec3], k: usize| if k > 0 { towards(all[k - 1], all[k]) } else { None };
    if length <= 0.0 || n == 0 {
        return all;
    }
    let Some(way) = way_at(points, n - 1) else { return all };
    let steps = (length / 0.5).ceil().clamp(4.0, 400.0) as usize;
    let fall = Fall { step: length / steps as f32, height, end: n - 1, last: n - 1 + steps };
    fall.on(&mut all, way, skin);
    let mut from = n - 1;
    while from > 0 && all[from - 1].distance(points[n - 1]) < LEAVES * height {
        from -= 1;
    }
    for _ in 0..NOOKS {
        let Some((low, high)) = climb(&all, from.max(n - 1), height) else { break };
        let comes = all[high];
        // Round, so that the braid can follow: it leaves in the direction of the row.
        let bow = |a: usize, t: f32| -> Vec3 {
            let leaves = all[a];
            let before = way_at(&all, a).unwrap_or(way);
            let across = comes - leaves;
            let far = across.length();
            let (start, end) = (before * far, across);
            let (t2, t3) = (t * t, t * t * t);
            leaves * (2.0 * t3 - 3.0 * t2 + 1.0)
                + start * (t3 - 2.0 * t2 + t)
                + comes * (3.0 * t2 - 2.0 * t3)
                + end * (t3 - t2)
        };
        let clear = |a: usize| {
            let room = 0.5 * skin.distance(all[a]).clamp(0.0, height);
            (1..16).all(|k| skin.distance(bow(a, k as f32 / 16.0)) >= room)
        };
        let Some(a) = (from..low).find(|a| clear(*a)) else { break };
        let over = all[a].distance(comes) * 1.1 / fall.step;
        let over = (over.ceil() as usize).clamp(2, (fall.last - a).max(2));
        let bridge: Vec<Vec3> = (1..=over).map(|k| bow(a, k as f32 / over as f32)).collect();
        all.truncate(a + 1);
        all.extend(bridge);
        from = a + over;
        let way = way_at(&all, from).unwrap_or(way);
        fall.on(&mut all, way, skin);
    }
    all
}

/// The most nooks that a tail bridges.
const NOOKS: usize = 8;
/// How much of the end of a row may leave the scalp for that, in heights of the tail.
const LEAVES: f32 = 7.0;

/// Where a tail climbs by more than `least` after `from`: its lowest point before and its highest after.
fn climb(tail: &[Vec3], from: usize, least: f32) -> Option<(usize, usize)> {
    let mut low = from;
    let mut high = None;
    for (k, p) in tail.iter().enumerate().skip(from) {
        match high {
            None if p.y < tail[low].y => low = k,
            None if p.y > tail[low].y + least => high = Some(k),
            Some(top) if p.y > tail[top].y => high = Some(k),
            Some(top) if p.y < tail[top].y - least => break,
            _ => {}
        }
    }
    high.map(|high| (low, high))
}

/// How a tail falls: in steps of `step` cm, at `height` off the skin from a few steps past the point `end`, up to the
/// point `last`.
struct Fall {
    step: f32,
    height: f32,
    end: usize,
    last: usize,
}

impl Fall {
    /// Continues a tail that arrived in this direction.
    fn on(&self, tail: &mut Vec<Vec3>, mut way: Vec3, skin: &Skin) {
        let Self { step, height, end, last } = *self;
        for k in tail.len()..=last {
            let p = tail[k - 1];
            // Gravity turns hanging hair within a few centimetres.
            way = (way + Vec3::NEG_Y * (0.22 * step)).normalize_or(way);
            let mut next = p + way * step;
            let fallen = k.saturating_sub(end) as f32 * step;
            let wanted = height * (fallen / (3.0 * height).max(1e-3)).min(1.0);
            let (lifted, moved) = lift(skin, next, wanted);
            if moved {
                next = p + (lifted - p).normalize_or(way) * step;
                way = (next - p).normalize_or(way);
            }
            tail.push(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::{HeadFrame, REGION, Scalp};
    use crate::maths::closest::Surface;

    /// A neck (z = 0) with a collar that stands off it, 4 cm high and 3 cm behind: a prism along x.
    fn collar() -> Scalp {
        let outline = [(20.0, 0.0), (0.0, 0.0), (4.0, -3.0), (4.0, -3.6), (-30.0, -9.0)];
        let outline = outline.iter().chain(&[(-30.0, 6.0), (20.0, 6.0)]);
        let flat: Vec<(f32, f32)> = outline.copied().collect();
        let n = flat.len() as u32;
        let side = |x: f32| flat.iter().map(move |(y, z)| Vec3::new(x, *y, *z));
        let points: Vec<Vec3> = side(-9.0).chain(side(9.0)).collect();
        let around = (0..n).flat_map(|k| {
            let (a, b) = (k, (k + 1) % n);
            [[a, b, b + n], [a, b + n, a + n]]
        });
        let outward = |t: [u32; 3]| {
            // The outline runs so that its inside is at +z.
            [t[0], t[2], t[1]]
        };
        let triangles: Vec<[u32; 3]> = around.map(outward).collect();
        let mut surface = Surface::new(points.clone(), triangles.clone());
        let out = Vec3::new(0.0, 10.0, -2.0);
        if surface.signed_distance(out, &surface.closest(out).unwrap()) < 0.0 {
            let turned = triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
            surface = Surface::new(points, turned);
        }
        let region = vec![1.0; surface.points.len()];
        Scalp::new(surface, None, HeadFrame::IDENTITY, [(REGION.to_owned(), region)].into())
    }

    #[test]
    fn a_tail_goes_over_a_collar_and_not_behind_it() {
        let scalp = collar();
        let skin = scalp.skin();
        let row: Vec<Vec3> =
            (0..24).map(|k| Vec3::new(0.0, 15.0 - 0.5 * k as f32, -0.01)).collect();
        let height = 0.8;
        // Without help, it falls into the nook and climbs out.
        let fall = Fall { step: 0.5, height, end: 23, last: 73 };
        let mut plain = row.clone();
        fall.on(&mut plain, Vec3::NEG_Y, &skin);
        assert!(climb(&plain, 23, height).is_some(), "{plain:?}");
        let tail = lengthened(&row, 25.0, height, &skin);
        assert!(climb(&tail, 23, height).is_none(), "{tail:?}");
        assert!(tail.iter().all(|p| skin.distance(*p) > -1e-3), "{tail:?}");
        let chords = tail.windows(2).map(|w| w[0].distance(w[1]));
        assert!(chords.clone().all(|c| (0.1..1.5).contains(&c)), "{tail:?}");
        // The row itself leaves the scalp only at its end.
        assert_eq!(tail[..10], row[..10]);
        assert!(tail[tail.len() - 1].z < -4.0, "outside the collar");
    }

    #[test]
    fn a_tail_that_only_falls_is_left_as_it_is() {
        let falls: Vec<Vec3> = (0..30).map(|k| Vec3::new(0.0, -0.5 * k as f32, 0.0)).collect();
        assert_eq!(climb(&falls, 0, 0.5), None);
        let mut climbs = falls.clone();
        climbs[20..].iter_mut().enumerate().for_each(|(k, p)| p.y = -9.5 + 0.4 * k as f32);
        assert_eq!(climb(&climbs, 0, 0.5), Some((19, 29)));
    }
}
