//! Interpolate: hair between guides.
//!
//! Where hairs root and which guides they follow is a plan made from the guides' *roots* alone, kept
//! while those stay; shapes are read when the hair of one guide is made. So combing a guide makes again
//! exactly the hair that follows it. Guarantees: roots on the scalp; more only adds hair; weights go to zero where a
//! guide stops counting for its distance, so nothing pops as roots move, but where a parting comes between; no point under the skin by more than the guide's
//! `allow_depth`; a hair rooted where a guide is has its shape; on a parted scalp no hair is rooted on a parting or led by a
//! guide of another section, what lies on the skin stays in its section as far along it as the nearest guide does in its own, and
//! where that would lead it over a parting it gathers to the guide sooner, so that both leave the section in one place. Not
//! promised: that hair stays over its section beyond that, for it goes where its guides go.

use super::plan::{Plan, PlannedHair};
use crate::data::attribute_transfer::{Lineage, evenly};
use crate::data::attributes::{
    ALLOW_DEPTH, Domain, ID, PARENT, RADIUS, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV, SCALP_NORMAL,
    SECTION, WIDTH,
};
use crate::data::curves::{AttributeView, Curves, Tuft, TuftBuilder};
use crate::data::patience::Patience;
use crate::data::route::makers::clear_noting;
use crate::data::scalp::{Scalp, Skin};
use crate::define::{FieldInput, NodeError, choice, node, unless};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::frame::smallest_rotation;
use crate::maths::hash::{KeyBuilder, curve_id};
use crate::maths::smoothstep;
use crate::maths::spline::Spline;
use glam::{Mat3, Vec3};
use std::sync::{Arc, OnceLock};

node! {
    /// Grows hair between guides, all over the scalp.
    ///
    /// Each hair blends the guides nearest to its root and follows the curve of the scalp. Combing a guide rebuilds only the
    /// hair around it; a higher density only adds hair.
    "interpolate", version 2, label "Interpolate",
        words "hair generate grow fill children between guides from curves density populate xgen description primitives fur", thins, scales;
    inputs {
        /// Guides to follow.
        guides: Curves;
        /// The head that the hair grows on.
        scalp: Arc<Scalp>;
        /// Set the density of hair, or the number of hairs.
        by: By = By::Density;
        /// Hairs per square centimetre, when by density. People have 130 to 250.
        density: f32 = 120.0, hard(0.0, 5000.0), soft(1.0, 300.0), unit(PerCm2), words("amount number"),
            idle(|of| unless(of, "by", "density", "the number goes by count"));
        /// Hairs on the whole region, when by count. A mask keeps its share of them.
        count: i64 = 20000, hard(0.0, 20000000.0), soft(100.0, 150000.0), unit(Count), words("amount number"),
            idle(|of| unless(of, "by", "count", "the number goes by density"));
        /// Share of the hairs to keep; usually a painted mask.
        mask: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("area region paint thin");
        /// Diameter of the hair.
        width: f32 = 0.008, hard(0.0001, 1.0), soft(0.002, 0.05), unit(Length), fixed(), words("thickness diameter");

        [Placement]
        /// Guides blended per hair. More is smoother; fewer keeps the character of the guides; 1 copies the nearest.
        guides_per_hair: i64 = 3, hard(1.0, 16.0), soft(1.0, 8.0), unit(Count), words("neighbours blend");
        /// Guides farther from the hair's root than this are ignored; without any, no hair grows.
        /// 0: no limit.
        reach: f32 = 0.0, hard(0.0, 1000.0), soft(0.0, 10.0), unit(Length), words("distance radius"), handle(Handle::Radius);

        [Detail]
        /// CVs per hair, including root and tip.
        points: i64 = 16, hard(2.0, 1024.0), soft(4.0, 64.0), unit(Count), words("cvs segments resolution");
        /// Scale lengths with the head, and density inversely with its area, so the number of hairs stays.
        scale_with_head: bool = true;
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// Hair, one tuft per nearest guide.
        curves: Curves;
    }
}

choice! {
    /// How the number of hairs is set.
    By {
        /// Hairs per square centimetre.
        Density = "density",
        /// Hairs on the whole region.
        Count = "count",
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let guides = one_each(&inputs.guides);
    let asked = super::plan::PlanParams {
        count: (inputs.by == By::Count).then_some(inputs.count as usize),
        density: inputs.density,
        mask: &inputs.mask,
        points: inputs.points as usize,
        neighbours: inputs.guides_per_hair as usize,
        reach: inputs.reach,
        seed: inputs.seed,
    };
    if let (Some(count), Some(1.0)) = (asked.count, inputs.mask.constant()) {
        let count = cx.thinned(count) as f64;
        cx.may_make(&Size::of(&[("count", count), ("points", inputs.points as f64)]))?;
    }
    let plan = Plan::of(cx, &guides, scalp, &asked)?;
    if plan.led_by_none > 0 {
        let n = plan.led_by_none;
        cx.warn(format!("{n} hairs are left out: no guide is rooted in their sections"));
    }
    if let Some(count) = asked.count.filter(|_| plan.missing > 0) {
        let there = count - plan.missing;
        let text = format!(
            "only {there} of {count} hairs have a root, in places ten times as many: reach or partings leave the others bare; \
             raise count, or go by density"
        );
        cx.warn(text);
    }
    let cx = &cx.in_lots(plan.groups.len());
    let skin = cx.skin(scalp);
    let maker = Maker { inputs: &inputs, scalp, skin: skin.for_hair() };
    let key = |i: usize| {
        let group = &plan.groups[i];
        let key = KeyBuilder::new("hair").key(group.key);
        group.guides.iter().fold(key, |key, guide| key.key(guides[*guide as usize].key())).finish()
    };
    // Guides are read by the hair of several others, and prepared by whichever comes first.
    let shapes: Vec<OnceLock<Shape>> = (0..guides.len()).map(|_| OnceLock::new()).collect();
    let shape = |guide: u32| {
        let guide = guide as usize;
        let make = || Shape::new(&guides[guide], plan.normals[guide], inputs.points as usize);
        shapes[guide].get_or_init(make)
    };
    let hairs: usize = plan.groups.iter().map(|group| cx.makes(group.hairs.len())).sum();
    let size = Size::of(&[("hairs", hairs as f64), ("points", inputs.points as f64)]);
    let [curves] = cx.each_item(plan.groups.len(), &size, key, |i, piece| {
        let group = &plan.groups[i];
        let own = group.guides[0];
        // Hairs are listed in the order in which a rising density adds them.
        let hairs = &group.hairs[..cx.thinned(group.hairs.len())];
        let read = Read {
            own: &guides[own as usize],
            section: plan.sections[own as usize],
            own_shape: shape(own),
            hairs: hairs.len(),
            hair: &|i| plan.hair(hairs[i]),
            shape: &shape,
            guide: &|guide| &guides[guide as usize],
        };
        Ok([maker.hair(&read, piece)?])
    })?;
    Ok(Outputs { curves })
}

/// Guides, one per tuft, so that a key changes with one guide alone.
fn one_each(curves: &Curves) -> Vec<Arc<Tuft>> {
    let mut out = Vec::with_capacity(curves.curve_count());
    for tuft in curves.tufts() {
        match tuft.len() {
            1 => out.push(tuft.clone()),
            n => out.extend((0..n as u32).map(|i| Arc::new(tuft.gather(&[i]).build()))),
        }
    }
    out
}

struct Maker<'a> {
    inputs: &'a Inputs,
    scalp: &'a Scalp,
    skin: Option<Skin<'a>>,
}

/// Inputs of the hair of one guide.
struct Read<'a, 'p> {
    own: &'a Tuft,
    section: u64,
    own_shape: &'p Shape,
    /// Number of hairs.
    hairs: usize,
    /// A hair, with its guides and their weights.
    hair: &'a dyn Fn(usize) -> (&'p PlannedHair, &'p [(u32, f32)]),
    shape: &'a dyn Fn(u32) -> &'p Shape,
    guide: &'a dyn Fn(u32) -> &'a Tuft,
}

/// A guide for blending: CVs relative to its root at even arc length, one list per axis.
struct Shape {
    normal: Vec3,
    axes: [Vec<f32>; 3],
}

impl Shape {
    fn new(tuft: &Tuft, normal: Vec3, each: usize) -> Self {
        let mut axes = [const { Vec::new() }; 3];
        let root = tuft.curve(0)[0];
        // The plan leaves out guides without a valid spline.
        if let Ok(spline) = Spline::new(tuft.curve(0)) {
            spline.resample(each, |p| {
                let from_root = (p - root).to_array();
                axes.iter_mut().zip(from_root).for_each(|(axis, x)| axis.push(x));
            });
        }
        axes.iter_mut().for_each(|axis| axis.resize(each, 0.0));
        Self { normal, axes }
    }
    fn at(&self, k: usize) -> Vec3 {
        Vec3::from(self.axes.each_ref().map(|axis| axis[k]))
    }
    /// Adds this shape, rotated and weighted by `m`, to a hair.
    #[inline]
    fn add_to(&self, m: &Mat3, [to_x, to_y, to_z]: &mut [Vec<f32>; 3]) {
        // One axis at a time over lists of equal length: plain loops that compilers vectorise.
        let n = to_x.len();
        let [x, y, z] = &self.axes;
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        let (to_y, to_z) = (&mut to_y[..n], &mut to_z[..n]);
        for k in 0..n {
            to_x[k] += m.x_axis.x * x[k] + m.y_axis.x * y[k] + m.z_axis.x * z[k];
            to_y[k] += m.x_axis.y * x[k] + m.y_axis.y * y[k] + m.z_axis.y * z[k];
            to_z[k] += m.x_axis.z * x[k] + m.y_axis.z * y[k] + m.z_axis.z * z[k];
        }
    }
}

/// Patience of the hair of one guide in finding a way out of the skin, in looks (a hair beside an ear takes some hundred), and
/// the increase with each CV.
const LOOKS: u64 = 1000;
const LOOKS_A_POINT: f32 = 0.25;
/// Margin by which a ball without skin is shrunk against rounding errors, cm.
const SURE: f32 = 1e-3;

/// Number of balls without skin kept per CV of the hair of one guide: searching them costs less than one query of the skin.
const KNOWN: usize = 24;

/// How a hair that would cross a parting joins its guide: where the guide leaves the section so may the hair.
struct Gather {
    /// Index of the CV at which the hair has joined the guide.
    over: usize,
    /// Path to the guide over the scalp; `None` where it is straight.
    way: Option<Vec<Vec3>>,
}

impl Gather {
    /// Share of the way to the guide at a CV.
    fn share(&self, k: usize) -> f32 {
        smoothstep((k as f32 / self.over as f32).min(1.0))
    }
    /// The place of a CV at `p` of a hair rooted at `root`, `drawn` of the way to that of its guide.
    fn on_the_way(&self, p: Vec3, root: Vec3, guide: (Vec3, Vec3), drawn: f32) -> Vec3 {
        let (guide_root, guide) = guide;
        let p = p.lerp(guide, drawn);
        let Some(way) = &self.way else { return p };
        let x = drawn * (way.len() - 1) as f32;
        let i = (x as usize).min(way.len() - 2);
        let on_way = way[i].lerp(way[i + 1], x - i as f32);
        p + (on_way - root.lerp(guide_root, drawn))
    }
}

impl Maker<'_> {
    /// The hair of one guide.
    fn hair(&self, read: &Read, piece: &mut Piece) -> Result<Tuft, NodeError> {
        let each = self.inputs.points as usize;
        let Read { own, section, own_shape, hair, shape, guide: guide_of, .. } = *read;
        let at_u = |k: usize| k as f32 / (each - 1) as f32;
        let depth = own.view(ALLOW_DEPTH);
        let last = own.curve(0).len() - 1;
        let depths: Vec<f32> =
            (0..each).map(|k| depth.at(0, (at_u(k) * last as f32) as usize)).collect();
        let guide_root = own.curve(0)[0];
        // Fraction up to which the guide itself stays in the section of its root.
        let home = self.scalp.home(guide_root);
        let at = |k: usize| guide_root + own_shape.at(k);
        let at_home = home.map_or(0, |home| (1..each).take_while(|k| home.holds(at(*k))).count());

        // Index of the last CV above its section, at any height.
        let over =
            home.map_or(1, |home| (1..each).take_while(|k| home.is_under(at(*k))).count().max(1));
        // Balls without skin around CVs of this and earlier hair: a point inside one needs no query.
        let mut clear = vec![(Vec3::ZERO, 0.0); each];
        let mut known: Vec<Vec<(Vec3, f32)>> = vec![vec![]; each];
        if let Some(skin) = &self.skin {
            for k in (0..each).filter(|k| depths[*k] == 0.0) {
                let sure = (skin.clear_about(at(k)) - SURE).max(0.0);
                clear[k] = (at(k), sure * sure);
            }
        }

        // Grows with each hair, so that more hair changes none before it.
        let patience = Patience::new(LOOKS);
        let skin = self.skin.map(|skin| skin.within(&patience));
        let guide_passes = home.is_some_and(|home| home.passes(own.curve(0)));

        // Found when the first hair needs it.
        let mut ways = None;
        let mut points: Vec<Vec3> = Vec::with_capacity(read.hairs * each);
        let mut blended = [vec![0.0; each], vec![0.0; each], vec![0.0; each]];
        let (mut asked, mut offs) = (vec![None; each], vec![0.0; each]);
        let mut grown: Vec<(&PlannedHair, &[(u32, f32)])> = Vec::with_capacity(read.hairs);
        let mut ids = Vec::with_capacity(read.hairs);
        for (hair, blend) in (0..read.hairs).map(hair) {
            piece.tick()?;
            patience.add((LOOKS_A_POINT * each as f32) as u64);
            let id = curve_id(0, self.inputs.seed as u64, hair.name);
            blended.iter_mut().for_each(|axis| axis.fill(0.0));
            for (guide, weight) in blend {
                let shape = shape(*guide);
                let turn = smallest_rotation(shape.normal, hair.normal) * *weight;
                shape.add_to(&turn, &mut blended);
            }
            let first = points.len();
            let mut lay = |points: &mut Vec<Vec3>, gather: Option<Gather>| {
                points.truncate(first);
                points.push(hair.point);
                let [x, y, z] = &blended;
                points.extend((1..each).map(|k| hair.point + Vec3::new(x[k], y[k], z[k])));
                if let Some(gather) = gather {
                    for (k, p) in points[first..].iter_mut().enumerate().skip(1) {
                        let drawn = gather.share(k);
                        *p = gather.on_the_way(*p, hair.point, (guide_root, at(k)), drawn);
                    }
                }
                if let Some(home) = home {
                    let hair_at_home = points[first..].iter_mut().enumerate().take(1 + at_home);
                    home.lead(hair_at_home.skip(1), hair.triangle, |_, _, kept| kept);
                }
                if let Some(skin) = &skin {
                    let triangle = hair.triangle as i32;
                    let hair = &mut points[first..];
                    for (k, p) in hair.iter().enumerate() {
                        let clearance = |(middle, square): &(Vec3, f32)| {
                            let far = p.distance_squared(*middle);
                            (far < *square).then(|| square.sqrt() - far.sqrt())
                        };
                        let off =
                            clearance(&clear[k]).or_else(|| known[k].iter().find_map(clearance));
                        asked[k] = off.is_none().then_some(depths[k]);
                        offs[k] = off.unwrap_or(0.0);
                    }
                    clear_noting(
                        skin,
                        hair,
                        triangle,
                        |k| asked[k],
                        |k| offs[k],
                        |k, middle, radius| {
                            if depths[k] < 0.0 {
                                return;
                            }
                            // The last ones, at any place.
                            if known[k].len() == KNOWN {
                                known[k].remove(0);
                            }
                            known[k].push((middle, radius * radius));
                        },
                    );
                }
            };
            lay(&mut points, None);
            if let Some(home) = home {
                let crosses = |points: &[Vec3]| {
                    points[first..].windows(2).take(at_home).any(|w| home.crosses(w[0], w[1]))
                };
                if crosses(&points) || home.passes(&points[first..]) {
                    let way = (!home.is_straight(hair.point, guide_root)).then(|| {
                        ways.get_or_insert_with(|| home.ways(guide_root)).from(hair.point)
                    });
                    lay(&mut points, Some(Gather { over, way: way.flatten() }));
                    if crosses(&points) || (!guide_passes && home.passes(&points[first..])) {
                        piece.trouble(
                            id,
                            "a hair that no way leads to its guide without crossing a parting was left out; with more points or guides there are fewer",
                        );
                        points.truncate(first);
                        continue;
                    }
                }
            }
            grown.push((hair, blend));
            ids.push(id);
        }
        let mut out = TuftBuilder::even(points, each);
        if grown.is_empty() {
            return Ok(out.build());
        }
        let hairs = || grown.iter().map(|(hair, _)| hair);
        out.set(ID, Domain::Curve, ids);
        out.set(PARENT, Domain::Curve, vec![own.id(0)]);
        out.set(WIDTH, Domain::Curve, vec![self.inputs.width]);
        if section != 0 {
            out.set(SECTION, Domain::Curve, vec![section]);
        }
        out.set(ROOT_TRIANGLE, Domain::Curve, hairs().map(|h| h.triangle as i32).collect());
        out.set(ROOT_BARY, Domain::Curve, hairs().map(|h| h.bary).collect());
        if self.scalp.uvs().is_some() {
            out.set(ROOT_UV, Domain::Curve, hairs().map(|h| h.uv).collect());
        }
        if matches!(depth, AttributeView::Point(_)) && depths.iter().any(|depth| *depth != 0.0) {
            out.set(ALLOW_DEPTH, Domain::Point, depths.repeat(grown.len()));
        }
        // Hair stands closer than its guides, and elsewhere on the scalp.
        let lineage = Lineage {
            parent: &|guide| (guide_of(guide), 0),
            of: &|hair| grown[hair].1,
            places: &|guide| evenly(guide_of(guide).curve(0), each),
            takes: &|name| ![RADIUS.name, SCALP_NORMAL.name].contains(&name),
        };
        lineage.pass_on(&mut out);
        Ok(out.build())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::eval::{Log, Quality};
    use crate::maths::hash::Dice;
    use crate::testing::{Memory, Threads, curves_of, run, run_on, with_points};
    use std::collections::{BTreeMap, BTreeSet};

    /// Guides all over the upper half of the ball, `length(i)` long, straight up from the skin.
    fn guides(n: u32, length: impl Fn(u32) -> f32) -> Curves {
        let scalp = shared_ball();
        let even = crate::guides::even_roots::EvenRoots::new(&scalp, Dice::new(0, 0, "guides"));
        let roots = (0..).filter_map(|i| even.root(i)).map(|root| root.1).take(n as usize);
        let tufts = (0..).zip(roots).map(|(i, root)| {
            let mut b = TuftBuilder::new();
            let at = |k: i32| root.point + root.normal * (length(i) * k as f32 / 6.0);
            b.push_curve(&(0..=6).map(at).collect::<Vec<_>>());
            b.set(ID, Domain::Curve, vec![u64::from(i) + 1]);
            Arc::new(b.build())
        });
        Curves::new(tufts.collect())
    }

    fn grow(guides: &Curves, set: &[(&str, Value)]) -> Curves {
        let given = [("guides", guides.clone().into()), ("scalp", shared_ball().into())];
        let mut set = [&given, set].concat();
        for (name, value) in [("by", "count".into()), ("count", Value::Int(2000))] {
            if set.iter().all(|(given, _)| *given != name) {
                set.push((name, value));
            }
        }
        let (out, _) = run(&NODE, &set);
        curves_of(&out[0]).clone()
    }

    fn by_id(curves: &Curves) -> BTreeMap<u64, Vec<Vec3>> {
        curves.each().map(|(t, i)| (t.id(i), t.curve(i).to_vec())).collect()
    }

    #[test]
    fn between_equal_guides_hair_is_equal_and_turns_with_the_scalp() {
        let hair = grow(&guides(100, |_| 4.0), &[]);
        assert_eq!(hair.curve_count(), 2000);
        let scalp = shared_ball();
        for (tuft, i) in hair.each() {
            let points = tuft.curve(i);
            let triangle = u32::try_from(tuft.view(ROOT_TRIANGLE).at(i, 0)).unwrap();
            let root = scalp.root(triangle, tuft.view(ROOT_BARY).at(i, 0));
            assert!(root.point.distance(points[0]) < 1e-5);
            for (k, p) in points.iter().enumerate() {
                let want = root.point + root.normal * (4.0 * k as f32 / 15.0);
                assert!(p.distance(want) < 1e-4, "{p} {want}");
            }
        }
    }

    #[test]
    fn a_combed_guide_makes_only_the_hair_that_follows_it_again() {
        let (host, scalp) = (Memory::default(), Value::from(shared_ball()));
        let grow = |guides: &Curves, width: f32| {
            let log = Log::default();
            let set = [
                ("guides", guides.clone().into()),
                ("scalp", scalp.clone()),
                ("density", Value::Float(20.0)),
                ("width", Value::Float(width)),
            ];
            let out = run_on(&NODE, &set, &host, &log, Quality::Final).unwrap();
            (curves_of(&out[0]).clone(), log.tufts_run.into_inner())
        };
        let input = guides(150, |_| 4.0);
        let (before, ran) = grow(&input, 0.01);
        assert_eq!(ran as usize, before.tufts().len());
        let mut tufts = input.tufts().to_vec();
        tufts[70] = with_points(&tufts[70], |points| points[6].x += 1.0).into();
        let combed = Curves::new(tufts);
        let (after, ran) = grow(&combed, 0.01);
        let changed: BTreeSet<u64> = {
            let (a, b) = (by_id(&before), by_id(&after));
            assert_eq!(a.len(), b.len());
            let differ = a.iter().filter(|(id, points)| b[id] != **points).map(|(id, _)| *id);
            let differ: BTreeSet<u64> = differ.collect();
            let parents = after.each().filter(|(t, i)| differ.contains(&t.id(*i)));
            parents.map(|(t, _)| t.view(PARENT).at(0, 0)).collect()
        };
        // What ran is what has the guide among those it reads: about its neighbours on the scalp.
        assert_eq!(ran as usize, changed.len());
        assert!((4..20).contains(&ran), "{ran}");
        assert_eq!(grow(&combed, 0.01).1, 0);
        assert_eq!(grow(&combed, 0.02).1 as usize, after.tufts().len());
    }

    #[test]
    fn more_hair_only_adds() {
        let input = guides(60, |i| 3.0 + i as f32 * 0.01);
        let some = by_id(&grow(&input, &[("count", Value::Int(700))]));
        let more = by_id(&grow(&input, &[("count", Value::Int(2000))]));
        assert_eq!((some.len(), more.len()), (700, 2000));
        assert!(some.iter().all(|(id, points)| more[id] == *points));
    }

    #[test]
    fn threads_change_nothing_and_ids_are_those_of_the_list() {
        let set = [
            ("guides", guides(300, |i| 2.0 + (i % 5) as f32).into()),
            ("scalp", Value::from(shared_ball())),
            ("by", "count".into()),
            ("count", Value::Int(9000)),
            ("seed", Value::Int(7)),
        ];
        let alone = curves_of(&run(&NODE, &set).0[0]).clone();
        let log = Log::default();
        let many = run_on(&NODE, &set, &Threads(5), &log, Quality::Final).unwrap();
        assert_eq!(alone.key(), curves_of(&many[0]).key());
        // The ball's edge is soft and leaves out a few of the list: what is left has the names of the first that are there, whatever
        // work they were found in, and each guide's hair lies in the order of the list.
        let scalp = shared_ball();
        let even = crate::guides::even_roots::EvenRoots::new(&scalp, Dice::new(0, 7, "roots"));
        let list = (0..).filter_map(|i| Some((i, even.root(i)?.0))).take(9000);
        let place: BTreeMap<u64, u32> = list.map(|(i, name)| (curve_id(0, 7, name), i)).collect();
        assert_eq!(alone.curve_count(), 9000);
        for tuft in alone.tufts() {
            let places: Vec<u32> = (0..tuft.len()).map(|i| place[&tuft.id(i)]).collect();
            assert!(places.is_sorted(), "{places:?}");
            for (i, place) in places.iter().enumerate() {
                assert_eq!(tuft.curve(i)[0], even.root(*place).unwrap().1.point);
            }
        }
    }

    #[test]
    fn hair_is_spread_more_evenly_than_by_chance() {
        let hair = grow(&guides(100, |_| 4.0), &[("count", Value::Int(8000))]);
        let roots: Vec<Vec3> = hair.each().map(|(t, i)| t.curve(i)[0]).collect();
        let tree = crate::maths::nearest::KdTree::new(roots.iter().copied());
        // Among places thrown by chance on an area, the nearest is on average half as far as their even spacing (Clark and Evans
        // 1954), and one in 127 is nearer than a twentieth of it: 1 - exp(-pi / 400).
        let even = (498.0f32 / 8000.0).sqrt();
        let mut near = vec![];
        let far = |p: &Vec3| {
            tree.find(*p, 2, &mut near);
            near[1].0.sqrt() / even
        };
        let far: Vec<f32> = roots.iter().map(far).collect();
        let mean = far.iter().sum::<f32>() / far.len() as f32;
        let close = far.iter().filter(|far| **far < 0.05).count();
        assert!(mean > 0.53 && close < 63, "{mean} of the even spacing, {close} close");
    }

    #[test]
    fn what_is_known_to_be_clear_is_not_asked_about_and_comes_out_the_same() {
        // Every other guide dives into the head, so that hair is in it, beside it and far off; each point as the skin alone would
        // have it. Guides that may lie as deep as they like give hair that nothing pushed.
        let input = guides(60, |i| if i % 2 == 0 { -3.0 } else { 4.0 });
        let deep = Curves::new(
            input
                .tufts()
                .iter()
                .map(|tuft| {
                    let mut b = tuft.edit();
                    b.set(ALLOW_DEPTH, Domain::Curve, vec![100.0]);
                    Arc::new(b.build())
                })
                .collect(),
        );
        let set = [("density", Value::Float(6.0)), ("by", "density".into())];
        let pushed = by_id(&grow(&input, &set));
        let (scalp, mut moved) = (shared_ball(), 0);
        let skin = scalp.skin();
        for (id, mut points) in by_id(&grow(&deep, &set)) {
            moved +=
                usize::from(crate::data::route::makers::clear(&skin, &mut points, |_| Some(0.0)));
            assert_eq!(points, pushed[&id]);
        }
        assert!(moved > 100 && moved < pushed.len(), "{moved} of {}", pushed.len());
    }

    #[test]
    fn nothing_pops_when_a_root_moves() {
        let input = guides(80, |i| 2.0 + (i % 7) as f32);
        let mut last = by_id(&grow(&input, &[]));
        let mut worst = 0.0f32;
        for step in 1..=20 {
            let mut tufts = input.tufts().to_vec();
            let shift = Vec3::new(0.02, 0.0, 0.015) * step as f32;
            let all = |points: &mut [Vec3]| points.iter_mut().for_each(|p| *p += shift);
            tufts[40] = with_points(&tufts[40], all).into();
            let now = by_id(&grow(&Curves::new(tufts), &[]));
            for (id, points) in &now {
                for (p, q) in points.iter().zip(&last[id]) {
                    worst = worst.max(p.distance(*q));
                }
            }
            last = now;
        }
        // Guides of 2 to 8 cm stand 2.5 cm apart; the root moves by 0.025 cm a step.
        assert!(worst < 0.3, "{worst}");
    }

    #[test]
    fn a_reach_leaves_bald_what_is_far() {
        let input = guides(40, |_| 4.0);
        let near = grow(&input, &[("by", "density".into()), ("reach", Value::Float(0.5))]);
        for (tuft, i) in near.each() {
            let guide = tuft.view(PARENT).at(i, 0);
            let root = input.each().find(|(t, i)| t.id(*i) == guide).unwrap().0.curve(0)[0];
            assert!(tuft.curve(i)[0].distance(root) < 0.5);
        }
    }

    #[test]
    fn no_hair_lies_in_the_head_and_a_preview_is_the_start_of_the_hair() {
        let scalp = shared_ball();
        // Guides that dive straight into the head.
        let input = guides(50, |i| if i % 2 == 0 { -3.0 } else { 4.0 });
        let set = [("guides", input.into()), ("scalp", Value::from(shared_ball()))];
        let set = [&set[..], &[("density", Value::Float(10.0))]].concat();
        let of = |quality| {
            let out = run_on(&NODE, &set, &crate::eval::PlainHost, &Log::default(), quality);
            curves_of(&out.unwrap()[0]).clone()
        };
        let (all, few) = (of(Quality::Final), of(Quality::Preview));
        let mut deepest = 0.0f32;
        for (tuft, i) in all.each() {
            for p in &tuft.curve(i)[1..] {
                let hit = scalp.surface().closest(*p).unwrap();
                deepest = deepest.min(scalp.surface().signed_distance(*p, &hit));
            }
        }
        assert!(deepest >= 0.0, "{deepest}");
        let all = by_id(&all);
        assert!(few.curve_count() < all.len());
        assert!(by_id(&few).iter().all(|(id, points)| all[id] == *points));
    }

    #[test]
    fn what_a_reach_leaves_missing_of_a_count_is_told() {
        let check = |reach: f32, said: &[&str]| {
            let set = [
                ("guides", guides(20, |_| 3.0).into()),
                ("scalp", shared_ball().into()),
                ("by", "count".into()),
                ("count", Value::Int(1000)),
                ("reach", Value::Float(reach)),
            ];
            let (out, found) = run(&NODE, &set);
            assert_eq!(found.len(), said.len(), "{reach}: {found:?}");
            let there = curves_of(&out[0]).curve_count();
            for (found, said) in found.iter().zip(said) {
                assert!(found.starts_with(&said.replace("{}", &there.to_string())), "{found}");
            }
        };
        // 10,000 places are looked at: about 20 guides, of 249 cm2 a quarter is more than enough, a fiftieth a fifth of it.
        check(1.0, &[]);
        check(0.3, &["only {} of 1000 hairs have a root"]);
    }

    #[test]
    fn a_mask_keeps_its_share_of_more_than_two_million_hairs() {
        let count = 2_500_000;
        assert!(NODE.input("count").unwrap().1.hard.unwrap().1 >= count as f64);
        let set = [
            ("count", Value::Int(count)),
            ("mask", Value::Float(0.0004)),
            ("guides_per_hair", Value::Int(1)),
        ];
        let kept = grow(&guides(20, |_| 3.0), &set).curve_count();
        assert!((900..1100).contains(&kept), "{kept}");
    }

    #[test]
    fn guides_that_are_none_are_left_out_and_no_guides_give_no_hair() {
        let mut tufts = guides(10, |_| 3.0).tufts().to_vec();
        tufts[4] = with_points(&tufts[4], |points| points[2] = Vec3::NAN).into();
        let input = Value::from(Curves::new(tufts));
        let set =
            [("guides", input), ("scalp", shared_ball().into()), ("density", Value::Float(1.0))];
        let (out, said) = run(&NODE, &set);
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(curves_of(&out[0]).each().all(|(t, i)| t.curve(i).iter().all(|p| p.is_finite())));
        assert_eq!(grow(&Curves::default(), &[]).curve_count(), 0);
    }
}
