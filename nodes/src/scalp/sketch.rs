//! A rough version of a mesh, to rule out non-heads at almost no cost.
//!
//! Each large piece is sampled evenly by area, once. A sphere fitted to the samples tells, for any axis up and any
//! pieces left out, whether there may be a cranium: in tens of microseconds, however many triangles there are.
//!
//! Guarantees: the same samples everywhere; no more than [`MOST`] and [`FEWEST`] allow. Not promised: an exact sphere;
//! it is off by a few percent. Candidates are examined again with all of their triangles.

use super::axes::Up;
use super::find::Pieces;
use super::fit::{self, Cell, Fit};
use glam::Vec3;

/// Samples of a mesh, distributed by area ...
const MOST: f64 = 32768.0;
/// ... and the minimum for each piece.
const FEWEST: f64 = 3072.0;

/// What lies nearer to the axis through a cranium than this may be a body above it, radii ...
const WITHIN: f32 = 0.8;
/// ... in slabs this high ...
const SLAB: f32 = 0.5;
/// ... up to this far above its centre: hats and hair reach 2.5.
const HIGHEST_HAT: f32 = 4.5;
/// How far under the centre of a cranium its neck is, radii.
const NECK: (f32, f32) = (1.1, 1.7);
/// The most places of a mesh that are looked at as tops of heads ...
const MOST_TOPS: usize = 24;
/// ... by what lies within this many heights of the mesh beside them, then within so many radii ...
const TOP_REACH: f32 = 0.2;
const APART: f32 = 1.7;
/// ... and around a place that is none, this many heights are passed over.
const NO_TOP: f32 = 0.06;

/// The samples of a mesh.
pub(crate) struct MeshSamples {
    /// Samples of each large piece, and of all others together.
    groups: Vec<Group>,
}

#[derive(Clone)]
struct Group {
    samples: Vec<Cell>,
    /// The extreme points along the axes, in both directions.
    ends: [Vec3; 6],
}

impl MeshSamples {
    /// Samples a mesh.
    pub(crate) fn of(points: &[Vec3], triangles: &[[u32; 3]], pieces: &Pieces) -> Self {
        let n_large = pieces.large().len();
        let group = |t: usize| (pieces.of[t] as usize).min(n_large);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize].as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        };
        let mut totals = vec![0.0f64; n_large + 1];
        let areas: Vec<f64> = triangles.iter().map(area).collect();
        areas.iter().enumerate().for_each(|(t, area)| totals[group(t)] += area);
        let whole: f64 = totals.iter().sum();
        let counts: Vec<f64> =
            totals.iter().map(|area| (MOST * area / whole).ceil().clamp(FEWEST, MOST)).collect();
        let nowhere = [Vec3::NEG_INFINITY, Vec3::INFINITY];
        let ends = std::array::from_fn(|end| nowhere[end % 2]);
        let none = Group { samples: vec![], ends };
        let mut groups = vec![none; n_large + 1];
        let mut sums = vec![0.0f64; n_large + 1];
        for (t, corners) in triangles.iter().enumerate() {
            let g = group(t);
            let [a, b, c] = corners.map(|v| points[v as usize]);
            let Group { samples, ends } = &mut groups[g];
            for p in [a, b, c] {
                for axis in 0..3 {
                    if p[axis] > ends[2 * axis][axis] {
                        ends[2 * axis] = p;
                    }
                    if p[axis] < ends[2 * axis + 1][axis] {
                        ends[2 * axis + 1] = p;
                    }
                }
            }
            sums[g] += areas[t];
            let step = totals[g] / counts[g];
            while (samples.len() as f64) < counts[g]
                && sums[g] > (samples.len() as f64 + 0.5) * step
            {
                let (u, v) = within(samples.len() as u32);
                samples.push(Cell { of: 0, at: a + (b - a) * u + (c - a) * v, area: step as f32 });
            }
        }
        Self { groups }
    }

    /// The cranium with one axis up, from the pieces that are kept (all small pieces share one index, the next one);
    /// `None` if there cannot be a whole one.
    pub(crate) fn cranium(&self, up: Up, keeps: impl Fn(u32) -> bool) -> Option<Fit> {
        let kept = || {
            let kept = self.groups.iter().zip(0u32..).filter(|(_, piece)| keeps(*piece));
            kept.map(|(group, _)| group).filter(|group| !group.samples.is_empty())
        };
        let ends = || kept().flat_map(|group| group.ends).map(|p| up.turned(p));
        let top = ends().max_by(|a, b| a.y.total_cmp(&b.y))?;
        let height = top.y - ends().fold(f32::MAX, |low, p| low.min(p.y));
        let turned = |cell: &Cell| Cell { at: up.turned(cell.at), ..*cell };
        let samples = kept().flat_map(|group| group.samples.iter().map(turned));
        fit::rough(samples, top, height).filter(|fit| fit.may_be_whole())
    }
}

impl MeshSamples {
    /// Whether the mesh goes on above this cranium, as a leg does above a knee: without a gap, and higher than any hat.
    pub(crate) fn goes_on_above(&self, up: Up, fit: &Fit) -> bool {
        let first = (1.0 / SLAB) as usize;
        let slabs = (HIGHEST_HAT / SLAB) as usize;
        let mut filled = vec![false; slabs];
        for at in self.about(up, fit, WITHIN) {
            if let Some(filled) = filled.get_mut((at.y.max(0.0) / SLAB) as usize) {
                *filled = true;
            }
        }
        filled[first..].iter().all(|filled| *filled)
    }

    /// Whether there is something under this cranium that it may stand on.
    pub(crate) fn has_neck(&self, up: Up, fit: &Fit) -> bool {
        self.about(up, fit, 1.0).any(|at| (NECK.0..NECK.1).contains(&-at.y))
    }

    /// All samples at most this far from the vertical axis through a cranium, seen from its centre; all in radii.
    fn about(&self, up: Up, fit: &Fit, within: f32) -> impl Iterator<Item = Vec3> {
        let samples = self.groups.iter().flat_map(|group| &group.samples);
        let seen = samples.map(move |cell| (up.turned(cell.at) - fit.centre) / fit.radius);
        seen.filter(move |at| at.with_y(0.0).length() <= within)
    }

    /// The craniums that stand highest about them, each alone, highest first: of one piece, or of all.
    pub(crate) fn craniums(&self, up: Up, piece: Option<u32>) -> Vec<Fit> {
        let groups =
            (0u32..).zip(&self.groups).filter(|(of, _)| piece.is_none_or(|only| *of == only));
        let mut samples: Vec<Cell> = groups
            .flat_map(|(_, group)| &group.samples)
            .map(|cell| Cell { at: up.turned(cell.at), ..*cell })
            .collect();
        samples.sort_by(|a, b| b.at.y.total_cmp(&a.at.y));
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return vec![] };
        let height = first.at.y - last.at.y;
        let mut found = vec![];
        for _ in 0..MOST_TOPS {
            let Some(Cell { at: top, .. }) = samples.first().copied() else { break };
            let column = |centre: Vec3, wide: f32| {
                let near = move |cell: &&Cell| (cell.at - centre).with_y(0.0).length() <= wide;
                samples.iter().filter(near).copied()
            };
            // The first sphere is that of all that is near; others stand beside the second.
            let rough = fit::rough(column(top, TOP_REACH * height), top, height);
            let alone = rough
                .and_then(|fit| fit::rough(column(fit.centre, APART * fit.radius), top, height));
            let alone = alone.filter(|fit| fit.may_be_whole() && fit.head_like());
            let (middle, wide) =
                alone.map_or((top, NO_TOP * height), |fit| (fit.centre, APART * fit.radius));
            found.extend(alone);
            samples.retain(|cell| (cell.at - middle).with_y(0.0).length() > wide);
        }
        found
    }
}

/// Position of the k-th sample in a triangle, as weights of its second and third corner: evenly distributed, for
/// consecutive samples as well (the two-dimensional golden ratio of M. Roberts).
fn within(k: u32) -> (f32, f32) {
    let part = |by: u32| (k.wrapping_mul(by) >> 8) as f32 / (1 << 24) as f32;
    let (u, v) = (part(3_242_174_889), part(2_447_445_414));
    if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) }
}
