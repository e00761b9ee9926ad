//! The page of documents and their schema say what the reader reads: every field, every kind, every value.

use super::schema;
use coif_graphs::file::{self, read};
use serde_json::Value as Json;
use std::collections::BTreeSet;
use std::fmt::Write as _;

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
    let (_, list) = said.split_once("expected one of ").unwrap_or_else(|| panic!("{said}"));
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
    let node = |fields: &str| format!("(format: 2, nodes: {{\"a\": ({fields})}})");
    check("(zzz: 1)", &schema);
    check(&node("zzz: 1"), def("node_merge"));
    check("(format: 2, frames: {\"a\": (zzz: 1)})", def("frame"));
    check("(format: 2, views: {\"a\": (zzz: 1)})", def("view"));
    check("(format: 2, look: (zzz: 1))", def("look"));
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
        if let Some(name) = of["$ref"].as_str() {
            let schema = self.schema;
            return self.write(out, schema.pointer(name.trim_start_matches('#')).unwrap(), depth);
        }
        if let Some(several) = of["oneOf"].as_array() {
            let n = self.below(several.len() as u64) as usize;
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
            Some(_) => write!(out, "\"word{number}\""),
        };
    }
    fn array(&mut self, out: &mut String, of: &Json, depth: usize) {
        let is_tuple = of["x-ron"] == "tuple";
        let first = of["prefixItems"].as_array().cloned().unwrap_or_default();
        let least = of["minItems"].as_u64().unwrap_or_default().max(first.len() as u64);
        let count = if is_tuple { least } else { least + self.below(3) };
        out.push(if is_tuple { '(' } else { '[' });
        let mut items: Vec<String> = (0..count as usize)
            .map(|n| {
                let mut item = String::new();
                self.write(&mut item, first.get(n).unwrap_or(&of["items"]), depth + 1);
                item
            })
            .collect();
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
            if self.below(2) == 0 && !(properties.contains_key("points") && is_column(name)) {
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
    assert_eq!(kinds.len(), coif_nodes::all().count());
    for round in 0..12 {
        for kind in &kinds {
            let mut node = String::new();
            generator.write(&mut node, &schema["$defs"][kind.as_str()], 0);
            let mut frame = String::new();
            generator.write(&mut frame, &schema["$defs"]["frame"], 0);
            let text = format!("(format: 2, nodes: {{\"a\": {node}}}, frames: {{\"f\": {frame}}})");
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
