//! Tail: hair held by a tie continues past it and hangs.
//!
//! Guarantees: roots stay, and so does the path to the tie; no point below the skin; a hair keeps its place across the
//! tail. Not promised: that a tail rests on other hair; use `clearance` for that.

use super::bundle::{Bundle, Course, MOST_LOCKS, STEP};
use super::tie::Tie;
use crate::data::curves::Curves;
use crate::data::ramp::{Blend, Ramp};
use crate::data::route::makers::lift;
use crate::data::scalp::{Scalp, Skin};
use crate::define::{NodeError, node};
use crate::eval::EvalCx;
use crate::maths::transcendental::{sin_cos, sin_cos_turns};
use std::sync::Arc;

node! {
    /// Lets gathered hair hang from its tie: ponytails and pigtails.
    ///
    /// Each hair continues from where it left the tie, falls in an arch and hangs beside the others, resting on head,
    /// neck and shoulders. Wire it after Gather into tie.
    "tail", version 1, label "Tail", words "ponytail pony tail pigtail bunches hang gravity fall swing updo", scales;
    inputs {
        /// Hair gathered in ties.
        curves: Curves;
        /// The ties that hold it.
        ties: Curves;
        /// The head that the tail rests on.
        scalp: Arc<Scalp>;
        /// Length beyond the tie.
        length: f32 = 35.0, hard(0.5, 200.0), soft(5.0, 80.0), unit(Length), handle(Handle::Length);
        /// Thickness along the tail, from tie to tip, as a multiple of the tie's.
        profile: Arc<Ramp> = profile(), hard(0.0, 100.0), soft(0.0, 2.0), words("taper fullness shape");
        /// How much earlier hair from farther away ends: 1 gives all hair the same total length, 0 cuts the tail level.
        layers: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("cut taper length");

        [Shape]
        /// Radius of the arch in which the tail falls. A large arch stands off farther before it hangs.
        arch: f32 = 3.0, hard(0.2, 100.0), soft(1.0, 12.0), unit(Length), words("gravity stiffness lift bounce");
        /// How far the tail swings to the head's left from hanging straight down; negative is right.
        swing: f32 = 0.0, hard(-80.0, 80.0), soft(-30.0, 30.0), unit(Angle), words("sway motion move");
        /// How far the tail swings back from hanging straight down; negative is forward.
        swing_back: f32 = 0.0, hard(-80.0, 80.0), soft(-30.0, 30.0), unit(Angle), words("sway motion move");
        /// Sideways amplitude of the tail's soft S.
        sway: f32 = 0.0, hard(0.0, 20.0), soft(0.0, 4.0), unit(Length), words("s curve wave movement");
        /// Length of one full S.
        sway_length: f32 = 28.0, hard(1.0, 200.0), soft(8.0, 60.0), unit(Length), words("s curve wave movement");
        /// Smallest height of the tail's centre above the skin, in its own radii there.
        clearance: f32 = 0.8, hard(0.0, 10.0), soft(0.3, 2.0), words("collide rest head neck shoulders");
        /// Twist of the tail about itself.
        twist: f32 = 0.0, hard(-90.0, 90.0), soft(-20.0, 20.0), unit(AnglePerCm), words("rope turn");

        [Clumping]
        /// Number of locks that the tail splits into; 0: none.
        locks: i64 = 40, hard(0.0, 400.0), soft(0.0, 120.0), unit(Count), words("clumps wisps strands");
        /// How closely the hairs of a lock converge at its tip.
        clump: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("clumping tip wisps");

        [Detail]
        /// CVs per hair, root and tip included.
        points: i64 = 60, hard(8.0, 250.0), soft(16.0, 120.0), unit(Count), words("cvs resolution segments");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// Random shortening of locks and hairs.
        uneven: f32 = 0.25, hard(0.0, 0.95), unit(Ratio), words("length variation taper random");
        /// Largest random offset of locks and hairs from their path.
        loose: f32 = 0.25, hard(0.0, 10.0), soft(0.0, 1.5), unit(Length), words("frizz messy natural");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The hair from root to tip. Its parents are the locks.
        curves: Curves;
    }
}

fn profile() -> Ramp {
    let stops = vec![(0.0, 1.0), (0.2, 1.7), (0.55, 1.7), (1.0, 0.5)];
    Ramp::new(Blend::Smooth, stops).unwrap_or_else(|_| Ramp::constant(1.0))
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let skin = cx.skin(scalp);
    let ties = Tie::all(cx, scalp, &inputs.ties);
    let hung = ties.into_iter().map(|tie| (tie, hang(&inputs, skin, cx.unit(), &tie)));
    let bundle = Bundle {
        ties: hung.collect(),
        skin,
        length: inputs.length,
        layers: inputs.layers,
        uneven: inputs.uneven,
        profile: &inputs.profile,
        twist: inputs.twist,
        locks: inputs.locks.min(MOST_LOCKS) as usize,
        clump: inputs.clump,
        loose: inputs.loose,
        points: inputs.points as usize,
        dice: cx.dice(inputs.seed, "tail"),
        seed: inputs.seed,
    };
    Ok(Outputs { curves: bundle.go_on(cx, &inputs.curves)? })
}

/// Centre line of a tail: out of the tie along its axis, then down in an arch, out of the skin by a fraction of its own
/// thickness.
fn hang(inputs: &Inputs, skin: Skin, unit: f32, tie: &Tie) -> Course {
    let frame = inputs.scalp.frame();
    let length = inputs.length;
    let steps = ((length / STEP).ceil() as usize).clamp(2, 4000);
    let step = length / steps as f32;
    let ((side, across), (back, _)) =
        (sin_cos(inputs.swing.to_radians()), sin_cos(inputs.swing_back.to_radians()));
    let down =
        (-frame.up * across + frame.right * side - frame.forward * back).normalize_or(-frame.up);
    let mut p = tie.top();
    let mut direction = tie.axis;
    let mut points = vec![p];
    for k in 0..steps {
        let u = (k + 1) as f32 / steps as f32;
        let turn = (down - direction * down.dot(direction)) * (step / inputs.arch);
        // A tail that stands straight up has no direction to fall in: it falls back.
        let turn = if turn.length_squared() < 1e-9 && down.dot(direction) < 0.0 {
            -frame.forward * (step / inputs.arch)
        } else {
            turn
        };
        direction = (direction + turn).normalize_or(down);
        let height = inputs.clearance * tie.radius * inputs.profile.at(u);
        // Close to the tie, the tail stays at the tie's height, however thick it gets.
        let height = height.min(0.8 * tie.height + 0.5 * step * k as f32);
        let next = p + direction * step;
        let (lifted, moved) = lift(&skin, next, height);
        if moved && let Some(along) = (lifted - p).try_normalize() {
            direction = direction.lerp(along, 0.7).normalize_or(along);
        }
        p = p + (lifted - p).normalize_or(direction) * step;
        points.push(p);
    }
    if inputs.sway > 0.0 {
        for (k, p) in points.iter_mut().enumerate() {
            let s = step * k as f32;
            let free = (s / (6.0 * unit)).min(1.0);
            let wave = sin_cos_turns(s / inputs.sway_length).0;
            *p += frame.right * (wave * inputs.sway * free * free);
        }
    }
    Course::new(tie, &points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{FIBRE, PARENT, PUFF, ROOT_TRIANGLE};
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::testing::{curves_of, run};
    use glam::Vec3;
    use std::collections::BTreeSet;

    fn gathered() -> (Curves, Curves) {
        let (out, _) = run(
            crate::by_id("gather").unwrap(),
            &[("scalp", shared_ball().into()), ("density", Value::Float(3.0))],
        );
        (curves_of(&out[0]).clone(), curves_of(&out[1]).clone())
    }

    /// Base, result, and messages.
    fn went_on(node: &str, set: &[(&str, Value)]) -> (Curves, Curves, Vec<String>) {
        let (hair, ties) = gathered();
        let given = [
            ("curves", hair.clone().into()),
            ("ties", ties.into()),
            ("scalp", shared_ball().into()),
        ];
        let (out, said) = run(crate::by_id(node).unwrap(), &[&given, set].concat());
        (hair, curves_of(&out[0]).clone(), said)
    }

    fn to_link(p: Vec3, a: Vec3, b: Vec3) -> f32 {
        p.distance(crate::maths::nearest_on([a, b], p).0)
    }

    #[track_caller]
    fn check_laws(node: &str, set: &[(&str, Value)]) -> Curves {
        let (hair, out, _) = went_on(node, set);
        let scalp = shared_ball();
        assert_eq!(hair.curve_count(), out.curve_count());
        for ((a, i), (b, j)) in hair.each().zip(out.each()) {
            assert_eq!((a.id(i), a.view(PUFF).at(i, 0)), (b.id(j), b.view(PUFF).at(j, 0)));
            assert_eq!(a.view(ROOT_TRIANGLE).at(i, 0), b.view(ROOT_TRIANGLE).at(j, 0));
            let (base, whole) = (a.curve(i), b.curve(j));
            assert_eq!(base[0], whole[0]);
            // On the way to the tie, and evenly.
            let held: f32 = base.windows(2).map(|w| w[0].distance(w[1])).sum();
            let mut s = 0.0;
            for w in whole.windows(2) {
                s += w[0].distance(w[1]);
                if s > 0.93 * held {
                    break;
                }
                let off = base.windows(2).map(|l| to_link(w[1], l[0], l[1])).fold(9.0, f32::min);
                assert!(off < 0.08, "{off}");
            }
            let deepest = whole.iter().map(|p| scalp.skin().distance(*p)).fold(1.0, f32::min);
            assert!(deepest > -1e-3 && whole.iter().all(|p| p.is_finite()), "{deepest}");
            let length: f32 = whole.windows(2).map(|w| w[0].distance(w[1])).sum();
            assert!((b.view(FIBRE).at(j, 0) - length).abs() < 1e-3 * length);
        }
        out
    }

    #[test]
    fn a_tail_keeps_the_way_to_its_tie_and_hangs_outside_the_head() {
        let out = check_laws("tail", &[]);
        let locks: BTreeSet<u64> = out.each().map(|(t, i)| t.view(PARENT).at(i, 0)).collect();
        assert!((20..=40).contains(&locks.len()), "{}", locks.len());
        let lowest = out.each().map(|(t, i)| t.curve(i).last().unwrap().y).fold(99.0, f32::min);
        assert!(lowest < -15.0, "{lowest}");
        let wild = [
            ("swing", Value::Float(-50.0)),
            ("sway", Value::Float(5.0)),
            ("arch", Value::Float(0.3)),
        ];
        check_laws("tail", &wild);
        check_laws("tail", &[("locks", Value::Int(0)), ("clearance", Value::Float(0.0))]);
    }

    #[test]
    fn a_tail_of_one_width_without_wandering_keeps_every_hair_in_its_place() {
        let (hair, out, _) = went_on(
            "tail",
            &[
                ("locks", Value::Int(0)),
                ("loose", Value::Float(0.0)),
                ("clump", Value::Float(0.0)),
                ("uneven", Value::Float(0.0)),
                ("layers", Value::Float(0.0)),
                ("profile", Ramp::constant(1.0).into()),
            ],
        );
        // As far apart at the tip as in the tie.
        let ends =
            |c: &Curves| c.each().map(|(t, i)| *t.curve(i).last().unwrap()).collect::<Vec<_>>();
        let (tie, tip) = (ends(&hair), ends(&out));
        for k in (0..tie.len() - 1).step_by(7) {
            let (a, b) = (tie[k].distance(tie[k + 1]), tip[k].distance(tip[k + 1]));
            assert!((a - b).abs() < 0.02 + 0.02 * a, "{a} {b}");
        }
    }

    #[test]
    fn a_bun_lies_round_its_tie() {
        let out = check_laws("bun", &[]);
        let (_, ties) = gathered();
        let foot = ties.tufts()[0].points()[0];
        for (tuft, i) in out.each() {
            let past = &tuft.curve(i)[60..];
            let far = past.iter().map(|p| p.distance(foot)).fold(0.0, f32::max);
            assert!(far < 9.0, "{far}");
        }
        check_laws(
            "bun",
            &[("turns", Value::Float(3.0)), ("hand", "right".into()), ("rise", Value::Float(0.8))],
        );
    }

    #[test]
    fn hair_of_no_tie_stays_and_is_said() {
        let (hair, _) = gathered();
        let set = [
            ("curves", hair.clone().into()),
            ("ties", Curves::default().into()),
            ("scalp", shared_ball().into()),
        ];
        let (out, said) = run(&NODE, &set);
        let same = |a: (&crate::data::curves::Tuft, usize),
                    b: (&crate::data::curves::Tuft, usize)| {
            a.0.curve(a.1) == b.0.curve(b.1)
        };
        assert!(hair.each().zip(curves_of(&out[0]).each()).all(|(a, b)| same(a, b)));
        assert_eq!(said.len(), 1);
    }
}
