//! One head saved plain, in a skin, and in a skin with quantized positions is one head to what grows on it.
//!
//! Floats in metres and in centimetres do not round alike: at 1.7 m their last bits are 0.00001 cm apart, and
//! quantized positions are steps of 0.0005 cm. The skin and the frame follow exactly that. Hair adds its own: rows laid on
//! the plain head move by 0.0008 cm when the last bit of each coordinate is turned, and what falls against other hair moves by far
//! more. Quantizing joins points that were apart: that is another mesh, whose scattered roots are its own.

use super::{head, scalp_projection};
use crate::data::curves::{Curves, TuftBuilder};
use crate::data::scalp::Scalp;
use crate::define::{FileData, Value};
use crate::guides::scatter_guides;
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

#[test]
fn a_head_in_a_skin_has_the_guides_of_the_plain_head_where_they_were() {
    let Some(plain) = scalp("head_plain") else { return };
    let guides_of = |scalp: &Arc<Scalp>| -> BTreeMap<u64, Vec<Vec3>> {
        let set = [("scalp", scalp.clone().into()), ("count", Value::Int(500))];
        let out = run(&scatter_guides::NODE, &set).0;
        curves_of(&out[0]).each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i).to_vec())).collect()
    };
    let (want, posed) = (guides_of(&plain), guides_of(&scalp("head_skinned_cm_zup").unwrap()));
    let off = |id: &u64| posed.get(id).map_or(f32::MAX, |found| apart(&want[id], found));
    let mut off: Vec<f32> = want.keys().map(off).collect();
    off.sort_by(f32::total_cmp);
    // At 1.7 m the last bits of coordinates are 0.00001 cm apart; 27 steps over curved skin make ten and more of one. One root in a
    // thousand lies so near the side of a triangle, or of another root's disc, that it lands on the other.
    println!("half within {} cm, all but five within {}", off[250], off[494]);
    assert!(off[250] < 1e-4 && off[494] < 2e-3);
}
