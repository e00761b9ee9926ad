//! Attributes of guides reach the hair of every node, a user's own too, by the rule of their type.
//!
//! Which nodes these are is read from their declarations: all that take curves and give some. On each curve that comes in lie ten
//! attributes of made-up names, one of each type for curves and for points, all of which say the number of the curve and, at
//! points, how far along it they are. So what comes out says which curve a value is from, and from where along it.

use super::{Bench, head};
use crate::data::attributes::{Attribute, Domain, Item, PARENT};
use crate::data::curves::{Curves, Tuft};
use crate::define::{InputDef, NodeDef, Type, Value};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Curves that no hair is made from, with the reason.
const NO_GUIDES: &[(&str, &str, &str)] = &[
    ("braid_hair", "stitches", "they say where hair joins"),
    ("bun", "ties", "a tie holds hair"),
    ("clump", "centres", "hair is drawn to them, and stays what it is"),
    ("edge_partition", "adjacent", "they are beside the rows that hair is made for"),
    ("edge_partition", "left", "they are beside the rows that hair is made for"),
    ("edge_partition", "picked", "they say where hair gathers"),
    ("edge_partition", "right", "they are beside the rows that hair is made for"),
    ("edge_partition", "stitches", "they say where hair gathers"),
    ("gather", "placements", "they say where ties sit"),
    ("partings", "between", "they say where lines lie"),
    ("partings", "lines", "they say where lines lie"),
    ("scatter_guides", "strokes", "they give directions alone"),
    ("shape_list_curl", "shape_curves", "they are shapes of turns"),
    ("sphere_puff", "front", "it is an outline"),
    ("sphere_puff", "placements", "they say where puffs sit"),
    ("sphere_puff", "side", "it is an outline"),
    ("sphere_puff", "ties", "a tie holds hair"),
    ("tail", "ties", "a tie holds hair"),
    ("trim", "front", "it is an outline"),
    ("trim", "side", "it is an outline"),
];
/// Curves that are no hair made from those, or not made here, with the reason.
const NO_HAIR: &[(&str, &str, &str)] = &[
    ("braid_hair", "bands", "an elastic band"),
    ("braid_hair", "extension", "it is made as hair that grows, of hair that is fed in alone"),
    ("gather", "bands", "it is wound round a tie"),
    ("gather", "ties", "they say where hair is held"),
    ("lissajous_braid", "stitches", "they say where hair joins"),
];
/// What makes some of all hair that a node can make.
const MORE: &[(&str, &str, f32)] =
    &[("braid_territory", "feed", 30.0), ("lissajous_braid", "flyaways", 3.0)];
/// How a number of parents that are mixed ends, in the name of an input.
const MIXES: [&str; 2] = ["_per_hair", "_per_guide"];

/// Along its curve, a value of a point rises by so much.
const RISE: f32 = 0.5;

/// Numbers of the points of a curve, by those of curves.
const CVS: i32 = 10_000;

fn name(of: &str, domain: Domain, ty: &str) -> String {
    format!("own {of} {domain:?} {ty}")
}

fn is_listed(list: &[(&str, &str, &str)], node: &NodeDef, name: &str) -> bool {
    list.iter().any(|(id, other, _)| *id == node.id && *other == name)
}

fn guides(node: &NodeDef) -> impl Iterator<Item = &'static InputDef> {
    node.inputs
        .iter()
        .filter(|input| input.ty == Type::Curves && !is_listed(NO_GUIDES, node, input.name))
}

/// The same curves, with the ten attributes.
fn marked(curves: &Curves, of: &str) -> Curves {
    let mut number = 0;
    let tufts = curves.tufts().iter().map(|tuft| {
        let (mut whole, mut points) = (vec![], vec![]);
        for i in 0..tuft.len() {
            number += 1;
            whole.push((number as f32, number));
            let last = (tuft.range(i).len().max(2) - 1) as f32;
            points.extend(
                (0..tuft.range(i).len() as i32)
                    .map(|k| (number as f32 + RISE * k as f32 / last, CVS * number + k)),
            );
        }
        let mut b = tuft.edit();
        for (domain, all) in [(Domain::Curve, whole), (Domain::Point, points)] {
            let x = || all.iter().map(|(x, _)| *x);
            let n = || all.iter().map(|(_, n)| *n);
            let columns = [
                ("f32", f32::column(x().collect())),
                ("i32", i32::column(n().collect())),
                ("u64", u64::column(n().map(|n| n as u64).collect())),
                ("vec2", Vec2::column(x().map(|x| Vec2::new(x, -x)).collect())),
                ("vec3", Vec3::column(x().map(|x| Vec3::new(x, 2.0 * x, 1.0 - x)).collect())),
            ];
            for (ty, values) in columns {
                b.set_column(Attribute { name: name(of, domain, ty).into(), domain, values });
            }
        }
        Arc::new(b.build())
    });
    Curves::new(tufts.collect())
}

/// What the hair of a tuft has of an attribute at each of its points, with the number of its curve.
fn read<T: Item>(tuft: &Tuft, of: &str, domain: Domain, ty: &str) -> Result<Vec<T>, String> {
    let name = name(of, domain, ty);
    let view = tuft.view_named::<T>(&name).ok_or_else(|| format!("has no {name}"))?;
    let points = (0..tuft.len()).flat_map(|i| tuft.range(i).map(move |p| (i, p)));
    Ok(points.map(|(i, p)| view.at(i, p)).collect())
}

/// All five, at each point: the number, as ids tell and as numbers tell.
fn told(tuft: &Tuft, of: &str, domain: Domain) -> Result<Vec<(i32, f32)>, String> {
    let x = read::<f32>(tuft, of, domain, "f32")?;
    let n = read::<i32>(tuft, of, domain, "i32")?;
    let same = read::<u64>(tuft, of, domain, "u64")?.iter().zip(&n).all(|(a, b)| *a == *b as u64);
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-4 * (1.0 + b.abs());
    let two = read::<Vec2>(tuft, of, domain, "vec2")?;
    let three = read::<Vec3>(tuft, of, domain, "vec3")?;
    let alike = x.iter().zip(two.iter().zip(&three)).all(|(x, (two, three))| {
        near(two.x, *x)
            && near(two.y, -x)
            && near(three.x, *x)
            && near(three.y, 2.0 * x)
            && near(three.z, 1.0 - x)
    });
    match same && alike {
        true => Ok(n.into_iter().zip(x).collect()),
        false => Err(format!("types of {domain:?} differ")),
    }
}

/// What is wrong with the hair that was made from these curves: `mixes` says whether of several at once.
fn wrong(hair: &Curves, guides: &Curves, of: &str, mixes: bool) -> Result<(), String> {
    let ids: Vec<u64> = guides.each().map(|(tuft, i)| tuft.id(i)).collect();
    let last_cv: Vec<i32> = guides.each().map(|(t, i)| t.range(i).len() as i32 - 1).collect();
    let most = ids.len() as f32;
    let (mut is_mixed, mut least_along, mut most_along) = (false, f32::MAX, f32::MIN);
    for tuft in hair.tufts() {
        let whole = told(tuft, of, Domain::Curve)?;
        let along = told(tuft, of, Domain::Point)?;
        for i in 0..tuft.len() {
            for p in tuft.range(i) {
                let ((number, x), (cv, at)) = (whole[p], along[p]);
                let Some(id) = ids.get((number - 1) as usize) else {
                    return Err(format!("is of no curve: {number}"));
                };
                // What came in, or its parent. (Hair that came in may have the id of what is made of its parent anew.)
                let of = [tuft.id(i), tuft.view(PARENT).at(i, p)];
                if !of.contains(id) && of.iter().any(|of| ids.contains(of)) {
                    return Err(format!("is not as the curve that it is of: {number}"));
                }
                if !(1.0..=most).contains(&x) || !(0.999..most + RISE + 0.001).contains(&at) {
                    return Err(format!("lies not between its parents: {x}, {at}"));
                }
                is_mixed |= x != number as f32;
                if cv / CVS != number {
                    return Err(format!("has points of another curve: {cv}, {number}"));
                }
                if !mixes {
                    // Ids are those of the point before.
                    let share = (at - number as f32) / RISE;
                    let off = share * last_cv[(number - 1) as usize] as f32 - (cv % CVS) as f32;
                    if x != number as f32 || !(-0.1..1.1).contains(&off) {
                        return Err(format!("is elsewhere: {x}, {number}: {at}, {cv}"));
                    }
                    (least_along, most_along) = (least_along.min(share), most_along.max(share));
                }
            }
        }
    }
    if mixes != is_mixed {
        return Err(format!("mixed: {is_mixed}"));
    }
    match mixes || most_along - least_along > 0.3 {
        true => Ok(()),
        false => Err(format!("points lie from {least_along} to {most_along} of their curves")),
    }
}

#[test]
fn attributes_of_guides_reach_the_hair_of_every_node() {
    let bench = Bench::new("the built-in head", head(&[]), "whole", 8);
    let (mut faults, mut seen) = (vec![], 0);
    let gives_curves = |node: &&NodeDef| node.outputs.iter().any(|out| out.ty == Type::Curves);
    for node in crate::all().filter(gives_curves).filter(|node| guides(node).next().is_some()) {
        let mut set: BTreeMap<&str, Value> = bench.usual(node).into_iter().collect();
        for (id, input, value) in MORE.iter().filter(|(id, ..)| *id == node.id) {
            assert!(node.input(input).is_some(), "{id} has no {input}");
            set.insert(input, Value::Float(*value));
        }
        let mut came = vec![];
        for input in guides(node) {
            let curves = match set.get(input.name) {
                Some(Value::Curves(curves)) => marked(curves, input.name),
                _ => marked(&bench.hair(), input.name),
            };
            set.insert(input.name, curves.clone().into());
            came.push((input, curves));
        }
        let mixing = node.inputs.iter().find(|it| MIXES.iter().any(|end| it.name.ends_with(end)));
        let alone = mixing.map(|input| (input.name, Value::Int(1)));
        for one in [None, alone].into_iter().take(1 + usize::from(mixing.is_some())) {
            let mixes = mixing.is_some() && one.is_none();
            set.extend(one);
            let set: Vec<(&'static str, Value)> = set.clone().into_iter().collect();
            let made = bench.run(node, &set).expect("little is made");
            for (value, out) in made.iter().zip(node.outputs) {
                let Value::Curves(hair) = value else { continue };
                if is_listed(NO_HAIR, node, out.name) {
                    continue;
                }
                if hair.curve_count() == 0 {
                    faults.push(format!("{}.{} is empty", node.id, out.name));
                    continue;
                }
                seen += 1;
                for (input, guides) in &came {
                    if let Err(what) = wrong(hair, guides, input.name, mixes) {
                        faults.push(format!("{}.{}, {}: {what}", node.id, out.name, input.name));
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(seen > 25, "{seen}");
}
