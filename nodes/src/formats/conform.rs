//! Conforming curves for other tools: resampling until both readings of a Catmull-Rom spline are the same hair.
//!
//! Other readers interpret `catmullRom` as uniform, coif as centripetal (methods.md 0). [`conform`] resamples the curves on which
//! the two differ by more than [`AGREE`](crate::maths::catmull_rom_agreement::AGREE), each until they agree.
//!
//! Guarantees: the root of a curve stays, all other points are new ones of the same curve, as far out of the skin as it
//! allows. Where no points of the same curve do, which is where the skin makes it leap or kink (an ear between two points),
//! the stretch about that place leaves the curve it was (`repair.rs`): it is led round what tears it, or moved out as a whole, its
//! tip where it is too. A curve is astray where folds leave it no way, or none but over a parting: such curves are left out where
//! they are one in [`FEW`] or less. Where they are more, only those that lie deep in the skin are, if these are as few, and the
//! others are kept. Hair of a braid keeps to its side of a parting on its way to it; its braid may hang over any. Not promised: that
//! curves that are kept astray are read alike; the report gives the difference that is left. How hard is
//! tried hangs from how many of the curves given at once ask for it, so what few curves get, many may not: all together may take
//! no more than `Effort::most_tried` says. Stopping is heard within any curve.

use super::repair::{Allowance, Mender, Read};
use crate::data::attribute_transfer::carry;
use crate::data::attributes as a;
use crate::data::curves::{AttributeView, Curves, Tuft, TuftBuilder};
use crate::data::route::makers::has_dip;
use crate::data::scalp::{Scalp, Skin};
use crate::data::sections::Sections;
use crate::eval::Host;
use crate::maths::catmull_rom_agreement::{readings_agree, readings_differ};
use crate::maths::nearest_on;
use crate::maths::spline::{Spline, SplineParam};
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Conformed curves, and what was done to them.
#[derive(Clone, Debug)]
pub struct Conformed {
    /// The curves, resampled where needed. Tufts without change are the same.
    pub curves: Curves,
    /// What was done.
    pub changes: Changes,
}

/// What conforming did to curves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Changes {
    /// Number of resampled curves.
    pub resampled: usize,
    /// Number of those that had to leave their original curve to clear the skin.
    pub moved: usize,
    /// Largest distance, cm, of a CV of these from its place on the original curve.
    pub farthest: f32,
    /// Largest remaining distance between the two readings, cm.
    pub difference: f32,
    /// Curves of fewer than two CVs, which no format can hold: left out.
    pub left_out: usize,
    /// Curves that still differ, or whose only way out of the skin crosses a parting.
    pub astray: usize,
    /// How many of these were left out: all where they are few, else those that lie in the skin where those are; see [`FEW`].
    pub astray_left_out: usize,
}

/// A curve that is astray is left out if there is at most one in so many: a missing hair is invisible, a missing guide is not.
pub const FEW: usize = 1000;
/// What lies deeper in the skin than it may by more than this, cm, shows as a hair cut off. The law on depth ends at 0.01.
const DEEP: f32 = 0.009;

/// Resamples the curves whose uneven CVs would be read as another curve elsewhere: the root stays, all other points are new
/// ones of the same curve, as far out of `skin` as it allows. A curve that the skin makes uneven, such as one that passes
/// through an ear between its CVs, is moved out of it as a whole or led round it, its tip too, but over no parting of the scalps
/// `parted`. No curve is left out where `all_stay`, as guides must, or where there is no skin to lead it astray. None where
/// somebody asked to stop.
pub fn conform(
    curves: &Curves,
    skin: Option<Skin>,
    parted: &[Arc<Scalp>],
    all_stay: bool,
    host: &dyn Host,
) -> Option<Conformed> {
    let sections = leading(parted);
    let land = Land { skin: skin.as_ref(), sections: &sections };
    let tufts = curves.tufts();
    let is_cancelled = || host.cancelled();
    let mut looked: Vec<Looked> =
        each(host, tufts.len(), |i| look_at(&tufts[i], &land, &is_cancelled))?;
    // The effort per curve that still differs depends on the number of such curves, not on how many threads find them.
    let effort = match skin.is_some_and(|skin| skin.is_rough()) {
        true => Effort::None,
        false => Effort::of(count(&looked, |one| one.astray)),
    };
    if effort != Effort::None {
        let points: usize = tufts.iter().map(|tuft| tuft.points().len()).sum();
        let all = effort.most_tried();
        let on_skin = all.min((TRIED * points as u64).max(LEAST_TRIED));
        try_again(&mut looked, tufts, (&land, effort), (false, all, all), host)?;
        try_again(&mut looked, tufts, (&land, effort), (true, all, on_skin), host)?;
    }
    let goes: fn(&Mended) -> bool = match land.skin.filter(|_| !all_stay) {
        None => |_| false,
        Some(_) => {
            let sorts: [fn(&Mended) -> bool; 2] = [|one| one.astray, Mended::is_deep];
            let few =
                |sort: &fn(&Mended) -> bool| count(&looked, sort) * FEW <= curves.curve_count();
            sorts.into_iter().find(few).unwrap_or(|_| false)
        }
    };
    let mut changes = Changes {
        astray: count(&looked, |one| one.astray),
        astray_left_out: count(&looked, goes),
        ..Changes::default()
    };
    for looked in &looked {
        changes.left_out += looked.left_out;
        changes.difference = changes.difference.max(looked.difference);
        for one in &looked.changed {
            changes.resampled += 1;
            changes.moved += usize::from(one.read.moved > 0.0);
            changes.farthest = changes.farthest.max(one.read.moved);
            if !goes(one) {
                changes.difference = changes.difference.max(one.read.left);
            }
        }
    }
    let tufts = each(host, tufts.len(), |i| conformed(&tufts[i], &looked[i], goes))?;
    Some(Conformed { curves: Curves::new(tufts), changes })
}

/// How many of the changed curves are of a sort.
fn count(looked: &[Looked], sort: impl Fn(&Mended) -> bool) -> usize {
    looked.iter().flat_map(|looked| &looked.changed).filter(|one| sort(one)).count()
}

/// `f(0)..f(n)` on all threads of the host; `None` on cancellation.
fn each<T: Send + Sync>(
    host: &dyn Host,
    n: usize,
    f: impl Fn(usize) -> T + Sync,
) -> Option<Vec<T>> {
    let cells: Vec<OnceLock<T>> = (0..n).map(|_| OnceLock::new()).collect();
    host.for_each(n, &|i| {
        if !host.cancelled() {
            let _ = cells[i].set(f(i));
        }
    });
    let all = cells.into_iter().map(OnceLock::into_inner).collect();
    if host.cancelled() { None } else { all }
}

/// Tries harder on all curves that are astray, those that the skin moved or those that it did not, one as hard as the other: each
/// may take its even share of `share_of` points. What some leave is shared among those who found no end, as long as that is twice as
/// much as they have had. When all together have taken `most`, the others stay as they are: few of a groom get all that a
/// curve may need, not many of them a little that helps none.
fn try_again(
    looked: &mut [Looked],
    tufts: &[Arc<Tuft>],
    (land, effort): (&Land, Effort),
    (on_skin, share_of, most): (bool, u64, u64),
    host: &dyn Host,
) -> Option<()> {
    let mut open: Vec<(usize, usize)> = (0..)
        .zip(looked.iter())
        .flat_map(|(t, looked)| {
            let is_open = |one: &Mended| one.astray && one.read.on_skin == on_skin;
            let astray = (0..).zip(&looked.changed).filter(move |(_, one)| is_open(one));
            astray.map(move |(k, _)| (t, k))
        })
        .collect();
    let (mut left, mut had) = (share_of, 0);
    let mut spent_by_all = 0;
    while !open.is_empty() {
        let share = (left / open.len() as u64).min(most / AT_ONCE as u64);
        if share < 2 * had || share == 0 {
            break;
        }
        let mut cut = vec![];
        for some in open.chunks(AT_ONCE) {
            if spent_by_all >= most {
                return Some(());
            }
            let again = each(host, some.len(), |n| {
                let (t, k) = some[n];
                let is_cancelled = || host.cancelled();
                let patience = Allowance::new(share, &is_cancelled);
                let curve = looked[t].changed[k].curve;
                let mended = mend(&tufts[t], curve, land, effort, &patience, &mut Room::default());
                (mended, share - patience.left(), patience.looked())
            })?;
            for ((t, k), (mended, spent, looked_for)) in some.iter().zip(again) {
                left -= spent;
                spent_by_all += spent + looked_for;
                if let Some(mended) = mended {
                    if mended.astray && spent == share {
                        cut.push((*t, *k));
                    }
                    looked[*t].changed[*k] = mended;
                }
            }
        }
        (open, had) = (cut, share);
    }
    Some(())
}

/// The sections that hair stays in. (On a mesh without a map it is not routed: fur lies over its lines.)
pub(crate) fn leading(parted: &[Arc<Scalp>]) -> Vec<&Sections> {
    let sections = parted.iter().filter_map(|scalp| scalp.sections());
    sections.filter(|sections| !sections.are_of_a_mesh()).collect()
}

/// What curves keep clear of.
struct Land<'a> {
    skin: Option<&'a Skin<'a>>,
    sections: &'a [&'a Sections],
}

impl Land<'_> {
    /// Whether the first `n` points of a curve cross a parting.
    fn is_over_a_parting(&self, points: &[Vec3], n: usize) -> bool {
        self.sections.iter().any(|sections| sections.is_over_line_before(points, n))
    }
}

/// What is tried on each curve whose readings still differ when its CVs are even.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    None,
    /// Moving it out of the skin as a whole.
    Moved,
    /// Also routing it around what tears it.
    Led,
}

impl Effort {
    /// Largest number of curves that are routed, which takes longest. A smooth head tears a few hundred at its ears, a rough scan
    /// a few thousand in its folds.
    const LED: usize = 4_000;
    /// Largest number of curves that are moved. Most need a few rounds; on a mesh of nothing but folds, where none succeeds,
    /// 72,000 coils took 50 s on two cores.
    const MOVED: usize = 40_000;

    /// The effort for this number of curves.
    fn of(curves: usize) -> Self {
        if curves <= Self::LED {
            Self::Led
        } else if curves <= Self::MOVED {
            Self::Moved
        } else {
            Self::None
        }
    }

    /// Largest effort on all curves together, in placed CVs: about ten seconds of one core. Where thousands of curves cannot get
    /// out of the skin, as under a braid that is sunk into the head, each would otherwise take most of a second. If they are too
    /// many to be routed, most queries are deep in the skin, which costs more.
    fn most_tried(self) -> u64 {
        match self {
            Self::None => 0,
            Self::Moved => 150_000_000,
            Self::Led => 600_000_000,
        }
    }
}

/// Limit of the effort where the skin moves curves, per CV of all hair; about the cost of making it ...
const TRIED: u64 = 16;
/// ... with this minimum for little hair.
const LEAST_TRIED: u64 = 6_000_000;
/// Curves tried in parallel between two checks of the budget.
const AT_ONCE: usize = 32;
/// Resampling may query the skin for a way out for one CV in so many.
const LOOKS: u64 = 4;
/// The same on a mesh where every CV queries the skin alone, since few find a way there.
const LOOKS_ALONE: u64 = 64;

/// State of a tuft.
struct Looked {
    left_out: usize,
    /// Largest difference between the readings of curves that stay as they are, cm.
    difference: f32,
    /// Curves that change, in order.
    changed: Vec<Mended>,
}

/// A curve with new CVs.
struct Mended {
    /// Its index in the tuft.
    curve: u32,
    read: Read,
    /// Whether its readings still differ, it still lies in the skin, or it was led over a parting.
    astray: bool,
}

impl Mended {
    /// Whether it is astray and lies [`DEEP`] in the skin.
    fn is_deep(&self) -> bool {
        self.astray && self.read.dip > DEEP
    }
}

/// The last point of a hair on its way to its braid, where it is of one. The step to that is the braid's: it leads into the
/// strand, and a braid may hang over partings.
pub(crate) fn joins(tuft: &Tuft, i: usize) -> Option<usize> {
    let along = tuft.view(a::ALONG);
    let points = tuft.range(i);
    let root = along.at(i, points.start);
    if !matches!(along, AttributeView::Point(_)) || tuft.view(a::BRAID).at(i, points.start) == 0 {
        return None;
    }
    points.into_iter().position(|k| along.at(i, k) > root).map(|k| k - 1)
}

/// The last point of a hair before it passes the middle of its tie, where it is held by one and passes in its ring or a band's
/// thickness (2 mm) beside it: behind that it hangs, over partings too.
pub(crate) fn passes_its_tie(tuft: &Tuft, i: usize) -> Option<usize> {
    if tuft.curve(i).len() < 2 {
        return None;
    }
    let first = tuft.range(i).start;
    let radius: f32 = tuft.view(a::TIE_RADIUS).at(i, first);
    if !(radius > 0.0 && radius < 1e6) {
        return None;
    }
    let tie: Vec3 = tuft.view(a::TIE).at(i, first);
    let off = |w: &[Vec3]| tie.distance(nearest_on([w[0], w[1]], tie).0);
    let offs = tuft.curve(i).windows(2).map(off).enumerate();
    let (at, far) = offs.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (far <= radius + 0.2).then_some(at)
}

/// Checks a tuft, and resamples uneven curves.
fn look_at(tuft: &Tuft, land: &Land, is_cancelled: &dyn Fn() -> bool) -> Looked {
    let mut looked = Looked { left_out: 0, difference: 0.0, changed: vec![] };
    let mut room = Room::default();
    let allowed = tuft.view(a::ALLOW_DEPTH);
    let alone = land.skin.is_some_and(Skin::asks_alone);
    let looks = tuft.points().len() as u64 / if alone { LOOKS_ALONE } else { LOOKS };
    let patience = Allowance::of_looks(looks, is_cancelled);
    for i in (0..tuft.len()).take_while(|_| !patience.is_out()) {
        let points = tuft.curve(i);
        if points.len() < 2 {
            looked.left_out += 1;
            continue;
        }
        let first = tuft.range(i).start;
        let dips = |skin: &&Skin| has_dip(skin, points, |k| allowed.at(i, first + k));
        if let Some(difference) =
            readings_agree(points).filter(|_| !land.skin.as_ref().is_some_and(dips))
        {
            looked.difference = looked.difference.max(difference);
        } else if patience.looks().left() == 0 {
            looked.changed.push(Mended {
                curve: i as u32,
                read: Read::of(points, readings_differ(points)),
                astray: true,
            });
        } else {
            let mended = mend(tuft, i as u32, land, Effort::None, &patience, &mut room);
            looked.changed.extend(mended);
        }
    }
    looked
}

/// Scratch memory, reused from curve to curve.
#[derive(Default)]
struct Room {
    spline: Spline,
    led: Spline,
}

/// New CVs for a curve; `None` if it has no valid spline.
fn mend(
    tuft: &Tuft,
    curve: u32,
    land: &Land,
    effort: Effort,
    patience: &Allowance,
    Room { spline, led }: &mut Room,
) -> Option<Mended> {
    let i = curve as usize;
    let old = tuft.curve(i);
    spline.rebuild(old).ok()?;
    let first = tuft.range(i).start;
    let allowed = tuft.view(a::ALLOW_DEPTH);
    // As the attribute will be read at the new CVs.
    let depth = |place: SplineParam| {
        let at = |k: usize| allowed.at(i, first + place.span + k);
        at(0) + (at(1) - at(0)) * place.t
    };
    // A curve that crossed a parting before may still cross it.
    let joins = joins(tuft, i);
    let is_barred = |read: &Read| {
        let on_way = |last: &usize| {
            let still =
                |(_, place): &&(f32, SplineParam)| place.span as f32 + place.t <= *last as f32;
            read.stops.iter().take_while(still).count() - 1
        };
        land.is_over_a_parting(&read.points, joins.as_ref().map_or(read.points.len(), on_way))
            && !land.is_over_a_parting(old, joins.unwrap_or(old.len()))
    };
    let skin = land.skin.map(|skin| skin.within(patience.looks()));
    let mut mender = Mender {
        old,
        spline,
        led,
        skin: skin.as_ref(),
        depth: &depth,
        is_barred: &is_barred,
        patience,
    };
    let lifted = mender.lifted();
    let read = match mender.takes(&lifted) {
        true => lifted,
        false => mender.read_alike(effort),
    };
    let astray = !read.agrees() || is_barred(&read);
    Some(Mended { curve, read, astray })
}

/// A tuft with its changed curves, without those that go.
fn conformed(tuft: &Arc<Tuft>, looked: &Looked, goes: impl Fn(&Mended) -> bool) -> Arc<Tuft> {
    if looked.left_out == 0 && looked.changed.is_empty() {
        return tuft.clone();
    }
    let mut out = TuftBuilder::new();
    let (mut kept, mut places) = (vec![], vec![]);
    let mut changed = looked.changed.iter().peekable();
    for i in 0..tuft.len() {
        let (old, first) = (tuft.curve(i), tuft.offsets()[i]);
        match changed.next_if(|one| one.curve as usize == i) {
            Some(one) if goes(one) => continue,
            Some(Mended { read, .. }) => {
                let stops = read.stops.iter();
                places.extend(stops.map(|(_, place)| (first + place.span as u32, place.t)));
                out.push_curve(&read.points);
            }
            None if old.len() < 2 => continue,
            None => {
                let last = old.len() - 1;
                places.extend((0..=last).map(|k| {
                    let span = k.min(last - 1);
                    (first + span as u32, (k - span) as f32)
                }));
                out.push_curve(old);
            }
        }
        kept.push(i as u32);
    }
    carry(tuft, &kept, &places, &mut out);
    Arc::new(out.build())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::data::attributes::{Domain, ID};
    use crate::data::curves::MOST_A_CURVE;
    use crate::eval::PlainHost;
    use crate::maths::catmull_rom_agreement::AGREE;

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
        let after = conform(&before, None, &[], false, &PlainHost).unwrap();
        assert_eq!(
            (after.changes.resampled, after.changes.moved, after.changes.left_out),
            (1, 0, 1)
        );
        assert!(after.changes.difference <= AGREE, "{}", after.changes.difference);
        let tuft = &after.curves.tufts()[0];
        assert_eq!(tuft.curve(1), even);
        assert_eq!(
            (tuft.curve(0)[0], tuft.curve(0)[tuft.curve(0).len() - 1]),
            (uneven[0], uneven[4])
        );
        let again = conform(&after.curves, None, &[], false, &PlainHost).unwrap();
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
            let after = conform(&curves(&[&curve]), None, &[], false, &PlainHost).unwrap();
            assert!(after.changes.difference <= AGREE, "{}", after.changes.difference);
            let points = after.curves.tufts()[0].curve(0);
            assert!(points.len() <= MOST_A_CURVE && points[0] == curve[0], "{}", points.len());
        }
    }

    /// `sin` and `cos` of 240ths of a turn, times `r`.
    pub(crate) fn arc(k: i32, r: f32) -> (f32, f32) {
        let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 / 240.0);
        (sin * r, cos * r)
    }

    /// The ball with a parting over its top, along z.
    pub(crate) fn parted_ball() -> [Arc<Scalp>; 1] {
        let ball = crate::data::scalp::tests::shared_ball();
        let points = (-50..=50).map(|k| {
            let (z, y) = arc(k, 8.9);
            ball.closest_root(Vec3::new(0.0, y, z)).unwrap().point
        });
        let line = crate::data::sections::Parting {
            id: 1,
            points: points.collect(),
            half_width: 0.08,
            of_pattern: false,
        };
        let (sections, _) = Sections::new(&ball, vec![line], &[]);
        [Arc::new(ball.parted(sections))]
    }

    #[test]
    fn a_hair_that_would_be_moved_over_a_parting_is_left_out_and_a_guide_is_kept() {
        let ball = crate::data::scalp::tests::shared_ball();
        // A coarse hair that dives under the parting.
        let parted = parted_ball();
        let skin = ball.skin();
        // Its turns are half in the ball, and far under it where the parting is.
        let hair: Vec<Vec3> = (-80..=80)
            .map(|k: i32| {
                let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 * 0.0875);
                let (x, y) = arc(k / 3 + k % 3, 1.0);
                let r = if k.abs() < 24 { 7.9 } else { 8.9 + 0.4 * sin };
                Vec3::new(x, y, 0.0) * r + Vec3::Z * 0.4 * cos
            })
            .collect();
        let check =
            |others: usize, parted: &[Arc<Scalp>], all_stay: bool, astray: usize, keeps: bool| {
                let beside = [0.0, 0.5, 1.0].map(|x| Vec3::new(x - 6.0, 9.0 + x, 4.0));
                let mut lists: Vec<&[Vec3]> = vec![&beside; others];
                lists.push(&hair);
                let curves = curves(&lists);
                let after =
                    conform(&curves, Some(ball.skin()), parted, all_stay, &PlainHost).unwrap();
                let Changes { astray: found, astray_left_out, difference, .. } = after.changes;
                let left_out = if keeps { 0 } else { astray };
                assert_eq!((found, astray_left_out), (astray, left_out), "{others}");
                assert_eq!(after.curves.curve_count(), others + 1 - left_out);
                assert!(keeps || difference <= AGREE, "{difference}");
            };
        assert!(skin.distance(hair[80]) < 0.0 && readings_differ(&hair) > AGREE);
        check(FEW, &[], false, 0, false);
        check(FEW, &parted, false, 1, false);
        check(FEW, &parted, true, 1, true);
        check(FEW - 2, &parted, false, 1, true);
        check(0, &parted, false, 1, true);
        // A hair that dives under the parting on its way to a braid, which hangs back over it: resampling lifts its way.
        let at = |degrees: f32, r: f32| {
            let (sin, cos) = crate::maths::transcendental::sin_cos_turns(degrees / 360.0);
            Vec3::new(sin * r, cos * r, 0.1)
        };
        let way = (-24..=24i32).map(|k| {
            let r = if k.abs() < 8 { 8.5 } else { 8.95 };
            at(1.5 * (k as f32 + 0.3 * (k.rem_euclid(3)) as f32), r)
        });
        let on_way = way.clone().count();
        let braid = (-4..=25).rev().map(|k| at(1.5 * k as f32, 9.0));
        let braided: Vec<Vec3> = way.chain(braid).collect();
        assert!(readings_differ(&braided) > AGREE);
        let judged = |along: Vec<f32>| {
            let mut b = TuftBuilder::new();
            b.push_curve(&braided);
            b.set(ID, Domain::Curve, vec![1u64]);
            b.set(a::BRAID, Domain::Curve, vec![7u64]);
            b.set(a::ALONG, Domain::Point, along);
            let one = Curves::new(vec![Arc::new(b.build())]);
            conform(&one, Some(ball.skin()), &parted, false, &PlainHost).unwrap().changes.astray
        };
        let along = |k: usize| k.saturating_sub(on_way) as f32;
        assert_eq!(judged((0..braided.len()).map(along).collect()), 1);
        assert_eq!(judged(vec![0.0; braided.len()]), 0, "what lay over a parting may");
    }

    /// Asks to stop when it was asked so often whether somebody does.
    struct Stops(std::sync::atomic::AtomicUsize);
    impl Host for Stops {
        fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
            PlainHost.for_each(n, f);
        }
        fn cancelled(&self) -> bool {
            use std::sync::atomic::Ordering::Relaxed;
            self.0.fetch_update(Relaxed, Relaxed, |n| Some(n.saturating_sub(1))) == Ok(0)
        }
    }

    /// Coils so narrow and coarse that no points of them are read alike, half in the ball.
    fn hopeless(count: usize) -> Curves {
        let coil = |n: usize| -> Vec<Vec3> {
            let turn = |k: i32| crate::maths::transcendental::sin_cos_turns(0.41 * k as f32);
            let at = |k: i32| {
                let ((sin, cos), (x, y)) = (turn(k), arc(k / 3 + k % 3, 8.85));
                Vec3::new(x, y, 0.3 * n as f32) + Vec3::new(0.2 * sin, 0.6 * cos, 0.6 * sin)
            };
            (-60..=60).map(at).collect()
        };
        let coils: Vec<Vec<Vec3>> = (0..count).map(coil).collect();
        curves(&coils.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn stopping_is_heard_within_one_curve() {
        let ball = crate::data::scalp::tests::shared_ball();
        let coil = hopeless(1);
        let ends = |asked: usize| {
            conform(&coil, Some(ball.skin()), &[], false, &Stops(asked.into())).is_some()
        };
        assert!(!ends(3) && !ends(20) && !ends(60), "it is asked as each curve is tried");
        assert!(ends(usize::MAX));
    }

    #[test]
    fn all_curves_together_take_no_more_than_is_allowed_each_its_share() {
        let ball = crate::data::scalp::tests::shared_ball();
        let coils = hopeless(80);
        let skin = ball.skin();
        let land = Land { skin: Some(&skin), sections: &[] };
        let tuft = coils.tufts()[0].clone();
        let looked = || vec![look_at(&tuft, &land, &|| false)];
        let polls = |share_of: u64, most: u64| {
            let (host, mut looked) = (Stops(usize::MAX.into()), looked());
            let tufts = [tuft.clone()];
            let of = (true, share_of, most);
            try_again(&mut looked, &tufts, (&land, Effort::Moved), of, &host).unwrap();
            usize::MAX - host.0.into_inner()
        };
        assert!(looked()[0].changed.iter().all(|one| one.astray && one.read.on_skin));
        // Each is asked about once a round of at least 121 points, and twice in between.
        let within = |most: usize| 3 * most / 121 + 3 * 80;
        let asked = [0, 600_000, 6_000_000].map(|most| polls(most, most));
        assert_eq!(asked[0], 0);
        assert!(asked[1] < asked[2] && asked[1] <= within(600_000), "{asked:?}");
        // Of what each might take by its share, all together take what they may and a batch of them more.
        let asked = polls(u64::MAX, 600_000);
        assert!(asked > 0 && asked <= within(2 * 600_000), "{asked}");
    }

    #[test]
    fn much_is_tried_on_few_curves_and_little_on_many() {
        let check = |curves, effort| assert_eq!(Effort::of(curves), effort, "{curves}");
        check(4_000, Effort::Led);
        check(4_001, Effort::Moved);
        check(40_001, Effort::None);
    }
}
