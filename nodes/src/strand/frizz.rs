//! Frizz: short random kinks, independent for each hair.
//!
//! A hair walks across itself as strands of sketched clusters do (methods.md 6): a random step at a fixed spacing, within a disc.
//! Guarantees: those of `data/route`; before lengths are restored, no CV is displaced by more than the amplitude. Not promised:
//! kinks finer than the spacing of CVs, which are remarked on.

use crate::data::curves::Curves;
use crate::data::ramp::Ramp;
use crate::data::route::Policy;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::random_walk::{random_walk, smooth};
use glam::Vec2;
use std::sync::Arc;

node! {
    /// Adds short random kinks to every hair.
    ///
    /// Roots and lengths stay, so hair looks shorter the more it frizzes. The hair needs CVs at least as dense as the kinks:
    /// resample it first.
    "frizz", version 1, label "Frizz",
        words "hair curves frizz frizzy kink crimp fuzzy fuzz scraggle messy rough random noise modifier dry humid", scales;
    inputs {
        /// Hair to change.
        curves: Curves;
        /// Head that the hair stays out of. Masks need it too.
        scalp: Option<TracedScalp>;
        /// Largest distance of a kink from the hair's path.
        amplitude: FieldInput = 0.5, hard(0.0, 100.0), soft(0.0, 2.0), unit(Length), words("amount magnitude strength intensity");
        /// Amplitude factor from root (left) to tip.
        along: Arc<Ramp> = Ramp::linear(0.3, 1.0), hard(-10.0, 10.0), soft(0.0, 1.0), words("profile falloff ramp");
        /// Spacing of kinks along the hair.
        step: f32 = 0.5, hard(0.02, 1000.0), soft(0.1, 3.0), unit(Length), words("frequency wavelength scale size");
        /// How sharp kinks are: 1 may jump across the whole amplitude, lower values drift.
        kink: f32 = 1.0, hard(0.0, 1.0), unit(Ratio), words("sharpness wild");
        /// How much less some hairs frizz than others. At 1, some stay smooth.
        variation: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("random vary");
        /// Keep the length of every segment.
        keep_length: bool = true, words("preserve stretch");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The hair, frizzed.
        curves: Curves;
    }
}

/// Largest number of kinks per hair; on longer hair the last ones are farther apart.
const MOST_STEPS: f32 = 4096.0;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let step = inputs.step;
    let (walk_dice, dice) =
        (cx.dice(inputs.seed, "frizz"), cx.dice(inputs.seed, "frizz of a hair"));
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let route = piece.route(Policy::keep_length(inputs.keep_length));
        let amplitude = inputs.amplitude.on(tuft, piece.scalp())?;
        let (mut frames, mut walk, mut steps) = (vec![], vec![], vec![]);
        let bent = piece.bend(&route, tuft, |hair, i, new| {
            let (first, id) = (tuft.range(i).start, tuft.id(i));
            let own = 1.0 - inputs.variation * dice.unit(id, 0);
            let far = |k: usize| {
                let u = hair.u(k);
                amplitude.at(i, first + k, u) * own * inputs.along.at(u)
            };
            if (1..new.len()).all(|k| far(k) == 0.0) {
                return;
            }
            let spans = (hair.length() / step).ceil().clamp(1.0, MOST_STEPS);
            steps.clear();
            steps.resize(spans as usize + 1, inputs.kink);
            walk.resize(steps.len() + 2, Vec2::ZERO);
            random_walk(walk_dice, id, Vec2::ZERO, &steps, &mut walk);
            hair.frames(&mut frames);
            for (k, p) in new.iter_mut().enumerate().skip(1) {
                let (knot, [a, b, c]) = smooth((hair.come(k) / step).min(spans));
                let d = walk[knot] * a + walk[knot + 1] * b + walk[knot + 2] * c;
                *p += frames[k].across(d.x, d.y) * far(k);
            }
        })?;
        Ok([bent])
    })?;
    super::coarse::remark_coarse(cx, &inputs.curves, step, "the step from kink to kink");
    Ok(Outputs { curves })
}
