//! Drawn regions of a head: closed strokes and names, with messages for what does not fit.
//!
//! methods.md 0.1. Each stroke is closed, laid on the skin and cut along its triangles ([`crate::data::outline`]); it
//! encloses the smaller of its two sides, unless a name's point is on the other. Strokes inside another stroke are
//! holes.

use crate::data::drawn::DrawnRegion;
use crate::data::laid::{ClosedStroke, LEAST_POINTS, place};
use crate::data::outline::{ConnectedSurface, Outline};
use crate::data::scalp::{HeadSpace, REGION};
use crate::data::sections::named_points;
use crate::data::strokes::Strokes;
use crate::define::NodeError;
use crate::eval::EvalCx;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most named regions of a head.
const MOST_NAMES: usize = 256;

/// Strokes and names, as given by the head node.
pub(super) struct DrawnRegionParams<'a> {
    pub(super) strokes: &'a Strokes,
    /// Names, each with a point in head units, as text.
    pub(super) names: &'a str,
    /// Whether the regions are what the strokes leave outside.
    pub(super) outside: bool,
    /// Width of the edge, cm.
    pub(super) softness: f32,
    /// For each vertex, whether it is outer skin: 0 or 1.
    pub(super) may: Vec<f32>,
}

/// The region where hair grows first, then the named ones.
pub(super) fn regions(
    cx: &EvalCx,
    net: &ConnectedSurface,
    space: &HeadSpace,
    wish: DrawnRegionParams,
) -> Result<Vec<(String, DrawnRegion)>, NodeError> {
    let surface = net.surface();
    let mut outlines: Vec<Outline> = vec![];
    for (number, stroke) in (1..).zip(&wish.strokes.0) {
        cx.check()?;
        let points: Vec<Vec3> = stroke.samples.iter().map(|s| space.place(s.position)).collect();
        if points.len() < LEAST_POINTS {
            cx.warn(format!("stroke {number} has {} points and encloses nothing", points.len()));
            continue;
        }
        let laid = ClosedStroke::new(net, space, &points, 0.5 * wish.softness);
        laid.faults.iter().for_each(|fault| cx.warn(format!("stroke {number} {fault}")));
        outlines.push(laid.outline);
    }
    if outlines.is_empty() {
        return Err(NodeError::failed("no outline is drawn: draw a closed stroke"));
    }
    // Nesting of lines: the innermost has the most lines around it.
    let holds = |outer: &Outline, inner: &Outline| {
        let pieces = inner.pieces();
        let mut seen = pieces.iter().step_by(pieces.len().div_ceil(64).max(1));
        seen.all(|piece| outer.holds(surface, piece.triangle, piece.bary[0]))
    };
    let about: Vec<Vec<usize>> = (0..outlines.len())
        .map(|i| {
            let other = |k: &usize| {
                *k != i
                    && outlines[*k].area() > outlines[i].area()
                    && !outlines[i].pieces().is_empty()
                    && holds(&outlines[*k], &outlines[i])
            };
            (0..outlines.len()).filter(other).collect()
        })
        .collect();
    let is_hole = |i: usize| about[i].len() % 2 == 1;
    let named = names(cx, net, space, &mut outlines, &is_hole, wish.names);
    let holes = (0..outlines.len()).filter(|i| is_hole(*i)).count();
    if holes > 0 {
        cx.remark(match holes {
            1 => "1 stroke lies inside another and leaves a hole in it".to_owned(),
            _ => format!("{holes} strokes lie inside others and leave holes in them"),
        });
    }
    let outlines: Vec<Arc<Outline>> = outlines.into_iter().map(Arc::new).collect();
    let may: Arc<[f32]> = wish.may.into();
    let drawn = |chosen: &dyn Fn(usize) -> bool| {
        let lines =
            (0..outlines.len()).filter(|i| chosen(*i) || about[*i].iter().any(|k| chosen(*k)));
        let lines = lines.map(|i| (outlines[i].clone(), is_hole(i)));
        DrawnRegion::new(net, (lines.collect(), wish.outside), wish.softness, may.clone())
    };
    let mut out = vec![(REGION.to_owned(), drawn(&|_| true))];
    for (name, lines) in named {
        cx.check()?;
        let region = drawn(&|i| lines.contains(&i));
        cx.remark(format!("{name:?}: {}", area(region.area())));
        out.push((name, region));
    }
    Ok(out)
}

/// The lines that each name refers to. A name whose point is in no line inverts the nearest.
fn names(
    cx: &EvalCx,
    net: &ConnectedSurface,
    space: &HeadSpace,
    outlines: &mut [Outline],
    is_hole: &dyn Fn(usize) -> bool,
    text: &str,
) -> BTreeMap<String, Vec<usize>> {
    let surface = net.surface();
    let (points, faults) = named_points(text);
    faults.into_iter().for_each(|fault| cx.warn(fault));
    if points.len() > MOST_NAMES {
        cx.warn(format!(
            "{} names are given; the first {MOST_NAMES} are read, for each holds a value a vertex",
            points.len()
        ));
    }
    let mut named: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (name, point) in points.into_iter().take(MOST_NAMES) {
        if name == REGION {
            cx.warn(format!("{name:?} names all drawn regions together: choose another name"));
            continue;
        }
        let Some(hit) = surface.closest(space.place(point)) else { continue };
        let inside = (0..outlines.len())
            .filter(|i| !is_hole(*i) && outlines[*i].holds(surface, hit.triangle, hit.bary))
            .min_by(|a, b| outlines[*a].area().total_cmp(&outlines[*b].area()));
        let chosen = inside.unwrap_or_else(|| {
            let far = |i: &usize| {
                let pieces = outlines[*i].pieces().iter();
                pieces.map(|piece| piece.ends[0].distance(hit.point)).fold(f32::MAX, f32::min)
            };
            let near = (0..outlines.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
            let near = near.expect("a line");
            outlines[near].turn(net);
            cx.remark(format!(
                "{name:?} stands outside of every stroke, at {}: the stroke nearest to it encloses that side",
                place(space, hit.point)
            ));
            near
        });
        named.entry(name).or_default().push(chosen);
    }
    named
}

/// An area with three significant digits.
pub(super) fn area(cm2: f32) -> String {
    let digits = [0.995, 9.95, 99.5].iter().filter(|most| cm2 < **most).count();
    format!("{cm2:.digits$} cm2")
}

#[cfg(test)]
mod tests;
