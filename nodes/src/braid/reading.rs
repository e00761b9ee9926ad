//! What tests read of evaluated strands: their word and its signs, and how near they come to one another.
//!
//! The one reader of words beside `laws::braids`, and independent of it on purpose: it knows the source and its frames, so it has to
//! find neither a middle line nor a front, lets no crossing pass as undone, and measures each strand against each in full. What
//! `laws` reads of the same braids is held against it (`laws.rs`).
//!
//! Guarantees: everything is measured on the strands only, as splines through their CVs with radii linear between CVs;
//! an invalid word fails the calling test. Not promised: signs beside a fold of the source, where no point shows them.

use super::weave::Weave;
use crate::data::attributes as attr;
use crate::data::curves::{Curves, Tuft};
use crate::maths::frame::{Frame, across, frames};
use crate::maths::spline::{Spline, SplineParam};
use glam::{Vec2, Vec3};

/// A strand, from its CVs.
pub(super) struct CvStrand {
    spline: Spline,
    pub(super) along: Vec<f32>,
    pub(super) radius: Vec<f32>,
}

impl CvStrand {
    pub(super) fn all(strands: &Curves) -> Vec<Self> {
        let strand = |(tuft, i): (&Tuft, usize)| {
            let column = |declared| {
                let view = tuft.view(declared);
                tuft.range(i).map(|k| view.at(i, k)).collect::<Vec<f32>>()
            };
            Self {
                spline: Spline::new(tuft.curve(i)).unwrap(),
                along: column(attr::ALONG),
                radius: column(attr::RADIUS),
            }
        };
        strands.each().map(strand).collect()
    }
    fn between(column: &[f32], place: SplineParam) -> f32 {
        column[place.span] * (1.0 - place.t) + column[place.span + 1] * place.t
    }
    /// The point at the fraction `u` of the source.
    pub(super) fn beside(&self, u: f32) -> Vec3 {
        let last = self.spline.span_count() - 1;
        let span = self.along.partition_point(|a| *a <= u).saturating_sub(1).min(last);
        let (a, b) = (self.along[span], self.along[span + 1]);
        self.spline.point(SplineParam { span, t: ((u - a) / (b - a)).clamp(0.0, 1.0) })
    }
    /// Point, radius and fraction along the source, `per_span` samples per span.
    pub(super) fn samples(&self, per_span: usize) -> Vec<(Vec3, f32, f32)> {
        let n = self.spline.span_count();
        (0..=n * per_span)
            .map(|k| {
                let span = (k / per_span).min(n - 1);
                let place = SplineParam { span, t: (k - span * per_span) as f32 / per_span as f32 };
                let point = self.spline.point(place);
                (point, Self::between(&self.radius, place), Self::between(&self.along, place))
            })
            .collect()
    }
}

/// Crossings in order: which neighbours (0 is the leftmost pair), and whether the strand going right is above. `None`
/// where `blind`; there, two crossings that undo each other are dropped.
fn crossings(
    at: impl Fn(usize) -> Vec<Vec2>,
    blind: impl Fn(usize) -> bool,
    samples: usize,
) -> Vec<(usize, Option<bool>)> {
    let first = at(0);
    let mut order: Vec<usize> = (0..first.len()).collect();
    order.sort_by(|a, b| first[*a].x.total_cmp(&first[*b].x));
    let mut word = vec![];
    for k in 1..samples {
        let now = at(k);
        let mut swapped = true;
        while swapped {
            swapped = false;
            for p in 0..order.len() - 1 {
                let (left, right) = (order[p], order[p + 1]);
                if now[left].x > now[right].x {
                    let sign = (!blind(k)).then_some(now[left].y > now[right].y);
                    let before = word.iter().rposition(|(q, _): &(usize, _)| p.abs_diff(*q) <= 1);
                    match before.filter(|at| sign.is_none() && word[*at] == (p, None)) {
                        Some(at) if first.len() > 2 => drop(word.remove(at)),
                        _ => word.push((p, sign)),
                    }
                    order.swap(p, p + 1);
                    swapped = true;
                }
            }
        }
    }
    word
}

/// Signs of the generators of a word in which all crossings of a pair have the same sign and neighbouring pairs
/// alternate: up to exchange of commuting generators and rotation, such a word is (one stitch's factor)^stitches.
#[track_caller]
fn signs(
    word: &[(usize, Option<bool>)],
    strands: usize,
    stitches: f64,
    what: &str,
) -> Vec<Option<bool>> {
    let mut signs = vec![];
    for p in 0..strands - 1 {
        let own: Vec<Option<bool>> =
            word.iter().filter(|(q, _)| *q == p).map(|(_, s)| *s).collect();
        assert!(
            (own.len() as f64 - stitches).abs() <= 1.0,
            "{what}: pair {p} {} {stitches}",
            own.len()
        );
        let own: Vec<bool> = own.into_iter().flatten().collect();
        assert!(own.iter().all(|s| *s == own[0]), "{what}: pair {p} crosses both ways");
        signs.push(own.first().copied());
        let two: Vec<&(usize, Option<bool>)> =
            word.iter().filter(|(q, _)| *q == p || *q == p + 1).collect();
        if p + 2 < strands {
            assert!(
                two.windows(2).all(|w| w[0].0 != w[1].0 || w[0].1.is_none() || w[1].1.is_none()),
                "{what}: pairs {p} and {} do not take turns",
                p + 1
            );
        }
    }
    signs
}

pub(super) fn path_signs(weave: &Weave) -> Vec<Option<bool>> {
    let n = weave.strands as usize;
    let at = |k: usize| -> Vec<Vec2> {
        (0..n as u32).map(|i| weave.at(i, 0.0013 + k as f64 / (97.0 * n as f64)).into()).collect()
    };
    signs(&crossings(at, |_| false, 97 * 4 + 1), n, 4.0, "path")
}

/// Crossing signs of a braid over the fractions `over` of its source. Where the source turns back on itself, the braid
/// is folded over: between the two points of a strand beside the fold, no point shows which strand is in front, or
/// when, so those crossings are only counted.
#[track_caller]
pub(super) fn braid_signs(
    strands: &[CvStrand],
    source: &Spline,
    frames: &dyn Fn(&[f32]) -> Vec<Frame>,
    over: (f32, f32),
    stitches: f64,
    what: &str,
) -> Vec<Option<bool>> {
    let samples = (stitches * 64.0) as usize + 2;
    let us: Vec<f32> = (0..samples)
        .map(|k| over.0 + (over.1 - over.0) * k as f32 / (samples - 1) as f32)
        .collect();
    let frames = frames(&us);
    let at = |k: usize| -> Vec<Vec2> {
        let centre = source.at(us[k]);
        strands
            .iter()
            .map(|strand| {
                let p = strand.beside(us[k]) - centre;
                Vec2::new(p.dot(frames[k].binormal()), p.dot(frames[k].normal))
            })
            .collect()
    };
    let folds: Vec<usize> = (1..samples)
        .filter(|k| {
            frames[k - 1].tangent.dot(frames[*k].tangent) < -std::f32::consts::FRAC_1_SQRT_2
        })
        .collect();
    // At least eight points per stitch of 64 samples, of which strands that run across take more than the source.
    let blind = |k: usize| folds.iter().any(|fold| k.abs_diff(*fold) <= 12);
    signs(&crossings(at, blind, samples), strands.len(), stitches, what)
}

/// The largest (r_i(u) + r_j(v)) / |p_i(u) - p_j(v)| of different strands, and the fraction of the strands' samples
/// with a neighbour that touches them to 8 %.
pub(super) fn overlap(strands: &[CvStrand]) -> (f32, f32) {
    let all: Vec<Vec<(Vec3, f32, f32)>> = strands.iter().map(|s| s.samples(4)).collect();
    let (mut worst, mut touching, mut count) = (0.0f32, 0, 0);
    for (i, own) in all.iter().enumerate() {
        for (p, r, _) in own {
            let mut best = 0.0f32;
            for (j, other) in all.iter().enumerate() {
                if i == j {
                    continue;
                }
                for (q, s, _) in other {
                    best = best.max((r + s) * (r + s) / p.distance_squared(*q));
                }
            }
            worst = worst.max(best);
            touching += usize::from(best > 0.85);
            count += 1;
        }
    }
    (worst.sqrt(), touching as f32 / count as f32)
}

pub(super) fn carried(source: &[Vec3]) -> impl Fn(&[f32]) -> Vec<Frame> + use<> {
    let spline = Spline::new(source).unwrap();
    move |us| frames(&spline, us, None, |_, _, _| None)
}

pub(super) fn on_ball(source: &[Vec3]) -> impl Fn(&[f32]) -> Vec<Frame> + use<> {
    let spline = Spline::new(source).unwrap();
    move |us| {
        let frame = |u: &f32| {
            let tangent = spline.tangent_at(*u);
            Frame { tangent, normal: across(spline.at(*u).normalize(), tangent).unwrap() }
        };
        us.iter().map(frame).collect()
    }
}
