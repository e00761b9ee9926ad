//! Scatter guides: guides all over the scalp region, laid by a simple flow, as a start for combing or as short hair.
//!
//! Guarantees: roots lie on the scalp and in the region; a higher count only adds guides; no point lies below the skin;
//! points are evenly spaced; on a parted scalp no guide is rooted in a parting or crosses one on the skin: it runs
//! along the parting, and ends at a corner with no way out. A parting removes the guides that would root in it and no
//! others. Not promised: that guides stay clear of each other.

use super::direct::Directions;
use super::even_roots::{Apart, EvenRoot, EvenRoots};
use super::grower::{CLEARANCE, Grower, bind};
use crate::data::attributes::{DENSITY, Domain, ID, RADIUS, ROOT_BARY, ROOT_TRIANGLE};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::landmarks::Landmark;
use crate::data::scalp::{HEAD_RADIUS, Root, Scalp};
use crate::define::{FieldInput, NodeError, choice, node, unless};
use crate::eval::{EvalCx, Size};
use crate::maths::frame::{across, any_normal, smallest_rotation};
use crate::maths::hash::{KeyBuilder, curve_id};
use crate::maths::smoothstep;
use crate::maths::transcendental::{exp, sin_cos};
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Scatters guides evenly over the scalp and lays them in a direction.
    ///
    /// Comb them with the pen, use them as clusters and fill them, or wire them to Interpolate to grow a short groom at
    /// once. Raising the count adds guides and keeps the existing ones. A soft region mask thins them out.
    "scatter_guides", version 1, label "Scatter guides",
        words "guides guide init plant distribute populate roots crown whorl cowlick flow short hair generate grow", scales;
    inputs {
        /// The head.
        scalp: Arc<Scalp>;
        /// Set the number of guides for the whole region, or per square centimetre.
        by: By = By::Count;
        /// Guides on the whole region, when by count. Guides that would root in a parting are left out.
        count: i64 = 300, hard(0.0, 100000.0), soft(10.0, 2000.0), unit(Count), words("amount number"),
            idle(|of| unless(of, "by", "count", "the number goes by density"));
        /// Guides per square centimetre, when by density.
        density: f32 = 0.5, hard(0.0, 1000.0), soft(0.05, 5.0), unit(PerCm2), words("amount number"),
            idle(|of| unless(of, "by", "density", "the number goes by count"));
        /// Fraction of guides to keep; usually a painted mask.
        mask: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("area region paint");
        /// Smallest distance between two roots. A large value can leave fewer guides than requested.
        min_distance: f32 = 0.0, hard(0.0, 100.0), soft(0.0, 3.0), unit(Length), words("spacing relax poisson");
        /// Length of the guides.
        length: FieldInput = 6.0, hard(0.05, 300.0), soft(0.5, 40.0), unit(Length), handle(Handle::Length);
        /// Radius of the guide when it is used as a cluster.
        radius: FieldInput = 1.0, hard(0.0, 100.0), soft(0.05, 3.0), unit(Length), handle(Handle::Radius);

        [Shape]
        /// Direction in which guides lie.
        flow: Flow = Flow::Crown, words("direction part comb");
        /// Strokes drawn on the skin, such as from nose to tail: guides lie along those beside them, instead of the flow.
        strokes: Option<Curves>, words("direct direction drawn comb fur nose tail");
        /// Direction for that flow, in the head frame (x to the head's left, y up, z forward).
        direction: Vec3 = Vec3::NEG_Y,
            idle(|of| unless(of, "flow", "direction", "guides are laid another way"));
        /// Position of the crown in the head frame, in head units.
        crown: Vec3 = Vec3::new(0.8, 6.8, -5.6), handle(Handle::Point), words("whorl vertex cowlick"),
            idle(|of| unless(of, "flow", "crown", "guides are not laid from the crown"));
        /// Angle by which hair swirls around the crown: 0 is a plain star, 60 a strong whorl. It fades out within about
        /// 5 cm.
        whorl: f32 = 45.0, hard(-180.0, 180.0), soft(-90.0, 90.0), unit(Angle), words("swirl cowlick"),
            idle(|of| unless(of, "flow", "crown", "guides are not laid from the crown"));
        /// Angle between scalp and guide at the root: 0 lies flat, 90 stands straight up.
        lie: FieldInput = 35.0, hard(0.0, 90.0), unit(Angle), words("lift stand elevation"), handle(Handle::Angle);
        /// Bend from root to tip, toward the scalp.
        bend: f32 = 25.0, hard(-360.0, 360.0), soft(-90.0, 180.0), unit(Angle), words("curve curl under");
        /// Strength of gravity: 0 is none, 1 makes hair hang after a few centimetres.
        droop: f32 = 0.25, hard(0.0, 10.0), soft(0.0, 2.0), unit(Ratio), words("gravity hang fall sag");

        [Detail]
        /// CVs per guide, root and tip included.
        points: i64 = 10, hard(2.0, 1024.0), soft(4.0, 32.0), unit(Count), words("cvs segments");
        /// Scale lengths with the size of the head.
        scale_with_head: bool = true;

        [Randomness]
        /// Random shortening of each guide: 0 keeps the full length, 0.95 allows down to a twentieth of it.
        length_variation: f32 = 0.1, hard(0.0, 0.95), unit(Ratio), words("random vary");
        /// Random deviation of the direction.
        randomness: f32 = 8.0, hard(0.0, 180.0), soft(0.0, 45.0), unit(Angle), words("jitter noise messy");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The guides, one tuft each.
        curves: Curves;
    }
}

choice! {
    /// What sets the number of guides.
    By {
        /// Per region.
        Count = "count",
        /// Per square centimetre.
        Density = "density",
    }
}

choice! {
    /// Direction in which guides lie.
    Flow {
        /// Away from the crown in all directions, as short hair grows; from nose to tail on animals.
        Crown = "crown",
        /// Straight down everywhere.
        Down = "down",
        /// From the forehead back over the head, then down.
        Back = "back",
        /// From nose to tail along the body, as fur lies.
        Tail = "tail",
        /// The same direction everywhere.
        Direction = "direction",
    }
}

/// Candidates tried per requested guide before giving up.
const TRIES: f64 = 200.0;
/// Distance from the crown at which the whorl has faded to a third, head units.
const WHORL_REACH: f32 = 3.0;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let roots = roots(cx, &inputs)?;
    let bound = bound(&roots, inputs.seed);
    let length = inputs.length.on(&bound, Some(scalp))?;
    let lie = inputs.lie.on(&bound, Some(scalp))?;
    let radius = inputs.radius.on(&bound, Some(scalp))?;
    let (vary, stray) = (cx.dice(inputs.seed, "length"), cx.dice(inputs.seed, "direction"));
    let grower = Grower { scalp, skin: cx.skin(scalp), points: inputs.points as usize };
    let strokes = inputs.strokes.as_ref();
    let directions = strokes.and_then(|strokes| Directions::of(strokes, scalp));
    if strokes.is_some() && directions.is_none() {
        cx.warn("no stroke is drawn to lie along: the flow counts");
    }
    let drawn = strokes.map_or_else(|| KeyBuilder::new("none").finish(), Curves::key);
    let laid = Laid { grower, inputs: &inputs, unit: cx.unit(), directions };
    let key = |i: usize| {
        let (name, root) = &roots[i];
        let key = KeyBuilder::new("guide").int(*name).vec3(root.point).vec3(root.normal);
        key.key(drawn).finish()
    };
    let size = Size::of(&[("guides", roots.len() as f64), ("points", inputs.points as f64)]);
    let [curves] = cx.each_item(roots.len(), &size, key, |i, piece| {
        piece.tick()?;
        let (id, (_, root)) = (bound.id(i), &roots[i]);
        let shorter = 1.0 - inputs.length_variation * vary.unit(id, 0);
        let random = [0, 1].map(|n| stray.signed(id, n) * inputs.randomness.to_radians());
        let length = length.at(i, i, 0.0) * shorter;
        let points = laid.guide(root, length, lie.at(i, i, 0.0).to_radians(), random);
        let mut b = TuftBuilder::new();
        b.push_curve(&points);
        b.set(ID, Domain::Curve, vec![id]);
        b.set(RADIUS, Domain::Curve, vec![radius.at(i, i, 0.0)]);
        b.set(DENSITY, Domain::Curve, vec![DENSITY.default]);
        bind(&mut b, root, scalp);
        Ok([b.build()])
    })?;
    Ok(Outputs { curves })
}

/// Even roots with their names.
fn roots(cx: &EvalCx, inputs: &Inputs) -> Result<Vec<(u64, Root)>, NodeError> {
    let scalp = &*inputs.scalp;
    let even = EvenRoots::new(scalp, cx.dice(inputs.seed, "roots"));
    let wanted = match inputs.by {
        By::Count => inputs.count as f64,
        By::Density => (f64::from(inputs.density) * even.region_area()).min(1e5),
    };
    let wanted = wanted.round() as usize;
    if inputs.mask.constant() == Some(1.0) {
        cx.may_make(&Size::of(&[("count", wanted as f64), ("points", inputs.points as f64)]))?;
    }
    let keep = cx.dice(inputs.seed, "mask");
    let mut apart = Apart::new(even.area() as f32, inputs.min_distance);
    let mut out: Vec<(u64, Root)> = vec![];
    // Masks are read for many candidates at a time; the most that are looked for at once.
    const BATCH: usize = 1024;
    const MOST: f64 = 262_144.0;
    let most = (wanted.max(8) as f64) * TRIES * f64::from(even.places_for_one());
    let (mut from, last) = (0.0, most / even.area());
    let mut skipped = 0;
    while out.len() + skipped < wanted && from < last && !apart.full() {
        let more = (0.5 * from * even.area()).clamp(BATCH as f64, MOST);
        let to = last.min(from + more / even.area());
        for candidates in even.by_chance(from, to).chunks(BATCH) {
            cx.check()?;
            if out.len() + skipped >= wanted || apart.full() {
                break;
            }
            let root =
                |(_, root): &(f32, EvenRoot)| (root.name, scalp.root(root.triangle, root.bary));
            let batch: Vec<(u64, Root)> = candidates.iter().map(root).collect();
            let tuft = bound(&batch, inputs.seed);
            let mask = inputs.mask.on(&tuft, Some(scalp))?;
            for (slot, ((name, root), (room, _))) in batch.into_iter().zip(candidates).enumerate() {
                if out.len() + skipped >= wanted || apart.full() {
                    break;
                }
                // A root in a parting keeps its place, so that moving the parting leaves all others in place.
                let share = mask.at(slot, slot, 0.0);
                let chosen = keep.unit(name, 0) < share && scalp.is_free(&root);
                if apart.take(*room, root.point) {
                    match chosen {
                        true => out.push((name, root)),
                        false => skipped += 1,
                    }
                }
            }
        }
        from = to;
    }
    // (If the region is empty, the head reports it.)
    if out.len() + skipped < wanted && even.area() > 0.0 {
        let min = inputs.min_distance;
        cx.warn(format!("only {} of {wanted} guides fit at {min} cm from each other", out.len()));
    }
    Ok(out)
}

/// The roots as curves of one point, for fields to read.
fn bound(roots: &[(u64, Root)], seed: i64) -> Tuft {
    let mut b = TuftBuilder::even(roots.iter().map(|(_, r)| r.point).collect(), 1);
    let id = |(name, _): &(u64, Root)| curve_id(0, seed as u64, *name);
    b.set(ID, Domain::Curve, roots.iter().map(id).collect());
    b.set(ROOT_TRIANGLE, Domain::Curve, roots.iter().map(|(_, r)| r.triangle as i32).collect());
    b.set(ROOT_BARY, Domain::Curve, roots.iter().map(|(_, r)| r.bary).collect());
    b.build()
}

/// Lays guides by the node's settings.
struct Laid<'a> {
    grower: Grower<'a>,
    inputs: &'a Inputs,
    /// Centimetres per head unit.
    unit: f32,
    /// What is drawn to lie along.
    directions: Option<Directions>,
}

impl Laid<'_> {
    /// A guide along the flow at the angle of `lie` to the skin below, decreasing as it bends, pulled down as it gets free.
    fn guide(&self, root: &Root, length: f32, lie: f32, [turn, tilt]: [f32; 2]) -> Vec<Vec3> {
        let steps = self.grower.steps();
        let step = length / steps as f32;
        let bend = self.inputs.bend.to_radians() / steps as f32;
        let down = -self.grower.scalp.frame().up;
        let flow = turned(self.flow(root.point, root.normal), root.normal, turn);
        let (sin, cos) = sin_cos((lie + tilt * cos_of(lie)).clamp(0.0, std::f32::consts::PI));
        let direction = flow * cos + root.normal * sin;
        self.grower.grow(
            root,
            length,
            direction,
            |_| CLEARANCE,
            |at| {
                let normal = at.normal;
                // Near the skin, hair turns with it and with the flow; a few cm away it is free.
                let near = exp(-at.distance / (2.0 * self.unit));
                let carried = smallest_rotation(at.normal_before, normal) * at.direction;
                let mut direction = at.direction.lerp(carried, near).normalize_or(at.direction);
                let flow = turned(self.flow(at.point, normal), normal, turn);
                if let Some(flat) = across(direction, normal) {
                    let high = direction.dot(normal);
                    let flat = flat.lerp(flow, 0.3 * near).normalize_or(flat);
                    direction = (flat * (1.0 - high * high).max(0.0).sqrt() + normal * high)
                        .normalize_or(direction);
                }
                if let Some(axis) = direction.cross(-normal).try_normalize() {
                    direction = turned(direction, axis, bend);
                }
                let pull = self.inputs.droop * 0.25 * step / self.unit;
                (direction + down * pull).normalize_or(direction)
            },
        )
    }

    /// The flow on the scalp at `p`. Unit, perpendicular to `normal`.
    fn flow(&self, p: Vec3, normal: Vec3) -> Vec3 {
        let frame = self.grower.scalp.frame();
        let drawn = self.directions.as_ref().and_then(|drawn| drawn.at(p, normal, &mut vec![]));
        if let Some(drawn) = drawn {
            return across(drawn, normal).unwrap_or_else(|| any_normal(normal));
        }
        // Without a cranium there is no crown.
        let is_head = self.grower.scalp.landmarks().get(Landmark::Crown).is_some();
        let wanted = match self.inputs.flow {
            Flow::Tail => -frame.forward,
            Flow::Crown if !is_head => -frame.forward,
            Flow::Down => -frame.up,
            Flow::Back => {
                // Straight back would end in a tuft where the head faces back: from the crown on, down.
                let behind = -frame.head_from_point(p).z / HEAD_RADIUS;
                let down = (0.5 + 0.8 * behind).clamp(0.0, 1.0);
                -(frame.forward.lerp(frame.up, smoothstep(down)))
            }
            Flow::Direction => frame.vector_from_head(self.inputs.direction),
            Flow::Crown => {
                let crown = self.grower.scalp.place(self.inputs.crown);
                let away = across(p - crown, normal).unwrap_or_else(|| any_normal(normal));
                let reach = WHORL_REACH * self.unit;
                let fade = exp(-(p - crown).length() / reach);
                turned(away, normal, self.inputs.whorl.to_radians() * fade)
            }
        };
        across(wanted, normal).unwrap_or_else(|| any_normal(normal))
    }
}

fn cos_of(angle: f32) -> f32 {
    sin_cos(angle).1
}

/// `v` turned about a unit axis.
fn turned(v: Vec3, axis: Vec3, radians: f32) -> Vec3 {
    let (sin, cos) = sin_cos(radians);
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::field::Field;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::eval::{Log, Quality};
    use crate::testing::{Memory, curves_of, run, run_on};

    fn scatter(set: &[(&str, Value)]) -> Curves {
        let (out, _) = run(&NODE, &[&[("scalp", shared_ball().into())], set].concat());
        curves_of(&out[0]).clone()
    }

    #[track_caller]
    fn check_laws(set: &[(&str, Value)], count: usize) {
        let (scalp, curves) = (shared_ball(), scatter(set));
        assert_eq!(curves.curve_count(), count);
        let skin = scalp.skin();
        for (tuft, i) in curves.each() {
            let points = tuft.curve(i);
            let triangle = tuft.view(ROOT_TRIANGLE).at(i, 0);
            let root = scalp.root(u32::try_from(triangle).unwrap(), tuft.view(ROOT_BARY).at(i, 0));
            assert!(root.point.distance(points[0]) < 1e-5);
            assert!(scalp.grows(root.triangle, root.bary) > 0.0);
            for p in &points[1..] {
                assert!(p.is_finite() && skin.distance(*p) >= 0.0, "{p}");
            }
            let steps: Vec<f32> = points.windows(2).map(|w| w[0].distance(w[1])).collect();
            for pair in steps.windows(2) {
                let ratio = (pair[0] / pair[1]).max(pair[1] / pair[0]);
                assert!(ratio < 1.2, "{ratio} {steps:?}");
            }
        }
    }

    #[test]
    fn guides_root_on_the_region_stay_out_of_the_head_and_have_even_points() {
        let number = |name, x: f32| (name, Value::Float(x));
        check_laws(&[], 300);
        check_laws(&[("count", Value::Int(0))], 0);
        check_laws(&[("count", Value::Int(40)), number("lie", 0.0), number("droop", 3.0)], 40);
        check_laws(&[("count", Value::Int(40)), number("lie", 90.0), number("bend", 180.0)], 40);
        let wild = [number("length", 40.0), number("randomness", 180.0), ("flow", "back".into())];
        check_laws(&[&[("count", Value::Int(60))], &wild[..]].concat(), 60);
        let down = [("flow", "down".into()), number("length", 0.1), ("points", Value::Int(2))];
        check_laws(&[&[("count", Value::Int(60))], &down[..]].concat(), 60);
    }

    #[test]
    fn a_higher_count_only_adds_and_makes_only_what_it_adds() {
        let (host, log) = (Memory::default(), Log::default());
        let scalp = Value::from(shared_ball());
        let with = |count: i64, log: &Log| {
            let set = [("scalp", scalp.clone()), ("count", Value::Int(count))];
            let out = run_on(&NODE, &set, &host, log, Quality::Final).unwrap();
            curves_of(&out[0]).clone()
        };
        let (few, many) = (with(80, &log), with(200, &log));
        assert_eq!((few.curve_count(), many.curve_count()), (80, 200));
        for (a, b) in few.tufts().iter().zip(many.tufts()) {
            assert_eq!(a.key(), b.key());
        }
    }

    #[test]
    fn no_two_roots_are_nearer_than_asked() {
        let curves = scatter(&[("min_distance", Value::Float(1.5)), ("count", Value::Int(2000))]);
        let roots: Vec<Vec3> = curves.tufts().iter().map(|t| t.points()[0]).collect();
        // 498 cm2 hold 255 discs of that distance in a perfect grid; at random about half.
        assert!((120..256).contains(&roots.len()), "{}", roots.len());
        for (i, a) in roots.iter().enumerate() {
            assert!(roots[..i].iter().all(|b| a.distance(*b) >= 1.5));
        }
    }

    #[test]
    fn guides_lie_along_the_strokes_beside_them_and_turn_between() {
        let scalp = shared_ball();
        // Over the top, forward on the left and backward on the right.
        let line = |side: f32, way: f32| {
            let place = |k: i32| Vec3::new(3.0 * side, 8.0, way * k as f32);
            let points: Vec<Vec3> =
                (-4..=4).map(|k| scalp.closest_root(place(k)).unwrap().point).collect();
            let mut b = TuftBuilder::new();
            b.push_curve(&points);
            Arc::new(b.build())
        };
        let strokes = Curves::new(vec![line(1.0, 1.0), line(-1.0, -1.0)]);
        let straight = [("randomness", 0.0), ("droop", 0.0), ("lie", 5.0), ("length", 1.0)];
        let straight = straight.map(|(name, x)| (name, Value::Float(x)));
        let set = [&[("strokes", strokes.into()), ("count", Value::Int(2000))], &straight[..]];
        let (mut along, mut across) = (0, 0);
        for (tuft, i) in scatter(&set.concat()).each() {
            let points = tuft.curve(i);
            let (root, way) = (points[0], (points[9] - points[0]).normalize());
            let beside = (root.x.abs() - 3.0).abs() < 0.8 && root.y > 7.0 && root.z.abs() < 3.0;
            if beside {
                let aside = way.x.abs();
                assert!(way.z * root.x.signum() > 0.7 && aside < 0.35, "{root}: {way}");
                along += 1;
            }
            across += usize::from(root.x.abs() < 0.3 && way.z.abs() < 0.7);
        }
        assert!(along > 30 && across > 5, "{along}, {across}");
    }

    #[test]
    fn fur_of_an_animal_runs_from_nose_to_tail() {
        let Some(file) = crate::testing::shared_file("rat/street_rat_4k.gltf") else {
            println!("skipped: fur_of_an_animal_runs_from_nose_to_tail needs ../shared/data/rat");
            return;
        };
        let set = [("mesh", Value::File(file)), ("fit", Value::from("none"))];
        let rat = crate::testing::head(&set);
        let forward = rat.frame().forward;
        let (out, _) = run(&NODE, &[("scalp", rat.into()), ("length", Value::Float(0.5))]);
        let way = |(tuft, i): (&Tuft, usize)| {
            let points = tuft.curve(i);
            (points[9] - points[0]).normalize_or_zero().dot(forward)
        };
        let back = curves_of(&out[0]).each().filter(|one| way(*one) < 0.1).count();
        assert!(back > 270, "{back} of 300");
    }

    #[test]
    fn a_mask_keeps_as_many_as_it_says() {
        let curves = scatter(&[("mask", Field::Constant(0.3).into())]);
        assert!((60..120).contains(&curves.curve_count()), "{}", curves.curve_count());
    }
}
