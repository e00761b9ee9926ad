//! Cross-section: the radius, flatness and twist of clusters from root to tip, as attributes.
//!
//! Guarantees: CVs, ids and all other attributes stay; with everything unset the cluster is the one that came in. Values are per
//! CV: between two CVs whatever fills the cluster interpolates, so a profile is as fine as the cluster is.

use crate::data::attributes::{Domain, FLATNESS, RADIUS, ROLL};
use crate::data::curves::{Curves, Tuft};
use crate::data::field::{Field, Sampler};
use crate::data::ramp::Ramp;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece, TracedScalp};
use crate::maths::spline::Spline;
use std::sync::Arc;

node! {
    /// Shapes the cross-section of clusters: radius, flatness and twist from root to tip.
    ///
    /// Wire it before Cluster to strands for locks that taper, flat ribbons, and ropes.
    "cross_section", version 1, label "Cross-section",
        words "cluster tube radius size profile taper lock flat flatten ribbon ellipse twist twirl spin rope roll shape modifier", scales;
    inputs {
        /// Clusters to shape.
        curves: Curves;
        /// The head; only masks need it.
        scalp: Option<TracedScalp>;
        /// Radius of the cross-section.
        radius: FieldInput = Field::Attribute(RADIUS.name.to_owned()),
            hard(0.0, 100.0), soft(0.05, 3.0), unit(Length), words("thickness size"), handle(Handle::Radius);
        /// Factor of the radius from root (left) to tip. Let it fall for locks that end in a point.
        profile: Arc<Ramp> = Ramp::constant(1.0), hard(0.0, 100.0), soft(0.0, 1.0), words("taper shape lock wisp tip falloff");
        /// Thickness relative to width: 1 is round. The flat side faces the head, or follows the cluster's own normal.
        flatness: FieldInput = Field::Attribute(FLATNESS.name.to_owned()),
            hard(0.02, 1.0), unit(Ratio), words("ellipse elliptic oval flat ribbon section");
        /// Turn of the cross-section about the cluster, the same from root to tip. It turns the flat side.
        turn: f32 = 0.0, hard(-360.0, 360.0), soft(-90.0, 90.0), unit(Angle), words("ellipse orientation flat angle roll");
        /// Turn per CV, added up from the root and to the cluster's own roll. 45 makes a rope; negative turns the other way.
        twist: FieldInput = 0.0, hard(-3600.0, 3600.0), soft(-90.0, 90.0), unit(Angle), words("rope twirl spin roll");
        /// Scale lengths with the size of the head. A radius from an attribute is already in true centimetres.
        scale_with_head: bool = true;
    }
    outputs {
        /// The clusters, with the attributes radius, flatness and roll.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let keeps_radius = inputs.radius.is_attribute(RADIUS.name)
        && inputs.profile.stops().iter().all(|(_, factor)| *factor == 1.0);
    let keeps_flatness = inputs.flatness.is_attribute(FLATNESS.name);
    let keeps_roll = inputs.turn == 0.0 && inputs.twist.constant() == Some(0.0);
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let scalp = piece.scalp();
        let (radius, flatness) = (inputs.radius.on(tuft, scalp)?, inputs.flatness.on(tuft, scalp)?);
        let twist = inputs.twist.on(tuft, scalp)?;
        let mut out = tuft.edit();
        if !keeps_radius {
            let values = per_cv(tuft, piece, |i, cv, u| {
                radius.at(i, cv, u) * inputs.profile.at(u).max(0.0)
            })?;
            out.set(RADIUS, Domain::Point, values);
        }
        if !keeps_flatness {
            out.set(
                FLATNESS,
                Domain::Point,
                per_cv(tuft, piece, |i, cv, u| flatness.at(i, cv, u))?,
            );
        }
        if !keeps_roll {
            out.set(ROLL, Domain::Point, rolls(tuft, inputs.turn, &twist, piece)?);
        }
        Ok([out.build()])
    })?;
    Ok(Outputs { curves })
}

/// A value at each CV of a tuft, given the curve, the CV and the fraction of the curve's length.
fn per_cv(
    tuft: &Tuft,
    piece: &mut Piece,
    value: impl Fn(usize, usize, f32) -> f32,
) -> Result<Vec<f32>, NodeError> {
    let mut values = Vec::with_capacity(tuft.points().len());
    let mut spline = Spline::default();
    for i in 0..tuft.len() {
        piece.tick()?;
        // What is no curve is left out by whatever fills it, which says why.
        let is_curve = spline.rebuild(tuft.curve(i)).is_ok();
        values.extend(tuft.range(i).enumerate().map(|(k, cv)| {
            let u = if is_curve { spline.u_of_cv(k) } else { 0.0 };
            value(i, cv, u)
        }));
    }
    Ok(values)
}

/// The roll at each CV, degrees: the cluster's own, and the turns up to there.
fn rolls(
    tuft: &Tuft,
    turn: f32,
    twist: &Sampler,
    piece: &mut Piece,
) -> Result<Vec<f32>, NodeError> {
    let turns = per_cv(tuft, piece, |i, cv, u| twist.at(i, cv, u))?;
    let own = tuft.view(ROLL);
    let mut values = Vec::with_capacity(turns.len());
    for i in 0..tuft.len() {
        let (range, mut sum) = (tuft.range(i), turn);
        for cv in range.clone() {
            if cv > range.start {
                sum += turns[cv];
            }
            values.push(sum + own.at(i, cv));
        }
    }
    Ok(values)
}
