//! The look of the window: one dark theme, neutral greys so that hair keeps its colour, and sizes for mouse and pen.
//!
//! Guaranteed: text stands out by at least 4.5 : 1 on every surface it is drawn on, marks by 3 : 1 (WCAG 2.2).
//! Colours never carry a meaning alone; shapes do.

use egui::{Color32, CornerRadius, Margin, Stroke, TextStyle, Vec2, Visuals};

/// Behind everything.
pub const GROUND: Color32 = Color32::from_gray(24);
/// Panels.
pub const PANEL: Color32 = Color32::from_gray(34);
/// What can be pressed.
pub const RAISED: Color32 = Color32::from_gray(52);
/// What the pointer is over.
pub const HOVERED: Color32 = Color32::from_gray(66);
/// Fields that take text, and the canvas.
pub const SUNKEN: Color32 = Color32::from_gray(19);
/// Lines between things.
pub const LINE: Color32 = Color32::from_gray(62);
/// Text.
pub const TEXT: Color32 = Color32::from_gray(215);
/// Text that explains.
pub const QUIET: Color32 = Color32::from_gray(160);
/// What is active or selected.
pub const ACCENT: Color32 = Color32::from_rgb(236, 170, 92);
/// Behind selected text and rows.
pub const SELECTED: Color32 = Color32::from_rgb(92, 68, 40);
/// Errors; always with a cross.
pub const ERROR: Color32 = Color32::from_rgb(255, 128, 112);
/// Warnings; always with a triangle.
pub const WARNING: Color32 = Color32::from_rgb(240, 200, 90);
/// Done; always with a dot.
pub const DONE: Color32 = Color32::from_rgb(140, 200, 160);

/// Gives a context the theme. `pen` makes targets 32 points high instead of 24.
pub fn apply(ctx: &egui::Context, pen: bool) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.visuals = visuals();
        let height = if pen { 32.0 } else { 24.0 };
        style.spacing.interact_size = Vec2::new(height * 1.5, height);
        style.spacing.item_spacing = Vec2::new(6.0, 4.0);
        style.spacing.button_padding = Vec2::new(6.0, 2.0);
        style.spacing.menu_margin = Margin::same(6);
        style.spacing.icon_width = 16.0;
        for (kind, size) in [
            (TextStyle::Body, 13.0),
            (TextStyle::Button, 13.0),
            (TextStyle::Small, 11.0),
            (TextStyle::Heading, 16.0),
            (TextStyle::Monospace, 12.5),
        ] {
            if let Some(font) = style.text_styles.get_mut(&kind) {
                font.size = size;
            }
        }
        style.url_in_tooltip = false;
        style.interaction.tooltip_delay = 0.5;
        style.animation_time = 0.08;
    });
}

/// Something to choose among others, as large when it is chosen as when it is not: what stands beside it keeps its place.
pub fn choice(ui: &mut egui::Ui, chosen: bool, label: &str) -> egui::Response {
    // Without a scope of its own: within one it would not go to the next line, but break letter by letter.
    let before = ui.visuals().widgets.inactive;
    let inactive = &mut ui.visuals_mut().widgets.inactive;
    inactive.weak_bg_fill = Color32::TRANSPARENT;
    inactive.bg_stroke.color = Color32::TRANSPARENT;
    let button = egui::Button::selectable(chosen, label).frame_when_inactive(true);
    let response = ui.add(button.wrap_mode(egui::TextWrapMode::Extend));
    ui.visuals_mut().widgets.inactive = before;
    response
}

/// Makes text and lines stand out more than [`apply`] does.
pub fn strengthen(ctx: &egui::Context) {
    ctx.all_styles_mut(|style| {
        let v = &mut style.visuals;
        v.weak_text_color = Some(TEXT);
        v.window_stroke.color = QUIET;
        let w = &mut v.widgets;
        for widget in [&mut w.noninteractive, &mut w.inactive, &mut w.open] {
            widget.bg_stroke.color = QUIET;
            widget.fg_stroke.color = Color32::WHITE;
        }
    });
}

fn visuals() -> Visuals {
    let mut v = Visuals::dark();
    let radius = CornerRadius::same(3);
    v.panel_fill = PANEL;
    v.window_fill = PANEL;
    v.extreme_bg_color = SUNKEN;
    v.faint_bg_color = Color32::from_gray(40);
    v.code_bg_color = SUNKEN;
    v.window_stroke = Stroke::new(1.0, LINE);
    v.window_corner_radius = CornerRadius::same(5);
    v.menu_corner_radius = CornerRadius::same(4);
    v.selection.bg_fill = SELECTED;
    v.selection.stroke = Stroke::new(1.0, ACCENT);
    v.hyperlink_color = ACCENT;
    v.error_fg_color = ERROR;
    v.warn_fg_color = WARNING;
    v.weak_text_color = Some(QUIET);
    v.widgets.noninteractive.bg_fill = PANEL;
    v.widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    v.widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
    let of =
        |fill: Color32, line: Color32, text: Color32, expansion: f32| egui::style::WidgetVisuals {
            bg_fill: fill,
            weak_bg_fill: fill,
            bg_stroke: Stroke::new(1.0, line),
            fg_stroke: Stroke::new(1.2, text),
            corner_radius: radius,
            expansion,
        };
    v.widgets.inactive = of(RAISED, RAISED, TEXT, 0.0);
    v.widgets.hovered = of(HOVERED, Color32::from_gray(96), Color32::WHITE, 0.0);
    v.widgets.active = of(SELECTED, ACCENT, Color32::WHITE, 0.0);
    v.widgets.open = of(HOVERED, LINE, Color32::WHITE, 0.0);
    v.popup_shadow.color = Color32::from_black_alpha(110);
    v.window_shadow.color = Color32::from_black_alpha(110);
    v
}

/// Contrast of two opaque colours by WCAG 2.2: 1 (none) to 21.
pub fn contrast(a: Color32, b: Color32) -> f32 {
    let luminance = |c: Color32| {
        let [r, g, b] = [c.r(), c.g(), c.b()].map(egui::ecolor::linear_f32_from_gamma_u8);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (x, y) = (luminance(a), luminance(b));
    (x.max(y) + 0.05) / (x.min(y) + 0.05)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stands_out_on_every_surface_it_is_drawn_on() {
        let surfaces = [GROUND, PANEL, SUNKEN, RAISED];
        for text in [TEXT, ACCENT, ERROR, WARNING, DONE] {
            for surface in surfaces {
                assert!(contrast(text, surface) >= 4.5, "{text:?} on {surface:?}");
            }
        }
        for surface in [GROUND, PANEL, SUNKEN, RAISED] {
            assert!(
                contrast(QUIET, surface) >= 4.5,
                "quiet on {surface:?}: {}",
                contrast(QUIET, surface)
            );
        }
        assert!(contrast(Color32::WHITE, SELECTED) >= 4.5);
        assert!(contrast(Color32::WHITE, HOVERED) >= 4.5);
        assert!(contrast(ACCENT, SELECTED) >= 3.0);
    }
}
