//! Tail: hair held by a tie goes on past it and hangs.
//!
//! Guarantees: roots and the way to the tie stay as they are; no point under the skin; a hair keeps its place across the
//! tail. Not promised: that a tail rests on other hair; give it `clearance` for that.

use super::bundle::{Bundle, Course, MOST_LOCKS, STEP};
use super::tie::Tie;
use crate::data::curves::Curves;
use crate::data::ramp::{Blend, Ramp};
use crate::data::scalp::{Scalp, Skin};
use crate::define::{NodeError, node};
use crate::eval::EvalCx;
use crate::maths::transcendental::{sin_cos, sin_cos_turns};
use std::sync::Arc;

node! {
    /// Lets gathered hair hang from its tie: pony tails and pigtails.
    ///
    /// Every hair goes on from where it left the tie, falls in an arch and hangs beside the others, resting on head, neck
    /// and shoulders. Wire it after Gather into tie.
    "tail", version 1, label "Tail", words "ponytail pony tail pigtail bunches hang gravity fall swing updo";
    inputs {
        /// Hair gathered in ties.
        curves: Curves;
        /// The ties that hold it.
        ties: Curves;
        /// The head that the tail rests on.
        scalp: Arc<Scalp>;
        /// Length past the tie.
        length: f32 = 35.0, hard(0.5, 200.0), soft(5.0, 80.0), unit(Length), handle(Handle::Length);
        /// Radius of the arch in which the tail falls: large tails stand off farther before they hang.
        arch: f32 = 3.0, hard(0.2, 100.0), soft(1.0, 12.0), unit(Length), words("gravity stiffness lift bounce");
        /// How far the tail swings to the head's left, from hanging straight down; negative to its right.
        swing: f32 = 0.0, hard(-80.0, 80.0), soft(-30.0, 30.0), unit(Angle), words("sway motion move");
        /// How far the tail swings back, from hanging straight down; negative forward.
        swing_back: f32 = 0.0, hard(-80.0, 80.0), soft(-30.0, 30.0), unit(Angle), words("sway motion move");
        /// How far the tail moves from side to side on its way, in a soft S.
        sway: f32 = 0.0, hard(0.0, 20.0), soft(0.0, 4.0), unit(Length), words("s curve wave movement");
        /// Length of one such S.
        sway_length: f32 = 28.0, hard(1.0, 200.0), soft(8.0, 60.0), unit(Length), words("s curve wave movement");
        /// How far over skin the middle of the tail hangs at least, in its own radii there.
        clearance: f32 = 0.8, hard(0.0, 10.0), soft(0.3, 2.0), words("collide rest head neck shoulders");
        /// Thickness along the tail, from tie to tip, in thicknesses of the tie.
        profile: Arc<Ramp> = profile(), words("taper fullness shape");
        /// How much sooner hair ends that came from farther away: 1 leaves all hair as long as it grew, 0 is cut level.
        layers: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("cut taper length");
        /// How much shorter locks and hairs may be than others, drawn for each.
        uneven: f32 = 0.25, hard(0.0, 0.95), unit(Ratio), words("length variation taper random");
        /// Locks that the tail falls into; 0: none.
        locks: i64 = 40, hard(0.0, 400.0), soft(0.0, 120.0), unit(Count), words("clumps wisps strands");
        /// How closely hairs of a lock come together at its tip.
        clump: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("clumping tip wisps");
        /// How far locks and hairs wander from their place.
        loose: f32 = 0.25, hard(0.0, 10.0), soft(0.0, 1.5), unit(Length), words("frizz messy natural");
        /// How fast the tail turns about itself, in degrees a cm.
        twist: f32 = 0.0, hard(-90.0, 90.0), soft(-20.0, 20.0), unit(Angle), words("rope turn");
        /// Points on each hair past the tie.
        points: i64 = 36, hard(4.0, 240.0), soft(8.0, 80.0), unit(Count), words("cvs resolution segments");
        /// Whether lengths follow the head's size.
        scale_with_head: bool = true;
        /// Seed tag; stored, mixed into ids and randomness.
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
    let unit = cx.head_unit(Some(scalp), inputs.scale_with_head);
    let skin = cx.skin(scalp);
    let ties = Tie::all(cx, scalp, &inputs.ties);
    let hung = ties.into_iter().map(|tie| (tie, hang(&inputs, skin, unit, &tie)));
    let bundle = Bundle {
        ties: hung.collect(),
        skin,
        length: inputs.length * unit,
        layers: inputs.layers,
        uneven: inputs.uneven,
        profile: &inputs.profile,
        twist: inputs.twist / unit,
        locks: inputs.locks.min(MOST_LOCKS) as usize,
        clump: inputs.clump,
        loose: inputs.loose * unit,
        points: inputs.points as usize,
        dice: cx.dice(inputs.seed, "tail"),
        seed: inputs.seed,
    };
    Ok(Outputs { curves: bundle.go_on(cx, &inputs.curves)? })
}

/// The middle of a tail: out of the tie along its axis, then down in an arch, out of the skin by a share of its own
/// thickness.
fn hang(inputs: &Inputs, skin: Skin, unit: f32, tie: &Tie) -> Course {
    let frame = inputs.scalp.frame();
    let length = inputs.length * unit;
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
        let turn = (down - direction * down.dot(direction)) * (step / (inputs.arch * unit));
        // A tail that stands straight up has no way to fall: it falls back.
        let turn = if turn.length_squared() < 1e-9 && down.dot(direction) < 0.0 {
            -frame.forward * (step / (inputs.arch * unit))
        } else {
            turn
        };
        direction = (direction + turn).normalize_or(down);
        let height = inputs.clearance * tie.radius * inputs.profile.at(u);
        // Close to the tie the tail is where the tie is, however thick it gets.
        let height = height.min(0.8 * tie.height + 0.5 * step * k as f32);
        let next = p + direction * step;
        let (lifted, moved) = skin.lift(next, height);
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
            let wave = sin_cos_turns(s / (inputs.sway_length * unit)).0;
            *p += frame.right * (wave * inputs.sway * unit * free * free);
        }
    }
    Course::new(tie, &points)
}
