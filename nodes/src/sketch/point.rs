//! Point: moves one CV with the pen, and with a size those around it, of its curve and of others, the less the farther they are;
//! beyond the paper, for finishing touches.
//!
//! Guarantees: roots, pins and everything before a pin stay; the CV moves in the picture as far as the pen went. What moves keeps its
//! depth, but where the skin is in the way it comes out of it towards the eye. Lengths are not kept: the CV is where the pen put
//! it.

use super::hand::{GestureContext, SketchState};
use super::relax::CLEARANCE;
use glam::Vec3;

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
    let nothing = "no point of a curve is here: begin on one";
    let taken = hand.takes_around(sketch, nearest, nothing, |lock| hand.place_at_start(lock));
    let line = hand.line();
    let way = line[line.len() - 1] - line[0];
    if way.length() < STILL {
        return sketch.say("it is no way: drag the point on");
    }
    // Where the points are that the pen takes.
    let mut centres: Vec<Vec3> = vec![];
    for (i, whole) in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let held = lock.held();
        let own = match hand.nearest_cv(&lock) {
            Some((k, _)) if whole == 1.0 => {
                if held > 0 && k <= held {
                    sketch.say("a pin holds this point: tap the pin to free it");
                    continue;
                }
                centres.push(lock.points[k]);
                Some(k)
            }
            _ => None,
        };
        let mut moved = false;
        for n in held + 1..lock.points.len() {
            let p = lock.points[n];
            let shares = centres.iter().map(|centre| hand.share(*centre, p));
            let share = if own == Some(n) { 1.0 } else { shares.fold(0.0, f32::max) };
            let Some(at) = hand.seen.pixel(p).filter(|_| share > 0.0) else { continue };
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
