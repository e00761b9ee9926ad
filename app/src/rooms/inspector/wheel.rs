//! The picker of a colour: a button that opens a wheel of hue and saturation, with how light it is below.
//!
//! Guarantees: hue and saturation stay where they were picked while the colour is black or grey, which have none, and where
//! what is picked becomes another colour; any colour can be picked with keys alone.

use super::target::How;
use crate::widgets::keyboard::keep_arrows;
use crate::widgets::panel;
use crate::widgets::text::set_name;
use crate::widgets::theme;
use egui::ecolor::Hsva;
use egui::{
    Color32, Key, Mesh, Popup, PopupCloseBehavior, Pos2, Response, Sense, Shape, Slider, Stroke,
    StrokeKind, Ui, Vec2, vec2,
};
use std::f32::consts::TAU;

/// The wheel's radius, points.
const RADIUS: f32 = 74.0;
/// What an arrow key moves hue and saturation by.
const STEP: f32 = 1.0 / 72.0;

/// A colour as the screen shows it.
pub(super) type Srgb = [u8; 3];

/// Shows the button of a colour that is picked, and the wheel where it is open; gives what is picked there. `becomes` is what
/// a colour is made into by whoever asks, `told` what there is to say of it.
pub(super) fn picker(
    ui: &mut Ui,
    name: &str,
    colour: Srgb,
    becomes: impl Fn(Srgb) -> Srgb,
    told: impl Fn(Srgb) -> Option<String>,
) -> (Response, Option<(Srgb, How)>) {
    let button = button(ui, name, colour);
    let kept = button.id.with("picked");
    let found = ui.data(|data| data.get_temp::<Hsva>(kept));
    // Something else may have changed the colour meanwhile.
    let mut hsva = found
        .filter(|hsva| becomes(hsva.to_srgb()) == colour || hsva.to_srgb() == colour)
        .unwrap_or_else(|| Hsva::from_srgb(colour));
    let before = hsva;
    let mut how = How::Once;
    let open = Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    // Where there is no room below it is moved up; turned up it would cover the menu bar.
    let open = open.align_alternatives(&[]);
    open.show(|ui| {
        panel::list(ui, |ui| {
            ui.set_width(2.0 * RADIUS);
            how = wheel(ui, name, &mut hsva);
            let slider = Slider::new(&mut hsva.v, 0.0..=1.0).text("Lightness");
            ui.spacing_mut().slider_width = (2.0 * RADIUS - 110.0).max(20.0);
            let slider = ui.add(slider);
            set_name(ui, &slider, &format!("{name}: lightness"));
            if slider.changed() {
                how = How::of(ui);
            }
            // It has its room whether there is anything to say or not.
            ui.allocate_ui(vec2(2.0 * RADIUS, 48.0), |ui| {
                ui.set_min_height(48.0);
                match told(hsva.to_srgb()) {
                    Some(text) => {
                        ui.add(egui::Label::new(egui::RichText::new(text).small()).wrap())
                    }
                    None => ui.weak(""),
                }
            });
        })
    });
    if hsva == before {
        return (button, None);
    }
    ui.data_mut(|data| data.insert_temp(kept, hsva));
    (button, Some((hsva.to_srgb(), how)))
}

fn button(ui: &mut Ui, name: &str, colour: Srgb) -> Response {
    let size = vec2(30.0, ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ColorButton, true, name));
    let line = match response.hovered() || response.has_focus() {
        true => Stroke::new(1.0, theme::STRONG.of(ui)),
        false => Stroke::new(1.0, theme::LINE.of(ui)),
    };
    let [r, g, b] = colour;
    ui.painter().rect(rect.shrink(2.0), 2.0, Color32::from_rgb(r, g, b), line, StrokeKind::Outside);
    response
}

/// Hue around, saturation outwards.
fn wheel(ui: &mut Ui, name: &str, hsva: &mut Hsva) -> How {
    let sense = Sense::click_and_drag();
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(2.0 * RADIUS), sense);
    let name = format!("{name}: hue and saturation");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Slider, true, &name));
    let mut how = How::Once;
    let middle = rect.center();
    if let Some(at) = response.interact_pointer_pos() {
        (hsva.h, hsva.s) = hue_and_saturation(at - middle, hsva.h);
        how = How::of(ui);
    }
    if response.has_focus() {
        keep_arrows(ui, response.id);
        let pressed = |key| ui.input(|input| input.num_presses(key)) as f32 * STEP;
        hsva.h = (hsva.h + pressed(Key::ArrowRight) - pressed(Key::ArrowLeft)).rem_euclid(1.0);
        hsva.s = (hsva.s + pressed(Key::ArrowUp) - pressed(Key::ArrowDown)).clamp(0.0, 1.0);
    }
    let painter = ui.painter();
    painter.add(Shape::mesh(disc(middle, hsva.v)));
    if response.has_focus() {
        painter.circle_stroke(middle, RADIUS, Stroke::new(1.0, theme::STRONG.of(ui)));
    }
    let at = middle + Vec2::angled(hsva.h * TAU) * hsva.s * (RADIUS - 1.0);
    painter.circle(at, 5.0, Color32::from(*hsva), Stroke::new(2.0, Color32::WHITE));
    painter.circle_stroke(at, 6.5, Stroke::new(1.0, Color32::BLACK));
    response.on_hover_text("Angle: hue. Radius: saturation. Arrow keys work too.");
    how
}

/// What is picked so far from the middle; there the hue stays.
fn hue_and_saturation(off: Vec2, hue: f32) -> (f32, f32) {
    let saturation = (off.length() / (RADIUS - 1.0)).min(1.0);
    if saturation < 0.01 {
        return (hue, 0.0);
    }
    ((off.angle() / TAU).rem_euclid(1.0), saturation)
}

fn disc(middle: Pos2, value: f32) -> Mesh {
    const PARTS: u32 = 48;
    const RINGS: u32 = 6;
    let mut mesh = Mesh::default();
    for ring in 0..=RINGS {
        let saturation = ring as f32 / RINGS as f32;
        for part in 0..=PARTS {
            let hue = part as f32 / PARTS as f32;
            let colour = Hsva::new(hue % 1.0, saturation, value, 1.0);
            mesh.colored_vertex(
                middle + Vec2::angled(hue * TAU) * saturation * RADIUS,
                Color32::from(colour),
            );
            if ring > 0 && part > 0 {
                let at = |ring: u32, part: u32| ring * (PARTS + 1) + part;
                let [a, b] = [at(ring - 1, part - 1), at(ring - 1, part)];
                let [c, d] = [at(ring, part - 1), at(ring, part)];
                mesh.add_triangle(a, b, c);
                mesh.add_triangle(b, d, c);
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Right is hue 0, down a quarter of the way round; the rim is full.
    #[test]
    fn places_on_the_wheel_are_hue_and_saturation() {
        let check = |off: Vec2, expected: (f32, f32)| {
            let (hue, saturation) = hue_and_saturation(off, 0.4);
            let near = (hue - expected.0).abs() < 1e-4 && (saturation - expected.1).abs() < 1e-4;
            assert!(near, "{off}: {hue} {saturation}");
        };
        check(vec2(RADIUS, 0.0), (0.0, 1.0));
        check(vec2(0.0, 1e6), (0.25, 1.0));
        check(vec2(0.0, -(RADIUS - 1.0) / 2.0), (0.75, 0.5));
        check(Vec2::ZERO, (0.4, 0.0));
    }
}
