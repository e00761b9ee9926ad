//! The region where hair grows, as a mask with one value per vertex.
//!
//! methods.md 0.1: the default region is the outer surface above a plane that rises toward the face, within a shell
//! around the cranium, without the ears and some skin around them. Drawn regions are in [`super::drawn`].

use crate::data::scalp::HeadFrame;
use crate::define::NodeError;
use crate::maths::closest::Surface;
use crate::maths::nearest::KdTree;
use crate::maths::soft_edge;
use crate::maths::transcendental::sin_cos;
use glam::Vec3;

/// Plane of the default region: this far below the centre (radii) ...
const DROP: f32 = 0.30;
/// ... rising toward the front at this angle.
const RISE: f32 = 40.0 / 180.0 * std::f32::consts::PI;
/// The shell of the default region, in radii from the centre.
const SHELL: (f32, f32) = (0.8, 1.2);

/// Ears are searched this far to the side, between these heights and depths, in radii ...
const BESIDE: f32 = 0.6;
const EAR_LOW: Vec3 = Vec3::new(BESIDE, -0.8, -0.7);
const EAR_HIGH: Vec3 = Vec3::new(2.0, 0.4, 0.4);
/// ... and are thinner than this, cm on a head of average size.
const THIN: f32 = 1.2;
/// Bare skin around an ear, cm on a head of average size.
const BARE: f32 = 0.35;
/// Skin surrounded by an ear within this distance (cm on a head of average size) belongs to it: the mean of the
/// directions to the ear is shorter than this. Next to a straight edge it is 0.64.
const WITHIN: f32 = 2.0;
const SURROUNDED: f32 = 0.5;
/// The most vertices that represent both ears; on a fine scan, a subset does.
const MOST_RIMS: usize = 4000;
/// If more than this fraction of the searched surface is thin, the mesh has an interior of its own and says nothing
/// about ears.
const MOST_THIN: f32 = 0.6;

/// Distance inside the standard hairline of a point at `v` from the centre, cm; negative outside.
pub(super) fn within_hairline(frame: &HeadFrame, v: Vec3) -> f32 {
    let (sin, cos) = sin_cos(RISE);
    let p = frame.head_from_vector(v);
    let r = frame.radius;
    let over = (p.y + DROP * r) * cos - p.z * sin;
    let shell = (p.length() - SHELL.0 * r).min(SHELL.1 * r - p.length());
    over.min(shell)
}

/// The default region; `softness` (cm) is the width of its edge, `rims` are the vertices of its [`ears`].
pub(crate) fn default_region(
    surface: &Surface,
    frame: &HeadFrame,
    softness: f32,
    rims: &[Vec3],
    check: &dyn Fn() -> Result<(), NodeError>,
) -> Result<Vec<f32>, NodeError> {
    let ears = KdTree::new(rims.iter().copied());
    let within = WITHIN * frame.unit();
    let mut found = vec![];
    mask(surface, frame, check, |v| {
        let inside = within_hairline(frame, v);
        if inside <= -0.5 * softness {
            return 0.0;
        }
        let p = frame.origin + v;
        ears.find(p, 1, &mut found);
        let Some((square, _)) = found.first() else { return soft_edge(inside, softness) };
        let far = square.sqrt();
        if far < within {
            // What an ear surrounds, such as its hollow, belongs to it even if it is not thin.
            let near = rims.iter().map(|rim| *rim - p).filter(|to| to.length() < within);
            let (sum, count) = near.fold((Vec3::ZERO, 0.0f32), |(sum, count), to| {
                (sum + to.normalize_or_zero(), count + 1.0)
            });
            if sum.length() < SURROUNDED * count {
                return 0.0;
            }
        }
        soft_edge(inside.min(far - BARE * frame.unit()), softness)
    })
}

/// The vertices of both ears: the thin surface at the sides of a head.
pub(crate) fn ears(
    surface: &Surface,
    frame: &HeadFrame,
    check: &dyn Fn() -> Result<(), NodeError>,
) -> Result<Vec<Vec3>, NodeError> {
    let (thin, mut looked, mut ears) = (THIN * frame.unit(), 0usize, vec![]);
    // Seen from inside, the inner wall of a hollow head is thin everywhere.
    let mut inner = vec![false; surface.points.len()];
    let numbered = (0u32..).zip(&surface.triangles);
    let gone = numbered.filter(|(t, _)| surface.is_gone(*t)).flat_map(|(_, corners)| corners);
    gone.for_each(|v| inner[*v as usize] = true);
    for (i, (p, normal)) in surface.points.iter().zip(&surface.normals).enumerate() {
        if i % 256 == 0 {
            check()?;
        }
        let at = frame.head_from_vector(*p - frame.origin) / frame.radius;
        let at = Vec3::new(at.x.abs(), at.y, at.z);
        if inner[i] || at.cmplt(EAR_LOW).any() || at.cmpgt(EAR_HIGH).any() {
            continue;
        }
        looked += 1;
        let start = *p - *normal * (0.002 * frame.radius);
        if surface.ray_meets(start, -*normal, thin) {
            ears.push(*p);
        }
    }
    if ears.len() as f32 > MOST_THIN * looked as f32 {
        ears.clear();
    }
    let every = ears.len().div_ceil(MOST_RIMS).max(1);
    Ok(ears.into_iter().step_by(every).collect())
}

/// For each vertex, whether it is on the outer surface: 0 or 1.
pub(crate) fn outer_skin(
    surface: &Surface,
    frame: &HeadFrame,
    check: &dyn Fn() -> Result<(), NodeError>,
) -> Result<Vec<f32>, NodeError> {
    mask(surface, frame, check, |_| 1.0)
}

/// The value of `value` for the vertex at `v` from the centre, on the outer surface.
fn mask(
    surface: &Surface,
    frame: &HeadFrame,
    check: &dyn Fn() -> Result<(), NodeError>,
    mut value: impl FnMut(Vec3) -> f32,
) -> Result<Vec<f32>, NodeError> {
    let mut out = Vec::with_capacity(surface.points.len());
    let mut hides = [None; 7];
    for (i, p) in surface.points.iter().enumerate() {
        if i % 256 == 0 {
            check()?;
        }
        let x = value(*p - frame.origin);
        out.push(if x > 0.0 && outer(surface, frame, i, &mut hides) { x } else { 0.0 });
    }
    Ok(out)
}

/// Angle of the rays of [`outer`] from the radial direction.
const LEAN: f32 = 50.0 / 180.0 * std::f32::consts::PI;

/// Whether the outside is visible from a vertex: a ray straight out, or one of six tilted by 50 degrees, hits nothing.
/// Skin behind an ear is therefore outer surface; the back of an eye or a tooth is not. `hides` is what last blocked
/// each direction.
fn outer(
    surface: &Surface,
    frame: &HeadFrame,
    vertex: usize,
    hides: &mut [Option<u32>; 7],
) -> bool {
    let p = surface.points[vertex];
    let Some(out) = (p - frame.origin).try_normalize() else { return false };
    let start = p + surface.normals[vertex] * (0.005 * frame.radius);
    let side = frame.up.cross(out).try_normalize().unwrap_or(frame.right);
    let other = out.cross(side);
    let (sin, cos) = sin_cos(LEAN);
    let leaning = (0..6).map(|k| {
        let (s, c) = crate::maths::transcendental::sin_cos_turns(k as f32 / 6.0);
        out * cos + (side * c + other * s) * sin
    });
    std::iter::once(out)
        .chain(leaning)
        .zip(hides)
        .any(|(way, hides)| !surface.ray_meets_again(start, way, 8.0 * frame.radius, hides))
}
