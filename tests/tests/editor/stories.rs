//! Stories of the whole window: every entry of every menu, and a slider that is dragged.

use super::harness::{SIZE, Ui, is_sound, on, on_groom, settle};
use coif::core::event::Event;
use coif::core::notes::Notes;
use coif::core::state::Select;
use coif::editor::actions::{self, MENUS};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Point};
use coif_graphs::{file, grooms};
use egui::{Event as Input, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::kittest::{By, NodeT, Queryable};

fn node(id: &str) -> NodeId {
    NodeId::new(id).expect("an id")
}

/// All that a person could see or read: the words on the screen, and what the state holds.
fn words(ui: &Ui) -> Vec<String> {
    ui.query_all(By::new()).filter_map(|node| node.accesskit_node().label()).collect()
}
fn sight(ui: &Ui) -> String {
    let editor = ui.state();
    let (state, words) = (&editor.state, words(ui));
    let camera = editor.viewport.camera();
    format!(
        "{words:?} {} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {camera:?} {:?} {:?}",
        state.changes,
        state.selection,
        state.pinned,
        state.document.display,
        state.focus,
        state.visibility,
        state.settings,
        state.notes.all(),
        editor.viewport.options,
        editor.pen.tool,
    )
}

/// Presses what has a name, as a mouse does.
fn click(ui: &mut Ui, name: &str) -> bool {
    // Entries of menus carry their keys behind their words.
    let named = |label: &str| {
        label == name || label.strip_prefix(name).is_some_and(|keys| keys.starts_with(' '))
    };
    // A menu that is taller than the window scrolls.
    let place = |ui: &Ui| {
        let mut all = ui.query_all(By::new());
        let found =
            all.find(|node| node.accesskit_node().label().is_some_and(|label| named(&label)))?;
        let rect = found.rect();
        let hidden = rect.bottom() > SIZE.y - 2.0 * rect.height();
        if hidden {
            found.scroll_to_me();
        }
        Some((rect.center(), hidden))
    };
    let Some((mut at, hidden)) = place(ui) else { return false };
    if hidden {
        ui.run_steps(6);
        let Some((now, _)) = place(ui) else { return false };
        at = now;
    }
    for pressed in [true, false] {
        ui.event(Input::PointerMoved(at));
        ui.step();
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        ui.event(Input::PointerButton { pos: at, button, pressed, modifiers });
        ui.step();
    }
    ui.run_steps(2);
    true
}

/// The braids of cornrows without the hair in them.
fn few_braids() -> Document {
    let text = grooms::by_name("cornrows").expect("a shipped groom");
    let mut document = file::read(text).expect("it reads").document;
    let kept = ["head", "rows", "braid"];
    let gone: Vec<NodeId> =
        document.nodes.keys().filter(|id| !kept.contains(&id.as_str())).cloned().collect();
    for id in gone {
        Edit::RemoveNode { id }.apply(&mut document).expect("it is there");
    }
    document
}

/// Entries whose work cannot be seen in the state, each with where it shows instead.
const UNSEEN: &[&str] = &[
    // The clipboard, and what is drawn on the canvas.
    "canvas.copy",
    "canvas.fit_all",
    "canvas.fit_selection",
    // They do nothing where there is nothing of theirs: no run to stop, no step of the view behind.
    "evaluate.stop",
    "evaluate.now",
    "file.save",
    "view.frame_all",
    "view.frame_selected",
    // The window itself, which tests have none of.
    "file.close",
];

#[test]
fn every_entry_of_every_menu_does_something_or_says_why_not() {
    let entries: Vec<_> = actions::all().filter(|action| !action.menu.is_empty()).collect();
    assert!(entries.len() > 60, "{} entries", entries.len());
    let mut could = 0;
    let mut idle = vec![];
    // The same groom for each, with little hair: nodes that are selected, and one step that can be taken back. Making an editor takes
    // longer than what it is made for, so what an entry left as it was serves the next.
    let editor = || {
        let mut ui = on(few_braids());
        ui.state_mut().documents.ask_in_the_window();
        ui.state_mut().apply(Event::Select(Select::Nodes(vec![node("rows"), node("braid")])));
        ui.state_mut().apply(Event::Edit(Edit::SetTitle("a".into())));
        settle(&mut ui);
        ui
    };
    let mut ui = editor();
    let state = |ui: &Ui| {
        let state = &ui.state().state;
        (state.document.clone(), state.selection.clone(), state.focus, state.group.clone())
    };
    let (started, there) = (state(&ui), words(&ui));
    let mut made = 1;
    for action in &entries {
        assert!(MENUS.contains(&action.menu), "{}: there is no menu {}", action.id, action.menu);
        assert!(click(&mut ui, action.menu), "the menu {}", action.menu);
        if let Some(group) = action.group() {
            assert!(click(&mut ui, group), "{}: the menu {group}", action.id);
        }
        let before = sight(&ui);
        assert!(click(&mut ui, action.label), "{}: its menu does not show it", action.id);
        ui.run_steps(3);
        let allowed = action.when(ui.state());
        let seen = sight(&ui) != before;
        if allowed.is_ok() {
            could += 1;
            if !seen && !UNSEEN.contains(&action.id) {
                idle.push(action.id);
            }
        }
        is_sound(&ui.state().state.document);
        ui.state_mut().state.notes = Notes::default();
        ui.key_press(Key::Escape);
        ui.run_steps(3);
        if state(&ui) != started || words(&ui) != there {
            (ui, made) = (editor(), made + 1);
        }
    }
    assert!(idle.is_empty(), "these change nothing: {idle:?}");
    println!("{} entries, {could} of them possible on this groom, {made} editors", entries.len());
}

#[test]
fn labels_and_tips_of_actions_are_sentences_and_ids_are_unique() {
    let mut ids = std::collections::BTreeSet::new();
    for action in actions::all() {
        assert!(ids.insert(action.id), "{} is there twice", action.id);
        assert!(
            !action.tip.is_empty() && action.tip.ends_with('.'),
            "{}: {}",
            action.id,
            action.tip
        );
        let words: Vec<&str> = action.label.split(' ').collect();
        let capital = |word: &&&str| word.chars().next().is_some_and(char::is_uppercase);
        let title_case = words.iter().skip(1).filter(capital).count();
        assert!(title_case == 0, "{}: {} is in title case", action.id, action.label);
    }
}

#[test]
fn a_slider_that_is_dragged_runs_only_what_hangs_from_it_and_is_one_step() {
    let mut ui = on_groom("cornrows");
    settle(&mut ui);
    ui.state_mut().apply(Event::Select(Select::Nodes(vec![node("fill")])));
    settle(&mut ui);
    let before = ui.state().state.document.clone();
    let field = |ui: &Ui| {
        let fields = ui.query_all_by_label("Frizz");
        fields.max_by(|a, b| a.rect().right().total_cmp(&b.rect().right())).map(|node| {
            node.scroll_to_me();
            node.rect()
        })
    };
    // It may lie below what the inspector has room for.
    field(&ui).expect("the inspector has frizz");
    ui.run_steps(8);
    let rect = field(&ui).expect("the inspector shows frizz");
    let from = Pos2::new(rect.left() + 12.0, rect.center().y);
    ui.event(Input::PointerMoved(from));
    ui.step();
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    ui.event(Input::PointerButton { pos: from, button, pressed: true, modifiers });
    ui.step();
    for k in 1..=10 {
        ui.event(Input::PointerMoved(from + Vec2::new(6.0 * k as f32, 0.0)));
        ui.step();
        assert!(k < 3 || ui.state().state.gesture, "a drag is a gesture");
    }
    let to = from + Vec2::new(60.0, 0.0);
    ui.event(Input::PointerButton { pos: to, button, pressed: false, modifiers });
    settle(&mut ui);
    let state = &ui.state().state;
    assert_ne!(state.document, before, "the slider moved");
    assert_eq!(state.history.done(), 1, "one step");
    let ran: Vec<&str> = state
        .run
        .reports
        .nodes
        .iter()
        .filter(|(_, report)| !report.cached && report.tufts_run > 0)
        .map(|(id, _)| id.as_str())
        .collect();
    assert_eq!(ran, ["colour", "fill", "fill_width"], "and what only passes hair on");
    ui.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut ui);
    assert_eq!(ui.state().state.document, before);
}

#[test]
fn moving_a_node_on_the_canvas_evaluates_nothing_and_is_one_step() {
    let mut ui = on_groom("cornrows");
    settle(&mut ui);
    let shown = ui.state().state.shown.clone().expect("hair");
    let editor = ui.state_mut();
    let at = |x: f32| Edit::Move { id: node("braid"), to: Some(Point(x, 50.0)) };
    editor.apply(Event::Begin(String::new()));
    for k in 0..5 {
        ui.state_mut().apply(Event::Edit(at(k as f32 * 10.0)));
        ui.run_steps(3);
        let state = &ui.state().state;
        assert!(state.gesture && !state.stale() && ui.state().is_idle());
    }
    ui.state_mut().apply(Event::End);
    settle(&mut ui);
    let state = &ui.state().state;
    assert!(std::sync::Arc::ptr_eq(&shown, state.shown.as_ref().expect("hair")));
    assert_eq!(state.history.done(), 1);
}
