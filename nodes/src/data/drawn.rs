//! Drawn regions: the inside of closed lines on a head, exact within its triangles.
//!
//! A line wholly inside another cuts a hole into it; otherwise the region is the union. The edge fades with the
//! straight distance to the line, half of its width on each side.
//!
//! Guarantees: the value at a point follows the lines, not an average over the corners of its triangle, however large
//! the triangle. Not promised: which of several crossing or self-crossing lines is a hole.

use super::outline::{ConnectedSurface, Outline, for_middles};
use crate::maths::closest::Surface;
use crate::maths::hash::{Key, KeyBuilder};
use crate::maths::soft_edge;
use glam::Vec2;
use std::sync::Arc;

/// A drawn region of one surface.
pub(crate) struct DrawnRegion {
    /// Lines, and whether each is the edge of a hole; holes come after the line that contains them.
    lines: Vec<(Arc<Outline>, bool)>,
    /// Whether the region is what the lines leave outside.
    outside: bool,
    /// Width of the edge, cm.
    softness: f32,
    /// For each vertex, whether hair may grow there at all: 0 or 1.
    may: Arc<[f32]>,
    /// Value at each vertex.
    values: Vec<f32>,
    /// Triangles in which values cannot be interpolated from the corners.
    exact: Vec<bool>,
    /// Area in cm2, weighted by the fade.
    area: f32,
}

impl DrawnRegion {
    /// The region inside `lines`, each with whether it is the edge of a hole, or all that is `outside`.
    pub(crate) fn new(
        net: &ConnectedSurface,
        (mut lines, outside): (Vec<(Arc<Outline>, bool)>, bool),
        softness: f32,
        may: Arc<[f32]>,
    ) -> Self {
        lines.sort_by_key(|(_, hole)| *hole);
        let surface = net.surface();
        let (values, exact) = (vec![], vec![]);
        let mut drawn = Self { lines, outside, softness, may, values, exact, area: 0.0 };
        drawn.values = (0..surface.points.len() as u32)
            .map(|v| {
                let depth = |line: &Outline| {
                    let distance = line.distance(surface.points[v as usize]);
                    if line.holds_vertex(v) { distance.max(f32::MIN_POSITIVE) } else { -distance }
                };
                drawn.may[v as usize] * soft_edge(drawn.deepest(depth), softness)
            })
            .collect();
        let mixed = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| drawn.values[v as usize]);
            a != b || b != c || (a > 0.0 && a < 1.0)
        };
        let mut exact: Vec<bool> = surface.triangles.iter().map(mixed).collect();
        for (line, _) in &drawn.lines {
            for piece in line.pieces() {
                exact[piece.triangle as usize] = true;
                net.beside(piece.triangle).for_each(|t| exact[t as usize] = true);
            }
        }
        drawn.exact = exact;
        // Spacing at which the smallest line has a few hundred samples inside.
        let length = |line: &Outline| -> f32 {
            line.pieces().iter().map(|piece| piece.ends[0].distance(piece.ends[1])).sum()
        };
        let shortest = drawn.lines.iter().map(|(line, _)| length(line)).fold(f32::MAX, f32::min);
        let area = (0..surface.triangles.len() as u32).filter(|t| !surface.is_gone(*t)).map(|t| {
            let whole = 0.5 * f64::from(surface.area_vector(t).length());
            if !drawn.exact[t as usize] {
                return whole * f64::from(drawn.values[surface.triangles[t as usize][0] as usize]);
            }
            let n = ((2.0 * whole).sqrt() / f64::from(shortest / 80.0)).ceil();
            let (mut sum, n) = (0.0, n.clamp(8.0, 256.0) as u32);
            for_middles(n, |bary| sum += f64::from(drawn.at(surface, t, bary)));
            whole * sum / f64::from(n * n)
        });
        drawn.area = area.sum::<f64>() as f32;
        drawn
    }

    /// Depth inside the region, from the depth inside each line.
    fn deepest(&self, depth: impl Fn(&Outline) -> f32) -> f32 {
        let inside = self.lines.iter().fold(f32::MIN, |deepest, (line, hole)| match hole {
            false => deepest.max(depth(line)),
            true => deepest.min(-depth(line)),
        });
        if self.outside { -inside } else { inside }
    }

    /// The value at a point of a triangle, 0 to 1.
    pub(crate) fn at(&self, surface: &Surface, triangle: u32, bary: Vec2) -> f32 {
        let Some(corners) = surface.triangles.get(triangle as usize) else { return 0.0 };
        let mix = |values: &[f32]| {
            let [a, b, c] = corners.map(|v| values[v as usize]);
            a * (1.0 - bary.x - bary.y) + b * bary.x + c * bary.y
        };
        if !self.exact[triangle as usize] {
            return mix(&self.values);
        }
        let may = mix(&self.may);
        if may <= 0.0 {
            return 0.0;
        }
        may * soft_edge(self.deepest(|line| line.depth(surface, triangle, bary)), self.softness)
    }

    /// Upper bound of the values in a triangle; `None` if the corners bound them.
    pub(crate) fn highest(&self, triangle: u32) -> Option<f32> {
        self.exact[triangle as usize].then_some(1.0)
    }
    /// Value at each vertex.
    pub(crate) fn values(&self) -> &[f32] {
        &self.values
    }
    /// Area in cm2, weighted by the fade.
    pub(crate) fn area(&self) -> f32 {
        self.area
    }
    /// Hash of the content.
    pub(crate) fn key(&self) -> Key {
        let key = KeyBuilder::new("drawn").float(self.softness).column(&self.values);
        let key = key.int(u64::from(self.outside));
        let lines = self.lines.iter().fold(key, |key, (line, hole)| {
            line.pieces().iter().fold(key.int(u64::from(*hole)), |key, piece| {
                key.int(u64::from(piece.triangle)).vec3(piece.ends[0]).vec3(piece.ends[1])
            })
        });
        lines.finish()
    }
    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let lines: usize = self.lines.iter().map(|(line, _)| line.bytes()).sum();
        lines + 8 * self.values.len() + self.exact.len()
    }
}
