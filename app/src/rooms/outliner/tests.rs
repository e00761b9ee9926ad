//! The outliner under hands that click and type, without a screen.

use super::tree::fits;
use super::*;
use crate::core::shown::Shown;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::work::count;
use coif_graphs::document::{Socket, graph};
use coif_nodes::data::attributes::{BRAID, Domain, ID, PARENT, SIDE, STRAND};
use coif_nodes::data::curves::{Curves, TuftBuilder};
use coif_nodes::eval::Quality;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::Vec3;

/// Two braids (7 and 8) of three strands of four hairs; each strand is its hairs' parent.
fn braids() -> Curves {
    let tuft = |braid: u64| {
        let mut tuft = TuftBuilder::even(vec![Vec3::ZERO; 24], 2);
        let each = |f: &dyn Fn(u64) -> u64| (0..12).map(f).collect::<Vec<u64>>();
        tuft.set(ID, Domain::Curve, each(&|i| braid * 100 + i));
        tuft.set(BRAID, Domain::Curve, vec![braid]);
        tuft.set(STRAND, Domain::Curve, (0..12).map(|i| i / 4).collect());
        tuft.set(PARENT, Domain::Curve, each(&|i| braid * 10 + i / 4));
        Arc::new(tuft.build())
    };
    Curves::new(vec![tuft(7), tuft(8)])
}

struct Bench {
    editor: Editor,
    outliner: Outliner,
}

fn hands(groom: &str, curves: Curves) -> (Harness<'static, Bench>, NodeId) {
    let text = coif_graphs::grooms::by_name(groom).unwrap();
    let document = coif_graphs::file::read(text).unwrap().document;
    let output = outputs(&document)[0].clone();
    let socket = Socket::new(output.clone(), "curves");
    let mut editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
    editor.state.shown = Some(Arc::new(Shown {
        revision: 1,
        quality: Quality::Final,
        sockets: vec![socket.clone()],
        curves: curves.clone(),
        scalps: vec![],
        values: [(socket, curves.into())].into(),
        head_alone: false,
        stands_for: 1.0,
        final_strands: None,
        ms: 0.0,
        over: vec![],
    }));
    let bench = Bench { editor, outliner: Outliner::default() };
    let mut hands =
        Harness::builder().with_size(vec2(300.0, 900.0)).with_step_dt(0.02).build_ui_state(
            |ui, bench: &mut Bench| {
                theme::apply(ui.ctx(), egui::Theme::Dark, false);
                let mut out = vec![];
                bench.outliner.ui(&bench.editor.state, ui, &mut out);
                for event in out {
                    bench.editor.apply(event);
                }
            },
            bench,
        );
    hands.run_steps(3);
    (hands, output)
}

fn click(hands: &mut Harness<'static, Bench>, label: &str) {
    hands.get_by_label(label).click();
    hands.run_steps(3);
}

#[test]
fn hair_belongs_to_braids_and_strands() {
    let Groups::Braids(found, beside) = groups(&braids()) else { panic!() };
    assert!(beside.is_empty());
    assert_eq!(found.keys().copied().collect::<Vec<_>>(), [7, 8]);
    assert_eq!(found[&7].curves, 12);
    assert_eq!(found[&8].strands[&2], (4, [82].into()));
    assert_eq!(groups(&Curves::default()), Groups::None);
}

#[test]
fn hair_that_runs_into_braids_from_beside_them_is_no_braid() {
    // A braid, and hair on both sides of its row, which joins no stitch of it.
    let mut tuft = TuftBuilder::even(vec![Vec3::ZERO; 16], 2);
    tuft.set(ID, Domain::Curve, (900..908).collect());
    tuft.set(BRAID, Domain::Curve, vec![7]);
    tuft.set(PARENT, Domain::Curve, vec![7]);
    tuft.set(SIDE, Domain::Curve, (0..8).map(|i| if i < 4 { -1 } else { 1 }).collect());
    let beside = Curves::new(vec![Arc::new(tuft.build())]);
    let all = Curves::new([braids().tufts(), beside.tufts()].concat());
    let Groups::Braids(found, parting) = groups(&all) else { panic!() };
    assert_eq!((found[&7].curves, found.len()), (12, 2));
    assert_eq!((parting[&7].curves, parting.len()), (8, 1));
    let (mut hands, _) = hands("cornrows", all);
    click(&mut hands, "Parting hairs 1");
    assert_eq!(hands.state().editor.state.selection.curves, (900..908).collect());
    click(&mut hands, "Braid 1");
    assert_eq!(hands.state().editor.state.selection.curves, (700..712).collect());
}

#[test]
fn rows_open_select_hide_isolate_and_lock() {
    let (mut hands, output) = hands("cornrows", braids());
    click(&mut hands, "Braid 2");
    assert_eq!(hands.state().editor.state.selection.curves, (800..812).collect());
    let lit = &hands.state().outliner.lit;
    assert!(lit.contains(&Item::Braid(output.clone(), 8)) && lit.len() == 4, "{lit:?}");
    click(&mut hands, "Open Braid 1");
    click(&mut hands, "Strand 2");
    assert_eq!(hands.state().editor.state.selection.curves, (704..708).collect());
    click(&mut hands, "Hide Strand 2");
    click(&mut hands, "Isolate Braid 1");
    click(&mut hands, "Lock Braid 2");
    let view = &hands.state().editor.state.visibility;
    assert_eq!((&view.hidden, &view.alone), (&[71].into(), &[7].into()));
    assert_eq!(view.locked, [8].into());
    assert!(view.shows(&[700, 70, 7]) && !view.shows(&[704, 71, 7]) && !view.shows(&[800, 80, 8]));
    click(&mut hands, "Show all");
    let view = &hands.state().editor.state.visibility;
    assert!(view.shows_all() && !view.locked.is_empty());
    // An output is selected as a node, and its hair hidden as a whole.
    let name = hands.state().editor.state.document.name_of(&output).into_owned();
    click(&mut hands, &name);
    assert_eq!(hands.state().editor.state.active(), Some(&output));
    click(&mut hands, &format!("Hide {name}"));
    assert_eq!(hands.state().editor.state.visibility.hidden, [7, 8].into());
    assert_eq!(hands.state().editor.state.history.done(), 0);
}

#[test]
fn nodes_that_made_it_are_listed_and_renamed() {
    let (mut hands, output) = hands("cornrows", braids());
    let made = hands.state().outliner.rows.iter().find(|r| matches!(r.item, Item::Makers(_)));
    let label = made.unwrap().name.clone();
    click(&mut hands, &format!("Open {label}"));
    let document = &hands.state().editor.state.document;
    let upstream = graph::upstream(document, [&output]);
    let braid = upstream.iter().find(|id| document.nodes[*id].kind == "lissajous_braid");
    let (braid, name) = (braid.unwrap().clone(), document.name_of(braid.unwrap()).into_owned());
    let at = hands.get_all_by_label(&name).next().unwrap().rect().center();
    // Longer than a double click takes.
    hands.run_steps(30);
    for _ in 0..2 {
        hands.hover_at(at);
        hands.drag_at(at);
        hands.drop_at(at);
    }
    hands.run_steps(3);
    hands.key_press_modifiers(Modifiers::COMMAND, Key::A);
    hands.event(egui::Event::Text("Side rows".into()));
    hands.run_steps(1);
    hands.key_press(Key::Enter);
    hands.run_steps(3);
    let label = hands.state().editor.state.document.nodes[&braid].label.clone();
    assert_eq!(label.as_deref(), Some("Side rows"));
    assert_eq!(hands.state().editor.state.history.done(), 1);
    assert_eq!(hands.state().outliner.renaming, None);
}

#[test]
fn a_head_that_is_displayed_has_one_row() {
    let document = crate::editor::documents::life::empty_head();
    let head = document.nodes.keys().next().unwrap().clone();
    assert_eq!(crate::core::shown::displayed(&document)[0].node, head);
    let editor = Editor::new(&egui::Context::default(), document, OpenFile::default());
    let (groups, open) = (BTreeMap::new(), BTreeMap::new());
    let tree = Tree { state: &editor.state, groups: &groups, open: &open, filter: "" };
    let rows = tree.rows(&outputs(&editor.state.document));
    let items: Vec<_> = rows.into_iter().map(|row| row.item).collect();
    assert_eq!(items, [Item::Node(head)]);
}

#[test]
fn keys_move_open_and_hide() {
    let (mut hands, _) = hands("cornrows", braids());
    click(&mut hands, "Braid 1");
    hands.key_press(Key::ArrowRight);
    hands.run_steps(2);
    hands.get_by_label("Strand 1");
    for _ in 0..2 {
        hands.key_press(Key::ArrowDown);
        hands.run_steps(2);
    }
    assert_eq!(hands.state().editor.state.selection.curves, (704..708).collect());
    hands.key_press(Key::Space);
    hands.run_steps(2);
    assert_eq!(hands.state().editor.state.visibility.hidden, [71].into());
}

#[test]
fn patterns_find_names() {
    for (pattern, name, want) in [
        ("row", "Front rows", true),
        ("row*", "Front rows", false),
        ("*row*", "Front rows", true),
        ("braid ?", "Braid 7", true),
        ("braid ?", "Braid 17", false),
        ("*1*7*", "Braid 1x7", true),
        ("", "x", true),
        ("*", "", true),
        ("a*b*c", "abcbd", false),
    ] {
        assert_eq!(fits(pattern, name), want, "{pattern} {name}");
    }
    let (mut hands, _) = hands("cornrows", braids());
    hands.get_by_label("Filter the outliner").click();
    hands.event(egui::Event::Text("strand 3".into()));
    hands.run_steps(3);
    let names: Vec<_> =
        hands.state().outliner.rows.iter().map(|row| row.name.as_str()).skip(1).collect();
    assert_eq!(names, ["Braid 1", "Strand 3", "Braid 2", "Strand 3"]);
}

#[test]
fn a_frame_of_many_clusters_costs_little() {
    let mut tuft = TuftBuilder::even(vec![Vec3::ZERO; 8_000], 2);
    tuft.set(PARENT, Domain::Curve, (0..4_000).map(|i| i / 2 + 1).collect());
    let tuft = tuft.build();
    let all = (0..25).map(|t| {
        let mut tuft = tuft.edit();
        tuft.set(PARENT, Domain::Curve, (0..4_000).map(|i| t * 2_000 + i / 2 + 1).collect());
        Arc::new(tuft.build())
    });
    let (mut hands, _) = hands("start", Curves::new(all.collect()));
    assert!(hands.state().outliner.rows.len() > 50_000);
    let (_, frame) = count(|| hands.run_steps(1));
    assert!(frame.asked < 5_000, "{frame:?}");
}

#[test]
fn the_right_button_offers_what_can_be_done_with_a_row() {
    let (mut hands, output) = hands("cornrows", braids());
    let open = |hands: &mut Harness<'static, Bench>, row: &str| {
        hands.get_by_label(row).click_secondary();
        hands.run_steps(4);
    };
    open(&mut hands, "Braid 2");
    let selected = hands.state().editor.state.selection.curves.clone();
    assert_eq!(selected, (800..812).collect(), "the row is selected");
    assert!(hands.query_by_label("Rename").is_none(), "a braid has no name of its own");
    click(&mut hands, "Isolate");
    assert_eq!(hands.state().editor.state.visibility.alone, [8].into());
    open(&mut hands, "Braid 2");
    click(&mut hands, "End isolation");
    assert!(hands.state().editor.state.visibility.shows_all());
    let name = hands.state().editor.state.document.name_of(&output).into_owned();
    open(&mut hands, &name);
    click(&mut hands, "Rename");
    hands.get_by_label("New name");
}

#[test]
fn selected_hair_is_found_in_the_tree() {
    let (mut hands, _) = hands("cornrows", braids());
    let closed = hands.get_all_by_label_contains("Close ").next();
    closed.expect("an open output").click();
    hands.run_steps(3);
    assert!(hands.query_by_label("Braid 2").is_none());
    hands.state_mut().editor.apply(Event::Select(Select::Curves([805].into())));
    hands.run_steps(2);
    hands.state_mut().outliner.reveal();
    hands.run_steps(3);
    let row = &hands.state().outliner.rows[hands.state().outliner.cursor];
    assert_eq!(row.name, "Braid 2");
    hands.get_by_label("Braid 2");
}
