//! That lengths grow with the head: what a node makes on a head twice as large is twice as large.
//!
//! Each node that scales runs with inputs that ask something of all its lengths, on a small head and on one that is twice that
//! one, with curves that are twice as large. Doubling changes no digit of a number, so where nothing in a node is of a size of its
//! own, the same hair comes out to the last bit.

use crate::data::attributes::{Attribute, Column, WIDTH, unit_of};
use crate::data::curves::{Curves, Tuft, TuftBuilder};
use crate::data::scalp::{HeadFrame, REGION, Scalp};
use crate::define::{Arity, InputDef, NodeDef, Type, Value};
use crate::eval::{Log, PlainHost, Quality};
use crate::hostile;
use crate::maths::closest::Surface;
use crate::testing::run_on;
use glam::Vec3;
use std::sync::Arc;

/// The same, twice as large: lengths of attributes too, but for the width of a hair.
fn doubled(value: &Value) -> Value {
    match value {
        Value::Curves(curves) => {
            Curves::new(curves.tufts().iter().map(|tuft| Arc::new(larger(tuft))).collect()).into()
        }
        Value::Scalp(scalp) => {
            let points = scalp.surface().points.iter().map(|p| *p * 2.0).collect();
            let surface = Surface::new(points, scalp.surface().triangles.clone());
            let frame = HeadFrame { radius: 2.0 * scalp.frame().radius, ..*scalp.frame() };
            let region = scalp.mask(REGION).unwrap_or_default().to_vec();
            let masks = [(REGION.to_owned(), region)];
            Scalp::new(surface, None, frame, masks.into()).into()
        }
        other => other.clone(),
    }
}

fn larger(tuft: &Tuft) -> Tuft {
    let mut b = TuftBuilder::new();
    for i in 0..tuft.len() {
        b.push_curve(&tuft.curve(i).iter().map(|p| *p * 2.0).collect::<Vec<_>>());
    }
    for attribute in tuft.attributes() {
        let grows = unit_of(&attribute.name) == "cm" && attribute.name != WIDTH.name;
        let values = match &attribute.values {
            Column::F32(all) if grows => {
                Column::F32(Arc::new(all.iter().map(|x| x * 2.0).collect()))
            }
            Column::Vec3(all) if grows => {
                Column::Vec3(Arc::new(all.iter().map(|p| *p * 2.0).collect()))
            }
            same => same.clone(),
        };
        b.set_column(Attribute { values, ..attribute.clone() });
    }
    b.build()
}

/// Something in the lower part of the slider for every length, and hair where some must come in.
fn asks(input: &InputDef) -> Option<Value> {
    if input.ty == Type::Curves && input.arity == Arity::One {
        return Some(hostile::hairs(3).into());
    }
    let (lo, hi) = input.soft?;
    let from = lo.max(0.0);
    let counts = input.grown(1.0, 2.0) != 1.0 && matches!(input.ty, Type::Float | Type::Field);
    counts.then(|| Value::Float((from + 0.2 * (hi - from)) as f32))
}

/// How far roots and tips of two lots lie apart at most, cm; none where they are not as many. (Some nodes sample at distances of a
/// size of their own.)
fn apart(one: &Curves, other: &Curves) -> Option<f32> {
    let ends = |curves: &Curves| -> Vec<Vec3> {
        let ends = |(tuft, i): (&Tuft, usize)| {
            let curve = tuft.curve(i);
            [curve.first().copied(), curve.last().copied()]
        };
        curves.each().flat_map(ends).flatten().collect()
    };
    let (one, other) = (ends(one), ends(other));
    let pairs = one.iter().zip(&other);
    (one.len() == other.len()).then(|| pairs.map(|(p, q)| p.distance(*q)).fold(0.0, f32::max))
}

fn curves_of(out: &[Value]) -> Curves {
    let all = out.iter().filter_map(|value| match value {
        Value::Curves(curves) => Some(curves.tufts().to_vec()),
        _ => None,
    });
    Curves::new(all.flatten().collect())
}

fn made(node: &NodeDef, set: &[(&str, Value)]) -> Curves {
    let out = run_on(node, set, &PlainHost, &Log::default(), Quality::Final);
    curves_of(&out.unwrap_or_else(|err| panic!("{}: {err}", node.id)))
}

/// What is set so that a node has something to do, or so that nothing is of a size of its own.
fn sets(id: &str) -> Vec<(&'static str, Value)> {
    let top = Value::Vec3(Vec3::Y * 9.0);
    match id {
        "gather" | "sphere_puff" => vec![("position", top), ("reach", 0.0f32.into())],
        "trim" => vec![("size", Value::Vec3(Vec3::splat(11.0)))],
        // Longer hair straightens at its tip within a distance of its own.
        "length" => vec![("by", "length".into()), ("length", 3.0f32.into())],
        // A row's tail goes round what is below it in steps of half a centimetre.
        "braid_territory" => vec![("tail", 0.0f32.into())],
        "tail" | "bun" => vec![("loose", 0.0f32.into())],
        _ => vec![],
    }
}

/// What has sizes of its own wherever it lies, so that ends are elsewhere on a larger head.
const OWN_SIZES: &[(&str, &str)] = &[
    ("hang", "hair falls in steps of 0.3 cm, and wanders in waves of 14"),
    ("baby_hair", "the hairline is smoothed over 0.8 cm"),
];

/// What gives no curves of what is usual: a mask, a region, and what is drawn, of which nothing is.
const DRAWN: &[&str] = &["hair_sketch", "paint_mask", "region", "stroke_input"];

/// How far ends may lie off, cm. Hair may keep off the skin by a distance of its own; the course of a tail has a point every 0.2 cm,
/// and ways to a row are laid on the skin as exactly on any head.
fn off(id: &str) -> f32 {
    if ["tail", "bun", "braid_territory"].contains(&id) { 0.32 } else { 0.05 }
}

#[test]
fn on_a_head_twice_as_large_hair_is_twice_as_large() {
    let mut wrong = vec![];
    let has_own_sizes = |id: &str| OWN_SIZES.iter().any(|(own, _)| *own == id);
    for node in crate::all().filter(|node| node.scales && !has_own_sizes(node.id)) {
        let id = node.id;
        let mut set = hostile::usual(node);
        set.extend(sets(id).into_iter().filter(|(name, _)| node.input(name).is_some()));
        for input in node.inputs {
            let is_set = set.iter().any(|(name, _)| *name == input.name);
            set.extend(asks(input).filter(|_| !is_set).map(|value| (input.name, value)));
        }
        let twice: Vec<_> = set.iter().map(|(name, value)| (*name, doubled(value))).collect();
        let (small, large) = (made(node, &set), made(node, &twice));
        let found = apart(&curves_of(&[doubled(&small.clone().into())]), &large);
        let is_empty = small.curve_count() == 0 && !DRAWN.contains(&id);
        if is_empty || found.is_none_or(|far| far > off(id)) {
            wrong.push((id, found));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
