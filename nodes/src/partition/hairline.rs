//! The hairline: the border of the region where hair grows, as lines on the scalp.

use crate::data::chart::{CELL, CELLS, Chart, middle};
use crate::data::scalp::Scalp;
use crate::maths::polyline::{Polyline, filter};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// A closed border, with hair on the right when following it seen from outside the head. (On the left on the map, which
/// is mirrored.)
pub(crate) struct Hairline {
    pub(crate) line: Polyline,
    /// Centimetres per head unit.
    unit: f32,
}

/// Borders shorter than this are holes in a mesh or a mask, head units.
const LEAST: f32 = 8.0;

/// All borders, longest first.
pub(crate) fn hairlines(scalp: &Scalp) -> Vec<Hairline> {
    let chart = scalp.chart();
    let mut found: Vec<Hairline> = loops(chart)
        .into_iter()
        .filter_map(|flat| {
            let mut points: Vec<Vec3> =
                flat.iter().filter_map(|q| Some(chart.root(scalp, *q)?.point)).collect();
            points.push(*points.first()?);
            // Removes the staircase of the mesh.
            let even = Polyline::new(points);
            let n = (even.length() / (0.15 * chart.unit())).ceil() as usize;
            let mut points = even.evenly(n.max(8));
            filter(&mut points, 24);
            let line = Polyline::new(points);
            (line.length() > LEAST * chart.unit()).then_some(Hairline { line, unit: chart.unit() })
        })
        .collect();
    found.sort_by(|a, b| b.line.length().total_cmp(&a.line.length()));
    found
}

impl Hairline {
    /// Point and direction at a fraction of its length.
    pub(crate) fn at(&self, part: f32) -> (Vec3, Vec3) {
        let s = part.clamp(0.0, 1.0) * self.line.length();
        let about = 0.4 * self.unit;
        let (a, b) = (self.line.at((s - about).max(0.0)), self.line.at(s + about));
        (self.line.at(s), (b - a).normalize_or(Vec3::X))
    }
}

/// Contours of the region at one half on the map, by marching squares; hair lies on their left.
fn loops(chart: &Chart) -> Vec<Vec<Vec2>> {
    let grows = |cell: usize| chart.spots()[cell].grows;
    // For each edge between two adjacent cells that the line crosses, by its first cell and direction, the next edge.
    let mut next: BTreeMap<(usize, bool), (usize, bool)> = BTreeMap::new();
    for y in 0..CELLS - 1 {
        for x in 0..CELLS - 1 {
            let a = y * CELLS + x;
            // Corners counterclockwise, and the edge from each to the next.
            let corners = [a, a + 1, a + CELLS + 1, a + CELLS];
            let edges = [(a, false), (a + 1, true), (a + CELLS, false), (a, true)];
            let inside = corners.map(|c| grows(c) >= 0.5);
            // With hair on the left, a line enters where one goes from inside to outside and leaves where one comes
            // back.
            let enters = (0..4).filter(|i| !inside[*i] && inside[(*i + 1) % 4]);
            let leaves: Vec<usize> =
                (0..4).filter(|i| inside[*i] && !inside[(*i + 1) % 4]).collect();
            for (k, i) in enters.enumerate() {
                next.insert(edges[leaves[k.min(leaves.len() - 1)]], edges[i]);
            }
        }
    }
    let at = |(cell, up): (usize, bool)| {
        let other = if up { cell + CELLS } else { cell + 1 };
        let (a, b) = (grows(cell), grows(other));
        let t = if a == b { 0.5 } else { ((0.5 - a) / (b - a)).clamp(0.0, 1.0) };
        middle(cell) + (if up { Vec2::Y } else { Vec2::X }) * (CELL * t)
    };
    let mut all = vec![];
    while let Some((first, _)) = next.first_key_value() {
        let (first, mut line) = (*first, vec![]);
        let mut edge = first;
        while let Some(to) = next.remove(&edge) {
            line.push(at(edge));
            edge = to;
        }
        if line.len() > 16 {
            all.push(line);
        }
    }
    // Their orientation is found by sampling: hair grows more in the cell to the left.
    for line in &mut all {
        let mut votes = 0i32;
        for w in line.windows(2).step_by(4) {
            let Some(way) = (w[1] - w[0]).try_normalize() else { continue };
            let left = way.perp() * (2.0 * CELL);
            votes += if chart.grows(w[0] + left) > chart.grows(w[0] - left) { 1 } else { -1 };
        }
        if votes < 0 {
            line.reverse();
        }
    }
    all
}
