//! The comb of the paper (4.5), for gestures that store no size: it pushes CVs, as documents of before [`super::comb`] have it.
//!
//! The stroke is divided into segments of rho pixels; each segment moves the CVs within rho of its start along itself,
//! parallel to the plane of the picture.

use super::comb::turn_with;
use super::hand::{GestureContext, SketchState};
use super::lock::Lock;
use super::relax::Rest;
use super::seen::steps;
use glam::Vec2;
use std::sync::Arc;

/// Displacement of a CV at the start of a segment, as a fraction of rho.
const PUSH: f32 = 0.5;

pub(super) fn push(hand: &GestureContext, sketch: &mut SketchState) {
    let rho = hand.set.rho;
    let line = steps(&hand.line(), rho);
    let taken = hand.takes(
        sketch,
        |hand, sketch| hand.passed(sketch, &line, rho),
        "the comb passes no curve: begin on hair, or comb all layers",
    );
    let around = (hand.set.follow > 0.0).then(|| sketch.locks.clone());
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        if pushed(hand, &line, &mut lock, around.as_deref()) {
            sketch.locks[i] = lock.done();
        }
    }
}

fn pushed(
    hand: &GestureContext,
    line: &[Vec2],
    lock: &mut Lock,
    around: Option<&[Arc<Lock>]>,
) -> bool {
    let (rho, held) = (hand.set.rho, lock.held());
    let rest = Rest::of(&lock.points, held, &hand.skin);
    // Displacement of each CV, in pushes.
    let mut weights = vec![0.0f32; lock.points.len()];
    for pair in line.windows(2) {
        let (from, way) = (pair[0], pair[1] - pair[0]);
        // A stroke shorter than a segment pushes proportionally less.
        let push = way * (PUSH * hand.gesture.strength);
        let mut moved = false;
        for (p, weight) in lock.points.iter_mut().zip(&mut weights).skip(held + 1) {
            let Some(at) = hand.seen.pixel(*p) else { continue };
            let w = 1.0 - at.distance(from) / rho;
            if w > 0.0 {
                *p = hand.seen.at(at + push * w, hand.seen.depth(*p));
                *weight += w;
                moved = true;
            }
        }
        if moved {
            rest.lengthen(&mut lock.points, &hand.skin);
        }
    }
    if weights.iter().all(|w| *w == 0.0) {
        return false;
    }
    if let Some(around) = around {
        turn_with(hand, lock, around, &weights);
    }
    rest.relax(&mut lock.points, &hand.skin);
    true
}
