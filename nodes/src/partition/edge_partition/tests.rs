//! Laws of `edge_partition`: where its hairs begin, end and lie, and what an edit recomputes.

use super::*;
use crate::data::attributes::{ROOT_BARY, ROOT_TRIANGLE};
use crate::data::scalp::{HEAD_RADIUS, HeadFrame, REGION};
use crate::define::{FileData, Value};
use crate::eval::{Log, Quality};
use crate::maths::closest::Surface;
use crate::maths::spline::Spline;
use crate::maths::transcendental::sin_cos_turns;
use crate::testing::{Memory, curves_of, run, run_on};
use std::sync::atomic::Ordering;

fn on(surface: Surface, radius: f32) -> Arc<Scalp> {
    let region = vec![1.0; surface.points.len()];
    let frame = HeadFrame { radius, ..HeadFrame::IDENTITY };
    Arc::new(Scalp::new(surface, None, frame, [(REGION.to_owned(), region)].into()))
}

fn ball(radius: f32) -> Arc<Scalp> {
    on(crate::maths::closest::tests::sphere(radius, 64), radius)
}

/// Shared by all tests, since its distance field takes a second.
fn bust() -> Arc<Scalp> {
    static BUST: std::sync::OnceLock<Arc<Scalp>> = std::sync::OnceLock::new();
    let make = || {
        let mesh = crate::scalp::bust::adult();
        on(Surface::new(mesh.points, mesh.triangles), HEAD_RADIUS)
    };
    BUST.get_or_init(make).clone()
}

/// A scanned head with its default region; `None` if this machine does not have it.
fn scanned() -> Option<Arc<Scalp>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/lps_head/LeePerrySmith.glb");
    let bytes = std::fs::read(path).ok()?.into();
    let (path, extension) = ("head.glb".to_owned(), "glb".to_owned());
    let file = FileData { path, extension, bytes, sides: BTreeMap::new() };
    let head = crate::by_id("head")?;
    match run(head, &[("mesh", Value::File(Arc::new(file)))]).0.remove(0) {
        Value::Scalp(scalp) => Some(scalp),
        _ => None,
    }
}

/// A row over the scalp through the directions that `way` returns for 0 to 1, `radius` cm thick, 0.1 cm off it.
fn row(scalp: &Scalp, id: u64, radius: f32, way: impl Fn(f32) -> Vec3) -> Arc<Tuft> {
    let unit = scalp.frame().unit();
    let points: Vec<Vec3> = (0..=24)
        .map(|k| {
            let p = scalp.frame().point_from_head(way(k as f32 / 24.0) * 9.5);
            lay::laid(scalp, p, 0.1 * unit).0
        })
        .collect();
    let mut b = TuftBuilder::new();
    b.push_curve(&points);
    b.set(ID, Domain::Curve, vec![id]);
    b.set(RADIUS, Domain::Curve, vec![radius * unit]);
    Arc::new(b.build())
}

/// Straight back over the head, from forehead to nape, `x` cm off the midline.
fn back(x: f32) -> impl Fn(f32) -> Vec3 {
    move |t| {
        let (s, c) = sin_cos_turns(0.16 - 0.42 * t);
        Vec3::new(x / 9.5, c, s).normalize_or(Vec3::Y)
    }
}

/// `n` rows back over the head, 1.9 cm apart.
fn rows(scalp: &Scalp, n: usize) -> Vec<Arc<Tuft>> {
    (0..n)
        .map(|i| row(scalp, i as u64 + 1, 0.4, back((i as f32 - (n - 1) as f32 / 2.0) * 1.9)))
        .collect()
}

/// Rows in random directions and of random thickness, as close as braids can lie.
fn wild(scalp: &Scalp, seed: u64) -> Vec<Arc<Tuft>> {
    let dice = Dice::new(seed, 0, "rows");
    let mut rows: Vec<(Arc<Tuft>, f32)> = vec![];
    for id in 0..60 {
        let way = |k| {
            let (s, c) = sin_cos_turns(dice.unit(id, k));
            let up = dice.range(id, 1 + k, 0.1, 1.0);
            Vec3::new(s, 0.0, c) * (1.0 - up * up).max(0.0).sqrt() + Vec3::Y * up
        };
        let (from, to, radius) = (way(0), way(2), dice.range(id, 9, 0.1, 0.6));
        let row =
            row(scalp, id + 1, radius, |t| from.lerp(to, t).try_normalize().unwrap_or(Vec3::Y));
        let line = rows_of(&row).next().unwrap();
        let apart = |(other, r): &(Arc<Tuft>, f32)| {
            let room = radius + r + 0.2;
            other.points().iter().all(|p| line.nearest(*p).1 > room)
        };
        if line.length() > 2.0 && rows.iter().all(apart) {
            rows.push((row, radius));
        }
    }
    rows.into_iter().map(|(row, _)| row).collect()
}

#[track_caller]
fn parted(scalp: &Arc<Scalp>, rows: &[Arc<Tuft>], set: &[(&str, Value)]) -> Curves {
    let fixed = [("source", Curves::new(rows.to_vec()).into()), ("scalp", scalp.clone().into())];
    let (out, said) = run(&NODE, &[&fixed, set].concat());
    let expected = ["no ground", "lengths are "];
    assert!(said.iter().all(|s| expected.iter().any(|e| s.starts_with(e))), "{said:?}");
    curves_of(&out[0]).clone()
}

/// The measured quantities of the laws, at their worst.
#[derive(Debug, Default)]
struct Worst {
    root: f32,
    bound: f32,
    out_of_braid: f32,
    depth: f32,
    spacing: f32,
    margin: f32,
    trespass: f32,
}

fn worst(scalp: &Arc<Scalp>, rows: &[Arc<Tuft>], curves: &Curves) -> Worst {
    let skin = scalp.skin();
    let overs = Overs::new(scalp, rows.len(), 6.0);
    let lines = rows.iter().flat_map(|t| rows_of(t)).map(|row| overs.give(row));
    let lines: Vec<Row> = lines.collect();
    let mut w = Worst { margin: f32::MAX, ..Worst::default() };
    for (tuft, i) in curves.each() {
        let points = tuft.curve(i);
        assert!(points.iter().all(|p| p.is_finite()));
        let first = tuft.range(i).start;
        let own = lines.iter().find(|l| l.id == tuft.view(PARENT).at(i, first)).unwrap();
        w.root = w.root.max(scalp.surface().closest(points[0]).unwrap().distance);
        let triangle = tuft.view(ROOT_TRIANGLE).at(i, first) as u32;
        let bound = scalp.root(triangle, tuft.view(ROOT_BARY).at(i, first)).point;
        w.bound = w.bound.max(bound.distance(points[0]));
        let source = rows.iter().find(|t| t.id(0) == own.id).unwrap();
        let end = points[points.len() - 1];
        w.out_of_braid = w.out_of_braid.max(own.nearest(end).1 - source.view(RADIUS).at(0, 0));
        let spline = Spline::new(points).unwrap();
        for k in 1..60 {
            let d = -skin.distance(spline.at(k as f32 / 60.0));
            w.depth = w.depth.max(d);
        }
        for p in points.windows(3) {
            let ratio = p[0].distance(p[1]) / p[1].distance(p[2]);
            w.spacing = w.spacing.max(ratio.max(1.0 / ratio));
        }
        let others = lines.iter().filter(|l| l.id != own.id);
        let ahead = |p: Vec3| {
            let far = |l: &Row| l.far(scalp, p, l.nearest(p).1);
            others.clone().map(far).fold(f32::MAX, f32::min) - far(own)
        };
        w.margin = w.margin.min(ahead(points[0]));
        for p in &points[1..] {
            w.trespass = w.trespass.max(-ahead(*p));
        }
    }
    w
}

#[test]
fn hairs_run_from_the_scalp_into_their_braid_and_stay_out_of_the_skin() {
    let mut all = vec![];
    let mut heads = vec![("ball", ball(HEAD_RADIUS)), ("bust", bust())];
    match scanned() {
        Some(scalp) => heads.push(("scanned", scalp)),
        None => println!("skipped: hairs_run_from_the_scalp (scanned head) needs ../shared"),
    }
    for (name, scalp) in heads {
        let sets = [
            ("rows", rows(&scalp, 6)),
            ("wild", wild(&scalp, 1)),
            ("wild", wild(&scalp, 2)),
            ("wild", wild(&scalp, 3)),
        ];
        for (what, rows) in sets {
            let curves = parted(&scalp, &rows, &[("per_cm", Value::Float(12.0))]);
            let w = worst(&scalp, &rows, &curves);
            println!("{name} {what}: {} rows, {} hairs {w:?}", rows.len(), curves.curve_count());
            all.push((name, what, w));
        }
    }
    for (name, what, w) in all {
        assert!(w.root < 1e-3 && w.bound < 1e-3, "{name} {what}: {w:?}");
        assert!(w.out_of_braid < 1e-3, "{name} {what}: {w:?}");
        assert!(w.depth < 5e-4, "{name} {what}: {w:?}");
        assert!(w.spacing < 1.2, "{name} {what}: {w:?}");
        assert!(w.margin > 0.15 - 2e-3, "{name} {what}: {w:?}");
        assert!(w.trespass < 0.01, "{name} {what}: {w:?}");
    }
}

#[test]
fn on_a_parted_scalp_rows_mind_their_neighbours_and_their_section() {
    let Value::Scalp(scalp) = run(crate::by_id("head").unwrap(), &[]).0.remove(0) else {
        panic!("a head")
    };
    let partings = crate::by_id("partings").unwrap();
    let set = [
        ("scalp", scalp.clone().into()),
        ("pattern", "straight_back".into()),
        ("count", Value::Int(3)),
    ];
    let (out, _) = run(partings, &set);
    let [Value::Scalp(cut), Value::Curves(lines), ..] = &out[..] else { panic!("a scalp") };
    let rows = rows(&scalp, 6);
    let overs = Overs::new(&scalp, rows.len(), 6.0);
    let lines_of = |rows: &[Arc<Tuft>]| {
        rows.iter().flat_map(|t| rows_of(t)).map(|row| overs.give(row)).collect()
    };
    let lines: [Vec<Row>; 2] = [lines_of(&rows), lines_of(lines.tufts())];
    let near = |of: &[Row], p: Vec3| of.iter().map(|l| l.nearest(p).1).fold(9.0, f32::min);
    let sections = cut.sections().unwrap();
    assert!(
        lines[1].len() >= 2 && rows.len() > sections.list().len(),
        "{} partings, {} sections",
        lines[1].len(),
        sections.list().len()
    );
    for grouping in ["none", "every_k"] {
        let set = [("per_cm", Value::Float(12.0)), ("grouping", grouping.into())];
        let curves = parted(cut, &rows, &set);
        let mut of: BTreeMap<u64, usize> = BTreeMap::new();
        for (tuft, i) in curves.each() {
            let points = tuft.curve(i);
            let own = tuft.view(PARENT).at(i, tuft.range(i).start);
            *of.entry(own).or_default() += 1;
            let (mine, others): (Vec<_>, Vec<_>) = lines[0].iter().partition(|l| l.id == own);
            assert!(near(&lines[1], points[0]) > sections.widest_half() - 2e-3);
            // Rows of other sections matter no more than the line in between.
            let home = cut.home(points[0]).unwrap();
            for l in others.iter().filter(|l| home.holds(l.spline.at(0.5))) {
                let far = |l: &Row| l.far(&scalp, points[0], l.nearest(points[0]).1);
                let ahead = far(l) - far(mine[0]);
                assert!(ahead > 0.15 - 2e-3, "{grouping}: {ahead}");
            }
            let crossed = points.windows(2).filter(|w| home.crosses(w[0], w[1])).count();
            assert_eq!(crossed, 0, "{grouping}");
        }
        assert_eq!(of.len(), rows.len(), "{grouping}: every row has hair");
        println!("{grouping}: {of:?}");
    }
}

#[test]
fn no_hair_crosses_a_hair_of_another_row() {
    let scalp = ball(HEAD_RADIUS);
    let few = ("per_cm", Value::Float(6.0));
    for (what, rows) in [("rows", rows(&scalp, 6)), ("wild", wild(&scalp, 2))] {
        for grouping in ["none", "every_k"] {
            let set = [few.clone(), ("grouping", grouping.into()), ("jitter", Value::Float(0.9))];
            let curves = parted(&scalp, &rows, &set);
            assert_eq!(crossings(&curves), 0, "{what} {grouping}");
        }
    }
    // The law can fail: with crossing allowed and roots at the neighbour, hairs do cross.
    let set = [few, ("cross_partings", true.into()), ("mediate", Value::Float(0.9))];
    assert!(crossings(&parted(&scalp, &rows(&scalp, 6), &set)) > 100);
}

/// Pairs of crossing segments of hairs of different rows, seen from the centre of the ball.
fn crossings(curves: &Curves) -> usize {
    let mut all: Vec<(u64, Vec3, Vec3)> = vec![];
    for (tuft, i) in curves.each() {
        let row = tuft.view(PARENT).at(i, tuft.range(i).start);
        all.extend(tuft.curve(i).windows(2).map(|w| (row, w[0], w[1])));
    }
    let mut count = 0;
    for (i, (row, a, b)) in all.iter().enumerate() {
        let plane = a.cross(*b);
        for (other, c, d) in &all[i + 1..] {
            if row == other || a.distance_squared(*c) > 4.0 {
                continue;
            }
            let second = c.cross(*d);
            let apart = plane.dot(*c) * plane.dot(*d);
            if apart < 0.0 && second.dot(*a) * second.dot(*b) < 0.0 {
                count += 1;
            }
        }
    }
    count
}

#[test]
fn mediate_places_the_root_between_the_row_and_its_neighbour() {
    let scalp = ball(HEAD_RADIUS);
    let rows = rows(&scalp, 2);
    let lines: Vec<Row> = rows.iter().flat_map(|t| rows_of(t).collect::<Vec<_>>()).collect();
    for (mediate, crossing, want) in [
        (0.0, true, 0.0),
        (0.25, true, 0.25),
        (0.5, true, 0.5),
        (1.0, true, 1.0),
        (1.0, false, 0.46),
    ] {
        let set = [
            ("mediate", Value::Float(mediate)),
            ("cross_partings", crossing.into()),
            ("jitter", Value::Float(0.0)),
            ("open_side", Value::Float(0.0)),
            ("lead", Value::Float(0.0)),
            ("per_cm", Value::Float(5.0)),
        ];
        let curves = parted(&scalp, &rows, &set);
        assert!(curves.curve_count() > 100);
        for (tuft, i) in curves.each() {
            let own = tuft.view(PARENT).at(i, tuft.range(i).start);
            let [home, other] = [own == 1, own == 2]
                .map(|first| lines[usize::from(!first)].nearest(tuft.curve(i)[0]).1);
            // Rows lie 0.1 cm above the scalp, which is the whole distance at their foot.
            let part = home / (home + other);
            assert!((part - want).abs() < 0.06, "{mediate} {crossing}: {part}");
        }
    }
}

#[test]
fn ends_of_a_group_lie_within_its_radius() {
    for scalp in [ball(HEAD_RADIUS), bust()] {
        let rows = rows(&scalp, 3);
        let stitches = Curves::new(rows.iter().map(|row| stitched(row)).collect());
        let dashes = |row: &Arc<Tuft>| {
            let mut b = TuftBuilder::new();
            for k in [3, 9, 15, 21] {
                let p = row.curve(0)[k];
                b.push_curve(&[p, p * 1.05]);
            }
            Arc::new(b.build())
        };
        let picked = Curves::new(rows.iter().map(dashes).collect());
        let per_row = [("stitches", 20), ("picked", 8), ("every_k", 0)];
        for (grouping, groups) in per_row {
            let set = [
                ("grouping", grouping.into()),
                ("stitches", stitches.clone().into()),
                ("picked", picked.clone().into()),
                ("per_cm", Value::Float(10.0)),
            ];
            let curves = parted(&scalp, &rows, &set);
            let mut ends: BTreeMap<(u64, i32), Vec<Vec3>> = BTreeMap::new();
            for (tuft, i) in curves.each() {
                let first = tuft.range(i).start;
                let group = (tuft.view(PARENT).at(i, first), tuft.view(GROUP).at(i, first));
                let end = tuft.curve(i)[tuft.curve(i).len() - 1];
                ends.entry(group).or_default().push(end);
                if grouping == "stitches" {
                    assert_eq!(tuft.view(BRAID).at(i, first), group.0 + 100);
                }
            }
            for (group, ends) in &ends {
                let far = |a: &Vec3| ends.iter().map(|b| a.distance(*b)).fold(0.0, f32::max);
                let across = ends.iter().map(far).fold(0.0, f32::max);
                assert!(across <= 0.2001, "{grouping} {group:?}: {across}");
            }
            assert!(groups == 0 || ends.len() == groups * 3, "{grouping}: {}", ends.len());
            let w = worst(&scalp, &rows, &curves);
            assert!(w.out_of_braid < 1e-3 && w.depth < 5e-4, "{grouping}: {w:?}");
            assert!(w.spacing < 1.2 && w.trespass < 0.01, "{grouping}: {w:?}");
        }
    }
}

/// Ten stitches on each side of a row, as a braid would have them.
fn stitched(row: &Tuft) -> Arc<Tuft> {
    let spline = Spline::new(row.curve(0)).unwrap();
    let mut b = TuftBuilder::new();
    let along: Vec<f32> = (0..20).map(|k| (k as f32 + 0.5) / 20.0).collect();
    b.push_curve(&along.iter().map(|u| spline.at(*u)).collect::<Vec<_>>());
    b.set(PARENT, Domain::Curve, vec![row.id(0)]);
    b.set(BRAID, Domain::Curve, vec![row.id(0) + 100]);
    b.set(ALONG, Domain::Point, along);
    b.set(SIDE, Domain::Point, (0..20).map(|k| if k % 2 == 0 { -1 } else { 1 }).collect());
    Arc::new(b.build())
}

fn by_id(curves: &Curves) -> BTreeMap<u64, Vec<Vec3>> {
    let all = curves.each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i).to_vec()));
    let count = curves.curve_count();
    let all: BTreeMap<_, _> = all.collect();
    assert_eq!(all.len(), count, "ids are unique");
    all
}

#[test]
fn more_density_and_final_quality_only_add_hairs() {
    let scalp = ball(HEAD_RADIUS);
    let rows = rows(&scalp, 3);
    for grouping in ["none", "stitches"] {
        let stitches = Curves::new(rows.iter().map(|row| stitched(row)).collect());
        let set = |n: f32| {
            [
                ("source", Curves::new(rows.clone()).into()),
                ("scalp", scalp.clone().into()),
                ("per_cm", n.into()),
                ("grouping", grouping.into()),
                ("stitches", stitches.clone().into()),
            ]
        };
        let made = |n: f32, quality| {
            let log = Log::default();
            let host = crate::eval::PlainHost;
            by_id(curves_of(&run_on(&NODE, &set(n), &host, &log, quality).unwrap()[0]))
        };
        let all = made(20.0, Quality::Final);
        for (n, quality) in [(7.0, Quality::Final), (20.0, Quality::Preview)] {
            let few = made(n, quality);
            assert!(few.len() * 2 < all.len() && few.len() > 20);
            assert!(few.iter().all(|(id, points)| all.get(id) == Some(points)));
        }
    }
}

#[test]
fn editing_one_row_makes_anew_its_own_hairs_and_its_neighbours() {
    let (scalp, host) = (ball(HEAD_RADIUS), Memory::default());
    let mut rows = rows(&scalp, 7);
    let ran = |rows: &[Arc<Tuft>]| {
        let log = Log::default();
        let set = [
            ("source", Curves::new(rows.to_vec()).into()),
            ("scalp", scalp.clone().into()),
            ("per_cm", Value::Float(2.0)),
        ];
        let out = run_on(&NODE, &set, &host, &log, Quality::Final).unwrap();
        (log.tufts_run.load(Ordering::Relaxed), by_id(curves_of(&out[0])))
    };
    assert_eq!(ran(&rows).0, 7);
    rows[3] = row(&scalp, 4, 0.4, back(0.2));
    assert_eq!(ran(&rows).0, 3);
    let (_, before) = ran(&rows);
    // A distant row changes nobody's hairs.
    rows.push(row(&scalp, 99, 0.4, |t| Vec3::new(0.3 * t, -1.0, 0.3)));
    let (count, after) = ran(&rows);
    assert_eq!(count, 1);
    assert!(before.iter().all(|(id, points)| after.get(id) == Some(points)));
}

#[test]
fn wired_neighbours_are_used_instead_of_found_ones() {
    let scalp = ball(HEAD_RADIUS);
    let row_at = |id, x| Curves::new(vec![row(&scalp, id, 0.4, back(x))]);
    let middle = row_at(1, 0.0).tufts().to_vec();
    let sides = |set: &[(&str, Value)]| {
        let set =
            [set, &[("open_side", Value::Float(0.0)), ("per_cm", Value::Float(5.0))]].concat();
        let curves = parted(&scalp, &middle, &set);
        let mut count = [0, 0];
        for (tuft, i) in curves.each() {
            let side = tuft.view(SIDE).at(i, tuft.range(i).start);
            // Rows run backward, against +Z: their right is at +X.
            let x = tuft.curve(i)[0].x;
            assert_eq!(side, if x > 0.0 { 1 } else { -1 });
            count[usize::from(side > 0)] += 1;
        }
        count.map(|n| n > 50)
    };
    assert_eq!(sides(&[]), [false, false]);
    assert_eq!(sides(&[("left", row_at(2, -2.0).into())]), [true, false]);
    assert_eq!(sides(&[("right", row_at(3, 2.0).into())]), [false, true]);
    let both = [row_at(2, -2.0).tufts()[0].clone(), row_at(3, 2.0).tufts()[0].clone()];
    assert_eq!(sides(&[("adjacent", Curves::new(both.to_vec()).into())]), [true, true]);
    assert_eq!(sides(&[("open_side", Value::Float(1.0))]), [true, true]);
}

#[test]
fn lengths_grow_with_the_head() {
    let hairs = |radius: f32| {
        let scalp = ball(radius);
        let curves = parted(&scalp, &rows(&scalp, 3), &[("per_cm", Value::Float(5.0))]);
        by_id(&curves)
    };
    let (one, two) = (hairs(HEAD_RADIUS), hairs(2.0 * HEAD_RADIUS));
    assert_eq!(one.len(), two.len());
    let mut far = 0;
    for (id, points) in &one {
        let off = points.iter().zip(&two[id]).map(|(a, b)| a.distance(*b * 0.5));
        far += usize::from(off.fold(0.0, f32::max) > 0.02);
    }
    // Searches step in true centimetres, so a few hairs at the ends of rows differ.
    assert!(far * 100 < one.len(), "{far} of {}", one.len());
}

#[test]
fn hair_is_rooted_where_hair_grows() {
    let mesh = crate::scalp::bust::adult();
    let region: Vec<f32> = mesh.points.iter().map(|p| f32::from(p.y > 3.0)).collect();
    let surface = Surface::new(mesh.points, mesh.triangles);
    let masks = [(REGION.to_owned(), region)].into();
    let scalp = Arc::new(Scalp::new(surface, None, HeadFrame::IDENTITY, masks));
    let curves = parted(&scalp, &rows(&scalp, 3), &[("per_cm", Value::Float(10.0))]);
    assert!(curves.curve_count() > 300);
    for (tuft, i) in curves.each() {
        let root = scalp.closest_root(tuft.curve(i)[0]).unwrap();
        assert!(scalp.mask_at(scalp.region(), root.triangle, root.bary) >= 0.49);
    }
    // A row where nothing grows is named in a message.
    let nape = row(&scalp, 7, 0.4, |t| Vec3::new(0.1 * t, -0.5, -1.0));
    let set = [("source", Curves::new(vec![nape]).into()), ("scalp", scalp.into())];
    let (_, said) = run(&NODE, &set);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with("no ground for hairs beside a row"), "{said:?}");
}

#[test]
fn what_is_no_row_is_left_out_and_named() {
    let scalp = ball(HEAD_RADIUS);
    let mut b = TuftBuilder::new();
    b.push_curve(&[Vec3::Y * 9.0; 3]);
    b.push_curve(&[Vec3::Y * 9.0, Vec3::NAN]);
    b.push_curve(&[Vec3::Y * 9.0]);
    b.push_curve(row(&scalp, 4, 0.4, back(0.0)).curve(0));
    b.push_curve(row(&scalp, 5, 0.4, back(2.0)).curve(0));
    b.set(ID, Domain::Curve, vec![1, 2, 3, 4, 5]);
    let source = Curves::new(vec![b.build().into()]);
    let set = [("source", source.into()), ("scalp", scalp.into()), ("per_cm", Value::Float(5.0))];
    let (out, said) = run(&NODE, &set);
    assert_eq!(said.len(), 3, "{said:?}");
    let curves = curves_of(&out[0]);
    // Rows of one tuft are each other's neighbours.
    assert!(curves.curve_count() > 400);
    assert!(curves.tufts().iter().all(|t| t.points().iter().all(|p| p.is_finite())));
}

#[test]
fn grouping_without_its_wire_says_which() {
    let scalp = ball(HEAD_RADIUS);
    let text = |grouping: &str| {
        let source = Curves::new(rows(&scalp, 1));
        crate::testing::fails(
            &NODE,
            &[
                ("source", source.into()),
                ("scalp", scalp.clone().into()),
                ("grouping", grouping.into()),
            ],
        )
    };
    assert_eq!(text("stitches"), "stitches is not connected: wire curves to it");
    assert_eq!(text("picked"), "picked is not connected: wire curves to it");
}
