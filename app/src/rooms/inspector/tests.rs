//! The inspector under hands that click, drag and type, without a screen.

use super::*;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::widgets::text::spoken;
use crate::work::count;
use coif_graphs::document::{Document, Socket};
use coif_nodes::data::field::Field;
use coif_nodes::data::ramp::Ramp;
use coif_nodes::data::shapes::{ShapeList, Tier, TurnProfile};
use coif_nodes::define::{Arity, Value};
use egui::{Key, Modifiers, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

/// An inspector before the editor's real state.
pub(super) struct Bench {
    pub(super) editor: Editor,
    inspector: Inspector,
    events: Vec<Event>,
}

pub(super) type Hands = Harness<'static, Bench>;

pub(super) fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

/// The inspector on a document with these nodes selected, the last one active.
pub(super) fn hands(document: Document, nodes: &[&str], size: (f32, f32)) -> Hands {
    let editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
    // Every input is found, also those of groups that are closed at first.
    let inspector = Inspector { groups: [(Group::Detail, true)].into(), ..Inspector::default() };
    let bench = Bench { editor, inspector, events: vec![] };
    let mut hands =
        Harness::builder().with_size(vec2(size.0, size.1)).with_step_dt(0.02).build_ui_state(
            |ui, bench: &mut Bench| {
                theme::apply(ui.ctx(), egui::Theme::Dark, false);
                let mut out = vec![];
                bench.inspector.ui(&bench.editor.state, ui, &mut out);
                for event in out {
                    bench.events.push(event.clone());
                    bench.editor.apply(event);
                }
            },
            bench,
        );
    let nodes = nodes.iter().map(|name| id(name)).collect();
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(nodes)));
    hands.run_steps(3);
    hands
}

/// A document of fresh nodes: (id, kind).
pub(super) fn nodes(kinds: &[(&str, &str)]) -> Document {
    let mut document = Document::default();
    for (name, kind) in kinds {
        let node = document.fresh_node(kind, &id(name));
        document.nodes.insert(id(name), node.into());
    }
    document
}

fn value(hands: &Hands, node: &str, input: &str) -> Option<Value> {
    match hands.state().editor.state.document.node(node)?.inputs.get(input)? {
        Setting::Known(value) => Some(value.clone()),
        Setting::Raw(_) => None,
    }
}

fn number(hands: &Hands, node: &str, input: &str) -> Option<f32> {
    match value(hands, node, input)? {
        Value::Float(x) => Some(x),
        Value::Int(x) => Some(x as f32),
        other => panic!("{other:?}"),
    }
}

fn done(hands: &Hands) -> usize {
    hands.state().editor.state.history.done()
}

fn drag(hands: &mut Hands, from: Pos2, by: egui::Vec2, modifiers: Modifiers) {
    hands.hover_at(from);
    hands.event(egui::Event::ModifiersChanged(modifiers));
    hands.drag_at(from);
    hands.run_steps(1);
    for i in 1..=8 {
        hands.hover_at(from + by * (i as f32 / 8.0));
        hands.run_steps(1);
    }
    hands.drop_at(from + by);
    hands.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    hands.run_steps(2);
}

fn typed(hands: &mut Hands, label: &str, text: &str) {
    hands.get_by_label(label).click();
    hands.run_steps(2);
    hands.key_press_modifiers(Modifiers::COMMAND, Key::A);
    hands.run_steps(1);
    hands.event(egui::Event::Text(text.to_owned()));
    hands.run_steps(1);
    hands.key_press(Key::Enter);
    hands.run_steps(3);
}

#[test]
fn what_counts_for_nothing_is_grey() {
    let grey = |strands: i64, input: &str| {
        let mut document = nodes(&[("braid", "lissajous_braid")]);
        let node = document.nodes.get_mut(&id("braid")).unwrap();
        std::sync::Arc::make_mut(node)
            .inputs
            .insert("strands".into(), Setting::Known(Value::Int(strands)));
        let hands = hands(document, &["braid"], (420.0, 3000.0));
        let name = spoken(input);
        let found: Vec<_> = hands.query_all_by_label(&name).collect();
        assert!(!found.is_empty(), "{input}");
        found.iter().any(|widget| widget.accesskit_node().is_disabled())
    };
    for (strands, input, idle) in
        [(3, "crossing", false), (4, "crossing", true), (3, "stitches", true), (3, "width", false)]
    {
        assert_eq!(grey(strands, input), idle, "{strands} strands: {input}");
    }
}

#[test]
fn every_input_of_every_kind_has_a_widget() {
    let mut widgets = 0;
    for def in coif_nodes::all() {
        let hands = hands(nodes(&[("a", def.id)]), &["a"], (380.0, 3000.0));
        let mut wires = 0;
        for input in def.inputs {
            let name = spoken(input.name);
            let label = match input.ty {
                Type::Curves | Type::Scalp => {
                    wires += 1;
                    continue;
                }
                Type::Vec3 => format!("{name} x"),
                Type::Shapes => format!("{name}: choose"),
                Type::Strokes => format!("{name}: draw"),
                Type::Gestures => format!("{name}: clear"),
                _ => name.clone(),
            };
            let found = hands.query_all_by_label(&label).count();
            let nested = hands.query_all_by_label_contains(&format!("{name} ")).count();
            assert!(found + nested > 0, "{}: {label}", def.id);
            assert_eq!(hands.query_all_by_label(&format!("{name} as socket")).count(), 1);
            widgets += 1;
        }
        let unwired = hands.query_all_by_label_contains("Not connected").count();
        assert_eq!(unwired, wires, "{}", def.id);
        let wired = |i: &&coif_nodes::define::InputDef| matches!(i.ty, Type::Curves | Type::Scalp);
        let needs = def.inputs.iter().filter(wired);
        let needs = needs.filter(|i| !i.has_default() && i.arity == Arity::One);
        let said = hands.query_all_by_label_contains("wire it on the canvas").count();
        assert_eq!(said, needs.count(), "{}", def.id);
    }
    assert!(widgets > 150, "{widgets}");
}

#[test]
fn a_drag_is_one_step_and_gives_the_right_value() {
    let mut hands = hands(nodes(&[("a", "scatter_guides")]), &["a"], (380.0, 1200.0));
    // Length: slider 0.5 to 40 cm.
    let field = hands.get_by_label("Length").rect();
    drag(&mut hands, field.center(), vec2(field.width() / 4.0, 0.0), Modifiers::NONE);
    let x = number(&hands, "a", "length").unwrap();
    assert!((x - (6.0 + 39.5 / 4.0)).abs() < 0.11, "{x}");
    assert_eq!(done(&hands), 1);
    let begun = hands.state().events.iter().filter(|e| matches!(e, Event::Begin(_))).count();
    let ended = hands.state().events.iter().filter(|e| matches!(e, Event::End)).count();
    assert_eq!((begun, ended), (1, 1));
    // Fine: a tenth of it, on a finer grid.
    let before = x;
    drag(&mut hands, field.center(), vec2(field.width() / 4.0, 0.0), Modifiers::SHIFT);
    let fine = number(&hands, "a", "length").unwrap() - before;
    assert!((fine - 39.5 / 40.0).abs() < 0.011, "{fine}");
    assert_eq!(done(&hands), 2);
    // It stops at the slider's end.
    drag(&mut hands, field.center(), vec2(900.0, 0.0), Modifiers::NONE);
    assert_eq!(number(&hands, "a", "length"), Some(40.0));
    hands.state_mut().editor.apply(Event::Undo);
    hands.state_mut().editor.apply(Event::Undo);
    hands.state_mut().editor.apply(Event::Undo);
    assert_eq!(number(&hands, "a", "length"), None);
}

#[test]
fn typing_takes_units_arithmetic_and_limits() {
    let mut hands = hands(nodes(&[("a", "scatter_guides")]), &["a"], (380.0, 1200.0));
    for (text, want) in [
        ("12", 12.0),
        ("25mm", 2.5),
        ("2in", 5.08),
        ("*=2", 10.16),
        ("+=1 - 6mm", 10.56),
        ("1/4", 0.25),
        ("(1+2)*2", 6.0),
    ] {
        typed(&mut hands, "Length", text);
        let x = number(&hands, "a", "length").unwrap();
        assert!((x - want).abs() < 1e-4, "{text}: {x}");
    }
    assert_eq!(done(&hands), 7);
    typed(&mut hands, "Length", "900");
    assert_eq!(number(&hands, "a", "length"), Some(300.0));
    hands.run_steps(2);
    hands.get_by_label_contains("900 cm is above 300 cm, which is used");
    typed(&mut hands, "Length", "long");
    assert_eq!(number(&hands, "a", "length"), Some(300.0));
    hands.run_steps(2);
    hands.get_by_label_contains("long is no number");
    assert_eq!(done(&hands), 8);
    // Escape leaves it as it was.
    hands.get_by_label("Length").click();
    hands.run_steps(2);
    hands.event(egui::Event::Text("3".to_owned()));
    hands.run_steps(1);
    hands.key_press(Key::Escape);
    hands.run_steps(2);
    assert_eq!(number(&hands, "a", "length"), Some(300.0));
    // Leaving by a click elsewhere counts.
    hands.get_by_label("Length").click();
    hands.run_steps(2);
    hands.key_press_modifiers(Modifiers::COMMAND, Key::A);
    hands.event(egui::Event::Text("7".to_owned()));
    hands.run_steps(1);
    hands.get_by_label("Lie").click();
    hands.run_steps(3);
    assert_eq!(number(&hands, "a", "length"), Some(7.0));
}

#[test]
fn keys_nudge_in_one_step() {
    let mut hands = hands(nodes(&[("a", "scatter_guides")]), &["a"], (380.0, 1200.0));
    hands.get_by_label("Length").click();
    hands.run_steps(2);
    for _ in 0..3 {
        hands.key_press(Key::ArrowUp);
        hands.run_steps(1);
    }
    hands.key_press_modifiers(Modifiers::COMMAND, Key::ArrowDown);
    hands.run_steps(2);
    let x = number(&hands, "a", "length").unwrap();
    assert!((x - 5.3).abs() < 1e-4, "{x}");
    assert!(hands.state().events.iter().all(|e| !matches!(e, Event::Edit(_))));
}

#[test]
fn several_nodes_are_edited_in_one_step() {
    let kinds = [("a", "scatter_guides"), ("b", "scatter_guides"), ("c", "resample")];
    let mut hands = hands(nodes(&kinds), &["b", "c", "a"], (380.0, 1200.0));
    typed(&mut hands, "Length", "4");
    assert_eq!(number(&hands, "a", "length"), Some(4.0));
    assert_eq!(number(&hands, "b", "length"), Some(4.0));
    assert_eq!(done(&hands), 1);
    typed(&mut hands, "Length", "*=2");
    assert_eq!(number(&hands, "b", "length"), Some(8.0));
    let field = hands.get_by_label("Length").rect();
    drag(&mut hands, field.center(), vec2(30.0, 0.0), Modifiers::NONE);
    assert_eq!(done(&hands), 3);
    assert_eq!(number(&hands, "a", "length"), number(&hands, "b", "length"));
    hands.get_by_label("2 of 3 selected nodes are of this kind: they are edited at once.");
}

#[test]
fn resets_by_button_by_alt_click_and_all_at_once() {
    let mut hands = hands(nodes(&[("a", "scatter_guides")]), &["a"], (380.0, 1200.0));
    typed(&mut hands, "Length", "4");
    hands.get_by_label("Length: reset").click();
    hands.run_steps(3);
    assert_eq!(number(&hands, "a", "length"), None);
    typed(&mut hands, "Length", "4");
    typed(&mut hands, "Lie", "40");
    hands.get_by_label("Length").click_modifiers(Modifiers::ALT);
    hands.run_steps(3);
    assert_eq!(number(&hands, "a", "length"), None);
    hands.get_by_label("More about the node").click();
    hands.run_steps(3);
    hands.get_by_label("Reset all inputs").click();
    hands.run_steps(3);
    assert!(hands.state().editor.state.document.node("a").unwrap().inputs.is_empty());
}

#[test]
fn switches_choices_colours_and_texts_are_edited() {
    let kinds = [("a", "scatter_guides"), ("b", "set_colour"), ("c", "groom_output")];
    let mut hands = hands(nodes(&kinds), &["a"], (380.0, 1200.0));
    let was = number(&hands, "a", "seed");
    hands.get_by_label("New seed").click();
    hands.run_steps(3);
    assert_ne!(number(&hands, "a", "seed"), was);
    hands.get_by_label("Scale with head").click();
    hands.run_steps(3);
    assert!(matches!(value(&hands, "a", "scale_with_head"), Some(Value::Bool(false))));
    hands.get_by_label("Flow").click();
    hands.run_steps(3);
    let other = match coif_nodes::by_id("scatter_guides").unwrap().input("flow").unwrap().1.ty {
        Type::Choice(words) => words[1].0,
        _ => panic!(),
    };
    hands.get_by_label(&other.replace('_', " ")).click();
    hands.run_steps(3);
    assert!(matches!(value(&hands, "a", "flow"), Some(Value::Text(word)) if &*word == other));
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("b")])));
    hands.run_steps(3);
    typed(&mut hands, "Root green", "0.25");
    assert!(matches!(value(&hands, "b", "root"), Some(Value::Vec3(v)) if v.y == 0.25));
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("c")])));
    hands.run_steps(3);
    typed(&mut hands, "Name", "Fringe");
    assert!(matches!(value(&hands, "c", "name"), Some(Value::Text(word)) if &*word == "Fringe"));
    typed(&mut hands, "Node name", "All hair");
    let label = hands.state().editor.state.document.node("c").unwrap().label.clone();
    assert_eq!(label.as_deref(), Some("All hair"));
    assert_eq!(done(&hands), 6);
}

fn ramp(hands: &Hands) -> Ramp {
    match value(hands, "a", "profile") {
        Some(Value::Ramp(ramp)) => (*ramp).clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn stops_of_ramps_are_added_moved_and_removed() {
    // Set width has a profile from 0 to 1, straight.
    let mut hands = hands(nodes(&[("a", "set_width")]), &["a"], (380.0, 900.0));
    let plot = hands.get_by_label("Profile").rect();
    let inner = ramp::plotted(plot);
    let at = |x: f32, y: f32| {
        Pos2::new(egui::lerp(inner.x_range(), x), egui::lerp(inner.bottom()..=inner.top(), y))
    };
    // Double click adds.
    for _ in 0..2 {
        hands.hover_at(at(0.5, 0.9));
        hands.drag_at(at(0.5, 0.9));
        hands.drop_at(at(0.5, 0.9));
    }
    hands.run_steps(3);
    let stops = ramp(&hands).stops().to_vec();
    assert_eq!(stops.len(), 3);
    assert!((stops[1].0 - 0.5).abs() < 0.02 && (stops[1].1 - 0.9).abs() < 0.02, "{stops:?}");
    // A drag moves it, as one step; Shift the value only.
    drag(&mut hands, at(0.5, 0.9), at(0.3, 0.2) - at(0.5, 0.9), Modifiers::NONE);
    let (x, y) = ramp(&hands).stops()[1];
    assert!((x - 0.3).abs() < 0.02 && (y - 0.2).abs() < 0.02, "{x} {y}");
    assert_eq!(done(&hands), 2);
    drag(&mut hands, at(x, y), at(0.8, 0.5) - at(x, y), Modifiers::SHIFT);
    let (x2, y2) = ramp(&hands).stops()[1];
    assert!(x2 == x && (y2 - 0.5).abs() < 0.02, "{x2} {y2}");
    drag(&mut hands, at(x2, y2), vec2(50.0, 0.0), Modifiers::CTRL);
    let fine = ramp(&hands).stops()[1].0 - x2;
    assert!((fine - 5.0 / inner.width()).abs() < 0.003, "{fine}");
    // The numbers of the selected stop.
    typed(&mut hands, "Profile value", "0.75");
    assert_eq!(ramp(&hands).stops()[1].1, 0.75);
    // Delete removes it.
    let (x, y) = ramp(&hands).stops()[1];
    hands.hover_at(at(x, y));
    hands.drag_at(at(x, y));
    hands.drop_at(at(x, y));
    hands.run_steps(3);
    hands.key_press(Key::Delete);
    hands.run_steps(3);
    assert_eq!(ramp(&hands).stops().len(), 2);
    // Text is pasted into the plot that has the keyboard; values stay in range.
    hands.event(egui::Event::Paste("Linear([(0.0, 0.5), (0.5, 0.25), (1.0, 1.0)])".into()));
    hands.run_steps(3);
    assert_eq!(ramp(&hands).at(0.5), 0.25);
    hands.event(egui::Event::Paste("Linear([(0, 0), (1, 1)])".into()));
    hands.event(egui::Event::Paste("no ramp".into()));
    hands.run_steps(3);
    assert_eq!(ramp(&hands).stops().len(), 2);
    // Blending and shapes.
    hands.get_by_label("Profile blending").click();
    hands.run_steps(3);
    hands.get_by_label("Smooth").click();
    hands.run_steps(3);
    assert_eq!(ramp(&hands).blend, coif_nodes::data::ramp::Blend::Smooth);
    hands.get_by_label("Profile shape").click();
    hands.run_steps(3);
    hands.get_by_label("Flip").click();
    hands.run_steps(3);
    assert_eq!(ramp(&hands).at(0.0), 1.0);
}

#[test]
fn fields_switch_their_source_and_keep_their_number() {
    let mut hands = hands(nodes(&[("a", "scatter_guides")]), &["a"], (380.0, 1500.0));
    let switch = |hands: &mut Hands, to: &str| {
        hands.get_by_label("Length source").click();
        hands.run_steps(3);
        hands.get_by_label(to).click();
        hands.run_steps(3);
    };
    switch(&mut hands, "Ramp");
    let Some(Value::Field(field)) = value(&hands, "a", "length") else { panic!() };
    let Field::Ramp(ramp) = &*field else { panic!("{field:?}") };
    assert_eq!((ramp.at(0.0), ramp.at(1.0)), (6.0, 6.0));
    switch(&mut hands, "Attribute");
    typed(&mut hands, "Length attribute", "radius");
    let Some(Value::Field(field)) = value(&hands, "a", "length") else { panic!() };
    assert_eq!(*field, Field::Attribute("radius".into()));
    switch(&mut hands, "Product");
    typed(&mut hands, "Length factor 2", "0.5");
    let Some(Value::Field(field)) = value(&hands, "a", "length") else { panic!() };
    let parts = vec![Field::Attribute("radius".into()), Field::Constant(0.5)];
    assert_eq!(*field, Field::Product(parts));
    switch(&mut hands, "Number");
    assert_eq!(number(&hands, "a", "length"), Some(0.5));
}

#[test]
fn shapes_are_added_edited_ordered_and_removed() {
    let mut hands = hands(nodes(&[("a", "shape_list_curl")]), &["a"], (420.0, 2400.0));
    let list = |hands: &Hands| match value(hands, "a", "shapes") {
        Some(Value::Shapes(list)) => list.0.clone(),
        other => panic!("{other:?}"),
    };
    hands.get_by_label("Shapes: choose").click();
    hands.run_steps(3);
    assert_eq!(list(&hands), [(Tier::A, TurnProfile::Circle)]);
    hands.get_by_label("Shapes: add a shape").click();
    hands.run_steps(3);
    typed(&mut hands, "Shapes 2 ratio", "0.4");
    assert_eq!(list(&hands)[1], (Tier::B, TurnProfile::Ellipse(0.4)));
    hands.get_by_label("Shapes 2 shape").click();
    hands.run_steps(3);
    hands.get_by_label("Drawn").click();
    hands.run_steps(3);
    assert!(matches!(&list(&hands)[1].1, TurnProfile::Custom(points) if points.len() == 8));
    let drawing = hands.get_by_label("Shapes 2 drawing").rect();
    let right = drawing.center() + vec2(0.42 * drawing.height(), 0.0);
    drag(&mut hands, right, vec2(-20.0, 0.0), Modifiers::NONE);
    let TurnProfile::Custom(points) = &list(&hands)[1].1 else { panic!() };
    assert!(points[0].x < 0.8, "{points:?}");
    let more = |hands: &mut Hands, what: &str| {
        hands.get_by_label("Shapes 2: more").click();
        hands.run_steps(3);
        hands.get_by_label(what).click();
        hands.run_steps(3);
    };
    more(&mut hands, "Move up");
    assert!(matches!(list(&hands)[1].1, TurnProfile::Circle));
    more(&mut hands, "Remove");
    // The list has no shape of tier A now: the document refuses it, and says so.
    hands.run_steps(2);
    let said = |hands: &Hands| {
        let mut all = hands.query_all_by_label_contains("at least one shape in tier A");
        all.next().is_some()
    };
    assert!(said(&hands));
    assert_eq!(list(&hands).len(), 2);
}

#[test]
fn wires_lead_to_their_node_and_can_be_cut() {
    let mut document = nodes(&[("a", "scatter_guides"), ("b", "resample"), ("c", "merge")]);
    let wire = |document: &mut Document, to: &str| {
        let to = Socket::new(id(to), "curves");
        document.links.entry(to).or_default().push(Socket::new(id("a"), "curves"));
    };
    wire(&mut document, "b");
    wire(&mut document, "c");
    wire(&mut document, "c");
    let mut hands = hands(document, &["c"], (380.0, 900.0));
    hands.get_by_label_contains("Curves 2: disconnect").click();
    hands.run_steps(3);
    // A click on the cross alone costs no wire: it asks.
    assert_eq!(hands.state().editor.state.document.wires(&id("c"), "curves").len(), 2);
    hands.get_by_label_contains("Disconnect from").click();
    hands.run_steps(3);
    let wires = |hands: &Hands, to: &str| {
        hands.state().editor.state.document.wires(&id(to), "curves").len()
    };
    assert_eq!((wires(&hands, "c"), wires(&hands, "b")), (1, 1));
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("b")])));
    hands.run_steps(3);
    hands.get_by_label_contains("Curves: go to").click();
    hands.run_steps(3);
    assert_eq!(hands.state().editor.state.active(), Some(&id("a")));
    hands.get_by_label("Length as socket").click();
    hands.run_steps(3);
    let socket = Socket::new(id("a"), "length");
    assert!(hands.state().editor.state.exposed.contains(&socket));
}

#[test]
fn the_menu_of_a_number_lists_painted_masks_and_wires_them() {
    let document = nodes(&[("fringe", "paint_mask"), ("later", "texture_mask"), ("a", "noise")]);
    let mut hands = hands(document, &["a"], (380.0, 900.0));
    hands.get_by_label("Amplitude source").click();
    hands.run_steps(3);
    assert!(hands.query_by_label("Mask: Texture mask").is_some());
    hands.get_by_label("Mask: Paint mask").click();
    hands.run_steps(3);
    let document = &hands.state().editor.state.document;
    assert_eq!(document.wires(&id("a"), "amplitude"), [Socket::new(id("fringe"), "mask")]);
    assert_eq!(done(&hands), 1);
}

#[test]
fn colours_of_hair_have_their_names_on_them_and_presets_of_curls_begin_with_the_type() {
    let document = nodes(&[("colour", "hair_colour"), ("curl", "shape_list_curl")]);
    let mut hands = hands(document, &["colour"], (380.0, 900.0));
    let texts = |hands: &Hands| -> Vec<String> {
        let shapes = hands.output().shapes.iter();
        let text = |shape: &egui::epaint::ClippedShape| match &shape.shape {
            egui::Shape::Text(text) => Some(text.galley.text().to_owned()),
            _ => None,
        };
        shapes.filter_map(text).collect()
    };
    for name in ["Black", "Copper", "Light blond", "White"] {
        assert!(texts(&hands).iter().any(|text| text == name), "{name}: {:?}", texts(&hands));
    }
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("curl")])));
    hands.run_steps(3);
    hands.get_by_label("Preset").click();
    hands.run_steps(3);
    let listed = texts(&hands);
    assert!(listed.iter().any(|text| text.starts_with("3b: curls 15 mm")), "{listed:?}");
}

#[test]
fn what_is_unknown_is_shown_and_kept() {
    let mut document = nodes(&[("a", "resample"), ("b", "resample")]);
    let node = Arc::make_mut(document.nodes.get_mut(&id("a")).unwrap());
    node.inputs.insert("count".into(), Setting::Raw("Later(3)".into()));
    node.inputs.insert("gone".into(), Setting::Raw("Gone(1, 2)".into()));
    Arc::make_mut(document.nodes.get_mut(&id("b")).unwrap()).kind = "from_the_future".into();
    let before = document.clone();
    let mut hands = hands(document, &["a"], (380.0, 900.0));
    hands.get_by_label("Later(3)");
    hands.get_by_label("Gone(1, 2)");
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("b")])));
    hands.run_steps(3);
    hands.get_by_label_contains("This version has no node");
    assert_eq!(hands.state().editor.state.document, before);
}

#[test]
fn odd_values_are_shown_without_harm() {
    let odd = [
        ("length", Value::Float(f32::MAX)),
        ("lie", Value::from(Field::Product(vec![]))),
        (
            "radius",
            Value::from(Field::Product(vec![Field::Product(vec![Field::Mask(String::new())])])),
        ),
        ("mask", Value::from(Field::Ramp(Ramp::constant(1e30)))),
        ("seed", Value::Int(i64::MIN)),
        ("count", Value::Int(i64::MAX)),
        ("flow", Value::Text("nowhere".into())),
        ("scale_with_head", Value::Float(2.0)),
    ];
    let mut document = nodes(&[("a", "scatter_guides"), ("b", "shape_list_curl")]);
    let node = Arc::make_mut(document.nodes.get_mut(&id("a")).unwrap());
    node.inputs = odd.into_iter().map(|(k, v)| (k.to_owned(), Setting::Known(v))).collect();
    let node = Arc::make_mut(document.nodes.get_mut(&id("b")).unwrap());
    let list =
        ShapeList(vec![(Tier::C, TurnProfile::Custom(vec![])), (Tier::A, TurnProfile::Polygon(0))]);
    node.inputs.insert("shapes".into(), Setting::Known(list.into()));
    for size in [(380.0, 1200.0), (90.0, 300.0), (1.0, 1.0)] {
        hands(document.clone(), &["a"], size);
        hands(document.clone(), &["b"], size);
        hands(document.clone(), &[], size);
    }
}

#[test]
fn the_filter_finds_inputs_by_name_and_by_words_of_the_trade() {
    let mut hands = hands(nodes(&[("a", "shape_list_curl")]), &["a"], (380.0, 1500.0));
    hands.get_by_label("Filter inputs").click();
    hands.run_steps(2);
    hands.event(egui::Event::Text("wavelength".to_owned()));
    hands.run_steps(3);
    hands.get_by_label("Pitch source");
    assert_eq!(hands.query_all_by_label("Diameter source").count(), 0);
}

#[test]
fn a_gesture_that_is_taken_back_under_the_hand_stays_so() {
    let mut hands = hands(nodes(&[("a", "scatter_guides")]), &["a"], (380.0, 1200.0));
    let at = hands.get_by_label("Length").rect().center();
    hands.hover_at(at);
    hands.run_steps(1);
    hands.drag_at(at);
    hands.run_steps(1);
    hands.hover_at(at + vec2(40.0, 0.0));
    hands.run_steps(2);
    assert!(number(&hands, "a", "length").is_some());
    hands.state_mut().editor.apply(Event::Abort);
    hands.hover_at(at + vec2(60.0, 0.0));
    hands.run_steps(2);
    assert_eq!(number(&hands, "a", "length"), None);
    hands.drop_at(at + vec2(60.0, 0.0));
    hands.run_steps(3);
    assert_eq!((number(&hands, "a", "length"), done(&hands)), (None, 0));
    drag(&mut hands, at, vec2(40.0, 0.0), Modifiers::NONE);
    assert_eq!(done(&hands), 1);
}

#[test]
fn a_frame_costs_little() {
    let mut hands = hands(nodes(&[("a", "shape_list_curl")]), &["a"], (380.0, 900.0));
    let (_, frame) = count(|| hands.run_steps(1));
    assert!(frame.asked < 10_000, "{frame:?}");
}

#[test]
fn values_that_do_nothing_beside_what_is_chosen_are_grey() {
    let check = |kind: &'static str, set: &[(&str, &str)], input: &str, grey: bool| {
        let mut document = nodes(&[("a", kind)]);
        let node = Arc::make_mut(document.nodes.get_mut(&id("a")).unwrap());
        for (name, word) in set {
            let value = coif_nodes::define::Value::Text((*word).into());
            node.inputs.insert((*name).to_owned(), Setting::Known(value));
        }
        let hands = hands(document, &["a"], (420.0, 2400.0));
        let name = spoken(input);
        let field = hands.query_all_by_label(&name);
        let field = field.max_by(|a, b| a.rect().right().total_cmp(&b.rect().right())).unwrap();
        assert_eq!(field.accesskit_node().is_disabled(), grey, "{kind} {set:?}: {input}");
    };
    check("interpolate", &[], "count", true);
    check("interpolate", &[], "density", false);
    check("interpolate", &[("by", "count")], "count", false);
    check("interpolate", &[("by", "count")], "density", true);
    check("resample", &[], "spacing", true);
    check("scatter_guides", &[], "density", true);
    check("scatter_guides", &[("flow", "down")], "whorl", true);
    check("edge_partition", &[], "total", true);
    check("sphere_puff", &[("fill", "density")], "count", true);
    check("hang", &[("flow", "back")], "parted_at", true);
    check("hang", &[], "parted_at", false);
}

#[test]
fn hair_has_its_own_colours_by_name_and_the_seed_stands_last() {
    let document = nodes(&[("a", "hair_colour")]);
    let mut hands = hands(document, &["a"], (420.0, 2400.0));
    let value = |hands: &Hands, input: &str| number(hands, "a", input);
    hands.get_by_label("Copper").click();
    hands.run_steps(3);
    assert_eq!(value(&hands, "melanin_root"), Some(0.45));
    assert_eq!((value(&hands, "melanin_tip"), value(&hands, "redness")), (Some(0.38), Some(0.85)));
    assert_eq!(done(&hands), 1, "one step");
    // Hex beside it: black is the darkest there is.
    typed(&mut hands, "Root colour as hex", "#000000");
    assert!(value(&hands, "melanin_root") > Some(0.9));
    assert_eq!(value(&hands, "melanin_tip"), Some(0.38));
    assert_eq!(value(&hands, "redness"), Some(0.85), "and the tips are copper still");
    let last = |name: &str| {
        let all = hands.query_all_by_label(name);
        all.map(|node| node.rect().bottom()).fold(0.0, f32::max)
    };
    let seed = last("Seed");
    for other in ["Melanin root", "Grey", "Dye", "Amount"] {
        assert!(last(other) < seed, "{other}");
    }
}

/// Sphere puff has its seldom wanted inputs in a group of their own: rows, columns, points, scale with head.
#[test]
fn groups_of_inputs_open_and_close_and_a_filter_shows_what_it_finds() {
    let mut hands = hands(nodes(&[("a", "sphere_puff"), ("b", "gather")]), &["a"], (420.0, 2400.0));
    hands.state_mut().inspector = Inspector::default();
    hands.run_steps(3);
    let shown = |hands: &Hands, input: &str| hands.query_all_by_label(input).next().is_some();
    let press = |hands: &mut Hands, label: &str| {
        hands.get_by_label(label).click();
        hands.run_steps(3);
    };
    assert!(shown(&hands, "Bulge") && !shown(&hands, "Columns"), "Detail alone is closed at first");
    press(&mut hands, "Detail");
    typed(&mut hands, "Columns", "20");
    assert!(shown(&hands, "Detail"), "an open group does not count its inputs");
    press(&mut hands, "Detail");
    assert!(shown(&hands, "Detail: 1 changed") && !shown(&hands, "Columns"));
    // Another node keeps what is open, by the group's name.
    press(&mut hands, "Tie");
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("b")])));
    hands.run_steps(3);
    assert!(!shown(&hands, "Lean") && shown(&hands, "Volume"));
    hands.state_mut().editor.apply(Event::Select(Select::Nodes(vec![id("a")])));
    hands.run_steps(3);
    typed(&mut hands, "Filter inputs", "columns");
    assert!(shown(&hands, "Columns") && shown(&hands, "Detail") && !shown(&hands, "Tie"));
}

/// Blue on the wheel is to the left and above (two thirds round): no hair is blue, and that is said. The wheel keeps what was
/// picked under the hand, hair gets the pigment that comes nearest, and it is one step.
#[test]
fn a_wheel_picks_colours_and_says_which_no_hair_has() {
    let mut hands = hands(nodes(&[("a", "hair_colour")]), &["a"], (420.0, 2400.0));
    let press = |hands: &mut Hands, at: Pos2| {
        hands.hover_at(at);
        hands.run_steps(1);
        hands.drag_at(at);
        hands.run_steps(2);
        hands.drop_at(at);
        hands.run_steps(3);
    };
    let wheel = |hands: &Hands| hands.get_by_label("Root colour: hue and saturation").rect();
    let well = |hands: &Hands, name: &str| {
        hands.get_by_role_and_label(egui::accesskit::Role::ColorWell, name).click();
    };
    hands.get_by_label("Light blond").click();
    hands.run_steps(3);
    well(&hands, "Root colour");
    hands.run_steps(3);
    let rect = wheel(&hands);
    let before = done(&hands);
    press(&mut hands, rect.center() + egui::Vec2::angled(std::f32::consts::TAU / 30.0) * 40.0);
    assert_ne!(number(&hands, "a", "melanin_root"), Some(0.17), "another pigment");
    assert_eq!(done(&hands), before + 1, "one step");
    // In the picker, and among what is said of the node.
    let says =
        |hands: &Hands| hands.query_all_by_label_contains("no natural hair is").next().is_some();
    press(&mut hands, rect.center() + egui::Vec2::angled(std::f32::consts::TAU * 2.0 / 3.0) * 70.0);
    assert!(says(&hands), "no hair is blue");
    assert_eq!(wheel(&hands), rect, "what is said moves nothing");
    hands.get_by_label("Copper").click();
    hands.run_steps(3);
    assert_eq!(number(&hands, "a", "melanin_root"), Some(0.45));
    // The same wheel for a colour that is no pigment: full red is 1, 0, 0.
    well(&hands, "Dye");
    hands.run_steps(3);
    let rect = hands.get_by_label("Dye: hue and saturation").rect();
    press(&mut hands, rect.center() + vec2(73.5, 0.0));
    let dye = value(&hands, "a", "dye");
    assert!(matches!(dye, Some(Value::Vec3(glam::Vec3::X))), "{dye:?}");
}

#[test]
fn a_typed_colour_that_is_none_or_becomes_another_is_told() {
    let mut hands = hands(nodes(&[("colour", "hair_colour")]), &["colour"], (420.0, 1400.0));
    let says = |hands: &Hands, words: &str| {
        let text = |node: &egui_kittest::Node<'_>| {
            let node = node.accesskit_node();
            let all = [node.label(), node.value()];
            all.into_iter().flatten().collect::<String>()
        };
        hands.query_all(egui_kittest::kittest::By::new()).any(|node| text(&node).contains(words))
    };
    let before = number(&hands, "colour", "melanin_root");
    for bad in ["#+1+2+3", "brown", "#12345"] {
        typed(&mut hands, "Root colour as hex", bad);
        assert_eq!(number(&hands, "colour", "melanin_root"), before, "{bad}");
        assert!(says(&hands, "is no colour: write six digits"), "{bad}");
    }
    assert_eq!(done(&hands), 0);
    // Blue is no hair's, and nearly black is a black that pigment has.
    typed(&mut hands, "Root colour as hex", "#0000ff");
    assert!(says(&hands, "no natural hair is #0000ff"));
    typed(&mut hands, "Root colour as hex", "#160802");
    assert!(says(&hands, "#160802 became #"));
    assert!(!says(&hands, "no natural hair"));
    assert_eq!(done(&hands), 2);
}

#[test]
fn tab_goes_from_value_to_value() {
    let mut hands = hands(nodes(&[("curl", "frizz")]), &["curl"], (420.0, 900.0));
    let say = |hands: &mut Hands, text: &str| {
        hands.run_steps(2);
        hands.key_press_modifiers(Modifiers::COMMAND, Key::A);
        hands.run_steps(1);
        hands.event(egui::Event::Text(text.to_owned()));
        hands.run_steps(1);
        hands.key_press(Key::Tab);
        hands.run_steps(3);
    };
    hands.get_by_label("Step").click();
    // Sockets, names and resets lie between, pressed by a pointer alone.
    for text in ["0.7", "40%", "20%"] {
        say(&mut hands, text);
    }
    let set = ["step", "kink", "variation"].map(|input| number(&hands, "curl", input));
    assert_eq!(set, [Some(0.7), Some(0.4), Some(0.2)]);
}

#[test]
fn a_colour_that_is_read_from_parameters_is_set_there() {
    let text = r#"(format: 3, nodes: {
        "colour": (kind: "hair_colour", links: {
            "melanin_root": "all.melanin_root", "melanin_tip": "all.melanin_tip", "redness": "all.redness"}),
        "all": (kind: "parameters", label: "Bob", interface: (inputs: [
            (name: "length", type: "number", default: 20.0, unit: "cm", doc: "How long."),
            (name: "melanin_root", type: "number", default: 0.9, range: (0.0, 1.0), section: "Colour"),
            (name: "melanin_tip", type: "number", default: 0.87, range: (0.0, 1.0)),
            (name: "redness", type: "number", default: 0.12, range: (0.0, 1.0)),
        ])),
    })"#;
    for node in ["all", "colour"] {
        let document = coif_graphs::file::read(text).unwrap().document;
        let mut hands = hands(document, &[node], (420.0, 1200.0));
        hands.get_by_label("Copper").click();
        hands.run_steps(3);
        let set =
            ["melanin_root", "melanin_tip", "redness"].map(|name| number(&hands, "all", name));
        assert_eq!(set, [Some(0.45), Some(0.38), Some(0.85)], "{node}");
        assert_eq!(done(&hands), 1);
        let document = &hands.state().editor.state.document;
        assert!(document.node("colour").unwrap().inputs.is_empty(), "the wires stay what counts");
        hands.get_by_label("Root colour as hex");
        if node == "all" {
            // What is turned first stands first.
            let top = |label: &str| hands.get_by_label(label).rect().top();
            assert!(top("Length") < top("Copper") && top("Copper") < top("Melanin root"));
        }
    }
}
