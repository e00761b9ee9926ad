//! Hairpin: locks the CV nearest to the pen in its place, or frees it (the paper's 4.6).
//!
//! What lies between two pins, or the root and the first pin, stays where it is whatever combs the curve.

use super::hand::{Hand, Sketch};

pub(super) fn pin(hand: &Hand, sketch: &mut Sketch) {
    let taken = hand.takes(sketch, Hand::under_start, "it is on no curve: tap on hair");
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let off = |k: &usize| {
            hand.seen.pixel(lock.points[*k]).map_or(f32::MAX, |at| at.distance(hand.start()))
        };
        // (The root never moves.)
        let near = (1..lock.points.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(k) = near {
            lock.pinned[k] = !lock.pinned[k];
            sketch.locks[i] = lock.done();
        }
    }
}
