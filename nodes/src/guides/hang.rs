//! Hang: curves that leave the scalp at their roots and fall, resting on head, neck, shoulders and each other.
//!
//! Guarantees: the same curves on every machine; lengths exact to 0.1 %; no point below the skin and no NaN for any
//! input; evenly spaced points; every part that does not hang freely rests on skin or another curve (`fall.rs` explains
//! how). Not promised: that curves keep their radii apart where there is not enough room, as beside their roots.
//!
//! **Dependencies:** curves that touch depend on each other and, through chains of contacts, on all others, so all are
//!  computed at once (80 braids take a tenth of a second). Each curve is its own tuft, keyed by content: downstream,
//!  only curves that changed run again.

use super::fall::{Fall, Thread};
use crate::data::attribute_transfer::{Lineage, ONE_PARENT, carry_root, evenly};
use crate::data::attributes::{
    Domain, ID, NORMAL, PARENT, RADIUS, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::scalp::{HEAD_RADIUS, Root, Scalp};
use crate::define::{FieldInput, NodeError, choice, node, unless};
use crate::eval::{EvalCx, Size};
use crate::maths::frame::{across, any_normal};
use crate::maths::hash::curve_id;
use crate::maths::smoothstep;
use crate::maths::spline::CurveFault;
use crate::maths::transcendental::sin_cos;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Hangs curves from their roots: out of the scalp, then down, resting on head, neck and shoulders.
    ///
    /// For free-hanging braids, locs and twists, and for long hair. Give it roots (the middles of sections, or guides,
    /// of which the first point is used) and braid or fill the result. Clearance is half the thickness of what runs
    /// along the curve, so that its surface, not the curve, rests on the skin.
    "hang", version 1, label "Hang",
        words "gravity fall drape simulate simulation dynamics collide collision rest shoulders free hanging locs twists long hair droop dangle", scales;
    inputs {
        /// Curves whose first points are the roots.
        roots: Curves, words("source guides");
        /// The head, with neck and shoulders if it has them. Without a head, curves fall freely.
        scalp: Option<Arc<Scalp>>;
        /// Length of each curve.
        length: FieldInput = 35.0, hard(0.1, 500.0), soft(1.0, 90.0), unit(Length), handle(Handle::Length);
        /// How far the curve stands out before its weight bends it down: 0 falls at once, 1 to 2 suits a braid, 10 a
        /// stiff lock.
        stiffness: FieldInput = 1.2, hard(0.0, 100.0), soft(0.0, 10.0), unit(Length), words("bend rigidity stand");
        /// Angle between scalp and curve at the root: 0 lies flat, 90 stands straight out.
        lie: FieldInput = 20.0, hard(0.0, 90.0), unit(Angle), words("lift stand elevation"), handle(Handle::Angle);
        /// Direction in which curves leave their roots.
        flow: Flow = Flow::Sides, words("direction part comb");
        /// Direction for the flows that use one, in the head frame (x to the head's left, y up, z forward).
        direction: Vec3 = Vec3::new(1.0, -0.2, -0.35),
            idle(|of| matches!(of("flow"), Some(Value::Text(is)) if !["sides", "direction"].contains(&&*is)).then_some("curves leave their roots another way"));
        /// Position of the parting when hair falls to both sides: 0 follows the scalp's parting or the midline,
        /// positive is nearer the head's left ear. Within 1.5 cm, a parting of the scalp decides which way hair falls.
        parted_at: f32 = 0.0, hard(-20.0, 20.0), soft(-6.0, 6.0), unit(Length), words("part side middle centre"),
            idle(|of| unless(of, "flow", "sides", "hair does not fall to both sides"));

        [Shape]
        /// Length over which curves that lie on the head follow the flow before they slide straight down.
        hold: f32 = 5.0, hard(0.0, 100.0), soft(0.0, 20.0), unit(Length), words("style set friction");
        /// Extra pull besides gravity, as a fraction of it, in the head frame: (0.2, 0, 0) leans to the head's left.
        swing: Vec3 = Vec3::ZERO, words("wind tilt motion lean");

        [Thickness]
        /// Half the thickness of what runs along the curve. Curves keep this distance from the skin and twice as much
        /// from each other; each starts in the skin at its root.
        clearance: FieldInput = 0.4, hard(0.0, 20.0), soft(0.0, 2.0), unit(Length), handle(Handle::Radius),
            words("radius thickness offset collision");
        /// Keep curves apart by their thickness. Off is faster and lets them intersect.
        separate: bool = true, words("collision neighbours stack layers");

        [Detail]
        /// CVs per curve, root and tip included.
        points: i64 = 48, hard(2.0, 1024.0), soft(8.0, 128.0), unit(Count), words("cvs segments");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// Random shortening of each curve: 0 keeps the full length, 0.95 allows down to a twentieth of it.
        length_variation: f32 = 0.04, hard(0.0, 0.95), soft(0.0, 0.5), unit(Ratio), words("random vary ends layers");
        /// Random deviation of each curve from the straight fall.
        variation: f32 = 4.0, hard(0.0, 60.0), soft(0.0, 20.0), unit(Angle), words("random jitter natural");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The curves, one tuft each, with the attributes of their roots and the clearance as radius.
        curves: Curves;
    }
}

choice! {
    /// Direction in which curves leave their roots.
    Flow {
        /// The direction below on the head's left, mirrored on the right, and down at the back: parted hair.
        Sides = "sides",
        /// The same direction everywhere.
        Direction = "direction",
        /// From the forehead back over the head, then down.
        Back = "back",
        /// Down, each on the side where it is rooted.
        Down = "down",
        /// As the input curves begin.
        Curve = "curve",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let (threads, from) = threads(cx, &inputs)?;
    let skin = scalp.map(|scalp| cx.skin(scalp));
    let (up, swing) = match scalp.map(Scalp::frame) {
        Some(frame) => (frame.up, frame.vector_from_head(inputs.swing)),
        None => (Vec3::Y, inputs.swing),
    };
    let fall = Fall {
        skin,
        down: (swing - up).try_normalize().unwrap_or(-up),
        hold: inputs.hold,
        separate: inputs.separate,
        stray: (inputs.variation.to_radians(), cx.dice(inputs.seed, "stray")),
        points: inputs.points as usize,
    };
    let size = [("roots", threads.len() as f64), ("points", inputs.points as f64)];
    cx.may_make(&Size::of(&size))?;
    let fallen = cx.whole(inputs.roots.key(), || {
        let fallen = fall.all(&threads, cx)?;
        let bytes = fallen.iter().map(|curve| curve.len() * 12 + 24).sum();
        Ok((fallen, bytes))
    })?;

    let tufts = threads.iter().zip(&from).zip(&*fallen).map(|((thread, (tuft, i)), points)| {
        let mut b = TuftBuilder::new();
        b.push_curve(points);
        b.set(ID, Domain::Curve, vec![thread.id]);
        b.set(PARENT, Domain::Curve, vec![tuft.id(*i)]);
        b.set(RADIUS, Domain::Curve, vec![thread.clearance]);
        if let Some(root) = &thread.root {
            b.set(SCALP_NORMAL, Domain::Curve, vec![root.normal]);
            b.set(ROOT_TRIANGLE, Domain::Curve, vec![root.triangle as i32]);
            b.set(ROOT_BARY, Domain::Curve, vec![root.bary]);
            if scalp.is_some_and(|scalp| scalp.uvs().is_some()) {
                b.set(ROOT_UV, Domain::Curve, vec![root.uv]);
            }
            // What is laid along the curve faces outward.
            let tangent = (points[1] - points[0]).normalize_or(thread.direction);
            let normal = across(root.normal, tangent).unwrap_or_else(|| any_normal(tangent));
            b.set(NORMAL, Domain::Curve, vec![normal]);
        } else {
            carry_root(tuft, *i, &mut b);
        }
        let lineage = Lineage {
            parent: &|_| (tuft, *i),
            of: &|_| ONE_PARENT,
            places: &|_| evenly(tuft.curve(*i), points.len()),
            takes: &|_| true,
        };
        lineage.pass_on(&mut b);
        Arc::new(b.build())
    });
    Ok(Outputs { curves: Curves::new(tufts.collect()) })
}

/// What is to fall, and the curve that each comes from.
type Threads<'a> = (Vec<Thread>, Vec<(&'a Tuft, usize)>);

fn threads<'a>(cx: &EvalCx, inputs: &'a Inputs) -> Result<Threads<'a>, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let (vary, stray) = (cx.dice(inputs.seed, "length"), cx.dice(inputs.seed, "direction"));
    let (mut threads, mut from) = (vec![], vec![]);
    for tuft in inputs.roots.tufts() {
        let length = inputs.length.on(tuft, scalp)?;
        let clearance = inputs.clearance.on(tuft, scalp)?;
        let stiffness = inputs.stiffness.on(tuft, scalp)?;
        let lie = inputs.lie.on(tuft, scalp)?;
        for i in 0..tuft.len() {
            let parent = tuft.id(i);
            let first = tuft.range(i).start;
            let Some(point) = tuft.curve(i).first().copied().filter(|p| p.is_finite()) else {
                cx.trouble(parent, CurveFault::NotFinite);
                continue;
            };
            let root = scalp.and_then(|scalp| bound(scalp, tuft, i, point));
            let id = curve_id(parent, inputs.seed as u64, 0);
            let normal = root.map_or(Vec3::Y, |root| root.normal);
            let flow = inputs.flow(scalp, tuft.curve(i), point, normal);
            let random = inputs.variation.to_radians();
            let [turn, tilt] = [0, 1].map(|n| stray.signed(id, n) * random);
            let (sin, cos) = sin_cos(turn);
            let flow = flow * cos + normal.cross(flow) * sin;
            let lie = lie.at(i, first, 0.0).to_radians();
            let (sin, cos) = sin_cos((lie + tilt).clamp(0.0, std::f32::consts::FRAC_PI_2));
            threads.push(Thread {
                id,
                point: root.map_or(point, |root| root.point),
                root,
                flow,
                direction: (flow * cos + normal * sin).normalize_or(normal),
                length: length.at(i, first, 0.0)
                    * (1.0 - inputs.length_variation * vary.unit(id, 0)),
                clearance: clearance.at(i, first, 0.0),
                stiffness: stiffness.at(i, first, 0.0),
            });
            from.push((&**tuft, i));
        }
    }
    Ok((threads, from))
}

/// Where a curve is bound to the scalp, or else its point nearest to the root.
fn bound(scalp: &Scalp, tuft: &Tuft, i: usize, point: Vec3) -> Option<Root> {
    let first = tuft.range(i).start;
    let triangle = tuft.view(ROOT_TRIANGLE).at(i, first);
    let known = u32::try_from(triangle)
        .ok()
        .filter(|t| (*t as usize) < scalp.surface().triangles.len())
        .map(|t| scalp.root(t, tuft.view(ROOT_BARY).at(i, first)))
        .filter(|root| root.point.distance(point) < 1e-3);
    known.or_else(|| scalp.closest_root(point))
}

/// Within this distance (cm) of the requested parting, a drawn parting decides to which side hair falls.
const ASIDE: f32 = 1.5;

impl Inputs {
    /// Direction along the skin in which a curve leaves its root. Unit, perpendicular to `normal`.
    fn flow(&self, scalp: Option<&Scalp>, curve: &[Vec3], p: Vec3, normal: Vec3) -> Vec3 {
        let identity = crate::data::scalp::HeadFrame::IDENTITY;
        let frame = scalp.map_or(&identity, Scalp::frame);
        let at = scalp.map_or_else(|| frame.head_from_point(p), |scalp| scalp.given(p));
        let wanted = match self.flow {
            Flow::Sides => {
                // Hair is parted up to the crown: on the back of the head it falls down.
                let behind = ((-normal.dot(frame.forward) - 0.1) / 0.6).clamp(0.0, 1.0);
                let behind = smoothstep(behind);
                let to = |side: f32| {
                    let sideways = self.direction * Vec3::new(side, 1.0, 1.0);
                    frame.vector_from_head(sideways.lerp(Vec3::NEG_Y, behind))
                };
                let x = at.x * frame.unit();
                let side = if x < self.parted_at { -1.0 } else { 1.0 };
                // A drawn parting does not exactly match the requested one: the drawn one decides.
                let step = ASIDE * frame.unit();
                let leads_over = |side: f32| {
                    let along = across(to(side), normal).unwrap_or(Vec3::ZERO);
                    let sections = scalp.and_then(Scalp::sections);
                    sections.is_some_and(|sections| sections.crosses(p, p + along * step))
                };
                let near = (x - self.parted_at).abs() < step;
                let turned = near && leads_over(side) && !leads_over(-side);
                // Without a requested parting, the scalp's partings decide: hair falls to the side that is not cut off.
                let cut_off = |side: f32| {
                    let aside = Vec3::new(side * HEAD_RADIUS, 0.0, at.z);
                    let aside = scalp.and_then(|s| s.closest_root(frame.point_from_head(aside)));
                    let sections = scalp.and_then(Scalp::sections);
                    let both = sections.zip(aside);
                    both.is_some_and(|(sections, aside)| sections.crosses(p, aside.point))
                };
                let told = self.parted_at != 0.0;
                let over = turned || (!told && cut_off(side) && !cut_off(-side));
                to(if over { -side } else { side })
            }
            Flow::Direction => frame.vector_from_head(self.direction),
            Flow::Back => {
                // Straight back would end in a tuft where the head faces back: from the crown on, down.
                let down = (0.5 - 0.8 * at.z / HEAD_RADIUS).clamp(0.0, 1.0);
                -(frame.forward.lerp(frame.up, smoothstep(down)))
            }
            Flow::Down => -frame.up,
            Flow::Curve => curve.get(1).map_or(Vec3::ZERO, |next| *next - curve[0]),
        };
        let flat = |v: Vec3| v.try_normalize().and_then(|v| across(v, normal));
        // If that points out of the skin: away from the head's axis.
        flat(wanted)
            .or_else(|| flat(p - frame.origin - frame.up * (p - frame.origin).dot(frame.up)))
            .unwrap_or_else(|| any_normal(normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::field::Field;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::eval::{Log, Quality};
    use crate::maths::hash::Dice;
    use crate::maths::spline::Spline;
    use crate::testing::{Memory, curves_of, run, run_on};

    /// Roots distributed over the upper half of the ball, as curves of two points.
    fn roots(n: u64) -> Curves {
        let (ball, dice) = (shared_ball(), Dice::new(9, 0, "roots"));
        let tufts = (0..n).map(|id| {
            let y = dice.range(id, 0, -0.2, 0.95);
            let (s, c) = sin_cos(dice.unit(id, 1) * std::f32::consts::TAU);
            let flat = (1.0 - y * y).sqrt();
            let root = ball.closest_root(Vec3::new(s * flat, y, c * flat) * 8.9).unwrap();
            let mut b = TuftBuilder::new();
            b.push_curve(&[root.point, root.point + root.normal]);
            b.set(ID, Domain::Curve, vec![id + 1]);
            b.set_named("section".into(), Domain::Curve, vec![id + 100]);
            Arc::new(b.build())
        });
        Curves::new(tufts.collect())
    }

    fn hang(n: u64, set: &[(&str, Value)]) -> Curves {
        let base = [("roots", Value::from(roots(n))), ("scalp", shared_ball().into())];
        let (out, _) = run(&NODE, &[&base, set].concat());
        curves_of(&out[0]).clone()
    }

    #[track_caller]
    fn check_laws(n: u64, set: &[(&str, Value)], length: f32) {
        let (ball, curves) = (shared_ball(), hang(n, set));
        assert_eq!(curves.curve_count(), n as usize);
        for (tuft, i) in curves.each() {
            let points = tuft.curve(i);
            let spline = Spline::new(points).unwrap();
            let off = (spline.length() / length - 1.0).abs();
            assert!(off < 1e-3, "{} of {length} {set:?}", spline.length());
            let triangle = tuft.view(ROOT_TRIANGLE).at(i, 0) as u32;
            let root = ball.root(triangle, tuft.view(ROOT_BARY).at(i, 0));
            assert!(root.point.distance(points[0]) < 1e-5);
            for p in &points[1..] {
                assert!(p.is_finite() && ball.skin().distance(*p) >= 0.0, "{p}");
            }
            let steps: Vec<f32> = points.windows(2).map(|w| w[0].distance(w[1])).collect();
            for pair in steps.windows(2) {
                let ratio = (pair[0] / pair[1]).max(pair[1] / pair[0]);
                // Even along the arc; where one thread slips off another, a chord is up to a fifth shorter than its
                // arc.
                assert!(ratio < 1.3, "{ratio} {steps:?}");
            }
        }
    }

    fn number(name: &'static str, x: f32) -> (&'static str, Value) {
        (name, Value::Float(x))
    }

    #[test]
    fn lengths_are_exact_points_even_and_outside_the_head() {
        let same = number("length_variation", 0.0);
        check_laws(60, std::slice::from_ref(&same), 35.0);
        check_laws(20, &[same.clone(), number("length", 0.1), ("points", Value::Int(4))], 0.1);
        check_laws(20, &[same.clone(), number("length", 200.0), number("hold", 50.0)], 200.0);
        check_laws(20, &[same.clone(), number("lie", 90.0), number("stiffness", 20.0)], 35.0);
        check_laws(20, &[same.clone(), number("clearance", 0.0), ("flow", "back".into())], 35.0);
        check_laws(20, &[same.clone(), number("clearance", 3.0), ("flow", "curve".into())], 35.0);
        check_laws(20, &[same, number("variation", 60.0), ("flow", "down".into())], 35.0);
    }

    #[test]
    fn what_does_not_hang_straight_rests_on_the_skin() {
        let alone = [("separate", Value::Bool(false)), number("variation", 0.0)];
        let (ball, curves) = (shared_ball(), hang(40, &alone));
        for (tuft, i) in curves.each() {
            let points = tuft.curve(i);
            let mut s = 0.0;
            for w in points.windows(2) {
                s += w[0].distance(w[1]);
                let height = ball.skin().distance(w[1]);
                if s > 6.0 && height > 0.8 {
                    let fall = -(w[1] - w[0]).normalize().y;
                    assert!(fall > 0.9, "{fall} at {s} cm, {height} over the skin");
                }
                if s > 2.0 {
                    assert!(height > 0.33, "{height} at {s} cm");
                }
            }
        }
    }

    #[test]
    fn curves_keep_their_radii_apart_where_there_is_room() {
        let wide = [number("clearance", 0.35), number("variation", 2.0)];
        let curves = hang(40, &wide);
        let all: Vec<&[Vec3]> = curves.each().map(|(t, i)| t.curve(i)).collect();
        let (mut near, mut through) = (0, 0);
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                // The first cm is at their roots, which they did not choose.
                let beyond = |c: &[Vec3]| c[6..].to_vec();
                for p in beyond(a) {
                    let d = beyond(b).iter().map(|q| q.distance(p)).fold(f32::MAX, f32::min);
                    near += usize::from(d < 1.2);
                    through += usize::from(d < 0.6 * 0.7);
                }
            }
        }
        assert!(near > 200, "{near}: nothing is tested");
        assert!(through * 100 < near * 2, "{through} of {near}");
    }

    #[test]
    fn nothing_in_gives_nothing_and_bad_roots_are_named() {
        assert_eq!(hang(0, &[]).curve_count(), 0);
        let mut b = TuftBuilder::new();
        b.push_curve(&[Vec3::NAN, Vec3::ONE]);
        b.push_curve(&[Vec3::ONE]);
        b.set(ID, Domain::Curve, vec![7, 8]);
        let bad = Curves::new(vec![Arc::new(b.build())]);
        let (out, said) = run(&NODE, &[("roots", bad.into())]);
        let curves = curves_of(&out[0]);
        assert_eq!(curves.curve_count(), 1);
        assert!(said[0].contains("not a finite number"), "{said:?}");
        let tip = *curves.tufts()[0].points().last().unwrap();
        assert!(tip.y < -30.0 && tip.is_finite(), "without a head it falls freely: {tip}");
    }

    #[test]
    fn what_the_roots_had_stays_and_ids_are_new_and_stable() {
        let curves = hang(5, &[]);
        for (k, (tuft, i)) in curves.each().enumerate() {
            assert_eq!(tuft.view(PARENT).at(i, 0), k as u64 + 1);
            assert_eq!(tuft.id(i), curve_id(k as u64 + 1, 0, 0));
            assert_eq!(tuft.view(crate::data::attributes::SECTION).at(i, 0), k as u64 + 100);
        }
    }

    #[test]
    fn a_curve_that_nobody_touches_stays_the_same_when_others_change() {
        let (host, log) = (Memory::default(), Log::default());
        let scalp = Value::from(shared_ball());
        let all = roots(12);
        let keys = |curves: &Curves| {
            let set = [("scalp", scalp.clone()), ("roots", curves.clone().into())];
            let out = run_on(&NODE, &set, &host, &log, Quality::Final).unwrap();
            curves_of(&out[0]).tufts().iter().map(|t| t.key()).collect::<Vec<_>>()
        };
        let (with, without) = (keys(&all), keys(&Curves::new(all.tufts()[..11].to_vec())));
        let same = without.iter().filter(|key| with.contains(key)).count();
        assert!(same >= 6, "{same} of 11");
    }

    #[test]
    fn a_field_says_each_length() {
        let lengths =
            Field::Product(vec![Field::Attribute("density".into()), Field::Constant(20.0)]);
        let set = [("length", lengths.into()), number("length_variation", 0.0)];
        let curves = hang(3, &set);
        for (tuft, i) in curves.each() {
            let length = Spline::new(tuft.curve(i)).unwrap().length();
            assert!((length - 10.0).abs() < 0.01, "{length}");
        }
    }

    #[test]
    fn hair_falls_to_both_sides_of_the_parting_that_the_scalp_has() {
        use crate::data::sections::{Parting, Sections};
        let ball = shared_ball();
        // From the front over the top, 4 cm beside the midline, without a requested parting.
        let points = (-60..=60).map(|k: i32| {
            let (s, c) = sin_cos(k as f32 / 120.0 * std::f32::consts::PI);
            ball.closest_root(Vec3::new(4.0, c * 8.0, s * 8.0)).unwrap().point
        });
        let line = Parting { id: 1, points: points.collect(), half_width: 0.08, of_pattern: false };
        let (sections, _) = Sections::new(&ball, vec![line], &[]);
        let parted = Arc::new(ball.parted(sections));
        let sides = |parted_at: f32| {
            let set = [
                ("roots", roots(300).into()),
                ("scalp", parted.clone().into()),
                ("direction", Value::Vec3(Vec3::new(1.0, -0.2, 0.0))),
                ("separate", Value::Bool(false)),
                number("variation", 0.0),
                number("parted_at", parted_at),
            ];
            let (out, _) = run(&NODE, &set);
            let curve = |(tuft, i): (&Tuft, usize)| {
                let points = tuft.curve(i);
                (points[0], points[4].x - points[0].x)
            };
            curves_of(&out[0]).each().map(curve).collect::<Vec<_>>()
        };
        // On top, where hair falls to the sides at all, and clear of the line's own width.
        let on_top = |root: &Vec3| root.z > 0.0 && root.y > 4.0 && (root.x - 4.0).abs() > 0.5;
        let mut between = 0;
        for (root, way) in sides(0.0).iter().filter(|(root, _)| on_top(root)) {
            assert_eq!(*way > 0.0, root.x > 4.0, "{root}");
            between += usize::from(root.x > 0.0 && root.x < 4.0);
        }
        assert!(between > 3, "{between}: nothing is tested");
        // A requested parting is respected.
        for (root, way) in sides(-3.0).iter().filter(|(root, _)| on_top(root)) {
            let near = (root.x + 3.0).abs() < 2.0;
            assert!(near || (*way > 0.0) == (root.x > -3.0), "{root}");
        }
    }

    #[test]
    fn a_parting_beside_the_place_where_hair_parts_decides_to_which_side_it_falls() {
        use crate::data::sections::{Parting, Sections};
        let ball = shared_ball();
        // From the front over the top, 0.8 cm beside the midline, where the requested parting is.
        let points = (-60..=60).map(|k: i32| {
            let (s, c) = sin_cos(k as f32 / 120.0 * std::f32::consts::PI);
            ball.closest_root(Vec3::new(0.8, c * 8.9, s * 8.9)).unwrap().point
        });
        let line = Parting { id: 1, points: points.collect(), half_width: 0.08, of_pattern: false };
        let (sections, _) = Sections::new(&ball, vec![line], &[]);
        let parted = Arc::new(ball.parted(sections));
        let sides = |scalp: Arc<Scalp>| {
            let set = [
                ("roots", roots(200).into()),
                ("scalp", scalp.into()),
                ("direction", Value::Vec3(Vec3::new(1.0, -0.2, 0.0))),
                ("separate", Value::Bool(false)),
                number("variation", 0.0),
            ];
            let (out, _) = run(&NODE, &set);
            let curve = |(tuft, i): (&Tuft, usize)| {
                let points = tuft.curve(i);
                (points[0], points[4].x - points[0].x)
            };
            curves_of(&out[0]).each().map(curve).collect::<Vec<_>>()
        };
        let (bare, drawn) = (sides(shared_ball()), sides(parted));
        let mut turned = 0;
        // On the back of the head hair falls down, to neither side.
        for ((root, before), (_, after)) in bare.iter().zip(&drawn).filter(|(b, _)| b.0.z > 0.0) {
            assert_eq!(*before > 0.0, root.x >= 0.0, "{root}");
            assert_eq!(*after > 0.0, root.x >= 0.8, "{root}");
            turned += usize::from((*before > 0.0) != (*after > 0.0));
        }
        assert!(turned > 2, "{turned}: nothing is tested");
    }
}
