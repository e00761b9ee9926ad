//! Cutting and extending hair: CVs and attributes of curves that change length.
//!
//! Guarantees: what is left of a hair stays in place; a cut hair ends at the cut, keeps its spacing of CVs and has at least four;
//! an extension continues the bend of the tip and straightens out; attributes as in `data/attribute_transfer.rs`.

use crate::data::attribute_transfer::carry_shares;
use crate::data::curves::{Tuft, TuftBuilder};
use crate::maths::spline::Spline;
use crate::maths::transcendental::{atan2, sin_cos};
use glam::Vec3;

/// Smallest number of CVs of a cut hair.
const FEWEST: usize = 4;
/// Largest number of CVs added to a hair.
const MOST: f32 = 4096.0;
/// Distance beyond the tip, cm, over which the bend of an extension halves.
const STRAIGHTER: f32 = 4.0;

/// A tuft whose hairs get new CVs, built one hair at a time.
pub(crate) struct Shortened<'a> {
    tuft: &'a Tuft,
    out: TuftBuilder,
    kept: Vec<u32>,
    shares: Vec<f32>,
    /// For each new CV: the old CV before it, and the fraction of the way to the next.
    places: Vec<(u32, f32)>,
    points: Vec<Vec3>,
}

impl<'a> Shortened<'a> {
    pub(crate) fn new(tuft: &'a Tuft) -> Self {
        let (out, points) = (TuftBuilder::new(), vec![]);
        Self { tuft, out, kept: vec![], shares: vec![], places: vec![], points }
    }

    /// Adds curve `i` unchanged. (It has at least two CVs.)
    pub(crate) fn keep(&mut self, i: usize) {
        self.put(i, 1.0);
        self.out.push_curve(self.tuft.curve(i));
    }

    /// Adds curve `i` with moved CVs, and optionally more beyond its tip; `share` is the factor of its length.
    pub(crate) fn grown(&mut self, i: usize, points: &[Vec3], share: f32) {
        let old = self.tuft.curve(i).len();
        self.put(i, share);
        let tip = self.tuft.offsets()[i] + old as u32 - 2;
        self.places.extend((old..points.len()).map(|_| (tip, 1.0)));
        self.out.push_curve(points);
    }

    /// Notes the factor of curve `i`'s length; all of its CVs are added.
    fn put(&mut self, i: usize, share: f32) {
        self.kept.push(i as u32);
        self.shares.push(share);
        self.place(i, self.tuft.curve(i).len());
    }

    /// Notes that its first `n` CVs are added.
    fn place(&mut self, i: usize, n: usize) {
        let (first, last) = (self.tuft.offsets()[i], self.tuft.curve(i).len() - 2);
        self.places
            .extend((0..n).map(|k| (first + k.min(last) as u32, k.saturating_sub(last) as f32)));
    }

    /// Adds curve `i`, with the spline `spline`, up to `end` cm from the root. `made` corrects a new CV, given the old one before
    /// it.
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
        // Up to the last CV that is kept, the hair is unchanged, so it is out of the skin. That CV is at least half a segment
        // away from the cut.
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

/// Adds CVs to those of a hair at its mean spacing until it is `more` cm longer.
pub(super) fn grow_on(spline: &Spline, points: &mut Vec<Vec3>, more: f32) {
    let Some(mut at) = points.last().copied() else { return };
    let (length, spacing) = (spline.length(), spline.length() / spline.span_count() as f32);
    let mut way = spline.tangent_at(1.0);
    let before = spline.tangent(spline.locate_length(length - spacing));
    // Curvature at the tip, radians per cm.
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
