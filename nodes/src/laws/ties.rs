//! Whether hair passes through the tie that holds it: its smallest distance from the centre of the tie's ring, relative to the
//! radius, and its length beyond.
//!
//! A hair is held by a tie if it carries the centre and radius of one. It passes if its distance is at most the radius plus 0.2
//! cm, which is within the band.

use super::hair::{AttributeValues, MeasuredHair, quantile};
use crate::maths::nearest_on;
use glam::Vec3;
use std::collections::BTreeSet;

/// Hair held by ties.
#[derive(Clone, Debug, PartialEq)]
pub struct Ties {
    /// Number of rings with different centres.
    pub ties: usize,
    /// Number of hairs held by one.
    pub hairs: usize,
    /// Number of those that do not pass through it.
    pub beside: usize,
    /// Smallest distance of a hair from the centre of its ring, in radii: median and largest over hairs.
    pub off: [f32; 2],
    /// Length of hair beyond its tie, cm: 5th percentile, median, largest.
    pub behind_cm: [f32; 3],
}

/// Tolerance of the radius, cm: the thickness of a band. A tail may begin slightly thicker than its tie, and its hair bends
/// smoothly through it, within a millimetre.
const LOOSE: f32 = 0.2;

/// How hair passes its ties; `None` without ties.
pub fn measure(hair: &MeasuredHair) -> Option<Ties> {
    let ties = TieAttributes::of(hair)?;
    let held: Vec<usize> = (0..hair.len()).filter(|i| ties.tie(hair, *i).is_some()).collect();
    if held.is_empty() {
        return None;
    }
    let found = hair
        .in_parts(held.len(), 500, |part| {
            let hair = |k: usize| {
                let (middle, radius) = ties.tie(hair, held[k])?;
                let (far, behind) = passes(hair.curve(held[k]), middle);
                Some((middle.to_array().map(f32::to_bits), far, radius, behind))
            };
            part.filter_map(hair).collect::<Vec<_>>()
        })
        .concat();
    let sorted = |of: &dyn Fn(f32, f32, f32) -> f32| {
        let mut all: Vec<f32> = found.iter().map(|(_, far, r, past)| of(*far, *r, *past)).collect();
        all.sort_by(f32::total_cmp);
        all
    };
    let (off, behind) = (sorted(&|far, r, _| far / r), sorted(&|_, _, past| past));
    Some(Ties {
        ties: found.iter().map(|(middle, ..)| *middle).collect::<BTreeSet<_>>().len(),
        hairs: held.len(),
        beside: found.iter().filter(|(_, far, r, _)| far.is_nan() || *far > r + LOOSE).count(),
        off: [0.5, 1.0].map(|q| quantile(&off, q)),
        behind_cm: [0.05, 0.5, 1.0].map(|q| quantile(&behind, q)),
    })
}

/// Centre and radius of ties, as hairs carry them.
pub(super) struct TieAttributes<'a>(AttributeValues<'a, Vec3>, AttributeValues<'a, f32>);

impl<'a> TieAttributes<'a> {
    pub(super) fn of(hair: &'a MeasuredHair) -> Option<Self> {
        Some(Self(hair.vectors("tie")?, hair.numbers("tie_radius")?))
    }
    /// Centre and radius of a hair's tie.
    fn tie(&self, hair: &MeasuredHair, i: usize) -> Option<(Vec3, f32)> {
        if hair.curve(i).is_empty() {
            return None;
        }
        let first = hair.range(i).start;
        let radius = self.1.at(i, first);
        // A radius that is not finite counts as none: every hair would pass.
        (radius > 0.0 && radius < 1e6).then(|| (self.0.at(i, first), radius))
    }
    /// Length of a hair up to its tie.
    pub(super) fn until(&self, hair: &MeasuredHair, i: usize) -> Option<f32> {
        let (middle, radius) = self.tie(hair, i)?;
        let points = hair.curve(i);
        let (far, behind) = passes(points, middle);
        let whole: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        (far <= radius + LOOSE).then_some(whole - behind)
    }
}

/// Smallest distance of a polyline from a point, and its length beyond the closest place.
fn passes(points: &[Vec3], place: Vec3) -> (f32, f32) {
    let last = points.last().map_or(f32::NAN, |p| p.distance(place));
    let (mut nearest, mut at, mut walked) = (last, f32::MAX, 0.0);
    for w in points.windows(2) {
        let way = w[1] - w[0];
        let (on, t) = nearest_on([w[0], w[1]], place);
        let far = place.distance(on);
        let length = way.length();
        if far < nearest {
            (nearest, at) = (far, walked + t * length);
        }
        walked += length;
    }
    (nearest, (walked - at.min(walked)).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::super::hair::tests::read_of;
    use super::*;
    use crate::eval::PlainHost;
    use crate::formats::usd::read::ReadValues;

    #[test]
    fn hair_beside_its_tie_is_counted_and_what_hangs_behind_is_as_long_as_it_is() {
        // Four hairs come from the left and hang down at x = 0, 0.9, 1.5 and nowhere near; the ring is 8 cm below the bend.
        let hair = |x: f32| [Vec3::X * -9.0, Vec3::X * x, Vec3::new(x, -20.0, 0.0)];
        let hairs = [hair(0.0), hair(0.9), hair(1.5), hair(-7.0)];
        let curves: Vec<&[Vec3]> = hairs.iter().map(|hair| &hair[..]).collect();
        let told = |radii: Vec<f32>, middle: Vec3| {
            let primvars = [
                ("tie", ReadValues::Float3(vec![middle])),
                ("tie_radius", ReadValues::Float(radii)),
            ];
            measure(&MeasuredHair::read(&read_of(&curves, &primvars), &PlainHost))
        };
        let all = told(vec![1.0], Vec3::Y * -8.0).unwrap();
        assert_eq!((all.ties, all.hairs, all.beside), (1, 4, 2));
        assert!((all.off[1] - 7.0).abs() < 1e-3, "{:?}", all.off);
        assert!((all.behind_cm[2] - 12.0).abs() < 1e-3, "{:?}", all.behind_cm);
        // Hair that no tie holds is not judged.
        let some = told(vec![1.0, 1.0, 0.0, 0.0], Vec3::Y * -8.0).unwrap();
        assert_eq!((some.hairs, some.beside), (2, 0));
        assert!((some.behind_cm[1] - 12.0).abs() < 1e-3, "{:?}", some.behind_cm);
        for none in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e30] {
            assert!(told(vec![none], Vec3::ZERO).is_none(), "{none}");
        }
    }

    #[test]
    fn a_curve_without_points_passes_no_tie() {
        // Told point by point, so that the last curve has no value of its own.
        let hair = [Vec3::X * -9.0, Vec3::ZERO, Vec3::Y * -20.0];
        let read = read_of(
            &[&hair, &[]],
            &[
                ("tie", ReadValues::Float3(vec![Vec3::Y * -8.0; 3])),
                ("tie_radius", ReadValues::Float(vec![1.0; 3])),
            ],
        );
        let hair = MeasuredHair::read(&read, &PlainHost);
        assert_eq!(measure(&hair).map(|ties| ties.hairs), Some(1));
        let held = TieAttributes::of(&hair).unwrap();
        assert!(held.until(&hair, 0).is_some() && held.until(&hair, 1).is_none());
    }
}
