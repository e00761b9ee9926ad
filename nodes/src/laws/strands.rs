//! Every curve: its points, length, thickness and evenness, and whether others read it as coif does.

use super::hair::{MeasuredHair, quantile};
use crate::data::curves::MOST_A_CURVE;
use crate::formats::usd::form::Basis;
use crate::maths::catmull_rom_agreement::AGREE;
use crate::maths::drawn_span;
use crate::maths::spline::{CurveFault, Spline};

/// The most points of all hair of a groom.
pub const MOST_POINTS: usize = 16_000_000;

/// Figures of all curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Strands {
    /// How many.
    pub curves: usize,
    /// Control points of all.
    pub points: usize,
    /// Fewest and most control points of a curve.
    pub points_a_curve: [usize; 2],
    /// Smallest, middle and largest arc length, cm, of all curves that can be drawn; 0 of those without length.
    pub length_cm: [f32; 3],
    /// Smallest and largest diameter, cm.
    pub width_cm: Option<[f32; 2]>,
    /// Lowest and highest corner of the box about all curves as they are drawn, cm.
    pub bounds: Option<[[f32; 3]; 2]>,
    /// Curves without length, or of a number of points that makes none.
    pub no_curve: usize,
    /// Curves without length: all their points are at one place.
    pub zero_length: usize,
    /// Largest ratio of two neighbouring segments' lengths.
    pub spacing_ratio: f32,
    /// Largest distance, cm, between the uniform and the centripetal reading of a curve; none where it is no Catmull-Rom spline.
    pub reading_difference_cm: Option<f32>,
}

impl Strands {
    /// Whether each has two points and a length.
    pub fn are_curves(&self) -> bool {
        self.no_curve == 0
    }
    /// Curves of a number of points that makes none.
    pub fn undrawn(&self) -> usize {
        self.no_curve - self.zero_length
    }
    /// Whether none has more points than engines take.
    pub fn are_short_enough(&self) -> bool {
        self.points_a_curve[1] <= MOST_A_CURVE
    }
    /// Whether all tools read them alike; none where there are no two readings.
    pub fn read_alike(&self) -> Option<bool> {
        Some(self.reading_difference_cm? <= AGREE)
    }
}

/// Looks at every curve.
pub fn measure(hair: &MeasuredHair) -> Strands {
    let shapes = Shapes::of(hair);
    let own = |i: usize| match hair.is_of_coifs_form() {
        true => drawn_span::bounds(hair.curve(i)),
        false => {
            let all = hair.curve(i).iter().map(|p| (*p, *p));
            all.reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p)))
        }
    };
    let all = (0..hair.len()).filter_map(own);
    let corners = all.reduce(|(lo, hi), (low, high)| (lo.min(low), hi.max(high)));
    let counts = || (0..hair.len()).map(|i| hair.cv_count(i));
    let lengths = &shapes.lengths;
    let zero_length = lengths.iter().filter(|length| **length == 0.0).count();
    Strands {
        curves: hair.len(),
        points: hair.cvs(),
        points_a_curve: [counts().min(), counts().max()].map(Option::unwrap_or_default),
        length_cm: [0.0, 0.5, 1.0].map(|q| quantile(lengths, q)),
        width_cm: hair.widths(),
        bounds: corners.map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
        no_curve: hair.len() - lengths.len() + zero_length,
        zero_length,
        spacing_ratio: shapes.spacing,
        reading_difference_cm: (hair.form().basis == Basis::CatmullRom)
            .then_some(shapes.difference),
    }
}

/// Figures of every curve, joined over parts.
struct Shapes {
    /// From the shortest on.
    lengths: Vec<f32>,
    spacing: f32,
    difference: f32,
}

impl Shapes {
    fn of(hair: &MeasuredHair) -> Self {
        let parts = hair.in_parts(hair.len(), 500, |part| {
            let mut out = Self { lengths: vec![], spacing: 1.0, difference: 0.0 };
            let mut spline = Spline::default();
            for i in part {
                match hair.spline(i, &mut spline) {
                    Ok(()) => out.lengths.push(spline.length()),
                    Err(CurveFault::NoLength) => {
                        out.lengths.push(0.0);
                        continue;
                    }
                    Err(_) => continue,
                }
                out.difference = out.difference.max(hair.readings_differ(i));
                let mut before = None;
                hair.each_part(i, &spline, |b| {
                    let a = before.replace(b).unwrap_or(b);
                    out.spacing = out.spacing.max(a.max(b) / a.min(b).max(1e-9));
                });
            }
            out
        });
        let mut all = Self { lengths: vec![], spacing: 1.0, difference: 0.0 };
        for part in parts {
            all.lengths.extend(part.lengths);
            all.spacing = all.spacing.max(part.spacing);
            all.difference = all.difference.max(part.difference);
        }
        all.lengths.sort_by(f32::total_cmp);
        all
    }
}
