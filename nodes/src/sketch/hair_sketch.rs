//! Hair sketch: pen gestures replayed on curves, or on a bare head.
//!
//! Each gesture is a step on the curves that those before left (`EvalCx::fold`), and the states are kept: one more gesture costs
//! that gesture, and taking it back costs nothing.
//!
//! Guarantees: a gesture changes only curves that it names or, where it names none, takes by its layer; roots stay; no CV that is
//! moved ends in the head; a curve that nothing touches is the tuft that came in. A gesture that does nothing, or whose curves
//! are gone, says so. Live and replayed gestures are the same call.

use super::hand::{Hand, Settings, Sketch};
use super::lock::Lock;
use super::seen::Seen;
use super::{brush, comb, cut, density, frizz, grow, pin, twist};
use crate::data::curves::Curves;
use crate::data::gestures::{Gesture, Gestures, Tool};
use crate::data::scalp::Scalp;
use crate::define::{NodeError, node};
use crate::eval::{EvalCx, Size};
use crate::maths::hash::Key;
use crate::maths::transcendental::sin_cos;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

node! {
    /// Makes hair with the pen, and edits by hand whatever a graph made: implant, lengthen, cut, comb, pin, twist and more.
    ///
    /// Draw in the viewport. Without curves it begins on a bare head; behind other nodes a gesture is kept by the ids of the curves
    /// it acts on, so that more guides, another parting or another head keep it. Give the result to Cluster to strands.
    "hair_sketch", version 1, label "Hair sketch",
        words "sketch pen tablet comb brush implant plant hairpin grab hand edit manual tweak sculpt";
    inputs {
        /// What the pen did, in drawing order. Drawn in the viewport; stored in the head's own frame.
        gestures: Arc<Gestures> = Gestures::default(), words("pen strokes drawn edits");
        /// Clusters or guides to edit. Without them the sketch begins on a bare head.
        curves: Option<Curves>;
        /// The head.
        scalp: Arc<Scalp>;
        /// Radius of what is implanted.
        radius: f32 = 1.0, hard(0.001, 100.0), soft(0.1, 3.0), unit(Length), words("width size thickness cluster");
        /// Length of a segment of what is implanted or lengthened.
        segment: f32 = 2.0, hard(0.05, 100.0), soft(0.5, 4.0), unit(Length), words("spacing cvs points resolution");
        /// How far curves are looked for that tell a new one how deep to go, and how full to be.
        tau: f32 = 4.0, hard(0.01, 100.0), soft(1.0, 10.0), unit(Length), words("neighbours reach distance depth");
        /// Reach of a comb in pixels of the picture that was drawn on, and length of the pieces that a stroke pushes with.
        rho: f32 = 30.0, hard(2.0, 1000.0), soft(10.0, 100.0), words("comb radius pixels force size");
        /// How far a curve nearby may run elsewhere on the picture and still tell a new one how deep to go.
        angle: f32 = 30.0, hard(0.0, 180.0), soft(5.0, 60.0), unit(Angle), words("neighbours similar direction");
        /// How full an implant is where no cluster is near; elsewhere it is as full as those.
        density: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("fullness default");
        /// How much combed hair also turns towards the depth in which the curves about it run: 0 keeps its depth.
        follow: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("comb neighbours direction side view");
        /// Seed tag; stored, mixed into the ids of implants.
        seed: i64 = 0;
        /// Whether lengths here grow with the head. Gestures always do.
        scale_with_head: bool = true, words("head units");
    }
    outputs {
        /// The curves as the pen left them: one tuft for each, with radius, density, frizz, roll, colour and pins.
        curves: Curves;
    }
}

/// The most lines that gestures say.
const SAID: usize = 12;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let curves = inputs.curves.clone().unwrap_or_default();
    let samples: usize = inputs.gestures.0.iter().map(|one| one.samples.len()).sum();
    cx.may_make(&Size::of(&[("samples of gestures", samples as f64)]))?;
    let unit = cx.head_unit(Some(scalp), inputs.scale_with_head);
    let set = Settings {
        radius: inputs.radius * unit,
        segment: inputs.segment * unit,
        tau: inputs.tau * unit,
        rho: inputs.rho,
        alike: sin_cos(inputs.angle.to_radians()).1,
        density: inputs.density,
        follow: inputs.follow,
        unit: scalp.frame().unit(),
        seed: inputs.seed as u64,
    };
    let skin = cx.skin(scalp);
    let items: Vec<(Key, (usize, &Gesture))> =
        (0..).zip(&inputs.gestures.0).map(|(i, one)| (one.key(), (i, one))).collect();
    let first = || {
        let mut sketch = Sketch { locks: Lock::all(&curves), ..Sketch::default() };
        sketch.bytes = sketch.bytes_beside(&Sketch::default());
        Ok(sketch)
    };
    let step = |sketch: &Sketch, (number, gesture): &(usize, &Gesture)| {
        let seen = Seen::new(&gesture.view, scalp.frame());
        let hand = Hand { gesture, seen, scalp, skin, set };
        Ok(after(&hand, sketch, *number))
    };
    // (What else the node was set to is in its own key.)
    let sketch = cx.fold((curves.key(), first), &items, step, |sketch| sketch.bytes)?;
    say(cx, &sketch, &inputs.gestures);
    Ok(Outputs {
        curves: Curves::new(sketch.locks.iter().map(|lock| lock.tuft().clone()).collect()),
    })
}

/// The curves after one gesture.
fn after(hand: &Hand, before: &Sketch, number: usize) -> Sketch {
    let mut sketch = before.clone();
    match hand.gesture.tool {
        Tool::Implant => grow::implant(hand, &mut sketch, number),
        Tool::Lengthen => grow::lengthen(hand, &mut sketch, number),
        Tool::Cut => cut::cut(hand, &mut sketch, number),
        Tool::Density => density::density(hand, &mut sketch, number),
        Tool::Twist => twist::twist(hand, &mut sketch, number),
        Tool::Frizz => frizz::frizz(hand, &mut sketch, number),
        Tool::Comb => comb::comb(hand, &mut sketch, number),
        Tool::Pin => pin::pin(hand, &mut sketch, number),
        Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten => {
            brush::brush(hand, &mut sketch, number);
        }
    }
    sketch.bytes = sketch.bytes_beside(before);
    sketch
}

/// A gesture with what it resolved to: the curves that it changed, and where an implant is rooted and what was drawn. Known
/// from the node's curves `before` it and `after` it; what a document keeps once the pen is lifted.
pub fn resolved(gesture: &Gesture, before: &Curves, after: &Curves, scalp: &Scalp) -> Gesture {
    let mut out = gesture.clone();
    let was: BTreeMap<u64, (Key, Vec<Vec3>)> = by_id(before);
    let is = by_id(after);
    let same = |id: &u64| was.get(id).map(|(key, _)| key) == is.get(id).map(|(key, _)| key);
    match gesture.tool {
        Tool::Implant => {
            let new = is.iter().find(|(id, _)| !was.contains_key(*id));
            if let Some((root, path)) = new.and_then(|(_, (_, all))| grow::kept(scalp, &[], all)) {
                (out.root, out.path) = (Some(root), path);
            }
        }
        tool => {
            out.curves = was.keys().filter(|id| !same(id)).copied().collect();
            let changed = out.curves.first().filter(|_| tool == Tool::Lengthen);
            let kept = changed.and_then(|id| grow::kept(scalp, &was[id].1, &is.get(id)?.1));
            if let Some((_, path)) = kept {
                out.path = path;
            }
        }
    }
    out
}

/// Curves by their ids, each with its key as a tuft of its own.
fn by_id(curves: &Curves) -> BTreeMap<u64, (Key, Vec<Vec3>)> {
    let locks = Lock::all(curves).into_iter();
    locks.map(|lock| (lock.id, (lock.tuft().key(), lock.points.clone()))).collect()
}

/// Tells what gestures could not do, and how far roots drifted.
fn say(cx: &EvalCx, sketch: &Sketch, gestures: &Gestures) {
    for (number, text) in sketch.told.iter().take(SAID) {
        let word = gestures.0.get(*number).map_or("", |one| one.tool.word());
        cx.warn(format!("gesture {number} ({word}): {text}"));
    }
    if sketch.told.len() > SAID {
        cx.warn(format!(
            "{} more gestures did not do all they were drawn for",
            sketch.told.len() - SAID
        ));
    }
    let mut drifts: Vec<f32> = sketch.drifts.clone();
    drifts.sort_by(f32::total_cmp);
    if let Some(most) = drifts.last().filter(|most| **most > 1e-3) {
        let median = drifts[drifts.len() / 2];
        cx.remark(format!(
            "{} implants stand on this head {median:.2} cm from where they were drawn in the median, {most:.2} cm at most",
            drifts.len()
        ));
    }
}
