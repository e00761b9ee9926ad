//! The tour notices what a person does, and nothing else.

use super::harness::{on_groom, settle};
use coif::core::event::Event;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{NodeId, Setting};
use coif_nodes::data::strokes::{Sample, Stroke};
use coif_nodes::define::Value;
use glam::Vec3;

#[test]
fn each_step_of_the_tour_is_noticed_when_it_is_done() {
    let mut ui = on_groom("cornrows");
    settle(&mut ui);
    ui.state_mut().act("help.tour");
    ui.run_steps(2);
    let at = |ui: &super::harness::Ui| ui.state().tour_step().map(|(step, _)| step);
    assert_eq!(at(&ui), Some(0));
    ui.run_steps(3);
    assert_eq!(at(&ui), Some(0), "nothing was done");

    let mut camera = *ui.state().viewport.camera();
    camera = camera.turned(camera.target, Vec3::Y, 30.0);
    ui.state_mut().viewport.look(camera);
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(1));

    let id = |text: &str| NodeId::new(text).expect("an id");
    let sample =
        |z: f32| Sample { position: Vec3::new(0.0, 9.0, z), pressure: 0.5, ..Sample::default() };
    let stroke = Stroke::new(77, vec![sample(3.0), sample(-3.0)]);
    let input = "strokes".to_owned();
    ui.state_mut().apply(Event::Edit(Edit::AddStroke { node: id("rows"), input, at: 99, stroke }));
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(2));

    let set = |node: &str, input: &str, value: Value| {
        let setting = Setting::Known(value);
        Event::Edit(Edit::SetInput { node: id(node), input: input.to_owned(), setting })
    };
    ui.state_mut().apply(set("braid", "width", Value::Float(1.0)));
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(2), "the width is not the number of strands");
    ui.state_mut().apply(set("braid", "strands", Value::Int(4)));
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(3));
    ui.state_mut().apply(set("partings", "parting_width", Value::Float(0.4)));
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(4));
    // By the pen it is tried in its own tests; a gesture in the document is noticed.
    let node = ui.state().state.document.fresh_node("hair_sketch", &id("sketch"));
    let add = Edit::AddNode { id: id("sketch"), node: node.into(), at: None };
    ui.state_mut().apply(Event::Edit(add));
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(4));
    let text = coif_graphs::grooms::by_name("sketch_mohawk").expect("a groom");
    let drawn = coif_graphs::file::read(text).expect("it reads").document;
    let held = drawn.node("hair_sketch").and_then(|node| node.inputs.get("gestures").cloned());
    let Some(Setting::Known(gestures)) = held else { panic!("gestures") };
    ui.state_mut().apply(set("sketch", "gestures", gestures));
    ui.run_steps(2);
    assert_eq!(at(&ui), Some(5));
}
