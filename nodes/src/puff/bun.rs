//! Bun: winds hair held by a tie around the tie.
//!
//! Guarantees: roots stay, and so does the path to the tie; no point below the skin; a hair keeps its place across the
//! coil; the end is tucked under it. Not promised: that turns do not press into each other.

use super::bundle::{Bundle, Course, MOST_LOCKS, STEP};
use super::tie::Tie;
use crate::data::curves::Curves;
use crate::data::ramp::{Blend, Ramp};
use crate::data::scalp::Scalp;
use crate::define::{NodeError, choice, node};
use crate::eval::EvalCx;
use crate::maths::smoothstep;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;
use std::f32::consts::TAU;
use std::sync::Arc;

node! {
    /// Winds gathered hair around its tie into a bun, with the ends tucked under.
    ///
    /// Wire it after Gather into tie. Turns and thickness determine the length of hair it takes; a message reports that
    /// length.
    "bun", version 1, label "Bun", words "bun chignon top knot coil wound wrap updo space buns ballet", scales;
    inputs {
        /// Hair gathered in ties.
        curves: Curves;
        /// The ties that hold it.
        ties: Curves;
        /// The head that the bun sits on.
        scalp: Arc<Scalp>;
        /// Turns around the tie.
        turns: f32 = 1.6, hard(0.5, 8.0), soft(1.0, 4.0), words("coil wind wrap");
        /// Radius of the wound hair.
        thickness: f32 = 1.5, hard(0.1, 10.0), soft(0.5, 3.0), unit(Length), handle(Handle::Radius), words("radius girth rope");
        /// Direction of winding, seen from the top of the bun.
        hand: Hand = Hand::Left, words("direction clockwise");

        [Shape]
        /// How far each turn lies outside the previous one, in thicknesses: 0 stacks turns, 1 lays them side by side.
        spread: f32 = 0.35, hard(0.0, 1.5), soft(0.0, 1.0), unit(Ratio), words("wide flat coil");
        /// How far each turn lies above the previous one, in thicknesses; negative goes down toward the head.
        rise: f32 = -0.5, hard(-1.5, 1.5), soft(-1.0, 1.0), words("tall stack");
        /// Twist of the wound hair about itself: 0 is smooth, 12 a rope.
        twist: f32 = 5.0, hard(-90.0, 90.0), soft(-20.0, 20.0), unit(AnglePerCm), words("rope turn");

        [Clumping]
        /// Number of locks that the hair splits into; 0: none.
        locks: i64 = 24, hard(0.0, 400.0), soft(0.0, 120.0), unit(Count), words("clumps wisps strands");
        /// How closely the hairs of a lock converge at its end.
        clump: f32 = 0.3, hard(0.0, 1.0), unit(Ratio), words("clumping");

        [Detail]
        /// CVs per hair, root and tip included.
        points: i64 = 90, hard(8.0, 250.0), soft(16.0, 120.0), unit(Count), words("cvs resolution segments");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// Random shortening of locks and hairs; short ones end inside the coil.
        uneven: f32 = 0.1, hard(0.0, 0.95), unit(Ratio), words("length variation messy");
        /// Largest random offset of locks and hairs from their path.
        loose: f32 = 0.08, hard(0.0, 10.0), soft(0.0, 1.0), unit(Length), words("frizz messy natural");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The hair from root to tip. Its parents are the locks.
        curves: Curves;
    }
}

choice! {
    /// Direction of winding.
    Hand {
        /// Counterclockwise seen from the top.
        Left = "left",
        /// Clockwise seen from the top.
        Right = "right",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let ties = Tie::all(cx, scalp, &inputs.ties);
    let wound: Vec<(Tie, Vec<Vec3>)> =
        ties.into_iter().map(|tie| (tie, wind(&inputs, &tie))).collect();
    let length_of = |points: &[Vec3]| points.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
    let length = wound.iter().map(|(_, points)| length_of(points)).fold(0.0, f32::max);
    // The profile is in radii of the tie; all ties of a node have one size.
    let ratio = wound.first().map_or(1.0, |(tie, _)| inputs.thickness / tie.radius);
    let stops = vec![(0.0, 1.0), (0.18, ratio), (0.85, ratio), (1.0, 0.3 * ratio)];
    let profile = Ramp::new(Blend::Smooth, stops).unwrap_or_else(|_| Ramp::constant(ratio));
    if length > 0.0 {
        cx.remark(format!("the bun takes {length:.0} cm of hair past the tie"));
    }
    let bundle = Bundle {
        ties: wound.iter().map(|(tie, points)| (*tie, Course::new(tie, points))).collect(),
        skin: cx.skin(scalp),
        length,
        layers: 0.0,
        uneven: inputs.uneven,
        profile: &profile,
        twist: inputs.twist,
        locks: inputs.locks.min(MOST_LOCKS) as usize,
        clump: inputs.clump,
        loose: inputs.loose,
        points: inputs.points as usize,
        dice: cx.dice(inputs.seed, "bun"),
        seed: inputs.seed,
    };
    Ok(Outputs { curves: bundle.go_on(cx, &inputs.curves)? })
}

/// Centre line of the wound hair: out of the tie, over to its side and around it, with the end under earlier turns.
fn wind(inputs: &Inputs, tie: &Tie) -> Vec<Vec3> {
    let thick = inputs.thickness;
    let hand = if inputs.hand == Hand::Left { 1.0 } else { -1.0 };
    let around = tie.radius + 0.75 * thick;
    let smooth = |x: f32| smoothstep(x);
    let steps = ((inputs.turns * around * TAU / STEP).ceil() as usize).clamp(16, 4000);
    let lowest = 0.7 * thick;
    (0..=steps)
        .map(|k| {
            let turn = inputs.turns * k as f32 / steps as f32;
            let (y, x) = sin_cos_turns(hand * turn);
            let out = tie.right * x + tie.ahead() * y;
            let wound = (turn - 0.5).max(0.0);
            let tucked = smooth(1.0 - (inputs.turns - turn) / 0.3);
            let aside = smooth(turn / 0.5) * around + wound * inputs.spread * 2.0 * thick;
            let over = tie.height + 0.5 * thick * smooth(turn / 0.25);
            let high = (over + wound * inputs.rise * 2.0 * thick).max(lowest);
            let high = high + (0.25 * thick - high) * tucked;
            let aside = aside - 0.6 * thick * tucked;
            tie.foot.point + out * aside + tie.axis * high
        })
        .collect()
}
