//! Frizz: the width of a scribble beside a cluster sets how much its strands wander (the paper's 4.5).

use super::hand::{GestureContext, SketchState};
use super::stroke_shape::scribble;

pub(super) fn frizz(hand: &GestureContext, sketch: &mut SketchState) {
    let Some(scribble) = scribble(&hand.line(), hand.set.rho) else {
        return sketch.say("it is no scribble: go to and fro across the hair");
    };
    let taken = hand.takes_around(
        sketch,
        GestureContext::under_start_or_middle,
        "it is drawn over no curve: draw it on hair",
        |lock| hand.place_at_start(lock),
    );
    for (i, share) in taken {
        let mut lock = (*sketch.locks[i]).clone();
        // The drawn width of the cluster where the scribble began.
        let off = |k: &usize| {
            hand.seen.pixel(lock.points[*k]).map_or(f32::MAX, |at| at.distance(hand.start()))
        };
        let near = (0..lock.points.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        let depth = hand.seen.depth(lock.points[near]);
        let diameter = 2.0 * lock.radii[near] / hand.seen.cm_per_pixel(depth);
        let mut frizz = of_amplitude(scribble.amplitude * hand.gesture.strength, diameter);
        if share < 1.0 {
            frizz = lock.frizz + (frizz - lock.frizz) * share;
        }
        if frizz != lock.frizz {
            lock.frizz = frizz;
            sketch.locks[i] = lock.done();
        }
    }
}

/// The frizz of a scribble: 1 if it is as wide as the cluster or wider, 0 if a quarter of that or less.
pub(super) fn of_amplitude(amplitude: f32, diameter: f32) -> f32 {
    ((amplitude / diameter.max(1e-6) - 0.25) / 0.75).clamp(0.0, 1.0)
}
