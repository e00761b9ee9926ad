//! Seeds: random points in space, each with the Voronoi cell around it.
//!
//! One seed per cell of a lattice, anywhere within it. Guarantees: the seed of a place depends on that place alone; on a smooth
//! surface, the number of seeds whose cell it meets is as requested, within a fifth. Not promised: that a seed lies on the
//! surface.

use crate::maths::hash::Dice;
use glam::Vec3;
use std::collections::BTreeMap;

/// Number of seeds whose cell meets a square of a plane, with sides of one lattice cell.
const ON_A_PLANE: f32 = 1.4;

/// Seeds throughout space.
pub(super) struct Seeds {
    side: f32,
    dice: Dice,
    /// Distinguishes lists of seeds from the same dice.
    list: u64,
}

/// One seed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Seed {
    /// Number that is unique in its list.
    pub key: u64,
    pub at: Vec3,
}

impl Seeds {
    /// Seeds of which `density` per cm2 have a cell that meets any given surface.
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
    /// For queries close to each other: each seed is drawn once.
    pub(super) fn kept(&self) -> DrawnSeeds<'_> {
        DrawnSeeds { seeds: self, drawn: BTreeMap::new() }
    }
}

/// Seeds that were drawn so far.
pub(super) struct DrawnSeeds<'a> {
    seeds: &'a Seeds,
    /// For each cell that was asked for: its seed and those of its neighbours, as far as they were needed.
    drawn: BTreeMap<[i64; 3], [Option<Seed>; 27]>,
}

/// Index of the cell itself among itself and its 26 neighbours.
const MIDDLE: usize = 13;

impl DrawnSeeds<'_> {
    /// The nearest seed in the cell of a place and its neighbours.
    pub(super) fn nearest(&mut self, p: Vec3) -> Seed {
        let seeds = self.seeds;
        let q = p / seeds.side;
        let low = q.floor();
        let cell = low.to_array().map(|x| x as i64);
        let drawn = self.drawn.entry(cell).or_insert([None; 27]);
        let step = |k: usize| [k % 3, k / 3 % 3, k / 9].map(|x| x as i64 - 1);
        let mut seed = |k: usize| {
            let at = |axis: usize| cell[axis].saturating_add(step(k)[axis]);
            *drawn[k].get_or_insert_with(|| seeds.seed([0, 1, 2].map(at)))
        };
        // How far off the cells beside it are, less what is rounded.
        let rounding = 1e-6 * (1.0 + q.abs().max_element());
        let [below, above] = [q - low, Vec3::ONE - (q - low)];
        let [below, above] = [below, above].map(|off| (off - rounding).max(Vec3::ZERO).to_array());
        let reach = |seed: &Seed| seed.at.distance_squared(p) / (seeds.side * seeds.side) * 1.001;
        let mut best = seed(MIDDLE);
        let mut most = reach(&best);
        for k in (0..27).filter(|k| *k != MIDDLE) {
            let off = |a: usize| match step(k)[a] {
                -1 => below[a],
                1 => above[a],
                _ => 0.0,
            };
            if off(0) * off(0) + off(1) * off(1) + off(2) * off(2) > most {
                continue;
            }
            let seed = seed(k);
            if seed.at.distance_squared(p) < best.at.distance_squared(p) {
                best = seed;
                most = reach(&best);
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
                let mut kept = seeds.kept();
                let found: BTreeSet<u64> = (0..n * n).map(|k| kept.nearest(at(k)).key).collect();
                let found = found.len() as f32 / (side * side);
                assert!((found / density - 1.0).abs() < 0.25, "{density}: {found}");
            }
        }
    }
}
