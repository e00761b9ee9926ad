//! How clean the outline of puffs is: the outermost point in every direction against the sphere that the file says they lie on.
//!
//! Directions from the middle of a puff's sphere are cut into cells of equal area, 5 degrees wide. Rings of cells about the
//! axis away from the head belong to the outline as long as most of their cells are filled to the sphere; one ring
//! further in, nearly all must be.

use super::prim::Prim;
use glam::Vec3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};

#[derive(Serialize)]
pub(super) struct Puffs {
    pub(super) puffs: usize,
    pub(super) hairs: usize,
    pub(super) radius_cm: [f32; 2],
    /// Degrees from the axis up to which the outline holds: the puff with the least.
    pub(super) coverage: f32,
    /// Share of cells within the coverage whose outermost point is within 3 % of the radius: the worst puff.
    pub(super) within: f32,
    /// Largest distance of the outermost point of such a cell from the sphere, as a share of its radius: 95 % of the
    /// cells have less.
    pub(super) deviation: f32,
}

/// Width of a cell, radians.
const CELL: f32 = PI / 36.0;
const RINGS: usize = 36;

pub(super) fn measure(prim: &Prim) -> Option<Puffs> {
    let puff = prim.whole("puff")?;
    let (centre, radius) = (prim.vectors("puff_centre")?, prim.numbers("puff_radius")?);
    let mut members: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for i in (0..prim.len()).filter(|i| puff[*i] != 0 && !prim.curve(*i).is_empty()) {
        if radius.at(i, prim.range(i).start) > 0.0 {
            members.entry(puff[i]).or_default().push(i);
        }
    }
    let mut out = Puffs {
        puffs: members.len(),
        hairs: members.values().map(Vec::len).sum(),
        radius_cm: [f32::MAX, 0.0],
        coverage: 180.0,
        within: 1.0,
        deviation: 0.0,
    };
    for hairs in members.values() {
        let first = prim.range(hairs[0]).start;
        let (middle, r) = (centre.at(hairs[0], first), radius.at(hairs[0], first));
        let root = hairs.iter().map(|i| prim.curve(*i)[0]).sum::<Vec3>() / hairs.len() as f32;
        let away = (middle - root).normalize_or(Vec3::Y);
        let points = hairs.iter().flat_map(|i| prim.curve(*i));
        let outline = Outline::of(points, middle, r, away);
        out.radius_cm = [out.radius_cm[0].min(r), out.radius_cm[1].max(r)];
        out.coverage = out.coverage.min(outline.coverage);
        out.within = out.within.min(outline.within);
        out.deviation = out.deviation.max(outline.deviation);
    }
    (!members.is_empty()).then_some(out)
}

struct Outline {
    coverage: f32,
    within: f32,
    deviation: f32,
}

/// How far from the sphere the outermost point of a cell may be, as a share of the radius.
const CLEAN: f32 = 0.03;

impl Outline {
    fn of<'a>(points: impl Iterator<Item = &'a Vec3>, middle: Vec3, r: f32, away: Vec3) -> Self {
        let side = away.any_orthonormal_vector();
        let other = away.cross(side);
        let in_ring = |ring: usize| {
            let circle = TAU * ((ring as f32 + 0.5) * CELL).sin();
            ((circle / CELL).round() as usize).max(1)
        };
        let starts: Vec<usize> = (0..=RINGS).map(|ring| (0..ring).map(in_ring).sum()).collect();
        let mut outermost = vec![0.0f32; starts[RINGS]];
        for p in points {
            let v = *p - middle;
            let far = v.length();
            if far == 0.0 || !far.is_finite() {
                continue;
            }
            let polar = (v.dot(away) / far).clamp(-1.0, 1.0).acos();
            let ring = ((polar / CELL) as usize).min(RINGS - 1);
            let turn = v.dot(other).atan2(v.dot(side)) / TAU + 0.5;
            let n = in_ring(ring);
            let cell = starts[ring] + ((turn * n as f32) as usize).min(n - 1);
            outermost[cell] = outermost[cell].max(far);
        }
        let off = |cell: usize| (outermost[cell] / r - 1.0).abs();
        let filled = |ring: usize| {
            let cells = starts[ring]..starts[ring + 1];
            let n = cells.len();
            2 * cells.filter(|c| outermost[*c] > (1.0 - 4.0 * CLEAN) * r).count() > n
        };
        let rings = (0..RINGS).take_while(|ring| filled(*ring)).count();
        let inside = starts[rings.saturating_sub(1)];
        let mut all: Vec<f32> = (0..inside).map(off).collect();
        all.sort_by(f32::total_cmp);
        let clean = all.iter().filter(|x| **x <= CLEAN).count();
        Self {
            coverage: rings as f32 * 5.0,
            within: if inside > 0 { clean as f32 / inside as f32 } else { 0.0 },
            deviation: super::prim::quantile(&all, 0.95),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a sphere of 5 cm up to `degrees` from its top, as far out as `far` says of each direction.
    fn sphere(degrees: f32, far: impl Fn(Vec3) -> f32) -> Vec<Vec3> {
        let n = 30_000;
        (0..n)
            .map(|k| {
                let y = 1.0 - 2.0 * (k as f32 + 0.5) / n as f32;
                let (s, c) = (k as f32 * 2.399_963_2).sin_cos();
                let flat = (1.0 - y * y).sqrt();
                Vec3::new(s * flat, y, c * flat)
            })
            .filter(|d| d.y > degrees.to_radians().cos())
            .map(|d| Vec3::ONE + d * far(d))
            .collect()
    }

    fn outline(points: &[Vec3]) -> Outline {
        Outline::of(points.iter(), Vec3::ONE, 5.0, Vec3::Y)
    }

    #[test]
    fn a_sphere_is_clean_as_far_as_it_goes() {
        let found = outline(&sphere(120.0, |_| 5.0));
        assert_eq!((found.coverage, found.within), (120.0, 1.0));
        assert!(found.deviation < 1e-4);
    }

    #[test]
    fn a_dent_and_a_bump_are_seen() {
        let dent = outline(&sphere(120.0, |d| if d.x > 0.8 { 4.7 } else { 5.0 }));
        assert!((0.8..0.95).contains(&dent.within), "{}", dent.within);
        assert!((dent.deviation - 0.06).abs() < 0.005, "{}", dent.deviation);
        let ragged =
            outline(&sphere(120.0, |d| 5.0 + 0.4 * (d.x * 40.0).sin() * (d.z * 33.0).sin()));
        assert!(ragged.within < 0.8, "{}", ragged.within);
    }

    #[test]
    fn a_bald_patch_is_seen() {
        let bald: Vec<Vec3> =
            sphere(120.0, |_| 5.0).into_iter().filter(|p| p.z - 1.0 < 4.2).collect();
        let found = outline(&bald);
        assert!(found.within < 0.96, "{}", found.within);
    }
}
