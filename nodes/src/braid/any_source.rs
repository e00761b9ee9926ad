//! The laws of methods.md 2 on thousands of random sources: straight, bent, spiral, and with cusps.
//!
//! Ten thousand sources for each of two seeds by `tests/run.sh --long`, else a hundred. Overlap
//! is tested where the source turns no more sharply than the braid can follow; everything else on any source, and the
//! word on those whose stitch length can be braided. All sources that break a law are reported.

use super::laws::{Set, bare, braid, counted, helix, set, straight};
use super::reading::{CvStrand, braid_signs, carried, overlap, path_signs};
use super::weave::{Weave, default_frequency};
use crate::data::attributes as attr;
use crate::long::is_long;
use crate::maths::hash::Dice;
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos_turns;
use glam::Vec3;

/// Number of sources.
pub(super) fn many() -> u64 {
    if is_long() { 10_000 } else { 100 }
}
const THREADS: u64 = 2;
/// Sources beyond the first hundred whose words were broken before strands got points according to their own
/// length.
const ONCE_BROKEN: [u64; 12] =
    [2724, 2869, 3093, 3664, 5053, 5494, 6399, 6729, 7599, 8469, 8669, 9654];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Straight,
    Bent,
    Spiral,
    Cusped,
    Thrown,
}

/// A source of a kind, and whether a braid `width` cm wide can follow it.
fn source(dice: Dice, id: u64, width: f32) -> (Kind, Vec<Vec3>, bool) {
    let length = width * dice.range(id, 1, 6.0, 40.0);
    // Radii of at least the width are at least 2A.
    let radius = width * dice.range(id, 2, 1.0, 8.0);
    match id % 5 {
        0 => (Kind::Straight, straight(length), true),
        1 => {
            let turns = (length / (std::f32::consts::TAU * radius)).min(0.9);
            let arc = |k: u32| {
                let (s, c) = sin_cos_turns(turns * k as f32 / 24.0);
                Vec3::new(radius * c, 0.0, radius * s)
            };
            (Kind::Bent, (0..=24).map(arc).collect(), true)
        }
        // Turns far enough apart that it stays clear of itself.
        2 => {
            let rise = width * dice.range(id, 3, 2.6, 6.0);
            (Kind::Spiral, helix(radius, rise, dice.range(id, 4, 0.5, 3.0)), true)
        }
        kind => {
            let n = [3, 5, 9, 40, 300][dice.below(id, 5, 5) as usize];
            let (mut p, mut way) = (Vec3::ZERO, Vec3::Y);
            let points = (0..n).map(|k| {
                let v = Vec3::from([0, 1, 2].map(|a| dice.signed(id, 10 + 3 * k + a)));
                if kind == 3 && dice.unit(id, 5000 + k) < 0.3 {
                    way = -way;
                } else {
                    way = (way + v * 0.6).normalize_or(Vec3::Y);
                }
                p += way * (length / n as f32);
                p
            });
            (if kind == 3 { Kind::Cusped } else { Kind::Thrown }, points.collect(), false)
        }
    }
}

/// Result for one source; the largest overlap if it was measured.
fn one(dice: Dice, id: u64) -> (Kind, f32) {
    let n = dice.below(id, 6, 11) as i64 + 2;
    let width = dice.range(id, 7, 0.3, 3.0);
    let (kind, points, follows) = source(dice, id, width);
    let spline = Spline::new(&points).unwrap();
    // Up to 200, evenly over the orders of magnitude; no closer than a braid of this width can be made.
    let most = (spline.length() / (0.45 * width)).clamp(1.0, 200.0);
    let share = dice.unit(id, 8);
    let stitches = if follows && !id.is_multiple_of(3) {
        1.0 + share * share * (most - 1.0)
    } else {
        1.0 + 199.0 * share * share * share
    };
    let stitches = stitches.round();
    // Closer than this, strands wind up on each other; much longer, the source bends within a stitch.
    let pitch = spline.length() / (stitches * width);
    let seen = (0.6..4.0).contains(&pitch);
    let follows = follows && seen;
    let what = format!("{kind:?} {id}: {n} strands, {stitches} stitches, {width} cm");
    let sets: Vec<Set> = vec![
        bare(),
        counted(stitches),
        set("strands", n),
        set("width", width),
        set("cvs_per_stitch", 8i64),
        set("crossing", if id.is_multiple_of(2) { "under" } else { "over" }),
    ];
    let (strands, stitch, _) = braid(&points, &sets);
    assert_eq!(strands.curve_count(), n as usize, "{what}");
    for (tuft, i) in strands.each() {
        let mut last: Option<(Vec3, Vec3)> = None;
        let curve = tuft.curve(i);
        for (k, p) in tuft.range(i).zip(curve) {
            let normal: Vec3 = tuft.view(attr::NORMAL).at(i, k);
            let radius: f32 = tuft.view(attr::RADIUS).at(i, k);
            assert!(p.is_finite() && radius.is_finite() && radius >= 0.0, "{what}");
            assert!((normal.length() - 1.0).abs() < 1e-4, "{what}");
            let here = k - tuft.range(i).start;
            let tangent = (curve[(here + 1).min(curve.len() - 1)] - curve[here.saturating_sub(1)])
                .normalize_or(Vec3::Y);
            // At a cusp a chord says nothing about the tangent.
            assert!(
                !follows || normal.dot(tangent).abs() < 0.9,
                "{what}: a frame along its strand"
            );
            if let (true, Some((before, along))) = (follows, last)
                && along.dot(tangent) > 0.5
            {
                assert!(normal.dot(before) > 0.0, "{what}: a frame that flips");
            }
            last = Some((normal, tangent));
        }
    }
    if follows {
        let uneven = super::laws::unevenness(&strands);
        assert!(uneven < 1.2, "{what}: {uneven}");
    }
    // Even stitches, in order, as many as asked for on each side.
    let (tuft, _) = stitch.each().next().unwrap_or_else(|| panic!("{what}: no stitches"));
    let at = |k: usize| (tuft.view(attr::ALONG).at(0, k), tuft.view(attr::SIDE).at(0, k));
    let all: Vec<(f32, i32)> = (0..tuft.points().len()).map(at).collect();
    assert_eq!(all.len(), 2 * stitches as usize, "{what}");
    for side in [-1, 1] {
        let us: Vec<f32> = all.iter().filter(|s| s.1 == side).map(|s| s.0).collect();
        for w in us.windows(2) {
            assert!(((w[1] - w[0]) * stitches - 1.0).abs() < 0.01, "{what}: {us:?}");
        }
    }
    let mut most = 0.0;
    if seen {
        let strands = CvStrand::all(&strands);
        let m = default_frequency(n as u32);
        let want = path_signs(&Weave::new(n as u32, m, id.is_multiple_of(2), false));
        let got =
            braid_signs(&strands, &spline, &carried(&points), (0.0, 1.0), stitches.into(), &what);
        // With one stitch a pair may not have met yet.
        if stitches > 2.0 {
            // Of a source that is all folds, not every pair is seen.
            let as_asked = got.iter().zip(&want).all(|(got, want)| got.is_none() || got == want);
            assert!(got.len() == want.len() && as_asked, "{what}: {got:?}, not {want:?}");
        }
        if follows && stitches * (n as f32) < 60.0 && stitches > 1.0 {
            most = overlap(&strands).0;
            assert!(most <= 1.02, "{what}: tubes overlap by {most}");
        }
    }
    (kind, most)
}

/// The results for these, on two threads; or the broken law, in words.
pub(super) fn each_of<T: Send>(
    ids: &[u64],
    one: impl Fn(u64) -> T + Sync,
) -> Vec<Result<T, String>> {
    let tried = |id: u64| {
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| one(id))).map_err(|panic| {
            let said = panic.downcast_ref::<String>().cloned();
            said.unwrap_or_else(|| format!("{id} panics"))
        })
    };
    let share = |t: u64| {
        let own = ids.iter().filter(|id| *id % THREADS == t);
        own.map(|id| tried(*id)).collect::<Vec<_>>()
    };
    let share = &share;
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|t| scope.spawn(move || share(t))).collect();
        threads.into_iter().flat_map(|t| t.join().unwrap()).collect()
    })
}

fn on_sources(seed: u64) {
    let dice = Dice::new(seed, 0, "any source");
    let beyond = ONCE_BROKEN.into_iter().filter(|id| *id >= many());
    let ids: Vec<u64> = (0..many()).chain(beyond).collect();
    let all: Vec<Result<(Kind, f32), String>> = each_of(&ids, |id| one(dice, id));
    let most: Vec<f32> = all.iter().flatten().map(|(_, most)| *most).collect();
    let looked = most.iter().filter(|most| **most > 0.0).count();
    let worst = most.iter().copied().fold(0.0, f32::max);
    let broken: Vec<&str> =
        all.iter().filter_map(|it| it.as_ref().err()).map(|s| s.as_str()).collect();
    println!("{} sources, overlap looked for on {looked}: at most {worst}", all.len());
    assert!(broken.is_empty(), "{} sources break a law:\n{}", broken.len(), broken.join("\n"));
    assert!(looked as u64 > many() / 20, "{looked}");
}

#[test]
fn braids_keep_their_laws_on_any_source() {
    on_sources(2026);
}

#[test]
fn braids_keep_their_laws_on_other_sources() {
    on_sources(77);
}
