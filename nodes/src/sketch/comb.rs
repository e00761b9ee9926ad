//! Comb: pushes curves along the stroke (the paper's 4.5).
//!
//! The stroke is divided into segments of rho pixels; each segment moves the CVs within rho of its start along itself,
//! parallel to the plane of the picture. Beyond the paper: on request, combed hair also turns toward the depth of the
//! curves around it, so that it looks right from the side.

use super::hand::{GestureContext, SketchState};
use super::lock::Lock;
use super::relax::Rest;
use super::seen::steps;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Displacement of a CV at the start of a segment, as a fraction of rho.
const PUSH: f32 = 0.5;

pub(super) fn comb(hand: &GestureContext, sketch: &mut SketchState) {
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
        if combed(hand, &line, &mut lock, around.as_deref()) {
            sketch.locks[i] = lock.done();
        }
    }
}

fn combed(
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

/// Turns combed segments toward the depth of the curves around them.
fn turn_with(hand: &GestureContext, lock: &mut Lock, around: &[Arc<Lock>], weights: &[f32]) {
    let ahead = hand.seen.ahead();
    for (k, weight) in weights.iter().enumerate().skip(lock.held() + 1) {
        let (from, share) = (lock.points[k - 1], weight.min(1.0) * hand.set.follow);
        let way = lock.points[k] - from;
        let Some(slope) = slope_about(hand, lock.id, around, from, way) else { continue };
        // The component in the picture stays; the depth component becomes that of the other curves.
        let flat = way - ahead * way.dot(ahead);
        let depth = way.dot(ahead);
        let wanted = depth + (slope * flat.length() - depth) * share;
        let turned = (flat + ahead * wanted).normalize_or(way) * way.length();
        let shift = turned - way;
        lock.points[k..].iter_mut().for_each(|p| *p += shift);
    }
}

/// Slope into the picture of curves near a position that run in a similar direction: depth by length, weighted by
/// proximity; `None` if there are none.
fn slope_about(
    hand: &GestureContext,
    own: u64,
    around: &[Arc<Lock>],
    at: Vec3,
    way: Vec3,
) -> Option<f32> {
    let ahead = hand.seen.ahead();
    let flat = |v: Vec3| v - ahead * v.dot(ahead);
    let (mut sum, mut weights) = (0.0, 0.0);
    for other in around.iter().filter(|other| other.id != own && other.is_curve()) {
        let near = |k: &usize| other.points[*k].distance_squared(at);
        let k = (0..other.points.len()).min_by(|a, b| near(a).total_cmp(&near(b)))?.max(1);
        let distance = other.points[k].distance(at);
        let along = other.points[k] - other.points[k - 1];
        let (a, b) = (flat(along), flat(way));
        let alike = a.dot(b) >= hand.set.alike * a.length() * b.length();
        if distance < hand.set.tau && alike && a.length() > 0.35 * along.length() {
            let weight = 1.0 - distance / hand.set.tau;
            sum += weight * along.dot(ahead) / a.length();
            weights += weight;
        }
    }
    (weights > 0.0).then(|| sum / weights)
}
