//! Hair cut off or grown on: the points and attributes of curves that become shorter or longer.
//!
//! Guarantees: what is kept of a hair lies as it lay; a cut hair ends where it was cut, keeps the distance of its points and has four
//! at least; a hair that grows on goes on as its tip does, straighter and straighter; attributes as in `data/attribute_transfer.rs`.

use crate::data::attribute_transfer::carry_shares;
use crate::data::curves::{Tuft, TuftBuilder};
use crate::maths::spline::Spline;
use crate::maths::transcendental::{atan2, sin_cos};
use glam::Vec3;

/// Points on what is left of a hair, at least.
const FEWEST: usize = 4;
/// The most points that a hair grows on by.
const MOST: f32 = 4096.0;
/// So far (cm) beyond its tip a hair bends half as much as at its tip.
const STRAIGHTER: f32 = 4.0;

/// A tuft whose hairs get other points, made one hair after the other.
pub(crate) struct Shortened<'a> {
    tuft: &'a Tuft,
    out: TuftBuilder,
    kept: Vec<u32>,
    shares: Vec<f32>,
    /// For each new point: the old point before it and the fraction of the way to the next.
    places: Vec<(u32, f32)>,
    points: Vec<Vec3>,
}

impl<'a> Shortened<'a> {
    pub(crate) fn new(tuft: &'a Tuft) -> Self {
        let (out, points) = (TuftBuilder::new(), vec![]);
        Self { tuft, out, kept: vec![], shares: vec![], places: vec![], points }
    }

    /// Curve `i` as it is. (It has two points at least.)
    pub(crate) fn keep(&mut self, i: usize) {
        self.put(i, 1.0);
        self.out.push_curve(self.tuft.curve(i));
    }

    /// Curve `i`, whose points lie elsewhere, with more of them beyond its tip or none; it is so many times as long.
    pub(crate) fn grown(&mut self, i: usize, points: &[Vec3], share: f32) {
        let old = self.tuft.curve(i).len();
        self.put(i, share);
        let tip = self.tuft.offsets()[i] + old as u32 - 2;
        self.places.extend((old..points.len()).map(|_| (tip, 1.0)));
        self.out.push_curve(points);
    }

    /// Notes that curve `i` is so many times as long, and all of its points are there.
    fn put(&mut self, i: usize, share: f32) {
        self.kept.push(i as u32);
        self.shares.push(share);
        self.place(i, self.tuft.curve(i).len());
    }

    /// Notes that its first `n` points are there.
    fn place(&mut self, i: usize, n: usize) {
        let (first, last) = (self.tuft.offsets()[i], self.tuft.curve(i).len() - 2);
        self.places
            .extend((0..n).map(|k| (first + k.min(last) as u32, k.saturating_sub(last) as f32)));
    }

    /// Curve `i`, whose spline is `spline`, up to `end` cm from the root. `made` sets a new point right, given the old one before it.
    pub(crate) fn cut(
        &mut self,
        i: usize,
        spline: &Spline,
        end: f32,
        made: impl Fn(Vec3, usize) -> Vec3,
    ) {
        let (old, first) = (self.tuft.curve(i), self.tuft.offsets()[i]);
        self.kept.push(i as u32);
        self.shares.push(end / spline.length());
        self.points.clear();
        // Where a point of the hair is kept the hair lies as it did: out of the skin. The last of them is no nearer to the cut than
        // half the way to the next.
        let cut = spline.locate_length(end);
        let whole = if cut.t < 0.5 { cut.span } else { cut.span + 1 };
        if whole >= FEWEST - 1 {
            self.points.extend_from_slice(&old[..whole]);
            self.place(i, whole);
            self.points.push(made(spline.point(cut), cut.span));
            self.places.push((first + cut.span as u32, cut.t));
        } else {
            let mut cursor = 0;
            for k in 0..FEWEST {
                let at = spline.locate_rising(&mut cursor, end * k as f32 / (FEWEST - 1) as f32);
                self.points.push(made(spline.point(at), at.span));
                self.places.push((first + at.span as u32, at.t));
            }
        }
        self.points[0] = old[0];
        self.out.push_curve(&self.points);
    }

    pub(crate) fn build(mut self) -> Tuft {
        carry_shares(self.tuft, &self.kept, &self.places, &self.shares, &mut self.out);
        self.out.build()
    }
}

/// Adds points to those of a hair, as far apart as its own are in the mean, until it is `more` cm longer.
pub(super) fn grow_on(spline: &Spline, points: &mut Vec<Vec3>, more: f32) {
    let Some(mut at) = points.last().copied() else { return };
    let (length, spacing) = (spline.length(), spline.length() / spline.span_count() as f32);
    let mut way = spline.tangent_at(1.0);
    let before = spline.tangent(spline.locate_length(length - spacing));
    // How much it bends at its tip, radians a cm.
    let axis = before.cross(way);
    let bend = atan2(axis.length(), before.dot(way)) / spacing;
    let axis = axis.normalize_or_zero();
    let n = (more / spacing).round().clamp(1.0, MOST);
    let step = more / n;
    for k in 1..=n as usize {
        let far = (k as f32 - 0.5) * step;
        let (sin, cos) = sin_cos(bend * step * STRAIGHTER / (STRAIGHTER + far));
        way = (way * cos + axis.cross(way) * sin).normalize_or(way);
        at += way * step;
        points.push(at);
    }
}
