//! A line on the skin, mirrored to the other side of the head.
//!
//! No head is the same on both sides, and the face of a scan is seldom straight in its head frame: mirrored in the plane of the frame, a
//! line lies in the air there, or on the eye. So the mirrored skin about the line is laid onto the skin by turning and shifting it
//! (iterative closest points, from point to plane: Chen and Medioni, Image and Vision Computing 10, 1992), and the line goes along.
//!
//! Guarantees: where the skin is the same on both sides, the line is only mirrored; at the midline both meet; mirrored skin lies nearer to
//! the skin by what is done than it did. Not promised: anything for sides that differ by more than [`MOST_TURN`] and [`MOST_SHIFT`].

use crate::data::scalp::HeadFrame;
use crate::define::NodeError;
use crate::maths::closest::Surface;
use crate::maths::smoothstep;
use glam::{DQuat, DVec3, Vec3};

/// A mirrored line is laid where the mirrored skin about it is farther from the skin than this in the mean, head units.
const MISSES: f32 = 0.05;
/// Skin is compared within this distance of the line (head units), by at most this many of its vertices.
const ABOUT: f32 = 2.5;
const MOST: usize = 1500;
/// Mirrored skin is compared with skin at most this far away (head units) whose direction is within this cosine.
const FAR: f32 = 1.2;
const ALIKE: f64 = 0.6;
/// Rounds, and the step (radians, head units) that ends them.
const ROUNDS: usize = 16;
const STEP: f64 = 1e-4;
/// Share of the mean square that holds back directions that nothing is known of.
const STIFF: f64 = 1e-3;
/// The largest turn (radians) and shift (head units) that are taken.
const MOST_TURN: f64 = 0.2;
const MOST_SHIFT: f64 = 2.0;
/// From the midline to this distance, the line goes along more and more, head units.
const MIDDLE: f32 = 1.0;

/// The line through points (cm), mirrored and laid onto the skin; `None` where it is only mirrored.
pub(super) fn laid(
    surface: &Surface,
    frame: &HeadFrame,
    line: &[Vec3],
    check: &dyn Fn() -> Result<(), NodeError>,
) -> Result<Option<Vec<Vec3>>, NodeError> {
    let (unit, right) = (frame.unit(), frame.right);
    let flipped = |v: Vec3| v - right * (2.0 * v.dot(right));
    let mirror = |p: Vec3| frame.origin + flipped(p - frame.origin);
    let near = |p: &Vec3| line.iter().any(|at| at.distance(*p) < ABOUT * unit);
    let about: Vec<usize> =
        (0..surface.points.len()).filter(|v| near(&surface.points[*v])).collect();
    let skin: Vec<[DVec3; 2]> = about
        .iter()
        .step_by(about.len().div_ceil(MOST).max(1))
        .map(|v| [mirror(surface.points[*v]), flipped(surface.normals[*v].normalize_or_zero())])
        .map(|both| both.map(Vec3::as_dvec3))
        .collect();
    let middle = skin.iter().map(|[p, _]| *p).sum::<DVec3>() / skin.len().max(1) as f64;
    let (mut turn, mut shift) = (DQuat::IDENTITY, DVec3::ZERO);
    let laid =
        |p: DVec3, turn: DQuat, shift: DVec3| (middle + turn * (p - middle) + shift).as_vec3();
    // How far mirrored skin is from the skin in the mean; what is too far to be compared counts as just that far.
    let off = |turn, shift| {
        let far = skin.iter().filter_map(|[p, _]| surface.closest(laid(*p, turn, shift)));
        far.map(|hit| hit.distance.min(FAR * unit)).sum::<f32>() / skin.len().max(1) as f32
    };
    let before = off(turn, shift);
    if before <= MISSES * unit {
        return Ok(None);
    }
    for _ in 0..ROUNDS {
        check()?;
        // The turn and the shift that bring mirrored skin nearest to the planes of the skin that it is nearest to.
        let mut sums = [[0.0f64; 7]; 6];
        for [p, normal] in &skin {
            let arm = turn * (*p - middle);
            let at = middle + arm + shift;
            let Some(hit) = surface.closest(at.as_vec3()) else { continue };
            let plane = surface.face_normal(hit.triangle).as_dvec3();
            if hit.distance > FAR * unit || (turn * *normal).dot(plane) < ALIKE {
                continue;
            }
            let (way, miss) = (arm.cross(plane), (hit.point.as_dvec3() - at).dot(plane));
            let row = [way.x, way.y, way.z, plane.x, plane.y, plane.z, miss];
            for (sums, a) in sums.iter_mut().zip(row) {
                sums.iter_mut().zip(row).for_each(|(sum, b)| *sum += a * b);
            }
        }
        let stiff = (0..6).map(|k| sums[k][k]).sum::<f64>() / 6.0 * STIFF;
        (0..6).for_each(|k| sums[k][k] += stiff);
        let Some([x, y, z, u, v, w]) = solved(sums) else { return Ok(None) };
        turn = (DQuat::from_xyzw(0.5 * x, 0.5 * y, 0.5 * z, 1.0).normalize() * turn).normalize();
        shift += DVec3::new(u, v, w);
        let step = DVec3::new(x, y, z).length().max(DVec3::new(u, v, w).length());
        if step < STEP * f64::from(unit) {
            break;
        }
    }
    // The imaginary part of a small turn is half of it.
    let turned = 2.0 * turn.xyz().length();
    if !(turned <= MOST_TURN && shift.length() <= MOST_SHIFT * f64::from(unit)) {
        return Ok(None);
    }
    if off(turn, shift) >= before {
        return Ok(None);
    }
    let moved = line.iter().map(|from| {
        let p = mirror(*from);
        let aside = (*from - frame.origin).dot(right).abs() / unit;
        p.lerp(laid(p.as_dvec3(), turn, shift), smoothstep(aside / MIDDLE))
    });
    Ok(Some(moved.collect()))
}

/// Solves six linear equations, each row ending in its right-hand side; `None` if they are singular.
fn solved(mut rows: [[f64; 7]; 6]) -> Option<[f64; 6]> {
    for k in 0..6 {
        let pivot = (k..6).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
        rows.swap(k, pivot);
        let own = rows[k];
        if own[k].abs() < 1e-12 {
            return None;
        }
        for row in &mut rows[k + 1..] {
            let share = row[k] / own[k];
            row.iter_mut().zip(own).for_each(|(a, b)| *a -= share * b);
        }
    }
    let mut out = [0.0; 6];
    for k in (0..6).rev() {
        let known: f64 = (k + 1..6).map(|j| rows[k][j] * out[j]).sum();
        out[k] = (rows[k][6] - known) / rows[k][k];
    }
    out.iter().all(|x| x.is_finite()).then_some(out)
}
