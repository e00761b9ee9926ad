//! Lower bound for the points of curls, from sizes and lengths alone: nothing is drawn or wound.
//!
//! Guarantees: no fewer points are made, except for hair that is dropped or kept straight beside a parting. Not
//! promised: a tight bound. Turns are assumed as large as possible, with as few points each as possible.

use super::{Inputs, Keep, Pattern, PresetValues};
use crate::data::attributes::FIBRE;
use crate::define::NodeError;
use crate::eval::Size;

/// Fewest points on a turn, where chords cut its corners (winding.rs: eight requested).
const ON_A_TURN: f32 = 6.5;
/// Fraction of its allowed points that a hair at the limit uses at least.
const USED: f32 = 0.8;
/// Samples along a hair at which sizes are evaluated.
const PLACES: usize = 8;

pub(super) fn foreseen(
    inputs: &Inputs,
    numbers: &PresetValues,
    pattern: &Pattern,
) -> Result<Size, NodeError> {
    let most = (pattern.most() as f32 * USED).floor();
    let [amplitude, frequency, ..] = pattern.ranges;
    // Symmetric in scale, as `Pattern::start` draws it.
    let spread = (1.0 + 0.34 * pattern.spread) / (1.0 - 0.34 * pattern.spread);
    let longest = spread * pattern.even.pitch / (1.0 - frequency).max(0.1);
    let widest = spread * pattern.even.size * (1.0 + amplitude);
    let around = pattern.shapes.iter().fold(0.0, |most: f32, shape| most.max(shape.perimeter));
    let scalp = inputs.scalp.as_ref();
    let mut points = 0.0f64;
    for tuft in inputs.curves.tufts() {
        let pitch = inputs.pitch.as_ref().map(|f| f.on_traced(tuft, scalp)).transpose()?;
        let diameter = inputs.diameter.as_ref().map(|f| f.on_traced(tuft, scalp)).transpose()?;
        let amount = inputs.amount.on_traced(tuft, scalp)?;
        let long = inputs.hair_length.on_traced(tuft, scalp)?;
        let fibre = tuft.view(FIBRE);
        for i in 0..tuft.len() {
            let cvs = tuft.curve(i);
            let root = tuft.range(i).start;
            let of = |value: &dyn Fn(f32) -> f32| {
                (0..=PLACES).map(|k| value(k as f32 / PLACES as f32)).fold(0.0, f32::max)
            };
            let pitch =
                of(&|u| pitch.as_ref().map_or(numbers.pitch, |f| f.along(tuft, i, u))) * longest;
            let wide = of(&|u| {
                let wide = diameter.as_ref().map_or(numbers.diameter, |f| f.along(tuft, i, u));
                wide * amount.along(tuft, i, u)
            });
            if wide == 0.0 {
                points += cvs.len() as f64;
                continue;
            }
            let round = around * 0.5 * wide * widest;
            let on_curl = |fibre: f32| fibre * pitch / (pitch * pitch + round * round).sqrt();
            let span = length(cvs);
            let reach = match (inputs.length, fibre.at(i, root)) {
                (Keep::Span, _) => span,
                (Keep::Visible, _) => long.at(i, root, 0.0),
                (Keep::Stretched, _) => on_curl(long.at(i, root, 0.0)),
                (Keep::Fibre, given) if given > 0.0 => on_curl(given).min(span),
                (Keep::Fibre, _) => on_curl(span),
            };
            // The turn that a hair ends on may have barely begun.
            let turns = (reach / pitch.max(1e-6) - 1.0).max(0.0);
            let wanted = (turns * ON_A_TURN).min(most).max(2.0);
            points += if wanted.is_finite() { f64::from(wanted) } else { 2.0 };
        }
    }
    Ok(Size::of(&[("points on the turns of all hairs, at least", points)]))
}

/// Length from point to point, cm: no curve through them is shorter.
fn length(cvs: &[glam::Vec3]) -> f32 {
    cvs.windows(2).map(|w| w[0].distance(w[1])).sum()
}
