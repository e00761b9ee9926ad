//! The shelf in a folder, and the room under a pointer and keys.

use super::pictures::{MOST, PER_FRAME};
use super::{Shelf, ShelfRow};
use crate::core::event::Event;
use crate::core::room::Room;
use crate::core::state::Select;
use crate::editor::tests::{Hands, groom};
use crate::library;
use crate::testing::{Folder, until};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Setting, Thumbnail, groups};
use coif_graphs::{file, grooms, template};
use coif_nodes::data::field::Field;
use coif_nodes::declared::Interface;
use coif_nodes::define::Value;
use egui::{Key, PointerButton, Pos2};
use egui_kittest::kittest::Queryable as _;

/// A template of coif under another name.
fn text(name: &str, change: impl FnOnce(&mut Document)) -> String {
    let mut document = library::shipped(grooms::TEMPLATES[3].1).unwrap().document;
    let group = template::group_of(&document).unwrap().clone();
    let node = std::sync::Arc::make_mut(document.nodes.get_mut(&group).unwrap());
    let origin = std::sync::Arc::make_mut(node.template.as_mut().unwrap());
    origin.name = name.to_owned();
    origin.author = "Ada".to_owned();
    node.label = Some(format!("Style {name}"));
    document.thumbnail = None;
    change(&mut document);
    file::write(&document)
}

/// A folder of so many templates.
fn shelf_of(folder: &Folder, many: usize) -> Vec<(String, std::path::PathBuf)> {
    for n in 0..many {
        std::fs::write(folder.path(&format!("t{n:02}.ron")), text(&format!("t{n:02}"), |_| {}))
            .unwrap();
    }
    vec![("a show".to_owned(), folder.root().to_owned())]
}

impl Hands {
    /// An editor whose room of templates is open and has read all.
    fn with_templates(document: Document, folders: Vec<(String, std::path::PathBuf)>) -> Self {
        let mut hands = Self::on(document, [1440.0, 900.0], 1.0);
        hands.editor().templates.folders = folders;
        hands.editor().act("window.templates");
        hands.read();
        hands
    }
    pub(crate) fn read(&mut self) {
        self.steps(2);
        until("all are read", || !self.editor().templates.shelf.is_looking());
        self.steps(8);
    }
    fn chosen(&mut self) -> Option<String> {
        self.editor().templates.chosen.clone()
    }
    fn added(&mut self) -> Option<String> {
        let state = &self.editor().state;
        let node = state.document.node(state.active()?.as_str())?;
        Some(node.template.as_deref()?.name.clone())
    }
}

#[test]
fn what_is_broken_is_listed_with_its_reason_and_hides_nothing() {
    let folder = Folder::new("templates-broken");
    let shelf = shelf_of(&folder, 2);
    std::fs::write(folder.path("no_ron.ron"), "(").unwrap();
    std::fs::write(folder.path("plain.ron"), grooms::ALL[0].1).unwrap();
    std::fs::write(folder.path("twin.ron"), text("t00", |_| {})).unwrap();
    let bomb = "iVBORw0KGgoAAAANSUhEUgAA6mAAAOpgCAIAAAAAAAAAAAAAAElFTkQAAAAA";
    let bombed =
        text("bomb", |_| {}).replacen("\n)\n", &format!("\n    thumbnail: \"{bomb}\",\n)\n"), 1);
    std::fs::write(folder.path("bomb.ron"), bombed).unwrap();
    let hands = &mut Hands::with_templates(groom("start"), shelf);
    let rows = hands.editor().templates.shelf.rows();
    let mut broken: Vec<(String, String)> = rows
        .iter()
        .filter_map(|row| match row {
            ShelfRow::Broken(it) => Some((row.title().to_owned(), it.why.clone())),
            ShelfRow::Found(_) => None,
        })
        .collect();
    broken.sort();
    let said = |n: usize, name: &str, why: &str| {
        assert_eq!(broken[n].0, name);
        assert!(broken[n].1.contains(why), "{}", broken[n].1);
    };
    said(0, "bomb.ron", "thumbnail: it says 60000 x 60000 pixels");
    said(1, "no_ron.ron", "1:2");
    said(2, "plain.ron", "no group in it is marked");
    said(3, "twin.ron", "t00 1.0 is taken from");
    assert_eq!(rows.len(), grooms::TEMPLATES.len() + 2 + 4);
    // Found by its reason, and by its words when it is chosen.
    hands.types("60000");
    hands.click_on("bomb.ron");
    assert!(hands.chosen().is_some_and(|key| key.ends_with("bomb.ron")));
    let id = hands.editor().state.document.clone();
    hands.key(Key::Enter);
    assert_eq!(hands.editor().state.document, id, "it is not added");
}

#[test]
fn a_file_is_read_once_until_it_changes() {
    let folder = Folder::new("templates-once");
    let shelf = shelf_of(&folder, 3);
    let hands = &mut Hands::with_templates(groom("start"), shelf);
    assert_eq!(hands.editor().templates.shelf.reads(), 3);
    let pictures = hands.editor().templates.pictures.total;
    let again = |hands: &mut Hands| {
        hands.editor().apply(Event::Show(Room::Inspector));
        hands.steps(3);
        hands.editor().apply(Event::Show(Room::Templates));
        hands.read();
    };
    again(hands);
    assert_eq!(hands.editor().templates.shelf.reads(), 3, "none changed");
    assert_eq!(hands.editor().templates.pictures.total, pictures, "none is decoded again");
    std::fs::write(folder.path("t01.ron"), text("t01", |document| document.note = "Other.".into()))
        .unwrap();
    std::fs::remove_file(folder.path("t02.ron")).unwrap();
    again(hands);
    assert_eq!(hands.editor().templates.shelf.reads(), 4);
    assert_eq!(hands.editor().templates.shelf.rows().len(), grooms::TEMPLATES.len() + 2);
}

/// Fifty of a show, each with a picture of its own.
#[test]
fn a_frame_decodes_few_pictures_reads_no_file_and_all_in_sight_are_there_soon() {
    let folder = Folder::new("templates-fifty");
    for n in 0..50 {
        let png = coif_shaders::small::small_png(
            &coif_shaders::picture::Picture::plain(64, 64, [n as f32 / 50.0, 0.3, 0.1, 1.0]),
            coif_shaders::display::Transform::Srgb,
            0.0,
            48 << 10,
        );
        let picture = Thumbnail::new(png.unwrap()).unwrap();
        let text = text(&format!("t{n:02}"), |document| document.thumbnail = Some(picture));
        std::fs::write(folder.path(&format!("t{n:02}.ron")), text).unwrap();
    }
    let hands = &mut Hands::on(groom("start"), [1440.0, 900.0], 1.0);
    hands.editor().templates.folders = vec![("a show".to_owned(), folder.root().to_owned())];
    hands.editor().act("window.templates");
    hands.steps(1);
    until("all are read", || !hands.editor().templates.shelf.is_looking());
    let (mut frames, mut total) = (0, 0);
    loop {
        hands.steps(1);
        frames += 1;
        let pictures = &hands.editor().templates.pictures;
        assert!(pictures.decoded <= PER_FRAME, "{}", pictures.decoded);
        assert!(pictures.len() <= MOST + PER_FRAME);
        if frames > 1 && pictures.total == total {
            break;
        }
        total = pictures.total;
    }
    assert!((8..=40).contains(&total), "{total} in sight");
    assert_eq!(hands.editor().templates.shelf.reads(), 50);
    let reads = |hands: &mut Hands| hands.editor().templates.shelf.reads();
    hands.steps(5);
    assert_eq!(reads(hands), 50, "a frame reads nothing");
}

#[test]
fn letters_find_by_all_that_is_said_and_enter_adds_in_one_step() {
    let hands = &mut Hands::with_templates(groom("start"), vec![]);
    let before = hands.editor().state.document.clone();
    let done = hands.editor().state.history.done();
    hands.types("jaw bob");
    hands.key(Key::Enter);
    assert_eq!(hands.added().as_deref(), Some("bob"));
    assert_eq!(hands.editor().state.history.done(), done + 1);
    let document = &hands.editor().state.document;
    let heads = document.nodes.values().filter(|node| node.is_head()).count();
    assert_eq!(heads, 1, "the head at hand");
    hands.editor().apply(Event::Undo);
    assert_eq!(hands.editor().state.document, before);
    // By arrows, without the field.
    hands.editor().templates.typed.clear();
    let room = hands.room(Room::Templates);
    hands.editor().templates.chosen = None;
    hands.0.ctx.memory_mut(|memory| memory.stop_text_input());
    hands.hover(Pos2::new(room.center().x, room.bottom() - 20.0));
    hands.steps(2);
    hands.key(Key::ArrowRight);
    let first = hands.chosen();
    assert!(first.is_some());
    hands.key(Key::ArrowRight);
    assert_ne!(hands.chosen(), first);
    hands.key(Key::ArrowLeft);
    assert_eq!(hands.chosen(), first);
}

#[test]
fn a_card_is_dragged_to_its_place_among_the_nodes_and_escape_lets_go() {
    let hands = &mut Hands::with_templates(groom("start"), vec![]);
    let before = hands.editor().state.document.clone();
    let from = hands.place("Afro").expect("a card").center();
    let canvas = hands.room(Room::Canvas);
    // Where all of it is in sight: the view stays.
    let to = canvas.lerp_inside(egui::vec2(0.35, 0.25));
    let drag = |hands: &mut Hands, escape: bool| {
        let press = |pos, pressed| egui::Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        hands.hover(from);
        hands.0.event(press(from, true));
        hands.steps(1);
        for part in 1..=8 {
            hands.hover(from.lerp(to, part as f32 / 8.0));
        }
        if escape {
            hands.key(Key::Escape);
        }
        hands.0.event(press(to, false));
        hands.steps(3);
    };
    drag(hands, true);
    assert_eq!(hands.editor().state.document, before, "Escape lets go");
    drag(hands, false);
    assert_eq!(hands.added().as_deref(), Some("afro"));
    let state = &hands.editor().state;
    let at = state.document.layout[state.active().unwrap()];
    let seen = hands.0.state().canvas.to_screen(Pos2::new(at.0, at.1));
    assert!(seen.distance(to) < 2.0, "{seen:?} for {to:?}");
}

#[test]
fn a_template_of_a_file_is_added_when_it_is_read() {
    let folder = Folder::new("templates-file");
    let shelf = shelf_of(&folder, 1);
    let hands = &mut Hands::with_templates(groom("start"), shelf);
    hands.types("ada");
    hands.key(Key::Enter);
    until("it is added", || {
        hands.steps(1);
        hands.added().is_some()
    });
    assert_eq!(hands.added().as_deref(), Some("t00"));
    // A file that went meanwhile is said.
    hands.editor().apply(Event::Undo);
    std::fs::remove_file(folder.path("t00.ron")).unwrap();
    let Some(ShelfRow::Found(gone)) = hands
        .editor()
        .templates
        .shelf
        .rows()
        .iter()
        .find(|row| row.title() == "Style t00")
        .cloned()
    else {
        panic!("it is on the shelf")
    };
    hands.editor().apply(super::add(&gone, None));
    until("it is said", || {
        hands.steps(1);
        hands.editor().state.notes.all().iter().any(|note| note.text.contains("t00.ron"))
    });
}

#[test]
fn a_shelf_of_nothing_is_what_comes_with_coif() {
    let shelf = Shelf::default();
    shelf.look(vec![("your own".into(), "/no such folder".into())], || {});
    until("it is read", || !shelf.is_looking());
    assert_eq!(shelf.rows().len(), grooms::TEMPLATES.len());
    assert!(shelf.rows().iter().all(|row| matches!(row, ShelfRow::Found(_))));
}

/// A groom with an instance of a style of version 1.0, on which two values are set, and version 2.0 of it: one port is called otherwise
/// there, one is gone.
fn old_and_new() -> (Document, String) {
    let old = file::read(&text("style", |_| {})).unwrap().document;
    let mut document = groom("start");
    let place = template::Placement::default();
    let added = template::add(&document, &old, place).unwrap();
    added.edit.apply(&mut document).unwrap();
    for (input, value) in
        [("count", Value::Int(5000)), ("curl_size", Value::from(Field::Constant(0.3)))]
    {
        let (node, setting) = (added.id.clone(), Setting::Known(value));
        Edit::SetInput { node, input: input.to_owned(), setting }.apply(&mut document).unwrap();
    }
    let new = text("style", |new| {
        let group = template::group_of(new).unwrap().clone();
        let ports = new.nodes[&group].interface.unwrap();
        let mut inputs = ports.inputs().to_vec();
        inputs.retain(|port| port.name != "curl_size");
        for port in inputs.iter_mut().filter(|port| port.name == "count") {
            (port.name, port.was) = ("hairs".to_owned(), vec!["count".to_owned()]);
        }
        let ports = Interface::new(inputs, ports.outputs().to_vec()).unwrap();
        let names = [("count".to_owned(), "hairs".to_owned())].into();
        groups::set_interface(new, &group, ports, &names).unwrap().apply(new).unwrap();
        let node = std::sync::Arc::make_mut(new.nodes.get_mut(&group).unwrap());
        std::sync::Arc::make_mut(node.template.as_mut().unwrap()).version = "2.0".to_owned();
    });
    (document, new)
}

#[test]
fn an_upgrade_is_told_before_it_is_done_and_is_one_step() {
    let folder = Folder::new("templates-upgrade");
    let (document, new) = old_and_new();
    std::fs::write(folder.path("style_2.ron"), new).unwrap();
    let shelf = vec![("a show".to_owned(), folder.root().to_owned())];
    let hands = &mut Hands::with_templates(document.clone(), shelf);
    let (id, _) = template::instances(&document).next().unwrap();
    hands.editor().apply(Event::Select(Select::Nodes(vec![id.clone()])));
    hands.editor().apply(Event::Show(Room::Inspector));
    hands.steps(4);
    assert!(hands.shows("⬆ Version 2.0 is in the library"));
    assert!(!hands.shows("Upgrade"), "not before it is told what it does");
    hands.click_on("Show what changes");
    until("it is told", || {
        hands.steps(1);
        hands.shows("Upgrade")
    });
    hands.steps(2);
    hands.picture("an upgrade");
    assert!(hands.shows("✖ curl_size = 0.3: lost, there is no such input any more"));
    assert!(hands.shows("⏵ count = 5000: moved to hairs"));
    assert!(hands.shows("• scalp = head.scalp: kept"));
    assert_eq!(hands.editor().state.document, document, "nothing is done yet");
    let version = |hands: &mut Hands| {
        let node = &hands.editor().state.document.nodes[id];
        (node.template.as_ref().unwrap().version.clone(), node.inputs.contains_key("hairs"))
    };
    hands.click_on("Upgrade");
    assert_eq!(version(hands), ("2.0".to_owned(), true));
    assert_eq!(hands.editor().state.history.done(), 1);
    assert!(!hands.shows("Show what changes"), "it is of the newest");
    hands.editor().apply(Event::Undo);
    hands.steps(2);
    assert_eq!(hands.editor().state.document, document);
    // Kept for good: no newer one is told of, until it may be upgraded again.
    hands.click_on("Keep this version");
    assert!(hands.shows("Kept at this version.") && !hands.shows("Show what changes"));
    hands.click_on("Let it be upgraded");
    assert!(hands.shows("Show what changes"));
    assert_eq!(hands.editor().state.document, document);
}

#[test]
fn what_is_offered_follows_the_document_and_a_template_that_lacks_loses_nothing() {
    let folder = Folder::new("templates-missing");
    let (document, new) = old_and_new();
    let shelf = vec![("a show".to_owned(), folder.root().to_owned())];
    let hands = &mut Hands::with_templates(document.clone(), shelf);
    let (id, _) = template::instances(&document).next().unwrap();
    hands.editor().apply(Event::Select(Select::Nodes(vec![id.clone()])));
    hands.editor().apply(Event::Show(Room::Inspector));
    hands.steps(4);
    assert!(hands.shows("Its template is not in your library; the graph holds all of it."));
    assert_eq!(hands.editor().state.document, document);
    std::fs::write(folder.path("style_2.ron"), new).unwrap();
    let ctx = hands.0.ctx.clone();
    hands.editor().templates.look(&ctx);
    hands.read();
    hands.click_on("Show what changes");
    until("it is offered", || {
        hands.steps(1);
        hands.editor().state.offer.is_some()
    });
    let told = hands.editor().state.offer.as_ref().unwrap().overrides.len();
    let unset = Edit::UnsetInput { node: id.clone(), input: "curl_size".to_owned() };
    hands.editor().apply(Event::Edit(unset));
    hands.steps(2);
    assert_eq!(hands.editor().state.offer.as_ref().unwrap().overrides.len(), told - 1);
    hands.editor().apply(Event::Edit(Edit::RemoveNode { id: id.clone() }));
    hands.steps(2);
    assert!(hands.editor().state.offer.is_none());
}

#[test]
fn a_groom_is_saved_as_a_template_in_the_window_and_stands_on_the_shelf_at_once() {
    let folder = Folder::new("templates-save");
    let shelf = vec![("a show".to_owned(), folder.root().to_owned())];
    let hands = &mut Hands::with_templates(groom("cornrows"), shelf);
    hands.editor().act("template.save");
    hands.steps(3);
    // One of this name and version comes with coif.
    hands.0.get_by_label("Save").click();
    hands.steps(2);
    let taken = "cornrows 1.0 is a template already";
    assert_eq!(hands.0.query_all_by_label_contains(taken).count(), 1);
    hands.key(Key::Escape);
    hands.editor().apply(Event::Edit(Edit::SetTitle("Our rows".to_owned())));
    let before = hands.editor().state.document.clone();
    hands.editor().act("template.save");
    hands.steps(3);
    hands.click_on("Render a thumbnail");
    hands.0.get_by_label("cornrows: strands").click_accesskit();
    hands.steps(2);
    hands.0.get_by_label("Save").click();
    hands.steps(2);
    let path = folder.path("our_rows-1.0.ron");
    until("it is written and listed", || {
        hands.steps(2);
        let rows = hands.editor().templates.shelf.rows();
        rows.iter().any(|row| row.key() == path.display().to_string())
    });
    let entry = library::read(&path).unwrap();
    let group = template::group_of(&entry.document).unwrap().clone();
    assert_eq!((entry.title.as_str(), entry.origin.version.as_str()), ("Our rows", "1.0"));
    let ports: Vec<&str> = {
        let def = entry.document.def(&group).unwrap();
        def.inputs.iter().map(|input| input.name).collect()
    };
    assert!(ports.contains(&"strands") && ports.contains(&"scalp"), "{ports:?}");
    assert_eq!(hands.editor().state.document, before, "the groom stays as it is");
    // Another of this name and version is not written over.
    let colour = "colour".parse().unwrap();
    hands.editor().apply(Event::Edit(Edit::RemoveNode { id: colour }));
    hands.editor().act("template.save");
    hands.steps(3);
    hands.0.get_by_label("Save").click();
    hands.steps(2);
    hands.steps(2);
    let said = hands.0.query_all_by_label_contains("has this name and version and another hash");
    assert_eq!(said.count(), 1);
    assert_eq!(library::read(&path).unwrap().hash, entry.hash);
}

#[test]
fn what_a_template_is_made_of_is_chosen_and_what_was_typed_stays() {
    let hands = &mut Hands::with_templates(groom("cornrows"), vec![]);
    let braid = "braid".parse().unwrap();
    hands.editor().apply(Event::Select(Select::Nodes(vec![braid])));
    hands.editor().act("template.save");
    hands.steps(3);
    let (all, one) = ("The whole groom, without its head", "The node cornrows");
    let has = |hands: &Hands, input: &str| hands.0.query_all_by_label(input).count() > 0;
    // Beside its name stands a field of that name.
    fn field(hands: &Hands) -> egui_kittest::Node<'_> {
        hands.0.query_all_by_label("Title").last().expect("a field")
    }
    let title = |hands: &Hands| field(hands).value().unwrap_or_default();
    let suggested = title(hands);
    let (inside, outside) = ("cornrows: strands", "hair in the braids: frizz");
    assert!(has(hands, inside) && has(hands, outside) && !suggested.is_empty());
    hands.0.get_by_label(one).click_accesskit();
    hands.steps(2);
    assert!(has(hands, inside) && !has(hands, outside), "the inputs are those of the node");
    assert_eq!(title(hands), "");
    field(hands).focus();
    hands.steps(1);
    hands.0.event(egui::Event::Text("Our braid".into()));
    hands.steps(2);
    hands.0.get_by_label(all).click_accesskit();
    hands.steps(2);
    assert!(has(hands, outside));
    assert_eq!(title(hands), "Our braid");
}

/// Brows on a head whose face lies lower, with that head alone in sight.
fn low_brows() -> Document {
    let text =
        grooms::TEMPLATES.iter().find(|(name, _)| *name == "brows").expect("it is shipped").1;
    let mut document = library::shipped(text).expect("a template").document;
    let head = document.nodes.keys().find(|id| id.as_str() == "head").expect("a head").clone();
    let low = "bridge 0 -3.6 9.3; nose 0 -6.6 11; mouth 0 -9.2 9.6";
    let mut set = |id: &str, edit: &dyn Fn(&mut coif_graphs::document::Node)| {
        edit(std::sync::Arc::make_mut(document.nodes.get_mut(id).expect("a node")));
    };
    set("head", &|node| {
        drop(node.inputs.insert("landmarks".into(), Setting::Known(Value::Text(low.into()))))
    });
    set("brows", &|node| node.label = Some("Low brows".to_owned()));
    document.display = Some(head);
    document
}

/// Until the head is seen.
fn seen(hands: &mut Hands) {
    until("the head is seen", || {
        hands.steps(1);
        !hands.editor().state.stale()
    });
}

#[test]
fn a_template_of_another_head_is_fitted_to_the_one_at_hand_and_that_is_said() {
    let folder = Folder::new("templates-fitted");
    let shelf = || vec![("a show".to_owned(), folder.root().to_owned())];
    let hands = &mut Hands::with_templates(low_brows(), shelf());
    seen(hands);
    let id = hands.editor().state.document.nodes.keys().find(|id| id.as_str() == "brows").cloned();
    hands.editor().apply(Event::Select(Select::Nodes(id.into_iter().collect())));
    hands.editor().act("template.save");
    hands.steps(3);
    hands.click_on("Render a thumbnail");
    hands.0.get_by_label("Save").click();
    let path = folder.path("low_brows-1.0.ron");
    until("it is written and listed", || {
        hands.steps(2);
        let rows = hands.editor().templates.shelf.rows();
        rows.iter().any(|row| row.key() == path.display().to_string())
    });
    let entry = library::read(&path).expect("a template");
    let home = |document: &Document| document.nodes["head"].inputs.contains_key("home");
    assert!(home(&entry.document) && !home(&hands.editor().state.document));
    // On the head that it was drawn on it is as it was saved; on the built-in one it lies higher.
    let height = |document: &Document, id: &coif_graphs::document::NodeId| {
        let values = document.inside(id).flat_map(|(_, node)| node.inputs.values());
        let strokes = values.filter_map(|setting| match setting {
            Setting::Known(Value::Strokes(strokes)) => Some(strokes.0.iter()),
            _ => None,
        });
        let all: Vec<f32> =
            strokes.flatten().flat_map(|s| &s.samples).map(|s| s.position.y).collect();
        all.iter().sum::<f32>() / all.len() as f32
    };
    let group = template::group_of(&entry.document).expect("a group").clone();
    let drawn = height(&entry.document, &group);
    let mut bare = low_brows();
    bare.nodes.retain(|id, _| id.as_str() == "head");
    bare.links.clear();
    let mut built_in = bare.clone();
    let head = built_in.nodes.values_mut().next().expect("a head");
    std::sync::Arc::make_mut(head).inputs.clear();
    for (document, is_same) in [(bare, true), (built_in, false)] {
        let hands = &mut Hands::with_templates(document, shelf());
        seen(hands);
        hands.types("low brows");
        hands.key(Key::Enter);
        until("it is added", || {
            hands.steps(1);
            hands.added().is_some()
        });
        let state = &hands.editor().state;
        let (id, origin) = template::instances(&state.document).next().expect("an instance");
        assert_eq!(
            (template::is_as_made(&state.document, id, origin), &origin.hash),
            (is_same, &entry.hash)
        );
        let up = height(&state.document, id) - drawn;
        assert_eq!(up == 0.0, is_same, "{up}");
        assert!(is_same || up > 0.3, "{up}");
        let said =
            state.notes.all().iter().any(|note| note.text.starts_with("Fitted to this head"));
        assert_eq!(said, !is_same);
    }
}

#[test]
fn what_others_put_into_a_folder_is_listed_while_the_room_is_open() {
    let folder = Folder::new("templates-new");
    let shelf = shelf_of(&folder, 1);
    let hands = &mut Hands::with_templates(groom("start"), shelf);
    std::fs::write(folder.path("late.ron"), text("late", |_| {})).unwrap();
    until("it is listed", || {
        hands.steps(1);
        hands.editor().templates.shelf.rows().iter().any(|row| row.title() == "Style late")
    });
}
