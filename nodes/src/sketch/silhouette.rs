//! Silhouette: a closed outline drawn over the head becomes a cluster of that width; beyond the paper: tapered locks in
//! one stroke.
//!
//! The outline begins and ends at the root. Its medial line, from between its ends to the middle of its far end, is the
//! path of an implant (`grow`); half its width is the radius at each CV, at the depth of that CV.
//!
//! Guarantees: those of an implant; a radius at each CV, finite and not negative; the same stroke gives the same widths
//! at each replay. An invalid outline (open, self-crossing, no larger than the reach of the pen, without width) is
//! reported and makes nothing. Not promised: the widths of outlines that double back on themselves.

use super::seen::{Seen, steps};
use glam::{Vec2, Vec3};

/// Samples at which both sides of an outline are compared.
const PLACES: u16 = 256;
/// The most steps of an outline that are examined.
const MOST_STEPS: f32 = 256.0;
/// Smallest distance of the far end from the root, relative to the farthest point.
const FAR: f32 = 0.7;
/// A medial line that advances by less than this fraction of its sides is past its end.
const LEADS_ON: f32 = 0.5;
/// Ends farther apart than this fraction of the stroke do not close it.
const OPEN: f32 = 0.25;

/// The medial line of an outline and half the width along it, pixels.
pub(super) struct MedialLine {
    pub line: Vec<Vec2>,
    /// For each position on the line, the distance along it in pixels, and half the width there.
    widths: Vec<(f32, f32)>,
}

impl MedialLine {
    /// The outline of a stroke under a pen that reaches `rho` pixels, or why it is invalid.
    pub(super) fn of(stroke: &[Vec2], rho: f32) -> Result<Self, &'static str> {
        let (first, last) = (stroke[0], stroke[stroke.len() - 1]);
        let extent = stroke.iter().map(|p| p.distance(first)).fold(0.0, f32::max);
        if extent < rho {
            return Err("it is smaller than the pen reaches: draw a larger outline");
        }
        let length: f32 = stroke.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let gap = first.distance(last);
        if gap > 2.0 * rho && gap > OPEN * length {
            return Err("it is not closed: lead the outline back to where it began");
        }
        let step = (0.1 * rho).max(length / MOST_STEPS);
        let around = steps(stroke, step);
        if crosses(&around, step, rho) {
            return Err("it crosses itself: draw an outline that goes round once");
        }
        let around = Around::new(around);
        let far_end = around.far_end(first.midpoint(last));
        let least = LEADS_ON * 0.5 * around.whole() / f32::from(PLACES);
        let (mut line, mut widths) = (vec![], vec![]);
        let (mut far, mut last) = (0.0f32, around.at(0.0));
        for k in 0..=PLACES {
            let (a, b) = around.pair(far_end, f32::from(k) / f32::from(PLACES));
            let at = a.midpoint(b);
            let on = at.distance(std::mem::replace(&mut last, at));
            if let Some(before) = line.last() {
                // Along the straight end of a lock, the width stays constant.
                if on < least {
                    continue;
                }
                far += at.distance(*before);
            }
            line.push(at);
            widths.push((far, 0.5 * a.distance(b)));
        }
        let mean = widths.iter().map(|(_, half)| half).sum::<f32>() / widths.len() as f32;
        match () {
            () if far < 0.5 * rho => Err("it leads nowhere: draw it from the root and back to it"),
            () if mean < 1.0 => Err("it has no width: draw both sides of the lock"),
            () => Ok(Self { line, widths }),
        }
    }

    /// The radius at each CV of a curve that was drawn along the line, cm.
    pub(super) fn radii(&self, seen: &Seen, points: &[Vec3]) -> Vec<f32> {
        let last = points.len() - 1;
        let half = |k: usize| {
            let along = k as f32 / last as f32;
            let half = self.half(along);
            // A cluster that begins in a point takes the width half a segment further, so that it has hair.
            if k == 0 { half.max(self.half(0.5 / last as f32)) } else { half }
        };
        (0..=last).map(|k| half(k) * seen.cm_per_pixel(seen.depth(points[k]))).collect()
    }

    /// Half the width at a fraction of the whole line, pixels.
    fn half(&self, along: f32) -> f32 {
        let far = along * self.widths[self.widths.len() - 1].0;
        let k = self.widths.partition_point(|(at, _)| *at < far).min(self.widths.len() - 1);
        let (to, from) = (self.widths[k], self.widths[k.saturating_sub(1)]);
        let t =
            if to.0 > from.0 { ((far - from.0) / (to.0 - from.0)).clamp(0.0, 1.0) } else { 1.0 };
        from.1 + (to.1 - from.1) * t
    }
}

/// Whether a line of steps crosses itself, except where an outline closes with overshooting ends, or where the hand
/// trembles.
fn crosses(line: &[Vec2], step: f32, rho: f32) -> bool {
    let near = (2.0 * rho / step).ceil() as usize;
    let count = line.len() - 1;
    let side = |a: Vec2, b: Vec2, p: Vec2| (b - a).perp_dot(p - a);
    (0..count).any(|i| {
        (i + 2..count).any(|j| {
            let (a, b, c, d) = (line[i], line[i + 1], line[j], line[j + 1]);
            let crossed =
                side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            let closes = i <= near && count - 1 - j <= near;
            crossed && !closes && j - i > near / 2
        })
    })
}

/// An outline by arc length, pixels.
struct Around {
    points: Vec<Vec2>,
    lengths: Vec<f32>,
}

impl Around {
    fn new(points: Vec<Vec2>) -> Self {
        let mut lengths = vec![0.0f32];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
        }
        Self { points, lengths }
    }

    fn whole(&self) -> f32 {
        self.lengths[self.lengths.len() - 1]
    }

    fn at(&self, far: f32) -> Vec2 {
        let last = self.points.len() - 1;
        let k = self.lengths.partition_point(|at| *at < far).min(last);
        let from = k.saturating_sub(1);
        let length = self.lengths[k] - self.lengths[from];
        let t = if length > 0.0 { (far - self.lengths[from]) / length } else { 1.0 };
        self.points[from].lerp(self.points[k], t.clamp(0.0, 1.0))
    }

    /// Both sides at the same fraction of their lengths, from the root to a far end.
    fn pair(&self, far_end: f32, t: f32) -> (Vec2, Vec2) {
        let whole = self.whole();
        (self.at(t * far_end), self.at(whole - t * (whole - far_end)))
    }

    /// Position of the far end: among points far from the root, the one where both sides, compared with each other, are
    /// closest, so that a bent band ends at the middle of its end and not at its outer corner.
    fn far_end(&self, root: Vec2) -> f32 {
        let off = |i: usize| self.points[i].distance(root);
        let farthest = (0..self.points.len()).map(off).fold(0.0, f32::max);
        let cost = |i: usize| {
            let apart = |k: u8| {
                let (a, b) = self.pair(self.lengths[i], f32::from(k) / 32.0);
                a.distance_squared(b)
            };
            (1..32).map(apart).sum::<f32>() / off(i)
        };
        let far = (0..self.points.len()).filter(|i| off(*i) >= FAR * farthest);
        let costs = far.map(|i| (i, cost(i)));
        let best = costs.min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or(0.0, |(i, _)| self.lengths[i])
    }
}

#[cfg(test)]
mod tests {
    use super::super::hair_sketch::resolved;
    use super::super::laws::{drawn, line, points, sketch_on};
    use super::*;
    use crate::data::attributes::RADIUS;
    use crate::data::curves::{Curves, Tuft};
    use crate::data::gestures::{Layer, Tool};
    use crate::data::scalp::tests::shared_ball;
    use crate::maths::transcendental::sin_cos;
    use crate::testing::{curves_of, run};

    /// From a root on the ball down to 8 cm below it and back, with the half-width given as a function of the fraction
    /// of the way, pixels.
    fn outline(wide: impl Fn(f32) -> f32) -> Vec<Vec2> {
        let side = |k: i32, sign: f32| {
            let t = k as f32 / 60.0;
            Vec2::new(sign * wide(t), -150.0 + 400.0 * t)
        };
        let there = (0..=60).map(|k| side(k, -1.0));
        there.chain((0..=60).rev().map(|k| side(k, 1.0))).collect()
    }

    /// Half as wide as 2 cm at the depth of the ball's front: a pixel 51 cm away is 0.0255 cm.
    fn leaf(t: f32) -> f32 {
        78.0 * sin_cos(std::f32::consts::PI * t).0
    }

    fn radii(tuft: &Tuft) -> Vec<f32> {
        (0..tuft.points().len()).map(|k| tuft.view(RADIUS).at(0, k)).collect()
    }

    fn only(stroke: &[Vec2]) -> Curves {
        let outline = drawn(Tool::Silhouette, Layer::Scalp, stroke);
        let (curves, said) = sketch_on(&shared_ball(), None, &[outline]);
        assert!(said.is_empty() && curves.curve_count() == 1, "{said:?}");
        curves
    }

    fn seen() -> Seen {
        let view = drawn(Tool::Comb, Layer::Scalp, &[Vec2::ZERO]).view;
        Seen::new(&view, shared_ball().frame())
    }

    #[test]
    fn a_leaf_of_two_cm_to_each_side_gives_strands_within_it() {
        let curves = only(&outline(leaf));
        let tuft = &curves.tufts()[0];
        let radii = radii(tuft);
        let widest = radii.iter().copied().fold(0.0, f32::max);
        assert!((1.85..2.05).contains(&widest), "{radii:?}");
        // A point at its tip; at its root as wide as half a segment further.
        let last = radii.len() - 1;
        assert!(radii[last] < 0.05 && radii[0] > 0.15 && radii[0] < radii[1], "{radii:?}");
        let set = [("curves", curves.into()), ("scalp", shared_ball().into())];
        let hair = run(crate::by_id("cluster_to_strands").unwrap(), &set).0;
        let (mut count, mut beside) = (0, 0.0f32);
        for (tuft, i) in curves_of(&hair[0]).each() {
            let cvs = tuft.curve(i);
            // (Past the root, whose disc is not a point.)
            for p in &cvs[cvs.len() / 8 + 1..] {
                let at = seen().pixel(*p).unwrap();
                beside = beside.max(at.x.abs() - leaf(((at.y + 150.0) / 400.0).clamp(0.0, 1.0)));
            }
            count += 1;
        }
        // Between CVs 2 cm apart the radius is linear, and the leaf is not.
        assert!(count > 20 && beside < 8.0, "{count} {beside}");
    }

    #[test]
    fn an_outline_of_constant_width_gives_a_constant_radius_in_its_depth() {
        #[track_caller]
        fn check(stroke: &[Vec2], half: f32) {
            let curves = only(stroke);
            let tuft = &curves.tufts()[0];
            for (p, radius) in tuft.points().iter().zip(radii(tuft)) {
                let wanted = half * seen().cm_per_pixel(seen().depth(*p));
                assert!((radius - wanted).abs() < 0.1 * wanted, "{radius}, not {wanted}");
            }
        }
        check(&outline(|_| 30.0), 30.0);
        // A band of a circle, 40 wide: a quarter turn around a point beside the root, out along one side and back along
        // the other.
        let band = |k: i32, radius: f32| {
            let (sin, cos) = sin_cos(std::f32::consts::FRAC_PI_2 * k as f32 / 60.0);
            Vec2::new(-200.0 + radius * cos, -150.0 + radius * sin)
        };
        let there = (0..=60).map(|k| band(k, 220.0));
        let stroke: Vec<Vec2> = there.chain((0..=60).rev().map(|k| band(k, 180.0))).collect();
        check(&stroke, 20.0);
    }

    #[test]
    fn what_is_no_outline_is_told_and_makes_nothing() {
        #[track_caller]
        fn check(stroke: &[Vec2], expected: &str) {
            let outline = drawn(Tool::Silhouette, Layer::Scalp, stroke);
            let (none, said) = sketch_on(&shared_ball(), None, &[outline]);
            assert!(none.curve_count() == 0, "{expected}");
            assert!(said.len() == 1 && said[0].contains(expected), "{said:?}");
        }
        let whole = outline(leaf);
        check(&whole[..80], "it is not closed");
        check(&whole.iter().map(|p| *p * 0.05).collect::<Vec<_>>(), "smaller than the pen reaches");
        check(&[Vec2::ZERO], "smaller than the pen reaches");
        // An eight.
        let eight = outline(|t| 60.0 * sin_cos(std::f32::consts::TAU * t).0);
        check(&eight, "it crosses itself");
        let there = [line([0.0, -150.0], [0.0, 200.0]), line([0.0, 200.0], [0.0, -150.0])].concat();
        check(&there, "it has no width");
        let beside: Vec<Vec2> = whole.iter().map(|p| *p + Vec2::new(900.0, 0.0)).collect();
        check(&beside, "it begins beside the head");
    }

    #[test]
    fn a_silhouette_replays_as_it_was_drawn_and_keeps_its_radii_when_combed_and_cut() {
        let scalp = shared_ball();
        let one = drawn(Tool::Silhouette, Layer::Scalp, &outline(leaf));
        let after = only(&outline(leaf));
        let kept = resolved(&one, &Curves::default(), &after, &scalp);
        assert!(kept.root.is_some() && kept.path.len() + 1 == radii(&after.tufts()[0]).len());
        let (again, said) = sketch_on(&scalp, None, std::slice::from_ref(&kept));
        assert!(said.is_empty(), "{said:?}");
        let (a, b) = (points(&after), points(&again));
        for ((id, a), (other, b)) in a.iter().zip(&b) {
            let off = a.iter().zip(b).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            assert!(id == other && a.len() == b.len() && off < 1e-4, "{off}");
        }
        let (was, is) = (radii(&after.tufts()[0]), radii(&again.tufts()[0]));
        assert!(was.iter().zip(&is).all(|(a, b)| (a - b).abs() < 1e-4), "{was:?} {is:?}");
        // The comb moves CVs, and each keeps its radius; the cut ends in the middle, where it is widest.
        let comb = drawn(Tool::Comb, Layer::Through, &line([0.0, 60.0], [120.0, 60.0]));
        let cut = drawn(Tool::Cut, Layer::Through, &line([-250.0, 50.0], [250.0, 50.0]));
        let (combed, said) = sketch_on(&scalp, None, &[kept.clone(), comb]);
        let kept_radii = radii(&combed.tufts()[0]);
        assert!(said.is_empty() && points(&combed) != b, "{said:?}");
        assert!(is.iter().all(|radius| kept_radii.contains(radius)), "{kept_radii:?}");
        // The pen grabs it by its flank, 1.5 cm off its centre where it is 2 wide, and a half at its root.
        let flank = drawn(Tool::Comb, Layer::Nearest, &line([60.0, 50.0], [-90.0, 50.0]));
        let (taken, said) = sketch_on(&scalp, None, &[kept.clone(), flank]);
        assert!(said.is_empty() && points(&taken) != b, "{said:?}");
        let (short, said) = sketch_on(&scalp, None, &[kept, cut]);
        assert!(said.is_empty(), "{said:?}");
        let left = radii(&short.tufts()[0]);
        assert!(
            left.len() < is.len() && left[left.len() - 1] > 1.8 && left[1] == is[1],
            "{left:?}"
        );
    }
}
