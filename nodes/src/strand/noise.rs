//! Noise: smooth waves, shared by hair that is close in space, or independent for each hair.
//!
//! Guarantees: those of `data/route`; before lengths are restored, no CV is displaced by more than the amplitude. Not promised:
//! waves finer than the spacing of CVs, which are remarked on.

use super::waves::{InSpace, OnHairs, Waves};
use crate::data::curves::Curves;
use crate::data::field::Sampler;
use crate::data::ramp::Ramp;
use crate::data::route::Policy;
use crate::data::route::bundle::{Bend, Hairs, Wish};
use crate::data::scalp::HeadFrame;
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::lanes::{Simd, Vec3x8, ops::*};
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
    let frame = inputs.scalp.as_ref().map(|scalp| *scalp.head().frame());
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let route = piece.route(Policy::keep_length(inputs.keep_length));
        let (amplitude, along) = (inputs.amplitude.on(tuft, piece.scalp())?, &*inputs.along);
        let bent = match inputs.together {
            Together::Space => {
                let waves = Across { waves: InSpace::new(&waves), frame, wavelength };
                piece.bend(&route, tuft, &mut Noise { amplitude, along, waves })
            }
            Together::Hair => {
                let waves = Along { waves: OnHairs::new(&waves), wavelength };
                piece.bend(&route, tuft, &mut Noise { amplitude, along, waves })
            }
        };
        Ok([bent?])
    })?;
    super::coarse::remark_coarse(cx, &inputs.curves, 0.5 * wavelength, "half the wavelength")?;
    Ok(Outputs { curves })
}

/// Displaces every CV perpendicular to its hair, by the amplitude times the waves there.
struct Noise<'a, W> {
    amplitude: Sampler<'a>,
    along: &'a Ramp,
    waves: W,
}

/// Waves of either kind.
trait At {
    /// The waves at point `k`.
    fn at<S: Simd>(&mut self, hairs: &Hairs<S>, k: usize) -> Vec3x8<S>;
}

impl<W: At> Bend for Noise<'_, W> {
    #[inline(always)]
    fn bend<S: Simd>(&mut self, hairs: &Hairs<S>, wish: &mut Wish<S>) {
        for k in 1..hairs.len() {
            let far = hairs.field(&self.amplitude, k) * self.along.at_each(hairs.u(k));
            let wave = self.waves.at(hairs, k).reject_from(hairs.tangent(k));
            let p = wish.get(k);
            wish.set(k, Vec3x8::pick(far.simd_eq(0.0), p, p + wave * far));
        }
    }
}

/// Waves in space. On a head they use its axes, so that they move with it.
struct Across<'a> {
    waves: InSpace<'a>,
    frame: Option<HeadFrame>,
    wavelength: f32,
}

impl At for Across<'_> {
    #[inline(always)]
    fn at<S: Simd>(&mut self, hairs: &Hairs<S>, k: usize) -> Vec3x8<S> {
        let (s, p, per) = (hairs.s, hairs.point(k), self.wavelength);
        let at = match &self.frame {
            Some(frame) => {
                let from = p - Vec3x8::splat(s, frame.origin);
                Vec3x8 {
                    x: from.dot(Vec3x8::splat(s, frame.right)),
                    y: from.dot(Vec3x8::splat(s, frame.up)),
                    z: from.dot(Vec3x8::splat(s, frame.forward)),
                }
            }
            None => p,
        };
        let wave = self.waves.at(Vec3x8 { x: at.x / per, y: at.y / per, z: at.z / per });
        match &self.frame {
            Some(frame) => {
                let (right, up) = (Vec3x8::splat(s, frame.right), Vec3x8::splat(s, frame.up));
                right * wave.x + up * wave.y + Vec3x8::splat(s, frame.forward) * wave.z
            }
            None => wave,
        }
    }
}

/// Waves along each hair.
struct Along<'a> {
    waves: OnHairs<'a>,
    wavelength: f32,
}

impl At for Along<'_> {
    #[inline(always)]
    fn at<S: Simd>(&mut self, hairs: &Hairs<S>, k: usize) -> Vec3x8<S> {
        self.waves.at(hairs.ids, hairs.come(k) / self.wavelength)
    }
}
