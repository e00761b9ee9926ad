//! The spreadsheet under hands, small and with 1.6 million points.

use super::*;
use crate::core::state::OpenFile;
use crate::core::state::Select;
use crate::editor::Editor;
use crate::testing::until;
use crate::work::count;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_nodes::data::attributes::{Domain as Of, ID, RADIUS};
use coif_nodes::data::curves::TuftBuilder;
use coif_nodes::eval::Quality;
use egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::Vec3;

/// Straight hair: curve i has the id i + 1 and is 1 + i % 7 cm long.
fn hair(tufts: usize, curves: usize, points: usize) -> Curves {
    let tuft = |t: usize| {
        let of = |c: usize| t * curves + c;
        let place = |c: usize, p: usize| {
            let length = (1 + of(c) % 7) as f32;
            Vec3::new(of(c) as f32, length * p as f32 / (points - 1) as f32, 0.0)
        };
        let all = (0..curves).flat_map(|c| (0..points).map(move |p| place(c, p)));
        let mut tuft = TuftBuilder::even(all.collect(), points);
        tuft.set(ID, Of::Curve, (0..curves).map(|c| of(c) as u64 + 1).collect());
        tuft.set(RADIUS, Of::Curve, (0..curves).map(|c| (of(c) % 10) as f32).collect());
        Arc::new(tuft.build())
    };
    Curves::new((0..tufts).map(tuft).collect())
}

struct Bench {
    editor: Editor,
    spreadsheet: Spreadsheet,
}

fn hands(curves: Curves) -> Harness<'static, Bench> {
    let mut editor =
        Editor::new(&egui::Context::default(), Document::default(), OpenFile::default());
    let socket = Socket::new(NodeId::new("a").unwrap(), "curves");
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
    let bench = Bench { editor, spreadsheet: Spreadsheet::default() };
    let mut hands =
        Harness::builder().with_size(vec2(900.0, 500.0)).with_step_dt(0.02).build_ui_state(
            |ui, bench: &mut Bench| {
                theme::apply(ui.ctx(), egui::Theme::Dark, false);
                let mut out = vec![];
                bench.spreadsheet.ui(&bench.editor.state, ui, &mut out);
                for event in out {
                    bench.editor.apply(event);
                }
            },
            bench,
        );
    hands.run_steps(3);
    hands
}

fn rows(hands: &Harness<'static, Bench>) -> Vec<usize> {
    let sheet = &hands.state().spreadsheet;
    let table = sheet.table.as_ref().unwrap();
    (0..sheet.places(table)).map(|place| sheet.row_at(place)).collect()
}

/// Lets the work beside the window come to its end.
fn settle(hands: &mut Harness<'static, Bench>) {
    hands.run_steps(2);
    until("it is sorted", || {
        hands.run_steps(1);
        !hands.state().spreadsheet.orders.is_working()
    });
    hands.run_steps(1);
}

#[test]
fn headings_sort_and_filters_filter() {
    let mut hands = hands(hair(3, 5, 4));
    assert_eq!(rows(&hands), (0..15).collect::<Vec<_>>());
    hands.get_by_label("Sort by length").click();
    hands.run_steps(2);
    assert_eq!(rows(&hands)[..4], [0, 7, 14, 1]);
    hands.get_by_label("Sort by length").click();
    hands.run_steps(2);
    assert_eq!(rows(&hands)[..3], [6, 13, 5]);
    hands.get_by_label("Filter rows").click();
    hands.event(egui::Event::Text("length > 5.5 and radius != 6".into()));
    hands.run_steps(3);
    assert_eq!(rows(&hands), [13, 5, 12]);
    hands.get_by_label("3 of 15 rows");
    hands.event(egui::Event::Text(" and".into()));
    hands.run_steps(3);
    hands.get_by_label_contains("something is missing at the end");
    hands.get_by_label("Sort by length").click();
    hands.run_steps(2);
    assert_eq!(hands.state().spreadsheet.sort, None);
}

#[test]
fn rows_select_curves_and_curves_rows() {
    let mut hands = hands(hair(3, 5, 4));
    let body = hands.get_by_label("Rows of the spreadsheet").rect();
    let height = 20.0;
    let at = |row: usize| body.left_top() + vec2(50.0, height * (row as f32 + 0.5));
    let click = |hands: &mut Harness<'static, Bench>, row: usize, modifiers: Modifiers| {
        hands.event(egui::Event::ModifiersChanged(modifiers));
        hands.hover_at(at(row));
        hands.drag_at(at(row));
        hands.drop_at(at(row));
        hands.event(egui::Event::ModifiersChanged(Modifiers::NONE));
        hands.run_steps(2);
    };
    let selected = |hands: &Harness<'static, Bench>| {
        hands.state().editor.state.selection.curves.iter().copied().collect::<Vec<_>>()
    };
    click(&mut hands, 2, Modifiers::NONE);
    assert_eq!(selected(&hands), [3]);
    click(&mut hands, 5, Modifiers::SHIFT);
    assert_eq!(selected(&hands), [3, 4, 5, 6]);
    click(&mut hands, 3, Modifiers::COMMAND);
    assert_eq!(selected(&hands), [3, 5, 6]);
    click(&mut hands, 0, Modifiers::NONE);
    hands.key_press(Key::ArrowDown);
    hands.run_steps(2);
    assert_eq!(selected(&hands), [2]);
    hands.key_press(Key::End);
    hands.run_steps(2);
    assert_eq!(selected(&hands), [15]);
    // The other way round.
    hands.state_mut().editor.apply(Event::Select(Select::Curves([4, 9].into())));
    hands.get_by_label("Selected").click();
    hands.run_steps(2);
    assert_eq!(rows(&hands), [3, 8]);
}

#[test]
fn statistics_columns_domains_and_copies() {
    let mut hands = hands(hair(3, 5, 4));
    hands.get_by_label("Statistics").click();
    hands.run_steps(3);
    let found = hands.state().spreadsheet.answer.as_ref().unwrap().statistics["radius"];
    assert_eq!((found.min, found.max, found.nans), (0.0, 9.0, 0));
    assert!((found.mean - 55.0 / 15.0).abs() < 1e-9);
    hands.get_by_label("Columns").click();
    hands.run_steps(3);
    hands.get_by_label("radius").click();
    hands.run_steps(3);
    hands.key_press(Key::Escape);
    hands.run_steps(3);
    assert_eq!(hands.query_all_by_label("Sort by radius").count(), 0);
    hands.get_by_label("Points").click();
    hands.run_steps(3);
    assert_eq!(rows(&hands).len(), 60);
    let sheet = &hands.state().spreadsheet;
    let table = sheet.table.as_ref().unwrap();
    let columns: Vec<&Column> =
        ["curve", "point", "x", "y"].map(|n| table.column(n).unwrap()).into();
    let text = csv(table, &columns, &[0, 5]);
    assert_eq!(text, "curve,point,x,y\n0,0,0,0\n1,1,1,0.666667\n");
    hands.get_by_label("Tufts").click();
    hands.run_steps(3);
    assert_eq!(rows(&hands).len(), 3);
}

#[test]
fn what_is_pinned_stays() {
    let mut hands = hands(hair(3, 5, 4));
    hands.get_by_label("What the spreadsheet shows").click();
    hands.run_steps(3);
    hands.get_by_label("Pin these").click();
    hands.run_steps(3);
    hands.state_mut().editor.state.shown = None;
    hands.run_steps(3);
    assert_eq!(rows(&hands).len(), 15);
}

/// Times that a frame may ask for memory.
const A_FRAME: u64 = 3_000;

#[test]
fn a_frame_of_many_points_costs_what_is_visible() {
    // 1.6 million points: 100,000 curves of 16.
    let curves = hair(200, 500, 16);
    assert_eq!(curves.point_count(), 1_600_000);
    let mut hands = hands(curves);
    hands.get_by_label("Points").click();
    hands.run_steps(3);
    let frame = |hands: &mut Harness<'static, Bench>| count(|| hands.run_steps(1)).1.asked;
    let mut costs = vec![];
    for top in [0.0, 800_000.5, 1_599_990.0] {
        hands.state_mut().spreadsheet.top = top;
        costs.push(frame(&mut hands));
        let sheet = &hands.state().spreadsheet;
        let table = sheet.table.as_ref().unwrap();
        let row = sheet.row_at(sheet.top as usize);
        let cell = |name: &str| table.cell(row, table.column(name).unwrap()).number() as usize;
        assert_eq!((cell("curve"), cell("point"), cell("x")), (row / 16, row % 16, row / 16));
    }
    assert!(costs.iter().all(|cost| *cost < A_FRAME), "{costs:?}");
    // Sorted by height, beside the window.
    hands.get_by_label("Sort by y").click();
    settle(&mut hands);
    let sheet = &hands.state().spreadsheet;
    let table = sheet.table.as_ref().unwrap();
    let y = table.column("y").unwrap();
    let heights =
        (0..1_600_000).step_by(997).map(|place| table.cell(sheet.row_at(place), y).number());
    assert!(heights.is_sorted());
}
