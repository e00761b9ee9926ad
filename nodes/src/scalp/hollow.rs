//! The inner wall of a hollow head, such as a bust for 3D printing: no hair grows on it or avoids it.
//!
//! A hollow head is a shell of a few millimetres. By distance alone, the air inside looks like the air outside, so that
//! hair that passes through the wall seems clear again, and half of what is scattered over the scalp grows inward.
//!
//! Guarantees: a head that is solid around the centre of its cranium has no inner wall. Not promised: nooks of the
//! cavity that are visible neither from its centre nor across it, such as in a chin, stay as they are.

use crate::define::NodeError;
use crate::maths::closest::{Hit, Surface};
use crate::maths::frame::round_about;
use glam::Vec3;

/// Spacing of the viewpoints in the cavity, in radii of the cranium.
const STEP: f32 = 0.5;
/// Number of steps of viewpoints from the centre: sideways, up, down.
const STEPS: (i32, i32, i32) = (5, 2, 7);
/// If a viewpoint sees a wall in fewer than this many of 26 directions, the cavity is open there.
const CLOSED: usize = 20;
/// Walls farther than this from a viewpoint, in radii, are left to nearer ones.
const SIGHT: f32 = 2.0;
/// Number of viewpoints, the nearest ones that face a wall, that look for it.
const EYES: usize = 8;
/// Triangles examined between two calls of `check`.
const BETWEEN: usize = 256;
/// Extent of a head, in radii.
const FAR: f32 = 6.0;
/// How often visibility across the cavity is propagated.
const ACROSS: usize = 3;

/// For each triangle, whether it belongs to the inner wall of a head with a cranium of this centre and radius, cm;
/// `None` without such a wall. `check` is called now and then and may stop the work.
pub(crate) fn inner_wall(
    surface: &Surface,
    middle: Vec3,
    radius: f32,
    check: impl Fn() -> Result<(), NodeError>,
) -> Result<Option<Vec<bool>>, NodeError> {
    // Whether the crown shows its front: from the centre of a solid head, every surface shows its back.
    let mut facing = 0i32;
    for way in round_about().filter(|way| way.y >= 0.0) {
        if let Some(hit) = surface.ray(middle, way, FAR * radius) {
            facing += if surface.face_normal(hit.triangle).dot(way) < 0.0 { 1 } else { -1 };
        }
    }
    if facing <= 0 || !closed(surface, middle, radius) {
        return Ok(None);
    }
    let from = places(surface, middle, radius, &check)?;
    let mut faces: Vec<(u32, Vec3, Vec3)> = (0..surface.triangles.len() as u32)
        .filter_map(|t| {
            let normal = surface.area_vector(t).try_normalize()?;
            let [a, b, c] = surface.corners(t);
            Some((t, (a + b + c) / 3.0, normal))
        })
        .filter(|(_, at, _)| at.distance(middle) < FAR * radius)
        .collect();
    // Neighbours in sequence, so that what was visited for one is cached for the next.
    faces.sort_by_cached_key(|(_, at, _)| {
        let cell = ((*at - middle) / (FAR * radius) + 1.0) * 511.0;
        hilbert(cell.to_array().map(|along| along as u32))
    });
    let mut wall = vec![false; surface.triangles.len()];
    let mut eyes: Vec<(f32, Vec3, usize)> = vec![];
    let mut hides: Vec<Option<u32>> = vec![None; from.len()];
    for (i, (t, at, normal)) in faces.iter().enumerate() {
        if i % BETWEEN == 0 {
            check()?;
        }
        eyes.clear();
        let ways = from.iter().enumerate().map(|(i, eye)| (*at - *eye, i));
        let facing = ways.filter(|(way, _)| normal.dot(*way) < 0.0);
        eyes.extend(facing.map(|(way, i)| (way.length(), way, i)));
        eyes.retain(|(far, ..)| *far < SIGHT * radius);
        eyes.sort_by(|a, b| a.0.total_cmp(&b.0));
        wall[*t as usize] = eyes
            .iter()
            .take(EYES)
            .any(|(_, way, eye)| surface.ray_sees(*at - *way, *way, 1.001, *t, &mut hides[*eye]));
    }
    let mut across: Vec<(u32, u32)> = vec![];
    for (i, (t, at, normal)) in faces.iter().enumerate() {
        if i % BETWEEN == 0 {
            check()?;
        }
        if wall[*t as usize] {
            continue;
        }
        let hit = surface.ray(*at + *normal * (1e-4 * radius), *normal, FAR * radius);
        let faces = |hit: &Hit| surface.area_vector(hit.triangle).dot(*normal) < 0.0;
        across.extend(hit.filter(faces).map(|hit| (*t, hit.triangle)));
    }
    for _ in 0..ACROSS {
        let is_more = |(t, hit): &&(u32, u32)| !wall[*t as usize] && wall[*hit as usize];
        let more: Vec<u32> = across.iter().filter(is_more).map(|(t, _)| *t).collect();
        if more.is_empty() {
            break;
        }
        more.into_iter().for_each(|t| wall[t as usize] = true);
    }
    Ok(Some(wall))
}

/// Whether a viewpoint sees a wall nearly all around it.
fn closed(surface: &Surface, at: Vec3, radius: f32) -> bool {
    let sees = |way: &Vec3| surface.ray_meets(at, *way, FAR * radius);
    round_about().filter(sees).count() >= CLOSED
}

/// Viewpoints in the cavity around `middle`, each visible from an earlier one.
fn places(
    surface: &Surface,
    middle: Vec3,
    radius: f32,
    check: &impl Fn() -> Result<(), NodeError>,
) -> Result<Vec<Vec3>, NodeError> {
    let at = |place: [i32; 3]| middle + Vec3::from_array(place.map(|k| k as f32)) * (STEP * radius);
    let (sides, up, down) = STEPS;
    let mut found = vec![[0i32; 3]];
    let mut k = 0;
    while k < found.len() {
        check()?;
        let here = found[k];
        for (axis, by) in [(0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1)] {
            let mut next = here;
            next[axis] += by;
            let [x, y, z] = next;
            let far = x.abs() > sides || z.abs() > sides || !(-down..=up).contains(&y);
            if far || found.contains(&next) {
                continue;
            }
            let free = !surface.ray_meets(at(here), at(next) - at(here), 1.0);
            if free && closed(surface, at(next), radius) {
                found.push(next);
            }
        }
        k += 1;
    }
    Ok(found.into_iter().map(at).collect())
}

/// Position of a cell on a Hilbert curve through 1024^3 cells (Skilling 2004, "Programming the Hilbert curve").
fn hilbert(mut cell: [u32; 3]) -> u32 {
    const BITS: u32 = 10;
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        let low = q - 1;
        for axis in 0..3 {
            if cell[axis] & q != 0 {
                cell[0] ^= low;
            } else {
                let t = (cell[0] ^ cell[axis]) & low;
                cell[0] ^= t;
                cell[axis] ^= t;
            }
        }
        q >>= 1;
    }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let mut t = 0;
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        if cell[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let [x, y, z] = cell.map(|c| c ^ t);
    (0..BITS)
        .rev()
        .fold(0, |key, bit| key << 3 | (x >> bit & 1) << 2 | (y >> bit & 1) << 1 | z >> bit & 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::ball;

    /// A ball of 9 cm with an inner wall of 8.6 cm, whose triangles come last.
    fn shell() -> Surface {
        let outer = ball();
        let (points, triangles) = (&outer.surface().points, &outer.surface().triangles);
        let middle = outer.frame().origin;
        let n = points.len() as u32;
        let smaller = points.iter().map(|p| middle + (*p - middle) * 0.95);
        let turned = triangles.iter().map(|[a, b, c]| [a + n, c + n, b + n]);
        Surface::new(
            points.iter().copied().chain(smaller).collect(),
            triangles.iter().copied().chain(turned).collect(),
        )
    }

    fn found(surface: &Surface) -> Option<Vec<bool>> {
        let (lo, hi) = surface.bounds();
        inner_wall(surface, (lo + hi) * 0.5, 0.5 * (hi.y - lo.y), || Ok(())).unwrap()
    }

    #[test]
    fn the_inner_wall_of_a_shell_is_found_whole_and_of_a_solid_none() {
        assert!(found(ball().surface()).is_none());
        let shell = shell();
        let wall = found(&shell).unwrap();
        let half = wall.len() / 2;
        assert!(wall[..half].iter().all(|wall| !wall));
        assert!(wall[half..].iter().all(|wall| *wall));
    }

    #[test]
    fn a_middle_outside_a_solid_head_makes_it_no_hollow_one() {
        let ball = ball();
        let (lo, hi) = ball.surface().bounds();
        let radius = 0.5 * (hi.y - lo.y);
        for off in [Vec3::Z, Vec3::X, Vec3::new(0.5, -0.2, 1.0)] {
            let middle = (lo + hi) * 0.5 + off * (1.5 * radius);
            assert!(inner_wall(ball.surface(), middle, radius, || Ok(())).unwrap().is_none());
        }
    }

    #[test]
    fn hair_grows_on_a_shell_as_on_a_solid_once_its_inner_wall_is_gone() {
        use crate::scalp::hairline::default_region;
        let ball = ball();
        let shell = shell();
        let wall = found(&shell).unwrap();
        let hollow = shell.without(&wall);
        let region = |surface: &Surface| {
            default_region(surface, ball.frame(), 0.5, &[], &|| Ok(())).unwrap()
        };
        let (solid, hollow) = (region(ball.surface()), region(&hollow));
        assert!(solid.iter().any(|grows| *grows > 0.9));
        assert_eq!(hollow[..solid.len()], solid[..]);
    }

    #[test]
    fn without_its_inner_wall_a_shell_is_solid() {
        let shell = shell();
        let wall = found(&shell).unwrap();
        let (lo, hi) = shell.bounds();
        let (middle, radius) = ((lo + hi) * 0.5, 0.5 * (hi.y - lo.y));
        let depth = |surface: &Surface, at: f32| {
            let p = middle + Vec3::new(0.3, 0.8, 0.5).normalize() * radius * at;
            surface.signed_distance(p, &surface.closest(p).unwrap()) / radius
        };
        assert!(depth(&shell, 0.8) > 0.1, "the hollow of a shell is outside");
        let solid = shell.without(&wall);
        assert!((depth(&solid, 0.8) + 0.2).abs() < 0.02, "{}", depth(&solid, 0.8));
        assert!((depth(&solid, 1.1) - 0.1).abs() < 0.02);
        assert_eq!(solid.triangles.len(), wall.len(), "triangles keep their numbers");
    }
}
