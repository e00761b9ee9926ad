//! Clump: draws hair together into locks and wisps.
//!
//! Guarantees: those of `data/route` and `middles.rs`; a higher share of strays only takes hairs out of clumps. Not promised:
//! that hair of one clump in several tufts meets where the tufts diverge: each tuft is drawn to a hair of its own, all of them
//! rooted at the clump's centre.

use super::middles::{Given, Middles};
use super::seeds::Seeds;
use crate::data::curves::{Curves, Tuft};
use crate::data::field::{FieldFault, Sampler};
use crate::data::ramp::Ramp;
use crate::data::route::Policy;
use crate::data::route::bundle::{Bend, Hairs, Wish};
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, Value as Set, node};
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::lanes::{Eight, Simd, ops::*, pick};
use std::sync::Arc;

node! {
    /// Draws hair together into clumps: locks, wisps, and wisps within wisps.
    ///
    /// Density spreads clump centres over the scalp. Instead, wire curves to draw each hair to the nearest one, or name an
    /// attribute that groups hairs. Finer levels add clumps within clumps. Roots and lengths stay.
    "clump", version 1, label "Clump",
        words "hair curves clump clumps clumping gather wisp wisps lock locks bunch group tuft strand separate piecey wet modifier", scales;
    inputs {
        /// Hair to clump.
        curves: Curves;
        /// Head that the hair stays out of. Hair of different sections never clumps together.
        scalp: Option<TracedScalp>;
        /// Curves to draw hair to. Each hair goes to the curve with the nearest root.
        centres: Option<Curves>, words("guides centers middles clusters");
        /// How far hair is drawn to its centre: 0 not at all, 1 onto it.
        amount: FieldInput = 0.8, hard(0.0, 1.0), unit(Ratio), words("tightness strength factor");
        /// Amount from root (left) to tip.
        along: Arc<Ramp> = Ramp::smooth(0.0, 1.0), hard(0.0, 1.0), words("profile falloff shape ramp");
        /// Clumps per square centimetre. With curves or an attribute, it sets only the finer levels.
        density: f32 = 0.6, hard(0.01, 1000.0), soft(0.1, 10.0), unit(PerCm2), words("number size count"),
            idle(only_finer);
        /// Levels of clumps within clumps. Each level has four times as many clumps as the one before.
        levels: i64 = 2, hard(1.0, 5.0), soft(1.0, 4.0), unit(Count), words("sub clumps multi level hierarchy");
        /// Attribute that groups hairs into clumps, such as parent. With curves, it holds the id of each hair's curve.
        attribute: Arc<str> = "", words("id parent map group");
        /// Turn of each clump about its centre, from root to tip.
        twist: f32 = 0.0, hard(-3600.0, 3600.0), soft(-360.0, 360.0), unit(Angle), words("twirl rope spin roll");

        [Detail]
        /// Keep the length of every segment.
        keep_length: bool = true, words("preserve stretch");
        /// Scale the spacing of clumps with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// Share of hairs left out of all clumps.
        strays: f32 = 0.05, hard(0.0, 1.0), soft(0.0, 0.3), unit(Ratio), words("flyaways loose hairs noise");
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The hair, clumped.
        curves: Curves;
    }
}

/// Ratio of the number of clumps from one level to the next.
const FINER: f32 = 4.0;

fn only_finer(of: &dyn Fn(&str) -> Option<Set>) -> Option<&'static str> {
    let is_one = matches!(of("levels"), Some(Set::Int(1)));
    let named = matches!(of("attribute"), Some(Set::Text(name)) if !name.trim().is_empty());
    (is_one && named).then_some("an attribute says which hairs belong together")
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let dice = cx.dice(inputs.seed, "clump");
    let stray = cx.dice(inputs.seed, "clump stray");
    let centres = inputs.centres.as_ref().map(one_each);
    let given = centres.as_ref().map(|all| Given::new(all.tufts().iter().map(|tuft| &**tuft)));
    let name = inputs.attribute.trim();
    let levels =
        |tuft: &Tuft, read: &[&Tuft], scalp: Option<&Scalp>| -> Result<Vec<Middles>, NodeError> {
            let missing = || FieldFault::NoAttribute(name.to_owned());
            let first = match (&given, name) {
                (None, "") => None,
                (None, _) => Some(Middles::alike(tuft, name, scalp).ok_or_else(missing)?),
                (Some(_), "") => Some(Middles::given(tuft, read, scalp)),
                (Some(_), _) => Some(Middles::named(tuft, name, read).ok_or_else(missing)?),
            };
            let mut density = inputs.density;
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
        (Some(given), _) => given.named(tuft, name),
    };
    let [curves] = cx.by_place(inputs.scalp.as_ref()).each_tuft_with(
        &inputs.curves,
        sources,
        needs,
        |tuft, read, piece| {
            let scalp = piece.scalp();
            let amount = inputs.amount.on(tuft, scalp)?;
            if inputs.amount.constant() == Some(0.0) {
                return Ok([tuft.clone()]);
            }
            let levels = levels(tuft, read, scalp)?;
            let route = piece.route(Policy::keep_length(inputs.keep_length));
            let (along, twist) = (&*inputs.along, inputs.twist.to_radians());
            let is_in = |id: u64| stray.unit(id, 0) >= inputs.strays;
            let mut clump =
                Clump { amount, along, is_in, twist, levels: &levels, strength: vec![] };
            Ok([piece.bend(&route, tuft, &mut clump)?])
        },
    )?;
    Ok(Outputs { curves })
}

/// Draws hairs to the centres of all levels.
struct Clump<'a, B> {
    amount: Sampler<'a>,
    along: &'a Ramp,
    /// Whether the hair with this id is in any clump.
    is_in: B,
    twist: f32,
    levels: &'a [Middles],
    /// How far each point of the bundle is drawn.
    strength: Vec<Eight>,
}

impl<B: Fn(u64) -> bool> Bend for Clump<'_, B> {
    #[inline(always)]
    fn bend<S: Simd>(&mut self, hairs: &Hairs<S>, wish: &mut Wish<S>) {
        let is_in = hairs.own(|id| f32::from((self.is_in)(id))).simd_gt(0.0);
        self.strength.resize(hairs.len(), Eight::default());
        for (k, strength) in self.strength.iter_mut().enumerate() {
            let drawn = hairs.field(&self.amount, k) * self.along.at_each(hairs.u(k));
            strength.set(pick(is_in, drawn, hairs.s.splat_f32x8(0.0)));
        }
        // The finest level first: clumps of hair, then clumps of clumps.
        for middles in self.levels.iter().rev() {
            middles.draw(hairs, wish, &self.strength, self.twist);
        }
    }
}

/// The same curves, one per tuft, so that a key changes with one curve alone.
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
