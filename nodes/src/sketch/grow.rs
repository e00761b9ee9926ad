//! Implant, silhouette and lengthen: a stroke in the picture becomes a curve in space (the paper's 4.1 and 4.2).
//!
//! A picture does not show the depth of a stroke. If nearby curves run in a similar direction in the picture, the
//! stroke takes their mean slope in depth; otherwise it stays in the upright plane through where it began that faces the eye, so that
//! hair drawn from above hangs straight down. Where the skin is in the way, it passes before it; over the head, what does not fall
//! then follows the skin.
//!
//! Guarantees: a curve is where the stroke was drawn, within 3 pixels of the picture: it is brought out of the skin along the line
//! of sight, never aside. Segments have the length set on the node, adjusted to come out even, and shorter where the stroke
//! bends too sharply for that. The curve starts on the head or at the old tip, and none of its other CVs lies below the skin; an
//! implant replaces curves whose root disc contains its root. Once drawn (with a stored root), it replaces the curves it names
//! and no others, so that none is lost on a head where roots are closer together.

use super::hand::{GestureContext, SketchState, off_piece};
use super::lock::{Implanted, Lock, length};
use super::relax::{CLEARANCE, Rest};
use super::seen::Seen;
use super::silhouette::MedialLine;
use super::stroke_shape::resampled;
use crate::data::gestures::{Gesture, RootFrame, Tool};
use crate::data::route::makers::lift_exactly;
use crate::data::scalp::{HeadFrame, Root, Scalp};
use crate::maths::hash::curve_id;
use crate::maths::nearest_on;
use crate::maths::polyline::Polyline;
use crate::maths::spline::Spline;
use crate::maths::transcendental::atan2;
use glam::{Vec2, Vec3};

/// Steepest slope into the picture: depth by length in the picture.
const STEEPEST: f32 = 2.5;
/// Fraction of a segment's length that must be visible in the picture for its depth to count.
const SHOWS: f32 = 0.35;
/// Differences below this (cm) near the skin are rounding.
const NOTHING: f32 = 1e-3;
/// Steps in which a stroke is led over the head, pixels.
const FINE: f32 = 3.0;
/// Rounds of taking the tremor out of them; a right angle is cut by less than 2 pixels.
const ROUNDS: usize = 2;
/// A stroke that begins beside its curve has joined it after this many times their distance.
const JOINS: f32 = 3.0;
/// Slopes with which a stroke meets skin that stands out, such as an ear, and goes back behind it: depth by length in the
/// picture.
const MEETS: f32 = 2.5;
const RETURNS: f32 = 1.0;
/// How far a curve may be from the stroke in the picture (pixels), and cut into what it passes over (cm).
const ASIDE: f32 = 1.0;
const DEEP: f32 = 0.1;
/// The most segments that a stroke gets for that.
const MOST_BENT: usize = 256;

/// Where an implant or an outline is rooted on the head that it is drawn on, in head units; `None` beside the head. `rho`: reach of the
/// pen, pixels.
pub fn rooted(gesture: &Gesture, scalp: &Scalp, rho: f32) -> Option<Vec3> {
    let seen = Seen::new(&gesture.view, scalp.frame());
    let line: Vec<Vec2> = gesture.samples.iter().map(|sample| sample.at).collect();
    let first = match gesture.tool {
        Tool::Silhouette => MedialLine::of(&line, rho).ok()?.line.first().copied()?,
        _ => *line.first()?,
    };
    seen.head(scalp, first).map(|hit| scalp.given(hit.point))
}

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
        true => stroke(hand, sketch, line, root.point, u64::MAX),
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
    let nothing = "no curve ends here: begin at a tip";
    let taken = hand.takes_around(sketch, near_end, nothing, |lock| Some(lock.tip()));
    // What is drawn on, from the tip of that which is taken.
    let mut path = hand.gesture.path.clone();
    for (i, share) in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let (tip, last) = (lock.tip(), lock.points.len() - 1);
        let mut points = lock.points.clone();
        match path.is_empty() {
            true => {
                points.extend(&stroke(hand, sketch, &hand.line(), tip, lock.id)[1..]);
                if hand.gesture.size > 0.0 {
                    path = kept(hand.scalp, &lock.points, &points).map_or(vec![], |(_, path)| path);
                }
            }
            false => {
                let own = onward(hand.scalp.frame(), &lock.points);
                points.extend(path.iter().map(|p| own.world(*p * share)));
                let drawn = points[last..].to_vec();
                clear(hand, &mut points, last);
                if !hand.gesture.path.is_empty() {
                    let more = turned(&drawn, &points[last..]);
                    sketch.now.turned = Some(sketch.now.turned.map_or(more, |most| most.max(more)));
                }
            }
        }
        let places: Vec<f32> = (0..points.len()).map(|k| k.min(last) as f32).collect();
        lock.set_points(points, &places);
        lock.cut = None;
        sketch.locks[i] = lock.done();
    }
}

/// The CVs of a curve that begins at `start` and runs where the stroke was drawn.
pub(super) fn stroke(
    hand: &GestureContext,
    sketch: &SketchState,
    line: &[Vec2],
    start: Vec3,
    own: u64,
) -> Vec<Vec3> {
    let Some(first) = hand.seen.pixel(start) else { return vec![start] };
    let flat = begun_at(line, first);
    if flat.len() < 2 {
        return vec![start];
    }
    let depths = depths(hand, sketch, &flat, start, own);
    let mut drawn: Vec<Vec3> =
        flat.iter().zip(&depths).map(|(p, d)| hand.seen.at(*p, *d)).collect();
    drawn[0] = start;
    let drawn = Polyline::new(drawn);
    let mut count = (drawn.length() / hand.set.segment).round().clamp(1.0, 4096.0) as usize;
    while count < MOST_BENT && !follows(hand, &drawn, count) {
        count = (count + count.div_ceil(2)).min(MOST_BENT);
    }
    let mut points = drawn.evenly(count + 1);
    for p in &mut points[1..] {
        if let Some(at) = hand.seen.pixel(*p) {
            *p = hand.seen.at(at, hand.out_of_skin(at, hand.seen.depth(*p), CLEARANCE));
        }
    }
    points
}

/// The stroke in fine steps without its tremor, from another first point; what lies between is led from one to the other.
fn begun_at(line: &[Vec2], first: Vec2) -> Vec<Vec2> {
    let mut fine = resampled(line, FINE);
    fine.extend(line.last().filter(|last| fine.last().is_none_or(|p| p.distance(**last) > 0.1)));
    for _ in 0..ROUNDS {
        let before = fine.clone();
        for (p, w) in fine.iter_mut().skip(1).zip(before.windows(3)) {
            *p = (w[0] + w[1] * 2.0 + w[2]) * 0.25;
        }
    }
    let shift = first - line[0];
    let whole = FINE * (fine.len() - 1) as f32;
    let joined = (JOINS * shift.length()).min(whole).max(1e-3);
    for (k, p) in fine.iter_mut().enumerate() {
        *p += shift * (1.0 - FINE * k as f32 / joined).max(0.0);
    }
    fine
}

/// The depth at each fine step of a stroke from `start`, cm.
fn depths(
    hand: &GestureContext,
    sketch: &SketchState,
    flat: &[Vec2],
    start: Vec3,
    own: u64,
) -> Vec<f32> {
    let seen = &hand.seen;
    let up = hand.scalp.frame().up;
    // The depth at a step of the plane that a point lies in.
    let level = |p: Vec3, k: usize| seen.upright(flat[k], p, up).unwrap_or(seen.depth(p));
    let mut anchor = start;
    // What begins behind the head stays there.
    let hidden = !seen.sees(hand.scalp, start);
    let began = seen.depth(start);
    let piece = (hand.set.segment / seen.cm_per_pixel(began) / FINE).max(1.0) as usize;
    let cm = |k: usize, depth: f32| flat[k].distance(flat[k - 1]) * seen.cm_per_pixel(depth);
    let mut depths = vec![began];
    let mut told = None;
    for k in 1..flat.len() {
        let before = depths[k - 1];
        // Neighbours tell the slope for as long as a segment is.
        if (k - 1).is_multiple_of(piece) {
            let way = flat[(k - 1 + piece).min(flat.len() - 1)] - flat[k - 1];
            let middle = flat[(k - 1 + piece / 2).min(flat.len() - 1)];
            told = slope(hand, sketch, seen.at(middle, before), way, own);
        }
        let far = cm(k, before);
        let depth = match told {
            Some(slope) => before + slope * far,
            None => {
                let way = seen.at(flat[k], before) - seen.at(flat[k - 1], before);
                let falls = (-way.normalize_or_zero().dot(up)).max(0.0);
                let on = level(seen.at(flat[k - 1], before), k);
                // Over the head it follows the skin on; beside it, it goes no farther than it began.
                let over = !hidden && seen.head(hand.scalp, flat[k]).is_some();
                let most = if over { f32::MAX } else { level(anchor, k).max(on) };
                (on + RETURNS * (1.0 - falls) * far).min(most)
            }
        };
        let depth = match told.is_some() || hidden {
            true => hand.out_of_skin(flat[k], depth, CLEARANCE),
            false => hand.before_head(flat[k], depth, CLEARANCE),
        };
        if told.is_some() {
            anchor = seen.at(flat[k], depth);
        }
        depths.push(depth);
    }
    for k in (1..flat.len() - 1).rev() {
        let nearest = depths[k + 1] + MEETS * cm(k + 1, depths[k + 1]);
        if depths[k] > nearest {
            depths[k] = hand.out_of_skin(flat[k], nearest, CLEARANCE);
        }
    }
    depths
}

/// Whether the curve through that many equal segments stays by a drawn line.
fn follows(hand: &GestureContext, drawn: &Polyline, count: usize) -> bool {
    let seen = &hand.seen;
    let Ok(curve) = Spline::new(&drawn.evenly(count + 1)) else { return true };
    let about = 0.25 / count as f32;
    let mut far = 0.0;
    drawn.points.windows(2).all(|pair| {
        far += pair[0].distance(pair[1]);
        let u = far / drawn.length().max(1e-12);
        let (a, b, p) = (curve.at((u - about).max(0.0)), curve.at((u + about).min(1.0)), pair[1]);
        let (Some(from), Some(to), Some(at)) = (seen.pixel(a), seen.pixel(b), seen.pixel(p)) else {
            return true;
        };
        let (off, t) = off_piece(&[at], [from, to]);
        off <= ASIDE && seen.depth(a.lerp(b, t)) - seen.depth(p) <= DEEP
    })
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
        // The piece beside it: one farther back or on would lead off skin that bends.
        let pieces = lock.points.windows(2).map(|pair| {
            let ends = [pair[0], pair[1]];
            (nearest_on(ends, at).0.distance(at), ends)
        });
        let Some((distance, [a, b])) = pieces.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if distance >= hand.set.tau {
            continue;
        }
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
