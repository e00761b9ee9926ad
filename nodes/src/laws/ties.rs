//! Whether hair passes the tie that holds it: how near its way comes to the middle of the ring in which the tie lets it go, against
//! the ring's radius, and how far it goes on behind.
//!
//! A hair is held by a tie where the middle and the radius of one are told for it. It passes where its way comes as near as the
//! radius, and 0.2 cm more: within the band.

use super::hair::{AttributeValues, MeasuredHair, quantile};
use crate::maths::nearest_on;
use glam::Vec3;
use std::collections::BTreeSet;

/// Hair that ties hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Ties {
    /// Rings of different middles.
    pub ties: usize,
    /// Hairs that are held by one.
    pub hairs: usize,
    /// Those of them that do not pass it.
    pub beside: usize,
    /// Nearest distance of a hair from the middle of its ring, in radii: of the middle hair, and of the one farthest off.
    pub off: [f32; 2],
    /// Length of hair behind its tie, cm: of 5 % of the hairs at most, the middle, the longest.
    pub behind_cm: [f32; 3],
}

/// How much farther from the middle than its radius a hair may pass, cm: as thick as a band is. A tail may begin a little thicker
/// than its tie, and its hair goes smoothly through the bend there, to less than a millimetre.
const LOOSE: f32 = 0.2;

/// How hair passes its ties; none where no tie holds any.
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

/// The ties that hold hairs.
pub(super) struct TieAttributes<'a>(AttributeValues<'a, Vec3>, AttributeValues<'a, f32>);

impl<'a> TieAttributes<'a> {
    pub(super) fn of(hair: &'a MeasuredHair) -> Option<Self> {
        Some(Self(hair.vectors("tie")?, hair.numbers("tie_radius")?))
    }
    /// Middle and radius of the tie of a hair.
    fn tie(&self, hair: &MeasuredHair, i: usize) -> Option<(Vec3, f32)> {
        if hair.curve(i).is_empty() {
            return None;
        }
        let first = hair.range(i).start;
        let radius = self.1.at(i, first);
        // A radius that is no number, or boundless, is none: every hair would pass.
        (radius > 0.0 && radius < 1e6).then(|| (self.0.at(i, first), radius))
    }
    /// How long a hair is up to the tie that it passes.
    pub(super) fn until(&self, hair: &MeasuredHair, i: usize) -> Option<f32> {
        let (middle, radius) = self.tie(hair, i)?;
        let points = hair.curve(i);
        let (far, behind) = passes(points, middle);
        let whole: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        (far <= radius + LOOSE).then_some(whole - behind)
    }
}

/// How near the straight way through the points comes to a place, and how long it is from there on.
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
