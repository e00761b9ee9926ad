//! Separation: curves that are too close to each other move apart.
//!
//! In each pass every point moves half of what it lacks away from the nearest part of each curve around it, as they were
//! before the pass; then each curve gets its lengths back, from the root on. So nothing depends on the order of curves, and a
//! tuft reads only the tufts near it. The points of a tuft stand in a tree of boxes as large as their room, which every link
//! around goes down once: what a pass costs grows with the hair, and with how many curves are too near to each, and not with
//! how long links are beside the room.
//!
//! Guarantees: roots stay; the distance between points along a curve is kept; nothing moves where curves keep their distance,
//! with no passes or with no strength; no point ends under the skin; a curve that too many are near to is told once. Not
//! promised: that the distance is reached where there is no room, close to roots, or in the few passes asked for, in which the
//! middle of a thick bundle does not learn that there is room outside; that two curves do not cross between their points.

use crate::data::attributes::{ALLOW_DEPTH, Domain, ID, RADIUS, WIDTH};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::{Field, Sampler};
use crate::data::ramp::Ramp;
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece};
use crate::maths::box_tree::{Block, BoxTree, Rod};
use crate::maths::hash::{KeyBuilder, mix};
use glam::Vec3;
use std::collections::BTreeSet;
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
    // A curve is crowded in one pass or in all, and told once.
    let mut crowded = BTreeSet::new();
    for _ in 0..inputs.passes {
        cx.check()?;
        let [next, crowd] = pass(cx, &inputs, &curves)?;
        crowded.extend(crowd.each().map(|(tuft, i)| tuft.id(i)));
        if next.key() == curves.key() {
            break;
        }
        curves = next;
    }
    crowded.into_iter().for_each(|id| cx.trouble(id, CROWDED));
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

/// A tuft with what every tuft near it asks of it.
struct Laid<'a> {
    tuft: &'a Tuft,
    ids: Vec<u64>,
    /// Room around each point, cm.
    rooms: Vec<f32>,
    /// Where each curve is with its room; nothing where it has no points.
    curves: Vec<Option<(Vec3, Vec3)>>,
}

impl<'a> Laid<'a> {
    fn new(inputs: &Inputs, tuft: &'a Tuft) -> Result<Self, NodeError> {
        let (radius, id) = (room(inputs, tuft)?, tuft.view(ID));
        let ids = (0..tuft.len()).map(|i| id.at(i, tuft.range(i).start)).collect();
        let mut rooms = Vec::with_capacity(tuft.points().len());
        let mut curves = Vec::with_capacity(tuft.len());
        for i in 0..tuft.len() {
            let range = tuft.range(i);
            let (first, last) = (range.start, range.len().max(2) - 1);
            let at = |p: usize| radius.at(i, p, (p - first) as f32 / last as f32) * inputs.scale;
            rooms.extend(range.map(at));
            let (mut low, mut high, mut widest) = (Vec3::MAX, Vec3::MIN, 0.0f32);
            for (p, room) in
                tuft.curve(i).iter().zip(&rooms[first..]).filter(|(p, _)| p.is_finite())
            {
                (low, high, widest) = (low.min(*p), high.max(*p), widest.max(*room));
            }
            curves.push((low.x <= high.x).then(|| (low - widest, high + widest)));
        }
        Ok(Self { tuft, ids, rooms, curves })
    }
    /// The links of a curve, whose turn it is, each with its number.
    fn links(&self, curve: usize, turn: u32) -> impl Iterator<Item = (usize, Link)> {
        let (id, points) = (self.ids[curve], self.tuft.curve(curve));
        let rooms = &self.rooms[self.tuft.range(curve)];
        points.windows(2).zip(rooms.windows(2)).enumerate().filter_map(move |(k, (p, room))| {
            let (from, to) = (p[0], p[1]);
            let link = Link { id, turn, from, to, room: (room[0], room[1]) };
            (from.is_finite() && to.is_finite()).then_some((k, link))
        })
    }
}

/// A curve that comes near the points of a tuft.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Hair {
    /// A number drawn by its id: the order of tufts does not matter, and the first curves of a crowd are any of them.
    draw: u64,
    tuft: u32,
    curve: u32,
    /// Which of its links do, one bit each; the last bit stands for all further ones.
    links: u64,
}

/// Both as one box.
fn joined(a: Option<(Vec3, Vec3)>, b: &Option<(Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    match (a, *b) {
        (Some((low, high)), Some((l, h))) => Some((low.min(l), high.max(h))),
        (one, other) => one.or(other),
    }
}

/// Moves all curves once; those after it that are crowded, by their roots.
fn pass(cx: &EvalCx, inputs: &Inputs, curves: &Curves) -> Result<[Curves; 2], NodeError> {
    let tufts = curves.tufts();
    let mut laid = Vec::with_capacity(tufts.len());
    for tuft in tufts {
        cx.check()?;
        laid.push(Laid::new(inputs, tuft)?);
    }
    // Tufts without points are near nothing, and nothing is near them.
    let (boxes, numbers): (Vec<(Vec3, Vec3)>, Vec<u32>) = (0..)
        .zip(&laid)
        .filter_map(|(n, laid)| Some((laid.curves.iter().fold(None, joined)?, n)))
        .unzip();
    let blocks: Vec<Block> = boxes.iter().map(|(low, high)| Block::new(*low, *high)).collect();
    let tree = BoxTree::new(&boxes);
    let mut near = vec![vec![]; tufts.len()];
    let mut found = vec![];
    for (block, number) in blocks.iter().zip(&numbers) {
        tree.find(|_, other| other.touches(block), &mut found);
        let told = found.iter().flat_map(|leaf| &tree.order()[leaf.boxes.clone()]);
        let touched = told.filter(|n| blocks[**n as usize].touches(block));
        let mut touched: Vec<u32> = touched.map(|n| numbers[*n as usize]).collect();
        touched.sort_unstable();
        near[*number as usize] = touched;
    }
    let key = |i: usize| {
        let key = KeyBuilder::new("apart").key(tufts[i].key());
        near[i].iter().fold(key, |key, n| key.key(tufts[*n as usize].key())).finish()
    };
    cx.each_item(tufts.len(), key, |i, piece| {
        let around: Vec<&Laid> = near[i].iter().map(|n| &laid[*n as usize]).collect();
        apart(cx, inputs, &laid[i], &around, piece)
    })
}

/// The most curves that push one point. Some six have room around one at the distance asked for: among so many nothing
/// comes apart in a few passes, and those that are looked at, a random choice of them, push where all would.
const MOST_NEAR: u32 = 256;
const CROWDED: &str = "more curves are near than can be kept apart, and only some of them were: lower the radius or the scale";

/// A point that may be pushed.
struct Spot {
    at: Vec3,
    room: f32,
    id: u64,
    point: u32,
    curve: u32,
}

/// What pushes a point.
#[derive(Clone, Copy, Default)]
struct Push {
    /// Of all curves before the last one.
    sum: Vec3,
    /// The most that the distance to one of them lacks, halved.
    most: f32,
    /// The last curve that came near, by its turn from 1 on: what the distance to its nearest part lacks, and the way.
    turn: u32,
    lacks: f32,
    way: Vec3,
    /// How many came near.
    curves: u32,
}

impl Push {
    /// Whether more came near than may push.
    fn is_over(&self) -> bool {
        self.curves > MOST_NEAR
    }
    /// Part of a curve came near. The parts of one curve come one after the other; the nearest of them counts.
    #[inline]
    fn add(&mut self, turn: u32, lacks: f32, way: Vec3) {
        if self.turn == turn {
            if lacks > self.lacks {
                (self.lacks, self.way) = (lacks, way);
            }
            return;
        }
        self.curves += 1;
        if !self.is_over() {
            self.take_last();
            (self.turn, self.lacks, self.way) = (turn, lacks, way);
        }
    }
    fn take_last(&mut self) {
        self.sum += self.way * self.lacks;
        self.most = self.most.max(self.lacks);
        (self.lacks, self.way) = (0.0, Vec3::ZERO);
    }
}

/// What all curves around push the points of a tuft.
fn pushes(
    laid: &Laid,
    around: &[&Laid],
    piece: &mut Piece,
) -> Result<(Vec<Spot>, Vec<Push>), NodeError> {
    let tuft = laid.tuft;
    let mut spots = vec![];
    for i in 0..tuft.len() {
        let (id, range) = (laid.ids[i], tuft.range(i));
        // Roots stay.
        for point in range.skip(1).filter(|p| tuft.points()[*p].is_finite()) {
            let (at, room) = (tuft.points()[point], laid.rooms[point]);
            spots.push(Spot { at, room, id, point: point as u32, curve: i as u32 });
        }
    }
    let boxes: Vec<(Vec3, Vec3)> = spots.iter().map(|s| (s.at - s.room, s.at + s.room)).collect();
    let tree = BoxTree::new(&boxes);
    drop(boxes);
    let mut hairs = vec![];
    for (n, other) in (0..).zip(around) {
        for (i, corners) in other.curves.iter().enumerate() {
            piece.tick()?;
            let Some((low, high)) = corners else { continue };
            let block = Block::new(*low, *high);
            if !tree.any(|_, node| node.touches(&block)) {
                continue;
            }
            // Of other tufts most that comes so near passes by all the same; not so of the tuft itself.
            let links = if std::ptr::eq(*other, laid) {
                u64::MAX
            } else {
                let mut near = 0;
                for (k, link) in other.links(i, 0) {
                    piece.tick()?;
                    let rod = link.rod();
                    near |= u64::from(tree.any(|_, node| rod.touches(node))) << k.min(63);
                }
                near
            };
            if links != 0 {
                hairs.push(Hair { draw: mix(other.ids[i]), tuft: n, curve: i as u32, links });
            }
        }
    }
    hairs.sort_unstable();
    let mut found = vec![];
    // As they lie in the tree.
    let mut spots: Vec<Option<Spot>> = spots.into_iter().map(Some).collect();
    let spots: Vec<Spot> =
        tree.order().iter().filter_map(|number| spots[*number as usize].take()).collect();
    let mut pushed = vec![Push::default(); spots.len()];
    // How many points under each node do not have enough yet: where all have, nothing more is looked for.
    let mut open = vec![0u32; tree.nodes()];
    tree.find(|_, _| true, &mut found);
    for leaf in &found {
        above(leaf.node, |node| open[node] += leaf.boxes.len() as u32);
    }
    for (turn, hair) in (1..).zip(hairs) {
        for (k, link) in around[hair.tuft as usize].links(hair.curve as usize, turn) {
            piece.tick()?;
            if hair.links >> k.min(63) & 1 == 0 {
                continue;
            }
            let rod = link.rod();
            tree.find(|node, block| open[node] > 0 && rod.touches(block), &mut found);
            for leaf in &found {
                piece.tick()?;
                let boxes = leaf.boxes.clone();
                let full = link.push(&spots[boxes.clone()], &mut pushed[boxes]);
                if full > 0 {
                    above(leaf.node, |node| open[node] -= full);
                }
            }
        }
    }
    pushed.iter_mut().for_each(Push::take_last);
    Ok((spots, pushed))
}

/// Does something at a node of a tree and at all above it.
fn above(mut node: usize, mut at: impl FnMut(usize)) {
    at(node);
    while node > 0 {
        node = (node - 1) / 2;
        at(node);
    }
}

/// A piece of a curve, from one point to the next, with the room at both.
struct Link {
    id: u64,
    turn: u32,
    from: Vec3,
    to: Vec3,
    room: (f32, f32),
}

impl Link {
    /// What its room takes up.
    fn rod(&self) -> Rod {
        Rod::new(self.from, self.to, self.room.0.max(self.room.1))
    }
    /// Pushes those points of other curves that it is near; how many of them have enough by it.
    #[inline]
    fn push(&self, spots: &[Spot], pushed: &mut [Push]) -> u32 {
        let way = self.to - self.from;
        let per_length = 1.0 / way.length_squared().max(1e-12);
        let mut full = 0;
        for (spot, push) in spots.iter().zip(pushed) {
            let t = ((spot.at - self.from).dot(way) * per_length).clamp(0.0, 1.0);
            let off = spot.at - (self.from + way * t);
            let wanted = spot.room + self.room.0 + (self.room.1 - self.room.0) * t;
            let d2 = off.length_squared();
            if d2 < wanted * wanted && spot.id != self.id && !push.is_over() {
                let d = d2.sqrt();
                // Two curves at one place: each its own way, opposite ones.
                let out = if d > 1e-5 * wanted {
                    off / d
                } else {
                    let bits = mix(spot.id ^ self.id);
                    let part = |s: u32| ((bits >> s) & 0xFFFF) as f32 / 32768.0 - 1.0;
                    let any = Vec3::new(part(0), part(16), part(32)).normalize_or(Vec3::X);
                    if spot.id < self.id { any } else { -any }
                };
                push.add(self.turn, 0.5 * (wanted - d), out);
                full += u32::from(push.is_over());
            }
        }
        full
    }
}

/// A tuft moved away from all curves around it, and its crowded curves.
fn apart(
    cx: &EvalCx,
    inputs: &Inputs,
    laid: &Laid,
    around: &[&Laid],
    piece: &mut Piece,
) -> Result<[Tuft; 2], NodeError> {
    let tuft = laid.tuft;
    let mut points = tuft.points().to_vec();
    let mut moved = vec![false; tuft.len()];
    let mut crowded = vec![false; tuft.len()];
    let (spots, pushed) = pushes(laid, around, piece)?;
    for (spot, push) in spots.iter().zip(&pushed) {
        let (curve, point) = (spot.curve as usize, spot.point as usize);
        crowded[curve] |= push.is_over();
        if push.most > 1e-6 {
            let range = tuft.range(curve);
            let u = (point - range.start) as f32 / (range.len() - 1) as f32;
            // Several neighbours may push one way: never farther than the nearest of them asks.
            let strength = inputs.strength * inputs.along.at(u).clamp(0.0, 1.0);
            points[point] = spot.at + push.sum.clamp_length_max(push.most) * strength;
            moved[curve] = true;
        }
    }
    let mut crowd = TuftBuilder::new();
    let mut ids = vec![];
    for i in (0..tuft.len()).filter(|i| crowded[*i]) {
        crowd.push_curve(&tuft.curve(i)[..1]);
        ids.push(laid.ids[i]);
    }
    crowd.set(ID, Domain::Curve, ids);
    let crowd = crowd.build();
    if !moved.contains(&true) {
        return Ok([tuft.clone(), crowd]);
    }
    let skin = inputs.scalp.as_deref().map(|scalp| cx.skin(scalp));
    let depth = tuft.view(ALLOW_DEPTH);
    for i in (0..tuft.len()).filter(|i| moved[*i]) {
        piece.tick()?;
        let (start, old) = (tuft.range(i).start, tuft.curve(i));
        for k in 1..old.len() {
            let length = old[k].distance(old[k - 1]);
            let at = start + k;
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
    let mut edit = tuft.edit();
    edit.points_mut().copy_from_slice(&points);
    Ok([edit.build(), crowd])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::shared_ball;
    use crate::define::Value;
    use crate::eval::{Host, Kept, Log, PlainHost, Quality};
    use crate::maths::hash::Dice;
    use crate::maths::hash::Key;
    use crate::maths::transcendental::sin_cos_turns;
    use crate::testing::{Memory, curves_of, run, run_on};
    use std::sync::atomic::{AtomicU32, Ordering};

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
        // Each once, however many passes it is crowded in.
        let set = [
            ("curves", bare(0.008, 700).into()),
            ("radius", Field::Constant(5.0).into()),
            ("passes", Value::Int(3)),
        ];
        let (_, said) = run(&NODE, &set);
        let told = |text: &&String| text.starts_with(CROWDED) && text.contains("(700 curves,");
        assert!(said.len() == 1 && said.iter().any(|text| told(&text)), "{said:?}");
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

    /// Hair that leaves a disc of a centimetre and meets in one of `tip` cm, as clumped clusters do; one tuft.
    fn clump(n: u64, tip: f32, first_id: u64, at: Vec3) -> Curves {
        let (mut b, dice) = (TuftBuilder::new(), Dice::new(7, 0, "clump"));
        for i in 0..n {
            // Anywhere on the disc, so that some are close though there is room for all.
            let id = first_id + i;
            let (sin, cos) = sin_cos_turns(dice.unit(id, 0));
            let from_middle = Vec3::new(cos, 0.0, sin) * dice.unit(id, 1).sqrt();
            let point = |k: i32| {
                let u = k as f32 / 11.0;
                at + Vec3::Y * (13.0 * u) + from_middle * (1.0 + (tip - 1.0) * u)
            };
            b.push_curve(&(0..12).map(point).collect::<Vec<_>>());
        }
        b.set(ID, Domain::Curve, (first_id..first_id + n).collect());
        b.set(WIDTH, Domain::Curve, vec![0.008]);
        Curves::new(vec![b.build().into()])
    }

    /// The share of points that are nearer to another curve than the distance asked for, by more than a twentieth.
    fn too_near(curves: &Curves, distance: f32) -> f32 {
        let all: Vec<(u64, &[Vec3])> = curves.each().map(|(t, i)| (t.id(i), t.curve(i))).collect();
        let near = |id: u64, p: Vec3| {
            all.iter().filter(|(other, _)| *other != id).any(|(_, points)| {
                points.windows(2).any(|w| {
                    let way = w[1] - w[0];
                    let t = ((p - w[0]).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                    p.distance(w[0] + way * t) < 0.95 * distance
                })
            })
        };
        let points = || all.iter().flat_map(|(id, points)| points[1..].iter().map(|p| (*id, *p)));
        points().filter(|(id, p)| near(*id, *p)).count() as f32 / points().count() as f32
    }

    #[test]
    fn clumped_hair_comes_apart_where_there_is_room() {
        let input = clump(300, 0.1, 1, Vec3::ZERO);
        let after = |passes: i64| {
            let (out, said) =
                run(&NODE, &[("curves", input.clone().into()), ("passes", Value::Int(passes))]);
            assert!(said.is_empty(), "{said:?}");
            let out = curves_of(&out[0]).clone();
            for ((a, i), (b, _)) in input.each().zip(out.each()) {
                assert_eq!((a.curve(i)[0], a.id(i)), (b.curve(i)[0], b.id(i)));
                for (p, q) in a.curve(i).windows(2).zip(b.curve(i).windows(2)) {
                    assert!((p[0].distance(p[1]) - q[0].distance(q[1])).abs() < 1e-4);
                }
            }
            too_near(&out, 0.008)
        };
        let shares = [too_near(&input, 0.008), after(6), after(60)];
        let [before, few, many] = shares;
        assert!(before > 0.06 && few < 0.7 * before && many < 0.002, "{shares:?}");
    }

    #[test]
    fn a_curve_counts_by_its_nearest_part_once() {
        // One hair bends beside a point of the other, where its two links are equally near; the other goes straight on.
        let two = |bent: bool| {
            let tuft = |id: u64, points: &[Vec3]| {
                let mut b = TuftBuilder::new();
                b.push_curve(points);
                b.set(ID, Domain::Curve, vec![id]);
                b.set(RADIUS, Domain::Curve, vec![0.05]);
                b.build().into()
            };
            let straight = [0.0, 1.0, 2.0].map(|y| Vec3::new(0.0, y, 0.0));
            let beside = [0.0, 1.0, 2.0].map(|y| Vec3::new(0.09, y, 0.0));
            let beside = if bent { beside.to_vec() } else { vec![beside[0], beside[2]] };
            let curves = Curves::new(vec![tuft(1, &straight), tuft(2, &beside)]);
            let (out, _) = run(&NODE, &[("curves", curves.into()), ("passes", Value::Int(1))]);
            curves_of(&out[0]).tufts()[0].key()
        };
        assert_eq!(two(true), two(false));
    }

    /// A host that runs pieces on threads of its own, the last first.
    struct Threads(usize);

    impl Host for Threads {
        fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
            std::thread::scope(|scope| {
                for thread in 0..self.0 {
                    scope.spawn(move || (0..n).rev().skip(thread).step_by(self.0).for_each(f));
                }
            });
        }
        fn cancelled(&self) -> bool {
            false
        }
        fn find(&self, _: Key) -> Option<Kept> {
            None
        }
        fn keep(&self, _: Key, _: Kept, _: usize) {}
        fn progress(&self, _: usize, _: usize) {}
    }

    #[test]
    fn threads_and_hair_elsewhere_change_nothing() {
        let at = |x: f32| Vec3::new(x, 0.0, 0.0);
        let tufts: Vec<_> = (0..6)
            .flat_map(|n| {
                // Two and two reach into each other.
                let x = 10.0 * (n / 2) as f32 + 0.02 * (n % 2) as f32;
                clump(60, 0.01, 1 + 60 * n, at(x)).tufts().to_vec()
            })
            .collect();
        let given = [("curves", Curves::new(tufts.clone()).into())];
        let keys = |host: &dyn Host, given: &[(&str, Value)], log: &Log| {
            let out = run_on(&NODE, given, host, log, Quality::Final).unwrap();
            curves_of(&out[0]).tufts().iter().map(|t| t.key()).collect::<Vec<_>>()
        };
        let one = keys(&PlainHost, &given, &Log::default());
        assert_eq!(keys(&Threads(5), &given, &Log::default()), one);
        // Another tuft far off: the rest is as it was and not made again, whatever is asked of the new one.
        let memory = Memory::default();
        assert_eq!(keys(&memory, &given, &Log::default()), one);
        let mut edit = clump(60, 0.01, 1000, at(50.0)).tufts()[0].edit();
        edit.set(WIDTH, Domain::Curve, vec![0.05]);
        let more = [&[edit.build().into()], &tufts[..]].concat();
        let log = Log::default();
        let all = keys(&memory, &[("curves", Curves::new(more).into())], &log);
        assert_eq!(all[1..], one);
        assert_eq!(log.tufts_run.into_inner(), 6, "the new one, in each pass");
        // What reaches into nothing is as it is alone, and else not.
        let alone = |n: usize| {
            keys(
                &PlainHost,
                &[("curves", Curves::new(vec![tufts[n].clone()]).into())],
                &Log::default(),
            )
        };
        assert_ne!(alone(0)[0], one[0]);
    }

    #[test]
    fn whoever_asks_to_stop_does_not_wait_for_a_crowd() {
        /// Asks to stop at the so-many-th look.
        struct Stops(AtomicU32);
        impl Host for Stops {
            fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
                (0..n).for_each(f);
            }
            fn cancelled(&self) -> bool {
                self.0.fetch_add(1, Ordering::Relaxed) > 100
            }
            fn find(&self, _: Key) -> Option<Kept> {
                None
            }
            fn keep(&self, _: Key, _: Kept, _: usize) {}
            fn progress(&self, _: usize, _: usize) {}
        }
        let set = [
            ("curves", clump(500, 0.05, 1, Vec3::ZERO).into()),
            ("radius", Field::Constant(20.0).into()),
        ];
        let host = Stops(AtomicU32::new(0));
        let err = run_on(&NODE, &set, &host, &Log::default(), Quality::Final).unwrap_err();
        assert!(matches!(err, NodeError::Cancelled), "{err}");
        assert!(host.0.into_inner() < 110);
    }
}
