//! Clump: hair drawn together to locks and wisps.
//!
//! Guarantees: those of `held.rs` and `middles.rs`; a higher share of strays only takes hairs out of clumps. Not promised: that hair
//! of one clump, but of several tufts whose hair runs apart, comes together: each tuft is drawn to a hair of its own, all of them
//! rooted at the clump's place.

use super::held::Held;
use super::middles::{Given, Middles};
use super::seeds::Seeds;
use crate::data::curves::{Curves, Tuft};
use crate::data::field::FieldFault;
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, Value as Set, node};
use crate::eval::EvalCx;
use std::sync::Arc;

node! {
    /// Draws hair together to clumps: locks, wisps and what they are made of.
    ///
    /// Clumps lie where density strews them; or wire curves to draw hair to the nearest of them, or name an attribute that says
    /// who belongs together. Finer levels make clumps of clumps. Roots stay, and so do lengths.
    "clump", version 1, label "Clump",
        words "hair curves clump clumps clumping gather wisp wisps lock locks bunch group tuft strand separate piecey wet modifier";
    inputs {
        /// Hair to draw together.
        curves: Curves;
        /// The head that it stays out of; hair of two sections is never drawn together.
        scalp: Option<Arc<Scalp>>;
        /// Curves to draw hair to: each goes to the one rooted nearest.
        centres: Option<Curves>, words("guides centers middles clusters");
        /// How far hair is drawn together: 0 not at all, 1 to a line.
        amount: FieldInput = 0.8, hard(0.0, 1.0), unit(Ratio), words("tightness strength factor");
        /// How the amount grows from root (left) to tip.
        along: Arc<Ramp> = Ramp::smooth(0.0, 1.0), hard(0.0, 1.0), words("profile falloff shape ramp");
        /// Clumps on a square centimetre. With curves or an attribute it counts for the finer levels alone.
        density: f32 = 0.6, hard(0.01, 1000.0), soft(0.1, 10.0), unit(PerCm2), words("number size count"),
            idle(only_finer);
        /// Clumps, and clumps within them: each level has four times as many as the one before.
        levels: i64 = 2, hard(1.0, 5.0), soft(1.0, 4.0), unit(Count), words("sub clumps multi level hierarchy");
        /// Attribute whose value says which hairs belong together, such as parent; with curves, the id of the one that a hair goes to.
        attribute: Arc<str> = "", words("id parent map group");
        /// Turn of a clump about its middle from root to tip.
        twist: f32 = 0.0, hard(-3600.0, 3600.0), soft(-360.0, 360.0), unit(Angle), words("twirl rope spin roll");

        [Detail]
        /// Whether every hair stays as long as it was, piece by piece.
        keep_length: bool = true, words("preserve stretch");
        /// Whether the density falls with the square of the head's size.
        scale_with_head: bool = true;

        [Randomness]
        /// Share of hairs that are in no clump.
        strays: f32 = 0.05, hard(0.0, 1.0), soft(0.0, 0.3), unit(Ratio), words("flyaways loose hairs noise");
        /// Seed tag; stored, mixed into randomness.
        seed: i64 = 0;
    }
    outputs {
        /// The same hair in clumps.
        curves: Curves;
    }
}

/// Each level has so many times the clumps of the one before.
const FINER: f32 = 4.0;

fn only_finer(of: &dyn Fn(&str) -> Option<Set>) -> Option<&'static str> {
    let is_one = matches!(of("levels"), Some(Set::Int(1)));
    let named = matches!(of("attribute"), Some(Set::Text(name)) if !name.trim().is_empty());
    (is_one && named).then_some("an attribute says which hairs belong together")
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let unit = cx.head_unit(scalp, inputs.scale_with_head);
    let dice = cx.dice(inputs.seed, "clump");
    let stray = cx.dice(inputs.seed, "clump stray");
    let centres = inputs.centres.as_ref().map(one_each);
    let given = centres.as_ref().map(|all| Given::new(all.tufts().iter().map(|tuft| &**tuft)));
    let name = inputs.attribute.trim();
    let held = Held { scalp, keep_length: inputs.keep_length };
    let levels = |tuft: &Tuft, read: &[&Tuft]| -> Result<Vec<Middles>, NodeError> {
        let missing = || FieldFault::NoAttribute(name.to_owned());
        let first = match (&given, name) {
            (None, "") => None,
            (None, _) => Some(Middles::alike(tuft, name, scalp).ok_or_else(missing)?),
            (Some(_), "") => Some(Middles::given(tuft, read, scalp)),
            (Some(_), _) => Some(Middles::named(tuft, name, read).ok_or_else(missing)?),
        };
        let mut density = inputs.density / (unit * unit);
        let mut levels: Vec<Middles> = first.into_iter().collect();
        for level in 0..inputs.levels as u64 {
            if level > 0 || levels.is_empty() {
                let seeds = Seeds::on_surface(density, dice, level);
                levels.push(Middles::strewn(tuft, &seeds, scalp.map(Scalp::frame), scalp));
            }
            density *= FINER;
        }
        Ok(levels)
    };
    let none = Curves::default();
    let sources = centres.as_ref().unwrap_or(&none);
    let needs = |_: usize, tuft: &Tuft| match (&given, name) {
        (None, _) => vec![],
        (Some(given), "") => given.near(tuft),
        (Some(_), _) => (0..sources.tufts().len() as u32).collect(),
    };
    let [curves] = cx.by_place(scalp).each_tuft_with(
        &inputs.curves,
        sources,
        needs,
        |tuft, read, piece| {
            let amount = inputs.amount.on(tuft, scalp)?;
            if inputs.amount.constant() == Some(0.0) {
                return Ok([tuft.clone()]);
            }
            let levels = levels(tuft, read)?;
            let bent = held.bend(tuft, piece, |hair, i, new| {
                if stray.unit(tuft.id(i), 0) < inputs.strays {
                    return;
                }
                let first = tuft.range(i).start;
                let drawn = |k: usize| {
                    let u = hair.u(k);
                    amount.at(i, first + k, u) * inputs.along.at(u)
                };
                // The finest first: clumps of hair, then clumps of these.
                for middles in levels.iter().rev() {
                    middles.draw((hair, i), new, drawn, inputs.twist.to_radians());
                }
            })?;
            Ok([bent])
        },
    )?;
    Ok(Outputs { curves })
}

/// The same curves, one a tuft: what is read of one changes with it alone.
fn one_each(curves: &Curves) -> Curves {
    let tufts = curves.tufts().iter().flat_map(|tuft| {
        (0..tuft.len() as u32).filter(|i| !tuft.curve(*i as usize).is_empty()).map(|i| {
            match tuft.len() {
                1 => tuft.clone(),
                _ => Arc::new(tuft.gather(&[i]).build()),
            }
        })
    });
    Curves::new(tufts.collect())
}
