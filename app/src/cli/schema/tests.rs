//! The page of documents and their schema say what the reader reads: every field, every kind, every value.

use super::schema;
use coif_graphs::file::{self, read};
use coif_graphs::grooms;
use coif_graphs::text::write_value;
use coif_graphs::values::DEEPEST_FIELD;
use coif_nodes::data::field::Field;
use coif_nodes::data::ramp::Ramp;
use coif_nodes::data::shapes::{ShapeList, Tier, TurnProfile};
use coif_nodes::define::Value;
use coif_nodes::maths::hash::Dice;
use glam::Vec2;
use serde_json::Value as Json;
use std::collections::BTreeSet;
use std::fmt::Write as _;

mod allows;

fn docs(name: &str) -> String {
    let path = format!("{}/../docs/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|err| panic!("{path}: {err}"))
}

#[test]
fn the_schema_in_docs_is_the_one_of_this_program() {
    let now = serde_json::to_string_pretty(&schema()).unwrap() + "\n";
    assert!(
        docs("document.schema.json") == now,
        "write docs/document.schema.json anew: coif nodes --schema"
    );
}

#[test]
fn the_examples_of_the_page_are_read_without_a_word() {
    let page = docs("document.md");
    let examples: Vec<&str> =
        page.split("```ron\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert!(examples.len() >= 5, "{}", examples.len());
    for text in examples {
        let loaded = read(text).unwrap_or_else(|err| panic!("{err}\n{text}"));
        assert_eq!((loaded.warnings, loaded.dropped_comments), (vec![], vec![]), "{text}");
        let problems = coif_graphs::document::graph::check(&loaded.document);
        let wrong = |p: &&coif_graphs::document::graph::Problem| p.to_string().contains("no such");
        assert_eq!(problems.iter().filter(wrong).count(), 0, "{text}");
    }
}

/// The fields that the reader says it knows where it meets one that it does not.
fn known(text: &str) -> BTreeSet<String> {
    let said = match read(text) {
        Err(err) => err.message,
        Ok(loaded) => loaded.warnings.iter().map(|w| w.message.clone()).collect(),
    };
    let (_, list) = said.split_once("`, expected ").unwrap_or_else(|| panic!("{said}"));
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn every_field_of_the_reader_is_on_the_page_and_in_the_schema_and_no_other() {
    let (page, schema) = (docs("document.md"), schema());
    let properties = |of: &Json| -> BTreeSet<String> {
        of["properties"].as_object().unwrap().keys().cloned().collect()
    };
    let def = |name: &str| &schema["$defs"][name];
    let check = |text: &str, of: &Json| {
        let found = known(text);
        assert_eq!(found, properties(of), "{text}");
        for name in found {
            assert!(page.contains(&format!("`{name}`")), "{name} of {text} is not on the page");
        }
    };
    let node = |fields: &str| format!("(format: 3, nodes: {{\"a\": ({fields})}})");
    check("(zzz: 1)", &schema);
    check(&node("zzz: 1"), def("node_group"));
    check(&node("interface: (zzz: 1)"), &def("node_group")["properties"]["interface"]);
    check(&node("interface: (inputs: [(zzz: 1)])"), def("port"));
    check(&node("template: (zzz: 1)"), &def("node_group")["properties"]["template"]);
    check("(format: 3, frames: {\"a\": (zzz: 1)})", def("frame"));
    check("(format: 3, views: {\"a\": (zzz: 1)})", def("view"));
    check("(format: 3, look: (zzz: 1))", def("look"));
    check("(format: 3, budget: (zzz: 1))", def("budget"));
    let strokes =
        |text: &str| node(&format!("kind: \"stroke_input\", inputs: {{\"strokes\": [{text}]}}"));
    check(&strokes("(zzz: 1)"), def("stroke"));
    check(&strokes("(drawn: (zzz: 1))"), &def("stroke")["properties"]["drawn"]);
    check(&node("kind: \"hair_sketch\", inputs: {\"gestures\": [(zzz: 1)]}"), def("gesture"));
    for word in
        ["Linear", "Smooth", "Step", "Attribute", "Mask", "Product", "Circle", "Ellipse", "Lame"]
    {
        assert!(page.contains(word), "{word}");
    }
}

/// Writes what a schema allows, by nothing but what it says.
struct Generator<'a> {
    schema: &'a Json,
    state: u64,
}

impl Generator<'_> {
    fn below(&mut self, n: u64) -> u64 {
        self.state = self
            .state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) % n.max(1)
    }
    fn number(&mut self, of: &Json) -> f64 {
        let bound = |name: &str, other: f64| of[name].as_f64().unwrap_or(other);
        let (low, high) = (bound("minimum", -50.0), bound("maximum", 50.0));
        match self.below(4) {
            0 => low,
            1 => high,
            _ => low + (high - low) * self.below(1001) as f64 / 1000.0,
        }
    }
    fn write(&mut self, out: &mut String, of: &Json, depth: usize) {
        // Of what refers to itself, the first of several does not.
        let deepest = of["x-deepest"].as_u64().is_some_and(|most| depth as u64 > most);
        if let Some(name) = of["$ref"].as_str() {
            let schema = self.schema;
            return self.write(out, schema.pointer(name.trim_start_matches('#')).unwrap(), depth);
        }
        if let Some(several) = of["oneOf"].as_array() {
            let n = if deepest { 0 } else { self.below(several.len() as u64) as usize };
            return self.write(out, &several[n], depth);
        }
        if let Some(word) = of["const"].as_str() {
            let _ = write!(out, "{word:?}");
            return;
        }
        if let Some(words) = of["enum"].as_array() {
            let word = words[self.below(words.len() as u64) as usize].as_str().unwrap();
            let _ =
                if of["x-ron"] == "word" { write!(out, "{word}") } else { write!(out, "{word:?}") };
            return;
        }
        match of["type"].as_str().unwrap() {
            "boolean" => out.push_str(["true", "false"][self.below(2) as usize]),
            "integer" if of["maximum"].as_u64() == Some(u64::MAX) => {
                let _ = write!(out, "{}", 1 + self.below(u64::MAX));
            }
            "integer" => {
                let _ = write!(out, "{}", self.number(of).round());
            }
            "number" => {
                let _ = write!(out, "{:?}", self.number(of) as f32);
            }
            "string" => self.text(out, of),
            "array" => self.array(out, of, depth),
            _ => self.object(out, of, depth),
        }
    }
    fn text(&mut self, out: &mut String, of: &Json) {
        let number = self.below(50);
        let _ = match of["pattern"].as_str() {
            None => write!(out, "\"some words {number}\""),
            Some(pattern) if pattern.contains("to ") => {
                write!(out, "\"curves to all_{number}.curves after other_{number}.curves\"")
            }
            Some(pattern) if pattern.contains("\\.") => write!(out, "\"node_{number}.curves\""),
            Some(_) => write!(out, "\"word{}\"", self.below(1 << 30)),
        };
    }
    fn array(&mut self, out: &mut String, of: &Json, depth: usize) {
        let is_tuple = of["x-ron"] == "tuple";
        let first = of["prefixItems"].as_array().cloned().unwrap_or_default();
        let least = of["minItems"].as_u64().unwrap_or_default().max(first.len() as u64);
        let more = of["maxItems"].as_u64().map_or(2, |most| (most - least).min(2));
        let count = if is_tuple { least } else { least + self.below(more + 1) };
        if of["x-rising"] == true {
            let _ = write!(out, "({}.5, {}.0)", self.below(50), 51 + self.below(50));
            return;
        }
        out.push(if is_tuple { '(' } else { '[' });
        let mut items: Vec<String> = (0..count as usize)
            .map(|n| {
                let mut item = String::new();
                self.write(&mut item, first.get(n).unwrap_or(&of["items"]), depth + 1);
                item
            })
            .collect();
        // A number in the first place is not the same in all of them, and shorter than the longest allowed.
        if of["x-not-one-place"] == true {
            for (n, item) in items.iter_mut().enumerate() {
                *item = format!("({n}.5, {}.0)", self.below(500));
            }
        }
        if of.get("contains").is_some() {
            let n = self.below(count) as usize;
            items[n].clear();
            self.write(&mut items[n], &of["contains"], depth + 1);
        }
        if of["x-ascending"] == true {
            let at =
                |item: &String| -> f64 { item[1..].split(',').next().unwrap().parse().unwrap() };
            items.sort_by(|a, b| at(a).total_cmp(&at(b)));
        }
        out.push_str(&items.join(", "));
        out.push(if is_tuple { ')' } else { ']' });
    }
    fn object(&mut self, out: &mut String, of: &Json, depth: usize) {
        let properties = of["properties"].as_object().cloned().unwrap_or_default();
        if of["x-ron"] == "variant" {
            let (name, inner) = properties.iter().next().unwrap();
            let mut value = String::new();
            self.write(&mut value, inner, depth + 1);
            // A variant of named fields has their brackets alone.
            let _ = match inner["x-ron"] == "struct" {
                true => write!(out, "{name}{value}"),
                false => write!(out, "{name}({value})"),
            };
            return;
        }
        let is_map = of["x-ron"] == "map";
        let mut chosen: BTreeSet<&str> =
            of["required"].as_array().into_iter().flatten().filter_map(Json::as_str).collect();
        for name in properties.keys() {
            // Columns are how format 1 wrote points.
            let any = properties[name]["x-any"] == true;
            if !any && self.below(2) == 0 && !(properties.contains_key("points") && is_column(name))
            {
                chosen.insert(name);
            }
        }
        for name in chosen.clone() {
            let needs = of["dependentRequired"][name].as_array().into_iter().flatten();
            chosen.extend(needs.filter_map(Json::as_str));
        }
        // Brushes ask for one another.
        if chosen.contains("radius") && of["dependentRequired"].is_object() {
            chosen.extend(["mode", "strength"]);
        }
        out.push(if is_map { '{' } else { '(' });
        let same = of["x-same-length"].as_array().cloned().unwrap_or_default();
        for name in chosen {
            let _ = if is_map { write!(out, "{name:?}: ") } else { write!(out, "{name}: ") };
            match same.iter().any(|n| n == name) {
                true => out.push_str("[1, 2]"),
                false => self.write(out, &properties[name], depth + 1),
            }
            out.push_str(", ");
        }
        if is_map && of["additionalProperties"].is_object() {
            for n in 0..self.below(3) {
                let id = format!("n{n}_{}", self.below(1 << 30));
                let is_socket = of["propertyNames"]["$ref"] == "#/$defs/socket";
                let _ = write!(out, "\"{id}{}\": ", if is_socket { ".curves" } else { "" });
                self.write(out, &of["additionalProperties"], depth + 1);
                out.push_str(", ");
            }
        }
        out.push(if is_map { '}' } else { ')' });
    }
}

fn is_column(name: &str) -> bool {
    ["x", "y", "z", "pressure", "time", "tilt_x", "tilt_y"].contains(&name)
}

/// Documents of every kind of node, made by the schema that stands in docs.
#[test]
fn what_the_schema_allows_is_read() {
    let schema: Json = serde_json::from_str(&docs("document.schema.json")).unwrap();
    let mut generator = Generator { schema: &schema, state: 7 };
    let kinds: Vec<&String> = schema["$defs"]
        .as_object()
        .unwrap()
        .keys()
        .filter(|name| name.starts_with("node_"))
        .collect();
    assert_eq!(kinds.len(), coif_nodes::all().count() + coif_nodes::declared::KINDS.len());
    for round in 0..12 {
        for kind in &kinds {
            let mut node = String::new();
            generator.write(&mut node, &schema["$defs"][kind.as_str()], 0);
            let mut frame = String::new();
            generator.write(&mut frame, &schema["$defs"]["frame"], 0);
            let text = format!("(format: 3, nodes: {{\"a\": {node}}}, frames: {{\"f\": {frame}}})");
            let loaded = read(&text).unwrap_or_else(|err| panic!("{kind}: {err}\n{text}"));
            // Two points of view and the pen's own laws are told in words.
            let told = |w: &&file::FileError| !w.message.contains("gesture");
            let told: Vec<String> =
                loaded.warnings.iter().filter(told).map(ToString::to_string).collect();
            assert!(told.is_empty(), "round {round}: {told:?}\n{text}");
            let written = file::write(&loaded.document);
            assert_eq!(read(&written).unwrap().document, loaded.document, "{text}");
        }
        let mut whole = String::new();
        generator.write(&mut whole, &schema, 0);
        read(&whole).unwrap_or_else(|err| panic!("{err}\n{whole}"));
    }
}

/// A random field, `depth` deep at most.
fn any_field(dice: &Dice, id: &mut u64, depth: usize) -> Field {
    *id += 1;
    match dice.below(*id, 0, if depth > 1 { 6 } else { 4 }) {
        0 => Field::Constant(dice.range(*id, 1, -9.0, 9.0)),
        1 => Field::Attribute("frizz".to_owned()),
        2 => Field::Mask("a \"mask\"\n".to_owned()),
        3 => Field::Ramp(Ramp::linear(dice.unit(*id, 2), 1.0)),
        _ => {
            let parts = 1 + dice.below(*id, 3, 2);
            Field::Product((0..parts).map(|_| any_field(dice, id, depth - 1)).collect())
        }
    }
}

/// Random sections, one of which is in tier A.
fn any_shapes(dice: &Dice, count: u64) -> ShapeList {
    let one = |id: u64| {
        let tier = [Tier::B, Tier::C][dice.below(id, 0, 2) as usize];
        let point = |k: u64| Vec2::new(dice.signed(id, 10 + k), dice.signed(id, 5000 + k)) * 700.0;
        let section = match dice.below(id, 1, 7) {
            0 => TurnProfile::Circle,
            1 => TurnProfile::Ellipse(dice.range(id, 2, 0.01, 1.0)),
            2 => TurnProfile::Lame(dice.range(id, 3, 0.3, 20.0)),
            3 => TurnProfile::Polygon(3 + dice.below(id, 4, 10)),
            4 => TurnProfile::Rose {
                petals: 2 + dice.below(id, 5, 11),
                depth: dice.unit(id, 6) * 0.95,
            },
            _ => {
                TurnProfile::Custom((0..3 + u64::from(dice.below(id, 7, 254))).map(point).collect())
            }
        };
        (tier, section)
    };
    let mut all: Vec<_> = (0..count).map(one).collect();
    all[dice.below(0, 8, count as u32) as usize].0 = Tier::A;
    ShapeList(all)
}

/// Documents of random values, the deepest field that is read, and all that comes along.
#[test]
fn what_is_read_is_allowed_by_the_schema() {
    let schema: Json = serde_json::from_str(&docs("document.schema.json")).unwrap();
    let check = |text: &str| {
        let loaded = read(text).unwrap_or_else(|err| panic!("{err}\n{text}"));
        assert!(loaded.warnings.is_empty(), "{:?}\n{text}", loaded.warnings);
        for text in [text, &file::write(&loaded.document)] {
            let fault = allows::fault(&schema, &schema, &allows::json_of(text));
            assert_eq!(fault, None, "{text}");
        }
    };
    let with = |field: &Field, shapes: &ShapeList| {
        let [field, shapes] =
            [Value::from(field.clone()), Value::from(shapes.clone())].map(|v| write_value(&v));
        check(&format!(
            "(format: 3, nodes: {{\"a\": (kind: \"stroke_input\", inputs: {{\"radius\": {field}}}), \
             \"b\": (kind: \"shape_list_curl\", inputs: {{\"shapes\": {shapes}}})}})"
        ));
    };
    for round in 0..200 {
        let dice = Dice::new(round, 0, "documents");
        with(&any_field(&dice, &mut 0, DEEPEST_FIELD), &any_shapes(&dice, 1 + round % 4));
    }
    let deepest = (1..DEEPEST_FIELD).fold(Field::Constant(1.0), |of, _| Field::Product(vec![of]));
    with(&deepest, &any_shapes(&Dice::new(1, 0, "shapes"), 1));
    grooms::ALL.iter().chain(grooms::TEMPLATES).for_each(|(_, text)| check(text));
}
