//! One row of the inspector: socket, name, value, reset; and the tooltip, which is the manual.

use super::number::Scale;
use super::target::{EditTarget, default_of};
use super::value;
use crate::core::event::Event;
use crate::core::state::Select;
use crate::widgets::panel;
use crate::widgets::text::{icon_button, set_name, spoken};
use crate::widgets::theme;
use coif_graphs::document::Socket;
use coif_graphs::document::edit::Edit;
use coif_graphs::text::write_value;
use coif_nodes::define::{Arity, InputDef, Type, Value};
use egui::{Align2, CursorIcon, Response, Sense, Stroke, TextStyle, Ui, Vec2, vec2};

/// Room for the socket before the name, and for the reset behind the value.
const EDGE: f32 = 20.0;

/// The share of the width that names take.
const NAMES: f32 = 0.38;

/// What is pressed beside a value. Tab goes from value to value.
const PRESSED: Sense = Sense::CLICK;

/// Gives what is pressed its name, and its place to screen readers, which know by themselves only what Tab reaches.
fn named(ui: &Ui, response: &Response, name: &str) {
    let enabled = ui.is_enabled();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, enabled, name));
}

/// Shows an input of the target, `width` points wide.
pub(crate) fn show(
    ui: &mut Ui,
    target: &mut EditTarget,
    input: &'static InputDef,
    known: &super::FieldNames,
    width: f32,
) {
    let height = ui.spacing().interact_size.y;
    let names = (width * NAMES).max(84.0) - EDGE;
    let name = spoken(input.name);
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        socket(ui, target, input, &name, height);
        let label = label(ui, target, input, &name, vec2(names, height));
        if label.clicked() && ui.input(|input| input.modifiers.alt) {
            target.unset(input);
        }
        label.context_menu(|ui| panel::list(ui, |ui| menu(ui, target, input)));
        let rest = (width - EDGE - names - EDGE - 4.0).max(60.0);
        ui.vertical(|ui| {
            ui.set_width(rest);
            ui.spacing_mut().item_spacing = vec2(3.0, 2.0);
            if target.wires(input).is_empty() {
                let counts = target.idle(input).is_none();
                ui.add_enabled_ui(counts, |ui| value::show(ui, target, input, &name, known, rest));
            } else {
                wires(ui, target, input, &name, rest);
            }
        });
        ui.add_space(4.0);
        reset(ui, target, input, &name, height);
    });
}

/// The socket: filled when wired, a ring when the canvas shows it, a dot when it does not.
fn socket(ui: &mut Ui, target: &mut EditTarget, input: &InputDef, name: &str, height: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(EDGE, height), PRESSED);
    let colour = theme::of_type(Some(input.ty)).of(ui);
    let wired = !target.wires(input).is_empty();
    let only_wire = matches!(input.ty, Type::Curves | Type::Scalp);
    let sockets: Vec<Socket> =
        target.nodes.iter().map(|node| Socket::new(node.clone(), input.name)).collect();
    let exposed = sockets.iter().all(|socket| target.state.exposed.contains(socket));
    let centre = rect.center() - vec2(2.0, 0.0);
    let painter = ui.painter();
    if wired {
        painter.circle_filled(centre, 4.5, colour);
    } else if only_wire || exposed {
        painter.circle_stroke(centre, 4.0, Stroke::new(1.5, colour));
    } else if response.hovered() {
        painter.circle_stroke(centre, 4.0, Stroke::new(1.0, theme::QUIET.of(ui)));
    } else {
        painter.circle_filled(centre, 1.5, theme::LINE.of(ui));
    }
    if only_wire {
        return;
    }
    named(ui, &response, &format!("{name} as socket"));
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_role(egui::accesskit::Role::CheckBox);
        node.set_toggled(exposed.into());
    });
    if response.clicked() {
        for socket in sockets {
            target.out.push(Event::Expose { socket, exposed: !exposed });
        }
    }
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    response.on_hover_text(if exposed {
        "Shown as a socket on the canvas. Click to hide the socket."
    } else {
        "Click to show this input as a socket on the canvas, to wire it."
    });
}

/// The name. What is changed from its default stands out by weight of colour and a bar.
fn label(ui: &mut Ui, target: &EditTarget, input: &InputDef, name: &str, size: Vec2) -> Response {
    let (rect, response) = ui.allocate_exact_size(size, PRESSED);
    let changed = target.is_changed(input);
    let colour = if changed { theme::TEXT.of(ui) } else { theme::QUIET.of(ui) };
    let font = TextStyle::Body.resolve(ui.style());
    let painter = ui.painter_at(rect);
    if changed {
        let bar = egui::Rect::from_min_size(rect.min + vec2(0.0, 5.0), vec2(2.0, size.y - 10.0));
        painter.rect_filled(bar, 1.0, theme::ACCENT.of(ui));
    }
    painter.text(rect.left_center() + vec2(6.0, 0.0), Align2::LEFT_CENTER, name, font, colour);
    response.on_hover_ui(|ui| tooltip(ui, target, input, name))
}

/// What the manual says.
pub(crate) fn tooltip(ui: &mut Ui, target: &EditTarget, input: &InputDef, name: &str) {
    ui.set_max_width(380.0);
    ui.strong(name);
    ui.label(input.doc());
    if let Some(why) = target.idle(input) {
        ui.colored_label(theme::WARNING.of(ui), format!("Has no effect now: {why}."));
    }
    let scale = Scale::of(input);
    let mut facts = vec![];
    if target.differ(input) {
        facts.push("the selected nodes differ".to_owned());
    }
    match (default_of(input), input.arity) {
        (Some(value), _) => facts.push(format!("default {}", told(&value, &scale))),
        (None, Arity::Optional) => facts.push("may be left unset".to_owned()),
        (None, Arity::Many) => facts.push("takes any number of wires".to_owned()),
        (None, Arity::One) => facts.push("needs a wire".to_owned()),
    }
    if let Some(hard) = input.hard {
        facts.push(format!("takes {}", scale.range(hard)));
    }
    if let Some(soft) = input.soft.filter(|soft| Some(*soft) != input.hard) {
        facts.push(format!("slider {}", scale.range(soft)));
    }
    facts.push(input.ty.name().to_owned());
    ui.weak(facts.join(" · "));
}

/// A value in a few words.
fn told(value: &Value, scale: &Scale) -> String {
    match value {
        Value::Float(x) => scale.text(f64::from(*x)),
        Value::Int(x) => x.to_string(),
        Value::Bool(on) => (if *on { "on" } else { "off" }).to_owned(),
        Value::Text(text) if text.is_empty() => "empty".to_owned(),
        Value::Text(text) => text.to_string(),
        Value::Strokes(strokes) if strokes.0.is_empty() => "none".to_owned(),
        Value::Gestures(gestures) if gestures.0.is_empty() => "none".to_owned(),
        other => write_value(other),
    }
}

fn menu(ui: &mut Ui, target: &mut EditTarget, input: &'static InputDef) {
    let set = target.is_set(input);
    let reset = ui.add_enabled(set, egui::Button::new("Reset to default"));
    if reset.on_disabled_hover_text("Already at the default.").clicked() {
        target.unset(input);
        ui.close();
    }
    super::ports::menu(ui, target, input);
    if let super::target::InputSetting::Value(value) = target.held(input)
        && ui.button("Copy as text").clicked()
    {
        ui.ctx().copy_text(write_value(&value));
        ui.close();
    }
}

fn reset(ui: &mut Ui, target: &mut EditTarget, input: &'static InputDef, name: &str, height: f32) {
    let changed = target.is_changed(input);
    let sense = if changed { PRESSED } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(EDGE, height), sense);
    if !changed {
        return;
    }
    named(ui, &response, &format!("{name}: reset"));
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_role(egui::accesskit::Role::Button);
    });
    let colour = if response.hovered() { theme::TEXT.of(ui) } else { theme::QUIET.of(ui) };
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, "⟲", font, colour);
    if response.clicked() {
        target.unset(input);
    }
    response.on_hover_text(match input.arity {
        Arity::Optional => "Reset: leaves it unset. Alt+click on the name or value does the same.",
        _ => "Reset to the default. Alt+click on the name or value does the same.",
    });
}

/// What an input is wired from.
fn wires(ui: &mut Ui, target: &mut EditTarget, input: &InputDef, name: &str, width: f32) {
    let from: Vec<Socket> = target.wires(input).to_vec();
    let several = from.len() > 1;
    let button = ui.spacing().interact_size.y;
    for (i, wire) in from.iter().enumerate() {
        ui.horizontal(|ui| {
            let there = target.state.document.nodes.contains_key(&wire.node);
            let source = target.state.document.name_of(&wire.node);
            let text = match wire.name.as_ref() {
                "curves" | "scalp" => format!("⏵ {source}"),
                output => format!("⏵ {source}: {}", spoken(output).to_lowercase()),
            };
            let size = vec2((width - button - 3.0).max(40.0), button);
            let go = egui::Button::new(text).right_text("").truncate().min_size(size);
            let go = ui.add_enabled(there, go);
            let number = if several { format!(" {}", i + 1) } else { String::new() };
            set_name(ui, &go, &format!("{name}{number}: go to {source}"));
            if go.on_hover_text(format!("Wired from {wire}. Click to go to that node.")).clicked() {
                target.out.push(Event::Select(Select::Nodes(vec![wire.node.clone()])));
            }
            // It asks: in other rows other buttons are at its place, and a slip is not to cost a wire.
            let cut = icon_button(ui, "✖", &format!("{name}{number}: disconnect"));
            egui::Popup::menu(&cut).show(|ui| {
                if ui.button(format!("Disconnect from {source}")).clicked()
                    && let Some(node) = target.nodes.first()
                {
                    let to = Socket::new(node.clone(), input.name);
                    target.out.push(Event::Edit(Edit::Disconnect { to, at: i }));
                    ui.close();
                }
            });
        });
    }
    if target.nodes.len() > 1 {
        ui.weak("Wires of the active node.");
    }
}
