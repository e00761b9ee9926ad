//! What a mask means, asserted of every node that declares one: the share to keep of the hair that is there without it.
//!
//! So what a mask keeps are hairs of the whole, where they were and under their ids, as many as it says, however their number is
//! set; and where it is 0 none, where it is 1 all.

use crate::data::field::Field;
use crate::data::scalp::{HeadFrame, REGION, Scalp};
use crate::define::{NodeDef, Type, Value};
use crate::maths::closest::tests::sphere;
use crate::testing::{curves_of, run};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A ball whose upper half is scalp, with a mask of its left half.
fn ball() -> Arc<Scalp> {
    let surface = sphere(8.9, 48);
    let mask = |of: fn(&Vec3) -> f32| surface.points.iter().map(of).collect();
    let region = mask(|p| f32::from(p.y > 0.0));
    let half = mask(|p| f32::from(p.x > 0.0));
    let masks = [(REGION.to_owned(), region), ("half".to_owned(), half)];
    Scalp::new(surface, None, HeadFrame::IDENTITY, masks.into()).into()
}

/// Enough hair to judge a share by, however its number is set.
fn amount(name: &str) -> Option<Value> {
    match name {
        "count" => Some(Value::Int(3000)),
        "density" => Some(Value::Float(12.0)),
        "per_cm" => Some(Value::Float(60.0)),
        _ => None,
    }
}

/// The roots of what a node makes of these inputs, by their ids.
fn roots(node: &NodeDef, set: &[(&str, Value)]) -> BTreeMap<u64, Vec3> {
    let (out, _) = run(node, set);
    curves_of(&out[0]).each().map(|(tuft, i)| (tuft.id(i), tuft.curve(i)[0])).collect()
}

/// That a node's mask keeps its share, with these inputs beside.
fn check(node: &NodeDef, set: &[(&'static str, Value)]) {
    let kept = |mask: Value| roots(node, &[set, &[("mask", mask)]].concat());
    let (id, all) = (node.id, kept(1.0f32.into()));
    let n = all.len() as f64;
    assert!(n > 1000.0, "{id}: {n} hairs are too few to judge by");
    for share in [0.0f32, 0.1, 0.5, 0.9] {
        let some = kept(share.into());
        assert!(some.iter().all(|(id, p)| all.get(id) == Some(p)), "{id}, {share}: other hair");
        let share = f64::from(share);
        let off = some.len() as f64 - share * n;
        let chance = (n * share * (1.0 - share)).sqrt();
        assert!(off.abs() <= 4.0 * chance, "{id}: {share} keeps {} of {n}", some.len());
    }
    let some = kept(Field::Mask("half".into()).into());
    assert!(some.iter().all(|(id, p)| all.get(id) == Some(p)), "{id}, half: other hair");
    // The mask fades over a row of triangles.
    let wrong =
        all.iter().filter(|(id, p)| p.x.abs() > 1.2 && some.contains_key(id) != (p.x > 0.0));
    assert_eq!(wrong.count(), 0, "{id}: of {n}, half keeps {}", some.len());
}

#[test]
fn a_mask_keeps_its_share_of_the_hair_that_is_there_without_it() {
    let scalp: Value = ball().into();
    let gives_hair = |node: &NodeDef| node.outputs.iter().any(|output| output.ty == Type::Curves);
    let is_mask = |node: &&NodeDef| {
        gives_hair(node) && node.input("mask").is_some_and(|(_, it)| it.ty == Type::Field)
    };
    let few = [("scalp", scalp.clone()), ("count", Value::Int(300))];
    let (guides, _) = run(crate::by_id("scatter_guides").unwrap(), &few);
    let mut seen = 0;
    for node in crate::all().filter(is_mask) {
        let mut set: Vec<(&str, Value)> = vec![];
        for input in node.inputs {
            match input.name {
                "scalp" => set.push(("scalp", scalp.clone())),
                "guides" => set.push(("guides", guides[0].clone())),
                name => set.extend(amount(name).map(|amount| (name, amount))),
            }
        }
        match node.input("by").map(|(_, by)| by.ty) {
            Some(Type::Choice(ways)) => ways.iter().for_each(|(way, _)| {
                check(node, &[&set[..], &[("by", (*way).into())]].concat());
                seen += 1;
            }),
            _ => {
                check(node, &set);
                seen += 1;
            }
        }
    }
    assert!(seen >= 6, "{seen}");
}
