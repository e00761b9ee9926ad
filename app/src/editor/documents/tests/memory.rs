//! What is kept of documents that are gone: nothing but what the evaluator's budget has room for, and that counts pictures and
//! documents too.

use super::*;
use crate::core::room::Room;
use crate::core::state::Select;
use crate::jobs::evaluation::Evaluation;
use coif_graphs::document::Node;
use coif_nodes::data::curves::Tuft;
use coif_nodes::data::scalp::Scalp;
use std::sync::Weak;

/// An editor whose evaluator keeps so many bytes, in a small window; with pictures where something can draw.
fn keeping(bytes: usize) -> Ui {
    let (mut ui, _) = on_empty_head();
    let ctx = ui.ctx.clone();
    let editor = ui.state_mut();
    editor.evaluation = Some(Evaluation::start(bytes, || {}).unwrap());
    editor.state.settings.samples = 1;
    match coif_shaders::Gpu::new(coif_shaders::Precision::Best) {
        Ok(_) => editor.viewport.start(&ctx),
        Err(err) => println!("without pictures: {err}"),
    }
    ui
}

fn rest(ui: &mut Ui) {
    until("all is made and drawn", || {
        ui.step();
        ui.state().is_idle() && ui.state().viewport.is_idle()
    });
    ui.run_steps(3);
}

/// A groom of so many hairs in a file.
fn groom(folder: &Folder, name: &str, hairs: usize) -> PathBuf {
    let text = format!(
        r#"(format: 3, title: "{name}", seed: 0, nodes: {{
            "head": (kind: "head"),
            "guides": (kind: "scatter_guides", inputs: {{ "count": 60, "length": 8 }}, links: {{ "scalp": "head.scalp" }}),
            "hair": (kind: "interpolate", inputs: {{ "by": "count", "count": {hairs}, "points": 12 }},
                links: {{ "guides": "guides.curves", "scalp": "head.scalp" }}),
            "noise": (kind: "noise", links: {{ "curves": "hair.curves" }}),
            "out": (kind: "groom_output", links: {{ "curves": "noise.curves" }}),
        }})"#
    );
    let path = folder.path(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn begin(ui: &mut Ui, groom: &Path) {
    does(ui, DocumentEvent::Open(groom.to_owned()));
    if ui.state().documents.unsaved.is_some() {
        does(ui, DocumentEvent::Unsaved(crate::core::documents::Unsaved::Discard));
    }
    rest(ui);
}

/// What a document has, and what was made of it.
struct Of {
    tufts: Vec<Weak<Tuft>>,
    scalps: Vec<Weak<Scalp>>,
    nodes: Vec<(NodeId, Weak<Node>)>,
}

impl Of {
    fn now(ui: &Ui) -> Self {
        let state = &ui.state().state;
        let shown = state.shown.as_ref().expect("something is shown");
        let nodes = state.document.nodes.iter();
        Self {
            tufts: shown.curves.tufts().iter().map(Arc::downgrade).collect(),
            scalps: shown.scalps.iter().map(Arc::downgrade).collect(),
            nodes: nodes.map(|(id, node)| (id.clone(), Arc::downgrade(node))).collect(),
        }
    }

    /// How much of each is still there.
    fn left(&self) -> [usize; 3] {
        [
            self.tufts.iter().filter(|it| it.strong_count() > 0).count(),
            self.scalps.iter().filter(|it| it.strong_count() > 0).count(),
            self.nodes.iter().filter(|(_, it)| it.strong_count() > 0).count(),
        ]
    }
}

/// Everything that a room or a thread may note of a groom is asked for.
fn use_all_of_it(ui: &mut Ui) {
    let state = &ui.state().state;
    let shown = state.shown.clone().unwrap();
    let hair = shown.curves.tufts()[0].id(0);
    let node = shown.sockets[0].node.clone();
    drop(shown);
    for room in [Room::Spreadsheet, Room::Messages, Room::History, Room::Outliner, Room::Inspector]
    {
        ui.state_mut().apply(Event::Show(room));
        ui.run_steps(2);
    }
    ui.state_mut().apply(Event::Select(Select::Nodes(vec![node])));
    ui.state_mut().apply(Event::Select(Select::Curves([hair].into())));
    ui.state_mut().apply(Event::Trace(hair));
    ui.state_mut().viewport.options.guides = true;
    rest(ui);
    ui.state_mut().apply(Event::WhatMade(hair));
    rest(ui);
    assert!(ui.state().state.made.is_some(), "what made the hair is known");
    edit(ui, Edit::SetSeed(7));
    rest(ui);
    act(ui, "edit.undo");
    rest(ui);
}

#[test]
fn of_a_document_that_is_gone_nothing_is_left_but_what_the_budget_keeps() {
    let mut ui = keeping(0);
    let folder = Folder::new("memory-gone");
    begin(&mut ui, &groom(&folder, "before.ron", 2000));
    use_all_of_it(&mut ui);
    let old = Of::now(&ui);
    assert!(!old.tufts.is_empty() && old.scalps.len() == 1);
    begin(&mut ui, &groom(&folder, "after.ron", 1000));
    assert_eq!(old.left(), [0, 0, 0], "hair, heads and nodes of the groom before");
}

#[test]
fn what_is_kept_for_reuse_gives_way_to_pictures_and_documents() {
    let budget = 24 << 20;
    let mut ui = keeping(budget);
    let folder = Folder::new("memory-kept");
    for hairs in [20_000, 10_000, 20_001] {
        begin(&mut ui, &groom(&folder, &format!("{hairs}.ron"), hairs));
        let editor = ui.state();
        let (kept, of) = editor.evaluation.as_ref().unwrap().evaluator().cache_bytes();
        let pictures = editor.viewport.bytes();
        let documents = editor.state.document.bytes() + editor.state.history.bytes();
        assert!(editor.viewport.fault().is_some() || pictures > 0, "pictures count");
        assert!(of == budget && documents > 0, "{of} {documents}");
        let room = budget.saturating_sub(pictures + documents).max(budget / 4);
        assert!(
            kept <= room,
            "{hairs} hairs: {kept} are kept, {pictures} of pictures, {documents}"
        );
    }
}
