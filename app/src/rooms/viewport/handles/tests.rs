//! Laws of grips on random views.

use super::grip::along;
use super::*;
use crate::core::projection::tests::{any_camera, any_rect};
use coif_nodes::data::scalp::{HeadFrame, HeadSpace};
use coif_nodes::maths::hash::Dice;

fn grip(handle: Handle, input: &'static str, kind: &str, value: Number, anchor: Vec3) -> Grip {
    let (_, input) = coif_nodes::by_id(kind).unwrap().input(input).unwrap();
    assert_eq!(input.handle, Some(handle));
    Grip {
        input,
        handle,
        value,
        anchor,
        out: Vec3::Y,
        number: 1,
        curve: (0..20).map(|k| anchor + Vec3::new(k as f32 * 0.5, 0.0, 0.1)).collect(),
        space: HeadSpace::new(HeadFrame::IDENTITY, None),
        on_skin: false,
        unit: 1.0,
    }
}

#[test]
fn a_grip_that_is_held_where_it_is_keeps_its_value() {
    for seed in 0..300 {
        let view = Projection::new(any_camera(seed), any_rect(seed));
        let dice = Dice::new(seed, 8, "grips");
        let anchor = view.at_depth(view.rect.center(), dice.range(0, 0, 20.0, 60.0));
        let x = dice.range(0, 1, 0.5, 6.0);
        let point = Number::Point(anchor);
        for (handle, input, kind, value) in [
            (Handle::Ball, "sphere_radius", "sphere_puff", Number::One(x)),
            (Handle::Radius, "root_radius", "sphere_puff", Number::One(x)),
            (Handle::Length, "tie_height", "sphere_puff", Number::One(x)),
            (Handle::Angle, "coverage", "sphere_puff", Number::One(20.0 * x)),
            (Handle::Along, "tie", "lissajous_braid", Number::One(0.1 + 0.1 * x)),
            (Handle::Point, "pivot", "transform", point),
        ] {
            let grip = grip(handle, input, kind, value, anchor);
            let seen = Seen { view: &view, scalps: &[] };
            let Some((at, _)) = grip.place(&seen, &[]) else { continue };
            let steep = view.axes()[2].dot(Vec3::Y).abs() > 0.95
                || (handle == Handle::Along && view.axes()[2].x.abs() > 0.9);
            let Some(back) = grip.value_at(&view, &[], at).filter(|_| !steep) else { continue };
            match (value, back) {
                (Number::One(a), Number::One(b)) => {
                    assert!((a - b).abs() < 0.02 * (1.0 + a.abs()), "{seed} {input}: {a} {b}");
                }
                (Number::Point(a), Number::Point(b)) => {
                    assert!(a.distance(b) < 0.01 * (1.0 + a.length()), "{seed}: {a} {b}");
                }
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn grips_that_would_lie_on_one_another_are_held_apart_and_the_place_stays() {
    let names = [
        (Handle::Radius, "radius"),
        (Handle::Length, "height"),
        (Handle::Angle, "lean"),
        (Handle::Point, "position"),
    ];
    let one = Number::One(1.0);
    for seed in 0..200 {
        let dice = Dice::new(seed, 9, "apart");
        let middle = Pos2::new(300.0, 200.0);
        let placed: Vec<(Grip, Pos2)> = names
            .iter()
            .enumerate()
            .map(|(k, (handle, input))| {
                let by = |n: u64| dice.range(k as u64, n, -20.0, 20.0);
                let at = if seed == 0 { middle } else { middle + Vec2::new(by(1), by(2)) };
                (grip(*handle, input, "gather", one, Vec3::ZERO), at)
            })
            .collect();
        let hands = apart(&placed);
        assert_eq!(hands[3], placed[3].1, "the position is where it is");
        for i in 0..4 {
            assert!(hands[i].distance(placed[i].1) <= 3.0 * APART + 0.1);
            for j in 0..i {
                let far = hands[i].distance(hands[j]);
                assert!(far >= 2.0 * TARGET, "{seed}: {} and {}: {far}", names[i].1, names[j].1);
            }
        }
    }
}

#[test]
fn drags_end_at_the_hard_limits() {
    let view = Projection::new(any_camera(3), any_rect(3));
    let anchor = view.at_depth(view.rect.center(), 40.0);
    let grip = grip(Handle::Ball, "sphere_radius", "sphere_puff", Number::One(6.0), anchor);
    let far = view.rect.center() + Vec2::new(1e6, 0.0);
    assert_eq!(grip.value_at(&view, &[], far), Some(Number::One(60.0)));
    let middle = view.screen(anchor).unwrap();
    assert_eq!(grip.value_at(&view, &[], middle), Some(Number::One(0.1)));
}

#[test]
fn places_along_a_line_are_fractions_of_its_length() {
    let line = [Vec3::ZERO, Vec3::X * 3.0, Vec3::new(3.0, 1.0, 0.0)];
    assert_eq!(along(&line, 0.0), Some(line[0]));
    assert_eq!(along(&line, 0.75), Some(line[1]));
    assert_eq!(along(&line, 1.0), Some(line[2]));
    assert_eq!(along(&[], 0.5), None);
    assert_eq!(along(&[Vec3::Y, Vec3::Y], 0.5), Some(Vec3::Y));
}
