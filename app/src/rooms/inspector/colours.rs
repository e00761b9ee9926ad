//! Colour as people pick it, over the pigment of *Hair colour*: hair's own colours by name, and root and tip by a wheel or as
//! hex. What is picked becomes the pigment that comes nearest; the numbers below say which.
//!
//! Pure but for [`show`]. A colour that hair cannot have becomes the nearest that it can, which is said: for others there is
//! the dye.

use super::target::{EditTarget, How, InputSetting};
use super::wheel;
use crate::widgets::text::text_field;
use crate::widgets::theme;
use coif_graphs::document::Setting;
use coif_nodes::define::{InputDef, NodeDef, Value};
use coif_nodes::maths::hair_colour::{absorption_of_melanin, colour_of};
use egui::{Color32, Mesh, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, pos2};
use glam::Vec3;

/// Hair's own colours: pigment at the root and at the tip, and how much of it is red.
const NATURAL: &[(&str, f32, f32, f32)] = &[
    ("Black", 0.97, 0.95, 0.05),
    ("Dark brown", 0.9, 0.87, 0.1),
    ("Brown", 0.8, 0.75, 0.12),
    ("Light brown", 0.65, 0.58, 0.15),
    ("Auburn", 0.75, 0.7, 0.55),
    ("Copper", 0.45, 0.38, 0.85),
    ("Ginger", 0.34, 0.28, 1.0),
    ("Dark blond", 0.45, 0.38, 0.15),
    ("Blond", 0.3, 0.24, 0.12),
    ("Light blond", 0.17, 0.12, 0.08),
    ("White", 0.02, 0.02, 0.0),
];

/// The colour of pigment, linear Rec.709.
fn of_pigment(melanin: f32, redness: f32) -> Vec3 {
    colour_of(absorption_of_melanin(melanin, redness))
}

/// As the screen shows it.
fn shown(colour: Vec3) -> [u8; 3] {
    colour.to_array().map(|c| egui::ecolor::gamma_u8_from_linear_f32(c.clamp(0.0, 1.0)))
}

/// How far the colour of a pigment is off on the screen: squares of 255ths of the channels, summed.
fn off((melanin, redness): (f32, f32), wanted: [u8; 3]) -> i32 {
    let got = shown(of_pigment(melanin, redness));
    got.iter().zip(wanted).map(|(a, b)| (i32::from(*a) - i32::from(b)).pow(2)).sum()
}

/// The pigment of these rednesses whose colour on the screen comes nearest: melanin and redness.
fn nearest(wanted: [u8; 3], rednesses: impl Iterator<Item = f32>) -> (f32, f32) {
    let all = rednesses.flat_map(|r| (0..=100u8).map(move |m| (f32::from(m) / 100.0, r)));
    all.min_by_key(|it| off(*it, wanted)).unwrap_or((0.9, 0.1))
}

/// The melanin and redness that a colour becomes, beside this redness.
fn pigment(wanted: [u8; 3], red: f32) -> (f32, f32) {
    let best = nearest(wanted, (0..=20u8).map(|r| f32::from(r) / 20.0));
    // Root and tip share what is red: a colour that it gives as well does not change it, or dark roots would take the copper out
    // of the tips.
    let same = nearest(wanted, std::iter::once(red));
    if off(same, wanted) <= off(best, wanted) + SAME { same } else { best }
}

/// A colour this much farther off is as good, as [`off`] counts.
const SAME: i32 = 3 * 4 * 4;

/// As far as this a colour of pigment is taken for the one that was picked: in 255ths of a channel.
const ALIKE: u8 = 20;

/// What is said where no pigment gives a colour, or nearly.
fn told(wanted: [u8; 3], red: f32) -> Option<String> {
    let (melanin, redness) = pigment(wanted, red);
    let got = shown(of_pigment(melanin, redness));
    let off = got.iter().zip(wanted).map(|(a, b)| a.abs_diff(b)).max();
    (off > Some(ALIKE)).then(|| {
        let percent = |x: f32| (100.0 * x).round();
        format!(
            "no natural hair is {}: melanin {} %, redness {} % comes nearest; Dye gives other colours",
            hex(wanted),
            percent(melanin),
            percent(redness)
        )
    })
}

/// Reads "#7a3b1e" or "7a3b1e".
fn read_hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.trim().trim_start_matches('#');
    // (Parsing numbers takes signs, too.)
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let part = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
    Some([part(0)?, part(2)?, part(4)?])
}

fn hex(colour: [u8; 3]) -> String {
    format!("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2])
}

/// Whether colours stand over the inputs that this one is among.
pub(super) fn stand_before(input: &InputDef) -> bool {
    input.name == ROOT
}

/// The first of the three numbers that a colour is.
const ROOT: &str = "melanin_root";

/// Shows it for a node whose colour is pigment; nothing for others.
pub(super) fn show(ui: &mut Ui, target: &mut EditTarget, def: &'static NodeDef, width: f32) {
    let input = |name: &str| def.input(name).map(|(_, input)| input);
    let (Some(root), Some(tip), Some(red)) = (input(ROOT), input("melanin_tip"), input("redness"))
    else {
        return;
    };
    let number = |target: &EditTarget, input: &InputDef| match target.held(input) {
        InputSetting::Value(Value::Float(x)) => x,
        _ => 0.0,
    };
    let now = [root, tip, red].map(|input| number(target, input));
    let counts = target.idle(root).is_none();
    let mut new = None;
    let mut said = [None, None];
    ui.add_enabled_ui(counts, |ui| {
        ui.set_max_width(width);
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = Vec2::splat(3.0);
            for (name, root, tip, red) in NATURAL {
                let is = [*root, *tip, *red] == now;
                let ends = [*root, *tip].map(|melanin| shown(of_pigment(melanin, *red)));
                if swatch(ui, name, ends, is) {
                    new = Some(([*root, *tip, *red], How::Once));
                }
            }
        });
        for (end, name) in [(0, "Root colour"), (1, "Tip colour")] {
            ui.horizontal(|ui| {
                let colour = shown(of_pigment(now[end], now[2]));
                let becomes = |wanted| {
                    let (melanin, redness) = pigment(wanted, now[2]);
                    shown(of_pigment(melanin, redness))
                };
                let (button, mut picked) =
                    wheel::picker(ui, name, colour, becomes, |wanted| told(wanted, now[2]));
                button.on_hover_text("Set the nearest natural pigment.");
                ui.label(name);
                let rest = ui.available_width().min(90.0);
                let typed =
                    text_field(ui, &format!("{name} as hex"), &hex(colour), "hex", (rest, 1));
                let mut words = None;
                if let Some(text) = typed {
                    match read_hex(&text) {
                        Some(typed) => {
                            picked = Some((typed, How::Once));
                            // Who types a colour sees another in the field then, and hears why.
                            let other = Some(becomes(typed)).filter(|other| *other != typed);
                            words = other.map(|other| {
                                let [typed, other] = [typed, other].map(hex);
                                format!("{typed} became {other}, the nearest colour that pigment gives")
                            });
                        }
                        None => {
                            said[end] = Some(Some(format!(
                                "\u{201C}{text}\u{201D} is no colour: write six digits from 0 to 9 and a to f, such as #7a3b1e"
                            )));
                        }
                    }
                }
                if let Some((wanted, how)) = picked {
                    let (melanin, redness) = pigment(wanted, now[2]);
                    let mut to = now;
                    (to[end], to[2]) = (melanin, redness);
                    new = Some((to, how));
                    said[end] = Some(told(wanted, now[2]).or(words));
                }
            });
        }
    });
    for (input, said) in [root, tip].into_iter().zip(said) {
        match said {
            Some(Some(text)) => {
                target.said.insert(input.name, text);
            }
            None if new.is_none() => {}
            _ => {
                target.said.remove(input.name);
            }
        }
    }
    let Some((to, how)) = new else { return };
    let mut edits = vec![];
    for node in target.nodes {
        for (input, x) in [root, tip, red].into_iter().zip(to) {
            edits.push(target.set_edit(node, input, Setting::Known(Value::Float(x))));
        }
    }
    target.say(edits, how);
}

/// A colour from root to tip with its name, to press on.
fn swatch(ui: &mut Ui, name: &str, [root, tip]: [[u8; 3]; 2], chosen: bool) -> bool {
    let font = egui::FontId::proportional(11.5);
    // Dark letters on light hair, light ones on dark.
    let light =
        root.iter().zip(tip).map(|(a, b)| u32::from(*a) + u32::from(b)).sum::<u32>() > 6 * 110;
    let ink = if light { Color32::BLACK } else { Color32::WHITE };
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, ink);
    let size = Vec2::new(text.size().x + 14.0, ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::WidgetType::SelectableLabel, true, chosen, name)
    });
    let inner = rect.shrink(2.0);
    let [root, tip] = [root, tip].map(|[r, g, b]| Color32::from_rgb(r, g, b));
    let mut mesh = Mesh::default();
    let Rect { min, max } = inner;
    for (at, colour) in
        [(min, root), (pos2(max.x, min.y), tip), (max, tip), (pos2(min.x, max.y), root)]
    {
        mesh.colored_vertex(at, colour);
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(0, 2, 3);
    ui.painter().add(Shape::mesh(mesh));
    let at = inner.center() - 0.5 * text.size();
    ui.painter().galley(at, text, ink);
    let line = match (chosen, response.hovered()) {
        (true, _) => Stroke::new(2.0, theme::ACCENT.of(ui)),
        (_, true) => Stroke::new(1.0, theme::STRONG.of(ui)),
        _ => Stroke::new(1.0, theme::LINE.of(ui)),
    };
    ui.painter().rect_stroke(rect.shrink(1.0), 2.0, line, StrokeKind::Inside);
    response.on_hover_text(name).clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_picked_becomes_the_pigment_that_comes_nearest() {
        for (name, root, _, red) in NATURAL {
            let colour = shown(of_pigment(*root, *red));
            let (melanin, redness) = pigment(colour, 0.5);
            let back = shown(of_pigment(melanin, redness));
            let off = back.iter().zip(colour).map(|(a, b)| a.abs_diff(b)).max();
            assert!(off <= Some(7), "{name}: {colour:?} became {back:?}");
        }
        assert_eq!(read_hex(" #7a3B1e"), Some([0x7a, 0x3b, 0x1e]));
        for bad in ["", "#7a3b1", "7a3b1ef", "zzzzzz", "ééé", "#+1+2+3", "-1-2-3", "##", "#"] {
            assert_eq!(read_hex(bad), None, "{bad}");
        }
        assert_eq!(hex([0x7a, 0x3b, 0x1e]), "#7a3b1e");
        // No hair is blue: the nearest is some hair's colour, and that is said.
        let (melanin, redness) = pigment([0, 0, 255], 0.5);
        assert!((0.0..=1.0).contains(&melanin) && (0.0..=1.0).contains(&redness));
        assert!(told([0, 0, 255], 0.1).is_some_and(|text| text.contains("#0000ff")));
        assert_eq!(told(shown(of_pigment(0.55, 0.8)), 0.1), None);
    }
}
