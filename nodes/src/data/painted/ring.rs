//! A closed line on a head, and what lies inside it.
//!
//! Seen from the middle of the head the line is made of arcs of great circles; a place is inside where the way to a pole outside
//! crosses it an odd number of times. Which side is the inside is told by the surface: the smaller one.

use super::Dab;
use crate::data::scalp::Scalp;
use crate::maths::frame::any_normal;
use crate::maths::transcendental::atan2;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A closed line.
pub(super) struct Ring {
    origin: Vec3,
    /// Two axes at right angles to the pole, and the pole.
    axes: [Vec3; 3],
    edges: Vec<Edge>,
    /// Numbers of the edges that cross each of [`SECTORS`], from `starts` on.
    starts: Vec<u32>,
    listed: Vec<u32>,
    /// Whether the pole is inside.
    turned: bool,
}

struct Edge {
    /// How far round its ends are, turns.
    round: [f32; 2],
    /// Normal of the plane through it and the middle.
    plane: Vec3,
    /// Whether the pole lies on the side that the normal points to.
    pole: bool,
}

const SECTORS: usize = 256;
/// The most triangles that are looked at to tell the smaller side.
const LOOKS: usize = 8192;

impl Ring {
    /// The line through these dabs, from the last back to the first.
    pub(super) fn new(scalp: &Scalp, dabs: &[Dab]) -> Self {
        let origin = scalp.frame().origin;
        let ways: Vec<Vec3> =
            dabs.iter().map(|dab| (dab.point - origin).normalize_or_zero()).collect();
        let next = || ways.iter().skip(1).chain(ways.first());
        let sum: Vec3 = ways.iter().zip(next()).map(|(a, b)| (*a + *b) * a.distance(*b)).sum();
        let area: Vec3 = ways.iter().zip(next()).map(|(a, b)| a.cross(*b)).sum();
        // (Of a line all round the head the middle is no way, but its plane has two.)
        let pole = -sum.try_normalize().or(area.try_normalize()).unwrap_or(Vec3::Y);
        let right = any_normal(pole);
        let mut ring = Self {
            origin,
            axes: [right, pole.cross(right), pole],
            edges: vec![],
            starts: vec![0; SECTORS + 1],
            listed: vec![],
            turned: false,
        };
        let edge = |(a, b): (&Vec3, &Vec3)| {
            let plane = a.cross(*b);
            Edge { round: [*a, *b].map(|way| ring.round(way)), plane, pole: plane.dot(pole) > 0.0 }
        };
        ring.edges = ways.iter().zip(next()).map(edge).collect();
        let sectors = |edge: &Edge| {
            let [from, to] = edge.round;
            let (from, to) = (from, from + short(to - from));
            let [low, high] =
                [from.min(to), from.max(to)].map(|x| (x * SECTORS as f32).floor() as i32);
            // One more on each side: an edge ends within a rounding of a border.
            (low - 1..=high + 1).take(SECTORS).map(|x| x.rem_euclid(SECTORS as i32) as usize)
        };
        for edge in &ring.edges {
            sectors(edge).for_each(|at| ring.starts[at + 1] += 1);
        }
        for at in 1..=SECTORS {
            ring.starts[at] += ring.starts[at - 1];
        }
        let mut next = ring.starts.clone();
        ring.listed = vec![0; ring.starts[SECTORS] as usize];
        for (i, edge) in (0u32..).zip(&ring.edges) {
            for at in sectors(edge) {
                ring.listed[next[at] as usize] = i;
                next[at] += 1;
            }
        }
        let surface = scalp.surface();
        let every = surface.triangles.len().div_ceil(LOOKS).max(1);
        let (mut inside, mut all) = (0.0f64, 0.0f64);
        for triangle in (0..surface.triangles.len() as u32).step_by(every) {
            let area = f64::from(surface.area_vector(triangle).length());
            all += area;
            if ring.holds(surface.at(triangle, Vec2::splat(1.0 / 3.0))) {
                inside += area;
            }
        }
        ring.turned = inside > 0.5 * all;
        ring
    }

    /// How far round the pole a direction is, turns from -0.5 to 0.5.
    fn round(&self, way: Vec3) -> f32 {
        let [right, up, _] = self.axes;
        atan2(way.dot(up), way.dot(right)) / TAU
    }

    /// Whether a point is inside.
    pub(super) fn holds(&self, p: Vec3) -> bool {
        let way = p - self.origin;
        let round = self.round(way);
        let sector = ((round * SECTORS as f32).floor() as i32).rem_euclid(SECTORS as i32) as usize;
        let listed = &self.listed[self.starts[sector] as usize..self.starts[sector + 1] as usize];
        let crossed = listed.iter().filter(|i| {
            let edge = &self.edges[**i as usize];
            let [a, b] = edge.round.map(|end| short(end - round));
            (a >= 0.0) != (b >= 0.0)
                && (a - b).abs() < 0.5
                && (edge.plane.dot(way) > 0.0) != edge.pole
        });
        (crossed.count() % 2 == 1) != self.turned
    }
}

/// The same turn the shorter way, -0.5 to 0.5.
fn short(turns: f32) -> f32 {
    match turns {
        x if x > 0.5 => x - 1.0,
        x if x < -0.5 => x + 1.0,
        x => x,
    }
}
