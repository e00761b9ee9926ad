//! Point: moves one CV with the pen, and no other; beyond the paper, for finishing touches.
//!
//! Guarantees: roots, pins and everything before a pin stay; the CV moves in the picture as far as the pen went. It keeps its
//! depth, but where the skin is in the way it comes out of it towards the eye. Lengths are not kept: the CV is where the pen put
//! it.

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
        let p = lock.points[k];
        let Some(at) = hand.seen.pixel(p) else { continue };
        let (to, height) = (at + way, hand.skin.distance(p).min(CLEARANCE));
        let depth = match hand.seen.sees(hand.scalp, p) {
            true => hand.before_head(to, hand.seen.depth(p), height),
            false => hand.out_of_skin(to, hand.seen.depth(p), height),
        };
        lock.points[k] = hand.seen.at(to, depth);
        if lock.points[k] != p {
            sketch.locks[i] = lock.done();
        }
    }
}
