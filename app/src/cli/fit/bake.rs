//! A document in the units of the head that it was carried to: what is given in head units goes through the map once and for all.
//!
//! Guarantees: strokes, gestures, names and places lie where the map brought them, to 0.001 mm. Not promised: mirrored twins of
//! strokes and ties, which are mirrored on the new head then and not on the home.

use coif_graphs::document::graph::downstream;
use coif_graphs::document::{Document, Node, NodeId, Setting};
use coif_nodes::data::gestures::{Gestures, Tool};
use coif_nodes::data::scalp::HeadSpace;
use coif_nodes::data::sections::named_points;
use coif_nodes::data::strokes::Strokes;
use coif_nodes::define::Value;
use glam::Vec3;
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

/// Brings everything that hangs from a head to the units of that head's own frame, and takes its map away. What it cannot is told.
pub(super) fn bake(
    document: &mut Document,
    head: &NodeId,
    space: &HeadSpace,
    warnings: &mut Vec<String>,
) {
    for id in downstream(document, [head]) {
        let Some(node) = document.nodes.get_mut(&id).map(Arc::make_mut) else { continue };
        for setting in node.inputs.values_mut() {
            match setting {
                Setting::Known(Value::Strokes(strokes)) => *strokes = moved(strokes, space).into(),
                Setting::Known(Value::Gestures(all)) => *all = replayed(all, space).into(),
                _ => {}
            }
        }
        let kind = node.kind.clone();
        for (_, input) in PLACES.into_iter().filter(|place| kind == place.0) {
            place(node, input, space);
        }
        for (_, input) in NAMES.into_iter().filter(|name| kind == name.0) {
            let Some(text) = super::text_of(node, input) else { continue };
            let (names, faults) = named_points(&text);
            if !faults.is_empty() {
                warnings.push(format!("{id}: {input} was left as it is: {}", faults.join(", ")));
                continue;
            }
            let entry = |(name, at): &(String, Vec3)| {
                let [x, y, z] = rounded(space.own(*at)).to_array();
                format!("{name} {x} {y} {z}")
            };
            let text = names.iter().map(entry).collect::<Vec<_>>().join("; ");
            node.inputs.insert(input.to_owned(), Setting::Known(Value::Text(text.into())));
        }
    }
    if let Some(node) = document.nodes.get_mut(head) {
        Arc::make_mut(node).inputs.remove("home");
    }
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

/// A place of a node, its default too.
fn place(node: &mut Node, input: &str, space: &HeadSpace) {
    let Some(def) = coif_nodes::by_id(&node.kind) else { return };
    let value = |name: &str| match node.inputs.get(name) {
        Some(Setting::Known(value)) => Some(value.clone()),
        Some(Setting::Raw(_)) => None,
        None => def.input(name).and_then(|(_, input)| input.default()),
    };
    if matches!(value("space"), Some(Value::Text(word)) if &*word != "head") {
        return;
    }
    let Some(Value::Vec3(at)) = value(input) else { return };
    let at = Value::Vec3(rounded(space.own(at)));
    node.inputs.insert(input.to_owned(), Setting::Known(at));
}
