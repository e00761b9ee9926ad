//! Flow: guides all over the scalp that run as drawn strokes do.
//!
//! A guide follows the strokes beside its root, from where each passes the root to its tip: their directions, carried along the skin,
//! are blended step by step, and so are their lengths. A stroke's weight falls with its distance and is zero where another takes its
//! place, so nothing pops, and a new stroke changes only the guides around it. A stroke that was cut is followed as it ran before,
//! falling from where it ends: hair that crosses the cut ends there, and no other hair changes its length.
//!
//! Guarantees: roots lie on the scalp and in its region; a higher count only adds guides; no point lies below the skin; points are evenly
//! spaced; a guide rooted where a stroke is, on the same skin, has its shape and length; on a parted scalp no guide follows a stroke on
//! the other side of a parting. Not promised: that guides stay clear of each other.

use super::even_roots::EvenRoots;
use super::grower::{CLEARANCE, Grower, bind};
use crate::data::attribute_transfer::{CvPlace, Lineage};
use crate::data::attributes::{Domain, ID, PARENT, SECTION, UNCUT};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::scalp::{Root, Scalp};
use crate::define::{NodeError, node};
use crate::eval::{EvalCx, Size};
use crate::maths::frame::smallest_rotation;
use crate::maths::hash::{KeyBuilder, curve_id};
use crate::maths::smoothstep;
use crate::maths::transcendental::exp;
use crate::scalp::territory::Row;
use glam::Vec3;
use std::sync::Arc;

node! {
    /// Covers the scalp with guides that flow as drawn strokes do.
    ///
    /// Draw a few strokes with Hair sketch: each guide takes direction, shape and length from the strokes beside it. Give it a head from
    /// Partings that parts between the strokes, and wire Interpolate after it to fill the hair in.
    "flow", version 1, label "Flow from strokes",
        words "flow direct direction groom strokes drawn guides fill style haircut bob swept back comb field few", scales;
    inputs {
        /// The strokes, root first.
        strokes: Curves, words("drawn hair guides sketch");
        /// The head.
        scalp: Arc<Scalp>;
        /// Guides on the whole region. Those that would root in a parting are left out.
        count: i64 = 600, hard(0.0, 20000.0), soft(100.0, 2000.0), unit(Count), words("amount number density");
        /// How level the hair ends beside strokes that hang: at 100% it ends where they end, as a blunt cut does; at 0 every hair is as
        /// long as its strokes, as layers are, and as it always is beside strokes that end on the skin.
        level: f32 = 1.0, hard(0.0, 1.0), unit(Ratio), words("blunt layers cut ends length");
        /// Height to which hair rises over the skin, so that hair from above lies over hair from below.
        volume: f32 = 0.5, hard(0.0, 20.0), soft(0.0, 3.0), unit(Length), words("lift body puffiness height");
        /// Strokes blended per guide. More is smoother; 1 follows the nearest alone.
        strokes_per_guide: i64 = 4, hard(1.0, 16.0), soft(1.0, 8.0), unit(Count), words("neighbours blend smooth");

        [Detail]
        /// CVs per guide, root and tip included.
        points: i64 = 20, hard(2.0, 1024.0), soft(4.0, 48.0), unit(Count), words("cvs segments");
        /// Scale lengths with the size of the head. Strokes always scale.
        scale_with_head: bool = true;
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The guides, one tuft each, with the attributes of the strokes that they follow.
        curves: Curves;
    }
}

/// The most strokes that are followed.
const MOST: usize = 2048;
/// Candidates tried per requested guide before giving up.
const TRIES: usize = 20;
/// Samples along a stroke.
const SAMPLES: usize = 64;
/// Length over which hair rises to its volume, head units.
const RISE: f32 = 3.0;
/// Distance from the skin over which hair comes free of it, head units.
const FREE: f32 = 2.0;
/// Shortest hair beside the end of a stroke, as a fraction of the stroke: of one that hangs in the air, so far (head units) from the skin
/// or farther, and of one that ends on the skin.
const SHORTEST: [f32; 2] = [0.1, 0.4];
const HANGS: f32 = 3.0;
/// A stroke that ends nearer to the skin than this (head units) lies on it more or less: hair beside it is as long as the stroke
/// wherever it is rooted, or its ends would show there as a line.
const LIES: f32 = 1.0;
/// Beyond the end of its strokes hair falls, over such a length (head units).
const FALLS: f32 = 5.0;
/// The most CVs by which a stroke that was cut leads on.
const MOST_BEYOND: f32 = 256.0;
/// Beyond its tip a stroke counts as whole again, over such a fraction of its length: of one that hangs, and of one on the skin.
const BEYOND: [f32; 2] = [0.5, 0.1];

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let size = |n: f64| Size::of(&[("count", n), ("points", inputs.points as f64)]);
    cx.may_make(&size(inputs.count as f64))?;
    let strokes = strokes(cx, &inputs)?;
    let roots = match strokes.is_empty() {
        true => vec![],
        false => roots(cx, &inputs),
    };
    let unit = cx.unit();
    let led = cx.map(roots.len().div_ceil(BATCH), |batch| {
        let roots = roots[batch * BATCH..].iter().take(BATCH);
        Ok(roots
            .map(|(_, root)| followed(&strokes, scalp, root, (&inputs, unit)))
            .collect::<Vec<_>>())
    })?;
    let all = roots.iter().zip(led.into_iter().flatten());
    let led: Vec<(&(u64, Root), Vec<Followed>)> = all.filter(|(_, led)| !led.is_empty()).collect();
    if led.len() < roots.len() {
        let n = roots.len() - led.len();
        cx.warn(format!("{n} guides are left out: partings separate them from all strokes"));
    }
    let grower = Grower { scalp, skin: cx.skin(scalp), points: inputs.points as usize };
    let down = -scalp.frame().up;
    let key = |i: usize| {
        let ((name, root), led) = &led[i];
        let key = KeyBuilder::new("guide").int(*name).vec3(root.point).vec3(root.normal);
        let add = |key: KeyBuilder, one: &Followed| {
            key.key(one.stroke.tuft.key()).float(one.weight).float(one.from).float(one.length)
        };
        led.iter().fold(key, add).finish()
    };
    let [curves] = cx.each_item(led.len(), &size(led.len() as f64), key, |i, piece| {
        piece.tick()?;
        let ((name, root), led) = &led[i];
        let length = led.iter().map(|one| one.weight * one.length).sum::<f32>();
        let rise = |u: f32| {
            let risen = smoothstep((u * length / (RISE * unit)).min(1.0));
            CLEARANCE.max(inputs.volume * risen)
        };
        let way = |u: f32, normal: Vec3, off: f32| {
            let sum = led.iter().map(|one| one.way(u, normal, off, (down, unit)) * one.weight);
            sum.sum::<Vec3>()
        };
        let first = way(0.0, root.normal, 0.0).normalize_or(root.normal);
        let points = grower.grow(root, length, first, rise, |at| {
            way(at.u, at.normal, at.distance).normalize_or(at.direction)
        });
        Ok([guide(&inputs, *name, root, led, &points)])
    })?;
    Ok(Outputs { curves })
}

/// Roots that are planned together.
const BATCH: usize = 256;

/// A stroke, and the skin under it.
struct StrokeOnSkin<'a> {
    tuft: &'a Tuft,
    curve: usize,
    /// As it runs, or ran before it was cut.
    row: Row,
    /// Where it was cut, as a fraction of its length.
    cut: Option<f32>,
    /// At even arc length: direction, normal of the skin, and distance from it (cm).
    samples: Vec<(Vec3, Vec3, f32)>,
    tip: Vec3,
}

/// A stroke that a guide follows.
struct Followed<'a> {
    stroke: &'a StrokeOnSkin<'a>,
    /// Weights of a guide sum to 1.
    weight: f32,
    /// Where it passes the guide's root, as a fraction of its length.
    from: f32,
    /// Length of a guide that follows it alone, cm.
    length: f32,
}

impl Followed<'_> {
    /// The place of the stroke that a fraction of a guide follows; its tip beyond it.
    fn place(&self, u: f32) -> CvPlace {
        let stroke = self.stroke;
        let at = stroke.row.spline.locate(self.from + u * self.length / stroke.row.length());
        let last = stroke.tuft.range(stroke.curve).len() - 2;
        // What was cut off has no CVs.
        if at.span > last { (last as u32, 1.0) } else { (at.span as u32, at.t) }
    }

    /// The direction that it gives at a fraction of a guide, where the guide is `off` the skin (cm) and the skin has this normal.
    fn way(&self, u: f32, normal: Vec3, off: f32, (down, unit): (Vec3, f32)) -> Vec3 {
        let stroke = self.stroke;
        let whole = stroke.row.length();
        let along = self.from + u * self.length / whole;
        let at = along.min(1.0) * SAMPLES as f32;
        let k = (at as usize).min(SAMPLES - 1);
        let (a, b) = (stroke.samples[k], stroke.samples[k + 1]);
        let way = a.0.lerp(b.0, at - k as f32).normalize_or(b.0);
        let under = a.1.lerp(b.1, at - k as f32).normalize_or(b.1);
        // On the skin, the direction turns with it; in the air it stays.
        let near = exp(-off.max(a.2.max(b.2)) / (FREE * unit));
        let carried = smallest_rotation(under, normal) * way;
        let way = way.lerp(carried, near).normalize_or(way);
        let beyond = (along - 1.0).max(0.0) * whole;
        way.lerp(down, smoothstep((beyond / (FALLS * unit)).min(1.0))).normalize_or(down)
    }
}

fn strokes<'a>(cx: &EvalCx, inputs: &'a Inputs) -> Result<Vec<StrokeOnSkin<'a>>, NodeError> {
    let n = inputs.strokes.curve_count();
    if n > MOST {
        return Err(NodeError::failed(format!(
            "{n} strokes to follow, at most {MOST} can be: wire drawn strokes or guides, not hair"
        )));
    }
    let surface = inputs.scalp.surface();
    let falls = (-inputs.scalp.frame().up, cx.unit());
    let mut out = vec![];
    for (tuft, curve) in inputs.strokes.each() {
        cx.check()?;
        let (points, uncut) = (tuft.curve(curve), tuft.view(UNCUT).at(curve, 0));
        let row = match Row::new(tuft.id(curve), points) {
            Ok(row) => row,
            Err(fault) => {
                cx.trouble(tuft.id(curve), fault);
                continue;
            }
        };
        let length = row.length();
        let (row, cut) = match Row::new(tuft.id(curve), &before_cut(points, uncut, falls)) {
            Ok(before) if before.length() > length => {
                let cut = length / before.length();
                (before, Some(cut))
            }
            _ => (row, None),
        };
        let sample = |k: usize| {
            let place = row.spline.locate(k as f32 / SAMPLES as f32);
            let way = row.spline.tangent(place).normalize_or_zero();
            let hit = surface.closest(row.spline.point(place))?;
            Some((way, surface.smooth_normal(hit.triangle, hit.bary), hit.distance))
        };
        if let Some(samples) = (0..=SAMPLES).map(sample).collect() {
            let tip = row.spline.at(1.0);
            out.push(StrokeOnSkin { tuft, curve, row, cut, samples, tip });
        }
    }
    Ok(out)
}

/// The CVs of a stroke as it ran before it was cut, given the length that it had (cm): on from its tip it falls.
fn before_cut(points: &[Vec3], uncut: f32, (down, unit): (Vec3, f32)) -> Vec<Vec3> {
    let mut all = points.to_vec();
    let length: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let [.., a, b] = *points else { return all };
    let mean = length / (points.len() - 1) as f32;
    let rest = (uncut - length).max(0.0);
    let steps = (rest / mean).ceil().min(MOST_BEYOND);
    let step = (rest / steps).min(mean);
    let way = (b - a).normalize_or(down);
    for k in 0..steps as usize {
        let falls = smoothstep((k as f32 * step / (FALLS * unit)).min(1.0));
        let on = all[all.len() - 1] + way.lerp(down, falls).normalize_or(down) * step;
        all.push(on);
    }
    all
}

/// Even roots with their names.
fn roots(cx: &EvalCx, inputs: &Inputs) -> Vec<(u64, Root)> {
    let scalp = &*inputs.scalp;
    let even = EvenRoots::new(scalp, cx.dice(inputs.seed, "roots"));
    let wanted = inputs.count as usize;
    if even.area() <= 0.0 {
        return vec![];
    }
    let last = wanted.saturating_mul(TRIES).saturating_mul(even.places_for_one() as usize);
    let all = (0..last.min(u32::MAX as usize) as u32).filter_map(|i| even.root(i));
    // A root in a parting keeps its place, so that moving the parting leaves all others in place.
    all.take(wanted).filter(|(_, root)| scalp.is_free(root)).collect()
}

/// The strokes that a root's guide follows, nearest first. Empty if partings separate the root from every stroke.
fn followed<'a>(
    strokes: &'a [StrokeOnSkin<'a>],
    scalp: &Scalp,
    root: &Root,
    (inputs, unit): (&Inputs, f32),
) -> Vec<Followed<'a>> {
    let count = inputs.strokes_per_guide as usize;
    let mut near: Vec<(f32, (Vec3, f32), &StrokeOnSkin)> = strokes
        .iter()
        .filter_map(|stroke| {
            let (place, distance, from) = stroke.row.nearest(root.point);
            let crosses = scalp.sections().is_some_and(|cut| cut.crosses(root.point, place));
            (!crosses).then_some((distance, (place, from), stroke))
        })
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let horizon = near.get(count).map_or(f32::MAX, |one| one.0);
    let share = |distance: f32| {
        // At a stroke, a thousandth of a millimetre counts as the same place.
        let share = (1.0 / distance.max(1e-4) - 1.0 / horizon.max(1e-4)).max(0.0);
        share * share
    };
    let whole: f32 = near.iter().take(count).map(|one| share(one.0)).sum();
    let mut out = vec![];
    for (distance, passes, stroke) in near.into_iter().take(count) {
        // All are as far as the first that is left out: the nearest alone is followed.
        let weight = match whole > 0.0 {
            true => share(distance) / whole,
            false => f32::from(u8::from(out.is_empty())),
        };
        if weight > 0.0 {
            let length = length(stroke, root.point, passes, inputs.level, unit);
            out.push(Followed { stroke, weight, from: passes.1, length });
        }
    }
    out
}

/// Length (cm) of a guide that follows alone a stroke, which passes its root at a `place` and at a fraction `from` of its length.
fn length(
    stroke: &StrokeOnSkin,
    root: Vec3,
    (place, from): (Vec3, f32),
    level: f32,
    unit: f32,
) -> f32 {
    let whole = stroke.row.length();
    let (way, _, off) = stroke.samples[SAMPLES];
    // Scissors cut level, however near the skin.
    let off = if stroke.cut.is_some() { f32::MAX } else { off };
    let hangs = smoothstep((off / (HANGS * unit)).min(1.0));
    let of_both = |[in_air, on_skin]: [f32; 2]| on_skin + (in_air - on_skin) * hangs;
    // What is rooted farther along the way of a hanging end ends level with it.
    let rest = whole * (1.0 - from) - (root - place).dot(way) * hangs;
    let rest = rest.max(whole * of_both(SHORTEST));
    // What is rooted beyond the tip is not under the stroke.
    let beyond = (root - stroke.tip).dot(way);
    let again = smoothstep((beyond / (of_both(BEYOND) * whole)).clamp(0.0, 1.0));
    let level = level * smoothstep(off / (LIES * unit));
    let length = whole + (rest + (whole - rest) * again - whole) * level;
    match stroke.cut {
        Some(cut) if from < cut => {
            let way = stroke.row.spline.tangent_at(cut);
            let rest = whole * (cut - from) - (root - place).dot(way);
            length.min(rest.max(whole * SHORTEST[0]))
        }
        _ => length,
    }
}

fn guide(inputs: &Inputs, name: u64, root: &Root, led: &[Followed], points: &[Vec3]) -> Tuft {
    let nearest = led[0].stroke;
    let mut b = TuftBuilder::new();
    b.push_curve(points);
    b.set(ID, Domain::Curve, vec![curve_id(0, inputs.seed as u64, name)]);
    b.set(PARENT, Domain::Curve, vec![nearest.tuft.id(nearest.curve)]);
    bind(&mut b, root, &inputs.scalp);
    let links: Vec<(u32, f32)> = (0..).zip(led).map(|(k, one)| (k, one.weight)).collect();
    let last = (points.len() - 1) as f32;
    let lineage = Lineage {
        parent: &|k| (led[k as usize].stroke.tuft, led[k as usize].stroke.curve),
        of: &|_| &links,
        places: &|k| (0..points.len()).map(|p| led[k as usize].place(p as f32 / last)).collect(),
        takes: &|name| name != SECTION.name,
    };
    lineage.pass_on(&mut b);
    b.build()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::testing::{curves_of, fails, run};
    use std::collections::{BTreeMap, BTreeSet};

    /// Strokes from places of the ball, each led over it to another and on by `hang` cm, straight down.
    fn strokes(of: &[([f32; 2], [f32; 2])], hang: f32) -> Curves {
        let place = |[x, z]: [f32; 2]| {
            let y = (81.0 - x * x - z * z).max(0.0).sqrt();
            shared_ball().closest_root(Vec3::new(x, y, z)).unwrap()
        };
        let tuft = |(id, (from, to)): (u64, &([f32; 2], [f32; 2]))| {
            let (from, to) = (place(*from), place(*to));
            let over = |k: i32| {
                let p = from.point.lerp(to.point, k as f32 / 12.0);
                let root = shared_ball().closest_root(p).unwrap();
                root.point + root.normal * if k > 0 { CLEARANCE } else { 0.0 }
            };
            let mut points: Vec<Vec3> = (0..=12).map(over).collect();
            let last = points[12];
            points.extend((1..=6).map(|k| last - Vec3::Y * (hang * k as f32 / 6.0)));
            let mut b = TuftBuilder::new();
            b.push_curve(&points);
            b.set(ID, Domain::Curve, vec![id]);
            Arc::new(b.build())
        };
        Curves::new((1..).zip(of).map(tuft).collect())
    }
    /// From the middle to both sides.
    fn both_sides() -> Curves {
        let pair = |z: f32| [1.0, -1.0].map(|side| ([side, z], [side * 8.0, z]));
        strokes(&[-4.0, 0.0, 4.0].map(pair).concat(), 6.0)
    }
    fn flow(strokes: &Curves, set: &[(&str, Value)]) -> Curves {
        flow_on(shared_ball().into(), strokes, set)
    }
    fn flow_on(scalp: Value, strokes: &Curves, set: &[(&str, Value)]) -> Curves {
        let given = [("strokes", strokes.clone().into()), ("scalp", scalp)];
        let (out, said) = run(&NODE, &[&given, set].concat());
        assert!(said.iter().all(|said| said.contains("lengths")), "{said:?}");
        curves_of(&out[0]).clone()
    }
    fn length(points: &[Vec3]) -> f32 {
        points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    #[test]
    fn a_guide_beside_a_stroke_has_its_shape_and_length() {
        let drawn = both_sides();
        let set = [("count", Value::Int(4000)), ("volume", Value::Float(0.0))];
        let guides = flow(&drawn, &set);
        let mut seen = 0;
        for stroke in drawn.tufts() {
            let row = crate::maths::spline::Spline::new(stroke.points()).unwrap();
            for tuft in guides.tufts() {
                let points = tuft.points();
                if points[0].distance(row.at(0.0)) > 0.2 {
                    continue;
                }
                seen += 1;
                assert_eq!(tuft.view(PARENT).at(0, 0), stroke.id(0));
                assert!((length(points) / row.length() - 1.0).abs() < 0.05);
                for (k, p) in points.iter().enumerate() {
                    let q = row.at(k as f32 / (points.len() - 1) as f32);
                    assert!(p.distance(q) < 0.08 * row.length(), "{k}: {p} {q}");
                }
            }
        }
        assert!(seen >= 6, "{seen}");
    }

    #[test]
    fn a_level_cut_ends_where_its_strokes_end_and_layers_are_as_long_as_they() {
        let drawn = both_sides();
        let tips = |level: f32| -> Vec<(f32, f32)> {
            let guides = flow(&drawn, &[("level", Value::Float(level))]);
            let under = guides.tufts().iter().map(|tuft| tuft.points()).filter(|points| {
                let root = points[0];
                (2.0..6.0).contains(&root.x.abs()) && root.z.abs() < 4.0
            });
            under.map(|points| (points[points.len() - 1].y, length(points))).collect()
        };
        let spread = |of: &dyn Fn(&(f32, f32)) -> f32, all: &[(f32, f32)]| {
            let each = all.iter().map(of);
            each.clone().fold(f32::MIN, f32::max) - each.fold(f32::MAX, f32::min)
        };
        let (level, layered) = (tips(1.0), tips(0.0));
        assert!(level.len() > 50);
        let heights = [&level, &layered].map(|all| spread(&|one| one.0, all));
        assert!(heights[0] < 3.5 && heights[1] > heights[0] + 1.0, "{heights:?}");
        assert!(spread(&|one| one.1, &level) > 4.0, "{}", spread(&|one| one.1, &level));
        assert!(spread(&|one| one.1, &layered) < 2.0, "{}", spread(&|one| one.1, &layered));
    }

    #[test]
    fn hair_that_crosses_a_cut_ends_there_and_no_other_hair_is_longer_than_before() {
        let drawn = both_sides();
        // Some 4 cm above the ends that hang, and 3 cm of the skin from where strokes begin.
        for (left, crossing, beyond) in [(0.8, 40, 0), (0.3, 0, 20)] {
            let cut = drawn.tufts().iter().map(|tuft| {
                let row = crate::maths::spline::Spline::new(tuft.points()).unwrap();
                let mut b = TuftBuilder::new();
                let points: Vec<Vec3> = (0..=14).map(|k| row.at(left * k as f32 / 14.0)).collect();
                b.push_curve(&points);
                b.set(ID, Domain::Curve, vec![tuft.id(0)]);
                b.set(UNCUT, Domain::Curve, vec![row.length()]);
                Arc::new(b.build())
            });
            let cut = Curves::new(cut.collect());
            let [was, is] = [&drawn, &cut].map(|strokes| {
                let set = [("volume", Value::Float(0.0)), ("count", Value::Int(3000))];
                let guides = flow(strokes, &set);
                let ends = |tuft: &Arc<Tuft>| {
                    assert!(tuft.attribute(UNCUT.name).is_none());
                    let points = tuft.points();
                    (tuft.id(0), (points[0], points[points.len() - 1].y, length(points)))
                };
                guides.tufts().iter().map(ends).collect::<BTreeMap<u64, _>>()
            });
            assert!(was.keys().eq(is.keys()));
            // Of the strokes in the middle.
            let end = cut.tufts()[2].points()[14].y;
            let (mut shorter, mut same) = (0, 0);
            for (id, (root, tip, long)) in &is {
                let before = was[id].2;
                assert!(*long < before * 1.1 + 0.2, "{left} {root}: {long} of {before}");
                let beside = root.z.abs() < 0.8 && root.x.abs() > 2.0;
                if beside && root.y > end + 2.0 && before > long + 0.5 {
                    assert!((tip - end).abs() < 1.5, "{left} {root}: ends at {tip}, not {end}");
                    shorter += 1;
                }
                same += usize::from(beside && root.y < end && (long / before - 1.0).abs() < 0.1);
            }
            assert!(
                shorter >= crossing && same >= beyond,
                "{left}: {shorter} {same} of {}",
                is.len()
            );
        }
    }

    #[test]
    fn a_length_before_a_cut_that_is_no_length_is_none() {
        let drawn = both_sides();
        for wrong in [f32::NAN, -1.0, 0.5, f32::MAX, f32::INFINITY] {
            let strange = drawn.tufts().iter().map(|tuft| {
                let mut b = tuft.edit();
                b.set(UNCUT, Domain::Curve, vec![wrong]);
                Arc::new(b.build())
            });
            let guides = flow(&Curves::new(strange.collect()), &[]);
            assert!(guides.tufts().iter().flat_map(|tuft| tuft.points()).all(|p| p.is_finite()));
            if wrong.is_nan() || wrong < 1.0 {
                let was = flow(&drawn, &[]);
                let keys = |of: &Curves| of.tufts().iter().map(|t| t.key()).collect::<Vec<_>>();
                assert_eq!(keys(&was), keys(&guides), "{wrong}");
            }
        }
    }

    #[test]
    fn one_more_stroke_changes_only_the_guides_around_it() {
        let at = |k: usize| {
            let (x, z) = ((k % 5) as f32 * 3.0 - 6.0, (k / 5) as f32 * 3.0 - 6.0);
            ([x, z], [x + 0.8, z + 0.8])
        };
        let all: Vec<_> = (0..25).map(at).collect();
        let (few, many) = (flow(&strokes(&all[..24], 0.5), &[]), flow(&strokes(&all, 0.5), &[]));
        let keys = |of: &Curves| -> BTreeMap<u64, _> {
            of.tufts().iter().map(|tuft| (tuft.id(0), tuft.key())).collect()
        };
        let (was, is) = (keys(&few), keys(&many));
        assert!(was.keys().eq(is.keys()));
        let changed: BTreeSet<u64> = is.keys().filter(|id| was[id] != is[id]).copied().collect();
        assert!(changed.len() > 10 && changed.len() * 4 < is.len(), "{}", changed.len());
        let (new, _) = all[24];
        for tuft in many.tufts().iter().filter(|tuft| changed.contains(&tuft.id(0))) {
            let root = tuft.points()[0];
            assert!(root.distance(Vec3::new(new[0], root.y, new[1])) < 9.0, "{root}");
        }
    }

    #[test]
    fn guides_follow_no_stroke_beyond_a_parting() {
        let drawn = both_sides();
        let cut = crate::by_id("partings").unwrap();
        let set = [
            ("scalp", shared_ball().into()),
            ("between", drawn.clone().into()),
            ("leave", Value::Float(60.0)),
        ];
        let parted = run(cut, &set).0.remove(0);
        let guides = flow_on(parted, &drawn, &[]);
        let mut sides = [0, 0];
        for tuft in guides.tufts() {
            let left = tuft.points()[0].x > 0.0;
            // Odd ids are on the left.
            assert_eq!(tuft.view(PARENT).at(0, 0) % 2 == 1, left, "{:?}", tuft.points()[0]);
            sides[usize::from(left)] += 1;
        }
        assert!(sides.iter().all(|n| *n > 200), "{sides:?}");
    }

    #[test]
    fn hair_is_not_taken_for_strokes() {
        let mut b = TuftBuilder::new();
        (0..=MOST as u64).for_each(|_| b.push_curve(&[Vec3::Y * 9.0, Vec3::Y * 12.0]));
        b.set(ID, Domain::Curve, (0..=MOST as u64).collect());
        let hair = Curves::new(vec![Arc::new(b.build())]);
        let said = fails(&NODE, &[("strokes", hair.into()), ("scalp", shared_ball().into())]);
        assert!(said.contains("at most 2048 can be"), "{said}");
    }
}
