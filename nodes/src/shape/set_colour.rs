//! Set colour: the colour of hair from root to tip.
//!
//! Guarantees: nothing else changes and nothing else is copied; a constant colour is stored once. Colours are linear
//! Rec.709.

use super::along::{ValueDomain, lay};
use crate::data::attributes::COLOUR;
use crate::data::curves::{AttributeView, Curves};
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::define::{Colour, FieldInput, NodeError, node};
use crate::eval::EvalCx;
use crate::maths::transcendental::exp;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Colours hair from root to tip, with variation from hair to hair.
    "set_colour", version 1, label "Set colour", words "color flat rgb paint dye highlights tint ombre";
    inputs {
        /// Hair to colour.
        curves: Curves;
        /// The head; only masks need it.
        scalp: Option<Arc<Scalp>>;
        /// Colour at the root.
        root: Colour = COLOUR.default, words("color");
        /// Colour at the tip.
        tip: Colour = COLOUR.default, words("color ombre");
        /// Blend from the root colour (0) to the tip colour (1), along the hair.
        profile: Arc<Ramp> = Ramp::smooth(0.0, 1.0), words("gradient blend falloff");
        /// Blend from the old colour (0) to the new one (1). A mask makes streaks.
        amount: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("mix opacity mask highlights");
        /// Random variation in brightness between hairs: 0.3 means up to about a third.
        variation: f32 = 0.15, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("random vary");
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The same hair, coloured.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let dice = cx.dice(inputs.seed, "colour");
    let (root, tip) = (inputs.root.0, inputs.tip.0);
    let stops = inputs.profile.stops();
    let level = root == tip || stops.iter().all(|stop| stop.1 == stops[0].1);
    let along = |u: f32| root.lerp(tip, inputs.profile.at(u)).max(Vec3::ZERO);
    let uniform = inputs.variation == 0.0;
    let constant = inputs.amount.constant();
    if constant == Some(0.0) {
        return Ok(Outputs { curves: inputs.curves });
    }
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        let amount = inputs.amount.on(tuft, scalp)?;
        let vary = |i: usize| match uniform {
            true => 1.0,
            false => exp(inputs.variation * dice.signed(tuft.id(i), 0)),
        };
        let old = tuft.view(COLOUR);
        let covers = constant == Some(1.0);
        let mixed = |i: usize, point: usize, u: f32, colour: Vec3| match covers {
            true => colour,
            false => old.at(i, point).lerp(colour, amount.at(i, point, u)),
        };
        let level =
            level && amount.is_of_curves() && (covers || !matches!(old, AttributeView::Point(_)));
        let held = ValueDomain::fewest(level, uniform && covers);
        let value =
            |vary: &f32, i: usize, point: usize, u: f32| mixed(i, point, u, along(u) * *vary);
        Ok([lay(piece, tuft, COLOUR, held, vary, value)?])
    })?;
    Ok(Outputs { curves })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::TuftBuilder;
    use crate::define::Value;
    use crate::testing::{curves_of, run};

    fn hair(n: u64) -> Curves {
        let mut b = TuftBuilder::new();
        for i in 0..n {
            b.push_curve(&[0.0, 1.0, 2.0].map(|y| Vec3::new(i as f32, y, 0.0)));
        }
        b.set(ID, Domain::Curve, (1..=n).collect());
        Curves::new(vec![b.build().into()])
    }

    #[track_caller]
    fn check(set: &[(&str, Value)], stored: usize, at: usize, want: Vec3) {
        let (out, _) = run(&NODE, &[&[("curves", hair(2).into())], set].concat());
        let tuft = &curves_of(&out[0]).tufts()[0];
        assert_eq!(tuft.attribute(COLOUR.name).map_or(0, |a| a.values.len()), stored);
        let got = tuft.view(COLOUR).at(at / 3, at);
        assert!(got.distance(want) < 1e-6, "{got} {want}");
    }

    #[test]
    fn colour_is_stored_as_few_times_as_it_can() {
        let (red, blue) = (Vec3::X, Vec3::Z);
        let root = ("root", Value::Vec3(red));
        let plain = ("variation", Value::Float(0.0));
        let tip = |colour| ("tip", Value::Vec3(colour));
        check(&[root.clone(), tip(red), plain.clone()], 1, 4, red);
        check(&[root.clone(), tip(blue), plain.clone()], 6, 4, (red + blue) * 0.5);
        let half = ("amount", Value::Float(0.5));
        let mixed = (red + COLOUR.default) * 0.5;
        check(&[root.clone(), tip(red), plain.clone(), half], 2, 4, mixed);
        check(&[root, tip(blue), plain, ("amount", Value::Float(0.0))], 0, 4, COLOUR.default);
    }

    #[test]
    fn hairs_differ_by_their_own_amount_whoever_stands_beside_them() {
        let colours = |n| {
            let (out, _) = run(&NODE, &[("curves", hair(n).into())]);
            let tuft = curves_of(&out[0]).tufts()[0].clone();
            (0..2).map(|i| tuft.view(COLOUR).at(i, 3 * i)).collect::<Vec<_>>()
        };
        assert_eq!(colours(2), colours(9));
        assert_ne!(colours(2)[0], colours(2)[1]);
    }
}
