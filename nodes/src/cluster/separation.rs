//! Separation: curves that are too close to each other move apart.
//!
//! In each pass every point moves half of what it lacks away from the nearest parts of the curves around it, as they were
//! before the pass; then each curve gets its lengths back, from the root on. So nothing depends on the order of curves, and a
//! tuft reads only the tufts near it.
//!
//! Guarantees: roots stay; the distance between points along a curve is kept; nothing moves where curves keep their distance,
//! with no passes or with no strength; no point ends under the skin. Not promised: that the distance is reached where there is
//! no room, close to roots, or in the few passes asked for.

use crate::data::attributes::{ALLOW_DEPTH, RADIUS, WIDTH};
use crate::data::curves::{Curves, Tuft};
use crate::data::field::{Field, Sampler};
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece};
use crate::maths::hash::mix;
use glam::{IVec3, Vec3};
use std::sync::{Arc, LazyLock};

node! {
    /// Moves clusters or hairs apart until they keep a distance.
    ///
    /// Roots and lengths stay. Clusters keep as far apart as their radii ask, hairs as far as they are thick; set `radius` to
    /// half a distance in cm for more.
    "separation", version 1, label "Separation",
        words "separate collide collision hair-hair apart push repel spacing overlap relax intersect volume";
    inputs {
        /// Clusters or hairs to move apart.
        curves: Curves;
        /// The head they stay out of.
        scalp: Option<Arc<Scalp>>;
        /// Room around each curve: two curves keep the sum of theirs. Hairs, which have no radius, take half their width.
        radius: FieldInput = Field::Attribute(RADIUS.name.to_owned()),
            hard(0.0, 100.0), soft(0.01, 3.0), unit(Length), words("distance thickness gap");
        /// Factor of the room.
        scale: f32 = 1.0, hard(0.0, 10.0), soft(0.0, 2.0);
        /// How much of the way curves go apart in each pass.
        strength: f32 = 0.7, hard(0.0, 1.0), unit(Ratio), words("stiffness");
        /// Factor of the strength from root to tip.
        along: Arc<Ramp> = Ramp::linear(0.3, 1.0), words("profile falloff");
        /// Passes; more come closer to the distance asked for.
        passes: i64 = 6, hard(0.0, 100.0), soft(0.0, 20.0), unit(Count), words("iterations");
    }
    outputs {
        /// The same curves, farther apart.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let mut curves = inputs.curves.clone();
    if inputs.strength <= 0.0 || inputs.scale <= 0.0 {
        return Ok(Outputs { curves });
    }
    for _ in 0..inputs.passes {
        cx.check()?;
        let next = pass(cx, &inputs, &curves)?;
        if next.key() == curves.key() {
            break;
        }
        curves = next;
    }
    Ok(Outputs { curves })
}

/// Room around the curves of a tuft, cm: single hairs have no radius, but half a width.
fn room<'a>(inputs: &'a Inputs, tuft: &'a Tuft) -> Result<Sampler<'a>, NodeError> {
    static HALF_A_WIDTH: LazyLock<Field> = LazyLock::new(|| {
        Field::Product(vec![Field::Attribute(WIDTH.name.to_owned()), Field::Constant(0.5)])
    });
    let asks_radius =
        matches!(&*inputs.radius.field, Field::Attribute(name) if name == RADIUS.name);
    if asks_radius && tuft.attribute(RADIUS.name).is_none() {
        return Ok(HALF_A_WIDTH.on(tuft, None, inputs.radius.range)?);
    }
    inputs.radius.on(tuft, inputs.scalp.as_deref())
}

fn pass(cx: &EvalCx, inputs: &Inputs, curves: &Curves) -> Result<Curves, NodeError> {
    let tufts = curves.tufts();
    let mut boxes = Vec::with_capacity(tufts.len());
    let mut widest = 0.0f32;
    for tuft in tufts {
        let radius = room(inputs, tuft)?;
        let mut most = 0.0f32;
        for i in 0..tuft.len() {
            let range = tuft.range(i);
            let last = range.len().max(2) - 1;
            let each =
                range.clone().map(|p| radius.at(i, p, (p - range.start) as f32 / last as f32));
            most = each.fold(most, f32::max);
        }
        let finite = || tuft.points().iter().copied().filter(|p| p.is_finite());
        let low = finite().fold(Vec3::MAX, Vec3::min);
        let high = finite().fold(Vec3::MIN, Vec3::max);
        let room = Vec3::splat(most * inputs.scale);
        boxes.push((low - room, high + room));
        widest = widest.max(most * inputs.scale);
    }
    let near = |i: usize, _: &Tuft| -> Vec<u32> {
        let (low, high) = boxes[i];
        let touches = |b: &(Vec3, Vec3)| b.0.cmple(high).all() && b.1.cmpge(low).all();
        (0..boxes.len() as u32).filter(|n| touches(&boxes[*n as usize])).collect()
    };
    let [out] = cx.each_tuft_with(curves, curves, near, |tuft, around, piece| {
        Ok([apart(cx, inputs, tuft, around, widest, piece)?])
    })?;
    Ok(out)
}

/// The most links that are looked at from one point. Where more are near, there is no room for the distances asked for.
const MOST_NEAR: usize = 4096;
const CROWDED: &str = "more curves are near than can be kept apart, and only some of them were: lower the radius or the scale";

/// A piece of a curve, from one point to the next, with the room at both.
struct Link {
    curve: u64,
    from: Vec3,
    to: Vec3,
    room: (f32, f32),
}

/// Links by the cells of a grid that their middles lie in: sorted, so that the order of curves does not matter.
struct Grid {
    size: f32,
    links: Vec<(IVec3, Link)>,
}

impl Grid {
    fn cell(&self, p: Vec3) -> IVec3 {
        (p / self.size).floor().as_ivec3()
    }
    /// Says each link that may be near, the first [`MOST_NEAR`] of them; whether that was all.
    fn around(&self, p: Vec3, mut each: impl FnMut(&Link)) -> bool {
        let middle = self.cell(p);
        let mut seen = 0;
        for x in -1..=1 {
            for y in -1..=1 {
                // Cells of one column lie one after the other.
                let first = middle + IVec3::new(x, y, -1);
                let last = middle + IVec3::new(x, y, 1);
                let key = |c: IVec3| (c.x, c.y, c.z);
                let start = self.links.partition_point(|(c, _)| key(*c) < key(first));
                for (cell, link) in &self.links[start..] {
                    if key(*cell) > key(last) {
                        break;
                    }
                    seen += 1;
                    if seen > MOST_NEAR {
                        return false;
                    }
                    each(link);
                }
            }
        }
        true
    }
}

fn apart(
    cx: &EvalCx,
    inputs: &Inputs,
    tuft: &Tuft,
    around: &[&Tuft],
    widest: f32,
    piece: &mut Piece,
) -> Result<Tuft, NodeError> {
    let scalp = inputs.scalp.as_deref();
    let mut grid = Grid { size: 0.0, links: vec![] };
    let mut longest = 0.0f32;
    let mut links = vec![];
    for other in around {
        let radius = room(inputs, other)?;
        for i in 0..other.len() {
            let (range, points) = (other.range(i), other.curve(i));
            let last = range.len().max(2) - 1;
            let room =
                |k: usize| radius.at(i, range.start + k, k as f32 / last as f32) * inputs.scale;
            for (k, w) in
                points.windows(2).enumerate().filter(|(_, w)| w[0].is_finite() && w[1].is_finite())
            {
                longest = longest.max(w[0].distance(w[1]));
                let room = (room(k), room(k + 1));
                links.push(Link { curve: other.id(i), from: w[0], to: w[1], room });
            }
        }
    }
    // What is nearer to a point than the room of both lies in a cell beside the point's own.
    grid.size = 2.0 * widest + 0.5 * longest;
    if grid.size <= 0.0 || !grid.size.is_finite() {
        return Ok(tuft.clone());
    }
    let place = |link: Link| (grid.cell(0.5 * (link.from + link.to)), link);
    let mut placed: Vec<(IVec3, Link)> = links.into_iter().map(place).collect();
    placed.sort_by(|(a, l), (b, m)| {
        let key = |c: &IVec3, l: &Link| (c.x, c.y, c.z, l.curve);
        key(a, l).cmp(&key(b, m)).then(l.from.length_squared().total_cmp(&m.from.length_squared()))
    });
    grid.links = placed;
    let radius = room(inputs, tuft)?;
    let skin = scalp.map(|scalp| cx.skin(scalp));
    let depth = tuft.view(ALLOW_DEPTH);
    let mut moved_any = false;
    let mut points = tuft.points().to_vec();
    for i in 0..tuft.len() {
        piece.tick()?;
        let (id, range) = (tuft.id(i), tuft.range(i));
        let last = range.len().max(2) - 1;
        let old = tuft.curve(i);
        let (mut moved, mut crowded) = (false, false);
        for k in 1..range.len() {
            let p = old[k];
            if !p.is_finite() {
                continue;
            }
            let u = k as f32 / last as f32;
            let room = radius.at(i, range.start + k, u) * inputs.scale;
            let (mut push, mut most) = (Vec3::ZERO, 0.0f32);
            let all = grid.around(p, |link| {
                if link.curve == id {
                    return;
                }
                let way = link.to - link.from;
                let t =
                    ((p - link.from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
                let off = p - (link.from + way * t);
                let wanted = room + link.room.0 + (link.room.1 - link.room.0) * t;
                let (d2, far) = (off.length_squared(), wanted);
                if d2 < far * far {
                    let d = d2.sqrt();
                    // Two curves at one place: each its own way, opposite ones.
                    let out = if d > 1e-5 * wanted {
                        off / d
                    } else {
                        let bits = mix(id ^ link.curve);
                        let part = |s: u32| ((bits >> s) & 0xFFFF) as f32 / 32768.0 - 1.0;
                        let any = Vec3::new(part(0), part(16), part(32)).normalize_or(Vec3::X);
                        if id < link.curve { any } else { -any }
                    };
                    let lacks = 0.5 * (wanted - d);
                    push += out * lacks;
                    most = most.max(lacks);
                }
            });
            crowded |= !all;
            if most > 1e-6 {
                // Several neighbours may push one way: never farther than the nearest of them asks.
                let strength = inputs.strength * inputs.along.at(u).clamp(0.0, 1.0);
                points[range.start + k] = p + push.clamp_length_max(most) * strength;
                moved = true;
            }
        }
        if crowded {
            piece.trouble(id, CROWDED);
        }
        if !moved {
            continue;
        }
        moved_any = true;
        for k in 1..range.len() {
            let length = old[k].distance(old[k - 1]);
            let at = range.start + k;
            let before = points[at - 1];
            let straight = (old[k] - old[k - 1]).normalize_or_zero();
            let put = |p: Vec3| before + (p - before).normalize_or(straight) * length;
            let mut p = put(points[at]);
            if let Some(skin) = &skin {
                let (out, pushed) = skin.push_out(p, depth.at(i, at));
                if pushed {
                    // On the skin first; the length once more as far as it stays out.
                    let again = put(out);
                    p = if skin.push_out(again, depth.at(i, at)).1 { out } else { again };
                }
            }
            points[at] = p;
        }
    }
    if !moved_any {
        return Ok(tuft.clone());
    }
    let mut edit = tuft.edit();
    edit.points_mut().copy_from_slice(&points);
    Ok(edit.build())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::TuftBuilder;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::maths::hash::Dice;
    use crate::testing::{curves_of, run};

    /// Curves that leave the ball side by side, much closer than their radii ask.
    fn crowd(n: u64, radius: f32) -> Curves {
        let dice = Dice::new(3, 0, "crowd");
        let tuft = |id: u64| {
            let v =
                Vec3::new(0.15 * dice.signed(id, 0), 1.0, 0.15 * dice.signed(id, 1)).normalize();
            let root = shared_ball().closest_root(v * 9.0).unwrap().point;
            let points: Vec<Vec3> = (0..12).map(|k| root + Vec3::Y * k as f32).collect();
            let mut b = TuftBuilder::new();
            b.push_curve(&points);
            b.set(ID, Domain::Curve, vec![id + 1]);
            b.set(RADIUS, Domain::Curve, vec![radius]);
            b.build().into()
        };
        Curves::new((0..n).map(tuft).collect())
    }

    fn nearest(curves: &Curves) -> f32 {
        let tips: Vec<Vec3> = curves.tufts().iter().map(|t| *t.points().last().unwrap()).collect();
        let mut least = f32::MAX;
        for (i, a) in tips.iter().enumerate() {
            least = tips[..i].iter().fold(least, |least, b| least.min(a.distance(*b)));
        }
        least
    }

    #[test]
    fn curves_come_apart_and_keep_roots_and_lengths() {
        let input = crowd(14, 0.5);
        let set = [("curves", input.clone().into()), ("scalp", shared_ball().into())];
        let (out, said) = run(&NODE, &[&set[..], &[("passes", Value::Int(40))]].concat());
        let out = curves_of(&out[0]);
        assert!(said.is_empty(), "{said:?}");
        assert!(
            nearest(&input) < 0.3 && nearest(out) > 0.85,
            "{} {}",
            nearest(&input),
            nearest(out)
        );
        let skin = shared_ball();
        for (a, b) in input.tufts().iter().zip(out.tufts()) {
            assert_eq!((a.points()[0], a.id(0)), (b.points()[0], b.id(0)));
            for (p, q) in a.points().windows(2).zip(b.points().windows(2)) {
                assert!((p[0].distance(p[1]) - q[0].distance(q[1])).abs() < 1e-4);
            }
            assert!(b.points()[1..].iter().all(|p| skin.skin().distance(*p) > -1e-3));
        }
    }

    #[test]
    fn hairs_keep_their_own_width_apart_and_a_crowd_is_told() {
        let bare = |width: f32, n: u64| {
            let tuft = |id: u64| {
                let x = 0.004 * id as f32;
                let points: Vec<Vec3> =
                    (0..8).map(|k| Vec3::new(x, 10.0 + 0.5 * k as f32, 0.0)).collect();
                let mut b = TuftBuilder::new();
                b.push_curve(&points);
                b.set(ID, Domain::Curve, vec![id + 1]);
                b.set(WIDTH, Domain::Curve, vec![width]);
                b.build().into()
            };
            Curves::new((0..n).map(tuft).collect())
        };
        // Half as far apart as they are thick: they part. Thinner than they are apart: they stay.
        let passes = ("passes", Value::Int(30));
        let (out, _) = run(&NODE, &[("curves", bare(0.008, 2).into()), passes.clone()]);
        assert!(
            (nearest(curves_of(&out[0])) - 0.008).abs() < 5e-4,
            "{}",
            nearest(curves_of(&out[0]))
        );
        let thin = bare(0.003, 2);
        let (out, _) = run(&NODE, &[("curves", thin.clone().into()), passes]);
        assert_eq!(curves_of(&out[0]).key(), thin.key());
        let set = [
            ("curves", bare(0.008, 700).into()),
            ("radius", Field::Constant(5.0).into()),
            ("passes", Value::Int(1)),
        ];
        let (_, said) = run(&NODE, &set);
        assert!(said.iter().any(|text| text.starts_with(CROWDED)), "{said:?}");
    }

    #[test]
    fn what_keeps_its_distance_stays_and_order_does_not_matter() {
        let roomy = crowd(14, 0.001);
        let (out, _) = run(&NODE, &[("curves", roomy.clone().into())]);
        assert_eq!(curves_of(&out[0]).key(), roomy.key());
        let input = crowd(9, 0.6);
        let mut back: Vec<_> = input.tufts().to_vec();
        back.reverse();
        let (one, _) = run(&NODE, &[("curves", input.clone().into())]);
        let (other, _) = run(&NODE, &[("curves", Curves::new(back).into())]);
        for (a, b) in
            curves_of(&one[0]).tufts().iter().zip(curves_of(&other[0]).tufts().iter().rev())
        {
            assert_eq!(a.key(), b.key());
        }
        let (none, _) = run(&NODE, &[("curves", input.clone().into()), ("passes", Value::Int(0))]);
        assert_eq!(curves_of(&none[0]).key(), input.key());
    }
}
