//! Stray: flyaways that leave the hair around them.
//!
//! Guarantees: those of `data/route`; which hairs stray depends on their ids alone, and a higher share only adds some; before
//! lengths are restored, no CV is displaced by more than the distance.

use super::waves::Waves;
use crate::data::attributes::SCALP_NORMAL;
use crate::data::curves::{Curves, Tuft};
use crate::data::ramp::Ramp;
use crate::data::route::Policy;
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Turns a share of the hairs into flyaways that leave the others on their way to the tip.
    ///
    /// Each bends away in its own direction, farthest at the tip, with a slight wave.
    "stray", version 1, label "Stray",
        words "hair curves stray strays flyaway flyaways loose wild hairs rogue messy natural modifier baby breakage halo", scales;
    inputs {
        /// Hair to change.
        curves: Curves;
        /// Head that the hair stays out of. Masks need it too.
        scalp: Option<TracedScalp>;
        /// Share of hairs that leave. Read at the root.
        share: FieldInput = 0.04, hard(0.0, 1.0), soft(0.0, 0.2), unit(Ratio), words("amount percent number probability");
        /// Largest distance of a tip from its old place.
        distance: FieldInput = 1.5, hard(0.0, 100.0), soft(0.0, 5.0), unit(Length), words("amplitude magnitude strength spread");
        /// Share of the distance from root (left) to tip.
        along: Arc<Ramp> = Ramp::smooth(0.0, 1.0), hard(-10.0, 10.0), soft(0.0, 1.0), words("profile falloff ramp");
        /// Direction: 0 any, 1 away from the skin.
        lift: f32 = 0.4, hard(0.0, 1.0), unit(Ratio), words("up out rise volume");
        /// Waviness, as a share of the distance.
        wave: f32 = 0.4, hard(0.0, 2.0), soft(0.0, 1.0), unit(Ratio), words("bend curl");
        /// Keep the length of every segment.
        keep_length: bool = true, words("preserve stretch");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The hair, with flyaways.
        curves: Curves;
    }
}

/// Wavelength of stray hairs, cm: as long as hair bends by itself.
const WAVE: f32 = 6.0;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let wave_length = WAVE * cx.unit();
    let dice = cx.dice(inputs.seed, "stray");
    let waves = Waves { dice: cx.dice(inputs.seed, "stray wave"), octaves: 2, roughness: 0.4 };
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let route = piece.route(Policy::keep_length(inputs.keep_length));
        let scalp = piece.scalp();
        let (share, distance) = (inputs.share.on(tuft, scalp)?, inputs.distance.on(tuft, scalp)?);
        let mut frames = vec![];
        let bent = piece.bend(&route, tuft, |hair, i, new| {
            let (first, id) = (tuft.range(i).start, tuft.id(i));
            if dice.unit(id, 0) >= share.at(i, first, 0.0) {
                return;
            }
            // Few go the full distance.
            let far = 0.25 + 0.75 * dice.unit(id, 1);
            hair.frames(&mut frames);
            let (y, x) = sin_cos_turns(dice.unit(id, 2));
            let aside = frames[0].across(x, y);
            let out = outward(tuft, i, scalp).map_or(aside, |out| aside.lerp(out, inputs.lift));
            let way = out.normalize_or(aside);
            for (k, p) in new.iter_mut().enumerate().skip(1) {
                let u = hair.u(k);
                let off = far * distance.at(i, first + k, u) * inputs.along.at(u);
                if off != 0.0 {
                    let wave = waves.along(id, hair.come(k) / wave_length) * inputs.wave;
                    *p += (way + wave).clamp_length_max(1.0) * off;
                }
            }
        })?;
        Ok([bent])
    })?;
    Ok(Outputs { curves })
}

/// Direction away from the skin at the root of a curve, by the scalp or the curve itself.
fn outward(tuft: &Tuft, i: usize, scalp: Option<&Scalp>) -> Option<Vec3> {
    let first = tuft.range(i).start;
    let skin = || {
        let scalp = scalp?;
        let hit = scalp.skin().closest(tuft.points()[first])?;
        Some(scalp.surface().smooth_normal(hit.triangle, hit.bary))
    };
    skin().or_else(|| tuft.view(SCALP_NORMAL).at(i, first).try_normalize())
}
