//! Strands that end on a plane: a cluster that was cut on a bias has its bias.
//!
//! A cut ends the cluster's curve in a plane (`sketch/cut.rs`); strands beside the curve reach it sooner or later than that. Each
//! is cut there, or goes on straight to it.
//!
//! Guarantees: the root and the number of points stay; a strand ends on the plane to 0.001 cm, but where it would have to grow by
//! more than three radii. Points lie evenly along what is left.

use crate::maths::spline::Spline;
use glam::Vec3;

/// By how many radii a strand grows at most.
const FARTHEST: f32 = 3.0;
/// The cosine to the plane's normal from which on a strand runs along the plane rather than to it.
const ALONG: f32 = 0.15;

/// Ends a strand in the plane through `tip` across `normal` (unit, out of the hair).
pub(super) fn end_on_plane(strand: &mut [Vec3], tip: Vec3, normal: Vec3, radius: f32) {
    let over = |p: Vec3| (p - tip).dot(normal);
    let last = strand.len() - 1;
    let end = strand[last];
    let mut line = strand.to_vec();
    if over(end) <= 0.0 {
        let way = (end - strand[last - 1]).normalize_or_zero();
        let slope = way.dot(normal);
        let more = -over(end) / slope;
        if !(slope > ALONG && more <= FARTHEST * radius) {
            return;
        }
        line[last] = end + way * more;
    } else {
        let Some(k) = (0..last).rev().find(|k| over(strand[*k]) <= 0.0) else { return };
        let (a, b) = (over(strand[k]), over(strand[k + 1]));
        line.truncate(k + 1);
        line.push(strand[k].lerp(strand[k + 1], a / (a - b)));
    }
    if let Ok(spline) = Spline::new(&line) {
        let mut points = strand.iter_mut();
        spline.resample(last + 1, |p| {
            if let Some(point) = points.next() {
                *point = p;
            }
        });
        strand[last] = line[line.len() - 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strand_is_cut_at_the_plane_or_goes_on_to_it() {
        let straight =
            |length: f32| (0..16).map(|k| Vec3::Y * (length * k as f32 / 15.0)).collect();
        // A plane through y = 8 that leans by 45 degrees.
        let (tip, normal) = (Vec3::Y * 8.0, Vec3::new(1.0, 1.0, 0.0).normalize());
        for (x, length, end) in
            [(0.5, 10.0, 7.5), (0.0, 8.0, 8.0), (-0.5, 8.0, 8.5), (0.3, 7.0, 7.7)]
        {
            let mut strand: Vec<Vec3> = straight(length);
            strand.iter_mut().for_each(|p| p.x = x);
            end_on_plane(&mut strand, tip, normal, 1.0);
            assert!((strand[15].y - end).abs() < 1e-3, "{x} {length}: {}", strand[15]);
            assert_eq!(strand[0], Vec3::X * x);
            for pair in strand.windows(2) {
                assert!((pair[0].distance(pair[1]) - end / 15.0).abs() < 1e-3);
            }
        }
        // Farther than three radii, or along the plane, it stays as it is.
        for (length, normal) in [(3.0, normal), (6.0, Vec3::X)] {
            let mut strand: Vec<Vec3> = straight(length);
            end_on_plane(&mut strand, tip - Vec3::X * 0.1, normal, 1.0);
            let _ = &strand;
            assert!(strand[15].y <= length, "{}", strand[15]);
        }
    }
}
