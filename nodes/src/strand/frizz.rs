//! Frizz: short random kinks, independent for each hair.
//!
//! A hair walks across itself as strands of sketched clusters do (methods.md 6): a random step at a fixed spacing, within a disc.
//! Guarantees: those of `data/route`; before lengths are restored, no CV is displaced by more than the amplitude. Not promised:
//! kinks finer than the spacing of CVs, which are remarked on.

use crate::data::curves::Curves;
use crate::data::field::Sampler;
use crate::data::ramp::Ramp;
use crate::data::route::Policy;
use crate::data::route::bundle::{Bend, Hairs, Wish};
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::hash::Dice;
use crate::maths::lanes::{Eight, LANES, Simd, Vec3x8, f32x8, ops::*, pick};
use crate::maths::random_walk::{random_walks, smooth_each};
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
        let own = |id: u64| 1.0 - inputs.variation * dice.unit(id, 0);
        let (along, kink) = (&*inputs.along, inputs.kink);
        let mut frizz =
            Frizz { amplitude, along, own, step, kink, walk_dice, scratch: Scratch::default() };
        Ok([piece.bend(&route, tuft, &mut frizz)?])
    })?;
    super::coarse::remark_coarse(cx, &inputs.curves, step, "the step from kink to kink")?;
    Ok(Outputs { curves })
}

/// Displaces every CV by the random walk of its hair.
struct Frizz<'a, O> {
    amplitude: Sampler<'a>,
    along: &'a Ramp,
    /// Factor of the hair with this id.
    own: O,
    step: f32,
    kink: f32,
    walk_dice: Dice,
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    far: Vec<Eight>,
    frames: Vec<[[Eight; 3]; 2]>,
    walk: Vec<[Eight; 2]>,
}

impl<O: Fn(u64) -> f32> Bend for Frizz<'_, O> {
    #[inline(always)]
    fn bend<S: Simd>(&mut self, hairs: &Hairs<S>, wish: &mut Wish<S>) {
        let (s, own) = (hairs.s, hairs.own(&self.own));
        let Scratch { far, frames, walk } = &mut self.scratch;
        far.resize(hairs.len(), Eight::default());
        let mut frizzes = s.splat_mask32x8(0);
        for (k, to) in far.iter_mut().enumerate().skip(1) {
            let far = hairs.field(&self.amplitude, k) * own * self.along.at_each(hairs.u(k));
            frizzes |= !far.simd_eq(0.0) & hairs.has(k);
            to.set(far);
        }
        if s.all_false_mask32x8(frizzes) {
            return;
        }
        let mut spans = Eight::default();
        spans.set(hairs.length() / self.step);
        spans.0 = spans.0.map(|x| x.ceil().clamp(1.0, MOST_STEPS));
        random_walks(s, self.walk_dice, hairs.ids, spans.0, self.kink, walk);
        hairs.frames(frames);
        for k in 1..hairs.len() {
            let at = hairs.come(k) / self.step;
            let most = spans.get(s);
            let (knot, [a, b, c]) = smooth_each(pick(at.simd_lt(most), at, most));
            let (d, e) = (knots(s, walk, &knot, 0), knots(s, walk, &knot, 1));
            let f = knots(s, walk, &knot, 2);
            let [x, y] = [d[0] * a + e[0] * b + f[0] * c, d[1] * a + e[1] * b + f[1] * c];
            let (tangent, normal) =
                (Vec3x8::load(s, &frames[k][0]), Vec3x8::load(s, &frames[k][1]));
            let p = wish.get(k);
            let off = tangent.cross(normal) * x + normal * y;
            wish.set(k, Vec3x8::pick(frizzes, p + off * far[k].get(s), p));
        }
    }
}

/// The position of each walk `next` knots after `knot`.
#[inline(always)]
fn knots<S: Simd>(s: S, walk: &[[Eight; 2]], knot: &[usize; LANES], next: usize) -> [f32x8<S>; 2] {
    let mut at = [Eight::default(); 2];
    for i in 0..LANES {
        let knot = &walk[(knot[i] + next).min(walk.len() - 1)];
        (at[0].0[i], at[1].0[i]) = (knot[0].0[i], knot[1].0[i]);
    }
    [at[0].get(s), at[1].get(s)]
}
