//! Soft brushes beyond the paper: smooth, puff, grab and straighten, each with a size and a falloff.
//!
//! Guarantees of all: those of [`super::relax`]; CVs farther from the brush than its size do not move because of it,
//! but CVs beyond moved ones follow, because lengths stay.

use super::hand::{GestureContext, SketchState};
use super::lock::Lock;
use super::relax::Rest;
use super::seen::steps;
use crate::data::gestures::Tool;
use crate::maths::smoothstep;
use glam::Vec2;

/// Lift of one step of a puff under the centre of the brush, head units.
const LIFT: f32 = 0.12;
/// Fraction of the way to smooth or straight per step there.
const SHARE: f32 = 0.35;

pub(super) fn brush(hand: &GestureContext, sketch: &mut SketchState) {
    let size = hand.reach();
    let line = steps(&hand.line(), 0.25 * size);
    let taken = hand.takes(
        sketch,
        |hand, sketch| hand.passed(sketch, &line, size),
        "the brush passes no curve: begin on hair",
    );
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        if brushed(hand, &line, size, &mut lock) {
            sketch.locks[i] = lock.done();
        }
    }
}

/// 1 under the centre of the brush, 0 at its edge, flat at both.
pub(super) fn falloff(off: f32, size: f32) -> f32 {
    smoothstep(1.0 - off / size)
}

fn brushed(hand: &GestureContext, line: &[Vec2], size: f32, lock: &mut Lock) -> bool {
    let held = lock.held();
    let rest = Rest::of(&lock.points, held, &hand.skin);
    let was = lock.points.clone();
    let strength = hand.gesture.strength;
    if hand.gesture.tool == Tool::Grab {
        let way = line[line.len() - 1] - line[0];
        for p in &mut lock.points[held + 1..] {
            let Some(at) = hand.seen.pixel(*p) else { continue };
            let share = falloff(at.distance(line[0]), size) * strength;
            *p = hand.seen.at(at + way * share, hand.seen.depth(*p));
        }
    } else {
        for at in line {
            step(hand, *at, size, held, lock);
            rest.lengthen(&mut lock.points, &hand.skin);
        }
    }
    if lock.points == was {
        return false;
    }
    rest.relax(&mut lock.points, &hand.skin);
    true
}

/// One position of the brush.
fn step(hand: &GestureContext, at: Vec2, size: f32, held: usize, lock: &mut Lock) {
    let was = lock.points.clone();
    let last = was.len() - 1;
    let (from, to) = (was[held], was[last]);
    for k in held + 1..=last {
        let Some(pixel) = hand.seen.pixel(was[k]) else { continue };
        let share = falloff(pixel.distance(at), size) * hand.gesture.strength;
        if share == 0.0 {
            continue;
        }
        let wanted = match hand.gesture.tool {
            Tool::Smooth if k < last => 0.5 * (was[k - 1] + was[k + 1]),
            Tool::Straighten => from.lerp(to, (k - held) as f32 / (last - held) as f32),
            Tool::Puff => {
                let out = hand
                    .skin
                    .closest(was[k])
                    .map(|hit| hand.scalp.surface().smooth_normal(hit.triangle, hit.bary));
                lock.points[k] += out.unwrap_or_default() * (LIFT * hand.set.unit * share);
                continue;
            }
            _ => continue,
        };
        lock.points[k] = was[k].lerp(wanted, (SHARE * share).min(1.0));
    }
}
