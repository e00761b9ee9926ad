//! What painted masks promise: values 0 to 1, the order of strokes, sides, sections, closed lines, thin skin, other heads.

use super::*;
use crate::data::curves::TuftBuilder;
use crate::data::outline::for_middles;
use crate::data::scalp::HeadFrame;
use crate::data::strokes::Sample;
use crate::define::{FileData, Value};
use crate::long::is_long;
use crate::maths::hash::Dice;
use crate::testing::{area_within, fails, round, run};
use std::collections::BTreeMap;
use std::sync::OnceLock;

fn head() -> Arc<Scalp> {
    static HEAD: OnceLock<Arc<Scalp>> = OnceLock::new();
    HEAD.get_or_init(|| made("head", &[]).0).clone()
}

fn made(id: &str, set: &[(&str, Value)]) -> (Arc<Scalp>, Vec<String>) {
    let (mut out, said) = run(crate::by_id(id).unwrap(), set);
    match out.remove(0) {
        Value::Scalp(scalp) => (scalp, said),
        other => panic!("a {}", other.type_name()),
    }
}

/// The scanned head; `None` if this machine does not have it.
fn scanned() -> Option<Arc<Scalp>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/lps_head/LeePerrySmith.glb");
    let bytes = std::fs::read(path).ok()?.into();
    let (path, extension) = ("head.glb".to_owned(), "glb".to_owned());
    let file = FileData { path, extension, bytes, sides: BTreeMap::new() };
    Some(made("head", &[("mesh", Value::File(Arc::new(file)))]).0)
}

/// A stroke through directions of the head frame, where they leave the built-in head, at full pressure.
fn stroke(id: u64, ways: &[[f32; 3]], brush: Brush) -> Stroke {
    let scalp = head();
    let frame = scalp.frame();
    let sample = |way: &[f32; 3]| {
        let out = frame.vector_from_head(Vec3::from(*way).normalize());
        let hit = scalp.surface().ray(frame.origin, out, 40.0).unwrap();
        Sample { position: frame.head_from_point(hit.point), pressure: 1.0, ..Sample::default() }
    };
    Stroke { brush: Some(brush), ..Stroke::new(id, ways.iter().map(sample).collect()) }
}

fn brush(mode: Mode, radius: f32, strength: f32) -> Brush {
    Brush { mode, radius, strength, ..Brush::default() }
}

fn mask(
    scalp: &Arc<Scalp>,
    strokes: &[Stroke],
    set: &[(&str, Value)],
) -> (Arc<Field>, Vec<String>) {
    let strokes = Value::from(Strokes(strokes.to_vec()));
    let given = [("scalp", scalp.clone().into()), ("strokes", strokes)];
    let (mut out, said) = run(crate::by_id("paint_mask").unwrap(), &[&given[..], set].concat());
    match out.remove(0) {
        Value::Field(field) => (field, said),
        other => panic!("a {}", other.type_name()),
    }
}

fn painted(scalp: &Arc<Scalp>, strokes: &[Stroke]) -> Arc<Painted> {
    match &*mask(scalp, strokes, &[]).0 {
        Field::Painted(painted) => painted.clone(),
        other => panic!("{other:?}"),
    }
}

/// The value where a direction of the head frame leaves the head.
fn at(painted: &Painted, way: [f32; 3]) -> f32 {
    let (scalp, frame) = (painted.scalp(), painted.scalp().frame());
    let out = frame.vector_from_head(Vec3::from(way).normalize());
    let hit = scalp.surface().ray(frame.origin, out, 60.0 * frame.unit()).unwrap();
    painted.on(&[scalp.root(hit.triangle, hit.bary)]).unwrap()[0]
}

const CROWN: [f32; 3] = [0.0, 1.0, 0.0];
/// 2 cm from the crown to the left: 8.9 cm x 0.225 rad.
const BESIDE: [f32; 3] = [0.229, 1.0, 0.0];

/// A random stroke with a few dabs over the upper head.
fn any_stroke(id: u64) -> Stroke {
    let dice = Dice::new(id, 0, "any stroke");
    let mut way = Vec3::new(dice.signed(0, 0), dice.unit(0, 1) + 0.2, dice.signed(0, 2));
    let count = 1 + dice.below(0, 3, 8) as u64;
    let ways: Vec<[f32; 3]> = (0..count)
        .map(|k| {
            way += Vec3::new(dice.signed(k, 4), 0.3 * dice.signed(k, 5), dice.signed(k, 6)) * 0.2;
            way.y = way.y.max(0.0);
            (way + Vec3::Y * 1e-3).to_array()
        })
        .collect();
    let (mode, _) = Mode::ALL[dice.below(0, 7, 4) as usize];
    let brush = Brush {
        mode,
        radius: dice.range(0, 8, 0.1, 4.0),
        strength: dice.unit(0, 9),
        mirrored: dice.unit(0, 10) < 0.5,
        closed: dice.unit(0, 11) < 0.3,
        section: String::new(),
    };
    let mut one = stroke(id, &ways, brush);
    one.samples.iter_mut().zip(0..).for_each(|(s, k)| s.pressure = dice.unit(k, 12));
    one
}

#[test]
fn a_dab_is_full_in_its_middle_half_way_out_and_nothing_beyond_its_radius() {
    // At the crown, which is 8.9 cm from the centre: 1 cm from the middle of a dab of 2 cm, smoothstep(0.5) = 0.5; at
    // full pressure and half strength, the middle is 0.5.
    let ball = crate::data::scalp::tests::shared_ball();
    let sample = Sample { position: Vec3::Y * 8.9, pressure: 1.0, ..Sample::default() };
    let one = |brush| Stroke { brush: Some(brush), ..Stroke::new(1, vec![sample]) };
    let check = |set: &[(&str, Value)], brush: Brush, ways: [f32; 4], wanted: [f32; 4]| {
        let (field, _) = mask(&ball, &[one(brush)], set);
        let Field::Painted(painted) = &*field else { panic!() };
        // By the chord: the sine of half the angle is half the chord over 8.9.
        let way = |chord: f32| {
            let half = crate::maths::transcendental::asin(0.5 * chord / 8.9);
            let (sin, cos) = crate::maths::transcendental::sin_cos(2.0 * half);
            [sin, cos, 0.0]
        };
        for (chord, wanted) in ways.into_iter().zip(wanted) {
            let found = at(painted, way(chord));
            assert!((found - wanted).abs() < 0.02, "{chord} cm: {found}, not {wanted}");
        }
    };
    check(&[], brush(Mode::Paint, 2.0, 1.0), [0.0, 1.0, 1.9, 2.1], [1.0, 0.5, 0.007, 0.0]);
    check(&[], brush(Mode::Paint, 2.0, 0.5), [0.0, 1.0, 1.9, 2.1], [0.5, 0.25, 0.004, 0.0]);
    let hard = [("softness", 0.0f32.into())];
    check(&hard, brush(Mode::Paint, 2.0, 1.0), [0.0, 1.0, 1.9, 2.1], [1.0, 1.0, 1.0, 0.0]);
    // A head twice as large has dabs twice as large.
    let mut large = HeadFrame::IDENTITY;
    large.radius *= 2.0;
    let surface = crate::maths::closest::tests::sphere(17.8, 48);
    let region = vec![1.0; surface.points.len()];
    let large = Scalp::new(surface, None, large, [("scalp".to_owned(), region)].into()).into();
    let twice = painted(&large, &[one(brush(Mode::Paint, 2.0, 1.0))]);
    let small = painted(&ball, &[one(brush(Mode::Paint, 2.0, 1.0))]);
    for x in [0.0, 0.05, 0.1, 0.15, 0.2, 0.25] {
        assert!((at(&twice, [x, 1.0, 0.0]) - at(&small, [x, 1.0, 0.0])).abs() < 0.01);
    }
}

#[test]
fn strokes_count_in_their_order_and_a_pass_that_covers_itself_counts_once() {
    let check = |strokes: &[Stroke], way, wanted: f32| {
        let found = at(&painted(&head(), strokes), way);
        assert!((found - wanted).abs() < 0.01, "{found}, not {wanted}");
    };
    let paint = |id, strength| stroke(id, &[CROWN], brush(Mode::Paint, 2.0, strength));
    let erase = |id, strength| stroke(id, &[CROWN], brush(Mode::Erase, 2.0, strength));
    check(&[paint(1, 1.0)], CROWN, 1.0);
    // A half, and half of the rest: 0.75; a quarter of that is erased: 0.5625.
    check(&[paint(1, 0.5), paint(2, 0.5)], CROWN, 0.75);
    check(&[paint(1, 0.5), paint(2, 0.5), erase(3, 0.25)], CROWN, 0.5625);
    check(&[paint(1, 1.0), erase(2, 1.0)], CROWN, 0.0);
    check(&[erase(1, 1.0), paint(2, 1.0)], CROWN, 1.0);
    let to_and_fro = [CROWN, BESIDE, CROWN, BESIDE];
    check(&[stroke(1, &to_and_fro, brush(Mode::Paint, 1.0, 0.5))], CROWN, 0.5);
    // Samples 2 cm apart with a brush of 0.6 cm leave no gap.
    let line = stroke(1, &[CROWN, BESIDE], brush(Mode::Paint, 0.6, 1.0));
    assert!(at(&painted(&head(), &[line]), [0.115, 1.0, 0.0]) > 0.9);
    // A flood sets the value, whatever was there.
    let flood = |id, value| stroke(id, &[CROWN], brush(Mode::Flood, 1.0, value));
    check(&[paint(1, 1.0), flood(2, 0.25)], CROWN, 0.25);
    check(&[flood(1, 0.25)], [0.0, -0.2, 1.0], 0.25);
}

#[test]
fn erasing_takes_all_paint_away_and_values_stay_between_0_and_1() {
    let (scalp, rounds) = (head(), if is_long() { 200 } else { 6 });
    let places: Vec<Root> = (0..scalp.surface().triangles.len() as u32)
        .step_by(37)
        .map(|t| scalp.root(t, glam::Vec2::splat(1.0 / 3.0)))
        .collect();
    for round in 0..rounds {
        let mut strokes: Vec<Stroke> = (1..8).map(|k| any_stroke(round * 100 + k)).collect();
        let values = painted(&scalp, &strokes).on(&places).unwrap();
        assert!(values.iter().all(|x| (0.0..=1.0).contains(x)), "round {round}");
        // A point that no stroke changed keeps its value.
        let again: Vec<f32> = painted(&scalp, &strokes).on(&places).unwrap();
        assert_eq!(values, again);
        for (id, way) in (9000..)
            .zip([1.0, -1.0].into_iter().flat_map(|s| [Vec3::X, Vec3::Y, Vec3::Z].map(|a| a * s)))
        {
            strokes.push(stroke(id, &[(way + 0.01).to_array()], brush(Mode::Erase, 30.0, 1.0)));
        }
        let erased = mask(&scalp, &strokes, &[("softness", 0.0f32.into())]).0;
        let Field::Painted(erased) = &*erased else { panic!() };
        let left = erased.on(&places).unwrap().into_iter().fold(0.0, f32::max);
        // Skin that faces away from both, deep in an ear or a nostril, may keep some.
        let all = erased.on(&places).unwrap();
        let kept = all.iter().filter(|x| **x > 0.0).count();
        assert!(kept * 20 < all.len(), "round {round}: {kept} of {} keep up to {left}", all.len());
    }
}

#[test]
fn a_mirrored_stroke_paints_both_sides_alike() {
    let ways = [[0.6, 1.0, 0.1], [0.7, 0.8, 0.4], [0.5, 0.5, 0.8]];
    let one = Brush { mirrored: true, ..brush(Mode::Paint, 1.5, 0.8) };
    let both = painted(&head(), &[stroke(1, &ways, one.clone())]);
    let own = painted(&head(), &[stroke(1, &ways, Brush { mirrored: false, ..one })]);
    let dice = Dice::new(4, 0, "mirror");
    let (mut covered, mut off) = (0, 0.0f32);
    for k in 0..400 {
        let way = [dice.unit(k, 0), dice.unit(k, 1), dice.signed(k, 2)];
        let twin = [-way[0], way[1], way[2]];
        off = off.max((at(&both, way) - at(&both, twin)).abs());
        covered += u32::from(at(&both, way) > 0.5);
        assert_eq!(at(&own, twin), 0.0, "{way:?}");
    }
    // Both sides of the built-in head are the same except for their triangles.
    assert!(covered > 20 && off < 0.03, "{covered} {off}");
}

#[test]
fn sections_keep_strokes_and_floods_to_themselves() {
    let parts = |count: i64, more: &[(&str, Value)]| {
        let set = [
            ("scalp", head().into()),
            ("pattern", "across".into()),
            ("count", Value::Int(count)),
            ("names", "front 0 7 6; back 0 3 -8".into()),
        ];
        made("partings", &[&set[..], more].concat()).0
    };
    let parted = parts(2, &[]);
    let within =
        |section: &str, mode| Brush { section: section.to_owned(), ..brush(mode, 30.0, 1.0) };
    let (front, back) = ([0.0, 7.0, 6.0], [0.0, 3.0, -8.0]);
    for (section, wanted) in [("front", [1.0, 0.0]), ("back", [0.0, 1.0])] {
        for mode in [Mode::Flood, Mode::Paint] {
            let on = painted(&parted, &[stroke(1, &[CROWN, front, back], within(section, mode))]);
            assert_eq!(
                [at(&on, front), at(&on, back)].map(|x| f32::from(x > 0.9)),
                wanted,
                "{section} {mode:?}"
            );
            assert_eq!(
                [at(&on, front), at(&on, back)].map(|x| f32::from(x > 0.0)),
                wanted,
                "{section} {mode:?}"
            );
        }
    }
    // Without such a section the stroke has no effect, and the node says so.
    let flood = [stroke(1, &[front], within("front", Mode::Flood))];
    let (field, said) = mask(&head(), &flood, &[("scale_with_head", false.into())]);
    let Field::Painted(on) = &*field else { panic!() };
    assert_eq!(at(on, front), 0.0);
    assert!(said[0].contains("\"front\"") && said[0].contains("not parted"), "{said:?}");
    // Partings that no stroke uses do not affect the mask.
    let free = [stroke(1, &[front], brush(Mode::Paint, 2.0, 1.0))];
    let other = parts(3, &[]);
    assert_eq!(mask(&parted, &free, &[]).0.bytes(), mask(&other, &free, &[]).0.bytes());
    assert_eq!(painted(&parted, &free).key(), painted(&other, &free).key());
    let kept = [stroke(1, &[front], within("front", Mode::Paint))];
    assert_ne!(painted(&parted, &kept).key(), painted(&other, &kept).key());
}

/// A ring around the crown, this many degrees from it.
fn ring(degrees: f32) -> Vec<[f32; 3]> {
    let (out, up) = crate::maths::transcendental::sin_cos(degrees.to_radians());
    let way = |k: u32| {
        let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 / 48.0);
        [sin * out, up, cos * out]
    };
    (0..48).map(way).collect()
}

#[test]
fn a_closed_stroke_is_its_smaller_inside_with_an_edge_in_millimetres() {
    let ball = crate::data::scalp::tests::shared_ball();
    let on_ball = |ways: &[[f32; 3]], mode| {
        let sample = |way: &[f32; 3]| Sample {
            position: Vec3::from(*way).normalize() * 8.9,
            pressure: 1.0,
            ..Sample::default()
        };
        let brush = Brush { closed: true, ..brush(mode, 0.1, 1.0) };
        Stroke { brush: Some(brush), ..Stroke::new(1, ways.iter().map(sample).collect()) }
    };
    // In either direction, and wherever its smaller side is: 80 degrees from the crown are less than half, 100 are
    // more.
    for backwards in [false, true] {
        for (degrees, crown) in [(20.0, 1.0), (80.0, 1.0), (100.0, 0.0), (160.0, 0.0)] {
            let mut ways = ring(degrees);
            if backwards {
                ways.reverse();
            }
            let on = painted(&ball, &[on_ball(&ways, Mode::Paint)]);
            for round in 0..17 {
                let (sin, cos) = crate::maths::transcendental::sin_cos_turns(round as f32 / 17.0);
                let up = |degrees: f32| {
                    let (out, up) = crate::maths::transcendental::sin_cos(degrees.to_radians());
                    at(&on, [sin * out, up, cos * out])
                };
                assert_eq!(up(0.0), crown, "{degrees}");
                assert_eq!(up(degrees - 3.0), crown, "{degrees} {round}");
                assert_eq!(up(degrees + 3.0), 1.0 - crown, "{degrees} {round}");
            }
        }
    }
    // An edge of 3 mm: 0 and 1 at 1.5 mm from the line (0.966 degrees), a half on it. The chords of the ring lie up to
    // 0.2 mm inside.
    let on = painted(&ball, &[on_ball(&ring(60.0), Mode::Paint)]);
    let edge = |degrees: f32| {
        let (out, up) = crate::maths::transcendental::sin_cos(degrees.to_radians());
        at(&on, [0.0, up, out])
    };
    assert_eq!((edge(58.9), edge(61.1)), (1.0, 0.0));
    assert!((edge(60.0) - 0.5).abs() < 0.1, "{}", edge(60.0));
    assert!(edge(59.5) > 0.7 && edge(60.5) < 0.3);
    // It erases and floods as well.
    let all = Stroke { id: 2, ..stroke(2, &[CROWN], brush(Mode::Flood, 1.0, 1.0)) };
    let holed = painted(&ball, &[all, on_ball(&ring(30.0), Mode::Erase)]);
    assert_eq!((at(&holed, CROWN), at(&holed, [1.0, 0.0, 0.0])), (0.0, 1.0));
}

/// The total value of a head's mask, cm2, and its largest distance from a point, cm, sampled about 9 times per length.
fn painted_skin(on: &Painted, middle: Vec3, length: f32) -> (f32, f32) {
    let surface = on.scalp().surface();
    let (mut sum, mut farthest) = (0.0f64, 0.0f32);
    for t in 0..surface.triangles.len() as u32 {
        let twice = surface.area_vector(t).length();
        let n = (twice.sqrt() / length * 9.0).ceil().clamp(2.0, 96.0) as u32;
        let part = 0.5 * f64::from(twice) / f64::from(n * n);
        for_middles(n, |bary| {
            let value = on.on_triangle(t, bary, 0.0);
            sum += part * f64::from(value);
            if value > 0.0 {
                farthest = farthest.max(surface.at(t, bary).distance(middle));
            }
        });
    }
    (sum as f32, farthest)
}

#[test]
fn a_closed_stroke_paints_what_it_encloses_and_no_skin_that_lies_behind() {
    let check = |set: &[(&str, Value)], near: Vec3, radius: f32| {
        let scalp = crate::testing::head(set);
        // On heads in head units, on animals as a fraction of their bounding box.
        let (low, high) = scalp.surface().bounds();
        let near = match set {
            [] => scalp.frame().point_from_head(near),
            _ => low + (high - low) * near,
        };
        let middle = scalp.closest_root(near).unwrap().point;
        let brush = Brush { closed: true, ..brush(Mode::Paint, 1.0, 1.0) };
        let line = Stroke { brush: Some(brush), ..round(&scalp, 1, middle, radius) };
        let sharp = [("edge", 0.0f32.into()), ("scale_with_head", false.into())];
        let (field, said) = mask(&scalp, &[line], &sharp);
        assert!(said.is_empty(), "{said:?}");
        let Field::Painted(on) = &*field else { panic!() };
        let ((inside, farthest), wide) =
            (painted_skin(on, middle, radius), area_within(&scalp, middle, radius));
        assert!((inside / wide - 1.0).abs() < 0.02, "{inside} cm2 of {wide}");
        assert!(farthest < 1.006 * radius, "{farthest} of {radius}");
    };
    // The side of the jaw, around one eye, and over the crown.
    check(&[], Vec3::new(6.0, -6.0, 4.0), 2.2);
    check(&[], Vec3::new(3.2, 0.0, 8.5), 1.7);
    check(&[], Vec3::new(0.0, 9.0, 0.0), 6.0);
    // The flank and the belly of a rat, with its paws behind them, and the side of a cow.
    for (name, near, radius) in [
        ("rat/street_rat_4k.gltf", Vec3::new(0.5, 0.25, 0.55), 0.6),
        ("rat/street_rat_4k.gltf", Vec3::new(0.5, 0.0, 0.55), 0.6),
        ("spot/spot_triangulated.obj", Vec3::new(0.91, 0.344, 0.534), 0.25),
    ] {
        let Some(file) = crate::testing::shared_file(name) else {
            println!(
                "skipped: a_closed_stroke_paints_what_it_encloses needs ../shared/data/{name}"
            );
            continue;
        };
        check(&[("fit", "none".into()), ("mesh", Value::File(file))], near, radius);
    }
}

#[test]
fn a_closed_stroke_that_does_not_fit_is_told_as_a_drawn_region_is() {
    let scalp = head();
    let at = scalp.closest_root(scalp.frame().point_from_head(Vec3::new(3.0, 8.0, 3.0))).unwrap();
    let closed = Brush { closed: true, ..brush(Mode::Paint, 1.0, 1.0) };
    let whole = Stroke { brush: Some(closed.clone()), ..round(&scalp, 1, at.point, 2.0) };
    let said = |strokes: &[Stroke]| mask(&scalp, strokes, &[("scale_with_head", false.into())]).1;
    let told = |change: &dyn Fn(&mut Stroke), what: &str| {
        let mut stroke = whole.clone();
        change(&mut stroke);
        let strokes = [whole.clone(), stroke];
        let said = said(&strokes);
        assert!(said.len() == 1 && said[0].contains(what), "{said:?}");
        let drawn = Strokes(strokes.to_vec()).into();
        let (_, region) = made("head", &[("region", "hairline".into()), ("hairline", drawn)]);
        assert!(region.iter().any(|told| told.starts_with(&said[0])), "{said:?} {region:?}");
    };
    let mirrored = |stroke: &mut Stroke| {
        stroke.brush = Some(Brush { mirrored: true, ..closed.clone() });
        stroke.samples.iter_mut().for_each(|s| s.position *= 1.2);
    };
    told(&|stroke| stroke.samples.truncate(60), "stroke 2 is open: its ends, at (");
    told(&|stroke| stroke.samples.iter_mut().for_each(|s| s.position *= 1.2), "stroke 2 misses");
    told(&|stroke| stroke.samples.truncate(2), "stroke 2 has 2 points and encloses nothing");
    assert_eq!(said(std::slice::from_ref(&whole)), <[String; 0]>::default());
    let mut both = whole.clone();
    mirrored(&mut both);
    let said = said(&[both]);
    assert!(said.len() == 2 && said[1].contains("the twin of stroke 1 misses"), "{said:?}");
}

#[test]
fn smoothing_over_a_closed_line_evens_it_out() {
    let closed = Brush { closed: true, ..brush(Mode::Paint, 1.0, 1.0) };
    let line = stroke(1, &ring(25.0), closed);
    let beside = |degrees: f32| {
        let (out, up) = crate::maths::transcendental::sin_cos(degrees.to_radians());
        [0.0, up, out]
    };
    let smooth = stroke(2, &[beside(25.0)], brush(Mode::Smooth, 2.0, 1.0));
    let on = painted(&head(), &[line, smooth]);
    // 3 degrees are about half a centimetre, outside the line's own edge of 1.5 mm.
    let (inside, outside) = (at(&on, beside(22.0)), at(&on, beside(28.0)));
    assert!((0.5..0.95).contains(&inside) && (0.05..0.5).contains(&outside), "{inside} {outside}");
    assert_eq!((at(&on, CROWN), at(&on, beside(45.0))), (1.0, 0.0));
}

#[test]
fn smoothing_evens_out_what_differs_and_leaves_what_does_not() {
    let dab = stroke(1, &[CROWN], brush(Mode::Paint, 0.8, 1.0));
    let smooth = |id| stroke(id, &[CROWN], brush(Mode::Smooth, 2.0, 1.0));
    let flood = stroke(5, &[CROWN], brush(Mode::Flood, 1.0, 0.6));
    let value = |strokes: &[Stroke], way| at(&painted(&head(), strokes), way);
    let near = [0.11, 1.0, 0.0];
    let (one, two) = ([dab.clone(), smooth(2)], [dab.clone(), smooth(2), smooth(3)]);
    // The peak sinks and its foot rises, again and again.
    assert!(value(&one, CROWN) < 0.7 && value(&one, CROWN) > 0.1, "{}", value(&one, CROWN));
    assert!(value(&two, CROWN) < value(&one, CROWN));
    assert!(value(&one, near) > value(std::slice::from_ref(&dab), near));
    for way in [CROWN, near, [0.3, 1.0, 0.1]] {
        assert!((value(&[flood.clone(), smooth(2)], way) - 0.6).abs() < 1e-5);
    }
    // A smooth stroke covers only earlier strokes: later painting is not smoothed.
    assert_eq!(value(&[smooth(2), dab.clone()], CROWN), value(&[dab], CROWN));
}

#[test]
fn a_scribble_of_thousands_of_samples_is_smoothed_too() {
    let to_and_fro: Vec<[f32; 3]> =
        (0..13_000).map(|k| if k % 2 == 0 { CROWN } else { [0.02, 1.0, 0.0] }).collect();
    let dab = stroke(1, &[CROWN], brush(Mode::Paint, 0.8, 1.0));
    let smooth = stroke(2, &to_and_fro, brush(Mode::Smooth, 0.3, 1.0));
    let value = at(&painted(&head(), &[dab, smooth]), CROWN);
    assert!(value > 0.8 && value < 1.0, "{value}");
}

#[test]
fn paint_does_not_come_through_an_ear() {
    let scalp = head();
    let (surface, frame) = (scalp.surface(), scalp.frame());
    // From one side of a thin part to the other.
    let (mut ears, mut through) = (0, 0);
    for triangle in (0..surface.triangles.len() as u32).step_by(7) {
        let front = scalp.root(triangle, glam::Vec2::splat(1.0 / 3.0));
        if frame.head_from_point(front.point).x.abs() < 7.5 {
            continue;
        }
        let back = surface.ray(front.point - front.normal * 0.02, -front.normal, 1.0);
        let Some(back) = back.map(|hit| scalp.root(hit.triangle, hit.bary)) else { continue };
        if front.normal.dot(back.normal) > -0.6 {
            continue;
        }
        ears += 1;
        let position = frame.head_from_point(front.point);
        let sample = Sample { position, pressure: 1.0, ..Sample::default() };
        let one =
            Stroke { brush: Some(brush(Mode::Paint, 1.5, 1.0)), ..Stroke::new(1, vec![sample]) };
        let values = painted(&scalp, &[one]).on(&[front, back]).unwrap();
        assert!(values[0] > 0.95, "{values:?}");
        through += u32::from(values[1] > 0.0);
    }
    assert!(ears > 5 && through == 0, "{through} of {ears}");
}

#[test]
fn another_head_shows_the_same_picture_within_2_percent_of_the_area() {
    let Some(other) = scanned() else {
        println!(
            "skipped: another_head_shows_the_same_picture_within_2_percent_of_the_area needs ../shared"
        );
        return;
    };
    // 1,000 dabs in 60 strokes over the scalp, and a hairline.
    let mut strokes: Vec<Stroke> = (0..60)
        .map(|k| {
            let dice = Dice::new(k, 0, "dabs");
            let mut way =
                Vec3::new(dice.signed(0, 0), 0.3 + dice.unit(0, 1), dice.signed(0, 2) - 0.2);
            let turn =
                Vec3::new(dice.signed(0, 3), 0.0, dice.signed(0, 4)).normalize_or(Vec3::X) * 0.03;
            let ways: Vec<[f32; 3]> = (0..17)
                .map(|_| {
                    way += turn;
                    way.to_array()
                })
                .collect();
            let mode = if k % 5 == 4 { Mode::Erase } else { Mode::Paint };
            stroke(
                k + 1,
                &ways,
                brush(mode, dice.range(0, 5, 0.4, 1.2), dice.range(0, 6, 0.4, 1.0)),
            )
        })
        .collect();
    strokes.push(Stroke {
        id: 99,
        ..stroke(99, &ring(25.0), Brush { closed: true, ..Brush::default() })
    });
    let (here, there) = (painted(&head(), &strokes), painted(&other, &strokes));
    let (mut sum, mut differs, mut heat) = (0.0f64, 0.0f64, [0.0f64; 2]);
    // Directions over the scalp, equal areas: heights are evenly distributed.
    let count = if is_long() { 40_000 } else { 6000 };
    for k in 0..count {
        let up = 0.2 + 0.8 * (k as f32 + 0.5) / count as f32;
        let (sin, cos) = crate::maths::transcendental::sin_cos_turns(k as f32 * 0.618_034);
        let out = (1.0 - up * up).sqrt();
        let way = [sin * out, up, cos * out];
        let (a, b) = (at(&here, way), at(&there, way));
        sum += 1.0;
        differs += f64::from((a - b).abs());
        heat[0] += f64::from(a);
        heat[1] += f64::from(b);
    }
    let shares = [heat[0] / sum, heat[1] / sum];
    println!("heat {shares:?} of the area, differs on {:.4} of it", differs / sum);
    assert!(shares[0] > 0.2 && (shares[0] - shares[1]).abs() < 0.02, "{shares:?}");
    assert!(differs / sum < 0.02, "{}", differs / sum);
}

#[test]
fn a_base_is_read_on_the_scalp_and_painted_over() {
    let region = |value| Value::Field(Field::Mask(value).into());
    let erase = stroke(1, &[CROWN], brush(Mode::Erase, 1.0, 1.0));
    let smooth = stroke(2, &[CROWN], brush(Mode::Smooth, 1.0, 1.0));
    let (field, _) =
        mask(&head(), &[erase.clone(), smooth], &[("base", region("scalp".to_owned()))]);
    let Field::Painted(on) = &*field else { panic!() };
    // Erased: 0 in the middle, 1 - smoothstep(0.75) = 0.156 at a quarter of the radius, 0.5 at half of it: six each,
    // 0.303 on average.
    assert!((at(on, CROWN) - 0.303).abs() < 0.06, "{}", at(on, CROWN));
    assert_eq!((at(on, [0.0, 1.0, -0.7]), at(on, [0.0, -0.2, 1.0])), (1.0, 0.0));
    // A painted mask as the base of another.
    let paint = stroke(3, &[[0.0, -0.2, 1.0]], brush(Mode::Paint, 1.0, 1.0));
    let (field, _) = mask(&head(), &[paint], &[("base", Value::Field(field.clone()))]);
    let Field::Painted(on) = &*field else { panic!() };
    assert_eq!((at(on, [0.0, 1.0, -0.7]), at(on, [0.0, -0.2, 1.0])), (1.0, 1.0));
    // Without strokes it equals the base, and attributes of hair are not allowed.
    assert_eq!(*mask(&head(), &[], &[("base", 0.25f32.into())]).0, Field::Constant(0.25));
    let hair = ("base", Value::Field(Field::Attribute("radius".into()).into()));
    let fault = fails(crate::by_id("paint_mask").unwrap(), &[("scalp", head().into()), hair]);
    assert!(fault.contains("base") && fault.contains("before there is hair"), "{fault}");
}

#[test]
fn any_field_reads_it_and_the_amount_of_hair_changes_nothing() {
    let strokes = [stroke(1, &[CROWN], brush(Mode::Paint, 3.0, 1.0))];
    let (field, _) = mask(&head(), &strokes, &[]);
    let grown = |count: i64, set: &[(&str, Value)]| {
        let given = [("scalp", head().into()), ("count", Value::Int(count))];
        let (out, _) = run(crate::by_id("scatter_guides").unwrap(), &[&given[..], set].concat());
        crate::testing::curves_of(&out[0]).clone()
    };
    let mask = || Value::Field(field.clone());
    // As the mask of hair: every root lies within 3 cm of the crown, at any count.
    let crown = scalp_point(CROWN);
    for count in [400, 800] {
        let curves = grown(count, &[("mask", mask())]);
        assert!(curves.curve_count() > 2);
        assert!(curves.each().all(|(t, i)| t.curve(i)[0].distance(crown) < 3.0));
    }
    // As its length: longer where it is painted, down to the smallest length elsewhere.
    let length = |t: &crate::data::curves::Tuft, i: usize| {
        t.curve(i).windows(2).map(|w| w[0].distance(w[1])).sum::<f32>()
    };
    for (tuft, i) in grown(400, &[("length", mask())]).each() {
        let far = tuft.curve(i)[0].distance(crown);
        assert!(if far < 1.0 { length(tuft, i) > 0.5 } else { far < 3.0 || length(tuft, i) < 0.1 });
    }
    // Without a root attribute, the nearest skin counts, and no scalp is needed.
    let mut b = TuftBuilder::new();
    b.push_curve(&[crown, crown + Vec3::Y]);
    b.push_curve(&[crown + Vec3::NEG_Y * 20.0, Vec3::ZERO]);
    let tuft = b.build();
    let sampler = field.on(&tuft, None, (0.0, 1.0)).unwrap();
    assert!(sampler.at(0, 0, 0.0) > 0.99 && sampler.at(1, 2, 0.0) == 0.0 && sampler.is_of_curves());
}

fn scalp_point(way: [f32; 3]) -> Vec3 {
    let (scalp, out) = (head(), Vec3::from(way).normalize());
    scalp
        .surface()
        .ray(scalp.frame().origin, scalp.frame().vector_from_head(out), 40.0)
        .unwrap()
        .point
}
