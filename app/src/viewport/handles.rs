//! Handles of the active node: what of its inputs can be dragged in the picture.
//!
//! Declarations say which inputs have one. Grips have the same size at any distance. A drag is one undo step; Escape takes it
//! back. Inputs that are wired, unset or vary over the hair have none.
//!
//! Where they stand: points where they are; balls about the middle that the node's curves carry; everything else about the
//! node's own point, else about the first curve that it gives. What the head hides is not drawn ([`Seen`]) and cannot be taken.
//! Lengths are as large as they are made: in head units where the node measures in those. Guaranteed: what a drag gives lies
//! within the input's hard limits, and a grip that is let go where it was taken leaves the value as it was.

use super::projection::Projection;
use crate::editor::evaluation::{Shown, first_output};
use crate::editor::event::Event;
use crate::editor::state::State;
use crate::editor::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::{Document, NodeId, Setting};
use coif_nodes::data::attributes::{NORMAL, PUFF_CENTRE};
use coif_nodes::data::field::Field;
use coif_nodes::data::scalp::{HeadFrame, HeadSpace, Scalp};
use coif_nodes::define::{Handle, InputDef, Type, Unit, Value};
use egui::{Color32, Key, Pos2, Sense, Shape, Stroke, Vec2};
use glam::Vec3;
use std::sync::Arc;

/// How far from a grip's middle it is taken, points.
const TARGET: f32 = 12.0;
/// The radius of a grip, points.
const GRIP: f32 = 5.0;
/// The radius of the arc of an angle, points.
const ARC: f32 = 44.0;
/// Grips of a node lie at least so far apart: one that would lie nearer to another is held aside of its place, by a line.
const APART: f32 = 26.0;
/// While the pointer is within this of a grip they all say what they are, points.
const NEAR: f32 = 60.0;
/// An angle's grip is not turned by less than this distance from its middle, points.
const DEAD: f32 = 4.0;

/// A value that can be dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    /// A number, or a field that is the same everywhere.
    One(f32),
    /// A point in head units.
    Point(Vec3),
}

/// One grip.
#[derive(Clone)]
struct Grip {
    input: &'static InputDef,
    handle: Handle,
    value: Number,
    /// What it stands about, cm.
    anchor: Vec3,
    /// Unit: away from the skin there.
    out: Vec3,
    /// Which of the node's grips of its kind.
    number: usize,
    /// The curve that the value runs along.
    curve: Arc<[Vec3]>,
    /// What points are given in.
    space: HeadSpace,
    /// Points stay on the skin.
    on_skin: bool,
    /// What a typed centimetre is, cm.
    unit: f32,
}

/// Inputs that say where a node's things are, instead of its own point.
const PLACES: [&str; 2] = ["placements", "ties"];
/// What a tie says instead of these.
const TIED: [&str; 2] = ["root_radius", "tie_height"];
/// Places of the skin itself lie up to so far under it, cm.
const UNDER: f32 = 0.5;

/// What the head lets be seen.
struct Seen<'a> {
    view: &'a Projection,
    /// The heads that are shown.
    scalps: &'a [&'a Scalp],
}

impl Seen<'_> {
    /// Whether a head stands before a place.
    fn hides(&self, p: Vec3) -> bool {
        let Some(at) = self.view.screen(p) else { return true };
        let ray = self.view.ray(at);
        let far = (p - ray.origin).dot(ray.direction) - UNDER;
        let hit = |scalp: &&&Scalp| scalp.surface().ray(ray.origin, ray.direction, far).is_some();
        far > 0.0 && self.scalps.iter().any(|scalp| hit(&scalp))
    }

    /// Draws what is seen of a line.
    fn line(&self, points: impl Iterator<Item = Vec3>, stroke: Stroke, painter: &egui::Painter) {
        let mut run = vec![];
        for p in points {
            match self.view.screen(p).filter(|_| !self.hides(p)) {
                Some(at) => run.push(at),
                None => {
                    painter.add(Shape::line(std::mem::take(&mut run), stroke));
                }
            }
        }
        painter.add(Shape::line(run, stroke));
    }
}

/// What is being dragged.
struct Drag {
    node: NodeId,
    grip: Grip,
    /// From the grip to where it was taken, points.
    off: Vec2,
    last: Number,
}

/// The grips of the active node.
#[derive(Default)]
pub(super) struct Handles {
    drag: Option<Drag>,
}

impl Handles {
    /// Whether one is being dragged.
    pub(super) fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Draws the grips and takes drags of them.
    pub(super) fn ui(
        &mut self,
        state: &State,
        view: &Projection,
        head: bool,
        ui: &mut egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let (Some(shown), Some(node)) = (state.shown.as_ref(), state.active()) else {
            self.drag = None;
            return;
        };
        if self.drag.as_ref().is_some_and(|drag| drag.node != *node) {
            self.drag = None;
        }
        let scalps: Vec<&Scalp> = shown.scalps.iter().map(|scalp| &**scalp).collect();
        let seen = Seen { view, scalps: if head { &scalps } else { &[] } };
        let dragged = self.drag.as_ref().map(|drag| drag.grip.input.name);
        let is_held = |grip: &Grip| dragged == Some(grip.input.name);
        let placed = grips(&state.document, shown, node, view).into_iter().filter_map(|grip| {
            let (at, hidden) = grip.place(&seen, &scalps)?;
            (!hidden || is_held(&grip)).then_some((grip, at))
        });
        let placed: Vec<(Grip, Pos2)> = placed.collect();
        let hands = apart(&placed);
        let pointer = ui.input(|input| input.pointer.latest_pos());
        let near = pointer.is_some_and(|p| hands.iter().any(|at| at.distance(p) < NEAR));
        for ((grip, place), at) in placed.into_iter().zip(hands) {
            let held = is_held(&grip);
            grip.draw(&seen, ui);
            if at.distance(place) > GRIP {
                let stroke = Stroke::new(1.0, theme::ACCENT.gamma_multiply(0.5));
                ui.painter_at(view.rect).line_segment([place, at], stroke);
            }
            let id = ui.id().with(("handle", node.as_str(), grip.input.name));
            let target = egui::Rect::from_center_size(at, Vec2::splat(2.0 * TARGET));
            let response = ui.interact(target, id, Sense::drag());
            response.widget_info(|| {
                let label = format!("Handle of {}", grip.input.name);
                egui::WidgetInfo::labeled(egui::WidgetType::Slider, true, label)
            });
            let colour = if held || response.hovered() { Color32::WHITE } else { theme::ACCENT };
            ui.painter().circle(at, GRIP, theme::GROUND, Stroke::new(2.0, colour));
            let told = held || response.hovered();
            if told || near {
                let name = crate::inspector::text::spoken(grip.input.name);
                let text = if told { format!("{name} {}", grip.words()) } else { name };
                let font = egui::FontId::proportional(12.0);
                let galley = ui.painter().layout_no_wrap(text, font, theme::TEXT);
                let from = at + Vec2::new(12.0, -18.0);
                let back = egui::Rect::from_min_size(from, galley.size()).expand(2.0);
                ui.painter().rect_filled(back, 2.0, Color32::from_black_alpha(190));
                ui.painter().galley(from, galley, theme::TEXT);
            }
            if response.drag_started() {
                let pressed = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
                out.push(Event::Begin(String::new()));
                let last = grip.value;
                self.drag = Some(Drag { node: node.clone(), grip, off: pressed - place, last });
            }
        }
        self.follow(view, &scalps, ui, out);
    }

    /// Gives the dragged input what the pointer says.
    fn follow(
        &mut self,
        view: &Projection,
        scalps: &[&Scalp],
        ui: &egui::Ui,
        out: &mut Vec<Event>,
    ) {
        let Some(drag) = &mut self.drag else { return };
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            out.push(Event::Abort);
            self.drag = None;
            return;
        }
        let (pointer, down) =
            ui.input(|input| (input.pointer.interact_pos(), input.pointer.any_down()));
        if let Some(at) = pointer
            && let Some(value) = drag.grip.value_at(view, scalps, at - drag.off)
            && value != drag.last
        {
            drag.last = value;
            let value = match value {
                Number::One(x) if drag.grip.input.ty == Type::Field => {
                    Value::Field(Arc::new(Field::Constant(x)))
                }
                Number::One(x) => Value::Float(x),
                Number::Point(p) => Value::Vec3(p),
            };
            let input = drag.grip.input.name.to_owned();
            let setting = Setting::Known(value);
            out.push(Event::Edit(Edit::SetInput { node: drag.node.clone(), input, setting }));
        }
        if !down {
            out.push(Event::End);
            self.drag = None;
        }
    }
}

/// Where grips are taken: at their places, but for those that would lie on another. The place of the whole stays first, for it is
/// what is dragged most.
fn apart(placed: &[(Grip, Pos2)]) -> Vec<Pos2> {
    let mut hands: Vec<Pos2> = placed.iter().map(|(_, at)| *at).collect();
    let mut order: Vec<usize> = (0..placed.len()).collect();
    order.sort_by_key(|i| placed[*i].0.handle != Handle::Point);
    for (n, i) in order.iter().copied().enumerate() {
        let free =
            |at: Pos2| order[..n].iter().all(|other| hands[*other].distance(at) >= APART - 0.01);
        let place = placed[i].1;
        // Away from the nearest of the others, else upwards; then round the place, farther and farther.
        let nearest = order[..n].iter().map(|other| place - hands[*other]);
        let nearest = nearest.min_by(|a, b| a.length().total_cmp(&b.length()));
        let first = nearest.filter(|by| by.length() > 1.0).map_or(-Vec2::Y, Vec2::normalized);
        let around = (1..4).flat_map(|ring| (0..8u8).map(move |turn| (ring as f32, turn)));
        let aside = around.map(|(ring, turn)| {
            // To both sides in turn.
            let side = if turn % 2 == 0 { 1.0 } else { -1.0 };
            let angle = side * f32::from(turn.div_ceil(2)) * std::f32::consts::FRAC_PI_4;
            place + egui::emath::Rot2::from_angle(angle) * first * (APART * ring)
        });
        if let Some(at) = std::iter::once(place).chain(aside).find(|at| free(*at)) {
            hands[i] = at;
        }
    }
    hands
}

/// The value of an input as it is set, where it can be dragged.
fn number(document: &Document, node: &NodeId, input: &InputDef) -> Option<Number> {
    if !document.wires(node, input.name).is_empty() {
        return None;
    }
    let set = document.node(node.as_str())?.inputs.get(input.name);
    let value = match set {
        Some(Setting::Known(value)) => value.clone(),
        Some(Setting::Raw(_)) => return None,
        None => input.default()?,
    };
    match value {
        Value::Float(x) => Some(Number::One(x)),
        Value::Field(field) => field.constant().map(Number::One),
        Value::Vec3(p) => Some(Number::Point(p)),
        _ => None,
    }
}

/// The grips of a node, in the order of its inputs.
fn grips(document: &Document, shown: &Shown, node: &NodeId, view: &Projection) -> Vec<Grip> {
    let Some(def) = document.def(node) else { return vec![] };
    let on_head = def
        .inputs
        .iter()
        .any(|input| input.ty == Type::Scalp && !document.wires(node, input.name).is_empty());
    let scalp = shown.scalp().filter(|_| on_head);
    let space = scalp.map(|scalp| scalp.space().clone());
    let space = space.unwrap_or_else(|| HeadSpace::new(HeadFrame::IDENTITY, None));
    let frame = *space.frame();
    let gives = first_output(document, node).and_then(|socket| shown.curves_of(&socket));
    // Of several balls, the one that is nearest to the eye.
    let balls = gives.iter().flat_map(|curves| curves.tufts()).filter_map(|tuft| {
        let has = tuft.attributes().iter().any(|a| *a.name == *PUFF_CENTRE.name);
        let first = tuft.range(0).start;
        (has && !tuft.is_empty()).then(|| tuft.view(PUFF_CENTRE).at(0, first))
    });
    let ball = balls.min_by(|a, b| view.depth(*a).total_cmp(&view.depth(*b)));
    let wired = |name: &&str| !document.wires(node, name).is_empty();
    let tied = PLACES.iter().any(|name| *name == "ties" && wired(name));
    let foot = ball.filter(|_| PLACES.iter().any(wired)).zip(scalp).and_then(|(ball, scalp)| {
        let root = scalp.closest_root(ball)?;
        Some((root.point, root.normal))
    });
    let curve = gives.and_then(|curves| {
        let (tuft, i) = curves.each().next()?;
        let normal = tuft.view(NORMAL).at(i, tuft.range(i).start);
        Some((Arc::<[Vec3]>::from(tuft.curve(i)), normal))
    });
    let point = def.inputs.iter().find_map(|input| match number(document, node, input)? {
        Number::Point(p) if input.handle == Some(Handle::Point) => {
            Some((p, input.unit != Unit::Length))
        }
        _ => None,
    });
    let (anchor, normal) = match (point, &curve) {
        _ if foot.is_some() => foot.unwrap_or_default(),
        (Some((p, on_skin)), _) => match scalp.filter(|_| on_skin) {
            Some(scalp) => on_skin_of(scalp, space.place(p) - frame.origin),
            None => (space.place(p), Vec3::ZERO),
        },
        (None, Some((curve, normal))) if !curve.is_empty() => (curve[curve.len() / 2], *normal),
        _ => return vec![],
    };
    let out = normal
        .try_normalize()
        .or_else(|| (anchor - frame.origin).try_normalize())
        .unwrap_or(frame.up);
    let line: Arc<[Vec3]> = curve.map_or_else(|| Arc::from([]), |(curve, _)| curve);
    let scales = def.input("scale_with_head").is_some_and(|(_, input)| {
        let set = document.node(node.as_str()).and_then(|node| node.inputs.get(input.name));
        !matches!(set, Some(Setting::Known(Value::Bool(false))))
    });
    let unit = if scales { frame.unit() } else { 1.0 };
    let mut all: Vec<Grip> = vec![];
    for input in def.inputs {
        let (Some(handle), Some(value)) = (input.handle, number(document, node, input)) else {
            continue;
        };
        let fits = matches!(value, Number::Point(_)) == (handle == Handle::Point);
        let elsewhere = foot.is_some() && handle == Handle::Point;
        let by_tie = tied && TIED.contains(&input.name);
        // What is switched off, as by a 0 that sets no limit, has no place to be held at.
        let off = value == Number::One(0.0)
            && handle != Handle::Angle
            && crate::inspector::value::zero_words(&input.doc()).is_some();
        if !fits || elsewhere || by_tie || off || (handle == Handle::Along && line.len() < 2) {
            continue;
        }
        let anchor = match handle {
            Handle::Ball => ball.unwrap_or(anchor),
            _ => anchor,
        };
        all.push(Grip {
            input,
            handle,
            value,
            anchor,
            out,
            number: all.iter().filter(|grip| grip.handle == handle).count(),
            curve: line.clone(),
            space: space.clone(),
            on_skin: scalp.is_some() && input.unit != Unit::Length,
            unit: if input.unit == Unit::Length { unit } else { 1.0 },
        });
    }
    // What lies under another grip is taken last: the place of the whole is on top.
    all.sort_by_key(|grip| grip.handle == Handle::Point);
    all
}

/// The outermost skin in a direction from the head's middle, and its normal; a ball where there is none.
fn on_skin_of(scalp: &Scalp, direction: Vec3) -> (Vec3, Vec3) {
    let frame = scalp.frame();
    let out = direction.normalize_or(frame.up);
    let far = 4.0 * frame.radius;
    let hit = scalp.surface().ray(frame.origin + out * far, -out, far);
    hit.map_or((frame.origin + out * frame.radius, out), |hit| {
        (hit.point, scalp.surface().smooth_normal(hit.triangle, hit.bary))
    })
}

impl Grip {
    /// Across the picture, for radii: each of a node's circles is held at another place.
    fn across(&self, view: &Projection, turns: f32) -> Vec3 {
        let [across, up, _] = view.axes();
        let angle = 0.5 + 0.9 * self.number as f32 + turns * std::f32::consts::TAU;
        across * angle.cos() + up * angle.sin()
    }

    /// The line that a length runs along: beside the lines of other lengths.
    fn foot(&self, view: &Projection) -> Vec3 {
        let aside = view.cm_per_point(view.depth(self.anchor)) * 22.0 * self.number as f32;
        self.anchor + view.axes()[0] * aside
    }

    /// Where the grip is drawn, and whether the head hides it. That of a circle goes to where it is seen.
    fn place(&self, seen: &Seen, scalps: &[&Scalp]) -> Option<(Pos2, bool)> {
        let view = seen.view;
        let place = match (self.handle, self.value) {
            (Handle::Point, Number::Point(p)) => match scalps.first().filter(|_| self.on_skin) {
                Some(scalp) => on_skin_of(scalp, self.space.place(p) - self.space.frame().origin).0,
                None => self.space.place(p),
            },
            (Handle::Radius | Handle::Ball, Number::One(r)) => {
                let on = |k: usize| {
                    self.anchor + self.across(view, k as f32 / 12.0) * r.max(0.0) * self.unit
                };
                (0..12).map(on).find(|p| !seen.hides(*p)).unwrap_or(on(0))
            }
            (Handle::Length, Number::One(x)) => self.foot(view) + self.out * x * self.unit,
            (Handle::Angle, Number::One(degrees)) => {
                let middle = view.screen(self.anchor)?;
                return Some((middle + self.turned(degrees), seen.hides(self.anchor)));
            }
            (Handle::Along, Number::One(u)) => along(&self.curve, u)?,
            _ => return None,
        };
        Some((view.screen(place)?, seen.hides(place)))
    }

    /// From an arc's middle to its grip: 0 degrees is to the right, positive turns left.
    fn turned(&self, degrees: f32) -> Vec2 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec2::new(cos, -sin) * (ARC + 14.0 * self.number as f32)
    }

    /// What the value is with the grip at a place of the screen.
    fn value_at(&self, view: &Projection, scalps: &[&Scalp], at: Pos2) -> Option<Number> {
        let ray = view.ray(at);
        let value = match self.handle {
            Handle::Point => {
                let on_skin = || {
                    let hits = scalps
                        .iter()
                        .filter_map(|s| s.surface().ray(ray.origin, ray.direction, 1e5));
                    hits.min_by(|a, b| a.distance.total_cmp(&b.distance)).map(|hit| hit.point)
                };
                let place = match self.on_skin {
                    true => on_skin()?,
                    false => view.at_depth(at, view.depth(self.anchor)),
                };
                return Some(Number::Point(self.space.given(place)));
            }
            Handle::Radius | Handle::Ball => {
                let depth = view.depth(self.anchor);
                view.at_depth(at, depth).distance(self.anchor) / self.unit
            }
            Handle::Length => {
                let foot = self.foot(view);
                (view.on_line(at, foot, self.out)? - foot).dot(self.out) / self.unit
            }
            Handle::Angle => {
                let off = at - view.screen(self.anchor)?;
                if off.length() < DEAD {
                    return None;
                }
                let Number::One(old) = self.value else { return None };
                // The turn nearest to the value that it had, so that an arc may be turned more than once around.
                let degrees = (-off.y).atan2(off.x).to_degrees();
                degrees + ((old - degrees) / 360.0).round() * 360.0
            }
            Handle::Along => nearest_along(&self.curve, view, at)?,
        };
        let (low, high) = self.input.hard.unwrap_or((f64::MIN, f64::MAX));
        value.is_finite().then(|| Number::One((f64::from(value)).clamp(low, high) as f32))
    }

    /// The value for people.
    fn words(&self) -> String {
        match self.value {
            Number::One(x) => format!("{x:.2}{}", self.input.unit.suffix()),
            Number::Point(p) => format!("{:.2} {:.2} {:.2}", p.x, p.y, p.z),
        }
    }

    fn draw(&self, seen: &Seen, ui: &egui::Ui) {
        let view = seen.view;
        let painter = ui.painter_at(view.rect);
        let stroke = Stroke::new(1.2, theme::ACCENT.gamma_multiply(0.75));
        let line = |points: Vec<Pos2>| painter.add(Shape::line(points, stroke));
        match (self.handle, self.value) {
            (Handle::Radius | Handle::Ball, Number::One(r)) => {
                let on = |k: usize| {
                    self.anchor + self.across(view, k as f32 / 64.0) * r.max(0.0) * self.unit
                };
                seen.line((0..=64).map(on), stroke, &painter);
            }
            (Handle::Length, Number::One(x)) => {
                let foot = self.foot(view);
                let on = |k: usize| foot + self.out * (x * self.unit * k as f32 / 16.0);
                seen.line((0..=16).map(on), stroke, &painter);
            }
            (Handle::Angle, Number::One(degrees)) => {
                let Some(middle) = view.screen(self.anchor) else { return };
                let degrees = degrees % 360.0;
                let part = |k: usize| middle + self.turned(degrees * k as f32 / 32.0);
                line([middle].into_iter().chain((0..=32).map(part)).collect());
            }
            (Handle::Along, _) => {
                let step = self.curve.len().div_ceil(64).max(1);
                let tip = self.curve.last();
                let points = self.curve.iter().step_by(step).chain(tip).copied();
                seen.line(points, stroke, &painter);
            }
            _ => {}
        }
    }
}

/// The point of a line at a fraction of its length.
fn along(curve: &[Vec3], u: f32) -> Option<Vec3> {
    let length: f32 = curve.windows(2).map(|w| w[0].distance(w[1])).sum();
    let mut left = u.clamp(0.0, 1.0) * length;
    for w in curve.windows(2) {
        let step = w[0].distance(w[1]);
        if left <= step {
            return Some(w[0].lerp(w[1], if step > 0.0 { left / step } else { 0.0 }));
        }
        left -= step;
    }
    curve.last().copied()
}

/// The fraction of a line's length at which it is drawn nearest to a place of the screen.
fn nearest_along(curve: &[Vec3], view: &Projection, at: Pos2) -> Option<f32> {
    let length: f32 = curve.windows(2).map(|w| w[0].distance(w[1])).sum();
    let mut before = 0.0;
    let mut best: Option<(f32, f32)> = None;
    for w in curve.windows(2) {
        let step = w[0].distance(w[1]);
        if let (Some(a), Some(b)) = (view.screen(w[0]), view.screen(w[1])) {
            let t = ((at - a).dot(b - a) / (b - a).length_sq().max(1e-6)).clamp(0.0, 1.0);
            let far = at.distance(a + (b - a) * t);
            if best.is_none_or(|(least, _)| far < least) {
                best = Some((far, before + step * t));
            }
        }
        before += step;
    }
    best.map(|(_, at)| at / length.max(1e-6))
}

#[cfg(test)]
mod tests {
    use super::super::projection::tests::{any_camera, any_rect};
    use super::*;
    use coif_nodes::maths::hash::Dice;

    fn grip(handle: Handle, input: &'static str, kind: &str, value: Number, anchor: Vec3) -> Grip {
        let (_, input) = coif_nodes::by_id(kind).unwrap().input(input).unwrap();
        assert_eq!(input.handle, Some(handle));
        Grip {
            input,
            handle,
            value,
            anchor,
            out: Vec3::Y,
            number: 1,
            curve: (0..20).map(|k| anchor + Vec3::new(k as f32 * 0.5, 0.0, 0.1)).collect(),
            space: HeadSpace::new(HeadFrame::IDENTITY, None),
            on_skin: false,
            unit: 1.0,
        }
    }

    #[test]
    fn a_grip_that_is_held_where_it_is_keeps_its_value() {
        for seed in 0..300 {
            let view = Projection::new(any_camera(seed), any_rect(seed));
            let dice = Dice::new(seed, 8, "grips");
            let anchor = view.at_depth(view.rect.center(), dice.range(0, 0, 20.0, 60.0));
            let x = dice.range(0, 1, 0.5, 6.0);
            let point = Number::Point(anchor);
            for (handle, input, kind, value) in [
                (Handle::Ball, "sphere_radius", "sphere_puff", Number::One(x)),
                (Handle::Radius, "root_radius", "sphere_puff", Number::One(x)),
                (Handle::Length, "tie_height", "sphere_puff", Number::One(x)),
                (Handle::Angle, "coverage", "sphere_puff", Number::One(20.0 * x)),
                (Handle::Along, "tie", "lissajous_braid", Number::One(0.1 + 0.1 * x)),
                (Handle::Point, "pivot", "transform", point),
            ] {
                let grip = grip(handle, input, kind, value, anchor);
                let seen = Seen { view: &view, scalps: &[] };
                let Some((at, _)) = grip.place(&seen, &[]) else { continue };
                let steep = view.axes()[2].dot(Vec3::Y).abs() > 0.95
                    || (handle == Handle::Along && view.axes()[2].x.abs() > 0.9);
                let Some(back) = grip.value_at(&view, &[], at).filter(|_| !steep) else { continue };
                match (value, back) {
                    (Number::One(a), Number::One(b)) => {
                        assert!((a - b).abs() < 0.02 * (1.0 + a.abs()), "{seed} {input}: {a} {b}");
                    }
                    (Number::Point(a), Number::Point(b)) => {
                        assert!(a.distance(b) < 0.01 * (1.0 + a.length()), "{seed}: {a} {b}");
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    #[test]
    fn grips_that_would_lie_on_one_another_are_held_apart_and_the_place_stays() {
        let names = [
            (Handle::Radius, "radius"),
            (Handle::Length, "height"),
            (Handle::Angle, "lean"),
            (Handle::Point, "position"),
        ];
        let one = Number::One(1.0);
        for seed in 0..200 {
            let dice = Dice::new(seed, 9, "apart");
            let middle = Pos2::new(300.0, 200.0);
            let placed: Vec<(Grip, Pos2)> = names
                .iter()
                .enumerate()
                .map(|(k, (handle, input))| {
                    let by = |n: u64| dice.range(k as u64, n, -20.0, 20.0);
                    let at = if seed == 0 { middle } else { middle + Vec2::new(by(1), by(2)) };
                    (grip(*handle, input, "gather", one, Vec3::ZERO), at)
                })
                .collect();
            let hands = apart(&placed);
            assert_eq!(hands[3], placed[3].1, "the position is where it is");
            for i in 0..4 {
                assert!(hands[i].distance(placed[i].1) <= 3.0 * APART + 0.1);
                for j in 0..i {
                    let far = hands[i].distance(hands[j]);
                    assert!(
                        far >= 2.0 * TARGET,
                        "{seed}: {} and {}: {far}",
                        names[i].1,
                        names[j].1
                    );
                }
            }
        }
    }

    #[test]
    fn drags_end_at_the_hard_limits() {
        let view = Projection::new(any_camera(3), any_rect(3));
        let anchor = view.at_depth(view.rect.center(), 40.0);
        let grip = grip(Handle::Ball, "sphere_radius", "sphere_puff", Number::One(6.0), anchor);
        let far = view.rect.center() + Vec2::new(1e6, 0.0);
        assert_eq!(grip.value_at(&view, &[], far), Some(Number::One(60.0)));
        let middle = view.screen(anchor).unwrap();
        assert_eq!(grip.value_at(&view, &[], middle), Some(Number::One(0.1)));
    }

    #[test]
    fn places_along_a_line_are_fractions_of_its_length() {
        let line = [Vec3::ZERO, Vec3::X * 3.0, Vec3::new(3.0, 1.0, 0.0)];
        assert_eq!(along(&line, 0.0), Some(line[0]));
        assert_eq!(along(&line, 0.75), Some(line[1]));
        assert_eq!(along(&line, 1.0), Some(line[2]));
        assert_eq!(along(&[], 0.5), None);
        assert_eq!(along(&[Vec3::Y, Vec3::Y], 0.5), Some(Vec3::Y));
    }
}
