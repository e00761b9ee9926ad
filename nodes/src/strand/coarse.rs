//! The remark of modifiers whose detail is finer than the spacing of CVs.

use crate::data::curves::{Curves, Tuft};
use crate::define::NodeError;
use crate::eval::EvalCx;

/// Remarks how many hairs have CVs farther apart than `step` (cm), the size of `what`, so that finer detail is lost.
pub(super) fn remark_coarse(
    cx: &EvalCx,
    curves: &Curves,
    step: f32,
    what: &str,
) -> Result<(), NodeError> {
    let tufts = curves.tufts();
    let coarse = |tuft: &Tuft| (0..tuft.len()).filter(|i| spacing(tuft, *i) > step).count();
    let coarse: usize = cx.map(tufts.len(), |i| Ok(coarse(&tufts[i])))?.into_iter().sum();
    if coarse > 0 {
        let all = curves.curve_count();
        cx.remark(format!(
            "{coarse} of {all} hairs have points farther apart than {what} ({step:.2} cm), and show nothing finer: Resample them before"
        ));
    }
    Ok(())
}

/// Mean distance between the points of a hair, cm; 0 if it is not a curve.
fn spacing(tuft: &Tuft, i: usize) -> f32 {
    let points = tuft.curve(i);
    let length: f32 = points.windows(2).map(|w| w[1].distance(w[0])).sum();
    if length.is_finite() { length / points.len().max(2).saturating_sub(1) as f32 } else { 0.0 }
}
