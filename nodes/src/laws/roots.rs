//! Roots: on the skin, and where they are told to be.

use super::hair::{MeasuredHair, quantile};
use crate::data::attributes::{ROOT_BARY, ROOT_TRIANGLE};
use crate::data::curves::Curves;
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
pub fn measure(hair: &MeasuredHair, scalp: &Scalp) -> Roots {
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

/// How far the first point of a curve is at most from the place on the skin that the curve tells for its root, cm. Infinite where
/// one tells none.
pub fn off_their_places(curves: &Curves, scalp: &Scalp) -> f32 {
    let off = curves.each().map(|(tuft, i)| {
        let first = tuft.range(i).start;
        let triangle = u32::try_from(tuft.view(ROOT_TRIANGLE).at(i, first));
        let known = triangle.ok().filter(|t| (*t as usize) < scalp.surface().triangles.len());
        known.zip(tuft.curve(i).first()).map_or(f32::INFINITY, |(triangle, root)| {
            scalp.surface().at(triangle, tuft.view(ROOT_BARY).at(i, first)).distance(*root)
        })
    });
    off.fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::Domain;
    use crate::data::curves::TuftBuilder;
    use crate::data::scalp::tests::shared_ball;
    use crate::eval::PlainHost;
    use glam::Vec3;
    use std::sync::Arc;

    #[test]
    fn roots_off_the_skin_and_off_their_places_are_found() {
        let scalp = shared_ball();
        let root = scalp.closest_root(Vec3::Y * 20.0).unwrap();
        let check = |lift: f32, triangle: i32, on: bool, off: f32| {
            let mut b = TuftBuilder::new();
            let foot = root.point + root.normal * lift;
            b.push_curve(&[foot, foot + root.normal]);
            b.set(ROOT_TRIANGLE, Domain::Curve, vec![triangle]);
            b.set(ROOT_BARY, Domain::Curve, vec![root.bary]);
            let curves = Curves::new(vec![Arc::new(b.build())]);
            let found = measure(&MeasuredHair::of(&curves, &PlainHost), &scalp);
            assert_eq!(found.are_on_the_skin(), on, "{lift}: {found:?}");
            let told = off_their_places(&curves, &scalp);
            assert!(told == off || (told - off).abs() < 1e-4, "{lift} {triangle}: {told}");
        };
        let own = root.triangle as i32;
        check(0.0, own, true, 0.0);
        check(0.5, own, false, 0.5);
        check(0.0, -1, true, f32::INFINITY);
        check(0.0, i32::MAX, true, f32::INFINITY);
    }
}
