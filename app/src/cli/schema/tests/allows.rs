//! RON as coif writes it, told whether a schema allows it: the JSON of the same shape is made of it and looked at by the words of the
//! schema. Patterns of texts are not looked at.

use coif_nodes::define::{Type, Value};
use serde_json::{Map, Value as Json, json};

/// The JSON of the same shape.
///
/// # Panics
/// Of text that is no RON.
pub(super) fn json_of(text: &str) -> Json {
    let mut rest = text;
    let json = value(&mut rest);
    assert_eq!(rest.trim(), "", "after the value");
    json
}

/// Steps over space and comments, and gives what comes next.
fn next(rest: &mut &str) -> char {
    loop {
        *rest = rest.trim_start();
        let Some(comment) = rest.strip_prefix("//") else { break };
        *rest = comment.find('\n').map_or("", |end| &comment[end..]);
    }
    rest.chars().next().expect("a value")
}

fn take(rest: &mut &str, wanted: char) -> bool {
    let is = next(rest) == wanted;
    if is {
        *rest = &rest[wanted.len_utf8()..];
    }
    is
}

fn word<'a>(rest: &mut &'a str, of: impl Fn(char) -> bool) -> &'a str {
    let end = rest.find(|c| !of(c)).unwrap_or(rest.len());
    let (word, after) = rest.split_at(end);
    *rest = after;
    word
}

fn value(rest: &mut &str) -> Json {
    match next(rest) {
        '"' => text(rest),
        '[' => list(rest, '[', ']'),
        '(' => brackets(rest),
        '{' => named(rest, '{', '}', |rest| text(rest).as_str().expect("a text").to_owned()),
        c if c.is_ascii_digit() || "+-.".contains(c) => {
            let number = word(rest, |c| c.is_ascii_alphanumeric() || "+-.".contains(c));
            number.parse().unwrap_or_else(|_| panic!("{number} is no number"))
        }
        _ => {
            let name = word(rest, |c| c.is_alphanumeric() || c == '_');
            match name {
                "true" | "false" => json!(name == "true"),
                _ if rest.starts_with('(') => {
                    let mut inner = brackets(rest);
                    if let Some([only]) = inner.as_array().map(Vec::as_slice) {
                        inner = only.clone();
                    }
                    json!({name: inner})
                }
                _ => json!(name),
            }
        }
    }
}

fn text(rest: &mut &str) -> Json {
    let mut end = 1;
    while !rest[end..].starts_with('"') {
        let escaped = usize::from(rest[end..].starts_with('\\'));
        end += escaped;
        end += rest[end..].chars().next().expect("the end of a text").len_utf8();
    }
    let (text, after) = rest.split_at(end + 1);
    *rest = after;
    match coif_graphs::text::read_value(Type::Text, text) {
        Ok(Value::Text(text)) => json!(&*text),
        other => panic!("{other:?}"),
    }
}

fn list(rest: &mut &str, open: char, close: char) -> Json {
    assert!(take(rest, open));
    let mut items = vec![];
    while !take(rest, close) {
        items.push(value(rest));
        take(rest, ',');
    }
    json!(items)
}

/// A tuple, or fields by name.
fn brackets(rest: &mut &str) -> Json {
    let mut ahead = &rest[1..];
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let fields = is_word(next(&mut ahead)) && {
        word(&mut ahead, is_word);
        next(&mut ahead) == ':'
    };
    match fields {
        true => named(rest, '(', ')', |rest| word(rest, is_word).to_owned()),
        false => list(rest, '(', ')'),
    }
}

fn named(rest: &mut &str, open: char, close: char, name: impl Fn(&mut &str) -> String) -> Json {
    assert!(take(rest, open));
    let mut all = Map::new();
    while !take(rest, close) {
        let name = name(rest);
        assert!(take(rest, ':'), "after {name}");
        all.insert(name, value(rest));
        take(rest, ',');
    }
    Json::Object(all)
}

/// Why a schema does not allow this, and where.
pub(super) fn fault(schema: &Json, of: &Json, json: &Json) -> Option<String> {
    if let Some(name) = of["$ref"].as_str() {
        let meant = schema.pointer(name.trim_start_matches('#')).expect("a definition");
        return fault(schema, meant, json).map(|why| format!("{name}: {why}"));
    }
    if let Some(several) = of["oneOf"].as_array() {
        let faults: Vec<_> = several.iter().map(|one| fault(schema, one, json)).collect();
        return match faults.iter().filter(|fault| fault.is_none()).count() {
            1 => None,
            n => Some(format!("{json} is {n} of {}: {faults:?}", several.len())),
        };
    }
    let wrong = of.get("const").is_some_and(|only| only != json)
        || of["enum"].as_array().is_some_and(|words| !words.contains(json))
        || !match of["type"].as_str() {
            None => true,
            Some("boolean") => json.is_boolean(),
            Some("integer") => json.is_i64() || json.is_u64(),
            Some("number") => json.is_number(),
            Some("string") => json.is_string(),
            Some("array") => json.is_array(),
            Some(_) => json.is_object(),
        }
        || json.as_f64().is_some_and(|x| {
            of["minimum"].as_f64().is_some_and(|low| x < low)
                || of["maximum"].as_f64().is_some_and(|high| x > high)
        });
    if wrong {
        return Some(format!("{json} is not of {of}"));
    }
    match json {
        Json::Array(items) => fault_of_items(schema, of, items),
        Json::Object(all) => fault_of_names(schema, of, all),
        _ => None,
    }
}

fn fault_of_items(schema: &Json, of: &Json, items: &[Json]) -> Option<String> {
    let bound = |name: &str, other: usize| of[name].as_u64().map_or(other, |n| n as usize);
    if !(bound("minItems", 0)..=bound("maxItems", usize::MAX)).contains(&items.len()) {
        return Some(format!("{} entries", items.len()));
    }
    let found = of
        .get("contains")
        .is_none_or(|one| items.iter().any(|item| fault(schema, one, item).is_none()));
    if !found {
        return Some("none of the entries is the one that must be".to_owned());
    }
    let first = of["prefixItems"].as_array().map_or(&[][..], Vec::as_slice);
    items.iter().enumerate().find_map(|(n, item)| {
        let of = first.get(n).or(of.get("items"))?;
        fault(schema, of, item).map(|why| format!("{n}: {why}"))
    })
}

fn fault_of_names(schema: &Json, of: &Json, all: &Map<String, Json>) -> Option<String> {
    let words = |of: &Json| -> Vec<String> {
        of.as_array().into_iter().flatten().filter_map(Json::as_str).map(str::to_owned).collect()
    };
    let mut needed = words(&of["required"]);
    needed.extend(all.keys().flat_map(|name| words(&of["dependentRequired"][name])));
    if let Some(name) = needed.iter().find(|name| !all.contains_key(*name)) {
        return Some(format!("no {name}"));
    }
    all.iter().find_map(|(name, value)| {
        let other = &of["additionalProperties"];
        let why = match of["properties"].get(name) {
            Some(of) => fault(schema, of, value),
            None if *other == false => Some("no such name".to_owned()),
            None if other.is_object() => fault(schema, other, value),
            None => None,
        };
        why.map(|why| format!("{name}: {why}"))
    })
}
