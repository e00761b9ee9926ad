//! Resample: the same curves with other CVs.

use crate::data::attribute_transfer::carry;
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::define::{NodeError, choice, node, unless};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::spline::Spline;

node! {
    /// Gives curves another number of CVs, evenly spaced along their length.
    ///
    /// The new curve follows the old one; roots and tips stay exactly in place. CV attributes are interpolated, curve
    /// attributes kept.
    "resample", version 1, label "Resample", words "points cvs segments subdivide resolution rebuild smooth simplify";
    inputs {
        /// Curves to resample.
        curves: Curves;
        /// Set the number of CVs, or their spacing.
        by: By = By::Count;
        /// CVs per curve, root and tip included, when by count.
        count: i64 = 16, hard(2.0, 4096.0), soft(4.0, 64.0), unit(Count),
            idle(|of| unless(of, "by", "count", "points go by their spacing"));
        /// Distance between CVs, when by spacing. Each curve gets the count that comes closest.
        spacing: f32 = 0.5, hard(0.001, 1000.0), soft(0.05, 2.0), unit(Length),
            idle(|of| unless(of, "by", "spacing", "points are counted"));
    }
    outputs {
        /// The resampled curves.
        curves: Curves;
    }
}

choice! {
    /// What sets the number of CVs.
    By {
        /// The same number for every curve.
        Count = "count",
        /// The same spacing for every curve.
        Spacing = "spacing",
    }
}

/// The most CVs per curve when resampling by spacing.
const MOST: f32 = 4096.0;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let curves = inputs.curves.curve_count() as f64;
    cx.may_make(&match inputs.by {
        By::Count => Size::of(&[("curves", curves), ("count", inputs.count as f64)]),
        By::Spacing => {
            let of = |(tuft, i): (&Tuft, usize)| {
                let chords = tuft.curve(i).windows(2).map(|w| w[0].distance(w[1]));
                f64::from((chords.sum::<f32>() / inputs.spacing).min(MOST))
            };
            Size::of(&[("steps of spacing on all curves", inputs.curves.each().map(of).sum())])
        }
    })?;
    let [curves] = cx.each_tuft(&inputs.curves, |tuft, piece| {
        let count = |length: f32| match inputs.by {
            By::Count => inputs.count as usize,
            By::Spacing => (length / inputs.spacing).round().clamp(1.0, MOST - 1.0) as usize + 1,
        };
        Ok([resample(tuft, count, piece)?])
    })?;
    Ok(Outputs { curves })
}

/// Every curve of `tuft` with `count(length)` points, evenly spaced by arc length. Curves without length are dropped
/// and reported.
pub(crate) fn resample(
    tuft: &Tuft,
    count: impl Fn(f32) -> usize,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let mut out = TuftBuilder::new();
    let mut spline = Spline::default();
    let mut kept = vec![];
    // For each new point: the old point before it and the fraction toward the next.
    let mut places: Vec<(u32, f32)> = vec![];
    let mut points = vec![];
    for i in 0..tuft.len() {
        piece.tick()?;
        if let Err(fault) = spline.rebuild(tuft.curve(i)) {
            piece.trouble(tuft.id(i), fault);
            continue;
        }
        kept.push(i as u32);
        let (n, first) = (count(spline.length()), tuft.offsets()[i]);
        points.clear();
        for k in 0..n {
            let place = spline.locate(k as f32 / (n - 1) as f32);
            points.push(spline.point(place));
            places.push((first + place.span as u32, place.t));
        }
        points[0] = tuft.curve(i)[0];
        points[n - 1] = *tuft.curve(i).last().unwrap_or(&points[0]);
        out.push_curve(&points);
    }
    carry(tuft, &kept, &places, &mut out);
    Ok(out.build())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID, ROLL};
    use crate::define::Value;
    use crate::testing::{curves_of, run};
    use glam::Vec3;

    fn source() -> Curves {
        let arc = |k: i32| Vec3::new(k as f32, (k * k) as f32 * 0.1, 0.0);
        let mut b = TuftBuilder::new();
        b.push_curve(&[0, 1, 2, 3, 4].map(arc));
        b.push_curve(&[Vec3::ONE; 3]);
        b.set(ID, Domain::Curve, vec![5, 6]);
        b.set(ROLL, Domain::Point, vec![0.0, 10.0, 20.0, 30.0, 40.0, 0.0, 0.0, 0.0]);
        Curves::new(vec![b.build().into()])
    }

    #[test]
    fn keeps_roots_tips_and_length_and_leaves_out_what_has_none() {
        let (out, said) = run(&NODE, &[("curves", source().into()), ("count", Value::Int(9))]);
        let curves = curves_of(&out[0]);
        assert_eq!((curves.curve_count(), curves.point_count()), (1, 9));
        let tuft = &curves.tufts()[0];
        assert_eq!(tuft.curve(0)[0], Vec3::ZERO);
        assert_eq!(tuft.curve(0)[8], Vec3::new(4.0, 1.6, 0.0));
        let before = Spline::new(source().tufts()[0].curve(0)).unwrap().length();
        let after = Spline::new(tuft.curve(0)).unwrap().length();
        assert!((before - after).abs() < 2e-3, "{before} {after}");
        assert_eq!(tuft.id(0), 5);
        assert_eq!(tuft.view(ROLL).at(0, 8), 40.0);
        assert_eq!(said, ["a curve without length was left out (curve 0000000000000006)"]);
    }

    #[test]
    fn spacing_decides_the_number() {
        let by = [("by", "spacing".into()), ("spacing", Value::Float(1.0))];
        let (out, _) = run(&NODE, &[&[("curves", source().into())], &by[..]].concat());
        assert_eq!(curves_of(&out[0]).point_count(), 5);
    }

    #[test]
    fn a_value_out_of_range_is_clamped_and_said() {
        let (out, said) = run(&NODE, &[("curves", source().into()), ("count", Value::Int(1))]);
        assert_eq!(curves_of(&out[0]).point_count(), 2);
        assert!(
            said.contains(&"count 1 is outside 2 to 4096 and was clamped".to_owned()),
            "{said:?}"
        );
    }
}
