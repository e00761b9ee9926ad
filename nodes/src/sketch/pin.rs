//! Hairpins: fix CVs in place, or free them (the paper's 4.6).
//!
//! A tap takes the CV nearest to the pen. A stroke with a size is a brush: it pins every CV that it passes over, or frees them where it
//! begins on a pinned one. Whatever lies between two pins, or between the root and the first pin, stays in place under combing.

use super::hand::{GestureContext, SketchState, off_piece};
use super::lock::Lock;

pub(super) fn pin(hand: &GestureContext, sketch: &mut SketchState) {
    if hand.gesture.size > 0.0 {
        return brush(hand, sketch);
    }
    let taken = hand.takes(sketch, GestureContext::under_start, "it is on no curve: tap on hair");
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        if let Some((k, _)) = hand.nearest_cv(&lock) {
            lock.pinned[k] = !lock.pinned[k];
            sketch.locks[i] = lock.done();
        }
    }
}

fn brush(hand: &GestureContext, sketch: &mut SketchState) {
    let (line, size) = (hand.line(), hand.gesture.size);
    let taken = hand.takes(
        sketch,
        |hand, sketch| hand.passed(sketch, &line, size),
        "the brush passes no curve: begin on hair",
    );
    let nearest = |i: &usize| {
        let lock: &Lock = &sketch.locks[*i];
        hand.nearest_cv(lock).map(|(k, off)| (off, lock.pinned[k]))
    };
    let first = taken.iter().filter_map(nearest).min_by(|a, b| a.0.total_cmp(&b.0));
    let pins = !first.is_some_and(|(off, pinned)| pinned && off <= size);
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let was = lock.pinned.clone();
        for k in 1..lock.points.len() {
            let at = hand.seen.pixel(lock.points[k]);
            if at.is_some_and(|at| off_piece(&line, [at, at]).0 <= size) {
                lock.pinned[k] = pins;
            }
        }
        if lock.pinned != was {
            sketch.locks[i] = lock.done();
        }
    }
}
