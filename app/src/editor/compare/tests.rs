//! Two documents side by side, driven as hands drive them.

use crate::core::documents::Purpose;
use crate::core::event::Event;
use crate::core::notes::Gravity;
use crate::core::room::Room;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::testing::{Folder, until};
use coif_graphs::compare::lines;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting, Socket};
use coif_graphs::{file, grooms};
use coif_nodes::define::Value;
use egui::{Event as Input, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

type Ui = Harness<'static, Editor>;

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

fn cornrows() -> Document {
    let mut document = file::read(grooms::by_name("cornrows").unwrap()).unwrap().document;
    // Braids alone are quickly made.
    for gone in ["colour", "fill", "out"] {
        if document.nodes.contains_key(gone) {
            Edit::RemoveNode { id: id(gone) }.apply(&mut document).unwrap();
        }
    }
    document
}

/// What somebody else made of it.
fn theirs() -> Document {
    let mut document = cornrows();
    let setting = Setting::Known(Value::Int(4));
    let strands = Edit::SetInput { node: id("braid"), input: "strands".to_owned(), setting };
    let added = document.fresh_node("merge", &id("more"));
    document.nodes.insert(id("more"), added.into());
    let wires = Edit::SetWires {
        to: Socket::new(id("more"), "curves"),
        from: vec![Socket::new(id("braid"), "curves")],
    };
    for edit in [strands, wires, Edit::SetDisplay(Some(id("braid")))] {
        edit.apply(&mut document).unwrap();
    }
    document
}

fn on(document: Document, file: OpenFile) -> Ui {
    let mut editor = Editor::new(&egui::Context::default(), document, file);
    editor.documents.ask_in_the_window();
    let mut ui = Harness::builder()
        .with_size(egui::vec2(1440.0, 900.0))
        .with_max_steps(64)
        .build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor);
    ui.run_steps(3);
    ui
}

/// An editor that compares its groom with another's file.
fn compared(folder: &Folder) -> Ui {
    let path = folder.path("theirs.ron");
    std::fs::write(&path, file::write(&theirs())).unwrap();
    let mut ui = on(cornrows(), OpenFile::default());
    ui.state_mut().compare_with(&path);
    until("all is evaluated", || {
        ui.step();
        ui.state().is_idle()
    });
    ui.run_steps(3);
    ui
}

fn press_at(ui: &mut Ui, at: Pos2, button: PointerButton) {
    ui.event(Input::PointerMoved(at));
    ui.run_steps(2);
    for pressed in [true, false] {
        ui.event(Input::PointerButton { pos: at, button, pressed, modifiers: Modifiers::NONE });
        ui.run_steps(1);
    }
    ui.run_steps(2);
}

#[track_caller]
fn press(ui: &mut Ui, label: &str) {
    let at = ui.get_all_by_label(label).next().unwrap().rect().center();
    press_at(ui, at, PointerButton::Primary);
}

/// All that a document of one's own and its history say.
fn all(ui: &Ui) -> (String, usize, bool) {
    let state = &ui.state().state;
    (file::write(&state.document), state.history.steps().count(), state.history.is_changed())
}

#[test]
fn what_differs_is_told_as_the_command_line_tells_it() {
    let folder = Folder::new("compare-words");
    let mut ui = compared(&folder);
    let told: Vec<String> = ui.state().compare().unwrap().lines().map(str::to_owned).collect();
    assert_eq!(told, lines(&cornrows(), &theirs(), true));
    assert!(told.iter().any(|line| line.contains("strands")), "{told:?}");
    // What one does meanwhile is told as it is done.
    let strands = Setting::Known(Value::Int(4));
    let edit = Edit::SetInput { node: id("braid"), input: "strands".to_owned(), setting: strands };
    ui.state_mut().apply(Event::Edit(edit));
    ui.run_steps(3);
    let now: Vec<&str> = ui.state().compare().unwrap().lines().collect();
    assert_eq!(now.len() + 1, told.len(), "{now:?}");
    press(&mut ui, "End");
    assert!(ui.state().compare().is_none());
}

#[test]
fn a_line_that_is_pressed_shows_its_node_on_both_canvases() {
    let folder = Folder::new("compare-line");
    let mut ui = compared(&folder);
    let line = lines(&cornrows(), &theirs(), true);
    let strands = line.iter().find(|line| line.contains("strands")).unwrap().clone();
    press(&mut ui, &strands);
    assert_eq!(ui.state().state.selection.active, Some(id("braid")));
    let room = ui.state().place_of(Room::Canvas).unwrap();
    let editor = ui.state_mut();
    let compare = editor.compare.as_mut().unwrap();
    assert_eq!(compare.other.selection.active, Some(id("braid")));
    let mine = editor.canvas.place(&editor.state, &id("braid")).unwrap();
    let places = [editor.canvas.to_screen(mine.center()), compare.canvas.to_screen(mine.center())];
    assert!(places.iter().all(|at| room.contains(*at)), "{places:?} in {room:?}");
    assert!(places[1].x - places[0].x > 100.0, "one beside the other: {places:?}");
    // A node that only the other has is shown there, and one's own selection is empty.
    let added = line.iter().find(|line| line.contains("added (Merge)")).unwrap().clone();
    press(&mut ui, &added);
    let editor = ui.state();
    assert!(editor.state.selection.nodes.is_empty());
    assert_eq!(editor.compare().unwrap().other.selection.active, Some(id("more")));
}

#[test]
fn both_canvases_are_moved_together() {
    let folder = Folder::new("compare-pan");
    let mut ui = compared(&folder);
    let at = |ui: &Ui| {
        let editor = ui.state();
        [&editor.canvas, &editor.compare().unwrap().canvas].map(|c| c.to_screen(Pos2::ZERO))
    };
    let apart = |[a, b]: [Pos2; 2]| b - a;
    let room = ui.state().place_of(Room::Canvas).unwrap();
    let before = at(&ui);
    for side in [0.2, 0.5] {
        let over = room.lerp_inside(Vec2::new(side, 0.5));
        ui.event(Input::PointerMoved(over));
        ui.run_steps(2);
        for (unit, delta) in [
            (egui::MouseWheelUnit::Point, Vec2::new(30.0, -40.0)),
            (egui::MouseWheelUnit::Line, Vec2::new(0.0, 2.0)),
        ] {
            let (modifiers, phase) = (Modifiers::NONE, egui::TouchPhase::Move);
            ui.event(Input::MouseWheel { unit, delta, modifiers, phase });
            ui.run_steps(20);
        }
        let now = at(&ui);
        assert!((apart(now) - apart(before)).length() < 1.0, "{before:?} {now:?}");
        assert!(now[0].distance(before[0]) > 5.0, "it was moved: {before:?} {now:?}");
    }
}

#[test]
fn nothing_that_is_done_to_the_other_changes_anything() {
    let folder = Folder::new("compare-hands");
    let mut ui = compared(&folder);
    let (before, document) = (all(&ui), ui.state().compare().unwrap().document.clone());
    let places: Vec<Pos2> = {
        let compare = ui.state_mut().compare.as_mut().unwrap();
        let nodes: Vec<NodeId> = compare.document.nodes.keys().cloned().collect();
        let rects = nodes.iter().filter_map(|id| compare.canvas.place(&compare.other, id));
        let corners = rects.flat_map(|rect| {
            [rect.center(), rect.left_center(), rect.right_top() + Vec2::new(-14.0, 13.0)]
        });
        corners.collect::<Vec<_>>().into_iter().map(|at| compare.canvas.to_screen(at)).collect()
    };
    for at in places {
        for button in [PointerButton::Primary, PointerButton::Secondary] {
            press_at(&mut ui, at, button);
            ui.key_press(Key::Escape);
            ui.run_steps(2);
        }
        // Dragged, pressed twice, and with keys.
        for (pressed, off) in [(true, 0.0), (true, 40.0), (false, 40.0)] {
            let pos = at + Vec2::splat(off);
            ui.event(Input::PointerMoved(pos));
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            if off == 0.0 || !pressed {
                ui.event(Input::PointerButton { pos, button, pressed, modifiers });
            }
            ui.run_steps(2);
        }
        press_at(&mut ui, at, PointerButton::Primary);
        press_at(&mut ui, at, PointerButton::Primary);
        assert!(!ui.state().canvas.types(), "nothing opens");
    }
    assert_eq!(all(&ui), before);
    assert_eq!(ui.state().compare().unwrap().document, document);
    assert_eq!(ui.state().compare().unwrap().other.document, document);
}

#[test]
fn its_hair_is_shown_in_place_and_ones_own_comes_back() {
    let folder = Folder::new("compare-flip");
    let mut ui = compared(&folder);
    let before = all(&ui);
    let mine = ui.state().state.shown.clone().unwrap();
    let camera = *ui.state().viewport.camera();
    ui.get_by_label("Shown: yours");
    ui.key_press(Key::F8);
    ui.run_steps(3);
    ui.get_by_label("Shown: theirs.ron");
    let compare = ui.state().compare().unwrap();
    let shown = compare.flipped().expect("it was made").shown.clone().unwrap();
    assert_ne!(shown.curves.point_count(), mine.curves.point_count(), "four strands, not three");
    assert_eq!(*ui.state().viewport.camera(), camera);
    // What is done to the picture does nothing to one's own, and the light is one's own.
    let middle = ui.state().place_of(Room::Viewport).unwrap().center();
    for button in [PointerButton::Primary, PointerButton::Secondary] {
        press_at(&mut ui, middle, button);
    }
    assert_eq!(all(&ui), before);
    assert!(ui.state().state.selection.curves.is_empty());
    assert!(std::sync::Arc::ptr_eq(ui.state().state.shown.as_ref().unwrap(), &mine));
    press(&mut ui, "Shown: theirs.ron");
    ui.get_by_label("Shown: yours");
    assert!(ui.state().compare().unwrap().flipped().is_none());
}

/// Pictures on the screen, by the parts of the screen that they are seen in.
fn pictures(ui: &Ui) -> Vec<egui::Rect> {
    let room = ui.state().place_of(Room::Viewport).unwrap();
    let shapes = ui.output().shapes.iter();
    let seen = shapes.filter_map(|shape| match &shape.shape {
        egui::Shape::Rect(rect) if rect.brush.is_some() => Some(shape.clip_rect.intersect(room)),
        egui::Shape::Mesh(mesh) if mesh.texture_id != egui::TextureId::default() => {
            Some(shape.clip_rect.intersect(room))
        }
        _ => None,
    });
    seen.filter(|seen| seen.is_positive()).collect()
}

/// Both pictures at rest, in a small window.
fn drawn(folder: &Folder) -> Option<Ui> {
    if let Err(err) = coif_shaders::Gpu::new(coif_shaders::Precision::Best) {
        println!("skipped: comparing pictures: {err}");
        return None;
    }
    let mut ui = compared(folder);
    ui.set_size(egui::vec2(960.0, 640.0));
    let ctx = ui.ctx.clone();
    let editor = ui.state_mut();
    editor.state.settings.samples = 2;
    editor.viewport.start(&ctx);
    editor.act("compare.wipe");
    rest(&mut ui);
    Some(ui)
}

fn rest(ui: &mut Ui) {
    until("both pictures are drawn", || {
        ui.step();
        assert_eq!(ui.state().viewport.fault(), None);
        ui.state().is_idle() && ui.state().viewport.is_idle()
    });
    ui.run_steps(3);
}

#[test]
fn no_way_to_show_both_begins_a_picture_anew() {
    let folder = Folder::new("compare-sides");
    let Some(mut ui) = drawn(&folder) else { return };
    let made = ui.state().viewport.stats.pictures;
    assert!(made >= 2, "{made} pictures of two grooms");
    for way in ["compare.beside", "compare.flip", "compare.flip", "compare.wipe", "compare.beside"]
    {
        ui.state_mut().act(way);
        rest(&mut ui);
        let now = ui.state().viewport.stats.pictures;
        assert_eq!(now, made, "{way} draws again");
        let seen = pictures(&ui).len();
        assert_eq!(seen, if way == "compare.flip" { 1 } else { 2 }, "{way}");
    }
    // The camera is one, also under the other picture: what moves it draws both again.
    let at = ui.state().place_of(Room::Viewport).unwrap().lerp_inside(Vec2::new(0.75, 0.5));
    ui.event(Input::PointerMoved(at));
    ui.run_steps(2);
    let (unit, delta) = (egui::MouseWheelUnit::Line, Vec2::new(0.0, 3.0));
    let (modifiers, phase) = (Modifiers::NONE, egui::TouchPhase::Move);
    let before = *ui.state().viewport.camera();
    ui.event(Input::MouseWheel { unit, delta, modifiers, phase });
    ui.run_steps(30);
    rest(&mut ui);
    assert_ne!(*ui.state().viewport.camera(), before, "the wheel over the other picture");
    assert!(ui.state().viewport.stats.pictures >= made + 2);
    ui.state_mut().act("compare.end");
    ui.run_steps(3);
    assert_eq!(pictures(&ui).len(), 1);
}

#[test]
fn the_divider_of_a_wipe_is_dragged_and_nothing_else_is() {
    let folder = Folder::new("compare-wipe");
    let mut ui = compared(&folder);
    ui.state_mut().act("compare.wipe");
    ui.run_steps(3);
    ui.get_by_label("Shown: yours and theirs.ron");
    let (before, camera) = (all(&ui), *ui.state().viewport.camera());
    let room = ui.state().place_of(Room::Viewport).unwrap();
    let divider = |ui: &Ui| ui.get_by_label("Divider between the two grooms").rect().center();
    let from = divider(&ui);
    assert!((from.x - room.center().x).abs() < 2.0, "{from:?} in {room:?}");
    let to = from - Vec2::new(80.0, 0.0);
    for (pos, pressed) in [(from, Some(true)), (to, None), (to, Some(false))] {
        ui.event(Input::PointerMoved(pos));
        ui.run_steps(2);
        if let Some(pressed) = pressed {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            ui.event(Input::PointerButton { pos, button, pressed, modifiers });
        }
        ui.run_steps(2);
    }
    assert!((divider(&ui).x - to.x).abs() < 2.0, "{:?} {to:?}", divider(&ui));
    assert_eq!((all(&ui), *ui.state().viewport.camera()), (before, camera));
    // One's own hair is under the hand at its left alone.
    let part = ui.state().viewport.part();
    assert!((part.right() - to.x).abs() < 2.0, "{part:?}");
    for (side, is_own) in [(-60.0, true), (60.0, false)] {
        ui.event(Input::PointerMoved(to + Vec2::new(side, 0.0)));
        ui.run_steps(2);
        assert_eq!(ui.state().viewport.is_hovered(), is_own, "{side}");
    }
}

#[test]
fn what_both_have_is_made_once() {
    let folder = Folder::new("compare-once");
    let ui = compared(&folder);
    let reports = &ui.state().compare().unwrap().other.run.reports.nodes;
    let cached = |node: &str| reports[&id(node)].cached;
    assert!(cached("head") && cached("rows"), "{:?}", reports.keys());
    assert!(!cached("braid"), "it has four strands");
}

#[test]
fn what_cannot_be_read_is_told_and_nothing_changes() {
    let folder = Folder::new("compare-broken");
    let broken = folder.path("broken.ron");
    std::fs::write(&broken, "(format: 3, nodes: {").unwrap();
    for path in [folder.path("none.ron"), broken, folder.root().to_owned()] {
        let mut ui = on(cornrows(), OpenFile::default());
        let before = all(&ui);
        ui.state_mut().compare_with(&path);
        ui.run_steps(3);
        let editor = ui.state();
        let said = editor.state.notes.all().last().expect("it is told");
        let name = path.file_name().unwrap().to_string_lossy();
        assert!(said.gravity == Gravity::Error && said.text.contains(&*name), "{said:?}");
        assert!(editor.compare().is_none());
        assert_eq!(all(&ui), before);
    }
}

#[test]
fn what_was_saved_is_compared_with_what_was_made_of_it() {
    let folder = Folder::new("compare-saved");
    let path = folder.path("mine.ron");
    let mut ui = on(cornrows(), OpenFile::default());
    ui.state_mut().act("compare.saved");
    assert!(ui.state().compare().is_none(), "there is no file yet");
    ui.state_mut().apply(Event::Documents(crate::core::documents::DocumentEvent::SaveTo(path)));
    let setting = Setting::Known(Value::Int(5));
    let edit = Edit::SetInput { node: id("braid"), input: "strands".to_owned(), setting };
    ui.state_mut().apply(Event::Edit(edit));
    ui.state_mut().act("compare.saved");
    ui.run_steps(3);
    let told: Vec<&str> = ui.state().compare().unwrap().lines().collect();
    assert!(told.len() == 1 && told[0].ends_with("strands 3 to 5"), "{told:?}");
    // Another document is none to compare with.
    ui.state_mut().apply(Event::Edit(Edit::SetTitle("x".to_owned())));
    ui.state_mut().apply(Event::Documents(crate::core::documents::DocumentEvent::New(None)));
    ui.state_mut().apply(Event::Documents(crate::core::documents::DocumentEvent::Unsaved(
        crate::core::documents::Unsaved::Discard,
    )));
    ui.run_steps(2);
    assert!(ui.state().compare().is_none());
}

#[test]
fn a_file_is_asked_for() {
    let mut ui = on(cornrows(), OpenFile::default());
    ui.state_mut().act("compare.file");
    ui.run_steps(2);
    ui.get_by_label(Purpose::Compare.title());
}
