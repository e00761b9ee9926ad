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

use super::drawing::{on_scalp, skin};
use super::overlay::line;
use super::sample::{PenSample as Report, Phase, Tool as End};
use super::target::{Fills, number};
use super::touch::{Begun, DrawnItem, Outcome, Touch, TouchStep, Wanted, Work};
use super::{Pen, Scene};
use crate::core::pen::PenSettings;
use crate::widgets::theme;
use coif_graphs::document::strokes::finish;
use coif_nodes::data::strokes::{Brush, Mode, Sample};
use egui::{Painter, Ui};
use glam::Vec3;
use heat::Heat;

/// The most samples of one stroke. What comes after is not painted.
const MOST: usize = 240_000;

/// The pen on masks.
#[derive(Default)]
pub(crate) struct Mask {
    /// Whether strokes are closed to lines whose inside they paint.
    pub(crate) closed: bool,
    /// Whether strokes keep to the section that they begin in. Floods always do.
    pub(crate) by_section: bool,
    heat: Heat,
}

/// A stroke of the brush.
struct Painting {
    brush: Brush,
    /// Where it was on the head last, cm.
    last: Vec3,
    samples: Vec<Sample>,
    /// Id of the stroke, once it has one.
    id: u64,
}

/// To the hundredth: shorter in files, and nobody sees the difference.
fn rounded(x: f32) -> f32 {
    (x * 100.0).round() / 100.0
}

/// What a touch begins.
pub(super) fn begin(mode: Mode, report: &Report, scene: &mut Scene) -> Begun {
    let hit = skin(scene.scalp, &scene.view, report.pos);
    let hit = hit.ok_or("A mask is painted on the head: begin on the skin, not beside it")?;
    let made = scene.node.clone().map(|node| (node, vec![]));
    let made = made.or_else(|| target::make(scene.state));
    let made = made.ok_or("there is no head to paint on: add a head to the graph")?;
    let mode = if report.tool == End::Eraser { Mode::Erase } else { mode };
    let brush = brush(mode, hit.point, scene);
    let mut painting = Painting { brush, last: hit.point, samples: vec![], id: 0 };
    painting.go_on(report, scene);
    Ok(Some(Touch::new(made, Fills::Mask, "mask painted", painting, scene)))
}

/// The brush of a stroke that begins at a place of the head.
fn brush(mode: Mode, at: Vec3, scene: &Scene) -> Brush {
    let settings = &scene.state.settings.pen;
    let parted = target::scalp(scene.state, scene.node.as_ref()).unwrap_or(scene.scalp);
    let section = parted.sections().filter(|_| scene.mask.by_section || mode == Mode::Flood);
    let section = section.and_then(|all| {
        let number = all.at(at)?.section;
        Some(all.list().get(number as usize)?.name.clone())
    });
    let (low, high) = Brush::RADII;
    let radius = settings.brush() / scene.scalp.frame().unit();
    Brush {
        mode,
        radius: rounded(radius).clamp(low, high),
        strength: rounded(settings.strength()).clamp(0.0, 1.0),
        mirrored: settings.symmetry,
        closed: scene.mask.closed && mode != Mode::Smooth && mode != Mode::Flood,
        section: section.unwrap_or_default(),
    }
}

impl Work for Painting {
    /// A flood has one sample, and the pen paints no more when it is lifted.
    fn go_on(&mut self, report: &Report, scene: &Scene) {
        let flooded = self.brush.mode == Mode::Flood && !self.samples.is_empty();
        let done = report.phase == Phase::Up || flooded || self.samples.len() >= MOST;
        let at = on_scalp(scene.scalp, &scene.view, report.pos, self.last);
        let Some(at) = at.filter(|_| !done) else { return };
        self.last = at;
        let mouse = matches!(report.tool, End::Mouse | End::Finger);
        let pressure = if mouse || self.brush.closed { 1.0 } else { report.pressure };
        let position = scene.scalp.given(at);
        let same = |last: &Sample| last.position == position && last.pressure == pressure;
        if !self.samples.last().is_some_and(same) {
            self.samples.push(Sample { position, pressure, ..Sample::default() });
        }
    }
    fn wants(&mut self, _: &TouchStep, scene: &Scene) -> Wanted {
        let stroke = finish(&self.samples, &scene.strokes).map(|mut stroke| {
            // It keeps the first id that it got.
            self.id = if self.id == 0 { stroke.id } else { self.id };
            (stroke.id, stroke.brush) = (self.id, Some(self.brush.clone()));
            (self.id, Some(DrawnItem::Stroke(stroke)))
        });
        stroke.into_iter().collect()
    }
    fn end(&mut self, step: &mut TouchStep, scene: &mut Scene) -> Outcome {
        step.tell(self.wants(step, scene), scene);
        let verb = match (self.brush.mode, self.brush.closed) {
            (Mode::Erase, _) => "erased mask",
            (_, true) => "painted an outline",
            (Mode::Paint, _) => "painted mask",
            (Mode::Smooth, _) => "smoothed mask",
            (Mode::Flood, _) => "flooded mask",
        };
        let section = &self.brush.section;
        step.words =
            if section.is_empty() { verb.to_owned() } else { format!("{verb} in {section}") };
        Outcome::Done
    }
    /// The line that is closed.
    fn paint(&self, painter: &Painter, scene: &Scene) {
        let places = self.samples.iter().chain(self.samples.first());
        let places = places.filter_map(|s| scene.view.screen(scene.scalp.place(s.position)));
        if self.brush.closed {
            line(painter, places.collect(), egui::Stroke::new(1.5, theme::ACCENT.dark));
        }
    }
}

/// Where a dab is half as strong as in its middle, in its radius: it fades over the part of it that the node says.
pub(super) fn half(scene: &Scene) -> f32 {
    let node = scene.node.as_ref();
    1.0 - 0.5 * number(&scene.state.document, Fills::Mask.kind(), node, "softness")
}

/// What lies under a touch: heat on the head.
pub(super) fn under(painter: &Painter, scene: &mut Scene) {
    let Some(node) = scene.node.as_ref() else { return scene.mask.heat = Heat::default() };
    let field = target::field(scene.state, node);
    if scene.mask.heat.follow(field, scene.scalp) {
        painter.ctx().request_repaint();
    }
    scene.mask.heat.paint(painter, &scene.view);
}

impl Pen {
    /// What a tool that paints needs.
    pub(super) fn mask_settings(&mut self, mode: Mode, settings: &mut PenSettings, ui: &mut Ui) {
        let mut number = |value: &mut f32, range, prefix: &str, unit: &str, tip: &str| {
            let drag = egui::DragValue::new(value).range(range).speed(0.02).max_decimals(2);
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
            ui.checkbox(&mut self.mask.closed, "Outline")
                .on_hover_text("Treat each stroke as a closed outline and paint its inside.");
        }
    }
}

#[cfg(test)]
mod tests;
