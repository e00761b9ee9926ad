//! The manual's examples: every kind of node has one, it is evaluated without a warning, and hair is other hair where the
//! node is bypassed.

use coif_graphs::document::graph::check;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_graphs::file;
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::content_hash;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::curves::Curves;
use coif_nodes::define::{NodeDef, Type, Value};
use coif_nodes::eval::Quality;
use coif_tests::{Folder, repository};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// What evaluates, and beside which files.
struct Bench {
    evaluator: Evaluator,
    files: DiskFiles,
}

impl Bench {
    /// The hair of a graph's one output, and what its nodes warned of.
    #[track_caller]
    fn hair(&self, kind: &str, document: &Document) -> (Curves, Vec<String>) {
        let problems = check(document);
        assert!(problems.is_empty(), "{kind}: {problems:?}");
        let outputs = document.nodes.iter().filter(|(_, node)| node.kind == "groom_output");
        let targets: Vec<Socket> =
            outputs.map(|(id, _)| Socket::new(id.clone(), "curves")).collect();
        assert_eq!(targets.len(), 1, "{kind}");
        let plan = plan(document, &targets, Quality::Final, &self.files);
        let plan = plan.unwrap_or_else(|err| panic!("{kind}: {err:?}"));
        let ran = self.evaluator.run(&plan, OnFailure::Stop, &CancelToken::default(), &Quiet);
        let messages = ran.nodes.iter().flat_map(|node| &node.messages);
        let warnings = messages.filter(|message| message.warning).map(|m| m.text.clone());
        let warnings = warnings.collect();
        match ran.targets.into_iter().next().flatten() {
            Some(Value::Curves(curves)) => (curves, warnings),
            other => panic!("{kind}: {other:?}: {:?}", ran.nodes),
        }
    }
}

/// The example of each kind, as the manual has it.
fn examples() -> BTreeMap<String, String> {
    let manual = std::fs::read_to_string(repository().join("docs/nodes.md")).expect("the manual");
    let nodes = manual.split("\n## ").filter_map(|page| {
        let kind = page.lines().next()?.split('`').nth(1)?;
        Some((kind.to_owned(), page.split("```ron\n").nth(1)?.split("```").next()?.to_owned()))
    });
    let first = manual.strip_prefix("## ").expect("the manual begins with a node");
    let kind = first.split('`').nth(1).expect("its kind").to_owned();
    let text = first.split("```ron\n").nth(1).and_then(|rest| rest.split("```").next());
    nodes.chain(text.map(|text| (kind, text.to_owned()))).collect()
}

/// A grey picture for the example that reads one.
fn write_density(file: &Path) {
    let file = std::fs::File::create(file).expect("a file");
    let mut encoder = png::Encoder::new(file, 16, 16);
    encoder.set_color(png::ColorType::Grayscale);
    let pixels: Vec<u8> = (0..=255).collect();
    encoder.write_header().and_then(|mut w| w.write_image_data(&pixels)).expect("a picture");
}

/// Whether curves come in by wire and go out first, so that the node can be bypassed.
fn can_be_bypassed(document: &Document, id: &NodeId, def: &NodeDef) -> bool {
    let wired = |name: &str| document.links.contains_key(&Socket::new(id.clone(), name));
    let takes = def.inputs.iter().any(|input| input.ty == Type::Curves && wired(input.name));
    takes && def.outputs.first().is_some_and(|out| out.ty == Type::Curves)
}

#[test]
fn the_manual_has_an_example_of_every_node_in_which_the_node_does_something() {
    let examples = examples();
    let folder = Folder::new("manual-examples");
    write_density(&folder.path("density.png"));
    let evaluator = Evaluator::new(2, 256 << 20).expect("threads");
    let bench = Bench { evaluator, files: DiskFiles::new(folder.path("")) };
    for def in coif_nodes::all() {
        let kind = def.id;
        let text = examples.get(kind).unwrap_or_else(|| panic!("{kind} has no example"));
        let loaded = file::read(text).unwrap_or_else(|err| panic!("{kind}: {err}"));
        let mut document = loaded.document;
        let found = document.nodes.iter().find(|(_, node)| node.kind == kind);
        let id: NodeId = found.map(|(id, _)| id.clone()).expect("the node is in its example");
        let (hair, warnings) = bench.hair(kind, &document);
        assert!(warnings.is_empty(), "{kind}: {warnings:?}");
        assert!(hair.curve_count() > 0, "{kind} makes nothing");
        if kind == "groom_output" || !can_be_bypassed(&document, &id, def) {
            continue;
        }
        let node = document.nodes.get_mut(&id).expect("the node");
        Arc::make_mut(node).bypass = true;
        let (without, _) = bench.hair(kind, &document);
        assert_ne!(content_hash(&hair), content_hash(&without), "{kind} changes nothing");
    }
}
