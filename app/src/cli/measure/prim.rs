//! One curves prim of a file, with its columns as measuring wants them, and work shared among threads.
//!
//! Points are those of the curve that type, basis and wrap define (`drawn.rs`), wherever the points of the file lie. A primvar is
//! read however it is spread: one value for all, one a curve, one a span's end or one a point.
//!
//! Of pinned Catmull-Rom curves both readings are the same to [`AGREE`], or the law is broken; where they are, the length is that of
//! coif's own reading, else that of USD's.

use super::drawn::Drawn;
use coif_nodes::formats::usd::form::{Basis, Blend, Form, Wrap, value};
use coif_nodes::formats::usd::read::{ReadCurves, ReadPrimvar, ReadValues};
use coif_nodes::maths::readings::{AGREE, each_span};
use coif_nodes::maths::spline::{CurveFault, Spline};
use glam::Vec3;
use std::num::NonZero;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// A prim and where each of its curves lies.
pub(super) struct Prim<'a> {
    pub(super) read: &'a ReadCurves,
    /// Where the points of the file that control each curve begin.
    offsets: Vec<usize>,
    drawn: Option<Drawn>,
}

impl<'a> Prim<'a> {
    pub(super) fn new(read: &'a ReadCurves) -> Self {
        let mut offsets = vec![0usize];
        for count in &read.counts {
            offsets.push(offsets[offsets.len() - 1] + *count as usize);
        }
        let drawn = Drawn::of(read.form, &read.points, &offsets);
        Self { read, offsets, drawn }
    }
    /// Number of curves.
    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }
    /// Whether renderers leave it out.
    pub(super) fn is_guides(&self) -> bool {
        self.read.purpose == "guide"
    }
    /// Whether it is what coif writes.
    pub(super) fn is_of_coifs_form(&self) -> bool {
        self.read.form == Form::COIF
    }
    /// Points on all curves.
    pub(super) fn points(&self) -> &[Vec3] {
        self.drawn.as_ref().map_or(&self.read.points, |drawn| &drawn.points)
    }
    /// Where the points of curve `i` lie among all.
    pub(super) fn range(&self, i: usize) -> Range<usize> {
        self.drawn.as_ref().map_or_else(|| self.own(i), |drawn| drawn.range(i))
    }
    /// The points of curve `i`, root to tip.
    pub(super) fn curve(&self, i: usize) -> &[Vec3] {
        &self.points()[self.range(i)]
    }
    /// Where the points of the file that control curve `i` lie.
    fn own(&self, i: usize) -> Range<usize> {
        self.offsets[i]..self.offsets[i + 1]
    }
    /// Makes `spline` curve `i`, a span from each of its points to the next.
    pub(super) fn spline(&self, i: usize, spline: &mut Spline) -> Result<(), CurveFault> {
        let cvs = &self.read.points[self.own(i)];
        match &self.drawn {
            Some(drawn) => spline.rebuild_from_spans(drawn.between(i, cvs)),
            None if self.is_of_coifs_form() && self.readings_differ(i) <= AGREE => {
                spline.rebuild(cvs)
            }
            None => {
                let spans = self.read.form.spans(cvs.len()).unwrap_or(0);
                spline.rebuild_from_spans((0..spans).map(|k| self.read.form.span(cvs, k)))
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
        let Form { basis: Basis::CatmullRom, wrap } = self.read.form else { return 0.0 };
        let cvs = &self.read.points[self.own(i)];
        let mut worst = 0.0f32;
        if wrap == Wrap::Pinned {
            each_span(cvs, |_, difference| worst = worst.max(difference));
        } else {
            // The first and last points only bend the curve; a closed curve has three of them twice.
            let again = if self.read.form.is_closed() { 3 } else { 0 };
            let all: Vec<Vec3> = cvs.iter().cycle().take(cvs.len() + again).copied().collect();
            each_span(&all, |k, difference| {
                if k > 0 && k + 2 < all.len() {
                    worst = worst.max(difference);
                }
            });
        }
        worst
    }
    fn values(&self, name: &str) -> Option<&'a ReadPrimvar> {
        self.read.primvars.iter().find(|p| p.name == name)
    }
    /// One whole number for each curve from a primvar of any whole type.
    pub(super) fn whole(&self, name: &str) -> Option<Vec<i64>> {
        let values: Vec<i64> = match &self.values(name)?.values {
            ReadValues::Int(v) => v.iter().map(|x| i64::from(*x)).collect(),
            ReadValues::Int64(v) => v.clone(),
            _ => return None,
        };
        match values.len() {
            1 => Some(vec![values[0]; self.len()]),
            len if len == self.len() => Some(values),
            _ => None,
        }
    }
    /// Numbers, however they are spread.
    pub(super) fn numbers(&self, name: &str) -> Option<Column<'_, f32>> {
        let primvar = self.values(name)?;
        match &primvar.values {
            ReadValues::Float(v) => self.column(&primvar.interpolation, v),
            _ => None,
        }
    }
    /// Vectors, however they are spread.
    pub(super) fn vectors(&self, name: &str) -> Option<Column<'_, Vec3>> {
        let primvar = self.values(name)?;
        match &primvar.values {
            ReadValues::Float3(v) => self.column(&primvar.interpolation, v),
            _ => None,
        }
    }
    /// Smallest and largest diameter on the curves, cm.
    pub(super) fn widths(&self) -> Option<[f32; 2]> {
        let widths = self.read.widths.as_ref().filter(|w| !w.values.is_empty())?;
        let range = |[lo, hi]: [f32; 2], x: f32| [lo.min(x), hi.max(x)];
        let none = [f32::MAX, f32::MIN];
        let values = &widths.values;
        let found = match (widths.interpolation.as_str(), &self.drawn) {
            ("vertex", Some(_)) => {
                let form = self.read.form;
                let spans = |i: usize| 0..form.spans(self.own(i).len()).unwrap_or(0);
                let all = (0..self.len()).flat_map(|i| spans(i).map(move |k| (i, k)));
                all.flat_map(|(i, k)| extremes(form.span(&values[self.own(i)], k)))
                    .fold(none, range)
            }
            _ => values.iter().copied().fold(none, range),
        };
        (found != none).then_some(found)
    }
    fn column<'p, T>(&'p self, interpolation: &str, values: &'p [T]) -> Option<Column<'p, T>> {
        let how = match (interpolation, &self.drawn) {
            ("constant", _) => Spread::All,
            ("uniform", _) => Spread::Curves,
            ("vertex", Some(drawn)) => Spread::Blended(drawn, &self.offsets),
            ("varying" | "faceVarying", Some(drawn)) => Spread::Straight(drawn),
            ("vertex" | "varying" | "faceVarying", None) => Spread::Points,
            _ => return None,
        };
        Some(Column { values, how })
    }
}

#[derive(Clone, Copy)]
enum Spread<'a> {
    All,
    Curves,
    Points,
    /// As points are blended: the curves, and where the values of each begin.
    Blended(&'a Drawn, &'a [usize]),
    /// Straight over each span.
    Straight(&'a Drawn),
}

/// Values of a primvar.
#[derive(Clone, Copy)]
pub(super) struct Column<'a, T> {
    values: &'a [T],
    how: Spread<'a>,
}

impl<T: Blend> Column<'_, T> {
    /// The value at point `point` of the prim, which is one of curve `curve`.
    #[inline]
    pub(super) fn at(&self, curve: usize, point: usize) -> T {
        match self.how {
            Spread::All => self.values[0],
            Spread::Curves => self.values[curve],
            Spread::Points => self.values[point],
            Spread::Blended(drawn, offsets) => {
                drawn.vertex(&self.values[offsets[curve]..offsets[curve + 1]], point)
            }
            Spread::Straight(drawn) => drawn.varying(self.values, curve, point),
        }
    }
    /// Whether points of one curve may differ.
    pub(super) fn is_of_points(&self) -> bool {
        !matches!(self.how, Spread::All | Spread::Curves)
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

/// What `make` gives for each part of `0..n` cut into pieces of `each`, made by as many threads as the machine has, in order.
pub(super) fn in_parts<T: Send>(
    n: usize,
    each: usize,
    make: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    let parts = n.div_ceil(each);
    let next = AtomicUsize::new(0);
    let made: Mutex<Vec<(usize, T)>> = Mutex::new(Vec::with_capacity(parts));
    let work = || {
        loop {
            let part = next.fetch_add(1, Ordering::Relaxed);
            if part >= parts {
                return;
            }
            let one = make(part * each..((part + 1) * each).min(n));
            made.lock().unwrap_or_else(PoisonError::into_inner).push((part, one));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get).min(parts);
    std::thread::scope(|scope| {
        (1..threads).for_each(|_| {
            scope.spawn(work);
        });
        work();
    });
    let mut made = made.into_inner().unwrap_or_else(PoisonError::into_inner);
    made.sort_by_key(|(part, _)| *part);
    made.into_iter().map(|(_, one)| one).collect()
}

/// The value that a share `q` of sorted values does not exceed.
pub(super) fn quantile(sorted: &[f32], q: f32) -> f32 {
    let at = (q * sorted.len().saturating_sub(1) as f32).round() as usize;
    sorted.get(at).copied().unwrap_or(0.0)
}
