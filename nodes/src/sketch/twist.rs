//! Twist: each loop of a stroke turns the cross-section of a cluster by 15 degrees from the CV nearest to it on (the paper's 4.5).

use super::hand::{Hand, Sketch, off_line};
use super::seen::steps;
use glam::Vec2;

/// Turn of one loop, degrees.
pub(super) const TURN: f32 = 15.0;
/// A stroke is looked at in steps of so many pixels, a fifteenth of rho.
const STEP: f32 = 2.0;
/// The most steps that are compared with each other.
const MOST: usize = 1500;

pub(super) fn twist(hand: &Hand, sketch: &mut Sketch, number: usize) {
    let loops = overlaps(&hand.line(), hand.set.rho);
    if loops.is_empty() {
        return sketch.told.push((number, "it makes no loop: let it cross itself".into()));
    }
    let taken = hand.takes(
        sketch,
        number,
        Hand::under_start_or_middle,
        "it is drawn over no curve: draw it on hair",
    );
    let mut turned = false;
    for i in &taken {
        let mut lock = (*sketch.locks[*i]).clone();
        let Some(drawn) = hand.drawn(&lock) else { continue };
        let line: Vec<Vec2> = drawn.iter().map(|(at, _)| *at).collect();
        let mut changed = false;
        for (at, sign) in &loops {
            // The root's cross-section does not turn.
            let far = |k: &usize| line[*k].distance_squared(*at);
            let near = (1..line.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
            let Some(k) = near else { continue };
            let wide = lock.radius / hand.seen.cm_per_pixel(drawn[k].1);
            if off_line(&line, *at) <= wide {
                let turn = TURN * sign * hand.gesture.strength;
                lock.roll[k..].iter_mut().for_each(|roll| *roll += turn);
                changed = true;
            }
        }
        if changed {
            sketch.locks[*i] = lock.done();
        }
        turned |= changed;
    }
    if !turned && !taken.is_empty() {
        sketch.told.push((number, "none of its loops lies on the hair it begins on".into()));
    }
}

/// Where a stroke crosses itself, each loop once, and which way: 1 clockwise, -1 not. Loops shorter than half of rho are tremor.
pub(super) fn overlaps(line: &[Vec2], rho: f32) -> Vec<(Vec2, f32)> {
    let length: f32 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let step = (STEP * rho / 30.0).max(length / MOST as f32);
    let line = steps(line, step.max(1e-3));
    let apart = (0.5 * rho / step).ceil().max(2.0) as usize;
    let mut found: Vec<(Vec2, f32)> = vec![];
    // Each crossing closes the loop since the one before it: the latest start.
    let mut from = 0;
    for j in apart..line.len().saturating_sub(1) {
        let (c, d) = (line[j], line[j + 1]);
        let crossed = (from..=j - apart).rev().find_map(|i| {
            let (a, b) = (line[i], line[i + 1]);
            let (r, s) = (b - a, d - c);
            let det = r.perp_dot(s);
            let (t, u) = ((c - a).perp_dot(s) / det, (c - a).perp_dot(r) / det);
            let meets = det != 0.0 && (0.0..1.0).contains(&t) && (0.0..1.0).contains(&u);
            meets.then(|| (i, a + r * t))
        });
        if let Some((i, at)) = crossed {
            // The loop's area tells which way it ran; y goes down.
            let loop_ = &line[i + 1..=j];
            let area: f32 = loop_
                .iter()
                .zip(loop_.iter().cycle().skip(1))
                .map(|(p, q)| (*p - at).perp_dot(*q - at))
                .sum();
            found.push((at, if area >= 0.0 { 1.0 } else { -1.0 }));
            from = j;
            if from + apart >= line.len() {
                break;
            }
        }
    }
    found
}
