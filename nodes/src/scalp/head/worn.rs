//! Things worn on heads, for tests: buns, tails, bangs, caps of hair, helmets, hats, glasses, of any size and
//! direction.
//!
//! A head here has its cranium's centre at the origin, radius 1, and faces +z.

use crate::maths::hash::Dice;
use crate::maths::transcendental::{sin_cos, sin_cos_turns};
use glam::Vec3;

/// Points and triangles.
#[derive(Clone, Default)]
pub(super) struct WornMesh {
    pub(super) points: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl WornMesh {
    /// The shape with another beside it, which shares no vertex with it.
    pub(super) fn and(mut self, other: &Self) -> Self {
        let n = self.points.len() as u32;
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + n)));
        self
    }
    pub(super) fn placed(mut self, place: impl Fn(Vec3) -> Vec3) -> Self {
        self.points.iter_mut().for_each(|p| *p = place(*p));
        self
    }
    /// A sheet of `across` by `along` squares over (0, 0) to (1, 1), without squares that have a missing corner.
    fn sheet(across: u32, along: u32, at: impl Fn(f32, f32) -> Option<Vec3>) -> Self {
        let (n, m) = (across as f32, along as f32);
        let grid =
            (0..=along).flat_map(|j| (0..=across).map(move |i| (i as f32 / n, j as f32 / m)));
        let all: Vec<Option<Vec3>> = grid.map(|(u, v)| at(u, v)).collect();
        let mut triangles = vec![];
        for j in 0..along {
            for i in 0..across {
                let a = j * (across + 1) + i;
                let corners = [a, a + 1, a + across + 2, a + across + 1];
                if corners.iter().all(|v| all[*v as usize].is_some()) {
                    let [a, b, c, d] = corners;
                    triangles.extend([[a, c, b], [a, d, c]]);
                }
            }
        }
        Self { points: all.into_iter().map(Option::unwrap_or_default).collect(), triangles }
    }
    pub(super) fn ball(middle: Vec3, half: Vec3) -> Self {
        Self::sheet(28, 18, |u, v| {
            let ((s, c), (out, up)) = (sin_cos_turns(u), sin_cos_turns(0.5 * v));
            Some(middle + half * Vec3::new(out * c, up, out * s))
        })
    }
}

/// The direction at these degrees to the head's left of its face and above its centre.
pub(super) fn way(aside: f32, above: f32) -> Vec3 {
    let ((s, c), (high, out)) = (sin_cos(aside.to_radians()), sin_cos(above.to_radians()));
    Vec3::new(s * out, high, c * out)
}

/// A shell over the crown from `low` degrees up, open in front to `side` degrees and up to `top`.
fn shell(far: f32, low: f32, side: f32, top: f32) -> WornMesh {
    WornMesh::sheet(64, 32, |u, v| {
        let (aside, above) = (u * 360.0 - 180.0, low + (90.0 - low) * v);
        let is_open = aside.abs() < side && above < top;
        (!is_open).then(|| way(aside, above) * Vec3::new(0.93, 1.0, 1.06) * far)
    })
}

/// Number of kinds of things worn.
pub(super) const KINDS: u32 = 14;

/// One of each kind, of any size and direction.
pub(super) fn worn(kind: u32, dice: Dice, id: u64) -> WornMesh {
    let any = |index: u64, lo: f32, hi: f32| dice.range(id, index, lo, hi);
    let both = |shape: &dyn Fn(f32) -> WornMesh| shape(1.0).and(&shape(-1.0));
    match kind % KINDS {
        // Buns at the back and on top.
        0 | 1 => {
            let size = any(0, 0.2, 0.6);
            let above =
                if kind.is_multiple_of(KINDS) { any(1, -20.0, 80.0) } else { any(1, 60.0, 90.0) };
            let half = Vec3::new(any(3, 0.7, 1.2), any(4, 0.7, 1.2), any(5, 0.7, 1.2)) * size;
            WornMesh::ball(way(any(2, 100.0, 260.0), above) * (1.0 + 0.6 * size), half)
        }
        // A ponytail, and two.
        2 => {
            let (aside, wide, long) = (any(0, 110.0, 250.0), any(1, 0.12, 0.4), any(2, 0.8, 3.0));
            let (from, out) = (way(aside, any(3, 0.0, 60.0)) * 1.05, any(4, 0.1, 0.5));
            WornMesh::sheet(20, 36, |u, v| {
                let ((s, c), thick) = (sin_cos_turns(u), wide * (0.15 + sin_cos_turns(0.5 * v).0));
                let middle =
                    from + way(aside, 0.0) * (out * (3.0 * v).min(1.0)) - Vec3::Y * (long * v * v);
                Some(middle + (way(aside + 90.0, 0.0) * c + way(aside, 0.0) * s) * thick)
            })
        }
        3 => {
            let (long, wide) = (any(0, 0.6, 2.0), any(1, 0.12, 0.35));
            let half = Vec3::new(wide, 0.6 * long, wide);
            both(&|side| WornMesh::ball(Vec3::new(side * 1.15, 0.4 - 0.5 * long, -0.3), half))
        }
        // Bangs.
        4 => {
            let (wide, low) = (any(0, 30.0, 80.0), any(1, -10.0, 25.0));
            let (far, bend) = (any(2, 1.02, 1.25), any(3, 0.0, 0.2));
            WornMesh::sheet(28, 16, |u, v| {
                let at = way((2.0 * u - 1.0) * wide, low + (75.0 - low) * v);
                Some(at * Vec3::new(0.9, 1.0, 1.08) * (far + bend * (1.0 - v)))
            })
        }
        // Caps of hair: open in front; all around; with an inside of their own.
        5 => shell(any(0, 1.05, 1.35), any(1, -60.0, 0.0), any(2, 20.0, 75.0), any(3, 20.0, 60.0)),
        6 => shell(any(0, 1.05, 1.4), any(1, -10.0, 20.0), 0.0, 0.0),
        7 => {
            let far = any(0, 1.15, 1.35);
            let one = |far| shell(far, any(1, -60.0, 0.0), any(2, 20.0, 75.0), any(3, 20.0, 60.0));
            one(far).and(&one(far - any(4, 0.03, 0.1)))
        }
        // A helmet, one that hides the whole head, and a hat with a brim.
        8 => shell(any(0, 1.2, 1.6), any(1, -50.0, -5.0), any(2, 30.0, 70.0), any(3, 5.0, 30.0)),
        9 => {
            let far = any(0, 1.3, 1.6);
            WornMesh::ball(
                Vec3::ZERO,
                Vec3::new(far, far * any(1, 0.9, 1.3), far * any(2, 1.0, 1.2)),
            )
        }
        10 => {
            let (low, wide, high, brim) =
                (any(0, 0.2, 0.5), any(1, 0.95, 1.15), any(2, 0.6, 1.8), any(3, 1.2, 2.5));
            let ring = |u: f32, far: f32, y: f32| {
                let (s, c) = sin_cos_turns(u);
                Some(Vec3::new(far * s, y, 1.1 * far * c))
            };
            let side = WornMesh::sheet(40, 8, |u, v| ring(u, wide, low + high * v));
            let top = WornMesh::sheet(40, 6, |u, v| ring(u, wide * (1.0 - v), low + high));
            side.and(&top)
                .and(&WornMesh::sheet(40, 6, |u, v| ring(u, wide + (brim - wide) * v, low)))
        }
        // Glasses.
        11 => {
            let (y, z, size) = (any(0, -0.35, 0.1), any(1, 1.0, 1.35), any(2, 0.15, 0.4));
            both(&|side| {
                let lens =
                    WornMesh::ball(Vec3::new(side * 0.38, y, z), Vec3::new(size, 0.8 * size, 0.05));
                let arm = Vec3::new(side * 0.85, y, 0.4);
                lens.and(&WornMesh::ball(arm, Vec3::new(0.03, 0.03, z - 0.3)))
            })
        }
        // Cards of hair.
        12 => {
            let (count, long) = (40 + dice.below(id, 0, 160), any(1, 0.5, 2.0));
            let card = |k: u64| {
                let (aside, above) = (any(3 * k + 2, 0.0, 360.0), any(3 * k + 3, 10.0, 90.0));
                let wide = any(3 * k + 4, 0.03, 0.12);
                let long = if (60.0..300.0).contains(&aside) { long } else { 0.3 * long };
                WornMesh::sheet(2, 10, |u, v| {
                    let out = way(aside, above) * 1.06 + way(aside, 0.0) * (0.6 * v.min(0.4));
                    let across = way(aside + 90.0, 0.0) * (wide * (2.0 * u - 1.0));
                    Some(out - Vec3::Y * (long * v * v) + across)
                })
            };
            (0..u64::from(count)).fold(WornMesh::default(), |all, k| all.and(&card(k)))
        }
        // Headphones.
        _ => {
            let cups = both(&|side| {
                WornMesh::ball(Vec3::new(side, -0.25, -0.1), Vec3::new(0.2, 0.4, 0.4))
            });
            cups.and(&WornMesh::sheet(8, 40, |u, v| {
                let (s, c) = sin_cos(1.6 * (2.0 * v - 1.0));
                Some(Vec3::new(1.15 * s, 1.15 * c, 0.2 * (u - 0.5)))
            }))
        }
    }
}
