//! Re-draw: from where the stroke begins on a curve, the curve follows the stroke to its end; beyond the paper. With a size, curves
//! around go a share of the way to the same path, from where they pass the beginning, and keep their CVs.
//!
//! It takes the depth of the curves around it, and keeps its place in the picture, as an implant would. Guarantees: everything before that point stays, and
//! so do pins: a curve is redrawn only beyond its last one. Its values (radius, twist and all other attributes) keep
//! their positions from there to the tip. The drawn part is stored in a frame at that point, which is located on each
//! head where the stroke begins.

use super::grow::{clear, onward, stroke, turned};
use super::hand::{GestureContext, SketchState, off_line};
use super::lock::{Lock, length};
use super::relax::CLEARANCE;
use super::seen::Seen;
use crate::data::gestures::{Gesture, RootFrame};
use crate::data::route::makers::lift_exactly;
use crate::data::scalp::{Scalp, Skin};
use crate::maths::polyline::Polyline;
use glam::{Vec2, Vec3};

/// A position closer to a CV than this fraction of a segment is that CV.
const AT_CV: f32 = 0.1;
/// The shortest stroke, in segments.
const SHORTEST: f32 = 0.25;

pub(super) fn redraw(hand: &GestureContext, sketch: &mut SketchState) {
    let nearest = |hand: &GestureContext, sketch: &SketchState| -> Vec<usize> {
        let seen = |i: usize| {
            let lock = &sketch.locks[i];
            let (place, off) = place(&hand.seen, &lock.points, hand.start())?;
            let p = at(&lock.points, place);
            (off <= hand.set.rho && hand.seen.sees(hand.scalp, p)).then_some((i, off))
        };
        let curves = (0..sketch.locks.len()).filter(|i| sketch.locks[*i].is_curve());
        let all = curves.filter_map(seen);
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i).into_iter().collect()
    };
    let nothing = "no curve is here: begin on the one to draw anew";
    let begins = |lock: &Lock| {
        let (place, _) = place(&hand.seen, &lock.points, hand.start())?;
        Some(at(&lock.points, place))
    };
    let taken = hand.takes_around(sketch, nearest, nothing, begins);
    // What is drawn, from where the one that is taken begins.
    let mut path = hand.gesture.path.clone();
    for (i, share) in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let Some(begin) = begin(&hand.seen, &lock.points, hand.start(), &hand.skin) else {
            continue;
        };
        let held = lock.held();
        if share < 1.0 {
            if begin.place >= held as f32 && goes_along(hand, &mut lock, &begin, &path, share) {
                sketch.locks[i] = lock.done();
            }
            continue;
        }
        if begin.place < held as f32 {
            sketch.say("a pin holds the curve here: begin behind its last pin");
            continue;
        }
        if let Some(points) = redrawn(hand, sketch, &lock, &begin) {
            let (first, last) = (begin.kept.len() - 1, lock.points.len() - 1);
            let more = (points.len() - 1 - first).max(1) as f32;
            let along = |k: usize| match k < first {
                true => k as f32,
                false => begin.place + (last as f32 - begin.place) * (k - first) as f32 / more,
            };
            let places: Vec<f32> = (0..points.len()).map(along).collect();
            if path.is_empty()
                && let Some(own) = begin.frame(hand.scalp)
            {
                path = points[first + 1..].iter().map(|p| own.local(*p)).collect();
            }
            lock.set_points(points, &places);
            sketch.locks[i] = lock.done();
        }
    }
}

/// Leads a curve a share of the way to a path from where it begins. False where there is no path, or nothing to lead.
fn goes_along(
    hand: &GestureContext,
    lock: &mut Lock,
    begin: &Begin,
    path: &[Vec3],
    share: f32,
) -> bool {
    let first = begin.place as usize;
    let (Some(own), last) = (begin.frame(hand.scalp), lock.points.len() - 1) else { return false };
    if path.is_empty() || first >= last {
        return false;
    }
    let from = begin.kept[begin.kept.len() - 1];
    let drawn = std::iter::once(from).chain(path.iter().map(|p| own.world(*p)));
    let drawn = Polyline::new(drawn.collect());
    let rest: Vec<Vec3> =
        std::iter::once(from).chain(lock.points[first + 1..].iter().copied()).collect();
    let whole = length(&rest).max(1e-6);
    let mut points = lock.points.clone();
    let mut far = 0.0;
    for (k, pair) in (first + 1..).zip(rest.windows(2)) {
        far += pair[0].distance(pair[1]);
        points[k] = pair[1].lerp(drawn.at(far / whole * drawn.length()), share);
    }
    clear(hand, &mut points, first);
    let places: Vec<f32> = (0..points.len()).map(|k| k as f32).collect();
    lock.set_points(points, &places);
    true
}

const SHORT: &str = "it has no length: draw on from the curve";

/// Whether a line is long enough to be part of a curve: a tap with a trembling hand removes nothing.
fn is_long(hand: &GestureContext, line: &[Vec3]) -> bool {
    length(line) >= SHORTEST * hand.set.segment
}

/// The new CVs of a curve from a stroke; `None` if it has no length.
fn redrawn(
    hand: &GestureContext,
    sketch: &mut SketchState,
    lock: &Lock,
    begin: &Begin,
) -> Option<Vec<Vec3>> {
    let (mut points, first) = (begin.kept.clone(), begin.kept.len() - 1);
    let from = points[first];
    match hand.gesture.path.is_empty() {
        true => {
            let more = stroke(hand, sketch, &hand.line(), from, lock.id);
            if !is_long(hand, &more) {
                sketch.say(SHORT);
                return None;
            }
            points.extend(&more[1..]);
        }
        false => {
            let own = begin.frame(hand.scalp)?;
            points.extend(hand.gesture.path.iter().map(|p| own.world(*p)));
            if !is_long(hand, &points[first..]) {
                sketch.say(SHORT);
                return None;
            }
            let drawn = points[first..].to_vec();
            clear(hand, &mut points, first);
            let more = turned(&drawn, &points[first..]);
            sketch.now.turned = Some(sketch.now.turned.map_or(more, |most| most.max(more)));
        }
    }
    Some(points)
}

/// Where a curve is redrawn.
struct Begin {
    /// In CVs from the root.
    place: f32,
    /// The CVs that stay, the last one at that position.
    kept: Vec<Vec3>,
}

impl Begin {
    /// The frame for storing the continuation from there.
    fn frame(&self, scalp: &Scalp) -> Option<RootFrame> {
        match self.kept[..] {
            [root] => Some(RootFrame::at(scalp, &scalp.closest_root(root)?)),
            _ => Some(onward(scalp.frame(), &self.kept)),
        }
    }
}

/// Where a stroke from `start` begins on a curve.
fn begin(seen: &Seen, points: &[Vec3], start: Vec2, skin: &Skin) -> Option<Begin> {
    let (mut place, _) = place(seen, points, start)?;
    if (place - place.round()).abs() <= AT_CV {
        place = place.round();
    }
    // (From the very tip, it would be a lengthening.)
    let mut kept = points[..=place as usize].to_vec();
    if place.fract() > 0.0 {
        kept.push(lift_exactly(skin, at(points, place), CLEARANCE).0);
    }
    Some(Begin { place, kept })
}

/// The position on a curve (in CVs) drawn nearest to a pixel, and its distance, pixels; `None` if the whole curve is
/// behind the eye.
fn place(seen: &Seen, points: &[Vec3], to: Vec2) -> Option<(f32, f32)> {
    let mut best: Option<(f32, f32)> = None;
    for (k, pair) in points.windows(2).enumerate() {
        let (Some(a), Some(b)) = (seen.pixel(pair[0]), seen.pixel(pair[1])) else { continue };
        let off = off_line(&[a, b], to);
        if best.is_none_or(|(_, least)| off < least) {
            let along = b - a;
            let t = (to - a).dot(along) / along.length_squared().max(1e-12);
            best = Some((k as f32 + t.clamp(0.0, 1.0), off));
        }
    }
    best
}

/// The point at a position on a curve.
fn at(points: &[Vec3], place: f32) -> Vec3 {
    let k = (place as usize).min(points.len() - 2);
    points[k].lerp(points[k + 1], place - k as f32)
}

/// How far from where a stroke begins a curve is drawn, pixels.
pub(super) fn off_start(gesture: &Gesture, scalp: &Scalp, points: &[Vec3]) -> f32 {
    let seen = Seen::new(&gesture.view, scalp.frame());
    place(&seen, points, gesture.samples[0].at).map_or(f32::MAX, |(_, off)| off)
}

/// What a redrawn curve stores of the stroke: its new CVs, in the frame of the point where it begins.
pub(super) fn kept(
    gesture: &Gesture,
    scalp: &Scalp,
    before: &[Vec3],
    after: &[Vec3],
) -> Option<Vec<Vec3>> {
    let seen = Seen::new(&gesture.view, scalp.frame());
    let begin = begin(&seen, before, gesture.samples[0].at, &scalp.skin())?;
    let own = begin.frame(scalp)?;
    Some(after.get(begin.kept.len()..)?.iter().map(|p| own.local(*p)).collect())
}
