//! Press puffs: puffs of any nodes that meet are flat between each other.
//!
//! A puff is described by its hair: the centre of its outline, and each hair's distance to the outline. Between every
//! two puffs that meet is a plane: for spheres, that of their common circle; for other outlines, the one that balances
//! their reach toward each other. Hair that crosses it is bent beyond its tie so that its tip reaches the plane, in its
//! original direction from the centre, and slides along the plane.
//!
//! Guarantees: roots, ids, numbers of points and hair that crosses no plane stay as they are; with `flatten` at 1, no
//! point past the first quarter of a hair is over a plane by more than 0.001 cm; the order of inputs does not matter;
//! `puff_radius` describes the pressed outline, `fibre_length` stays in proportion. Not promised: that a hair keeps its
//! length, or that planes are where outlines that are far from round meet.

use super::press::{Wall, pressed};
use crate::data::attributes::{Domain, FIBRE, PUFF, PUFF_CENTRE, PUFF_RADIUS};
use crate::data::curves::{Curves, Tuft};
use crate::data::route::{Policy, Route};
use crate::data::scalp::Scalp;
use crate::define::{NodeError, node};
use crate::eval::{EvalCx, Piece, Quality, Size};
use crate::maths::hash::KeyBuilder;
use crate::maths::spline::Spline;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

node! {
    /// Presses the puffs of several nodes flat against each other where they meet.
    ///
    /// Merge the hair of all puffs and wire it here, then wire the result to Shape-list curl, so that curls cross the
    /// plane between two puffs by no more than their own size. Sphere puff can press the puffs of one node with its own
    /// `flatten`. Hair without an outline passes through unchanged.
    "press_puffs", version 1, label "Press puffs",
        words "flatten collide touch squash squeeze meet several between balls";
    inputs {
        /// Hair or guides of all puffs, from Sphere puff.
        curves: Curves;
        /// Head that pressed hair stays out of.
        scalp: Option<Arc<Scalp>>;
        /// How flat puffs are where they meet: 0 lets them overlap, 1 ends them at the plane between them.
        flatten: f32 = 1.0, hard(0.0, 1.0), unit(Ratio), words("press strength amount");
    }
    outputs {
        /// The same hair, flattened between the puffs.
        curves: Curves;
    }
}

/// The most puffs that are pressed: each is tested against every other.
const MOST_PUFFS: usize = 1024;
/// The most hairs of a puff that are used to measure its reach.
const MOST_TOLD: usize = 4096;
/// Fraction of a hair from its root over which pressing fades in: its root stays.
const ROOTED: f32 = 0.25;

/// Identifies a puff: its id and the bits of its centre, since two nodes may use one id.
type Which = (u64, [u32; 3]);

/// A puff, as described by its hair.
#[derive(Default)]
struct Puff {
    middle: Vec3,
    hairs: usize,
    /// The largest distance of its outline.
    farthest: f32,
    /// Directions of tips from the centre, with the distance of the outline there.
    told: Vec<(Vec3, f32)>,
}

impl Puff {
    /// Distance of the outline in a direction: from the hair with the nearest tip.
    fn reach(&self, direction: Vec3, quality: Quality) -> f32 {
        // The hair of a preview at any quality, so that the plane is the same.
        let count = match quality {
            Quality::Final => self.hairs.min(16.max(self.hairs / 10)),
            Quality::Preview | Quality::FirstLook => self.hairs,
        };
        let told = self.told.iter().take(count);
        let nearest = told.max_by(|a, b| a.0.dot(direction).total_cmp(&b.0.dot(direction)));
        nearest.map_or(self.farthest, |(_, reach)| *reach)
    }
}

fn which(tuft: &Tuft, i: usize) -> Option<(Which, Vec3, f32)> {
    let at = tuft.range(i).start;
    let (middle, radius) = (tuft.view(PUFF_CENTRE).at(i, at), tuft.view(PUFF_RADIUS).at(i, at));
    let is_puff = radius > 0.0 && radius.is_finite() && middle.is_finite();
    let bits = middle.to_array().map(f32::to_bits);
    is_puff.then(|| ((tuft.view(PUFF).at(i, at), bits), middle, radius))
}

fn eval(cx: &EvalCx, inputs: Inputs) -> Result<Outputs, NodeError> {
    let mut puffs: BTreeMap<Which, Puff> = BTreeMap::new();
    for (k, (tuft, i)) in inputs.curves.each().enumerate() {
        if k % 1024 == 0 {
            cx.check()?;
        }
        let Some((id, middle, radius)) = which(tuft, i) else { continue };
        let puff = puffs.entry(id).or_default();
        puff.middle = middle;
        puff.hairs += 1;
        puff.farthest = puff.farthest.max(radius);
        let tip = tuft.curve(i).last().and_then(|tip| (*tip - middle).try_normalize());
        if let Some(direction) = tip.filter(|_| puff.told.len() < MOST_TOLD) {
            puff.told.push((direction, radius));
        }
    }
    if puffs.len() > MOST_PUFFS {
        return Err(NodeError::BadValue {
            input: "curves",
            value: format!("hair of {} puffs", puffs.len()),
            reason: format!("is of more than {MOST_PUFFS}: wire fewer puffs"),
        });
    }
    let walls = walls(&puffs, cx.quality);
    cx.check()?;
    match (puffs.len(), walls.values().map(Vec::len).sum::<usize>() / 2) {
        (0, _) => cx.warn(
            "no hair in curves carries the middle and radius of a puff: wire the hair of Sphere puff nodes",
        ),
        (1, _) => cx.remark("there is one puff alone, and nothing to press it against"),
        (n, 0) => cx.remark(format!("no two of the {n} puffs meet")),
        (n, 1) => cx.remark(format!("two of the {n} puffs meet")),
        (n, pairs) => cx.remark(format!("{pairs} pairs of the {n} puffs meet")),
    }
    let tufts = inputs.curves.tufts();
    let key = |i: usize| {
        let key = KeyBuilder::new("press").key(tufts[i].key());
        let mut last = None;
        let mut key = key;
        for c in 0..tufts[i].len() {
            let Some((id, ..)) = which(&tufts[i], c) else { continue };
            if last.replace(id) != Some(id) {
                for (towards, at) in walls.get(&id).into_iter().flatten().map(Wall::key_parts) {
                    key = key.vec3(towards).float(at);
                }
            }
        }
        key.finish()
    };
    let presser = Presser { inputs: &inputs, walls: &walls };
    let [curves] =
        cx.each_item(tufts.len(), &Size::as_many([&inputs.curves]), key, |i, piece| {
            Ok([presser.tuft(&tufts[i], piece)?])
        })?;
    Ok(Outputs { curves })
}

/// The planes of each puff that meets others.
fn walls(puffs: &BTreeMap<Which, Puff>, quality: Quality) -> BTreeMap<Which, Vec<Wall>> {
    let mut out: BTreeMap<Which, Vec<Wall>> = BTreeMap::new();
    for (id, puff) in puffs {
        for (_, other) in puffs.iter().filter(|(other, _)| *other != id) {
            let apart = other.middle - puff.middle;
            let meet = apart.length() < puff.farthest + other.farthest;
            let Some(way) = apart.try_normalize().filter(|_| meet) else { continue };
            let (far, other_far) = (puff.reach(way, quality), other.reach(-way, quality));
            let wall = Wall::between((puff.middle, far), (other.middle, other_far));
            out.entry(*id).or_default().push(wall);
        }
    }
    out
}

struct Presser<'a> {
    inputs: &'a Inputs,
    walls: &'a BTreeMap<Which, Vec<Wall>>,
}

impl Presser<'_> {
    fn tuft(&self, tuft: &Tuft, piece: &mut Piece) -> Result<Tuft, NodeError> {
        let policy = Policy::keep_length(false);
        let route = Route::new(self.inputs.scalp.as_deref(), policy);
        let mut moved = route.moved(tuft);
        let share = self.inputs.flatten;
        let (mut new, mut radii, mut fibres) = (vec![], vec![], vec![]);
        let (mut spline, mut way) = (Spline::default(), vec![]);
        let mut changed = false;
        let fibre = tuft.view(FIBRE);
        for i in 0..tuft.len() {
            piece.tick()?;
            let range = tuft.range(i);
            let mut fibre = fibre.at(i, range.start);
            let mut radius = tuft.view(PUFF_RADIUS).at(i, range.start);
            let old = tuft.curve(i);
            let walls = which(tuft, i).and_then(|(id, middle, _)| {
                Some((self.walls.get(&id)?.as_slice(), middle)).filter(|_| share > 0.0)
            });
            if let (Some((walls, middle)), [root, .., tip]) = (walls, old)
                && old.iter().all(|p| p.is_finite())
            {
                if let Some(direction) = (*tip - middle).try_normalize() {
                    let outline = direction * radius;
                    let now = pressed(outline, walls, share);
                    if now != outline {
                        radius = now.length();
                        changed = true;
                    }
                }
                let last = old.len() - 1;
                let u = |k: usize| k as f32 / last as f32;
                let press =
                    |p: Vec3, u: f32| middle + pressed(p - middle, walls, (u / ROOTED).min(1.0));
                let is_over = |(k, p): (usize, &Vec3)| {
                    u(k) >= ROOTED && pressed(*p - middle, walls, 1.0) != *p - middle
                };
                if old.iter().enumerate().any(is_over) {
                    let by = press(*tip, 1.0) - *tip;
                    way.clear();
                    way.extend(old.iter().enumerate().map(|(k, p)| match k {
                        0 => *root,
                        _ => p.lerp(press(*p + by * (u(k) * u(k)), u(k)), share),
                    }));
                    let before = spline.rebuild(old).map_or(0.0, |()| spline.length());
                    // As many points as before, evenly spaced; the tip is already in place.
                    if spline.rebuild(&way).is_ok() && before > 0.0 {
                        new.clear();
                        spline.resample(old.len(), |p| new.push(p));
                        new.truncate(old.len());
                        new[last] = way[last];
                        let leaving = (old[1] - *root).normalize_or_zero();
                        if last > 1 {
                            new[1] = *root + leaving * new[1].distance(*root);
                        }
                        // Where the path turns into the plane, a smooth curve through its points overshoots.
                        for (k, p) in new.iter_mut().enumerate().skip(2).filter(|_| share >= 1.0) {
                            *p = press(*p, u(k));
                        }
                        match moved.hair(i, &mut new) {
                            Ok(()) => {
                                fibre *= spline.length() / before;
                                changed = true;
                            }
                            Err(why) => piece.trouble(tuft.id(i), why),
                        }
                    }
                }
            }
            radii.push(radius);
            fibres.push(fibre);
        }
        if !changed {
            return Ok(tuft.clone());
        }
        let mut edit = moved.done().unwrap_or_else(|| tuft.edit());
        edit.set(PUFF_RADIUS, Domain::Curve, radii);
        if tuft.attribute(FIBRE.name).is_some() {
            edit.set(FIBRE, Domain::Curve, fibres);
        }
        Ok(edit.build())
    }
}
