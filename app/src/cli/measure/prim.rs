//! One curves prim of a file, with its columns as measuring wants them, and work shared among threads.
//!
//! A primvar is read however it is spread: one value for all, one a curve or one a point.

use coif_nodes::formats::usd::read::{ReadCurves, ReadValues};
use glam::Vec3;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// A prim and where each of its curves lies.
pub(super) struct Prim<'a> {
    pub(super) read: &'a ReadCurves,
    offsets: Vec<usize>,
}

impl<'a> Prim<'a> {
    pub(super) fn new(read: &'a ReadCurves) -> Self {
        let mut offsets = vec![0usize];
        for count in &read.counts {
            offsets.push(offsets[offsets.len() - 1] + *count as usize);
        }
        Self { read, offsets }
    }
    /// Number of curves.
    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }
    /// Whether renderers leave it out.
    pub(super) fn is_guides(&self) -> bool {
        self.read.purpose == "guide"
    }
    /// Where the points of curve `i` lie among all.
    pub(super) fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.offsets[i]..self.offsets[i + 1]
    }
    /// The points of curve `i`, root to tip.
    pub(super) fn curve(&self, i: usize) -> &'a [Vec3] {
        &self.read.points[self.range(i)]
    }
    fn values(&self, name: &str) -> Option<&'a ReadValues> {
        Some(&self.read.primvars.iter().find(|p| p.name == name)?.values)
    }
    /// One whole number for each curve from a primvar of any whole type.
    pub(super) fn whole(&self, name: &str) -> Option<Vec<i64>> {
        let values: Vec<i64> = match self.values(name)? {
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
    pub(super) fn numbers(&self, name: &str) -> Option<Column<'a, f32>> {
        match self.values(name)? {
            ReadValues::Float(v) => self.column(v),
            _ => None,
        }
    }
    /// Vectors, however they are spread.
    pub(super) fn vectors(&self, name: &str) -> Option<Column<'a, Vec3>> {
        match self.values(name)? {
            ReadValues::Float3(v) => self.column(v),
            _ => None,
        }
    }
    fn column<T>(&self, values: &'a [T]) -> Option<Column<'a, T>> {
        let how = match values.len() {
            1 => Spread::All,
            n if n == self.read.points.len() => Spread::Points,
            n if n == self.len() => Spread::Curves,
            _ => return None,
        };
        Some(Column { values, how })
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Spread {
    All,
    Curves,
    Points,
}

/// Values of a primvar.
#[derive(Clone, Copy)]
pub(super) struct Column<'a, T> {
    values: &'a [T],
    how: Spread,
}

impl<T: Copy> Column<'_, T> {
    /// The value at point `point` of the prim, which is one of curve `curve`.
    #[inline]
    pub(super) fn at(&self, curve: usize, point: usize) -> T {
        match self.how {
            Spread::All => self.values[0],
            Spread::Curves => self.values[curve],
            Spread::Points => self.values[point],
        }
    }
    /// Whether points of one curve may differ.
    pub(super) fn is_of_points(&self) -> bool {
        self.how == Spread::Points
    }
}

/// What `make` gives for each part of `0..n` cut into pieces of `each`, made by as many threads as the machine has, in order.
pub(super) fn in_parts<T: Send>(
    n: usize,
    each: usize,
    make: impl Fn(std::ops::Range<usize>) -> T + Sync,
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
