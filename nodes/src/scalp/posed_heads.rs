//! One head saved plain, skinned, and skinned with quantized positions is the same head for what grows on it.
//!
//! Floats in metres and in centimetres round differently: at 1.7 m their last bits are 0.00001 cm apart, and quantized
//! positions have steps of 0.0005 cm. Skin and frame follow exactly that. Hair adds its own: rows laid on the plain
//! head move by 0.0008 cm if the last bit of each coordinate changes, like the tip of a guide over 10 cm when the
//! normal at its root turns by that much. Scattered hair keeps its roots: last bits do not change which guide is used
//! and where.

use super::{head, scalp_projection};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::scalp::Scalp;
use crate::define::{FileData, Value};
use crate::maths::transcendental::sin_cos_turns;
use crate::testing::{curves_of, run};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The head of a file; `None` without `../shared`.
fn scalp(name: &str) -> Option<Arc<Scalp>> {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/reported/");
    let Ok(bytes) = std::fs::read(format!("{data}{name}.glb")) else {
        println!("skipped: posed heads need ../shared");
        return None;
    };
    let (path, extension) = (name.to_owned(), "glb".to_owned());
    let file = FileData { path, extension, bytes: bytes.into(), sides: BTreeMap::new() };
    let (out, _) = run(&head::NODE, &[("mesh", Value::File(Arc::new(file)))]);
    match &out[0] {
        Value::Scalp(scalp) => Some(scalp.clone()),
        other => panic!("{}", other.type_name()),
    }
}

/// Twelve rows drawn from the crown down in the head frame and laid on the scalp.
fn rows(scalp: &Arc<Scalp>) -> Curves {
    let frame = scalp.frame();
    let mut b = TuftBuilder::new();
    for row in 0..12 {
        let (sin, cos) = sin_cos_turns(row as f32 / 12.0);
        let down = |j: u8| {
            let (side, up) = sin_cos_turns(0.02 + 0.03 * f32::from(j));
            frame.point_from_head(Vec3::new(side * sin, up, side * cos) * 10.0)
        };
        b.push_curve(&[0, 1, 2, 3, 4, 5].map(down));
    }
    let drawn = Curves::new(vec![Arc::new(b.build())]);
    let set = [("curves", drawn.into()), ("scalp", scalp.clone().into())];
    let exact = [("refine", false.into()), ("smoothing", 0.0.into())];
    curves_of(&run(&scalp_projection::NODE, &[&set[..], &exact].concat()).0[0]).clone()
}

/// Scattered guides and the hair between them, each by id.
fn scattered(scalp: &Arc<Scalp>) -> [BTreeMap<u64, Vec<Vec3>>; 2] {
    let by_id = |curves: &Curves| {
        curves.each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i).to_vec())).collect()
    };
    let set = [("scalp", scalp.clone().into()), ("count", Value::Int(500))];
    let guides = curves_of(&run(crate::by_id("scatter_guides").unwrap(), &set).0[0]).clone();
    let by = [("by", "count".into()), ("count", Value::Int(3000)), ("points", Value::Int(8))];
    let on = [("scalp", scalp.clone().into()), ("guides", guides.clone().into())];
    let hair = run(crate::by_id("interpolate").unwrap(), &[&on[..], &by].concat()).0;
    [by_id(&guides), by_id(curves_of(&hair[0]))]
}

/// Largest distance of a point of one list from its counterpart in the other, cm.
fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max(a.distance(*b)))
}

#[test]
fn a_head_in_a_skin_grows_the_hair_of_the_plain_head() {
    let Some(plain) = scalp("head_plain") else { return };
    let corners = |scalp: &Scalp| -> Vec<Vec3> {
        let surface = scalp.surface();
        surface.triangles.iter().flatten().map(|v| surface.points[*v as usize]).collect()
    };
    let hair_of = |scalp: &Arc<Scalp>| -> Vec<Vec3> {
        rows(scalp).each().flat_map(|(tuft, i)| tuft.curve(i).to_vec()).collect()
    };
    let hair = hair_of(&plain);
    let grown = scattered(&plain);
    // The quantized head is 31.5 cm high in steps of 15.75 / 32767 cm: half of one is 0.00024 cm per axis, 0.00042
    // diagonally. For guides and hair: the fraction that exists and moves no farther than the rows may.
    for (name, skin, on_it, stays) in [
        ("head_skinned_cm_zup", 3e-5, 1e-3, [0.998, 0.995]),
        ("head_skinned_quantized", 4.3e-4, 4e-3, [0.75, 0.5]),
    ] {
        let posed = scalp(name).unwrap();
        let (a, b) = (plain.frame(), posed.frame());
        assert_eq!((a.forward, a.right, a.up), (b.forward, b.right, b.up), "{name}");
        assert_eq!(plain.cm_per_unit(), posed.cm_per_unit(), "{name}");
        let frames = a.origin.distance(b.origin).max((a.radius - b.radius).abs());
        let (surfaces, hairs) =
            (apart(&corners(&plain), &corners(&posed)), apart(&hair, &hair_of(&posed)));
        println!("{name}: {frames} cm between the frames, {surfaces} the skins, {hairs} the hair");
        assert!(frames < 1e-4 && surfaces < skin && hairs < on_it, "{name}");
        let again = scattered(&posed);
        for (k, what) in ["guides", "hair"].into_iter().enumerate() {
            let same = |(id, points): (&u64, &Vec<Vec3>)| {
                again[k].get(id).is_some_and(|found| apart(points, found) < on_it)
            };
            let share =
                grown[k].iter().filter(|one| same(*one)).count() as f32 / grown[k].len() as f32;
            println!("{name}: {share} of the {what} to {on_it} cm");
            assert!(share >= stays[k], "{name}: {share} of the {what}");
        }
    }
}
