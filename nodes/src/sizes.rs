//! Sizes that hang from the curves that come in: foreseen before anything is made, and never more than is made.

use crate::data::attributes::{self as attr, Domain};
use crate::data::curves::{Curves, TuftBuilder};
use crate::define::Value;
use crate::eval::{Log, Quality, Room};
use crate::testing::{Lends, curves_of, run, run_on};
use glam::Vec3;

type Set = Vec<(&'static str, Value)>;

/// Room for so many points.
fn room(points: Option<u64>) -> Lends {
    Lends(Room { points, bytes: None })
}

/// `n` straight curves 10 cm long of `points` points, beside each other.
fn straight(n: usize, points: usize) -> Curves {
    let mut b = TuftBuilder::new();
    for i in 0..n {
        let at = |k: usize| Vec3::new(i as f32, 12.0, -5.0 + 10.0 * k as f32 / (points - 1) as f32);
        b.push_curve(&(0..points).map(at).collect::<Vec<_>>());
    }
    b.set(attr::ID, Domain::Curve, (1..=n as u64).collect());
    Curves::new(b.build().split())
}

/// What the node says where 1.05 million points are more than it may make, in millions; nothing has run.
#[track_caller]
fn foreseen(id: &str, set: &Set) -> f64 {
    let (node, log) = (crate::by_id(id).unwrap(), Log::default());
    let said = run_on(node, set, &room(Some(1 << 20)), &log, Quality::Final);
    let said = said.map(|_| ()).unwrap_err().to_string();
    assert_eq!(log.tufts_run.into_inner(), 0, "{id}: {said}");
    let number = said.strip_prefix("would make ").and_then(|rest| rest.split(' ').next());
    number.and_then(|n| n.parse().ok()).unwrap_or_else(|| panic!("{id}: {said}"))
}

/// As many points are foreseen, in millions, without one piece having run.
#[track_caller]
fn check(id: &str, set: Set, range: [f64; 2]) {
    let found = foreseen(id, &set);
    assert!((range[0]..=range[1]).contains(&found), "{id}: {found} million");
}

/// No more points are foreseen than are made, and at least so large a share of them.
#[track_caller]
fn holds(id: &str, set: Set, share: f64) {
    let found = foreseen(id, &set) * 1e6;
    let (node, log) = (crate::by_id(id).unwrap(), Log::default());
    let out = run_on(node, &set, &room(None), &log, Quality::Final).unwrap();
    let made = curves_of(&out[0]).point_count() as f64;
    // Said to a tenth of a million.
    assert!(found - 5e4 <= made, "{id}: {found} of {made}");
    assert!(found >= share * made, "{id}: {found} of {made}");
}

fn float(x: f32) -> Value {
    x.into()
}

fn curls(curves: Curves, preset: &str, pitch: f32, most: i64) -> Set {
    vec![
        ("curves", curves.into()),
        ("preset", preset.into()),
        ("pitch", float(pitch)),
        ("most_points", Value::Int(most)),
    ]
}

/// The strands and stitches of one braid 10 cm long, and `hairs` hairs at its root.
fn braid(hairs: usize, per_stitch: f32) -> Set {
    let source = straight(1, 20);
    let set: Set = vec![
        ("source", source.clone().into()),
        ("width", float(1.0)),
        ("stitch_spacing", float(0.5)),
    ];
    let (out, _) = run(crate::by_id("lissajous_braid").unwrap(), &set);
    let way = |i: usize| {
        let root = source.tufts()[0].curve(0)[0];
        let from = root + Vec3::new(0.3, 0.0, -0.5 - 1e-5 * i as f32);
        [from, from.lerp(root, 0.5), root]
    };
    let mut b = TuftBuilder::new();
    (0..hairs).for_each(|i| b.push_curve(&way(i)));
    b.set(attr::ID, Domain::Curve, (1..=hairs as u64).collect());
    b.set(attr::PARENT, Domain::Curve, vec![1]);
    vec![
        ("roots", Curves::new(b.build().split()).into()),
        ("strands", out[0].clone()),
        ("stitches", out[1].clone()),
        ("points_per_stitch", float(per_stitch)),
    ]
}

#[test]
fn what_hangs_from_the_curves_that_come_in_is_foreseen_before_any_piece_runs() {
    // 10 cm in turns of 1 mm, which spread makes half as long again at most: some 60 of 8 points each, for 20,000 hairs.
    check("shape_list_curl", curls(straight(20_000, 2), "4c", 0.1, 16_384), [4.0, 20.0]);
    // 255 points are the most: 51 million for 200,000 hairs.
    check("shape_list_curl", curls(straight(200_000, 2), "4c", 0.02, 255), [30.0, 51.0]);
    // 1,000 sources x 3 strands x 10 / 0.05 = 200 stitches x 64 CVs; the tie is at the tip.
    let spaced = |spacing: f32| -> Set {
        vec![
            ("source", straight(1000, 2).into()),
            ("tie", float(1.0)),
            ("stitch_spacing", float(spacing)),
            ("cvs_per_stitch", Value::Int(64)),
        ]
    };
    check("lissajous_braid", spaced(0.05), [38.2, 38.4]);
    // More than 400 stitches are none; 3 x 400 x 64 x 1000.
    check("lissajous_braid", spaced(0.001), [76.8, 76.8]);
    // 4 rows x 2 sides x 2,000 a cm x (10 + 0.6 in front) x 64 CVs, on a head of average size.
    let rows: Set = vec![
        ("source", straight(4, 20).into()),
        ("scalp", crate::data::scalp::tests::shared_ball().into()),
        ("per_cm", float(2000.0)),
        ("cvs", Value::Int(64)),
        ("scale_with_head", false.into()),
    ];
    check("edge_partition", rows, [10.8, 10.9]);
    // 20 stitches of 64 points are more than the 255 that a hair may have: 20,000 hairs of 150 at least.
    check("braid_hair", braid(20_000, 64.0), [2.0, 5.1]);
}

#[test]
fn no_more_points_are_foreseen_than_are_made() {
    holds("shape_list_curl", curls(straight(3_000, 2), "4c", 0.1, 16_384), 0.2);
    holds("braid_hair", braid(8_000, 16.0), 0.5);
    let set: Set = vec![
        ("source", straight(180, 10).into()),
        ("tie", float(0.9)),
        ("width", float(0.5)),
        ("stitch_spacing", float(0.25)),
        ("cvs_per_stitch", Value::Int(64)),
        ("uneven_stitches", float(0.2)),
    ];
    holds("lissajous_braid", set, 0.7);
}

#[test]
#[ignore = "long: half a minute in release"]
fn no_more_points_are_foreseen_than_are_made_of_braids_of_any_width() {
    for width in [0.1, 0.3, 0.5, 1.0] {
        for strands in [2, 3, 7, 12] {
            let set: Set = vec![
                ("source", straight((3200.0 * width) as usize, 10).into()),
                ("width", float(width)),
                ("strands", Value::Int(strands)),
                ("cvs_per_stitch", Value::Int(64)),
            ];
            holds("lissajous_braid", set, 0.2);
        }
    }
}

#[test]
#[ignore = "long: half a minute in release"]
fn no_more_points_are_foreseen_than_are_made_whatever_the_curls() {
    for preset in ["custom", "2a", "2c", "3a", "3b", "3c", "4a", "4b", "4c"] {
        for (pitch, diameter, most) in
            [(0.05, 0.05, 255), (0.05, 1.0, 4000), (0.3, 0.1, 1000), (1.0, 2.0, 255)]
        {
            for length in ["span", "fibre", "visible", "stretched"] {
                let mut set = curls(straight(9_000, 6), preset, pitch, most);
                set.push(("diameter", float(diameter)));
                set.push(("length", length.into()));
                set.push(("points", "turn".into()));
                let node = crate::by_id("shape_list_curl").unwrap();
                let out = run_on(node, &set, &room(None), &Log::default(), Quality::Final);
                let made = curves_of(&out.unwrap()[0]).point_count() as u64;
                // May as many be made as are made, and one for each hair that is told to be coarser, then nothing is refused.
                let lent = room(Some(made + 9_000));
                let again = run_on(node, &set, &lent, &Log::default(), Quality::Final);
                assert!(again.is_ok(), "{preset} {pitch} {diameter} {most} {length}: {made}");
            }
        }
    }
}
