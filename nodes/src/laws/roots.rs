//! Roots on the skin.

use super::hair::{Hair, quantile};
use crate::data::scalp::Scalp;

/// Where roots lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roots {
    /// Middle and largest distance of a root from the skin, cm.
    pub distance_cm: [f32; 2],
}

/// A root may be off the skin so far, cm.
const ROUNDING: f32 = 1e-3;

impl Roots {
    /// Whether all lie on the skin, to 0.001 cm.
    pub fn are_on_the_skin(&self) -> bool {
        self.distance_cm[1] <= ROUNDING
    }
}

/// Roots of all curves but those that were fed into a braid, which have none.
pub fn measure(hair: &Hair, scalp: &Scalp) -> Roots {
    let surface = scalp.surface();
    let fed = hair.whole("fed");
    let parts = hair.in_parts(hair.len(), 200, |part| {
        let grown = part.filter(|i| fed.as_ref().is_none_or(|fed| fed[*i] == 0));
        let roots = grown.filter_map(|i| hair.curve(i).first());
        roots.filter_map(|p| Some(surface.closest(*p)?.distance)).collect::<Vec<f32>>()
    });
    let mut distances = parts.concat();
    distances.sort_by(f32::total_cmp);
    Roots { distance_cm: [0.5, 1.0].map(|q| quantile(&distances, q)) }
}
