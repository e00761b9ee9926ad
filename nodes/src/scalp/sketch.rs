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

/// Position of the k-th sample in a triangle, as weights of its second and third corner: evenly distributed, for
/// consecutive samples as well (the two-dimensional golden ratio of M. Roberts).
fn within(k: u32) -> (f32, f32) {
    let part = |by: u32| (k.wrapping_mul(by) >> 8) as f32 / (1 << 24) as f32;
    let (u, v) = (part(3_242_174_889), part(2_447_445_414));
    if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) }
}
