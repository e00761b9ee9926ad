//! Where hair that is being made may lie: what nodes ask that grow it, lay it or comb it point by point.
//!
//! A maker knows why a point goes where it goes, and holds it out of the skin as it goes on. These are its steps; each is a wish of one
//! point or one whole hair. They write no hair: who moves hair that exists goes by [`Route`](super::Route).
//!
//! Guarantees: a point or hair ends no lower than asked, as far as the skin's patience goes; what is high enough stays, to the last bit.
//! Not promised: that what is made keeps to its section, which [`Home::lead`] is for; a test over all nodes holds makers to it.
//!
//! [`Home::lead`]: super::section_guard::Home::lead

use super::clearance::Clearance;
use super::drawn::Dip;
use super::skin_clear::Torn;
use crate::data::skin::Skin;
use crate::maths::spline::Spline;
use glam::Vec3;
use std::ops::Range;

/// Rounds of spacing a hair evenly.
const EVENINGS: usize = 4;

/// `p`, or where it is lower, the nearest point at a height (cm, negative: a depth that is allowed) over the skin; and whether it was
/// moved.
#[inline]
pub(crate) fn lift(skin: &Skin, p: Vec3, height: f32) -> (Vec3, bool) {
    skin.lift(p, height)
}

/// [`lift`] of the points of a hair in `which`, each by its number to its own height, and of what is drawn between them; where that spoils
/// their spacing, they are spaced evenly again. The other points stay.
pub(crate) fn lift_each(
    skin: &Skin,
    hair: &mut [Vec3],
    which: Range<usize>,
    height: impl Fn(usize) -> f32,
) {
    let moved = lift_points(skin, hair, which.clone(), &height);
    let clearance = Clearance::unknown();
    settle_evenly(skin, hair, which, height, (moved, clearance), &mut Spline::default());
}

/// [`lift_each`] that leaves the spacing as it comes.
pub(crate) fn lift_drawn(
    skin: &Skin,
    hair: &mut [Vec3],
    which: Range<usize>,
    height: impl Fn(usize) -> f32,
) {
    lift_points(skin, hair, which.clone(), &height);
    skin.clear_drawn(hair, |k| which.contains(&k), |k| -height(k));
}

/// [`lift`] of points; tells whether any was moved.
fn lift_points(
    skin: &Skin,
    hair: &mut [Vec3],
    which: Range<usize>,
    height: impl Fn(usize) -> f32,
) -> bool {
    let mut any = false;
    for k in which {
        let (lifted, moved) = skin.lift(hair[k], height(k));
        hair[k] = lifted;
        any |= moved;
    }
    any
}

/// Spaces the points of a hair in `which` evenly if lifting them `moved` any, and sets out of the skin what is drawn between them, spacing
/// them again where that spoils it. Spans that are clear by `clearance` are skipped if no point was
/// moved. Tells whether any was moved.
fn settle_evenly(
    skin: &Skin,
    hair: &mut [Vec3],
    which: Range<usize>,
    height: impl Fn(usize) -> f32,
    (moved, clearance): (bool, Clearance),
    spline: &mut Spline,
) -> bool {
    let [points, drawn] = [false, true];
    // What is drawn between points costs more than they do, so they are settled first.
    if moved {
        space_evenly(skin, hair, which.clone(), &height, points, spline);
    }
    let is_off = |points: &[Vec3], k: usize| !moved && clearance.of_span(points, k, 0.0);
    let led = skin.clear_drawn_where(hair, |k| which.contains(&k), |k| -height(k), is_off);
    if led {
        space_evenly(skin, hair, which, height, drawn, spline);
    }
    moved || led
}

/// Spaces the points of a hair in `which` evenly between those beside them, and lifts them again, with what is `drawn` between them or
/// not, as long as that helps. The tip stays.
fn space_evenly(
    skin: &Skin,
    hair: &mut [Vec3],
    which: Range<usize>,
    height: impl Fn(usize) -> f32,
    drawn: bool,
    spline: &mut Spline,
) {
    let Some(first) = which.start.checked_sub(1).filter(|_| !skin.is_rough()) else { return };
    let end = which.end.min(hair.len() - 1);
    let hair = &mut hair[first..=end];
    for _ in 0..EVENINGS {
        if is_even(hair) || spline.rebuild(hair).is_err() {
            break;
        }
        let last = hair.len() - 1;
        for (k, p) in hair.iter_mut().enumerate().take(last).skip(1) {
            *p = spline.at(k as f32 / last as f32);
        }
        lift_points(skin, hair, 1..last, |k| height(first + k));
        if drawn {
            skin.clear_drawn(hair, |k| (1..last).contains(&k), |k| -height(first + k));
        }
    }
}

/// Sets what is drawn between the points of a hair out of the skin, all but its root free to move; `depth` says how deep (cm) each may
/// lie.
pub(crate) fn clear_drawn(skin: &Skin, hair: &mut [Vec3], depth: impl Fn(usize) -> f32) -> bool {
    skin.clear_drawn(hair, |k| k > 0, depth)
}

/// Where what is drawn between the points of a hair dips into the skin, deeper (cm) than its ends may lie.
pub(crate) fn dips(skin: &Skin, hair: &[Vec3], depth: impl Fn(usize) -> f32) -> Vec<Dip> {
    let mut dips = vec![];
    skin.dips(hair, |_| true, depth, |dip| dips.push(dip));
    dips
}

/// Whether there is such a place.
pub(crate) fn has_dip(skin: &Skin, hair: &[Vec3], depth: impl Fn(usize) -> f32) -> bool {
    skin.has_dip(hair, depth)
}

/// How much deeper than it may the deepest such place lies, cm; 0 without one.
pub(crate) fn deepest_dip(skin: &Skin, hair: &[Vec3], depth: impl Fn(usize) -> f32) -> f32 {
    dips(skin, hair, depth).iter().map(|dip| dip.excess).fold(0.0, f32::max)
}

/// [`lift`] of all that [`Skin::distance`] tells to be lower: beside ears and among folds the field alone may pass over a thin wall,
/// and what is put out of one may end in another. Where the skin is near it costs a search more.
pub(crate) fn lift_exactly(skin: &Skin, p: Vec3, height: f32) -> (Vec3, bool) {
    skin.lift_exactly(p, height)
}

/// [`lift`] as far as the field knows, which is right to half a cell: for rounds that come nearer and nearer.
#[inline]
pub(crate) fn lift_about(skin: &Skin, p: Vec3, height: f32) -> Vec3 {
    skin.lift_about(p, height)
}

/// Sets a whole hair clear of the skin, all but its first point, and leads it round what would tear it; where that spoils its spacing, it
/// is spaced evenly again. `depth` says how deep (cm) each may lie; none where a point is known to be clear. Tells whether any was moved.
pub(crate) fn clear(
    skin: &Skin,
    points: &mut [Vec3],
    depth: impl Fn(usize) -> Option<f32>,
) -> bool {
    clear_noting(skin, points, -1, depth, |_| 0.0, |_, _, _| {})
}

/// [`clear`] for points whose distances from the skin are known to be at least `off` (cm; 0 if unknown), of a hair that is rooted on
/// `root_triangle` (-1 if unknown). On a mesh where each point asks the
/// skin alone, `note` receives each ball without skin that is found: the point's index, the centre and the radius (cm).
pub(crate) fn clear_noting(
    skin: &Skin,
    points: &mut [Vec3],
    root_triangle: i32,
    depth: impl Fn(usize) -> Option<f32>,
    off: impl Fn(usize) -> f32,
    note: impl FnMut(usize, Vec3, f32),
) -> bool {
    let height = |k: usize| -depth(k).unwrap_or(0.0);
    let view = points.first().and_then(|root| skin.view_from(*root, root_triangle));
    let clearance = Clearance::new(skin, points.len(), off).seen(view);
    let is_off = |points: &[Vec3], k: usize| clearance.of_point(points, k, height(k));
    let moved = skin.clear_noting(points, &depth, is_off, note);
    let clearance = if moved { Clearance::unknown() } else { clearance };
    settle_evenly(skin, points, 1..points.len(), height, (moved, clearance), &mut Spline::default())
}

/// [`clear`] that leads round whatever tears the hair so far.
pub(crate) fn clear_beyond(
    skin: &Skin,
    far: Torn,
    points: &mut [Vec3],
    depth: impl Fn(usize) -> Option<f32>,
) -> bool {
    skin.clear_beyond(far, points, depth)
}

/// The shortest way from `middle` out of a thin part, across a hair that runs `along` and whose points were torn apart along `through`.
pub(crate) fn way_out(skin: &Skin, middle: Vec3, through: Vec3, along: Vec3) -> Option<Vec3> {
    skin.way_out(middle, through, along)
}

/// Sets a hair of even chords clear of the skin, but for points that are known not to be `near` it. Where one was moved, each chord gets
/// its length once more, from the root on, the hair is cleared again, and spaced evenly where the skin disturbed that.
pub(crate) fn rest_evenly(
    skin: &Skin,
    points: &mut [Vec3],
    near: &[bool],
    depth: f32,
    spline: &mut Spline,
) {
    let may_be = |k: usize| near[k].then_some(depth);
    if !(1..points.len()).any(|k| near[k] && skin.push_out(points[k], depth).1) {
        return;
    }
    let chords: Vec<f32> = points.windows(2).map(|w| w[0].distance(w[1])).collect();
    // What a tight turn leads through an ear shows between points alone.
    skin.clear(points, may_be);
    skin.clear_drawn(points, |k| k > 0 && near[k], |_| depth);
    for k in 1..points.len() {
        let along = (points[k] - points[k - 1]).normalize_or_zero();
        points[k] = points[k - 1] + along * chords[k - 1];
    }
    skin.clear(points, |_| Some(depth));
    skin.clear_drawn(points, |k| k > 0, |_| depth);
    space_evenly(skin, points, 1..points.len(), |_| -depth, true, spline);
}

/// Whether adjacent points are spaced within 1.2 : 1 (methods.md 0).
fn is_even(points: &[Vec3]) -> bool {
    points.windows(3).all(|w| {
        let (a, b) = (w[0].distance_squared(w[1]), w[1].distance_squared(w[2]));
        a <= b * 1.44 && b <= a * 1.44
    })
}
