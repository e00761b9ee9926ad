//! That lengths grow with the head: what a node makes on a head twice as large is twice as large.
//!
//! Each node that scales runs with inputs that ask something of all its lengths, on a small head and on one that is twice that
//! one, with curves that are twice as large. Doubling changes no digit of a number, so where nothing in a node is of a size of its
//! own, the same hair comes out to the last bit.

use crate::data::attributes::{Column, PUFF_EDGE, WIDTH, unit_of};
use crate::data::curves::{Curves, Tuft};
use crate::data::scalp::{HeadFrame, REGION, Scalp};
use crate::define::{InputDef, NodeDef, Type, Value};
use crate::eval::{Log, PlainHost, Quality};
use crate::hostile;
use crate::maths::closest::Surface;
use crate::testing::run_on;
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
    let mut b = tuft.edit();
    b.set_points(tuft.points().iter().map(|p| *p * 2.0).collect());
    for attribute in tuft.attributes() {
        let grows = unit_of(&attribute.name) == "cm" && attribute.name != WIDTH.name;
        let values = match &attribute.values {
            Column::F32(all) if grows => {
                Column::F32(Arc::new(all.iter().map(|x| x * 2.0).collect()))
            }
            Column::Vec3(all) if grows => {
                Column::Vec3(Arc::new(all.iter().map(|p| *p * 2.0).collect()))
            }
            _ => continue,
        };
        b.set_column(crate::data::attributes::Attribute { values, ..attribute.clone() });
    }
    b.build()
}

/// Something in the lower part of the slider, for every length that is left as it is.
fn asks(input: &InputDef) -> Option<Value> {
    let (lo, hi) = input.soft?;
    let counts = input.grown(1.0, 2.0) != 1.0;
    (counts && matches!(input.ty, Type::Float | Type::Field))
        .then(|| Value::Float((lo.max(0.0) + 0.2 * (hi - lo.max(0.0))) as f32))
}

/// How far two outputs lie apart at most, cm, and what of their attributes differs; none where they have other curves.
fn apart(one: &Curves, other: &Curves) -> Option<(f32, Vec<String>)> {
    let mut far = 0.0f32;
    let mut differ = vec![];
    if one.tufts().len() != other.tufts().len() {
        return None;
    }
    for (a, b) in one.tufts().iter().zip(other.tufts()) {
        if a.offsets() != b.offsets() {
            return None;
        }
        let pairs = a.points().iter().zip(b.points());
        far = pairs.map(|(p, q)| p.distance(*q)).fold(far, f32::max);
        let names = a.attributes().iter().filter(|attribute| *attribute.name != *PUFF_EDGE.name);
        for attribute in names {
            if b.attribute(&attribute.name).is_none_or(|is| is.values != attribute.values) {
                differ.push(attribute.name.to_string());
            }
        }
    }
    differ.sort();
    differ.dedup();
    Some((far, differ))
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

#[test]
fn on_a_head_twice_as_large_hair_is_twice_as_large() {
    for (id, few) in hostile::NODES {
        let node = crate::by_id(id).unwrap();
        if !node.scales {
            continue;
        }
        let mut set = hostile::usual(node, few);
        for input in node.inputs.iter().filter(|input| !input.fixed) {
            let is_set = set.iter().any(|(name, _)| *name == input.name);
            set.extend(asks(input).filter(|_| !is_set).map(|value| (input.name, value)));
        }
        let twice: Vec<_> = set.iter().map(|(name, value)| (*name, doubled(value))).collect();
        let small = made(node, &set);
        let want = curves_of(&[doubled(&small.clone().into())]);
        let found = apart(&want, &made(node, &twice));
        println!("{id}: {} curves: {found:?}", small.curve_count());
    }
}
