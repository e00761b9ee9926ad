//! The look of the window: one table of colours in two versions, dark and light, and sizes for mouse and pen.
//!
//! Both are neutral greys, so that hair keeps its colour. Which is in use is known to egui alone, and asked where something is painted
//! ([`Tint::of`]). What stands over the picture is dark in both, for the picture is the same ([`Tint::dark`]).
//!
//! Guaranteed: text stands out by at least 4.5 : 1 on every surface it is drawn on, marks by 3 : 1 (WCAG 2.2).
//! Colours never carry a meaning alone; shapes do.

use coif_nodes::define::Type;
use egui::{Color32, CornerRadius, Margin, Stroke, TextStyle, Vec2, Visuals};

/// A colour of the table: one for each theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tint {
    /// In the dark theme, and over the picture.
    pub dark: Color32,
    /// In the light theme.
    pub light: Color32,
}

/// Behind everything.
pub const GROUND: Tint = Tint::grey(24, 206);
/// Panels.
pub const PANEL: Tint = Tint::grey(34, 232);
/// Every other row of a list.
pub const STRIPE: Tint = Tint::grey(40, 225);
/// What can be pressed.
pub const RAISED: Tint = Tint::grey(52, 214);
/// What the pointer is over.
pub const HOVERED: Tint = Tint::grey(66, 196);
/// Around what the pointer is over.
pub const RIM: Tint = Tint::grey(96, 140);
/// Fields that take text, and the canvas.
pub const SUNKEN: Tint = Tint::grey(19, 246);
/// Lines between things.
pub const LINE: Tint = Tint::grey(62, 176);
/// Text.
pub const TEXT: Tint = Tint::grey(215, 24);
/// Text that explains.
pub const QUIET: Tint = Tint::grey(160, 82);
/// Text of what is pressed or under the pointer, and lines that stand out most.
pub const STRONG: Tint = Tint::grey(255, 0);
/// What is active or selected.
pub const ACCENT: Tint = Tint::new([236, 170, 92], [138, 62, 0]);
/// Behind selected text and rows.
pub const SELECTED: Tint = Tint::new([92, 68, 40], [250, 214, 160]);
/// Errors; always with a cross.
pub const ERROR: Tint = Tint::new([255, 128, 112], [168, 16, 10]);
/// Warnings; always with a triangle.
pub const WARNING: Tint = Tint::new([240, 200, 90], [100, 80, 0]);
/// Done; always with a dot.
pub const DONE: Tint = Tint::new([140, 200, 160], [18, 96, 48]);

/// The colour of what a wire or an input carries; none where nobody knows.
pub(crate) fn of_type(ty: Option<Type>) -> Tint {
    match ty {
        Some(Type::Curves) => Tint::new([128, 203, 148], [49, 140, 73]),
        Some(Type::Scalp) => Tint::new([219, 172, 130], [179, 106, 40]),
        Some(Type::Strokes) => Tint::new([232, 150, 96], [204, 90, 15]),
        Some(Type::Gestures) => Tint::new([226, 132, 178], [221, 56, 137]),
        Some(Type::Field | Type::Ramp) => Tint::new([178, 158, 235], [133, 98, 233]),
        Some(Type::Bool | Type::Int | Type::Float) => Tint::new([130, 180, 225], [36, 127, 209]),
        Some(Type::Vec3 | Type::Colour) => Tint::new([224, 205, 110], [142, 122, 21]),
        Some(Type::Shapes) => Tint::new([110, 200, 200], [43, 135, 135]),
        Some(Type::Text | Type::Choice(_) | Type::File) => Tint::grey(175, 124),
        None => ERROR,
    }
}

impl Tint {
    /// Red, green and blue in the dark theme and in the light one.
    pub const fn new([r, g, b]: [u8; 3], [red, green, blue]: [u8; 3]) -> Self {
        Self { dark: Color32::from_rgb(r, g, b), light: Color32::from_rgb(red, green, blue) }
    }
    /// A grey in either theme.
    pub const fn grey(dark: u8, light: u8) -> Self {
        Self { dark: Color32::from_gray(dark), light: Color32::from_gray(light) }
    }
    /// The colour in the theme that is in use there.
    pub fn of(self, place: &impl Themed) -> Color32 {
        self.in_theme(place.theme())
    }
    /// The colour in a theme.
    pub fn in_theme(self, theme: egui::Theme) -> Color32 {
        match theme {
            egui::Theme::Dark => self.dark,
            egui::Theme::Light => self.light,
        }
    }
    /// So much of the way to another, 0 to 1.
    #[must_use]
    pub fn mixed(self, other: Self, share: f32) -> Self {
        Self {
            dark: self.dark.lerp_to_gamma(other.dark, share),
            light: self.light.lerp_to_gamma(other.light, share),
        }
    }
    /// The same, so much of it seen: 0 to 1.
    #[must_use]
    pub fn faded(self, share: f32) -> Self {
        Self { dark: self.dark.gamma_multiply(share), light: self.light.gamma_multiply(share) }
    }
}

/// Where something is painted, which knows the theme in use.
pub trait Themed {
    /// The theme.
    fn theme(&self) -> egui::Theme;
}

impl Themed for egui::Ui {
    fn theme(&self) -> egui::Theme {
        egui::Theme::from_dark_mode(self.visuals().dark_mode)
    }
}
impl Themed for egui::Context {
    fn theme(&self) -> egui::Theme {
        egui::Context::theme(self)
    }
}
impl Themed for egui::Painter {
    fn theme(&self) -> egui::Theme {
        self.ctx().theme()
    }
}

/// Gives a context the look. `pen` makes targets 32 points high instead of 24.
pub fn apply(ctx: &egui::Context, theme: egui::Theme, pen: bool) {
    ctx.set_theme(theme);
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        ctx.style_mut_of(theme, |style| {
            style.visuals = visuals(theme);
            sizes(style, pen);
        });
    }
}

fn sizes(style: &mut egui::Style, pen: bool) {
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
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        ctx.style_mut_of(theme, |style| {
            let v = &mut style.visuals;
            v.weak_text_color = Some(TEXT.in_theme(theme));
            v.window_stroke.color = QUIET.in_theme(theme);
            let w = &mut v.widgets;
            for widget in [&mut w.noninteractive, &mut w.inactive, &mut w.open] {
                widget.bg_stroke.color = QUIET.in_theme(theme);
                widget.fg_stroke.color = STRONG.in_theme(theme);
            }
        });
    }
}

/// How widgets look in a theme; for those that stand over the picture, the dark one.
pub(crate) fn visuals(theme: egui::Theme) -> Visuals {
    let of = |tint: Tint| tint.in_theme(theme);
    let mut v = theme.default_visuals();
    let radius = CornerRadius::same(3);
    v.panel_fill = of(PANEL);
    v.window_fill = of(PANEL);
    v.extreme_bg_color = of(SUNKEN);
    v.faint_bg_color = of(STRIPE);
    v.code_bg_color = of(SUNKEN);
    v.window_stroke = Stroke::new(1.0, of(LINE));
    v.window_corner_radius = CornerRadius::same(5);
    v.menu_corner_radius = CornerRadius::same(4);
    v.selection.bg_fill = of(SELECTED);
    v.selection.stroke = Stroke::new(1.0, of(ACCENT));
    v.hyperlink_color = of(ACCENT);
    v.error_fg_color = of(ERROR);
    v.warn_fg_color = of(WARNING);
    v.weak_text_color = Some(of(QUIET));
    v.widgets.noninteractive.bg_fill = of(PANEL);
    v.widgets.noninteractive.bg_stroke = Stroke::new(1.0, of(LINE));
    v.widgets.noninteractive.fg_stroke = Stroke::new(1.0, of(TEXT));
    let widget = |fill: Tint, line: Tint, text: Tint| egui::style::WidgetVisuals {
        bg_fill: of(fill),
        weak_bg_fill: of(fill),
        bg_stroke: Stroke::new(1.0, of(line)),
        fg_stroke: Stroke::new(1.2, of(text)),
        corner_radius: radius,
        expansion: 0.0,
    };
    v.widgets.inactive = widget(RAISED, RAISED, TEXT);
    v.widgets.hovered = widget(HOVERED, RIM, STRONG);
    v.widgets.active = widget(SELECTED, ACCENT, STRONG);
    v.widgets.open = widget(HOVERED, LINE, STRONG);
    let shadow = Color32::from_black_alpha(if theme == egui::Theme::Dark { 110 } else { 50 });
    (v.popup_shadow.color, v.window_shadow.color) = (shadow, shadow);
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

    /// Each of the first stands out from each of the second, in both themes.
    #[track_caller]
    fn check(least: f32, over: &[(&str, Tint)], surfaces: &[(&str, Tint)]) {
        for theme in [egui::Theme::Dark, egui::Theme::Light] {
            for (name, tint) in over {
                for (surface, under) in surfaces {
                    let found = contrast(tint.in_theme(theme), under.in_theme(theme));
                    assert!(found >= least, "{theme:?}: {name} on {surface}: {found}");
                }
            }
        }
    }

    #[test]
    fn text_stands_out_on_every_surface_it_is_drawn_on_in_both_themes() {
        let surfaces = [
            ("ground", GROUND),
            ("panel", PANEL),
            ("stripe", STRIPE),
            ("sunken", SUNKEN),
            ("raised", RAISED),
        ];
        let text = [
            ("text", TEXT),
            ("strong", STRONG),
            ("quiet", QUIET),
            ("accent", ACCENT),
            ("error", ERROR),
            ("warning", WARNING),
            ("done", DONE),
        ];
        check(4.5, &text, &surfaces);
        check(
            4.5,
            &[("text", TEXT), ("strong", STRONG)],
            &[("selected", SELECTED), ("hovered", HOVERED)],
        );
        check(3.0, &[("accent", ACCENT)], &[("selected", SELECTED)]);
    }

    #[test]
    fn types_stand_out_on_panels_and_the_canvas_in_both_themes() {
        let types =
            [Type::Curves, Type::Scalp, Type::Strokes, Type::Field, Type::Float, Type::Colour];
        for ty in types.into_iter().chain([Type::Shapes, Type::Text]).map(Some).chain([None]) {
            check(
                3.0,
                &[(&format!("{ty:?}"), of_type(ty))],
                &[("panel", PANEL), ("sunken", SUNKEN)],
            );
        }
    }

    /// The widgets that egui draws take their colours from the same table.
    #[test]
    fn words_of_widgets_stand_out_from_them_in_both_themes() {
        for theme in [egui::Theme::Dark, egui::Theme::Light] {
            let v = visuals(theme);
            assert_eq!(v.dark_mode, theme == egui::Theme::Dark);
            let w = &v.widgets;
            for widget in [&w.noninteractive, &w.inactive, &w.hovered, &w.active, &w.open] {
                assert!(contrast(widget.fg_stroke.color, widget.weak_bg_fill) >= 4.5, "{widget:?}");
                assert!(contrast(widget.fg_stroke.color, widget.bg_fill) >= 4.5, "{widget:?}");
            }
            let selected = (v.selection.stroke.color, v.selection.bg_fill);
            assert!(contrast(selected.0, selected.1) >= 4.5, "{theme:?}: {selected:?}");
            assert!(contrast(v.text_color(), v.window_fill) >= 4.5);
            assert!(contrast(v.weak_text_color(), v.extreme_bg_color) >= 4.5);
        }
    }
}
