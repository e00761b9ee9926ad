//! The pen in the editor: samples in, strokes and curves out.

use super::sample::{Device, PenSample, Phase, Tool};
use super::*;
use crate::editor::Editor;
use crate::editor::state::OpenFile;
use coif_graphs::document::strokes::finish;
use coif_graphs::document::{Document, Node};
use coif_shaders::camera::Camera;
use egui::Vec2;
use egui_kittest::Harness;
use glam::Vec3;

/// A head alone.
fn head() -> Document {
    let mut document = Document::default();
    let node = Node { kind: "head".to_owned(), ..Node::default() };
    let id = document.free_id("head");
    document.nodes.insert(id, Arc::new(node));
    document
}

fn view() -> Projection {
    let camera = Camera {
        eye: Vec3::new(0.0, 60.0, 20.0),
        target: Vec3::new(0.0, 0.0, 0.0),
        up: Vec3::Y,
        focal_mm: 85.0,
        orthographic: Some(30.0),
    };
    Projection::new(camera, Rect::from_min_size(Pos2::ZERO, Vec2::new(600.0, 600.0)))
}

/// The editor with the pen over a picture that fills the window.
struct Table {
    harness: Harness<'static, Editor>,
    frame: u32,
    time: f64,
}

impl Table {
    fn new(document: Document) -> Self {
        let harness = Harness::builder().with_size(Vec2::splat(600.0)).build_ui_state(
            |ui, editor: &mut Editor| {
                editor.ui(ui);
                let mut out = vec![];
                editor.pen.ui(&editor.state, &view(), ui, &|_| true, &mut out);
                for event in out {
                    editor.apply(event);
                }
            },
            Editor::new(&egui::Context::default(), document, OpenFile::default()),
        );
        let mut table = Self { harness, frame: 0, time: 0.0 };
        table.rest();
        table
    }
    fn editor(&mut self) -> &mut Editor {
        self.harness.state_mut()
    }
    fn step(&mut self) {
        self.harness.step();
        self.frame += 1;
    }
    /// Until all is evaluated.
    fn rest(&mut self) {
        for _ in 0..2000 {
            self.step();
            if self.editor().is_idle() && !self.editor().state.stale() {
                self.step();
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        panic!("the evaluation never ends: {:?}", self.editor().state.notes.all());
    }
    fn pen(&mut self, phase: Phase, at: Pos2, pressure: f32) {
        self.time += 0.005;
        let sample = PenSample::mouse(self.time, phase, at, pressure);
        let sample = PenSample { tool: Tool::Tip, device: Device(9), ..sample };
        self.editor().pen.devices.push(sample);
    }
    /// A stroke with a pressure for each of its places.
    fn draw(&mut self, places: &[(Pos2, f32)]) {
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
        target::of(state).map_or_else(Arc::default, |id| target::strokes(&state.document, &id))
    }
}

/// From left to right over the head, in three levels of pressure.
fn row(y: f32) -> Vec<(Pos2, f32)> {
    let pressure = |k: usize| [0.25, 0.5, 1.0][k / 10];
    (0..30).map(|k| (Pos2::new(240.0 + 4.0 * k as f32, y), pressure(k))).collect()
}

fn draw_on(document: Document) -> Table {
    let mut table = Table::new(document);
    table.editor().act("pen.draw");
    // Without lag, so that pressures and places can be told.
    let mut settings = table.editor().state.settings.clone();
    let feel = settings::Feel { stabiliser: 0.0, ..Default::default() };
    settings.pen.devices.insert(settings::TOUCH.to_owned(), feel);
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
    let node = target::of(&table.editor().state).expect("a node was made");
    assert_eq!(table.editor().state.document.wires(&node, "scalp").len(), 1);
    assert_eq!(table.editor().state.document.display, Some(node));
    // On the head, where the pen was.
    table.rest();
    let shown = table.editor().state.shown.clone().expect("a result");
    assert_eq!(shown.curves.curve_count(), 1);
    let (tuft, _) = shown.curves.each().next().expect("a curve");
    let ends = [tuft.curve(0)[0], tuft.curve(0)[tuft.curve(0).len() - 1]];
    for (end, (at, _)) in ends.iter().zip([row(300.0)[0], row(300.0)[29]]) {
        let seen = view().screen(*end).expect("before the eye");
        assert!(seen.distance(at) < 6.0, "{seen} {at}");
    }
    table.editor().apply(Event::Undo);
    assert_eq!(table.editor().state.document, before);
    table.rest();
    assert_eq!(table.editor().state.shown.as_ref().map(|s| s.curves.curve_count()), Some(0));
}
