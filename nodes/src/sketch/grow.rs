//! Implant, silhouette and lengthen: a stroke in the picture becomes a curve in space (the paper's 4.1 and 4.2).
//!
//! A picture does not show the depth of a stroke. If nearby curves run in a similar direction in the picture, the
//! stroke takes their mean slope in depth; otherwise it stays at constant depth.
//!
//! Guarantees: segments have the length set on the node, adjusted to come out even; the curve starts on the head or at
//! the old tip, and none of its other CVs lies below the skin; an implant replaces curves whose root disc contains its
//! root. Once drawn (with a stored root), it replaces the curves it names and no others, so that none is lost on a head
//! where roots are closer together.

use super::hand::{GestureContext, SketchState};
use super::lock::{Implanted, Lock};
use super::relax::{CLEARANCE, Rest};
use super::seen::steps;
use super::silhouette::MedialLine;
use crate::data::gestures::RootFrame;
use crate::data::route::makers::lift_exactly;
use crate::data::scalp::{HeadFrame, Root, Scalp};
use crate::maths::hash::curve_id;
use crate::maths::polyline::Polyline;
use crate::maths::transcendental::atan2;
use glam::{Vec2, Vec3};

/// Steepest slope into the picture: depth by length in the picture.
const STEEPEST: f32 = 2.5;
/// Fraction of a segment's length that must be visible in the picture for its depth to count.
const SHOWS: f32 = 0.35;
/// Differences below this (cm) near the skin are rounding.
const NOTHING: f32 = 1e-3;
/// Rounds of smoothing turns wider than 60 degrees.
const ROUNDS: usize = 4;

pub(super) fn implant(hand: &GestureContext, sketch: &mut SketchState) {
    plant(hand, sketch, &hand.line(), |_| vec![hand.set.radius]);
}

pub(super) fn silhouette(hand: &GestureContext, sketch: &mut SketchState) {
    match MedialLine::of(&hand.line(), hand.set.rho) {
        Ok(drawn) => plant(hand, sketch, &drawn.line, |cvs| drawn.radii(&hand.seen, cvs)),
        Err(fault) => sketch.say(fault),
    }
}

/// A new cluster along a line in the picture, with the radii (cm) of its CVs.
fn plant(
    hand: &GestureContext,
    sketch: &mut SketchState,
    line: &[Vec2],
    radii: impl FnOnce(&[Vec3]) -> Vec<f32>,
) {
    let (root, drift) = match hand.gesture.root {
        Some(drawn) => {
            let drawn = hand.scalp.place(drawn);
            match hand.scalp.closest_root(drawn) {
                Some(root) => (root, root.point.distance(drawn)),
                None => return sketch.say("the head has no skin"),
            }
        }
        None => match hand.seen.head(hand.scalp, line[0]).or_else(|| hand.on_head()) {
            Some(hit) => (hand.scalp.root(hit.triangle, hit.bary), 0.0),
            None => {
                return sketch.say("it begins beside the head: begin an implant on the skin");
            }
        },
    };
    let points = match hand.gesture.path.is_empty() {
        true => {
            let drawn = stroke(hand, sketch, line, root.point, u64::MAX);
            let mut points = even(hand, root.point, drawn);
            clear(hand, &mut points, 0);
            points
        }
        false => {
            let own = RootFrame::at(hand.scalp, &root);
            let path = hand.gesture.path.iter().map(|p| own.world(*p));
            let drawn: Vec<Vec3> = std::iter::once(root.point).chain(path).collect();
            let mut points = drawn.clone();
            clear(hand, &mut points, 0);
            sketch.now.turned = Some(turned(&drawn, &points));
            points
        }
    };
    if length(&points) < 1e-3 {
        return sketch.say("it has no length: draw on from the root");
    }
    let names = &hand.gesture.curves;
    let held = |lock: &Lock| match hand.gesture.root {
        Some(_) => names.contains(&lock.id),
        None => lock.is_curve() && lock.root().distance(root.point) <= lock.radius,
    };
    let density = density_about(hand, sketch, &root);
    sketch.locks.retain(|lock| !held(lock));
    let id = curve_id(hand.gesture.id, hand.set.seed, 0);
    let radii = radii(&points);
    let asked = Implanted { root, radii, density, colour: hand.gesture.colour, drift };
    sketch.now.drift = hand.gesture.root.map(|_| drift);
    sketch.now.changed = 1;
    sketch.locks.push(std::sync::Arc::new(Lock::implanted(id, points, &asked, hand.scalp)));
}

pub(super) fn lengthen(hand: &GestureContext, sketch: &mut SketchState) {
    let near_end = |hand: &GestureContext, sketch: &SketchState| -> Vec<usize> {
        let off = |i: usize| {
            let lock = &sketch.locks[i];
            let tip = lock.is_curve().then(|| lock.tip())?;
            let far = hand.seen.pixel(tip)?.distance(hand.start());
            (far <= hand.set.rho && hand.seen.sees(hand.scalp, tip)).then_some((i, far))
        };
        let ends = (0..sketch.locks.len()).filter_map(off);
        ends.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i).into_iter().collect()
    };
    let taken = hand.takes(sketch, near_end, "no curve ends here: begin at a tip");
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let (tip, last) = (lock.tip(), lock.points.len() - 1);
        let mut points = lock.points.clone();
        match hand.gesture.path.is_empty() {
            true => {
                let more = even(hand, tip, stroke(hand, sketch, &hand.line(), tip, lock.id));
                points.extend(&more[1..]);
                let lengths = points.windows(2).map(|w| w[0].distance(w[1])).collect();
                Rest::new(lengths, last).relax(&mut points, &hand.skin);
            }
            false => {
                let own = onward(hand.scalp.frame(), &lock.points);
                points.extend(hand.gesture.path.iter().map(|p| own.world(*p)));
                let drawn = points[last..].to_vec();
                clear(hand, &mut points, last);
                let more = turned(&drawn, &points[last..]);
                sketch.now.turned = Some(sketch.now.turned.map_or(more, |most| most.max(more)));
            }
        }
        let places: Vec<f32> = (0..points.len()).map(|k| k.min(last) as f32).collect();
        lock.set_points(points, &places);
        lock.cut = None;
        sketch.locks[i] = lock.done();
    }
}

/// The stroke in space from `start`, as if it had been drawn from there.
pub(super) fn stroke(
    hand: &GestureContext,
    sketch: &SketchState,
    line: &[Vec2],
    start: Vec3,
    own: u64,
) -> Vec<Vec3> {
    let seen = &hand.seen;
    let Some(first) = seen.pixel(start) else { return vec![start] };
    let mut depth = seen.depth(start);
    let step = (hand.set.segment / seen.cm_per_pixel(depth)).max(2.0);
    let shift = first - line[0];
    let line: Vec<Vec2> = steps(line, step).into_iter().map(|p| p + shift).collect();
    let mut points = vec![start];
    for pair in line.windows(2) {
        let way = pair[1] - pair[0];
        let at = points[points.len() - 1];
        let slope = slope(hand, sketch, at, way, own).unwrap_or(0.0);
        depth += slope * way.length() * seen.cm_per_pixel(depth);
        depth = depth.max(0.2);
        points.push(seen.at(pair[1], depth));
    }
    points
}

/// Mean slope into the picture of curves near a position that run in a similar direction, weighted by proximity; `None`
/// if there are none.
fn slope(
    hand: &GestureContext,
    sketch: &SketchState,
    at: Vec3,
    way: Vec2,
    own: u64,
) -> Option<f32> {
    let seen = &hand.seen;
    let (mut sum, mut weights) = (0.0, 0.0);
    for lock in sketch.locks.iter().filter(|lock| lock.id != own && lock.is_curve()) {
        let far = |k: usize| lock.points[k].distance_squared(at);
        let k = (0..lock.points.len()).fold(0, |best, k| if far(k) < far(best) { k } else { best });
        let distance = far(k).sqrt();
        if distance >= hand.set.tau {
            continue;
        }
        let (a, b) = (lock.points[k.max(1) - 1], lock.points[k.max(1)]);
        let (Some(q), Some(r)) = (seen.pixel(a), seen.pixel(b)) else { continue };
        let along = r - q;
        let cm = along.length() * seen.cm_per_pixel(seen.depth(a));
        let alike = along.dot(way) >= hand.set.alike * along.length() * way.length();
        if cm >= SHOWS * a.distance(b) && cm > 0.0 && alike {
            let weight = 1.0 - distance / hand.set.tau;
            sum += weight * (seen.depth(b) - seen.depth(a)) / cm;
            weights += weight;
        }
    }
    (weights > 0.0).then(|| (sum / weights).clamp(-STEEPEST, STEEPEST))
}

/// The stroke without sharp turns, in segments of equal length.
pub(super) fn even(hand: &GestureContext, start: Vec3, mut points: Vec<Vec3>) -> Vec<Vec3> {
    for _ in 0..ROUNDS {
        for k in 1..points.len().saturating_sub(1) {
            let (a, b) = (points[k] - points[k - 1], points[k + 1] - points[k]);
            if a.dot(b) < 0.5 * a.length() * b.length() {
                points[k] = points[k].lerp(0.5 * (points[k - 1] + points[k + 1]), 0.5);
            }
        }
    }
    points[0] = start;
    if points.len() < 2 {
        return points;
    }
    let line = Polyline::new(points);
    let count = (line.length() / hand.set.segment).round().clamp(1.0, 4096.0) as usize;
    line.evenly(count + 1)
}

/// Moves all CVs beyond `held` out of the head, keeping segment lengths.
pub(super) fn clear(hand: &GestureContext, points: &mut [Vec3], held: usize) {
    if points[held + 1..].iter().any(|p| hand.skin.distance(*p) < CLEARANCE - NOTHING) {
        let lengths = points.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
        Rest::new(lengths, held).lengthen(points, &hand.skin);
        for p in &mut points[held + 1..] {
            *p = lift_exactly(&hand.skin, *p, CLEARANCE).0;
        }
    }
}

/// The frame for storing a continuation of these CVs.
pub(super) fn onward(frame: &HeadFrame, points: &[Vec3]) -> RootFrame {
    let tip = points[points.len() - 1];
    RootFrame::of(frame, tip, tip - points[points.len() - 2])
}

/// The result of an implant or lengthening that the gesture stores: its root and its path ([`Gesture::path`]). `before`
/// are the previous CVs, empty for an implant.
pub(super) fn kept(scalp: &Scalp, before: &[Vec3], after: &[Vec3]) -> Option<(Vec3, Vec<Vec3>)> {
    let frame = scalp.frame();
    let own = match before {
        [] => RootFrame::at(scalp, &scalp.closest_root(*after.first()?)?),
        [_] => return None,
        _ => onward(frame, before),
    };
    let new = after.get(before.len().max(1)..)?;
    Some((scalp.given(after[0]), new.iter().map(|p| own.local(*p)).collect()))
}

/// Mean angle between two lines with equally many points, degrees.
pub(super) fn turned(drawn: &[Vec3], made: &[Vec3]) -> f32 {
    let (mut sum, mut lengths) = (0.0, 0.0);
    for (a, b) in drawn.windows(2).zip(made.windows(2)) {
        let (a, b) = (a[1] - a[0], b[1] - b[0]);
        sum += a.length() * atan2(a.cross(b).length(), a.dot(b)).to_degrees();
        lengths += a.length();
    }
    if lengths > 0.0 { sum / lengths } else { 0.0 }
}

pub(super) fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Mean density of clusters near a root, weighted by proximity; the node's density if there are none.
fn density_about(hand: &GestureContext, sketch: &SketchState, root: &Root) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for lock in sketch.locks.iter().filter(|lock| lock.is_curve()) {
        let weight = 1.0 - lock.root().distance(root.point) / hand.set.tau;
        if weight > 0.0 {
            sum += weight * lock.density;
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { hand.set.density }
}
