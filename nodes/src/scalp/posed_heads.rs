//! One head saved plain, in a skin, and in a skin with quantized positions is one head to what grows on it.
//!
//! Floats in metres and in centimetres do not round alike: at 1.7 m their last bits are 0.00001 cm apart, and
//! quantized positions are steps of 0.0005 cm. The skin and the frame follow exactly that. Hair adds its own: rows laid on
//! the plain head move by 0.0008 cm when the last bit of each coordinate is turned, and what is scattered by area or
//! falls against other hair moves by far more.

use super::{head, scalp_projection};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::scalp::Scalp;
use crate::define::{FileData, Value};
use crate::maths::transcendental::sin_cos_turns;
use crate::testing::{curves_of, run};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The head of a file; none where `../shared` is not there.
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

/// Twelve rows drawn from the crown down in the head's frame and laid on the scalp.
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

/// The farthest that a point of one list is from its fellow of the other, cm.
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
    // The quantized head is 31.5 cm high in steps of 15.75 / 32767 cm: half of one is 0.00024 cm an axis, 0.00042 across.
    for (name, skin, on_it) in
        [("head_skinned_cm_zup", 3e-5, 1e-3), ("head_skinned_quantized", 4.3e-4, 2e-3)]
    {
        let posed = scalp(name).unwrap();
        let (a, b) = (plain.frame(), posed.frame());
        assert_eq!((a.forward, a.right, a.up), (b.forward, b.right, b.up), "{name}");
        assert_eq!(plain.cm_per_unit(), posed.cm_per_unit(), "{name}");
        let frames = a.origin.distance(b.origin).max((a.radius - b.radius).abs());
        let (surfaces, hairs) =
            (apart(&corners(&plain), &corners(&posed)), apart(&hair, &hair_of(&posed)));
        println!("{name}: {frames} cm between the frames, {surfaces} the skins, {hairs} the hair");
        assert!(frames < 1e-4 && surfaces < skin && hairs < on_it, "{name}");
    }
}
