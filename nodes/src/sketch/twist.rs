//! Twist: each loop of a stroke twists a cluster by 15 degrees from the CV nearest to the loop on (the paper's 4.5).

use super::hand::{GestureContext, SketchState, off_line};
use super::stroke_shape::{Loop, loops};
use glam::Vec2;

/// Twist per loop, degrees.
pub(super) const TURN: f32 = 15.0;
pub(super) fn twist(hand: &GestureContext, sketch: &mut SketchState) {
    let loops = loops(&hand.line(), hand.set.rho);
    if loops.is_empty() {
        return sketch.say("it makes no loop: lead it round to where it came by");
    }
    let taken = hand.takes_around(
        sketch,
        GestureContext::under_start_or_middle,
        "it is drawn over no curve: draw it on hair",
        |lock| hand.place_at_start(lock),
    );
    // Loops that lie on hair that is taken turn what follows, too.
    let mut turns = vec![false; loops.len()];
    for (i, share) in &taken {
        let mut lock = (*sketch.locks[*i]).clone();
        let Some(drawn) = hand.drawn(&lock) else { continue };
        let line: Vec<Vec2> = drawn.iter().map(|(at, _)| *at).collect();
        let mut changed = false;
        for (Loop { at, sign }, turns) in loops.iter().zip(&mut turns) {
            // The root's cross-section does not turn.
            let far = |k: &usize| line[*k].distance_squared(*at);
            let near = (1..line.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
            let Some(k) = near else { continue };
            let wide = lock.radii[k] / hand.seen.cm_per_pixel(drawn[k].1);
            *turns |= *share == 1.0 && off_line(&line, *at) <= wide;
            if off_line(&line, *at) <= wide || *share < 1.0 && *turns {
                let turn = TURN * sign * hand.gesture.strength * share;
                lock.roll[k..].iter_mut().for_each(|roll| *roll += turn);
                changed = true;
            }
        }
        if changed {
            sketch.locks[*i] = lock.done();
        }
    }
    if turns.iter().all(|turns| !turns) && !taken.is_empty() {
        sketch.say("none of its loops lies on the hair it begins on");
    }
}
