//! The pen on masks in the editor: samples in; strokes, heat, hair and undo steps out.

use super::super::sample::{Device, PenSample as Report, Phase, Tool as End};
use super::super::target::{Fills, of, strokes};
use super::super::tests::{Table, draw_on, head};
use super::target;
use crate::testing::until;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::data::strokes::{Mode, Strokes};
use egui::Pos2;
use glam::Vec3;
use std::sync::Arc;

/// The editor with a tool that paints, seen from above; places are told as on a sheet of 600 by 600, 20 of them a cm.
struct Studio(Table);

impl Studio {
    fn open(document: Document, action: &str) -> Self {
        let mut table = draw_on(document);
        table.editor().act(action);
        table.rest();
        Self(table)
    }
    fn report(&mut self, phase: Phase, at: Pos2, pressure: f32, end: End) {
        self.0.time += 0.008;
        let at = self.0.on_screen(at);
        let report = Report::mouse(self.0.time, phase, at, pressure);
        self.0.editor().pen.devices.push(Report { tool: end, device: Device(9), ..report });
    }
    /// A stroke that is not lifted.
    fn begin(&mut self, places: &[[f32; 2]], pressure: f32, end: End) {
        self.report(Phase::Hover, places[0].into(), 0.0, end);
        self.report(Phase::Down, places[0].into(), pressure, end);
        for at in &places[1..] {
            self.report(Phase::Move, Pos2::from(*at), pressure, end);
        }
        self.0.step();
    }
    fn paint(&mut self, places: &[[f32; 2]], pressure: f32) {
        self.begin(places, pressure, End::Tip);
        self.lift(places[places.len() - 1]);
    }
    fn lift(&mut self, at: [f32; 2]) {
        self.report(Phase::Up, at.into(), 0.0, End::Tip);
        self.0.rest();
    }
    fn node(&mut self) -> Option<NodeId> {
        of(&self.0.editor().state, Fills::Mask)
    }
    fn strokes(&mut self) -> Arc<Strokes> {
        let node = self.node();
        let document = &self.0.editor().state.document;
        node.map_or_else(Arc::default, |id| strokes(document, &id))
    }
    fn modes(&mut self) -> Vec<Mode> {
        let strokes = self.strokes();
        strokes.0.iter().map(|stroke| stroke.brush.as_ref().expect("a brush").mode).collect()
    }
    /// The head under a place of the sheet.
    fn skin(&mut self, at: [f32; 2]) -> Vec3 {
        let at = self.0.on_screen(at.into());
        let editor = self.0.editor();
        let ray = editor.viewport.projection().ray(at);
        let shown = editor.state.shown.clone().expect("a head");
        let scalp = shown.scalp().expect("a head");
        scalp.surface().ray(ray.origin, ray.direction, f32::MAX).expect("the head").point
    }
    /// How hot the head is there, once the heat has been made.
    fn heat(&mut self, at: [f32; 2]) -> f32 {
        let p = self.skin(at);
        self.0.step();
        until("the heat is made", || {
            self.0.step();
            self.0.editor().pen.mask.heat.is_done()
        });
        self.0.editor().pen.mask.heat.near(p)
    }
    fn words(&mut self) -> String {
        let history = &self.0.editor().state.history;
        history.steps().nth(history.done() - 1).expect("a step").words.clone()
    }
    fn set(&mut self, change: impl FnOnce(&mut crate::core::pen::PenSettings)) {
        let mut settings = self.0.editor().state.settings.clone();
        change(&mut settings.pen);
        self.0.editor().apply(crate::core::event::Event::Settings(settings.into()));
    }
}

const LINE: [[f32; 2]; 3] = [[300.0, 300.0], [320.0, 300.0], [340.0, 300.0]];

#[test]
fn the_first_touch_makes_a_mask_in_one_step_and_shows_it_as_heat() {
    let mut studio = Studio::open(head(), "mask.paint");
    let before = studio.0.editor().state.document.clone();
    studio.set(|pen| (pen.brush, pen.strength) = (1.5, 1.0));
    studio.begin(&LINE, 1.0, End::Tip);
    assert!(studio.0.editor().state.gesture, "it is in the document while it is painted");
    assert_eq!(studio.strokes().0.len(), 1);
    studio.lift(LINE[2]);
    assert_eq!(studio.modes(), [Mode::Paint]);
    assert_eq!((studio.0.done(), studio.words().as_str()), (1, "painted mask"));
    // On the line it is 1; 2 cm beside it, beyond the brush, nothing.
    assert!(studio.heat([320.0, 300.0]) > 0.9, "{}", studio.heat([320.0, 300.0]));
    assert_eq!(studio.heat([320.0, 345.0]), 0.0);
    // Wired to the head, and to nothing else.
    let node = studio.node().expect("a node");
    let document = &studio.0.editor().state.document;
    assert_eq!(document.wires(&node, "scalp").len(), 1);
    let socket = target::output(&node);
    assert!(!document.links.iter().any(|(_, from)| from.contains(&socket)));
    // Again on the same node; then both are taken back, and the node with the first.
    studio.paint(&[[260.0, 330.0]], 1.0);
    assert_eq!(studio.strokes().0.len(), 2);
    for _ in 0..2 {
        studio.0.editor().apply(crate::core::event::Event::Undo);
    }
    assert_eq!(studio.0.editor().state.document, before);
}

#[test]
fn pressure_strength_size_and_the_tools_say_what_a_stroke_does() {
    let mut studio = Studio::open(head(), "mask.paint");
    studio.set(|pen| (pen.brush, pen.strength, pen.symmetry) = (1.0, 0.8, true));
    studio.paint(&[[330.0, 300.0]], 0.5);
    // Full in the middle of a dab: strength 0.8 x half pressure. Its twin is on the other side of the head.
    for at in [[330.0, 300.0], [270.0, 300.0]] {
        assert!((studio.heat(at) - 0.4).abs() < 0.06, "{}", studio.heat(at));
    }
    // A mouse has no pressure of its own.
    studio.begin(&[[330.0, 300.0]], 0.1, End::Mouse);
    studio.lift([330.0, 300.0]);
    let last = |studio: &mut Studio| studio.strokes().0.last().expect("a stroke").clone();
    assert_eq!(last(&mut studio).samples[0].pressure, 1.0);
    for (action, radius, strength) in [
        ("pen.brush_larger", 1.25, 0.8),
        ("pen.brush_smaller", 1.0, 0.8),
        ("pen.weaker", 1.0, 0.7),
        ("pen.stronger", 1.0, 0.8),
    ] {
        studio.0.editor().act(action);
        studio.paint(&[[330.0, 320.0]], 1.0);
        let unit = studio.0.editor().state.shown.as_ref().unwrap().scalp().unwrap().frame().unit();
        let brush = last(&mut studio).brush.expect("a brush");
        assert!((brush.radius * unit - radius).abs() < 0.01, "{action}: {}", brush.radius);
        assert!((brush.strength - strength).abs() < 0.001 && brush.mirrored, "{action}");
    }
    studio.0.editor().act("pen.symmetry");
    // The same keys as for strokes; the eraser end erases with any tool.
    studio.0.editor().act("pen.smooth_brush");
    studio.paint(&LINE, 1.0);
    studio.0.editor().act("pen.erase");
    studio.paint(&LINE, 1.0);
    studio.0.editor().act("mask.flood");
    studio.paint(&[[300.0, 300.0]], 1.0);
    studio.begin(&LINE, 1.0, End::Eraser);
    studio.lift(LINE[2]);
    let modes = studio.modes();
    assert_eq!(modes[modes.len() - 4..], [Mode::Smooth, Mode::Erase, Mode::Flood, Mode::Erase]);
    assert!(!last(&mut studio).brush.expect("a brush").mirrored);
    // The whole head has the flood's value, but where it was erased.
    assert!((studio.heat([250.0, 250.0]) - 0.8).abs() < 0.01);
    assert!(studio.heat(LINE[1]) < 0.2);
}

#[test]
fn escape_takes_back_a_touch_and_one_beside_the_head_says_where_to_begin() {
    let mut studio = Studio::open(head(), "mask.paint");
    let before = studio.0.editor().state.document.clone();
    studio.begin(&LINE, 1.0, End::Tip);
    assert_eq!(studio.strokes().0.len(), 1);
    studio.0.harness.key_down(egui::Key::Escape);
    studio.0.step();
    studio.0.harness.key_up(egui::Key::Escape);
    studio.lift(LINE[2]);
    assert_eq!(studio.0.editor().state.document, before);
    assert_eq!(studio.heat(LINE[1]), 0.0, "without a mask nothing is hot");
    studio.paint(&[[20.0, 300.0], [60.0, 300.0]], 1.0);
    assert_eq!((studio.0.editor().state.document == before, studio.0.done()), (true, 0));
    let said = studio.0.editor().pen.said.take().expect("why not").text;
    assert!(said.contains("begin on the skin"), "{said}");
}

#[test]
fn a_closed_stroke_is_an_outline_and_its_inside_is_hot() {
    let mut studio = Studio::open(head(), "mask.paint");
    studio.0.editor().act("mask.hairline");
    studio.set(|pen| pen.strength = 1.0);
    let round: Vec<[f32; 2]> = (0..24)
        .map(|k| {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / 24.0).sin_cos();
            [300.0 + 90.0 * cos, 300.0 + 90.0 * sin]
        })
        .collect();
    studio.paint(&round, 0.3);
    assert!(studio.strokes().0[0].brush.as_ref().expect("a brush").closed);
    assert_eq!(studio.words(), "painted an outline");
    assert!(studio.heat([300.0, 300.0]) > 0.99 && studio.heat([340.0, 340.0]) > 0.99);
    assert_eq!(studio.heat([300.0, 420.0]), 0.0);
}

#[test]
fn by_section_a_stroke_and_a_flood_keep_to_where_they_begin() {
    let mut document = head();
    let head = document.display.clone().expect("the head");
    let id = document.free_id("partings");
    let mut node = document.fresh_node("partings", &id);
    let set =
        |node: &mut coif_graphs::document::Node, name: &str, value: coif_nodes::define::Value| {
            node.inputs.insert(name.to_owned(), coif_graphs::document::Setting::Known(value));
        };
    // The middle parting leads straight through the sheet's middle.
    set(&mut node, "pattern", "straight_back".into());
    set(&mut node, "count", coif_nodes::define::Value::Int(2));
    document.nodes.insert(id.clone(), Arc::new(node));
    document.links.insert(Socket::new(id.clone(), "scalp"), vec![Socket::new(head, "scalp")]);
    document.display = Some(id);
    let mut studio = Studio::open(document, "mask.flood");
    studio.set(|pen| pen.strength = 1.0);
    studio.paint(&[[350.0, 300.0]], 1.0);
    let flood = studio.strokes().0[0].brush.clone().expect("a brush");
    assert!(!flood.section.is_empty());
    assert!(studio.words().starts_with("flooded mask in "));
    assert_eq!((studio.heat([350.0, 300.0]), studio.heat([250.0, 300.0])), (1.0, 0.0));
    // A stroke over both sides erases one alone.
    studio.0.editor().act("mask.erase");
    studio.0.editor().act("mask.by_section");
    studio.paint(&[[350.0, 300.0], [250.0, 300.0]], 1.0);
    assert_eq!(studio.strokes().0[1].brush.as_ref().expect("a brush").section, flood.section);
    assert!(studio.heat([350.0, 300.0]) < 0.1);
}

#[test]
fn a_mask_is_painted_on_the_scalp_of_the_selected_hair_and_never_on_that_of_a_region() {
    let text = r#"(format: 3, nodes: {
        "head": (kind: "head"),
        "chin": (kind: "region", links: {"scalp": "head.scalp"}),
        "a_beard": (kind: "scatter_guides", links: {"scalp": "chin.scalp"}, inputs: {"count": 50}),
        "a_out": (kind: "groom_output", links: {"curves": "a_beard.curves"}),
        "rows": (kind: "partings", links: {"scalp": "head.scalp"}),
        "hair": (kind: "scatter_guides", links: {"scalp": "rows.scalp"}, inputs: {"count": 50}),
        "loose": (kind: "scatter_guides", links: {"scalp": "head.scalp"}, inputs: {"count": 50}),
        "out": (kind: "groom_output", links: {"curves": ["hair.curves", "loose.curves"]}),
    })"#;
    let document = coif_graphs::file::read(text).expect("it reads").document;
    let file = crate::core::state::OpenFile::default();
    let settings = crate::core::settings::Settings::default();
    let mut state = crate::core::state::State::new(document, file, settings, |_| None);
    for (active, expected) in
        [("", "rows"), ("hair", "rows"), ("loose", "head"), ("a_beard", "head"), ("chin", "head")]
    {
        state.selection.active = NodeId::new(active).ok();
        let (id, edits) = target::make(&state).expect("a head");
        let mut with = state.document.clone();
        edits.iter().for_each(|edit| drop(edit.apply(&mut with).expect("it can be made")));
        assert_eq!(with.wires(&id, "scalp")[0].node.as_str(), expected, "{active:?} is selected");
    }
}

#[test]
fn hair_follows_a_thousand_dabs_that_are_wired_to_its_length_and_density() {
    let mut document = head();
    let scalp = Socket::new(document.display.clone().expect("the head"), "scalp");
    let mut add =
        |kind: &str, set: &[(&str, coif_nodes::define::Value)], wires: &[(&str, Socket)]| {
            let id = document.free_id(kind);
            let mut node = document.fresh_node(kind, &id);
            for (name, value) in set {
                let value = coif_graphs::document::Setting::Known(value.clone());
                node.inputs.insert((*name).to_owned(), value);
            }
            document.nodes.insert(id.clone(), Arc::new(node));
            for (to, from) in wires {
                document.links.insert(Socket::new(id.clone(), to), vec![from.clone()]);
            }
            document.display = Some(id.clone());
            id
        };
    let mask = Socket::new(add("paint_mask", &[], &[("scalp", scalp.clone())]), "mask");
    let wires = [("scalp", scalp.clone()), ("length", mask.clone())];
    let guides = Socket::new(add("scatter_guides", &[], &wires), "curves");
    let (on, count) = (("by", "count".into()), ("count", coif_nodes::define::Value::Int(20_000)));
    let wires = [("scalp", scalp), ("guides", guides), ("mask", mask)];
    let hair = add("interpolate", &[on, count], &wires);
    let mut studio = Studio::open(document, "mask.paint");
    // To and fro over the crown, so that each sample says something.
    for row in 0..25 {
        let at =
            |k: usize| [230.0 + 3.5 * k as f32, 210.0 + 7.0 * row as f32 + 5.0 * (k % 2) as f32];
        let places: Vec<[f32; 2]> = (0..40).map(at).collect();
        studio.paint(&places, 1.0);
    }
    let strokes = studio.strokes();
    let dabs: usize = strokes.0.iter().map(|stroke| stroke.samples.len()).sum();
    assert!(dabs >= 1000, "{dabs}");
    let count = |studio: &mut Studio| {
        let shown = studio.0.editor().state.shown.clone().expect("hair");
        shown.curves.curve_count()
    };
    // Hair where it is painted, and nowhere else.
    let roots = studio.0.editor().state.shown.clone().expect("hair").curves.clone();
    let crown = studio.skin([300.0, 300.0]);
    assert!(count(&mut studio) > 1000);
    assert!(roots.each().all(|(tuft, i)| tuft.curve(i)[0].distance(crown) < 8.0));
    // One more sample, as a preview is made of it.
    studio.begin(&[[300.0, 250.0], [301.0, 262.0]], 1.0, End::Tip);
    let whole = count(&mut studio);
    for k in 0..8 {
        studio.report(
            Phase::Move,
            Pos2::new(300.0 + k as f32, 270.0 + 4.0 * k as f32),
            1.0,
            End::Tip,
        );
        let revision = studio.0.editor().state.revision;
        until("a preview follows the pen", || {
            studio.0.step();
            let shown = studio.0.editor().state.shown.as_ref();
            shown.is_some_and(|shown| shown.revision > revision && !shown.is_final())
        });
        let made = count(&mut studio);
        assert!(made < whole / 2, "{made} hairs of a preview, {whole} in all");
    }
    studio.lift([310.0, 300.0]);
    // Twice the hair changes no dab.
    let before = studio.strokes();
    let (node, twice) = (hair, coif_nodes::define::Value::Int(40_000));
    let setting = coif_graphs::document::Setting::Known(twice);
    let edit =
        coif_graphs::document::edit::Edit::SetInput { node, input: "count".to_owned(), setting };
    let few = count(&mut studio);
    studio.0.editor().apply(crate::core::event::Event::Edit(edit));
    studio.0.rest();
    assert!(count(&mut studio) as f32 > 1.9 * few as f32);
    assert_eq!(studio.strokes(), before);
}
