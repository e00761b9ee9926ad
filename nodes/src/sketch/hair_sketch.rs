//! Hair sketch: pen gestures replayed on curves, or on a bare head.
//!
//! Each gesture is a step on the curves left by earlier gestures (`EvalCx::fold`), and all states are cached: one more
//! gesture costs only that gesture, and undoing it costs nothing.
//!
//! Guarantees: a gesture changes only curves that it names or, if it names none, selects by its layer; roots stay; no
//! moved CV ends inside the head; an untouched curve is the input tuft itself. A gesture without effect, or whose
//! curves no longer exist, is reported. Live and replayed gestures are the same call.

use super::hand::{GestureContext, Settings, SketchState};
use super::lock::{Lock, length};
use super::seen::Seen;
use super::{brush, comb, cut, density, frizz, grow, pin, point, redraw, scatter, twist};
use crate::data::curves::Curves;
use crate::data::gestures::{Gesture, Gestures, Replayed, Tool};
use crate::data::scalp::Scalp;
use crate::define::{NodeError, node};
use crate::eval::{EvalCx, Size};
use crate::maths::hash::Key;
use crate::maths::transcendental::sin_cos;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

node! {
    /// Makes hair with the pen, and edits by hand whatever the graph made: implant, lengthen, cut, comb, pin, twist,
    /// re-draw, scatter and more.
    ///
    /// Draw in the viewport. Without curves the sketch begins on a bare head. After other nodes, each gesture stores
    /// the ids of the curves it acts on, so edits survive more guides, another parting or another head. Wire the result
    /// to Cluster to strands.
    "hair_sketch", version 2, label "Hair sketch",
        words "sketch pen tablet comb brush implant plant hairpin grab hand edit manual tweak sculpt points redraw strands scatter copy silhouette outline shape", scales;
    inputs {
        /// Pen gestures, in order. Draw them in the viewport; they are stored in the head frame.
        gestures: Arc<Gestures> = Gestures::default(), words("pen strokes drawn edits");
        /// Clusters or guides to edit. Without them, the sketch begins on a bare head.
        curves: Option<Curves>;
        /// The head.
        scalp: Arc<Scalp>;
        /// Radius of an implant.
        radius: f32 = 1.0, hard(0.001, 100.0), soft(0.1, 3.0), unit(Length), words("width size thickness cluster");
        /// Density of an implant with no cluster nearby; otherwise it takes the density of its neighbours.
        density: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("fullness default");
        /// Reach of the pen in pixels of the view it was drawn in, and the radius of brushes and combs that store no
        /// size.
        rho: f32 = 30.0, hard(2.0, 1000.0), soft(10.0, 100.0), words("comb radius pixels force size");

        [Shape]
        /// Distance within which neighbouring curves set the depth and density of a new one.
        tau: f32 = 4.0, hard(0.01, 100.0), soft(1.0, 10.0), unit(Length), words("neighbours reach distance depth");
        /// Largest angle in the view between a new curve and a neighbour that sets its depth.
        angle: f32 = 30.0, hard(0.0, 180.0), soft(5.0, 60.0), unit(Angle), words("neighbours similar direction");
        /// How far combed hair also turns toward the depth of the curves around it: 0 keeps its own depth.
        follow: f32 = 0.0, hard(0.0, 1.0), unit(Ratio), words("comb neighbours direction side view");

        [Detail]
        /// Segment length of implanted and lengthened curves.
        segment: f32 = 2.0, hard(0.05, 100.0), soft(0.5, 4.0), unit(Length), words("spacing cvs points resolution");
        /// Scale lengths with the size of the head. Gestures always scale.
        scale_with_head: bool = true, words("head units");
        /// Random seed for this node. It changes the ids of implants.
        seed: i64 = 0;
    }
    outputs {
        /// The curves as the pen left them, one tuft each, with radius, density, frizz, roll, colour and pins.
        curves: Curves;
    }
}

/// The most message lines from gestures.
const SAID: usize = 12;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let curves = inputs.curves.clone().unwrap_or_default();
    let samples: usize = inputs.gestures.0.iter().map(|one| one.samples.len()).sum();
    cx.may_make(&Size::of(&[("samples of gestures", samples as f64)]))?;
    let set = Settings {
        radius: inputs.radius,
        segment: inputs.segment,
        tau: inputs.tau,
        rho: inputs.rho,
        alike: sin_cos(inputs.angle.to_radians()).1,
        density: inputs.density,
        follow: inputs.follow,
        unit: scalp.frame().unit(),
        seed: inputs.seed as u64,
    };
    let skin = cx.skin(scalp);
    let items: Vec<(Key, &Gesture)> =
        inputs.gestures.0.iter().map(|one| (one.key(), one)).collect();
    let first = || Ok(SketchState::of(Lock::all(&curves)));
    let step = |sketch: &SketchState, gesture: &&Gesture| {
        let seen = Seen::new(&gesture.view, scalp.frame());
        Ok(after(&GestureContext { gesture, seen, scalp, skin, set }, sketch))
    };
    // (The node's other settings are in its own key.)
    let sketch = cx.fold((curves.key(), first), &items, step, |sketch| sketch.bytes)?;
    say(cx, &sketch.replayed);
    cx.replayed(sketch.replayed.clone());
    Ok(Outputs {
        curves: Curves::new(sketch.locks.iter().map(|lock| lock.tuft().clone()).collect()),
    })
}

/// The curves after one gesture.
fn after(hand: &GestureContext, before: &SketchState) -> SketchState {
    let mut sketch = before.clone();
    (sketch.now.id, sketch.now.tool) = (hand.gesture.id, hand.gesture.tool.word());
    match hand.gesture.tool {
        Tool::Implant => grow::implant(hand, &mut sketch),
        Tool::Lengthen => grow::lengthen(hand, &mut sketch),
        Tool::Cut => cut::cut(hand, &mut sketch),
        Tool::Density => density::density(hand, &mut sketch),
        Tool::Twist => twist::twist(hand, &mut sketch),
        Tool::Frizz => frizz::frizz(hand, &mut sketch),
        Tool::Comb => comb::comb(hand, &mut sketch),
        Tool::Pin => pin::pin(hand, &mut sketch),
        Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten => {
            brush::brush(hand, &mut sketch);
        }
        Tool::Point => point::point(hand, &mut sketch),
        Tool::Redraw => redraw::redraw(hand, &mut sketch),
        Tool::Scatter => scatter::scatter(hand, &mut sketch),
        Tool::Silhouette => grow::silhouette(hand, &mut sketch),
    }
    sketch.ended(before)
}

/// A gesture with its result: the curves that it changed, replaced or copied, the roots of an implant or of copies, and
/// what was drawn. Derived from the node's curves `before` and `after` it; a document stores this when the pen is
/// lifted.
pub fn resolved(gesture: &Gesture, before: &Curves, after: &Curves, scalp: &Scalp) -> Gesture {
    let mut out = gesture.clone();
    let was: BTreeMap<u64, (Key, Vec<Vec3>)> = by_id(before);
    let is = by_id(after);
    let same = |id: &u64| was.get(id).map(|(key, _)| key) == is.get(id).map(|(key, _)| key);
    match gesture.tool {
        Tool::Implant | Tool::Silhouette => {
            let new = is.iter().find(|(id, _)| !was.contains_key(*id));
            if let Some((root, path)) = new.and_then(|(_, (_, all))| grow::kept(scalp, &[], all)) {
                (out.root, out.path) = (Some(root), path);
                out.curves = was.keys().filter(|id| !is.contains_key(*id)).copied().collect();
            }
        }
        Tool::Scatter => {
            let new = after.each().filter(|(tuft, i)| !was.contains_key(&tuft.id(*i)));
            let roots = new.filter_map(|(tuft, i)| tuft.curve(i).first().copied());
            let path: Vec<Vec3> = roots.map(|p| scalp.given(p)).collect();
            if !path.is_empty() {
                out.path = path;
                let source = scatter::source(gesture, scalp, &Lock::all(before));
                out.curves = source.into_iter().collect();
            }
        }
        tool => {
            out.curves = was.keys().filter(|id| !same(id)).copied().collect();
            // The curve that the pen drew; what followed it grew less, and lies farther from where the stroke began.
            let grown = |id: &&u64| {
                let all =
                    [Some(&was[*id]), is.get(*id)].map(|of| of.map_or(0.0, |(_, all)| length(all)));
                all[1] - all[0]
            };
            let drawn = match tool {
                Tool::Lengthen => {
                    out.curves.iter().rev().max_by(|a, b| grown(a).total_cmp(&grown(b)))
                }
                Tool::Redraw => {
                    let off = |id: &u64| redraw::off_start(gesture, scalp, &was[id].1);
                    out.curves.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
                }
                _ => out.curves.first(),
            };
            let path = drawn.and_then(|id| {
                let (was, is) = (&was[id].1, &is.get(id)?.1);
                match tool {
                    Tool::Lengthen => grow::kept(scalp, was, is).map(|(_, path)| path),
                    Tool::Redraw => redraw::kept(gesture, scalp, was, is),
                    _ => None,
                }
            });
            if let Some(path) = path {
                out.path = path;
            }
        }
    }
    out
}

/// Curves by id, each with the key of its own tuft.
fn by_id(curves: &Curves) -> BTreeMap<u64, (Key, Vec<Vec3>)> {
    let locks = Lock::all(curves).into_iter();
    locks.map(|lock| (lock.id, (lock.tuft().key(), lock.points.clone()))).collect()
}

/// Reports what gestures could not do, and how far gestures with a root and a path deviate from how they were drawn.
fn say(cx: &EvalCx, replayed: &[Arc<Replayed>]) {
    let undone = || (0..).zip(replayed).filter(|(_, one)| !one.said.is_empty());
    for (number, one) in undone().take(SAID) {
        cx.warn(format!("gesture {number} ({}): {}", one.tool, one.said.join("; ")));
    }
    let more = undone().count().saturating_sub(SAID);
    if more > 0 {
        cx.warn(format!("{more} more gestures did not do all they were drawn for"));
    }
    let orphans = || replayed.iter().filter(|one| !one.orphaned.is_empty());
    if orphans().count() > 1 {
        let lost: usize = orphans().map(|one| one.orphaned.len()).sum();
        let named: usize = replayed.iter().map(|one| one.named).sum();
        cx.warn(format!("of {named} curves that gestures name {lost} are not there any more"));
    }
    // A hundredth of a millimetre, or of a degree, is rounding.
    if let Some((median, most, at)) = spread(replayed, |one| one.drift).filter(|all| all.1 > 1e-3) {
        cx.remark(format!(
            "implants stand on this head {median:.2} cm from where they were drawn in the median, {most:.2} cm at most (gesture {at})"
        ));
    }
    if let Some((median, most, at)) = spread(replayed, |one| one.turned).filter(|all| all.1 > 0.01)
    {
        cx.remark(format!(
            "what was drawn turned by {median:.1} degrees in the median to stay out of this head, by {most:.1} at most (gesture {at})"
        ));
    }
}

/// The median of a number that some gestures have, the largest, and the gesture that has it; `None` if none has one.
fn spread(
    replayed: &[Arc<Replayed>],
    of: impl Fn(&Replayed) -> Option<f32>,
) -> Option<(f32, f32, usize)> {
    let mut all: Vec<(f32, usize)> =
        (0..).zip(replayed).filter_map(|(number, one)| Some((of(one)?, number))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (most, at) = *all.last()?;
    Some((all[all.len() / 2].0, most, at))
}
