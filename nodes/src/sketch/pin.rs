//! Hairpin: fixes the CV nearest to the pen, or frees it (the paper's 4.6).
//!
//! Whatever lies between two pins, or between the root and the first pin, stays in place under combing.

use super::hand::{GestureContext, SketchState};

pub(super) fn pin(hand: &GestureContext, sketch: &mut SketchState) {
    let taken = hand.takes(sketch, GestureContext::under_start, "it is on no curve: tap on hair");
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        if let Some((k, _)) = hand.nearest_cv(&lock) {
            lock.pinned[k] = !lock.pinned[k];
            sketch.locks[i] = lock.done();
        }
    }
}
