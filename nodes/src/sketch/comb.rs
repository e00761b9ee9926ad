//! Comb: hair under the pen follows it.
//!
//! The brush goes along the stroke in small steps. What of a curve lies under it, at CVs or between them, goes along in the
//! picture: all the way at its middle, less towards its edge. A curve first gets the CVs that the brush needs in the scale of
//! the picture. On request, combed hair also turns toward the depth of the curves around it, so that it looks right from the
//! side.
//!
//! Guarantees: those of [`super::relax`]: roots, pins and lengths stay, and hair is out of the head. What the brush moves lies
//! where the pen led it in the picture, as far as its length and its root let it: near the skin it keeps its height, farther off
//! its depth, and it comes out of the skin towards the eye. What the head hides does not move because of the brush.

use super::brush::falloff;
use super::hand::{GestureContext, SketchState, off_piece};
use super::lock::Lock;
use super::relax::{CLEARANCE, Rest};
use super::seen::steps;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Within this much of its radius, hair goes all the way with the brush.
const CORE: f32 = 0.25;
/// Free hair with less than this share beside hair that a pin holds is not meant.
const SLIGHT: f32 = 0.25;
/// Step of the brush, in its radius.
const STEP: f32 = 0.25;
/// Distance between CVs under the brush, in its radius; the least, and the least radius, pixels.
const SPACING: f32 = 1.0 / 6.0;
const CLOSEST: f32 = 2.0;
/// The most CVs of a curve: what Unreal reads.
const MOST_CVS: usize = 255;
/// Hair nearer to the skin than this (head units) lies on it, and keeps its height.
const LIES: f32 = 0.5;
/// Looks for that height on the line of sight.
const LOOKS: usize = 12;
/// Height that is met, cm.
const MET: f32 = 1e-3;

pub(super) fn comb(hand: &GestureContext, sketch: &mut SketchState) {
    let size = match hand.gesture.size {
        0.0 => hand.set.rho,
        size => size.max(CLOSEST),
    };
    let line = steps(&hand.line(), STEP * size);
    let taken = hand.takes(
        sketch,
        |hand, sketch| hand.passed(sketch, &line, size),
        "the comb passes no curve: enlarge it with ], or begin on hair",
    );
    let around = (hand.set.follow > 0.0).then(|| sketch.locks.clone());
    let (mut any, mut held) = (false, false);
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        match combed(hand, (&line, size), &mut lock, around.as_deref()) {
            Combed::Moved => (sketch.locks[i], any) = (lock.done(), true),
            Combed::Held => held = true,
            Combed::Missed => {}
        }
    }
    if held && !any {
        sketch.say("a pin holds this hair: comb it beyond its last pin, or tap the pin to free it");
    }
}

/// What the brush did to a curve.
enum Combed {
    Moved,
    /// It passed what a pin holds, and next to nothing else.
    Held,
    Missed,
}

fn combed(
    hand: &GestureContext,
    (line, size): (&[Vec2], f32),
    lock: &mut Lock,
    around: Option<&[Arc<Lock>]>,
) -> Combed {
    let (seen, held, strength) = (&hand.seen, lock.held(), hand.gesture.strength);
    let more = needed(hand, (line, size), lock);
    let before = lock.points.clone();
    lock.refine(&more, &hand.skin);
    let rest = Rest::of(&lock.points, held, &hand.skin).with_lengths_of(&before, &more);
    let each = 0..lock.points.len();
    let tubes: Vec<f32> = each.clone().map(|k| hand.tube(lock, k)).collect();
    let shown: Vec<bool> = lock.points.iter().map(|p| seen.sees(hand.scalp, *p)).collect();
    let heights: Vec<f32> = lock.points.iter().map(|p| hand.skin.distance(*p)).collect();
    // How far each CV has been moved by the brush, in its steps, and how far it stays behind it, pixels.
    let mut weights = vec![0.0f32; lock.points.len()];
    let mut behind = vec![Vec2::ZERO; lock.points.len()];
    // The largest share of what a pin holds, and of what is free.
    let (mut most_held, mut most_free) = (0.0f32, 0.0f32);
    for pair in line.windows(2) {
        let (from, way) = (pair[0], pair[1] - pair[0]);
        let drawn: Vec<Option<Vec2>> =
            each.clone().map(|k| seen.pixel(lock.points[k]).filter(|_| shown[k])).collect();
        let Some(middle) = middle(&drawn, &tubes, from) else { break };
        let mut lead: Option<(usize, f32)> = None;
        let mut wanted = vec![None; lock.points.len()];
        for k in each.clone().skip(1) {
            let (p, Some(at)) = (lock.points[k], drawn[k]) else { continue };
            let off = at.distance(middle);
            let edge = (off - CORE * size).max(0.0);
            let share = (falloff(edge, (1.0 - CORE) * size) * strength).min(1.0);
            if share <= 0.0 || k <= held {
                most_held = most_held.max(share);
                continue;
            }
            most_free = most_free.max(share);
            let to = at + (way + behind[k]) * share;
            let most = 2.0 * (to - at).length() * seen.cm_per_pixel(seen.depth(p));
            let height = (heights[k] < LIES * hand.set.unit).then_some(heights[k]);
            let depth = at_height(hand, to, seen.depth(p), height, most);
            lock.points[k] = seen.at(to, depth);
            wanted[k] = Some(to);
            weights[k] += share;
            if lead.is_none_or(|(_, least)| off < least) {
                lead = Some((k, off));
            }
        }
        if let Some((lead, _)) = lead {
            rest.follow(&mut lock.points, lead);
            rest.lengthen(&mut lock.points, &hand.skin);
        }
        for k in each.clone() {
            let left = wanted[k].zip(seen.pixel(lock.points[k])).map(|(to, at)| to - at);
            behind[k] = left.unwrap_or_default();
        }
    }
    match () {
        () if most_held > most_free && most_free < SLIGHT => return Combed::Held,
        () if most_free == 0.0 => return Combed::Missed,
        () => {}
    }
    if let Some(around) = around {
        turn_with(hand, lock, around, &weights);
    }
    rest.settle(&mut lock.points, &hand.skin);
    Combed::Moved
}

/// Where the brush takes hold of a curve whose CVs are drawn here: at the pen, or where that is on or beside a cluster, as much
/// nearer to its curve as the cluster is wide. None where nothing of it is drawn.
fn middle(drawn: &[Option<Vec2>], tubes: &[f32], pen: Vec2) -> Option<Vec2> {
    let places = drawn.windows(2).zip(tubes).filter_map(|(pair, tube)| {
        let (a, b) = (pair[0]?, pair[1]?);
        let (off, t) = off_piece(&[pen], [a, b]);
        Some((off, a.lerp(b, t), *tube))
    });
    let (_, on, tube) = places.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(pen + (on - pen).clamp_length_max(tube))
}

/// How many CVs each segment needs besides its ends so that the brush finds one wherever it passes.
fn needed(hand: &GestureContext, (line, size): (&[Vec2], f32), lock: &Lock) -> Vec<usize> {
    let long = |k: usize| -> Option<f32> {
        let ends = [hand.seen.pixel(lock.points[k])?, hand.seen.pixel(lock.points[k + 1])?];
        let reach = 2.0 * size + hand.tube(lock, k).max(hand.tube(lock, k + 1));
        let near = k >= lock.held() && off_piece(line, ends).0 <= reach;
        near.then(|| ends[0].distance(ends[1]))
    };
    let last = lock.points.len() - 1;
    let longs: Vec<f32> = (0..last).map(|k| long(k).unwrap_or(0.0)).collect();
    let room = MOST_CVS.saturating_sub(lock.points.len()) as f32;
    let spacing = (SPACING * size).max(CLOSEST).max(longs.iter().sum::<f32>() / room.max(1e-3));
    longs.iter().map(|long| ((long / spacing) as usize).min(MOST_CVS)).collect()
}

/// The depth under a pixel, from `depth` (cm) on: at a height over the skin where that is given, at most so far away from the eye;
/// in any case out of the skin.
fn at_height(
    hand: &GestureContext,
    pixel: Vec2,
    depth: f32,
    height: Option<f32>,
    most: f32,
) -> f32 {
    let farthest = depth + most;
    let mut depth = depth;
    for _ in 0..height.map_or(0, |_| LOOKS) {
        // The skin is at least as far off along the line of sight as it is.
        let off = hand.skin.distance(hand.seen.at(pixel, depth)) - height.unwrap_or_default();
        if off.abs() < MET {
            break;
        }
        depth = (depth + off).min(farthest);
    }
    hand.out_of_skin(pixel, depth, height.unwrap_or(CLEARANCE).min(CLEARANCE))
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
