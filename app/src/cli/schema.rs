//! `coif nodes --schema`: a JSON Schema of documents, made of the declarations that the reader goes by.
//!
//! RON has no language of schemas, so it describes the JSON of the same shape; `x-ron` says how each part is written in RON:
//! a `struct` as `(name: value)`, a `map` as `{"name": value}`, a `tuple` as `(1, 2)`, a `variant` as `Name(value)`, a `word` bare;
//! lists, texts, numbers and truth values are as in JSON. `x-ascending`: the first numbers of the entries do not fall.
//! `x-same-length`: these lists are equally long. `x-deepest`: what refers to itself does so at most so many times.
//! `x-shorter-than`: as a vector it is shorter. `x-not-one-place`: the entries are not all the same.
//! `x-wires`: inputs and outputs that a wire may end at, with their types.

use coif_graphs::file::{FORMAT, PORT_TYPES, PORT_UNITS};
use coif_graphs::values::DEEPEST_FIELD;
use coif_nodes::data::gestures::{Layer, Tool};
use coif_nodes::data::shapes::TurnProfile;
use coif_nodes::data::strokes::Mode;
use coif_nodes::declared;
use coif_nodes::define::{Arity, InputDef, NodeDef, Type};
use serde_json::{Map, Value as Json, json};

/// The whole schema.
pub(super) fn schema() -> Json {
    let mut defs = shared();
    let kinds: Vec<Json> = coif_nodes::all()
        .map(|def| {
            let name = format!("node_{}", def.id);
            defs.insert(name.clone(), node(def));
            reference(&name)
        })
        .collect();
    let declared = declared::KINDS.into_iter().map(|kind| {
        let name = format!("node_{kind}");
        defs.insert(name.clone(), declared_node(kind));
        reference(&name)
    });
    let kinds: Vec<Json> = kinds.into_iter().chain(declared).collect();
    defs.insert("node".to_owned(), json!({"oneOf": kinds}));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "coif groom",
        "description": "The JSON of the same shape as a groom's RON; x-ron says how each part is written in RON. docs/document.md is \
                        the page of it.",
        "x-ron": "struct",
        "type": "object",
        "required": ["format"],
        "additionalProperties": false,
        "properties": {
            "format": {"type": "integer", "minimum": 1, "maximum": FORMAT},
            "title": {"type": "string"},
            "note": {"type": "string"},
            "seed": {"type": "integer", "minimum": 0, "maximum": u64::MAX},
            "display": {"$ref": "#/$defs/id"},
            "nodes": map_by("id", reference("node")),
            "links": map_by("socket", reference("wires")),
            "frames": map(reference("frame")),
            "bends": map_by("socket", list(list(reference("place"), 0), 0)),
            "collapsed": list(reference("id"), 0),
            "views": map(reference("view")),
            "look": reference("look"),
            "budget": reference("budget"),
            "layout": map_by("id", reference("place")),
            "thumbnail": {"type": "string", "contentEncoding": "base64", "contentMediaType": "image/png"},
        },
        "$defs": defs,
    })
}

fn reference(name: &str) -> Json {
    json!({"$ref": format!("#/$defs/{name}")})
}
fn map(of: Json) -> Json {
    json!({"x-ron": "map", "type": "object", "additionalProperties": of})
}
/// A map whose names are of a kind of their own.
fn map_by(name: &str, of: Json) -> Json {
    let mut map = map(of);
    map["propertyNames"] = reference(name);
    map
}
fn list(of: Json, least: usize) -> Json {
    json!({"type": "array", "items": of, "minItems": least})
}
fn tuple(of: &[Json]) -> Json {
    json!({"x-ron": "tuple", "type": "array", "prefixItems": of, "minItems": of.len(), "maxItems": of.len()})
}
fn structure(required: &[&str], properties: Json) -> Json {
    json!({
        "x-ron": "struct",
        "type": "object",
        "required": required,
        "additionalProperties": false,
        "properties": properties,
    })
}
fn variant(name: &str, of: Json) -> Json {
    json!({
        "x-ron": "variant",
        "type": "object",
        "required": [name],
        "additionalProperties": false,
        "properties": {name: of},
    })
}
fn number(low: f64, high: f64) -> Json {
    json!({"type": "number", "minimum": low, "maximum": high})
}
fn words<'a>(of: impl Iterator<Item = &'a str>) -> Json {
    json!({"type": "string", "enum": of.collect::<Vec<_>>()})
}

/// The points of a drawn section.
fn corners() -> Json {
    let (low, high) = (f64::from(-TurnProfile::FARTHEST), f64::from(TurnProfile::FARTHEST));
    let mut point = tuple(&[number(low, high), number(low, high)]);
    point["x-shorter-than"] = json!(high);
    let mut corners = list(point, TurnProfile::CORNERS.0);
    corners["maxItems"] = json!(TurnProfile::CORNERS.1);
    corners["x-not-one-place"] = json!(true);
    corners
}

/// What is the same for all kinds of nodes.
fn shared() -> Map<String, Json> {
    let any = || json!({"type": "number"});
    let vector = tuple(&[any(), any(), any()]);
    let whole = || json!({"type": "integer"});
    let id = json!({"type": "integer", "minimum": 1, "maximum": u64::MAX});
    let mut stops = list(tuple(&[number(0.0, 1.0), any()]), 1);
    stops["x-ascending"] = json!(true);
    let ramps = ["Linear", "Smooth", "Step"].map(|name| variant(name, reference("stops")));
    let with = |first: &[Json]| json!({"oneOf": first.iter().chain(&ramps).collect::<Vec<_>>()});
    let text = || json!({"type": "string"});
    let mut field = with(&[
        any(),
        variant("Attribute", text()),
        variant("Mask", text()),
        variant("Product", list(reference("field"), 0)),
    ]);
    field["x-deepest"] = json!(DEEPEST_FIELD);
    let tier = |words: &[&str]| json!({"x-ron": "word", "enum": words});
    let rose = structure(
        &["petals", "depth"],
        json!({"petals": {"type": "integer", "minimum": 2, "maximum": 12}, "depth": number(0.0, 0.95)}),
    );
    let section = json!({"oneOf": [
        {"x-ron": "word", "enum": ["Circle"]},
        variant("Ellipse", number(0.01, 1.0)),
        variant("Lame", number(0.3, 20.0)),
        variant("Polygon", json!({"type": "integer", "minimum": 3, "maximum": 12})),
        variant("Rose", rose),
        variant("Custom", corners()),
    ]});
    let mut shapes = list(tuple(&[tier(&["A", "B", "C"]), section.clone()]), 1);
    shapes["contains"] = tuple(&[tier(&["A"]), section]);
    let point = |counts: std::ops::RangeInclusive<usize>| {
        let all = [
            number(-1e5, 1e5),
            number(-1e5, 1e5),
            number(-1e5, 1e5),
            number(0.0, 1.0),
            number(0.0, 1e5),
            number(-1.0, 1.0),
            number(-1.0, 1.0),
        ];
        counts.filter(|n| *n != 6).map(|n| tuple(&all[..n])).collect::<Vec<_>>()
    };
    let columns = |names: &[&str]| -> Map<String, Json> {
        let column = |name: &&str| ((*name).to_owned(), list(whole(), 0));
        names.iter().map(column).collect()
    };
    let pen = ["x", "y", "z", "pressure", "time", "tilt_x", "tilt_y"];
    let mut drawn = columns(&pen);
    drawn.insert("points".to_owned(), list(reference("point"), 1));
    let mut stroke = drawn.clone();
    stroke.extend([
        ("id".to_owned(), id.clone()),
        ("after".to_owned(), id.clone()),
        ("mode".to_owned(), words(Mode::ALL.iter().map(|(_, word)| *word))),
        ("radius".to_owned(), number(0.05, 30.0)),
        ("strength".to_owned(), number(0.0, 1.0)),
        ("mirrored".to_owned(), json!({"type": "boolean"})),
        ("closed".to_owned(), json!({"type": "boolean"})),
        ("section".to_owned(), text()),
        ("drawn".to_owned(), structure(&["points"], drawn.into())),
    ]);
    let brush = ["mirrored", "closed", "section", "radius", "strength"];
    let needs: Map<String, Json> =
        brush.iter().map(|name| ((*name).to_owned(), json!(["mode", "radius"]))).collect();
    let mut stroke = structure(&["points"], stroke.into());
    stroke["dependentRequired"] = needs.into();
    stroke["dependentRequired"]["mode"] = json!(["radius", "strength"]);
    let moved = ["x", "y", "pressure", "time"];
    let mut gesture =
        columns(&["x", "y", "pressure", "time", "tilt_x", "tilt_y", "path_x", "path_y", "path_z"]);
    gesture.extend([
        ("id".to_owned(), id.clone()),
        ("after".to_owned(), id),
        ("tool".to_owned(), words(Tool::ALL.iter().map(|tool| tool.1))),
        ("layer".to_owned(), words(Layer::ALL.iter().map(|layer| layer.1))),
        ("eye".to_owned(), reference("vector")),
        ("target".to_owned(), reference("vector")),
        ("up".to_owned(), reference("vector")),
        ("half_height".to_owned(), any()),
        ("parallel".to_owned(), json!({"type": "boolean"})),
        ("pixels".to_owned(), any()),
        (
            "curves".to_owned(),
            list(json!({"type": "integer", "minimum": 0, "maximum": u64::MAX}), 0),
        ),
        ("root".to_owned(), reference("vector")),
        ("colour".to_owned(), reference("vector")),
        ("size".to_owned(), any()),
        ("strength".to_owned(), any()),
    ]);
    let needed =
        [&moved[..], &["id", "tool", "layer", "eye", "target", "up", "half_height", "pixels"]]
            .concat();
    let mut gesture = structure(&needed, gesture.into());
    gesture["x-same-length"] = json!(moved);
    let port_name = json!({"type": "string", "pattern": "^[a-z][a-z0-9_]*$", "maxLength": 64});
    let name = json!({
        "type": "string",
        "pattern": "^[a-z][a-z0-9_]*(/[a-z][a-z0-9_]*)*$",
        "maxLength": 16 * 65,
    });
    let socket = json!({"type": "string", "pattern": "^[a-z][a-z0-9_]*(/[a-z][a-z0-9_]*)*\\..+$"});
    let place = tuple(&[any(), any()]);
    let frame = json!({
        "at": reference("place"),
        "size": tuple(&[number(1.0, 1e6), number(1.0, 1e6)]),
        "text": text(),
        "colour": {"type": "integer", "minimum": 0, "maximum": 255},
    });
    let view = json!({
        "eye": reference("vector"),
        "target": reference("vector"),
        "up": reference("vector"),
        "focal_mm": number(1.0, 1000.0),
        "orthographic": number(0.0, 1e4),
    });
    let word = json!({"type": "string", "pattern": "^[A-Za-z0-9-]{1,64}$"});
    let look = json!({
        "light": word, "exposure": number(-20.0, 20.0), "turn": number(-180.0, 180.0), "skin": word
    });
    let points = json!({"type": "integer", "minimum": 1, "maximum": 1u64 << 53});
    let budget = json!({"seconds": number(1e-3, 1e9), "points": points, "mib": number(1e-3, 1e9)});
    let wires = json!({"oneOf": [reference("socket"), list(reference("socket"), 1)]});
    let into = json!({
        "type": "string",
        "pattern": "^\\S+ to [a-z][a-z0-9_]*\\.\\S+( after [a-z][a-z0-9_]*\\.\\S+)?$",
    });
    let all = [
        ("id", name),
        ("word", port_name),
        ("port", port()),
        ("socket", socket),
        ("wires", wires),
        ("into", into),
        ("place", place),
        ("vector", vector),
        ("stops", stops),
        ("ramp", with(&[any()])),
        ("field", field),
        ("shapes", shapes),
        ("point", json!({"oneOf": point(3..=7)})),
        ("stroke", stroke),
        ("gesture", gesture),
        ("frame", structure(&["at", "size"], frame)),
        ("view", structure(&["eye", "target", "up", "focal_mm"], view)),
        ("look", structure(&["light", "skin"], look)),
        ("budget", structure(&[], budget)),
    ];
    all.into_iter().map(|(name, of)| (name.to_owned(), of)).collect()
}

fn node(def: &NodeDef) -> Json {
    let inputs: Map<String, Json> = def
        .inputs
        .iter()
        .filter_map(|input| Some((input.name.to_owned(), value(input)?)))
        .collect();
    let ends =
        |name: &str, ty: Type, many: bool| json!({"name": name, "type": ty.name(), "many": many});
    let takes: Vec<Json> = def
        .inputs
        .iter()
        .map(|input| ends(input.name, input.ty, input.arity == Arity::Many))
        .collect();
    let gives: Vec<Json> =
        def.outputs.iter().map(|output| ends(output.name, output.ty, false)).collect();
    let inputs = json!({
        "x-ron": "map",
        "type": "object",
        "additionalProperties": false,
        "properties": inputs,
    });
    let properties = json!({
        "kind": {"const": def.id},
        "label": {"type": "string"},
        "note": {"type": "string"},
        "bypass": {"type": "boolean"},
        "inputs": inputs,
        "links": map(reference("wires")),
        "into": list(reference("into"), 0),
        "at": reference("place"),
        "collapsed": {"type": "boolean"},
    });
    let mut node = structure(&["kind"], properties);
    node["title"] = json!(def.label);
    node["description"] = json!(def.doc());
    node["x-wires"] = json!({"inputs": takes, "outputs": gives});
    node
}

/// One input or output of a group, or one parameter.
fn port() -> Json {
    let mut range = tuple(&[json!({"type": "number"}), json!({"type": "number"})]);
    range["x-rising"] = json!(true);
    let text = || json!({"type": "string"});
    let properties = json!({
        "name": reference("word"),
        "was": list(reference("word"), 0),
        "type": words(PORT_TYPES.iter().map(|(word, _)| *word)),
        "doc": text(),
        "default": {"x-any": true, "description": "a value of the port's type, as an input would have it"},
        "range": range,
        "slider": range,
        "unit": words(PORT_UNITS.iter().map(|(word, _)| *word)),
        "section": text(),
        "choices": list(tuple(&[text(), text()]), 0),
        "needed": {"type": "boolean"},
        "many": {"type": "boolean"},
    });
    structure(&["name", "type"], properties)
}

/// A node whose ports the document declares.
fn declared_node(kind: &str) -> Json {
    let def = declared::Interface::default().def(kind);
    let mut node = def.map_or(Json::Null, node);
    let mut has = |name: &str, of: Json| node["properties"][name] = of;
    if [declared::GROUP, declared::PARAMETERS].contains(&kind) {
        has(
            "inputs",
            json!({"x-ron": "map", "type": "object", "description": "values by port, each of its port's type"}),
        );
        let side = || list(reference("port"), 0);
        has("interface", structure(&[], json!({"inputs": side(), "outputs": side()})));
    }
    if kind == declared::GROUP {
        let text = || json!({"type": "string"});
        let template = json!({
            "name": text(),
            "version": text(),
            "hash": text(),
            "locked": {"type": "boolean"},
            "author": text(),
            "licence": text(),
            "tags": list(text(), 0),
            "source": text(),
            "needs": list(text(), 0),
        });
        has("template", structure(&["name"], template));
        has("nodes", map_by("id", reference("node")));
    }
    node
}

/// What an input may be set to; none where only a wire can give it.
fn value(input: &InputDef) -> Option<Json> {
    let mut of = match input.ty {
        Type::Bool => json!({"type": "boolean"}),
        Type::Int => json!({"type": "integer"}),
        Type::Float => json!({"type": "number"}),
        Type::Field => reference("field"),
        Type::Vec3 | Type::Colour => reference("vector"),
        Type::Text | Type::File => json!({"type": "string"}),
        Type::Choice(known) => words(known.iter().map(|(word, _)| *word)),
        Type::Ramp => reference("ramp"),
        Type::Shapes => reference("shapes"),
        Type::Strokes => list(reference("stroke"), 0),
        Type::Gestures => list(reference("gesture"), 0),
        Type::Curves | Type::Scalp => return None,
    };
    if let (Type::Int | Type::Float, Some((low, high))) = (input.ty, input.hard) {
        let whole = input.ty == Type::Int;
        let bound = |x: f64| if whole { json!(x as i64) } else { json!(x) };
        (of["minimum"], of["maximum"]) = (bound(low), bound(high));
    }
    of["description"] = json!(input.doc());
    if let Some(default) = input.default() {
        of["x-default"] = json!(coif_graphs::text::write_value(&default));
    }
    Some(of)
}

#[cfg(test)]
mod tests;
