//! Scatter: copies of a cluster placed where the pen paints; beyond the paper, whose artists found it tedious to
//! implant every cluster.
//!
//! The cluster drawn nearest to the start of the stroke is copied. Copies are placed along the stroke, and in rows
//! beside it as far as the brush reaches, wherever there is room for their discs. Each copy keeps its shape in the
//! frame of its own root, turned toward the mean direction of the surrounding clusters, weighted by the proximity of
//! their roots.
//!
//! Guarantees: no existing curve changes; no copy is closer to a root than nine tenths of both discs; no CV of a copy
//! lies below the skin; the same stroke makes the same copies. Once drawn (with stored roots), copies keep their
//! positions, whatever else is there. Not promised: that rows are packed as densely as possible.

use super::grow::clear;
use super::hand::{GestureContext, SketchState, off_line};
use super::lock::Lock;
use super::seen::{Seen, steps};
use crate::data::gestures::{Gesture, RootFrame};
use crate::data::scalp::{Root, Scalp};
use crate::maths::frame::{any_normal, smallest_rotation};
use crate::maths::hash::curve_id;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Smallest distance of roots, as a fraction of the sum of their disc radii: discs of a full head overlap slightly.
pub(super) const APART: f32 = 0.9;
/// The most copies per stroke.
const MOST: usize = 1000;
/// The most steps of the stroke that are tried, and the most positions in all, including beside it.
const MOST_STEPS: f32 = 2000.0;
const MOST_PLACES: usize = 20_000;
/// Distance (cm) at which other positions are tried if a root is not stable, and their number.
const BESIDE: f32 = 5e-4;
const TRIES: usize = 24;
/// Positions closer than this (pixels) are the same.
const LEAST: f32 = 2.0;

pub(super) fn scatter(hand: &GestureContext, sketch: &mut SketchState) {
    let under = |hand: &GestureContext, sketch: &SketchState| -> Vec<usize> {
        let found = nearest(&hand.seen, hand.scalp, &sketch.locks, hand.start());
        let touched = found.filter(|(i, off)| {
            let lock = &sketch.locks[*i];
            let wide = lock.radius / hand.seen.cm_per_pixel(hand.seen.depth(lock.root()));
            *off <= wide.max(2.0 * hand.set.rho)
        });
        touched.map(|(i, _)| i).into_iter().collect()
    };
    let taken = hand.takes(sketch, under, "no hair is near its start: begin on what it copies");
    let Some(source) = taken.first().map(|i| sketch.locks[*i].clone()) else { return };
    let Some(own) = hand.scalp.closest_root(source.root()) else {
        return sketch.say("the head has no skin");
    };
    let roots = match hand.gesture.path.is_empty() {
        true => free(hand, sketch, &source),
        false => kept(hand),
    };
    if roots.is_empty() {
        return sketch.say("there is no room for a copy: draw on over skin that is free");
    }
    if roots.len() > MOST {
        sketch.say(format!("it makes {MOST} copies, the most for one stroke: draw shorter ones"));
    }
    let own = RootFrame::at(hand.scalp, &own);
    let shape: Vec<Vec3> =
        source.points.iter().map(|p| own.local(*p) - own.local(source.root())).collect();
    let mut ways = Ways { scalp: hand.scalp, known: vec![None; sketch.locks.len()] };
    let there = sketch.locks.clone();
    for (number, (root, drift)) in roots.iter().take(MOST).enumerate() {
        let own = RootFrame::at(hand.scalp, root);
        let way = shape[shape.len() - 1].normalize_or_zero();
        let wanted = ways.about(&there, root.point, hand.set.tau).unwrap_or(way);
        let mut points: Vec<Vec3> = match way == Vec3::ZERO {
            true => shape.iter().map(|p| own.world(*p)).collect(),
            false => {
                let turn = smallest_rotation(way, wanted);
                shape.iter().map(|p| own.world(turn * *p)).collect()
            }
        };
        clear(hand, &mut points, 0);
        let id = curve_id(hand.gesture.id, hand.set.seed, number as u64);
        sketch.locks.push(Arc::new(source.copied(id, points, root, *drift, hand.scalp)));
        if !hand.gesture.path.is_empty() {
            sketch.now.drift = Some(sketch.now.drift.map_or(*drift, |most| most.max(*drift)));
        }
    }
    sketch.now.changed = roots.len().min(MOST);
}

/// The curve that a gesture copies: the first named one or, if it names none, the one nearest to its start.
pub(super) fn source(gesture: &Gesture, scalp: &Scalp, locks: &[Arc<Lock>]) -> Option<u64> {
    let named = |lock: &&Arc<Lock>| lock.is_curve() && gesture.curves.contains(&lock.id);
    if !gesture.curves.is_empty() {
        return locks.iter().find(named).map(|lock| lock.id);
    }
    let seen = Seen::new(&gesture.view, scalp.frame());
    nearest(&seen, scalp, locks, gesture.samples[0].at).map(|(i, _)| locks[i].id)
}

/// The curve drawn nearest to a pixel that the head does not hide, and its distance, pixels.
fn nearest(seen: &Seen, scalp: &Scalp, locks: &[Arc<Lock>], at: Vec2) -> Option<(usize, f32)> {
    let mut best: Option<(usize, f32)> = None;
    for (i, lock) in locks.iter().enumerate().filter(|(_, lock)| lock.is_curve()) {
        for pair in lock.points.windows(2) {
            let (Some(a), Some(b)) = (seen.pixel(pair[0]), seen.pixel(pair[1])) else { continue };
            let off = off_line(&[a, b], at);
            let nearer = best.is_none_or(|(_, least)| off < least);
            if nearer && pair.iter().any(|p| seen.sees(scalp, *p)) {
                best = Some((i, off));
            }
        }
    }
    best
}

/// Stored roots of the gesture, on this head, each with its distance from the stored position, cm.
fn kept(hand: &GestureContext) -> Vec<(Root, f32)> {
    let root = |p: &Vec3| {
        let drawn = hand.scalp.place(*p);
        let root = hand.scalp.closest_root(drawn)?;
        Some((root, root.point.distance(drawn)))
    };
    hand.gesture.path.iter().take(MOST + 1).filter_map(root).collect()
}

/// A root that a document can restore, at this one or slightly beside it: stored values are rounded, and among folds of
/// the skin the smallest rounding may turn what grows there. `None` if none was found.
fn settled(scalp: &Scalp, root: Root) -> Option<Root> {
    let aside = any_normal(root.normal) * BESIDE;
    (0..TRIES).find_map(|k| {
        let mut root = match k {
            0 => root,
            k => scalp.closest_root(root.point + aside * k as f32)?,
        };
        for _ in 0..4 {
            let kept = scalp.place(scalp.given(root.point));
            let again = scalp.closest_root(kept)?;
            if again == root {
                return Some(root);
            }
            root = again;
        }
        None
    })
}

/// Positions along the stroke, and then beside it row by row, with room for a copy.
fn free(hand: &GestureContext, sketch: &SketchState, source: &Lock) -> Vec<(Root, f32)> {
    let disc = source.radius.max(0.0);
    let there = sketch.locks.iter().filter(|lock| lock.is_curve());
    let mut discs: Vec<(Vec3, f32)> =
        there.map(|lock| (lock.root(), lock.radius.max(0.0))).collect();
    let line = hand.line();
    let length: f32 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let depth = hand.seen.depth(source.root());
    let apart = APART * 2.0 * disc / hand.seen.cm_per_pixel(depth);
    let walk = steps(&line, (0.1 * apart).max(LEAST).max(length / MOST_STEPS));
    let most_rows = (MOST_PLACES / (2 * walk.len())).clamp(1, 64);
    let row = (0.25 * apart).max(LEAST).max(hand.gesture.size / most_rows as f32);
    let rows = (hand.gesture.size / row) as usize;
    let mut roots = vec![];
    let offs = (1..=rows).flat_map(|k| [k as f32 * row, -(k as f32) * row]);
    for off in std::iter::once(0.0).chain(offs) {
        for (i, at) in walk.iter().enumerate() {
            let way = walk[(i + 1).min(walk.len() - 1)] - walk[i.saturating_sub(1)];
            let at = *at + way.normalize_or(Vec2::X).perp() * off;
            let Some(hit) = hand.seen.head(hand.scalp, at) else { continue };
            let root = hand.scalp.root(hit.triangle, hit.bary);
            let room = |(p, other): &(Vec3, f32)| {
                let least = APART * (disc + other);
                p.distance_squared(root.point) > least * least
            };
            if !discs.iter().all(room) {
                continue;
            }
            let Some(root) = settled(hand.scalp, root) else { continue };
            discs.push((root.point, disc));
            roots.push((root, 0.0));
            if roots.len() > MOST {
                return roots;
            }
        }
    }
    roots
}

/// Directions of curves, each in the frame of its root; computed on demand.
struct Ways<'a> {
    scalp: &'a Scalp,
    known: Vec<Option<Vec3>>,
}

impl Ways<'_> {
    /// The mean over the curves whose roots are within `tau` (cm) of a position, weighted by proximity; unit. `None` if
    /// there are none.
    fn about(&mut self, locks: &[Arc<Lock>], at: Vec3, tau: f32) -> Option<Vec3> {
        let mut sum = Vec3::ZERO;
        for (lock, known) in locks.iter().zip(&mut self.known).filter(|(lock, _)| lock.is_curve()) {
            let weight = 1.0 - lock.root().distance(at) / tau;
            if weight > 0.0 {
                let way = || {
                    let root = self.scalp.closest_root(lock.root())?;
                    let own = RootFrame::at(self.scalp, &root);
                    Some((own.local(lock.tip()) - own.local(lock.root())).normalize_or_zero())
                };
                sum += weight * *known.get_or_insert_with(|| way().unwrap_or_default());
            }
        }
        sum.try_normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::super::hair_sketch::resolved;
    use super::super::laws::{drawn, line, points, sketch_on};
    use super::super::random_laws::out_of;
    use super::*;
    use crate::data::attributes::{COLOUR, DENSITY, Domain, FRIZZ, ID, PINNED, RADIUS, ROLL};
    use crate::data::curves::{Curves, TuftBuilder};
    use crate::data::gestures::{Layer, Tool};
    use crate::data::scalp::tests::shared_ball;
    use crate::testing::{head, with_points};

    /// Position of a root on the ball, from the front, this many cm to the right of the centre.
    fn on_ball(scalp: &Scalp, x: f32) -> Vec3 {
        let p = Vec3::new(x, 0.0, (8.9f32 * 8.9 - x * x).sqrt());
        scalp.closest_root(p).unwrap().point
    }

    /// A curve of five CVs that leads out, and down or aside by the given amounts.
    fn lock(scalp: &Scalp, id: u64, root: Vec3, down: f32, aside: f32) -> TuftBuilder {
        let own = RootFrame::at(scalp, &scalp.closest_root(root).unwrap());
        let mut b = TuftBuilder::new();
        let at = |k: i32| own.world(Vec3::new(1.0, down, aside) * k as f32);
        b.push_curve(&(0..5).map(at).collect::<Vec<Vec3>>());
        b.set(ID, Domain::Curve, vec![id]);
        b
    }

    fn roots(curves: &Curves) -> Vec<Vec3> {
        curves.each().map(|(tuft, i)| tuft.curve(i)[0]).collect()
    }

    #[test]
    fn copies_stand_nine_tenths_of_two_discs_apart_and_the_more_the_longer_the_stroke() {
        let scalp = shared_ball();
        let first = on_ball(&scalp, -7.0);
        let upstream = Curves::new(vec![Arc::new(lock(&scalp, 5, first, 0.5, 0.0).build())]);
        let seen = Seen::new(&drawn(Tool::Comb, Layer::Scalp, &[Vec2::ZERO]).view, scalp.frame());
        let mut last = 1;
        // From x = -7 to so far: an arc of the ball of 8.9 (asin(7 / 8.9) + asin(x / 8.9)) cm, a copy for each 1.8 cm.
        for (x, arc) in [(-4.0, 3.9), (0.0, 8.06), (7.0, 16.1f32)] {
            let ends = [first, on_ball(&scalp, x)].map(|p| seen.pixel(p).unwrap());
            let stroke = drawn(Tool::Scatter, Layer::Scalp, &line(ends[0].into(), ends[1].into()));
            let (curves, said) = sketch_on(&scalp, Some(&upstream), &[stroke]);
            assert!(said.is_empty(), "{said:?}");
            let roots = roots(&curves);
            // One less at most: steps are a tenth of that, coarser where the skin leads away.
            let wanted = 1 + (arc / 1.8) as usize;
            assert!((wanted - 1..=wanted).contains(&roots.len()), "{x}: {} {wanted}", roots.len());
            assert!(roots.len() > last);
            last = roots.len();
            for (i, p) in roots.iter().enumerate() {
                let near = roots[..i].iter().map(|q| p.distance(*q)).fold(f32::MAX, f32::min);
                assert!(i == 0 || (1.8..2.3).contains(&near), "{x}: {near}");
            }
            // The brush paints rows beside it.
            let stroke = drawn(Tool::Scatter, Layer::Scalp, &line(ends[0].into(), ends[1].into()));
            let wide = Gesture { size: 80.0, ..stroke };
            let (curves, _) = sketch_on(&scalp, Some(&upstream), &[wide]);
            assert!(curves.curve_count() > roots.len() + 1, "{}", curves.curve_count());
        }
        // Where there is no room, nothing is made, and that is reported.
        let tap = drawn(Tool::Scatter, Layer::Scalp, &[seen.pixel(first).unwrap()]);
        let (same, said) = sketch_on(&scalp, Some(&upstream), &[tap]);
        assert!(same.curve_count() == 1 && said[0].contains("no room for a copy"), "{said:?}");
        let beside = drawn(Tool::Scatter, Layer::Scalp, &line([100.0, 100.0], [200.0, 100.0]));
        let (same, said) = sketch_on(&scalp, Some(&upstream), &[beside]);
        assert!(same.curve_count() == 1 && said[0].contains("no hair is near"), "{said:?}");
    }

    #[test]
    fn a_copy_keeps_its_shape_and_values_and_turns_with_neighbours_alone() {
        let scalp = shared_ball();
        let mut b = lock(&scalp, 5, on_ball(&scalp, -6.0), 0.5, 0.0);
        b.set(RADIUS, Domain::Curve, vec![0.7]);
        b.set(DENSITY, Domain::Curve, vec![0.8]);
        b.set(FRIZZ, Domain::Curve, vec![0.3]);
        b.set(COLOUR, Domain::Curve, vec![Vec3::new(0.5, 0.25, 0.125)]);
        b.set(ROLL, Domain::Point, vec![0.0, 15.0, 15.0, 30.0, 30.0]);
        b.set(PINNED, Domain::Point, vec![0, 0, 1, 0, 0]);
        let first = Arc::new(b.build());
        let seen = Seen::new(&drawn(Tool::Comb, Layer::Scalp, &[Vec2::ZERO]).view, scalp.frame());
        let ends = [-6.0, 6.0].map(|x| seen.pixel(on_ball(&scalp, x)).unwrap());
        let stroke = drawn(Tool::Scatter, Layer::Scalp, &line(ends[0].into(), ends[1].into()));
        let alone = Curves::new(vec![first.clone()]);
        let local = |cvs: &[Vec3]| -> Vec<Vec3> {
            let own = RootFrame::at(&scalp, &scalp.closest_root(cvs[0]).unwrap());
            cvs.iter().map(|p| own.local(*p)).collect()
        };
        let (curves, said) = sketch_on(&scalp, Some(&alone), std::slice::from_ref(&stroke));
        assert!(said.is_empty() && curves.curve_count() > 5, "{said:?}");
        assert!(Arc::ptr_eq(&curves.tufts()[0], &first));
        for tuft in &curves.tufts()[1..] {
            for (k, p) in local(tuft.points()).iter().enumerate() {
                let wanted = Vec3::new(1.0, 0.5, 0.0) * k as f32;
                assert!(p.distance(wanted) < 0.01, "{k}: {p}");
            }
            assert_eq!(tuft.view(RADIUS).at(0, 0), 0.7);
            assert_eq!(tuft.view(DENSITY).at(0, 0), 0.8);
            assert_eq!(tuft.view(FRIZZ).at(0, 0), 0.3);
            assert_eq!(tuft.view(COLOUR).at(0, 0), Vec3::new(0.5, 0.25, 0.125));
            assert_eq!((tuft.view(ROLL).at(0, 1), tuft.view(ROLL).at(0, 4)), (15.0, 30.0));
            assert_eq!(tuft.view(PINNED).at(0, 2), 0);
        }
        // One at the far end leads aside: copies turn there, except for those more than tau (4 cm) away.
        let far = on_ball(&scalp, 6.0);
        let other = Arc::new(lock(&scalp, 6, far, 0.0, 1.0).build());
        let both = Curves::new(vec![first, other]);
        let (curves, _) = sketch_on(&scalp, Some(&both), &[stroke]);
        let mut turned = 0;
        for tuft in &curves.tufts()[2..] {
            let (p, root) = (local(tuft.points())[4], tuft.points()[0]);
            if root.distance(far) > 4.0 {
                assert!(p.distance(Vec3::new(4.0, 2.0, 0.0)) < 0.01, "{p}");
            } else if root.distance(roots(&curves)[0]) > 4.0 {
                // Only that one is near: its direction, 45 degrees aside, with the length of the copy.
                let wanted = Vec3::new(1.0, 0.0, 1.0).normalize() * 20f32.sqrt();
                assert!(p.distance(wanted) < 0.02, "{p}, not {wanted}");
                turned += 1;
            }
        }
        assert!(turned > 0);
    }

    #[test]
    fn copies_stay_out_of_a_rough_head_and_replay_as_they_were_drawn() {
        let scalp = head(&[]);
        // It lies close to the skin: half a cm out over four cm down.
        let top = scalp.frame().point_from_head(Vec3::new(-2.0, 6.0, 8.0));
        let upright = lock(&scalp, 5, scalp.closest_root(top).unwrap().point, 8.0, 0.0);
        let (p, q) = {
            let own = RootFrame::at(&scalp, &scalp.closest_root(top).unwrap());
            (own.world(Vec3::ZERO), own.world(Vec3::new(0.5, 4.0, 0.0)))
        };
        let close = with_points(&upright.build(), |points| {
            points.iter_mut().enumerate().for_each(|(k, on)| *on = p.lerp(q, k as f32 / 4.0));
        });
        let upstream = Curves::new(vec![Arc::new(close)]);
        let view = drawn(Tool::Comb, Layer::Scalp, &[Vec2::ZERO]).view;
        let seen = Seen::new(&view, scalp.frame());
        let at = seen.pixel(p).unwrap();
        // Over forehead and face to the other side, and down over eyes and nose.
        let mut way = line(at.into(), [-at.x, at.y]);
        way.extend(line([-at.x, at.y], [0.0, at.y + 300.0]));
        let stroke = Gesture { size: 60.0, ..drawn(Tool::Scatter, Layer::Scalp, &way) };
        let (curves, said) = sketch_on(&scalp, Some(&upstream), std::slice::from_ref(&stroke));
        // (A message that lengths follow the head's size is always there.)
        let undone = |said: &[String]| said.iter().any(|text| text.contains("gesture"));
        assert!(!undone(&said) && curves.curve_count() > 10, "{said:?} {}", curves.curve_count());
        for (tuft, i) in curves.each().skip(1) {
            let deep = tuft.curve(i).iter().map(|p| out_of(&scalp, *p)).fold(f32::MAX, f32::min);
            assert!(deep > -2e-3, "{deep}");
        }
        let kept = resolved(&stroke, &upstream, &curves, &scalp);
        assert_eq!((kept.path.len(), &kept.curves[..]), (curves.curve_count() - 1, &[5u64][..]));
        let (again, said) = sketch_on(&scalp, Some(&upstream), std::slice::from_ref(&kept));
        assert!(!undone(&said), "{said:?}");
        let (a, b) = (points(&curves), points(&again));
        assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
        for (id, cvs) in &a {
            let off = cvs.iter().zip(&b[id]).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            assert!(off < 1e-4, "{off}");
        }
        // On another head, all of them, out of the skin; without the one they copy, none.
        let (other, _) = sketch_on(&shared_ball(), Some(&upstream), std::slice::from_ref(&kept));
        assert_eq!(other.curve_count(), curves.curve_count());
        let (none, said) = sketch_on(&scalp, None, &[kept]);
        let gone = said.iter().any(|text| text.contains("its curve is not there any more"));
        assert!(none.curve_count() == 0 && gone, "{said:?}");
    }
}
