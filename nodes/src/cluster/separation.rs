//! Separation: curves that are too close to each other move apart.
//!
//! In each pass, every CV moves by half of its missing distance away from the nearest part of each nearby curve, all as they were
//! before the pass; then each curve regains its segment lengths from the root on. So the order of curves has no effect, and a
//! tuft reads only the tufts near it. The CVs of a tuft are kept in a tree of boxes with their room, which every segment nearby
//! descends once: the cost of a pass grows with the amount of hair and the number of curves that are too close to each, not with
//! the length of segments.
//!
//! Guarantees: roots stay; segment lengths are kept; nothing moves where curves keep their distance, or with no passes or no
//! strength; no CV ends under the skin; a curve with too many neighbours is counted once. Not promised: the distance where there
//! is no room, close to roots, or within few passes, in which the middle of a thick bundle cannot yet use the room outside; that
//! curves do not cross between CVs.

use crate::data::attributes::{Domain, ID, RADIUS, WIDTH};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::{Field, Sampler};
use crate::data::ramp::Ramp;
use crate::data::route::{Lengths, Policy, Route};
use crate::data::scalp::Scalp;
use crate::define::{FieldInput, NodeError, node};
use crate::eval::{EvalCx, Piece, Size};
use crate::maths::box_tree::{Aabb, BoxTree, Rod};
use crate::maths::hash::{KeyBuilder, mix};
use glam::Vec3;
use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};

node! {
    /// Moves clusters or hairs apart until they keep a distance.
    ///
    /// Roots and lengths stay. Clusters keep the sum of their radii apart, hairs the sum of half their widths; for
    /// more, set `radius` to half the distance in cm.
    "separation", version 1, label "Separation",
        words "separate collide collision hair-hair apart push repel spacing overlap relax intersect volume";
    inputs {
        /// Clusters or hairs to move apart.
        curves: Curves;
        /// Head that the curves stay out of.
        scalp: Option<Arc<Scalp>>;
        /// Room around each curve; two curves keep the sum of theirs. Hairs have no radius and use half their width.
        radius: FieldInput = Field::Attribute(RADIUS.name.to_owned()),
            hard(0.0, 100.0), soft(0.01, 3.0), unit(Length), words("distance thickness gap");
        /// Multiplies the room.
        scale: f32 = 1.0, hard(0.0, 10.0), soft(0.0, 2.0);
        /// Fraction of the missing distance that each pass corrects.
        strength: f32 = 0.7, hard(0.0, 1.0), unit(Ratio), words("stiffness");
        /// Multiplies the strength from root to tip.
        along: Arc<Ramp> = Ramp::linear(0.3, 1.0), words("profile falloff");
        /// Number of passes; more come closer to the requested distance.
        passes: i64 = 6, hard(0.0, 100.0), soft(0.0, 20.0), unit(Count), words("iterations");
    }
    outputs {
        /// The same curves, moved apart.
        curves: Curves;
    }
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let mut curves = inputs.curves.clone();
    if inputs.strength <= 0.0 || inputs.scale <= 0.0 {
        return Ok(Outputs { curves });
    }
    // A curve may be crowded in one pass or in all; it is counted once.
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

/// A tuft, and what neighbouring tufts read of it.
struct Laid<'a> {
    tuft: &'a Tuft,
    ids: Vec<u64>,
    /// Room around each CV, cm.
    rooms: Vec<f32>,
    /// Bounds of each curve with its room; `None` without CVs.
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
    /// The segments of the current curve, each with its index.
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

/// A curve that is near the CVs of a tuft.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Hair {
    /// Random number by id, so that the order of tufts has no effect and the curves that count in a crowd are a random sample.
    draw: u64,
    tuft: u32,
    curve: u32,
    /// Which of its segments are near, one bit each; the last bit stands for all further ones.
    links: u64,
}

/// The union of both boxes.
fn joined(a: Option<(Vec3, Vec3)>, b: &Option<(Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    match (a, *b) {
        (Some((low, high)), Some((l, h))) => Some((low.min(l), high.max(h))),
        (one, other) => one.or(other),
    }
}

/// Moves all curves once; also returns the crowded ones, by their roots.
fn pass(cx: &EvalCx, inputs: &Inputs, curves: &Curves) -> Result<[Curves; 2], NodeError> {
    let tufts = curves.tufts();
    let mut laid = Vec::with_capacity(tufts.len());
    for tuft in tufts {
        cx.check()?;
        laid.push(Laid::new(inputs, tuft)?);
    }
    // Tufts without CVs have no neighbours.
    let (boxes, numbers): (Vec<(Vec3, Vec3)>, Vec<u32>) = (0..)
        .zip(&laid)
        .filter_map(|(n, laid)| Some((laid.curves.iter().fold(None, joined)?, n)))
        .unzip();
    let blocks: Vec<Aabb> = boxes.iter().map(|(low, high)| Aabb::new(*low, *high)).collect();
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
    cx.each_item(tufts.len(), &Size::as_many([curves]), key, |i, piece| {
        let around: Vec<&Laid> = near[i].iter().map(|n| &laid[*n as usize]).collect();
        apart(inputs, &laid[i], &around, piece)
    })
}

/// Largest number of curves that push one CV. About six fit around one at the requested distance; with more, nothing separates in
/// a few passes, and a random sample of them pushes like all.
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
    /// Sums over all curves before the last one.
    sum: Vec3,
    /// Largest missing distance to one of them, halved.
    most: f32,
    /// The last curve that came near, by its turn from 1: the missing distance to its nearest part, and the direction.
    turn: u32,
    lacks: f32,
    way: Vec3,
    /// Number of curves that came near.
    curves: u32,
}

impl Push {
    /// Whether more came near than may push.
    fn is_over(&self) -> bool {
        self.curves > MOST_NEAR
    }
    /// Adds a part of a curve. Parts of one curve are added consecutively; the nearest of them counts.
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

/// The push on the CVs of a tuft from all curves around.
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
            let block = Aabb::new(*low, *high);
            if !tree.any(|_, node| node.touches(&block)) {
                continue;
            }
            // Most segments of other tufts that are near miss all CVs; those of the tuft itself do not.
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
    // In the order of the tree.
    let mut spots: Vec<Option<Spot>> = spots.into_iter().map(Some).collect();
    let spots: Vec<Spot> =
        tree.order().iter().filter_map(|number| spots[*number as usize].take()).collect();
    let mut pushed = vec![Push::default(); spots.len()];
    // Number of CVs under each node that may take more pushes: a node with none is skipped.
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

/// Calls a function for a node of a tree and all its ancestors.
fn above(mut node: usize, mut at: impl FnMut(usize)) {
    at(node);
    while node > 0 {
        node = (node - 1) / 2;
        at(node);
    }
}

/// A segment of a curve, with the room at both ends.
struct Link {
    id: u64,
    turn: u32,
    from: Vec3,
    to: Vec3,
    room: (f32, f32),
}

impl Link {
    /// Its bounds, room included.
    fn rod(&self) -> Rod {
        Rod::new(self.from, self.to, self.room.0.max(self.room.1))
    }
    /// Pushes nearby CVs of other curves; returns how many of them need no more.
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
                // Two curves in one place move in opposite directions.
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
            // Several neighbours may push the same way: the CV moves no farther than the nearest requires.
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
    let policy = Policy { lengths: Lengths::KeptTowards, ..Policy::default() };
    let route = Route::new(inputs.scalp.as_deref(), policy);
    let mut edit = route.moved(tuft);
    for i in (0..tuft.len()).filter(|i| moved[*i]) {
        piece.tick()?;
        if let Err(why) = edit.hair(i, &mut points[tuft.range(i)]) {
            piece.trouble(tuft.id(i), why);
        }
    }
    Ok([edit.done().map_or_else(|| tuft.clone(), TuftBuilder::build), crowd])
}

#[cfg(test)]
mod tests;
