//! Stories of hands on the canvas, without a display.

use super::testing::*;
use super::*;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::testing::until;
use crate::waiting::ends;
use crate::work::count;
use coif_graphs::document::{Setting, Socket};
use coif_nodes::define::Value;
use egui::{Key, Modifiers, pos2};
use egui_kittest::kittest::Queryable as _;

const SHIFT: Modifiers = Modifiers::SHIFT;
const CTRL: Modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };

/// Rows of the head, and a braid that is not wired to them.
fn unwired() -> coif_graphs::document::Document {
    let mut document = document("cornrows");
    document.links.retain(|to, _| to.node == id("rows"));
    document.nodes.retain(|id, _| ["head", "rows", "braid"].contains(&id.as_str()));
    document.layout.retain(|id, _| document.nodes.contains_key(id));
    document.bends.clear();
    document.display = None;
    document
}
fn wired(window: &Window, input: &str) -> Vec<String> {
    let socket = socket(input);
    let wires = window.state().state.document.wires(&socket.node, &socket.name);
    wires.iter().map(Socket::to_string).collect()
}
#[track_caller]
fn steps(window: &Window, count: usize) {
    assert_eq!(window.state().steps, count, "{:?}", window.state().said);
}
/// An empty place of the canvas, on the screen.
fn nowhere(window: &Window) -> Pos2 {
    window.state().canvas.area.unwrap().center_bottom() - vec2(0.0, 40.0)
}

#[test]
fn a_wire_is_drawn_from_socket_to_socket() {
    let mut w = window(unwired());
    let (from, to) = (place(&w, "rows: curves output"), place(&w, "cornrows: source input"));
    drag(&mut w, &[from, to + vec2(-6.0, 4.0)], Modifiers::NONE);
    assert_eq!(wired(&w, "braid.source"), ["rows.curves"]);
    steps(&w, 1);
    // And from the other end.
    let (from, to) = (place(&w, "cornrows: scalp input"), place(&w, "Head: scalp output"));
    drag(&mut w, &[from, to], Modifiers::NONE);
    assert_eq!(wired(&w, "braid.scalp"), ["head.scalp"]);
    steps(&w, 2);
}

#[test]
fn a_wrong_wire_is_refused_while_dragging_with_the_reason() {
    let mut w = window(unwired());
    let (from, to) = (place(&w, "rows: curves output"), place(&w, "cornrows: scalp input"));
    hold(&mut w, &[from, to], Modifiers::NONE);
    let why = "rows.curves gives curves, scalp is taken";
    w.get_by_label(why);
    release(&mut w, to, Modifiers::NONE);
    assert_eq!(wired(&w, "braid.scalp"), Vec::<String>::new());
    assert_eq!(w.state().said, [why]);
    assert!(w.query_by_label(why).is_none());
    steps(&w, 0);
}

#[test]
fn the_end_of_a_wire_is_lifted_and_put_elsewhere_or_let_go() {
    let mut w = window(document("cornrows"));
    let (from, to) =
        (place(&w, "hair in the braids: curves input"), place(&w, "parting hairs: adjacent input"));
    drag(&mut w, &[from, to], Modifiers::NONE);
    assert_eq!(wired(&w, "fill.curves"), Vec::<String>::new());
    assert_eq!(wired(&w, "partings.adjacent"), ["braid.curves"]);
    steps(&w, 1);
    let away = nowhere(&w);
    let lifted = place(&w, "parting hairs: adjacent input");
    drag(&mut w, &[lifted, away], Modifiers::NONE);
    assert_eq!(wired(&w, "partings.adjacent"), Vec::<String>::new());
    assert!(w.state().canvas.memory.finder.is_none());
    // Escape puts it back.
    let lifted = place(&w, "parting hairs: source input");
    hold(&mut w, &[lifted, away], Modifiers::NONE);
    w.key_press(Key::Escape);
    w.run_steps(2);
    release(&mut w, away, Modifiers::NONE);
    assert_eq!(wired(&w, "partings.source"), ["rows.curves"]);
    steps(&w, 2);
}

#[test]
fn a_wire_dropped_on_nothing_searches_what_fits() {
    let mut w = window(unwired());
    let (from, away) = (place(&w, "cornrows: curves output"), nowhere(&w));
    drag(&mut w, &[from, away], Modifiers::NONE);
    assert!(w.query_by_label("Head").is_none(), "a head takes no curves");
    w.event(egui::Event::Text("fill".into()));
    w.run_steps(2);
    w.key_press(Key::Enter);
    w.run_steps(3);
    let document = &w.state().state.document;
    assert_eq!(document.nodes["cluster_to_strands"].kind, "cluster_to_strands");
    assert_eq!(wired(&w, "cluster_to_strands.curves"), ["braid.curves"]);
    assert_eq!(w.state().state.active(), Some(&id("cluster_to_strands")));
    // Its end lies where the wire was dropped.
    let end = place(&w, "Cluster to strands: curves input");
    assert!(end.distance(away) < 24.0, "{end:?} {away:?}");
    steps(&w, 1);
}

#[test]
fn puffs_at_the_ends_of_braids_are_one_action_and_are_joined_with_their_hair() {
    let mut w = window(document("cornrows"));
    w.run_steps(2);
    let desk = w.state_mut();
    for event in desk.canvas.puffs_at_ends(&desk.state) {
        desk.apply(event);
    }
    steps(&w, 1);
    assert_eq!(wired(&w, "sphere_puff.placements"), ["braid.curves"]);
    assert_eq!(wired(&w, "sphere_puff.scalp"), wired(&w, "braid.scalp"));
    assert_eq!(wired(&w, "merge.curves").last().map(String::as_str), Some("sphere_puff.curves"));
    let puff = &w.state().state.document.nodes["sphere_puff"].inputs;
    assert_eq!(puff["at"], Setting::Known(Value::Text("tips".into())));
    // Where nothing is braided there is nothing to do.
    let mut bare = unwired();
    bare.nodes.remove("braid");
    assert!(commands::braid(&window(bare).state().state).is_none());
}

#[test]
fn a_field_dropped_on_a_node_lists_the_inputs_that_take_it_and_opens_them_while_it_is_dragged() {
    let mut document = document("cornrows");
    let mask = document.fresh_node("paint_mask", &id("mask"));
    document.nodes.insert(id("mask"), mask.into());
    document.layout.insert(id("mask"), coif_graphs::document::Point(440.0, -300.0));
    let mut w = window(document);
    let from = place(&w, "Paint mask: mask output");
    let body = place(&w, "hair in the braids: node");
    assert!(w.query_by_label("hair in the braids: frizz input").is_none());
    hold(&mut w, &[from, body], Modifiers::NONE);
    assert!(w.query_by_label("hair in the braids: frizz input").is_some(), "its fields are open");
    assert!(w.query_by_label("cornrows: width input").is_none(), "those of others are not");
    release(&mut w, body, Modifiers::NONE);
    assert!(w.query_by_label("hair in the braids: frizz input").is_none());
    assert!(w.query_by_label("Curves").is_none(), "curves take no field");
    w.event(egui::Event::Text("frizz".into()));
    w.run_steps(2);
    w.key_press(Key::Enter);
    w.run_steps(3);
    assert_eq!(wired(&w, "fill.frizz"), ["mask.mask"]);
    steps(&w, 1);
    // On one of them it is wired at once.
    hold(&mut w, &[from, body], Modifiers::NONE);
    let radius = place(&w, "hair in the braids: radius input");
    w.event(egui::Event::PointerMoved(radius));
    w.run_steps(3);
    release(&mut w, radius, Modifiers::NONE);
    assert_eq!(wired(&w, "fill.radius"), ["mask.mask"]);
    // What nothing takes is refused, with the node.
    let head = place(&w, "Head: node");
    hold(&mut w, &[from, head], Modifiers::NONE);
    w.get_by_label("Head takes no field");
    release(&mut w, head, Modifiers::NONE);
    steps(&w, 2);
}

#[test]
fn two_clicks_on_a_wired_input_and_beside_it_leave_the_wire() {
    let mut w = window(document("cornrows"));
    let at = place(&w, "hair in the braids: curves input");
    click(&mut w, at, 1);
    let away = nowhere(&w);
    click(&mut w, away, 1);
    assert_eq!(wired(&w, "fill.curves"), ["braid.curves"]);
    steps(&w, 0);
}

#[test]
fn all_wires_of_an_output_move_together() {
    let mut document = document("cornrows");
    let more = document.fresh_node("stroke_input", &id("more"));
    document.nodes.insert(id("more"), more.into());
    document.layout.insert(id("more"), coif_graphs::document::Point(220.0, 300.0));
    let mut w = window(document);
    let (from, to) = (place(&w, "rows: curves output"), place(&w, "more: curves output"));
    drag(&mut w, &[from, to], SHIFT);
    assert_eq!(wired(&w, "braid.source"), ["more.curves"]);
    assert_eq!(wired(&w, "partings.source"), ["more.curves"]);
    steps(&w, 1);
}

#[test]
fn wires_are_cut_by_a_line() {
    let mut w = window(document("cornrows"));
    let at = place(&w, "hair in the braids: curves output") + vec2(20.0, 0.0);
    drag(&mut w, &[at - vec2(0.0, 60.0), at + vec2(0.0, 40.0)], CTRL);
    assert_eq!(wired(&w, "fill_width.curves"), Vec::<String>::new());
    assert_eq!(wired(&w, "fill.curves"), ["braid.curves"]);
    assert!(w.state().state.selection.nodes.is_empty());
    steps(&w, 1);
}

#[test]
fn a_drag_of_nodes_is_one_step_and_is_taken_back() {
    let mut w = window(document("cornrows"));
    let before = w.state().state.document.layout.clone();
    let nodes = ["rows", "braid"].map(id).to_vec();
    w.state_mut().apply(Event::Select(Select::Nodes(nodes)));
    w.run_steps(2);
    let from = place(&w, "rows: node") - vec2(0.0, 28.0);
    let scale = w.state().canvas.scale();
    drag(&mut w, &[from, from + vec2(37.0, 145.0)], Modifiers::ALT);
    steps(&w, 1);
    let after = w.state().state.document.layout.clone();
    for node in ["rows", "braid"] {
        let moved = arrange::pos(after[&id(node)]) - arrange::pos(before[&id(node)]);
        let wanted = vec2(37.0, 145.0) / scale;
        assert!((moved - wanted).length() < 3.0, "{node} {moved:?} {wanted:?}");
    }
    assert_eq!(after[&id("fill")], before[&id("fill")]);
    let desk = w.state_mut();
    desk.state.history.undo(&mut desk.state.document).unwrap();
    assert_eq!(desk.state.document.layout, before);
    assert_eq!(desk.state.history.done(), 0);
    // A drag that is given up moves nothing.
    w.run_steps(2);
    hold(&mut w, &[from, from + vec2(37.0, 145.0)], Modifiers::ALT);
    w.key_press(Key::Escape);
    w.run_steps(2);
    release(&mut w, from + vec2(50.0, 145.0), Modifiers::ALT);
    assert_eq!(w.state().state.document.layout, before);
    steps(&w, 1);
}

#[test]
fn a_loose_node_dropped_on_a_wire_is_inserted() {
    let mut document = document("cornrows");
    let node = document.fresh_node("resample", &id("thin"));
    document.nodes.insert(id("thin"), node.into());
    document.layout.insert(id("thin"), coif_graphs::document::Point(300.0, 420.0));
    let mut w = window(document);
    let from = place(&w, "Resample: node") - vec2(0.0, 22.0);
    let node = place(&w, "Resample: node");
    let wire = place(&w, "hair in the braids: curves output") + vec2(24.0, 0.0);
    let to = from + (wire - node);
    hold(&mut w, &[from, to], Modifiers::ALT);
    assert!(w.state().canvas.memory.drop_on.is_some(), "the wire is marked");
    release(&mut w, to, Modifiers::ALT);
    assert_eq!(wired(&w, "thin.curves"), ["fill.curves"]);
    assert_eq!(wired(&w, "fill_width.curves"), ["thin.curves"]);
    steps(&w, 1);
    // And removed again, the wire heals.
    let desk = w.state_mut();
    for event in desk.canvas.delete(&desk.state) {
        desk.apply(event);
    }
    assert_eq!(wired(&w, "fill_width.curves"), ["fill.curves"]);
}

#[test]
fn a_node_of_a_chain_dropped_on_a_wire_moves_there_and_with_shift_branches() {
    for (keys, fed, behind) in [
        (Modifiers::ALT, "fill.curves", "fill_width.curves"),
        (SHIFT | Modifiers::ALT, "fill_width.curves", "braid.curves"),
    ] {
        let mut w = window(document("cornrows"));
        w.state_mut().apply(Event::Select(Select::Nodes(vec![id("fill_width")])));
        w.run_steps(2);
        let node = place(&w, "Set width: node");
        let from = node - vec2(0.0, 22.0);
        let wire = place(&w, "cornrows: curves output") + vec2(20.0, 0.0);
        let to = from + (wire - node);
        hold(&mut w, &[from, to], keys);
        assert!(w.state().canvas.memory.drop_on.is_some(), "the wire is marked");
        release(&mut w, to, keys);
        assert_eq!(wired(&w, "fill_width.curves"), ["braid.curves"]);
        assert_eq!(wired(&w, "fill.curves"), [behind]);
        assert_eq!(wired(&w, "colour.curves"), [fed]);
        let said = ["Set width: inserted between cornrows and hair in the braids"];
        let said = if keys.shift { &said[..0] } else { &said[..] };
        assert_eq!(w.state().said, said);
        steps(&w, 1);
    }
}

#[test]
fn tab_and_enter_on_a_node_in_a_chain_insert_behind_it_and_shift_branches() {
    for (shift, fed) in [(false, "resample.curves"), (true, "braid.curves")] {
        let mut w = window(document("cornrows"));
        w.state_mut().apply(Event::Select(Select::Nodes(vec![id("braid")])));
        let desk = w.state_mut();
        desk.canvas.add(&desk.state);
        w.run_steps(2);
        w.get_by_label_contains("Enter inserts after cornrows, Shift+Enter branches");
        w.event(egui::Event::Text("resample".into()));
        w.run_steps(2);
        w.key_press_modifiers(if shift { SHIFT } else { Modifiers::NONE }, Key::Enter);
        w.run_steps(3);
        assert_eq!(wired(&w, "resample.curves"), ["braid.curves"]);
        assert_eq!(wired(&w, "fill.curves"), [fed]);
        steps(&w, 1);
        let said = &w.state().said;
        match shift {
            true => assert!(said.is_empty(), "{said:?}"),
            false => {
                assert_eq!(*said, ["Resample: inserted between cornrows and hair in the braids"])
            }
        }
        // It stands in a column of its own, from left to right.
        let faces = faces(&w.state().state.document);
        let left = |node: &str| faces.rect(&id(node)).unwrap().left();
        if !shift {
            assert!(left("braid") < left("resample") && left("resample") < left("fill"));
            let seen = w.state().canvas.seen();
            assert!(seen.contains_rect(faces.rect(&id("resample")).unwrap()));
        }
    }
}

#[test]
fn a_double_click_bends_a_wire_a_drag_moves_the_bend_and_delete_removes_it() {
    let mut w = window(document("cornrows"));
    let to = Wire { to: socket("partings.scalp"), at: 0 };
    let bends = |w: &Window| w.state().state.document.bends_of(&to.to, 0).to_vec();
    let runs = {
        let desk = w.state();
        let faces = desk.canvas.cache.last();
        wires::runs(&desk.state.document, faces, |id| faces.corners.get(id).copied(), None)
    };
    let run = runs.iter().find(|run| run.wire == to).unwrap();
    let points = run.points(4.0);
    let on_it = w.state().canvas.to_screen(points[points.len() * 2 / 3]);
    click(&mut w, on_it, 2);
    assert_eq!(bends(&w).len(), 1, "{on_it:?} {:?}", w.state().canvas.memory.wires);
    let dot = w.state().canvas.to_screen(arrange::pos(bends(&w)[0]));
    drag(&mut w, &[dot, dot + vec2(-60.0, 90.0)], Modifiers::NONE);
    let now = w.state().canvas.to_screen(arrange::pos(bends(&w)[0]));
    assert!(now.distance(dot + vec2(-60.0, 90.0)) < 2.0, "{now:?}");
    steps(&w, 2);
    let desk = w.state_mut();
    assert_eq!(desk.canvas.memory.bend, Some((to.clone(), 0)));
    for event in desk.canvas.delete(&desk.state) {
        desk.apply(event);
    }
    assert!(bends(&w).is_empty());
}

#[test]
fn wires_of_one_input_are_reordered_by_hand_and_by_key() {
    let mut w = window(document("braids"));
    let merge = "merge.curves";
    let node =
        w.state().state.document.nodes.iter().find(|(_, n)| n.kind == "merge").unwrap().0.clone();
    let merge = merge.replace("merge", node.as_str());
    let before = wired(&w, &merge);
    assert!(before.len() > 2);
    let (from, to) = (place(&w, "Merge: curves 1 input"), place(&w, "Merge: curves 3 input"));
    drag(&mut w, &[from, to], Modifiers::NONE);
    let moved = [&before[1..3], &before[..1], &before[3..]].concat();
    assert_eq!(wired(&w, &merge), moved);
    let desk = w.state_mut();
    desk.canvas.memory.wires = [Wire { to: socket(&merge), at: 2 }].into();
    for by in [-1, -1, -1] {
        for event in desk.canvas.reorder(&desk.state, by) {
            desk.apply(event);
        }
    }
    assert_eq!(wired(&w, &merge), before);
}

#[test]
fn shaking_a_node_takes_it_out() {
    let mut w = window(document("cornrows"));
    let from = place(&w, "hair in the braids: node") - vec2(0.0, 38.0);
    let mut way = vec![from];
    for turn in 0..8 {
        way.push(from + vec2(if turn % 2 == 0 { 50.0 } else { -30.0 }, 60.0));
    }
    drag(&mut w, &way, Modifiers::NONE);
    assert_eq!(wired(&w, "fill.curves"), Vec::<String>::new());
    assert_eq!(wired(&w, "fill_width.curves"), ["braid.curves"], "the wire heals");
}

#[test]
fn sockets_can_be_wired_by_clicks_alone() {
    let mut w = window(unwired());
    w.get_by_label("rows: curves output").click_accesskit();
    w.run_steps(2);
    assert!(matches!(w.state().canvas.memory.hand, Hand::Wire(_)));
    w.get_by_label("cornrows: source input").click_accesskit();
    w.run_steps(3);
    assert_eq!(wired(&w, "braid.source"), ["rows.curves"]);
    // By pointer as well.
    let (from, to) = (place(&w, "Head: scalp output"), place(&w, "cornrows: scalp input"));
    click(&mut w, from, 1);
    click(&mut w, to, 1);
    assert_eq!(wired(&w, "braid.scalp"), ["head.scalp"]);
    assert_eq!(w.state().canvas.memory.hand, Hand::Empty);
}

#[test]
fn nodes_are_copied_as_text_and_pasted() {
    let mut w = window(document("cornrows"));
    let nodes = ["braid", "fill"].map(id).to_vec();
    w.state_mut().apply(Event::Select(Select::Nodes(nodes)));
    w.run_steps(2);
    w.event(egui::Event::Copy);
    w.run_steps(1);
    let copied = w.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let text = copied.expect("text in the clipboard");
    let count = w.state().state.document.nodes.len();
    w.event(egui::Event::Paste(text));
    w.run_steps(2);
    let made = w.state().state.selection.nodes.clone();
    assert_eq!((made.len(), w.state().state.document.nodes.len()), (2, count + 2));
    steps(&w, 1);
    w.event(egui::Event::Cut);
    w.run_steps(2);
    assert_eq!(w.state().state.document.nodes.len(), count);
    w.event(egui::Event::Paste("just words".into()));
    w.run_steps(2);
    assert!(w.state().said[0].contains("nothing was pasted"), "{:?}", w.state().said);
}

#[test]
fn flags_are_clicked_on_the_node() {
    let mut w = window(document("cornrows"));
    for (name, count) in [("cornrows: display", 0), ("cornrows: bypass", 1)] {
        let at = place(&w, name);
        click(&mut w, at, 1);
        steps(&w, count);
    }
    assert_eq!(w.state().state.document.display, Some(id("braid")));
    assert!(w.state().state.document.nodes["braid"].bypass);
}

#[test]
fn a_box_selects_nodes_and_a_click_beside_them_nothing() {
    let mut w = window(document("cornrows"));
    let (a, b) = (place(&w, "rows: node"), place(&w, "cornrows: node"));
    drag(&mut w, &[a - vec2(95.0, 60.0), b + vec2(20.0, 70.0)], Modifiers::NONE);
    assert_eq!(w.state().state.selection.nodes, ["rows", "braid"].map(id).into());
    let away = nowhere(&w);
    click(&mut w, away, 1);
    assert!(w.state().state.selection.nodes.is_empty());
    steps(&w, 0);
}

#[test]
fn a_node_that_takes_the_place_of_one_of_its_name_comes_into_sight() {
    let mut w = window(document("cornrows"));
    let desk = w.state_mut();
    // Far from all else, with another that is new.
    let mut other = desk.state.document.clone();
    other.nodes.remove("braid");
    let before = coif_graphs::document::edit::between(&desk.state.document, &other);
    let mut after = other.clone();
    for (node, at) in [("braid", 4000.0), ("new", 4400.0)] {
        after.nodes.insert(id(node), after.fresh_node("lissajous_braid", &id(node)).into());
        after.layout.insert(id(node), coif_graphs::document::Point(at, 3000.0));
    }
    let edit = coif_graphs::document::edit::between(&other, &after);
    desk.apply(Event::Edit(Edit::Several(vec![before, edit])));
    desk.apply(Event::Select(Select::Nodes(vec![id("braid")])));
    w.run_steps(20);
    let desk = w.state_mut();
    let faces = desk.canvas.cache.of(&desk.state);
    let title = faces.rect(&id("braid")).unwrap().split_top_bottom_at_fraction(0.3).0;
    assert!(desk.canvas.seen().contains_rect(title), "{title} {}", desk.canvas.seen());
}

#[test]
fn a_click_with_shift_adds_to_the_selection() {
    for (quick, boxed) in [(true, false), (false, false), (true, true), (false, true)] {
        let mut w = window(document("cornrows"));
        let [a, b, c] = ["rows: node", "cornrows: node", "hair in the braids: node"]
            .map(|name| place(&w, name));
        match boxed {
            true => drag(&mut w, &[a - vec2(95.0, 60.0), b + vec2(20.0, 70.0)], Modifiers::NONE),
            false => click(&mut w, a, 1),
        }
        let before = w.state().state.selection.nodes.clone();
        assert_eq!(before.len(), if boxed { 2 } else { 1 });
        match quick {
            true => {
                w.event(egui::Event::ModifiersChanged(SHIFT));
                w.event(egui::Event::PointerMoved(c));
                w.run_steps(2);
                w.event(button(c, true, SHIFT));
                w.event(button(c, false, SHIFT));
                w.run_steps(3);
            }
            false => drag(&mut w, &[c, c], SHIFT),
        }
        let now = &w.state().state.selection.nodes;
        assert!(now.is_superset(&before) && now.contains(&id("fill")), "{quick} {boxed}: {now:?}");
    }
}

#[test]
fn a_box_with_shift_selects_wires() {
    let mut w = window(document("cornrows"));
    let at = place(&w, "hair in the braids: curves output") + vec2(20.0, 0.0);
    drag(&mut w, &[at - vec2(8.0, 70.0), at + vec2(8.0, 30.0)], SHIFT);
    let wires: Vec<&Wire> = w.state().canvas.memory.wires.iter().collect();
    assert_eq!(wires, [&Wire { to: socket("fill_width.curves"), at: 0 }]);
    let desk = w.state_mut();
    for event in desk.canvas.delete(&desk.state) {
        desk.apply(event);
    }
    assert_eq!(wired(&w, "fill_width.curves"), Vec::<String>::new());
}

#[test]
fn what_files_may_say_is_drawn_with_bounded_work() {
    use coif_graphs::document::{Frame, Point};
    let mut document = document("cornrows");
    document.layout.insert(id("fill"), Point(f32::MAX, -f32::MAX));
    document.layout.insert(id("braid"), Point(1e9, 3.0));
    document.bends.insert(socket("colour.curves"), vec![vec![Point(-1e30, 1e30); 3]]);
    let frame = Frame { at: Point(-1e30, 0.0), size: Point(f32::MAX, 1e-30), ..Frame::default() };
    document.frames.insert("wide".to_owned(), frame);
    let from = vec![socket("colour.curves"); 3000];
    document.links.insert(socket("braids_out.curves"), from);
    document.links.insert(socket("nowhere.at_all"), vec![socket("never.was")]);
    let long =
        coif_graphs::document::Node { label: Some("x".repeat(100_000)), ..Default::default() };
    document.nodes.insert(id("long"), long.into());
    let mut w = ends("a window opens", || window(document));
    for scale in [0.1, 1.0, 2.0] {
        let canvas = &mut w.state_mut().canvas;
        canvas.view.scene_rect =
            Rect::from_center_size(pos2(400.0, 100.0), vec2(1280.0, 640.0) / scale);
        let (_, work) = ends("a frame ends", || count(|| w.run_steps(2)));
        assert!(work.asked < 100_000 && work.held < 64 << 20, "at {scale}: {work:?}");
    }
}

#[test]
fn a_frame_moves_with_its_nodes_in_one_step() {
    let mut w = window(document("cornrows"));
    let nodes = ["rows", "braid"].map(id).to_vec();
    w.state_mut().apply(Event::Select(Select::Nodes(nodes)));
    let desk = w.state_mut();
    for event in desk.canvas.frame_nodes(&desk.state) {
        desk.apply(event);
    }
    w.run_steps(2);
    w.event(egui::Event::Text("Front rows".into()));
    w.run_steps(1);
    w.key_press(Key::Enter);
    w.run_steps(3);
    assert_eq!(w.state().state.document.frames["frame"].text, "Front rows");
    steps(&w, 2);
    let before = w.state().state.document.layout.clone();
    let title = place(&w, "Front rows: frame");
    drag(&mut w, &[title, title + vec2(40.0, -50.0)], Modifiers::NONE);
    let after = &w.state().state.document.layout;
    assert_ne!(after[&id("rows")], before[&id("rows")]);
    assert_eq!(after[&id("fill")], before[&id("fill")]);
    steps(&w, 3);
}

#[test]
fn the_wheel_zooms_about_the_pointer_within_limits() {
    let mut w = window(document("cornrows"));
    let at = place(&w, "hair in the braids: node") + vec2(3.0, 5.0);
    let under = w.state().canvas.to_canvas(at);
    for turns in [6.0, -60.0, 90.0] {
        w.event(egui::Event::PointerMoved(at));
        w.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, turns),
            phase: egui::TouchPhase::Move,
            modifiers: Modifiers::NONE,
        });
        w.run_steps(30);
        let canvas = &w.state().canvas;
        assert!(canvas.to_canvas(at).distance(under) < 1.0, "{:?}", canvas.to_canvas(at));
        assert!((0.099..=2.001).contains(&canvas.scale()), "{}", canvas.scale());
    }
    assert!(w.state().canvas.scale() > 1.9);
}

/// The whole editor, for what keys do.
fn editor(document: coif_graphs::document::Document) -> egui_kittest::Harness<'static, Editor> {
    let ctx = egui::Context::default();
    let editor = Editor::new(&ctx, document, OpenFile::default());
    let mut ui = egui_kittest::Harness::builder()
        .with_size(vec2(1440.0, 900.0))
        .with_max_steps(64)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
    ui.state_mut().apply(Event::Show(Room::Canvas));
    ui.run_steps(4);
    ui
}
fn press(ui: &mut egui_kittest::Harness<'static, Editor>, modifiers: Modifiers, key: Key) {
    ui.key_press_modifiers(modifiers, key);
    ui.run_steps(3);
}
fn write(ui: &mut egui_kittest::Harness<'static, Editor>, text: &str) {
    ui.event(egui::Event::Text(text.to_owned()));
    ui.run_steps(2);
}

#[test]
fn a_braid_is_built_from_nothing_with_the_keyboard() {
    let mut ui = editor(coif_graphs::document::Document::default());
    let none = Modifiers::NONE;
    for typed in ["head", "draw", "plait", "fill"] {
        press(&mut ui, none, Key::Tab);
        write(&mut ui, typed);
        press(&mut ui, none, Key::Enter);
    }
    let document = &ui.state().state.document;
    let wires = |input: &str| -> Vec<String> {
        let input = socket(input);
        document.wires(&input.node, &input.name).iter().map(Socket::to_string).collect()
    };
    assert_eq!(wires("stroke_input.scalp"), ["head.scalp"]);
    assert_eq!(wires("lissajous_braid.source"), ["stroke_input.curves"]);
    assert_eq!(wires("cluster_to_strands.curves"), ["lissajous_braid.curves"]);
    assert_eq!(ui.state().state.history.done(), 4);
    // Back to the braid along its wire, and from it a wire to a node that stands alone.
    press(&mut ui, none, Key::Tab);
    write(&mut ui, "resample");
    press(&mut ui, SHIFT, Key::Enter);
    assert!(ui.state().state.document.wires(&id("resample"), "curves").is_empty());
    ui.state_mut().apply(Event::Select(Select::Nodes(vec![id("cluster_to_strands")])));
    press(&mut ui, none, Key::ArrowLeft);
    assert_eq!(ui.state().state.active(), Some(&id("lissajous_braid")));
    press(&mut ui, none, Key::C);
    write(&mut ui, "resample");
    press(&mut ui, none, Key::Enter);
    let fed = ui.state().state.document.wires(&id("resample"), "curves").to_vec();
    assert_eq!(fed, [socket("lissajous_braid.curves")]);
}

#[test]
fn keys_do_what_the_table_says() {
    let mut ui = editor(unwired());
    let none = Modifiers::NONE;
    let select = |ui: &mut egui_kittest::Harness<'static, Editor>, node: &str| {
        ui.state_mut().apply(Event::Select(Select::Nodes(vec![id(node)])));
        ui.run_steps(2);
    };
    select(&mut ui, "rows");
    press(&mut ui, none, Key::D);
    assert_eq!(ui.state().state.document.display, Some(id("rows")));
    select(&mut ui, "braid");
    press(&mut ui, none, Key::Q);
    assert_eq!(ui.state().state.document.display, Some(id("braid")));
    press(&mut ui, none, Key::Q);
    assert_eq!(ui.state().state.document.display, Some(id("rows")));
    press(&mut ui, none, Key::B);
    press(&mut ui, none, Key::H);
    assert!(ui.state().state.document.nodes["braid"].bypass);
    assert!(ui.state().state.document.collapsed.contains("braid"));
    press(&mut ui, CTRL, Key::D);
    assert_eq!(ui.state().state.document.nodes.len(), 4);
    press(&mut ui, none, Key::Delete);
    assert_eq!(ui.state().state.document.nodes.len(), 3);
    press(&mut ui, CTRL, Key::A);
    assert_eq!(ui.state().state.selection.nodes.len(), 3);
    press(&mut ui, CTRL, Key::G);
    write(&mut ui, "All of it");
    press(&mut ui, none, Key::Enter);
    assert_eq!(ui.state().state.document.frames["frame"].text, "All of it");
    select(&mut ui, "rows");
    press(&mut ui, none, Key::F2);
    write(&mut ui, "front");
    press(&mut ui, none, Key::Enter);
    assert_eq!(ui.state().state.document.name_of(&id("rows")), "front");
    press(&mut ui, none, Key::S);
    write(&mut ui, "scatter");
    press(&mut ui, none, Key::Enter);
    assert_eq!(ui.state().state.document.nodes["rows"].kind, "scatter_guides");
    assert_eq!(ui.state().state.document.wires(&id("rows"), "scalp"), [socket("head.scalp")]);
    press(&mut ui, none, Key::W);
    press(&mut ui, none, Key::Delete);
    assert!(ui.state().state.document.wires(&id("rows"), "scalp").is_empty());
    press(&mut ui, none, Key::ArrowRight);
    press(&mut ui, none, Key::P);
    assert!(ui.state().state.pinned.is_some());
    let done = ui.state().state.history.done();
    for _ in 0..done {
        press(&mut ui, CTRL, Key::Z);
    }
    let document = &ui.state().state.document;
    assert_eq!((document.nodes.len(), document.frames.len()), (3, 0));
    assert_eq!(document.links, unwired().links);
}

/// So many nodes in rows of ten, each fed by the one before.
fn many(count: usize) -> coif_graphs::document::Document {
    let mut document = coif_graphs::document::Document::default();
    for n in 0..count {
        let at = id(&format!("n{n}"));
        let kind = ["resample", "set_width", "transform", "cluster_to_strands"][n % 4];
        let node = document.fresh_node(kind, &at);
        document.nodes.insert(at.clone(), node.into());
        let (x, y) = ((n % 20) as f32 * 220.0, (n / 20) as f32 * 130.0);
        document.layout.insert(at.clone(), coif_graphs::document::Point(x, y));
        if n > 0 {
            let from = Socket::new(id(&format!("n{}", n - 1)), "curves");
            document.links.insert(Socket::new(at, "curves"), vec![from]);
        }
    }
    document
}

#[test]
fn three_hundred_nodes_take_little_of_a_frame() {
    let mut state = State::new(many(300), OpenFile::default(), Default::default(), |_| None);
    state.focus = Room::Canvas;
    let mut canvas = Canvas::default();
    let ctx = egui::Context::default();
    let size = vec2(1440.0, 900.0);
    let frame = |canvas: &mut Canvas| {
        let input = egui::RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, size)),
            events: vec![egui::Event::PointerMoved(pos2(700.0, 500.0))],
            ..Default::default()
        };
        let mut out = vec![];
        let mut output = ctx.run_ui(input, |ui| canvas.ui(&state, ui, &mut out));
        output.textures_delta.clear();
        let shapes = ctx.tessellate(output.shapes, 1.0);
        let vertices = |shape: &egui::ClippedPrimitive| match &shape.primitive {
            egui::epaint::Primitive::Mesh(mesh) => mesh.vertices.len(),
            egui::epaint::Primitive::Callback(_) => 0,
        };
        shapes.iter().map(vertices).sum::<usize>()
    };
    for (name, scale) in [("all in sight", 0.0), ("at half size", 0.5), ("at full size", 1.0)] {
        frame(&mut canvas);
        if scale > 0.0 {
            let middle = canvas.view.scene_rect.center();
            canvas.view.scene_rect = Rect::from_center_size(middle, size / scale);
        }
        frame(&mut canvas);
        let (vertices, work) = count(|| frame(&mut canvas));
        let zoom = canvas.scale();
        println!("300 nodes {name} (zoom {zoom:.2}): {vertices} vertices, {work:?}");
        assert!(vertices < 200_000 && work.asked < 20_000, "{name}: {vertices} vertices, {work:?}");
    }
}

/// Pictures for eyes: `COIF_PICTURES=folder cargo test -p coif --lib canvas::tests::pictures`.
#[test]
fn pictures() {
    let Some(folder) = std::env::var_os("COIF_PICTURES").map(std::path::PathBuf::from) else {
        return;
    };
    let file = |name: &str| folder.join(format!("canvas_{name}.png"));
    let mut w = window(document("cornrows"));
    w.state_mut().apply(Event::Select(Select::Nodes(vec![id("rows")])));
    let from = place(&w, "rows: curves output");
    let to = place(&w, "hair in the braids: scalp input");
    hold(&mut w, &[from, to], Modifiers::NONE);
    w.render().unwrap().save(file("refused")).unwrap();
    let mut w = window(document("braids"));
    let names: Vec<NodeId> = w.state().state.document.nodes.keys().cloned().collect();
    w.state_mut().apply(Event::Select(Select::Nodes(names[..3].to_vec())));
    let desk = w.state_mut();
    let said = [Canvas::frame_nodes, Canvas::collapse].map(|f| f(&mut desk.canvas, &desk.state));
    said.into_iter().flatten().for_each(|event| desk.apply(event));
    desk.canvas.memory.naming = None;
    desk.apply(Event::Select(Select::Nodes(vec![names[5].clone()])));
    let said =
        [Canvas::bypass, Canvas::display, Canvas::pin].map(|f| f(&mut desk.canvas, &desk.state));
    said.into_iter().flatten().for_each(|event| desk.apply(event));
    let links: Vec<Socket> = desk.state.document.links.keys().cloned().collect();
    let source = links.iter().find(|to| &*to.name == "source").unwrap();
    desk.apply(Event::Edit(edits::cut([Wire { to: source.clone(), at: 0 }])));
    w.run_steps(3);
    w.render().unwrap().save(file("marks")).unwrap();
    let mut w = sized(many(300), vec2(1280.0, 800.0));
    w.render().unwrap().save(file("far")).unwrap();
    let view = &mut w.state_mut().canvas.view;
    view.scene_rect = Rect::from_center_size(view.scene_rect.center(), vec2(1280.0, 800.0));
    w.run_steps(3);
    w.render().unwrap().save(file("near")).unwrap();
    let view = &mut w.state_mut().canvas.view;
    view.scene_rect = Rect::from_center_size(view.scene_rect.center(), 2.0 * vec2(1280.0, 800.0));
    w.run_steps(3);
    w.render().unwrap().save(file("half")).unwrap();
    let mut ui = editor(document("cornrows"));
    crate::widgets::theme::apply(&ui.ctx, egui::Theme::Dark, false);
    until("it is evaluated", || {
        ui.step();
        ui.state().is_idle()
    });
    ui.state_mut().apply(Event::Select(Select::Nodes(vec![id("braid")])));
    ui.state_mut().act("canvas.add");
    ui.run_steps(4);
    ui.render().unwrap().save(file("editor")).unwrap();
}

/// Footers, kinds and sockets are read at full size: nothing is smaller than 11 points there.
#[test]
fn text_on_nodes_is_large_enough_to_be_read_at_full_size() {
    let mut window = window(document("cornrows"));
    window.run_steps(3);
    let zoom = {
        let to = |x: f32| window.state().canvas.to_screen(Pos2::new(x, 0.0)).x;
        to(1.0) - to(0.0)
    };
    let mut least = f32::INFINITY;
    let mut texts = vec![];
    for shape in &window.output().shapes {
        if let egui::Shape::Text(text) = &shape.shape {
            let size = |section: &egui::text::LayoutSection| section.format.font_id.size;
            let sizes = text.galley.job.sections.iter().map(size);
            least = sizes.fold(least, f32::min);
            texts.push(text.galley.text().to_owned());
        }
    }
    assert!(texts.iter().any(|text| text == "not run yet"), "a footer: {texts:?}");
    // Letters are laid out in half points.
    assert!(least >= 11.0 * zoom - 0.26, "{least} at {zoom}");
}

#[test]
fn a_click_whose_press_and_release_come_within_one_frame_selects_as_any_does() {
    let mut w = window(document("cornrows"));
    let selected = |w: &Window| {
        let nodes = w.state().state.selection.nodes.iter();
        nodes.map(ToString::to_string).collect::<Vec<_>>()
    };
    for (name, node) in [("rows", "rows"), ("cornrows", "braid"), ("Head", "head")] {
        let at = place(&w, &format!("{name}: node")) - vec2(0.0, 22.0);
        click(&mut w, at, 1);
        assert_eq!(selected(&w), [node]);
        assert_eq!(w.state().state.active(), Some(&id(node)));
    }
    // With Ctrl one more, and off again; beside all nodes none.
    let (at, away) = (place(&w, "rows: node") - vec2(0.0, 22.0), nowhere(&w));
    for expected in [vec!["head", "rows"], vec!["head"]] {
        w.event(egui::Event::ModifiersChanged(CTRL));
        for pressed in [true, false] {
            let button = egui::PointerButton::Primary;
            w.event(egui::Event::PointerMoved(at));
            w.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers: CTRL });
        }
        w.run_steps(3);
        assert_eq!(selected(&w), expected);
    }
    w.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    w.run_steps(1);
    click(&mut w, away, 1);
    assert_eq!(selected(&w), Vec::<String>::new());
    steps(&w, 0);
}

#[test]
fn the_search_opens_at_the_pointer_and_what_it_adds_is_in_sight() {
    let mut w = window(document("cornrows"));
    w.state_mut().apply(crate::core::event::Event::Select(Select::Nodes(vec![id("braids_out")])));
    // So near that what comes behind the last node is out of sight.
    w.state_mut().canvas.see(pos2(700.0, 100.0), 1.0);
    let at = nowhere(&w);
    w.event(egui::Event::PointerMoved(at));
    w.run_steps(2);
    let Desk { state, canvas, .. } = w.state_mut();
    canvas.add(state);
    w.run_steps(2);
    let field = w.get_by_label("Search nodes").rect();
    assert!(field.left_top().distance(at) < 60.0 || field.bottom() < at.y, "{field:?} {at:?}");
    assert!((field.left() - at.x).abs() < 60.0, "{field:?} {at:?}");
    w.event(egui::Event::Text("waves".into()));
    w.run_steps(2);
    w.key_press(Key::Enter);
    w.run_steps(4);
    let desk = w.state();
    let added = desk.state.active().expect("a node").clone();
    let node = desk.state.document.node(added.as_str()).expect("it is there");
    let preset = coif_nodes::define::Value::Text("2a".into());
    let preset = coif_graphs::document::Setting::Known(preset);
    assert_eq!((node.kind.as_str(), node.inputs.get("preset")), ("shape_list_curl", Some(&preset)));
    let rect = faces(&desk.state.document).rect(&added).expect("a place");
    let seen = desk.canvas.seen();
    assert!(seen.contains_rect(rect), "{rect:?} is beyond {seen:?}");
}

#[test]
fn nodes_are_grouped_entered_left_and_taken_apart() {
    let mut w = window(document("cornrows"));
    let before = w.state().state.document.clone();
    let act = |w: &mut Window, act: fn(&mut Canvas, &State) -> Vec<Event>| {
        let desk = w.state_mut();
        for event in act(&mut desk.canvas, &desk.state) {
            desk.apply(event);
        }
        w.run_steps(3);
    };
    w.state_mut().apply(Event::Select(Select::Nodes(vec![id("rows"), id("braid")])));
    act(&mut w, Canvas::group);
    assert_eq!(w.state().said, Vec::<String>::new());
    steps(&w, 1);
    // Its name is asked for at once.
    w.event(egui::Event::Text("Row".into()));
    w.run_steps(2);
    w.key_press(Key::Enter);
    w.run_steps(3);
    assert_eq!(w.state().state.document.name_of(&id("group")), "Row");
    assert!(w.query_by_label("Row: curves output").is_some());
    assert!(w.query_by_label("cornrows: source input").is_none(), "it is in the group");
    // A double click shows what is in it, with its border; nodes that are added then are in it.
    let title = place(&w, "Row: node");
    click(&mut w, title, 2);
    assert_eq!(w.state().state.group, Some(id("group")));
    for name in ["cornrows: source input", "Inputs: scalp output", "Outputs: curves input", "Groom"]
    {
        assert!(w.query_by_label(name).is_some(), "{name}");
    }
    w.state_mut().apply(Event::Select(Select::Nodes(vec![id("group/rows")])));
    act(&mut w, Canvas::duplicate);
    assert!(w.state().state.document.nodes.contains_key(&id("group/rows_2")));
    act(&mut w, Canvas::select_all);
    let inside = |id: &NodeId| id.group().is_some_and(|group| group.as_str() == "group");
    assert!(w.state().state.selection.nodes.iter().all(inside));
    // The way back, and apart again.
    w.get_by_label("Groom").click();
    w.run_steps(3);
    assert_eq!(w.state().state.group, None);
    w.state_mut().apply(Event::Select(Select::Nodes(vec![id("group")])));
    act(&mut w, Canvas::ungroup);
    let document = &w.state().state.document;
    assert_eq!(
        document.links.get(&socket("braid.source")),
        before.links.get(&socket("braid.source"))
    );
    assert_eq!(document.nodes["braid"], before.nodes["braid"]);
    assert!(
        document.nodes.contains_key(&id("rows_2")) && !document.nodes.contains_key(&id("group"))
    );
}
