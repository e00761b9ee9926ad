//! Cut: ends curves where a straight stroke crosses them (the paper's 4.3).
//!
//! The stroke must enter a cluster on one side and leave it on the other. Depending on the layer, it cuts the nearest
//! curve, all curves down to the head, or removes whole curves rooted where it crosses the head. Beyond the paper: the
//! curve stores the plane of the stroke, and Cluster to strands ends each strand in it, so that an angled cut stays
//! angled. It stores the length that it had, too: Flow from strokes ends there what the cut crosses, and leaves the rest as long
//! as it was. With a size, curves around that reach beyond the line of the stroke lose a share of what lies beyond it.

use super::hand::{GestureContext, SketchState, off_line};
use super::lock::{Lock, length, way};
use crate::data::gestures::Layer;
use crate::data::route::makers::lift_exactly;
use glam::{Vec2, Vec3};

/// A cut is angled if the cosine between the hair and the cut's normal exceeds this: 75 degrees.
const BIAS: f32 = 0.26;
/// How far the line of a stroke leads on to each side, in its lengths.
const BEYOND: f32 = 100.0;
/// A curve that a cut would make shorter than this (cm) is removed whole.
const SHORTEST: f32 = 0.1;

pub(super) fn cut(hand: &GestureContext, sketch: &mut SketchState) {
    let line = hand.line();
    let stroke = [line[0], line[line.len() - 1]];
    let nothing = match hand.gesture.layer {
        Layer::Scalp => "it crosses no roots on the head",
        _ => "it crosses no curve from side to side: begin and end beside the hair",
    };
    let under = |hand: &GestureContext, sketch: &SketchState| crossed(hand, sketch, stroke);
    if hand.gesture.layer == Layer::Scalp {
        let taken = hand.takes(sketch, under, nothing);
        let mut gone = vec![false; sketch.locks.len()];
        taken.into_iter().for_each(|i| gone[i] = true);
        let mut gone = gone.into_iter();
        sketch.locks.retain(|_| !gone.next().unwrap_or(false));
        return;
    }
    // Curves around may end beside the stroke: they meet its line.
    let far = (stroke[1] - stroke[0]) * BEYOND;
    let on = [stroke[0] - far, stroke[1] + far];
    let meets = |lock: &Lock| {
        let (k, t) = crossing(hand, lock, on)?;
        Some(lock.points[k].lerp(lock.points[k + 1], t))
    };
    let taken = hand.takes_around(sketch, under, nothing, meets);
    let mut gone = vec![false; sketch.locks.len()];
    for (i, share) in taken {
        let line = if share < 1.0 { on } else { stroke };
        let crossing = crossing(hand, &sketch.locks[i], line);
        let Some((k, t)) = crossing.and_then(|at| part_of(&sketch.locks[i], at, share)) else {
            continue;
        };
        let mut lock = (*sketch.locks[i]).clone();
        lock.uncut = lock.uncut.max(length(&lock.points));
        match shorter(hand, &mut lock, k, t) {
            true => {
                let to = way(&lock.points);
                let normal = hand.seen.plane(stroke[0], stroke[1]);
                let normal = if normal.dot(to) < 0.0 { -normal } else { normal };
                // A plane along the hair ends nothing.
                lock.cut = (normal.dot(to) > BIAS).then_some([normal, to]);
                sketch.locks[i] = lock.done();
            }
            false => gone[i] = true,
        }
    }
    let mut gone = gone.into_iter();
    sketch.locks.retain(|_| !gone.next().unwrap_or(false));
}

/// Curves that the stroke crosses.
fn crossed(hand: &GestureContext, sketch: &SketchState, stroke: [Vec2; 2]) -> Vec<usize> {
    let locks = sketch.locks.iter().enumerate().filter(|(_, lock)| lock.is_curve());
    if hand.gesture.layer == Layer::Scalp {
        let at_root = |lock: &Lock| {
            let root = lock.root();
            let wide = lock.radius / hand.seen.cm_per_pixel(hand.seen.depth(root));
            let near = hand.seen.pixel(root).is_some_and(|at| off_line(&stroke, at) <= wide);
            near && hand.seen.sees(hand.scalp, root)
        };
        return locks.filter(|(_, lock)| at_root(lock)).map(|(i, _)| i).collect();
    }
    let mut met: Vec<(usize, f32)> = vec![];
    for (i, lock) in locks {
        let Some((k, t)) = crossing(hand, lock, stroke) else { continue };
        let at = lock.points[k].lerp(lock.points[k + 1], t);
        let wide =
            lock.radii[k].max(lock.radii[k + 1]) / hand.seen.cm_per_pixel(hand.seen.depth(at));
        // Both ends must be beside the cluster as drawn.
        let Some(drawn) = hand.drawn(lock) else { continue };
        let drawn: Vec<Vec2> = drawn.into_iter().map(|(at, _)| at).collect();
        let beside = stroke.iter().all(|end| off_line(&drawn, *end) > wide);
        if beside && hand.seen.sees(hand.scalp, at) {
            met.push((i, hand.seen.depth(at)));
        }
    }
    met.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let most = if hand.gesture.layer == Layer::Nearest { 1 } else { usize::MAX };
    met.into_iter().take(most).map(|(i, _)| i).collect()
}

/// The first crossing of a curve, starting at its root: the segment and the fraction along it, whether or not it is
/// beyond the last pin.
fn crossing(hand: &GestureContext, lock: &Lock, [a, b]: [Vec2; 2]) -> Option<(usize, f32)> {
    let drawn = hand.drawn(lock)?;
    drawn.windows(2).enumerate().find_map(|(k, pair)| {
        let (p, q) = (pair[0].0, pair[1].0);
        let (r, s) = (q - p, b - a);
        let det = r.perp_dot(s);
        if det == 0.0 {
            return None;
        }
        let (t, u) = ((a - p).perp_dot(s) / det, (a - p).perp_dot(r) / det);
        if !((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)) {
            return None;
        }
        // Linear in the picture is not linear in space.
        let (near, far) = (pair[0].1, pair[1].1);
        let t = if hand.seen.is_parallel() { t } else { t * near / (far + (near - far) * t) };
        Some((k, t))
    })
}

/// Where a curve ends that loses only a share of what lies beyond a place on it.
fn part_of(lock: &Lock, (k, t): (usize, f32), share: f32) -> Option<(usize, f32)> {
    if share >= 1.0 {
        return Some((k, t));
    }
    let rest = std::iter::once(lock.points[k].lerp(lock.points[k + 1], t));
    let rest: Vec<Vec3> = rest.chain(lock.points[k + 1..].iter().copied()).collect();
    let lengths = rest.windows(2).map(|pair| pair[0].distance(pair[1]));
    let mut left = (1.0 - share) * lengths.clone().sum::<f32>();
    for (n, length) in lengths.enumerate() {
        if left < length {
            // Of the first piece, a part lies before the place.
            let from = if n == 0 { t } else { 0.0 };
            return Some((k + n, from + (1.0 - from) * left / length));
        }
        left -= length;
    }
    None
}

/// Ends a curve in its segment `k`, at the fraction `t`, keeping the spacing of its CVs. False if nothing is left.
fn shorter(hand: &GestureContext, lock: &mut Lock, k: usize, t: f32) -> bool {
    let mut kept: Vec<Vec3> = lock.points[..=k].to_vec();
    let mut places: Vec<f32> = (0..=k).map(|k| k as f32).collect();
    // Between two CVs outside the head, a curve may pass through it.
    let (end, _) = lift_exactly(&hand.skin, lock.points[k].lerp(lock.points[k + 1], t), 0.0);
    let segment = lock.points[k].distance(lock.points[k + 1]);
    // A short last segment merges with the previous one, if that is free.
    if t * segment < 0.3 * segment && kept.len() > 1 && !lock.pinned[k] {
        kept.pop();
        places.pop();
    }
    kept.push(end);
    places.push(k as f32 + t);
    if length(&kept) < SHORTEST {
        return false;
    }
    lock.set_points(kept, &places);
    true
}
