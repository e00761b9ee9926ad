//! The remark of modifiers whose detail is finer than the spacing of CVs.

use crate::data::curves::{Curves, Tuft};
use crate::data::route::hair::Hair;
use crate::eval::EvalCx;

/// Remarks how many hairs have CVs farther apart than `step` (cm), the size of `what`, so that finer detail is lost.
pub(super) fn remark_coarse(cx: &EvalCx, curves: &Curves, step: f32, what: &str) {
    let mut hair = Hair::default();
    let coarse = |(tuft, i): &(&Tuft, usize)| hair.read(tuft.curve(*i)) && hair.spacing() > step;
    let coarse = curves.each().filter(coarse).count();
    if coarse > 0 {
        let all = curves.curve_count();
        cx.remark(format!(
            "{coarse} of {all} hairs have points farther apart than {what} ({step:.2} cm), and show nothing finer: Resample them before"
        ));
    }
}
