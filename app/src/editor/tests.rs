//! The whole window under a pointer and keys: where keys go, what Escape closes, what stays where it is.

use super::Editor;
use crate::core::event::Event;
use crate::core::room::Room;
use crate::core::state::{OpenFile, Select};
use crate::places::Places;
use crate::testing::{Folder, until};
use coif_graphs::document::{Document, NodeId};
use coif_graphs::{file, grooms, text};
use egui::{Event as Input, Key, Modifiers, PointerButton, Pos2, Rect, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{By, NodeT, Queryable};

/// An editor in a window that nobody sees, with hands on it.
pub(crate) struct Hands(pub(crate) Harness<'static, Editor>);

pub(crate) fn groom(name: &str) -> Document {
    file::read(grooms::by_name(name).unwrap()).unwrap().document
}

/// A head, and rows on it that nobody braids.
fn rows() -> Document {
    let mut document = groom("cornrows");
    for id in document.nodes.keys().cloned().collect::<Vec<_>>() {
        if !["head", "rows"].contains(&id.as_str()) {
            coif_graphs::document::edit::Edit::RemoveNode { id }.apply(&mut document).unwrap();
        }
    }
    document
}

impl Hands {
    pub(crate) fn on(document: Document, [width, height]: [f32; 2], scale: f32) -> Self {
        let mut editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
        editor.state.settings.scale = scale;
        let size = Vec2::new(width, height);
        let mut builder = Harness::builder().with_size(size).with_max_steps(64);
        // Pictures are drawn where they are asked for.
        if std::env::var_os("COIF_SHOTS").is_some() {
            builder = builder.wgpu();
        }
        let mut hands =
            Self(builder.build_ui_state(|ui, editor: &mut Editor| editor.ui(ui), editor));
        crate::widgets::theme::apply(&hands.0.ctx, egui::Theme::Dark, false);
        hands.steps(3);
        hands
    }
    pub(crate) fn steps(&mut self, n: usize) {
        self.0.run_steps(n);
    }
    pub(crate) fn editor(&mut self) -> &mut Editor {
        self.0.state_mut()
    }
    pub(crate) fn room(&self, room: Room) -> Rect {
        let rooms = &self.0.state().rooms;
        rooms.iter().find(|(known, _)| *known == room).map(|(_, rect)| *rect).unwrap()
    }
    pub(crate) fn hover(&mut self, at: Pos2) {
        self.0.event(Input::PointerMoved(at));
        self.steps(2);
    }
    fn click_with(&mut self, at: Pos2, button: PointerButton) {
        self.hover(at);
        for pressed in [true, false] {
            let modifiers = Modifiers::NONE;
            self.0.event(Input::PointerButton { pos: at, button, pressed, modifiers });
            self.steps(1);
        }
        self.steps(2);
    }
    pub(crate) fn click(&mut self, at: Pos2) {
        self.click_with(at, PointerButton::Primary);
    }
    pub(crate) fn key(&mut self, key: Key) {
        self.0.key_press(key);
        self.steps(2);
    }
    pub(crate) fn wheel(&mut self, delta: Vec2) {
        self.0.event(Input::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta,
            modifiers: Modifiers::NONE,
            phase: egui::TouchPhase::Move,
        });
        self.steps(12);
    }
    fn keys(&mut self, modifiers: Modifiers, key: Key) {
        self.0.key_press_modifiers(modifiers, key);
        self.steps(2);
    }
    /// Letters as a keyboard sends them, all in one frame.
    pub(crate) fn types(&mut self, letters: &str) {
        for c in letters.chars() {
            if let Some(key) = Key::from_name(&c.to_uppercase().to_string()) {
                let (physical_key, repeat, modifiers) = (None, false, Modifiers::NONE);
                self.0.event(Input::Key { key, physical_key, pressed: true, repeat, modifiers });
            }
            self.0.event(Input::Text(c.to_string()));
        }
        self.steps(2);
    }
    /// Where something with these words is; menus carry keys behind theirs.
    pub(crate) fn place(&self, words: &str) -> Option<Rect> {
        let is = |label: &str| {
            label == words || label.strip_prefix(words).is_some_and(|keys| keys.starts_with(' '))
        };
        let mut found = self.0.query_all(By::new());
        let says = |node: egui_kittest::kittest::AccessKitNode| {
            // What a label says is its value.
            node.label().is_some_and(|label| is(&label))
                || node.value().is_some_and(|value| is(&value))
        };
        found.find(|node| says(node.accesskit_node())).map(|node| node.rect())
    }
    #[track_caller]
    pub(crate) fn click_on(&mut self, words: &str) {
        let at = self.place(words).unwrap_or_else(|| panic!("nothing is called {words:?}"));
        self.click(at.center());
    }
    pub(crate) fn shows(&self, words: &str) -> bool {
        self.place(words).is_some()
    }
}

mod sizes;

const SIZE: [f32; 2] = [1440.0, 900.0];

fn empty(rect: Rect) -> Pos2 {
    rect.right_bottom() - Vec2::new(30.0, 40.0)
}

#[test]
fn keys_go_where_the_pointer_is() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let (viewport, canvas) = (hands.room(Room::Viewport), hands.room(Room::Canvas));
    // The canvas was clicked last; P over the picture is the pen, not the pin of a node.
    hands.click(empty(canvas));
    hands.hover(viewport.center());
    hands.key(Key::P);
    assert_eq!(hands.editor().pen.tool, crate::rooms::pen::PenTool::Draw);
    assert!(hands.editor().state.notes.all().is_empty());
    // The picture was clicked last; Tab over the nodes adds one.
    hands.keys(Modifiers::NONE, Key::V);
    hands.click(viewport.center());
    hands.hover(empty(canvas));
    hands.key(Key::Tab);
    assert!(hands.editor().canvas.searches(), "Tab opens the search");
    hands.key(Key::Escape);
    // In one frame too, as long frames have it.
    hands.hover(viewport.center());
    hands.0.event(Input::PointerMoved(empty(canvas)));
    hands.key(Key::Tab);
    assert!(hands.editor().canvas.searches(), "the pointer and the key came together");
    hands.key(Key::Escape);
    // What is dragged out of a room keeps the keys; a pointer at rest leaves them to F6.
    hands.hover(viewport.center());
    hands.key(Key::F6);
    let led = hands.editor().state.focus;
    assert_ne!(led, Room::Viewport);
    hands.steps(3);
    assert_eq!(hands.editor().state.focus, led);
}

#[test]
fn escape_closes_the_topmost_thing_and_nothing_typed_behind_it_reaches_that() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let canvas = hands.room(Room::Canvas);
    let nodes = |hands: &mut Hands| hands.editor().state.document.nodes.len();
    let before = nodes(&mut hands);
    // The search, also with letters in it.
    hands.hover(empty(canvas));
    hands.key(Key::Tab);
    hands.types("brai");
    assert!(hands.shows("Lissajous braid"));
    hands.key(Key::Escape);
    assert!(!hands.editor().canvas.searches());
    hands.types("merge");
    hands.key(Key::Enter);
    assert_eq!(nodes(&mut hands), before);
    // Escape and what follows in one frame.
    hands.keys(Modifiers::COMMAND, Key::K);
    assert!(hands.editor().palette.is_open());
    hands.0.key_press(Key::Escape);
    hands.types("x");
    assert!(!hands.editor().palette.is_open());
    // Panels, the one in front first.
    hands.keys(Modifiers::COMMAND, Key::Comma);
    hands.key(Key::F1);
    hands.editor().act("pen.settings");
    hands.editor().act("file.recent");
    hands.steps(3);
    let front = hands.place("Settings").unwrap().center();
    hands.click(front);
    let open = |hands: &mut Hands| {
        let editor = hands.editor();
        [
            editor.settings_panel.is_open,
            editor.documents.shows_welcome(),
            editor.pen.settings_open,
            editor.key_sheet,
        ]
    };
    assert_eq!(open(&mut hands), [true; 4]);
    let mut left = 4;
    while left > 0 {
        hands.key(Key::Escape);
        left -= 1;
        let open = open(&mut hands);
        assert_eq!(open.iter().filter(|open| **open).count(), left, "{open:?}");
        assert!(!open[0], "what was clicked last goes first");
    }
    // The last Escape has nothing left to close, and a field is left before its panel.
    hands.keys(Modifiers::COMMAND, Key::Comma);
    let field = hands.place("Samples of a still").unwrap();
    let samples = hands.0.query_all_by_value("32").next().map(|node| node.rect().center());
    hands.click(samples.unwrap_or(field.right_center() + Vec2::new(40.0, 0.0)));
    assert!(hands.0.ctx.text_edit_focused(), "a number is typed");
    hands.key(Key::Escape);
    assert!(hands.editor().settings_panel.is_open);
    hands.key(Key::Escape);
    assert!(!hands.editor().settings_panel.is_open);
}

#[test]
fn panels_and_menus_leave_the_menu_bar_free_and_are_reached_whole() {
    for (size, scale) in [
        ([1280.0, 720.0], 0.75),
        ([1280.0, 720.0], 2.0),
        ([1600.0, 1000.0], 1.0),
        ([1600.0, 1000.0], 2.0),
        ([320.0, 240.0], 1.0),
        ([320.0, 240.0], 2.0),
    ] {
        let mut hands = Hands::on(rows(), size, scale);
        let bar = hands.place("File").unwrap().bottom();
        let window = hands.0.ctx.content_rect();
        for action in ["edit.settings", "window.keys", "pen.settings", "file.recent"] {
            hands.editor().act(action);
            hands.steps(8);
        }
        for id in ["settings", "key sheet", "pen settings", "welcome"] {
            let place = crate::widgets::panel::id(id, &hands.0.ctx);
            let rect = hands.0.ctx.memory(|memory| memory.area_rect(place)).unwrap();
            assert!(
                rect.top() >= bar,
                "{size:?} at {scale}: {id} {rect:?} over the menu bar {bar}"
            );
            let inside = window.expand(1.0).contains_rect(rect);
            assert!(inside, "{size:?} at {scale}: {id} {rect:?} is larger than {window:?}");
        }
        for _ in 0..4 {
            hands.key(Key::Escape);
        }
        let view = hands.place("View").unwrap();
        if !window.contains_rect(view) {
            continue;
        }
        hands.click(view.center());
        let entry = |hands: &Hands, words: &str| hands.place(words).unwrap();
        let first = super::actions::all().find(|action| action.menu == "View").unwrap();
        let top = entry(&hands, first.group().unwrap_or(first.label));
        assert!(window.contains_rect(top), "{size:?} at {scale}: {top:?}");
        let lowest = |hands: &Hands| {
            let actions = super::actions::all().filter(|action| action.menu == "View");
            let names = actions.map(|action| action.group().unwrap_or(action.label));
            let rects = names.filter_map(|name| hands.place(name));
            rects.map(|rect| rect.bottom()).fold(0.0, f32::max)
        };
        hands.hover(top.center());
        for _ in 0..60 {
            if lowest(&hands) <= window.bottom() {
                break;
            }
            hands.wheel(Vec2::new(0.0, -200.0));
        }
        assert!(lowest(&hands) <= window.bottom(), "{size:?} at {scale}: the end is not reached");
    }
}

#[test]
fn no_menu_of_the_bar_is_taller_than_a_small_screen() {
    let mut hands = Hands::on(rows(), [1366.0, 768.0], 1.0);
    for menu in super::actions::MENUS {
        hands.click_on(menu);
        hands.picture(&format!("the menu {menu}"));
        let all = super::actions::all().filter(|action| action.menu == *menu);
        let names: Vec<&str> = all.map(|action| action.group().unwrap_or(action.label)).collect();
        for name in names {
            let rect = hands.place(name).unwrap_or_else(|| panic!("{menu}: {name}"));
            assert!(rect.bottom() < 768.0, "{menu}: {name} at {rect:?}");
        }
        hands.key(Key::Escape);
    }
    // A menu within a menu opens beside it, and its entries do what they say.
    hands.click_on("Pen");
    hands.click_on("Recipes");
    let before = hands.editor().state.history.done();
    hands.click_on("Brows");
    assert_eq!(hands.editor().state.history.done(), before + 1);
}

#[test]
fn a_click_beside_a_menu_or_a_search_closes_it_and_does_nothing_else() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let node = hands.0.state().canvas.to_screen(hands.place("rows: node").unwrap().center());
    hands.editor().apply(Event::Select(Select::Nodes(vec![])));
    let chosen = |hands: &mut Hands| hands.editor().state.selection.nodes.clone();
    hands.click_on("View");
    assert!(hands.shows("Evaluate now"));
    hands.click(node);
    assert!(!hands.shows("Evaluate now") && chosen(&mut hands).is_empty());
    hands.hover(empty(hands.room(Room::Canvas)));
    hands.key(Key::Tab);
    assert!(hands.editor().canvas.searches());
    hands.click(node);
    assert!(!hands.editor().canvas.searches() && chosen(&mut hands).is_empty());
    hands.keys(Modifiers::COMMAND, Key::K);
    hands.click(node);
    assert!(!hands.editor().palette.is_open() && chosen(&mut hands).is_empty());
    // The pen neither: a menu of the right button, and a stroke begun beside it.
    hands.editor().act("pen.draw");
    let strokes = file::write(&hands.editor().state.document);
    hands.click_with(node, PointerButton::Secondary);
    hands.click(hands.room(Room::Viewport).center());
    assert_eq!(file::write(&hands.editor().state.document), strokes);
    hands.click(node);
    assert_eq!(chosen(&mut hands), [NodeId::new("rows").unwrap()].into());
}

#[test]
fn tooltips_of_actions_have_two_lines_at_most() {
    let hands = Hands::on(rows(), SIZE, 1.0);
    let style = hands.0.ctx.global_style();
    let (font, width) = (egui::TextStyle::Body.resolve(&style), style.spacing.tooltip_width);
    let long: Vec<&str> = super::actions::all()
        .filter(|action| {
            let (tip, font) = (action.tip.to_owned(), font.clone());
            let laid = hands.0.ctx.fonts_mut(|f| f.layout(tip, font, egui::Color32::WHITE, width));
            laid.rows.len() > 2
        })
        .map(|action| action.tip)
        .collect();
    assert!(long.is_empty(), "longer than two lines: {long:#?}");
}

/// Where everything is that can be pressed in these rooms, but for what was asked to be left out.
fn places(hands: &Hands, words: &[&str]) -> Vec<(String, Option<Rect>)> {
    words.iter().map(|word| ((*word).to_owned(), hands.place(word))).collect()
}

#[test]
fn the_pens_bar_keeps_its_places_whatever_the_tool() {
    let tools: Vec<&str> = super::actions::all()
        .map(|action| action.id)
        .filter(|id| id.starts_with("pen.") || id.starts_with("hair.") || id.starts_with("mask."))
        .filter(|id| !id.contains("settings") && !id.contains("brush_") && !id.contains("level"))
        .filter(|id| *id != "pen.words")
        .collect();
    for size in [[1440.0, 900.0], [1280.0, 720.0], [900.0, 700.0]] {
        let mut hands = Hands::on(rows(), size, 1.0);
        let named = ["Select", "Draw", "Comb", "Implant", "Scatter", "Recipes", "Paint", "Flood"];
        let before = places(&hands, &named);
        let picture = hands.place("Picture of the groom");
        for tool in &tools {
            hands.editor().act(tool);
            hands.steps(2);
            assert_eq!(places(&hands, &named), before, "{size:?}, {tool}");
            assert_eq!(hands.place("Picture of the groom"), picture, "{size:?}, {tool}");
        }
    }
}

#[test]
fn tools_stand_in_one_row_of_icons_or_with_their_words_in_several() {
    let names = [
        "Select",
        "Points",
        "Sketch",
        "Silhouette",
        "Draw",
        "Comb",
        "Grab",
        "Comb strokes",
        "Cut",
        "Erase strokes",
        "Straighten",
        "Pin",
        "Paint",
        "Flood",
        "Draw region",
        "Pen settings",
        "Recipes",
        "Words",
    ];
    let rects = |hands: &Hands| names.map(|name| hands.place(name).unwrap());
    let lines = |rects: &[Rect]| {
        let tops: std::collections::BTreeSet<i32> = rects.iter().map(|r| r.top() as i32).collect();
        tops.len()
    };
    let mut hands = Hands::on(rows(), [1366.0, 768.0], 1.0);
    let room = hands.room(Room::Viewport);
    let row = rects(&hands);
    assert_eq!(lines(&row), 1, "{row:?}");
    assert!(row.windows(2).all(|pair| pair[0].right() <= pair[1].left()), "{row:?}");
    assert!(row[0].left() >= room.left() && row[17].right() <= room.right(), "{row:?} in {room:?}");
    // A key means the same on hair and on strokes; what stands in the bar is one of them.
    use crate::rooms::pen::PenTool;
    hands.click_on("Comb");
    assert!(matches!(hands.editor().pen.tool, PenTool::Hair(Some(_))));
    hands.click_on("Comb strokes");
    assert_eq!(hands.editor().pen.tool, PenTool::Comb);
    hands.hover(row[5].center());
    hands.0.event(Input::PointerMoved(row[5].center() + Vec2::splat(1.0)));
    until("the tooltip comes", || {
        hands.steps(1);
        hands.0.query_all_by_label_contains("Comb hair\nPull hair").next().is_some()
    });
    hands.click_on("Words");
    assert!(hands.editor().state.settings.pen.words);
    hands.steps(2);
    let several = rects(&hands);
    assert!(several[2].width() > row[2].width() + 20.0, "{several:?}");
    assert!(lines(&several) > 1 && several.iter().all(|r| r.right() <= room.right()));
    hands.click_on("Words");
    hands.steps(2);
    assert_eq!(rects(&hands), row);
    // Where the room is narrower, the wheel leads to the rest.
    let mut narrow = Hands::on(rows(), [800.0, 600.0], 1.0);
    let room = narrow.room(Room::Viewport);
    let last = |hands: &Hands| hands.place("Words").unwrap();
    assert!(last(&narrow).left() > room.right());
    narrow.hover(narrow.place("Draw").unwrap().center());
    narrow.wheel(Vec2::new(0.0, -2000.0));
    assert!(last(&narrow).right() <= room.right(), "{:?} in {room:?}", last(&narrow));
    narrow.click_on("Flood");
    assert!(matches!(narrow.editor().pen.tool, PenTool::Mask(_)));
}

#[test]
fn what_is_said_of_a_node_moves_none_of_its_inputs() {
    let mut hands = Hands::on(groom("cornrows"), SIZE, 1.0);
    hands.editor().apply(Event::Select(Select::Nodes(vec![NodeId::new("rows").unwrap()])));
    hands.steps(3);
    let inputs = ["Filter inputs", "Bypass", "Smoothing", "Mirror", "Spacing"];
    let before = places(&hands, &inputs);
    assert!(before.iter().filter(|(_, place)| place.is_some()).count() >= 3, "{before:?}");
    // It loses its head: an error with a remedy.
    let socket: coif_graphs::document::Socket = "rows.scalp".parse().unwrap();
    let cut = coif_graphs::document::edit::Edit::SetWires { to: socket, from: vec![] };
    hands.editor().apply(Event::Edit(cut));
    hands.steps(4);
    assert_eq!(places(&hands, &inputs), before);
    let room = hands.room(Room::Inspector);
    let said = hands.0.query_all_by_label_contains("✖").find(|n| room.contains(n.rect().center()));
    let said = said.expect("the inspector says so").rect();
    assert!(said.top() > room.bottom() - 40.0, "under the inputs: {said:?} in {room:?}");
    hands.click(said.left_center() + Vec2::new(4.0, 0.0));
    assert_eq!(places(&hands, &inputs), before);
    assert!(hands.0.query_all_by_label_contains("✖").count() >= 2, "the line opens");
}

#[test]
fn an_export_and_a_changed_file_move_nothing() {
    let folder = Folder::new("moves");
    let path = folder.path("mine.ron");
    std::fs::write(&path, file::write(&rows())).unwrap();
    let mut hands = Hands::on(groom("cornrows"), SIZE, 1.0);
    let rooms = |hands: &Hands| {
        Room::ALL.map(|room| {
            hands.0.state().rooms.iter().find(|(known, _)| *known == room).map(|(_, rect)| *rect)
        })
    };
    let before = rooms(&hands);
    let to = folder.path("hair.usdc");
    let content = super::documents::export::Content::Hair(Default::default());
    hands.editor().export(content, to.clone());
    let mut seen = false;
    crate::testing::until("the export ends", || {
        hands.steps(1);
        assert_eq!(rooms(&hands), before);
        seen |= hands.shows("Stop export");
        to.exists() && !hands.shows("Stop export")
    });
    assert!(seen, "the status line showed it");
    hands
        .editor()
        .apply(Event::Documents(crate::core::documents::DocumentEvent::Open(path.clone())));
    hands.steps(4);
    let before = rooms(&hands);
    std::fs::write(&path, file::write(&groom("puffs"))).unwrap();
    crate::testing::until("the change is asked about", || {
        hands.steps(1);
        assert_eq!(rooms(&hands), before);
        hands.shows("Keep mine")
    });
    hands.steps(3);
    hands.click_on("Keep mine");
    assert!(!hands.shows("Keep mine"));
    assert_eq!(rooms(&hands), before);
}

#[test]
fn the_welcome_panel_stands_beside_the_picture() {
    for size in [[1280.0, 720.0], [1440.0, 900.0], [1600.0, 1000.0], [2560.0, 1400.0]] {
        let mut hands = Hands::on(rows(), size, 1.0);
        hands.editor().greet();
        hands.steps(4);
        let id = crate::widgets::panel::id("welcome", &hands.0.ctx);
        let rect = hands.0.ctx.memory(|memory| memory.area_rect(id)).unwrap();
        let picture = hands.room(Room::Viewport);
        let hidden = rect.intersect(picture);
        assert!(!hidden.is_positive() || hidden.width() < 4.0, "{size:?}: {rect:?} on {picture:?}");
    }
}

#[test]
fn docks_come_back_to_their_shares_after_a_tiny_window_and_a_restart() {
    let folder = Folder::new("shares");
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let places_of = || Places::under(folder.root());
    let ctx = hands.0.ctx.clone();
    hands.editor().keep_in(&ctx, places_of());
    hands.steps(3);
    let share = |hands: &Hands| {
        let all = hands.0.ctx.content_rect().size();
        Room::ALL.map(|room| {
            let found = hands.0.state().rooms.iter().find(|(known, _)| *known == room);
            found.map(|(_, rect)| {
                let size = rect.size() / all;
                [size.x, size.y].map(|x| (x * 100.0).round())
            })
        })
    };
    let before = share(&hands);
    // One border is dragged: that stays.
    let border = Pos2::new(hands.room(Room::Viewport).right() + 3.0, 450.0);
    hands.hover(border);
    let press = |pos, pressed| Input::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    hands.0.event(press(border, true));
    hands.steps(1);
    for k in 1..=10 {
        hands.0.event(Input::PointerMoved(border - Vec2::new(10.0 * k as f32, 0.0)));
        hands.steps(1);
    }
    hands.0.event(press(border - Vec2::new(100.0, 0.0), false));
    hands.steps(3);
    let dragged = share(&hands);
    assert_ne!(dragged, before, "a border can be dragged");
    for size in [[160.0, 120.0], [320.0, 240.0], [900.0, 120.0], [200.0, 900.0]] {
        hands.0.set_size(size.into());
        hands.steps(3);
        // Something is pressed meanwhile: the status line.
        hands.click(Pos2::new(size[0] / 2.0, size[1] - 4.0));
    }
    // It ends while it is small.
    hands.editor().store_settings();
    hands.0.set_size(SIZE.into());
    hands.steps(3);
    assert_eq!(share(&hands), dragged);
    let mut again = Hands::on(rows(), SIZE, 1.0);
    let ctx = again.0.ctx.clone();
    again.editor().keep_in(&ctx, places_of());
    again.steps(3);
    assert_eq!(share(&again), dragged);
}

#[test]
fn hair_that_changes_begins_one_picture_and_what_changes_none_begins_none() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let settle = |hands: &mut Hands| {
        let mut keys = vec![];
        crate::testing::until("all is evaluated", || {
            hands.steps(1);
            let key = hands.0.state().state.shown.as_ref().map(|shown| shown.curves.key());
            if let Some(key) = key.filter(|key| keys.last() != Some(key)) {
                keys.push(key);
            }
            hands.0.state().is_idle()
        });
        keys.len()
    };
    settle(&mut hands);
    let rows = NodeId::new("rows").unwrap();
    // As of a groom that takes a while, but no second.
    hands.editor().last_final_ms = 600.0;
    let set = |input: &str, text: &str| {
        let def = coif_nodes::by_id("stroke_input").unwrap();
        let ty = def.input(input).unwrap().1.ty;
        let setting = coif_graphs::document::Setting::Known(text::read_value(ty, text).unwrap());
        let (node, input) = (NodeId::new("rows").unwrap(), input.to_owned());
        Event::Edit(coif_graphs::document::edit::Edit::SetInput { node, input, setting })
    };
    let document = &hands.editor().state.document;
    let def = coif_nodes::by_id(&document.node("rows").unwrap().kind).unwrap();
    assert_eq!(def.id, "stroke_input");
    hands.editor().apply(set("spacing", "0.8"));
    assert_eq!(settle(&mut hands), 2, "the old hair, and once the new");
    for event in [
        Event::Select(Select::Nodes(vec![rows.clone()])),
        Event::Pin(Some(rows.clone())),
        Event::Display(Some(rows.clone())),
        Event::Show(Room::Messages),
        Event::Expose { socket: "rows.seed".parse().unwrap(), exposed: true },
    ] {
        hands.editor().apply(event);
        assert_eq!(settle(&mut hands), 1);
    }
}

#[test]
fn a_search_says_why_it_found_something_and_sets_what_was_asked_for() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let at = empty(hands.room(Room::Canvas));
    let search = |hands: &mut Hands, letters: &str| {
        hands.hover(at);
        hands.key(Key::Tab);
        hands.types(letters);
    };
    search(&mut hands, "noise");
    assert!(hands.shows("Cluster to strands: frizz"));
    hands.key(Key::Escape);
    search(&mut hands, "qqqq");
    assert!(hands.shows("Nothing matches."));
    hands.key(Key::Escape);
    search(&mut hands, "4c");
    assert!(hands.shows("Shape-list curl: preset 4c") || hands.shows("Shape list curl: preset 4c"));
    hands.key(Key::Enter);
    let document = &hands.editor().state.document;
    let curl = document.nodes.values().find(|node| node.kind == "shape_list_curl").unwrap();
    let preset = curl.inputs.get("preset");
    let set = coif_nodes::define::Value::Text("4c".into());
    assert_eq!(preset, Some(&coif_graphs::document::Setting::Known(set)));
    assert_eq!(hands.editor().state.history.done(), 1, "one step");
}

#[test]
fn the_palette_keeps_its_size_and_says_when_nothing_is_found() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    hands.keys(Modifiers::COMMAND, Key::K);
    let size = |hands: &Hands| {
        let id = egui::Id::new("palette");
        hands.0.ctx.memory(|memory| memory.area_rect(id)).unwrap().size()
    };
    hands.steps(3);
    let whole = size(&hands);
    hands.types("qqqq");
    hands.steps(3);
    assert!(hands.0.query_by_label_contains("No action answers").is_some());
    assert_eq!(size(&hands), whole);
    for _ in 0..4 {
        hands.key(Key::Backspace);
    }
    hands.steps(3);
    assert_eq!(size(&hands), whole);
}

#[test]
fn failures_are_seen_with_reason_and_remedy_and_kept_and_old_news_leaves() {
    let folder = Folder::new("failures");
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let said = |hands: &Hands, words: &str| {
        let toast = hands.0.ctx.memory(|memory| memory.area_rect(egui::Id::new("toasts")));
        let mut all = hands.0.query_all_by_label_contains(words);
        toast.is_some_and(|toast| all.any(|node| toast.contains(node.rect().center())))
    };
    let read_only = folder.path("locked.ron");
    std::fs::write(&read_only, "").unwrap();
    let mut mode = std::fs::metadata(&read_only).unwrap().permissions();
    mode.set_readonly(true);
    std::fs::set_permissions(&read_only, mode).unwrap();
    let broken = folder.path("broken.ron");
    std::fs::write(&broken, "(format: 1, nodes: {,").unwrap();
    use crate::core::documents::DocumentEvent;
    let cases = [
        (DocumentEvent::SaveTo(folder.path("none/x.ron")), "not saved: ", "make the folder"),
        (DocumentEvent::SaveTo(read_only.clone()), "is read-only", "choose another name"),
        (DocumentEvent::Open(broken.clone()), "not opened: ", "mend it"),
        (DocumentEvent::Open(folder.path("gone.ron")), "no such file", "look for it with Open"),
    ];
    for (event, why, remedy) in cases.clone() {
        hands.editor().apply(Event::Documents(event));
        hands.steps(3);
        assert!(said(&hands, why) && said(&hands, remedy), "{why}; {remedy}");
        // Twice the same is said twice.
        hands.click_on("Put away");
    }
    let (again, why, _) = cases[3].clone();
    hands.editor().apply(Event::Documents(again));
    hands.steps(3);
    assert!(said(&hands, why), "the same failure again");
    hands.steps(100);
    assert!(!said(&hands, why), "it leaves by itself");
    hands.editor().apply(Event::Show(Room::Messages));
    hands.steps(3);
    assert!(hands.0.query_all_by_label_contains("make the folder").next().is_some(), "it is kept");
    // What was done leaves the status line.
    hands.editor().apply(Event::Show(Room::Canvas));
    hands.editor().apply(Event::Documents(DocumentEvent::SaveTo(folder.path("x.ron"))));
    until("it is saved", || {
        hands.steps(1);
        hands.0.query_all_by_label_contains("saved ").next().is_some()
    });
    hands.steps(60);
    assert!(hands.0.query_all_by_label_contains("saved ").next().is_none());
}

#[test]
fn what_is_added_behind_the_displayed_node_takes_the_display_along_in_one_step() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let rows = NodeId::new("rows").unwrap();
    hands.editor().apply(Event::Display(Some(rows.clone())));
    hands.editor().apply(Event::Select(Select::Nodes(vec![rows.clone()])));
    hands.hover(empty(hands.room(Room::Canvas)));
    hands.key(Key::Tab);
    hands.types("resample");
    hands.key(Key::Enter);
    let state = &hands.editor().state;
    let new = state.active().cloned().unwrap();
    assert_eq!(state.document.display.as_ref(), Some(&new));
    assert_eq!(state.document.nodes[&new].kind, "resample");
    hands.keys(Modifiers::COMMAND, Key::Z);
    let state = &hands.editor().state;
    assert_eq!((state.document.display.as_ref(), state.history.done()), (Some(&rows), 0));
}

#[test]
fn the_hair_and_the_symmetry_of_a_document_go_with_it() {
    let mut hands = Hands::on(groom("cornrows"), SIZE, 1.0);
    crate::testing::until("all is evaluated", || {
        hands.steps(1);
        hands.0.state().is_idle()
    });
    assert!(hands.editor().state.shown.is_some());
    hands.editor().state.settings.pen.symmetry = true;
    assert!(hands.editor().state.settings.pen.symmetry);
    hands.editor().apply(Event::Documents(crate::core::documents::DocumentEvent::New(None)));
    let braids = |hands: &Hands| {
        let shown = hands.0.state().state.shown.as_ref();
        shown.is_some_and(|shown| shown.curves.curve_count() > 0)
    };
    assert!(!braids(&hands) && !hands.editor().state.settings.pen.symmetry);
    crate::testing::until("the head is there", || {
        hands.steps(1);
        assert!(!braids(&hands), "hair of the groom before");
        hands.0.state().is_idle()
    });
}

#[test]
fn people_read_names_and_never_ids() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let canvas = hands.room(Room::Canvas);
    let rows = NodeId::new("rows").unwrap();
    hands.editor().apply(Event::Select(Select::Nodes(vec![rows.clone()])));
    hands.hover(empty(canvas));
    for _ in 0..3 {
        hands.keys(Modifiers::COMMAND, Key::D);
    }
    let state = &hands.editor().state;
    let names: Vec<String> =
        state.document.nodes.keys().map(|id| state.document.name_of(id).into_owned()).collect();
    let label = state.document.nodes["rows"].label.clone();
    let stem = label.unwrap_or_else(|| "rows".to_owned());
    for n in 2..=4 {
        assert!(names.contains(&format!("{stem} {n}")), "{names:?}");
    }
    // A step of the history, and a failure over the picture.
    let set = |input: &str, x: f32| {
        let setting = coif_graphs::document::Setting::Known(coif_nodes::define::Value::Float(x));
        let (node, input) = (NodeId::new("rows").unwrap(), input.to_owned());
        Event::Edit(coif_graphs::document::edit::Edit::SetInput { node, input, setting })
    };
    hands.editor().apply(set("pressure_radius", 0.123_456));
    let words = hands.editor().state.history.steps().last().unwrap().words.clone();
    assert!(words.ends_with("pressure radius 0 to 0.123"), "{words}");
    let text = "(format: 1, title: \"x\", nodes: {\"my_head\": (kind: \"head\", inputs: {\"mesh\": \
                \"/none.obj\"}), \"the_rows\": (kind: \"stroke_input\"), \"other_head\": (kind: \"head\")}, \
                links: {\"the_rows.scalp\": \"my_head.scalp\"}, display: \"the_rows\")";
    let document = file::read(text).unwrap().document;
    let mut hands = Hands::on(document, SIZE, 1.0);
    crate::testing::until("it failed", || {
        hands.steps(1);
        hands.0.state().is_idle()
    });
    hands.steps(2);
    let banner = "✖ my head failed and passes its input on";
    assert_eq!(hands.0.query_all_by_label(banner).count(), 1);
    let about = crate::rooms::messages::all(&hands.editor().state);
    let mut told: Vec<String> = about.iter().map(|message| message.line()).collect();
    told.sort();
    let count = told.len();
    told.dedup();
    assert_eq!(told.len(), count, "nothing is told twice: {told:?}");
    assert!(
        told.iter().all(|line| !line.contains("the_rows") && !line.contains("my_head")),
        "{told:?}"
    );
}

#[test]
fn a_frame_is_pasted_into_another_document() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let canvas = hands.room(Room::Canvas);
    let both: Vec<NodeId> = hands.editor().state.document.nodes.keys().cloned().collect();
    hands.editor().apply(Event::Select(Select::Nodes(both.clone())));
    hands.hover(empty(canvas));
    hands.keys(Modifiers::COMMAND, Key::G);
    hands.key(Key::Enter);
    assert_eq!(hands.editor().state.document.frames.len(), 1);
    hands.editor().apply(Event::Select(Select::Nodes(both)));
    hands.hover(empty(canvas));
    hands.0.event(Input::Copy);
    hands.steps(1);
    let copied =
        hands.0.output().platform_output.commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
    let text = copied.expect("nodes are copied as text");
    let mut other = Hands::on(groom("puffs"), SIZE, 1.0);
    let before = other.editor().state.document.frames.len();
    other.hover(empty(other.room(Room::Canvas)));
    other.0.event(Input::Paste(text));
    other.steps(2);
    assert_eq!(other.editor().state.document.frames.len(), before + 1);
}

#[test]
fn a_bar_of_any_width_keeps_its_words_whole_and_leaves_room_for_the_picture() {
    for size in [[1600.0, 1000.0], [1280.0, 720.0], [640.0, 480.0], [320.0, 240.0]] {
        for scale in [0.75, 1.0, 2.0] {
            let [width, height] = size;
            let mut hands = Hands::on(rows(), [width / scale, height / scale], scale);
            let what = format!("{size:?} at {scale}");
            for words in ["Pen settings", "Draw region", "Recipes", "Silhouette", "Puff", "Re-draw"]
            {
                let Some(rect) = hands.place(words) else { panic!("{what}: no {words}") };
                assert!(rect.height() < 40.0, "{what}: {words} is {rect:?}");
            }
            let room = hands.room(Room::Viewport);
            let picture = hands.editor().viewport.projection().rect;
            let least = (0.6 * room.height()).min(room.height() - 28.0) - 8.0;
            assert!(picture.height() >= least, "{what}: {picture:?} of {room:?}");
        }
    }
}

#[test]
fn numbers_beside_names_are_those_of_this_groom() {
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let rest = |hands: &mut Hands| {
        until("it ends", || {
            hands.steps(1);
            hands.0.state().is_idle() && !hands.0.state().state.stale()
        });
    };
    rest(&mut hands);
    let id = |text: &str| NodeId::new(text).unwrap();
    let count = |hands: &Hands, node: &str| {
        let reports = &hands.0.state().state.run.reports;
        reports.nodes.get(&id(node)).map(|report| report.curves)
    };
    let strokes = count(&hands, "rows").expect("rows ran");
    assert!(strokes > 2);
    // What is displayed is the head alone: the rows are as they were, so what they said holds.
    hands.editor().apply(Event::Display(Some(id("head"))));
    rest(&mut hands);
    assert_eq!(count(&hands, "rows"), Some(strokes));
    // With other strokes it does not, though they have not run.
    let node = hands.editor().state.document.fresh_node("stroke_input", &id("rows"));
    let edit = coif_graphs::document::edit::Edit::SetInput {
        node: id("rows"),
        input: "strokes".to_owned(),
        setting: node.inputs.get("strokes").cloned().unwrap_or_else(|| {
            let none = coif_nodes::data::strokes::Strokes::default();
            coif_graphs::document::Setting::Known(coif_nodes::define::Value::Strokes(none.into()))
        }),
    };
    hands.editor().apply(Event::Edit(edit));
    rest(&mut hands);
    assert_eq!(count(&hands, "rows"), None);
}

/// What was wrong goes as soon as it is mended, and what is wrong with a file stays.
#[test]
fn what_was_said_of_a_groom_leaves_when_the_groom_changes() {
    use crate::core::notes::Note;
    use coif_graphs::document::edit::Edit;
    let mut hands = Hands::on(rows(), SIZE, 1.0);
    let seen = |hands: &Hands, words: &str| hands.0.query_all_by_label_contains(words).count();
    hands.editor().apply(Event::Say(Note::error("not saved: the disk is full")));
    let twice = Edit::RemoveNode { id: NodeId::new("nobody").unwrap() };
    hands.editor().apply(Event::Edit(twice));
    hands.steps(3);
    let before = seen(&hands, "nobody");
    assert!(before > 0 && seen(&hands, "disk is full") > 0);
    hands.editor().apply(Event::Edit(Edit::SetSeed(7)));
    hands.steps(3);
    assert!(seen(&hands, "nobody") < before, "it stays in the corner");
    assert!(seen(&hands, "disk is full") > 0);
    // While a hand drags, nothing that is said of what it does goes by its own steps.
    let rows = NodeId::new("rows").unwrap();
    hands.editor().apply(Event::Begin("drag".to_owned()));
    hands.editor().apply(Event::Say(Note::warning("no curve is there").of(rows)));
    hands.steps(1);
    for seed in 8..12 {
        hands.editor().apply(Event::Edit(Edit::SetSeed(seed)));
        hands.steps(1);
    }
    hands.editor().apply(Event::End);
    hands.steps(3);
    assert!(seen(&hands, "no curve is there") > 0);
    hands.editor().apply(Event::Edit(Edit::SetSeed(2)));
    hands.steps(3);
    assert_eq!(seen(&hands, "no curve is there"), 0);
}

#[test]
fn another_groom_begins_with_a_preview_and_without_counts_of_the_one_before() {
    let mut hands = Hands::on(groom("puffs"), SIZE, 1.0);
    until("all is evaluated", || {
        hands.steps(1);
        hands.0.state().is_idle()
    });
    assert!(!hands.editor().state.run.reports.nodes.is_empty());
    let new = crate::core::documents::DocumentEvent::New(Some("start"));
    hands.editor().apply(Event::Documents(new));
    hands.steps(1);
    assert!(hands.editor().state.run.reports.nodes.is_empty(), "counts of the groom before");
    let mut seen: Vec<(bool, bool)> = vec![];
    until("all is evaluated", || {
        hands.steps(1);
        let shown = hands.0.state().state.shown.as_ref().filter(|shown| !shown.head_alone);
        let now = shown.map(|shown| (shown.is_final(), shown.stands_for > 1.0));
        seen.extend(now.filter(|now| seen.last() != Some(now)));
        hands.0.state().is_idle()
    });
    assert_eq!(seen, [(false, true), (true, false)], "a tenth first, then all");
}
