//! One grip: where it stands, what its value is where it is dragged to, and how it is drawn.
//!
//! Guaranteed: values lie within the input's hard limits. What the head hides is not known here, but by [`Seen`].

use super::Seen;
use crate::core::projection::Projection;
use crate::core::shown::{Shown, first_output};
use crate::widgets::theme;
use coif_graphs::document::{Document, NodeId, Setting, Socket, wiring};
use coif_nodes::data::attributes::{NORMAL, PUFF_CENTRE};
use coif_nodes::data::scalp::{HeadFrame, HeadSpace, Scalp};
use coif_nodes::define::{Handle, InputDef, SCALES, Type, Unit, Value};
use egui::{Pos2, Shape, Stroke, Vec2};
use glam::Vec3;
use std::sync::Arc;

/// The radius of the arc of an angle, points.
const ARC: f32 = 44.0;
/// An angle's grip is not turned by less than this distance from its middle, points.
const DEAD: f32 = 4.0;

/// A value that can be dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    /// A number, or a field that is the same everywhere.
    One(f32),
    /// A point in head units.
    Point(Vec3),
}

/// One grip.
#[derive(Clone)]
pub(super) struct Grip {
    pub(super) input: &'static InputDef,
    pub(super) handle: Handle,
    pub(super) value: Number,
    /// What it stands about, cm.
    pub(super) anchor: Vec3,
    /// Unit: away from the skin there.
    pub(super) out: Vec3,
    /// Which of the node's grips of its kind.
    pub(super) number: usize,
    /// The curve that the value runs along.
    pub(super) curve: Arc<[Vec3]>,
    /// What points are given in.
    pub(super) space: HeadSpace,
    /// Points stay on the skin.
    pub(super) on_skin: bool,
    /// What a typed centimetre is, cm.
    pub(super) unit: f32,
}

/// Inputs that say where a node's things are, instead of its own point.
const PLACES: [&str; 2] = ["placements", "ties"];
/// What a tie says instead of these.
const TIED: [&str; 2] = ["root_radius", "tie_height"];

/// The value of an input as it is set, there or by a parameter that it reads, where it can be dragged.
fn number(document: &Document, node: &NodeId, input: &InputDef) -> Option<Number> {
    let at = wiring::set_at(document, &Socket::new(node.clone(), input.name));
    if !document.wires(&at.node, &at.name).is_empty() {
        return None;
    }
    let set = document.node(at.node.as_str())?.inputs.get(&*at.name);
    let value = match set {
        Some(Setting::Known(value)) => value.clone(),
        Some(Setting::Raw(_)) => return None,
        None => wiring::input_def(document, &at).and_then(InputDef::default).or(input.default())?,
    };
    match value {
        Value::Float(x) => Some(Number::One(x)),
        Value::Field(field) => field.constant().map(Number::One),
        Value::Vec3(p) => Some(Number::Point(p)),
        _ => None,
    }
}

/// The grips of a node, in the order of its inputs.
pub(super) fn grips(
    document: &Document,
    shown: &Shown,
    node: &NodeId,
    view: &Projection,
) -> Vec<Grip> {
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
    let set = document.node(node.as_str()).and_then(|node| node.inputs.get(SCALES));
    let scales = def.scales && !matches!(set, Some(Setting::Known(Value::Bool(false))));
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
            && crate::widgets::text::zero_words(&input.doc()).is_some();
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
            unit: input.grown(1.0, unit),
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
    pub(super) fn place(&self, seen: &Seen, scalps: &[&Scalp]) -> Option<(Pos2, bool)> {
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
    pub(super) fn value_at(
        &self,
        view: &Projection,
        scalps: &[&Scalp],
        at: Pos2,
    ) -> Option<Number> {
        let ray = view.ray(at);
        let value = match self.handle {
            Handle::Point => {
                let on_skin = || {
                    let hits = scalps
                        .iter()
                        .filter_map(|s| s.surface().ray(ray.origin, ray.direction, super::FAR));
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
    pub(super) fn words(&self) -> String {
        match self.value {
            Number::One(x) => format!("{x:.2}{}", self.input.unit.suffix()),
            Number::Point(p) => format!("{:.2} {:.2} {:.2}", p.x, p.y, p.z),
        }
    }

    pub(super) fn draw(&self, seen: &Seen, ui: &egui::Ui) {
        let view = seen.view;
        let painter = ui.painter_at(view.rect);
        let stroke = Stroke::new(1.2, theme::ACCENT.dark.gamma_multiply(0.75));
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
pub(super) fn along(curve: &[Vec3], u: f32) -> Option<Vec3> {
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
