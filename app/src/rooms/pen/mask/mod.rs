//! The pen paints masks: from samples to strokes of a *Paint mask*, seen as heat on the head while they are painted.
//!
//! A touch is a stroke in the document from its first sample on, so what is seen is what the node makes of it. Where no node
//! takes it the first touch makes one (`target.rs`), wired to nothing but the head.
//!
//! Guarantees: one touch is one step; Escape takes back one that is under way; a touch begins only on the head. A mouse, which
//! has no pressure, presses fully.

pub(crate) mod actions;
mod heat;
pub(super) mod target;

use super::devices::Input;
use super::drawing::on_scalp;
use super::overlay::{disc, label, line};
use super::sample::{PenSample as Report, Phase, Tool as End};
use super::{Pen, PenTool, Scene};
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::state::{Select, State};
use crate::widgets::theme;
use coif_graphs::document::NodeId;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::strokes::finish;
use coif_nodes::data::strokes::{Brush, Mode, Sample, Stroke};
use egui::{Align2, Key, Pos2, Ui, Vec2};
use glam::Vec3;
use heat::Heat;

/// Tools that paint, as they stand in the bar: what they are called, and their actions.
pub(crate) const TOOLS: &[(Mode, &str, &str)] = &[
    (Mode::Paint, "Paint", "mask.paint"),
    (Mode::Erase, "Erase mask", "mask.erase"),
    (Mode::Smooth, "Smooth mask", "mask.smooth"),
    (Mode::Flood, "Flood", "mask.flood"),
];

/// What the bar says of a mode, and its action.
pub(super) fn tool(mode: Mode) -> (&'static str, &'static str) {
    TOOLS
        .iter()
        .find(|(own, ..)| *own == mode)
        .map_or(("", ""), |(_, label, action)| (label, action))
}

/// The most samples of one stroke. What comes after is not painted.
const MOST: usize = 240_000;

/// The pen on masks.
#[derive(Default)]
pub(crate) struct Mask {
    /// Whether strokes are closed to lines whose inside they paint.
    pub(crate) closed: bool,
    /// Whether strokes keep to the section that they begin in. Floods always do.
    pub(crate) by_section: bool,
    touch: Option<Touch>,
    heat: Heat,
}

/// A touch under way.
struct Touch {
    node: NodeId,
    /// What makes the node, where there was none.
    make: Vec<Edit>,
    begun: bool,
    brush: Brush,
    /// Where it was on the head last, cm.
    last: Vec3,
    samples: Vec<Sample>,
    /// Id of the stroke, once it has one.
    id: u64,
    told: Option<Stroke>,
}

/// To the hundredth: shorter in files, and nobody sees the difference.
fn rounded(x: f32) -> f32 {
    (x * 100.0).round() / 100.0
}

impl Mask {
    /// Whether a stroke is being painted.
    pub(super) fn is_drawing(&self) -> bool {
        self.touch.is_some()
    }

    /// A touch under way never was.
    pub(super) fn stop(&mut self, out: &mut Vec<Event>) {
        if self.touch.take().is_some_and(|touch| touch.begun) {
            out.push(Event::Abort);
        }
    }

    /// One frame: `free` tells where a touch may begin.
    fn ui(&mut self, mode: Mode, inputs: Vec<(Input, bool)>, scene: &mut Scene) {
        if self.touch.as_ref().is_some_and(|touch| touch.is_orphaned(scene.state)) {
            self.touch = None;
        }
        for (input, free) in inputs {
            let report = &input.sample;
            match (report.phase, &mut self.touch) {
                (Phase::Down, None) if free => self.touch = self.begin(mode, report, scene),
                (Phase::Move, Some(touch)) => touch.go_on(report, scene),
                (Phase::Up, Some(_)) => {
                    if let Some(mut touch) = self.touch.take() {
                        touch.flush(scene);
                        scene.out.push(Event::EndAs(touch.words()));
                    }
                }
                (Phase::Out, Some(_)) => self.stop(scene.out),
                _ => {}
            }
        }
        if let Some(touch) = self.touch.as_mut().filter(|_| super::ready(scene.state)) {
            touch.flush(scene);
        }
    }

    /// What a touch begins; nothing beside the head.
    fn begin(&self, mode: Mode, report: &Report, scene: &mut Scene) -> Option<Touch> {
        let ray = scene.view.ray(report.pos);
        let hit = scene.scalp.surface().ray(ray.origin, ray.direction, f32::MAX)?;
        let (node, make) = match target::of(scene.state) {
            Some(node) => (node, vec![]),
            None => {
                let made = target::make(scene.state);
                if made.is_none() {
                    let note = "there is no head to paint on: add a head to the graph";
                    scene.out.push(Event::Say(Note::warning(note)));
                }
                made?
            }
        };
        let settings = &scene.state.settings.pen;
        let mode = if report.tool == End::Eraser { Mode::Erase } else { mode };
        let parted = target::scalp(scene.state, Some(&node)).unwrap_or(scene.scalp);
        let section = parted.sections().filter(|_| self.by_section || mode == Mode::Flood);
        let section = section.and_then(|all| {
            let number = all.at(hit.point)?.section;
            Some(all.list().get(number as usize)?.name.clone())
        });
        let (low, high) = Brush::RADII;
        let radius = settings.brush() / scene.scalp.frame().unit();
        let mut touch = Touch {
            node,
            make,
            begun: false,
            brush: Brush {
                mode,
                radius: rounded(radius).clamp(low, high),
                strength: rounded(settings.strength()).clamp(0.0, 1.0),
                mirrored: settings.symmetry,
                closed: self.closed && mode != Mode::Smooth && mode != Mode::Flood,
                section: section.unwrap_or_default(),
            },
            last: hit.point,
            samples: vec![],
            id: 0,
            told: None,
        };
        touch.go_on(report, scene);
        Some(touch)
    }
}

impl Touch {
    /// Whether somebody has ended or undone what it has begun.
    fn is_orphaned(&self, state: &State) -> bool {
        self.begun && (!state.gesture || !state.document.nodes.contains_key(self.node.as_str()))
    }

    /// The next sample. A flood has one.
    fn go_on(&mut self, report: &Report, scene: &Scene) {
        let done = self.brush.mode == Mode::Flood && !self.samples.is_empty();
        if done || self.samples.len() >= MOST {
            return;
        }
        let Some(at) = on_scalp(scene.scalp, scene.view, report.pos, self.last) else { return };
        self.last = at;
        let mouse = matches!(report.tool, End::Mouse | End::Finger);
        let pressure = if mouse || self.brush.closed { 1.0 } else { report.pressure };
        let position = scene.scalp.given(at);
        let same = |last: &Sample| last.position == position && last.pressure == pressure;
        if !self.samples.last().is_some_and(same) {
            self.samples.push(Sample { position, pressure, ..Sample::default() });
        }
    }

    /// Tells the document what has changed since it was told last.
    fn flush(&mut self, scene: &mut Scene) {
        let others = target::strokes(&scene.state.document, &self.node);
        let Some(mut stroke) = finish(&self.samples, &others) else { return };
        if self.id == 0 {
            self.id = stroke.id;
        }
        (stroke.id, stroke.brush) = (self.id, Some(self.brush.clone()));
        if self.told.as_ref() == Some(&stroke) {
            return;
        }
        if !self.begun {
            self.begun = true;
            scene.out.push(Event::Begin("mask painted".to_owned()));
            if !self.make.is_empty() {
                scene.out.extend(std::mem::take(&mut self.make).into_iter().map(Event::Edit));
                scene.out.push(Event::Select(Select::Nodes(vec![self.node.clone()])));
            }
        }
        let (node, input) = (self.node.clone(), target::STROKES.to_owned());
        let edit = match self.told.replace(stroke.clone()) {
            Some(_) => Edit::ReplaceStroke { node, input, stroke },
            None => Edit::AddStroke { node, input, at: usize::MAX, stroke },
        };
        scene.out.push(Event::Edit(edit));
    }

    /// What its step is called.
    fn words(&self) -> String {
        let verb = match (self.brush.mode, self.brush.closed) {
            (Mode::Erase, _) => "erased mask",
            (_, true) => "drew a hairline",
            (Mode::Paint, _) => "painted mask",
            (Mode::Smooth, _) => "smoothed mask",
            (Mode::Flood, _) => "flooded mask",
        };
        let section = &self.brush.section;
        if section.is_empty() { verb.to_owned() } else { format!("{verb} in {section}") }
    }
}

impl Pen {
    /// One frame with a tool that paints in hand.
    pub(super) fn on_mask(
        &mut self,
        mode: Mode,
        inputs: Vec<Input>,
        ui: &egui::Ui,
        mut scene: Scene,
        free: &dyn Fn(Pos2) -> bool,
    ) {
        let ctx = ui.ctx();
        if ctx.input(|input| input.key_down(Key::Escape)) {
            self.mask.stop(scene.out);
        }
        let told = self.told(inputs, ctx, free);
        self.mask.ui(mode, told, &mut scene);
        self.paint_mask(mode, ui, &scene);
        if self.mask.is_drawing() {
            ctx.request_repaint();
        }
    }

    /// Heat on the head, the brush under the pen, and what is painted on.
    fn paint_mask(&mut self, mode: Mode, ui: &egui::Ui, scene: &Scene) {
        let painter = ui.painter_at(scene.view.rect);
        let node = target::of(scene.state);
        let field = node.as_ref().and_then(|node| target::field(scene.state, node));
        if self.mask.heat.follow(field, scene.scalp) {
            ui.ctx().request_repaint();
        }
        self.mask.heat.paint(&painter, scene.view);
        if let Some(touch) = self.mask.touch.as_ref().filter(|touch| touch.brush.closed) {
            let places = touch.samples.iter().chain(touch.samples.first());
            let places = places.filter_map(|s| scene.view.screen(scene.scalp.place(s.position)));
            line(&painter, places.collect(), egui::Stroke::new(1.5, theme::ACCENT));
        }
        if let Some(input) = self.hover.filter(|_| mode != Mode::Flood) {
            let ray = scene.view.ray(input.sample.pos);
            let surface = scene.scalp.surface();
            if let Some(hit) = surface.ray(ray.origin, ray.direction, f32::MAX) {
                let radius = scene.state.settings.pen.brush();
                let disc = disc(scene.scalp, hit.point, hit.triangle, hit.bary, radius);
                let mut ring: Vec<Pos2> =
                    disc.iter().filter_map(|p| scene.view.screen(*p)).collect();
                ring.extend(ring.first().copied());
                line(&painter, ring, egui::Stroke::new(1.5, theme::ACCENT));
            }
        }
        let name = node.as_ref().map(|node| scene.state.document.name_of(node));
        let words =
            format!("{}: {}", self.tool.label(), name.as_deref().unwrap_or("new paint mask"));
        let at = scene.view.rect.right_top() + Vec2::new(-12.0, 12.0);
        label(&painter, at, Align2::RIGHT_TOP, &words);
        if ui.rect_contains_pointer(scene.view.rect) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
    }

    /// The row of the bar with the tools that paint, and what they need.
    pub(super) fn mask_bar(
        &mut self,
        settings: &mut crate::core::pen::PenSettings,
        ui: &mut Ui,
        out: &mut Vec<Event>,
    ) {
        let tools: Vec<_> = TOOLS
            .iter()
            .map(|(mode, label, action)| (PenTool::Mask(*mode), *label, *action))
            .collect();
        self.tools(&tools, ui, out);
        let PenTool::Mask(mode) = self.tool else { return };
        ui.separator();
        let mut number = |value: &mut f32, range, prefix: &str, unit: &str, tip: &str| {
            let drag = egui::DragValue::new(value).range(range).speed(0.02);
            ui.add(drag.prefix(prefix.to_owned()).suffix(unit.to_owned())).on_hover_text(tip);
        };
        if mode != Mode::Flood {
            let tip = "Radius of the brush on the scalp ([ and ]).";
            number(&mut settings.brush, 0.05..=20.0, "Size ", " cm", tip);
        }
        let tip = match mode {
            Mode::Flood => "Value that the mask gets; 0 clears it (Shift+[ and Shift+]).",
            _ => "Strength of one pass at full pressure (Shift+[ and Shift+]).",
        };
        number(&mut settings.strength, 0.0..=1.0, "Strength ", "", tip);
        ui.checkbox(&mut settings.symmetry, "Symmetry")
            .on_hover_text("Paint both sides of the head (X).");
        if mode != Mode::Flood {
            ui.checkbox(&mut self.mask.by_section, "By section")
                .on_hover_text("Limit each stroke to the section that it begins in.");
        }
        if matches!(mode, Mode::Paint | Mode::Erase) {
            ui.checkbox(&mut self.mask.closed, "Hairline")
                .on_hover_text("Treat each stroke as a closed outline and paint its inside.");
        }
    }
}

/// Takes up a tool that paints.
pub(super) fn take_up(pen: &mut Pen, mode: Mode) {
    pen.tool = PenTool::Mask(mode);
}

#[cfg(test)]
mod tests;
