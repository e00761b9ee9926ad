//! The curve that type, basis and wrap of BasisCurves make of control points, as the documentation of UsdGeomBasisCurves states it.
//!
//! A curve is a chain of spans, each a polynomial over [0, 1] of the two (linear) or four (cubic) values that control it. Values of
//! `vertex` primvars are blended as points are, those of `varying` ones lie at the ends of spans and run straight between them.
//!
//! Guarantees: every span is exact but for rounding; counts that the documentation does not allow make no curve. Not promised:
//! anything of `hermite` and `power`, which USD has withdrawn.

use glam::Vec3;
use std::fmt;
use std::ops::{Add, Mul, Sub};

/// How the points of a span are blended: `type` and `basis` in one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Straight from point to point.
    Linear,
    /// Every third point lies on the curve.
    Bezier,
    /// No point lies on the curve.
    Bspline,
    /// All points lie on the curve, but for the first and last where it is not pinned.
    CatmullRom,
}

/// What happens at the ends of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The first and last points of B-splines and Catmull-Rom curves only bend them.
    Nonperiodic,
    /// The curve is closed: its first points come again after the last.
    Periodic,
    /// B-splines and Catmull-Rom curves go from the first point to the last, as if another lay straight beyond each.
    Pinned,
}

/// Type, basis and wrap of the curves of a prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// How points are blended.
    pub basis: Basis,
    /// What happens at the ends.
    pub wrap: Wrap,
}

/// The largest number of a position that is read, cm: what lies farther off has no length in `f32`, whose squares end at 1e38.
pub const FARTHEST: f32 = 1e15;

/// Whether a point can be measured. No number is none.
pub fn is_position(point: Vec3) -> bool {
    point.abs().cmple(Vec3::splat(FARTHEST)).all()
}

/// Values that can be blended.
pub trait Lerp: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self> {}
impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>> Lerp for T {}

impl Form {
    /// What coif writes: cubic, Catmull-Rom, pinned.
    pub const COIF: Self = Self { basis: Basis::CatmullRom, wrap: Wrap::Pinned };

    /// From the tokens of a prim. The basis of linear curves counts nothing.
    ///
    /// # Errors
    /// The attribute whose token is none of those that USD knows, and which these are.
    pub fn of(curve_type: &str, basis: &str, wrap: &str) -> Result<Self, (&'static str, String)> {
        let none_of = |name, found: &str, known: &str| {
            Err((name, format!("{found:?} is none of {known}: curves of it cannot be told")))
        };
        let basis = match (curve_type, basis) {
            ("linear", _) => Basis::Linear,
            ("cubic", "bezier") => Basis::Bezier,
            ("cubic", "bspline") => Basis::Bspline,
            ("cubic", "catmullRom") => Basis::CatmullRom,
            ("cubic", basis) => return none_of("basis", basis, "bezier, bspline, catmullRom"),
            (curve_type, _) => return none_of("type", curve_type, "linear, cubic"),
        };
        let wrap = match wrap {
            "nonperiodic" => Wrap::Nonperiodic,
            "periodic" => Wrap::Periodic,
            "pinned" => Wrap::Pinned,
            wrap => return none_of("wrap", wrap, "nonperiodic, periodic, pinned"),
        };
        Ok(Self { basis, wrap })
    }

    /// Whether a curve is closed.
    pub fn is_closed(self) -> bool {
        self.wrap == Wrap::Periodic
    }

    /// Whether the points are on the curve and it goes from the first to the last.
    pub fn passes_its_points(self) -> bool {
        self == Self::COIF || (self.basis == Basis::Linear && !self.is_closed())
    }

    /// Number of spans of a curve of so many points; none where there can be no such curve.
    pub fn spans(self, points: usize) -> Option<usize> {
        use Basis::{Bezier, Bspline, CatmullRom, Linear};
        use Wrap::{Nonperiodic, Periodic, Pinned};
        match (self.basis, self.wrap) {
            (Linear, Periodic) => (points > 2).then_some(points),
            (Linear, _) | (Bspline | CatmullRom, Pinned) => (points > 1).then(|| points - 1),
            (Bezier, Periodic) => (points > 2 && points.is_multiple_of(3)).then_some(points / 3),
            (Bezier, _) => (points > 3 && points % 3 == 1).then_some(points / 3),
            (_, Periodic) => (points > 2).then_some(points),
            (_, Nonperiodic) => (points > 3).then(|| points - 3),
        }
    }

    /// Which counts of points make a curve, in words.
    pub fn counts(self) -> &'static str {
        use Basis::{Bezier, Linear};
        match (self.basis, self.wrap) {
            (Bezier, Wrap::Periodic) => "3, 6, 9 and so on",
            (_, Wrap::Periodic) => "3 or more",
            (Bezier, _) => "4, 7, 10 and so on",
            (Linear, _) | (_, Wrap::Pinned) => "2 or more",
            _ => "4 or more",
        }
    }

    /// Number of `varying` values of a curve of so many points: one for each end of a span.
    pub fn varying(self, points: usize) -> usize {
        self.spans(points).map_or(0, |spans| spans + usize::from(!self.is_closed()))
    }

    /// The values that control the span `span` of a curve with these values at its points; of linear ones the first two count.
    pub fn control<T: Lerp>(self, values: &[T], span: usize) -> [T; 4] {
        let n = values.len();
        let at = |k: usize| values[k % n];
        let beyond = |end: T, before: T| end + end - before;
        match (self.basis, self.wrap) {
            (Basis::Linear, _) => [at(span), at(span + 1), at(span), at(span + 1)],
            (Basis::Bezier, _) => [0, 1, 2, 3].map(|k| at(3 * span + k)),
            (_, Wrap::Pinned) => [
                if span > 0 { at(span - 1) } else { beyond(at(0), at(1)) },
                at(span),
                at(span + 1),
                if span + 2 < n { at(span + 2) } else { beyond(at(n - 1), at(n - 2)) },
            ],
            _ => [0, 1, 2, 3].map(|k| at(span + k)),
        }
    }

    /// The span `span` as a polynomial: `((c3 t + c2) t + c1) t + c0` for t from 0 to 1.
    pub fn span<T: Lerp>(self, values: &[T], span: usize) -> [T; 4] {
        let [a, b, c, d] = self.control(values, span);
        let bent = d - a + (b - c) * 3.0;
        match self.basis {
            Basis::Linear => [a, b - a, a * 0.0, a * 0.0],
            Basis::Bezier => [a, (b - a) * 3.0, (a - b - b + c) * 3.0, bent],
            Basis::Bspline => {
                let sixth = 1.0 / 6.0;
                [(a + b * 4.0 + c) * sixth, (c - a) * 0.5, (a - b - b + c) * 0.5, bent * sixth]
            }
            Basis::CatmullRom => {
                [b, (c - a) * 0.5, (a * 2.0 - b * 5.0 + c * 4.0 - d) * 0.5, bent * 0.5]
            }
        }
    }

    /// The `varying` values at the ends of the span `span`, of those of its curve.
    pub fn ends<T: Copy>(self, values: &[T], span: usize) -> [T; 2] {
        [values[span], values[(span + 1) % values.len()]]
    }
}

impl fmt::Display for Form {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let basis = match self.basis {
            Basis::Linear => "linear",
            Basis::Bezier => "cubic bezier",
            Basis::Bspline => "cubic bspline",
            Basis::CatmullRom => "cubic catmullRom",
        };
        let wrap = match self.wrap {
            Wrap::Nonperiodic => "nonperiodic",
            Wrap::Periodic => "periodic",
            Wrap::Pinned => "pinned",
        };
        write!(out, "{basis} {wrap}")
    }
}

/// A polynomial's value.
pub fn value<T: Lerp>([c0, c1, c2, c3]: [T; 4], t: f32) -> T {
    ((c3 * t + c2) * t + c1) * t + c0
}

#[cfg(test)]
mod tests {
    use super::*;
    use Basis::{Bezier, Bspline, CatmullRom, Linear};
    use Wrap::{Nonperiodic, Periodic, Pinned};

    const ALL: [Form; 12] = {
        let (b, w) = ([Linear, Bezier, Bspline, CatmullRom], [Nonperiodic, Periodic, Pinned]);
        let mut all = [Form::COIF; 12];
        let mut i = 0;
        while i < 12 {
            all[i] = Form { basis: b[i / 3], wrap: w[i % 3] };
            i += 1;
        }
        all
    };

    #[test]
    fn counts_of_spans_and_varying_values_are_those_of_the_documentation() {
        // The table of examples in the documentation of UsdGeomBasisCurves, and its rule for pinned curves.
        let check = |basis, wrap, counts: &[usize], spans: &[usize], varying: &[usize]| {
            let form = Form { basis, wrap };
            let found: Vec<_> = counts.iter().map(|n| form.spans(*n).unwrap()).collect();
            assert_eq!(found, spans, "{form}");
            let found: Vec<_> = counts.iter().map(|n| form.varying(*n)).collect();
            assert_eq!(found, varying, "{form}");
        };
        check(Linear, Nonperiodic, &[2, 3, 2, 5], &[1, 2, 1, 4], &[2, 3, 2, 5]);
        check(Bezier, Nonperiodic, &[4, 7, 10, 4, 7], &[1, 2, 3, 1, 2], &[2, 3, 4, 2, 3]);
        check(Bspline, Nonperiodic, &[5, 4, 6, 7], &[2, 1, 3, 4], &[3, 2, 4, 5]);
        check(Bezier, Periodic, &[6, 9, 6], &[2, 3, 2], &[2, 3, 2]);
        check(Linear, Periodic, &[3, 7], &[3, 7], &[3, 7]);
        check(CatmullRom, Pinned, &[2, 3, 9], &[1, 2, 8], &[2, 3, 9]);
        let refused = |basis, wrap, counts: &[usize]| {
            let form = Form { basis, wrap };
            assert!(counts.iter().all(|n| form.spans(*n).is_none()), "{form}");
        };
        refused(Linear, Nonperiodic, &[0, 1]);
        refused(Linear, Periodic, &[0, 1, 2]);
        refused(Bezier, Nonperiodic, &[0, 1, 2, 3, 5, 6, 8]);
        refused(Bezier, Periodic, &[0, 1, 2, 4, 5, 7]);
        refused(Bspline, Nonperiodic, &[0, 1, 2, 3]);
        refused(CatmullRom, Periodic, &[0]);
        refused(Bspline, Pinned, &[0, 1]);
    }

    #[test]
    fn spans_join_and_closed_curves_close() {
        let values = [0.5f32, 3.0, -1.0, 2.5, 7.0, 4.0, -2.0, 0.25, 6.0, 1.0, -3.0, 5.0, 2.0];
        for form in ALL {
            let n = (4..=13).rev().find(|n| form.spans(*n).is_some()).unwrap();
            let spans = form.spans(n).unwrap();
            let of = |k: usize| form.span(&values[..n], k);
            for k in 1..spans {
                assert!((value(of(k - 1), 1.0) - value(of(k), 0.0)).abs() < 1e-5, "{form} {k}");
            }
            let closes = (value(of(spans - 1), 1.0) - value(of(0), 0.0)).abs() < 1e-5;
            assert_eq!(closes, form.is_closed(), "{form}");
        }
    }

    #[test]
    fn curves_begin_and_end_where_the_documentation_says() {
        let v = [1.0f32, 3.0, 2.0, 6.0, 5.0, 9.0, 4.0];
        let check = |basis, wrap, begin: f32, end: f32| {
            let form = Form { basis, wrap };
            let last = form.spans(v.len()).unwrap() - 1;
            let found = [value(form.span(&v, 0), 0.0), value(form.span(&v, last), 1.0)];
            assert!((found[0] - begin).abs() + (found[1] - end).abs() < 1e-5, "{form}: {found:?}");
        };
        check(Linear, Nonperiodic, 1.0, 4.0);
        check(Bezier, Nonperiodic, 1.0, 4.0);
        check(Bezier, Pinned, 1.0, 4.0);
        check(CatmullRom, Nonperiodic, 3.0, 9.0);
        check(CatmullRom, Pinned, 1.0, 4.0);
        check(CatmullRom, Periodic, 3.0, 3.0);
        // (1 + 4 * 3 + 2) / 6 and (5 + 4 * 9 + 4) / 6.
        check(Bspline, Nonperiodic, 2.5, 7.5);
        check(Bspline, Pinned, 1.0, 4.0);
    }

    #[test]
    fn tokens_that_usd_does_not_know_are_named() {
        assert_eq!(Form::of("cubic", "catmullRom", "pinned"), Ok(Form::COIF));
        assert!(Form::of("linear", "hermite", "pinned").is_ok());
        for (tokens, name) in [
            (["cubic", "hermite", "pinned"], "basis"),
            (["quadratic", "bezier", "pinned"], "type"),
            (["cubic", "bezier", "segmented"], "wrap"),
        ] {
            assert_eq!(Form::of(tokens[0], tokens[1], tokens[2]).unwrap_err().0, name);
        }
    }
}
