//! The value of an input, by its type. What cannot be read is shown as the text that is kept.

use super::FieldNames;
use super::field::{FieldEditor, NumberSource};
use super::number::Scale;
use super::ramp::RampField;
use super::shapes;
use super::slider::{Done, NumberField};
use super::target::{EditTarget, How, InputSetting};
use super::wheel;
use crate::core::documents;
use crate::core::event::Event;
use crate::widgets::text::{icon_button, set_name, spoken, text_field, zero_words};
use crate::widgets::theme;
use coif_graphs::document::edit::Edit;
use coif_graphs::document::wiring::LooseWire;
use coif_graphs::document::{Node, NodeId, Socket};
use coif_nodes::data::field::Field;
use coif_nodes::data::gestures::{Gestures, Tool};
use coif_nodes::data::shapes::{ShapeList, Tier, TurnProfile};
use coif_nodes::data::strokes::Strokes;
use coif_nodes::declared::{GROUP_INPUT, PARAMETERS};
use coif_nodes::define::{Arity, InputDef, Type, Unit, Value, choice_name};
use egui::ecolor::{gamma_u8_from_linear_f32, linear_f32_from_gamma_u8};
use egui::{Checkbox, ComboBox, Ui};
use glam::Vec3;

/// Shows what the target holds in an input without wires, and says what is done to it.
pub(crate) fn show(
    ui: &mut Ui,
    target: &mut EditTarget,
    input: &'static InputDef,
    name: &str,
    known: &FieldNames,
    width: f32,
) {
    let held = match target.held(input) {
        InputSetting::Raw(text) => {
            ui.horizontal_wrapped(|ui| {
                ui.weak("Kept as text:");
                ui.monospace(text.chars().take(400).collect::<String>());
            });
            ui.weak("This version cannot read it. Reset gives it the default.");
            return;
        }
        InputSetting::Value(value) => Some(value),
        InputSetting::Unset => None,
    };
    match (input.ty, held) {
        (Type::Curves | Type::Scalp, _) => {
            let text = match input.arity {
                Arity::One => "Not connected: wire it on the canvas",
                _ => "Not connected",
            };
            let colour =
                if input.arity == Arity::One { theme::WARNING.of(ui) } else { theme::QUIET.of(ui) };
            ui.horizontal(|ui| {
                ui.set_height(ui.spacing().interact_size.y);
                ui.colored_label(colour, text);
            });
        }
        (Type::Bool, value) => {
            bool(ui, target, input, name, matches!(value, Some(Value::Bool(true))))
        }
        (Type::Int | Type::Float, value) => number(ui, target, input, name, value.as_ref(), width),
        (Type::Field, value) => field(ui, target, input, name, value.as_ref(), known, width),
        (Type::Vec3, Some(Value::Vec3(v))) => vector(ui, target, input, name, v, width),
        (Type::Colour, Some(Value::Vec3(v))) => colour(ui, target, input, name, v, width),
        (Type::Text, Some(Value::Text(text))) => {
            if let Some(text) = text_field(ui, name, &text, "empty", (width, 1)) {
                target.set(input, text.as_str(), How::Once);
            }
        }
        (Type::Choice(words), Some(Value::Text(word))) => {
            choice(ui, target, input, name, words, &word, width);
        }
        (Type::File, value) => file(ui, target, input, name, value.as_ref(), width),
        (Type::Ramp, Some(Value::Ramp(ramp))) => {
            let scale = ramp_scale(input);
            let editor = RampField { name, scale: &scale };
            if let Some((ramp, how)) = editor.show(ui, &ramp, width) {
                target.set(input, ramp, how);
            }
        }
        (Type::Shapes, Some(Value::Shapes(list))) => {
            if let Some((list, how)) = shapes::show(ui, name, &list, width) {
                target.set(input, list, how);
            }
        }
        (Type::Shapes, None) => {
            let own = ui.button("Choose shapes").on_hover_text("Unset: follows other inputs.");
            set_name(ui, &own, &format!("{name}: choose"));
            if own.clicked() {
                let list = ShapeList(vec![(Tier::A, TurnProfile::Circle)]);
                target.set(input, list, How::Once);
            }
        }
        (Type::Strokes, value) => {
            let none = Strokes::default();
            let strokes = match &value {
                Some(Value::Strokes(strokes)) => strokes,
                _ => &none,
            };
            drawn(ui, target, input, name, strokes);
        }
        (Type::Gestures, value) => {
            let none = Gestures::default();
            let gestures = match &value {
                Some(Value::Gestures(gestures)) => gestures,
                _ => &none,
            };
            ui.horizontal_wrapped(|ui| ui.label(counted(gestures)));
            if clear(ui, name, "gestures", !gestures.0.is_empty()) {
                target.set(input, none, How::Once);
            }
        }
        (_, Some(other)) => {
            ui.weak(format!("Holds a {}.", other.type_name()));
        }
        (ty, None) => {
            ui.weak(format!("Unset: takes a {}.", ty.name()));
        }
    }
}

/// Ramps of angles without a range of their own show half a turn either way.
fn ramp_scale(input: &InputDef) -> Scale {
    let slider = match (input.soft.or(input.hard), input.unit) {
        (None, Unit::Angle) => Some((-180.0, 180.0)),
        (None, _) => Some((0.0, 1.0)),
        (some, _) => some,
    };
    Scale::new(input.unit, slider, input.hard, false)
}

fn bool(ui: &mut Ui, target: &mut EditTarget, input: &InputDef, name: &str, mut on: bool) {
    let text = match (target.differ(input), on) {
        (true, _) => "Differ",
        (_, true) => "On",
        (_, false) => "Off",
    };
    let response = ui.add(Checkbox::new(&mut on, text).indeterminate(target.differ(input)));
    set_name(ui, &response, name);
    if response.changed() {
        target.set(input, on, How::Once);
    }
}

fn as_number(held: &InputSetting) -> Option<f64> {
    match held {
        InputSetting::Value(Value::Float(x)) => Some(f64::from(*x)),
        InputSetting::Value(Value::Int(x)) => Some(*x as f64),
        InputSetting::Value(Value::Field(field)) => field.constant().map(f64::from),
        _ => None,
    }
}

fn number(
    ui: &mut Ui,
    target: &mut EditTarget,
    input: &'static InputDef,
    name: &str,
    value: Option<&Value>,
    width: f32,
) {
    let scale = Scale::of(input);
    let seed = input.ty == Type::Int && input.name == "seed";
    let button = ui.spacing().interact_size.y;
    ui.horizontal(|ui| {
        let width = if seed { width - button - 3.0 } else { width };
        let value =
            value.map(|value| as_number(&InputSetting::Value(value.clone()))).unwrap_or_default();
        let instead = target.differ(input).then_some("differ");
        let doc = input.doc();
        let unset = unset_words(&doc);
        let zero = zero_words(&doc).filter(|_| value == Some(0.0));
        let instead = instead.or(zero);
        let field = NumberField { name, value, instead, unset, scale: &scale };
        let (response, done) = field.show(ui, width.max(30.0));
        if let Some(done) = done {
            apply(target, input, &scale, done);
        }
        response.on_hover_ui(|ui| {
            super::row::tooltip(ui, target, input, name);
            ui.weak("Drag, or click to type. Units and arithmetic work: 3mm, 1/3, +=0.2, *=2.");
        });
        if seed && icon_button(ui, "🎲", "New seed").clicked() {
            let of = |held: InputSetting| Some(Value::Int(next_seed(as_number(&held)? as i64)));
            target.set_each(input, How::Once, of);
        }
    });
}

/// What a declaration says that an unset input means: "Unset: the preset's."
fn unset_words(doc: &str) -> Option<&str> {
    let (_, words) = doc.split_once("Unset: ")?;
    let end = words.find(['.', ';', ',']).unwrap_or(words.len());
    Some(&words[..end]).filter(|words| words.len() < 24)
}

/// Another seed tag from 1 to 99,999, the same for the same one.
fn next_seed(seed: i64) -> i64 {
    let mixed = (seed as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20;
    let next = (mixed % 99_999) as i64 + 1;
    if next == seed { next % 99_999 + 1 } else { next }
}

/// Does to the nodes what was done to a number field.
fn apply(target: &mut EditTarget, input: &'static InputDef, scale: &Scale, done: Done) {
    target.said.remove(input.name);
    let value = |x: f64| match input.ty {
        Type::Int => Value::Int(x.round() as i64),
        _ => Value::Float(x as f32),
    };
    match done {
        Done::Dragged(x) => target.set(input, value(x), How::Drag),
        Done::Reset => target.unset(input),
        Done::Refused(why) => {
            target.said.insert(input.name, why);
        }
        Done::Typed(entry) => {
            let olds: Vec<f64> = target
                .nodes
                .iter()
                .map(|node| as_number(&target.held_by(node, input)).unwrap_or(0.0))
                .collect();
            let said = olds.iter().find_map(|old| scale.clamp(entry.apply(*old)).1);
            let new = |held: InputSetting| {
                let old = as_number(&held).unwrap_or(0.0);
                Some(value(scale.clamp(entry.apply(old)).0))
            };
            target.set_each(input, How::Once, new);
            if let Some(said) = said {
                target.said.insert(input.name, said);
            }
        }
        Done::Nudged(by) => {
            let new = |held: InputSetting| {
                let x = as_number(&held)? + by;
                Some(value(scale.clamp(scale.snap(x, scale.step(x) / 10.0)).0))
            };
            target.set_each(input, How::Nudge, new);
        }
    }
}

fn field(
    ui: &mut Ui,
    target: &mut EditTarget,
    input: &'static InputDef,
    name: &str,
    value: Option<&Value>,
    known: &FieldNames,
    width: f32,
) {
    let scale = Scale::of(input);
    let editor = FieldEditor { name, scale: &scale, names: known };
    let button = ui.spacing().interact_size.y;
    let held = match value {
        Some(Value::Field(field)) => Some((**field).clone()),
        Some(Value::Float(x)) => Some(Field::Constant(*x)),
        _ => None,
    };
    ui.horizontal_top(|ui| {
        let inner = (width - button - 3.0).max(60.0);
        match &held {
            None | Some(Field::Constant(_)) => {
                ui.vertical(|ui| {
                    ui.set_width(inner);
                    number(ui, target, input, name, value, inner);
                });
            }
            Some(field) => {
                ui.vertical(|ui| {
                    ui.set_width(inner);
                    if target.differ(input) {
                        ui.weak("The selected nodes differ.");
                    }
                    if let Some((field, how)) = editor.show(ui, field, inner) {
                        target.set(input, field, how);
                    }
                });
            }
        }
        let now = held.unwrap_or(Field::Constant(1.0));
        match editor.source_menu(ui, &now, &painted(target, input)) {
            Some(NumberSource::Field(field)) => target.set(input, field, How::Once),
            Some(NumberSource::Wire(from)) => {
                let to = |node: &NodeId| Socket::new(node.clone(), input.name);
                let wire = |node| Edit::Connect { from: from.clone(), to: to(node), at: None };
                target.say(target.nodes.iter().map(wire).collect(), How::Once);
            }
            None => {}
        }
    });
}

/// The outputs that give fields, such as painted masks, and could be wired to an input, with the names of their nodes.
fn painted(target: &EditTarget, input: &InputDef) -> Vec<(Socket, String)> {
    let (document, Some(node)) = (&target.state.document, target.nodes.first()) else {
        return vec![];
    };
    // Ports and parameters only pass fields on; they are not masks.
    let hands_on = |node: &Node| matches!(node.kind.as_str(), GROUP_INPUT | PARAMETERS);
    let beside =
        document.nodes.iter().filter(|(id, it)| id.group() == node.group() && !hands_on(it));
    let fields = beside.filter_map(|(id, _)| {
        let output = document.def(id)?.outputs.iter().find(|output| output.ty == Type::Field)?;
        Some(Socket::new(id.clone(), output.name))
    });
    let fields: Vec<Socket> = fields.collect();
    if fields.is_empty() {
        return vec![];
    }
    let loose = LooseWire::from_input(document, Socket::new(node.clone(), input.name));
    let fits = fields.into_iter().filter(|from| loose.reason(from).is_none());
    fits.map(|from| (from.clone(), document.name_of(&from.node).into_owned())).collect()
}

/// Three numbers side by side; gives the vector they become.
fn three(
    ui: &mut Ui,
    target: &EditTarget,
    input: &InputDef,
    (name, parts): (&str, [&str; 3]),
    scale: &Scale,
    v: Vec3,
    width: f32,
) -> Option<(Vec3, How)> {
    let mut new = None;
    let each = ((width - 6.0) / 3.0).max(36.0);
    for (i, part) in parts.iter().enumerate() {
        let name = format!("{name} {part}");
        let x = f64::from(v[i]);
        let instead = target.differ(input).then_some("differ");
        let field = NumberField { name: &name, value: Some(x), instead, unset: None, scale };
        let (response, done) = field.show(ui, each);
        response.on_hover_text(spoken(part));
        let (to, how) = match done {
            Some(Done::Dragged(to)) => (to, How::Drag),
            Some(Done::Typed(entry)) => (entry.apply(x), How::Once),
            Some(Done::Nudged(by)) => (x + by, How::Nudge),
            _ => continue,
        };
        let mut to_vector = v;
        to_vector[i] = scale.clamp(to).0 as f32;
        new = Some((to_vector, how));
    }
    new
}

fn vector(ui: &mut Ui, target: &mut EditTarget, input: &InputDef, name: &str, v: Vec3, width: f32) {
    let scale = Scale::new(input.unit, input.soft, input.hard, false);
    let new = ui
        .horizontal(|ui| three(ui, target, input, (name, ["x", "y", "z"]), &scale, v, width))
        .inner;
    if let Some((v, how)) = new {
        target.set(input, v, how);
    }
}

fn colour(ui: &mut Ui, target: &mut EditTarget, input: &InputDef, name: &str, v: Vec3, width: f32) {
    let scale = Scale::new(Unit::None, Some((0.0, 1.0)), Some((0.0, 1e6)), false);
    let mut new = None;
    ui.horizontal(|ui| {
        let shown = v.to_array().map(|c| gamma_u8_from_linear_f32(c.clamp(0.0, 1.0)));
        let (picker, picked) = wheel::picker(ui, name, shown, |picked| picked, |_| None);
        if let Some((picked, how)) = picked {
            new = Some((Vec3::from(picked.map(linear_f32_from_gamma_u8)), how));
        }
        let swatch = picker.rect.width() + 3.0;
        picker.on_hover_text("Click to pick. Stored as linear Rec.709; the picker shows sRGB.");
        let parts = ["red", "green", "blue"];
        new = three(ui, target, input, (name, parts), &scale, v, width - swatch).or(new);
    });
    if let Some((v, how)) = new {
        target.set(input, v, how);
    }
}

fn choice(
    ui: &mut Ui,
    target: &mut EditTarget,
    input: &InputDef,
    name: &str,
    words: &[(&'static str, &'static str)],
    word: &str,
    width: f32,
) {
    let differ = target.differ(input);
    let tip = words.iter().find(|(known, _)| *known == word).map_or("", |(_, tip)| tip);
    let shown = if differ { "differ".to_owned() } else { choice_name(word, tip) };
    let combo = ComboBox::from_id_salt(("choice", input.name))
        .width(width)
        .truncate()
        .selected_text(shown)
        .show_ui(ui, |ui| {
            for (known, tip) in words {
                let chosen =
                    ui.selectable_label(!differ && *known == word, choice_name(known, tip));
                if chosen.on_hover_text(tip.trim()).clicked() {
                    target.set(input, *known, How::Once);
                }
            }
        });
    set_name(ui, &combo.response, name);
    combo.response.on_hover_ui(|ui| {
        ui.label(tip.trim());
        super::row::tooltip(ui, target, input, name);
    });
}

fn file(
    ui: &mut Ui,
    target: &mut EditTarget,
    input: &InputDef,
    name: &str,
    value: Option<&Value>,
    width: f32,
) {
    let path = match value {
        Some(Value::Text(path)) => path.to_string(),
        _ => String::new(),
    };
    let mut new = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let button = ui.spacing().interact_size.y;
        let hint = "a path, relative to the groom";
        new = text_field(ui, name, &path, hint, (width - button - 3.0, 1));
        if icon_button(ui, "📂", &format!("{name}: browse")).clicked()
            && let Some(node) = target.nodes.first()
        {
            let asked = documents::DocumentEvent::Find(node.clone(), input.name.to_owned());
            target.out.push(Event::Documents(asked));
        }
    });
    match new {
        Some(path) if path.trim().is_empty() => target.unset(input),
        Some(path) => target.set(input, path.trim(), How::Once),
        None => {}
    }
}

fn drawn(ui: &mut Ui, target: &mut EditTarget, input: &InputDef, name: &str, strokes: &Strokes) {
    let points: usize = strokes.0.iter().map(|stroke| stroke.samples.len()).sum();
    let count = strokes.0.len();
    let plural = if count == 1 { "" } else { "s" };
    let pinned =
        target.nodes.first().is_some_and(|node| target.state.pinned.as_ref() == Some(node));
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("{count} stroke{plural}, {}", crate::words::counted(points, "point")));
    });
    ui.horizontal(|ui| {
        let text = if pinned { "Stop drawing" } else { "Draw with the pen" };
        let draw = ui.selectable_label(pinned, text);
        set_name(ui, &draw, &format!("{name}: draw"));
        if draw.on_hover_text("Keep the pen on this node, whatever is displayed.").clicked() {
            let node = target.nodes.first().filter(|_| !pinned).cloned();
            let document = &target.state.document;
            let held = node.as_ref().and_then(|id| document.node(id.as_str()));
            if held.is_some_and(|held| held.kind == "paint_mask") {
                target.out.push(Event::Act("mask.paint"));
            }
            target.out.push(Event::Pin(node));
        }
        if clear(ui, name, "strokes", count > 0) {
            target.set(input, Strokes::default(), How::Once);
        }
    });
}

/// Whether the button that removes all items of a list was pressed.
fn clear(ui: &mut Ui, name: &str, what: &str, can: bool) -> bool {
    let clear = ui.add_enabled(can, egui::Button::new("Clear"));
    set_name(ui, &clear, &format!("{name}: clear"));
    clear.on_hover_text(format!("Remove all {what}.")).clicked()
}

/// How many gestures there are of each tool, most first: "12 gestures: 5 comb, 4 implant, 3 cut".
fn counted(gestures: &Gestures) -> String {
    let of = |tool: Tool| gestures.0.iter().filter(|gesture| gesture.tool == tool).count();
    let mut tools: Vec<(usize, &str)> =
        Tool::ALL.iter().map(|(tool, word)| (of(*tool), *word)).filter(|(n, _)| *n > 0).collect();
    // Where there are as many, in the order of the shelf: the sort is stable.
    tools.sort_by_key(|(n, _)| std::cmp::Reverse(*n));
    let count = gestures.0.len();
    let plural = if count == 1 { "" } else { "s" };
    let tools: Vec<String> = tools.iter().map(|(n, word)| format!("{n} {word}")).collect();
    match &tools[..] {
        [] => "no gestures".to_owned(),
        tools => format!("{count} gesture{plural}: {}", tools.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_graphs::text::read_value;
    use coif_nodes::data::ramp::Ramp;
    use coif_nodes::define::Type;

    #[test]
    fn gestures_are_counted_by_tool() {
        let one = |id: u64, tool: &str| {
            format!(
                "(id: {id}, tool: {tool:?}, layer: \"scalp\", eye: (0.0, 0.0, 9.0), target: (0.0, 0.0, 0.0), \
                 up: (0.0, 1.0, 0.0), half_height: 0.3, pixels: 900.0, x: [1], y: [1], pressure: [1], time: [0])"
            )
        };
        let check = |tools: &[&str], expected: &str| {
            let all: Vec<String> =
                tools.iter().enumerate().map(|(i, tool)| one(i as u64 + 1, tool)).collect();
            let value = read_value(Type::Gestures, &format!("[{}]", all.join(", "))).unwrap();
            let Value::Gestures(gestures) = value else { panic!("{value:?}") };
            assert_eq!(counted(&gestures), expected);
        };
        check(&[], "no gestures");
        check(&["pin"], "1 gesture: 1 pin");
        check(&["cut", "comb", "implant", "comb"], "4 gestures: 2 comb, 1 implant, 1 cut");
    }

    #[test]
    fn what_unset_means_is_said() {
        assert_eq!(unset_words("Diameter. Unset: the preset's."), Some("the preset's"));
        assert_eq!(unset_words("Diameter."), None);
    }

    #[test]
    fn a_zero_that_is_no_amount_is_said() {
        let check = |doc: &str, expected: Option<&str>| assert_eq!(zero_words(doc), expected);
        check("Distance of stitches. 0 takes what suits firmly braided hair.", Some("auto"));
        check("Exactly so many. 0: as density and radius ask.", Some("auto"));
        check("Hair farther than this does not count. 0: no limit.", Some("no limit"));
        check("How far tips may lie outside. 0 is the clean outline.", None);
        check("Diameter.", None);
    }

    #[test]
    fn seeds_change_and_stay_tags() {
        let mut seed = 0;
        let mut seen = std::collections::BTreeSet::new();
        for _ in 0..1000 {
            let next = next_seed(seed);
            assert!(next != seed && (1..=99_999).contains(&next));
            seen.insert(next);
            seed = next;
        }
        assert!(seen.len() > 100);
    }

    #[test]
    fn ramps_without_a_range_show_a_useful_one() {
        for input in coif_nodes::all().flat_map(|def| def.inputs) {
            if input.ty == Type::Ramp {
                let (lo, hi) = ramp_scale(input).slider.unwrap();
                let Some(Value::Ramp(ramp)) = super::super::target::default_of(input) else {
                    panic!("{}", input.name)
                };
                let within = |ramp: &Ramp| {
                    ramp.stops().iter().all(|(_, y)| (lo..=hi).contains(&f64::from(*y)))
                };
                assert!(within(&ramp), "{}", input.name);
            }
        }
    }
}
