//! The pen on hair in the editor: samples in, gestures, hair and undo steps out.

mod fine;
mod frozen;
mod styles;

use super::super::sample::{Device, PenSample as Report, Phase, Tool as End};
use super::super::target::{Fills, gestures, of};
use super::super::tests::{Table, draw_on, head};
use super::target;
use crate::testing::until;
use coif_graphs::document::{Document, NodeId, Socket};
use coif_graphs::schedule::files::DiskFiles;
use coif_graphs::schedule::request::plan;
use coif_graphs::schedule::result::content_hash;
use coif_graphs::schedule::run::{CancelToken, Evaluator, OnFailure, Quiet};
use coif_nodes::data::curves::Curves;
use coif_nodes::data::gestures::{Gesture, Gestures, Layer, Tool};
use coif_nodes::define::Value;
use coif_nodes::eval::Quality;
use coif_nodes::maths::nearest_on;
use egui::{Pos2, Vec2};
use glam::Vec3;
use std::sync::Arc;

/// The editor with the pen on hair, seen from the front; places are told as on a sheet of 600 by 600.
struct Salon(Table);

/// Pressures of the three levels.
const LIGHT: f32 = 0.2;
const MIDDLE: f32 = 0.5;
const HEAVY: f32 = 0.9;

impl Salon {
    fn open(document: Document, action: &str) -> Self {
        let mut table = draw_on(document);
        table.look_from_the_front();
        table.editor().act(action);
        table.rest();
        Self(table)
    }
    fn rest(&mut self) {
        until("the touch ends", || {
            self.0.rest();
            !self.0.editor().pen.touches.is_busy()
        });
    }
    fn line(from: [f32; 2], to: [f32; 2]) -> Vec<Pos2> {
        let at =
            |k: i32| Pos2::from(from) + (Pos2::from(to) - Pos2::from(from)) * (k as f32 / 24.0);
        (0..=24).map(at).collect()
    }
    fn report(&mut self, phase: Phase, at: Pos2, pressure: f32, end: End) {
        self.0.time += 0.008;
        let at = self.0.on_screen(at);
        let report = Report::mouse(self.0.time, phase, at, pressure);
        let report = Report { tool: end, device: Device(9), ..report };
        self.0.editor().pen.devices.push(report);
    }
    fn begin(&mut self, places: &[Pos2], pressure: f32, end: End) {
        self.0.time += 1.0;
        self.report(Phase::Hover, places[0], 0.0, end);
        self.report(Phase::Down, places[0], pressure, end);
        for at in &places[1..] {
            self.report(Phase::Move, *at, pressure, end);
        }
    }
    /// A whole stroke, all its reports in one frame.
    fn draw(&mut self, places: &[Pos2], pressure: f32) {
        self.draw_with(places, pressure, End::Tip);
    }
    fn draw_with(&mut self, places: &[Pos2], pressure: f32, end: End) {
        self.begin(places, pressure, end);
        self.report(Phase::Up, places[places.len() - 1], 0.0, end);
        self.rest();
    }
    fn node(&mut self) -> Option<NodeId> {
        of(&self.0.editor().state, Fills::Hair)
    }
    fn gestures(&mut self) -> Arc<Gestures> {
        let node = self.node();
        let document = &self.0.editor().state.document;
        node.map_or_else(Arc::default, |id| gestures(document, &id))
    }
    /// The curves of the sketch as they are shown.
    fn curves(&mut self) -> Curves {
        let node = self.node().expect("a sketch");
        let shown = self.0.editor().state.shown.clone().expect("a result");
        shown.curves_of(&target::output(&node)).expect("its curves").clone()
    }
    fn words(&mut self) -> String {
        let history = &self.0.editor().state.history;
        history.steps().nth(history.done() - 1).expect("a step").words.clone()
    }
    /// What the status line says.
    fn said(&mut self) -> Option<String> {
        self.0.step();
        self.0.editor().state.notes.all().last().map(|note| note.text.clone())
    }
    fn tools(&mut self) -> Vec<Tool> {
        self.gestures().0.iter().map(|gesture| gesture.tool).collect()
    }
    /// Where a CV is on the sheet.
    fn place(&mut self, curve: usize, cv: usize) -> Pos2 {
        let curves = self.curves();
        let (tuft, i) = curves.each().nth(curve).expect("a curve");
        let p = tuft.curve(i)[cv.min(tuft.curve(i).len() - 1)];
        let at = self.0.editor().viewport.projection().screen(p).expect("before the eye");
        self.0.on_sheet(at)
    }
}

/// From the forehead up and down to the side.
fn lock() -> Vec<Pos2> {
    Salon::line([300.0, 130.0], [330.0, 420.0])
}

#[test]
fn a_heavy_stroke_from_the_skin_is_a_cluster_in_one_step_with_a_name() {
    let mut salon = Salon::open(head(), "hair.sketch");
    let before = salon.0.editor().state.document.clone();
    salon.draw(&lock(), HEAVY);
    assert_eq!(salon.tools(), [Tool::Implant]);
    let gestures = salon.gestures();
    let gesture = &gestures.0[0];
    assert_eq!((gesture.layer, gesture.curves.len()), (Layer::Scalp, 0));
    assert!(gesture.root.is_some() && !gesture.path.is_empty());
    assert_eq!((salon.0.done(), salon.words().as_str()), (1, "implanted a cluster"));
    assert_eq!(salon.curves().curve_count(), 1);
    // It runs where the pen did.
    for (cv, at) in [(0, lock()[0]), (99, lock()[24])] {
        let there = salon.place(0, cv);
        assert!(there.distance(at) < 3.0, "{there} {at}");
    }
    salon.0.editor().apply(crate::core::event::Event::Undo);
    assert_eq!(salon.0.editor().state.document, before);
}

#[test]
fn what_is_seen_before_the_pen_is_lifted_is_what_stays_and_what_a_farm_makes() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    salon.draw(&Salon::line([360.0, 140.0], [420.0, 420.0]), HEAVY);
    for (places, pressure) in [
        (Salon::line([240.0, 130.0], [200.0, 400.0]), HEAVY),
        (Salon::line([310.0, 250.0], [360.0, 260.0]), MIDDLE),
    ] {
        salon.begin(&places, pressure, End::Tip);
        salon.rest_drawing();
        let seen = salon.curves();
        salon.report(Phase::Up, places[24], 0.0, End::Tip);
        salon.rest();
        let stays = salon.curves();
        assert_eq!(seen.curve_count(), stays.curve_count());
        for ((a, i), (b, j)) in seen.each().zip(stays.each()) {
            assert_eq!(a.id(i), b.id(j));
            let off = a.curve(i).iter().zip(b.curve(j)).map(|(p, q)| p.distance(*q));
            let most = off.fold(0.0, f32::max);
            assert!(most < 1e-4, "{most}");
        }
    }
    assert_eq!(salon.tools(), [Tool::Implant, Tool::Implant, Tool::Implant, Tool::Comb]);
    assert_eq!(content_hash(&salon.farmed()), content_hash(&salon.curves()));
}

impl Salon {
    /// The curves of the sketch, written, read and evaluated without a window.
    fn farmed(&mut self) -> Curves {
        let text = coif_graphs::file::write(&self.0.editor().state.document);
        let read = coif_graphs::file::read(&text).expect("it reads").document;
        let socket = target::output(&self.node().expect("a sketch"));
        let files = DiskFiles::default();
        let planned = plan(&read, &[socket], Quality::Final, &files).expect("it can be evaluated");
        let evaluator = Evaluator::new(1, 1 << 28).expect("threads");
        let outcome = evaluator.run(&planned, OnFailure::Stop, &CancelToken::default(), &Quiet);
        let Some(Some(Value::Curves(made))) = outcome.targets.first() else { panic!("no curves") };
        made.clone()
    }
    /// Until what is drawn so far is evaluated, with the pen still down.
    fn rest_drawing(&mut self) {
        for _ in 0..3 {
            self.0.rest();
        }
    }
}

#[test]
fn the_paper_grammar_combs_lengthens_cuts_twists_frizzes_and_pins() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    let tip = salon.place(0, 99);
    salon.draw(&Salon::line([tip.x, tip.y], [tip.x + 10.0, tip.y + 90.0]), LIGHT);
    let middle = salon.place(0, 4);
    salon
        .draw(&Salon::line([middle.x - 4.0, middle.y], [middle.x + 60.0, middle.y + 10.0]), MIDDLE);
    let middle = salon.place(0, 4);
    // Two taps.
    for _ in 0..2 {
        salon.0.time -= 0.8;
        salon.draw(&[middle, middle], MIDDLE);
    }
    // Straight across, with the eraser.
    let low = salon.place(0, 5);
    salon.draw_with(
        &Salon::line([low.x - 80.0, low.y - 5.0], [low.x + 80.0, low.y + 5.0]),
        MIDDLE,
        End::Eraser,
    );
    // Circles, clockwise, with the eraser.
    let middle = salon.place(0, 3);
    let circle = |k: i32| middle + Vec2::angled(k as f32 * 0.2) * 45.0;
    salon.draw_with(&(0..70).map(circle).collect::<Vec<_>>(), LIGHT, End::Eraser);
    // Loops down the cluster.
    let coil = |k: i32| {
        let t = k as f32 * 0.2;
        middle + Vec2::new(-24.0, 0.0) + Vec2::angled(t) * 24.0 + Vec2::new(0.0, 3.0 * t)
    };
    salon.draw(&(0..70).map(coil).collect::<Vec<_>>(), MIDDLE);
    // To and fro.
    let saw = |k: i32| {
        let swing = ((k % 16) - 8).abs() as f32 / 4.0 - 1.0;
        middle + Vec2::new(swing * 55.0, k as f32 * 0.7)
    };
    salon.draw(&(0..97).map(saw).collect::<Vec<_>>(), MIDDLE);
    use Tool::{Comb, Cut, Density, Frizz, Implant, Lengthen, Pin, Twist};
    assert_eq!(
        salon.tools(),
        [Implant, Lengthen, Comb, Pin, Cut, Density, Twist, Frizz],
        "{:?}",
        salon.0.editor().pen.said
    );
    let words: Vec<String> =
        salon.0.editor().state.history.steps().map(|step| step.words.clone()).collect();
    assert_eq!(
        words,
        [
            "implanted a cluster",
            "lengthened a cluster",
            "combed a cluster",
            "pinned a cluster",
            "cut a cluster",
            "changed the density of a cluster",
            "twisted a cluster",
            "frizzed a cluster"
        ]
    );
    // Each knows whom it changed.
    let id = salon.curves().each().next().map(|(tuft, i)| tuft.id(i)).expect("a curve");
    assert!(salon.gestures().0[1..].iter().all(|gesture| gesture.curves == [id]));
}

#[test]
fn a_touch_that_does_nothing_changes_nothing_and_says_why() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    let before = salon.0.editor().state.document.clone();
    // Beside all hair; off the head; a crooked cut; a lone tap; too short.
    for (places, pressure, end, why) in [
        (Salon::line([200.0, 300.0], [190.0, 380.0]), MIDDLE, End::Tip, "The comb passes no curve"),
        (Salon::line([68.0, 300.0], [60.0, 380.0]), HEAVY, End::Tip, "off the scalp"),
        (Salon::line([200.0, 300.0], [150.0, 300.0]), MIDDLE, End::Eraser, "crosses no hair"),
    ] {
        salon.draw_with(&places, pressure, end);
        let said = salon.0.editor().pen.said.clone().expect("a word").text;
        assert!(said.contains(why), "{said}");
        assert_eq!(salon.0.editor().state.document, before, "{why}");
        assert_eq!(salon.0.done(), 1, "{why}");
        assert!(!salon.0.editor().state.gesture);
    }
    // Escape, and a pen that leaves.
    salon.begin(&Salon::line([310.0, 250.0], [360.0, 260.0]), MIDDLE, End::Tip);
    salon.rest_drawing();
    assert_ne!(salon.0.editor().state.document, before);
    salon.0.harness.key_down(egui::Key::Escape);
    salon.0.step();
    salon.0.harness.key_up(egui::Key::Escape);
    salon.rest();
    assert_eq!(salon.0.editor().state.document, before);
    salon.report(Phase::Up, Pos2::new(360.0, 260.0), 0.0, End::Tip);
    salon.begin(&Salon::line([310.0, 250.0], [360.0, 260.0]), MIDDLE, End::Tip);
    salon.rest_drawing();
    salon.report(Phase::Out, Pos2::new(360.0, 260.0), 0.0, End::Tip);
    salon.rest();
    assert_eq!((salon.0.editor().state.document == before, salon.0.done()), (true, 1));
}

#[test]
fn the_first_comb_of_generated_guides_puts_a_sketch_behind_them_in_the_same_step() {
    let text = coif_graphs::grooms::by_name("start").expect("the start-up groom");
    let mut document = coif_graphs::file::read(text).expect("it reads").document;
    let few = coif_graphs::document::Setting::Known(Value::Int(2000));
    let hair = NodeId::new("hair").expect("an id");
    Arc::make_mut(document.nodes.get_mut(&hair).expect("hair")).inputs.insert("count".into(), few);
    let mut salon = Salon::open(document, "hair.comb");
    let before = salon.0.editor().state.document.clone();
    salon.draw(&Salon::line([300.0, 120.0], [380.0, 150.0]), MIDDLE);
    assert_eq!(salon.tools(), [Tool::Comb]);
    assert!(salon.words().starts_with("combed "), "{}", salon.words());
    let document = salon.0.editor().state.document.clone();
    let node = salon.node().expect("a sketch");
    assert_eq!(document.wires(&node, "curves")[0].to_string(), "guides.curves");
    assert_eq!(document.wires(&hair, "guides")[0].node, node);
    assert_eq!(document.wires(&node, "scalp")[0].to_string(), "head.scalp");
    assert_eq!(coif_graphs::document::graph::check(&document), vec![]);
    // Only guides that the pen passed are in it, by their ids.
    let named = salon.gestures().0[0].curves.clone();
    assert!(!named.is_empty() && named.len() < 200, "{}", named.len());
    // The next one goes into the same node.
    salon.draw(&Salon::line([300.0, 130.0], [230.0, 150.0]), MIDDLE);
    assert_eq!(salon.tools().len(), 2);
    salon.0.editor().apply(crate::core::event::Event::Undo);
    salon.0.editor().apply(crate::core::event::Event::Undo);
    assert_eq!(salon.0.editor().state.document, before);
}

#[test]
fn a_mouse_reaches_all_three_levels_by_what_it_touches_and_by_keys() {
    let mut salon = Salon::open(head(), "hair.sketch");
    // On bare skin it plants, from a tip it lengthens, on hair it combs.
    let mouse = |salon: &mut Salon, places: &[Pos2]| {
        salon.0.time += 1.0;
        for (k, at) in places.iter().enumerate() {
            let pos = salon.0.on_screen(*at);
            salon.0.harness.event(egui::Event::PointerMoved(pos));
            salon.0.step();
            if k == 0 || k == places.len() - 1 {
                salon.0.harness.event(egui::Event::PointerButton {
                    pos,
                    button: egui::PointerButton::Primary,
                    pressed: k == 0,
                    modifiers: egui::Modifiers::NONE,
                });
                salon.0.step();
            }
        }
        salon.rest();
    };
    mouse(&mut salon, &lock());
    let tip = salon.place(0, 99);
    mouse(&mut salon, &Salon::line([tip.x, tip.y], [tip.x, tip.y + 60.0]));
    assert_eq!(salon.said(), None);
    let middle = salon.place(0, 4);
    mouse(&mut salon, &Salon::line([middle.x, middle.y], [middle.x + 60.0, middle.y]));
    let said = "combed a cluster; to implant there, choose Implant";
    assert_eq!(salon.said().as_deref(), Some(said));
    salon.0.editor().act("hair.level_3");
    let middle = salon.place(0, 2);
    mouse(
        &mut salon,
        &Salon::line([middle.x + 40.0, middle.y], [middle.x + 60.0, middle.y + 90.0]),
    );
    salon.0.editor().act("hair.level_1");
    let middle = salon.place(0, 1);
    mouse(&mut salon, &Salon::line([middle.x, middle.y], [middle.x + 30.0, middle.y]));
    let told: Vec<(Tool, Layer)> =
        salon.gestures().0.iter().map(|gesture| (gesture.tool, gesture.layer)).collect();
    assert_eq!(
        told,
        [
            (Tool::Implant, Layer::Scalp),
            (Tool::Lengthen, Layer::Nearest),
            (Tool::Comb, Layer::Through),
            (Tool::Implant, Layer::Scalp),
            (Tool::Comb, Layer::Nearest),
        ]
    );
    salon.0.editor().act("hair.level_1");
    assert_eq!(salon.0.editor().pen.hair.level, None);
}

#[test]
fn with_the_pin_tool_a_tap_pins_one_cv_and_a_stroke_all_under_the_brush() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&lock(), HEAVY);
    let middle = salon.place(0, 2);
    salon.0.editor().act("hair.pin");
    salon.draw(&[middle, middle], MIDDLE);
    let count = |salon: &mut Salon| {
        let curves = salon.curves();
        let (tuft, i) = curves.each().next().expect("a curve");
        let pins = tuft.view(coif_nodes::data::attributes::PINNED);
        (0..tuft.curve(i).len()).filter(|k| pins.at(i, *k) != 0).count()
    };
    assert_eq!(count(&mut salon), 1);
    let tip = salon.place(0, 99);
    salon.draw(&Salon::line([tip.x, tip.y], [tip.x + 10.0, tip.y]), MIDDLE);
    let all = salon.gestures().0.clone();
    let told = |gesture: &Gesture| (gesture.tool, gesture.layer, gesture.size > 0.0);
    assert_eq!(told(&all[1]), (Tool::Pin, Layer::Nearest, false));
    assert_eq!(told(&all[2]), (Tool::Pin, Layer::Through, true));
    assert!(count(&mut salon) > 1);
}

#[test]
fn an_implant_that_takes_the_place_of_another_says_so() {
    let mut salon = Salon::open(head(), "hair.implant");
    salon.draw(&lock(), HEAVY);
    assert_eq!(salon.said(), None);
    salon.draw(&Salon::line([302.0, 132.0], [250.0, 400.0]), HEAVY);
    assert_eq!(salon.curves().curve_count(), 1);
    let said = "implanted a cluster; it replaced 1 cluster rooted there: to keep both, undo and begin farther away";
    assert_eq!(salon.said().as_deref(), Some(said));
}

#[test]
fn a_stroke_that_waits_for_hair_is_drawn_as_the_head_was_seen_then() {
    let mut salon = Salon::open(head(), "hair.implant");
    for places in [lock(), Salon::line([240.0, 140.0], [200.0, 420.0])] {
        salon.begin(&places, HEAVY, End::Tip);
        salon.report(Phase::Up, places[places.len() - 1], 0.0, End::Tip);
    }
    salon.0.step();
    assert!(salon.0.editor().pen.touches.is_busy(), "the second waits for the first");
    salon.0.editor().act("view.from_back");
    salon.rest();
    let gestures = salon.gestures();
    assert_eq!(salon.tools(), [Tool::Implant; 2]);
    assert_eq!(gestures.0[0].view.eye, gestures.0[1].view.eye);
}

#[test]
fn with_symmetry_both_sides_of_the_head_are_one_step() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.0.editor().act("pen.symmetry");
    // So far apart that neither tells the other its depth.
    salon.draw(&Salon::line([385.0, 150.0], [410.0, 400.0]), HEAVY);
    assert_eq!((salon.tools().len(), salon.0.done()), (2, 1));
    assert_eq!(salon.words(), "implanted 2 clusters");
    // As far as the built-in head is the same on both sides.
    let apart = |salon: &mut Salon| {
        let curves = salon.curves();
        let shown = salon.0.editor().state.shown.clone().expect("a result");
        let frame = *shown.scalp().expect("a head").frame();
        let both: Vec<Vec<Vec3>> = curves
            .each()
            .map(|(tuft, i)| tuft.curve(i).iter().map(|p| frame.head_from_point(*p)).collect())
            .collect();
        let off = |a: &Vec3| {
            let a = *a * Vec3::new(-1.0, 1.0, 1.0);
            let near = |pair: &[Vec3]| nearest_on([pair[0], pair[1]], a).0.distance(a);
            both[1].windows(2).map(near).fold(f32::MAX, f32::min)
        };
        both[0].iter().map(off).fold(0.0, f32::max)
    };
    let off = apart(&mut salon);
    assert!(off < 0.5, "{off}");
    let middle = salon.place(0, 4);
    salon.draw(&Salon::line([middle.x, middle.y], [middle.x + 60.0, middle.y]), MIDDLE);
    assert_eq!((salon.tools().len(), salon.0.done()), (4, 2));
    assert_eq!(salon.words(), "combed 2 clusters");
    let off = apart(&mut salon);
    assert!(off < 0.5, "{off}");
    // In the middle there is one, and what finds nothing on the other side is alone.
    salon.draw(&Salon::line([300.0, 120.0], [300.0, 180.0]), HEAVY);
    assert_eq!(salon.words(), "implanted a cluster");
    salon.0.editor().apply(crate::core::event::Event::Undo);
    salon.0.editor().apply(crate::core::event::Event::Undo);
    salon.0.editor().apply(crate::core::event::Event::Undo);
    assert_eq!(salon.tools(), []);
}

#[test]
fn a_colour_is_picked_beside_the_head_and_planted() {
    let mut salon = Salon::open(head(), "hair.sketch");
    // To the upper right of where nothing is: a green dye.
    salon.draw(&Salon::line([60.0, 120.0], [60.0, 160.0]), MIDDLE);
    let picked = salon.0.editor().state.settings.pen.hair_colour.expect("a colour");
    assert_eq!((salon.tools().len(), salon.0.done()), (0, 0));
    salon.draw(&lock(), HEAVY);
    let colour = salon.gestures().0[0].colour.expect("its colour");
    assert_eq!(Some(colour), salon.0.editor().state.settings.pen.hair_colour());
    // Back to the middle: the hair's own again.
    salon.draw(&[Pos2::new(60.0, 120.0), Pos2::new(60.0, 160.0), Pos2::new(60.0, 121.0)], MIDDLE);
    assert_eq!(
        salon.0.editor().state.settings.pen.hair_colour,
        Some(picked),
        "a tap picks nothing"
    );
    salon.draw(&[Pos2::new(60.0, 120.0), Pos2::new(60.0, 160.0), Pos2::new(60.0, 126.0)], MIDDLE);
    assert_eq!(salon.0.editor().state.settings.pen.hair_colour, None);
}

#[test]
fn copies_and_outlined_locks_are_planted_in_one_step_each() {
    let mut salon = Salon::open(head(), "hair.sketch");
    salon.draw(&Salon::line([300.0, 130.0], [300.0, 330.0]), HEAVY);
    salon.0.editor().act("hair.scatter");
    salon.draw(&Salon::line([300.0, 135.0], [430.0, 190.0]), MIDDLE);
    let count = salon.curves().curve_count();
    assert!(count > 2, "{count}");
    assert_eq!(salon.words(), format!("scattered {} clusters", count - 1));
    // A leaf: down one side and back up the other.
    salon.0.editor().act("hair.silhouette");
    let leaf = |k: i32| {
        let turn = std::f32::consts::TAU * k as f32 / 60.0;
        Pos2::new(210.0 + 30.0 * turn.sin(), 260.0 - 90.0 * turn.cos())
    };
    salon.draw(&(0..=60).map(leaf).collect::<Vec<_>>(), MIDDLE);
    assert_eq!(salon.curves().curve_count(), count + 1, "{:?}", salon.0.editor().pen.said);
    assert_eq!(salon.tools(), [Tool::Implant, Tool::Scatter, Tool::Silhouette]);
    assert_eq!(salon.0.done(), 3);
}

#[test]
fn a_lock_sketched_on_a_braided_head_is_seen_as_hair_beside_the_braids() {
    let text = coif_graphs::grooms::by_name("cornrows").expect("cornrows");
    let mut document = coif_graphs::file::read(text).expect("it reads").document;
    let id = |text: &str| NodeId::new(text).expect("an id");
    for id in ["partings", "partings_colour", "partings_out"].map(id) {
        let remove = coif_graphs::document::edit::Edit::RemoveNode { id };
        let _ = remove.apply(&mut document);
    }
    let mut salon = Salon::open(document, "hair.sketch");
    let display = salon.0.editor().state.document.display.clone();
    let shown = |salon: &mut Salon| salon.0.editor().state.shown.clone().expect("a result");
    let before = shown(&mut salon);
    salon.draw(&lock(), HEAVY);
    assert_eq!(salon.tools(), [Tool::Implant]);
    assert_eq!(salon.0.editor().state.document.display, display, "what is looked at stays");
    let after = shown(&mut salon);
    let ids = |curves: &Curves| -> std::collections::BTreeSet<u64> {
        curves.each().map(|(tuft, i)| tuft.id(i)).collect()
    };
    let (braids, all) = (ids(&before.curves), ids(&after.curves));
    assert!(braids.is_subset(&all), "all hair of the braids is there");
    // A cluster of half the density over a circle of 1 cm radius is some dozens of hairs.
    assert!(all.len() >= braids.len() + 20, "{} and {}", braids.len(), all.len());
    // It hangs where it was drawn: over the forehead, which no braid reaches.
    let low = |curves: &Curves| {
        let points = curves.each().flat_map(|(tuft, i)| tuft.curve(i));
        points.filter(|p| p.z > 5.0).map(|p| p.y).fold(f32::MAX, f32::min)
    };
    assert!(low(&after.curves) < low(&before.curves) - 1.0);
}
