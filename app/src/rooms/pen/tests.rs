//! The pen in the editor: samples in, strokes and curves out.

use super::sample::{Device, PenSample, Phase, Tool};
use super::*;
use crate::core::state::OpenFile;
use crate::editor::Editor;
use crate::testing::until;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, Node, Setting};
use coif_nodes::define::Value;
use coif_shaders::camera::Camera;
use egui::Vec2;
use egui_kittest::Harness;
use glam::Vec3;

/// A head alone.
pub(super) fn head() -> Document {
    let mut document = Document::default();
    let node = Node { kind: "head".to_owned(), ..Node::default() };
    let id = document.free_id("head");
    document.display = Some(id.clone());
    document.nodes.insert(id, Arc::new(node));
    document
}

/// From above and a little in front; the picture is 30 cm high.
fn camera(state: &State) -> Camera {
    let scalp = state.shown.as_ref().and_then(|shown| shown.scalp());
    let middle = scalp.map_or(Vec3::ZERO, |scalp| scalp.frame().origin);
    Camera {
        eye: middle + Vec3::new(0.0, 60.0, 20.0),
        target: middle,
        up: Vec3::Y,
        focal_mm: 85.0,
        orthographic: Some(30.0),
    }
}

/// The editor, with the pen on a picture in which places are told as on a sheet of 600 by 600.
pub(super) struct Table {
    pub(super) harness: Harness<'static, Editor>,
    pub(super) time: f64,
}

impl Table {
    pub(super) fn new(document: Document) -> Self {
        let harness = Harness::builder().with_size(Vec2::new(1400.0, 1170.0)).build_ui_state(
            |ui, editor: &mut Editor| editor.ui(ui),
            Editor::new(&egui::Context::default(), document, OpenFile::default()),
        );
        let mut table = Self { harness, time: 0.0 };
        table.rest();
        // The viewport puts the eye before a groom that it sees first.
        until("the view arrives", || {
            table.step();
            table.editor().viewport.is_idle()
        });
        let camera = camera(&table.editor().state);
        table.editor().viewport.look(camera);
        table
    }
    /// From the front and a little above, in perspective.
    pub(super) fn look_from_the_front(&mut self) {
        let state = &self.editor().state;
        let scalp = state.shown.as_ref().and_then(|shown| shown.scalp());
        let middle = scalp.map_or(Vec3::ZERO, |scalp| scalp.frame().origin);
        self.editor().viewport.look(Camera {
            eye: middle + Vec3::new(0.0, 8.0, 80.0),
            target: middle,
            up: Vec3::Y,
            focal_mm: 85.0,
            orthographic: None,
        });
    }
    /// A place of the sheet in the window.
    pub(super) fn on_screen(&mut self, at: Pos2) -> Pos2 {
        let rect = self.editor().viewport.projection().rect;
        rect.center() + (at - Pos2::new(300.0, 300.0)) * (rect.height() / 600.0)
    }
    /// A place of the window on the sheet.
    pub(super) fn on_sheet(&mut self, at: Pos2) -> Pos2 {
        let rect = self.editor().viewport.projection().rect;
        Pos2::new(300.0, 300.0) + (at - rect.center()) * (600.0 / rect.height())
    }
    pub(super) fn editor(&mut self) -> &mut Editor {
        self.harness.state_mut()
    }
    pub(super) fn step(&mut self) {
        self.harness.step();
    }
    /// Until all is evaluated.
    pub(super) fn rest(&mut self) {
        until("the evaluation ends", || {
            self.step();
            self.editor().is_idle() && !self.editor().state.stale()
        });
        self.step();
    }
    pub(super) fn pen(&mut self, phase: Phase, at: Pos2, pressure: f32) {
        self.time += 0.005;
        let at = self.on_screen(at);
        let sample = PenSample::mouse(self.time, phase, at, pressure);
        let sample = PenSample { tool: Tool::Tip, device: Device(9), ..sample };
        self.editor().pen.devices.push(sample);
    }
    /// A stroke with a pressure for each of its places.
    pub(super) fn draw(&mut self, places: &[(Pos2, f32)]) {
        let (first, last) = (places[0], places[places.len() - 1]);
        self.pen(Phase::Hover, first.0, 0.0);
        self.pen(Phase::Down, first.0, first.1);
        for (at, pressure) in &places[1..] {
            self.pen(Phase::Move, *at, *pressure);
        }
        self.pen(Phase::Up, last.0, 0.0);
    }
    fn strokes(&mut self) -> Arc<Strokes> {
        let state = &self.editor().state;
        target::of(state, target::Fills::Strokes)
            .map_or_else(Arc::default, |id| target::strokes(&state.document, &id))
    }
}

/// From left to right over the head, in three levels of pressure.
pub(super) fn row(y: f32) -> Vec<(Pos2, f32)> {
    let pressure = |k: usize| [0.25, 0.5, 1.0][k / 10];
    (0..30).map(|k| (Pos2::new(240.0 + 4.0 * k as f32, y), pressure(k))).collect()
}

pub(super) fn draw_on(document: Document) -> Table {
    let mut table = Table::new(document);
    table.editor().act("pen.draw");
    // Without lag, so that pressures and places can be told.
    let mut settings = table.editor().state.settings.clone();
    let feel = crate::core::pen::Feel { stabiliser: 0.0, ..Default::default() };
    settings.pen.devices.insert(crate::core::pen::TOUCH.to_owned(), feel);
    table.editor().apply(Event::Settings(settings.into()));
    table
}

#[test]
fn a_stroke_drawn_with_pressure_becomes_a_curve_and_one_undo_takes_it_back() {
    let mut table = draw_on(head());
    let before = table.editor().state.document.clone();
    table.draw(&row(300.0));
    table.step();
    // In the document at once, with a node made for it.
    let strokes = table.strokes();
    assert_eq!(strokes.0.len(), 1);
    let levels: BTreeSet<u32> =
        strokes.0[0].samples.iter().map(|s| (s.pressure * 16.0).round() as u32).collect();
    assert!([4, 8, 16].iter().all(|level| levels.contains(level)), "{levels:?}");
    assert_eq!(table.editor().state.history.done(), 1);
    let node = target::of(&table.editor().state, target::Fills::Strokes).expect("a node was made");
    assert_eq!(table.editor().state.document.wires(&node, "scalp").len(), 1);
    assert_eq!(table.editor().state.document.display, Some(node));
    // Two frames after its evaluation is done it is a curve of what is displayed, on the head where the pen was.
    let mut frames_after = 0;
    let curves = |editor: &Editor| editor.state.shown.as_ref().map(|s| s.curves.curve_count());
    until("it is a curve", || {
        let state = &table.editor().state;
        frames_after += usize::from(state.run.reports.revision == state.revision);
        assert!(frames_after <= 2);
        table.step();
        curves(table.editor()) == Some(1)
    });
    table.rest();
    let shown = table.editor().state.shown.clone().expect("a result");
    assert_eq!(shown.curves.curve_count(), 1);
    let (tuft, _) = shown.curves.each().next().expect("a curve");
    let tuft = tuft.clone();
    let ends = [tuft.curve(0)[0], tuft.curve(0)[tuft.curve(0).len() - 1]];
    for (end, (at, _)) in ends.iter().zip([row(300.0)[0], row(300.0)[29]]) {
        let seen = table.editor().viewport.projection().screen(*end).expect("before the eye");
        let seen = table.on_sheet(seen);
        assert!(seen.distance(at) < 6.0, "{seen} {at}");
    }
    table.editor().apply(Event::Undo);
    assert_eq!(table.editor().state.document, before);
    table.rest();
    assert_eq!(table.editor().state.shown.as_ref().map(|s| s.curves.curve_count()), Some(0));
}

/// A document with one stroke over the head, and the points tool in hand.
fn with_a_row() -> (Table, u64) {
    let mut table = draw_on(head());
    table.draw(&row(300.0));
    table.rest();
    table.editor().act("pen.points");
    table.step();
    let id = table.strokes().0[0].id;
    (table, id)
}

impl Table {
    /// Where a point of a stroke is on the screen.
    fn point(&mut self, id: u64, at: usize) -> Pos2 {
        self.step();
        let shape = self.editor().pen.shapes.of(id).expect("the stroke is there");
        let at = shape.screen[at].expect("before the eye");
        self.on_sheet(at)
    }
    fn drag(&mut self, from: Pos2, by: Vec2) {
        let places: Vec<(Pos2, f32)> =
            (0..=8).map(|k| (from + by * (k as f32 / 8.0), 0.5)).collect();
        self.draw(&places);
        self.step();
    }
    fn click(&mut self, at: Pos2) {
        self.time += 1.0;
        self.draw(&[(at, 0.5), (at, 0.5)]);
        self.step();
    }
    pub(super) fn done(&mut self) -> usize {
        self.editor().state.history.done()
    }
}

#[test]
fn live_and_replayed_strokes_have_the_same_bits_and_one_id() {
    // One sample a frame with the evaluator keeping up, and all samples in one frame.
    let mut live = draw_on(head());
    let places = row(290.0);
    live.pen(Phase::Down, places[0].0, places[0].1);
    let mut ids = BTreeSet::new();
    for (at, pressure) in &places[1..] {
        live.pen(Phase::Move, *at, *pressure);
        live.rest();
        ids.extend(live.strokes().0.iter().map(|stroke| stroke.id));
    }
    let during = live.editor().state.shown.as_ref().map(|shown| shown.curves.curve_count());
    assert_eq!(during, Some(1), "the hair follows while the pen is down");
    live.pen(Phase::Up, places[29].0, 0.0);
    live.step();
    let mut replay = draw_on(head());
    replay.time = 0.0;
    replay.pen(Phase::Down, places[0].0, places[0].1);
    for (at, pressure) in &places[1..] {
        replay.pen(Phase::Move, *at, *pressure);
    }
    replay.pen(Phase::Up, places[29].0, 0.0);
    replay.step();
    assert_eq!(live.strokes(), replay.strokes());
    assert_eq!(ids.len(), 1);
    assert_eq!((live.done(), replay.done()), (1, 1));
    let first = live.strokes().0[0].samples[0];
    assert_eq!((first.time, first.pressure), (0.0, 0.25));
}

#[test]
fn a_touch_that_draws_nothing_changes_nothing() {
    let mut table = draw_on(head());
    let before = table.editor().state.document.clone();
    table.click(Pos2::new(300.0, 300.0));
    // A pen that leaves in the middle of a stroke, and Escape.
    table.pen(Phase::Down, Pos2::new(300.0, 300.0), 0.5);
    table.pen(Phase::Move, Pos2::new(330.0, 300.0), 0.5);
    table.step();
    table.rest();
    table.pen(Phase::Out, Pos2::new(330.0, 300.0), 0.0);
    table.step();
    assert_eq!(table.editor().state.document, before);
    assert_eq!(table.done(), 0);
    assert!(!table.editor().state.gesture);
}

#[test]
fn a_touch_that_hits_nothing_makes_nothing_and_says_why() {
    let mut table = draw_on(head());
    let before = table.editor().state.document.clone();
    let touch = |table: &mut Table, action: &str, places: &[(Pos2, f32)]| {
        table.editor().act(action);
        table.draw(places);
        table.step();
        table.rest();
        assert_eq!(table.editor().state.document, before, "{action}");
        assert_eq!(table.done(), 0, "{action}");
        table.editor().pen.said.take().map_or_else(String::new, |said| said.text)
    };
    // On the background, and where the hand hardly moves.
    let at = |x: f32, y: f32| (Pos2::new(x, y), 0.5);
    let beside = [at(30.0, 300.0), at(40.0, 420.0)];
    assert!(touch(&mut table, "pen.draw", &beside).contains("begins on the head"));
    let still = [at(300.0, 300.0), at(301.0, 300.0)];
    assert!(touch(&mut table, "pen.draw", &still).contains("too short"));
    // Tools that have nothing to work on offer what would.
    let over = [at(280.0, 300.0), at(320.0, 300.0)];
    for (action, why) in [
        ("pen.points", "draw one with P"),
        ("pen.redraw", "draw one with P"),
        ("pen.erase", "H, then K"),
        ("pen.comb", "H, then C"),
        ("pen.smooth_brush", "H, then S"),
    ] {
        let said = touch(&mut table, action, &over);
        assert!(said.contains(why), "{action}: {said}");
    }
}

#[test]
fn another_kind_of_tool_takes_back_what_is_under_way_and_leaves_what_was_lifted() {
    let mut table = draw_on(head());
    let before = table.editor().state.document.clone();
    for (tool, next) in
        [("pen.draw", "mask.paint"), ("mask.paint", "hair.sketch"), ("hair.sketch", "pen.draw")]
    {
        for steps in [0, 1] {
            table.editor().act(tool);
            table.rest();
            let places = row(300.0);
            table.pen(Phase::Down, places[0].0, 0.9);
            places[1..].iter().for_each(|(at, _)| table.pen(Phase::Move, *at, 0.9));
            until("it is in the document", || {
                table.step();
                table.editor().state.gesture
            });
            if steps == 1 {
                table.pen(Phase::Up, places[29].0, 0.0);
                table.step();
            }
            table.editor().act(next);
            table.step();
            assert_eq!(table.done(), steps, "{tool}");
            assert_eq!(table.editor().state.document == before, steps == 0, "{tool}");
            assert!(!table.editor().state.gesture && !table.editor().pen.is_drawing(), "{tool}");
            // A pen that is still down begins nothing.
            table.pen(Phase::Up, places[29].0, 0.0);
            table.step();
            assert_eq!(table.done(), steps, "{tool}");
            if steps == 1 {
                table.editor().apply(Event::Undo);
            }
        }
    }
}

#[test]
fn a_stroke_in_space_glides_over_the_face_and_leaves_it_at_the_outline() {
    let mut document = head();
    let (node, mut edits) = target::make(&document, false).expect("a head");
    let setting = Setting::Known(Value::Text("free".into()));
    edits.push(Edit::SetInput { node, input: "project".to_owned(), setting });
    Edit::Several(edits).apply(&mut document).expect("it is put in");
    let mut table = draw_on(document);
    let state = &table.editor().state;
    let scalp = state.shown.as_ref().and_then(|shown| shown.scalp()).expect("a head").clone();
    let frame = *scalp.frame();
    table.look_from_the_front();
    // From the crown over the forehead, an eye and a cheek, and aside off the head.
    let down = (0..30).map(|k| (Pos2::new(330.0, 110.0 + 8.0 * k as f32), 0.5));
    let off = (0..30).map(|k| (Pos2::new(330.0 + 8.0 * k as f32, 350.0), 0.5));
    table.draw(&down.chain(off).collect::<Vec<_>>());
    table.rest();
    let strokes = table.strokes();
    let [stroke] = &strokes.0[..] else { panic!("{} strokes", strokes.0.len()) };
    let places: Vec<Vec3> =
        stroke.samples.iter().map(|sample| frame.point_from_head(sample.position)).collect();
    let skin = scalp.skin();
    let deep = places[1..].iter().map(|p| skin.distance(*p)).fold(f32::MAX, f32::min);
    assert!(deep > 0.0, "{deep}");
    // It lay on the face, which is far before the crown where it began, and goes on as deep as it left it.
    let forward = |p: &Vec3| frame.head_from_point(*p).z;
    let most = places.iter().map(forward).fold(f32::MIN, f32::max);
    let last = places[places.len() - 1];
    assert!(most > forward(&places[0]) + 2.0, "{most}");
    let over = places.iter().filter(|p| skin.distance(**p) < 0.3).count();
    assert!(over > places.len() / 2, "{over} of {}", places.len());
    assert!(skin.distance(last) > 0.5 && forward(&last).abs() < 6.0, "{last}");
}

#[test]
fn undo_in_the_middle_of_a_stroke_ends_it() {
    let mut table = draw_on(head());
    table.pen(Phase::Down, Pos2::new(300.0, 300.0), 0.5);
    table.pen(Phase::Move, Pos2::new(330.0, 300.0), 0.5);
    table.rest();
    table.editor().apply(Event::Undo);
    table.pen(Phase::Move, Pos2::new(360.0, 300.0), 0.5);
    table.step();
    table.pen(Phase::Up, Pos2::new(360.0, 300.0), 0.5);
    table.step();
    assert_eq!(table.strokes().0.len(), 0);
    assert!(!table.editor().pen.is_drawing());
}

#[test]
fn strokes_near_the_middle_snap_to_it_when_both_sides_are_drawn() {
    let mut table = draw_on(head());
    table.editor().act("pen.symmetry");
    // Down the middle with a tremble of 2 mm, and a row beside it.
    let places: Vec<(Pos2, f32)> = (0..30)
        .map(|k| {
            (Pos2::new(300.0 + if k % 2 == 0 { 3.0 } else { -3.0 }, 240.0 + 3.0 * k as f32), 0.5)
        })
        .collect();
    table.draw(&places);
    table.step();
    assert!(table.strokes().0[0].samples.iter().all(|s| s.position.x == 0.0));
    table.draw(&row(300.0));
    table.rest();
    assert!(table.strokes().0[1].samples.iter().any(|s| s.position.x != 0.0));
    let shown = table.editor().state.shown.clone().expect("a result");
    assert_eq!(shown.curves.curve_count(), 3, "the row has a twin, the middle has none");
}

#[test]
fn points_are_picked_moved_with_falloff_and_stay_on_the_scalp() {
    let (mut table, id) = with_a_row();
    let before = table.strokes().0[0].clone();
    assert!(before.samples.len() > 4);
    let at = table.point(id, 2);
    table.drag(at, Vec2::new(0.0, 30.0));
    let after = table.strokes().0[0].clone();
    assert_eq!(table.done(), 2);
    let way = |i: usize| before.samples[i].position.distance(after.samples[i].position);
    assert!(way(2) > 1.0, "{}", way(2));
    assert!(way(0) == 0.0 && way(3) < way(2) && way(3) > 0.0, "{} {}", way(0), way(3));
    let scalp = table.editor().state.shown.as_ref().and_then(|s| s.scalp().cloned()).expect("one");
    for sample in &after.samples {
        let p = scalp.frame().point_from_head(sample.position);
        let hit = scalp.surface().closest(p).expect("a surface");
        assert!(hit.distance < 0.05, "{}", hit.distance);
    }
    // As it was drawn, by name.
    table.editor().act("strokes.refit");
    assert_eq!(table.strokes().0[0].samples, before.samples);
    table.editor().apply(Event::Undo);
    table.editor().apply(Event::Undo);
    assert_eq!(table.strokes().0[0], before);
}

#[test]
fn what_is_picked_can_be_changed_by_name_each_in_one_step() {
    let (mut table, id) = with_a_row();
    let at = table.point(id, 1);
    let root = table.point(id, 0);
    for (action, strokes) in [
        ("strokes.insert", 1),
        ("strokes.reverse", 1),
        ("strokes.smooth", 1),
        ("strokes.straighten", 1),
        ("strokes.extend", 1),
        ("strokes.shorten", 1),
        ("strokes.mirror_once", 2),
        ("strokes.delete", 0),
    ] {
        table.editor().act("strokes.all");
        table.editor().act(action);
        assert_eq!(table.done(), 2, "{action}: {:?}", table.editor().state.notes.all());
        assert_eq!(table.strokes().0.len(), strokes, "{action}");
        table.editor().apply(Event::Undo);
    }
    for (action, strokes) in [
        ("strokes.slide_tip", 1),
        ("strokes.slide_root", 1),
        ("strokes.cut", 2),
        ("strokes.delete", 1),
    ] {
        table.click(Pos2::new(30.0, 30.0));
        table.click(at);
        assert_eq!(table.editor().pen.picked.points, BTreeSet::from([(id, 1)]), "{action}");
        table.editor().act(action);
        assert_eq!(table.done(), 2, "{action}: {:?}", table.editor().state.notes.all());
        assert_eq!(table.strokes().0.len(), strokes, "{action}");
        table.editor().apply(Event::Undo);
        table.step();
    }
    // Box and grow.
    table.drag(root - Vec2::splat(8.0), Vec2::splat(12.0));
    assert_eq!(table.editor().pen.picked.points, BTreeSet::from([(id, 0)]));
    table.editor().act("strokes.grow");
    assert_eq!(table.editor().pen.picked.points.len(), 2);
}

#[test]
fn points_are_raised_over_the_scalp_by_number() {
    let (mut table, id) = with_a_row();
    let before = table.strokes().0[0].clone();
    let scalp = table.editor().state.shown.as_ref().and_then(|s| s.scalp().cloned()).expect("one");
    let raised = edits::raised(&scalp, &before, &BTreeSet::from([2, 3]), 1.5);
    let path = edits::path(&scalp, &raised);
    for (i, p) in path.iter().enumerate() {
        let height = edits::height(&scalp, *p).expect("a surface");
        let expected = if i == 2 || i == 3 { 1.5 } else { 0.0 };
        assert!((height - expected).abs() < 0.03, "{i}: {height}");
    }
    // The field is there for picked points.
    let numbers = |table: &mut Table| {
        use egui_kittest::kittest::Queryable;
        table.step();
        table.harness.get_all_by_role(egui::accesskit::Role::SpinButton).count()
    };
    let none = numbers(&mut table);
    let at = table.point(id, 2);
    table.click(at);
    assert_eq!(numbers(&mut table), none + 1);
}

#[test]
fn two_strokes_become_one_and_a_part_is_drawn_anew() {
    let (mut table, _) = with_a_row();
    table.editor().act("pen.draw");
    table.draw(&row(330.0));
    table.step();
    table.editor().act("strokes.all");
    table.editor().act("strokes.join");
    assert_eq!(table.strokes().0.len(), 1);
    table.editor().apply(Event::Undo);
    table.editor().act("pen.redraw");
    table.step();
    let before = table.strokes();
    let arc: Vec<(Pos2, f32)> = (0..=20)
        .map(|k| {
            let t = k as f32 / 20.0;
            (Pos2::new(270.0 + 50.0 * t, 300.0 - 20.0 * (t * std::f32::consts::PI).sin()), 0.5)
        })
        .collect();
    table.draw(&arc);
    table.step();
    let after = table.strokes();
    assert_eq!(after.0[1], before.0[1]);
    assert_ne!(after.0[0].samples, before.0[0].samples);
    assert_eq!(after.0[0].samples[0], before.0[0].samples[0]);
    assert_eq!(
        after.0[0].samples.last().map(|s| s.position),
        before.0[0].samples.last().map(|s| s.position)
    );
    assert_eq!(table.done(), 3);
}

#[test]
fn brushes_erase_comb_and_smooth_in_one_step_each_and_locked_strokes_stay() {
    let mut table = draw_on(head());
    let wild: Vec<(Pos2, f32)> = row(300.0)
        .iter()
        .enumerate()
        .map(|(k, (at, p))| (*at + Vec2::new(0.0, if k % 4 < 2 { 6.0 } else { -6.0 }), *p))
        .collect();
    table.draw(&wild);
    table.rest();
    let (before, id) = (table.strokes(), table.strokes().0[0].id);
    for tool in ["pen.comb", "pen.smooth_brush", "pen.erase"] {
        table.editor().act(tool);
        table.drag(Pos2::new(300.0, 285.0), Vec2::new(0.0, 30.0));
        let after = table.strokes();
        assert_eq!(table.done(), 2, "{tool}");
        assert_ne!(before, after, "{tool}");
        if let Some(stroke) = after.0.first() {
            assert_eq!(stroke.samples[0], before.0[0].samples[0], "{tool}");
        }
        table.editor().apply(Event::Undo);
        table.editor().state.visibility.locked.insert(id);
        table.step();
        table.drag(Pos2::new(300.0, 285.0), Vec2::new(0.0, 30.0));
        assert_eq!(table.strokes(), before, "{tool}: locked");
        table.editor().state.visibility.locked.clear();
        table.step();
    }
    // The eraser end, whatever the tool is.
    table.editor().act("pen.draw");
    for (phase, y) in [(Phase::Down, 280.0), (Phase::Move, 300.0), (Phase::Up, 300.0)] {
        table.time += 0.01;
        let at = table.on_screen(Pos2::new(300.0, y));
        let sample = PenSample::mouse(table.time, phase, at, 0.5);
        let sample = PenSample { tool: Tool::Eraser, device: Device(10), ..sample };
        table.editor().pen.devices.push(sample);
    }
    table.step();
    assert_eq!(table.strokes().0.len(), 0);
}

#[test]
fn a_stroke_is_picked_by_its_curve_selected_elsewhere() {
    let (mut table, id) = with_a_row();
    table.editor().act("pen.select");
    let shown = table.editor().state.shown.clone().expect("a result");
    let curve = shown.curves.each().next().map(|(tuft, i)| tuft.id(i)).expect("a curve");
    table.editor().apply(Event::Select(crate::core::state::Select::Curves([curve].into())));
    table.step();
    assert_eq!(table.editor().pen.picked.strokes, BTreeSet::from([id]));
    table.editor().act("strokes.delete");
    assert_eq!(table.strokes().0.len(), 0);
}

#[test]
fn a_mouse_draws_too_and_the_keys_that_turn_the_view_keep_it_from_drawing() {
    // What is in hand, keys that are held -> strokes there are.
    for (tool, modifiers, strokes) in [
        ("pen.draw", egui::Modifiers::NONE, 1),
        ("pen.draw", egui::Modifiers::ALT, 0),
        ("pen.select", egui::Modifiers::NONE, 0),
    ] {
        let mut table = draw_on(head());
        table.editor().act(tool);
        let before = table.editor().viewport.projection().camera;
        table.harness.event(egui::Event::ModifiersChanged(modifiers));
        for (k, (at, _)) in row(300.0).iter().enumerate() {
            let pos = table.on_screen(*at);
            table.harness.event(egui::Event::PointerMoved(pos));
            table.step();
            if k == 0 || k == 29 {
                let button = egui::PointerButton::Primary;
                let pressed = k == 0;
                table.harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
                table.step();
            }
        }
        table.step();
        assert_eq!(table.strokes().0.len(), strokes, "{tool} {modifiers:?}");
        let turned = table.editor().viewport.projection().camera != before;
        assert_eq!(turned, modifiers.alt, "{tool} {modifiers:?}");
        if let Some(stroke) = table.strokes().0.first() {
            assert!(stroke.samples.iter().all(|s| (s.pressure - 0.5).abs() < 0.01));
            assert!(stroke.samples.len() > 4);
        }
    }
}

#[test]
fn the_line_is_painted_in_the_frame_of_its_samples() {
    let (mut table, _) = with_a_row();
    table.editor().act("pen.draw");
    table.pen(Phase::Down, Pos2::new(240.0, 320.0), 0.5);
    table.step();
    for k in 1..20 {
        table.pen(Phase::Move, Pos2::new(240.0 + 5.0 * k as f32, 320.0), 0.5);
        table.step();
        let shapes = table.harness.output().shapes.iter();
        let is_ink = |shape: &&egui::epaint::ClippedShape| matches!(&shape.shape, egui::Shape::LineSegment { stroke, .. } if stroke.color == crate::widgets::theme::ACCENT.dark);
        let drawn = shapes.filter(is_ink).count();
        assert_eq!(drawn, k, "the line leads through every sample");
        table.rest();
    }
    table.pen(Phase::Up, Pos2::new(340.0, 320.0), 0.5);
    table.step();
    assert_eq!(table.strokes().0.len(), 2);
}

#[test]
fn a_stroke_that_becomes_no_hair_lies_on_no_node_hides_no_hair_and_says_so() {
    // Two recipes: all outputs are displayed, none by itself.
    let mut document = head();
    for at in [14, 14] {
        let made = recipes::ALL[at].edits(&document, None, false, None).expect("a recipe");
        Edit::Several(made.edits).apply(&mut document).expect("it is put in");
    }
    let outputs = document.nodes.values().filter(|node| node.kind == "groom_output").count();
    assert_eq!((outputs, &document.display), (2, &None));
    // Few hairs will do.
    for node in document.nodes.values_mut().filter(|node| node.kind == "parameters") {
        Arc::make_mut(node).inputs.insert("count".into(), Setting::Known(Value::Int(300)));
    }
    let mut table = draw_on(document);
    table.draw(&row(300.0));
    table.rest();
    let said = table.editor().pen.said.take().map_or_else(String::new, |said| said.text);
    assert!(said.contains("Strokes are no hair yet"), "{said}");
    let state = &table.editor().state;
    assert_eq!(state.document.display, None, "the hair is seen as before");
    let drawn = state.document.nodes.iter().find(|(_, node)| node.kind == target::KIND);
    let id = drawn.expect("the strokes").0.clone();
    // It lies beside all others, whatever their heights are: below where it would stand, a whole node of 140 is free.
    let at = state.document.layout[&id];
    let fresh = crate::core::faces::arrange::free_in(
        &{
            let mut others = state.document.clone();
            Edit::RemoveNode { id: id.clone() }.apply(&mut others).expect("it goes");
            others
        },
        at,
        target::STEP,
    );
    assert_eq!(fresh, at, "it is free");
}

#[test]
fn what_stands_on_the_picture_is_pressed_and_not_drawn_on_however_slow_a_frame_is() {
    use egui::{Event, PointerButton};
    use egui_kittest::kittest::Queryable;
    let mut table = draw_on(head());
    table.editor().act("hair.implant");
    table.rest();
    let button = table.harness.get_by_label("From \u{23f7}").rect().center();
    // Pressed, let go, and left for the menu below, all within one frame; and with a pen, which egui's pointer trails.
    let press = |pressed| Event::PointerButton {
        pos: button,
        button: PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let below = button + Vec2::new(0.0, 60.0);
    let events =
        [Event::PointerMoved(button), press(true), press(false), Event::PointerMoved(below)];
    table.harness.input_mut().events.extend(events);
    table.step();
    for phase in [Phase::Hover, Phase::Down, Phase::Up] {
        let report = PenSample::mouse(table.time, phase, button, 0.9);
        let report = PenSample { tool: Tool::Tip, device: Device(9), ..report };
        table.editor().pen.devices.push(report);
    }
    table.rest();
    let said = table.editor().pen.said.take().map(|said| said.text);
    assert_eq!((said, table.done()), (None, 0));
    // Beside it, the same says what is wrong.
    let at = table.on_screen(Pos2::new(20.0, 300.0));
    for phase in [Phase::Hover, Phase::Down, Phase::Up] {
        let report = PenSample::mouse(table.time, phase, at, 0.9);
        let report = PenSample { tool: Tool::Tip, device: Device(9), ..report };
        table.editor().pen.devices.push(report);
    }
    table.rest();
    assert!(table.editor().pen.said.is_some());
}

#[test]
fn an_entry_of_a_menu_over_the_picture_is_picked_and_not_drawn_on_however_slow_a_frame_is() {
    use egui::{Event, PointerButton};
    use egui_kittest::kittest::Queryable;
    let mut table = draw_on(head());
    table.editor().act("hair.implant");
    table.rest();
    // All within one frame, and each in one of its own.
    for slow in [true, false] {
        for label in ["From \u{23f7}", "Left"] {
            let at = table.harness.get_by_label_contains(label).rect().center();
            let press = |pressed| Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            };
            for event in [Event::PointerMoved(at), press(true), press(false)] {
                table.harness.input_mut().events.push(event);
                if !slow {
                    table.step();
                }
            }
            table.step();
            table.step();
        }
        table.rest();
        let said = table.editor().pen.said.take().map(|said| said.text);
        assert_eq!((said, table.done()), (None, 0), "slow: {slow}");
    }
}
