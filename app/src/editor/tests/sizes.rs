//! Everything that opens over the rooms, in windows of all sizes and scales: within the window, below the menu bar, all of it
//! within reach; and afterwards everything is as it was.

use super::*;
use crate::core::documents::Purpose;
use crate::core::notes::Note;
use egui::{Id, LayerId, Order};

/// Pixels of windows, and scales of what they show.
const SIZES: [[f32; 2]; 3] = [[1280.0, 720.0], [1600.0, 1000.0], [320.0, 240.0]];
const SCALES: [f32; 3] = [0.75, 1.0, 2.0];

/// What opens: actions, and what needs more to open ([`open`]).
const PANELS: [&str; 11] = [
    "file.export",
    "file.picture",
    "edit.settings",
    "window.keys",
    "pen.settings",
    "file.recent",
    "window.palette",
    "help.tour",
    "canvas.add",
    "browser",
    "unsaved",
];

impl Hands {
    fn resize(&mut self, [width, height]: [f32; 2], scale: f32) {
        self.editor().state.settings.scale = scale;
        self.steps(2);
        self.0.set_size(Vec2::new(width, height) / scale);
        self.steps(4);
    }

    /// What lies over the rooms: layers and where they are.
    fn over(&self) -> Vec<(LayerId, Rect)> {
        self.0.ctx.memory(|memory| {
            let layers = memory.areas().visible_layer_ids();
            let over = layers.into_iter().filter(|layer| {
                matches!(layer.order, Order::Middle | Order::Foreground)
                    && layer.id != Id::new("beside what is open")
                    && !crate::rooms::canvas::Canvas::owns(layer.id)
            });
            over.filter_map(|layer| Some((layer, memory.area_rect(layer.id)?))).collect()
        })
    }

    /// Named widgets of a layer, or of all.
    fn widgets(&self, of: Option<LayerId>) -> Vec<(Id, Rect)> {
        self.0.ctx.viewport(|viewport| {
            let widgets = &viewport.prev_pass.widgets;
            let layers = widgets.layers().filter(|(layer, _)| of.is_none_or(|of| of == **layer));
            let all = layers.flat_map(|(_, all)| all);
            let named = all.filter(|widget| widgets.info(widget.id).is_some());
            named.map(|widget| (widget.id, widget.rect)).collect()
        })
    }

    /// What is wrong with what is open over the rooms.
    fn check_what_is_open(&mut self, what: &str, wrong: &mut Vec<String>) {
        let window = self.0.ctx.content_rect().expand(1.0);
        let bar = self.place("File").map_or(0.0, |rect| rect.bottom());
        let over = self.over();
        self.picture(what);
        if over.is_empty() {
            wrong.push(format!("{what}: nothing opened"));
        }
        for (layer, rect) in over {
            if !window.contains_rect(rect) {
                wrong.push(format!("{what}: {rect:?} is larger than {window:?}"));
            }
            if rect.top() < bar - 1.0 {
                wrong.push(format!("{what}: {rect:?} over the menu bar, {bar}"));
            }
            let beyond = |hands: &Self| {
                let widgets = hands.widgets(Some(layer));
                let last = |end: fn(&Rect) -> f32| {
                    widgets.iter().map(|(_, rect)| end(rect)).fold(f32::MIN, f32::max)
                };
                Vec2::new(
                    (last(Rect::right) - window.right()).max(0.0),
                    (last(Rect::bottom) - window.bottom()).max(0.0),
                )
            };
            let mut left = beyond(self);
            // What lies beyond the window is reached by the wheel.
            for _ in 0..3 {
                if left == Vec2::ZERO {
                    break;
                }
                self.0.event(Input::PointerMoved(rect.center()));
                self.0.event(Input::MouseWheel {
                    unit: egui::MouseWheelUnit::Point,
                    delta: -left * 2.0 - Vec2::splat(400.0),
                    modifiers: Modifiers::NONE,
                    phase: egui::TouchPhase::Move,
                });
                self.steps(4);
                left = beyond(self);
            }
            if left != Vec2::ZERO {
                wrong.push(format!("{what}: {left} of {layer:?} {rect:?} is out of reach"));
            }
        }
    }

    /// A picture of the window, where they are asked for (`COIF_SHOTS`, a folder): to be looked at.
    pub(crate) fn picture(&mut self, what: &str) {
        let Some(folder) = std::env::var_os("COIF_SHOTS") else { return };
        let letters = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        let name: String = what.chars().map(letters).collect();
        let path = std::path::Path::new(&folder).join(format!("size-{name}.png"));
        self.0.render().expect("a picture").save(path).expect("it is written");
    }

    fn close_all(&mut self) {
        // It stays beside what it teaches until it is ended.
        self.editor().tour = Default::default();
        self.steps(1);
        for _ in 0..4 {
            if self.over().is_empty() {
                return;
            }
            self.key(Key::Escape);
        }
        assert!(self.over().is_empty(), "Escape closes what is open: {:?}", self.over());
    }
}

fn open(hands: &mut Hands, what: &str) {
    match what {
        "unsaved" => {
            let edit = coif_graphs::document::edit::Edit::SetTitle("Other".to_owned());
            hands.editor().apply(Event::Edit(edit));
            hands.editor().act("file.close");
        }
        "browser" => {
            hands
                .editor()
                .apply(Event::Documents(crate::core::documents::DocumentEvent::Ask(Purpose::Open)));
        }
        action => hands.editor().act(action),
    }
    hands.steps(4);
}

/// Opens each in turn, checks it, and gives where it was.
fn each(hands: &mut Hands, (size, scale): ([f32; 2], f32), wrong: &mut Vec<String>) -> Vec<Rect> {
    let mut places = vec![];
    for what in PANELS {
        // Nodes are searched where there is room for nodes.
        if what == "canvas.add" && hands.room(Room::Canvas).height() < 8.0 {
            continue;
        }
        open(hands, what);
        places.extend(hands.over().first().map(|(_, rect)| *rect));
        hands.check_what_is_open(&format!("{what} at {size:?} and {scale}"), wrong);
        hands.close_all();
        if what == "unsaved" {
            hands.editor().apply(Event::Undo);
            hands.steps(2);
        }
    }
    places
}

#[test]
fn panels_and_dialogues_fit_every_window_and_sizes_come_back() {
    let mut hands = Hands::on(groom("cornrows"), [1600.0, 1000.0], 1.0);
    hands.editor().documents.ask_in_the_window();
    hands.steps(4);
    let before = hands.widgets(None);
    let (usual, mut wrong) = (([1600.0, 1000.0], 1.0), vec![]);
    let first = each(&mut hands, usual, &mut wrong);
    for size in SIZES {
        for scale in SCALES {
            hands.resize(size, scale);
            each(&mut hands, (size, scale), &mut wrong);
        }
    }
    hands.resize([1600.0, 1000.0], 1.0);
    let last = each(&mut hands, usual, &mut wrong);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(last, first, "panels come back");
    hands.steps(4);
    assert_eq!(hands.widgets(None), before, "rooms come back");
}

/// Two documents side by side: what is in the room of nodes stays in it, and the rooms come back.
#[test]
fn two_documents_side_by_side_fit_every_window() {
    let mut other = groom("cornrows");
    other.seed = 7;
    for node in ["braid", "rows"] {
        let id = NodeId::new(node).unwrap();
        let edit = coif_graphs::document::edit::Edit::SetBypass { id, bypass: true };
        edit.apply(&mut other).unwrap();
    }
    let name = "a groom whose name is longer than any of the windows is wide.ron".to_owned();
    let mut hands = Hands::on(groom("cornrows"), [1600.0, 1000.0], 1.0);
    hands.steps(4);
    let before = hands.widgets(None);
    let mut wrong = vec![];
    for size in SIZES {
        for scale in SCALES {
            hands.resize(size, scale);
            let file = OpenFile::default();
            hands.editor().compare_document(other.clone(), file, name.clone());
            hands.steps(6);
            hands.picture(&format!("compare at {size:?} and {scale}"));
            let room = hands.room(Room::Canvas).expand(1.0);
            for words in ["Its hair", "End"] {
                let place = hands.place(words).unwrap();
                // A room lower than a button has none to press.
                if room.height() > 60.0 && !room.contains_rect(place) {
                    wrong.push(format!("{words} at {size:?} and {scale}: {place:?} in {room:?}"));
                }
            }
            let picture = hands.room(Room::Viewport).expand(1.0);
            let whose = hands.place("Shown: yours").unwrap();
            if picture.height() > 120.0 && !picture.contains_rect(whose) {
                wrong.push(format!("whose hair at {size:?} and {scale}: {whose:?} in {picture:?}"));
            }
            hands.editor().act("compare.end");
            hands.steps(2);
        }
    }
    hands.resize([1600.0, 1000.0], 1.0);
    hands.steps(4);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(hands.widgets(None), before, "rooms come back");
}

/// What a merge left to decide: its buttons are within the room of messages, or scrolled to.
#[test]
fn what_a_merge_left_is_decided_in_every_window() {
    let base = groom("cornrows");
    let with = |seed: u64, bypass: bool| {
        let mut document = base.clone();
        document.seed = seed;
        let id = NodeId::new("braid").unwrap();
        let label = Some(format!("braids of {seed}"));
        use coif_graphs::document::edit::Edit;
        Edit::SetLabel { id, label }.apply(&mut document).unwrap();
        let id = NodeId::new("fill").unwrap();
        match bypass {
            true => Edit::SetBypass { id, bypass }.apply(&mut document).unwrap(),
            false => Edit::RemoveNode { id }.apply(&mut document).unwrap(),
        };
        document
    };
    let merged = coif_graphs::compare::merge(&base, &with(5, true), &with(6, false)).document;
    let mut hands = Hands::on(merged, [1600.0, 1000.0], 1.0);
    for size in SIZES {
        for scale in SCALES {
            hands.resize(size, scale);
            hands.editor().apply(Event::Show(Room::Messages));
            hands.steps(4);
            let name = format!("conflicts at {size:?} and {scale}");
            hands.picture(&name);
            let room = hands.room(Room::Messages);
            if room.height() < 90.0 {
                continue;
            }
            for words in ["Keep ours", "Take theirs"] {
                for button in hands.0.query_all_by_label(words) {
                    let place = button.rect();
                    let across = room.x_range();
                    let inside = across.contains(place.left()) && across.contains(place.right());
                    assert!(inside, "{name}: {words} {place:?} in {room:?}");
                }
            }
            assert!(hands.shows("Keep ours"), "{name}");
        }
    }
}

fn menus(sizes: &[([f32; 2], f32)]) {
    let mut hands = Hands::on(groom("cornrows"), [1600.0, 1000.0], 1.0);
    let mut wrong = vec![];
    for (size, scale) in sizes {
        hands.resize(*size, *scale);
        let window = hands.0.ctx.content_rect();
        let over_picture = ["Hair ⏷", "Look ⏷", "Over it ⏷", "From ⏷"];
        for menu in super::super::actions::MENUS.iter().chain(&over_picture) {
            let name = format!("{menu} at {size:?} and {scale}");
            let Some(found) = hands.0.query_all_by_label(menu).next() else { continue };
            // A narrow menu bar scrolls.
            found.scroll_to_me();
            hands.steps(4);
            let at = hands.place(menu).map_or(Pos2::ZERO, |rect| rect.center());
            let inside = !over_picture.contains(menu) || hands.room(Room::Viewport).contains(at);
            if !inside || !window.contains(at) {
                assert!(over_picture.contains(menu), "{name} is out of reach");
                continue;
            }
            hands.click(at);
            hands.check_what_is_open(&name, &mut wrong);
            hands.close_all();
        }
        for room in [Room::Viewport, Room::Canvas, Room::Outliner] {
            hands.editor().apply(Event::Show(room));
            hands.editor().state.focus = room;
            hands.editor().act("window.menu");
            hands.steps(4);
            // In a room without any height there is nothing to open a menu on.
            if hands.over().is_empty() && hands.room(room).height() < 60.0 {
                continue;
            }
            let name = format!("menu of {room:?} at {size:?} and {scale}");
            hands.check_what_is_open(&name, &mut wrong);
            hands.close_all();
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "long"]
fn menus_fit_every_window() {
    let all = SIZES.iter().flat_map(|size| SCALES.map(|scale| (*size, scale)));
    menus(&all.collect::<Vec<_>>());
}

#[test]
fn menus_fit_small_windows() {
    menus(&[([320.0, 240.0], 1.0), ([1280.0, 720.0], 2.0)]);
}

/// What comes up by itself, or from within a room: the panel of one's own head, toasts, the popup of a colour.
#[test]
fn panels_of_heads_toasts_and_colours_fit_every_window() {
    let folder = Folder::new("sizes-head");
    let cube = "v -9 -9 -9\nv 9 -9 -9\nv 9 9 -9\nv -9 9 -9\nv -9 -9 9\nv 9 -9 9\nv 9 9 9\nv -9 9 9\n\
        o a_part_with_a_name_that_is_longer_than_any_panel_is_wide\nf 1 2 3 4\nf 5 8 7 6\n\
        o hair\nf 1 5 6 2\nf 2 6 7 3\no glasses\nf 3 7 8 4\nf 5 1 4 8\n";
    let mesh = folder.path("a_head_of_ones_own.obj");
    std::fs::write(&mesh, cube).unwrap();
    let mut hands = Hands::on(groom("cornrows"), [1600.0, 1000.0], 1.0);
    let colour = hands.editor().state.document.nodes.iter();
    let mut colour = colour.filter(|(_, node)| node.kind == "hair_colour");
    let colour = colour.next().map(|(id, _)| id.clone()).expect("a colour");
    hands.editor().documents.ask_in_the_window();
    let mut wrong = vec![];
    let mut opened = [0; 3];
    for (size, scale) in [([1600.0, 1000.0], 1.0), ([1280.0, 720.0], 2.0), ([320.0, 240.0], 1.0)] {
        hands.resize(size, scale);
        let name = |what: &str| format!("{what} at {size:?} and {scale}");
        // Toasts: some words, and a failure as long as they come.
        let long = "the file could not be written: its folder may not be written; ".repeat(4);
        for note in [Note::warning("a warning"), Note::error(long)] {
            hands.editor().state.notes.say(note);
        }
        hands.steps(4);
        hands.check_what_is_open(&name("toasts"), &mut wrong);
        opened[0] += hands.over().len();
        for _ in 0..4 {
            let Some(button) = hands.place("Put away") else { break };
            hands.click(button.center());
        }
        assert!(hands.over().is_empty(), "{}: put away", name("toasts"));
        // A colour, where the inspector has room for it.
        hands.editor().apply(Event::Select(Select::Nodes(vec![colour.clone()])));
        hands.editor().apply(Event::Show(Room::Inspector));
        hands.steps(4);
        let role = egui::accesskit::Role::ColorWell;
        let room = hands.room(Room::Inspector);
        let found = hands.0.query_all_by_role(role).next().map(|well| well.scroll_to_me());
        hands.steps(6);
        let well = hands.0.query_all_by_role(role).next().map(|well| well.rect());
        if let (Some(()), Some(well)) = (found, well.filter(|well| room.contains(well.center()))) {
            hands.click(well.center());
            hands.check_what_is_open(&name("colour"), &mut wrong);
            opened[1] += hands.over().len();
            hands.close_all();
        }
        // One's own head, before and after it is read.
        let read = crate::core::documents::DocumentEvent::Mesh(mesh.clone());
        hands.editor().apply(Event::Documents(read));
        hands.steps(4);
        hands.check_what_is_open(&name("own head, unread"), &mut wrong);
        until("it is read", || {
            hands.steps(1);
            hands.0.state().is_idle()
        });
        hands.check_what_is_open(&name("own head"), &mut wrong);
        opened[2] += hands.over().len();
        for _ in 0..4 {
            let Some(button) = hands.place("Put away") else { break };
            hands.click(button.center());
        }
        hands.close_all();
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(opened.iter().all(|times| *times > 0), "all were seen: {opened:?}");
}

/// The room of templates: what it holds is as wide as it is, with a template chosen and with one that is broken.
#[test]
fn the_room_of_templates_fits_every_window() {
    let folder = Folder::new("sizes-templates");
    std::fs::write(folder.path("a_file_that_is_no_template_and_has_a_long_name.ron"), "(").unwrap();
    let mut hands = Hands::on(groom("cornrows"), [1600.0, 1000.0], 1.0);
    hands.editor().templates.folders = vec![("a show".to_owned(), folder.root().to_owned())];
    hands.editor().apply(Event::Show(Room::Templates));
    hands.read();
    let rows = hands.editor().templates.shelf.rows();
    let fixed = ["Search templates", "Add", "Make thumbnail"].map(str::to_owned);
    let ours: Vec<String> = rows.iter().map(|row| row.title().to_owned()).chain(fixed).collect();
    let (mut wrong, mut seen) = (vec![], 0);
    for (size, scale) in SIZES.iter().flat_map(|size| SCALES.map(|scale| (*size, scale))) {
        hands.resize(size, scale);
        for (n, words) in ["", "bob", "long name"].into_iter().enumerate() {
            hands.editor().templates.find(words);
            hands.steps(4);
            let name = format!("templates {n} at {size:?} and {scale}");
            hands.picture(&name);
            let room = hands.room(Room::Templates).expand(1.0);
            for node in hands.0.query_all(By::new()) {
                // Nodes of the canvas are told where they stand there.
                let words = node.accesskit_node().label().unwrap_or_default();
                if !ours.contains(&words) {
                    continue;
                }
                let rect = node.rect();
                if room.contains(rect.center()) {
                    seen += 1;
                    if rect.left() < room.left() || rect.right() > room.right() {
                        wrong.push(format!("{name}: {rect:?} is wider than {room:?}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(seen > 60, "{seen}");
}
