//! Which curves a touch may act on: while curves are selected these alone, and the rest of the hair is frozen.
//!
//! A gesture then names its curves from its first sample on: of the free ones those that the stroke passes, on this side of the head.
//! It does so in the document, so a replay acts on the same. Where strands are selected, what they were made from is free.

use super::super::Scene;
use super::target;
use crate::core::shown::Shown;
use crate::core::state::State;
use coif_graphs::document::NodeId;
use coif_nodes::data::attributes::{BRAID, PARENT, RADIUS};
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::gestures::{Gesture, Layer, Tool};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::sketch::seen::Seen;
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::sync::{Arc, Weak};

/// Samples nearer to each other than this add nothing to where a stroke passes, pixels.
const STEP: f32 = 2.0;
/// What is said where a stroke passes no free curve.
pub(super) const FROZEN: &str =
    "The stroke passes no selected curve, and the rest is frozen: Esc frees it";

/// The curves of `hair` that touches may act on; none where they may act on all.
pub(super) fn free(state: &State, hair: &Curves) -> Option<BTreeSet<u64>> {
    let selected = &state.selection.curves;
    if selected.is_empty() {
        return None;
    }
    let of_hair = |ids: &BTreeSet<u64>| -> BTreeSet<u64> {
        hair.each().map(|(tuft, i)| tuft.id(i)).filter(|id| ids.contains(id)).collect()
    };
    let mut free = of_hair(selected);
    if free.len() < selected.len() {
        let all = state.shown.iter().flat_map(|shown| shown.curves.each());
        let made = all.filter(|(tuft, i)| selected.contains(&tuft.id(*i)));
        let from = made.flat_map(|(tuft, i)| {
            let first = tuft.range(i).start;
            [tuft.view(PARENT).at(i, first), tuft.view(BRAID).at(i, first)]
        });
        free.append(&mut of_hair(&from.collect()));
    }
    Some(free)
}

/// How many curves are free, counted anew where the selection, the hair or the sketch is another.
#[derive(Default)]
pub(super) struct FreeCount {
    of: (BTreeSet<u64>, Weak<Shown>, Option<NodeId>),
    count: Option<usize>,
}

impl FreeCount {
    fn update(&mut self, state: &State, node: Option<&NodeId>) -> Option<usize> {
        let shown = state.shown.as_ref().map_or_else(Weak::new, Arc::downgrade);
        let (selected, before, of) = &self.of;
        let same = before.ptr_eq(&shown) && of.as_ref() == node;
        if !same || *selected != state.selection.curves {
            let hair = target::curves(state, node).unwrap_or_default();
            self.count = free(state, &hair).map(|free| free.len());
            self.of = (state.selection.curves.clone(), shown, node.cloned());
        }
        self.count
    }
}

/// What the corner of the picture says; none where no hair is frozen.
pub(in super::super) fn words(scene: &mut Scene) -> Option<String> {
    Some(match scene.hair.free.update(scene.state, scene.node.as_ref())? {
        0 => "all hair here is frozen: what is selected is not of it".to_owned(),
        1 => "1 curve, the rest is frozen".to_owned(),
        n => format!("{n} curves, the rest is frozen"),
    })
}

/// The free curves whose root disc contains the root of a gesture.
pub(super) fn rooted_about(
    gesture: &Gesture,
    hair: &Curves,
    free: &BTreeSet<u64>,
    scalp: &Scalp,
) -> Vec<u64> {
    let Some(root) = gesture.root.map(|root| scalp.place(root)) else { return vec![] };
    let contains = |(tuft, i): &(&Tuft, usize)| {
        let radius = tuft.view(RADIUS).at(*i, tuft.range(*i).start);
        tuft.curve(*i).first().is_some_and(|p| p.distance(root) <= radius)
    };
    let all = hair.each().filter(contains).map(|(tuft, i)| tuft.id(i));
    all.filter(|id| free.contains(id)).collect()
}

/// The free curves that a gesture passes on this side of the head: one where its level asks for one. `rho` is how far the pen reaches
/// without a brush, pixels.
pub(super) fn passed(
    gesture: &Gesture,
    hair: &Curves,
    free: &BTreeSet<u64>,
    (scalp, rho): (&Scalp, f32),
) -> Vec<u64> {
    let seen = Seen::new(&gesture.view, scalp.frame());
    let (line, reach) = footprint(gesture, rho);
    let near = |line: &[Vec2]| -> Vec<(u64, f32, f32)> {
        let all = hair.each().filter(|(tuft, i)| free.contains(&tuft.id(*i)));
        let near = all.filter_map(|(tuft, i)| {
            let (off, depth) = off(gesture, &seen, scalp, (tuft, i), line)?;
            (off <= reach).then(|| (tuft.id(i), off, depth))
        });
        near.collect()
    };
    // What is soft takes what is around along.
    if gesture.layer != Layer::Nearest || gesture.tool.is_soft() && gesture.size > 0.0 {
        return near(&line).into_iter().map(|(id, ..)| id).collect();
    }
    // Where the pen touched down, or else where it passed; of what is under it, the nearest to the eye.
    let mut found = near(&line[..1]);
    if found.is_empty() {
        found = near(&line);
    }
    let first = found.iter().min_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
    first.map(|(id, ..)| *id).into_iter().collect()
}

/// Where a gesture acts in the picture: a line, and how far beside it.
fn footprint(gesture: &Gesture, rho: f32) -> (Vec<Vec2>, f32) {
    let mut line: Vec<Vec2> = vec![];
    for sample in &gesture.samples {
        if line.last().is_none_or(|last| last.distance(sample.at) >= STEP) {
            line.push(sample.at);
        }
    }
    match gesture.tool {
        // A cut is straight.
        Tool::Cut => line = vec![line[0], gesture.samples[gesture.samples.len() - 1].at],
        // Circles are drawn about hair.
        Tool::Density => {
            let middle = line.iter().sum::<Vec2>() / line.len() as f32;
            let wide: f32 = line.iter().map(|at| at.distance(middle)).sum();
            return (vec![middle], wide / line.len() as f32 + gesture.size);
        }
        _ => {}
    }
    let reach = match gesture.tool {
        tool if tool.is_soft() => gesture.size.max(rho),
        _ if gesture.size > 0.0 => gesture.size,
        _ => rho,
    };
    (line, reach)
}

/// How far a curve is from a line in the picture, pixels, and its depth there; none where the head hides it. What counts of it is what
/// the tool takes hold of: its tip, its CVs, its root, or all of it.
fn off(
    gesture: &Gesture,
    seen: &Seen,
    scalp: &Scalp,
    (tuft, i): (&Tuft, usize),
    line: &[Vec2],
) -> Option<(f32, f32)> {
    let curve = tuft.curve(i);
    let last = curve.len().checked_sub(1)?;
    let whole = match (gesture.tool, gesture.layer) {
        (Tool::Lengthen, _) => last..=last,
        (Tool::Cut | Tool::Density, Layer::Scalp) => 0..=0,
        _ => 0..=last,
    };
    let by_cvs = gesture.tool == Tool::Point || whole.start() == whole.end();
    let piece = |k: usize| -> Option<(f32, f32, Vec3)> {
        let p = curve[k];
        let next = if by_cvs { p } else { curve[(k + 1).min(last)] };
        let ends = [seen.pixel(p)?, seen.pixel(next)?];
        let depth = seen.depth(p);
        let wide = tuft.view(RADIUS).at(i, 0) / seen.cm_per_pixel(depth);
        let wide = if wide.is_finite() { wide } else { 0.0 };
        let runs = line.windows(2.min(line.len()));
        let off = runs.map(|run| apart([run[0], run[run.len() - 1]], ends));
        Some(((off.fold(f32::MAX, f32::min) - wide).max(0.0), depth, p))
    };
    let mut pieces: Vec<(f32, f32, Vec3)> = whole.filter_map(piece).collect();
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let first = pieces.into_iter().find(|(.., p)| seen.sees(scalp, *p));
    first.map(|(off, depth, _)| (off, depth))
}

/// How far apart two segments are; 0 where they cross.
fn apart([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> f32 {
    let side = |a: Vec2, b: Vec2, p: Vec2| (b - a).perp_dot(p - a);
    let parted = |a, b, c, d| side(a, b, c) * side(a, b, d) < 0.0;
    if parted(a, b, c, d) && parted(c, d, a, b) {
        return 0.0;
    }
    let to = |a: Vec2, b: Vec2, p: Vec2| {
        let t = (p - a).dot(b - a) / (b - a).length_squared().max(1e-12);
        a.lerp(b, t.clamp(0.0, 1.0)).distance(p)
    };
    to(a, b, c).min(to(a, b, d)).min(to(c, d, a)).min(to(c, d, b))
}
