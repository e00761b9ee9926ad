//! Numbers that may vary over the hair: where they come from, and what they are there.

use super::number::Scale;
use super::ramp::RampField;
use super::slider::{Done, NumberField};
use super::target::How;
use crate::widgets::panel;
use crate::widgets::text::{icon_button, set_name, text_field};
use coif_graphs::document::Socket;
use coif_graphs::values::DEEPEST_FIELD;
use coif_nodes::data::field::Field;
use coif_nodes::data::ramp::{Blend, Ramp};
use coif_nodes::maths::smoothstep;
use egui::{
    Align2, Color32, ComboBox, Popup, Rect, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo,
    WidgetType, vec2,
};

/// The names that there are to choose from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FieldNames {
    /// Attributes that are numbers.
    pub(crate) attributes: Vec<String>,
    /// Masks of the heads.
    pub(crate) masks: Vec<String>,
}

/// A field's editor.
pub(crate) struct FieldEditor<'a> {
    /// What it is called for those who cannot see it.
    pub(crate) name: &'a str,
    /// Unit and range of its numbers.
    pub(crate) scale: &'a Scale,
    /// Names to choose from.
    pub(crate) names: &'a FieldNames,
}

/// Where somebody lets a number come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NumberSource {
    /// A field, as the value of the input.
    Field(Field),
    /// A wire from an output.
    Wire(Socket),
}

/// Where a number can come from, in the menu's order: name and explanation.
const SOURCES: [(&str, &str); 5] = [
    ("Number", "The same everywhere."),
    ("Ramp", "Varies from root to tip of each curve."),
    ("Attribute", "An attribute of the curves, such as radius."),
    ("Mask", "A painted or drawn mask of the head, read at each root."),
    ("Product", "A product of these, such as a ramp times a mask."),
];

fn source(field: &Field) -> usize {
    match field {
        Field::Constant(_) => 0,
        Field::Ramp(_) => 1,
        Field::Attribute(_) => 2,
        // (What is painted comes by wire alone.)
        Field::Mask(_) | Field::Painted(_) | Field::Texture(_) => 3,
        Field::Product(_) => 4,
    }
}

impl FieldEditor<'_> {
    /// `field` from another source, keeping what the other can say.
    pub(crate) fn switched(&self, field: &Field, to: usize) -> Field {
        let typical = match field {
            Field::Constant(x) => *x,
            Field::Ramp(ramp) => ramp.at(0.0),
            Field::Product(parts) => {
                let numbers = parts.iter().filter_map(Field::constant);
                numbers.product()
            }
            _ => self.typical(),
        };
        let name = |known: &[String]| match field {
            Field::Attribute(name) | Field::Mask(name) if known.contains(name) => name.clone(),
            _ => known.first().cloned().unwrap_or_default(),
        };
        // What a product holds of the wanted kind is what is meant.
        if let Field::Product(parts) = field
            && let Some(part) = parts.iter().find(|part| source(part) == to)
        {
            return part.clone();
        }
        match to {
            0 => Field::Constant(typical),
            1 => Field::Ramp(even(typical)),
            2 => Field::Attribute(name(&self.names.attributes)),
            3 => Field::Mask(name(&self.names.masks)),
            _ => Field::Product(vec![field.clone(), Field::Constant(1.0)]),
        }
    }

    /// A number of the usual size.
    fn typical(&self) -> f32 {
        let (lo, hi) = self.scale.slider.unwrap_or((1.0, 1.0));
        1f32.max(lo as f32).min(hi as f32)
    }

    /// The button that says where the number comes from, and switches it: to a field, or to one of these outputs.
    pub(crate) fn source_menu(
        &self,
        ui: &mut Ui,
        field: &Field,
        painted: &[(Socket, String)],
    ) -> Option<NumberSource> {
        let at = source(field);
        let mut new = None;
        let size = Vec2::splat(ui.spacing().interact_size.y);
        // Pressed, not focused: Tab goes from value to value.
        let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK);
        let visuals = ui.style().interact(&response);
        ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
        sign(ui, rect, at, visuals.text_color());
        let name = format!("{} source", self.name);
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), &name));
        Popup::menu(&response).show(|ui| {
            panel::list(ui, |ui| {
                for (to, (label, tip)) in SOURCES.iter().enumerate() {
                    let can = to != 3 || at == 3 || !self.names.masks.is_empty();
                    let chosen =
                        ui.add_enabled_ui(can, |ui| ui.selectable_label(at == to, *label)).inner;
                    let chosen = chosen.on_hover_text(*tip);
                    let none = "The head has no masks. M paints one, which is listed here.";
                    if chosen.on_disabled_hover_text(none).clicked() {
                        new = (to != at).then(|| NumberSource::Field(self.switched(field, to)));
                        ui.close();
                    }
                    for (socket, name) in painted.iter().filter(|_| to == 3) {
                        let chosen = ui.button(format!("Mask: {name}"));
                        if chosen.on_hover_text("Wire this mask to the input.").clicked() {
                            new = Some(NumberSource::Wire(socket.clone()));
                            ui.close();
                        }
                    }
                }
            })
        });
        response.on_hover_text(format!("{}: {} Click to switch.", SOURCES[at].0, SOURCES[at].1));
        new
    }

    /// Shows what the field says and gives the field it becomes. Constants at the top are shown by the caller, who
    /// can edit several nodes by what was typed.
    pub(crate) fn show(&self, ui: &mut Ui, field: &Field, width: f32) -> Option<(Field, How)> {
        self.shown(ui, field, width, 1)
    }

    fn shown(&self, ui: &mut Ui, field: &Field, width: f32, depth: usize) -> Option<(Field, How)> {
        match field {
            Field::Constant(x) => {
                let x = f64::from(*x);
                let (name, scale) = (self.name, self.scale);
                let field = NumberField { name, value: Some(x), instead: None, unset: None, scale };
                let (to, how) = match field.show(ui, width).1? {
                    Done::Dragged(to) => (to, How::Drag),
                    Done::Typed(entry) => (self.scale.clamp(entry.apply(x)).0, How::Once),
                    Done::Nudged(by) => (self.scale.clamp(x + by).0, How::Nudge),
                    Done::Refused(_) | Done::Reset => return None,
                };
                Some((Field::Constant(to as f32), how))
            }
            Field::Ramp(ramp) => {
                let editor = RampField { name: self.name, scale: self.scale };
                let (ramp, how) = editor.show(ui, ramp, width)?;
                Some((Field::Ramp(ramp), how))
            }
            Field::Attribute(name) => {
                let new = self.name_field(ui, "attribute", name, &self.names.attributes, width)?;
                Some((Field::Attribute(new), How::Once))
            }
            Field::Mask(name) => {
                let new = self.name_field(ui, "mask", name, &self.names.masks, width)?;
                Some((Field::Mask(new), How::Once))
            }
            Field::Painted(_) | Field::Texture(_) => None,
            Field::Product(parts) => self.product(ui, parts, width, depth),
        }
    }

    /// A name, typed or chosen from those there are.
    fn name_field(
        &self,
        ui: &mut Ui,
        what: &str,
        name: &str,
        known: &[String],
        width: f32,
    ) -> Option<String> {
        let mut new = None;
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let button = ui.spacing().interact_size.y;
            let label = format!("{} {what}", self.name);
            new = text_field(ui, &label, name, &format!("{what} name"), (width - button - 2.0, 1));
            let combo = ComboBox::from_id_salt((what, self.name))
                .width(button)
                .selected_text("")
                .show_ui(ui, |ui| {
                    if known.is_empty() {
                        ui.weak("None is known yet.");
                    }
                    for it in known {
                        if ui.selectable_label(it == name, it).clicked() {
                            new = Some(it.clone());
                        }
                    }
                });
            set_name(ui, &combo.response, &format!("{label}: choose"));
        });
        new.filter(|new| !new.is_empty())
    }

    fn product(
        &self,
        ui: &mut Ui,
        parts: &[Field],
        width: f32,
        depth: usize,
    ) -> Option<(Field, How)> {
        let mut new = None;
        let button = ui.spacing().interact_size.y;
        let factor = Scale::new(coif_nodes::define::Unit::None, Some((0.0, 2.0)), None, false);
        ui.vertical(|ui| {
            for (i, part) in parts.iter().enumerate() {
                let name = format!("{} factor {}", self.name, i + 1);
                // The first factor has the input's unit, the others count how often.
                let scale = if i == 0 { self.scale } else { &factor };
                let editor = FieldEditor { name: &name, scale, names: self.names };
                ui.push_id(i, |ui| {
                    ui.horizontal_top(|ui| {
                        ui.spacing_mut().item_spacing.x = 2.0;
                        let inner = (width - 2.0 * button - 6.0).max(60.0);
                        if let Some((part, how)) = editor.shown(ui, part, inner, depth + 1) {
                            new = Some((with(parts, i, Some(part)), how));
                        }
                        if let Some(NumberSource::Field(part)) = editor.source_menu(ui, part, &[])
                            && depth + 1 < DEEPEST_FIELD
                        {
                            new = Some((with(parts, i, Some(part)), How::Once));
                        }
                        if icon_button(ui, "✖", &format!("{name}: remove")).clicked() {
                            new = Some((with(parts, i, None), How::Once));
                        }
                    });
                });
            }
            let add = ui.button("Add a factor").on_hover_text("Multiply by another factor.");
            set_name(ui, &add, &format!("{}: add a factor", self.name));
            if add.clicked() {
                let more = [parts, &[Field::Constant(1.0)]].concat();
                new = Some((Field::Product(more), How::Once));
            }
        });
        new
    }
}

/// The factors with the `i`th changed or gone; one alone is no product.
fn with(parts: &[Field], i: usize, part: Option<Field>) -> Field {
    let mut parts = parts.to_vec();
    parts.splice(i..=i, part);
    match parts.len() {
        0 => Field::Constant(1.0),
        1 => parts.remove(0),
        _ => Field::Product(parts),
    }
}

/// The sign of a source.
fn sign(ui: &Ui, rect: Rect, source: usize, colour: Color32) {
    let (painter, centre) = (ui.painter(), rect.center());
    let font = TextStyle::Body.resolve(ui.style());
    let letter = |text: &str| {
        painter.text(centre, Align2::CENTER_CENTER, text, font.clone(), colour);
    };
    match source {
        0 => letter("1"),
        1 => {
            let at = |x: f32| {
                let y = smoothstep(x);
                centre + vec2(12.0 * x - 6.0, 5.0 - 10.0 * y)
            };
            let line = (0..=8).map(|i| at(i as f32 / 8.0)).collect();
            painter.add(Shape::line(line, Stroke::new(1.6, colour)));
        }
        2 => letter("A"),
        3 => {
            painter.circle_stroke(centre, 5.5, Stroke::new(1.4, colour));
            let half = rect.with_max_x(centre.x);
            painter.with_clip_rect(half).circle_filled(centre, 5.5, colour);
        }
        _ => letter("×"),
    }
}

/// A ramp that is `x` from root to tip, with a handle at either end.
fn even(x: f32) -> Ramp {
    Ramp::new(Blend::Linear, vec![(0.0, x), (1.0, x)]).unwrap_or_else(|_| Ramp::constant(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::define::Unit;

    #[test]
    fn switching_the_source_keeps_what_the_other_can_say() {
        let scale = Scale::new(Unit::Length, Some((0.0, 4.0)), None, false);
        let known = FieldNames { attributes: vec!["radius".into()], masks: vec!["fringe".into()] };
        let editor = FieldEditor { name: "x", scale: &scale, names: &known };
        let number = Field::Constant(2.5);
        let ramp = editor.switched(&number, 1);
        assert_eq!(ramp, Field::Ramp(even(2.5)));
        assert_eq!(editor.switched(&ramp, 0), number);
        assert_eq!(editor.switched(&number, 2), Field::Attribute("radius".into()));
        assert_eq!(editor.switched(&number, 3), Field::Mask("fringe".into()));
        let product = editor.switched(&Field::Mask("fringe".into()), 4);
        assert_eq!(editor.switched(&product, 3), Field::Mask("fringe".into()));
        assert_eq!(editor.switched(&product, 0), Field::Constant(1.0));
        assert_eq!(editor.switched(&Field::Attribute("radius".into()), 0), Field::Constant(1.0));
        let nothing = FieldNames::default();
        let editor = FieldEditor { names: &nothing, ..editor };
        assert_eq!(editor.switched(&number, 2), Field::Attribute(String::new()));
    }

    #[test]
    fn a_product_of_one_is_that_one() {
        let parts = [Field::Constant(2.0), Field::Mask("m".into())];
        assert_eq!(with(&parts, 0, None), Field::Mask("m".into()));
        assert_eq!(with(&parts[..1], 0, None), Field::Constant(1.0));
        let changed = with(&parts, 0, Some(Field::Constant(3.0)));
        assert_eq!(changed, Field::Product(vec![Field::Constant(3.0), parts[1].clone()]));
    }
}
