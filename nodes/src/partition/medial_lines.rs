//! The centre line of a section of any shape: the path along it with equal parts of the section on its left and right.
//!
//! The two points of a section that are farthest apart, measured inside it, give an initial direction. The section's
//! cells are then binned by position along it, and the centroids of the bins form the line. Two more passes along that
//! line itself make the result independent of the initial points.

use crate::data::chart::{CELL, CELLS, Chart, around, cell_of};
use crate::data::scalp::{Root, Scalp};
use crate::data::sections::{NONE, Sections};
use crate::maths::polyline::{Polyline, filter};
use crate::maths::transcendental::sin_cos_turns;
use glam::{Vec2, Vec3};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Spacing of the points of centre lines, head units.
const STEP: f32 = 0.5;

/// The cells of every section.
pub(crate) fn members(sections: &Sections) -> Vec<Vec<u32>> {
    let mut all = vec![vec![]; sections.list().len()];
    for (cell, label) in (0..).zip(sections.labels()).filter(|(_, l)| **l != NONE) {
        all[*label as usize].push(cell);
    }
    all
}

/// Points (on the map) along the centre of a section with these cells; `None` if it is a speck.
pub(crate) fn line(
    chart: &Chart,
    sections: &Sections,
    section: u32,
    cells: &[u32],
) -> Option<Vec<Vec2>> {
    let spots = chart.spots();
    let grown: Vec<u32> =
        cells.iter().copied().filter(|c| spots[*c as usize].grows >= 0.5).collect();
    let cells = if grown.len() > 8 { &grown } else { cells };
    let from = *cells.first()?;
    let first = farthest(chart, sections, section, from)?.0;
    let (second, far) = farthest(chart, sections, section, first)?;
    let reach = far[second as usize];
    let step = STEP * chart.unit();
    if reach < 2.0 * step {
        return None;
    }
    let bands = ((reach / step).ceil() as usize).clamp(3, 200);
    let mut points = centres(cells, chart, bands, |cell| far[cell as usize] / reach);
    for _ in 0..3 {
        filter(&mut points, 4);
        let line = Polyline::new(points);
        // Cells past the line's ends would pull the ends aside.
        let even = line.evenly(bands.min((line.length() / step).ceil() as usize + 2));
        let n = even.len() as f32;
        points = centres(cells, chart, even.len(), |cell| {
            let p = spots[cell as usize].point;
            let far = |q: &Vec3| q.distance_squared(p);
            let at = (0..even.len()).min_by(|a, b| far(&even[*a]).total_cmp(&far(&even[*b])));
            (at.unwrap_or(0) as f32 + 0.5) / n
        });
    }
    filter(&mut points, 8);
    let mut line: Vec<Vec2> = points.iter().map(|p| chart.flat(*p)).collect();
    for _ in 0..2 {
        reach_out(chart, sections, section, &mut line);
        line.reverse();
    }
    Some(line)
}

/// Extends a line until it leaves its section or the region.
fn reach_out(chart: &Chart, sections: &Sections, section: u32, line: &mut Vec<Vec2>) {
    let inside = |q: Vec2| {
        let p = chart.spread().direction(q);
        let out = cell_of(q).map_or(0.0, |cell| chart.out(cell));
        let place = sections.at(chart.origin() + p * out);
        place.is_some_and(|place| place.section == section) && chart.grows(q) >= 0.5
    };
    while line.len() > 3 && line.last().is_some_and(|q| !inside(*q)) {
        line.pop();
    }
    let n = line.len();
    let Some(way) = (line[n - 1] - line[n - 1 - (n - 1).min(3)]).try_normalize() else { return };
    let step = 0.5 * CELL;
    let from = line[n - 1];
    let last = (1..200).map(|k| from + way * (step * k as f32)).take_while(|q| inside(*q)).last();
    line.extend(last);
}

/// The cell farthest from a given one, measured inside the section, and every cell's distance, cm.
fn farthest(
    chart: &Chart,
    sections: &Sections,
    section: u32,
    from: u32,
) -> Option<(u32, Vec<f32>)> {
    let (labels, spots) = (sections.labels(), chart.spots());
    let mut far = vec![f32::MAX; CELLS * CELLS];
    let mut heap = BinaryHeap::new();
    *far.get_mut(from as usize)? = 0.0;
    heap.push(Reverse((0u32, from)));
    let mut best = (0.0, from);
    while let Some(Reverse((bits, cell))) = heap.pop() {
        let d = f32::from_bits(bits);
        if d > far[cell as usize] {
            continue;
        }
        if spots[cell as usize].grows >= 0.5 && d > best.0 {
            best = (d, cell);
        }
        for other in around(cell as usize).filter(|c| labels[*c] == section) {
            let next = d + spots[other].point.distance(spots[cell as usize].point);
            if next < far[other] {
                far[other] = next;
                // Distances are not negative, so their bits sort like their values.
                heap.push(Reverse((next.to_bits(), other as u32)));
            }
        }
    }
    Some((best.1, far))
}

/// The centroids of cells by position along the line (0 to 1); empty bins are skipped.
fn centres(cells: &[u32], chart: &Chart, bands: usize, part: impl Fn(u32) -> f32) -> Vec<Vec3> {
    let mut sums = vec![(glam::DVec3::ZERO, 0.0f64); bands];
    for cell in cells {
        let spot = &chart.spots()[*cell as usize];
        let weight = f64::from(spot.area * spot.grows);
        let at = part(*cell);
        let band = ((at * bands as f32) as usize).min(bands - 1);
        if at.is_finite() && at <= 1.5 {
            sums[band].0 += spot.point.as_dvec3() * weight;
            sums[band].1 += weight;
        }
    }
    sums.iter().filter(|(_, w)| *w > 0.0).map(|(sum, w)| (*sum / *w).as_vec3()).collect()
}

/// The longest part of a line that lies in one section.
pub(crate) fn longest_run<'l>(
    chart: &Chart,
    sections: &Sections,
    line: &'l [Vec2],
) -> Option<(u32, &'l [Vec2])> {
    let at = |q: &Vec2| {
        let cell = cell_of(*q)?;
        let grows = chart.spots()[cell].grows >= 0.5;
        let p = chart.origin() + chart.direction(*q) * chart.out(cell);
        sections.at(p).filter(|_| grows).map(|place| place.section)
    };
    let labels: Vec<Option<u32>> = line.iter().map(at).collect();
    let mut best: Option<(usize, usize)> = None;
    let mut from = 0;
    for k in 1..=labels.len() {
        if k == labels.len() || labels[k] != labels[from] {
            if labels[from].is_some() && best.is_none_or(|(a, b)| b - a < k - from) {
                best = Some((from, k));
            }
            from = k;
        }
    }
    let (a, b) = best?;
    (b - a > 3).then(|| (labels[a].unwrap_or_default(), &line[a..b]))
}

/// The line oriented to start at the hairline or, if both ends or neither are there, in front.
pub(crate) fn from_the_hairline(
    scalp: &Scalp,
    sections: &Sections,
    mut line: Vec<Vec2>,
) -> Vec<Vec2> {
    let chart = scalp.chart();
    let end = |q: Vec2| {
        let cell = cell_of(q).unwrap_or(0);
        let p = chart.spots()[cell].point;
        // Closer to bare skin than to any line.
        let line = sections.at(p).map_or(0.0, |place| place.distance);
        let reach = (line / (CELL * scalp.frame().radius)).ceil() + 6.0;
        let ring = (0..16).any(|k| {
            let (s, c) = sin_cos_turns(k as f32 / 16.0);
            chart.grows(q + Vec2::new(s, c) * (reach * CELL)) == 0.0
        });
        (ring, scalp.frame().head_from_point(p).z)
    };
    let (Some(first), Some(last)) = (line.first().copied(), line.last().copied()) else {
        return line;
    };
    let (a, b) = (end(first), end(last));
    let turn = if a.0 != b.0 { b.0 } else { b.1 > a.1 };
    if turn {
        line.reverse();
    }
    line
}

/// Half of a section's width at each point of its row, cm; `unit` is one head unit in cm.
pub(crate) fn half_widths(scalp: &Scalp, section: u32, roots: &[Root], unit: f32) -> Vec<f32> {
    let (chart, step) = (scalp.chart(), 0.06 * unit);
    let inside = |q: Vec2| {
        let place = cell_of(q).filter(|_| chart.grows(q) >= 0.5).and_then(|cell| {
            scalp.sections()?.at(chart.origin() + chart.direction(q) * chart.out(cell))
        });
        place.is_some_and(|place| place.section == section)
    };
    let mut widths: Vec<f32> = (0..roots.len())
        .map(|k| {
            let root = &roots[k];
            let next = roots[(k + 1).min(roots.len() - 1)].point;
            let along = next - roots[k.saturating_sub(1)].point;
            let side = along.cross(root.normal).normalize_or_zero();
            let mut sum = 0.0;
            for way in [side, -side] {
                let inside = |d: &f32| inside(chart.flat(root.point + way * *d));
                let reach = (1..100).map(|k| k as f32 * step).take_while(inside).last();
                sum += 0.5 * reach.unwrap_or(0.0);
            }
            sum.max(0.5 * step)
        })
        .collect();
    for _ in 0..3 {
        let before = widths.clone();
        for k in 1..before.len().saturating_sub(1) {
            widths[k] = 0.25 * (before[k - 1] + 2.0 * before[k] + before[k + 1]);
        }
    }
    widths
}
