//! The map that transfers a groom from its home head to another head: smooth, and exact at landmarks.
//!
//! Displacements at landmarks are interpolated by radial basis functions plus an affine part. The basis is Hardy's
//! multiquadric (J. Geophys. Res. 76, 1971; conditionally positive definite of order 1: Micchelli, Constr. Approx. 2,
//! 1986), a biharmonic spline with rounded cones. The affine part has a small weight, so that few or coplanar landmarks
//! do not rotate or stretch directions they say nothing about. Both sides are in head units of each head's own frame.
//! Each pair of heads has one map, built from the head whose landmarks lie farther out; the other direction is its
//! inverse, so that a groom transferred there and back is unchanged.
//!
//! Guarantees: landmarks meet to 1e-5; smooth everywhere; an affine change of landmarks is reproduced (to 1e-4 of it).
//! Everywhere around the cranium the map keeps orientation, shrinks no length below [`LEAST`] and moves nothing farther
//! than two radii; otherwise less of it is applied ([`Carry::part`]). Never NaN. Not promised: anything beyond the
//! affine part far from the head, where hair hangs.

use super::landmarks::{Landmark, Landmarks};
use super::scalp::HEAD_RADIUS;
use crate::maths::hash::KeyBuilder;
use crate::maths::transcendental::sin_cos_turns;
use glam::{DMat3, DVec3, Vec3};

/// Radius (in cranium radii) within which a landmark's basis function is rounded: about half the distance to the next
/// landmark.
const ROUND: f64 = 0.45;
/// Weight of the affine part: directions in which landmarks are planar to a hundredth of the radius count half.
const STIFF: f64 = 1e-4;
/// Landmarks closer together than this (head units) count as one.
const NEAR: f32 = 0.2;
/// No length shrinks below this fraction of itself, or grows beyond its inverse.
pub const LEAST: f64 = 0.2;
/// Nothing around the cranium moves farther than this, in radii.
const FARTHEST: f64 = 2.0;
/// Number of steps from the whole map down to none.
const STEPS: u32 = 50;
/// The map is checked in this many directions from the centre, at these distances (radii) ...
const LOOKS: u32 = 600;
const SHELLS: [f64; 3] = [0.75, 1.05, 1.4];
/// ... but no farther below the centre than this, where there are necks and no hair.
const LOW: f64 = -1.2;
/// Tolerance of the inverse (radii), within the allowed number of steps.
const FOUND: f64 = 1e-9;
const MOST_STEPS: usize = 40;

/// A map from one head's units to another's.
#[derive(Clone, Debug, PartialEq)]
pub struct Carry {
    /// Landmarks of the home head, in radii, each with the weight of its basis function.
    marks: Vec<(DVec3, DVec3)>,
    shift: DVec3,
    slope: DMat3,
    part: f64,
    /// The stored map leads from this head to the home head; it is applied inverted.
    turned: bool,
}

/// What there is to report about a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapReport {
    /// Landmarks that both heads have and the map uses.
    pub met: Vec<Landmark>,
    /// Landmarks left out because they coincide with another one.
    pub left_out: Vec<Landmark>,
    /// The landmark missed by the most, and by how much in head units: 0 if the whole map is applied.
    pub missed: Option<(Landmark, f32)>,
}

impl Carry {
    /// The map that takes the landmarks of `home` to those of `here`; `None` if both are equal or have none in common,
    /// or if no part of the map is sound. Also what there is to report.
    pub fn between(home: &Landmarks, here: &Landmarks) -> (Option<Self>, MapReport) {
        let mut told = MapReport::default();
        if home.same(here) {
            return (None, told);
        }
        let mut pairs: Vec<(DVec3, DVec3)> = vec![];
        for (mark, from) in home.each() {
            let Some(to) = here.get(mark) else { continue };
            if told.met.iter().any(|one| home.get(*one).is_some_and(|p| p.distance(from) < NEAR)) {
                told.left_out.push(mark);
                continue;
            }
            told.met.push(mark);
            pairs.push((radii(from), radii(to)));
        }
        let wide = |far: &dyn Fn(&(DVec3, DVec3)) -> DVec3| -> f64 {
            pairs.iter().map(|pair| far(pair).length_squared()).sum()
        };
        let turned = wide(&|pair| pair.1) > wide(&|pair| pair.0);
        if turned {
            pairs.iter_mut().for_each(|(from, to)| std::mem::swap(from, to));
        }
        let Some(mut map) = Self::through(&pairs) else { return (None, told) };
        map.turned = turned;
        let whole = (0..STEPS).map(|k| 1.0 - f64::from(k) / f64::from(STEPS));
        let sound = whole.into_iter().find(|part| {
            map.part = *part;
            !map.folds()
        });
        map.part = sound.unwrap_or(0.0);
        if map.part < 1.0 {
            let missed = told.met.iter().zip(&pairs).map(|(mark, (from, to))| {
                (*mark, (map.moved(*from).distance(*to) * f64::from(HEAD_RADIUS)) as f32)
            });
            told.missed = missed.max_by(|a, b| a.1.total_cmp(&b.1));
        }
        (sound.map(|_| map), told)
    }

    /// Interpolates these pairs (from, to), in radii; `None` if there are none.
    fn through(pairs: &[(DVec3, DVec3)]) -> Option<Self> {
        let n = pairs.len();
        if n == 0 {
            return None;
        }
        let affine = |p: DVec3| [1.0, p.x, p.y, p.z];
        let mut rows: Vec<Vec<f64>> = vec![];
        for (from, to) in pairs {
            let mut row: Vec<f64> = pairs.iter().map(|(other, _)| round(*from - *other)).collect();
            row.extend(affine(*from));
            row.extend((*to - *from).to_array());
            rows.push(row);
        }
        for k in 0..4 {
            let mut row: Vec<f64> = pairs.iter().map(|(from, _)| affine(*from)[k]).collect();
            row.extend((0..4).map(|j| if j == k { -STIFF } else { 0.0 }));
            row.extend([0.0; 3]);
            rows.push(row);
        }
        let solved = solve(rows)?;
        let at = |i: usize| DVec3::from(solved[i]);
        let map = Self {
            marks: (0..n).map(|i| (pairs[i].0, at(i))).collect(),
            shift: at(n),
            slope: DMat3::from_cols(at(n + 1), at(n + 2), at(n + 3)),
            part: 1.0,
            turned: false,
        };
        let sound = |v: &DVec3| v.is_finite();
        let is_finite = map.marks.iter().all(|(_, weight)| sound(weight));
        (is_finite && sound(&map.shift) && map.slope.is_finite()).then_some(map)
    }

    /// How much of the map is applied, 0 to 1: less than 1 only where the whole map would fold.
    pub fn part(&self) -> f32 {
        self.part as f32
    }

    /// The position on this head of a position on the home head; both in head units.
    pub fn at(&self, p: Vec3) -> Vec3 {
        self.walked(p, self.turned)
    }

    /// The inverse of [`Self::at`]: the position on the home head of a position on this head.
    pub fn back(&self, q: Vec3) -> Vec3 {
        self.walked(q, !self.turned)
    }

    fn walked(&self, p: Vec3, back: bool) -> Vec3 {
        match (p.is_finite(), back) {
            (false, _) => p,
            (true, false) => units(self.moved(radii(p))),
            (true, true) => units(self.found(radii(p))),
        }
    }

    /// The inverse of [`Self::moved`].
    fn found(&self, to: DVec3) -> DVec3 {
        let mut p = to - (self.moved(to) - to);
        let mut off = self.moved(p) - to;
        for _ in 0..MOST_STEPS {
            if off.length() < FOUND {
                break;
            }
            let slope = self.slopes(p);
            let step = if slope.determinant() > 1e-6 { slope.inverse() * off } else { off };
            let tries = (0..10).map(|k| p - step / f64::from(1u32 << k));
            let better = tries.map(|next| (next, self.moved(next) - to));
            let Some(next) = better.into_iter().find(|(_, left)| left.length() < off.length())
            else {
                break;
            };
            (p, off) = next;
        }
        p
    }

    /// Singular values of the map at a position on the home head, smallest first: how much it stretches. The first is
    /// negative where the map turns inside out.
    pub fn stretch(&self, p: Vec3) -> [f32; 3] {
        let all = match self.turned {
            false => stretches(self.slopes(radii(p))),
            true => {
                let [a, b, c] = stretches(self.slopes(self.found(radii(p))));
                let parts = [1.0 / c, 1.0 / b, 1.0 / a.abs().max(1e-9)];
                [if a < 0.0 { -parts[0] } else { parts[0] }, parts[1], parts[2]]
            }
        };
        all.map(|x| x as f32)
    }

    /// Adds the map to a key.
    pub(crate) fn add_to(&self, key: KeyBuilder) -> KeyBuilder {
        let ends = [self.shift, self.slope.x_axis, self.slope.y_axis, self.slope.z_axis];
        let all = self.marks.iter().flat_map(|(at, weight)| [*at, *weight]).chain(ends);
        let numbers =
            all.flat_map(|v| v.to_array()).chain([self.part, f64::from(u8::from(self.turned))]);
        numbers.fold(key, |key, number| key.int(number.to_bits()))
    }

    fn moved(&self, p: DVec3) -> DVec3 {
        let sum = self.shift + self.slope * p;
        let sum = self.marks.iter().fold(sum, |sum, (at, weight)| sum + *weight * round(p - *at));
        p + sum * self.part
    }

    /// The derivative of [`Self::moved`].
    fn slopes(&self, p: DVec3) -> DMat3 {
        let sum = self.marks.iter().fold(self.slope, |sum, (at, weight)| {
            let off = p - *at;
            let way = off / round(off);
            sum + DMat3::from_cols(*weight * way.x, *weight * way.y, *weight * way.z)
        });
        DMat3::IDENTITY + sum * self.part
    }

    /// Whether the map folds, nearly folds, or moves too far, anywhere around the cranium.
    fn folds(&self) -> bool {
        let directions = (0..LOOKS).map(|k| {
            let up = 1.0 - (2 * k + 1) as f32 / LOOKS as f32;
            let (sin, cos) = sin_cos_turns(k as f32 * 0.381_966);
            let out = (1.0 - up * up).max(0.0).sqrt();
            DVec3::new(f64::from(out * sin), f64::from(up), f64::from(out * cos))
        });
        let places = directions.flat_map(|way| SHELLS.map(|far| way * far));
        let mut places = places.filter(|p| p.y > LOW).chain(self.marks.iter().map(|mark| mark.0));
        // Written so that NaN counts as folding.
        let is_sound = |p: DVec3| {
            let [least, _, most] = stretches(self.slopes(p));
            least >= LEAST && most <= 1.0 / LEAST && self.moved(p).distance(p) <= FARTHEST
        };
        places.any(|p| !is_sound(p))
    }
}

fn radii(p: Vec3) -> DVec3 {
    p.as_dvec3() / f64::from(HEAD_RADIUS)
}

fn units(p: DVec3) -> Vec3 {
    (p * f64::from(HEAD_RADIUS)).as_vec3()
}

/// The basis function at this offset from a landmark.
fn round(off: DVec3) -> f64 {
    -(off.length_squared() + ROUND * ROUND).sqrt()
}

/// Solves a linear system whose rows end in three right-hand sides, by elimination with pivoting; `None` if it is
/// singular.
fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<[f64; 3]>> {
    let n = rows.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|a, b| rows[*a][i].abs().total_cmp(&rows[*b][i].abs()))?;
        rows.swap(i, pivot);
        let above = rows[i].clone();
        if !(above[i].abs() > 1e-12 && above[i].is_finite()) {
            return None;
        }
        for row in &mut rows[i + 1..] {
            let factor = row[i] / above[i];
            row.iter_mut().zip(&above).skip(i).for_each(|(x, above)| *x -= factor * above);
        }
    }
    let mut out = vec![[0.0; 3]; n];
    for i in (0..n).rev() {
        let row = &rows[i];
        for side in 0..3 {
            let known: f64 = (i + 1..n).map(|j| row[j] * out[j][side]).sum();
            out[i][side] = (row[n + side] - known) / row[i];
        }
    }
    Some(out)
}

/// Singular values of a matrix, smallest first, the smallest with the sign of the determinant: Jacobi rotations of its
/// square.
fn stretches(m: DMat3) -> [f64; 3] {
    let mut a = (m.transpose() * m).to_cols_array_2d();
    for _ in 0..8 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if a[i][j].abs() <= 1e-15 * (a[i][i] + a[j][j]) {
                continue;
            }
            let theta = 0.5 * (a[j][j] - a[i][i]) / a[i][j];
            let sign = if theta < 0.0 { -1.0 } else { 1.0 };
            let t = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (t * t + 1.0).sqrt();
            let sin = t * cos;
            for row in &mut a {
                (row[i], row[j]) = (cos * row[i] - sin * row[j], sin * row[i] + cos * row[j]);
            }
            let (first, second) = (a[i], a[j]);
            for k in 0..3 {
                a[i][k] = cos * first[k] - sin * second[k];
                a[j][k] = sin * first[k] + cos * second[k];
            }
        }
    }
    let mut all = [a[0][0], a[1][1], a[2][2]].map(|square| square.max(0.0).sqrt());
    all.sort_by(f64::total_cmp);
    if m.determinant() < 0.0 {
        all[0] = -all[0];
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::Dice;

    /// Landmarks of a head similar to the built-in one.
    fn usual() -> Landmarks {
        let text = "front 0 3.8 8.9; nape 0 -6.9 -7.2; left temple 6.8 1.2 4.7; right temple -6.8 1.2 4.7; \
                    left ear 7.6 -1.9 -1.9; right ear -7.6 -1.9 -1.9; crown 0 8.2 -3.8; chin 0 -12 9.2";
        Landmarks::parse(text).0
    }

    /// The same, each moved by at most this much along each axis.
    fn shaken(id: u64, by: f32) -> Landmarks {
        let dice = Dice::new(7, 0, "carry");
        let mut out = usual();
        for (k, (mark, at)) in (0u64..).zip(usual().each()) {
            let way = |axis| dice.signed(id, 3 * k + axis);
            let way =
                Vec3::new(way(0), way(1), way(2)).normalize_or(Vec3::X) * dice.unit(id, 40 + k);
            out.set(mark, Some(at + way * by));
        }
        out
    }

    fn about(id: u64) -> Vec3 {
        let dice = Dice::new(8, 0, "place");
        Vec3::new(dice.signed(id, 0), dice.signed(id, 1), dice.signed(id, 2)) * 12.0
    }

    #[test]
    fn landmarks_meet_and_the_way_back_leads_back() {
        let mut whole = 0;
        for id in 0..1000 {
            let (home, here) = (usual(), shaken(id, 1.5));
            let (Some(map), told) = Carry::between(&home, &here) else { panic!("no map") };
            assert_eq!(told.met.len(), 8);
            whole += usize::from(map.part() == 1.0);
            if map.part() == 1.0 {
                for (mark, at) in home.each() {
                    assert!(map.at(at).distance(here.get(mark).unwrap()) < 1e-5, "{mark:?}");
                }
            }
            for place in 0..20 {
                let p = about(id * 20 + place);
                let back = map.back(map.at(p));
                // Deep in the neck the map may fold, since no hair is there.
                assert!(
                    back.distance(p) < 1e-4 || p.length() > 10.0 && p.y < -5.0 || p.length() < 6.0,
                    "{id} {p} {back}"
                );
            }
        }
        println!("{whole} of 1000 whole");
        assert!(whole > 950, "{whole}");
    }

    #[test]
    fn the_same_landmarks_are_no_map() {
        let (map, told) = Carry::between(&usual(), &usual());
        assert!(map.is_none() && told == MapReport::default());
        let (read, _) = Landmarks::parse(&usual().to_string());
        assert!(Carry::between(&read, &usual()).0.is_none());
        assert!(Carry::between(&Landmarks::default(), &usual()).0.is_none());
    }

    #[test]
    fn an_affine_change_is_kept_everywhere() {
        let turn = glam::Mat3::from_cols(
            Vec3::new(1.1, 0.05, 0.0),
            Vec3::new(-0.04, 0.9, 0.1),
            Vec3::new(0.02, 0.0, 1.05),
        );
        let to = |p: Vec3| turn * p + Vec3::new(0.2, -0.4, 0.3);
        let mut here = Landmarks::default();
        usual().each().for_each(|(mark, at)| here.set(mark, Some(to(at))));
        let map = Carry::between(&usual(), &here).0.unwrap();
        for id in 0..500 {
            let p = about(id);
            assert!(map.at(p).distance(to(p)) < 0.01, "{p} {} {}", map.at(p), to(p));
        }
    }

    #[test]
    fn no_displacement_up_to_3_cm_folds_and_none_is_relaxed_in_silence() {
        let (mut whole, mut least) = (0, 1f32);
        for id in 0..1000 {
            let here = shaken(id + 5000, 3.0);
            let (Some(map), told) = Carry::between(&usual(), &here) else { panic!("no map") };
            whole += usize::from(map.part() == 1.0);
            least = least.min(map.part());
            assert_eq!(map.part() < 1.0, told.missed.is_some(), "{told:?}");
            for place in 0..40 {
                let p = about(id * 40 + place).normalize_or(Vec3::Y) * (6.7 + 0.15 * place as f32);
                let [low, _, high] = map.stretch(p);
                assert!(map.at(p).is_finite() && high.is_finite());
                assert!(low > 0.5 * LEAST as f32 || p.y < -9.0, "{id}: {low} at {p}");
            }
        }
        println!("{whole} of 1000 whole, the least part {least}");
        assert!(whole > 500, "{whole}");
    }

    #[test]
    fn landmarks_that_swap_sides_are_relaxed_and_hostile_ones_are_sound() {
        let swap = "left ear -7.6 -1.9 -1.9; right ear 7.6 -1.9 -1.9";
        let mut here = usual();
        Landmarks::parse(swap).0.each().for_each(|(mark, at)| here.set(mark, Some(at)));
        let (map, told) = Carry::between(&usual(), &here);
        assert!(map.is_none_or(|map| map.part() < 1.0) && told.missed.unwrap().1 > 5.0);
        let hostile = [
            "crown 0 9 -3",
            "crown 0 9 -3; chin 0 -9 8",
            "left ear 8 0 0; right ear -8 0 0; front 0 0 8; nape 0 0 -8",
            "crown 0 9 -3; chin 0 9 -3; front 0 9 -3; nape 0 8 0",
            "crown 1e30 0 0; chin 0 -1e30 0",
            "crown 3e38 3e38 -3e38; front 0 0 0",
            "crown 0 0 0; chin 0 0 0; front 0 0 0",
        ];
        for text in hostile {
            let (one, faults) = Landmarks::parse(text);
            assert!(faults.is_empty(), "{faults:?}");
            for (home, here) in [(one, usual()), (usual(), one)] {
                let (map, told) = Carry::between(&home, &here);
                let Some(map) = map else { continue };
                for id in 0..50 {
                    let p = about(id);
                    assert!(map.at(p).is_finite() && map.back(p).is_finite(), "{text} {told:?}");
                    assert!(map.stretch(p).iter().all(|x| x.is_finite()));
                }
            }
        }
    }

    #[test]
    fn stretches_are_those_of_the_matrix() {
        let dice = Dice::new(9, 0, "matrix");
        for id in 0..500 {
            let number = |k| f64::from(dice.signed(id, k));
            let m = DMat3::from_cols_array(&std::array::from_fn(|k| number(k as u64)));
            let [a, b, c] = stretches(m);
            assert!((a * b * c - m.determinant()).abs() < 1e-9, "{a} {b} {c}");
            let squares: f64 = m.to_cols_array().iter().map(|x| x * x).sum();
            assert!((a * a + b * b + c * c - squares).abs() < 1e-9 && b >= a.abs() && c >= b);
        }
    }
}
