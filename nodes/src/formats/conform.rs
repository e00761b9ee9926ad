//! Curves as other tools read them: resampled until both readings of Catmull-Rom splines are the same hair.
//!
//! Other readers take `catmullRom` as uniform, coif means centripetal (methods.md 0). [`conform`] resamples the curves for
//! which the two differ by more than [`AGREE`], each until they agree.
//!
//! Guarantees: both ends of a curve stay, all other points are new ones of the same curve, as far out of the skin as it
//! allows. Where no points of the same curve do, which is where the skin makes it leap or kink (an ear between two points),
//! the stretch about that place is eased: it leaves the curve it was, and stays out of the skin. Not promised: that easing
//! is enough where a curve leaps farther than it has points to go slower; the report gives the difference that is left. How hard
//! is tried hangs from how many of the curves given at once ask for it, so what few curves get, many may not.

use crate::data::attributes::{self as a, Domain};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::lead::Torn;
use crate::data::scalp::Skin;
use crate::maths::spline::{Place, Spline};
use crate::shape::resample::between;
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Curves as other tools will read them, and how far the two readings differ.
#[derive(Clone, Debug)]
pub struct Conformed {
    /// The curves, resampled where needed. Tufts that need nothing are the same.
    pub curves: Curves,
    /// How many curves were resampled.
    pub resampled: usize,
    /// The largest distance between the two readings, cm.
    pub difference: f32,
    /// Curves of fewer than two points, which no format holds: left out.
    pub left_out: usize,
}

/// The largest distance between the two readings of a curve that is let pass, cm (methods.md 0).
pub const AGREE: f32 = 1e-3;

/// Resamples the curves whose uneven CVs would be read as another curve elsewhere: both ends stay, all other points are new
/// ones of the same curve, as far out of `skin` as it allows. A curve that passes through a thin part of the skin, such as an
/// ear, between its CVs is led round it.
pub fn conform(curves: &Curves, skin: Option<Skin>, for_each: crate::eval::ForEach) -> Conformed {
    let all = |tufts: &[usize], effort: Effort| -> Vec<Done> {
        let cells: Vec<OnceLock<Done>> = tufts.iter().map(|_| OnceLock::new()).collect();
        for_each(cells.len(), &|i| {
            let _ = cells[i].set(conform_tuft(&curves.tufts()[tufts[i]], skin.as_ref(), effort));
        });
        cells.into_iter().filter_map(|cell| cell.into_inner()).collect()
    };
    let every: Vec<usize> = (0..curves.tufts().len()).collect();
    let mut done = all(&every, Effort::NONE);
    // How hard each curve that still differs is tried hangs from how many there are: not on how many threads find them.
    // Few are left of many, and these are tried again with all that the many had.
    let mut differ = every;
    for most in Effort::MOST {
        differ.retain(|i| done[*i].differ > 0);
        let left = done.iter().map(|done| done.differ).sum();
        if left == 0 {
            break;
        }
        let effort = Effort::of(left, most);
        for (i, again) in differ.iter().zip(all(&differ, effort)) {
            done[*i] = again;
        }
    }
    let mut out =
        Conformed { curves: Curves::default(), resampled: 0, difference: 0.0, left_out: 0 };
    let mut tufts = vec![];
    for done in done {
        tufts.push(done.tuft);
        out.resampled += done.resampled;
        out.difference = out.difference.max(done.difference);
        out.left_out += done.left_out;
    }
    out.curves = Curves::new(tufts);
    out
}

/// How many times as many segments a resampled curve is given, and from what on it is first led round what the skin tears it
/// at: tried in turn until both readings agree. More points do not mend a torn curve, and fewer only where it leaps little.
const TRIES: [(f32, Option<Torn>); 7] = [
    (1.0, None),
    (1.25, None),
    (1.0, Some(Torn::APART)),
    (1.25, Some(Torn::APART)),
    (1.0, Some(Torn::UNEVEN)),
    (1.25, Some(Torn::UNEVEN)),
    (2.0, Some(Torn::UNEVEN)),
];
/// How often a curve is eased and made even again.
const EASINGS: usize = 24;
/// How many of the tries, those that differ least, easing starts from until one agrees.
const STARTS: usize = 3;
/// How much readings differ, points, and where these lie on the old curve: arc length and place.
type Tried = (f32, Vec<Vec3>, Vec<(f32, Place)>);
/// As few segments as chords of the length of the longest need are tried last, but no fewer than such a share.
const FEWEST: f32 = 0.6;
/// What may be tried on each curve whose readings still differ when its points are even.
#[derive(Clone, Copy)]
struct Effort {
    /// Whether it is led round what the skin tears it at.
    leads: bool,
    /// How many moves of a point easing may take.
    moves: usize,
}

impl Effort {
    const NONE: Self = Self { leads: false, moves: 0 };
    /// Moves for all curves together: a minute of one core.
    const ALL: usize = 200_000_000;
    /// For one of them, each time that what is left is tried again.
    const MOST: [usize; 3] = [2_000_000, 2_000_000, 8_000_000];
    /// So many curves are led: each may take a twentieth of a second.
    const LED: usize = 4_000;

    /// For each of so many curves. A smooth head tears a few hundred at its ears, the folds of a rough scan most of them.
    fn of(curves: usize, most: usize) -> Self {
        let moves = (Self::ALL / curves.max(1)).min(most);
        Self { leads: curves <= Self::LED, moves }
    }
}

/// The most points that resampling gives a curve: what game engines take. Where that is not enough, the difference that is
/// left is told.
pub const MOST_POINTS: usize = 255;
/// Rounds in which chords are made alike.
const ROUNDS: usize = 16;
/// Rounds after which they are made so at half the pace: where a curve turns by a right angle from point to point, a full
/// step oversteps.
const QUICK: usize = 8;
/// Chords within this ratio are alike.
const ALIKE: f32 = 1.01;

/// What [`conform`] has made of a tuft.
struct Done {
    tuft: Arc<Tuft>,
    resampled: usize,
    difference: f32,
    left_out: usize,
    /// Curves of which the two readings still differ.
    differ: usize,
}

fn conform_tuft(tuft: &Arc<Tuft>, skin: Option<&Skin>, effort: Effort) -> Done {
    let mut worst = 0.0f32;
    let mut change = vec![false; tuft.len()];
    let mut left_out = 0;
    for (i, change) in change.iter_mut().enumerate() {
        let points = tuft.curve(i);
        if points.len() < 2 {
            left_out += 1;
            continue;
        }
        let difference = readings_differ(points);
        if difference > AGREE {
            *change = true;
        } else {
            worst = worst.max(difference);
        }
    }
    if left_out == 0 && !change.contains(&true) {
        return Done { tuft: tuft.clone(), resampled: 0, difference: worst, left_out, differ: 0 };
    }
    let allowed = tuft.view(a::ALLOW_DEPTH);
    let mut out = TuftBuilder::new();
    let (mut kept, mut places, mut points, mut stops) = (vec![], vec![], vec![], vec![]);
    let (mut spline, mut led) = (Spline::default(), Spline::default());
    let (mut resampled, mut differ) = (0, 0);
    for (i, change) in change.into_iter().enumerate() {
        let old = tuft.curve(i);
        if old.len() < 2 {
            continue;
        }
        kept.push(i as u32);
        let first = tuft.offsets()[i];
        if !change || spline.rebuild(old).is_err() {
            let last = old.len() - 1;
            places.extend((0..=last).map(|k| {
                let span = k.min(last - 1);
                (first + span as u32, (k - span) as f32)
            }));
            out.push_curve(old);
            continue;
        }
        resampled += 1;
        // As the attribute will be read at the new points.
        let depth = |place: Place| {
            let at = |k: usize| allowed.at(i, first as usize + place.span + k);
            at(0) + (at(1) - at(0)) * place.t
        };
        let clear = |p: Vec3, place| skin.map_or(p, |skin| skin.push_out(p, depth(place)).0);
        // Points of the curve that others stand for, which lie where `stops` say, made even along these others.
        let mut evened = |points: &mut Vec<Vec3>, stops: &mut Vec<(f32, Place)>| {
            if led.rebuild(points).is_err() {
                return false;
            }
            let (root, tip, last) = (old[0], old[old.len() - 1], points.len() - 1);
            let was: Vec<f32> = stops.iter().map(|(s, _)| *s).collect();
            let before = |place: Place| {
                let (a, b) = (was[place.span], was[place.span + 1]);
                a + (b - a) * place.t
            };
            alike_chords(&led, last, stops, points, |k, place| match k {
                0 => root,
                k if k == last => tip,
                _ => clear(led.point(place), spline.locate_length(before(place))),
            });
            stops.iter_mut().for_each(|(s, place)| {
                *s = before(*place);
                *place = spline.locate_length(*s);
            });
            true
        };
        let mut tried: Vec<Tried> = vec![];
        for (finer, lead) in TRIES.into_iter().chain([(0.0, Some(Torn::UNEVEN))]) {
            let finer = if finer > 0.0 { finer } else { mean_of_longest(&points).max(FEWEST) };
            let last = ((old.len() - 1) as f32 * finer) as usize;
            let last = last.min((MOST_POINTS - 1).max(old.len() - 1));
            if lead.is_some() && !effort.leads {
                continue;
            }
            if let (Some(torn), Some(skin)) = (lead, skin) {
                let plain = |_, place| spline.point(place);
                alike_chords(&spline, last, &mut stops, &mut points, plain);
                skin.clear_beyond(torn, &mut points, |k| Some(depth(stops[k].1)));
                if !evened(&mut points, &mut stops) {
                    break;
                }
            } else {
                alike_chords(&spline, last, &mut stops, &mut points, |k, place| match k {
                    0 => old[0],
                    k if k == last => old[old.len() - 1],
                    _ => clear(spline.point(place), place),
                });
            }
            let left = readings_differ(&points);
            tried.push((left, points.clone(), stops.clone()));
            if left <= AGREE {
                break;
            }
        }
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.dedup_by(|a, b| a.1 == b.1);
        let mut best = tried[0].clone();
        let mut moves = effort.moves;
        for (_, start, its_stops) in tried.into_iter().take(STARTS) {
            (points, stops) = (start, its_stops);
            for _ in 0..EASINGS {
                if best.0 <= AGREE || moves == 0 {
                    break;
                }
                ease(&mut points, &mut moves, |k| depth(stops[k].1), skin);
                // Easing moves points together, which makes chords uneven again.
                for even in [false, true] {
                    if even && !evened(&mut points, &mut stops) {
                        break;
                    }
                    let left = readings_differ(&points);
                    if left < best.0 {
                        best = (left, points.clone(), stops.clone());
                    }
                }
            }
        }
        (_, points, stops) = best;
        places.extend(stops.iter().map(|(_, place)| (first + place.span as u32, place.t)));
        let left = readings_differ(&points);
        worst = worst.max(left);
        differ += usize::from(left > AGREE);
        out.push_curve(&points);
    }
    for attribute in tuft.attributes() {
        let values = match attribute.domain {
            Domain::Curve => attribute.values.gather(&kept),
            Domain::Point => between(&attribute.values, &places),
        };
        out.set_column(a::Attribute { values, ..attribute.clone() });
    }
    Done { tuft: Arc::new(out.build()), resampled, difference: worst, left_out, differ }
}

/// The mean chord of a curve as a share of the longest.
fn mean_of_longest(points: &[Vec3]) -> f32 {
    let chords = points.windows(2).map(|w| w[0].distance(w[1]));
    let (sum, longest) = chords.fold((0.0f32, 0.0f32), |(sum, most), c| (sum + c, most.max(c)));
    sum / ((points.len() - 1) as f32 * longest).max(f32::MIN_POSITIVE)
}

/// `last` + 1 points of the spline whose chords are so much alike that both readings agree, and where they lie on it (arc
/// length and place): through such points both are one curve, however sharply it bends; points at even arc length have
/// shorter chords where it bends. `point` gives the point of a place, which may have to keep clear of the skin.
fn alike_chords(
    spline: &Spline,
    last: usize,
    stops: &mut Vec<(f32, Place)>,
    points: &mut Vec<Vec3>,
    point: impl Fn(usize, Place) -> Vec3,
) {
    // Places the points at these arc lengths; gives the longest chord over the shortest.
    let sample = |wanted: &[f32], stops: &mut Vec<(f32, Place)>, points: &mut Vec<Vec3>| -> f32 {
        let mut cursor = 0;
        stops.clear();
        stops.extend(wanted.iter().map(|s| (*s, spline.locate_rising(&mut cursor, *s))));
        points.clear();
        points.extend(stops.iter().enumerate().map(|(k, (_, place))| point(k, *place)));
        let chords = points.windows(2).map(|w| w[0].distance(w[1]));
        let (least, most) = chords.fold((f32::MAX, 0.0f32), |(a, b), c| (a.min(c), b.max(c)));
        most / least.max(1e-9)
    };
    let mut wanted: Vec<f32> =
        (0..=last).map(|k| k as f32 / last as f32 * spline.length()).collect();
    // Where the skin makes a curve leap, more points make no shorter chords: the best round counts.
    let mut best = (f32::MAX, wanted.clone());
    for round in 0..ROUNDS {
        let ratio = sample(&wanted, stops, points);
        if ratio <= ALIKE || readings_differ(points) <= AGREE {
            return;
        }
        if ratio < best.0 {
            best = (ratio, wanted.clone());
        }
        // What arc length has come where the chords have come to their even share.
        let total: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let (mut k, mut come) = (0, 0.0);
        for (n, stop) in wanted.iter_mut().enumerate().take(last).skip(1) {
            let share = total * n as f32 / last as f32;
            while k + 1 < last && come + points[k].distance(points[k + 1]) < share {
                come += points[k].distance(points[k + 1]);
                k += 1;
            }
            let chord = points[k].distance(points[k + 1]);
            let part = if chord > 0.0 { ((share - come) / chord).clamp(0.0, 1.0) } else { 0.0 };
            let even = stops[k].0 + (stops[k + 1].0 - stops[k].0) * part;
            *stop += (even - *stop) * if round < QUICK { 1.0 } else { 0.5 };
        }
    }
    if sample(&wanted, stops, points) > best.0 {
        sample(&best.1, stops, points);
    }
}

/// How many points to either side of a place where readings differ are eased, and how far they are lifted off the skin there
/// (cm), over edges that would hold them apart: tried in turn until they agree.
const REACHES: [(usize, f32); 5] = [(4, 0.0), (8, 0.06), (16, 0.15), (32, 0.3), (64, 0.6)];
/// Easing goes on for so many times the square of that, as far as evening out spreads.
const SPREAD: usize = 2;
/// No easing moves more points than this, or than such a share of all there may be, before chords are made even again.
const MOST_MOVES: usize = 32_000;
const SHARE: usize = 48;

/// Eases the points about the spans where readings differ towards the middle of their neighbours, the nearer the more, and
/// out of the skin: chords and turns are then shared by many spans. Where that does not make readings agree, the points
/// are those for which they differ least.
fn ease(
    points: &mut Vec<Vec3>,
    moves: &mut usize,
    depth: impl Fn(usize) -> f32,
    skin: Option<&Skin>,
) {
    let n = points.len();
    let mut best = (readings_differ(points), points.clone());
    let least = moves.saturating_sub(MOST_MOVES.max(*moves / SHARE));
    'all: for (reach, lift) in REACHES {
        let mut weights = vec![0.0f32; n];
        each_span(points, |span, difference| {
            if difference <= AGREE {
                return;
            }
            let end = (span + 2 + reach).min(n - 1);
            for (k, weight) in weights.iter_mut().enumerate().take(end).skip(1) {
                let off = span.saturating_sub(k).max(k.saturating_sub(span + 1));
                *weight = weight.max(1.0 - off as f32 / (reach + 1) as f32);
            }
        });
        for round in 1..=SPREAD * reach * reach {
            if *moves <= least {
                break 'all;
            }
            for k in (1..n - 1).filter(|k| weights[*k] > 0.0) {
                *moves = moves.saturating_sub(1);
                let middle = (points[k - 1] + points[k + 1]) * 0.5;
                let p = points[k] + (middle - points[k]) * (0.5 * weights[k]);
                let least = depth(k) - lift * weights[k];
                points[k] = skin.map_or(p, |skin| skin.push_out(p, least).0);
            }
            if round % reach != 0 {
                continue;
            }
            let left = readings_differ(points);
            if left <= AGREE {
                return;
            }
            if left < best.0 {
                best = (left, points.clone());
            }
        }
    }
    *points = best.1;
}

/// The largest distance, cm, between the uniform and the centripetal Catmull-Rom spline through the points: the two have the
/// same ends in each span and differ in their tangents there. Sliding along the curve counts nothing.
pub fn readings_differ(points: &[Vec3]) -> f32 {
    let mut worst = 0.0f32;
    each_span(points, |_, difference| worst = worst.max(difference));
    worst
}

/// [`readings_differ`] of each span; where it is no more than [`AGREE`], not less than it is.
fn each_span(points: &[Vec3], mut found: impl FnMut(usize, f32)) {
    let n = points.len();
    let knot = |i: usize| points[i].distance(points[i + 1]).sqrt();
    // Tangents at the inner point `i`, whose segments have the knots `a` and `b`: per unit of the centripetal
    // parameter, and of the uniform one.
    let tangents = |i: usize, a: f32, b: f32| -> (Vec3, Vec3) {
        let (p0, p1, p2) = (points[i - 1], points[i], points[i + 1]);
        let centripetal = if a > 0.0 && b > 0.0 {
            (p1 - p0) / a - (p2 - p0) / (a + b) + (p2 - p1) / b
        } else {
            Vec3::ZERO
        };
        (centripetal, (p2 - p0) * 0.5)
    };
    let mut before = None;
    let mut d = if n > 1 { knot(0) } else { 0.0 };
    for i in 0..n.saturating_sub(1) {
        let next = if i + 2 < n { knot(i + 1) } else { 0.0 };
        let after = (i + 2 < n).then(|| tangents(i + 1, d, next));
        let delta = |t: Option<(Vec3, Vec3)>| t.map_or(Vec3::ZERO, |(c, u)| c * d - u);
        let (d1, d2) = (delta(before), delta(after));
        // 4/27 is the largest value of either Hermite basis.
        let bound = (d1.length() + d2.length()) * (4.0 / 27.0);
        if bound > AGREE && d > 0.0 {
            let chord = points[i + 1] - points[i];
            let (m1, m2) = (before.map_or(chord, |(_, u)| u), after.map_or(chord, |(_, u)| u));
            let mut worst = 0.0f32;
            for t in [0.2f32, 0.4, 0.6, 0.8] {
                let gap = d1 * (t * (1.0 - t) * (1.0 - t)) - d2 * (t * t * (1.0 - t));
                let along = chord * (6.0 * t * (1.0 - t))
                    + m1 * (1.0 - 4.0 * t + 3.0 * t * t)
                    + m2 * (3.0 * t * t - 2.0 * t);
                let slide = along * (gap.dot(along) / along.length_squared().max(1e-20));
                worst = worst.max((gap - slide).length());
            }
            found(i, worst);
        } else {
            found(i, bound.min(AGREE));
        }
        (before, d) = (after, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::attributes::ID;
    use crate::data::scalp::tests::in_order;

    fn curves(lists: &[&[Vec3]]) -> Curves {
        let mut b = TuftBuilder::new();
        lists.iter().for_each(|points| b.push_curve(points));
        b.set(ID, Domain::Curve, (1..=lists.len() as u64).collect());
        Curves::new(vec![Arc::new(b.build())])
    }

    #[test]
    fn uneven_curves_are_resampled_until_both_readings_agree_and_even_ones_are_left() {
        let uneven = [0.0, 0.2, 3.0, 3.3, 7.0f32].map(|x| Vec3::new(x, (x * x) * 0.2, 0.0));
        let even = [0.0, 1.0, 2.0, 3.0f32].map(|x| Vec3::new(x, x * 0.1, 0.0));
        let before = curves(&[&uneven, &even, &[Vec3::ONE]]);
        assert!(readings_differ(&uneven) > 0.05);
        let after = conform(&before, None, &in_order);
        assert_eq!((after.resampled, after.left_out), (1, 1));
        assert!(after.difference <= AGREE, "{}", after.difference);
        let tuft = &after.curves.tufts()[0];
        assert_eq!(tuft.curve(1), even);
        assert_eq!(
            (tuft.curve(0)[0], tuft.curve(0)[tuft.curve(0).len() - 1]),
            (uneven[0], uneven[4])
        );
        let again = conform(&after.curves, None, &in_order);
        assert!(Arc::ptr_eq(&again.curves.tufts()[0], tuft), "what agrees is not copied");
    }

    #[test]
    fn hairpins_and_coarse_coils_are_read_alike_after_resampling() {
        let hairpin: Vec<Vec3> = (0..40)
            .map(|k| Vec3::new(4.0 - (k as f32 - 19.7).abs() * 0.2, 0.05 * k as f32, 0.0))
            .collect();
        let coil: Vec<Vec3> = (0..200)
            .map(|k| {
                let k = k as f32 + 0.35 * ((k % 3) as f32);
                let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k * 0.13);
                Vec3::new(cos * 0.2, k * 0.02, sin * 0.2)
            })
            .collect();
        for curve in [hairpin, coil] {
            assert!(readings_differ(&curve) > 3.0 * AGREE, "{}", readings_differ(&curve));
            let after = conform(&curves(&[&curve]), None, &in_order);
            assert!(after.difference <= AGREE, "{}", after.difference);
            let points = after.curves.tufts()[0].curve(0);
            assert!(points.len() <= MOST_POINTS && points[0] == curve[0], "{}", points.len());
        }
    }

    #[test]
    fn many_curves_share_what_few_have_to_themselves() {
        let check = |curves, leads, moves| {
            let effort = Effort::of(curves, Effort::MOST[0]);
            assert_eq!((effort.leads, effort.moves), (leads, moves), "{curves}");
        };
        check(0, true, 2_000_000);
        check(100, true, 2_000_000);
        check(4_000, true, 50_000);
        check(40_000, false, 5_000);
    }

    #[test]
    fn a_leap_is_shared_by_many_spans() {
        // As the skin leaves a hair that it tears: even chords, one five times as long, across the way.
        let mut torn: Vec<Vec3> = (0..60).map(|k| Vec3::new(0.0, -0.2 * k as f32, 0.0)).collect();
        torn[30..].iter_mut().for_each(|p| *p += Vec3::new(1.0, 0.2, 0.0));
        let before = readings_differ(&torn);
        assert!(before > 0.01, "{before}");
        let mut eased = torn.clone();
        let mut moves = usize::MAX;
        ease(&mut eased, &mut moves, |_| 0.0, None);
        assert!(readings_differ(&eased) <= AGREE, "{}", readings_differ(&eased));
        let moved: Vec<f32> = eased.iter().zip(&torn).map(|(a, b)| a.distance(*b)).collect();
        assert!(moved[..10].iter().chain(&moved[50..]).all(|m| *m == 0.0), "{moved:?}");
    }
}
