//! A document in the units of the head that it was carried to: what is given in head units goes through the map once and for all.
//!
//! Guarantees: strokes, gestures, names and places lie where the map brought them, to 0.001 mm. Not promised: mirrored twins of
//! strokes and ties, which are mirrored on the new head then and not on the home.

use coif_graphs::document::graph::downstream;
use coif_graphs::document::{Document, NodeId, Setting};
use coif_nodes::data::gestures::{Gestures, Tool};
use coif_nodes::data::scalp::HeadSpace;
use coif_nodes::data::sections::named_points;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::declared::{GROUP, GROUP_INPUT, KINDS, PARAMETERS};
use coif_nodes::define::{Type, Value};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Places in head units, by kind of node and input. (The centre of a head node is no such place: it moves the units themselves.)
const PLACES: [(&str, &str); 6] = [
    ("scatter_guides", "crown"),
    ("gather", "position"),
    ("sphere_puff", "position"),
    ("partings", "centre"),
    ("trim", "centre"),
    ("transform", "pivot"),
];
/// Texts of names, each with a place in head units.
const NAMES: [(&str, &str); 2] = [("head", "names"), ("partings", "names")];

/// What is given in head units.
#[derive(Clone, Copy, PartialEq)]
enum Given {
    Strokes,
    Gestures,
    Place,
    Names,
}

/// Brings everything that hangs from a head to the units of that head's own frame, and takes its map away. A value that comes by
/// ports of groups or by parameters is changed where it is set. What cannot be brought along is told.
pub(crate) fn bake(
    document: &mut Document,
    head: &NodeId,
    space: &HeadSpace,
    warnings: &mut Vec<String>,
) {
    let sites = sites(document, head, warnings);
    let mut changed_inside = BTreeSet::new();
    for ((id, input), (given, default)) in &sites {
        let def = document.def(id);
        let Some(node) = document.nodes.get_mut(id).map(Arc::make_mut) else { continue };
        let value = match node.inputs.get(input) {
            Some(Setting::Known(value)) => Some(value.clone()),
            Some(Setting::Raw(_)) => None,
            None => def
                .and_then(|def| def.input(input))
                .and_then(|(_, input)| input.default())
                .or_else(|| default.clone()),
        };
        let known = value.as_ref().map(Value::key);
        let baked = match (given, value) {
            (Given::Strokes, Some(Value::Strokes(strokes))) => moved(&strokes, space).into(),
            (Given::Gestures, Some(Value::Gestures(all))) => replayed(&all, space).into(),
            (Given::Place, Some(Value::Vec3(at))) => Value::Vec3(rounded(space.own(at))),
            (Given::Names, Some(Value::Text(text))) => match renamed(&text, space) {
                Ok(text) => Value::Text(text),
                Err(faults) => {
                    warnings.push(format!("{id}: {input} was left as it is: {faults}"));
                    continue;
                }
            },
            _ => continue,
        };
        // Such as no strokes at all.
        if known == Some(baked.key()) {
            continue;
        }
        node.inputs.insert(input.clone(), Setting::Known(baked));
        let holds = |id: &NodeId| document.node(id.as_str()).is_some_and(|n| n.template.is_some());
        let instance = std::iter::successors(id.group(), NodeId::group).find(holds);
        changed_inside.extend(instance);
    }
    for id in changed_inside {
        warnings.push(format!(
            "{id}: what is drawn inside it is in units of the new head now, so it is no longer its template's: upgrade it with --force alone"
        ));
    }
    if let Some(node) = document.nodes.get_mut(head) {
        Arc::make_mut(node).inputs.remove("home");
    }
}

/// Where a value is set: an input of a node, or a port of a group or of parameters.
type Site = (NodeId, String);

/// All places where something in head units is set that is read on a head, what it is, and what its reader has where nothing is.
fn sites(
    document: &Document,
    head: &NodeId,
    warnings: &mut Vec<String>,
) -> BTreeMap<Site, (Given, Option<Value>)> {
    let on_head = downstream(document, [head]);
    let mut out = BTreeMap::new();
    let mut others: BTreeMap<Site, NodeId> = BTreeMap::new();
    for id in document.nodes.keys() {
        let Some(def) = document.def(id).filter(|def| !KINDS.contains(&def.id)) else { continue };
        for input in def.inputs {
            let from = set_at(document, id, input.name);
            let read = given(def.id, input.name, input.ty)
                .filter(|_| on_head.contains(id) && is_in_head_units(document, id, input.name));
            let Some(read) = read else {
                others.extend(from.into_iter().flatten().map(|site| (site, id.clone())));
                continue;
            };
            match from {
                Some(all) => {
                    out.extend(all.into_iter().map(|site| (site, (read, input.default()))))
                }
                None => warnings.push(format!(
                    "{id}: {} is made by a node, and stays in units of the old head",
                    input.name
                )),
            }
        }
    }
    for ((id, input), other) in others.iter().filter(|(site, _)| out.contains_key(*site)) {
        warnings.push(format!(
            "{other} reads {input} of {id} too, which is in units of the new head now"
        ));
    }
    out
}

/// What an input of a node is given as, in head units; none where it is not.
fn given(kind: &str, input: &str, ty: Type) -> Option<Given> {
    match ty {
        Type::Strokes => Some(Given::Strokes),
        Type::Gestures => Some(Given::Gestures),
        _ if PLACES.contains(&(kind, input)) => Some(Given::Place),
        _ if NAMES.contains(&(kind, input)) => Some(Given::Names),
        _ => None,
    }
}

/// A transform may be in the space of the scene.
fn is_in_head_units(document: &Document, id: &NodeId, input: &str) -> bool {
    let space = || {
        let (node, name) = set_at(document, id, "space")?.pop()?;
        let node = document.node(node.as_str())?;
        match node.inputs.get(&name) {
            Some(Setting::Known(Value::Text(word))) => Some(word.clone()),
            _ => None,
        }
    };
    input != "pivot" || space().is_none_or(|word| &*word == "head")
}

/// Where what an input reads is set, through groups and parameters; none where a node makes it.
fn set_at(document: &Document, id: &NodeId, input: &str) -> Option<Vec<Site>> {
    let wires = document.wires(id, input);
    if wires.is_empty() {
        return Some(vec![(id.clone(), input.to_owned())]);
    }
    let mut out = vec![];
    for wire in wires {
        let at = match document.node(wire.node.as_str())?.kind.as_str() {
            GROUP_INPUT => wire.node.group()?,
            GROUP => {
                let out = document.outputs_of(&wire.node)?;
                (!document.wires(out, &wire.name).is_empty()).then(|| out.clone())?
            }
            PARAMETERS => wire.node.clone(),
            _ => return None,
        };
        out.extend(set_at(document, &at, &wire.name)?);
    }
    Some(out)
}

fn renamed(text: &str, space: &HeadSpace) -> Result<Arc<str>, String> {
    let (names, faults) = named_points(text);
    if !faults.is_empty() {
        return Err(faults.join(", "));
    }
    let entry = |(name, at): &(String, Vec3)| {
        let [x, y, z] = rounded(space.own(*at)).to_array();
        format!("{name} {x} {y} {z}")
    };
    Ok(names.iter().map(entry).collect::<Vec<_>>().join("; ").into())
}

/// To what documents write anyway: 0.001 mm.
fn rounded(p: Vec3) -> Vec3 {
    (p * 1e4).round() / 1e4
}

fn moved(strokes: &Strokes, space: &HeadSpace) -> Strokes {
    let mut out = strokes.clone();
    let samples = out.0.iter_mut().flat_map(|stroke| &mut stroke.samples);
    samples.for_each(|sample| sample.position = rounded(space.own(sample.position)));
    out
}

/// Where gestures are rooted. (What they drew from there is in the frame of the root, and what they see by the head's frame.)
fn replayed(gestures: &Gestures, space: &HeadSpace) -> Gestures {
    let mut out = gestures.clone();
    for gesture in &mut out.0 {
        gesture.root = gesture.root.map(|root| rounded(space.own(root)));
        if gesture.tool == Tool::Scatter {
            gesture.path.iter_mut().for_each(|p| *p = rounded(space.own(*p)));
        }
    }
    out
}
