//! Hair as laws read it: curves of a groom while it is evaluated, or those that a file has, with their columns.
//!
//! Points are those of the curve that type, basis and wrap define (`drawn.rs`), wherever the points of a file lie; curves of coif go
//! through theirs. A column is read however it is spread: one value for all, one a curve, one a span's end or one a point. What all
//! curves would have without it says nothing, and is not there.
//!
//! Guarantees: curves read the same before they are written and after. Of pinned Catmull-Rom curves both readings are the same to
//! [`AGREE`], or the law is broken; where they are, the length is that of coif's own reading, else that of USD's. Not promised: that
//! reading stops when its host is asked to stop.

use super::drawn::EvaluatedCurves;
use crate::data::attributes::{self as a, Item};
use crate::data::curves::{AttributeView, Curves};
use crate::eval::Host;
use crate::formats::usd::form::{Basis, Form, Lerp, Wrap, value};
use crate::formats::usd::read::{ReadCurves, ReadPrimvar, ReadValues};
use crate::maths::catmull_rom_agreement::{AGREE, each_span};
use crate::maths::spline::{CurveFault, Spline};
use glam::Vec3;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::OnceLock;

/// Curves and where each of them lies.
pub struct MeasuredHair<'a> {
    source: Source<'a>,
    /// Control points of all curves.
    cvs: Cow<'a, [Vec3]>,
    /// Where the control points of each curve begin.
    offsets: Vec<usize>,
    drawn: Option<EvaluatedCurves>,
    host: &'a dyn Host,
}

#[derive(Clone, Copy)]
enum Source<'a> {
    Curves(&'a Curves),
    File(&'a ReadCurves),
}

impl<'a> MeasuredHair<'a> {
    /// Curves of a groom, to be read on the threads of `host`. One tuft is read where it lies, several are copied together.
    pub fn of(curves: &'a Curves, host: &'a dyn Host) -> Self {
        let tufts = curves.tufts();
        let counts = tufts.iter().flat_map(|tuft| (0..tuft.len()).map(|i| tuft.range(i).len()));
        let cvs = match tufts {
            [one] => Cow::Borrowed(one.points()),
            _ => tufts.iter().flat_map(|tuft| tuft.points()).copied().collect(),
        };
        let offsets = offsets(counts);
        Self { source: Source::Curves(curves), cvs, offsets, drawn: None, host }
    }
    /// Curves of a file, to be read on the threads of `host`.
    pub fn read(read: &'a ReadCurves, host: &'a dyn Host) -> Self {
        let offsets = offsets(read.counts.iter().map(|count| *count as usize));
        let drawn = EvaluatedCurves::of(read.form, &read.points, &offsets, host);
        Self { source: Source::File(read), cvs: Cow::Borrowed(&read.points), offsets, drawn, host }
    }
    /// Number of curves.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }
    /// Whether there are no curves.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Which curve the control points stand for.
    pub fn form(&self) -> Form {
        match self.source {
            Source::Curves(_) => Form::COIF,
            Source::File(read) => read.form,
        }
    }
    /// Number of control points of curve `i`.
    pub fn cv_count(&self, i: usize) -> usize {
        self.own(i).len()
    }
    /// Number of control points of all curves.
    pub fn cvs(&self) -> usize {
        self.cvs.len()
    }
    /// What `make` gives for each part of `0..n` cut into pieces of `each`, in order, made on all threads.
    pub(super) fn in_parts<T: Send + Sync>(
        &self,
        n: usize,
        each: usize,
        make: impl Fn(Range<usize>) -> T + Sync,
    ) -> Vec<T> {
        in_parts(self.host, n, each, make)
    }
    /// Whether it is what coif writes.
    pub(super) fn is_of_coifs_form(&self) -> bool {
        self.form() == Form::COIF
    }
    /// Points on all curves.
    pub fn points(&self) -> &[Vec3] {
        self.drawn.as_ref().map_or(&self.cvs, |drawn| &drawn.points)
    }
    /// Where the points of curve `i` lie among all.
    pub fn range(&self, i: usize) -> Range<usize> {
        self.drawn.as_ref().map_or_else(|| self.own(i), |drawn| drawn.range(i))
    }
    /// The points of curve `i`, root to tip.
    pub fn curve(&self, i: usize) -> &[Vec3] {
        &self.points()[self.range(i)]
    }
    /// Where the control points of curve `i` lie.
    fn own(&self, i: usize) -> Range<usize> {
        self.offsets[i]..self.offsets[i + 1]
    }
    /// Makes `spline` curve `i`, a span from each of its points to the next.
    pub(super) fn spline(&self, i: usize, spline: &mut Spline) -> Result<(), CurveFault> {
        let cvs = &self.cvs[self.own(i)];
        match &self.drawn {
            Some(drawn) => spline.rebuild_from_spans(drawn.between(i, cvs)),
            None if self.is_of_coifs_form() && self.readings_differ(i) <= AGREE => {
                spline.rebuild(cvs)
            }
            None => {
                let spans = self.form().spans(cvs.len()).unwrap_or(0);
                spline.rebuild_from_spans((0..spans).map(|k| self.form().span(cvs, k)))
            }
        }
    }
    /// Lengths of the parts of curve `i`, which `spline` is: from point to point, or of the spans that have points within.
    pub(super) fn each_part(&self, i: usize, spline: &Spline, mut part: impl FnMut(f32)) {
        let Some(drawn) = &self.drawn else {
            return self.curve(i).windows(2).for_each(|w| part(w[0].distance(w[1])));
        };
        let length = |k: usize| spline.u_of_cv(k) * spline.length();
        let (mut last, mut from) = (None, 0.0);
        for (k, span) in drawn.spans(i).enumerate() {
            if last.replace(span).is_some_and(|last| last != span) {
                part(length(k) - from);
                from = length(k);
            }
        }
        part(spline.length() - from);
    }
    /// How far the uniform and the centripetal reading of curve `i` differ, cm; 0 of curves that are no Catmull-Rom splines.
    pub(super) fn readings_differ(&self, i: usize) -> f32 {
        let Form { basis: Basis::CatmullRom, wrap } = self.form() else { return 0.0 };
        let cvs = &self.cvs[self.own(i)];
        let mut worst = 0.0f32;
        if wrap == Wrap::Pinned {
            each_span(cvs, |_, difference| worst = worst.max(difference));
        } else {
            // The first and last points only bend the curve; a closed curve has three of them twice.
            let again = if self.form().is_closed() { 3 } else { 0 };
            let all: Vec<Vec3> = cvs.iter().cycle().take(cvs.len() + again).copied().collect();
            each_span(&all, |k, difference| {
                if k > 0 && k + 2 < all.len() {
                    worst = worst.max(difference);
                }
            });
        }
        worst
    }
    /// One whole number for each curve from a column of any whole type.
    pub fn whole(&self, name: &str) -> Option<Vec<i64>> {
        let values: Vec<i64> = match self.source {
            Source::Curves(curves) => {
                let numbers = of_curves::<i32>(curves, name);
                let ids = || of_curves::<u64>(curves, name);
                match numbers {
                    Some(column) => column.of_each_curve()?.iter().map(|n| i64::from(*n)).collect(),
                    None => ids()?.of_each_curve()?.iter().map(|id| *id as i64).collect(),
                }
            }
            Source::File(read) => match &primvar(read, name)?.values {
                ReadValues::Int(v) => v.iter().map(|x| i64::from(*x)).collect(),
                ReadValues::Int64(v) => v.clone(),
                _ => return None,
            },
        };
        match values.len() {
            1 => Some(vec![values[0]; self.len()]),
            len if len == self.len() => Some(values),
            _ => None,
        }
    }
    /// Numbers, however they are spread.
    pub fn numbers(&self, name: &str) -> Option<AttributeValues<'_, f32>> {
        match self.source {
            Source::Curves(curves) => of_curves(curves, name),
            Source::File(read) => match &primvar(read, name)? {
                ReadPrimvar { values: ReadValues::Float(v), interpolation, .. } => {
                    self.column(interpolation, v)
                }
                _ => None,
            },
        }
    }
    /// Vectors, however they are spread.
    pub fn vectors(&self, name: &str) -> Option<AttributeValues<'_, Vec3>> {
        match self.source {
            Source::Curves(curves) => of_curves(curves, name),
            Source::File(read) => match &primvar(read, name)? {
                ReadPrimvar { values: ReadValues::Float3(v), interpolation, .. } => {
                    self.column(interpolation, v)
                }
                _ => None,
            },
        }
    }
    /// Smallest and largest diameter on the curves, cm.
    pub fn widths(&self) -> Option<[f32; 2]> {
        let range = |[lo, hi]: [f32; 2], x: f32| [lo.min(x), hi.max(x)];
        let none = [f32::MAX, f32::MIN];
        let found = match self.source {
            Source::Curves(curves) => match of_curves(curves, a::WIDTH.name) {
                Some(column) => column.values.iter().copied().fold(none, range),
                None => [a::WIDTH.default; 2],
            },
            Source::File(read) => {
                let widths = read.widths.as_ref().filter(|w| !w.values.is_empty())?;
                let values = &widths.values;
                match (widths.interpolation.as_str(), &self.drawn) {
                    ("vertex", Some(_)) => {
                        let spans = |i: usize| 0..read.form.spans(self.own(i).len()).unwrap_or(0);
                        let all = (0..self.len()).flat_map(|i| spans(i).map(move |k| (i, k)));
                        all.flat_map(|(i, k)| extremes(read.form.span(&values[self.own(i)], k)))
                            .fold(none, range)
                    }
                    _ => values.iter().copied().fold(none, range),
                }
            }
        };
        (found != none).then_some(found)
    }
    fn column<'p, T: Clone>(
        &'p self,
        interpolation: &str,
        values: &'p [T],
    ) -> Option<AttributeValues<'p, T>> {
        let how = match (interpolation, &self.drawn) {
            ("constant", _) => Spread::All,
            ("uniform", _) => Spread::Curves,
            ("vertex", Some(drawn)) => Spread::Blended(drawn, &self.offsets),
            ("varying" | "faceVarying", Some(drawn)) => Spread::Straight(drawn),
            ("vertex" | "varying" | "faceVarying", None) => Spread::Points,
            _ => return None,
        };
        Some(AttributeValues { values: Cow::Borrowed(values), how })
    }
}

fn offsets(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut offsets = vec![0];
    for count in counts {
        offsets.push(offsets[offsets.len() - 1] + count);
    }
    offsets
}

fn primvar<'a>(read: &'a ReadCurves, name: &str) -> Option<&'a ReadPrimvar> {
    read.primvars.iter().find(|p| p.name == name)
}

/// The column of all tufts together; none where no curve has anything but what it would have without.
fn of_curves<T: Item>(curves: &Curves, name: &str) -> Option<AttributeValues<'static, T>> {
    let views = || curves.tufts().iter().map(|tuft| tuft.view_named::<T>(name));
    let sample = curves.tufts().iter().filter_map(|tuft| tuft.attribute(name));
    let sample = sample.map(|own| &own.values).find(|own| T::values(own).is_some())?;
    let default = *T::values(&a::default_of(name, sample))?.first()?;
    let says_nothing = |view: Option<AttributeView<T>>| match view {
        Some(AttributeView::Shared(one)) => one == default,
        view => view.is_none(),
    };
    if views().all(says_nothing) {
        return None;
    }
    let of_points = views().any(|view| matches!(view, Some(AttributeView::Point(_))));
    let mut values = vec![];
    for tuft in curves.tufts() {
        let view = tuft.view_named(name).unwrap_or(AttributeView::Shared(default));
        for i in 0..tuft.len() {
            let points = tuft.range(i);
            match of_points {
                true => values.extend(points.map(|k| view.at(i, k))),
                false => values.push(view.at(i, points.start)),
            }
        }
    }
    let how = if of_points { Spread::Points } else { Spread::Curves };
    Some(AttributeValues { values: values.into(), how })
}

#[derive(Clone, Copy)]
enum Spread<'a> {
    All,
    Curves,
    Points,
    /// As points are blended: the curves, and where the values of each begin.
    Blended(&'a EvaluatedCurves, &'a [usize]),
    /// Straight over each span.
    Straight(&'a EvaluatedCurves),
}

/// Values of one name.
pub struct AttributeValues<'a, T: Clone> {
    values: Cow<'a, [T]>,
    how: Spread<'a>,
}

impl<T: Lerp> AttributeValues<'_, T> {
    /// The value at point `point` of all, which is one of curve `curve`.
    #[inline]
    pub fn at(&self, curve: usize, point: usize) -> T {
        match self.how {
            Spread::All => self.values[0],
            Spread::Curves => self.values[curve],
            Spread::Points => self.values[point],
            Spread::Blended(drawn, offsets) => {
                drawn.vertex(&self.values[offsets[curve]..offsets[curve + 1]], point)
            }
            Spread::Straight(drawn) => drawn.varying(&self.values, curve, point),
        }
    }
}

impl<T: Clone> AttributeValues<'_, T> {
    /// Whether points of one curve may differ.
    pub fn is_of_points(&self) -> bool {
        !matches!(self.how, Spread::All | Spread::Curves)
    }
    /// One value a curve, where there is.
    fn of_each_curve(&self) -> Option<&[T]> {
        matches!(self.how, Spread::Curves).then_some(&*self.values)
    }
}

/// Values of a polynomial over [0, 1] with its smallest and largest among them.
fn extremes(span: [f32; 4]) -> impl Iterator<Item = f32> {
    let [_, c1, c2, c3] = span;
    // Where 3 c3 t² + 2 c2 t + c1 is zero, in a form that no small c3 spoils.
    let root = (c2 * c2 - 3.0 * c3 * c1).max(0.0).sqrt();
    let q = -(c2 + root.copysign(c2));
    let inner = [q / (3.0 * c3), c1 / q].into_iter().filter(|t| *t > 0.0 && *t < 1.0);
    [0.0, 1.0].into_iter().chain(inner).map(move |t| value(span, t))
}

/// What `make` gives for each part of `0..n` cut into pieces of `each`, in order, made on the threads of `host`.
pub(super) fn in_parts<T: Send + Sync>(
    host: &dyn Host,
    n: usize,
    each: usize,
    make: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    let made: Vec<OnceLock<T>> = (0..n.div_ceil(each)).map(|_| OnceLock::new()).collect();
    host.for_each(made.len(), &|part| {
        let _ = made[part].set(make(part * each..((part + 1) * each).min(n)));
    });
    made.into_iter().filter_map(OnceLock::into_inner).collect()
}

/// The value that a share `q` of sorted values does not exceed.
pub(super) fn quantile(sorted: &[f32], q: f32) -> f32 {
    let at = (q * sorted.len().saturating_sub(1) as f32).round() as usize;
    sorted.get(at).copied().unwrap_or(0.0)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Curves of a file with these primvars: one value, one a curve or one a point.
    pub(in super::super) fn read_of(
        curves: &[&[Vec3]],
        primvars: &[(&str, ReadValues)],
    ) -> ReadCurves {
        let points: Vec<Vec3> = curves.concat();
        let interpolation = |n: usize| match n {
            1 => "constant",
            n if n == curves.len() => "uniform",
            _ => "vertex",
        };
        let primvar = |(name, values): &(&str, ReadValues)| ReadPrimvar {
            name: (*name).into(),
            type_name: String::new(),
            interpolation: interpolation(values.len()).into(),
            values: values.clone(),
        };
        ReadCurves {
            path: "/groom/hair".into(),
            purpose: "default".into(),
            is_visible: true,
            counts: curves.iter().map(|c| c.len() as u32).collect(),
            points,
            form: Form::COIF,
            widths: None,
            primvars: primvars.iter().map(primvar).collect(),
            notes: vec![],
        }
    }
}
