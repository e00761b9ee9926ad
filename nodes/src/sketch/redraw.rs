//! Re-draw: from where the stroke begins on a curve, the curve follows the stroke to its end; beyond the paper.
//!
//! It takes the depth of the curves around it, and keeps its place in the picture, as an implant would. Guarantees: everything before that point stays, and
//! so do pins: a curve is redrawn only beyond its last one. Its values (radius, twist and all other attributes) keep
//! their positions from there to the tip. The drawn part is stored in a frame at that point, which is located on each
//! head where the stroke begins.

use super::grow::{clear, length, onward, stroke, turned};
use super::hand::{GestureContext, SketchState, off_line};
use super::lock::Lock;
use super::relax::CLEARANCE;
use super::seen::Seen;
use crate::data::gestures::{Gesture, RootFrame};
use crate::data::route::makers::lift_exactly;
use crate::data::scalp::{Scalp, Skin};
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
    let taken = hand.takes(sketch, nearest, "no curve is here: begin on the one to draw anew");
    for i in taken {
        let mut lock = (*sketch.locks[i]).clone();
        let Some(begin) = begin(&hand.seen, &lock.points, hand.start(), &hand.skin) else {
            continue;
        };
        let held = lock.held();
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
            lock.set_points(points, &places);
            sketch.locks[i] = lock.done();
        }
    }
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
