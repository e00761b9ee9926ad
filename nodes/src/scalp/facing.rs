//! Finds the inverted triangles of a head, patch by patch.
//!
//! Files assembled from several sources have inverted parts next to correct ones. Seen from outside and above, a head
//! shows its front; a patch that shows its back is flipped. A patch is a set of triangles connected by edges of exactly
//! two triangles, with consistent winding.
//!
//! Guarantees: bounded work; nothing is flipped if everything visible shows its front, or if a patch is seen from both
//! sides, like a hair card. Not promised: parts that are hardly visible from outside stay as they are.

use crate::define::NodeError;
use crate::maths::closest::Surface;
use crate::maths::frame::round_about;
use glam::Vec3;

/// Lines of sight from each side, along both axes of a square around the head ...
const LINES: usize = 20;
/// ... that extends this far from the centre of the cranium, in radii.
const ABOUT: f32 = 2.0;
/// Less than this fraction of the visible surface may show its back, flipped or not: holes and flaws.
const FLAWS: f32 = 0.02;
/// A patch needs at least this many lines of sight, and this fraction of all ...
const FEWEST: u32 = 8;
const PART: f32 = 0.05;
/// ... with this many times more on one side than on the other.
const CLEARLY: u32 = 3;

/// For each triangle, whether to flip it, on a head with a cranium of this centre and radius, cm; `None` if none is
/// flipped. `check` is called now and then and may stop the work.
pub(crate) fn turned(
    surface: &Surface,
    middle: Vec3,
    radius: f32,
    check: impl Fn() -> Result<(), NodeError>,
) -> Result<Option<Vec<bool>>, NodeError> {
    let mut seen: Vec<(u32, bool)> = vec![];
    let (low, high) = surface.bounds();
    let far = 2.0 * (high - low).length() + middle.distance(low);
    for way in round_about().filter(|way| way.y >= 0.0) {
        check()?;
        let side = way.cross(if way.y.abs() < 0.9 { Vec3::Y } else { Vec3::X }).normalize_or_zero();
        let up = side.cross(way);
        let off = |k: usize| (2.0 * (k as f32 + 0.5) / LINES as f32 - 1.0) * ABOUT * radius;
        for k in 0..LINES * LINES {
            let from = middle + way * far + side * off(k % LINES) + up * off(k / LINES);
            let Some(hit) = surface.ray(from, -way, 2.0 * far) else { continue };
            seen.push((hit.triangle, surface.area_vector(hit.triangle).dot(way) < 0.0));
        }
    }
    let backs = seen.iter().filter(|(_, back)| *back).count();
    if backs as f32 <= FLAWS * seen.len() as f32 {
        return Ok(None);
    }
    check()?;
    let mut patches = Patches::of(&surface.triangles);
    // How often each patch shows the back and the front of its representative triangle.
    let mut shown = vec![[0u32; 2]; surface.triangles.len()];
    for (t, back) in &seen {
        let (patch, unlike) = patches.find(*t);
        shown[patch as usize][usize::from(*back == unlike)] += 1;
    }
    let least = FEWEST.max((PART * seen.len() as f32) as u32);
    let mut turn = |t: u32| {
        let (patch, unlike) = patches.find(t);
        let [back, front] = shown[patch as usize];
        match back + front >= least {
            true if back > CLEARLY * front => !unlike,
            true if front > CLEARLY * back => unlike,
            _ => false,
        }
    };
    let turned: Vec<bool> = (0..surface.triangles.len() as u32).map(&mut turn).collect();
    let mends: i32 = seen
        .iter()
        .filter(|(t, _)| turned[*t as usize])
        .map(|(_, back)| if *back { 1 } else { -1 })
        .sum();
    Ok((mends as f32 > FLAWS * seen.len() as f32).then_some(turned))
}

/// Triangles connected by edges of exactly two; each links to another one of its patch, with whether their windings
/// differ.
struct Patches(Vec<(u32, bool)>);

impl Patches {
    fn of(triangles: &[[u32; 3]]) -> Self {
        // Each edge, whether its triangle traverses it upward, and that triangle.
        let mut sides: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(3 * triangles.len());
        for (t, [a, b, c]) in (0u32..).zip(triangles) {
            for (a, b) in [(*a, *b), (*b, *c), (*c, *a)] {
                sides.push((a.min(b), a.max(b), t, a < b));
            }
        }
        sides.sort_unstable();
        let mut patches = Self((0..triangles.len() as u32).map(|t| (t, false)).collect());
        for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let [(.., one, goes), (.., other, comes)] = same else { continue };
            let ((one, a), (other, b)) = (patches.find(*one), patches.find(*other));
            let (low, high) = (one.min(other), one.max(other));
            if low != high {
                patches.0[high as usize] = (low, a ^ b ^ (goes == comes));
            }
        }
        patches
    }

    /// The representative triangle of a patch, and whether this one's winding differs from it.
    fn find(&mut self, t: u32) -> (u32, bool) {
        let (mut at, mut unlike) = (t, false);
        while self.0[at as usize].0 != at {
            let (next, differs) = self.0[at as usize];
            // Path halving.
            let (after, differs_too) = self.0[next as usize];
            self.0[at as usize] = (after, differs ^ differs_too);
            unlike ^= differs ^ differs_too;
            at = after;
        }
        (at, unlike)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::scalp::tests::ball;

    /// What is flipped on a ball whose triangles were inverted where `flips` says so, next to an unchanged ball.
    fn found(flips: impl Fn(usize, usize) -> bool) -> (Option<Vec<bool>>, usize) {
        let ball = ball();
        let (points, triangles) = (&ball.surface().points, &ball.surface().triangles);
        let n = points.len() as u32;
        let count = triangles.len();
        let mut all = triangles.clone();
        all.iter_mut()
            .enumerate()
            .filter(|(t, _)| flips(*t, count))
            .for_each(|(_, t)| t.swap(1, 2));
        all.extend(triangles.iter().map(|t| t.map(|v| v + n)));
        let beside = points.iter().map(|p| *p + Vec3::X * 25.0);
        let surface = Surface::new(points.iter().copied().chain(beside).collect(), all);
        let frame = ball.frame();
        (turned(&surface, frame.origin, frame.radius, || Ok(())).unwrap(), count)
    }

    #[test]
    fn what_shows_its_back_is_turned_and_nothing_else() {
        // None, all of one ball, half of it, and every seventh of its triangles.
        let (none, _) = found(|_, _| false);
        assert!(none.is_none());
        let cases: [fn(usize, usize) -> bool; 3] =
            [|_, _| true, |t, count| 2 * t < count, |t, _| t % 7 == 0];
        for flips in cases {
            let (turned, count) = found(flips);
            let turned = turned.unwrap();
            assert!(
                turned
                    .iter()
                    .enumerate()
                    .all(|(t, turned)| *turned == (t < count && flips(t, count)))
            );
        }
    }
}
