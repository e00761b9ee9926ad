//! A node as anyone adds one who moves hair, and the laws that hold for it without its doing.

use super::{Bench, faults};
use crate::data::attributes::{Domain, ID};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::route::Policy;
use crate::data::route::bundle::{Bend, Hairs, Wish};
use crate::data::scalp::tests::shared_ball;
use crate::data::scalp::{HEAD_RADIUS, HeadFrame, REGION, Scalp};
use crate::define::{NodeError, Value, node};
use crate::eval::{EvalCx, TracedScalp};
use crate::maths::closest::tests::sphere;
use crate::maths::hash::Dice;
use crate::maths::lanes::{Simd, Vec3x8};
use crate::testing::{curves_of, run};
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Moves every point of hair anywhere.
    "nudge", version 1, label "Nudge", words "test", scales;
    inputs {
        /// Hair to change.
        curves: Curves;
        /// Head that the hair stays out of.
        scalp: Option<TracedScalp>;
        /// The most by which a point is moved along each axis.
        far: f32 = 20.0, hard(0.0, 100.0), unit(Length);
        /// Keep the length of every segment.
        keep_length: bool = true;
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;
        /// Random seed for this node.
        seed: i64 = 0;
    }
    outputs {
        /// The hair, moved.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let dice = cx.dice(inputs.seed, "nudge");
    let placed = cx.by_place(inputs.scalp.as_ref());
    let [curves] = placed.each_tuft(&inputs.curves, |tuft, piece| {
        let route = piece.route(Policy::keep_length(inputs.keep_length));
        Ok([piece.bend(&route, tuft, &mut Nudge { dice, far: inputs.far })?])
    })?;
    Ok(Outputs { curves })
}

struct Nudge {
    dice: Dice,
    far: f32,
}

impl Bend for Nudge {
    #[inline(always)]
    fn bend<S: Simd>(&mut self, hairs: &Hairs<S>, wish: &mut Wish<S>) {
        for k in 0..hairs.len() {
            let by = |a: u64| hairs.ids.map(|id| self.dice.signed(id, 3 * k as u64 + a));
            let [x, y, z] = [0, 1, 2].map(|a| hairs.s.load_array_f32x8(by(a)));
            wish.set(k, wish.get(k) + Vec3x8 { x, y, z } * hairs.s.splat_f32x8(self.far));
        }
    }
}

fn nudged(hair: &Curves, set: &[(&'static str, Value)]) -> Curves {
    let given = [("curves", Value::from(hair.clone()))];
    curves_of(&run(&NODE, &[&given[..], set].concat()).0[0]).clone()
}

/// Hair of all makers that is moved anywhere on a head obeys, and keeps its roots, ids and what is known of it.
pub(super) fn check(bench: &Bench, broken: &mut Vec<String>) {
    let hair = bench.hair();
    assert!(hair.curve_count() > 300, "{}: {}", bench.name, hair.curve_count());
    for (far, keep) in [(20.0, true), (20.0, false), (0.5, true)] {
        let on = ("scalp", Value::from(bench.scalp.clone()));
        let set = [on, ("far", Value::Float(far)), ("keep_length", keep.into())];
        let after = nudged(&hair, &set);
        let what = format!("{}, {far} cm, lengths kept: {keep}", bench.name);
        let found = faults(&bench.scalp, &after);
        broken.extend(found.iter().map(|(law, count)| format!("{what}: {count} hairs {law}")));
        let mut moved = 0;
        for ((a, i), (b, j)) in hair.each().zip(after.each()) {
            let (old, new) = (a.curve(i), b.curve(j));
            assert_eq!((old[0], old.len(), a.id(i)), (new[0], new.len(), b.id(j)), "{what}");
            assert_eq!(a.attributes().len(), b.attributes().len(), "{what}");
            moved += usize::from(old != new);
        }
        println!("{what}: {moved} of {}", hair.curve_count());
        // Wished up to 20 cm off, most pieces lead through the head, on ways that nothing clears.
        assert!(moved * 12 > hair.curve_count(), "{what}: {moved} moved");
    }
}

/// Straight hairs in the air over the ball, on a head so many times as large.
fn over(times: f32) -> Curves {
    let mut b = TuftBuilder::new();
    for i in 0..200 {
        let root = Vec3::new(0.1 * i as f32 - 10.0, 14.0, 0.07 * i as f32) * times;
        let at = |k: u32| root + Vec3::new(0.1, 1.0, 0.0) * (0.5 * times * k as f32);
        b.push_curve(&(0..12).map(at).collect::<Vec<_>>());
    }
    b.set(ID, Domain::Curve, (1..=200).collect());
    Curves::new(vec![b.build().into()])
}

#[test]
fn lengths_are_kept_and_a_head_twice_as_large_moves_hair_twice_as_far() {
    let surface = sphere(2.0 * HEAD_RADIUS, 48);
    let region = surface.points.iter().map(|p| f32::from(p.y > 0.0)).collect();
    let frame = HeadFrame { radius: 2.0 * HEAD_RADIUS, ..HeadFrame::IDENTITY };
    let large = Arc::new(Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into()));
    for keep in [true, false] {
        let on = |scalp: Arc<Scalp>| {
            [("scalp", scalp.into()), ("keep_length", keep.into()), ("far", Value::Float(3.0))]
        };
        let small = nudged(&over(1.0), &on(shared_ball()));
        let large = nudged(&over(2.0), &on(large.clone()));
        for ((a, i), (b, _)) in small.each().zip(large.each()) {
            let twice: Vec<Vec3> = a.curve(i).iter().map(|p| *p * 2.0).collect();
            assert_eq!(twice, b.curve(i));
            for w in a.curve(i).windows(2).filter(|_| keep) {
                let was = 0.5 * 1.01f32.sqrt();
                assert!((w[0].distance(w[1]) / was - 1.0).abs() < 1e-4, "{w:?}");
            }
        }
    }
}
