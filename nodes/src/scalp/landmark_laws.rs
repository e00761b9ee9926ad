//! Guarantees of the landmarks of the built-in head and of real ones.

use crate::data::landmarks::{Landmark, Landmarks};
use crate::data::scalp::Scalp;
use crate::define::{FileData, Value};
use crate::maths::transcendental::sin_cos;
use crate::testing::{head, run, shared_file, shared_head};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The tested heads: from a file, or the built-in one.
pub(super) const HEADS: [&str; 5] = [
    "",
    "lps_head/LeePerrySmith.glb",
    "ict_head/generic_neutral_mesh.obj",
    "sintel/sintel.obj",
    "snowden_scan/snowden.obj",
];

/// A head with an input set; `None`, with a note, if this machine does not have its file.
#[track_caller]
pub(super) fn of(name: &str, set: &[(&str, Value)]) -> Option<Arc<Scalp>> {
    match name {
        "" => Some(head(set)),
        name => shared_head("landmarks", name, set),
    }
}

/// A mesh file with one vertex per line, each transformed.
fn moved(name: &str, to: impl Fn(Vec3) -> Vec3, mirrored: bool) -> Option<Arc<Scalp>> {
    let file = match name {
        "" => None,
        name => Some(shared_file(name)?),
    };
    let mesh = match file {
        Some(file) => crate::formats::mesh_in::read_mesh(&file.extension, &file.bytes, &|side| {
            file.sides.get(side).cloned()
        })
        .ok()?,
        None => super::bust::adult(),
    };
    let mut text = String::new();
    for p in &mesh.points {
        let p = to(*p);
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.triangles {
        let [a, b, c] = if mirrored { [a, c, b] } else { [a, b, c] }.map(|v| v + 1);
        text += &format!("f {a} {b} {c}\n");
    }
    let (path, extension) = ("moved.obj".to_owned(), "obj".to_owned());
    let file =
        FileData { path, extension, bytes: text.into_bytes().into(), sides: BTreeMap::new() };
    Some(head(&[("mesh", Value::File(Arc::new(file)))]))
}

/// Largest distance of a landmark of one head from the other's, head units; `to` maps the landmarks and positions.
#[track_caller]
fn apart(a: &Landmarks, b: &Landmarks, to: impl Fn(Landmark, Vec3) -> (Landmark, Vec3)) -> f32 {
    assert_eq!(a.missing().is_some(), b.missing().is_some(), "{a} {b}");
    let far = a.each().map(|(mark, at)| {
        let (mark, at) = to(mark, at);
        b.get(mark).expect("the same landmark").distance(at)
    });
    far.fold(0.0, f32::max)
}

#[test]
fn real_heads_have_them_all_and_each_lies_on_the_skin() {
    for name in HEADS {
        let Some(scalp) = of(name, &[]) else { continue };
        let (marks, frame) = (scalp.landmarks(), scalp.frame());
        println!("{name}: {marks}");
        assert_eq!(marks.missing(), None, "{name}");
        for (mark, at) in marks.each() {
            let p = frame.point_from_head(at);
            let off = scalp.closest_root(p).unwrap().point.distance(p);
            assert!(off < 1e-4, "{name} {mark:?} is {off} cm off the skin");
        }
        let at = |mark| marks.get(mark).unwrap();
        use Landmark::*;
        assert!(at(Front).z > 7.0 && at(Nape).z < -4.0 && at(Crown).y > 7.0, "{name} {marks}");
        assert!(at(Nape).y < -5.0 && at(Chin).y < -10.0 && at(Chin).z > 6.0, "{name} {marks}");
        // Down the face, and the nose in front of the rest of it.
        let down = [Front, Bridge, Nose, Mouth, Chin].map(at);
        assert!(down.windows(2).all(|w| w[0].y > w[1].y + 0.8), "{name} {marks}");
        assert!(down.iter().all(|p| p.x.abs() < 1.0 && p.z <= at(Nose).z), "{name} {marks}");
        for (left, right) in [(LeftEar, RightEar), (LeftTemple, RightTemple)] {
            assert!(at(left).x > 5.0 && at(right).x < -5.0, "{name} {marks}");
        }
    }
}

#[test]
fn the_built_in_head_has_them_where_it_was_modelled() {
    let marks = *head(&[]).landmarks();
    let modelled: BTreeMap<_, _> = super::bust::landmarks().into_iter().collect();
    let far = |mark, name: &str| marks.get(mark).unwrap().distance(modelled[name]);
    use Landmark::*;
    let two = [far(Front, "hairline_front"), far(Nape, "nape")];
    println!("front {} nape {} chin {}", two[0], two[1], far(Chin, "chin"));
    assert!(two.iter().all(|off| *off < 0.1) && far(Chin, "chin") < 1.5);
    assert!(far(LeftTemple, "temple_left") < 1.0 && far(RightTemple, "temple_right") < 1.0);
}

#[test]
fn they_are_mirrored_with_the_head_and_move_with_it() {
    let mirror = Vec3::new(-1.0, 1.0, 1.0);
    let (sin, cos) = sin_cos(40f32.to_radians());
    let turned = |p: Vec3| {
        Vec3::new(p.x * cos + p.z * sin, p.y, p.z * cos - p.x * sin) * 3.0
            + Vec3::new(40.0, -9.0, 7.0)
    };
    for name in ["", "ict_head/generic_neutral_mesh.obj", "sintel/sintel.obj"] {
        let Some(plain) = moved(name, |p| p, false) else { continue };
        let Some(mirrored) = moved(name, |p| p * mirror, true) else { continue };
        let other = |mark| match mark {
            Landmark::LeftEar => Landmark::RightEar,
            Landmark::RightEar => Landmark::LeftEar,
            Landmark::LeftTemple => Landmark::RightTemple,
            Landmark::RightTemple => Landmark::LeftTemple,
            middle => middle,
        };
        let off = apart(plain.landmarks(), mirrored.landmarks(), |m, at| (other(m), at * mirror));
        let Some(moved) = moved(name, turned, false) else { continue };
        // A frame is found to half a degree where the head faces between axes.
        let by = apart(plain.landmarks(), moved.landmarks(), |mark, at| (mark, at));
        println!("{name}: mirrored {off}, turned {by}");
        assert!(off < 0.02 && by < 0.15, "{name}: mirrored {off}, turned {by}");
    }
}

#[test]
fn what_is_stated_overrules_a_guess_and_lies_on_the_skin() {
    let plain = head(&[]);
    let (stated, said) = run(
        crate::by_id("head").unwrap(),
        &[("landmarks", "chin 0 -13 9; crown 0 12 0; brow 1 2 3".into())],
    );
    let Value::Scalp(stated) = &stated[0] else { panic!() };
    for (mark, at) in stated.landmarks().each() {
        let guess = plain.landmarks().get(mark).unwrap();
        let moved = matches!(mark, Landmark::Chin | Landmark::Crown);
        assert_eq!(at != guess, moved, "{mark:?}");
    }
    let told = |text: &str| said.iter().any(|s| s.contains(text));
    assert!(told("\"brow\" is no landmark") && told("misses the skin by"), "{said:?}");
    assert!(stated.landmarks().get(Landmark::Crown).unwrap().y < 9.0);
}

#[test]
fn what_a_mesh_does_not_have_is_said_and_not_made_up() {
    // Only the cap of the built-in head: no face, no neck, no ears.
    let bust = super::bust::adult();
    let is_cap = |t: &&[u32; 3]| t.iter().all(|v| bust.points[*v as usize].y > 2.0);
    let mut text = String::new();
    bust.points.iter().for_each(|p| text += &format!("v {} {} {}\n", p.x, p.y, p.z));
    for [a, b, c] in bust.triangles.iter().filter(is_cap) {
        text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    let (path, extension) = ("cap.obj".to_owned(), "obj".to_owned());
    let file =
        FileData { path, extension, bytes: text.into_bytes().into(), sides: BTreeMap::new() };
    let (out, said) = run(crate::by_id("head").unwrap(), &[("mesh", Value::File(Arc::new(file)))]);
    let Value::Scalp(scalp) = &out[0] else { panic!() };
    let missing = scalp.landmarks().missing().unwrap();
    assert!(missing.contains("chin") && missing.contains("ear"), "{missing}");
    assert!(said.iter().any(|s| s.contains("; not found: ") && s.contains("chin")), "{said:?}");
    // An animal is not a head: no landmark is detected, and none is reported missing.
    let Some(rat) = shared_head("landmarks", "rat/street_rat_4k.gltf", &[("fit", "none".into())])
    else {
        return;
    };
    assert_eq!(*rat.landmarks(), Landmarks::default());
}
