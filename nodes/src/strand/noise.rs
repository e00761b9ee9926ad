//! Noise: smooth waves, shared by hair that is close in space, or independent for each hair.
//!
//! Guarantees: those of `data/route`; before lengths are restored, no CV is displaced by more than the amplitude. Not promised:
//! waves finer than the spacing of CVs, which are remarked on.

use super::waves::Waves;
use crate::data::curves::Curves;
use crate::data::ramp::Ramp;
use crate::data::route::Policy;
use crate::data::route::hair::Hair;
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, TracedScalp};
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Bends hair with smooth noise.
    ///
    /// Noise in space moves neighbours together, so hair waves in locks and sheets; noise along the hair bends each strand on
    /// its own. Roots and lengths stay.
    "noise", version 1, label "Noise",
        words "hair curves noise turbulence perlin fractal displace jitter random natural messy bend wind modifier", scales;
    inputs {
        /// Hair to change.
        curves: Curves;
        /// Head that the hair stays out of. Masks need it too.
        scalp: Option<TracedScalp>;
        /// Largest distance from the hair's path.
        amplitude: FieldInput = 0.6, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length), words("amount magnitude strength intensity");
        /// Wavelength of the largest waves.
        wavelength: f32 = 5.0, hard(0.05, 1000.0), soft(0.5, 20.0), unit(Length), words("frequency scale size");
        /// Amplitude factor from root (left) to tip.
        along: Arc<Ramp> = Ramp::linear(0.0, 1.0), hard(-10.0, 10.0), soft(0.0, 1.0), words("profile falloff ramp");
        /// What waves together.
        together: Together = Together::Space, words("mode space strand correlation coherent");
        /// Layers of noise, each with half the wavelength of the one before. 1 is smooth.
        octaves: i64 = 2, hard(1.0, 8.0), soft(1.0, 4.0), unit(Count), words("detail complexity smooth");
        /// Strength of each layer relative to the one before: 0 is smooth, 1 is rough.
        roughness: f32 = 0.4, hard(0.0, 1.0), unit(Ratio), words("gain persistence smooth");
        /// Keep the length of every segment.
        keep_length: bool = true, words("preserve stretch");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The hair, bent.
        curves: Curves;
    }
}

choice! {
    /// What waves together.
    Together {
        /// Hair that is close in space.
        Space = "space",
        /// Each hair on its own.
        Hair = "hair",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let wavelength = inputs.wavelength;
    let waves = Waves {
        dice: cx.dice(inputs.seed, "noise"),
        octaves: inputs.octaves as u32,
        roughness: inputs.roughness,
    };
    // In the head's axes, so that the waves move with the head.
    let frame = inputs.scalp.as_ref().map(|scalp| *scalp.head().frame());
    let in_space = |p: Vec3| match &frame {
        Some(frame) => {
            let at = frame.head_from_vector(p - frame.origin) / wavelength;
            frame.vector_from_head(waves.in_space(at))
        }
        None => waves.in_space(p / wavelength),
    };
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let route = piece.route(Policy::keep_length(inputs.keep_length));
        let amplitude = inputs.amplitude.on(tuft, piece.scalp())?;
        let bent = piece.bend(&route, tuft, |hair, i, new| {
            let first = tuft.range(i).start;
            let far = |k: usize| {
                let u = hair.u(k);
                amplitude.at(i, first + k, u) * inputs.along.at(u)
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
    super::coarse::remark_coarse(cx, &inputs.curves, 0.5 * wavelength, "half the wavelength");
    Ok(Outputs { curves })
}

/// Displaces every CV across its hair by `far` (cm) times a vector of `waves`.
fn wave(hair: &Hair, new: &mut [Vec3], far: impl Fn(usize) -> f32, waves: impl Fn(usize) -> Vec3) {
    for (k, p) in new.iter_mut().enumerate().skip(1) {
        let far = far(k);
        if far != 0.0 {
            *p += waves(k).reject_from_normalized(hair.tangent(k)) * far;
        }
    }
}
