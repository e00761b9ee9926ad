//! What a smooth stroke blends a mask toward: the local mean of the result of all earlier strokes.
//!
//! Means of means would cost more with each stroke, so they are computed once, on a grid with a spacing of a quarter of
//! the radius, and interpolated in between.
//!
//! Guarantees: results stay within the minimum and maximum of the neighbourhood; constant areas stay constant.

use super::Painted;
use crate::data::scalp::Root;
use crate::error::NodeError;
use crate::maths::frame::any_normal;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// Means on a grid, as far as a stroke reaches.
#[derive(Default)]
pub struct GridMeans {
    low: Vec3,
    side: f32,
    /// By grid position, sorted.
    means: Vec<([i32; 3], f32)>,
}

/// Grid cells per radius.
const FINE: f32 = 4.0;
/// Radius of the neighbourhood, as a fraction of the brush radius.
const ABOUT: f32 = 0.5;
/// A longer path, in grid cells, makes the grid coarser.
const LONGEST: f64 = 6_000.0;
/// Corners farther from the skin than this many cells belong to no cell with skin in it.
const OFF: f32 = 1.7321;

impl GridMeans {
    /// What stroke `layer` blends the mask toward.
    pub(super) fn new(
        painted: &Painted,
        layer: u32,
        check: &dyn Fn() -> Result<(), NodeError>,
    ) -> Result<Self, NodeError> {
        let pieces = painted.dabs.of(layer);
        let Some(first) = pieces.first() else { return Ok(Self::default()) };
        let (radius, low) = (first.reach, painted.scalp.frame().origin);
        let mut side = radius / FINE;
        let steps = |side: f32, [a, b]: [Vec3; 2]| (a.distance(b) / (2.0 * side)).ceil().max(1.0);
        let ends = || pieces.iter().map(|piece| piece.ends.map(|dab| dab.point));
        if side <= 0.0 || !side.is_finite() {
            return Ok(Self::default());
        }
        let way: f64 = ends().map(|[a, b]| f64::from(a.distance(b))).sum();
        while way / f64::from(side) > LONGEST {
            side *= 2.0;
        }
        let cell = |p: Vec3| ((p - low) / side).floor().as_ivec3().to_array();
        let mut corners: Vec<[i32; 3]> = vec![];
        let reach = radius + OFF * side;
        for ends in ends() {
            check()?;
            let [a, b] = ends;
            let steps = steps(side, ends) as usize;
            for step in 0..steps {
                let [from, to] = [step, step + 1].map(|k| a.lerp(b, k as f32 / steps as f32));
                let (least, most) = (cell(from.min(to) - reach), cell(from.max(to) + reach));
                let middle = (from + to) * 0.5;
                let near = reach + 0.5 * from.distance(to);
                for x in least[0]..=most[0] {
                    for y in least[1]..=most[1] {
                        for z in least[2]..=most[2] {
                            let p = low + Vec3::new(x as f32, y as f32, z as f32) * side;
                            if p.distance_squared(middle) <= near * near {
                                corners.push([x, y, z]);
                            }
                        }
                    }
                }
            }
            if corners.len() > 1 << 22 {
                corners.sort_unstable();
                corners.dedup();
            }
        }
        corners.sort_unstable();
        corners.dedup();
        let mut means = vec![];
        for corners in corners.chunks(512) {
            check()?;
            let mut places: Vec<Root> = vec![];
            for corner in corners {
                let p = low + Vec3::from(corner.map(|x| x as f32)) * side;
                let root = painted.scalp.closest_root(p);
                let Some(root) = root.filter(|root| root.point.distance(p) <= OFF * side) else {
                    continue;
                };
                means.push((*corner, 0.0));
                let lined = painted.layers[..layer as usize].iter().any(|l| l.lines.is_some());
                let rooted = lined || painted.base.constant().is_none();
                about(&root, ABOUT * radius, |point| {
                    let there = rooted.then(|| painted.scalp.closest_root(point)).flatten();
                    let there = there.unwrap_or(root);
                    places.push(Root { point, normal: root.normal, ..there });
                });
            }
            let bases = painted.base.on_skin(&places, &painted.scalp)?;
            let values: Vec<f32> = places
                .iter()
                .zip(bases)
                .map(|(place, base)| {
                    let at = (place.triangle, place.bary);
                    painted.before(layer, at, place.point, || place.normal, base)
                })
                .collect();
            let from = means.len() - values.len() / PLACES;
            for ((_, mean), values) in means[from..].iter_mut().zip(values.chunks(PLACES)) {
                *mean = values.iter().sum::<f32>() / PLACES as f32;
            }
        }
        Ok(Self { low, side, means })
    }

    /// The mean at a point of the skin; `None` if unknown.
    pub(super) fn at(&self, p: Vec3) -> Option<f32> {
        if self.means.is_empty() {
            return None;
        }
        let at = (p - self.low) / self.side;
        let cell = at.floor();
        let (part, cell) = (at - cell, cell.as_ivec3().to_array());
        let (mut sum, mut weights) = (0.0, 0.0);
        for corner in 0..8 {
            let up = [0, 1, 2].map(|k| corner >> k & 1);
            let weigh = |k: usize| if up[k] == 1 { part[k] } else { 1.0 - part[k] };
            let weight = weigh(0) * weigh(1) * weigh(2);
            let place = [0, 1, 2].map(|k| cell[k].saturating_add(up[k]));
            if let Ok(i) = self.means.binary_search_by(|(at, _)| at.cmp(&place)) {
                sum += self.means[i].1 * weight;
                weights += weight;
            }
        }
        (weights > 1e-6).then(|| sum / weights)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.means[..])
    }
}

/// Samples per mean.
const PLACES: usize = 13;

/// A point and twelve others around it, in the tangent plane of the skin.
fn about(root: &Root, far: f32, mut each: impl FnMut(Vec3)) {
    each(root.point);
    let right = any_normal(root.normal);
    let up = root.normal.cross(right);
    for k in 0..12 {
        let (sin, cos) = sin_cos_turns(k as f32 / 12.0);
        let far = if k % 2 == 0 { far } else { 0.5 * far };
        each(root.point + (right * cos + up * sin) * far);
    }
}
