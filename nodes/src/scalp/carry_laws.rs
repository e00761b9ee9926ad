//! Guarantees of a head to a groom that was made on another one.

use super::landmark_laws::{HEADS, of};
use crate::data::landmarks::Landmark;
use crate::data::scalp::Scalp;
use crate::data::strokes::{Sample, Stroke, Strokes};
use crate::define::Value;
use crate::testing::{curves_of, head, run};
use glam::Vec3;
use std::sync::Arc;

/// The landmarks of a head in the form that its `home` takes.
fn text(scalp: &Scalp) -> Value {
    scalp.landmarks().to_string().as_str().into()
}

#[test]
fn landmarks_meet_on_the_skin_of_every_real_head() {
    for from in HEADS {
        let Some(home) = of(from, &[]) else { continue };
        for to in HEADS.into_iter().filter(|to| *to != from) {
            let Some(there) = of(to, &[("home", text(&home))]) else { continue };
            let map = there.space().carry().expect("a map");
            assert_eq!(map.part(), 1.0, "{from} to {to}");
            let mut most = 0f32;
            for (mark, at) in home.landmarks().each() {
                let wanted = there.frame().point_from_head(there.landmarks().get(mark).unwrap());
                let place = there.place(at);
                most = most.max(place.distance(wanted));
                assert!(there.given(place).distance(at) < 1e-4, "{mark:?} {}", there.given(place));
            }
            println!("{from} to {to}: landmarks meet to {most} cm");
            assert!(most < 0.01, "{from} to {to}: {most} cm");
        }
    }
}

#[test]
fn a_groom_at_home_keeps_its_bits() {
    for name in HEADS {
        let Some(plain) = of(name, &[]) else { continue };
        let Some(home) = of(name, &[("home", text(&plain))]) else { continue };
        assert!(home.space().carry().is_none());
        assert_eq!(plain.key(), home.key(), "{name}");
    }
    let Some(away) = of(HEADS[1], &[("home", text(&head(&[])))]) else { return };
    let Some(plain) = of(HEADS[1], &[]) else { return };
    assert!(away.key() != plain.key() && away.frame() == plain.frame());
    assert_eq!((away.region(), away.landmarks()), (plain.region(), plain.landmarks()));
}

#[test]
fn strokes_names_and_places_go_by_the_map_and_lengths_by_the_frame() {
    let home = head(&[]);
    let Some(there) = of(HEADS[3], &[("home", text(&home))]) else { return };
    // From landmark to landmark on the home head is from landmark to landmark there.
    let at = |scalp: &Scalp, mark| scalp.landmarks().get(mark).unwrap();
    use Landmark::*;
    for (a, b) in [(Front, LeftTemple), (LeftTemple, LeftEar), (LeftEar, Nape), (Nape, RightEar)] {
        let ends = [at(&home, a), at(&home, b)];
        let samples = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| Sample {
            position: ends[0].lerp(ends[1], t).normalize() * 9.5,
            pressure: 1.0,
            ..Sample::default()
        });
        let mut samples = samples.to_vec();
        (samples[0].position, samples[4].position) = (ends[0], ends[1]);
        let strokes = Strokes(vec![Stroke::new(1, samples)]);
        let set = [("scalp", there.clone().into()), ("strokes", strokes.into())];
        let out = run(
            crate::by_id("stroke_input").unwrap(),
            &[&set[..], &[("radius", Value::Float(1.0))]].concat(),
        )
        .0;
        let curves = curves_of(&out[0]);
        let line = curves.tufts()[0].curve(0);
        let own = |mark| there.frame().point_from_head(at(&there, mark));
        let off = [line[0].distance(own(a)), line[line.len() - 1].distance(own(b))];
        // (Strokes are smoothed, including their last point.)
        assert!(off[0] < 0.01 && off[1] < 0.1, "{a:?} {b:?}: {off:?}");
        let radius = curves.tufts()[0].view(crate::data::attributes::RADIUS).at(0, 0);
        assert!((radius - there.frame().unit()).abs() < 1e-6, "{radius}");
    }
    let crown = at(&home, Crown);
    let set = [("scalp", there.clone().into()), ("position", Value::Vec3(crown))];
    let out = run(crate::by_id("sphere_puff").unwrap(), &set).0;
    let out = curves_of(&out[0]);
    let foot = there.frame().point_from_head(at(&there, Crown));
    let roots: Vec<Vec3> = out.each().map(|(tuft, i)| tuft.curve(i)[0]).collect();
    let middle = roots.iter().sum::<Vec3>() / roots.len() as f32;
    assert!(middle.distance(foot) < 1.0, "{middle} {foot}");
}

#[test]
fn what_the_map_goes_without_is_said() {
    let said = |set: &[(&str, Value)]| run(crate::by_id("head").unwrap(), set).1;
    let told = |set: &[(&str, Value)], text: &str| {
        let said = said(set);
        assert!(said.iter().any(|s| s.contains(text)), "{text}: {said:?}");
    };
    let home = |text: &str| [("home", Value::from(text))];
    told(&home("crown 0 9 -3"), "not given, and the map goes without");
    told(&home("crown 0 9 -3; brow 1 2 3"), "\"brow\" is no landmark");
    told(&home("brow 1 2 3"), "no landmark is known on both heads");
    told(&home("crown 0 9 -3; chin 0 9 -3"), "chin left out: on the spot of another landmark");
    told(
        &home(
            "left ear -7.6 -1.9 -1.9; right ear 7.6 -1.9 -1.9; front 0 3.8 8.9; nape 0 -6.8 -7.2; crown 0 8 -4",
        ),
        "all of the map would fold",
    );
    told(
        &[("home", "crown 0 9 -3".into()), ("fit", "none".into())],
        "crown not found on this head, and the map goes without: say where in landmarks",
    );
}

/// Round trips over real heads: what was drawn on one, carried to another and laid on its skin, is carried back.
#[test]
fn there_and_back_is_where_it_was() {
    let home = head(&[]);
    for name in &HEADS[1..] {
        let Some(there) = of(name, &[("home", text(&home))]) else { continue };
        let back: Arc<Scalp> = head(&[("home", text(&there))]);
        let mut off: Vec<f32> = (0..home.surface().points.len())
            .filter(|v| home.region()[*v] > 0.5)
            .map(|v| {
                let p = home.surface().points[v];
                let on = there.closest_root(there.place(home.given(p))).unwrap().point;
                let again = back.place(there.frame().head_from_point(on));
                back.closest_root(again).unwrap().point.distance(p)
            })
            .collect();
        off.sort_by(f32::total_cmp);
        let (median, p95) = (off[off.len() / 2], off[off.len() * 95 / 100]);
        println!("{name}: {median} cm in the middle, 95 % within {p95}");
        assert!(median < 0.1, "{name}: {median} cm");
    }
}
