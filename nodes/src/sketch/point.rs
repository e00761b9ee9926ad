//! Point: moves one CV with the pen, and with a size those of the same curve around it, the less the farther they are; beyond the
//! paper, for finishing touches.
//!
//! Guarantees: roots, pins and everything before a pin stay; the CV moves in the picture as far as the pen went. What moves keeps its
//! depth, but where the skin is in the way it comes out of it towards the eye. Lengths are not kept: the CV is where the pen put
//! it.

use super::brush::falloff;
use super::hand::{GestureContext, SketchState};
use super::relax::CLEARANCE;

/// A pen movement shorter than this (pixels) moves nothing.
const STILL: f32 = 0.5;

pub(super) fn point(hand: &GestureContext, sketch: &mut SketchState) {
    let nearest = |hand: &GestureContext, sketch: &SketchState| -> Vec<usize> {
        let seen = |i: usize| {
            let lock = &sketch.locks[i];
            let (k, off) = hand.nearest_cv(lock).filter(|(_, off)| *off <= hand.set.rho)?;
            hand.seen.sees(hand.scalp, lock.points[k]).then_some((i, off))
        };
        let all = (0..sketch.locks.len()).filter_map(seen);
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i).into_iter().collect()
    };
    let taken = hand.takes(sketch, nearest, "no point of a curve is here: begin on one");
    let line = hand.line();
    let way = line[line.len() - 1] - line[0];
    if way.length() < STILL {
        return sketch.say("it is no way: drag the point on");
    }
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let Some((k, _)) = hand.nearest_cv(&lock) else { continue };
        let held = lock.held();
        if held > 0 && k <= held {
            sketch.say("a pin holds this point: tap the pin to free it");
            continue;
        }
        let Some(middle) = hand.seen.pixel(lock.points[k]) else { continue };
        let size = hand.gesture.size;
        let mut moved = false;
        for n in held + 1..lock.points.len() {
            let p = lock.points[n];
            let Some(at) = hand.seen.pixel(p) else { continue };
            let share = match n == k {
                true => 1.0,
                false if size > 0.0 => falloff(at.distance(middle), size),
                false => 0.0,
            };
            if share <= 0.0 {
                continue;
            }
            let (to, height) = (at + way * share, hand.skin.distance(p).min(CLEARANCE));
            let depth = match hand.seen.sees(hand.scalp, p) {
                true => hand.before_head(to, hand.seen.depth(p), height),
                false => hand.out_of_skin(to, hand.seen.depth(p), height),
            };
            lock.points[n] = hand.seen.at(to, depth);
            moved |= lock.points[n] != p;
        }
        if moved {
            sketch.locks[i] = lock.done();
        }
    }
}
