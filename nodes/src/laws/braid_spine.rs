//! Which way a braid faces along its length, and what is seen of it from there: its sections and their word.
//!
//! The front is told with the hair, or at the beginning alone by the skin or by the normals of the scalp at the roots. Where
//! it is not told it is found: a word read along a front that is never told is that of the braid but for front and back.

use super::braid_strands::{SampledBraid, StrandSample};
use super::braid_words::Word;
use super::hair::{AttributeValues, MeasuredHair, quantile};
use crate::data::scalp::Scalp;
use crate::maths::frame::{across, any_normal, carry};
use crate::maths::transcendental::{atan2, cos, sin, sin_cos};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Farther than this (cm) from the skin its side tells nothing of a braid's front.
const NEAR: f32 = 3.0;

/// A braid as it is seen along one way of turning its front.
pub(super) struct BraidView {
    pub(super) sections: Vec<Vec<Vec2>>,
    /// First and last section that is braided: the root where strands are gathered to a bundle and the brush beyond the
    /// tie are not.
    pub(super) woven: (usize, usize),
    pub(super) word: Option<Word>,
}

impl BraidView {
    /// Whichever way shows one weave all along, the braid is that weave; else the way with the fewest faults.
    pub(super) fn of(spine: &Spine, told: &[Vec3], braid: &SampledBraid) -> Self {
        let mut seen = Self::along(spine, told, BROAD[0], braid, Cut::Across);
        let across = BROAD[1..].iter().map(|broad| (*broad, Cut::Across));
        for (broad, cut) in across.chain(BROAD.iter().map(|broad| (*broad, Cut::AsFarAlong))) {
            if seen.faults() > 0 {
                let other = Self::along(spine, told, broad, braid, cut);
                seen = if other.faults() < seen.faults() { other } else { seen };
            }
        }
        seen
    }

    fn along(spine: &Spine, told: &[Vec3], broad: f32, braid: &SampledBraid, cut: Cut) -> Self {
        let sections = spine.turned(told, broad, braid).sections(braid, cut);
        let halves: Vec<f32> = sections.iter().map(|s| half(s)).collect();
        let mut sorted = halves.clone();
        sorted.sort_by(f32::total_cmp);
        let wide = 0.4 * quantile(&sorted, 0.5);
        let first = halves.iter().position(|h| *h > wide).unwrap_or(0);
        let last = halves.iter().rposition(|h| *h > wide).unwrap_or(0);
        let word = Word::read(braid.strands.len(), &sections[first..=last]);
        Self { sections, woven: (first, last), word }
    }

    fn faults(&self) -> usize {
        self.word.as_ref().map_or(usize::MAX, |word| word.faults)
    }
}

/// Which places of the strands are a section.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cut {
    /// Where they go through the plane across the braid.
    Across,
    /// As far along. Where a thin braid climbs, a plane across it may meet a strand a stitch away.
    AsFarAlong,
}

/// How much the breadth of a braid says of its front, against turning: braids that turn much are followed by much, those
/// that lie round at places by little, those that are as high as they are broad, and have no broad side, not at all.
const BROAD: [f32; 4] = [0.25, 1.0, 4.0, 0.0];
/// What is told of the front, against both.
const TOLD: f32 = 100.0;
/// The cost of turning: of a radian along half the braid's width, squared.
const STIFF: f32 = 4.0;

/// A braid's own middle line with its front.
pub(super) struct Spine {
    pub(super) at: Vec<Vec3>,
    tangents: Vec<Vec3>,
    fronts: Vec<Vec3>,
}

impl Spine {
    /// With any front, carried along without turning.
    pub(super) fn of(braid: &SampledBraid) -> Self {
        let n = braid.strands[0].len();
        let of_strands = braid.strands.len() as f32;
        let at: Vec<Vec3> = (0..n)
            .map(|k| braid.strands.iter().map(|s| s[k].middle).sum::<Vec3>() / of_strands)
            .collect();
        let reach = (n / 100).max(2);
        let mut tangents: Vec<Vec3> = (0..n)
            .map(|k| at[(k + reach).min(n - 1)] - at[k.saturating_sub(reach)])
            .map(Vec3::normalize_or_zero)
            .collect();
        for k in 1..n {
            if tangents[k] == Vec3::ZERO {
                tangents[k] = tangents[k - 1];
            }
        }
        Self { at, fronts: carried(&tangents), tangents }
    }

    /// What tells the front, zero where nothing does: the hair; else the skin where the braid begins, or the normal of
    /// the scalp at its roots.
    pub(super) fn front_cues(
        &self,
        hair: &MeasuredHair,
        braid: &SampledBraid,
        scalp: Option<&Scalp>,
        root_front: Option<&AttributeValues<Vec3>>,
    ) -> Vec<Vec3> {
        let n = self.at.len();
        let mut told: Vec<Vec3> = (0..n)
            .map(|k| braid.strands.iter().map(|s| s[k].front).sum::<Vec3>().normalize_or_zero())
            .collect();
        if told.iter().all(|front| *front == Vec3::ZERO) {
            let below = |p: &Vec3| {
                let hit = scalp?.surface().closest_within(*p, NEAR)?;
                Some(scalp?.surface().smooth_normal(hit.triangle, hit.bary))
            };
            let skin = self.at[..n.div_ceil(20)].iter().filter_map(below).sum::<Vec3>();
            let roots = braid.curves.iter().flatten();
            let root = root_front.map_or(Vec3::ZERO, |column| {
                roots.map(|i| column.at(*i, hair.range(*i).start)).sum::<Vec3>()
            });
            told[0] = if skin == Vec3::ZERO { root } else { skin };
        }
        told
    }

    /// The same with its fronts turned to what is `told` of them. Where nothing is, the braid may have turned on: of all
    /// ways to turn, the one that turns least and along which the braid is seen `broad`.
    fn turned(&self, told: &[Vec3], broad: f32, braid: &SampledBraid) -> Self {
        let angles: Vec<Option<f32>> = (0..self.at.len())
            .map(|k| {
                let front = across(told[k].try_normalize()?, self.tangents[k])?;
                let right = self.tangents[k].cross(self.fronts[k]);
                Some(atan2(front.dot(-right), front.dot(self.fronts[k])))
            })
            .collect();
        let turned = match angles.iter().copied().collect() {
            Some(all) => all,
            None => self.least_turn(&angles, broad, braid),
        };
        let front = |(k, turned): (usize, f32)| {
            let (front, right) = (self.fronts[k], self.tangents[k].cross(self.fronts[k]));
            // The broad side turned from `right` towards `front` by the angle.
            front * cos(turned) - right * sin(turned)
        };
        Self {
            at: self.at.clone(),
            tangents: self.tangents.clone(),
            fronts: turned.into_iter().enumerate().map(front).collect(),
        }
    }

    /// By how much (radians) each carried front turns on the way of least cost. It is the best way of all, so that a place
    /// where strands lie round, or one kink, can't lead it astray as it would a front that is followed step by step.
    fn least_turn(&self, told: &[Option<f32>], broad: f32, braid: &SampledBraid) -> Vec<f32> {
        // Fronts looked at about each place, and how many of these a front turns by at most from one place to the next.
        const WAYS: usize = 192;
        const AT_ONCE: usize = 24;
        // Places are so many half widths apart: closer, the ways would be too far apart for a slow turn.
        const APART: f32 = 0.5;
        let n = self.at.len();
        let sections = self.sections(braid, Cut::Across);
        let mut sorted: Vec<f32> =
            sections.iter().map(|s| s.iter().map(|p| p.length()).fold(0.0, f32::max)).collect();
        sorted.sort_by(f32::total_cmp);
        let half = quantile(&sorted, 0.5).max(1e-6);
        let long: f32 = self.at.windows(2).map(|w| w[0].distance(w[1])).sum();
        let block = ((APART * half * n as f32 / long.max(1e-6)) as usize).clamp(1, n);
        let step = (long * block as f32 / n as f32 / half).max(1e-6);
        let way = |i: usize| i as f32 * (TAU / WAYS as f32);
        // How narrow the braid is seen to be, 0 to 1, and how far from what is told, at one place from all ways.
        let costs = |k: usize| -> Vec<f32> {
            let places = k..(k + block).min(n);
            let [mut xx, mut xy, mut yy] = [1e-12; 3];
            for p in sections[places.clone()].iter().flatten() {
                (xx, xy, yy) = (xx + p.x * p.x, xy + p.x * p.y, yy + p.y * p.y);
            }
            let told = told[places].iter().flatten().next();
            let of = |i: usize| {
                let (s, c) = sin_cos(way(i));
                let deep = (xx * s * s - 2.0 * xy * s * c + yy * c * c) / (xx + yy);
                let off = told.map_or(0.0, |told| TOLD * (1.0 - cos(way(i) - told)));
                step * (broad * deep + off)
            };
            (0..WAYS).map(of).collect()
        };
        let turn = STIFF * way(1) * way(1) / step;
        let mut sum = costs(0);
        let mut came_by: Vec<Vec<usize>> = vec![];
        for k in (block..n).step_by(block) {
            let from = |i: usize| {
                let by = |d: usize| {
                    let off = d.abs_diff(AT_ONCE) as f32;
                    (sum[(i + WAYS + d - AT_ONCE) % WAYS] + turn * off * off, d)
                };
                (0..=2 * AT_ONCE)
                    .map(by)
                    .fold((f32::MAX, AT_ONCE), |a, b| if b.0 < a.0 { b } else { a })
            };
            let (least, by): (Vec<f32>, Vec<usize>) = (0..WAYS).map(from).unzip();
            sum = least.iter().zip(costs(k)).map(|(least, cost)| least + cost).collect();
            came_by.push(by);
        }
        // Back along the best, counted on over full turns.
        let end = (0..WAYS).min_by(|a, b| sum[*a].total_cmp(&sum[*b])).unwrap_or(0);
        let mut best = vec![end as i64];
        for by in came_by.iter().rev() {
            let at = best[best.len() - 1];
            let by = by[at.rem_euclid(WAYS as i64) as usize];
            best.push(at + by as i64 - AT_ONCE as i64);
        }
        best.reverse();
        let best: Vec<f32> = best.into_iter().map(|i| i as f32 * way(1)).collect();
        let between = |k: usize| {
            // Each place is the middle of its block.
            let t = ((k as f32 + 0.5) / block as f32 - 0.5).clamp(0.0, (best.len() - 1) as f32);
            let i = t as usize;
            best[i] + (best[(i + 1).min(best.len() - 1)] - best[i]) * t.fract()
        };
        (0..n).map(between).collect()
    }

    /// Each strand seen along the braid: to the right (tangent x front) and to the front.
    fn sections(&self, braid: &SampledBraid, cut: Cut) -> Vec<Vec<Vec2>> {
        let n = self.at.len();
        let reach = if cut == Cut::Across { (n / 30).max(3) } else { 0 };
        (0..n)
            .map(|k| {
                let (at, tangent, front) = (self.at[k], self.tangents[k], self.fronts[k]);
                let right = tangent.cross(front);
                let one = |strand: &Vec<StrandSample>| {
                    // Where the strand goes through the plane across the braid here.
                    let ahead = |j: usize| (strand[j].middle - at).dot(tangent);
                    let mut p = strand[k].middle;
                    let mut best = usize::MAX;
                    for j in k.saturating_sub(reach)..(k + reach).min(n - 1) {
                        let (a, b) = (ahead(j), ahead(j + 1));
                        if a <= 0.0 && b > 0.0 && j.abs_diff(k) < best {
                            best = j.abs_diff(k);
                            p = strand[j].middle.lerp(strand[j + 1].middle, a / (a - b));
                        }
                    }
                    Vec2::new((p - at).dot(right), (p - at).dot(front))
                };
                braid.strands.iter().map(one).collect()
            })
            .collect()
    }
}

/// Any front carried along without turning about the tangents.
fn carried(tangents: &[Vec3]) -> Vec<Vec3> {
    let mut fronts = vec![any_normal(tangents[0])];
    for w in tangents.windows(2) {
        fronts.push(carry(fronts[fronts.len() - 1], w[0], w[1]));
    }
    fronts
}

fn half(section: &[Vec2]) -> f32 {
    section.iter().map(|p| p.x.abs()).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::super::braid_words::Crossing;
    use super::*;
    use crate::maths::transcendental::exp;
    use std::f32::consts::PI;

    /// Ten stitches of a braid under a front that turns by `turn` (radians) at a share of its length, 2 wide and `high` deep,
    /// along `line`, and what is told of its front.
    fn braid(
        line: impl Fn(f32) -> Vec3,
        turn: impl Fn(f32) -> f32,
        high: f32,
        shape: impl Fn(f32, Vec2) -> Vec2,
    ) -> (SampledBraid, Vec<Vec3>) {
        const SAMPLES: usize = 400;
        let share = |k: usize| k as f32 / (SAMPLES - 1) as f32;
        let at: Vec<Vec3> = (0..SAMPLES).map(|k| line(share(k))).collect();
        let tangents: Vec<Vec3> = (0..SAMPLES)
            .map(|k| at[(k + 1).min(SAMPLES - 1)] - at[k.saturating_sub(1)])
            .map(Vec3::normalize)
            .collect();
        let fronts = carried(&tangents);
        let strand = |i: usize| {
            let section = |k: usize| {
                let (sin, cos) = sin_cos(turn(share(k)));
                let right = tangents[k].cross(fronts[k]);
                let c = (0.013 + share(k) * 10.0 / 3.0 + i as f32 / 3.0) * TAU;
                let p = shape(share(k), Vec2::new(sin_cos(c).0, 0.5 * high * sin_cos(2.0 * c).0));
                let (front, right) = (fronts[k] * cos - right * sin, right * cos + fronts[k] * sin);
                StrandSample {
                    middle: at[k] + right * p.x + front * p.y,
                    ..StrandSample::default()
                }
            };
            (0..SAMPLES).map(section).collect()
        };
        let mut told = vec![Vec3::ZERO; SAMPLES];
        told[0] = fronts[0];
        let strands = (0..3).map(strand).collect();
        (SampledBraid { tubes: false, strands, curves: vec![vec![]; 3] }, told)
    }

    /// Straight down, and with a kink of 80 degrees half-way.
    fn straight(t: f32) -> Vec3 {
        Vec3::NEG_Y * (20.0 * t)
    }

    fn kinked(t: f32) -> Vec3 {
        let after = (t - 0.5).max(0.0) * 20.0;
        straight(t.min(0.5)) + Vec3::new(0.0, -0.17, 0.98) * after
    }

    #[track_caller]
    fn check((braid, told): (SampledBraid, Vec<Vec3>), what: &str) {
        let word = BraidView::of(&Spine::of(&braid), &told, &braid).word.unwrap();
        assert_eq!((word.faults, word.crossing()), (0, Crossing::Under), "{what}");
    }

    #[test]
    fn a_braid_is_read_whichever_way_it_turns() {
        let as_it_is = |_: f32, p: Vec2| p;
        let squeezed = |t: f32, p: Vec2| {
            let narrow = if (t - 0.5).abs() < 0.06 { 0.45 } else { 1.0 };
            Vec2::new(p.x * narrow, p.y)
        };
        check(braid(straight, |_| 0.0, 1.0, as_it_is), "straight");
        check(braid(straight, |t| 3.0 * PI * t, 1.0, as_it_is), "turned by one and a half");
        check(braid(kinked, |_| 0.0, 1.0, as_it_is), "kinked");
        check(braid(kinked, |t| PI * t, 1.0, as_it_is), "kinked and turned");
        check(braid(straight, |_| 0.0, 2.0, as_it_is), "as high as broad");
        check(braid(straight, |_| 0.0, 2.6, as_it_is), "higher than broad");
        check(braid(kinked, |_| 0.0, 1.3, squeezed), "squeezed at its kink");
    }

    #[test]
    fn where_planes_meet_a_strand_a_stitch_away_it_is_read_as_far_along() {
        let (mut braid, told) = braid(straight, |_| 0.0, 1.0, |_, p| p);
        let n = braid.strands[0].len() as f32;
        for (k, section) in braid.strands[0].iter_mut().enumerate() {
            let far = (k as f32 / n - 0.4) * 20.0;
            section.middle.y += 2.2 * exp(-far * far);
        }
        let across = BraidView::along(&Spine::of(&braid), &told, BROAD[0], &braid, Cut::Across);
        assert!(across.faults() > 0);
        check((braid, told), "one strand back by a stitch");
    }

    #[test]
    fn a_crossing_the_wrong_way_is_found_whichever_way_the_braid_turns() {
        for turn in [0.0, 3.0 * PI] {
            let wrong =
                |t: f32, p: Vec2| if (t - 0.5).abs() < 0.025 { Vec2::new(p.x, -p.y) } else { p };
            let (braid, told) = braid(straight, |t| turn * t, 1.0, wrong);
            let view = BraidView::of(&Spine::of(&braid), &told, &braid);
            assert!(view.faults() > 0, "turned by {turn}");
        }
    }
}
