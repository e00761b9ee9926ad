//! The laws of methods.md 2, measured on the evaluated strands only: splines through their CVs, radii linear between
//! CVs.

use super::lissajous_braid::NODE;
use super::reading::{CvStrand, braid_signs, carried, on_ball, overlap, path_signs};
use super::weave::{Weave, coprime, default_frequency};
use crate::data::attributes::{self as attr, Domain};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::field::Field;
use crate::data::ramp::{Blend, Ramp};
use crate::data::scalp::{HeadFrame, REGION, Scalp, tests::ball};
use crate::define::{FileData, Value};
use crate::eval::{Log, PlainHost, Quality};
use crate::laws::braid_words::Crossing;
use crate::laws::{MeasuredHair, braids, depth};
use crate::maths::hash::Dice;
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos_turns;
use crate::testing::{Memory, curves_of, run, run_on};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

pub(super) type Set = Vec<(&'static str, Value)>;

pub(super) fn curves(all: &[&[Vec3]]) -> Curves {
    let tufts = all.iter().enumerate().map(|(i, points)| {
        let mut b = TuftBuilder::new();
        b.push_curve(points);
        b.set(attr::ID, Domain::Curve, vec![100 + i as u64]);
        Arc::new(b.build())
    });
    Curves::new(tufts.collect())
}

/// A straight source of `length` cm hanging down.
pub(super) fn straight(length: f32) -> Vec<Vec3> {
    vec![Vec3::ZERO, Vec3::Y * -0.5 * length, Vec3::Y * -length]
}

/// A helix around Y.
pub(super) fn helix(radius: f32, rise: f32, turns: f32) -> Vec<Vec3> {
    let n = (24.0 * turns) as usize;
    (0..=n)
        .map(|k| {
            let (s, c) = sin_cos_turns(k as f32 / 24.0);
            Vec3::new(radius * c, rise * k as f32 / 24.0, radius * s)
        })
        .collect()
}

/// Over the ball of `ball()` from front to back, beside the midline.
fn over_the_ball() -> Vec<Vec3> {
    (0..24)
        .map(|k| {
            let (s, c) = sin_cos_turns(0.06 + k as f32 / 70.0);
            Vec3::new(0.4, s, c).normalize() * 8.9
        })
        .collect()
}

/// No gather, no tie: only the weave.
pub(super) fn bare() -> Set {
    vec![
        ("root_gather", 0.0f32.into()),
        ("tie", 1.0f32.into()),
        ("tip_amplitude", 1.0f32.into()),
        ("phase", 7.0f32.into()),
    ]
}

pub(super) fn braid(source: &[Vec3], sets: &[Set]) -> (Curves, Curves, Vec<String>) {
    let set: Set =
        std::iter::once(("source", curves(&[source]).into())).chain(sets.concat()).collect();
    // A later value replaces an earlier one.
    let mut last: Set = vec![];
    for (name, value) in set {
        last.retain(|(known, _)| *known != name);
        last.push((name, value));
    }
    let (out, said) = run(&NODE, &last);
    (curves_of(&out[0]).clone(), curves_of(&out[1]).clone(), said)
}

pub(super) fn set<V: Into<Value>>(name: &'static str, value: V) -> Set {
    vec![(name, value.into())]
}

/// The largest ratio of neighbouring distances between CVs.
pub(super) fn unevenness(curves: &Curves) -> f32 {
    crate::laws::strands::measure(&MeasuredHair::of(curves, &PlainHost)).spacing_ratio
}

pub(super) fn counted(stitches: f32) -> Set {
    vec![("stitches_by", "count".into()), ("stitches", stitches.into())]
}

#[test]
fn words_of_the_method() {
    // Pairs from left to right: s_p is true where the strand going right is above.
    for (n, m, want) in [
        (3, 2, &[false, true][..]),
        (4, 3, &[false, true, false]),
        (5, 2, &[false, false, true, true]),
    ] {
        let signs = path_signs(&Weave::new(n, m, true, false));
        assert_eq!(signs.into_iter().flatten().collect::<Vec<_>>(), want, "({n}, {m})");
    }
}

#[test]
fn strands_come_as_close_in_space_as_the_method_says() {
    let weave = Weave::new(3, 2, true, false);
    for (pitch, want) in [(1.0f32, 0.451f32), (1.5, 0.605), (2.0, 0.706), (3.0, 0.800)] {
        let point = |i: u32, stitches: f64| {
            let (x, y) = weave.at(i, stitches / 3.0);
            Vec3::new(x, 0.5 * y, pitch * stitches as f32)
        };
        let mut least = f32::MAX;
        for k in 0..300 {
            for d in -300..300 {
                let (here, there) = (f64::from(k) / 100.0, f64::from(k + d) / 100.0);
                least = least.min(point(0, here).distance(point(1, there)));
                least = least.min(point(0, here).distance(point(2, there)));
            }
        }
        assert!((least - want).abs() < 2e-3, "{pitch}: {least} {want}");
    }
}

#[test]
fn lengths_scale_with_the_head_when_asked() {
    let width = |scaled: bool| {
        let surface = crate::maths::closest::tests::sphere(17.8, 24);
        let region = vec![1.0; surface.points.len()];
        let frame = HeadFrame { radius: 17.8, ..HeadFrame::IDENTITY };
        let scalp = Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into());
        let set = vec![("scalp", scalp.into()), ("scale_with_head", scaled.into())];
        let (strands, _, said) = braid(&[Vec3::X * 40.0, Vec3::new(40.0, -20.0, 0.0)], &[set]);
        assert_eq!(said.iter().any(|s| s.contains("lengths are 100 % longer")), scaled);
        CvStrand::all(&strands).iter().flat_map(|s| s.radius.clone()).fold(0.0, f32::max)
    };
    let ratio = width(true) / width(false);
    assert!((ratio - 2.0).abs() < 0.1, "{ratio}");
}

#[test]
fn every_weave_is_braided_as_it_should_on_any_source() {
    let mut tried = 0;
    for n in 2..=12u32 {
        for m in (1..n).filter(|m| coprime(*m, n) && (*m > 1 || n < 4)) {
            let usual = m == default_frequency(n);
            for (crossing, hand) in [("under", "Z"), ("over", "Z"), ("under", "S")] {
                if !usual && hand == "S" {
                    continue;
                }
                let set = |stitches: f32| {
                    vec![
                        ("strands", Value::Int(n.into())),
                        ("weave", Value::Int(if usual { 0 } else { m.into() })),
                        ("crossing", crossing.into()),
                        ("handedness", hand.into()),
                        ("stitches_by", "count".into()),
                        ("stitches", stitches.into()),
                    ]
                };
                let want = path_signs(&Weave::new(n, m, crossing == "under", hand == "S"));
                let bent = helix(2.0, 4.0, 1.0);
                for (source, stitches) in [(straight(10.0), 9.0), (bent, 13.0)] {
                    let (strands, ..) = braid(&source, &[bare(), set(stitches)]);
                    let what = format!("({n}, {m}) {crossing} {hand}");
                    let got = braid_signs(
                        &CvStrand::all(&strands),
                        &Spline::new(&source).unwrap(),
                        &carried(&source),
                        (0.0, 1.0),
                        stitches.into(),
                        &what,
                    );
                    assert_eq!(got, want, "{what}");
                    if m % 2 == 0 {
                        // Rightmost pair, strand going left: it passes below when under.
                        assert_eq!(*got.last().unwrap(), Some(crossing == "under"), "{what}");
                    }
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 150, "{tried}");
}

#[test]
fn laws_read_the_words_that_are_woven() {
    for n in 2..=7u32 {
        for (crossing, source) in [("under", straight(10.0)), ("over", helix(2.0, 4.0, 1.0))] {
            let set = [counted(9.0), set("strands", i64::from(n)), set("crossing", crossing)];
            let (strands, ..) = braid(&source, &[bare(), set.concat()]);
            let found = braids::measure(&MeasuredHair::of(&strands, &PlainHost), None).unwrap();
            let what = format!("{n} {crossing}: {found:?}");
            assert!(found.braids == 1 && found.are_woven(), "{what}");
            assert_eq!(found.keep_apart(), Some(true), "{what}");
            let (m, kind) = (default_frequency(n), &found.kinds[0]);
            let want = path_signs(&Weave::new(n, m, crossing == "under", false));
            assert_eq!((kind.strands, kind.weave), (n as usize, Some(m as usize)), "{what}");
            assert!(kind.signs.iter().map(|sign| Some(*sign)).eq(want), "{what}");
            let asked = if crossing == "under" { Crossing::Under } else { Crossing::Over };
            let seen = if m % 2 == 0 { asked } else { Crossing::Either };
            assert_eq!(kind.crossing, Some(seen), "{what}");
        }
    }
}

#[test]
fn gather_taper_tie_looseness_and_uneven_stitches_keep_the_word() {
    for n in 3..=7i64 {
        let source = straight(12.0);
        let set = vec![
            ("strands", n.into()),
            ("looseness", 1.0f32.into()),
            ("uneven_stitches", 1.0f32.into()),
            ("stitches_by", "count".into()),
            ("stitches", 10.0f32.into()),
            ("phase", 7.0f32.into()),
            ("width", Ramp::linear(1.2, 0.8).into()),
        ];
        let (strands, ..) = braid(&source, &[set]);
        let got = braid_signs(
            &CvStrand::all(&strands),
            &Spline::new(&source).unwrap(),
            &carried(&source),
            (0.0, 0.9),
            10.0,
            &n.to_string(),
        );
        let m = default_frequency(n as u32);
        assert_eq!(got, path_signs(&Weave::new(n as u32, m, false, false)), "{n}");
        assert!(unevenness(&strands) < 1.2, "{}", unevenness(&strands));
        let (worst, _) = overlap(&CvStrand::all(&strands));
        assert!(worst <= 1.02, "{n}: {worst}");
    }
}

#[test]
fn tubes_touch_and_never_overlap() {
    let mut worst = (0.0f32, String::new());
    let mut check = |what: String, source: &[Vec3], sets: &[Set], touch: f32| {
        let (strands, ..) = braid(source, sets);
        let (most, touching) = overlap(&CvStrand::all(&strands));
        assert!(most <= 1.02, "{what}: {most}");
        assert!(touching > touch, "{what}: only {touching} touch");
        if most > worst.0 {
            worst = (most, what);
        }
    };
    for n in [2i64, 3, 4, 5, 8, 12] {
        for height in [0.0f32, 1.0] {
            let strands = vec![("strands", n.into()), ("height", height.into())];
            for spacing in [0.0f32, 0.35, 0.75, 1.2] {
                let set = [bare(), strands.clone(), set("stitch_spacing", spacing)];
                check(format!("{n} straight {spacing} {height}"), &straight(5.0), &set, 0.05);
            }
            for cvs in [8i64, 24] {
                let set = [bare(), strands.clone(), set("cvs_per_stitch", cvs)];
                check(format!("{n} straight cvs {cvs}"), &straight(4.0), &set, 0.05);
            }
            // A = 0.35 or so: a bend of radius 2A.
            let bent = helix(0.66, 3.0, 0.9);
            check(format!("{n} bent {height}"), &bent, &[bare(), strands.clone()], 0.07);
            // Everything at its default.
            check(
                format!("{n} plain {height}"),
                &straight(8.0),
                std::slice::from_ref(&strands),
                0.07,
            );
        }
    }
    for m in [5i64, 7, 11] {
        let set = [bare(), vec![("strands", Value::Int(12)), ("weave", m.into())]];
        check(format!("12:{m}"), &straight(3.0), &set, 0.03);
    }
    // Thin and gathered at the root, like braids that grow with their hair.
    let ramp = |from: f32, to: f32| {
        let keys = vec![(0.0, from), (0.1, 0.5 * (from + to)), (0.4, to), (1.0, 0.6 * to)];
        Value::Field(Arc::new(Field::Ramp(Ramp::new(Blend::Smooth, keys).unwrap())))
    };
    for n in 2..=6i64 {
        for (thin, gather) in [(0.15, 0.5f32), (0.3, 0.5), (0.3, 1.5), (0.15, 0.0)] {
            let set = vec![
                ("strands", n.into()),
                ("width", ramp(thin, 1.0)),
                ("height", ramp(0.6 * thin, 0.6)),
                ("stitch_spacing", ramp(0.6 * thin, 0.6)),
                ("root_gather", gather.into()),
                ("tie", 1.0f32.into()),
                ("tip_amplitude", 0.8f32.into()),
            ];
            check(format!("{n} growing from {thin} {gather}"), &straight(12.0), &[set], 0.02);
        }
    }
    println!("largest overlap {} at {}", worst.0, worst.1);
}

#[test]
fn the_braid_is_as_large_as_asked() {
    for n in 2..=8i64 {
        for (width, height) in [(1.0f32, 0.0f32), (1.0, 0.8), (3.0, 1.2)] {
            let set =
                vec![("strands", n.into()), ("width", width.into()), ("height", height.into())];
            let source = straight(10.0 * width);
            let (strands, ..) = braid(&source, &[bare(), set]);
            let frame = carried(&source)(&[0.5])[0];
            let (mut w, mut h) = (0.0f32, 0.0f32);
            for strand in CvStrand::all(&strands) {
                for (p, r, u) in strand.samples(4) {
                    if u > 0.1 && u < 0.9 {
                        w = w.max(2.0 * (p.dot(frame.binormal()).abs() + r));
                        h = h.max(2.0 * (p.dot(frame.normal).abs() + r));
                    }
                }
            }
            let flat = if n == 2 { 1.0 } else { 0.5 };
            let want = if height > 0.0 { height } else { flat * width };
            let (dw, dh) = (w / width - 1.0, h / want - 1.0);
            assert!(dw.abs() < 0.03 && dh.abs() < 0.08, "{n} strands: {w} {width}, {h} {want}");
        }
    }
}

#[test]
fn stitches_are_even_in_order_and_where_strands_are_outermost() {
    for n in 2..=12i64 {
        for (source, count) in [(straight(10.0), 9.0), (helix(2.0, 4.0, 1.0), 14.0)] {
            let (strands, stitches, _) =
                braid(&source, &[bare(), set("strands", n), counted(count)]);
            let (strands, spline) = (CvStrand::all(&strands), Spline::new(&source).unwrap());
            let (tuft, _) = stitches.each().next().unwrap();
            let at = |k: usize| {
                let (u, side) = (tuft.view(attr::ALONG).at(0, k), tuft.view(attr::SIDE).at(0, k));
                (u, side, tuft.view(attr::STRAND).at(0, k) as usize)
            };
            let all: Vec<(f32, i32, usize)> = (0..tuft.points().len()).map(at).collect();
            assert!(all.windows(2).all(|w| w[0].0 <= w[1].0 + 1e-6));
            for side in [-1, 1] {
                let us: Vec<f32> = all.iter().filter(|s| s.1 == side).map(|s| s.0).collect();
                assert_eq!(us.len(), count as usize, "{n}");
                for w in us.windows(2) {
                    assert!(((w[1] - w[0]) * count - 1.0).abs() < 0.01, "{n}: {us:?}");
                }
            }
            // Half a stitch apart for an odd number of strands, level for an even one.
            let apart = (all[1].0 - all[0].0) * count;
            assert!((apart - if n % 2 == 1 { 0.5 } else { 0.0 }).abs() < 0.01, "{n}: {apart}");
            let frames = carried(&source)(&all.iter().map(|s| s.0).collect::<Vec<_>>());
            for ((k, (u, side, strand)), frame) in all.iter().enumerate().zip(frames) {
                let x = |p: Vec3| (p - spline.at(*u)).dot(frame.binormal()) * *side as f32;
                let own = x(tuft.points()[k]);
                assert!(tuft.points()[k].distance(strands[*strand].beside(*u)) < 0.02);
                let most = strands.iter().map(|s| x(s.beside(*u))).fold(0.0, f32::max);
                assert!(own > most - 0.01, "{n} {u}: {own} {most}");
            }
        }
    }
}

#[test]
fn three_strands_by_either_formula_are_one_braid() {
    for source in [straight(8.0), helix(2.0, 4.0, 1.0)] {
        let (weave, ..) = braid(&source, &[set("crossing", "under")]);
        let (talk, ..) = braid(&source, &[set("crossing", "under"), set("formula", "lightyear")]);
        for ((a, i), (b, j)) in weave.each().zip(talk.each()) {
            for (p, q) in a.curve(i).iter().zip(b.curve(j)) {
                assert!(p.distance(*q) < 1e-5 * 0.35, "{p} {q}");
            }
        }
    }
}

#[test]
fn any_number_of_stitches_and_points_makes_smooth_finite_strands() {
    let dice = Dice::new(11, 0, "source");
    for id in 0..60 {
        let cvs = [2, 3, 8, 40, 500][dice.below(id, 0, 5) as usize];
        let (mut p, mut step) = (Vec3::ZERO, Vec3::Y);
        // Half of them bend no more than a braid can follow, the others are random.
        let bends = if id % 2 == 0 { 1.0 } else { (20.0 / cvs as f32).min(1.0) };
        let points: Vec<Vec3> = (0..cvs)
            .map(|k| {
                let axis = |a| dice.signed(id, 10 + 3 * k as u64 + a);
                step = (step + Vec3::new(axis(0), axis(1), axis(2)) * (0.3 * bends)).normalize();
                p += step * (20.0 / cvs as f32);
                p
            })
            .collect();
        let n = dice.below(id, 1, 11) as i64 + 2;
        let stitches = [1.0f32, 2.0, 17.0, 200.0][dice.below(id, 2, 4) as usize];
        let width = if stitches > 100.0 { 0.3f32 } else { 1.0 };
        let (strands, stitch, _) =
            braid(&points, &[set("strands", n), set("width", width), counted(stitches)]);
        assert_eq!(strands.curve_count(), n as usize);
        assert_eq!(stitch.point_count(), 2 * stitches as usize, "{n} {stitches}");
        for strand in CvStrand::all(&strands) {
            assert!(strand.radius.iter().all(|r| r.is_finite() && *r >= 0.0));
            assert!(strand.along.windows(2).all(|w| w[0] <= w[1]));
        }
        for (tuft, i) in strands.each() {
            assert!(tuft.curve(i).iter().all(|p| p.is_finite()));
            for k in tuft.range(i) {
                let normal: Vec3 = tuft.view(attr::NORMAL).at(i, k);
                assert!((normal.length() - 1.0).abs() < 1e-4);
            }
        }
        let worst = unevenness(&strands);
        assert!(worst < 1.2 || bends == 1.0, "{n} {stitches} {cvs}: {worst}");
    }
}

#[test]
fn what_is_no_curve_is_left_out_and_named() {
    let nan = [Vec3::ZERO, Vec3::NAN, Vec3::Y];
    let source = curves(&[&[Vec3::ONE; 4], &straight(5.0), &nan, &[Vec3::X]]);
    let (out, said) = run(&NODE, &[("source", source.into())]);
    assert_eq!(curves_of(&out[0]).curve_count(), 3);
    for (text, id) in
        [("without length", 100), ("not a finite number", 102), ("fewer than 2 points", 103)]
    {
        assert!(
            said.iter().any(|s| s.contains(text) && s.contains(&format!("{id:016x}"))),
            "{said:?}"
        );
    }
}

/// Laws of a cornrow on `scalp`; returns the largest overlap.
#[track_caller]
fn check_cornrow(scalp: &Arc<Scalp>, source: &[Vec3], sets: &[Set], what: &str) -> f32 {
    let (strands, ..) = braid(source, &[vec![("scalp", scalp.clone().into())], sets.concat()]);
    let skin = scalp.skin();
    let mut deepest = f32::MAX;
    for (tuft, i) in strands.each() {
        for (k, p) in tuft.range(i).zip(tuft.curve(i)) {
            let (d, r) = (skin.distance(*p), tuft.view(attr::RADIUS).at(i, k));
            let allowed: f32 = tuft.view(attr::ALLOW_DEPTH).at(i, k);
            deepest = deepest.min(d + allowed);
            assert!(d - r + allowed > -1e-3, "{what}: tube {} deep", r - d);
        }
        assert!(tuft.view(attr::ROOT_TRIANGLE).at(i, 0) >= 0);
    }
    assert!(deepest > -1e-4, "{what}: {deepest}");
    let strands = CvStrand::all(&strands);
    let (worst, touching) = overlap(&strands);
    assert!(worst <= 1.02, "{what}: {worst}");
    assert!(touching > 0.07, "{what}: {touching}");
    worst
}

#[test]
fn cornrows_lie_on_the_ball_and_keep_their_word() {
    let (scalp, source) = (Arc::new(ball()), over_the_ball());
    let spline = Spline::new(&source).unwrap();
    let mut worst = 0.0f32;
    for n in 2..=7i64 {
        for (mode, sink) in [
            ("flatten", 0.0f32),
            ("flatten", 1.0),
            ("push_out", 0.6),
            ("allow", 0.0),
            ("allow", 0.7),
        ] {
            let set = vec![
                ("strands", n.into()),
                ("scalp_intersection", mode.into()),
                ("sink", sink.into()),
                ("phase", 7.0f32.into()),
                ("stitches_by", "count".into()),
                ("stitches", 20.0f32.into()),
            ];
            let what = format!("{n} {mode} {sink}");
            worst = worst.max(check_cornrow(&scalp, &source, std::slice::from_ref(&set), &what));
            let (strands, ..) = braid(&source, &[set, vec![("scalp", scalp.clone().into())]]);
            let strands = CvStrand::all(&strands);
            let got = braid_signs(&strands, &spline, &on_ball(&source), (0.0, 0.9), 20.0, &what);
            let m = default_frequency(n as u32);
            assert_eq!(got, path_signs(&Weave::new(n as u32, m, true, false)), "{what}");
            // The top of the braid has the right height.
            let high = |s: &CvStrand| {
                let tops = s.samples(2).into_iter().filter(|(.., u)| (0.1..0.2).contains(u));
                tops.map(|(p, r, _)| p.length() + r - 8.9).fold(0.0, f32::max)
            };
            let top = strands.iter().map(high).fold(0.0, f32::max);
            let flat = if n == 2 { 1.0 } else { 0.5 };
            let want = flat * if mode == "push_out" { 1.0 } else { 1.0 - 0.5 * sink };
            assert!((top / want - 1.0).abs() < 0.12, "{what}: {top} {want}");
        }
    }
    println!("largest overlap on the ball {worst}");
}

#[test]
fn a_source_under_or_off_the_skin_still_gives_a_braid_outside() {
    let scalp = Arc::new(ball());
    for lift in [-0.5f32, -0.2, 0.1, 0.4] {
        let source: Vec<Vec3> = over_the_ball().iter().map(|p| p * (1.0 + lift / 8.9)).collect();
        for mode in ["flatten", "push_out", "allow"] {
            for frames in ["scalp", "minimal", "up_axis"] {
                let set = vec![
                    ("scalp_intersection", mode.into()),
                    ("frames", frames.into()),
                    ("root_gather", 0.0f32.into()),
                ];
                let deep_root = frames != "scalp" && lift < 0.0;
                if mode == "allow" || !deep_root {
                    check_cornrow(&scalp, &source, &[set], &format!("{lift} {mode} {frames}"));
                }
            }
        }
    }
}

/// The built-in head, and lps_head if available.
pub(super) fn heads() -> Vec<Arc<Scalp>> {
    let made = |set: &[(&str, Value)]| match &run(crate::by_id("head").unwrap(), set).0[0] {
        Value::Scalp(scalp) => scalp.clone(),
        other => panic!("a {}", other.type_name()),
    };
    let mut heads = vec![made(&[])];
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/lps_head/LeePerrySmith.glb");
    match std::fs::read(path) {
        Ok(bytes) => {
            let file = FileData {
                path: path.to_owned(),
                extension: "glb".to_owned(),
                bytes: bytes.into(),
                sides: BTreeMap::new(),
            };
            heads.push(made(&[("mesh", Value::File(Arc::new(file)))]));
        }
        Err(_) => println!(
            "skipped: cornrows_lie_on_the_built_in_head_and_on_a_real_one:lps_head needs ../shared"
        ),
    }
    heads
}

/// A row over the head from forehead to nape, at this distance to the side.
pub(super) fn row(scalp: &Scalp, side: f32) -> Vec<Vec3> {
    let centre = scalp.frame().origin + Vec3::X * side;
    let point = |k: usize| {
        let (s, c) = sin_cos_turns(0.1 + 0.35 * k as f32 / 29.0);
        let from = centre + Vec3::new(0.0, s, c) * 20.0;
        Some(scalp.surface().ray(from, (centre - from).normalize(), 40.0)?.point)
    };
    (0..30).filter_map(point).collect()
}

#[test]
fn cornrows_lie_on_the_built_in_head_and_on_a_real_one() {
    for scalp in heads() {
        for side in [-4.0f32, -1.5, 1.5, 4.0] {
            let source = row(&scalp, side);
            assert!(source.len() > 20, "{side}");
            for (mode, n) in [("flatten", 3i64), ("flatten", 5), ("push_out", 3), ("allow", 4)] {
                let set = vec![("strands", n.into()), ("scalp_intersection", mode.into())];
                let what = format!("{scalp:?} {side} {mode} {n}");
                check_cornrow(&scalp, &source, std::slice::from_ref(&set), &what);
            }
        }
    }
}

#[test]
fn editing_one_source_braids_one_again() {
    let host = Memory::default();
    let ran = |moved: f32| {
        let mut all: Vec<Vec<Vec3>> = (0..20)
            .map(|k| straight(5.0).iter().map(|p| *p + Vec3::X * k as f32).collect())
            .collect();
        all[7][1].z += moved;
        let all: Vec<&[Vec3]> = all.iter().map(Vec::as_slice).collect();
        let (log, set) = (Log::default(), [("source", curves(&all).into())]);
        run_on(&NODE, &set, &host, &log, Quality::Final).unwrap();
        log.tufts_run.into_inner()
    };
    assert_eq!([ran(0.0), ran(0.0), ran(0.3)], [20, 0, 1]);
}

#[test]
fn a_longer_source_keeps_the_stitches_it_has() {
    let stitches = |length: f32| {
        let uneven = vec![("uneven_stitches", 0.5f32.into()), ("stitch_spacing", 0.6f32.into())];
        let (_, stitches, _) = braid(&straight(length), &[bare(), uneven]);
        stitches.tufts()[0].points().to_vec()
    };
    let (short, long) = (stitches(6.0), stitches(9.0));
    assert!(long.len() > short.len());
    for (a, b) in short.iter().zip(&long) {
        assert!((a.y - b.y).abs() < 5e-3, "{a} {b}");
    }
}

#[test]
fn more_flyaways_only_add_to_them() {
    let ids = |count: f32| {
        let set = [("source", curves(&[&straight(5.0)]).into()), ("flyaways", count.into())];
        let (out, _) = run(&NODE, &set);
        let all = curves_of(&out[2]);
        assert!(all.each().all(|(t, i)| t.curve(i).iter().all(|p| p.is_finite())));
        all.each().map(|(t, i)| t.id(i)).collect::<Vec<_>>()
    };
    let (few, many) = (ids(5.0), ids(20.0));
    assert_eq!((few.len(), many.len()), (23, 90));
    assert_eq!(few, many[..few.len()]);
}

#[test]
fn what_is_loose_beyond_the_tie_rests_on_the_skin() {
    let (scalp, source) = (Arc::new(ball()), over_the_ball());
    let skin = scalp.skin();
    for (length, flyaway) in [(4.0f32, 0.5f32), (15.0, 2.0), (60.0, 8.0)] {
        let set = [
            ("source", curves(&[&source]).into()),
            ("scalp", scalp.clone().into()),
            ("tuft_length", length.into()),
            ("flyaways", 10.0f32.into()),
            ("flyaway_length", flyaway.into()),
        ];
        let (out, _) = run(&NODE, &set);
        let deep = depth::measure(&MeasuredHair::of(curves_of(&out[0]), &PlainHost), &scalp);
        assert_eq!(deep.too_deep, 0, "tuft {length}: {deep:?}");
        for (tuft, i) in curves_of(&out[0]).each() {
            let drawn = Spline::new(tuft.curve(i)).unwrap().length();
            assert!(drawn > length, "tuft {length}: {drawn}");
        }
        let unit = scalp.frame().unit();
        for (tuft, i) in curves_of(&out[2]).each() {
            let points = tuft.curve(i);
            assert!(points[1..].iter().all(|p| skin.distance(*p) > -1e-3), "flyaway {flyaway}");
            let long = Spline::new(points).unwrap().length() / unit;
            assert!((0.3 * flyaway..1.03 * flyaway).contains(&long), "{flyaway}: {long}");
        }
    }
}

#[test]
fn the_talks_formula_and_a_weave_that_does_not_fit_are_told() {
    let (.., said) = braid(&straight(5.0), &[set("formula", "lightyear"), set("strands", 4i64)]);
    assert!(said.iter().any(|s| s.contains("pass through each other")), "{said:?}");
    let (.., said) = braid(&straight(5.0), &[set("weave", 2i64), set("strands", 4i64)]);
    assert!(said.iter().any(|s| s.contains("3 was taken")), "{said:?}");
    let (.., said) = braid(&straight(5.0), &[set("stitch_spacing", 0.2f32)]);
    assert!(said.iter().any(|s| s.contains("strands are thin")), "{said:?}");
}
