//! Points on curves of a file whose own points are not on them: B-splines, Beziers, closed curves, and Catmull-Rom curves whose
//! first and last points only bend them.
//!
//! Guarantees: straight lines between neighbouring points are nowhere farther than [`NEAR`] from the curve, unless a span bends so
//! much that [`MOST_PIECES`] are not enough, or the points of all curves would be more than [`MOST`], or of one more than
//! [`MOST_OF_A_CURVE`]. Between two points the curve
//! itself is known, exactly. A curve of which there is none, for its count of points or numbers beyond all bounds, has no points.

use super::hair::in_parts;
use crate::eval::Host;
use crate::formats::usd::form::{Form, Lerp, value};
use glam::Vec3;
use std::ops::Range;

/// Largest distance of straight segments from the curve, cm.
const NEAR: f32 = 1e-3;
/// Largest number of segments per span.
const MOST_PIECES: usize = 32;
/// Largest number of points per curve, unless it has more spans.
const MOST_OF_A_CURVE: usize = 65_536;
/// Largest number of points of all curves, unless spans have one segment each.
const MOST: usize = 16_000_000;

/// Position of a point: the span of its curve, and the fraction along it, 0 to 1. Only the last point of a curve is at 1.
#[derive(Clone, Copy)]
struct Place {
    span: u32,
    t: f32,
}

/// Points on all curves, curve by curve.
pub(super) struct EvaluatedCurves {
    form: Form,
    offsets: Vec<usize>,
    pub(super) points: Vec<Vec3>,
    places: Vec<Place>,
    /// Start of the `varying` values of each curve.
    varying: Vec<usize>,
}

impl EvaluatedCurves {
    /// Evaluates curves with CVs at these offsets; `None` if the CVs of the file lie on the curve and describe it fully.
    pub(super) fn of(
        form: Form,
        points: &[Vec3],
        offsets: &[usize],
        host: &dyn Host,
    ) -> Option<Self> {
        if form.passes_its_points() {
            return None;
        }
        let n = offsets.len() - 1;
        let own = |i: usize| &points[offsets[i]..offsets[i + 1]];
        let spans = |i: usize| form.spans(own(i).len()).unwrap_or(0);
        let pieces_of = |i: usize, near: f32| -> usize {
            (0..spans(i)).map(|k| pieces(form.span(own(i), k), near, spans(i))).sum()
        };
        let mut near = NEAR;
        let all = |near: f32| -> usize { (0..n).map(|i| pieces_of(i, near)).sum() };
        while near < 1e3 * NEAR && all(near) > MOST {
            near *= 4.0;
        }
        let parts = in_parts(host, n, 500, |part| {
            let (mut counts, mut at, mut places) = (vec![], vec![], vec![]);
            for i in part {
                let first = places.len();
                let cvs = own(i);
                for k in 0..spans(i) {
                    let span = form.span(cvs, k);
                    let n = pieces(span, near, spans(i));
                    for piece in 0..n {
                        let t = piece as f32 / n as f32;
                        places.push(Place { span: k as u32, t });
                        at.push(value(span, t));
                    }
                    if k + 1 == spans(i) {
                        places.push(Place { span: k as u32, t: 1.0 });
                        at.push(value(span, 1.0));
                    }
                }
                if at[first..].iter().any(|p: &Vec3| !p.is_finite()) {
                    at.truncate(first);
                    places.truncate(first);
                }
                counts.push(places.len() - first);
            }
            (counts, at, places)
        });
        let mut out =
            Self { form, offsets: vec![0], points: vec![], places: vec![], varying: vec![0] };
        for (counts, at, places) in parts {
            for count in counts {
                out.offsets.push(out.offsets[out.offsets.len() - 1] + count);
            }
            out.points.extend(at);
            out.places.extend(places);
        }
        for i in 0..n {
            out.varying.push(out.varying[i] + form.varying(own(i).len()));
        }
        Some(out)
    }

    /// Range of the points of curve `i` among all.
    pub(super) fn range(&self, i: usize) -> Range<usize> {
        self.offsets[i]..self.offsets[i + 1]
    }

    /// The curve between its points, as polynomials, given its control points in the file.
    pub(super) fn between<'d>(
        &'d self,
        curve: usize,
        cvs: &'d [Vec3],
    ) -> impl Iterator<Item = [Vec3; 4]> + 'd {
        self.places[self.range(curve)].windows(2).map(move |w| {
            let end = if w[1].span == w[0].span { w[1].t } else { 1.0 };
            part(self.form.span(cvs, w[0].span as usize), w[0].t, end)
        })
    }

    /// For each segment, the span of its curve.
    pub(super) fn spans(&self, curve: usize) -> impl Iterator<Item = u32> + '_ {
        let places = &self.places[self.range(curve)];
        places[..places.len().saturating_sub(1)].iter().map(|place| place.span)
    }

    /// `vertex` values at a point, given those of its curve.
    pub(super) fn vertex<T: Lerp>(&self, of_curve: &[T], point: usize) -> T {
        let Place { span, t } = self.places[point];
        value(self.form.span(of_curve, span as usize), t)
    }

    /// `varying` values at a point of curve `curve`.
    pub(super) fn varying<T: Lerp>(&self, values: &[T], curve: usize, point: usize) -> T {
        let Place { span, t } = self.places[point];
        let of_curve = &values[self.varying[curve]..self.varying[curve + 1]];
        let [a, b] = self.form.ends(of_curve, span as usize);
        a + (b - a) * t
    }
}

/// Number of segments for each span of a curve, so that they are within `near` of it.
fn pieces([_, _, c2, c3]: [Vec3; 4], near: f32, spans: usize) -> usize {
    let most = (MOST_OF_A_CURVE / spans).clamp(1, MOST_PIECES);
    // A chord over 1/n of the span deviates by an eighth of the second derivative over n², which is largest at an end.
    let bend = (c2 * 2.0).length().max((c2 * 2.0 + c3 * 6.0).length());
    ((bend / (8.0 * near)).sqrt().ceil() as usize).clamp(1, most)
}

/// The part of a polynomial from `t0` to `t1`, reparametrised to 0 to 1.
fn part(span: [Vec3; 4], t0: f32, t1: f32) -> [Vec3; 4] {
    let [_, c1, c2, c3] = span;
    let d = t1 - t0;
    let slope = (c3 * (3.0 * t0) + c2 * 2.0) * t0 + c1;
    [value(span, t0), slope * d, (c3 * (3.0 * t0) + c2) * (d * d), c3 * (d * d * d)]
}
