//! Noise: hair that waves, all of it together as wind and sleep do it, or each hair on its own.
//!
//! Guarantees: those of `held.rs`; before lengths are kept no point goes farther aside than the amplitude says. Not promised: waves
//! finer than a hair has points for, which is remarked.

use super::hair::Hair;
use super::held::Held;
use super::waves::Waves;
use crate::cluster::sections::reads_attribute;
use crate::data::curves::Curves;
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::EvalCx;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Lets hair wave.
    ///
    /// Noise in space moves neighbours together, so that hair waves in locks and sheets; noise along the hair gives each its own
    /// way. Roots stay, and so do lengths.
    "noise", version 1, label "Noise",
        words "hair curves noise turbulence perlin fractal displace jitter random natural messy bend wind modifier";
    inputs {
        /// Hair to change.
        curves: Curves;
        /// The head that it stays out of; masks need it, too.
        scalp: Option<Arc<Scalp>>;
        /// How far aside hair goes at most.
        amplitude: FieldInput = 0.6, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length), words("amount magnitude strength intensity");
        /// Length of the largest waves.
        wavelength: f32 = 5.0, hard(0.05, 1000.0), soft(0.5, 20.0), unit(Length), words("frequency scale size");
        /// Factor of the amplitude from root (left) to tip.
        along: Arc<Ramp> = Ramp::linear(0.0, 1.0), hard(-10.0, 10.0), soft(0.0, 1.0), words("profile falloff ramp");
        /// What waves together.
        together: Together = Together::Space, words("mode space strand correlation coherent");
        /// How many sizes of waves there are, each half as long as the one before. 1 is smooth.
        octaves: i64 = 2, hard(1.0, 8.0), soft(1.0, 4.0), unit(Count), words("detail complexity smooth");
        /// Share of each size by the one before it: 0 is smooth, 1 is rough.
        roughness: f32 = 0.4, hard(0.0, 1.0), unit(Ratio), words("gain persistence smooth");
        /// Whether every hair stays as long as it was, piece by piece.
        keep_length: bool = true, words("preserve stretch");
        /// Whether lengths typed here grow with the size of the head.
        scale_with_head: bool = true;
        /// Seed tag; stored, mixed into randomness.
        seed: i64 = 0;
    }
    outputs {
        /// The same hair, waving.
        curves: Curves;
    }
}

choice! {
    /// What waves together.
    Together {
        /// What is near each other in space.
        Space = "space",
        /// Each hair for itself.
        Hair = "hair",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let unit = cx.head_unit(scalp, inputs.scale_with_head);
    let own_unit = if reads_attribute(&inputs.amplitude.field) { 1.0 } else { unit };
    let wavelength = inputs.wavelength * unit;
    let waves = Waves {
        dice: cx.dice(inputs.seed, "noise"),
        octaves: inputs.octaves as u32,
        roughness: inputs.roughness,
    };
    // In the head's axes, so that a head that stands elsewhere has the same waves.
    let frame = scalp.map(|scalp| *scalp.frame());
    let in_space = |p: Vec3| match &frame {
        Some(frame) => {
            let at = frame.head_from_vector(p - frame.origin) / wavelength;
            frame.vector_from_head(waves.in_space(at))
        }
        None => waves.in_space(p / wavelength),
    };
    let held = Held { scalp, keep_length: inputs.keep_length };
    let [curves] = cx.by_place(scalp).each_tuft(&inputs.curves, |tuft, piece| {
        let amplitude = inputs.amplitude.on(tuft, scalp)?;
        let bent = held.bend(tuft, piece, |hair, i, new| {
            let first = tuft.range(i).start;
            let far = |k: usize| {
                let u = hair.u(k);
                amplitude.at(i, first + k, u) * own_unit * inputs.along.at(u)
            };
            match inputs.together {
                Together::Space => wave(hair, new, far, |k| in_space(hair.points()[k])),
                Together::Hair => {
                    let id = tuft.id(i);
                    wave(hair, new, far, |k| waves.along(id, hair.come(k) / wavelength));
                }
            }
        })?;
        Ok([bent])
    })?;
    super::hair::remark_coarse(cx, &inputs.curves, 0.5 * wavelength, "half the wavelength");
    Ok(Outputs { curves })
}

/// Moves every point across its hair: as far (cm) as `far` says of a vector of `waves`.
fn wave(hair: &Hair, new: &mut [Vec3], far: impl Fn(usize) -> f32, waves: impl Fn(usize) -> Vec3) {
    for (k, p) in new.iter_mut().enumerate().skip(1) {
        let far = far(k);
        if far != 0.0 {
            *p += waves(k).reject_from_normalized(hair.tangent(k)) * far;
        }
    }
}
