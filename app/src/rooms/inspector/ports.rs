//! The ports of a group, and the parameters of the graph: named, ordered, ranged and explained; and the menu of an input that
//! makes it one, or lets it read one.
//!
//! A port's type is what it was made for and does not change. What is wired and set goes with a port that is renamed; with
//! one that is removed it goes too.

use super::target::EditTarget;
use crate::core::event::Event;
use crate::core::notes::Note;
use crate::core::state::State;
use crate::widgets::text::{icon_button, spoken, text_field};
use coif_graphs::document::{Node, NodeId, Socket, groups};
use coif_nodes::declared::{self, Interface, Port};
use coif_nodes::define::{InputDef, Type, Unit};
use egui::{DragValue, Ui};
use std::collections::BTreeMap;

/// What can be added by hand, besides what inputs are made into.
const KINDS: [(&str, Type); 9] = [
    ("Curves", Type::Curves),
    ("Scalp", Type::Scalp),
    ("Strokes", Type::Strokes),
    ("Gestures", Type::Gestures),
    ("Number", Type::Float),
    ("Whole number", Type::Int),
    ("Field", Type::Field),
    ("Colour", Type::Colour),
    ("On or off", Type::Bool),
];

const UNITS: [(&str, Unit); 8] = [
    ("none", Unit::None),
    ("percent", Unit::Ratio),
    ("cm", Unit::Length),
    ("degrees", Unit::Angle),
    ("count", Unit::Count),
    ("per cm", Unit::PerCm),
    ("per cm2", Unit::PerCm2),
    ("degrees per cm", Unit::AnglePerCm),
];

/// What was done to the ports of one side.
#[derive(Default)]
struct Done {
    change: Option<(usize, Port)>,
    remove: Option<usize>,
    /// Before which one it goes.
    raise: Option<usize>,
    add: Option<Type>,
}

/// The ports of a group or of parameters.
pub(super) fn show(state: &State, ui: &mut Ui, id: &NodeId, node: &Node, out: &mut Vec<Event>) {
    let interface = node.interface.unwrap_or_default();
    ui.separator();
    let is_group = node.is_group();
    let title = if is_group { "Inputs and outputs" } else { "Parameters" };
    egui::CollapsingHeader::new(title).id_salt("ports").show(ui, |ui| {
        let mut sides = vec![(true, interface.inputs())];
        if is_group {
            sides.push((false, interface.outputs()));
        }
        for (is_input, ports) in sides {
            let name = match (is_group, is_input) {
                (true, true) => "input",
                (true, false) => "output",
                (false, _) => "parameter",
            };
            let mut done = Done::default();
            for (at, port) in ports.iter().enumerate() {
                ui.push_id((is_input, at), |ui| one(ui, at, port, is_input, &mut done));
            }
            add(ui, name, is_group, &mut done);
            if let Some(edit) = changed(state, id, interface, is_input, done) {
                match edit {
                    Ok(edit) => out.push(Event::Edit(edit)),
                    Err(why) => out.push(Event::Say(Note::warning(why).of(id.clone()))),
                }
            }
        }
    });
}

fn add(ui: &mut Ui, name: &str, is_group: bool, done: &mut Done) {
    ui.menu_button(format!("Add {name}"), |ui| {
        for (label, ty) in KINDS {
            let by_wire = matches!(ty, Type::Curves | Type::Scalp);
            if (is_group || !by_wire) && ui.button(label).clicked() {
                done.add = Some(ty);
                ui.close();
            }
        }
    });
}

/// One port: a line with its name, and what is said of it where it is open.
fn one(ui: &mut Ui, at: usize, port: &Port, is_input: bool, done: &mut Done) {
    let name = spoken(&port.name);
    let mut new = port.clone();
    let mut finished = false;
    let header = egui::CollapsingHeader::new(format!("{name}  \u{B7}  {}", word(port.ty)));
    header.id_salt("port").show(ui, |ui| {
        ui.horizontal(|ui| {
            finished |= line(ui, "Name", &mut new.name, port.name.len().max(8));
            if icon_button(ui, "\u{23F6}", &format!("{name}: move up")).clicked() {
                done.raise = Some(at);
            }
            if icon_button(ui, "\u{2716}", &format!("{name}: remove")).clicked() {
                done.remove = Some(at);
            }
        });
        finished |= line(ui, "Explanation", &mut new.doc, 28);
        if !is_input {
            return;
        }
        finished |= line(ui, "Heading", &mut new.section, 20);
        if matches!(port.ty, Type::Int | Type::Float | Type::Field | Type::Ramp) {
            finished |= range(ui, "Range", &mut new.hard);
            finished |= range(ui, "Slider", &mut new.soft);
            let unit =
                UNITS.iter().find(|(_, unit)| *unit == port.unit).map_or("", |(name, _)| name);
            egui::ComboBox::from_label("Unit").selected_text(unit).show_ui(ui, |ui| {
                for (name, unit) in UNITS {
                    finished |= ui.selectable_value(&mut new.unit, unit, name).changed();
                }
            });
        }
    });
    if finished {
        done.change = Some((at, new));
    }
}

/// A field of text; whether it was left with another text.
fn line(ui: &mut Ui, label: &str, text: &mut String, letters: usize) -> bool {
    let width = letters.min(40) as f32 * 8.0;
    let typed = text_field(ui, label, text, label, (width, 1));
    let changed = typed.is_some();
    if let Some(typed) = typed {
        *text = typed;
    }
    changed
}

/// Two numbers, or none; whether they changed.
fn range(ui: &mut Ui, label: &str, range: &mut Option<(f64, f64)>) -> bool {
    let mut changed = false;
    ui.horizontal(|ui| {
        let mut is_set = range.is_some();
        if ui.checkbox(&mut is_set, label).changed() {
            *range = is_set.then_some((0.0, 1.0));
            changed = true;
        }
        if let Some((lo, hi)) = range {
            for end in [lo, hi] {
                let number = ui.add(DragValue::new(end).speed(0.05).update_while_editing(false));
                changed |= number.drag_stopped() || (number.changed() && !number.dragged());
            }
        }
    });
    changed
}

fn word(ty: Type) -> &'static str {
    KINDS.iter().find(|(_, known)| *known == ty).map_or(ty.name(), |(word, _)| word)
}

/// A name as documents have them: what was typed, in lower case, with underscores.
fn stored(name: &str) -> String {
    let letters = name.trim().to_lowercase();
    let letters = letters.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
    letters.take(declared::LONGEST_NAME).collect()
}

type Changed = Result<coif_graphs::document::edit::Edit, String>;

/// The edit of what was done to one side.
fn changed(
    state: &State,
    id: &NodeId,
    interface: Interface,
    is_input: bool,
    done: Done,
) -> Option<Changed> {
    let side = if is_input { interface.inputs() } else { interface.outputs() };
    let mut ports = side.to_vec();
    let mut names = BTreeMap::new();
    match done {
        Done { change: Some((at, mut new)), .. } => {
            new.name = stored(&new.name);
            names.insert(ports[at].name.clone(), new.name.clone());
            ports[at] = new;
        }
        Done { remove: Some(at), .. } => drop(ports.remove(at)),
        Done { raise: Some(at), .. } if at > 0 => ports.swap(at - 1, at),
        Done { add: Some(ty), .. } => {
            let stem = stored(word(ty));
            let mut numbers =
                (1..).map(|n| if n == 1 { stem.clone() } else { format!("{stem}_{n}") });
            let free = numbers.find(|name| !ports.iter().any(|port| port.name == *name))?;
            ports.push(Port::new(&free, ty));
        }
        Done { .. } => return None,
    }
    let other = if is_input { interface.outputs() } else { interface.inputs() }.to_vec();
    let (inputs, outputs) = if is_input { (ports, other) } else { (other, ports) };
    match Interface::new(inputs, outputs) {
        Ok(new) => groups::set_interface(&state.document, id, new, &names).map(Ok),
        Err(why) => Some(Err(why.to_string())),
    }
}

/// Entries of an input's menu: make a port of it, or let it read one.
pub(super) fn menu(ui: &mut Ui, target: &mut EditTarget, input: &'static InputDef) {
    let [node] = target.nodes else { return };
    let document = &target.state.document;
    let socket = Socket::new(node.clone(), input.name);
    if matches!(input.ty, Type::Curves | Type::Scalp) || document.links.contains_key(&socket) {
        return;
    }
    let is_parameter = document.node(node.as_str()).is_some_and(|n| n.kind == declared::PARAMETERS);
    if is_parameter {
        return;
    }
    let (label, tip) = match node.group() {
        Some(_) => {
            ("Make it an input of the group", "The group has this value then; here it is read.")
        }
        None => (
            "Make it a parameter of the graph",
            "The value gets a name under Parameters, which other inputs can read and --set can set.",
        ),
    };
    if ui.button(label).on_hover_text(tip).clicked() {
        target.out.push(match groups::expose(document, &socket) {
            Ok((edit, _)) => Event::Edit(edit),
            Err(why) => Event::Say(Note::warning(why)),
        });
        ui.close();
    }
    let holder = match node.group() {
        Some(group) => document.node(group.as_str()),
        None => {
            let mut all = document.nodes.iter();
            let found = all.find(|(id, n)| n.kind == declared::PARAMETERS && id.group().is_none());
            found.map(|(_, node)| &**node)
        }
    };
    let ports = holder.map_or(&[][..], |node| node.interface.unwrap_or_default().inputs());
    for port in ports.iter().filter(|port| port.ty.fits(input.ty)) {
        if ui.button(format!("Read \u{201C}{}\u{201D}", spoken(&port.name))).clicked() {
            target.out.push(match groups::read_port(document, &socket, &port.name) {
                Ok(edit) => Event::Edit(edit),
                Err(why) => Event::Say(Note::warning(why)),
            });
            ui.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_ports_are_stored_as_documents_have_them() {
        for (typed, kept) in
            [("Hair length", "hair_length"), (" Größe ", "gr__e"), ("seed2", "seed2")]
        {
            assert_eq!(stored(typed), kept);
        }
    }
}
