//! Hair colour: the natural colour of hair by its pigment, grey hairs in it, and dye on top.
//!
//! Guarantees: only the `colour` attribute changes, and it is stored as few times as possible. Everything is mixed as
//! absorption, like real pigment and dye, and then converted to a colour (`maths::hair_colour`); colours therefore blend
//! from root to tip and from hair to hair without turning muddy or pale. Equal ids give equal hairs, whatever else is
//! there, and raising `grey` only adds grey hairs.

use super::along::{ValueDomain, lay};
use crate::data::attributes::COLOUR;
use crate::data::curves::{AttributeView, Curves};
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::define::{Colour, FieldInput, NodeError, choice, node};
use crate::eval::EvalCx;
use crate::maths::hair_colour::{GREY, absorption_of, absorption_of_melanin, colour_of};
use crate::maths::transcendental::{exp, pow};
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Colours hair by its pigment, from white through blond and brown to black, with grey hairs and dye.
    ///
    /// Melanin 0.97 is black, 0.87 brown, 0.3 blond, 0.02 white. Add a second node with a mask for highlights or dipped
    /// tips.
    "hair_colour", version 1, label "Hair colour",
        words "color melanin ombre balayage grey gray white highlights dye tint bleach natural eumelanin pheomelanin pigment black brown blond blonde red ginger";
    inputs {
        /// Hair to colour.
        curves: Curves;
        /// The head; only masks need it.
        scalp: Option<Arc<Scalp>>;
        /// Base colour, before variation between hairs, grey and dye.
        from: Base = Base::Melanin, words("own keep inherit base cluster painted");
        /// Pigment at the root, 0 (white) to 1 (black).
        melanin_root: f32 = 0.9, hard(0.0, 1.0), unit(Ratio), words("eumelanin pigment darkness");
        /// Pigment at the tip. Sun and washing fade it slightly.
        melanin_tip: f32 = 0.87, hard(0.0, 1.0), unit(Ratio), words("eumelanin pigment darkness ombre balayage");
        /// Fraction of the pigment that is red: 0 is ash, 0.2 warm, 1 ginger.
        redness: f32 = 0.1, hard(0.0, 1.0), unit(Ratio), words("pheomelanin warm red ginger auburn");
        /// Blend from the root colour (0) to the tip colour (1), along the hair.
        profile: Arc<Ramp> = Ramp::smooth(0.0, 1.0), words("gradient blend falloff ombre");
        /// Fraction of hairs that are grey, that is, white among the others. A mask greys the temples first.
        grey: FieldInput = 0.0, hard(0.0, 1.0), unit(Ratio), words("gray white salt pepper age silver");
        /// Fraction of hairs between grey and not: 0 makes each hair one or the other.
        grey_softness: f32 = 0.15, hard(0.0, 1.0), unit(Ratio), words("gray blend");
        /// Colour of the dye; white is no dye. Dye only darkens: lower the melanin to bleach first.
        dye: Colour = Vec3::ONE, words("color tint henna");
        /// Strength of the dye. A ramp dyes only the tips, or leaves grown-out roots.
        dye_amount: FieldInput = 1.0, hard(0.0, 4.0), soft(0.0, 1.0), unit(Ratio), words("strength roots tips");
        /// Blend from the old colour (0) to the new one (1). A mask makes streaks.
        amount: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("mix opacity mask highlights");

        [Randomness]
        /// Random variation in pigment between hairs: 0.2 means up to about a fifth.
        variation: f32 = 0.2, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("random vary");
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The same hair, coloured.
        curves: Curves;
    }
}

choice! {
    /// Base colour.
    Base {
        /// The pigment below, from root to tip.
        Melanin = "melanin",
        /// The hair's own colour: from its cluster, the pen that implanted it, or an earlier node.
        Own = "own",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    if inputs.amount.constant() == Some(0.0) {
        return Ok(Outputs { curves: inputs.curves });
    }
    let scalp = inputs.scalp.as_deref();
    let dice = cx.dice(inputs.seed, "hair colour");
    let root = absorption_of_melanin(inputs.melanin_root, inputs.redness);
    let tip = absorption_of_melanin(inputs.melanin_tip, inputs.redness);
    let dye = absorption_of(inputs.dye.0);
    let dyed = dye != Vec3::ZERO && inputs.dye_amount.constant() != Some(0.0);
    let stops = inputs.profile.stops();
    let level = root == tip || stops.iter().all(|stop| stop.1 == stops[0].1);
    let grown = |u: f32| root.lerp(tip, inputs.profile.at(u).clamp(0.0, 1.0));
    let covers = inputs.amount.constant() == Some(1.0);
    let keeps = inputs.from == Base::Own;
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        let amount = inputs.amount.on(tuft, scalp)?;
        let laid = inputs.dye_amount.on(tuft, scalp)?;
        let grey = inputs.grey.on(tuft, scalp)?;
        let old = tuft.view(COLOUR);
        // Factor of one hair's own pigment: it varies, and some hairs have nearly none.
        let own = |i: usize| {
            let (id, first) = (tuft.id(i), tuft.offsets()[i] as usize);
            let vary = match inputs.variation {
                0.0 => 1.0,
                variation => exp(variation * dice.signed(id, 0)),
            };
            let greyness = greyness(grey.at(i, first, 0.0), inputs.grey_softness, dice.unit(id, 1));
            vary * if greyness == 0.0 { 1.0 } else { pow(GREY, greyness) }
        };
        let colour = |i: usize, point: usize, u: f32, own: f32| {
            let base = if keeps { absorption_of(old.at(i, point)) } else { grown(u) };
            let mut sigma = base * own;
            if dyed {
                sigma += dye * laid.at(i, point, u);
            }
            if !covers {
                sigma = absorption_of(old.at(i, point)).lerp(sigma, amount.at(i, point, u));
            }
            colour_of(sigma)
        };
        let even = !matches!(old, AttributeView::Point(_));
        let level = (if keeps { even } else { level })
            && (!dyed || laid.is_of_curves())
            && (covers || amount.is_of_curves() && even);
        let alike = inputs.variation == 0.0
            && inputs.grey.constant() == Some(0.0)
            && (!dyed || inputs.dye_amount.constant().is_some())
            && covers
            && !keeps;
        let value = |own: &f32, i: usize, point: usize, u: f32| colour(i, point, u, *own);
        Ok([lay(piece, tuft, COLOUR, ValueDomain::fewest(level, alike), own, value)?])
    })?;
    Ok(Outputs { curves })
}

/// How grey a hair is, 0 to 1, that drew `chance` (0 to 1) where the fraction of grey hairs is `share`. It grows with
/// `share`; a share of 0 greys none and a share of 1 all, at any softness.
fn greyness(share: f32, softness: f32, chance: f32) -> f32 {
    if softness == 0.0 {
        return if chance < share { 1.0 } else { 0.0 };
    }
    let middle = share * (1.0 + softness) - 0.5 * softness;
    ((middle - chance) / softness + 0.5).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::{Tuft, TuftBuilder};
    use crate::data::field::Field;
    use crate::define::Value;
    use crate::testing::{curves_of, run};

    fn hair(n: u64) -> Curves {
        let mut b = TuftBuilder::new();
        for i in 0..n {
            b.push_curve(&[0.0, 1.0, 2.0].map(|y| Vec3::new(i as f32, y, 0.0)));
        }
        b.set(ID, Domain::Curve, (1..=n).collect());
        b.set_named("half".into(), Domain::Curve, vec![0.5f32; n as usize]);
        Curves::new(vec![b.build().into()])
    }

    fn coloured(n: u64, set: &[(&str, Value)]) -> std::sync::Arc<Tuft> {
        let (out, _) = run(&NODE, &[&[("curves", hair(n).into())], set].concat());
        curves_of(&out[0]).tufts()[0].clone()
    }

    /// Pigment `root` and `tip`, nothing random.
    fn plain(root: f32, tip: f32) -> Vec<(&'static str, Value)> {
        let set = [("melanin_root", root), ("melanin_tip", tip), ("redness", 0.0)];
        let set = set.into_iter().chain([("variation", 0.0)]);
        set.map(|(name, x)| (name, Value::Float(x))).collect()
    }

    #[track_caller]
    fn check(set: &[(&str, Value)], stored: usize, at: usize, want: Vec3) {
        let tuft = coloured(2, set);
        assert_eq!(tuft.attribute(COLOUR.name).map_or(0, |a| a.values.len()), stored);
        assert_eq!(tuft.points(), hair(2).tufts()[0].points());
        assert_eq!(tuft.attributes().len(), hair(2).tufts()[0].attributes().len() + 1);
        let got = tuft.view(COLOUR).at(at / 3, at);
        let off = ((got - want) / want).abs().max_element();
        assert!(off < 1e-3, "{got} {want}");
    }

    #[test]
    fn pigment_is_mixed_as_absorption_and_stored_as_few_times_as_it_can() {
        let brown = absorption_of_melanin(0.87, 0.0);
        let blond = absorption_of_melanin(0.3, 0.0);
        check(&plain(0.87, 0.87), 1, 4, colour_of(brown));
        check(&plain(0.87, 0.3), 6, 4, colour_of((brown + blond) * 0.5));
        check(&plain(0.87, 0.3), 6, 5, colour_of(blond));
        let with = |more: (&'static str, Value)| [plain(0.87, 0.87), vec![more]].concat();
        let half = with(("amount", Value::Float(0.5)));
        check(&half, 2, 4, colour_of((brown + absorption_of(COLOUR.default)) * 0.5));
        // All grey: slightly more than a fiftieth of the pigment.
        check(&with(("grey", Value::Float(1.0))), 2, 1, colour_of(brown * 0.04));
        check(&with(("grey", Value::Float(0.0))), 1, 1, colour_of(brown));
        let red = Vec3::new(0.5, 0.05, 0.05);
        let dye = [plain(0.3, 0.3), vec![("dye", Value::Vec3(red))]].concat();
        check(&dye, 1, 1, colour_of(blond + absorption_of(red)));
        let weak = ("dye_amount", Field::Attribute("half".into()).into());
        check(&[dye, vec![weak]].concat(), 2, 1, colour_of(blond + absorption_of(red) * 0.5));
        // The hair's own colour is kept, and varied and dyed all the same.
        let own = ("from", Value::Text("own".into()));
        check(&with(own.clone()), 2, 4, COLOUR.default);
        let dye = [plain(0.3, 0.3), vec![own, ("dye", Value::Vec3(red))]].concat();
        check(&dye, 2, 1, colour_of(absorption_of(COLOUR.default) + absorption_of(red)));
        // An amount of 0 changes nothing.
        let tuft = coloured(1, &with(("amount", Value::Float(0.0))));
        assert!(tuft.attribute(COLOUR.name).is_none());
    }

    #[test]
    fn the_share_of_grey_hairs_is_the_one_asked_for_and_grows_hair_by_hair() {
        let n = 4000;
        let greys = |share: f32, softness: f32| -> Vec<f32> {
            let set = [("grey", share), ("grey_softness", softness)];
            let set = set.map(|(name, x)| (name, Value::Float(x)));
            let tuft = coloured(n, &[plain(0.9, 0.9), set.to_vec()].concat());
            (0..n as usize).map(|i| tuft.view(COLOUR).at(i, 3 * i).x).collect()
        };
        let dark = colour_of(absorption_of_melanin(0.9, 0.0)).x;
        for (share, softness) in [(0.0, 0.0), (0.3, 0.0), (0.3, 0.2), (1.0, 0.5), (0.0, 0.5)] {
            let colours = greys(share, softness);
            let grey = colours.iter().filter(|c| **c > 4.0 * dark).count() as f32 / n as f32;
            assert!((grey - share).abs() < 0.07, "{share} {softness}: {grey}");
            assert!(share > 0.0 || grey == 0.0);
            let more = greys((share + 0.2).min(1.0), softness);
            assert!(colours.iter().zip(&more).all(|(less, more)| more >= less));
        }
    }

    #[test]
    fn hairs_differ_by_their_own_amount_whoever_stands_beside_them() {
        let colours = |n| {
            let tuft = coloured(n, &[("grey", Value::Float(0.5))]);
            (0..2).map(|i| tuft.view(COLOUR).at(i, 3 * i)).collect::<Vec<_>>()
        };
        assert_eq!(colours(2), colours(9));
        assert_ne!(colours(2)[0], colours(2)[1]);
    }
}
