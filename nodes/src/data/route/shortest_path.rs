//! The way round: the shortest way through the air from one place to another, past whatever skin lies between.
//!
//! Found on a lattice by A* (Hart, Nilsson and Raphael 1968) and pulled tight.
//!
//! Guarantees: every piece of a way keeps off the skin as far as the distance field tells, but for its two ends; the same way on
//! every machine. Not promised: a way that leaves the box about both ends by more than [`MARGIN`], or through gaps narrower than
//! the lattice; there is none then.

use crate::data::skin::Skin;
use glam::Vec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Spacing of the lattice, cm: that of the distance field.
const STEP: f32 = 0.2;
/// A way leaves the box about its ends by no more than this, cm: over an ear.
const MARGIN: f32 = 3.0;
/// Ends farther apart than this (cm) are not looked at: their box has too many places.
const FARTHEST: f32 = 5.0;
/// How far a way keeps off the skin, cm, where it can.
const OFF: f32 = 0.06;
/// After so many places looked at there is no way: past half of an ear it takes a few thousand, among folds all there are.
const MOST_PLACES: usize = 20_000;
/// How many times as long a way may be to do so: past half of an ear, and out of the fold that an end lies in.
const HARD: u32 = 15;
/// Lengths of the steps along one, two and three axes, in thousandths of [`STEP`]: whole numbers, so that ways that are as long
/// as each other are told apart by where they have come to, not by how they were added up.
const LONG: [u32; 3] = [1000, 1414, 1732];
/// So far off the skin (cm) half a step to the side is free too, even at a crease.
const AIR: f32 = OFF + 0.9 * STEP + 0.1;

/// The corners of the shortest way, both ends included; none where there is none.
pub(super) fn way_round(skin: &Skin, from: Vec3, to: Vec3) -> Option<Vec<Vec3>> {
    if !from.is_finite() || !to.is_finite() || from.distance(to) > FARTHEST {
        return None;
    }
    let low = from.min(to) - Vec3::splat(MARGIN);
    let high = from.max(to) + Vec3::splat(MARGIN);
    let size = ((high - low) / STEP).to_array().map(|x| x as i32 + 1);
    let place = |at: [i32; 3]| low + Vec3::from_array(at.map(|x| x as f32)) * STEP;
    let index = |at: [i32; 3]| ((at[0] * size[1] + at[1]) * size[2] + at[2]) as usize;
    let nearest = |p: Vec3| {
        let at = ((p - low) / STEP).to_array();
        [0, 1, 2].map(|axis| ((at[axis] + 0.5) as i32).min(size[axis] - 1))
    };
    let is_free = |p: Vec3| skin.about(p) > OFF;
    let count = (size[0] * size[1] * size[2]) as usize;
    // How far off the skin places are, once asked for.
    let mut known = vec![f32::NAN; count];
    let mut off = |at: [i32; 3]| {
        let known = &mut known[index(at)];
        if known.is_nan() {
            *known = skin.about(place(at));
        }
        *known
    };
    // Ends lie on the skin: the way begins in the air over them, so that only what lies between is hard.
    let mut beside = |p: Vec3| {
        let (d, outward, _) = skin.roughly(p).unwrap_or((1.0, Vec3::ZERO, 0.0));
        let over = p + outward.normalize_or_zero() * (OFF + 0.5 * STEP - d).max(0.0);
        let at = nearest(over.clamp(low, high));
        let far = |at: [i32; 3]| place(at).distance_squared(over);
        let mut best: Option<[i32; 3]> = None;
        for step in [[0; 3]].into_iter().chain(STEPS) {
            let next = [0, 1, 2].map(|axis| at[axis] + step[axis]);
            let inside = (0..3).all(|axis| (0..size[axis]).contains(&next[axis]));
            if inside && off(next) > OFF && best.is_none_or(|best| far(next) < far(best)) {
                best = Some(next);
            }
        }
        best.unwrap_or(at)
    };
    let (start, goal) = (beside(from), beside(to));
    let mut cost = vec![u32::MAX; count];
    let mut before = vec![0u8; count];
    // By the least that the whole way may cost; of equals first what is nearest to the goal.
    let mut open = BinaryHeap::new();
    let (mut looked, most) = (0, MOST_PLACES.min(skin.patience()));
    cost[index(start)] = 0;
    open.push(Reverse((left(start, goal), left(start, goal), start)));
    while let Some(Reverse((whole, rest, at))) = open.pop() {
        if at == goal {
            break;
        }
        let come = cost[index(at)];
        if whole > come + rest {
            continue;
        }
        looked += 1;
        if looked > most {
            skin.looked(looked);
            return None;
        }
        for (k, step) in STEPS.iter().enumerate() {
            let next = [0, 1, 2].map(|axis| at[axis] + step[axis]);
            if (0..3).any(|axis| !(0..size[axis]).contains(&next[axis])) {
                continue;
            }
            let long = LONG[step.iter().filter(|x| **x != 0).count() - 1];
            let known = cost[index(next)];
            if come + long >= known {
                continue;
            }
            let open_air = off(at).max(off(next)) > AIR;
            let free = off(next) > OFF && (open_air || is_free((place(at) + place(next)) * 0.5));
            let come = come + if free { long } else { HARD * long };
            if come < known {
                cost[index(next)] = come;
                before[index(next)] = k as u8;
                let rest = left(next, goal);
                open.push(Reverse((come + rest, rest, next)));
            }
        }
    }
    skin.looked(looked);
    if cost[index(goal)] == u32::MAX {
        return None;
    }
    let mut way = vec![to];
    let mut at = goal;
    loop {
        way.push(place(at));
        if at == start {
            break;
        }
        let step = STEPS[before[index(at)] as usize];
        at = [0, 1, 2].map(|axis| at[axis] - step[axis]);
    }
    way.push(from);
    way.reverse();
    Some(tight(&way, is_free))
}

/// The 26 neighbours of a place.
const STEPS: [[i32; 3]; 26] = {
    let (mut out, mut n, mut k) = ([[0; 3]; 26], 0, 0);
    while k < 27 {
        if k != 13 {
            out[n] = [k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1];
            n += 1;
        }
        k += 1;
    }
    out
};

/// The length of the shortest way through open air, in thousandths of [`STEP`].
fn left(at: [i32; 3], goal: [i32; 3]) -> u32 {
    let mut far = [0, 1, 2].map(|axis| at[axis].abs_diff(goal[axis]));
    far.sort_unstable();
    LONG[2] * far[0] + LONG[1] * (far[1] - far[0]) + LONG[0] * (far[2] - far[1])
}

/// The way without the corners that it can do without.
fn tight(way: &[Vec3], is_free: impl Fn(Vec3) -> bool) -> Vec<Vec3> {
    let sees = |a: Vec3, b: Vec3| {
        let pieces = (a.distance(b) / (0.5 * STEP)).ceil().max(2.0) as usize;
        (1..pieces).all(|k| is_free(a.lerp(b, k as f32 / pieces as f32)))
    };
    let mut out = vec![way[0]];
    let mut k = 0;
    while k + 1 < way.len() {
        let far = (k + 2..way.len()).rev().find(|far| sees(way[k], way[*far]));
        k = far.unwrap_or(k + 1);
        out.push(way[k]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::route::skin_clear::tests::bust;

    #[test]
    fn a_way_leads_round_an_ear_and_keeps_off_it() {
        let scalp = bust();
        let skin = scalp.skin();
        let mut led = 0;
        for k in 0..20 * 16 * 20 {
            let [x, y, z] = [k / 320, k / 20 % 16, k % 20].map(|k| 0.2 * k as f32);
            let at = Vec3::new(7.0 + x, y - 2.5, z - 3.0);
            let (from, to) = (at + Vec3::Z * 2.0, at - Vec3::Z * 2.0);
            let blocked = skin.about(at) < -0.02;
            if !blocked || skin.about(from) < OFF || skin.about(to) < OFF {
                continue;
            }
            let way = way_round(&skin, from, to).unwrap();
            assert_eq!((way[0], way[way.len() - 1]), (from, to));
            let length: f32 = way.windows(2).map(|w| w[0].distance(w[1])).sum();
            assert!(length < 10.0, "{at}: {length}");
            for w in way.windows(2) {
                for k in 0..=20 {
                    let p = w[0].lerp(w[1], k as f32 / 20.0);
                    assert!(skin.distance(p) > 0.0, "{p} is {}", skin.distance(p));
                }
            }
            led += 1;
        }
        assert!(led > 20, "{led}");
        assert_eq!(way_round(&skin, Vec3::Y * 20.0, Vec3::Y * 30.0), None);
        let near = [Vec3::Y * 20.0, Vec3::Y * 20.01];
        assert_eq!(way_round(&skin, near[0], near[1]), Some(near.to_vec()));
    }
}
