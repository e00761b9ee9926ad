//! Braid words: which neighbours cross in which order, and which of the two is in front (methods.md 2).
//!
//! Strands are seen along the braid, `x` to the side and `y` to the front. `s1` is the pair farthest left; `s1` stands for a
//! crossing in which the strand that goes right is in front, `s1^-1` for one in which it is behind. In a weave every pair
//! crosses always the same way and neighbouring pairs take turns: up to exchange of commuting generators and rotation
//! such a word is (one stitch's factor)^stitches.

use crate::maths::transcendental::sin;
use glam::Vec2;

/// What the crossings of one braid say.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// For each pair from the left: whether the strand that goes right is in front.
    pub signs: Vec<bool>,
    /// Crossings of the pair that crosses most.
    pub stitches: usize,
    /// Crossings that break the pattern: the other way round, or out of turn.
    pub faults: usize,
}

/// How strands cross at the outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Crossing {
    /// The strand that goes inward is behind on both sides: cornrow, Dutch braid.
    Under,
    /// It is in front on both sides: English and French braid.
    Over,
    /// Both are the same braid: a rope, four or six strands. The hand tells two apart.
    Either,
}

impl Word {
    /// Reads `samples` sections of a braid of `n` strands from its root on; none where nothing crosses.
    pub fn read(n: usize, samples: &[Vec<Vec2>]) -> Option<Self> {
        let crossings = crossings(n, samples);
        let mut signs = vec![];
        let (mut faults, mut stitches) = (0, 0);
        for pair in 0..n - 1 {
            let own = || crossings.iter().filter(|(p, _)| *p == pair).map(|(_, front)| *front);
            let with = |wanted: bool| own().flatten().filter(|front| *front == wanted).count();
            let (front, behind) = (with(true), with(false));
            signs.push(front > behind);
            // A pair of which nothing is told has no sign.
            faults += front.min(behind) + usize::from(front + behind == 0);
            stitches = stitches.max(own().count());
            if pair + 2 < n {
                let two: Vec<usize> = crossings
                    .iter()
                    .map(|c| c.0)
                    .filter(|p| *p == pair || *p == pair + 1)
                    .collect();
                faults += two.windows(2).filter(|w| w[0] == w[1]).count();
            }
        }
        let inner = crossings.get(ENDS..crossings.len().saturating_sub(ENDS)).unwrap_or_default();
        faults += inner.iter().filter(|(_, front)| front.is_none()).count();
        (stitches > 0).then_some(Self { signs, stitches, faults })
    }

    /// How strands cross at the outside, `y` being away from the scalp.
    pub fn crossing(&self) -> Crossing {
        match (self.signs.first(), self.signs.last()) {
            (Some(false), Some(true)) => Crossing::Under,
            (Some(true), Some(false)) => Crossing::Over,
            _ => Crossing::Either,
        }
    }

    /// The frequency of the weave with this factor, seen from in front or, mirrored, from either hand; none where there
    /// is none.
    pub fn weave(&self) -> Option<usize> {
        let n = self.signs.len() + 1;
        let turned: Vec<bool> = self.signs.iter().map(|s| !s).collect();
        (1..n).find(|m| {
            let of = factor_of(n, *m);
            gcd(*m, n) == 1 && (of == self.signs || of == turned)
        })
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Signs of the weave (n, m): x = sin(c), y = sin(m c), or cos for odd m; strand i is i/n of a cycle ahead.
fn factor_of(n: usize, m: usize) -> Vec<bool> {
    const FINE: usize = 60;
    let section = |k: usize| -> Vec<Vec2> {
        let strand = |i: usize| {
            // A little off, so that no crossing falls on a sample.
            let c = ((k as f32 + 0.37) / (FINE * n) as f32 + i as f32 / n as f32)
                * std::f32::consts::TAU;
            let quarter = if m % 2 == 1 { std::f32::consts::FRAC_PI_2 } else { 0.0 };
            Vec2::new(sin(c), sin(m as f32 * c + quarter))
        };
        (0..n).map(strand).collect()
    };
    let samples: Vec<Vec<Vec2>> = (0..4 * FINE).map(section).collect();
    Word::read(n, &samples).map_or(vec![], |word| word.signs)
}

/// How far strands must have passed each other for a crossing, as a share of the braid's half width for each strand: of
/// three, each is 1.5 times the half width beyond the other before it meets the next.
const PASSED: f32 = 0.9;

/// Strands of which neither is in front by more than this share of the braid's half width lie side by side where they pass: at
/// the root, where a braid is as thin as its hair, and in the brush beyond its tie. Which of them crosses over is not told then.
const SIDE_BY_SIDE: f32 = 0.15;
/// So many crossings from either end may be of that kind.
const ENDS: usize = 3;

/// Crossings in order: the pair, and whether the strand going right is in front.
fn crossings(n: usize, samples: &[Vec<Vec2>]) -> Vec<(usize, Option<bool>)> {
    let mut word = vec![];
    let Some(first) = samples.first().filter(|s| s.len() == n) else { return word };
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| first[*a].x.total_cmp(&first[*b].x));
    let halves: Vec<f32> =
        samples.iter().map(|s| s.iter().map(|p| p.x.abs()).fold(0.0, f32::max)).collect();
    let mut sorted = halves.clone();
    sorted.sort_by(f32::total_cmp);
    // Where strands are drawn together, little things are no crossings.
    let least = 0.5 * sorted[sorted.len() / 2];
    for (k, now) in samples.iter().enumerate().skip(1) {
        let passed = PASSED / n as f32 * halves[k].max(least);
        let mut swapped = true;
        while swapped {
            swapped = false;
            for p in 0..n - 1 {
                let (left, right) = (order[p], order[p + 1]);
                if now[left].x > now[right].x + passed {
                    // In front is who was it where they passed.
                    let passed = (1..=k)
                        .rev()
                        .find(|k| samples[k - 1][left].x <= samples[k - 1][right].x)
                        .unwrap_or(k);
                    let (a, b) = (&samples[passed - 1], &samples[passed]);
                    let high = |s: &[Vec2]| s[left].y - s[right].y;
                    let high = 0.5 * (high(a) + high(b));
                    let told = high.abs() > SIDE_BY_SIDE * halves[k];
                    word.push((p, told.then_some(high > 0.0)));
                    order.swap(p, p + 1);
                    swapped = true;
                }
            }
        }
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::transcendental::cos;

    /// `stitches` stitches of the weave (n, m); `depth` -1 swaps front and back, `side` -1 left and right.
    fn weave(n: usize, m: usize, stitches: f32, depth: f32, side: f32) -> Vec<Vec<Vec2>> {
        let samples = (stitches * 20.0) as usize;
        (0..samples)
            .map(|k| {
                let strand = |i: usize| {
                    let turns = 0.013 + k as f32 / (20 * n) as f32 + i as f32 / n as f32;
                    let c = turns * std::f32::consts::TAU;
                    let y = if m % 2 == 1 { cos(m as f32 * c) } else { sin(m as f32 * c) };
                    Vec2::new(side * sin(c), depth * y)
                };
                (0..n).map(strand).collect()
            })
            .collect()
    }

    #[track_caller]
    fn check(n: usize, m: usize, depth: f32, signs: &[bool], crossing: Crossing) {
        let word = Word::read(n, &weave(n, m, 10.0, depth, 1.0)).unwrap();
        assert_eq!((&word.signs[..], word.crossing()), (signs, crossing), "({n}, {m})");
        assert_eq!((word.faults, word.weave()), (0, Some(m)), "({n}, {m})");
        assert!(word.stitches.abs_diff(10) <= 1, "({n}, {m}): {} of 10", word.stitches);
    }

    #[test]
    fn words_of_the_method_are_read_from_sections() {
        check(3, 2, 1.0, &[false, true], Crossing::Under);
        check(3, 2, -1.0, &[true, false], Crossing::Over);
        check(4, 3, 1.0, &[false, true, false], Crossing::Either);
        check(5, 2, 1.0, &[false, false, true, true], Crossing::Under);
        check(5, 4, -1.0, &[false, true, false, true], Crossing::Under);
        check(2, 1, 1.0, &[true], Crossing::Either);
    }

    #[test]
    fn a_mirror_image_is_the_same_braid_and_a_turned_one_is_not() {
        let word = Word::read(3, &weave(3, 2, 10.0, 1.0, -1.0)).unwrap();
        assert_eq!((word.crossing(), word.faults), (Crossing::Under, 0));
    }

    #[test]
    fn one_crossing_the_wrong_way_is_found() {
        let mut samples = weave(3, 2, 10.0, 1.0, 1.0);
        for sample in &mut samples[85..95] {
            sample.iter_mut().for_each(|p| p.y = -p.y);
        }
        assert!(Word::read(3, &samples).unwrap().faults > 0);
    }

    #[test]
    fn strands_that_lie_side_by_side_tell_nothing_at_an_end_and_are_a_fault_between() {
        let faults = |flat: std::ops::Range<usize>| {
            let mut samples = weave(3, 2, 10.0, 1.0, 1.0);
            samples[flat].iter_mut().flatten().for_each(|p| p.y *= -0.05);
            Word::read(3, &samples).unwrap().faults
        };
        assert_eq!((faults(180..200), faults(0..20)), (0, 0));
        assert!(faults(80..100) > 0);
    }

    #[test]
    fn strands_side_by_side_have_no_word() {
        let samples = vec![vec![Vec2::ZERO, Vec2::X, Vec2::X * 2.0]; 50];
        assert_eq!(Word::read(3, &samples), None);
    }
}
