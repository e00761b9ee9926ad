//! What the pen on hair shows over the picture: what a touch would do and how deep it would reach, before it does; the stroke's ink
//! and what it is taken for; pins; the tip that would be lengthened; where an implant would stand.
//!
//! Each coming action has a shape of its own beside its colour. Nothing here changes anything.

use super::super::overlay::{self, EDGE, label, line};
use super::super::{Scene, partings};
use super::touch::HairTouch;
use super::{End, Spot, number, picks_colour, target, wheel};
use crate::rooms::pen::devices::Input;
use crate::widgets::theme;
use coif_nodes::data::attributes::PINNED;
use coif_nodes::data::curves::{Curves, Tuft};
use coif_nodes::data::gestures::{Layer, Tool};
use coif_nodes::sketch::classify::Guess;
use egui::{Align2, Color32, Painter, Pos2, Shape, Stroke, Vec2};
use std::collections::BTreeMap;

/// Plants and lengthens.
const GROW: Color32 = Color32::from_rgb(150, 230, 150);
/// Takes away.
const TAKE: Color32 = theme::ERROR.dark;
/// Bends.
const STYLE: Color32 = theme::ACCENT.dark;
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
            Self::Plain => theme::TEXT.dark,
            Self::Implant | Self::Lengthen => GROW,
            Self::Cut => TAKE,
            Self::Style => STYLE,
            Self::Pin => HOLD,
        }
    }
}

/// What lies under a touch: the partings that are found between hair, and pins.
pub(in super::super) fn under(painter: &Painter, scene: &Scene) {
    partings::paint(painter, scene);
    pins(painter, scene);
}

/// What the coming touch would do, at the pen.
pub(in super::super) fn cursor(
    tool: Option<Tool>,
    input: &Input,
    painter: &Painter,
    scene: &Scene,
) {
    let (pen, end) = (input.sample.pos, input.sample.tool);
    let curves = curves(scene);
    let spot = Spot::of(scene, pen);
    let ground = spot.ground(scene, &curves);
    let level = scene.hair.depth(tool, end, &ground, spot.at);
    let picks = picks_colour(tool, end, &ground, &spot);
    let coming = if picks { Coming::Plain } else { coming(tool, end, level) };
    if picks {
        wheel::paint(painter, scene, pen, None);
    }
    if let (Coming::Lengthen, Some((id, _))) = (coming, ground.end(spot.at)) {
        tint(painter, scene, &curves, id);
    }
    if tool == Some(Tool::Point) {
        points(painter, scene, &curves, pen, spot.rho);
    }
    if tool.is_some_and(Tool::is_soft) {
        painter.circle_stroke(pen, soft(scene), Stroke::new(1.0, STYLE));
        let half = Stroke::new(1.0, STYLE.gamma_multiply(overlay::HALF));
        painter.circle_stroke(pen, 0.5 * soft(scene), half);
    }
    if coming == Coming::Implant {
        let radius = number(scene, "radius") * scene.scalp.frame().unit();
        overlay::brush(painter, scene, pen, radius, GROW);
    }
    if has_brush(tool) && (tool.is_some() || coming == Coming::Style) {
        let ring = |radius: f32, colour: Color32| {
            painter.circle_stroke(pen, radius, Stroke::new(3.0, EDGE));
            painter.circle_stroke(pen, radius, Stroke::new(1.5, colour));
        };
        ring(brush(scene), STYLE);
        if let Some(half) = half(tool) {
            ring(half * brush(scene), STYLE.gamma_multiply(overlay::HALF));
        }
    }
    mark(painter, pen, coming, level);
}

fn curves(scene: &Scene) -> Curves {
    target::curves(scene.state, scene.node.as_ref()).unwrap_or_default()
}

/// Radius of the brush in the picture, points.
pub(super) fn brush(scene: &Scene) -> f32 {
    at_the_head(scene, scene.state.settings.pen.hair_brush())
}

/// How far around what a tool acts on others follow in the picture, points.
pub(super) fn soft(scene: &Scene) -> f32 {
    at_the_head(scene, scene.state.settings.pen.hair_soft())
}

fn at_the_head(scene: &Scene, cm: f32) -> f32 {
    let depth = scene.view.depth(scene.scalp.frame().origin);
    cm / scene.view.cm_per_point(depth).max(1e-6)
}

/// Whether a tool works with a brush of some size, or may.
pub(in super::super) fn has_brush(tool: Option<Tool>) -> bool {
    use Tool::{Comb, Grab, Pin, Puff, Scatter, Smooth, Straighten};
    matches!(tool, None | Some(Comb | Smooth | Puff | Grab | Straighten | Scatter | Pin))
}

/// Where a brush is half as strong as in its middle, in its radius; none where it is as strong up to its edge.
fn half(tool: Option<Tool>) -> Option<f32> {
    match tool {
        // A comb has a core in which hair goes all the way with it.
        None | Some(Tool::Comb) => Some(0.625),
        Some(Tool::Smooth | Tool::Puff | Tool::Grab | Tool::Straighten) => Some(0.5),
        _ => None,
    }
}

/// What a touch would do, as far as can be told before it.
fn coming(tool: Option<Tool>, end: End, level: Option<Layer>) -> Coming {
    match (tool, end == End::Eraser, level) {
        (Some(tool), ..) => Coming::of(tool),
        (None, true, _) => Coming::Cut,
        (None, false, Some(Layer::Nearest)) => Coming::Lengthen,
        (None, false, Some(Layer::Through)) => Coming::Style,
        (None, false, Some(Layer::Scalp)) => Coming::Implant,
        (None, false, None) => Coming::Plain,
    }
}

/// The stroke as it is drawn, what it is taken for, and what it has changed so far.
pub(super) fn touch(touch: &HairTouch, painter: &Painter, scene: &Scene) {
    let (colour, word) = match touch.guess {
        Guess::Is(tool) => (Coming::of(tool).colour(), tool.word()),
        Guess::Unsure(_) => (theme::TEXT.dark, ""),
    };
    if touch.told.is_some() {
        changed(&touch.before, colour, painter, scene);
    }
    let places: Vec<Pos2> = touch.line.places().collect();
    let faint = colour.gamma_multiply(if touch.lifted { 0.25 } else { 0.6 });
    for (pair, sample) in places.windows(2).zip(&touch.line.samples) {
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

/// The curves that are not as they were: the picture of their hair comes a little later.
fn changed(before: &Curves, colour: Color32, painter: &Painter, scene: &Scene) {
    let curves = curves(scene);
    let was: BTreeMap<u64, (&Tuft, usize)> =
        before.each().map(|(tuft, i)| (tuft.id(i), (tuft, i))).collect();
    let changed = curves.each().filter(|(tuft, i)| {
        was.get(&tuft.id(*i)).is_none_or(|(old, k)| {
            old.curve(*k) != tuft.curve(*i)
                || old.len() == 1 && tuft.len() == 1 && old.key() != tuft.key()
        })
    });
    for (tuft, i) in changed.take(MOST_LINES) {
        let places: Vec<Pos2> =
            tuft.curve(i).iter().filter_map(|p| scene.view.screen(*p)).collect();
        line(painter, places, Stroke::new(1.0, colour.gamma_multiply(0.5)));
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
fn mark(painter: &Painter, at: Pos2, coming: Coming, level: Option<Layer>) {
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
fn pins(painter: &Painter, scene: &Scene) {
    let curves = curves(scene);
    let view = super::seen_from(&scene.view, scene.scalp.frame());
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
        let colour = if own { STYLE } else { theme::TEXT.dark };
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
