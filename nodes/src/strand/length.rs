//! Length: cuts, scales or extends hair.
//!
//! Guarantees: roots and ids stay; hair of the requested length keeps its bits, and a tuft of such hair is the tuft that came in;
//! what is left of a cut hair stays in place; the random shortening of a hair depends on its id alone; on a scalp, no new or
//! moved CV ends deeper in the skin than the hair allows, and no hair crosses a parting that it did not cross before. Lengths are
//! exact to 1e-3, except where the skin pushes.

use super::shorten::{Shortened, grow_on};
use crate::data::attributes::{ALLOW_DEPTH, ROOT_TRIANGLE};
use crate::data::curves::{Curves, Tuft};
use crate::data::route::{Policy, Route};
use crate::define::{FieldInput, NodeError, Value as Set, choice, node, unless};
use crate::eval::{EvalCx, Piece, Size, TracedScalp};
use crate::maths::spline::Spline;
use glam::Vec3;

node! {
    /// Cuts, extends or scales hair to a length.
    ///
    /// The length is a share of the hair's own, or centimetres; attributes and painted masks vary it. To cut hair to an
    /// outline, use Trim.
    "length", version 1, label "Length",
        words "length cut shorten lengthen extend grow scale longer shorter random vary variation layers uneven modifier", scales;
    inputs {
        /// Hair to change.
        curves: Curves;
        /// Head that new CVs stay out of. Masks need it too.
        scalp: Option<TracedScalp>;
        /// Whether to give the length as a share of the hair's own, or in centimetres.
        by: By = By::Share, words("relative absolute");
        /// Share of the hair's own length. Read at the root.
        share: FieldInput = 1.0, hard(0.0, 100.0), soft(0.0, 2.0), unit(Ratio), words("factor percent multiply"),
            idle(|of| unless(of, "by", "share", "lengths are given in centimetres"));
        /// Length of the hair. Read at the root.
        length: FieldInput = 10.0, hard(0.0, 1000.0), soft(0.0, 60.0), unit(Length), words("absolute target"), handle(Handle::Length),
            idle(|of| unless(of, "by", "length", "lengths are shares of what hair has"));
        /// How the length changes.
        way: Way = Way::Cut, words("method mode trim stretch");
        /// Which hairs change.
        change: Change = Change::Any, words("limit only clamp minimum maximum");
        /// Random shortening per hair: 0 none, 0.95 down to a twentieth.
        variation: f32 = 0.15, hard(0.0, 0.95), unit(Ratio), words("random vary uneven between");
        /// How random lengths are distributed.
        distribution: Distribution = Distribution::Few, words("random uniform bias spread"),
            idle(|of| matches!(of("variation"), Some(Set::Float(0.0))).then_some("no length varies"));
        /// Scale centimetres with the size of the head.
        scale_with_head: bool = true,
            idle(|of| unless(of, "by", "length", "lengths are shares of what hair has"));
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The hair at its new length.
        curves: Curves;
    }
}

choice! {
    /// Unit of the length.
    By {
        /// A share of the hair's own length.
        Share = "share",
        /// Centimetres.
        Length = "length",
    }
}

choice! {
    /// How the length changes.
    Way {
        /// Cut, or extended in the direction of the tip.
        Cut = "cut",
        /// Scaled about the root.
        Scale = "scale",
    }
}

choice! {
    /// Which hairs change.
    Change {
        /// All hair.
        Any = "any",
        /// Only hair that is longer.
        Shorten = "shorten",
        /// Only hair that is shorter.
        Lengthen = "lengthen",
    }
}

choice! {
    /// How random lengths are distributed.
    Distribution {
        /// Most hairs stay close to full length; few are much shorter.
        Few = "few",
        /// Evenly, from full length to the shortest.
        Even = "even",
    }
}

/// Hair that would end up shorter than this, cm, is left out.
const NOTHING: f32 = 0.01;
/// Relative error of length up to which hair is left as it is.
const RIGHT: f32 = 1e-5;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let dice = cx.dice(inputs.seed, "length");
    if let (By::Share, Way::Cut, Some(share)) = (inputs.by, inputs.way, inputs.share.constant())
        && inputs.change != Change::Shorten
    {
        // Lower bound of the size of the result.
        let pieces = inputs.curves.point_count().saturating_sub(inputs.curves.curve_count());
        let times = f64::from(share * (1.0 - inputs.variation)).max(1.0);
        let pieces = ("pieces between points that come in", pieces as f64);
        cx.may_make(&Size::of(&[pieces, ("share less variation", times)]))?;
    }
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let (scalp, route) = (piece.scalp(), piece.route(Policy::keep_length(false)));
        let field = match inputs.by {
            By::Share => inputs.share.on(tuft, scalp)?,
            By::Length => inputs.length.on(tuft, scalp)?,
        };
        let wanted = |i: usize, length: f32| {
            let asked = field.at(i, tuft.range(i).start, 0.0);
            let asked = if inputs.by == By::Share { asked * length } else { asked };
            let x = dice.unit(tuft.id(i), 0);
            let cut = if inputs.distribution == Distribution::Even { x } else { x * x };
            let asked = asked * (1.0 - inputs.variation * cut);
            match inputs.change {
                Change::Any => asked,
                Change::Shorten => asked.min(length),
                Change::Lengthen => asked.max(length),
            }
        };
        Ok([relength(tuft, wanted, inputs.way, &route, piece)?])
    })?;
    let gone = inputs.curves.curve_count() - curves.curve_count();
    if gone > 0 {
        cx.remark(format!("{gone} hairs are left out, which come to be shorter than {NOTHING} cm or have no length"));
    }
    Ok(Outputs { curves })
}

/// Sets each hair of a tuft to the length (cm) that `wanted` gives for its index and its length.
fn relength(
    tuft: &Tuft,
    wanted: impl Fn(usize, f32) -> f32,
    way: Way,
    route: &Route,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let mut spline = Spline::default();
    let mut changes = false;
    for i in 0..tuft.len() {
        piece.tick()?;
        changes = spline.rebuild(tuft.curve(i)).is_ok() && {
            let length = spline.length();
            !is_right(wanted(i, length), length)
        };
        if changes {
            break;
        }
    }
    if !changes {
        return Ok(tuft.clone());
    }
    let (depths, root_triangles) = (tuft.view(ALLOW_DEPTH), tuft.view(ROOT_TRIANGLE));
    let mut out = Shortened::new(tuft);
    let mut points: Vec<Vec3> = vec![];
    for i in 0..tuft.len() {
        piece.tick()?;
        let (old, first) = (tuft.curve(i), tuft.range(i).start);
        if let Err(fault) = spline.rebuild(old) {
            piece.trouble(tuft.id(i), fault);
            continue;
        }
        let length = spline.length();
        let wanted = wanted(i, length);
        let share = wanted / length;
        let depth = |k: usize| depths.at(i, first + k.min(old.len() - 1));
        if wanted < NOTHING && wanted < length {
            continue;
        }
        if is_right(wanted, length) {
            out.keep(i);
        } else if way == Way::Cut && wanted < length {
            out.cut(i, &spline, wanted, |p, span| route.between(p, depth(span)));
        } else {
            points.clear();
            points.extend_from_slice(old);
            let settled = if way == Way::Scale {
                points.iter_mut().for_each(|p| *p = old[0] + (*p - old[0]) * share);
                route.settle(old, &mut points, root_triangles.at(i, first), depth)
            } else {
                grow_on(&spline, &mut points, wanted - length);
                route.settle_beyond(old, &mut points, depth)
            };
            match settled {
                Ok(()) => out.grown(i, &points, share),
                Err(why) => {
                    piece.trouble(tuft.id(i), why);
                    out.keep(i);
                }
            }
        }
    }
    Ok(out.build())
}

fn is_right(wanted: f32, length: f32) -> bool {
    (wanted - length).abs() <= RIGHT * length
}
