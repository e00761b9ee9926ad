//! Laws of braid territory and braid hair, read from what the nodes give, on a ball and on the built-in head.
//!
//! Which hair crosses a parting is read from the lanes between rows: rows alone draw no lines that `laws` could read.

use super::ground::{Lane, RowIndex};
use super::laws::heads;
use super::{braid_hair, braid_territory, lissajous_braid};
use crate::data::attributes as attr;
use crate::data::attributes::Domain;
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::field::Field;
use crate::data::scalp::{Scalp, tests::shared_ball};
use crate::define::Value;
use crate::eval::PlainHost;
use crate::laws::{MeasuredHair, depth, roots};
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos_turns;
use crate::testing::{curves_of, run};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

type Set = Vec<(&'static str, Value)>;

/// Rows from front to back beside each other, `apart` degrees about the axis through the ears.
fn rows(scalp: &Scalp, count: usize) -> Curves {
    let row = |r: usize| {
        let tilt = (r as f32 - 0.5 * (count - 1) as f32) * 0.045;
        let point = |k: usize| {
            let (s, c) = sin_cos_turns(0.1 + 0.28 * k as f32 / 29.0);
            let (x, up) = sin_cos_turns(tilt);
            let way = Vec3::new(x, s * up, c * up);
            Some(scalp.surface().ray(scalp.frame().origin + way * 20.0, -way, 40.0)?.point)
        };
        let mut b = TuftBuilder::new();
        b.push_curve(&(0..30).filter_map(point).collect::<Vec<_>>());
        b.set(attr::ID, Domain::Curve, vec![50 + r as u64]);
        Arc::new(b.build())
    };
    Curves::new((0..count).map(row).collect())
}

struct Made {
    roots: Curves,
    source: Curves,
    strands: Curves,
    stitches: Curves,
    hair: Curves,
    extension: Curves,
    bands: Curves,
}

fn made(scalp: &Arc<Scalp>, rows: &Curves, territory: Set, hair: Set) -> Made {
    let mut set: Set = vec![("source", rows.clone().into()), ("scalp", scalp.clone().into())];
    set.extend(territory);
    let (out, _) = run(&braid_territory::NODE, &set);
    let (roots, source) = (curves_of(&out[0]).clone(), curves_of(&out[1]).clone());
    let width = Field::Product(vec![Field::Attribute("girth".into()), Field::Constant(1.2)]);
    let (out, _) = run(
        &lissajous_braid::NODE,
        &[
            ("source", source.clone().into()),
            ("scalp", scalp.clone().into()),
            ("width", Value::Field(Arc::new(width))),
        ],
    );
    let (strands, stitches) = (curves_of(&out[0]).clone(), curves_of(&out[1]).clone());
    let mut set: Set = vec![
        ("roots", roots.clone().into()),
        ("strands", strands.clone().into()),
        ("stitches", stitches.clone().into()),
        ("scalp", scalp.clone().into()),
        ("flyaways", 0.0f32.into()),
        ("fill", 1.0f32.into()),
        ("broad", 0.0f32.into()),
    ];
    set.extend(hair);
    let (out, _) = run(&braid_hair::NODE, &set);
    let [hair, extension, bands] = [0, 1, 2].map(|k| curves_of(&out[k]).clone());
    Made { roots, source, strands, stitches, hair, extension, bands }
}

fn ground(scalp: &Scalp, rows: &Curves) -> RowIndex {
    let lane = |(tuft, i): (&Tuft, usize)| {
        Lane::new(tuft.id(i), &Spline::new(tuft.curve(i)).unwrap(), scalp, 0.9, None)
    };
    RowIndex::new(rows.each().filter_map(lane).collect(), scalp)
}

/// Points by id.
fn by_id(curves: &Curves) -> BTreeMap<u64, Vec<Vec3>> {
    let all: BTreeMap<_, _> = curves.each().map(|(t, i)| (t.id(i), t.curve(i).to_vec())).collect();
    assert_eq!(all.len(), curves.curve_count(), "ids are unique");
    all
}

#[test]
fn every_root_joins_once_at_its_stitch_and_stays_in_its_strand() {
    let all = heads().into_iter().chain([shared_ball()]);
    for (scalp, what) in all.zip(["bust", "scan or ball", "ball"]) {
        let rows = rows(&scalp, 5);
        let m =
            made(&scalp, &rows, vec![("density", 12.0f32.into())], vec![("frizz", 0.0f32.into())]);
        assert!(m.hair.curve_count() > 1500, "{what}: {}", m.hair.curve_count());
        assert_eq!(m.hair.curve_count(), m.roots.curve_count(), "{what}");
        let ground = ground(&scalp, &rows);
        let unit = scalp.frame().unit();
        let mut tubes: BTreeMap<u64, (Vec<(Vec3, f32)>, u64)> = BTreeMap::new();
        for (tuft, i) in m.strands.each() {
            let spline = Spline::new(tuft.curve(i)).unwrap();
            let radius = tuft.view(attr::RADIUS);
            let first = tuft.range(i).start;
            let at = |k: usize| {
                let u = k as f32 / 1500.0;
                let place = spline.locate(u);
                let (a, b) = (first + place.span, first + place.span + 1);
                let r = radius.at(i, a) + (radius.at(i, b) - radius.at(i, a)) * place.t;
                (spline.point(place), r)
            };
            let parent = tuft.view(attr::PARENT).at(i, first);
            tubes.insert(tuft.id(i), ((0..=1500).map(at).collect(), parent));
        }
        let deepest = depth::measure(&MeasuredHair::of(&m.hair, &PlainHost), &scalp).deepest_cm;
        let rooted = roots::off_their_places(&m.hair, &scalp);
        let (mut crossed, mut uneven, mut out, mut points) = (0, 0, 0.0f32, 0);
        for (n, (tuft, i)) in m.hair.each().enumerate() {
            let first = tuft.range(i).start;
            let curve = tuft.curve(i);
            assert!(curve.len() <= 255 && curve.iter().all(|p| p.is_finite()), "{what}");
            let own = ground.owner(&scalp, curve[0], |_| true).unwrap();
            assert!(own.ahead >= 0.15 * unit - 1e-4, "{what}: rooted in a parting");
            let (tube, row) = &tubes[&tuft.view(attr::PARENT).at(i, first)];
            assert_eq!(ground.lanes[own.lane as usize].id, *row, "{what}");
            assert!(tuft.view(attr::STITCH).at(i, first) >= 0);
            if n % 7 != 0 {
                continue;
            }
            let along = tuft.view(attr::ALONG);
            let enters = along.at(i, first) + 1e-6;
            let joins = tuft.range(i).position(|k| along.at(i, k) > enters).unwrap_or(0);
            for (k, p) in curve.iter().enumerate() {
                points += 1;
                if k < joins {
                    let here = ground.owner(&scalp, *p, |_| true).unwrap();
                    crossed += usize::from(here.lane != own.lane);
                } else {
                    let off = tube.iter().map(|(c, r)| p.distance(*c) / r.max(0.03));
                    let last = along.at(i, first + k) > 0.86;
                    // Behind the tie it is the end tuft.
                    out = out.max(if last { 0.0 } else { off.fold(f32::MAX, f32::min) });
                }
                if k > 1 && k + 1 < curve.len() {
                    let (a, b) = (p.distance(curve[k - 1]), p.distance(curve[k + 1]));
                    uneven += usize::from(a.max(b) > 1.2 * a.min(b));
                }
            }
        }
        println!(
            "{what}: deepest {deepest}, crossed {crossed}, out {out}, uneven {uneven} of {points}"
        );
        assert!(rooted < 1e-3, "{what}: {rooted}");
        // (Curves that dip by 0.004 cm between points are let pass.)
        assert!(deepest < 5e-3, "{what}: {deepest}");
        // On the ball rows end amid the hair, which is combed round their ends; on the real head a few points are.
        let around = if what == "bust" { 0 } else { points / 1000 };
        assert!(crossed <= around, "{what}: {crossed} of {points} points across a parting");
        assert!(out < 1.25, "{what}: {out}");
        assert!(uneven * 250 < points, "{what}: {uneven} of {points}");
        stitches_are_the_nearest(&m);
    }
}

/// Every hair that joins at a stitch joins at the nearest one on its side.
fn stitches_are_the_nearest(m: &Made) {
    let mut stitches: BTreeMap<u64, Vec<(f32, i32)>> = BTreeMap::new();
    for (tuft, i) in m.stitches.each() {
        let range = tuft.range(i);
        let at = |k| (tuft.view(attr::ALONG).at(i, k), tuft.view(attr::SIDE).at(i, k));
        let row = tuft.view(attr::PARENT).at(i, range.start);
        stitches.insert(row, range.map(at).collect());
    }
    let place = |tuft: &Tuft, i: usize| {
        let first = tuft.range(i).start;
        let bary = tuft.view(attr::ROOT_BARY).at(i, first);
        (tuft.view(attr::ROOT_TRIANGLE).at(i, first), bary.x.to_bits(), bary.y.to_bits())
    };
    let wish: BTreeMap<(i32, u32, u32), f32> = m
        .roots
        .each()
        .map(|(t, i)| (place(t, i), t.view(attr::ALONG).at(i, t.range(i).start)))
        .collect();
    let strand_row: BTreeMap<u64, u64> = m
        .strands
        .each()
        .map(|(t, i)| (t.id(i), t.view(attr::PARENT).at(i, t.range(i).start)))
        .collect();
    let mut seen = 0;
    for (tuft, i) in m.hair.each() {
        let first = tuft.range(i).start;
        let along = wish[&place(tuft, i)];
        if along <= 0.0 {
            continue;
        }
        let all = &stitches[&strand_row[&tuft.view(attr::PARENT).at(i, first)]];
        let (at, side) = all[tuft.view(attr::STITCH).at(i, first) as usize];
        assert_eq!(side, tuft.view(attr::SIDE).at(i, first));
        let off = |a: f32| (a - along).abs();
        assert!(all.iter().filter(|s| s.1 == side).all(|s| off(s.0) >= off(at) - 1e-6));
        seen += 1;
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn a_braid_is_as_thick_as_the_hair_that_has_joined() {
    let scalp = shared_ball();
    let rows = rows(&scalp, 3);
    for feed in [0.0f32, 800.0] {
        let set =
            vec![("density", 60.0f32.into()), ("feed", feed.into()), ("feed_from", 3.0f32.into())];
        let m = made(&scalp, &rows, set, vec![]);
        assert_eq!(m.extension.curve_count(), 3 * feed as usize);
        for (tuft, i) in m.source.each() {
            let mut joins = vec![];
            for (roots, k) in m.roots.each() {
                let first = roots.range(k).start;
                if roots.view(attr::PARENT).at(k, first) == tuft.id(i) {
                    let (along, fed): (f32, i32) =
                        (roots.view(attr::ALONG).at(k, first), roots.view(attr::FED).at(k, first));
                    let length = Spline::new(tuft.curve(i)).unwrap().length();
                    assert!(fed == 0 || along * length > 2.99, "fed too early: {along}");
                    joins.push(along);
                }
            }
            let girth = tuft.view_named::<f32>("girth").unwrap();
            let joined = tuft.view_named::<f32>("joined").unwrap();
            let n = tuft.range(i).len();
            for k in (5..n).step_by(7) {
                let u = k as f32 / (n - 1) as f32;
                let share = joins.iter().filter(|a| **a <= u).count() as f32 / joins.len() as f32;
                let at = tuft.range(i).start + k;
                assert!(
                    (joined.at(i, at) - share).abs() < 0.04,
                    "{u}: {share} {}",
                    joined.at(i, at)
                );
                assert!(
                    (girth.at(i, at) - share.sqrt()).abs() < 0.06,
                    "{u}: {share} {}",
                    girth.at(i, at)
                );
            }
        }
        for (tuft, i) in m.extension.each() {
            assert_eq!(tuft.view(attr::FED).at(i, tuft.range(i).start), 1);
            assert!(tuft.view(attr::BRAID).at(i, tuft.range(i).start) != 0);
        }
    }
}

#[test]
fn hair_that_ends_makes_the_braid_thinner() {
    let scalp = shared_ball();
    // Hair too short to reach the braid would be longer than requested.
    let set = vec![
        ("density", 30.0f32.into()),
        ("length", 12.0f32.into()),
        ("reach", 4.0f32.into()),
        ("tail", 25.0f32.into()),
    ];
    let m = made(&scalp, &rows(&scalp, 1), set, vec![]);
    let girth = m.source.tufts()[0].view_named::<f32>("girth").unwrap();
    let n = m.source.tufts()[0].points().len();
    assert!(girth.at(0, n / 3) > 0.6 && girth.at(0, n - 1) < 0.15);
    for (tuft, i) in m.hair.each() {
        let length = Spline::new(tuft.curve(i)).unwrap().length();
        assert!(length < 12.0 * 1.12 && length > 6.0, "{length}");
    }
}

#[test]
fn hair_much_longer_than_its_braid_has_its_points_no_farther_apart() {
    let scalp = shared_ball();
    let hair = |length: f32| {
        let set = vec![("density", 10.0f32.into()), ("length", length.into())];
        by_id(&made(&scalp, &rows(&scalp, 1), set, vec![]).hair)
    };
    // Both end with their braid.
    let (enough, much) = (hair(50.0), hair(190.0));
    assert!(enough.len() > 300);
    for ((a, enough), (b, much)) in enough.iter().zip(&much) {
        assert_eq!(a, b);
        assert!(enough.len().abs_diff(much.len()) <= 2, "{} {}", enough.len(), much.len());
    }
}

#[test]
fn a_root_knot_is_as_much_wider_than_the_braid_as_was_asked() {
    // A braid that stands on top of a ball, with its strands gathered at its root.
    let scalp = shared_ball();
    let top = Vec3::new(0.0, 8.9, 0.0) + scalp.frame().origin;
    let foot = scalp.surface().ray(top + Vec3::Y * 20.0, -Vec3::Y, 40.0).unwrap().point;
    let mut b = TuftBuilder::new();
    b.push_curve(&(0..20).map(|k| foot + Vec3::Y * (0.6 * k as f32)).collect::<Vec<_>>());
    b.set(attr::ID, Domain::Curve, vec![50]);
    let row = Curves::new(vec![Arc::new(b.build())]);
    let make = |start: &'static str, size: f32| {
        let territory: Set = vec![("density", 60.0f32.into()), ("reach", 1.2f32.into())];
        let hair: Set = vec![
            ("root_start", start.into()),
            ("knot_size", size.into()),
            ("knot_length", 1.0f32.into()),
            ("frizz", 0.0f32.into()),
        ];
        by_id(&made(&scalp, &row, territory, hair).hair)
    };
    // How far hair reaches from the braid's centre within a height range over the scalp, except for a twentieth: single
    // hairs are still on their way in.
    let outline = |hair: &BTreeMap<u64, Vec<Vec3>>, low: f32, high: f32| {
        let points = hair.values().flat_map(|points| points.iter().map(|p| *p - foot));
        let near = points.filter(|p| p.y > low && p.y < high);
        let mut reach: Vec<f32> = near.map(|p| glam::Vec2::new(p.x, p.z).length()).collect();
        reach.sort_by(f32::total_cmp);
        reach[reach.len() * 95 / 100]
    };
    let none = make("knotless", 0.5);
    let behind = outline(&none, 1.2, 2.4);
    assert!(outline(&none, 0.15, 0.35) < 0.85 * behind, "strands are gathered at the root");
    for size in [0.0, 0.5, 1.0] {
        let knotted = make("knotted", size);
        let ratio = outline(&knotted, 0.35, 0.65) / behind;
        assert!((ratio / (1.0 + size) - 1.0).abs() < 0.15, "{size}: {ratio}");
        assert!((outline(&knotted, 1.2, 2.4) / behind - 1.0).abs() < 0.02, "{size}");
        assert_eq!(knotted.keys().collect::<Vec<_>>(), none.keys().collect::<Vec<_>>());
    }
}

#[test]
fn a_band_lies_round_its_braid_and_draws_it_together() {
    let scalp = shared_ball();
    let rows = rows(&scalp, 3);
    let tied = |turns: f32, tightness: f32| {
        let hair = vec![
            ("band_turns", turns.into()),
            ("band_height", 0.6f32.into()),
            ("band_tightness", tightness.into()),
        ];
        made(&scalp, &rows, vec![("density", 12.0f32.into()), ("tail", 8.0f32.into())], hair)
    };
    let untied = tied(0.0, 0.3);
    assert_eq!(untied.bands.curve_count(), 0);
    let mut wide = vec![];
    for tightness in [0.0, 0.4] {
        let m = tied(3.0, tightness);
        assert_eq!(m.bands.curve_count(), 3);
        let (free, held) = (by_id(&untied.hair), by_id(&m.hair));
        assert!(free.keys().eq(held.keys()));
        assert!(free.iter().all(|(id, hair)| hair[0] == held[id][0]), "roots stay");
        let (mut inside, mut outside, mut sum) = (0, 0, 0.0);
        for (band, i) in m.bands.each() {
            let points = band.curve(i);
            let (start, end) = (points[0], points[points.len() - 1]);
            let axis = (end - start).normalize();
            let out = |p: Vec3| (p - start).reject_from(axis);
            let turns = &points[1..points.len() - 1];
            assert!(turns.iter().all(|p| scalp.skin().distance(*p) > 0.0));
            // Three turns of 0.15 cm side by side, from centre to centre of the outer ones.
            let radius = band.view(attr::RADIUS).at(i, 0);
            assert!((radius - 0.075).abs() < 1e-5);
            assert!((end.distance(start) - 0.45).abs() < 0.02, "{}", end.distance(start));
            let braid = band.view(attr::PARENT).at(i, 0);
            let of_braid = |(t, h): &(&Tuft, usize)| t.view(attr::BRAID).at(*h, 0) == braid;
            for (hair, h) in m.hair.each().filter(of_braid) {
                for p in hair.curve(h) {
                    let (along, far) = ((*p - start).dot(axis), out(*p).length());
                    let beside = |a: &&Vec3| out(**a).normalize().dot(out(*p) / far) > 0.95;
                    let held = turns.iter().filter(beside).map(|a| out(*a).length());
                    let held = held.fold(f32::MAX, f32::min);
                    // Hair farther out is on its way to the braid.
                    if (0.0..=0.45).contains(&along) && far < 2.0 * held {
                        inside += usize::from(far <= held + radius);
                        outside += usize::from(far > held + radius);
                        sum += far;
                    }
                }
            }
        }
        // At its borders, a turn is beside only part of the hair.
        assert!(inside > 5000 && outside * 200 <= inside, "{outside} of {inside}");
        wide.push(sum / (inside + outside) as f32);
    }
    let ratio = wide[1] / wide[0];
    assert!((ratio - 0.6).abs() < 0.04, "{ratio}");
    // A band that the braid or tuft cannot hold is as high as they allow, or missing, and the node reports it.
    let m = tied(3.0, 0.3);
    let strands: Set = vec![("roots", m.roots.into()), ("strands", m.strands.into())];
    let said = |stitches: Option<&Curves>, height: f32| {
        let mut set = strands.clone();
        set.extend(stitches.map(|stitches| ("stitches", stitches.clone().into())));
        set.extend([("band_turns", 0.5f32.into()), ("band_height", height.into())]);
        let (out, mut said) = run(&braid_hair::NODE, &set);
        said.retain(|text| text.contains("band"));
        (curves_of(&out[2]).clone(), said)
    };
    let (bands, told) = said(Some(&m.stitches), 8.0);
    assert!(bands.curve_count() == 3 && told[0].contains("a band is lower"), "{told:?}");
    let radius = bands.tufts()[0].view(attr::RADIUS).at(0, 0);
    assert!((0.05..1.0).contains(&radius), "{radius}");
    let (bands, told) = said(None, 0.6);
    assert!(bands.curve_count() == 0 && told[0].contains("a braid without a tuft"), "{told:?}");
}

#[test]
fn a_braid_begins_behind_the_front_of_its_row_and_hair_before_it_is_combed_back() {
    let scalp = shared_ball();
    let rows = rows(&scalp, 2);
    let front = |start: f32| {
        let m =
            made(&scalp, &rows, vec![("density", 20.0f32.into()), ("start", start.into())], vec![]);
        let mut combed = vec![];
        for (tuft, i) in m.roots.each() {
            if tuft.view(attr::ALONG).at(i, tuft.range(i).start) == 0.0 {
                let row =
                    m.source.each().find(|(t, r)| t.id(*r) == tuft.view(attr::PARENT).at(i, 0));
                let (row, r) = row.unwrap();
                let along = row.curve(r)[1] - row.curve(r)[0];
                let way = tuft.curve(i);
                combed.push((way[way.len() - 1] - way[0]).dot(along.normalize()));
            }
        }
        let length = |(tuft, i): (&Tuft, usize)| Spline::new(tuft.curve(i)).unwrap().length();
        let begins: Vec<f32> =
            m.source.each().zip(rows.each()).map(|(b, row)| length(row) - length(b)).collect();
        (begins, combed)
    };
    let (begins, combed) = front(2.0);
    assert!(begins.iter().all(|x| (x - 2.0).abs() < 0.02), "{begins:?}");
    assert!(combed.len() > 20 && combed.iter().all(|back| *back > 0.0), "{combed:?}");
    // However much is requested: at most half as far as the row leads.
    let (begins, _) = front(50.0);
    assert!(begins.iter().all(|x| *x > 4.0 && *x < 10.0), "{begins:?}");
    assert!(front(0.0).0.iter().all(|x| *x < 1e-3));
}

#[test]
fn hair_far_from_its_row_is_combed_as_its_neighbours_are() {
    // At the temple, a row from forehead to nape is about equally near all along: its nearest position jumps.
    let scalp = heads().remove(0);
    let set: Set = vec![
        ("source", rows(&scalp, 2).into()),
        ("scalp", scalp.clone().into()),
        ("density", 16.0f32.into()),
        ("pull_angle", 40.0f32.into()),
    ];
    let (out, _) = run(&braid_territory::NODE, &set);
    let far = |way: &[Vec3]| way[0].distance(way[way.len() - 1]) > 4.0;
    let ways: Vec<Vec<Vec3>> = by_id(curves_of(&out[0])).into_values().filter(|w| far(w)).collect();
    let towards = |way: &[Vec3]| (way[2] - way[0]).normalize();
    let (mut pairs, mut apart) = (0, 0);
    for (k, a) in ways.iter().enumerate() {
        for b in ways[k + 1..].iter().filter(|b| b[0].distance_squared(a[0]) < 0.4 * 0.4) {
            pairs += 1;
            apart += usize::from(towards(a).dot(towards(b)) < 0.87);
        }
    }
    println!("{apart} of {pairs} pairs of {} hairs", ways.len());
    assert!(pairs > 1000 && apart * 200 < pairs, "{apart} of {pairs}");
}

#[test]
fn more_density_only_adds_hairs() {
    let scalp = shared_ball();
    let rows = rows(&scalp, 3);
    let hair =
        |density: f32| by_id(&made(&scalp, &rows, vec![("density", density.into())], vec![]).hair);
    let (few, many) = (hair(10.0), hair(25.0));
    assert!(few.len() > 1000 && many.len() > 2 * few.len());
    assert!(few.iter().all(|(id, points)| many.get(id) == Some(points)));
}

#[test]
fn one_row_takes_all_and_a_tail_keeps_off_the_skin() {
    let scalp = heads().remove(0);
    let tail = vec![("density", 12.0f32.into()), ("tail", 30.0f32.into())];
    let m = made(&scalp, &rows(&scalp, 1), tail, vec![]);
    // Every root of the region is used.
    let area: f32 = (0..scalp.surface().triangles.len() as u32)
        .map(|t| {
            let region = scalp.grows(t, glam::Vec2::splat(1.0 / 3.0));
            0.5 * scalp.surface().area_vector(t).length() * region
        })
        .sum();
    let count = m.hair.curve_count() as f32;
    assert!((count / (12.0 * area) - 1.0).abs() < 0.05, "{count} {area}");
    let row = &m.source.tufts()[0];
    let skin = scalp.skin();
    let hanging = row.points().len() * 3 / 5;
    assert!(row.points()[hanging..].iter().all(|p| skin.distance(*p) > 0.3));
    let last = row.points()[row.points().len() - 1];
    assert!(last.y < -20.0 && skin.distance(last) > 0.5, "{last}");
}
