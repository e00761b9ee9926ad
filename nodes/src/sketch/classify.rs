//! Identifies the gesture of a pen stroke: the grammar of the hair sketching paper (section 4), as explicit rules.
//!
//! The tip: two short taps pin; on the scalp (heavy pressure), any stroke from the head implants hair; otherwise a
//! scribble adds frizz, a stroke with loops twists, a light stroke from a curve's tip lengthens it, and any other
//! stroke combs. The eraser: full circles change density, a nearly straight stroke across hair cuts.
//!
//! Guarantees: a cut is guessed only for an eraser stroke that is clearly straight and crosses hair, or lies on the
//! scalp; the eraser never guesses a tool of the tip, or the tip one of the eraser's. An ambiguous stroke gives no
//! guess, with advice on what to do. Not known here: what is under the stroke; the caller passes that in [`Around`].

use super::stroke_shape::{Straightness, full_circles, loops, scribble, straightness};
use crate::data::gestures::{Layer, PenSample, Tool};
use glam::Vec2;

/// The gesture of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guess {
    /// One of implant, lengthen, cut, density, twist, frizz, comb and pin.
    Is(Tool),
    /// Ambiguous: why, and what to do.
    Unsure(&'static str),
}

/// The context of a stroke in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Around {
    /// Whether it was drawn with the pen's eraser.
    pub eraser: bool,
    /// How deep it reaches.
    pub layer: Layer,
    /// Whether it begins within `rho` of the drawn tip of a curve.
    pub near_end: bool,
    /// Whether the ray through its first sample hits the scalp.
    pub starts_on_scalp: bool,
    /// Whether the straight line from its first to its last sample crosses a drawn curve, with both ends outside the
    /// cluster.
    pub crosses: bool,
}

/// Longest duration of a tap, seconds.
const TAP_TIME: f32 = 0.25;
/// Longest pause between two taps, seconds.
const TAP_PAUSE: f32 = 0.4;
/// Largest distance of a tap's samples from its centre, in `rho`.
const TAP_SIZE: f32 = 0.2;
/// Largest distance of two taps, in `rho`.
const TAPS_APART: f32 = 0.4;
/// A stroke that stays within this distance of its start, in `rho`, has no usable shape.
const SHORT: f32 = 0.3;

/// Whether a stroke is a tap: within 6 pixels of its centre (for a `rho` of 30), and at most 0.25 s long.
pub fn is_tap(samples: &[PenSample], rho: f32) -> bool {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return false };
    let middle = middle(samples);
    last.time - first.time <= TAP_TIME
        && samples.iter().all(|s| s.at.distance(middle) <= rho * TAP_SIZE)
}

/// Identifies the gesture of a stroke. `before` is the previous stroke, if that was a tap, with its times on the same
/// clock: negative, counted from the start of this stroke. `rho` is the reach of the pen in pixels, 30 in a picture
/// 1000 pixels high.
pub fn classify(
    samples: &[PenSample],
    before: Option<&[PenSample]>,
    around: &Around,
    rho: f32,
) -> Guess {
    let points: Vec<Vec2> = samples.iter().map(|s| s.at).collect();
    let Some(&start) = points.first() else {
        return Guess::Unsure("Nothing was drawn: draw a stroke over the hair");
    };
    if is_tap(samples, rho) {
        return tapped(samples, before, around, rho);
    }
    let small = points.iter().all(|p| p.distance(start) < rho * SHORT);
    if small && (around.eraser || scribble(&points, rho).is_none()) {
        return Guess::Unsure(
            "The stroke is too short: draw it longer, or tap twice quickly to pin",
        );
    }
    if around.eraser { erased(&points, around, rho) } else { drawn(&points, around, rho) }
}

fn middle(samples: &[PenSample]) -> Vec2 {
    samples.iter().map(|s| s.at).sum::<Vec2>() / samples.len().max(1) as f32
}

fn tapped(samples: &[PenSample], before: Option<&[PenSample]>, around: &Around, rho: f32) -> Guess {
    if around.eraser {
        return Guess::Unsure(
            "A tap of the eraser does nothing: draw straight across hair to cut, or circles to change its density",
        );
    }
    let Some(before) = before.filter(|before| is_tap(before, rho)) else {
        return Guess::Unsure("One tap does nothing: tap twice quickly to pin, or draw a stroke");
    };
    let pause = samples[0].time - before[before.len() - 1].time;
    match () {
        () if !(0.0..=TAP_PAUSE).contains(&pause) => {
            Guess::Unsure("The taps are too far apart in time: tap twice within 0.4 s to pin")
        }
        () if middle(samples).distance(middle(before)) > rho * TAPS_APART => {
            Guess::Unsure("The taps are too far apart: tap twice on the same place to pin")
        }
        () => Guess::Is(Tool::Pin),
    }
}

/// Gestures of the tip.
fn drawn(points: &[Vec2], around: &Around, rho: f32) -> Guess {
    match around.layer {
        Layer::Scalp if around.starts_on_scalp => Guess::Is(Tool::Implant),
        Layer::Scalp => Guess::Unsure(
            "The stroke begins off the scalp: begin on it to plant hair, or press less to comb",
        ),
        _ if scribble(points, rho).is_some() => Guess::Is(Tool::Frizz),
        _ if !loops(points, rho).is_empty() => Guess::Is(Tool::Twist),
        Layer::Nearest if around.near_end => Guess::Is(Tool::Lengthen),
        _ => Guess::Is(Tool::Comb),
    }
}

/// Gestures of the eraser.
fn erased(points: &[Vec2], around: &Around, rho: f32) -> Guess {
    let shape = straightness(points, rho);
    let reached = around.crosses || (around.layer == Layer::Scalp && around.starts_on_scalp);
    match () {
        () if full_circles(points, rho) != 0 => Guess::Is(Tool::Density),
        () if is_cut(&shape, rho) && reached => Guess::Is(Tool::Cut),
        () if is_cut(&shape, rho) && around.layer == Layer::Scalp => Guess::Unsure(
            "The stroke meets neither scalp nor hair: draw it across the roots to remove what grows there",
        ),
        () if is_cut(&shape, rho) => Guess::Unsure(
            "The stroke crosses no hair: begin on one side of a cluster and leave it on the other to cut",
        ),
        () if shape.chord_by_length >= BENT => Guess::Unsure(
            "The stroke is not straight enough to cut: draw it straight across the hair",
        ),
        () => Guess::Unsure(
            "Neither a cut nor a circle: draw straight across hair to cut, or full circles to change its density",
        ),
    }
}

/// Above this value, a stroke that is not a cut looks like one: the ratio of chord to length of half a circle, plus a
/// margin.
const BENT: f32 = 0.7;

/// Whether a stroke is clearly straight: long enough to tell, with a bow of at most tremor plus a twelfth of it.
fn is_cut(shape: &Straightness, rho: f32) -> bool {
    shape.chord >= rho * 0.7
        && shape.chord_by_length >= 0.85
        && shape.bow <= rho * 0.08 + shape.chord / 12.0
}

#[cfg(test)]
mod tests;
