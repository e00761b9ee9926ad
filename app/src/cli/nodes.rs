//! `coif nodes`: the manual, printed from the same declarations that make the interface.

use super::examples::example;
use super::{Exit, complain, print};
use clap::Args;
use coif_nodes::data::attributes::DECLARED;
use coif_nodes::define::{Arity, InputDef, NodeDef, Type, Value};
use coif_nodes::formats::export::{ADDED, file_name};
use serde_json::{Value as Json, json};

#[derive(Args)]
pub(crate) struct NodesArgs {
    /// One kind of node; without it, all
    kind: Option<String>,
    /// Print JSON for other tools
    #[arg(long)]
    json: bool,
    /// Print a JSON Schema of documents, as docs/document.md explains it
    #[arg(long, conflicts_with_all = ["json", "kind"])]
    schema: bool,
}

pub(crate) fn run(args: NodesArgs) -> Exit {
    if args.schema {
        return print(&serde_json::to_string_pretty(&super::schema::schema()).unwrap_or_default());
    }
    let chosen: Vec<(&str, &NodeDef)> = coif_nodes::STAGES
        .iter()
        .flat_map(|(stage, nodes)| nodes.iter().map(move |node| (*stage, *node)))
        .filter(|(_, node)| args.kind.as_ref().is_none_or(|kind| node.id == kind))
        .collect();
    if chosen.is_empty() {
        let known: Vec<&str> = coif_nodes::all().map(|n| n.id).collect();
        complain(format!(
            "no node is called {:?}; there are: {}",
            args.kind.unwrap_or_default(),
            known.join(", ")
        ));
        return Exit::Refused;
    }
    if args.json {
        let nodes: Vec<Json> = chosen.iter().map(|(stage, node)| as_json(stage, node)).collect();
        print(&serde_json::to_string_pretty(&nodes).unwrap_or_default())
    } else {
        let pages = print(
            &chosen.iter().map(|(stage, node)| page(stage, node)).collect::<Vec<_>>().join("\n"),
        );
        if args.kind.is_none() { pages.max(print(&attributes())) } else { pages }
    }
}

fn page(stage: &str, node: &NodeDef) -> String {
    let mut text = format!("## {} (`{}`)\n\n{}\n\n", node.label, node.id, node.doc());
    text += &format!("Menu: {stage}. Also found as: {}.\n\n", node.words);
    text += "| input | takes | default | range | |\n|---|---|---|---|---|\n";
    for (group, inputs) in node.groups() {
        if let Some(group) = group {
            text += &format!("| **{}** | | | | |\n", group.name());
        }
        for input in inputs {
            text += &format!(
                "| `{}` | {} | {} | {} | {} |\n",
                input.name,
                takes(input),
                default_of(input).unwrap_or_default(),
                range_of(input),
                cell(&input.doc())
            );
        }
    }
    text += "\n| output | gives | |\n|---|---|---|\n";
    for output in node.outputs {
        text +=
            &format!("| `{}` | {} | {} |\n", output.name, output.ty.name(), cell(&output.doc()));
    }
    if let Some(example) = example(node.id) {
        text += &format!(
            "\nExample, to save as a `.ron` file or paste into an empty graph:\n\n```ron\n{example}```\n"
        );
    }
    text
}

fn takes(input: &InputDef) -> String {
    let ty = match input.ty {
        Type::Choice(words) => {
            let words: Vec<String> =
                words.iter().map(|(word, doc)| format!("`\"{word}\"`: {}", doc.trim())).collect();
            format!("one of {}", words.join(" "))
        }
        ty => ty.name().to_owned(),
    };
    let how = match (input.arity, input.has_default()) {
        (Arity::Optional, _) => ", optional",
        (Arity::Many, _) => ", any number of wires",
        (Arity::One, false) => ", needed",
        (Arity::One, true) => "",
    };
    cell(&format!("{ty}{how}"))
}

fn default_of(input: &InputDef) -> Option<String> {
    let value = input.default()?;
    let unit = match value {
        Value::Float(_) | Value::Int(_) => input.unit.suffix(),
        _ => "",
    };
    Some(format!("`{}`{unit}", coif_graphs::text::write_value(&value)))
}

fn range_of(input: &InputDef) -> String {
    let between = |(lo, hi): (f64, f64)| format!("{lo} to {hi}");
    match (input.hard, input.soft) {
        (Some(hard), Some(soft)) if hard != soft => {
            format!("{} (slider {}){}", between(hard), between(soft), input.unit.suffix())
        }
        (Some(range), _) | (None, Some(range)) => between(range) + input.unit.suffix(),
        (None, None) => String::new(),
    }
}

fn cell(text: &str) -> String {
    text.replace("\n\n", "<br>").replace('\n', " ").replace('|', "\\|")
}

fn attributes() -> String {
    let mut text = "\n## Attributes\n\nWhat curves can carry, by the names that fields use, and the names under which USD and Alembic \
                    hold it. Hair that is made from curves takes over what they carry, attributes of your own too: numbers, vectors \
                    and colours are mixed as the shapes of the curves are, and change along the hair as along them; ids and counts \
                    are those of the nearest. What says how a cluster is shaped and filled stays with clusters.\n\n| attribute | in files | type | |\n|---|---|---|---|\n"
        .to_owned();
    for (name, ty, doc) in DECLARED {
        text += &format!("| `{name}` | `{}` | {ty} | {} |\n", file_name(name), cell(doc.trim()));
    }
    text += "\n## Beside attributes in files\n\nWhat USD and Alembic files hold for readers of grooms, as Epic's \"Alembic for \
             Grooms\" asks: primvars there, GeomParams here. An attribute of the same name goes before.\n\n\
             | in files | type | values | |\n|---|---|---|---|\n";
    for (name, ty, values, doc) in ADDED {
        text += &format!("| `{name}` | {ty} | {values} | {} |\n", cell(doc));
    }
    text
}

fn as_json(stage: &str, node: &NodeDef) -> Json {
    let inputs: Vec<Json> = node
        .groups()
        .flat_map(|(group, inputs)| inputs.iter().map(move |input| (group, input)))
        .map(|(group, input)| {
            let words: Option<Vec<Json>> = match input.ty {
                Type::Choice(words) => {
                    Some(words.iter().map(|(w, d)| json!({"word": w, "doc": d.trim()})).collect())
                }
                _ => None,
            };
            json!({
                "name": input.name,
                "group": group.map(|group| group.name()),
                "old_names": input.old_names,
                "type": input.ty.name(),
                "arity": match input.arity {
                    Arity::One => "one",
                    Arity::Optional => "optional",
                    Arity::Many => "many",
                },
                "default": input.default().map(|d| coif_graphs::text::write_value(&d)),
                "hard": input.hard.map(|(a, b)| [a, b]),
                "soft": input.soft.map(|(a, b)| [a, b]),
                "unit": input.unit.suffix().trim(),
                "words": input.words,
                "choices": words,
                "handle": input.handle.map(|h| format!("{h:?}").to_lowercase()),
                "doc": input.doc(),
            })
        })
        .collect();
    let outputs: Vec<Json> = node
        .outputs
        .iter()
        .map(|o| json!({"name": o.name, "type": o.ty.name(), "doc": o.doc()}))
        .collect();
    json!({
        "id": node.id,
        "version": node.version,
        "label": node.label,
        "stage": stage,
        "words": node.words,
        "doc": node.doc(),
        "inputs": inputs,
        "outputs": outputs,
        "example": example(node.id),
    })
}
