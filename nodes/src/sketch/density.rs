//! Density: each full circle makes clusters a twentieth denser (clockwise) or thinner (the paper's 4.4).

use super::hand::{GestureContext, SketchState, off_line};
use super::stroke_shape::full_circles;
use crate::data::gestures::Layer;
use glam::Vec2;

/// Change of density per circle.
pub(super) const STEP: f32 = 0.05;

pub(super) fn density(hand: &GestureContext, sketch: &mut SketchState) {
    let line = hand.line();
    let turns = full_circles(&line, hand.set.rho);
    if turns == 0 {
        return sketch.say("it closes no circle: draw all the way round");
    }
    let taken = hand.takes_around(
        sketch,
        |hand, sketch| within(hand, sketch, &line),
        "there is no curve in the circle",
        |lock| hand.place_at_start(lock),
    );
    for (i, share) in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let step = STEP * turns as f32 * hand.gesture.strength * share;
        let filled = (lock.density + step).clamp(0.0, 1.0);
        if filled != lock.density {
            lock.density = filled;
            sketch.locks[i] = lock.done();
        }
    }
}

fn within(hand: &GestureContext, sketch: &SketchState, line: &[Vec2]) -> Vec<usize> {
    let middle = line.iter().sum::<Vec2>() / line.len() as f32;
    let locks = sketch.locks.iter().enumerate().filter(|(_, lock)| lock.is_curve());
    match hand.gesture.layer {
        Layer::Nearest => {
            // The curve nearest to the circle's centre; of equally near ones, the one nearest to the eye.
            if let Some((i, _)) = hand.met(sketch, middle).first() {
                return vec![*i];
            }
            let off = locks.filter_map(|(i, lock)| {
                let drawn: Vec<Vec2> = hand.drawn(lock)?.into_iter().map(|(at, _)| at).collect();
                let seen = lock.points[1..].iter().any(|p| hand.seen.sees(hand.scalp, *p));
                seen.then_some((i, off_line(&drawn, middle)))
            });
            off.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i).into_iter().collect()
        }
        Layer::Through => {
            // Most of its CVs inside the circle, on this side of the head.
            let inside = |lock: &super::lock::Lock| {
                let seen = |p: &&glam::Vec3| {
                    hand.seen.pixel(**p).is_some_and(|at| encloses(line, at))
                        && hand.seen.sees(hand.scalp, **p)
                };
                2 * lock.points.iter().filter(seen).count() > lock.points.len()
            };
            locks.filter(|(_, lock)| inside(lock)).map(|(i, _)| i).collect()
        }
        Layer::Scalp => {
            let rooted = |root: glam::Vec3| {
                hand.seen.pixel(root).is_some_and(|at| encloses(line, at))
                    && hand.seen.sees(hand.scalp, root)
            };
            locks.filter(|(_, lock)| rooted(lock.root())).map(|(i, _)| i).collect()
        }
    }
}

/// Whether a closed line goes around a pixel.
fn encloses(line: &[Vec2], at: Vec2) -> bool {
    let mut round = 0;
    let ends = line.iter().zip(line.iter().cycle().skip(1));
    for (a, b) in ends {
        if (a.y <= at.y) != (b.y <= at.y) {
            let side = (*b - *a).perp_dot(at - *a);
            round += match (side > 0.0, b.y > a.y) {
                (true, true) => 1,
                (false, false) => -1,
                _ => 0,
            };
        }
    }
    round != 0
}
