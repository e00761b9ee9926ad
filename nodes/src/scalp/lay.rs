//! Laying lines on the scalp: shared by drawn strokes, projected curves and hair pulled from partings.

use crate::data::attributes::{Domain, ROOT_BARY, ROOT_TRIANGLE, ROOT_UV};
use crate::data::curves::TuftBuilder;
use crate::data::scalp::{Root, Scalp};
use glam::Vec3;

/// Binds the curves of a tuft, in order, to these roots.
pub(crate) fn bind(tuft: &mut TuftBuilder, roots: &[Root]) {
    if roots.is_empty() {
        return;
    }
    let triangles = roots.iter().map(|r| r.triangle as i32).collect();
    tuft.set(ROOT_TRIANGLE, Domain::Curve, triangles);
    tuft.set(ROOT_BARY, Domain::Curve, roots.iter().map(|r| r.bary).collect());
    tuft.set(ROOT_UV, Domain::Curve, roots.iter().map(|r| r.uv).collect());
}

/// The point at `height` (cm) above the scalp's closest point to `p`, and the smooth normal there; `p` itself without a
/// scalp.
pub(crate) fn laid(scalp: &Scalp, p: Vec3, height: f32) -> (Vec3, Vec3) {
    match scalp.closest_root(p) {
        Some(root) => (root.point + root.normal * height, root.normal),
        None => (p, Vec3::ZERO),
    }
}

/// Where a pen at `p` touches the scalp: the closest point, or scalp that overhangs it as seen from outside the head,
/// such as the modeled locks of a scan. Nothing is drawn below such a lock. Ears, where no hair grows, do not count as
/// overhangs.
pub(crate) fn met(scalp: &Scalp, p: Vec3) -> Option<Root> {
    let mut root = scalp.closest_root(p)?;
    let frame = scalp.frame();
    let Some(up) = (root.point - frame.point_from_head(Vec3::ZERO)).try_normalize() else {
        return Some(root);
    };
    let surface = scalp.surface();
    let (below, mut come) = (root.point, 0.0);
    for _ in 0..LAYERS {
        let left = OVERHANG * frame.unit() - come;
        let Some(hit) = surface.ray(below + up * (come + PAST), up, left) else { break };
        come += PAST + hit.distance;
        let grows = scalp.grows(hit.triangle, hit.bary) > 0.0;
        if grows && surface.face_normal(hit.triangle).dot(up) > 0.0 {
            root = scalp.root(hit.triangle, hit.bary);
        }
    }
    Some(root)
}

/// Distance out from the scalp within which overhangs are searched, cm on a head of average size: anything farther is
/// not a lock.
const OVERHANG: f32 = 1.5;
/// The most layers searched.
const LAYERS: usize = 8;
/// Anything closer than this (cm) is the layer itself.
const PAST: f32 = 1e-3;

/// The smooth scalp normal nearest to each point.
pub(crate) fn scalp_normals(scalp: &Scalp, points: &[Vec3]) -> Vec<Vec3> {
    points.iter().map(|p| laid(scalp, *p, 0.0).1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pen_meets_the_lock_that_overhangs_and_no_ear() {
        use crate::data::scalp::{HeadFrame, REGION};
        use crate::maths::closest::Surface;
        use crate::maths::closest::tests::sphere;
        // A plate 0.6 cm over the crown of a ball, seen from above.
        let ball = sphere(9.0, 48);
        let n = ball.points.len() as u32;
        let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
        let plate = corners.map(|(x, z)| Vec3::new(x, 9.6, z));
        let points: Vec<Vec3> = ball.points.iter().copied().chain(plate).collect();
        let faces = [[n, n + 2, n + 1], [n, n + 3, n + 2]];
        let triangles: Vec<_> = ball.triangles.iter().copied().chain(faces).collect();
        let met_at = |hair_on_it: f32, p: Vec3| {
            let region = (0..n + 4).map(|v| if v < n { 1.0 } else { hair_on_it }).collect();
            let surface = Surface::new(points.clone(), triangles.clone());
            let frame = HeadFrame { radius: 9.0, ..HeadFrame::IDENTITY };
            let scalp = Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into());
            met(&scalp, p).unwrap().point
        };
        let under = Vec3::new(0.3, 9.1, 0.2);
        assert!((met_at(1.0, under).y - 9.6).abs() < 1e-4);
        assert!((met_at(0.0, under).length() - 9.0).abs() < 0.05);
        let beside = Vec3::new(4.0, 8.1, 0.0);
        assert!((met_at(1.0, beside).length() - 9.0).abs() < 0.05);
    }
}
