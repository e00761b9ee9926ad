//! One node as it is drawn, and what hands do to it.
//!
//! Everything is painted, not built of widgets; only sockets and flags take the pointer. Each of them,
//! and the node itself, has a role and a name for screen readers and tests.

use super::look;
use super::marks::Mark;
use super::text::line;
use crate::core::faces::{Face, Plug, ROW, Trouble, WIDTH};
use crate::widgets::theme;
use egui::accesskit::Role;
use egui::{
    Align2, Color32, CornerRadius, Painter, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui,
    Vec2, pos2, vec2,
};

/// One end of a node: an input or an output, by its number among the node's plugs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum End {
    /// On the left.
    In(usize),
    /// On the right.
    Out(usize),
}

/// How much of a node is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Detail {
    /// All of it.
    Full,
    /// Name and sockets, for many nodes at once.
    Plain,
    /// A box with a name, for views from far away.
    Far,
    /// A box.
    Speck,
}

impl Detail {
    /// What can be read at a scale (points of the screen for a unit of the canvas), with so many
    /// nodes in sight.
    pub(super) fn at(scale: f32, nodes: usize) -> Self {
        match scale {
            s if s >= 0.62 || (s >= 0.45 && nodes <= 60) => Self::Full,
            s if s >= 0.38 => Self::Plain,
            s if s >= 0.2 => Self::Far,
            _ => Self::Speck,
        }
    }

    /// Whether sockets are drawn.
    pub(super) fn has_sockets(self) -> bool {
        matches!(self, Self::Full | Self::Plain)
    }
}

/// What else a node looks like just now.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mood {
    /// Selected.
    pub selected: bool,
    /// The selected node that keys mean.
    pub active: bool,
    /// Within the box that is being drawn, or under the pointer.
    pub near: bool,
    /// Runs, with this share of its work done.
    pub running: Option<f32>,
    /// The end that a wire in the hand would go to.
    pub aimed: Option<End>,
    /// A wire is in the hand.
    pub wiring: bool,
    /// Targets are large, for pens.
    pub pen: bool,
    /// Points of the screen for a unit of the canvas.
    pub scale: f32,
    /// Sockets have their names.
    pub named: bool,
}

/// What hands did to a node.
pub(super) struct NodeResponse {
    /// The flags that were clicked.
    pub display: bool,
    pub bypass: bool,
    /// Its ends and what was done to them.
    pub ends: Vec<(End, Response)>,
}

const FLAG: Vec2 = vec2(24.0, 26.0);

/// Draws a node at the cursor and says what was done to it.
pub(super) fn show(ui: &mut Ui, face: &Face, detail: Detail, mood: Mood) -> NodeResponse {
    let (rect, _) = ui.allocate_exact_size(face.size(), Sense::hover());
    let mut touched = NodeResponse { display: false, bypass: false, ends: vec![] };
    if !detail.has_sockets() {
        far(ui, face, rect, detail, mood);
        return touched;
    }
    body(ui, face, rect, mood);
    if detail == Detail::Full {
        header(ui, face, rect, &mut touched);
        if !face.collapsed {
            footer(ui, face, rect, mood);
        }
    } else {
        plain(ui, face, rect);
    }
    for number in 0..face.inputs.len() {
        let at = face.input_at(rect.min, number);
        end(ui, face, End::In(number), &face.inputs[number], at, mood, &mut touched);
    }
    for number in 0..face.outputs.len() {
        let at = face.output_at(rect.min, number);
        end(ui, face, End::Out(number), &face.outputs[number], at, mood, &mut touched);
    }
    touched
}

/// Tells screen readers what a node is.
pub(super) fn describe(
    ctx: &egui::Context,
    response: &Response,
    face: &Face,
    selected: bool,
    mark: Option<Mark>,
) {
    ctx.accesskit_node_builder(response.id, |node| {
        // The crate makes its widget before its size is known.
        let (min, max) = (response.rect.min, response.rect.max);
        node.set_bounds(egui::accesskit::Rect {
            x0: min.x.into(),
            y0: min.y.into(),
            x1: max.x.into(),
            y1: max.y.into(),
        });
        node.set_role(Role::Group);
        node.set_label(format!("{}: node", face.label));
        let kind = face.kind.as_deref().unwrap_or(&face.label);
        let trouble = match &face.trouble {
            Some(Trouble::Error(why)) => format!(", error: {why}"),
            Some(Trouble::Upstream(of)) => format!(", upstream: {of}"),
            Some(Trouble::Warning(said)) if said.len() == 1 => ", 1 warning".to_owned(),
            Some(Trouble::Warning(said)) => format!(", {} warnings", said.len()),
            None => String::new(),
        };
        let bypass = if face.bypass { ", bypassed" } else { "" };
        let shown = if face.displayed { ", displayed" } else { "" };
        let mark = mark.map_or(String::new(), |mark| format!(", {}", mark.name()));
        let text = format!("{kind}{shown}{bypass}{mark}{trouble} {}", face.footer);
        node.set_description(text);
        node.set_selected(selected);
    });
}

fn outline(p: &Painter, mood: Mood) -> Stroke {
    let (width, tint) = match mood {
        Mood { active: true, .. } => (2.0, theme::ACCENT),
        Mood { selected: true, .. } => (1.4, theme::ACCENT),
        Mood { near: true, .. } => (1.2, theme::QUIET),
        _ => (1.0, look::EDGE),
    };
    Stroke::new(width, tint.of(p))
}

/// How much of its colour a node keeps.
fn strength(face: &Face) -> f32 {
    if face.bypass { 0.45 } else { 1.0 }
}

fn far(ui: &Ui, face: &Face, rect: Rect, detail: Detail, mood: Mood) {
    // As large on the screen as letters and marks elsewhere.
    let unit = 1.0 / mood.scale.max(0.1);
    let p = ui.painter();
    let fill = look::header_fill(face.stage).mixed(look::stage_colour(face.stage), 0.2);
    let fill = fill.of(p).gamma_multiply(strength(face));
    p.rect(rect, 4.0, fill, outline(p, mood), StrokeKind::Middle);
    if face.displayed {
        p.rect_filled(
            Rect::from_min_size(rect.min, vec2(8.0, rect.height())),
            4.0,
            theme::ACCENT.of(ui),
        );
    }
    if detail == Detail::Far {
        let text = line(ui, &face.label, 11.0 * unit, theme::TEXT.of(ui), rect.width() - 4.0);
        let at = Align2::CENTER_CENTER.anchor_size(rect.center(), text.size());
        text.show(p, at.min, theme::TEXT.of(ui));
    }
    trouble_mark(ui, face, rect.left_top(), 6.0 * unit);
}

/// The header where many nodes are in sight: a name in larger letters.
fn plain(ui: &Ui, face: &Face, rect: Rect) {
    let middle = rect.top() + face.header() / 2.0;
    if face.displayed {
        look::eye(ui.painter(), pos2(rect.right() - 14.0, middle), true, false);
    }
    let colour = if face.bypass { theme::QUIET.of(ui) } else { theme::TEXT.of(ui) };
    let label = line(ui, &face.label, 17.0, colour, WIDTH - 36.0);
    let at = pos2(rect.left() + 10.0, middle - label.size().y / 2.0);
    label.show(ui.painter(), at, colour);
    trouble_mark(ui, face, rect.left_top(), 9.0);
}

fn trouble_mark(ui: &Ui, face: &Face, at: Pos2, r: f32) {
    match &face.trouble {
        Some(Trouble::Error(_)) => look::error_mark(ui.painter(), at, r),
        Some(Trouble::Warning(_)) => look::warning_mark(ui.painter(), at, r),
        Some(Trouble::Upstream(_)) => look::upstream_mark(ui.painter(), at, r),
        None => {}
    }
}

fn body(ui: &Ui, face: &Face, rect: Rect, mood: Mood) {
    let p = ui.painter();
    if mood.named {
        let shadow = rect.translate(vec2(0.0, 2.0)).expand(1.0);
        p.rect_filled(shadow, 6.0, Color32::from_black_alpha(70));
    }
    p.rect_filled(rect, 5.0, look::BODY.of(p).gamma_multiply(strength(face)));
    let header = Rect::from_min_size(rect.min, vec2(WIDTH, face.header()));
    let radius = if face.collapsed {
        CornerRadius::same(5)
    } else {
        CornerRadius { nw: 5, ne: 5, sw: 0, se: 0 }
    };
    p.rect_filled(
        header,
        radius,
        look::header_fill(face.stage).of(p).gamma_multiply(strength(face)),
    );
    p.rect_stroke(rect, 5.0, outline(p, mood), StrokeKind::Middle);
    if face.bypass && !face.collapsed && !face.inputs.is_empty() && !face.outputs.is_empty() {
        // The way that hair takes past the node.
        let ends = [face.input_at(rect.min, 0), face.output_at(rect.min, 0)];
        let line = Stroke::new(1.6, theme::WARNING.of(ui));
        p.extend(egui::Shape::dashed_line(&ends, line, 6.0, 4.0));
    }
}

fn header(ui: &mut Ui, face: &Face, rect: Rect, touched: &mut NodeResponse) {
    let middle = rect.top() + face.header() / 2.0;
    look::stage(ui.painter(), pos2(rect.left() + 15.0, middle), face.stage);
    let flags = [("display", 14.0), ("bypass", 38.0)];
    let mut room = WIDTH - 28.0 - 50.0;
    for (name, from_right) in flags {
        let at = pos2(rect.right() - from_right, middle);
        let set = if name == "display" { face.displayed } else { face.bypass };
        let id = ui.id().with((face.key, name));
        let response = ui.interact(Rect::from_center_size(at, FLAG), id, Sense::click());
        response.widget_info(|| {
            let label = format!("{}: {name}", face.label);
            egui::WidgetInfo::selected(egui::WidgetType::Checkbox, true, set, label)
        });
        if name == "display" {
            look::eye(ui.painter(), at, set, response.hovered());
            touched.display = response.clicked();
            response.on_hover_text("Show this node in the viewport (D)");
        } else {
            look::bypass(ui.painter(), at, set, response.hovered());
            touched.bypass = response.clicked();
            response.on_hover_text("Pass its input through (B)");
        }
    }
    let mut right = rect.right() - 56.0;
    if face.pinned {
        look::pen(ui.painter(), pos2(right, middle));
        (right, room) = (right - 14.0, room - 14.0);
    }
    if !face.note.is_empty() {
        look::note(ui.painter(), pos2(right, middle));
        room -= 12.0;
    }
    let colour = if face.bypass { theme::QUIET.of(ui) } else { theme::TEXT.of(ui) };
    let x = rect.left() + 28.0;
    let label = line(ui, &face.label, 13.0, colour, room);
    let (height, p) = (label.size().y, ui.painter());
    match &face.kind {
        Some(kind) => {
            let kind = line(ui, kind, look::SMALL, colour, room);
            let top = middle - (height + kind.size().y - 1.0) / 2.0;
            label.show(p, pos2(x, top), colour);
            kind.show(p, pos2(x, top + height - 1.0), colour);
        }
        None => {
            label.show(p, pos2(x, middle - height / 2.0), colour);
        }
    }
    if face.collapsed {
        trouble_mark(ui, face, rect.left_top(), 7.0);
    }
}

fn footer(ui: &Ui, face: &Face, rect: Rect, mood: Mood) {
    let p = ui.painter();
    let top = rect.bottom() - crate::core::faces::FOOTER;
    let middle = top + crate::core::faces::FOOTER / 2.0;
    let (mut x, mut colour, mut text) =
        (rect.left() + 9.0, theme::QUIET.of(ui), face.footer.clone());
    if face.trouble.is_some() && mood.running.is_none() {
        trouble_mark(ui, face, pos2(rect.left() + 13.0, middle - 0.5), 6.0);
        x += 15.0;
    }
    match (&face.trouble, mood.running) {
        (_, Some(_)) => text = "running".to_owned(),
        (Some(Trouble::Error(why)), _) => (text, colour) = (why.clone(), theme::ERROR.of(ui)),
        (Some(Trouble::Upstream(of)), _) => text = format!("upstream: {of}"),
        (Some(Trouble::Warning(_)), _) => colour = theme::WARNING.of(ui),
        _ => {}
    }
    if text.is_empty() {
        text = if face.bypass { "bypassed" } else { "not run yet" }.to_owned();
    }
    p.hline(rect.x_range().shrink(6.0), top, Stroke::new(1.0, look::RULE.of(p)));
    let room = rect.right() - 8.0 - x;
    let mut words = line(ui, &text, look::SMALL, colour, room);
    // Half a number says nothing: what has no room is left to the tooltip.
    while words.is_cut()
        && let Some((shorter, _)) = text.rsplit_once(crate::core::faces::PARTS)
    {
        text = shorter.to_owned();
        words = line(ui, &text, look::SMALL, colour, room);
    }
    let at = pos2(x, middle - words.size().y / 2.0);
    words.show(p, at, colour);
    if let Some(share) = mood.running {
        let bar = Rect::from_min_max(pos2(rect.left() + 1.0, rect.bottom() - 3.0), rect.max);
        p.rect_filled(bar, 1.0, theme::SUNKEN.of(ui));
        let done = Rect::from_min_size(bar.min, vec2(bar.width() * share.clamp(0.02, 1.0), 3.0));
        p.rect_filled(done, 1.0, theme::ACCENT.of(ui));
    }
}

fn end(
    ui: &mut Ui,
    face: &Face,
    end: End,
    plug: &Plug,
    at: Pos2,
    mood: Mood,
    touched: &mut NodeResponse,
) {
    // An input of very many wires is longer than the window.
    if !ui.clip_rect().expand(ROW).contains(at) {
        return;
    }
    let inward = if matches!(end, End::In(_)) { 1.0 } else { -1.0 };
    let height = if face.collapsed { 14.0 } else { ROW + 2.0 };
    let reach = Rect::from_center_size(
        at + vec2(4.0 * inward, 0.0),
        vec2(if mood.pen { 40.0 } else { 26.0 }, height),
    );
    let id = ui.id().with((face.key, end_name(end)));
    let response = ui.interact(reach, id, Sense::click_and_drag());
    let side = if matches!(end, End::In(_)) { "input" } else { "output" };
    response.widget_info(|| {
        let label = format!("{}: {} {side}", face.label, plug.label());
        egui::WidgetInfo::labeled(egui::WidgetType::Button, true, label)
    });
    let bright = mood.aimed == Some(end) || (response.hovered() && !mood.wiring);
    let wired = plug.wire.is_some();
    let p = ui.painter();
    if plug.many && matches!(end, End::In(_)) && plug.wire.is_none() {
        // Room for one more.
        p.circle_stroke(at, look::SOCKET + 2.6, Stroke::new(1.0, look::EDGE.of(p)));
    }
    look::socket(p, at, plug.ty, wired || matches!(end, End::Out(_)), bright);
    if mood.named && !face.collapsed {
        let missing = plug.needed && !wired;
        let colour = match (missing, wired || matches!(end, End::Out(_))) {
            (true, _) => theme::WARNING.of(ui),
            (_, true) => theme::TEXT.of(ui),
            _ => theme::QUIET.of(ui),
        };
        let both = face.inputs.len().min(face.outputs.len()) > 0;
        let room = if both { WIDTH / 2.0 + 16.0 } else { WIDTH - 24.0 };
        let text = line(ui, &plug.label(), 11.5, colour, room);
        let y = at.y - text.size().y / 2.0;
        let x = match end {
            End::In(_) => at.x + 11.0,
            End::Out(_) => at.x - 11.0 - text.size().x,
        };
        text.show(ui.painter(), pos2(x, y), colour);
    }
    let response =
        if mood.wiring { response } else { response.on_hover_ui(|ui| tip(ui, face, end, plug)) };
    touched.ends.push((end, response));
}

fn end_name(end: End) -> (&'static str, usize) {
    match end {
        End::In(number) => ("in", number),
        End::Out(number) => ("out", number),
    }
}

/// What a socket is for.
fn tip(ui: &mut Ui, face: &Face, end: End, plug: &Plug) {
    ui.set_max_width(320.0);
    let ty = plug.ty.map_or("not known to this version", coif_nodes::define::Type::name);
    ui.strong(format!("{} ({ty})", plug.label()));
    let doc = face.def.and_then(|def| match end {
        End::In(_) => def.input(&plug.socket.name).map(|(_, input)| input.doc()),
        End::Out(_) => def.output(&plug.socket.name).map(|(_, output)| output.doc()),
    });
    if let Some(doc) = doc {
        ui.label(doc);
    }
    if plug.needed && plug.wire.is_none() {
        ui.colored_label(theme::WARNING.of(ui), "Required: wire it.");
    }
}

/// What a node is, what it said, and its note.
pub(super) fn node_tip(ui: &mut Ui, face: &Face) {
    ui.set_max_width(360.0);
    ui.strong(&face.label);
    match face.def {
        Some(def) => {
            let doc = def.doc();
            ui.label(doc.split("\n\n").next().unwrap_or_default());
        }
        None => {
            ui.label("This version does not know this kind of node. It is kept as it is.");
        }
    }
    if !face.footer.is_empty() {
        ui.weak(&face.footer);
    }
    match &face.trouble {
        Some(Trouble::Error(why)) => {
            ui.colored_label(theme::ERROR.of(ui), format!("\u{2716} {why}"));
        }
        Some(Trouble::Upstream(of)) => {
            ui.colored_label(theme::ERROR.of(ui), format!("upstream: {of}"));
        }
        Some(Trouble::Warning(said)) => {
            for said in said.iter().take(4) {
                ui.colored_label(theme::WARNING.of(ui), format!("\u{26A0} {said}"));
            }
        }
        None => {}
    }
    if !face.note.is_empty() {
        ui.separator();
        ui.label(face.note.chars().take(1000).collect::<String>());
    }
}
