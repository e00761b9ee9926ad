//! Baby hair: short, fine hair along the hairline, natural or laid.
//!
//! Each hair is traced over the skin from its root in a direction that turns along the way: freely, along the hairline,
//! or in waves. Guarantees: roots lie on the scalp, within the band and off every parting; no hair crosses a parting
//! (it ends before one); points stay off the skin; a higher density only adds hairs. Not promised: that the scalp's
//! other hair leaves room; thin that out at the edge with a mask.

use super::hairline::{Hairline, hairlines};
use crate::data::attributes::{
    Domain, GROUP, ID, ROOT_BARY, ROOT_TRIANGLE, SCALP_NORMAL, SECTION, WIDTH,
};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::route::makers;
use crate::data::scalp::{Root, Scalp};
use crate::data::sections::Sections;
use crate::define::{FieldInput, NodeError, choice, node};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::frame::{across, any_normal, smallest_rotation};
use crate::maths::hash::{Dice, KeyBuilder, curve_id};
use crate::maths::low_discrepancy::r2;
use crate::maths::smoothstep;
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos;
use crate::scalp::lay::bind;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

node! {
    /// Short, fine hair along the hairline: natural, laid or swooped edges.
    ///
    /// Natural edges stand softly off the skin; laid edges are combed flat along the hairline; swooped edges lie in
    /// S-waves, one lock at a time. On a parted scalp they stay in their sections.
    "baby_hair", version 1, label "Baby hair", words "edges baby hair hairline laid swoop swooped slick fuzz wisp fringe border fine short", thins, scales;
    inputs {
        /// The head.
        scalp: Arc<Scalp>;
        /// How the hair lies.
        style: Style = Style::Natural, words("laid swoop edges");
        /// Hairs per centimetre of hairline.
        per_cm: f32 = 30.0, hard(0.0, 2000.0), soft(2.0, 150.0), unit(PerCm), words("density count amount");
        /// Fraction of hairs to keep; usually a painted mask.
        mask: FieldInput = 1.0, hard(0.0, 1.0), unit(Ratio), words("area where front nape temples");
        /// Length of the hairs.
        length: f32 = 1.6, hard(0.05, 30.0), soft(0.5, 3.0), unit(Length);

        [Placement]
        /// Width of the band behind the hairline that they are rooted in.
        band: f32 = 0.7, hard(0.0, 10.0), soft(0.1, 2.0), unit(Length), words("depth zone");
        /// How far in front of the hairline the first hairs are rooted, where hair grows at all.
        ahead: f32 = 0.12, hard(0.0, 5.0), soft(0.0, 0.5), unit(Length), words("soft edge start");
        /// Position of the parting that the hairs lie away from: 0 is the midline, positive is nearer the head's left
        /// ear. Match the parting of the other hair.
        parted_at: f32 = 0.0, hard(-20.0, 20.0), soft(-6.0, 6.0), unit(Length), words("part side middle centre");

        [Shape]
        /// Direction in which they lie: 0 is straight out over the face, 90 along the hairline away from the parting,
        /// -90 toward it.
        direction: f32 = 35.0, hard(-180.0, 180.0), soft(-90.0, 90.0), unit(Angle), handle(Handle::Angle), words("comb flow sweep");
        /// Height of the tips above the skin.
        lift: f32 = 0.12, hard(0.0, 10.0), soft(0.0, 1.0), unit(Length), words("height off");
        /// How far swoops turn to each side.
        wave: f32 = 65.0, hard(0.0, 180.0), soft(0.0, 120.0), unit(Angle), words("swoop amplitude s-wave finger wave");
        /// Length of one full wave of a swoop.
        wave_length: f32 = 2.2, hard(0.1, 30.0), soft(0.5, 6.0), unit(Length), words("period");

        [Clumping]
        /// Width of a lock along the hairline.
        lock: f32 = 0.8, hard(0.05, 30.0), soft(0.2, 3.0), unit(Length), words("clump width group");
        /// How much the hairs of a lock converge toward its tip.
        gather: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("clump tightness");

        [Thickness]
        /// Diameter at the root; baby hair is finer than other hair.
        width_root: f32 = 0.004, hard(0.0001, 1.0), soft(0.001, 0.01), unit(Length), fixed(), words("thickness diameter");
        /// Diameter at the tip.
        width_tip: f32 = 0.0012, hard(0.0001, 1.0), soft(0.0003, 0.01), unit(Length), fixed(), words("thickness diameter taper");

        [Detail]
        /// CVs per hair, root and tip included.
        points: i64 = 12, hard(4.0, 255.0), soft(6.0, 32.0), unit(Count), words("cvs segments resolution");
        /// Scale lengths with the size of the head. The number of hairs and their widths stay.
        scale_with_head: bool = true, words("head units");

        [Randomness]
        /// Random shortening of each hair: 0 keeps the full length, 0.95 allows down to a twentieth of it. The foremost
        /// hairs are the shortest.
        length_variation: f32 = 0.55, hard(0.0, 0.95), unit(Ratio), words("random vary");
        /// Random variation in direction, lift and bend.
        unevenness: f32 = 0.5, hard(0.0, 1.0), unit(Ratio), words("random messy natural");
        /// Random seed for this node. It changes ids too.
        seed: i64 = 0;
    }
    outputs {
        /// The hairs, with the lock number as group.
        curves: Curves;
    }
}

choice! {
    /// How the hair lies.
    Style {
        /// Each hair in its own direction, as it grows.
        Natural = "natural",
        /// Combed flat along the hairline.
        Laid = "laid",
        /// Laid in S-waves, one lock at a time.
        Swooped = "swooped",
    }
}

/// Hairs per work item.
const BATCH: usize = 1024;
/// Smallest height above the skin, cm on a head of average size: a hair's own thickness.
const CLEAR: f32 = 0.006;
/// Steps in which a hair is traced.
const STEPS: usize = 28;

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let scalp = &*inputs.scalp;
    let Some(hairline) = hairlines(scalp).into_iter().next() else {
        cx.warn("the scalp has no hairline: hair grows nowhere or everywhere");
        return Ok(Outputs { curves: Curves::default() });
    };
    cx.check()?;
    let count = (inputs.per_cm * hairline.line.length()).round() as usize;
    let count = cx.makes(count.min(2_000_000));
    let maker = Maker {
        inputs: &inputs,
        scalp,
        unit: cx.unit(),
        hairline,
        spot: [cx.dice(inputs.seed, "place").unit(0, 0), cx.dice(inputs.seed, "place").unit(0, 1)],
        dice: cx.dice(inputs.seed, "hair"),
        locks: cx.dice(inputs.seed, "lock"),
        keep: cx.dice(inputs.seed, "mask"),
    };
    let key = |i: usize| {
        KeyBuilder::new("edge").int(i as u64).int(((i + 1) * BATCH).min(count) as u64).finish()
    };
    let size = Size::of(&[("hairs", count as f64), ("points", inputs.points as f64)]);
    let [curves] = cx.each_item(count.div_ceil(BATCH), &size, key, |i, piece| {
        Ok([maker.hairs(i * BATCH..((i + 1) * BATCH).min(count), piece)?])
    })?;
    Ok(Outputs { curves })
}

struct Maker<'a> {
    inputs: &'a Inputs,
    scalp: &'a Scalp,
    /// Centimetres per head unit.
    unit: f32,
    hairline: Hairline,
    spot: [f32; 2],
    dice: Dice,
    locks: Dice,
    keep: Dice,
}

/// Start of a hair: its root, the direction out over the face, and the direction along the hairline away from the
/// middle of the head.
struct Start {
    root: Root,
    out: Vec3,
    along: Vec3,
    /// 0 at the hairline, 1 at the back of the band.
    depth: f32,
}

impl Maker<'_> {
    /// The start at a fraction of the hairline and a depth (cm) behind it.
    fn start(&self, part: f32, depth: f32) -> Option<Start> {
        let frame = self.scalp.frame();
        let (edge, tangent) = self.hairline.at(part);
        let at_edge = self.scalp.closest_root(edge)?;
        let inward = tangent.cross(at_edge.normal).normalize_or_zero();
        let root = self.scalp.closest_root(edge + inward * depth)?;
        let p = frame.head_from_vector(root.point - frame.origin) / frame.radius;
        let front = p.z.abs().min(1.0);
        let x = p.x - self.inputs.parted_at / frame.radius;
        let away =
            frame.right * (x.signum() * front) - frame.up * (1.0 - front) - frame.forward * 0.2;
        let along = if tangent.dot(away) < 0.0 { -tangent } else { tangent };
        let out = across(-inward, root.normal).unwrap_or_else(|| any_normal(root.normal));
        let along = across(along, root.normal).unwrap_or(out);
        let depth = (depth / self.inputs.band.max(1e-3)).clamp(0.0, 1.0);
        Some(Start { root, out, along, depth })
    }

    fn hairs(&self, range: std::ops::Range<usize>, piece: &mut Piece) -> Result<Tuft, NodeError> {
        let inputs = self.inputs;
        let (band, ahead) = (inputs.band, inputs.ahead);
        let mut starts = vec![];
        for i in range {
            piece.tick()?;
            let [part, b] = r2(i as u32, self.spot);
            let Some(start) = self.start(part, b * (band + ahead) - ahead) else { continue };
            let (root, id) = (&start.root, curve_id(0, inputs.seed as u64, i as u64));
            let grows = self.scalp.grows(root.triangle, root.bary);
            // Baby hair fades with the region.
            let chance = (2.0 * grows).min(1.0);
            if self.dice.unit(id, 9) < chance && self.scalp.is_free(root) {
                starts.push((id, part, start));
            }
        }
        let mut b = TuftBuilder::even(starts.iter().map(|(.., s)| s.root.point).collect(), 1);
        if starts.is_empty() {
            return Ok(b.build());
        }
        let triangles = starts.iter().map(|(.., s)| s.root.triangle as i32).collect();
        b.set(ROOT_TRIANGLE, Domain::Curve, triangles);
        b.set(ROOT_BARY, Domain::Curve, starts.iter().map(|(.., s)| s.root.bary).collect());
        let bound = b.build();
        let mask = inputs.mask.on(&bound, Some(self.scalp))?;

        let n = inputs.points as usize;
        let locks = (self.hairline.line.length() / inputs.lock).ceil().max(1.0);
        let mut middles: BTreeMap<u64, Option<Vec<Vec3>>> = BTreeMap::new();
        let (mut ids, mut groups, mut roots, mut points) = (vec![], vec![], vec![], vec![]);
        for (slot, (id, part, start)) in starts.iter().enumerate() {
            piece.tick()?;
            if self.keep.unit(*id, 0) >= mask.at(slot, slot, 0.0) {
                continue;
            }
            // Locks differ in width, so that their borders do not look like a fence.
            let lock = {
                let at = part * locks;
                let border = 0.35 * self.locks.signed(at.floor() as u64, 7);
                (at + border).floor().max(0.0) as u64
            };
            let gathered = inputs.style != Style::Natural && inputs.gather > 0.0;
            let middle = match gathered {
                true => middles
                    .entry(lock)
                    .or_insert_with(|| {
                        let part = (lock as f32 + 0.5) / locks;
                        let start = self.start(part, 0.5 * band)?;
                        self.walked(&start, lock, None, inputs.length)
                    })
                    .as_deref(),
                false => None,
            };
            let short = inputs.length_variation * self.dice.unit(*id, 0);
            let length = inputs.length * (1.0 - short) * (0.65 + 0.35 * start.depth);
            let Some(walk) = self.walked(start, lock, Some(*id), length) else { continue };
            if self.laid_out(start, &walk, middle, *id, n, &mut points) {
                ids.push(*id);
                groups.push(lock as i32);
                roots.push(start.root);
            }
        }
        let mut tuft = TuftBuilder::even(points, n);
        if tuft.is_empty() {
            return Ok(tuft.build());
        }
        let count = tuft.len();
        tuft.set(ID, Domain::Curve, ids);
        if inputs.style != Style::Natural {
            tuft.set(GROUP, Domain::Curve, groups);
        }
        tuft.set(SCALP_NORMAL, Domain::Curve, roots.iter().map(|r| r.normal).collect());
        if let Some(sections) = self.scalp.sections() {
            let id = |root: &Root| sections.id_of(root).unwrap_or_default();
            tuft.set(SECTION, Domain::Curve, roots.iter().map(id).collect());
        }
        bind(&mut tuft, &roots);
        let width = |k: usize| {
            let u = k as f32 / (n - 1) as f32;
            inputs.width_root + (inputs.width_tip - inputs.width_root) * u
        };
        let widths: Vec<f32> = (0..n).map(width).collect();
        tuft.set(WIDTH, Domain::Point, widths.repeat(count));
        Ok(tuft.build())
    }

    /// A path over the skin: [`STEPS`] equal steps, fewer if a parting is in the way. `id` is that of the hair, `None`
    /// for the centre of a lock.
    fn walked(&self, start: &Start, lock: u64, id: Option<u64>, length: f32) -> Option<Vec<Vec3>> {
        let inputs = self.inputs;
        let stray =
            |index: u64| id.map_or(0.0, |id| self.dice.signed(id, index)) * inputs.unevenness;
        let of_lock = |index: u64| self.locks.signed(lock, index) * inputs.unevenness;
        let asked = inputs.direction.to_radians();
        let (wave, wave_length) = (inputs.wave.to_radians(), inputs.wave_length);
        let flat = std::f32::consts::FRAC_PI_2 * if asked < 0.0 { -1.0 } else { 1.0 };
        let (phase, bend) = (0.12 * of_lock(0), stray(2));
        // The angle from straight out, at a fraction of the path.
        let angle = |s: f32| match inputs.style {
            Style::Natural => asked + 0.9 * stray(1) + 1.2 * bend * s,
            Style::Laid => {
                let t = (2.2 * s).min(1.0);
                let turned = asked + (flat - asked) * smoothstep(t);
                turned + 0.12 * stray(1) + 0.15 * of_lock(1) * s
            }
            Style::Swooped => {
                let (_, cos) = sin_cos(std::f32::consts::TAU * (s * length / wave_length + phase));
                flat * (0.55 + 0.1 * of_lock(1)) - flat.signum() * wave * cos + 0.06 * stray(1)
            }
        };
        let skin = self.scalp.skin();
        let turn = |v: Vec3, axis: Vec3, by: f32| {
            let (sin, cos) = sin_cos(by);
            v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
        };
        let (sin, cos) = sin_cos(angle(0.0));
        let mut way = (start.out * cos + start.along * sin).try_normalize()?;
        // Turning from out to along may be left- or right-handed about the normal.
        let hand = start.out.cross(start.along).dot(start.root.normal).signum();
        let (mut p, mut normal, mut near) =
            (start.root.point, start.root.normal, start.root.triangle);
        let mut line = vec![p];
        let step = length / STEPS as f32;
        for k in 1..=STEPS {
            let s = k as f32 / STEPS as f32;
            let hit = skin.foot(p + way * step, &mut near)?;
            let foot = (hit.triangle, hit.bary);
            if self.scalp.sections().is_some_and(|cut| is_parted(cut, p, hit.point, foot)) {
                break;
            }
            let below = skin.smooth_normal(&hit);
            way = smallest_rotation(normal, below) * way;
            way = across(way, below).unwrap_or(way);
            way = turn(way, below, hand * (angle(s) - angle(s - 1.0 / STEPS as f32)));
            (p, normal) = (hit.point, below);
            line.push(p);
        }
        // A hair that runs into a parting at once is dropped.
        (line.len() > STEPS / 4).then_some(line)
    }

    /// Lays a hair along its path, drawn toward the centre of its lock; false if it has no length.
    fn laid_out(
        &self,
        start: &Start,
        walk: &[Vec3],
        middle: Option<&[Vec3]>,
        id: u64,
        n: usize,
        points: &mut Vec<Vec3>,
    ) -> bool {
        let inputs = self.inputs;
        let lift = inputs.lift * (1.0 + 0.8 * inputs.unevenness * self.dice.signed(id, 3));
        let clear = CLEAR * self.unit;
        let skin = self.scalp.skin();
        let mut near = start.root.triangle;
        let mut line = Vec::with_capacity(walk.len());
        let mut feet = Vec::with_capacity(walk.len());
        for (k, p) in walk.iter().enumerate() {
            let s = k as f32 / (walk.len() - 1) as f32;
            let mut p = *p;
            if let Some(middle) = middle {
                // The lock's centre keeps its length: a shorter hair ends beside an earlier part of it.
                let part = s * (walk.len() - 1) as f32 / STEPS as f32;
                let at = (part * (middle.len() - 1) as f32) as usize;
                let beside = walk[0] - middle[0];
                let share = inputs.gather * s * (2.0 - s);
                let to = middle[at.min(middle.len() - 1)] + beside * (1.0 - 0.85 * share);
                p = p.lerp(to, share);
            }
            let Some(hit) = skin.foot(p, &mut near) else { return false };
            let normal = skin.smooth_normal(&hit);
            let height = (clear * (6.0 * s).min(1.0)).max(lift * s * s.sqrt());
            line.push(if k == 0 { hit.point } else { hit.point + normal * height });
            feet.push((hit.triangle, hit.bary));
        }
        line[0] = start.root.point;
        if let Some(cut) = self.scalp.sections() {
            // A hair that was drawn across a parting is cut before it.
            let mut steps = line.windows(2).zip(&feet[1..]);
            let over = steps.position(|(w, foot)| is_parted(cut, w[0], w[1], *foot));
            if let Some(k) = over {
                line.truncate(k + 1);
            }
        }
        if line.len() <= STEPS / 4 {
            return false;
        }
        let Ok(spline) = Spline::new(&line) else { return false };
        let from = points.len();
        spline.resample(n, |p| points.push(p));
        points[from] = start.root.point;
        // Queries the surface directly: a distance field costs more than a whole hairline of hair.
        near = start.root.triangle;
        for p in &mut points[from + 1..] {
            let Some(hit) = skin.foot(*p, &mut near) else { return false };
            if skin.height_over(*p, &hit) >= 0.5 * clear {
                continue;
            }
            *p = hit.point + skin.smooth_normal(&hit) * (0.5 * clear);
            // In a fold, the way out of one side leads into the other.
            if skin.has_clear_inside() {
                let again = skin.foot(*p, &mut near.clone());
                if again.is_some_and(|hit| skin.height_over(*p, &hit) < 0.0) {
                    *p = makers::lift(&skin, *p, 0.5 * clear).0;
                }
            }
        }
        // In folds, a path that stays in its section on the scalp may still cross a parting in the air.
        let cut = self.scalp.sections();
        if cut.is_some_and(|cut| cut.is_over_line(&points[from..])) {
            points.truncate(from);
            return false;
        }
        true
    }
}

/// Whether a step over the scalp crosses a parting or ends on its bare skin; `foot` is what is closest to its end.
fn is_parted(cut: &Sections, from: Vec3, to: Vec3, foot: (u32, Vec2)) -> bool {
    cut.at_over(to, foot).is_some_and(|place| !place.free) || cut.crosses(from, to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::define::Value;
    use crate::testing::{curves_of, run};

    fn head() -> Arc<Scalp> {
        static HEAD: std::sync::OnceLock<Arc<Scalp>> = std::sync::OnceLock::new();
        let make = || match run(crate::by_id("head").unwrap(), &[]).0.remove(0) {
            Value::Scalp(scalp) => scalp,
            other => panic!("a {}", other.type_name()),
        };
        HEAD.get_or_init(make).clone()
    }

    #[test]
    fn edges_are_rooted_at_the_hairline_stay_off_the_skin_and_cross_no_parting() {
        let parted = [("scalp", head().into()), ("pattern", "straight_back".into())];
        let (out, _) = run(crate::by_id("partings").unwrap(), &parted);
        let Value::Scalp(scalp) = &out[0] else { panic!() };
        let skin = scalp.skin();
        let sections = scalp.sections().unwrap();
        let hairline = hairlines(scalp);
        assert!((60.0..110.0).contains(&hairline[0].line.length()));
        for style in ["natural", "laid", "swooped"] {
            let set = [
                ("scalp", scalp.clone().into()),
                ("style", style.into()),
                ("per_cm", Value::Float(12.0)),
            ];
            let (out, said) = run(&NODE, &set);
            let hairs = curves_of(&out[0]);
            assert!(hairs.curve_count() > 500, "{style}: {} {said:?}", hairs.curve_count());
            for (tuft, i) in hairs.each() {
                let points = tuft.curve(i);
                let far = |p: &Vec3| p.distance(points[0]);
                let edge = hairline[0].line.points.iter().map(far).fold(f32::MAX, f32::min);
                assert!(edge < 0.95, "{style}: {edge}");
                assert!(scalp.surface().closest(points[0]).unwrap().distance < 1e-3);
                assert!(sections.at(points[0]).unwrap().free);
                assert!(points[1..].iter().all(|p| skin.distance(*p) > 0.0), "{style}");
                assert!(points.windows(2).all(|w| !sections.crosses(w[0], w[1])), "{style}");
                let length = Spline::new(points).unwrap().length();
                assert!((0.1..1.8).contains(&length), "{style}: {length}");
            }
        }
    }

    #[test]
    fn more_hairs_only_add() {
        let ids = |per_cm: f32| {
            let set = [("scalp", head().into()), ("per_cm", Value::Float(per_cm))];
            let (out, _) = run(&NODE, &set);
            let all = curves_of(&out[0]);
            all.each().map(|(t, i)| (t.id(i), t.curve(i).to_vec())).collect::<BTreeMap<_, _>>()
        };
        let (few, many) = (ids(3.0), ids(6.0));
        assert!(few.len() < many.len());
        assert!(few.iter().all(|(id, points)| many[id] == *points));
    }
}
