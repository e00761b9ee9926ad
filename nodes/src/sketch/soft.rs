//! Soft selection: what a gesture does to the curves that it takes, curves around them do along, the less the farther they are.
//!
//! Guarantees: without a size, and for tools that have none, only what is taken acts; what is taken acts in full; a curve farther
//! than the size in space, or hidden by the head, does not; where the gesture names curves, no other follows, so that a replay acts
//! on the same curves by the same shares.

use super::brush::falloff;
use super::hand::{GestureContext, SketchState};
use super::lock::Lock;
use glam::Vec3;
use std::collections::BTreeSet;

impl GestureContext<'_> {
    /// How far a point goes along with what is taken at `centre`, 0 to 1.
    pub(super) fn share(&self, centre: Vec3, p: Vec3) -> f32 {
        let size = self.gesture.size * self.seen.cm_per_pixel(self.seen.depth(centre));
        if size > 0.0 { falloff(p.distance(centre), size) } else { 0.0 }
    }

    /// Curves that the gesture acts on, each with its share: those that `under` takes have 1; others within its size, by how far
    /// their `place`, which the tool takes hold of, is from that of one of these. Those that are taken come first.
    pub(super) fn takes_around(
        &self,
        sketch: &mut SketchState,
        under: impl Fn(&Self, &SketchState) -> Vec<usize>,
        nothing: &str,
        place: impl Fn(&Lock) -> Option<Vec3>,
    ) -> Vec<(usize, f32)> {
        let all = self.takes(sketch, &under, nothing);
        if !(self.gesture.size > 0.0 && self.gesture.tool.is_soft()) {
            return all.into_iter().map(|i| (i, 1.0)).collect();
        }
        let named = !self.gesture.curves.is_empty();
        let mut first = match named {
            true => under(self, sketch).into_iter().filter(|i| all.contains(i)).collect(),
            false => all.clone(),
        };
        if first.is_empty() {
            // Of the named ones that which is nearest to the pen.
            let off = |i: &usize| {
                let at = self.seen.pixel(place(&sketch.locks[*i])?)?;
                Some((*i, at.distance(self.start())))
            };
            let nearest = all.iter().filter_map(off).min_by(|a, b| a.1.total_cmp(&b.1));
            first.extend(nearest.map(|(i, _)| i));
        }
        let centres: Vec<Vec3> = first.iter().filter_map(|i| place(&sketch.locks[*i])).collect();
        let taken: BTreeSet<usize> = first.iter().copied().collect();
        let others: Vec<usize> = match named {
            true => all,
            false => (0..sketch.locks.len()).filter(|i| sketch.locks[*i].is_curve()).collect(),
        };
        let follows = |i: usize| {
            let p = place(&sketch.locks[i])?;
            let share = centres.iter().map(|centre| self.share(*centre, p)).fold(0.0, f32::max);
            (share > 0.0 && self.seen.sees(self.scalp, p)).then_some((i, share))
        };
        let follow = others.into_iter().filter(|i| !taken.contains(i)).filter_map(follows);
        let follow: Vec<(usize, f32)> = follow.collect();
        let out: Vec<(usize, f32)> = first.into_iter().map(|i| (i, 1.0)).chain(follow).collect();
        sketch.now.picked = out.len();
        out
    }

    /// The CV of a curve that is nearest to the pen's start.
    pub(super) fn place_at_start(&self, lock: &Lock) -> Option<Vec3> {
        self.nearest_cv(lock).map(|(k, _)| lock.points[k])
    }
}

#[cfg(test)]
mod tests {
    use super::super::hair_sketch::resolved;
    use super::super::laws::{circle, drawn, length, line, sketch_on};
    use crate::data::attributes::{DENSITY, FRIZZ, ROLL};
    use crate::data::curves::Curves;
    use crate::data::gestures::{Gesture, Layer, Tool};
    use crate::data::scalp::tests::shared_ball;
    use crate::maths::transcendental::sin_cos;
    use glam::{Vec2, Vec3};

    /// Clusters down the front of the ball, so many pixels to the right of its middle.
    fn clusters() -> Vec<Gesture> {
        let at = |(id, x): (u64, f32)| {
            let implant = drawn(Tool::Implant, Layer::Scalp, &line([x, -150.0], [x, 250.0]));
            Gesture { id, ..implant }
        };
        (1..).zip([0.0, 50.0, 230.0]).map(at).collect()
    }

    fn sketch(gestures: &[Gesture]) -> (Curves, Vec<String>) {
        sketch_on(&shared_ball(), None, gestures)
    }

    /// How much a tool changed each curve, in the order in which they were planted.
    fn changes(tool: Tool, was: &Curves, is: &Curves) -> Vec<f32> {
        let number = |curves: &Curves, i: usize| {
            let tuft = &curves.tufts()[i];
            match tool {
                Tool::Lengthen => length(tuft.points()),
                Tool::Cut => -length(tuft.points()),
                Tool::Twist => tuft.view(ROLL).at(0, tuft.points().len() - 1),
                Tool::Frizz => tuft.view(FRIZZ).at(0, 0),
                _ => tuft.view(DENSITY).at(0, 0),
            }
        };
        let moved = |i: usize| {
            let pairs = was.tufts()[i].points().iter().zip(is.tufts()[i].points());
            pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
        };
        let tip = |curves: &Curves, i: usize| *curves.tufts()[i].points().last().unwrap();
        let change = |i| match tool {
            Tool::Point => moved(i),
            Tool::Redraw => tip(was, i).distance(tip(is, i)),
            _ => number(is, i) - number(was, i),
        };
        (0..was.tufts().len()).map(change).collect()
    }

    #[test]
    fn curves_around_follow_within_the_size_the_less_the_farther_and_so_does_a_replay() {
        let planted = clusters();
        let (was, _) = sketch(&planted);
        let seen = super::super::seen::Seen::new(&planted[0].view, shared_ball().frame());
        let at = |k: usize| seen.pixel(was.tufts()[0].points()[k]).unwrap();
        let tip = at(was.tufts()[0].points().len() - 1);
        let twirl = (0..=120).map(|k| {
            let t = k as f32 / 120.0;
            let (sin, cos) = sin_cos(std::f32::consts::TAU * 3.3 * t);
            Vec2::new(12.0 * sin, 30.0 * t - 12.0 * cos)
        });
        let saw = (0..72).map(|k| {
            let swing = ((k % 16) as f32 / 8.0 - 1.0).abs() * 80.0 - 40.0;
            Vec2::new(-0.9 * swing, 0.5 * k as f32)
        });
        let (low, high) = (at(3), at(2));
        let strokes: [(Tool, Vec<Vec2>); 7] = [
            (Tool::Point, line(at(4).into(), [at(4).x - 40.0, at(4).y])),
            (Tool::Lengthen, line(tip.into(), [tip.x - 10.0, tip.y + 120.0])),
            (Tool::Twist, twirl.collect()),
            (Tool::Frizz, saw.collect()),
            (Tool::Density, circle([0.0, 20.0], 30.0, 4.0)),
            (Tool::Cut, line([low.x - 80.0, low.y], [low.x + 45.0, low.y])),
            (Tool::Redraw, line(high.into(), [high.x - 120.0, high.y + 160.0])),
        ];
        for (tool, stroke) in strokes {
            let alone = Gesture { id: 50, ..drawn(tool, Layer::Nearest, &stroke) };
            let (only, said) = sketch(&[&planted[..], std::slice::from_ref(&alone)].concat());
            let first = changes(tool, &was, &only);
            assert!(
                first[0] > 0.01 && first[1] == 0.0 && first[2] == 0.0,
                "{tool:?}: {first:?} {said:?}"
            );
            let soft = Gesture { size: 110.0, ..alone };
            let (live, said) = sketch(&[&planted[..], std::slice::from_ref(&soft)].concat());
            let all = changes(tool, &was, &live);
            assert!((all[0] - first[0]).abs() < 1e-4, "{tool:?}: {all:?} of {first:?} {said:?}");
            let share = all[1] / all[0];
            assert!((0.05..0.95).contains(&share) && all[2] == 0.0, "{tool:?}: {all:?}");
            // With the curves that it changed, it acts on the same again.
            let kept = resolved(&soft, &was, &live, &shared_ball());
            assert_eq!(kept.curves.len(), 2, "{tool:?}");
            let (again, said) = sketch(&[&planted[..], std::slice::from_ref(&kept)].concat());
            assert!(said.is_empty(), "{tool:?}: {said:?}");
            let far = |i: usize| {
                let pairs = live.tufts()[i].points().iter().zip(again.tufts()[i].points());
                pairs.map(|(a, b): (&Vec3, &Vec3)| a.distance(*b)).fold(0.0, f32::max)
            };
            assert!((0..3).all(|i| far(i) < 2e-3), "{tool:?}: {} {}", far(0), far(1));
            // Of what it names one alone, the other is not touched.
            let named = Gesture { curves: vec![was.tufts()[0].id(0)], ..kept };
            let (one, _) = sketch(&[&planted[..], &[named]].concat());
            let one = changes(tool, &was, &one);
            assert!((one[0] - all[0]).abs() < 2e-3 && one[1] == 0.0, "{tool:?}: {one:?}");
        }
    }
}
