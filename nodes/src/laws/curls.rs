//! Diameter, pitch and shrinkage of curled hair, measured from its CVs and compared with the requested values.
//!
//! Measurements use no requested value. The axis of a curl is the mean of the hair over one turn; the length of a turn follows
//! from the number of turns around the axis, iterated until both agree; for the diameter of a few long turns, the axis is the
//! smoothest curve nearest to the hair. Diameter: twice the RMS distance from the axis over the middle of the hair, where it is
//! requested (a wave's is its height over the root of 2, as in methods.md 4). Pitch: length of the axis per turn. Shrinkage: the
//! fraction by which the axis is shorter than the hair.

use super::hair::{AttributeValues, MeasuredHair, quantile};
use crate::data::attributes::CURL_MIDDLE;
use crate::maths::frame::carry;
use crate::maths::spline::Spline;
use crate::maths::transcendental::atan2;
use glam::{Vec2, Vec3};

/// Curls of hair.
#[derive(Clone, Debug, PartialEq)]
pub struct Curls {
    /// Number of hairs with requested curls.
    pub curled: usize,
    /// Number of hairs measured, evenly spread; hairs with fewer than two and a half turns cannot be.
    pub measured: usize,
    /// Measured over requested diameter: 5th percentile, median, 95th percentile.
    pub diameter_ratio: [f32; 3],
    /// The same for pitch.
    pub pitch_ratio: [f32; 3],
    /// The same for shrinkage; `None` if no request is known.
    pub shrinkage_ratio: Option<[f32; 3]>,
    /// Median measured diameter, cm.
    pub diameter_cm: f32,
    /// Median measured pitch, cm.
    pub pitch_cm: f32,
    /// Median measured shrinkage, 0 to 1.
    pub shrinkage: f32,
}

/// Largest number of measured hairs.
const MOST: usize = 2000;

/// Measured and requested curls of hair; `None` if none was requested.
pub fn measure(hair: &MeasuredHair) -> Option<Curls> {
    let (diameter, pitch) = (hair.numbers("curl_diameter")?, hair.numbers("curl_pitch")?);
    let shrinkage = hair.numbers("shrinkage");
    let asked = |column: &AttributeValues<f32>, i: usize| column.at(i, hair.range(i).start);
    let curled: Vec<usize> = (0..hair.len())
        .filter(|i| {
            hair.curve(*i).len() > 3 && asked(&diameter, *i) > 0.0 && asked(&pitch, *i) > 0.0
        })
        .collect();
    if curled.is_empty() {
        return None;
    }
    let every = curled.len().div_ceil(MOST);
    let chosen: Vec<usize> = curled.iter().copied().step_by(every).collect();
    let found: Vec<(usize, Curl)> = hair
        .in_parts(chosen.len(), 50, |part| {
            let curl = |k: usize| {
                let mut spline = Spline::default();
                hair.spline(chosen[k], &mut spline).ok()?;
                Some((chosen[k], Curl::of(&spline, hair.curve(chosen[k]).len())?))
            };
            part.filter_map(curl).collect::<Vec<_>>()
        })
        .concat();
    let spread = |value: &dyn Fn(&(usize, Curl)) -> Option<f32>| {
        let mut all: Vec<f32> = found.iter().filter_map(value).collect();
        all.sort_by(f32::total_cmp);
        [0.05, 0.5, 0.95].map(|q| quantile(&all, q))
    };
    Some(Curls {
        curled: curled.len(),
        measured: found.len(),
        diameter_ratio: spread(&|(i, c)| Some(c.diameter / asked(&diameter, *i))),
        pitch_ratio: spread(&|(i, c)| Some(c.pitch / asked(&pitch, *i))),
        shrinkage_ratio: shrinkage.as_ref().map(|s| {
            spread(&|(i, c)| Some(c.shrinkage / asked(s, *i)).filter(|_| asked(s, *i) > 0.02))
        }),
        diameter_cm: spread(&|(_, c)| Some(c.diameter))[1],
        pitch_cm: spread(&|(_, c)| Some(c.pitch))[1],
        shrinkage: spread(&|(_, c)| Some(c.shrinkage))[1],
    })
}

/// Number of measured hairs below which the rest cannot be judged.
const JUDGED: usize = 20;

impl Curls {
    /// Whether enough hairs could be measured to judge all.
    pub fn can_be_judged(&self) -> bool {
        self.measured >= JUDGED.min(self.curled) && self.measured > 0
    }
    /// Whether the medians of diameter, pitch and shrinkage are within `share` of the request.
    pub fn are_as_requested(&self, share: f32) -> [bool; 3] {
        let near = |ratio: [f32; 3]| (ratio[1] - 1.0).abs() <= share;
        let shrinkage = self.shrinkage_ratio.is_none_or(near);
        [near(self.diameter_ratio), near(self.pitch_ratio), shrinkage]
    }
}

/// Measurements of one hair.
#[derive(Clone, Copy, Debug)]
struct Curl {
    diameter: f32,
    pitch: f32,
    shrinkage: f32,
}

impl Curl {
    /// Measures a hair with `points` CVs; `None` if that is not possible.
    fn of(spline: &Spline, points: usize) -> Option<Self> {
        let length = spline.length();
        let count = (points * 4).clamp(64, 2048);
        let mut at = Vec::with_capacity(count);
        spline.resample(count, |p| at.push(p));
        let sums = sums(&at);
        let settle = |window| Turning::settled(&at, &sums, window);
        let mut turning = settle(count as f32 / 3.0)?;
        // Of a coil wider than its pitch the axis over half a turn too many winds along with the hair, and so few turns are
        // counted about it that it seems to be right. It is longer than the axis over one turn.
        if let Some(other) = settle(0.7 * turning.window)
            && other.window < 0.85 * turning.window
            && other.axis_step < 0.9 * turning.axis_step
        {
            turning = other;
        }
        let Turning { window, turned, swings, .. } = turning;
        if turned < 1.5 || window * 2.5 > count as f32 {
            return None;
        }
        // Where there are many turns, the axis is a mean over several: no turn's own wandering or going back bends it.
        let mut several = (0.25 * count as f32 / window).floor().clamp(1.0, 4.0);
        // A curl that goes back at every turn comes round in two: its axis is a mean over these, or bends half as often.
        let bends = count as f32 / window * if swings { 0.5 } else { 1.0 };
        if swings {
            several = several.min(2.0);
        }
        let (axis, from) = match swings && several == 1.0 {
            true => (low_axis(&at, bends), 0),
            false => self::axis(&sums, several * window)?,
        };
        let n = axis.len();
        let (turned, _) = turns(&at[from..from + n], &axis, window);
        // How far: along the axis, once more a mean where that is over several turns, from the root to as far as the tip lies
        // ahead.
        let (course, start) = match several > 1.0 {
            true => self::axis(&self::sums(&axis), window)?,
            false => (axis.clone(), 0),
        };
        let long = course.len();
        let span: f32 = course.windows(2).map(|w| w[0].distance(w[1])).sum();
        let turns = turned[start + long - 1] - turned[start];
        let ahead = (course[long - 1] - course[long - 1 - long / 8]).normalize_or_zero();
        // From the root on, past a third of a turn, in means that grow wider: a few long waves begin where the head bends hair
        // most.
        let reach = if several > 1.0 { 0 } else { from + start };
        let mut before = at[0];
        let mut rest = (at[count - 1] - course[long - 1]).dot(ahead).max(0.0);
        for k in (window / 3.0) as usize..reach {
            let mean = (sums[2 * k + 1] / (2 * k + 1) as f64).as_vec3();
            rest += mean.distance(before);
            before = mean;
        }
        rest += before.distance(course[0]);
        // How wide: off the axis across it, each place as often as the axis is long there.
        let (axis, from) = match several > 1.0 {
            true => (axis, from),
            false => (low_axis(&at, bends), 0),
        };
        let middle = CURL_MIDDLE.map(|u| (u * (count - 1) as f32).round() as usize);
        let (first, last) = (middle[0].max(from + 1), middle[1].min(from + axis.len() - 1));
        let (mut square, mut weight) = (0.0, 0.0);
        for k in first..last {
            let along = (axis[k + 1 - from] - axis[k - 1 - from]).normalize_or_zero();
            let gone = (at[k + 1] - at[k - 1]).dot(along).max(0.0);
            square +=
                gone * (at[k] - axis[k - from]).reject_from_normalized(along).length_squared();
            weight += gone;
        }
        Some(Self {
            diameter: 2.0 * (square / weight.max(1e-9)).sqrt(),
            pitch: span / turns.max(1e-3),
            shrinkage: 1.0 - (span + rest) / length,
        })
    }
}

/// How a hair turns about its axis.
struct Turning {
    /// Samples of a turn.
    window: f32,
    /// Turns counted.
    turned: f32,
    /// Whether it goes back at every turn.
    swings: bool,
    /// cm of the axis for a sample of the hair.
    axis_step: f32,
}

impl Turning {
    /// Turns counted about the axis over one turn, as often as it takes for both to agree, a turn being `window` samples at first.
    fn settled(at: &[Vec3], sums: &[glam::DVec3], mut window: f32) -> Option<Self> {
        let count = at.len();
        let mut found = None;
        for _ in 0..8 {
            let (axis, from) = axis(sums, window)?;
            let (turned, swings) = turns(&at[from..from + axis.len()], &axis, window);
            let turned = turned[turned.len() - 1];
            let next = axis.len() as f32 / turned.max(1e-3);
            // Waves are counted in a window of many before they are in one of one.
            let settled = (next - window).abs() < 0.01 * window;
            window = next.clamp(6.0, count as f32 / 2.5);
            let long: f32 = axis.windows(2).map(|w| w[0].distance(w[1])).sum();
            let axis_step = long / (axis.len() - 1) as f32;
            found = Some(Self { window, turned, swings, axis_step });
            if settled {
                break;
            }
        }
        found
    }
}

/// Sums up to each sample, so that a mean over any window is two look-ups.
fn sums(at: &[Vec3]) -> Vec<glam::DVec3> {
    let mut sums = vec![glam::DVec3::ZERO];
    for p in at {
        sums.push(sums[sums.len() - 1] + p.as_dvec3());
    }
    sums
}

/// Means over `window` samples, with the sample that the first belongs to. A mean cuts across where hair bends; how far shows
/// in the means themselves, and is put back.
fn axis(sums: &[glam::DVec3], window: f32) -> Option<(Vec<Vec3>, usize)> {
    let n = sums.len() - 1;
    let half = 0.5 * window;
    let first = half.ceil() as usize + 1;
    let last = n.checked_sub(first + 1)?;
    if last < first + 8 {
        return None;
    }
    // Between sums, as the window is no whole number of samples.
    let sum = |x: f32| {
        let k = (x.floor() as usize).min(n - 1);
        sums[k].lerp(sums[k + 1], f64::from(x - k as f32))
    };
    let mean = |k: usize| {
        let middle = k as f32 + 0.5;
        ((sum(middle + half) - sum(middle - half)) / f64::from(window)).as_vec3()
    };
    let means: Vec<Vec3> = (first..=last).map(mean).collect();
    let n = means.len();
    let reach = (half.round() as usize).min((n - 1) / 2).max(1);
    let bent = |k: usize| {
        let k = k.clamp(reach, n - 1 - reach);
        means[k + reach] - means[k] * 2.0 + means[k - reach]
    };
    let part = window * window / (24.0 * (reach * reach) as f32);
    Some(((0..n).map(|k| means[k] - bent(k) * part).collect(), first))
}

/// The axis of a few long turns: the polynomial of least squares, which bends as often as a head bends hair but seldomer than
/// the hair does. A mean over one turn takes part of the wave for axis where turns are not all alike, and there are too few to
/// take the mean over several: set beside what they were laid along, waves of four turns were measured 4 % too narrow by it
/// (single hairs 23 %); by this, 0 (7).
fn low_axis(at: &[Vec3], turns: f32) -> Vec<Vec3> {
    const OF_TURNS: f32 = 1.35;
    let degree = ((OF_TURNS * turns).round() as usize).clamp(3, 9);
    let n = at.len();
    let points: Vec<glam::DVec3> = at.iter().map(|p| p.as_dvec3()).collect();
    let mut fitted = vec![glam::DVec3::ZERO; n];
    let mut columns: Vec<Vec<f64>> = vec![];
    for k in 0..=degree {
        // The next power, and what is new in it; twice, for rounding.
        let x = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
        let mut column: Vec<f64> = match k {
            0 => vec![1.0; n],
            _ => (0..n).map(|i| columns[k - 1][i] * x(i)).collect(),
        };
        for known in columns.iter().chain(&columns) {
            let part: f64 = column.iter().zip(known).map(|(a, b)| a * b).sum();
            column.iter_mut().zip(known).for_each(|(a, b)| *a -= part * b);
        }
        let size = column.iter().map(|a| a * a).sum::<f64>().sqrt().max(1e-30);
        column.iter_mut().for_each(|a| *a /= size);
        let part: glam::DVec3 = points.iter().zip(&column).map(|(p, a)| *p * *a).sum();
        fitted.iter_mut().zip(&column).for_each(|(p, a)| *p += part * *a);
        columns.push(column);
    }
    fitted.into_iter().map(|p| p.as_vec3()).collect()
}

/// How often `at` has gone about its axis up to each sample, whichever way round; and whether it goes back at every turn, each
/// about `turn` samples long.
fn turns(at: &[Vec3], axis: &[Vec3], turn: f32) -> (Vec<f32>, bool) {
    let n = axis.len();
    let tangent =
        |k: usize| (axis[(k + 1).min(n - 1)] - axis[k.saturating_sub(1)]).normalize_or_zero();
    let mut before = tangent(0);
    let mut normal = crate::maths::frame::any_normal(before);
    let mut last: Option<Vec2> = None;
    let (mut angle, mut gone) = (0.0f32, Vec2::ZERO);
    // How far round up to each sample, one way less the other and both together.
    let mut net = Vec::with_capacity(n);
    let mut out = Vec::with_capacity(n);
    for k in 0..n {
        let along = tangent(k);
        if along != Vec3::ZERO {
            normal = carry(normal, before, along);
            before = along;
            let off = at[k] - axis[k];
            let here = Vec2::new(off.dot(normal), off.dot(along.cross(normal)));
            if let Some(last) = last {
                let step = atan2(last.perp_dot(here), last.dot(here));
                angle += step.abs();
                // What flies past the axis, as a wave does, goes neither way.
                gone += if step.abs() < 0.5 { Vec2::new(step, step.abs()) } else { Vec2::ZERO };
            }
            if here.length_squared() > 0.0 {
                last = Some(here);
            }
        }
        net.push(gone);
        out.push(angle / std::f32::consts::TAU);
    }
    // Of two turns that go back at every turn nothing is left; of two of which one in two goes back, half.
    let two = ((2.0 * turn).round() as usize).clamp(1, n - 1);
    let left = (0..n - two).map(|k| net[k + two] - net[k]);
    let left = left.fold(Vec2::ZERO, |sum, left| sum + Vec2::new(left.x.abs(), left.y));
    let swings = gone.y > 0.6 * angle && left.x < 0.3 * left.y;
    (out, swings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::transcendental::{cos, sin, sin_cos};

    fn of(points: &[Vec3]) -> Option<Curl> {
        Curl::of(&Spline::new(points).ok()?, points.len())
    }

    /// `turns` turns of a coil of this diameter and pitch, `per_turn` points each, round an axis that bends. Like a hair it
    /// begins on its axis and leaves it within half a turn.
    fn coil(diameter: f32, pitch: f32, turns: f32, per_turn: f32, bend: f32) -> Vec<Vec3> {
        let n = (turns * per_turn) as usize;
        (0..=n)
            .map(|k| {
                let turn = k as f32 / per_turn;
                let (s, c) = sin_cos(turn * std::f32::consts::TAU);
                let along = turn * pitch * bend;
                let (sb, cb) = sin_cos(along);
                let out = Vec3::new(cb, sb, 0.0);
                let radius = 0.5 * diameter * (2.0 * turn).min(1.0);
                out * (1.0 / bend + radius * c) + Vec3::Z * (radius * s)
            })
            .collect()
    }

    #[track_caller]
    fn check(points: &[Vec3], diameter: f32, pitch: f32, shrinkage: f32) {
        let curl = of(points).unwrap();
        let near = |found: f32, want: f32| (found / want - 1.0).abs() < 0.03;
        assert!(
            near(curl.diameter, diameter)
                && near(curl.pitch, pitch)
                && near(curl.shrinkage, shrinkage),
            "{curl:?}, not {diameter} {pitch} {shrinkage}"
        );
    }

    #[test]
    fn a_coil_measures_what_it_is() {
        for (d, p, turns, bend) in [
            (0.5, 0.7, 20.0, 1e-3),
            (1.5, 3.0, 6.0, 1e-3),
            (0.3, 0.25, 60.0, 1e-3),
            (2.5, 6.0, 4.0, 1e-3),
            (0.5, 0.7, 20.0, 0.1),
            // Wider than their pitch: about a mean over half a turn too many, fewer turns are counted than there are.
            (1.6, 1.3, 4.0, 1e-3),
            (1.6, 1.3, 8.0, 1e-3),
        ] {
            let fine = coil(d, p, turns, 96.0, bend);
            let length: f32 = fine.windows(2).map(|w| w[0].distance(w[1])).sum();
            check(&coil(d, p, turns, 12.0, bend), d, p, 1.0 - turns * p / length);
        }
    }

    #[test]
    fn curls_of_which_too_few_turn_often_enough_are_not_judged() {
        let judged = |measured: usize, curled: usize| {
            let none = [0.0; 3];
            let curls = Curls {
                curled,
                measured,
                diameter_ratio: none,
                pitch_ratio: none,
                shrinkage_ratio: None,
                diameter_cm: 0.0,
                pitch_cm: 0.0,
                shrinkage: 0.0,
            };
            curls.can_be_judged()
        };
        for (measured, curled, want) in
            [(0, 1500, false), (8, 1500, false), (20, 1500, true), (3, 3, true), (0, 3, false)]
        {
            assert_eq!(judged(measured, curled), want, "{measured} of {curled}");
        }
    }

    #[test]
    fn a_wave_measures_its_height_times_the_root_of_two() {
        let wave = |k: usize| {
            let turn = k as f32 / 16.0;
            Vec3::new(sin(turn * std::f32::consts::TAU) * 0.7, -5.0 * turn, 0.0)
        };
        let points: Vec<Vec3> = (0..=100).map(wave).collect();
        let curl = of(&points).unwrap();
        assert!((curl.diameter / (2.0 * 0.7 / 2f32.sqrt()) - 1.0).abs() < 0.04, "{curl:?}");
        assert!((curl.pitch / 5.0 - 1.0).abs() < 0.04, "{curl:?}");
    }

    #[test]
    fn switchbacks_are_counted_on() {
        let mut points = vec![];
        let mut angle = 0.0f32;
        for k in 0..400 {
            angle += if (k / 60) % 2 == 0 { 0.5 } else { -0.5 };
            points.push(Vec3::new(0.25 * cos(angle), -0.05 * k as f32, 0.25 * sin(angle)));
        }
        let curl = of(&points).unwrap();
        let pitch = 0.05 * std::f32::consts::TAU / 0.5;
        assert!((curl.pitch / pitch - 1.0).abs() < 0.06, "{curl:?} {pitch}");
    }

    /// Turns of a curl 0.5 cm wide, `pitch` cm each, of which `back` says whether it goes against the last.
    fn turning(turns: usize, pitch: f32, back: impl Fn(usize) -> bool) -> Vec<Vec3> {
        let (mut hand, mut angle, mut points) = (1.0f32, 0.0f32, vec![]);
        for k in 0..turns * 24 {
            if k > 0 && k % 24 == 0 && back(k / 24) {
                hand = -hand;
            }
            points.push(
                Vec3::new(cos(angle), 0.0, sin(angle)) * 0.25 - Vec3::Y * (pitch * k as f32 / 24.0),
            );
            angle += hand * std::f32::consts::TAU / 24.0;
        }
        points
    }

    #[test]
    fn a_curl_that_goes_back_at_every_turn_is_told_from_one_that_does_at_some() {
        // By which the axis is read; the width of either is that of its turns, off an axis that swings or does not.
        let swings = |points: &[Vec3]| {
            let count = points.len();
            let window = 24.0;
            let (axis, from) = axis(&sums(points), 2.0 * window).unwrap();
            assert!(axis.len() > count / 2);
            turns(&points[from..from + axis.len()], &axis, window).1
        };
        for n in [8, 20, 40] {
            assert!(swings(&turning(n, 0.7, |_| true)), "{n} turns, back at every one");
            assert!(!swings(&turning(n, 0.7, |_| false)), "{n} turns one way");
            assert!(
                !swings(&turning(n, 0.7, |k| k.is_multiple_of(2))),
                "{n} turns, back at every other"
            );
            let at_random = |k: usize| (k * 7_919 % 31).is_multiple_of(2);
            assert!(!swings(&turning(n, 0.7, at_random)), "{n} turns, back at half of them");
        }
    }

    #[test]
    fn straight_hair_has_no_curl() {
        let straight: Vec<Vec3> = (0..20).map(|k| Vec3::Y * k as f32).collect();
        assert!(of(&straight).is_none());
        assert!(of(&[Vec3::ZERO, Vec3::ZERO]).is_none());
    }
}
