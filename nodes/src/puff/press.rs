//! Walls between puffs: the planes at which adjacent puffs end.
//!
//! Guarantees: pressed points keep their direction from the puff's centre, so that hairs keep their order; points on
//! their own side of a wall stay; both puffs of a pair use the same plane.

use glam::Vec3;

/// A plane between a puff and one beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall {
    /// Vector from this puff's centre to the other's.
    towards: Vec3,
    /// Position of the plane along that vector, 0 to 1.
    at: f32,
}

/// Smallest fraction of the way from either centre: a puff inside a much larger one keeps some volume.
const NEAREST: f32 = 0.1;

impl Wall {
    /// Halfway between two puffs of equal size.
    pub(super) fn half_way(from: Vec3, to: Vec3) -> Self {
        Self { towards: to - from, at: 0.5 }
    }
    /// Where two puffs meet that reach this far toward each other: for spheres, the plane of their common circle.
    pub(super) fn between((from, far): (Vec3, f32), (to, other_far): (Vec3, f32)) -> Self {
        let apart = from.distance_squared(to).max(1e-6);
        let at = 0.5 + 0.5 * (far * far - other_far * other_far) / apart;
        Self { towards: to - from, at: at.clamp(NEAREST, 1.0 - NEAREST) }
    }
    /// The wall's data, for keys.
    pub(super) fn key_parts(&self) -> (Vec3, f32) {
        (self.towards, self.at)
    }
}

/// A point at `off` from the puff's centre, pulled back along its direction toward the walls that it crosses, by this
/// fraction of the excess.
pub(super) fn pressed(off: Vec3, walls: &[Wall], share: f32) -> Vec3 {
    let mut off = off;
    for wall in walls {
        let along = off.dot(wall.towards) / wall.towards.length_squared().max(1e-6);
        if along > wall.at {
            let on_wall = off * (wall.at / along);
            off = off.lerp(on_wall, share);
        }
    }
    off
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_spheres_meet_in_the_circle_they_share() {
        let (a, b) = ((Vec3::ZERO, 5.0), (Vec3::X * 7.0, 4.0));
        let (one, other) = (Wall::between(a, b), Wall::between(b, a));
        // x2 - (x - 7)2 = 25 - 16.
        let x = (49.0 + 9.0) / 14.0;
        assert!((one.at * 7.0 - x).abs() < 1e-5 && (7.0 - other.at * 7.0 - x).abs() < 1e-5);
        let over = Vec3::new(4.8, 1.0, 0.5);
        let on = pressed(over, &[one], 1.0);
        assert!((on.x - x).abs() < 1e-5 && on.cross(over).length() < 1e-4, "{on}");
        assert!((pressed(over, &[one], 0.5) - 0.5 * (on + over)).length() < 1e-5);
        let within = Vec3::new(3.0, 4.0, 0.0);
        assert_eq!(pressed(within, &[one], 1.0), within);
    }
}
