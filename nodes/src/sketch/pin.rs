//! Hairpin: fixes the CV nearest to the pen, or frees it (the paper's 4.6).
//!
//! Whatever lies between two pins, or between the root and the first pin, stays in place under combing.

use super::hand::{Hand, Sketch};

pub(super) fn pin(hand: &Hand, sketch: &mut Sketch) {
    let taken = hand.takes(sketch, Hand::under_start, "it is on no curve: tap on hair");
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        if let Some((k, _)) = hand.nearest_cv(&lock) {
            lock.pinned[k] = !lock.pinned[k];
            sketch.locks[i] = lock.done();
        }
    }
}
