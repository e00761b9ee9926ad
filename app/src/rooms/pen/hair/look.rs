//! What the pen on hair shows over the picture: what a touch would do and how deep it would reach, before it does; the stroke's ink
//! and what it is taken for; pins; the tip that would be lengthened; where an implant would stand.
//!
//! Each coming action has a shape of its own beside its colour. Nothing here changes anything.

use super::super::overlay::{EDGE, disc, label, line, tell};
use super::super::{Pen, PenTool, Scene, partings};
use super::{Hair, target, wheel};
use crate::core::state::State;
use crate::widgets::theme;
use coif_nodes::data::attributes::PINNED;
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::gestures::{Layer, Tool};
use coif_nodes::sketch::around::ViewedCurves;
use coif_nodes::sketch::classify::Guess;
use egui::{Align2, Color32, Painter, Pos2, Shape, Stroke, Vec2};
use std::collections::BTreeMap;

/// Plants and lengthens.
const GROW: Color32 = Color32::from_rgb(150, 230, 150);
/// Takes away.
const TAKE: Color32 = theme::ERROR;
/// Bends.
const STYLE: Color32 = theme::ACCENT;
/// Holds.
const HOLD: Color32 = Color32::from_rgb(130, 200, 255);
/// The most changed curves that are drawn as lines.
const MOST_LINES: usize = 400;
/// The ring of levels, points.
const RING: f32 = 13.0;

/// What a touch would do: the paper's cursors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Coming {
    /// Nothing is known.
    Plain,
    Implant,
    Lengthen,
    Cut,
    Style,
    Pin,
}

impl Coming {
    fn of(tool: Tool) -> Self {
        match tool {
            Tool::Implant | Tool::Scatter | Tool::Silhouette => Self::Implant,
            Tool::Lengthen => Self::Lengthen,
            Tool::Cut | Tool::Density => Self::Cut,
            Tool::Pin => Self::Pin,
            _ => Self::Style,
        }
    }
    fn colour(self) -> Color32 {
        match self {
            Self::Plain => theme::TEXT,
            Self::Implant | Self::Lengthen => GROW,
            Self::Cut => TAKE,
            Self::Style => STYLE,
            Self::Pin => HOLD,
        }
    }
}

/// The curves that the pen works on now.
pub(super) fn curves(state: &State) -> Option<Curves> {
    let shown = state.shown.as_ref()?;
    let value = |socket| shown.curves_of(&socket).cloned();
    match target::of(state) {
        Some(node) => value(target::output(&node)),
        None => target::sources(state).into_iter().find_map(value),
    }
}

impl Pen {
    /// Paints over the picture while the pen works on hair.
    pub(in super::super) fn paint_hair(&self, ui: &egui::Ui, scene: &Scene) {
        let PenTool::Hair(tool) = self.tool else { return };
        let painter = ui.painter_at(scene.view.rect);
        let curves = curves(scene.state).unwrap_or_default();
        partings::paint(&painter, scene);
        paint_pins(&painter, scene, &curves);
        self.hair.paint_changed(&painter, scene, &curves);
        self.hair.paint_touch(&painter);
        if let Some(input) = self.hover.filter(|_| !self.hair.is_drawing()) {
            let view = super::seen_from(scene.view, scene.scalp.frame());
            let rho =
                target::number(&scene.state.document, target::of(scene.state).as_ref(), "rho");
            let ground = ViewedCurves::new(&view, scene.scalp, &curves, rho);
            let at = super::pixel(scene.view, input.sample.pos);
            let mouse = super::is_mouse(&input.sample);
            let eraser = input.sample.tool == super::End::Eraser;
            let picks = tool.is_none() && !eraser && wheel::is_free(&ground, at, rho);
            if picks {
                wheel::paint(&painter, scene, input.sample.pos, None);
            }
            let level = self.hair.level_to_come(tool, eraser, mouse, &ground, at);
            let coming = if picks { Coming::Plain } else { coming(tool, eraser, level) };
            if coming == Coming::Lengthen
                && let Some((id, _)) = ground.end(at)
            {
                tint(&painter, scene, &curves, id);
            }
            if tool == Some(Tool::Point) {
                points(&painter, scene, &curves, input.sample.pos, rho);
            }
            let radius =
                target::number(&scene.state.document, target::of(scene.state).as_ref(), "radius")
                    * scene.scalp.frame().unit();
            let brush = has_brush(tool) && (tool.is_some() || coming == Coming::Style);
            let brush = brush.then(|| scene.state.settings.pen.hair_brush());
            if let (Coming::Implant, Some(hit)) = (coming, ground.skin(at)) {
                let mut ring: Vec<Pos2> =
                    disc(scene.scalp, hit.point, hit.triangle, hit.bary, radius)
                        .iter()
                        .filter_map(|p| scene.view.screen(*p))
                        .collect();
                ring.extend(ring.first().copied());
                line(&painter, ring, Stroke::new(1.5, GROW));
            }
            if let Some(brush) = brush {
                let depth = scene.view.depth(scene.scalp.frame().origin);
                let radius = brush / scene.view.cm_per_point(depth).max(1e-6);
                painter.circle_stroke(input.sample.pos, radius, Stroke::new(3.0, EDGE));
                painter.circle_stroke(input.sample.pos, radius, Stroke::new(1.5, STYLE));
            }
            cursor(&painter, input.sample.pos, coming, level);
        }
        if let Some((middle, pen)) = self.hair.wheel {
            wheel::paint(&painter, scene, middle, Some(pen));
        }
        tell(ui, &painter, scene.view.rect, self.hair.said.as_ref());
        let name = target::of(scene.state);
        let name = name.as_ref().map(|node| scene.state.document.name_of(node));
        let words =
            format!("{}: {}", self.tool.label(), name.as_deref().unwrap_or("new hair sketch"));
        let at = scene.view.rect.right_top() + Vec2::new(-12.0, 12.0);
        label(&painter, at, Align2::RIGHT_TOP, &words);
        if ui.rect_contains_pointer(scene.view.rect) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
    }
}

/// Whether a tool works with a brush of some size, or may.
pub(in super::super) fn has_brush(tool: Option<Tool>) -> bool {
    use Tool::{Comb, Grab, Pin, Puff, Scatter, Smooth, Straighten};
    matches!(tool, None | Some(Comb | Smooth | Puff | Grab | Straighten | Scatter | Pin))
}

/// What a touch would do, as far as can be told before it.
fn coming(tool: Option<Tool>, eraser: bool, level: Option<Layer>) -> Coming {
    match (tool, eraser, level) {
        (Some(tool), ..) => Coming::of(tool),
        (None, true, _) => Coming::Cut,
        (None, false, Some(Layer::Nearest)) => Coming::Lengthen,
        (None, false, Some(Layer::Through)) => Coming::Style,
        (None, false, Some(Layer::Scalp)) => Coming::Implant,
        (None, false, None) => Coming::Plain,
    }
}

impl Hair {
    /// Whether a stroke is being drawn.
    pub(in super::super) fn is_drawing(&self) -> bool {
        self.wheel.is_some() || self.touch.as_ref().is_some_and(|touch| !touch.lifted)
    }

    /// How deep a touch would reach, where that is known before it.
    fn level_to_come(
        &self,
        tool: Option<Tool>,
        eraser: bool,
        mouse: bool,
        ground: &ViewedCurves,
        at: glam::Vec2,
    ) -> Option<Layer> {
        match (tool, self.level) {
            (Some(Tool::Implant | Tool::Silhouette | Tool::Scatter), _) => Some(Layer::Scalp),
            (Some(Tool::Lengthen | Tool::Pin | Tool::Point | Tool::Redraw), _) => {
                Some(Layer::Nearest)
            }
            (None, None) if mouse => Some(super::level_of_mouse(ground, at, eraser)),
            (_, level) => level,
        }
    }

    /// The curves that the touch has changed so far: the picture of their hair comes a little later.
    fn paint_changed(&self, painter: &Painter, scene: &Scene, curves: &Curves) {
        let Some(touch) = self.touch.as_ref().filter(|touch| touch.told.is_some()) else { return };
        let was: BTreeMap<u64, (&Tuft, usize)> =
            touch.before.each().map(|(tuft, i)| (tuft.id(i), (tuft, i))).collect();
        let changed = curves.each().filter(|(tuft, i)| {
            was.get(&tuft.id(*i)).is_none_or(|(old, k)| {
                old.curve(*k) != tuft.curve(*i)
                    || old.len() == 1 && tuft.len() == 1 && old.key() != tuft.key()
            })
        });
        let colour =
            if let Guess::Is(tool) = touch.guess { Coming::of(tool).colour() } else { GROW };
        for (tuft, i) in changed.take(MOST_LINES) {
            let places: Vec<Pos2> =
                tuft.curve(i).iter().filter_map(|p| scene.view.screen(*p)).collect();
            line(painter, places, Stroke::new(1.0, colour.gamma_multiply(0.5)));
        }
    }

    /// The stroke as it is drawn, and what it is taken for.
    fn paint_touch(&self, painter: &Painter) {
        let Some(touch) = &self.touch else { return };
        let (colour, word) = match touch.guess {
            Guess::Is(tool) => (Coming::of(tool).colour(), tool.word()),
            Guess::Unsure(_) => (theme::TEXT, ""),
        };
        let places: Vec<Pos2> = touch.line().collect();
        let faint = colour.gamma_multiply(if touch.lifted { 0.25 } else { 0.6 });
        for (pair, sample) in places.windows(2).zip(&touch.samples) {
            let width = 1.0 + 3.0 * sample.pressure;
            painter.line_segment([pair[0], pair[1]], Stroke::new(width, faint));
        }
        if let (Some(at), false) = (places.last(), touch.lifted) {
            ring(painter, *at, Some(touch.layer()), colour);
            if !word.is_empty() {
                label(painter, *at + Vec2::new(18.0, -26.0), Align2::LEFT_CENTER, word);
            }
        }
    }
}

/// Three arcs, as many of them full as the level is deep.
fn ring(painter: &Painter, at: Pos2, level: Option<Layer>, colour: Color32) {
    let deep = level.map_or(0, |level| match level {
        Layer::Nearest => 1,
        Layer::Through => 2,
        Layer::Scalp => 3,
    });
    for arc in 0..3 {
        let turn = |t: f32| std::f32::consts::TAU * ((arc as f32 + 0.06 + 0.88 * t) / 3.0 - 0.25);
        let place = |k: i32| at + Vec2::angled(turn(k as f32 / 12.0)) * RING;
        let places: Vec<Pos2> = (0..=12).map(place).collect();
        painter.add(Shape::line(places.clone(), Stroke::new(4.0, EDGE)));
        let (width, shade) = if arc < deep { (2.5, 1.0) } else { (1.0, 0.4) };
        painter.add(Shape::line(places, Stroke::new(width, colour.gamma_multiply(shade))));
    }
}

/// The shape of what is to come, in the ring of its level.
fn cursor(painter: &Painter, at: Pos2, coming: Coming, level: Option<Layer>) {
    let colour = coming.colour();
    ring(painter, at, level, colour);
    let stroke = |from: [f32; 2], to: [f32; 2]| {
        let ends = [at + Vec2::from(from), at + Vec2::from(to)];
        painter.line_segment(ends, Stroke::new(3.5, EDGE));
        painter.line_segment(ends, Stroke::new(1.5, colour));
    };
    match coming {
        Coming::Plain => {
            painter.circle(at, 2.5, colour, Stroke::new(1.0, EDGE));
        }
        // A root with a stem.
        Coming::Implant => {
            stroke([0.0, 0.0], [0.0, -9.0]);
            painter.circle(at, 2.5, colour, Stroke::new(1.0, EDGE));
        }
        // An arrow onwards.
        Coming::Lengthen => {
            stroke([-6.0, 0.0], [6.0, 0.0]);
            stroke([2.0, -4.0], [6.0, 0.0]);
            stroke([2.0, 4.0], [6.0, 0.0]);
        }
        // Blades.
        Coming::Cut => {
            stroke([-5.0, -5.0], [5.0, 5.0]);
            stroke([-5.0, 5.0], [5.0, -5.0]);
        }
        // Teeth of a comb.
        Coming::Style => {
            stroke([-6.0, -5.0], [6.0, -5.0]);
            for x in [-5.0, 0.0, 5.0] {
                stroke([x, -5.0], [x, 5.0]);
            }
        }
        Coming::Pin => hairpin(painter, at, colour),
    }
}

fn hairpin(painter: &Painter, at: Pos2, colour: Color32) {
    let place = |x: f32, y: f32| at + Vec2::new(x, y);
    let bend = (0..=8).map(|k| {
        let turn = std::f32::consts::PI * (1.0 + k as f32 / 8.0);
        at + Vec2::new(0.0, -4.0) + Vec2::angled(turn) * 3.0
    });
    let mut places = vec![place(-3.0, 7.0)];
    places.extend(bend);
    places.push(place(3.0, 7.0));
    painter.add(Shape::line(places.clone(), Stroke::new(4.0, EDGE)));
    painter.add(Shape::line(places, Stroke::new(1.5, colour)));
}

/// Hairpins where CVs hold their place.
fn paint_pins(painter: &Painter, scene: &Scene, curves: &Curves) {
    let view = super::seen_from(scene.view, scene.scalp.frame());
    let seen = coif_nodes::sketch::seen::Seen::new(&view, scene.scalp.frame());
    for (tuft, i) in curves.each().filter(|(tuft, _)| tuft.attribute(PINNED.name).is_some()) {
        let pinned = tuft.view(PINNED);
        for (_, p) in tuft.curve(i).iter().enumerate().filter(|(k, _)| pinned.at(i, *k) != 0) {
            let before = seen.sees(scene.scalp, *p);
            if let Some(at) = scene.view.screen(*p).filter(|at| scene.view.rect.contains(*at)) {
                hairpin(painter, at, if before { HOLD } else { HOLD.gamma_multiply(0.3) });
            }
        }
    }
}

/// The points of the curve of which one is nearest to the pen, and that one, within a reach (points of the screen).
fn points(painter: &Painter, scene: &Scene, curves: &Curves, pen: Pos2, reach: f32) {
    let places = |(tuft, i): (&Tuft, usize)| -> Vec<Option<Pos2>> {
        tuft.curve(i)[1..].iter().map(|p| scene.view.screen(*p)).collect()
    };
    let nearest = |places: &Vec<Option<Pos2>>| {
        let off = |at: &Option<Pos2>| at.map_or(f32::MAX, |at| at.distance(pen));
        places.iter().map(off).fold(f32::MAX, f32::min)
    };
    let all = curves.each().filter(|(tuft, i)| tuft.curve(*i).len() > 1).map(places);
    let all = all.map(|places| (nearest(&places), places));
    let Some((off, places)) = all.min_by(|a, b| a.0.total_cmp(&b.0)) else { return };
    if off > reach {
        return;
    }
    for at in places.into_iter().flatten() {
        let own = at.distance(pen) <= off;
        let colour = if own { STYLE } else { theme::TEXT };
        painter.circle(at, if own { 5.0 } else { 3.0 }, colour, Stroke::new(1.0, EDGE));
    }
}

/// The curve that would go on.
fn tint(painter: &Painter, scene: &Scene, curves: &Curves, id: u64) {
    let curve = curves.each().find(|(tuft, i)| tuft.id(*i) == id);
    let Some((tuft, i)) = curve else { return };
    let places = tuft.curve(i).iter().filter_map(|p| scene.view.screen(*p)).collect();
    line(painter, places, Stroke::new(3.0, GROW.gamma_multiply(0.7)));
}
