//! Seeds: places strewn in space, to each of which what lies nearest belongs.
//!
//! There is one in each cell of a lattice, anywhere within it. Guarantees: which seed a place belongs to hangs from that place
//! alone, whatever else there is; on a smooth surface as many have a share of it as asked for, within a fifth. Not
//! promised: that a seed lies on the surface.

use crate::maths::hash::Dice;
use glam::Vec3;

/// Of the seeds about a plane so many have a share of a square of it as large as a cell's side.
const ON_A_PLANE: f32 = 1.4;

/// Seeds all over space.
pub(super) struct Seeds {
    side: f32,
    dice: Dice,
    /// Tells lists of seeds that are strewn with the same dice apart.
    list: u64,
}

/// One of them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Seed {
    /// Number that no other seed of its list has.
    pub key: u64,
    pub at: Vec3,
}

impl Seeds {
    /// Seeds of which `density` have a share of a square centimetre of any surface.
    pub(super) fn on_surface(density: f32, dice: Dice, list: u64) -> Self {
        Self { side: (ON_A_PLANE / density).sqrt(), dice, list }
    }
    fn seed(&self, cell: [i64; 3]) -> Seed {
        let [x, y, z] = cell.map(|c| c as u64);
        let key = self.dice.bits(self.dice.bits(self.dice.bits(self.list, x), y), z);
        let within = Vec3::from([0, 1, 2].map(|axis| self.dice.unit(key, axis)));
        let corner = Vec3::from(cell.map(|c| c as f32));
        Seed { key, at: (corner + within) * self.side }
    }
    /// The nearest of the seeds in the cell of a place and in those about it.
    pub(super) fn nearest(&self, p: Vec3) -> Seed {
        let cell = (p / self.side).floor().to_array().map(|x| x as i64);
        let mut best = self.seed(cell);
        for k in (0..27i64).filter(|k| *k != 13) {
            let step = [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1];
            let seed = self.seed([0, 1, 2].map(|axis| cell[axis].saturating_add(step[axis])));
            if seed.at.distance_squared(p) < best.at.distance_squared(p) {
                best = seed;
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn as_many_have_a_share_of_a_surface_as_were_asked_for() {
        let turn = Dice::new(3, 0, "turn");
        for density in [0.3, 1.0, 4.0] {
            let seeds = Seeds::on_surface(density, Dice::new(1, 0, "seeds"), 0);
            for plane in 0..6 {
                let v = |k: u64| Vec3::from([0, 1, 2].map(|a| turn.signed(plane, 3 * k + a)));
                let normal = if plane == 0 { Vec3::Y } else { v(0).normalize() };
                let (x, y) = normal.any_orthonormal_pair();
                // A square of so many seeds that those cut off at its edge hardly count.
                let (side, step) = (20.0 / density.sqrt(), 0.125 / density.sqrt());
                let n = (side / step) as u32;
                let at = |k: u32| v(1) * 9.0 + (x * (k % n) as f32 + y * (k / n) as f32) * step;
                let found: BTreeSet<u64> = (0..n * n).map(|k| seeds.nearest(at(k)).key).collect();
                let found = found.len() as f32 / (side * side);
                assert!((found / density - 1.0).abs() < 0.25, "{density}: {found}");
            }
        }
    }
}
